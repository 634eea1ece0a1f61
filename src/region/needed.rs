//! Wall beads and the areas that they are for -> the stretches of the beads that lie there.
//!
//! Beads are laid behind stretches of a wall ([`crate::region::wall_beads`]), and go on over short gaps between
//! these and around corners. From one tooth of a gear to the next it is as far as around the corner of a strip: there
//! a bead would run on along a wall behind which there is sparse infill.

use super::hidden::Place;
use super::stretches::{Smooth, stretches};
use super::wall_samples::SHORT;
use crate::geom::Point;
use crate::geom::polyline::{LinePoint, Polyline, length};
use crate::geom::segment::way;
use crate::geom::spans::Rows;
use crate::units::Coord;

/// A way around a corner of a strip is no longer than this, in line widths: it is a room wide on both sides. A
/// larger value keeps beads on round walls, behind which there is sparse infill.
const TURN: f64 = 15.0;

/// The stretches of the `beads` of layer `k` that lie in `areas`, or beside them by a line at most. The
/// areas are on the two rasters of skins, whose rows are `pitch` apart. Stretches shorter than `least`,
/// in line widths, are left out.
#[must_use]
pub fn needed(
    k: usize,
    beads: Vec<Polyline>,
    areas: &[Rows; 2],
    pitch: Coord,
    least: f64,
) -> Vec<Polyline> {
    if beads.is_empty() {
        return beads;
    }
    let near = [0, 1].map(|r| areas[r].dilate(pitch, pitch));
    let near = Place::new(k, &near, pitch);
    let [close, least] = [SHORT, least].map(|lines| lines * f64::from(pitch));
    let smooth = Smooth { close, least, ..Smooth::default() };
    let is_needed = |p: &LinePoint| near.holds(Point { x: p.u, y: p.v });
    let most = TURN * f64::from(pitch);
    let joined = |bead: &Polyline| {
        let closes = bead.first() == bead.last();
        joined(stretches(bead, pitch, smooth, is_needed), (most, closes))
    };
    beads.iter().flat_map(joined).collect()
}

/// The stretches of a bead that pass, joined by those between them that go around a corner of a strip: there the
/// strip is wider than a room, but for a short way.
fn joined(stretches: Vec<(bool, Polyline)>, (most, closes): (f64, bool)) -> Vec<Polyline> {
    let count = stretches.len();
    let mut out: Vec<Polyline> = Vec::new();
    let mut goes_on = false;
    for (k, (passes, stretch)) in stretches.into_iter().enumerate() {
        let is_short = || length(&stretch) as f64 <= most;
        // Stretches pass in turn: the next one does. That after the last one of a ring is its first.
        let is_between = goes_on && (k + 1 < count || closes);
        let kept = passes || is_between && is_short() && turns_inwards(&stretch);
        match out.last_mut().filter(|_| kept && goes_on) {
            Some(last) => last.extend_from_slice(&stretch[1..]),
            None if kept => out.push(stretch),
            None => {}
        }
        goes_on = kept;
    }
    out
}

/// Whether a stretch turns by more than 45° to the left, where the solid lies: as inside a corner, and not as from
/// the flank of one tooth to the foot of the next.
fn turns_inwards(stretch: &[LinePoint]) -> bool {
    let at = |p: &LinePoint| [f64::from(p.u), f64::from(p.v)];
    let ways: Vec<[f64; 2]> = stretch.windows(2).map(|w| way(at(&w[0]), at(&w[1]))).collect();
    let left = |w: &[[f64; 2]]| {
        let ([x, y], [u, v]) = (w[0], w[1]);
        libm::atan2(x * v - y * u, x * u + y * v).max(0.0)
    };
    ways.windows(2).map(left).sum::<f64>() > std::f64::consts::FRAC_PI_4
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::spans::Span;

    const W: Coord = 4_000;

    /// Rows from `first` to `last`, `from` to `to` long.
    fn rows(first: i32, last: i32, (from, to): (Coord, Coord)) -> Rows {
        let mut rows = Rows::starting_at(first);
        let spans = |out: &mut Vec<Span>| out.push(Span { start: from, end: to });
        (first..=last).for_each(|_| rows.push_row(spans));
        rows
    }

    #[test]
    fn a_bead_from_room_to_room_is_parted_but_one_over_a_short_gap_is_not() {
        let bead = |to: Coord| -> Polyline {
            [0, to].map(|u| LinePoint { u, v: 10 * W, width: W }).to_vec()
        };
        // Rooms up to 5 mm, and after a gap. Columns tell of none.
        let room = |from: Coord, to: Coord| rows(5, 15, (from, to));
        let lengths = |gap: Coord| -> Vec<Coord> {
            let areas = [room(0, 50_000).or(&room(50_000 + gap, 150_000)), Rows::default()];
            let needed = needed(0, vec![bead(150_000)], &areas, W, SHORT);
            needed.iter().map(|bead| bead[bead.len() - 1].u - bead[0].u).collect()
        };
        assert_eq!(lengths(15_000), [150_000]);
        let parted = lengths(25_000);
        assert_eq!(parted.len(), 2, "{parted:?}");
        assert!(parted[0] < 57_000 && parted[1] < 82_000, "{parted:?}");
    }
}
