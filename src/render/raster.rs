//! Triangles -> pixels: which face is nearest at each sample, in bands of rows side by side.

use super::view::{Corner, GRAIN, View};
use super::{Pixel, light};
use crate::mesh::Mesh;
use rayon::prelude::*;

/// Samples that are drawn at a time, at most: few are little to hold, many go through the
/// triangles less often.
const BAND: u32 = 1 << 18;

/// All pixels, row by row from the top.
pub(super) fn pixels(mesh: &Mesh, view: &View, size: [u32; 2], samples: u32) -> Vec<Pixel> {
    let corners: Vec<Corner> =
        mesh.vertices.par_iter().map(|&vertex| view.corner(vertex)).collect();
    let most = (BAND / (size[0] * samples * samples).max(1)).max(1);
    let bands = size[1].div_ceil(most);
    let bands = (0..bands).into_par_iter().map(|band| {
        let [top, end] = [band, band + 1].map(|band| size[1] * band / bands);
        let mut samples = Samples::new(size[0], top, end - top, samples);
        for triangle in &mesh.triangles {
            samples.triangle(mesh, &corners, *triangle);
        }
        samples.pixels()
    });
    bands.flatten_iter().collect()
}

/// The samples of a band.
struct Samples {
    /// Along each side of a pixel.
    per_pixel: usize,
    width: usize,
    /// First row and the one after the last, from the top of the picture.
    rows: [i32; 2],
    /// Nearness in the upper 24 bits and tone below: the larger one is what is seen, so
    /// that the order of the triangles has no say. 0 where nothing is.
    seen: Vec<u32>,
}

impl Samples {
    #[expect(
        clippy::slow_vector_initialization,
        reason = "memory that comes zeroed is mapped twice: when it is read, and when it is written"
    )]
    fn new(width: u32, top: u32, rows: u32, samples: u32) -> Self {
        let (width, per_pixel) = ((width * samples) as usize, samples as usize);
        let first = (top * samples) as i32;
        let count = (rows * samples) as usize;
        let mut seen = Vec::with_capacity(width * count);
        seen.resize(width * count, 0);
        Self { per_pixel, width, rows: [first, first + count as i32], seen }
    }

    fn triangle(&mut self, mesh: &Mesh, corners: &[Corner], triangle: [u32; 3]) {
        let at = |k: usize, axis: usize| corners[triangle[k] as usize].at[axis];
        let least = |axis: usize| at(0, axis).min(at(1, axis)).min(at(2, axis));
        let most = |axis: usize| at(0, axis).max(at(1, axis)).max(at(2, axis));
        let first = first_sample(least(1)).max(self.rows[0]);
        let last = last_sample(most(1)).min(self.rows[1] - 1);
        let (left, right) = (least(0), most(0));
        // Most triangles of fine meshes lie between the samples.
        if first > last || first_sample(left) > last_sample(right) {
            return;
        }
        let Some(face) = Face::new(mesh, corners, triangle) else { return };
        for row in first..=last {
            let [from, to] = face.within(centre(row), [left, right]);
            let from = first_sample(from).max(0);
            let to = last_sample(to).min(self.width as i32 - 1);
            if from > to {
                continue;
            }
            let start = (row - self.rows[0]) as usize * self.width;
            let samples = &mut self.seen[start + from as usize..=start + to as usize];
            for (seen, value) in samples.iter_mut().zip(face.seen(from, row)) {
                *seen = (*seen).max(value);
            }
        }
    }

    /// The samples of each pixel together.
    fn pixels(&self) -> Vec<Pixel> {
        let side = self.per_pixel;
        if self.width == 0 {
            return Vec::new();
        }
        let row = |rows: &[u32]| -> Vec<Pixel> {
            let mut pixels = vec![Pixel::default(); self.width / side];
            let mut near = vec![0_u64; pixels.len()];
            for samples in rows.chunks(self.width) {
                for ((pixel, near), samples) in
                    pixels.iter_mut().zip(&mut near).zip(samples.chunks(side))
                {
                    for &seen in samples.iter().filter(|&&seen| seen > 0) {
                        pixel.covered += 1;
                        pixel.tone += seen & 0xff;
                        *near += u64::from(seen >> 8);
                    }
                }
            }
            for (pixel, near) in pixels.iter_mut().zip(near) {
                let count = pixel.covered.max(1);
                pixel.tone = (pixel.tone + count / 2) / count;
                pixel.near = (near / u64::from(count)) as u32;
            }
            pixels
        };
        self.seen.chunks(self.width * side).flat_map(row).collect()
    }
}

/// A triangle that is to be drawn.
struct Face {
    /// Its corners, so that its inside is to the left of each side.
    at: [[i32; 2]; 3],
    tone: u32,
    /// Nearness at the first corner, and how it grows to the right and downwards.
    near: f64,
    slope: [f64; 2],
    /// Nearness of the farthest and the nearest corner.
    range: [f64; 2],
}

impl Face {
    /// `None` for a triangle that is seen from its edge or has no area.
    fn new(mesh: &Mesh, corners: &[Corner], [a, b, c]: [u32; 3]) -> Option<Self> {
        let vertex = |corner: u32| mesh.vertices[corner as usize];
        let tone = light::tone(vertex(a), vertex(b), vertex(c))?;
        // One beginning, whichever corner the file names first.
        let [a, mut b, mut c] = match (vertex(a), vertex(b), vertex(c)) {
            (one, two, three) if one <= two && one <= three => [a, b, c],
            (_, two, three) if two <= three => [b, c, a],
            _ => [c, a, b],
        };
        if doubled(corners, a, b, c) < 0 {
            std::mem::swap(&mut b, &mut c);
        }
        let twice = doubled(corners, a, b, c);
        if twice == 0 {
            return None;
        }
        let [a, b, c] = [corners[a as usize], corners[b as usize], corners[c as usize]];
        let near = f64::from(a.near);
        let (of_b, of_c) = (f64::from(b.near) - near, f64::from(c.near) - near);
        let side = |p: Corner, axis: usize| f64::from(p.at[axis] - a.at[axis]);
        let twice = twice as f64;
        Some(Self {
            at: [a.at, b.at, c.at],
            tone: u32::from(tone),
            near,
            slope: [
                (of_b * side(c, 1) - of_c * side(b, 1)) / twice,
                (of_c * side(b, 0) - of_b * side(c, 0)) / twice,
            ],
            range: [near + of_b.min(of_c).min(0.0), near + of_b.max(of_c).max(0.0)],
        })
    }

    /// From where to where it lies on the row at `y`, both included, at most all of `range`.
    fn within(&self, y: i32, range: [i32; 2]) -> [i32; 2] {
        let (low, high) = (i64::from(range[0]), i64::from(range[1]));
        let (mut from, mut to) = (low, high);
        for k in 0..3 {
            let at = |corner: usize, axis: usize| i64::from(self.at[corner % 3][axis]);
            // To the left of the side, or on it: rise * x <= limit.
            let rise = at(k + 1, 1) - at(k, 1);
            let run = at(k + 1, 0) - at(k, 0);
            let limit = run * (i64::from(y) - at(k, 1)) + rise * at(k, 0);
            match rise {
                0 => {}
                1.. => to = to.min(limit.div_euclid(rise)),
                _ => from = from.max(-limit.div_euclid(-rise)),
            }
        }
        // An empty row may lie anywhere; beyond its range nothing is lost.
        [from.min(high + 1) as i32, to.max(low - 1) as i32]
    }

    /// What the samples of a row hold, from one `column` on, where this face is nearest.
    fn seen(&self, column: i32, row: i32) -> impl Iterator<Item = u32> {
        let away = |sample: i32, axis: usize| f64::from(centre(sample) - self.at[0][axis]);
        let first = self.near + away(row, 1) * self.slope[1];
        (column..).map(move |column| {
            let near = first + away(column, 0) * self.slope[0];
            (near.max(self.range[0]).min(self.range[1]) as u32) << 8 | self.tone
        })
    }
}

/// Twice the area of a triangle as seen; more than 0 if its inside is to the left of its
/// sides, as y grows downwards.
fn doubled(corners: &[Corner], a: u32, b: u32, c: u32) -> i64 {
    let at = |corner: u32, axis: usize| i64::from(corners[corner as usize].at[axis]);
    let side = |corner: u32, axis: usize| at(corner, axis) - at(a, axis);
    side(b, 0) * side(c, 1) - side(b, 1) * side(c, 0)
}

/// The middle of a sample.
fn centre(sample: i32) -> i32 {
    sample * GRAIN + GRAIN / 2
}

/// The first sample whose middle is at `at` or behind it.
fn first_sample(at: i32) -> i32 {
    (at + GRAIN / 2 - 1).div_euclid(GRAIN)
}

/// The last sample whose middle is at `at` or before it.
fn last_sample(at: i32) -> i32 {
    (at - GRAIN / 2).div_euclid(GRAIN)
}
