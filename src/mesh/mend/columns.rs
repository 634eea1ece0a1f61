//! Places -> Columns: a quick test whether a triangle can lie above or below one of some places.

use crate::mesh::geometry::bounds::Bounds;
use crate::mesh::geometry::vector::{Corner, minus};

/// Cells along the longer side of the area, at most: a table of up to 256 KB. With fewer cells more
/// triangles pass the test in vain; with more the table leaves the cache.
const MOST: u32 = 512;

/// Square cells of the plane, which say where there are places.
pub(super) struct Columns {
    low: [i64; 2],
    /// The side of a cell is 2 to this power, grid units.
    shift: u32,
    /// Columns and rows of cells.
    size: [usize; 2],
    /// Whether a cell has a place, row by row.
    has: Vec<bool>,
}

impl Columns {
    /// The cells of `places`.
    pub(super) fn of(places: &[Corner]) -> Self {
        let Bounds { low, high } = match places {
            [] => Bounds { low: [0; 3], high: [0; 3] },
            places => Bounds::of(places.iter().copied()),
        };
        let [width, depth, _] = minus(high, low);
        let longer = width.max(depth).unsigned_abs();
        let shift = (u64::BITS - longer.leading_zeros()).saturating_sub(MOST.ilog2());
        let low = [i64::from(low[0]), i64::from(low[1])];
        let size = [width, depth].map(|side| (side >> shift) as usize + 1);
        let mut columns = Self { low, shift, size, has: vec![false; size[0] * size[1]] };
        for &[x, y, _] in places {
            let [column, row] = columns.cell([x, y]);
            columns.has[row * size[0] + column] = true;
        }
        columns
    }

    /// Whether there is a place in a cell under or over the box of a triangle.
    pub(super) fn meet(&self, bounds: Bounds) -> bool {
        let Bounds { low: [left, front, _], high: [right, back, _] } = bounds;
        let beyond = |axis: usize, from: i32, to: i32| {
            let end = self.low[axis] + ((self.size[axis] as i64) << self.shift);
            i64::from(to) < self.low[axis] || i64::from(from) >= end
        };
        if beyond(0, left, right) || beyond(1, front, back) {
            return false;
        }
        let ([from, first], [to, last]) = (self.cell([left, front]), self.cell([right, back]));
        (first..=last).any(|row| self.has[row * self.size[0]..][from..=to].contains(&true))
    }

    /// Column and row of the cell of a point, or of the nearest one.
    fn cell(&self, point: [i32; 2]) -> [usize; 2] {
        let along = |axis: usize| {
            let cell = (i64::from(point[axis]) - self.low[axis]).max(0) >> self.shift;
            (cell as usize).min(self.size[axis] - 1)
        };
        [along(0), along(1)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_over_a_place_meet_it_and_most_others_do_not() {
        let places: Vec<Corner> =
            (0..40).map(|k| [k * k * 997 - 300_000, k * 7_919 % 40 * 10_000, k]).collect();
        let columns = Columns::of(&places);
        let (mut met, mut over) = (0, 0);
        for k in 0..4000 {
            let low = [k * 331 % 2_000_000 - 500_000, k * 977 % 600_000 - 100_000, 0];
            let bounds = Bounds { low, high: low.map(|side| side + 40_000) };
            let holds = |place: &Corner| {
                let within =
                    |axis: usize| (bounds.low[axis]..=bounds.high[axis]).contains(&place[axis]);
                within(0) && within(1)
            };
            assert!(columns.meet(bounds) || !places.iter().any(holds));
            met += usize::from(columns.meet(bounds));
            over += usize::from(places.iter().any(holds));
        }
        assert!(over > 50 && met < over + over / 4, "{met} for {over}");
        let one = Columns::of(&places[..1]);
        assert!(one.meet(Bounds { low: places[0], high: places[0] }));
    }
}
