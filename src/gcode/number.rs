//! Integers -> text: fixed-point numbers, never an exponent, no allocation.

use crate::units::nearest;

/// Appends `value · 10^-decimals` to `out` without trailing zeros: `1050` with
/// three decimals is `1.05`.
pub fn push_fixed(out: &mut Vec<u8>, value: i64, decimals: u32) {
    if value < 0 {
        out.push(b'-');
    }
    let scale = 10_u64.pow(decimals);
    let magnitude = value.unsigned_abs();
    push_integer(out, magnitude / scale);
    let mut rest = magnitude % scale;
    if rest == 0 {
        return;
    }
    out.push(b'.');
    let mut digit = scale / 10;
    while rest > 0 {
        out.push(b'0' + (rest / digit) as u8);
        rest %= digit;
        digit /= 10;
    }
}

/// Appends `value` in decimal digits.
pub fn push_integer(out: &mut Vec<u8>, mut value: u64) {
    let mut digits = [0_u8; 20];
    let mut at = digits.len();
    loop {
        at -= 1;
        digits[at] = b'0' + (value % 10) as u8;
        value /= 10;
        if value == 0 {
            break;
        }
    }
    out.extend_from_slice(&digits[at..]);
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
