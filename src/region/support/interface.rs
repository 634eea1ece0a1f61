//! Columns -> Layers: which places of support are dense, and on which raster their lines run.
//!
//! Words: the *interface* is the dense support next to the part: so many layers at its top, and as
//! many where it stands on the part. Its *rank* is counted from the part. *Along* is the direction of
//! the support's own lines, *across* the other one.
//!
//! The layer of the interface furthest from the part runs across the lines below it (or above it),
//! which are far apart. From there to the part the direction changes from layer to layer.
//!
//! On slopes the top of support is a flight of narrow steps, each with lines too short to hold. So
//! each is grown by a line's width, within the support.

use super::columns::Column;
use super::outline::outlines;
use super::params::{SupportLayer, SupportParams};
use super::pieces::erode;
use crate::geom::Contour;
use crate::geom::spans::{Rows, Span};
use crate::units::Coord;

/// The ends of support lines lie this far inside the outline, in hundredths of a line's width: their
/// round ends just reach into it. More leaves a gap, less piles up plastic there.
const LINES_FROM_OUTLINE: Coord = 60;

/// The support of layer `k`, divided.
pub(super) fn divide(columns: &[Column], k: usize, params: &SupportParams) -> SupportLayer {
    let here = &columns[k].all;
    if here.is_empty() {
        return SupportLayer::default();
    }
    if k == 0 && params.brim > 0 {
        let interface = [Rows::default(), params.across(here)];
        return SupportLayer { interface, ..SupportLayer::default() };
    }
    let [across, along] = interface(columns, k, params);
    let along = along.minus(&across);
    let body = here.minus(&across).minus(&along);
    let (outlines, body) = params.outline(body);
    SupportLayer { body, outlines, interface: [params.along(&along), params.across(&across)] }
}

/// The interface of layer `k` with lines across and along those of the support.
fn interface(columns: &[Column], k: usize, params: &SupportParams) -> [Rows; 2] {
    let mut out = [Rows::default(), Rows::default()];
    let n = params.interface_layers;
    let (none, pitch) = (Rows::default(), params.raster().pitch);
    let reach = |k: usize| columns.get(k).map_or(&none, |column| &column.reach);
    let all = |k: usize| &columns[k].all;
    for rank in 1..=n {
        let top = reach(k + rank - 1).minus(reach(k + rank));
        let bottom =
            if rank <= k { all(k + 1 - rank).minus(all(k - rank)) } else { Rows::default() };
        let ends = top.or(&bottom);
        if ends.is_empty() {
            continue;
        }
        let wide = ends.dilate(params.least, pitch).and(all(k));
        let out = &mut out[(n - rank) % 2];
        *out = out.or(&wide);
    }
    out
}

impl SupportParams {
    /// The area of support lines, and its outlines if it gets any.
    fn outline(&self, rows: Rows) -> (Vec<Contour>, Rows) {
        if !self.has_outline {
            return (Vec::new(), rows);
        }
        let raster = self.raster();
        let outlines = outlines(&rows, raster.pitch, raster.frame, 4 * self.least);
        (outlines, erode(&rows, self.least * LINES_FROM_OUTLINE / 100, raster.pitch))
    }

    /// `rows` on the interface's raster in the same direction.
    fn along(&self, rows: &Rows) -> Rows {
        let (from, to) = (self.raster().pitch, self.interface_pitch);
        let range = rows.range();
        if rows.is_empty() {
            return Rows::default();
        }
        let first = (range.start * from).div_euclid(to);
        let mut out = Rows::starting_at(first);
        for j in first..=(range.end * from).div_euclid(to) {
            let nearest = (2 * j * to + from).div_euclid(2 * from);
            out.push_row(|spans| spans.extend_from_slice(rows.row(nearest)));
        }
        out
    }

    /// `rows` on the interface's raster across, whose row `m` lies at `u = −m · pitch`.
    fn across(&self, rows: &Rows) -> Rows {
        let (pitch, to) = (self.raster().pitch, self.interface_pitch);
        let spans = || rows.iter().flat_map(|(_, row)| row);
        let (Some(low), Some(high)) =
            (spans().map(|s| s.start).min(), spans().map(|s| s.end).max())
        else {
            return Rows::default();
        };
        // Rows of the new raster that a stretch of u crosses.
        let crossed = |s: &Span| (-s.end).div_euclid(to) + 1..(-s.start).div_euclid(to) + 1;
        let all = crossed(&Span { start: low, end: high });
        let mut columns: Vec<Vec<Span>> = vec![Vec::new(); all.len()];
        for (j, row) in rows.iter() {
            for m in row.iter().flat_map(crossed) {
                let column = &mut columns[(m - all.start) as usize];
                match column.last_mut() {
                    Some(last) if last.end == (j - 1) * pitch => last.end = j * pitch,
                    _ => column.push(Span { start: j * pitch, end: j * pitch }),
                }
            }
        }
        let mut out = Rows::starting_at(all.start);
        for column in columns {
            out.push_row(|out| out.extend(column.into_iter().filter(|s| s.start < s.end)));
        }
        out
    }
}
