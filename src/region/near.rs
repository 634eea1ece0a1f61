//! Walls -> Near: whether a place keeps its distance from all of them.

use crate::geom::{Contour, edges};
use crate::units::Coord;

/// The edges of closed walls, sorted into square cells.
#[derive(Debug)]
pub(super) struct Near {
    /// From one end of an edge to the other.
    edges: Vec<[[f64; 2]; 2]>,
    /// Each edge's index in each cell that its box touches, in the order of cells.
    cells: Vec<((i32, i32), u32)>,
    side: f64,
}

impl Near {
    /// Cells of side `side`.
    pub(super) fn new(walls: &[Contour], side: Coord) -> Self {
        let point = |p: crate::geom::Point| [f64::from(p.x), f64::from(p.y)];
        let edges: Vec<[[f64; 2]; 2]> =
            walls.iter().flat_map(|w| edges(w)).map(|(p, q)| [point(p), point(q)]).collect();
        let side = f64::from(side);
        let mut cells = Vec::new();
        for (k, [p, q]) in (0..).zip(&edges) {
            let range = |i: usize| cell(p[i].min(q[i]), side)..=cell(p[i].max(q[i]), side);
            for row in range(1) {
                cells.extend(range(0).map(|column| ((row, column), k)));
            }
        }
        cells.sort_unstable();
        Self { edges, cells, side }
    }

    /// Whether no wall is nearer to `p` than `distance`.
    pub(super) fn is_free(&self, p: [f64; 2], distance: f64) -> bool {
        let range = |i: usize| cell(p[i] - distance, self.side)..=cell(p[i] + distance, self.side);
        range(1).all(|row| {
            let (low, high) = ((row, *range(0).start()), (row, *range(0).end()));
            let from = self.cells.partition_point(|(at, _)| *at < low);
            let here = self.cells[from..].iter().take_while(|(at, _)| *at <= high);
            let mut edges = here.map(|&(_, k)| self.edges[k as usize]);
            edges.all(|edge| distance2(p, edge) >= distance * distance)
        })
    }
}

fn cell(at: f64, side: f64) -> i32 {
    (at / side).floor() as i32
}

/// The squared distance from `p` to an edge.
fn distance2(p: [f64; 2], [a, b]: [[f64; 2]; 2]) -> f64 {
    let along = [b[0] - a[0], b[1] - a[1]];
    let from = [p[0] - a[0], p[1] - a[1]];
    let square = (along[0] * along[0] + along[1] * along[1]).max(1.0);
    let t = ((from[0] * along[0] + from[1] * along[1]) / square).clamp(0.0, 1.0);
    let off = [from[0] - t * along[0], from[1] - t * along[1]];
    off[0] * off[0] + off[1] * off[1]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Point;

    #[test]
    fn a_place_is_free_up_to_its_distance_from_the_nearest_wall() {
        let p = |x, y| Point { x, y };
        let square = vec![p(0, 0), p(40_000, 0), p(40_000, 40_000), p(0, 40_000)];
        let near = Near::new(&[square], 4_000);
        for (at, far) in [([20_000.0, 3_000.0], 3_000.0), ([39_000.0, 20_000.0], 1_000.0)] {
            assert!(near.is_free(at, far));
            assert!(!near.is_free(at, far + 1.0));
        }
        // Around a corner it is the corner itself that counts.
        assert!(near.is_free([43_000.0, 44_000.0], 5_000.0));
        assert!(!near.is_free([43_000.0, 44_000.0], 5_001.0));
    }
}
