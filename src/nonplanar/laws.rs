//! Laws of surfaces and of the base below them, on bodies whose tops are known.
//!
//! A *body* stands on a grid of places, with a given height over each: a wedge, a dome, an arc, a ramp
//! that ends at a plateau. So areas, heights and slopes are known by formula.
//!
//! - Areas of all classes add up to those of all tops.
//! - Where the whole top is a patch, the cut layers are those of the body lowered by its skins: the slicer
//!   itself says what is right, layer by layer.
//! - What no patch reaches stays as it is: layers below, a roof above.

use super::base::{Base, Lowered};
use super::params::NonPlanarParams;
use super::surface::Surface;
use super::surface::find::{Surfaces, surfaces};
use crate::geom::{Contour, Point, double_area};
use crate::head::Head;
use crate::mesh::Mesh;
use crate::mesh::edges::adjacency;
use crate::slice::{Heights, Layer, Slicer};
use crate::units::{Coord, to_mm, to_units};
use std::ops::RangeInclusive;
use std::sync::Arc;

fn params(slopes: RangeInclusive<f64>) -> NonPlanarParams {
    let head = Head { flat: 1.0, cone: 45.0, cone_length: 3.0, discs: vec![], boxes: vec![] };
    NonPlanarParams {
        skins: 2,
        height: 2_000,
        line_width: 4_000,
        nozzle: 4_000,
        slopes,
        max_bend: 30.0,
        min_area: 20.0,
        directions: None,
        wall: 0,
        tolerance: 50,
        segment: 20_000,
        shortest: 1_000,
        clearance: 5_000,
        outline: 0,
        beyond: 0,
        head,
    }
}

/// From `low` to `high` in `count` equal steps, mm.
fn steps(low: f64, high: f64, count: i32) -> Vec<f64> {
    (0..=count).map(|k| low + (high - low) * f64::from(k) / f64::from(count)).collect()
}

/// A body on a grid of places with its top at `top` and its underside at `under`; mm.
fn body(xs: &[f64], ys: &[f64], top: impl Fn(f64, f64) -> f64, under: f64) -> Mesh {
    let (nx, ny) = (xs.len() as u32, ys.len() as u32);
    let mut vertices = Vec::new();
    for of_top in [true, false] {
        for &y in ys {
            let corner = |&x: &f64| [x, y, if of_top { top(x, y) } else { under }].map(to_units);
            vertices.extend(xs.iter().map(corner));
        }
    }
    let up = |i: u32, j: u32| j * nx + i;
    let down = |i: u32, j: u32| nx * ny + up(i, j);
    let mut triangles = Vec::new();
    let mut quad = |[a, b, c, d]: [u32; 4]| triangles.extend([[a, b, c], [a, c, d]]);
    for (i, j) in (0..ny - 1).flat_map(|j| (0..nx - 1).map(move |i| (i, j))) {
        quad([up(i, j), up(i + 1, j), up(i + 1, j + 1), up(i, j + 1)]);
        quad([down(i, j), down(i, j + 1), down(i + 1, j + 1), down(i + 1, j)]);
    }
    for i in 0..nx - 1 {
        quad([down(i, 0), down(i + 1, 0), up(i + 1, 0), up(i, 0)]);
        quad([down(i + 1, ny - 1), down(i, ny - 1), up(i, ny - 1), up(i + 1, ny - 1)]);
    }
    for j in 0..ny - 1 {
        quad([down(0, j + 1), down(0, j), up(0, j), up(0, j + 1)]);
        quad([down(nx - 1, j), down(nx - 1, j + 1), up(nx - 1, j + 1), up(nx - 1, j)]);
    }
    Mesh { vertices, triangles }
}

/// A ramp that winds around an axis; mm a turn.
fn spiral(turns: i32, pitch: f64) -> Mesh {
    const STEPS: i32 = 60;
    let mut vertices = Vec::new();
    for k in 0..=turns * STEPS {
        let turn = f64::from(k) / f64::from(STEPS);
        let (sin, cos) = crate::units::sin_cos(360.0 * turn);
        let z = 3.0 + pitch * turn;
        for (radius, z) in [(10.0, z), (20.0, z), (20.0, z - 1.5), (10.0, z - 1.5)] {
            vertices.push([radius * cos, radius * sin, z].map(to_units));
        }
    }
    let mut triangles = vec![[0, 3, 2], [0, 2, 1]];
    let last = vertices.len() as u32 - 4;
    triangles.extend([[last, last + 1, last + 2], [last, last + 2, last + 3]]);
    for k in (0..last).step_by(4) {
        for side in 0..4 {
            let (a, b) = (k + side, k + (side + 1) % 4);
            triangles.extend([[a, b, b + 4], [a, b + 4, a + 4]]);
        }
    }
    Mesh { vertices, triangles }
}

fn found(mesh: &Mesh, slopes: RangeInclusive<f64>) -> Surfaces {
    let adjacency = adjacency(&mesh.vertices, &mesh.triangles);
    assert_eq!((adjacency.unpaired, adjacency.non_manifold), (0, 0));
    let found = surfaces(mesh, &adjacency, &params(slopes));
    let Surfaces { surfaces, tops } = &found;
    let in_surfaces: f64 = surfaces.iter().map(|s| s.area_mm2(s.outline())).sum();
    let sum = in_surfaces + tops.level + tops.slope + tops.press + tops.small;
    assert!((sum - tops.all).abs() < 1e-3 * tops.all, "{tops:?} {in_surfaces}");
    found
}

/// The only surface, and what is level.
fn only(mesh: &Mesh, slopes: RangeInclusive<f64>) -> (Arc<Surface>, f64) {
    let mut found = found(mesh, slopes);
    assert_eq!(found.surfaces.len(), 1, "{:?}", found.tops);
    (found.surfaces.remove(0), found.tops.level)
}

fn mm2(contours: &[Contour]) -> f64 {
    contours.iter().map(|c| double_area(c) as f64 / 2e8).sum()
}

fn at(x: f64, y: f64) -> Point {
    Point { x: to_units(x), y: to_units(y) }
}

fn rectangle(low: Point, high: Point) -> Vec<Contour> {
    let (right, left) = (Point { x: high.x, y: low.y }, Point { x: low.x, y: high.y });
    vec![vec![low, right, high, left]]
}

fn layers(mesh: &Mesh) -> Vec<Layer> {
    let adjacency = adjacency(&mesh.vertices, &mesh.triangles);
    let heights = Heights::even(2_000, 2_000, mesh.top());
    let slicer = Slicer::new(mesh, &adjacency, heights, 50);
    (0..slicer.blocks()).flat_map(|b| slicer.block(b)).collect()
}

/// The base under skins of 0.2 mm on these areas of a surface.
fn base_under(surface: &Surface, areas: Vec<Vec<Contour>>, raised: Coord) -> Base<'_> {
    let height = 2_000;
    Base::new(vec![Lowered { surface, areas, height, raised, grown: 0, beyond: 0 }])
}

/// Cuts a body whose whole top is a patch, and compares with the body lowered by two skins,
/// but for what the base is raised by.
fn is_lowered(make: impl Fn(f64) -> Mesh, slopes: RangeInclusive<f64>, raised: Coord) {
    let (whole, lower) = (make(0.0), make(0.4 - to_mm(raised)));
    let (surface, _) = only(&whole, slopes);
    let areas = vec![surface.outline().to_vec(); 2];
    let base = base_under(&surface, areas, raised);
    let expected = layers(&lower);
    let mut cut = 0;
    for layer in layers(&whole) {
        let before = layer.contours.clone();
        let plane = layer.z - layer.height / 2;
        let after = base.cut(layer);
        let expected = expected.get(after.index).map_or(&[][..], |l| &l.contours[..]);
        let (is, should) = (mm2(&after.contours), mm2(expected));
        assert!((is - should).abs() <= 1e-3 * should, "layer {}: {is} {should}", after.index);
        assert_eq!(after.contours.len(), expected.len(), "layer {}", after.index);
        cut += usize::from(after.contours != before);
        if plane < surface.bounds()[0] - 4_000 {
            assert_eq!(after.contours, before);
        }
    }
    assert!(cut > 8, "{cut}");
}

fn wedge(lower: f64) -> Mesh {
    body(&[-25.0, 25.0], &[-15.0, 15.0], |x, _| 4.0 + x * 0.08 - lower, 0.0)
}

fn dome(lower: f64) -> Mesh {
    let all = steps(-20.0, 20.0, 40);
    body(&all, &all, |x, y| (80.0 * 80.0 - x * x - y * y).sqrt() - 72.0 - lower, 0.0)
}

#[test]
fn the_top_of_a_wedge_is_one_plane() {
    let (surface, level) = only(&wedge(0.0), 0.5..=26.0);
    assert_eq!(level, 0.0);
    assert_eq!(mm2(surface.outline()), 1_500.0);
    assert_eq!(surface.bounds(), [20_000, 60_000]);
    let true_area = 1_500.0 * 1.0064_f64.sqrt();
    assert!((surface.area_mm2(surface.outline()) - true_area).abs() < 1e-6 * true_area);
    let half = rectangle(at(-25.0, -15.0), at(0.0, 15.0));
    assert!((surface.area_mm2(&half) - true_area / 2.0).abs() < 1e-3);
    assert!((surface.steepest() - 4.573_9).abs() < 1e-3, "{}", surface.steepest());
    assert!(surface.direction().min(180.0 - surface.direction()) < 0.01);
    assert!((surface.z(at(10.0, 3.0)).unwrap() - 48_000.0).abs() < 1.0);
    assert_eq!(surface.z(at(25.000_1, 3.0)), Some(60_000.0), "a tenth of a µm beside it");
    assert_eq!(surface.z(at(25.1, 3.0)), None);
    let [x, y] = surface.slope(at(10.0, 3.0)).unwrap();
    assert!((x - 0.08).abs() < 1e-6 && y.abs() < 1e-6);
    let band = surface.between(30_000, 40_000);
    assert!((mm2(&band) - 375.0).abs() < 0.01, "{band:?}");
    let [low, high] = surface.over(&rectangle(at(-5.0, -5.0), at(5.0, 5.0))).unwrap();
    assert!((low - 36_000.0).abs() < 1.0 && (high - 44_000.0).abs() < 1.0);
    assert_eq!(surface.over(&rectangle(at(30.0, 0.0), at(40.0, 5.0))), None);
}

#[test]
fn a_profile_has_the_heights_of_the_mesh() {
    let (surface, _) = only(&dome(0.0), 0.5..=26.0);
    let (a, b) = (at(-19.5, -7.3), at(18.2, 11.9));
    let profile = surface.profile(a, b);
    assert!(profile.len() > 70, "{}", profile.len());
    assert_eq!((profile[0].0, profile[profile.len() - 1].0), (0.0, 1.0));
    assert!(profile.windows(2).all(|pair| pair[0].0 < pair[1].0));
    for pair in profile.windows(2) {
        // Straight between its points.
        for by in [0.0, 0.25, 0.5, 0.75] {
            let t = pair[0].0 + by * (pair[1].0 - pair[0].0);
            let on =
                |from: i32, to: i32| (f64::from(from) + t * f64::from(to - from)).round() as i32;
            let z = surface.z(Point { x: on(a.x, b.x), y: on(a.y, b.y) }).unwrap();
            let expected = pair[0].1 + by * (pair[1].1 - pair[0].1);
            assert!((z - expected).abs() < 1.0, "{t}: {z} {expected}");
        }
    }
    // Ends beside the surface: it begins at its edge.
    let through = surface.profile(at(-30.0, 0.5), at(30.0, 0.5));
    let ends = [through[0].0, through[through.len() - 1].0].map(|t| t * 60.0 - 30.0);
    assert!((ends[0] + 20.0).abs() < 1e-3 && (ends[1] - 20.0).abs() < 1e-3, "{ends:?}");
}

#[test]
fn bands_of_a_dome_fill_its_outline() {
    // The triangles around its top slope by half a degree.
    let (surface, level) = only(&dome(0.0), 0.8..=26.0);
    assert_eq!(level, 0.0, "its top belongs to it");
    let [low, high] = surface.bounds();
    let heights: Vec<Coord> = (low..=high + 1_000).step_by(1_000).collect();
    let bands = heights.windows(2).map(|pair| mm2(&surface.between(pair[0], pair[1])));
    let sum: f64 = bands.sum();
    assert!((sum - 1_600.0).abs() < 0.05, "{sum}");
    // The true area of a part of it, by its middle line: measured in rows, against the whole.
    let quarter = rectangle(at(0.0, 0.0), at(20.0, 20.0));
    let share = surface.area_mm2(&quarter) / surface.area_mm2(surface.outline());
    assert!((share - 0.25).abs() < 1e-4, "{share}");
    let [floor, top] = surface.over(&quarter).unwrap();
    assert!((top - f64::from(high)).abs() < 1.0 && (floor - f64::from(low)).abs() < 1.0);
}

#[test]
fn a_base_is_the_part_lowered_by_its_skins() {
    is_lowered(wedge, 0.5..=26.0, 0);
    is_lowered(dome, 0.5..=26.0, 0);
    is_lowered(dome, 0.5..=26.0, 500);
}

#[test]
fn the_level_strip_on_top_of_an_arc_belongs_to_it_and_a_plateau_does_not() {
    // 51 strips: the middle one is level, 1 mm wide.
    let arc = body(&steps(-25.5, 25.5, 51), &[-10.0, 10.0], |x, _| 5.0 - x * x / 220.0, 0.0);
    let (surface, level) = only(&arc, 0.5..=26.0);
    assert_eq!((mm2(surface.outline()), level), (1_020.0, 0.0));
    assert!(surface.direction().min(180.0 - surface.direction()) < 0.01);
    let ramp = |x: f64, _| 2.0 + 0.1 * x.min(0.0) + 3.0;
    let beside = body(&[-30.0, 0.0, 20.0], &[-10.0, 10.0], ramp, 0.0);
    let (surface, level) = only(&beside, 0.5..=26.0);
    assert_eq!((mm2(surface.outline()), level), (600.0, 400.0));
}

#[test]
fn slivers_do_not_cut_a_surface() {
    // A strip 0.8 µm wide that stands at 45° in the middle of each row.
    let mut xs = steps(-20.0, 20.0, 20);
    xs.push(0.000_8);
    xs.sort_by(f64::total_cmp);
    let top = |x: f64, y: f64| {
        let lifted = if x == 0.000_8 { 0.000_8 } else { 0.0 };
        4.0 + 0.05 * x + 0.02 * y + lifted
    };
    let mesh = body(&xs, &steps(-10.0, 10.0, 10), top, 0.0);
    let (surface, _) = only(&mesh, 0.5..=26.0);
    assert!((mm2(surface.outline()) - 800.0).abs() < 1e-3);
    assert!(surface.steepest() < 4.0, "{}", surface.steepest());
}

#[test]
fn a_ramp_that_winds_over_itself_is_several_surfaces() {
    let found = found(&spiral(3, 4.0), 0.5..=26.0);
    assert_eq!(found.surfaces.len(), 3);
    let ring = std::f64::consts::PI * 300.0;
    for surface in &found.surfaces {
        let plan = mm2(surface.outline());
        assert!(plan < ring && plan > 0.95 * ring, "{plan} of {ring}");
        assert!((surface.bounds()[1] - surface.bounds()[0]) < 42_000);
    }
    let all: f64 = found.surfaces.iter().map(|s| s.area_mm2(s.outline())).sum();
    assert!(all > 0.99 * found.tops.all, "{all} of {:?}", found.tops);
}

#[test]
fn a_skin_of_less_area_than_the_next_leaves_a_higher_base() {
    let mesh = wedge(0.0);
    let (surface, _) = only(&mesh, 0.5..=26.0);
    let inner = rectangle(at(-25.0, -15.0), at(25.0, 0.0));
    let areas = vec![inner, surface.outline().to_vec()];
    let base = base_under(&surface, areas, 0);
    let layer = layers(&mesh).swap_remove(19);
    let plane = to_mm(layer.z - layer.height / 2);
    let reach = |lower: f64| 25.0 - (plane + lower - 4.0) / 0.08;
    let expected = 15.0 * reach(0.4) + 15.0 * reach(0.2);
    let left = mm2(&base.cut(layer).contours);
    assert!((left - expected).abs() < 1e-3 * expected, "{left} {expected}");
}

#[test]
fn a_roof_over_a_patch_stays() {
    let mut mesh = wedge(0.0);
    let roof = body(&[-5.0, 5.0], &[-5.0, 5.0], |_, _| 8.0, 5.0);
    let first = mesh.vertices.len() as u32;
    mesh.vertices.extend(&roof.vertices);
    mesh.triangles.extend(roof.triangles.iter().map(|t| t.map(|v| v + first)));
    let (surface, level) = only(&mesh, 0.5..=26.0);
    assert_eq!(level, 100.0);
    let areas = vec![surface.outline().to_vec(); 2];
    let base = base_under(&surface, areas, 0);
    for layer in layers(&mesh).into_iter().skip(25) {
        let plane = to_mm(layer.z - layer.height / 2);
        let lowered = 30.0 * (25.0 - (plane + 0.4 - 4.0) / 0.08).max(0.0);
        let left = mm2(&base.cut(layer).contours);
        assert!((left - 100.0 - lowered).abs() < 0.1, "{plane}: {left} {lowered}");
    }
}
