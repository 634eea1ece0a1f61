//! Integers -> text: fixed-point numbers, never an exponent, no allocation.

use crate::units::nearest;

/// The most characters of a number: 20 digits, a sign and a point.
const LONGEST: usize = 22;

/// The numbers 0 to 99 in two digits: half as many divisions as digit by digit.
const PAIRS: [[u8; 2]; 100] = {
    let mut pairs = [[b'0'; 2]; 100];
    let mut k = 0;
    while k < pairs.len() {
        pairs[k] = [b'0' + (k / 10) as u8, b'0' + (k % 10) as u8];
        k += 1;
    }
    pairs
};

/// Appends `value · 10^-decimals` to `out` without trailing zeros: `1050` with
/// three decimals is `1.05`. At most 19 decimals.
pub fn push_fixed(out: &mut Vec<u8>, value: i64, decimals: u32) {
    let mut text = Digits::new();
    let (mut rest, mut places) = (value.unsigned_abs(), decimals);
    while places > 0 && rest % 10 == 0 {
        rest /= 10;
        places -= 1;
    }
    if places > 0 {
        for _ in 0..places / 2 {
            rest = text.pair(rest);
        }
        if places % 2 == 1 {
            rest = text.digit(rest);
        }
        text.put(b'.');
    }
    text.integer(rest);
    if value < 0 {
        text.put(b'-');
    }
    out.extend_from_slice(text.written());
}

/// Appends `value` in decimal digits.
pub fn push_integer(out: &mut Vec<u8>, value: u64) {
    let mut text = Digits::new();
    text.integer(value);
    out.extend_from_slice(text.written());
}

/// A number in the making, from its last character to the first: where it ends is known,
/// how long it gets is not.
struct Digits {
    text: [u8; LONGEST],
    at: usize,
}

impl Digits {
    fn new() -> Self {
        Self { text: [0; LONGEST], at: LONGEST }
    }

    fn written(&self) -> &[u8] {
        &self.text[self.at..]
    }

    fn put(&mut self, character: u8) {
        self.at -= 1;
        self.text[self.at] = character;
    }

    /// The last digit of `value`; gives what is left of it.
    fn digit(&mut self, value: u64) -> u64 {
        self.put(b'0' + (value % 10) as u8);
        value / 10
    }

    /// The last two digits of `value`; gives what is left of it.
    fn pair(&mut self, value: u64) -> u64 {
        let [tens, ones] = PAIRS[(value % 100) as usize];
        self.put(ones);
        self.put(tens);
        value / 100
    }

    /// All digits of `value`.
    fn integer(&mut self, mut value: u64) {
        while value >= 100 {
            value = self.pair(value);
        }
        if value >= 10 {
            self.pair(value);
        } else {
            self.digit(value);
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
