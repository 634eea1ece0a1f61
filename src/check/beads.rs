//! Print + Terms -> findings of amounts: lines with odd plastic, narrow lines, and the file's own sums.
//!
//! Words used here: the *ratio* of a line is its plastic over the room of its size; what is *usual* is the
//! middle one of the ratios of a role; a *fade* is lines at an end of a chain that take more and more plastic.
//!
//! - A line is odd whose ratio is far from the usual one of its role.
//! - A line is narrow that, as high as it is, takes too little plastic to be as wide as the nozzle's hole.
//! - Fades of other slicers are neither: they are seams.
//! - The file's own sums are compared with those of its moves.

use super::finding::{Code, Finding, Findings, Place, short};
use super::terms::Terms;
use crate::reader::print::Step;
use crate::reader::{Facts, Role};
use std::ops::Range;

/// Shorter lines are not judged, mm: their plastic is mostly rounding.
const LEAST_LENGTH: f64 = 0.5;

/// A line may take this many times the plastic of its role's usual line of that size:
/// well below a line that is printed twice, well above what flow factors make of one, …
const MOST: f64 = 1.6;

/// … or this: above a line that got half of its plastic.
const LEAST: f64 = 0.55;

/// The most where no comment gives widths: there a wide line of the role takes several times a thin
/// one's plastic.
const MOST_WITHOUT_WIDTH: f64 = 4.0;

/// Least number of lines of a role: of fewer none is usual.
pub(super) const LEAST_LINES: u64 = 20;

/// A line narrower than this many nozzles is drawn thinner than it can be laid: it breaks, or curls
/// up. The thinnest that slicers lay on purpose are 0.85 wide.
const NARROW: f64 = 0.7;

/// So much of a line may be narrow, mm: where it tapers.
const LEAST_NARROW: f64 = 1.0;

/// Lines of a fade at least, and the plastic of its faintest as a part of that of the line it leads to.
const LEAST_FADE: usize = 4;
const FAINT: f64 = 0.4;

/// How far the file's own sums may be off: a part of 1, and mm. Some count primed filament.
const SUM_SLACK: (f64, f64) = (0.01, 1.0);

/// Lines of a layer whose plastic does not fit their size, with their roles. `usual` is what lines of
/// each role take as a rule.
pub(super) fn odd(
    (facts, terms): (&Facts, &Terms),
    (layer, moves): (usize, &[Step]),
    usual: &[Option<Usual>; Role::ALL.len()],
) -> Vec<(Role, Finding)> {
    let mut found = Vec::new();
    let fades = fades((facts, terms), moves);
    let is_known = |k: &usize| fades.iter().any(|fade| fade.contains(k));
    let judged = moves.iter().enumerate().filter(|(k, step)| is_judged(step) && !is_known(k));
    for (_, step) in judged {
        let Some(usual) = usual[step.role as usize] else { continue };
        let times = ratio(facts, terms, step) / usual.ratio;
        let is_odd = if facts.has_widths {
            !(LEAST..=MOST).contains(&times)
        } else {
            // The first layer on a raft is pressed into less than its height.
            times > MOST_WITHOUT_WIDTH && thick(terms, step) > MOST * usual.thick
        };
        if is_odd {
            let text = format!(
                "{} times the plastic that {} lines of this size take",
                short(times),
                step.role.name()
            );
            let measure = if times > 1.0 { times } else { 1.0 / times };
            let finding = Finding::of(Code::OddBead, measure, "times", text);
            found.push((step.role, Finding { place: place(layer, step), ..finding }));
        }
    }
    found
}

/// What lines of a role take as a rule.
#[derive(Debug, Clone, Copy)]
pub(super) struct Usual {
    /// See [`ratio`].
    pub(super) ratio: f64,
    /// See [`thick`], mm².
    pub(super) thick: f64,
}

/// The plastic of a mm of a line as it is from above, mm².
pub(super) fn thick(terms: &Terms, step: &Step) -> f64 {
    f64::from(step.filament) * terms.filament_area / step.plan_length()
}

/// The plastic of a line by its size, less what the layer on the bed gets more on purpose.
pub(super) fn ratio(facts: &Facts, terms: &Terms, step: &Step) -> f64 {
    let plastic = f64::from(step.filament) * terms.filament_area;
    plastic / (room(facts, step) * terms.pressed(step))
}

/// Lines of a layer that stay too narrow for the nozzle. Their width is that of their height and
/// plastic, whatever the file says.
pub(super) fn narrow(
    (facts, terms): (&Facts, &Terms),
    (layer, steps): (usize, &[Step]),
) -> Vec<Finding> {
    let mut found = Vec::new();
    let Some(nozzle) = terms.nozzle else { return found };
    // What irons is pressed flat on what is there.
    let is_narrow = |step: &Step| {
        step.is_line()
            && step.role != Role::Ironing
            && terms.width_by_plastic(step) < NARROW * nozzle
    };
    let fades = fades((facts, terms), steps);
    let mut first = 0;
    for run in steps.chunk_by(|a, b| is_narrow(a) && is_narrow(b) && a.to == b.from) {
        let at = first;
        first += run.len();
        if !is_narrow(&run[0]) || fades.iter().any(|fade| fade.contains(&at)) {
            continue;
        }
        let length: f64 = run.iter().map(Step::length).sum();
        if length <= LEAST_NARROW {
            continue;
        }
        let mean = run.iter().map(|step| terms.width_by_plastic(step) * step.length()).sum::<f64>()
            / length;
        let role = run[0].role.name();
        let text = format!("{} mm of {role} are {} mm wide", short(length), short(mean));
        let middle = &run[run.len() / 2];
        let finding = Finding::warning(Code::NarrowBead, length, "mm", text);
        found.push(finding.at(place(layer, middle)));
    }
    found
}

/// Lines by which walls of other slicers fade in and out where a scarf seam laps over itself: at the beginning
/// or the end of a chain, from little plastic on each line takes more than the one nearer to its end.
fn fades((facts, terms): (&Facts, &Terms), moves: &[Step]) -> Vec<Range<usize>> {
    let mut fades = Vec::new();
    if terms.is_own {
        return fades;
    }
    let mut first = 0;
    for chain in moves.chunk_by(|a, b| a.is_line() && b.is_line() && a.to == b.from) {
        let count = chain.len();
        let ratio = |k: usize| ratio(facts, terms, &chain[k]);
        let grows = |at: &dyn Fn(usize) -> usize| {
            let steps = (1..count).take_while(|&k| ratio(at(k - 1)) < ratio(at(k))).count();
            let is_fade = steps >= LEAST_FADE && ratio(at(0)) < FAINT * ratio(at(steps));
            if is_fade { steps } else { 0 }
        };
        if count > LEAST_FADE {
            let (up, down) = (grows(&|k| k), grows(&|k| count - 1 - k));
            fades.extend([first..first + up, first + count - down..first + count]);
        }
        first += count;
    }
    fades.retain(|fade| !fade.is_empty());
    fades
}

/// Whether a line is long enough to be judged.
pub(super) fn is_judged(step: &Step) -> bool {
    step.is_line() && step.length() >= LEAST_LENGTH
}

/// The room that a line's plastic is compared with, mm³: its length from above times its height and,
/// if the file gives it, its width.
fn room(facts: &Facts, step: &Step) -> f64 {
    let width = if facts.has_widths { f64::from(step.width) } else { 1.0 };
    step.plan_length() * width * f64::from(step.height)
}

/// Where a move of a layer, from 0, ends.
pub(super) fn place(layer: usize, step: &Step) -> Place {
    let [x, y, z] = step.to.map(f64::from);
    Place {
        line: Some(u64::from(step.line)),
        layer: Some(layer + 1),
        z_mm: Some(short(z)),
        at_mm: Some([short(x), short(y)]),
    }
}

/// Compares filament and layers with the sums in the file's comments.
/// `used` is what the moves up to the last line take, of the whole file and from the first layer on.
pub(super) fn sums(facts: &Facts, used: [f64; 2], found: &mut Findings) {
    let sum_of = |keys: &[&str]| {
        let text = keys.iter().find_map(|key| facts.value(key))?;
        let parts: Option<Vec<f64>> = text.split(',').map(|one| one.trim().parse().ok()).collect();
        parts.map(|parts| parts.iter().sum::<f64>()).filter(|sum| sum.is_finite())
    };
    if let Some(stated) = sum_of(&["filament used [mm]"]) {
        let fits = |sum: &f64| (sum - stated).abs() <= SUM_SLACK.0 * stated + SUM_SLACK.1;
        // Some slicers count the start block, some do not.
        if !used.iter().any(fits) {
            let text = format!(
                "the file says that it uses {} mm of filament, but uses {}",
                short(stated),
                short(used[1])
            );
            let measure = (used[1] - stated).abs();
            found.add(Finding::of(Code::WrongSums, measure, "mm", text));
        }
    }
    if let Some(stated) = sum_of(&["total layers count", "layers"]) {
        // A layer may have nothing to print.
        let count = facts.begun as f64;
        if count != stated {
            let text = format!("the file says that it has {stated} layers, but has {count}");
            found.add(Finding::of(Code::WrongSums, (count - stated).abs(), "layers", text));
        }
    }
}
