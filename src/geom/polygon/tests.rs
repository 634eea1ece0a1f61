//! Shapes -> laws of offsets, unions and differences, held against the library and against areas by formula.
//!
//! - A *star* has its corners around one place, at given distances; its sides do not cross.
//! - A *sliver* is a contour that is hardly wider than the grid.
//!
//! 1. Curves that do not cross come out as the library makes them, to the first vertex.
//! 2. Where sides are cut here and not by the library, areas agree within a micrometre along the outline.
//! 3. What is left of areas has no hole in nothing.

use super::*;
use crate::geom::edges;
use crate::units::{nearest, sin_cos};
use proptest::prelude::*;

/// A star around the origin with its corners at `radii`. No side of it is horizontal.
fn star(radii: &[f64]) -> Contour {
    let corner = |(k, r): (usize, &f64)| {
        let (sin, cos) = sin_cos(0.1 + 360.0 * k as f64 / radii.len() as f64);
        Point { x: nearest(r * cos) as Coord, y: nearest(r * sin) as Coord }
    };
    radii.iter().enumerate().map(corner).collect()
}

fn area(contours: &[Contour]) -> f64 {
    contours.iter().map(|c| double_area(c) as f64 / 2.0).sum()
}

#[test]
fn loops_are_cut_by_the_areas_near_them_and_those_around_them() {
    let square = |(x, y): (Coord, Coord), side: Coord| -> Contour {
        let corners = [(0, 0), (side, 0), (side, side), (0, side)];
        corners.map(|(right, up)| Point { x: x + right, y: y + up }).to_vec()
    };
    // A frame with a hole in it, and so many squares far away that they are sorted into cells.
    let mut hole = square((40_000, 40_000), 20_000);
    hole.reverse();
    let mut areas = vec![square((0, 0), 100_000), hole];
    areas.extend((0..60).map(|k| square((200_000 + 30_000 * k, 0), 10_000)));
    let in_hole = square((45_000, 45_000), 5_000);
    let far = square((0, -50_000), 5_000);
    let loops = vec![
        in_hole.clone(),
        square((10_000, 10_000), 5_000),
        square((55_000, 45_000), 10_000),
        far.clone(),
        square((205_000, -5_000), 10_000),
    ];
    let Cut { whole, pieces } = cut(loops, &areas);
    assert_eq!(whole, [in_hole, far]);
    let length =
        |piece: &Vec<Point>| -> f64 { piece.windows(2).map(|p| p[0].distance(p[1])).sum() };
    // Of a loop halfway in the hole half is left; of one over the corner of a square 3/4.
    assert_eq!(pieces.iter().map(length).collect::<Vec<_>>(), [20_000.0, 30_000.0]);
}

#[test]
fn a_sliver_that_is_turned_over_does_not_turn_what_lies_beside_it() {
    let at = |x: Coord, y: Coord| Point { x, y };
    let piece = vec![at(-9244, -72104), at(-58287, 43437), at(-96736, 27118), at(-47691, -88424)];
    let sliver = vec![at(12274, 47822), at(12541, 47190), at(11445, 49772)];
    assert!(double_area(&piece) > 0 && double_area(&sliver) < 0);
    let alone = inset(std::slice::from_ref(&piece), 200);
    assert_eq!(alone.len(), 1);
    assert_eq!(inset(&[piece.clone(), sliver.clone()], 200), alone);
    // Nor does one come to be: what is simplified keeps its turn, or goes.
    let over = [vec![at(11_400, 49_770), at(12_541, 47_180), at(20_000, 50_000)]];
    let turned: Contour = sliver.into_iter().rev().collect();
    for tolerance in [1, 10, 100, 1_000] {
        let left = difference(&[piece.clone(), turned.clone()], &over, tolerance);
        assert!(left.iter().all(|c| double_area(c) > 0), "{left:?}");
    }
}

#[test]
fn many_that_overlap_make_one_in_parts() {
    // 300 triangles that share a middle, and one apart from them.
    let triangle = |k: i32| -> Contour {
        let at = |by: f64| {
            let (sin, cos) = crate::units::sin_cos(by + f64::from(k) * 0.37);
            Point { x: (cos * 90_000.0) as i32, y: (sin * 90_000.0) as i32 }
        };
        vec![at(0.0), at(120.0), at(240.0)]
    };
    let mut all: Vec<Contour> = (0..300).map(triangle).collect();
    all.push(triangle(0).into_iter().map(|p| Point { x: p.x + 500_000, ..p }).collect());
    let (parts, whole) = (by_parts(&all), united(&all));
    let area = |contours: &[Contour]| contours.iter().map(|c| double_area(c)).sum::<i128>();
    assert_eq!((parts.len(), whole.len()), (2, 2));
    // Corners are rounded to the grid, a few times.
    assert!((area(&parts) - area(&whole)).abs() < area(&whole) / 20_000);
}

proptest! {
    #[test]
    fn sides_cut_here_enclose_what_the_library_encloses(
        radii in prop::collection::vec(84_000.0..90_000.0, 5..40),
        distance in prop_oneof![-30_000.0..-100.0, 100.0..8_000.0],
    ) {
        let star = [star(&radii)];
        let sides = parallel(&star[0], distance, MITER_LIMIT);
        prop_assume!(sides.is_some());
        let ours = from_library(&clean(&to_library(sides.as_slice())));
        let (join, end) = (JoinType::Miter, EndType::Polygon);
        let theirs =
            inflate_paths_64(&to_library(&star), distance, join, end, MITER_LIMIT, 0.0);
        let theirs = from_library(&theirs);
        // They may differ by a micrometre along the whole outline.
        let round = edges(&star[0]).map(|(p, q)| p.distance(q)).sum::<f64>();
        let apart = (area(&ours) - area(&theirs)).abs();
        prop_assert!(apart <= 10.0 * round, "{apart} of {}", area(&theirs));
    }
}

/// Whether a corner of `hole` lies in the box of `contour`.
fn encloses_most(contour: &Contour, hole: &Contour) -> bool {
    let Some((low, high)) = extent(contour) else { return false };
    hole.iter().any(|p| low.x <= p.x && p.x <= high.x && low.y <= p.y && p.y <= high.y)
}

/// Stars with corners on a coarse grid: many horizontal sides, many corners of equal y.
fn stars() -> impl Strategy<Value = Vec<Contour>> {
    let shape = (prop::collection::vec(20.0..60.0, 3..12), -80..80, -80..80, any::<bool>());
    let shape = shape.prop_map(|(radii, x, y, hole): (Vec<f64>, i32, i32, bool)| {
        let coarse = |from: Coord, c: Coord| (from + c) / 4 * 4_000;
        let move_to = |p: Point| Point { x: coarse(x, p.x), y: coarse(y, p.y) };
        let mut star: Contour = star(&radii).into_iter().map(move_to).collect();
        star.dedup();
        if hole {
            star.reverse();
        }
        star
    });
    prop::collection::vec(shape, 1..5)
}

proptest! {
    #[test]
    fn what_is_left_of_areas_has_no_hole_in_nothing(
        areas in stars(), others in stars(), tolerance in 1_i32..2_000,
    ) {
        prop_assume!(areas.iter().chain(&others).all(|c| c.len() > 2));
        let left = difference(&union(&areas), &union(&others), tolerance);
        let outer = |hole: &Contour| {
            let inside = |c: &&Contour| double_area(c) > 0 && encloses_most(c, hole);
            left.iter().any(|c| inside(&c))
        };
        for hole in left.iter().filter(|c| double_area(c) < 0) {
            prop_assert!(outer(hole), "{hole:?} of {left:?}");
        }
    }

    #[test]
    fn curves_without_crossings_are_united_as_the_library_does(curves in stars()) {
        prop_assume!(curves.iter().all(|c| c.len() > 2));
        let library = |fill| from_library(&union_subjects_64(&to_library(&curves), fill));
        if let Some(ours) = disjoint(&curves, |winding| winding != 0, 0.0) {
            prop_assert_eq!(ours, library(FillRule::NonZero));
        }
        if let Some(ours) = disjoint(&curves, |winding| winding > 0, 0.0) {
            prop_assert_eq!(ours, library(FillRule::Positive));
        }
    }
}

#[test]
fn a_side_too_short_for_its_cuts_is_removed() {
    let p = |x, y| Point { x, y };
    // A square on its corner, with one corner blunted.
    let cut =
        vec![p(0, -100_000), p(100_000, 0), p(1_000, 99_000), p(-1_000, 99_000), p(-100_000, 0)];
    let moved = parallel(&cut, -7_071.067_8, MITER_LIMIT).unwrap();
    assert_eq!(moved.len(), 4, "{moved:?}");
    assert!(moved.iter().any(|at| at.distance2(p(0, 90_000)) <= 2), "{moved:?}");
}

#[test]
fn shapes_are_kept_unless_something_is_too_thin() {
    let p = |x, y| Point { x, y };
    let square =
        |low: Coord, high: Coord| vec![p(low, low), p(high, low), p(high, high), p(low, high)];
    let block = square(0, 100_000);
    let hole = |low, high| square(low, high).into_iter().rev().collect::<Contour>();
    assert!(keep_shape(std::slice::from_ref(&block), 1_000, 0.0));
    assert!(keep_shape(&[block.clone(), hole(2_100, 50_000)], 1_000, 0.0));
    assert!(!keep_shape(&[block.clone(), hole(1_900, 50_000)], 1_000, 0.0), "a thin rim");
    assert!(!keep_shape(&[square(0, 1_900)], 1_000, 0.0), "nothing is left");
    // A pointed bump on a side, whose sides are removed one after the other from its tip.
    let mut cape = vec![p(0, 0), p(100_000, 0), p(100_000, 100_000)];
    cape.extend((0..=20).map(|k| p(51_000 - 50 * k, 100_000 + 1_000 * k)));
    cape.extend((0..20).rev().map(|k| p(49_000 + 50 * k, 100_000 + 1_000 * k)));
    cape.push(p(0, 100_000));
    assert!(!keep_shape(&[cape], 1_100, 20_000.0));
    // A blunted corner.
    let blunt = vec![p(0, 0), p(100_000, 0), p(100_000, 99_900), p(99_900, 100_000), p(0, 100_000)];
    let keeps = |most| keep_shape(std::slice::from_ref(&blunt), 1_000, most);
    assert!(keeps(200.0) && !keeps(100.0));
}

#[test]
fn the_sharpest_corner_is_the_one_whose_tip_moves_furthest() {
    let p = |x, y| Point { x, y };
    let square = vec![p(0, 0), p(100_000, 0), p(100_000, 100_000), p(0, 100_000)];
    assert!((sharpest(std::slice::from_ref(&square)) - 1.0).abs() < 1e-9);
    // A wedge of 10°: 1 / tan 5°.
    let wedge = vec![p(0, 0), p(100_000, 0), p(100_000, 17_633)];
    assert!((sharpest(&[square.clone(), wedge]) - 11.43).abs() < 0.01);
    // A hole has its corners the other way round.
    assert_eq!(sharpest(&[square.into_iter().rev().collect()]), 0.0);
}

#[test]
fn neighbouring_sides_are_cut_where_they_cross() {
    let p = |x, y| Point { x, y };
    // A square on its corner: no side is horizontal.
    let diamond = vec![p(0, -100_000), p(100_000, 0), p(0, 100_000), p(-100_000, 0)];
    let moved = parallel(&diamond, -7_071.067_8, MITER_LIMIT).unwrap();
    for (at, corner) in moved.iter().zip([(0, -90_000), (90_000, 0), (0, 90_000), (-90_000, 0)]) {
        assert!(at.distance2(p(corner.0, corner.1)) <= 2, "{moved:?}");
    }
    let wider = parallel(&diamond, 7_071.067_8, MITER_LIMIT).unwrap();
    assert_eq!(wider.len(), 4);
    assert!(wider[0].distance2(p(0, -110_000)) <= 2, "{wider:?}");
}
