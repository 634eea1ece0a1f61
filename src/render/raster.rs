//! Triangles -> pixels: which face is nearest at each sample, in bands of rows side by side.

use super::view::{Corner, GRAIN, View};
use super::{Pixel, light};
use crate::mesh::Mesh;
use rayon::prelude::*;
use std::cell::LazyCell;
use std::ops::RangeInclusive;

/// Samples that are drawn at a time, at most: few enough to stay in a processor's cache.
const BAND: u32 = 1 << 15;

/// Triangles that are looked through at a time for those that hold a sample.
const AT_ONCE: usize = 1 << 14;

/// All pixels, row by row from the top.
pub(super) fn pixels(mesh: &Mesh, view: &View, size: [u32; 2], samples: u32) -> Vec<Pixel> {
    let corners: Vec<Corner> =
        mesh.vertices.par_iter().map(|&vertex| view.corner(vertex)).collect();
    let grid = Grid::new(size, samples);
    let bins = bins(mesh, &corners, &grid);
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

/// The triangles that hold a sample, by the bands that they reach into; several lists for each
/// band, one after the other.
fn bins(mesh: &Mesh, corners: &[Corner], grid: &Grid) -> Vec<Vec<Vec<u32>>> {
    let chunks = mesh.triangles.par_chunks(AT_ONCE).enumerate();
    let bins = chunks.map(|(chunk, triangles)| {
        let mut bins = vec![Vec::new(); grid.bands];
        for (number, triangle) in (chunk * AT_ONCE..).zip(triangles) {
            let [columns, rows] = held(triangle.map(|corner| corners[corner as usize].at));
            // Most triangles of fine meshes lie between the samples.
            if !columns.is_empty() && !rows.is_empty() {
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
        let Some(outline) = Outline::new(mesh, corners, triangle) else { return };
        // Many a small triangle has a sample in its box but none in itself.
        let face = LazyCell::new(|| Face::new(mesh, corners, &outline));
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
        for (k, pixel) in pixels.iter_mut().enumerate() {
            let (row, column) = (k * side / self.width, k * side % self.width);
            let first = row * side * self.width + column;
            let (mut covered, mut tone, mut near) = (0, 0, 0);
            for row in 0..side {
                for &seen in &self.seen[first + row * self.width..][..side] {
                    covered += u32::from(seen > 0);
                    tone += seen & 0xff;
                    near += u64::from(seen >> 8);
                }
            }
            let count = covered.max(1);
            *pixel = Pixel {
                covered: covered as u8,
                tone: ((tone + count / 2) / count) as u8,
                near: (near / u64::from(count)) as u32,
            };
        }
    }
}

/// A triangle as seen.
struct Outline {
    /// Its corners, beginning with the one that has the least vertex, so that its inside is to the
    /// left of each side.
    corners: [u32; 3],
    at: [[i32; 2]; 3],
    /// Twice its area, more than 0.
    twice: i64,
}

impl Outline {
    /// `None` for a triangle that is seen from its edge.
    fn new(mesh: &Mesh, corners: &[Corner], [a, b, c]: [u32; 3]) -> Option<Self> {
        let vertex = |corner: u32| mesh.vertices[corner as usize];
        // One beginning, whichever corner the file names first.
        let [a, b, c] = match (vertex(a), vertex(b), vertex(c)) {
            (one, two, three) if one <= two && one <= three => [a, b, c],
            (_, two, three) if two <= three => [b, c, a],
            _ => [c, a, b],
        };
        let twice = doubled(corners, a, b, c);
        let corners_of = if twice < 0 { [a, c, b] } else { [a, b, c] };
        let at = corners_of.map(|corner| corners[corner as usize].at);
        (twice != 0).then_some(Self { corners: corners_of, at, twice: twice.abs() })
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
}

/// The surface of a triangle that is to be drawn.
struct Face {
    /// Its first corner.
    at: [i32; 2],
    tone: u32,
    /// Nearness at the first corner, and how it grows to the right and downwards.
    near: f64,
    slope: [f64; 2],
    /// Nearness of the farthest and the nearest corner.
    range: [f64; 2],
}

impl Face {
    /// `None` for a triangle without area.
    fn new(mesh: &Mesh, corners: &[Corner], outline: &Outline) -> Option<Self> {
        let [a, b, c] = outline.corners.map(|corner| mesh.vertices[corner as usize]);
        let tone = u32::from(light::tone(a, b, c)?);
        let [a, b, c] = outline.corners.map(|corner| corners[corner as usize]);
        let near = f64::from(a.near);
        let (of_b, of_c) = (f64::from(b.near) - near, f64::from(c.near) - near);
        let side = |p: Corner, axis: usize| f64::from(p.at[axis] - a.at[axis]);
        let twice = outline.twice as f64;
        Some(Self {
            at: a.at,
            tone,
            near,
            slope: [
                (of_b * side(c, 1) - of_c * side(b, 1)) / twice,
                (of_c * side(b, 0) - of_b * side(c, 0)) / twice,
            ],
            range: [near + of_b.min(of_c).min(0.0), near + of_b.max(of_c).max(0.0)],
        })
    }

    /// What the samples of a row hold, from one `column` on, where this face is nearest.
    fn seen(&self, column: i32, row: i32) -> impl Iterator<Item = u32> {
        let away = |sample: i32, axis: usize| f64::from(centre(sample) - self.at[axis]);
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
