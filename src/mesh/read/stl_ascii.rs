//! Text -> RawMesh: reads ASCII STL word by word, so that its lines do not matter.

use super::limit::{CHUNK, Limit, unreadable};
use super::number::{complaint, usable};
use super::weld::{Facet, Welder};
use crate::mesh::RawMesh;
use std::io::Read;

/// The words that have a place inside a facet only.
const INNER_WORDS: [&str; 6] = ["normal", "outer", "loop", "vertex", "endloop", "endfacet"];

/// The words that have a place outside of facets only.
const OUTER_WORDS: [&str; 3] = ["solid", "endsolid", "facet"];

type Result<T> = std::result::Result<T, String>;

/// Reads the ASCII STL that begins at byte `start`, and no more of it than as many triangles
/// as `limit` allows can need. Keywords may be in any case; `solid` blocks are joined; names
/// and stray words between facets are skipped.
///
/// # Errors
/// The line, the cause and what to do, as text without the file's name.
pub(crate) fn read(from: &mut dyn Read, start: usize, limit: Limit) -> Result<RawMesh> {
    let mut parser = Parser { line: 1, ..Parser::default() };
    let mut text = Vec::new();
    from.take(start as u64).read_to_end(&mut text).map_err(|error| unreadable(&error))?;
    text.drain(..).for_each(|byte| parser.blank(byte));
    let mut length = 0_u64;
    loop {
        let before = text.len();
        from.take(CHUNK).read_to_end(&mut text).map_err(|error| unreadable(&error))?;
        let read = text.len() - before;
        length += read as u64;
        if read == 0 {
            parser.word(&text, limit)?;
            return parser.finish();
        }
        let end = text[before..].iter().position(|&byte| byte == 0);
        let used = parser.words(&text[..end.map_or(text.len(), |end| before + end)], limit)?;
        let line = parser.line;
        if end.is_some() {
            let damage = "NUL bytes within the text; the file is damaged: export it again";
            return Err(format!("line {line}: {damage}"));
        }
        if length > limit.most_bytes(parser.welder.count()) {
            let count = parser.welder.count();
            return Err(format!(
                "line {line}: {length} bytes of text and only {count} triangles until here; it is \
                 damaged or no STL: export it again"
            ));
        }
        text.drain(..used);
    }
}

/// What comes next.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
enum State {
    /// A facet or a solid, or words that say nothing.
    #[default]
    Between,
    /// The name of a solid: the rest of this line, or what stands before the next facet or
    /// `endsolid` in a file without line breaks.
    Name(usize),
    /// The same after the word `facet`, with which a facet begins if `normal` follows.
    NameOrFacet(usize),
    /// The words up to `outer`.
    Normal,
    /// `loop`.
    Loop,
    /// `vertex` or `endloop`.
    Corners,
    /// A number of a corner.
    Number,
    /// The words up to `endfacet`.
    End,
}

/// Reads words, one after the other.
#[derive(Debug, Default)]
struct Parser {
    welder: Welder,
    state: State,
    /// The line, counted from 1; LF, CR LF and CR end one.
    line: usize,
    after_return: bool,
    /// The numbers of the facet's normal, as far as they are numbers, and how many words it has.
    normal: [f32; 3],
    normal_words: usize,
    corners: [[f32; 3]; 3],
    /// Numbers of corners so far.
    numbers: usize,
}

impl Parser {
    /// Takes the words of `text` that end in it, and says how many bytes of it are done with.
    fn words(&mut self, text: &[u8], limit: Limit) -> Result<usize> {
        let mut at = 0;
        loop {
            while let Some(&byte) = text.get(at).filter(|&&byte| blank(byte)) {
                self.blank(byte);
                at += 1;
            }
            let Some(length) = text[at..].iter().position(|&byte| blank(byte)) else {
                return Ok(at);
            };
            self.word(&text[at..at + length], limit)?;
            at += length;
        }
    }

    /// Counts the line that a byte ends.
    fn blank(&mut self, byte: u8) {
        if byte == b'\r' || (byte == b'\n' && !self.after_return) {
            self.line += 1;
        }
        self.after_return = byte == b'\r';
    }

    /// Takes the next word; the empty one is none.
    fn word(&mut self, word: &[u8], limit: Limit) -> Result<()> {
        if word.is_empty() {
            return Ok(());
        }
        self.after_return = false;
        self.state = match self.state {
            State::Between => self.between(word)?,
            State::NameOrFacet(_) if is(word, "normal") => self.facet(),
            State::Name(line) | State::NameOrFacet(line) => self.name(word, line)?,
            State::Normal => self.normal(word)?,
            State::Loop if is(word, "loop") => State::Corners,
            State::Loop => return Err(self.wrong(word, "loop")),
            State::Corners => self.corner(word)?,
            State::Number => self.number(word)?,
            State::End if is(word, "endfacet") => {
                if self.welder.count() >= limit.triangles {
                    return Err(limit.exceeded(&format!("has more than {}", limit.triangles)));
                }
                self.welder.add(&Facet::new(self.normal, self.corners));
                State::Between
            }
            State::End => self.other(word, "endfacet")?,
        };
        Ok(())
    }

    fn between(&mut self, word: &[u8]) -> Result<State> {
        if is(word, "solid") || is(word, "endsolid") {
            Ok(State::Name(self.line))
        } else if is(word, "facet") {
            Ok(self.facet())
        } else if INNER_WORDS.iter().any(|inner| is(word, inner)) {
            Err(self.wrong(word, "facet"))
        } else {
            Ok(State::Between)
        }
    }

    /// A word after that of `line` with `solid`.
    fn name(&mut self, word: &[u8], line: usize) -> Result<State> {
        if self.line != line || is(word, "endsolid") {
            return self.between(word);
        }
        Ok(if is(word, "facet") { State::NameOrFacet(line) } else { State::Name(line) })
    }

    fn facet(&mut self) -> State {
        (self.normal, self.normal_words, self.numbers) = ([0.0; 3], 0, 0);
        State::Normal
    }

    /// A word before `outer`: part of a normal, which may be anything.
    fn normal(&mut self, word: &[u8]) -> Result<State> {
        if is(word, "outer") {
            if self.normal_words != 3 {
                self.normal = [0.0; 3];
            }
            return Ok(State::Loop);
        }
        if is(word, "normal") {
            return Ok(State::Normal);
        }
        let state = self.other(word, "outer")?;
        if let Some(slot) = self.normal.get_mut(self.normal_words) {
            *slot = parsed(word).unwrap_or(f32::NAN);
        }
        self.normal_words += 1;
        Ok(state)
    }

    fn corner(&mut self, word: &[u8]) -> Result<State> {
        if is(word, "vertex") {
            return Ok(State::Number);
        }
        if !is(word, "endloop") {
            return Err(self.wrong(word, "vertex or endloop"));
        }
        let count = self.numbers / 3;
        if count != 3 {
            return Err(format!(
                "line {}: a loop of {count} corners; STL knows triangles only: \
                 triangulate the model and export it again",
                self.line
            ));
        }
        Ok(State::End)
    }

    fn number(&mut self, word: &[u8]) -> Result<State> {
        let Some(number) = parsed(word) else {
            return Err(self.no_number(word));
        };
        if !usable(number) {
            return Err(format!(
                "line {}: {}; mend or export the model again",
                self.line,
                complaint(number)
            ));
        }
        // Those of a fourth corner are only counted.
        if let Some(slot) = self.corners.as_flattened_mut().get_mut(self.numbers) {
            *slot = number;
        }
        self.numbers += 1;
        Ok(if self.numbers.is_multiple_of(3) { State::Corners } else { State::Number })
    }

    /// Steps over a word before `goal`, unless it is one of STL's own.
    fn other(&self, word: &[u8], goal: &str) -> Result<State> {
        if INNER_WORDS.iter().chain(&OUTER_WORDS).any(|known| is(word, known)) {
            return Err(self.wrong(word, goal));
        }
        Ok(self.state)
    }

    fn finish(self) -> Result<RawMesh> {
        if !matches!(self.state, State::Between | State::Name(_) | State::NameOrFacet(_)) {
            return Err(format!(
                "line {}: the file ends within a facet; it is cut off: \
                 export or download it again",
                self.line
            ));
        }
        let mut mesh = self.welder.finish();
        mesh.report.format = "ascii";
        Ok(mesh)
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

/// The number that a word is, if it is one.
fn parsed(word: &[u8]) -> Option<f32> {
    std::str::from_utf8(word).ok()?.parse().ok()
}

fn blank(byte: u8) -> bool {
    byte == b' ' || (0x09..=0x0d).contains(&byte)
}

fn is(word: &[u8], keyword: &str) -> bool {
    word.eq_ignore_ascii_case(keyword.as_bytes())
}

/// The start of some text in quotes, made fit for a message of one line.
pub(crate) fn quote(text: &[u8]) -> String {
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

    const ANY: Limit = Limit { triangles: 1000 };

    const FACET: &str = "facet normal 0 0 nan outer loop\n vertex 0 0 0\n vertex 1 0 0\n \
                         vertex 0 1 0\nendloop endfacet\n";

    fn read(text: &str) -> RawMesh {
        super::read(&mut text.as_bytes(), 0, ANY)
            .unwrap_or_else(|reason| panic!("{text}: {reason}"))
    }

    fn reason(text: &str) -> String {
        super::read(&mut text.as_bytes(), 0, ANY).expect_err("must be refused")
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
