//! Models of others -> G-code, read back: sound ones print soundly, broken ones never panic.
//!
//! The models are not part of the project: `SLICER_MODELS` names their folder.
//! Unset, these tests pass with a message. In a debug build they take minutes.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]
#![allow(clippy::print_stdout, reason = "a test that is skipped says so")]

use crate::common::checks::{furthest_out, sound, stringing_travels};
use crate::common::{Kind, Print, Run, Solid, as_it_is, settings, slice_file};
use slicer::error::Error;
use std::path::{Path, PathBuf};

/// Every edge has two faces, wound oppositely.
const SOUND: &[&str] = &[
    "animal_bunny_hollow.stl",
    "animal_dino.stl",
    "animal_koala.stl",
    "ascii_fennec_fox.stl",
    "bracket_y_motor_holder.stl",
    "building_dome.stl",
    "calib_3dbenchy.stl",
    "calib_bridge_cube.stl",
    "calib_overhang.stl",
    "calib_support_test.stl",
    "cube_multi.stl",
    "cube_xyz_20mm.stl",
    "curved_tooth.stl",
    "hand_big.stl",
    "islands_coin_text.stl",
    "islands_xy_offset_pattern.stl",
    "lattice_bcc.stl",
    "scan_brain_mni152_500k.stl",
    "scan_femur.stl",
    "scan_liver.stl",
    "thin_phone_case.stl",
    "thin_wall_rings.stl",
    "broken_tardis.stl",
    "malformed_ascii_crlf.stl",
    "thesis/bar_A.stl",
    "thesis/bar_E.stl",
    "thesis/bar_F.stl",
    "thesis/bar_I.stl",
    "thesis/cube_2unit_blender_ascii.stl",
    "thesis/cube_40p32.stl",
    "thesis/cube_50_holes_30.stl",
    "thesis/cylinder_r20_h10.stl",
    "thesis/like_bear.stl",
    "thesis/like_bracket.stl",
    "thesis/like_building.stl",
    "thesis/like_hand.stl",
    "thesis/like_turbine.stl",
    "thesis/surf_arc_3mm.stl",
    "thesis/surf_hypar.stl",
    "thesis/surf_piva_waves.stl",
    "thesis/surf_wedge_4p76deg.stl",
];

/// Profile and settings of each way that every sound model is printed.
const WAYS: &[(&str, &[(&str, &str)])] = &[
    ("generic-marlin", &[]),
    ("generic-marlin", &[("dual.mode", "pair"), ("support.enabled", "true")]),
    ("zcube-dual", &[]),
    ("zcube-dual", &[("dual.mode", "pair")]),
];

/// How far a bead may reach out of the part: joins of walls at needles' tips included.
const MOST_OUT: f64 = 0.05;

/// Layers whose beads are held against the part, at most; evenly spread.
const LAYERS_LOOKED_AT: usize = 6;

fn folder() -> Option<PathBuf> {
    let folder = std::env::var_os("SLICER_MODELS").map(PathBuf::from);
    if folder.is_none() {
        println!("skipped: SLICER_MODELS does not name a folder of models");
    }
    folder
}

/// Settings that are far from what the bed holds are no failure, but must say the sizes.
fn says_the_size(error: &Error) -> bool {
    let is_fit = match error {
        Error::Mesh(error) => matches!(
            error,
            slicer::mesh::Error::TooLarge { .. } | slicer::mesh::Error::BedFull { .. }
        ),
        Error::Refused(_) => true,
        _ => false,
    };
    let text = error.to_string();
    is_fit && text.contains("mm") && !text.contains('\n')
}

fn check(path: &Path, profile: &str, set: &[(&str, &str)]) {
    let what = format!("{} {profile} {set:?}", path.file_name().unwrap().display());
    let settings = settings(profile, set);
    let (text, report) = match slice_file(path, &settings, &as_it_is()) {
        Ok(made) => made,
        Err(error) => {
            let machine = &settings.machine;
            let solid = Solid::from_stl(&std::fs::read(path).unwrap());
            let (low, high) = solid.extent();
            let limits = [machine.bed_width, machine.bed_depth, machine.bed_height];
            let is_too_large = (0..3).any(|axis| high[axis] - low[axis] > limits[axis]);
            assert!(is_too_large && says_the_size(&error), "{what}: {error}");
            return;
        }
    };
    let print = Print::read(&text).unwrap_or_else(|e| panic!("{what}: {e}"));
    sound(&print, &settings, &what);
    assert_eq!(report.layers.count, print.layers.len(), "{what}");
    let run = Run { text, print, report, settings };
    let solid = Solid::from_stl(&std::fs::read(path).unwrap()).on_bed(run.middle());
    let count = run.print.layers.len();
    let looked_at: Vec<usize> =
        (0..count).step_by(count.div_ceil(LAYERS_LOOKED_AT)).chain([count - 1]).collect();
    let (out, line) = furthest_out(&run.print, &solid, &looked_at, |_| true);
    assert!(out <= MOST_OUT, "{what}: line {line} reaches {out} mm out of the part");
    let strings = stringing_travels(&run.print, &solid, &run.settings, &looked_at);
    assert!(strings.is_empty(), "{what}: no pull on lines {strings:?}");
    let is_dual = set.contains(&("dual.mode", "pair"));
    for m in run.print.beads().filter(|m| run.print.is_thick(m)) {
        let k = m.layer.unwrap();
        assert!(
            is_dual && k % 2 == 1 && k > 1 && [Kind::Infill, Kind::Support].contains(&m.kind),
            "{what}: line {}",
            m.line
        );
    }
    let material: f64 = run.print.beads().map(|m| m.length() * m.width * m.height).sum();
    let body: f64 = run.report.models.iter().map(|m| m.volume_mm3).sum();
    let support: f64 = run.print.of(Kind::Support).map(|m| m.length() * m.width * m.height).sum();
    assert!(material - support < 1.1 * body, "{what}: {material} mm³ for a part of {body} mm³");
}

#[test]
fn sound_models_print_soundly() {
    let Some(folder) = folder() else { return };
    let mut failures = Vec::new();
    for name in SOUND {
        for (profile, set) in WAYS {
            let path = folder.join(name);
            let run = std::panic::catch_unwind(|| check(&path, profile, set));
            failures.extend(run.err().map(|_| format!("{name} {profile} {set:?}")));
        }
    }
    assert!(failures.is_empty(), "{} failures (see above): {failures:#?}", failures.len());
}

#[test]
fn broken_models_print_or_are_refused_in_one_line() {
    let Some(folder) = folder() else { return };
    let settings =
        settings("generic-marlin", &[("dual.mode", "pair"), ("support.enabled", "true")]);
    let mut seen = 0;
    for entry in std::fs::read_dir(folder.join("broken")).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|e| e != "stl") {
            continue;
        }
        seen += 1;
        let name = path.file_name().unwrap().display().to_string();
        match slice_file(&path, &settings, &as_it_is()) {
            Ok((text, _)) => {
                let print = Print::read(&text).unwrap_or_else(|e| panic!("{name}: {e}"));
                sound(&print, &settings, &name);
            }
            Err(error) => {
                let text = error.to_string();
                assert!(!text.is_empty() && !text.contains('\n'), "{name}: {text:?}");
                assert!([2, 3].contains(&error.exit_code()), "{name}: {text}");
            }
        }
    }
    assert!(seen > 50, "only {seen} broken models were found");
}
