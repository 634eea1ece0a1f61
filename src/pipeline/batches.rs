//! Slicer -> toolpaths -> Writer: plans the layers in batches, the next while one is written.
//!
//! A *batch* is some layers whose regions are ready. Of each batch
//! 1. the first layer of all is made anew if its lines have a width of their own;
//! 2. all layers are filled side by side, and the first layer of all gets what makes it stick;
//! 3. their paths are put in order one after the other, since each begins where the last one ended;
//! 4. their travels are planned side by side;
//! 5. a raft lifts them; its own layers come before the first.
//!
//! All code that names the numbers of `region`, `fill` and `plan` stands here and in no other file of
//! the pipeline.
//!
//! - The *setup* is what the settings mean for the three stages, and what heights and bodies add to it.
//! - The *planner* makes regions of a batch while the *orderer* fills and orders those of the one before.

use super::curved::Curved;
use super::droop::{self, Stretch};
use super::footing::Footing;
use super::footprint::{Footprint, Rules, footprint};
use super::raise::raise;
use super::sticking::{Sticking, Stuck};
use crate::error::{Refusal, Result};
use crate::fill::adhesion::lift::Lift;
use crate::fill::{self, FillParams, Path};
use crate::gcode::Writer;
use crate::geom::Point;
use crate::plan::order::{self, Unordered};
use crate::plan::{Nozzle, PlanParams, Seams, Toolpath, travel};
use crate::profile::Settings;
use crate::progress::Progress;
use crate::region::dual::audit::Audit;
use crate::region::dual::groups::Grouping;
use crate::region::prepare::prepare;
use crate::region::support::{SupportParams, supports};
use crate::region::window::{Support, Window};
use crate::region::{Region, RegionParams, foot};
use crate::report::tally::Tally;
use crate::slice::{Heights, Slicer};
use crate::units::to_units;
use rayon::prelude::*;
use std::collections::VecDeque;

/// Batches that are planned before the first is written. Planning this many takes about as long
/// as drawing the thumbnails, which runs at the same time. More would only take more memory.
const AHEAD: usize = 2;

/// What the settings mean for `region`, `fill` and `plan`.
pub struct Setup {
    region: RegionParams,
    rules: Rules,
    support: Option<SupportParams>,
    grouping: Grouping,
    fill: FillParams,
    plan: PlanParams,
    /// The numbers of the first layer, if its lines have a width of their own.
    first: Option<(RegionParams, FillParams)>,
    lift: Lift,
}

impl Setup {
    /// The numbers that `settings` mean, for layers at `heights` and these `bodies`, of which the
    /// lowest and the highest corner are given.
    #[must_use]
    pub fn new(settings: &Settings, heights: &Heights, bodies: &[[Point; 2]]) -> Self {
        let region = |settings: &Settings| region(settings, heights, bodies);
        let first = settings.in_first_width();
        let first = first.map(|wide| (region(&wide), FillParams::new(&wide, heights)));
        Self {
            region: region(settings),
            first,
            rules: Rules::new(settings),
            support: SupportParams::new(settings),
            grouping: Grouping::new(&settings.dual, settings.dual_ratio()),
            fill: FillParams::new(settings, heights),
            plan: PlanParams::new(settings),
            lift: Lift::new(settings),
        }
    }

    /// The support of the layers of `slicer`, if there is any; it stands within these corners of the bed.
    #[must_use]
    pub fn supports(&self, slicer: &Slicer<'_>, bed: (Point, Point)) -> Option<Support> {
        let of = |s: SupportParams| Support {
            patterns: s.patterns(),
            layers: supports(slicer, &s, bed),
        };
        self.support.map(of)
    }

    /// How many of the layers are printed, from the lowest on, and what those above add up to, which have nothing
    /// that is thick enough for a line. All, if nothing is: then the job is refused for that. Cuts the highest
    /// layers once more.
    #[must_use]
    pub fn printed(&self, slicer: &Slicer<'_>) -> (usize, Tally) {
        let mut left_out = Tally::default();
        for block in (0..slicer.blocks()).rev() {
            for layer in slicer.block(block).into_iter().rev() {
                let count = layer.index + 1;
                let (own, rows) = prepare(layer, &self.region);
                let is_filled = [0, 1].iter().any(|&r| !rows.skin(r).fill.is_empty());
                if is_filled || !own.walls.is_empty() {
                    return (count, left_out);
                }
                left_out.add(&own.layer, own.thin_mm2);
            }
        }
        (slicer.heights().count(), Tally::default())
    }

    /// Ready to plan the layers of `slicer`, with their support and under these curved tops. Layers that are
    /// `left_out` above them count for what is told.
    #[must_use]
    pub fn planner<'a>(
        &'a self,
        slicer: &'a Slicer<'a>,
        support: Option<Support>,
        curved: Option<&'a Curved<'a>>,
        footing: Footing,
        sticking: Sticking<'a>,
        left_out: Tally,
    ) -> Planner<'a> {
        let window = Window::new(slicer, &self.region, &self.grouping, support);
        let window = window.under(curved.map(Curved::tops));
        let window = Regions { window, first: self.first.as_ref().map(|(region, _)| region) };
        let orderer = Orderer {
            rules: self.rules,
            fill: &self.fill,
            first: self.first.as_ref().map(|(_, fill)| fill),
            plan: &self.plan,
            lift: &self.lift,
            nozzle: Nozzle::default(),
            seams: Seams::default(),
            tally: left_out,
            footing,
            sticking,
            curved,
        };
        Planner { window, regions: None, orderer }
    }
}

/// The numbers of the region stage.
fn region(settings: &Settings, heights: &Heights, bodies: &[[Point; 2]]) -> RegionParams {
    let mut region = RegionParams::new(settings);
    // No more can be skin than there is; each layer looks at as many neighbours as this.
    let count = |count: usize, thickness: f64| {
        count.max(heights.layers_of(to_units(thickness))).min(heights.count())
    };
    region.skins.top = count(region.skins.top, settings.top_thickness);
    region.skins.bottom = count(region.skins.bottom, settings.bottom_thickness);
    if let Some(ironing) = &mut region.ironing {
        ironing.bodies = bodies.to_vec();
    }
    region
}

/// Makes the regions of the next batch. The first layer's are those of its own lines.
struct Regions<'a> {
    window: Window<'a>,
    first: Option<&'a RegionParams>,
}

impl Iterator for Regions<'_> {
    type Item = Vec<Region>;

    fn next(&mut self) -> Option<Vec<Region>> {
        let mut regions = self.window.next()?;
        if let Some(params) = self.first.take() {
            let first = regions.remove(0);
            regions.insert(0, foot::widen(first, params));
        }
        Some(regions)
    }
}

/// Plans the layers, a batch at a time.
pub struct Planner<'a> {
    window: Regions<'a>,
    /// The regions of the next batch.
    regions: Option<Vec<Region>>,
    orderer: Orderer<'a>,
}

impl Planner<'_> {
    /// Plans the first batches.
    pub fn ahead(&mut self) -> VecDeque<Vec<Toolpath>> {
        self.by_ref().take(AHEAD).collect()
    }

    /// What was done so that the print sticks; known once the first batch is planned.
    ///
    /// # Errors
    /// [`Refusal::BesideBed`].
    pub fn stuck(&self) -> Result<Stuck, Refusal> {
        self.orderer.sticking.stuck()
    }

    /// What dual injection did, what the layers add up to, and what they stand on.
    #[must_use]
    pub fn finish(self) -> (Vec<Audit>, Tally, Footing) {
        let Self { mut window, orderer, .. } = self;
        (window.window.audits(), orderer.tally, orderer.footing)
    }
}

impl Iterator for Planner<'_> {
    type Item = Vec<Toolpath>;

    fn next(&mut self) -> Option<Self::Item> {
        let regions = self.regions.take().or_else(|| self.window.next())?;
        // While one of the two waits for its last layer, the other keeps the threads busy.
        let (toolpaths, next) =
            rayon::join(|| self.orderer.toolpaths(&regions), || self.window.next());
        self.regions = next;
        Some(toolpaths)
    }
}

/// Fills regions and orders the paths of layer after layer.
struct Orderer<'a> {
    rules: Rules,
    fill: &'a FillParams,
    /// Of the first layer, if they are others.
    first: Option<&'a FillParams>,
    plan: &'a PlanParams,
    lift: &'a Lift,
    /// Where the nozzle is after the layers so far.
    nozzle: Nozzle,
    seams: Seams,
    tally: Tally,
    footing: Footing,
    sticking: Sticking<'a>,
    curved: Option<&'a Curved<'a>>,
}

/// What a layer stands by.
type Ground = (Footprint, Vec<Stretch>);

impl Orderer<'_> {
    fn toolpaths(&mut self, regions: &[Region]) -> Vec<Toolpath> {
        let (fill, plan, rules) = (self.fill, self.plan, self.rules);
        let first = self.first.unwrap_or(fill);
        let filled = |region: &Region| {
            let paths = fill::paths(region, if region.layer.index == 0 { first } else { fill });
            let ground = (footprint(region, &paths, rules), droop::stretches(&paths));
            (ground, self.bent(region, paths))
        };
        let mut filled: Vec<(Ground, Vec<Path>)> = regions.par_iter().map(filled).collect();
        for (region, (_, paths)) in regions.iter().zip(&mut filled) {
            self.sticking.layer(&region.layer, paths);
        }
        let unordered = |(region, (ground, paths)): (&Region, (Ground, Vec<Path>))| {
            (ground, Unordered::new(paths, &region.layer.contours, plan))
        };
        let unordered: Vec<(Ground, Unordered)> =
            regions.par_iter().zip(filled).map(unordered).collect();
        // The end of a layer decides where the next begins, so that they are ordered in sequence.
        let mut ordered = Vec::with_capacity(regions.len());
        for (region, ((footprint, stretches), paths)) in regions.iter().zip(unordered) {
            let at = self.nozzle.at.unwrap_or_default();
            let paths = order::order(paths, at, &mut self.seams, plan);
            let skins = self.curved.map(|c| c.after(region.layer.index)).unwrap_or_default();
            let next = self.nozzle.after(&region.layer, &paths);
            let k = region.layer.index;
            let next = self.curved.map_or(next, |c| c.nozzle_after(next, k, &skins));
            ordered.push((region, std::mem::replace(&mut self.nozzle, next), paths, skins));
            self.tally.layer(region);
            self.footing.layer(footprint, &stretches, region);
        }
        let toolpaths = ordered.into_par_iter();
        let toolpaths = toolpaths.map(|(region, from, paths, skins)| {
            let mut toolpath = travel::toolpath(&region.layer, paths, from, plan);
            skins.into_iter().for_each(|skin| skin.add_to(&mut toolpath, plan));
            toolpath
        });
        self.lifted(toolpaths.collect())
    }

    /// Paths of a region that follow its slopes where no skin does.
    fn bent(&self, region: &Region, mut paths: Vec<Path>) -> Vec<Path> {
        if let Some(contours) = self.curved.and_then(Curved::contours) {
            contours.bend(&region.layer, region.above.as_deref(), &mut paths);
        }
        paths
    }

    /// The toolpaths, lifted by the raft. Before the first of them come those of the raft.
    fn lifted(&mut self, mut toolpaths: Vec<Toolpath>) -> Vec<Toolpath> {
        raise(&mut toolpaths, self.lift);
        let (mut nozzle, mut seams) = (Nozzle::default(), Seams::default());
        let courses = self.sticking.raft().into_iter().map(|(layer, paths)| {
            let paths = Unordered::new(paths, &layer.contours, self.plan);
            let paths = order::order(paths, nozzle.at.unwrap_or_default(), &mut seams, self.plan);
            let next = nozzle.after(&layer, &paths);
            travel::toolpath(&layer, paths, std::mem::replace(&mut nozzle, next), self.plan)
        });
        let mut courses: Vec<Toolpath> = courses.collect();
        if let Some(first) = toolpaths.first_mut().filter(|_| !courses.is_empty()) {
            first.from = nozzle;
        }
        courses.append(&mut toolpaths);
        courses
    }
}

/// Writes the batches that are planned, and the rest while it is planned.
///
/// # Errors
/// Those of writing; [`Error::Cancelled`](crate::error::Error::Cancelled).
pub fn write(
    writer: &mut Writer<'_>,
    mut planned: VecDeque<Vec<Toolpath>>,
    planner: &mut Planner<'_>,
    progress: &Progress,
) -> Result<()> {
    while let Some(toolpaths) = planned.pop_front() {
        progress.go_on()?;
        // No more batches are planned than are needed to go on.
        let is_last = planned.is_empty();
        let (written, next) =
            rayon::join(|| writer.layers(&toolpaths), || is_last.then(|| planner.next()).flatten());
        written?;
        progress.add(toolpaths.len());
        planned.extend(next);
    }
    Ok(())
}
