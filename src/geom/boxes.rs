//! Boxes -> Boxes: finds those around a place without asking each; so too which contours run around it.
//!
//! A hierarchical grid: a box lies in a layer of square cells that are as wide as it is, or up to twice as wide. So it
//! reaches into at most four of them, and a place into one cell of each layer. Layers that hold no
//! box are left out; there are at most 32 others.

use super::{Contour, Point, edges, encloses};

/// So many boxes are asked one by one. More cost time where there are few boxes, as there mostly
/// are; fewer make lists that are not worth it.
const FEW: usize = 32;

/// A layer of cells, then row and column of a cell in it.
type Cell = (u32, i64, i64);

/// Boxes, each of lowest and highest x and y.
#[derive(Debug, Default)]
pub struct Boxes {
    boxes: Vec<(Point, Point)>,
    /// The boxes that reach into each cell, in the order of the cells; empty if there are few boxes.
    cells: Vec<(Cell, usize)>,
    /// The layers that hold boxes.
    layers: Vec<u32>,
}

impl Boxes {
    /// Sorts `boxes` into cells, in n log n time.
    #[must_use]
    pub fn new(boxes: Vec<(Point, Point)>) -> Self {
        let (mut cells, mut layers) = (Vec::new(), Vec::new());
        if boxes.len() > FEW {
            for (k, &(low, high)) in boxes.iter().enumerate() {
                let wide = (i64::from(high.x) - i64::from(low.x))
                    .max(i64::from(high.y) - i64::from(low.y))
                    .max(0);
                let layer = i64::BITS - wide.leading_zeros();
                layers.push(layer);
                let ((_, top, left), (_, bottom, right)) = (cell(layer, low), cell(layer, high));
                let rows = (top..=bottom).flat_map(|row| (left..=right).map(move |at| (row, at)));
                cells.extend(rows.map(|(row, column)| ((layer, row, column), k)));
            }
            cells.sort_unstable();
            layers.sort_unstable();
            layers.dedup();
        }
        Self { boxes, cells, layers }
    }

    /// The numbers of the boxes that have a place in common with another one, in their order.
    #[must_use]
    pub fn meeting(&self, other: (Point, Point)) -> Vec<usize> {
        let meets = |&k: &usize| meet(self.boxes[k], other);
        if self.boxes.len() <= FEW {
            return (0..self.boxes.len()).filter(meets).collect();
        }
        let mut found = Vec::new();
        for &layer in &self.layers {
            let ((_, top, left), (_, bottom, right)) = (cell(layer, other.0), cell(layer, other.1));
            let rows = if bottom - top < self.boxes.len() as i64 { top..bottom + 1 } else { 0..0 };
            for row in rows.clone() {
                let first = self.cells.partition_point(|(at, _)| *at < (layer, row, left));
                let near = self.cells[first..].iter();
                found
                    .extend(near.take_while(|(at, _)| *at <= (layer, row, right)).map(|(_, k)| *k));
            }
            // A box over very many rows of small cells is asked by all others.
            if rows.is_empty() {
                let own = self.cells.iter().filter(|((at, ..), _)| *at == layer);
                found.extend(own.map(|(_, k)| *k));
            }
        }
        found.sort_unstable();
        found.dedup();
        found.retain(meets);
        found
    }

    /// The numbers of the boxes around `p`, or with it on a side, in no order.
    pub fn around(&self, p: Point) -> impl Iterator<Item = usize> {
        let few = 0..if self.boxes.len() > FEW { 0 } else { self.boxes.len() };
        let sorted = self.layers.iter().flat_map(move |&layer| {
            let cell = cell(layer, p);
            let first = self.cells.partition_point(|(other, _)| *other < cell);
            self.cells[first..].iter().take_while(move |(other, _)| *other == cell)
        });
        few.chain(sorted.map(|(_, k)| *k)).filter(move |&k| {
            let (low, high) = self.boxes[k];
            low.x <= p.x && p.x <= high.x && low.y <= p.y && p.y <= high.y
        })
    }
}

/// Contours, to find those that run around a place.
#[derive(Debug)]
pub struct Around<'a> {
    /// With the numbers that they were given.
    contours: Vec<(usize, &'a Contour)>,
    boxes: Boxes,
}

impl<'a> Around<'a> {
    /// Sorts some contours that have numbers.
    #[must_use]
    pub fn new(numbered: impl Iterator<Item = (usize, &'a Contour)>) -> Self {
        let known = numbered.filter_map(|(k, contour)| Some(((k, contour), extent(contour)?)));
        let (contours, boxes) = known.unzip();
        Self { contours, boxes: Boxes::new(boxes) }
    }

    /// Those around `p`, each by itself, in no order. Of what `p` lies on, some may count.
    pub fn of(&self, p: Point) -> impl Iterator<Item = usize> {
        let near = self.boxes.around(p).map(|k| self.contours[k]);
        near.filter(move |(_, contour)| encloses(edges(contour), p)).map(|(k, _)| k)
    }
}

/// Lowest and highest x and y of some points; `None` without any.
#[must_use]
pub fn extent<'a>(points: impl IntoIterator<Item = &'a Point>) -> Option<(Point, Point)> {
    points.into_iter().fold(None, |extent, p| {
        let (low, high) = extent.unwrap_or((*p, *p));
        let low = Point { x: low.x.min(p.x), y: low.y.min(p.y) };
        Some((low, Point { x: high.x.max(p.x), y: high.y.max(p.y) }))
    })
}

/// Whether two boxes, each of lowest and highest x and y, have a place in common.
#[must_use]
pub fn meet(one: (Point, Point), other: (Point, Point)) -> bool {
    let apart = |a: (Point, Point), b: (Point, Point)| a.1.x < b.0.x || a.1.y < b.0.y;
    !apart(one, other) && !apart(other, one)
}

/// The cell of a layer that holds `p`.
fn cell(layer: u32, p: Point) -> Cell {
    (layer, i64::from(p.y) >> layer, i64::from(p.x) >> layer)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn boxes_around_a_place_are_found_once_each(
            boxes in prop::collection::vec((-900..900, -900..900, 0..300, 0..300, 0..9_u32), 0..120),
            places in prop::collection::vec((-1000..1000, -1000..1000), 1..40),
        ) {
            // Of sizes that differ by a factor of 256.
            let corners = |&(x, y, wide, deep, by): &(i32, i32, i32, i32, u32)| {
                (Point { x, y }, Point { x: x + (wide >> by), y: y + (deep >> by) })
            };
            let boxes: Vec<(Point, Point)> = boxes.iter().map(corners).collect();
            let sorted = Boxes::new(boxes.clone());
            for (x, y) in places {
                let holds = |(low, high): &(Point, Point)| {
                    low.x <= x && x <= high.x && low.y <= y && y <= high.y
                };
                let expected: Vec<usize> = (0..boxes.len()).filter(|&k| holds(&boxes[k])).collect();
                let mut found: Vec<usize> = sorted.around(Point { x, y }).collect();
                found.sort_unstable();
                prop_assert_eq!(found, expected);
                let other = (Point { x, y }, Point { x: x + 70, y: y + 300 });
                let meets = |&k: &usize| meet(boxes[k], other);
                let expected: Vec<usize> = (0..boxes.len()).filter(meets).collect();
                prop_assert_eq!(sorted.meeting(other), expected);
            }
        }
    }
}
