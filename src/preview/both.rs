//! Strands of two files -> Drawing: a layer of both, in two colours where they differ.

use super::MARGIN;
use super::colours::{Colour, INK};
use super::drawing::{Drawing, Frame, Kind, Look, Stroke};
use super::page::Page;

/// What both have. The three colours differ in lightness, too.
const COMMON: Colour = Colour([205, 205, 205]);

/// What only the first has: a blue of M. Okabe and K. Ito, "Color Universal Design" (2008).
const FIRST: Colour = Colour([0, 114, 178]);

/// What only the second has: their vermilion.
const SECOND: Colour = Colour([213, 94, 0]);

/// Width of a travel and of the ring, pixels.
const TRAVEL: f64 = 2.0;

/// Width and length of a dot where a travel goes up or down, pixels.
const DOT: f64 = 9.0;
const DOT_LENGTH: f64 = 0.1;

/// Dashes and gaps of a travel, in its widths.
const DASH: u8 = 4;

/// How far travels may widen the frame of the lines, of its longer side: those to the end of the world
/// would leave no room for the part.
const ASIDE: f64 = 0.5;

/// Radius of the ring around a place, of the frame's longer side, and its corners.
const RING: f64 = 0.025;
const CORNERS: u32 = 48;

/// A straight piece of a line, or of a travel, whose width is 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Strand {
    /// Where it begins, mm.
    pub from: [f64; 2],
    /// Where it ends, mm.
    pub to: [f64; 2],
    /// Width of the line, mm; 0 for a travel.
    pub width: f64,
    /// Whose it is.
    pub whose: Whose,
}

impl Strand {
    /// Whether it is a travel that goes up or down alone.
    fn is_upright(&self) -> bool {
        self.width == 0.0 && self.from == self.to
    }
}

/// Which of two files have a strand.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Whose {
    /// Both.
    Both,
    /// Only the first.
    First,
    /// Only the second.
    Second,
}

impl Whose {
    fn colour(self) -> Colour {
        match self {
            Self::Both => COMMON,
            Self::First => FIRST,
            Self::Second => SECOND,
        }
    }
}

/// Draws strands, later ones over earlier ones, with a ring around a place, mm. `size` is that of the
/// longer side, pixels; `heading` stands beside the picture, a line each.
#[must_use]
pub fn drawing(
    strands: &[Strand],
    ring: Option<[f64; 2]>,
    heading: Vec<String>,
    size: u32,
) -> Drawing {
    let frame = frame(strands);
    let mut keys = vec![
        (COMMON, "A and B".to_owned()),
        (FIRST, "only A".to_owned()),
        (SECOND, "only B".to_owned()),
    ];
    if strands.iter().any(|strand| strand.width == 0.0) {
        keys.push((INK, "dashed: travels".to_owned()));
    }
    if strands.iter().any(Strand::is_upright) {
        keys.push((INK, "dots: up and down".to_owned()));
    }
    let mut drawing = Page { size, frame, axes: ["x", "y"], heading, keys }.lay_out();
    let pixel = 1.0 / drawing.view.scale;
    for strand in strands {
        let Strand { from, to, width, whose } = *strand;
        let colour = whose.colour();
        // Up and down is a dot, and a dot has some length.
        let is_upright = strand.is_upright();
        let to = if is_upright { [to[0] + DOT_LENGTH * pixel, to[1]] } else { to };
        let (width, kind) = match (width > 0.0, whose) {
            (false, _) if is_upright => (DOT * pixel, Kind::Bead),
            (false, _) => (TRAVEL * pixel, Kind::Dashed(DASH)),
            (true, Whose::Both) => (width, Kind::PaleBead),
            (true, _) => (width, Kind::Bead),
        };
        let look = Look { width: (width * 100.0).round().max(1.0) / 100.0, colour, kind };
        match drawing.scene.last_mut() {
            Some(last) if last.look == look && last.points.last() == Some(&from) => {
                last.points.push(to);
            }
            _ => drawing.scene.push(Stroke { points: vec![from, to], look }),
        }
    }
    let [width, height] = frame.size();
    drawing.scene.extend(ring.map(|at| circle(at, RING * width.max(height), TRAVEL * pixel)));
    drawing
}

/// Around all lines, and around travels that are not too far aside.
fn frame(strands: &[Strand]) -> Frame {
    let mut lines = Frame::EMPTY;
    let mut travels = Frame::EMPTY;
    for strand in strands {
        let frame = if strand.width > 0.0 { &mut lines } else { &mut travels };
        for at in [strand.from, strand.to] {
            frame.include(at, strand.width / 2.0);
        }
    }
    let mut frame = if lines.is_empty() { travels } else { lines };
    if frame.is_empty() {
        frame.include([0.0; 2], 1.0);
    }
    let size = frame.size();
    let longest = size[0].max(size[1]).max(1.0);
    if !travels.is_empty() {
        let most = frame.padded(ASIDE * longest);
        for corner in [travels.min, travels.max] {
            let inside = |axis: usize| corner[axis].clamp(most.min[axis], most.max[axis]);
            frame.include([inside(0), inside(1)], 0.0);
        }
    }
    frame.padded(MARGIN * longest)
}

fn circle(at: [f64; 2], radius: f64, width: f64) -> Stroke {
    let point = |corner: u32| {
        let (sin, cos) =
            libm::sincos(std::f64::consts::TAU * f64::from(corner) / f64::from(CORNERS));
        [at[0] + radius * cos, at[1] + radius * sin]
    };
    let look = Look { width, colour: INK, kind: Kind::Bead };
    Stroke { points: (0..=CORNERS).map(point).collect(), look }
}
