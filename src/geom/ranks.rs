//! Outlines in some order -> Ranks: which of them another line lies along.

use super::nearest::Nearest;
use super::{Contour, Point};

/// Outlines, to be asked which of them is nearest.
#[derive(Debug)]
pub struct Ranks {
    corners: Nearest,
    /// The outline of each corner.
    owners: Vec<usize>,
    points: Vec<Point>,
}

impl Ranks {
    /// Of these outlines.
    #[must_use]
    pub fn new(outlines: &[Contour]) -> Self {
        let points: Vec<Point> = outlines.iter().flatten().copied().collect();
        let owner = |(k, outline): (usize, &Contour)| std::iter::repeat_n(k, outline.len());
        let owners = outlines.iter().enumerate().flat_map(owner).collect();
        Self { corners: Nearest::new(points.clone()), owners, points }
    }

    /// The number of the outline that has the corner nearest to any of these points; of equal ones the
    /// first. Without any outline or point it is `usize::MAX`.
    #[must_use]
    pub fn of(&self, line: impl IntoIterator<Item = Point>) -> usize {
        let of = |at: Point| {
            let corner = self.corners.nearest(at, |k| (self.owners[k], k))?;
            Some((self.points[corner].distance2(at), self.owners[corner]))
        };
        line.into_iter().filter_map(of).min().map_or(usize::MAX, |(_, owner)| owner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(x: i32, half: i32) -> Contour {
        [(-1, -1), (1, -1), (1, 1), (-1, 1)]
            .map(|(a, b)| Point { x: x + a * half, y: b * half })
            .to_vec()
    }

    #[test]
    fn a_line_belongs_to_the_outline_beside_it() {
        let ranks = Ranks::new(&[square(90, 10), square(0, 50), square(0, 30)]);
        for (line, rank) in [(square(0, 48), 1), (square(0, 32), 2), (square(90, 8), 0)] {
            assert_eq!(ranks.of(line), rank);
        }
        // As near to two: the first counts.
        assert_eq!(ranks.of(square(0, 40)), 1);
        assert_eq!(ranks.of([]), usize::MAX);
        assert_eq!(Ranks::new(&[]).of(square(0, 1)), usize::MAX);
    }
}
