//! Pile, head and a straight move -> the deepest touch on its way.

use super::Head;
use super::pile::{Hit, Pile};

/// Distance of the places on a move where the head is looked at, mm, at most.
pub const SAMPLE: f64 = 0.25;

/// Longer pieces of a move are first tried as a whole, mm.
const WHOLE: f64 = 2.0;

/// The deepest touch of `head` while its tip moves straight from `from` to `to`, mm, among those that `spare`
/// does not allow; the first one of those equally deep. The move's ends are samples, and no two
/// samples lie more than [`SAMPLE`] apart.
#[must_use]
pub fn sweep(
    pile: &Pile,
    head: &Head,
    from: [f64; 3],
    to: [f64; 3],
    spare: &dyn Fn(&Hit) -> bool,
) -> Option<Hit> {
    deepest(pile, head, [from, to], &|tip| pile.hit(head, tip, spare))
}

/// As [`sweep`], of the touches that `hit` tells; it tells none where the head touches nothing of the pile.
#[must_use]
pub fn deepest(
    pile: &Pile,
    head: &Head,
    [from, to]: [[f64; 3]; 2],
    hit: &dyn Fn([f64; 3]) -> Option<Hit>,
) -> Option<Hit> {
    let by = [0, 1, 2].map(|axis| to[axis] - from[axis]);
    let length = by.iter().map(|by| by * by).sum::<f64>().sqrt();
    let steps = ((length / SAMPLE - 1e-9).ceil().max(1.0)) as usize;
    let at = |step: usize| {
        let share = step as f64 / steps as f64;
        if step == steps { to } else { [0, 1, 2].map(|axis| from[axis] + share * by[axis]) }
    };
    let whole = (WHOLE / SAMPLE) as usize;
    let mut best: Option<Hit> = None;
    // Pieces that are to be looked at yet, the first one last: from one sample to another.
    let mut open = vec![(0, steps)];
    while let Some((first, last)) = open.pop() {
        if last - first > whole {
            let (a, b) = (at(first), at(last));
            let bound = |of: fn(f64, f64) -> f64| [0, 1, 2].map(|axis| of(a[axis], b[axis]));
            if pile.is_clear(head, bound(f64::min), bound(f64::max)) {
                continue;
            }
            let middle = first.midpoint(last);
            open.extend([(middle + 1, last), (first, middle)]);
            continue;
        }
        for step in first..=last {
            let hit = hit(at(step));
            best = match (best, hit) {
                (Some(best), Some(hit)) if hit.depth > best.depth => Some(hit),
                (best, hit) => best.or(hit),
            };
        }
    }
    best
}
