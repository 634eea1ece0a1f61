//! Walls and exposed rows of two crossing rasters -> Beads: narrow skin along the walls.
//!
//! Words: a *wall sample* is a place on a wall, with the depth of the skin behind it. A *lap* is
//! all samples of one closed wall. The *index* of a bead counts from the wall, from 0. A *place*
//! is a point of a bead. An *arc* is a stretch of a lap along which a bead runs.
//!
//! On a slope, skin is a ring hardly wider than a line just inside the wall; on a blade it is a
//! strip. Zigzags there would be all turns. So what one to three beads can cover is laid along
//! the wall, and deeper skin stays for lines. Between two walls the beads of both share the width.
//!
//! Algorithm:
//! 1. Sample the walls (`wall_samples`). A row that crosses the inner edge of the walls gives the
//!    exact depth of the skin there, and roughly the distance to the wall on the other side. Of the two
//!    rasters, one always crosses the wall at 45° or steeper.
//! 2. For each lap and bead index, offset each sample to the place of that bead. Skip places too
//!    near to another wall, and mitres beyond one, split the lap where a bead ends, and drop short arcs.
//!    Around a small curve the sides of a bead are shorter than those of the wall: skip places that are nearer to
//!    the wall than they should be, or further from it. There the bead would run backwards.
//! 3. Decimate each arc to the places where the bead bends or its width changes.

use super::crossed::Crossed;
use super::near::{Edge, Near};
use super::params::BeadParams;
use super::scan::around_in_part;
use super::taper::{self, distance, go_on, tapered};
use super::wall_samples::{MOST_BEADS, SHORT, WallSample, facing, samples};
use crate::geom::frame::Frame;
use crate::geom::polyline::{LinePoint, Polyline};
use crate::geom::raster::Raster;
use crate::geom::segment::dot;
use crate::geom::spans::Rows;
use crate::geom::{Contour, Point};
use crate::units::Coord;

/// Tolerance by which beads may be too near to a wall, in line widths, because the walls of a strip
/// are not quite parallel. A smaller value breaks beads in tapering strips; a larger one lets
/// beads overlap walls.
const SLACK: f64 = 0.15;

/// The square of the length from which on a normal is that of a corner: rounding.
const LONGER: f64 = 1.0 + 1e-9;

/// The square of the length of the mitre at a right angle, and rounding.
const RIGHT_ANGLE: f64 = 2.0 + 1e-6;

/// Cosine of the turn between the side of a place and those that go on as it does: 50°. A bead beside sides
/// shorter than its distance would run backwards. A larger turn takes the end of a pointed room for such a side.
const ALIKE: f64 = 0.64;

/// A place may be nearer to its wall by this much (2 µm): rounding.
const ROUNDING: f64 = 20.0;

/// A point of a bead.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Place {
    at: [f64; 2],
    width: f64,
    /// Minimum distance from all walls.
    clear: f64,
    /// The normal of the side that it lies beside; longer than 1 beside a corner.
    normal: [f64; 2],
}

impl Place {
    /// How much further than the wall itself the bead runs at a corner, on each side of it. `w` is a line's width.
    fn overshoot(&self, w: f64) -> f64 {
        let [x, y] = self.normal;
        let square = x * x + y * y;
        // The mitre of a sharper corner may lie beyond the wall on the other side.
        if square > RIGHT_ANGLE {
            0.0
        } else {
            (self.clear + SLACK * w) * (square - 1.0).max(0.0).sqrt()
        }
    }
}

/// What beads keep away from.
struct Around {
    /// The innermost walls.
    walls: Near,
    /// Beads that lie between them already.
    middle: Option<Near>,
}

impl Around {
    /// Whether places of a bead of this `width` are `clear` of walls, and on no middle bead.
    fn is_free<const N: usize>(&self, places: [[f64; 2]; N], clear: f64, width: f64) -> bool {
        let is_beside = |middle: &Near| middle.is_free(places, width / 2.0);
        self.walls.is_free(places, clear) && self.middle.as_ref().is_none_or(is_beside)
    }
}

/// The beads that cover the narrow parts of the exposed skin `crossed` along `walls`. These are
/// the innermost walls, in the frame of the raster that is printed; `middle` are the beads between them.
#[must_use]
pub fn wall_beads(
    walls: &[Contour],
    middle: &[Contour],
    crossed: &Crossed<'_>,
    params: &BeadParams,
) -> Vec<Polyline> {
    if crossed.skin.is_empty() && crossed.columns.is_empty() {
        return Vec::new();
    }
    let Some((laps, walls)) = samples(walls, crossed, params) else { return Vec::new() };
    let float = |p: Point| [f64::from(p.x), f64::from(p.y)];
    let sides = middle.iter().flat_map(|b| b.windows(2)).map(|p| [float(p[0]), float(p[1])]);
    let near = |sides: Vec<_>| Near::of_edges(sides, 2.0 * f64::from(params.line_width));
    let near = Around { walls, middle: (!middle.is_empty()).then(|| near(sides.collect())) };
    let mut out = Vec::new();
    for lap in &laps {
        for index in 0..MOST_BEADS {
            for arc in arcs(lap, index, &near, params) {
                out.push(bead(&arc));
            }
        }
    }
    out
}

/// The place of bead `index` at a sample. `None` if there is no such bead, or if another wall is
/// too near.
fn place(sample: &WallSample, index: usize, near: &Around, params: &BeadParams) -> Option<Place> {
    let w = f64::from(params.line_width);
    let (count, width) = sample.laid(params);
    if index >= count {
        return None;
    }
    let away = w / 2.0 + (index as f64 + 0.5) * width;
    let [x, y] = [0, 1].map(|k| sample.at[k] + away * sample.normal[k]);
    let clear = away - SLACK * w;
    // A mitre is long: beyond the wall on the other side is no place either.
    let square = dot(sample.normal, sample.normal);
    let long = square.sqrt();
    let unit = sample.normal.map(|side| side / long);
    if square > LONGER && near.walls.hit(sample.at, unit, away * long).is_some() {
        return None;
    }
    let goes_on = |edge: Edge| facing(unit, edge) < -ALIKE;
    if near.walls.has([x, y], away - ROUNDING, goes_on) {
        return None;
    }
    // The two sides of a corner that sticks out may be too short to meet there.
    let has_wall = |far: f64| !near.walls.is_free([[x, y]], far);
    if square > LONGER && !has_wall(away + ROUNDING) && has_wall(away * long - ROUNDING) {
        return None;
    }
    near.is_free([[x, y]], clear, width).then_some(Place {
        at: [x, y],
        width,
        clear,
        normal: sample.normal,
    })
}

/// The arcs of bead `index` on a lap, without those that are too short. An arc that goes all
/// around the wall ends where it begins.
fn arcs(lap: &[WallSample], index: usize, near: &Around, params: &BeadParams) -> Vec<Vec<Place>> {
    let short = SHORT * f64::from(params.line_width);
    // Start where there is no such bead, so that no arc is split. If it goes all around, close it at a place of its own.
    let bare = lap.iter().position(|s| s.beads <= index);
    let own = || lap.iter().position(|s| place(s, index, near, params).is_some());
    let around = lap.iter().cycle().skip(bare.or_else(own).unwrap_or(0));
    let around = around.take(lap.len() + usize::from(bare.is_none()));
    let mut arcs: Vec<Vec<Place>> = Vec::new();
    let mut open = false;
    for sample in around {
        if sample.beads <= index {
            open = false;
            continue;
        }
        // Skip places too near to another wall. At a corner the two sides of the bead then meet.
        let Some(place) = place(sample, index, near, params) else { continue };
        let last = arcs.last_mut().filter(|_| open);
        match last.filter(|a| a.last().is_some_and(|l| joins(l, &place, near, params))) {
            Some(arc) => arc.push(place),
            None => {
                // Room for most arcs: growing from one place would reallocate four times.
                let mut arc = Vec::with_capacity(16);
                arc.push(place);
                arcs.push(arc);
            }
        }
        open = true;
    }
    let step = f64::from(params.line_width) / 2.0;
    arcs.iter_mut().for_each(|arc| go_on(arc, step, |place| place.at));
    arcs.retain(|arc| length(arc) >= short);
    arcs
}

/// Whether a bead may go straight from one place to the next: they are near, and no wall pokes in
/// between.
fn joins(a: &Place, b: &Place, near: &Around, params: &BeadParams) -> bool {
    let w = f64::from(params.line_width);
    let far = distance(a.at, b.at);
    let clear = a.clear.min(b.clear) - SLACK * w;
    let on_the_way = |t: f64| [0, 1].map(|k| a.at[k] + t * (b.at[k] - a.at[k]));
    let places = || [0.25, 0.5, 0.75].map(on_the_way);
    let most = SHORT * w + a.overshoot(w).max(b.overshoot(w));
    far <= w / 2.0 || far <= most && near.is_free(places(), clear, a.width.min(b.width))
}

/// The area on `raster` that `beads`, given in `frame`, keep free of lines. Lines overlap with
/// beads as they do with walls.
#[must_use]
pub fn taken(beads: &[Polyline], frame: Frame, raster: Raster, params: &BeadParams) -> Rows {
    let more = params.line_width / 2 - params.overlap;
    beside(beads, frame, raster, |width| (width / 2 + more).max(0))
}

/// The area on `raster` within a `radius` of `beads`, given in `frame`, by their width at each place.
#[must_use]
pub fn beside(
    beads: &[Polyline],
    frame: Frame,
    raster: Raster,
    radius: impl Fn(Coord) -> Coord,
) -> Rows {
    let leave = |p: &LinePoint| frame.leave(Point { x: p.u, y: p.v });
    let ways = beads.iter().flat_map(|b| b.windows(2));
    around_in_part(ways.map(|w| (leave(&w[0]), leave(&w[1]), radius(w[1].width))), raster)
}

fn length(arc: &[Place]) -> f64 {
    arc.windows(2).map(|w| distance(w[0].at, w[1].at)).sum()
}

/// The points of a bead, decimated to those where it bends or changes its width.
fn bead(arc: &[Place]) -> Polyline {
    let places: Vec<taper::Place> =
        arc.iter().map(|p| taper::Place { at: p.at, width: p.width }).collect();
    let (points, widths) = tapered(&places);
    points.iter().zip(widths).map(|(p, width)| LinePoint { u: p.x, v: p.y, width }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::polygon;
    use crate::profile;
    use crate::region::RegionParams;
    use crate::region::scan::Scan;
    use crate::units::{nearest, sin_cos};

    /// The beads of a part with one wall and lines along x, whose skin is exposed up to `covered`
    /// from its contour.
    fn beads(part: &[Contour], covered: Coord) -> (Vec<Polyline>, BeadParams) {
        exposed(part, |scan, _| scan.inset(covered))
    }

    /// The same, whose skin is exposed but for what `covered` gives of its scan on a raster.
    fn exposed(
        part: &[Contour],
        covered: impl Fn(&Scan, Raster) -> Rows,
    ) -> (Vec<Polyline>, BeadParams) {
        let mut settings = profile::load(["generic-marlin"], &[]).unwrap().settings;
        settings.angle = profile::Angle::Degrees(0.0);
        settings.walls = 1;
        let params = RegionParams::new(&settings);
        let rows = |r: usize| {
            let raster = params.rasters.skin(r);
            let scan = Scan::new(part, raster);
            let fill = scan.inset(params.insets.fill);
            (fill.minus(&covered(&scan, raster)), fill)
        };
        let ((skin, fill), (columns, fill_columns)) = (rows(0), rows(1));
        let crossed = Crossed {
            skin: &skin,
            fill: &fill,
            columns: &columns,
            fill_columns: &fill_columns,
            left_turn: true,
        };
        let walls = polygon::inset(part, params.walls.outer_inset);
        (wall_beads(&walls, &[], &crossed, &params.beads), params.beads)
    }

    fn block(width: Coord, depth: Coord) -> Vec<Contour> {
        let p = |x, y| Point { x, y };
        vec![vec![p(0, 0), p(width, 0), p(width, depth), p(0, depth)]]
    }

    #[test]
    fn a_ring_of_skin_is_a_closed_bead_beside_the_wall() {
        // Exposed up to 1 mm from the contour: 0.6 mm from the wall's inner edge.
        let (beads, params) = beads(&block(200_000, 150_000), 10_000);
        assert_eq!(beads.len(), 1, "{beads:?}");
        assert_eq!(beads[0].first().map(|p| (p.u, p.v)), beads[0].last().map(|p| (p.u, p.v)));
        for p in &beads[0] {
            let away = p.u.min(p.v).min(200_000 - p.u).min(150_000 - p.v);
            assert!((p.width - 6_000).abs() <= 2, "{p:?}");
            assert!((away - params.line_width - p.width / 2).abs() <= 2, "{p:?}");
        }
    }

    #[test]
    fn deeper_skin_takes_more_beads_and_wide_skin_none() {
        let lay = |covered: Coord| beads(&block(200_000, 150_000), covered).0.len();
        assert_eq!([lay(14_000), lay(20_000), lay(26_000), lay(60_000)], [2, 3, 0, 0]);
    }

    /// What covers the rest comes near to a wall that goes on beside deep skin.
    #[test]
    fn a_strip_that_is_short_for_its_depth_is_left_to_lines() {
        let p = |x, y| Point { x, y };
        let lay = |length: Coord| {
            let cover = [vec![
                p(60_000, 12_000),
                p(60_000 + length, 12_000),
                p(60_000 + length, 90_000),
                p(60_000, 90_000),
            ]];
            let covered = |_: &Scan, raster| Scan::new(&cover, raster).inside().clone();
            exposed(&block(300_000, 150_000), covered).0.len()
        };
        assert_eq!([lay(30_000), lay(60_000), lay(120_000)], [0, 0, 2]);
    }

    #[test]
    fn a_solid_layer_has_no_beads_not_even_in_its_corners() {
        let (beads, _) = beads(&block(200_000, 150_000), 100_000);
        assert!(beads.is_empty(), "{beads:?}");
    }

    #[test]
    fn beads_in_a_round_pin_never_step_back() {
        for (corners, radius) in [(48, 9_000.0), (48, 10_000.0)] {
            let at = |k: usize| {
                let (sin, cos) = sin_cos(360.0 * k as f64 / corners as f64);
                Point { x: nearest(radius * cos) as Coord, y: nearest(radius * sin) as Coord }
            };
            let (beads, _) = beads(&[(0..corners).map(at).collect()], 50_000);
            for bead in &beads {
                let step = |p: &[LinePoint]| [p[1].u - p[0].u, p[1].v - p[0].v].map(f64::from);
                let steps: Vec<[f64; 2]> = bead.windows(2).map(step).collect();
                assert!(steps.windows(2).all(|s| dot(s[0], s[1]) > 0.0), "{radius}: {bead:?}");
            }
            assert!(!beads.is_empty(), "{radius}");
        }
    }

    #[test]
    fn both_sides_of_a_strip_share_its_width() {
        // 1.7 mm with walls, 0.9 mm inside them: one closed bead that turns at the ends.
        let (beads, _) = beads(&block(300_000, 17_000), 10_000);
        assert_eq!(beads.len(), 1, "{beads:?}");
        for p in beads.iter().flatten().filter(|p| p.u > 20_000 && p.u < 280_000) {
            assert!((p.width - 4_500).abs() <= 2, "{p:?}");
            assert!([6_250, 10_750].iter().any(|v| (p.v - v).abs() <= 2), "{p:?}");
        }
    }

    /// The beads of a strip roughly along x that is 1.24 mm wide at its middle, walls included. It
    /// is `lean` narrower on the right than on the left, and rises by `turn` from left to right.
    fn leaning(lean: Coord, turn: Coord) -> Vec<Polyline> {
        let p = |x, y| Point { x, y };
        let (left, right) = (-turn / 2, turn / 2);
        let half = 6_200;
        beads(
            &[vec![
                p(0, left - half - lean / 4),
                p(300_000, right - half + lean / 4),
                p(300_000, right + half - lean / 4),
                p(0, left + half + lean / 4),
            ]],
            10_000,
        )
        .0
    }

    #[test]
    fn one_of_two_walls_lays_the_bead_between_them_whichever_way_they_lean() {
        for lean in [-800, -40, 0, 40, 800] {
            for turn in [-3_000, -300, -10, 0, 10, 300, 3_000] {
                let beads = leaning(lean, turn);
                assert_eq!(beads.len(), 1, "lean {lean} turn {turn}: {beads:?}");
                let steps = beads[0].windows(2).map(|w| f64::from((w[1].u - w[0].u).abs()));
                let length: f64 = steps.sum();
                assert!(
                    (284_000.0..=292_000.0).contains(&length),
                    "lean {lean} turn {turn}: {length}"
                );
            }
        }
    }

    #[test]
    fn a_strip_too_thin_for_two_gets_one_bead_along_its_middle() {
        let (beads, _) = beads(&block(300_000, 13_000), 10_000);
        assert_eq!(beads.len(), 1, "{beads:?}");
        for p in &beads[0] {
            assert!((p.width - 5_000).abs() <= 2 && (p.v - 6_500).abs() <= 2, "{p:?}");
        }
        let length = beads[0][0].u - beads[0].last().unwrap().u;
        assert!(length.abs() > 280_000, "{length}");
    }

    #[test]
    fn a_square_on_its_corner_gets_the_same_ring_wherever_rows_lie() {
        // Every row ends beside a corner. 1.25 mm inside the walls: two beads of half of it.
        let half = 14_500;
        for (x, y) in [(0, 0), (0, 1_000), (1_300, 2_100), (2_000, 2_000), (700, 3_100)] {
            let p = |u, v| Point { x: x + u, y: y + v };
            let (beads, _) =
                beads(&[vec![p(-half, 0), p(0, -half), p(half, 0), p(0, half)]], 60_000);
            assert_eq!(beads.len(), 1, "{x} {y}: {beads:?}");
            for p in &beads[0] {
                let away = (p.u - x).abs() + (p.v - y).abs();
                assert!(
                    (p.width - 6_253).abs() <= 2 && (away - 4_422).abs() <= 2,
                    "{x} {y}: {p:?}"
                );
            }
        }
    }

    #[test]
    fn a_ring_turns_in_corners_a_little_sharper_than_square() {
        // A square of 1.25 mm inside the walls whose corners are up to 2° off.
        let p = |u, v| Point { x: u, y: v };
        let (beads, _) =
            beads(&[vec![p(-14_420, -220), p(200, -14_630), p(14_610, 0), p(0, 14_410)]], 60_000);
        assert_eq!(beads.iter().map(Vec::len).collect::<Vec<_>>(), [5], "{beads:?}");
    }

    #[test]
    fn a_room_that_narrows_to_a_point_gets_no_ring_as_narrow_as_the_point() {
        for half in (9_000..=16_000).step_by(500) {
            for long in (14_000..=30_000).step_by(2_000) {
                let p = |x, y| Point { x, y };
                let drop =
                    [p(-long, 0), p(0, -half), p(half, -half / 2), p(half, half / 2), p(0, half)];
                let (beads, params) = beads(&[drop.to_vec()], 60_000);
                let pairs = beads.iter().flat_map(|bead| bead.windows(2));
                let narrow = pairs.filter(|p| 10 * p[1].width < 7 * params.line_width);
                let at = |p: &LinePoint| Point { x: p.u, y: p.v };
                let narrow: f64 = narrow.map(|p| at(&p[0]).distance(at(&p[1]))).sum();
                // The taper itself, and no ring of 4 mm.
                assert!(narrow < 20_000.0, "{half} {long}: {narrow}");
            }
        }
    }
}
