//! Mesh -> Surfaces: the tops of a part that slope gently, and what of its tops is none of them, and why.
//!
//! A *top* is a facet that faces up by 45° or less. A surface is a group of facets (see
//! `facets`) that is large enough, divided where it overlaps itself in plan (see
//! `sheets`). All areas are true areas of the mesh, not areas in plan. What is hidden
//! inside another body counts as it is.

use super::Surface;
use super::facets::{Groups, Lie, groups, in_plan};
use super::sheets::sheets;
use crate::geom::double_area;
use crate::mesh::Mesh;
use crate::mesh::edges::{Adjacency, NONE, parts};
use crate::mesh::geometry::measure::corners_of;
use crate::nonplanar::params::NonPlanarParams;
use crate::units::UNITS_PER_MM;
use rayon::prelude::*;

/// Grid units² in a mm².
const UNITS2: f64 = UNITS_PER_MM * UNITS_PER_MM;

/// A group overlaps itself if its facets have this much more area in plan than its outline, or a
/// thousandth more; mm². Less comes from slivers that fold.
const OVERLAP: f64 = 0.1;

/// What is steeper than this (60°) beside a surface is no top that goes on: the tangent.
const UPRIGHT: f64 = 1.732;

/// The gentle slopes of a mesh, and its other tops.
#[derive(Debug)]
pub struct Surfaces {
    /// The surfaces, in the order of their first triangles.
    pub surfaces: Vec<Surface>,
    /// The areas of all tops.
    pub tops: Tops,
}

/// True areas of facets that face up by 45° or less, mm². What is left of `all` is in surfaces.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Tops {
    /// All of them.
    pub all: f64,
    /// Flatter than the least slope, and in no surface.
    pub level: f64,
    /// Steeper than the head can follow, whatever its flat face.
    pub slope: f64,
    /// Steeper than the flat face may press.
    pub press: f64,
    /// In pieces smaller than the least area.
    pub small: f64,
}

/// The surfaces of a mesh that lies on the bed.
#[must_use]
pub fn surfaces(mesh: &Mesh, adjacency: &Adjacency, params: &NonPlanarParams) -> Surfaces {
    let Groups { lies, members } = groups(mesh, adjacency, params);
    let is_large = |group: &[u32]| {
        let plan: f64 = group.iter().map(|&t| lies[t as usize].plan).sum();
        plan >= params.min_area * UNITS2
    };
    let pieces = members.par_iter().filter(|group| is_large(group));
    let pieces = pieces.flat_map_iter(|group| {
        let all = (mesh, adjacency, &lies[..]);
        let whole = surface(all, group);
        if !overlaps(&whole, &lies, group) {
            return vec![(whole, group.clone())];
        }
        let sheets = sheets(mesh, adjacency, group).into_iter().filter(|sheet| is_large(sheet));
        sheets.map(|sheet| (surface(all, &sheet), sheet)).collect()
    });
    let (surfaces, used): (Vec<Surface>, Vec<Vec<u32>>) =
        pieces.collect::<Vec<_>>().into_iter().unzip();
    let mut is_used = vec![false; lies.len()];
    used.iter().flatten().for_each(|&t| is_used[t as usize] = true);
    Surfaces { surfaces, tops: tops(&lies, &is_used, params) }
}

/// The surface of some triangles, in their order.
fn surface((mesh, adjacency, lies): (&Mesh, &Adjacency, &[Lie]), group: &[u32]) -> Surface {
    let corners = |t: u32| corners_of(&mesh.vertices, mesh.triangles[t as usize]);
    let is_upright = |side: u32| {
        let beside = (side != NONE).then(|| parts(side).0);
        let is_own = |t: usize| group.binary_search(&(t as u32)).is_ok();
        beside.is_none_or(|t| lies[t].slope() > UPRIGHT && !is_own(t))
    };
    let sides = |&t: &u32| {
        let (plan, beside) = (in_plan(&corners(t)), adjacency.neighbour[t as usize]);
        let sides = (0..3).filter(move |&k| is_upright(beside[k]));
        sides.map(move |k| [plan[k], plan[(k + 1) % 3]])
    };
    let upright = group.iter().flat_map(sides).collect();
    Surface::new(group.iter().map(|&t| corners(t)).collect()).with_upright(upright)
}

/// Whether a surface lies above itself somewhere.
fn overlaps(surface: &Surface, lies: &[Lie], group: &[u32]) -> bool {
    let facets: f64 = group.iter().map(|&t| lies[t as usize].plan.max(0.0)).sum();
    let outline: i128 = surface.outline().iter().map(|contour| double_area(contour)).sum();
    let outline = outline as f64 / 2.0;
    facets - outline > (OVERLAP * UNITS2).max(outline / 1_000.0)
}

/// The areas of all tops.
fn tops(lies: &[Lie], is_used: &[bool], params: &NonPlanarParams) -> Tops {
    let tangent = |degrees: f64| libm::tan(degrees.to_radians());
    let (least, most) = (tangent(*params.slopes.start()), tangent(*params.slopes.end()));
    // The uphill edge of the flat face presses by a layer height at most.
    let press = f64::from(params.height) / (params.head.flat / 2.0 * UNITS_PER_MM);
    // Asked only where it tells.
    let mut head = None;
    let mut follows = || *head.get_or_insert_with(|| tangent(params.head.steepest()));
    let mut sums = Tops::default();
    for (lie, &is_used) in lies.iter().zip(is_used) {
        let (slope, area) = (lie.slope(), lie.area / UNITS2);
        if is_used {
            sums.all += area;
        } else if slope <= 1.0 {
            sums.all += area;
            let class = if slope < least {
                &mut sums.level
            } else if slope <= most {
                &mut sums.small
            } else if slope <= press || slope > follows() {
                &mut sums.slope
            } else {
                &mut sums.press
            };
            *class += area;
        }
    }
    sums
}
