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

mod anchors;
mod lines;
pub mod zigzag;

pub use lines::Lines;

use crate::geom::outline::{Bounds, Columns};
use crate::geom::polyline::{self, Polyline};
use crate::geom::raster::Raster;
use crate::geom::spans::Rows;
use crate::profile::{self, Settings};
use crate::units::{Coord, to_units};
use std::fmt::Debug;
use std::sync::Arc;

/// How far beads along a wall reach into it at most, in line widths (0.1 mm). Ends of lines reach
/// `infill_overlap` minus this further in their middle, but only as wide as a round end. A smaller value leaves gaps
/// where arcs are decimated; a larger one presses plastic into the wall.
const RUN_OVERLAP: f64 = 0.25;

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

    /// Whether it fills its region solidly, up to the walls.
    fn is_solid(&self) -> bool {
        false
    }

    /// Whether it needs its region on a raster across, to follow the walls around it.
    fn is_anchored(&self) -> bool {
        false
    }

    /// As [`Self::strands`], with ends and turns that run along the walls around the region. By
    /// default there are none.
    fn anchored(&self, region: &Held<'_>, width: Coord, least: Coord) -> Vec<Polyline> {
        self.strands(region.rows, width, least)
    }
}

/// A region with the walls that hold what is printed in it.
#[derive(Debug, Clone, Copy)]
pub struct Held<'a> {
    /// The region, on every row of the pattern's raster.
    pub rows: &'a Rows,
    /// The region on a raster across.
    pub columns: Columns<'a>,
    /// The room inside the walls, on both; several if any of several walls will do.
    pub walls: &'a [Bounds<'a>],
}

/// A pattern that several layers and stages refer to.
pub type Pattern = Arc<dyn SparsePattern>;

/// The patterns of the sparse infill, by turn.
#[derive(Debug, Clone, Default)]
pub struct Turns {
    sparse: Vec<Vec<Pattern>>,
    /// Solid lines along the two rasters of skins, for rooms too narrow for sparse ones.
    dense: Vec<Pattern>,
}

impl Turns {
    /// The patterns that `settings` ask for; no turns without infill.
    #[must_use]
    pub fn new(settings: &Settings) -> Self {
        if settings.infill <= 0.0 {
            return Self::default();
        }
        let lines = |directions| lines(settings, directions);
        let sparse: Vec<Vec<Pattern>> = match settings.printed_pattern() {
            profile::Pattern::Rectilinear => vec![lines(&[0.0]), lines(&[90.0])],
            profile::Pattern::Aligned => vec![lines(&[0.0])],
            profile::Pattern::Grid => vec![lines(&[0.0, 90.0])],
            profile::Pattern::Triangles => vec![lines(&[0.0, 60.0, 120.0])],
        };
        let dense = |turn: f64| -> Pattern {
            let width = to_units(settings.line_width);
            Arc::new(Lines {
                solid: true,
                ..Lines::new(settings.angle.degrees() + turn, width, width)
            })
        };
        let rooms = settings.narrow_room > 0.0 && settings.walls > 0;
        Self { sparse, dense: if rooms { vec![dense(0.0), dense(90.0)] } else { Vec::new() } }
    }

    /// The solid lines of turn `n`; `None` if no room gets any.
    #[must_use]
    pub fn dense(&self, n: usize) -> Option<&Pattern> {
        self.dense.get(n % 2)
    }

    /// The patterns of turn `n`; none without infill.
    #[must_use]
    pub fn of(&self, n: usize) -> &[Pattern] {
        match self.sparse.len() {
            0 => &[],
            turns => &self.sparse[n % turns],
        }
    }

    /// Whether there is no infill.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.sparse.is_empty()
    }

    /// The rasters of all patterns, with repetitions.
    pub fn rasters(&self) -> impl Iterator<Item = Raster> {
        self.sparse.iter().flatten().map(|pattern| pattern.raster())
    }
}

/// Lines in several directions, in degrees from that of the skin, printed on the same layers.
/// Together they have the density of the settings.
fn lines(settings: &Settings, directions: &[f64]) -> Vec<Pattern> {
    let spacing = settings.line_width * 100.0 / settings.infill * directions.len() as f64;
    let (spacing, width) = (to_units(spacing), to_units(settings.line_width));
    // Without walls there is nothing to hold on to.
    let anchor = if settings.walls > 0 { to_units(settings.infill_anchor) } else { 0 };
    let inwards = (settings.infill_overlap - RUN_OVERLAP).max(0.0) * settings.line_width;
    let inwards = to_units(inwards);
    let lines = |turn: &f64| -> Pattern {
        let lines = Lines::new(settings.angle.degrees() + turn, spacing, width);
        let joined = directions.len() == 1;
        let anchor = if joined { anchor } else { 0 };
        Arc::new(Lines { joined, anchor, inwards, ..lines })
    };
    directions.iter().map(lines).collect()
}
