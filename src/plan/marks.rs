//! Seams -> Marks: finds those near a wall without asking all.
//!
//! A plate of many parts has as many seams on each layer, and each wall looks for those near it. Few
//! are asked one after the other; many are kept in a tree, which gives the same answers.

use crate::geom::Point;
use crate::geom::nearest::Nearest;
use crate::geom::nest::meet;
use crate::units::Coord;

/// So many marks are asked one after the other; see [`super::next`].
const FEW: usize = 64;

/// Places of seams, in their order.
#[derive(Debug, Default)]
pub(super) struct Marks {
    places: Vec<Point>,
    tree: Option<Nearest>,
}

impl Marks {
    /// The marks at `places`.
    pub(super) fn new(places: Vec<Point>) -> Self {
        let tree = (places.len() > FEW).then(|| Nearest::new(places.clone()));
        Self { places, tree }
    }

    /// Those within a box of lowest and highest x and y that is grown by `reach`, in their order.
    pub(super) fn around(&self, (low, high): (Point, Point), reach: Coord) -> Vec<Point> {
        let grown =
            |p: Point, by: Coord| Point { x: p.x.saturating_add(by), y: p.y.saturating_add(by) };
        let area = (grown(low, -reach), grown(high, reach));
        match &self.tree {
            Some(tree) => tree.within(area).into_iter().map(|k| self.places[k]).collect(),
            None => self.places.iter().copied().filter(|&p| meet(area, (p, p))).collect(),
        }
    }

    /// The squared distance from `at` to the nearest.
    pub(super) fn far2(&self, at: Point) -> Option<i64> {
        match &self.tree {
            Some(tree) => tree.nearest(at, |k| k).map(|k| self.places[k].distance2(at)),
            None => self.places.iter().map(|mark| mark.distance2(at)).min(),
        }
    }

    /// What `of` gives for the nearest of the marks, measured from what lies in the box `area`: `of`
    /// returns it for the nearest of some marks, with its squared distance. Marks that are asked for
    /// lie ever further away, until no other can be nearer.
    pub(super) fn nearest<T>(
        &self,
        area: (Point, Point),
        first_reach: Coord,
        of: impl Fn(&[Point]) -> Option<(f64, T)>,
    ) -> Option<T> {
        if self.tree.is_none() {
            return of(&self.places).map(|(_, found)| found);
        }
        let mut reach = first_reach.max(1);
        loop {
            let some = self.around(area, reach);
            let found = of(&some);
            let is_all = some.len() == self.places.len() || reach == Coord::MAX / 4;
            match found {
                Some((far2, found)) if is_all || far2 < f64::from(reach) * f64::from(reach) => {
                    return Some(found);
                }
                _ if is_all => return None,
                _ => reach = reach.saturating_mul(2).min(Coord::MAX / 4),
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn many_marks_are_found_as_few_are(
            places in prop::collection::vec((-500..500, -500..500), 65..200),
            x in -900..900, y in -900..900, wide in 0..300, reach in 1..100,
        ) {
            let places: Vec<Point> = places.into_iter().map(|(x, y)| Point { x, y }).collect();
            let many = Marks::new(places.clone());
            prop_assert!(many.tree.is_some());
            let few = Marks { places, tree: None };
            let (low, high) = (Point { x, y }, Point { x: x + wide, y: y + wide });
            prop_assert_eq!(many.around((low, high), reach), few.around((low, high), reach));
            prop_assert_eq!(many.far2(low), few.far2(low));
            // The mark nearest to the middle of the box; the first of equal ones.
            let middle = Point { x: x + wide / 2, y: y + wide / 2 };
            let of = |some: &[Point]| {
                let far = some.iter().map(|p| (p.distance2(middle) as f64, *p));
                far.min_by(|a, b| a.0.total_cmp(&b.0))
            };
            let nearest = |marks: &Marks| marks.nearest((low, high), reach, of);
            prop_assert_eq!(nearest(&many), nearest(&few));
        }
    }
}
