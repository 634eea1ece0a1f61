//! Columns, from the bed up -> Columns: what nothing carries is cut off.
//!
//! Beside the part, and over its slopes, support ends a clearance away from it. So strips of it lose
//! what they would stand on. Each layer may reach a little beyond what it stands on, the layer below
//! or a *foot* on the part. What is further out would be printed in the air, and is left out, with
//! all that would stand on it.

use super::columns::Column;
use super::params::{LEAN, SupportParams};
use super::pieces::{with_lines, without_specks};
use crate::geom::spans::Rows;

/// Cuts off what nothing carries, and specks.
pub(super) fn stand(columns: &mut [Column], params: &SupportParams) {
    // The brim makes pieces on the bed wide enough.
    if let Some(lowest) = columns.first_mut().filter(|_| params.brim <= 0) {
        lowest.all = without_specks(&lowest.all, params);
    }
    for k in 1..columns.len() {
        let [below, here] = &mut columns[k - 1..=k] else { continue };
        here.all = without_specks(&here.all, params);
        let falls = falls(&here.all, [&below.all, &here.foot], params);
        if !falls.is_empty() {
            here.all = without_specks(&here.all.minus(&falls), params);
            here.reach = here.reach.minus(&falls);
        }
    }
}

/// Cuts off what nothing carries of what is added beside the support. There is none of it around strips,
/// which hold themselves, nor beside a piece that has none of the support.
pub(super) fn stand_beside(columns: &mut [Column], strips: &[Rows], params: &SupportParams) {
    let far = params.lines.stride * params.raster().pitch;
    for (k, strips) in strips.iter().enumerate() {
        let (lower, here) = columns.split_at_mut(k);
        let Some(here) = here.first_mut().filter(|here| !here.beside.is_empty()) else { continue };
        if !strips.is_empty() {
            here.beside = here.beside.minus(&strips.dilate(far, params.raster().pitch));
        }
        if let Some(below) = lower.last() {
            let carriers = below.all.or(&below.beside);
            let falls = falls(&here.beside, [&carriers, &here.foot], params);
            here.beside = here.beside.minus(&falls);
        }
        here.beside = with_lines(&here.all, &here.beside).minus(&here.all);
    }
}

/// What of `rows` lies too far from what carries it.
fn falls(rows: &Rows, carriers: [&Rows; 2], params: &SupportParams) -> Rows {
    let (lean, pitch) = (LEAN * params.least, params.raster().pitch);
    let hanging = rows.minus(carriers[0]).minus(carriers[1]);
    if hanging.is_empty() {
        return hanging;
    }
    // Only what is near counts, and there is little of it.
    let around = hanging.dilate(lean, pitch);
    let carriers = carriers[0].or(carriers[1]).and(&around).dilate(lean, pitch);
    hanging.minus(&carriers)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::spans::{Span, merge};
    use crate::profile;
    use proptest::prelude::*;

    /// Cells of 1.6 mm, on rows of the raster.
    fn cells(masks: &[u16]) -> Rows {
        let mut rows = Rows::starting_at(0);
        for mask in masks.iter().flat_map(|mask| std::iter::repeat_n(mask, 8)) {
            let of = |i: i32| Span { start: 16_000 * i, end: 16_000 * (i + 1) };
            let mut spans: Vec<Span> = (0..16).filter(|i| mask >> i & 1 == 1).map(of).collect();
            rows.push_row(|out| merge(&mut spans, out));
        }
        rows
    }

    proptest! {
        #[test]
        fn each_layer_stands_on_the_one_below_or_on_a_foot(
            layers in prop::collection::vec(prop::collection::vec(any::<u16>(), 5), 1..6),
            feet in prop::collection::vec(prop::collection::vec(any::<u16>(), 5), 6),
        ) {
            let mut settings = profile::load(["generic-marlin"], &[]).unwrap().settings;
            settings.support.enabled = true;
            let params = SupportParams::new(&settings).unwrap();
            let column = |(masks, feet): (&Vec<u16>, &Vec<u16>)| {
                let all = cells(masks);
                Column { foot: cells(feet).and(&all), reach: all.clone(), all, ..Column::default() }
            };
            let before: Vec<Column> = layers.iter().zip(&feet).map(column).collect();
            let mut after = before.clone();
            stand(&mut after, &params);
            for k in 0..after.len() {
                prop_assert!(after[k].all.minus(&before[k].all).is_empty());
                let Some(below) = k.checked_sub(1) else { continue };
                let carriers = after[below].all.or(&after[k].foot);
                let carriers = carriers.dilate(params.least, params.raster().pitch);
                prop_assert!(after[k].all.minus(&carriers).is_empty(), "layer {k}");
            }
        }
    }
}
