//! Path: a bead laid in one go; filling makes paths, ordering sorts them.

use super::role::Role;
use crate::geom::Point;
use crate::units::Coord;

/// A point of a path. Its width, height and hang hold for the bead from the previous point to this one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PathPoint {
    /// Position on the bed relative to the middle of the layout, grid units.
    pub at: Point,
    /// Height of the nozzle above the top of its layer, grid units: 0 on a flat path.
    pub z: Coord,
    /// Width of the bead, grid units.
    pub width: Coord,
    /// Height of the bead, grid units.
    pub height: Coord,
    /// How far a wall hangs over nothing, % of its width; 0 up to half.
    pub hang: u8,
}

/// How the ends of a path may be chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shape {
    /// Either end may come first.
    Open,
    /// Printed in its own direction, and in its turn.
    InTurn {
        /// After all of its island and role with a lesser turn.
        turn: u32,
    },
    /// Closed: the last point repeats the first, and any point may become the first. Loops are
    /// ordered by their depth.
    Loop {
        /// Counted from 0 at the outside.
        depth: u32,
    },
}

/// A bead laid in one go.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Path {
    /// What it is for.
    pub role: Role,
    /// How its ends may be chosen.
    pub shape: Shape,
    /// Its points, at least one.
    pub points: Vec<PathPoint>,
    /// How many layers it is printed for: its own and those below.
    pub layers: u32,
}

impl Path {
    /// Whether it is printed for more than its own layer.
    #[must_use]
    pub fn is_thick(&self) -> bool {
        self.layers > 1
    }

    /// Its first point.
    #[must_use]
    pub fn start(&self) -> Point {
        self.points.first().map(|p| p.at).unwrap_or_default()
    }

    /// Its last point.
    #[must_use]
    pub fn end(&self) -> Point {
        self.points.last().map(|p| p.at).unwrap_or_default()
    }

    /// Reverses its direction.
    pub fn reverse(&mut self) {
        self.points.reverse();
        // Each point has the bead of the segment before it. That segment now ends at its other point.
        for k in (1..self.points.len()).rev() {
            let PathPoint { width, height, hang, .. } = self.points[k - 1];
            self.points[k] = PathPoint { width, height, hang, ..self.points[k] };
        }
    }

    /// Rotates a loop so that it begins at its point `first`.
    pub fn begin_at(&mut self, first: usize) {
        let Some(closing) = self.points.last().copied().filter(|_| first > 0) else { return };
        // The bead of the segment to the old first point is that of the point which repeated it.
        self.points[0] = closing;
        self.points.pop();
        self.points.rotate_left(first);
        self.points.extend(self.points.first().copied());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square() -> Path {
        let corners = [(0, 0, 1), (10, 0, 2), (10, 10, 3), (0, 10, 4), (0, 0, 5)];
        let point = |(x, y, width)| PathPoint {
            at: Point { x, y },
            z: width,
            width,
            height: 2 * width,
            hang: 0,
        };
        let points = corners.map(point).to_vec();
        let shape = Shape::Loop { depth: 0 };
        Path { role: Role::OuterWall, shape, points, layers: 1 }
    }

    /// The segments: both ends and the width of the bead between them.
    fn segments(path: &Path) -> Vec<(Point, Point, Coord)> {
        path.points.windows(2).map(|w| (w[0].at, w[1].at, w[1].width)).collect()
    }

    #[test]
    fn a_loop_keeps_its_segments_wherever_it_begins() {
        for first in 0..4 {
            let mut path = square();
            path.begin_at(first);
            assert_eq!(path.start(), square().points[first].at);
            assert_eq!(path.start(), path.end());
            let mut turned = segments(&square());
            turned.rotate_left(first);
            assert_eq!(segments(&path), turned);
        }
    }

    #[test]
    fn a_reversed_path_has_the_same_segments() {
        let mut path = square();
        path.reverse();
        let mut back = segments(&square());
        back.reverse();
        back.iter_mut().for_each(|(a, b, _)| std::mem::swap(a, b));
        assert_eq!(segments(&path), back);
        let heights = path.points.iter().skip(1).map(|p| p.height);
        assert_eq!(heights.collect::<Vec<_>>(), [10, 8, 6, 4]);
    }
}
