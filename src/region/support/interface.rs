//! Columns -> Layers: which places of support are dense, and on which raster their lines run.
//!
//! Words: the *interface* is the dense support next to the part: so many layers at its top, and as
//! many where it stands on the part. Its *rank* is counted from the part. *Along* is the direction of
//! the support's own lines, *across* the other one.
//!
//! The layer of the interface furthest from the part runs across the lines below it (or above it),
//! which are far apart. From there to the part the direction changes from layer to layer. In strips the
//! lines below run across ([`mod@super::strips`]), and so the interface begins along.
//!
//! On slopes the top of support is a flight of narrow steps, each with lines too short to hold. So
//! each is grown by a line's width, within the support.

use super::body::Body;
use super::columns::Column;
use super::held::to_lines;
use super::params::{SupportLayer, SupportParams};
use super::pieces::{Pieces, across, with_lines, without_specks};
use super::stand::stand_beside;
use super::strips::strips;
use crate::geom::spans::{Rows, Span};
use rayon::prelude::*;

/// The support of a layer, divided.
#[derive(Debug, Default)]
pub(super) struct Divided {
    body: Body,
    /// Where dense lines run, by pattern.
    interface: [Rows; 2],
}

impl Divided {
    /// The lines of layer `k`.
    pub(super) fn lay(self, k: usize, params: &SupportParams) -> SupportLayer {
        let (outlines, body) = self.body.lay(k, params);
        SupportLayer { body, outlines, interface: self.interface }
    }
}

/// The support of all layers, divided.
pub(super) fn divided(mut columns: Vec<Column>, params: &SupportParams) -> Vec<Divided> {
    let strips = |column: &Column| {
        if params.has_outline { strips(&column.all, params) } else { Rows::default() }
    };
    let strips: Vec<Rows> = columns.par_iter().map(strips).collect();
    stand_beside(&mut columns, &strips, params);
    let divide = |k| divide((&columns, &strips), k, params);
    let mut layers: Vec<Divided> = (0..columns.len()).into_par_iter().map(divide).collect();
    // What gets an outline on a layer, and would have nothing below it, gets one on those below.
    for k in (1..layers.len()).rev() {
        if let [below, here] = &mut layers[k - 1..=k] {
            below.body.carry(&here.body, params);
        }
    }
    layers
}

/// The support of layer `k`, divided.
fn divide(all: (&[Column], &[Rows]), k: usize, params: &SupportParams) -> Divided {
    let (columns, strips) = (all.0, &all.1[k]);
    let here = &columns[k].all;
    if here.is_empty() {
        return Divided::default();
    }
    if k == 0 && params.brim > 0 {
        let interface = [Rows::default(), params.across(here)];
        return Divided { interface, ..Divided::default() };
    }
    let pitch = params.raster().pitch;
    let [across, along] = interface(all, k, params);
    let mut parts = [along.minus(&across), across];
    // Where the two meet, their outermost lines lie beside each other.
    let mut dense = parts[0].or(&parts[1]).dilate(params.least, pitch);
    let rests = rests(&here.minus(&dense), strips, params);
    if !dense.is_empty() && !rests.is_empty() {
        let rests = rests.dilate(params.least + pitch, pitch).and(here);
        parts[1] = with_lines(&parts[1], &rests);
        parts[0] = with_lines(&parts[0], &rests).minus(&parts[1]);
        dense = parts[0].or(&parts[1]).dilate(params.least, pitch);
    }
    let [along, across] = parts;
    let body = with_lines(&here.minus(&dense), &columns[k].beside.minus(&dense));
    let carries = ends(columns, k + params.interface_layers);
    Divided {
        body: Body::new(body, strips.clone(), carries, params),
        interface: [params.along(&along), params.across(&across)],
    }
}

/// The pieces of a body without a line of their own. Beside the interface they belong to it: its lines
/// reach that far, and an outline of theirs would have nothing below it.
fn rests(body: &Rows, strips: &Rows, params: &SupportParams) -> Rows {
    let prints =
        |j: i32, span: Span| params.lines.prints(j) && span.len() >= i64::from(params.least);
    let pieces = Pieces::new(body);
    let mut has_line = vec![false; pieces.count()];
    // Lines across a strip are too short to hold where little of it is left.
    let strips = body.and(strips).erode(2 * params.least, params.raster().pitch);
    let lines = body.filter(prints).or(&strips);
    pieces.meeting(body, &lines, |piece, _| has_line[piece] = true);
    pieces.keep(body, |piece| !has_line[piece])
}

/// Where support of layer `k` ends below the part.
fn ends(columns: &[Column], k: usize) -> Rows {
    let Some(here) = columns.get(k) else { return Rows::default() };
    columns.get(k + 1).map_or_else(|| here.reach.clone(), |above| here.reach.minus(&above.reach))
}

/// The interface of layer `k` with lines across and along those of the support. Next to strips they
/// are exchanged.
fn interface(
    (columns, strips): (&[Column], &[Rows]),
    k: usize,
    params: &SupportParams,
) -> [Rows; 2] {
    let mut out = [Rows::default(), Rows::default()];
    let n = params.interface_layers;
    let (none, pitch) = (Rows::default(), params.raster().pitch);
    let all = |k: usize| &columns[k].all;
    // On a slope of the part support ends by less than a line on each layer: dense lines would
    // stand alone there. What is added beside the body begins there, too.
    let bottom = |k: usize| {
        let ends = all(k).minus(all(k - 1));
        let ends = ends.erode(params.least / 2, pitch).dilate(params.least / 2, pitch);
        with_lines(&ends, &columns[k].beside.minus(&columns[k - 1].beside).minus(all(k - 1)))
    };
    let own = all(k).or(&columns[k].beside);
    for rank in 1..=n {
        let bottom = if rank <= k { bottom(k + 1 - rank) } else { Rows::default() };
        let first = n - rank;
        let mut top = self::ends(columns, k + rank - 1);
        if let Some(below) = columns[..k].last().filter(|_| first == 0 && !top.is_empty()) {
            top = top.or(&onto_lines(&top.dilate(params.least, pitch).and(&own), below, params));
        }
        // The body that a stack lies on, or that stands on it, is next to the layer of the highest rank.
        let next = [k.checked_sub(first + 1), Some(k + first + 1)];
        for (ends, next) in [top, bottom].into_iter().zip(next) {
            if ends.is_empty() {
                continue;
            }
            let wide = ends.dilate(params.least, pitch).and(&own);
            let next = next.and_then(|k| strips.get(k)).unwrap_or(&none);
            for (turn, rows) in [(first % 2, wide.minus(next)), (1 - first % 2, wide.and(next))] {
                out[turn] = out[turn].or(&rows);
            }
        }
    }
    out.map(|rows| without_specks(&rows, params))
}

/// What must be added to dense `rows` between two lines of the layer below, so that they lie on one.
fn onto_lines(rows: &Rows, below: &Column, params: &SupportParams) -> Rows {
    let more = to_lines(&params.lines, rows);
    if more.is_empty() { more } else { more.and(&below.all.or(&below.beside)) }
}

impl SupportParams {
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

    /// `rows` on the interface's raster across.
    fn across(&self, rows: &Rows) -> Rows {
        across(rows, self.raster().pitch, self.interface_pitch)
    }
}
