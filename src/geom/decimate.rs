//! Places one after the other -> those that matter: straight lines between them miss no other by much.
//!
//! Ramer 1972, Douglas and Peucker 1973: of the places between two kept ones that is kept which the
//! straight line between the two misses most, until none is missed by more than is allowed. What a
//! miss is, a distance or a change of width, is for the caller to say.

/// The kept of `count` places, as their numbers in order; the first and the last always are.
/// `split` gives the place to keep between two, if any: mostly by [`most_missed`].
#[must_use]
pub fn decimate(count: usize, split: impl Fn(usize, usize) -> Option<usize>) -> Vec<usize> {
    let mut kept = Vec::with_capacity(count);
    if count > 0 {
        kept.push(0);
        between(0, count - 1, &split, &mut kept);
    }
    if count > 1 {
        kept.push(count - 1);
    }
    kept
}

fn between(
    a: usize,
    b: usize,
    split: &impl Fn(usize, usize) -> Option<usize>,
    kept: &mut Vec<usize>,
) {
    if let Some(middle) = split(a, b) {
        between(a, middle, split, kept);
        kept.push(middle);
        between(middle, b, split, kept);
    }
}

/// The place between `a` and `b` that is missed most, of equals the first, if by more than `least`.
#[must_use]
pub fn most_missed(a: usize, b: usize, least: f64, miss: impl Fn(usize) -> f64) -> Option<usize> {
    let (mut most, mut found) = (least, None);
    for k in a + 1..b {
        let miss = miss(k);
        if miss > most {
            (most, found) = (miss, Some(k));
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn kept(heights: &[f64], least: f64) -> Vec<usize> {
        decimate(heights.len(), |a, b| {
            most_missed(a, b, least, |k| (heights[k] - on_line(heights, a, b, k)).abs())
        })
    }

    fn on_line(heights: &[f64], a: usize, b: usize, k: usize) -> f64 {
        heights[a] + (heights[b] - heights[a]) * (k - a) as f64 / (b - a) as f64
    }

    #[test]
    fn bends_are_kept_and_what_lies_between_is_not() {
        assert_eq!(kept(&[0.0, 1.0, 2.0, 1.0, 0.0, 0.1, 0.0], 0.5), [0, 2, 4, 6]);
        assert_eq!(kept(&[0.0, 0.0], 0.5), [0, 1]);
        assert_eq!(kept(&[1.0], 0.5), [0]);
        assert!(kept(&[], 0.5).is_empty());
    }

    proptest! {
        #[test]
        fn no_place_is_missed_by_more(heights in prop::collection::vec(0.0..9.0_f64, 2..60), least in 0.1..4.0_f64) {
            let kept = kept(&heights, least);
            for two in kept.windows(2) {
                for k in two[0]..two[1] {
                    let off = heights[k] - on_line(&heights, two[0], two[1], k);
                    prop_assert!(off.abs() <= least);
                }
            }
        }
    }
}
