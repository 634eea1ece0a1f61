//! Lines of two files -> Apart: what of one's lines is not where the other has any, or not as thick.
//!
//! Words used here: *far* is what of a line is farther than the tolerance from all lines of the other
//! file; *unlike* is what lies in the same place as others, but none of them with as much filament
//! per mm; a *gap* is a range of a line that none of the others covers; the *ceiling* of a gap is a
//! bound on how far any of its places is.
//!
//! 1. For each line the others nearby are found: first the neighbours of the last match, since files
//!    often have their lines in the same or in the opposite order, then by a grid.
//! 2. Each covers a part of the line. What no part covers is far; what only parts with another amount
//!    of filament cover is unlike. Both are summed up exactly.
//!    Of lines with the same ends each has one counterpart: a line that is drawn twice where the other file
//!    draws it once is unlike.
//! 3. The farthest place of all is searched in the gaps by branch and bound: the gap with the
//!    highest ceiling is halved and measured in the middle, until no ceiling exceeds the farthest
//!    place known. A ceiling follows from the ends: a distance grows no faster than the way, and to a
//!    convex line it is convex.

use super::grid::Grid;
use super::line::{Line, Part, Point};
use std::cell::OnceCell;
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// Distance beyond a tolerance that is still within it, mm: a file's decimals are not exact in binary.
pub(super) const SLACK: f64 = 1e-4;

/// Largest gap between parts of a line that is only rounding, as a share of the line.
const NO_GAP: f64 = 1e-9;

/// Accuracy of the largest distance, mm; halving it costs a step of the search for each gap.
const EXACT: f64 = 1e-3;

/// A part of a line that the other file has not, or not as thick.
#[derive(Debug, Clone, Copy)]
pub(super) struct Mark {
    pub(super) from: Point,
    pub(super) to: Point,
    /// mm.
    pub(super) width: f64,
}

/// What of some lines has no counterpart among others.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Apart {
    /// Length farther than the tolerance from all of the others, mm.
    pub(super) far: f64,
    /// The place farthest from them; `None` if none is too far, or if there are no others.
    pub(super) farthest: Option<Farthest>,
    /// Length where the others are, but none with as much filament for each mm, mm.
    pub(super) unlike: f64,
    /// The line whose filament differs most there.
    pub(super) most_unlike: Option<Unlike>,
}

/// A place that is far from all lines of the other file.
#[derive(Debug, Clone, Copy)]
pub(super) struct Farthest {
    /// mm.
    pub(super) distance: f64,
    /// Where; the height is above the layer, mm.
    pub(super) at: Point,
    /// Its line of the file, from 1.
    pub(super) number: u32,
    /// The nearest line of the other file, from 1.
    pub(super) nearest: u32,
}

/// Two lines in the same place with another amount of filament.
#[derive(Debug, Clone, Copy)]
pub(super) struct Unlike {
    /// The middle of the part that lies in the same place; the height is above the layer, mm.
    pub(super) at: Point,
    /// The line.
    pub(super) line: Line,
    /// The other one.
    pub(super) other: Line,
}

impl Unlike {
    /// How much the amounts of filament differ, over the larger one.
    pub(super) fn share(&self) -> f64 {
        let (one, other) = (self.line.flow, self.other.flow);
        (one - other).abs() / one.max(other)
    }
}

/// Compares `lines` with `others`: places by `reach` in mm, filament for each mm by `share`.
pub(super) fn apart<'a>(lines: &'a [Line], others: &'a [Line], reach: f64, share: f64) -> Apart {
    if others.is_empty() {
        let far = lines.iter().map(|line| line.length).fold(0.0, |sum, length| sum + length);
        return Apart { far, ..Apart::default() };
    }
    let mut search = Search::new(others, reach, share);
    lines.iter().for_each(|line| search.line(line));
    search.farthest();
    search.found
}

/// The parts of `lines` that [`apart`] finds.
pub(super) fn marks(lines: &[Line], others: &[Line], reach: f64, share: f64) -> Vec<Mark> {
    if others.is_empty() {
        return lines.iter().map(|line| line.mark([0.0, 1.0])).collect();
    }
    let mut search = Search::new(others, reach, share);
    lines.iter().for_each(|line| search.line(line));
    search.marks
}

struct Search<'a> {
    others: &'a [Line],
    reach: f64,
    share: f64,
    /// Only made when it is needed: equal files do without.
    grid: OnceCell<Grid<'a>>,
    /// The last of the others that was a counterpart.
    last: usize,
    /// Which of the others are counterparts of lines with the same ends already.
    taken: Vec<bool>,
    /// Others that may be near a line.
    near: Vec<usize>,
    /// Gaps in which the farthest place is searched.
    open: Vec<Open<'a>>,
    /// What is far or unlike.
    marks: Vec<Mark>,
    found: Apart,
}

/// A part of a line whose farthest place is looked for.
struct Open<'a> {
    line: &'a Line,
    ends: [Probe; 2],
    /// No place of it is farther than this, mm.
    ceiling: f64,
}

/// A part of a line where another one lies.
#[derive(Clone, Copy)]
struct Covered {
    part: Part,
    by: usize,
    as_thick: bool,
}

impl<'a> Search<'a> {
    /// Among `others`, of which there is at least one.
    fn new(others: &'a [Line], reach: f64, share: f64) -> Self {
        Self {
            others,
            reach: reach + SLACK,
            share,
            grid: OnceCell::new(),
            last: usize::MAX,
            taken: vec![false; others.len()],
            near: Vec::new(),
            open: Vec::new(),
            marks: Vec::new(),
            found: Apart::default(),
        }
    }

    fn grid(&self) -> &Grid<'a> {
        self.grid.get_or_init(|| Grid::new(self.others))
    }

    fn covered(&self, line: &Line, by: usize) -> Option<Covered> {
        let other = self.others.get(by)?;
        let part = line.part_near(other, self.reach)?;
        let as_thick = line.is_as_thick(other, self.share, self.reach);
        Some(Covered { part, by, as_thick })
    }

    fn line(&mut self, line: &'a Line) {
        // Lines often follow in the same order in both files, or in the opposite one.
        for guess in [self.last.wrapping_add(1), self.last.wrapping_sub(1)] {
            let covered = self.covered(line, guess);
            if covered.is_some_and(|covered| covered.is_all()) && self.take(line, guess) {
                self.last = guess;
                return;
            }
        }
        let mut near = std::mem::take(&mut self.near);
        near.clear();
        self.grid().near(line, self.reach, &mut |index| near.push(index));
        near.sort_unstable();
        near.dedup();
        let (mut covered, mut taken) = (Vec::new(), None);
        for &index in &near {
            let Some(one) = self.covered(line, index) else { continue };
            if one.is_all() && self.take(line, index) {
                self.last = index;
                self.near = near;
                return;
            }
            taken = taken.or(one.is_all().then_some(index));
            covered.push(one);
        }
        self.near = near;
        match taken {
            Some(index) => self.twice(line, index),
            None => self.judge(line, &covered),
        }
    }

    /// Whether another line may be a counterpart: not if it has the same ends and is one already.
    fn take(&mut self, line: &Line, by: usize) -> bool {
        // Ways without plastic may be gone again.
        let is_twin = line.flow > 0.0 && line.has_ends_of(&self.others[by], self.reach);
        !is_twin || !std::mem::replace(&mut self.taken[by], true)
    }

    /// The other file draws a line once which this one draws again: with it there is twice the plastic.
    fn twice(&mut self, line: &Line, by: usize) {
        self.marks.push(line.mark([0.0, 1.0]));
        self.found.unlike += line.length;
        let double = Line { flow: 2.0 * line.flow, ..*line };
        let all = Covered { part: [0.0, 1.0], by, as_thick: false };
        self.offer_unlike(&double, &all);
    }

    /// Adds up what is not covered, or not by lines as thick.
    fn judge(&mut self, line: &'a Line, covered: &[Covered]) {
        let far = gaps(covered.to_vec());
        let unlike = gaps(covered.iter().filter(|one| one.as_thick).copied().collect());
        let length = |gaps: &[Gap]| {
            gaps.iter().map(|gap| (gap.to.0 - gap.from.0) * line.length).sum::<f64>()
        };
        let (far_length, unlike_length) = (length(&far), length(&unlike));
        self.marks.extend(unlike.iter().map(|gap| line.mark([gap.from.0, gap.to.0])));
        self.found.far += far_length;
        if unlike_length - far_length > NO_GAP * line.length {
            self.found.unlike += unlike_length - far_length;
            let size = |one: &Covered| one.part[1] - one.part[0];
            let thick = covered.iter().filter(|one| !one.as_thick);
            let largest = thick.reduce(|a, b| if size(b) > size(a) { b } else { a });
            if let Some(one) = largest {
                self.offer_unlike(line, one);
            }
        }
        for gap in far {
            let ends = [gap.from, gap.to].map(|end| self.end(line, end));
            let ceiling = self.ceiling(line, &ends);
            self.open.push(Open { line, ends, ceiling });
        }
    }

    /// Where a gap ends, its distance is known, unless it is the line's own end.
    fn end(&mut self, line: &Line, (t, by): (f64, Option<usize>)) -> Probe {
        match by {
            Some(nearest) => Probe { t, distance: self.reach, nearest },
            None => self.probe(line, t),
        }
    }

    fn offer_unlike(&mut self, line: &Line, covered: &Covered) {
        let at = line.at(0.5 * (covered.part[0] + covered.part[1]));
        let unlike = Unlike { at, line: *line, other: self.others[covered.by] };
        if self.found.most_unlike.is_none_or(|most| unlike.share() > most.share()) {
            self.found.most_unlike = Some(unlike);
        }
    }

    /// Looks for the farthest place of all: what may hold it is halved, the best hope first.
    fn farthest(&mut self) {
        let mut open = BinaryHeap::from(std::mem::take(&mut self.open));
        while let Some(Open { line, ends: [a, b], ceiling }) = open.pop() {
            if self.found.farthest.is_some_and(|known| ceiling <= known.distance + EXACT) {
                break;
            }
            let middle = self.probe(line, 0.5 * (a.t + b.t));
            for ends in [[a, middle], [middle, b]] {
                let ceiling = self.ceiling(line, &ends);
                open.push(Open { line, ends, ceiling });
            }
        }
    }

    fn probe(&mut self, line: &Line, t: f64) -> Probe {
        let at = line.at(t);
        let (distance, nearest) = self.grid().nearest(at);
        if self.found.farthest.is_none_or(|farthest| distance > farthest.distance) {
            let nearest = self.others[nearest].number;
            self.found.farthest = Some(Farthest { distance, at, number: line.number, nearest });
        }
        Probe { t, distance, nearest }
    }

    /// No place between the two is farther from the others than this, mm: either of the two
    /// nearest lines is a convex thing, and a distance grows no faster than the way.
    fn ceiling(&self, line: &Line, [a, b]: &[Probe; 2]) -> f64 {
        let to = |probe: &Probe, t: f64| self.others[probe.nearest].distance(line.at(t));
        let by_way = 0.5 * (a.distance + b.distance + (b.t - a.t) * line.length);
        by_way.min(a.distance.max(to(a, b.t))).min(b.distance.max(to(b, a.t)))
    }
}

impl Line {
    fn mark(&self, [from, to]: Part) -> Mark {
        Mark { from: self.at(from), to: self.at(to), width: self.section[0] }
    }
}

/// How far a place of a line is from the others.
#[derive(Clone, Copy)]
struct Probe {
    t: f64,
    distance: f64,
    nearest: usize,
}

impl Covered {
    /// Whether nothing of the line is left, and it is as thick.
    fn is_all(&self) -> bool {
        self.as_thick && self.part[0] <= 0.0 && self.part[1] >= 1.0
    }
}

impl Ord for Open<'_> {
    fn cmp(&self, other: &Self) -> Ordering {
        self.ceiling.total_cmp(&other.ceiling)
    }
}

impl PartialOrd for Open<'_> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Eq for Open<'_> {}

impl PartialEq for Open<'_> {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

/// A part that nothing covers: its ends, and which of the others covers what lies beyond.
struct Gap {
    from: (f64, Option<usize>),
    to: (f64, Option<usize>),
}

/// What the parts leave of 0 to 1.
fn gaps(mut parts: Vec<Covered>) -> Vec<Gap> {
    parts.sort_by(|a, b| a.part[0].total_cmp(&b.part[0]));
    let mut gaps = Vec::new();
    let mut reached = (0.0, None);
    for Covered { part: [low, high], by, .. } in parts {
        if low > reached.0 + NO_GAP {
            gaps.push(Gap { from: reached, to: (low, Some(by)) });
        }
        if high >= reached.0 {
            reached = (high, Some(by));
        }
    }
    if reached.0 + NO_GAP < 1.0 {
        gaps.push(Gap { from: reached, to: (1.0, None) });
    }
    gaps
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diff::line::tests::line;

    #[test]
    fn the_farthest_place_may_lie_in_the_middle_of_a_line() {
        // Between two lines, not at an end.
        let others = [line([0.0, 0.0], [0.0, 10.0]), line([6.0, 0.0], [6.0, 10.0])];
        let found = apart(&[line([0.0, 5.0], [6.0, 5.0])], &others, 0.01, 0.001);
        let farthest = found.farthest.unwrap();
        assert!((farthest.distance - 3.0).abs() < 2.0 * EXACT, "{farthest:?}");
        assert!((farthest.at[0] - 3.0).abs() < 2.0 * EXACT);
        assert!((found.far - 5.98).abs() < 0.001, "{}", found.far);
    }

    #[test]
    fn a_line_may_be_many_and_the_other_way_round() {
        let parts: Vec<Line> =
            (0..10).map(|k| line([f64::from(k), 0.0], [f64::from(k) + 1.0, 0.003])).collect();
        let whole = [line([10.0, 0.0], [0.0, 0.0])];
        for (a, b) in [(&parts[..], &whole[..]), (&whole, &parts)] {
            let found = apart(a, b, 0.01, 0.001);
            assert!(found.far == 0.0 && found.unlike == 0.0, "{found:?}");
            assert!(found.farthest.is_none() && found.most_unlike.is_none());
        }
        let found = apart(&whole, &parts[..9], 0.01, 0.001);
        assert!((found.far - 0.99).abs() < 0.001, "{}", found.far);
        assert!((found.farthest.unwrap().distance - 1.0).abs() < 2.0 * EXACT);
    }

    #[test]
    fn thick_and_thin() {
        let thin = line([0.0, 0.0], [10.0, 0.0]);
        let thick = Line { flow: 2.0 * thin.flow, ..thin };
        let found = apart(&[thin], &[thick], 0.01, 0.001);
        assert_eq!((found.far, found.unlike), (0.0, 10.0));
        assert_eq!(found.most_unlike.unwrap().share(), 0.5);
        // With a thin one there, too, it has its counterpart.
        assert_eq!(apart(&[thin], &[thick, thin], 0.01, 0.001).unlike, 0.0);
    }

    #[test]
    fn a_line_that_is_drawn_again_has_no_counterpart() {
        let [one, other] = [line([0.0, 0.0], [10.0, 0.0]), line([0.0, 1.0], [10.0, 1.0])];
        let back = line([10.0, 0.0], [0.0, 0.0]);
        for again in [one, back] {
            let found = apart(&[one, other, again], &[one, other], 0.01, 0.001);
            assert_eq!((found.far, found.unlike), (0.0, 10.0));
            assert_eq!(found.most_unlike.unwrap().share(), 0.5);
            let twice = [other, again, one];
            assert_eq!(apart(&[one, other, again], &twice, 0.01, 0.001).unlike, 0.0);
        }
    }

    #[test]
    fn an_offset_of_all_lines_is_found_without_end() {
        let lines: Vec<Line> =
            (0..100).map(|k| line([0.0, f64::from(k)], [100.0, f64::from(k)])).collect();
        let moved: Vec<Line> = lines
            .iter()
            .map(|l| line([l.from[0], l.from[1] + 0.05], [l.to[0], l.to[1] + 0.05]))
            .collect();
        let found = apart(&lines, &moved, 0.01, 0.001);
        assert!((found.farthest.unwrap().distance - 0.05).abs() < 1e-9);
        assert!((found.far - 10_000.0).abs() < 1e-6);
    }
}
