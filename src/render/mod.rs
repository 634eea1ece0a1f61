//! Mesh -> Picture: draws the placed models in software, seen from the front right above.
//!
//! A sample is a point of the picture; each pixel has a square of them. The tone of a face is its
//! brightness, 0 to 255. Nearness grows towards the eye.
//!
//! 1. `view` projects each vertex along parallel rays: where it is in the picture, and how near.
//! 2. `raster` finds the nearest face at each sample, with its tone from `light`, and takes the
//!    mean of the samples of each pixel. Bands of rows are drawn by all threads.
//! 3. `tint` darkens what lies behind its surroundings, and turns tones into colours.
//!
//! A picture has the same bytes on every machine: all arithmetic is integers, and sums, products,
//! quotients and square roots of `f64`, which every processor rounds alike. The nearest face at a
//! sample does not depend on the order of the triangles, and so neither does the picture.

mod light;
mod raster;
mod tint;
mod view;

use crate::mesh::Mesh;

/// What is behind the models.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ground {
    /// Nothing: alpha 0.
    Transparent,
    /// White paper.
    White,
}

/// Which faces are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Faces {
    /// Those that look at the eye. In a closed mesh that faces outward they hide all others: the
    /// picture is the same in less time.
    Outer,
    /// All of them, whichever way they face.
    Both,
}

impl Faces {
    /// The faces to draw of a mesh that is closed and faces outward, or of any other mesh.
    #[must_use]
    pub fn of(is_sound: bool) -> Self {
        if is_sound { Self::Outer } else { Self::Both }
    }
}

/// A picture of 8 bits a channel.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Picture {
    /// Pixels from left to right.
    pub width: u32,
    /// Pixels from top to bottom.
    pub height: u32,
    /// Red, green, blue and alpha (not multiplied into the colours) of each pixel, row by
    /// row from the top.
    pub rgba: Vec<u8>,
}

/// One pixel before it has a colour.
#[derive(Debug, Clone, Copy, Default)]
struct Pixel {
    /// The number of its samples that show a model.
    covered: u8,
    /// Their mean tone.
    tone: u8,
    /// Their mean nearness; see [`view::Corner::near`].
    near: u32,
}

/// Draws `mesh` as large as `[width, height]` pixels allow, with a narrow margin.
#[must_use]
pub fn draw(mesh: &Mesh, faces: Faces, size: [u32; 2], ground: Ground) -> Picture {
    let samples = samples(size);
    let view = view::View::new(mesh, size, samples);
    let pixels = raster::pixels(mesh, faces, &view, size, samples);
    let rgba = tint::tint(&pixels, size, samples, ground);
    Picture { width: size[0], height: size[1], rgba }
}

/// Width and height of a picture of `mesh` whose longer side has `longer` pixels. It has the
/// proportions of what it shows, but at most 3 to 1.
#[must_use]
pub fn fitting(mesh: &Mesh, longer: u32) -> [u32; 2] {
    let [wide, high] = view::extents(mesh);
    let part = |side: f64| (side / wide.max(high)).clamp(1.0 / 3.0, 1.0);
    [wide, high].map(|side| ((part(side) * f64::from(longer)).round() as u32).max(1))
}

/// Samples along each side of a pixel: the fewer pixels, the more samples. 2 x 2 look the same as 3 x 3 in
/// pictures of 300 pixels and take less than half the time; icons of 32 need 8 x 8.
fn samples(size: [u32; 2]) -> u32 {
    /// Samples along the longer side, at least, if 8 x 8 for each pixel make that many.
    const WISHED: u32 = 600;
    (WISHED / size[0].max(size[1]).max(1)).clamp(2, 8)
}

impl Picture {
    /// The picture as the bytes of a PNG file.
    ///
    /// # Errors
    /// A picture without pixels.
    pub fn png(&self) -> std::io::Result<Vec<u8>> {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, self.width, self.height);
        encoder.set_color(png::ColorType::Rgba);
        encoder.set_depth(png::BitDepth::Eight);
        // A tenth more bytes than the default compression, in a tenth of its time.
        encoder.set_deflate_compression(png::DeflateCompression::FdeflateUltraFast);
        encoder.set_filter(png::Filter::Paeth);
        let mut writer = encoder.write_header()?;
        writer.write_image_data(&self.rgba)?;
        writer.finish()?;
        Ok(bytes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A block with its lower corner at the origin; triangles counter-clockwise from outside.
    fn block([x, y, z]: [i32; 3]) -> Mesh {
        let corner = |k: i32| [(k & 1) * x, (k >> 1 & 1) * y, (k >> 2) * z];
        let quads =
            [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [1, 3, 7, 5], [3, 2, 6, 7], [2, 0, 4, 6]];
        let halves = |[a, b, c, d]: [u32; 4]| [[a, b, c], [a, c, d]];
        Mesh {
            vertices: (0..8).map(corner).collect(),
            triangles: quads.into_iter().flat_map(halves).collect(),
        }
    }

    fn at(picture: &Picture, x: u32, y: u32) -> [u8; 4] {
        let start = 4 * (y * picture.width + x) as usize;
        std::array::from_fn(|channel| picture.rgba[start + channel])
    }

    #[test]
    fn a_cube_shows_its_front_right_and_top_in_three_tones() {
        let picture = draw(&block([200_000; 3]), Faces::Both, [100, 100], Ground::Transparent);
        let (front, right, top) =
            (at(&picture, 35, 62), at(&picture, 78, 62), at(&picture, 50, 18));
        let light = |rgba: [u8; 4]| rgba[..3].iter().map(|&c| u32::from(c)).sum::<u32>();
        assert!([front, right, top].iter().all(|rgba| rgba[3] == 255));
        assert!(light(top) > light(front) + 60, "{top:?} {front:?}");
        assert!(light(front) > light(right) + 60, "{front:?} {right:?}");
        assert_eq!(at(&picture, 0, 0), [0; 4]);
    }

    #[test]
    fn the_picture_is_filled_up_to_its_margin() {
        for size in [[32, 32], [300, 300], [220, 124], [64, 200]] {
            for sides in [[200_000; 3], [2_000_000, 10_000, 500], [5_000, 5_000, 900_000]] {
                let picture = draw(&block(sides), Faces::Both, size, Ground::Transparent);
                let shown = |x, y| at(&picture, x, y)[3] > 0;
                let columns = (0..size[0]).filter(|&x| (0..size[1]).any(|y| shown(x, y))).count();
                let rows = (0..size[1]).filter(|&y| (0..size[0]).any(|x| shown(x, y))).count();
                let fills = |found: usize, all: u32| {
                    let free = all as usize - found;
                    (2..=2 + all as usize / 8).contains(&free)
                };
                assert!(fills(columns, size[0]) || fills(rows, size[1]), "{size:?} {sides:?}");
            }
        }
    }

    #[test]
    fn a_fitting_picture_is_as_flat_as_the_model() {
        for (sides, flat) in [([200_000; 3], false), ([2_000_000, 10_000, 500], true)] {
            let size = fitting(&block(sides), 300);
            assert_eq!(size[0].max(size[1]), 300);
            assert_eq!(size[1] <= 150, flat, "{size:?}");
            assert!(size[1] >= 100);
        }
    }

    #[test]
    fn neither_order_of_triangles_nor_of_corners_nor_winding_matters() {
        let mesh = block([300_000, 100_000, 200_000]);
        let picture = draw(&mesh, Faces::Both, [90, 60], Ground::White);
        let mut other = mesh.clone();
        other.triangles.reverse();
        other.triangles.iter_mut().for_each(|corners| corners.rotate_left(1));
        assert!(picture == draw(&other, Faces::Both, [90, 60], Ground::White));
        other.triangles.iter_mut().for_each(|corners| corners.reverse());
        assert!(picture == draw(&other, Faces::Both, [90, 60], Ground::White));
        assert!(picture.rgba.chunks(4).all(|rgba| rgba[3] == 255));
    }

    #[test]
    fn outer_faces_hide_the_others_of_a_closed_mesh() {
        // Two blocks that overlap, the second with a cavity.
        let solid = block([200_000, 150_000, 300_000]);
        let mut mesh = block([260_000, 40_000, 90_000]);
        let mut add = |other: &Mesh, by: i32, inwards: bool| {
            let first = mesh.vertices.len() as u32;
            mesh.vertices.extend(other.vertices.iter().map(|at| at.map(|c| c + by)));
            let added = other.triangles.iter().map(|corners| corners.map(|k| first + k));
            mesh.triangles
                .extend(added.map(|[a, b, c]| if inwards { [a, c, b] } else { [a, b, c] }));
        };
        add(&solid, 10_000, false);
        add(&block([90_000; 3]), 30_000, true);
        for size in [[32, 32], [300, 300], [220, 124]] {
            let drawn = |faces| draw(&mesh, faces, size, Ground::Transparent);
            assert!(drawn(Faces::Outer) == drawn(Faces::Both), "{size:?}");
        }
    }

    #[test]
    fn closed_surfaces_have_no_cracks() {
        // A fan of slivers over the top of a block's outline.
        let count = 600;
        let turn = |k: u32| crate::units::sin_cos(360.0 * f64::from(k) / f64::from(count));
        let rim = |k: u32| [(3e5 * turn(k).1) as i32, (3e5 * turn(k).0) as i32, 0];
        let mut vertices: Vec<[i32; 3]> = (0..count).map(rim).collect();
        vertices.push([1_234, 777, 0]);
        let triangles = (0..count).map(|k| [count, k, (k + 1) % count]).collect();
        let picture =
            draw(&Mesh { vertices, triangles }, Faces::Both, [200, 200], Ground::Transparent);
        for y in 0..200 {
            let shown: Vec<u32> = (0..200).filter(|&x| at(&picture, x, y)[3] == 255).collect();
            if let (Some(first), Some(last)) = (shown.first(), shown.last()) {
                assert_eq!(shown.len() as u32, last - first + 1, "row {y}");
            }
        }
    }

    #[test]
    fn nothing_to_see_gives_an_empty_picture() {
        let line = Mesh { vertices: vec![[0; 3], [5; 3], [9; 3]], triangles: vec![[0, 1, 2]] };
        for mesh in [Mesh::default(), line] {
            let picture = draw(&mesh, Faces::Both, [20, 10], Ground::Transparent);
            assert!(picture.rgba.iter().all(|&byte| byte == 0));
        }
        assert!(draw(&Mesh::default(), Faces::Both, [0, 10], Ground::White).png().is_err());
    }

    #[test]
    fn png_gives_the_pixels_back() {
        let picture = draw(&block([200_000; 3]), Faces::Both, [40, 30], Ground::Transparent);
        let bytes = picture.png().unwrap();
        let mut reader = png::Decoder::new(std::io::Cursor::new(&bytes)).read_info().unwrap();
        let mut rgba = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut rgba).unwrap();
        assert_eq!((info.width, info.height), (40, 30));
        assert!(rgba == picture.rgba);
    }
}
