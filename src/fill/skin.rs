//! Lines of a skin -> zigzags: neighbouring solid lines joined end to end, straight across.
//!
//! Words: a *join* is the piece between the ends of two lines. A *turn* is a join with what it does to these
//! ends. A *room* is the area that a zigzag has between walls.
//!
//! Algorithm: link the lines row by row. At each turn move both ends back from the wall, so that the edge of the
//! join lies near that of the wall, and apart along a slanted wall, so that turns close the gaps between them.
//! Then lines take the widths that [`gap_closing`](super::gap_closing) gives them. Last, compare the plastic of
//! the zigzag with its room, and make thinner what is too much: joins before lines.

use super::gap_closing::STEEPEST;
use super::monotonic::in_order;
use super::variable_width::{self, Joined, Line, LineParams};
use crate::geom::polyline::{LinePoint, Polyline, area};
use crate::pattern::zigzag::{Link, Side, link};
use crate::units::{Bounded as _, Coord, nearest};

/// Maximum distance that a join runs along its lines, in line widths. A longer join would lie on
/// the ends of neighbouring lines; a smaller limit cuts zigzags at slanted walls.
const LONGEST_JOIN: Coord = 2;

/// Share of the overlap by which joins are moved back from the wall. At 1 their plastic fills the room
/// exactly, but their round corners leave notches at the wall; at 0 the whole join lies in the wall.
const MOVED_BACK: f64 = 0.75;

/// So much less at a slanted wall, for each line width that the gap between two turns there is wide: the pointed corners
/// of turns would leave notches at the wall.
const SLANTED: f64 = 0.6;

/// Share of the gap between two turns along a slanted wall that they close: the ends of each turn move apart along the
/// wall. At 1 the notch between their round corners stays open; at 2 lines beside them are pressed together.
const APART: f64 = 1.2;

/// Length of the piece at the end of a line that bends towards the gap, in tenths of a line's width. A larger value
/// opens wedges between lines, and their straight parts end before they lie on a wall; a smaller one makes sharp bends.
const END_PIECE: Coord = 3;

/// Shorter lines are skipped (50 µm): the ends of their neighbours cover them.
const LEAST: i64 = 500;

/// Plastic that a zigzag may have beyond its room: its turns fill the notches between their round
/// corners. At 0 lines of narrow places are so thin that hair lines stay open between them; a larger
/// value presses more into the walls of narrow rooms.
const MOST_OVER: f64 = 0.04;

/// Lines thinned to this share leave slots of 20 µm, with lines of 0.4 mm, which nobody sees. A larger value changes the
/// flow at the turns of nearly all zigzags; a smaller one leaves slots.
const UNSEEN: f64 = 0.95;

/// Lines keep at least this share of their width: narrower ones no longer lie side by side.
const LEAST_SHARE: f64 = 0.85;

/// Joins keep at least this share of theirs. A smaller one tears, a larger one leaves slots between lines.
const LEAST_JOIN: f64 = 0.75;

/// Joins the lines of a skin, already closed up to the walls, to zigzags.
///
/// A join is a bead of full width along the wall. Lines reach into the wall with their round ends, so
/// that a join between two ends would lie in it. Both ends are moved back by most of the
/// overlap, measured at right angles to the join: then its edge lies near the wall's.
/// Along a slanted wall both ends also move apart, up to the next turn.
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
    let line = |link: &Link| &rows[rows.partition_point(|r| r[0].row < link.row)][link.index];
    let zigzags = link(spans, 1, pitch, join);
    let zigzags = if monotonic { in_order(zigzags, pitch) } else { zigzags };
    zigzags.into_iter().map(|links| bead(&links, line, params)).collect()
}

/// The bead along the lines of a zigzag.
fn bead<'a>(links: &[Link], line: impl Fn(&Link) -> &'a Line, params: &LineParams) -> Polyline {
    let mut bead = Vec::with_capacity(2 * links.len());
    let mut joins = Vec::with_capacity(links.len());
    let mut turn = Turn::default();
    for (k, link) in links.iter().enumerate() {
        let mut joined = Joined::default();
        if k > 0 {
            joined.below(link.from == Side::Left);
            joins.push(bead.len());
        }
        let mut next_turn = Turn::default();
        if let Some(next) = links.get(k + 1) {
            joined.above(link.from == Side::Right);
            let ends = [(link, link.from.other()), (next, next.from)];
            let [from, to] = ends.map(|(link, side)| side.of(link.span));
            let at_wall =
                ends.map(|(link, side)| line(link).at_wall[usize::from(side == Side::Right)]);
            next_turn = Turn::new(to - from, at_wall == [true; 2], params);
        }
        let mut points = variable_width::points(line(link), joined, params);
        if link.from == Side::Right {
            points.reverse();
        }
        move_ends(&mut points, (turn, next_turn), params.line_width);
        append_line(points, &mut bead, params);
        turn = next_turn;
    }
    thin(&mut bead, &joins, links.iter().map(|link| room(line(link), params)).sum());
    bead
}

/// The area that a line and half the turns at its ends have between walls.
fn room(line: &Line, params: &LineParams) -> f64 {
    let w = f64::from(params.line_width);
    // Its span ends where its middle reaches `overlap` further than the wall's edge lets it.
    let ends = w - 2.0 * f64::from(params.overlap);
    w * (line.span.len() as f64 + ends) + line.beside
}

/// Takes from a zigzag what is more than its `room` takes. If lines would leave slots between them, it is taken from
/// the `joins` first, which lie on walls: they are given by the points that they lead to.
fn thin(bead: &mut Polyline, joins: &[usize], room: f64) {
    let (all, most) = (area(bead), (1.0 + MOST_OVER) * room);
    if all <= most {
        return;
    }
    let in_joins: f64 = joins.iter().map(|&k| area(&bead[k - 1..=k])).sum();
    let even = most / all;
    let joins_alone = (1.0 - (all - most) / in_joins.at_least(1.0)).at_least(LEAST_JOIN);
    let of_joins = if even < UNSEEN { joins_alone } else { even };
    let in_lines = (all - in_joins).at_least(1.0);
    let of_lines = ((most - of_joins * in_joins) / in_lines).clamp(LEAST_SHARE, 1.0);
    let mut joins = joins.iter().peekable();
    for (k, point) in bead.iter_mut().enumerate() {
        let share = if joins.next_if_eq(&&k).is_some() { of_joins } else { of_lines };
        point.width = nearest(share * f64::from(point.width)) as Coord;
    }
}

/// How the two ends of a turn are moved.
#[derive(Debug, Clone, Copy, Default)]
struct Turn {
    /// Both, back from the wall.
    back: Coord,
    /// The second one along the wall, on the row and across; the first one as far the other way.
    apart: [Coord; 2],
}

impl Turn {
    /// Between two ends, the second one `run` further along the rows, both `at_wall` or not.
    fn new(run: Coord, at_wall: bool, params: &LineParams) -> Self {
        let (run, rise) = (f64::from(run), f64::from(params.line_width));
        let far = (run * run + rise * rise).sqrt();
        let gap = if at_wall { far - rise } else { 0.0 };
        let moved_back = (MOVED_BACK - SLANTED * gap / rise).max(0.0);
        let back = moved_back * f64::from(params.overlap) * far / rise;
        // At flatter walls the lines themselves close what is open.
        let is_steep = run.abs() < STEEPEST * rise;
        let gap = if is_steep { gap } else { 0.0 };
        let apart = [run, rise].map(|way| nearest(APART / 2.0 * gap * way / far) as Coord);
        Self { back: nearest(back) as Coord, apart }
    }
}

/// Moves the first and the last point of a line as the turns there ask, inwards at most to a third of its length.
fn move_ends(points: &mut Vec<LinePoint>, (first_turn, last_turn): (Turn, Turn), pitch: Coord) {
    if let [first, .., last] = points.as_mut_slice() {
        let way = last.u - first.u;
        let back = |by: Coord| by.min(way.abs() / 3) * way.signum();
        first.u += back(first_turn.back);
        last.u -= back(last_turn.back);
    }
    move_apart(points, last_turn.apart.map(|by| -by), pitch);
    points.reverse();
    move_apart(points, first_turn.apart, pitch);
    points.reverse();
}

/// Moves the last point of a line by `apart`. The line runs straight up to its end piece, if it is long enough.
fn move_apart(points: &mut Vec<LinePoint>, apart: [Coord; 2], pitch: Coord) {
    let [.., before, mut last] = points[..] else { return };
    if apart == [0; 2] {
        return;
    }
    let (way, piece) = (last.u - before.u, END_PIECE * pitch / 10);
    points.pop();
    if way.abs() > 2 * piece {
        points.push(LinePoint { u: last.u - piece * way.signum(), ..last });
    }
    (last.u, last.v) = (last.u + apart[0], last.v + apart[1]);
    points.push(last);
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
