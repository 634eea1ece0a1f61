//! Boxes -> positions: lays models out on one bed, in rows.

use crate::units::Coord;

/// Usual distance between the bounding boxes of neighbouring models, mm: about as much as other
/// slicers leave. Less leaves no room for stringing; more fits fewer models.
pub const GAP_MM: f64 = 5.0;

/// Row widths that are tried at most, so that 10 000 boxes take a million steps. With fewer, large
/// batches lie less squarely.
const TRIALS: usize = 100;

/// Where the boxes lie, grid units.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Layout {
    /// The middle of each box, in the order given. The middle of the layout is at 0, 0, to one
    /// unit.
    pub(super) middles: Vec<[Coord; 2]>,
    /// Size of the whole.
    pub(super) size: [i64; 2],
}

/// Lays `boxes` (width and depth, even numbers of units) out in rows, `gap` units apart, the
/// deepest first, so that boxes of similar depth share a row. Several row widths are tried; of
/// those that fit the bed, the one wins that leaves the widest margin. `None` if none fits.
///
/// Shelf packing by decreasing depth: Coffman, Garey, Johnson and Tarjan 1980, "Performance
/// bounds for level-oriented two-dimensional packing algorithms" (next-fit decreasing height).
pub(super) fn shelves(boxes: &[[i64; 2]], bed: [i64; 2], gap: i64) -> Option<Layout> {
    let room = |[width, depth]: [i64; 2]| i128::from(width + gap) * i128::from(depth + gap);
    if boxes.iter().map(|&size| room(size)).sum::<i128>() > room(bed) {
        return None;
    }
    let mut order: Vec<usize> = (0..boxes.len()).collect();
    order.sort_by_key(|&i| (-boxes[i][1], -boxes[i][0], i));
    let mut best: Option<(i64, Layout)> = None;
    let mut row = -gap;
    for (tried, &i) in order.iter().enumerate() {
        row += boxes[i][0] + gap;
        if tried % boxes.len().div_ceil(TRIALS) != 0 && tried + 1 != boxes.len() {
            continue;
        }
        let layout = fill(boxes, &order, row.min(bed[0]), gap);
        // The share of the bed that it takes, along the side where less is left.
        let use_of = (layout.size[0] * bed[1]).max(layout.size[1] * bed[0]);
        let fits = layout.size[0] <= bed[0] && layout.size[1] <= bed[1];
        if fits && best.as_ref().is_none_or(|(least, _)| use_of < *least) {
            best = Some((use_of, layout));
        }
    }
    best.map(|(_, layout)| layout)
}

/// Fills rows of at most `width` in the given order; a row has at least one box.
#[expect(clippy::cast_possible_truncation, reason = "a layout that fits the bed fits Coord")]
fn fill(boxes: &[[i64; 2]], order: &[usize], width: i64, gap: i64) -> Layout {
    let mut corners = vec![[0; 2]; boxes.len()];
    let (mut x, mut y, mut depth) = (0, 0, 0);
    let mut size = [0; 2];
    for &i in order {
        if x > 0 && x + boxes[i][0] > width {
            y += depth + gap;
            (x, depth) = (0, 0);
        }
        corners[i] = [x, y];
        depth = depth.max(boxes[i][1]);
        size = [size[0].max(x + boxes[i][0]), size[1].max(y + boxes[i][1])];
        x += boxes[i][0] + gap;
    }
    let middle =
        |i: usize, axis: usize| (corners[i][axis] + boxes[i][axis] / 2 - size[axis] / 2) as Coord;
    Layout { middles: (0..boxes.len()).map(|i| [middle(i, 0), middle(i, 1)]).collect(), size }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GAP: i64 = 50_000;

    fn check(boxes: &[[i64; 2]], layout: &Layout) {
        for (i, a) in boxes.iter().enumerate() {
            for (axis, side) in a.iter().enumerate() {
                let middle = i64::from(layout.middles[i][axis]);
                assert!(middle.abs() + side / 2 <= layout.size[axis] / 2 + 1);
            }
            for (j, b) in boxes.iter().enumerate().skip(i + 1) {
                let apart = |axis: usize| {
                    let distance = layout.middles[i][axis] - layout.middles[j][axis];
                    i64::from(distance).abs() - (a[axis] + b[axis]) / 2
                };
                assert!(apart(0).max(apart(1)) >= GAP, "{i} and {j}");
            }
        }
    }

    #[test]
    fn one_box_lies_in_the_middle() {
        let layout = shelves(&[[400, 202]], [1000, 1000], GAP).unwrap();
        assert_eq!(layout, Layout { middles: vec![[0, 0]], size: [400, 202] });
    }

    #[test]
    fn boxes_keep_apart() {
        let boxes: Vec<[i64; 2]> =
            (0..37).map(|i| [100_000 + 2 * (i * 7919 % 90_000), 50_000 + i * 4000]).collect();
        let layout = shelves(&boxes, [2_200_000, 2_200_000], GAP).unwrap();
        check(&boxes, &layout);
    }

    #[test]
    fn nine_squares_make_a_square() {
        let layout = shelves(&[[200_000, 200_000]; 9], [2_200_000, 2_200_000], GAP).unwrap();
        check(&[[200_000, 200_000]; 9], &layout);
        assert_eq!(layout.size, [700_000, 700_000]);
    }

    #[test]
    fn a_full_bed_is_filled_and_no_more() {
        let bed = [1_100_000, 1_100_000];
        assert!(shelves(&[[525_000, 525_000]; 4], bed, GAP).is_some());
        assert!(shelves(&[[525_000, 525_000]; 5], bed, GAP).is_none());
        assert!(shelves(&[[525_002, 525_000]; 4], bed, GAP).is_none());
    }
}
