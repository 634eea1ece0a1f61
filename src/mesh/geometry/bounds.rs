//! Corners -> Bounds: axis-aligned boxes on the grid.

use super::vector::{Corner, length, minus};

/// An axis-aligned box, grid units; it includes both corners.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Bounds {
    /// The lowest x, y and z.
    pub(crate) low: [i32; 3],
    /// The highest.
    pub(crate) high: [i32; 3],
}

impl Bounds {
    /// The empty box: joined with another it gives the other.
    pub(crate) const NONE: Self = Self { low: [i32::MAX; 3], high: [i32::MIN; 3] };

    /// The box around some corners.
    pub(crate) fn of(corners: impl IntoIterator<Item = Corner>) -> Self {
        let point = |corner| Self { low: corner, high: corner };
        corners.into_iter().fold(Self::NONE, |all, corner| all.join(point(corner)))
    }

    /// The length of its diagonal, grid units.
    pub(crate) fn diagonal(&self) -> f64 {
        length(minus(self.high, self.low))
    }

    /// The box around both.
    pub(crate) fn join(self, other: Self) -> Self {
        Self {
            low: std::array::from_fn(|axis| self.low[axis].min(other.low[axis])),
            high: std::array::from_fn(|axis| self.high[axis].max(other.high[axis])),
        }
    }

    /// The box that both have in common, if they touch.
    pub(crate) fn common(self, other: Self) -> Self {
        Self {
            low: std::array::from_fn(|axis| self.low[axis].max(other.low[axis])),
            high: std::array::from_fn(|axis| self.high[axis].min(other.high[axis])),
        }
    }

    /// Whether both have a point in common.
    pub(crate) fn touches(&self, other: &Self) -> bool {
        (0..3).all(|axis| self.low[axis] <= other.high[axis] && other.low[axis] <= self.high[axis])
    }

    /// Whether the ray straight up from `point` can hit something in this box. The point counts as
    /// moved a little, as [`super::tree::Tree::above`] says.
    pub(crate) fn is_over(&self, point: [i32; 3]) -> bool {
        let beside = |axis: usize| point[axis] < self.low[axis] || self.high[axis] <= point[axis];
        !beside(0) && !beside(1) && point[2] < self.high[2]
    }
}
