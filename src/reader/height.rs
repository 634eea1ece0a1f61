//! Lines of a layer -> the layer's height: where most of them lie.
//!
//! A layer's lines need not all lie at one height: a skin may follow a surface, a seam may begin
//! with a ramp. The layer's own height is that at which the greatest length of level lines lies,
//! as long as this is a fair share of all its lines: walls, as a rule. Else it is the height of the
//! level lines that it was found by, and without such the height that half of the lines' length lies
//! below (the weighted median).

use std::collections::BTreeMap;

/// Heights that differ by less than half of this count as one, mm: printed positions have
/// thousandths. If it were larger, thin layers would be taken for one.
const STEP: f64 = 1e-3;

/// Share of all lines that must lie at one height for it to be the layer's. In the bent fixture
/// walls make up 40 % and more, and the turning points of a bent line at most 10 %; with 0.5 a
/// layer with more bent skin than walls would lie somewhere in the skin.
const LEAST_SHARE: f64 = 0.25;

/// Lengths of lines by height.
#[derive(Debug, Clone, Default)]
pub(crate) struct Heights {
    /// Those at the height of the last line, in a flat layer all of them.
    last: Lengths,
    /// Those at other heights, by height in [`STEP`]s.
    others: BTreeMap<i64, Lengths>,
}

/// Lengths at one height, mm.
#[derive(Debug, Clone, Copy, Default)]
struct Lengths {
    /// The height, mm.
    z: f64,
    level: f64,
    sloping: f64,
}

impl Heights {
    /// Adds a line that goes from one height to another, mm.
    pub(crate) fn add(&mut self, [from, to]: [f64; 2], length: f64) {
        let z = if from == to { from } else { 0.5 * (from + to) };
        if (z - self.last.z).abs() >= 0.5 * STEP {
            let next = self.others.remove(&key(z)).unwrap_or(Lengths { z, ..Lengths::default() });
            let last = std::mem::replace(&mut self.last, next);
            if last.level + last.sloping > 0.0 {
                self.others.insert(key(last.z), last);
            }
        } else if self.last.level + self.last.sloping == 0.0 {
            self.last.z = z;
        }
        let sum = if from == to { &mut self.last.level } else { &mut self.last.sloping };
        *sum += length;
    }

    /// The height at which most of the level lines lie, and their share of all lines; `None`
    /// without a level line.
    pub(crate) fn level(&self) -> Option<(f64, f64)> {
        let all: f64 = self.all().map(Lengths::sum).sum();
        let most = self.all().reduce(|a, b| if b.level > a.level { b } else { a })?;
        (most.level > 0.0).then_some((most.z, most.level / all))
    }

    /// The layer's height; `None` without a line. `found` is that of the lines it was found by.
    pub(crate) fn height(&self, found: Option<f64>) -> Option<f64> {
        if let Some((z, _)) = self.level().filter(|(_, share)| *share >= LEAST_SHARE) {
            return Some(z);
        }
        if found.is_some() && self.last.sum() > 0.0 {
            return found;
        }
        let half = 0.5 * self.all().map(Lengths::sum).sum::<f64>();
        let mut below = 0.0;
        let mut sorted: Vec<Lengths> = self.all().collect();
        sorted.sort_by(|a, b| a.z.total_cmp(&b.z));
        let middle = sorted.iter().find(|one| {
            below += one.sum();
            below >= half
        });
        middle.map(|one| one.z)
    }

    /// Whether all lines lie at one height.
    pub(crate) fn is_one(&self) -> bool {
        self.others.is_empty()
    }

    fn all(&self) -> impl Iterator<Item = Lengths> {
        let has_some = self.last.sum() > 0.0;
        self.others.values().copied().chain(has_some.then_some(self.last))
    }
}

impl Lengths {
    fn sum(self) -> f64 {
        self.level + self.sloping
    }
}

fn key(z: f64) -> i64 {
    (z / STEP).round() as i64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn walls_tell_the_height_and_bent_lines_only_without_them() {
        let mut heights = Heights::default();
        assert_eq!(heights.height(None), None);
        heights.add([0.0, 0.0], 1.0);
        assert_eq!(heights.height(None), Some(0.0));
        let mut heights = Heights::default();
        for k in 0..20 {
            let z = 0.4 + 0.01 * f64::from(k % 7);
            heights.add([z, z + 0.01], 1.0);
        }
        assert!((heights.height(None).unwrap() - 0.435).abs() < 1e-9, "{heights:?}");
        heights.add([0.4, 0.4], 4.0);
        heights.add([0.7, 0.7], 3.0);
        assert!((heights.height(None).unwrap() - 0.435).abs() < 1e-9, "{heights:?}");
        heights.add([0.4, 0.4], 5.0);
        assert_eq!(heights.height(None), Some(0.4));
        for k in 0..20 {
            heights.add([0.4, 2.4], f64::from(k));
        }
        assert_eq!(heights.height(Some(0.7)), Some(0.7));
        assert_eq!(heights.height(None), Some(1.4));
    }
}
