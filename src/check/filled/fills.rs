//! Filled -> findings of plastic and room, layer by layer and place by place.
//!
//! Words used here: a *cell* is a square of the bed; the *room* of walls and skins in a cell is what
//! they cover of it; a *gap* is a stretch between two of them that is too narrow for sparse infill.
//!
//! In each cell of a layer
//! - the plastic of walls and skins is compared with the room that they cover: lines that lie on one
//!   another share the room, and overfill it; thin ones leave it half empty. Of a thick line the
//!   share counts that lies in the layer. What irons lies on the others: it counts where it takes
//!   more than ironing does. Infill has no room there: where its lines lie side by side in that of walls and
//!   skins they come on top. A single one may run along the edge of what it holds on to;
//! - gaps are compared with that room. They are looked for along rows and along columns, and only
//!   inside the closed loops of the outer walls, so that air between two parts is none.
//!
//! Few places have either. A first look draws all lines of a layer coarsely, along rows and along columns, and tells
//! the cells in doubt; only what lies near these is drawn finely and judged.
//!
//! Sums over a whole file hide such places: a wall that is printed twice disappears among good ones.

use super::Filled;
use super::cell::{Cell, DOUBT, LEAST_OPEN, is_open};
use crate::check::capsule::Capsule;
use crate::check::finding::{Finding, Place, short};
use crate::check::rows::{Lattice, united};
use crate::check::samples::Samples;
use crate::check::survey::Survey;
use crate::check::terms::Terms;
use crate::geom::segment;
use crate::geom::spans::{Rows, Span};
use crate::reader::Role;
use crate::reader::print::Step;
use crate::units::{Bounded as _, to_mm, to_units};

/// Distance of rows, mm: an eighth of a usual line, so that a line along a row is covered by eight.
const PITCH: f64 = 0.05;

/// Rows of a layer at most; larger prints get rows further apart.
const MOST_ROWS: f64 = 6000.0;

/// Side of a cell, mm: ten lines, so that a single bad line shows and a corner does not.
const CELL: f64 = 4.0;

/// Cells along a side at most; larger prints get larger cells.
const MOST_CELLS: f64 = 256.0;

/// Width at which lines side by side touch, and half the width from which on they are more than one, in widths.
const TOUCHING: f64 = 1.1;
const SEVERAL: f64 = 0.75;

/// Share of a layer that infill fills at least to be looked at.
const LEAST_FILLED: f64 = 0.5;

/// Narrower stretches between walls or skins are gaps, mm, two lines: wider rooms are left to sparse
/// infill on purpose.
const GAP: f64 = 0.8;

/// Loops whose ends lie nearer than this are closed, mm: seams leave gaps.
const CLOSED: f64 = 1.0;

/// How far told heights may be off, mm; and the share of a layer that a line takes at least that lies lower
/// than the layer's top.
const ROUNDED: f64 = 0.02;
const LEAST_SHARE: f64 = 0.2;

/// Length of the pieces in which plastic is counted, mm.
const PIECE: f64 = 0.4;

/// Plastic of a round thread over that of a box around it: π/4 = 0.79, and what some widen it by.
const ROUND: f64 = 0.86;

/// Lanes side by side in which a line's plastic is counted: it may run along a border of cells.
const LANES: usize = 4;

/// How much further apart the columns of a first look lie: a usual line still covers two.
const COARSE: i32 = 4;

/// Where lines of walls and skins are looked at.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Field {
    lattice: Lattice,
    /// Lowest corner of the cells, mm.
    low: [f64; 2],
    /// Side of a cell, mm.
    side: f64,
    count: [usize; 2],
}

impl Field {
    /// Of all walls and skins of a print, if it has any.
    pub(crate) fn over(survey: &Survey) -> Option<Self> {
        let (low, high) = survey.solid?;
        let sides = [high[0] - low[0], high[1] - low[1]];
        let longest = sides[0].max(sides[1]);
        let side = CELL.max(longest / MOST_CELLS);
        Some(Self {
            lattice: Lattice::new(PITCH, longest, MOST_ROWS),
            // One more around, for what lines cover beyond their ends.
            low: low.map(|low| low - side),
            side,
            count: sides.map(|length| (length / side) as usize + 3),
        })
    }
}

/// Judges a layer.
pub(crate) fn layer(
    filled: &Filled<'_>,
    (field, terms): (Field, &Terms),
    layer: usize,
) -> Vec<Finding> {
    Judge { filled, terms, field }.layer(layer)
}

fn is_solid(step: &Step) -> bool {
    matches!(step.role, Role::OuterWall | Role::InnerWall | Role::Skin)
}

/// Whether a line is a round thread, as bridges are: it hangs, and fills no room of its layer.
fn is_thread(step: &Step, terms: &Terms) -> bool {
    step.height >= 0.9 * step.width && terms.width_by_plastic(step) <= ROUND * f64::from(step.width)
}

#[derive(Clone, Copy)]
struct Judge<'a> {
    filled: &'a Filled<'a>,
    terms: &'a Terms,
    field: Field,
}

impl Judge<'_> {
    fn layer(&self, layer: usize) -> Vec<Finding> {
        let mut cells = vec![Cell::default(); self.field.count[0] * self.field.count[1]];
        let lines = self.filled.lines(layer).filter(|(step, _)| !is_thread(step, self.terms));
        let mut lines: Vec<(&Step, f64)> =
            lines.map(|(step, share)| (step, share * self.over(layer, step))).collect();
        let counts = |step: &Step| is_solid(step) || step.role == Role::Ironing;
        for &(step, share) in lines.iter().filter(|(step, _)| counts(step)) {
            self.add_plastic(step, share, &mut cells);
        }
        let coarse = self.coarser();
        let is_doubtful = coarse.doubtful(layer, &lines, &cells);
        if !is_doubtful.contains(&true) {
            return Vec::new();
        }
        let is_near = |step: &Step| self.cells_near(step).any(|k| is_doubtful[k]);
        lines.retain(|(step, _)| is_near(step));
        let solids = || solids_of(&lines);
        for flipped in [false, true] {
            if flipped {
                // Few layers have gaps along columns: a first look tells most of the others.
                let solid = coarse.drawn(solids(), flipped);
                if coarse.open((layer, flipped), &solid, &cells, DOUBT).is_none() {
                    continue;
                }
            }
            let solid = self.drawn(solids(), flipped);
            if !flipped {
                self.share(&solid, flipped, |k, area| cells[k].room += area);
                let infill = self.infill_on(layer, &solid, &lines);
                self.share(&infill, flipped, |k, area| cells[k].infill += area);
            }
            // Most layers have too few gaps for any place to be open: no more is drawn for them.
            let open = self.unfilled((layer, flipped), &solid, (&lines, &cells), 1.0);
            let Some(open) = open else { continue };
            self.share(&open, flipped, |k, area| cells[k].open[usize::from(flipped)] += area);
        }
        let judged = cells.iter().enumerate().filter_map(|(k, cell)| {
            let finding = is_doubtful[k].then(|| cell.judged(self.filled.height(layer)))??;
            let [x, y] = [k % self.field.count[0], k / self.field.count[0]];
            let middle = |low: f64, k: usize| short(low + (k as f64 + 0.5) * self.field.side);
            Some(finding.at(Place {
                line: None,
                layer: Some(layer + 1),
                z_mm: Some(short(self.filled.top(layer))),
                at_mm: Some([middle(self.field.low[0], x), middle(self.field.low[1], y)]),
            }))
        });
        judged.collect()
    }

    /// In which cells of a layer, of which the plastic is known, a first look leaves a doubt whether they have too
    /// little plastic, too much, or gaps. The room is measured along rows and along columns: lines that lie between
    /// rows cross columns.
    fn doubtful(&self, layer: usize, lines: &[(&Step, f64)], cells: &[Cell]) -> Vec<bool> {
        let mut cells = cells.to_vec();
        let drawn = [false, true].map(|flipped| {
            let solid = self.drawn(solids_of(lines), flipped);
            self.share(&solid, flipped, |k, area| cells[k].room += area / 2.0);
            if !flipped {
                let infill = self.infill_on(layer, &solid, lines);
                self.share(&infill, flipped, |k, area| cells[k].infill += area);
            }
            (flipped, solid)
        });
        for (flipped, solid) in drawn {
            let open = self.unfilled((layer, flipped), &solid, (lines, &cells), DOUBT);
            let Some(open) = open else { continue };
            let side = usize::from(flipped);
            self.share(&open, flipped, |k, area| cells[k].open[side] += area / DOUBT);
        }
        let height = self.filled.height(layer);
        cells.iter().map(|cell| cell.is_doubtful(height)).collect()
    }

    /// The cells whose gaps a line may lie in or beside.
    fn cells_near(&self, step: &Step) -> impl Iterator<Item = usize> {
        let (low, high) = Capsule::of(step, 1.0).extent();
        let field = self.field;
        let [columns, rows] = [0, 1].map(|axis| {
            let place = |at: f64| ((at - field.low[axis]) / field.side).at_least(0.0) as usize;
            place(low[axis] - GAP)..(place(high[axis] + GAP) + 1).min(field.count[axis])
        });
        rows.flat_map(move |row| columns.clone().map(move |column| column + row * field.count[0]))
    }

    /// The same with columns and rows further apart.
    fn coarser(&self) -> Self {
        let lattice = self.field.lattice.coarser(COARSE);
        Self { field: Field { lattice, ..self.field }, ..*self }
    }

    /// The gaps of a layer's walls and skins, if they make a place open, or this part of it.
    fn open(
        &self,
        (layer, flipped): (usize, bool),
        solid: &Rows,
        cells: &[Cell],
        part: f64,
    ) -> Option<Rows> {
        let between = gaps(solid);
        if self.field.lattice.area(&between) < part * LEAST_OPEN {
            return None;
        }
        let has_open = |gaps: &Rows| {
            let mut areas = vec![0.0; cells.len()];
            self.share(gaps, flipped, |k, area| areas[k] += area / part);
            areas.iter().zip(cells).any(|(open, cell)| is_open(*open, cell.room))
        };
        if !has_open(&between) {
            return None;
        }
        let open = between.and(&self.inside(layer, flipped));
        has_open(&open).then_some(open)
    }

    /// As [`Self::open`], less what sparse infill and threads cover.
    fn unfilled(
        &self,
        (layer, flipped): (usize, bool),
        solid: &Rows,
        (lines, cells): (&[(&Step, f64)], &[Cell]),
        part: f64,
    ) -> Option<Rows> {
        let open = self.open((layer, flipped), solid, cells, part)?;
        let sparse = lines.iter().map(|(step, _)| *step).filter(|step| step.role == Role::Infill);
        let own = self.filled.window.moves(layer).iter();
        let threads = own.filter(|step| step.is_line() && is_thread(step, self.terms));
        let others = capsules(sparse.chain(threads), flipped);
        Some(open.minus(&self.field.lattice.draw_on(&open, others)))
    }

    /// The layer's height over that of the room below a line: more than 1 of one that ends below the layer's
    /// top, as on a slope, for the room above is not its own.
    fn over(&self, layer: usize, step: &Step) -> f64 {
        let (top, height) = (self.filled.top(layer), self.filled.height(layer));
        let room = 0.5 * f64::from(step.from[2] + step.to[2]) - (top - height);
        let lies_in = f64::from(step.height) <= room + ROUNDED && room >= LEAST_SHARE * height;
        if lies_in && room < height - ROUNDED { height / room } else { 1.0 }
    }

    /// Adds the share of a line's plastic to the cells that it lies in.
    fn add_plastic(&self, step: &Step, share: f64, cells: &mut [Cell]) {
        // One by one, so that sums do not depend on how pieces are counted, to the last digit.
        let mut add = |cell: Option<usize>, plastic: f64, pieces: usize| {
            if let Some(cell) = cell.and_then(|k| cells.get_mut(k)) {
                let sum = if is_solid(step) { &mut cell.plastic } else { &mut cell.ironed };
                *sum = (0..pieces).fold(*sum, |sum, _| sum + plastic);
            }
        };
        let plastic = self.terms.plastic(step) * share;
        let (low, high) = Capsule::of(step, 1.0).extent();
        let ends = [self.cell(low), self.cell(high)];
        if ends[0].is_some() && ends[0] == ends[1] {
            return add(ends[0], plastic, 1);
        }
        let pieces = Samples::of(step, PIECE);
        let each = plastic / step.length() * pieces.length_of_each() / LANES as f64;
        let lane = f64::from(step.width) / LANES as f64;
        for k in 0..LANES {
            let aside = (k as f64 + 0.5 - LANES as f64 / 2.0) * lane;
            self.along(pieces.row(aside), |cell, count| add(cell, each, count));
        }
    }

    /// Hands the cells of places in a row to `sink`, each with how many of the places lie in it.
    fn along(
        &self,
        (first, by, count): ([f64; 2], [f64; 2], usize),
        mut sink: impl FnMut(Option<usize>, usize),
    ) {
        let mut done = 0;
        while done < count {
            let at = segment::along(first, done as f64, by);
            let cell = self.cell(at);
            let more = if cell.is_some() { self.places_ahead(at, by) } else { 0 };
            let here = more.saturating_add(1).min(count - done);
            sink(cell, here);
            done += here;
        }
    }

    /// How many places after one lie in its cell, if each lies so far from the one before.
    fn places_ahead(&self, at: [f64; 2], by: [f64; 2]) -> usize {
        let [x, y] = [0, 1].map(|axis| {
            let from = (at[axis] - self.field.low[axis]) / self.field.side;
            let part = from - f64::from(from as u32);
            let room = if by[axis] > 0.0 { 1.0 - part } else { part };
            // Endless along a border: no place is beyond.
            room * self.field.side / by[axis].abs()
        });
        x.min(y) as usize
    }

    /// What lines cover.
    fn drawn<'s>(&self, lines: impl Iterator<Item = &'s Step>, flipped: bool) -> Rows {
        self.field.lattice.draw(capsules(lines, flipped))
    }

    /// Where infill that fills most of a layer lies side by side on what is `solid`.
    fn infill_on(&self, layer: usize, solid: &Rows, lines: &[(&Step, f64)]) -> Rows {
        let least = LEAST_FILLED * self.filled.height(layer);
        let fills = |(step, share): &&(&Step, f64)| {
            step.role == Role::Infill && share * f64::from(step.height) >= least
        };
        let mut widest = 0.0_f64;
        let infill = lines.iter().filter(fills).map(|(step, _)| {
            widest = widest.max(f64::from(step.width));
            Capsule::of(step, TOUCHING)
        });
        let both = solid.and(&self.field.lattice.draw_on(solid, infill));
        self.field.lattice.opened(&both, SEVERAL * widest)
    }

    /// The cell of a place.
    fn cell(&self, at: [f64; 2]) -> Option<usize> {
        let x = (at[0] - self.field.low[0]) / self.field.side;
        let y = (at[1] - self.field.low[1]) / self.field.side;
        let is_in = x >= 0.0
            && y >= 0.0
            && x < self.field.count[0] as f64
            && y < self.field.count[1] as f64;
        is_in.then_some(x as usize + y as usize * self.field.count[0])
    }

    /// Hands each cell's part of an area to `sink`, mm².
    fn share(&self, rows: &Rows, flipped: bool, mut sink: impl FnMut(usize, f64)) {
        let (along, across) = if flipped { (1, 0) } else { (0, 1) };
        let strides = [1, self.field.count[0]];
        for (j, row) in rows.iter().filter(|(_, row)| !row.is_empty()) {
            let y = (self.field.lattice.middle(j) - self.field.low[across]) / self.field.side;
            if y < 0.0 || y >= self.field.count[across] as f64 {
                continue;
            }
            let base = y as usize * strides[across];
            for span in row {
                let [mut from, to] = [span.start, span.end].map(|at| {
                    ((to_mm(at) - self.field.low[along]) / self.field.side).at_least(0.0)
                });
                while from < to {
                    let k = from as usize;
                    let end = to.at_most((k + 1) as f64);
                    if k < self.field.count[along] {
                        let area = (end - from) * self.field.side * self.field.lattice.pitch();
                        sink(base + k * strides[along], area);
                    }
                    from = end;
                }
            }
        }
    }

    /// What the closed loops of a layer's outer walls enclose, between the middles of their lines.
    fn inside(&self, layer: usize, flipped: bool) -> Rows {
        let steps = self.filled.window.moves(layer);
        let is_wall = |step: &Step| step.is_line() && step.role == Role::OuterWall;
        let mut crossings: Vec<(i32, f64)> = Vec::new();
        for chain in steps.chunk_by(|a, b| is_wall(a) && is_wall(b) && a.to == b.from) {
            let (first, last) = (&chain[0], &chain[chain.len() - 1]);
            let [x, y] = [0, 1].map(|axis| f64::from(first.from[axis] - last.to[axis]));
            if !is_wall(first) || x * x + y * y > CLOSED * CLOSED {
                continue;
            }
            let closing = std::iter::once((last.to, first.from));
            for (from, to) in chain.iter().map(|step| (step.from, step.to)).chain(closing) {
                let at = |at: [f32; 3]| {
                    let [x, y] = [f64::from(at[0]), f64::from(at[1])];
                    if flipped { [y, x] } else { [x, y] }
                };
                let (a, b) = (at(from), at(to));
                let (low, high) = if a[1] < b[1] { (a, b) } else { (b, a) };
                for row in self.field.lattice.range(low[1], high[1]) {
                    let part = (self.field.lattice.middle(row) - low[1]) / (high[1] - low[1]);
                    crossings.push((row, low[0] + part * (high[0] - low[0])));
                }
            }
        }
        crossings.sort_unstable_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
        let rows = crossings.chunk_by(|a, b| a.0 == b.0);
        let spans: Vec<(i32, Span)> = rows
            .flat_map(|row| row.chunks_exact(2))
            .filter_map(|two| Some((two[0].0, Span::new(to_units(two[0].1), to_units(two[1].1))?)))
            .collect();
        united(&spans)
    }
}

/// Lines from above, with x and y exchanged or not.
fn capsules<'s>(
    lines: impl Iterator<Item = &'s Step>,
    flipped: bool,
) -> impl Iterator<Item = Capsule> {
    let capsules = lines.map(|step| Capsule::of(step, 1.0));
    capsules.map(move |one| if flipped { one.flipped() } else { one })
}

/// The lines of walls and skins.
fn solids_of<'s>(lines: &[(&'s Step, f64)]) -> impl Iterator<Item = &'s Step> {
    lines.iter().filter(|(step, _)| is_solid(step)).map(|(step, _)| *step)
}

/// The gaps of each row.
fn gaps(solid: &Rows) -> Rows {
    let most = i64::from(to_units(GAP));
    let mut between = Rows::with_room_of(solid, solid.range().start);
    for (_, row) in solid.iter() {
        between.push_row(|spans| {
            let gaps = row.windows(2).filter_map(|two| Span::new(two[0].end, two[1].start));
            spans.extend(gaps.filter(|gap| gap.len() <= most));
        });
    }
    between
}
