//! Heights and head -> Glance: places where the head touches nothing, told at a glance.
//!
//! Nearly all places of a patch are clear, and by far. So the head is replaced by a cone that lies below
//! it everywhere, from the edge of a circle round the tip on. How high the tip has to be so that this
//! cone touches nothing is known for all cells after two passes over them: each cell is as high as it
//! stands, or as what the cells beside it allow, less what the cone rises from there. Where that is not
//! enough, the head itself is tried.
//!
//! The passes go from cell to cell, along rows, columns and diagonals, and such a way is up to 8.3 %
//! longer than the straight one: the cone is taken to be as much gentler.
//!
//! P. Felzenszwalb and D. Huttenlocher, "Distance transforms of sampled functions", Theory of Computing 8
//! (2012), has the idea; the passes are those of G. Borgefors, "Distance transformations in digital
//! images", CVGIP 34 (1986).

use super::stack::WIDER;
use crate::head::{DEEPEST_PRESS, Head};
use crate::nonplanar::grid::{CELL, Spot, counted};
use crate::units::to_mm;

/// A way along rows, columns and diagonals is at most so many times as long as the straight one.
const LONGER: f64 = 1.083;

/// The tip may lie anywhere in its cell, and plastic in its own or a little beside it, mm.
const SLACK: f64 = 0.15 + WIDER;

/// A cone that lies below the head.
#[derive(Debug, Clone, Copy)]
pub(super) struct Under {
    /// Radius of the circle round the tip where it begins, mm.
    from: f64,
    /// How much it rises for each mm outwards.
    pub(super) rise: f64,
}

impl Under {
    /// The cone below a head, for what it must not touch at all. Nothing stands more than `most` above
    /// the tip, mm.
    pub(super) fn of(head: &Head, most: f64) -> Self {
        let from = head.flat / 2.0;
        let rise = |r: f64, z: f64| if r > from { z / (r - from) } else { f64::INFINITY };
        let least = parts(head, most).map(|[r, z]| rise(r, z)).fold(f64::INFINITY, f64::min);
        Self { from: from + SLACK, rise: least.min(STEEPEST) }
    }

    /// The cone below a head for a surface into which it may press, with layers of this height, mm. The
    /// surface rises by no more than `most`, and its lines stand over it by `excess`, of which tips are as much
    /// higher. `None` if nothing is spare then.
    pub(super) fn pressing(
        head: &Head,
        layer: f64,
        most: f64,
        excess: Option<f64>,
    ) -> Option<Self> {
        // Lines are as wide as they are.
        let (less, slack) = excess.map_or((0.0, SLACK), |excess| (excess, SLACK - WIDER));
        // A tip and a surface that both lie anywhere in their cells.
        let spare = DEEPEST_PRESS * layer - layer / 4.0 - less;
        let from = head.flat / 2.0;
        let pressed = spare / (from + slack).max(f64::MIN_POSITIVE);
        // Beyond the ring where a touch may be press, nothing is spare.
        let beyond = head.press_radius() + slack;
        let flank = head
            .underside([head.press_radius(), 0.0])
            .map_or(STEEPEST, |(z, _)| (z - less) / beyond);
        let pressing = |r: f64| if r > head.press_radius() { -less } else { spare };
        let others = parts(head, most).map(|[r, z]| (z + pressing(r)) / (r + slack));
        let least = others.fold(pressed.min(flank), f64::min);
        (least > 0.0).then_some(Self { from: 0.0, rise: least.min(STEEPEST) })
    }
}

/// Heights are kept so exactly, mm; less is no touch.
const ROUNDING: f64 = 2e-4;

/// No cone needs to be steeper than this.
const STEEPEST: f64 = 10.0;

/// Radius and underside where a part of a head reaches furthest out, mm: there a cone below all of it is
/// gentlest. Parts above `most` are out of reach.
fn parts(head: &Head, most: f64) -> impl Iterator<Item = [f64; 2]> + '_ {
    let rise = libm::tan(head.cone.to_radians());
    let cone = [head.flat / 2.0 + head.cone_length / rise.max(f64::MIN_POSITIVE), head.cone_length];
    let boxes = head.boxes.iter().map(|&[x0, y0, x1, y1, z]| {
        let [x, y] = [x0.abs().max(x1.abs()), y0.abs().max(y1.abs())];
        [x.hypot(y), z]
    });
    let beside = head.discs.iter().copied().chain(boxes).filter(move |[_, z]| *z < most);
    std::iter::once(cone).chain(beside)
}

/// How high a tip has to be over each cell so that nothing is touched.
#[derive(Debug)]
pub(super) struct Glance {
    low: Spot,
    columns: usize,
    tips: Vec<f32>,
}

impl Glance {
    /// Over the cells from `low` on, `columns` in a row, which stand so high, mm; minus infinity where
    /// nothing does.
    pub(super) fn new(low: Spot, columns: usize, mut heights: Vec<f32>, under: Under) -> Self {
        let step = under.rise / LONGER * to_mm(CELL);
        let [side, across] = [step, step * std::f64::consts::SQRT_2].map(|v| v as f32);
        let columns = columns.max(1);
        let rows = heights.len() / columns;
        for row in 0..rows {
            pass(&mut heights, (row, row.checked_sub(1)), columns, [side, across]);
        }
        for row in (0..rows).rev() {
            let below = Some(row + 1).filter(|below| *below < rows);
            pass(&mut heights, (row, below), columns, [side, across]);
        }
        let more = (under.rise * under.from) as f32;
        heights.iter_mut().for_each(|z| *z += more);
        Self { low, columns, tips: heights }
    }

    /// The same with more that stands, which reaches no further than `other` does.
    pub(super) fn add(&mut self, other: &Self) {
        for (line, tips) in (other.low[1]..).zip(other.tips.chunks(other.columns)) {
            for (column, &tip) in (other.low[0]..).zip(tips) {
                let Some([x, y]) = counted([column, line], self.low) else { continue };
                let own = self.tips.get_mut(y * self.columns + x);
                if let Some(own) = own.filter(|_| x < self.columns) {
                    *own = own.max(tip);
                }
            }
        }
    }

    /// Whether a tip so high, mm, over a cell certainly touches nothing.
    pub(super) fn is_clear(&self, cell: Spot, z: f64) -> bool {
        let Some([x, y]) = counted(cell, self.low) else { return false };
        let known = if x < self.columns { self.tips.get(y * self.columns + x) } else { None };
        known.is_some_and(|&tip| f64::from(tip) <= z + ROUNDING)
    }
}

/// Carries heights along a row, both ways, and to it from the row beside.
fn pass(
    heights: &mut [f32],
    (row, beside): (usize, Option<usize>),
    columns: usize,
    [side, across]: [f32; 2],
) {
    let line = |row: usize| row * columns..(row + 1) * columns;
    if let Some(beside) = beside {
        let lines = [line(row), line(beside)];
        let Ok([own, beside]) = heights.get_disjoint_mut(lines) else { return };
        // One kind of step at a time: each is then done for many cells at once.
        carry(own, beside, side);
        carry(&mut own[1..], beside, across);
        carry(own, &beside[1..], across);
    }
    let own = &mut heights[line(row)];
    let mut last = f32::NEG_INFINITY;
    for height in own.iter_mut() {
        last = height.max(last - side);
        *height = last;
    }
    last = f32::NEG_INFINITY;
    for height in own.iter_mut().rev() {
        last = height.max(last - side);
        *height = last;
    }
}

/// Raises cells to what those beside them allow.
fn carry(cells: &mut [f32], beside: &[f32], step: f32) {
    for (height, beside) in cells.iter_mut().zip(beside) {
        *height = height.max(beside - step);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::head::named::{named, names};
    use crate::head::pile::Pile;
    use proptest::prelude::*;

    const SIDE: usize = 60;

    /// A pile of some cells, and their heights.
    fn pile(cells: &[(usize, usize, f64)]) -> (Pile, Vec<f32>) {
        let end = SIDE as f64 * 0.1 - 0.05;
        let mut pile = Pile::new([-0.05; 2], [end; 2], 0.1);
        let mut heights = vec![f32::NEG_INFINITY; SIDE * SIDE];
        for &(x, y, z) in cells {
            pile.raise([x, y], z);
            heights[y * SIDE + x] = heights[y * SIDE + x].max(z as f32);
        }
        (pile, heights)
    }

    proptest! {
        /// Where a glance finds nothing, the head touches nothing.
        #[test]
        fn what_is_clear_at_a_glance_is_clear(
            cells in prop::collection::vec((0..SIDE, 0..SIDE, 0.0..4.0), 1..30),
            tips in prop::collection::vec((0..SIDE, 0..SIDE, 0.0..6.0), 1..40),
            which in 0..3_usize,
        ) {
            let head = named(names().nth(which).unwrap()).unwrap();
            let (pile, heights) = pile(&cells);
            let glance = Glance::new([0, 0], SIDE, heights, Under::of(&head, 4.0));
            for (x, y, z) in tips {
                if glance.is_clear([x as i32, y as i32], z) {
                    let at = [x as f64 * 0.1 + 0.04, y as f64 * 0.1 - 0.04];
                    prop_assert_eq!(pile.hit(&head, [at[0], at[1], z], &|_| false), None);
                }
            }
        }

        /// The same where more stands than at first.
        #[test]
        fn what_is_clear_of_more_is_clear(
            cells in prop::collection::vec((0..SIDE, 0..SIDE, 0.0..4.0), 1..30),
            more in prop::collection::vec((20..SIDE, 10..SIDE, 0.0..4.0), 1..30),
            tips in prop::collection::vec((0..SIDE, 0..SIDE, 0.0..6.0), 1..40),
            which in 0..3_usize,
        ) {
            let head = named(names().nth(which).unwrap()).unwrap();
            let (mut pile, heights) = pile(&cells);
            let under = Under::of(&head, 4.0);
            let mut glance = Glance::new([0, 0], SIDE, heights, under);
            // Beyond the first cells, too: what lies there is left out.
            let (low, columns) = ([-5, -3], SIDE + 9);
            let mut heights = vec![f32::NEG_INFINITY; columns * (SIDE + 8)];
            for (x, y, z) in more {
                pile.raise([x, y], z);
                let at = (y + 3) * columns + x + 5;
                heights[at] = heights[at].max(z as f32);
            }
            glance.add(&Glance::new(low, columns, heights, under));
            for (x, y, z) in tips {
                if glance.is_clear([x as i32, y as i32], z) {
                    let at = [x as f64 * 0.1 + 0.04, y as f64 * 0.1 - 0.04];
                    prop_assert_eq!(pile.hit(&head, [at[0], at[1], z], &|_| false), None);
                }
            }
        }

        /// The same on a rough surface of which the tip is part, where press is allowed.
        #[test]
        fn a_surface_that_is_clear_at_a_glance_is_only_pressed(
            slope in prop::array::uniform2(-0.5..0.5_f64),
            bumps in prop::collection::vec((0..SIDE, 0..SIDE, 0.0..0.6), 0..12),
            which in 0..3_usize,
        ) {
            let head = named(names().nth(which).unwrap()).unwrap();
            let bump = |x: usize, y: usize| {
                let own = bumps.iter().filter(|(a, b, _)| (*a, *b) == (x, y)).map(|bump| bump.2);
                own.fold(0.0, f64::max)
            };
            let at = |x: usize, y: usize| {
                4.0 + (slope[0] * x as f64 + slope[1] * y as f64) * 0.1 + bump(x, y)
            };
            let all = (0..SIDE * SIDE).map(|k| (k % SIDE, k / SIDE, at(k % SIDE, k / SIDE)));
            let (pile, heights) = pile(&all.collect::<Vec<_>>());
            let glance = Glance::new([0, 0], SIDE, heights, Under::pressing(&head, 0.2, 10.0, None).unwrap());
            for (x, y) in (0..SIDE).step_by(7).flat_map(|x| (0..SIDE).step_by(7).map(move |y| (x, y))) {
                let z = at(x, y);
                if glance.is_clear([x as i32, y as i32], z + 1e-5) {
                    let tip = [x as f64 * 0.1, y as f64 * 0.1, z];
                    prop_assert_eq!(pile.hit_printing(&head, tip, 0.2), None);
                }
            }
        }
    }

    #[test]
    fn a_gentle_plane_is_clear_and_a_steep_one_is_not() {
        let head = named("long-0.6").unwrap();
        let clear = |slope: f64| {
            let at = |k: usize| (k % SIDE, k / SIDE, (k % SIDE) as f64 * 0.1 * slope);
            let (_, heights) = pile(&(0..SIDE * SIDE).map(at).collect::<Vec<_>>());
            let glance = Glance::new(
                [0, 0],
                SIDE,
                heights,
                Under::pressing(&head, 0.2, 10.0, None).unwrap(),
            );
            glance.is_clear([30, 30], at(30).2 + 1e-5)
        };
        assert!(clear(0.3) && !clear(0.8));
    }
}
