//! Layer and its neighbours -> Areas and beads: narrow skin as wall beads, the rest as skin or infill.

use super::classify::{Areas, areas, areas_beside, exposed};
use super::crossed::Crossed;
use super::params::{BeadParams, RegionParams};
use super::per_raster::{PerRaster, skin_turn};
use super::prepare::{LayerRows, Own};
use super::strips::{Strip, apart};
use super::wall_beads::{taken, wall_beads};
use crate::geom::Contour;
use crate::geom::polyline::Polyline;
use crate::geom::raster::Raster;
use crate::geom::spans::Rows;

/// Areas of one layer on both rasters of skins, and on the others that were requested.
pub type LayerAreas = PerRaster<Areas>;

/// Divides the layer `own`, one of `layers`. Returns its areas on both rasters of skins and on
/// `more`, and its wall beads in the frame of its skin's raster. `layers(k)` is `None` outside
/// the part.
#[must_use]
pub fn divide<'a>(
    own: &Own,
    more: impl Iterator<Item = Raster>,
    layers: &impl Fn(usize) -> Option<&'a LayerRows>,
    params: &RegionParams,
) -> (LayerAreas, Vec<Polyline>) {
    let k = own.layer.index;
    let exposed = |raster| exposed(k, raster, layers, &params.skins);
    let skins = [0, 1].map(|r| exposed(params.rasters.skin(r)));
    let fill = |raster| layers(k)?.on(raster).map(|rows| &rows.fill);
    let beads = beads(own, &skins, layers, params);
    let along = params.rasters.skin(skin_turn(k).0);
    let areas_on = |raster: Raster| {
        let Some(fill) = fill(raster) else { return Areas::default() };
        let other;
        let uncovered = match (0..2).find(|&r| params.rasters.skin(r) == raster) {
            Some(r) => &skins[r],
            None => {
                other = exposed(raster);
                &other
            }
        };
        if beads.is_empty() {
            return areas(fill, uncovered, raster.pitch, &params.skins);
        }
        let taken = taken(&beads, along.frame, raster, &params.beads);
        areas_beside(&taken, fill, uncovered, raster.pitch, &params.skins)
    };
    let areas = PerRaster::new(&params.rasters, more, areas_on);
    (areas, beads)
}

/// The beads of a layer: along its innermost walls where the exposed `skins` are narrow, and in
/// strips.
fn beads<'a>(
    own: &Own,
    skins: &[Rows; 2],
    layers: &impl Fn(usize) -> Option<&'a LayerRows>,
    params: &RegionParams,
) -> Vec<Polyline> {
    let Some(rows) = layers(own.layer.index) else { return Vec::new() };
    let innermost = [0, 1].map(|r| &*rows.skin(r).fill);
    let mut beads = along_walls(own, params.walls.count, skins, innermost, params, &params.beads);
    beads.extend(in_strips(own, skins, params));
    beads
}

/// The beads of a layer where it is too thin for both passes of an inner wall, and where it is
/// too thin for infill and no skin fills it.
fn in_strips(own: &Own, skins: &[Rows; 2], params: &RegionParams) -> Vec<Polyline> {
    let only_strips = BeadParams { only_strips: true, ..params.beads };
    let beads = |(walls, Strip { room: [a, b], narrow }): (u32, &Strip)| {
        let room = [a, b];
        if walls < params.walls.count {
            return along_walls(own, walls, narrow, room, params, &only_strips);
        }
        let hollow = params.sparse.is_empty();
        let uncovered =
            |r: usize| if hollow { Rows::default() } else { apart(&narrow[r], &skins[r]) };
        along_walls(own, walls, &[uncovered(0), uncovered(1)], room, params, &only_strips)
    };
    (1..).zip(&own.strips).flat_map(beads).collect()
}

/// The beads of a layer along the innermost of its first `count` walls. `skins` is the exposed
/// skin, `room` where beads may run.
fn along_walls(
    own: &Own,
    count: u32,
    skins: &[Rows; 2],
    room: [&Rows; 2],
    params: &RegionParams,
    beads: &BeadParams,
) -> Vec<Polyline> {
    // Without walls the ends of lines form the outside of the part, so all skin stays lines.
    if count == 0 || skins.iter().all(Rows::is_empty) {
        return Vec::new();
    }
    let (along, across) = skin_turn(own.layer.index);
    let crossed = Crossed {
        skin: &skins[along],
        fill: room[along],
        columns: &skins[across],
        fill_columns: room[across],
        left_turn: along == 0,
    };
    let frame = params.rasters.skin(along).frame;
    let innermost = own.walls.iter().filter(|w| w.depth + 1 == count);
    let walls = innermost.map(|w| -> Contour { w.path.iter().map(|&p| frame.enter(p)).collect() });
    wall_beads(&walls.collect::<Vec<_>>(), &crossed, beads)
}
