//! Layers, from the top down -> Columns: where support stands on each layer.
//!
//! With the overhang `O(k)` of layer `k`, grown by the outset, the contours `L(k)` and the support
//! `S(k)`: `S(k) = (O(k+1+gap) ∪ S(k+1)) − outset(L(k), clearance)`, less the layers within the gap,
//! those below with their clearance as well, and less what carries nothing any more ([`mod@super::posts`]).
//! So support goes down until it reaches the bed or the part. A window keeps only the layers within
//! the gap, and those further down over which the slope of the next one is judged.
//!
//! Two versions go down side by side: the *reach*, which is this alone, and the support itself, in
//! which thin posts grow ([`mod@super::posts`]). Where the reach ends on a layer it carries an
//! overhang; where a grown post ends it carries nothing.

use super::held::to_lines;
use super::overhangs::{LayerView, Overhang, overhang};
use super::params::{LEAN, SupportParams};
use super::posts::Posts;
use crate::geom::spans::{Rows, Span, subtract};
use crate::slice::Heights;
use crate::units::Coord;
use std::collections::VecDeque;

/// The support of one layer.
#[derive(Debug, Clone, Default)]
pub(super) struct Column {
    /// Where support stands.
    pub(super) all: Rows,
    /// Where it stands, without what thin posts have grown.
    pub(super) reach: Rows,
    /// Where it stands on the part.
    pub(super) foot: Rows,
    /// What hangs above and is to be carried from here on down.
    pub(super) hangs: Rows,
    /// What may be added to the body of support, so that lines hold all of it.
    pub(super) beside: Rows,
}

/// The layers around the one whose support is computed, from the top down.
pub(super) struct Window<'a> {
    params: &'a SupportParams,
    heights: &'a Heights,
    /// Those that are still to enter it, highest first.
    coming: VecDeque<LayerView>,
    /// Highest first.
    layers: VecDeque<LayerView>,
    /// Overhangs that wait for the layer where their support begins, highest first.
    overhangs: VecDeque<Overhang>,
    /// The reach of the layer above.
    reach: Rows,
    /// The support of the layer above.
    posts: Posts,
    /// Number of layers in the window that are done.
    done: usize,
}

impl<'a> Window<'a> {
    /// A window at the top.
    pub(super) fn new(params: &'a SupportParams, heights: &'a Heights) -> Self {
        Self {
            params,
            heights,
            coming: VecDeque::new(),
            layers: VecDeque::new(),
            overhangs: VecDeque::new(),
            reach: Rows::default(),
            posts: Posts::default(),
            done: 0,
        }
    }

    /// Takes the next layer down. Its support is computed when those below it are known.
    pub(super) fn push(&mut self, layer: LayerView, out: &mut [Column]) {
        self.coming.push_back(layer);
        if self.coming.len() >= self.params.slope_layers {
            self.enter(out);
        }
    }

    /// Lets the next layer enter and computes the support of the one `gap` layers above it.
    fn enter(&mut self, out: &mut [Column]) {
        let gap = self.params.gap;
        let Some(layer) = self.coming.pop_front() else { return };
        if let Some(over) = self.layers.back() {
            // Next to the bed slopes are lower, and their layers are judged one by one.
            let far = self.params.slope_layers.checked_sub(2).and_then(|k| self.coming.get(k));
            self.overhangs.push_back(overhang(over, (&layer, far), self.params));
        }
        self.layers.push_back(layer);
        if self.layers.len() > gap {
            self.support(self.layers.len() - 1 - gap, out);
        }
        // A layer is needed until the one `gap` below it is done.
        if self.layers.len() > 2 * gap + 1 {
            self.layers.pop_front();
            self.done -= 1;
        }
    }

    /// Computes the support of the lowest layers, which have fewer than `gap` below them.
    pub(super) fn flush(&mut self, out: &mut [Column]) {
        while !self.coming.is_empty() {
            self.enter(out);
        }
        while self.done < self.layers.len() {
            self.support(self.done, out);
        }
    }

    /// Computes the support of the layer at index `at` of the window.
    fn support(&mut self, at: usize, out: &mut [Column]) {
        let (params, gap) = (self.params, self.params.gap);
        let layer = &self.layers[at];
        let k = layer.index;
        // Support of the overhang of layer k + 1 + gap begins at layer k.
        let begins = self.overhangs.front().is_some_and(|o| o.layer > k + gap);
        let new = if begins { self.overhangs.pop_front() } else { None };
        let new = new.unwrap_or_default();
        let around = at.saturating_sub(gap)..(at + gap + 1).min(self.layers.len());
        // Beside the edge of a floor support would lie on nothing.
        let near = |n: usize| if n > at { &self.layers[n].near } else { &self.layers[n].inside };
        let others: Vec<&Rows> = around.filter(|&n| n != at).map(near).collect();
        // What begins in the air within the gap above the bed is carried without a gap: it would
        // have nothing below it otherwise.
        let low = self.overhangs.iter().find(|o| o.layer == k + 1 && k < gap);
        let low = low.map(|overhang| overhang.islands.minus(&layer.near)).unwrap_or_default();
        let cut = |rows: Rows| {
            let rows = join_gaps(&rows.minus(&layer.near), layer, params.least);
            others.iter().fold(rows, |rows, other| rows.minus(other)).or(&low)
        };
        self.reach = cut(self.reach.or(&new.all));
        let wanted = cut(self.posts.rows().or(&new.all));
        let floors = self.layers.range(at..(at + gap + 1).min(self.layers.len()));
        let ends = self.posts.rows().minus(&wanted);
        // What stands on the part is cut off later where only the bed may carry.
        let foot = if params.bed_only {
            Rows::default()
        } else {
            foot(&ends, floors.map(|floor| &floor.inside), params)
        };
        let (hangs, z) = (new.hangs.or(&low), self.heights.top(k));
        let idle = self.posts.next(&wanted, [&hangs, &foot], z, params, cut);
        if let Some(above) = out.get_mut(k + 1) {
            above.foot = foot;
        }
        self.reach = self.reach.minus(&idle);
        let all = self.posts.rows().clone();
        let beside = to_lines(&params.lines, &all).minus(&all);
        let beside = if beside.is_empty() { beside } else { cut(beside).minus(&all) };
        out[k] = Column { all, reach: self.reach.clone(), hangs, beside, ..Column::default() };
        self.done = at + 1;
    }
}

/// What of `ends`, where support ends downwards, stands on `floors`, or reaches a little beyond them.
fn foot<'a>(ends: &Rows, floors: impl Iterator<Item = &'a Rows>, params: &SupportParams) -> Rows {
    if ends.is_empty() {
        return Rows::default();
    }
    let (lean, pitch) = (LEAN * params.least, params.raster().pitch);
    let around = ends.dilate(lean, pitch);
    let floor = floors.fold(Rows::default(), |all, floor| all.or(&floor.and(&around)));
    floor.dilate(lean, pitch).and(ends)
}

/// Joins support on both sides of a gap that is at most two lines wide and free of the part. Such
/// a gap is left over from something above and only costs travels.
fn join_gaps(rows: &Rows, layer: &LayerView, line_width: Coord) -> Rows {
    let mut out = Rows::starting_at(rows.range().start);
    let mut free = Vec::new();
    for (j, row) in rows.iter() {
        out.push_row(|spans| {
            let base = spans.len();
            for &span in row {
                let gap = spans[base..].last().and_then(|last| Span::new(last.end, span.start));
                free.clear();
                subtract(gap.as_slice(), layer.near.row(j), &mut free);
                let narrow = gap.is_none_or(|gap| gap.len() <= 2 * i64::from(line_width));
                match spans[base..].last_mut() {
                    Some(last) if narrow && free == gap.as_slice() => last.end = span.end,
                    _ => spans.push(span),
                }
            }
        });
    }
    out
}
