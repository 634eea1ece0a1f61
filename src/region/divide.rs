//! Layer and its neighbours -> Divided: narrow skin as wall beads, bridges, the rest as skin or infill.
//!
//! Words: a layer is *exposed* where a neighbour does not cover it. A *room* is a place too narrow for
//! sparse lines; it is solid.
//!
//! Algorithm: first a layer is examined alone: what is exposed, which rooms it has, and which beads
//! along walls fill the narrow parts of both. Then, with the layer below, bridges take their place, and
//! what is left is skin or infill. Last, strips in which no sparse line has room become skin, and so does
//! what of rooms is skin on the other of the two rasters of skins.

use super::Skin;
use super::bridge::loose::{self, Beads, Below};
use super::bridge::{self, Open, Pair, ledges};
use super::classify::{Areas, areas, areas_beside, exposed};
use super::crossed::Crossed;
use super::hidden::{self, between_walls};
use super::needed::needed;
use super::overhang::{Hanging, overhangs};
use super::params::RegionParams;
use super::per_raster::{PerRaster, skin_turn};
use super::prepare::{LayerRows, Own, Whole};
use super::rooms;
use super::scan::around;
use super::wall_beads::{taken, wall_beads};
use super::wall_samples::SHORT;
use super::wedges::{without_patchwork, without_wedges};
use crate::geom::Contour;
use crate::geom::frame::Frame;
use crate::geom::outline::Columns;
use crate::geom::polyline::Polyline;
use crate::geom::raster::Raster;
use crate::geom::spans::Rows;
use crate::slice::Layer;
use crate::units::Coord;
use std::borrow::Cow;

/// How far from a skin line's middle there is no infill on other rasters, % of half its width. At 100
/// half of an infill line may lie on it; a larger value leaves a gap between the two.
const BESIDE_SKIN: Coord = 150;

/// Areas of one layer on both rasters of skins, and on the others that were requested.
pub type LayerAreas = PerRaster<Areas>;

/// What a layer is divided into.
#[derive(Debug)]
pub struct Divided {
    /// Its areas.
    pub areas: LayerAreas,
    /// Its wall beads, in the frame of its skin's raster.
    pub beads: Vec<Polyline>,
    /// Those of its rooms too narrow for sparse lines, where nothing is exposed.
    pub room_beads: Vec<Polyline>,
    /// Which of its walls fill a room that nothing exposes; they are among the beads of its rooms.
    pub filling: Vec<usize>,
    /// Its bridges.
    pub bridges: Vec<Skin>,
    /// Its walls with their overhangs, if there are any.
    pub hanging: Option<Vec<Hanging>>,
}

/// What a layer alone and its neighbours' rows tell, before what lies below is looked at.
#[derive(Debug)]
pub struct Examined {
    /// Where its neighbours leave it exposed, on the two rasters of skins.
    pub exposed: [Rows; 2],
    /// Its rooms too narrow for sparse lines, on the same.
    pub solid: Option<[Rows; 2]>,
    /// Wall beads for the narrow parts of both, in the frame of its skin's raster.
    pub beads: Vec<Polyline>,
}

/// The layer below the one that is divided.
#[derive(Debug)]
pub struct Lower<'a> {
    /// The layer.
    pub layer: &'a Layer,
    /// What it was divided by.
    pub examined: &'a Examined,
    /// The direction of its sparse lines, if skin has to run across.
    pub lines: Option<Frame>,
}

/// Examines the layer `own`, one of `layers`, which are `None` outside the part.
#[must_use]
pub fn examine<'a>(
    own: &Own,
    layers: &impl Fn(usize) -> Option<&'a LayerRows>,
    params: &RegionParams,
) -> Examined {
    let exposed =
        |r: usize| exposed(own.layer.index, params.rasters.skin(r), layers, &params.skins);
    let exposed = [0, 1].map(exposed);
    let solid = solid(own.layer.index, layers, params);
    let beads = match &solid {
        Some(rooms @ [a, b]) => {
            let areas = [exposed[0].or(a), exposed[1].or(b)];
            let beads = beads(own, &areas, layers, params);
            // Rooms are alike on many layers: what goes on from one to the next would make a wall.
            let beads = needed(own.layer.index, beads, &areas, params.beads.line_width, SHORT);
            without_wedges(own.layer.index, beads, rooms, params)
        }
        None => beads(own, &exposed, layers, params),
    };
    let along = skin_turn(own.layer.index).0;
    let beads = match room(own, layers) {
        Some(room) => {
            let strips = (room[along], &exposed[along]);
            without_patchwork(own.layer.index, beads, strips, params)
        }
        None => beads,
    };
    Examined { exposed, solid, beads }
}

/// Divides the layer `own`, one of `layers`. Its areas are on both rasters of skins and on `more`.
/// `layers(k)` is `None` outside the part; `below` is the layer below.
#[must_use]
pub fn divide<'a>(
    own: &Own,
    examined: &Examined,
    more: impl Iterator<Item = Raster>,
    layers: &impl Fn(usize) -> Option<&'a LayerRows>,
    below: Option<&Lower<'_>>,
    params: &RegionParams,
) -> Divided {
    let k = own.layer.index;
    let exposed = |raster| exposed(k, raster, layers, &params.skins);
    let skins = &examined.exposed;
    let fill = |raster| layers(k)?.on(raster).map(|rows| &rows.fill);
    let both = [0, 1].map(|r| params.rasters.skin(r));
    let index = |raster: Raster| both.iter().position(|r| *r == raster);
    let on = |narrow: &[Rows; 2], raster: Raster, region: &Rows| match index(raster) {
        Some(r) => narrow[r].clone(),
        None => rooms::on_raster(narrow, both, raster, region),
    };
    let solid = &examined.solid;
    let held = held(k, examined, layers, below, params);
    let open = Open::new(k, layers, params);
    let (Beads { kept: beads, cut }, bridges) = over_air(own, held, below.zip(open), params);
    let along = params.rasters.skin(skin_turn(k).0);
    let areas_on = |raster: Raster| {
        let Some(fill) = fill(raster) else { return Areas::default() };
        let uncovered = match index(raster) {
            Some(r) => Cow::Borrowed(&skins[r]),
            None => Cow::Owned(exposed(raster)),
        };
        let solid = solid.as_ref().map(|solid| on(solid, raster, fill));
        let uncovered = with_bare(uncovered, &cut, along.frame, (raster, fill), solid.as_ref());
        if beads.is_empty() && bridges.is_empty() {
            return areas(fill, &uncovered, solid.as_ref(), raster.pitch, &params.skins);
        }
        let mut taken = taken(&beads, along.frame, raster, &params.beads);
        if !bridges.is_empty() {
            taken = taken.or(&bridge::taken(&bridges, raster, params));
        }
        areas_beside(&taken, fill, &uncovered, solid.as_ref(), raster.pitch, &params.skins)
    };
    let areas = PerRaster::new(&params.rasters, more, areas_on);
    // Strips between skin or a bridge and a wall in which no sparse line has room.
    let infill = [0, 1].map(|r| &areas.skin(r).infill);
    let limit = least_strip(&areas, &bridges, params);
    let strips = limit.and_then(|limit| rooms::narrow(infill, both, limit));
    let areas = match strips {
        Some(strips) => areas.map_on(|raster, its| {
            let strips = on(&strips, raster, &its.infill);
            its.with_skin(&strips)
        }),
        None => areas,
    };
    let areas = beside_skin(agreed(areas, both), skin_turn(k).0, both);
    let hanging = overhangs(k, &own.walls, layers, params);
    let filling = between_walls(k, &own.walls, layers, params);
    let (mut room_beads, beads) = hidden::beads(k, beads, solid.as_ref(), skins, params);
    let bead = |index: &usize| own.walls[*index].bead(along.frame, params.walls.line_width);
    room_beads.extend(filling.iter().map(bead));
    Divided { areas, beads, room_beads, filling, bridges, hanging }
}

/// `areas` in which the two rasters of skins agree about rooms: what is skin on one is no solid infill on
/// the other. A strip of skin thinner than the distance of the rows, with what it reaches, is seen by the rows
/// across it alone. Skin along these and solid infill along the others would be printed one on the other.
fn agreed(areas: LayerAreas, both: [Raster; 2]) -> LayerAreas {
    let taken = [0, 1].map(|r| {
        let (dense, pitch) = (&areas.skin(r).dense, both[r].pitch);
        let (rows, across) = (&areas.skin(1 - r).skin, both[1 - r].pitch);
        if dense.is_empty() || rows.is_empty() {
            return Rows::default();
        }
        let held = Columns { rows, pitch: across, left_turn: r == 0 }.held(dense, pitch);
        // Both are rounded to lines: shorter bits are at borders that they share.
        rooms::whole(dense, &held.filter(|_, s| s.len() >= i64::from(across)), across)
    });
    if taken.iter().all(Rows::is_empty) {
        return areas;
    }
    areas.map_on(|raster, areas| match both.iter().position(|its| *its == raster) {
        Some(r) => areas.with_skin_of(&taken[r]),
        None => areas,
    })
}

/// `areas` whose infill keeps off the skin, which is printed on one of `both` rasters, the one `along`.
/// On a raster with rows at other distances the same reach ends elsewhere, and an infill line would run
/// along the last skin line, on it.
fn beside_skin(areas: LayerAreas, along: usize, both: [Raster; 2]) -> LayerAreas {
    let (skin, its) = (areas.skin(along).skin.clone(), both[along]);
    if skin.is_empty() {
        return areas;
    }
    let spans = || skin.iter().flat_map(|(j, row)| row.iter().map(move |span| (j, *span)));
    areas.map_on(|raster, areas| {
        if both.contains(&raster) || areas.infill.is_empty() {
            return areas;
        }
        let edges = rooms::edges(spans(), its, raster).into_iter();
        let near = edges.map(|(from, to, half)| (from, to, half * BESIDE_SKIN / 100));
        areas.beside(&around(&near.collect::<Vec<_>>(), raster))
    })
}

/// What is `uncovered` on a raster with these `fill` rows, and what beads that were `cut` out, given in the
/// frame `from`, leave bare. Rooms are `solid` anyway, with lines across.
fn with_bare<'a>(
    uncovered: Cow<'a, Rows>,
    cut: &[Polyline],
    from: Frame,
    (raster, fill): (Raster, &Rows),
    solid: Option<&Rows>,
) -> Cow<'a, Rows> {
    if cut.is_empty() {
        return uncovered;
    }
    let bare = loose::bare(cut, from, raster).and(fill);
    Cow::Owned(match solid {
        Some(solid) => uncovered.or(&bare.minus(solid)),
        None => uncovered.or(&bare),
    })
}

/// Narrower strips of infill become skin; `None` if there is nothing beside which they could be.
fn least_strip(areas: &LayerAreas, bridges: &[Skin], params: &RegionParams) -> Option<Coord> {
    let skinned = !bridges.is_empty() || (0..2).any(|r| !areas.skin(r).skin.is_empty());
    (skinned && !params.sparse.is_empty()).then_some(params.skins.reach)
}

/// The rooms of layer `k` too narrow for sparse lines, on the rasters of skins.
fn solid<'a>(
    k: usize,
    layers: &impl Fn(usize) -> Option<&'a LayerRows>,
    params: &RegionParams,
) -> Option<[Rows; 2]> {
    let rows = layers(k)?;
    let fill = [0, 1].map(|r| &*rows.skin(r).fill);
    rooms::narrow(fill, [0, 1].map(|r| params.rasters.skin(r)), params.skins.least_room)
}

/// The beads of a layer, `held` by sparse lines below, that do not hang where it is open, and its bridges.
fn over_air(
    own: &Own,
    held: Beads,
    lower: Option<(&Lower<'_>, Open<'_>)>,
    params: &RegionParams,
) -> (Beads, Vec<Skin>) {
    let Some((below, open)) = lower else { return (held, Vec::new()) };
    let pair = Pair { own, below: below.layer, beads: &held.kept };
    let beads = match ledges::held(pair, &open, params) {
        Some(Beads { kept, cut }) => Beads { kept, cut: [cut, held.cut].concat() },
        None => held,
    };
    let pair = Pair { own, below: below.layer, beads: &beads.kept };
    let bridges = bridge::bridges(pair, open, params);
    (beads, bridges)
}

/// The beads of layer `k`; cut out is what would lie along the sparse lines below.
fn held<'a>(
    k: usize,
    own: &Examined,
    layers: &impl Fn(usize) -> Option<&'a LayerRows>,
    below: Option<&Lower<'_>>,
    params: &RegionParams,
) -> Beads {
    let beads = own.beads.clone();
    let lower = below.and_then(|below| Some((below, below.lines?, layers(k.checked_sub(1)?)?)));
    let Some((below, lines, rows)) = lower.filter(|_| !beads.is_empty()) else {
        return Beads { kept: beads, cut: Vec::new() };
    };
    let along = skin_turn(k).0;
    let Examined { exposed, solid, .. } = below.examined;
    let skin = solid.as_ref().map(|solid| exposed[along].or(&solid[along]));
    let below = Below {
        raster: params.rasters.skin(along),
        fill: &rows.skin(along).fill,
        exposed: skin.as_ref().unwrap_or(&exposed[along]),
        lines,
    };
    let Beads { kept, cut } = loose::held(beads, &below);
    // Beads of rooms go on beside these. What nothing exposes needs no cover.
    let cut = match own.solid {
        Some(_) => needed(k, cut, &own.exposed, params.beads.line_width, 0.0),
        None => cut,
    };
    Beads { kept, cut }
}

/// What the walls of the layer `own` leave, on both rasters of skins.
fn room<'a: 'b, 'b>(
    own: &'b Own,
    layers: &impl Fn(usize) -> Option<&'a LayerRows>,
) -> Option<[&'b Rows; 2]> {
    let rows = layers(own.layer.index)?;
    Some([0, 1].map(|r| match &own.whole {
        Some(whole) => &*whole.fill[r],
        None => &*rows.skin(r).fill,
    }))
}

/// The beads of a layer along its innermost walls, where the exposed `skins` are narrow.
fn beads<'a>(
    own: &Own,
    skins: &[Rows; 2],
    layers: &impl Fn(usize) -> Option<&'a LayerRows>,
    params: &RegionParams,
) -> Vec<Polyline> {
    let Some(room) = room(own, layers) else { return Vec::new() };
    let count = params.walls.count;
    // Without walls the ends of lines form the outside of the part, so all skin stays lines.
    if count == 0 || skins.iter().all(Rows::is_empty) {
        return Vec::new();
    }
    // Beside the outer wall of a top there are lines alone.
    let beside_tops;
    let skins = match &own.whole {
        Some(Whole { fill, tops, .. }) => {
            beside_tops = [0, 1].map(|r| skins[r].and(&fill[r]).minus(&tops[r]));
            &beside_tops
        }
        None => skins,
    };
    let (along, across) = skin_turn(own.layer.index);
    let crossed = Crossed {
        skin: &skins[along],
        fill: room[along],
        columns: &skins[across],
        fill_columns: room[across],
        left_turn: along == 0,
    };
    let frame = params.rasters.skin(along).frame;
    let entered = |path: &Contour| -> Contour { path.iter().map(|&p| frame.enter(p)).collect() };
    let walls: Vec<Contour> = match &own.whole {
        Some(whole) => whole.innermost.iter().map(entered).collect(),
        None => {
            let innermost = own.walls.iter().filter(|w| w.closed && w.depth + 1 == count);
            innermost.map(|w| entered(&w.path)).collect()
        }
    };
    let middle = own.walls.iter().filter(|w| w.depth >= count).map(|w| entered(&w.path));
    wall_beads(&walls, &middle.collect::<Vec<_>>(), &crossed, &params.beads)
}
