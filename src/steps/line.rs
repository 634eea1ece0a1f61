//! Two places -> the steps between them: the law of a straight line, in whole numbers only.
//!
//! Words used here:
//! - an axis *crosses* where the true line passes the middle between two steps;
//! - the *leader* is the axis that goes farthest, in steps. Its crossings are evenly spaced.
//!
//! The law: after every step all axes stand at the nearest step to one place of the true line, and
//! these places go forward. So no axis is ever more than half a step beside the line.
//!
//! - The leader steps at its crossings, and with it every other axis that has crossed since. No axis can
//!   cross twice between two crossings of the leader.
//! - What crosses after the leader's last crossing steps at its own, in their order, so that every line
//!   ends at the nearest step to its true end, and nothing is left for the next one.
//!
//! Whether an axis j has crossed n + 1 times when the leader L has m + 1 times is a comparison of two
//! fractions, `(r_j + n·S) / d_j <= (r_L + m·S) / d_L`, with S a whole step, d the way of an axis and r
//! its way to the first crossing. It is kept as `e = (r_L·d_j − r_j·d_L) / S + m·d_j − n·d_L`, whose sign
//! is exact since only the first term is rounded, downwards, and the others are whole.

use super::axis::{AXES, STEP, nearest};
use std::ops::ControlFlow;

/// A straight line between two places.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Line {
    /// Where it begins, for each axis.
    pub from: [i64; AXES],
    /// Where it ends.
    pub to: [i64; AXES],
}

/// An axis on its way.
#[derive(Debug, Clone, Copy, Default)]
struct Way {
    /// Its bit in a mask.
    bit: u8,
    /// How far it goes, in units of a place.
    length: i64,
    /// How far it is to the first crossing.
    first: i64,
    /// Steps that are left.
    left: i64,
    /// See the file's head.
    error: i64,
}

impl Line {
    /// Which axes go towards lower numbers, a bit for each.
    #[must_use]
    pub fn backwards(&self) -> u8 {
        let back = |axis: &usize| self.to[*axis] < self.from[*axis];
        (0..AXES).filter(back).fold(0, |mask, axis| mask | 1 << axis)
    }

    /// How far each axis goes, in units of a place.
    #[must_use]
    pub fn lengths(&self) -> [i64; AXES] {
        std::array::from_fn(|axis| (self.to[axis] - self.from[axis]).abs())
    }

    /// Hands out all steps in their order: how far along the line, as a share of it from 0 to 1, and the
    /// axes that step there, a bit for each. It ends early where `sink` breaks.
    #[inline]
    pub fn steps(&self, mut sink: impl FnMut(f64, u8) -> ControlFlow<()>) {
        let ways: [Way; AXES] = std::array::from_fn(|axis| self.way(axis));
        if ways.iter().all(|way| way.left == 0) {
            return;
        }
        let mut at = 0;
        for (axis, way) in ways.iter().enumerate() {
            at = if way.length > ways[at].length { axis } else { at };
        }
        let leader = ways[at];
        let mut others = [Way::default(); AXES - 1];
        let mut count = 0;
        for (axis, way) in ways.iter().enumerate() {
            if axis != at && way.left > 0 {
                others[count] = Way { error: error(way, &leader), ..*way };
                count += 1;
            }
        }
        let others = &mut others[..count];
        let whole = 1.0 / leader.length as f64;
        let (start, pace) = (leader.first as f64 * whole, STEP as f64 * whole);
        for step in 0..leader.left {
            let mut mask = leader.bit;
            for way in others.iter_mut() {
                // The last crossing of an axis may lie beyond the end, where it does not count.
                if way.error >= 0 && way.left > 0 {
                    mask |= way.bit;
                    way.error -= leader.length;
                    way.left -= 1;
                    way.first += STEP;
                }
                way.error += way.length;
            }
            if sink(start + step as f64 * pace, mask).is_break() {
                return;
            }
        }
        left_over(others, &mut sink);
    }

    fn way(&self, axis: usize) -> Way {
        let (from, to) = (self.from[axis], self.to[axis]);
        let (stands, ends) = (nearest(from), nearest(to));
        let middle = if to > from { (stands << 32) + STEP / 2 } else { (stands << 32) - STEP / 2 };
        Way {
            bit: 1 << axis,
            length: (to - from).abs(),
            first: (middle - from).abs(),
            left: (ends - stands).abs(),
            error: 0,
        }
    }
}

/// `(r_L·d_j − r_j·d_L) / S`, rounded downwards.
fn error(way: &Way, leader: &Way) -> i64 {
    let ahead = i128::from(leader.first) * i128::from(way.length);
    let behind = i128::from(way.first) * i128::from(leader.length);
    ((ahead - behind) >> 32) as i64
}

/// Steps after the leader's last, each at its own crossing.
fn left_over(ways: &mut [Way], sink: &mut impl FnMut(f64, u8) -> ControlFlow<()>) {
    let is_before = |a: &Way, b: &Way| {
        i128::from(a.first) * i128::from(b.length) < i128::from(b.first) * i128::from(a.length)
    };
    loop {
        let mut next: Option<Way> = None;
        for way in ways.iter().filter(|way| way.left > 0) {
            next = match next {
                Some(best) if !is_before(way, &best) => Some(best),
                _ => Some(*way),
            };
        }
        let Some(next) = next else { return };
        let mut mask = 0;
        for way in ways.iter_mut().filter(|way| way.left > 0) {
            if !is_before(&next, way) {
                mask |= way.bit;
                way.left -= 1;
                way.first += STEP;
            }
        }
        if sink(next.first as f64 / next.length as f64, mask).is_break() {
            return;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Steps of a line: the share of the way, and where all axes stand after it.
    fn walk(line: &Line) -> Vec<(f64, [i64; AXES])> {
        let mut at = line.from.map(nearest);
        let back = line.backwards();
        let mut found = Vec::new();
        line.steps(|share, mask| {
            for (axis, at) in at.iter_mut().enumerate() {
                let by = if back >> axis & 1 == 1 { -1 } else { 1 };
                *at += by * i64::from(mask >> axis & 1);
            }
            found.push((share, at));
            ControlFlow::Continue(())
        });
        found
    }

    /// Judges the law by whole numbers alone: the shares at which an axis is within half a step of where
    /// it stands are a range between two fractions; all four ranges have a share in common, and the
    /// shares can be chosen so that they do not go back.
    fn judge(line: &Line) {
        let walked = walk(line);
        // The least share so far, as a fraction.
        let mut least = (0_i128, 1_i128);
        for (_, at) in &walked {
            let mut most = (1_i128, 1_i128);
            for (axis, at) in at.iter().enumerate() {
                let (from, to) = (i128::from(line.from[axis]), i128::from(line.to[axis]));
                let stands = i128::from(*at) << 32;
                let half = i128::from(STEP / 2);
                let length = (to - from).abs();
                let (near, far) = if to >= from {
                    (stands - half - from, stands + half - from)
                } else {
                    (from - stands - half, from - stands + half)
                };
                if length == 0 {
                    assert!(near <= 0 && far >= 0, "an axis that stands still has stepped");
                    continue;
                }
                if near * least.1 > least.0 * length {
                    least = (near, length);
                }
                if far * most.1 < most.0 * length {
                    most = (far, length);
                }
            }
            assert!(least.0 * most.1 <= most.0 * least.1, "{line:?}: {at:?} is beside the line");
        }
        let end = walked.last().map_or(line.from.map(nearest), |(_, at)| *at);
        assert_eq!(end, line.to.map(nearest), "{line:?}");
        let shares: Vec<f64> = walked.iter().map(|(share, _)| *share).collect();
        assert!(shares.windows(2).all(|two| two[0] <= two[1] + 1e-12), "{line:?}");
        assert!(shares.iter().all(|share| (0.0..=1.0 + 1e-12).contains(share)), "{line:?}");
    }

    /// A place: anything within some steps, whole and half steps among them.
    fn place(steps: i64) -> impl Strategy<Value = i64> {
        prop_oneof![
            (-steps * STEP..=steps * STEP),
            (-2 * steps..=2 * steps).prop_map(|halves| halves * STEP / 2),
        ]
    }

    fn line(steps: i64) -> impl Strategy<Value = Line> {
        let places = move || [(); AXES].map(|()| place(steps));
        (places(), places()).prop_map(|(from, to)| Line { from, to })
    }

    proptest! {
        #[test]
        fn short_lines_keep_the_law(line in line(3)) {
            judge(&line);
        }

        #[test]
        fn long_lines_keep_the_law(line in line(2000)) {
            judge(&line);
        }

        #[test]
        fn many_small_moves_stand_where_one_would(ends in prop::collection::vec([(); AXES].map(|()| place(2)), 1..40)) {
            let mut from = [0; AXES];
            let mut at = [0; AXES];
            for to in ends {
                let line = Line { from, to };
                judge(&line);
                at = walk(&line).last().map_or(at, |(_, at)| *at);
                from = to;
            }
            prop_assert_eq!(at, from.map(nearest));
        }
    }

    #[test]
    fn octants_ends_and_a_million_steps() {
        let far = 1_000_000 * STEP;
        for (x, y) in [(3, 1), (1, 3), (-1, 3), (-3, 1), (-3, -1), (-1, -3), (1, -3), (3, -1)] {
            judge(&Line {
                from: [STEP / 3, 7, 0, 0],
                to: [x * STEP * 40, y * STEP * 40, STEP, -STEP],
            });
        }
        judge(&Line { from: [0; 4], to: [0; 4] });
        judge(&Line { from: [0; 4], to: [STEP / 2, 0, 0, 0] });
        let long = Line { from: [5, 0, 0, 0], to: [far, far / 3, far - 1, -far] };
        assert_eq!(walk(&long).last().unwrap().1, [1_000_000, 333_333, 1_000_000, -1_000_000]);
        assert_eq!(walk(&Line { from: [0; 4], to: [STEP / 2 - 1, 9, 9, 9] }), []);
    }

    /// Where all axes are at the leader's crossings, in floating point.
    fn compare(lines: u32) {
        let mut state = 7_u64;
        let mut roll = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (state >> 20) as i64 % (40 * STEP) - 20 * STEP
        };
        let mut compared = 0_u64;
        for _ in 0..lines {
            let line = Line { from: [(); AXES].map(|()| roll()), to: [(); AXES].map(|()| roll()) };
            let at = |share: f64, axis: usize| {
                let [from, to] =
                    [line.from[axis], line.to[axis]].map(|place| place as f64 / STEP as f64);
                from + share * (to - from)
            };
            for (share, stands) in walk(&line) {
                for (axis, stands) in stands.into_iter().enumerate() {
                    let place = at(share, axis);
                    let beside = (place - stands as f64).abs();
                    assert!(beside <= 0.5 + 1e-9, "{line:?}: {stands} at {place}");
                    compared += 1;
                }
            }
        }
        assert!(compared > u64::from(lines));
    }

    #[test]
    fn floating_point_gives_the_same() {
        compare(3000);
    }

    #[test]
    #[ignore = "a minute: a million lines"]
    fn floating_point_gives_the_same_of_a_million_lines() {
        compare(1_000_000);
    }
}
