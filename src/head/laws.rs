//! Laws of pile and sweep: what they tell is what a look at every cell tells.
//!
//! Words: a *pile* is what stands, as heights of cells; a *hit* is the deepest touch of the head, above one
//! cell; what is *spared* is no touch, such as the press of the nozzle's flat on its own surface.
//!
//! - Heads, piles and tips are random; the answer that counts looks at every cell, one by one.
//! - Searches that leave something out as a whole, by press or by distance, find the same hit.
//! - A place that passed can fail only for what rose since: it may be tried against that alone.
//! - A sweep is the deepest of its samples.

use super::pile::{Hit, LEAST_TOUCH, Pile};
use super::shape::Shape;
use super::sweep::{SAMPLE, sweep};
use super::tests::any_head;
use super::{Head, Part};
use proptest::prelude::*;

/// The deepest touch by a look at every cell.
fn brute(pile: &Pile, head: &Head, tip: [f64; 3], spare: &dyn Fn(&Hit) -> bool) -> Option<Hit> {
    let [columns, rows] = pile.size();
    let mut best: Option<Hit> = None;
    for row in 0..rows {
        for column in 0..columns {
            let at = pile.middle([column, row]);
            let half = pile.side() / 2.0;
            let edge = |sign: f64| [at[0] + sign * half - tip[0], at[1] + sign * half - tip[1]];
            let (low, high) = (edge(-1.0), edge(1.0));
            let over = Shape::of(head).lowest(low, high).0;
            let height = pile.height([column, row]);
            let hit = Hit { part: Part::Flat, depth: height - tip[2] - over, at, height, tip };
            let deeper = best.is_none_or(|best| hit.depth > best.depth);
            if hit.depth > LEAST_TOUCH && deeper && !spare(&hit) {
                best = Some(hit);
            }
        }
    }
    best
}

fn any_pile() -> impl Strategy<Value = Pile> {
    let rise = (0usize..40, 0usize..30, 1usize..20, 0.0..12.0);
    (prop::collection::vec(rise, 0..40), -3.0..3.0, 0.3..1.5).prop_map(
        |(rises, low, cell): (Vec<_>, f64, f64)| {
            let mut pile = Pile::new([low, low], [low + 40.0 * cell, low + 30.0 * cell], cell);
            for (column, row, count, z) in rises {
                pile.raise_row(row, column..column + count, z);
            }
            pile
        },
    )
}

proptest! {
    #[test]
    fn a_hit_is_the_deepest_of_all_cells(
        head in any_head(), pile in any_pile(), x in -5.0..45.0, y in -5.0..35.0, z in -1.0..12.0,
        spared in 0.0..3.0,
    ) {
        let tip = [x, y, z];
        let spare = |hit: &Hit| hit.depth < spared;
        let (hit, right) = (pile.hit(&head, tip, &spare), brute(&pile, &head, tip, &spare));
        prop_assert_eq!(hit.is_some(), right.is_some());
        if let (Some(hit), Some(right)) = (hit, right) {
            // A cell's edge is rounded in another way here.
            prop_assert!((hit.depth - right.depth).abs() < 1e-6, "{:?} {:?}", hit, right);
            prop_assert_eq!(hit.height, pile.height(pile.cell(hit.at).unwrap()));
        }
    }

    #[test]
    fn what_is_only_pressed_is_left_out(
        head in any_head(), pile in any_pile(), x in -5.0..45.0, y in -5.0..35.0, z in 5.0..12.0,
        flat in 0.5..12.0, layer_height in 0.1..2.0,
    ) {
        let (tip, head) = ([x, y, z], Head { flat, ..head });
        let right = pile.hit(&head, tip, &|hit| head.presses(hit, layer_height));
        prop_assert_eq!(pile.hit_printing(&head, tip, layer_height), right);
    }

    #[test]
    fn what_is_too_far_away_is_left_out(
        head in any_head(), pile in any_pile(), x in -5.0..45.0, y in -5.0..35.0, z in 0.0..6.0,
        radius in 0.0..12.0,
    ) {
        let tip = [x, y, z];
        let is_far = |hit: &Hit| {
            let by = [0, 1].map(|axis| (f64::abs(hit.at[axis] - tip[axis]) - pile.side() / 2.0).max(0.0));
            by[0].hypot(by[1]) > radius
        };
        let right = pile.hit(&head, tip, &is_far);
        prop_assert_eq!(pile.hit_within(&head, tip, radius, &|_| false), right);
    }

    #[test]
    fn what_passed_only_fails_for_what_rose_since(
        head in any_head(), pile in any_pile(), tip in [-1.0..9.0_f64, -1.0..9.0_f64, 0.0..8.0_f64],
        risen in prop::collection::vec(([0..40_usize, 0..30_usize], 0.0..9.0_f64), 0..20),
    ) {
        let (mut whole, mut alone) = (pile.clone(), pile.emptied());
        for &(cell, z) in &risen {
            whole.raise(cell, z);
            alone.raise(cell, whole.height(cell));
        }
        if pile.hit_printing(&head, tip, 0.2).is_none() {
            let hits = [&whole, &alone].map(|pile| pile.hit_printing(&head, tip, 0.2));
            prop_assert_eq!(hits[0], hits[1]);
        }
    }

    #[test]
    fn cells_of_a_row_rise_as_one_by_one(
        pile in any_pile(), row in 0..32_usize, column in 0..42_usize,
        heights in prop::collection::vec(prop::option::of(-1.0..6.0_f64), 0..50),
        head in any_head(), tip in [-1.0..5.0_f64, -1.0..5.0_f64, -0.5..3.0_f64],
    ) {
        let (mut one, mut other) = (pile.clone(), pile);
        one.raise_cells([column, row], heights.iter().map(|z| z.unwrap_or(f64::NAN)));
        for (by, z) in heights.iter().enumerate().filter_map(|(by, z)| Some((by, (*z)?))) {
            other.raise([column + by, row], z);
        }
        let of = |pile: &Pile| pile.hit(&head, tip, &|_| false);
        prop_assert_eq!((of(&one), one.highest()), (of(&other), other.highest()));
        let heights = |pile: &Pile| (0..40 * 30).map(|k| pile.height([k % 40, k / 40])).collect::<Vec<_>>();
        prop_assert_eq!(heights(&one), heights(&other));
    }

    #[test]
    fn a_square_is_as_high_as_its_highest_cell(pile in any_pile()) {
        let [columns, rows] = pile.size();
        let cells = (0..rows).flat_map(|row| (0..columns).map(move |column| [column, row]));
        let highest = cells.map(|cell| pile.height(cell)).fold(f64::NEG_INFINITY, f64::max);
        prop_assert_eq!(pile.highest(), highest);
    }

    #[test]
    fn a_sweep_is_the_deepest_of_its_samples(
        head in any_head(), pile in any_pile(), from in prop::array::uniform3(-2.0_f64..30.0),
        to in prop::array::uniform3(-2.0_f64..30.0),
    ) {
        let length = (0..3).map(|axis| (to[axis] - from[axis]).powi(2)).sum::<f64>().sqrt();
        let steps = (length / SAMPLE).ceil().max(1.0);
        let at = |step: f64| [0, 1, 2].map(|axis| from[axis] + step / steps * (to[axis] - from[axis]));
        let none = |_: &Hit| false;
        let right = (0..=steps as usize)
            .filter_map(|step| pile.hit(&head, at(step as f64), &none))
            .map(|hit| hit.depth)
            .fold(0.0, f64::max);
        let depth = sweep(&pile, &head, from, to, &none).map_or(0.0, |hit| hit.depth);
        prop_assert!((depth - right).abs() < 1e-6, "{} {}", depth, right);
    }
}

#[test]
fn of_equal_touches_the_first_one_counts() {
    let mut pile = Pile::new([0.0, 0.0], [8.0, 8.0], 1.0);
    (0..8).for_each(|row| pile.raise_row(row, 0..8, 2.0));
    let plate = Head { flat: 20.0, cone: 90.0, cone_length: 0.0, discs: vec![], boxes: vec![] };
    let hit = pile.hit(&plate, [4.0, 4.0, 1.5], &|_| false).unwrap();
    assert_eq!((hit.at, hit.part, hit.depth), ([0.5, 0.5], Part::Flat, 0.5));
    // A level move over a top of the same height touches nothing.
    assert_eq!(sweep(&pile, &plate, [0.0, 0.0, 2.0], [8.0, 8.0, 2.0], &|_| false), None);
}

#[test]
fn a_height_is_never_rounded_down() {
    let mut pile = Pile::new([0.0, 0.0], [1.0, 1.0], 0.1);
    assert_eq!((pile.size(), pile.height([3, 3])), ([10, 10], f64::NEG_INFINITY));
    for z in [0.1, 0.3, 10.2, 199.9999] {
        pile.raise([3, 3], z);
        assert!((pile.height([3, 3]) - z).abs() < 1e-9, "{z}");
    }
    pile.raise([3, 3], 200.00001);
    assert!((pile.height([3, 3]) - 200.0001).abs() < 1e-9);
    // Lower values and places beside the grid change nothing.
    pile.raise([3, 3], 1.0);
    pile.raise([3, 30], 300.0);
    assert!((pile.highest() - 200.0001).abs() < 1e-9);
    assert_eq!((pile.cell([0.35, 0.3501]), pile.cell([1.01, 0.5])), (Some([3, 3]), None));
}

/// What touches a plane through the tip that rises along x by `slope` degrees, while layers of 0.3 mm are printed.
fn on_a_plane(head: &Head, slope: f64) -> Option<Part> {
    let mut pile = Pile::new([-20.0, -20.0], [20.0, 20.0], 0.1);
    let [columns, rows] = pile.size();
    let rise = slope.to_radians().tan();
    for column in 0..columns {
        // A cell is as high as the plane anywhere over it.
        let x = pile.middle([column, 0])[0] + 0.05 * rise.signum();
        (0..rows).for_each(|row| pile.raise_row(row, column..column + 1, 30.0 + x * rise));
    }
    pile.hit_printing(head, [0.0, 0.0, 30.0], 0.3).map(|hit| hit.part)
}

#[test]
fn a_plane_touches_what_its_slope_lets_it_touch() {
    let v6 = crate::head::named::v6();
    for (slope, part) in [
        (15.0, None),
        (-15.0, None),
        (20.0, None),
        // The block reaches further to the left.
        (-20.0, Some(Part::Box(0))),
        (28.0, Some(Part::Disc(0))),
    ] {
        assert_eq!(on_a_plane(&v6, slope), part, "{slope}");
    }
    let cautious = crate::head::named::cautious();
    assert_eq!(
        (on_a_plane(&cautious, 4.2), on_a_plane(&cautious, 9.0)),
        (None, Some(Part::Disc(0)))
    );
    assert_eq!(on_a_plane(&crate::head::named::long(), 31.0), None);
    // The flat presses deeper than a layer and a half.
    assert_eq!(on_a_plane(&crate::head::named::long(), 42.0), Some(Part::Flat));
}
