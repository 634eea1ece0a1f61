//! Bead + a test of its places -> stretches of it that pass, and those that do not.
//!
//! Words: a *piece* is a short way along the bead, of one width; its middle is what is tested. A *run*
//! is a number of pieces, one after the other, with the same answer.
//!
//! 1. Cut the bead into pieces and test the middle of each. A ring is turned so that it begins where the
//!    answer changes.
//! 2. Smooth the runs: close short gaps, keep off from what fails, drop what is short.
//! 3. Join the pieces of each run, with the bead's own corners.

use crate::geom::Point;
use crate::geom::polyline::{LinePoint, Polyline};
use crate::units::{Bounded as _, Coord};
use std::ops::Range;

/// How runs are smoothed, in this order; grid units.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Smooth {
    /// Shorter runs that fail, between two that pass, pass as well.
    pub(super) close: f64,
    /// Runs that pass keep so far from those that fail.
    pub(super) margin: f64,
    /// Shorter runs that pass, and are not the whole bead, fail.
    pub(super) least: f64,
}

/// A short way along a bead.
pub(super) struct Piece {
    from: Point,
    to: LinePoint,
    pub(super) length: f64,
    /// Whether the bead has a point at its end.
    is_corner: bool,
}

impl Piece {
    /// From its one end to the other.
    pub(super) fn way(&self) -> [f64; 2] {
        [f64::from(self.to.u - self.from.x), f64::from(self.to.v - self.from.y)]
    }

    pub(super) fn middle(&self) -> LinePoint {
        let u = Coord::midpoint(self.from.x, self.to.u);
        LinePoint { u, v: Coord::midpoint(self.from.y, self.to.v), width: self.to.width }
    }
}

/// Those stretches that pass, and the others.
pub(super) fn parted(all: impl Iterator<Item = (bool, Polyline)>) -> [Vec<Polyline>; 2] {
    let mut out = [Vec::new(), Vec::new()];
    all.for_each(|(passes, stretch)| out[usize::from(!passes)].push(stretch));
    out
}

/// Divides `bead` into stretches whose places pass, and those whose places do not. It is tested at places
/// at most a `step` apart. A ring may begin elsewhere.
pub(super) fn stretches(
    bead: &[LinePoint],
    step: Coord,
    smooth: Smooth,
    passes: impl Fn(&LinePoint) -> bool,
) -> Vec<(bool, Polyline)> {
    let pieces = pieces(bead, step);
    let flags = pieces.iter().map(|piece| passes(&piece.middle())).collect();
    let is_ring = bead.first().zip(bead.last()).is_some_and(|(a, b)| (a.u, a.v) == (b.u, b.v));
    let mut runs = Runs { pieces, flags, is_ring };
    runs.begin_at_a_change();
    for smoothed in [Runs::close, Runs::keep_off, Runs::drop_short] {
        smoothed(&mut runs, smooth);
        runs.begin_at_a_change();
    }
    match runs.all().as_slice() {
        [] => Vec::new(),
        [one] => vec![(runs.flags[one.start], bead.to_vec())],
        more => {
            more.iter().map(|r| (runs.flags[r.start], joined(&runs.pieces[r.clone()]))).collect()
        }
    }
}

/// The pieces of `bead`, at most a `step` long.
pub(super) fn pieces(bead: &[LinePoint], step: Coord) -> Vec<Piece> {
    let mut out = Vec::new();
    for pair in bead.windows(2) {
        let at = |p: &LinePoint| Point { x: p.u, y: p.v };
        let (from, to) = (at(&pair[0]), at(&pair[1]));
        let length = from.distance(to);
        let count = (length / f64::from(step)).ceil().at_least(1.0) as i64;
        let on = |k: i64| {
            let between = |a: Coord, b: Coord| a + (i64::from(b - a) * k / count) as Coord;
            Point { x: between(from.x, to.x), y: between(from.y, to.y) }
        };
        out.extend((0..count).map(|k| {
            let end = on(k + 1);
            Piece {
                from: on(k),
                to: LinePoint { u: end.x, v: end.y, width: pair[1].width },
                length: length / count as f64,
                is_corner: k + 1 == count,
            }
        }));
    }
    out
}

/// The pieces of a bead, and whether each passes.
struct Runs {
    pieces: Vec<Piece>,
    flags: Vec<bool>,
    /// The last piece leads on to the first.
    is_ring: bool,
}

impl Runs {
    /// Turns a ring that begins within a run so that it begins with one.
    fn begin_at_a_change(&mut self) {
        let within = self.is_ring && self.flags.first() == self.flags.last();
        let change = self.flags.windows(2).position(|pair| pair[0] != pair[1]);
        if let Some(before) = change.filter(|_| within) {
            self.pieces.rotate_left(before + 1);
            self.flags.rotate_left(before + 1);
        }
    }

    fn all(&self) -> Vec<Range<usize>> {
        let mut end = 0;
        let run = |equal: &[bool]| {
            let start = end;
            end += equal.len();
            start..end
        };
        self.flags.chunk_by(|a, b| a == b).map(run).collect()
    }

    /// Whether there are others before and behind a run.
    fn neighbours(&self, run: &Range<usize>) -> [bool; 2] {
        let goes_on = self.is_ring && run.len() < self.flags.len();
        [goes_on || run.start > 0, goes_on || run.end < self.flags.len()]
    }

    fn length(&self, run: &Range<usize>) -> f64 {
        self.pieces[run.clone()].iter().map(|p| p.length).sum()
    }

    fn close(&mut self, smooth: Smooth) {
        for run in self.all() {
            let inside = self.neighbours(&run) == [true; 2];
            if !self.flags[run.start] && inside && self.length(&run) < smooth.close {
                self.flags[run].fill(true);
            }
        }
    }

    fn keep_off(&mut self, smooth: Smooth) {
        // How many pieces begin within the margin.
        let near = |pieces: &mut dyn Iterator<Item = &Piece>| -> usize {
            let mut away = 0.0;
            let is_near = |piece: &&Piece| {
                let is = away < smooth.margin;
                away += piece.length;
                is
            };
            pieces.take_while(is_near).count()
        };
        for run in self.all().into_iter().filter(|run| self.flags[run.start]).collect::<Vec<_>>() {
            let [before, after] = self.neighbours(&run);
            let pieces = &self.pieces[run.clone()];
            let first = if before { near(&mut pieces.iter()) } else { 0 };
            let last = if after { near(&mut pieces.iter().rev()) } else { 0 };
            self.flags[run.start..run.start + first].fill(false);
            self.flags[run.end - last..run.end].fill(false);
        }
    }

    fn drop_short(&mut self, smooth: Smooth) {
        for run in self.all() {
            let is_part = self.neighbours(&run).contains(&true);
            if self.flags[run.start] && is_part && self.length(&run) < smooth.least {
                self.flags[run].fill(false);
            }
        }
    }
}

/// The way along some pieces.
fn joined(pieces: &[Piece]) -> Polyline {
    let start = pieces.first().map(|first| LinePoint {
        u: first.from.x,
        v: first.from.y,
        width: first.to.width,
    });
    let last = pieces.len().saturating_sub(1);
    let kept = pieces.iter().enumerate().filter(|(k, piece)| piece.is_corner || *k == last);
    start.into_iter().chain(kept.map(|(_, piece)| piece.to)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::polyline::length;
    use proptest::prelude::*;

    const STEP: Coord = 4_000;

    fn point(u: Coord, v: Coord) -> LinePoint {
        LinePoint { u, v, width: 4_000 }
    }

    proptest! {
        /// Stretches lie one after the other along the bead, and leave nothing out.
        #[test]
        fn stretches_are_the_whole_bead(
            ends in prop::collection::vec((0..100_000, 0..100_000), 2..9),
            from in 0..100_000,
            (close, margin, least) in (0..20_000, 0..20_000, 0..20_000),
        ) {
            let bead: Polyline = ends.iter().map(|&(u, v)| point(u, v)).collect();
            let [close, margin, least] = [close, margin, least].map(f64::from);
            let found = stretches(&bead, STEP, Smooth { close, margin, least }, |p| p.u > from);
            let all: i64 = found.iter().map(|(_, stretch)| length(stretch)).sum();
            prop_assert!((all - length(&bead)).abs() <= 2 * bead.len() as i64 + 200);
            for pair in found.windows(2) {
                prop_assert!(pair[0].0 != pair[1].0);
                prop_assert_eq!(pair[0].1.last().map(|p| (p.u, p.v)), pair[1].1.first().map(|p| (p.u, p.v)));
            }
            for (passes, stretch) in &found {
                prop_assert!(!passes || found.len() == 1 || length(stretch) as f64 >= least - 10.0);
            }
        }
    }

    #[test]
    fn a_ring_is_not_cut_where_it_begins() {
        let ring =
            [point(0, 0), point(40_000, 0), point(40_000, 40_000), point(0, 40_000), point(0, 0)];
        let found = stretches(&ring, STEP, Smooth::default(), |p| p.u < 30_000);
        assert_eq!(found.iter().map(|(passes, _)| *passes).collect::<Vec<_>>(), [false, true]);
        let [(_, fails), (_, passes)] = [&found[0], &found[1]].map(|(flag, one)| (flag, one));
        assert_eq!((length(fails), length(passes)), (64_000, 96_000));
    }

    #[test]
    fn a_gap_where_a_ring_begins_is_closed() {
        let ring =
            [point(0, 0), point(40_000, 0), point(40_000, 40_000), point(0, 40_000), point(0, 0)];
        let near_start = |p: &LinePoint| p.u + p.v < 5_000;
        let smooth = Smooth { close: 13_000.0, ..Smooth::default() };
        let found = stretches(&ring, STEP, smooth, |p| !near_start(p));
        assert_eq!(found, [(true, ring.to_vec())]);
    }

    #[test]
    fn runs_are_closed_then_held_off_and_short_ones_dropped() {
        let bead = [point(0, 0), point(100_000, 0)];
        let fails = |p: &LinePoint| (40_000..44_000).contains(&p.u) || p.u > 80_000;
        let run = |smooth| stretches(&bead, STEP, smooth, |p| !fails(p));
        let starts = |smooth| -> Vec<(bool, Coord)> {
            run(smooth).iter().map(|(flag, stretch)| (*flag, stretch[0].u)).collect()
        };
        assert_eq!(
            starts(Smooth::default()),
            [(true, 0), (false, 40_000), (true, 44_000), (false, 80_000)]
        );
        let closed = Smooth { close: 5_000.0, ..Smooth::default() };
        assert_eq!(starts(closed), [(true, 0), (false, 80_000)]);
        let held = Smooth { margin: 8_000.0, ..Smooth::default() };
        assert_eq!(starts(held), [(true, 0), (false, 32_000), (true, 52_000), (false, 72_000)]);
        let long = Smooth { least: 38_000.0, ..Smooth::default() };
        assert_eq!(starts(long), [(true, 0), (false, 40_000)]);
    }
}
