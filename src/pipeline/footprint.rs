//! Region + paths -> Footprint: the islands of a layer that are printed, and which of two layers touch.
//!
//! An *island* is one outer contour with its holes and the paths inside it. It is *printed* if there
//! are any. Two islands of successive layers *touch* if they share an area: to meet along an edge, or
//! to lie in a hole of the other, is not enough. Where no skin closes the layer below, an island also
//! has to lie on beads of it.
//!
//! Most islands are found to touch by a place near a corner. The contours are only subtracted from each
//! other where no such place is in both.

use crate::fill::Path;
use crate::geom::boxes::Boxes;
use crate::geom::segment::distance2;
use crate::geom::{Contour, Point, double_area, edges, encloses, polygon};
use crate::profile::{DualMode, Settings};
use crate::region::Region;
use crate::units::{Coord, UNITS_PER_MM, nearest};
use std::collections::HashSet;

/// Corners of an island that are tried. More find smaller overlaps without subtracting contours.
const CORNERS: usize = 24;

/// Places this far (0.05 mm) inside the corners are tried, not the corners: those lie on the edges of
/// whatever stands straight above or below, and on those of a neighbour.
const INSIDE: f64 = 500.0;

/// Overlaps narrower than twice this (0.02 mm) are none: rounding and simplified curves leave slivers
/// where contours only meet.
const SLIVER: Coord = 100;

/// Side of the squares by which beads are found again, grid units (0.2 mm, half a usual line): beads in
/// neighbouring squares touch.
const SQUARE: Coord = 2_000;

/// What footprints are judged by.
#[derive(Debug, Clone, Copy)]
pub struct Rules {
    /// Narrower places are not printed, grid units.
    least_room: f64,
    /// Islands lie on the beads below, not on the area: without skin most of that is open.
    by_beads: bool,
}

impl Rules {
    /// The rules that `settings` mean.
    #[must_use]
    pub fn new(settings: &Settings) -> Self {
        // Thick infill lies on other layers than it fills, so that the beads of one do not tell.
        let by_beads = !settings.has_top_skins() && settings.dual.mode == DualMode::Off;
        Self { least_room: settings.min_feature * UNITS_PER_MM, by_beads }
    }
}

/// What a layer prints, as far as the layers around it need to know.
#[derive(Debug, Default)]
pub struct Footprint {
    /// The printed islands.
    pub islands: Vec<Island>,
    /// How many layers its paths are printed for, at most; 0 without paths.
    pub layers: u32,
    /// The boxes around the islands.
    boxes: Boxes,
    /// The squares in which beads of all islands lie, if beads are what counts.
    beads: HashSet<[Coord; 2]>,
}

impl Footprint {
    /// The islands whose boxes share a place with that of another one, in their order.
    pub fn around(&self, other: &Island) -> impl Iterator<Item = &Island> {
        self.boxes.meeting((other.low, other.high)).into_iter().map(|k| &self.islands[k])
    }

    /// Whether an island lies around a place, or as near to it as `reach`, grid units.
    #[must_use]
    pub fn is_near(&self, place: Point, reach: f64) -> bool {
        let by = reach.ceil() as Coord;
        let moved = |by: Coord| Point { x: place.x + by, y: place.y + by };
        let near = |k: usize| self.islands[k].is_near(place, reach);
        self.boxes.meeting((moved(-by), moved(by))).into_iter().any(near)
    }
}

/// A printed island.
#[derive(Debug)]
pub struct Island {
    /// Its outer contour, then its holes.
    contours: Vec<Contour>,
    low: Point,
    high: Point,
    /// Length of its paths, grid units.
    pub length: f64,
    /// Its number; islands count through all layers.
    pub number: usize,
    /// The squares in which its beads lie, if beads are what counts.
    beads: HashSet<[Coord; 2]>,
}

/// The footprint of a layer with these `paths`.
#[must_use]
pub fn footprint(region: &Region, paths: &[Path], rules: Rules) -> Footprint {
    let mut islands = match apart(region, rules.least_room) {
        Some(contours) => islands(&contours),
        None => islands(&region.layer.contours),
    };
    let boxes = boxes_of(&islands);
    let mut beads = HashSet::new();
    for path in paths.iter().filter(|path| path.role.facts().order.is_of_part()) {
        let at = path.start();
        let holds = |k: &usize| islands.len() == 1 || islands[*k].encloses(at);
        // An only island may be missed by rounding.
        let alone = if islands.len() == 1 { Some(0) } else { None };
        let all = boxes.around(at).filter(|_| alone.is_none()).chain(alone).filter(holds);
        // Of nested contours the one with the smallest box is the path's own.
        if let Some(k) = all.min_by_key(|&k| (islands[k].size(), k)) {
            let steps = path.points.windows(2).map(|p| p[0].at.distance(p[1].at));
            islands[k].length += steps.sum::<f64>();
            if rules.by_beads {
                islands[k].beads.extend(squares(path));
                beads.extend(squares(path));
            }
        }
    }
    islands.retain(|island| island.length > 0.0);
    let boxes = boxes_of(&islands);
    let layers = paths.iter().map(|path| path.layers).max().unwrap_or(0);
    Footprint { islands, layers, boxes, beads }
}

fn boxes_of(islands: &[Island]) -> Boxes {
    Boxes::new(islands.iter().map(|island| (island.low, island.high)).collect())
}

/// The squares along a path.
fn squares(path: &Path) -> impl Iterator<Item = [Coord; 2]> {
    path.points.windows(2).flat_map(|ends| {
        let [from, to] = [ends[0].at, ends[1].at];
        let count = (from.distance(to) / f64::from(SQUARE)).ceil().max(1.0);
        (0..=count as u32).map(move |k| {
            let part = f64::from(k) / count;
            let at = |a: Coord, b: Coord| f64::from(a) + part * (f64::from(b) - f64::from(a));
            [at(from.x, to.x), at(from.y, to.y)].map(|at| (at / f64::from(SQUARE)).floor() as Coord)
        })
    })
}

/// The contours without necks too thin to be printed, if walls tell that there are such: one
/// contour then has outer walls apart from each other.
fn apart(region: &Region, least: f64) -> Option<Vec<Contour>> {
    let contours = &region.layer.contours;
    let outer = contours.iter().filter(|c| double_area(c) > 0).count();
    let walls = region.walls.iter().filter(|wall| wall.depth == 0);
    let walls = walls.filter(|wall| !wall.closed || double_area(&wall.path) > 0).count();
    let half = nearest(least / 2.0) as Coord - 1;
    (walls > outer && half > 0).then(|| polygon::outset(&polygon::inset(contours, half), half))
}

/// The islands of some contours, nothing of them printed yet.
fn islands(contours: &[Contour]) -> Vec<Island> {
    let (outer, holes): (Vec<&Contour>, Vec<&Contour>) =
        contours.iter().partition(|c| double_area(c) > 0);
    let mut islands: Vec<Island> = outer.into_iter().map(|c| Island::new(c.clone())).collect();
    let boxes = boxes_of(&islands);
    for hole in holes {
        let around = boxes.around(hole[0]).filter(|&k| islands[k].encloses(hole[0]));
        if let Some(own) = around.min_by_key(|&k| (islands[k].size(), k)) {
            islands[own].contours.push(hole.clone());
        }
    }
    islands
}

impl Island {
    fn new(outer: Contour) -> Self {
        let xs = || outer.iter().map(|p| p.x);
        let ys = || outer.iter().map(|p| p.y);
        let bound = |x: Option<Coord>, y: Option<Coord>| Point {
            x: x.unwrap_or_default(),
            y: y.unwrap_or_default(),
        };
        let (low, high) = (bound(xs().min(), ys().min()), bound(xs().max(), ys().max()));
        Self { contours: vec![outer], low, high, length: 0.0, number: 0, beads: HashSet::new() }
    }

    /// The squared diagonal of its box.
    fn size(&self) -> i64 {
        self.low.distance2(self.high)
    }

    /// Its outer contour, then its holes.
    #[must_use]
    pub fn contours(&self) -> &[Contour] {
        &self.contours
    }

    /// Its outer contour.
    #[must_use]
    pub fn outer(&self) -> &[Point] {
        &self.contours[0]
    }

    /// The distance of the boxes around the two, grid units.
    #[must_use]
    pub fn distance(&self, other: &Self) -> f64 {
        let apart = |low: Coord, high: Coord, other_low: Coord, other_high: Coord| {
            let between = |a: Coord, b: Coord| f64::from(a) - f64::from(b);
            between(other_low, high).max(between(low, other_high)).max(0.0)
        };
        let x = apart(self.low.x, self.high.x, other.low.x, other.high.x);
        let y = apart(self.low.y, self.high.y, other.low.y, other.high.y);
        (x * x + y * y).sqrt()
    }

    /// Whether a place lies within its outer contour.
    fn encloses(&self, p: Point) -> bool {
        self.has_in_box(p) && encloses(edges(self.outer()), p)
    }

    /// Whether a place lies on it, and not in a hole.
    fn holds(&self, p: Point) -> bool {
        self.has_in_box(p) && encloses(self.contours.iter().flat_map(|c| edges(c)), p)
    }

    /// Whether a place lies on it, or as near to its edge as `reach`.
    fn is_near(&self, place: Point, reach: f64) -> bool {
        let real = |p: Point| [f64::from(p.x), f64::from(p.y)];
        let mut edges = self.contours.iter().flat_map(|contour| edges(contour));
        self.holds(place)
            || edges.any(|(p, q)| distance2(real(place), [real(p), real(q)]) <= reach * reach)
    }

    fn has_in_box(&self, p: Point) -> bool {
        (self.low.x..=self.high.x).contains(&p.x) && (self.low.y..=self.high.y).contains(&p.y)
    }

    /// Some of its corners, evenly spread.
    pub fn corners(&self) -> impl Iterator<Item = Point> + Clone {
        let outer = self.outer();
        outer.iter().step_by(self.step()).copied()
    }

    fn step(&self) -> usize {
        self.outer().len().div_ceil(CORNERS).max(1)
    }

    /// Places near these corners, to the left of the contour there. At needles they may lie outside.
    fn inside_corners(&self) -> impl Iterator<Item = Point> {
        let (outer, n) = (self.outer(), self.outer().len());
        (0..n).step_by(self.step()).map(move |k| {
            let (before, at, after) = (outer[(k + n - 1) % n], outer[k], outer[(k + 1) % n]);
            let [a, b] = [(before, at), (at, after)].map(|(p, q)| {
                let length = p.distance(q).max(1.0);
                let way = |from: Coord, to: Coord| (f64::from(to) - f64::from(from)) / length;
                [way(q.y, p.y), way(p.x, q.x)]
            });
            let left = [a[0] + b[0], a[1] + b[1]];
            let scale = INSIDE / (left[0] * left[0] + left[1] * left[1]).sqrt().max(1e-3);
            let moved =
                |at: Coord, by: f64| at + nearest((by * scale).clamp(-INSIDE, INSIDE)) as Coord;
            Point { x: moved(at.x, left[0]), y: moved(at.y, left[1]) }
        })
    }

    /// Whether a place near a corner of `self` lies on both.
    #[must_use]
    pub fn has_corner_in(&self, other: &Self) -> bool {
        self.inside_corners().any(|p| other.holds(p) && self.holds(p))
    }

    /// Whether beads of `self` touch some of the layer below, as far as beads count.
    #[must_use]
    pub fn lies_on(&self, below: &Footprint) -> bool {
        let touches = |square: &[Coord; 2]| {
            let [x, y] = *square;
            (-1..=1)
                .flat_map(|i| (-1..=1).map(move |j| [x + i, y + j]))
                .any(|near| below.beads.contains(&near))
        };
        self.beads.is_empty() || self.beads.iter().any(touches)
    }

    /// Whether the two share an area.
    #[must_use]
    pub fn overlaps(&self, other: &Self) -> bool {
        let outside = polygon::difference(&self.contours, &other.contours, 0);
        let shared = polygon::difference(&self.contours, &outside, 0);
        !polygon::inset(&shared, SLIVER).is_empty()
    }
}
