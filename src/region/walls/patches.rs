//! Beads and layout -> loops in what all beads leave open.
//!
//! Words:
//! - A *doubt* is a place beside which neither a core nor shared loops and middle beads were found.
//! - A *hole* is a circle inside the part, of a radius that a bead has, which no bead and no core touches.
//! - A *patch* is what is open around holes, without what is too thin for a bead.
//!
//! Insets have mitred corners, and beads round ones. Where walls meet at sharp corners that stick into the
//! part, the inset for one more loop or for the core may be empty, though there is room for it. And a
//! small shape that is neither a dot nor has opposite sides has no middle bead.
//!
//! 1. Look for a hole beside each doubt and in the middle behind it; from sharp corners walk into the part.
//!    Most layers have none.
//! 2. Around the holes, take from the part what the beads and the core cover. Patches are left.
//! 3. Fill each patch with loops that share the room of the largest circle in it, as dots are filled.

use super::dots::halved;
use super::{Layout, Wall};
use crate::geom::boxes::Around;
use crate::geom::segment::{along, distance2};
use crate::geom::{Contour, Point, double_area, edges, encloses, polygon};
use crate::region::near::{Area, Near};
use crate::region::sides::{Side, Sides};
use crate::units::{Bounded as _, Coord, nearest, sin_cos};
use std::cell::LazyCell;
use std::f64::consts::PI;

/// A place of the contour in doubt.
#[derive(Debug, Clone, Copy)]
pub(super) struct Doubt {
    pub(super) at: [f64; 2],
    /// The direction in which the part lies.
    pub(super) normal: [f64; 2],
    /// Whether it is a sharp corner that sticks into the part: holes may lie deep behind it.
    pub(super) sharp: bool,
    /// The radius of the circle inside the part that touches this place, if one was looked for.
    pub(super) deep: f64,
}

/// Steps of the walk into the part, in line widths; loops move by at most as much.
const STEP: f64 = 0.25;

/// The radius of the least hole between loops, in line widths. Smaller ones stay open where the round
/// corners and ends of beads meet; a larger value leaves hubs open.
const HOLE: f64 = 0.55;

/// How much of the radius of the narrowest bead has to be free on the outline, for rounding and corners.
const PART: f64 = 0.95;

/// How far around a hole is looked at, in line widths beyond the walls.
const AROUND: f64 = 4.0;

/// A loop of a patch is at most so wide, in line widths. With a smaller value a patch gets a loop and a
/// blot in it.
const WIDEST: f64 = 1.25;

/// Islands of less area than this are looked at as a whole, square grid units (3 mm²): in larger ones
/// samples find a hole.
const SMALL: f64 = 3e8;

/// The round end of a bead has this many sides.
const END: usize = 6;

/// What is cut is simplified within this (2 µm).
const ROUNDING: Coord = 20;

/// The sides of all beads, and the width of the widest: most layers need none.
type Beads<'a> = LazyCell<(Sides, f64), &'a dyn Fn() -> (Sides, f64)>;

/// The loops of all patches. `walls` are all other beads, and the middle ones lie `near`.
pub(super) fn patches(
    doubts: &[Doubt],
    (walls, near): (&[Wall], &Near),
    core: &[Contour],
    layout: &Layout<'_>,
) -> Vec<Wall> {
    if doubts.is_empty() {
        return Vec::new();
    }
    let beads = || {
        let all =
            walls.iter().flat_map(|wall| sides(wall, layout.line_width)).collect::<Vec<Side>>();
        let widest = all.iter().fold(0.0, |widest: f64, (_, width)| widest.at_least(*width));
        (Sides::new(all, 2.0 * layout.line_width), widest)
    };
    let beads = Beads::new(&beads);
    let mut holes = bare(walls, layout);
    holes.extend(doubts.iter().filter_map(|&doubt| hole(doubt, (&beads, near), layout)));
    if holes.is_empty() {
        return Vec::new();
    }
    let open = open(&holes, beads.0.all(), core, layout);
    let depth =
        |p: Point| walls.iter().filter(|w| w.closed && encloses(edges(&w.path), p)).count() as u32;
    let outers = open.iter().filter(|c| double_area(c) > 0);
    let patch = |outer: &Contour| {
        let is_in = |p: &Point| encloses(edges(outer), *p);
        if !holes.iter().any(|&h| is_in(&point(h))) {
            return Vec::new();
        }
        let inside = |c: &&Contour| double_area(c) < 0 && is_in(&c[0]);
        let group: Vec<Contour> =
            std::iter::once(outer).chain(open.iter().filter(inside)).cloned().collect();
        loops(&group, depth(outer[0]), layout)
    };
    outers.flat_map(patch).collect()
}

/// A place in each small island that has no bead and room for one. Its corners leave little room for the
/// circle beside a doubt.
fn bare(walls: &[Wall], layout: &Layout<'_>) -> Vec<[f64; 2]> {
    let is_small = |c: &Contour| (0.0..2.0 * SMALL).contains(&(double_area(c) as f64));
    let islands = || layout.contours.iter().enumerate().filter(|(_, c)| is_small(c));
    if islands().next().is_none() {
        return Vec::new();
    }
    let around = Around::new(islands());
    let mut has_bead = vec![false; layout.contours.len()];
    let starts = walls.iter().filter_map(|wall| wall.path.first());
    starts.flat_map(|&p| around.of(p)).for_each(|k| has_bead[k] = true);
    let narrow = (nearest(layout.params.narrowest / 2.0) as Coord).max(1);
    let place = |(_, island): (usize, &Contour)| {
        let room = polygon::inset(std::slice::from_ref(island), narrow);
        Some(float(*room.first()?.first()?))
    };
    islands().filter(|(k, _)| !has_bead[*k]).filter_map(place).collect()
}

/// The first hole on the way from a doubt into the part.
fn hole(doubt: Doubt, beads: (&Beads<'_>, &Near), layout: &Layout<'_>) -> Option<[f64; 2]> {
    let (w, count) = (layout.line_width, layout.params.count);
    let edge = PART * layout.params.narrowest / 2.0;
    let at = |deep: f64| along(doubt.at, deep, doubt.normal);
    let outmost = at(edge / PART);
    if is_open(outmost, edge, beads, layout) {
        return layout.outline.is_free(outmost, edge).then_some(outmost);
    }
    if !doubt.sharp {
        // Between three sides there is no other one opposite, and the middle may be deep inside.
        let middle = at(doubt.deep);
        let is_hole = doubt.deep > layout.inset(0) + (0.5 + HOLE) * w
            && layout.outline.is_free(middle, PART * doubt.deep)
            && layout.levels[count as usize].is_free([middle], STEP * w)
            && is_open(middle, HOLE * w, beads, layout);
        return is_hole.then_some(middle);
    }
    let (first, step) = (layout.inset(0) + (0.5 + HOLE) * w, STEP * w);
    let steps = (2.0 * layout.inset(count + 1) / step) as usize;
    let places = (0..steps).map(|k| at(first + k as f64 * step));
    let is_inside = |place: &[f64; 2]| {
        layout.outline.is_free(*place, edge)
            && layout.levels[count as usize].is_free([*place], step)
    };
    places.take_while(is_inside).find(|&place| is_open(place, HOLE * w, beads, layout))
}

/// Whether no bead and no core touches a circle around `at`.
fn is_open(
    at: [f64; 2],
    radius: f64,
    (beads, near): (&Beads<'_>, &Near),
    layout: &Layout<'_>,
) -> bool {
    // A quick look, as loops lie without shares, and for beads as narrow as can be.
    let loops = radius + STEP * layout.line_width;
    let narrow = radius + PART * layout.params.narrowest / 2.0;
    let is_clear = |(side, width): &Side| distance2(at, *side).sqrt() > radius + width / 2.0;
    layout.levels.iter().all(|level| level.is_free([at], loops))
        && near.is_free([at], narrow)
        && beads.0.near(at, radius + beads.1 / 2.0).all(is_clear)
}

/// What beads and core leave open around holes, without what is thinner than the narrowest bead.
fn open(holes: &[[f64; 2]], sides: &[Side], core: &[Contour], layout: &Layout<'_>) -> Vec<Contour> {
    let w = layout.line_width;
    let margin = layout.inset(layout.params.count) + AROUND * w;
    let boxes: Vec<Area> =
        holes.iter().map(|&at| Area::around(std::iter::once(at), margin)).collect();
    let rectangle = |area: &Area| {
        let [[x, y], [right, top]] = area.corners();
        [[x, y], [right, y], [right, top], [x, top]].map(point).to_vec()
    };
    let around = polygon::union(&boxes.iter().map(rectangle).collect::<Vec<_>>());
    let part = polygon::intersection(layout.contours, &around);
    let is_near = |(side, _): &&Side| boxes.iter().any(|area| area.meets(side));
    let mut covered: Vec<Contour> = sides.iter().filter(is_near).map(capsule).collect();
    covered = polygon::union(&covered);
    covered.extend(polygon::outset(core, nearest(w / 2.0) as Coord));
    let left = polygon::difference(&part, &polygon::union(&covered), ROUNDING);
    let by = nearest(PART * layout.params.narrowest / 2.0) as Coord;
    // Pointed corners stay in part: their plastic goes where a bead has room.
    polygon::intersection(&left, &polygon::outset(&polygon::inset(&left, by.max(1)), 2 * by.max(1)))
}

/// The loops in a patch: an outer contour and its holes.
fn loops(patch: &[Contour], depth: u32, layout: &Layout<'_>) -> Vec<Wall> {
    let area = patch.iter().map(|c| double_area(c) as f64 / 2.0).sum::<f64>();
    let inset = |distance: f64| polygon::inset(patch, (nearest(distance) as Coord).max(1));
    let widest = (area.max(0.0) / PI).sqrt();
    let [half, _] = halved([0.0, widest], |radius| !inset(radius).is_empty());
    let narrowest = layout.params.narrowest;
    let count = (half / (WIDEST * layout.line_width)).ceil().min(half / narrowest).floor().max(1.0);
    let even = half / count;
    let depths = 0..count as u32;
    let mut paths: Vec<(u32, Contour)> = depths
        .flat_map(|k| inset((f64::from(k) + 0.5) * even).into_iter().map(move |path| (k, path)))
        .collect();
    let whole: f64 = paths.iter().map(|(_, path)| length(path)).sum();
    // As much plastic as there is room.
    let width = (area / whole.max(1.0)).max(narrowest).min(even.max(narrowest));
    if count == 1.0 && whole * width > area {
        // Deeper, where it is shorter.
        let shorter = |k: u32| (f64::from(k) / 100.0 + 0.5) * half;
        let fits = |d: f64| inset(d).iter().map(length).sum::<f64>() * width <= area;
        if let Some(deeper) = (0..48).map(shorter).find(|&d| fits(d)) {
            paths = inset(deeper).into_iter().map(|path| (0, path)).collect();
        }
    }
    // A wall, and no infill: that would have to be carried by others.
    let most = layout.params.count.saturating_sub(1).max(1);
    let wall = |(k, path): (u32, Contour)| Wall {
        widths: vec![nearest(width) as Coord; path.len()],
        ..Wall::closed(path, (depth + k).min(most))
    };
    paths.into_iter().map(wall).collect()
}

fn length(path: &Contour) -> f64 {
    edges(path).map(|(p, q)| p.distance(q)).sum()
}

/// The sides of a bead.
fn sides(wall: &Wall, line_width: f64) -> impl Iterator<Item = Side> + use<'_> {
    let width = move |k: usize| wall.widths.get(k).map_or(line_width, |&w| f64::from(w));
    let on = wall.path.windows(2).enumerate();
    let on = on.map(move |(k, p)| ([float(p[0]), float(p[1])], width(k + 1)));
    let ends = wall.path.last().zip(wall.path.first()).filter(|_| wall.closed);
    on.chain(ends.map(move |(&p, &q)| ([float(p), float(q)], width(0))))
}

/// What a side of a bead covers, with its round ends.
fn capsule(&([from, to], width): &Side) -> Contour {
    let ahead = libm::atan2(to[1] - from[1], to[0] - from[0]).to_degrees();
    let end = |at: [f64; 2], start: f64| {
        (0..=END).map(move |k| {
            let (sin, cos) = sin_cos(start + 180.0 * k as f64 / END as f64);
            point([at[0] + cos * width / 2.0, at[1] + sin * width / 2.0])
        })
    };
    end(to, ahead - 90.0).chain(end(from, ahead + 90.0)).collect()
}

fn float(p: Point) -> [f64; 2] {
    [f64::from(p.x), f64::from(p.y)]
}

fn point([x, y]: [f64; 2]) -> Point {
    Point { x: nearest(x) as Coord, y: nearest(y) as Coord }
}
