//! Outline of a skin -> Pieces: each with lines of its own phase and distance.
//!
//! Words: *u* runs along the lines, *v* across them. A *row* is where a line runs, at `v = j · pitch`. A
//! *band* is what lies nearer to a row than to the next ones.
//!
//! The first and the last row of a piece lie half a line within its lowest and its highest place, and the
//! rows between are spread evenly. So the bands fill a rectangle exactly, whatever its width. This
//! stretches the distance of the lines by half a line in the whole width at most.
//!
//! The way to the edge is found among the edges near a row only: those are kept by rows.

use crate::geom::frame::Frame;
use crate::geom::nest::{Nest, extent};
use crate::geom::raster::Raster;
use crate::geom::segment::distance2;
use crate::geom::{Contour, Point, edges, side};
use crate::region::scan::Scan;
use crate::units::{Coord, nearest};

/// Lines of a piece come closer to each other, or part, by this share at most. Narrower pieces have
/// lines of the plain width in their middle.
const MOST_STRETCH: f64 = 0.125;

/// An outer contour of a skin with its holes, in the frame of its lines.
#[derive(Debug)]
pub(super) struct Piece {
    frame: Frame,
    /// What is added to `v`, so that a row lies at zero.
    shift: Coord,
    /// Distance of the rows, grid units.
    pub(super) pitch: Coord,
    /// Lines of this distance along u, at zero and at multiples of the pitch.
    pub(super) scan: Scan,
    first: i32,
    /// The edges within two rows of each row.
    near: Vec<Vec<(Point, Point)>>,
}

/// The pieces of `area`, with lines of about this width at `degrees`.
pub(super) fn pieces(area: &[Contour], degrees: f64, width: Coord) -> Vec<Piece> {
    let nest = Nest::new(area);
    let frame = Frame::new(degrees);
    let piece = |k: usize| {
        let own = std::iter::once(k).chain(nest.within(Some(k)));
        let enter = |k: usize| area[k].iter().map(|&p| frame.enter(p)).collect();
        Piece::new(own.map(enter).collect(), frame, width)
    };
    nest.outer().filter_map(piece).collect()
}

impl Piece {
    /// Of contours in the frame of the lines; `None` of nothing.
    fn new(mut contours: Vec<Contour>, frame: Frame, width: Coord) -> Option<Self> {
        let (low, high) = extent(contours.iter().flatten())?;
        let (across, wide) = (f64::from(high.y - low.y), f64::from(width));
        let count = nearest(across / wide).max(1);
        let even = across / count as f64;
        let fits = (even / wide - 1.0).abs() <= MOST_STRETCH;
        let pitch = if fits { nearest(even) as Coord } else { width };
        // The middle of all bands is the middle of the piece.
        let spread = i64::from(pitch) * (count - 1);
        let first = nearest((across - spread as f64) / 2.0) as Coord;
        let shift = pitch - (low.y + first);
        contours.iter_mut().flatten().for_each(|p| p.y += shift);
        let scan = Scan::new(&contours, Raster { frame: Frame::new(0.0), pitch });
        let range = scan.inside().range();
        let mut near = vec![Vec::new(); range.len() + 1];
        for (p, q) in contours.iter().flat_map(|c| edges(c)) {
            let (low, high) = (p.y.min(q.y), p.y.max(q.y));
            let rows = low.div_euclid(pitch) - 2..high.div_euclid(pitch) + 4;
            for j in rows.start.max(range.start)..rows.end.min(range.end) {
                near[(j - range.start) as usize].push((p, q));
            }
        }
        Some(Self { frame, shift, pitch, scan, first: range.start, near })
    }

    /// Where the middle of row `j` lies, across the lines.
    pub(super) fn v(&self, j: i32) -> Coord {
        j * self.pitch
    }

    /// From the frame of the lines back to the bed.
    pub(super) fn leave(&self, u: f64, v: f64) -> Point {
        let at = Point { x: nearest(u) as Coord, y: nearest(v) as Coord - self.shift };
        self.frame.leave(at)
    }

    /// How much a surface rises across the lines, of how it rises along x and y.
    pub(super) fn across(&self, [x, y]: [f64; 2]) -> f64 {
        // The unit of v on the bed, long enough for the grid.
        const LONG: Coord = 1_000_000;
        let unit = self.frame.leave(Point { x: 0, y: LONG });
        (x * f64::from(unit.x) + y * f64::from(unit.y)) / f64::from(LONG)
    }

    fn near(&self, j: i32) -> &[(Point, Point)] {
        usize::try_from(j - self.first).ok().and_then(|k| self.near.get(k)).map_or(&[], |e| e)
    }

    /// How far the edge is from row `j` at `u`, upwards (`up` 1) or downwards (-1); at most `most`.
    pub(super) fn room(&self, j: i32, u: f64, up: f64, most: f64) -> f64 {
        let v = f64::from(self.v(j));
        let crossing = |&(p, q): &(Point, Point)| {
            let [pu, pv, qu, qv] = [p.x, p.y, q.x, q.y].map(f64::from);
            let crosses = (pu <= u) != (qu <= u);
            let at = || pv + (qv - pv) * (u - pu) / (qu - pu);
            crosses.then(|| up * (at() - v)).filter(|far| *far >= 0.0)
        };
        self.near(j).iter().filter_map(crossing).fold(most, f64::min)
    }

    /// Whether the straight way between two places near row `j` stays `clear` of all edges.
    pub(super) fn is_clear(&self, j: i32, [a, b]: [Point; 2], clear: f64) -> bool {
        let place = |p: Point| [f64::from(p.x), f64::from(p.y)];
        let far = |p: Point, [a, b]: [Point; 2]| distance2(place(p), [place(a), place(b)]);
        let apart = |p: Point, q: Point| {
            let cross = (side(a, b, p) > 0) != (side(a, b, q) > 0)
                && (side(p, q, a) > 0) != (side(p, q, b) > 0);
            let nearest = [far(a, [p, q]), far(b, [p, q]), far(p, [a, b]), far(q, [a, b])];
            !cross && nearest.into_iter().all(|d| d >= clear * clear)
        };
        self.near(j).iter().all(|&(p, q)| apart(p, q))
    }
}
