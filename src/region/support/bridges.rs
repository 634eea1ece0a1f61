//! Overhang + both layers -> the places that bridge, so that they need no support.
//!
//! Words: a *gap* is a stretch of a row where the layer has nothing below it. It is *anchored* if the
//! layer goes on at both ends, over something that is printed.
//!
//! A piece of an overhang bridges if nearly all its rows lie in short anchored gaps, in the direction
//! of the rows or across it. If they lie in anchored gaps that are too long, it bridges from *pier* to
//! pier: strips of support that divide the gaps, across the direction in which its lines will run
//! ([`mod@crate::region::bridge`]).

use super::params::SupportParams;
use super::pieces::{Pieces, turned};
use super::strips::upright;
use crate::geom::islands::Islands;
use crate::geom::spans::{Rows, Span, intersect};
use crate::region::bridge::direction::{self, Site};
use crate::region::bridge::sides::{COUNT, Sides};
use crate::units::Coord;

/// How far the layer must reach over what carries it, in line widths. Less does not hold a line.
const ANCHOR: Coord = 2;

/// By how much a gap may be longer than the longest bridge (0.02 mm), so that rounding does not decide
/// over one that is exactly as long.
const ROUNDING: i64 = 200;

/// Per cent of a piece's length that must bridge: corners are round, and rows touch them.
const MOSTLY: i64 = 95;

/// Lines of a bridge that are askew by no more than so many steps, 15°, still cross the piers.
const ASKEW: usize = 150;

/// `hanging` without the pieces that bridge from place to place of `below`, and without what bridges
/// from pier to pier. Lines of skin run along the rows if `turn` is 0, else across.
pub(super) fn without_bridges(
    hanging: &Rows,
    [layer, below]: [&Rows; 2],
    turn: usize,
    params: &SupportParams,
) -> Rows {
    if params.longest_bridge <= 0 || hanging.is_empty() || below.is_empty() {
        return hanging.clone();
    }
    let (pitch, pieces) = (params.raster().pitch, Pieces::new(hanging));
    let lengths = pieces.lengths(hanging);
    // What was grown by a pitch reaches as far beyond its gap.
    let bridges = |gaps: &Rows, reach: Coord| {
        let mut sums = vec![0; pieces.count()];
        pieces.shared(hanging, &gaps.dilate(reach, pitch), &mut sums);
        (0..pieces.count()).map(|k| 100 * sums[k] >= MOSTLY * lengths[k]).collect::<Vec<bool>>()
    };
    let longest = i64::from(params.longest_bridge) + ROUNDING;
    let rows = gaps([layer, below], params);
    let along = bridges(&rows.filter(|_, gap| gap.len() <= longest), pitch);
    if along.iter().all(|bridges| *bridges) {
        return Rows::default();
    }
    // Across, a gap is known to a row at each edge. Turned back, by three more quarters, it may be
    // short by a row at each edge.
    let [layer_across, below_across] = [layer, below].map(|rows| turned(rows, pitch));
    let columns = gaps([&layer_across, &below_across], params);
    let rough = longest + 2 * i64::from(pitch);
    let short = columns.filter(|_, gap| gap.len() <= rough);
    let across = bridges(&upright(&short, params), 2 * pitch);
    let left = pieces.keep(hanging, |piece| !along[piece] && !across[piece]);
    let is_long = |gaps: &Rows, most: i64| gaps.iter().flat_map(|(_, r)| r).any(|g| g.len() > most);
    if left.is_empty() || !(is_long(&rows, longest) || is_long(&columns, rough)) {
        return left;
    }
    let is_short = |piece: usize| along[piece] || across[piece];
    let far = [bridges(&rows, pitch), bridges(&upright(&columns, params), 2 * pitch)];
    let mut left = pieces.keep(hanging, |k| !is_short(k) && !far[0][k] && !far[1][k]);
    for k in (0..pieces.count()).filter(|k| !is_short(*k) && (far[0][*k] || far[1][*k])) {
        let piece = pieces.keep(hanging, |other| other == k);
        let way = way(&piece, [below, &below_across], turn, params).filter(|way| far[*way][k]);
        let piers = match way {
            Some(0) => piers(&near(&rows, &piece, params), params),
            Some(_) => {
                let near = near(&columns, &turned(&piece, pitch), params);
                upright(&piers(&near, params), params)
            }
            None => piece.clone(),
        };
        left = left.or(&piers.and(&piece));
    }
    left
}

/// Whether the lines of a bridge will run along the rows (0), across them (1), or neither.
fn way(piece: &Rows, below: [&Rows; 2], turn: usize, params: &SupportParams) -> Option<usize> {
    let pitch = params.raster().pitch;
    let open = if turn == 0 { piece.clone() } else { turned(piece, pitch) };
    let islands = Islands::new(&open);
    let site = Site { island: 0, islands: &islands, carrier: below[turn], pitch };
    let best = direction::best(&site, 2 * params.least, &Sides::default()).turn;
    let off = best % COUNT;
    let is_near = |to: usize| off.abs_diff(to) <= ASKEW;
    if is_near(0) || is_near(COUNT) { Some(turn) } else { is_near(COUNT / 2).then_some(1 - turn) }
}

/// The gaps that `piece` lies in.
fn near(gaps: &Rows, piece: &Rows, params: &SupportParams) -> Rows {
    let pitch = params.raster().pitch;
    let near = piece.dilate(pitch, pitch);
    gaps.filter(|j, gap| near.overlapping(j, gap).is_some())
}

/// Strips that divide gaps which are too long.
fn piers(gaps: &Rows, params: &SupportParams) -> Rows {
    // They grow by the outset on both sides.
    let wide = (params.min_width - 2 * params.outset).max(2 * params.least);
    let grown = i64::from(wide + 2 * params.outset);
    let longest = i64::from(params.longest_bridge);
    let mut out = Rows::with_room_of(gaps, gaps.range().start);
    for (_, row) in gaps.iter() {
        out.push_row(|spans| {
            for gap in row.iter().filter(|gap| gap.len() > longest + ROUNDING) {
                // As many as leave no stretch that is too long, and all stretches alike.
                let count = (gap.len() + grown - 1) / (longest + grown);
                let free = (gap.len() - count * grown) / (count + 1);
                let start =
                    |i: i64| gap.start + (i * free + (i - 1) * grown) as Coord + params.outset;
                let pier = |start: Coord| Span { start, end: start + wide };
                spans.extend((1..=count).map(start).map(pier));
            }
        });
    }
    out
}

/// The anchored gaps of a layer.
fn gaps([layer, below]: [&Rows; 2], params: &SupportParams) -> Rows {
    let anchor = i64::from(ANCHOR * params.least);
    let mut carried = Vec::new();
    let mut out = Rows::with_room_of(layer, layer.range().start);
    for (j, row) in layer.iter() {
        out.push_row(|spans| {
            for span in row {
                carried.clear();
                intersect(&[*span], below.row(j), &mut carried);
                carried.retain(|one| one.len() >= anchor);
                let gaps = carried.windows(2).filter_map(|two| Span::new(two[0].end, two[1].start));
                spans.extend(gaps);
            }
        });
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::profile;

    /// A plate of 10 mm over two pillars, with rows along or across the gap.
    fn plate(gap: Coord, is_turned: bool) -> [Rows; 3] {
        let pitch = 2_000;
        let (mut layer, mut below) = (Rows::starting_at(0), Rows::starting_at(0));
        for _ in 0..50 {
            let end = 60_000 + gap;
            layer.push_row(|out| out.push(Span { start: 0, end }));
            below.push_row(|out| {
                out.extend([Span { start: 0, end: 30_000 }, Span { start: 30_000 + gap, end }]);
            });
        }
        let all = [layer.minus(&below), layer, below];
        if is_turned { all.map(|rows| turned(&rows, pitch)) } else { all }
    }

    #[test]
    fn a_plate_between_pillars_bridges_if_it_is_short() {
        let mut settings = profile::load(["generic-marlin"], &[]).unwrap().settings;
        (settings.support.enabled, settings.support.max_bridge) = (true, 15.0);
        let params = SupportParams::new(&settings).unwrap();
        assert_eq!(params.raster().pitch, 2_000);
        for is_turned in [false, true] {
            for (gap, bridges) in
                [(100_000, true), (150_000, true), (150_100, true), (160_000, false)]
            {
                let [hanging, layer, below] = plate(gap, is_turned);
                let left = without_bridges(&hanging, [&layer, &below], 0, &params);
                assert_eq!(left.is_empty(), bridges, "{gap} {is_turned}");
            }
        }
        // A balcony hangs on one side only.
        let [hanging, layer, below] = plate(100_000, false);
        let one = below.filter(|_, span| span.start == 0);
        assert!(!without_bridges(&hanging, [&layer, &one], 0, &params).is_empty());
    }

    #[test]
    fn a_plate_that_is_too_long_bridges_from_pier_to_pier() {
        let mut settings = profile::load(["generic-marlin"], &[]).unwrap().settings;
        (settings.support.enabled, settings.support.max_bridge) = (true, 15.0);
        let params = SupportParams::new(&settings).unwrap();
        for (gap, piers) in [(162_000, 1), (330_000, 1), (350_000, 2), (525_000, 2), (560_000, 3)] {
            for (is_turned, turn) in [(false, 0), (true, 0), (false, 1), (true, 1)] {
                let [hanging, layer, below] = plate(gap, is_turned);
                let left = without_bridges(&hanging, [&layer, &below], turn, &params);
                let left = if is_turned { upright(&left, &params) } else { left };
                let left = left.dilate(params.outset, 2_000);
                assert_eq!(Pieces::new(&left).count(), piers, "{gap} {is_turned}");
                for j in 5..45 {
                    let mut free = Vec::new();
                    let whole = [Span { start: 30_000, end: 30_000 + gap }];
                    crate::geom::spans::subtract(&whole, left.row(j), &mut free);
                    let longest = free.iter().map(|span| span.len()).max().unwrap();
                    assert!(longest <= 150_000 + 8_000, "{gap} {is_turned}: {free:?}");
                    assert!(left.row(j).iter().all(|span| span.len() <= 50_000));
                }
            }
        }
    }
}
