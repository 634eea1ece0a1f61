//! Beads -> Sides: their centre lines with their widths, sorted into cells, to find those near a place.

use super::near::{Area, Edge, Grid};
use crate::geom::cells::Cells;

/// A side of a bead: its centre line and its width, grid units.
pub(super) type Side = (Edge, f64);

/// The sides of beads.
#[derive(Debug)]
pub(super) struct Sides {
    all: Vec<Side>,
    grid: Grid,
    cells: Cells<Side>,
}

impl Sides {
    /// Sorts `all` sides into cells of side `side`; larger ones if there would be too many.
    pub(super) fn new(all: Vec<Side>, side: f64) -> Self {
        let area = Area::around(all.iter().flat_map(|(edge, _)| *edge), 0.0);
        let grid = Grid::new(area, side);
        let cells = Cells::new(
            grid.count(),
            || all.iter().copied(),
            |(edge, _)| grid.cells(edge).flatten(),
        );
        Self { all, grid, cells }
    }

    /// All sides, in their order.
    pub(super) fn all(&self) -> &[Side] {
        &self.all
    }

    /// The sides of which the centre line may be as near to a place as `distance`; some are further away.
    pub(super) fn near(&self, at: [f64; 2], distance: f64) -> impl Iterator<Item = &Side> {
        let around = Area::around(std::iter::once(at), distance).corners();
        self.grid.cells(around).flat_map(|cells| self.cells.of(cells))
    }
}
