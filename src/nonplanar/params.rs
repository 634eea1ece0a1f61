//! Settings -> NonPlanarParams: the numbers of non-planar skins, grid units where nothing else is said.

use crate::head::{DEEPEST_PRESS, Head};
use crate::profile::{Directions, Settings};
use crate::units::{Coord, to_mm, to_units};
use std::ops::RangeInclusive;

/// The numbers of non-planar skins.
#[derive(Debug, Clone)]
pub struct NonPlanarParams {
    /// Number of skins.
    pub skins: u32,
    /// Height of a skin and of a layer.
    pub height: Coord,
    /// Width of a line of a skin, and the distance of lines.
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
    /// Shortest segment, no longer than a line is wide.
    pub shortest: Coord,
    /// Travels keep so far above all under their way.
    pub clearance: Coord,
    /// The part's outline is moved outwards by this, inwards if negative.
    pub outline: Coord,
    /// The walls of what is printed level reach so far beyond its contours.
    pub beyond: Coord,
    /// The head.
    pub head: Head,
}

/// A line with less room than this share of a skin's height would be torn by the nozzle.
const LEAST_HEIGHT: f64 = 0.25;

/// A line with more room than this many heights of a skin, or than the bore of the nozzle, would be laid
/// in the air.
const MOST_HEIGHT: f64 = 1.75;

/// A base that ends by the middles of layers leaves room for its lowest skin up to so many layer heights.
const MOST_ROOM: f64 = 1.5;

/// What a press on a line may be less deep than the rule allows, mm, and at most this share of a layer's
/// height: a line is looked at every quarter of a millimetre, on cells of a tenth.
const SPARE: [f64; 2] = [0.02, 0.1];

/// By how much more a press at a place is kept off, mm, and at most this share of a layer's height:
/// places are further apart than the cells are wide, and lines run between them.
const SPARE_BETWEEN: [f64; 2] = [0.01, 0.1];

/// The shortest time that a planner may get for a move, s. Sailfish plans 50 moves a second.
const SHORTEST_MOVE_S: f64 = 0.02;

/// Lines are at most so many bores wide: over a slope one side of a line lies higher than the other, by its
/// width times the slope, and a wide line stands above its neighbour.
const WIDEST_LINE: f64 = 1.25;

impl NonPlanarParams {
    /// The numbers that these settings give.
    #[must_use]
    pub fn new(settings: &Settings) -> Self {
        let skins = &settings.nonplanar;
        let rate = settings.limits.max_segment_rate;
        let seconds = if rate > 0.0 { 1.0 / rate } else { SHORTEST_MOVE_S };
        let nozzle = settings.machine.nozzle_diameter;
        let width = settings.line_width.min(WIDEST_LINE * nozzle);
        Self {
            skins: skins.skins,
            height: to_units(settings.layer_height),
            line_width: to_units(width * skins.spacing),
            nozzle: to_units(nozzle),
            slopes: skins.min_slope..=settings.steepest_skin(),
            max_bend: skins.max_bend,
            min_area: skins.min_area,
            directions: match &skins.directions {
                Directions::Degrees(degrees) => Some(degrees.clone()),
                Directions::Auto(_) => None,
            },
            wall: skins.wall,
            tolerance: to_units(skins.tolerance),
            segment: to_units(skins.segment),
            // A longer chord would leave the surface where it bends: a board with a limit goes slower there.
            shortest: to_units((settings.speed.nonplanar * seconds).min(width)),
            clearance: to_units(skins.clearance),
            outline: to_units(settings.xy_compensation),
            beyond: to_units(settings.line_width * (0.5 - settings.outer_wall_inset).max(0.0)),
            head: settings.head(),
        }
    }

    /// How high the bead of a skin may be, grid units.
    #[must_use]
    pub fn bead_heights(&self) -> RangeInclusive<f64> {
        let height = f64::from(self.height);
        LEAST_HEIGHT * height..=(MOST_HEIGHT * height).min(f64::from(self.nozzle))
    }

    /// How much higher than its skins are thick the base ends, grid units, so that the treads of its staircase
    /// leave no more room than a bead may have. None is needed while the bore is wide enough.
    #[must_use]
    pub fn raised(&self) -> Coord {
        let most = MOST_ROOM * f64::from(self.height);
        (most - self.bead_heights().end()).ceil().max(0.0) as Coord
    }

    /// The height of layers on which the deepest press would be what lines may have here, mm.
    #[must_use]
    pub fn press_layer(&self) -> f64 {
        let height = to_mm(self.height);
        height - spare(SPARE, height) / DEEPEST_PRESS
    }

    /// The same for single places.
    #[must_use]
    pub fn press_layer_at_places(&self) -> f64 {
        self.press_layer() - spare(SPARE_BETWEEN, to_mm(self.height)) / DEEPEST_PRESS
    }
}

/// The lesser of a length and a share of a layer's height.
fn spare([most, share]: [f64; 2], height: f64) -> f64 {
    most.min(share * height)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::profile::Profile;

    #[test]
    fn slopes_end_where_the_head_or_the_press_ends_them() {
        let with = |key: &str, value: &str| {
            let made = Profile::builder("generic-marlin").set("head.name", "long-0.6");
            NonPlanarParams::new(&made.set(key, value).load().unwrap().settings)
        };
        let most = |key: &str, value: &str| (*with(key, value).slopes.end() * 10.0).round() / 10.0;
        assert_eq!(most("layer_height", "0.2"), 21.8);
        assert_eq!(most("layer_height", "0.3"), 31.0);
        assert_eq!(most("head.name", "cautious"), 4.3);
        assert_eq!(most("head.cone", "3"), 1.5);
    }

    #[test]
    fn a_base_is_raised_where_the_bore_is_too_small_for_its_treads() {
        let raised = |height: &str| {
            let made = Profile::builder("generic-marlin").set("layer_height", height);
            NonPlanarParams::new(&made.load().unwrap().settings).raised()
        };
        assert_eq!(["0.1", "0.2", "0.26", "0.3"].map(raised), [0, 0, 0, 500]);
    }

    #[test]
    fn lengths_are_in_grid_units() {
        let made = Profile::builder("generic-marlin").set("nonplanar.directions", "auto");
        let params = NonPlanarParams::new(&made.load().unwrap().settings);
        let lengths = [params.height, params.line_width, params.nozzle, params.tolerance];
        assert_eq!(lengths, [2000, 3600, 4000, 50]);
        assert_eq!([params.segment, params.shortest, params.clearance], [20_000, 4000, 5000]);
        assert_eq!((params.directions, params.skins), (None, 2));
    }
}
