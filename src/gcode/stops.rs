//! Moves of a patch -> the places within its paths where progress may be told: such a path may take hours.

use super::moves::{Kind, Moves};

/// How long lines take at their feeds, at least, between two such places, ms.
const APART_MS: i64 = 20_000;

impl Moves {
    /// The moves within a path before which progress may be told: none but in patches.
    #[must_use]
    pub fn within(&self, path: usize) -> Vec<usize> {
        let is_in_patch = self.patches.iter().any(|run| run.paths.contains(&path));
        let Some(&first) = self.paths.get(path).filter(|_| is_in_patch) else { return Vec::new() };
        let end = self.paths.get(path + 1).copied().unwrap_or(self.moves.len());
        let (mut taken, mut stops) = (0, Vec::new());
        for k in first + 1..end {
            if taken >= APART_MS && self.arcs.iter().all(|arc| !arc.pieces.contains(&k)) {
                taken = 0;
                stops.push(k);
            }
            taken += self.milliseconds(k);
        }
        stops
    }

    /// How long a line takes at its feed, ms, along x and then along y: exact enough, and the same on every
    /// machine. Travels take none.
    fn milliseconds(&self, number: usize) -> i64 {
        let [from, to] = [number - 1, number].map(|k| &self.moves[k]);
        if !matches!(to.kind, Kind::Extrude(_)) {
            return 0;
        }
        let along = [0, 1].map(|axis| i64::from((to.to[axis].0 - from.to[axis].0).abs()));
        60 * (along[0] + along[1]) / i64::from(to.feed.max(1))
    }
}
