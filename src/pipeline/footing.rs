//! Paths of successive layers -> Footing: what begins in the air, judged on what is printed.
//!
//! Words:
//! - An *island* is one outer contour with the paths inside it. It is *printed* if there are any.
//! - Two islands of successive layers *touch* if they share an area.
//! - A *body* is all printed islands that touch each other, directly or through others. It *stands*
//!   if one of its islands is on the first layer or on support.
//! - An island *begins in the air* if it touches no printed island below and no support.
//!
//! Algorithm: [`footprint`] looks at each layer alone, in parallel. [`Footing::layer`] links each
//! layer with the one below. A corner of one island inside the other shows at once that they
//! touch, which is nearly always so. Only where no such corner is found, and it would change the
//! verdict, the contours are subtracted from each other.
//!
//! Bodies are only known at the end: two arms that begin in the air on their own may meet what
//! stands further up. So a job is refused after its last layer, before its output is complete.

use crate::error::Hanging;
use crate::fill::{Path, Place};
use crate::geom::sets::Sets;
use crate::geom::{Contour, Point, double_area, edges, encloses, polygon};
use crate::profile::{Floating, Settings};
use crate::region::{Region, Sparse, SupportLines};
use crate::units::{Coord, UNITS_PER_MM, sum_mm, to_mm};
use crate::warning::Warning;
use std::collections::VecDeque;

/// Corners of an island that are tried. More find smaller overlaps without subtracting contours.
const CORNERS: usize = 24;

/// A smaller share of an island's area is no overlap: contours that only meet leave slivers.
const LEAST_SHARE: f64 = 1e-3;

/// What a layer prints, as far as the layers around it need to know.
#[derive(Debug, Default)]
pub struct Footprint {
    /// All contours of the layer.
    contours: Vec<Contour>,
    islands: Vec<Island>,
    /// How many layers its paths are printed for, at most; 0 without paths.
    layers: u32,
}

/// A printed island.
#[derive(Debug)]
struct Island {
    outer: Contour,
    low: Point,
    high: Point,
    /// Length of its paths, grid units.
    length: f64,
    /// Its number; islands count through all layers.
    number: usize,
}

/// The footprint of a layer with these `paths`.
#[must_use]
pub fn footprint(region: &Region, paths: &[Path]) -> Footprint {
    let contours = &region.layer.contours;
    let outer = contours.iter().filter(|c| double_area(c) > 0);
    let mut islands: Vec<Island> = outer.map(|c| Island::new(c.clone())).collect();
    for path in paths.iter().filter(|path| path.role.facts().place != Place::Helper) {
        let at = path.start();
        let holds = |(_, island): &(usize, &Island)| islands.len() == 1 || island.contains(at);
        let all = islands.iter().enumerate().filter(holds);
        // Of nested contours the one with the smallest box is the path's own.
        let own = all.min_by_key(|(k, i)| (i.low.distance2(i.high), *k)).map(|(k, _)| k);
        if let Some(k) = own {
            let steps = path.points.windows(2).map(|p| p[0].at.distance(p[1].at));
            islands[k].length += steps.sum::<f64>();
        }
    }
    islands.retain(|island| island.length > 0.0);
    let layers = paths.iter().map(|path| path.layers).max().unwrap_or(0);
    Footprint { contours: contours.clone(), islands, layers }
}

impl Island {
    fn new(outer: Contour) -> Self {
        let xs = || outer.iter().map(|p| p.x);
        let ys = || outer.iter().map(|p| p.y);
        let bound = |x: Option<Coord>, y: Option<Coord>| Point {
            x: x.unwrap_or_default(),
            y: y.unwrap_or_default(),
        };
        let (low, high) = (bound(xs().min(), ys().min()), bound(xs().max(), ys().max()));
        Self { outer, low, high, length: 0.0, number: 0 }
    }

    fn boxes_meet(&self, other: &Self) -> bool {
        self.low.x <= other.high.x
            && other.low.x <= self.high.x
            && self.low.y <= other.high.y
            && other.low.y <= self.high.y
    }

    fn contains(&self, p: Point) -> bool {
        (self.low.x..=self.high.x).contains(&p.x)
            && (self.low.y..=self.high.y).contains(&p.y)
            && encloses(edges(&self.outer), p)
    }

    /// Some of its corners, evenly spread.
    fn corners(&self) -> impl Iterator<Item = Point> {
        let step = self.outer.len().div_ceil(CORNERS).max(1);
        self.outer.iter().step_by(step).copied()
    }

    /// Whether a corner of `self` lies inside `other`, whose layer has these `contours`.
    fn has_corner_in(&self, other: &Self, contours: &[Contour]) -> bool {
        let inside =
            |p: Point| other.contains(p) && encloses(contours.iter().flat_map(|c| edges(c)), p);
        self.corners().any(inside)
    }

    /// Whether the two share an area.
    fn overlaps(&self, other: &Self, contours: &[Contour]) -> bool {
        let own = [self.outer.clone()];
        let area = |all: &[Contour]| all.iter().map(double_area_of).sum::<f64>();
        let mut left = polygon::difference(&own, std::slice::from_ref(&other.outer), 0);
        // What lies in a hole of the other does not touch it.
        let holes = contours.iter().filter(|c| double_area(c) < 0);
        let holes: Vec<Contour> = holes
            .filter(|c| other.contains(c[0]))
            .map(|c| c.iter().rev().copied().collect())
            .collect();
        let outside_holes = polygon::difference(&own, &holes, 0);
        let in_holes = area(&own) - area(&outside_holes);
        let outside = area(&std::mem::take(&mut left));
        area(&own) - outside - in_holes > LEAST_SHARE * area(&own)
    }
}

fn double_area_of(contour: &Contour) -> f64 {
    double_area(contour) as f64
}

/// An island that begins in the air.
#[derive(Debug, Clone, Copy)]
struct Begin {
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
    /// Layers whose support may carry an island.
    reach: usize,
    below: Footprint,
    /// The islands of each body.
    bodies: Sets,
    /// Whether the body with this number as its root stands.
    stands: Vec<bool>,
    /// Length of the lines of the body with this number as its root, grid units.
    lengths: Vec<f64>,
    support: VecDeque<SupportLines>,
    /// Whether each layer is printed.
    printed: Vec<bool>,
    tops: Vec<Coord>,
    begins: Vec<Begin>,
    /// The middle of the layout in the machine's coordinates, mm.
    offset: [f64; 2],
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
            reach: gap + settings.dual_ratio().max(1) as usize + 1,
            below: Footprint::default(),
            bodies: Sets::default(),
            stands: Vec::new(),
            lengths: Vec::new(),
            support: VecDeque::new(),
            printed: Vec::new(),
            tops: Vec::new(),
            begins: Vec::new(),
            offset,
        }
    }

    /// Links the next layer, that of `region`, with the one below.
    pub fn layer(&mut self, mut print: Footprint, region: &Region) {
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
            let touches = self.link(island, &print.contours, &below);
            if k > 0 && !touches && !self.on_support(island) {
                self.begins.push(Begin {
                    number: island.number,
                    layer: k,
                    z: region.layer.z,
                    at: island.outer[0],
                    length: island.length,
                });
            }
        }
        self.below = print;
        self.support.push_back(region.support.clone());
        if self.support.len() > self.reach {
            self.support.pop_front();
        }
    }

    /// Joins an island with all islands below that it touches. Returns whether there are any.
    fn link(&mut self, island: &Island, contours: &[Contour], below: &Footprint) -> bool {
        let mut touches = false;
        let mut unclear = Vec::new();
        for other in below.islands.iter().filter(|other| island.boxes_meet(other)) {
            let corner = island.has_corner_in(other, &below.contours)
                || other.has_corner_in(island, contours);
            if corner {
                touches = true;
                self.join(island.number, other.number);
            } else {
                unclear.push(other);
            }
        }
        for other in unclear {
            let (a, b) = (self.bodies.root(island.number), self.bodies.root(other.number));
            let matters = !touches || (a != b && !(self.stands[a] && self.stands[b]));
            if matters && island.overlaps(other, &below.contours) {
                touches = true;
                self.join(island.number, other.number);
            }
        }
        touches
    }

    /// Whether support ends just below an island. Its body then stands.
    fn on_support(&mut self, island: &Island) -> bool {
        let inside = |sparse: &Sparse, p: Point| {
            let raster = sparse.pattern.raster();
            let Point { x: u, y: v } = raster.frame.enter(p);
            let row = sparse.rows.row((v + raster.pitch / 2).div_euclid(raster.pitch));
            row.iter().any(|span| span.start <= u && u <= span.end)
        };
        let carries = |sparse: &Sparse| island.corners().any(|p| inside(sparse, p));
        let stands = self.support.iter().any(|support| support.areas().any(carries));
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

    /// What the print begins in the air with: the reason to refuse it, or a warning.
    ///
    /// # Errors
    /// [`Hanging`], if the settings do not ask for a warning instead.
    pub fn finish(mut self) -> Result<Option<Warning>, Hanging> {
        let rule = self.rule;
        let found = self.empty_layers().or_else(|| self.hanging_body());
        if let Some(hanging) = found.filter(|_| rule != Floating::Warn) {
            return Err(hanging);
        }
        let Some(first) = self.begins.first().copied() else { return Ok(None) };
        let length: f64 = self.begins.iter().map(|b| b.length).sum();
        let (places, length_mm) = (self.begins.len(), sum_mm(length as i64));
        let (layer, z_mm, at_mm) = self.place(first);
        if rule == Floating::RefuseAll {
            return Err(Hanging::Places { places, length_mm, layer, z_mm, at_mm });
        }
        Ok(Some(Warning::BeginsInTheAir { places, length_mm, layer, z_mm, at_mm }))
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
        Some(Hanging::EmptyLayers { from: from + 1, until: until + 1, gap_mm, from_bed: from == 0 })
    }

    /// A body that never stands.
    fn hanging_body(&mut self) -> Option<Hanging> {
        let least = Floating::LEAST_BODY * UNITS_PER_MM;
        let mut hangs = |begin: &&Begin| {
            let body = self.bodies.root(begin.number);
            !self.stands[body] && self.lengths[body] >= least
        };
        let first = *self.begins.iter().find(|begin| hangs(begin))?;
        let (layer, z_mm, at_mm) = self.place(first);
        let below = layer.checked_sub(2).map_or(0, |k| self.tops[k]);
        Some(Hanging::Body { layer, z_mm, above_bed_mm: to_mm(below), at_mm })
    }

    /// Layer, counted from 1; top of the layer; x and y in the machine's coordinates, mm.
    fn place(&self, begin: Begin) -> (usize, f64, [f64; 2]) {
        let at = [self.offset[0] + to_mm(begin.at.x), self.offset[1] + to_mm(begin.at.y)];
        (begin.layer + 1, to_mm(begin.z), at)
    }
}
