//! Support of a layer -> support of a layer: thin pieces grow, from layer to layer, until they stand.
//!
//! Words: a *post* is a piece of support that goes down from layer to layer; its *height* is measured
//! from its top. It is *thin* if no disc of its least width has room in it. The least width is a
//! fixed one, or a fifth of the height if that is more.
//!
//! A thin piece grows to all sides on each layer further down, as far as the part leaves room. So it
//! becomes wide enough within a few layers, and meets its neighbours on the way: then they are one
//! piece. A piece that has room for the disc somewhere stays as it is, since that place holds it.

use super::params::SupportParams;
use super::pieces::Pieces;
use crate::geom::spans::Rows;
use crate::units::{Bounded as _, Coord};

/// The least width of a post, as a part of its height: half of the slenderness of 10 at which
/// posts begin to whip under the nozzle.
const PART_OF_HEIGHT: f64 = 0.2;

/// Posts grow no wider than this (20 mm), however high: a piece as wide stands by its own weight.
const MOST_WIDTH: Coord = 200_000;

/// How far a thin piece grows on a layer, in pitches. It leans out by two layer heights then, which
/// is no matter further down: wider layers carry narrower ones.
const STEP: Coord = 2;

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
        let thin = self.thin(&rows, &pieces, |piece| tops[piece] - z, params);
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
        &self,
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
        let radius = |width: Coord| ((width - params.least) / 2).max(1);
        let mut wide = vec![false; pieces.count()];
        let core = rows.erode(radius(params.min_width), pitch);
        pieces.meeting(rows, &core, |piece, _| wide[piece] = true);
        // Only posts that are taller than five times that width are looked at alone.
        for (piece, wide) in wide.iter_mut().enumerate().filter(|(_, wide)| **wide) {
            let asked = f64::from(height(piece)) * PART_OF_HEIGHT;
            if asked > f64::from(params.min_width) {
                let one = pieces.keep(rows, |other| other == piece);
                let asked = asked.at_most(f64::from(MOST_WIDTH)) as Coord;
                *wide = !one.erode(radius(asked), pitch).is_empty();
            }
        }
        pieces.keep(rows, |piece| !wide[piece])
    }
}
