//! Layer and patches -> Layer: takes the room of the skins away from a layer's section.
//!
//! Words: S is the height of a patch's surface over a place, h the height of a skin, n the number of skins.
//! The areas of the skins, A1 to An, are counted from the lowest; each lies in the next. The *base* is what
//! is printed level below them: where skins i and higher lie, it ends (n + 1 − i)·h straight below S.
//!
//! A layer is cut at its middle, zp. For every skin, it loses the places of Ai where
//! zp − 2h < S < zp + (n + 1 − i)·h, of all patches (less what the base is raised by, see
//! [`NonPlanarParams::raised`](super::params::NonPlanarParams::raised)). The upper bound is what a slicer would leave of a part
//! lowered by so much, whose corners at zp count as above it. The lower bound leaves the roof that stands
//! higher above the patch. The section ends where S = zp, well within what is taken away, so that rounding
//! leaves nothing there. Where the patch ends at an upright side of the part, the section was simplified
//! and the patch's outline was not: what is left there is thin. Of what is left and of what is taken, places
//! thinner than a tenth of a usual line go: no bead fits into them, and walls would bend around them.
//! Where the part's outline is moved outwards, a rim of that width would stand beside the skins, in treads:
//! it is taken as well.

use super::surface::Surface;
use crate::geom::boxes::{extent, meet};
use crate::geom::{Contour, polygon};
use crate::region::curved::CurvedTops;
use crate::slice::Layer;
use crate::units::Coord;

/// Nothing of the part stands above an accepted patch so near: so many skin heights are taken with it.
const ABOVE: Coord = 2;

/// Half the width of what is too thin to be left or taken, grid units: 0.02 mm.
const THIN: Coord = 200;

/// The cotangent of half the angle of a corner of 40°. A sharper one may end in a thin tip.
const SHARP: f64 = 2.747;

/// Contours are simplified within this, grid units: 2 µm.
const TOLERANCE: Coord = 20;

/// The skins of a patch.
#[derive(Debug)]
pub struct Lowered<'a> {
    /// Their surface.
    pub surface: &'a Surface,
    /// Where each skin lies in plan, from the lowest up; each within the next. As from a union.
    pub areas: Vec<Vec<Contour>>,
    /// Height of a skin, grid units.
    pub height: Coord,
    /// The base ends so much higher, grid units.
    pub raised: Coord,
    /// The part's outline is moved outwards by this, grid units: beside the skins nothing of that stands.
    pub grown: Coord,
    /// Walls of the base reach so far beyond its contours, grid units: their room is taken, too.
    pub beyond: Coord,
}

/// The patches of a print, and what is left of its layers under them.
#[derive(Debug, Default)]
pub struct Base<'a> {
    patches: Vec<Lowered<'a>>,
}

impl<'a> Base<'a> {
    /// The base under some patches.
    #[must_use]
    pub fn new(patches: Vec<Lowered<'a>>) -> Self {
        Self { patches }
    }

    /// A layer without the room of the skins. One that no patch reaches into comes back as it is.
    #[must_use]
    pub fn cut(&self, layer: Layer) -> Layer {
        let plane = layer.z - layer.height / 2;
        let taken = self.taken(plane, &layer.contours);
        if taken.is_empty() {
            return layer;
        }
        let left = polygon::difference(&layer.contours, &taken, TOLERANCE);
        Layer { contours: without_thin(left), ..layer }
    }

    /// The room of all skins at a height, as far as it may meet some contours.
    fn taken(&self, plane: Coord, contours: &[Contour]) -> Vec<Contour> {
        let near = |patch: &&Lowered<'_>| {
            let [low, high] = patch.surface.bounds();
            let up = patch.up(0);
            low < plane.saturating_add(up) && high > plane.saturating_sub(ABOVE * patch.height)
        };
        let mut patches = self.patches.iter().filter(near).peekable();
        // Boxes are looked at only where heights meet.
        let around = patches.peek().and_then(|_| extent(contours.iter().flatten()));
        let Some(around) = around else { return Vec::new() };
        let beside = |patch: &&Lowered<'_>| meet(patch.surface.extent(), around);
        let rooms: Vec<Contour> =
            patches.filter(beside).flat_map(|patch| patch.room(plane)).collect();
        if rooms.is_empty() { rooms } else { without_thin(polygon::union(&rooms)) }
    }
}

impl CurvedTops for Base<'_> {
    fn cut(&self, layer: Layer) -> Layer {
        Base::cut(self, layer)
    }

    fn over(&self, from: Coord, below: Coord) -> Vec<Contour> {
        let over = |patch: &Lowered<'_>| patch.over(from, below);
        let all: Vec<Contour> = self.patches.iter().flat_map(over).collect();
        if all.is_empty() { all } else { polygon::union(&all) }
    }
}

impl Lowered<'_> {
    /// Where the underside of the skins lies at `from` or higher and lower than `below`; may overlap.
    fn over(&self, from: Coord, below: Coord) -> Vec<Contour> {
        let [low, high] = self.surface.bounds();
        let most = self.up(0);
        if low.saturating_sub(most) >= below || high < from {
            return Vec::new();
        }
        let of = |(k, area): (usize, &Vec<Contour>)| {
            let up = self.up(k);
            let band = self.surface.between(from.saturating_add(up), below.saturating_add(up));
            if band.is_empty() { band } else { polygon::intersection(&band, area) }
        };
        self.areas.iter().enumerate().flat_map(of).collect()
    }

    /// How far below the surface the base ends where skin `k`, counted from 0 at the lowest, is the lowest.
    fn up(&self, k: usize) -> Coord {
        let skins = Coord::try_from(self.areas.len() - k.min(self.areas.len())).unwrap_or(0);
        skins.saturating_mul(self.height).saturating_sub(self.raised)
    }

    /// The room of the skins at a height, in plan; may overlap.
    fn room(&self, plane: Coord) -> Vec<Contour> {
        let from = plane.saturating_sub(ABOVE * self.height).saturating_add(1);
        let mut out = Vec::new();
        for (k, area) in self.areas.iter().enumerate() {
            let band = self.surface.between(from, plane.saturating_add(self.up(k)));
            if band.is_empty() || area == self.surface.outline() {
                out.extend(band);
            } else {
                out.extend(polygon::intersection(&band, area));
            }
        }
        if self.grown > 0 && !out.is_empty() {
            // A little more, for contours that were simplified.
            let by = self.grown + THIN;
            let beside = polygon::outset(&polygon::union(&out), by);
            let beside = polygon::intersection(&beside, &self.surface.near_upright(by));
            out.extend(polygon::difference(&beside, self.surface.outline(), TOLERANCE));
        }
        if self.beyond > 0 && !out.is_empty() {
            out = polygon::outset(&polygon::union(&out), self.beyond);
        }
        out
    }
}

/// What is left of contours without places thinner than twice [`THIN`].
fn without_thin(contours: Vec<Contour>) -> Vec<Contour> {
    if is_thick(&contours) {
        return contours;
    }
    let cores = polygon::inset(&contours, THIN);
    // Further out than they were moved in, so that all but thin places keeps its outline, sharp corners too.
    let around = polygon::outset(&cores, 4 * THIN);
    let thin = polygon::difference(&contours, &around, 1);
    if thin.is_empty() { contours } else { polygon::intersection(&contours, &around) }
}

/// Whether contours certainly have no thin places: moved in, each keeps all its sides and meets no other, and no
/// corner is so sharp that its tip would be thin.
fn is_thick(contours: &[Contour]) -> bool {
    polygon::sharpest(contours) < SHARP && polygon::keep_shape(contours, THIN, 0.0)
}
