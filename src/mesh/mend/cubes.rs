//! Points -> cubes: a spatial hash, to find the points near a place.

use crate::mesh::geometry::vector::Corner;
use hashbrown::HashMap;

/// Points by the cube that they lie in. Cubes are looked up but never iterated over, so that the
/// order of a hash table shows nowhere.
pub(super) struct Cubes {
    size: i64,
    /// Where each cube's points begin in `points`, and how many there are.
    cubes: HashMap<[i32; 3], (u32, u32)>,
    points: Vec<u32>,
}

impl Cubes {
    /// Sorts `points`, indices into `vertices`, into cubes of `size` grid units.
    pub(super) fn new(vertices: &[Corner], points: &[u32], size: i64) -> Self {
        let size = size.max(1);
        let mut keyed: Vec<([i32; 3], u32)> =
            points.iter().map(|&p| (cube_of(vertices[p as usize], size), p)).collect();
        keyed.sort_unstable();
        let mut cubes = HashMap::default();
        let mut start = 0;
        for group in keyed.chunk_by(|a, b| a.0 == b.0) {
            let count = u32::try_from(group.len()).unwrap_or(u32::MAX);
            cubes.insert(group[0].0, (start, count));
            start += count;
        }
        Self { size, cubes, points: keyed.into_iter().map(|(_, point)| point).collect() }
    }

    /// Calls `visit` with the points in the cubes that touch the box from `low` to `high`.
    pub(super) fn near(&self, low: Corner, high: Corner, mut visit: impl FnMut(u32)) {
        let (low, high) = (cube_of(low, self.size), cube_of(high, self.size));
        for x in low[0]..=high[0] {
            for y in low[1]..=high[1] {
                for z in low[2]..=high[2] {
                    let (start, count) = self.cubes.get(&[x, y, z]).copied().unwrap_or((0, 0));
                    let (start, count) = (start as usize, count as usize);
                    self.points[start..start + count].iter().for_each(|&point| visit(point));
                }
            }
        }
    }
}

#[expect(clippy::cast_possible_truncation, reason = "a quotient of an i32")]
fn cube_of(corner: Corner, size: i64) -> [i32; 3] {
    corner.map(|side| i64::from(side).div_euclid(size) as i32)
}
