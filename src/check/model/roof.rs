//! Part -> Roof: how high the model's surface lies at a place of the bed, seen from above.
//!
//! What is judged by it are lines over slopes, whose height belongs to no layer.

use super::part::Part;
use crate::geom::cells::Cells;
use crate::geom::segment;

/// Side of a cell, mm, and cells along a side at most.
const CELL: f64 = 1.0;
const MOST_CELLS: f64 = 1024.0;

/// A triangle by its cells reaches this much further, mm: places are rounded.
const ROUNDING: f64 = 1e-6;

/// The surface.
pub(crate) struct Roof {
    triangles: Vec<[[f64; 3]; 3]>,
    low: [f64; 2],
    side: f64,
    count: [usize; 2],
    cells: Cells<u32>,
}

impl Roof {
    /// Of a part; `None` if it has no triangle.
    pub(crate) fn of(part: &Part) -> Option<Self> {
        let (low, high) = part.extent()?;
        let sides = segment::way(low, high);
        let side = CELL.max(sides[0].max(sides[1]) / MOST_CELLS);
        let count = sides.map(|length| (length / side) as usize + 1);
        let triangles: Vec<[[f64; 3]; 3]> = part.triangles().collect();
        let cell = |at: f64, axis: usize| {
            (((at - low[axis]) / side).max(0.0) as usize).min(count[axis] - 1)
        };
        let reach = |triangle: u32| {
            let corners = &triangles[triangle as usize];
            let span = |axis: usize| {
                let (from, to) = corners.iter().fold((f64::MAX, f64::MIN), |(from, to), corner| {
                    (from.min(corner[axis]), to.max(corner[axis]))
                });
                cell(from - ROUNDING, axis)..=cell(to + ROUNDING, axis)
            };
            let (columns, rows) = (span(0), span(1));
            rows.flat_map(move |row| columns.clone().map(move |column| column + row * count[0]))
        };
        let cells = Cells::new(count[0] * count[1], || (0_u32..).take(triangles.len()), reach);
        Some(Self { triangles, low, side, count, cells })
    }

    /// The highest place of the model there, mm; `None` beside it.
    pub(crate) fn at(&self, at: [f64; 2]) -> Option<f64> {
        let [x, y] = segment::way(self.low, at).map(|along| along / self.side);
        let is_in = x >= 0.0 && y >= 0.0 && x < self.count[0] as f64 && y < self.count[1] as f64;
        let cell = is_in.then_some(x as usize + y as usize * self.count[0])?;
        let some = self.cells.of(cell..cell + 1).iter();
        some.filter_map(|&triangle| height(&self.triangles[triangle as usize], at)).reduce(f64::max)
    }
}

/// The height of a triangle at a place that it covers; `None` for an upright one.
fn height([a, b, c]: &[[f64; 3]; 3], [x, y]: [f64; 2]) -> Option<f64> {
    let cross = |p: &[f64; 3], q: &[f64; 3]| (p[0] - x) * (q[1] - y) - (p[1] - y) * (q[0] - x);
    let parts = [cross(b, c), cross(c, a), cross(a, b)];
    let area: f64 = parts.iter().sum();
    let is_in = parts.iter().all(|part| part * area.signum() >= -ROUNDING);
    (is_in && area.abs() > ROUNDING)
        .then(|| (parts[0] * a[2] + parts[1] * b[2] + parts[2] * c[2]) / area)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Mesh;
    use crate::units::to_units;

    #[test]
    fn the_surface_is_the_highest_of_all_triangles_there() {
        let corners = [[0.0, 0.0, 1.0], [9.0, 0.0, 4.0], [0.0, 9.0, 1.0], [9.0, 9.0, 4.0]];
        let low = corners.map(|[x, y, _]| [x, y, 0.0]);
        let vertices = [corners, low].concat().into_iter().map(|at| at.map(to_units)).collect();
        let triangles = vec![[0, 1, 2], [2, 1, 3], [4, 6, 5], [5, 6, 7], [0, 4, 1]];
        let mesh = Mesh { vertices, triangles };
        let part = Part::new(&mesh, ([10.0, 20.0], 0.0), &[(0.2, 0.2)]).unwrap();
        let roof = Roof::of(&part).unwrap();
        for [x, y] in [[0.0, 0.0], [3.0, 4.5], [8.9, 8.9], [4.5, 4.5]] {
            let z = roof.at([10.0 + x, 20.0 + y]).unwrap();
            assert!((z - (1.0 + x / 3.0)).abs() < 1e-3, "{x} {y} {z}");
        }
        assert_eq!((roof.at([9.9, 21.0]), roof.at([15.0, 29.2])), (None, None));
    }
}
