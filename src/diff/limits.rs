//! Facts of two files -> limits of the machine, and long waits, that only one of them sets.
//!
//! How long moves take shows what limits do; this says which they are. A value counts once however often it is
//! set: another order of the same lines sets it elsewhere.

use super::codes::CodeDifference;
use super::sums::Both;
use crate::reader::{Facts, LongWait, Told};

/// A value or a wait by its line of the file, for people.
type Named = (u64, String);

/// What only one of the files sets.
pub(super) fn difference(facts: Both<&Facts>) -> Option<CodeDifference> {
    let all = facts.map(named);
    let only = |own: &[Named], other: &[Named]| -> Vec<Named> {
        let mut other: Vec<&str> = other.iter().map(|(_, text)| text.as_str()).collect();
        let is_left = |one: &&Named| match other.iter().position(|text| *text == one.1) {
            Some(place) => {
                other.swap_remove(place);
                false
            }
            None => true,
        };
        own.iter().filter(is_left).cloned().collect()
    };
    let only = Both { a: only(&all.a, &all.b), b: only(&all.b, &all.a) };
    let line = only.as_ref().map(|own| own.first().map(|(line, _)| *line));
    let only = only.map(|own| own.into_iter().map(|(_, text)| text).collect::<Vec<_>>());
    (!only.a.is_empty() || !only.b.is_empty()).then_some(CodeDifference { only, line })
}

/// All limits and long waits of a file by their lines.
fn named(facts: &Facts) -> Vec<Named> {
    let rounded = |value: f64| (value * 1e3).round() / 1e3;
    let limit = |Told { limit, value, line, .. }: &Told| {
        let text = format!("{} {} {}", limit.name(), rounded(*value), limit.unit());
        (*line, text.trim_end().to_owned())
    };
    let wait = |LongWait { seconds, line, .. }: &LongWait| {
        (*line, format!("wait of {} s", rounded(*seconds)))
    };
    let mut all: Vec<Named> = facts.limits.iter().map(limit).collect();
    all.extend(facts.waits.iter().map(wait));
    all.sort_by_key(|(line, _)| *line);
    all
}
