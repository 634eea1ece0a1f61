//! Head: what hangs around the nozzle's tip, and what it may touch.
//!
//! All lengths are mm, seen from the middle of the nozzle's hole, z upwards from its tip. Words:
//!
//! - The *flat* is the level face round the hole; the *cone* is the nozzle's flank, which rises from the
//!   flat's edge and ends at its length: above that nothing hangs but discs and boxes.
//! - *Discs* are round parts about the nozzle's axis, such as its hexagon and its collar. *Boxes* hang
//!   beside it: the heater block, ducts, a probe.
//! - The *underside* is the lowest place of the head over a point of the bed. All above it is taken.
//! - *Press* is a touch that does no harm: on a slope the flat's uphill edge goes into soft plastic.
//!
//! [`Pile`](pile::Pile) holds what stands, and tells what a head touches; [`sweep`] moves it.

#[cfg(test)]
mod laws;
pub mod named;
pub mod pile;
pub mod shape;
pub mod sweep;

use pile::Hit;
use shape::Shape;

/// What hangs around the nozzle's tip.
#[derive(Debug, Clone, PartialEq)]
pub struct Head {
    /// Diameter of the level face round the hole, mm.
    pub flat: f64,
    /// Flank of the nozzle above the horizontal, degrees; from 90 on there is none.
    pub cone: f64,
    /// Height of the flank, mm.
    pub cone_length: f64,
    /// Radius and underside of round parts about the nozzle's axis, mm.
    pub discs: Vec<[f64; 2]>,
    /// `[x0, y0, x1, y1, z]` of parts that hang beside it, mm; x0 <= x1 and y0 <= y1.
    pub boxes: Vec<[f64; 5]>,
}

/// A part of the head.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// The level face round the hole.
    Flat,
    /// The flank of the nozzle.
    Cone,
    /// A disc, counted from 0.
    Disc(usize),
    /// A box, counted from 0.
    Box(usize),
}

/// How deep a press may be, in layer heights: one for the slope, and half a one by which the tread of a
/// staircase stands over its surface.
pub const DEEPEST_PRESS: f64 = 1.5;

impl Head {
    /// The steepest plane through the tip that cone and discs leave free, degrees. Boxes do not count: only
    /// a surface so large that it rises up to a box meets one. Beside the flat a plane always presses: the
    /// cone counts from the edge of the ring where a touch may be press, [`Self::press_radius`].
    #[must_use]
    pub fn steepest(&self) -> f64 {
        let shape = Shape::of(self);
        let from = self.press_radius();
        let flank = if from > 0.0 { atan(shape.rise(from), from) } else { self.cone };
        let cone = (shape.cone_end > from).then_some(flank);
        let discs = self.discs.iter().map(|&[radius, z]| atan(z, radius));
        cone.into_iter().chain(discs).fold(90.0, f64::min)
    }

    /// The steepest plane through the tip on which the flat's uphill edge presses no deeper than `most`,
    /// degrees.
    #[must_use]
    pub fn steepest_press(&self, most: f64) -> f64 {
        atan(most, self.flat / 2.0)
    }

    /// How far from its middle a touch may be press: twice the flat's radius, mm.
    #[must_use]
    pub fn press_radius(&self) -> f64 {
        self.flat
    }

    /// Whether a touch is press, which is allowed while printing layers of this height, mm.
    #[must_use]
    pub fn presses(&self, hit: &Hit, layer_height: f64) -> bool {
        let by = [hit.at[0] - hit.tip[0], hit.at[1] - hit.tip[1]];
        length(by) <= self.press_radius() && hit.depth <= DEEPEST_PRESS * layer_height
    }

    /// The same head turned by half a turn: what it touches at the tip, the tip touches with it.
    #[must_use]
    pub fn mirrored(&self) -> Self {
        let turned = |&[x0, y0, x1, y1, z]: &[f64; 5]| [-x1, -y1, -x0, -y0, z];
        Self { boxes: self.boxes.iter().map(turned).collect(), ..self.clone() }
    }

    /// How far it reaches sideways, mm.
    #[must_use]
    pub fn reach(&self) -> f64 {
        let discs = self.discs.iter().map(|disc| disc[0]);
        let boxes = self.boxes.iter().map(|&area| furthest(area));
        discs.chain(boxes).fold(Shape::of(self).nozzle(), f64::max)
    }

    /// How far sideways it can touch what stands no higher than this above the tip, mm.
    #[must_use]
    pub fn reach_below(&self, height: f64) -> f64 {
        let rise = libm::tan(self.cone.min(90.0).to_radians()).max(f64::MIN_POSITIVE);
        let nozzle = self.flat / 2.0 + height.clamp(0.0, self.cone_length) / rise;
        let discs = self.discs.iter().filter(|disc| disc[1] < height).map(|disc| disc[0]);
        let boxes = self.boxes.iter().filter(|area| area[4] < height).map(|&area| furthest(area));
        discs.chain(boxes).fold(nozzle, f64::max)
    }

    /// The underside over the place `by` beside the tip, mm above it, and its part; `None` beyond its reach.
    #[must_use]
    pub fn underside(&self, by: [f64; 2]) -> Option<(f64, Part)> {
        let (z, part) = Shape::of(self).lowest(by, by);
        part.map(|part| (z, part))
    }
}

/// The slope of a plane that rises `z` over `run`, degrees.
fn atan(z: f64, run: f64) -> f64 {
    libm::atan2(z, run).to_degrees()
}

fn length([x, y]: [f64; 2]) -> f64 {
    // Monotone in either, which `hypot` need not be.
    (x * x + y * y).sqrt()
}

/// The distance of a box's furthest corner from the tip.
fn furthest([x0, y0, x1, y1, _]: [f64; 5]) -> f64 {
    length([x0.abs().max(x1.abs()), y0.abs().max(y1.abs())])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::head::named::named;
    use proptest::prelude::*;

    pub(super) fn any_head() -> impl Strategy<Value = Head> {
        let disc = (0.5..20.0, 0.0..10.0).prop_map(|(radius, z)| [radius, z]);
        let beside = (-20.0..20.0, -20.0..20.0, 0.0..20.0, 0.0..20.0, 0.0..10.0)
            .prop_map(|(x, y, w, h, z)| [x, y, x + w, y + h, z]);
        let some = |most| 0..=most;
        let lists = (prop::collection::vec(disc, some(2)), prop::collection::vec(beside, some(2)));
        (0.0..2.0, 1.0..95.0, 0.0..5.0, lists).prop_map(|(flat, cone, cone_length, lists)| Head {
            flat,
            cone,
            cone_length,
            discs: lists.0,
            boxes: lists.1,
        })
    }

    #[test]
    fn what_is_low_is_reached_from_near() {
        let long = named("long-0.6").unwrap();
        assert!((long.reach_below(2.0) - 0.5 - 2.0 / 3.0_f64.sqrt()).abs() < 1e-9);
        assert_eq!((long.reach_below(-1.0), long.reach_below(20.1)), (0.5, long.reach()));
        let v6 = named("v6").unwrap();
        assert_eq!([2.1, 5.1].map(|most| v6.reach_below(most)), [4.04, v6.reach()]);
    }

    #[test]
    fn the_underside_rises_from_flat_to_cone_to_disc_to_box() {
        let head = named("v6").unwrap();
        let at = |x, y| head.underside([x, y]);
        assert_eq!(at(0.3, 0.4), Some((0.0, Part::Flat)));
        let (z, part) = at(1.5, 0.0).unwrap();
        assert!((z - 1.0).abs() < 1e-9 && part == Part::Cone, "{z}");
        assert_eq!(at(0.0, 4.0), Some((2.0, Part::Disc(0))));
        assert_eq!(at(-10.0, 4.0), Some((5.0, Part::Box(0))));
        assert_eq!(at(10.0, 4.0), None);
        assert_eq!(head.mirrored().underside([10.0, 4.0]), Some((5.0, Part::Box(0))));
        assert!((head.reach() - 17.0).abs() < 1e-9);
        // The nozzle alone ends with its cone.
        let nozzle = Head { discs: Vec::new(), boxes: Vec::new(), ..head };
        assert_eq!(
            (nozzle.underside([2.6, 0.0]), Shape::of(&nozzle).lowest([2.6, 0.0], [3.0, 1.0]).0),
            (None, f64::INFINITY)
        );
        assert!((nozzle.reach() - 2.5).abs() < 1e-9);
    }

    #[test]
    fn the_steepest_slope_is_that_of_the_part_in_its_way() {
        let near =
            |angle: f64, right: f64| assert!((angle - right).abs() < 0.05, "{angle} {right}");
        let v6 = named("v6").unwrap();
        near(v6.steepest(), 26.3);
        near(v6.steepest_press(0.2), 21.8);
        near(named("cautious").unwrap().steepest(), 4.3);
        near(named("long-0.6").unwrap().steepest(), 40.9);
        // A flat cone is in the way itself.
        near(Head { cone: 3.0, ..v6.clone() }.steepest(), 1.5);
        near(Head { cone: 3.0, flat: 0.0, ..v6 }.steepest(), 3.0);
    }

    proptest! {
        #[test]
        fn over_a_rectangle_nothing_hangs_lower(
            head in any_head(), x in -25.0..25.0, y in -25.0..25.0, w in 0.0..9.0, h in 0.0..9.0,
        ) {
            let (low, high) = ([x, y], [x + w, y + h]);
            let over = Shape::of(&head).lowest(low, high).0;
            let mut least = f64::INFINITY;
            for i in 0..=30 {
                for j in 0..=30 {
                    let share = |at: i32, from: f64, to: f64| (from + f64::from(at) / 30.0 * (to - from)).min(to);
                    let z = head.underside([share(i, x, high[0]), share(j, y, high[1])]);
                    least = least.min(z.map_or(f64::INFINITY, |(z, _)| z));
                }
            }
            prop_assert!(over <= least, "{over} {least}");
        }
    }
}
