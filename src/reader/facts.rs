//! Events -> Facts: what is known of a G-code file as a whole, without its moves.
//!
//! Words used here: a *move* is a straight way of the nozzle; a *line* is a move that goes sideways and
//! extrudes; a *segment* is all moves from the beginning of one layer to that of the next; a *value*
//! is `key = value` in a comment.
//!
//! Segments become layers:
//! - by the file's comments if any marks a layer, else by the heights of lines (see `layers`). What
//!   comes before the first mark is no layer: what heights told until then is forgotten;
//! - a segment without a line is no layer: its moves belong to the one before;
//! - a layer lies where most of its lines do (see `height`), or where a comment says (`;Z:`) if they lie at
//!   several heights, or fell within it; it is as high as it lies above the layer before;
//! - the lines of a patch of non-planar skin belong to the layer in which they stand, and say nothing of
//!   its height. A patch without other lines belongs to the layer before.
//!
//! A line without a comment is as high as its layer rises, with an exception. Where layers of support lie
//! between those of the part, and on rafts, a layer's lines are higher or lower than it rises. They
//! show it by their plastic: the layer's takes as many times the usual room as its rise is less than
//! the usual one.
//!
//! Nothing here grows with the number of moves or lines; what a file may have many of is bounded.

use super::priming::{self, Priming};
use super::step::{Layer, Step};
use super::told::{self, LongWait, Told};
use super::{Event, Heights, Motion, Role, Summary};
use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::ops::Range;

/// Longest part of a comment that is kept, bytes: the longest settings are lists of a few hundred.
const LONGEST_COMMENT: usize = 4096;

/// Comments of a file that are kept: more than any slicer writes settings; and their bytes.
const MOST_COMMENTS: usize = 10_000;
const MOST_BYTES: usize = 1 << 22;

/// Different commands that are kept: firmwares know some hundreds.
const MOST_COMMANDS: usize = 10_000;

/// Patches of skin that are kept: a print has tens.
const MOST_PATCHES: usize = 100_000;

/// Heights that differ by less are the same, mm.
const SAME_HEIGHT: f64 = 1e-4;

/// Heights in comments have thousandths, mm.
const FALLEN: f64 = 2e-3;

/// Keys under which slicers write the filament's diameter, mm.
const DIAMETER_KEYS: &[&str] = &["filament.diameter", "filament_diameter"];

/// Diameters that a filament may have, mm.
const DIAMETERS: std::ops::RangeInclusive<f64> = 0.1..=10.0;

/// Height of a line where neither a comment nor a layer below gives one, mm: the most usual one.
const SOME_HEIGHT: f64 = 0.2;

/// No line is higher than this, mm: twice what the widest nozzles print. A layer that lies higher
/// above the one before, or above the bed, hangs.
const HIGHEST: f64 = 2.0;

/// How many times the usual room the lines of a layer take, at least or as a share at most, to be
/// higher or lower than the layer rises.
const OTHER_ROOM: f64 = 1.6;

/// How near that has to bring the layer's rise to the usual one, as a share.
const NEAR_USUAL: f64 = 0.25;

/// A patch of non-planar skin between its marks.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Patch {
    /// Its number in the file; a patch may come in several pieces.
    pub number: u32,
    /// Its part of the file's moves, travels to and on it among them.
    pub moves: Range<usize>,
    /// The lines of the file between its marks, from 1; the last is not in it.
    pub lines: Range<u64>,
}

/// What is known of a file as a whole.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Facts {
    /// Moves before the first layer: the start block and what it draws.
    pub start: Range<usize>,
    /// The layers from the bed up. Each ends where the next begins; the last
    /// holds what comes after the print as well.
    pub layers: Vec<Layer>,
    /// Patches of non-planar skin, in the file's order; some may be a layer's.
    pub patches: Vec<Patch>,
    /// Moves in all.
    pub move_count: usize,
    /// Place in the moves after the last line; 0 without one.
    pub last_line: usize,
    /// Roles that moves have, by [`Role::ALL`].
    pub roles: [bool; Role::ALL.len()],
    /// `key = value` in comments: settings and sums that slicers write, in the file's order.
    pub values: Vec<(String, String)>,
    /// Commands that occur, but for moves: letter and number -> the first line with it.
    pub commands: BTreeMap<(u8, u32), u64>,
    /// Limits that the file tells the machine, each value once, in the file's order.
    pub limits: Vec<Told>,
    /// Long waits (G4), in the file's order.
    pub waits: Vec<LongWait>,
    /// The file's first comments, up to the first line that is something else.
    pub head: Vec<String>,
    /// Whether comments mark where layers begin.
    pub marked: bool,
    /// Layers that begin, those without a line included.
    pub begun: usize,
    /// Whether comments give widths of lines.
    pub has_widths: bool,
    /// Whether comments give heights of lines.
    pub has_heights: bool,
    /// Diameter of the filament, mm: the file's own, else what the caller gave.
    pub filament_diameter: f64,
    /// How high lines of each layer are that no comment tells, mm; empty if all are as high as their
    /// layer rises.
    line_heights: Vec<f64>,
    /// By how much filament is multiplied that was read before the file said its diameter.
    scale: Option<f32>,
    /// What was read besides the moves.
    pub summary: Summary,
}

impl Facts {
    /// The last of the values with this key.
    #[must_use]
    pub fn value(&self, key: &str) -> Option<&str> {
        self.values.iter().rev().find(|(known, _)| known == key).map(|(_, value)| value.as_str())
    }

    /// Whether some move has this role.
    #[must_use]
    pub fn has(&self, role: Role) -> bool {
        self.roles[role as usize]
    }

    /// The patch that a line of the file is in, from 1.
    #[must_use]
    pub fn patch_at(&self, line: u64) -> Option<&Patch> {
        let after = self.patches.partition_point(|patch| patch.lines.start <= line);
        let patch = self.patches.get(after.checked_sub(1)?)?;
        patch.lines.contains(&line).then_some(patch)
    }

    /// How high layers are by the file's settings or head, mm.
    fn told_height(&self) -> Option<f64> {
        let in_head = || self.head.iter().find_map(|text| text.strip_prefix("Layer height:"));
        let told = self.value("layer_height").or_else(in_head)?;
        told.trim().parse().ok().filter(|height| (0.01..HIGHEST).contains(height))
    }

    /// Cross-section of the filament, mm².
    fn area(&self) -> f64 {
        PI * self.filament_diameter * self.filament_diameter / 4.0
    }

    /// Fills in what comments do not give of moves, the first of which is move `first` of the file.
    pub(super) fn measure(&self, first: usize, moves: &mut [Step]) {
        if let Some(scale) = self.scale {
            moves.iter_mut().for_each(|step| step.filament *= scale);
        }
        let area = self.area();
        let mut next = self.layers.partition_point(|layer| layer.moves.end <= first);
        let mut index = first;
        let mut rest = moves;
        while !rest.is_empty() {
            let (height, end) = match self.layers.get(next) {
                Some(layer) if layer.moves.start <= index => {
                    let own = self.line_heights.get(next).copied().unwrap_or(layer.height);
                    next += 1;
                    (if own > HIGHEST { SOME_HEIGHT } else { own }, layer.moves.end)
                }
                Some(layer) => (SOME_HEIGHT, layer.moves.start),
                None => (SOME_HEIGHT, usize::MAX),
            };
            let (some, after) = rest.split_at_mut(rest.len().min(end - index));
            index += some.len();
            some.iter_mut().for_each(|step| step.measure(height, area));
            rest = after;
        }
    }
}

/// Gathers the facts of a file, event by event.
#[derive(Default)]
pub(super) struct Gatherer {
    facts: Facts,
    /// Where the segment begins that goes on; `None` before the first.
    segment: Option<usize>,
    /// Heights of its lines, and their length and filament, mm.
    heights: Heights,
    drawn: [f64; 2],
    /// Height of the level lines that the segment was found by, mm.
    found: Option<f64>,
    /// Its height by a comment, and how high that says its lines are, mm.
    told: Option<f64>,
    told_rise: Option<f64>,
    /// Whether it has a line that lies lower than told, and is lower itself by as much: it fell within its layer.
    has_fallen: bool,
    /// Whether a patch of skin goes on.
    is_in_patch: bool,
    /// Filament for each mm of the lines of each layer, mm.
    flows: Vec<f64>,
    /// How many lines it has, and how many the first layer has.
    lines: usize,
    first_lines: usize,
    /// The lines with which the first layer begins, and the length and filament of all of it, mm.
    priming: Priming,
    first_drawn: [f64; 2],
    /// Height of the layer before, mm.
    below: f64,
    /// Height of the lowest layer so far, mm.
    lowest: Option<f64>,
    /// Whether the head has ended.
    past_head: bool,
    /// Bytes of comments that are kept.
    bytes: usize,
}

impl Gatherer {
    pub(super) fn event(&mut self, line: u64, event: &Event) {
        match event {
            Event::Move(motion) => self.motion(line, motion),
            Event::Layer { marked, z } => self.begin(*marked, *z),
            Event::Patch(number) => self.patch(line, *number),
            Event::Command { letter, number, .. } => {
                let commands = &mut self.facts.commands;
                if commands.len() < MOST_COMMANDS {
                    commands.entry((*letter, *number)).or_insert(line);
                }
            }
            Event::Change(change) => {
                told::add(&mut self.facts.limits, change, (line, self.facts.move_count));
            }
            Event::Dwell(seconds) => {
                told::wait(&mut self.facts.waits, *seconds, (line, self.facts.move_count));
            }
            Event::Comment(comment) => return self.comment(comment),
            _ => {}
        }
        self.past_head = true;
    }

    fn motion(&mut self, line: u64, motion: &Motion) {
        let facts = &mut self.facts;
        facts.has_widths |= motion.width.is_some();
        facts.has_heights |= motion.height.is_some();
        facts.roles[motion.role as usize] = true;
        facts.move_count += 1;
        // What is told where the layer begins.
        self.told_rise = self.told_rise.or(self.told.and(motion.height));
        let step = Step::of(line, motion);
        if step.is_line() {
            facts.last_line = facts.move_count;
            if self.segment.is_some() && motion.role != Role::NonPlanar {
                self.lines += 1;
                self.heights.add([step.from[2], step.to[2]].map(f64::from), step.length());
                self.drawn[0] += step.length();
                self.drawn[1] += f64::from(step.filament);
                if facts.layers.is_empty() {
                    let drawn = [step.length(), f64::from(step.filament)];
                    self.priming.line(facts.move_count, drawn);
                }
                self.has_fallen |= self.falls(&step, motion.height);
            }
        }
    }

    /// Whether a line of this height ends below the top of its layer, on the layer below.
    fn falls(&self, step: &Step, height: Option<f64>) -> bool {
        let (Some(told), Some(rise), Some(height)) = (self.told, self.told_rise, height) else {
            return false;
        };
        let by = told - f64::from(step.to[2]);
        by > FALLEN && (rise - height - by).abs() < FALLEN
    }

    /// A patch of skin begins or ends.
    fn patch(&mut self, line: u64, number: Option<u32>) {
        self.end_patch(line);
        let facts = &mut self.facts;
        if let Some(number) = number.filter(|_| facts.patches.len() < MOST_PATCHES) {
            let moves = facts.move_count..facts.move_count;
            facts.patches.push(Patch { number, moves, lines: line..u64::MAX });
            self.is_in_patch = true;
        }
    }

    /// The patch that goes on ends at this line of the file.
    fn end_patch(&mut self, line: u64) {
        if std::mem::take(&mut self.is_in_patch)
            && let Some(last) = self.facts.patches.last_mut()
        {
            (last.moves.end, last.lines.end) = (self.facts.move_count, line);
        }
    }

    /// A layer begins, by level lines at height `z` if it was found by such, mm.
    fn begin(&mut self, marked: bool, z: Option<f64>) {
        let facts = &mut self.facts;
        if facts.marked && !marked {
            return;
        }
        if facts.marked || !marked {
            self.end();
        } else {
            // The first mark: what heights told is part of the start.
            (facts.layers, facts.begun) = (Vec::new(), 0);
            (self.heights, self.below) = (Heights::default(), 0.0);
            (self.drawn, self.flows) = ([0.0; 2], Vec::new());
            (self.lines, self.lowest) = (0, None);
            self.priming = Priming::default();
        }
        let facts = &mut self.facts;
        facts.marked |= marked;
        facts.begun += 1;
        (self.found, self.told, self.told_rise) = (z, None, None);
        self.has_fallen = false;
        self.segment = Some(facts.move_count);
    }

    /// Ends the segment that goes on.
    fn end(&mut self) {
        let Some(first) = self.segment else { return };
        let facts = &mut self.facts;
        let (end, last) = (facts.move_count, facts.layers.last_mut());
        let [length, filament] = std::mem::take(&mut self.drawn);
        let heights = std::mem::take(&mut self.heights);
        let told = self.told.take().filter(|_| self.has_fallen || !heights.is_one());
        let Some(z) = heights.height(self.found) else {
            if let Some(last) = last {
                last.moves.end = end;
            }
            return;
        };
        // Lines of a top may all rise and fall within their layer.
        let is_near = |told: &f64| *told > self.below && (told - z).abs() < told - self.below;
        let z = told.filter(is_near).unwrap_or(z);
        let lowest = self.lowest.unwrap_or(HIGHEST);
        let lines = std::mem::take(&mut self.lines);
        if last.is_none() {
            (self.first_lines, self.first_drawn) = (lines, [length, filament]);
        }
        let height = match (z - self.below, last) {
            (rise, _) if rise > SAME_HEIGHT => rise,
            // The first layer of another part lies on the bed as well.
            (rise, _) if rise < -SAME_HEIGHT && 0.0 < z && z <= lowest + SAME_HEIGHT => z,
            // At the height of the layer before.
            (_, Some(last)) => last.height,
            (_, None) => SOME_HEIGHT,
        };
        (self.below, self.lowest) = (z, Some(lowest.min(z)));
        facts.layers.push(Layer { moves: first..end, z, height });
        self.flows.push(filament / length);
    }

    fn comment(&mut self, comment: &[u8]) {
        let short = &comment[..comment.len().min(LONGEST_COMMENT)];
        if let Some(z) = short.trim_ascii().strip_prefix(b"Z:") {
            self.told = std::str::from_utf8(z).ok().and_then(|z| z.trim().parse().ok());
        }
        if self.bytes + short.len() > MOST_BYTES {
            return;
        }
        let text = || String::from_utf8_lossy(short).trim().to_owned();
        let facts = &mut self.facts;
        if !self.past_head && facts.head.len() < MOST_COMMENTS {
            self.bytes += short.len();
            facts.head.push(text());
        }
        if short.windows(3).any(|three| three == b" = ") && facts.values.len() < MOST_COMMENTS {
            let text = text();
            if let Some((key, value)) = text.split_once(" = ") {
                self.bytes += short.len();
                facts.values.push((key.trim().to_owned(), value.trim().to_owned()));
            }
        }
    }

    /// Whether the first layer of a file without marks is but the few lines with which a start block
    /// primes the nozzle, higher than the part's first layer.
    fn has_priming(&self) -> bool {
        let [first, next, ..] = &self.facts.layers[..] else { return false };
        let is_higher = next.z < first.z - SAME_HEIGHT;
        !self.facts.marked && is_higher && self.first_lines <= priming::MOST_LINES
    }

    /// Where in the moves of a file without marks the first layer begins after what primes the nozzle at its height,
    /// and what it draws from there on, if anything primes there.
    fn primed(&self) -> Option<(usize, [f64; 2])> {
        let is_unmarked = !self.facts.marked && !self.facts.layers.is_empty();
        is_unmarked.then(|| self.priming.end(self.first_drawn))?
    }

    /// The facts, at the file's end. `diameter`, mm, is that of the filament if the file gives none.
    pub(super) fn facts(mut self, summary: Summary, diameter: f64) -> Facts {
        self.end();
        self.end_patch(u64::MAX);
        if self.has_priming() {
            self.facts.layers.remove(0);
            self.flows.remove(0);
            self.facts.begun -= 1;
        } else if let Some((end, [length, filament])) = self.primed() {
            self.facts.layers[0].moves.start = end;
            self.flows[0] = filament / length;
        }
        let mut facts = self.facts;
        facts.summary = summary;
        let own = DIAMETER_KEYS.iter().find_map(|key| facts.value(key)?.parse().ok());
        facts.filament_diameter = own.filter(|own| DIAMETERS.contains(own)).unwrap_or(diameter);
        // Read before the file said its diameter, which stands at its end.
        if summary.volumes_by > 0.0 {
            let area = facts.area();
            facts.scale = Some((summary.volumes_by / area) as f32);
            facts.summary.volumes_by = area;
        }
        if !facts.has_widths && !facts.has_heights {
            facts.line_heights = line_heights(
                (&facts.layers, &self.flows),
                facts.told_height(),
                facts.has(Role::OuterWall),
            );
        }
        let first = facts.layers.first();
        facts.start = 0..first.map_or(facts.move_count, |layer| layer.moves.start);
        facts
    }
}

/// How high lines of each layer are by their plastic, mm; empty if all are as high as their layer rises.
/// `told` is what the file says of it, mm.
fn line_heights(
    (layers, flows): (&[Layer], &[f64]),
    told: Option<f64>,
    has_roles: bool,
) -> Vec<f64> {
    let usual = told.unwrap_or_else(|| median(layers.iter().map(|layer| layer.height).collect()));
    let widths =
        || layers.iter().zip(flows).map(|(layer, flow)| (layer.height, flow / layer.height));
    let is_usual = |rise: f64| (rise - usual).abs() <= NEAR_USUAL * usual;
    let usual_width =
        median(widths().filter(|(rise, _)| is_usual(*rise)).map(|two| two.1).collect());
    let own = |(rise, width): (f64, f64)| {
        let times = width / usual_width;
        // Where nobody knows which lines are a raft, the first on it are taken to reach down to it.
        let is_other = times > OTHER_ROOM || (has_roles && times < 1.0 / OTHER_ROOM);
        if is_other && is_usual(rise * times) { usual } else { rise }
    };
    let heights: Vec<f64> = widths().map(own).collect();
    let all_rise = heights.iter().zip(layers).all(|(height, layer)| *height == layer.height);
    if all_rise { Vec::new() } else { heights }
}

/// The middle one by their order; 0 of none.
fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or_default()
}
