//! Walls of small islands -> walls: where they hold too much or too little plastic, others that suit better.
//!
//! Words: an *island* is a contour without holes and without a core inside. Its *plastic* is that of its
//! walls, its *room* what of it a bead of the least width reaches. A *way* is one set of walls for it.
//!
//! Loops and middle beads suit places with two sides. In a flower, or where many short rays meet, beads along
//! the middle of each petal run over the same place, and loops that follow all petals are longer than
//! there is room; one loop around the middle leaves the petals open.
//!
//! 1. Sum up the plastic of each small island. Nearly all have as much as their area: nothing is done.
//! 2. Else try other ways: without one or several beads, with narrower beads, with one, two or more loops.
//! 3. Of each way, what it leaves open and what it lays twice or outside are added. The way with
//!    the smallest sum is taken, if it is better by what can be seen.

use super::Wall;
use super::patches::{capsule, fitted, sides};
use crate::geom::boxes::Around;
use crate::geom::{Contour, Point, double_area, polygon};
use crate::region::params::WallParams;
use crate::region::taper::distance;
use crate::units::{Coord, UNITS_PER_MM, nearest};
use std::f64::consts::PI;

/// Larger islands have room for a core, or many places: one more or less is not seen. Square grid units (6 mm²).
const SMALL: f64 = 6e8;

/// Plastic over area, with round ends and without, that is right. A smaller range costs time.
const LEAST_PLASTIC: f64 = 0.94;
const MOST_PLASTIC: f64 = 1.04;

/// Another way has to be better by this part of the area, so that like layers keep like walls.
const BETTER: f64 = 0.04;

/// At most so many loops are tried, and so many beads taken away.
const MOST: usize = 4;

/// How much of the radius of the narrowest bead has to be free, for rounding.
const PART: f64 = 0.95;

/// What is open counts this many times. With a smaller value thin strokes go where they meet.
const OPEN: f64 = 1.5;

/// Gives each small island of `contours` the walls that suit it best.
pub(super) fn settle(
    contours: &[Contour],
    walls: &mut Vec<Wall>,
    core: &[Contour],
    params: &WallParams,
) {
    let is_small = |c: &Contour| (1.0..2.0 * SMALL).contains(&(double_area(c) as f64));
    let islands = || contours.iter().enumerate().filter(|(_, c)| is_small(c));
    if islands().next().is_none() {
        return;
    }
    let around = Around::new(islands());
    let mut wide = vec![false; contours.len()];
    let holes = contours.iter().filter(|c| double_area(c) < 0);
    let inside = holes.chain(core).filter_map(|c| c.first());
    inside.flat_map(|&p| around.of(p)).for_each(|k| wide[k] = true);
    let mut of = vec![Vec::new(); contours.len()];
    for (index, wall) in walls.iter().enumerate() {
        around_of(wall, &around).for_each(|k| of[k].push(index));
    }
    let mut taken = vec![false; walls.len()];
    let mut more = Vec::new();
    for (k, island) in islands().filter(|(k, _)| !wide[*k]) {
        let its: Vec<Wall> = of[k].iter().map(|&index| walls[index].clone()).collect();
        let plastic = plastic(&its, params);
        let whole = area(std::slice::from_ref(island));
        if plastic <= MOST_PLASTIC * whole && plastic + ends(&its) >= LEAST_PLASTIC * whole {
            continue;
        }
        if let Some(better) = better(island, its, params) {
            of[k].iter().for_each(|&index| taken[index] = true);
            more.extend(better);
        }
    }
    let mut taken = taken.into_iter();
    walls.retain(|_| taken.next() == Some(false));
    walls.extend(more);
}

/// The islands that a wall lies in. Some corners of it may lie outside, between two petals.
fn around_of(wall: &Wall, around: &Around<'_>) -> impl Iterator<Item = usize> {
    let around = |p: &Point| Some(around.of(*p).collect::<Vec<_>>()).filter(|all| !all.is_empty());
    wall.path.iter().find_map(around).unwrap_or_default().into_iter()
}

/// The area of those of several islands of which nothing is printed, mm².
pub(super) fn bare(contours: &[Contour], walls: &[Wall]) -> f64 {
    let islands = || contours.iter().enumerate().filter(|(_, c)| double_area(c) > 0);
    if islands().nth(1).is_none() {
        return 0.0;
    }
    let around = Around::new(islands());
    let mut bare: Vec<bool> = contours.iter().map(|c| double_area(c) > 0).collect();
    walls.iter().flat_map(|wall| around_of(wall, &around)).for_each(|k| bare[k] = false);
    let lost = contours.iter().zip(bare).filter(|(_, bare)| *bare);
    lost.map(|(c, _)| area(std::slice::from_ref(c))).sum::<f64>() / (UNITS_PER_MM * UNITS_PER_MM)
}

/// The walls that suit an island better than `its` own; `None` if there are none.
fn better(island: &Contour, its: Vec<Wall>, params: &WallParams) -> Option<Vec<Wall>> {
    let whole = std::slice::from_ref(island);
    let by = (nearest(PART * params.narrowest / 2.0) as Coord).max(1);
    let room = polygon::intersection(whole, &polygon::outset(&polygon::inset(whole, by), by));
    // Pointed corners that stick into a small island may leave no room for a mitred inset.
    let room = match room.is_empty() {
        true if its.is_empty() => return None,
        true => whole.to_vec(),
        false => room,
    };
    let wrong = |walls: &[Wall]| wrong(whole, walls, params);
    let least = BETTER * area(whole);
    let before = wrong(&its);
    let mut best = (before - least, None);
    let mut consider = |way: Vec<Wall>| {
        let wrong = wrong(&way);
        if wrong < best.0 && !way.is_empty() {
            best = (wrong, Some(way));
        }
    };
    let share = area(whole) / plastic(&its, params).max(1.0);
    let mut fewer = its.clone();
    for _ in 0..MOST.min(its.len().saturating_sub(1)) {
        let without = |k: usize| {
            let mut way = fewer.clone();
            way.remove(k);
            way
        };
        let ways = (0..fewer.len()).map(without).map(|way| (wrong(&way), way));
        let Some((_, way)) = ways.min_by(|a, b| a.0.total_cmp(&b.0)) else { break };
        fewer = way;
        consider(fewer.clone());
        let share = area(whole) / plastic(&fewer, params).max(1.0);
        if share < 1.0 {
            consider(narrower(fewer.clone(), share, params));
        }
    }
    if share < 1.0 {
        consider(narrower(its, share, params));
    }
    for count in 1..=MOST as u32 {
        consider(fitted(&room, Some(count), 0, params));
    }
    best.1
}

/// The same walls with this `share` of their widths.
fn narrower(mut walls: Vec<Wall>, share: f64, params: &WallParams) -> Vec<Wall> {
    for wall in &mut walls {
        if wall.widths.is_empty() {
            wall.widths = vec![params.line_width; wall.path.len()];
        }
        let least = params.narrowest.min(f64::from(params.line_width));
        wall.widths.iter_mut().for_each(|w| {
            *w = nearest((share * f64::from(*w)).max(least.min(f64::from(*w)))) as Coord
        });
    }
    walls
}

/// What `walls` leave open of an island, and what they lay twice or outside of it. What is open counts for more:
/// the island looks like another.
fn wrong(island: &[Contour], walls: &[Wall], params: &WallParams) -> f64 {
    let w = f64::from(params.line_width);
    let covered: Vec<Contour> =
        walls.iter().flat_map(|wall| sides(wall, w)).map(|s| capsule(&s)).collect();
    let covered = polygon::union(&covered);
    let inside = area(&polygon::intersection(island, &covered));
    let (open, outside) = (area(island) - inside, area(&covered) - inside);
    OPEN * open + outside + (plastic(walls, params) - area(&covered)).max(0.0)
}

/// The area of contours, square grid units.
fn area(contours: &[Contour]) -> f64 {
    contours.iter().map(|c| double_area(c) as f64 / 2.0).sum()
}

/// The area that the plastic of beads fills, square grid units.
fn plastic(walls: &[Wall], params: &WallParams) -> f64 {
    let w = f64::from(params.line_width);
    let sides = walls.iter().flat_map(|wall| sides(wall, w));
    sides.map(|([a, b], w)| distance(a, b) * w).sum()
}

/// The area of the round ends of beads, square grid units: no plastic is laid for them, but it gets there.
fn ends(walls: &[Wall]) -> f64 {
    let open = walls.iter().filter(|wall| !wall.closed);
    let widths = open.flat_map(|wall| [wall.widths.first(), wall.widths.last()]).flatten();
    widths.map(|w| f64::from(*w).powi(2) * PI / 8.0).sum()
}
