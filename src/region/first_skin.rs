//! Skin and the sparse lines below it -> two kinds of islands: skin that runs as usual, skin that turns.
//!
//! The *first skin* is skin that lies on sparse infill. Where its lines run along the lines below,
//! most of them lie on nothing over their whole length. Where they run across, none is free for
//! longer than the spacing below. Skin alternates its direction with the layer, and sparse lines
//! with the block of layers that they fill. So with dual injection the two often run alike.
//!
//! Algorithm: find the places where a line of skin has a long stretch of sparse infill below. All
//! islands of skin with such a place take the raster across. Both rasters of skins are known on
//! every layer, so that a turned island costs no scan. An island turns as a whole: a seam between
//! two directions inside it would cost more than it mends.

use crate::geom::islands::Islands;
use crate::geom::raster::crossed;
use crate::geom::spans::{Rows, Span};
use crate::units::Coord;
use std::sync::Arc;

/// A line of skin may run over sparse infill for this long (2 mm) in the direction of the lines
/// below. It then lies on what bounds it at its ends, or across on lines of 20 % infill just as
/// far apart. A larger value leaves lines that sag; a smaller one turns skins for nothing.
const MOST_FREE: Coord = 20_000;

/// Skin on the raster of its lines and on the raster across.
pub type Both = [Arc<Rows>; 2];

/// The rasters of a skin: how their places belong together.
#[derive(Debug, Clone, Copy)]
pub struct Turn {
    /// Distance of the lines of both rasters.
    pub pitch: Coord,
    /// The raster across is turned by +90° (else by −90°).
    pub left: bool,
}

/// Divides `skin` into the islands that keep their direction, and those that must turn. `below` is
/// the sparse infill that runs in the direction of the skin on the layer below, on the same raster.
#[must_use]
pub fn divide(skin: Both, below: &Rows, turn: Turn) -> (Both, Option<Both>) {
    let free = skin[0].and(below).filter(|_, span| span.len() > i64::from(MOST_FREE));
    if free.is_empty() {
        return (skin, None);
    }
    let islands = Islands::new(&skin[0]);
    let mut turns = vec![false; islands.count()];
    for (j, row) in free.iter() {
        for island in row.iter().filter_map(|span| islands.at(j, span.start)) {
            turns[island] = true;
        }
    }
    if turns.iter().all(|turns| *turns) {
        return (Both::default(), Some(skin));
    }
    let turned = |c: i32, span: Span| island(&islands, c, span, turn).is_some_and(|k| turns[k]);
    let rows = [false, true].map(|which| islands.select(|k| turns[k] == which));
    let columns = [false, true].map(|which| skin[1].filter(|c, s| turned(c, s) == which));
    let ([kept, turned], [kept_across, turned_across]) = (rows, columns);
    ([kept, kept_across].map(Arc::new), Some([turned, turned_across].map(Arc::new)))
}

/// The island that `span` of column `c` belongs to: that of the first row that it crosses.
fn island(islands: &Islands<'_>, c: i32, span: Span, turn: Turn) -> Option<usize> {
    // Turned left, u is −v of the columns and v their u; turned right, it is the other way round.
    let at = c * turn.pitch;
    let (u, low, high) =
        if turn.left { (-at, span.start, span.end) } else { (at, -span.end, -span.start) };
    crossed(low, high, turn.pitch).find_map(|j| islands.at(j, u))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::frame::Frame;
    use crate::geom::raster::Raster;
    use crate::geom::{Contour, Point};
    use crate::region::scan::Scan;
    use proptest::prelude::*;

    const W: Coord = 4_000;

    fn rectangle(x: [Coord; 2], y: [Coord; 2]) -> Contour {
        [(x[0], y[0]), (x[1], y[0]), (x[1], y[1]), (x[0], y[1])].map(|(x, y)| Point { x, y }).into()
    }

    /// `contours` on the raster at `degrees`.
    fn rows(contours: &[Contour], degrees: f64) -> Rows {
        let raster = Raster { frame: Frame::new(degrees), pitch: W };
        Scan::new(contours, raster).inside().clone()
    }

    fn both(contours: &[Contour], left: bool) -> Both {
        let degrees = if left { [0.0, 90.0] } else { [90.0, 0.0] };
        degrees.map(|degrees| Arc::new(rows(contours, degrees)))
    }

    proptest! {
        /// Nothing is lost, and both rasters agree on which island turns.
        #[test]
        fn the_islands_over_infill_turn_and_no_others(
            left: bool,
            gap in 5_000_i32..50_000,
            size in 30_000_i32..90_000,
            shift in -40_000_i32..40_000,
        ) {
            let here = rectangle([shift, shift + size], [-size, size]);
            let from = shift + size + gap;
            let there = rectangle([from, from + size], [-size, size / 2]);
            let skin = both(&[here.clone(), there.clone()], left);
            let below = rows(std::slice::from_ref(&there), if left { 0.0 } else { 90.0 });
            let (kept, turned) = divide(skin, &below, Turn { pitch: W, left });
            prop_assert_eq!(kept[0].total(), both(std::slice::from_ref(&here), left)[0].total());
            prop_assert_eq!(kept[1].total(), both(&[here], left)[1].total());
            let turned = turned.unwrap();
            prop_assert_eq!(turned[0].total(), both(std::slice::from_ref(&there), left)[0].total());
            prop_assert_eq!(turned[1].total(), both(&[there], left)[1].total());
        }
    }

    #[test]
    fn short_stretches_over_infill_turn_nothing() {
        let skin = both(&[rectangle([0, 100_000], [0, 100_000])], true);
        let below = rows(&[rectangle([0, 15_000], [0, 90_000])], 0.0);
        assert!(divide(skin, &below, Turn { pitch: W, left: true }).1.is_none());
    }
}
