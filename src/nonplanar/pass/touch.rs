//! A touch of the head -> whether it is allowed, and what is touched.
//!
//! Allowed is *press*: near the middle of the nozzle, no deeper than the rule of
//! [`Head::presses`](crate::head::Head::presses), and into the same smooth surface: its base, its skins,
//! or what of it is printed flat. Such a cell stands no more than half a layer over the surface, by which
//! a tread of a staircase does. Beside the surface stands a plateau that continues it, if it is no higher
//! than the slope under the nozzle would go on.

use crate::geom::Point;
use crate::head::pile::Hit;
use crate::nonplanar::field::Field;
use crate::nonplanar::grid::{CELL, Spot};
use crate::nonplanar::scene::Scene;
use crate::nonplanar::tally::Reason;
use crate::units::{Coord, to_mm, to_units};

/// Half a layer, and a quarter for rounding, bends of the surface and the walls of a cell: shares of a
/// layer's height.
const TREAD: f64 = 0.75;

/// What is touched, and whether it may be.
#[derive(Clone, Copy)]
pub(super) struct Touch<'a> {
    pub scene: &'a Scene<'a>,
    pub field: &'a Field,
    /// Press is no deeper than on layers of this height, mm.
    pub layer: f64,
}

/// The cell around a place, mm.
pub(super) fn cell_at(at: [f64; 2]) -> Spot {
    let along = |v: f64| (v / to_mm(CELL)).round() as i32;
    [along(at[0]), along(at[1])]
}

impl Touch<'_> {
    /// Whether a touch is press. The tip is at a place of the surface, or straight below it.
    pub(super) fn is_press(&self, hit: &Hit) -> bool {
        self.scene.params.head.presses(hit, self.layer) && self.is_own(hit)
    }

    /// Whether a cell that stands so high, mm, is the surface or its base.
    pub(super) fn is_surface(&self, cell: Spot, height: f64) -> bool {
        self.field.at(cell).is_some_and(|z| height <= mm(z) + self.tread())
    }

    /// How far what is printed flat may stand over the surface, mm.
    fn tread(&self) -> f64 {
        TREAD * to_mm(self.scene.params.height)
    }

    /// Whether what is touched is the surface, or continues it.
    fn is_own(&self, hit: &Hit) -> bool {
        let at = cell_at(hit.at);
        let level = match self.field.at(at) {
            Some(z) => z,
            None => {
                let tip = cell_at([hit.tip[0], hit.tip[1]]);
                let Some(z) = self.field.at(tip) else { return false };
                let [x, y] = self.field.rise(tip);
                let by = [0, 1].map(|axis| f64::from((at[axis] - tip[axis]) * CELL));
                z + (x * by[0] + y * by[1]).max(0.0)
            }
        };
        hit.height <= mm(level) + self.tread()
    }

    /// Why a touch refuses a place. `is_support` tells whether support stood at a cell.
    pub(super) fn reason(&self, hit: &Hit, is_support: impl Fn(Spot) -> bool) -> Reason {
        let cell = cell_at(hit.at);
        let own = self.field.at(cell).is_some() && self.is_own(hit);
        if own {
            Reason::Cone
        } else if is_support(cell) || self.body(hit.at) != self.body([hit.tip[0], hit.tip[1]]) {
            Reason::Neighbour
        } else {
            Reason::Obstacle
        }
    }

    /// The body at a place, mm.
    pub(super) fn body(&self, at: [f64; 2]) -> Option<usize> {
        self.scene.body(Point { x: to_units(at[0]), y: to_units(at[1]) })
    }
}

/// A height in grid units as mm.
pub(super) fn mm(z: f64) -> f64 {
    z / crate::units::UNITS_PER_MM
}

/// A height in mm as grid units, rounded up.
pub(super) fn up(z: f64) -> Coord {
    (z * crate::units::UNITS_PER_MM).ceil() as Coord
}
