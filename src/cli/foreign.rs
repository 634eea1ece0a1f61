//! Flag that there is not -> what it is called here, or the flag it is nearest to.

use super::args::SettingArgs;
use slicer::profile::foreign::{self, Foreign};
use slicer::profile::{keys, suggest};

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

/// What to say of a flag that there is not: what it is called here, or which one it is nearest
/// to. The command is the one that it was given to, with its name as it is shown, and `takes_settings` whether
/// that slices.
pub(super) fn unknown_flag(
    flag: &str,
    takes_settings: bool,
    (command, shown): (&clap::Command, &str),
) -> String {
    let flag = flag.split('=').next().unwrap_or(flag);
    let name = flag.trim_start_matches('-');
    let foreign = || FOREIGN_FLAGS.iter().find(|(theirs, _)| *theirs == flag);
    let told = if let Some(what) = setting_for(name).filter(|_| takes_settings) {
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

/// How a setting is made that someone takes for a flag.
fn setting_for(name: &str) -> Option<String> {
    let ours = keys::find(&name.replace('-', "_")).map(|key| Foreign::Key(&key.name));
    Some(match ours.or_else(|| foreign::meaning(name))? {
        Foreign::Key(key) => SettingArgs::flag_of(key)
            .map_or_else(|| format!("use --set {key}=VALUE"), |flag| format!("use {flag}")),
        Foreign::NotSupported(what) => format!("{what} is not supported yet"),
    })
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
            ("--wals", "a similar argument exists: '--walls'; "),
            ("--bogus", ""),
        ] {
            let shown = flag.split('=').next().unwrap();
            let expected =
                format!("unexpected argument '{shown}' found; {told}see `slicer --help`");
            assert_eq!(unknown_flag(flag, true, (&command, "slicer")), expected);
        }
        assert!(!unknown_flag("--perimeters", false, (&command, "slicer")).contains("--walls"));
    }
}
