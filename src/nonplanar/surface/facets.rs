//! Mesh -> Groups: how each triangle lies, and which of them make one gentle slope.
//!
//! Words: the *bend* of an edge is the angle between the normals of its two triangles. A *sliver* is a
//! triangle narrower than [`SLIVER`]: rounding to the grid, or the few digits of a file, may turn it
//! anyhow. It lies as what lies beside its long sides.
//!
//! 1. Each triangle gets a normal; slivers that of a neighbour.
//! 2. It is *sloped* if its slope is one that skins may have, *level* if flatter.
//! 3. Sloped ones, and level ones, hang together over edges that bend by less than the most.
//! 4. A group of level ones is *adopted* by the slopes around it if it is narrow, and a quarter of its
//!    border or more bends gently into a slope. The top of an arc or a wave crosses slope 0: it may not
//!    leave a gap. Narrow means that no circle of [`NARROW`] line widths fits into it: a plateau is wider.
//!
//! How narrow: an arc of radius r is flatter than an angle a over a strip of 2·r·sin(a) about its top. Eight
//! lines of 0.4 mm are that strip of half a degree at a radius of 183 mm.

use super::rim::rim;
use crate::geom::sets::Sets;
use crate::geom::{Point, polygon};
use crate::mesh::Mesh;
use crate::mesh::edges::{Adjacency, NONE, parts};
use crate::mesh::geometry::measure::corners_of;
use crate::mesh::geometry::vector::{Corner, distance2, length, normal};
use crate::nonplanar::params::NonPlanarParams;
use crate::units::Coord;
use rayon::prelude::*;

/// Triangles narrower than this (0.01 mm) are slivers: a corner that is off by a grid unit tilts them
/// by half a degree and more.
const SLIVER: f64 = 100.0;

/// Slivers in a row that take the slope of what lies beside them.
const ROUNDS: usize = 8;

/// A level group into which no circle of so many line widths fits is narrow.
const NARROW: i32 = 8;

/// How a triangle lies.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lie {
    /// Unit normal, of a sliver that of what lies beside it; zero if there is nothing.
    pub normal: [f64; 3],
    /// True area, grid units².
    pub area: f64,
    /// Area in plan, grid units²; negative if it faces down.
    pub plan: f64,
}

impl Lie {
    /// The tangent of its slope; infinite if it does not face up.
    #[must_use]
    pub(super) fn slope(&self) -> f64 {
        let [x, y, z] = self.normal;
        if z > 0.0 { x.hypot(y) / z } else { f64::INFINITY }
    }
}

/// Of what use a triangle is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Class {
    Sloped,
    Level,
    Other,
}

/// Of what use triangles that lie so are.
#[must_use]
pub(super) fn classes(lies: &[Lie], params: &NonPlanarParams) -> Vec<Class> {
    let tangent = |degrees: f64| libm::tan(degrees.to_radians());
    let slopes = tangent(*params.slopes.start())..=tangent(*params.slopes.end());
    let class = |lie: &Lie| match lie.slope() {
        slope if slopes.contains(&slope) => Class::Sloped,
        slope if slope < *slopes.start() => Class::Level,
        _ => Class::Other,
    };
    lies.par_iter().map(class).collect()
}

/// Triangles of gentle slopes by what hangs together: those of each group in their order, groups in the order
/// of their first triangles.
#[must_use]
pub(super) fn groups(
    mesh: &Mesh,
    adjacency: &Adjacency,
    (lies, mut classes): (&[Lie], Vec<Class>),
    params: &NonPlanarParams,
) -> Vec<Vec<u32>> {
    let most = libm::cos(params.max_bend.to_radians());
    let joins = |t: usize, u: usize| {
        let ([ax, ay, az], [bx, by, bz]) = (lies[t].normal, lies[u].normal);
        ax * bx + ay * by + az * bz > most
    };
    let mut sets = Sets::new(lies.len());
    for (t, sides) in adjacency.neighbour.iter().enumerate() {
        for &side in sides.iter().filter(|&&side| side != NONE) {
            let (u, _) = parts(side);
            if u > t && classes[t] != Class::Other && classes[t] == classes[u] && joins(t, u) {
                sets.join(t, u);
            }
        }
    }
    adopt(mesh, adjacency, params, (lies, &mut classes, &mut sets), joins);
    gathered(&mut sets, |t| classes[t] == Class::Sloped)
}

/// The triangles of each set that `holds` for, in their order.
fn gathered(sets: &mut Sets, holds: impl Fn(usize) -> bool) -> Vec<Vec<u32>> {
    let mut of = vec![NONE; sets.len()];
    let mut members: Vec<Vec<u32>> = Vec::new();
    for (number, t) in (0_u32..).zip(0..sets.len()) {
        if !holds(t) {
            continue;
        }
        let root = sets.root(t);
        if of[root] == NONE {
            of[root] = u32::try_from(members.len()).unwrap_or(NONE);
            members.push(Vec::new());
        }
        members[of[root] as usize].push(number);
    }
    members
}

/// How the triangles lie.
#[must_use]
pub(super) fn lies(mesh: &Mesh, adjacency: &Adjacency) -> Vec<Lie> {
    let lie = |&triangle: &[u32; 3]| {
        let corners = corners_of(&mesh.vertices, triangle);
        let across = normal(corners);
        let twice = length(across);
        let [a, b, c] = sides2_of(&corners);
        let longest = (a.max(b).max(c) as f64).sqrt();
        let is_sliver = twice <= SLIVER * longest;
        let part = |v: i64| if is_sliver { 0.0 } else { v as f64 / twice };
        let normal = [part(across[0]), part(across[1]), part(across[2])];
        (Lie { normal, area: twice / 2.0, plan: across[2] as f64 / 2.0 }, is_sliver)
    };
    let (mut lies, slivers): (Vec<Lie>, Vec<bool>) = mesh.triangles.par_iter().map(lie).unzip();
    let mut open: Vec<usize> = (0..lies.len()).filter(|&t| slivers[t]).collect();
    for _ in 0..ROUNDS {
        let known = |&t: &usize| Some((t, beside(mesh, adjacency, &lies, t)?));
        let found: Vec<(usize, [f64; 3])> = open.iter().filter_map(known).collect();
        if found.is_empty() {
            break;
        }
        for (t, normal) in found {
            lies[t].normal = normal;
        }
        open.retain(|&t| lies[t].normal == [0.0; 3]);
    }
    // Among slivers only: their own is the best there is.
    for t in open {
        let own = normal(corners_of(&mesh.vertices, mesh.triangles[t]));
        let twice = length(own);
        if twice > 0.0 {
            lies[t].normal = own.map(|v| v as f64 / twice);
        }
    }
    lies
}

/// The normal of what lies beside a sliver: over its longest side that has one. Not over a short side: a
/// strip of many slivers ends there, at what it is no part of.
fn beside(mesh: &Mesh, adjacency: &Adjacency, lies: &[Lie], t: usize) -> Option<[f64; 3]> {
    let sides = sides_of(&corners_of(&mesh.vertices, mesh.triangles[t]));
    let longest = sides.into_iter().fold(0.0, f64::max);
    let normal = |&edge: &usize| match adjacency.neighbour[t][edge] {
        NONE => None,
        half => Some(lies[parts(half).0].normal).filter(|normal| *normal != [0.0; 3]),
    };
    let mut order: Vec<usize> = (0..3).filter(|&edge| 4.0 * sides[edge] >= longest).collect();
    order.sort_by(|&a, &b| sides[b].total_cmp(&sides[a]));
    order.iter().find_map(normal)
}

/// The lengths of a triangle's sides, grid units.
fn sides_of(corners: &[Corner; 3]) -> [f64; 3] {
    sides2_of(corners).map(|square| (square as f64).sqrt())
}

/// Their squares.
fn sides2_of([a, b, c]: &[Corner; 3]) -> [i64; 3] {
    [distance2(*a, *b), distance2(*b, *c), distance2(*c, *a)]
}

/// Makes narrow level groups part of the slopes around them.
fn adopt(
    mesh: &Mesh,
    adjacency: &Adjacency,
    params: &NonPlanarParams,
    (lies, classes, sets): (&[Lie], &mut [Class], &mut Sets),
    joins: impl Fn(usize, usize) -> bool,
) {
    // Borders of each level triangle: all of them, and those into slopes.
    let mut borders = vec![[0.0_f64; 2]; lies.len()];
    let mut doors = Vec::new();
    for (t, sides) in adjacency.neighbour.iter().enumerate() {
        if classes[t] != Class::Level {
            continue;
        }
        let root = sets.root(t);
        let lengths = sides_of(&corners_of(&mesh.vertices, mesh.triangles[t]));
        for (&side, length) in sides.iter().zip(lengths) {
            let beside = (side != NONE).then(|| parts(side).0);
            if beside.is_some_and(|u| classes[u] == Class::Level && sets.root(u) == root) {
                continue;
            }
            borders[root][0] += length;
            if let Some(u) = beside.filter(|&u| classes[u] == Class::Sloped && joins(t, u)) {
                borders[root][1] += length;
                doors.push((t, u));
            }
        }
    }
    let level = |t: usize| classes[t] == Class::Level;
    let groups = gathered(sets, level);
    let wide = params.line_width.saturating_mul(NARROW);
    let is_adopted = |group: &Vec<u32>| {
        let [all, gentle] = borders[group[0] as usize];
        gentle > 0.0 && 4.0 * gentle >= all && is_narrow(mesh, lies, group, all, wide)
    };
    let adopted: Vec<bool> = groups.par_iter().map(is_adopted).collect();
    for (group, _) in groups.iter().zip(adopted).filter(|(_, adopted)| *adopted) {
        group.iter().for_each(|&t| classes[t as usize] = Class::Sloped);
    }
    for (t, u) in doors {
        if classes[t] == Class::Sloped {
            sets.join(t, u);
        }
    }
}

/// Whether no circle of this diameter fits into a group with this length of border.
fn is_narrow(mesh: &Mesh, lies: &[Lie], group: &[u32], border: f64, wide: Coord) -> bool {
    // Cheap answers first: an area is at most its greatest inner circle's radius times its border.
    let area: f64 = group.iter().map(|&t| lies[t as usize].plan.max(0.0)).sum();
    if 2.0 * area > f64::from(wide) * border {
        return false;
    }
    let plan =
        group.iter().map(|&t| in_plan(&corners_of(&mesh.vertices, mesh.triangles[t as usize])));
    let outline = rim(plan);
    polygon::inset(&outline, (wide / 2).max(1)).is_empty()
}

/// The corners of a triangle in plan.
#[must_use]
pub(super) fn in_plan(corners: &[Corner; 3]) -> [Point; 3] {
    corners.map(|[x, y, _]| Point { x, y })
}
