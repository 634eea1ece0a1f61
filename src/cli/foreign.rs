//! Flag that there is not -> what it is called here, or the flag it is nearest to.

use super::args::SettingArgs;
use slicer::profile::foreign::{self, Foreign};
use slicer::profile::{keys, suggest};
use std::ffi::OsString;

/// Flags of other slicers' programs that are no settings, and what does the same here.
const FOREIGN_FLAGS: &[(&str, &str)] = &[
    ("--center", "--at X,Y"),
    ("--duplicate", "--copies N"),
    ("--export-gcode", "-o FILE"),
    ("--info", "`slicer mesh MODEL`"),
    ("--load", "-p FILE"),
    ("--load-settings", "-p FILE"),
    ("--loglevel", "-v"),
    ("--repair", "--mesh repair"),
    ("--rotate-x", "--rotate X,Y,Z"),
    ("--rotate-y", "--rotate X,Y,Z"),
    ("--save", "`slicer profile show`"),
    ("--slice", "-o FILE"),
];

/// Flags for what no command writes, and what that is.
const NOT_WRITTEN: &[(&str, &str)] = &[("--junit", "a report for JUnit (--json is for programs)")];

/// What to say of a flag that there is not: what it is called here, or which one it is nearest
/// to. The command is the one that it was given to, with its name as it is shown, and `takes_settings` whether
/// that slices.
pub(super) fn unknown_flag(
    flag: &str,
    takes_settings: bool,
    words: &[OsString],
    (command, shown): (&clap::Command, &str),
) -> String {
    let flag = flag.split('=').next().unwrap_or(flag);
    let name = flag.trim_start_matches('-');
    let foreign = || FOREIGN_FLAGS.iter().find(|(theirs, _)| *theirs == flag);
    let told = if let Some((_, what)) = NOT_WRITTEN.iter().find(|(theirs, _)| *theirs == flag) {
        format!("{what} is not supported yet")
    } else if let Some(what) = setting_for(name, value(flag, words)).filter(|_| takes_settings) {
        what
    } else if let Some((_, ours)) = foreign().filter(|_| takes_settings) {
        format!("use {ours}")
    } else {
        let known = || command.get_arguments().filter_map(clap::Arg::get_long);
        suggest::nearest(name, known())
            .map_or_else(String::new, |near| format!("a similar argument exists: '--{near}'"))
    };
    let told = if told.is_empty() { told } else { format!("{told}; ") };
    format!("unexpected argument '{flag}' found; {told}see `{shown} --help`")
}

/// How a setting is made that someone takes for a flag, with the value that was given to it.
fn setting_for(name: &str, value: &str) -> Option<String> {
    let ours = keys::find(&name.replace('-', "_")).map(|key| Foreign::Key(&key.name));
    Some(match ours.or_else(|| foreign::meaning(name))? {
        Foreign::Key(key) => SettingArgs::flag_of(key)
            .map_or_else(|| format!("use --set {key}={value}"), |flag| format!("use {flag}")),
        Foreign::NotSupported(what) => format!("{what} is not supported yet"),
    })
}

/// The value of a flag among the words, if it is one of numbers or letters.
fn value<'a>(flag: &str, words: &'a [OsString]) -> &'a str {
    let mut rest = words.iter().filter_map(|word| word.to_str()).skip_while(|word| {
        *word != flag && !word.strip_prefix(flag).is_some_and(|rest| rest.starts_with('='))
    });
    let first = rest.next().unwrap_or_default();
    let given = first.split_once('=').map(|(_, value)| value).or_else(|| rest.next());
    let is_plain = |value: &&str| {
        !value.is_empty() && value.bytes().all(|byte| byte.is_ascii_digit() || byte == b'.')
    };
    given.filter(is_plain).unwrap_or("VALUE")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::args::Arguments;
    use clap::CommandFactory as _;

    #[test]
    fn flags_of_other_slicers_are_answered_by_ours() {
        let command = Arguments::command();
        for (flag, told) in [
            ("--raft-layers", "use --raft; "),
            ("--spiral-vase", "a spiral vase is not supported yet; "),
            ("--fill-density", "use --infill; "),
            ("--fill-density=20", "use --infill; "),
            ("--nozzle-diameter", "use --set machine.nozzle_diameter=VALUE; "),
            ("--tolerance", "use --set tolerance=VALUE; "),
            ("--support-material", "use --support; "),
            ("--export-gcode", "use -o FILE; "),
            ("--vase", "a spiral vase is not supported yet; "),
            ("--vase-mode", "a spiral vase is not supported yet; "),
            ("--spiralize", "a spiral vase is not supported yet; "),
            ("--adaptive-layers", "a height of layers that varies is not supported yet; "),
            ("--tree-support", "tree support is not supported yet; "),
            ("--fan", "use --set filament.fan=VALUE; "),
            ("--speed", "use --set speed.wall=VALUE; "),
            ("--top-layers", "use --set top_layers=5; "),
            ("--bottom-layers=4", "use --set bottom_layers=4; "),
            ("--junit", "a report for JUnit (--json is for programs) is not supported yet; "),
            ("--wals", "a similar argument exists: '--walls'; "),
            ("--bogus", ""),
        ] {
            let shown = flag.split('=').next().unwrap();
            let expected =
                format!("unexpected argument '{shown}' found; {told}see `slicer --help`");
            let words = ["slicer", "part.stl", flag, if told.contains("=5") { "5" } else { "-q" }];
            let words = words.map(OsString::from);
            assert_eq!(unknown_flag(flag, true, &words, (&command, "slicer")), expected);
        }
        let told = unknown_flag("--perimeters", false, &[], (&command, "slicer"));
        assert!(!told.contains("--walls"));
    }
}
