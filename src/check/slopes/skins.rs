//! Patches of skin + what they lie on -> findings of places that the last skin leaves open, or fills twice.
//!
//! Words used here: a *cell* is a square of 0.1 mm; a *ply* is what of a patch does not lie on itself, a
//! skin ([`plies`](super::plies)); the *room* of a cell is how far the last skin lies above what stood
//! there before the patch.
//!
//! - A cell is *open* if lines of the patch cover it, but none of the last ply of its piece of the patch; or
//!   if it lies between lines of the patch nearer to each other than [`GAP`], and what stands there lies as
//!   far below them as skins are high. A place of open cells counts where it is [`NARROW`] wide all over,
//!   and from [`LEAST_OPEN`] on: two and a half mm of one missing line.
//! - In squares of [`WINDOW`] cells, or more where lines are wide, the plastic of all lines is compared with the
//!   room of the cells that they cover. Squares with more than [`MOST_PLASTIC`] times as much count from [`LEAST_DOUBLE`] on in a
//!   patch, those with less than [`LEAST_PLASTIC`] times as much, as where lines of a lower skin are missing,
//!   from [`LEAST_THIN`] on. All skins are judged: other slicers lay a first skin of one height on the treads of a
//!   staircase. Where there is but one, squares are larger than a tread.

use super::plies::{Field, Stroke, strokes};
use super::relief::{CELL, Relief, footprint};
use crate::check::finding::{Code, Finding, Findings, Place, short};
use crate::check::samples::Samples;
use crate::check::terms::Terms;
use crate::geom::segment;
use crate::reader::print::Step;
use std::collections::BTreeMap;

/// Gaps between lines of a patch up to so many cells are looked at: five missing lines and more.
const GAP: usize = 26;

/// Cells on all sides that are open, too, in the middle of an open place: it is 0.3 mm wide.
const NARROW: usize = 1;

/// Least open place, mm².
const LEAST_OPEN: f64 = 1.0;

/// Part of a piece of a patch that its last ply covers at least.
const LEAST_PLY: f64 = 0.1;

/// Part of a line's height by which it lies at least above what shows between the lines of a patch.
const SHOWS: f64 = 0.75;

/// Skins that a base leaves room for, where lines of all of them are missing.
const USUAL_PLIES: u16 = 2;

/// Sides of the squares in which plastic is judged, cells; and of those of a single skin in a file that has
/// no marks.
const WINDOW: usize = 10;
const WIDE: usize = 40;

/// Squares are at least so many lines wide: a line's plastic is evenly spread over its width, and over as much of its
/// length, whatever lies under it.
const LINES: f64 = 2.5;

/// Part of a square's cells that the patch covers, for it to be judged.
const LEAST_COVERED: f64 = 0.5;

/// Plastic over room, at most and at least: half of it is there where one of two skins is missing.
const MOST_PLASTIC: f64 = 1.3;
const LEAST_PLASTIC: f64 = 0.65;

/// Least area with too much, and with too little, where the ends of lines are round, mm². Of squares that are larger,
/// one is the least.
const LEAST_DOUBLE: f64 = 1.0;
const LEAST_THIN: f64 = 4.0;

/// Lanes side by side in which a line's plastic is counted.
const LANES: usize = 4;

/// Lines that are kept at most: some 600 MB.
const MOST_LINES: usize = 10_000_000;

/// A patch by its number, or without marks the layer, from 0, in which it stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Name {
    Patch(u32),
    Layer(usize),
}

/// Lines of a patch in the file's order.
struct Skin {
    lines: Vec<Step>,
    /// Of those the last one that counts.
    end: usize,
    layer: Option<usize>,
}

/// All patches so far.
#[derive(Default)]
pub(crate) struct Skins {
    all: BTreeMap<Name, Skin>,
    kept: usize,
}

impl Skins {
    /// The next line of a patch, in a layer from 0. Of those at its end that do not `count`, none is kept.
    pub(crate) fn line(&mut self, name: Name, step: &Step, (layer, counts): (Option<usize>, bool)) {
        if self.kept >= MOST_LINES {
            return;
        }
        self.kept += 1;
        let skin = self.all.entry(name).or_insert(Skin { lines: Vec::new(), end: 0, layer });
        skin.lines.push(*step);
        if counts {
            skin.end = skin.lines.len();
        }
    }

    /// Judges all patches on what stands.
    pub(crate) fn finish(self, relief: &Relief, terms: &Terms, found: &mut Findings) {
        for (name, mut skin) in self.all {
            skin.lines.truncate(skin.end);
            let Some(field) = Field::around(&skin.lines, 1) else { continue };
            let map = Map::of(&skin, field, terms);
            let place = Place { layer: skin.layer.map(|layer| layer + 1), ..Place::default() };
            let judge = Judge { map, name, relief, place };
            judge.open(found);
            judge.double(found);
        }
    }
}

/// A patch as cells.
struct Map {
    field: Field,
    /// The last ply that covers a cell, 0 for none; how high it is, mm; its plastic, mm³.
    ply: Vec<u16>,
    top: Vec<f32>,
    plastic: Vec<f32>,
    plies: u16,
    /// How high a skin is, and how wide the narrowest tenth of its lines is at most, mm.
    height: f64,
    width: f64,
}

impl Map {
    fn of(skin: &Skin, field: Field, terms: &Terms) -> Self {
        let cells = field.cells();
        let (ply, top, plastic) = (vec![0; cells], vec![0.0; cells], vec![0.0; cells]);
        let mut map = Self { field, ply, top, plastic, plies: 0, height: 0.0, width: 0.0 };
        let strokes = strokes(&skin.lines, &field);
        map.height = height(&skin.lines, &strokes);
        let widths = skin.lines.iter().map(|step| (f64::from(step.width), step.plan_length()));
        map.width = reached(&mut widths.collect::<Vec<_>>(), 0.1).map_or(0.0, |(width, _)| width);
        for stroke in strokes {
            map.plies = map.plies.max(stroke.ply);
            for step in &skin.lines[stroke.lines.clone()] {
                map.cover(step, stroke.ply);
                map.fill(step, terms);
            }
        }
        map
    }

    fn cover(&mut self, step: &Step, ply: u16) {
        footprint(step, 0.0, |cell, z| {
            let Some(cell) = self.field.index(cell) else { return };
            self.ply[cell] = self.ply[cell].max(ply);
            self.top[cell] = self.top[cell].max(z as f32);
        });
    }

    fn fill(&mut self, step: &Step, terms: &Terms) {
        let lane = f64::from(step.width) / LANES as f64;
        let plastic = terms.plastic(step) / step.plan_length() / LANES as f64;
        for piece in Samples::of(step, CELL) {
            for k in 0..LANES {
                let aside = (k as f64 + 0.5 - LANES as f64 / 2.0) * lane;
                if let Some(cell) = self.field.cell(segment::along(piece.at, aside, piece.across)) {
                    self.plastic[cell] += (plastic * piece.length) as f32;
                }
            }
        }
    }

    /// The last ply of the piece of the patch that each cell is of.
    fn lasts(&self) -> Vec<u16> {
        let mut lasts = vec![0_u16; self.ply.len()];
        let mut is_seen = vec![false; self.ply.len()];
        for first in 0..self.ply.len() {
            if self.ply[first] == 0 || is_seen[first] {
                continue;
            }
            let piece = flood(&self.field, first, &mut is_seen, |cell| self.ply[cell] > 0);
            let mut counts: BTreeMap<u16, usize> = BTreeMap::new();
            piece.iter().for_each(|&cell| *counts.entry(self.ply[cell]).or_default() += 1);
            let enough = (LEAST_PLY * piece.len() as f64) as usize;
            let last = counts.iter().rev().find(|(_, count)| **count >= enough);
            let last = last.map_or(0, |(ply, _)| *ply);
            piece.into_iter().for_each(|cell| lasts[cell] = last);
        }
        lasts
    }
}

/// How high a skin is, mm: as half of a ply is, by length. The lowest ply fills the treads of a staircase, and is
/// thinner all over where a level base reaches far up; so that ply counts in which lines are highest.
fn height(lines: &[Step], strokes: &[Stroke]) -> f64 {
    let mut plies: BTreeMap<u16, Vec<(f64, f64)>> = BTreeMap::new();
    for stroke in strokes {
        let own = lines[stroke.lines.clone()].iter();
        let of = own.map(|step| (f64::from(step.height), step.plan_length()));
        plies.entry(stroke.ply).or_default().extend(of);
    }
    let all: f64 = plies.values().flatten().map(|one| one.1).sum();
    let of_ply = |own: &mut Vec<(f64, f64)>| {
        reached(own, 0.5).filter(|(_, whole)| *whole >= LEAST_PLY * all).map(|(height, _)| height)
    };
    plies.values_mut().filter_map(of_ply).fold(0.0, f64::max)
}

/// Of values with the lengths that have them: the one that this part of the length reaches at most, and the whole
/// length.
fn reached(all: &mut [(f64, f64)], part: f64) -> Option<(f64, f64)> {
    all.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    let whole: f64 = all.iter().map(|one| one.1).sum();
    let mut so_far = 0.0;
    let one = all.iter().find(|one| {
        so_far += one.1;
        so_far >= part * whole
    });
    one.map(|one| (one.0, whole))
}

/// All cells that hang together with one, itself included, and are such.
fn flood(
    field: &Field,
    first: usize,
    is_seen: &mut [bool],
    is_such: impl Fn(usize) -> bool,
) -> Vec<usize> {
    let mut piece = vec![first];
    is_seen[first] = true;
    let mut next = 0;
    while next < piece.len() {
        around(field, piece[next], 1, |cell| {
            if !is_seen[cell] && is_such(cell) {
                is_seen[cell] = true;
                piece.push(cell);
            }
        });
        next += 1;
    }
    piece
}

/// The cells around one, `reach` to all sides.
fn around(field: &Field, cell: usize, reach: usize, mut sink: impl FnMut(usize)) {
    let [columns, rows] = field.count;
    let (x, y) = (cell % columns, cell / columns);
    for j in y.saturating_sub(reach)..=(y + reach).min(rows - 1) {
        for i in x.saturating_sub(reach)..=(x + reach).min(columns - 1) {
            sink(i + j * columns);
        }
    }
}

struct Judge<'a> {
    map: Map,
    name: Name,
    relief: &'a Relief,
    place: Place,
}

impl Judge<'_> {
    fn at(&self, cell: usize) -> Place {
        let middle = self.map.field.of(cell).map(|k| short((f64::from(k) + 0.5) * CELL));
        Place { at_mm: Some(middle), ..self.place }
    }

    fn name(&self) -> String {
        match self.name {
            Name::Patch(number) => format!("patch {number}"),
            Name::Layer(layer) => format!("the skin of layer {}", layer + 1),
        }
    }

    /// Reports open places.
    fn open(&self, found: &mut Findings) {
        let field = &self.map.field;
        let is_open = self.opens();
        let mut is_core = vec![false; is_open.len()];
        for (cell, core) in is_core.iter_mut().enumerate().filter(|(cell, _)| is_open[*cell]) {
            let mut all = true;
            around(field, cell, NARROW, |one| all &= is_open[one]);
            *core = all;
        }
        let mut is_seen = vec![false; is_open.len()];
        for first in 0..is_core.len() {
            if !is_core[first] || is_seen[first] {
                continue;
            }
            let core = flood(field, first, &mut is_seen, |cell| is_core[cell]);
            let mut all: Vec<usize> = Vec::new();
            core.iter().for_each(|&cell| around(field, cell, NARROW, |one| all.push(one)));
            all.sort_unstable();
            all.dedup();
            let area = all.len() as f64 * CELL * CELL;
            if area < LEAST_OPEN {
                continue;
            }
            let (area, name) = (short(area), self.name());
            let text = format!("{area} mm² of {name} are not covered by its last skin");
            let finding = Finding::of(Code::UncoveredSkin, area, "mm²", text);
            found.add(finding.at(self.at(core[core.len() / 2])));
        }
    }

    /// Which cells are open.
    fn opens(&self) -> Vec<bool> {
        let (map, lasts) = (&self.map, self.map.lasts());
        let mut is_open: Vec<bool> =
            map.ply.iter().zip(&lasts).map(|(ply, last)| ply < last).collect();
        let [columns, rows] = map.field.count;
        for (lines, along, step) in [(rows, columns, 1), (columns, rows, columns)] {
            let next = if step == 1 { columns } else { 1 };
            for line in 0..lines {
                let mut last: Option<usize> = None;
                for k in 0..along {
                    let cell = line * next + k * step;
                    if map.ply[cell] == 0 {
                        continue;
                    }
                    if let Some(before) = last.filter(|before| k - before > 1 && k - before <= GAP)
                    {
                        let ends = [line * next + before * step, cell];
                        for gap in before + 1..k {
                            let cell = line * next + gap * step;
                            let part = (gap - before) as f64 / (k - before) as f64;
                            is_open[cell] |= self.shows(cell, (ends, part), &lasts);
                        }
                    }
                    last = Some(k);
                }
            }
        }
        is_open
    }

    /// Whether the base of a patch shows between two cells of it, after a part of the way between them.
    fn shows(&self, cell: usize, (ends, part): ([usize; 2], f64), lasts: &[u16]) -> bool {
        let map = &self.map;
        let [from, to] = ends.map(|end| f64::from(map.top[end]));
        let top = from + part * (to - from);
        let plies = f64::from(lasts[ends[0]].max(lasts[ends[1]]).max(USUAL_PLIES));
        let depth = top - self.relief.at(map.field.of(cell));
        (SHOWS * map.height..(plies + SHOWS) * map.height).contains(&depth)
    }

    /// Reports too much and too little plastic.
    fn double(&self, found: &mut Findings) {
        let is_single = self.map.plies < 2 && matches!(self.name, Name::Layer(_));
        let lines = (LINES * self.map.width / CELL).round() as usize;
        let side = if is_single { WIDE } else { WINDOW.max(lines) };
        let [columns, rows] = self.map.field.count;
        let (mut double, mut thin) = (Sum::default(), Sum::default());
        for row in (0..rows).step_by(side) {
            for column in (0..columns).step_by(side) {
                let own = self.square([column, row], side, self.map.plies);
                if own.area < LEAST_COVERED * (CELL * side as f64).powi(2) {
                    continue;
                }
                if own.fills() > MOST_PLASTIC {
                    // A lower skin that lies under a small part of the one above it is no ply of its own.
                    let plies = self.map.plies.max(USUAL_PLIES);
                    let own = self.square([column, row], side, plies);
                    if own.fills() > MOST_PLASTIC {
                        double.add(own);
                    }
                } else if own.fills() < LEAST_PLASTIC {
                    thin.add(own);
                }
            }
        }
        let mut tell = |sum: Sum, code: Code| {
            let percent = short(100.0 * sum.fills());
            let (area, name) = (short(sum.area), self.name());
            let text = format!(
                "{area} mm² of {name} take {percent} % of the plastic that they have room for"
            );
            found.add(Finding::of(code, area, "mm²", text).at(self.at(sum.middle)));
        };
        let one = if is_single { 0.0 } else { (CELL * side as f64).powi(2) };
        if double.area >= LEAST_DOUBLE.max(one) {
            tell(double, Code::DoubleSkin);
        }
        if thin.area >= LEAST_THIN.max(one) {
            tell(thin, Code::UncoveredSkin);
        }
    }

    /// How high the base of a cell stands, mm. The relief is an upper bound, and has each line wider by half a
    /// cell: the least of a cell and those beside it has not.
    fn before(&self, cell: usize) -> f64 {
        let [x, y] = self.map.field.of(cell);
        let beside = [[x, y], [x - 1, y], [x + 1, y], [x, y - 1], [x, y + 1]];
        let known = beside.into_iter().filter_map(|cell| self.relief.before(cell));
        known.reduce(f64::min).unwrap_or_default()
    }

    /// What a square takes, and has room for under so many plies.
    fn square(&self, [column, row]: [usize; 2], side: usize, plies: u16) -> Sum {
        let map = &self.map;
        let [columns, rows] = map.field.count;
        let most = (f64::from(plies) + SHOWS) * map.height;
        let middle = [(column + side / 2).min(columns - 1), (row + side / 2).min(rows - 1)];
        let mut sum = Sum { middle: middle[0] + middle[1] * columns, ..Sum::default() };
        for j in row..(row + side).min(rows) {
            for cell in column + j * columns..(column + side).min(columns) + j * columns {
                if map.ply[cell] == 0 {
                    continue;
                }
                // Over sparse infill there is more room than skins fill.
                let room = (f64::from(map.top[cell]) - self.before(cell)).clamp(0.0, most);
                sum.plastic += f64::from(map.plastic[cell]);
                sum.room += room * CELL * CELL;
                sum.area += CELL * CELL;
            }
        }
        sum
    }
}

/// Plastic and room of a square, or of several, mm³; area, mm²; and the middle of the worst one.
#[derive(Debug, Clone, Copy, Default)]
struct Sum {
    plastic: f64,
    room: f64,
    area: f64,
    middle: usize,
    /// By how much the worst one is off, mm³.
    off: f64,
}

impl Sum {
    /// Plastic over room.
    fn fills(&self) -> f64 {
        self.plastic / self.room.max(f64::MIN_POSITIVE)
    }

    fn add(&mut self, one: Self) {
        let off = (one.plastic - one.room).abs();
        if off > self.off {
            (self.off, self.middle) = (off, one.middle);
        }
        self.plastic += one.plastic;
        self.room += one.room;
        self.area += one.area;
    }
}
