//! First layer + the width of its lines -> its Region in lines of that width.
//!
//! All of it is skin between walls, since nothing lies below it. So it needs no neighbour: it is
//! divided as the only layer of a part, on rasters of its own. The layers above go on from its
//! contours, not from its lines, and do not see the difference.

use super::divide::{divide, examine};
use super::first_skin;
use super::params::RegionParams;
use super::per_raster::skin_turn;
use super::prepare::prepare;
use super::{Region, Skin};

/// The first layer of a part, `usual`, in the lines of `params`. Its support stays as it is.
#[must_use]
pub fn widen(usual: Region, params: &RegionParams) -> Region {
    let (own, rows) = prepare((*usual.layer).clone(), params);
    let k = own.layer.index;
    let layers = |layer: usize| (layer == k).then_some(&rows);
    let examined = examine(&own, &layers, params);
    let divided = divide(&own, &examined, std::iter::empty(), &layers, None, params);
    let (along, across) = skin_turn(k);
    let part: first_skin::Both =
        [along, across].map(|raster| divided.areas.skin(raster).skin.clone());
    let skin = Skin::on(params, (along, across), 1, &divided.areas, part);
    let skin = Skin { beads: divided.beads, room_beads: divided.room_beads, ..skin };
    Region {
        walls: own.walls,
        hangs: Vec::new(),
        skins: vec![skin],
        infill: Vec::new(),
        thin_mm2: own.thin_mm2,
        ..usual
    }
}
