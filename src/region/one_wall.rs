//! Layer and the one above -> Opened: tops with the outer wall alone, and the room that the others leave.
//!
//! Words: a *top* is a place that the layer above leaves bare, and that is wide. An inner wall is *cut*
//! where it enters a top; what is left of it are its *arcs*. The *freed* room is where cut walls would lie.
//!
//! The visible surface is then skin all over. Walls stay where the layer above covers this one: there they
//! carry its walls. They stay where a top is narrow, too: on a slope every layer has one, and all of the
//! part's walls would be gone.
//!
//! Algorithm:
//! 1. On both rasters of skins, a top is what the layer above does not cover within reach of a place so
//!    deep in it that a wide disc has room (`tops`). Where walls share the room of a thin place, there is
//!    none: they are no loops side by side.
//! 2. Each inner wall is followed in short steps. Those that lie in a top on both rasters are cut out.
//!    Short arcs go with them, and short cuts are none.
//! 3. Skin and infill get the freed room: what is inside the outer wall, near the walls that were cut, less
//!    what the arcs take. Lines reach into arcs as they do into walls.

use super::params::{OneWall, RegionParams};
use super::prepare::{LayerRows, Own, PreparedRows, Whole};
use super::scan::{Scan, around_in_part};
use super::walls::Wall;
use crate::geom::Point;
use crate::geom::raster::Raster;
use crate::geom::spans::Rows;
use crate::units::{Coord, nearest};
use std::sync::Arc;

/// Arcs shorter than this many line widths are cut as well, and shorter cuts are none: they would be
/// starts and stops with nothing between.
const LEAST_ARC: f64 = 5.0;

/// Steps by which walls are followed, for each line width.
const STEPS: f64 = 4.0;

/// How far around thin places walls stay, in line widths.
const BESIDE_THIN: Coord = 3;

/// What the tops of a layer change.
#[derive(Debug)]
pub struct Opened {
    /// All its walls; arcs are open.
    walls: Vec<Wall>,
    /// Edges of the walls that were cut, with the radius of what they free.
    freed: Vec<Edge>,
    /// Edges of the inner walls that stay, with the radius of what they take.
    kept: Vec<Edge>,
    whole: Whole,
}

/// The ends of an edge, and a distance around it.
type Edge = (Point, Point, Coord);

/// What the tops of the layer `own` change; `None` if it has none that is wide. `above` are the rows of
/// the next layer, if there is one.
#[must_use]
pub fn open(
    own: &Own,
    rows: &LayerRows,
    above: Option<&LayerRows>,
    params: &RegionParams,
) -> Option<Opened> {
    let one = params.one_wall?;
    let leaves_bare = |r: usize| {
        let Some(above) = above else { return true };
        let bare = rows.skin(r).cover.minus(&above.skin(r).cover);
        !bare.filter(|_, span| span.len() >= i64::from(one.wide)).is_empty()
    };
    if !(leaves_bare(0) && leaves_bare(1)) {
        return None;
    }
    let rasters = [0, 1].map(|r| params.rasters.skin(r));
    let tops = [0, 1].map(|r| {
        let scan = Scan::new(&own.layer.contours, rasters[r]);
        let tops = tops(&scan, above.map(|above| &above.skin(r).cover), rasters[r], one);
        tops.minus(&thin(&own.walls, rasters[r], params))
    });
    if tops.iter().any(Rows::is_empty) {
        return None;
    }
    let w = params.walls.line_width;
    let is_top = |p: Point| (0..2).all(|r| holds(&tops[r], rasters[r], p));
    let (mut walls, mut freed, mut kept) = (Vec::new(), Vec::new(), Vec::new());
    for wall in &own.walls {
        if wall.depth == 0 || !wall.closed {
            walls.push(wall.clone());
            continue;
        }
        let Cut { arcs, out } = cut(wall, w, is_top);
        freed.extend(out.into_iter().map(|(p, q)| (p, q, w)));
        walls.extend(arcs);
    }
    if freed.is_empty() {
        return None;
    }
    for wall in walls.iter().filter(|wall| wall.depth > 0) {
        let more = w / 2 - params.beads.overlap;
        kept.extend(edges(wall, w).map(|(p, q, width)| (p, q, (width / 2 + more).max(0))));
    }
    let innermost = own.walls.iter().filter(|wall| wall.closed && wall.depth + 1 == one.count);
    let whole = Whole {
        innermost: innermost.map(|wall| wall.path.clone()).collect(),
        fill: [0, 1].map(|r| rows.skin(r).fill.clone()),
        tops,
    };
    Some(Opened { walls, freed, kept, whole })
}

impl Opened {
    /// The layer `own` and its `rows` with these changes.
    #[must_use]
    pub fn apply(self, own: Own, rows: LayerRows, params: &RegionParams) -> (Own, LayerRows) {
        let Self { walls, freed, kept, whole } = self;
        let Some(one) = params.one_wall else { return (own, rows) };
        let rows = rows.map_on(|raster, PreparedRows { fill, cover }| {
            let near = |all: &[Edge]| around_in_part(all.iter().copied(), raster);
            let room = Scan::new(&own.layer.contours, raster).inset(one.fill);
            let freed = room.and(&near(&freed)).minus(&near(&kept));
            PreparedRows { fill: Arc::new(fill.or(&freed)), cover }
        });
        (Own { walls, whole: Some(whole), ..own }, rows)
    }
}

/// The tops of a layer on `raster`; `cover` is the layer above on the same.
fn tops(scan: &Scan, cover: Option<&Rows>, raster: Raster, one: OneWall) -> Rows {
    let room = scan.inset(one.outer);
    // As deep as a disc that just fits a wide top.
    let deep = scan.inset(one.wide / 2);
    let Some(cover) = cover else {
        return room.and(&deep.dilate(one.wide, raster.pitch));
    };
    let hidden = room.and(cover);
    let deep = deep.minus(&hidden.dilate(one.wide / 2, raster.pitch));
    if deep.is_empty() {
        return deep;
    }
    room.minus(cover).and(&deep.dilate(one.wide, raster.pitch))
}

/// Where walls share the room of thin places, on `raster`.
fn thin(walls: &[Wall], raster: Raster, params: &RegionParams) -> Rows {
    let w = params.walls.line_width;
    let shared = walls.iter().filter(|wall| !wall.widths.is_empty() || !wall.closed);
    let edges = shared
        .flat_map(|wall| edges(wall, w).filter(|(.., width)| !wall.closed || *width != w))
        .map(|(p, q, _)| (p, q, BESIDE_THIN * w));
    around_in_part(edges, raster)
}

/// The edges of a wall with the width of each.
fn edges(wall: &Wall, line_width: Coord) -> impl Iterator<Item = Edge> {
    let (n, path) = (wall.path.len(), &wall.path);
    (usize::from(!wall.closed)..n).map(move |k| {
        let width = wall.widths.get(k).copied().unwrap_or(line_width);
        (path[(k + n - 1) % n], path[k], width)
    })
}

/// Whether a row near `p` holds it.
fn holds(rows: &Rows, raster: Raster, p: Point) -> bool {
    let Point { x: u, y: v } = raster.frame.enter(p);
    let row = (v + raster.pitch / 2).div_euclid(raster.pitch);
    rows.span_at(row, u).is_some()
}

/// A wall without what lies in tops.
struct Cut {
    arcs: Vec<Wall>,
    /// The edges that were cut out.
    out: Vec<(Point, Point)>,
}

/// A short step along a wall.
#[derive(Clone, Copy)]
struct Step {
    from: Point,
    to: Point,
    width: Option<Coord>,
    /// Its edge.
    edge: usize,
    in_top: bool,
}

/// Cuts a loop where it lies in tops.
fn cut(wall: &Wall, line_width: Coord, is_top: impl Fn(Point) -> bool) -> Cut {
    let mut steps = steps(wall, f64::from(line_width) / STEPS, is_top);
    let least = LEAST_ARC * f64::from(line_width);
    // First cuts that are none, then arcs that are none.
    for in_top in [true, false] {
        drop_short(&mut steps, in_top, least);
    }
    let Some(first) = steps.iter().position(|step| step.in_top) else {
        return Cut { arcs: vec![wall.clone()], out: Vec::new() };
    };
    // It begins in a top, so that no arc goes over the end of the list.
    steps.rotate_left(first);
    let out = steps.iter().filter(|step| step.in_top).map(|step| (step.from, step.to)).collect();
    let runs = steps.chunk_by(|a, b| a.in_top == b.in_top);
    let arcs = runs.filter(|run| !run[0].in_top).map(|run| arc(run, wall)).collect();
    Cut { arcs, out }
}

/// Steps along a loop, none longer than `most`.
fn steps(wall: &Wall, most: f64, is_top: impl Fn(Point) -> bool) -> Vec<Step> {
    let mut steps = Vec::new();
    for (edge, (p, q, _)) in edges(wall, 0).enumerate() {
        let width = wall.widths.get(edge).copied();
        let count = (p.distance(q) / most).ceil().max(1.0) as i64;
        let on = |a: Coord, b: Coord, k: i64| {
            nearest(f64::from(a) + f64::from(b - a) * k as f64 / count as f64) as Coord
        };
        let at = |k: i64| Point { x: on(p.x, q.x, k), y: on(p.y, q.y, k) };
        steps.extend((0..count).map(|k| {
            let (from, to) = (at(k), at(k + 1));
            let middle = Point { x: (from.x + to.x) / 2, y: (from.y + to.y) / 2 };
            Step { from, to, width, edge, in_top: is_top(middle) }
        }));
    }
    steps
}

/// Turns runs of steps that are shorter than `least`, and do or do not lie in tops, to the other side.
fn drop_short(steps: &mut [Step], in_top: bool, least: f64) {
    // A run is not divided by the beginning of the loop.
    let Some(first) = steps.iter().position(|step| step.in_top != in_top) else { return };
    steps.rotate_left(first);
    for run in steps.chunk_by_mut(|a, b| a.in_top == b.in_top) {
        let length: f64 = run.iter().map(|step| step.from.distance(step.to)).sum();
        if run[0].in_top == in_top && length < least {
            run.iter_mut().for_each(|step| step.in_top = !in_top);
        }
    }
}

/// A run of steps as a wall with two ends.
fn arc(run: &[Step], wall: &Wall) -> Wall {
    let (mut path, mut widths) = (vec![run[0].from], Vec::new());
    widths.extend(run[0].width);
    for edge in run.chunk_by(|a, b| a.edge == b.edge) {
        path.push(edge[edge.len() - 1].to);
        widths.extend(edge[0].width);
    }
    Wall { path, widths, closed: false, ..wall.clone() }
}

#[cfg(test)]
mod tests {
    use super::*;

    const W: Coord = 4_000;

    /// A square loop, 40 mm around.
    fn square() -> Wall {
        let path = [(0, 0), (100_000, 0), (100_000, 100_000), (0, 100_000)];
        let path = path.map(|(x, y)| Point { x, y }).to_vec();
        Wall { path, widths: Vec::new(), closed: true, depth: 1, layers: 1 }
    }

    fn length(wall: &Wall) -> f64 {
        wall.path.windows(2).map(|w| w[0].distance(w[1])).sum()
    }

    #[test]
    fn a_wall_is_cut_where_it_enters_a_top_whatever_its_first_point() {
        for turn in 0..4 {
            let mut wall = square();
            wall.path.rotate_left(turn);
            let Cut { arcs, out } = cut(&wall, W, |p| p.x > 50_000);
            assert_eq!(arcs.len(), 1, "{arcs:?}");
            assert!(!arcs[0].closed && arcs[0].path.len() == 4, "{arcs:?}");
            assert!((length(&arcs[0]) - 200_000.0).abs() < 2_000.0);
            let freed: f64 = out.iter().map(|(p, q)| p.distance(*q)).sum();
            assert!((freed + length(&arcs[0]) - 400_000.0).abs() < 10.0);
        }
    }

    #[test]
    fn short_arcs_go_and_short_cuts_are_none() {
        let whole = cut(&square(), W, |p| p.y == 0 && (40_000..55_000).contains(&p.x));
        assert_eq!((whole.arcs, whole.out.len()), (vec![square()], 0));
        let none = cut(&square(), W, |p| !(p.y == 0 && (40_000..55_000).contains(&p.x)));
        assert!(none.arcs.is_empty());
    }

    #[test]
    fn an_arc_keeps_the_widths_of_its_edges() {
        let wall = Wall { widths: vec![1, 2, 3, 4], ..square() };
        let Cut { arcs, .. } = cut(&wall, W, |p| p.x > 50_000);
        assert_eq!(arcs[0].widths, [4, 4, 1, 2], "{arcs:?}");
        assert_eq!(arcs[0].path.len(), arcs[0].widths.len());
    }
}
