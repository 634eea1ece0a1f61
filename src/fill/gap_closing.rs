//! Skin rows of two crossing rasters -> Lines: skin closed up to the walls, slivers included.
//!
//! Words: a *line* is what is printed of one span of a row. A *column* is a row of the raster
//! across. A *strip* is the open room beside a line. An *extent* is a span of a column: the
//! skin's exact size across the lines at one place. A *sliver* is skin that no line reaches.
//!
//! Raster lines lie on a fixed grid. So a strip up to one line width wide stays open between
//! the last line and a wall that runs nearly parallel to it, and skin narrower than a line may
//! fall between two rows.
//!
//! Algorithm: for each extent, measure the strips above its highest and below its lowest row.
//! [`variable_width`](super::variable_width) then moves and widens the line to fill them. An
//! extent without a row is part of a sliver, which gets a bead along its middle. Columns are
//! one line width apart and miss shorter strips. Those lie where a line ends beyond the end of
//! the line beside it, so they are computed from these two ends. Columns cost nothing extra:
//! the region stage needs them for neighbouring layers.
//!
//! Rows may also lie deeper in a wall than lines reach into it: then a narrow room has more lines than
//! space. How much room a line truly has beside it is kept with it, and [`skin`](super::skin) takes
//! away what is too much.
//!
//! Only edges at a wall are closed. An edge at the infill has more skin than it needs.

use super::variable_width::{Line, LineParams, SHORT_STRIP, Strip, WIDEST};
use crate::geom::polyline::{LinePoint, Polyline};
use crate::geom::raster::crossed;
use crate::geom::spans::{Rows, Span};
use crate::region::crossed::Crossed;
use crate::units::Coord;
use std::ops::Range;

/// Narrower strips stay open (20 µm): about half the positioning error of a printer. A smaller
/// value gives nearly every line of a slanted wall a changing width; a larger one leaves gaps.
const LEAST_STRIP: Coord = 200;

/// Slivers seen by fewer columns in a row get no bead: one column gives one point, which has no
/// length. 3, the first value, left slivers with two columns open.
const LEAST_COLUMNS: usize = 2;

/// Least width of a bead along a sliver, in line widths: a nozzle lays no thinner one evenly. At a smaller value it
/// tears; a larger one presses more than there is room for into slivers.
const THINNEST: f64 = 0.72;

/// The two rasters tell the same edge apart by at most this, grid units: rounding.
const ROUNDING: Coord = 2;

/// At a wall that moves on by less than this from row to row, in pitches, lines run straight up to it: their round
/// ends and turns ([`skin`](super::skin)) cover what is open. A smaller value gives every second line of a slanted or
/// round wall a hook; a larger one leaves notches.
pub(super) const STEEPEST: f64 = 1.1;

/// Without walls, strips beside each other that differ by more than this part of a line lie along an edge that is
/// too slanted to be followed by wide beads: 6°. A larger value lets beads reach out of the part.
const EVEN: f64 = 0.1;

/// Room for the strips added at the ends of a line: three at each end ([`add_end`]). Reserved at
/// once to avoid reallocation; a wrong value costs time only.
const AT_ENDS: usize = 6;

/// Returns the lines of a skin and the beads along its slivers, without those that have nowhere room for a bead
/// as wide as `least`.
#[must_use]
pub fn close(
    crossed: &Crossed<'_>,
    least: Coord,
    params: &LineParams,
) -> (Vec<Line>, Vec<Polyline>) {
    let mut strips = Strips::new(crossed.skin.range(), params);
    let mut thin = Vec::new();
    for extent in extents(crossed, params) {
        let rows = rows_of(&extent, crossed.skin, params.line_width);
        if !strips.add(&extent, rows, params) && (extent.wall_low || extent.wall_high) {
            thin.push(extent);
        }
    }
    let mut lines = Vec::new();
    for (row, spans) in crossed.skin.iter() {
        for &span in spans {
            let (above, below) = strips.beside(row, span);
            let at_wall = [false; 2];
            let mut line = Line { row, span, above, below, beside: 0.0, at_wall };
            if params.walled {
                line.at_wall = at_walls(span, crossed.fill.row(row));
                line.beside = strips.room_beside(row, span);
                let Line { above, below, at_wall, .. } = &mut line;
                add_ends(above, (span, *at_wall), crossed.fill.row(row + 1), params);
                add_ends(below, (span, *at_wall), crossed.fill.row(row - 1), params);
            } else {
                // The skin ends at the outside of the part, and no bead may reach out of it.
                keep_even(&mut line.above, params.line_width);
                keep_even(&mut line.below, params.line_width);
            }
            lines.push(line);
        }
    }
    (lines, slivers(thin, least, params))
}

/// A span of a column, in the frame of the lines, and which of its ends are at a wall.
#[derive(Debug, Clone, Copy)]
struct Extent {
    u: Coord,
    low: Coord,
    high: Coord,
    wall_low: bool,
    wall_high: bool,
}

/// The extents of all columns, sorted by u.
fn extents(crossed: &Crossed<'_>, params: &LineParams) -> Vec<Extent> {
    let mut out = Vec::new();
    for (c, spans) in crossed.columns.iter() {
        let walls = crossed.fill_columns.row(c);
        for &span in spans {
            let at_start = walls.iter().any(|w| w.start == span.start);
            let at_end = walls.iter().any(|w| w.end == span.end);
            let at = c * params.line_width;
            // Back to the frame of the lines: turned left, u is −v of the columns; else v is −u.
            out.push(if crossed.left_turn {
                let (wall_low, wall_high) = (at_start, at_end);
                Extent { u: -at, low: span.start, high: span.end, wall_low, wall_high }
            } else {
                let (wall_low, wall_high) = (at_end, at_start);
                Extent { u: at, low: -span.end, high: -span.start, wall_low, wall_high }
            });
        }
    }
    out.sort_by_key(|e| (e.u, e.low));
    out
}

/// The rows, `pitch` apart, that cross `extent`. One along its very edge counts only if the skin has it:
/// which of the rows along its edges an area has is for its scan to say.
fn rows_of(extent: &Extent, skin: &Rows, pitch: Coord) -> Range<i32> {
    let rows = crossed(extent.low, extent.high, pitch);
    let is_lacking = |row: i32, edge: Coord| {
        (row * pitch - edge).abs() <= ROUNDING && skin.span_at(row, extent.u).is_none()
    };
    let lacks = [is_lacking(rows.start, extent.low), is_lacking(rows.end - 1, extent.high)];
    rows.start + i32::from(lacks[0])..rows.end - i32::from(lacks[1])
}

/// The strips beside the lines of each row, sorted by u.
struct Strips {
    first: i32,
    above: Vec<Vec<Strip>>,
    below: Vec<Vec<Strip>>,
    /// All strips beside each row, also those less than zero wide, where it lies too deep in a wall.
    all: Vec<Vec<(Coord, Coord)>>,
    pitch: Coord,
}

impl Strips {
    fn new(range: Range<i32>, params: &LineParams) -> Self {
        let empty = vec![Vec::new(); range.len()];
        Self {
            first: range.start,
            above: empty.clone(),
            below: empty,
            all: vec![Vec::new(); range.len()],
            pitch: params.line_width,
        }
    }

    /// The strips above and below `span` of `row`.
    fn beside(&self, row: i32, span: Span) -> (Vec<Strip>, Vec<Strip>) {
        let of = |rows: &[Vec<Strip>]| {
            let strips = self.index(row).map_or(&[] as &[Strip], |k| &rows[k]);
            let from = strips.partition_point(|s| s.u <= span.start);
            let to = strips.partition_point(|s| s.u < span.end);
            let found = strips.get(from..to).unwrap_or_default();
            let mut out = Vec::new();
            if !found.is_empty() {
                out.reserve_exact(found.len() + AT_ENDS);
                out.extend_from_slice(found);
            }
            out
        };
        (of(&self.above), of(&self.below))
    }

    /// The area of the strips beside `span` of `row`, less that by which it lies too deep in walls: as
    /// in its middle. Near its ends a slanted wall makes steps, which are no strips.
    fn room_beside(&self, row: i32, span: Span) -> f64 {
        let known = self.index(row).map_or(&[] as &[_], |k| &self.all[k]);
        if known.is_empty() {
            return 0.0;
        }
        let ends = (span.len() / 3).min(i64::from(SHORT_STRIP * self.pitch)) as Coord;
        let from = known.partition_point(|(u, _)| *u < span.start + ends);
        let inner = known[from..].iter().take_while(|(u, _)| *u <= span.end - ends);
        let open = inner.map(|(_, open)| f64::from(*open));
        let share = span.len() as f64 / (span.len() - 2 * i64::from(ends)).max(1) as f64;
        open.sum::<f64>() * f64::from(self.pitch) * share
    }

    fn index(&self, row: i32) -> Option<usize> {
        usize::try_from(row - self.first).ok().filter(|&k| k < self.above.len())
    }

    /// Adds the strips above the highest and below the lowest of the `rows` within `extent`. Returns
    /// `false` if no row crosses it.
    fn add(&mut self, extent: &Extent, rows: Range<i32>, params: &LineParams) -> bool {
        if rows.is_empty() {
            return false;
        }
        let (lowest, highest) = (rows.start, rows.end - 1);
        // A line at the wall already reaches `overlap` into it.
        let above = extent.high - highest * self.pitch - params.overlap;
        let below = lowest * self.pitch - extent.low - params.overlap;
        let strip = |open: Coord| Strip { u: extent.u, open: f64::from(open) };
        if let Some(k) = self.index(highest).filter(|_| extent.wall_high && above > LEAST_STRIP) {
            self.above[k].push(strip(above));
        }
        if let Some(k) = self.index(lowest).filter(|_| extent.wall_low && below > LEAST_STRIP) {
            self.below[k].push(strip(below));
        }
        let both = [(highest, extent.wall_high, above), (lowest, extent.wall_low, below)];
        for (row, _, open) in
            both.into_iter().filter(|(_, wall, open)| *wall && open.abs() > LEAST_STRIP)
        {
            if let Some(k) = self.index(row) {
                self.all[k].push((extent.u, open));
            }
        }
        true
    }
}

/// Keeps the strips that are as wide as those beside them, one pitch away: along an edge that runs as the
/// line does.
fn keep_even(strips: &mut Vec<Strip>, pitch: Coord) {
    let is_even = |a: &Strip, b: &Strip| {
        (a.u - b.u).abs() <= pitch && (a.open - b.open).abs() <= EVEN * f64::from(pitch)
    };
    let all = std::mem::take(strips);
    let even = |k: usize| {
        let before = k.checked_sub(1).is_none_or(|before| is_even(&all[before], &all[k]));
        before && all.get(k + 1).is_none_or(|after| is_even(&all[k], after)) && all.len() > 2
    };
    *strips = (0..all.len()).filter(|&k| even(k)).map(|k| all[k]).collect();
}

/// Whether `span` begins and ends where one between `walls` does.
fn at_walls(span: Span, walls: &[Span]) -> [bool; 2] {
    [walls.iter().any(|w| w.start == span.start), walls.iter().any(|w| w.end == span.end)]
}

/// Adds the strips at those ends of a line that are `at_wall`, on the side of a row that has `others` between
/// walls. Where the wall cuts this row a little before it cuts the line's, the strip between is one pitch wide
/// at the end of the other and tapers to nothing at the end of the line.
fn add_ends(
    strips: &mut Vec<Strip>,
    (span, at_wall): (Span, [bool; 2]),
    others: &[Span],
    params: &LineParams,
) {
    let beside = |u: Coord| others.iter().any(|o| o.start <= u && u <= o.end);
    if at_wall[1] && !beside(span.end) {
        let edge = others.iter().map(|o| o.end).filter(|&u| u < span.end).max();
        add_end(strips, span, (edge, span.end), params);
    }
    if at_wall[0] && !beside(span.start) {
        let edge = others.iter().map(|o| o.start).filter(|&u| u > span.start).min();
        add_end(strips, span, (edge, span.start), params);
    }
    strips.sort_by_key(|s| s.u);
    strips.dedup_by_key(|s| s.u);
}

/// Adds the strip between `edge`, where the other row ends, and the line's own `end`, if it is
/// short. It replaces the strips that columns measured there.
fn add_end(
    strips: &mut Vec<Strip>,
    span: Span,
    (edge, end): (Option<Coord>, Coord),
    params: &LineParams,
) {
    let pitch = params.line_width;
    let inside = |u: Coord| span.start < u && u < span.end;
    let near = |u: Coord| (u - end).abs() <= SHORT_STRIP * pitch;
    let Some(edge) = edge.filter(|&u| inside(u) && near(u)) else { return };
    strips.retain(|s| (s.u - end).abs() > (edge - end).abs());
    let run = i64::from(end) - i64::from(edge);
    if (run.abs() as f64) < STEEPEST * f64::from(pitch) {
        return;
    }
    // Both lines reach `overlap` into the wall, so the taper ends before the line.
    let taper = end - (run * i64::from(params.overlap) / i64::from(pitch)) as Coord;
    // Behind the edge the other row's line fills the room, so the strip ends abruptly.
    let back = edge - (run.signum() * run.abs().min(i64::from(pitch / 4))) as Coord;
    let open = f64::from(pitch - params.overlap);
    let ends = [(back, 0.0), (edge, open), (taper, 0.0)];
    strips.reserve(AT_ENDS);
    strips.extend(ends.into_iter().filter(|e| inside(e.0)).map(|(u, open)| Strip { u, open }));
}

/// Beads along the middle of slivers, of which the widest place has room for `least`: extents that overlap on
/// neighbouring columns are joined.
fn slivers(thin: Vec<Extent>, least: Coord, params: &LineParams) -> Vec<Polyline> {
    let mut beads: Vec<Sliver> = Vec::new();
    let w = params.line_width;
    let thinnest = (THINNEST * f64::from(w)) as Coord;
    for extent in thin {
        let height = extent.high - extent.low;
        let room = height + w - 2 * params.overlap;
        let width = room.clamp(thinnest, (WIDEST * f64::from(w)) as Coord);
        let point = LinePoint { u: extent.u, v: extent.low + height / 2, width };
        let joins = |last: &Extent| {
            extent.u - last.u == w && extent.low <= last.high && last.low <= extent.high
        };
        let mut near = beads.iter_mut().rev().take_while(|sliver| extent.u - sliver.last.u <= w);
        match near.find(|sliver| joins(&sliver.last)) {
            Some(sliver) => {
                sliver.last = extent;
                sliver.room = sliver.room.max(room);
                sliver.bead.push(point);
            }
            None => beads.push(Sliver { last: extent, room, bead: vec![point] }),
        }
    }
    let is_kept = |sliver: &Sliver| sliver.room >= least && sliver.bead.len() >= LEAST_COLUMNS;
    beads.into_iter().filter(is_kept).map(|sliver| sliver.bead).collect()
}

/// A bead along the middle of a sliver.
struct Sliver {
    /// The extent of its last point.
    last: Extent,
    /// The width of a bead that fills its widest place.
    room: Coord,
    bead: Polyline,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fill::variable_width::{Joined, points};
    use crate::geom::{Contour, Point};
    use crate::profile;
    use crate::region::RegionParams;
    use crate::region::scan::Scan;

    /// The closed skin of a layer that is all skin, with lines along x.
    fn closed(contour: Contour) -> (Vec<Line>, Vec<Polyline>, LineParams) {
        let mut settings = profile::load(["generic-marlin"], &[]).unwrap().settings;
        settings.angle = profile::Angle::Degrees(0.0);
        let rasters = RegionParams::new(&settings).rasters;
        let along = Scan::new(std::slice::from_ref(&contour), rasters.skin(0)).inside().clone();
        let across = Scan::new(&[contour], rasters.skin(1)).inside().clone();
        let crossed = Crossed {
            skin: &along,
            fill: &along,
            columns: &across,
            fill_columns: &across,
            left_turn: true,
        };
        let params = LineParams::new(&settings);
        let (lines, slivers) = close(&crossed, 0, &params);
        (lines, slivers, params)
    }

    fn rectangle(low: (Coord, Coord), high: (Coord, Coord)) -> Contour {
        let p = |x, y| Point { x, y };
        vec![p(low.0, low.1), p(high.0, low.1), p(high.0, high.1), p(low.0, high.1)]
    }

    #[test]
    fn the_last_line_is_widened_up_to_the_edge() {
        // Rows lie at multiples of 4000, so 3000 stay open above the last one.
        let (lines, slivers, params) = closed(rectangle((-50_000, -1_000), (50_000, 43_000)));
        assert!(slivers.is_empty());
        let last = lines.iter().find(|l| l.row == 10).unwrap();
        let points = points(last, Joined::default(), &params);
        let open = 3_000 - params.overlap;
        assert_eq!(points.len(), 2, "one straight line: {points:?}");
        assert!(points.iter().all(|p| p.width == params.line_width + open), "{points:?}");
        assert!(points.iter().all(|p| p.v == 40_000 + open / 2), "{points:?}");
    }

    #[test]
    fn edges_along_a_row_leave_nothing_open() {
        for (low, high) in [(-1_000, 44_000), (-4_000, 43_000), (-4_000, 44_000)] {
            let (lines, _, params) = closed(rectangle((-50_000, low), (50_000, high)));
            let printed = |line: &Line| points(line, Joined::default(), &params)[0];
            let all: Vec<LinePoint> = lines.iter().map(printed).collect();
            let first = all.iter().map(|p| p.v - p.width / 2).min().unwrap();
            let last = all.iter().map(|p| p.v + p.width / 2).max().unwrap();
            // Lines at the edge reach into it by the overlap less than half a line.
            let beyond = params.line_width / 2 - params.overlap;
            assert!(first <= low - beyond + LEAST_STRIP, "{low} to {high}: {first}");
            assert!(last >= high + beyond - LEAST_STRIP, "{low} to {high}: {last}");
        }
    }

    #[test]
    fn lines_in_the_middle_stay_as_they_are() {
        let (lines, _, params) = closed(rectangle((-50_000, -1_000), (50_000, 43_000)));
        let middle = lines.iter().find(|l| l.row == 5).unwrap();
        let points = points(middle, Joined::default(), &params);
        assert!(points.iter().all(|p| p.width == params.line_width && p.v == 20_000));
    }

    #[test]
    fn lines_run_straight_up_to_a_slanted_wall() {
        // By so much the sides move on from row to row: 45° and steeper.
        for run in [500, 1_000, 2_500, 4_000] {
            let p = |x: Coord, row: Coord| Point { x: x + row * run, y: row * 4_000 };
            let slanted = vec![p(0, 0), p(100_000, 0), p(100_000, 20), p(0, 20)];
            let (lines, _, params) = closed(slanted);
            let inner = lines.iter().filter(|line| (2..18).contains(&line.row));
            for line in inner {
                let points = points(line, Joined::default(), &params);
                assert_eq!(points.len(), 2, "{run}: {points:?}");
                assert!(points.iter().all(|p| p.width == params.line_width), "{run}: {points:?}");
            }
        }
    }

    #[test]
    fn a_skin_between_two_rows_gets_a_bead_along_its_middle() {
        let (lines, slivers, params) = closed(rectangle((-50_000, 500), (50_000, 3_500)));
        assert!(lines.is_empty());
        assert_eq!(slivers.len(), 1);
        let width = 3_000 + params.line_width - 2 * params.overlap;
        assert!(slivers[0].iter().all(|p| p.v == 2_000 && p.width == width), "{slivers:?}");
        let length = slivers[0].last().unwrap().u - slivers[0][0].u;
        assert!(length > 100_000 - 2 * params.line_width, "{length}");
    }
}
