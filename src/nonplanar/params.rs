//! Settings -> NonPlanarParams: the numbers of non-planar skins, grid units where nothing else is said.

use crate::head::Head;
use crate::units::Coord;

/// The numbers of non-planar skins.
#[derive(Debug, Clone)]
pub struct NonPlanarParams {
    /// Number of skins.
    pub skins: u32,
    /// Height of a skin and of a layer.
    pub height: Coord,
    /// Width of a line, and the distance of lines.
    pub line_width: Coord,
    /// Bore of the nozzle.
    pub nozzle: Coord,
    /// Slopes that skins may have, degrees.
    pub slopes: std::ops::RangeInclusive<f64>,
    /// A patch ends where the surface bends by more over an edge, degrees.
    pub max_bend: f64,
    /// Smaller patches are printed level, mm².
    pub min_area: f64,
    /// Directions of the lines, from the lowest skin upwards, degrees; the last one counts for more skins. None: along the slope.
    pub directions: Option<Vec<f64>>,
    /// Lines along the edge.
    pub wall: u32,
    /// How far a chord may leave the surface.
    pub tolerance: Coord,
    /// Longest segment where the surface bends.
    pub segment: Coord,
    /// Shortest segment.
    pub shortest: Coord,
    /// Travels keep so far above all under their way.
    pub clearance: Coord,
    /// The head.
    pub head: Head,
}
