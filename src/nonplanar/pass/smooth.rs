//! Outline of what passes -> the same without steps and teeth that are too small for its lines.
//!
//! A scan's surface ends in steps, facet by facet, and so does what is left around refused places. Lines lie
//! side by side, so that a step of half a line leaves a gap or a stub. So steps are levelled, always inwards:
//! nothing is added to what passes.
//!
//! Words: an outline has the area to its left. It turns right at a *notch*. A *tooth* is what lies between
//! two notches.
//!
//! 1. A tooth no further out than a line is wide goes, if it is no longer than [`LONGEST`] lines.
//! 2. At each end of another tooth, the step from the notch is made a ramp of [`RAMP`] lines: then a line's
//!    turn runs along it.
//!
//! Where the part ends upright, the outline stays: what is cut off there would stand alone, too thin to be
//! printed.

use super::marks::Marks;
use crate::geom::segment::distance2;
use crate::geom::{Contour, Point, polygon, side};
use crate::units::{Coord, nearest};

/// Teeth of so many line widths in length are levelled.
const LONGEST: f64 = 12.0;

/// A step becomes a ramp of so many line widths.
const RAMP: f64 = 5.0;

/// Turns of less are none: the sine of 15°. A ramp up to a line's width makes less.
const LEAST_TURN: f64 = 0.26;

/// Levelled teeth may be teeth of a larger one.
const ROUNDS: usize = 3;

/// An area without small steps; the same if there are none.
pub(super) fn smooth(area: Vec<Contour>, marks: &Marks, line_width: Coord) -> Vec<Contour> {
    let mut changed = false;
    let mut out = Vec::with_capacity(area.len());
    for contour in &area {
        let mut own = contour.clone();
        for _ in 0..ROUNDS {
            let Some(levelled) = levelled(&own, marks, f64::from(line_width)) else { break };
            (own, changed) = (levelled, true);
        }
        out.push(own);
    }
    if changed { polygon::intersection(&area, &polygon::union(&out)) } else { area }
}

/// A contour with its teeth levelled once; `None` if there are none.
fn levelled(contour: &Contour, marks: &Marks, width: f64) -> Option<Contour> {
    let n = contour.len();
    let notches: Vec<usize> = (0..n).filter(|&k| is_notch(contour, k)).collect();
    let mut changed = false;
    let mut out = Vec::with_capacity(n);
    for (k, &from) in notches.iter().enumerate() {
        let next = notches[(k + 1) % notches.len()];
        let to = if next > from { next } else { next + n };
        let tooth: Vec<Point> = (from..=to).map(|k| contour[k % n]).collect();
        let is_fixed = |part: &[Point]| part.windows(2).any(|w| marks.is_upright(w[0], w[1]));
        let whole = from != next
            && is_out(&tooth, width, 1)
            && tooth[0].distance(tooth[tooth.len() - 1]) <= LONGEST * width
            && !is_fixed(&tooth);
        if tooth.len() > 2 && whole {
            out.push(tooth[0]);
            changed = true;
            continue;
        }
        let (start, first) = ramp(&tooth, width, 1, &is_fixed);
        let mut rest: Vec<Point> = tooth[start..].to_vec();
        rest.reverse();
        let (end, last) = ramp(&rest, width, -1, &is_fixed);
        changed |= first.is_some() || last.is_some();
        out.extend([tooth[0]].into_iter().chain(first));
        let middle = &tooth[start.max(1)..tooth.len() - end.max(1)];
        out.extend(middle.iter().copied().chain(last));
    }
    (changed && out.len() > 2).then_some(out)
}

/// How many points of a tooth a ramp from its start replaces, and where the ramp ends. `way` is -1 if the
/// tooth comes from its end.
fn ramp(
    tooth: &[Point],
    width: f64,
    way: i64,
    is_fixed: &dyn Fn(&[Point]) -> bool,
) -> (usize, Option<Point>) {
    let length: f64 = tooth.windows(2).map(|w| w[0].distance(w[1])).sum();
    let mut left = (RAMP * width).min(length / 3.0);
    for (k, ends) in tooth.windows(2).enumerate() {
        let own = ends[0].distance(ends[1]);
        if own < left {
            left -= own;
            continue;
        }
        let on =
            |a: Coord, b: Coord| nearest(f64::from(a) + f64::from(b - a) * left / own) as Coord;
        let end = Point { x: on(ends[0].x, ends[1].x), y: on(ends[0].y, ends[1].y) };
        let mut part = tooth[..=k].to_vec();
        part.push(end);
        let is_step = k > 0 && is_out(&part, width, way) && !is_fixed(&part);
        return if is_step { (k + 1, Some(end)) } else { (0, None) };
    }
    (0, None)
}

/// Whether all points lie to the right of the way from the first to the last, or to the left if `way` is -1,
/// some of them off it, none further than `most`.
fn is_out(part: &[Point], most: f64, way: i64) -> bool {
    let (Some(&a), Some(&b)) = (part.first(), part.last()) else { return false };
    let at = |p: Point| [f64::from(p.x), f64::from(p.y)];
    let off = |p: &Point| distance2(at(*p), [at(a), at(b)]).sqrt();
    part.iter().all(|p| way * side(a, b, *p) <= 0 && off(p) <= most)
        && part.iter().any(|p| off(p) > 1.0)
}

/// Whether a contour turns right at a corner.
fn is_notch(contour: &Contour, k: usize) -> bool {
    let n = contour.len();
    let (a, b, c) = (contour[(k + n - 1) % n], contour[k], contour[(k + 1) % n]);
    let lengths = a.distance(b) * b.distance(c);
    (side(a, b, c) as f64) < -LEAST_TURN * lengths
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::double_area;

    fn contour(points: &[[i32; 2]]) -> Contour {
        points.iter().map(|&[x, y]| Point { x: x * 1_000, y: y * 1_000 }).collect()
    }

    fn area(contours: &[Contour]) -> f64 {
        contours.iter().map(|c| double_area(c)).sum::<i128>() as f64 / 2e6
    }

    /// A plate of 20 by 10 mm whose upper side has a tooth, and then a step, 0.3 mm each.
    fn jagged() -> Contour {
        contour(&[
            [0, 0],
            [200, 0],
            [200, 103],
            [120, 103],
            [120, 100],
            [60, 100],
            [55, 103],
            [50, 103],
            [45, 100],
            [0, 100],
        ])
    }

    #[test]
    fn teeth_go_and_steps_become_ramps() {
        let whole = vec![jagged()];
        let smoothed = smooth(whole.clone(), &Marks::default(), 3_600);
        // The tooth, and a triangle as high as the step.
        let less = area(&whole) - area(&smoothed);
        let (tooth, ramp) = (3.0 * 10.0, 3.0 * 5.0 * 3.6 / 2.0);
        assert!((less - tooth - ramp).abs() < 6.0, "{less} {tooth} {ramp}");
        assert_eq!(polygon::difference(&smoothed, &whole, 1), Vec::<Contour>::new());
        // Once smooth, it stays so.
        assert_eq!(smooth(smoothed.clone(), &Marks::default(), 3_600), smoothed);
    }

    #[test]
    fn what_is_larger_than_a_line_stays() {
        let ell = contour(&[[0, 0], [200, 0], [200, 100], [100, 100], [100, 50], [0, 50]]);
        let comb = contour(&[[0, 0], [200, 0], [200, 100], [120, 100], [120, 90], [0, 90]]);
        for whole in [vec![ell], vec![comb]] {
            assert_eq!(smooth(whole.clone(), &Marks::default(), 3_600), whole);
        }
    }
}
