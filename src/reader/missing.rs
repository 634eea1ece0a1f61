//! Command + words -> the word that needs a number and has none, as in `M109 S` and `M104 S[heat]`.
//!
//! - A firmware reads over such a word, or takes 0 for it: the heater stays cold, the axis where it is.
//! - Most letters of most commands may stand alone: `G28 X`, `M84 E`, `G92 E`. [`NEED`] lists those that
//!   make no sense so. What stands in brackets is a placeholder that a slicer has not filled in, whatever
//!   the command, but for those whose words are texts.
//! - RepRapFirmware computes what stands in braces: there it is a number.
//! - Words of moves are looked at where moves are read (see `drive`).

use super::words::{Code, Words};

/// M-codes, and the letters that need a number.
const NEED: &[(&[u32], &[u8])] = &[
    (&[104, 109, 140, 141, 190, 191], b"SR"),
    (&[106, 220, 221], b"S"),
    (&[92, 201, 203, 566], b"XYZE"),
    (&[204], b"PRST"),
    (&[205], b"XYZEJ"),
    (&[900], b"K"),
];

/// M-codes whose words are texts or names of files, or may be.
const TEXTS: &[u32] = &[
    16, 20, 23, 28, 30, 32, 34, 36, 98, 117, 118, 150, 260, 291, 486, 550, 551, 552, 559, 560, 587,
    588, 589, 591, 862, 928, 929, 950, 1002,
];

/// Letters of a move that need a number; A and B are filaments of some.
pub(super) const OF_MOVES: &[u8] = b"XYZEFIJR";

/// The first word of a command, that is no move, which has no number and needs one. `computes` says
/// whether braces hold numbers.
pub(super) fn missing(code: Code, words: Words<'_>, computes: bool) -> Option<u8> {
    if code.has_part || !b"GMT".contains(&code.letter) {
        return None;
    }
    let need = match (code.letter, code.number) {
        (b'M', number) if TEXTS.contains(&number) => return None,
        (b'M', number) => NEED.iter().find(|(numbers, _)| numbers.contains(&number)),
        (b'G', 4) => Some(&(&[4][..], &b"PS"[..])),
        _ => None,
    };
    if need.is_none() && !words.has_brackets() {
        return None;
    }
    let needs = |letter: u8| need.is_some_and(|(_, letters)| letters.contains(&letter));
    let mut words = words;
    while let Some((letter, number)) = words.next() {
        let is_missing = match words.bracket {
            Some(b'{') if computes => false,
            Some(_) => true,
            None => needs(letter),
        };
        if number.is_none() && is_missing {
            return Some(letter);
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reader::words;

    #[test]
    fn words_that_need_a_number_are_named() {
        let of = |code: &str, computes| {
            let (command, words) = words::command(code.as_bytes()).unwrap();
            missing(command, words, computes).map(char::from)
        };
        for (code, expected) in [
            ("M109 S", Some('S')),
            ("M104 S[x] T0", Some('S')),
            ("M104 T0 S{temperature}", Some('S')),
            ("M221 S", Some('S')),
            ("G92 X[x]", Some('X')),
            ("M104 S200", None),
            ("M109", None),
            ("G28 X Y", None),
            ("G92 E", None),
            ("M84 X Y E", None),
            ("M117 S[x] {y}", None),
            ("M220 B", None),
        ] {
            assert_eq!(of(code, false), expected, "{code}");
        }
        assert_eq!(of("M104 S{global.heat}", true), None);
        assert_eq!(of("M104 S[heat]", true), Some('S'));
    }
}
