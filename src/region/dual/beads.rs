//! Beads in narrow rooms of a block of layers -> which stretches of them are printed once for several layers.
//!
//! Such a room is solid on every layer, and where its walls stand upright it has the same beads on each.
//! The uppermost layer of a group then prints them for all, as it does with lines. A bead *goes on* where
//! one of the layer below lies right under it and is as wide; elsewhere each layer prints its own.

use super::groups::{Block, Grouping};
use crate::geom::Point;
use crate::geom::frame::Frame;
use crate::geom::polyline::{LinePoint, Polyline};
use crate::geom::segment::distance2;
use crate::region::sides::{Side, Sides};
use crate::region::stretches::{Smooth, parted, stretches};
use crate::units::Coord;

/// Beads of two layers are printed at once if they are at most this far apart, and one at most so much
/// wider than the other, in line widths: 0.04 mm. More leaves gaps to the walls on slopes; less shares
/// nothing but upright rooms.
const ALIKE: f64 = 0.1;

/// A shorter stretch that differs between two that are alike is printed with these, in line widths. Beads
/// of two layers have their corners at other places.
const CLOSE: f64 = 2.5;

/// Shorter stretches are not worth a change of height, in line widths.
const LEAST: f64 = 12.0;

/// Beads of a layer by the number of layers that they are printed for.
pub type Counted = Vec<(u32, Vec<Polyline>)>;

/// For each layer of `block` its beads by the number of layers that they are printed for: the layer and those
/// below it. `layers` are their beads, each in a frame. Layers that have to be `thin` print nothing for others.
#[must_use]
pub fn share(
    block: &Block,
    layers: &[(Frame, &[Polyline])],
    grouping: &Grouping,
    thin: &dyn Fn(usize) -> bool,
    line_width: Coord,
) -> Vec<Counted> {
    let mut out: Vec<Counted> = Vec::with_capacity(layers.len());
    for (n, &(frame, beads)) in layers.iter().enumerate() {
        let k = block.layers.start + n;
        let mut own = beads.to_vec();
        let mut counted = Counted::new();
        let goes_on = n > 0 && !thin(k) && !grouping.ends(0, k - 1, block);
        for (count, lower) in out.last_mut().filter(|_| goes_on).into_iter().flatten() {
            let turn = Turn { from: layers[n - 1].0, to: frame };
            let both = taken_over(&mut own, lower, &turn, line_width);
            if !both.is_empty() {
                counted.push((*count + 1, both));
            }
        }
        counted.push((1, own));
        out.push(counted);
    }
    out
}

/// Takes the stretches that are alike out of the beads of a layer and of the one below it. They are those
/// of the upper one.
fn taken_over(
    own: &mut Vec<Polyline>,
    lower: &mut Vec<Polyline>,
    turn: &Turn,
    line_width: Coord,
) -> Vec<Polyline> {
    let w = f64::from(line_width);
    let below: Vec<Polyline> =
        lower.iter().map(|bead| bead.iter().map(|p| turn.enter(p)).collect()).collect();
    let Some(under) = Under::new(&below, w) else { return Vec::new() };
    let smooth = Smooth { close: CLOSE * w, least: LEAST * w, ..Smooth::default() };
    let divided = own.iter().flat_map(|bead| stretches(bead, line_width, smooth, |p| under.has(p)));
    let [both, alone] = parted(divided);
    *own = alone;
    if let Some(over) = Under::new(&both, w) {
        let smooth = Smooth { close: CLOSE * w, ..Smooth::default() };
        let is_taken = |p: &LinePoint| over.has(&turn.enter(p));
        let divided = lower.iter().flat_map(|bead| stretches(bead, line_width, smooth, is_taken));
        let [_, left] = parted(divided);
        *lower = left;
    }
    both
}

/// From the frame of one layer to that of another.
struct Turn {
    from: Frame,
    to: Frame,
}

impl Turn {
    fn enter(&self, p: &LinePoint) -> LinePoint {
        let at = self.to.enter(self.from.leave(Point { x: p.u, y: p.v }));
        LinePoint { u: at.x, v: at.y, width: p.width }
    }
}

/// The sides of the beads of another layer.
struct Under {
    sides: Sides,
    far: f64,
}

impl Under {
    /// `None` without any beads.
    fn new(beads: &[Polyline], line_width: f64) -> Option<Self> {
        let at = |p: &LinePoint| [f64::from(p.u), f64::from(p.v)];
        let pairs = beads.iter().flat_map(|bead| bead.windows(2));
        let side = |pair: &[LinePoint]| ([at(&pair[0]), at(&pair[1])], f64::from(pair[1].width));
        let all: Vec<Side> = pairs.map(side).collect();
        let far = ALIKE * line_width;
        (!all.is_empty()).then(|| Self { sides: Sides::new(all, 4.0 * line_width), far })
    }

    /// Whether a bead as wide as at `p` runs there.
    fn has(&self, p: &LinePoint) -> bool {
        let (at, width) = ([f64::from(p.u), f64::from(p.v)], f64::from(p.width));
        self.sides.near(at, self.far).any(|(edge, other)| {
            (width - other).abs() <= self.far && distance2(at, *edge) <= self.far * self.far
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::polyline::length;
    use crate::profile::{self, DualMode};

    const W: Coord = 4_000;

    fn bead(ends: &[(Coord, Coord)]) -> Polyline {
        ends.iter().map(|&(u, v)| LinePoint { u, v, width: W }).collect()
    }

    fn lengths(counted: &[Counted]) -> Vec<Vec<(u32, i64)>> {
        let sum = |beads: &[Polyline]| beads.iter().map(|bead| length(bead)).sum();
        let layer = |counted: &Counted| -> Vec<(u32, i64)> {
            counted.iter().map(|(count, beads)| (*count, sum(beads))).collect()
        };
        counted.iter().map(layer).collect()
    }

    /// What two layers print, of which the upper is turned by a quarter.
    fn printed(lower: &[Polyline], upper: &[Polyline], thin: bool) -> Vec<Vec<(u32, i64)>> {
        let mut dual = profile::load(["generic-marlin"], &[]).unwrap().settings.dual;
        dual.mode = DualMode::Pair;
        let grouping = Grouping::new(&dual, 2);
        let block = grouping.block(4, 100);
        let [along, across] = [0.0, 90.0].map(Frame::new);
        let turn = Turn { from: along, to: across };
        let upper: Vec<Polyline> =
            upper.iter().map(|bead| bead.iter().map(|p| turn.enter(p)).collect()).collect();
        let layers = [(along, lower), (across, upper.as_slice())];
        lengths(&share(&block, &layers, &grouping, &|_| thin, W))
    }

    #[test]
    fn what_lies_right_above_is_printed_once() {
        let ring = bead(&[(0, 0), (90_000, 0), (90_000, 50_000), (0, 50_000), (0, 0)]);
        let beads = [ring];
        assert_eq!(printed(&beads, &beads, false), [vec![(1, 0)], vec![(2, 280_000), (1, 0)]]);
        assert_eq!(printed(&beads, &beads, true), [[(1, 280_000)], [(1, 280_000)]]);
    }

    #[test]
    fn what_differs_is_printed_by_each_layer() {
        let lower = [bead(&[(0, 0), (100_000, 0)])];
        // The upper one leans away from the middle on, by a tenth of a line after 40 000.
        let upper = [bead(&[(0, 100), (50_000, 100), (100_000, 600)])];
        let found = printed(&lower, &upper, false);
        let ((both, alone), left) = ((found[1][0], found[1][1]), found[0][0]);
        assert!(both.0 == 2 && (78_000..=82_000).contains(&both.1), "{found:?}");
        assert!(alone.1 + both.1 >= 100_000, "{found:?}");
        assert!((left.1 - alone.1).abs() <= i64::from(W), "{found:?}");
        // Another width differs as well.
        let wide = upper[0].iter().map(|p| LinePoint { width: W + 500, ..*p }).collect();
        assert_eq!(printed(&lower, &[wide], false)[0], [(1, 100_000)]);
    }
}
