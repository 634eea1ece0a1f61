//! Solids -> prints: makes solids in code, slices them, reads the G-code back and checks it, for all tests.

#![allow(dead_code, reason = "no test uses all of it")]
#![allow(unused_imports, reason = "no test uses all of it")]
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

pub(crate) mod board;
pub(crate) mod checks;
pub(crate) mod damage;
pub(crate) mod gcode;
pub(crate) mod raster;
pub(crate) mod relief;
pub(crate) mod section;
pub(crate) mod slope;
pub(crate) mod solid;
pub(crate) mod stack;

use slicer::error::Result;
use slicer::mesh::Placement;
use slicer::profile::{Override, Settings, ValueOrigin, load};
use slicer::progress::Progress;
use slicer::report::Report;
use slicer::{Job, Model};
use std::path::{Path, PathBuf};

pub(crate) use gcode::{Kind, Move, Print};
pub(crate) use section::Section;
pub(crate) use solid::Solid;

/// What a run made.
pub(crate) struct Run {
    pub(crate) text: String,
    pub(crate) print: Print,
    pub(crate) report: Report,
    pub(crate) settings: Settings,
}

/// The warnings of a run but for walls that hang: the bracket has a hat.
pub(crate) fn beside_droop(run: &Run) -> Vec<slicer::warning::Warning> {
    let hangs =
        |w: &&slicer::warning::Warning| matches!(w, slicer::warning::Warning::WallsHang { .. });
    run.report.warnings.iter().filter(|w| !hangs(w)).cloned().collect()
}

impl Run {
    /// The middle of the bed in the machine's coordinates, where models are put.
    pub(crate) fn middle(&self) -> [f64; 2] {
        checks::bed(&self.settings).map(|[low, high]| (low + high) / 2.0)
    }

    /// mm³ of filament for each mm of it.
    pub(crate) fn filament_area(&self) -> f64 {
        let d = self.settings.filament.diameter;
        std::f64::consts::PI * d * d / 4.0
    }
}

/// One model, resting on the bed's middle as it is.
pub(crate) fn as_it_is() -> Placement {
    Placement::default()
}

/// What makes a print stick, cool and look well changes speeds, skins and first layers. Laws about
/// other things are held without it.
const PLAIN: [(&str, &str); 6] = [
    ("cooling.min_layer_time", "0"),
    ("speed.first_layer", "100"),
    ("speed.first_layer_max", "999"),
    ("brim.where", "off"),
    ("top_thickness", "0"),
    ("bottom_thickness", "0"),
];

/// The effective settings of `profile` with `set` laid over it, as `--set` would, and over what is
/// [plain](PLAIN).
pub(crate) fn settings(profile: &str, set: &[(&str, &str)]) -> Settings {
    shipped(profile, &[&PLAIN, set].concat())
}

/// The effective settings of `profile` with `set` laid over it, as `--set` would.
pub(crate) fn shipped(profile: &str, set: &[(&str, &str)]) -> Settings {
    let overrides: Vec<Override> = set
        .iter()
        .map(|(key, value)| Override {
            key: (*key).to_owned(),
            value: (*value).to_owned(),
            origin: ValueOrigin::Set,
        })
        .collect();
    load([profile], &overrides).unwrap().settings
}

/// Slices the file at `path`.
pub(crate) fn slice_file(
    path: &Path,
    settings: &Settings,
    placement: &Placement,
) -> Result<(String, Report)> {
    let job = Job {
        models: vec![Model::path(path.to_str().unwrap())],
        placement: placement.clone(),
        settings: settings.clone(),
        sources: slicer::profile::Sources::default(),
    };
    let mut out = std::io::Cursor::new(Vec::new());
    let report = slicer::slice(&job, &mut out, &Progress::default())?;
    Ok((String::from_utf8(out.into_inner()).unwrap(), report))
}

/// Slices `stl` (a file's bytes) in this process, laid out as `placement` says.
pub(crate) fn slice_placed(
    stl: &[u8],
    profile: &str,
    set: &[(&str, &str)],
    placement: &Placement,
) -> Run {
    slice_with(stl, settings(profile, set), placement)
}

/// Slices `stl` with these settings, laid out as `placement` says.
pub(crate) fn slice_with(stl: &[u8], settings: Settings, placement: &Placement) -> Run {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("model.stl");
    std::fs::write(&path, stl).unwrap();
    let (text, report) = slice_file(&path, &settings, placement).unwrap();
    let print = Print::read(&text).unwrap();
    Run { text, print, report, settings }
}

/// Slices `stl` in the middle of the bed.
pub(crate) fn slice(stl: &[u8], profile: &str, set: &[(&str, &str)]) -> Run {
    slice_placed(stl, profile, set, &as_it_is())
}

/// As [`slice`], with all that makes a print stick, cool and look well.
pub(crate) fn slice_shipped(stl: &[u8], profile: &str, set: &[(&str, &str)]) -> Run {
    slice_with(stl, shipped(profile, set), &as_it_is())
}

/// The bytes of a file of `fixtures/`.
pub(crate) fn fixture(name: &str) -> Vec<u8> {
    std::fs::read(fixtures().join(name)).unwrap()
}

/// The folder `fixtures/`, of this package or, in `tests/fuzz`, of the one above.
pub(crate) fn fixtures() -> PathBuf {
    let folders = Path::new(env!("CARGO_MANIFEST_DIR")).ancestors();
    folders.map(|folder| folder.join("fixtures")).find(|folder| folder.is_dir()).unwrap()
}
