//! Leg and base -> Room: how much plastic fits under each part of a leg.
//!
//! The room is what lies between the base and the skin straight below it: spacing · free height · length
//! in plan. Neither the slope nor the length in space has a part in it (a leg that rises is longer, and
//! thinner at right angles to itself by the same share).
//!
//! The base is asked for its height at places all along the leg, and across it. Sums along the leg then
//! tell the room of any part of it, and no plastic is lost or counted twice where it is cut.

use super::relief::Base;
use super::runs::Leg;
use crate::geom::Point;
use crate::geom::segment::along;
use crate::units::{Coord, nearest};

/// The base is asked at places so far apart along a leg at most (0.05 mm): all lines along a slope meet
/// the steps of a staircase at the same places, so that what is missed there adds up.
const STEP: f64 = 500.0;

/// Bases that leave a plane by less than this (1 µm) between the sides of a leg are one there. Others are
/// asked at places a `STEP` apart.
const PLANE: f64 = 10.0;

/// Three places across a leg tell whether the base is a plane: the middle, and two so far from it, in
/// widths. At a half they would lie on the edge of the skin.
const SIDE: f64 = 0.45;

/// A base that lies lower beside a leg's middle by more than so many heights of a skin ends there: that is
/// the edge of the part, beside which there is nothing to fill. Steps of a staircase are one layer high,
/// and on the steepest slope there are two of them under half a line.
const CLIFF: f64 = 2.0;

/// Sums along a leg: the area in plan and the room, grid units² and ³.
#[derive(Debug)]
pub(super) struct Room {
    step: f64,
    /// Area and room from the leg's beginning to each multiple of the step.
    sums: Vec<[f64; 2]>,
}

impl Room {
    /// Over `base`, of a leg whose top is at `z` after a way along it, in a skin of this height. Ways are asked
    /// for in order.
    pub(super) fn new(
        leg: &Leg,
        mut z: impl FnMut(f64) -> f64,
        base: &dyn Base,
        skin: Coord,
    ) -> Self {
        let cliff = CLIFF * f64::from(skin);
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
            let free = z(s) - mean(|off| below(base, along(middle, off, across)), width, cliff);
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

/// The mean height across a leg of this width; `height` is that beside its middle.
fn mean(height: impl Fn(f64) -> f64, width: f64, cliff: f64) -> f64 {
    let middle = height(0.0);
    let beside = |off: f64| Some(height(off)).filter(|h| *h > middle - cliff).unwrap_or(middle);
    let (left, right) = (beside(-SIDE * width), beside(SIDE * width));
    if (left + right - 2.0 * middle).abs() <= PLANE {
        return middle;
    }
    let count = (width / STEP).ceil().max(1.0);
    let heights = (0..count as usize).map(|k| beside(((k as f64 + 0.5) / count - 0.5) * width));
    heights.sum::<f64>() / count
}

/// How high the base stands at a place; the bed's height where nothing stands.
fn below(base: &dyn Base, [x, y]: [f64; 2]) -> f64 {
    let height = base.height(Point { x: nearest(x) as Coord, y: nearest(y) as Coord });
    if height.is_finite() { height } else { 0.0 }
}
