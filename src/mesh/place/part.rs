//! RawMesh -> Part: scales and turns one model, mends it, sets it down and rounds it to the integer grid.

use super::fit::{check_size, sides};
use crate::error::{Error, Result};
use crate::mesh::edges::Adjacency;
use crate::mesh::faults::{self, Fault};
use crate::mesh::geometry::measure::{has_area, volume_mm3};
use crate::mesh::mend::{self, Mended, told};
use crate::mesh::notes::Notes;
use crate::mesh::{Bed, Mesh, Placement, Policy, RawMesh, Unit, inspect};
use crate::units::{sin_cos, sum_mm, to_units};
use nalgebra::{Matrix3, Vector3};
use rayon::prelude::*;

/// One model on the grid, its bounding box's middle at x = y = 0.
#[derive(Debug, Clone)]
pub struct Part {
    /// The triangles. Vertices are those of the [`RawMesh`] that it was made of, in the same order.
    pub mesh: Mesh,
    /// Which half-edge of `mesh` continues which.
    pub adjacency: Adjacency,
    /// Width, depth and height, grid units. The first two are even.
    pub(super) size: [i64; 3],
}

/// Brings one model onto the grid, mends it and completes its report. What is left of the
/// model are the vertices that the mended triangles use.
///
/// # Errors
/// [`Error::Unprintable`] for what is larger than the bed; [`Error::Input`] for a model that
/// is flat or encloses nothing, and with [`Policy::Strict`] for one with any fault.
pub fn part(model: &mut RawMesh, placement: &Placement, bed: &Bed) -> Result<Part> {
    let mut points = points(model, placement);
    let [low, high] = bounds(&points);
    check_size((high - low).into(), &model.report.file, placement, bed)?;
    let (vertices, mut size) = on_grid(&points);
    let mut mesh = Mesh { vertices, triangles: std::mem::take(&mut model.triangles) };
    refuse_flat(&mesh, size, &model.report.file)?;
    let mut mended = match placement.policy {
        Policy::Warn => mend::inspect(&mesh),
        Policy::Repair => mend::mend(&mut mesh),
        Policy::Strict => {
            let mut mended = mend::mend(&mut mesh);
            // Of the mended mesh, since gaps and copies would be taken for crossings.
            mended.found.extend(inspect::inspect(&mesh, &mended.adjacency));
            mended
        }
    };
    tell(model, &mut mended);
    if mended.is_lost {
        let why = "the mesh cannot be mended: more of its faces meet no others than enclose a \
                   body; mend the model, or slice it as it is with --mesh warn";
        return Err(Error::input(&model.report.file, why));
    }
    if placement.policy == Policy::Strict {
        refuse_faults(model)?;
    }
    if !model.report.mended.is_empty() {
        // What was dropped may have been the outermost.
        keep_used(model, &mut points, &mut mesh);
        (mesh.vertices, size) = on_grid(&points);
        refuse_flat(&mesh, size, &model.report.file)?;
    }
    model.report.triangles = mesh.triangles.len();
    model.report.size_mm = size.map(sum_mm);
    model.report.volume_mm3 = volume_mm3(&mesh);
    Ok(Part { mesh, adjacency: mended.adjacency, size })
}

/// The vertices, scaled and turned, mm.
fn points(model: &RawMesh, placement: &Placement) -> Vec<Vector3<f64>> {
    let unit = match placement.unit {
        Unit::Mm => 1.0,
        Unit::Cm => 10.0,
        Unit::M => 1000.0,
        Unit::Inch => 25.4,
    };
    let (turn, factor) = (rotation(placement.rotate), unit * placement.scale);
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

/// The points as they stand on the bed, and the size of the whole, grid units.
fn on_grid(points: &[Vector3<f64>]) -> (Vec<[i32; 3]>, [i64; 3]) {
    let [low, high] = bounds(points);
    // In this order, so that a mirrored model gives exactly the mirrored middle.
    let zero = Vector3::new((low.x + high.x) / 2.0, (low.y + high.y) / 2.0, low.z);
    let rounded = |point: &Vector3<f64>| <[f64; 3]>::from(point - zero).map(to_units);
    // The middle of the box is at 0, so that both sides round alike.
    let half = rounded(&high).map(i64::from);
    (points.par_iter().map(rounded).collect(), [2 * half[0], 2 * half[1], half[2]])
}

/// Refuses a model that encloses nothing.
fn refuse_flat(mesh: &Mesh, size: [i64; 3], file: &str) -> Result<()> {
    let flat = |what: &str| {
        let size = sides(&size.map(sum_mm));
        let advice = "check the model, --unit and --scale";
        Err(Error::input(file, format!("{what} ({size} mm), nothing to print; {advice}")))
    };
    if mesh.triangles.len() < 4 {
        return flat("fewer than four triangles enclose no body");
    }
    if size[2] == 0 {
        return flat("the model has no height");
    }
    if size[0] == 0 || size[1] == 0 || !has_area(mesh) {
        return flat("the model is flat and has no area in any layer");
    }
    Ok(())
}

/// Writes what reading and mending found and did into the model's report.
fn tell(model: &mut RawMesh, mended: &mut Mended) {
    let mut found = Notes::default();
    found.many(Fault::WrongNormal, model.wrong_normals);
    found.many(Fault::Degenerate, model.degenerate);
    found.extend(std::mem::take(&mut mended.found));
    let report = &mut model.report;
    report.shells = mended.shells;
    report.found = told(found, &model.vertices);
    report.mended = told(std::mem::take(&mut mended.done), &model.vertices);
    report.left = told(std::mem::take(&mut mended.left), &model.vertices);
}

/// Refuses a model with any fault.
fn refuse_faults(model: &RawMesh) -> Result<()> {
    let Some(first) = model.report.found.first() else { return Ok(()) };
    let all: Vec<String> = model.report.found.iter().map(ToString::to_string).collect();
    let place = first.places.first().map_or_else(String::new, |&place| {
        format!(" (the first {} at {})", first.kind.one(), faults::told(place))
    });
    Err(Error::input(
        &model.report.file,
        format!(
            "the mesh has faults: {}{place}; mend the model, as `slicer mesh` does, or slice without \
             --mesh strict",
            all.join(", ")
        ),
    ))
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
