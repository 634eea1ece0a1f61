//! Walls of a block of layers -> counts: which inner walls are printed once for several layers.

use super::Wall;
use crate::geom::follow::follow;
use crate::region::dual::groups::{Block, Grouping};
use crate::region::params::WallParams;

/// Walls of two layers are printed at once if they are at most this fraction (one tenth) of a
/// line's width apart. A larger distance lets thick walls hang over or leave gaps to the outer
/// wall on slopes; a smaller one shares nothing but upright walls.
const ALIKE: i32 = 10;

/// For each wall of each layer of `block`, the number of layers it is printed for: 0 if a layer
/// above prints it. The outer wall is always for its own layer. An inner one continues in a wall
/// of the next layer that runs along it. Layers that have to be `thin` print nothing for others.
#[must_use]
pub fn share(
    block: &Block,
    layers: &[&[Wall]],
    grouping: &Grouping,
    thin: &dyn Fn(usize) -> bool,
    params: &WallParams,
) -> Vec<Vec<u32>> {
    let tolerance = params.line_width / ALIKE;
    let mut out: Vec<Vec<u32>> = layers.iter().map(|walls| vec![1; walls.len()]).collect();
    for n in 1..layers.len() {
        let k = block.layers.start + n;
        if thin(k) {
            continue;
        }
        for (i, wall) in layers[n].iter().enumerate().filter(|(_, w)| w.depth > 0 && w.closed) {
            if grouping.ends(grouping.wall_phase(wall.depth), k - 1, block) {
                continue;
            }
            let continues = |&j: &usize| {
                let below = &layers[n - 1][j];
                out[n - 1][j] > 0
                    && below.closed
                    && below.depth == wall.depth
                    && follow(&below.path, &wall.path, tolerance)
            };
            if let Some(j) = (0..layers[n - 1].len()).find(continues) {
                out[n][i] += std::mem::take(&mut out[n - 1][j]);
            }
        }
    }
    out
}
