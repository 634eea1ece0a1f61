//! Text -> its size in pixels, and its pixels: one typeface, since a machine in a farm may have none.

use noto_sans_mono_bitmap::{FontWeight, RasterHeight, get_raster, get_raster_width};

/// Shown for what the typeface does not have.
const UNKNOWN: char = '?';

/// How large text is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TextSize(RasterHeight);

impl TextSize {
    /// The size for a picture whose longer side has this many pixels.
    #[must_use]
    pub fn suiting(pixels: u32) -> Self {
        Self(match pixels {
            0..1000 => RasterHeight::Size16,
            1000..1800 => RasterHeight::Size20,
            1800..2600 => RasterHeight::Size24,
            _ => RasterHeight::Size32,
        })
    }

    /// From line to line, pixels.
    #[must_use]
    pub fn height(self) -> f64 {
        self.0.val() as f64
    }

    /// Width of a letter, pixels; all are alike.
    #[must_use]
    pub fn advance(self) -> f64 {
        get_raster_width(FontWeight::Regular, self.0) as f64
    }

    /// Calls `dot` for each pixel of the text that has ink: column and row from the upper left
    /// corner of its first letter, and how much, 1 to 255.
    pub fn pixels(self, text: &str, dot: &mut dyn FnMut(usize, usize, u8)) {
        let raster = |letter| get_raster(letter, FontWeight::Regular, self.0);
        for (k, letter) in text.chars().enumerate() {
            let Some(glyph) = raster(letter).or_else(|| raster(UNKNOWN)) else { continue };
            for (row, line) in glyph.rows().enumerate() {
                for (column, &ink) in line.iter().enumerate().filter(|(_, ink)| **ink > 0) {
                    dot(k * glyph.width() + column, row, ink);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_letter_has_ink_within_its_box() {
        for pixels in [400, 1200, 2000, 4000] {
            let size = TextSize::suiting(pixels);
            let mut ink = [0; 3];
            size.pixels("a\u{4e2d}z", &mut |x, y, _| {
                assert!((y as f64) < size.height());
                ink[x / size.advance() as usize] += 1;
            });
            assert!(ink.iter().all(|ink| *ink > 10), "{ink:?}");
        }
    }
}
