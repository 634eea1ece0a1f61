//! Ironing -> zigzags: its lines joined end to end, to be printed one after the other as they come.
//!
//! What the nozzle pushes before it must not be pushed back by the next line. So lines come in one
//! direction of advance, as those of a top do ([`monotonic`](super::monotonic)).

use super::monotonic::in_order;
use crate::geom::Point;
use crate::pattern::zigzag::{Link, Side, link};
use crate::region::ironing::Ironing;
use crate::units::Coord;

/// Maximum distance that a join runs along its lines, in line widths of the layer. The nozzle would go
/// over other lines once more on longer ones; a smaller limit cuts zigzags at slanted walls.
const LONGEST_JOIN: Coord = 2;

/// The zigzags in their order, in the frame of the raster. Lines of the layer are `line_width` wide.
pub(super) fn zigzags(ironing: &Ironing, line_width: Coord) -> Vec<Vec<Point>> {
    let pitch = ironing.raster.pitch;
    let rows = ironing.rows.iter().map(|(j, row)| (j, row.iter().map(|&span| Some(span))));
    let join = |from: (Coord, i32), to: (Coord, i32), _: Side| {
        ((from.0 - to.0).abs() <= LONGEST_JOIN * line_width).then(Vec::new)
    };
    let zigzags = in_order(link(rows, 1, pitch, join), pitch);
    let points = |zigzag: Vec<Link>| {
        let ends = zigzag.iter().flat_map(|link| {
            let at = |side: Side| Point { x: side.of(link.span), y: link.row * pitch };
            [at(link.from), at(link.from.other())]
        });
        ends.collect()
    };
    zigzags.into_iter().map(points).collect()
}
