//! Contours -> dots: parts so small and compact that loops alone fill them.
//!
//! Words: a *dot* is a contour without holes, hardly longer than it is wide, and too small for a core.
//! The *room* of a dot is that of the largest circle in it.
//!
//! The middle of a dot is a place and not a line. A middle bead would curl up there, and no place of
//! the outline has another one opposite. But an inset by half the room leaves nothing of it, whatever
//! its shape. So loops of equal width that share half the room fill it exactly.

use super::Wall;
use super::thin::{LIMIT, ONE_MORE};
use crate::geom::boxes::Around;
use crate::geom::{Contour, double_area, edges, polygon};
use crate::region::params::WallParams;
use crate::units::{Coord, nearest};
use std::f64::consts::PI;

/// The largest area of a dot, in squares of the radius of the largest circle in it. A circle has 3.1, a
/// square 4, a regular triangle 5.2, and a rectangle half as long again as wide 6. With a larger
/// value, strips get wide loops and no middle bead.
const COMPACT: f64 = 6.0;

/// How often the radius is halved in on: to a four hundredth.
const HALVINGS: usize = 7;

/// The loops of the dots among `contours`, and the other contours. `None` if there are no dots.
pub(super) fn dots(contours: &[Contour], params: &WallParams) -> Option<(Vec<Wall>, Vec<Contour>)> {
    let mut radii: Vec<Option<f64>> = contours.iter().map(|c| radius(c, params)).collect();
    if radii.iter().any(Option::is_some) {
        // What has a hole is no dot.
        let around = Around::new(contours.iter().enumerate().filter(|(k, _)| radii[*k].is_some()));
        let holes = contours.iter().filter(|c| double_area(c) < 0);
        let with_hole: Vec<usize> = holes.flat_map(|hole| around.of(hole[0])).collect();
        with_hole.into_iter().for_each(|k| radii[k] = None);
    }
    if radii.iter().all(Option::is_none) {
        return None;
    }
    let both = || contours.iter().zip(&radii);
    let loops = both().filter_map(|(c, radius)| Some(loops(c, (*radius)?, params))).flatten();
    let others = both().filter(|(_, radius)| radius.is_none()).map(|(c, _)| c.clone());
    Some((loops.collect(), others.collect()))
}

/// The radius of the largest circle in `contour`, if it may be a dot.
fn radius(contour: &Contour, params: &WallParams) -> Option<f64> {
    let most = params.room_of_loops(params.count) / 2.0 - params.outside();
    let area = double_area(contour) as f64 / 2.0;
    let holds = |radius: f64| {
        let inset =
            polygon::inset(std::slice::from_ref(contour), (nearest(radius) as Coord).max(1));
        !inset.is_empty()
    };
    let low = (area / COMPACT).max(0.0).sqrt();
    if area <= 0.0 || low > most || !holds(low) {
        return None;
    }
    let [low, high] = halved([low, (area / PI).sqrt()], holds);
    let radius = f64::midpoint(low, high);
    (radius <= most && 2.0 * radius >= params.least_room.max(params.narrowest)).then_some(radius)
}

/// A narrow range around the largest radius that `holds`, of one from a radius that does to one that may not.
pub(super) fn halved([mut low, mut high]: [f64; 2], holds: impl Fn(f64) -> bool) -> [f64; 2] {
    for _ in 0..HALVINGS {
        let middle = f64::midpoint(low, high);
        *(if holds(middle) { &mut low } else { &mut high }) = middle;
    }
    [low, high]
}

/// The loops of a dot.
fn loops(contour: &Contour, radius: f64, params: &WallParams) -> Vec<Wall> {
    let half = radius + params.outside();
    let count = (1..params.count).find(|&n| 2.0 * half < params.room_of_loops(n));
    let narrow = (half / params.narrowest) as u32;
    let count = count.unwrap_or(params.count).min(narrow).max(1);
    let even = half / f64::from(count);
    let width = even.max(params.narrowest);
    let inset = |depth: u32| {
        let deep = (f64::from(depth) + 0.5) * even - params.outside();
        if even < width { nearer(contour, radius, width) } else { deep }
    };
    let path = |depth: u32| {
        let inset = nearest(inset(depth)) as Coord;
        let whole = std::slice::from_ref(contour);
        let paths = match inset {
            0 => whole.to_vec(),
            1.. => polygon::inset(whole, inset),
            _ => polygon::outset(whole, -inset),
        };
        let widths = |path: &Contour| vec![nearest(width) as Coord; path.len()];
        let wall = move |path: Contour| Wall { widths: widths(&path), ..Wall::closed(path, depth) };
        paths.into_iter().map(wall)
    };
    (0..count).flat_map(path).collect()
}

/// The inset at which a loop wider than half the room is as much plastic as there is solid.
fn nearer(contour: &Contour, radius: f64, width: f64) -> f64 {
    let whole = length(std::slice::from_ref(contour));
    let half = nearest(radius / 2.0).max(1) as Coord;
    let inner = length(&polygon::inset(std::slice::from_ref(contour), half));
    // Each inset makes the loop shorter by the same.
    let least = double_area(contour) as f64 / 2.0 / width;
    let inset = (whole - least) / (whole - inner).max(1.0) * f64::from(half);
    inset.clamp(radius / 2.0, 0.95 * radius)
}

fn length(contours: &[Contour]) -> f64 {
    contours.iter().flat_map(|c| edges(c)).map(|(p, q)| p.distance(q)).sum()
}

impl WallParams {
    /// The room above which one more than `count` loops, or a core, fits inside the outline.
    fn room_of_loops(&self, count: u32) -> f64 {
        let w = f64::from(self.line_width);
        (2.0 * f64::from(count) + ONE_MORE) * w + f64::from(LIMIT)
    }
}
