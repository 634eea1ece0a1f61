//! Deviations -> Sums: what means over profiles and areas are made of, for each class of slopes.

use super::means::{Means, Values};

/// Slopes of the surface that are told apart, degrees: each class goes up to the next one's begin. The
/// first is level.
pub(super) const SLOPES: [f64; 6] = [0.0, 0.5, 5.0, 15.0, 30.0, 45.0];

/// Number of classes.
pub(super) const CLASSES: usize = SLOPES.len() - 1;

/// The class of a slope in degrees.
pub(super) fn class_of(slope: f64) -> usize {
    (1..CLASSES).rev().find(|class| slope >= SLOPES[*class]).unwrap_or(0)
}

/// A weighted sum of absolute values and of squares.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Spread {
    weight: f64,
    sizes: f64,
    squares: f64,
}

impl Spread {
    pub(super) fn add(&mut self, weight: f64, value: f64) {
        self.weight += weight;
        self.sizes += weight * value.abs();
        self.squares += weight * value * value;
    }

    fn and(&mut self, other: &Self) {
        self.weight += other.weight;
        self.sizes += other.sizes;
        self.squares += other.squares;
    }

    /// Mean of the absolute values, and root of the mean square.
    fn means(&self) -> [Option<f64>; 2] {
        let of = |sum: f64| (self.weight > 0.0).then(|| sum / self.weight);
        [of(self.sizes), of(self.squares).map(f64::sqrt)]
    }
}

/// What is measured with or without the filter, µm.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Kind {
    pub(super) profile: Spread,
    pub(super) area: Spread,
    /// Weighted sum of Rz, and the weights.
    pub(super) range: [f64; 2],
}

impl Kind {
    fn and(&mut self, other: &Self) {
        self.profile.and(&other.profile);
        self.area.and(&other.area);
        self.range = [self.range[0] + other.range[0], self.range[1] + other.range[1]];
    }

    fn values(&self) -> Values {
        let ([ra_um, rq_um], [sa_um, sq_um]) = (self.profile.means(), self.area.means());
        let rz_um = (self.range[1] > 0.0).then(|| self.range[0] / self.range[1]);
        Values { ra_um, rq_um, rz_um, sa_um, sq_um }
    }
}

/// All sums over some of the surface.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Sums {
    /// Area of the surface, of what of it is covered, and of what has plastic near, mm².
    pub(super) area: f64,
    pub(super) covered: f64,
    pub(super) near: f64,
    /// Deviation times area, µm · mm².
    pub(super) signed: f64,
    pub(super) raw: Kind,
    pub(super) filtered: Kind,
}

impl Sums {
    /// Takes in those of another piece.
    pub(super) fn and(&mut self, other: &Self) {
        self.area += other.area;
        self.covered += other.covered;
        self.near += other.near;
        self.signed += other.signed;
        self.raw.and(&other.raw);
        self.filtered.and(&other.filtered);
    }

    /// Of several pieces together.
    pub(super) fn of<'a>(all: impl IntoIterator<Item = &'a Self>) -> Self {
        let mut sums = Self::default();
        all.into_iter().for_each(|one| sums.and(one));
        sums
    }

    pub(super) fn means(&self) -> Means {
        Means {
            area_mm2: self.area,
            coverage: if self.area > 0.0 { self.covered / self.area } else { 0.0 },
            mean_um: (self.near > 0.0).then(|| self.signed / self.near),
            unfiltered: self.raw.values(),
            filtered: self.filtered.values(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn classes_begin_where_they_say() {
        let classes = [0.0, 0.49, 0.5, 4.99, 5.0, 15.0, 30.0, 45.0].map(class_of);
        assert_eq!(classes, [0, 0, 1, 1, 2, 3, 4, 4]);
    }
}
