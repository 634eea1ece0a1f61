//! Slices STL models into G-code for FDM printers, with dual injection: walls
//! and skins at the fine layer height, sparse infill on one layer of each pair
//! with twice the material.
//!
#![doc = include_str!("guide/embedding.md")]
//!
//! # Modules
//!
//! In the order of the flow, which [`slice_placed`] shows in one function:
//!
//! | module | in -> out |
//! |---|---|
//! | [`profile`] | TOML -> settings |
//! | [`mesh`] | bytes -> triangles: welded, mended, laid on the bed |
//! | [`mod@slice`] | triangles -> layers of closed contours |
//! | [`nonplanar`] | gentle tops -> skins that follow the surface, and their room in the layers |
//! | [`region`] | layers -> walls, and spans of skin, sparse infill and support |
//! | [`fill`] | regions -> paths |
//! | [`plan`] | paths -> paths in order, with travels |
//! | [`gcode`] | paths in order -> text |
//! | [`pipeline`] | the stages put together, batch by batch |
//!
//! From the G-code of any slicer:
//!
//! | module | in -> out |
//! |---|---|
//! | [`reader`] | text -> moves |
//! | [`motion`] | moves and limits -> seconds |
//! | [`mod@estimate`] | moves -> time by role and layer |
//! | [`mod@check`] | moves and model -> what is wrong |
//! | [`mod@diff`] | two files -> whether they print the same |
//! | [`mod@roughness`] | moves and model -> how rough its tops are |
//! | [`preview`] | moves -> pictures |
//! | [`steps`] | moves -> steps of motors, and back |
//!
//! Beside the flow:
//!
//! | module | what it holds |
//! |---|---|
//! | [`job`], [`progress`] | what a run is asked for, and how far it is |
//! | [`report`], [`warning`], [`error`] | what a run gives back |
//! | [`mod@compare`] | one job, printed in several ways -> what each saves |
//! | [`pattern`] | how sparse lines run |
//! | [`head`] | what hangs around the nozzle, and what it would touch |
//! | [`geom`], [`units`] | plane geometry on the integer grid |
//! | [`text`] | names and texts of files, made safe to show |
//! | [`render`] | triangles -> a picture |
//!
//! The command line is the binary's own. [`guide`] has the words, the reasons, and where to add what.

pub mod check;
pub mod compare;
pub mod diff;
pub mod error;
pub mod estimate;
pub mod fill;
pub mod gcode;
pub mod geom;
pub mod guide;
pub mod head;
pub mod job;
pub mod mesh;
pub mod motion;
pub mod nonplanar;
pub mod pattern;
pub mod pipeline;
pub mod plan;
pub mod preview;
pub mod profile;
pub mod progress;
pub mod reader;
pub mod region;
pub mod render;
pub mod report;
pub mod roughness;
pub mod slice;
pub mod steps;
pub mod text;
pub mod units;
pub mod warning;

pub use job::{Job, Model, NAME};
pub use pipeline::place::{bed, place, suited};
pub use pipeline::spool::slice_to;

use error::{Error, Refusal, Result};
use fill::adhesion::lift::Lift;
use pipeline::batches::{self, Setup};
use pipeline::curved::{self, Curved};
use pipeline::footing::Footing;
use pipeline::phase;
use pipeline::place::{bed_corners, print_facts};
use pipeline::prime;
use pipeline::refuse;
use pipeline::sticking::Sticking;
use pipeline::thumbnails::thumbnails;

/// Slices `job` and writes the G-code to `out`, which is empty yet.
///
/// # Errors
/// Every [`error::Error`]. A job is refused before anything is written, but for
/// [`Refusal::Hanging`], which is only known at the end. What a run that was refused so, that was
/// cancelled, or that cannot write on, has written until then is no usable G-code.
pub fn slice(
    job: &Job,
    out: &mut dyn gcode::Output,
    progress: &progress::Progress,
) -> Result<report::Report> {
    let bed = bed(&job.settings.machine);
    let placement = suited(&job.placement, &job.settings);
    let placed = place(&job.models, &placement, &bed, progress)?;
    slice_placed(job, &placed, out, progress)
}

/// As [`slice()`], of the models as [`place`] gave them, [`suited`] to the settings.
///
/// # Errors
/// As [`slice()`].
pub fn slice_placed(
    job: &Job,
    placed: &mesh::place::Placed,
    out: &mut dyn gcode::Output,
    progress: &progress::Progress,
) -> Result<report::Report> {
    let placed = &*phase::in_phase(&job.settings, placed);
    // Mesh -> layers; each block of them is cut when the stages after it ask for it.
    let heights = pipeline::heights(&job.settings, placed)?;
    let lift = Lift::new(&job.settings);
    let (settings, slicer) = rayon::join(
        || pipeline::settle(&job.settings, &placed.mesh),
        || pipeline::slicer(&job.settings, placed, heights.clone()),
    );
    refuse::gaps(job, placed, &slicer, progress)?;
    // Tips that are too thin for a line have no layers.
    let (printed, left_out) = Setup::new(&settings, &heights, &placed.bodies).printed(&slicer);
    let (heights, slicer) = (heights.lowest(printed), slicer.lowest(printed));
    progress.set_total(heights.count() + lift.layers());

    // Tops whose skins follow the surface: known before the first layer, since its base is lower.
    let setup = Setup::new(&settings, &heights, &placed.bodies);
    let corners = bed_corners(&bed(&settings.machine), placed.offset);
    let support = setup.supports(&slicer, corners);
    let found = curved::find(&settings, placed, &slicer, support.as_ref());
    let curved = found.as_ref().map(|found| Curved::new(found, &slicer));
    let layers = curved.as_ref().map_or(heights.count(), Curved::layers);
    let (heights, slicer) = (heights.lowest(layers), slicer.lowest(layers));

    // Layers -> regions -> toolpaths, in batches. The thumbnails stand in the head of the file:
    // they are drawn while the first batches are planned.
    let footing = Footing::new(&settings, placed.offset);
    let sticking = Sticking::new(&settings, placed, &heights, corners);
    let mut planner = setup.planner(&slicer, support, curved.as_ref(), footing, sticking, left_out);
    let (pictures, planned) = rayon::join(|| thumbnails(&settings, placed), || planner.ahead());

    // Toolpaths -> text, one batch while the next is planned.
    let pictures = pictures.map_err(Error::Thumbnails)?;
    let stuck = planner.stuck()?;
    let highest = curved.as_ref().map_or(0, Curved::highest);
    let facts = print_facts(placed, (&heights, highest), &lift, stuck.extent);
    let first = planned.front().and_then(|batch| batch.first());
    prime::refuse(&settings, &facts, placed.offset, first)?;
    let mut writer = gcode::Writer::new(out, &settings, facts, placed.offset, &pictures)?;
    batches::write(&mut writer, planned, &mut planner, progress)?;
    let (audits, tally, footing) = planner.finish();
    let hangs = footing.finish().map_err(Refusal::Hanging)?;
    // Nothing is written if nothing is extruded.
    let sums = writer.finish()?.ok_or_else(|| refuse::thin(&settings))?;

    let mut report = report::make::report(job, placed, &heights, &sums, &audits, &tally);
    report.warnings.extend(hangs);
    report.warnings.extend(stuck.warning);
    report.brim = stuck.brim;
    report.raft = stuck.raft;
    report.nonplanar = found.map(|found| found.report(heights.count(), &lift));
    report.warnings.extend(report.nonplanar.as_ref().and_then(report::nonplanar::unused));
    Ok(report)
}
