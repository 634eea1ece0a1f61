//! Shapes -> STL bytes: closed solids made in code.

use std::f64::consts::TAU;

/// A point of space, mm.
pub(crate) type Point3 = [f64; 3];
/// A closed line of the plane, counter-clockwise around solid.
pub(crate) type Outline = Vec<[f64; 2]>;

/// Triangles that enclose a body, counter-clockwise seen from outside.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Solid {
    pub(crate) triangles: Vec<[Point3; 3]>,
}

impl Solid {
    /// Stacks outlines with equally many corners: sides between neighbours, lids at both ends.
    pub(crate) fn tower(rings: &[(Outline, f64)]) -> Self {
        let at = |k: usize, i: usize| {
            let (outline, z) = &rings[k];
            let [x, y] = outline[i % outline.len()];
            [x, y, *z]
        };
        let n = rings[0].0.len();
        let last = rings.len() - 1;
        let mut triangles = Vec::new();
        for i in 1..n - 1 {
            triangles.push([at(0, 0), at(0, i + 1), at(0, i)]);
            triangles.push([at(last, 0), at(last, i), at(last, i + 1)]);
        }
        for k in 0..last {
            for i in 0..n {
                triangles.push([at(k, i), at(k, i + 1), at(k + 1, i + 1)]);
                triangles.push([at(k, i), at(k + 1, i + 1), at(k + 1, i)]);
            }
        }
        Self { triangles }
    }

    /// The same outline from the bottom to the top.
    pub(crate) fn prism(outline: &Outline, low: f64, high: f64) -> Self {
        Self::tower(&[(outline.clone(), low), (outline.clone(), high)])
    }

    pub(crate) fn cuboid(low: Point3, high: Point3) -> Self {
        Self::prism(&rectangle([low[0], low[1]], [high[0], high[1]]), low[2], high[2])
    }

    pub(crate) fn cylinder(radius: f64, height: f64, corners: usize) -> Self {
        Self::prism(&circle(radius, corners), 0.0, height)
    }

    /// A cone that ends in a flat of a tenth of its radius.
    pub(crate) fn cone(radius: f64, height: f64, corners: usize) -> Self {
        Self::tower(&[(circle(radius, corners), 0.0), (circle(radius / 10.0, corners), height)])
    }

    /// A ball without its poles' last degrees.
    pub(crate) fn ball(radius: f64, corners: usize) -> Self {
        let rings = corners / 2;
        let ring = |k: usize| {
            let (sin, cos) = (TAU / 2.0 * (k as f64 + 0.5) / rings as f64).sin_cos();
            (circle(radius * sin, corners), -radius * cos)
        };
        Self::tower(&(0..rings).map(ring).collect::<Vec<_>>())
    }

    /// Both bodies as two shells of one model.
    pub(crate) fn and(mut self, other: &Self) -> Self {
        self.triangles.extend(&other.triangles);
        self
    }

    /// Every corner moved by `to`, which must not turn the body inside out.
    pub(crate) fn map(&self, to: impl Fn(Point3) -> Point3) -> Self {
        Self { triangles: self.triangles.iter().map(|t| t.map(&to)).collect() }
    }

    pub(crate) fn shifted(&self, by: Point3) -> Self {
        self.map(|p| [p[0] + by[0], p[1] + by[1], p[2] + by[2]])
    }

    /// Turned by 90° about z, counter-clockwise seen from above.
    pub(crate) fn quarter_turned(&self) -> Self {
        self.map(|[x, y, z]| [-y, x, z])
    }

    /// Lying on its back: what was up is now to the back (y), what was to the back is down.
    pub(crate) fn laid_down(&self) -> Self {
        self.map(|[x, y, z]| [x, -z, y])
    }

    pub(crate) fn mirrored_in_x(&self) -> Self {
        let mirrored = self.map(|[x, y, z]| [-x, y, z]);
        mirrored.inside_out()
    }

    /// A cavity of the same shape.
    pub(crate) fn inside_out(&self) -> Self {
        Self { triangles: self.triangles.iter().map(|&[a, b, c]| [a, c, b]).collect() }
    }

    /// Every coordinate on a grid of 1/256 mm, which `f32` holds exactly below 65 m.
    pub(crate) fn on_a_coarse_grid(&self) -> Self {
        self.map(|p| p.map(|x| (x * 256.0).round() / 256.0))
    }

    /// Signed volume, mm³.
    pub(crate) fn volume(&self) -> f64 {
        let six = |[a, b, c]: &[Point3; 3]| {
            a[0] * (b[1] * c[2] - b[2] * c[1])
                + a[1] * (b[2] * c[0] - b[0] * c[2])
                + a[2] * (b[0] * c[1] - b[1] * c[0])
        };
        self.triangles.iter().map(six).sum::<f64>() / 6.0
    }

    /// Lowest and highest coordinates.
    pub(crate) fn extent(&self) -> (Point3, Point3) {
        let bound = |pick: fn(f64, f64) -> f64, from: f64| {
            let points = self.triangles.as_flattened().iter();
            points.fold([from; 3], |b, p| [pick(b[0], p[0]), pick(b[1], p[1]), pick(b[2], p[2])])
        };
        (bound(f64::min, f64::MAX), bound(f64::max, f64::MIN))
    }

    /// As the slicer lays it: the box's middle at `middle`, its foot on the bed.
    pub(crate) fn on_bed(&self, middle: [f64; 2]) -> Self {
        let (low, high) = self.extent();
        let by = |axis: usize| middle[axis] - (low[axis] + high[axis]) / 2.0;
        self.shifted([by(0), by(1), -low[2]])
    }

    /// A binary STL.
    pub(crate) fn stl(&self) -> Vec<u8> {
        let mut bytes = vec![b' '; 80];
        bytes.extend(u32::try_from(self.triangles.len()).unwrap().to_le_bytes());
        for triangle in &self.triangles {
            bytes.extend([0; 12]);
            let numbers = triangle.as_flattened().iter();
            bytes.extend(numbers.flat_map(|&n| (n as f32 + 0.0).to_le_bytes()));
            bytes.extend([0; 2]);
        }
        bytes
    }

    /// The triangles of an STL, read by a crate of others.
    pub(crate) fn from_stl(bytes: &[u8]) -> Self {
        let mut from = std::io::Cursor::new(bytes);
        let reader = stl_io::create_stl_reader(&mut from).unwrap();
        let corner = |v: stl_io::Vertex| <[f32; 3]>::from(v).map(f64::from);
        Self { triangles: reader.map(|t| t.unwrap().vertices.map(corner)).collect() }
    }
}

pub(crate) fn rectangle(low: [f64; 2], high: [f64; 2]) -> Outline {
    vec![low, [high[0], low[1]], high, [low[0], high[1]]]
}

/// A polygon on a circle around the origin.
pub(crate) fn circle(radius: f64, corners: usize) -> Outline {
    star(&vec![radius; corners])
}

/// Corners at even angles around the origin, at the given distances from it.
pub(crate) fn star(radii: &[f64]) -> Outline {
    let corner = |(k, r): (usize, &f64)| {
        let (sin, cos) = (TAU * k as f64 / radii.len() as f64).sin_cos();
        [r * cos, r * sin]
    };
    radii.iter().enumerate().map(corner).collect()
}
