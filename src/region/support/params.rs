//! Settings -> SupportParams: the numbers and patterns of support, and what is decided for a layer.

use crate::geom::Contour;
use crate::geom::raster::Raster;
use crate::geom::spans::Rows;
use crate::pattern::{Lines, Pattern};
use crate::profile::{Settings, SupportBase};
use crate::units::{Coord, to_units};
use std::sync::Arc;

/// Number of patterns of what is sparse.
pub const BODIES: usize = 4;

/// How far a layer of support may reach beyond what carries it, in line widths: the next bead
/// holds on to the one beside it.
pub(super) const LEAN: i32 = 1;

/// Slopes are judged over this height: more knows their angle better, and sees those of small parts later.
const SLOPE_MM: f64 = 1.0;

/// The numbers of support, in grid units.
#[derive(Debug, Clone, Copy)]
pub struct SupportParams {
    /// The lines, on rows fine enough to find every overhang. They are joined at their ends.
    pub(super) lines: Lines,
    /// The same across, for narrow strips that lie between two of them.
    pub(super) crossing: Lines,
    /// The lines of the interface in the same direction, and across.
    pub(super) interface: [Lines; 2],
    /// How far a layer may reach out without support, for each unit of its height.
    pub(super) lean: f64,
    /// The angle of a slope is judged over so many layers.
    pub(super) slope_layers: usize,
    pub(super) outset: Coord,
    /// Distance from the part to the middle of a support line, sideways.
    pub(super) clearance: Coord,
    /// Layers left open above and below support.
    pub(super) gap: usize,
    pub(super) bed_only: bool,
    /// Width of a line.
    pub(super) least: Coord,
    /// Width of a line, and of the thinnest bead: of islands of a layer that are printed.
    pub(super) printed: [Coord; 2],
    pub(super) interface_layers: usize,
    pub(super) interface_pitch: Coord,
    /// Least width of a post, 0 for any.
    pub(super) min_width: Coord,
    pub(super) has_outline: bool,
    /// Overhangs that bridge so far get no support.
    pub(super) longest_bridge: Coord,
    /// How far the lowest layer reaches further out.
    pub(super) brim: Coord,
}

/// The patterns of support.
#[derive(Debug)]
pub struct SupportPatterns {
    /// Of what is sparse: zigzags, and lines that end at an outline; both also across, for strips.
    pub body: [Pattern; BODIES],
    /// Of what is dense: in the same direction, and across.
    pub interface: [Pattern; 2],
}

/// The support of one layer.
#[derive(Debug, Clone, Default)]
pub struct SupportLayer {
    /// Where its sparse lines run, by pattern.
    pub body: [Rows; BODIES],
    /// The outlines at which some of them end.
    pub outlines: Vec<Contour>,
    /// Where its dense lines run, by pattern.
    pub interface: [Rows; 2],
}

impl SupportParams {
    /// The patterns that fill support.
    #[must_use]
    pub fn patterns(&self) -> SupportPatterns {
        let pattern = |lines| -> Pattern { Arc::new(lines) };
        let ends = |lines: Lines| Lines { joined: false, ..lines };
        let body = [self.lines, ends(self.lines), self.crossing, ends(self.crossing)];
        SupportPatterns { body: body.map(pattern), interface: self.interface.map(pattern) }
    }

    /// The raster on whose rows support is computed.
    pub(super) fn raster(&self) -> Raster {
        self.lines.raster
    }

    /// Derives the numbers from `settings`; `None` if support is off.
    #[must_use]
    pub fn new(settings: &Settings) -> Option<Self> {
        let support = &settings.support;
        let (w, spacing) = (to_units(settings.line_width), to_units(support.spacing));
        let degrees = settings.angle.degrees();
        let [lines, crossing] =
            [0.0, 90.0].map(|turn| Lines::new(degrees + turn, spacing, (w / 2).max(1)));
        let pitch = w + to_units(support.interface_spacing);
        let interface = [0.0, 90.0].map(|turn| Lines::new(degrees + turn, pitch, pitch));
        let angle = support.threshold_angle.to_radians();
        let lean =
            if support.threshold_angle >= 90.0 { 0.0 } else { libm::cos(angle) / libm::sin(angle) };
        support.enabled.then(|| Self {
            lines,
            crossing,
            interface,
            lean,
            slope_layers: ((SLOPE_MM / settings.layer_height).round() as usize).max(2),
            outset: to_units(support.expansion),
            clearance: to_units(support.xy_distance) + w / 2,
            gap: (support.z_distance / settings.layer_height).round() as usize,
            bed_only: support.stands_on == SupportBase::Bed,
            least: w,
            printed: [w, to_units(settings.min_feature)],
            interface_layers: support.interface_layers as usize,
            interface_pitch: pitch,
            min_width: to_units(support.min_width),
            has_outline: support.outline,
            longest_bridge: if support.bridges { 0 } else { to_units(support.max_bridge) },
            brim: to_units(support.brim),
        })
    }
}
