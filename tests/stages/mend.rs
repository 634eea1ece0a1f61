//! Sound solids, damaged in known ways -> mended: the same solid comes out, whatever the damage and the order of the triangles.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use proptest::prelude::*;
use slicer::error::Error;
use slicer::mesh::faults::{Fault, Mending};
use slicer::mesh::place::{Placed, place};
use slicer::mesh::{Bed, Placement, Policy, read};
use slicer::slice::{Heights, Layer, Slicer};
use std::path::Path;

type Corners = [[f32; 3]; 3];

/// Solids of the fixtures; of one body, of two, and with a cavity.
const SOLIDS: [&str; 4] = ["cube_20.stl", "bracket.stl", "two_shells.stl", "cavity.stl"];

fn triangles(name: &str) -> Vec<Corners> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures").join(name);
    let mesh = read::from_path(path.to_str().unwrap(), read::DEFAULT_MAX_TRIANGLES).unwrap();
    let corner = |vertex: u32| mesh.vertices[vertex as usize];
    mesh.triangles.iter().map(|triangle| triangle.map(corner)).collect()
}

fn placed(triangles: &[Corners], policy: Policy) -> Result<Placed, Error> {
    let mut bytes = vec![b' '; 80];
    bytes.extend(u32::try_from(triangles.len()).unwrap().to_le_bytes());
    for triangle in triangles {
        bytes.extend([0; 12]);
        bytes.extend(triangle.as_flattened().iter().flat_map(|number| number.to_le_bytes()));
        bytes.extend([0; 2]);
    }
    let mesh = read::from_bytes("x.stl", &bytes, read::DEFAULT_MAX_TRIANGLES)?;
    Ok(place(vec![mesh], &Placement { policy, ..Placement::default() }, &Bed::ANY)?)
}

fn mended(triangles: &[Corners]) -> Placed {
    let placed = placed(triangles, Policy::Repair).unwrap();
    let left = &placed.reports[0].left;
    let open = left.iter().find(|fault| fault.kind != Fault::CrowdedEdge);
    assert_eq!((open, placed.adjacency.unpaired), (None, 0));
    placed
}

fn layers(placed: &Placed) -> Vec<Layer> {
    let top = placed.mesh.vertices.iter().map(|vertex| vertex[2]).max().unwrap();
    let heights = Heights::even(3_000, 3_000, top);
    let slicer = Slicer::new(&placed.mesh, &placed.adjacency, heights, 100);
    (0..slicer.blocks()).flat_map(|block| slicer.block(block)).collect()
}

/// Numbers that look random and are the same each time.
fn noise(seed: u64) -> impl FnMut() -> u64 {
    let mut state = seed.wrapping_mul(2).wrapping_add(1);
    move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        state
    }
}

/// The damages that leave the solid exactly as it was, each with what mends it.
fn harmless(name: &str, seed: u64, triangles: &[Corners]) -> Vec<Corners> {
    let mut next = noise(seed);
    let mut out = triangles.to_vec();
    let turned = |[a, b, c]: Corners| [a, c, b];
    match name {
        "all inverted" => out.iter_mut().for_each(|triangle| *triangle = turned(*triangle)),
        "one inverted" => {
            let k = next() as usize % out.len();
            out[k] = turned(out[k]);
        }
        "some copied" => {
            for &triangle in triangles.iter().filter(|_| next().is_multiple_of(3)) {
                out.push(triangle);
                out.push(turned(triangle));
            }
        }
        "whole copied" => out.extend(triangles),
        "points and lines" => {
            for &[a, b, _] in triangles.iter().filter(|_| next().is_multiple_of(2)) {
                let middle = std::array::from_fn(|axis| (a[axis] + b[axis]) / 2.0);
                out.extend([[a, a, b], [a, a, a], [a, middle, b]]);
            }
        }
        "corners on edges" => {
            out = triangles
                .iter()
                .flat_map(|&triangle| split(triangle, next().is_multiple_of(3)))
                .collect();
        }
        "one missing" => {
            out.remove(next() as usize % triangles.len());
        }
        "a fin" => {
            let [a, b, c] = out[next() as usize % triangles.len()];
            // Beside the triangle, and in none of the planes of the solid.
            let off = [3.25, 5.5, 7.125];
            let out_of_it = std::array::from_fn(|axis| a[axis] + b[axis] - c[axis] + off[axis]);
            out.push([a, b, out_of_it]);
        }
        _ => panic!("no damage is called {name}"),
    }
    out
}

/// A triangle as it is, or in two halves where its neighbour keeps the whole edge.
fn split([a, b, c]: Corners, is_split: bool) -> Vec<Corners> {
    if !is_split {
        return vec![[a, b, c]];
    }
    let middle = std::array::from_fn(|axis| (a[axis] + b[axis]) / 2.0);
    vec![[a, middle, c], [middle, b, c]]
}

const HARMLESS: [(&str, Mending); 8] = [
    ("all inverted", Mending::TurnedShell),
    ("one inverted", Mending::Turned),
    ("some copied", Mending::DroppedDuplicate),
    ("whole copied", Mending::DroppedDuplicate),
    ("points and lines", Mending::DroppedDegenerate),
    ("corners on edges", Mending::SplitTJunction),
    ("one missing", Mending::FilledHole),
    ("a fin", Mending::DroppedSheet),
];

#[test]
fn a_damaged_solid_is_the_sound_one_again() {
    for name in SOLIDS {
        let sound = triangles(name);
        let wanted = mended(&sound);
        assert!(wanted.reports[0].found.is_empty() && wanted.reports[0].mended.is_empty());
        let wanted_layers = layers(&wanted);
        for (damage, mending) in HARMLESS {
            for seed in 1..4 {
                let what = format!("{name}, {damage}, {seed}");
                let damaged = harmless(damage, seed, &sound);
                let placed = std::panic::catch_unwind(|| mended(&damaged)).expect(&what);
                let report = &placed.reports[0];
                let volume = wanted.reports[0].volume_mm3;
                assert!((report.volume_mm3 / volume - 1.0).abs() < 1e-6, "{what}: {report:?}");
                assert!(report.mended.iter().any(|one| one.kind == mending), "{what}: {report:?}");
                same(&layers(&placed), &wanted_layers, damage == "corners on edges", &what);
            }
        }
    }
}

/// Compares layers: bit by bit, or by area where corners in the middle of
/// edges were `rounded`, so that contours are simplified at other corners.
fn same(layers: &[Layer], wanted: &[Layer], rounded: bool, what: &str) {
    assert_eq!(layers.len(), wanted.len(), "{what}");
    for (layer, wanted) in layers.iter().zip(wanted) {
        assert_eq!(layer.closed_gap, 0, "{what}");
        let off = layer.volume_mm3() / wanted.volume_mm3() - 1.0;
        let is_same = if rounded { off.abs() < 1e-3 } else { layer == wanted };
        assert!(is_same, "{what}, layer {}", layer.index);
    }
}

#[test]
fn corners_that_were_moved_apart_meet_again() {
    for name in SOLIDS {
        let sound = triangles(name);
        let volume = mended(&sound).reports[0].volume_mm3;
        let mut next = noise(7);
        let mut moved = sound.clone();
        for number in moved.as_flattened_mut().as_flattened_mut() {
            // Up to 5 µm to either side.
            *number += (next() % 10_001) as f32 * 1e-6 - 5e-3;
        }
        let placed = mended(&moved);
        let report = &placed.reports[0];
        assert!((report.volume_mm3 / volume - 1.0).abs() < 2e-3, "{name}: {report:?}");
        assert!(layers(&placed).iter().all(|layer| layer.closed_gap == 0), "{name}");
    }
}

#[test]
fn strict_refuses_every_damage_and_warn_changes_nothing() {
    let sound = triangles("cube_20.stl");
    assert!(placed(&sound, Policy::Strict).is_ok());
    for (damage, _) in HARMLESS {
        let damaged = harmless(damage, 1, &sound);
        let error = placed(&damaged, Policy::Strict).expect_err(damage);
        let text = error.to_string();
        assert_eq!(error.exit_code(), 3);
        assert!(text.starts_with("x.stl: the mesh has faults: ") && !text.contains('\n'), "{text}");
        let report = &placed(&damaged, Policy::Warn).unwrap().reports[0];
        assert!(report.mended.is_empty(), "{damage}: {report:?}");
    }
}

#[test]
fn a_sheet_below_does_not_lift_the_part() {
    let mut all = triangles("cube_20.stl");
    let low = all.as_flattened().iter().map(|corner| corner[2]).fold(f32::MAX, f32::min) - 9.0;
    let sheet = [[0.0, 0.0, low], [9.0, 0.0, low], [0.0, 9.0, low]];
    all.extend([sheet, [sheet[0], sheet[2], sheet[1]]]);
    let placed = mended(&all);
    assert_eq!((placed.size_mm[2], placed.mesh.triangles.len()), (20.0, 12));
}

#[test]
fn faces_that_do_not_meet_are_no_body() {
    // Each face of the cube, 2 mm out of its place.
    let apart: Vec<Corners> = triangles("cube_20.stl")
        .chunks(2)
        .zip(0_u8..)
        .flat_map(|(face, k)| {
            let moved = |corner: [f32; 3]| corner.map(|side| side + f32::from(k) * 2.0);
            face.iter().map(move |triangle| triangle.map(moved)).collect::<Vec<_>>()
        })
        .collect();
    let error = placed(&apart, Policy::Repair).expect_err("must be refused");
    assert!(error.to_string().contains("cannot be mended"), "{error}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn the_order_of_triangles_and_corners_does_not_show(
        seed in 1_u64..1000, damage in 0..HARMLESS.len(), solid in 0..SOLIDS.len(),
    ) {
        let damaged = harmless(HARMLESS[damage].0, seed, &triangles(SOLIDS[solid]));
        let mut next = noise(seed + 1000);
        let mut mixed = damaged.clone();
        for k in (1..mixed.len()).rev() {
            mixed.swap(k, next() as usize % (k + 1));
            mixed[k].rotate_left(next() as usize % 3);
        }
        let (one, other) = (mended(&damaged), mended(&mixed));
        prop_assert!(layers(&one) == layers(&other));
        let counts = |placed: &Placed| -> Vec<_> {
            placed.reports[0].mended.iter().map(|one| (one.kind, one.count)).collect()
        };
        prop_assert_eq!(counts(&one), counts(&other));
    }
}
