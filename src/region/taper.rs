//! Places with widths -> polyline: a bead decimated to the places where it bends or its width changes.

use crate::geom::decimate::{decimate, most_missed};
use crate::geom::segment::{along, dot, way};
use crate::geom::{Contour, Point};
use crate::units::{Bounded as _, Coord, nearest};

/// Smaller changes of place give no corner in a bead (10 µm). A smaller value makes more, shorter
/// moves; a larger one lets beads cut corners into the wall.
const LEAST_BEND: f64 = 100.0;

/// Larger changes of width between two points are divided (0.08 mm). A segment has one width, so a
/// long taper needs steps; a larger value makes them visible, and leaves gaps and bulges.
const MOST_STEP: f64 = 800.0;

/// Divisor for changes of width when they are compared with changes of place. A wrong width is
/// shared by both sides of the bead and shows less. At 3 a bar of one width may get 6 % too much
/// plastic; at 1 there are more points than the plastic tells.
const WIDTH_TO_PLACE: f64 = 2.0;

/// Cosine of the turn from which on a bead turns back: 114°. A smaller turn is that of a corner.
const BACK: f64 = -0.4;

/// A place on the centre line of a bead.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Place {
    /// The place, grid units.
    pub at: [f64; 2],
    /// Width of the bead there, grid units.
    pub width: f64,
}

/// The points of a bead, decimated to those where it bends or its width changes, and the width of
/// the bead that leads to each: the mean of the widths at its two ends.
pub(super) fn tapered(places: &[Place]) -> (Contour, Vec<Coord>) {
    let kept = decimate(places.len(), |a, b| bend(places, a, b));
    let mut before = places.first().map_or(0.0, |place| place.width);
    kept.into_iter()
        .map(|k| {
            let Place { at: [x, y], width } = places[k];
            let mean = f64::midpoint(before, width);
            before = width;
            (Point { x: nearest(x) as Coord, y: nearest(y) as Coord }, nearest(mean) as Coord)
        })
        .unzip()
}

/// Takes away the places of a bead from which it would turn back at once, with a step shorter than `short`: beside
/// a jagged wall places jerk to and fro by less than the bead is wide.
pub(super) fn go_on<T: Copy>(bead: &mut Vec<T>, short: f64, at: impl Fn(&T) -> [f64; 2]) {
    let turns_back = |[a, b, c]: [[f64; 2]; 3]| {
        let (to, from) = (way(a, b), way(b, c));
        let lengths = [dot(to, to), dot(from, from)];
        dot(to, from) < BACK * (lengths[0] * lengths[1]).sqrt()
            && lengths[0].at_most(lengths[1]) < short * short
    };
    let mut kept: Vec<T> = Vec::with_capacity(bead.len());
    for place in bead.drain(..) {
        while let [.., a, b] = kept[..]
            && turns_back([at(&a), at(&b), at(&place)])
        {
            kept.pop();
        }
        kept.push(place);
    }
    *bead = kept;
}

/// The place between `a` and `b` to keep: the one that a straight bead would miss most, or the
/// middle of a long taper.
fn bend(places: &[Place], a: usize, b: usize) -> Option<usize> {
    let (first, last) = (places[a], places[b]);
    let chord = way(first.at, last.at);
    let square = dot(chord, chord).at_least(1.0);
    let worst = most_missed(a, b, LEAST_BEND, |k| {
        let t = (dot(way(first.at, places[k].at), chord) / square).at_least(0.0).at_most(1.0);
        let width = first.width + t * (last.width - first.width);
        let foot = along(first.at, t, chord);
        distance(foot, places[k].at).at_least((width - places[k].width).abs() / WIDTH_TO_PLACE)
    });
    // A segment has one width, so a long taper needs steps.
    let tapers = (first.width - last.width).abs() > MOST_STEP && b - a > 1;
    worst.or_else(|| tapers.then_some(usize::midpoint(a, b)))
}

/// The distance of two places.
pub(super) fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    let off = way(a, b);
    dot(off, off).sqrt()
}
