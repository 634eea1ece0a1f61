//! Mesh -> Surfaces: the tops of a part that slope gently, and what of its tops is none of them, and why.
//!
//! A *top* is a facet that faces up by 45° or less. A surface is a group of facets (see
//! `facets`) that is large enough, divided where it overlaps itself in plan (see
//! `sheets`). All areas are true areas of the mesh, not areas in plan. What is hidden
//! inside another body counts as it is.

use super::Surface;
use super::facets::{Lie, classes, groups, in_plan, lies};
use super::sheets::sheets;
use crate::geom::double_area;
use crate::mesh::Mesh;
use crate::mesh::edges::{Adjacency, NONE, parts};
use crate::mesh::geometry::measure::corners_of;
use crate::nonplanar::params::NonPlanarParams;
use crate::units::UNITS_PER_MM;
use rayon::prelude::*;
use std::sync::Arc;

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
    pub surfaces: Vec<Arc<Surface>>,
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
    let lies = lies(mesh, adjacency);
    let members = groups(mesh, adjacency, (&lies, classes(&lies, params)), params);
    let found = found(mesh, adjacency, (&lies, &members), params.min_area);
    large(&found, &lies, params)
}

/// The same for two ways of looking at a mesh, which differ in slopes and least area. Surfaces that are the
/// same in both are made once.
#[must_use]
pub fn surfaces_for(
    mesh: &Mesh,
    adjacency: &Adjacency,
    [one, other]: [&NonPlanarParams; 2],
) -> [Surfaces; 2] {
    let lies = lies(mesh, adjacency);
    let [first, second] = [one, other].map(|params| classes(&lies, params));
    let is_same = first == second && one.max_bend == other.max_bend;
    let members = groups(mesh, adjacency, (&lies, first), one);
    if is_same {
        let least = one.min_area.min(other.min_area);
        let found = found(mesh, adjacency, (&lies, &members), least);
        return [one, other].map(|params| large(&found, &lies, params));
    }
    let of = |members: &[Vec<u32>], params: &NonPlanarParams| {
        let found = found(mesh, adjacency, (&lies, members), params.min_area);
        large(&found, &lies, params)
    };
    let own = groups(mesh, adjacency, (&lies, second), other);
    [of(&members, one), of(&own, other)]
}

/// A surface with what it is made of.
struct Found {
    surface: Arc<Surface>,
    triangles: Vec<u32>,
    /// Area in plan, grid units²: the lesser of its own and that of the group that it is a sheet of.
    plan: f64,
}

/// The surfaces of some groups that are so large in plan, mm².
fn found(
    mesh: &Mesh,
    adjacency: &Adjacency,
    (lies, members): (&[Lie], &[Vec<u32>]),
    least: f64,
) -> Vec<Found> {
    let plan = |group: &[u32]| group.iter().map(|&t| lies[t as usize].plan).sum::<f64>();
    let made = |triangles: Vec<u32>, surface: Surface, plan: f64| Found {
        surface: Arc::new(surface),
        triangles,
        plan,
    };
    let groups = members.par_iter().map(|group| (group, plan(group)));
    let large = groups.filter(|(_, plan)| *plan >= least * UNITS2);
    let found = large.flat_map_iter(|(group, all)| {
        let whole = surface((mesh, adjacency, lies), group);
        if !overlaps(&whole, lies, group) {
            return vec![made(group.clone(), whole, all)];
        }
        let sheets = sheets(mesh, adjacency, group).into_iter().map(|sheet| (plan(&sheet), sheet));
        let sheets = sheets.filter(|(own, _)| *own >= least * UNITS2);
        let sheet = |(own, sheet): (f64, Vec<u32>)| {
            let surface = surface((mesh, adjacency, lies), &sheet);
            made(sheet, surface, all.min(own))
        };
        sheets.map(sheet).collect()
    });
    found.collect()
}

/// Those of some surfaces that are large enough, and the areas of all tops.
fn large(found: &[Found], lies: &[Lie], params: &NonPlanarParams) -> Surfaces {
    let large = || found.iter().filter(|one| one.plan >= params.min_area * UNITS2);
    let mut is_used = vec![false; lies.len()];
    large().flat_map(|one| &one.triangles).for_each(|&t| is_used[t as usize] = true);
    let surfaces = large().map(|one| Arc::clone(&one.surface)).collect();
    Surfaces { surfaces, tops: tops(lies, &is_used, params) }
}

/// The surface of some triangles, in their order.
fn surface((mesh, adjacency, lies): (&Mesh, &Adjacency, &[Lie]), group: &[u32]) -> Surface {
    let corners = |&t: &u32| corners_of(&mesh.vertices, mesh.triangles[t as usize]);
    // Most neighbours are the triangles before and after.
    let holds = |u: u32, k: usize| {
        let near = k.saturating_sub(1)..(k + 2).min(group.len());
        group[near].contains(&u) || group.binary_search(&u).is_ok()
    };
    let open = |(k, &t): (usize, &u32)| {
        adjacency.neighbour[t as usize].map(|side| side == NONE || !holds(parts(side).0 as u32, k))
    };
    let open: Vec<[bool; 3]> = group.iter().enumerate().map(open).collect();
    let is_upright = |side: u32| side == NONE || lies[parts(side).0].slope() > UPRIGHT;
    let sides = |(t, open): (&u32, &[bool; 3])| {
        let (plan, beside) = (in_plan(&corners(t)), adjacency.neighbour[*t as usize]);
        let open = *open;
        let sides = (0..3).filter(move |&k| open[k] && is_upright(beside[k]));
        sides.map(move |k| [plan[k], plan[(k + 1) % 3]])
    };
    let upright = group.iter().zip(&open).flat_map(sides).collect();
    Surface::new(group.iter().map(corners).collect(), open).with_upright(upright)
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
