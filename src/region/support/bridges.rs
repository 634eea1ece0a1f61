//! Overhang + both layers -> the places that bridge, so that they need no support.
//!
//! Words: a *gap* is a stretch of a row where the layer has nothing below it. It is *anchored* if the
//! layer goes on at both ends, over something that is printed.
//!
//! A piece of an overhang bridges if nearly all its rows lie in short anchored gaps, in the direction
//! of the rows or across it.

use super::params::SupportParams;
use super::pieces::{Pieces, turned};
use crate::geom::spans::{Rows, Span, intersect};
use crate::units::Coord;

/// How far the layer must reach over what carries it, in line widths. Less does not hold a line.
const ANCHOR: Coord = 2;

/// By how much a gap may be longer than the longest bridge (0.02 mm), so that rounding does not decide
/// over one that is exactly as long.
const ROUNDING: i64 = 200;

/// Per cent of a piece's length that must bridge: corners are round, and rows touch them.
const MOSTLY: i64 = 95;

/// `hanging` without the pieces that bridge from place to place of `below`.
pub(super) fn without_bridges(
    hanging: &Rows,
    [layer, below]: [&Rows; 2],
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
    let along = bridges(&gaps([layer, below], params, ROUNDING), pitch);
    if along.iter().all(|bridges| *bridges) {
        return Rows::default();
    }
    let [layer, below] = [layer, below].map(|rows| turned(rows, pitch));
    // Across, a gap is known to a row at each edge.
    let across = gaps([&layer, &below], params, ROUNDING + 2 * i64::from(pitch));
    // Turned back, by three more quarters, it may be short by a row at each edge.
    let across = (0..3).fold(across, |rows, _| turned(&rows, pitch));
    let across = bridges(&across, 2 * pitch);
    pieces.keep(hanging, |piece| !along[piece] && !across[piece])
}

/// The anchored gaps of a layer that exceed the longest bridge by no more than `slack`.
fn gaps([layer, below]: [&Rows; 2], params: &SupportParams, slack: i64) -> Rows {
    let anchor = i64::from(ANCHOR * params.least);
    let longest = i64::from(params.longest_bridge) + slack;
    let mut carried = Vec::new();
    let mut out = Rows::with_room_of(layer, layer.range().start);
    for (j, row) in layer.iter() {
        out.push_row(|spans| {
            for span in row {
                carried.clear();
                intersect(&[*span], below.row(j), &mut carried);
                carried.retain(|one| one.len() >= anchor);
                let gaps = carried.windows(2).filter_map(|two| Span::new(two[0].end, two[1].start));
                spans.extend(gaps.filter(|gap| gap.len() <= longest));
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
                let left = without_bridges(&hanging, [&layer, &below], &params);
                assert_eq!(left.is_empty(), bridges, "{gap} {is_turned}");
            }
        }
        // A balcony hangs on one side only.
        let [hanging, layer, below] = plate(100_000, false);
        let one = below.filter(|_, span| span.start == 0);
        assert!(!without_bridges(&hanging, [&layer, &one], &params).is_empty());
    }
}
