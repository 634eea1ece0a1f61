//! Integers -> text: fixed-point numbers, never an exponent, no allocation.

use crate::units::nearest;

/// The most characters of a number: 20 digits, a sign and a point.
const LONGEST: usize = 22;

/// Appends `value · 10^-decimals` to `out` without trailing zeros: `1050` with
/// three decimals is `1.05`. At most 19 decimals.
///
/// Digits are made from the last to the first, so that zeros at the end are known before
/// anything is written.
pub fn push_fixed(out: &mut Vec<u8>, value: i64, decimals: u32) {
    let mut text = [0_u8; LONGEST];
    let mut at = LONGEST;
    let mut rest = value.unsigned_abs();
    for _ in 0..decimals {
        let digit = (rest % 10) as u8;
        rest /= 10;
        if at < LONGEST || digit > 0 {
            at -= 1;
            text[at] = b'0' + digit;
        }
    }
    if at < LONGEST {
        at -= 1;
        text[at] = b'.';
    }
    at = digits(rest, &mut text, at);
    if value < 0 {
        at -= 1;
        text[at] = b'-';
    }
    out.extend_from_slice(&text[at..]);
}

/// Appends `value` in decimal digits.
pub fn push_integer(out: &mut Vec<u8>, value: u64) {
    let mut text = [0_u8; LONGEST];
    let at = digits(value, &mut text, LONGEST);
    out.extend_from_slice(&text[at..]);
}

/// Writes the digits of `value` before `end` of `text`; says where they begin.
fn digits(mut value: u64, text: &mut [u8; LONGEST], end: usize) -> usize {
    let mut at = end;
    loop {
        at -= 1;
        text[at] = b'0' + (value % 10) as u8;
        value /= 10;
        if value == 0 {
            return at;
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

    fn text(value: i64, decimals: u32) -> String {
        let mut out = Vec::new();
        push_fixed(&mut out, value, decimals);
        String::from_utf8(out).unwrap()
    }

    #[test]
    fn numbers_are_plain() {
        assert_eq!(text(0, 3), "0");
        assert_eq!(text(1050, 3), "1.05");
        assert_eq!(text(-5, 3), "-0.005");
        assert_eq!(text(12_000, 3), "12");
        assert_eq!(text(i64::MIN, 0), "-9223372036854775808");
    }

    proptest! {
        #[test]
        fn numbers_read_back(value in -1_000_000_000_000i64..1_000_000_000_000, decimals in 0u32..6) {
            let read: f64 = text(value, decimals).parse().unwrap();
            let back = (read * 10f64.powi(decimals as i32)).round() as i64;
            prop_assert_eq!(back, value);
        }
    }
}
