//! Overhang + both layers -> the places that bridge, so that they need no support.
//!
//! Words: a *gap* is a stretch of a row where the layer has nothing below it. It is *anchored* if the
//! layer goes on at both ends, over something that is printed.
//!
//! A piece of an overhang bridges if nearly all its rows lie in short anchored gaps, in the direction
//! of the rows or across it.

use super::params::SupportParams;
use super::pieces::{Pieces, turned};
use crate::geom::spans::{Rows, Span, intersect, subtract};
use crate::units::Coord;

/// How far the layer must reach over what carries it, in line widths. Less does not hold a line.
const ANCHOR: Coord = 2;

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
    let pieces = Pieces::new(hanging);
    let lengths = pieces.lengths(hanging);
    let along = bridged(hanging, [layer, below], params);
    let bridges = |bridged: &Rows| {
        let mut sums = vec![0; pieces.count()];
        pieces.shared(hanging, bridged, &mut sums);
        (0..pieces.count()).map(|k| 100 * sums[k] >= MOSTLY * lengths[k]).collect::<Vec<bool>>()
    };
    let along = bridges(&along);
    if along.iter().all(|bridges| *bridges) {
        return Rows::default();
    }
    let pitch = params.raster().pitch;
    let [hanging_across, layer, below] = [hanging, layer, below].map(|rows| turned(rows, pitch));
    let across = bridged(&hanging_across, [&layer, &below], params);
    // Turned back, it lies on the same rows as before but for one at each edge.
    let back = turned(&turned(&turned(&across, pitch), pitch), pitch).dilate(pitch, pitch);
    let across = bridges(&back);
    pieces.keep(hanging, |piece| !along[piece] && !across[piece])
}

/// What of `hanging` lies in short anchored gaps, and what lies beside the layer: that was grown.
fn bridged(hanging: &Rows, [layer, below]: [&Rows; 2], params: &SupportParams) -> Rows {
    let anchor = i64::from(ANCHOR * params.least);
    let mut out = Rows::with_room_of(hanging, hanging.range().start);
    let (mut carried, mut good) = (Vec::new(), Vec::new());
    for (j, row) in hanging.iter() {
        good.clear();
        let mut beside = Span { start: Coord::MIN / 2, end: Coord::MIN / 2 };
        for &span in layer.row(j) {
            good.extend(Span::new(beside.end, span.start));
            beside = span;
            carried.clear();
            intersect(&[span], below.row(j), &mut carried);
            for ends in carried.windows(2).filter(|two| two.iter().all(|one| one.len() >= anchor)) {
                let gap = Span::new(ends[0].end, ends[1].start);
                good.extend(gap.filter(|gap| gap.len() <= i64::from(params.longest_bridge)));
            }
        }
        good.extend(Span::new(beside.end, Coord::MAX / 2));
        let mut merged = Vec::new();
        crate::geom::spans::merge(&mut good, &mut merged);
        // What lies over something is no gap; only growing brought it here.
        out.push_row(|spans| {
            let mut rest = Vec::new();
            subtract(row, below.row(j), &mut rest);
            let mut bad = Vec::new();
            subtract(&rest, &merged, &mut bad);
            subtract(row, &bad, spans);
        });
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::profile;

    /// A plate of 10 mm over two pillars and a beam at one end, with rows along or across the gap.
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
        let set = [("support.enabled", "true"), ("support.max_bridge", "15")];
        let set = set.map(|(key, value)| (key.to_owned(), value.to_owned()));
        let settings = profile::load(["generic-marlin"], &set).unwrap().settings;
        let params = SupportParams::new(&settings).unwrap();
        assert_eq!(params.raster().pitch, 2_000);
        for is_turned in [false, true] {
            for (gap, bridges) in [(100_000, true), (160_000, false)] {
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
