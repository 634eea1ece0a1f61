//! Two lists of lines -> where they stop to be one way: the same places in the same order.
//!
//! Words used here: a *way* is the lines one after the other, however they are divided; two ways
//! *part* where one goes where the other does not.
//!
//! Both are walked at once, each line as far as the shorter of the two goes: its end has to lie on
//! the other. What is left of the longer one is walked on from there. So a way of two files takes one
//! look at each line, and nothing that was walked without a look is longer than the tolerance.

use super::line::{Line, Point};
use crate::geom::segment::{along, dot, nearest_part, way};

/// The first lines, by place, from which on the two are no longer one way within `reach`, mm; `None`
/// if they are one to the end. A place after the last line is the end of the shorter list.
pub(super) fn parting(a: &[Line], b: &[Line], reach: f64) -> Option<(usize, usize)> {
    let mut one = Walk { lines: a, next: 0, at: None };
    let mut other = Walk { lines: b, next: 0, at: None };
    // Where both are.
    let mut here: Option<Point> = None;
    loop {
        let is_here = |rest: [Point; 2]| {
            let at = here.unwrap_or(rest[0]);
            rest.iter().all(|end| length([at, *end]) <= reach)
        };
        let parted = Some((one.next, other.next));
        let (ours, theirs) = match (one.rest(), other.rest()) {
            (None, None) => return None,
            (Some(ours), Some(theirs)) if length([ours[0], theirs[0]]) <= reach => (ours, theirs),
            // What one of them has more must be no way at all.
            (Some(ours), _) if is_here(ours) => {
                here = here.or(Some(ours[0]));
                one.skip();
                continue;
            }
            (_, Some(theirs)) if is_here(theirs) => {
                here = here.or(Some(theirs[0]));
                other.skip();
                continue;
            }
            _ => return parted,
        };
        let (far, near) = (length(ours), length(theirs));
        let end = if far <= near { ours[1] } else { theirs[1] };
        if (far - near).abs() <= reach && length([ours[1], theirs[1]]) <= reach {
            one.skip();
            other.skip();
        } else if far <= near {
            if !other.go_on(end, theirs, reach) {
                return parted;
            }
            one.skip();
        } else {
            if !one.go_on(end, ours, reach) {
                return parted;
            }
            other.skip();
        }
        here = Some(end);
    }
}

/// A walk along lines.
struct Walk<'a> {
    lines: &'a [Line],
    next: usize,
    /// Where it is on the next line, if not at its beginning.
    at: Option<Point>,
}

impl Walk<'_> {
    /// What is left of the next line.
    fn rest(&self) -> Option<[Point; 2]> {
        let line = self.lines.get(self.next)?;
        Some([self.at.unwrap_or(line.from), line.to])
    }

    fn skip(&mut self) {
        self.next = (self.next + 1).min(self.lines.len());
        self.at = None;
    }

    /// Goes along its rest to `end`. Whether that lies on it.
    fn go_on(&mut self, end: Point, [from, to]: [Point; 2], reach: f64) -> bool {
        let rest = way(from, to);
        let at = along(from, nearest_part(way(from, end), rest), rest);
        self.at = Some(at);
        length([at, end]) <= reach
    }
}

fn length([from, to]: [Point; 2]) -> f64 {
    let way = way(from, to);
    dot(way, way).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diff::line::tests::line;

    fn ways(points: &[[f64; 2]]) -> Vec<Line> {
        points.windows(2).map(|ends| line(ends[0], ends[1])).collect()
    }

    #[test]
    fn a_way_may_be_divided_anyhow_but_not_go_elsewhere() {
        let way = ways(&[[0.0, 0.0], [10.0, 0.0], [10.0, 5.0]]);
        let parts = ways(&[[0.0, 0.0], [3.0, 0.005], [4.0, 0.0], [10.0, 0.0], [10.0, 5.0]]);
        assert_eq!(parting(&way, &parts, 0.01), None);
        assert_eq!(parting(&parts, &way, 0.01), None);
        let aside = ways(&[[0.0, 0.0], [3.0, 0.02], [10.0, 0.0], [10.0, 5.0]]);
        assert_eq!(parting(&way, &aside, 0.01), Some((0, 0)));
        // The same places in another order, and one end that is missing.
        let turned = ways(&[[10.0, 5.0], [10.0, 0.0], [0.0, 0.0]]);
        assert_eq!(parting(&way, &turned, 0.01), Some((0, 0)));
        assert_eq!(parting(&way, &way[..1], 0.01), Some((1, 1)));
        assert_eq!(parting(&[], &[], 0.01), None);
    }

    #[test]
    fn many_short_ways_do_not_add_up_unseen() {
        let points: Vec<[f64; 2]> = (0..=200).map(|k| [0.0, 0.008 * f64::from(k)]).collect();
        let back = points.iter().chain(points.iter().rev().skip(1)).copied().collect::<Vec<_>>();
        assert!(parting(&ways(&back), &[], 0.01).is_some());
        assert!(parting(&ways(&back), &ways(&[[0.0, 0.0], [0.0, 0.001]]), 0.01).is_some());
    }
}
