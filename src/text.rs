//! Text of files and names -> text that is safe to show: the one place where characters are escaped.
//!
//! A terminal obeys control characters, a log takes a line feed for a new message, and some marks of
//! Unicode turn the direction of what follows. Comments of G-code, names of files and values of
//! profiles may hold any of them. What is written out is right in JSON and TOML, too.

use std::borrow::Cow;
use std::ffi::OsStr;

/// Whether a character does something instead of being seen: control characters, separators of lines
/// and paragraphs, and what changes the direction of text.
#[must_use]
pub fn acts(character: char) -> bool {
    let turns = matches!(character, '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    character.is_control() || matches!(character, '\u{2028}' | '\u{2029}') || turns
}

/// A text of several lines with all else that [`acts`] written out, such as `\u001b`. Line feeds and
/// tabs stay.
#[must_use]
pub fn harmless(text: &str) -> Cow<'_, str> {
    escaped(text, |c| acts(c) && c != '\n' && c != '\t')
}

/// A text as one line: line feeds and tabs are written out as well.
#[must_use]
pub fn line(text: &str) -> Cow<'_, str> {
    escaped(text, acts)
}

/// The name of a file for people, on one line. What is no UTF-8 becomes U+FFFD: such a name can be
/// read, but not be used to open the file.
#[must_use]
pub fn name(file: impl AsRef<OsStr>) -> String {
    line(&file.as_ref().to_string_lossy()).into_owned()
}

fn escaped(text: &str, acts: impl Fn(char) -> bool) -> Cow<'_, str> {
    if !text.contains(&acts) {
        return Cow::Borrowed(text);
    }
    let mut out = String::with_capacity(text.len() + 8);
    for c in text.chars() {
        match c {
            '\n' if acts(c) => out.push_str("\\n"),
            '\t' if acts(c) => out.push_str("\\t"),
            _ if acts(c) => out.push_str(&format!("\\u{:04x}", u32::from(c))),
            _ => out.push(c),
        }
    }
    Cow::Owned(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn control_characters_are_written_out() {
        assert_eq!(harmless("a\tb\n"), "a\tb\n");
        assert_eq!(
            harmless("\u{1b}[31mX\r\u{9b}2J\u{7f}é\n"),
            "\\u001b[31mX\\u000d\\u009b2J\\u007fé\n"
        );
        assert_eq!(harmless("a\u{202e}b\u{2028}"), "a\\u202eb\\u2028");
    }

    #[test]
    fn a_name_is_one_line() {
        assert_eq!(line("a\nerror: b\t\u{1b}"), "a\\nerror: b\\t\\u001b");
        assert_eq!(name("ä ö.stl"), "ä ö.stl");
    }

    #[cfg(unix)]
    #[test]
    fn a_name_that_is_no_utf_8_can_be_read() {
        use std::os::unix::ffi::OsStrExt as _;
        assert_eq!(name(OsStr::from_bytes(b"a\xff\n.stl")), "a\u{fffd}\\n.stl");
    }
}
