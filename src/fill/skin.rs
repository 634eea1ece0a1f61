//! Lines of a skin -> zigzags: neighbouring solid lines joined end to end, straight across.

use super::variable_width::{self, Joined, Line, LineParams};
use crate::geom::polyline::{LinePoint, Polyline};
use crate::pattern::zigzag::{Side, link};
use crate::units::Coord;

/// A join between two lines may run at most this many line widths along them: a longer one
/// would lie on its neighbours.
const LONGEST_JOIN: Coord = 2;

/// Width of a join between two lines, in line widths: the rest of what it covers
/// is filled by the lines' round ends.
const JOIN_WIDTH: f64 = 0.25;

/// The same where turns are rounded: arcs cover more than corners do.
const ROUND_JOIN_WIDTH: f64 = 0.1;

/// Lines that turn in an arc reach further by the arc's radius over this.
const REACH: Coord = 4;

/// Lines shorter than this are left out (50 µm): the ends of their neighbours cover them.
const LEAST: i64 = 500;

/// Zigzags of a skin's lines, which are closed up to the walls. Their turns will be rounded
/// with `radius`.
#[must_use]
pub fn zigzags(lines: &[Line], params: &LineParams, radius: Coord) -> Vec<Polyline> {
    let pitch = params.line_width;
    let rows: Vec<&[Line]> = lines.chunk_by(|a, b| a.row == b.row).collect();
    let solid = |line: &Line| Some(line.span).filter(|s| s.len() >= LEAST);
    let spans = rows.iter().map(|row| (row[0].row, row.iter().map(solid)));
    let join = |from: (Coord, i32), to: (Coord, i32), _: Side| {
        ((from.0 - to.0).abs() <= LONGEST_JOIN * pitch).then(Vec::new)
    };
    // Rows come in order, but rows without skin are left out.
    let line = |row: i32, index: usize| &rows[rows.partition_point(|r| r[0].row < row)][index];
    link(spans, 1, pitch, join)
        .into_iter()
        .map(|zigzag| {
            let mut polyline = Vec::with_capacity(2 * zigzag.len());
            for (k, link) in zigzag.iter().enumerate() {
                let mut joined = Joined::default();
                if k > 0 {
                    joined.below(link.from == Side::Left);
                }
                if k + 1 < zigzag.len() {
                    joined.above(link.from == Side::Right);
                }
                let mut points = variable_width::points(line(link.row, link.index), joined, params);
                if link.from == Side::Right {
                    points.reverse();
                }
                let ends = (k > 0, k + 1 < zigzag.len());
                reach(&mut points, ends, link.from, radius);
                lay(points, &mut polyline, pitch, radius);
            }
            polyline
        })
        .collect()
}

/// Moves those ends of a line that are joined (the first and the last of `points`, entered
/// from `side`) outwards, so that the arcs there cover what lies between their corners.
fn reach(points: &mut [LinePoint], joined: (bool, bool), side: Side, radius: Coord) {
    let by = if side == Side::Left { radius / REACH } else { -radius / REACH };
    if let [first, .., last] = points {
        first.u -= if joined.0 { by } else { 0 };
        last.u += if joined.1 { by } else { 0 };
    }
}

/// Appends a line, given with the widths at its points, to a polyline, whose widths are those
/// on the way to its points.
fn lay(points: Vec<LinePoint>, polyline: &mut Polyline, line_width: Coord, radius: Coord) {
    let share = if radius > 0 { ROUND_JOIN_WIDTH } else { JOIN_WIDTH };
    let join = (f64::from(line_width) * share) as Coord;
    let mut before = None;
    for point in points {
        let width = before.map_or(join, |b: Coord| (b + point.width) / 2);
        before = Some(point.width);
        polyline.push(LinePoint { width, ..point });
    }
}
