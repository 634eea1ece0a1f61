//! Arc -> the straight pieces that a printer drives.
//!
//! For what reads G2 and G3 and for what writes them, so that both see the same pieces: a file then
//! takes as long as its slicer said.

use nalgebra::{Matrix2, Vector2};
use std::f64::consts::TAU;

/// How far pieces leave the arc, mm: RepRapFirmware's MaxArcDeviation. At a radius of 5 mm so do those of
/// a current Marlin (72 a circle, 1 mm at most) and, at 25 mm, all that are 1 mm long whatever the radius,
/// as of older Marlins and of Klipper where nothing is set. Longer ones would make times and checks see
/// corners that the printer does not drive.
const TOLERANCE_MM: f64 = 0.005;

/// Most pieces of an arc, whatever its radius: a faulty file must not fill the memory.
pub const MOST_PIECES: f64 = 10_000.0;

/// By how much half the chord may be longer than the radius, mm: both are rounded in files.
const ROUNDING_MM: f64 = 0.01;

/// The same as a part of the radius: RepRapFirmware's, which refuses what is further apart.
const ROUNDING: f64 = 0.01;

/// An arc in the plane, mm.
#[derive(Debug, Clone, Copy)]
pub struct Arc {
    /// Where it begins.
    pub from: [f64; 2],
    /// Where it ends.
    pub to: [f64; 2],
    /// The middle of its circle.
    pub middle: [f64; 2],
    /// Whether it turns right (G2).
    pub clockwise: bool,
}

impl Arc {
    /// The arc of this radius; a negative one is the long way round. Ends as far apart as two radii
    /// make a half circle. `None` if they are the same or further apart.
    #[must_use]
    pub fn by_radius(from: [f64; 2], to: [f64; 2], radius: f64, clockwise: bool) -> Option<Self> {
        let (start, end) = (Vector2::from(from), Vector2::from(to));
        let chord = end - start;
        let square = chord.norm_squared();
        let is_far = 0.5 * square.sqrt() > radius.abs() + ROUNDING_MM.max(ROUNDING * radius.abs());
        let beside = (radius * radius / square - 0.25).max(0.0);
        if !(square > 0.0 && beside.is_finite()) || is_far {
            return None;
        }
        let side = if clockwise == (radius > 0.0) { -beside.sqrt() } else { beside.sqrt() };
        let middle = (0.5 * (start + end) + side * Vector2::new(-chord.y, chord.x)).into();
        Some(Self { from, to, middle, clockwise })
    }

    /// The ends of its pieces; the last one is `to`, exactly. Ends that are the same make a full circle.
    pub fn points(&self) -> impl Iterator<Item = [f64; 2]> + use<> {
        self.divided(self.pieces(0.0).min(MOST_PIECES) as u32, 0.0)
    }

    /// How many pieces keep within the tolerance, with so many turns more.
    #[must_use]
    pub fn pieces(&self, turns: f64) -> f64 {
        let radius = (Vector2::from(self.from) - Vector2::from(self.middle)).norm();
        let piece = (8.0 * TOLERANCE_MM * radius).sqrt();
        // An arc of no radius has no piece: 0 by 0 is no number, which `max` replaces.
        (self.turn(turns).abs() * radius / piece).max(1.0).ceil()
    }

    /// The ends of `count` pieces, with so many turns more.
    pub fn divided(&self, count: u32, turns: f64) -> impl Iterator<Item = [f64; 2]> + use<> {
        let (arc, turn) = (*self, self.turn(turns));
        let middle = Vector2::from(arc.middle);
        let start = Vector2::from(arc.from) - middle;
        (1..=count).map(move |k| {
            if k == count {
                return arc.to;
            }
            let (sin, cos) = libm::sincos(turn * f64::from(k) / f64::from(count));
            (middle + Matrix2::new(cos, -sin, sin, cos) * start).into()
        })
    }

    /// How far it turns, radians; left is positive.
    fn turn(&self, more: f64) -> f64 {
        let middle = Vector2::from(self.middle);
        let (start, end) = (Vector2::from(self.from) - middle, Vector2::from(self.to) - middle);
        let mut turn = libm::atan2(start.perp(&end), start.dot(&end));
        if self.from == self.to {
            turn = 0.0;
        }
        if self.clockwise {
            (if turn >= 0.0 { turn - TAU } else { turn }) - more * TAU
        } else {
            (if turn <= 0.0 { turn + TAU } else { turn }) + more * TAU
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn length(arc: &Arc) -> f64 {
        let mut at = arc.from;
        let mut sum = 0.0;
        for to in arc.points() {
            sum += ((to[0] - at[0]).powi(2) + (to[1] - at[1]).powi(2)).sqrt();
            at = to;
        }
        assert_eq!(at, arc.to);
        sum
    }

    #[test]
    fn lengths_of_arcs() {
        let quarter =
            |clockwise| Arc { from: [10.0, 0.0], to: [0.0, 10.0], middle: [0.0, 0.0], clockwise };
        let about = |a: f64, b: f64| assert!((a - b).abs() < 0.002 * b, "{a} {b}");
        about(length(&quarter(false)), TAU * 2.5);
        about(length(&quarter(true)), TAU * 7.5);
        let circle = Arc { to: [10.0, 0.0], ..quarter(true) };
        about(length(&circle), TAU * 10.0);
        for (radius, clockwise, turn) in
            [(10.0, false, 2.5), (-10.0, false, 7.5), (10.0, true, 2.5), (-10.0, true, 7.5)]
        {
            let arc = Arc::by_radius([10.0, 0.0], [0.0, 10.0], radius, clockwise).unwrap();
            about(length(&arc), TAU * turn);
        }
        // A radius that was rounded down.
        for clockwise in [false, true] {
            let arc = Arc::by_radius([0.0, 0.0], [10.0, 0.0], 4.9995, clockwise).unwrap();
            about(length(&arc), TAU * 2.5);
        }
        let huge = Arc { from: [0.0; 2], to: [0.0; 2], middle: [99_999.0, 0.0], clockwise: true };
        about(length(&huge), TAU * 99_999.0);
        assert!(huge.points().count() <= 10_000);
        assert!(Arc::by_radius([0.0, 0.0], [10.0, 0.0], 4.0, true).is_none());
        assert!(Arc::by_radius([0.0, 0.0], [0.0, 0.0], 4.0, true).is_none());
    }
}
