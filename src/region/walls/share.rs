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
/// of the next layer that runs along it. Layers that have to be `thin` print nothing for others, and a
/// wall that `fills` a room, by its layer and number, is none here: it is laid with the beads of rooms.
#[must_use]
pub fn share(
    block: &Block,
    layers: &[&[Wall]],
    grouping: &Grouping,
    thin: &dyn Fn(usize) -> bool,
    fills: &dyn Fn(usize, usize) -> bool,
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
            if fills(k, i) || grouping.ends(grouping.wall_phase(wall.depth), k - 1, block) {
                continue;
            }
            let continues = |&j: &usize| {
                let below = &layers[n - 1][j];
                out[n - 1][j] > 0
                    && !fills(k - 1, j)
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Point;
    use crate::profile::{self, DualMode};
    use crate::region::RegionParams;

    #[test]
    fn a_wall_that_fills_a_room_on_one_layer_is_shared_with_none() {
        let mut settings = profile::load(["generic-marlin"], &[]).unwrap().settings;
        settings.dual.mode = DualMode::Pair;
        let params = RegionParams::new(&settings).walls;
        let grouping = Grouping::new(&settings.dual, 2);
        let p = |x, y| Point { x, y };
        let square = vec![p(0, 0), p(90_000, 0), p(90_000, 90_000), p(0, 90_000)];
        let wall = Wall { path: square, widths: Vec::new(), closed: true, depth: 2, layers: 1 };
        let walls = [wall];
        let counts = |filling: Option<usize>| {
            let fills = |k: usize, _: usize| Some(k) == filling;
            let block = grouping.block(4, 100);
            share(&block, &[&walls, &walls], &grouping, &|_| false, &fills, &params)
        };
        assert_eq!(counts(None), [[0], [2]]);
        assert_eq!(counts(Some(4)), [[1], [1]]);
        assert_eq!(counts(Some(5)), [[1], [1]]);
    }
}
