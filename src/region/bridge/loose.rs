//! Wall beads and the layer below -> beads that lie on something: none runs along sparse lines.
//!
//! Narrow skin is laid as beads along the walls ([`crate::region::wall_beads`]). Where they are the
//! first skin above sparse infill whose lines run in the same direction, they lie between two of
//! these lines, on nothing, for the whole length of the wall. Such stretches are cut out. What
//! they would cover is left to the lines of the skin, which run across. It may be narrower than the
//! rows lie apart, so that none of them tells of it: it is handed on as [`bare`] rows.

use crate::geom::Point;
use crate::geom::frame::Frame;
use crate::geom::polyline::{self, LinePoint, Polyline};
use crate::geom::raster::Raster;
use crate::geom::spans::Rows;
use crate::region::wall_beads::beside;
use crate::units::{Bounded as _, Coord, nearest};

/// A bead may lie on nothing for this long (2 mm). A smaller value breaks beads at every gap
/// between two lines, a larger one leaves beads that sag.
const MOST_FREE: i64 = 20_000;

/// A bead runs along the lines below within this angle: its cosine, of 30°. Steeper ones meet the
/// next line within twice the spacing.
pub(super) const ALONG: f64 = 0.866;

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

/// Wall beads of a layer.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Beads {
    /// Those that lie on something.
    pub kept: Vec<Polyline>,
    /// What was cut out of others. Nothing covers it but the lines of the skin.
    pub cut: Vec<Polyline>,
}

/// Divides `beads` into the parts that lie on something, and the rest.
#[must_use]
pub fn held(beads: Vec<Polyline>, below: &Below<'_>) -> Beads {
    let lines = below.direction();
    let mut out = Beads::default();
    beads.into_iter().for_each(|bead| divide(bead, below, lines, &mut out));
    out
}

/// Where beads that were `cut` out, given in the frame `from`, leave a layer bare: on the rows of
/// `raster` that are next to them.
#[must_use]
pub fn bare(cut: &[Polyline], from: Frame, raster: Raster) -> Rows {
    // Two rows may lie as far away as half their distance.
    beside(cut, from, raster, |width| (width / 2).max(raster.pitch / 2 + 1))
}

/// A point of a bead, and whether the way to it is free.
#[derive(Debug, Clone, Copy)]
struct Step {
    point: LinePoint,
    is_corner: bool,
    is_free: bool,
}

fn divide(bead: Polyline, below: &Below<'_>, lines: [f64; 2], out: &mut Beads) {
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
        out.kept.push(bead);
        return;
    }
    let least = SHORT * i64::from(below.raster.pitch);
    for pieces in runs.chunk_by(|a, b| !is_cut(a) && !is_cut(b)) {
        let piece = pieces.concat();
        let to =
            if is_cut(pieces[0]) || length(&piece) < least { &mut out.cut } else { &mut out.kept };
        to.push(corners(&piece));
    }
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
    fn left(bead: Polyline, degrees: f64) -> Beads {
        let (fill, exposed) = (rows(0, 40), rows(0, 5));
        let raster = Raster { frame: Frame::new(0.0), pitch: W };
        let lines = Frame::new(degrees);
        held(vec![bead], &Below { raster, fill: &fill, exposed: &exposed, lines })
    }

    #[test]
    fn a_bead_along_the_lines_below_is_left_to_lines_across() {
        let along = bead(&[(10_000, 20 * W), (400_000, 20 * W)]);
        assert!(left(along.clone(), 0.0).kept.is_empty());
        assert_eq!(left(along.clone(), 90.0).kept, [along]);
        let on_skin = bead(&[(10_000, 3 * W), (400_000, 3 * W)]);
        assert_eq!(left(on_skin.clone(), 0.0).kept, [on_skin]);
    }

    #[test]
    fn only_the_stretch_that_lies_on_nothing_is_cut_out() {
        // Along row 3, which lies on skin, across the lines, back along row 20.
        let bead = bead(&[(400_000, 3 * W), (50_000, 3 * W), (50_000, 20 * W), (300_000, 20 * W)]);
        let Beads { kept, cut } = left(bead, 0.0);
        let ends = |pieces: &[Polyline]| {
            assert_eq!(pieces.len(), 1);
            [pieces[0][0], pieces[0][pieces[0].len() - 1]].map(|p| (p.u, p.v))
        };
        assert_eq!(ends(&kept), [(400_000, 3 * W), (50_000, 20 * W)]);
        assert_eq!(ends(&cut)[1], (300_000, 20 * W));
    }

    #[test]
    fn what_is_cut_out_is_seen_by_a_row_of_every_raster() {
        for (degrees, pitch) in [(0.0, W), (90.0, W), (45.0, 5 * W), (0.0, 5 * W)] {
            // Between two rows, and narrower than they lie apart.
            let cut = vec![bead(&[(10_000, 20 * W + W / 2), (400_000, 20 * W + W / 2)])];
            let rows = bare(&cut, Frame::new(0.0), Raster { frame: Frame::new(degrees), pitch });
            assert!(!rows.is_empty(), "{degrees} {pitch}");
        }
    }
}
