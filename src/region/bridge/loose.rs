//! Wall beads and the layer below -> beads that lie on something: none runs along sparse lines.
//!
//! Narrow skin is laid as beads along the walls ([`crate::region::wall_beads`]). Where they are the
//! first skin above sparse infill whose lines run in the same direction, they lie between two of
//! these lines, on nothing, for the whole length of the wall. Such stretches are cut out. What
//! they would cover is left to the lines of the skin, which run across.

use crate::geom::Point;
use crate::geom::frame::Frame;
use crate::geom::polyline::{self, LinePoint, Polyline};
use crate::geom::raster::Raster;
use crate::geom::spans::Rows;
use crate::units::{Bounded as _, Coord, nearest};

/// A bead may lie on nothing for this long (2 mm). A smaller value breaks beads at every gap
/// between two lines, a larger one leaves beads that sag.
const MOST_FREE: i64 = 20_000;

/// A bead runs along the lines below within this angle: its cosine, of 30°. Steeper ones meet the
/// next line within twice the spacing.
const ALONG: f64 = 0.866;

/// Pieces that are left over are dropped below this length, in line widths.
const SHORT: i64 = 3;

/// What lies below the beads of a layer, on the raster of its skin.
#[derive(Debug, Clone, Copy)]
pub struct Below<'a> {
    /// The raster. Beads are in its frame.
    pub raster: Raster,
    /// Where the layer below has skin or infill.
    pub fill: &'a Rows,
    /// Where its own neighbours leave it exposed: its skin, but for what reaches under infill.
    pub exposed: &'a Rows,
    /// The direction of its sparse lines.
    pub lines: Frame,
}

/// The parts of `beads` that lie on something.
#[must_use]
pub fn held(beads: Vec<Polyline>, below: &Below<'_>) -> Vec<Polyline> {
    let lines = below.direction();
    beads.into_iter().flat_map(|bead| cut(bead, below, lines)).collect()
}

/// A point of a bead, and whether the way to it is free.
#[derive(Debug, Clone, Copy)]
struct Step {
    point: LinePoint,
    is_corner: bool,
    is_free: bool,
}

fn cut(bead: Polyline, below: &Below<'_>, lines: [f64; 2]) -> Vec<Polyline> {
    let mut steps = Vec::new();
    for (k, ends) in bead.windows(2).enumerate() {
        let (a, b) = (ends[0], ends[1]);
        let way = [f64::from(b.u) - f64::from(a.u), f64::from(b.v) - f64::from(a.v)];
        let length = (way[0] * way[0] + way[1] * way[1]).sqrt().at_least(1.0);
        let along = (way[0] * lines[0] + way[1] * lines[1]).abs() > ALONG * length;
        let count = (2.0 * length / f64::from(below.raster.pitch)).ceil().at_least(1.0) as i32;
        for n in i32::from(k > 0)..=count {
            let t = f64::from(n) / f64::from(count);
            let at = |a: Coord, way: f64| a + nearest(t * way) as Coord;
            let point = LinePoint { u: at(a.u, way[0]), v: at(a.v, way[1]), width: b.width };
            let is_free = along && below.is_free(point);
            steps.push(Step { point, is_corner: n == 0 || n == count, is_free });
        }
    }
    let length = |run: &[Step]| polyline::length(&run.iter().map(|s| s.point).collect::<Vec<_>>());
    let is_cut = |run: &[Step]| run[0].is_free && length(run) > MOST_FREE;
    let runs: Vec<&[Step]> = steps.chunk_by(|a, b| a.is_free == b.is_free).collect();
    if !runs.iter().any(|run| is_cut(run)) {
        return vec![bead];
    }
    let least = SHORT * i64::from(below.raster.pitch);
    let kept = runs.split(|run| is_cut(run)).map(<[&[Step]]>::concat);
    kept.filter(|piece| length(piece) >= least).map(|piece| corners(&piece)).collect()
}

/// The ends and corners of a piece.
fn corners(piece: &[Step]) -> Polyline {
    let last = piece.len() - 1;
    let keep =
        |(k, step): (usize, &Step)| (step.is_corner || k == 0 || k == last).then_some(step.point);
    piece.iter().enumerate().filter_map(keep).collect()
}

impl Below<'_> {
    /// The direction of the sparse lines in the frame of the beads.
    fn direction(&self) -> [f64; 2] {
        const FAR: Coord = 1_000_000;
        let to = self.raster.frame.enter(self.lines.leave(Point { x: FAR, y: 0 }));
        [to.x, to.y].map(|x| f64::from(x) / f64::from(FAR))
    }

    /// Whether there is sparse infill below a point, as far as the nearest row tells.
    fn is_free(&self, point: LinePoint) -> bool {
        let row = nearest(f64::from(point.v) / f64::from(self.raster.pitch)) as i32;
        let holds =
            |rows: &Rows| rows.row(row).iter().any(|s| s.start < point.u && point.u < s.end);
        holds(self.fill) && !holds(self.exposed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::spans::Span;

    const W: Coord = 4_000;

    /// Rows from `first` to `last`, 0 to 50 mm long.
    fn rows(first: i32, last: i32) -> Rows {
        let mut rows = Rows::starting_at(first);
        (first..=last).for_each(|_| rows.push_row(|out| out.push(Span { start: 0, end: 500_000 })));
        rows
    }

    fn bead(points: &[(Coord, Coord)]) -> Polyline {
        points.iter().map(|&(u, v)| LinePoint { u, v, width: W }).collect()
    }

    /// What is left of `bead` above infill on rows 0 to 40, with skin below on rows 0 to 5.
    fn left(bead: Polyline, degrees: f64) -> Vec<Polyline> {
        let (fill, exposed) = (rows(0, 40), rows(0, 5));
        let raster = Raster { frame: Frame::new(0.0), pitch: W };
        let lines = Frame::new(degrees);
        held(vec![bead], &Below { raster, fill: &fill, exposed: &exposed, lines })
    }

    #[test]
    fn a_bead_along_the_lines_below_is_left_to_lines_across() {
        let along = bead(&[(10_000, 20 * W), (400_000, 20 * W)]);
        assert!(left(along.clone(), 0.0).is_empty());
        assert_eq!(left(along.clone(), 90.0), [along]);
        let on_skin = bead(&[(10_000, 3 * W), (400_000, 3 * W)]);
        assert_eq!(left(on_skin.clone(), 0.0), [on_skin]);
    }

    #[test]
    fn only_the_stretch_that_lies_on_nothing_is_cut_out() {
        // Along row 3, which lies on skin, across the lines, back along row 20.
        let bead = bead(&[(400_000, 3 * W), (50_000, 3 * W), (50_000, 20 * W), (300_000, 20 * W)]);
        let left = left(bead, 0.0);
        assert_eq!(left.len(), 1);
        let ends = [left[0][0], left[0][left[0].len() - 1]].map(|p| (p.u, p.v));
        assert_eq!(ends, [(400_000, 3 * W), (50_000, 20 * W)]);
    }
}
