//! Pixels -> colours: hollows and edges darker than their surroundings, then tones as one colour's shades.

use super::{Ground, Pixel};

/// Shades from dark to bright, with the tones that they stand for. Saturated in the
/// middle, so that no face is lost on a light or on a dark page.
const SHADES: [(u32, [u32; 3]); 4] =
    [(0, [54, 30, 26]), (110, [176, 74, 28]), (190, [240, 132, 44]), (255, [255, 206, 128])];

/// How far around a pixel the surroundings reach, as a part of the longer side.
const REACH: u32 = 40;

/// Tones that a pixel loses for lying behind its surroundings by the models' whole depth.
const HOLLOW: f64 = 1100.0;

/// Tones that are lost at most.
const DARKEST: f64 = 70.0;

/// Red, green, blue and alpha of each pixel.
pub(super) fn tint(pixels: &[Pixel], size: [u32; 2], samples: u32, ground: Ground) -> Vec<u8> {
    let around = surroundings(pixels, size);
    let full = samples * samples;
    let colour = |(pixel, around): (&Pixel, &f64)| {
        let alpha = (255 * pixel.covered + full / 2) / full;
        let rgb = if alpha == 0 { [0; 3] } else { shade(darkened(pixel, *around)) };
        match ground {
            Ground::Transparent => [rgb[0] as u8, rgb[1] as u8, rgb[2] as u8, alpha as u8],
            Ground::White => {
                let mixed = rgb.map(|c| ((c * alpha + 255 * (255 - alpha) + 127) / 255) as u8);
                [mixed[0], mixed[1], mixed[2], 255]
            }
        }
    };
    pixels.iter().zip(&around).flat_map(colour).collect()
}

/// The tone of a pixel after it is compared with its surroundings: unsharp masking of the
/// depth, after Luft, Colditz and Deussen 2006.
fn darkened(pixel: &Pixel, around: f64) -> u32 {
    let behind = (around - f64::from(pixel.near)) / 16_777_216.0;
    let lost = (HOLLOW * behind).clamp(0.0, DARKEST);
    (f64::from(pixel.tone) - lost).max(0.0) as u32
}

/// The colour of a tone.
fn shade(tone: u32) -> [u32; 3] {
    let above = SHADES.iter().position(|&(at, _)| tone <= at).unwrap_or(SHADES.len() - 1).max(1);
    let ((low, dark), (high, bright)) = (SHADES[above - 1], SHADES[above]);
    std::array::from_fn(|k| {
        (dark[k] * (high - tone) + bright[k] * (tone - low) + (high - low) / 2) / (high - low)
    })
}

/// The mean nearness around each pixel, of the pixels that show a model.
fn surroundings(pixels: &[Pixel], size: [u32; 2]) -> Vec<f64> {
    let width = size[0].max(1) as usize;
    let reach = (size[0].max(size[1]) / REACH).max(1) as usize;
    let mut sums: Vec<[u64; 2]> = pixels
        .iter()
        .map(|pixel| [u64::from(pixel.covered), u64::from(pixel.covered) * u64::from(pixel.near)])
        .collect();
    for _ in 0..2 {
        sums = blur_columns(&sums, reach, width);
        sums.chunks_mut(width).for_each(|row| blur_row(row, reach));
    }
    sums.into_iter().map(|[count, near]| near as f64 / count.max(1) as f64).collect()
}

/// Each of a row's sums becomes that of the ones within `reach` of it.
fn blur_row(row: &mut [[u64; 2]], reach: usize) {
    let before = row.to_vec();
    let mut sum = [0; 2];
    for k in 0..row.len() + reach {
        if let Some(next) = before.get(k) {
            (0..2).for_each(|part| sum[part] += next[part]);
        }
        if let Some(last) = k.checked_sub(2 * reach + 1) {
            (0..2).for_each(|part| sum[part] -= before[last][part]);
        }
        if let Some(here) = k.checked_sub(reach) {
            row[here] = sum;
        }
    }
}

/// Each of the columns' sums becomes that of the ones within `reach` of it: all columns at a
/// time, as memory lies by rows.
fn blur_columns(sums: &[[u64; 2]], reach: usize, width: usize) -> Vec<[u64; 2]> {
    let rows: Vec<&[[u64; 2]]> = sums.chunks(width).collect();
    let mut out = Vec::with_capacity(sums.len());
    let mut window = vec![[0; 2]; width];
    for k in 0..rows.len() + reach {
        if let Some(&next) = rows.get(k) {
            for (sum, one) in window.iter_mut().zip(next) {
                (0..2).for_each(|part| sum[part] += one[part]);
            }
        }
        if let Some(last) = k.checked_sub(2 * reach + 1) {
            for (sum, one) in window.iter_mut().zip(rows[last]) {
                (0..2).for_each(|part| sum[part] -= one[part]);
            }
        }
        if k >= reach {
            out.extend_from_slice(&window);
        }
    }
    out
}
