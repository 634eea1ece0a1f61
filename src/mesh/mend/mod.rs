//! Mesh -> mended Mesh: welds, drops, splits, turns and fills until the surface is closed, and counts what it did.
//!
//! An open edge has one triangle. A rim is a closed line of open edges around a hole. A patch is
//! what is connected by edges of two triangles, a shell what is connected when mending is
//! done. A sheet is a surface that encloses nothing.
//!
//! The steps, in this order, since each relies on those before it:
//! 1. `duplicates`: drop copies of triangles.
//! 2. `near`, `junctions`: weld corners that nearly meet, and split triangles at corners on their edges;
//!    first within 0.02 mm, then, if edges are still open, within 0.1 mm.
//! 3. `orient`: wind the triangles of each patch alike.
//! 4. `rim`, `bridge`, `fill`, `holes`: bridge gaps between two rims, and fill the other holes.
//! 5. `shells`: drop shells that enclose nothing, and turn the others outward.
//!
//! A mesh that is closed goes through the last step only. No step makes new corners, and only
//! welding moves them, so that mended triangles have corners of the file. The result does not
//! depend on the order of the triangles.
//!
//! Shells that overlap stay as they are: the winding rule of slicing makes one solid of them.

mod beside;
mod bridge;
mod columns;
mod cubes;
mod duplicates;
mod fill;
mod holes;
mod junctions;
mod links;
mod near;
mod orient;
mod probes;
mod rim;
pub(super) mod shells;

pub use holes::SMALL_MM;
pub use near::TOLERANCES_MM;

use super::Mesh;
use super::edges::{self, Adjacency};
use super::faults::{Fault, Mending};
use super::geometry::measure::{corners_of, determinant};
use super::geometry::vector::{Corner, distance2, length, normal};
use super::notes::Notes;
use near::TOLERANCES;

/// Triangles no higher than this are lines, grid units: rounding their corners to the grid moves
/// each by up to 0.9. A larger value drops real thin triangles and opens gaps.
const LEAST_HEIGHT: f64 = 2.0;

/// The fewest faces of a body. If fewer sheets were dropped, they are not a body whose faces came
/// apart.
const LEAST_FACES: usize = 4;

/// What mending found and did.
#[derive(Debug, Clone, Default)]
pub(super) struct Mended {
    /// Which half-edges of the mended mesh are neighbours.
    pub(super) adjacency: Adjacency,
    /// Faults of the mesh as it was.
    pub(super) found: Notes<Fault>,
    /// What was done.
    pub(super) done: Notes<Mending>,
    /// Faults that are left.
    pub(super) left: Notes<Fault>,
    /// The number of connected surfaces.
    pub(super) shells: usize,
    /// Whether more of the surface was dropped than is left. Then these were not sheets, but faces
    /// of a body that do not meet.
    pub(super) is_lost: bool,
}

/// Mends `mesh`.
pub(super) fn mend(mesh: &mut Mesh) -> Mended {
    let mut adjacency = edges::adjacency(&mesh.vertices, &mesh.triangles);
    let (found, done) = (Notes::default(), Notes::default());
    let triangles = std::mem::take(&mut mesh.triangles);
    let mut work =
        Work { vertices: &mesh.vertices, triangles, found, done, dropped: 0.0, sheets: 0 };
    let is_closed = adjacency.unpaired == 0;
    let mut is_mended = false;
    if !is_closed || adjacency.non_manifold > 0 {
        work.found = faults(work.vertices, &work.triangles);
        // Counted after gaps are closed, since some show only then.
        work.found.0.retain(|note| note.kind != Fault::FlippedEdge);
        let count = work.count();
        duplicates::drop_duplicates(&mut work);
        if !is_closed || work.count() != count {
            close(&mut work);
            is_mended = true;
            adjacency = edges::adjacency(work.vertices, &work.triangles);
        }
    }
    let (shells, is_changed) = shells::settle(&mut work, &adjacency, is_mended);
    let is_lost = work.is_lost();
    let Work { triangles, found, done, .. } = work;
    if is_changed {
        adjacency = edges::adjacency(&mesh.vertices, &triangles);
    }
    let is_sound = adjacency.unpaired == 0 && adjacency.non_manifold == 0;
    let left = if is_sound { Notes::default() } else { faults(&mesh.vertices, &triangles) };
    mesh.triangles = triangles;
    Mended { adjacency, found, done, left, shells, is_lost }
}

/// The faults of a mesh that stays as it is.
pub(super) fn inspect(mesh: &Mesh) -> Mended {
    let adjacency = edges::adjacency(&mesh.vertices, &mesh.triangles);
    let found = faults(&mesh.vertices, &mesh.triangles);
    let shells = shells::count(&adjacency);
    let left = found.clone();
    Mended { adjacency, found, done: Notes::default(), left, shells, is_lost: false }
}

/// The steps that close a mesh.
fn close(work: &mut Work) {
    work.drop_degenerate();
    for tolerance in near::TOLERANCES {
        near::weld(work, tolerance);
        duplicates::drop_duplicates(work);
        junctions::split_junctions(work, tolerance);
        if near::open_edges(work).is_empty() {
            break;
        }
    }
    orient::orient(work);
    holes::fill_holes(work);
    // The filling of the rim of a sheet is a copy of the sheet.
    duplicates::drop_duplicates(work);
}

/// The faults that the edges of a mesh show.
pub(super) fn faults(vertices: &[Corner], triangles: &[[u32; 3]]) -> Notes<Fault> {
    let mut notes = Notes::default();
    edges::each_edge(vertices.len(), triangles, |(low, _), sides| match *sides {
        [_] => notes.add(Fault::OpenEdge, low),
        [a, b] => {
            if edges::starts_at(low, a, triangles) == edges::starts_at(low, b, triangles) {
                notes.add(Fault::FlippedEdge, low);
            }
        }
        _ => notes.add(Fault::CrowdedEdge, low),
    });
    notes
}

/// A mesh while it is mended.
struct Work<'a> {
    vertices: &'a [Corner],
    triangles: Vec<[u32; 3]>,
    found: Notes<Fault>,
    done: Notes<Mending>,
    /// Twice the area of the dropped sheets, grid units².
    dropped: f64,
    /// Dropped sheets that were shells of their own.
    sheets: usize,
}

impl Work<'_> {
    /// Counts a triangle of a sheet that the caller drops.
    fn drop_sheet(&mut self, triangle: [u32; 3]) {
        self.done.add(Mending::DroppedSheet, triangle[0]);
        self.dropped += self.area(triangle);
    }

    /// Whether more of the surface was dropped than is left, see [`Mended::is_lost`].
    fn is_lost(&self) -> bool {
        if self.dropped == 0.0 {
            return false;
        }
        let kept: f64 = self.triangles.iter().map(|&triangle| self.area(triangle)).sum();
        self.dropped > kept && (self.sheets >= LEAST_FACES || kept == 0.0)
    }

    /// Twice the area of a triangle, grid units².
    fn area(&self, triangle: [u32; 3]) -> f64 {
        length(normal(corners_of(self.vertices, triangle)))
    }

    /// The number of triangles.
    fn count(&self) -> u32 {
        u32::try_from(self.triangles.len()).unwrap_or(u32::MAX)
    }

    /// Drops the marked triangles.
    fn drop_marked(&mut self, drop: &[bool]) {
        let mut marks = drop.iter();
        self.triangles.retain(|_| !marks.next().copied().unwrap_or(false));
    }

    /// Drops triangles without area: two corners are equal, or three are on one line. Splitting
    /// joins the neighbours of the latter.
    fn drop_degenerate(&mut self) {
        let Self { vertices, triangles, found, done, .. } = self;
        triangles.retain(|&triangle| {
            let corners = corners_of(vertices, triangle);
            let sides = (0..3).map(|k| distance2(corners[k], corners[(k + 1) % 3]));
            let longest = (sides.max().unwrap_or(0) as f64).sqrt();
            let has_area = length(normal(corners)) > LEAST_HEIGHT * longest;
            if !has_area {
                found.add(Fault::Degenerate, triangle[0]);
                done.add(Mending::DroppedDegenerate, triangle[0]);
            }
            has_area
        });
    }

    /// Six times the signed volume between some triangles and the mean of their corners: that of
    /// what they enclose, if they enclose something.
    fn volume(&self, triangles: impl Iterator<Item = [u32; 3]> + Clone) -> i128 {
        let corners = triangles.map(|triangle| corners_of(self.vertices, triangle));
        let (mut sum, mut count) = ([0_i64; 3], 0);
        for corner in corners.clone().flatten() {
            (0..3).for_each(|axis| sum[axis] += i64::from(corner[axis]));
            count += 1;
        }
        let middle = sum.map(|side| i32::try_from(side / count.max(1)).unwrap_or(0));
        let about = |corner: Corner| std::array::from_fn(|axis| corner[axis] - middle[axis]);
        corners.map(|corners| determinant(corners.map(about))).sum()
    }

    /// Whether some triangles enclose next to nothing: less than a plate of their area that is as
    /// thick as the tolerance of welding.
    fn is_flat(&self, triangles: impl Iterator<Item = [u32; 3]> + Clone) -> bool {
        let volume = self.volume(triangles.clone()).unsigned_abs() as f64 / 6.0;
        let area = triangles.map(|t| self.area(t)).sum::<f64>();
        // `area` is twice that of both sides of a plate: a quarter of it is one side.
        volume <= area / 4.0 * f64::from(TOLERANCES[0])
    }
}
