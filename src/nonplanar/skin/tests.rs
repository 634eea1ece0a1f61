//! Skins on surfaces of known formulas: planes, an arc, a wave, and the facets of a mesh.
//!
//! Words: the *room* is what lies between surface and base. A place is *odd* if a square millimetre of the
//! outline around it has over 1.3 or under 0.7 times the plastic that its room takes.
//!
//! 1. Coverage: each stretch of a path is a rectangle of plastic on a grid of 0.1 mm, and seen with round
//!    ends. Outlines of many shapes must be covered once, and nothing beside them.
//! 2. Plastic is the room, over a staircase too, and told where it is no height of a bead.
//! 3. Chords leave the surface by the tolerance at most, and have the lengths asked for.
//! 4. Order: from below; walls first; the same for any number of threads.

use super::*;
use crate::head::Head;
use crate::nonplanar::surface::Surface;
use crate::units::{to_mm, to_units};
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
        outline: 0,
        beyond: 0,
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

    /// Sums of all cells below and to the left.
    fn sums(&self, cells: impl Iterator<Item = f64>) -> Vec<f64> {
        let columns = self.size[0];
        let mut sums = vec![0.0; columns + 1];
        let mut row = 0.0;
        for (k, cell) in cells.enumerate() {
            if k % columns == 0 {
                row = 0.0;
                sums.push(0.0);
            }
            row += cell;
            sums.push(row + sums[sums.len() - columns - 1]);
        }
        sums
    }

    /// Shares of the area: covered, and of places around which a millimetre square of it has over 1.3 or
    /// under 0.7 times the plastic of a skin `height` thick; and covered cells beyond the area.
    fn judge(&self, height: f64) -> Judged {
        const HALF: usize = 5;
        let [columns, rows] = self.size;
        let room = |inside: &bool| f64::from(u8::from(*inside)) * height * CELL * CELL;
        let plastic = self.sums(self.plastic.iter().copied());
        let rooms = self.sums(self.inside.iter().map(room));
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
                let around = |sums: &[f64]| {
                    let at = |i: usize, j: usize| sums[j * (columns + 1) + i];
                    let ([a, b], [c, d]) = ([i - HALF, i + HALF], [j - HALF, j + HALF]);
                    at(b, d) - at(a, d) - at(b, c) + at(a, c)
                };
                let (here, fits) = (around(&plastic), around(&rooms));
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
    let square = rectangle([0.0, 0.0], [14.0, 14.13]);
    let ring = vec![circle([0.0, 0.0], 7.0), circle([1.0, 0.0], 3.0).into_iter().rev().collect()];
    let ell =
        contour(&[[0.0, 0.0], [14.0, 0.0], [14.0, 6.3], [6.9, 6.3], [6.9, 14.0], [0.0, 14.0]]);
    let tip = contour(&[[0.0, 0.0], [25.0, 0.0], [25.0, 9.0]]);
    let areas = [
        ("square", vec![square.clone()], 0.0),
        ("square across", vec![square.clone()], 90.0),
        ("askew", vec![square.clone()], 45.0),
        ("nearly along", vec![turned(&square, 3.0)], 0.0),
        ("slanted", vec![turned(&square, 17.0)], 0.0),
        ("circle", vec![circle([3.0, 4.0], 7.0)], 30.0),
        ("ring", ring, 0.0),
        ("ell", vec![ell], 0.0),
        ("tip", vec![tip.clone()], 0.0),
        ("tip across", vec![tip], 90.0),
    ];
    for (name, area, direction) in areas {
        let laid = lay(|x, _| slope(x), &area, direction, &params());
        let judged = Grid::new(&area, &laid).judge(0.2);
        let full = plastic(&laid) / (laid.area_mm2 * 0.2);
        let says = format!("{name}: {judged:?}, plastic {full}, {} paths", laid.paths.len());
        assert!(judged.covered > 0.98 && judged.odd < 0.015, "{says}");
        assert!(judged.beyond < 0.003 && (full - 1.0).abs() < 0.005, "{says}");
    }
}

/// What stands between two heights of a plane that rises along x: layers 0.2 mm high.
fn staircase(x: f64) -> f64 {
    0.2 * (slope(x) / 0.2 + 0.5).floor() - 0.2
}

#[test]
fn plastic_is_the_room_over_a_staircase_along_and_across_it() {
    let area = [rectangle([0.0, 0.0], [24.05, 12.0])];
    for direction in [0.0, 90.0, 45.0] {
        let surface = Formula(|x, _| slope(x));
        let skin = Skin { surface: &surface, area: &area, lowered: 0, layer_top: 0, direction };
        let laid = paths(&skin, &Under(|x, _| staircase(x)), &params());
        let cells = (0..2405).map(|k| (f64::from(k) + 0.5) / 100.0);
        let room: f64 = cells.map(|x| 0.01 * 12.0 * (slope(x) - staircase(x))).sum();
        let share = plastic(&laid) / room;
        assert!((share - 1.0).abs() < 0.005, "{direction}: {share}");
        assert_eq!(laid.outside, [], "{direction}");
        let heights = || segments(&laid).map(|[_, b]| b.height);
        let (low, high) = (heights().min().unwrap(), heights().max().unwrap());
        let (lows, highs) = (900..1_400, 2_601..3_101);
        assert!(lows.contains(&low) && highs.contains(&high), "{low} {high}");
        let lengths: Vec<f64> = segments(&laid).map(|[a, b]| a.at.distance(b.at)).collect();
        let longest = lengths.iter().copied().fold(0.0, f64::max);
        match direction {
            // The room is steady across the slope, and a saw-tooth along it.
            90.0 => assert!(longest > 110_000.0, "{longest}"),
            0.0 => assert!(longest < 4_200.0, "{longest}"),
            _ => {}
        }
    }
}

/// Checks that no chord leaves the surface by more than the tolerance (and rounding), and how long
/// chords are. Returns the longest one, mm.
fn follows<F: Fn(f64, f64) -> f64 + Sync>(z: F, area: &[Contour], direction: f64) -> f64 {
    let params = NonPlanarParams { shortest: 1_000, ..params() };
    let laid = lay(&z, area, direction, &params);
    let mut longest: f64 = 0.0;
    for [a, b] in segments(&laid) {
        let ([ax, ay], [bx, by]) = (mm(a.at), mm(b.at));
        let length = a.at.distance(b.at);
        longest = longest.max(length);
        assert!(length >= 999.0, "{length} of {a:?}");
        let mut most: f64 = 0.0;
        for k in 0..=8 {
            let t = f64::from(k) / 8.0;
            let chord = f64::from(a.z) + t * f64::from(b.z - a.z) + 10_000.0;
            let surface = UNITS_PER_MM * z(ax + t * (bx - ax), ay + t * (by - ay));
            most = most.max((chord - surface).abs());
        }
        assert!(most <= 52.0, "{most} between {a:?} and {b:?}");
        assert!(most <= 12.0 || length <= 20_600.0, "a bent chord {length} long");
    }
    let judged = Grid::new(area, &laid).judge(0.2);
    assert!(judged.covered > 0.985 && judged.odd < 0.01, "{judged:?}");
    longest
}

#[test]
fn chords_follow_a_plane_an_arc_and_a_wave() {
    let area = [rectangle([-8.0, -8.0], [8.0, 8.0])];
    let plane = |x: f64, _: f64| slope(x);
    // A ruling is one chord.
    assert!(follows(plane, &area, 0.0) > 155_000.0);
    assert!(follows(plane, &area, 90.0) > 155_000.0);
    assert!(follows(plane, &area, 45.0) > 200_000.0);
    let arc = |x: f64, _: f64| (105.0_f64 * 105.0 - x * x).sqrt() - 102.0;
    assert!(follows(arc, &area, 90.0) > 155_000.0);
    assert!(follows(arc, &area, 0.0) < 20_600.0);
    let wave = |x: f64, y: f64| 0.8 * ((0.3 * x).sin() + (0.3 * y).sin()) + 3.0;
    assert!(follows(wave, &area, 0.0) < 20_600.0);
    // Near a crossing of two rulings it hardly bends.
    assert!(follows(wave, &area, 30.0) < 100_000.0);
}

#[test]
fn lines_across_a_slope_are_laid_from_below() {
    let area = [rectangle([-8.0, -8.0], [8.0, 8.0])];
    for (z, direction) in [(1.0, 90.0), (-1.0, 90.0), (1.0, 45.0), (-1.0, -45.0)] {
        let laid = lay(|x, _| z * slope(x), &area, direction, &params());
        let [path] = laid.paths.as_slice() else { panic!("{} paths", laid.paths.len()) };
        let [first, last] = [&path.points[0], &path.points[path.points.len() - 1]];
        assert!(first.z + 10_000 < last.z, "{direction}: {first:?} {last:?}");
    }
    // A crest: both sides from below, each in one go.
    let laid = lay(|x, _| 5.0 - x * x / 200.0, &area, 90.0, &params());
    let ways: Vec<i32> =
        laid.paths.iter().map(|p| p.points.last().unwrap().z - p.points[0].z).collect();
    assert_eq!(ways.len(), 2, "{ways:?}");
    assert!(ways.iter().all(|way| *way > 2_000), "{ways:?}");
}

#[test]
fn rooms_that_are_no_height_of_a_bead_are_told() {
    let area = [rectangle([0.0, 0.0], [10.0, 10.0])];
    let surface = Formula(|x, _| 5.0 + slope(x));
    let skin = Skin { surface: &surface, area: &area, lowered: 0, layer_top: 0, direction: 90.0 };
    // The base is 0.2 mm below but for a hole and a hump.
    let base = Under(|x: f64, y: f64| {
        let [hole, hump] = [3.0, 7.0].map(|m| (x - m).hypot(y - m) < 1.0);
        5.0 + slope(x)
            - if hole {
                2.0
            } else if hump {
                0.02
            } else {
                0.2
            }
    });
    let laid = paths(&skin, &base, &params());
    let near = |m: f64, p: Point| (mm(p)[0] - m).hypot(mm(p)[1] - m) < 1.6;
    let (deep, high): (Vec<Outside>, Vec<Outside>) =
        laid.outside.iter().partition(|one| one.height > 2_000);
    assert!(deep.len() > 10 && high.len() > 5, "{} {}", deep.len(), high.len());
    assert!(deep.iter().all(|one| near(3.0, one.from) && near(3.0, one.to) && one.height > 3_500));
    assert!(high.iter().all(|one| near(7.0, one.from) && near(7.0, one.to) && one.height < 500));
}

#[test]
fn walls_run_along_the_edge_before_the_lines() {
    let area = [rectangle([0.0, 0.0], [12.0, 12.0])];
    let params = NonPlanarParams { wall: 2, ..params() };
    let laid = lay(|x, _| slope(x), &area, 0.0, &params);
    assert_eq!(laid.paths.len(), 3);
    for (k, wall) in laid.paths[..2].iter().enumerate() {
        assert_eq!(wall.start(), wall.end());
        let edge = |p: &PathPoint| {
            let [x, y] = mm(p.at);
            x.min(y).min(12.0 - x).min(12.0 - y)
        };
        let off = 0.2 + 0.4 * k as f64;
        assert!(wall.points.iter().all(|p| (edge(p) - off).abs() < 1e-3));
    }
    let judged = Grid::new(&area, &laid).judge(0.2);
    let full = plastic(&laid) / (laid.area_mm2 * 0.2);
    assert!(
        judged.covered > 0.98 && judged.odd < 0.01 && (full - 1.0).abs() < 0.005,
        "{judged:?} {full}"
    );
}

#[test]
fn other_heights_and_widths_and_a_skin_below_another() {
    let area = [rectangle([0.0, 0.0], [12.0, 12.0])];
    for (height, line_width, nozzle) in [(1_000, 4_000, 4_000), (3_000, 6_000, 6_000)] {
        let params = NonPlanarParams { height, line_width, nozzle, ..params() };
        let h = to_mm(height);
        let surface = Formula(|x, _| 5.0 + slope(x));
        let skin = Skin {
            surface: &surface,
            area: &area,
            lowered: height,
            layer_top: 40_000,
            direction: 0.0,
        };
        let laid = paths(&skin, &Under(|x, _| 5.0 + slope(x) - 2.0 * h), &params);
        let full = plastic(&laid) / (laid.area_mm2 * h);
        assert!((full - 1.0).abs() < 0.005, "{full}");
        for p in laid.paths.iter().flat_map(|p| &p.points) {
            let z = UNITS_PER_MM * (5.0 + slope(mm(p.at)[0]) - h - 4.0);
            assert!((z - f64::from(p.z)).abs() < 2.0 && p.height == height, "{p:?}");
        }
    }
}

#[test]
fn the_number_of_threads_changes_nothing() {
    let area = [circle([0.0, 0.0], 5.0), circle([20.0, 0.0], 4.0)];
    let with = |count: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(count).build().unwrap();
        pool.install(|| lay(|x, y| slope(x) + (y / 4.0).sin(), &area, 20.0, &params()))
    };
    assert_eq!(with(1), with(3));
}

#[test]
fn the_facets_of_a_mesh_are_followed_exactly() {
    let z = |x: i32, y: i32| {
        let [x, y] = [x, y].map(|v| 0.3 * f64::from(v));
        [x / 0.3, y / 0.3, 3.0 + 0.8 * (x.sin() + y.sin())].map(to_units)
    };
    let facets = (-8..8).flat_map(|i| (-8..8).map(move |j| (i, j))).flat_map(|(i, j)| {
        let [a, b, c, d] = [z(i, j), z(i + 1, j), z(i + 1, j + 1), z(i, j + 1)];
        [[a, b, c], [a, c, d]]
    });
    let facets: Vec<_> = facets.collect();
    let open = vec![[true; 3]; facets.len()];
    let surface = Surface::new(facets, open);
    let area = surface.outline();
    let params = NonPlanarParams { shortest: 1_000, ..params() };
    for direction in [0.0, 30.0] {
        let skin = Skin { surface: &surface, area, lowered: 0, layer_top: 0, direction };
        let base = Under(|x, y| surface.z(at(x, y)).map_or(0.0, |z| z / UNITS_PER_MM - 0.2));
        let laid = paths(&skin, &base, &params);
        assert_eq!(laid.outside, []);
        let full = plastic(&laid) / (laid.area_mm2 * 0.2);
        assert!((full - 1.0).abs() < 0.005, "{full}");
        for [a, b] in segments(&laid) {
            for (t, z) in surface.profile(a.at, b.at) {
                let chord = f64::from(a.z) + t * f64::from(b.z - a.z);
                assert!((z - chord).abs() < 52.0, "{a:?} {b:?}");
            }
        }
    }
}

fn at(x: f64, y: f64) -> Point {
    Point { x: to_units(x), y: to_units(y) }
}
