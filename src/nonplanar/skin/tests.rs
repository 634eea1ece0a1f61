//! Skins on surfaces of known formulas: planes, an arc, a wave.

use super::*;
use crate::head::Head;
use crate::units::to_units;
use std::fmt;

/// A surface z(x, y), mm.
struct Formula<F>(F);

impl<F> fmt::Debug for Formula<F> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Formula")
    }
}

fn mm(p: Point) -> [f64; 2] {
    [f64::from(p.x) / UNITS_PER_MM, f64::from(p.y) / UNITS_PER_MM]
}

impl<F: Fn(f64, f64) -> f64 + Sync> Relief for Formula<F> {
    fn z(&self, at: Point) -> Option<f64> {
        let [x, y] = mm(at);
        Some(UNITS_PER_MM * self.0(x, y))
    }

    fn slope(&self, at: Point) -> Option<[f64; 2]> {
        const D: f64 = 1e-4;
        let ([x, y], z) = (mm(at), &self.0);
        Some([(z(x + D, y) - z(x - D, y)) / (2.0 * D), (z(x, y + D) - z(x, y - D)) / (2.0 * D)])
    }

    fn profile(&self, a: Point, b: Point) -> Vec<(f64, f64)> {
        let ([ax, ay], [bx, by]) = (mm(a), mm(b));
        let count = (a.distance(b) / 500.0).ceil().max(1.0);
        let at = |k: usize| {
            let t = k as f64 / count;
            (t, UNITS_PER_MM * self.0(ax + t * (bx - ax), ay + t * (by - ay)))
        };
        (0..=count as usize).map(at).collect()
    }
}

/// A base of this height, mm.
struct Under<F>(F);

impl<F: Fn(f64, f64) -> f64 + Sync> Base for Under<F> {
    fn height(&self, at: Point) -> f64 {
        let [x, y] = mm(at);
        UNITS_PER_MM * self.0(x, y)
    }
}

fn params() -> NonPlanarParams {
    NonPlanarParams {
        skins: 1,
        height: 2_000,
        line_width: 4_000,
        nozzle: 4_000,
        slopes: 0.5..=45.0,
        max_bend: 30.0,
        min_area: 20.0,
        directions: None,
        wall: 0,
        tolerance: 50,
        segment: 20_000,
        shortest: 4_000,
        clearance: 5_000,
        head: Head { flat: 1.0, cone: 45.0, cone_length: 3.0, discs: vec![], boxes: vec![] },
    }
}

fn contour(points: &[[f64; 2]]) -> Contour {
    points.iter().map(|&[x, y]| Point { x: to_units(x), y: to_units(y) }).collect()
}

fn rectangle([x0, y0]: [f64; 2], [x1, y1]: [f64; 2]) -> Contour {
    contour(&[[x0, y0], [x1, y0], [x1, y1], [x0, y1]])
}

fn turned(c: &Contour, degrees: f64) -> Contour {
    let (sin, cos) = degrees.to_radians().sin_cos();
    let turn = |[x, y]: [f64; 2]| [x * cos - y * sin, x * sin + y * cos];
    contour(&c.iter().map(|&p| turn(mm(p))).collect::<Vec<_>>())
}

fn circle([x, y]: [f64; 2], r: f64) -> Contour {
    let at = |k: i32| f64::from(k).to_radians() * 5.0;
    contour(&(0..72).map(|k| [x + r * at(k).cos(), y + r * at(k).sin()]).collect::<Vec<_>>())
}

/// Lays a skin a layer high at `direction` on the surface.
fn lay<F: Fn(f64, f64) -> f64 + Sync>(
    z: F,
    area: &[Contour],
    direction: f64,
    params: &NonPlanarParams,
) -> Laid {
    let h = to_mm(params.height);
    let surface = Formula(&z);
    let skin = Skin { surface: &surface, area, lowered: 0, layer_top: 10_000, direction };
    paths(&skin, &Under(|x, y| z(x, y) - h), params)
}

use crate::units::to_mm;

/// Plastic of the paths, mm³.
fn plastic(laid: &Laid) -> f64 {
    segments(laid).map(|[a, b]| volume(a, b)).sum()
}

fn volume(a: PathPoint, b: PathPoint) -> f64 {
    to_mm(b.width) * to_mm(b.height) * a.at.distance(b.at) / UNITS_PER_MM
}

fn segments(laid: &Laid) -> impl Iterator<Item = [PathPoint; 2]> + '_ {
    laid.paths.iter().flat_map(|path| path.points.windows(2).map(|w| [w[0], w[1]]))
}

fn is_in(area: &[Contour], p: Point) -> bool {
    crate::geom::encloses(area.iter().flat_map(|c| crate::geom::edges(c)), p)
}

/// A grid over an area.
struct Grid {
    low: [f64; 2],
    size: [usize; 2],
    inside: Vec<bool>,
    /// Plastic per cell, mm³.
    plastic: Vec<f64>,
    covered: Vec<bool>,
}

const CELL: f64 = 0.1;

impl Grid {
    fn new(area: &[Contour], laid: &Laid) -> Self {
        let all = || area.iter().flatten().map(|&p| mm(p));
        let low = [0, 1].map(|i| all().map(|p| p[i]).fold(f64::INFINITY, f64::min) - 1.0);
        let high = [0, 1].map(|i| all().map(|p| p[i]).fold(f64::NEG_INFINITY, f64::max) + 1.0);
        let size = [0, 1].map(|i| ((high[i] - low[i]) / CELL).ceil() as usize);
        let count = size[0] * size[1];
        let (plastic, covered) = (vec![0.0; count], vec![false; count]);
        let mut grid = Self { low, size, inside: vec![false; count], plastic, covered };
        // Rows of the area by its crossings: quicker than cell by cell.
        for row in 0..size[1] {
            let y = to_units(grid.middle([0, row])[1]);
            let mut xs: Vec<i32> = Vec::new();
            for (p, q) in area.iter().flat_map(|c| crate::geom::edges(c)) {
                let (l, h) = if p.y < q.y { (p, q) } else { (q, p) };
                if l.y < y && y <= h.y {
                    xs.push(crate::units::between(l.x, h.x, (y, l.y, h.y)));
                }
            }
            xs.sort_unstable();
            for column in 0..size[0] {
                let x = to_units(grid.middle([column, row])[0]);
                grid.inside[row * size[0] + column] =
                    xs.iter().filter(|c| **c < x).count() % 2 == 1;
            }
        }
        segments(laid).for_each(|[a, b]| grid.add(a, b));
        grid
    }

    fn middle(&self, [i, j]: [usize; 2]) -> [f64; 2] {
        [self.low[0] + (i as f64 + 0.5) * CELL, self.low[1] + (j as f64 + 0.5) * CELL]
    }

    /// Adds a bead: a rectangle of plastic, seen with round ends.
    fn add(&mut self, a: PathPoint, b: PathPoint) {
        let ([ax, ay], [bx, by]) = (mm(a.at), mm(b.at));
        let (half, length) = (to_mm(b.width) / 2.0, (bx - ax).hypot(by - ay));
        let way = [(bx - ax) / length, (by - ay) / length];
        let range = |lo: f64, hi: f64, i: usize| {
            let at = |v: f64| ((v - self.low[i]) / CELL).max(0.0) as usize;
            at(lo - half)..(at(hi + half) + 1).min(self.size[i])
        };
        let (columns, rows) = (range(ax.min(bx), ax.max(bx), 0), range(ay.min(by), ay.max(by), 1));
        let mut within = Vec::new();
        for j in rows {
            for i in columns.clone() {
                let [x, y] = self.middle([i, j]);
                let along = (x - ax) * way[0] + (y - ay) * way[1];
                let off = ((y - ay) * way[0] - (x - ax) * way[1]).abs();
                let beyond = (-along).max(along - length).max(0.0);
                let cell = j * self.size[0] + i;
                self.covered[cell] |= off.hypot(beyond) <= half;
                if off <= half && beyond == 0.0 {
                    within.push(cell);
                }
            }
        }
        let each = volume(a, b) / within.len().max(1) as f64;
        within.into_iter().for_each(|cell| self.plastic[cell] += each);
    }

    /// Shares of the area: covered, and of places around which a millimetre square of it has over 1.3 or
    /// under 0.7 times the plastic of a skin `height` thick; and covered cells beyond the area.
    fn judge(&self, height: f64) -> Judged {
        const HALF: usize = 5;
        let [columns, rows] = self.size;
        let room = height * CELL * CELL;
        let (mut all, mut covered, mut odd, mut beyond) = (0.0, 0.0, 0.0, 0.0);
        for j in HALF..rows - HALF {
            for i in HALF..columns - HALF {
                let cell = j * columns + i;
                if !self.inside[cell] {
                    beyond += f64::from(u8::from(self.covered[cell]));
                    continue;
                }
                all += 1.0;
                covered += f64::from(u8::from(self.covered[cell]));
                let (mut here, mut fits) = (0.0, 0.0);
                for row in j - HALF..j + HALF {
                    let cells = row * columns + i - HALF..row * columns + i + HALF;
                    here += self.plastic[cells.clone()].iter().sum::<f64>();
                    fits += self.inside[cells].iter().filter(|c| **c).count() as f64 * room;
                }
                odd += f64::from(u8::from(here > 1.3 * fits || here < 0.7 * fits));
            }
        }
        Judged { covered: covered / all, odd: odd / all, beyond: beyond / all }
    }
}

#[derive(Debug)]
struct Judged {
    covered: f64,
    odd: f64,
    beyond: f64,
}

fn slope(x: f64) -> f64 {
    x * 4.76_f64.to_radians().tan()
}

#[test]
fn a_skin_covers_its_outline_once_whatever_its_shape() {
    let square = rectangle([0.0, 0.0], [20.0, 20.13]);
    let ring = vec![circle([0.0, 0.0], 9.0), circle([1.0, 0.0], 3.0).into_iter().rev().collect()];
    let ell = contour(&[[0.0, 0.0], [20.0, 0.0], [20.0, 8.3], [8.9, 8.3], [8.9, 20.0], [0.0, 20.0]]);
    let areas = [
        ("square", vec![square.clone()], 0.0),
        ("square across", vec![square.clone()], 90.0),
        ("askew", vec![square.clone()], 45.0),
        ("nearly along", vec![turned(&square, 3.0)], 0.0),
        ("slanted", vec![turned(&square, 17.0)], 0.0),
        ("circle", vec![circle([3.0, 4.0], 10.0)], 30.0),
        ("ring", ring, 0.0),
        ("ell", vec![ell], 0.0),
    ];
    for (name, area, direction) in areas {
        let laid = lay(|x, _| slope(x), &area, direction, &params());
        let judged = Grid::new(&area, &laid).judge(0.2);
        let full = plastic(&laid) / (laid.area_mm2 * 0.2);
        println!("{name}: {judged:?} {full} {}", laid.paths.len());
    }
}
