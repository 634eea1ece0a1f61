//! Triangles -> pixels: finds the nearest face at each sample, band by band.
//!
//! A sample is a point of the picture, `samples` x `samples` of them in each pixel. A step is
//! 1/256 of the way from one sample to the next; corners are whole numbers of steps. A band is
//! some rows of pixels whose samples fit a processor's cache.
//!
//! 1. All threads sort the triangles into bins, one for each band that they reach into. Most
//!    triangles of a fine mesh lie between the samples and are skipped here.
//! 2. Each thread draws bands. A triangle covers an interval of each row, found by exact integer
//!    division. A sample on an edge belongs to both faces, so that there are no cracks.
//! 3. A sample holds nearness in its upper 24 bits and tone in its lower 8. The larger value wins: the nearer face,
//!    and of two equally near ones the brighter, whatever the order of the triangles.
//! 4. The samples of each pixel become its mean.

use super::view::{Corner, GRAIN, View};
use super::{Faces, Pixel, light};
use crate::mesh::Mesh;
use crate::units::Bounded as _;
use rayon::prelude::*;
use std::cell::LazyCell;
use std::ops::RangeInclusive;

/// Samples of a band, at most: 128 KB, which stay in a processor's cache. Larger bands also leave
/// threads without work in small pictures.
const BAND: u32 = 1 << 15;

/// Triangles that a thread sorts into bins at a time: enough that the lists of its bins cost little.
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
    bands.for_each_init(Vec::new, |nearest, (band, pixels)| {
        let mut samples = Samples::new(&grid, band, pixels.len(), nearest);
        for triangle in bins.iter().flat_map(|bins| &bins[band]) {
            samples.triangle(mesh, &corners, mesh.triangles[*triangle as usize]);
        }
        samples.resolve(pixels);
    });
    pixels
}

/// The bins: for each chunk of triangles and each band, the triangles to draw whose boxes hold a
/// sample of the band.
fn bins(mesh: &Mesh, faces: Faces, corners: &[Corner], grid: &Grid) -> Vec<Vec<Vec<u32>>> {
    let looks_away = |at| faces == Faces::Outer && doubled(at) >= 0;
    let chunks = mesh.triangles.par_chunks(AT_ONCE).enumerate();
    let bins = chunks.map(|(chunk, triangles)| {
        let mut bins = vec![Vec::new(); grid.bands];
        for (number, triangle) in (chunk * AT_ONCE..).zip(triangles) {
            let at = triangle.map(|corner| corners[corner as usize].at);
            let [columns, rows] = held(at);
            if !columns.is_empty() && !rows.is_empty() && !looks_away(at) {
                let bands = grid.band_of(*rows.start())..=grid.band_of(*rows.end());
                bins[bands].iter_mut().for_each(|bin| bin.push(number as u32));
            }
        }
        bins
    });
    bins.collect()
}

/// The columns and rows of samples in a triangle's box.
fn held(corners: [[i32; 2]; 3]) -> [RangeInclusive<i32>; 2] {
    let along = |axis: usize| {
        let [least, most] = extent(corners, axis);
        first_sample(least)..=last_sample(most)
    };
    [along(0), along(1)]
}

/// The lowest and highest coordinate of a triangle along an axis.
fn extent(corners: [[i32; 2]; 3], axis: usize) -> [i32; 2] {
    let [a, b, c] = corners.map(|corner| corner[axis]);
    [a.min(b).min(c), a.max(b).max(c)]
}

/// How a picture is divided into bands.
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
    /// The first row and the one after the last, from the top of the picture.
    rows: [i32; 2],
    /// Nearness in the upper 24 bits and tone in the lower 8; 0 where there is no model.
    nearest: &'a mut Vec<u32>,
}

impl<'a> Samples<'a> {
    /// The samples of a band with this many `pixels`, in memory that is used again.
    fn new(grid: &Grid, band: usize, pixels: usize, nearest: &'a mut Vec<u32>) -> Self {
        let per_pixel = grid.samples;
        let width = grid.width * per_pixel;
        let first = (band * grid.band * per_pixel) as i32;
        let count = pixels * per_pixel * per_pixel;
        nearest.clear();
        nearest.resize(count, 0);
        Self { per_pixel, width, rows: [first, first + (count / width.max(1)) as i32], nearest }
    }

    /// Draws a triangle.
    fn triangle(&mut self, mesh: &Mesh, corners: &[Corner], triangle: [u32; 3]) {
        let at = triangle.map(|corner| corners[corner as usize].at);
        let [_, rows] = held(at);
        let first = (*rows.start()).max(self.rows[0]);
        let last = (*rows.end()).min(self.rows[1] - 1);
        let range = extent(at, 0);
        let Some(outline) = Outline::new(at) else { return };
        // Many small triangles have a sample in their box but none in themselves.
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
            let samples = &mut self.nearest[start + from as usize..=start + to as usize];
            for (sample, value) in samples.iter_mut().zip(face.samples(from, row)) {
                *sample = (*sample).max(value);
            }
        }
    }

    /// Takes the mean of the samples of each pixel.
    fn resolve(&self, pixels: &mut [Pixel]) {
        let side = self.per_pixel;
        let rows = self.nearest.chunks(self.width * side);
        for (samples, pixels) in rows.zip(pixels.chunks_mut(self.width / side)) {
            for (k, pixel) in pixels.iter_mut().enumerate() {
                let rows = samples.chunks_exact(self.width);
                *pixel = resolved(rows.flat_map(|row| &row[k * side..][..side]));
            }
        }
    }
}

/// The mean of the samples of a pixel.
fn resolved<'a>(samples: impl Iterator<Item = &'a u32>) -> Pixel {
    // No overflow: at most 64 samples of a nearness below 2²⁴.
    let (mut covered, mut tone, mut near) = (0, 0, 0);
    for &sample in samples {
        covered += u32::from(sample > 0);
        tone += sample & 0xff;
        near += sample >> 8;
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

/// The corners of a projected triangle, in an order in which its inside is to the left of each side.
struct Outline([[i32; 2]; 3]);

impl Outline {
    /// `None` for a triangle without area in the picture.
    fn new([a, b, c]: [[i32; 2]; 3]) -> Option<Self> {
        match doubled([a, b, c]) {
            0 => None,
            1.. => Some(Self([a, b, c])),
            _ => Some(Self([a, c, b])),
        }
    }

    /// The first and last step that it covers on the row at `y`, within `range`.
    fn within(&self, y: i32, range: [i32; 2]) -> [i32; 2] {
        let (low, high) = (i64::from(range[0]), i64::from(range[1]));
        let (mut from, mut to) = (low, high);
        for k in 0..3 {
            let at = |corner: usize, axis: usize| i64::from(self.0[corner % 3][axis]);
            // On the side or to the left of it: rise * x <= limit.
            let rise = at(k + 1, 1) - at(k, 1);
            let run = at(k + 1, 0) - at(k, 0);
            let limit = run * (i64::from(y) - at(k, 1)) + rise * at(k, 0);
            match rise {
                0 => {}
                1.. => to = to.min(limit.div_euclid(rise)),
                _ => from = from.max(-limit.div_euclid(-rise)),
            }
        }
        // An empty interval may lie anywhere: it is clamped to just outside the range.
        [from.min(high + 1) as i32, to.max(low - 1) as i32]
    }
}

/// A triangle's tone, and its nearness as a function of the place.
struct Face {
    /// One of its corners.
    at: [i32; 2],
    tone: u32,
    /// Nearness at this corner, and its slope to the right and downwards.
    near: f64,
    slope: [f64; 2],
    /// Nearness of the farthest and the nearest corner.
    range: [f64; 2],
}

impl Face {
    /// `None` for a triangle without area. The order of the corners does not matter: all products
    /// and sums are exact until they are divided.
    fn new(mesh: &Mesh, corners: &[Corner], triangle: [u32; 3]) -> Option<Self> {
        let vertices = triangle.map(|corner| mesh.vertices[corner as usize]);
        let tone = u32::from(light::tone(vertices)?);
        let first = (0..3).min_by_key(|&k| place(vertices[k])).unwrap_or_default();
        let projected = triangle.map(|corner| corners[corner as usize]);
        let [a, b, c] = projected;
        let twice = doubled(projected.map(|corner| corner.at)) as f64;
        let near = |corner: Corner| f64::from(corner.near);
        let (of_b, of_c) = (near(b) - near(a), near(c) - near(a));
        let side = |p: Corner, axis: usize| f64::from(p.at[axis] - a.at[axis]);
        Some(Self {
            at: projected[first].at,
            tone,
            near: near(projected[first]),
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

    /// The values of the samples of a row from `column` on, where this face is nearest.
    fn samples(&self, column: i32, row: i32) -> impl Iterator<Item = u32> {
        let away = |sample: i32, axis: usize| f64::from(centre(sample) - self.at[axis]);
        let first = self.near + away(row, 1) * self.slope[1];
        (column..).map(move |column| {
            let near = first + away(column, 0) * self.slope[0];
            (near.at_least(self.range[0]).at_most(self.range[1]) as u32) << 8 | self.tone
        })
    }
}

/// Twice the signed area of a projected triangle. Since y grows downwards, it is positive for a
/// triangle that is seen from behind, whose inside is to the left of its sides.
fn doubled([a, b, c]: [[i32; 2]; 3]) -> i64 {
    let side = |corner: [i32; 2], axis: usize| i64::from(corner[axis]) - i64::from(a[axis]);
    side(b, 0) * side(c, 1) - side(b, 1) * side(c, 0)
}

/// A vertex as one number: these are compared without a branch.
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
