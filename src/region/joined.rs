//! What is decided for a layer, and what belongs to it alone -> its Region.

use super::dual::beads::Counted;
use super::ironing::Ironing;
use super::overhang::Hanging;
use super::prepare::Own;
use super::walls::Wall;
use super::{Region, Skin, Sparse, SupportLines, tops};
use crate::geom::polyline::Polyline;
use crate::geom::spans::Rows;
use crate::slice::Layer;
use std::sync::Arc;

/// What is laid on a layer, whatever its block is.
#[derive(Debug)]
pub(super) struct Laid {
    /// Beads along walls where skin is narrow.
    pub(super) beads: Vec<Polyline>,
    /// The same in narrow rooms.
    pub(super) room_beads: Vec<Polyline>,
    /// Which walls fill a room: they are among the beads in narrow rooms.
    pub(super) filling: Vec<usize>,
    /// Bridges.
    pub(super) bridges: Vec<Skin>,
    /// Walls with their overhangs, if there are any.
    pub(super) hanging: Option<Vec<Hanging>>,
}

/// What is decided for one layer of a block, before its walls and beads are added.
pub(super) struct Filling {
    /// Its skins, the first on the raster of the layer's beads.
    pub(super) skins: Vec<Skin>,
    /// Its sparse lines.
    pub(super) infill: Vec<Sparse>,
    /// Its support.
    pub(super) support: SupportLines,
    /// How many layers each wall is printed for.
    pub(super) walls: Vec<u32>,
    /// Its beads in narrow rooms, by how many layers they are printed for.
    pub(super) room_beads: Counted,
    /// What is ironed.
    pub(super) ironing: Option<Ironing>,
    /// The layer above, under curved tops.
    pub(super) above: Option<Arc<Layer>>,
}

/// The region of a layer. `seen` tells tops apart: it is the cover of the layer above on the raster of this
/// one's beads, if there is a layer above.
pub(super) fn region(
    filling: Filling,
    own: Own,
    laid: Laid,
    seen: Option<Option<&Rows>>,
) -> Region {
    let Filling { mut skins, infill, support, walls: mut printed, room_beads, ironing, above } =
        filling;
    let Laid { beads, filling, bridges, hanging, .. } = laid;
    // Wall beads beside skin are for this layer alone.
    let beads = match seen {
        Some(above) => tops::add_seen(&mut skins, beads, above),
        None => beads,
    };
    let mut thick = Vec::new();
    if let Some(skin) = skins.first_mut() {
        skin.beads.extend(beads);
        for (layers, room_beads) in room_beads {
            match layers {
                1 => skin.room_beads = room_beads,
                _ => thick.push(Skin { layers, room_beads, ..skin.bare() }),
            }
        }
    }
    skins.extend(thick);
    skins.extend(bridges);
    let Own { layer, walls, thin_mm2, .. } = own;
    let (walls, hangs): (Vec<Wall>, Vec<Vec<u8>>) = match hanging {
        Some(hanging) => hanging.into_iter().map(|h| (h.wall, h.hangs)).unzip(),
        None => (walls, Vec::new()),
    };
    filling.into_iter().for_each(|index| printed[index] = 0);
    // A wall that is printed for several layers lies on the lowest of them.
    let of = |(hangs, layers): (Vec<u8>, &u32)| match layers {
        0 => None,
        1 => Some(hangs),
        _ => Some(Vec::new()),
    };
    let hangs = hangs.into_iter().zip(&printed).filter_map(of).collect();
    let printed = walls.into_iter().zip(printed).filter(|(_, layers)| *layers > 0);
    let walls = printed.map(|(wall, layers)| Wall { layers, ..wall }).collect();
    Region { layer, above, walls, hangs, skins, infill, ironing, support, thin_mm2 }
}
