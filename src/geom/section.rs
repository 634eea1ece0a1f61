//! Spans -> Section: how thick a shape is for bending.
//!
//! Words: the *thickness* is the side of the square that resists bending as the shape does in its
//! weakest direction, √12 times its least radius of gyration. Of a straight line it is the width, of
//! a zigzag or an outline about the side of the field.

use super::spans::Span;
use crate::units::to_mm;

/// Sums over strips of a plane.
#[derive(Debug, Clone, Copy, Default)]
pub struct Section {
    /// Of area, x, y, xx, xy and yy, from the origin, in mm.
    sums: [f64; 6],
    origin: [f64; 2],
}

impl Section {
    /// Sums from a place near the shape, mm.
    #[must_use]
    pub fn near(origin: [f64; 2]) -> Self {
        Self { sums: [0.0; 6], origin }
    }

    /// Adds a strip that is `wide` around `y`, mm.
    pub fn add(&mut self, span: Span, y: f64, wide: f64) {
        let (from, to) = (to_mm(span.start) - self.origin[0], to_mm(span.end) - self.origin[0]);
        let (x, y, length) = (0.5 * (from + to), y - self.origin[1], to - from);
        let area = length * wide;
        let own = [length * length / 12.0, wide * wide / 12.0];
        let more = [1.0, x, y, x * x + own[0], x * y, y * y + own[1]];
        self.sums.iter_mut().zip(more).for_each(|(sum, more)| *sum += area * more);
    }

    /// Adds another shape whose sums are from the same origin.
    pub fn join(&mut self, other: &Self) {
        self.sums.iter_mut().zip(other.sums).for_each(|(sum, more)| *sum += more);
    }

    /// See the words of this file, mm; 0 of nothing.
    #[must_use]
    pub fn thickness(&self) -> f64 {
        let [area, x, y, xx, xy, yy] = self.sums;
        if area <= 0.0 {
            return 0.0;
        }
        let (x, y) = (x / area, y / area);
        let (a, b, c) = (xx / area - x * x, xy / area - x * y, yy / area - y * y);
        let least = 0.5 * (a + c - ((a - c) * (a - c) + 4.0 * b * b).sqrt());
        (12.0 * least.max(0.0)).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn strips(count: i32, length: i32, apart: f64) -> Section {
        let mut section = Section::near([5.0, 5.0]);
        let span = Span { start: 0, end: length * 10_000 };
        (0..count).for_each(|k| section.add(span, apart * f64::from(k), 0.5));
        section
    }

    #[test]
    fn a_square_is_as_thick_as_its_side_and_a_line_as_wide_as_it_is() {
        let is = |section: Section, thick: f64| (section.thickness() - thick).abs() < 1e-9;
        assert!(is(strips(20, 10, 0.5), 10.0));
        assert!(is(strips(20, 4, 0.5), 4.0));
        assert!(is(strips(1, 10, 0.5), 0.5));
        assert!(is(Section::default(), 0.0));
        // Two lines far apart are as thick as the field between them, and more.
        assert!(strips(2, 10, 3.0).thickness() > 3.0);
    }
}
