//! Codes -> whether they are known to change nothing that is read here.

use super::words::Code;

/// M-codes that neither move anything nor wait: of Marlin, Klipper, Sailfish and Prusa's and Bambu's
/// firmwares. One that is missing here makes files look as if they had unknown lines.
const HARMLESS: &[u32] = &[
    17, 18, 20, 21, 27, 31, 42, 70, 72, 73, 75, 76, 77, 82, 83, 84, 85, 92, 105, 106, 107, 108,
    110, 111, 113, 114, 115, 117, 118, 119, 120, 121, 126, 127, 130, 132, 136, 137, 141, 142, 150,
    155, 200, 207, 208, 209, 211, 217, 218, 221, 240, 250, 280, 290, 300, 301, 302, 304, 350, 351,
    355, 412, 413, 420, 422, 425, 486, 500, 501, 502, 503, 555, 572, 592, 593, 851, 862, 900, 906,
    907, 910, 911, 912, 913, 914, 915, 950, 955, 970, 971, 973, 974, 975, 981, 982, 983, 991, 1002,
];

/// Whether it neither moves anything nor waits.
pub(super) fn is_harmless(code: Code) -> bool {
    code.letter == b'M' && HARMLESS.contains(&code.number)
}

/// What follows the word `name`, in any case.
pub(super) fn klipper<'a>(code: &'a [u8], name: &[u8]) -> Option<&'a [u8]> {
    let (word, rest) = code.split_at_checked(name.len())?;
    let ends = rest.first().is_none_or(u8::is_ascii_whitespace);
    (ends && word.eq_ignore_ascii_case(name)).then_some(rest)
}
