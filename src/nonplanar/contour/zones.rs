//! Layer above -> Zones: where lines of a tread may not rise, and where they may not fall.
//!
//! - *Covered*: inside the contours of the layer above. No line of the tread lies there; a surface that goes
//!   on below is hidden in another body.
//! - *Close*: within a quarter of a line of these contours. A line there lies under a line of the layer above,
//!   and does not rise into its room.
//! - *Kept*: near an edge of these contours that stands upright beside the surface. There the nozzle stays at
//!   the layer's top: its flat would scrape the wall, which stands at full height.
//!
//! On a slope the contour of the layer above runs where the surface is as high as that layer's middle. An edge
//! stands upright where the surface beside it lies lower than the steepest slope would.

use super::super::grid::{self, CELL, Spot};
use super::{Tread, between};
use crate::geom::spans::Rows;
use crate::geom::{Contour, Point, edges};
use crate::region::scan::{Scan, around};
use crate::units::{Coord, nearest};

/// How far beside an edge the surface is looked at, grid units: beyond what contours are simplified by,
/// and a bit further out.
const BESIDE: [f64; 2] = [500.0, 3_000.0];

/// An edge is looked at so often, grid units: every mm.
const STRETCH: f64 = 10_000.0;

/// The share of a layer's height by which the surface beside an edge may be lower than it should.
const LOWER: f64 = 0.25;

/// Zones around the layer above.
pub(super) struct Zones {
    covered: Rows,
    close: Rows,
    kept: Rows,
}

impl Zones {
    /// The zones of a tread below the contours of the layer above.
    pub(super) fn new(tread: &Tread<'_>, above: &[Contour]) -> Self {
        let raster = grid::raster(CELL);
        let limits = &tread.all.limits;
        let close = limits.line_width / 4;
        let all = || above.iter().flat_map(|contour| edges(contour));
        let near: Vec<(Point, Point, Coord)> =
            all().filter(|&(a, b)| is_near(tread, a, b)).map(|(a, b)| (a, b, close)).collect();
        let mut upright = Vec::new();
        for &(a, b, _) in &near {
            let count = (a.distance(b) / STRETCH).ceil().max(1.0);
            for k in 0..count as usize {
                let ends = [k, k + 1].map(|k| between(a, b, k as f64 / count));
                if is_upright(tread, ends) {
                    upright.push((ends[0], ends[1], limits.keep));
                }
            }
        }
        Self {
            covered: Scan::new(above, raster).inside().clone(),
            close: around(&near, raster),
            kept: around(&upright, raster),
        }
    }

    /// Whether a line may rise at a place of this height above the layer's top, or fall.
    pub(super) fn lets(&self, cell: Spot, rises: bool) -> bool {
        !holds(&self.covered, cell) && !holds(if rises { &self.close } else { &self.kept }, cell)
    }
}

/// Whether an edge lies near a slope.
fn is_near(tread: &Tread<'_>, a: Point, b: Point) -> bool {
    let keep = tread.all.limits.keep;
    tread.grounds.iter().any(|ground| {
        let (low, high) = ground.extent;
        a.x.min(b.x) <= high.x + keep
            && a.x.max(b.x) >= low.x - keep
            && a.y.min(b.y) <= high.y + keep
            && a.y.max(b.y) >= low.y - keep
    })
}

/// Whether a stretch of a contour stands upright beside the surface. Solid lies to its left.
fn is_upright(tread: &Tread<'_>, [a, b]: [Point; 2]) -> bool {
    let length = a.distance(b);
    if length == 0.0 {
        return false;
    }
    let [dx, dy] = [f64::from(b.x - a.x) / length, f64::from(b.y - a.y) / length];
    let middle = between(a, b, 0.5);
    let height = f64::from(tread.layer.height);
    let plane = f64::from(tread.layer.z) + height / 2.0;
    BESIDE.into_iter().any(|out| {
        let by = |v: Coord, d: f64| v + nearest(d * out) as Coord;
        let at = Point { x: by(middle.x, dy), y: by(middle.y, -dx) };
        let least = plane - LOWER * height - out * tread.all.limits.steepest;
        tread.surface(at).is_some_and(|z| z < least)
    })
}

/// Whether a cell is one of these rows of cells.
pub(super) fn holds(rows: &Rows, [x, y]: Spot) -> bool {
    let (row, x) = (rows.row(y), x * CELL);
    let after = row.partition_point(|span| span.start <= x);
    after > 0 && x < row[after - 1].end
}
