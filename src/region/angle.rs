//! Mesh -> angle: the direction in which raster lines have the fewest ends, and so the fewest turns.
//!
//! A straight side of length `l` at an angle `a` to the lines cuts `l·|sin a|` of them, divided
//! by their distance, and `l·|cos a|` of the lines across. So the number of ends in both
//! directions is proportional to the length of the sides measured along the two directions: the
//! "taxicab" length. A face with the area vector `N` has sides of total length `|Nxy|` over all
//! heights, at right angles to `Nxy`. So a sum over all faces is enough; no layer is needed.

use crate::mesh::Mesh;
use crate::units::sin_cos;
use rayon::prelude::*;

/// One bin for each degree of a quarter turn: the direction across belongs to the same pair.
const BINS: usize = 90;

/// The usual direction. Another one is taken only if it has at least 2 % fewer ends: a smaller
/// gain is noise, and would change the angle with every small change of a model.
const USUAL: f64 = 45.0;

/// See [`USUAL`].
const GAIN: f64 = 0.98;

/// Angles are rounded to this fraction of a degree. Vertices on the grid give the sides of one
/// turned box angles that differ by less.
const STEPS: f64 = 100.0;

/// The best direction for the lines of even layers, degrees from the x axis, 0 to 90. Those of
/// odd layers run across.
#[must_use]
pub fn least_turns(mesh: &Mesh) -> f64 {
    let bins = bins(mesh);
    let ends = |degrees: f64| -> f64 {
        let (sin, cos) = sin_cos(degrees);
        bins.iter().map(|&[x, y]| (x * cos + y * sin).abs() + (y * cos - x * sin).abs()).sum()
    };
    let sides = bins.iter().filter(|b| **b != [0.0; 2]).map(|&[x, y]| libm::atan2(y, x));
    let exact = sides.map(|angle| (angle.to_degrees() * STEPS).round() / STEPS % 90.0);
    let whole = (0..BINS).map(|degrees| degrees as f64);
    let best = whole
        .chain(exact)
        .map(|degrees| (ends(degrees), degrees))
        .min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    best.filter(|(least, _)| *least < GAIN * ends(USUAL)).map_or(USUAL, |(_, degrees)| degrees)
}

/// The area vectors of the faces, seen from above and turned into the first quarter, summed by
/// direction. The sums are integers, so the order of faces does not matter.
fn bins(mesh: &Mesh) -> Vec<[f64; 2]> {
    let directions: Vec<(f64, f64)> = (1..BINS).map(|degrees| sin_cos(degrees as f64)).collect();
    let none = || vec![[0_i128; 2]; BINS];
    let add = |mut bins: Vec<[i128; 2]>, triangle: &[u32; 3]| {
        let [a, b, c] = triangle.map(|k| mesh.vertices[k as usize].map(i64::from));
        let (p, q) = ([0, 1, 2].map(|k| b[k] - a[k]), [0, 1, 2].map(|k| c[k] - a[k]));
        let [x, y] = [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2]];
        let [x, y] = match (x, y) {
            (0, 0) => return bins,
            (1.., 0..) => [x, y],
            (..=0, 1..) => [y, -x],
            (..0, ..=0) => [-x, -y],
            _ => [-y, x],
        };
        let sum = &mut bins[degrees([x as f64, y as f64], &directions)];
        *sum = [sum[0] + i128::from(x), sum[1] + i128::from(y)];
        bins
    };
    let both = |mut bins: Vec<[i128; 2]>, others: Vec<[i128; 2]>| {
        for (sum, other) in bins.iter_mut().zip(others) {
            *sum = [sum[0] + other[0], sum[1] + other[1]];
        }
        bins
    };
    let bins = mesh.triangles.par_iter().fold(none, add).reduce(none, both);
    bins.into_iter().map(|sum| sum.map(|s| s as f64)).collect()
}

/// The angle from the x axis to `[x, y]` in the first quarter, rounded down to whole degrees.
/// `directions` holds sine and cosine of 1, 2, … degrees.
fn degrees([x, y]: [f64; 2], directions: &[(f64, f64)]) -> usize {
    let is_from = |k: usize| {
        let (sin, cos) = directions[k - 1];
        y * cos >= x * sin
    };
    // An estimate within 0.2°, corrected below: faster than an arc tangent, which is not exact either.
    let slope = x.min(y) / x.max(y);
    let about = slope * (45.0 + 15.64 * (1.0 - slope));
    let about = if y > x { 90.0 - about } else { about };
    let mut degrees = (about as usize).min(directions.len());
    while degrees < directions.len() && is_from(degrees + 1) {
        degrees += 1;
    }
    while degrees > 0 && !is_from(degrees) {
        degrees -= 1;
    }
    degrees
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::to_units;

    /// A box of 30 by 20 by 10 mm, turned by `degrees` about z.
    fn turned(degrees: f64) -> Mesh {
        let (sin, cos) = sin_cos(degrees);
        let corner = |k: usize| {
            let (x, y) = ([0.0, 30.0][k & 1], [0.0, 20.0][k >> 1 & 1]);
            [x * cos - y * sin, x * sin + y * cos, [0.0, 10.0][k >> 2]].map(to_units)
        };
        let faces =
            [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [3, 2, 6, 7], [1, 3, 7, 5], [2, 0, 4, 6]];
        let halves = faces.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
        Mesh { vertices: (0..8).map(corner).collect(), triangles: halves.collect() }
    }

    #[test]
    fn lines_run_along_the_sides_of_a_box() {
        for (turn, angle) in [(0.0, 0.0), (90.0, 0.0), (10.0, 10.0), (20.25, 20.25), (-15.0, 75.0)]
        {
            assert!((least_turns(&turned(turn)) - angle).abs() < 0.011, "{turn}");
        }
    }

    #[test]
    fn the_order_of_faces_makes_no_difference() {
        let mut mesh = turned(33.3);
        let angle = least_turns(&mesh);
        mesh.triangles.reverse();
        mesh.triangles.iter_mut().for_each(|t| t.rotate_left(1));
        assert!((least_turns(&mesh) - angle).abs() < 1e-12);
    }

    #[test]
    fn without_upright_sides_the_usual_angle_is_taken() {
        let mesh = Mesh { vertices: Vec::new(), triangles: Vec::new() };
        assert!((least_turns(&mesh) - USUAL).abs() < 1e-12);
    }
}
