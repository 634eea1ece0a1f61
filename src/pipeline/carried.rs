//! Support of the layers so far -> whether it carries a place or an area.

use crate::geom::{Contour, Point};
use crate::region::scan::Scan;
use crate::region::{Sparse, SupportLines};
use std::collections::VecDeque;

/// The support of the last layers.
#[derive(Debug)]
pub struct Carried {
    layers: VecDeque<SupportLines>,
    /// How many layers are kept: support further below carries nothing.
    reach: usize,
}

impl Carried {
    /// No layers yet.
    #[must_use]
    pub fn new(reach: usize) -> Self {
        Self { layers: VecDeque::new(), reach }
    }

    /// Adds the next layer's.
    pub fn push(&mut self, support: SupportLines) {
        self.layers.push_back(support);
        if self.layers.len() > self.reach {
            self.layers.pop_front();
        }
    }

    /// Whether support ends just below a place.
    #[must_use]
    pub fn carries(&self, place: Point) -> bool {
        self.carries_any(std::iter::once(place))
    }

    /// Whether support ends just below one of these places.
    #[must_use]
    pub fn carries_any(&self, places: impl Iterator<Item = Point> + Clone) -> bool {
        let carries = |area: &Sparse| places.clone().any(|place| is_in(area, place));
        self.layers.iter().any(|support| support.areas().any(carries))
    }

    /// Whether support ends just below some of an area.
    #[must_use]
    pub fn carries_some_of(&self, contours: &[Contour]) -> bool {
        let carries = |area: &Sparse| {
            let inside = Scan::new(contours, area.pattern.raster());
            !inside.inside().and(&area.rows).is_empty()
        };
        self.layers.iter().any(|support| support.areas().any(carries))
    }
}

fn is_in(area: &Sparse, place: Point) -> bool {
    let raster = area.pattern.raster();
    let Point { x: u, y: v } = raster.frame.enter(place);
    let row = area.rows.row((v + raster.pitch / 2).div_euclid(raster.pitch));
    row.iter().any(|span| span.start <= u && u <= span.end)
}
