//! Contours -> Outline: how thick the part is behind a place of its contour.
//!
//! A circle inside the part that touches the contour at a place has its centre on the normal
//! there. Of all sides of the contour, the one that allows the smallest circle bounds the part on
//! the other side. The circle's centre then lies on the medial axis, and the thickness is twice
//! its radius. For a place `p` with the normal `n`:
//!
//! - A side with the normal `m` at the distance `h` from `p` touches the circle of the radius
//!   `h / (1 − n·m)`.
//! - A point at `q` from `p` touches the circle of the radius `q² / 2 n·q`, if the circle's centre lies
//!   between the normals of the two sides that meet there. Elsewhere one of these sides is nearer.

use crate::geom::cells::Cells;
use crate::geom::segment::{along, dot, way};
use crate::geom::{Contour, Point, edges};
use crate::region::near::{Area, Grid};
use crate::region::params::WallParams;
use crate::units::Bounded as _;

/// Cosine of the angle between two sides that are opposite to each other: a wedge of 32°. Blunter
/// wedges keep their loops up to the corner, as the tests of [`super::thin`] show. A smaller value
/// lays middle beads in corners; a larger one leaves steep tapers open.
const OPPOSITE: f64 = 0.85;

/// The same for corners that stick into the part. Where walls cross, a wall looks at two such
/// corners; a middle bead runs on between them. A larger value breaks it there.
const OPPOSITE_CORNER: f64 = 0.5;

/// Sides that look at a place at a flatter angle bound nothing there: the end of a strip must not
/// hide what is opposite.
const BOUNDS: f64 = 0.3;

/// A centre this far beyond the normal of a side (5 µm) still lies between those of two: rounding.
const ROUNDING: f64 = 50.0;

/// How much larger than the last circle the first one is that is searched. It affects speed only.
const GUESS: f64 = 1.15;

/// A side of the contour.
#[derive(Debug, Clone, Copy, Default)]
struct Side {
    from: [f64; 2],
    /// Its direction; the solid is on its left.
    along: [f64; 2],
    /// The direction of the side before it.
    before: [f64; 2],
    length: f64,
    index: u32,
}

impl Side {
    /// The side from `p` to `q`, which are two; what lies before it is not known yet.
    fn new(p: Point, q: Point, index: u32) -> Self {
        let from = [f64::from(p.x), f64::from(p.y)];
        let length = p.distance(q);
        let along = way(from, [f64::from(q.x), f64::from(q.y)]).map(|x| x / length);
        Self { from, along, before: [0.0; 2], length, index }
    }

    fn normal(&self) -> [f64; 2] {
        [-self.along[1], self.along[0]]
    }

    /// The circle at `at` that touches the side between its ends, if it is smaller than `most`.
    fn touch(&self, at: [f64; 2], normal: [f64; 2], most: f64) -> Option<Touch> {
        let m = self.normal();
        let (height, facing) = (dot(way(self.from, at), m), -dot(normal, m));
        if height <= 0.0 || facing <= BOUNDS || height >= most * (1.0 + facing) {
            return None;
        }
        let radius = height / (1.0 + facing);
        let centre = along(at, radius, normal);
        let t = dot(way(self.from, centre), self.along);
        let touch = Touch { radius, corner: false, opposite: facing >= OPPOSITE };
        (0.0..=self.length).contains(&t).then_some(touch)
    }

    /// The circle at `at` that touches the start of the side, if it is smaller than `most`.
    fn touch_start(&self, at: [f64; 2], normal: [f64; 2], most: f64) -> Option<Touch> {
        let arm = way(at, self.from);
        let (ahead, square) = (dot(arm, normal), dot(arm, arm));
        if ahead <= 0.0 || square >= most * 2.0 * ahead {
            return None;
        }
        let radius = square / (2.0 * ahead);
        let facing = 2.0 * ahead * ahead / square.at_least(1.0) - 1.0;
        let centre = way(self.from, along(at, radius, normal));
        let is_between =
            dot(centre, self.along) <= ROUNDING && dot(centre, self.before) >= -ROUNDING;
        let touch = Touch { radius, corner: true, opposite: facing >= OPPOSITE_CORNER };
        (facing > BOUNDS && is_between).then_some(touch)
    }
}

/// What lies opposite to a place of the contour.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Opposite {
    /// Radius of the circle that touches both.
    pub radius: f64,
    /// The index of the side that it touches: sides count through all contours.
    pub side: u32,
    /// Whether it touches no side there, but a corner that sticks into the part.
    pub corner: bool,
}

/// What a circle touches.
#[derive(Debug, Clone, Copy)]
struct Touch {
    radius: f64,
    corner: bool,
    /// Whether that is opposite to the place of the circle.
    opposite: bool,
}

/// The sides of contours, sorted into cells.
#[derive(Debug)]
pub(super) struct Outline {
    grid: Grid,
    cells: Cells<Side>,
    /// No circle is larger than this.
    most: f64,
}

impl Outline {
    /// Sorts the sides of `contours`. Places with more room than the walls can share have nothing
    /// opposite.
    pub(super) fn new(contours: &[Contour], params: &WallParams) -> Self {
        let mut sides: Vec<Side> = Vec::with_capacity(contours.iter().map(Vec::len).sum());
        let mut index = 0;
        for contour in contours {
            let first = sides.len();
            for (p, q) in edges(contour) {
                if p != q {
                    sides.push(Side::new(p, q, index));
                }
                index += 1;
            }
            for k in first..sides.len() {
                let before = if k == first { sides.len() - 1 } else { k - 1 };
                sides[k].before = sides[before].along;
            }
        }
        let w = f64::from(params.line_width);
        let most = w * (f64::from(params.count) + 0.85) + w / 2.0 - f64::from(params.outer_inset);
        let area = Area::around(sides.iter().map(|s| s.from), most);
        let grid = Grid::new(area, 2.0 * w);
        let end = |s: &Side| along(s.from, s.length, s.along);
        let reach = |s: Side| grid.cells([s.from, end(&s)]).flatten();
        let cells = Cells::new(grid.count(), || sides.iter().copied(), reach);
        Self { grid, cells, most }
    }

    /// What lies opposite to `at`, where the part lies towards `normal`. `None` if it is too far
    /// away, or not opposite. `guess` is the radius at a place near by, and is set to that found.
    pub(super) fn opposite(
        &self,
        at: [f64; 2],
        normal: [f64; 2],
        guess: &mut f64,
    ) -> Option<Opposite> {
        // Whatever touches a circle lies in it: a smaller one that something touches is enough.
        let near = (GUESS * *guess).at_most(self.most);
        let touched = self.touched(at, normal, near);
        let touched = match touched {
            None if near < self.most => self.touched(at, normal, self.most),
            touched => touched,
        };
        let (Touch { radius, corner, opposite }, side) = touched?;
        *guess = radius;
        opposite.then_some(Opposite { radius, side, corner })
    }

    /// What the smallest circle at `at` that touches a side touches, if its radius is below `most`, and
    /// the index of that side.
    fn touched(&self, at: [f64; 2], normal: [f64; 2], most: f64) -> Option<(Touch, u32)> {
        let middle = along(at, most, normal);
        let area = Area::around(std::iter::once(middle), most);
        let mut best = most;
        let mut found = None;
        for cells in self.grid.cells(area.corners()) {
            for side in self.cells.of(cells) {
                if let Some(touch) = side.touch(at, normal, best) {
                    best = touch.radius;
                    found = Some((touch, side.index));
                }
                if let Some(touch) = side.touch_start(at, normal, best) {
                    best = touch.radius;
                    found = Some((touch, side.index));
                }
            }
        }
        found
    }

    /// Whether no side is nearer to `at` than `distance`.
    pub(super) fn is_free(&self, at: [f64; 2], distance: f64) -> bool {
        let area = Area::around(std::iter::once(at), distance);
        let far = |side: &Side| {
            let arm = way(side.from, at);
            let t = dot(arm, side.along).at_least(0.0).at_most(side.length);
            let off = along(arm, -t, side.along);
            dot(off, off) >= distance * distance
        };
        self.grid.cells(area.corners()).all(|cells| self.cells.of(cells).iter().all(far))
    }
}
