//! Settings -> patterns: the lines or curves of sparse areas, behind one trait.
//!
//! A *pattern* is a set of lines or curves that covers the plane, such as every fifth raster
//! line. Sparse infill and support are a pattern inside a region. No other stage knows the
//! curves. The region stage asks a pattern for its length inside some rows and for its *shares*:
//! interlaced layers print one share each. The fill stage asks for its *strands*, the polylines
//! to print. So a new pattern is a new file here, and a line in [`Turns::new`].
//!
//! A *turn* is the set of patterns that one block of layers prints: one direction of rectilinear
//! infill, or both directions of a grid. Blocks take the turns one after the other.

mod lines;
pub mod zigzag;

pub use lines::Lines;

use crate::geom::polyline::{self, Polyline};
use crate::geom::raster::Raster;
use crate::geom::spans::Rows;
use crate::profile::{self, Settings};
use crate::units::{Coord, to_units};
use std::fmt::Debug;
use std::sync::Arc;

/// Lines or curves that fill a region sparsely. They are the same on every layer.
///
/// A region is given as rows of [`Self::raster`]; strands are in that raster's frame. Strands
/// shorter than `least` are not printed, so lengths do not include them.
pub trait SparsePattern: Debug + Send + Sync {
    /// The raster on whose rows this pattern expects a region.
    fn raster(&self) -> Raster;

    /// The length of what is printed inside `region`, grid units, without joins between lines.
    /// By default it is the length of the strands; straight lines compute it faster.
    fn length(&self, region: &Rows, least: Coord) -> i64 {
        self.strands(region, least, least).iter().map(|strand| polyline::length(strand)).sum()
    }

    /// Divides this pattern evenly into `count` patterns that together print the same.
    fn shares(&self, count: usize) -> Vec<Pattern>;

    /// What is printed inside `region` with lines `width` wide.
    fn strands(&self, region: &Rows, width: Coord, least: Coord) -> Vec<Polyline>;
}

/// A pattern that several layers and stages refer to.
pub type Pattern = Arc<dyn SparsePattern>;

/// The patterns of the sparse infill, by turn.
#[derive(Debug, Clone, Default)]
pub struct Turns(Vec<Vec<Pattern>>);

impl Turns {
    /// The patterns that `settings` ask for; no turns without infill.
    #[must_use]
    pub fn new(settings: &Settings) -> Self {
        if settings.infill <= 0.0 {
            return Self::default();
        }
        let lines = |directions| lines(settings, directions);
        Self(match settings.pattern {
            profile::Pattern::Rectilinear => vec![lines(&[0.0]), lines(&[90.0])],
            profile::Pattern::Aligned => vec![lines(&[0.0])],
            profile::Pattern::Grid => vec![lines(&[0.0, 90.0])],
            profile::Pattern::Triangles => vec![lines(&[0.0, 60.0, 120.0])],
        })
    }

    /// The patterns of turn `n`; none without infill.
    #[must_use]
    pub fn of(&self, n: usize) -> &[Pattern] {
        match self.0.len() {
            0 => &[],
            turns => &self.0[n % turns],
        }
    }

    /// Whether there is no infill.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The rasters of all patterns, with repetitions.
    pub fn rasters(&self) -> impl Iterator<Item = Raster> {
        self.0.iter().flatten().map(|pattern| pattern.raster())
    }
}

/// Lines in several directions, in degrees from that of the skin, printed on the same layers.
/// Together they have the density of the settings.
fn lines(settings: &Settings, directions: &[f64]) -> Vec<Pattern> {
    let spacing = settings.line_width * 100.0 / settings.infill * directions.len() as f64;
    let (spacing, width) = (to_units(spacing), to_units(settings.line_width));
    let lines = |turn: &f64| -> Pattern {
        let lines = Lines::new(settings.angle.degrees() + turn, spacing, width);
        Arc::new(Lines { joined: directions.len() == 1, ..lines })
    };
    directions.iter().map(lines).collect()
}
