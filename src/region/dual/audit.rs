//! Lines of a block and what is printed of them -> Audit: what is thick, what is not and why, and whether the material is all there.

use crate::geom::spans::Rows;
use crate::pattern::SparsePattern;
use crate::profile::DualPart;
use crate::region::Sparse;
use crate::units::Coord;
use std::sync::Arc;

/// What became of one kind of lines of a block; lengths in grid units. Lines shorter
/// than they are wide are not printed on their own, with or without dual injection.
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
    /// Material of what is printed, as the length of thin lines with as much.
    pub material: i64,
    /// Why lines are not printed for a whole group.
    pub kept_apart: Apart,
}

/// Length of a print's lines that are not in a line of a whole group's height, by cause;
/// grid units, summed over the layers.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Apart {
    /// Another layer of the group has none there: it is at or beyond its walls.
    pub bounds: i64,
    /// Another layer of the group has skin there.
    pub skin: i64,
    /// What the layers share is shorter than a line is wide.
    pub short: i64,
    /// The group has fewer layers than the ratio: at the bed, at the top, where the
    /// direction turns.
    pub ends: i64,
}

impl Apart {
    /// Counts `other` in.
    pub fn add(&mut self, other: Self) {
        self.bounds += other.bounds;
        self.skin += other.skin;
        self.short += other.short;
        self.ends += other.ends;
    }
}

impl Audit {
    /// An audit of nothing yet.
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

    /// Counts what an undoubled print has on one layer.
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

/// What of the strands of `pattern` on each layer of a group is not in `whole`, the lines
/// printed for all its layers, and why. `full` says whether the group has as many
/// layers as the ratio.
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
        let bare = others().fold(beyond.clone(), |rows, n| match &skins[n] {
            Some(skin) => rows.minus(skin),
            None => rows,
        });
        out.short += length(&shared);
        out.bounds += length(&bare);
        out.skin += length(&beyond) - length(&bare);
    }
    out
}
