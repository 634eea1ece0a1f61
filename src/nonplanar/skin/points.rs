//! Leg on a surface -> where it is cut, so that its straight parts follow the surface and the room.
//!
//! Words: a *chord* is the straight line in space between two cuts. A chord *bends* if the surface leaves
//! it by more than rounding.
//!
//! 1. The leg is divided into cells of a line's width. Neighbouring cells stay together as long as their
//!    rooms are nearly the same: over a staircase plastic goes where the room is, and a leg with steady
//!    room is one part.
//! 2. Each part is cut so that its chords miss the surface by the tolerance at most. A chord that bends
//!    is at most one segment long. The longest chord is found in one pass: each place of the surface
//!    leaves a range of slopes, and a chord is good while its slope is in all of them.
//! 3. Chords shorter than the shortest segment are joined, or share their length with the one before.

use super::relief::Relief;
use super::room::Room;
use super::runs::Leg;

/// Rooms that differ by this share in all are the same.
const STEADY: f64 = 0.04;

/// A surface that leaves its chord by less is straight (1 µm, the resolution of the file).
const STRAIGHT: f64 = 10.0;

/// Lengths that limit chords, grid units.
#[derive(Debug, Clone, Copy)]
pub(super) struct Limits {
    /// How far a chord may leave the surface.
    pub(super) tolerance: f64,
    /// Longest chord that bends.
    pub(super) segment: f64,
    /// Shortest chord.
    pub(super) shortest: f64,
    /// Length of a cell.
    pub(super) cell: f64,
}

/// The surface's height along a leg, by the way along it, grid units.
#[derive(Debug)]
pub(super) struct Heights(Vec<(f64, f64)>);

impl Heights {
    /// Along `leg` on `surface`. A leg that does not touch it is as high as `else_at`, where the leg before
    /// ends; `None` if there is no such leg.
    pub(super) fn new(leg: &Leg, surface: &dyn Relief, else_at: Option<f64>) -> Option<Self> {
        let length = leg.from.distance(leg.to);
        let profile = surface.profile(leg.from, leg.to);
        let mut all: Vec<(f64, f64)> = Vec::with_capacity(profile.len() + 2);
        for (part, z) in profile {
            let s = (part * length).clamp(0.0, length);
            if all.last().is_none_or(|(last, _)| s > last + 0.5) {
                all.push((s, z));
            }
        }
        let ends = [surface.z(leg.from), surface.z(leg.to)];
        let first = ends[0].or(all.first().map(|one| one.1)).or(ends[1]).or(else_at)?;
        let last = ends[1].or(all.last().map(|one| one.1)).unwrap_or(first);
        if all.first().is_none_or(|(s, _)| *s > 0.5) {
            all.insert(0, (0.0, first));
        }
        all[0].0 = 0.0;
        match all.last_mut() {
            Some(end) if end.0 >= length - 0.5 && length > 1.0 => end.0 = length,
            _ => all.push((length, last)),
        }
        Some(Self(all))
    }

    /// The height after the way `s`.
    pub(super) fn at(&self, s: f64) -> f64 {
        self.between(self.0.partition_point(|(at, _)| *at <= s), s)
    }

    /// The same, of ways that are asked for in order.
    pub(super) fn in_order(&self) -> impl FnMut(f64) -> f64 + '_ {
        let mut next = 0;
        move |s| {
            while self.0.get(next).is_some_and(|(at, _)| *at <= s) {
                next += 1;
            }
            self.between(next, s)
        }
    }

    /// The height after a way `s`, before the place `k` and after the one before it.
    fn between(&self, k: usize, s: f64) -> f64 {
        let k = k.clamp(1, self.0.len() - 1);
        let ((a, low), (b, high)) = (self.0[k - 1], self.0[k]);
        if b > a { low + (high - low) * ((s - a) / (b - a)).clamp(0.0, 1.0) } else { low }
    }

    /// The heights at both ends of a part and where it bends between them.
    fn within(&self, [start, end]: [f64; 2]) -> Vec<(f64, f64)> {
        let first = self.0.partition_point(|(s, _)| *s <= start + 0.5);
        let inner = self.0[first..].iter().copied().take_while(|(s, _)| *s < end - 0.5);
        let ends = [start, end].map(|s| (s, self.at(s)));
        std::iter::once(ends[0]).chain(inner).chain([ends[1]]).collect()
    }
}

/// Where a leg of this length is cut, from 0 to its length.
pub(super) fn cuts(length: f64, heights: &Heights, room: &Room, limits: &Limits) -> Vec<f64> {
    let mut cuts = vec![0.0];
    for part in parts(length, room, limits) {
        let first = cuts.len();
        chords(&heights.within(part), limits, &mut cuts);
        lengthen(&mut cuts, first - 1, limits.shortest);
    }
    cuts
}

/// The parts of a leg with steady room.
fn parts(length: f64, room: &Room, limits: &Limits) -> Vec<[f64; 2]> {
    let cell = limits.cell.max(limits.shortest);
    let count = (length / cell).floor().max(1.0);
    let at = |k: usize| if k as f64 >= count { length } else { length * k as f64 / count };
    let mut parts: Vec<[f64; 2]> = Vec::new();
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for k in 0..count as usize {
        let cell = [at(k), at(k + 1)];
        let here = room.of(cell)[1] / (cell[1] - cell[0]);
        (low, high) = (low.min(here), high.max(here));
        match parts.last_mut() {
            Some(last) if high - low <= STEADY * high => last[1] = cell[1],
            _ => {
                parts.push(cell);
                (low, high) = (here, here);
            }
        }
    }
    parts
}

/// The slopes that a chord may have.
#[derive(Clone, Copy)]
struct Slopes {
    off: f64,
    low: f64,
    high: f64,
}

impl Slopes {
    fn all(off: f64) -> Self {
        Self { off, low: f64::NEG_INFINITY, high: f64::INFINITY }
    }

    fn hold(&self, slope: f64) -> bool {
        self.low <= slope && slope <= self.high
    }

    /// ... that pass a place `far` away and `rise` higher at most `off` above or below it.
    fn pass(&mut self, far: f64, rise: f64) {
        self.low = self.low.max((rise - self.off) / far);
        self.high = self.high.min((rise + self.off) / far);
    }
}

/// Appends the ends of the chords along `places`.
fn chords(places: &[(f64, f64)], limits: &Limits, cuts: &mut Vec<f64>) {
    let mut from = 0;
    while from + 1 < places.len() {
        let (start, z) = places[from];
        let mut near = Slopes::all(limits.tolerance);
        let mut straight = Slopes::all(STRAIGHT);
        let mut to = from + 1;
        for (k, &(s, height)) in places.iter().enumerate().skip(from + 1) {
            let (far, rise) = (s - start, height - z);
            let slope = rise / far;
            let short = far <= limits.segment || straight.hold(slope);
            if near.hold(slope) && short || places[to].0 - start < limits.shortest {
                to = k;
            }
            near.pass(far, rise);
            straight.pass(far, rise);
            let bends = far > limits.segment && straight.low > straight.high;
            if near.low > near.high && far >= limits.shortest || bends {
                break;
            }
        }
        cuts.push(places[to].0);
        from = to;
    }
}

/// Lets no chord from cut `first` on be shorter than `shortest`, if the part is longer.
fn lengthen(cuts: &mut Vec<f64>, first: usize, shortest: f64) {
    let Some(&end) = cuts.last() else { return };
    let n = cuts.len();
    if n < first + 3 || end - cuts[n - 2] >= shortest {
        return;
    }
    let start = cuts[n - 3];
    if end - start >= 2.0 * shortest {
        cuts[n - 2] = (start + end) / 2.0;
    } else {
        cuts.remove(n - 2);
    }
}
