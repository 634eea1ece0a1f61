//! Support of a layer -> support of a layer: thin pieces grow, from layer to layer, until they stand.
//!
//! Words: a *post* is a piece of support that goes down from layer to layer; its *height* is measured
//! from its top. Its *thickness* is that of its section ([`mod@crate::geom::section`]): a bent strip
//! stands where a straight one would not. It is *thin* if it is less than a fixed width, of low posts
//! half of their height, of high ones a fifth of it.
//!
//! A thin piece grows to all sides on each layer further down, as far as the part leaves room, until
//! it is no longer thin, and meets its neighbours on the way: then they are one piece.

use super::params::SupportParams;
use super::pieces::Pieces;
use crate::geom::section::Section;
use crate::geom::spans::Rows;
use crate::units::{Bounded as _, Coord, to_mm};

/// The least width of a post, as a part of its height: half of the slenderness of 10 at which
/// posts begin to whip under the nozzle.
const PART_OF_HEIGHT: f64 = 0.2;

/// The same of low posts, which may be thinner than others: many land on the part before long.
const PART_OF_LOW: f64 = 0.5;

/// Posts grow no wider than this (20 mm), however high: a piece as wide stands by its own weight.
const MOST_WIDTH: Coord = 200_000;

/// No post is thinner than so many lines at its thickest place, however long it is.
const LEAST_LINES: Coord = 3;

/// How far a thin piece grows on a layer, in pitches of half a line: the beads at its edge lie with
/// half of their width on those of the wider layer below.
const STEP: Coord = 1;

/// The pieces of the layer above, and the height of the top of each.
#[derive(Default)]
pub(super) struct Posts {
    rows: Rows,
    /// By span, in the order of [`Rows::iter`].
    tops: Vec<Coord>,
}

impl Posts {
    /// The support above.
    pub(super) fn rows(&self) -> &Rows {
        &self.rows
    }

    /// Takes the support of the next layer down, whose top lies at `z`, and grows its thin pieces.
    /// `cut` removes what would be in the part.
    pub(super) fn next(
        &mut self,
        rows: Rows,
        z: Coord,
        params: &SupportParams,
        cut: impl Fn(Rows) -> Rows,
    ) {
        let pieces = Pieces::new(&rows);
        let mut tops = vec![z; pieces.count()];
        pieces.meeting(&rows, &self.rows, |piece, above| {
            tops[piece] = tops[piece].max(self.tops[above]);
        });
        let thin = Self::thin(&rows, &pieces, |piece| tops[piece] - z, params);
        let grown = if thin.is_empty() {
            rows.clone()
        } else {
            let pitch = params.raster().pitch;
            cut(rows.or(&thin.dilate(STEP * pitch, pitch)))
        };
        // The tops of the grown pieces: each has some of those from before in it.
        let after = Pieces::new(&grown);
        let mut top_of = vec![z; after.count()];
        after.meeting(&grown, &rows, |piece, span| {
            top_of[piece] = top_of[piece].max(tops[pieces.of(span)]);
        });
        let spans = grown.iter().map(|(_, row)| row.len()).sum();
        self.tops = (0..spans).map(|span| top_of[after.of(span)]).collect();
        self.rows = grown;
    }

    /// The pieces that are too thin for their height.
    fn thin(
        rows: &Rows,
        pieces: &Pieces,
        height: impl Fn(usize) -> Coord,
        params: &SupportParams,
    ) -> Rows {
        if params.min_width <= 0 || rows.is_empty() {
            return Rows::default();
        }
        let pitch = params.raster().pitch;
        // Rows show the middle of the outermost lines.
        let core = rows.erode((LEAST_LINES - 1) * params.least / 2, pitch);
        let mut has_core = vec![false; pieces.count()];
        pieces.meeting(rows, &core, |piece, _| has_core[piece] = true);
        let wide = |(piece, section): (usize, Section)| {
            let asked = to_mm(asked(height(piece), params.min_width));
            has_core[piece] && section.thickness() + to_mm(params.least) >= asked
        };
        let wide: Vec<bool> =
            pieces.sections(rows, pitch).into_iter().enumerate().map(wide).collect();
        pieces.keep(rows, |piece| !wide[piece])
    }
}

/// The least thickness of a piece of some height.
fn asked(height: Coord, min_width: Coord) -> Coord {
    let height = f64::from(height);
    let low = (height * PART_OF_LOW).at_most(f64::from(min_width));
    (height * PART_OF_HEIGHT).at_most(f64::from(MOST_WIDTH)).at_least(low) as Coord
}
