//! Lines of a skin -> zigzags: neighbouring solid lines joined end to end, straight across.

use super::monotonic::in_order;
use super::variable_width::{self, Joined, Line, LineParams};
use crate::geom::Point;
use crate::geom::polyline::{LinePoint, Polyline};
use crate::pattern::zigzag::{Side, link};
use crate::units::{Coord, nearest};

/// Maximum distance that a join runs along its lines, in line widths. A longer join would lie on
/// the ends of neighbouring lines; a smaller limit cuts zigzags at slanted walls.
const LONGEST_JOIN: Coord = 2;

/// Share of the overlap by which joins are moved back from the wall. At 1 their plastic fills the room
/// exactly, but their round corners leave notches at the wall; at 0 the whole join lies in the wall.
const MOVED_BACK: f64 = 0.75;

/// Shorter lines are skipped (50 µm): the ends of their neighbours cover them.
const LEAST: i64 = 500;

/// Plastic that a zigzag may have beyond its room: its turns fill the notches between their round
/// corners. At 0 lines of narrow places are so thin that hair lines stay open between them; a larger
/// value presses more into the walls of narrow rooms.
const MOST_OVER: f64 = 0.04;

/// It gets at least this share: narrower lines no longer lie side by side.
const LEAST_SHARE: f64 = 0.85;

/// Joins the lines of a skin, already closed up to the walls, to zigzags.
///
/// A join is a bead of full width along the wall. Lines reach into the wall with their round ends, so
/// that a join between two ends would lie in it. Both ends are moved back by most of the
/// overlap, measured at right angles to the join: then its edge lies near the wall's.
///
/// `monotonic` zigzags are to be printed one after the other as they come, each in its direction.
#[must_use]
pub fn zigzags(lines: &[Line], monotonic: bool, params: &LineParams) -> Vec<Polyline> {
    let pitch = params.line_width;
    let rows: Vec<&[Line]> = lines.chunk_by(|a, b| a.row == b.row).collect();
    let solid = |line: &Line| Some(line.span).filter(|s| s.len() >= LEAST);
    let spans = rows.iter().map(|row| (row[0].row, row.iter().map(solid)));
    let join = |from: (Coord, i32), to: (Coord, i32), _: Side| {
        ((from.0 - to.0).abs() <= LONGEST_JOIN * pitch).then(Vec::new)
    };
    // Rows are sorted, but rows without skin are missing.
    let line = |row: i32, index: usize| &rows[rows.partition_point(|r| r[0].row < row)][index];
    let zigzags = link(spans, 1, pitch, join);
    let zigzags = if monotonic { in_order(zigzags, pitch) } else { zigzags };
    zigzags
        .into_iter()
        .map(|zigzag| {
            let mut polyline = Vec::with_capacity(2 * zigzag.len());
            let mut back = 0;
            for (k, link) in zigzag.iter().enumerate() {
                let mut joined = Joined::default();
                if k > 0 {
                    joined.below(link.from == Side::Left);
                }
                let mut next_back = 0;
                if let Some(next) = zigzag.get(k + 1) {
                    joined.above(link.from == Side::Right);
                    let run = link.from.other().of(link.span) - next.from.of(next.span);
                    next_back = moved_back(run, params);
                }
                let line = line(link.row, link.index);
                let mut points = variable_width::points(line, joined, params);
                if link.from == Side::Right {
                    points.reverse();
                }
                move_ends(&mut points, (back, next_back));
                append_line(points, &mut polyline, params);
                back = next_back;
            }
            let all = zigzag.iter().map(|link| line(link.row, link.index));
            thin(&mut polyline, all.map(|line| room(line, params)).sum());
            polyline
        })
        .collect()
}

/// The area that a line and half the turns at its ends have between walls.
fn room(line: &Line, params: &LineParams) -> f64 {
    let w = f64::from(params.line_width);
    // Its span ends where its middle reaches `overlap` further than the wall's edge lets it.
    let ends = w - 2.0 * f64::from(params.overlap);
    w * (line.span.len() as f64 + ends) + line.beside
}

/// Takes from a zigzag what is more than its `room` takes.
fn thin(polyline: &mut Polyline, room: f64) {
    let at = |p: &LinePoint| Point { x: p.u, y: p.v };
    let area = |w: &[LinePoint]| at(&w[0]).distance(at(&w[1])) * f64::from(w[1].width);
    let area: f64 = polyline.windows(2).map(area).sum();
    if area <= (1.0 + MOST_OVER) * room {
        return;
    }
    let share = ((1.0 + MOST_OVER) * room / area).max(LEAST_SHARE);
    for point in polyline {
        point.width = nearest(share * f64::from(point.width)) as Coord;
    }
}

/// How far two ends, `run` apart along their lines, are moved back from the wall.
fn moved_back(run: Coord, params: &LineParams) -> Coord {
    let (run, rise) = (f64::from(run), f64::from(params.line_width));
    nearest(MOVED_BACK * f64::from(params.overlap) * (run * run + rise * rise).sqrt() / rise)
        as Coord
}

/// Moves the first and the last point of a line inwards, at most to a third of its length.
fn move_ends(points: &mut [LinePoint], (first_back, last_back): (Coord, Coord)) {
    if let [first, .., last] = points {
        let way = last.u - first.u;
        let back = |by: Coord| by.min(way.abs() / 3) * way.signum();
        (first.u, last.u) = (first.u + back(first_back), last.u - back(last_back));
    }
}

/// Appends a line to a polyline. The line has the widths at its points; those of the polyline
/// hold for the segment before each point. A join is as wide as a line where it is the outside of the part.
fn append_line(points: Vec<LinePoint>, polyline: &mut Polyline, params: &LineParams) {
    let mut before: Option<Coord> = polyline.last().map(|p: &LinePoint| p.width);
    let is_outside = !params.walled && before.is_some();
    let first = polyline.len();
    for point in points {
        let width = before.map_or(point.width, |b| (b + point.width) / 2);
        before = Some(point.width);
        polyline.push(LinePoint { width, ..point });
    }
    if let Some(join) = polyline.get_mut(first).filter(|_| is_outside) {
        join.width = params.line_width;
    }
}
