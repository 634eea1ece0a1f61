//! Layer and its neighbours -> Areas and Beads: narrow skin along the walls, the rest skin or infill.

use super::classify::{areas, areas_beside, exposed};
use super::close::Crossed;
use super::dual::LayerAreas;
use super::rings::{Bead, rings, taken};
use super::{Params, Prepared};
use crate::geom::Contour;
use crate::geom::spans::Rows;

/// Divides layer `k` of `layers`: its areas on both skin rasters and on those that `more`
/// names, and the beads along its walls, in the frame of the raster of its skin.
/// `layers(k)` is `None` outside the part.
#[must_use]
pub fn divide<'a>(
    k: usize,
    more: impl Iterator<Item = usize>,
    layers: &impl Fn(usize) -> Option<&'a Prepared>,
    params: &Params,
) -> (LayerAreas, Vec<Bead>) {
    let mut out: LayerAreas = vec![None; params.rasters.len()];
    let Some(layer) = layers(k) else { return (out, Vec::new()) };
    let exposed = |r| exposed(k, r, layers, params);
    let skins = [exposed(0), exposed(1)];
    let beads = beads(k, layer, &skins, params);
    let along = params.rasters[params.skin_rasters(k).0];
    for r in [0, 1].into_iter().chain(more) {
        if out[r].is_some() {
            continue;
        }
        let (raster, fill) = (params.rasters[r], &layer.rows[r].fill);
        let other;
        let bare = match skins.get(r) {
            Some(rows) => rows,
            None => {
                other = exposed(r);
                &other
            }
        };
        out[r] = Some(if beads.is_empty() {
            areas(fill, bare, raster.pitch, params)
        } else {
            let taken = taken(&beads, along.frame, raster, params);
            areas_beside(&taken, fill, bare, raster.pitch, params)
        });
    }
    (out, beads)
}

/// The beads along the walls of layer `k`, whose skin is exposed where `skins` says on
/// the two skin rasters.
fn beads(k: usize, layer: &Prepared, skins: &[Rows; 2], params: &Params) -> Vec<Bead> {
    if skins.iter().all(Rows::is_empty) {
        return Vec::new();
    }
    let (along, across) = params.skin_rasters(k);
    let crossed = Crossed {
        skin: &skins[along],
        fill: &layer.rows[along].fill,
        columns: &skins[across],
        fill_columns: &layer.rows[across].fill,
        left_turn: along == 0,
    };
    let frame = params.rasters[along].frame;
    let enter = |c: &Contour| c.iter().map(|&p| frame.enter(p)).collect();
    let walls: Vec<Contour> = match params.walls {
        0 => layer.layer.contours.iter().map(enter).collect(),
        n => layer.walls.iter().filter(|w| w.depth + 1 == n).map(|w| enter(&w.path)).collect(),
    };
    rings(&walls, &crossed, params)
}
