//! A line -> command, words of a letter and a number, and comment.
//!
//! - The *code* of a line is what stands before its comment, without a line number and a checksum.
//! - A *command* is a letter with a number, `G1`; it may have a fraction, `G92.1`.
//! - A *word* is a letter with a number, or alone. Blanks may stand anywhere, or nowhere.
//! - What stands in round brackets is a comment; in braces or square brackets a value that is no number: no
//!   word is looked for in it.
//! - Numbers are decimal, without an exponent, as firmwares read them.
//!
//! Nothing is copied: words are read from the line as they are asked for.

/// A letter with a number, such as `G1`. Fractions of the number are left out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Code {
    pub(super) letter: u8,
    pub(super) number: u32,
    /// Whether it is one of a family, such as `G92.1`.
    pub(super) has_part: bool,
}

/// The words after a command.
#[derive(Debug, Clone, Copy)]
pub(super) struct Words<'a> {
    rest: &'a [u8],
    /// The bracket in which the value of the last word stands, `{` or `[`, if it does.
    pub(super) bracket: Option<u8>,
}

/// A line's code and its comment, which begins after the `;`. A line number before and a
/// checksum after the code are left out.
pub(super) fn split(line: &[u8]) -> (&[u8], Option<&[u8]>) {
    let end = memchr::memchr2(b';', b'*', line);
    let (code, comment) = match end {
        Some(end) if line[end] == b';' => (&line[..end], Some(&line[end + 1..])),
        Some(end) => (&line[..end], None),
        None => (line, None),
    };
    let code = code.trim_ascii();
    if let Some((b'n' | b'N', rest)) = code.split_first() {
        let digits = rest.iter().take_while(|byte| byte.is_ascii_digit()).count();
        if digits > 0 {
            return (rest[digits..].trim_ascii_start(), comment);
        }
    }
    (code, comment)
}

/// The command that `code` begins with, and the words after it. Firmwares read over blanks between a
/// letter and its number.
pub(super) fn command(code: &[u8]) -> Option<(Code, Words<'_>)> {
    let (letter, mut rest) = code.split_first()?;
    if rest.first() == Some(&b' ') && letter.is_ascii_alphabetic() {
        rest = rest.trim_ascii_start();
    }
    let digits = rest.iter().take_while(|byte| byte.is_ascii_digit()).count();
    if digits == 0 || digits > 6 {
        return None;
    }
    let number = rest[..digits].iter().fold(0, |sum, &digit| 10 * sum + u32::from(digit - b'0'));
    let mut rest = &rest[digits..];
    let has_part = rest.first() == Some(&b'.');
    if has_part {
        let part = 1 + rest[1..].iter().take_while(|byte| byte.is_ascii_digit()).count();
        rest = &rest[part..];
    }
    Some((
        Code { letter: letter.to_ascii_uppercase(), number, has_part },
        Words { rest, bracket: None },
    ))
}

impl Words<'_> {
    /// Whether brackets stand among them, in which no number may stand.
    pub(super) fn has_brackets(&self) -> bool {
        memchr::memchr2(b'{', b'[', self.rest).is_some()
    }
}

impl Iterator for Words<'_> {
    /// An upper-case letter, and its number if there is a usable one.
    type Item = (u8, Option<f64>);

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            let (&byte, rest) = self.rest.split_first()?;
            self.rest = rest;
            if byte == b'(' {
                // A comment in brackets.
                let end = rest.iter().position(|&byte| byte == b')').map_or(rest.len(), |k| k + 1);
                self.rest = &rest[end..];
            } else if byte.is_ascii_alphabetic() {
                let blank = self.rest.iter().take_while(|&&byte| byte == b' ').count();
                let (number, after) = number(&self.rest[blank..]);
                self.bracket = None;
                if number.is_some() {
                    self.rest = after;
                } else if let Some(after) = past_brackets(self.rest) {
                    (self.bracket, self.rest) = (self.rest.first().copied(), after);
                }
                return Some((byte.to_ascii_uppercase(), number));
            }
        }
    }
}

/// What follows a value in braces or square brackets, if one stands there: RepRapFirmware computes
/// `{move.axes[0].max}`, and `[first_layer_temperature]` was left by a slicer. None of it is a word.
fn past_brackets(text: &[u8]) -> Option<&[u8]> {
    let close = match text.first()? {
        b'{' => b'}',
        b'[' => b']',
        _ => return None,
    };
    let end = text.iter().position(|&byte| byte == close);
    Some(&text[end.map_or(text.len(), |end| end + 1)..])
}

/// Powers of ten that a double holds exactly.
const POWERS: [f64; 20] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16,
    1e17, 1e18, 1e19,
];

/// Larger numbers are no length, speed or time of a printer, and count as missing.
const LARGEST: f64 = 1e9;

/// The decimal number that `text` begins with, and what follows it. G-code knows no
/// exponents; digits that a double cannot hold are dropped.
pub(super) fn number(text: &[u8]) -> (Option<f64>, &[u8]) {
    let (negative, text) = match text.split_first() {
        Some((b'-', rest)) => (true, rest),
        Some((b'+', rest)) => (false, rest),
        _ => (false, text),
    };
    let whole = digits(text, 0);
    let part = match whole.rest.split_first() {
        Some((b'.', after)) => digits(after, whole.value),
        _ => Digits { kept: 0, count: 0, ..whole },
    };
    // Of a whole number digits are dropped only where it is too large for any use.
    let size = part.value as f64 / POWERS[part.kept.min(19)];
    if whole.count + part.count == 0 || size > LARGEST {
        return (None, part.rest);
    }
    (Some(if negative { -size } else { size }), part.rest)
}

/// Digits one after the other.
#[derive(Clone, Copy)]
struct Digits<'a> {
    /// What they say, after those before.
    value: u64,
    /// How many of them the value holds, and how many there are.
    kept: usize,
    count: usize,
    /// What follows them.
    rest: &'a [u8],
}

/// The digits that `text` begins with, after others of this value.
#[inline]
fn digits(text: &[u8], mut value: u64) -> Digits<'_> {
    const FULL: u64 = 10_u64.pow(17);
    let mut rest = text;
    while let [byte @ b'0'..=b'9', after @ ..] = rest
        && value < FULL
    {
        value = 10 * value + u64::from(byte - b'0');
        rest = after;
    }
    let kept = text.len() - rest.len();
    while let [b'0'..=b'9', after @ ..] = rest {
        rest = after;
    }
    Digits { value, kept, count: text.len() - rest.len(), rest }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(line: &str) -> (Code, Vec<(u8, Option<f64>)>) {
        let (code, _) = split(line.as_bytes());
        let (code, words) = command(code).unwrap();
        (code, words.collect())
    }

    #[test]
    fn words_come_in_any_shape() {
        let expected = vec![(b'X', Some(1.5)), (b'Y', Some(-0.25)), (b'E', None)];
        for line in [
            "G1 X1.5 Y-.25 E",
            "g01x+1.5y-0.250E",
            "N12 G1 X1.5Y-.25 (a Z9) E*71",
            "G 1 X 1.5 Y -.25 E",
        ] {
            let (code, words) = parsed(line);
            assert_eq!((code.letter, code.number), (b'G', 1));
            assert_eq!(words, expected, "{line}");
        }
        for line in ["M104 S[first_layer_temperature] T1", "M104 S{a.t[0]} T1"] {
            assert_eq!(parsed(line).1, [(b'S', None), (b'T', Some(1.0))], "{line}");
        }
        assert!(parsed("G92.1 X0").0.has_part);
        assert!(command(b"").is_none() && command(b"G").is_none() && command(b"GX1").is_none());
    }

    #[test]
    fn numbers_are_read_as_the_standard_library_does() {
        for text in ["0", "1", "123.456", "0.1", "99999.99999", ".5", "7.", "0.30000000000000004"] {
            let (value, rest) = number(text.as_bytes());
            assert!((value.unwrap() - text.parse::<f64>().unwrap()).abs() < 1e-15, "{text}");
            assert!(rest.is_empty());
        }
        for text in ["", "-", ".", "nan", &"9".repeat(400)] {
            assert_eq!(number(text.as_bytes()).0, None, "{text}");
        }
        // No exponents: what follows is another word.
        assert_eq!(number(b"1e5"), (Some(1.0), &b"e5"[..]));
    }

    #[test]
    fn comments_and_checksums_are_no_code() {
        assert_eq!(split(b"G1 X1 ; a;b"), (&b"G1 X1"[..], Some(&b" a;b"[..])));
        assert_eq!(split(b";TYPE:FILL"), (&b""[..], Some(&b"TYPE:FILL"[..])));
        assert_eq!(split(b"N3 G1*4 ; x"), (&b"G1"[..], None));
    }
}
