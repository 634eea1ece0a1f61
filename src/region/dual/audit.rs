//! Lines of a block and what is printed of them -> Audit: how much is thick, why the rest is not, and whether material is missing.

use crate::geom::spans::Rows;
use crate::pattern::SparsePattern;
use crate::profile::DualPart;
use crate::region::Sparse;
use crate::units::Coord;
use std::sync::Arc;

/// What was printed of one kind of lines in a block; lengths in grid units. Lines shorter than
/// their width are not printed on their own, with or without dual injection.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Audit {
    /// Infill or support.
    pub part: DualPart,
    /// First layer of the block, counted from 0.
    pub first: usize,
    /// Number of its layers.
    pub layers: usize,
    /// Length of thick lines.
    pub thick: i64,
    /// Length of thin lines.
    pub thin: i64,
    /// Length of the lines of all layers in a print without dual injection.
    pub plain: i64,
    /// Material of what is printed, as the length of thin lines with the same volume.
    pub material: i64,
    /// Why lines are not printed for a whole group.
    pub kept_apart: Apart,
}

/// Length of lines that are not part of a line as high as the whole group, by cause; grid units,
/// summed over the layers.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Apart {
    /// Another layer of the group has no fill there: its walls or the outside.
    pub bounds: i64,
    /// Another layer of the group has skin there.
    pub skin: i64,
    /// What the layers share is shorter than a line's width.
    pub short: i64,
    /// The group has fewer layers than the ratio: at the bed, at the top, or where the
    /// direction changes.
    pub ends: i64,
}

impl Apart {
    /// Adds the lengths of `other`.
    pub fn add(&mut self, other: Self) {
        self.bounds += other.bounds;
        self.skin += other.skin;
        self.short += other.short;
        self.ends += other.ends;
    }
}

impl Audit {
    /// An empty audit.
    #[must_use]
    pub fn new(part: DualPart, layers: std::ops::Range<usize>) -> Self {
        Self {
            part,
            first: layers.start,
            layers: layers.len(),
            thick: 0,
            thin: 0,
            plain: 0,
            material: 0,
            kept_apart: Apart::default(),
        }
    }

    /// Counts what one layer has in a print without dual injection.
    pub fn plain(&mut self, pattern: &dyn SparsePattern, rows: &Rows, least: Coord) {
        self.plain += pattern.length(rows, least);
    }

    /// Counts lines that are printed.
    pub fn printed(&mut self, sparse: &Sparse, line_width: Coord) {
        let length = sparse.length(line_width);
        *(if sparse.layers > 1 { &mut self.thick } else { &mut self.thin }) += length;
        let layers = i64::from(sparse.layers);
        self.material += layers * length * i64::from(sparse.width) / i64::from(line_width);
    }
}

/// The length of `pattern` on the layers of a group that is not in `whole`, the lines printed
/// for all its layers, by cause. `full` is whether the group has as many layers as the ratio.
#[must_use]
pub fn apart(
    pattern: &dyn SparsePattern,
    layers: &[Rows],
    skins: &[Option<Arc<Rows>>],
    whole: Option<&Rows>,
    full: bool,
) -> Apart {
    let mut out = Apart::default();
    let length = |rows: &Rows| pattern.length(rows, 0);
    for (k, here) in layers.iter().enumerate() {
        if !full {
            out.ends += length(here);
            continue;
        }
        let left = whole.map_or_else(|| here.clone(), |whole| here.minus(whole));
        if left.is_empty() {
            continue;
        }
        let others = || (0..layers.len()).filter(|&n| n != k);
        let shared = others().fold(left.clone(), |rows, n| rows.and(&layers[n]));
        let beyond = left.minus(&shared);
        let without_skin = others().fold(beyond.clone(), |rows, n| match &skins[n] {
            Some(skin) => rows.minus(skin),
            None => rows,
        });
        out.short += length(&shared);
        out.bounds += length(&without_skin);
        out.skin += length(&beyond) - length(&without_skin);
    }
    out
}
