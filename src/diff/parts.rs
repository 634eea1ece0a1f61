//! Two files -> parts of a plate that moved alone, and the second file's moves as if they had not.
//!
//! Words used here: a *cell* is a square of 1 mm of the bed; a *part* is all cells with lines of any layer that
//! hang together, and has a *number*; brims and skirts, which are [`Role::Adhesion`], are none of them; a part is
//! *still* if it lies where one of the other file does.
//!
//! 1. The cells of each file are marked, by all layers: those of the print, and those of brims and skirts. What
//!    hangs together is a part. A brim that touches one part alone is of that part; a skirt, or a brim around
//!    several, is of none.
//! 2. Each part is measured: the box around its lines, their length, and the middle of it.
//! 3. Parts of equal size and length are paired: first those that are still, then the nearest.
//! 4. In the second file, moves that begin or end in a part that moved do so as far back. So the rest is compared
//!    as if it had not moved, a travel to it too.
//!
//! Parts nearer to each other than a cell are one. It costs two more passes over each file, which only files pay
//! whose layers lie differently ([`lie_apart`]).

use super::PartMoved;
use super::align::Pair;
use super::apart::SLACK;
use super::moved::{self, Floor, rounded};
use super::side::Side;
use super::sums::{Extent, Shape};
use crate::reader::print::Step;
use crate::reader::{Error, Role};
use std::borrow::Cow;
use std::io;

/// Side of a cell, mm; cells along a side of the map, and the first of them: beds begin near 0, or have it in their
/// middle.
const CELL: f64 = 1.0;
const SIDE: i32 = 1400;
const FIRST: i32 = -400;

/// Marks of a cell.
const PRINT: u8 = 1;
const BED: u8 = 2;

/// Parts of a file at most.
const MOST: usize = 10_000;

/// Share by which lengths of the same part may differ, and how far its middle may lie elsewhere, mm: a line of it
/// may be another.
const ALIKE: f64 = 0.01;
const MIDDLE: f64 = 0.2;

/// What moved.
#[derive(Debug, Default)]
pub(super) struct Parts {
    pub(super) moved: Vec<PartMoved>,
    /// Numbers of the second file's parts by cell, 0 for none; how far each moved, mm.
    map: Option<Map>,
    by: Vec<[f64; 2]>,
}

/// Whether layers that both files have lie elsewhere, or have their lines elsewhere.
pub(super) fn lie_apart(a: &[Floor], b: &[Floor], pairs: &[Pair], tolerance: f64) -> bool {
    let differ = |pair: &Pair| {
        let (one, other) = (a.get(pair.a?)?, b.get(pair.b?)?);
        let by = [0, 1].map(|axis| (one.middle[axis] - other.middle[axis]).abs());
        Some(by[0].max(by[1]) > 0.1 * tolerance)
    };
    pairs.iter().filter_map(differ).any(|differs| differs)
}

impl Parts {
    /// Finds what moved.
    ///
    /// # Errors
    /// What reading gives.
    pub(super) fn new(a: &Side, b: &Side, tolerance: f64) -> Result<Self, Error> {
        let map = |side: &Side| Map::of(side).map_err(|error| side.unreadable(error));
        let (Some(one), Some(other)) = (map(a)?, map(b)?) else { return Ok(Self::default()) };
        let pairs = paired(&one.parts, &other.parts, tolerance);
        let mut all = Self { by: vec![[0.0; 2]; other.parts.len() + 1], ..Self::default() };
        for (own, number, by) in pairs {
            all.by[number + 1] = by;
            let Some(Extent { min, max }) = one.parts[own].extent else { continue };
            let box_mm = [min, max].map(|[x, y, _]| [x, y]);
            all.moved.push(PartMoved { box_mm, by_mm: by });
        }
        all.map = Some(other).filter(|_| !all.moved.is_empty());
        Ok(all)
    }

    /// The second file's moves as if nothing had moved.
    pub(super) fn back<'a>(&self, steps: &'a [Step]) -> Cow<'a, [Step]> {
        let Some(map) = &self.map else { return Cow::Borrowed(steps) };
        let place = |at: [f32; 3]| {
            let by = self.by.get(usize::from(map.near(at))).copied().unwrap_or_default();
            [at[0] - by[0] as f32, at[1] - by[1] as f32, at[2]]
        };
        let moved =
            steps.iter().map(|step| Step { from: place(step.from), to: place(step.to), ..*step });
        Cow::Owned(moved.collect())
    }
}

/// How far a part lies from one that is like it, mm.
fn apart(one: &Shape, other: &Shape, tolerance: f64) -> Option<[f64; 2]> {
    let by = moved::apart(one.extent?, other.extent?, tolerance)?;
    let is_as_long = (one.length - other.length).abs() <= ALIKE * one.length;
    let (from, to) = (one.middle(), other.middle());
    let is_alike = (0..2).all(|axis| (to[axis] - from[axis] - by[axis]).abs() <= MIDDLE);
    (is_as_long && is_alike).then_some(by)
}

/// Parts that moved: the places of a part in both lists, and how far it did.
fn paired(a: &[Shape], b: &[Shape], tolerance: f64) -> Vec<(usize, usize, [f64; 2])> {
    let square = |by: [f64; 2]| by[0] * by[0] + by[1] * by[1];
    let is_still = |by: [f64; 2]| by.iter().all(|by| by.abs() <= tolerance + SLACK);
    let mut is_free = vec![true; b.len()];
    let nearest = |part: &Shape, is_free: &[bool]| {
        let free = b.iter().enumerate().filter(|(k, _)| is_free[*k]);
        let like = free.filter_map(|(k, other)| Some((k, apart(part, other, tolerance)?)));
        like.min_by(|one, two| square(one.1).total_cmp(&square(two.1)))
    };
    let mut left = Vec::new();
    for (own, part) in a.iter().enumerate() {
        match nearest(part, &is_free) {
            Some((other, by)) if is_still(by) => is_free[other] = false,
            _ => left.push(own),
        }
    }
    let mut pairs = Vec::new();
    for own in left {
        if let Some((other, by)) = nearest(&a[own], &is_free) {
            is_free[other] = false;
            pairs.push((own, other, by.map(rounded)));
        }
    }
    pairs
}

/// The parts of a file.
#[derive(Debug)]
struct Map {
    /// Numbers of parts by cell, from 1.
    numbers: Vec<u16>,
    parts: Vec<Shape>,
}

impl Map {
    /// `None` where lines lie farther away than on any usual bed, or are too many parts.
    fn of(side: &Side) -> io::Result<Option<Self>> {
        let mut marks = vec![0_u8; (SIDE * SIDE) as usize];
        for section in side.sections() {
            let section = section?;
            let lines = section.lines().filter(|_| section.layer.is_some());
            for step in lines {
                let mark = if step.role == Role::Adhesion { BED } else { PRINT };
                if !cells(step, |cell| marks[cell] |= mark) {
                    return Ok(None);
                }
            }
        }
        let Some((numbers, count)) = numbered(&marks) else { return Ok(None) };
        let mut parts = vec![Shape::default(); count];
        for section in side.sections() {
            let section = section?;
            let lines = section.lines().filter(|_| section.layer.is_some());
            for step in lines.filter(|step| step.role != Role::Adhesion) {
                let number = cell(step.from).map_or(0, |cell| usize::from(numbers[cell]));
                if let Some(part) = number.checked_sub(1).and_then(|part| parts.get_mut(part)) {
                    part.add(step);
                }
            }
        }
        Ok(Some(Self { numbers, parts }))
    }

    /// The part in whose cell a place is, or that of a cell beside it; 0 for none.
    fn near(&self, at: [f32; 3]) -> u16 {
        let Some(own) = cell(at) else { return 0 };
        let mut number = self.numbers[own];
        if number == 0 {
            around(own, |cell| number = number.max(self.numbers[cell]));
        }
        number
    }
}

/// The cell of a place, if it is on the map.
fn cell(at: [f32; 3]) -> Option<usize> {
    let [x, y] = [at[0], at[1]].map(|at| (f64::from(at) / CELL).floor() - f64::from(FIRST));
    let is_on = |at: f64| (0.0..f64::from(SIDE)).contains(&at);
    (is_on(x) && is_on(y)).then(|| x as usize + y as usize * SIDE as usize)
}

/// Hands the cells along a line to `sink`; whether all are on the map.
fn cells(step: &Step, mut sink: impl FnMut(usize)) -> bool {
    let (Some(from), Some(to)) = (cell(step.from), cell(step.to)) else { return false };
    sink(from);
    if to == from {
        return true;
    }
    let count = (2.0 * step.plan_length() / CELL).ceil().max(1.0);
    for k in 1..=count as u32 {
        let part = f64::from(k) / count;
        let at = [0, 1].map(|axis| {
            let (from, to) = (f64::from(step.from[axis]), f64::from(step.to[axis]));
            (from + part * (to - from)) as f32
        });
        cell([at[0], at[1], 0.0]).into_iter().for_each(&mut sink);
    }
    true
}

/// The cells around one.
fn around(own: usize, mut sink: impl FnMut(usize)) {
    let side = SIDE as usize;
    let (x, y) = (own % side, own / side);
    for j in y.saturating_sub(1)..=(y + 1).min(side - 1) {
        for i in x.saturating_sub(1)..=(x + 1).min(side - 1) {
            sink(i + j * side);
        }
    }
}

/// The number of the part of each cell, and how many parts there are; `None` of too many.
fn numbered(marks: &[u8]) -> Option<(Vec<u16>, usize)> {
    let mut numbers = vec![0_u16; marks.len()];
    let mut count = 0;
    for first in 0..marks.len() {
        if marks[first] & PRINT != 0 && numbers[first] == 0 {
            count += 1;
            if count > MOST {
                return None;
            }
            flood(first, |cell| {
                let is_new = marks[cell] & PRINT != 0 && numbers[cell] == 0;
                if is_new {
                    numbers[cell] = count as u16;
                }
                is_new
            });
        }
    }
    // Brims: of the one part that they touch.
    let mut is_seen = vec![false; marks.len()];
    for first in 0..marks.len() {
        let is_brim = |cell: usize| marks[cell] == BED;
        if !is_brim(first) || is_seen[first] {
            continue;
        }
        let (mut brim, mut touched) = (Vec::new(), Vec::new());
        flood(first, |cell| {
            if numbers[cell] > 0 && !is_brim(cell) {
                touched.push(numbers[cell]);
            }
            let is_new = is_brim(cell) && !std::mem::replace(&mut is_seen[cell], true);
            if is_new {
                brim.push(cell);
            }
            is_new
        });
        touched.sort_unstable();
        touched.dedup();
        if let [number] = touched[..] {
            brim.into_iter().for_each(|cell| numbers[cell] = number);
        }
    }
    Some((numbers, count))
}

/// Goes on from a cell to all around it that `takes` says yes to, and so on.
fn flood(first: usize, mut takes: impl FnMut(usize) -> bool) {
    let mut next = vec![first];
    takes(first);
    while let Some(own) = next.pop() {
        around(own, |cell| {
            if takes(cell) {
                next.push(cell);
            }
        });
    }
}
