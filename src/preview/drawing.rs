//! What a picture shows -> Drawing: strokes in mm, and a page of marks around them, for any format.
//!
//! Words used here: a *stroke* is a line of some width through some points, mm; a *mark* is what
//! stands around the scene, pixels; a *look* is a stroke's width, colour and kind; a *coat* is one of the
//! lines that are painted over each other for a stroke: a dark edge, then the bead.
//!
//! A scene's second axis points upwards, a page's downwards: a view holds the way from one to the
//! other. Neighbours in the scene that look alike are a group, painted together, so that a path of
//! many strokes has no edges across it. What lies later in a list covers what lies before.

use super::colours::Colour;
use super::text::TextSize;

/// Part of a bead's width that each of its two edges takes: enough to separate neighbours at 5
/// pixels a bead.
const EDGE: f64 = 0.09;

/// Width of the edge around a filled outline, mm: about as wide as that of a bead of 0.2 mm.
pub const OUTLINE: f64 = 0.018;

/// How much darker an edge is than its bead.
const EDGE_DARK: f64 = 0.38;

/// The same for a pale bead.
const PALE_EDGE_DARK: f64 = 0.1;

/// A picture. What lies later in a list is painted over what lies before.
#[derive(Debug, Clone, PartialEq)]
pub struct Drawing {
    /// What it shows, in a few words.
    pub title: String,
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// Where the scene lies on the page.
    pub view: View,
    /// What is printed, mm.
    pub scene: Vec<Stroke>,
    /// What is around it, pixels; painted over the scene.
    pub page: Vec<Mark>,
    /// Size of all text.
    pub text: TextSize,
}

/// A rectangle of the scene, mm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame {
    /// Its lower left corner.
    pub min: [f64; 2],
    /// Its upper right corner.
    pub max: [f64; 2],
}

/// From mm, the second axis upwards, to pixels, the second axis downwards.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct View {
    /// Pixels in a mm.
    pub scale: f64,
    /// Pixels of the scene's origin, from the left and from the top.
    pub origin: [f64; 2],
}

/// A line with round ends through some points, mm.
#[derive(Debug, Clone, PartialEq)]
pub struct Stroke {
    /// Its points; a single one is a dot.
    pub points: Vec<[f64; 2]>,
    /// How it looks.
    pub look: Look,
}

/// How a stroke looks. Neighbours in the scene that look alike are painted together.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Look {
    /// Width, mm.
    pub width: f64,
    /// Colour.
    pub colour: Colour,
    /// What kind of line it is.
    pub kind: Kind,
}

/// See [`Look`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Plastic, with edges that are a little darker, within its width.
    Bead,
    /// Plastic in the background.
    PaleBead,
    /// Plastic within an outline, whose points it goes through: filled, with a darker edge along them of
    /// the given width.
    Outline,
    /// A stripe without edges.
    Plain,
    /// Dashes of this many widths, and gaps as long.
    Dashed(u8),
}

/// Something on the page, pixels.
#[derive(Debug, Clone, PartialEq)]
pub enum Mark {
    /// A straight line.
    Line {
        /// From here,
        from: [f64; 2],
        /// to here.
        to: [f64; 2],
        /// Its width.
        width: f64,
        /// Its colour.
        colour: Colour,
    },
    /// A filled rectangle.
    Rectangle {
        /// Upper left corner.
        at: [f64; 2],
        /// Width and height.
        size: [f64; 2],
        /// Its colour.
        colour: Colour,
    },
    /// A line of text.
    Text {
        /// Where it is, at half its height.
        at: [f64; 2],
        /// What of it is there.
        anchor: Anchor,
        /// Its letters; ASCII.
        text: String,
    },
}

/// The end of a text that has a given place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Anchor {
    /// Where it begins.
    Start,
    /// Its middle.
    Middle,
    /// Where it ends.
    End,
}

impl Look {
    /// The strokes to paint, one over the other: width in mm and colour.
    #[must_use]
    pub fn coats(&self) -> Vec<(f64, Colour)> {
        match self.kind {
            Kind::Bead => self.bead(EDGE_DARK),
            Kind::PaleBead => self.bead(PALE_EDGE_DARK),
            Kind::Outline => {
                vec![(self.width, self.colour.mixed(Colour([0; 3]), EDGE_DARK))]
            }
            Kind::Dashed(_) | Kind::Plain => vec![(self.width, self.colour)],
        }
    }

    /// Width of a bead within its edges.
    #[must_use]
    pub fn within_edges(&self) -> f64 {
        self.width * (1.0 - 2.0 * EDGE)
    }

    fn bead(&self, dark: f64) -> Vec<(f64, Colour)> {
        let edge = self.colour.mixed(Colour([0; 3]), dark);
        vec![(self.width, edge), (self.within_edges(), self.colour)]
    }
}

impl View {
    /// The pixel of a point of the scene.
    #[must_use]
    pub fn pixel(&self, at: [f64; 2]) -> [f64; 2] {
        [self.origin[0] + self.scale * at[0], self.origin[1] - self.scale * at[1]]
    }
}

impl Frame {
    /// Contains nothing yet.
    pub const EMPTY: Self = Self { min: [f64::INFINITY; 2], max: [f64::NEG_INFINITY; 2] };

    /// Whether it contains anything.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.min[0] > self.max[0]
    }

    /// Grows so that it contains all within `radius` around a point, mm.
    pub fn include(&mut self, at: [f64; 2], radius: f64) {
        self.min = std::array::from_fn(|axis| self.min[axis].min(at[axis] - radius));
        self.max = std::array::from_fn(|axis| self.max[axis].max(at[axis] + radius));
    }

    /// With a margin on all sides, mm.
    #[must_use]
    pub fn padded(&self, margin: f64) -> Self {
        let [min, max] = [self.min.map(|at| at - margin), self.max.map(|at| at + margin)];
        Self { min, max }
    }

    /// Width and height, mm.
    #[must_use]
    pub fn size(&self) -> [f64; 2] {
        [self.max[0] - self.min[0], self.max[1] - self.min[1]]
    }

    /// Whether the box around two points, with `radius` around it, reaches into this one.
    #[must_use]
    pub fn touches(&self, a: [f64; 2], b: [f64; 2], radius: f64) -> bool {
        (0..2).all(|axis| {
            let (low, high) = (a[axis].min(b[axis]), a[axis].max(b[axis]));
            low - radius < self.max[axis] && high + radius > self.min[axis]
        })
    }
}

impl Drawing {
    /// The scene's strokes, those that are painted together in one slice.
    pub fn groups(&self) -> impl Iterator<Item = &[Stroke]> {
        self.scene.chunk_by(|a, b| a.look == b.look)
    }
}
