//! Command -> whether a firmware knows it.

use crate::profile::DialectName;

/// G-codes of GPX 2.6 for Sailfish; it skips all others with a warning.
const GPX_G: &[u32] =
    &[0, 1, 4, 10, 15, 21, 28, 53, 54, 55, 56, 57, 58, 59, 71, 90, 91, 92, 130, 161, 162];

/// M-codes of GPX 2.6 for Sailfish. Missing on purpose: those that become queries of a host (M105,
/// M114, M115 …), on which a print from a card waits for ever.
const GPX_M: &[u32] = &[
    0, 2, 6, 17, 18, 22, 31, 70, 71, 72, 73, 82, 83, 84, 101, 102, 103, 104, 106, 107, 108, 109,
    110, 111, 116, 126, 127, 131, 132, 133, 134, 135, 136, 137, 140, 190, 220, 221, 300, 320, 321,
    322, 400, 420,
];

/// G-codes of Klipper, those of optional modules included.
const KLIPPER_G: &[u32] = &[0, 1, 2, 3, 4, 10, 11, 17, 18, 19, 21, 28, 29, 90, 91, 92];

/// M-codes of Klipper, those of optional modules and of the macros that hosts bring included.
const KLIPPER_M: &[u32] = &[
    0, 18, 20, 21, 23, 24, 25, 26, 27, 73, 82, 83, 84, 104, 105, 106, 107, 109, 110, 112, 114, 115,
    117, 118, 119, 140, 141, 190, 191, 204, 220, 221, 290, 300, 400, 486, 600,
];

/// G-codes of Marlin 2.
const MARLIN_G: &[u32] = &[
    0, 1, 2, 3, 4, 5, 6, 10, 11, 12, 17, 18, 19, 20, 21, 26, 27, 28, 29, 30, 31, 32, 33, 34, 35,
    38, 42, 53, 54, 55, 56, 57, 58, 59, 60, 61, 76, 80, 90, 91, 92, 425,
];

/// M-codes of Marlin 2 below 700; above are only rare ones. M601 and M602 are of Prusa's.
const MARLIN_M: &[u32] = &[
    0, 1, 3, 4, 5, 7, 8, 9, 10, 11, 16, 17, 18, 20, 21, 22, 23, 24, 25, 26, 27, 28, 29, 30, 31, 32,
    33, 34, 42, 43, 48, 73, 75, 76, 77, 78, 80, 81, 82, 83, 84, 85, 86, 87, 92, 100, 102, 104, 105,
    106, 107, 108, 109, 110, 111, 112, 113, 114, 115, 117, 118, 119, 120, 121, 122, 123, 125, 126,
    127, 128, 129, 140, 141, 143, 145, 149, 150, 154, 155, 163, 164, 165, 166, 190, 191, 192, 193,
    200, 201, 203, 204, 205, 206, 207, 208, 209, 211, 217, 218, 220, 221, 226, 240, 250, 255, 256,
    260, 261, 280, 281, 282, 290, 300, 301, 302, 303, 304, 305, 306, 309, 350, 351, 355, 360, 361,
    362, 363, 364, 380, 381, 400, 401, 402, 403, 404, 405, 406, 407, 410, 412, 413, 420, 421, 422,
    423, 425, 428, 430, 486, 493, 500, 501, 502, 503, 504, 510, 511, 512, 524, 540, 550, 552, 553,
    554, 569, 575, 592, 593, 600, 601, 602, 603, 605, 665, 666, 672,
];

/// Marlin's M-codes from here on are rare ones (M700 and more), which all count as known.
const MARLIN_RARE: u32 = 700;

/// G-codes of RepRapFirmware 3.
const RRF_G: &[u32] = &[
    0, 1, 2, 3, 4, 10, 11, 17, 18, 19, 20, 21, 28, 29, 30, 31, 32, 38, 53, 54, 55, 56, 57, 58, 59,
    60, 68, 69, 90, 91, 92, 93, 94,
];

/// M-codes of RepRapFirmware 3 below [`RRF_OWN`].
const RRF_M: &[u32] = &[
    0, 1, 2, 3, 4, 5, 17, 18, 20, 21, 22, 23, 24, 25, 26, 27, 28, 29, 30, 32, 36, 37, 38, 39, 42,
    73, 80, 81, 82, 83, 84, 85, 92, 98, 99, 101, 102, 103, 104, 105, 106, 107, 108, 109, 110, 111,
    112, 114, 115, 116, 117, 118, 119, 120, 121, 122, 140, 141, 143, 144, 150, 190, 191, 200, 201,
    203, 204, 205, 206, 207, 208, 220, 221, 226, 260, 261, 280, 290, 291, 292, 300, 301, 302, 303,
    304, 305, 307, 308, 309, 350, 374, 375, 376, 400, 401, 402, 404, 408, 409, 450, 451, 452, 453,
    470, 471, 472, 486,
];

/// From here on RepRapFirmware's M-codes set it up, and one that is not its own may be a macro file of
/// the user's: all count as known.
const RRF_OWN: u32 = 500;

/// G-codes of the Ultimaker 2.
const ULTIMAKER_G: &[u32] = &[0, 1, 2, 3, 4, 10, 11, 28, 29, 30, 90, 91, 92];

/// M-codes of the Ultimaker 2.
const ULTIMAKER_M: &[u32] = &[
    0, 1, 17, 18, 20, 21, 22, 23, 24, 25, 26, 27, 28, 29, 30, 31, 42, 80, 81, 82, 83, 84, 85, 92,
    104, 105, 106, 107, 109, 114, 115, 117, 119, 120, 121, 140, 190, 201, 202, 203, 204, 205, 206,
    207, 208, 209, 218, 220, 221, 240, 280, 300, 301, 302, 303, 304, 350, 351, 400, 401, 500, 501,
    502, 503, 540, 600, 601, 605, 606, 907, 908, 923, 928, 999,
];

/// Whether the firmware knows the command, or at least accepts it without a complaint.
pub(crate) fn knows(dialect: DialectName, letter: u8, number: u32) -> bool {
    let (g, m) = match dialect {
        DialectName::Makerbot => (GPX_G, GPX_M),
        DialectName::Klipper => (KLIPPER_G, KLIPPER_M),
        DialectName::Marlin => (MARLIN_G, MARLIN_M),
        DialectName::Reprapfirmware => (RRF_G, RRF_M),
        DialectName::Ultigcode => (ULTIMAKER_G, ULTIMAKER_M),
    };
    let all_from = match dialect {
        DialectName::Marlin => MARLIN_RARE,
        DialectName::Reprapfirmware => RRF_OWN,
        _ => u32::MAX,
    };
    match letter {
        b'G' => g.contains(&number),
        b'M' => m.contains(&number) || number >= all_from,
        // Tools.
        b'T' => true,
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn firmwares_differ() {
        for (letter, number, marlin, klipper, gpx) in [
            (b'G', 1, true, true, true),
            (b'G', 161, false, false, true),
            (b'M', 105, true, true, false),
            (b'M', 201, true, false, false),
            (b'M', 999, true, false, false),
            (b'X', 1, false, false, false),
        ] {
            let of = |dialect| knows(dialect, letter, number);
            let known = [DialectName::Marlin, DialectName::Klipper, DialectName::Makerbot].map(of);
            assert_eq!(known, [marlin, klipper, gpx], "{}{number}", letter as char);
        }
    }
}
