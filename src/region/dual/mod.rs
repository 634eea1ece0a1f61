//! Areas of a block of layers -> Sparse: which lines each layer prints, for itself or for several layers.
//!
//! Words: *group*, *block*, *ratio* and *lane* as in [`groups`]; *run* as in [`mod@runs`]. A
//! *thick* line is printed for several layers at once, a *thin* one for its own layer. The
//! *remainder* is what not all layers of a group have.
//!
//! Where all layers of a group have sparse lines, the uppermost prints them once, with exactly
//! the material of all. Where only some successive layers have them, these share one line.
//!
//! Algorithm, for each block: choose its patterns; divide each into lanes; find the runs of each
//! lane; count in an [`audit`] what is thick and why the rest is not; widen the thick lines
//! slightly, to make up for lines too short to be printed.
//!
//! The thesis that this follows prints the layer of a pair whose lines are shorter in total, and
//! drops the other. That leaves hollow places where the layers differ, and it often keeps the
//! same direction every time. Both are avoided here unless the settings ask for that rule.

pub mod audit;
pub mod beads;
pub mod groups;
pub mod inner_skin;
pub mod runs;

use super::classify::Areas;
use super::divide::LayerAreas;
use super::{Border, Sparse};
use crate::geom::raster::Raster;
use crate::geom::spans::Rows;
use crate::pattern::{Pattern, SparsePattern, Turns};
use crate::profile::DualPart;
use crate::units::Coord;
use audit::{Audit, apart};
use groups::{Block, Grouping, Lane};
use runs::{Printed, runs};
use std::sync::Arc;

/// Thick lines are widened by at most this, per cent of a line's width, to carry the material of
/// lines too short to be printed. A larger value shows as bulges where thick lines end; a smaller
/// one loses that material.
const MOST_WIDENED: i64 = 5;

/// Narrower remainders beside thick lines have no room for a run along the wall, per cent of a
/// line's width. A smaller value lets runs lie on thick ones, a larger one takes anchors away.
const LEAST_REMAINDER: i64 = 70;

/// The patterns that may fill `block`. Its layers must be divided on the rasters of all of them.
#[must_use]
pub fn patterns(block: &Block, grouping: &Grouping, turns: &Turns) -> Vec<Pattern> {
    if grouping.shares(DualPart::Infill) && !grouping.shorter {
        return turns.of(block.turn).to_vec();
    }
    block.layers.clone().flat_map(|k| turns.of(k)).cloned().collect()
}

/// The infill of each layer of `block`, and the audit of its lines if they may be shared.
#[must_use]
pub fn infill(
    block: &Block,
    layers: &[&LayerAreas],
    grouping: &Grouping,
    turns: &Turns,
    line_width: Coord,
) -> (Vec<Vec<Sparse>>, Option<Audit>) {
    if !grouping.shares(DualPart::Infill) {
        let each = block.layers.clone().zip(layers);
        let plain = |(k, areas): (usize, &&'_ LayerAreas)| {
            let patterns: Vec<_> = turns.of(k).iter().chain(turns.dense(k)).cloned().collect();
            plain(&patterns, areas, line_width)
        };
        return (each.map(plain).collect(), None);
    }
    let kept = shortest(block, layers, grouping, turns, line_width);
    let patterns = turns.of(if grouping.shorter { block.layers.start + kept } else { block.turn });
    let mut sharing = Sharing::new(DualPart::Infill, block, grouping, line_width);
    let shared = if grouping.drops {
        sharing.keep(patterns, layers, kept);
        &[]
    } else {
        patterns
    };
    // Rooms that are solid are shared whatever becomes of sparse lines: dropped, they would be hollow.
    for pattern in shared.iter().chain(turns.dense(block.turn)) {
        let rows: Vec<Rows> = layers.iter().map(|areas| rows(&**pattern, areas)).collect();
        let skin = |areas: &&'_ LayerAreas| areas.on(pattern.raster()).map(|a| a.skin.clone());
        let skins: Vec<Option<Arc<Rows>>> = layers.iter().map(skin).collect();
        let borders = layers.iter().map(|areas| border(&**pattern, areas)).collect();
        sharing.share(pattern, &rows, &skins, borders);
    }
    let (sparse, audit) = sharing.finish();
    (sparse, Some(audit))
}

/// The support of each layer of `block`, and the audit of its lines if they may be shared. `rows`
/// is where each layer has support, by pattern.
#[must_use]
pub fn support(
    block: &Block,
    rows: &[Vec<Rows>],
    patterns: &[Pattern],
    grouping: &Grouping,
    line_width: Coord,
) -> (Vec<Vec<Sparse>>, Option<Audit>) {
    if !grouping.shares(DualPart::Support) {
        let each = |n: usize| patterns.iter().zip(rows).map(move |(p, rows)| (p, &rows[n]));
        let thin = |n| each(n).map(|(p, rows)| thin(p, rows.clone(), line_width, None)).collect();
        return ((0..block.layers.len()).map(thin).collect(), None);
    }
    let mut sharing = Sharing::new(DualPart::Support, block, grouping, line_width);
    for (pattern, rows) in patterns.iter().zip(rows) {
        sharing.share(pattern, rows, &vec![None; rows.len()], vec![None; rows.len()]);
    }
    let (sparse, audit) = sharing.finish();
    (sparse, Some(audit))
}

/// The infill of a layer on its own.
#[must_use]
pub fn plain(patterns: &[Pattern], areas: &LayerAreas, line_width: Coord) -> Vec<Sparse> {
    let thin = |pattern: &Pattern| {
        let border = border(&**pattern, areas);
        thin(pattern, rows(&**pattern, areas), line_width, border)
    };
    patterns.iter().map(thin).collect()
}

/// A region that one layer prints for itself.
fn thin(pattern: &Pattern, rows: Rows, width: Coord, border: Option<Border>) -> Sparse {
    Sparse { pattern: pattern.clone(), rows, layers: 1, width, border }
}

/// What the sparse infill of a layer holds on to, if `pattern` asks for it.
fn border(pattern: &dyn SparsePattern, areas: &LayerAreas) -> Option<Border> {
    let raster = pattern.raster();
    let (across, Raster { pitch, .. }, left_turn) =
        areas.across(raster).filter(|_| pattern.is_anchored())?;
    let walls = vec![[areas.on(raster)?.fill.clone(), across.fill.clone()]];
    let columns = if pattern.is_solid() { &across.dense } else { &across.infill }.clone();
    Some(Border { columns, pitch, left_turn, walls, beside_thick: false })
}

/// Leaves out the columns of remainders that are narrower than a bead: there the thick bead beside
/// them holds on to the wall, and a run along the wall would lie on it.
fn without_slivers(printed: &mut Printed, line_width: Coord) {
    let Some(thickest) = printed.iter().map(|(layers, _)| *layers).max() else { return };
    let least = i64::from(line_width) * LEAST_REMAINDER / 100;
    for (_, columns) in printed.iter_mut().filter(|(layers, _)| *layers < thickest) {
        *columns = columns.filter(|_, span| span.len() >= least);
    }
}

/// The border of what `layers` share, whose own borders are given, with its `columns`;
/// `beside_thick` as in [`Border`].
fn shared(layers: &[Border], columns: Rows, beside_thick: bool) -> Option<Border> {
    let walls = layers.iter().flat_map(|border| border.walls.clone()).collect();
    let &Border { pitch, left_turn, .. } = layers.last()?;
    Some(Border { columns, pitch, left_turn, walls, beside_thick })
}

/// The sparse infill of a layer on the raster of `pattern`; empty if it was not divided there.
fn rows(pattern: &dyn SparsePattern, areas: &LayerAreas) -> Rows {
    let of = |areas: &Areas| if pattern.is_solid() { &areas.dense } else { &areas.infill }.clone();
    areas.on(pattern.raster()).map_or_else(Rows::default, of)
}

/// The layer of the block with the smallest length of lines; of equals the upper one. Each layer
/// counts in its own direction if thick lines take the shorter one.
fn shortest(
    block: &Block,
    layers: &[&LayerAreas],
    grouping: &Grouping,
    turns: &Turns,
    line_width: Coord,
) -> usize {
    let length = |n: usize| -> i64 {
        let turn = if grouping.shorter { block.layers.start + n } else { block.turn };
        let of = |pattern: &Pattern| {
            let areas = layers[n].on(pattern.raster());
            areas.map_or(0, |areas| pattern.length(&areas.infill, line_width))
        };
        turns.of(turn).iter().map(of).sum()
    };
    let decides = grouping.shorter || grouping.drops;
    let by_length = (0..layers.len()).rev().filter(|_| decides).min_by_key(|&n| length(n));
    by_length.unwrap_or(0)
}

/// Distributes the lines of a block among its layers.
struct Sharing<'a> {
    block: &'a Block,
    grouping: &'a Grouping,
    line_width: Coord,
    sparse: Vec<Vec<Sparse>>,
    audit: Audit,
    /// Lines of whole layers are left out on purpose.
    has_dropped: bool,
}

impl<'a> Sharing<'a> {
    fn new(part: DualPart, block: &'a Block, grouping: &'a Grouping, line_width: Coord) -> Self {
        let sparse = vec![Vec::new(); block.layers.len()];
        let audit = Audit::new(part, block.layers.clone());
        Self { block, grouping, line_width, sparse, audit, has_dropped: false }
    }

    /// The rule of the thesis: the lines of the layer `kept` are printed for all, those of the others
    /// are dropped.
    fn keep(&mut self, patterns: &[Pattern], layers: &[&LayerAreas], kept: usize) {
        self.has_dropped = true;
        for sparse in plain(patterns, layers[kept], self.line_width) {
            for areas in layers {
                let rows = rows(&*sparse.pattern, areas);
                self.audit.plain(&*sparse.pattern, &rows, self.line_width);
            }
            self.sparse[layers.len() - 1].push(Sparse { layers: layers.len() as u32, ..sparse });
        }
    }

    /// Distributes the strands of `pattern`. `rows` is its region on each layer, `skins` are the
    /// skins of the layers on the same raster.
    fn share(
        &mut self,
        pattern: &Pattern,
        rows: &[Rows],
        skins: &[Option<Arc<Rows>>],
        borders: Vec<Option<Border>>,
    ) {
        let borders: Vec<Border> = borders.into_iter().flatten().collect();
        let columns: Vec<Rows> = borders.iter().map(|border| border.columns.clone()).collect();
        let lanes = match pattern.is_solid() {
            true => vec![Lane { pattern: pattern.clone(), phase: 0 }],
            false => self.grouping.lanes(pattern),
        };
        for lane in lanes {
            let first = self.block.layers.start;
            let ends = |n: usize| self.grouping.ends(lane.phase, first + n, self.block);
            let printed = runs(rows, ends, self.line_width);
            let mut across = runs(&columns, ends, self.line_width);
            across.iter_mut().for_each(|printed| without_slivers(printed, self.line_width));
            self.explain(&lane, rows, skins, &printed);
            for (n, printed) in printed.into_iter().enumerate() {
                let most = printed.iter().map(|(layers, _)| *layers).max().unwrap_or(1);
                let sparse = |(layers, rows): (u32, Rows)| {
                    let columns = across.get(n).and_then(|a| a.iter().find(|a| a.0 == layers));
                    let columns = columns.map(|(_, rows)| rows.clone()).unwrap_or_default();
                    let its = borders.get(n + 1 - layers as usize..=n).unwrap_or_default();
                    let border = shared(its, columns, layers < most);
                    Sparse { layers, ..thin(&lane.pattern, rows, self.line_width, border) }
                };
                self.sparse[n].extend(printed.into_iter().map(sparse));
            }
        }
    }

    /// Counts the strands of a lane, and why some are not printed for a whole group.
    fn explain(
        &mut self,
        lane: &Lane,
        rows: &[Rows],
        skins: &[Option<Arc<Rows>>],
        printed: &[Printed],
    ) {
        let first = self.block.layers.start;
        let pattern = &*lane.pattern;
        let mut from = 0;
        for n in 0..rows.len() {
            self.audit.plain(pattern, &rows[n], self.line_width);
            if !self.grouping.ends(lane.phase, first + n, self.block) {
                continue;
            }
            let group = from..n + 1;
            let whole = printed[n].iter().find(|(layers, _)| *layers as usize == group.len());
            let full = group.len() == self.grouping.ratio();
            let whole = whole.map(|(_, rows)| rows);
            let apart = apart(pattern, &rows[group.clone()], &skins[group], whole, full);
            self.audit.kept_apart.add(apart);
            from = n + 1;
        }
    }

    /// The lines of each layer. Thick ones are widened to carry the material of lines too short to
    /// be printed, unless that of whole layers is dropped. Solid ones have no room for it.
    fn finish(mut self) -> (Vec<Vec<Sparse>>, Audit) {
        let w = self.line_width;
        let widens = |s: &Sparse| s.layers > 1 && !s.pattern.is_solid();
        let all = || self.sparse.iter().flatten();
        let material = |s: &Sparse| i64::from(s.layers) * s.length(w);
        let thick: i64 = all().filter(|s| widens(s)).map(material).sum();
        let lost = self.audit.plain - all().map(material).sum::<i64>();
        if thick > 0 && lost > 0 && !self.has_dropped {
            let most = i64::from(w) * MOST_WIDENED / 100;
            let wider = ((i64::from(w) * lost + thick / 2) / thick).min(most) as Coord;
            let thick = self.sparse.iter_mut().flatten().filter(|s| widens(s));
            thick.for_each(|sparse| sparse.width += wider);
        }
        for sparse in self.sparse.iter().flatten() {
            self.audit.printed(sparse, w);
        }
        (self.sparse, self.audit)
    }
}
