//! Toolpaths -> text: writes a G-code file layer by layer.
//!
//! - *Moves* are the machine moves of one layer. Text, sums and the clock all read the same ones, so
//!   that the times are those of what is written.
//! - *Progress* lines (`M73`) tell the printer which part of the print is done.
//!
//! 1. [`moves`] turns a layer into machine moves; [`flow`] lowers feeds to the flow limit, `slopes` to
//!    what the z axis can follow. `arcs` replaces lines that lie on a circle; `segments` joins and slows down lines that are too short.
//! 2. [`cooling`] lowers those of layers that would take too little time. It holds back some layers,
//!    since those above have a say.
//! 3. [`times`] runs the clock over these moves, layer by layer; [`usage`] sums their filament.
//! 4. [`write`](mod@write) formats the moves in the printer's [`dialect`], with the power of the
//!    [`fan`], and with acceleration and jerk of each kind of move ([`drive`]).
//! 5. Layers go to the output in order as soon as their times are known, with placeholders for
//!    progress lines. These have a fixed length and are filled in at the end, when the total time
//!    is known.
//! 6. [`hosts`] writes the comments that hosts read at the head and the end of the file.

mod arcs;
pub mod cooling;
pub mod dialect;
pub mod drive;
mod error;
pub mod fan;
pub mod flow;
pub mod hosts;
mod modes;
pub mod moves;
pub mod number;
mod output;
mod progress;
pub mod reshaped;
mod segments;
mod slopes;
mod stops;
pub mod times;
pub mod usage;
pub mod write;

use crate::motion::Limits;
use crate::plan::Toolpath;
use crate::profile::template::{self, PrintFacts};
use crate::profile::{Settings, dump};
use arcs::Arcs;
use cooling::{Cooled, Cooling};
use dialect::Dialect;
use drive::Drives;
pub use error::{Error, Result};
use fan::FanParams;
use hosts::Thumbnail;
use moves::{MoveParams, Moves};
pub use output::Output;
use output::Places;
use progress::Progress;
use rayon::prelude::*;
use segments::Segments;
use slopes::Slopes;
use std::collections::VecDeque;
use times::{Timer, Times};
use usage::Usage;
use write::{Before, LayerText, WriteParams};

/// Sums over a file.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Sums {
    /// Lengths and filament.
    pub usage: Usage,
    /// Times.
    pub times: Times,
    /// What cooling changed; none where nothing asks for it.
    pub cooled: Option<Cooled>,
}

/// Writes one G-code file.
pub struct Writer<'a> {
    out: Places<'a>,
    settings: &'a Settings,
    facts: PrintFacts,
    moves: MoveParams,
    slopes: Slopes,
    arcs: Option<Arcs>,
    segments: Option<Segments>,
    params: WriteParams,
    cooling: Option<Cooling>,
    /// What is in force after the layers so far.
    before: Before,
    timer: Timer,
    /// Layers whose times are not all known yet.
    waiting: VecDeque<LayerText>,
    progress: Progress,
    usage: Usage,
    /// The end block, filled in.
    end: String,
}

impl<'a> Writer<'a> {
    /// Begins with the head of the file, the pictures in it, and the start block. `offset` is where
    /// the layout's middle goes on the machine, mm.
    ///
    /// # Errors
    /// [`Error::Block`] for an unknown placeholder,
    /// [`Error::Write`] if writing fails.
    pub fn new(
        out: &'a mut dyn Output,
        settings: &'a Settings,
        facts: PrintFacts,
        offset: [f64; 2],
        thumbnails: &[Thumbnail],
    ) -> Result<Self> {
        let mut writer = Self {
            out: Places { out, written: 0, held: Some(Vec::new()) },
            settings,
            facts,
            moves: MoveParams::new(settings, offset),
            slopes: Slopes::new(settings),
            arcs: Arcs::new(settings),
            segments: Segments::new(settings),
            params: WriteParams::new(settings),
            cooling: Cooling::new(settings, FanParams::new(settings).goes_by_time()),
            before: Before::default(),
            timer: Timer::new(Limits::new(settings)).driven(Drives::new(settings)),
            waiting: VecDeque::new(),
            progress: Progress::new(settings.machine.dialect),
            usage: Usage::default(),
            end: String::new(),
        };
        // Both blocks at once: one that cannot be filled in is refused before anything is written.
        let values = template::values(settings, &facts);
        writer.end = template::render("machine.end_gcode", &settings.machine.end_gcode, &values)?;
        let values = template::start_values(settings, &facts);
        let block =
            template::render("machine.start_gcode", &settings.machine.start_gcode, &values)?;
        let (modes, e_mode) =
            (modes::before(&block, &settings.machine), modes::of_filament(&settings.machine));
        // Its numbers are filled in at the end.
        let head = hosts::head(facts.layers, settings.output.stamp, thumbnails);
        let head = dialect_head(settings, 0.0, 0.0) + &head;
        let advance = dialect_advance(settings);
        let units = modes::units_after(&block);
        let start =
            format!("{head};TYPE:Custom\n{modes}{block}{units}G90\n{e_mode}\nG92 E0\n{advance}");
        writer.out.put(start.as_bytes())?;
        Ok(writer)
    }

    /// Writes the next layers. All threads make their moves and text; the output keeps their order.
    ///
    /// # Errors
    /// [`Error::Write`] if writing fails.
    pub fn layers(&mut self, layers: &[Toolpath]) -> Result<()> {
        // Few at once: moves and text take more memory than the layers themselves.
        let at_once = rayon::current_num_threads().max(4);
        layers.chunks(at_once).try_for_each(|layers| {
            let (params, slopes) = (&self.moves, &self.slopes);
            let (arcs, segments) = (&self.arcs, &self.segments);
            let made = |layer: &Toolpath| {
                let mut moves = params.moves(layer);
                slopes.limit(&mut moves);
                arcs.iter().for_each(|arcs| arcs.replace(&mut moves));
                segments.iter().for_each(|segments| segments.limit(&mut moves));
                moves
            };
            let moves: Vec<Moves> = layers.par_iter().map(made).collect();
            let ready = match &mut self.cooling {
                Some(cooling) => cooling.layers(moves),
                None => moves,
            };
            self.together(&ready)
        })
    }

    /// Writes layers, with the text of all of them in memory at once.
    fn together(&mut self, layers: &[Moves]) -> Result<()> {
        let (params, timer) = (&self.params, &mut self.timer);
        let used: Vec<Usage> = layers.par_iter().map(Usage::of).collect();
        let mut befores = Vec::with_capacity(layers.len());
        for (layer, used) in layers.iter().zip(&used) {
            self.before.fan = params.fan(layer, self.before.fan);
            befores.push(self.before);
            self.usage.add(used);
            self.before.e = self.usage.filament();
            self.before.told = params.told(layer, self.before.told);
        }
        // The clock must see the layers in order. Their texts are independent of each other.
        let ((), texts) = rayon::join(
            || layers.iter().for_each(|moves| timer.layer(moves)),
            || -> Vec<LayerText> {
                let layers = layers.par_iter().zip(&befores);
                layers.map(|(moves, &before)| params.layer(moves, before)).collect()
            },
        );
        self.waiting.extend(texts);
        if self.usage.filament() > 0.0 {
            self.out.release()?;
        }
        self.write_ready()
    }

    /// Writes the end block and the settings, says what was used and fills in the progress.
    /// `None` if nothing was extruded: then nothing is written at all.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn finish(mut self) -> Result<Option<Sums>> {
        if let Some(last) = self.cooling.as_mut().map(Cooling::finish) {
            self.together(&last)?;
        }
        if self.usage.filament() <= 0.0 {
            return Ok(None);
        }
        self.timer.finish();
        self.write_ready()?;
        let mut tail = self.params.finish(&self.moves, self.before);
        tail.extend_from_slice(hosts::risen(self.usage.highest, self.timer.times()).as_bytes());
        tail.extend_from_slice(self.progress.done().as_bytes());
        tail.extend_from_slice(format!(";TYPE:Custom\n{}", self.end).as_bytes());
        let cooled = self.cooling.as_ref().map(|cooling| cooling.cooled().clone());
        let sums = Sums { usage: self.usage, times: self.timer.times().clone(), cooled };
        tail.extend_from_slice(hosts::tail(self.facts.layers, &sums, self.settings).as_bytes());
        for (key, value) in dump(self.settings) {
            tail.extend_from_slice(format!("; {key} = {value}\n").as_bytes());
        }
        self.out.put(&tail)?;
        self.progress.fill_in(sums.times.total(), &mut self.out)?;
        let plastic = sums.usage.filament() * self.settings.filament_area();
        let head = dialect_head(self.settings, sums.times.total(), plastic);
        if !head.is_empty() {
            self.out.put_at(0, head.as_bytes())?;
        }
        Ok(Some(sums))
    }

    /// Writes the layers whose times are known.
    fn write_ready(&mut self) -> Result<()> {
        while let Some(schedule) = self.timer.next_ready() {
            let Some(layer) = self.waiting.pop_front() else { return Ok(()) };
            self.progress.layer(&layer, &schedule, &mut self.out)?;
        }
        Ok(())
    }
}

/// The line that sets the material's pressure advance, if it asks for one.
fn dialect_advance(settings: &Settings) -> String {
    let dialect = Dialect::new(settings.machine.dialect);
    let advance = settings.filament.pressure_advance;
    let line = advance.and_then(|seconds| dialect.advance(seconds, settings.machine.tool));
    line.map_or_else(String::new, |line| line + "\n")
}

/// The lines that the dialect needs first of all.
fn dialect_head(settings: &Settings, seconds: f64, plastic: f64) -> String {
    let machine = &settings.machine;
    Dialect::new(machine.dialect).head(seconds, plastic, machine.nozzle_diameter)
}
