//! Integers -> text: writes fixed-point numbers, without exponents and without allocation.

use crate::units::nearest;

/// Bytes for the longest number: a sign, 20 digits, a point, 6 decimals, and the spare ones of
/// the last write, since digits are written four bytes at a time.
const ROOM: usize = 32;

/// The numbers 0 to 999 in three digits. Three digits at a time need a third of the divisions.
static TRIPLES: [[u8; 4]; 1000] = {
    let mut triples = [[0; 4]; 1000];
    let mut k = 0;
    while k < triples.len() {
        triples[k] = [b'0' + (k / 100) as u8, b'0' + (k / 10 % 10) as u8, b'0' + (k % 10) as u8, 0];
        k += 1;
    }
    triples
};

/// Appends `value · 10^-DECIMALS` to `out` without trailing zeros: `1050` with
/// three decimals is `1.05`. At most 6 decimals.
pub fn push_fixed<const DECIMALS: u32>(out: &mut Vec<u8>, value: i64) {
    const { assert!(DECIMALS <= 6) };
    let power = 10_u64.pow(DECIMALS);
    let (whole, part) = (value.unsigned_abs() / power, value.unsigned_abs() % power);
    let mut text = Digits { text: [0; ROOM], end: 0 };
    if value < 0 {
        text.put(b'-');
    }
    text.integer(whole);
    if part > 0 {
        text.put(b'.');
        let places = 3 * DECIMALS.div_ceil(3);
        text.triples(part * 10_u64.pow(places - DECIMALS), places / 3);
        text.trim();
    }
    // Copies a constant number of bytes: the compiler inlines that, a short copy is a call.
    let end = out.len() + text.end;
    out.extend_from_slice(&text.text);
    out.truncate(end);
}

/// Text of a number, written from its first character on.
struct Digits {
    text: [u8; ROOM],
    end: usize,
}

impl Digits {
    fn put(&mut self, character: u8) {
        self.text[self.end] = character;
        self.end += 1;
    }

    /// Appends the last `count` digits of a number below 1000.
    fn part(&mut self, value: u64, count: usize) {
        let triple = u32::from_le_bytes(TRIPLES[value as usize]) >> (8 * (3 - count));
        self.text[self.end..self.end + 4].copy_from_slice(&triple.to_le_bytes());
        self.end += count;
    }

    /// Appends the last `count` groups of three digits.
    fn triples(&mut self, value: u64, count: u32) {
        if count > 1 {
            self.triples(value / 1000, count - 1);
        }
        self.part(value % 1000, 3);
    }

    /// Appends all digits of `value`.
    fn integer(&mut self, value: u64) {
        match value {
            0..10 => self.part(value, 1),
            10..100 => self.part(value, 2),
            100..1000 => self.part(value, 3),
            _ => {
                self.integer(value / 1000);
                self.part(value % 1000, 3);
            }
        }
    }

    /// Removes zeros from the end. Some other digit must come before them.
    fn trim(&mut self) {
        while self.text[self.end - 1] == b'0' {
            self.end -= 1;
        }
    }
}

/// `mm` in thousandths, rounded half away from zero.
#[must_use]
pub fn thousandths(mm: f64) -> i64 {
    nearest(mm * 1000.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn text<const DECIMALS: u32>(value: i64) -> String {
        let mut out = b"X".to_vec();
        push_fixed::<DECIMALS>(&mut out, value);
        String::from_utf8(out).unwrap().split_off(1)
    }

    #[test]
    fn numbers_are_plain() {
        assert_eq!(text::<3>(0), "0");
        assert_eq!(text::<3>(1050), "1.05");
        assert_eq!(text::<3>(-5), "-0.005");
        assert_eq!(text::<3>(12_000), "12");
        assert_eq!(text::<5>(1_234_500_010), "12345.0001");
        assert_eq!(text::<0>(i64::MIN), "-9223372036854775808");
        assert_eq!(text::<6>(i64::MIN), "-9223372036854.775808");
    }

    proptest! {
        #[test]
        fn numbers_read_back(value in -1_000_000_000_000i64..1_000_000_000_000, nines in 0u32..12) {
            let value = value % 10_i64.pow(nines + 1);
            let texts = [text::<0>, text::<1>, text::<2>, text::<3>, text::<4>, text::<5>, text::<6>];
            for (decimals, text) in texts.iter().map(|text| text(value)).enumerate() {
                let read: f64 = text.parse().unwrap();
                let back = (read * 10f64.powi(decimals as i32)).round() as i64;
                prop_assert_eq!(back, value);
                let is_plain = |end| !(text.contains('.') && text.ends_with(end));
                prop_assert!(is_plain('0') && is_plain('.'), "{}", text);
            }
        }
    }
}
