//! What the pass looks at.

use super::params::NonPlanarParams;
use super::surface::find::Surfaces;
use crate::geom::raster::Raster;
use crate::geom::spans::{Rows, Span};
use crate::geom::{Contour, Point, edges};
use crate::region::support::{SupportLayer, SupportPatterns};
use crate::slice::Slicer;
use crate::units::Coord;

/// The lines of support of a layer, each by its ends.
pub type SupportLines<'a> = dyn Fn(usize) -> Vec<[Point; 2]> + Sync + 'a;

/// Support, as the pass sees it.
#[derive(Clone, Copy)]
pub struct Props<'a> {
    /// Its lines, by layer. All that it may cover: an area is told by lines beside each other.
    pub lines: &'a SupportLines<'a>,
    /// Their width, grid units.
    pub width: Coord,
    /// How far above the part it begins, grid units.
    pub gap: Coord,
}

/// A skirt of several layers, as the pass sees it. It is laid around what the first layer holds, brims too,
/// so that it is only known how near it may be.
#[derive(Debug, Clone, PartialEq)]
pub struct Skirt {
    /// It stands outside of these contours, anywhere.
    pub inside: Vec<Contour>,
    /// How high it gets above the bed, grid units.
    pub top: Coord,
}

/// The lines that support may have in a layer: all rows of where it stands, and its outlines.
#[must_use]
pub fn support_lines(layer: &SupportLayer, patterns: &SupportPatterns) -> Vec<[Point; 2]> {
    let pairs = layer.body.iter().zip(&patterns.body);
    let all = pairs.chain(layer.interface.iter().zip(&patterns.interface));
    let lines = |rows: &Rows, raster: Raster| {
        let line = |j: i32, span: &Span| {
            let end = |u: Coord| raster.frame.leave(Point { x: u, y: j * raster.pitch });
            [end(span.start), end(span.end)]
        };
        let rows = rows.iter().flat_map(|(j, row)| row.iter().map(move |span| line(j, span)));
        rows.collect::<Vec<_>>()
    };
    let outlines = layer.outlines.iter().flat_map(|outline| edges(outline)).map(|(a, b)| [a, b]);
    all.flat_map(|(rows, pattern)| lines(rows, pattern.raster())).chain(outlines).collect()
}

/// A part on the bed, with its gentle slopes.
#[derive(Clone, Copy)]
pub struct Scene<'a> {
    /// Its layers, as they are without skins.
    pub slicer: &'a Slicer<'a>,
    /// Its gentle slopes.
    pub surfaces: &'a Surfaces,
    /// The lowest and the highest corner of each body, grid units.
    pub bodies: &'a [[Point; 2]],
    /// Its support, if it has any.
    pub support: Option<Props<'a>>,
    /// Its skirt, if that is higher than a layer.
    pub skirt: Option<&'a Skirt>,
    /// The nozzle gets no higher than this above the bed, grid units.
    pub ceiling: Coord,
    /// The numbers of skins.
    pub params: &'a NonPlanarParams,
}

impl Scene<'_> {
    /// Height of all skins together.
    pub(super) fn depth(&self) -> Coord {
        let skins = Coord::try_from(self.params.skins).unwrap_or(1);
        skins.saturating_mul(self.params.height)
    }

    /// How far below the surface the base ends where all skins lie.
    pub(super) fn base_depth(&self) -> Coord {
        self.depth() - self.params.raised()
    }

    /// How far skin `i`, counted from 0 at the lowest, lies below the surface.
    pub(super) fn lowered(&self, i: usize) -> Coord {
        let above = (self.params.skins as usize).saturating_sub(i + 1);
        Coord::try_from(above).unwrap_or(0).saturating_mul(self.params.height)
    }

    /// The body at a place, by its box.
    pub(super) fn body(&self, p: Point) -> Option<usize> {
        let holds = |[low, high]: &[Point; 2]| {
            low.x <= p.x && p.x <= high.x && low.y <= p.y && p.y <= high.y
        };
        self.bodies.iter().position(holds)
    }

    /// The direction of the lines of skin `i`, degrees; `along` is that in which the surface is steepest.
    pub(super) fn direction(&self, i: usize, along: f64) -> f64 {
        let skins = self.params.skins as usize;
        match &self.params.directions {
            Some(list) if !list.is_empty() => {
                // The last direction is the one that is seen, however few skins there are.
                let first = list.len().saturating_sub(skins);
                list[(first + i).min(list.len() - 1)]
            }
            _ if (skins - i.min(skins)) % 2 == 1 => along,
            _ => (along + 90.0).rem_euclid(180.0),
        }
    }
}
