//! Everything on the bed -> skirt: loops around it.

use super::Bead;
use crate::geom::hull::hull;
use crate::geom::{Contour, Point, polygon};
use crate::profile::Settings;
use crate::units::{Coord, UNITS_PER_MM, to_units};

/// Most loops that a least length may ask for: around a large print one is long.
const MOST_LOOPS: u32 = 1_000;

/// The numbers of a skirt, grid units.
#[derive(Debug, Clone, Copy)]
pub(super) struct SkirtParams {
    loops: u32,
    distance: Coord,
    width: Coord,
    /// Least length of all loops on the first layer.
    least: f64,
    /// Layers that have one.
    pub(super) layers: usize,
}

impl SkirtParams {
    /// Derives the numbers from `settings`; `None` without a skirt.
    pub(super) fn new(settings: &Settings) -> Option<Self> {
        let skirt = &settings.skirt;
        (skirt.loops > 0).then(|| Self {
            loops: skirt.loops,
            distance: to_units(skirt.distance),
            width: to_units(settings.line_width),
            least: skirt.min_length * UNITS_PER_MM,
            layers: skirt.layers as usize,
        })
    }
}

/// The skirt of the first layer around `points`, in the order of printing: from outside inwards, as a
/// brim.
pub(super) fn skirt(points: Vec<Point>, params: &SkirtParams) -> Vec<Bead> {
    let around = hull(points);
    let mut loops: Vec<Bead> = Vec::new();
    let mut length = 0.0;
    let most = if params.least > 0.0 { MOST_LOOPS.max(params.loops) } else { params.loops };
    for k in 0..most {
        if k >= params.loops && length >= params.least {
            break;
        }
        let out = params.distance + params.width / 2 + k as Coord * params.width;
        let grown: Vec<Contour> = polygon::outset(std::slice::from_ref(&around), out);
        let Some(points) = grown.into_iter().next() else { break };
        let one = Bead::closed(points, k);
        length += one.length();
        loops.push(one);
    }
    loops.reverse();
    loops
}

/// The loops of the layers above: those next to the part.
pub(super) fn above(first: &[Bead], params: &SkirtParams) -> Vec<Bead> {
    first[first.len().saturating_sub(params.loops as usize)..].to_vec()
}
