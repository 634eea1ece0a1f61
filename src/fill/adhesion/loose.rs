//! Islands of the first layer -> which of them would come loose without a brim.
//!
//! A part comes loose in two ways:
//!
//! - *It is pushed over.* The nozzle drags at what it prints. The higher that is, and the smaller the
//!   foot, the harder the edge of the foot pulls at the bed. A push of 1 N at height h (mm) pulls there
//!   with h / S N/mm², where S (mm³) is the foot's section modulus in its weakest direction, that is
//!   b d² / 6 for a rectangle. From 0.25 N/mm² on a foot needs a brim: a tower of 10 × 10 mm from
//!   42 mm of height on, one of 5 × 5 mm from 5.2 mm on, a wall 2 mm thick and 60 mm long from 10 mm on.
//! - *A corner curls.* Plastic shrinks as it cools, and pulls the ends of the part up. A pointed corner
//!   has little area to hold against it: one of less than 40°, measured over 5 mm, needs a brim if the
//!   part rises by 10 mm.
//!
//! An island by itself stands until it grows together with another one: a leg of a table is as high
//! as the leg. One that does so within 2 mm is held soon enough. All islands of a body stand together,
//! then for its whole height.

use crate::geom::nest::Nest;
use crate::geom::{Contour, Point, edges, side};
use crate::units::{Bounded as _, Coord, UNITS_PER_MM, to_mm};

/// The hardest pull, N/mm² for each N, that a foot holds without a brim.
const MOST_PULL: f64 = 0.25;

/// Corners are measured over this length, mm, …
const TIP: f64 = 5.0;

/// … and are sharp above this cosine, of 40°.
const SHARP: f64 = 0.766;

/// Lower parts do not shrink enough to lift a corner, mm.
const LEAST_CURLING: f64 = 10.0;

/// An island that grows together with another one before this height, mm, is held soon enough: what
/// is left standing inside letters that are cut into the bottom.
const LEAST_ALONE: f64 = 2.0;

/// Why an island would come loose.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Loose {
    /// All of the body's feet are small for its height.
    Tall,
    /// The island is small for the height that it rises alone.
    ThinFoot,
    /// It has a sharp corner.
    SharpCorner,
}

impl Loose {
    /// In a few words.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Self::Tall => "high on a small foot",
            Self::ThinFoot => "a thin foot",
            Self::SharpCorner => "a sharp corner",
        }
    }
}

/// How high what stands on an island rises, grid units.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Rise {
    /// Until it grows together with what stands on another island.
    pub alone: Coord,
    /// To the top of the body that it is of.
    pub whole: Coord,
    /// The number of that body.
    pub body: usize,
}

/// The outer contours that would come loose, and why. `rise` gives a [`Rise`] for each contour; those
/// of holes do not matter. It is not asked if no island could come loose if it rose to `top`.
pub(super) fn loose(
    contours: &[Contour],
    nest: &Nest,
    top: Coord,
    rise: impl FnOnce(&[Contour]) -> Vec<Rise>,
) -> Vec<(usize, Loose)> {
    let feet: Vec<(usize, Moments, bool)> = nest
        .outer()
        .map(|k| {
            let parts = std::iter::once(k).chain(nest.within(Some(k)));
            let moments = Moments::of(parts.map(|k| &contours[k]));
            (k, moments, has_sharp_corner(&contours[k]))
        })
        .collect();
    let could = |(_, moments, is_sharp): &(usize, Moments, bool)| {
        moments.pull(top) > MOST_PULL || *is_sharp && to_mm(top) >= LEAST_CURLING
    };
    if !feet.iter().any(could) {
        return Vec::new();
    }
    let rises = rise(contours);
    // How hard each foot's body pulls at all of its feet.
    let mut by_body: Vec<(usize, usize)> =
        (0..feet.len()).filter_map(|at| Some((rises.get(feet[at].0)?.body, at))).collect();
    by_body.sort_unstable();
    let mut pulls = vec![0.0; feet.len()];
    for body in by_body.chunk_by(|a, b| a.0 == b.0) {
        let moments = body.iter().map(|&(_, at)| &feet[at].1);
        let all = moments.fold(Moments::default(), |a, b| a.and(b));
        let pull = all.pull(rises[feet[body[0].1].0].whole);
        body.iter().for_each(|&(_, at)| pulls[at] = pull);
    }
    let mut found = Vec::new();
    for ((k, moments, is_sharp), pull) in feet.iter().zip(pulls) {
        let Some(Rise { alone, .. }) = rises.get(*k).copied() else { continue };
        let why = if pull > MOST_PULL {
            Loose::Tall
        } else if moments.pull(alone) > MOST_PULL && to_mm(alone) >= LEAST_ALONE {
            Loose::ThinFoot
        } else if *is_sharp && to_mm(alone) >= LEAST_CURLING {
            Loose::SharpCorner
        } else {
            continue;
        };
        found.push((*k, why));
    }
    found
}

/// Area and moments of a foot, mm, and the box around it.
#[derive(Debug, Clone, Default)]
struct Moments {
    area: f64,
    /// First moments: ∫x, ∫y.
    first: [f64; 2],
    /// Second moments: ∫x², ∫y², ∫xy.
    second: [f64; 3],
    outline: Vec<[f64; 2]>,
}

impl Moments {
    fn of<'a>(contours: impl Iterator<Item = &'a Contour>) -> Self {
        let mut sum = Self::default();
        let mm = |p: Point| [p.x, p.y].map(|c| f64::from(c) / UNITS_PER_MM);
        for (k, contour) in contours.enumerate() {
            for (a, b) in edges(contour) {
                let ([x1, y1], [x2, y2]) = (mm(a), mm(b));
                let cross = x1 * y2 - x2 * y1;
                sum.area += cross / 2.0;
                sum.first[0] += cross * (x1 + x2) / 6.0;
                sum.first[1] += cross * (y1 + y2) / 6.0;
                sum.second[0] += cross * (x1 * x1 + x1 * x2 + x2 * x2) / 12.0;
                sum.second[1] += cross * (y1 * y1 + y1 * y2 + y2 * y2) / 12.0;
                let mixed = x1 * y2 + 2.0 * x1 * y1 + 2.0 * x2 * y2 + x2 * y1;
                sum.second[2] += cross * mixed / 24.0;
            }
            if k == 0 {
                sum.outline.extend(contour.iter().map(|p| mm(*p)));
            }
        }
        sum
    }

    fn and(mut self, other: &Self) -> Self {
        self.area += other.area;
        (0..2).for_each(|k| self.first[k] += other.first[k]);
        (0..3).for_each(|k| self.second[k] += other.second[k]);
        self.outline.extend_from_slice(&other.outline);
        self
    }

    /// How hard 1 N at this height pulls at the edge of the foot, N/mm².
    fn pull(&self, height: Coord) -> f64 {
        if self.area <= 0.0 {
            return 0.0;
        }
        let middle = self.first.map(|first| first / self.area);
        let xx = self.second[0] - self.first[0] * middle[0];
        let yy = self.second[1] - self.first[1] * middle[1];
        let xy = self.second[2] - self.first[0] * middle[1];
        // The direction in which the foot is narrowest, and its second moment along it.
        let (half, mean) = ((xx - yy) / 2.0, f64::midpoint(xx, yy));
        let spread = (half * half + xy * xy).sqrt();
        let least = (mean - spread).at_least(0.0);
        // Of the two ways to write the direction, the one that is not rounded away.
        let way = if half < 0.0 { [spread - half, -xy] } else { [-xy, spread + half] };
        let length = (way[0] * way[0] + way[1] * way[1]).sqrt();
        let way = if length > 0.0 { way.map(|c| c / length) } else { [1.0, 0.0] };
        let off = |p: &[f64; 2]| ((p[0] - middle[0]) * way[0] + (p[1] - middle[1]) * way[1]).abs();
        let farthest = self.outline.iter().map(off).fold(0.0, f64::max);
        if least > 0.0 { to_mm(height) * farthest / least } else { f64::INFINITY }
    }
}

/// Whether an outer contour has a corner that is sharp over [`TIP`].
fn has_sharp_corner(contour: &Contour) -> bool {
    let tip = TIP * UNITS_PER_MM;
    let round: f64 = edges(contour).map(|(a, b)| a.distance(b)).sum();
    if round < 4.0 * tip {
        return false;
    }
    let n = contour.len();
    (0..n).any(|k| {
        let at = contour[k];
        if side(contour[(k + n - 1) % n], at, contour[(k + 1) % n]) <= 0 {
            return false;
        }
        let ends = [1, n - 1].map(|step| walked(contour, k, step, tip));
        let ways = ends.map(|end| [end[0] - f64::from(at.x), end[1] - f64::from(at.y)]);
        let lengths = ways.map(|way| (way[0] * way[0] + way[1] * way[1]).sqrt());
        let cosine =
            (ways[0][0] * ways[1][0] + ways[0][1] * ways[1][1]) / (lengths[0] * lengths[1]);
        // Both sides run straight, and do not fold back.
        lengths.iter().all(|length| *length > 0.8 * tip) && cosine > SHARP
    })
}

/// The place `length` along a contour from its corner `k`, in steps of `step` corners.
fn walked(contour: &Contour, mut k: usize, step: usize, mut length: f64) -> [f64; 2] {
    let n = contour.len();
    loop {
        let (from, to) = (contour[k], contour[(k + step) % n]);
        let distance = from.distance(to);
        if distance >= length {
            let part = length / distance.at_least(1.0);
            let at = |a: Coord, b: Coord| f64::from(a) + part * (f64::from(b) - f64::from(a));
            return [at(from.x, to.x), at(from.y, to.y)];
        }
        length -= distance;
        k = (k + step) % n;
    }
}
