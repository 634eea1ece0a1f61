//! Leg and base -> Room: how much plastic fits under each part of a leg.
//!
//! The room is what lies between the base and the skin straight below it: spacing · free height · length
//! in plan. Neither the slope nor the length in space has a part in it (a leg that rises is longer, and
//! thinner at right angles to itself by the same share).
//!
//! The base is asked for its height on a grid of a tenth of a millimetre over the leg's width. Sums along
//! the leg then tell the room of any part of it, and no plastic is lost or counted twice where it is cut.

use super::relief::Base;
use super::runs::Leg;
use crate::geom::Point;
use crate::geom::segment::along;
use crate::units::{Coord, nearest};

/// The base is asked at places so far apart at most (0.1 mm): steps of a staircase are wider than that
/// on all slopes that skins may have.
const STEP: f64 = 1_000.0;

/// Sums along a leg: the area in plan and the room, grid units² and ³.
#[derive(Debug)]
pub(super) struct Room {
    step: f64,
    /// Area and room from the leg's beginning to each multiple of the step.
    sums: Vec<[f64; 2]>,
}

impl Room {
    /// Over `base`, of a leg whose top is at `z` after a way along it.
    pub(super) fn new(leg: &Leg, z: impl Fn(f64) -> f64, base: &dyn Base) -> Self {
        let length = leg.from.distance(leg.to);
        let count = (length / STEP).ceil().max(1.0);
        let step = length / count;
        let [a, b] = [leg.from, leg.to].map(|p| [f64::from(p.x), f64::from(p.y)]);
        let way = [(b[0] - a[0]) / length, (b[1] - a[1]) / length];
        let across = [-way[1], way[0]];
        let mut sums = Vec::with_capacity(count as usize + 1);
        let mut sum = [0.0, 0.0];
        sums.push(sum);
        for k in 0..count as usize {
            let s = (k as f64 + 0.5) * step;
            let width = leg.widths[0] + (leg.widths[1] - leg.widths[0]) * s / length;
            let middle = along(a, s, way);
            let asked = (width / STEP).ceil().max(1.0);
            let off = |m: usize| ((m as f64 + 0.5) / asked - 0.5) * width;
            let heights = (0..asked as usize).map(|m| below(base, along(middle, off(m), across)));
            let free = z(s) - heights.sum::<f64>() / asked;
            sum = [sum[0] + width * step, sum[1] + width * step * free.max(0.0)];
            sums.push(sum);
        }
        Self { step, sums }
    }

    /// Area and room from the leg's beginning to `s`.
    fn until(&self, s: f64) -> [f64; 2] {
        let last = self.sums.len() - 1;
        let k = ((s / self.step) as usize).min(last.saturating_sub(1));
        let part = (s / self.step - k as f64).clamp(0.0, 1.0);
        let [low, high] = [self.sums[k], self.sums[(k + 1).min(last)]];
        [0, 1].map(|i| low[i] + (high[i] - low[i]) * part)
    }

    /// Area and room of a part of the leg.
    pub(super) fn of(&self, [start, end]: [f64; 2]) -> [f64; 2] {
        let [low, high] = [self.until(start), self.until(end)];
        [high[0] - low[0], high[1] - low[1]]
    }

    /// The mean free height over a part of the leg.
    pub(super) fn height(&self, part: [f64; 2]) -> f64 {
        let [area, room] = self.of(part);
        if area > 0.0 { room / area } else { 0.0 }
    }
}

/// How high the base stands at a place; the bed's height where nothing stands.
fn below(base: &dyn Base, [x, y]: [f64; 2]) -> f64 {
    let height = base.height(Point { x: nearest(x) as Coord, y: nearest(y) as Coord });
    if height.is_finite() { height } else { 0.0 }
}
