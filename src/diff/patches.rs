//! Two halves -> patches of non-planar skin: the lines of each in both, to be compared one by one.
//!
//! Patches are the same that have the same number and lie at one place of the bed; of the rest those are
//! that lie at one place. A patch that only one file has there is compared with nothing.

use super::half::Half;
use super::sums::{Both, Extent, Measure};
use crate::reader::Role;
use crate::reader::print::Step;
use std::collections::BTreeMap;

/// The moves of the lines of each patch, by its number.
type Patches = BTreeMap<u32, Vec<Step>>;

/// The number of a patch in both halves, where it is in both, and its lines.
type Pair = (Both<Option<u32>>, Both<Vec<Step>>);

/// The patches of both halves, one by one.
pub(super) fn all(halves: Both<&Half<'_>>) -> Vec<Pair> {
    let all = halves.map(of_half);
    let steps = |number: Option<u32>, all: &Patches| {
        number.and_then(|number| all.get(&number)).cloned().unwrap_or_default()
    };
    let of = |patch: Both<Option<u32>>| {
        (patch, Both { a: steps(patch.a, &all.a), b: steps(patch.b, &all.b) })
    };
    pairs(&all).into_iter().map(of).collect()
}

fn of_half(half: &Half<'_>) -> Patches {
    let mut all = Patches::new();
    for step in half.steps.iter().filter(|step| step.role == Role::NonPlanar) {
        let line = u64::from(step.line);
        let after = half.patches.partition_point(|patch| patch.lines.start <= line);
        let number = after.checked_sub(1).map_or(0, |last| half.patches[last].number);
        all.entry(number).or_default().push(*step);
    }
    all
}

/// Which patch is which.
fn pairs(all: &Both<Patches>) -> Vec<Both<Option<u32>>> {
    let boxes = |patches: &Patches| -> BTreeMap<u32, Option<Extent>> {
        let of = |(number, steps): (&u32, &Vec<Step>)| (*number, Measure::new(steps, true).extent);
        patches.iter().map(of).collect()
    };
    let (mut a, mut b) = (boxes(&all.a), boxes(&all.b));
    let mut pairs = Vec::new();
    for by_number in [true, false] {
        for (number, own) in a.clone() {
            let same = |(other, place): &(&u32, &Option<Extent>)| {
                (!by_number || **other == number) && meet(own, **place)
            };
            let Some(other) = b.iter().find(same).map(|(other, _)| *other) else { continue };
            a.remove(&number);
            b.remove(&other);
            pairs.push(Both { a: Some(number), b: Some(other) });
        }
    }
    pairs.extend(a.into_keys().map(|number| Both { a: Some(number), b: None }));
    pairs.extend(b.into_keys().map(|number| Both { a: None, b: Some(number) }));
    pairs
}

/// Whether boxes have some of the bed in common.
fn meet(a: Option<Extent>, b: Option<Extent>) -> bool {
    let (Some(a), Some(b)) = (a, b) else { return false };
    (0..2).all(|axis| a.min[axis] <= b.max[axis] && b.min[axis] <= a.max[axis])
}
