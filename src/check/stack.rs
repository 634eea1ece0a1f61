//! Print -> findings of how lines lie on each other: in the air, or printed twice.
//!
//! Words used here: *tops* is a map of how high plastic stands at each place of the bed, *cores* one
//! of the height at which the middle of the last line there was laid; a *chain* is lines one after the
//! other without a break; a *patch* is all lines of a layer that touch; a place of a line is
//! *carried* if plastic or the bed reaches up to its lower side there.
//!
//! Lines are laid on the maps in the file's order, layer by layer:
//! - a patch of which no line is carried anywhere is in the air, unless the model itself has
//!   nothing below there. Within other patches a stretch that is not carried is a bridge if both
//!   its ends are, else an end that hangs; both are measured;
//! - a line whose core runs along another core of its layer is printed twice;
//! - a line that lies lower than a core of a layer before it falls: it runs into what is printed.
//!   This is possible only for lines below the highest line so far, so flat files do not pay for it;
//! - a layer whose walls are less high than it lies above the one below misses a layer between.
//!
//! A layer's lines raise the tops only when the layer is done: lines beside each other do not carry
//! each other.

use super::beads::place;
use super::capsule::Capsule;
use super::finding::{Code, Finding, Findings, short};
use super::moves::{ROUNDING, fallen};
use super::part::Part;
use super::raster::Grid;
use super::samples::{Sample, Samples};
use crate::reader::print::Step;
use crate::reader::{Print, Role};

/// Side of a pixel, mm: a quarter of a usual line. Larger ones miss lines between the samples.
const PITCH: f64 = 0.1;

/// Pixels of the map at most; larger beds get larger pixels.
const MOST_PIXELS: f64 = 2e7;

/// Part of a line's height that may be missing under it: less makes findings of rounded heights,
/// more hides a missing layer under a thick line.
const GAP: f64 = 0.5;

/// Part of its walls' height by which a layer may lie too high: variable heights are rounded,
/// a missing layer is a whole height.
const LEAST_GAP: f64 = 0.4;

/// Gap that may be between support and part, mm: it must come off. Two layers of 0.2 mm, and rounding.
const SUPPORT_GAP: f64 = 0.45;

/// A patch with shorter lines in all is ignored as a blob, mm.
const LEAST_PATCH: f64 = 4.0;

/// A line runs on another where their cores meet, which are this part of their widths: neighbours
/// overlap by less, turns of a zigzag by more, …
const CORE: f64 = 0.4;

/// … over this many mm; or over the share `WHOLE` of a line that is longer than `LEAST_WHOLE`.
const LEAST_TWICE: f64 = 10.0;
const LEAST_WHOLE: f64 = 2.0;
const WHOLE: f64 = 0.8;

/// Heights of lines that differ by less are the same, mm: positions are rounded to this or less.
const SAME_HEIGHT: f32 = 0.01;

/// Length behind the nozzle that does not count as laid, mm: a line may turn back within it.
const BEHIND: f64 = 1.5;

/// What was measured.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Measured {
    /// Longest stretch between two carried places, mm.
    pub(super) longest_bridge: f64,
    /// Longest end of a line that only the line itself and its neighbours hold, mm.
    pub(super) longest_end: f64,
    /// Length of lines that hang where the part itself hangs, mm.
    pub(super) part_hangs: f64,
}

/// Lays all lines of the layers down. Where `part` itself has nothing below, a hanging line is
/// only measured, and no finding.
pub(super) fn check(print: &Print, part: Option<&Part>, found: &mut Findings) -> Measured {
    let mut measured = Measured::default();
    let Some(mut pile) = Pile::over(print) else { return measured };
    let mut highest = 0.0_f64;
    for (layer, one) in print.layers.iter().enumerate() {
        gap(print, layer, found);
        pile.begin_layer();
        let steps = print.moves_of(one);
        let chains = steps.chunk_by(|a, b| a.is_line() && b.is_line() && a.to == b.from);
        let lines: Vec<Line> = chains
            .filter(|chain| chain[0].is_line())
            .map(|chain| pile.chain(chain, layer, found))
            .collect();
        let judge = Judge { layer, part };
        judge.patches(&lines, &mut pile, found, &mut measured);
        // A layer that falls as a whole is reported where moves are judged one by one.
        if let Some((fall, step)) = pile.fall.take().filter(|_| one.z >= highest - ROUNDING) {
            found.add(Finding { place: place(layer, &step), ..fallen(fall) });
        }
        highest = highest.max(one.z);
        steps.iter().filter(|step| step.is_line()).for_each(|step| pile.raise(step));
    }
    measured
}

/// Reports a layer whose walls are less high than it lies above the one below: a layer between is
/// missing. Only walls are compared, since infill may be as thick as several layers.
fn gap(print: &Print, layer: usize, found: &mut Findings) {
    let walls = |layer: usize| {
        let steps = print.moves_of(&print.layers[layer]).iter();
        steps.filter(|step| step.is_line() && step.role == Role::OuterWall)
    };
    let Some(below) = layer.checked_sub(1).filter(|_| print.has_heights) else { return };
    // A raft or support below ends lower on purpose.
    let (Some(first), Some(_)) = (walls(layer).next(), walls(below).next()) else { return };
    let height = walls(layer).map(|step| f64::from(step.height)).fold(0.0, f64::max);
    let missing = print.layers[layer].height - height;
    if missing > LEAST_GAP * height {
        let text = format!("the layer lies {} mm too high above the one before", short(missing));
        let finding = Finding::of(Code::InTheAir, missing, "mm", text);
        found.add(Finding { place: place(layer, first), ..finding });
    }
}

/// An unbroken line once it is laid.
struct Line {
    /// Its first piece.
    first: Step,
    /// mm.
    length: f64,
    /// Whether it is carried somewhere.
    carried: bool,
    /// Stretches that are not, but for bridges: those at its ends.
    ends: Vec<Vec<Sample>>,
    longest_bridge: f64,
}

/// Judges what hangs on a layer.
struct Judge<'a> {
    layer: usize,
    part: Option<&'a Part>,
}

impl Judge<'_> {
    fn patches(
        &self,
        lines: &[Line],
        pile: &mut Pile,
        found: &mut Findings,
        measured: &mut Measured,
    ) {
        let roots: Vec<usize> = (0..lines.len()).map(|line| pile.root(line)).collect();
        let mut carried = vec![false; lines.len()];
        let mut lengths = vec![0.0; lines.len()];
        for (line, &root) in lines.iter().zip(&roots) {
            carried[root] |= line.carried;
            lengths[root] += line.length;
        }
        for (k, (line, &root)) in lines.iter().zip(&roots).enumerate() {
            measured.longest_bridge = measured.longest_bridge.max(line.longest_bridge);
            if carried[root] {
                // Skins may begin and end between two lines of sparse infill.
                let longest = line.ends.iter().map(|end| length_of(end)).fold(0.0, f64::max);
                measured.longest_end = measured.longest_end.max(longest);
            } else if k == root && lengths[root] >= LEAST_PATCH {
                let whole = lines.iter().zip(&roots).filter(|(_, other)| **other == root);
                let ends = whole.flat_map(|(line, _)| line.ends.iter().flatten().copied());
                self.hangs(line, &ends.collect::<Vec<_>>(), found, measured);
            }
        }
    }

    /// Reports a patch that hangs, unless the part does.
    fn hangs(&self, line: &Line, places: &[Sample], found: &mut Findings, measured: &mut Measured) {
        let (by_part, own): (Vec<Sample>, Vec<Sample>) = places
            .iter()
            .partition(|place| self.part.is_some_and(|part| part.hangs(self.layer, place.at)));
        measured.part_hangs += length_of(&by_part);
        let length = length_of(&own);
        if length < LEAST_PATCH {
            return;
        }
        let what = line.first.role.name();
        let text = format!("{} mm of {what} have nothing under them", short(length));
        let finding = Finding::of(Code::InTheAir, length, "mm", text);
        let mut place = place(self.layer, &line.first);
        place.at_mm = Some(own[own.len() / 2].at.map(short));
        found.add(Finding { place, ..finding });
    }
}

fn length_of(places: &[Sample]) -> f64 {
    places.iter().map(|place| place.length).sum()
}

/// Plastic as it stands.
struct Pile {
    grid: Grid,
    /// How high it stands, mm; 0 is the bed.
    tops: Vec<f32>,
    /// Height of the nozzle when a line's middle was laid, mm.
    cores: Vec<f32>,
    /// The line that was laid there last, counted over all layers from 1.
    owners: Vec<u32>,
    /// The owner before the first line of this layer.
    owners_from: u32,
    /// For each line of the layer a line that it touches, and so on to the first of its patch.
    parents: Vec<usize>,
    /// The highest line of the layers before, mm.
    highest: f64,
    /// How deep a line of this layer lies in what the layers before have printed, mm, and the line
    /// that lies deepest.
    fall: Option<(f64, Step)>,
}

impl Pile {
    fn over(print: &Print) -> Option<Self> {
        let (low, high) = super::extent(print.lines())?;
        let grid = Grid::over(low, high, 0.5, PITCH, MOST_PIXELS);
        let count = grid.size[0] * grid.size[1];
        Some(Self {
            grid,
            tops: vec![0.0; count],
            cores: vec![0.0; count],
            owners: vec![0; count],
            owners_from: 0,
            parents: Vec::new(),
            highest: 0.0,
            fall: None,
        })
    }

    fn at<T: Copy>(&self, map: &[T], place: [f64; 2]) -> Option<T> {
        self.grid.pixel(place).map(|[x, y]| map[y * self.grid.size[0] + x])
    }

    /// Forgets which lines touch; those to come are of another layer.
    fn begin_layer(&mut self) {
        self.owners_from += self.parents.len() as u32;
        self.parents.clear();
    }

    /// The first line of the patch that a line of this layer belongs to.
    fn root(&mut self, mut line: usize) -> usize {
        while self.parents[line] != line {
            self.parents[line] = self.parents[self.parents[line]];
            line = self.parents[line];
        }
        line
    }

    /// Lays one unbroken line, of many straight pieces.
    fn chain(&mut self, chain: &[Step], layer: usize, found: &mut Findings) -> Line {
        let mut runs = Runs::default();
        let mut twice = Twice::default();
        let (mut behind, mut way_behind) = (0, 0.0);
        let mut length = 0.0;
        for step in chain {
            way_behind += step.length();
            while way_behind - chain[behind].length() > BEHIND {
                way_behind -= chain[behind].length();
                self.lay_core(&chain[behind]);
                behind += 1;
            }
            for place in Samples::of(step, self.grid.pitch) {
                length += place.length;
                self.find_fall(step, &place);
                twice.add(self.is_laid(step, place.at), place.length, step);
                runs.add(self.is_carried(step, &place), place);
            }
        }
        chain[behind..].iter().for_each(|step| self.lay_core(step));
        self.lay(chain);
        runs.end();
        for (long, step) in twice.ends(length) {
            let text = format!("{} mm of a line lie on another of the layer", short(long));
            let finding = Finding::of(Code::PrintedTwice, long, "mm", text);
            found.add(Finding { place: place(layer, &step), ..finding });
        }
        Line {
            first: chain[0],
            length,
            carried: runs.is_carried_before,
            ends: runs.ends,
            longest_bridge: runs.longest_bridge,
        }
    }

    /// Whether something below carries the line there.
    fn is_carried(&self, step: &Step, place: &Sample) -> bool {
        let height = f64::from(step.height);
        let needed = place.z - height - GAP * height.min(0.3);
        let side = f64::from(step.width) / 2.0;
        [0.0, -side / 2.0, side / 2.0, -side, side].into_iter().any(|off| {
            let at = [place.at[0] + off * place.across[0], place.at[1] + off * place.across[1]];
            self.at(&self.tops, at).is_none_or(|top| f64::from(top) >= needed - 1e-3)
        })
    }

    /// Whether the middle of another line of this layer lies there.
    fn is_laid(&self, step: &Step, at: [f64; 2]) -> bool {
        let core = self.at(&self.cores, at).unwrap_or(0.0);
        core > 0.0 && (core - middle(step)).abs() < SAME_HEIGHT
    }

    /// Notes how far a place of a line lies below the nozzle's way there in a layer before. Flat
    /// layers, which all lie above those before, need no search.
    fn find_fall(&mut self, step: &Step, place: &Sample) {
        if place.z >= self.highest - ROUNDING {
            return;
        }
        let is_of_layer = self.at(&self.owners, place.at).is_none_or(|one| one > self.owners_from);
        let fall = f64::from(self.at(&self.cores, place.at).unwrap_or(0.0)) - place.z;
        if !is_of_layer && fall > self.fall.map_or(ROUNDING, |(most, _)| most) {
            self.fall = Some((fall, *step));
        }
    }

    /// Lays a line down, and joins it to the lines of this layer that it touches.
    fn lay(&mut self, chain: &[Step]) {
        // Lines of the layer are counted from 0, owners over all layers from 1.
        let line = self.parents.len();
        self.parents.push(line);
        let owner = self.owners_from + self.parents.len() as u32;
        let mut touched: Vec<u32> = Vec::new();
        let width = self.grid.size[0];
        for step in chain {
            let (owners, before) = (&mut self.owners, self.owners_from);
            Capsule::of(step, 1.0).rows(&self.grid, |y, span| {
                let row = y * width;
                // Lines that lie side by side touch at a pixel more.
                let beside = row + span.start.saturating_sub(1)..row + (span.end + 1).min(width);
                for known in &mut owners[beside] {
                    if *known > before && *known != owner && touched.last() != Some(known) {
                        touched.push(*known);
                    }
                    *known = owner;
                }
            });
        }
        touched.sort_unstable();
        touched.dedup();
        for other in touched {
            let (a, b) = (self.root(line), self.root((other - 1 - self.owners_from) as usize));
            self.parents[a.max(b)] = a.min(b);
        }
    }

    /// Lets plastic stand where a line was laid, once its layer is done: lines beside it are not
    /// carried by it.
    fn raise(&mut self, step: &Step) {
        let extra = if step.role == Role::Support { SUPPORT_GAP as f32 } else { 0.0 };
        let top = step.from[2].max(step.to[2]) + extra;
        self.highest = self.highest.max(step.heights()[1]);
        let (width, tops) = (self.grid.size[0], &mut self.tops);
        Capsule::of(step, 1.0).rows(&self.grid, |y, span| {
            for known in &mut tops[y * width..][span] {
                *known = known.max(top);
            }
        });
    }

    fn lay_core(&mut self, step: &Step) {
        let (width, cores, z) = (self.grid.size[0], &mut self.cores, middle(step));
        Capsule::of(step, CORE).rows(&self.grid, |y, span| cores[y * width..][span].fill(z));
    }
}

/// Height of the nozzle in the middle of a line, mm.
fn middle(step: &Step) -> f32 {
    0.5 * (step.from[2] + step.to[2])
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
        self.found.extend(self.last.take().map(|step| (self.length, step)));
        self.length = 0.0;
    }

    /// Those that are long, or nearly all of the line, which is `all` mm long.
    fn ends(mut self, all: f64) -> Vec<(f64, Step)> {
        self.end();
        let least = LEAST_TWICE.min((WHOLE * all).max(LEAST_WHOLE));
        self.found.retain(|(length, _)| *length >= least);
        self.found
    }
}
