//! Stream and Estimate of a file -> Side: a file as it is compared, and its halves one after the other.
//!
//! Words used here: a *floor* is what is known of a layer without its moves; the *moves* of a half are
//! those from the last line of the half before to its own last line.
//!
//! A file is read several times, and never held as a whole:
//! 1. the stream has its facts, and the estimate its times;
//! 2. all layers are read for the boxes around them and for where commands belong ([`Side::new`]);
//! 3. they are read again for each comparison ([`Side::layer`]), layer by layer beside those of the
//!    other file.

use super::align::Level;
use super::codes::{Codes, Heat, Places};
use super::half::Half;
use super::moved::Floor;
use super::sums::{self, Shape};
use crate::estimate::Estimate;
use crate::reader::print::Step;
use crate::reader::stream::Section;
use crate::reader::{Cause, Error, Facts, Firmware, Role, Source, Stream};
use std::io::{self, BufReader};

/// Commands for heaters that are kept: more than any slicer writes.
const MOST_HEATS: usize = 50_000;

/// Diameter that widths are worked out with where a file gives none, mm: the most usual one. What is
/// compared is the filament itself.
const SOME_DIAMETER: f64 = 1.75;

/// Bytes that are read at once.
const BUFFER: usize = 1 << 18;

/// A file as it is compared.
#[derive(Debug)]
pub struct Side {
    /// Its name for messages.
    name: String,
    stream: Stream,
    /// Its settings, by today's names.
    pub(super) values: Vec<(String, String)>,
    pub(super) estimate: Estimate,
    /// Its layers, from the bed up.
    pub(super) floors: Vec<Floor>,
    /// Whether the file gives roles of lines.
    pub(super) has_roles: bool,
    pub(super) codes: Codes,
    /// The file's line with which the first layer begins, from 1.
    first_line: u32,
}

impl Side {
    /// The file `name`, timed as `estimate`. Both files are to be timed with the same limits. `values`
    /// are the settings in its comments, by the names that are to be compared.
    ///
    /// # Errors
    /// [`Cause::Unreadable`].
    pub fn new(
        name: &str,
        stream: Stream,
        values: Vec<(String, String)>,
        estimate: Estimate,
    ) -> Result<Self, Error> {
        let unreadable = |error| Cause::Unreadable(error).of(name);
        let roles = [Role::Other, Role::Travel, Role::Retraction, Role::NonPlanar];
        let mut roles = Role::ALL.into_iter().filter(|role| !roles.contains(role));
        let has_roles = roles.any(|role| stream.facts().has(role));
        let Survey { floors, places, heats, first_line } =
            Survey::new(&stream).map_err(unreadable)?;
        let codes = {
            let mut source = BufReader::with_capacity(BUFFER, stream.source().reader());
            Codes::read(&mut source, &heats, &places).map_err(unreadable)?
        };
        let first_line = first_line.unwrap_or(u32::MAX);
        let name = name.to_owned();
        Ok(Self { name, stream, values, estimate, floors, has_roles, codes, first_line })
    }

    /// A file in memory, as [`Self::new`] has it with the settings as they stand there.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn of_bytes(bytes: &[u8], estimate: Estimate) -> Result<Self, Error> {
        let name = "a file in memory";
        let source = Source::of_bytes(bytes.to_vec());
        let stream = Stream::open(source, Firmware::default(), SOME_DIAMETER)
            .map_err(|error| Cause::Unreadable(error).of(name))?;
        let values = stream.facts().values.clone();
        Self::new(name, stream, values, estimate)
    }

    /// Retractions whose length only the printer knows.
    pub(super) fn firmware_retractions(&self) -> u64 {
        self.stream.facts().summary.firmware_retractions
    }

    /// What the file could not be read for.
    pub(super) fn unreadable(&self, error: io::Error) -> Error {
        Cause::Unreadable(error).of(&self.name)
    }

    /// Time of a role in the whole file, s.
    pub(super) fn seconds(&self, role: Role, by_role: bool) -> f64 {
        let roles = self.estimate.roles.iter();
        let own = roles.filter(|one| sums::role(one.role, by_role) == role);
        own.fold(0.0, |sum, one| sum + one.seconds)
    }

    /// The moves of all halves: those of the start, of each layer, and of the end.
    pub(super) fn moves(&self) -> impl Iterator<Item = io::Result<Vec<Step>>> + Send {
        Moves { sections: self.stream.sections(), rest: Some(Vec::new()) }
    }

    /// The start and all layers, one after the other.
    pub(super) fn sections(&self) -> impl Iterator<Item = io::Result<Section>> + Send {
        self.stream.sections()
    }

    /// What is known of the file as a whole.
    pub(super) fn facts(&self) -> &Facts {
        self.stream.facts()
    }

    /// What comes before the first layer.
    pub(super) fn start<'a>(&'a self, steps: &'a [Step]) -> Half<'a> {
        let seconds = self.estimate.start_seconds;
        Half { number: Some(0), seconds, ..self.end(steps) }
    }

    /// A layer, counted from 0. The print as a whole has moved by `by`, mm.
    pub(super) fn layer<'a>(
        &'a self,
        index: Option<usize>,
        by: [f64; 2],
        steps: &'a [Step],
    ) -> Half<'a> {
        let layer = index.and_then(|index| Some((index, self.floors.get(index)?)));
        let Some((index, floor)) = layer else { return Half::default() };
        let time = self.estimate.layers.get(index);
        Half {
            number: Some(index + 1),
            level: Some([floor.level.z, floor.level.height]),
            seconds: time.map_or(0.0, |time| time.seconds),
            origin: [by[0], by[1], floor.level.z],
            ..self.end(steps)
        }
    }

    /// What comes after the last line.
    pub(super) fn end<'a>(&'a self, steps: &'a [Step]) -> Half<'a> {
        let patches = &self.stream.facts().patches;
        Half { steps, patches, first_line: self.first_line, ..Half::default() }
    }
}

/// What is known of a file before it is compared.
#[derive(Default)]
struct Survey {
    floors: Vec<Floor>,
    places: Places,
    heats: Vec<Heat>,
    /// The file's line with which the first layer begins, from 1.
    first_line: Option<u32>,
}

impl Survey {
    /// Reads all layers once, for what is known of them without their moves.
    fn new(stream: &Stream) -> io::Result<Self> {
        let mut survey = Self::default();
        // The file's line of the last line that extrudes: what comes after it belongs to the next
        // layer, whether a mark stands between or not.
        let mut last = 0;
        for section in stream.sections() {
            let section = section?;
            if let Some(layer) = section.of(stream.facts()) {
                let level = Level { z: layer.z, height: layer.height };
                let mut shape = Shape::default();
                section.lines().for_each(|step| shape.add(step));
                let (extent, middle) = (shape.extent, shape.middle());
                survey.floors.push(Floor { level, extent, middle });
                survey.places.before.push(last);
                let begin = section.moves.first().map(|step| step.line);
                survey.first_line = survey.first_line.or(begin);
                for step in section.lines() {
                    let first = survey.places.lines.map_or(step.line, |[first, _]| first);
                    survey.places.lines = Some([first, step.line]);
                }
            }
            last = section.lines().last().map_or(last, |step| step.line);
            let room = MOST_HEATS - survey.heats.len().min(MOST_HEATS);
            survey.heats.extend(section.notes.iter().filter_map(Heat::of).take(room));
        }
        Ok(survey)
    }
}

/// See [`Side::moves`].
struct Moves<I> {
    sections: I,
    /// Moves after the last line so far; `None` after the end.
    rest: Option<Vec<Step>>,
}

impl<I: Iterator<Item = io::Result<Section>>> Iterator for Moves<I> {
    type Item = io::Result<Vec<Step>>;

    fn next(&mut self) -> Option<Self::Item> {
        let mut own = self.rest.take()?;
        match self.sections.next() {
            None => Some(Ok(own)),
            Some(Err(error)) => Some(Err(error)),
            Some(Ok(section)) => {
                let before = own.len();
                own.extend(section.moves);
                let last = own[before..].iter().rposition(Step::is_line);
                self.rest = Some(own.split_off(last.map_or(0, |last| before + last + 1)));
                Some(Ok(own))
            }
        }
    }
}
