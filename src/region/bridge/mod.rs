//! Layer + the one below -> bridges: skin over nothing, with lines that run from hold to hold.
//!
//! Words: a place is *open* if the layer below does not cover it. A *bridge* is an island of open
//! skin with a line so long that it would sag. The *carrier* is what is printed below beside it.
//! The *anchor* is the stretch of a line that lies on the carrier.
//!
//! Algorithm, for each layer:
//! 1. Find the open places on the raster of the layer's skin. On most layers there are none, or
//!    only short ones along walls: then this is all.
//! 2. Divide them into islands. For each bridge choose the direction of its lines ([`direction`]), of which the
//!    sides beside it are the first to be tried ([`sides`]). Those on both sides of a thin carrier agree on one
//!    ([`shared`]).
//! 3. For each direction, scan the contours of both layers with a raster of that direction, and
//!    find the open places of its bridges again: exactly, at the lines' own ends.
//! 4. Lengthen each line by the anchor at both ends, and add a line on both sides.
//!
//! The lines of a bridge take their place from the layer's skin and infill, like wall beads. Beads that would hang
//! where a bridge holds are left out before ([`ledges`]).

pub mod direction;
pub mod ledges;
pub mod loose;
pub mod shared;
pub mod sides;
#[cfg(test)]
mod tests;

use super::params::RegionParams;
use super::per_raster::skin_turn;
use super::prepare::{self, LayerRows, Own};
use super::scan::{Scan, around_in_part};
use super::wall_beads;
use super::{Skin, SkinRows};
use crate::geom::frame::Frame;
use crate::geom::islands::Islands;
use crate::geom::polyline::Polyline;
use crate::geom::raster::{Raster, crossed};
use crate::geom::spans::{Rows, Span, merge};
use crate::geom::{Contour, Point};
use crate::slice::Layer;
use crate::units::{Coord, nearest};
use direction::{Direction, Site};
use sides::{COUNT, STEP, Sides};
use std::collections::BTreeSet;
use std::sync::Arc;

/// Shorter open spans are dropped as noise of the contours (50 µm), as `LEAST_SKIN` in `classify`.
const LEAST_OPEN: Coord = 500;

/// An island is a bridge if one of its lines is free for longer than this (2 mm). Shorter lines hold
/// in any direction. A larger value leaves lines that sag; a smaller one makes bridges, with their
/// slow lines, of every flat slope.
const MOST_FREE: Coord = 20_000;

/// Most directions of the bridges of one layer: each is scanned anew. A larger number costs time where a plate has
/// hundreds of slots at all angles.
const MOST_TURNS: usize = 24;

/// The steps to which directions are brought where there are more: of 0.1, 0.3, 1.5 and 7.5°.
const STEPS: [usize; 4] = [1, 3, 15, 75];

/// A layer and the one below, with what is known of them.
#[derive(Debug, Clone, Copy)]
pub struct Pair<'a> {
    /// The layer.
    pub own: &'a Own,
    /// The layer below.
    pub below: &'a Layer,
    /// Its wall beads, in the frame of its skin's raster. No bridge takes their place.
    pub beads: &'a [Polyline],
}

/// The bridges of the upper layer of a pair, which is `open` there.
#[must_use]
pub fn bridges(pair: Pair<'_>, open: Open<'_>, params: &RegionParams) -> Vec<Skin> {
    let sags = |open: &Open<'_>| open.rows.iter().any(|(_, row)| row.iter().any(is_long));
    // On most layers nothing is open for long, and beads need not be looked at.
    let open = Some(open).filter(sags).map(|open| open.beside(pair, params)).filter(sags);
    let (Some(anchor), Some(open)) = (params.bridges.anchor, open) else { return Vec::new() };
    let islands = Islands::new(&open.rows);
    let long = islands.any(|_, span| is_long(&span));
    let mut found = open.directions(pair, &islands, |island| long[island], params);
    shared::agree(&mut found, &islands, &open, anchor, params);
    keep_few(&mut found);
    let each: BTreeSet<usize> = found.iter().flatten().map(|found| found.turn).collect();
    let along = skin_turn(pair.own.layer.index).0;
    let mut out = Vec::new();
    for turn in each {
        let is_open = |island: usize| found[island].is_some_and(|found| found.turn == turn);
        let holds = Holds { islands: &islands, raster: open.raster, is_open };
        let degrees = params.bridges.angle + 90.0 * along as f64 + STEP * turn as f64;
        out.push(lay(pair, degrees, anchor, &holds, &out, params));
    }
    out
}

/// The open places of a layer, on the raster of its skin.
#[derive(Debug)]
pub struct Open<'a> {
    raster: Raster,
    rows: Rows,
    /// What the layer below covers.
    carrier: &'a Rows,
}

impl<'a> Open<'a> {
    /// Those of layer `k`; `None` if it is the lowest, or nothing is bridged. `layers(k)` is `None` outside the part.
    #[must_use]
    pub fn new(
        k: usize,
        layers: &impl Fn(usize) -> Option<&'a LayerRows>,
        params: &RegionParams,
    ) -> Option<Self> {
        if params.bridges.anchor.is_none() || params.skins.bottom == 0 {
            return None;
        }
        let raster = params.rasters.skin(skin_turn(k).0);
        let rows = |k: usize| layers(k)?.on(raster);
        let (here, below) = (rows(k)?, rows(k.checked_sub(1)?)?);
        Some(Self { raster, rows: noticed(&here.fill.minus(&below.cover)), carrier: &below.cover })
    }

    /// What the beads of `pair` leave of them.
    fn beside(self, pair: Pair<'_>, params: &RegionParams) -> Self {
        if pair.beads.is_empty() {
            return self;
        }
        Self { rows: noticed(&self.rows.minus(&pair.taken(self.raster, params))), ..self }
    }

    fn site<'b>(&'b self, island: usize, islands: &'b Islands<'b>) -> Site<'b> {
        Site { island, islands, carrier: self.carrier, pitch: self.raster.pitch }
    }

    /// The direction of each of the `islands` in which something `sags`.
    fn directions(
        &self,
        pair: Pair<'_>,
        islands: &Islands<'_>,
        sags: impl Fn(usize) -> bool,
        params: &RegionParams,
    ) -> Vec<Option<Direction>> {
        let sides = Sides::new(pair.contours(), self.raster.frame);
        let direction = |island: usize| {
            let best = || direction::best(&self.site(island, islands), params.insets.fill, &sides);
            sags(island).then(best)
        };
        (0..islands.count()).map(direction).collect()
    }
}

/// `rows` without what is noise.
fn noticed(rows: &Rows) -> Rows {
    rows.filter(|_, span| span.len() >= i64::from(LEAST_OPEN))
}

/// Brings many different directions to fewer, by steps that grow until there are at most [`MOST_TURNS`].
fn keep_few(found: &mut [Option<Direction>]) {
    let snapped = |turn: usize, step: usize| (turn + step / 2) / step * step % COUNT;
    let count = |step: usize| {
        let turns = found.iter().flatten().map(|found| snapped(found.turn, step));
        turns.collect::<BTreeSet<usize>>().len()
    };
    let step = STEPS.into_iter().find(|step| count(*step) <= MOST_TURNS).unwrap_or(STEPS[3]);
    found.iter_mut().flatten().for_each(|found| found.turn = snapped(found.turn, step));
}

fn is_long(span: &Span) -> bool {
    span.len() > i64::from(MOST_FREE)
}

/// What the lines of `bridges` take of a layer, on `raster`: no other line may end in it.
#[must_use]
pub fn taken(bridges: &[Skin], raster: Raster, params: &RegionParams) -> Rows {
    // As a wall bead: a line that ends there reaches into it as into a wall.
    let more = (params.beads.line_width / 2 - params.beads.overlap).max(0);
    let mut edges = Vec::new();
    for bridge in bridges {
        let Raster { frame, pitch } = bridge.raster;
        let at = |u: Coord, v: Coord| frame.leave(Point { x: u, y: v });
        for (j, row) in bridge.rows.skin.iter() {
            let end = |u: Coord| at(u, j * pitch);
            edges.extend(row.iter().map(|s| (end(s.start), end(s.end), pitch / 2 + more)));
        }
        if params.walls.count > 0 {
            for ((u, low), (_, high)) in strips(bridge) {
                edges.push((at(u, low), at(u, high), pitch / 2));
            }
        }
    }
    around_in_part(edges.into_iter(), raster)
}

/// The strips beside the last lines of a bridge, which are widened up to the walls: column by column,
/// in the frame of its rows.
fn strips(bridge: &Skin) -> Vec<((Coord, Coord), (Coord, Coord))> {
    let pitch = bridge.raster.pitch;
    let mut out = Vec::new();
    for (c, row) in bridge.columns.skin.iter() {
        let walls = bridge.columns.fill.row(c);
        // Bridges have their columns turned left.
        let u = -c * pitch;
        for s in row {
            if walls.iter().any(|wall| wall.start == s.start) {
                out.push(((u, s.start), (u, s.end.min(s.start + pitch))));
            }
            if walls.iter().any(|wall| wall.end == s.end) {
                out.push(((u, s.start.max(s.end - pitch)), (u, s.end)));
            }
        }
    }
    out
}

impl Pair<'_> {
    fn contours(&self) -> impl Iterator<Item = &Contour> {
        self.own.layer.contours.iter().chain(&self.below.contours)
    }

    /// What the wall beads take, on `raster`.
    fn taken(&self, raster: Raster, params: &RegionParams) -> Rows {
        let along = params.rasters.skin(skin_turn(self.own.layer.index).0);
        wall_beads::taken(self.beads, along.frame, raster, &params.beads)
    }
}

/// The islands that are laid in one direction.
struct Holds<'a, F> {
    islands: &'a Islands<'a>,
    raster: Raster,
    is_open: F,
}

impl<F: Fn(usize) -> bool> Holds<'_, F> {
    /// Whether `span` of row `j` of `raster` is part of one of the islands. It is part of one island
    /// at most, but their rows may miss its first places.
    fn holds(&self, raster: Raster, j: i32, span: Span) -> bool {
        let at = |u: Coord| {
            let p = raster.frame.leave(Point { x: u, y: j * raster.pitch });
            let p = self.raster.frame.enter(p);
            let row = nearest(f64::from(p.y) / f64::from(self.raster.pitch)) as i32;
            [row, row + 1, row - 1].into_iter().find_map(|j| self.islands.at(j, p.x))
        };
        let places = (span.start..=span.end).step_by(self.raster.pitch.max(2) as usize / 2);
        places.filter_map(at).next().is_some_and(&self.is_open)
    }
}

/// The bridges of one direction as skin. `others` are bridges that are laid already.
fn lay(
    pair: Pair<'_>,
    degrees: f64,
    anchor: Coord,
    holds: &Holds<'_, impl Fn(usize) -> bool>,
    others: &[Skin],
    params: &RegionParams,
) -> Skin {
    let pitch = params.bridges.pitch;
    // The open places are grown by a line on all sides: its row is as far away as the rows lie apart.
    let aside = pitch.max(params.skins.line_width);
    let rasters = [0.0, 90.0].map(|turn| Raster { frame: Frame::new(degrees + turn), pitch });
    let [(fill, open), (fill_across, open_across)] = rasters.map(|raster| {
        let scan = Scan::new(&pair.own.layer.contours, raster);
        let mut fill =
            prepare::fill(&scan, pair.own.core.as_deref(), &pair.own.mitres, raster, params);
        let cover = Scan::new(&pair.below.contours, raster).inset(params.insets.cover);
        if !pair.beads.is_empty() {
            fill = fill.minus(&pair.taken(raster, params));
        }
        if !others.is_empty() {
            fill = fill.minus(&taken(others, raster, params));
        }
        let keep = |j, s: Span| s.len() >= i64::from(LEAST_OPEN) && holds.holds(raster, j, s);
        let open = fill.minus(&cover).filter(keep).dilate(aside, pitch);
        (fill, open)
    });
    let more = (anchor - aside).max(0);
    let skin = lengthened(&open, more).and(&fill);
    // A line never jumps over a hole to reach its anchor.
    let skin = skin.filter(|j, span| open.overlapping(j, span).is_some());
    let columns = widened(&open_across, (more + pitch / 2) / pitch).and(&fill_across);
    // A place between two rows has no line, and takes none from others.
    let has_line = |c: i32, span: Span| {
        crossed(span.start, span.end, pitch).any(|j| skin.span_at(j, -c * pitch).is_some())
    };
    let columns = columns.filter(|c, span| span.len() >= i64::from(pitch) && has_line(c, span));
    Skin {
        layers: 1,
        raster: rasters[0],
        rows: SkinRows { skin: Arc::new(skin), fill: Arc::new(fill) },
        columns: SkinRows { skin: Arc::new(columns), fill: Arc::new(fill_across) },
        left_turn: true,
        beads: Vec::new(),
        room_beads: Vec::new(),
        bridges: true,
        top: false,
    }
}

/// `rows` with each span longer by `by` at both ends.
fn lengthened(rows: &Rows, by: Coord) -> Rows {
    let mut out = Rows::with_room_of(rows, rows.range().start);
    for (_, row) in rows.iter() {
        let longer = |s: &Span| Span { start: s.start - by, end: s.end + by };
        let mut spans: Vec<Span> = row.iter().map(longer).collect();
        out.push_row(|out| merge(&mut spans, out));
    }
    out
}

/// `rows` united with the `by` rows before and after each.
fn widened(rows: &Rows, by: i32) -> Rows {
    let range = rows.range();
    let mut out = Rows::starting_at(range.start - by);
    if range.is_empty() {
        return out;
    }
    let mut spans = Vec::new();
    for j in range.start - by..range.end + by {
        spans.clear();
        (j - by..=j + by).for_each(|j| spans.extend_from_slice(rows.row(j)));
        out.push_row(|out| merge(&mut spans, out));
    }
    out
}
