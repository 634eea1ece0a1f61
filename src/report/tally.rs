//! Regions -> Tally: what the layers of a print add up to, beside what is extruded.

use crate::region::Region;
use crate::slice::Layer;
use crate::units::{Coord, to_mm};
use crate::warning::Warning;

/// Thin places of a layer are counted from this area on, mm², where every model is printed once.
/// Smaller ones are rounding and the tips of corners, not the shape of the part.
const LEAST_THIN_MM2: f64 = 1.0;

/// What the layers of a print add up to.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Tally {
    open_layers: usize,
    longest_gap: Coord,
    /// Thin places of each layer that has some, mm².
    thin_mm2: Vec<f64>,
    solid_mm3: f64,
}

impl Tally {
    /// Adds one layer.
    pub fn layer(&mut self, region: &Region) {
        self.add(&region.layer, region.thin_mm2);
    }

    /// Adds a layer of which so much is too thin for a line, mm²; all of it where nothing is printed.
    pub fn add(&mut self, layer: &Layer, thin_mm2: f64) {
        if layer.closed_gap > 0 {
            self.open_layers += 1;
            self.longest_gap = self.longest_gap.max(layer.closed_gap);
        }
        self.solid_mm3 += layer.volume_mm3();
        if thin_mm2 > LEAST_THIN_MM2 {
            self.thin_mm2.push(thin_mm2);
        }
    }

    /// What the contours of all layers enclose, mm³.
    #[must_use]
    pub fn solid_mm3(&self) -> f64 {
        self.solid_mm3
    }

    /// Warns of what the layers could not be printed as they are, if each model is printed so many times.
    /// What is too little to tell of one copy is so of any number.
    pub fn warnings(&self, copies: u32) -> impl Iterator<Item = Warning> {
        let open = (self.open_layers > 0).then(|| Warning::OpenContours {
            layers: self.open_layers,
            longest_gap_mm: to_mm(self.longest_gap),
        });
        let least = LEAST_THIN_MM2 * f64::from(copies.max(1));
        let (layers, area_mm2) = self
            .thin_mm2
            .iter()
            .filter(|&&area| area > least)
            .fold((0, 0.0), |(layers, sum), area| (layers + 1, sum + area));
        let thin = (layers > 0).then_some(Warning::ThinPlaces { layers, area_mm2 });
        open.into_iter().chain(thin)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thin_places_are_judged_as_of_one_copy() {
        let warned = |one: f64, copies: u32| {
            let thin_mm2 = vec![one * f64::from(copies)];
            Tally { thin_mm2, ..Tally::default() }.warnings(copies).count()
        };
        for copies in [1, 2, 7, 100] {
            assert_eq!(warned(0.6, copies), 0, "{copies}");
            assert_eq!(warned(1.5, copies), 1, "{copies}");
        }
    }
}
