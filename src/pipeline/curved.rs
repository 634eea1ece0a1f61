//! Mesh and layers -> Curved: the patches of non-planar skin, for the stages that leave room for them and print them.

use super::lift::Lift;
use crate::geom::raster::Raster;
use crate::geom::{Point, edges};
use crate::mesh::place::Placed;
use crate::nonplanar;
use crate::nonplanar::base::Base;
use crate::nonplanar::contour::Contours;
use crate::nonplanar::find::{Surfaces, surfaces};
use crate::nonplanar::params::NonPlanarParams;
use crate::nonplanar::{Patch, Patches, Props, Scene};
use crate::plan::PrintMove;
use crate::profile::Settings;
use crate::region::curved::CurvedTops;
use crate::region::window::Support;
use crate::report::nonplanar::{NonPlanarReport, report};
use crate::slice::Slicer;
use crate::units::{Coord, to_mm, to_units};

/// The surfaces of a mesh, and the patches on them.
pub struct Found {
    surfaces: Surfaces,
    patches: Patches,
    contours: Option<Contours>,
}

impl Found {
    /// What is told of them, on a print that is lifted by a raft.
    #[must_use]
    pub fn report(&self, lift: &Lift) -> NonPlanarReport {
        report(&self.patches, (lift.layers(), to_mm(lift.by())))
    }
}

/// The patches of a job, if it asks for any. Settings and support are those of the layers.
#[must_use]
pub fn find(
    settings: &Settings,
    placed: &Placed,
    slicer: &Slicer<'_>,
    support: Option<&Support>,
) -> Option<Found> {
    if !settings.nonplanar.enabled {
        return None;
    }
    let params = NonPlanarParams::new(settings);
    let surfaces = surfaces(&placed.mesh, &placed.adjacency, &params);
    let lines = |k: usize| support.map_or_else(Vec::new, |support| lines(support, k));
    let props = support.map(|_| Props {
        lines: &lines,
        width: params.line_width,
        gap: to_units(settings.support.z_distance),
    });
    let ceiling = to_units(settings.machine.bed_height) - Lift::new(settings).by();
    let scene = Scene {
        slicer,
        surfaces: &surfaces,
        bodies: &placed.bodies,
        support: props,
        ceiling,
        params: &params,
    };
    let mut patches = nonplanar::patches(&scene);
    let contours = settings.nonplanar.contour.then(|| {
        let min_height = to_units(settings.nonplanar.min_height);
        let contours = Contours::new(&placed.mesh, &placed.adjacency, &params, min_height);
        contours.tell(&surfaces, &mut patches);
        contours.beside(&patches)
    });
    Some(Found { surfaces, patches, contours })
}

/// The places that support of layer `k` may take, as lines beside each other.
fn lines(support: &Support, k: usize) -> Vec<[Point; 2]> {
    let Some(layer) = support.layers.get(k) else { return Vec::new() };
    let Support { patterns, .. } = support;
    let body = patterns.body.iter().zip(&layer.body);
    let interface = patterns.interface.iter().zip(&layer.interface);
    let areas = body.chain(interface).flat_map(|(pattern, rows)| {
        let Raster { frame, pitch } = pattern.raster();
        rows.iter().flat_map(move |(j, row)| {
            let at = move |u: Coord| frame.leave(Point { x: u, y: j * pitch });
            row.iter().map(move |span| [at(span.start), at(span.end)]).collect::<Vec<_>>()
        })
    });
    let outlines = layer.outlines.iter().flat_map(|outline| edges(outline).map(|(a, b)| [a, b]));
    areas.chain(outlines).collect()
}

/// Patches, and what is left of the layers below them.
pub struct Curved<'a> {
    patches: &'a Patches,
    base: Base<'a>,
    contours: Option<&'a Contours>,
    /// Whether travels to patches pull the filament back.
    retracts: bool,
}

impl<'a> Curved<'a> {
    /// The patches on these `surfaces`.
    #[must_use]
    pub fn new(found: &'a Found, settings: &Settings) -> Self {
        let Found { surfaces, patches, contours } = found;
        let height = to_units(settings.layer_height);
        Self {
            patches,
            base: patches.base(surfaces, height),
            contours: contours.as_ref(),
            retracts: settings.retraction.length > 0.0,
        }
    }

    /// For the layers below the patches.
    #[must_use]
    pub fn tops(&self) -> &dyn CurvedTops {
        &self.base
    }

    /// The slopes whose lines rise and fall within their layer.
    #[must_use]
    pub fn contours(&self) -> Option<&Contours> {
        self.contours
    }

    /// What is printed after the paths of layer `k`, in its order.
    #[must_use]
    pub fn after(&self, k: usize) -> Vec<PrintMove> {
        let moves = |patch: &'a Patch| {
            patch.strokes.iter().map(|stroke| PrintMove {
                retract: self.retracts && stroke.over > 0,
                over: stroke.over,
                patch: Some(patch.number),
                ..PrintMove::to(stroke.path.clone())
            })
        };
        self.patches.after(k).flat_map(moves).collect()
    }

    /// The highest place of all patches above the bed, grid units; 0 without any.
    #[must_use]
    pub fn highest(&self) -> Coord {
        self.patches.patches.iter().map(|patch| patch.bounds[1]).max().unwrap_or(0)
    }
}
