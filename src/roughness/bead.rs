//! A line -> Bead: what it covers of the bed, row by row, and how high its top is there.

use crate::reader::print::Step;
use crate::reader::{Facts, Role};
use crate::units::UNITS_PER_MM;

/// The plastic of a line: as wide as told, with round ends, its top level across the width.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bead {
    /// Ends of the middle line and their heights, grid units.
    from: [f64; 3],
    to: [f64; 3],
    /// Half of its width, grid units.
    radius: f64,
    /// The square of its length in plan.
    square: f64,
}

/// Whether a line can be plastic of a part's top. Files without roles call all lines the same.
pub(super) fn is_of_part(step: &Step, facts: &Facts) -> bool {
    let beside = [Role::Support, Role::Adhesion];
    step.is_line() && !(facts.has(Role::OuterWall) && beside.contains(&step.role))
}

impl Bead {
    /// The bead of a line, seen from `origin`, mm, and lower by `lift`.
    pub(super) fn of(step: &Step, origin: [f64; 2], lift: f64) -> Self {
        let off = [origin[0], origin[1], lift];
        let place = |at: [f32; 3]| {
            [0, 1, 2].map(|axis: usize| (f64::from(at[axis]) - off[axis]) * UNITS_PER_MM)
        };
        let radius = f64::from(step.width) * UNITS_PER_MM / 2.0;
        Self::between(place(step.from), place(step.to), radius)
    }

    /// Of a middle line and half a width, grid units.
    pub(super) fn between(from: [f64; 3], to: [f64; 3], radius: f64) -> Self {
        let way = [to[0] - from[0], to[1] - from[1]];
        Self { from, to, radius, square: way[0] * way[0] + way[1] * way[1] }
    }

    /// The same, higher by this many grid units.
    #[cfg(test)]
    pub(super) fn raised(&self, by: f64) -> Self {
        let up = |[x, y, z]: [f64; 3]| [x, y, z + by];
        Self { from: up(self.from), to: up(self.to), ..*self }
    }

    /// Lowest and highest y, grid units.
    pub(super) fn rows(&self) -> [f64; 2] {
        let (from, to) = (self.from[1], self.to[1]);
        [from.min(to) - self.radius, from.max(to) + self.radius]
    }

    /// Lowest and highest top, grid units.
    pub(super) fn tops(&self) -> [f64; 2] {
        [self.from[2].min(self.to[2]), self.from[2].max(self.to[2])]
    }

    /// What it covers of the straight line at `y`: from where to where along x, one stretch, since its shape
    /// has no dents.
    pub(super) fn chord(&self, y: f64) -> Option<[f64; 2]> {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        let mut take = |x: f64| (low, high) = (low.min(x), high.max(x));
        for end in [self.from, self.to] {
            let away = y - end[1];
            let half = self.radius * self.radius - away * away;
            if half >= 0.0 {
                take(end[0] - half.sqrt());
                take(end[0] + half.sqrt());
            }
        }
        let length = self.square.sqrt();
        if length > 0.0 {
            let side = [
                (self.from[1] - self.to[1]) / length * self.radius,
                (self.to[0] - self.from[0]) / length * self.radius,
            ];
            let corner =
                |end: [f64; 3], sign: f64| [end[0] + sign * side[0], end[1] + sign * side[1]];
            let corners = [
                corner(self.from, 1.0),
                corner(self.to, 1.0),
                corner(self.to, -1.0),
                corner(self.from, -1.0),
            ];
            for k in 0..4 {
                let (a, b) = (corners[k], corners[(k + 1) % 4]);
                if a[1] != b[1] && (a[1] - y) * (b[1] - y) <= 0.0 {
                    take(a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]));
                }
            }
        }
        (low <= high).then_some([low, high])
    }

    /// Its top over a place that it covers, grid units.
    pub(super) fn top(&self, at: [f64; 2]) -> f64 {
        let rise = self.to[2] - self.from[2];
        if rise == 0.0 || self.square == 0.0 {
            return self.from[2].max(self.to[2]);
        }
        let along = (at[0] - self.from[0]) * (self.to[0] - self.from[0])
            + (at[1] - self.from[1]) * (self.to[1] - self.from[1]);
        self.from[2] + (along / self.square).clamp(0.0, 1.0) * rise
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bead_covers_its_width_and_round_ends_and_rises_evenly() {
        let bead = Bead::between([0.0, 0.0, 0.0], [100.0, 0.0, 10.0], 5.0);
        assert_eq!(bead.chord(0.0), Some([-5.0, 105.0]));
        assert_eq!(bead.chord(4.0), Some([-3.0, 103.0]));
        assert_eq!(bead.chord(5.1), None);
        assert_eq!([bead.top([50.0, 3.0]), bead.top([104.0, 0.0])], [5.0, 10.0]);
        let slant = Bead::between([0.0, 0.0, 2.0], [30.0, 40.0, 2.0], 5.0);
        let [low, high] = slant.chord(20.0).unwrap();
        assert!((low - 8.75).abs() < 1e-9 && (high - 21.25).abs() < 1e-9, "{low} {high}");
        assert_eq!((slant.rows(), slant.tops()), ([-5.0, 45.0], [2.0, 2.0]));
    }
}
