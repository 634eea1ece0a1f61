//! Wall beads + the layer below -> beads that do not hang where a bridge holds.
//!
//! Words: a *ledge* is an open island that is held from outside, such as the roof of a counterbore around its hole.
//!
//! A ledge is narrow skin, so that beads run around in it, on nothing and held by nothing. Straight lines that begin
//! and end on what carries the ledge take their place. Where the part ends beside an open island, as at the bottom of a
//! ball, lines would begin or end in the air: there beads stay, each beside one that holds. Beads stay as well where
//! they run as the lines would, such as in a narrow bar between two pillars, and in a roof hardly wider than its walls.
//!
//! Algorithm: divide what is open into islands, as if there were no beads. Where more of the beads hangs than may sag,
//! ask for the best direction of lines and what part of their ends is free. Of each bead, cut out the stretches that
//! lie in a ledge and run across its lines.

use super::direction::Direction;
use super::loose::{ALONG, Beads};
use super::sides::STEP;
use super::{MOST_FREE, Open, Pair};
use crate::geom::Point;
use crate::geom::islands::Islands;
use crate::geom::polyline::{LinePoint, Polyline};
use crate::geom::segment::dot;
use crate::region::params::RegionParams;
use crate::region::stretches::{Piece, Smooth, parted, pieces, stretches};
use crate::units::{Coord, sin_cos};

/// Most ends of lines, by length, that are free in a ledge. Where one side of each line is free it is a half.
const FREE: f64 = 0.45;

/// Shorter pieces between those in a ledge, and beside them, are left out as well, in line widths: what lies between
/// two rows of the ledge is on none.
const SHORT: f64 = 3.0;

/// Divides the beads of a pair into those that may stay, and what would hang in a ledge; `None` if all stay.
#[must_use]
pub fn held(pair: Pair<'_>, open: &Open<'_>, params: &RegionParams) -> Option<Beads> {
    if pair.beads.is_empty() || open.rows.is_empty() {
        return None;
    }
    let (islands, pitch) = (Islands::new(&open.rows), open.raster.pitch);
    let hanging = hanging(pair.beads, &islands, pitch);
    let sags = |island: usize| hanging[island] > f64::from(MOST_FREE);
    if !(0..islands.count()).any(sags) {
        return None;
    }
    let is_ledge = |found: &Direction| found.free < FREE;
    let found = open.directions(pair, &islands, sags, params);
    let turns = found.iter().map(|found| found.filter(is_ledge).map(|found| found.turn)).collect();
    let ledges = Ledges { islands: &islands, pitch, turns };
    let mut out = Beads::default();
    for bead in pair.beads {
        ledges.divide(bead, &mut out);
    }
    Some(out)
}

/// How much of the `beads` lies in each of the `islands`.
fn hanging(beads: &[Polyline], islands: &Islands<'_>, pitch: Coord) -> Vec<f64> {
    let mut lengths = vec![0.0; islands.count()];
    for piece in beads.iter().flat_map(|bead| pieces(bead, pitch / 2)) {
        if let Some(island) = island(islands, pitch, &piece.middle()) {
            lengths[island] += piece.length;
        }
    }
    lengths
}

/// The island at a place.
fn island(islands: &Islands<'_>, pitch: Coord, p: &LinePoint) -> Option<usize> {
    islands.beside(Point { x: p.u, y: p.v }, pitch)
}

/// The ledges among the islands of a layer, and the directions of their lines.
struct Ledges<'a> {
    islands: &'a Islands<'a>,
    pitch: Coord,
    turns: Vec<Option<usize>>,
}

impl Ledges<'_> {
    /// The direction of lines at a place.
    fn turn(&self, p: &LinePoint) -> Option<usize> {
        self.turns[island(self.islands, self.pitch, p)?]
    }

    fn divide(&self, bead: &[LinePoint], out: &mut Beads) {
        let least = SHORT * f64::from(self.pitch);
        let smooth = Smooth { least, ..Smooth::default() };
        let is_held = |p: &LinePoint| self.turn(p).is_none();
        let all = stretches(bead, self.pitch / 2, smooth, is_held);
        let stays = |(held, stretch): (bool, Polyline)| (held || !self.hangs(&stretch), stretch);
        let [kept, cut] = parted(all.into_iter().map(stays));
        if cut.is_empty() {
            out.kept.push(bead.to_vec());
        } else {
            out.kept.extend(kept);
            out.cut.extend(cut);
        }
    }

    /// Whether a stretch runs in ledges across their lines for so long that it sags.
    fn hangs(&self, stretch: &[LinePoint]) -> bool {
        let across = |piece: Piece| {
            let (sin, cos) = sin_cos(STEP * self.turn(&piece.middle())? as f64);
            let along = dot(piece.way(), [cos, sin]).abs();
            (along < ALONG * piece.length).then_some(piece.length)
        };
        let lengths = pieces(stretch, self.pitch / 2).into_iter().filter_map(across);
        lengths.sum::<f64>() > f64::from(MOST_FREE)
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{params, rectangle};
    use super::*;
    use crate::geom::Contour;
    use crate::region::per_raster::skin_turn;
    use crate::region::prepare::prepare;
    use crate::slice::Layer;
    use crate::units::to_units;

    /// What stays of `bead` on a layer with contours `upper` on one with `lower`.
    fn staying(upper: &[Contour], lower: &[Contour], bead: &[Point]) -> Beads {
        let params = params();
        let layer = |index: usize, contours: &[Contour]| {
            let contours = contours.to_vec();
            prepare(Layer { index, z: 0, height: 2_000, contours, closed_gap: 0 }, &params)
        };
        let ((below, below_rows), (own, rows)) = (layer(0, lower), layer(1, upper));
        let layers = |k: usize| [&below_rows, &rows].get(k).copied();
        let frame = params.rasters.skin(skin_turn(1).0).frame;
        let point = |p: &Point| {
            let Point { x, y } = frame.enter(*p);
            LinePoint { u: x, v: y, width: 4_000 }
        };
        let beads = [bead.iter().map(point).collect()];
        let open = Open::new(1, &layers, &params).unwrap();
        let pair = Pair { own: &own, below: &below.layer, beads: &beads };
        held(pair, &open, &params).unwrap_or_else(|| Beads { kept: beads.into(), cut: Vec::new() })
    }

    /// A circle with 48 corners; with a negative radius it goes around a hole.
    fn circle(radius: f64) -> Contour {
        let corner = |k: i32| {
            let (sin, cos) = sin_cos(7.5 * f64::from(k) * radius.signum());
            Point { x: to_units(radius.abs() * cos), y: to_units(radius.abs() * sin) }
        };
        (0..48).map(corner).collect()
    }

    fn ring(radius: f64) -> Contour {
        let mut ring = circle(radius);
        ring.push(ring[0]);
        ring
    }

    #[test]
    fn a_ring_that_hangs_in_the_roof_of_a_counterbore_is_left_to_lines() {
        let plate = rectangle([-20.0, 20.0], [-20.0, 20.0]);
        for (hole, bore, bead) in [(1.6, 3.6, 2.6), (2.5, 5.0, 3.6), (4.0, 7.0, 5.0)] {
            let upper = [plate.clone(), circle(-hole)];
            let found = staying(&upper, &[plate.clone(), circle(-bore)], &ring(bead));
            assert!(found.kept.is_empty(), "{hole}: {found:?}");
            // It lies on the plate.
            let found = staying(&upper, &[plate.clone(), circle(-hole)], &ring(bead));
            assert_eq!((found.kept.len(), found.cut.len()), (1, 0), "{hole}");
        }
    }

    #[test]
    fn a_ring_in_a_roof_hardly_wider_than_its_walls_stays_beside_them() {
        let plate = rectangle([-20.0, 20.0], [-20.0, 20.0]);
        let upper = [plate.clone(), circle(-1.6)];
        let found = staying(&upper, &[plate, circle(-2.9)], &ring(2.6));
        assert_eq!((found.kept.len(), found.cut.len()), (1, 0), "{found:?}");
    }

    #[test]
    fn a_ring_around_what_carries_it_stays() {
        let found = staying(&[circle(13.0)], &[circle(10.0)], &ring(11.5));
        assert_eq!((found.kept.len(), found.cut.len()), (1, 0), "{found:?}");
    }

    /// Wherever its ends lie to the steps in which it is looked at.
    #[test]
    fn straight_beads_along_a_channel_are_left_to_lines() {
        let block = rectangle([-20.0, 20.0], [-10.0, 10.0]);
        let below = |from: f64| {
            let channel: Contour = rectangle([from, 14.0], [-0.9, 0.9]).into_iter().rev().collect();
            [block.clone(), channel]
        };
        for k in 0..20 {
            let from = -14.0 + 0.037 * f64::from(k);
            // Its ends are held for less than what is left out with the rest, or for nothing.
            for held in [0.0, 0.3, 1.0] {
                let ends = [from - held, 14.0].map(|x| Point { x: to_units(x), y: 1_000 });
                let found = staying(std::slice::from_ref(&block), &below(from), &ends);
                assert!(found.kept.is_empty(), "{k} {held}: {found:?}");
            }
        }
    }

    #[test]
    fn a_bead_along_a_bar_between_two_pillars_stays() {
        let bar = rectangle([-20.0, 20.0], [-1.0, 1.0]);
        let pillars =
            [rectangle([-20.0, -12.0], [-1.0, 1.0]), rectangle([12.0, 20.0], [-1.0, 1.0])];
        let ends = [-19.0, 19.0].map(|x| Point { x: to_units(x), y: 0 });
        let found = staying(&[bar], &pillars, &ends);
        assert_eq!((found.kept.len(), found.cut.len()), (1, 0), "{found:?}");
    }
}
