//! Slices STL models into G-code for FDM printers, with dual injection: walls
//! and skins at the fine layer height, sparse infill on one layer of each pair
//! with twice the material.
//!
//! The modules in the order of the way an STL takes; [`slice()`] shows it whole:
//!
//! - [`mesh`]: bytes -> triangles, welded, mended and laid on the bed
//! - [`mod@slice`]: triangles -> layers of closed contours
//! - [`region`]: layers -> walls, and spans of skin, sparse infill and support
//! - [`plan`]: regions -> paths in order, with travels
//! - [`gcode`]: paths -> text
//! - [`render`]: triangles -> a picture, for the head of the file
//!
//! Another way, from any slicer's G-code to its time: [`reader`] (text -> moves), [`motion`] (moves and
//! limits -> seconds), [`mod@estimate`] (seconds by role and layer), [`mod@check`] (moves and model -> what is
//! wrong), [`preview`] (pictures).
//!
//! Beside the way: [`job`] (what a run is asked for), [`geom`] and [`units`] (plane geometry on the integer grid),
//! [`profile`] (settings), [`motion`] (moves -> time), [`reader`] and [`mod@estimate`] (G-code of any slicer -> time),
//! [`mod@compare`] (ways to print -> what each saves), [`mod@diff`] (two G-code files -> whether they print the same), [`report`], [`progress`], [`warning`] and [`error`].
//! The command line is the binary's own.

pub mod check;
pub mod compare;
pub mod diff;
pub mod error;
pub mod estimate;
pub mod gcode;
pub mod geom;
pub mod job;
pub mod mesh;
pub mod motion;
pub mod plan;
pub mod preview;
pub mod profile;
pub mod progress;
pub mod reader;
pub mod region;
pub mod render;
pub mod report;
pub mod slice;
pub mod units;
pub mod warning;

use error::{Error, Result};
use geom::Point;
use profile::template::PrintFacts;
use rayon::prelude::*;
use std::collections::VecDeque;
use units::to_units;

pub use job::{Job, NAME};

/// Batches of layers that are planned before the first is written: about as many as take as
/// long as the pictures do.
const AHEAD: usize = 2;

/// Slices `job` and writes the G-code to `out`, which is empty yet.
///
/// # Errors
/// Every [`error::Error`]; what was written to `out` until then is no usable G-code.
pub fn slice(
    job: &Job,
    out: &mut dyn gcode::Output,
    progress: &progress::Progress,
) -> Result<report::Report> {
    let placed = place(&job.models, &job.placement, &bed(&job.settings.machine))?;
    slice_placed(job, &placed, out, progress)
}

/// Reads models, `-` being standard input, and lays them on a bed.
///
/// # Errors
/// Those of reading and placing: [`Error::Input`], [`Error::Usage`], [`Error::Unprintable`].
pub fn place(
    models: &[String],
    placement: &mesh::Placement,
    bed: &mesh::Bed,
) -> Result<mesh::place::Placed> {
    let load = |file: &String| mesh::read::load(file, placement.max_triangles);
    let models = models.iter().map(load).collect::<Result<_>>()?;
    mesh::place::place(models, placement, bed)
}

/// As [`slice()`], of the models as [`place`] gave them.
///
/// # Errors
/// As [`slice()`].
pub fn slice_placed(
    job: &Job,
    placed: &mesh::place::Placed,
    out: &mut dyn gcode::Output,
    progress: &progress::Progress,
) -> Result<report::Report> {
    let bed = bed(&job.settings.machine);
    let heights = heights(&job.settings, placed)?;
    let facts = print_facts(placed, heights);
    progress.set_total(heights.count);
    let tolerance = to_units(job.settings.tolerance);
    let (settings, slicer) = rayon::join(
        || settle(&job.settings, &placed.mesh),
        || slice::Slicer::new(&placed.mesh, &placed.adjacency, heights, tolerance),
    );
    let settings = &settings;

    let params = region::Params::new(settings);
    let support = region::support::SupportParams::new(settings);
    let on_bed = bed_corners(&bed, placed.offset);
    let supports = support.map(|s| region::window::Support {
        comb: s.comb(),
        rows: region::support::supports(&slicer, &s, on_bed),
    });
    let plan = plan::PlanParams::new(settings, &params, support);

    let grouping = region::groups::Grouping::new(&settings.dual, settings.dual_ratio());
    let window = region::window::Window::new(&slicer, &params, &grouping, supports);
    let orderer = Orderer { plan, at: None, tally: report::Tally::default() };
    let mut planner = Planner { window, regions: None, orderer };
    // The pictures stand in the file's head: they are drawn while the first layers are planned.
    let (pictures, mut planned) = rayon::join(
        || thumbnails(settings, placed),
        || planner.by_ref().take(AHEAD).collect::<VecDeque<_>>(),
    );
    let pictures = pictures.map_err(|source| {
        let action = "cannot draw the thumbnails";
        Error::Output { file: job.output.clone(), action, source }
    })?;
    let mut writer =
        gcode::Writer::new(out, &job.output, settings, facts, placed.offset, &pictures)?;
    while let Some(toolpaths) = planned.pop_front() {
        // Layers are written while the next are planned, no more of them than are needed.
        let is_last = planned.is_empty();
        let (written, next) =
            rayon::join(|| writer.layers(&toolpaths), || is_last.then(|| planner.next()).flatten());
        written?;
        progress.add(toolpaths.len());
        planned.extend(next);
    }
    let Planner { mut window, orderer: Orderer { tally, .. }, .. } = planner;
    let audits = window.audits();
    let sums = writer.finish()?;
    report::report(job, placed, heights, &sums, &audits, &tally)
}

/// Plans the layers, some at a time.
struct Planner<'a> {
    window: region::window::Window<'a>,
    /// The regions of the next layers.
    regions: Option<Vec<region::Region>>,
    orderer: Orderer,
}

impl Iterator for Planner<'_> {
    type Item = Vec<plan::Toolpath>;

    fn next(&mut self) -> Option<Self::Item> {
        let regions = self.regions.take().or_else(|| self.window.next())?;
        // Where one of the two waits for its last layer the other goes on.
        let (toolpaths, next) =
            rayon::join(|| self.orderer.toolpaths(&regions), || self.window.next());
        self.regions = next;
        Some(toolpaths)
    }
}

/// Regions -> toolpaths, layer after layer.
struct Orderer {
    plan: plan::PlanParams,
    /// Where the nozzle is after the layers so far.
    at: Option<Point>,
    tally: report::Tally,
}

impl Orderer {
    fn toolpaths(&mut self, regions: &[region::Region]) -> Vec<plan::Toolpath> {
        let plan = &self.plan;
        let pieces: Vec<plan::Pieces> = regions.par_iter().map(|r| plan::pieces(r, plan)).collect();
        // Where a layer ends decides how the next is best begun: one after the other.
        let mut ordered = Vec::with_capacity(regions.len());
        for (region, pieces) in regions.iter().zip(pieces) {
            let (height, from) = (region.layer.height, self.at.unwrap_or_default());
            let paths = plan::order::order(pieces, height, from, plan);
            let end = paths.last().map(plan::Path::end).or(self.at);
            ordered.push((region, std::mem::replace(&mut self.at, end), paths));
            self.tally.layer(region);
        }
        let toolpaths = ordered.into_par_iter();
        toolpaths.map(|(r, from, paths)| plan::toolpath(r, paths, from, plan)).collect()
    }
}

/// The settings with what depends on the model decided.
fn settle(settings: &profile::Settings, mesh: &mesh::Mesh) -> profile::Settings {
    let angle = match settings.angle {
        profile::Angle::Auto(_) => profile::Angle::Degrees(region::angle::least_turns(mesh)),
        given => given,
    };
    profile::Settings { angle, ..settings.clone() }
}

/// Pictures of the models, of the sizes that the host wants.
fn thumbnails(
    settings: &profile::Settings,
    placed: &mesh::place::Placed,
) -> std::io::Result<Vec<gcode::hosts::Thumbnail>> {
    let draw = |&profile::PictureSize { width, height }| {
        let size = [width, height];
        let (faces, ground) = (render::Faces::of(placed.is_sound), render::Ground::Transparent);
        let png = render::draw(&placed.mesh, faces, size, ground).png()?;
        Ok(gcode::hosts::Thumbnail { width, height, png })
    };
    settings.machine.thumbnails.par_iter().map(draw).collect()
}

/// What the start and end blocks may want to know.
fn print_facts(placed: &mesh::place::Placed, heights: slice::Heights) -> PrintFacts {
    let half = [placed.size_mm[0] / 2.0, placed.size_mm[1] / 2.0];
    let [x, y] = placed.offset;
    PrintFacts {
        layers: heights.count,
        min: [x - half[0], y - half[1]],
        max: [x + half[0], y + half[1]],
        height: units::to_mm(heights.top(heights.count.saturating_sub(1))),
    }
}

/// The space that the machine has.
#[must_use]
pub fn bed(machine: &profile::Machine) -> mesh::Bed {
    let size = [machine.bed_width, machine.bed_depth];
    let min = match machine.origin {
        profile::Origin::Centre => size.map(|side| -side / 2.0),
        profile::Origin::FrontLeft => [0.0, 0.0],
    };
    let max = [min[0] + size[0], min[1] + size[1]];
    mesh::Bed { min, max, height: machine.bed_height }
}

/// The bed's corners as seen from the middle of the layout, grid units.
fn bed_corners(bed: &mesh::Bed, offset: [f64; 2]) -> (Point, Point) {
    let corner =
        |at: [f64; 2]| Point { x: to_units(at[0] - offset[0]), y: to_units(at[1] - offset[1]) };
    (corner(bed.min), corner(bed.max))
}

/// What layers through a mesh enclose, mm³; what overlaps counts once. As exact as some hundred
/// layers are.
#[must_use]
pub fn solid_mm3(mesh: &mesh::Mesh, adjacency: &mesh::edges::Adjacency) -> f64 {
    /// More layers take longer and tell little more.
    const LAYERS: i32 = 400;
    let top = top(mesh);
    let height = (top / LAYERS).max(1);
    let slicer = slice::Slicer::new(mesh, adjacency, slice::Heights::new(height, height, top), 1);
    let blocks = (0..slicer.blocks()).flat_map(|block| slicer.block(block));
    let volume: f64 = blocks.map(|layer| layer.volume_mm3()).sum();
    // The last layer is cut off by the top, or does not reach it.
    volume * f64::from(top) / f64::from(height) / slicer.heights().count.max(1) as f64
}

/// The layers that the models are cut into, at least one.
fn heights(settings: &profile::Settings, placed: &mesh::place::Placed) -> Result<slice::Heights> {
    let top = top(&placed.mesh);
    let (first, other) = (to_units(settings.first_layer_height), to_units(settings.layer_height));
    let heights = slice::Heights::new(first, other, top);
    if heights.count > 0 {
        return Ok(heights);
    }
    let height = placed.size_mm[2];
    Err(Error::Unprintable(format!(
        "nothing to print: {height:.3} mm is less than half a layer high; \
         use thinner layers, --scale or --unit"
    )))
}

/// The highest corner of a mesh, grid units.
fn top(mesh: &mesh::Mesh) -> units::Coord {
    mesh.vertices.iter().map(|v| v[2]).max().unwrap_or(0)
}
