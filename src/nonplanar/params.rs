//! Settings -> NonPlanarParams: the numbers of non-planar skins, grid units where nothing else is said.

use crate::head::Head;
use crate::profile::{Directions, Settings};
use crate::units::{Coord, to_units};

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
    /// Shortest segment.
    pub shortest: Coord,
    /// Travels keep so far above all under their way.
    pub clearance: Coord,
    /// The head.
    pub head: Head,
}

/// The shortest time that a planner may get for a move, s. Sailfish plans 50 moves a second.
const SHORTEST_MOVE_S: f64 = 0.02;

impl NonPlanarParams {
    /// The numbers that these settings give.
    #[must_use]
    pub fn new(settings: &Settings) -> Self {
        let skins = &settings.nonplanar;
        let rate = settings.limits.max_segment_rate;
        let seconds = if rate > 0.0 { 1.0 / rate } else { SHORTEST_MOVE_S };
        Self {
            skins: skins.skins,
            height: to_units(settings.layer_height),
            line_width: to_units(settings.line_width * skins.spacing),
            nozzle: to_units(settings.machine.nozzle_diameter),
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
            shortest: to_units(settings.speed.nonplanar * seconds),
            clearance: to_units(skins.clearance),
            head: settings.head(),
        }
    }
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
    fn lengths_are_in_grid_units() {
        let made = Profile::builder("generic-marlin").set("nonplanar.directions", "auto");
        let params = NonPlanarParams::new(&made.load().unwrap().settings);
        let lengths = [params.height, params.line_width, params.nozzle, params.tolerance];
        assert_eq!(lengths, [2000, 3600, 4000, 50]);
        assert_eq!([params.segment, params.shortest, params.clearance], [20_000, 4000, 5000]);
        assert_eq!((params.directions, params.skins), (None, 2));
    }
}
