//! Samples of a loop -> the same samples, where the room at a corner is taken from both sides of it.
//!
//! Near the outside of a corner nothing is opposite, or a corner is, behind which there is more room than
//! the beads share. A loop that took its nominal place there would step out and in again beside
//! each corner of a box, and leave a hole behind it. So where a loop shares alike rooms on both sides
//! of a short way around a corner, it goes on between them as it comes. Where walls cross, nothing
//! turns: there is more room, and other beads fill it.

/// The longest way that is bridged, in rooms of its ends: beside a right angle it is two rooms long.
const LONGEST: f64 = 3.0;

/// How far the widths at its ends may differ, as a part of them. A larger value bridges ways between different
/// rooms; a smaller one leaves steps where the two sides of a corner are not measured quite alike.
const ALIKE: f64 = 0.15;

/// Cosine of the turn from which on a way goes around a corner.
pub(super) const TURNED: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// The bead at one place of a side.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Sample {
    /// How far the centre line moves inwards.
    pub shift: f64,
    pub width: f64,
    /// The room that it shares with what is opposite, if that is a side; else 0.
    pub room: f64,
    /// Whether a middle bead lies in it.
    pub bead: bool,
    /// The distance to the next sample.
    pub step: f64,
    /// The direction of its side, of length 1; the solid is on its left.
    pub way: [f64; 2],
}

/// Bridges short ways of the samples of a loop, in their order.
pub(super) fn bridge(samples: &mut [Sample]) {
    let n = samples.len();
    let is_sure = |s: &Sample| s.room > 0.0;
    let Some(first) = samples.iter().position(is_sure) else { return };
    let mut from = first;
    for k in first + 1..=first + n {
        if !is_sure(&samples[k % n]) {
            continue;
        }
        let (a, b) = (samples[from % n], samples[k % n]);
        let way: f64 = (from..k).map(|i| samples[i % n].step).sum();
        let are_alike = (a.width - b.width).abs() <= ALIKE * a.width.max(b.width);
        let (p, q) = (a.way, b.way);
        // A round bend is no corner.
        let is_one = (from..k).all(|i| samples[i % n].way == p || samples[i % n].way == q);
        // A bead in the corner alone has its room from the loops around it.
        let is_shared = (from + 1..k).all(|i| !samples[i % n].bead || a.bead && b.bead);
        let turns = p[0] * q[1] - p[1] * q[0] > 0.0 && p[0] * q[0] + p[1] * q[1] < TURNED;
        if k > from + 1
            && turns
            && is_one
            && is_shared
            && are_alike
            && way <= LONGEST * a.room.max(b.room)
        {
            let mut on = 0.0;
            for i in from + 1..k {
                on += samples[(i - 1) % n].step / way;
                let between = |a: f64, b: f64| a + on * (b - a);
                let sample = &mut samples[i % n];
                (sample.shift, sample.width) =
                    (between(a.shift, b.shift), between(a.width, b.width));
            }
        }
        from = k;
    }
}
