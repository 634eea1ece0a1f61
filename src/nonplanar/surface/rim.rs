//! Plane polygons laid side by side -> Contours: what all of them together cover.
//!
//! Each polygon runs round its place. A side that two neighbours share is run through both ways, and
//! cancels. What is left are the sides at the rim: as many begin at a corner as end there, so that they
//! chain into loops. Only these are united: a thousandth of the work of uniting all polygons. Corners
//! must be the same points in both neighbours; where they are not, two sides stay that lie on each other
//! and enclose nothing.

use crate::geom::{Contour, Point, polygon, side};

/// What `polygons` cover, as from [`polygon::union`]. They may run clockwise, where a surface folds
/// under itself: there they take away what another one covers twice.
#[must_use]
pub(in crate::nonplanar) fn rim<P: AsRef<[Point]>>(
    polygons: impl Iterator<Item = P>,
) -> Vec<Contour> {
    let mut sides = Vec::new();
    for polygon in polygons {
        let corners = polygon.as_ref();
        sides.extend((0..corners.len()).map(|k| (corners[k], corners[(k + 1) % corners.len()])));
    }
    of_sides(sides.into_iter())
}

/// As [`rim`], of the sides of such polygons. Both of a pair that cancels may be left out.
#[must_use]
pub(super) fn of_sides(sides: impl Iterator<Item = (Point, Point)>) -> Vec<Contour> {
    let directed = |(from, to): (Point, Point)| {
        if from < to { (from, to, 1) } else { (to, from, -1) }
    };
    let mut sides: Vec<(Point, Point, i32)> =
        sides.filter(|(from, to)| from != to).map(directed).collect();
    sides.sort_unstable();
    let mut left: Vec<(Point, Point)> = Vec::new();
    for same in sides.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
        let (low, high, _) = same[0];
        let more: i32 = same.iter().map(|&(.., way)| way).sum();
        let way = if more > 0 { (low, high) } else { (high, low) };
        left.extend(std::iter::repeat_n(way, more.unsigned_abs() as usize));
    }
    left.sort_unstable();
    polygon::union(&loops(&left))
}

/// Chains directed sides, sorted by their starts, into loops. At every corner as many begin as end.
fn loops(sides: &[(Point, Point)]) -> Vec<Contour> {
    let mut used = vec![false; sides.len()];
    let mut out = Vec::new();
    for first in 0..sides.len() {
        if used[first] {
            continue;
        }
        let begin = sides[first].0;
        let (mut at, mut chain) = (first, Vec::new());
        loop {
            used[at] = true;
            chain.push(sides[at].0);
            let end = sides[at].1;
            let from = sides.partition_point(|&(start, _)| start < end);
            let free = (from..sides.len()).take_while(|&k| sides[k].0 == end).find(|&k| !used[k]);
            match free {
                Some(next) if end != begin => at = next,
                _ => break,
            }
        }
        let chain = straightened(chain);
        if chain.len() >= 3 {
            out.push(chain);
        }
    }
    out
}

/// Without the corners that lie on the straight way between their neighbours.
fn straightened(chain: Contour) -> Contour {
    let n = chain.len();
    let is_corner = |k: usize| {
        let (before, at, after) = (chain[(k + n - 1) % n], chain[k], chain[(k + 1) % n]);
        side(before, at, after) != 0
            || at.distance2(before).max(at.distance2(after)) > before.distance2(after)
    };
    (0..n).filter(|&k| is_corner(k)).map(|k| chain[k]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::double_area;

    fn p(x: i32, y: i32) -> Point {
        Point { x, y }
    }

    #[test]
    fn a_frame_of_triangles_has_a_hole() {
        let ring = [(0, 0), (9_000, 0), (9_000, 9_000), (0, 9_000)].map(|(x, y)| p(x, y));
        let hole = [(3_000, 3_000), (6_000, 3_000), (6_000, 6_000), (3_000, 6_000)];
        let hole = hole.map(|(x, y)| p(x, y));
        let triangles = (0..4).flat_map(|k| {
            let next = (k + 1) % 4;
            [[ring[k], ring[next], hole[k]], [hole[k], ring[next], hole[next]]]
        });
        let found = rim(triangles);
        let areas: Vec<i128> = found.iter().map(|c| double_area(c) / 2).collect();
        assert_eq!(areas, [81_000_000, -9_000_000]);
        assert!(found.iter().all(|c| c.len() == 4), "{found:?}");
    }

    #[test]
    fn a_triangle_that_folds_back_takes_nothing_from_the_whole() {
        // The second lies on the first, clockwise; the third covers it again and what is beyond.
        let (a, b, c, d) = (p(0, 0), p(9_000, 0), p(0, 9_000), p(9_000, 9_000));
        let fold = p(3_000, 3_000);
        let found = rim([[a, b, c], [c, b, fold], [c, fold, b], [c, b, d]].iter());
        assert_eq!(found.iter().map(|c| double_area(c)).sum::<i128>(), 2 * 81_000_000);
    }
}
