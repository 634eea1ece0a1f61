//! Mesh and layers -> Curved: the patches of non-planar skin, for the stages that leave room for them and print them.
//!
//! Words: a *patch* is skins over one piece of a surface; its *base* is what is printed level below; a *coat* is
//! a patch as it is printed, after the paths of its layer.
//!
//! 1. Patches are [found](find) before the first layer is planned: support, a tall skirt and the other bodies stand
//!    in their way.
//! 2. Layers are cut to what the base leaves of them; those of which nothing is left are not printed.
//! 3. After the paths of a layer come the coats that wait for it.

use crate::fill::Path;
use crate::fill::adhesion::lift::Lift;
use crate::geom::hull::hull;
use crate::geom::{Point, polygon};
use crate::head::named;
use crate::mesh::place::Placed;
use crate::nonplanar;
use crate::nonplanar::base::Base;
use crate::nonplanar::contour::{self, Contours};
use crate::nonplanar::params::NonPlanarParams;
use crate::nonplanar::surface::find::{Surfaces, surfaces, surfaces_for};
use crate::nonplanar::{Patch, Patches, Props, Scene, Skirt, support_lines};
use crate::plan::{Nozzle, PlanParams, Toolpath, travel};
use crate::profile::Settings;
use crate::region::curved::CurvedTops;
use crate::region::window::Support;
use crate::report::nonplanar::{NonPlanarReport, report};
use crate::slice::{Heights, Layer, Slicer};
use crate::units::{Coord, to_mm, to_units};

/// The surfaces of a mesh, and the patches on them.
pub struct Found {
    params: NonPlanarParams,
    surfaces: Surfaces,
    patches: Patches,
    contours: Option<Contours>,
}

impl Found {
    /// What is told of them, on a print of `layers` layers that is lifted by a raft.
    #[must_use]
    pub fn report(&self, layers: usize, lift: &Lift) -> NonPlanarReport {
        let head = named::name_of(&self.params.head);
        let lift = (lift.layers(), to_mm(lift.by()));
        NonPlanarReport { head, ..report(&self.patches, layers, lift) }
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
    let (mesh, adjacency) = (&placed.mesh, &placed.adjacency);
    let (surfaces, slopes) = if settings.nonplanar.contour {
        let [own, slopes] = surfaces_for(mesh, adjacency, [&params, &contour::gentle(&params)]);
        (own, Some(slopes))
    } else {
        (surfaces(mesh, adjacency, &params), None)
    };
    let lines = |k: usize| {
        let support = support.and_then(|support| Some((support.layers.get(k)?, &support.patterns)));
        support.map_or_else(Vec::new, |(layer, patterns)| support_lines(layer, patterns))
    };
    let props = support.map(|_| Props {
        lines: &lines,
        width: params.line_width,
        gap: to_units(settings.support.z_distance),
    });
    let skirt = skirt(settings, placed, slicer);
    let ceiling = to_units(settings.machine.bed_height) - Lift::new(settings).by();
    let scene = Scene {
        slicer,
        surfaces: &surfaces,
        bodies: &placed.bodies,
        support: props,
        skirt: skirt.as_ref(),
        ceiling,
        params: &params,
    };
    let (mut patches, fields) = nonplanar::patches_and_fields(&scene);
    let contours = slopes.map(|slopes| {
        let min_height = to_units(settings.nonplanar.min_height);
        let contours = Contours::new(&slopes, fields, &params, min_height);
        contours.tell(&surfaces, &mut patches);
        contours.beside(&patches)
    });
    Some(Found { params, surfaces, patches, contours })
}

/// The skirt beside the parts, if it is higher than a layer. It is laid later, around all lines of the first
/// layer and all corners of the parts up to its top.
fn skirt(settings: &Settings, placed: &Placed, slicer: &Slicer<'_>) -> Option<Skirt> {
    let (skirt, heights) = (&settings.skirt, slicer.heights());
    let layers = (skirt.layers as usize).saturating_sub(Lift::new(settings).layers());
    let last = layers.min(heights.count()).checked_sub(1)?;
    if skirt.loops == 0 || skirt.layers < 2 {
        return None;
    }
    let top = heights.top(last);
    let first = slicer.block(0);
    let outline = first.first().into_iter().flat_map(|layer| layer.contours.iter().flatten());
    let beside = placed.mesh.vertices.iter().filter(|v| v[2] <= top);
    let corners = beside.map(|&[x, y, _]| Point { x, y });
    let around = hull(outline.copied().chain(corners).collect());
    // Lines keep half a line within the outline, and the skirt's own is as wide.
    let near = to_units(skirt.distance).saturating_sub(to_units(settings.line_width)).max(1);
    Some(Skirt { inside: polygon::outset(&[around], near), top })
}

/// Patches, and what is left of the layers below them.
pub struct Curved<'a> {
    patches: &'a Patches,
    /// The layers that are printed: of those above nothing is left.
    heights: Heights,
    base: Base<'a>,
    contours: Option<&'a Contours>,
    /// Travels keep so far above patches, grid units.
    clearance: Coord,
}

impl<'a> Curved<'a> {
    /// The patches that were `found`, over the layers of `slicer`.
    #[must_use]
    pub fn new(found: &'a Found, slicer: &Slicer<'_>) -> Self {
        let Found { params, surfaces, patches, contours } = found;
        let base = patches.base(surfaces, params);
        Self {
            patches,
            heights: slicer.heights().clone().lowest(layers(&base, slicer)),
            base,
            contours: contours.as_ref(),
            clearance: params.clearance,
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

    /// How many of the layers are printed, from the lowest on; skins take the place of those above.
    #[must_use]
    pub fn layers(&self) -> usize {
        self.heights.count()
    }

    /// The patches that are printed after the paths of layer `k`, in their order. The z of their points is
    /// relative to that layer's top.
    #[must_use]
    pub fn after(&self, k: usize) -> Vec<Coat> {
        let last = self.layers().saturating_sub(1);
        let here = self.patches.patches.iter().filter(|patch| patch.layer.min(last) == k);
        here.map(|patch| self.coat(patch, k)).collect()
    }

    fn coat(&self, patch: &Patch, k: usize) -> Coat {
        // A patch may have waited for a layer of which nothing is left.
        let up = patch.top - self.heights.top(k);
        let strokes = patch.strokes.iter().map(|stroke| {
            let mut path = stroke.path.clone();
            path.points.iter_mut().for_each(|point| point.z += up);
            (path, stroke.over)
        });
        let (paths, over) = strokes.unzip();
        Coat { number: patch.number, paths, over }
    }

    /// The nozzle once the patches after layer `k` are printed as well; `nozzle` is that after its paths.
    #[must_use]
    pub fn nozzle_after(&self, nozzle: Nozzle, k: usize, coats: &[Coat]) -> Nozzle {
        let z = self.heights.top(k);
        coats.iter().fold(nozzle, |nozzle, coat| nozzle.after_patch(z, &coat.paths, self.clearance))
    }

    /// The highest place of all patches above the bed, grid units; 0 without any.
    #[must_use]
    pub fn highest(&self) -> Coord {
        self.patches.patches.iter().map(|patch| patch.bounds[1]).max().unwrap_or(0)
    }
}

/// A patch as it is printed.
pub struct Coat {
    number: u32,
    paths: Vec<Path>,
    /// How high the travel to each goes.
    over: Vec<Coord>,
}

impl Coat {
    /// Adds it to the toolpath of its layer.
    pub fn add_to(self, toolpath: &mut Toolpath, params: &PlanParams) {
        travel::add_patch(toolpath, self.number, self.paths.into_iter().zip(self.over), params);
    }
}

/// How many layers of `slicer` have something left on the `base`, from the lowest on. All, where none has anything:
/// then there was nothing, and the job is refused for that.
fn layers(base: &Base<'_>, slicer: &Slicer<'_>) -> usize {
    let is_left = |layer: &&Layer| !base.cut(Layer::clone(layer)).contours.is_empty();
    let last = |block| slicer.block(block).iter().rev().find(is_left).map(|layer| layer.index + 1);
    (0..slicer.blocks()).rev().find_map(last).unwrap_or_else(|| slicer.heights().count())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Mesh;
    use crate::mesh::edges::adjacency;

    #[test]
    fn a_part_of_which_nothing_is_cut_keeps_its_layers() {
        // A needle: too thin for a contour at the middle of its layer.
        let vertices = vec![[0, 0, 0], [40, 0, 0], [0, 40, 0], [0, 0, 2_000]];
        let mesh = Mesh { vertices, triangles: vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]] };
        let heights = Heights::even(2_000, 2_000, 2_000);
        let adjacency = adjacency(&mesh.vertices, &mesh.triangles);
        let slicer = Slicer::new(&mesh, &adjacency, heights, 100);
        assert!(slicer.block(0)[0].contours.is_empty());
        assert_eq!(layers(&Base::default(), &slicer), 1);
    }
}
