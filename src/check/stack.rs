//! Print -> findings of how lines lie on each other: in the air, or printed twice.
//!
//! A map of the bed holds how high plastic stands; lines are laid on it in the file's order.
//! A place of a line is carried if plastic (or the bed) reaches up to its lower side there,
//! or stands beside it on its own layer. A stretch that is not carried is a bridge if both
//! its ends are, and else hangs in the air.

use super::against::SOME_WIDTH;
use super::beads::place;
use super::capsule::Capsule;
use super::finding::{Code, Finding, Findings, short};
use super::part::Part;
use super::raster::Grid;
use crate::reader::print::Step;
use crate::reader::{Print, Role};

/// Side of a pixel, mm.
const PITCH: f64 = 0.1;

/// Pixels of the map at most; larger beds get larger pixels.
const MOST_PIXELS: f64 = 4e7;

/// Plastic may be missing under a line by this part of its height.
const GAP: f64 = 0.5;

/// Support may end so far below the part, mm: it is to come off.
const SUPPORT_GAP: f64 = 0.45;

/// A line may hang out so far, mm, …
const LONGEST_END: f64 = 2.0;

/// … or so many distances between lines of sparse infill: skins begin somewhere above it.
const INFILL_GAPS: f64 = 2.0;

/// Density of sparse infill where none is told, and where it is next to nothing, as a part of 1.
const SOME_DENSITY: f64 = 0.2;
const LEAST_DENSITY: f64 = 0.02;

/// A line runs on another where their middles, so wide as a part of their widths, meet …
const CORE: f64 = 0.4;

/// … over so many mm.
const LEAST_TWICE: f64 = 2.0;

/// So far behind the nozzle a line counts as one that the next may not run on, mm: turns are closer.
const BEHIND: f64 = 1.5;

/// What was measured.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Measured {
    /// Longest stretch between two carried places, mm.
    pub(super) longest_bridge: f64,
    /// Length of lines that hang where the part itself hangs, mm.
    pub(super) part_hangs: f64,
}

/// Lays all lines of the layers down. Where `part` itself has nothing below, a hanging line is
/// the part's fault, and only measured.
pub(super) fn check(
    print: &Print,
    part: Option<&Part>,
    infill: Option<f64>,
    found: &mut Findings,
) -> Measured {
    let mut measured = Measured::default();
    let Some(mut pile) = Pile::over(print, infill) else { return measured };
    for (layer, one) in print.layers.iter().enumerate() {
        let steps = print.moves_of(one);
        for chain in steps.chunk_by(|a, b| a.is_line() && b.is_line() && a.to == b.from) {
            if chain[0].is_line() {
                pile.chain(chain, layer, part, found, &mut measured);
            }
        }
    }
    measured
}

/// Plastic as it stands.
struct Pile {
    grid: Grid,
    /// How high it stands, mm; 0 is the bed.
    tops: Vec<f32>,
    /// Height of the nozzle when a line's middle was laid, mm.
    cores: Vec<f32>,
    /// A line may hang out so far, mm.
    longest_end: f64,
}

impl Pile {
    /// An empty bed under all of `print`; `infill` is the density of its sparse infill, as a part of 1.
    fn over(print: &Print, infill: Option<f64>) -> Option<Self> {
        let steps = print.layers.iter().flat_map(|layer| print.moves_of(layer));
        let (low, high) = super::extent(steps.filter(|step| step.is_line()))?;
        let grid = Grid::over(low, high, 0.5, PITCH, MOST_PIXELS);
        let count = grid.size[0] * grid.size[1];
        let gap = SOME_WIDTH / infill.unwrap_or(SOME_DENSITY).max(LEAST_DENSITY);
        Some(Self {
            grid,
            tops: vec![0.0; count],
            cores: vec![0.0; count],
            longest_end: LONGEST_END.max(INFILL_GAPS * gap),
        })
    }

    fn at<T: Copy>(&self, map: &[T], place: [f64; 2]) -> Option<T> {
        self.grid.pixel(place).map(|[x, y]| map[y * self.grid.size[0] + x])
    }

    /// Lays one unbroken line, of many straight pieces.
    fn chain(
        &mut self,
        chain: &[Step],
        layer: usize,
        part: Option<&Part>,
        found: &mut Findings,
        measured: &mut Measured,
    ) {
        let mut runs = Runs::default();
        let mut twice = Twice::default();
        let mut behind = 0;
        let mut way_behind = 0.0;
        for step in chain {
            way_behind += step.length();
            while way_behind - chain[behind].length() > BEHIND {
                way_behind -= chain[behind].length();
                self.lay_core(&chain[behind]);
                behind += 1;
            }
            for place in Samples::of(step, self.grid.pitch) {
                twice.add(self.is_laid(step, place.at), place.length, step);
                runs.add(self.is_carried(step, &place), place);
            }
        }
        chain[behind..].iter().for_each(|step| self.lay_core(step));
        chain.iter().for_each(|step| self.lay(step));
        runs.end();
        self.hanging(&runs.ends, layer, (chain, part), found, measured);
        measured.longest_bridge = measured.longest_bridge.max(runs.longest_bridge);
        for (length, step) in twice.ends() {
            let text = format!("{} mm of a line lie on another of the layer", short(length));
            let finding = Finding::of(Code::PrintedTwice, length, "mm", text);
            found.add(Finding { place: place(layer, &step), ..finding });
        }
    }

    fn hanging(
        &self,
        ends: &[Vec<Sample>],
        layer: usize,
        (chain, part): (&[Step], Option<&Part>),
        found: &mut Findings,
        measured: &mut Measured,
    ) {
        let length = |places: &[&Sample]| places.iter().map(|place| place.length).sum::<f64>();
        for end in ends {
            let all: Vec<&Sample> = end.iter().collect();
            if length(&all) <= self.longest_end {
                continue;
            }
            let (by_part, own): (Vec<&Sample>, Vec<&Sample>) = all
                .into_iter()
                .partition(|place| part.is_some_and(|part| part.hangs(layer, place.at)));
            measured.part_hangs += length(&by_part);
            let length = length(&own);
            if length <= self.longest_end {
                continue;
            }
            let what = chain[0].role.name();
            let text = format!("{} mm of {what} have nothing under them", short(length));
            let finding = Finding::of(Code::InTheAir, length, "mm", text);
            let mut place = place(layer, &chain[0]);
            place.at_mm = Some(own[own.len() / 2].at.map(short));
            found.add(Finding { place, ..finding });
        }
    }

    /// Whether something carries the line there: below it, or beside it on its layer.
    fn is_carried(&self, step: &Step, place: &Sample) -> bool {
        let height = f64::from(step.height);
        let needed = place.z - height - GAP * height.min(0.3);
        let side = f64::from(step.width) / 2.0;
        [-side, -side / 2.0, 0.0, side / 2.0, side].into_iter().any(|off| {
            let at = [place.at[0] + off * place.across[0], place.at[1] + off * place.across[1]];
            self.at(&self.tops, at).is_none_or(|top| f64::from(top) >= needed - 1e-3)
        })
    }

    /// Whether the middle of another line of this layer lies there.
    fn is_laid(&self, step: &Step, at: [f64; 2]) -> bool {
        let core = self.at(&self.cores, at).unwrap_or(0.0);
        core > 0.0 && (core - step.to[2]).abs() < 0.01
    }

    fn lay(&mut self, step: &Step) {
        let extra = if step.role == Role::Support { SUPPORT_GAP as f32 } else { 0.0 };
        let top = step.from[2].max(step.to[2]) + extra;
        let (width, tops) = (self.grid.size[0], &mut self.tops);
        Capsule::of(step, 1.0).rows(&self.grid, |y, span| {
            let row = &mut tops[y * width..][span];
            row.iter_mut().for_each(|known| *known = known.max(top));
        });
    }

    fn lay_core(&mut self, step: &Step) {
        let (width, cores, z) = (self.grid.size[0], &mut self.cores, step.to[2]);
        Capsule::of(step, CORE).rows(&self.grid, |y, span| cores[y * width..][span].fill(z));
    }
}

/// A short piece of a line.
struct Sample {
    /// Its middle.
    at: [f64; 2],
    z: f64,
    /// Across the line, of length 1.
    across: [f64; 2],
    /// mm.
    length: f64,
}

/// The pieces of a line.
struct Samples {
    from: [f64; 3],
    way: [f64; 3],
    length: f64,
    count: usize,
    next: usize,
}

impl Samples {
    fn of(step: &Step, pitch: f64) -> Self {
        let from = step.from.map(f64::from);
        let way = [0, 1, 2].map(|axis| f64::from(step.to[axis]) - from[axis]);
        let length = (way[0] * way[0] + way[1] * way[1]).sqrt();
        let count = (length / pitch).ceil().max(1.0) as usize;
        Self { from, way, length, count, next: 0 }
    }
}

impl Iterator for Samples {
    type Item = Sample;

    fn next(&mut self) -> Option<Sample> {
        if self.next == self.count {
            return None;
        }
        let part = (self.next as f64 + 0.5) / self.count as f64;
        self.next += 1;
        Some(Sample {
            at: [0, 1].map(|axis| self.from[axis] + part * self.way[axis]),
            z: self.from[2] + part * self.way[2],
            across: [-self.way[1] / self.length, self.way[0] / self.length],
            length: self.length / self.count as f64,
        })
    }
}

/// Stretches of a line that nothing carries.
#[derive(Default)]
struct Runs {
    /// Those at the line's ends.
    ends: Vec<Vec<Sample>>,
    longest_bridge: f64,
    /// The one that goes on.
    run: Vec<Sample>,
    is_carried_before: bool,
}

impl Runs {
    fn add(&mut self, carried: bool, place: Sample) {
        if !carried {
            self.run.push(place);
            return;
        }
        let length: f64 = self.run.iter().map(|place| place.length).sum();
        if !self.is_carried_before && length > 0.0 {
            self.ends.push(std::mem::take(&mut self.run));
        }
        self.longest_bridge =
            self.longest_bridge.max(if self.is_carried_before { length } else { 0.0 });
        self.run.clear();
        self.is_carried_before = true;
    }

    /// Ends the line: what still hangs is an end, too.
    fn end(&mut self) {
        if !self.run.is_empty() {
            self.ends.push(std::mem::take(&mut self.run));
        }
    }
}

/// Stretches of a line that run on other lines.
#[derive(Default)]
struct Twice {
    found: Vec<(f64, Step)>,
    length: f64,
    last: Option<Step>,
}

impl Twice {
    fn add(&mut self, laid: bool, length: f64, step: &Step) {
        if laid {
            self.length += length;
            self.last = Some(*step);
        } else {
            self.end();
        }
    }

    fn end(&mut self) {
        if let Some(step) = self.last.take().filter(|_| self.length >= LEAST_TWICE) {
            self.found.push((self.length, step));
        }
        self.length = 0.0;
    }

    fn ends(mut self) -> Vec<(f64, Step)> {
        self.end();
        self.found
    }
}
