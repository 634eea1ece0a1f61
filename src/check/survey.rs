//! Layers as they come -> Survey: what must be known of all of them before any is judged.
//!
//! Words used here: a layer's *floor* is how low its lines and those of all layers above reach; its
//! *gap* is how much higher it lies above the layer below than its walls are; a *stray* is a line
//! so far from its layer's height that it is judged with the layers it lies at, as all lines of
//! non-planar skin are; what is *usual* is the middle one of all by their order (the median).
//!
//! A layer of strays alone that does not lie above the one before is a skin that a file calls a layer.
//!
//! A few numbers a layer are kept, and no moves, but for strays, which are rare, and a few layers by
//! which the part is laid where it was printed. What is usual is found by counting in narrow classes, a
//! part in four thousand wide, instead of keeping all values.

use super::beads::{self, Usual};
use super::belongs::{SOME_WIDTH, is_of_part, is_stray, pieces};
use super::capsule::Capsule;
use super::model::part::extent_of;
use super::terms::Terms;
use super::window::{Page, Pages};
use crate::reader::print::{Note, Step, What};
use crate::reader::{Facts, Role};
use crate::units::Bounded as _;
use std::collections::BTreeMap;

/// Layers on which is looked where the part lies, spread over the print.
const LAYERS_LOOKED_AT: usize = 16;

/// Part of its walls' height by which a layer may lie too high: variable heights are rounded,
/// a missing layer is a whole height.
const LEAST_GAP: f64 = 0.4;

/// How far heights of lines and layers may be rounded apart, mm.
const ROUNDED: f64 = 0.02;

/// The least distance of two cuts, mm.
const APART: f64 = 1e-3;

/// Share of a layer's lines that are level at its height, unless it is a skin over a slope.
const LEAST_LEVEL: f64 = 0.25;

/// Lowest and highest x and y, mm.
pub(super) type Extent = Option<([f64; 2], [f64; 2])>;

/// What is known of the layers; lists have a value for each.
#[derive(Debug, Default)]
pub(super) struct Survey {
    /// How high outer walls are at most, mm; 0 without one.
    walls: Vec<f64>,
    /// How high its lines are where no comment tells what they are for, mm; else 0.
    lines: Vec<f64>,
    /// How high it is for the part, mm.
    pub(super) heights: Vec<f64>,
    /// See the words of this file, mm.
    pub(super) gaps: Vec<f64>,
    pub(super) floors: Vec<f64>,
    /// As the floors, but with strays, mm.
    pub(super) depths: Vec<f64>,
    /// How low lines of the part reach, mm; endless without one.
    pub(super) bottoms: Vec<f64>,
    /// Whether it is support alone, between two layers of the part that lie on one another.
    pub(super) between: Vec<bool>,
    /// What outer walls cover, or else lines of the part.
    pub(super) outlines: Vec<Extent>,
    /// Whether it is no layer, but a skin over those before.
    pub(super) is_skin: Vec<bool>,
    /// What of lines of any layer that stray lies at its height.
    pub(super) strays: Vec<Vec<Step>>,
    /// What all lines cover; those of the part, those before the layers included.
    pub(super) extent: Extent,
    pub(super) part: Extent,
    /// Where ends of lines of walls and skins lie, and of support.
    pub(super) solid: Extent,
    pub(super) support: Extent,
    /// The highest line, mm.
    pub(super) top: f64,
    /// Filament of the lines of the layers, mm.
    pub(super) filament: f64,
    /// Filament up to the last line as the file asks for it, without M221's factor; of the whole file and from
    /// the first layer on, mm.
    pub(super) used: [f64; 2],
    /// Usual width of outer walls, mm.
    pub(super) line_width: f64,
    /// Usual plastic of lines of each role by their size, if there are enough.
    pub(super) usual: [Option<Usual>; Role::ALL.len()],
    /// Some layers, spread over the print.
    pub(super) looked_at: Vec<(usize, Vec<Step>)>,
}

/// M221's factor of each tool, and the tool in use.
#[derive(Debug)]
struct Flow {
    factors: [f64; 2],
    tool: usize,
}

impl Flow {
    const UNTOLD: Self = Self { factors: [1.0; 2], tool: 0 };

    fn note(&mut self, note: &Note) {
        let What::Command(order) = &note.what else { return };
        let named = |letter: u8| order.value(letter).map(|tool| usize::from(tool >= 1.0));
        match (order.letter, order.number) {
            (b'T', tool) => self.tool = (tool as usize).min(1),
            (b'M', 108 | 135) => self.tool = named(b'T').unwrap_or(self.tool),
            (b'M', 221) => {
                let tool = named(b'T').or(named(b'D')).unwrap_or(self.tool);
                let percent = order.value(b'S').filter(|percent| *percent > 0.0);
                self.factors[tool] = percent.map_or(self.factors[tool], |percent| percent / 100.0);
            }
            _ => {}
        }
    }
}

/// Values counted in narrow classes.
#[derive(Debug, Default)]
struct Counted {
    /// How many there are of each class, and the first of them.
    classes: BTreeMap<u32, (u64, f64)>,
    /// The class of the last ones, which are not among those yet.
    last: Option<(u32, (u64, f64))>,
    count: u64,
}

impl Survey {
    pub(super) fn new<E>(facts: &Facts, terms: &Terms, pages: Pages<'_, E>) -> Result<Self, E> {
        let strays = vec![Vec::new(); facts.layers.len()];
        let mut survey = Self { strays, ..Self::default() };
        let mut plastic: [[Counted; 2]; Role::ALL.len()] = Default::default();
        let (mut widths, mut flow) = (Counted::default(), Flow::UNTOLD);
        let every = facts.layers.len().div_ceil(LAYERS_LOOKED_AT).max(1);
        for page in pages {
            let page = page?;
            survey.count(facts, &page, &mut flow);
            survey.page(facts, &page);
            let Some(layer) = page.layer else { continue };
            for step in page.moves.iter().filter(|step| step.is_line()) {
                if step.role == Role::OuterWall {
                    widths.add(f64::from(step.width));
                }
                if beads::is_judged(step) {
                    let [ratio, thick] = &mut plastic[step.role as usize];
                    ratio.add(beads::ratio(facts, terms, step));
                    thick.add(beads::thick(terms, step));
                }
            }
            if layer % every == 0 {
                survey.looked_at.push((layer, page.moves.into_owned()));
            }
        }
        for lows in [&mut survey.floors, &mut survey.depths] {
            let mut floor = f64::INFINITY;
            for own in lows.iter_mut().rev() {
                floor = floor.min(*own);
                *own = floor;
            }
        }
        survey.set_heights(facts);
        survey.line_width = widths.median().unwrap_or(SOME_WIDTH);
        survey.usual = plastic.map(|[ratio, thick]| {
            let enough = ratio.count >= beads::LEAST_LINES;
            let usual = |ratio| Some(Usual { ratio, thick: thick.median()? });
            ratio.median().filter(|_| enough).and_then(usual)
        });
        Ok(survey)
    }

    /// How high layers are for the part: where layers of support alone lie between two of its own, as high
    /// as they lie above the part's one below. A layer above a gap is no higher than its lines.
    fn set_heights(&mut self, facts: &Facts) {
        self.between = between(facts, &self.bottoms);
        let mut below = 0.0;
        for (k, (layer, walls)) in facts.layers.iter().zip(&self.walls).enumerate() {
            let is_above = k > 0 && self.between[k - 1] && !self.between[k];
            let own = if self.lines[k] > layer.height { self.lines[k] } else { layer.height };
            let rise = if is_above { layer.z - below } else { own };
            let missing = rise - walls;
            let is_gap = facts.has_heights && *walls > 0.0 && missing > LEAST_GAP * walls;
            let gap = if is_gap { missing } else { 0.0 };
            self.gaps.push(gap);
            self.heights.push(rise - gap);
            if !self.between[k] {
                below = layer.z;
            }
        }
        // Cuts rise: that of support alone lies below the next one of the part.
        let mut above = f64::INFINITY;
        for (k, layer) in facts.layers.iter().enumerate().rev() {
            let cut = layer.z - self.heights[k] / 2.0;
            if self.between[k] && cut >= above - APART {
                self.heights[k] = 2.0 * (layer.z - (above - APART));
            }
            above = layer.z - self.heights[k] / 2.0;
        }
    }

    /// Whether lines go over slopes: some are of a patch, or stray from their layers.
    pub(super) fn has_slopes(&self, facts: &Facts) -> bool {
        !facts.patches.is_empty() || self.strays.iter().any(|strays| !strays.is_empty())
    }

    /// Whether a layer has an outer wall.
    pub(super) fn has_walls(&self, layer: usize) -> bool {
        self.walls[layer] > 0.0
    }

    /// Counts the filament that a page asks for. `flow` goes on from page to page.
    fn count(&mut self, facts: &Facts, page: &Page<'_>, flow: &mut Flow) {
        let mut notes = page.notes.iter().peekable();
        for (index, step) in (page.first..facts.last_line).zip(page.moves.iter()) {
            while let Some(note) = notes.next_if(|note| note.at <= index) {
                flow.note(note);
            }
            let asked = f64::from(step.filament) / flow.factors[flow.tool];
            self.used[0] += asked;
            self.used[1] += if page.layer.is_some() { asked } else { 0.0 };
        }
        notes.for_each(|note| flow.note(note));
    }

    fn page(&mut self, facts: &Facts, page: &Page<'_>) {
        let has_roles = facts.has(Role::OuterWall);
        let (mut walls, mut floor, mut bottom) = (0.0_f64, f64::INFINITY, f64::INFINITY);
        let (mut lines, mut depth) = (0.0_f64, f64::INFINITY);
        let is_skin = page.layer.is_some_and(|layer| is_skin(facts, layer, &page.moves));
        let (mut of_walls, mut of_part) = (None, None);
        for step in page.moves.iter() {
            if !step.is_line() {
                continue;
            }
            let covered = Capsule::of(step, 1.0).extent();
            let is_of = is_of_part(step, has_roles);
            if is_of {
                self.part = both(self.part, Some(covered));
                of_part = both(of_part, Some(covered));
            }
            let Some(layer) = page.layer else { continue };
            self.filament += f64::from(step.filament);
            self.extent = both(self.extent, Some(covered));
            let ends = || extent_of([step.from, step.to].map(flat).into_iter());
            match step.role {
                Role::OuterWall | Role::InnerWall | Role::Skin => {
                    self.solid = both(self.solid, ends())
                }
                Role::Support => self.support = both(self.support, ends()),
                _ => {}
            }
            let low = step.heights()[0] - f64::from(step.height);
            depth = depth.min(low);
            self.top = self.top.max(step.heights()[1]);
            if self.stray(facts, (layer, is_skin), step) {
                continue;
            }
            floor = floor.min(low);
            if is_of_part(step, true) {
                bottom = bottom.min(low);
            }
            lines = lines.max(if has_roles { 0.0 } else { f64::from(step.height) });
            if step.role == Role::OuterWall {
                walls = walls.max(reach(facts, page.layer, step));
                of_walls = both(of_walls, Some(covered));
            }
        }
        if page.layer.is_some() {
            self.walls.push(walls);
            self.lines.push(lines);
            self.floors.push(floor);
            self.depths.push(depth);
            self.is_skin.push(is_skin);
            self.bottoms.push(bottom);
            self.outlines.push(of_walls.or(of_part));
        }
    }
}

impl Survey {
    /// Puts a line of a layer that strays, as all of a skin do, where it lies; whether it does.
    fn stray(&mut self, facts: &Facts, (layer, is_skin): (usize, bool), step: &Step) -> bool {
        let strays = is_skin || is_stray(step, &facts.layers[layer]);
        if strays {
            for (at, piece) in pieces(step, &facts.layers) {
                self.strays[at].push(piece);
            }
        }
        strays
    }
}

/// Whether a layer that does not lie above the one before has next to no level line at its height.
fn is_skin(facts: &Facts, layer: usize, moves: &[Step]) -> bool {
    let own = &facts.layers[layer];
    let is_above = layer.checked_sub(1).is_none_or(|below| own.z > facts.layers[below].z + APART);
    if is_above {
        return false;
    }
    let (mut level, mut all) = (0.0, 0.0);
    for step in moves.iter().filter(|step| step.is_line()) {
        all += step.length();
        if step.heights().iter().all(|z| (z - own.z).abs() < APART) {
            level += step.length();
        }
    }
    level < LEAST_LEVEL * all
}

/// How far below its layer's height a wall reaches: its own height, unless it lies lower or higher as those
/// on a slope may.
fn reach(facts: &Facts, layer: Option<usize>, step: &Step) -> f64 {
    let (height, top) = (f64::from(step.height), step.heights()[0]);
    let level = layer.map_or(top, |layer| facts.layers[layer].z);
    if (top - level).abs() < ROUNDED { height } else { height + level - top }
}

fn flat(at: [f32; 3]) -> [f64; 2] {
    [f64::from(at[0]), f64::from(at[1])]
}

/// Which layers are support alone between two of the part, the upper of which lies on the lower.
fn between(facts: &Facts, bottoms: &[f64]) -> Vec<bool> {
    let mut between = vec![false; bottoms.len()];
    let mut below = None;
    for (k, layer) in facts.layers.iter().enumerate() {
        let Some(last) = below.filter(|last| last + 1 < k && bottoms[k].is_finite()) else {
            below = if bottoms[k].is_finite() { Some(k) } else { below };
            continue;
        };
        let top = facts.layers[last].z;
        if bottoms[k] <= top + ROUNDED && layer.z > top {
            between[last + 1..k].fill(true);
        }
        below = Some(k);
    }
    between
}

/// What either covers.
pub(super) fn both(a: Extent, b: Extent) -> Extent {
    let (Some((low, high)), Some((from, to))) = (a, b) else { return a.or(b) };
    let lower = [low[0].at_most(from[0]), low[1].at_most(from[1])];
    Some((lower, [high[0].at_least(to[0]), high[1].at_least(to[1])]))
}

impl Counted {
    /// Bits of a double of 32 bits that a class leaves open: it is 1/4096 wide.
    const OPEN: u32 = 11;

    fn add(&mut self, value: f64) {
        let class = (value as f32).to_bits() >> Self::OPEN;
        self.count += 1;
        match &mut self.last {
            // Most lines are like the one before.
            Some((last, (count, _))) if *last == class => *count += 1,
            _ => {
                if let Some(last) = self.last.replace((class, (1, value))) {
                    Self::put(&mut self.classes, last);
                }
            }
        }
    }

    fn put(classes: &mut BTreeMap<u32, (u64, f64)>, (class, more): (u32, (u64, f64))) {
        classes.entry(class).and_modify(|(count, _)| *count += more.0).or_insert(more);
    }

    /// One of the class of the middle one of all by their order.
    fn median(mut self) -> Option<f64> {
        if let Some(last) = self.last {
            Self::put(&mut self.classes, last);
        }
        let mut below = 0;
        let class = self.classes.into_values().find(|(count, _)| {
            below += count;
            below > self.count / 2
        });
        class.map(|(_, value)| value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_middle_one_is_found_by_counting() {
        assert_eq!(Counted::default().median(), None);
        let mut counted = Counted::default();
        for k in 1..=99 {
            counted.add(f64::from((k * 37) % 100) / 100.0);
        }
        let median = counted.median().unwrap();
        assert!((median - 0.5).abs() < 0.5 / 4096.0, "{median}");
    }
}
