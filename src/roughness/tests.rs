//! Beads laid by hand on a plane -> what its roughness has to be.

use super::bead::Bead;
use super::map::Map;
use super::profile::{Found, measure};
use super::sums::Sums;
use super::surface::Surface;
use crate::mesh::Mesh;
use crate::mesh::edges::adjacency;
use crate::roughness::Means;
use crate::units::{UNITS_PER_MM, to_units};

/// Height of a layer, mm.
const LAYER: f64 = 0.2;

/// Sides of the plane in plan, mm.
const SIDE: [f64; 2] = [12.0, 3.0];

/// How it rises along x: 10°.
const RISE: f64 = 0.176_326_98;

/// A square plane that rises along `axis`, or a roof over it, mm above.
fn plane(axis: usize, roof: Option<f64>) -> Mesh {
    let height = |at: [f64; 2]| 2.0 + RISE * at[axis];
    let mut mesh = Mesh::default();
    for over in [Some(0.0), roof].into_iter().flatten() {
        let first = mesh.vertices.len() as u32;
        for at in [[0.0, 0.0], [SIDE[0], 0.0], SIDE, [0.0, SIDE[1]]] {
            mesh.vertices.push([at[0], at[1], height(at) + over].map(to_units));
        }
        mesh.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
    }
    mesh
}

/// A bead between two places, mm, and as wide as that.
fn bead(from: [f64; 3], to: [f64; 3], width: f64) -> Bead {
    let [from, to] = [from, to].map(|at| at.map(|mm| mm * UNITS_PER_MM));
    Bead::between(from, to, width * UNITS_PER_MM / 2.0)
}

/// Layers that each reach to where the plane is half a layer below their tops, as a slicer cuts it, and
/// from there so many mm into the part.
fn staircase(depth: f64) -> Vec<Bead> {
    let layers = 0..((2.0 + RISE * SIDE[0]) / LAYER).ceil() as usize + 1;
    let layer = |k: usize| {
        let top = LAYER * k as f64;
        let from = ((top - LAYER / 2.0 - 2.0) / RISE).max(0.0);
        let middle = from + depth / 2.0;
        bead([middle, -50.0, top], [middle, 50.0, top], depth)
    };
    layers.map(layer).collect()
}

fn found(mesh: &Mesh, beads: &[Bead], patch: u32) -> Found {
    let surface = Surface::new(mesh, &adjacency(&mesh.vertices, &mesh.triangles)).unwrap();
    let map = Map::new(&surface, surface.cell(), LAYER);
    beads.iter().for_each(|bead| map.bead(bead));
    let of_patch = |k: &u32| map.samples[*k as usize].patch == patch;
    let samples: Vec<u32> = (0..map.samples.len() as u32).filter(of_patch).collect();
    measure(&map, &samples, 8.0)
}

fn means(mesh: &Mesh, beads: &[Bead]) -> Means {
    Sums::of(&found(mesh, beads, 0).sums).means()
}

/// Whether a value is as expected, as a share.
fn is_near(value: Option<f64>, expected: f64, share: f64) {
    let value = value.unwrap();
    assert!((value - expected).abs() <= share * expected, "{value} for {expected}");
}

#[test]
fn a_staircase_is_as_rough_as_its_steps() {
    let means = means(&plane(0, None), &staircase(30.0));
    let slope = RISE.atan();
    // A sawtooth as high as a layer seen at right angles to the plane.
    let ra = 1000.0 * LAYER * slope.cos() / 4.0;
    for values in [means.unfiltered, means.filtered] {
        is_near(values.ra_um, ra, 0.02);
        is_near(values.sa_um, ra, 0.02);
        is_near(values.rq_um, ra * 2.0 / 3.0_f64.sqrt(), 0.02);
        is_near(values.sq_um, ra * 2.0 / 3.0_f64.sqrt(), 0.02);
        is_near(values.rz_um, 4.0 * ra, 0.03);
    }
    assert!(means.mean_um.unwrap().abs() < 2.0, "{means:?}");
    assert!(means.coverage > 0.999, "{means:?}");
    is_near(Some(means.area_mm2), SIDE[0] * SIDE[1] / slope.cos(), 0.001);
}

#[test]
fn lines_along_a_slope_are_smooth_and_lines_across_it_leave_steps() {
    let spacing = 0.4;
    let at = |x: f64| 2.0 + RISE * x;
    let along: Vec<Bead> = (0..8)
        .map(|k| spacing * (f64::from(k) + 0.5))
        .map(|y| bead([-1.0, y, at(-1.0)], [13.0, y, at(13.0)], spacing + 0.01))
        .collect();
    let smooth = means(&plane(0, None), &along);
    assert!(smooth.unfiltered.ra_um.unwrap() < 0.1 && smooth.filtered.sa_um.unwrap() < 0.1);
    assert!(smooth.mean_um.unwrap().abs() < 0.1 && smooth.coverage == 1.0, "{smooth:?}");
    let across: Vec<Bead> = (0..30)
        .map(|k| spacing * (f64::from(k) + 0.5))
        .map(|x| bead([x, -1.0, at(x)], [x, 4.0, at(x)], spacing))
        .collect();
    let stepped = means(&plane(0, None), &across);
    let ra = 1000.0 * spacing * RISE.atan().sin() / 4.0;
    for values in [stepped.unfiltered, stepped.filtered] {
        is_near(values.ra_um, ra, 0.02);
        is_near(values.sa_um, ra, 0.02);
    }
}

#[test]
fn what_lacks_is_not_covered_and_what_is_too_high_shifts_the_mean() {
    let raised = |bead: &Bead| bead.raised(0.05 * UNITS_PER_MM);
    let beads: Vec<Bead> = staircase(30.0).iter().map(raised).collect();
    let means_of = means(&plane(0, None), &beads);
    let cosine = RISE.atan().cos();
    is_near(means_of.mean_um, 50.0 * cosine, 0.05);
    is_near(means_of.unfiltered.ra_um, 50.0 * cosine, 0.02);
    // Without layers above 3.4 mm the plane is covered up to 0.8 layers higher.
    let kept = staircase(30.0);
    let less = means(&plane(0, None), &kept[..kept.len() - 4]);
    is_near(Some(less.coverage), (3.4 + 0.8 * LAYER - 2.0) / RISE / SIDE[0], 0.005);
    let none = means(&plane(0, None), &[]);
    assert_eq!((none.coverage, none.mean_um, none.unfiltered.ra_um), (0.0, None, None));
}

#[test]
fn a_roof_does_not_hide_the_floor_below_it() {
    let floor = staircase(30.0);
    // Two layers thick.
    let thin = staircase(2.0 * LAYER / RISE);
    let roof = thin.iter().map(|bead| bead.raised(3.0 * UNITS_PER_MM));
    let both: Vec<Bead> = floor.iter().copied().chain(roof).collect();
    let mesh = plane(0, Some(3.0));
    let alone = means(&plane(0, None), &floor);
    for patch in [0, 1] {
        assert_eq!(Sums::of(&found(&mesh, &both, patch).sums).means(), alone, "{patch}");
    }
}

#[test]
fn profiles_go_along_the_slope_whichever_way_it_falls() {
    for (axis, direction) in [(0, 0.0), (1, 90.0)] {
        let found = found(&plane(axis, None), &[], 0);
        assert!((found.direction - direction).abs() < 1e-6, "{}", found.direction);
    }
}
