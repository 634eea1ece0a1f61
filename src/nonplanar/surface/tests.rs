//! A surface in two ways: what is left out for speed changes nothing.

use super::Surface;
use crate::geom::Point;
use crate::units::{Coord, to_units};

/// Squares along a side.
const SIDE: i32 = 16;

/// Waves, with a hole in the middle, and for each facet which of its sides lie at a rim.
fn waves() -> (Vec<[[Coord; 3]; 3]>, Vec<[bool; 3]>) {
    let z = |x: i32, y: i32| {
        let [x, y] = [x, y].map(|v| 0.37 * f64::from(v));
        [x, y, 3.0 + 0.8 * (x.sin() + (1.3 * y).sin())].map(to_units)
    };
    let is_in = |i: i32, j: i32| {
        let inside = (0..SIDE).contains(&i) && (0..SIDE).contains(&j);
        inside && !((6..9).contains(&i) && (5..8).contains(&j))
    };
    let squares = (0..SIDE).flat_map(|i| (0..SIDE).map(move |j| (i, j)));
    let facets = squares.filter(|&(i, j)| is_in(i, j)).flat_map(|(i, j)| {
        let [a, b, c, d] = [z(i, j), z(i + 1, j), z(i + 1, j + 1), z(i, j + 1)];
        let [below, right] = [!is_in(i, j - 1), !is_in(i + 1, j)];
        let [above, left] = [!is_in(i, j + 1), !is_in(i - 1, j)];
        [([a, b, c], [below, right, false]), ([a, c, d], [false, above, left])]
    });
    facets.unzip()
}

#[test]
fn sides_that_cancel_may_be_left_out() {
    let (facets, open) = waves();
    let all = vec![[true; 3]; facets.len()];
    let (one, other) = (Surface::new(facets.clone(), open), Surface::new(facets, all));
    assert_eq!(one.outline(), other.outline());
    assert_eq!(one.outline().len(), 2);
    let [low, high] = one.bounds();
    for from in (low - 300..high + 300).step_by(371) {
        for tall in [1, 400, 2_000, 9_000] {
            assert_eq!(one.between(from, from + tall), other.between(from, from + tall), "{from}");
        }
    }
}

#[test]
fn a_band_is_where_the_surface_is_as_high() {
    let (facets, open) = waves();
    let surface = Surface::new(facets, open);
    let area = |contours: &[Vec<Point>]| -> f64 {
        contours.iter().map(|contour| crate::geom::double_area(contour) as f64 / 2.0).sum()
    };
    let [low, high] = surface.bounds();
    let bands = (low..=high).step_by(500).map(|from| area(&surface.between(from, from + 500)));
    let (sum, whole) = (bands.sum::<f64>(), area(surface.outline()));
    assert!((sum / whole - 1.0).abs() < 1e-3, "{sum} {whole}");
}

#[test]
fn many_ways_at_once_are_those_one_by_one() {
    let (facets, open) = waves();
    let surface = Surface::new(facets, open);
    let (low, high) = surface.extent();
    let (first, pitch) = (low.y / 1_000 - 2, 1_000);
    let count = high.y / 1_000 - first + 3;
    let way = |k: i32| (k % 5 != 3).then_some([low.x - 700 - 10 * k, high.x + 300 + 7 * k]);
    let ways: Vec<_> = (0..count).map(way).collect();
    let found = surface.profiles((first, pitch), &ways);
    assert!(found.iter().map(Vec::len).max() > Some(30));
    for ((k, way), found) in (0..).zip(ways).zip(found) {
        let y = (first + k) * pitch;
        let expected = way.map(|way| way.map(|x| Point { x, y }));
        assert_eq!(found, expected.map_or(Vec::new(), |[a, b]| surface.profile(a, b)));
    }
}
