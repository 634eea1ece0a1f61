//! Block of layers -> what of its walls, beads and support is printed once for several layers.

use super::{Support, Window};
use crate::geom::polyline::Polyline;
use crate::geom::spans::Rows;
use crate::profile::DualPart;
use crate::region::dual::audit::Audit;
use crate::region::dual::beads::{self, Counted};
use crate::region::dual::groups::Block;
use crate::region::per_raster::skin_turn;
use crate::region::support::{BODIES, SupportLayer};
use crate::region::walls::{self, Wall};
use crate::region::{Sparse, SupportLines, dual};

impl Window<'_> {
    /// The number of layers that each wall of each layer of a block is printed for.
    pub(super) fn share_walls(&self, block: &Block) -> Vec<Vec<u32>> {
        let walls = |k| self.own.get(k).map_or(&[] as &[Wall], |own| &own.walls);
        let layers: Vec<&[Wall]> = block.layers.clone().map(walls).collect();
        if self.grouping.shares(DualPart::InnerWalls) {
            let thin = |k: usize| self.is_thin(k);
            let fills = |k: usize, i: usize| {
                self.beads.get(k).is_some_and(|laid| laid.filling.contains(&i))
            };
            walls::share(block, &layers, self.grouping, &thin, &fills, &self.params.walls)
        } else {
            layers.iter().map(|walls| vec![1; walls.len()]).collect()
        }
    }

    /// The beads in narrow rooms of each layer of a block, by how many layers they are printed for.
    pub(super) fn share_beads(&self, block: &Block) -> Vec<Counted> {
        let beads = |k| self.beads.get(k).map_or(&[] as &[Polyline], |laid| &laid.room_beads);
        let frame = |k| self.params.rasters.skin(skin_turn(k).0).frame;
        let layers: Vec<_> = block.layers.clone().map(|k| (frame(k), beads(k))).collect();
        if self.grouping.shares(DualPart::Infill) && !self.grouping.drops {
            let thin = |k: usize| self.is_thin(k);
            beads::share(block, &layers, self.grouping, &thin, self.params.walls.line_width)
        } else {
            layers.iter().map(|(_, beads)| vec![(1, beads.to_vec())]).collect()
        }
    }

    /// The support of each layer of a block.
    pub(super) fn share_support(&self, block: &Block) -> (Vec<SupportLines>, Option<Audit>) {
        let Some(Support { patterns, layers }) = &self.support else {
            return (block.layers.clone().map(|_| SupportLines::default()).collect(), None);
        };
        let layers = &layers[block.layers.clone()];
        let width = self.params.walls.line_width;
        let rows = |n: usize| layers.iter().map(|layer| layer.body[n].clone()).collect();
        let rows: [Vec<Rows>; BODIES] = std::array::from_fn(rows);
        let (bodies, audit) = dual::support(block, &rows, &patterns.body, self.grouping, width);
        // What carries the part is printed layer by layer, as finely as the part.
        let lines = |(layer, body): (&SupportLayer, Vec<Sparse>)| {
            let dense = patterns.interface.iter().zip(&layer.interface);
            let interface =
                dense.filter(|(_, rows)| !rows.is_empty()).map(|(pattern, rows)| Sparse {
                    pattern: pattern.clone(),
                    rows: rows.clone(),
                    layers: 1,
                    width,
                    border: None,
                });
            SupportLines { body, interface: interface.collect(), outlines: layer.outlines.clone() }
        };
        (layers.iter().zip(bodies).map(lines).collect(), audit)
    }
}
