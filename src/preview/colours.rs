//! Role of a line -> Colour: one palette for every picture, which colour-blind people can distinguish, too.

use crate::reader::Role;
use crate::reader::print::{Layer, Step};

/// A line this many times as high as its layer is printed for more than one layer: half-way to two.
const THICK: f64 = 1.5;

/// A scale from least to most, as that of the page: lightness rises all the way, so that the order is
/// seen without colour, too.
const RAMP: [Colour; 9] = [
    Colour([72, 40, 120]),
    Colour([62, 73, 137]),
    Colour([49, 104, 142]),
    Colour([38, 130, 142]),
    Colour([31, 158, 137]),
    Colour([53, 183, 121]),
    Colour([110, 206, 88]),
    Colour([181, 222, 43]),
    Colour([240, 229, 28]),
];

/// Red, green and blue, as on a screen (sRGB).
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Colour(pub [u8; 3]);

/// What is behind everything.
pub const PAPER: Colour = Colour([255, 255, 255]);

/// Text, and the frame.
pub const INK: Colour = Colour([51, 51, 51]);

impl Colour {
    /// The colour of a line of this role; a thick one has a darker shade.
    ///
    /// Hues near those of M. Okabe and K. Ito, "Color Universal Design" (2008), moved until any
    /// two colours of lines are 17 or more apart in CIELAB, also as people see them who lack one
    /// kind of cones (matrices of Machado et al. 2009). Travel and retraction are thin lines and
    /// dots.
    #[must_use]
    pub fn of(role: Role, thick: bool) -> Self {
        let (thin, dark) = match role {
            Role::OuterWall => ([92, 92, 92], [0, 0, 0]),
            Role::InnerWall => ([199, 109, 184], [102, 10, 87]),
            Role::Skin => ([243, 183, 70], [191, 93, 0]),
            Role::Ironing => ([165, 135, 255], [96, 6, 192]),
            Role::NonPlanar => ([232, 136, 108], [140, 22, 30]),
            Role::Infill => ([78, 211, 255], [16, 89, 178]),
            Role::Support => ([113, 176, 157], [0, 76, 32]),
            Role::Adhesion => ([144, 40, 248], [18, 0, 126]),
            Role::Other => ([191, 175, 124], [136, 120, 88]),
            Role::Travel => ([213, 94, 0], [213, 94, 0]),
            Role::Retraction => ([140, 40, 160], [140, 40, 160]),
        };
        Self(if thick { dark } else { thin })
    }

    /// A colour of the scale; `part` from 0 for the least to 1 for the most.
    #[must_use]
    pub fn on_scale(part: f64) -> Self {
        let at = part.clamp(0.0, 1.0) * (RAMP.len() - 1) as f64;
        let below = (at as usize).min(RAMP.len() - 2);
        RAMP[below].mixed(RAMP[below + 1], at - below as f64)
    }

    /// As `#rrggbb`.
    #[must_use]
    pub fn hex(self) -> String {
        let [red, green, blue] = self.0;
        format!("#{red:02x}{green:02x}{blue:02x}")
    }

    /// Mixed with `part` of another colour, 0 to 1.
    #[must_use]
    pub fn mixed(self, other: Self, part: f64) -> Self {
        let mix = |k: usize| {
            let (own, other) = (f64::from(self.0[k]), f64::from(other.0[k]));
            (own + (other - own) * part).round() as u8
        };
        Self([mix(0), mix(1), mix(2)])
    }
}

/// Whether a line is printed for more layers than its own. Non-planar skin is not: it is as high as
/// the room that the steps of the layers below leave.
#[must_use]
pub fn is_thick(step: &Step, layer: &Layer) -> bool {
    step.role != Role::NonPlanar && f64::from(step.height) > THICK * layer.height
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_role_has_its_own_colour_and_a_shade_of_it() {
        let drawn = &Role::ALL[..9];
        let all = |thick| drawn.iter().map(move |role| Colour::of(*role, thick));
        let mut colours: Vec<Colour> = all(false).chain(all(true)).collect();
        colours.sort_unstable();
        colours.dedup();
        assert_eq!(colours.len(), 18);
    }

    #[test]
    fn the_scale_is_that_of_the_page_and_grows_lighter() {
        let script = include_str!("viewer/colour.js");
        let light = |Colour([r, g, b]): Colour| 3 * u32::from(r) + 6 * u32::from(g) + u32::from(b);
        for (k, colour) in RAMP.into_iter().enumerate() {
            assert!(script.contains(&colour.hex()), "{}", colour.hex());
            assert_eq!(Colour::on_scale(k as f64 / 8.0), colour);
            assert!(k == 0 || light(RAMP[k - 1]) < light(colour));
        }
        assert_eq!(Colour::on_scale(f64::INFINITY), RAMP[8]);
    }

    #[test]
    fn colours_are_written_as_in_html() {
        assert_eq!(Colour([0, 84, 148]).hex(), "#005494");
        assert_eq!(Colour([0, 0, 0]).mixed(PAPER, 0.5).hex(), "#808080");
    }
}
