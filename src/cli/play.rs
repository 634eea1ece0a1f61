//! `slicer play` -> what a stream of steps does: totals and findings, its steps as text, its path as G-code.
//!
//! Words used here: *events* are steps as lines of text; the *path* is the moves that the steps were made
//! of, as G-code; a *text* is one of the two while it is written.
//!
//! 1. No two products may go to one place.
//! 2. The stream is read block by block; what it holds goes to both texts at once, piece by piece, so that
//!    memory does not grow with it.
//! 3. Only when all of it was right are texts put in place, and the totals told.

use super::failure::writing;
use super::output::{self, Sink};
use super::publish::publish;
use super::{Outcome, failure, interrupt, usage};
use anyhow::{Context as _, Result};
use clap::Args;
use serde::Serialize;
use slicer::steps::axis::{AXES, Axes, LETTERS};
use slicer::steps::{self, Cause, Finding, Item, Played};
use slicer::text;
use slicer::warning::plural;
use std::cell::RefCell;
use std::ffi::OsString;
use std::fs::File;
use std::io::{self, BufReader, Read, Write as _};
use std::path::{Path, PathBuf};

/// Version of the JSON; raised when a field changes its meaning or goes away.
const SCHEMA: u32 = 1;

/// Bytes that are read at once, and of text that are written at once.
const BUFFER: usize = 1 << 18;

const PLAY_RULES: &str = "\
Findings, with the block in which each occurs first:
  beyond-switch   an axis goes beyond the lowest or highest step that the machine allows
  too-fast        two steps of an axis are closer than its motor allows
  turns-too-soon  an axis turns round without the wait that it needs

--events writes a line for each step, `TIME AXIS +` or `-`, the time in whole µs; steps at one time are
lines with the same time. Lines with # are comments.

Exit codes: 0 clean, 1 findings, 2 wrong arguments, 3 a file that is no stream of steps, or is damaged:
cut off, a bit turned, a block lost, twice or out of order, bytes after its end; 4 an output cannot be
written.";

/// Arguments of `play`.
#[derive(Debug, Args)]
#[command(after_long_help = PLAY_RULES)]
pub(crate) struct PlayArgs {
    /// Stream of steps, as `slicer steps` makes it; `-` reads standard input
    #[arg(value_name = "FILE")]
    file: OsString,
    /// Print JSON
    #[arg(long)]
    json: bool,
    /// Write a line for each step: time in µs, axis, + or -; `-` writes standard output
    #[arg(long, value_name = "OUT")]
    events: Option<PathBuf>,
    /// Write the path as moves of G-code; `-` writes standard output
    #[arg(long, value_name = "OUT")]
    gcode: Option<PathBuf>,
    /// Print nothing; the exit code says whether it is good
    #[arg(short, long, conflicts_with = "json")]
    quiet: bool,
}

/// Plays a stream.
///
/// # Errors
/// A stream that cannot be read or is damaged, an output that cannot be written.
pub(super) fn run(args: &PlayArgs) -> Result<Outcome> {
    let outputs = [args.events.as_deref(), args.gcode.as_deref()];
    for out in outputs.into_iter().flatten() {
        usage::replaces(out, &args.file)?;
    }
    let to_stdout = outputs.iter().flatten().filter(|out| output::is_stdout(out)).count();
    if to_stdout + usize::from(args.json) > 1 {
        let why = "two products cannot both go to standard output; name a file for one";
        return Err(failure::usage(why));
    }
    if let [Some(a), Some(b)] = outputs
        && usage::is_same_file(a, b)
    {
        return Err(failure::usage("--events and --gcode name the same file; name two"));
    }
    interrupt::watch();
    let (name, mut source) = open(&args.file)?;
    let [events, gcode] = outputs.map(|out| out.map(Text::open).transpose());
    let (mut events, mut gcode) = (events?, gcode?);
    let played = play(&mut source, &name, events.as_mut(), gcode.as_mut())?;
    let mut products = Vec::new();
    for text in [events, gcode].into_iter().flatten() {
        products.push(text.whole()?);
    }
    publish(products)?;
    let code = u8::from(!played.findings.is_empty());
    let text = if args.json {
        output::json(&Told::new(&played), Path::new("-"))?
    } else if args.quiet || to_stdout > 0 {
        String::new()
    } else {
        table(&played)
    };
    Ok(Outcome { text, code })
}

fn open(file: &OsString) -> Result<(String, Box<dyn Read>)> {
    if file == "-" {
        return Ok(("<stdin>".to_owned(), Box::new(io::stdin().lock())));
    }
    let name = text::name(file);
    let file = File::open(file).map_err(|error| Cause::Unreadable(error).of(&name))?;
    Ok((name, Box::new(BufReader::with_capacity(BUFFER, file))))
}

/// A text that is written piece by piece. What fails is told at its end.
struct Text<'a> {
    out: &'a Path,
    sink: Sink,
    text: String,
    failed: Option<io::Error>,
}

impl<'a> Text<'a> {
    fn open(out: &'a Path) -> Result<Self> {
        let text = String::with_capacity(BUFFER);
        Ok(Self { out, sink: Sink::open(out)?, text, failed: None })
    }

    /// Writes what is there, once it is long enough.
    fn piece(&mut self, least: usize) {
        if self.text.len() >= least && self.failed.is_none() {
            self.failed = self.sink.write_all(self.text.as_bytes()).err();
        }
        if self.text.len() >= least {
            self.text.clear();
        }
    }

    fn whole(mut self) -> Result<super::publish::Product> {
        self.piece(1);
        match self.failed {
            Some(error) => Err(error).with_context(|| writing(self.out)),
            None => self.sink.whole(),
        }
    }
}

fn play(
    source: &mut dyn Read,
    name: &str,
    events: Option<&mut Text<'_>>,
    gcode: Option<&mut Text<'_>>,
) -> Result<Played, steps::Error> {
    let path = RefCell::new(None);
    let (events, gcode) = (RefCell::new(events), RefCell::new(gcode));
    let begin = |header: &steps::Header| {
        if let Some(text) = events.borrow_mut().as_mut() {
            text.text.push_str(&heading(header));
        }
        if let Some(text) = gcode.borrow_mut().as_mut() {
            *path.borrow_mut() = Some(steps::Path::new(header, &mut text.text));
        }
    };
    let each = |_: u64, item: &Item| {
        if let Some(text) = events.borrow_mut().as_mut() {
            event(item, &mut text.text);
            text.piece(BUFFER);
        }
        if let (Some(text), Some(path)) = (gcode.borrow_mut().as_mut(), path.borrow_mut().as_mut())
        {
            path.item(item, &mut text.text);
            text.piece(BUFFER);
        }
    };
    steps::play(source, name, begin, each)
}

/// What the events begin with.
fn heading(header: &steps::Header) -> String {
    let machine = &header.machine;
    let start = machine.mm(machine.start);
    let mut text = String::from("# time in µs, axis, direction\n");
    for axis in 0..AXES {
        let scale = machine.scale[axis];
        text.push_str(&format!(
            "# {}: {}/{} steps/mm, at {:.6} mm ({} steps) in the beginning\n",
            LETTERS[axis], scale.steps, scale.mm, start[axis], machine.start[axis]
        ));
    }
    text
}

fn event(item: &Item, text: &mut String) {
    let Item::Step { at, mask, backwards } = *item else { return };
    for axis in (0..AXES).filter(|axis| mask >> axis & 1 == 1) {
        let sign = if backwards >> axis & 1 == 1 { '-' } else { '+' };
        text.push_str(&at.to_string());
        text.extend([' ', LETTERS[axis], ' ', sign, '\n']);
    }
}

/// For people.
fn table(played: &Played) -> String {
    let (end, rates) = (played.end_mm(), played.highest_rate());
    let mut text = format!("{:.3} s, {}\n", played.seconds(), plural(played.blocks, "block"));
    for axis in 0..AXES {
        text.push_str(&format!(
            "{} {:>12} {:>8.0} steps/s at most, ends at {:.3} mm\n",
            LETTERS[axis],
            plural(played.totals.steps[axis], "step"),
            rates[axis],
            end[axis]
        ));
    }
    for finding in &played.findings {
        text.push_str(&format!(
            "{}: {}, {} from block {} on ({:.3} s)\n",
            finding.code,
            finding.message,
            plural(finding.times, "time"),
            finding.block,
            finding.seconds
        ));
    }
    text
}

/// For programs.
#[derive(Serialize)]
struct Told<'a> {
    schema: u32,
    seconds: f64,
    /// Steps of each axis.
    steps: Axes<u64>,
    /// Times at which any axis steps.
    instants: u64,
    start_mm: Axes<f64>,
    end_mm: Axes<f64>,
    /// Steps a second, by the shortest time between two of them.
    highest_rate: Axes<f64>,
    steps_per_mm: Axes<f64>,
    blocks: u64,
    findings: &'a [Finding],
}

impl<'a> Told<'a> {
    fn new(played: &'a Played) -> Self {
        let machine = &played.header.machine;
        Self {
            schema: SCHEMA,
            seconds: played.seconds(),
            steps: played.totals.steps.into(),
            instants: played.totals.instants,
            start_mm: machine.mm(machine.start).into(),
            end_mm: played.end_mm().into(),
            highest_rate: played.highest_rate().into(),
            steps_per_mm: machine.scale.map(|scale| scale.per_mm()).into(),
            blocks: played.blocks,
            findings: &played.findings,
        }
    }
}
