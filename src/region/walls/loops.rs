//! Loop and layout -> loop of changing width: passes move and widen where they share the room.
//!
//! Each side of the loop is sampled once for each line width. A sample asks for the share of the
//! beads at its place. Between samples the loop goes straight; at a corner it goes where its two
//! moved sides meet.

use super::{Layout, Wall};
use crate::geom::segment::{along, dot, way};
use crate::geom::{Contour, Point, edges};
use crate::region::near::Near;
use crate::region::taper::{Place, tapered};

/// Smaller cross products of two sides' directions count as straight on: the corner moves along
/// the mean normal. Two nearly parallel lines meet too far away.
const STRAIGHT: f64 = 0.2;

/// How near a middle bead has to be to the middle of a place, in line widths, to lie there. Samples of
/// both are up to a line apart.
const BEAD: f64 = 0.5;

/// The bead at one place of a side.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Sample {
    /// How far the centre line moves inwards.
    shift: f64,
    width: f64,
}

/// A side of the loop with its samples, evenly spaced.
struct Sampled {
    from: [f64; 2],
    way: [f64; 2],
    normal: [f64; 2],
    samples: Vec<Sample>,
}

/// Moves and widens `wall`, a loop, where it shares the room. `beads` are the middle beads.
pub(super) fn share(wall: &mut Wall, beads: &Near, layout: &Layout<'_>) {
    let sides = sampled(&wall.path, wall.depth, beads, layout);
    let plain = Sample { shift: 0.0, width: layout.line_width };
    if sides.iter().flat_map(|s| &s.samples).all(|s| *s == plain) {
        return;
    }
    let n = sides.len();
    let mut places = Vec::new();
    for (k, side) in sides.iter().enumerate() {
        places.push(corner(&sides[(k + n - 1) % n], side));
        let count = side.samples.len() as f64;
        places.extend(side.samples.iter().enumerate().map(|(i, s)| {
            let on = along(side.from, (i as f64 + 0.5) / count, side.way);
            Place { at: along(on, s.shift, side.normal), width: s.width }
        }));
    }
    places.extend(places.first().copied());
    let (mut path, mut widths) = tapered(&places);
    // The last place repeats the first. What leads to it is the width of the first.
    path.pop();
    if let (Some(last), Some(first)) = (widths.pop(), widths.first_mut()) {
        *first = last;
    }
    (wall.path, wall.widths) = (path, widths);
}

fn sampled(path: &Contour, depth: u32, beads: &Near, layout: &Layout<'_>) -> Vec<Sampled> {
    let float = |p: Point| [f64::from(p.x), f64::from(p.y)];
    let mut guess = layout.line_width;
    let sides = edges(path).filter(|(p, q)| p != q).map(|(p, q)| {
        let (from, length) = (float(p), p.distance(q));
        let way = way(from, float(q));
        let normal = [-way[1] / length, way[0] / length];
        let count = (length / layout.line_width).ceil();
        let sample = |i: usize| {
            let at = along(from, (i as f64 + 0.5) / count, way);
            sample(at, normal, depth, (beads, layout), &mut guess)
        };
        Sampled { from, way, normal, samples: (0..count as usize).map(sample).collect() }
    });
    sides.collect()
}

/// The bead of a loop of this `depth` at the place `at` of its nominal centre line.
fn sample(
    at: [f64; 2],
    normal: [f64; 2],
    depth: u32,
    (beads, layout): (&Near, &Layout<'_>),
    guess: &mut f64,
) -> Sample {
    let inset = layout.inset(depth);
    let foot = along(at, -inset, normal);
    match layout.share(foot, normal, guess).filter(|(share, _)| share.loops > depth) {
        Some((share, opposite)) => {
            // What is laid decides, not what each place on its own would take.
            let middle = along(foot, opposite.radius, normal);
            let has_bead = !beads.is_free([middle], BEAD * layout.line_width);
            let count = f64::from(2 * share.loops + u32::from(has_bead));
            let width = share.room / count;
            let middle = (f64::from(depth) + 0.5) * width - layout.outside();
            Sample { shift: middle - inset, width }
        }
        None => Sample { shift: 0.0, width: layout.line_width },
    }
}

/// The corner between two sides: where the moved sides meet.
fn corner(before: &Sampled, after: &Sampled) -> Place {
    let (Some(a), Some(b)) = (before.samples.last(), after.samples.first()) else {
        return Place { at: after.from, width: 0.0 };
    };
    // A short side, such as the end of a bar, must not change the width all along a long one.
    let width = if before.samples.len() > after.samples.len() { a.width } else { b.width };
    let (m, n) = (before.normal, after.normal);
    let cross = m[0] * n[1] - m[1] * n[0];
    let by = if cross.abs() < STRAIGHT {
        let mean = f64::midpoint(a.shift, b.shift) / (1.0 + dot(m, n)).max(STRAIGHT);
        [0, 1].map(|k| (m[k] + n[k]) * mean)
    } else {
        [(a.shift * n[1] - b.shift * m[1]) / cross, (b.shift * m[0] - a.shift * n[0]) / cross]
    };
    Place { at: [0, 1].map(|k| after.from[k] + by[k]), width }
}
