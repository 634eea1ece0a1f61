//! Bytes -> name of a format: tells a user who named something else `.stl` what it is.

/// How much of a file's start is looked at.
const HEAD: usize = 1024;

/// What the bytes seem to be, if that is a known format other than STL, and what to do about it.
pub(crate) fn foreign(bytes: &[u8]) -> Option<&'static str> {
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
    let head = &start[..start.len().min(HEAD)];
    let mut lines = head.split(|&byte| byte == b'\n' || byte == b'\r');
    let obj = lines.any(|line| starts_with(line, "v ") || starts_with(line, "mtllib "));
    obj.then_some("a Wavefront OBJ model; export it as STL")
}

/// Whether the start of `bytes` is text: no control characters but white space.
/// Bytes above 127 are let through, for names in any encoding.
pub(crate) fn is_text(bytes: &[u8]) -> bool {
    bytes[..bytes.len().min(HEAD)].iter().all(|&byte| byte != 0 && plain(byte))
}

/// Where the text of an ASCII STL begins, if `bytes` can be one: at `solid`,
/// which a byte order mark, blanks and lines of other text may precede.
///
/// A binary file may begin with `solid` too. It has NUL bytes early on, because
/// its count has (below 16 million triangles); a text with NUL bytes is taken
/// for ASCII, and then refused for them, when `endfacet` stands after the place of a header.
pub(crate) fn ascii_start(bytes: &[u8]) -> Option<usize> {
    let head = &bytes[..bytes.len().min(HEAD)];
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

/// White space and everything that is no control character; NUL as well.
fn plain(byte: u8) -> bool {
    byte == 0 || (byte >= 0x20 && byte != 0x7f) || (0x09..=0x0d).contains(&byte)
}

/// Without a UTF-8 byte order mark and leading white space.
fn trimmed(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes).trim_ascii_start()
}

fn starts_with(bytes: &[u8], word: &str) -> bool {
    bytes.get(..word.len()).is_some_and(|start| start.eq_ignore_ascii_case(word.as_bytes()))
}

fn contains(bytes: &[u8], word: &str) -> bool {
    bytes.windows(word.len()).any(|part| part.eq_ignore_ascii_case(word.as_bytes()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn other_formats_are_named() {
        let said = |bytes: &[u8]| foreign(bytes).unwrap_or("nothing").to_owned();
        assert!(said(b"\x1f\x8b\x08\x00").contains("gzip"));
        assert!(said(b"\n<!DOCTYPE html><html>").contains("HTML"));
        assert!(said(b"# a cube\nv 0 0 0\nv 1 0 0\n").contains("OBJ"));
        assert!(said(b"version https://git-lfs.github.com/spec/v1\n").contains("git lfs pull"));
        assert!(said(b"\xff\xfes\0o\0l\0i\0d\0").contains("UTF-16"));
        assert_eq!(said(b"solid name\nfacet normal 0 0 1\n"), "nothing");
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
