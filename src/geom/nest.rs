//! Contours -> Nest: which contour lies directly in which.
//!
//! The contours are those of a layer: they do not cross, outer ones run counter-clockwise, holes
//! clockwise. Then a hole lies in an outer contour, and an outer contour in a hole or in none.

pub use super::boxes::{extent, meet};

use super::boxes::Boxes;
use super::{Contour, Point, double_area, edges, encloses};

/// What lies in what.
#[derive(Debug, Clone)]
pub struct Nest {
    /// For each contour the one that it lies in.
    pub parents: Vec<Option<usize>>,
    /// For each contour whether it runs around solid.
    pub is_outer: Vec<bool>,
    /// The contours by their parents, then by their numbers.
    children: Vec<(Option<usize>, usize)>,
}

/// A contour with what is asked of it often.
struct Known<'a> {
    contour: &'a Contour,
    area: i128,
    low: Point,
    high: Point,
}

impl Known<'_> {
    /// Whether all of `other` lies in it, as they do not cross.
    fn holds(&self, other: &Known<'_>) -> bool {
        let inside = self.low.x <= other.low.x
            && self.low.y <= other.low.y
            && self.high.x >= other.high.x
            && self.high.y >= other.high.y;
        // A corner may lie on the outer contour; the side of most of them is the contour's.
        inside && {
            let at = |k: usize| other.contour.get(k * other.contour.len() / 3).copied();
            let held = (0..3).filter_map(at).filter(|p| encloses(edges(self.contour), *p)).count();
            held > 1
        }
    }
}

impl Nest {
    /// Finds the parents of `contours`.
    #[must_use]
    pub fn new(contours: &[Contour]) -> Self {
        let known = |contour| {
            let (low, high) = extent(contour).unwrap_or_default();
            Known { contour, area: double_area(contour), low, high }
        };
        let known: Vec<Known<'_>> = contours.iter().map(known).collect();
        let boxes = Boxes::new(known.iter().map(|one| (one.low, one.high)).collect());
        let parent = |one: &Known<'_>| {
            let around = boxes.around(one.low).filter(|&k| {
                let other = &known[k];
                (other.area > 0) != (one.area > 0)
                    && other.area.abs() > one.area.abs()
                    && other.holds(one)
            });
            around.min_by_key(|&k| (known[k].area.abs(), k))
        };
        let parents: Vec<Option<usize>> = known.iter().map(parent).collect();
        let mut children: Vec<_> = parents.iter().copied().zip(0..).collect();
        children.sort_unstable();
        Self { parents, is_outer: known.iter().map(|one| one.area > 0).collect(), children }
    }

    /// The contours that lie directly in contour `k`, or in none.
    pub fn within(&self, k: Option<usize>) -> impl Iterator<Item = usize> {
        let first = self.children.partition_point(|(parent, _)| *parent < k);
        let own = self.children[first..].iter().take_while(move |(parent, _)| *parent == k);
        own.map(|(_, child)| *child)
    }

    /// The outer contours.
    pub fn outer(&self) -> impl Iterator<Item = usize> {
        (0..self.is_outer.len()).filter(|&k| self.is_outer[k])
    }
}

/// A contour that runs the other way: a hole as solid.
#[must_use]
pub fn turned(contour: &Contour) -> Contour {
    contour.iter().rev().copied().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_island_in_a_hole_has_the_hole_as_parent() {
        let square = |half: i32| -> Contour {
            [(-1, -1), (1, -1), (1, 1), (-1, 1)]
                .map(|(x, y)| Point { x: x * half, y: y * half })
                .to_vec()
        };
        let contours =
            [square(10), turned(&square(300)), square(400), turned(&square(50)), square(100)];
        let nest = Nest::new(&contours);
        assert_eq!(nest.parents, [Some(3), Some(2), None, Some(4), Some(1)]);
        assert_eq!(nest.outer().collect::<Vec<_>>(), [0, 2, 4]);
        assert_eq!(nest.within(Some(1)).collect::<Vec<_>>(), [4]);
        assert_eq!(extent(&contours[4]), Some((contours[4][0], contours[4][2])));
    }
}
