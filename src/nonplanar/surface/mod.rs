//! Triangles -> Surface: a piece of the part's top with one height at each place, and what is asked of it.
//!
//! Words: a *facet* is a triangle of the mesh. A facet that faces down is a sliver that folds under its
//! neighbours: it counts for the outline, but has no height.
//!
//! All answers are exact on the facets, but for rounding to the grid:
//! - The outline is the rim of all facets in plan.
//! - The height over a place is that of the facet there. Two facets of an edge agree on it. Places up to
//!   2 µm beside the surface have the height of its edge: outlines are rounded to the grid.
//! - A band between two heights is the rim of the facets cut off at both. Crossings are rounded as those
//!   of the slicer, and both facets of an edge get the same.
//! - A profile has a point where the way crosses an edge.

pub mod find;

mod facets;
mod index;
mod levels;
pub(super) mod rim;
mod sheets;
#[cfg(test)]
mod tests;
mod upright;

use crate::geom::boxes::extent;
use crate::geom::raster::crossed;
use crate::geom::{Contour, Point, edges, encloses, side};
use crate::mesh::geometry::vector::normal;
use crate::units::{Coord, UNITS_PER_MM, between};
use index::{Index, NEAR};
use levels::Levels;
use rim::of_sides;

/// Distance of the rows that areas are measured along, grid units: 0.05 mm.
const ROW: f64 = 500.0;

/// A piece of the part's top, with one height over each place of its outline. Grid units.
#[derive(Debug)]
pub struct Surface {
    facets: Vec<[[Coord; 3]; 3]>,
    /// Which sides of each facet have no other facet beside them.
    open: Vec<[bool; 3]>,
    levels: Levels,
    index: Index,
    outline: Vec<Contour>,
    upright: Vec<[Point; 2]>,
    extent: (Point, Point),
    bounds: [Coord; 2],
    area_mm2: f64,
    steepest: f64,
    direction: f64,
}

impl Surface {
    /// The surface of some facets, counter-clockwise seen from above. `open` are those of their sides, from
    /// each corner to the next, along which no other of them runs the other way.
    #[must_use]
    pub(super) fn new(facets: Vec<[[Coord; 3]; 3]>, open: Vec<[bool; 3]>) -> Self {
        let plans: Vec<[Point; 3]> = facets.iter().map(plan).collect();
        let zs = || facets.as_flattened().iter().map(|corner| corner[2]);
        let bounds = [zs().min().unwrap_or(0), zs().max().unwrap_or(0)];
        let (mut steepest, mut area, mut axis) = (0.0_f64, 0.0, [0.0; 2]);
        for facet in &facets {
            let [x, y, z] = across(facet);
            if z <= 0.0 {
                continue;
            }
            area += x.hypot(y).hypot(z) / 2.0;
            // Doubled angles, so that slopes to both sides add up; weighted by area and slope².
            axis = [axis[0] + (x * x - y * y) / z, axis[1] + 2.0 * x * y / z];
            if !is_thin(facet, z) {
                steepest = steepest.max(x.hypot(y) / z);
            }
        }
        let turn = libm::atan2(axis[1], axis[0]).to_degrees() / 2.0;
        let rim = plans.iter().zip(&open).flat_map(|(plan, open)| {
            edges(plan).zip(open).filter(|(_, open)| **open).map(|(side, _)| side)
        });
        Self {
            outline: of_sides(rim),
            levels: Levels::new(&facets),
            index: Index::new(&plans),
            upright: Vec::new(),
            extent: extent(plans.as_flattened()).unwrap_or_default(),
            bounds,
            area_mm2: area / (UNITS_PER_MM * UNITS_PER_MM),
            steepest: libm::atan(steepest).to_degrees(),
            direction: turn.rem_euclid(180.0),
            facets,
            open,
        }
    }

    /// Its outline in plan, outer contours counter-clockwise, as from [`crate::geom::polygon::union`].
    #[must_use]
    pub fn outline(&self) -> &[Contour] {
        &self.outline
    }

    /// Lowest and highest x and y.
    #[must_use]
    pub fn extent(&self) -> (Point, Point) {
        self.extent
    }

    /// Its lowest and its highest z.
    #[must_use]
    pub fn bounds(&self) -> [Coord; 2] {
        self.bounds
    }

    /// Its steepest slope, degrees. Facets too thin to have a dependable slope do not count.
    #[must_use]
    pub fn steepest(&self) -> f64 {
        self.steepest
    }

    /// The direction in plan in which it is steepest on the mean, degrees from x, from 0 to below 180:
    /// each facet counts by its area and the square of its slope.
    #[must_use]
    pub fn direction(&self) -> f64 {
        self.direction
    }

    /// Its height over a place, grid units; `None` beside it.
    #[must_use]
    pub fn z(&self, at: Point) -> Option<f64> {
        self.facet_at(at).map(|facet| height(facet, at))
    }

    /// How it rises along x and along y at a place; `None` beside it.
    #[must_use]
    pub fn slope(&self, at: Point) -> Option<[f64; 2]> {
        self.facet_at(at).map(|facet| {
            let [x, y, z] = across(facet);
            [-x / z, -y / z]
        })
    }

    /// The facet over a place, the one that is highest there.
    fn facet_at(&self, at: Point) -> Option<&[[Coord; 3]; 3]> {
        let near = self.index.at(at);
        let highest = |least: &dyn Fn(Point, Point) -> f64| {
            let holds = |facet: &[[Coord; 3]; 3]| {
                let [a, b, c] = plan(facet);
                let is_left = |a: Point, b: Point| side(a, b, at) as f64 >= least(a, b);
                is_left(a, b) && is_left(b, c) && is_left(c, a) && side(a, b, c) > 0
            };
            let mut best: Option<(u32, f64)> = None;
            for &k in near.iter().filter(|&&k| holds(&self.facets[k as usize])) {
                let z = height(&self.facets[k as usize], at);
                if best.is_none_or(|(_, other)| z > other) {
                    best = Some((k, z));
                }
            }
            best
        };
        let (k, _) = highest(&|_, _| 0.0).or_else(|| highest(&|a, b| -NEAR * a.distance(b)))?;
        Some(&self.facets[k as usize])
    }

    /// Where it is lower than `below` and not lower than `from`, in plan, as from a union.
    #[must_use]
    pub fn between(&self, from: Coord, below: Coord) -> Vec<Contour> {
        let [low, high] = self.bounds;
        if from <= low && high < below {
            return self.outline.clone();
        }
        if high < from || below <= low {
            return Vec::new();
        }
        let mut sides = Vec::new();
        self.levels.each(&self.facets, [from, below], |k| {
            band(&self.facets[k], self.open[k], [from, below], &mut sides);
        });
        of_sides(sides.into_iter())
    }

    /// Where the straight way from `a` to `b` crosses its edges: the share of the way and the height,
    /// grid units, in order. The ends are among them, if they lie on the surface.
    ///
    /// Where the way leaves the surface and comes back, the places where it does are two points in a row
    /// like any others: who must know keeps to the outline.
    #[must_use]
    pub fn profile(&self, a: Point, b: Point) -> Vec<(f64, f64)> {
        let length = a.distance(b);
        let mut found: Vec<(f64, f64)> = Vec::new();
        found.extend(self.z(a).map(|z| (0.0, z)));
        if length == 0.0 {
            return found;
        }
        found.extend(self.z(b).map(|z| (1.0, z)));
        for k in self.index.along(a, b) {
            let facet = &self.facets[k as usize];
            if across(facet)[2] > 0.0 {
                crossings(facet, (a, b), &mut found);
            }
        }
        in_order(found, length)
    }

    /// As [`Self::profile`], along many ways that run to the right along rows: from and to these x at
    /// `y = j · pitch`, with j from `first` on. Ways may be missing.
    #[must_use]
    pub(super) fn profiles(
        &self,
        (first, pitch): (i32, Coord),
        ways: &[Option<[Coord; 2]>],
    ) -> Vec<Vec<(f64, f64)>> {
        let y = |k: usize| (first + k as i32) * pitch;
        let ends = |(k, way): (usize, &Option<[Coord; 2]>)| {
            let z = |(x, share): (Coord, f64)| Some((share, self.z(Point { x, y: y(k) })?));
            way.iter().flat_map(|&[a, b]| [(a, 0.0), (b, 1.0)]).filter_map(z).collect()
        };
        let mut found: Vec<Vec<(f64, f64)>> = ways.iter().enumerate().map(ends).collect();
        let xs = || ways.iter().flatten().flatten().copied();
        let (Some(left), Some(right)) = (xs().min(), xs().max()) else { return found };
        let (low, high) = (y(0), y(ways.len().saturating_sub(1)));
        let around =
            [(left, low), (right, low), (right, high), (left, high)].map(|(x, y)| Point { x, y });
        for facet in self.index.near(&around).into_iter().map(|k| &self.facets[k as usize]) {
            if across(facet)[2] <= 0.0 {
                continue;
            }
            let [[_, a, _], [_, b, _], [_, c, _]] = *facet;
            let (low, high) = (a.min(b).min(c), a.max(b).max(c));
            let rows = crossed(low, high, pitch);
            let rows = rows.start.max(first)..rows.end;
            for k in rows.map(|j| (j - first) as usize).take_while(|&k| k < ways.len()) {
                if let Some(way) = ways[k] {
                    level_crossings(facet, (way, y(k)), &mut found[k]);
                }
            }
        }
        let length = |way: &Option<[Coord; 2]>| way.map_or(0.0, |[a, b]| f64::from(b - a));
        let lengths = ways.iter().map(length);
        found.into_iter().zip(lengths).map(|(found, length)| in_order(found, length)).collect()
    }

    /// Its lowest and highest z over an area in plan, as from a union; `None` if they have no place in
    /// common.
    #[must_use]
    pub fn over(&self, area: &[Contour]) -> Option<[f64; 2]> {
        if area == self.outline && !area.is_empty() {
            return Some(self.bounds.map(f64::from));
        }
        let mut bounds: Option<[f64; 2]> = None;
        let mut meet = |z: f64| {
            let [low, high] = bounds.unwrap_or([z, z]);
            bounds = Some([low.min(z), high.max(z)]);
            bounds
        };
        let mut known: Option<[f64; 2]> = None;
        for (a, b) in area.iter().flat_map(|contour| edges(contour)) {
            // Along most sides it is neither lower nor higher than what is known.
            let is_within = |k: u32| {
                let [lowest, highest] = levels::bounds(&self.facets[k as usize]).map(f64::from);
                known.is_some_and(|[low, high]| low <= lowest && highest <= high)
            };
            if self.index.all_near(&[a, b], is_within) {
                continue;
            }
            for (_, z) in self.profile(a, b) {
                known = meet(z);
            }
        }
        // Elsewhere it is lowest and highest at corners.
        let (low, high) = extent(area.iter().flatten())?;
        for &[x, y, z] in self.facets.as_flattened() {
            let z = f64::from(z);
            let in_box = low.x <= x && x <= high.x && low.y <= y && y <= high.y;
            let is_new = known.is_none_or(|[low, high]| z < low || z > high);
            let all = || area.iter().flat_map(|contour| edges(contour));
            if in_box && is_new && encloses(all(), Point { x, y }) {
                known = meet(z);
            }
        }
        known
    }

    /// Its true area over an area in plan, as from a union, mm². Exact over its own outline, elsewhere
    /// measured along rows 0.05 mm apart.
    #[must_use]
    pub fn area_mm2(&self, of: &[Contour]) -> f64 {
        if of == self.outline {
            return self.area_mm2;
        }
        let Some((low, high)) = extent(of.iter().flatten()) else { return 0.0 };
        let tall = f64::from(high.y) - f64::from(low.y);
        let rows = (tall / ROW).ceil().max(1.0);
        let step = tall / rows;
        let mut length = 0.0;
        for row in 0..rows as usize {
            let y = f64::from(low.y) + (row as f64 + 0.5) * step;
            length += self.along_row(of, y);
        }
        length * step / (UNITS_PER_MM * UNITS_PER_MM)
    }

    /// The length along y of an area, each stretch weighted by how much of the surface lies over it.
    fn along_row(&self, of: &[Contour], y: f64) -> f64 {
        let all = of.iter().flat_map(|contour| edges(contour));
        let inside = row_crossings(all, y);
        let (Some(first), Some(last)) = (inside.first(), inside.last()) else { return 0.0 };
        let at = |x: f64| Point { x: x as Coord, y: y as Coord };
        let mut sum = 0.0;
        for k in self.index.along(at(*first), at(*last)) {
            let facet = &self.facets[k as usize];
            let [nx, ny, nz] = across(facet);
            let own = row_crossings(edges(&plan(facet)), y);
            let &[left, right] = &own[..] else { continue };
            if nz <= 0.0 {
                continue;
            }
            let weight = nx.hypot(ny).hypot(nz) / nz;
            let before = inside.partition_point(|&x| x < left) / 2 * 2;
            for span in inside[before..].chunks_exact(2).take_while(|span| span[0] < right) {
                sum += weight * (span[1].min(right) - span[0].max(left)).max(0.0);
            }
        }
        sum
    }
}

/// Where some sides cross a row, from left to right.
fn row_crossings(sides: impl Iterator<Item = (Point, Point)>, y: f64) -> Vec<f64> {
    let crossing = |(a, b): (Point, Point)| {
        let [ax, ay, bx, by] = [a.x, a.y, b.x, b.y].map(f64::from);
        ((ay < y) != (by < y)).then(|| ax + (bx - ax) * (y - ay) / (by - ay))
    };
    let mut found: Vec<f64> = sides.filter_map(crossing).collect();
    found.sort_by(f64::total_cmp);
    found
}

/// Places of a way with their heights, in order. Both facets of an edge give the same place. Places nearer
/// than a grid unit are one.
fn in_order(mut found: Vec<(f64, f64)>, length: f64) -> Vec<(f64, f64)> {
    found.sort_unstable_by(|one, other| one.0.total_cmp(&other.0).then(other.1.total_cmp(&one.1)));
    let mut out: Vec<(f64, f64)> = Vec::with_capacity(found.len());
    for point in found {
        match out.last_mut() {
            Some(last) if (point.0 - last.0) * length < 1.0 => {
                if point.0 >= 1.0 && last.0 > 0.0 {
                    *last = point;
                }
            }
            _ => out.push(point),
        }
    }
    out
}

/// The corners of a facet in plan.
fn plan(facet: &[[Coord; 3]; 3]) -> [Point; 3] {
    let corner = |[x, y, _]: [Coord; 3]| Point { x, y };
    [corner(facet[0]), corner(facet[1]), corner(facet[2])]
}

/// The normal of a facet, as long as twice its area. Exact: its parts are products of coordinates.
fn across(facet: &[[Coord; 3]; 3]) -> [f64; 3] {
    let [x, y, z] = normal(*facet);
    [x as f64, y as f64, z as f64]
}

/// Whether a facet with this doubled area in plan is narrower than 0.01 mm: rounding turns it anyhow.
fn is_thin(facet: &[[Coord; 3]; 3], twice: f64) -> bool {
    let longest = edges(&plan(facet)).map(|(a, b)| a.distance(b)).fold(0.0, f64::max);
    twice < 100.0 * longest
}

/// The height of a facet's plane over a place, within the facet's own heights.
fn height(facet: &[[Coord; 3]; 3], at: Point) -> f64 {
    let [x, y, z] = across(facet);
    let [a, b, c] = *facet;
    let (dx, dy) = (i64::from(at.x) - i64::from(a[0]), i64::from(at.y) - i64::from(a[1]));
    let over = f64::from(a[2]) - (x * dx as f64 + y * dy as f64) / z;
    let (low, high) = (a[2].min(b[2]).min(c[2]), a[2].max(b[2]).max(c[2]));
    over.clamp(f64::from(low), f64::from(high))
}

/// Adds the sides of what of a facet is not lower than the first height and lower than the second, in plan:
/// those along its open sides, and those at both heights. The others are those of the facets beside it, too.
fn band(
    facet: &[[Coord; 3]; 3],
    open: [bool; 3],
    heights: [Coord; 2],
    sides: &mut Vec<(Point, Point)>,
) {
    let is_in = |corner: &[Coord; 3]| corner[2] >= heights[0] && corner[2] < heights[1];
    if open == [false; 3] && facet.iter().all(is_in) {
        return;
    }
    // The corners of what is left, each with whether the side from it to the next one is wanted.
    let mut corners: Vec<(Point, bool)> = Vec::with_capacity(9);
    for k in 0..3 {
        let (p, q) = (facet[k], facet[(k + 1) % 3]);
        let before = corners.len();
        if is_in(&p) {
            corners.push((Point { x: p[0], y: p[1] }, open[k]));
        }
        let rises = p[2] < q[2];
        let (low, high) = if rises { (p, q) } else { (q, p) };
        let order = if rises { [0, 1] } else { [1, 0] };
        for v in order.map(|k| heights[k]) {
            // A corner at the height counts as above it, as in slicing.
            if low[2] < v && v <= high[2] {
                let along = |axis: usize| between(low[axis], high[axis], (v, low[2], high[2]));
                corners.push((Point { x: along(0), y: along(1) }, open[k]));
            }
        }
        // Where the facet's side leaves the band, a side at that height begins.
        if let Some(last) = corners[before..].last_mut().filter(|_| !is_in(&q)) {
            last.1 = true;
        }
    }
    let next = corners.iter().cycle().skip(1);
    let pairs = corners.iter().zip(next).filter(|((_, wanted), _)| *wanted);
    sides.extend(pairs.map(|(a, b)| (a.0, b.0)));
}

/// Where a straight way crosses the sides of a facet: the share of the way and the height.
fn crossings(facet: &[[Coord; 3]; 3], (a, b): (Point, Point), found: &mut Vec<(f64, f64)>) {
    let plan = plan(facet);
    let asides = [side(a, b, plan[0]), side(a, b, plan[1]), side(a, b, plan[2])];
    let way = [f64::from(b.x) - f64::from(a.x), f64::from(b.y) - f64::from(a.y)];
    let length2 = way[0] * way[0] + way[1] * way[1];
    let share =
        |x: f64, y: f64| ((x - f64::from(a.x)) * way[0] + (y - f64::from(a.y)) * way[1]) / length2;
    let mut add = |[x, y, z]: [f64; 3]| {
        let t = share(x, y);
        if t > 0.0 && t < 1.0 {
            found.push((t, z));
        }
    };
    for k in 0..3 {
        let next = (k + 1) % 3;
        if asides[k] == 0 {
            let [x, y, z] = facet[k];
            add([f64::from(x), f64::from(y), f64::from(z)]);
        }
        if (asides[k] < 0 && asides[next] > 0) || (asides[k] > 0 && asides[next] < 0) {
            // From the lesser corner, so that both facets of an edge get the same numbers.
            let (p, q) = if facet[k] < facet[next] { (k, next) } else { (next, k) };
            let by = asides[p] as f64 / (asides[p] as f64 - asides[q] as f64);
            let at = |axis: usize| {
                let (from, to) = (f64::from(facet[p][axis]), f64::from(facet[q][axis]));
                from + by * (to - from)
            };
            add([at(0), at(1), at(2)]);
        }
    }
}

/// The same on a way to the right along x, at y: to the last digit, since the distances from such a way are all
/// multiplied by its length there.
fn level_crossings(
    facet: &[[Coord; 3]; 3],
    ([left, right], y): ([Coord; 2], Coord),
    found: &mut Vec<(f64, f64)>,
) {
    let aside = |k: usize| i64::from(facet[k][1]) - i64::from(y);
    let asides = [aside(0), aside(1), aside(2)];
    let (left, way) = (f64::from(left), f64::from(right) - f64::from(left));
    let mut add = |x: f64, z: f64| {
        let t = (x - left) * way / (way * way);
        if t > 0.0 && t < 1.0 {
            found.push((t, z));
        }
    };
    for k in 0..3 {
        let next = (k + 1) % 3;
        if asides[k] == 0 {
            add(f64::from(facet[k][0]), f64::from(facet[k][2]));
        }
        if (asides[k] < 0 && asides[next] > 0) || (asides[k] > 0 && asides[next] < 0) {
            let (p, q) = if facet[k] < facet[next] { (k, next) } else { (next, k) };
            let by = asides[p] as f64 / (asides[p] - asides[q]) as f64;
            let at = |axis: usize| {
                let (from, to) = (f64::from(facet[p][axis]), f64::from(facet[q][axis]));
                from + by * (to - from)
            };
            add(at(0), at(2));
        }
    }
}
