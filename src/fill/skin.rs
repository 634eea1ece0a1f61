//! Lines of a skin -> zigzags: neighbouring solid lines joined end to end, straight across.

use super::variable_width::{self, Joined, Line, LineParams};
use crate::geom::polyline::{LinePoint, Polyline};
use crate::pattern::zigzag::{Side, link};
use crate::units::Coord;

/// Maximum distance that a join runs along its lines, in line widths. A longer join would lie on
/// the ends of neighbouring lines; a smaller limit cuts zigzags at slanted walls.
const LONGEST_JOIN: Coord = 2;

/// Width of a join, in line widths. The round ends of the lines fill most of what it covers. A
/// larger value overfills each turn, a smaller one leaves it open.
const JOIN_WIDTH: f64 = 0.25;

/// Width of a join where turns are rounded. It is less because arcs cover more than corners do.
const ROUND_JOIN_WIDTH: f64 = 0.1;

/// Lines that turn in an arc are lengthened by the arc's radius divided by this. The arc cuts off
/// the corner; this moves it outwards to cover the same area. A smaller value presses plastic
/// into the wall, a larger one leaves open corners.
const REACH: Coord = 4;

/// Shorter lines are skipped (50 µm): the ends of their neighbours cover them.
const LEAST: i64 = 500;

/// Joins the lines of a skin, already closed up to the walls, to zigzags. `radius` is that with
/// which their turns will be rounded.
#[must_use]
pub fn zigzags(lines: &[Line], params: &LineParams, radius: Coord) -> Vec<Polyline> {
    let pitch = params.line_width;
    let rows: Vec<&[Line]> = lines.chunk_by(|a, b| a.row == b.row).collect();
    let solid = |line: &Line| Some(line.span).filter(|s| s.len() >= LEAST);
    let spans = rows.iter().map(|row| (row[0].row, row.iter().map(solid)));
    let join = |from: (Coord, i32), to: (Coord, i32), _: Side| {
        ((from.0 - to.0).abs() <= LONGEST_JOIN * pitch).then(Vec::new)
    };
    // Rows are sorted, but rows without skin are missing.
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
                extend_ends(&mut points, ends, link.from, radius);
                append_line(points, &mut polyline, pitch, radius);
            }
            polyline
        })
        .collect()
}

/// Moves the joined ends of a line outwards, so that the arcs there cover the area up to their
/// corners. `points` is entered from `side`; `joined` is for its first and last point.
fn extend_ends(points: &mut [LinePoint], joined: (bool, bool), side: Side, radius: Coord) {
    let by = if side == Side::Left { radius / REACH } else { -radius / REACH };
    if let [first, .., last] = points {
        first.u -= if joined.0 { by } else { 0 };
        last.u += if joined.1 { by } else { 0 };
    }
}

/// Appends a line to a polyline. The line has the widths at its points; those of the polyline
/// hold for the segment before each point.
fn append_line(points: Vec<LinePoint>, polyline: &mut Polyline, line_width: Coord, radius: Coord) {
    let share = if radius > 0 { ROUND_JOIN_WIDTH } else { JOIN_WIDTH };
    let join = (f64::from(line_width) * share) as Coord;
    let mut before = None;
    for point in points {
        let width = before.map_or(join, |b: Coord| (b + point.width) / 2);
        before = Some(point.width);
        polyline.push(LinePoint { width, ..point });
    }
}
