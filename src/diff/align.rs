//! Layers of two files -> pairs: which layer of one is which of the other, by height.

/// How high a layer lies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Level {
    /// Height of the nozzle where most of its lines lie, mm.
    pub(super) z: f64,
    /// How far it lies above the layer below, or the bed, mm.
    pub(super) height: f64,
}

/// Two layers of the same height, or one that the other file has not.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Pair {
    /// Place in the first file's layers.
    pub(super) a: Option<usize>,
    /// Place in the second file's layers.
    pub(super) b: Option<usize>,
}

/// Layers that are searched for one of the same height: more than any part that is printed beside
/// another has; without a limit the search takes quadratic time.
const FARTHEST: usize = 1000;

/// Heights that differ by less are the same at any tolerance, mm.
const SAME_HEIGHT: f64 = 1e-3;

/// Pairs the layers in their order; both may come back to the bed for another part.
/// `tolerance` in mm.
pub(super) fn align(a: &[Level], b: &[Level], tolerance: f64) -> Vec<Pair> {
    let mut pairs = Vec::with_capacity(a.len().max(b.len()));
    let (mut i, mut j) = (0, 0);
    while let (Some(one), Some(other)) = (a.get(i), b.get(j)) {
        let lower = one.height.min(other.height);
        let same = tolerance.min(0.25 * lower).max(SAME_HEIGHT);
        let is_same = |a: &Level, b: &Level| (a.z - b.z).abs() <= same;
        let (mut skip_a, mut skip_b) = (0, 0);
        if !is_same(one, other) {
            let ahead = |layers: &[Level], from: usize, of: &Level| {
                let ahead = layers[from..].iter().take(FARTHEST);
                ahead.enumerate().skip(1).find(|(_, layer)| is_same(layer, of)).map(|(k, _)| k)
            };
            match (ahead(a, i, other), ahead(b, j, one)) {
                (Some(k), None) => skip_a = k,
                (None, Some(k)) => skip_b = k,
                (Some(k), Some(l)) if k <= l => skip_a = k,
                (Some(_), Some(l)) => skip_b = l,
                // Nowhere the same: near enough to be the same layer at another height?
                (None, None) if (one.z - other.z).abs() <= 0.5 * lower + SAME_HEIGHT => {}
                (None, None) if one.z < other.z => skip_a = 1,
                (None, None) => skip_b = 1,
            }
        }
        if skip_a + skip_b == 0 {
            pairs.push(Pair { a: Some(i), b: Some(j) });
            (i, j) = (i + 1, j + 1);
        }
        pairs.extend((i..i + skip_a).map(|k| Pair { a: Some(k), b: None }));
        pairs.extend((j..j + skip_b).map(|k| Pair { a: None, b: Some(k) }));
        (i, j) = (i + skip_a, j + skip_b);
    }
    pairs.extend((i..a.len()).map(|k| Pair { a: Some(k), b: None }));
    pairs.extend((j..b.len()).map(|k| Pair { a: None, b: Some(k) }));
    pairs
}

#[cfg(test)]
mod tests {
    use super::*;

    fn layers(heights: &[f64]) -> Vec<Level> {
        heights.iter().map(|&z| Level { z, height: 0.2 }).collect()
    }

    fn pairs_of(a: &[f64], b: &[f64]) -> String {
        let place = |place: Option<usize>| place.map_or("-".to_owned(), |k| k.to_string());
        let pairs = align(&layers(a), &layers(b), 0.01).into_iter();
        pairs.map(|pair| place(pair.a) + &place(pair.b)).collect::<Vec<_>>().join(" ")
    }

    #[test]
    fn layers_are_paired_by_height() {
        assert_eq!(pairs_of(&[0.2, 0.4, 0.6], &[0.2, 0.4, 0.6]), "00 11 22");
        assert_eq!(pairs_of(&[0.2, 0.4, 0.6], &[0.2, 0.6]), "00 1- 21");
        assert_eq!(pairs_of(&[0.2, 0.4], &[0.1, 0.2, 0.3, 0.4]), "-0 01 -2 13");
        // Another height of the first layer lifts all of them.
        assert_eq!(pairs_of(&[0.2, 0.4, 0.6], &[0.25, 0.45, 0.65, 0.85]), "00 11 22 -3");
        // A part of its own begins at the bed again.
        assert_eq!(pairs_of(&[0.2, 0.4, 0.2, 0.4], &[0.2, 0.2, 0.4]), "00 1- 21 32");
        assert_eq!(pairs_of(&[], &[0.2]), "-0");
    }
}
