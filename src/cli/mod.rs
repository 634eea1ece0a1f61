//! Arguments -> products and exit code: the only place that prints.
//!
//! Words used here: a *product* is what a command is run for, a file or text on standard output; an
//! *outcome* is that text with the exit code.
//!
//! 1. The words become arguments ([`args`]); help, versions and wrong words end here.
//! 2. The command's own module does the work, and gives an outcome or an error.
//! 3. An error becomes one line and an exit code ([`failure`]).

mod about;
mod args;
mod check;
mod clock;
mod compare;
mod diff;
mod estimate;
mod failed;
mod failure;
mod foreign;
mod help;
mod input;
mod interrupt;
mod mesh;
mod model;
mod output;
mod part;
mod place;
mod play;
mod preview;
mod profile;
mod profiles;
mod progress;
mod publish;
mod reading;
mod roughness;
mod send;
mod slice;
mod steps;
mod stray;
mod summary;
mod texts;
mod threads;
mod usage;
mod viewer;
mod words;

use anyhow::Result;
use args::{Arguments, Command, ReportCommand};
use clap::FromArgMatches as _;
use clap::error::{ContextKind, ContextValue};
use slicer::{report, text};
use std::ffi::OsString;
use std::fmt::Display;
use std::io::Write as _;
use std::path::Path;

/// What a subcommand gives: the text for standard output, and the exit code.
struct Outcome {
    text: String,
    code: u8,
}

impl Outcome {
    /// Prints the text and gives the exit code, which holds even if nobody reads the text.
    ///
    /// # Errors
    /// [`failure::Output`] if standard output cannot be written.
    fn print(self) -> Result<u8> {
        match output::print(&self.text) {
            Err(error) if !output::is_closed_stdout(&error) => Err(error),
            _ => Ok(self.code),
        }
    }
}

impl From<String> for Outcome {
    /// All is well.
    fn from(text: String) -> Self {
        Self { text, code: 0 }
    }
}

/// Runs the program with these arguments, the program's name first, and
/// returns the process's exit code.
pub(crate) fn run(words: impl Iterator<Item = OsString>) -> u8 {
    interrupt::watch_faults();
    let words: Vec<OsString> = asked_for_help(words.collect());
    let matches = help::command().try_get_matches_from(&words);
    let arguments = match matches.and_then(|matches| Arguments::from_arg_matches(&matches)) {
        Ok(arguments) => arguments,
        Err(error) => return refused(&error, &words),
    };
    if let Some(line) = stray::among(&words, arguments.inputs()) {
        return wrong(&words, line);
    }
    let done = match &arguments.command {
        None => threads::with(arguments.slice.threads, || slice::run(&arguments.slice)),
        Some(command) if command.computes() => {
            threads::with(None, || other(command)).and_then(Outcome::print)
        }
        Some(command) => other(command).and_then(Outcome::print),
    };
    done.unwrap_or_else(|error| {
        // A reader that stops reading, such as `head`, has had enough: that is no failure.
        if output::is_closed_stdout(&error) {
            return 0;
        }
        say_line("error", failure::line(&error));
        failure::exit_code(&error)
    })
}

/// `slicer help check` is meant as `slicer check --help`; a model may be called so, too.
fn asked_for_help(mut words: Vec<OsString>) -> Vec<OsString> {
    if words.get(1).is_some_and(|word| word == "help") && !Path::new("help").exists() {
        words.remove(1);
        words.push("--help".into());
    }
    words
}

/// Prints the help or the version, which are products, or one line of error.
/// `words` are the program's name and the arguments, the first of which may be a mistyped command.
fn refused(error: &clap::Error, words: &[OsString]) -> u8 {
    let first = words.get(1).and_then(|word| word.to_str());
    use clap::error::ErrorKind::{
        DisplayHelp, DisplayHelpOnMissingArgumentOrSubcommand, DisplayVersion, InvalidValue,
        MissingRequiredArgument, TooManyValues, UnknownArgument,
    };
    let text = error.render();
    match error.kind() {
        DisplayHelp | DisplayVersion => match output::print(&text.to_string()) {
            Ok(()) => 0,
            Err(error) if output::is_closed_stdout(&error) => 0,
            Err(error) => failure::exit_code(&error),
        },
        DisplayHelpOnMissingArgumentOrSubcommand => {
            say(&text.to_string());
            2
        }
        kind => {
            let line = match kind {
                MissingRequiredArgument => {
                    first.and_then(|word| usage::meant(word, &help::command()))
                }
                UnknownArgument => dashed_file(words).or_else(|| unknown_flag(error, words)),
                TooManyValues => too_many(error),
                InvalidValue if told(error, ContextKind::InvalidArg).starts_with("--head") => {
                    Some(format!("{}; {MEASURED}", usage::reason(&text.to_string())))
                }
                _ => None,
            };
            let plain = || usage::one_line(&text.to_string(), &command_of(words));
            // The first thing that a new user leaves out.
            let line = line.unwrap_or_else(plain);
            let hint = if command_of(words) == "slicer" { ", such as -o part.gcode" } else { "" };
            wrong(words, line.replacen(MISSING_OUT, &format!("{MISSING_OUT}{hint}"), 1))
        }
    }
}

/// How clap names the output that a run lacks.
const MISSING_OUT: &str = "not provided: --output <OUT>";

/// What to say of a file that is taken for flags, since its name begins with a dash.
fn dashed_file(words: &[OsString]) -> Option<String> {
    let is_it =
        |word: &&OsString| word.to_string_lossy().starts_with('-') && Path::new(word).is_file();
    let name = text::name(words.iter().skip(1).find(is_it)?);
    Some(format!("{name} is taken for flags, since it begins with a dash; write ./{name}"))
}

/// The command that the first words name, such as `slicer profile show`, or the program alone.
fn command_of(words: &[OsString]) -> String {
    let (program, mut name) = (help::command(), "slicer".to_owned());
    let mut command = &program;
    for word in words.iter().skip(1) {
        let Some(next) = word.to_str().and_then(|word| command.find_subcommand(word)) else {
            break;
        };
        command = next;
        name = format!("{name} {}", command.get_name());
    }
    name
}

/// What to do with a head that has no name here.
const MEASURED: &str =
    "measure any other, and write it as [head] into a profile (profiles/README.md)";

/// Says what is wrong with the words of the command line, also in the report that they name.
fn wrong(words: &[OsString], line: String) -> u8 {
    let first = words.get(1).and_then(|word| word.to_str());
    if first.is_none_or(|word| help::command().find_subcommand(word).is_none()) {
        failed::refused(words, 2, &line);
    }
    say_line("error", line);
    2
}

/// What clap says of an error under `kind`, or nothing.
fn told(error: &clap::Error, kind: ContextKind) -> &str {
    match error.get(kind) {
        Some(ContextValue::String(text)) => text,
        _ => "",
    }
}

/// What to say of a value for a flag that takes none.
fn too_many(error: &clap::Error) -> Option<String> {
    stray::told(told(error, ContextKind::InvalidArg), told(error, ContextKind::InvalidValue))
}

/// What to say of a flag that the command, named by the first words, does not have.
fn unknown_flag(error: &clap::Error, words: &[OsString]) -> Option<String> {
    let flag = told(error, ContextKind::InvalidArg);
    let flag = flag.starts_with("--").then_some(flag)?;
    let program = help::command();
    let first = words.get(1).and_then(|word| word.to_str());
    let command = first.and_then(|word| program.find_subcommand(word));
    let takes_settings = command.is_none_or(|command| command.get_name() == "compare");
    let command = (command.unwrap_or(&program), &*command_of(words));
    Some(foreign::unknown_flag(flag, takes_settings, words, command))
}

/// Prints text for people on standard error. If that fails there is nowhere left to report it. Names
/// and other texts of files in it are on one line each: see [`text::name`] and [`text::line`].
fn say(text: &str) {
    let _ = std::io::stderr().lock().write_all(text::harmless(text).as_bytes());
}

/// Prints a message on one line of standard error, whatever is in it: `error: …`, `warning: …`.
fn say_line(kind: &str, message: impl Display) {
    say(&format!("{kind}: {}\n", text::line(&message.to_string())));
}

fn other(command: &Command) -> Result<Outcome> {
    let text = match command {
        Command::Profile(command) => return profile::run(command),
        Command::Report(ReportCommand::Schema) => pretty(&report::schema())?,
        Command::Compare(args) => compare::run(args)?,
        Command::Check(args) => return check::run(args),
        Command::Estimate(args) => return estimate::run(args),
        Command::Steps(args) => steps::run(args)?,
        Command::Play(args) => return play::run(args),
        Command::Send(args) => return send::run(args),
        // Its product is a file, unless `-o -` asks for another.
        Command::Preview(args) => preview::run(args).map(|()| String::new())?,
        Command::Diff(args) => return diff::run(args),
        Command::Roughness(args) => roughness::run(args)?,
        Command::Mesh(args) => return mesh::run(args),
        Command::Completions { shell } => help::completions(*shell),
        Command::Man { command } => help::manual(command)?,
    };
    Ok(text.into())
}

fn pretty(schema: &impl serde::Serialize) -> Result<String> {
    output::json(schema, Path::new("-"))
}
