//! Text -> RawMesh: reads ASCII STL word by word, so that its lines do not matter.

use super::RawMesh;
use super::coordinate::{complaint, usable};
use super::weld::{MAX_TRIANGLES, Welder};

/// What a facet takes at least, in bytes, for a bound on what is allocated ahead.
const FACET_BYTES: usize = 80;

/// The words that have a place inside a facet only.
const INNER_WORDS: [&str; 6] = ["normal", "outer", "loop", "vertex", "endloop", "endfacet"];

type Result<T> = std::result::Result<T, String>;

/// Reads the ASCII STL that begins at byte `start`. Keywords may be in any case;
/// `solid` blocks are joined; names, normals and stray words between facets are skipped.
///
/// # Errors
/// The line, the cause and what to do, as text without the file's name.
pub(crate) fn parse(bytes: &[u8], start: usize) -> Result<RawMesh> {
    let mut words = Words { bytes, at: 0, line: 1 };
    if let Some(nul) = bytes.iter().position(|&byte| byte == 0) {
        words.bytes = &bytes[..nul];
        while words.next().is_some() {}
        return Err(format!(
            "line {}: NUL bytes within the text; the file is damaged: export it again",
            words.line
        ));
    }
    while words.at < start {
        words.blank();
    }
    let mut welder = Welder::with_capacity((bytes.len() / FACET_BYTES).min(MAX_TRIANGLES));
    let mut facets = 0_usize;
    while let Some(word) = words.next() {
        if is(word, "solid") || is(word, "endsolid") {
            words.skip_name();
        } else if is(word, "facet") {
            facets += 1;
            if facets > MAX_TRIANGLES {
                return Err(format!("has more than {MAX_TRIANGLES} triangles; simplify the model"));
            }
            welder.add(facet(&mut words)?);
        } else if INNER_WORDS.iter().any(|inner| is(word, inner)) {
            return Err(words.wrong(word, "facet"));
        }
    }
    let mut mesh = welder.finish();
    mesh.report.format = "ascii";
    Ok(mesh)
}

/// Reads what follows `facet` up to `endfacet`.
fn facet(words: &mut Words) -> Result<[[f32; 3]; 3]> {
    // The normal says nothing that the corners do not, so that its numbers may be anything.
    words.skip_to("outer", &["normal"])?;
    let word = words.expect()?;
    if !is(word, "loop") {
        return Err(words.wrong(word, "loop"));
    }
    let mut corners = [[0.0; 3]; 3];
    let mut count = 0;
    loop {
        let word = words.expect()?;
        if is(word, "endloop") {
            break;
        }
        if !is(word, "vertex") {
            return Err(words.wrong(word, "vertex or endloop"));
        }
        let corner = vertex(words)?;
        if let Some(slot) = corners.get_mut(count) {
            *slot = corner;
        }
        count += 1;
    }
    if count != 3 {
        return Err(format!(
            "line {}: a loop of {count} corners; STL knows triangles only: \
             triangulate the model and export it again",
            words.line
        ));
    }
    words.skip_to("endfacet", &[])?;
    Ok(corners)
}

/// Reads the three numbers after `vertex`.
fn vertex(words: &mut Words) -> Result<[f32; 3]> {
    let mut corner = [0.0; 3];
    for slot in &mut corner {
        let word = words.expect()?;
        let number = std::str::from_utf8(word).ok().and_then(|text| text.parse::<f32>().ok());
        let Some(number) = number else {
            return Err(words.no_number(word));
        };
        if !usable(number) {
            return Err(format!(
                "line {}: {}; mend or export the model again",
                words.line,
                complaint(number)
            ));
        }
        *slot = number;
    }
    Ok(corner)
}

/// The words of a text with the line of the last one read.
#[derive(Debug, Clone, Copy)]
struct Words<'a> {
    bytes: &'a [u8],
    at: usize,
    /// Counted from 1; LF, CR LF and CR end a line.
    line: usize,
}

impl<'a> Words<'a> {
    fn next(&mut self) -> Option<&'a [u8]> {
        while self.bytes.get(self.at).copied().is_some_and(blank) {
            self.blank();
        }
        let rest = &self.bytes[self.at..];
        let length = rest.iter().position(|&byte| blank(byte)).unwrap_or(rest.len());
        self.at += length;
        (length > 0).then(|| &rest[..length])
    }

    /// Steps over one byte and counts the line that it ends.
    fn blank(&mut self) {
        let byte = self.bytes[self.at];
        self.at += 1;
        if byte == b'\n' || (byte == b'\r' && self.bytes.get(self.at) != Some(&b'\n')) {
            self.line += 1;
        }
    }

    /// The next word of a facet.
    fn expect(&mut self) -> Result<&'a [u8]> {
        self.next().ok_or_else(|| {
            format!(
                "line {}: the file ends within a facet; it is cut off: \
                 export or download it again",
                self.line
            )
        })
    }

    /// Steps over the name of a solid: the rest of the line, or what stands before
    /// the next facet or `endsolid` in a file without line breaks.
    fn skip_name(&mut self) {
        let line = self.line;
        loop {
            let mut ahead = *self;
            let Some(word) = ahead.next() else { return };
            if ahead.line != line || is(word, "endsolid") {
                return;
            }
            if is(word, "facet") && { ahead }.next().is_some_and(|word| is(word, "normal")) {
                return;
            }
            *self = ahead;
        }
    }

    /// Steps over words up to and including `goal`; of STL's own words only `allowed` may come before it.
    fn skip_to(&mut self, goal: &str, allowed: &[&str]) -> Result<()> {
        loop {
            let word = self.expect()?;
            if is(word, goal) {
                return Ok(());
            }
            let outer = ["solid", "endsolid", "facet"];
            let known = INNER_WORDS.iter().chain(&outer).any(|known| is(word, known));
            if known && !allowed.iter().any(|known| is(word, known)) {
                return Err(self.wrong(word, goal));
            }
        }
    }

    fn wrong(&self, word: &[u8], expected: &str) -> String {
        format!(
            "line {}: {} stands where {expected} is expected; mend or export the file again",
            self.line,
            quote(word)
        )
    }

    fn no_number(&self, word: &[u8]) -> String {
        let advice = if word.contains(&b',') {
            "has a decimal comma; export it again with decimal points"
        } else {
            "stands where a number is expected; mend or export the file again"
        };
        format!("line {}: {} {advice}", self.line, quote(word))
    }
}

fn blank(byte: u8) -> bool {
    byte == b' ' || (0x09..=0x0d).contains(&byte)
}

fn is(word: &[u8], keyword: &str) -> bool {
    word.eq_ignore_ascii_case(keyword.as_bytes())
}

/// The start of some text in quotes, made fit for a message of one line.
pub(crate) fn quote(text: &[u8]) -> String {
    let text = String::from_utf8_lossy(text);
    let mut short: String = text.chars().take(24).filter(|c| !c.is_control()).collect();
    if text.chars().nth(24).is_some() {
        short.push('…');
    }
    format!("'{short}'")
}

#[cfg(test)]
mod tests {
    use super::*;

    const FACET: &str = "facet normal 0 0 nan outer loop\n vertex 0 0 0\n vertex 1 0 0\n \
                         vertex 0 1 0\nendloop endfacet\n";

    fn read(text: &str) -> RawMesh {
        parse(text.as_bytes(), 0).unwrap_or_else(|reason| panic!("{text}: {reason}"))
    }

    fn reason(text: &str) -> String {
        parse(text.as_bytes(), 0).expect_err("must be refused")
    }

    #[test]
    fn writers_differ() {
        let good = format!("solid name\n{FACET}endsolid name\n");
        let plain = read(&good).triangles;
        assert_eq!(plain.len(), 1);
        for text in [
            good.replace('\n', "\r\n"),
            good.replace('\n', "\r"),
            good.replace('\n', " "),
            good.replace(' ', "\t \x0b"),
            good.to_uppercase(),
            good.replace("name", ""),
            good.replace("name", "vertex facet outer"),
            good.replace("endsolid name", ""),
            good.replace("endloop", "endloop foo").replace("endfacet", "endfacet bar"),
            good.replace("vertex 1 0 0", "vertex +1.0E+00 -0 .0e-5"),
        ] {
            assert_eq!(read(&text).triangles, plain, "{text}");
        }
        assert_eq!(read(&good.repeat(2)).triangles.len(), 2);
        assert_eq!(read("solid a\nendsolid a\n").triangles.len(), 0);
    }

    #[test]
    fn faults_are_named_with_their_line() {
        let good = format!("solid name\n{FACET}endsolid\n");
        for (from, to, line, word) in [
            (" vertex 0 1 0\n", "", 5, "loop of 2"),
            ("vertex 0 1 0", "vertex 0 1 0 vertex 1 1 1", 6, "loop of 4"),
            ("vertex 1 0 0", "vertex 1 0", 5, "'vertex' stands where a number"),
            ("vertex 1 0 0", "vertex 1 0 0 0", 4, "'0' stands where vertex"),
            ("vertex 1 0 0", "vertex 1,5 0 0", 4, "decimal comma"),
            ("vertex 1 0 0", "vertex one 0 0", 4, "'one' stands where a number"),
            ("vertex 1 0 0", "vertex inf 0 0", 4, "no finite"),
            ("vertex 1 0 0", "vertex nan 0 0", 4, "no finite"),
            ("vertex 1 0 0", "vertex 1e30 0 0", 4, "absurdly large"),
            ("vertex 1 0 0", "vertex 1e99 0 0", 4, "no finite"),
            ("1 0\nendloop endfacet\nendsolid\n", "1 0\nendloop", 6, "ends within a facet"),
            ("facet normal", "facte normal", 2, "'normal' stands where facet"),
            ("endfacet\nend", "\nend", 7, "'endsolid' stands where endfacet"),
            ("vertex 1", "vertex \0 1", 4, "NUL"),
        ] {
            assert!(good.contains(from), "{from}");
            let text = reason(&good.replace(from, to));
            assert!(text.starts_with(&format!("line {line}: ")), "{to}: {text}");
            assert!(text.contains(word), "{to}: {text}");
        }
    }

    #[test]
    fn quotes_are_short_and_of_one_line() {
        assert_eq!(quote(b"a\nb\x07\xff"), "'ab\u{fffd}'");
        assert_eq!(quote(&[b'x'; 99]).chars().count(), 27);
    }
}
