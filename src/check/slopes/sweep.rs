//! Moves in the file's order + the head -> findings of what of it touches plastic that stands.
//!
//! Words used here: the *tip* is the place of the nozzle; a *touch* is a cell of what stands that is
//! higher than the head's underside over it; *press* is a touch that does no harm.
//!
//! - Only files with lines over slopes are swept: in others nothing stands higher than the tip, but for
//!   what `through-print` and `falling-z` judge. Of such files only moves count whose tip lies below the
//!   highest plastic.
//! - While printing, and where the nozzle goes straight down to print, the flat may press into what is soft
//!   yet: within its diameter of the tip, and no deeper than [`DEEPEST_PRESS`] layers, one for the slope
//!   and half a one for the tread of a staircase. Where a travel ends a line begins: there that holds, too.
//! - All other touches of more than [`TOLERANCE`] are hits. From [`MOST_MEASURED`] hits on only whether a move
//!   hits is looked for, not where it does so the deepest.
//! - Most of a way is clear at a glance: the lowest place of it and the head over all of its places leave all
//!   blocks of the map be. Where one is not, each half of the way is looked at for itself.

use super::relief::{Relief, Square};
use crate::check::finding::{Code, Finding, Findings, Place, short};
use crate::geom::segment;
use crate::head::shape::Shape;
use crate::head::{DEEPEST_PRESS, Head, Part};
use crate::reader::print::Step;
use std::cell::Cell;
use std::ops::Range;

/// Distance of the places that are looked at, mm.
const STEP: f64 = 0.25;

/// So many places are looked at of one move: of a longer one every so often.
const MOST_PLACES: f64 = 20_000.0;

/// Touches that are less deep are rounding, mm.
const TOLERANCE: f64 = 0.02;

/// How much higher the map may be than what stands, mm: lines are wider by half a cell's diagonal and higher
/// by what they rise over it, on a slope of 22 degrees.
const BOUND: f64 = 0.06;

/// Squares in which no touch can be this many times as deep as one that is known are left out: a flat head
/// touches all of a slope at once.
const CLOSE: f64 = 1.05;

/// Hits of a file of which each is measured at its deepest: many more than are listed.
const MOST_MEASURED: usize = 1000;

/// Places of a way that are looked at one by one, not at a glance.
const FEW: usize = 3;

/// See the head of this file.
pub(crate) struct Sweep<'a> {
    head: &'a Head,
    shape: Shape<'a>,
    press: f64,
    hits: usize,
    /// Whether nobody knows how high the nozzle is.
    is_lost: bool,
}

/// The way of a move, at whose places the head is looked at.
struct Way {
    from: [f64; 3],
    way: [f64; 3],
    /// Places, of which the last is its end.
    count: usize,
    /// How far the head reaches with what may touch anything, mm.
    reach: f64,
    /// How deep a press may be on it, and at its end, mm.
    most: [f64; 2],
}

impl Way {
    /// A place of it, counted from 1.
    fn place(&self, k: usize) -> [f64; 3] {
        segment::along(self.from, k as f64 / self.count as f64, self.way)
    }
}

/// The deepest touch of a move that is no press.
#[derive(Debug, Clone, Copy)]
struct Hit {
    depth: f64,
    at: [f64; 2],
    part: Part,
}

impl<'a> Sweep<'a> {
    pub(crate) fn new(head: &'a Head) -> Self {
        let (shape, press) = (Shape::of(head), head.press_radius());
        Self { head, shape, press, hits: 0, is_lost: false }
    }

    /// The nozzle is sent to where only the printer knows.
    pub(crate) fn lose(&mut self) {
        self.is_lost = true;
    }

    /// The next move of the file, in a layer of this height, mm.
    pub(crate) fn step(&mut self, step: &Step, relief: &Relief, height: f64, found: &mut Findings) {
        self.is_lost &= step.to[2] == 0.0;
        let is_aside = step.from[..2] != step.to[..2];
        let sinks = step.to[2] < step.from[2];
        let is_low = step.heights()[0] < relief.highest() - TOLERANCE;
        if self.is_lost || !is_low || !(is_aside || sinks) {
            return;
        }
        let (from, to) = (step.from.map(f64::from), step.to.map(f64::from));
        let count = (step.plan_length() / STEP).ceil().clamp(1.0, MOST_PLACES) as usize;
        let most = DEEPEST_PRESS * height + BOUND;
        let way = Way {
            from,
            way: segment::way(from, to),
            count,
            // Nothing stands higher than this above the tip.
            reach: self.head.reach_below(relief.highest() - step.heights()[0]),
            // Down to a line, and where a travel ends: there one begins.
            most: [if step.is_line() || !is_aside { most } else { TOLERANCE }, most],
        };
        // What a way begins with is where the one before has ended.
        if let Some(hit) = self.places(relief, &way, 1..count + 1, None) {
            self.hits += 1;
            found.add(told(&hit, step));
        }
    }

    /// The deepest touch at some places of a way, if that is deeper than the worst so far.
    fn places(
        &self,
        relief: &Relief,
        way: &Way,
        places: Range<usize>,
        mut worst: Option<Hit>,
    ) -> Option<Hit> {
        let is_enough = |worst: Option<Hit>| worst.is_some() && self.hits >= MOST_MEASURED;
        if is_enough(worst) || !self.may_touch(relief, way, &places) {
            return worst;
        }
        if places.len() > FEW {
            let middle = places.start + places.len() / 2;
            worst = self.places(relief, way, places.start..middle, worst);
            return self.places(relief, way, middle..places.end, worst);
        }
        for k in places {
            if is_enough(worst) {
                break;
            }
            let deeper = worst.map_or(0.0, |worst| worst.depth);
            let most = way.most[usize::from(k == way.count)];
            worst = self.touch(relief, (way.place(k), way.reach), (most, deeper)).or(worst);
        }
        worst
    }

    /// Whether any block of what stands may be in the head's way at some places of a way.
    fn may_touch(&self, relief: &Relief, way: &Way, places: &Range<usize>) -> bool {
        let [a, b] = [way.place(places.start), way.place(places.end - 1)];
        let low = [0, 1, 2].map(|axis: usize| a[axis].min(b[axis]));
        let high = [0, 1].map(|axis: usize| a[axis].max(b[axis]));
        let reach = way.reach;
        let area = [[low[0] - reach, low[1] - reach], high.map(|at| at + reach)];
        relief.any(area, &|square, highest| {
            highest > low[2] + TOLERANCE && {
                let near = [0, 1].map(|axis: usize| square.low[axis] - high[axis]);
                let far = [0, 1].map(|axis: usize| square.low[axis] + square.side - low[axis]);
                highest > low[2] + self.shape.lowest(near, far).0 + TOLERANCE
            }
        })
    }

    /// The underside over a place beside the tip, mm above it, and its part.
    fn underside(&self, by: [f64; 2]) -> Option<(f64, Part)> {
        let (z, part) = self.shape.lowest(by, by);
        part.map(|part| (z, part))
    }

    /// The deepest touch there that is deeper than `least`, but for those within the flat's diameter that are
    /// no deeper than `most`.
    fn touch(
        &self,
        relief: &Relief,
        ([x, y, z], reach): ([f64; 3], f64),
        (most, least): (f64, f64),
    ) -> Option<Hit> {
        // What is found first lets most other squares be.
        let deepest = Cell::new(least.max(TOLERANCE));
        let beside = |square: Square| {
            let low = [square.low[0] - x, square.low[1] - y];
            (low, low.map(|at| at + square.side))
        };
        let counts = |square: Square, highest: f64| {
            let least = CLOSE * deepest.get();
            // Most lies lower than the tip: no look at the head.
            highest > z + least && {
                let (low, high) = beside(square);
                highest > z + self.shape.lowest(low, high).0 + least
            }
        };
        let mut worst = None;
        relief.look([x, y], reach, &counts, &mut |square, top| {
            if !counts(square, top) {
                return;
            }
            let (low, high) = beside(square);
            let middle = [0, 1].map(|axis: usize| 0.5 * (low[axis] + high[axis]));
            let own = self.underside(middle);
            let away = middle[0] * middle[0] + middle[1] * middle[1];
            let is_near = away <= self.press * self.press;
            // Near the tip by the cell's middle: its nearest corner would press where nothing does, and
            // on a steep slope the flank be deep in what it only comes near to.
            let is_beside = away <= 4.0 * self.press * self.press;
            let under = own
                .filter(|_| is_beside)
                .map_or(self.shape.lowest(low, high).0, |(under, _)| under);
            let depth = top - z - under;
            if depth <= deepest.get() || (is_near && depth <= most) {
                return;
            }
            deepest.set(depth);
            let near = [0, 1].map(|axis: usize| 0.0_f64.clamp(low[axis], high[axis]));
            let nearest = || self.underside(near).or(own);
            let lowest = own.filter(|_| is_beside).or_else(nearest);
            let part = lowest.map_or(Part::Box(0), |(_, part)| part);
            worst = Some(Hit { depth, at: [x + middle[0], y + middle[1]], part });
        });
        worst
    }
}

fn told(hit: &Hit, step: &Step) -> Finding {
    let part = match hit.part {
        Part::Flat => "the nozzle's flat".to_owned(),
        Part::Cone => "the nozzle's cone".to_owned(),
        Part::Disc(k) => format!("disc {} of the head", k + 1),
        Part::Box(k) => format!("box {} of the head", k + 1),
    };
    let what = if step.is_line() { step.role.name() } else { "travel" };
    let text =
        format!("{part} is {} mm deep in what stands, on the way of {what}", short(hit.depth));
    // The line and the layer are the move's.
    let place = Place { at_mm: Some(hit.at.map(short)), ..Place::default() };
    Finding::of(Code::HeadHits, hit.depth, "mm", text).at(place)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::head::named::named;
    use crate::reader::Role;
    use proptest::prelude::*;

    fn step(from: [f32; 3], to: [f32; 3], filament: f32) -> Step {
        let (feed, width, height) = (30.0, 0.4, 0.2);
        Step { from, to, filament, feed, width, height, role: Role::NonPlanar, line: 1 }
    }

    /// What is found of a move beside a wall along y at x = 0, 10 mm high.
    fn beside(head: &Head, one: Step) -> Vec<Finding> {
        let mut relief = Relief::default();
        relief.lay(&step([0.0, 0.0, 10.0], [0.0, 20.0, 10.0], 1.0), false, [None; 2]);
        let mut found = Findings::default();
        Sweep::new(head).step(&one, &relief, 0.2, &mut found);
        found.into_iter().collect()
    }

    #[test]
    fn each_part_of_the_head_hits_where_it_hangs() {
        let head = named("v6").unwrap();
        // The wall's side lies at x = 0.2, and a cell may be as much wider.
        for (x, z, part, depth) in
            [(1.25_f32, 9.0_f32, "cone", 0.4), (4.0, 7.5, "disc 1", 0.5), (14.5, 4.5, "box 1", 0.5)]
        {
            let one = step([x, 2.0, z], [x, 18.0, z], 0.0);
            let found = beside(&head, one);
            let [hit] = &found[..] else { panic!("{found:?}") };
            assert!(hit.text.contains(part), "{hit}");
            assert!((hit.measure - depth).abs() < 0.15, "{hit}");
            let clear = beside(&head, step([x, 2.0, z + 0.6], [x, 18.0, z + 0.6], 0.0));
            assert_eq!(clear, [], "{part}");
        }
        // Over the box, beyond its end and beside it.
        let at = |x: f32| step([x, 2.0, 1.0], [x, 18.0, 1.0], 0.0);
        assert_eq!(beside(&head, at(15.4)), []);
        assert_eq!(beside(&head, at(-8.4)), []);
        assert!(!beside(&head, at(-8.0)).is_empty());
    }

    #[test]
    fn printing_may_press_and_travels_may_not() {
        let head = named("v6").unwrap();
        let at = |z: f32, filament: f32| step([0.5, 2.0, z], [0.5, 18.0, z], filament);
        assert_eq!(beside(&head, at(9.75, 1.0)), []);
        assert!((beside(&head, at(9.6, 1.0))[0].measure - 0.4).abs() < 1e-3);
        assert!((beside(&head, at(9.75, 0.0))[0].measure - 0.25).abs() < 1e-3);
        assert_eq!(beside(&head, at(9.99, 0.0)), []);
        // Down to a line, and up from anywhere.
        let sinks = |to: f32| step([0.5, 5.0, 12.0], [0.5, 5.0, to], 0.0);
        assert_eq!(beside(&head, sinks(9.75)), []);
        assert!(!beside(&head, sinks(9.0)).is_empty());
        assert_eq!(beside(&head, step([0.5, 5.0, 9.0], [0.5, 5.0, 12.0], 0.0)), []);
    }

    #[test]
    fn hits_are_counted_on_where_they_are_not_measured_any_more() {
        let head = named("v6").unwrap();
        let mut relief = Relief::default();
        relief.lay(&step([0.0, 0.0, 10.0], [0.0, 20.0, 10.0], 1.0), false, [None; 2]);
        let (mut sweep, mut found) = (Sweep::new(&head), Findings::default());
        let all = MOST_MEASURED + 50;
        for _ in 0..all {
            sweep.step(&step([0.5, 2.0, 9.0], [0.5, 18.0, 5.0], 0.0), &relief, 0.2, &mut found);
        }
        assert_eq!(found.len(), all);
        let depths: Vec<f64> = found.into_iter().map(|hit| hit.measure).collect();
        assert!(depths[0] > 4.9 && depths[all - 1] > 1.0 && depths[all - 1] < 1.2, "{depths:?}");
    }

    /// A place in a box of 20 mm, 5 mm high.
    fn any_place() -> impl Strategy<Value = [f32; 3]> {
        (0.0..20.0_f32, 0.0..20.0_f32, 0.0..5.0_f32).prop_map(|(x, y, z)| [x, y, z])
    }

    proptest! {
        #[test]
        fn a_glance_overlooks_nothing(
            lines in prop::collection::vec((any_place(), any_place()), 1..6),
            (from, to) in (any_place(), any_place()),
            prints in any::<bool>(),
            name in prop::sample::select(vec!["v6", "cautious", "long-0.6"]),
        ) {
            let head = named(name).unwrap();
            let mut relief = Relief::default();
            lines.iter().for_each(|(from, to)| relief.lay(&step(*from, *to, 1.0), false, [None; 2]));
            let one = step(from, to, if prints { 1.0 } else { 0.0 });
            let (mut sweep, mut found) = (Sweep::new(&head), Findings::default());
            sweep.step(&one, &relief, 0.2, &mut found);
            let count = (one.plan_length() / STEP).ceil().max(1.0) as usize;
            let (start, end) = (one.from.map(f64::from), one.to.map(f64::from));
            let way = Way { from: start, way: segment::way(start, end), count, reach: 99.0, most: [0.0; 2] };
            let press = DEEPEST_PRESS * 0.2 + BOUND;
            let mut worst: Option<Hit> = None;
            for k in 1..=count {
                let most = if prints || k == count { press } else { TOLERANCE };
                let deeper = worst.map_or(0.0, |worst| worst.depth);
                worst = sweep.touch(&relief, (way.place(k), way.reach), (most, deeper)).or(worst);
            }
            let depth = found.into_iter().next().map(|hit| hit.measure);
            // A move above all that stands is not looked at.
            let is_low = one.heights()[0] < relief.highest() - TOLERANCE;
            prop_assert_eq!(depth, worst.filter(|_| is_low).map(|hit| hit.depth));
        }
    }
}
