//! Flags -> what a user reads of them: help on one screen, manual pages, completions.
//!
//! The flags and their full texts stand in `args.rs`. Here is what is made of them:
//!
//! - *Everyday flags* come first, and are all that `-h` shows, each in a few words. The others are
//!   for `--help`.
//! - A *manual page* is there for every command; `slicer man check` prints slicer-check(1).
//! - *Completions* are clap's, which know flags and the words that a flag may have. To these come
//!   profiles and keys: where a flag takes one, clap is told of one word, a mark, and the mark is
//!   replaced in the script by what the shell needs. A script knows the profiles and keys of the
//!   program that made it.

use super::args::Arguments;
use super::failure::usage;
use super::texts::{DUAL, FINDINGS, MENDING};
use anyhow::{Context as _, Result};
use clap::builder::{PossibleValuesParser, Resettable};
use clap::{Command, CommandFactory as _};
use clap_complete::Shell;
use slicer::profile::{builtin_names, keys};
use slicer::text;
use std::path::Path;

/// The flags that `-h` shows, in this order, in words that fit on one line of 80.
const EVERYDAY: [(&str, &str); 13] = [
    ("output", "G-code file to write, `-` for standard output"),
    ("profile", "Printer: a built-in profile, or your mine.toml"),
    ("material", "Material [default: the printer's]"),
    ("print", "Print, such as fine [default: the printer's]"),
    ("dual", "Infill of two layers at once, twice as thick"),
    ("layer_height", "Height of a layer, mm"),
    ("infill", "Density of the infill, %"),
    ("support", "Print support under overhangs"),
    ("brim", "Print a brim of this width, mm"),
    ("set", "Change any setting (see `slicer profile show -v`)"),
    ("rotate", "Turn about x, y, z, degrees"),
    ("copies", "Print each model N times"),
    ("check", "Write G-code only if it is found to be good"),
];

/// The program's flags and commands, everyday ones first.
pub(super) fn command() -> Command {
    everyday(Arguments::command())
        .mut_subcommand("compare", |command| with(everyday(command), DUAL))
        .mut_subcommand("check", |command| with(command, FINDINGS))
        .mut_subcommand("mesh", |command| with(command, MENDING))
}

/// The long help ends with `text`, and with what the short one ends with.
fn with(command: Command, text: &str) -> Command {
    let end = command.get_after_help().map(|end| format!("\n\n{end}")).unwrap_or_default();
    command.after_long_help(format!("{text}{end}"))
}

/// Everyday flags get their short text and a place above all others.
fn everyday(command: Command) -> Command {
    command.mut_args(|arg| {
        let everyday = EVERYDAY.iter().position(|(id, _)| *id == arg.get_id().as_str());
        match everyday {
            Some(at) => {
                let long = arg.get_long_help().or(arg.get_help()).cloned().unwrap_or_default();
                let arg = arg.help(EVERYDAY[at].1).long_help(long).display_order(at);
                arg.help_heading(Resettable::Reset)
            }
            None if arg.is_positional() => arg,
            None => arg.hide_short_help(true),
        }
    })
}

/// The manual page of a command, `["profile", "show"]`, or of the program.
///
/// # Errors
/// If there is no such command.
pub(super) fn manual(words: &[String]) -> Result<String> {
    let mut program = command();
    // Names such as slicer-profile-show.
    program.build();
    let mut page = &program;
    for word in words {
        page = page.find_subcommand(word).ok_or_else(|| {
            let names: Vec<_> = page.get_subcommands().map(Command::get_name).collect();
            let known = if names.is_empty() { "none".to_owned() } else { names.join(", ") };
            usage(format!("man: there is no command {}; there are: {known}", text::line(word)))
        })?;
    }
    let mut text = Vec::new();
    // What `-h` leaves out is told here.
    let page = page.clone().mut_args(|arg| arg.hide_short_help(false));
    clap_mangen::Man::new(page)
        .source(concat!("slicer ", env!("CARGO_PKG_VERSION")))
        .render(&mut text)
        .with_context(|| super::failure::writing(Path::new("-")))?;
    // Lines of tables and examples stay lines.
    Ok(String::from_utf8_lossy(&text).replace(".SH EXTRA\n", ".SH NOTES\n.nf\n"))
}

/// Stands for the names of profiles in what clap writes.
const PROFILES: &str = "@profiles@";

/// Stands for the keys of a profile.
const KEYS: &str = "@keys@";

/// The script that tells `shell` how to complete.
pub(super) fn completions(shell: Shell) -> String {
    let (mut program, mut text) = (marked(command()), Vec::new());
    clap_complete::generate(shell, &mut program, "slicer", &mut text);
    let text = String::from_utf8_lossy(&text);
    let mut profiles: Vec<&str> = builtin_names().collect();
    profiles.sort_unstable();
    let profiles = profiles.join(" ");
    let keys: String = keys::KEYS.iter().map(|key| format!("{}= ", key.name)).collect();
    let keys = keys.trim_end();
    match shell {
        // Where no profile fits, bash offers files by itself (`-o default`).
        Shell::Bash => {
            let text = text.replace(PROFILES, &profiles).replace(KEYS, keys);
            BASH_KEYS.to_owned() + &text.replace("-F _slicer ", "-F _slicer_keys ")
        }
        Shell::Zsh => {
            let text = text.replace(&format!("({PROFILES})"), "_slicer_profiles");
            let text = text.replace(&format!("({KEYS})"), "_slicer_keys");
            let last = "if [ \"$funcstack[1]\"";
            let helpers = ZSH_HELPERS.replace(PROFILES, &profiles).replace(KEYS, keys);
            text.replacen(last, &format!("{helpers}{last}"), 1)
        }
        Shell::Fish => {
            // Files are offered beside profiles.
            let text = text
                .replace(&format!("-f -a \"{PROFILES}\\t''\""), &format!("-F -a \"{profiles}\""));
            // fish takes a model for a command, and would offer no flag after it.
            let commands: Vec<_> = program.get_subcommands().map(Command::get_name).collect();
            let slices = FISH_SLICES.replace("@commands@", &commands.join(" "));
            let text = ["-s ", "-l "].iter().fold(text, |text, flag| {
                let before_all = format!("-n \"__fish_slicer_needs_command\" {flag}");
                text.replace(&before_all, &format!("{slices} {flag}"))
            });
            text.replace(&format!("{KEYS}\\t''"), keys)
        }
        _ => text.into_owned(),
    }
}

/// Bash puts a space after what it completes; after a key comes its value instead.
const BASH_KEYS: &str = "\
_slicer_keys() {
    _slicer \"$@\"
    [[ ${COMPREPLY[0]} == *= ]] && compopt -o nospace
    return 0
}

";

const ZSH_HELPERS: &str = "\
_slicer_profiles() {
    _alternative 'profiles:profile:(@profiles@)' 'files:file:_files -g \"*.toml\"'
}

_slicer_keys() {
    compadd -S '' -- @keys@
}

";

/// There is no command among the words: it is a model that is sliced.
const FISH_SLICES: &str = "-n \"not __fish_seen_subcommand_from @commands@\"";

/// With the marks where profiles and keys are meant, in all commands.
fn marked(command: Command) -> Command {
    let marked_here = command.mut_args(|arg| match arg.get_id().as_str() {
        "profile" | "material" | "print" | "name" | "names" => {
            arg.value_parser(PossibleValuesParser::new([PROFILES]))
        }
        "set" => arg.value_parser(PossibleValuesParser::new([KEYS])),
        _ => arg,
    });
    marked_here.mut_subcommands(marked)
}
