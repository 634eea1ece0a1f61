//! An island of open skin -> the direction in which its lines hold best.
//!
//! Words: *open* and *carrier* as in [`super`]. A *run* is what one line has of the island. A run's
//! end *holds* if the carrier, or a wall on it, begins there.
//!
//! Algorithm: draw the island and the carrier around it into a small grid of cells. For each of
//! the directions, those of sides beside it and some that lie evenly around, walk over the grid along
//! parallel lines. Count what part of the runs' ends does not hold, weighted by length, and how long
//! the runs are: the mean of their lengths' eighth powers, weighted by length, so that the longest
//! count most. Of the directions with nearly the fewest free ends, the shortest runs win. So a
//! bridge is laid across its gap, and a ledge that is held on one side only is laid outwards
//! from there, in lines that each begin on the carrier.

use super::sides::{COUNT, STEP, Sides};
use crate::geom::Point;
use crate::geom::islands::Islands;
use crate::geom::spans::Rows;
use crate::units::{Bounded as _, Coord, sin_cos};

/// One in so many directions is tried, and those of sides.
const EVERY: usize = COUNT / 24;

/// Share of free ends that makes no difference by itself: lines that graze an island's edge are free
/// in any direction. At 0.05 bridges were laid one step askew, so that the lines at their sides
/// ended in the side walls; at 0 noise decides.
const ALIKE: f64 = 0.02;

/// What a free end costs among directions that are alike: eight times its share of the length. At
/// twice, small bridges were laid a step askew, since cells tell lengths only roughly.
const FREE_COST: f64 = 8.0;

/// Along or across a side a bridge may have this share of free ends more than in the best direction, and lines
/// longer by this share: cells and the lines that are tried tell both only roughly. Such bridges keep their
/// edges along the walls. Larger values lay bridges along sides that do not carry them; smaller ones askew.
const NEAT: [f64; 2] = [0.08, 0.03];

/// The same along or across the rows. At [`NEAT`] openings without straight sides would get longer lines.
const NEAT_ROWS: [f64; 2] = [0.04, 0.019];

/// Beside a larger bridge lines may be longer by this factor than in the best direction, so that both lie in one.
/// A larger value lays slots along their length; with a smaller one round holes are laid askew to what is around them.
const LONGER: f64 = 1.25;

/// So many lines at each edge may graze a side that they are parallel to: they leave and enter the cells of the
/// island, and seem free.
const GRAZING: usize = 2;

/// Most lines of one direction. The lines of a large island lie further apart: the choice is the
/// same, and its time stays bounded.
const MOST_LINES: usize = 64;

/// An island on the raster of the layer's skin.
#[derive(Debug, Clone, Copy)]
pub struct Site<'a> {
    /// Number of the island.
    pub island: usize,
    /// All islands.
    pub islands: &'a Islands<'a>,
    /// What is printed below.
    pub carrier: &'a Rows,
    /// Distance of the rows.
    pub pitch: Coord,
}

/// A direction for the lines of an island.
#[derive(Debug, Clone, Copy)]
pub struct Direction {
    /// Number of [`STEP`]s from the rows.
    pub turn: usize,
    /// Share of the lines' ends that do not hold, by length: 0 to 1. Where the island goes on from what carries
    /// it to an edge of the part it is a half or more. Cells do not tell it of strips at most two rows wide: there
    /// it is 1.
    pub free: f64,
    /// How long the lines are, in cells: the mean by which directions are compared.
    pub length: f64,
}

/// Whether the lines of an island hold in direction `turn` nearly as well as in their `best` one.
#[must_use]
pub fn suits(site: &Site<'_>, turn: usize, best: &Direction, walls: Coord) -> bool {
    let hold = Grid::new(site, walls).map(|grid| grid.hold(turn, false));
    hold.is_some_and(|Hold { free, length }| {
        free <= best.free + NEAT[0] && length <= LONGER * best.length
    })
}

/// The best direction for the lines of an island. Walls lie within `walls` beyond its edge, `sides` beside them.
#[must_use]
pub fn best(site: &Site<'_>, walls: Coord, sides: &Sides) -> Direction {
    let none = Direction { turn: 0, free: 1.0, length: 0.0 };
    let Some(grid) = Grid::new(site, walls) else { return none };
    let thin = grid.is_thin();
    let along = if thin { Vec::new() } else { sides.directions(grid.corners(walls)) };
    let of = |turn: usize| (turn, grid.hold(turn, along.contains(&turn)));
    // A side that is nearly parallel to the rows, or square to them, is what counts there.
    let rows = [0, COUNT / 2].into_iter().filter(|row| !along.iter().any(|to| is_near(*row, *to)));
    let rows: Vec<(usize, Hold)> = rows.map(of).collect();
    let sides: Vec<(usize, Hold)> = along.iter().copied().map(of).collect();
    let is_new = |turn: &usize| !along.contains(turn) && !rows.iter().any(|(row, _)| row == turn);
    let others: Vec<(usize, Hold)> = (0..COUNT).step_by(EVERY).filter(is_new).map(of).collect();
    let tried = || sides.iter().chain(&rows).chain(&others).copied();
    let fewest = tried().map(|(_, hold)| hold.free).fold(f64::MAX, f64::at_most);
    let cost = |hold: Hold| hold.length * (1.0 + FREE_COST * (hold.free - fewest));
    let good = tried().filter(|(_, hold)| hold.free <= fewest + ALIKE);
    let Some(best) = good.min_by(|a, b| cost(a.1).total_cmp(&cost(b.1))) else { return none };
    // Along and across the rows first, then along sides: of equal directions they give the neatest edges. Of both
    // the rows' own direction first: the skin above then crosses the bridge.
    let neat = |tried: &[(usize, Hold)], [free, longer]: [f64; 2]| {
        let is_neat = |(_, hold): &&(usize, Hold)| {
            hold.free <= fewest + free && hold.length <= best.1.length * (1.0 + longer)
        };
        tried.iter().find(is_neat).copied()
    };
    let (turn, Hold { free, length }) =
        neat(&rows, NEAT_ROWS).or_else(|| neat(&sides, NEAT)).unwrap_or(best);
    Direction { turn, free: if thin { 1.0 } else { free }, length }
}

/// Whether two directions are different, but nearer to each other than those that lie evenly around.
fn is_near(a: usize, b: usize) -> bool {
    let off = a.abs_diff(b);
    a != b && off.min(COUNT - off) < EVERY
}

/// How well an island holds in one direction.
#[derive(Debug, Clone, Copy)]
struct Hold {
    /// Share of the ends that do not hold.
    free: f64,
    /// How long the runs are, in cells.
    length: f64,
}

/// What a cell holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Cell {
    Nothing,
    Open,
    Carrier,
}

/// The island and what is around it, in square cells.
struct Grid {
    /// The island's first row and its least place along the rows, and the greatest ones.
    ends: [Point; 2],
    cells: Vec<Cell>,
    width: usize,
    height: usize,
    /// How far beyond the island's edge the carrier still holds a line, in cells.
    reach: usize,
}

impl Grid {
    fn new(site: &Site<'_>, walls: Coord) -> Option<Self> {
        let Site { island, islands, carrier, pitch } = *site;
        let open = islands.select(|k| k == island);
        let rows = || open.iter().filter(|(_, row)| !row.is_empty());
        let (first, last) = (rows().next()?.0, rows().last()?.0);
        let ends = || rows().flat_map(|(_, row)| row);
        let (low, high) = (ends().map(|s| s.start).min()?, ends().map(|s| s.end).max()?);
        let reach = usize::try_from(walls / pitch).ok()? + 1;
        let margin = reach as i32 + 1;
        let left = low.div_euclid(pitch) - margin;
        let width = usize::try_from(high.div_euclid(pitch) + margin + 1 - left).ok()?;
        let height = usize::try_from(last - first + 2 * margin + 1).ok()?;
        let mut cells = vec![Cell::Nothing; width * height];
        for (row, j) in cells.chunks_mut(width).zip(first - margin..) {
            for (rows, cell) in [(carrier, Cell::Carrier), (&open, Cell::Open)] {
                for span in rows.row(j) {
                    // A cell counts if its middle is in the span.
                    let index = |u: Coord| (u + pitch / 2).div_euclid(pitch) - left;
                    let clamp = |k: i32| k.clamp(0, width as i32) as usize;
                    row[clamp(index(span.start))..clamp(index(span.end))].fill(cell);
                }
            }
        }
        let ends = [(low, first), (high, last)].map(|(x, j)| Point { x, y: j * pitch });
        Some(Self { ends, cells, width, height, reach })
    }

    /// The corners of a box around the island and `walls`.
    fn corners(&self, walls: Coord) -> [Point; 2] {
        let [low, high] = self.ends;
        let out = |p: Point, by: Coord| Point { x: p.x + by, y: p.y + by };
        [out(low, -walls), out(high, walls)]
    }

    /// Whether the island is nowhere wider than two cells.
    fn is_thin(&self) -> bool {
        let is_open = |k: usize| self.cells[k] == Cell::Open;
        // The outermost cells are not open.
        let is_inner = |k: usize| {
            is_open(k) && [k - 1, k + 1, k - self.width, k + self.width].into_iter().all(is_open)
        };
        !(0..self.cells.len()).any(is_inner)
    }

    fn at(&self, [x, y]: [f64; 2]) -> Cell {
        if x < 0.0 || y < 0.0 {
            return Cell::Nothing;
        }
        let (x, y) = (x as usize, y as usize);
        if x < self.width && y < self.height {
            self.cells[y * self.width + x]
        } else {
            Cell::Nothing
        }
    }

    /// From where to where a line through `start` along `way`, of length 1, runs over the cells; a little
    /// more is no harm.
    fn within(&self, start: [f64; 2], way: [f64; 2]) -> [f64; 2] {
        let size = [self.width as f64, self.height as f64];
        let mut on = [f64::MIN, f64::MAX];
        for axis in (0..2).filter(|&axis| way[axis].abs() > 0.01) {
            let ends = [-1.0, size[axis] + 1.0].map(|end| (end - start[axis]) / way[axis]);
            on[0] = on[0].at_least(ends[0].at_most(ends[1]));
            on[1] = on[1].at_most(ends[0].at_least(ends[1]));
        }
        on
    }

    /// How the island holds in direction `turn`. Along `sides` ends of the outermost lines do not count.
    fn hold(&self, turn: usize, sides: bool) -> Hold {
        let (sin, cos) = sin_cos(STEP * turn as f64);
        let middle = [self.width as f64 / 2.0, self.height as f64 / 2.0];
        let radius = (middle[0] * middle[0] + middle[1] * middle[1]).sqrt();
        let lines = (2.0 * radius).at_most(MOST_LINES as f64) as usize;
        // Two steps a cell, so that no cell is jumped over.
        let steps = (4.0 * radius) as usize;
        let mut sums: Vec<[f64; 3]> = Vec::with_capacity(lines);
        let mut line = Vec::with_capacity(steps);
        for n in 0..lines {
            let aside = (2.0 * n as f64 + 1.0 - lines as f64) * radius / lines as f64;
            let on = |step: usize| step as f64 / 2.0 - radius;
            let start = [middle[0] - aside * sin, middle[1] + aside * cos];
            // Beyond the cells there is nothing, which changes no run.
            let [from, to] = self.within(start, [cos, sin]).map(|on| 2.0 * (on + radius));
            let steps = from as usize..steps.min(to as usize + 2);
            line.clear();
            line.extend(steps.map(on).map(|on| {
                self.at([middle[0] + on * cos - aside * sin, middle[1] + on * sin + aside * cos])
            }));
            mend(&mut line, 2 * self.reach);
            let of = |(length, ends): (usize, usize)| {
                let length = length as f64 / 2.0;
                [length * ends as f64 / 2.0, length, length * length.powi(8)]
            };
            sums.extend(runs(&line, 2 * self.reach).into_iter().map(of).reduce(plus));
        }
        let left_out = if sides { GRAZING.min(sums.len() / 4) } else { 0 };
        let within = &sums[left_out..sums.len() - left_out];
        let [free, inner, _] = within.iter().copied().fold([0.0; 3], plus);
        let [_, all, powers] = sums.iter().copied().fold([0.0; 3], plus);
        let length = (powers / all.at_least(1.0)).sqrt().sqrt().sqrt();
        Hold { free: free / inner.at_least(1.0), length }
    }
}

fn plus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|k| a[k] + b[k])
}

/// Closes gaps of up to `reach` cells between open cells. A line that grazes an island's edge leaves
/// and enters it with every step of the cells; its parts are one run.
fn mend(line: &mut [Cell], reach: usize) {
    let mut last: Option<usize> = None;
    for k in 0..line.len() {
        match (line[k], last) {
            (Cell::Open, Some(from)) if k - from <= reach => line[from..k].fill(Cell::Open),
            (Cell::Carrier, _) => last = None,
            _ => {}
        }
        if line[k] == Cell::Open {
            last = Some(k);
        }
    }
}

/// The runs of open cells of a line: their lengths, and how many of their ends do not hold. The
/// carrier holds an end if it begins within `reach` cells from it.
fn runs(line: &[Cell], reach: usize) -> Vec<(usize, usize)> {
    let mut out = Vec::new();
    let mut from = 0;
    for run in line.chunk_by(|a, b| a == b) {
        let to = from + run.len();
        if run[0] == Cell::Open {
            let before = line[..from].iter().rev().take(reach).any(|c| *c == Cell::Carrier);
            let after = line[to..].iter().take(reach).any(|c| *c == Cell::Carrier);
            let free = usize::from(!before) + usize::from(!after);
            out.push((run.len(), free));
        }
        from = to;
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::frame::Frame;
    use crate::geom::raster::Raster;
    use crate::geom::{Contour, Point};
    use crate::region::scan::Scan;
    use proptest::prelude::*;

    const W: Coord = 4_000;

    fn rectangle(x: [Coord; 2], y: [Coord; 2]) -> Contour {
        [(x[0], y[0]), (x[1], y[0]), (x[1], y[1]), (x[0], y[1])].map(|(x, y)| Point { x, y }).into()
    }

    /// `contours`, turned, on the rows of a raster.
    fn rows(contours: &[Contour], degrees: f64) -> Rows {
        let turn = Frame::new(degrees);
        let turned = |c: &Contour| -> Contour { c.iter().map(|p| turn.leave(*p)).collect() };
        let contours: Vec<Contour> = contours.iter().map(turned).collect();
        let raster = Raster { frame: Frame::new(0.0), pitch: W };
        Scan::new(&contours, raster).inside().clone()
    }

    /// The best direction over an opening, in degrees from that of the opening.
    fn direction(open: &[Contour], carrier: &[Contour], degrees: f64) -> f64 {
        let all = [open, carrier].concat();
        let (open, carrier) = (rows(open, degrees), rows(carrier, degrees));
        let islands = Islands::new(&open);
        let site = Site { island: 0, islands: &islands, carrier: &carrier, pitch: W };
        let sides = Sides::new(all.iter(), Frame::new(-degrees));
        let off = STEP * best(&site, 2 * W, &sides).turn as f64 - degrees;
        (off + 90.0).rem_euclid(180.0) - 90.0
    }

    proptest! {
        /// However a bridge is turned, its lines run from pillar to pillar.
        #[test]
        fn a_bridge_is_laid_along_its_span(
            degrees in 0.0_f64..180.0,
            half in 30_000_i32..300_000,
            width in 40_000_i32..200_000,
        ) {
            let open = rectangle([-half, half], [-width / 2, width / 2]);
            let pillar = |side: Coord| {
                let x = [side * half, side * (half + 100_000)];
                rectangle([x[0].min(x[1]), x[0].max(x[1])], [-width / 2, width / 2])
            };
            let off = direction(&[open], &[pillar(-1), pillar(1)], degrees);
            prop_assert!(off.abs() <= STEP, "{off}");
        }

        /// A ledge is laid outwards from where it is held.
        #[test]
        fn a_ledge_is_laid_from_where_it_is_held(
            degrees in 0.0_f64..180.0,
            deep in 30_000_i32..150_000,
            wide in 60_000_i32..300_000,
        ) {
            let open = rectangle([0, deep], [-wide, wide]);
            let carrier = rectangle([-100_000, 0], [-wide, wide]);
            let off = direction(&[open], &[carrier], degrees);
            prop_assert!(off.abs() < 45.0, "{off}");
        }
    }

    proptest! {
        /// A hall that is held all around is laid along its sides.
        #[test]
        fn a_hall_is_laid_along_its_sides(
            width in 160_000..400_000_i32, deep in 160_000..400_000_i32,
        ) {
            let hall = rectangle([0, width], [0, deep]);
            let around = rectangle([-30_000, width + 30_000], [-30_000, deep + 30_000]);
            let rest = [around, hall.iter().rev().copied().collect()];
            let off = direction(std::slice::from_ref(&hall), &rest, 0.0).abs();
            prop_assert!(!(0.1..=89.9).contains(&off), "{off}");
        }
    }

    #[test]
    fn over_a_hole_that_is_held_all_around_the_shorter_way_wins() {
        let hole = rectangle([-200_000, 200_000], [-60_000, 60_000]);
        let around = rectangle([-300_000, 300_000], [-160_000, 160_000]);
        for degrees in [0.0, 20.0, 75.0, 130.0] {
            let rest = [around.clone(), hole.iter().rev().copied().collect()];
            let off = direction(std::slice::from_ref(&hole), &rest, degrees);
            assert!(off.abs() > 90.0 - STEP, "{degrees}: {off}");
        }
    }
}
