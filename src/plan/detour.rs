//! Travel + contours -> Detour: the way round a hole or a corner, where the straight way leaves the part.
//!
//! - The *rail* of a contour follows it inside the part, at the distance of a line's width.
//! - The *clearance* is the least distance of a way to the outline. Nearer, a string would show.
//! - To *tighten* a way is to leave out corners that it can pass by.
//!
//! 1. Find where the straight way crosses the contours, in order.
//! 2. The way leaves the part over some contour. Go along its rail to the last place where the
//!    straight way crosses the same contour, on the shorter side of the two. Go on from there.
//! 3. Tighten the way, first from its beginning, then from its end.
//! 4. A way that comes too near to an outline is none: necks are too narrow, or the two ends lie in
//!    different bodies. So is one that is longer than the settings allow.
//!
//! Rails are simple: each corner is moved by itself, so that they may cross themselves in narrow
//! places. Step 4 sorts those out; nothing depends on rails being right.

use super::crossings::Crossings;
use crate::geom::{Contour, Point, side};
use crate::units::{Coord, nearest};

/// Most corners of a way before it is tightened. Ways along more are hardly ever short enough; the
/// limit keeps the time of a travel bounded.
const MOST_CORNERS: usize = 400;

/// How far a corner of a rail may lie from the contour's, in distances of the rail. Sharper corners
/// are cut short. Any value above 1 works; a large one makes ways run far into acute corners.
const MITRE: f64 = 2.0;

/// How ways are found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct DetourParams {
    /// How much longer than the straight way one may be, grid units.
    pub(super) most_more: Coord,
    /// Longer ways are none, since they retract anyway, grid units.
    pub(super) longest: Coord,
    /// Distance of rails to the contour, grid units.
    pub(super) rail: Coord,
    /// Least distance of a way to the contour, grid units.
    pub(super) clearance: Coord,
}

/// The points between `from` and `to` of the shortest way that leaves the part nowhere, if there is
/// one that is short enough. The straight way must leave it.
pub(super) fn detour(
    (from, to): (Point, Point),
    contours: &[Contour],
    crossings: &Crossings,
    params: &DetourParams,
) -> Option<Vec<Point>> {
    let straight = from.distance(to);
    let longest = (straight + f64::from(params.most_more)).min(f64::from(params.longest));
    if straight > longest {
        return None;
    }
    let way = along_rails((from, to), contours, crossings, params)?;
    if !crossings.holds(from) || !crossings.holds(to) {
        return None;
    }
    let free = |a: Point, b: Point| !crossings.is_near(a, b, params.clearance);
    let mut way = tighten(&way, free)?;
    way.reverse();
    let mut way = tighten(&way, free)?;
    way.reverse();
    let length: f64 = way.windows(2).map(|ends| ends[0].distance(ends[1])).sum();
    (length <= longest).then(|| way[1..way.len() - 1].to_vec())
}

/// A place where the straight way crosses an edge: how far along it, the contour, and the edge.
type Crossing = (f64, usize, usize);

/// Where the way crosses the contours, in order.
fn crossed((from, to): (Point, Point), crossings: &Crossings) -> Vec<Crossing> {
    let mut found = Vec::new();
    for edge in crossings.met(from, to) {
        let (p, q) = edge.ends;
        // An end on the way belongs to the edge on one side of it, so that none counts twice.
        let (left, right) = (side(from, to, p), side(from, to, q));
        if (left > 0) != (right > 0) {
            let (a, b) = (side(p, q, from) as f64, side(p, q, to) as f64);
            let along = if a == b { 0.0 } else { a / (a - b) };
            found.push((along, edge.of.0 as usize, edge.of.1 as usize));
        }
    }
    found.sort_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
    // An edge may lie in several bands.
    found.dedup();
    found
}

/// The way along the rails of the contours that the straight way crosses.
fn along_rails(
    (from, to): (Point, Point),
    contours: &[Contour],
    crossings: &Crossings,
    params: &DetourParams,
) -> Option<Vec<Point>> {
    let crossed = crossed((from, to), crossings);
    let mut way = vec![from];
    let mut next = 0;
    while let Some(&(_, c, leaves)) = crossed.get(next) {
        let last = crossed.iter().rposition(|one| one.1 == c).filter(|&last| last > next)?;
        way.extend(rail(&contours[c], (leaves, crossed[last].2), params.rail)?);
        next = last + 1;
    }
    way.push(to);
    (way.len() > 2 && way.len() <= MOST_CORNERS).then_some(way)
}

/// The shorter rail along a contour from one of its edges to another.
fn rail(contour: &[Point], (from, to): (usize, usize), distance: Coord) -> Option<Vec<Point>> {
    let n = contour.len();
    // Edge k leads from point k to point k + 1.
    let ahead = (to + n - from) % n;
    let forwards: Vec<usize> = (1..=ahead).map(|by| (from + by) % n).collect();
    let backwards: Vec<usize> = (0..n - ahead).map(|by| (from + n - by) % n).collect();
    let length = |ks: &[usize]| -> f64 {
        ks.windows(2).map(|two| contour[two[0]].distance(contour[two[1]])).sum()
    };
    let shorter =
        if ahead == 0 || length(&forwards) <= length(&backwards) { forwards } else { backwards };
    if shorter.len() > MOST_CORNERS {
        return None;
    }
    shorter.into_iter().map(|k| corner(contour, k, distance)).collect()
}

/// Corner `k` of a contour, moved to its left, which is into the part.
fn corner(contour: &[Point], k: usize, distance: Coord) -> Option<Point> {
    let n = contour.len();
    let (p, at, q) = (contour[(k + n - 1) % n], contour[k], contour[(k + 1) % n]);
    let normal = |a: Point, b: Point| {
        let length = a.distance(b);
        let (x, y) = (f64::from(b.x - a.x), f64::from(b.y - a.y));
        (length > 0.0).then(|| [-y / length, x / length])
    };
    let (before, after) = (normal(p, at)?, normal(at, q)?);
    let both = [before[0] + after[0], before[1] + after[1]];
    let square = both[0] * both[0] + both[1] * both[1];
    // The mitre lies at 2 / |both| distances. Of a corner that folds back it has no direction.
    let by = if square > 0.0 { (2.0 / square).min(MITRE / square.sqrt()) } else { 0.0 };
    let place = |at: Coord, way: f64| nearest(f64::from(at) + way * by * f64::from(distance));
    Some(Point { x: place(at.x, both[0]) as Coord, y: place(at.y, both[1]) as Coord })
}

/// The way without the corners that it can pass by; `None` if it is free nowhere.
fn tighten(way: &[Point], free: impl Fn(Point, Point) -> bool) -> Option<Vec<Point>> {
    let mut out = vec![*way.first()?];
    let mut at = 0;
    while at + 1 < way.len() {
        // Corners of a rail that lie in a narrow place are passed by as well: of the next few, the
        // last that is free, and from there on as long as it stays free.
        let reach = (at + 1..way.len().min(at + 1 + SKIPPED)).rev();
        let mut next = reach.into_iter().find(|&k| free(way[at], way[k]))?;
        while next + 1 < way.len() && free(way[at], way[next + 1]) {
            next += 1;
        }
        at = next;
        out.push(way[at]);
    }
    Some(out)
}

/// So many corners of a way are tried at once where some of them cannot be reached. More cost time
/// for each travel; fewer give up at small teeth of a contour.
const SKIPPED: usize = 8;

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const PARAMS: DetourParams =
        DetourParams { most_more: 60_000, longest: 120_000, rail: 4_000, clearance: 1_500 };

    fn p(x: Coord, y: Coord) -> Point {
        Point { x, y }
    }

    fn find(contours: &[Contour], from: Point, to: Point) -> Option<Vec<Point>> {
        detour((from, to), contours, &Crossings::new(contours), &PARAMS)
    }

    fn frame() -> Vec<Contour> {
        let outer = vec![p(0, 0), p(200_000, 0), p(200_000, 200_000), p(0, 200_000)];
        let hole =
            vec![p(90_000, 90_000), p(90_000, 110_000), p(110_000, 110_000), p(110_000, 90_000)];
        vec![outer, hole]
    }

    #[test]
    fn a_way_goes_round_a_hole_on_the_shorter_side() {
        let way = find(&frame(), p(70_000, 104_000), p(130_000, 104_000)).unwrap();
        assert_eq!(way, [p(86_000, 114_000), p(114_000, 114_000)]);
        let way = find(&frame(), p(130_000, 96_000), p(70_000, 96_000)).unwrap();
        assert_eq!(way, [p(114_000, 86_000), p(86_000, 86_000)]);
    }

    #[test]
    fn a_way_goes_round_an_outside_corner() {
        let ell = [
            p(0, 0),
            p(100_000, 0),
            p(100_000, 50_000),
            p(50_000, 50_000),
            p(50_000, 100_000),
            p(0, 100_000),
        ];
        let way = find(&[ell.to_vec()], p(45_000, 75_000), p(75_000, 45_000)).unwrap();
        assert_eq!(way, [p(46_000, 46_000)]);
    }

    #[test]
    fn there_is_no_way_to_another_body_or_over_a_long_one() {
        let square =
            |x: Coord| vec![p(x, 0), p(x + 20_000, 0), p(x + 20_000, 20_000), p(x, 20_000)];
        assert_eq!(find(&[square(0), square(30_000)], p(10_000, 10_000), p(40_000, 10_000)), None);
        let deep = [
            p(0, 0),
            p(50_000, 0),
            p(50_000, 150_000),
            p(30_000, 150_000),
            p(30_000, 20_000),
            p(20_000, 20_000),
            p(20_000, 150_000),
            p(0, 150_000),
        ];
        assert_eq!(find(&[deep.to_vec()], p(10_000, 140_000), p(40_000, 140_000)), None);
    }

    proptest! {
        /// Whatever the outline, a way stays inside and is no longer than allowed.
        #[test]
        fn a_way_stays_inside_and_is_short(radii in prop::collection::vec(20_000..90_000i32, 5..40),
                                           hole in prop::collection::vec(2_000..15_000i32, 4..20),
                                           a in 0..360u32, b in 0..360u32) {
            let ring = |radii: &[i32], turn: f64| -> Contour {
                let n = radii.len() as f64;
                let at = |(k, r): (usize, &i32)| {
                    let (sin, cos) = (turn * k as f64 * std::f64::consts::TAU / n).sin_cos();
                    p((f64::from(*r) * cos) as Coord, (f64::from(*r) * sin) as Coord)
                };
                radii.iter().enumerate().map(at).collect()
            };
            let contours = [ring(&radii, 1.0), ring(&hole, -1.0)];
            let crossings = Crossings::new(&contours);
            let place = |degrees: u32| {
                let (sin, cos) = f64::from(degrees).to_radians().sin_cos();
                p((17_500.0 * cos) as Coord, (17_500.0 * sin) as Coord)
            };
            let (from, to) = (place(a), place(b));
            prop_assume!(crossings.leaves(from, to));
            if let Some(way) = detour((from, to), &contours, &crossings, &PARAMS) {
                let all: Vec<Point> = [from].into_iter().chain(way).chain([to]).collect();
                prop_assert!(all.windows(2).all(|w| !crossings.leaves(w[0], w[1])), "{all:?}");
                let length: f64 = all.windows(2).map(|w| w[0].distance(w[1])).sum();
                prop_assert!(length <= 120_000.0 && length <= from.distance(to) + 60_000.0);
            }
        }
    }
}
