//! G-code + Limits -> Estimate: how long a print takes, by role and by layer.
//!
//! The reader's events go one by one to a [`Clock`], which plans the moves as the printer does. Each
//! move carries a tag (its layer, its role, its plastic per mm); the clock returns the tag with the
//! move's time as soon as it is final, and the time is added where the tag points. So a file of any
//! length is timed in the memory of a few hundred moves, besides a record for each layer.
//!
//! - Limits that the file sets (M201, M203 to M205, M566, SET_VELOCITY_LIMIT) hold from there on,
//!   unless the caller wants the same limits for several files.
//! - A layer without a line is no layer: its time counts for the one before, or for the start.
//! - Heating and homing take a time that is not in the file: they are counted, not timed. The
//!   nozzle stops for them.
//! - Dwells (G4) are timed, and belong to no role.

use crate::motion::{Clock, Junction, Limits, Move, Timed};
use crate::reader::{
    self, Cause, Change, Event, Firmware, Heights, Motion, Reading, Role, Summary, Wait,
};
use serde::Serialize;
use std::f64::consts::PI;
use std::io::BufRead;

/// Version of the JSON schema; raised when a field changes its meaning or goes away.
pub const SCHEMA: u32 = 1;

/// What an estimate depends on besides the file and the machine's limits.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Options {
    /// Diameter of the filament, mm.
    pub filament_diameter: f64,
    /// Whether the file's own limits are ignored, so that files can be compared.
    pub fixed_limits: bool,
    /// Whose rules the file is read by.
    pub firmware: Firmware,
    /// Diameter of the filament by which E is a volume, as [`Reading::volumes`].
    pub volumes: Option<f64>,
}

/// How long a print takes.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Estimate {
    /// [`SCHEMA`].
    pub schema: u32,
    /// All moves and dwells, s; neither heating nor homing.
    pub seconds: f64,
    /// Of these, printing: from the first layer to the last line, s; what files and reports tell.
    pub print_seconds: f64,
    /// Of these, before the first layer, s.
    pub start_seconds: f64,
    /// Of these, after the last line: what is pulled back and the end block, s.
    pub end_seconds: f64,
    /// Of these, standing still by G4, s.
    pub dwell_seconds: f64,
    /// Number of moves; an arc counts as the straight pieces that it is read as.
    pub moves: u64,
    /// Filament that has gone in at most, mm.
    pub filament_mm: f64,
    /// Largest flow of plastic in a move sideways, mm³/s.
    pub peak_flow_mm3_s: f64,
    /// By role, those that occur.
    pub roles: Vec<RoleTime>,
    /// By layer, from the first.
    pub layers: Vec<LayerTime>,
    /// The layer that takes longest, counted from 1; 0 without layers.
    pub longest_layer: usize,
    /// The layer that takes least time, counted from 1; 0 without layers.
    pub shortest_layer: usize,
    /// What is in the file but not in the time.
    pub not_counted: NotCounted,
}

/// What one role takes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct RoleTime {
    /// The role.
    pub role: Role,
    /// Its time, s.
    pub seconds: f64,
    /// Number of moves.
    pub moves: u64,
    /// Length of the nozzle's way, mm.
    pub length_mm: f64,
    /// Filament pushed out less that pulled back, mm.
    pub filament_mm: f64,
}

/// What one layer takes.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct LayerTime {
    /// Height at which most of its lines lie, mm.
    pub z_mm: f64,
    /// Its time with the way to it, s.
    pub seconds: f64,
}

/// What is in the file but not in the time.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct NotCounted {
    /// Waits until something is hot.
    pub heating: u64,
    /// Homing and probing.
    pub homing: u64,
    /// Pauses and changes of filament, which last until somebody goes on.
    pub pauses: u64,
    /// Retractions whose length only the printer knows (G10, G11).
    pub firmware_retractions: u64,
    /// Lines of code that the reader does not know.
    pub unknown_lines: u64,
    /// The first of them, from 1; 0 if there is none.
    pub first_unknown_line: u64,
    /// Arcs that were read coarser, or with fewer turns, than they are: see
    /// [`Summary::coarse_arcs`](reader::Summary::coarse_arcs).
    pub coarse_arcs: u64,
}

/// Reads G-code from `source` and estimates how long it takes on a machine of these limits.
/// `file` is its name for messages.
///
/// # Errors
/// [`Cause::Unreadable`], or [`Cause::NoMove`] for a file that is no G-code.
pub fn estimate(
    source: &mut dyn BufRead,
    file: &str,
    limits: &Limits,
    options: Options,
) -> Result<Estimate, reader::Error> {
    let mut meter = Meter::new(limits, options);
    let reading = Reading { firmware: options.firmware, volumes: options.volumes };
    let summary = reader::read(source, reading, &mut |_, event| meter.event(event))
        .map_err(|error| Cause::Unreadable(error).of(file))?;
    meter.clock.finish();
    meter.collect();
    if meter.moves == 0 {
        return Err(Cause::NoMove.of(file));
    }
    Ok(meter.estimate(summary))
}

/// What a move's time is added to.
#[derive(Debug, Clone, Copy)]
struct Tag {
    /// Place in the list of layers.
    layer: usize,
    /// `None` for a dwell.
    role: Option<Role>,
    /// Plastic per way of the nozzle, mm³/mm.
    area: f64,
}

/// A layer while it is measured.
#[derive(Debug, Clone, Default)]
struct Layer {
    seconds: f64,
    /// Of its lines, but for those of non-planar skin.
    heights: Heights,
    /// Height of the level lines that it was found by, mm.
    found: Option<f64>,
}

/// Sums up.
struct Meter {
    clock: Clock<Tag>,
    options: Options,
    roles: [RoleTime; Role::ALL.len()],
    /// The first is what comes before the first layer.
    layers: Vec<Layer>,
    /// Where the layers begin that comments mark.
    first_marked: Option<usize>,
    dwell: f64,
    /// Since the last line.
    end: f64,
    moves: u64,
    filament: f64,
    most_filament: f64,
    peak_flow: f64,
    not_counted: NotCounted,
}

impl Meter {
    fn new(limits: &Limits, options: Options) -> Self {
        let zero =
            |role| RoleTime { role, seconds: 0.0, moves: 0, length_mm: 0.0, filament_mm: 0.0 };
        Self {
            clock: Clock::new(limits.clone()),
            options,
            roles: Role::ALL.map(zero),
            layers: vec![Layer::default()],
            first_marked: None,
            dwell: 0.0,
            end: 0.0,
            moves: 0,
            filament: 0.0,
            most_filament: 0.0,
            peak_flow: 0.0,
            not_counted: NotCounted::default(),
        }
    }

    fn event(&mut self, event: Event) {
        let layer = self.layers.len() - 1;
        match event {
            Event::Move(motion) => self.motion(&motion, layer),
            Event::Dwell(seconds) => {
                self.clock.dwell(seconds, Tag { layer, role: None, area: 0.0 });
            }
            Event::Wait(wait) => {
                self.clock.stop();
                match wait {
                    Wait::Heating => self.not_counted.heating += 1,
                    Wait::Homing => self.not_counted.homing += 1,
                    Wait::User => self.not_counted.pauses += 1,
                    Wait::Moves => {}
                }
            }
            Event::Layer { marked, z } => {
                if marked && self.first_marked.is_none() {
                    self.first_marked = Some(self.layers.len());
                }
                self.layers.push(Layer { found: z, ..Layer::default() });
            }
            Event::Change(change) if !self.options.fixed_limits => {
                let mut limits = self.clock.limits().clone();
                apply(&change, &mut limits);
                self.clock.set_limits(limits);
            }
            // Setting a heater takes no time; waiting for it is counted above.
            Event::Change(_)
            | Event::Heating(_)
            | Event::Command { .. }
            | Event::Comment(_)
            | Event::Patch(_) => {}
            // All three are in the reader's summary.
            Event::FirmwareRetraction { .. } | Event::Unknown(_) | Event::NoNumber { .. } => {}
        }
        self.collect();
    }

    fn motion(&mut self, motion: &Motion, layer: usize) {
        let [x, y, z] = std::array::from_fn(|axis| motion.to[axis] - motion.from[axis]);
        let length = (x * x + y * y + z * z).sqrt();
        let sum = &mut self.roles[motion.role as usize];
        sum.moves += 1;
        sum.length_mm += length;
        sum.filament_mm += motion.filament;
        self.moves += 1;
        self.filament += motion.filament;
        self.most_filament = self.most_filament.max(self.filament);
        let mut area = 0.0;
        if motion.filament > 0.0 && (x != 0.0 || y != 0.0) {
            let diameter = self.options.filament_diameter;
            area = motion.filament * PI * diameter * diameter / 4.0 / length;
            if motion.role != Role::NonPlanar {
                self.layers[layer].heights.add([motion.from[2], motion.to[2]], length);
            }
        }
        let tag = Tag { layer, role: Some(motion.role), area };
        self.clock.push(Move { delta: [x, y, z, motion.filament], feed: motion.feed, tag });
    }

    /// Adds up the times that are known by now.
    fn collect(&mut self) {
        for Timed { seconds, peak, tag, .. } in self.clock.drain() {
            match tag.role {
                Some(role) => self.roles[role as usize].seconds += seconds,
                None => self.dwell += seconds,
            }
            self.layers[tag.layer].seconds += seconds;
            self.end = if tag.area > 0.0 { 0.0 } else { self.end + seconds };
            self.peak_flow = self.peak_flow.max(tag.area * peak);
        }
    }

    fn estimate(self, summary: Summary) -> Estimate {
        let roles: Vec<_> = self.roles.into_iter().filter(|role| role.moves > 0).collect();
        // Lines drawn before the first comment that marks a layer belong to the start.
        let first = self.first_marked.unwrap_or(1).min(self.layers.len());
        let (start, marked) = self.layers.split_at(first);
        let mut start_seconds: f64 = start.iter().map(|layer| layer.seconds).sum();
        let mut layers: Vec<LayerTime> = Vec::new();
        for layer in marked {
            match (layer.heights.height(layer.found), layers.last_mut()) {
                (Some(z_mm), _) => layers.push(LayerTime { z_mm, seconds: layer.seconds }),
                // Without a line: its moves count with what lies before.
                (None, Some(last)) => last.seconds += layer.seconds,
                (None, None) => start_seconds += layer.seconds,
            }
        }
        let by_time = |a: &usize, b: &usize| layers[*a].seconds.total_cmp(&layers[*b].seconds);
        // Of equals the first.
        let longest = (0..layers.len()).rev().max_by(by_time).map_or(0, |index| index + 1);
        let shortest = (0..layers.len()).min_by(by_time).map_or(0, |index| index + 1);
        let seconds = roles.iter().map(|role| role.seconds).sum::<f64>() + self.dwell;
        Estimate {
            schema: SCHEMA,
            seconds,
            print_seconds: (seconds - start_seconds - self.end).max(0.0),
            start_seconds,
            end_seconds: self.end,
            dwell_seconds: self.dwell,
            moves: self.moves,
            filament_mm: self.most_filament,
            peak_flow_mm3_s: self.peak_flow,
            roles,
            longest_layer: longest,
            shortest_layer: shortest,
            layers,
            not_counted: NotCounted {
                firmware_retractions: summary.firmware_retractions,
                unknown_lines: summary.unknown,
                first_unknown_line: summary.first_unknown,
                coarse_arcs: summary.coarse_arcs,
                ..self.not_counted
            },
        }
    }
}

/// Limits as the file changes them. What does not fit the machine's rule for corners has no effect.
pub(crate) fn apply(change: &Change, limits: &mut Limits) {
    let set = |limit: &mut f64, value: Option<f64>| *limit = value.unwrap_or(*limit);
    for axis in 0..4 {
        set(&mut limits.feed[axis], change.feed[axis]);
        set(&mut limits.acceleration[axis], change.acceleration[axis]);
    }
    set(&mut limits.print_acceleration, change.print);
    set(&mut limits.travel_acceleration, change.travel);
    set(&mut limits.retract_acceleration, change.retract);
    let is_vector = matches!(limits.junction, Junction::VectorJerk(_));
    match &mut limits.junction {
        Junction::Jerk(jerk) | Junction::VectorJerk(jerk) | Junction::SpeedChange(jerk) => {
            let mut change = *change;
            if is_vector {
                // Where x and y have one jerk, Y is no word.
                change.jerk[1] = change.jerk[1].or(change.jerk[0]);
            }
            for (jerk, value) in jerk.iter_mut().zip(change.jerk) {
                set(jerk, value);
            }
        }
        Junction::Deviation(deviation) => set(deviation, change.deviation),
        Junction::SquareCorner { velocity, minimum_cruise_ratio, .. } => {
            set(velocity, change.square_corner_velocity);
            set(minimum_cruise_ratio, change.minimum_cruise_ratio);
            if let Some(sprint) = change.accel_to_decel {
                *minimum_cruise_ratio = 1.0 - sprint / limits.print_acceleration.max(sprint);
            }
            if !minimum_cruise_ratio.is_finite() {
                *minimum_cruise_ratio = 0.0;
            }
            *minimum_cruise_ratio = minimum_cruise_ratio.clamp(0.0, 1.0);
        }
    }
}
