//! Steps -> patterns of coils, and back: for a board that only copies bits to its transistors.
//!
//! A unipolar motor has four coils, a bit for each. *Half steps* go round in eight patterns, one and two
//! coils by turns; *full steps* in four, two coils each. The pattern of a step is that of its number,
//! counted from the axis's zero, so that a stream of patterns can be joined anywhere.

use super::axis::AXES;

/// Patterns of half steps, towards higher numbers.
const HALF: [u8; 8] = [0b0001, 0b0011, 0b0010, 0b0110, 0b0100, 0b1100, 0b1000, 0b1001];

/// Patterns of full steps.
const FULL: [u8; 4] = [0b0011, 0b0110, 0b1100, 0b1001];

fn table(full: bool) -> &'static [u8] {
    if full { &FULL } else { &HALF }
}

/// The patterns of all axes at these steps, four bits each, x lowest.
pub(super) fn patterns(at: [i64; AXES], full: [bool; AXES]) -> u16 {
    let mut patterns = 0;
    for axis in (0..AXES).rev() {
        let table = table(full[axis]);
        let place = at[axis].rem_euclid(table.len() as i64) as usize;
        patterns = patterns << 4 | u16::from(table[place]);
    }
    patterns
}

/// Which way an axis has gone from step `at` to what shows this pattern; `None` if that is no neighbour.
pub(super) fn went(at: i64, pattern: u8, full: bool) -> Option<i64> {
    let table = table(full);
    let is_there = |by: &i64| {
        let place = (at + by).rem_euclid(table.len() as i64) as usize;
        table[place] == pattern
    };
    [0, 1, -1].into_iter().find(is_there)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patterns_tell_which_way_an_axis_went() {
        for full in [false, true] {
            for at in -9..9 {
                for by in -1..=1 {
                    let all = patterns([0, at + by, 3, -4], [!full, full, false, true]);
                    assert_eq!(went(at, (all >> 4 & 15) as u8, full), Some(by));
                    assert_eq!(went(-4, (all >> 12) as u8, true), Some(0));
                }
            }
            assert_eq!(went(0, 0, full), None);
            // Neighbours differ in one coil of a half step, and in two of a full one.
            let table = table(full);
            for k in 0..table.len() {
                let changed = table[k] ^ table[(k + 1) % table.len()];
                assert_eq!(changed.count_ones(), if full { 2 } else { 1 });
            }
        }
    }
}
