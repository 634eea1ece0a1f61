//! Two layers -> tests: bridges of layers made from rectangles.

use super::*;
use crate::geom::Contour;
use crate::profile;
use crate::region::prepare::prepare;
use crate::units::{to_mm, to_units};
use proptest::prelude::*;

pub(super) fn rectangle(x: [f64; 2], y: [f64; 2]) -> Contour {
    let corners = [(x[0], y[0]), (x[1], y[0]), (x[1], y[1]), (x[0], y[1])];
    corners.map(|(x, y)| Point { x: to_units(x), y: to_units(y) }).into()
}

pub(super) fn params() -> RegionParams {
    let mut settings = profile::load(["generic-marlin"], &[]).unwrap().settings;
    settings.angle = profile::Angle::Degrees(0.0);
    RegionParams::new(&settings)
}

/// The bridges of a layer with contours `upper` on one with `lower`, all turned by `degrees`.
fn turned(upper: &[Contour], lower: &[Contour], degrees: f64, params: &RegionParams) -> Vec<Skin> {
    let turn = Frame::new(degrees);
    let layer = |index: usize, contours: &[Contour]| {
        let turned = |c: &Contour| -> Contour { c.iter().map(|p| turn.leave(*p)).collect() };
        let contours = contours.iter().map(turned).collect();
        prepare(Layer { index, z: 0, height: 2_000, contours, closed_gap: 0 }, params)
    };
    let ((below, below_rows), (own, rows)) = (layer(0, lower), layer(1, upper));
    let layers = |k: usize| [&below_rows, &rows].get(k).copied();
    let pair = Pair { own: &own, below: &below.layer, beads: &[] };
    Open::new(1, &layers, params).map(|open| bridges(pair, open, params)).unwrap_or_default()
}

/// The spans of all lines, mm.
fn lines(bridge: &Skin) -> Vec<(f64, f64)> {
    let rows = bridge.rows.skin.iter();
    rows.flat_map(|(_, row)| row.iter().map(|s| (to_mm(s.start), to_mm(s.end)))).collect()
}

proptest! {
    /// However a bridge is turned, each of its lines reaches 2 mm onto both pillars. It is longer than
    /// wide: lines of a square one may run a step askew.
    #[test]
    fn lines_reach_onto_both_pillars(
        degrees in 0.0_f64..180.0,
        half in 8.0_f64..30.0,
        width in 8.0_f64..13.0,
    ) {
        let plate = rectangle([-half - 6.0, half + 6.0], [-width / 2.0, width / 2.0]);
        let pillar = |x: [f64; 2]| rectangle(x, [-width / 2.0, width / 2.0]);
        let pillars = [pillar([-half - 6.0, -half]), pillar([half, half + 6.0])];
        let found = turned(&[plate], &pillars, degrees, &params());
        prop_assert_eq!(found.len(), 1);
        let raster = found[0].raster;
        let back = Frame::new(degrees);
        let x = |u: Coord, j: i32| {
            let at = raster.frame.leave(Point { x: u, y: j * raster.pitch });
            to_mm(back.enter(at).x).abs()
        };
        let reaches = |x: f64| (x - half - 2.0).abs() < 0.3;
        let lines = || found[0].rows.skin.iter().flat_map(|(j, row)| row.iter().map(move |s| (j, s)));
        let held = lines().filter(|(j, s)| reaches(x(s.start, *j)) && reaches(x(s.end, *j)));
        // All the width inside the walls. At the sides rows may see the edges differently.
        prop_assert!(lines().count() as f64 * 0.45 > width - 2.5);
        prop_assert!(held.count() * 10 >= lines().count() * 7, "{:?}", found[0].rows.skin);
    }
}

#[test]
fn what_is_carried_is_no_bridge() {
    let plate = || vec![rectangle([-20.0, 20.0], [-10.0, 10.0])];
    assert!(turned(&plate(), &plate(), 0.0, &params()).is_empty());
    let slope = rectangle([-19.5, 20.0], [-10.0, 10.0]);
    assert!(turned(&plate(), &[slope], 0.0, &params()).is_empty());
}

#[test]
fn no_line_jumps_over_a_hole_to_reach_its_anchor() {
    // A hole in the plate, 1 mm beyond the pillar's edge.
    let plate = rectangle([-20.0, 20.0], [-10.0, 10.0]);
    let hole = rectangle([10.5, 12.0], [-5.0, 5.0]).into_iter().rev().collect();
    let pillars =
        [rectangle([-20.0, -10.0], [-10.0, 10.0]), rectangle([10.0, 20.0], [-10.0, 10.0])];
    let found = turned(&[plate, hole], &pillars, 0.0, &params());
    let middle = found[0].rows.skin.row(0);
    assert_eq!(middle.len(), 1);
    // The frame may be turned by half.
    let ends = [-middle[0].start, middle[0].end].map(to_mm);
    assert!(ends[0].min(ends[1]) < 10.5 && ends[0].max(ends[1]) > 11.8, "{middle:?}");
}

#[test]
fn islands_with_gaps_of_their_own_get_directions_of_their_own() {
    // A plate over two openings: one longer in x, the other in y.
    let plate = rectangle([-40.0, 40.0], [-20.0, 20.0]);
    let hole = |x, y| -> Contour { rectangle(x, y).into_iter().rev().collect() };
    let below =
        [plate.clone(), hole([-35.0, -5.0], [-3.0, 3.0]), hole([15.0, 21.0], [-15.0, 15.0])];
    let found = turned(&[plate], &below, 0.0, &params());
    assert_eq!(found.len(), 2);
    for bridge in found {
        let longest = lines(&bridge).iter().map(|(a, b)| b - a).fold(0.0, f64::max);
        assert!((longest - 10.0).abs() < 0.2, "{longest}");
    }
}

#[test]
fn a_bridge_has_a_line_beside_its_opening_on_both_sides() {
    let plate = rectangle([-40.0, 40.0], [-20.0, 20.0]);
    for half in [10.0, 12.3, 15.1] {
        let hole = rectangle([-half, half], [-3.0, 3.0]).into_iter().rev().collect();
        let params = params();
        let found = turned(std::slice::from_ref(&plate), &[plate.clone(), hole], 0.0, &params);
        let rows = found[0].rows.skin.iter().filter(|(_, row)| !row.is_empty());
        let aside: Vec<f64> = rows.map(|(j, _)| to_mm(j * found[0].raster.pitch)).collect();
        let edge = half + to_mm(params.insets.cover);
        let (first, last) = (aside[0], aside[aside.len() - 1]);
        assert!(first < -edge && last > edge, "{half}: {first} to {last}");
    }
}

#[test]
fn a_place_between_two_rows_takes_nothing_from_other_lines() {
    let params = params();
    let mut between = 0;
    for shift in 0..9 {
        // A notch in the edge of the layer below, which reaches 0.1 mm under what lies inside the walls.
        let edge = 20.0 + f64::from(shift) / 20.0;
        let plate = rectangle([-20.0, edge], [-10.0, 10.0]);
        let depth = edge - to_mm(params.insets.fill - params.insets.cover) - 0.1;
        let notch = [(edge, -3.0), (depth, -3.0), (depth, 3.0), (edge, 3.0)];
        let notch = notch.map(|(x, y)| Point { x: to_units(x), y: to_units(y) });
        let mut below = plate.clone();
        below.splice(2..2, notch);
        for bridge in turned(&[plate], &[below], 0.0, &params) {
            between += i32::from(lines(&bridge).is_empty());
            let taken = taken(std::slice::from_ref(&bridge), params.rasters.skin(0), &params);
            assert!(!lines(&bridge).is_empty() || taken.is_empty(), "{shift}");
        }
    }
    assert!(between > 0, "no case of this kind");
}
