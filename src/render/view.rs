//! Mesh + picture's size -> View: projects each vertex into the picture, with its nearness.

use crate::mesh::Mesh;
use crate::units::nearest;
use rayon::prelude::*;

/// Steps from one sample to the next. Corners are whole numbers of steps, so that edges are exact
/// and neighbouring faces leave no cracks. Fewer steps make the edges of thin faces uneven; more
/// make no difference in 8 bits a channel.
pub(super) const GRAIN: i32 = 256;

/// The largest [`Corner::near`]: 24 bits, less one that rounding may add. A sample keeps nearness
/// and tone in 32 bits.
const NEAREST: f64 = 16_777_214.0;

/// Margin at each side, as a part of the picture's shorter side; chosen by eye.
const MARGIN: f64 = 0.03;

/// Towards the eye, times 17: the camera stands to the front right and looks down by 28°. Chosen
/// so that all three axes are whole numbers of one length.
pub(super) const TO_EYE: [i64; 3] = [9, -12, 8];
/// To the right in the picture, times 85.
const RIGHT: [i64; 3] = [68, 51, 0];
/// Upwards in the picture, times 85.
const UP: [i64; 3] = [-24, 32, 75];

/// A projected vertex.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Corner {
    /// From the picture's top left corner to the right and down, in steps of 1/[`GRAIN`] sample.
    pub(super) at: [i32; 2],
    /// Nearness: from 1 at the far end of the models to 2²⁴ - 1 at the near end.
    pub(super) near: f32,
}

/// The camera: parallel rays, scaled so that the models fill the picture.
#[derive(Debug, Clone)]
pub(super) struct View {
    /// Steps for each unit along [`RIGHT`] and [`UP`].
    scale: f64,
    /// The middle of the models along [`RIGHT`] and [`UP`], times 2.
    middle: [i64; 2],
    /// The middle of the picture, in steps.
    centre: [f64; 2],
    /// The far end of the models along [`TO_EYE`].
    far: i64,
    /// Nearness for each unit along [`TO_EYE`].
    depth: f64,
}

impl View {
    /// A view of all of `mesh` in a picture of `size` pixels, with `samples` along each side of a
    /// pixel.
    pub(super) fn new(mesh: &Mesh, size: [u32; 2], samples: u32) -> Self {
        let [right, up, eye] = spans(mesh);
        let grains = f64::from(samples) * f64::from(GRAIN);
        let margin = (MARGIN * f64::from(size[0].min(size[1]))).max(1.0);
        let room = size.map(|pixels| (f64::from(pixels) - 2.0 * margin).max(1.0) * grains);
        Self {
            scale: (room[0] / extent(right)).min(room[1] / extent(up)),
            middle: [right, up].map(|[low, high]| low + high),
            centre: size.map(|pixels| f64::from(pixels) * grains / 2.0),
            far: eye[0],
            depth: NEAREST / (eye[1] - eye[0]).max(1) as f64,
        }
    }

    /// Projects a vertex.
    pub(super) fn corner(&self, vertex: [i32; 3]) -> Corner {
        let away = |axis: [i64; 3], middle: i64| {
            (2 * along(vertex, axis) - middle) as f64 / 2.0 * self.scale
        };
        Corner {
            at: [
                nearest(self.centre[0] + away(RIGHT, self.middle[0])) as i32,
                nearest(self.centre[1] - away(UP, self.middle[1])) as i32,
            ],
            near: (1.0 + (along(vertex, TO_EYE) - self.far) as f64 * self.depth) as f32,
        }
    }
}

/// Width and height of `mesh` in the picture; only their ratio has a meaning.
pub(super) fn extents(mesh: &Mesh) -> [f64; 2] {
    let [right, up, _] = spans(mesh);
    [extent(right), extent(up)]
}

fn extent([low, high]: [i64; 2]) -> f64 {
    (high - low).max(1) as f64
}

fn along(vertex: [i32; 3], axis: [i64; 3]) -> i64 {
    (0..3).map(|k| i64::from(vertex[k]) * axis[k]).sum()
}

/// The lowest and highest place of `mesh` along the three axes.
fn spans(mesh: &Mesh) -> [[i64; 2]; 3] {
    let here = |vertex: &[i32; 3]| [RIGHT, UP, TO_EYE].map(|axis| [along(*vertex, axis); 2]);
    let both = |a: [[i64; 2]; 3], b: [[i64; 2]; 3]| {
        std::array::from_fn(|k| [a[k][0].min(b[k][0]), a[k][1].max(b[k][1])])
    };
    let all = mesh.vertices.par_iter().map(here);
    all.reduce_with(both).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_axes_are_square_and_of_one_length() {
        let dot = |a: [i64; 3], b: [i64; 3]| (0..3).map(|k| a[k] * b[k]).sum::<i64>();
        assert_eq!([dot(RIGHT, UP), dot(UP, TO_EYE), dot(TO_EYE, RIGHT)], [0; 3]);
        assert_eq!([dot(RIGHT, RIGHT), dot(UP, UP), dot(TO_EYE, TO_EYE)], [7225, 7225, 289]);
    }
}
