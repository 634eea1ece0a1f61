//! First bytes -> format: recognizes ASCII STL, and other formats that someone named `.stl`.

/// Bytes of the head that must be text for a file to be text. The count of a binary STL lies
/// within the first 84, so that a binary file has a control character among these.
const TEXT: usize = 1024;

/// The known format other than STL that the bytes begin like, and what to do about it.
pub(super) fn foreign(bytes: &[u8]) -> Option<&'static str> {
    let magic: [(&[u8], &str); 7] = [
        (b"\x1f\x8b", "a gzip archive; unpack it first"),
        (b"PK\x03\x04", "a ZIP archive or 3MF file; unpack it, or export the model as STL"),
        (b"\xff\xfe", "UTF-16 text; save it as ASCII or export it as binary STL"),
        (b"\xfe\xff", "UTF-16 text; save it as ASCII or export it as binary STL"),
        (b"\0s\0o\0l\0i\0d", "UTF-16 text; save it as ASCII or export it as binary STL"),
        (b"s\0o\0l\0i\0d\0", "UTF-16 text; save it as ASCII or export it as binary STL"),
        (b"%PDF", "a PDF document; export the model as STL"),
    ];
    magic
        .iter()
        .find(|(start, _)| bytes.starts_with(start))
        .map(|&(_, what)| what)
        .or_else(|| if is_text(bytes) { foreign_text(bytes) } else { None })
}

fn foreign_text(bytes: &[u8]) -> Option<&'static str> {
    let start = trimmed(bytes);
    let starts: [(&str, &str); 7] = [
        ("version https://git-lfs", "a Git LFS pointer, not the file itself; run `git lfs pull`"),
        ("<!doctype html", "an HTML page; download the model itself"),
        ("<html", "an HTML page; download the model itself"),
        ("<", "an XML file; export the model as STL"),
        ("ply", "a PLY model; export it as STL"),
        ("off", "an OFF model; export it as STL"),
        ("iso-10303-21", "a STEP model; export it as STL"),
    ];
    if let Some((_, what)) = starts.iter().find(|(word, _)| starts_with(start, word)) {
        return Some(what);
    }
    let head = &start[..start.len().min(TEXT)];
    let mut lines = head.split(|&byte| byte == b'\n' || byte == b'\r');
    let obj = lines.any(|line| starts_with(line, "v ") || starts_with(line, "mtllib "));
    obj.then_some("a Wavefront OBJ model; export it as STL")
}

/// Whether `bytes` begin as text: no control characters but white space. Bytes above 127 count
/// as text, since names may be in any encoding.
pub(super) fn is_text(bytes: &[u8]) -> bool {
    bytes[..bytes.len().min(TEXT)].iter().all(|&byte| byte != 0 && plain(byte))
}

/// Where the text of an ASCII STL begins, if `bytes` can be one: at `solid`. A byte order mark,
/// blanks and lines of other text may come before it.
///
/// A binary file may begin with `solid` too, but has NUL bytes early on: below 16 million
/// triangles its count has one. A text with NUL bytes is taken for a damaged ASCII STL only if
/// `endfacet` stands after the place of a binary header; its reader then refuses it.
pub(super) fn ascii_start(bytes: &[u8]) -> Option<usize> {
    let head = &bytes[..bytes.len().min(TEXT)];
    if !head.iter().all(|&byte| plain(byte)) {
        return None;
    }
    let start = bytes.len() - trimmed(bytes).len();
    if starts_with(&bytes[start..], "solid") {
        let nul = head.contains(&0);
        return (!nul || contains(bytes.get(84..)?, "endfacet")).then_some(start);
    }
    if head.contains(&0) {
        return None;
    }
    let mut at = 0;
    for line in bytes.split_inclusive(|&byte| byte == b'\n' || byte == b'\r') {
        let text = trimmed(line);
        if starts_with(text, "solid") {
            return Some(at + line.len() - text.len());
        }
        at += line.len();
    }
    None
}

/// Whether a byte is white space, NUL or no control character.
fn plain(byte: u8) -> bool {
    byte == 0 || (byte >= 0x20 && byte != 0x7f) || (0x09..=0x0d).contains(&byte)
}

/// The bytes without a UTF-8 byte order mark and leading white space.
fn trimmed(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes).trim_ascii_start()
}

fn starts_with(bytes: &[u8], word: &str) -> bool {
    bytes.get(..word.len()).is_some_and(|start| start.eq_ignore_ascii_case(word.as_bytes()))
}

fn contains(bytes: &[u8], word: &str) -> bool {
    bytes.windows(word.len()).any(|part| part.eq_ignore_ascii_case(word.as_bytes()))
}

/// The start of the first line of a text, in quotes.
pub(super) fn first_line(head: &[u8]) -> String {
    let line = head.trim_ascii_start().split(|&byte| byte == b'\n' || byte == b'\r').next();
    quote(line.unwrap_or_default())
}

/// The start of some text in quotes, fit for a message of one line.
pub(super) fn quote(text: &[u8]) -> String {
    // A word may be of any length.
    let text = String::from_utf8_lossy(&text[..text.len().min(100)]);
    let mut short: String = text.chars().take(24).filter(|c| !c.is_control()).collect();
    if text.chars().nth(24).is_some() {
        short.push('…');
    }
    format!("'{short}'")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn other_formats_are_named() {
        let named = |bytes: &[u8]| foreign(bytes).unwrap_or("nothing").to_owned();
        assert!(named(b"\x1f\x8b\x08\x00").contains("gzip"));
        assert!(named(b"\n<!DOCTYPE html><html>").contains("HTML"));
        assert!(named(b"# a cube\nv 0 0 0\nv 1 0 0\n").contains("OBJ"));
        assert!(named(b"version https://git-lfs.github.com/spec/v1\n").contains("git lfs pull"));
        assert!(named(b"\xff\xfes\0o\0l\0i\0d\0").contains("UTF-16"));
        assert_eq!(named(b"solid name\nfacet normal 0 0 1\n"), "nothing");
    }

    #[test]
    fn quotes_are_short_and_of_one_line() {
        assert_eq!(quote(b"a\nb\x07\xff"), "'ab\u{fffd}'");
        assert_eq!(quote(&[b'x'; 99]).chars().count(), 27);
    }

    #[test]
    fn ascii_begins_at_solid() {
        assert_eq!(ascii_start(b"solid x"), Some(0));
        assert_eq!(ascii_start(b"\xef\xbb\xbf Solid x"), Some(4));
        assert_eq!(ascii_start(b"; a comment\n  solid x"), Some(14));
        assert_eq!(ascii_start(b"a solid block"), None);
        let mut binary = b"solid facet normal endfacet".to_vec();
        binary.resize(80, b' ');
        binary.extend([12, 0, 0, 0]);
        binary.resize(700, 0);
        assert_eq!(ascii_start(&binary), None);
    }
}
