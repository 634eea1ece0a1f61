//! Regions -> Tally: what the layers of a print add up to, beside what is extruded.

use crate::region::Region;
use crate::units::{Coord, to_mm};
use crate::warning::Warning;

/// Thin places of a layer are counted from this area on, mm². Smaller ones are rounding and the
/// tips of corners, not the shape of the part.
const LEAST_THIN_MM2: f64 = 1.0;

/// What the layers of a print add up to.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Tally {
    open_layers: usize,
    longest_gap: Coord,
    thin_layers: usize,
    thin_mm2: f64,
    solid_mm3: f64,
}

impl Tally {
    /// Adds one layer.
    pub fn layer(&mut self, region: &Region) {
        if region.layer.closed_gap > 0 {
            self.open_layers += 1;
            self.longest_gap = self.longest_gap.max(region.layer.closed_gap);
        }
        self.solid_mm3 += region.layer.volume_mm3();
        if region.thin_mm2 > LEAST_THIN_MM2 {
            self.thin_layers += 1;
            self.thin_mm2 += region.thin_mm2;
        }
    }

    /// What the contours of all layers enclose, mm³.
    #[must_use]
    pub fn solid_mm3(&self) -> f64 {
        self.solid_mm3
    }

    /// Warns of what the layers could not be printed as they are.
    pub fn warnings(self) -> impl Iterator<Item = Warning> {
        let open = (self.open_layers > 0).then(|| Warning::OpenContours {
            layers: self.open_layers,
            longest_gap_mm: to_mm(self.longest_gap),
        });
        let thin = (self.thin_layers > 0)
            .then_some(Warning::ThinPlaces { layers: self.thin_layers, area_mm2: self.thin_mm2 });
        open.into_iter().chain(thin)
    }
}
