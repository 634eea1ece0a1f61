//! Surface -> places on it: six points of a surface that show what it lies in.

use crate::mesh::geometry::vector::Corner;

/// The middles of the triangles of a surface that are furthest to each side. They do not depend
/// on the order of the triangles. Corners would not do: where two surfaces touch, they lie on both.
#[derive(Debug, Clone, Default)]
pub(in crate::mesh) struct Probes {
    /// Sums of the three corners: the least by x, y and z, then the greatest.
    furthest: Option<[[i64; 3]; 6]>,
}

impl Probes {
    /// Adds a triangle of the surface.
    pub(super) fn add(&mut self, corners: [Corner; 3]) {
        let sum: [i64; 3] =
            std::array::from_fn(|axis| corners.iter().map(|corner| i64::from(corner[axis])).sum());
        let furthest = self.furthest.get_or_insert([sum; 6]);
        for axis in 0..3 {
            let key = |sum: [i64; 3]| [sum[axis], sum[(axis + 1) % 3], sum[(axis + 2) % 3]];
            if key(sum) < key(furthest[axis]) {
                furthest[axis] = sum;
            }
            if key(sum) > key(furthest[axis + 3]) {
                furthest[axis + 3] = sum;
            }
        }
    }

    /// The six places, in grid units.
    pub(super) fn places(&self) -> [Corner; 6] {
        let middle = |sum: i64| i32::try_from(sum.div_euclid(3)).unwrap_or(0);
        self.furthest.unwrap_or_default().map(|sum| sum.map(middle))
    }
}

/// A surface lies in another one if at least this many of its six places do. Where surfaces touch,
/// one or two places are on the other one and may count either way, so that 6 would miss bodies
/// that touch the inside of others, and 3 would take touching neighbours for nested bodies.
pub(super) const MOST_INSIDE: usize = 4;
