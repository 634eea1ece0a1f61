//! Pixels -> colours: darkens hollows and edges, then turns tones into shades of one colour.

use super::{Ground, Pixel};
use std::collections::VecDeque;

/// Colours for some tones, from dark to bright; tones between them are interpolated. Saturated in
/// the middle, so that no face vanishes on a light or on a dark page. Chosen by eye.
const SHADES: [(u32, [u32; 3]); 4] =
    [(0, [54, 30, 26]), (110, [176, 74, 28]), (190, [240, 132, 44]), (255, [255, 206, 128])];

/// The surroundings of a pixel reach this part (1/40) of the longer side. Chosen by eye: wider ones blur the
/// dark edge of a step, narrower ones leave only a thin line.
const REACH: u32 = 40;

/// Tones that a pixel would lose if it lay behind its surroundings by the models' whole depth.
/// Chosen by eye: a step of 1/100 of the depth loses 11 tones, and shows.
const HOLLOW: f64 = 1100.0;

/// Tones that a pixel loses at most, so that deep holes keep their colour.
const DARKEST: f64 = 70.0;

/// Red, green, blue and alpha of each pixel.
pub(super) fn tint(pixels: &[Pixel], size: [u32; 2], samples: u32, ground: Ground) -> Vec<u8> {
    let full = samples * samples;
    let shades: Vec<[u32; 3]> = (0..=255).map(shade).collect();
    let mut rgba = Vec::with_capacity(4 * pixels.len());
    for (row, around) in pixels.chunks(size[0].max(1) as usize).zip(surroundings(pixels, size)) {
        for (pixel, around) in row.iter().zip(around) {
            let alpha = (255 * u32::from(pixel.covered) + full / 2) / full;
            let rgb = if alpha == 0 { [0; 3] } else { shades[darkened(pixel, around) as usize] };
            rgba.extend_from_slice(&match ground {
                Ground::Transparent => [rgb[0] as u8, rgb[1] as u8, rgb[2] as u8, alpha as u8],
                Ground::White => {
                    let mixed = rgb.map(|c| ((c * alpha + 255 * (255 - alpha) + 127) / 255) as u8);
                    [mixed[0], mixed[1], mixed[2], 255]
                }
            });
        }
    }
    rgba
}

/// The tone of a pixel, darkened if it lies behind its surroundings: unsharp masking of the depth
/// buffer, after Luft, Colditz and Deussen, 2006.
fn darkened(pixel: &Pixel, around: Sum) -> u8 {
    let around = around.near as f64 / around.count.max(1) as f64;
    let behind = (around - f64::from(pixel.near)) / 16_777_216.0;
    let lost = (HOLLOW * behind).clamp(0.0, DARKEST);
    (f64::from(pixel.tone) - lost) as u8
}

/// The colour of a tone.
fn shade(tone: u32) -> [u32; 3] {
    let above = SHADES.iter().position(|&(at, _)| tone <= at).unwrap_or(SHADES.len() - 1).max(1);
    let ((low, dark), (high, bright)) = (SHADES[above - 1], SHADES[above]);
    std::array::from_fn(|k| {
        (dark[k] * (high - tone) + bright[k] * (tone - low) + (high - low) / 2) / (high - low)
    })
}

/// Sums over some pixels.
#[derive(Debug, Clone, Copy, Default)]
struct Sum {
    /// Samples that show a model.
    count: u64,
    /// Their nearness, summed.
    near: u64,
}

impl Sum {
    fn add(&mut self, other: Self) {
        self.count += other.count;
        self.near += other.near;
    }

    fn take(&mut self, other: Self) {
        self.count -= other.count;
        self.near -= other.near;
    }
}

/// The sums around each pixel, row by row.
fn surroundings(pixels: &[Pixel], size: [u32; 2]) -> impl Iterator<Item = Vec<Sum>> {
    let width = size[0].max(1) as usize;
    let reach = (size[0].max(size[1]) / REACH).max(1) as usize;
    let sum = |pixel: &Pixel| {
        let count = u64::from(pixel.covered);
        Sum { count, near: count * u64::from(pixel.near) }
    };
    let rows = pixels.chunks(width).map(move |row| row.iter().map(sum).collect());
    let across = move |row: Vec<Sum>| blurred_row(&row, reach);
    Columns::new(Columns::new(rows, reach).map(across), reach).map(across)
}

/// For each place of a row the sum of the ones within `reach`.
fn blurred_row(row: &[Sum], reach: usize) -> Vec<Sum> {
    let mut sum = Sum::default();
    row.iter().take(reach).for_each(|&one| sum.add(one));
    let blurred = (0..row.len()).map(|k| {
        if let Some(&next) = row.get(k + reach) {
            sum.add(next);
        }
        let around = sum;
        if let Some(last) = k.checked_sub(reach) {
            sum.take(row[last]);
        }
        around
    });
    blurred.collect()
}

/// For each row the sums of the rows within `reach`, column by column. Only these rows are held.
struct Columns<I> {
    rows: I,
    reach: usize,
    /// The rows within reach of the next row, from the top.
    held: VecDeque<Vec<Sum>>,
    /// How many of these are above the next row.
    above: usize,
    /// Their sums, column by column.
    window: Vec<Sum>,
}

impl<I> Columns<I> {
    fn new(rows: I, reach: usize) -> Self {
        Self { rows, reach, held: VecDeque::new(), above: 0, window: Vec::new() }
    }
}

impl<I: Iterator<Item = Vec<Sum>>> Iterator for Columns<I> {
    type Item = Vec<Sum>;

    fn next(&mut self) -> Option<Vec<Sum>> {
        while self.held.len() <= self.above + self.reach {
            let Some(row) = self.rows.next() else { break };
            self.window.resize(row.len(), Sum::default());
            self.window.iter_mut().zip(&row).for_each(|(sum, &one)| sum.add(one));
            self.held.push_back(row);
        }
        if self.held.len() <= self.above {
            return None;
        }
        let sums = self.window.clone();
        if self.above < self.reach {
            self.above += 1;
            return Some(sums);
        }
        let last = self.held.pop_front();
        self.window.iter_mut().zip(last.iter().flatten()).for_each(|(sum, &one)| sum.take(one));
        Some(sums)
    }
}
