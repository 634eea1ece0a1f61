//! Paths -> rounded paths: what rounding turns keeps, on random zig-zags and polylines.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use proptest::prelude::*;
use slicer::fill::PathPoint;
use slicer::fill::rounding::Rounding;
use slicer::geom::{Point, side};
use slicer::units::Coord;

fn path(places: &[(Coord, Coord)], width: Coord) -> Vec<PathPoint> {
    let point = |&(x, y): &(Coord, Coord)| PathPoint {
        at: Point { x, y },
        z: 0,
        width,
        height: 2_000,
        hang: 0,
    };
    places.iter().map(point).collect()
}

fn volume(path: &[PathPoint]) -> f64 {
    path.windows(2).map(|w| w[0].at.distance(w[1].at) * f64::from(w[1].width)).sum()
}

/// Distance of `p` from the segment a–b.
fn distance(p: Point, a: Point, b: Point) -> f64 {
    let number = |q: Point| (f64::from(q.x - a.x), f64::from(q.y - a.y));
    let ((dx, dy), (x, y)) = (number(b), number(p));
    let length2 = dx * dx + dy * dy;
    let t = if length2 > 0.0 { ((dx * x + dy * y) / length2).clamp(0.0, 1.0) } else { 0.0 };
    ((x - t * dx).powi(2) + (y - t * dy).powi(2)).sqrt()
}

/// Distance of `p` from the triangle a b c; 0 inside.
fn outside(p: Point, [a, b, c]: [Point; 3]) -> f64 {
    let sides = [side(a, b, p), side(b, c, p), side(c, a, p)];
    if sides.iter().all(|&s| s >= 0) || sides.iter().all(|&s| s <= 0) {
        return 0.0;
    }
    [distance(p, a, b), distance(p, b, c), distance(p, c, a)].into_iter().fold(f64::MAX, f64::min)
}

/// Cosine of the sharpest corner.
fn sharpest(path: &[PathPoint]) -> f64 {
    let turn = |w: &[PathPoint]| {
        let step = |a: Point, b: Point| (f64::from(b.x - a.x), f64::from(b.y - a.y));
        let ((ax, ay), (bx, by)) = (step(w[0].at, w[1].at), step(w[1].at, w[2].at));
        (ax * bx + ay * by) / (ax.hypot(ay) * bx.hypot(by))
    };
    path.windows(3).map(turn).fold(1.0, f64::min)
}

proptest! {
    #[test]
    fn rounding_keeps_ends_middles_and_material_and_stays_at_the_corners(
        places in prop::collection::vec((-300_000..300_000_i32, -300_000..300_000_i32), 2..12),
        width in 1_000..10_000_i32,
        radius in 0..40_000_i32,
    ) {
        let sharp = path(&places, width);
        let round = Rounding { radius }.round(sharp.clone());
        prop_assert_eq!(round.first().map(|p| p.at), sharp.first().map(|p| p.at));
        prop_assert_eq!(round.last().map(|p| p.at), sharp.last().map(|p| p.at));
        for w in sharp.windows(2) {
            let (a, b) = (w[0].at, w[1].at);
            let middle = Point { x: (a.x + b.x) / 2, y: (a.y + b.y) / 2 };
            let far = round.windows(2).map(|r| distance(middle, r[0].at, r[1].at));
            prop_assert!(far.fold(f64::MAX, f64::min) <= 2.0, "{:?} is gone", middle);
        }
        for p in &round {
            let off = |w: &[PathPoint]| outside(p.at, [w[0].at, w[1].at, w[2].at]);
            let far = sharp.windows(3).map(off).fold(f64::MAX, f64::min);
            prop_assert!(sharp.len() < 3 || far <= 3.0, "{:?} is {} out", p, far);
        }
        let length = |path: &[PathPoint]| -> f64 {
            path.windows(2).map(|w| w[0].at.distance(w[1].at)).sum()
        };
        let laid = volume(&round) / volume(&sharp);
        // A path keeps its material, or is 4 % wider where that is not enough.
        let shorter = length(&round) / length(&sharp);
        prop_assert!(laid <= 1.001 && laid >= (1.04 * shorter).min(1.0) - 0.001, "{} {}", laid, shorter);
        prop_assert!(round.iter().all(|p| p.width <= width + width / 25 + 1));
    }

    #[test]
    fn turns_of_a_zigzag_are_flat(
        run in 100_000..500_000_i32, pitch in 15_000..60_000_i32, lean in -10_000..10_000_i32,
    ) {
        let row = |j: i32| [(j * lean, j * pitch), (run + j * lean, j * pitch)];
        let places: Vec<_> = (0..7)
            .flat_map(|j| {
                let [a, b] = row(j);
                if j % 2 == 0 { [a, b] } else { [b, a] }
            })
            .collect();
        let round = Rounding { radius: 8_000 }.round(path(&places, 4_000));
        // 25° is the sharpest corner of all that is left alone.
        prop_assert!(sharpest(&round) > 0.9, "{}", sharpest(&round));
        let turns = f64::from(places.len() as i32 - 2);
        prop_assert!((round.len() as f64) < 2.0 + 9.0 * turns, "{} points", round.len());
    }
}

#[test]
fn without_a_radius_and_without_corners_a_path_stays_as_it_is() {
    let bent = path(&[(0, 0), (50_000, 0), (50_000, 50_000)], 4_000);
    assert_eq!(Rounding { radius: 0 }.round(bent.clone()), bent);
    let straight = path(&[(0, 0), (50_000, 0), (90_000, 10_000)], 4_000);
    assert_eq!(Rounding { radius: 8_000 }.round(straight.clone()), straight);
    let line = path(&[(0, 0), (50_000, 0)], 4_000);
    assert_eq!(Rounding { radius: 8_000 }.round(line.clone()), line);
}
