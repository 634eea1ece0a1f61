//! Code -> STL fixtures: makes the small models of `fixtures/`, all dedicated to the public domain (CC0).
//!
//! `UPDATE_FIXTURES=1 cargo test --test prints fixtures` rewrites them, and fails, so
//! that nobody leaves the variable set.

use slicer::mesh::{Bed, Placement, place, read};
use std::collections::BTreeMap;
use std::path::PathBuf;

type Point = [f64; 3];
type Triangles = Vec<[Point; 3]>;

#[test]
fn fixtures_are_what_the_generator_makes() {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("fixtures");
    let update = std::env::var_os("UPDATE_FIXTURES").is_some();
    for (name, bytes) in fixtures() {
        let path = folder.join(name);
        if update {
            std::fs::write(&path, &bytes).unwrap();
        }
        let kept = std::fs::read(&path).unwrap_or_default();
        assert!(kept == bytes, "fixtures/{name} differs; run with UPDATE_FIXTURES=1");
    }
    assert!(!update, "the fixtures are rewritten; unset UPDATE_FIXTURES");
}

#[test]
fn fixtures_are_closed_and_have_their_volume() {
    let bed = Bed { min: [0.0; 2], max: [220.0; 2], height: 250.0 };
    let placement = Placement::default();
    for (name, bytes) in fixtures() {
        assert!(bytes.len() < 500_000, "{name} is too large for a fixture");
        let mesh = read::from_bytes(name, &bytes, read::DEFAULT_MAX_TRIANGLES).unwrap();
        let placed = place::place(vec![mesh], &placement, &bed).unwrap();
        assert_eq!(placed.warnings, [], "{name}");
        let report = &placed.reports[0];
        assert_eq!((&report.found[..], &report.left[..]), (&[][..], &[][..]), "{name}");
        let (volume, size) = match name {
            "cube_20.stl" | "cube_ascii.stl" => (8000.0, [20.0, 20.0, 20.0]),
            "sphere_20.stl" => (4110.0, [20.0, 20.0, 20.0]),
            "overhang.stl" => (16.0 * (8.0 * 20.0 + 30.0 * 5.0), [30.0, 16.0, 25.0]),
            "two_shells.stl" => (10_000.0, [25.0, 25.0, 20.0]),
            "cavity.stl" => (8000.0 - 512.0, [20.0, 20.0, 20.0]),
            "tile.stl" => (57.6, [6.0, 6.0, 1.6]),
            "wedge.stl" => (624.0, [24.0, 10.0, 3.6]),
            "bracket.stl" => (16_796.0, [90.0, 30.0, 24.0]),
            _ => panic!("no expectation for {name}"),
        };
        let off = report.volume_mm3 / volume - 1.0;
        assert!(off.abs() < 0.01, "{name}: {} mm³", report.volume_mm3);
        for (is, should) in report.size_mm.iter().zip(size) {
            // A polygon around a circle falls short of it at some sides.
            assert!((is - should).abs() < 0.11, "{name}: {:?}", report.size_mm);
        }
    }
}

fn fixtures() -> Vec<(&'static str, Vec<u8>)> {
    let cube = cuboid([0.0; 3], [20.0; 3]);
    let mut shells = cube.clone();
    shells.extend(cuboid([10.0, 10.0, 5.0], [25.0, 25.0, 5.0 + 80.0 / 9.0]));
    let mut hollow = cube.clone();
    let inner = cuboid([6.0; 3], [14.0; 3]);
    hollow.extend(inner.into_iter().map(|[a, b, c]| [a, c, b]));
    vec![
        ("cube_20.stl", binary(&cube)),
        ("cube_ascii.stl", ascii("cube", &cube)),
        ("bracket.stl", binary(&bracket())),
        ("sphere_20.stl", binary(&sphere(10.0))),
        ("overhang.stl", binary(&overhang())),
        ("two_shells.stl", binary(&shells)),
        ("cavity.stl", binary(&hollow)),
        ("tile.stl", binary(&cuboid([0.0; 3], [6.0, 6.0, 1.6]))),
        ("wedge.stl", binary(&wedge())),
    ]
}

/// Triangles of the plane, and between which of some surfaces each is solid.
/// Walls are cut at every surface, so that neighbours always share whole edges.
struct Columns {
    /// Corners of the cells, counter-clockwise.
    cells: Vec<[[f64; 2]; 3]>,
    /// For each cell and each gap between two surfaces whether it is solid.
    solid: Vec<Vec<bool>>,
}

impl Columns {
    /// The boundary of the solid; `surface` gives the height of surface `k` at a point.
    fn skin(&self, surface: impl Fn(usize, [f64; 2]) -> f64) -> Triangles {
        // Adding zero makes -0 and 0 one.
        let bits = |[x, y]: [f64; 2]| ((x + 0.0).to_bits(), (y + 0.0).to_bits());
        let at = |k: usize, p: [f64; 2]| [p[0], p[1], surface(k, p)];
        let mut sides = BTreeMap::new();
        for (i, cell) in self.cells.iter().enumerate() {
            for e in 0..3 {
                sides.insert((bits(cell[e]), bits(cell[(e + 1) % 3])), i);
            }
        }
        let mut out = Triangles::new();
        for (&[a, b, c], solid) in self.cells.iter().zip(&self.solid) {
            let filled = |k: usize| solid.get(k).copied().unwrap_or(false);
            for k in 0..=solid.len() {
                match (k > 0 && filled(k - 1), filled(k)) {
                    (true, false) => out.push([a, b, c].map(|p| at(k, p))),
                    (false, true) => out.push([a, c, b].map(|p| at(k, p))),
                    _ => {}
                }
            }
            for (p, q) in [(a, b), (b, c), (c, a)] {
                let other = sides.get(&(bits(q), bits(p))).map(|&i| &self.solid[i]);
                for k in (0..solid.len()).filter(|&k| filled(k)) {
                    if !other.is_some_and(|other| other[k]) {
                        out.push([at(k, p), at(k, q), at(k + 1, q)]);
                        out.push([at(k, p), at(k + 1, q), at(k + 1, p)]);
                    }
                }
            }
        }
        out
    }
}

/// Two triangles for each box of a grid.
fn grid(xs: &[f64], ys: &[f64]) -> Vec<[[f64; 2]; 3]> {
    let mut cells = Vec::new();
    for x in xs.windows(2) {
        for y in ys.windows(2) {
            cells.push([[x[0], y[0]], [x[1], y[0]], [x[1], y[1]]]);
            cells.push([[x[0], y[0]], [x[1], y[1]], [x[0], y[1]]]);
        }
    }
    cells
}

fn cuboid(low: Point, high: Point) -> Triangles {
    let cells = grid(&[low[0], high[0]], &[low[1], high[1]]);
    let columns = Columns { solid: vec![vec![true]; cells.len()], cells };
    columns.skin(|k, _| [low[2], high[2]][k])
}

/// A ramp that rises by 1 in 12, 4.8°.
fn wedge() -> Triangles {
    let cells = grid(&[0.0, 24.0], &[0.0, 10.0]);
    let columns = Columns { solid: vec![vec![true]; cells.len()], cells };
    columns.skin(|k, [x, _]| [0.0, 1.6 + x / 12.0][k])
}

/// A T: arms of 11 mm stand out at both sides.
fn overhang() -> Triangles {
    let cells = grid(&[-15.0, -4.0, 4.0, 15.0], &[-8.0, 8.0]);
    let middle = |cell: &[[f64; 2]; 3]| cell.iter().all(|p| p[0].abs() < 5.0);
    let solid = cells.iter().map(|cell| vec![middle(cell), true]).collect();
    Columns { cells, solid }.skin(|k, _| [0.0, 20.0, 25.0][k])
}

fn sphere(radius: f64) -> Triangles {
    const AROUND: usize = 30;
    const UP: usize = 26;
    let point = |i: usize, j: usize| {
        let (sin, cos) = circle(i as f64 / UP as f64 / 2.0);
        let (y, x) = circle((j % AROUND) as f64 / AROUND as f64);
        // The poles are one point each, whatever sin(π) is.
        let ring = if i == 0 || i == UP { 0.0 } else { radius * sin };
        [ring * x, ring * y, -radius * cos]
    };
    let mut out = Triangles::new();
    for i in 0..UP {
        for j in 0..AROUND {
            let [a, b, c, d] = [point(i, j), point(i, j + 1), point(i + 1, j + 1), point(i + 1, j)];
            if i > 0 {
                out.push([a, b, c]);
            }
            if i + 1 < UP {
                out.push([a, c, d]);
            }
        }
    }
    out
}

/// Sine and cosine of a part of a full turn.
fn circle(part: f64) -> (f64, f64) {
    libm::sincos(part * std::f64::consts::TAU)
}

/// Steps around a hole of the bracket, a multiple of 8.
const STEPS: usize = 64;
/// Half of the bracket's width, mm.
const HALF: f64 = 15.0;

/// A point of the square around the origin, `step` of [`STEPS`] steps around, even along its sides.
fn on_square(step: usize) -> [f64; 2] {
    let eighth = STEPS / 8;
    let along = |step: usize| HALF * (step as f64 / eighth as f64 - 1.0);
    let from = (step + eighth) % STEPS;
    let (side, t) = (from / (2 * eighth), along(from % (2 * eighth)));
    [[HALF, t], [-t, HALF], [-HALF, -t], [t, -HALF]][side]
}

fn on_circle(step: usize, radius: f64) -> [f64; 2] {
    let (sin, cos) = circle((step % STEPS) as f64 / STEPS as f64);
    [radius * cos, radius * sin]
}

/// Cells between closed lines around `centre`, from the inside outwards.
fn rings(centre: f64, lines: &[Vec<[f64; 2]>]) -> Vec<[[f64; 2]; 3]> {
    let mut cells = Vec::new();
    for pair in lines.windows(2) {
        for j in 0..STEPS {
            let next = (j + 1) % STEPS;
            let corners = [pair[0][j], pair[1][j], pair[1][next], pair[0][next]];
            let [a, b, c, d] = corners.map(|[x, y]| [centre + x, y]);
            cells.push([a, b, c]);
            if a != d {
                cells.push([a, c, d]);
            }
        }
    }
    cells
}

/// A plate with rounded ends, two counterbored holes, and in its middle a
/// domed cap on a stem, which overhangs all around, above a blind pocket.
fn bracket() -> Triangles {
    const LEVELS: [f64; 6] = [0.0, 2.0, 3.0, 6.0, 14.0, 18.0];
    let line = |radius: f64| (0..STEPS).map(|j| on_circle(j, radius)).collect::<Vec<_>>();
    let square: Vec<_> = (0..STEPS).map(on_square).collect();
    // The rounded end: a half circle on the side away from the middle.
    let end = |side: f64| -> Vec<[f64; 2]> {
        let away = |p: [f64; 2], j: usize| if p[0] * side > 0.0 { on_circle(j, HALF) } else { p };
        (0..STEPS).map(|j| away(on_square(j), j)).collect()
    };
    let (mut cells, mut solid) = (Vec::new(), Vec::new());
    for side in [-1.0, 1.0] {
        let lines = [line(4.0), line(7.5), end(side)];
        for (i, cell) in rings(side * 2.0 * HALF, &lines).into_iter().enumerate() {
            let bored = i < 2 * STEPS;
            cells.push(cell);
            solid.push(vec![true, true, !bored, false, false]);
        }
    }
    let radii = [0.0, 2.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 9.6, 10.0];
    let mut lines: Vec<_> = radii.iter().map(|&radius| line(radius)).collect();
    lines.push(square);
    for cell in rings(0.0, &lines) {
        let radius = cell.iter().map(|p| libm::sqrt(p[0] * p[0] + p[1] * p[1])).fold(0.0, f64::max);
        let within = |limit: f64| radius < limit + 0.1;
        cells.push(cell);
        solid.push(vec![!within(4.0), true, true, within(6.0), within(10.0)]);
    }
    Columns { cells, solid }.skin(|k, [x, y]| if k == 5 { dome(x, y) } else { LEVELS[k] })
}

/// A spherical cap of radius 10 and height 6 above z = 18.
fn dome(x: f64, y: f64) -> f64 {
    let sphere = (100.0 + 36.0) / 12.0;
    18.0 - (sphere - 6.0) + libm::sqrt(sphere * sphere - x * x - y * y)
}

#[expect(clippy::cast_possible_truncation, reason = "STL holds f32")]
fn corners(triangle: &[Point; 3]) -> [[f32; 3]; 3] {
    triangle.map(|point| point.map(|number| number as f32 + 0.0))
}

fn binary(triangles: &Triangles) -> Vec<u8> {
    let mut bytes = b"CC0, made by tests/fixtures.rs".to_vec();
    bytes.resize(80, b' ');
    bytes.extend(u32::try_from(triangles.len()).expect("a fixture is small").to_le_bytes());
    for triangle in triangles {
        bytes.extend([0; 12]);
        bytes.extend(corners(triangle).as_flattened().iter().flat_map(|n| n.to_le_bytes()));
        bytes.extend([0; 2]);
    }
    bytes
}

fn ascii(name: &str, triangles: &Triangles) -> Vec<u8> {
    let mut text = format!("solid {name}\n");
    for triangle in triangles {
        text += "  facet normal 0 0 0\n    outer loop\n";
        for [x, y, z] in corners(triangle) {
            text += &format!("      vertex {x} {y} {z}\n");
        }
        text += "    endloop\n  endfacet\n";
    }
    text += &format!("endsolid {name}\n");
    text.into_bytes()
}
