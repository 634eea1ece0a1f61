//! Print + Part -> findings of how lines lie on each other: in the air, unanchored, or printed twice.
//!
//! Words used here: a *chain* is lines one after the other without a break; a *patch* is all lines of a
//! layer that touch; a place of a line is *carried* if plastic or the bed reaches up to its lower
//! side there.
//!
//! Lines are laid on a [`Pile`] in the file's order, layer by layer:
//! - a patch of which no line is carried anywhere is in the air. If the model itself has nothing
//!   below there, or is not known, a body begins ([`bodies`](super::bodies)). Within other patches a
//!   stretch that is not carried is a bridge if both its ends are, else an end that hangs; both are
//!   measured, and judged ([`anchors`](super::anchors));
//! - a line whose core runs along another core of its layer is printed twice;
//! - a line that lies lower than a core of a layer before it falls: it runs into what is printed.
//!   This is possible only for lines below the highest line so far, so flat files do not pay for it;
//! - a line that irons may lie on others of its layer, and on nothing else;
//! - a layer whose walls are less high than it lies above the one below misses a layer between.

use super::anchors::{self, LEAST_RUN, Loose, Piece};
use super::beads::place;
use super::bodies::{Bodies, Start};
use super::finding::{Code, Finding, Findings, Place, short};
use super::part::Part;
use super::pile::{Pile, lower_side};
use super::runs::{Runs, Twice};
use super::samples::{Sample, Samples};
use crate::reader::print::Step;
use crate::reader::{Print, Role};

/// Part of its walls' height by which a layer may lie too high: variable heights are rounded,
/// a missing layer is a whole height.
const LEAST_GAP: f64 = 0.4;

/// A patch with shorter lines in all is no layer that is missing below, but a blob, mm.
const LEAST_PATCH: f64 = 4.0;

/// Longest stretch that is ironed where the layer has nothing, mm: hair lines between beads are less.
const LEAST_BARE: f64 = 1.5;

/// Layers that may be missing below lines, by which that differs from a body that begins.
const MOST_MISSING: f64 = 2.0;

/// Length behind the nozzle that does not count as laid, mm: a line may turn back within it.
const BEHIND: f64 = 1.5;

/// What was measured.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Measured {
    /// Longest stretch between two carried places, mm.
    pub(super) longest_bridge: f64,
    /// Longest end of a line that only the line itself and its neighbours hold, mm.
    pub(super) longest_end: f64,
    /// Length of lines that hang where the part itself hangs, mm.
    pub(super) part_hangs: f64,
}

/// Lays all lines of the layers down. Where `part` itself has nothing below, a hanging line is
/// no missing layer.
pub(super) fn check(print: &Print, part: Option<&Part>, found: &mut Findings) -> Measured {
    let mut measured = Measured::default();
    let Some(mut pile) = Pile::over(print) else { return measured };
    let mut bodies = Bodies::default();
    let mut pieces = Vec::new();
    for (layer, one) in print.layers.iter().enumerate() {
        gap(print, (layer, part), found);
        pile.begin_layer();
        let steps = print.moves_of(one).chunk_by(|a, b| {
            a.is_line() && b.is_line() && a.to == b.from && is_ironing(a) == is_ironing(b)
        });
        let all = || steps.clone().filter(|chain| chain[0].is_line());
        let chains = || all().filter(|chain| !is_ironing(&chain[0]));
        let lines: Vec<Line> = chains()
            .map(|chain| lay(&mut pile, chain, &mut pieces, (layer, &mut *found)))
            .collect();
        let mut judge = Judge { layer, part, bodies: &mut bodies, found, measured: &mut measured };
        judge.patches(&lines, &mut pile);
        for chain in all().filter(|chain| is_ironing(&chain[0])) {
            iron(&mut pile, chain, layer, found);
        }
        if let Some((fall, step)) = pile.fall.take() {
            let text = format!("{} mm lower than what is printed already", short(fall));
            found.add(Finding::of(Code::FallingZ, fall, "mm", text).at(place(layer, &step)));
        }
        pile.raise(chains());
    }
    bodies.report(found);
    measured
}

/// Whether a line lies on purpose on others of its layer.
fn is_ironing(step: &Step) -> bool {
    step.role == Role::Ironing
}

/// Reports what of a chain that irons lies beside all that the layer has laid.
fn iron(pile: &mut Pile, chain: &[Step], layer: usize, found: &mut Findings) {
    let (mut run, mut longest) = (0.0, (0.0, chain[0]));
    for step in chain {
        for sample in Samples::of(step, pile.grid.pitch) {
            pile.find_fall(step, &sample);
            run = if pile.is_covered(sample.at) { 0.0 } else { run + sample.length };
            if run > longest.0 {
                longest = (run, *step);
            }
        }
    }
    let (length, step) = longest;
    if length >= LEAST_BARE {
        let text = format!("{} mm are ironed where the layer has nothing", short(length));
        found.add(Finding::of(Code::InTheAir, length, "mm", text).at(place(layer, &step)));
    }
}

/// How much higher a layer lies than its walls are, above the layer or the bed below, mm. Only walls
/// are compared, since infill may be as thick as several layers.
pub(super) fn gap_below(print: &Print, layer: usize) -> f64 {
    let one = &print.layers[layer];
    if !print.has_heights {
        return 0.0;
    }
    let height = walls(print, layer).map(|step| f64::from(step.height)).fold(0.0, f64::max);
    let missing = one.height - height;
    if height > 0.0 && missing > LEAST_GAP * height { missing } else { 0.0 }
}

fn walls(print: &Print, layer: usize) -> impl Iterator<Item = &Step> {
    let steps = print.moves_of(&print.layers[layer]).iter();
    steps.filter(|step| step.is_line() && step.role == Role::OuterWall)
}

/// Reports a layer whose walls are less high than it lies above the one below: a layer between is
/// missing, unless the part has nothing there either.
fn gap(print: &Print, (layer, part): (usize, Option<&Part>), found: &mut Findings) {
    let missing = gap_below(print, layer);
    // Above the bed the patches are judged. A raft or support below ends lower on purpose.
    let is_above_walls = layer.checked_sub(1).is_some_and(|k| walls(print, k).next().is_some());
    let is_of_part = part.is_some_and(|part| part.is_empty_below(layer));
    let (Some(first), true) = (walls(print, layer).next(), is_above_walls) else { return };
    if missing > 0.0 && !is_of_part {
        let text = format!("the layer lies {} mm too high above the one before", short(missing));
        found.add(Finding::of(Code::InTheAir, missing, "mm", text).at(place(layer, first)));
    }
}

/// An unbroken line once it is laid.
struct Line {
    /// Its first piece.
    first: Step,
    /// mm.
    length: f64,
    /// The chains that carry it, counted from 1, each once or more; 0 is the bed.
    carriers: Vec<u32>,
    /// Stretches that nothing carries, but for bridges: those at its ends.
    ends: Vec<Vec<Sample>>,
    /// Lines without an anchor.
    loose: Vec<(Loose, Step)>,
    longest_bridge: f64,
}

/// Lays one unbroken line, of many straight pieces; `pieces` is room for them.
fn lay(
    pile: &mut Pile,
    chain: &[Step],
    pieces: &mut Vec<Piece>,
    (layer, found): (usize, &mut Findings),
) -> Line {
    let (mut runs, mut twice, mut carriers) = (Runs::default(), Twice::default(), Vec::new());
    let (mut behind, mut way_behind) = (0, 0.0);
    let (mut length, mut hangs) = (0.0, 0.0);
    pieces.clear();
    for (k, step) in chain.iter().enumerate() {
        way_behind += step.length();
        while way_behind - chain[behind].length() > BEHIND {
            way_behind -= chain[behind].length();
            pile.lay_core(&chain[behind]);
            behind += 1;
        }
        for sample in Samples::of(step, pile.grid.pitch) {
            length += sample.length;
            pile.find_fall(step, &sample);
            twice.add(pile.is_laid(step, sample.at), sample.length, step);
            let carrier = pile.carrier(step, &sample);
            match carrier {
                Some(one) if carriers.last() != Some(&one) => carriers.push(one),
                Some(_) => {}
                None => hangs += sample.length,
            }
            runs.add(carrier.is_some(), sample);
            pieces.push(Piece { sample, carried: carrier.is_some(), step: k });
        }
    }
    chain[behind..].iter().for_each(|step| pile.lay_core(step));
    runs.end();
    let loose = if hangs > LEAST_RUN { anchors::loose(pile, chain, pieces) } else { Vec::new() };
    pile.lay(chain);
    for (long, step) in twice.ends(length) {
        let text = format!("{} mm of a line lie on another of the layer", short(long));
        found.add(Finding::of(Code::PrintedTwice, long, "mm", text).at(place(layer, &step)));
    }
    Line {
        first: chain[0],
        length,
        carriers,
        ends: runs.ends,
        loose: loose
            .into_iter()
            .map(|one| {
                let step = chain[one.step];
                (one, step)
            })
            .collect(),
        longest_bridge: runs.longest_bridge,
    }
}

/// Judges what hangs on a layer.
struct Judge<'a> {
    layer: usize,
    part: Option<&'a Part>,
    bodies: &'a mut Bodies,
    found: &'a mut Findings,
    measured: &'a mut Measured,
}

impl Judge<'_> {
    fn patches(&mut self, lines: &[Line], pile: &mut Pile) {
        let roots: Vec<usize> = (0..lines.len()).map(|line| pile.root(line)).collect();
        // The lines of each patch side by side, in the order of their first lines.
        let mut order: Vec<usize> = (0..lines.len()).collect();
        order.sort_by_key(|&line| roots[line]);
        let mut of_line = vec![0; lines.len()];
        for patch in order.chunk_by(|&a, &b| roots[a] == roots[b]) {
            let lines: Vec<&Line> = patch.iter().map(|&line| &lines[line]).collect();
            let body = self.patch(&lines, pile);
            patch.iter().for_each(|&line| of_line[line] = body);
        }
        of_line.into_iter().for_each(|body| self.bodies.chain(body));
    }

    /// Judges a patch; returns its body.
    fn patch(&mut self, lines: &[&Line], pile: &Pile) -> usize {
        let length = lines.iter().map(|line| line.length).sum();
        let carriers = || lines.iter().flat_map(|line| line.carriers.iter().copied());
        let is_part = lines.iter().any(|line| !is_beside(line.first.role));
        let body = self.bodies.add((length, is_part), carriers());
        for line in lines {
            self.measured.longest_bridge = self.measured.longest_bridge.max(line.longest_bridge);
        }
        if carriers().next().is_none() {
            self.begins(lines, length, (body, pile));
            return body;
        }
        for line in lines {
            // Skins may begin and end between two lines of sparse infill.
            let longest = line.ends.iter().map(|end| length_of(end)).fold(0.0, f64::max);
            self.measured.longest_end = self.measured.longest_end.max(longest);
            for (loose, step) in &line.loose {
                let what = step.role.name();
                let text = format!("{} mm of {what} {}", short(loose.length), loose.why);
                let finding = Finding::warning(Code::Unanchored, loose.length, "mm", text);
                let at_mm = Some(loose.at.map(short));
                self.found.add(finding.at(Place { at_mm, ..place(self.layer, step) }));
            }
        }
        body
    }

    /// A patch hangs: a layer below is missing, unless the part itself hangs there. Where that is
    /// not known, plastic a layer or two lower tells.
    fn begins(&mut self, lines: &[&Line], length: f64, (body, pile): (usize, &Pile)) {
        let samples = || lines.iter().flat_map(|line| line.ends.iter().flatten().copied());
        let step = &lines[0].first;
        let hangs = |sample: &Sample| match self.part {
            Some(part) => part.hangs(self.layer, sample.at),
            None => {
                let low = lower_side(step, sample.z) - MOST_MISSING * f64::from(step.height);
                low <= 0.0 || pile.standing(sample.at, low).is_none()
            }
        };
        let (by_part, own): (Vec<Sample>, Vec<Sample>) = samples().partition(hangs);
        let middle = |of: &[Sample]| of.get(of.len() / 2).map(|sample| sample.at.map(short));
        let at = |of: &[Sample]| Place { at_mm: middle(of), ..place(self.layer, step) };
        if length >= LEAST_PATCH && self.part.is_some() {
            self.measured.part_hangs += length_of(&by_part);
        }
        if length_of(&own) >= LEAST_PATCH {
            let what = step.role.name();
            let text = format!("{} mm of {what} have nothing under them", short(length_of(&own)));
            let finding = Finding::of(Code::InTheAir, length_of(&own), "mm", text);
            self.found.add(finding.at(at(&own)));
            return;
        }
        let all: Vec<Sample> = samples().collect();
        let start = Start {
            place: at(&all),
            role: step.role,
            length,
            bottom: step.heights()[0] - f64::from(step.height),
        };
        self.bodies.begin(body, start);
    }
}

fn length_of(samples: &[Sample]) -> f64 {
    samples.iter().map(|sample| sample.length).sum()
}

/// Whether lines of this role are printed beside the part, which does not stand by them.
fn is_beside(role: Role) -> bool {
    matches!(role, Role::Support | Role::Adhesion)
}
