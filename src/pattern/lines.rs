//! Raster -> Lines: parallel lines as a pattern, every so many lines of a fine raster.
//!
//! Words: the *stride* is the number of rows from one printed line to the next, the *offset* the
//! index of a printed row. A *join* links the ends of two neighbouring lines. A *strand* is a
//! zigzag: lines and joins in turn. An *edge* is the border of the region, known as the ends of
//! its spans on each row.
//!
//! The raster is as fine as a solid fill, though few of its rows are printed. The rows between
//! two printed lines show where the region's edge runs, so that joins can follow it. Where the
//! spacing is a multiple of the line width, the raster is the skin's own and costs nothing.
//!
//! Algorithm: [`zigzag::link`] walks over the printed rows and asks for a join between two ends.
//! A join goes straight if that stays inside the region on all rows between. Else it follows the
//! edge from row to row, and its points are decimated. Where neither works, or the ends are too
//! far apart, the strand ends.

use super::anchors::{self, LONGEST_JOIN, Places, bends};
use super::zigzag::{self, Side};
use super::{Held, Pattern, SparsePattern};
use crate::geom::polyline::{LinePoint, Polyline};
use crate::geom::raster::Raster;
use crate::geom::spans::{Rows, Span};
use crate::units::Coord;
use std::sync::Arc;

/// Maximum run of a join along the lines from one row to the next, in row distances. A flatter
/// edge is seen by too few rows: the join could miss a hole between two of them.
const FLATTEST_STEP: Coord = 2;

/// Tolerance by which a straight join may leave its region (10 µm), because edges are rounded to
/// the grid. At 0, joins along a straight edge would fail at random.
const SLACK: Coord = 100;

/// Tolerance for decimating a join along an edge, in line widths. A smaller value makes more,
/// shorter moves; a larger one lets the join leave the edge visibly.
const BEND: f64 = 0.125;

/// Every `stride`-th line of a raster.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lines {
    /// The raster.
    pub raster: Raster,
    /// Index of a line that is printed.
    pub offset: i32,
    /// Number of rows from one printed line to the next.
    pub stride: i32,
    /// Whether neighbouring lines are joined at their ends. They are not where lines of several
    /// directions end at the same wall: their joins would lie on each other.
    pub joined: bool,
    /// How far an end that is not joined runs along a wall, at most. At 0 joins do not run along
    /// walls either.
    pub anchor: Coord,
    /// How far inside the region's border beads run along a wall.
    pub inwards: Coord,
    /// Whether they lie side by side, to fill a room solidly.
    pub solid: bool,
}

impl Lines {
    /// Lines at `degrees` with distance `spacing`, on rows at most `width` apart.
    #[must_use]
    pub fn new(degrees: f64, spacing: Coord, width: Coord) -> Self {
        let (raster, stride) = Raster::fine(degrees, spacing, width);
        Self { raster, offset: 0, stride, joined: true, anchor: 0, inwards: 0, solid: false }
    }

    /// Whether line `j` is printed.
    #[must_use]
    pub fn prints(&self, j: i32) -> bool {
        (j - self.offset).rem_euclid(self.stride) == 0
    }
}

impl SparsePattern for Lines {
    fn raster(&self) -> Raster {
        self.raster
    }

    fn length(&self, region: &Rows, least: Coord) -> i64 {
        let printed = region.iter().filter(|(j, _)| self.prints(*j)).flat_map(|(_, row)| row);
        printed.map(|span| span.len()).filter(|&len| len >= i64::from(least)).sum()
    }

    fn shares(&self, count: usize) -> Vec<Pattern> {
        // Thick runs along the wall of two shares would lie in each other on the layers between.
        let share = |c: i32| -> Pattern {
            let offset = self.offset + c * self.stride;
            Arc::new(Self { offset, stride: count as i32 * self.stride, anchor: 0, ..*self })
        };
        (0..count as i32).map(share).collect()
    }

    fn strands(&self, region: &Rows, width: Coord, least: Coord) -> Vec<Polyline> {
        let pitch = self.raster.pitch;
        let printed = region.iter().filter(|(j, _)| self.prints(*j));
        let long = |s: &Span| Some(*s).filter(|s| s.len() >= i64::from(least));
        let rows = printed.map(|(j, row)| (j, row.iter().map(long)));
        let edges = Edges { region, pitch, width };
        let short = |from: (Coord, i32), to: (Coord, i32)| {
            let (du, dv) = (i64::from(to.0 - from.0), i64::from((to.1 - from.1) * pitch));
            du * du + dv * dv <= (LONGEST_JOIN * i64::from(width)).pow(2)
        };
        let join = |from: (Coord, i32), to: (Coord, i32), side: Side| {
            let straight = || edges.straight(from, to).then(Vec::new);
            let join = || straight().or_else(|| edges.along(from, to, side));
            (self.joined && short(from, to)).then(join).flatten()
        };
        let zigzags = zigzag::link(rows, self.stride, self.stride * pitch, join);
        let strand = |zigzag: Vec<zigzag::Link>| {
            let mut strand = Vec::with_capacity(2 * zigzag.len());
            for link in zigzag {
                strand.extend(link.join);
                let v = link.row * pitch;
                let end = |side: Side| LinePoint { u: side.of(link.span), v, width };
                strand.extend([end(link.from), end(link.from.other())]);
            }
            strand
        };
        zigzags.into_iter().map(strand).collect()
    }

    fn is_solid(&self) -> bool {
        self.solid
    }

    fn is_anchored(&self) -> bool {
        self.anchor > 0 || self.solid
    }

    fn anchored(&self, region: &Held<'_>, width: Coord, least: Coord) -> Vec<Polyline> {
        let Self { raster, offset, stride, anchor, inwards, .. } = *self;
        let places = Places { pitch: raster.pitch, offset, stride, anchor, inwards };
        anchors::strands(places, region, width, least)
    }
}

/// The edges of a sparse region as its fine rows show them. Ends of lines are `(u, row)`.
struct Edges<'a> {
    region: &'a Rows,
    pitch: Coord,
    width: Coord,
}

impl Edges<'_> {
    /// Whether the straight join is inside the region on every row between the two ends.
    fn straight(&self, (u, a): (Coord, i32), (to, b): (Coord, i32)) -> bool {
        let run = i64::from(to) - i64::from(u);
        // A flatter join could slip past a hole between two rows.
        run.abs() <= i64::from(FLATTEST_STEP * self.pitch * (b - a))
            && (a + 1..b).all(|j| {
                let u = u + (run * i64::from(j - a) / i64::from(b - a)) as Coord;
                let holds = |s: &Span| s.start - SLACK <= u && u <= s.end + SLACK;
                self.region.row(j).iter().any(holds)
            })
    }

    /// The points of a join along the region's edge, if one edge leads from end to end.
    fn along(
        &self,
        (u, a): (Coord, i32),
        (to, b): (Coord, i32),
        side: Side,
    ) -> Option<Vec<LinePoint>> {
        // Along a flatter edge the join is long, and a travel is cheaper.
        let step = FLATTEST_STEP * self.pitch;
        let mut at = u;
        let point = |u, row| LinePoint { u, v: row * self.pitch, width: self.width };
        let mut points = vec![point(u, a)];
        for j in a + 1..b {
            let ends = self.region.row(j).iter().map(|&s| side.of(s));
            at = ends.filter(|u| (u - at).abs() <= step).min_by_key(|u| ((u - at).abs(), *u))?;
            points.push(point(at, j));
        }
        points.push(point(to, b));
        ((to - at).abs() <= step).then(|| bends(&points, f64::from(self.width) * BEND))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::frame::Frame;
    use crate::geom::spans::subtract;

    const W: Coord = 4_000;

    fn every(stride: i32) -> Lines {
        let raster = Raster { frame: Frame::new(0.0), pitch: W };
        Lines { raster, offset: 0, stride, joined: true, anchor: 0, inwards: 0, solid: false }
    }

    /// Rows 0 to `count`, 40 mm long, without `hole` on its rows.
    fn region(count: i32, hole: Option<(std::ops::Range<i32>, Span)>) -> Rows {
        let whole = [Span { start: 0, end: 400_000 }];
        let mut rows = Rows::starting_at(0);
        for j in 0..count {
            let cut = hole.as_ref().filter(|(rows, _)| rows.contains(&j)).map(|(_, s)| *s);
            rows.push_row(|out| subtract(&whole, cut.as_slice(), out));
        }
        rows
    }

    fn joins_are_inside(region: &Rows, strand: &Polyline) {
        for w in strand.windows(2).filter(|w| w[0].v != w[1].v) {
            for j in w[0].v.min(w[1].v) / W..=w[0].v.max(w[1].v) / W {
                let holds = |u: Coord| region.row(j).iter().any(|s| s.start <= u && u <= s.end);
                assert!(holds(w[0].u) && holds(w[1].u), "{w:?} on row {j}");
            }
        }
    }

    #[test]
    fn a_convex_region_is_one_zigzag() {
        let strands = every(5).strands(&region(26, None), W, W);
        assert_eq!(strands.len(), 1);
        let ends: Vec<Coord> = strands[0].iter().map(|p| p.u).collect();
        assert_eq!(ends[..6], [0, 400_000, 400_000, 0, 0, 400_000]);
        assert_eq!(strands[0].len(), 12);
    }

    #[test]
    fn joins_go_round_a_hole_and_never_across() {
        let hole = (6..14, Span { start: 100_000, end: 300_000 });
        let region = region(26, Some(hole));
        let strands = every(5).strands(&region, W, W);
        strands.iter().for_each(|strand| joins_are_inside(&region, strand));
        let lines: usize = strands.iter().map(|c| c.len() / 2).sum();
        assert_eq!(lines, 7, "six rows, one of them in two pieces: {strands:?}");
        assert!(strands.len() > 1);
    }

    #[test]
    fn lines_of_a_crossing_pattern_are_not_joined() {
        let grid = Lines { joined: false, ..every(5) };
        let strands = grid.strands(&region(26, None), W, W);
        assert_eq!(strands.len(), 6);
    }

    #[test]
    fn sparse_lines_far_apart_are_not_joined() {
        let strands = every(20).strands(&region(41, None), W, W);
        assert_eq!(strands.len(), 3);
        assert!(strands.iter().all(|c| c.len() == 2));
    }

    #[test]
    fn a_sparse_line_shorter_than_its_width_is_skipped() {
        let mut rows = Rows::starting_at(0);
        rows.push_row(|out| out.push(Span { start: 0, end: W - 1 }));
        assert!(every(1).strands(&rows, W, W).is_empty());
    }
}
