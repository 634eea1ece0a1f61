//! RawMesh -> Part: scales and turns one model, mends it, sets it down and rounds it to the integer grid.

use super::fit::check_size;
use crate::mesh::edges::Adjacency;
use crate::mesh::error::{Error, Flat, Result};
use crate::mesh::faults::Fault;
use crate::mesh::geometry::measure::{has_area, volume_mm3};
use crate::mesh::mend::{self, Mended};
use crate::mesh::notes::Notes;
use crate::mesh::{Bed, Mesh, Placement, Policy, RawMesh, inspect};
use crate::units::{sin_cos, sum_mm, to_units};
use nalgebra::{Matrix3, Vector3};
use rayon::prelude::*;

/// One model on the grid. The middle of its bounding box is at x = y = 0, its bottom at z = 0.
#[derive(Debug, Clone)]
pub struct Part {
    /// The triangles over the vertices of the [`RawMesh`], in the same order.
    pub mesh: Mesh,
    /// Which half-edges of `mesh` are neighbours.
    pub adjacency: Adjacency,
    /// Width, depth and height, grid units. Width and depth are even.
    pub(super) size: [i64; 3],
}

/// Rounds one model to the grid, mends it and completes its report. `model` keeps the vertices
/// that the mended triangles use, and its triangles move into the part.
///
/// # Errors
/// [`Error::TooLarge`], [`Error::Flat`], [`Error::Unmendable`], and with [`Policy::Strict`]
/// [`Error::Faulty`].
pub fn part(model: &mut RawMesh, placement: &Placement, bed: &Bed) -> Result<Part> {
    let mut points = points(model, placement);
    let [low, high] = bounds(&points);
    check_size((high - low).into(), &model.report.file, placement, bed)?;
    let (vertices, mut size) = on_grid(&points, placement.sink);
    let mut mesh = Mesh { vertices, triangles: std::mem::take(&mut model.triangles) };
    refuse_flat(&mesh, size, &model.report.file, placement.sink)?;
    let mut mended = match placement.policy {
        Policy::Warn => mend::inspect(&mesh),
        Policy::Repair => mend::mend(&mut mesh),
        Policy::Strict => {
            let mut mended = mend::mend(&mut mesh);
            // Of the mended mesh: gaps and copies would count as crossings.
            mended.found.extend(inspect::inspect(&mesh, &mended.adjacency));
            mended
        }
    };
    report(model, &mut mended);
    if mended.is_lost {
        return Err(Error::Unmendable { file: model.report.file.clone() });
    }
    if placement.policy == Policy::Strict {
        refuse_faults(model)?;
    }
    if !model.report.mended.is_empty() {
        // The outermost triangles may have been dropped: then the middle and size are others.
        keep_used(model, &mut points, &mut mesh);
        (mesh.vertices, size) = on_grid(&points, placement.sink);
        refuse_flat(&mesh, size, &model.report.file, placement.sink)?;
    }
    model.report.triangles = mesh.triangles.len();
    model.report.size_mm = size.map(sum_mm);
    model.report.volume_mm3 = volume_mm3(&mesh);
    Ok(Part { mesh, adjacency: mended.adjacency, size })
}

/// The vertices, scaled, turned and stretched, mm.
fn points(model: &RawMesh, placement: &Placement) -> Vec<Vector3<f64>> {
    let (turn, factor) = (rotation(placement.rotate), placement.unit.mm() * placement.scale);
    // Stretched after the turn: by how much plastic shrinks depends on how it is laid.
    let turn = Matrix3::from_diagonal(&Vector3::from(placement.stretch)) * turn;
    let point = |corner: &[f32; 3]| turn * (Vector3::from(corner.map(f64::from)) * factor);
    model.vertices.par_iter().map(point).collect()
}

/// The turns about x, then y, then z by `degrees`, as one matrix.
fn rotation(degrees: [f64; 3]) -> Matrix3<f64> {
    let [(sx, cx), (sy, cy), (sz, cz)] = degrees.map(sin_cos);
    let x = Matrix3::new(1.0, 0.0, 0.0, 0.0, cx, -sx, 0.0, sx, cx);
    let y = Matrix3::new(cy, 0.0, sy, 0.0, 1.0, 0.0, -sy, 0.0, cy);
    let z = Matrix3::new(cz, -sz, 0.0, sz, cz, 0.0, 0.0, 0.0, 1.0);
    z * y * x
}

/// The lowest and the highest coordinates.
fn bounds(points: &[Vector3<f64>]) -> [Vector3<f64>; 2] {
    let first = points.first().copied().unwrap_or_default();
    let both =
        |[low, high]: [Vector3<f64>; 2], [l, h]: [Vector3<f64>; 2]| [low.inf(&l), high.sup(&h)];
    points.par_iter().map(|point| [*point; 2]).reduce(|| [first; 2], both)
}

/// The points as they stand on the bed, `sink` mm in it, and the size of what is above, grid units.
fn on_grid(points: &[Vector3<f64>], sink: f64) -> (Vec<[i32; 3]>, [i64; 3]) {
    let [low, high] = bounds(points);
    // In this order, so that a mirrored model gives exactly the mirrored middle.
    let zero = Vector3::new((low.x + high.x) / 2.0, (low.y + high.y) / 2.0, low.z + sink);
    let rounded = |point: &Vector3<f64>| <[f64; 3]>::from(point - zero).map(to_units);
    // The middle of the box is at 0, so that opposite sides round alike.
    let half = rounded(&high).map(i64::from);
    (points.par_iter().map(rounded).collect(), [2 * half[0], 2 * half[1], half[2]])
}

/// Refuses a model that encloses nothing.
fn refuse_flat(mesh: &Mesh, size: [i64; 3], file: &str, sink_mm: f64) -> Result<()> {
    let height_mm = sum_mm(size[2]) + sink_mm;
    if sink_mm > 0.0 && height_mm > 0.0 && size[2] <= 0 {
        return Err(Error::Sunk { file: file.to_owned(), sink_mm, height_mm });
    }
    let what = if mesh.triangles.len() < 4 {
        Flat::FewTriangles
    } else if size[2] <= 0 {
        Flat::NoHeight
    } else if size[0] == 0 || size[1] == 0 || !has_area(mesh) {
        Flat::NoArea
    } else {
        return Ok(());
    };
    Err(Error::Flat { file: file.to_owned(), what, size_mm: size.map(sum_mm) })
}

/// Writes what reading and mending found and did into the model's report.
fn report(model: &mut RawMesh, mended: &mut Mended) {
    let mut found = Notes::default();
    found.many(Fault::WrongNormal, model.wrong_normals);
    found.many(Fault::Degenerate, model.degenerate);
    found.extend(std::mem::take(&mut mended.found));
    let report = &mut model.report;
    report.shells = mended.shells;
    report.found = found.counted(&model.vertices);
    report.mended = std::mem::take(&mut mended.done).counted(&model.vertices);
    report.left = std::mem::take(&mut mended.left).counted(&model.vertices);
}

/// Refuses a model with any fault.
fn refuse_faults(model: &RawMesh) -> Result<()> {
    let found = &model.report.found;
    if found.is_empty() {
        return Ok(());
    }
    Err(Error::Faulty { file: model.report.file.clone(), found: found.clone() })
}

/// Drops the vertices that no triangle uses.
fn keep_used(model: &mut RawMesh, points: &mut Vec<Vector3<f64>>, mesh: &mut Mesh) {
    let mut place = vec![u32::MAX; points.len()];
    for &vertex in mesh.triangles.as_flattened() {
        place[vertex as usize] = 0;
    }
    for (new, place) in (0..).zip(place.iter_mut().filter(|place| **place == 0)) {
        *place = new;
    }
    let used = || place.iter().map(|&place| place != u32::MAX);
    let (mut of_points, mut of_vertices) = (used(), used());
    points.retain(|_| of_points.next().unwrap_or(false));
    model.vertices.retain(|_| of_vertices.next().unwrap_or(false));
    for triangle in &mut mesh.triangles {
        *triangle = triangle.map(|vertex| place[vertex as usize]);
    }
    model.report.vertices = points.len();
}
