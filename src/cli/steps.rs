//! `slicer steps` and `-o part.steps` -> a stream of steps for motors, made of G-code.
//!
//! Words used here: a *stream* is the product, a file of steps; its *notes* are what people are told of
//! it: where it begins and ends, and what of the G-code it does not have; a *target* is where slicing
//! writes, be it G-code or a stream.
//!
//! 1. The profile has to say how far a step goes, before any work is done.
//! 2. The G-code is read once, and the stream is written beside its place.
//! 3. It is put in place, and people or programs are told.
//!
//! The G-code of `slicer steps` is any slicer's; that of `slicer part.stl -o part.steps` is written to a
//! file without a name first, and read back. Either way the machine is that of the settings.

use super::failure::{self, Output, writing};
use super::output::Sink;
use super::profiles::ProfileArgs;
use super::publish::Product;
use super::reading::ReadingArgs;
use super::texts::CODES;
use super::{clock, input, interrupt, output, say, say_line, usage, words};
use anyhow::{Context as _, Result};
use clap::Args;
use serde::Serialize;
use slicer::profile::Settings;
use slicer::reader::Reading;
use slicer::steps::axis::{AXES, Axes, LETTERS};
use slicer::steps::{self, Failure, Form, Machine, Made, Options};
use slicer::text;
use slicer::warning::plural;
use std::ffi::OsString;
use std::io::{BufRead, Write as _};
use std::path::{Path, PathBuf};

/// Version of the JSON; raised when a field changes its meaning or goes away.
const SCHEMA: u32 = 1;

/// The ending of a stream's name.
const ENDING: &str = "steps";

/// Arguments of `steps`.
#[derive(Debug, Args)]
#[command(after_long_help = CODES)]
pub(crate) struct StepsArgs {
    /// G-code file of any slicer; `-` reads standard input
    #[arg(value_name = "FILE")]
    file: OsString,
    /// Stream to write; `-` writes standard output
    #[arg(short, long, value_name = "OUT")]
    output: PathBuf,
    /// Write patterns of coils instead of steps: full or half steps, of all axes or of X,Y,Z,E each
    #[arg(long, value_name = "half|full", value_parser = coils)]
    coils: Option<[bool; AXES]>,
    /// Where the nozzle stands at the beginning, mm [default: the profile's steps.home_x, _y and _z]
    #[arg(long, value_name = "X,Y,Z", value_parser = words::numbers::<3>, allow_hyphen_values = true)]
    start: Option<[f64; 3]>,
    /// Print JSON
    #[arg(long)]
    json: bool,
    /// Show only warnings and errors
    #[arg(short, long)]
    quiet: bool,
    #[command(flatten)]
    reading: ReadingArgs,
    #[command(flatten)]
    profiles: ProfileArgs,
}

/// `half`, `full`, or a word for each axis: whether a step is a full one.
fn coils(text: &str) -> Result<[bool; AXES], String> {
    let word = |word: &str| match word.trim() {
        "half" => Some(false),
        "full" => Some(true),
        _ => None,
    };
    let all: Option<Vec<bool>> = text.split(',').map(word).collect();
    let all = match all.as_deref() {
        Some([one]) => Some([*one; AXES]),
        Some(each) => each.try_into().ok(),
        None => None,
    };
    all.ok_or_else(|| "it must be half or full, or four of them with commas between".to_owned())
}

/// Makes a stream; gives the text for standard output.
///
/// # Errors
/// A profile that makes no steps, a file that cannot be read or holds no move, an output that cannot be
/// written.
pub(super) fn run(args: &StepsArgs) -> Result<String> {
    usage::replaces(&args.output, &args.file)?;
    if args.json && output::is_stdout(&args.output) {
        return Err(failure::usage("JSON and steps cannot both go to standard output; name OUT"));
    }
    interrupt::watch();
    let opened = args.reading.open(&args.file)?;
    let own = opened.values().map_err(|error| opened.unreadable(error))?;
    let (profile, _) = clock::of(&args.profiles, &[(&own, "the file's own settings")])?;
    let settings = &profile.settings;
    let reading = args.reading.of(args.profiles.any().then_some(settings), opened.says);
    let form = args.coils.map_or(Form::Steps, Form::Coils);
    let options = Options { reading, form, start: args.start };
    Machine::new(settings, args.start)?;
    let mut sink = Sink::open(&args.output)?;
    let mut source = opened.source.reader();
    let made = make(&mut source, &opened.name, settings, options, &args.output, &mut sink)?;
    sink.commit()?;
    warn(&made);
    if args.json {
        return output::json(&Told::new(&made), Path::new("-"));
    }
    if !args.quiet {
        say(&notes(&made));
    }
    Ok(String::new())
}

/// Makes a stream, with the errors of this program.
fn make(
    source: &mut dyn BufRead,
    file: &str,
    settings: &Settings,
    options: Options,
    out: &Path,
    sink: &mut Sink,
) -> Result<Made> {
    let made = steps::make(source, file, settings, options, sink);
    let made = made.map_err(|failure| match failure {
        Failure::Profile(error) => anyhow::Error::from(error),
        Failure::Reader(error) => error.into(),
        Failure::Steps(error) => error.into(),
        Failure::Write(error) => anyhow::Error::from(error).context(writing(out)),
    })?;
    sink.flush().with_context(|| writing(out))?;
    Ok(made)
}

/// Where slicing writes: G-code, or a stream that is made of it in the end.
pub(super) struct Target {
    gcode: Sink,
    stream: Option<(Sink, Box<Settings>)>,
}

impl Target {
    /// # Errors
    /// A profile that makes no steps, where the name asks for them; [`Output`].
    pub(super) fn open(out: &Path, settings: &Settings) -> Result<Self> {
        if out.extension().is_none_or(|ending| ending != ENDING) {
            return Ok(Self { gcode: Sink::open(out)?, stream: None });
        }
        Machine::new(settings, None)?;
        let stream = Some((Sink::open(out)?, Box::new(settings.clone())));
        Ok(Self { gcode: Sink::open(Path::new("-"))?, stream })
    }

    /// Where the G-code goes.
    pub(super) fn gcode(&mut self) -> &mut Sink {
        &mut self.gcode
    }

    /// The whole product.
    ///
    /// # Errors
    /// What making steps gives, and [`Output`].
    pub(super) fn whole(mut self, out: &Path, quiet: bool) -> Result<Product> {
        let Some((mut stream, settings)) = self.stream.take() else { return self.gcode.whole() };
        let reading = Reading::from(input::firmware(&settings));
        let options = Options { reading, form: Form::Steps, start: None };
        let action = "cannot read back";
        let read = self.gcode.read_back();
        let mut source = read.with_context(|| Output { file: out.to_owned(), action })?;
        let file = text::name(out);
        let made = make(&mut source, &file, &settings, options, out, &mut stream)?;
        warn(&made);
        if !quiet {
            say(&notes(&made));
        }
        stream.whole()
    }
}

/// What people have to know of a stream.
fn warn(made: &Made) {
    for (axis, beyond) in made.beyond.iter().enumerate() {
        if let Some((line, mm)) = beyond {
            let letter = LETTERS[axis];
            say_line(
                "warning",
                format!("{letter} goes {mm:.3} mm beyond its end, first on line {line}"),
            );
        }
    }
    if made.slowed > 0 {
        let (moves, line) = (plural(made.slowed, "move"), made.first_slowed);
        let why = "slower than the file asks for, since a motor cannot step so fast";
        say_line("warning", format!("{moves} {why}; the first is line {line}"));
    }
}

fn notes(made: &Made) -> String {
    let place = |at: [f64; AXES]| {
        let words = (0..AXES).map(|axis| format!("{}{:.3}", LETTERS[axis], at[axis]));
        words.collect::<Vec<_>>().join(" ")
    };
    let steps: u64 = made.totals.steps.iter().sum();
    let mut text = format!(
        "from {} to {}\n{} in {}, {:.1} s\n",
        place(made.start),
        place(made.end),
        plural(steps, "step"),
        plural(u64::from(made.blocks), "block"),
        made.totals.time as f64 / 1e6,
    );
    let left =
        [(made.heating, "wait for heat", "waits for heat"), (made.pauses, "pause", "pauses")];
    let left = left
        .into_iter()
        .filter(|(count, ..)| *count > 0)
        .map(|(count, one, more)| format!("{count} {}", if count == 1 { one } else { more }));
    let left: Vec<String> = left.collect();
    if !left.is_empty() {
        text.push_str(&format!("motors cannot do, and left out: {}\n", left.join(", ")));
    }
    text
}

/// For programs.
#[derive(Serialize)]
struct Told {
    schema: u32,
    start_mm: Axes<f64>,
    end_mm: Axes<f64>,
    /// Steps of each axis.
    steps: Axes<u64>,
    seconds: f64,
    /// Of these, waits that the plan of the moves does not have, s.
    waits_seconds: f64,
    blocks: u32,
    moves: u64,
    warnings: Vec<Warned>,
    left_out: LeftOut,
}

#[derive(Serialize)]
struct Warned {
    code: &'static str,
    /// Line of the G-code, from 1.
    line: u64,
    #[serde(skip_serializing_if = "Option::is_none")]
    axis: Option<char>,
    #[serde(skip_serializing_if = "Option::is_none")]
    beyond_mm: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    moves: Option<u64>,
}

#[derive(Serialize)]
struct LeftOut {
    heating: u64,
    pauses: u64,
}

impl Told {
    fn new(made: &Made) -> Self {
        let beyond = made.beyond.iter().enumerate().filter_map(|(axis, beyond)| {
            let (line, mm) = (*beyond)?;
            let axis = Some(LETTERS[axis].to_ascii_lowercase());
            Some(Warned { code: "beyond-switch", line, axis, beyond_mm: Some(mm), moves: None })
        });
        let slowed = (made.slowed > 0).then_some(Warned {
            code: "too-many-steps",
            line: made.first_slowed,
            axis: None,
            beyond_mm: None,
            moves: Some(made.slowed),
        });
        Self {
            schema: SCHEMA,
            start_mm: made.start.into(),
            end_mm: made.end.into(),
            steps: made.totals.steps.into(),
            seconds: made.totals.time as f64 / 1e6,
            waits_seconds: made.waits,
            blocks: made.blocks,
            moves: made.moves,
            warnings: beyond.chain(slowed).collect(),
            left_out: LeftOut { heating: made.heating, pauses: made.pauses },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coils_are_of_all_axes_or_of_each() {
        assert_eq!(coils("half"), Ok([false; 4]));
        assert_eq!(coils("half,half,full,half"), Ok([false, false, true, false]));
        assert!(coils("half,full").is_err() && coils("quarter").is_err() && coils("").is_err());
    }
}
