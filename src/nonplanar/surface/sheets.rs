//! A group of triangles that overlaps itself in plan -> sheets: groups that do not.
//!
//! A spiral ramp hangs together over several turns, but a surface has one height over each place. A sheet
//! grows from the lowest triangle that is left, from neighbour to neighbour. A grid of cells of 0.2 mm
//! remembers how high the sheet stands where. A triangle that comes to a cell at another height, by more
//! than a slope makes within the cell, is left for a later sheet.

use super::facets::in_plan;
use super::index::Grid;
use crate::geom::boxes::extent;
use crate::geom::{Point, side};
use crate::mesh::Mesh;
use crate::mesh::edges::{Adjacency, NONE, parts};
use crate::mesh::geometry::measure::corners_of;
use std::collections::VecDeque;

/// Side of a cell, grid units: 0.2 mm.
const CELL: f64 = 2_000.0;

/// Heights in a cell that are further apart belong to different sheets, grid units: what a slope of
/// 45° makes over the diagonals of a cell, and some more.
const APART: i32 = 4_000;

/// Divides `members`, in their order, into sheets.
#[must_use]
pub(super) fn sheets(mesh: &Mesh, adjacency: &Adjacency, members: &[u32]) -> Vec<Vec<u32>> {
    let corners = |k: usize| corners_of(&mesh.vertices, mesh.triangles[members[k] as usize]);
    let plans: Vec<[Point; 3]> = (0..members.len()).map(|k| in_plan(&corners(k))).collect();
    let Some(around) = extent(plans.as_flattened()) else { return Vec::new() };
    let grid = Grid::new(around, CELL);
    let mut stands: Vec<Option<(i32, i32)>> = vec![None; grid.count()];
    let lowest = |k: usize| corners(k).map(|corner| corner[2]).into_iter().min();
    let mut seeds: Vec<usize> = (0..members.len()).collect();
    seeds.sort_by_cached_key(|&k| (lowest(k), k));
    // The number of the sheet that a triangle is in, and of the last one that it did not fit into.
    let (mut taken, mut tried) = (vec![false; members.len()], vec![usize::MAX; members.len()]);
    let mut out: Vec<Vec<u32>> = Vec::new();
    for seed in seeds {
        if taken[seed] {
            continue;
        }
        let (mut sheet, mut touched) = (Vec::new(), Vec::new());
        let mut queue = VecDeque::from([seed]);
        while let Some(k) = queue.pop_front() {
            if taken[k] || tried[k] == out.len() {
                continue;
            }
            let heights = heights(&grid, &corners(k), &plans[k]);
            let fits = |&(cell, z): &(usize, i32)| {
                stands[cell].is_none_or(|(low, high)| low - APART < z && z < high + APART)
            };
            if !heights.iter().all(fits) {
                tried[k] = out.len();
                continue;
            }
            for (cell, z) in heights {
                let (low, high) = stands[cell].unwrap_or((z, z));
                stands[cell] = Some((low.min(z), high.max(z)));
                touched.push(cell);
            }
            taken[k] = true;
            sheet.push(members[k]);
            let sides = adjacency.neighbour[members[k] as usize].iter().filter(|&&s| s != NONE);
            let beside = sides.filter_map(|&s| members.binary_search(&(parts(s).0 as u32)).ok());
            queue.extend(beside);
        }
        touched.into_iter().for_each(|cell| stands[cell] = None);
        sheet.sort_unstable();
        out.push(sheet);
    }
    out
}

/// How high a triangle stands in the cells whose middles lie under it, and in that of its own middle.
fn heights(grid: &Grid, corners: &[[i32; 3]; 3], plan: &[Point; 3]) -> Vec<(usize, i32)> {
    let [a, b, c] = *plan;
    let mean = |axis: usize| {
        (corners.iter().map(|corner| i64::from(corner[axis])).sum::<i64>() / 3) as i32
    };
    let own = grid.cell(Point { x: mean(0), y: mean(1) }).map(|cell| (cell, mean(2)));
    let whole = side(a, b, c) as f64;
    let over = |cell: usize| {
        let p = grid.middle(cell);
        let shares = [side(b, c, p), side(c, a, p), side(a, b, p)];
        if whole <= 0.0 || shares.iter().any(|&share| share < 0) {
            return None;
        }
        let z = (0..3).map(|k| shares[k] as f64 * f64::from(corners[k][2])).sum::<f64>() / whole;
        Some((cell, z as i32))
    };
    grid.under(plan).filter_map(over).chain(own).collect()
}
