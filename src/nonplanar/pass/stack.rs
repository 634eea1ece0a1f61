//! Layers -> Stack: what stands at a moment of the print, layer by layer from below.
//!
//! Words: a *section* is a layer's inside, on cells. A *cut* is the room of a patch's skins in the
//! sections that it reaches into: there the base ends, or nothing stands until the skins lie.
//!
//! - Layers are sliced block by block, as they are asked for, and forgotten once they are piled up.
//! - They are piled up from the highest down: a layer raises only cells that none above it covers.
//!   Most layers cover what those below them do.
//! - What a patch leaves to be printed flat is raised as a whole, see [`Stack::raise`].

use super::touch::mm;
use crate::geom::spans::{Rows, Span, merge};
use crate::geom::{Contour, Point};
use crate::head::pile::Pile;
use crate::nonplanar::field::Field;
use crate::nonplanar::grid::{self, CELL, Spot, cells, columns, middle, raster};
use crate::nonplanar::scene::Scene;
use crate::region::scan::around;
use crate::slice::{Heights, Layer};
use crate::units::{Coord, to_mm};
use rayon::prelude::*;
use std::collections::VecDeque;
use std::ops::Range;

/// A layer's section ends where its middle meets the surface. What of it stands higher above the surface
/// than this share of a layer is something else: another shell, or a roof.
const ABOVE: f64 = 0.5;

/// Up to so many layers above the surface there must be nothing of it.
const FREE: f64 = 1.5;

/// Beads may reach so much further out than sections, mm: thin walls are as wide as the nozzle lays them, and
/// corners are rounded.
pub(super) const WIDER: f64 = 0.1;

/// The inside of a layer.
#[derive(Debug, Clone, Default)]
pub(super) struct Section {
    /// The part, without anything taken from it.
    pub solid: Rows,
    /// Support.
    pub support: Rows,
}

/// The room of a piece's skins.
#[derive(Debug, Default)]
pub(super) struct Cut {
    first: usize,
    layers: Vec<Rows>,
}

/// What stands.
pub(super) struct Stack<'a> {
    scene: &'a Scene<'a>,
    /// How high it stands.
    pub pile: Pile,
    /// The first cell of the pile.
    low: Spot,
    /// Sections from layer `next` on.
    sections: VecDeque<Section>,
    /// The first layer that is not piled up yet.
    next: usize,
    /// The cuts, by the numbers of pieces.
    pub cuts: Vec<Cut>,
    /// Where support stands or stood.
    supported: Rows,
    /// Where a skirt may stand that is not piled up yet.
    skirt: Option<Rows>,
}

impl<'a> Stack<'a> {
    /// Nothing stands yet; layers below `first` do not matter. The pile covers the cells of `columns` and
    /// `rows`.
    pub(super) fn new(
        scene: &'a Scene<'a>,
        first: usize,
        (columns, rows): (Range<i32>, Range<i32>),
    ) -> Self {
        let corner = |cell: Spot| middle(cell).map(|v| v - to_mm(CELL) / 2.0);
        let low = [columns.start, rows.start];
        let pile =
            Pile::new(corner(low), corner([columns.end, rows.end]), to_mm(CELL)).wider(WIDER);
        let (sections, supported) = (VecDeque::new(), Rows::default());
        let skirt = scene.skirt.map(|skirt| {
            let [x0, x1] = [columns.start, columns.end].map(|v| v * CELL);
            let [y0, y1] = [rows.start, rows.end].map(|v| v * CELL);
            let all = [(x0, y0), (x1, y0), (x1, y1), (x0, y1)].map(|(x, y)| Point { x, y });
            cells(&grid::without(&[all.to_vec()], &skirt.inside))
        });
        Self { scene, pile, low, sections, next: first, cuts: Vec::new(), supported, skirt }
    }

    /// The section of a layer that is not piled up; nothing above the last one.
    pub(super) fn section(&mut self, k: usize) -> Option<&Section> {
        let slicer = self.scene.slicer;
        let at = k.checked_sub(self.next)?;
        while self.sections.len() <= at {
            let wanted = self.next + self.sections.len();
            if wanted >= slicer.heights().count() {
                return None;
            }
            let layers = slicer.block(slicer.block_of(wanted));
            let made: Vec<Section> =
                layers.par_iter().filter(|l| l.index >= wanted).map(|l| self.cross(l)).collect();
            if made.is_empty() {
                return None;
            }
            self.sections.extend(made);
        }
        self.sections.get(at)
    }

    fn cross(&self, layer: &Layer) -> Section {
        let lines = self.scene.support.map(|props| ((props.lines)(layer.index), props.width / 2));
        let support = lines.map(|(lines, radius)| {
            let edges: Vec<_> = lines.into_iter().map(|[a, b]| (a, b, radius)).collect();
            around(&edges, raster(CELL))
        });
        let solid = cells(&layer.contours);
        let beyond = self.scene.params.beyond;
        let solid = if beyond > 0 { solid.dilate(beyond, CELL) } else { solid };
        Section { solid, support: support.unwrap_or_default() }
    }

    /// Piles up all layers up to `k`.
    pub(super) fn raise_to(&mut self, k: usize) {
        self.raise_skirt(k);
        // What is sliced in one go is piled up in one go.
        while self.next <= k && self.section(self.next).is_some() {
            let count = self.sections.len().min(k + 1 - self.next);
            self.raise_some(count);
        }
    }

    /// Piles the skirt up to layer `k`.
    fn raise_skirt(&mut self, k: usize) {
        let Some((rows, skirt)) = self.skirt.take().zip(self.scene.skirt) else { return };
        let top = self.scene.slicer.heights().top(k);
        for (j, row) in rows.iter() {
            self.raise_row(j, row, to_mm(top.min(skirt.top)));
        }
        self.skirt = Some(rows).filter(|_| top < skirt.top);
    }

    /// Piles up the first sections.
    fn raise_some(&mut self, count: usize) {
        let heights = self.scene.slicer.heights();
        let mut covered = Rows::default();
        let sections: Vec<Section> = self.sections.drain(..count).collect();
        for (by, section) in sections.iter().enumerate().rev() {
            let k = self.next + by;
            let all = self.standing(k, section);
            let new = if covered.is_empty() { all.clone() } else { all.minus(&covered) };
            for (j, row) in new.iter() {
                self.raise_row(j, row, to_mm(heights.top(k)));
            }
            covered = covered.or(&all);
            if !section.support.is_empty() {
                self.supported = self.supported.or(&section.support);
            }
        }
        self.next += count;
    }

    /// What of a section is printed flat: the part without the room of skins, and support.
    pub(super) fn standing(&self, k: usize, section: &Section) -> Rows {
        let rows = self.cuts.iter().filter_map(|cut| cut.layers.get(k.checked_sub(cut.first)?));
        let rows: Vec<&Rows> = rows.filter(|rows| !rows.is_empty()).collect();
        let cut = Rows::united(&rows);
        let solid = if cut.is_empty() { section.solid.clone() } else { section.solid.minus(&cut) };
        if section.support.is_empty() { solid } else { solid.or(&section.support) }
    }

    fn raise_row(&mut self, j: i32, row: &[Span], z: f64) {
        let Ok(line) = usize::try_from(j - self.low[1]) else { return };
        for &span in row {
            let at = |column: i32| usize::try_from(column - self.low[0]).unwrap_or(0);
            let columns = columns(span, CELL);
            self.pile.raise_row(line, at(columns.start)..at(columns.end), z);
        }
    }

    /// A cell stands at least so high, mm. Whether it rose.
    pub(super) fn raise(&mut self, [x, y]: Spot, z: f64) -> bool {
        let at = (usize::try_from(x - self.low[0]), usize::try_from(y - self.low[1]));
        let (Ok(x), Ok(y)) = at else { return false };
        let before = self.pile.height([x, y]);
        self.pile.raise([x, y], z);
        self.pile.height([x, y]) > before
    }

    /// What stands at some cells alone, if any; as near to a head as it is among all, to the last digit.
    pub(super) fn alone(&self, cells: &[Spot]) -> Option<Pile> {
        let mut pile = (!cells.is_empty()).then(|| self.pile.emptied())?;
        for &[x, y] in cells {
            let at = (usize::try_from(x - self.low[0]), usize::try_from(y - self.low[1]));
            if let (Ok(column), Ok(row)) = at {
                pile.raise([column, row], self.pile.height([column, row]));
            }
        }
        Some(pile)
    }

    /// The cells of an area stand at least as high as a surface over them.
    pub(super) fn raise_over(&mut self, field: &Field, rows: &Rows) {
        for (j, row) in rows.iter() {
            for &span in row {
                let columns = columns(span, CELL);
                let at = (columns.start - self.low[0], j - self.low[1]);
                if let (Ok(x), Ok(y)) = (usize::try_from(at.0), usize::try_from(at.1)) {
                    let z = |column: i32| field.at([column, j]).map_or(f64::NAN, mm);
                    self.pile.raise_cells([x, y], columns.map(z));
                }
            }
        }
    }

    /// How high a cell stands, mm.
    pub(super) fn height(&self, [x, y]: Spot) -> f64 {
        match (usize::try_from(x - self.low[0]), usize::try_from(y - self.low[1])) {
            (Ok(x), Ok(y)) => self.pile.height([x, y]),
            _ => f64::NEG_INFINITY,
        }
    }

    /// Whether support stands or stood at a cell.
    pub(super) fn is_supported(&self, [x, y]: Spot) -> bool {
        let spans = self.supported.row(y);
        spans.iter().any(|span| span.start <= x * CELL && x * CELL < span.end)
    }
}

impl Cut {
    /// The room of skins of this depth over an area, in the layers from `from` on.
    pub(super) fn new(
        field: &Field,
        area: &[Contour],
        heights: &Heights,
        (depth, height): (Coord, Coord),
        from: usize,
    ) -> Self {
        // The base ends where a part lowered by the skins would; see `base`.
        let mut lower = Planes::new(heights, -f64::from(depth));
        let mut upper = Planes::new(heights, ABOVE * f64::from(height));
        let mut reach = |z: f64| -> Range<usize> {
            let (first, last) = (lower.up_to(z).max(from), upper.up_to(z));
            first..last.max(first)
        };
        let rows = cells(area);
        let mut stretches: Vec<(i32, Range<usize>, Span)> = Vec::new();
        for (j, row) in rows.iter() {
            for column in row.iter().flat_map(|&span| columns(span, CELL)) {
                let Some(z) = field.at([column, j]) else { continue };
                let (layers, start) = (reach(z), column * CELL - CELL / 2);
                match stretches.last_mut() {
                    Some((row, same, span))
                        if *row == j && *same == layers && span.end == start =>
                    {
                        span.end += CELL;
                    }
                    _ => stretches.push((j, layers, Span { start, end: start + CELL })),
                }
            }
        }
        let used = || stretches.iter().filter(|(_, layers, _)| !layers.is_empty());
        let first = used().map(|(_, layers, _)| layers.start).min().unwrap_or(from);
        let last = used().map(|(_, layers, _)| layers.end).max().unwrap_or(first);
        let mut layers = vec![Rows::starting_at(rows.range().start); last - first];
        let mut row: Vec<Vec<Span>> = vec![Vec::new(); layers.len()];
        let mut at = stretches.into_iter().peekable();
        for j in rows.range() {
            while let Some((_, reached, span)) = at.next_if(|(row, ..)| *row == j) {
                reached.for_each(|k| row[k - first].push(span));
            }
            for (rows, spans) in layers.iter_mut().zip(&mut row) {
                rows.push_row(|out| merge(spans, out));
                spans.clear();
            }
        }
        Self { first, layers }
    }
}

/// The number of planes up to a height that is so much higher than asked for. Most questions in a row have the
/// same answer.
struct Planes<'a> {
    heights: &'a Heights,
    by: f64,
    /// The last answer, and the heights that have it.
    last: (usize, Range<Coord>),
}

impl<'a> Planes<'a> {
    fn new(heights: &'a Heights, by: f64) -> Self {
        Self { heights, by, last: (0, 0..0) }
    }

    fn up_to(&mut self, z: f64) -> usize {
        let z = (z + self.by) as Coord;
        if !self.last.1.contains(&z) {
            let count = self.heights.planes_up_to(z);
            let below = count.checked_sub(1).map_or(Coord::MIN, |k| self.heights.plane(k));
            let is_last = count == self.heights.count();
            let above = if is_last { Coord::MAX } else { self.heights.plane(count) };
            self.last = (count, below..above);
        }
        self.last.0
    }
}

impl Stack<'_> {
    /// The cells of an area up to `high` over which the part goes on in layers that are not piled up yet.
    pub(super) fn beneath(&mut self, field: &Field, area: &[Contour], high: f64) -> Vec<Spot> {
        let heights = self.scene.slicer.heights();
        let h = f64::from(self.scene.params.height);
        let own = cells(area);
        let mut out = Vec::new();
        for k in self.next..heights.planes_up_to((high + FREE * h) as Coord) {
            let plane = f64::from(heights.plane(k));
            let Some(section) = self.section(k) else { break };
            // A wall beside the area may share the cells of its edge.
            let over = section.solid.and(&own).erode(CELL, CELL);
            let is_over = |cell: &Spot| {
                field.at(*cell).is_some_and(|z| (z + ABOVE * h..z + FREE * h).contains(&plane))
            };
            out.extend(grid::spots(&over, CELL).into_iter().filter(is_over));
        }
        out
    }
}

/// The cells of an area with their heights above the bed, mm.
pub(super) fn heights_over(field: &Field, rows: &Rows) -> Vec<(Spot, f64)> {
    let all = grid::spots(rows, CELL).into_iter();
    all.filter_map(|cell| Some((cell, mm(field.at(cell)?)))).collect()
}
