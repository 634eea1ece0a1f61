//! Solids made by hand -> what of their tops becomes skin, and why the rest does not.
//!
//! - A *body* is a grid of columns whose tops are as high as a formula says.
//! - A *ramp* rises evenly, a *wave* up and down, a *boss* stands on either.
//! - What is *passed* are the patches that the whole way from mesh to patch gives.
//!
//! 1. Make bodies, put them on a bed, and find their patches with a head and some parameters.
//! 2. Look at what holds of all patches: numbers in order, outlines within each other, travels above the layer.
//! 3. Look at the share of a box that is skin, and at the reasons of the rest.

use super::params::NonPlanarParams;
use super::surface::find::surfaces;
use super::*;
use crate::geom::{Point, polygon};
use crate::head::Head;
use crate::head::named::named;
use crate::mesh::edges::MAX_TRIANGLES;
use crate::mesh::place::{Placed, place};
use crate::mesh::{Bed, MeshReport, Placement, Policy, RawMesh, Unit};
use crate::slice::{Heights, Slicer};
use crate::units::{Coord, to_units};

const BED: Bed = Bed { min: [-150.0, -150.0], max: [150.0, 150.0], height: 200.0 };

fn head(name: &str) -> Head {
    named(name).unwrap()
}

fn params(head: Head) -> NonPlanarParams {
    NonPlanarParams {
        skins: 2,
        height: 2_000,
        line_width: 4_000,
        nozzle: 4_000,
        slopes: 0.5..=head.steepest().min(head.steepest_press(0.2)),
        max_bend: 30.0,
        min_area: 20.0,
        directions: Some(vec![0.0, 90.0]),
        wall: 0,
        tolerance: 50,
        segment: 20_000,
        shortest: 500,
        clearance: 5_000,
        outline: 0,
        beyond: 0,
        head,
    }
}

/// A body on a grid of columns from `low` on, `step` apart, whose top is as high as `z` says, mm.
fn body(
    low: [f64; 2],
    (columns, rows, step): (usize, usize, f64),
    z: impl Fn(f64, f64) -> f64,
) -> RawMesh {
    let mut vertices: Vec<[f32; 3]> = Vec::new();
    for top in [false, true] {
        for j in 0..=rows {
            for i in 0..=columns {
                let (x, y) = (low[0] + i as f64 * step, low[1] + j as f64 * step);
                let height = if top { z(x, y) } else { 0.0 };
                vertices.push([x as f32, y as f32, height as f32]);
            }
        }
    }
    let wide = columns + 1;
    let at = |top: bool, i: usize, j: usize| {
        let layer = if top { wide * (rows + 1) } else { 0 };
        (layer + j * wide + i) as u32
    };
    let mut triangles: Vec<[u32; 3]> = Vec::new();
    let mut quad = |[a, b, c, d]: [u32; 4]| triangles.extend([[a, b, c], [a, c, d]]);
    for j in 0..rows {
        for i in 0..columns {
            quad([at(true, i, j), at(true, i + 1, j), at(true, i + 1, j + 1), at(true, i, j + 1)]);
            quad([
                at(false, i, j),
                at(false, i, j + 1),
                at(false, i + 1, j + 1),
                at(false, i + 1, j),
            ]);
        }
    }
    let mut side = |a: (usize, usize), b: (usize, usize)| {
        quad([at(false, a.0, a.1), at(false, b.0, b.1), at(true, b.0, b.1), at(true, a.0, a.1)]);
    };
    for i in 0..columns {
        side((i, 0), (i + 1, 0));
        side((i + 1, rows), (i, rows));
    }
    for j in 0..rows {
        side((columns, j), (columns, j + 1));
        side((0, j + 1), (0, j));
    }
    let report = MeshReport { file: "x.stl".to_owned(), ..MeshReport::default() };
    RawMesh { vertices, triangles, report, ..RawMesh::default() }
}

/// One model of several bodies.
fn joined(bodies: Vec<RawMesh>) -> RawMesh {
    let mut out = RawMesh::default();
    for body in bodies {
        let first = out.vertices.len() as u32;
        out.vertices.extend(body.vertices);
        out.triangles.extend(body.triangles.iter().map(|t| t.map(|v| v + first)));
        out.report = body.report;
    }
    out
}

fn placed(models: Vec<RawMesh>, copies: u32) -> Placed {
    spaced(models, copies, 5.0)
}

fn spaced(models: Vec<RawMesh>, copies: u32, gap: f64) -> Placed {
    let placement = Placement {
        sink: 0.0,
        unit: Unit::Mm,
        scale: 1.0,
        stretch: [1.0; 3],
        rotate: [0.0; 3],
        at: None,
        gap,
        taken: Vec::new(),
        copies,
        max_triangles: MAX_TRIANGLES,
        policy: Policy::Repair,
    };
    place(models, &placement, &BED).unwrap_or_else(|error| panic!("{error}"))
}

/// What becomes of the tops of a model.
fn passed(placed: &Placed, params: &NonPlanarParams) -> Patches {
    under(placed, params, to_units(BED.height), None)
}

/// The same under a ceiling, with support.
fn under(
    placed: &Placed,
    params: &NonPlanarParams,
    ceiling: Coord,
    support: Option<Props<'_>>,
) -> Patches {
    let (h, top) = (params.height, placed.mesh.top());
    let heights = Heights::even(h, h, top);
    let slicer = Slicer::new(&placed.mesh, &placed.adjacency, heights, 20);
    let surfaces = surfaces(&placed.mesh, &placed.adjacency, params);
    let scene = Scene {
        slicer: &slicer,
        surfaces: &surfaces,
        bodies: &placed.bodies,
        support,
        skirt: None,
        ceiling,
        params,
    };
    let out = patches_and_fields(&scene).0;
    let sum = out.mm2.total();
    assert!(
        (sum - surfaces.tops.all).abs() < 0.01 * surfaces.tops.all,
        "{sum} {:?}",
        surfaces.tops
    );
    check(&out, slicer.heights());
    out
}

/// What holds for all patches.
fn check(patches: &Patches, heights: &Heights) {
    let mut last = 0;
    for (number, patch) in (1..).zip(&patches.patches) {
        assert_eq!(patch.number, number);
        assert!(patch.layer >= last);
        last = patch.layer;
        for two in patch.areas.windows(2) {
            let out = crate::geom::polygon::difference(&two[0], &two[1], 20);
            assert!(grid::area_mm2(&out) < 0.1, "{}", grid::area_mm2(&out));
        }
        let top = heights.top(patch.layer);
        let first = patch.strokes.first().unwrap();
        assert!(first.over > top);
        let highest = |stroke: &Stroke| stroke.path.points.iter().map(|p| p.z + top).max().unwrap();
        let most = patch.strokes.iter().map(highest).max().unwrap();
        assert!((most - patch.bounds[1]).abs() < 1_200, "{most} {:?}", patch.bounds);
    }
}

fn tan(degrees: f64) -> f64 {
    libm::tan(degrees.to_radians())
}

/// The share of a patch's area in a box of plan, mm.
fn share(out: &Patches, skin: usize, low: [f64; 2], high: [f64; 2]) -> f64 {
    let p = |x: f64, y: f64| Point { x: to_units(x), y: to_units(y) };
    let area =
        vec![vec![p(low[0], low[1]), p(high[0], low[1]), p(high[0], high[1]), p(low[0], high[1])]];
    let inside = |patch: &Patch| grid::area_mm2(&polygon::intersection(&area, &patch.areas[skin]));
    out.patches.iter().map(inside).sum::<f64>() / grid::area_mm2(&area)
}

#[test]
fn a_wedge_is_taken_whole() {
    let wedge = body([0.0, 0.0], (20, 10, 1.0), |x, _| 2.0 + x * tan(4.76));
    let out = passed(&placed(vec![wedge], 1), &params(head("long-0.6")));
    assert_eq!(out.patches.len(), 1);
    assert!(out.mm2.skin > 0.999 * out.mm2.total());
    let patch = &out.patches[0];
    assert_eq!(patch.areas[0], patch.areas[1]);
    assert_eq!(patch.directions, [0.0, 90.0]);
    assert!((patch.steepest - 4.76).abs() < 0.05, "{}", patch.steepest);
    // The base is whole, and nothing stands higher than the wedge's top.
    assert!((patch.bounds[1] - to_units(2.0 + 20.0 * tan(4.76))).abs() < 5);
    assert_eq!(patch.layer, 16);
    assert!(17 * 2_000 < patch.bounds[1]);
}

#[test]
fn threads_change_nothing() {
    let wave = |x: f64, y: f64| {
        let is_boss = (x - 2.0).abs() < 1.1 && (y - 4.0).abs() < 1.1;
        if is_boss { 9.0 } else { 4.0 + libm::sin(x / 4.0) }
    };
    let placed = placed(vec![body([0.0, 0.0], (20, 16, 0.5), wave)], 2);
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| passed(&placed, &params(head("v6"))))
    };
    let one = with(1);
    assert!(one.mm2.skin > 100.0, "{:?}", one.mm2);
    assert_eq!(one, with(3));
}

#[test]
fn a_slope_ends_where_the_bed_is_too_near() {
    let wedge = body([0.0, 0.0], (20, 10, 1.0), |x, _| 0.05 + x * tan(5.0));
    let out = passed(&placed(vec![wedge], 1), &params(head("long-0.6")));
    // Two skins and half a first layer.
    let lost = (0.5 - 0.05) / tan(5.0);
    let told = out.mm2.of(Reason::Overhang) / 10.0;
    assert!((told - lost).abs() < 0.3, "{told} {lost}");
}

#[test]
fn a_wave_with_a_boss_loses_a_ring() {
    let wave = |x: f64, y: f64| {
        let z = 4.0 + 1.0 * libm::sin(x / 6.0) + 0.3 * libm::cos(y / 5.0);
        let is_boss = (x - 10.0).abs() < 2.1 && (y - 8.0).abs() < 2.1;
        if is_boss { 12.0 } else { z }
    };
    let model = body([0.0, 0.0], (40, 32, 0.5), wave);
    let out = passed(&placed(vec![model], 1), &params(head("long-0.6")));
    let lost = out.mm2.of(Reason::Obstacle);
    // The boss is 5 mm wide with its flanks, and stands 2.6 mm over the lowest place. The nozzle's flank
    // of 60 degrees then keeps 0.5 + 1.5 mm off.
    assert!(lost > 5.0 && lost < 9.0 * 9.0 - 25.0, "{lost}");
    assert!(share(&out, 1, [-2.0, -2.0], [2.0, 2.0]) < 1e-3);
    assert!(share(&out, 1, [-10.0, -8.0], [-5.0, 8.0]) > 0.98);
    assert!(share(&out, 1, [5.0, -8.0], [10.0, 8.0]) > 0.98);
}

#[test]
fn what_stands_beside_a_ramp_keeps_the_head_off() {
    let bodies = |beside: f64| {
        let low = body([0.0, 0.0], (5, 10, 1.0), |_, _| 3.0);
        let ramp = body([5.5, 0.0], (15, 10, 1.0), |x, _| 2.0 + (x - 5.5) * tan(8.0));
        let high = body([21.0, 0.0], (5, 10, 1.0), |_, _| 12.0);
        let wall = body([5.5, 10.0 + beside], (15, 3, 1.0), |_, _| 20.0);
        vec![low, ramp, high, wall]
    };
    let v6 = params(head("v6"));
    let near = passed(&placed(vec![joined(bodies(0.6))], 1), &v6);
    let far = passed(&placed(vec![joined(bodies(9.0))], 1), &v6);
    // One model: an obstacle. Beside the low end the wall is higher than the nozzle by the ramp's rise.
    assert!(near.mm2.of(Reason::Obstacle) > far.mm2.of(Reason::Obstacle) + 5.0);
    assert!(near.mm2.skin > 0.6 * 15.0 * 10.0 && far.mm2.skin > 0.9 * 15.0 * 10.0);
    // Several models: neighbours, whose layers come at the same time.
    let [low, ramp, high, wall] = bodies(0.0).try_into().unwrap();
    let wedge = |x: f64, _: f64| 2.0 + x * tan(12.0);
    let two = vec![body([0.0, 0.0], (20, 6, 1.0), wedge), joined(vec![low, ramp, high, wall])];
    let out = passed(&spaced(two, 1, 0.6), &v6);
    assert!(out.mm2.of(Reason::Neighbour) > 1.0, "{:?}", out.mm2);
}

#[test]
fn a_cautious_head_refuses_ten_degrees() {
    let wedge = body([0.0, 0.0], (40, 6, 1.0), |x, _| 2.0 + x * tan(10.0));
    let mut cautious = params(head("cautious"));
    let out = passed(&placed(vec![wedge.clone()], 1), &cautious);
    assert!(out.patches.is_empty() && out.mm2.of(Reason::Slope) > 200.0);
    // Asked all the same: all that hangs 3 mm over the tip touches what is higher by that.
    cautious.slopes = 0.5..=21.8;
    let out = passed(&placed(vec![wedge], 1), &cautious);
    assert!(out.mm2.of(Reason::Cone) > 50.0);
    let kept = out.mm2.skin / 6.0 * libm::cos(10.0_f64.to_radians());
    assert!((kept - 3.0 / tan(10.0)).abs() < 1.0, "{kept}");
}

#[test]
fn a_ramp_goes_up_to_its_plateau() {
    let ramp = |x: f64, _: f64| 2.0 + x.clamp(3.0, 13.0) * tan(10.0);
    for skins in [1, 2, 3, 4] {
        let params = NonPlanarParams { skins, ..params(head("long-0.6")) };
        let out = passed(&placed(vec![body([0.0, 0.0], (16, 6, 1.0), ramp)], 1), &params);
        assert!(out.mm2.skin > 0.999 * (out.mm2.total() - out.mm2.level), "{skins} {:?}", out.mm2);
    }
}

#[test]
fn thick_skins_leave_no_stripes() {
    let wedge = body([0.0, 0.0], (20, 6, 1.0), |x, _| 2.0 + x * tan(5.0));
    let params = NonPlanarParams { height: 3_000, ..params(head("long-0.6")) };
    // Treads of 0.3 mm leave 0.45 mm of room, and the bore is 0.4 mm.
    assert_eq!(params.raised(), 500);
    let out = passed(&placed(vec![wedge], 1), &params);
    assert!(out.mm2.skin > 0.999 * out.mm2.total(), "{:?}", out.mm2);
}

#[test]
fn what_is_too_steep_leaves_the_rest() {
    // A saddle that gets too steep for layers of 0.1 mm at its corners.
    let saddle = |x: f64, y: f64| 4.0 + 0.016 * (x - 10.0) * (y - 10.0);
    let head = head("long-0.6");
    let slopes = 0.5..=head.steepest_press(0.1);
    let params = NonPlanarParams { height: 1_000, slopes, ..params(head) };
    let out = passed(&placed(vec![body([0.0, 0.0], (20, 20, 1.0), saddle)], 1), &params);
    assert!(out.mm2.of(Reason::Press) > 5.0, "{:?}", out.mm2);
    assert!(out.mm2.skin > 0.5 * out.mm2.total(), "{:?}", out.mm2);
    assert!(share(&out, 1, [-5.0, -5.0], [5.0, 5.0]) > 0.98);
}

#[test]
fn what_lies_inside_of_another_body_is_no_skin() {
    let post = body([5.0, 0.0], (10, 8, 1.0), |x, _| 7.5 + x * tan(5.0));
    let mut plate = body([0.0, -2.0], (20, 12, 1.0), |_, _| 5.0);
    plate.vertices.iter_mut().for_each(|v| v[2] += 5.0);
    let out = passed(&placed(vec![joined(vec![post, plate])], 1), &params(head("long-0.6")));
    assert!(out.patches.is_empty(), "{:?}", out.mm2);
    assert!(out.mm2.of(Reason::Obstacle) > 0.9 * 80.0, "{:?}", out.mm2);
}

#[test]
fn a_floor_is_done_before_its_roof() {
    let floor = body([0.0, 0.0], (20, 10, 1.0), |x, _| 2.0 + x * tan(5.0));
    let mut roof = body([8.0, 0.0], (12, 10, 1.0), |_, _| 2.0);
    roof.vertices.iter_mut().for_each(|v| v[2] += 5.0);
    let out =
        passed(&placed(vec![joined(vec![floor.clone(), roof.clone()])], 1), &params(head("v6")));
    assert!(out.mm2.of(Reason::Obstacle) < 1e-9 && out.patches.len() == 1);
    // So near above the floor that it stands in the way already.
    roof.vertices.iter_mut().for_each(|v| v[2] -= 1.9);
    let out = passed(&placed(vec![joined(vec![floor, roof])], 1), &params(head("v6")));
    assert!(out.mm2.skin < 180.0, "{:?}", out.mm2);
}

#[test]
fn flat_zones_do_not_grow() {
    let knob = |x: f64, y: f64| {
        let z = 4.0 + x * tan(10.0);
        if (x - 8.0).hypot(y - 6.0) < 1.2 { z + 2.0 } else { z }
    };
    let model = body([0.0, 0.0], (32, 24, 0.5), knob);
    let out = passed(&placed(vec![model], 1), &params(head("long-0.6")));
    assert_eq!(out.patches.len(), 1);
    let [low, high] =
        [&out.patches[0].areas[0], &out.patches[0].areas[1]].map(|a| grid::area_mm2(a));
    // Around the knob's ring of flat places the first skin keeps off a little more.
    assert!(low < high - 1.0 && low > high - 25.0, "{low} {high}");
    assert!(share(&out, 0, [-8.0, -6.0], [-5.0, 6.0]) > 0.97);
    assert!(share(&out, 0, [5.0, -6.0], [8.0, 6.0]) > 0.97);
}

#[test]
fn what_the_machine_cannot_rise_over_is_flat() {
    let wedge = body([0.0, 0.0], (20, 6, 1.0), |x, _| 2.0 + x * tan(5.0));
    let placed = placed(vec![wedge], 1);
    let out = under(&placed, &params(head("long-0.6")), to_units(3.5), None);
    let told = out.mm2.of(Reason::ZLimit) / 6.0;
    // 0.5 mm over it are no higher than 3.5 mm up to 11.4 mm.
    assert!((told - (20.0 - 1.0 / tan(5.0))).abs() < 0.3, "{told}");
}

#[test]
fn support_stands_on_no_patch() {
    let wedge = body([0.0, 0.0], (20, 6, 1.0), |x, _| 2.0 + x * tan(5.0));
    let placed = placed(vec![wedge], 1);
    // A bar of support over the middle.
    let lines = |k: usize| {
        let ends = [-3.0, 3.0].map(|y| Point { x: 0, y: to_units(y) });
        if k < 10 { Vec::new() } else { vec![ends] }
    };
    let props = Props { lines: &lines, width: 4_000, gap: 2_000 };
    let out = under(&placed, &params(head("long-0.6")), to_units(100.0), Some(props));
    assert!(
        out.mm2.of(Reason::Support) > 6.0 && out.mm2.of(Reason::Support) < 20.0,
        "{:?}",
        out.mm2
    );
    assert!(share(&out, 1, [-0.5, -3.0], [0.5, 3.0]) < 1e-3);
    assert!(out.mm2.skin > 60.0);
}

#[test]
fn what_no_tread_crosses_stays_level() {
    // Rises by 0.06 mm; the middles of layers lie at odd tenths.
    let rim = |low: f64| body([0.0, 0.0], (6, 6, 1.0), move |x, _| low + 0.01 * x);
    let all = |low: f64| passed(&placed(vec![rim(low)], 1), &params(head("long-0.6")));
    let out = all(4.02);
    assert!(out.patches.is_empty() && (out.mm2.level - 36.0).abs() < 0.1, "{:?}", out.mm2);
    let out = all(4.07);
    assert!(out.patches.len() == 1 && out.mm2.level < 1e-9, "{:?}", out.mm2);
}

#[test]
fn a_refused_summit_does_not_keep_the_rest_waiting() {
    // The upper half of the ramp lies inside of a tower, which would stand 3 mm over the lower half if that
    // waited for the summit.
    let ramp = body([0.0, 0.0], (30, 12, 1.0), |x, _| 2.0 + x * tan(10.0));
    let tower = body([15.0, -1.0], (17, 14, 1.0), |_, _| 12.0);
    let out = passed(&placed(vec![joined(vec![ramp, tower])], 1), &params(head("v6")));
    assert_eq!(out.patches.len(), 1, "{:?}", out.mm2);
    let patch = &out.patches[0];
    // What is lower than the tower's foot, and the middle of the layer there.
    let foot = to_units(2.0 + 15.0 * tan(10.0));
    assert!(i64::from(patch.top) <= i64::from(foot), "{} {foot}", patch.top);
    assert!(share(&out, 1, [-16.0, -6.0], [-2.0, 6.0]) > 0.97, "{:?}", out.mm2);
    assert!(out.mm2.of(Reason::Obstacle) > 150.0, "{:?}", out.mm2);
}

#[test]
fn layers_too_high_for_the_bore_leave_no_stripes() {
    // Without the rule, stripes of about 1.6 by 20 mm would be left between treads 2.6 mm wide.
    let wedge = body([0.0, 0.0], (20, 20, 1.0), |x, _| 2.0 + x * tan(8.0));
    let params = NonPlanarParams { height: 3_600, ..params(head("long-0.6")) };
    let out = passed(&placed(vec![wedge], 1), &params);
    assert!(out.patches.is_empty(), "{} stripes", out.patches.len());
    assert!(out.mm2.of(Reason::Overhang) > 0.5 * out.mm2.total(), "{:?}", out.mm2);
}

#[test]
fn flat_corners_of_a_saddle_do_not_grow_inwards() {
    // Its corners, 3 % of it, are steeper than layers of 0.1 mm allow. With treads taken as half a layer
    // above the surface everywhere, flat zones grow until the slope falls to 8°.
    let saddle = |x: f64, y: f64| 5.0 + 0.008 * (x - 20.0) * (y - 20.0);
    let head = head("long-0.6");
    let slopes = 0.5..=head.steepest_press(0.1);
    let params = NonPlanarParams { height: 1_000, slopes, ..params(head) };
    let out = passed(&placed(vec![body([0.0, 0.0], (40, 40, 1.0), saddle)], 1), &params);
    assert!(out.mm2.skin > 0.75 * out.mm2.total(), "{:?}", out.mm2);
}
