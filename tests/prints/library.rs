//! Embedding the crate: what a job that is refused or cancelled writes, and what it gives back.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common::{as_it_is, fixture, settings};
use slicer::error::{Error, Refusal, Result};
use slicer::mesh::{Placement, Policy};
use slicer::progress::Progress;
use slicer::report::Report;
use slicer::{Job, Model};
use std::io::{Cursor, Seek, SeekFrom, Write};

/// An output that knows what was done to it, and may cancel the run at its first byte.
#[derive(Default)]
struct Watched<'a> {
    text: Cursor<Vec<u8>>,
    touched: usize,
    cancels: Option<&'a Progress>,
}

impl Write for Watched<'_> {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.touched += 1;
        self.cancels.iter().for_each(|progress| progress.cancel());
        self.text.write(bytes)
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

impl Seek for Watched<'_> {
    fn seek(&mut self, to: SeekFrom) -> std::io::Result<u64> {
        self.touched += 1;
        self.text.seek(to)
    }
}

/// A binary STL of a cube of 20 mm, made of these of its faces: bottom, top, front, right, back, left.
fn box_of(faces: &[usize]) -> Vec<u8> {
    const FACES: [[u8; 4]; 6] =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [1, 3, 7, 5], [3, 2, 6, 7], [2, 0, 4, 6]];
    let mut bytes = vec![b' '; 80];
    bytes.extend(u32::try_from(2 * faces.len()).unwrap().to_le_bytes());
    for [a, b, c, d] in faces.iter().map(|&face| FACES[face]) {
        for corners in [[a, b, c], [a, c, d]] {
            bytes.extend([0; 12]);
            for corner in corners {
                let side = |bit: u8| if corner >> bit & 1 == 1 { 20.0_f32 } else { 0.0 };
                bytes.extend([0, 1, 2].map(side).iter().flat_map(|mm| mm.to_le_bytes()));
            }
            bytes.extend([0; 2]);
        }
    }
    bytes
}

fn slice(
    stl: &[u8],
    placement: &Placement,
    out: &mut Watched<'_>,
    progress: &Progress,
) -> Result<Report> {
    let job = Job {
        models: vec![Model::bytes("model.stl", stl)],
        placement: placement.clone(),
        settings: settings("generic-marlin", &[("min_feature", "1")]),
        sources: slicer::profile::Sources::default(),
    };
    slicer::slice(&job, out, progress)
}

/// The refusal, and how often the output was touched by then.
fn refusal(stl: &[u8], placement: &Placement) -> (Refusal, usize) {
    let mut out = Watched::default();
    match slice(stl, placement, &mut out, &Progress::default()) {
        Err(Error::Refused(refusal)) => (refusal, out.touched),
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_refused_job_writes_nothing() {
    let cube = fixture("cube_20.stl");
    let scaled = |scale| Placement { scale, ..as_it_is() };
    let (low, touched) = refusal(&cube, &scaled(0.004));
    assert!(matches!(low, Refusal::TooLow { height_mm: 0.08 }) && touched == 0, "{low:?}");
    let (thin, touched) = refusal(&cube, &scaled(0.015));
    assert!(matches!(thin, Refusal::TooThin { .. }) && touched == 0, "{thin:?}");
    // Without top and right side a box is rather a sheet than a body, and its holes are not filled.
    let (open, touched) = refusal(&box_of(&[0, 2, 4, 5]), &as_it_is());
    let Refusal::Open { layers: 100, layer: 1, gap_mm: 20.0, models } = open else {
        panic!("{open:?}")
    };
    assert!(models == ["model.stl"] && touched == 0, "{models:?}");
}

#[test]
fn a_mesh_that_is_to_be_sliced_as_it_is_is_not_refused_for_its_gaps() {
    let placement = Placement { policy: Policy::Warn, ..as_it_is() };
    let mut out = Watched::default();
    let report = slice(&box_of(&[0, 2, 4, 5]), &placement, &mut out, &Progress::default());
    assert!(report.unwrap().filament.length_mm > 0.0);
    assert!(out.text.into_inner().ends_with(b"\n"));
}

#[test]
fn a_cancelled_run_ends_at_the_next_batch() {
    // Each thread adds a few layers to a batch: with two there are several batches.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().unwrap();
    pool.install(cancel);
}

fn cancel() {
    let progress = Progress::default();
    let mut whole = Watched::default();
    slice(&fixture("cube_20.stl"), &as_it_is(), &mut whole, &progress).unwrap();
    let (done, all) = progress.get();
    assert_eq!((done, all), (100, 100));

    let progress = Progress::default();
    let mut out = Watched { cancels: Some(&progress), ..Watched::default() };
    let error = slice(&fixture("cube_20.stl"), &as_it_is(), &mut out, &progress).unwrap_err();
    assert!(matches!(error, Error::Cancelled), "{error:?}");
    let (done, all) = progress.get();
    assert!(done < all, "{done} of {all}");
    assert!(out.text.get_ref().len() < whole.text.get_ref().len() / 2);

    // One that was cancelled before it began does not begin.
    let mut out = Watched::default();
    let error = slice(&fixture("cube_20.stl"), &as_it_is(), &mut out, &progress).unwrap_err();
    assert!(matches!(error, Error::Cancelled) && out.touched == 0, "{error:?}");
}
