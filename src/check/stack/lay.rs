//! A layer on the ground -> what hangs on it, lies twice or falls, and its patches: all lines that touch.
//!
//! Words used here: a *chain* is lines one after the other without a break; a *patch* is all lines of a
//! layer that touch; a *way* is a part of a line, from 0 to 1; a *run* is a stretch of a chain that
//! is carried all along, or nowhere. What is judged is told in [`stack`](super).
//!
//! Chains are laid in the file's order, each on the ground and beside those of its layer before it:
//! 1. the ways of each of its lines that are carried, or lie on another line, are found among the
//!    lines near it;
//! 2. they are put together to runs of the chain, which are judged;
//! 3. chains that touch become patches, which are judged last.
//!
//! Lines *stray* that are farther off their layer's height than it is high, as those of skins over a slope
//! are. In a layer with such, and elsewhere off the height, a line lies on what was laid before it, be it of
//! its own layer.

use super::anchors::{self, LEAST_RUN, Loose, Piece};
use super::bead::{Bead, both};
use super::bodies::Start;
use super::carriers::Carriers;
use super::chains::{CORE, SAME_HEIGHT, chains_of, is_ironing, runs_on};
use super::ground::{Carrier, Ground, PITCH, above, bed_room, below, lower_side, room_below};
use super::laid::{AROUND, Laid, Seen};
use super::runs::{Runs, Twice, united};
use crate::check::beads::place;
use crate::check::belongs::{carries_aside, is_stray};
use crate::check::finding::{Code, Finding, Place, short};
use crate::check::model::part::Part;
use crate::check::moves::ROUNDING;
use crate::check::samples::{Sample, Samples, length_of};
use crate::geom::sets::Sets;
use crate::reader::Role;
use crate::reader::print::{Layer, Step};
use crate::units::Bounded as _;
use std::ops::Range;

/// A patch with shorter lines in all is no layer that is missing below, but a blob, mm.
const LEAST_PATCH: f64 = 4.0;

/// Longest stretch that is ironed where the layer has nothing, mm: hair lines between beads are less.
const LEAST_BARE: f64 = 1.5;

/// Layers that may be missing below lines, by which that differs from a body that begins.
const MOST_MISSING: f64 = 2.0;

/// Length behind the nozzle that does not count as laid, mm: a line may turn back within it.
const BEHIND: f64 = 1.5;

/// What carries a line may end so far beside it, mm: a tenth of a line, by which widths are rounded
/// and beads are wider than files say.
const SLACK: f64 = 0.05;

/// Gaps in what a line lies on that do not count, mm.
const CLOSED: f64 = 0.03;

/// A line that strays lies on another of its layer, or falls into it, from this part of its height on;
/// and so long a stretch of it may have nothing under it, mm.
const OVER: f64 = 0.25;
const LEAST_STRAY: f64 = 2.0;

/// A skin over a slope lies on a staircase whose treads stand over its base by so many layers: at its edge a line
/// may begin in one.
const TREAD: f64 = 0.5;

/// What was measured.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Measured {
    /// Longest stretch between two carried places, mm.
    pub(crate) longest_bridge: f64,
    /// Longest end of a line that only the line itself and its neighbours hold, mm.
    pub(crate) longest_end: f64,
    /// Length of lines that hang where the part itself hangs, mm.
    pub(crate) part_hangs: f64,
}

/// A chain once it is laid.
struct Line {
    /// mm.
    length: f64,
    /// What carries it, each once.
    carriers: Vec<Carrier>,
    /// Longest stretch that nothing carries at one of its ends, and between two that are carried, mm.
    longest_end: f64,
    longest_bridge: f64,
    /// Lines without an anchor.
    loose: Vec<(Loose, Step)>,
}

/// All lines of a layer that touch.
pub(crate) struct Patch {
    /// mm.
    pub(crate) length: f64,
    /// Whether the part stands by it.
    pub(crate) is_part: bool,
    pub(crate) carriers: Vec<Carrier>,
    /// Where a body begins, if it does.
    pub(crate) start: Option<Start>,
}

/// What was found on a layer.
pub(crate) struct Judged {
    pub(crate) found: Vec<Finding>,
    pub(crate) measured: Measured,
    pub(crate) patches: Vec<Patch>,
    /// The patch of each chain.
    pub(crate) of_chain: Vec<usize>,
}

/// Judges a layer.
pub(crate) struct Judge<'a> {
    layer: usize,
    level: &'a Layer,
    has_strays: bool,
    part: Option<&'a Part>,
    laid: &'a Laid,
    moves: &'a [Step],
    ground: &'a Ground<'a>,
    /// The highest line of the layers before, mm.
    highest: f64,
    /// Which chains touch.
    touching: Sets,
    /// Beads of this layer, and of those below, that were looked at for a line.
    seen: Seen,
    seen_below: Vec<Seen>,
    carriers: Carriers,
    pub(crate) found: Vec<Finding>,
    measured: Measured,
    /// How deep a line of this layer lies in what the layers before have printed, mm, and the line
    /// that lies deepest.
    fall: Option<(f64, Step)>,
}

/// What of a line is carried, and what of it lies on others of its layer: stretches from 0 to 1.
#[derive(Default)]
struct Ways {
    carried: Vec<[f64; 2]>,
    /// Carried on the middle, and beside it: by which chain of which layer of the ground.
    middle: Vec<[f64; 2]>,
    beside: Vec<((usize, u32), [f64; 2])>,
    laid: Vec<[f64; 2]>,
}

impl<'a> Judge<'a> {
    pub(crate) fn new(
        (layer, level, part): (usize, &'a Layer, Option<&'a Part>),
        (laid, moves): (&'a Laid, &'a [Step]),
        ground: &'a Ground<'a>,
        highest: f64,
    ) -> Self {
        let mut touching = Sets::default();
        laid.chains.iter().for_each(|_| _ = touching.add());
        Self {
            layer,
            level,
            has_strays: moves.iter().any(|step| step.is_line() && is_stray(step, level)),
            part,
            laid,
            moves,
            ground,
            highest,
            touching,
            seen: Seen::default(),
            seen_below: ground.seen(),
            carriers: Carriers::new(ground),
            found: Vec::new(),
            measured: Measured::default(),
            fall: None,
        }
    }

    pub(crate) fn layer(mut self) -> Judged {
        let mut ways = Ways::default();
        let lines: Vec<Line> =
            (0..self.laid.chains.len()).map(|chain| self.lay(chain, &mut ways)).collect();
        let (patches, of_chain) = self.patches(&lines);
        for chain in chains_of(self.moves).filter(|chain| is_ironing(&self.moves[chain.start])) {
            self.iron(&self.moves[chain]);
        }
        if let Some((fall, step)) = self.fall {
            let text = format!("{} mm lower than what is printed already", short(fall));
            self.add(Finding::of(Code::FallingZ, fall, "mm", text), &step);
        }
        Judged { found: self.found, measured: self.measured, patches, of_chain }
    }

    fn add(&mut self, finding: Finding, step: &Step) {
        self.found.push(finding.at(place(self.layer, step)));
    }

    /// Lays a chain, of many straight lines.
    fn lay(&mut self, chain: usize, ways: &mut Ways) -> Line {
        let beads = self.laid.chains[chain].clone();
        let (mut runs, mut twice) = (Runs::default(), Twice::default());
        self.carriers.begin();
        for index in beads.clone() {
            let bead = &self.laid.beads[index];
            let step = &self.moves[bead.step as usize];
            self.find_fall(bead, step, beads.start);
            self.carry(bead, step, ways);
            self.touch(bead, step, index, ways);
            united(&mut ways.carried, 0.0);
            runs.add(index - beads.start, bead.length, &ways.carried);
            united(&mut ways.laid, CLOSED / bead.length);
            twice.step(&ways.laid, bead.length, step);
        }
        let carriers = self.carriers.take();
        let length = self.laid.beads[beads.clone()].iter().map(|bead| bead.length).sum();
        for (long, step) in twice.ends(length) {
            let text = format!("{} mm of a line lie on another of the layer", short(long));
            self.add(Finding::of(Code::PrintedTwice, long, "mm", text), &step);
        }
        if self.has_strays && beads.clone().any(|bead| self.strays(bead)) {
            let (longest_end, longest_bridge) = (0.0, 0.0);
            self.hang(beads.start, &runs);
            return Line { length, carriers, longest_end, longest_bridge, loose: Vec::new() };
        }
        let loose = if runs.hanging() > LEAST_RUN { self.loose(beads, &runs) } else { Vec::new() };
        let (longest_end, longest_bridge) = runs.longest();
        Line { length, carriers, longest_end, longest_bridge, loose }
    }

    /// Whether a bead is of a line that strays.
    fn strays(&self, bead: usize) -> bool {
        is_stray(&self.moves[self.laid.beads[bead].step as usize], self.level)
    }

    /// Reports what of a chain that strays has nothing under it; `first` is its first bead.
    fn hang(&mut self, first: usize, runs: &Runs) {
        for run in runs.all.iter().filter(|run| !run.carried && run.length >= LEAST_STRAY) {
            let step = self.moves[self.laid.beads[first + run.from.0].step as usize];
            let (length, what) = (short(run.length), step.role.name());
            let text = format!("{length} mm of {what} have nothing under them");
            self.add(Finding::of(Code::InTheAir, run.length, "mm", text), &step);
        }
    }

    /// Finds what carries a line.
    fn carry(&mut self, bead: &Bead, step: &Step, ways: &mut Ways) {
        ways.carried.clear();
        ways.middle.clear();
        ways.beside.clear();
        ways.laid.clear();
        let (ground, carriers) = (self.ground, &mut self.carriers);
        // What lies lower falls into other lines before it lies on one; higher than all lies on none.
        let lowest = bead.heights[0].at_most(bead.heights[1]);
        let may_run =
            bead.middle() > self.highest - SAME_HEIGHT && lowest < self.highest + SAME_HEIGHT;
        let (mut is_whole, mut is_full) = (false, false);
        if let Some(way) = below(bead, bed_room(step)) {
            is_whole = way == [0.0, 1.0];
            ways.carried.push(way);
            carriers.add_bed();
        }
        let room = room_below(step);
        ground.near(bead, (lowest - room, SLACK), &mut self.seen_below, |place, other| {
            if may_run && let Some(way) = runs_on(bead, other) {
                ways.laid.push(way);
            }
            let carrier = (place, other.chain);
            let is_known = carriers.has(carrier);
            // Of a line that lies on others as a whole, chains beside it carry nothing more.
            let carries_more = || !is_full || bead.way(other, other.radius + SLACK).is_some();
            if is_whole && (is_known || !carries_more()) {
                return;
            }
            let low = if other.is_level() {
                below(bead, other.top() + room)
            } else {
                let gap = other.top() - other.highest() + room;
                above(bead, other, [f64::NEG_INFINITY, gap])
            };
            let side = bead.way(other, other.radius + bead.radius + SLACK);
            let Some(side) = low.zip(side).and_then(|(a, b)| both(a, b)) else { return };
            is_whole |= side == [0.0, 1.0];
            ways.carried.push(side);
            if is_known {
                return;
            }
            match bead.way(other, other.radius + SLACK).and_then(|way| both(way, side)) {
                Some(middle) => {
                    is_full |= middle == [0.0, 1.0];
                    ways.middle.push(middle);
                    carriers.add(ground, carrier);
                }
                None => ways.beside.push((carrier, side)),
            }
        });
        // What lies beside the middle carries only where nothing lies below that.
        if !ways.beside.is_empty() {
            united(&mut ways.middle, 0.0);
            for (carrier, [from, to]) in ways.beside.drain(..) {
                if !ways.middle.iter().any(|middle| middle[0] <= from && to <= middle[1]) {
                    carriers.add(ground, carrier);
                }
            }
        }
    }

    /// Joins a line's chain to those that it touches, and finds what it lies on of its own layer: of
    /// what was laid before.
    fn touch(&mut self, bead: &Bead, step: &Step, index: usize, ways: &mut Ways) {
        let strays = is_stray(step, self.level);
        let is_off =
            self.has_strays || bead.heights.iter().any(|z| (z - self.level.z).abs() > SAME_HEIGHT);
        let over = OVER * f64::from(step.height);
        let (mut fall, room) = (0.0_f64, room_below(step));
        let (touching, chain) = (&mut self.touching, bead.chain as usize);
        let mut root = touching.root(chain);
        self.laid.before(index, &mut self.seen, |_, other| {
            let is_own = other.chain == bead.chain;
            if !is_own
                && root != touching.root(other.chain as usize)
                && bead.way(other, bead.radius + other.radius + AROUND).is_some()
            {
                touching.join(chain, other.chain as usize);
                root = touching.root(chain);
            }
            let is_behind = !is_own || bead.reach - other.reach > BEHIND;
            if !is_behind {
                return;
            }
            if let Some(way) = runs_on(bead, other) {
                ways.laid.push(way);
            }
            if is_off {
                let aside = carries_aside(&self.moves[other.step as usize], self.level, bead);
                let under = bead.way(other, other.radius + aside + SLACK);
                let carried = under.zip(above(bead, other, [over, room]));
                ways.carried.extend(carried.and_then(|(a, b)| both(a, b)));
            }
            if strays && let Some([from, to]) = bead.way(other, CORE * other.radius) {
                fall = fall.max(-bead.above(other, 0.5 * (from + to)));
            }
        });
        if fall > self.fall.map_or(over, |(most, _)| most.max(over)) {
            self.fall = Some((fall, *step));
        }
    }

    /// Notes how far a line lies below the nozzle's way there in a layer before; `before` is how many
    /// beads of its own layer lie there already.
    fn find_fall(&mut self, bead: &Bead, step: &Step, before: usize) {
        if bead.heights[0].min(bead.heights[1]) >= self.highest - ROUNDING {
            return;
        }
        // Skins lie on what their layer has there.
        let strays = is_stray(step, self.level);
        let is_free = |at| strays || !self.laid.covers(at, |k, _| k < before);
        let fall = self.ground.depth(bead, CORE, &mut self.seen_below, is_free);
        let least = if strays { TREAD * self.level.height } else { ROUNDING };
        if fall > self.fall.map_or(least, |(most, _)| most.max(least)) {
            self.fall = Some((fall, *step));
        }
    }

    /// Reports what of a chain that irons lies beside all that the layer has laid.
    fn iron(&mut self, chain: &[Step]) {
        let (mut run, mut longest) = (0.0, (0.0, chain[0]));
        for step in chain {
            let bead = Bead::of(step);
            self.find_fall(&bead, step, usize::MAX);
            let mut covered = Vec::new();
            self.laid.near(&bead, 0.0, &mut self.seen, |_, other| {
                covered.extend(bead.way(other, other.radius));
            });
            united(&mut covered, 0.0);
            let mut at = 0.0;
            for [from, to] in covered.into_iter().chain([[1.0, 1.0]]) {
                run += (from - at) * bead.length;
                if run > longest.0 {
                    longest = (run, *step);
                }
                run = if to > from { 0.0 } else { run };
                at = to;
            }
        }
        let (length, step) = longest;
        if length >= LEAST_BARE {
            let text = format!("{} mm are ironed where the layer has nothing", short(length));
            self.add(Finding::of(Code::InTheAir, length, "mm", text), &step);
        }
    }

    /// The loose lines of a chain.
    fn loose(&self, beads: Range<usize>, runs: &Runs) -> Vec<(Loose, Step)> {
        let first = self.laid.beads[beads.start].step as usize;
        let chain = &self.moves[first..first + beads.len()];
        let mut pieces = Vec::new();
        for run in &runs.all {
            if run.carried || run.length <= LEAST_RUN {
                let (step, _) = run.from;
                let sample = Samples::of(&chain[step], f64::INFINITY).next();
                pieces.extend(sample.map(|sample| Piece {
                    sample: Sample { length: run.length, ..sample },
                    carried: run.carried,
                    step,
                }));
                continue;
            }
            let steps = chain.iter().enumerate().take(run.to.0 + 1).skip(run.from.0);
            for (step, line) in steps {
                let from = if step == run.from.0 { run.from.1 } else { 0.0 };
                let to = if step == run.to.0 { run.to.1 } else { 1.0 };
                let samples = Samples::of(line, PITCH).between(from, to);
                pieces.extend(samples.map(|sample| Piece { sample, carried: false, step }));
            }
        }
        let loose = anchors::loose(self.ground, chain, &pieces);
        loose.into_iter().map(|one| (chain[one.step], one)).map(|(step, one)| (one, step)).collect()
    }

    /// Judges the patches of the layer, in the order of their first chains; gives each chain's.
    fn patches(&mut self, lines: &[Line]) -> (Vec<Patch>, Vec<usize>) {
        let roots: Vec<usize> = (0..lines.len()).map(|line| self.touching.root(line)).collect();
        // The lines of each patch side by side, in the order of their first lines.
        let mut order: Vec<usize> = (0..lines.len()).collect();
        order.sort_by_key(|&line| roots[line]);
        let (mut patches, mut of_chain) = (Vec::new(), vec![0; lines.len()]);
        for patch in order.chunk_by(|&a, &b| roots[a] == roots[b]) {
            patch.iter().for_each(|&line| of_chain[line] = patches.len());
            let patch = self.patch(lines, patch);
            patches.push(patch);
        }
        (patches, of_chain)
    }

    fn patch(&mut self, lines: &[Line], chains: &[usize]) -> Patch {
        let of_patch = || chains.iter().map(|&chain| &lines[chain]);
        let length = of_patch().map(|line| line.length).sum();
        let mut carriers = Vec::new();
        for line in of_patch() {
            carriers.extend_from_slice(&line.carriers);
            self.measured.longest_bridge = self.measured.longest_bridge.max(line.longest_bridge);
        }
        let is_part = chains.iter().any(|&chain| !is_beside(self.first(chain).role));
        if carriers.is_empty() {
            let start = self.begins(chains, length);
            return Patch { length, is_part, carriers, start };
        }
        for line in of_patch() {
            // Skins may begin and end between two lines of sparse infill.
            self.measured.longest_end = self.measured.longest_end.max(line.longest_end);
            for (loose, step) in &line.loose {
                let what = step.role.name();
                let text = format!("{} mm of {what} {}", short(loose.length), loose.why);
                let finding = Finding::warning(Code::Unanchored, loose.length, "mm", text);
                let at_mm = Some(loose.at.map(short));
                self.found.push(finding.at(Place { at_mm, ..place(self.layer, step) }));
            }
        }
        Patch { length, is_part, carriers, start: None }
    }

    /// The first line of a chain.
    fn first(&self, chain: usize) -> &'a Step {
        let first = self.laid.chains[chain].start;
        &self.moves[self.laid.beads[first].step as usize]
    }

    /// A patch hangs: a layer below is missing, unless the part itself hangs there. Where that is
    /// not known, plastic a layer or two lower tells.
    fn begins(&mut self, chains: &[usize], length: f64) -> Option<Start> {
        let beads =
            chains.iter().flat_map(|&chain| &self.laid.beads[self.laid.chains[chain].clone()]);
        let samples = beads.flat_map(|bead| Samples::of(&self.moves[bead.step as usize], PITCH));
        let all: Vec<Sample> = samples.collect();
        let step = self.first(chains[0]);
        let hangs = |sample: &Sample| match self.part {
            Some(part) => part.hangs(self.layer, sample.at),
            None => {
                let low = lower_side(step, sample.z) - MOST_MISSING * f64::from(step.height);
                low <= 0.0 || !self.ground.stands(sample.at, low)
            }
        };
        let (by_part, own): (Vec<Sample>, Vec<Sample>) = all.iter().copied().partition(hangs);
        let middle = |of: &[Sample]| of.get(of.len() / 2).map(|sample| sample.at.map(short));
        let at = |of: &[Sample]| Place { at_mm: middle(of), ..place(self.layer, step) };
        if length >= LEAST_PATCH && self.part.is_some() {
            self.measured.part_hangs += length_of(&by_part);
        }
        if length_of(&own) >= LEAST_PATCH {
            let what = step.role.name();
            let text = format!("{} mm of {what} have nothing under them", short(length_of(&own)));
            let finding = Finding::of(Code::InTheAir, length_of(&own), "mm", text);
            self.found.push(finding.at(at(&own)));
            return None;
        }
        Some(Start {
            place: at(&all),
            role: step.role,
            length,
            bottom: step.heights()[0] - f64::from(step.height),
        })
    }
}

/// Whether lines of this role are printed beside the part, which does not stand by them.
fn is_beside(role: Role) -> bool {
    matches!(role, Role::Support | Role::Adhesion)
}
