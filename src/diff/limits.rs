//! Facts of two files -> limits of the machine, and long waits, that only one of them sets.
//!
//! How long moves take shows what limits do; this says which they are. A value counts once however often it is
//! set: another order of the same lines sets it elsewhere.

use super::codes::{self, Code, CodeDifference};
use super::sums::Both;
use crate::reader::{Facts, LongWait, Told};

/// What only one of the files sets.
pub(super) fn difference(facts: Both<&Facts>) -> Option<CodeDifference> {
    let all = facts.map(named);
    codes::only_in(all.as_ref().map(Vec::as_slice))
}

/// All limits and long waits of a file, for people, in the order of its lines.
fn named(facts: &Facts) -> Vec<Code> {
    let rounded = |value: f64| (value * 1e3).round() / 1e3;
    let limit = |Told { limit, value, line, .. }: &Told| {
        let text = format!("{} {} {}", limit.name(), rounded(*value), limit.unit());
        (*line, text.trim_end().to_owned())
    };
    let wait = |LongWait { seconds, line, .. }: &LongWait| {
        (*line, format!("wait of {} s", rounded(*seconds)))
    };
    let mut all: Vec<(u64, String)> = facts.limits.iter().map(limit).collect();
    all.extend(facts.waits.iter().map(wait));
    all.sort_by_key(|(line, _)| *line);
    all.into_iter().map(|(line, text)| Code::new(line, text)).collect()
}
