//! Solids made by hand -> what of their tops becomes skin, and why the rest does not.

use super::find::surfaces;
use super::params::NonPlanarParams;
use super::*;
use crate::head::Head;
use crate::head::named::named;
use crate::mesh::edges::MAX_TRIANGLES;
use crate::mesh::place::{Placed, place};
use crate::mesh::{Bed, MeshReport, Placement, Policy, RawMesh, Unit};
use crate::slice::{Heights, Slicer};
use crate::units::{Coord, to_units};

const BED: Bed = Bed { min: [-150.0, -150.0], max: [150.0, 150.0], height: 200.0 };

pub(super) fn head(name: &str) -> Head {
    named(name).unwrap()
}

pub(super) fn params(head: Head) -> NonPlanarParams {
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
        head,
    }
}

/// A body on a grid of columns from `low` on, `step` apart, whose top is as high as `z` says, mm.
pub(super) fn body(
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
pub(super) fn joined(bodies: Vec<RawMesh>) -> RawMesh {
    let mut out = RawMesh::default();
    for body in bodies {
        let first = out.vertices.len() as u32;
        out.vertices.extend(body.vertices);
        out.triangles.extend(body.triangles.iter().map(|t| t.map(|v| v + first)));
        out.report = body.report;
    }
    out
}

pub(super) fn placed(models: Vec<RawMesh>, copies: u32) -> Placed {
    let placement = Placement {
        sink: 0.0,
        unit: Unit::Mm,
        scale: 1.0,
        stretch: [1.0; 3],
        rotate: [0.0; 3],
        at: None,
        gap: 5.0,
        copies,
        max_triangles: MAX_TRIANGLES,
        policy: Policy::Repair,
    };
    place(models, &placement, &BED).unwrap_or_else(|error| panic!("{error}"))
}

/// What becomes of the tops of a model.
pub(super) fn passed(placed: &Placed, params: &NonPlanarParams) -> Patches {
    let (h, top) = (params.height, placed.mesh.top());
    let heights = Heights::even(h, h, top);
    let slicer = Slicer::new(&placed.mesh, &placed.adjacency, heights, 20);
    let surfaces = surfaces(&placed.mesh, &placed.adjacency, params);
    let scene = Scene {
        slicer: &slicer,
        surfaces: &surfaces,
        bodies: &placed.bodies,
        support: None,
        ceiling: to_units(BED.height),
        params,
    };
    let out = patches(&scene);
    let sum = out.mm2.total();
    assert!(
        (sum - surfaces.tops.all).abs() < 0.01 * surfaces.tops.all,
        "{sum} {:?}",
        surfaces.tops
    );
    check(&out, heights_of(&slicer));
    out
}

fn heights_of<'a>(slicer: &'a Slicer<'_>) -> &'a Heights {
    slicer.heights()
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
        assert!(top < patch.bounds[1]);
        let first = patch.strokes.first().unwrap();
        assert!(first.over > top);
        let highest = |stroke: &Stroke| stroke.path.points.iter().map(|p| p.z + top).max().unwrap();
        let most = patch.strokes.iter().map(highest).max().unwrap();
        assert!((most - patch.bounds[1]).abs() < 1_200, "{most} {:?}", patch.bounds);
    }
}

pub(super) fn tell(name: &str, out: &Patches) {
    let flat: Vec<String> = Reason::ALL
        .iter()
        .filter(|r| out.mm2.of(**r) > 0.0)
        .map(|r| format!("{} {:.1}", r.name(), out.mm2.of(*r)))
        .collect();
    let sloped = out.mm2.total() - out.mm2.level;
    eprintln!(
        "{name}: {} patches, skin {:.1} ({:.1} % of sloped), level {:.1}, {}",
        out.patches.len(),
        out.mm2.skin,
        100.0 * out.mm2.skin / sloped,
        out.mm2.level,
        flat.join(", ")
    );
}

fn tan(degrees: f64) -> f64 {
    libm::tan(degrees.to_radians())
}

#[test]
fn a_wedge_is_taken_whole() {
    let wedge = body([0.0, 0.0], (30, 20, 1.0), |x, _| 2.0 + x * tan(4.76));
    let out = passed(&placed(vec![wedge], 1), &params(head("long-0.6")));
    tell("wedge", &out);
    assert_eq!(out.patches.len(), 1);
    assert!(out.mm2.skin > 0.999 * out.mm2.total());
    assert_eq!(out.patches[0].areas[0], out.patches[0].areas[1]);
}

#[test]
fn a_wave_with_a_boss_loses_a_ring() {
    let wave = |x: f64, y: f64| {
        let z = 4.0 + 1.0 * libm::sin(x / 6.0) + 0.5 * libm::cos(y / 5.0);
        let is_boss = (x - 15.0).abs() < 3.1 && (y - 10.0).abs() < 3.1;
        if is_boss { 12.0 } else { z }
    };
    let out =
        passed(&placed(vec![body([0.0, 0.0], (60, 40, 0.5), wave)], 1), &params(head("long-0.6")));
    tell("wave with a boss", &out);
    assert!(out.mm2.of(Reason::Obstacle) > 10.0);
}

#[test]
fn a_ramp_between_boxes() {
    let low = body([0.0, 0.0], (10, 20, 1.0), |_, _| 3.0);
    let ramp = body([11.0, 0.0], (20, 20, 1.0), |x, _| 2.0 + (x - 11.0) * tan(8.0));
    let high = body([32.0, 0.0], (10, 20, 1.0), |_, _| 12.0);
    let out = passed(&placed(vec![joined(vec![low, ramp, high])], 1), &params(head("v6")));
    tell("ramp between boxes", &out);
}

#[test]
fn a_cautious_head_refuses_ten_degrees() {
    let wedge = body([0.0, 0.0], (40, 20, 1.0), |x, _| 2.0 + x * tan(10.0));
    let mut cautious = params(head("cautious"));
    let out = passed(&placed(vec![wedge.clone()], 1), &cautious);
    tell("cautious", &out);
    cautious.slopes = 0.5..=21.8;
    let out = passed(&placed(vec![wedge], 1), &cautious);
    tell("cautious, asked", &out);
}

#[test]
fn a_ramp_with_a_plateau() {
    let ramp = |x: f64, _: f64| 2.0 + x.clamp(5.0, 25.0) * tan(10.0);
    for skins in 1..=4 {
        let params = NonPlanarParams { skins, ..params(head("long-0.6")) };
        let out = passed(&placed(vec![body([0.0, 0.0], (40, 20, 1.0), ramp)], 1), &params);
        tell("ramp with plateau", &out);
    }
}

#[test]
fn a_floor_under_a_roof() {
    let floor = body([0.0, 0.0], (30, 20, 1.0), |x, _| 2.0 + x * tan(5.0));
    let mut roof = body([10.0, 0.0], (20, 20, 1.0), |_, _| 2.0);
    roof.vertices.iter_mut().for_each(|v| v[2] += 9.0);
    let out = passed(&placed(vec![joined(vec![floor, roof])], 1), &params(head("v6")));
    tell("floor under a roof", &out);
}

#[test]
fn flat_zones_do_not_grow() {
    // A pit in a slope of 10 degrees, too steep to follow.
    let pit = |x: f64, y: f64| {
        let z = 6.0 + x * tan(10.0);
        if (x - 15.0).hypot(y - 10.0) < 2.2 { z + 2.0 } else { z }
    };
    let out =
        passed(&placed(vec![body([0.0, 0.0], (60, 40, 0.5), pit)], 1), &params(head("long-0.6")));
    tell("knob on a slope", &out);
}

/// `SLICER_TRY=file,file cargo test --lib tries_models -- --ignored --nocapture`
#[test]
#[ignore = "for looking at models"]
fn tries_models() {
    let files = std::env::var("SLICER_TRY").unwrap();
    for file in files.split(',') {
        for name in
            std::env::var("SLICER_HEADS").unwrap_or_else(|_| "long-0.6,v6".into()).split(',')
        {
            let mesh = crate::mesh::read::from_path(file, MAX_TRIANGLES).unwrap();
            let placed = placed(vec![mesh], 1);
            let start = std::time::Instant::now();
            let out = passed(&placed, &params(head(name)));
            tell(&format!("{file} {name} {:?}", start.elapsed()), &out);
        }
    }
}

fn _unused(_: Coord) {}
