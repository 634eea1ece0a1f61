//! Triangles -> Section: cuts a body at one height, in floating point and without any code of the slicer.

use super::solid::Solid;

/// The edges of a body at a height, solid on the left.
pub(crate) struct Section {
    edges: Vec<([f64; 2], [f64; 2])>,
    /// Indices of edges by bands of y.
    bands: Vec<Vec<usize>>,
    low: f64,
    band: f64,
}

impl Section {
    /// Cuts `solid` at height `z`.
    pub(crate) fn new(solid: &Solid, z: f64) -> Self {
        Self::from_edges(solid.triangles.iter().filter_map(|t| cut(t, z)).collect())
    }

    pub(crate) fn from_edges(edges: Vec<([f64; 2], [f64; 2])>) -> Self {
        let ys = || edges.iter().flat_map(|(a, b)| [a[1], b[1]]);
        let (low, high) = (ys().fold(f64::MAX, f64::min), ys().fold(f64::MIN, f64::max));
        let count = (edges.len() / 4).clamp(1, 400);
        let band = ((high - low) / count as f64).max(1e-9);
        let mut bands = vec![Vec::new(); count];
        for (k, (a, b)) in edges.iter().enumerate() {
            let index = |y: f64| (((y - low) / band) as usize).min(count - 1);
            for band in &mut bands[index(a[1].min(b[1]))..=index(a[1].max(b[1]))] {
                band.push(k);
            }
        }
        Self { edges, bands, low, band }
    }

    fn band(&self, y: f64) -> usize {
        (((y - self.low) / self.band).max(0.0) as usize).min(self.bands.len() - 1)
    }

    /// How often the body winds around `p`.
    pub(crate) fn winding(&self, p: [f64; 2]) -> i32 {
        let mut winding = 0;
        for &k in &self.bands[self.band(p[1])] {
            let (a, b) = self.edges[k];
            if (a[1] <= p[1]) != (b[1] <= p[1]) {
                let x = a[0] + (b[0] - a[0]) * (p[1] - a[1]) / (b[1] - a[1]);
                if x > p[0] {
                    winding += if b[1] > a[1] { 1 } else { -1 };
                }
            }
        }
        winding
    }

    pub(crate) fn is_inside(&self, p: [f64; 2]) -> bool {
        self.winding(p) != 0
    }

    /// Distance of `p` from the nearest edge, or `limit` if that is less.
    pub(crate) fn distance(&self, p: [f64; 2], limit: f64) -> f64 {
        let near = self.band(p[1] - limit)..=self.band(p[1] + limit);
        let edges = self.bands[near].iter().flatten().map(|&k| self.edges[k]);
        edges.map(|(a, b)| distance(p, a, b)).fold(limit, f64::min)
    }

    /// Distance from the body's edge, positive outside; between −limit and limit.
    /// Edges inside the union of several shells count as edges: see [`Self::reach`].
    pub(crate) fn signed_distance(&self, p: [f64; 2], limit: f64) -> f64 {
        let distance = self.distance(p, limit);
        if self.is_inside(p) { -distance } else { distance }
    }

    /// How far a disc of `radius` around `p` reaches out of the body, tried in 24 directions. Shells
    /// of the body may overlap.
    pub(crate) fn reach(&self, p: [f64; 2], radius: f64) -> f64 {
        if self.is_inside(p) && self.distance(p, radius) >= radius {
            return 0.0;
        }
        let mut worst = 0.0_f64;
        for k in 0..24 {
            let (sin, cos) = (std::f64::consts::TAU * f64::from(k) / 24.0).sin_cos();
            let q = [p[0] + radius * cos, p[1] + radius * sin];
            if !self.is_inside(q) {
                worst = worst.max(self.distance(q, 100.0 * radius));
            }
        }
        if worst == 0.0 && !self.is_inside(p) { self.distance(p, 100.0 * radius) } else { worst }
    }

    /// The signed area, mm²: overlaps of shells count twice.
    pub(crate) fn area(&self) -> f64 {
        self.edges.iter().map(|(a, b)| (a[0] * b[1] - a[1] * b[0]) / 2.0).sum()
    }

    /// The lowest and the highest corner of the box around it, nothing if it is empty.
    pub(crate) fn extent(&self) -> Option<([f64; 2], [f64; 2])> {
        let points = || self.edges.iter().flat_map(|(a, b)| [a, b]);
        points().next()?;
        let bound = |axis: usize, pick: fn(f64, f64) -> f64, from: f64| {
            points().map(|p| p[axis]).fold(from, pick)
        };
        Some((
            [bound(0, f64::min, f64::MAX), bound(1, f64::min, f64::MAX)],
            [bound(0, f64::max, f64::MIN), bound(1, f64::max, f64::MIN)],
        ))
    }
}

/// Distance of `p` from the stretch a–b.
pub(crate) fn distance(p: [f64; 2], a: [f64; 2], b: [f64; 2]) -> f64 {
    let (d, e) = ([b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]);
    let length2 = d[0] * d[0] + d[1] * d[1];
    let t =
        if length2 > 0.0 { ((d[0] * e[0] + d[1] * e[1]) / length2).clamp(0.0, 1.0) } else { 0.0 };
    (e[0] - t * d[0]).hypot(e[1] - t * d[1])
}

/// Where a triangle meets the height `z`: from where its border goes down through it to where it goes up.
fn cut(triangle: &[[f64; 3]; 3], z: f64) -> Option<([f64; 2], [f64; 2])> {
    let mut ends = [None; 2];
    for e in 0..3 {
        let (a, b) = (triangle[e], triangle[(e + 1) % 3]);
        if (a[2] >= z) != (b[2] >= z) {
            let up = usize::from(b[2] > a[2]);
            // The same point from both sides of an edge: a ray must not slip between two.
            let (low, high) = if up == 1 { (a, b) } else { (b, a) };
            let t = (z - low[2]) / (high[2] - low[2]);
            ends[up] = Some([low[0] + t * (high[0] - low[0]), low[1] + t * (high[1] - low[1])]);
        }
    }
    Some((ends[0]?, ends[1]?))
}
