//! Moves of a layer -> Moves with arcs: lines that lie on a circle become the pieces of a G2 or G3.
//!
//! Words: a *run* is lines of one path that follow each other with the same role, height, feed and z,
//! and widths that differ by a hundredth at most; its *points* are their ends as they are written. A
//! *piece* is a straight move that the firmware makes of an arc.
//!
//! 1. From each point on, the longest part of its run is found that one circle fits: first by
//!    doubling, then by halving.
//! 2. A *fit* goes through the first and the last point, as G-code wants it, and as near as can be
//!    through the others. Its middle is rounded as it is written. It holds if no point and no place of a
//!    line is further from it than the tolerance, and if the points follow each other around it. As
//!    arc and lines pass by the same angles, no place of the arc is further from the lines either.
//! 3. It is worth an arc if a straight line would not do as well, and if the firmware's own pieces
//!    do not cut off too much.
//! 4. The lines give way to the pieces that our reader makes of the arc ([`geom::arc`](crate::geom::arc)),
//!    so that clock, cooling and sums see what is read from the file. All filament of the lines goes
//!    into them. An arc is longer than its lines by a part of tolerance / (3 · radius) at most: a third
//!    of a per cent at 1 mm.

use super::moves::{Kind, Move, Moves};
use super::reshaped::ArcRun;
use crate::geom::arc::Arc;
use crate::profile::Settings;
use crate::units::{Thousandths, nearest};

/// Fewest lines that are worth an arc: three points lie on a circle always, four often.
const LEAST_LINES: usize = 4;

/// Most lines that are tried for one arc: more would take long, and save nothing.
const MOST_LINES: usize = 1024;

/// Radii of arcs, mm. Smaller ones are blots; larger ones are straight, and firmwares with 32-bit floats
/// lose the place on them.
const RADII_MM: [f64; 2] = [0.1, 1000.0];

/// How much the firmware's pieces may stand out because coordinates are rounded, mm.
const ROUNDING_MM: f64 = 0.001;

/// Makes arcs.
#[derive(Debug, Clone)]
pub(super) struct Arcs {
    /// How far an arc may be from its lines, mm.
    tolerance: f64,
    /// Length of the firmware's pieces, mm.
    piece: f64,
    /// How far they leave the arc at most, mm.
    deviation: f64,
}

/// A circle through the first and the last of some points; mm from the first of them.
#[derive(Debug, Clone, Copy)]
struct Fit {
    middle: [f64; 2],
    clockwise: bool,
    radius: f64,
    /// How far the points reach beyond the circle.
    beyond: f64,
    /// How far they stand from the straight line between their ends.
    bulge: f64,
    /// The arc's length.
    length: f64,
}

impl Arcs {
    /// None where no arcs are asked for, or the firmware does not know them.
    pub(super) fn new(settings: &Settings) -> Option<Self> {
        let machine = &settings.machine;
        (settings.arcs && machine.arcs).then(|| Self {
            tolerance: settings.arc_tolerance,
            piece: machine.arc_segment,
            deviation: machine.arc_deviation.unwrap_or(f64::INFINITY),
        })
    }

    /// Replaces what lines of a layer an arc fits.
    pub(super) fn replace(&self, layer: &mut Moves) {
        let old = std::mem::take(&mut layer.moves);
        let mut starts = layer.paths.clone().into_iter().enumerate().peekable();
        let mut k = 0;
        while k < old.len() {
            while let Some((path, _)) = starts.next_if(|&(_, first)| first == k) {
                layer.paths[path] = layer.moves.len();
            }
            let end = starts.peek().map_or(old.len(), |&(_, first)| first);
            let count = alike(&old, k, end);
            if count >= LEAST_LINES {
                self.run(&old[k - 1..k + count], layer);
            } else {
                layer.moves.extend_from_slice(&old[k..k + count]);
            }
            k += count;
        }
        for (path, _) in starts {
            layer.paths[path] = layer.moves.len();
        }
    }

    /// Adds the lines of a run, which begins where its first move ends.
    fn run(&self, moves: &[Move], layer: &mut Moves) {
        let points: Vec<[f64; 2]> = moves.iter().map(|step| mm(step.to)).collect();
        let mut done = 0;
        while done + 1 < moves.len() {
            let (count, fit) = self.longest(&points[done..]);
            let lines = &moves[done + 1..=done + count];
            match fit.filter(|fit| self.is_worth(fit)) {
                Some(fit) => {
                    add(layer, moves[done].to, lines, &fit);
                    done += count;
                }
                // What fits a circle that is no arc is not looked at from each of its points.
                None => {
                    let skipped = (count / 2).max(1);
                    layer.moves.extend_from_slice(&lines[..skipped]);
                    done += skipped;
                }
            }
        }
    }

    /// How many of the lines from the first point on one circle fits, and that.
    fn longest(&self, points: &[[f64; 2]]) -> (usize, Option<Fit>) {
        let most = (points.len() - 1).min(MOST_LINES);
        let (mut fits, mut fit) = (0, None);
        let mut fails = most + 1;
        let mut next = LEAST_LINES.min(most + 1);
        while next < fails {
            match self.fit(&points[..=next]) {
                Some(found) => (fits, fit) = (next, Some(found)),
                None => fails = next,
            }
            next = if fails > most { (2 * fits).min(most) } else { (fits + fails) / 2 };
            // Fewer than the least are not tried.
            if fit.is_none() || next <= fits {
                break;
            }
        }
        (fits.max(1), fit)
    }

    /// The circle through the first and the last point that is nearest to the others, if it holds.
    fn fit(&self, points: &[[f64; 2]]) -> Option<Fit> {
        let (first, last) = (*points.first()?, *points.last()?);
        let chord = way(first, last);
        let long = length(chord);
        if long <= 0.0 {
            return None;
        }
        let along = chord.map(|side| side / long);
        let across = [-along[1], along[0]];
        // With its middle at height h above the chord's, a circle passes a point at u, v from there
        // if u² + v² - long² / 4 = 2 h v. The h that fits best, by least squares:
        let (mut sum, mut square, mut bulge, mut sides) = (0.0, 0.0, 0.0_f64, 0.0);
        for &point in points {
            let arm = way(first, point);
            let (u, v) = (dot(arm, along) - 0.5 * long, dot(arm, across));
            sum += v * (u * u + v * v - 0.25 * long * long);
            square += v * v;
            sides += v;
            bulge = bulge.max(v.abs());
        }
        // Straight lines fit a circle as large as one likes.
        let most = 100.0 * RADII_MM[1];
        let height = if square > 0.0 { (0.5 * sum / square).clamp(-most, most) } else { most };
        let clockwise = sides > 0.0;
        let middle = std::array::from_fn(|k| 0.5 * chord[k] + height * across[k]);
        let middle = middle.map(|side: f64| nearest(1000.0 * side) as f64 / 1000.0);
        let fit =
            Fit { middle, clockwise, radius: length(middle), beyond: 0.0, bulge, length: 0.0 };
        self.holds(fit, points)
    }

    /// The fit with what is to be known of it, if it stays within the tolerance and the points follow
    /// each other around it by half a turn at most. Of more than that the chord would tell too little:
    /// a circle is two arcs, not one that begins where it ends, which firmwares take for nothing.
    fn holds(&self, mut fit: Fit, points: &[[f64; 2]]) -> Option<Fit> {
        let first = *points.first()?;
        let arm = |point: [f64; 2]| way(fit.middle, way(first, point));
        let start = arm(first);
        let forwards = if fit.clockwise { -1.0 } else { 1.0 };
        let mut before = start;
        let mut lines = 0;
        for &point in &points[1..] {
            let now = arm(point);
            let turn = forwards * cross(before, now);
            let line = length(way(before, now));
            if line > 0.0 {
                lines += 1;
                // Where a line is nearest to the middle.
                if turn < 0.0 || turn < (fit.radius - self.tolerance) * line {
                    return None;
                }
            }
            fit.beyond = fit.beyond.max(length(now) - fit.radius);
            // Half a turn, but for what coordinates are rounded by.
            let over = forwards * cross(start, now) < -fit.radius * self.tolerance;
            if over || fit.beyond > self.tolerance {
                return None;
            }
            before = now;
        }
        fit.length = fit.radius * libm::atan2(cross(start, before).abs(), dot(start, before));
        (lines >= LEAST_LINES).then_some(fit)
    }

    /// Whether an arc is better than lines there, and the firmware's pieces are near enough to them.
    fn is_worth(&self, fit: &Fit) -> bool {
        // Firmwares round the number of pieces down, so that they may be up to twice as long.
        let pieces = (fit.length / self.piece).floor().max(1.0);
        let piece = fit.length / pieces;
        let cut = (piece * piece / (8.0 * fit.radius)).min(self.deviation);
        let most = 2.0 * self.tolerance + ROUNDING_MM;
        (RADII_MM[0]..=RADII_MM[1]).contains(&fit.radius)
            && fit.bulge > self.tolerance
            && fit.beyond + cut <= most
    }
}

/// The number of moves from `first` on that are one run; 1 for a move that is no line, or where it is
/// not known where a line begins.
fn alike(moves: &[Move], first: usize, end: usize) -> usize {
    let Kind::Extrude(bead) = moves[first].kind else { return 1 };
    let same = |step: &&Move| {
        let like = matches!(step.kind, Kind::Extrude(other) if other.is_like(&bead));
        like && (step.z, step.feed) == (moves[first].z, moves[first].feed)
    };
    if first == 0 || moves[first - 1].z != moves[first].z {
        return 1;
    }
    moves[first..end].iter().take_while(same).count().max(1)
}

/// Adds an arc in the place of `lines`.
fn add(layer: &mut Moves, from: [Thousandths; 2], lines: &[Move], fit: &Fit) {
    let Some(&last) = lines.last() else { return };
    let start = mm(from);
    let middle = [0, 1].map(|k| start[k] + fit.middle[k]);
    let arc = Arc { from: start, to: mm(last.to), middle, clockwise: fit.clockwise };
    let filament: f64 = lines.iter().map(|line| line.filament).sum();
    let way: f64 = lines.iter().map(|line| line.length).sum();
    let count = arc.points().count();
    let (first, share) = (layer.moves.len(), 1.0 / count as f64);
    let place = |mm: f64| Thousandths(nearest(1000.0 * mm) as i32);
    layer.moves.extend(arc.points().map(|to| Move {
        to: to.map(place),
        length: share * way,
        filament: share * filament,
        // Of widths that are nearly the same, that of the first.
        kind: lines[0].kind,
        ..last
    }));
    layer.arcs.push(ArcRun {
        pieces: first..first + count,
        lines: lines.len(),
        to_middle: fit.middle.map(place),
        clockwise: fit.clockwise,
    });
}

fn mm(place: [Thousandths; 2]) -> [f64; 2] {
    place.map(|at| f64::from(at.0) / 1000.0)
}

fn way(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [b[0] - a[0], b[1] - a[1]]
}

fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

fn cross(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

fn length(a: [f64; 2]) -> f64 {
    dot(a, a).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fill::Role;
    use crate::gcode::moves::Bead;
    use std::f64::consts::TAU;

    const ARCS: Arcs = Arcs { tolerance: 0.01, piece: 0.1, deviation: f64::INFINITY };

    /// A layer with one path through these points, mm.
    fn layer(points: &[[f64; 2]]) -> Moves {
        let bead = Bead { role: Role::OuterWall, thick: false, height: 2_000, width: 4_000 };
        let step = |at: [f64; 2], kind| Move {
            to: at.map(|mm| Thousandths((1000.0 * mm).round() as i32)),
            z: 2_000,
            feed: 1_800,
            length: 0.5,
            filament: 0.25,
            kind,
        };
        let mut moves = vec![step(points[0], Kind::Travel)];
        moves.extend(points[1..].iter().map(|&at| step(at, Kind::Extrude(bead))));
        Moves { moves, paths: vec![0], ..Moves::default() }
    }

    /// Points on a circle around 50, 50, from angle `from` to `to`, degrees.
    fn circle(radius: f64, [from, to]: [f64; 2], count: usize) -> Vec<[f64; 2]> {
        let angle = |k: usize| TAU / 360.0 * (from + (to - from) * k as f64 / count as f64);
        let at = |a: f64| [50.0 + radius * a.cos(), 50.0 + radius * a.sin()];
        (0..=count).map(|k| at(angle(k))).collect()
    }

    fn arcs(points: &[[f64; 2]]) -> Moves {
        let mut layer = layer(points);
        ARCS.replace(&mut layer);
        layer
    }

    #[test]
    fn a_circle_is_two_arcs_around_its_middle() {
        for (ends, clockwise) in [([30.0, 390.0], false), ([390.0, 30.0], true)] {
            let made = arcs(&circle(12.0, ends, 180));
            assert_eq!(made.arcs.len(), 2, "{:?}", made.arcs);
            assert_eq!(made.arcs.iter().map(|arc| arc.lines).sum::<usize>(), 180);
            for arc in &made.arcs {
                assert_eq!(arc.clockwise, clockwise);
                let start = made.moves[arc.pieces.start - 1].to;
                for (at, to_middle) in start.iter().zip(arc.to_middle) {
                    assert!((at.0 + to_middle.0 - 50_000).abs() <= 10, "{arc:?}");
                }
            }
            let filament: f64 = made.moves.iter().skip(1).map(|step| step.filament).sum();
            assert!((filament - 45.0).abs() < 1e-9);
        }
    }

    #[test]
    fn lines_that_lie_further_off_than_the_tolerance_stay() {
        // 36 corners on 12 mm: each line cuts off 0.046 mm.
        let made = arcs(&circle(12.0, [0.0, 360.0], 36));
        assert_eq!((made.arcs.len(), made.moves.len()), (0, 37));
        // Corners by turns in and out by more than that.
        let mut rough = circle(12.0, [0.0, 170.0], 100);
        let outer = circle(12.03, [0.0, 170.0], 100);
        rough.iter_mut().zip(outer).step_by(2).for_each(|(at, out)| *at = out);
        assert_eq!(arcs(&rough).arcs, []);
        // Straight on, in many steps.
        let straight: Vec<_> = (0..100).map(|k| [0.3 * f64::from(k), 0.1 * f64::from(k)]).collect();
        assert_eq!(arcs(&straight), layer(&straight));
    }

    #[test]
    fn an_arc_ends_where_another_begins_and_at_the_end_of_its_path() {
        // An S of two halves.
        let mut points = circle(10.0, [180.0, 0.0], 90);
        let back = circle(10.0, [180.0, 360.0], 90).into_iter().map(|[x, y]| [x + 20.0, y]);
        points.extend(back.skip(1));
        let made = arcs(&points);
        assert!((2..=4).contains(&made.arcs.len()), "{:?}", made.arcs);
        assert!(made.arcs[0].clockwise && !made.arcs.last().unwrap().clockwise);
        // The same half circle as two paths.
        let mut two = layer(&circle(10.0, [180.0, 0.0], 90));
        two.paths.push(46);
        ARCS.replace(&mut two);
        assert_eq!(two.arcs.len(), 2);
        assert_eq!(two.paths[1], two.arcs[1].pieces.start);
        assert_eq!(two.arcs.iter().map(|arc| arc.lines).sum::<usize>(), 90);
    }
}
