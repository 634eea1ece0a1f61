//! Paths of successive layers -> Footing: what begins in the air, judged on what is printed.
//!
//! Words:
//! - An *island* is one outer contour with its holes and the paths inside it; it *touches* another
//!   if they share an area: see [`footprint`](super::footprint).
//! - A *body* is all printed islands that touch each other, directly or through others. It *stands*
//!   if one of its islands is on the first layer or on support.
//! - An island *begins in the air* if it touches no printed island below and no support.
//!
//! Algorithm: [`Footing::layer`] links each layer's footprint with the one below. A place near a
//! corner of one island inside the other shows at once that they touch, which is nearly always so.
//! Only where no such place is found, and it would change the verdict, the contours are subtracted
//! from each other.
//!
//! What droops is kept beside it ([`droop`](super::droop)), and told with it at the end.
//!
//! Bodies are only known at the end: two arms that begin in the air on their own may meet what
//! stands further up. So a job is refused after its last layer, before its output is complete.

use super::carried::Carried;
use super::droop::{Droop, Stretch};
use super::footprint::{Footprint, Island};
use crate::error::Hanging;
use crate::fill::adhesion::lift::Lift;
use crate::geom::Point;
use crate::geom::sets::Sets;
use crate::profile::{Floating, Settings, SupportBase};
use crate::region::Region;
use crate::units::{Coord, UNITS_PER_MM, sum_mm, to_mm};
use crate::warning::Warning;

/// Which setting keeps support away from what hangs, in the order in which support is made.
#[derive(Debug, Clone, Copy)]
struct Keepers {
    /// How far a layer may reach out without support, as a height's tangent.
    lean: f64,
    bed_only: bool,
}

impl Keepers {
    fn new(settings: &Settings) -> Option<Self> {
        let support = &settings.support;
        let angle = support.threshold_angle.to_radians();
        let lean = libm::cos(angle).max(0.0) / libm::sin(angle).max(1e-9);
        let bed_only = support.stands_on == SupportBase::Bed;
        support.enabled.then_some(Self { lean, bed_only })
    }

    /// The setting that leaves no support `clear` layers above the part, with room for support from
    /// `gap` layers on. `lean` is how far to the side the part is next, in heights of a layer.
    fn of(self, (clear, gap): (usize, usize), lean: Option<f64>) -> &'static str {
        if lean.is_some_and(|lean| lean <= self.lean) {
            "support.threshold_angle"
        } else if clear > 0 && clear <= gap {
            "support.z_distance"
        } else if self.bed_only {
            "support.stands_on"
        } else {
            "support.xy_distance"
        }
    }
}

/// An island that begins in the air.
#[derive(Debug, Clone, Copy)]
struct Begin {
    /// The layers right below it in which nothing of the part is printed.
    clear: usize,
    /// How far to the side the layer below is printed, in heights of the layer.
    lean: Option<f64>,
    number: usize,
    layer: usize,
    z: Coord,
    at: Point,
    length: f64,
}

/// What is known of the layers so far.
#[derive(Debug)]
pub struct Footing {
    rule: Floating,
    /// Layers that stay open between support and the part.
    gap: usize,
    below: Footprint,
    /// The islands of each body.
    bodies: Sets,
    /// Whether the body with this number as its root stands.
    stands: Vec<bool>,
    /// Length of the lines of the body with this number as its root, grid units.
    lengths: Vec<f64>,
    /// Length of the lines of all bodies, grid units.
    islands_length: f64,
    support: Carried,
    droop: Droop,
    /// Whether each layer is printed.
    printed: Vec<bool>,
    /// The layers up to the last one in which some of the part is printed.
    part: usize,
    tops: Vec<Coord>,
    begins: Vec<Begin>,
    /// The middle of the layout in the machine's coordinates, mm.
    offset: [f64; 2],
    /// What may keep support away, if it is asked for.
    keepers: Option<Keepers>,
    /// What lifts the print: places are told as they are in the file.
    lift: Lift,
}

impl Footing {
    /// Nothing is printed yet. `offset` is the middle of the layout in the machine's coordinates.
    #[must_use]
    pub fn new(settings: &Settings, offset: [f64; 2]) -> Self {
        let support = &settings.support;
        let gap = (support.z_distance / settings.layer_height).round() as usize;
        let gap = if support.enabled { gap } else { 0 };
        Self {
            rule: settings.floating,
            gap,
            below: Footprint::default(),
            bodies: Sets::default(),
            stands: Vec::new(),
            lengths: Vec::new(),
            islands_length: 0.0,
            support: Carried::new(gap + settings.dual_ratio().max(1) as usize + 1),
            droop: Droop::default(),
            printed: Vec::new(),
            part: 0,
            tops: Vec::new(),
            begins: Vec::new(),
            offset,
            keepers: Keepers::new(settings),
            lift: Lift::new(settings),
        }
    }

    /// Links the next layer, that of `region`, with the one below. `stretches` are those of its walls.
    pub fn layer(&mut self, mut print: Footprint, stretches: &[Stretch], region: &Region) {
        let k = self.printed.len();
        self.printed.push(false);
        self.tops.push(region.layer.z);
        let from = (k + 1).saturating_sub(print.layers as usize);
        self.printed[from..].fill(print.layers > 0);
        let below = std::mem::take(&mut self.below);
        for island in &mut print.islands {
            island.number = self.bodies.add();
            self.stands.push(k == 0);
            self.lengths.push(island.length);
            self.islands_length += island.length;
            let touches = self.link(island, &below) && island.lies_on(&below);
            if k > 0 && !touches && !self.on_support(island) {
                let beside = below.islands.iter().map(|other| island.distance(other));
                let nearest = beside.reduce(f64::min);
                let height = f64::from(region.layer.z - self.tops[k - 1]);
                self.begins.push(Begin {
                    clear: k - self.part,
                    lean: nearest.map(|nearest| nearest / height.max(1.0)),
                    number: island.number,
                    layer: k,
                    z: region.layer.z,
                    at: island.outer()[0],
                    length: island.length,
                });
            }
        }
        if !print.islands.is_empty() {
            self.part = k + 1;
        }
        self.droop.layer(stretches, region, &below, &self.support);
        self.below = print;
        self.support.push(region.support.clone());
    }

    /// Joins an island with all islands below that it touches. Returns whether there are any.
    fn link(&mut self, island: &Island, below: &Footprint) -> bool {
        let mut touches = false;
        let mut unclear = Vec::new();
        for other in below.around(island) {
            if island.has_corner_in(other) || other.has_corner_in(island) {
                touches = true;
                self.join(island.number, other.number);
            } else {
                unclear.push(other);
            }
        }
        for other in unclear {
            let (a, b) = (self.bodies.root(island.number), self.bodies.root(other.number));
            let matters = !touches || (a != b && !(self.stands[a] && self.stands[b]));
            if matters && island.overlaps(other) {
                touches = true;
                self.join(island.number, other.number);
            }
        }
        touches
    }

    /// Whether support ends just below an island. Its body then stands.
    fn on_support(&mut self, island: &Island) -> bool {
        // The corners tell nearly always. Where walls are near, support ends before them.
        let stands = self.support.carries_any(island.corners())
            || self.support.carries_some_of(island.contours());
        if stands {
            let root = self.bodies.root(island.number);
            self.stands[root] = true;
        }
        stands
    }

    fn join(&mut self, a: usize, b: usize) {
        if let Some((body, joined)) = self.bodies.join(a, b) {
            self.stands[body] |= self.stands[joined];
            self.lengths[body] += self.lengths[joined];
        }
    }

    /// What the print begins in the air with, the reason to refuse it or a warning; and a warning of what droops.
    ///
    /// # Errors
    /// [`Hanging`], if the settings do not ask for a warning instead.
    pub fn finish(mut self) -> Result<Vec<Warning>, Hanging> {
        let rule = self.rule;
        let found = self.empty_layers().or_else(|| self.hanging_body());
        if let Some(hanging) = found.filter(|_| rule != Floating::Warn) {
            return Err(hanging);
        }
        let droop = self.droop.warning(self.offset, &self.lift, self.keepers.is_some());
        let Some(first) = self.begins.first().copied() else {
            return Ok(droop.into_iter().collect());
        };
        let length: f64 = self.begins.iter().map(|b| b.length).sum();
        let (places, length_mm) = (self.begins.len(), sum_mm(length as i64));
        let (layer, z_mm, at_mm) = self.place(first);
        let kept_away = self.kept_away(first);
        if rule == Floating::RefuseAll {
            return Err(Hanging::Places { places, length_mm, layer, z_mm, at_mm, kept_away });
        }
        let kept_away = kept_away.map(str::to_owned);
        let begins = Warning::BeginsInTheAir { places, length_mm, layer, z_mm, at_mm, kept_away };
        Ok(std::iter::once(begins).chain(droop).collect())
    }

    /// Layers without plastic below the first one with plastic, or between two. Where support carries
    /// the part, a gap is meant.
    fn empty_layers(&self) -> Option<Hanging> {
        let mut printed = (0..self.printed.len()).filter(|&k| self.printed[k]);
        let first = printed.next()?;
        let (from, until) = if first > 0 {
            (0, first - 1)
        } else {
            let steps = std::iter::once(0).chain(printed.clone()).zip(printed);
            let (before, after) = steps.into_iter().find(|(a, b)| b - a > 1 + self.gap)?;
            (before + 1, after - 1)
        };
        let bottom = from.checked_sub(1).map_or(0, |k| self.tops[k]);
        let gap_mm = to_mm(self.tops[until] - bottom);
        let kept_away = self.keepers.map(|keepers| keepers.of((until + 1 - from, self.gap), None));
        let below = 1 + self.lift.layers();
        let (from_bed, from, until) = (from == 0, from + below, until + below);
        Some(Hanging::EmptyLayers { from, until, gap_mm, from_bed, kept_away })
    }

    /// A body that never stands.
    fn hanging_body(&mut self) -> Option<Hanging> {
        let all: f64 = self.islands_length / UNITS_PER_MM;
        let least = Floating::least_body(all) * UNITS_PER_MM;
        let mut hangs = |begin: &&Begin| {
            let body = self.bodies.root(begin.number);
            !self.stands[body] && self.lengths[body] >= least
        };
        let first = *self.begins.iter().find(|begin| hangs(begin))?;
        let (layer, z_mm, at_mm) = self.place(first);
        let below = first.layer.checked_sub(1).map_or(0, |k| self.tops[k]) + self.lift.by();
        let kept_away = self.kept_away(first);
        Some(Hanging::Body { layer, z_mm, above_bed_mm: to_mm(below), at_mm, kept_away })
    }

    fn kept_away(&self, begin: Begin) -> Option<&'static str> {
        self.keepers.map(|keepers| keepers.of((begin.clear, self.gap), begin.lean))
    }

    /// Layer, counted from 1; top of the layer; x and y in the machine's coordinates, mm.
    fn place(&self, begin: Begin) -> (usize, f64, [f64; 2]) {
        let at = [self.offset[0] + to_mm(begin.at.x), self.offset[1] + to_mm(begin.at.y)];
        (begin.layer + 1 + self.lift.layers(), to_mm(begin.z + self.lift.by()), at)
    }
}
