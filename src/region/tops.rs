//! Skin of a layer + what covers it above -> skin that is seen from above, and the rest.
//!
//! A top is printed in its own way: slower, and line beside line. It ends a line's width under the walls
//! of what stands on it, so that the edge between both kinds of skin is hidden. A ring of a slope that
//! is narrower than a few lines is no top of its own: cut off, it would be all turns.
//!
//! At the edge both kinds turn, or end in a tip, and each presses a little into the other. So lines of
//! the rest end earlier by half of what lines reach into walls.
//!
//! Both rasters are divided by the same rule, but each knows its edges across only to within a line.
//! Beside a wall that runs along the rows they may disagree for a long way. So each part has all columns
//! that some row crosses: they say how far its last row is from the wall, and what is left open there is
//! closed by the part that has this row. Other columns belong to one part.

use super::first_skin::Both;
use super::params::{NARROW_TOP, NOISE};
use super::{Skin, SkinRows};
use crate::geom::polyline::{LinePoint, Polyline};
use crate::geom::raster;
use crate::geom::spans::{Rows, Span};
use crate::units::Coord;
use std::sync::Arc;

/// The parts of `skin` on two rasters, and whether each is seen. `covers` are the layer above on the same
/// rasters; `None` above the part. Lines are `width` wide, and reach `overlap` into walls.
#[must_use]
pub fn divide(
    skin: Both,
    covers: [Option<&Rows>; 2],
    (width, overlap): (Coord, Coord),
) -> Vec<(Both, bool)> {
    let [along, across] = [0, 1].map(|r| seen(&skin[r], covers[r], width));
    // No row is so near to the next: spans grow along their rows alone.
    let rest = skin[0].minus(&along.dilate(overlap / 2, width));
    if along.is_empty() || rest.is_empty() {
        return vec![(skin, !along.is_empty())];
    }
    let columns = [skin[1].minus(&across), across];
    let columns = columns.map(|columns| columns_of(&columns, &skin[1], width));
    let part = |rows: Rows, columns: &Rows| [rows, columns.clone()].map(Arc::new);
    vec![(part(rest, &columns[0]), false), (part(along, &columns[1]), true)]
}

/// The columns of a part: those of the `whole` skin that rows `pitch` apart cross, and of the others its
/// `own`.
fn columns_of(own: &Rows, whole: &Rows, pitch: Coord) -> Rows {
    let crossed = whole.filter(|_, s| !raster::crossed(s.start, s.end, pitch).is_empty());
    own.and(&whole.minus(&crossed)).or(&crossed)
}

/// Adds the wall beads of a layer that are seen to its skin that is; returns the others. They lie on the
/// raster of its first skin, `above` is the layer above on the same.
#[must_use]
pub fn add_seen(
    skins: &mut Vec<Skin>,
    mut beads: Vec<Polyline>,
    above: Option<&Rows>,
) -> Vec<Polyline> {
    let Some(&Skin { raster, left_turn, .. }) = skins.first() else { return beads };
    let seen = beads.extract_if(.., |bead| is_seen(bead, above, raster.pitch));
    let seen: Vec<Polyline> = seen.collect();
    match skins.iter_mut().find(|skin| skin.top && skin.raster == raster) {
        _ if seen.is_empty() => {}
        Some(top) => top.beads = seen,
        None => skins.push(Skin {
            layers: 1,
            raster,
            rows: SkinRows::default(),
            columns: SkinRows::default(),
            left_turn,
            beads: seen,
            room_beads: Vec::new(),
            bridges: false,
            top: true,
        }),
    }
    beads
}

/// Whether most of `bead` lies beside `cover`, the layer above on rows `pitch` apart in the bead's frame.
fn is_seen(bead: &Polyline, cover: Option<&Rows>, pitch: Coord) -> bool {
    let Some(cover) = cover else { return true };
    let is_under = |point: &&LinePoint| {
        let row = cover.row((point.v + pitch / 2).div_euclid(pitch));
        row.iter().any(|span| span.start <= point.u && point.u <= span.end)
    };
    2 * bead.iter().filter(is_under).count() < bead.len()
}

/// The part of `skin` that is seen.
fn seen(skin: &Rows, cover: Option<&Rows>, width: Coord) -> Rows {
    let Some(cover) = cover else { return skin.clone() };
    let long = |_, span: Span| span.len() >= NOISE;
    let hidden = skin.and(cover).filter(long);
    if hidden.is_empty() {
        return skin.clone();
    }
    let bare = skin.minus(&hidden).filter(long);
    let half = NARROW_TOP * width / 2;
    // Of a wide place some row or other has a long stretch.
    if bare.filter(|_, span| span.len() >= i64::from(half)).is_empty() {
        return Rows::default();
    }
    let inmost = bare.minus(&hidden.dilate(half, width));
    if inmost.is_empty() {
        return inmost;
    }
    let top = skin.and(&inmost.dilate(half + width, width));
    let rest = skin.minus(&top);
    let inmost = rest.minus(&top.dilate(half, width));
    skin.minus(&rest.and(&inmost.dilate(half, width)))
}

#[cfg(test)]
mod tests {
    use super::*;

    const WIDTH: Coord = 4_000;

    /// Rows `from..to`, each with these spans.
    fn rows(from: i32, to: i32, spans: &[(Coord, Coord)]) -> Rows {
        let mut rows = Rows::starting_at(from);
        for _ in from..to {
            rows.push_row(|row| row.extend(spans.iter().filter_map(|&(a, b)| Span::new(a, b))));
        }
        rows
    }

    fn parts(cover: Option<&Rows>) -> Vec<(i64, bool)> {
        let skin = [0, 1].map(|_| Arc::new(rows(0, 50, &[(0, 200_000)])));
        let parts = divide(skin, [cover, cover], (WIDTH, 1_600));
        parts.iter().map(|([rows, _], top)| (rows.total() / 50, *top)).collect()
    }

    #[test]
    fn what_nothing_covers_is_seen_and_reaches_under_what_stands_on_it() {
        assert_eq!(parts(None), [(200_000, true)]);
        assert_eq!(parts(Some(&rows(0, 50, &[(0, 200_000)]))), [(200_000, false)]);
        assert_eq!(parts(Some(&rows(0, 50, &[(0, 100_000)]))), [(95_200, false), (104_000, true)]);
    }

    #[test]
    fn both_parts_have_the_columns_that_rows_cross_and_share_the_others() {
        let whole = rows(0, 2, &[(500, 90_000), (100_500, 103_500)]);
        let own = rows(0, 2, &[(500, 10_000)]);
        let columns = columns_of(&own, &whole, WIDTH);
        assert_eq!(columns.row(0), [Span { start: 500, end: 90_000 }]);
        let own = rows(0, 2, &[(80_000, 103_500)]);
        assert_eq!(columns_of(&own, &whole, WIDTH).row(1), whole.row(1));
    }

    #[test]
    fn beads_are_seen_where_most_of_them_lies_beside_what_is_above() {
        let bead = |us: [Coord; 3]| us.map(|u| LinePoint { u, v: 10_000, width: WIDTH }).to_vec();
        let cover = rows(0, 50, &[(0, 100_000)]);
        let seen = |us| is_seen(&bead(us), Some(&cover), WIDTH);
        assert!(seen([90_000, 110_000, 120_000]) && !seen([80_000, 90_000, 120_000]));
        assert!(is_seen(&bead([0; 3]), None, WIDTH));
    }

    #[test]
    fn narrow_strips_are_no_part_of_their_own() {
        assert_eq!(parts(Some(&rows(0, 50, &[(0, 195_000)]))), [(200_000, false)]);
        assert_eq!(parts(Some(&rows(0, 50, &[(0, 9_000)]))), [(200_000, true)]);
    }
}
