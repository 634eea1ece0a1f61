//! A source read twice -> Stream: the facts of the file, then its layers one after the other.
//!
//! Words used here: a *place* is the end of a line at which reading may go on; a *block* is what lies
//! between two of them; a *section* is the start, or a layer with its moves.
//!
//! 1. The first pass gathers the facts ([`Facts`]) and keeps no moves. At every so many bytes it notes
//!    a place, with all that the reader knows there.
//! 2. The second reads block by block, some side by side, each from what is known at its place; and
//!    hands out section by section.
//!
//! So only the moves of a few blocks and of the layer that they belong to are held, and the moves are
//! the same as those of [`Print`], for any number of threads.
//!
//! A file with few moves is kept as a whole in the first pass, and not read again.

use super::facts::Gatherer;
use super::layers::Layers;
use super::lines::{self, Place};
use super::print::{Kept, Print};
use super::state::State;
use super::step::{Layer, Note, Step};
use super::{Event, Facts, Reading, Source};
use rayon::prelude::*;
use std::collections::VecDeque;
use std::io;

/// Bytes of a block: read in a millisecond or two, and its moves take half a megabyte.
const BLOCK: u64 = 1 << 18;

/// Blocks that are read side by side at most, so that memory does not grow with the machine.
const MOST_BLOCKS: usize = 16;

/// Moves and notes of a file that is kept as a whole, at most: some 15 MB, of 10 MB of G-code. Two such files
/// are compared in as much memory again as one needs that is read twice.
const MOST_KEPT: usize = 300_000;

/// A file that is read layer by layer.
#[derive(Debug)]
pub struct Stream {
    source: Source,
    /// The file, without moves and notes unless it is kept as a whole.
    print: Print,
    is_whole: bool,
    /// Where blocks begin, and where the last one ends.
    places: Vec<Known>,
}

/// All that is known at a place of the file.
#[derive(Debug, Clone)]
struct Known {
    place: Place,
    /// Lines before it.
    line: u64,
    /// Moves before it.
    moves: usize,
    state: State,
}

/// The start, or a layer, with its moves.
#[derive(Debug, Clone, PartialEq)]
pub struct Section {
    /// Which layer it is, from 0; `None` for what comes before the first.
    pub layer: Option<usize>,
    /// How many moves come before.
    pub first: usize,
    /// Its moves.
    pub moves: Vec<Step>,
    /// What lies between them; places count over all moves of the file.
    pub notes: Vec<Note>,
}

impl Stream {
    /// Reads a file for the first time. `filament_diameter`, in mm, gives the widths of lines without
    /// a comment, unless the file has a diameter of its own.
    ///
    /// # Errors
    /// Only what reading the bytes gives: no content is an error.
    pub fn open(
        source: Source,
        reading: impl Into<Reading>,
        filament_diameter: f64,
    ) -> io::Result<Self> {
        Self::keeping(MOST_KEPT, (source, reading.into()), filament_diameter)
    }

    /// As [`Self::open`]; a file with at most `most` moves and notes is kept.
    fn keeping(
        most: usize,
        (source, reading): (Source, Reading),
        filament_diameter: f64,
    ) -> io::Result<Self> {
        let (mut gatherer, mut layers) = (Gatherer::default(), Layers::default());
        let mut kept = Some(Kept::default());
        let state = State::new(reading);
        let mut known = Known { place: Place::default(), line: 0, moves: 0, state };
        let mut places = vec![known.clone()];
        let mut next = BLOCK;
        let end = {
            let mut sink = |line: u64, event: Event| {
                gatherer.event(line, &event);
                let Some(all) = &mut kept else { return };
                all.event(line, event);
                if all.moves.len() + all.notes.len() > most {
                    kept = None;
                }
            };
            let mut reader = source.reader();
            let end = lines::each(&mut reader, known.place, &mut |line, place| {
                known.line += 1;
                let Known { state, moves, line: number, .. } = &mut known;
                state.line(line, &mut |event| {
                    *moves += usize::from(matches!(event, Event::Move(_)));
                    layers.event(*number, event, &mut sink);
                });
                if place.offset >= next {
                    known.place = place;
                    places.push(known.clone());
                    next = place.offset + BLOCK;
                }
            })?;
            layers.finish(&mut sink);
            end
        };
        let facts = gatherer.facts(known.state.summary, filament_diameter);
        places.push(Known { place: end, ..known });
        let is_whole = kept.is_some();
        let Kept { mut moves, notes, .. } = kept.unwrap_or_default();
        facts.measure(0, &mut moves);
        Ok(Self { source, print: Print { facts, moves, notes }, is_whole, places })
    }

    /// The whole file, if it is kept.
    #[must_use]
    pub fn whole(&self) -> Option<&Print> {
        self.is_whole.then_some(&self.print)
    }

    /// The file itself.
    #[must_use]
    pub fn source(&self) -> &Source {
        &self.source
    }

    /// What is known of the file as a whole.
    #[must_use]
    pub fn facts(&self) -> &Facts {
        &self.print.facts
    }

    /// The start, then all layers in the file's order, read for the second time if the file is not kept. Errors are what
    /// reading gives, and that the file is not the same any more; nothing comes after one.
    pub fn sections(&self) -> impl Iterator<Item = io::Result<Section>> + Send {
        Sections {
            stream: self,
            next_block: 0,
            next: Some(0),
            moves: VecDeque::new(),
            notes: VecDeque::new(),
            first: 0,
        }
    }

    /// Reads a block.
    fn block(&self, block: usize) -> io::Result<Kept> {
        let [from, to] = [block, block + 1].map(|k| &self.places[k]);
        let bytes = self.source.bytes(from.place.offset, to.place.offset)?;
        let (mut state, mut line) = (from.state.clone(), from.line);
        let (unknown, numberless) = (state.summary.unknown, state.summary.numberless);
        let mut kept = Kept { unknown, numberless, ..Kept::default() };
        kept.moves.reserve_exact(to.moves - from.moves);
        let end = lines::each(&mut &bytes[..], from.place, &mut |text, _| {
            line += 1;
            state.line(text, &mut |event| kept.event(line, event));
        })?;
        if kept.moves.len() != to.moves - from.moves || end.offset != to.place.offset {
            return Err(io::Error::other("it changed while it was read"));
        }
        self.print.facts.measure(from.moves, &mut kept.moves);
        kept.notes.iter_mut().for_each(|note| note.at += from.moves);
        Ok(kept)
    }
}

/// See [`Stream::sections`].
struct Sections<'a> {
    stream: &'a Stream,
    next_block: usize,
    /// Sections that were handed out; `None` after the last.
    next: Option<usize>,
    /// What is read and not handed out yet.
    moves: VecDeque<Step>,
    notes: VecDeque<Note>,
    /// Moves that were handed out.
    first: usize,
}

impl Sections<'_> {
    /// Reads until the moves before `end` are there.
    fn fill(&mut self, end: usize) -> io::Result<()> {
        let blocks = self.stream.places.len() - 1;
        while self.first + self.moves.len() < end && self.next_block < blocks {
            let some = rayon::current_num_threads().clamp(1, MOST_BLOCKS);
            let last = blocks.min(self.next_block + some);
            let read: Vec<io::Result<Kept>> = (self.next_block..last)
                .into_par_iter()
                .map(|block| self.stream.block(block))
                .collect();
            self.next_block = last;
            for kept in read {
                let kept = kept?;
                self.moves.extend(kept.moves);
                self.notes.extend(kept.notes);
            }
        }
        Ok(())
    }

    fn section(&mut self, index: usize) -> io::Result<Section> {
        let facts = self.stream.facts();
        if let Some(print) = self.stream.whole() {
            self.next = (index < facts.layers.len()).then_some(index + 1);
            let (range, notes) = print.section(index);
            let (first, moves) = (range.start, print.moves[range].to_vec());
            return Ok(Section {
                layer: index.checked_sub(1),
                first,
                moves,
                notes: notes.to_vec(),
            });
        }
        let layer = index.checked_sub(1);
        let range = layer.map_or(&facts.start, |layer| &facts.layers[layer].moves).clone();
        let is_last = index == facts.layers.len();
        // Notes after the last move lie in blocks that have none.
        self.fill(if is_last { usize::MAX } else { range.end })?;
        let notes = self.notes.iter().take_while(|note| is_last || note.at < range.end).count();
        self.first = range.end;
        self.next = (!is_last).then_some(index + 1);
        Ok(Section {
            layer,
            first: range.start,
            moves: self.moves.drain(..range.len().min(self.moves.len())).collect(),
            notes: self.notes.drain(..notes).collect(),
        })
    }
}

impl Iterator for Sections<'_> {
    type Item = io::Result<Section>;

    fn next(&mut self) -> Option<Self::Item> {
        let index = self.next?;
        let section = self.section(index);
        if section.is_err() {
            self.next = None;
        }
        Some(section)
    }
}

impl Section {
    /// Its lines.
    pub fn lines(&self) -> impl Iterator<Item = &Step> {
        self.moves.iter().filter(|step| step.is_line())
    }

    /// The facts of its layer; `None` for the start.
    #[must_use]
    pub fn of<'a>(&self, facts: &'a Facts) -> Option<&'a Layer> {
        facts.layers.get(self.layer?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reader::Print;
    use std::fmt::Write as _;

    /// A file with `layers` layers, marked or not, of many blocks, and notes all over.
    fn text(layers: usize, marked: bool) -> String {
        let mut text = String::from("; made = by hand\nM104 S200\nG1 X1 E1\n");
        for layer in 0..layers {
            if marked {
                text.push_str(";LAYER_CHANGE\n");
            }
            let _ =
                writeln!(text, "G1 Z{:.2}\r\nFOO {layer}\nM104 S{layer}", 0.2 + 0.2 * layer as f64);
            text.push_str("M83\n");
            for k in 0..4000 {
                let _ = writeln!(text, "G1 X{}.5 Y{} E0.5", k % 90, (7 * k + layer) % 80);
            }
        }
        text.push_str("G1 Z99\nBAR\n; filament_diameter = 2.85\nM84");
        text
    }

    #[test]
    fn layers_one_by_one_are_those_of_the_whole_file() {
        for (layers, marked) in [(0, false), (1, false), (9, true), (40, false), (40, true)] {
            let text = text(layers, marked);
            let print = Print::read(&mut text.as_bytes(), 1.75).unwrap();
            let is_kept = layers % 2 == 1;
            let most = if is_kept { print.moves.len() + print.notes.len() } else { 1 };
            let source = Source::of_bytes(text.into_bytes());
            let stream = Stream::keeping(most, (source, Reading::default()), 1.75).unwrap();
            assert_eq!(stream.facts(), &print.facts);
            assert_eq!(stream.whole(), is_kept.then_some(&print));
            assert!(print.layers.len() >= layers && (!marked || print.layers.len() == layers));
            let sections: Vec<Section> = stream.sections().map(Result::unwrap).collect();
            assert_eq!(sections.len(), print.layers.len() + 1);
            let (mut moves, mut notes) = (Vec::new(), Vec::new());
            for (k, section) in sections.into_iter().enumerate() {
                assert_eq!((section.layer, section.first), (k.checked_sub(1), moves.len()));
                let range = section.of(stream.facts()).map(|layer| layer.moves.clone());
                assert_eq!(range.unwrap_or(print.start.clone()).len(), section.moves.len());
                moves.extend(section.moves);
                notes.extend(section.notes);
            }
            assert_eq!((moves, notes), (print.moves, print.notes));
        }
    }

    #[test]
    fn what_is_kept_of_a_file_that_is_no_print_is_bounded() {
        let text = "x\n".repeat(100_000);
        let print = Print::read(&mut text.as_bytes(), 1.75).unwrap();
        assert_eq!((print.notes.len(), print.summary.unknown), (1000, 100_000));
        for most in [999, MOST_KEPT] {
            let source = Source::of_bytes(text.clone().into());
            let stream = Stream::keeping(most, (source, Reading::default()), 1.75).unwrap();
            let sections = stream.sections().map(Result::unwrap);
            assert_eq!(sections.map(|one| one.notes.len()).sum::<usize>(), 1000);
        }
    }
}
