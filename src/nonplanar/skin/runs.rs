//! Lines of pieces -> Beads: zigzags in the order of printing.
//!
//! Words: a *leg* is a straight stretch of a bead in plan. A *turn* is the leg from one line's end to that
//! of the next. A *run* is a zigzag, or a part of one, that is printed in one go. It *climbs* if the
//! surface rises across all its lines to the same side.
//!
//! 1. Neighbouring lines are joined at their ends, if the turn is short and stays on the skin.
//! 2. A zigzag is cut where the surface turns from rising to falling across the lines. Each part is
//!    printed from below: the level face of the nozzle reaches below the line on its upper side, and
//!    there it shall press on what lies under the skin, not on a line just laid.
//! 3. A run that climbs waits for those that end below its first line. Of the runs that wait for none the
//!    one that begins nearest to the end of the last is next.

use super::lines::{Joined, LONGEST_RUN, rows, spots};
use super::piece::Piece;
use super::relief::Relief;
use crate::geom::Point;
use crate::geom::spans::Span;
use crate::pattern::zigzag::{Link, Side, link};
use crate::units::Coord;

/// A turn stays this share of a line's width away from the edge: half, but for the rounding of corners
/// and of the edge between two lines.
const CLEAR: f64 = 0.45;

/// Places on a line at which the slope is asked for.
const ASKED: i32 = 9;

/// A surface rises across a line if it does so by this on average (tangent of 0.3°).
const LEAST_SLOPE: f64 = 0.005;

/// ... and if what it falls elsewhere on the line leaves at least this share of it.
const ONE_SIDED: f64 = 0.8;

/// Runs of fewer lines are not worth a travel: they go with the lines before them.
const LEAST_LINES: usize = 4;

/// A straight stretch of a bead in plan, with its width at both ends, grid units.
#[derive(Debug, Clone, Copy)]
pub(super) struct Leg {
    /// Where it begins.
    pub(super) from: Point,
    /// Where it ends.
    pub(super) to: Point,
    /// Its width at both.
    pub(super) widths: [f64; 2],
}

/// A bead in plan: each leg begins where the one before ends.
pub(super) type Bead = Vec<Leg>;

/// A run, and what it waits for.
struct Run {
    bead: Bead,
    /// The first and the last line: row, and where it runs along the row.
    ends: [(i32, [Coord; 2]); 2],
    /// The side to which it climbs, by rows; 0 if it does not.
    up: i32,
    piece: usize,
}

/// The beads of `pieces` on `surface`, in the order of printing.
pub(super) fn beads(pieces: &[Piece], surface: &dyn Relief, shortest: Coord) -> Vec<Bead> {
    let of_piece = |(k, piece): (usize, &Piece)| runs(piece, k, surface, shortest);
    in_order(pieces.iter().enumerate().flat_map(of_piece).collect())
}

/// The runs of one piece.
fn runs(piece: &Piece, number: usize, surface: &dyn Relief, shortest: Coord) -> Vec<Run> {
    let rows = rows(piece);
    let pitch = f64::from(piece.pitch);
    let spans = rows.iter().map(|(j, row)| (*j, row.iter().map(|&span| Some(span))));
    let join = |from: (Coord, i32), to: (Coord, i32), _: Side| {
        let ends = [from, to].map(|(u, j)| Point { x: u, y: piece.v(j) });
        let is_short = f64::from((from.0 - to.0).abs()) <= LONGEST_RUN * pitch;
        (is_short && piece.is_clear(from.1, ends, CLEAR * pitch)).then(Vec::new)
    };
    let mut out = Vec::new();
    for zigzag in link(spans, 1, piece.pitch, join) {
        let ups = ups(zigzag.iter().map(|link| up(piece, link, surface)).collect());
        let mut rest = zigzag.into_iter().zip(ups).peekable();
        while let Some((link, up)) = rest.next() {
            let mut links = vec![link];
            while let Some((link, _)) = rest.next_if(|(_, next)| *next == up) {
                links.push(link);
            }
            if up < 0 {
                links.reverse();
                links.iter_mut().for_each(|link| link.from = link.from.other());
            }
            let at = |link: &Link| (link.row, [link.span.start, link.span.end]);
            let ends = [at(&links[0]), at(&links[links.len() - 1])];
            let bead = bead(piece, &rows, &links, shortest);
            out.push(Run { bead, ends, up, piece: number });
        }
    }
    out
}

/// The side to which `surface` rises across a line, if it does so to one side.
fn up(piece: &Piece, link: &Link, surface: &dyn Relief) -> i32 {
    let [a, b] = [link.span.start, link.span.end].map(f64::from);
    let v = f64::from(piece.v(link.row));
    let at = |k: i32| piece.leave(a + (b - a) * (f64::from(k) + 0.5) / f64::from(ASKED), v);
    let slopes = (0..ASKED).filter_map(|k| surface.slope(at(k)));
    let (mut sum, mut all, mut count) = (0.0, 0.0, 0.0);
    for across in slopes.map(|slope| piece.across(slope)) {
        (sum, all, count) = (sum + across, all + across.abs(), count + 1.0);
    }
    let rises = all > LEAST_SLOPE * count && f64::abs(sum) >= ONE_SIDED * all;
    if !rises {
        0
    } else if sum > 0.0 {
        1
    } else {
        -1
    }
}

/// The sides to which the lines of a zigzag climb, without changes for few lines: those go with the lines
/// before them, the first ones with the next.
fn ups(ups: Vec<i32>) -> Vec<i32> {
    let mut out: Vec<i32> = Vec::with_capacity(ups.len());
    for same in ups.chunk_by(|a, b| a == b) {
        let with = out.last().filter(|_| same.len() < LEAST_LINES).unwrap_or(&same[0]);
        let up = *with;
        if out.len() < LEAST_LINES {
            out.fill(up);
        }
        out.extend(same.iter().map(|_| up));
    }
    out
}

/// The bead along the lines of a run.
fn bead(piece: &Piece, rows: &[(i32, Vec<Span>)], links: &[Link], shortest: Coord) -> Bead {
    let pitch = f64::from(piece.pitch);
    let first = rows.first().map_or(0, |(j, _)| *j);
    let row = |j: i32| usize::try_from(j - first).ok().and_then(|k| rows.get(k));
    let spans = |j: i32| row(j).map_or(&[] as &[Span], |(_, spans)| spans);
    let mut legs: Bead = Vec::with_capacity(2 * links.len());
    for (k, link) in links.iter().enumerate() {
        let mut joined = [Joined::default(); 2];
        let above = |other: &Link| usize::from(other.row > link.row);
        let end = |side: Side| usize::from(side == Side::Right);
        if let Some(last) = k.checked_sub(1).and_then(|k| links.get(k)) {
            joined[above(last)][end(link.from)] = true;
        }
        if let Some(next) = links.get(k + 1) {
            joined[above(next)][end(link.from.other())] = true;
        }
        let beside = [spans(link.row - 1), spans(link.row + 1)];
        let mut spots = spots(piece, (link.row, link.span), beside, joined, shortest);
        if link.from == Side::Right {
            spots.reverse();
        }
        let places: Vec<Point> = spots.iter().map(|s| piece.leave(s.u, s.v)).collect();
        if let (Some(last), Some(&to)) = (legs.last(), places.first()) {
            legs.push(Leg { from: last.to, to, widths: [pitch; 2] });
        }
        let leg = |k: usize| Leg {
            from: places[k - 1],
            to: places[k],
            widths: [spots[k - 1].width, spots[k].width],
        };
        legs.extend((1..spots.len()).map(leg));
    }
    legs.retain(|leg| leg.from != leg.to);
    legs
}

/// The beads of runs in the order of printing.
fn in_order(runs: Vec<Run>) -> Vec<Bead> {
    let mut waits = vec![0_usize; runs.len()];
    let mut frees = vec![Vec::new(); runs.len()];
    for (k, run) in runs.iter().enumerate() {
        let below = runs.iter().enumerate().filter(|(_, other)| lies_below(other, run));
        for (other, _) in below {
            frees[other].push(k);
            waits[k] += 1;
        }
    }
    let ups: Vec<i32> = runs.iter().map(|run| run.up).collect();
    let mut beads: Vec<Option<Bead>> = runs.into_iter().map(|run| Some(run.bead)).collect();
    let mut out = Vec::with_capacity(beads.len());
    let mut at: Option<Point> = None;
    while let Some((k, turned)) = next(&beads, &waits, &ups, at) {
        let Some(mut bead) = beads[k].take() else { continue };
        if turned {
            turn(&mut bead);
        }
        at = bead.last().map(|leg| leg.to).or(at);
        out.extend(Some(bead).filter(|bead| !bead.is_empty()));
        for &freed in &frees[k] {
            waits[freed] -= 1;
        }
    }
    out
}

/// Whether `run` begins beside the last line of `other` and above it.
fn lies_below(other: &Run, run: &Run) -> bool {
    let ((last, [a, b]), (first, [c, d])) = (other.ends[1], run.ends[0]);
    let same = other.piece == run.piece && run.up != 0 && other.up == run.up;
    same && first == last + run.up && a < d && c < b
}

/// The bead that is printed next, and whether from its end. If all wait for each other, any.
fn next(
    beads: &[Option<Bead>],
    waits: &[usize],
    ups: &[i32],
    at: Option<Point>,
) -> Option<(usize, bool)> {
    let ways = |k: usize| {
        let bead = beads[k].as_ref()?;
        let far = |p: Option<Point>| at.zip(p).map_or(0, |(at, p)| at.distance2(p));
        let ahead = (waits[k] > 0, far(bead.first().map(|leg| leg.from)), k, false);
        let back = (waits[k] > 0, far(bead.last().map(|leg| leg.to)), k, true);
        // A lone line may be entered at both ends, whatever its slope.
        let either = ups[k] == 0;
        Some(if either { ahead.min(back) } else { ahead })
    };
    (0..beads.len()).filter_map(ways).min().map(|(_, _, k, turned)| (k, turned))
}

/// Lets a bead begin at its end.
fn turn(bead: &mut Bead) {
    bead.reverse();
    for leg in bead {
        (leg.from, leg.to) = (leg.to, leg.from);
        leg.widths.reverse();
    }
}
