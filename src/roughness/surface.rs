//! Mesh -> Surface: the facets that face up by 45° or less, in patches, and samples of them.
//!
//! Words used here: a *facet* is a triangle of the mesh; its *gradient* is how it rises along x and along
//! y; a *sample* is the surface over the middle of a cell.
//!
//! Facets are joined over edges at which the surface bends by less than [`BEND`]. Each piece is a patch,
//! the largest first. A place may have samples of several patches, one above the other; where a patch
//! overlaps itself, as a spiral ramp does, only its highest place counts.

use crate::mesh::Mesh;
use crate::mesh::edges::{Adjacency, NONE, parts};
use crate::units::{Coord, UNITS_PER_MM};
use nalgebra::Vector3;
use rayon::prelude::*;

/// Steepest slope of a facet, degrees.
pub(super) const STEEPEST: f64 = 45.0;

/// Bend at an edge that parts patches, degrees.
const BEND: f64 = 30.0;

/// Finest and usual coarsest cell, grid units, and cells of the bed up to which each is taken. A plate
/// beyond the second gets cells as coarse as it needs.
const CELLS: [(Coord, f64); 2] = [(500, 4e6), (1000, 16e6)];

/// Slack of a sine or a share, for what lies right at a limit.
const SLACK: f64 = 1e-9;

/// A triangle that faces up.
#[derive(Debug, Clone)]
struct Facet {
    corners: [[i32; 3]; 3],
    /// How it rises along x and y.
    gradient: [f64; 2],
    patch: u32,
}

/// The tops of a part.
#[derive(Debug)]
pub(super) struct Surface {
    facets: Vec<Facet>,
    /// Number of patches.
    pub(super) patches: usize,
    /// Lowest and highest x and y, grid units from the middle of the layout.
    low: [i32; 2],
    high: [i32; 2],
}

/// The surface over the middle of a cell.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sample {
    /// Number of the cell: row times width plus place in the row.
    pub(super) cell: u32,
    pub(super) patch: u32,
    /// Height, grid units.
    pub(super) z: Coord,
    /// How it rises along x and y.
    pub(super) gradient: [f32; 2],
}

impl Sample {
    /// The cosine of its slope.
    pub(super) fn cosine(&self) -> f64 {
        let [x, y] = self.gradient.map(f64::from);
        1.0 / (1.0 + x * x + y * y).sqrt()
    }

    /// Its slope, degrees.
    pub(super) fn slope(&self) -> f64 {
        libm::acos(self.cosine().min(1.0)).to_degrees()
    }
}

/// Square cells over the surface.
#[derive(Debug, Clone, Copy)]
pub(super) struct Grid {
    /// Side of a cell, grid units.
    pub(super) cell: Coord,
    /// Lower left corner of the first, grid units from the middle of the layout.
    pub(super) low: [i32; 2],
    /// Cells along x and y.
    pub(super) size: [usize; 2],
}

impl Grid {
    /// Places along an axis whose middles lie from `low` to `high`, grid units: from the first, up to the
    /// one before the second.
    pub(super) fn range(&self, axis: usize, low: f64, high: f64) -> (usize, usize) {
        let at = |units: f64| (units - f64::from(self.low[axis])) / f64::from(self.cell) - 0.5;
        let most = self.size[axis] as f64;
        let first = (at(low) - SLACK).ceil().clamp(0.0, most);
        let end = ((at(high) + SLACK).floor() + 1.0).clamp(first, most);
        (first as usize, end as usize)
    }

    /// The middle of a place along an axis, grid units.
    pub(super) fn middle(&self, axis: usize, place: usize) -> f64 {
        f64::from(self.low[axis]) + (place as f64 + 0.5) * f64::from(self.cell)
    }
}

impl Surface {
    /// The tops of a mesh; `None` if nothing of it faces up by 45° or less.
    pub(super) fn new(mesh: &Mesh, adjacency: &Adjacency) -> Option<Self> {
        let corners = |triangle: &[u32; 3]| triangle.map(|corner| mesh.vertices[corner as usize]);
        let normals: Vec<Option<Vector3<f64>>> =
            mesh.triangles.par_iter().map(|triangle| normal(corners(triangle))).collect();
        let patch_of = patches(mesh, adjacency, &normals);
        let patches = patch_of.iter().flatten().max().map_or(0, |last| *last as usize + 1);
        let all = mesh.triangles.iter().zip(&normals).zip(&patch_of);
        let facets: Vec<Facet> = all
            .filter_map(|((triangle, normal), patch)| {
                let (normal, patch) = ((*normal)?, (*patch)?);
                let gradient = [-normal.x / normal.z, -normal.y / normal.z];
                Some(Facet { corners: corners(triangle), gradient, patch })
            })
            .collect();
        let all = || facets.iter().flat_map(|facet| facet.corners);
        let end =
            |axis: usize| Some((all().map(|at| at[axis]).min()?, all().map(|at| at[axis]).max()?));
        let ((left, right), (front, back)) = (end(0)?, end(1)?);
        Some(Self { facets, patches, low: [left, front], high: [right, back] })
    }

    /// Side of a cell that is fine and leaves them few enough, grid units.
    pub(super) fn cell(&self) -> Coord {
        let side = |axis: usize| f64::from(self.high[axis]) - f64::from(self.low[axis]);
        let area = side(0).max(1.0) * side(1).max(1.0);
        let fits =
            |&&(cell, most): &&(Coord, f64)| area / f64::from(cell) / f64::from(cell) <= most;
        match CELLS.iter().find(fits) {
            Some((cell, _)) => *cell,
            None => (area / CELLS[1].1).sqrt().ceil() as Coord,
        }
    }

    /// Cells of this side that cover it.
    pub(super) fn grid(&self, cell: Coord) -> Grid {
        let size = |axis: usize| {
            let side = f64::from(self.high[axis]) - f64::from(self.low[axis]);
            (side / f64::from(cell)).ceil().max(1.0) as usize
        };
        Grid { cell, low: self.low, size: [size(0), size(1)] }
    }

    /// The surface over the middles of all cells, by cell, then by patch; one of each.
    pub(super) fn samples(&self, grid: &Grid) -> Vec<Sample> {
        let mut samples: Vec<Sample> =
            self.facets.par_iter().flat_map_iter(|facet| facet.samples(grid)).collect();
        // Of one patch the highest comes first, and stays.
        samples.par_sort_unstable_by(|a, b| {
            let key = |one: &Sample| (one.cell, one.patch, -i64::from(one.z));
            key(a)
                .cmp(&key(b))
                .then(a.gradient.map(f32::to_bits).cmp(&b.gradient.map(f32::to_bits)))
        });
        samples.dedup_by_key(|one| (one.cell, one.patch));
        samples
    }
}

impl Facet {
    fn samples(&self, grid: &Grid) -> Vec<Sample> {
        let at = self.corners.map(|corner| corner.map(f64::from));
        let end = |of: fn(f64, f64) -> f64| of(of(at[0][1], at[1][1]), at[2][1]);
        let (first, last) = grid.range(1, end(f64::min), end(f64::max));
        let mut samples = Vec::new();
        for row in first..last {
            let y = grid.middle(1, row);
            let (mut from, mut to) = (f64::INFINITY, f64::NEG_INFINITY);
            for k in 0..3 {
                let (a, b) = (at[k], at[(k + 1) % 3]);
                if a[1].min(b[1]) > y || a[1].max(b[1]) < y || a[1] == b[1] {
                    continue;
                }
                let x = a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]);
                (from, to) = (from.min(x), to.max(x));
            }
            if from > to {
                continue;
            }
            let (first, last) = grid.range(0, from, to);
            samples.extend((first..last).map(|place| {
                let (dx, dy) = (grid.middle(0, place) - at[0][0], y - at[0][1]);
                let z = at[0][2] + dx * self.gradient[0] + dy * self.gradient[1];
                let cell = (row * grid.size[0] + place) as u32;
                let gradient = self.gradient.map(|rise| rise as f32);
                Sample { cell, patch: self.patch, z: z.round() as Coord, gradient }
            }));
        }
        samples
    }
}

/// The unit normal of a triangle that faces up by 45° or less.
fn normal(corners: [[i32; 3]; 3]) -> Option<Vector3<f64>> {
    let at = corners.map(|corner| Vector3::from(corner.map(f64::from)) / UNITS_PER_MM);
    let normal = (at[1] - at[0]).cross(&(at[2] - at[0]));
    let length = normal.norm();
    let steepest = libm::cos(STEEPEST.to_radians());
    (length > 0.0 && normal.z >= (steepest - SLACK) * length).then(|| normal / length)
}

/// The patch of each triangle that has a normal, the largest patch first.
fn patches(
    mesh: &Mesh,
    adjacency: &Adjacency,
    normals: &[Option<Vector3<f64>>],
) -> Vec<Option<u32>> {
    let least = libm::cos(BEND.to_radians());
    let mut patch_of: Vec<Option<u32>> = vec![None; normals.len()];
    // Area in plan and first number of each.
    let mut sizes: Vec<(f64, u32)> = Vec::new();
    for first in 0..normals.len() {
        if normals[first].is_none() || patch_of[first].is_some() {
            continue;
        }
        let patch = sizes.len() as u32;
        let (mut size, mut open) = (0.0, vec![first]);
        patch_of[first] = Some(patch);
        while let Some(triangle) = open.pop() {
            let Some(own) = normals[triangle] else { continue };
            size += area(mesh, triangle);
            let beside = adjacency.neighbour[triangle].into_iter().filter(|half| *half != NONE);
            for (next, _) in beside.map(parts) {
                let joins = normals[next].is_some_and(|other| other.dot(&own) > least);
                if joins && patch_of[next].is_none() {
                    patch_of[next] = Some(patch);
                    open.push(next);
                }
            }
        }
        sizes.push((size, patch));
    }
    sizes.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    let mut place = vec![0_u32; sizes.len()];
    for (new, (_, old)) in sizes.iter().enumerate() {
        place[*old as usize] = new as u32;
    }
    patch_of.iter().map(|patch| patch.map(|old| place[old as usize])).collect()
}

/// Area of a triangle in plan, mm².
fn area(mesh: &Mesh, triangle: usize) -> f64 {
    let [a, b, c] = mesh.triangles[triangle].map(|corner| {
        let [x, y, _] = mesh.vertices[corner as usize].map(f64::from);
        [x / UNITS_PER_MM, y / UNITS_PER_MM]
    });
    0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])).abs()
}
