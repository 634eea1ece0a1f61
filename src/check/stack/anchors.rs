//! A chain and what carries it -> its lines that hang without an anchor.
//!
//! Words used here: a *run* is a stretch of a chain that nothing carries; its end is *held* if the
//! chain is carried beyond it, or if plastic stands close by (a line that ends beside a wall holds on
//! to it, but only where the wall itself stands). A line is *loose* over a run
//! - with an end that is not held: it is laid into the air and sags. The end of a bridge, a long run of
//!   skin, must rest on what carries it;
//! - along a narrow void: what carries it lies on both sides, nearer together than the run is long,
//!   so that the line runs beside what it should cross;
//! - of a wall in a bow, which the plastic cuts short.
//!
//! Infill and skin turn at each end of a line, so that such chains are cut at corners, and each line
//! is judged alone. Walls are judged as a whole: they go round corners by right.

use super::ground::{Ground, PITCH, lower_side};
use crate::check::samples::Sample;
use crate::geom::segment;
use crate::reader::Role;
use crate::reader::print::Step;

/// Shorter runs are let pass, mm: a line bridges the gap between two lines of sparse infill.
pub(crate) const LEAST_RUN: f64 = 3.0;

/// Plastic this near holds an end, mm: a line ends one and a half widths from the middle of a wall's
/// own line below at most.
const NEAR: f64 = 0.8;

/// A skin's longer run is a bridge, mm: it hangs on its ends alone, …
const BRIDGE: f64 = 6.0;

/// … and an end must rest on plastic, or end at its very edge, mm: beside a wall that carries nothing of
/// it, only the side of the bead sticks.
const NEAR_BRIDGE: f64 = 0.4;

/// Void to both sides of a line is looked for as far as this, mm: sparse lines of 10 % lie 4 mm apart.
const MOST_ASIDE: f64 = 6.0;

/// A run is along a void if that is narrower than this part of the run.
const ALONG: f64 = 0.5;

/// A wall's run is a bow if its ends lie nearer than this part of its length: a half circle has 0.64.
const BOW: f64 = 0.7;

/// Cosines of the angles from which on a step leaves its line: a long step, and a short one, mm, of
/// which rounded corners and rounded ends of lines consist.
const CORNERS: [f64; 2] = [0.95, 0.7];
const LONG: f64 = 1.0;

/// Ends of a loop lie nearer to each other than this, mm.
const CLOSED: f64 = 0.6;

/// A short piece of a chain.
pub(crate) struct Piece {
    pub(crate) sample: Sample,
    pub(crate) carried: bool,
    /// Its line in the chain.
    pub(crate) step: usize,
}

/// A line that hangs.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Loose {
    /// Middle of the run.
    pub(crate) at: [f64; 2],
    /// Its line in the chain.
    pub(crate) step: usize,
    /// mm.
    pub(crate) length: f64,
    pub(crate) why: &'static str,
}

/// The loose lines of a chain of the layer that is laid on the ground.
pub(crate) fn loose(ground: &Ground<'_>, chain: &[Step], pieces: &[Piece]) -> Vec<Loose> {
    let mut found = Vec::new();
    let mut from = 0;
    for run in pieces.chunk_by(|a, b| a.carried == b.carried) {
        let (first, end) = (from, from + run.len());
        from = end;
        if run[0].carried || length_of(run) <= LEAST_RUN {
            continue;
        }
        let ends = [first > 0, end < pieces.len()];
        let judge = Judge { ground, chain };
        match chain[run[0].step].role {
            Role::Support | Role::Adhesion => {}
            Role::OuterWall | Role::InnerWall => {
                // A loop may begin in the air.
                let closes = is_closed(chain) && ends != [false; 2];
                found.extend(judge.wall(run, ends.map(|held| held || closes)));
            }
            _ => judge.lines(run, ends, &mut found),
        }
    }
    found
}

struct Judge<'a> {
    ground: &'a Ground<'a>,
    chain: &'a [Step],
}

impl Judge<'_> {
    /// Judges a wall's run; `carried` says whether the chain is carried beyond its ends.
    fn wall(&self, run: &[Piece], carried: [bool; 2]) -> Option<Loose> {
        if !self.holds(run, carried, NEAR) {
            return Some(found(run, FREE));
        }
        let [first, .., last] = run else { return None };
        let way = segment::way(first.sample.at, last.sample.at);
        let chord = segment::dot(way, way).sqrt();
        (chord < BOW * length_of(run)).then(|| found(run, "hang in a bow"))
    }

    /// Judges the straight lines of a run.
    fn lines(&self, run: &[Piece], carried: [bool; 2], out: &mut Vec<Loose>) {
        let lines = straight(self.chain);
        let mut from = 0;
        for line in run.chunk_by(|a, b| lines[a.step] == lines[b.step]) {
            let (first, end) = (from, from + line.len());
            from = end;
            if length_of(line) <= LEAST_RUN {
                continue;
            }
            let carried = [first == 0 && carried[0], end == run.len() && carried[1]];
            let near = if length_of(line) > BRIDGE { NEAR_BRIDGE } else { NEAR };
            if !self.holds(line, carried, near) {
                out.push(found(line, FREE));
            } else if self.is_along(line) {
                out.push(found(line, "run beside what they should rest on"));
            }
        }
    }

    /// Whether both ends of a run are held.
    fn holds(&self, run: &[Piece], carried: [bool; 2], near: f64) -> bool {
        let [Some(first), Some(last)] = [run.first(), run.last()] else { return true };
        (carried[0] || self.is_near(first, near)) && (carried[1] || self.is_near(last, near))
    }

    /// Whether plastic stands as near as this, mm.
    fn is_near(&self, piece: &Piece, near: f64) -> bool {
        let [x, y] = piece.sample.across;
        let (sides, slants) =
            ([[x, y], [-x, -y], [y, -x], [-y, x]], [[x + y, y - x], [x - y, x + y]]);
        let slants = slants.map(|way| way.map(|side| side * std::f64::consts::FRAC_1_SQRT_2));
        let ways = sides.into_iter().chain(slants).chain(slants.map(|way| way.map(|side| -side)));
        ways.flat_map(|way| [0.5 * near, near].map(|by| segment::along(piece.sample.at, by, way)))
            .any(|at| self.stands(piece, at))
    }

    fn stands(&self, piece: &Piece, at: [f64; 2]) -> bool {
        let needed = lower_side(&self.chain[piece.step], piece.sample.z);
        self.ground.stands(at, needed)
    }

    /// Whether a line runs along a void that it should cross.
    fn is_along(&self, line: &[Piece]) -> bool {
        let most = ALONG * length_of(line);
        let step = PITCH;
        let aside = |piece: &Piece, side: f64| {
            let way = piece.sample.across.map(|part| side * part);
            let tries = (most.min(MOST_ASIDE) / step) as usize;
            (1..=tries)
                .map(|k| k as f64 * step)
                .find(|&by| self.stands(piece, segment::along(piece.sample.at, by, way)))
        };
        let along = line.iter().filter(|piece| {
            let Some(left) = aside(piece, 1.0) else { return false };
            aside(piece, -1.0).is_some_and(|right| left + right < most)
        });
        along.map(|piece| piece.sample.length).sum::<f64>() > LEAST_RUN
    }
}

/// For each step of a chain the straight line that it is of.
fn straight(chain: &[Step]) -> Vec<usize> {
    let (mut line, mut along) = (0, None);
    let lines = chain.iter().map(|step| {
        let length = step.length().max(f64::MIN_POSITIVE);
        let way = segment::way(step.from.map(f64::from), step.to.map(f64::from));
        let way = way.map(|side| side / length);
        let is_long = length >= LONG;
        let corner = CORNERS[usize::from(!is_long)];
        if along.is_some_and(|along| segment::dot(along, way) < corner) {
            line += 1;
            along = Some(way);
        } else if is_long || along.is_none() {
            along = Some(way);
        }
        line
    });
    lines.collect()
}

const FREE: &str = "hang with a free end";

fn found(run: &[Piece], why: &'static str) -> Loose {
    let middle = &run[run.len() / 2];
    Loose { at: middle.sample.at, step: middle.step, length: length_of(run), why }
}

fn length_of(run: &[Piece]) -> f64 {
    run.iter().map(|piece| piece.sample.length).sum()
}

/// Whether a chain ends where it begins.
fn is_closed(chain: &[Step]) -> bool {
    let [Some(first), Some(last)] = [chain.first(), chain.last()] else { return false };
    let way = segment::way(first.from.map(f64::from), last.to.map(f64::from));
    segment::dot(way, way).sqrt() <= CLOSED
}
