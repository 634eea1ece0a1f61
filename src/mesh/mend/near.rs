//! Open corners -> welded corners: gives corners of open edges that nearly meet one vertex.

use super::Work;
use super::cubes::Cubes;
use super::links::Links;
use crate::mesh::edges::{each_edge, parts};
use crate::mesh::faults::Mending;
use crate::mesh::geometry::vector::{distance2, length, minus};
use crate::units::UNITS_PER_MM;

/// Corners of open edges that are no further apart than this are one, mm. The first value is far
/// below what a printer can lay, and above what rounding and single precision do to a corner on a
/// bed. The second, a quarter of a line's width, is tried only if edges are still open. Larger
/// values close real slots; smaller ones leave the seams of badly exported files open.
pub const TOLERANCES_MM: [f64; 2] = [0.02, 0.1];

/// [`TOLERANCES_MM`] in grid units.
#[expect(clippy::cast_possible_truncation, reason = "small constants")]
pub(super) const TOLERANCES: [i32; 2] =
    [(TOLERANCES_MM[0] * UNITS_PER_MM) as i32, (TOLERANCES_MM[1] * UNITS_PER_MM) as i32];

/// Edges up to this long, grid units (2 µm), do not keep their ends from being welded: they come
/// from rounding. A smaller value leaves slivers open that welding should collapse.
const ROUNDING: f64 = 20.0;

/// Looks at a corner near another one, for all corners together, and more for each of them. Where very
/// many corners lie within the tolerance of each other, the rest is not welded, and is reported as open.
const MOST_LOOKS: u64 = 1 << 26;
const MOST_LOOKS_OF_CORNER: u64 = 64;

/// Welds, and drops the triangles that have two equal corners afterwards.
///
/// A corner moves by no more than half of the shortest edge at it, so that no triangle larger
/// than rounding vanishes or turns over.
pub(super) fn weld(work: &mut Work, tolerance: i32) {
    let reach = reaches(work, tolerance);
    let open: Vec<u32> =
        (0_u32..).zip(&reach).filter(|(_, reach)| **reach >= 0.0).map(|(v, _)| v).collect();
    let cubes = Cubes::new(work.vertices, &open, i64::from(tolerance));
    let mut links = Links::new(work.vertices.len());
    let mut looks = MOST_LOOKS + MOST_LOOKS_OF_CORNER * open.len() as u64;
    for &a in &open {
        let at = work.vertices[a as usize];
        let low = at.map(|side| side - tolerance);
        let high = at.map(|side| side + tolerance);
        if looks == 0 {
            break;
        }
        cubes.near(low, high, |b| {
            looks = looks.saturating_sub(1);
            let least = reach[a as usize].min(reach[b as usize]);
            let apart2 = distance2(at, work.vertices[b as usize]) as f64;
            if b > a && apart2 <= least * least {
                links.join(a, b);
            }
        });
    }
    // The least corner of a group stands for all, so that the order of triangles does not matter.
    let mut stands: Vec<u32> = (0_u32..).zip(work.vertices).map(|(v, _)| v).collect();
    for &v in &open {
        let least = &mut stands[links.root(v) as usize];
        if work.vertices[v as usize] < work.vertices[*least as usize] {
            *least = v;
        }
    }
    let mut to: Vec<u32> = (0_u32..).zip(work.vertices).map(|(v, _)| v).collect();
    for &v in &open {
        let stand = stands[links.root(v) as usize];
        let moved = length(minus(work.vertices[v as usize], work.vertices[stand as usize]));
        // In a chain of near corners the last may be far from the first.
        if stand != v && moved <= f64::from(tolerance) {
            to[v as usize] = stand;
            work.done.sized(Mending::Welded, v, moved);
        }
    }
    for triangle in &mut work.triangles {
        *triangle = triangle.map(|v| to[v as usize]);
    }
    work.drop_degenerate();
}

/// How far each vertex may move, grid units; negative if it has no open edge.
fn reaches(work: &Work, tolerance: i32) -> Vec<f64> {
    let most = f64::from(tolerance);
    let mut reach = vec![-1.0; work.vertices.len()];
    each_edge(work.vertices.len(), &work.triangles, |(a, b), sides| {
        if sides.len() % 2 == 1 {
            (reach[a as usize], reach[b as usize]) = (most, most);
        }
    });
    for triangle in &work.triangles {
        for side in 0..3 {
            let (a, b) = (triangle[side] as usize, triangle[(side + 1) % 3] as usize);
            let long = length(minus(work.vertices[a], work.vertices[b]));
            if long > ROUNDING {
                reach[a] = reach[a].min(long / 2.0);
                reach[b] = reach[b].min(long / 2.0);
            }
        }
    }
    reach
}

/// The open edges: the triangle of each, and which of its sides it is.
pub(super) fn open_edges(work: &Work) -> Vec<(usize, usize)> {
    let mut open = Vec::new();
    each_edge(work.vertices.len(), &work.triangles, |_, sides| {
        if let &[only] = sides {
            open.push(parts(only));
        }
    });
    open
}
