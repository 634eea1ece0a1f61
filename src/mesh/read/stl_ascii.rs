//! Text -> RawMesh: reads ASCII STL word by word, so that its line breaks do not matter.
//!
//! A word is what stands between white space. A facet is
//! `facet normal x y z outer loop vertex x y z vertex x y z vertex x y z endloop endfacet`;
//! facets stand between `solid NAME` and `endsolid NAME`.
//!
//! The parser is a state machine: [`State`] says which word must come next. It is as tolerant as
//! the files that exist need, and no more:
//! - keywords may be in any case, and lines may end in LF, CR LF or CR, or be missing;
//! - `solid` blocks are joined, and the last `endsolid` may be missing;
//! - names and unknown words between facets are skipped, and so are unknown words before
//!   `outer` and `endfacet`; a keyword in the wrong place is an error, but not in a name;
//! - a normal may be anything, since the order of the corners counts;
//! - each corner must have three numbers and each facet three corners.
//!
//! The text is read in chunks. A word that a chunk cuts in two stays in the buffer until the next
//! chunk completes it.

use super::error::{Damaged, Place, ReadError, Truncated};
use super::limit::{CHUNK, Limit};
use super::number::usable;
use super::sniff::quote;
use super::weld::{Facet, Welder};
use crate::mesh::RawMesh;
use std::io::Read;

/// The keywords that stand inside a facet only.
const INNER_WORDS: [&str; 6] = ["normal", "outer", "loop", "vertex", "endloop", "endfacet"];

/// The keywords that stand outside of facets only.
const OUTER_WORDS: [&str; 3] = ["solid", "endsolid", "facet"];

type Result<T> = std::result::Result<T, ReadError>;

/// Reads the ASCII STL that begins at byte `start`, and no more of it than the triangles that
/// `limit` allows can need.
///
/// # Errors
/// A word or a number that does not belong where it stands, with its line; a text that ends too
/// early; a source that fails.
pub(super) fn read(from: &mut dyn Read, start: usize, limit: Limit) -> Result<RawMesh> {
    let mut parser = Parser { line: 1, ..Parser::default() };
    let mut text = Vec::new();
    from.take(start as u64).read_to_end(&mut text)?;
    text.drain(..).for_each(|byte| parser.blank(byte));
    let mut length = 0_u64;
    loop {
        let before = text.len();
        from.take(CHUNK).read_to_end(&mut text)?;
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
            return Err(Damaged::Nul { line }.into());
        }
        let triangles = parser.welder.count();
        if length > limit.most_bytes(triangles) {
            return Err(Damaged::Text { line, bytes: length, triangles }.into());
        }
        text.drain(..used);
    }
}

/// What must come next.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
enum State {
    /// A facet or a solid, or words that mean nothing.
    #[default]
    Between,
    /// The name of a solid: the rest of the line with this number. In a file without line
    /// breaks, the words up to the next facet or `endsolid`.
    Name(usize),
    /// The same after the word `facet`: a facet begins if `normal` follows.
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
    /// The current line, counted from 1.
    line: usize,
    after_return: bool,
    /// The facet's normal, NaN for a word that is no number, and how many words it has.
    normal: [f32; 3],
    normal_words: usize,
    corners: [[f32; 3]; 3],
    /// Numbers of corners so far.
    numbers: usize,
    /// The line of the `solid` whose name may be what was taken for a facet.
    guess: Option<usize>,
    /// What was wrong with it, and its line: in a file without line breaks it was a facet.
    wrong: Option<(usize, ReadError)>,
}

impl Parser {
    /// Parses the words of `text` that end in it. Returns how many bytes these take.
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

    /// Counts the line that a white-space byte ends, if it does.
    fn blank(&mut self, byte: u8) {
        if byte == b'\r' || (byte == b'\n' && !self.after_return) {
            self.line += 1;
        }
        self.after_return = byte == b'\r';
    }

    /// Parses the next word; an empty one is skipped.
    fn word(&mut self, word: &[u8], limit: Limit) -> Result<()> {
        if word.is_empty() {
            return Ok(());
        }
        self.after_return = false;
        // A name may have words of a facet in it, but no facet ends there.
        if let Some(line) = self.guess.filter(|line| *line != self.line)
            && self.state != State::Name(line)
            && ["facet", "endsolid"].iter().any(|next| is(word, next))
        {
            self.state = State::Between;
            self.guess = None;
        }
        match (self.next(word, limit), self.guess) {
            (Ok(state), _) => self.state = state,
            (Err(error), Some(line)) if line == self.line => {
                self.state = State::Name(line);
                self.guess = None;
                self.wrong.get_or_insert((line, error));
            }
            (Err(error), _) => return Err(error),
        }
        Ok(())
    }

    /// The state after a word.
    fn next(&mut self, word: &[u8], limit: Limit) -> Result<State> {
        Ok(match self.state {
            State::Between => self.between(word)?,
            State::NameOrFacet(line) if is(word, "normal") => {
                self.guess = Some(line);
                self.facet()
            }
            State::Name(line) | State::NameOrFacet(line) => self.name(word, line)?,
            State::Normal => self.normal(word)?,
            State::Loop if is(word, "loop") => State::Corners,
            State::Loop => return Err(self.wrong(word, "loop")),
            State::Corners => self.corner(word)?,
            State::Number => self.number(word)?,
            State::End if is(word, "endfacet") => {
                if self.welder.count() >= limit.triangles {
                    let (announced, most) = (None, limit.triangles);
                    return Err(ReadError::TooManyTriangles { announced, most });
                }
                self.welder.add(&Facet::new(self.normal, self.corners));
                self.guess = None;
                if let Some((_, error)) = self.wrong.take().filter(|(line, _)| *line == self.line) {
                    return Err(error);
                }
                State::Between
            }
            State::End => self.other(word, "endfacet")?,
        })
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

    /// A word of a name, or after it; `line` is that of `solid`.
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

    /// A word before `outer`: part of a normal.
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
            return Err(Damaged::Loop { line: self.line, corners: count }.into());
        }
        Ok(State::End)
    }

    fn number(&mut self, word: &[u8]) -> Result<State> {
        let Some(number) = parsed(word) else {
            return Err(self.no_number(word));
        };
        if !usable(number) {
            return Err(ReadError::Coordinate { place: Place::Line(self.line), number });
        }
        // Those of a fourth corner are only counted.
        if let Some(slot) = self.corners.as_flattened_mut().get_mut(self.numbers) {
            *slot = number;
        }
        self.numbers += 1;
        Ok(if self.numbers.is_multiple_of(3) { State::Corners } else { State::Number })
    }

    /// Skips a word before `goal`, unless it is a keyword.
    fn other(&self, word: &[u8], goal: &'static str) -> Result<State> {
        if INNER_WORDS.iter().chain(&OUTER_WORDS).any(|known| is(word, known)) {
            return Err(self.wrong(word, goal));
        }
        Ok(self.state)
    }

    fn finish(self) -> Result<RawMesh> {
        let is_done = matches!(self.state, State::Between | State::Name(_) | State::NameOrFacet(_));
        // The last name may have words of a facet in it, too.
        let is_name = self.guess.is_some() && self.welder.count() > 0;
        if !is_done && !is_name {
            return Err(Truncated::Text { line: self.line }.into());
        }
        let mut mesh = self.welder.finish();
        mesh.report.format = "ascii";
        Ok(mesh)
    }

    fn wrong(&self, word: &[u8], expected: &'static str) -> ReadError {
        Damaged::Word { line: self.line, word: quote(word), expected }.into()
    }

    fn no_number(&self, word: &[u8]) -> ReadError {
        if word.contains(&b',') {
            return Damaged::DecimalComma { line: self.line, word: quote(word) }.into();
        }
        self.wrong(word, "a number")
    }
}

/// The word as a number, if it is one.
fn parsed(word: &[u8]) -> Option<f32> {
    std::str::from_utf8(word).ok()?.parse().ok()
}

fn blank(byte: u8) -> bool {
    byte == b' ' || (0x09..=0x0d).contains(&byte)
}

fn is(word: &[u8], keyword: &str) -> bool {
    word.eq_ignore_ascii_case(keyword.as_bytes())
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
        let error = super::read(&mut text.as_bytes(), 0, ANY).expect_err("must be refused");
        error.to_string()
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
            good.replace("solid name", "solid facet normal"),
            good.replace("solid name", "solid facet normal outer loop vertex 1 2 3"),
            good.replace("solid name", "solid facet normal outer loop vertex a b c endloop"),
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
}
