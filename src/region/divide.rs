//! Layer and its neighbours -> Areas and Beads: narrow skin along the walls, the rest skin or infill.

use super::classify::{areas, areas_beside, exposed};
use super::dual::LayerAreas;
use super::gap_closing::Crossed;
use super::thin::{Strip, apart};
use super::wall_beads::{Bead, rings, taken};
use super::walls::Wall;
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
    let innermost = [0, 1].map(|r| &layer.rows[r].fill);
    let mut beads = along_walls(k, layer, &skins, innermost, params);
    beads.extend(in_strips(k, layer, &skins, params));
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

/// The beads of layer `k` where it is too thin for both passes of an inner wall, and where
/// it is too thin for infill and there is no skin as `skins` says.
fn in_strips(k: usize, layer: &Prepared, skins: &[Rows; 2], params: &Params) -> Vec<Bead> {
    let beads = |(walls, Strip { room: [a, b], narrow }): (u32, &Strip)| {
        let within = params.within(walls);
        if walls < params.walls {
            return along_walls(k, layer, narrow, [a, b], &within);
        }
        let hollow = params.infill.is_empty();
        let bare = |r: usize| if hollow { Rows::default() } else { apart(&narrow[r], &skins[r]) };
        along_walls(k, layer, &[bare(0), bare(1)], [a, b], &within)
    };
    (1..).zip(&layer.strips).flat_map(beads).collect()
}

/// The beads along the innermost of `params.walls` walls of layer `k`, whose skin is exposed
/// where `skins` says within `room`.
fn along_walls(
    k: usize,
    layer: &Prepared,
    skins: &[Rows; 2],
    room: [&Rows; 2],
    params: &Params,
) -> Vec<Bead> {
    // Without walls the ends of the lines are the part's outside, all of them alike.
    if params.walls == 0 || skins.iter().all(Rows::is_empty) {
        return Vec::new();
    }
    let (along, across) = params.skin_rasters(k);
    let crossed = Crossed {
        skin: &skins[along],
        fill: room[along],
        columns: &skins[across],
        fill_columns: room[across],
        left_turn: along == 0,
    };
    let frame = params.rasters[along].frame;
    let innermost = layer.walls.iter().filter(|w| w.depth + 1 == params.walls);
    let enter = |w: &Wall| -> Contour { w.path.iter().map(|&p| frame.enter(p)).collect() };
    let walls: Vec<Contour> = innermost.map(enter).collect();
    rings(&walls, &crossed, params)
}
