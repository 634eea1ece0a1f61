//! Skin rows of two crossing rasters -> Lines: skin closed up to the walls, slivers included.
//!
//! Words: a *line* is what is printed of a row's span; a *column* is a line of
//! the raster across. Lines lie on a fixed grid, so where an edge of the skin
//! runs nearly along them, a strip up to one line width wide stays open between
//! the edge and the last line, and a skin narrower than a line may fall between
//! two. The columns tell how wide the strip is, exactly: they hold the skin's
//! extent across the lines, and they were made for the neighbours anyway. The
//! last line is moved and widened to fill the strip; a skin without a line gets
//! a bead along its middle. Strips shorter than the columns' distance lie where a
//! line ends before its neighbour does, and are known from these two ends. Only edges at a wall are closed: an edge at the
//! infill has more skin around it than it needs.

use super::variable_width::{Line, LineParams, SHORT_STRIP, Strip, WIDEST};
use crate::geom::polyline::{LinePoint, Polyline};
use crate::geom::spans::Span;
use crate::region::crossed::Crossed;
use crate::units::Coord;

/// Strips narrower than this stay open (20 µm): half of what positioning can tell.
const LEAST_STRIP: Coord = 200;

/// Beads along thin strips that fewer columns in a row tell of are left out.
const LEAST_COLUMNS: usize = 2;

/// Strips that are added at the ends of a line, at most.
const AT_ENDS: usize = 6;

/// The lines of a skin, and the beads along strips too thin for a line.
#[must_use]
pub fn close(crossed: &Crossed<'_>, params: &LineParams) -> (Vec<Line>, Vec<Polyline>) {
    // Without a wall there is nothing to close up to, only an outside to stay within.
    let walled = params.walled;
    let mut strips = Strips::new(crossed.skin.range(), params);
    let mut thin = Vec::new();
    for extent in extents(crossed, params) {
        if !strips.add(&extent, params) && (extent.wall_low || extent.wall_high) {
            thin.push(extent);
        }
    }
    let mut lines = Vec::new();
    for (row, spans) in crossed.skin.iter() {
        for &span in spans {
            let mut line = Line { row, span, above: Vec::new(), below: Vec::new() };
            if walled {
                (line.above, line.below) = strips.beside(row, span);
                add_ends(&mut line.above, span, crossed, (row, row + 1), params);
                add_ends(&mut line.below, span, crossed, (row, row - 1), params);
            }
            lines.push(line);
        }
    }
    (lines, slivers(thin, params))
}

/// The skin's extent across the lines at one column, and which of its ends are at a wall.
#[derive(Debug, Clone, Copy)]
struct Extent {
    u: Coord,
    low: Coord,
    high: Coord,
    wall_low: bool,
    wall_high: bool,
}

/// The extents of all columns, in the order of u.
fn extents(crossed: &Crossed<'_>, params: &LineParams) -> Vec<Extent> {
    let mut out = Vec::new();
    for (c, spans) in crossed.columns.iter() {
        let walls = crossed.fill_columns.row(c);
        for &span in spans {
            let at_start = walls.iter().any(|w| w.start == span.start);
            let at_end = walls.iter().any(|w| w.end == span.end);
            let at = c * params.line_width;
            // In the frame across, u is −v of ours (turned left) or v is −u of ours.
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

/// The strips beside the lines of each row, in the order of u.
struct Strips {
    first: i32,
    above: Vec<Vec<Strip>>,
    below: Vec<Vec<Strip>>,
    pitch: Coord,
}

impl Strips {
    fn new(range: std::ops::Range<i32>, params: &LineParams) -> Self {
        let empty = vec![Vec::new(); range.len()];
        Self { first: range.start, above: empty.clone(), below: empty, pitch: params.line_width }
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

    fn index(&self, row: i32) -> Option<usize> {
        usize::try_from(row - self.first).ok().filter(|&k| k < self.above.len())
    }

    /// Notes the strips above the highest and below the lowest line within `extent`;
    /// says no if there is no line in it.
    fn add(&mut self, extent: &Extent, params: &LineParams) -> bool {
        let highest = extent.high.div_euclid(self.pitch);
        let lowest = -(-extent.low).div_euclid(self.pitch);
        if lowest > highest {
            return false;
        }
        // Lines reach `overlap` beyond the extent's ends already.
        let above = extent.high - highest * self.pitch - params.overlap;
        let below = lowest * self.pitch - extent.low - params.overlap;
        let strip = |open: Coord| Strip { u: extent.u, open: f64::from(open) };
        if let Some(k) = self.index(highest).filter(|_| extent.wall_high && above > LEAST_STRIP) {
            self.above[k].push(strip(above));
        }
        if let Some(k) = self.index(lowest).filter(|_| extent.wall_low && below > LEAST_STRIP) {
            self.below[k].push(strip(below));
        }
        true
    }
}

/// Adds to the strips between a line of `row` and row `other` those at the ends of
/// the line: where the edge at a wall crosses row `other` a little earlier, the strip
/// is a whole pitch wide, and from there it tapers off towards the line's end.
fn add_ends(
    strips: &mut Vec<Strip>,
    span: Span,
    crossed: &Crossed<'_>,
    (row, other): (i32, i32),
    params: &LineParams,
) {
    let (walls, others) = (crossed.fill.row(row), crossed.fill.row(other));
    let beside = |u: Coord| others.iter().any(|o| o.start <= u && u <= o.end);
    if walls.iter().any(|w| w.end == span.end) && !beside(span.end) {
        let edge = others.iter().map(|o| o.end).filter(|&u| u < span.end).max();
        add_end(strips, span, (edge, span.end), params);
    }
    if walls.iter().any(|w| w.start == span.start) && !beside(span.start) {
        let edge = others.iter().map(|o| o.start).filter(|&u| u > span.start).min();
        add_end(strips, span, (edge, span.start), params);
    }
    strips.sort_by_key(|s| s.u);
    strips.dedup_by_key(|s| s.u);
}

/// Adds the strip between `edge`, where the other row ends, and the line's own `end`,
/// if it is short, in place of what columns tell of it.
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
    // Both lines reach `overlap` into the wall: the taper ends before the line does.
    let taper = end - (run * i64::from(params.overlap) / i64::from(pitch)) as Coord;
    // The other row's line begins here, so the strip ends at once.
    let back = edge - (run.signum() as Coord) * pitch / 4;
    let open = f64::from(pitch - params.overlap);
    let ends = [(back, 0.0), (edge, open), (taper, 0.0)];
    strips.reserve(AT_ENDS);
    strips.extend(ends.into_iter().filter(|e| inside(e.0)).map(|(u, open)| Strip { u, open }));
}

/// Beads along the middle of extents that no line reaches, joined from column to column.
fn slivers(thin: Vec<Extent>, params: &LineParams) -> Vec<Polyline> {
    let mut beads: Vec<(Extent, Polyline)> = Vec::new();
    let w = params.line_width;
    for extent in thin {
        let height = extent.high - extent.low;
        let width =
            (height + w - 2 * params.overlap).clamp(w / 2, (WIDEST * f64::from(w)) as Coord);
        let point = LinePoint { u: extent.u, v: extent.low + height / 2, width };
        let joins = |last: &Extent| {
            extent.u - last.u == w && extent.low <= last.high && last.low <= extent.high
        };
        match beads
            .iter_mut()
            .rev()
            .take_while(|(e, _)| extent.u - e.u <= w)
            .find(|(e, _)| joins(e))
        {
            Some((last, bead)) => {
                *last = extent;
                bead.push(point);
            }
            None => beads.push((extent, vec![point])),
        }
    }
    beads.into_iter().map(|(_, bead)| bead).filter(|bead| bead.len() >= LEAST_COLUMNS).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fill::variable_width::{Joined, points};
    use crate::geom::{Contour, Point};
    use crate::profile;
    use crate::region::RegionParams;
    use crate::region::scan::Scan;

    /// Closes a skin that is all of `contour`, lines along x.
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
        let (lines, slivers) = close(&crossed, &params);
        (lines, slivers, params)
    }

    fn rectangle(low: (Coord, Coord), high: (Coord, Coord)) -> Contour {
        let p = |x, y| Point { x, y };
        vec![p(low.0, low.1), p(high.0, low.1), p(high.0, high.1), p(low.0, high.1)]
    }

    #[test]
    fn the_last_line_is_widened_up_to_the_edge() {
        // Rows lie at multiples of 4000: 3000 are left above the last one.
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
    fn lines_in_the_middle_stay_as_they_are() {
        let (lines, _, params) = closed(rectangle((-50_000, -1_000), (50_000, 43_000)));
        let middle = lines.iter().find(|l| l.row == 5).unwrap();
        let points = points(middle, Joined::default(), &params);
        assert!(points.iter().all(|p| p.width == params.line_width && p.v == 20_000));
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
