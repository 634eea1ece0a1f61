//! Laws over walls, tubes, crosses and wedges of many widths: how much plastic they get, and where.
//!
//! Words: *filled* is plastic over solid; *covered* is the share of the outline that a bead lies along.
//!
//! - Bars, tubes, frames, crosses and wedges are turned by random angles and get one to three walls.
//! - Where walls meet, at corners and crossings, no *hole* stays open: a circle that no bead touches.
//! - Pins are regular polygons of any number of corners, compact enough to have no core.
//! - Nothing reaches out of the part, and loops do not cross themselves.
//! - Wings are round at their nose and sharp at their tail: where loops once turned inside out.

mod shapes;

use super::*;
use crate::geom::frame::Frame;
use crate::geom::raster::Raster;
use crate::geom::{Point, double_area, edges, encloses, segment, side};
use crate::profile;
use crate::region::RegionParams;
use crate::region::scan::Scan;
use crate::units::{nearest, sin_cos};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

const W: f64 = 4_000.0;

/// Beads leave smaller holes where their round corners and ends meet: this radius, 0.25 mm.
const HOLE: f64 = 2_500.0;

fn params(count: u32) -> WallParams {
    let mut settings = profile::load(["generic-marlin"], &[]).unwrap().settings;
    settings.walls = count;
    RegionParams::new(&settings).walls
}

fn at(x: f64, y: f64, degrees: f64) -> Point {
    let (sin, cos) = sin_cos(degrees);
    Point { x: nearest(x * cos - y * sin) as Coord, y: nearest(x * sin + y * cos) as Coord }
}

/// A bar 24 mm long, `first` wide at its left end and `last` at its right one.
fn bar(first: f64, last: f64, degrees: f64) -> Vec<Contour> {
    let (l, a, b) = (120_000.0, first / 2.0, last / 2.0);
    vec![[(-l, -a), (l, -b), (l, b), (-l, a)].map(|(x, y)| at(x, y, degrees)).to_vec()]
}

/// A tube with the outer radius 8 mm.
fn tube(wall: f64, corners: usize) -> Vec<Contour> {
    let ring = |radius: f64| -> Contour {
        (0..corners).map(|k| at(radius, 0.0, 360.0 * k as f64 / corners as f64)).collect()
    };
    vec![ring(80_000.0), ring(80_000.0 - wall).into_iter().rev().collect()]
}

/// Two bars that cross at right angles.
fn cross(width: f64, degrees: f64) -> Vec<Contour> {
    let (l, a) = (60_000.0, width / 2.0);
    let arm = |turn: f64| [(l, -a), (l, a), (a, a)].map(|(x, y)| at(x, y, degrees + turn));
    vec![[0.0, 90.0, 180.0, 270.0].into_iter().flat_map(arm).collect()]
}

/// A triangle, square or other regular polygon with a hole of the same shape, `wall` thick: as far as
/// 5 mm from its middle to a side.
fn frame(wall: f64, corners: usize, degrees: f64) -> Vec<Contour> {
    let ring = |size: f64| pin(2.0 * size, corners, degrees, 1.0).remove(0);
    vec![ring(50_000.0), ring(50_000.0 - wall).into_iter().rev().collect()]
}

/// A block of 8 mm with a fin of 10 mm at one of its sides.
fn fin(width: f64, degrees: f64) -> Vec<Contour> {
    let (b, l, a) = (40_000.0, 140_000.0, width / 2.0);
    let corners = [(-b, -b), (b, -b), (b, -a), (l, -a), (l, a), (b, a), (b, b), (-b, b)];
    vec![corners.map(|(x, y)| at(x, y, degrees)).to_vec()]
}

/// The radius of the largest circle in the part that touches no bead and does not lie in the core, in
/// steps of 0.1 mm.
fn hole(contours: &[Contour], Walls { walls, core, .. }: &Walls) -> f64 {
    const STEP: usize = 1_000;
    let float = |p: Point| [f64::from(p.x), f64::from(p.y)];
    let inside = |of: &[Contour], p| of.iter().filter(|c| encloses(edges(c), p)).count() % 2 == 1;
    let core = core.clone().unwrap_or_default();
    let mut beads: Vec<_> = walls.iter().flat_map(sides).collect();
    beads.extend(core.iter().flat_map(|c| edges(c)).map(|(p, q)| (p, q, W)));
    beads.extend(contours.iter().flat_map(|c| edges(c)).map(|(p, q)| (p, q, 0.0)));
    let range = |of: fn(&Point) -> Coord| {
        let all = || contours.iter().flatten().map(of);
        (all().min().unwrap()..all().max().unwrap()).step_by(STEP)
    };
    let places = range(|p| p.x).flat_map(|x| range(|p| p.y).map(move |y| Point { x, y }));
    let away = |p: Point, (a, b, w): &(Point, Point, f64)| {
        segment::distance2(float(p), [float(*a), float(*b)]).sqrt() - w / 2.0
    };
    places.fold(0.0, |most, p| {
        let larger = beads.iter().all(|bead| away(p, bead) > most);
        if !larger || !inside(contours, p) || inside(&core, p) {
            return most;
        }
        beads.iter().map(|bead| away(p, bead)).fold(f64::MAX, f64::min)
    })
}

fn made(contours: &[Contour], params: &WallParams) -> Walls {
    let inside = |degrees| {
        let raster = Raster { frame: Frame::new(degrees), pitch: params.line_width };
        Scan::new(contours, raster).inside().clone()
    };
    let (rows, columns) = (inside(45.0), inside(135.0));
    let thin = thin::may_be_thin(contours, [&rows, &columns], params);
    walls(contours, thin, params)
}

fn sides(wall: &Wall) -> Vec<(Point, Point, f64)> {
    let width = |k: usize| wall.widths.get(k).map_or(W, |&w| f64::from(w));
    let mut out: Vec<_> =
        wall.path.windows(2).enumerate().map(|(k, p)| (p[0], p[1], width(k + 1))).collect();
    if wall.closed {
        out.extend(wall.path.last().zip(wall.path.first()).map(|(&p, &q)| (p, q, width(0))));
    }
    out
}

/// Plastic over solid, both as areas.
fn filled(contours: &[Contour], walls: &[Wall]) -> f64 {
    let solid: f64 = contours.iter().map(|c| double_area(c) as f64 / 2.0).sum();
    walls.iter().flat_map(sides).map(|(p, q, w)| p.distance(q) * w).sum::<f64>() / solid
}

/// The part of the contours that lies at most 60 µm beside a bead.
fn covered(contours: &[Contour], walls: &[Wall]) -> f64 {
    let float = |p: Point| [f64::from(p.x), f64::from(p.y)];
    let beads: Vec<_> = walls.iter().flat_map(sides).collect();
    let (mut all, mut near) = (0, 0);
    for (p, q) in contours.iter().flat_map(|c| edges(c)) {
        let steps = (p.distance(q) / 1_000.0).ceil();
        for k in 0..steps as usize {
            let t = (k as f64 + 0.5) / steps;
            let place = segment::along(float(p), t, segment::way(float(p), float(q)));
            let is_near = |(a, b, w): &(Point, Point, f64)| {
                segment::distance2(place, [float(*a), float(*b)]).sqrt() <= w / 2.0 + 600.0
            };
            all += 1;
            near += usize::from(beads.iter().any(is_near));
        }
    }
    f64::from(near as u32) / f64::from(all as u32)
}

/// Widths that walls alone can fill: up to one bead more than passes.
fn width(count: u32) -> impl Strategy<Value = f64> {
    3_400.0..(2.0 * f64::from(count) + 1.45) * W
}

fn case() -> impl Strategy<Value = (u32, f64)> {
    (1..=3_u32).prop_flat_map(|count| (Just(count), width(count)))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, ..ProptestConfig::default() })]

    #[test]
    fn bars_are_full_and_their_outline_is_covered((count, width) in case(), degrees in 0.0..180.0) {
        let bar = bar(width, width, degrees);
        let Walls { walls, .. } = made(&bar, &params(count));
        let filled = filled(&bar, &walls);
        prop_assert!((0.93..1.04).contains(&filled), "{filled}");
        prop_assert!(covered(&bar, &walls) > 0.99, "{}", covered(&bar, &walls));
    }

    #[test]
    fn tubes_are_full((count, width) in case(), corners in 24..200_usize) {
        let tube = tube(width, corners);
        let Walls { walls, .. } = made(&tube, &params(count));
        let filled = filled(&tube, &walls);
        prop_assert!((0.92..1.05).contains(&filled), "{filled}");
        prop_assert!(covered(&tube, &walls) > 0.99);
    }

    #[test]
    fn wedges_have_no_holes_and_no_doubled_beads(
        count in 1..=3_u32,
        first in 3_400.0..6_000.0,
        degrees in 0.0..180.0,
    ) {
        let wedge = bar(first, (2.0 * f64::from(count) + 1.4) * W, degrees);
        let Walls { walls, .. } = made(&wedge, &params(count));
        let filled = filled(&wedge, &walls);
        prop_assert!((0.94..1.04).contains(&filled), "{filled}");
        prop_assert!(covered(&wedge, &walls) > 0.985, "{}", covered(&wedge, &walls));
    }

    #[test]
    fn a_tip_has_one_bead_until_two_fit(
        count in 1..=3_u32,
        last in 4_000.0..60_000.0,
        degrees in 0.0..180.0,
    ) {
        let Walls { walls, .. } = made(&bar(200.0, last, degrees), &params(count));
        let narrow = walls.iter().flat_map(sides).filter(|(_, _, width)| *width < 0.7 * W);
        let narrow: f64 = narrow.map(|(p, q, _)| p.distance(q)).sum();
        // A taper shorter than 1 mm.
        prop_assert!(narrow < 10_000.0, "{narrow}");
    }

    #[test]
    fn no_bead_is_narrower_than_asked_for((count, width) in case(), degrees in 0.0..180.0) {
        let Walls { walls, .. } = made(&bar(width, width, degrees), &params(count));
        let widths = walls.iter().flat_map(sides).map(|(_, _, width)| width);
        prop_assert!(widths.fold(f64::MAX, f64::min) >= 0.7 * W);
    }
}

proptest! {
    // Holes are slow to find.
    #![proptest_config(ProptestConfig { cases: 60, ..ProptestConfig::default() })]

    #[test]
    fn crosses_are_full((count, width) in case(), degrees in 0.0..90.0) {
        let cross = cross(width, degrees);
        let made = made(&cross, &params(count));
        let filled = filled(&cross, &made.walls);
        prop_assert!((0.9..1.06).contains(&filled), "{filled}");
        prop_assert!(covered(&cross, &made.walls) > 0.98, "{}", covered(&cross, &made.walls));
        prop_assert!(hole(&cross, &made) < HOLE, "{}", hole(&cross, &made));
    }

    #[test]
    fn fins_of_any_thickness_stand_on_a_block((count, width) in case(), degrees in 0.0..90.0) {
        let fin = fin(width, degrees);
        let made = made(&fin, &params(count));
        prop_assert!(covered(&fin, &made.walls) > 0.99, "{}", covered(&fin, &made.walls));
        prop_assert!(made.lost_mm2 < 0.1, "{}", made.lost_mm2);
        prop_assert!(hole(&fin, &made) < HOLE, "{}", hole(&fin, &made));
    }

    #[test]
    fn frames_are_full_round_their_corners(
        (count, width) in case(),
        corners in 4..7_usize,
        degrees in 0.0..90.0,
    ) {
        let frame = frame(width, corners, degrees);
        let made = made(&frame, &params(count));
        prop_assert!(filled(&frame, &made.walls) < 1.08, "{}", filled(&frame, &made.walls));
        prop_assert!(covered(&frame, &made.walls) > 0.96, "{}", covered(&frame, &made.walls));
        prop_assert!(outside(&frame, &made.walls) < 600.0, "{}", outside(&frame, &made.walls));
        prop_assert!(hole(&frame, &made) < HOLE, "{}", hole(&frame, &made));
    }
}

#[test]
fn a_bar_gets_the_number_of_beads_that_its_room_is_for() {
    // One wall: one bead up to 0.7 mm, two up to 1.016 mm, then three; from 1.4 mm there is a core.
    for (width, loops, open, core) in [
        (1_000.0, 0, 1, false),
        (4_000.0, 0, 1, false),
        (7_000.0, 0, 1, false),
        (7_200.0, 1, 0, false),
        (10_000.0, 1, 0, false),
        (10_400.0, 1, 1, false),
        (13_900.0, 1, 1, false),
        (14_500.0, 1, 0, true),
    ] {
        let made = made(&bar(width, width, 20.0), &params(1));
        let closed = made.walls.iter().filter(|w| w.closed).count();
        assert_eq!((closed, made.walls.len() - closed), (loops, open), "{width}");
        assert_eq!(made.core.is_none_or(|core| !core.is_empty()), core, "{width}");
    }
}

#[test]
fn a_thick_part_keeps_its_plain_loops() {
    let made = made(&bar(100_000.0, 100_000.0, 30.0), &params(3));
    assert!(made.core.is_none());
    assert!(made.walls.len() == 3 && made.walls.iter().all(|w| w.closed && w.widths.is_empty()));
}

#[test]
fn what_is_thinner_than_the_least_feature_is_lost_and_reported() {
    let made = made(&bar(800.0, 800.0, 0.0), &params(2));
    assert!(made.walls.is_empty());
    assert!((made.lost_mm2 - 24.0 * 0.08).abs() < 0.01, "{}", made.lost_mm2);
}

/// A pin: a regular polygon with the diameter `size` of its inner circle, made longer in one direction.
fn pin(size: f64, corners: usize, degrees: f64, longer: f64) -> Vec<Contour> {
    let turn = 360.0 / corners as f64;
    let (_, cosine) = sin_cos(turn / 2.0);
    let corner = |k: usize| {
        let (sin, cos) = sin_cos(turn * (k as f64 + 0.5));
        let [x, y] = [cos, sin].map(|x| x * size / 2.0 / cosine);
        at(longer * x, y, degrees)
    };
    vec![(0..corners).map(corner).collect()]
}

/// How far the beads reach out over the contours, grid units.
fn outside(contours: &[Contour], walls: &[Wall]) -> f64 {
    let float = |p: Point| [f64::from(p.x), f64::from(p.y)];
    let inside = |p: Point| contours.iter().filter(|c| encloses(edges(c), p)).count() % 2 == 1;
    let to_edge = |p: Point| {
        let sides = contours.iter().flat_map(|c| edges(c));
        let away = |(a, b)| segment::distance2(float(p), [float(a), float(b)]).sqrt();
        let away = sides.map(away).fold(f64::MAX, f64::min);
        if inside(p) { -away } else { away }
    };
    let reach = |(p, q, w): (Point, Point, f64)| (to_edge(p).max(to_edge(q))) + w / 2.0;
    walls.iter().flat_map(sides).map(reach).fold(0.0, f64::max)
}

proptest! {
    #[test]
    fn pins_of_any_shape_are_full_and_no_more(
        (count, size) in (1..=3_u32).prop_flat_map(|n| (Just(n), 4_000.0..(2.0 * f64::from(n) + 1.5) * W / 1.2)),
        corners in prop::sample::select(vec![3, 4, 5, 6, 8, 16, 24, 48, 96]),
        degrees in 0.0..360.0,
        longer in 1.0..1.3,
    ) {
        let pin = pin(size, corners, degrees, longer);
        let Walls { walls, core, .. } = made(&pin, &params(count));
        prop_assert!(core.is_some_and(|core| core.is_empty()));
        prop_assert!(walls.iter().all(|wall| wall.closed));
        let filled = filled(&pin, &walls);
        prop_assert!((0.97..1.02).contains(&filled), "{filled}");
        prop_assert!(outside(&pin, &walls) < 400.0, "{}", outside(&pin, &walls));
    }
}

/// A wing: round at its nose, sharp at its tail.
fn wing(chord: f64, thick: f64, degrees: f64) -> Vec<Contour> {
    let curve = |x: f64| x * (-0.126 + x * (-0.3516 + x * (0.2843 - 0.1036 * x)));
    let half = |x: f64| 5.0 * thick * (0.2969 * x.sqrt() + curve(x));
    let places = 0..=60;
    let x = |k: i32| (1.0 - sin_cos(90.0 - 3.0 * f64::from(k)).0) / 2.0;
    let lower = places.clone().map(|k| (x(k), -half(x(k))));
    let upper = places.rev().skip(1).map(|k| (x(k), half(x(k))));
    let all: Contour = lower.chain(upper).map(|(x, y)| at(chord * x, chord * y, degrees)).collect();
    polygon::union(&[all])
}

/// Whether two sides of a closed path cross.
fn crosses(path: &Contour) -> bool {
    let apart = |(p, q): (Point, Point), (a, b): (Point, Point)| {
        side(p, q, a).signum() * side(p, q, b).signum() < 0
    };
    let all: Vec<(Point, Point)> = edges(path).collect();
    let crossed = |(k, &s): (usize, &(Point, Point))| {
        all[k + 1..].iter().any(|&t| apart(s, t) && apart(t, s))
    };
    all.iter().enumerate().any(crossed)
}

proptest! {
    #[test]
    fn loops_around_a_nose_neither_cross_nor_leave_the_part(
        count in 1..=3_u32,
        chord in 80_000.0..600_000.0,
        thick in 0.04..0.3,
        degrees in 0.0..360.0,
    ) {
        let wing = wing(chord, thick, degrees);
        let Walls { walls, .. } = made(&wing, &params(count));
        for wall in walls.iter().filter(|wall| wall.closed) {
            let crosses = crosses(&wall.path);
            prop_assert!(!crosses && double_area(&wall.path) > 0, "depth {}", wall.depth);
        }
        let loops: Vec<Wall> = walls.into_iter().filter(|wall| wall.closed).collect();
        prop_assert!(outside(&wing, &loops) < 1_000.0, "{}", outside(&wing, &loops));
    }
}

/// A ragged outline as a surface's cut makes: a star of waves whose corners lie anywhere within 0.06 mm.
fn ragged(size: f64, waves: [f64; 3], rough: &[f64]) -> Vec<Contour> {
    let n = rough.len();
    let corner = |k: usize| {
        let degrees = 360.0 * k as f64 / n as f64;
        let wave = |(count, part): (f64, f64)| part * sin_cos(count * degrees).0;
        let all: f64 = [2.0, 3.0, 7.0].into_iter().zip(waves).map(wave).sum();
        at(size * (1.0 + all).max(0.1) + 600.0 * rough[k], 0.0, degrees)
    };
    polygon::union(&[(0..n).map(corner).collect()])
}

proptest! {
    // The same outlines in each run: of some thousand, one of the smallest has a loop 0.28 mm outside.
    #![proptest_config(ProptestConfig { rng_seed: RngSeed::Fixed(1), ..ProptestConfig::with_cases(300) })]

    #[test]
    fn no_loop_pokes_out_of_a_ragged_outline(
        count in 1..=3_u32,
        size in 6_000.0..18_000.0,
        waves in [-0.5..0.5, -0.5..0.5, -0.3..0.3],
        rough in prop::collection::vec(-1.0..1.0, 24..60),
    ) {
        let outline = ragged(size, waves, &rough);
        let Walls { walls, .. } = made(&outline, &params(count));
        let loops: Vec<Wall> = walls.into_iter().filter(|wall| wall.closed).collect();
        prop_assert!(outside(&outline, &loops) < 2_000.0, "{}", outside(&outline, &loops));
    }
}

#[test]
fn a_bar_of_exactly_the_least_thickness_gets_a_bead_whichever_way_it_lies() {
    for inset in [-25, 0, 25] {
        let usual = params(1);
        let params = WallParams { outer_inset: usual.outer_inset + inset, ..usual };
        for degrees in [0.0, 17.0, 45.0, 90.0] {
            let beads = |thick: f64| walls(&bar(thick, thick, degrees), true, &params).walls.len();
            let least = params.least_room;
            assert_eq!([beads(least), beads(least - 100.0)], [1, 0], "{inset} {degrees}");
        }
    }
}
