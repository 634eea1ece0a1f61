//! Triangles -> pixels: which face is nearest at each sample, in bands of rows side by side.

use super::view::{Corner, GRAIN, View};
use super::{Faces, Pixel, light};
use crate::mesh::Mesh;
use crate::units::Bounded as _;
use rayon::prelude::*;
use std::cell::LazyCell;
use std::ops::RangeInclusive;

/// Samples that are drawn at a time, at most: few enough to stay in a processor's cache.
const BAND: u32 = 1 << 15;

/// Triangles that are looked through at a time for those that hold a sample.
const AT_ONCE: usize = 1 << 14;

/// All pixels, row by row from the top.
pub(super) fn pixels(
    mesh: &Mesh,
    faces: Faces,
    view: &View,
    size: [u32; 2],
    samples: u32,
) -> Vec<Pixel> {
    let corners: Vec<Corner> =
        mesh.vertices.par_iter().map(|&vertex| view.corner(vertex)).collect();
    let grid = Grid::new(size, samples);
    let bins = bins(mesh, faces, &corners, &grid);
    let mut pixels = vec![Pixel::default(); grid.width * size[1] as usize];
    let bands = pixels.par_chunks_mut((grid.width * grid.band).max(1)).enumerate();
    bands.for_each_init(Vec::new, |seen, (band, pixels)| {
        let mut samples = Samples::new(&grid, band, pixels.len(), seen);
        for triangle in bins.iter().flat_map(|bins| &bins[band]) {
            samples.triangle(mesh, &corners, mesh.triangles[*triangle as usize]);
        }
        samples.resolve(pixels);
    });
    pixels
}

/// The triangles to draw that hold a sample, by the bands that they reach into; several lists for each
/// band, one after the other.
fn bins(mesh: &Mesh, faces: Faces, corners: &[Corner], grid: &Grid) -> Vec<Vec<Vec<u32>>> {
    let looks_away = |at| faces == Faces::Outer && doubled(at) >= 0;
    let chunks = mesh.triangles.par_chunks(AT_ONCE).enumerate();
    let bins = chunks.map(|(chunk, triangles)| {
        let mut bins = vec![Vec::new(); grid.bands];
        for (number, triangle) in (chunk * AT_ONCE..).zip(triangles) {
            let at = triangle.map(|corner| corners[corner as usize].at);
            let [columns, rows] = held(at);
            // Most triangles of fine meshes lie between the samples.
            if !columns.is_empty() && !rows.is_empty() && !looks_away(at) {
                let bands = grid.band_of(*rows.start())..=grid.band_of(*rows.end());
                bins[bands].iter_mut().for_each(|bin| bin.push(number as u32));
            }
        }
        bins
    });
    bins.collect()
}

/// The columns and rows of samples whose middles a triangle's box has.
fn held(corners: [[i32; 2]; 3]) -> [RangeInclusive<i32>; 2] {
    [0, 1].map(|axis| {
        let [least, most] = extent(corners, axis);
        first_sample(least)..=last_sample(most)
    })
}

/// From where to where a triangle's box reaches.
fn extent(corners: [[i32; 2]; 3], axis: usize) -> [i32; 2] {
    let [a, b, c] = corners.map(|corner| corner[axis]);
    [a.min(b).min(c), a.max(b).max(c)]
}

/// How a picture is divided.
struct Grid {
    /// Samples along each side of a pixel.
    samples: usize,
    /// Pixels in a row.
    width: usize,
    /// Rows of pixels in each band but the last.
    band: usize,
    /// The number of bands, at least one.
    bands: usize,
}

impl Grid {
    fn new(size: [u32; 2], samples: u32) -> Self {
        let band = (BAND / (size[0] * samples * samples).max(1)).max(1);
        let bands = size[1].div_ceil(band).max(1) as usize;
        Self { samples: samples as usize, width: size[0] as usize, band: band as usize, bands }
    }

    /// The band of a row of samples, or the nearest one.
    fn band_of(&self, row: i32) -> usize {
        let row = usize::try_from(row).unwrap_or(0);
        (row / (self.band * self.samples)).min(self.bands - 1)
    }
}

/// The samples of a band.
struct Samples<'a> {
    /// Along each side of a pixel.
    per_pixel: usize,
    width: usize,
    /// First row and the one after the last, from the top of the picture.
    rows: [i32; 2],
    /// Nearness in the upper 24 bits and tone below: the larger one is what is seen, so
    /// that the order of the triangles has no say. 0 where nothing is.
    seen: &'a mut Vec<u32>,
}

impl<'a> Samples<'a> {
    /// Those of a band with so many `pixels`, in memory that was `seen` before.
    fn new(grid: &Grid, band: usize, pixels: usize, seen: &'a mut Vec<u32>) -> Self {
        let per_pixel = grid.samples;
        let width = grid.width * per_pixel;
        let first = (band * grid.band * per_pixel) as i32;
        let count = pixels * per_pixel * per_pixel;
        seen.clear();
        seen.resize(count, 0);
        Self { per_pixel, width, rows: [first, first + (count / width.max(1)) as i32], seen }
    }

    fn triangle(&mut self, mesh: &Mesh, corners: &[Corner], triangle: [u32; 3]) {
        let at = triangle.map(|corner| corners[corner as usize].at);
        let [_, rows] = held(at);
        let first = (*rows.start()).max(self.rows[0]);
        let last = (*rows.end()).min(self.rows[1] - 1);
        let range = extent(at, 0);
        let Some(outline) = Outline::new(at) else { return };
        // Many a small triangle has a sample in its box but none in itself.
        let face = LazyCell::new(|| Face::new(mesh, corners, triangle));
        for row in first..=last {
            let [from, to] = outline.within(centre(row), range);
            let from = first_sample(from).max(0);
            let to = last_sample(to).min(self.width as i32 - 1);
            if from > to {
                continue;
            }
            let Some(face) = &*face else { return };
            let start = (row - self.rows[0]) as usize * self.width;
            let samples = &mut self.seen[start + from as usize..=start + to as usize];
            for (seen, value) in samples.iter_mut().zip(face.seen(from, row)) {
                *seen = (*seen).max(value);
            }
        }
    }

    /// Puts the samples of each pixel together.
    fn resolve(&self, pixels: &mut [Pixel]) {
        let side = self.per_pixel;
        let rows = self.seen.chunks(self.width * side);
        for (samples, pixels) in rows.zip(pixels.chunks_mut(self.width / side)) {
            for (k, pixel) in pixels.iter_mut().enumerate() {
                let rows = samples.chunks_exact(self.width);
                *pixel = resolved(rows.flat_map(|row| &row[k * side..][..side]));
            }
        }
    }
}

/// What a pixel has of its samples.
fn resolved<'a>(samples: impl Iterator<Item = &'a u32>) -> Pixel {
    // 64 samples of a nearness below 2²⁴ at most.
    let (mut covered, mut tone, mut near) = (0, 0, 0);
    for &seen in samples {
        covered += u32::from(seen > 0);
        tone += seen & 0xff;
        near += seen >> 8;
    }
    if covered == 0 {
        return Pixel::default();
    }
    Pixel {
        covered: covered as u8,
        tone: ((tone + covered / 2) / covered) as u8,
        near: near / covered,
    }
}

/// A triangle as seen: its corners, so that its inside is to the left of each side.
struct Outline([[i32; 2]; 3]);

impl Outline {
    /// `None` for a triangle that is seen from its edge.
    fn new([a, b, c]: [[i32; 2]; 3]) -> Option<Self> {
        match doubled([a, b, c]) {
            0 => None,
            1.. => Some(Self([a, b, c])),
            _ => Some(Self([a, c, b])),
        }
    }

    /// From where to where it lies on the row at `y`, both included, at most all of `range`.
    fn within(&self, y: i32, range: [i32; 2]) -> [i32; 2] {
        let (low, high) = (i64::from(range[0]), i64::from(range[1]));
        let (mut from, mut to) = (low, high);
        for k in 0..3 {
            let at = |corner: usize, axis: usize| i64::from(self.0[corner % 3][axis]);
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
}

/// The surface of a triangle that is to be drawn.
struct Face {
    /// One of its corners.
    at: [i32; 2],
    tone: u32,
    /// Nearness at this corner, and how it grows to the right and downwards.
    near: f64,
    slope: [f64; 2],
    /// Nearness of the farthest and the nearest corner.
    range: [f64; 2],
}

impl Face {
    /// `None` for a triangle without area. Which corner is the file's first, and which way
    /// round they go, has no say: until they are divided all products and sums are exact.
    fn new(mesh: &Mesh, corners: &[Corner], triangle: [u32; 3]) -> Option<Self> {
        let vertices = triangle.map(|corner| mesh.vertices[corner as usize]);
        let tone = u32::from(light::tone(vertices)?);
        let first = (0..3).min_by_key(|&k| place(vertices[k])).unwrap_or_default();
        let seen = triangle.map(|corner| corners[corner as usize]);
        let [a, b, c] = seen;
        let twice = doubled(seen.map(|corner| corner.at)) as f64;
        let near = |corner: Corner| f64::from(corner.near);
        let (of_b, of_c) = (near(b) - near(a), near(c) - near(a));
        let side = |p: Corner, axis: usize| f64::from(p.at[axis] - a.at[axis]);
        Some(Self {
            at: seen[first].at,
            tone,
            near: near(seen[first]),
            slope: [
                (of_b * side(c, 1) - of_c * side(b, 1)) / twice,
                (of_c * side(b, 0) - of_b * side(c, 0)) / twice,
            ],
            range: [
                near(a).at_most(near(b)).at_most(near(c)),
                near(a).at_least(near(b)).at_least(near(c)),
            ],
        })
    }

    /// What the samples of a row hold, from one `column` on, where this face is nearest.
    fn seen(&self, column: i32, row: i32) -> impl Iterator<Item = u32> {
        let away = |sample: i32, axis: usize| f64::from(centre(sample) - self.at[axis]);
        let first = self.near + away(row, 1) * self.slope[1];
        (column..).map(move |column| {
            let near = first + away(column, 0) * self.slope[0];
            (near.at_least(self.range[0]).at_most(self.range[1]) as u32) << 8 | self.tone
        })
    }
}

/// Twice the area of a triangle as seen; more than 0 if its inside is to the left of its
/// sides, as y grows downwards: if it is seen from behind.
fn doubled([a, b, c]: [[i32; 2]; 3]) -> i64 {
    let side = |corner: [i32; 2], axis: usize| i64::from(corner[axis]) - i64::from(a[axis]);
    side(b, 0) * side(c, 1) - side(b, 1) * side(c, 0)
}

/// What vertices are ordered by: as one number they are compared without a branch.
fn place(vertex: [i32; 3]) -> u128 {
    let ordered = |c: i32| u128::from(c as u32 ^ 1 << 31);
    vertex.into_iter().fold(0, |place, c| place << 32 | ordered(c))
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
