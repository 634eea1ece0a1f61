//! Sloped tops of the thesis, printed flat -> the roughness that steps of a layer must have.
//!
//! The models are not part of the project: `SLICER_MODELS` names their folder. Unset, this test passes
//! with a message.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]
#![allow(clippy::print_stdout, reason = "a test that is skipped says so")]

use crate::common::{as_it_is, settings, slice_file};
use slicer::Model;
use slicer::progress::Progress;
use slicer::reader::{Reading, Source, Stream};
use slicer::roughness::{Options, Roughness, roughness};
use std::path::{Path, PathBuf};

/// Each part, and Ra of its flat print with layers of 0.2 mm, Gauss 8 mm, µm.
const FLAT: [(&str, f64); 4] = [
    ("surf_wedge_4p76deg.stl", 49.8),
    ("surf_arc_3mm.stl", 46.5),
    ("surf_piva_waves.stl", 48.5),
    ("surf_hypar.stl", 48.9),
];

fn of_print(path: &Path) -> Roughness {
    let settings = settings("generic-marlin", &[]);
    let (text, _) = slice_file(path, &settings, &as_it_is()).unwrap();
    let models = [Model::path(path.to_str().unwrap())];
    let bed = slicer::bed(&settings.machine);
    let placed = slicer::place(&models, &as_it_is(), &bed, &Progress::default()).unwrap();
    let stream = Stream::open(Source::of_bytes(text.into_bytes()), Reading::default(), 1.75);
    let model = slicer::roughness::Model {
        mesh: &placed.mesh,
        adjacency: &placed.adjacency,
        offset: placed.offset,
        lift: None,
    };
    roughness(&stream.unwrap(), model, &Options { cutoff: 8.0 }).unwrap()
}

#[test]
fn flat_prints_of_slopes_are_as_rough_as_their_steps() {
    let Some(folder) = std::env::var_os("SLICER_MODELS").map(PathBuf::from) else {
        println!("skipped: SLICER_MODELS does not name a folder of models");
        return;
    };
    for (name, expected) in FLAT {
        let path = folder.join("thesis").join(name);
        if !path.is_file() {
            println!("skipped: {} is not there", path.display());
            continue;
        }
        let whole = of_print(&path).whole;
        let ra = whole.filtered.ra_um.unwrap();
        assert!((ra - expected).abs() < 0.02 * expected, "{name}: {ra} µm for {expected}");
        assert!(whole.coverage > 0.99, "{name}: {}", whole.coverage);
        assert!(whole.mean_um.unwrap().abs() < 5.0, "{name}: {whole:?}");
    }
}
