//! Words of the command line -> Arguments: every flag, its help, and the settings it stands for.

use super::place::PlaceArgs;
use super::preview::PreviewArgs;
use super::profiles::{ProfileArgs, ShelfArgs};
use super::reading::ReadingArgs;
use super::texts::CODES;
use super::words::{brim, code, parts, words};
use clap::builder::PossibleValuesParser;
use clap::{Args, Parser, Subcommand};
use slicer::check::finding::Code;
use slicer::profile::{Override, Settings, ValueOrigin};
use std::ffi::OsString;
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  slicer part.stl -p ender-3 -o part.gcode
  slicer part.stl -p ender-3 --dual --infill 25 -o part.gcode
  slicer part.stl -p ender-3 --material petg --set filament.temperature=235 -o part.gcode
  slicer part.stl -p ./mine.toml --copies 4 --report part.json -o part.gcode
  slicer - -p ender-3 -o - < part.stl > part.gcode
  slicer profile new ender-3 > mine.toml
  slicer estimate part.gcode -p ./mine.toml
  slicer check part.gcode --against part.stl
  slicer roughness part.gcode --against part.stl
  slicer preview part.gcode --layer 40 -o part.png
  slicer mesh part.stl -o mended.stl
  slicer steps part.gcode -p ./mine.toml -o part.steps
  slicer send part.steps --port /dev/ttyUSB0

A model whose file is named like a subcommand is given as ./profile.";

const EXIT_CODES: &str = "\
Exit codes:
    0  done
    1  done, but with findings: warnings with --strict, what `check`, `play` or --check found, files
       that `diff` found unequal, a mesh that `mesh` could not close
    2  wrong arguments, profile or setting
    3  a file cannot be read or used; a model does not fit, or leaves nothing to print
    4  an output cannot be written; `send`: the port, the line or the board fails
  101  a fault of the slicer itself
  130  interrupted
  134  no memory to be had
  137  killed, as by a system that runs out of memory
Only the product goes to standard output, everything else to standard error.
A run that fails changes no file but its report, which tells of the failure: `error.code` is a word
for its kind, and `slicer report schema` lists them.";

const CHECK_CODES: &str = "\
Exit codes: 0 clean or warnings, 1 findings, with --strict also warnings,
2 wrong arguments or profile, 3 a file cannot be read or prints nothing, or a
model does not fit the machine; of several files the highest. What could not be
judged is listed and no finding.";

const PILES: &str = "\
What -p, --material, --print and --set give is laid over each file; without a
file it is checked as one pile, as it is laid for a print:
`slicer profile check -p ender.toml --material ./silk.toml`. A file that is wrong
has a line for each unknown key and each wrong value.
Exit codes: 0 all are good, 2 some are not.";

/// Slices STL models into G-code
///
/// Slices STL models into G-code for FDM printers: fine walls and skins, and
/// with --dual the sparse infill of each pair of layers printed at once, twice
/// as thick.
#[derive(Debug, Parser)]
#[command(
    name = "slicer",
    version,
    after_long_help = format!("{EXAMPLES}\n\n{EXIT_CODES}"),
    args_conflicts_with_subcommands = true,
    subcommand_negates_reqs = true,
    disable_help_subcommand = true,
    args_override_self = true,
    arg_required_else_help = true,
    override_usage = "slicer [OPTIONS] <INPUT>... -o <OUT>\n       slicer <COMMAND>",
    max_term_width = 100
)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    pub(crate) command: Option<Command>,
    #[command(flatten)]
    pub(crate) slice: SliceArgs,
}

impl Arguments {
    /// The models, of what slices them.
    pub(super) fn inputs(&self) -> &[OsString] {
        match &self.command {
            None => &self.slice.inputs,
            Some(Command::Compare(args)) => &args.inputs,
            Some(_) => &[],
        }
    }
}

/// What else there is to do than slicing.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// List, show and check profiles
    #[command(subcommand)]
    Profile(ProfileCommand),
    /// Describe the report of slicing
    #[command(subcommand)]
    Report(ReportCommand),
    /// Say how long a G-code file takes
    Estimate(EstimateArgs),
    /// Say what is wrong with a G-code file, also against the model
    Check(Box<CheckArgs>),
    /// Draw a G-code file or a model, as pictures or as a page
    Preview(PreviewArgs),
    /// Say what is wrong with a model's mesh, and mend it
    Mesh(super::mesh::MeshArgs),
    /// Tell what each way of dual injection saves on a model
    Compare(Box<CompareArgs>),
    /// Tell whether two G-code files print the same, and where not
    Diff(super::diff::DiffArgs),
    /// Measure how rough the tops of a print are, against the model
    Roughness(Box<super::roughness::RoughnessArgs>),
    /// Turn a G-code file into steps of motors
    Steps(super::steps::StepsArgs),
    /// Play a stream of steps: totals, steps as text, its path as G-code
    Play(super::play::PlayArgs),
    /// Send a stream of steps to a board over a serial port
    Send(super::send::SendArgs),
    /// Print completions for a shell
    Completions {
        /// The shell
        shell: clap_complete::Shell,
    },
    /// Print a manual page
    Man {
        /// The command, such as `check` or `profile show` [default: the program]
        #[arg(value_name = "COMMAND")]
        command: Vec<String>,
    },
}

impl Command {
    /// Whether it takes long enough to want threads.
    pub(crate) fn computes(&self) -> bool {
        !matches!(
            self,
            Self::Profile(_)
                | Self::Report(_)
                | Self::Send(_)
                | Self::Completions { .. }
                | Self::Man { .. }
        )
    }
}

/// What to do with profiles.
#[derive(Debug, Subcommand)]
pub(crate) enum ProfileCommand {
    /// List all profiles: printers, materials and prints
    List {
        /// Print JSON
        #[arg(long)]
        json: bool,
        #[command(flatten)]
        shelf: ShelfArgs,
    },
    /// Print a short profile of your own, which inherits another one
    New {
        /// The profile to begin with
        #[arg(value_name = "NAME")]
        name: String,
        #[command(flatten)]
        shelf: ShelfArgs,
    },
    /// Print all settings of a profile as TOML, each with where it comes from
    Show {
        /// Name or file (repeatable: a later one is laid over the earlier) [default: your default printer]
        #[arg(value_name = "NAME")]
        names: Vec<OsString>,
        /// Say what each key means, too
        #[arg(short, long)]
        verbose: bool,
        #[command(flatten)]
        profiles: ProfileArgs,
    },
    /// Print the JSON Schema of a profile, by which editors complete and check one
    Schema,
    /// Check profile files, each by itself, and say what is wrong
    #[command(after_help = PILES)]
    Check {
        /// Name or file (repeatable: each is checked by itself)
        #[arg(value_name = "FILE", required_unless_present_any = ["profile", "material", "print"])]
        names: Vec<OsString>,
        #[command(flatten)]
        profiles: ProfileArgs,
    },
}

/// What to do about reports.
#[derive(Debug, Subcommand)]
pub(crate) enum ReportCommand {
    /// Print the JSON Schema of what --report writes
    Schema,
}

/// Arguments of estimating.
#[derive(Debug, Args)]
#[command(after_long_help = CODES)]
pub(crate) struct EstimateArgs {
    /// G-code files of any slicer; `-` reads standard input
    #[arg(value_name = "FILE", required = true)]
    pub(crate) files: Vec<OsString>,
    /// Print JSON
    ///
    /// Print JSON: of one file an object, of several one on each line.
    #[arg(long)]
    pub(crate) json: bool,
    /// List every layer with its time (JSON always does)
    #[arg(long)]
    pub(crate) layers: bool,
    /// Leave out what the file itself says of limits (M201, M203, M204, M205, M566, SET_VELOCITY_LIMIT)
    #[arg(long)]
    pub(crate) fixed_limits: bool,
    #[command(flatten)]
    pub(crate) reading: ReadingArgs,
    #[command(flatten)]
    pub(crate) profiles: ProfileArgs,
}

/// Arguments of checking.
#[derive(Debug, Args)]
#[command(after_help = CHECK_CODES)]
pub(crate) struct CheckArgs {
    /// G-code files of any slicer; `-` reads standard input
    #[arg(value_name = "FILE", required = true)]
    pub(crate) files: Vec<OsString>,
    /// STL file that they were made from (repeatable)
    ///
    /// STL file that they were made from (repeatable); placed as the flags below say, then moved to where the
    /// lines are.
    #[arg(long, value_name = "PART")]
    pub(crate) against: Vec<OsString>,
    /// Print JSON
    ///
    /// Print JSON: of one file an object, of several one on each line.
    #[arg(long)]
    pub(crate) json: bool,
    /// Exit with 1 if there are warnings, too
    #[arg(long)]
    pub(crate) strict: bool,
    /// Findings of these codes do not count (repeatable)
    ///
    /// Findings of these codes, errors and warnings, are known: they are listed after `allowed:`, and do not count
    /// for the exit code (repeatable).
    #[arg(long, value_name = "CODE,..", value_delimiter = ',', value_parser = code)]
    pub(crate) allow: Vec<Code>,
    /// Print findings only, each with its file
    #[arg(short, long, conflicts_with = "json")]
    pub(crate) quiet: bool,
    /// What hangs around the nozzle [default: what the file's settings or the profile say]
    #[arg(long, value_name = "NAME", value_parser = PossibleValuesParser::new(words("head.name")))]
    pub(crate) head: Option<String>,
    #[command(flatten)]
    pub(crate) reading: ReadingArgs,
    #[command(flatten)]
    pub(crate) profiles: ProfileArgs,
    #[command(flatten)]
    pub(crate) place: PlaceArgs,
}

/// Arguments of `compare`.
#[derive(Debug, Args)]
#[command(after_help = CODES)]
pub(crate) struct CompareArgs {
    /// STL files, binary or ASCII
    #[arg(value_name = "INPUT", required = true)]
    pub(crate) inputs: Vec<OsString>,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) profiles: ProfileArgs,
    #[command(flatten)]
    pub(crate) settings: SettingArgs,
    #[command(flatten)]
    pub(crate) place: PlaceArgs,
}

/// Arguments of slicing.
#[derive(Debug, Args)]
pub(crate) struct SliceArgs {
    /// STL files, binary or ASCII; `-` reads standard input
    #[arg(value_name = "INPUT", required = true)]
    pub(crate) inputs: Vec<OsString>,
    /// G-code file to write, or OUT.steps for motors; `-` writes standard output
    #[arg(short, long, value_name = "OUT", required = true)]
    pub(crate) output: Option<PathBuf>,

    #[command(flatten)]
    pub(crate) profiles: ProfileArgs,
    #[command(flatten)]
    pub(crate) settings: SettingArgs,

    #[command(flatten)]
    pub(crate) place: PlaceArgs,

    /// Write a report as JSON; `-` writes standard output
    #[arg(long, value_name = "FILE", help_heading = "Running")]
    pub(crate) report: Option<PathBuf>,
    /// Exit with 1 if there are warnings; the output is written all the same
    #[arg(long, help_heading = "Running")]
    pub(crate) strict: bool,
    /// Check the G-code against the models before it is put in place; with findings it is not
    #[arg(long, help_heading = "Running")]
    pub(crate) check: bool,
    /// Threads to use; the output never depends on it [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024), help_heading = "Running")]
    pub(crate) threads: Option<u16>,
    /// Show only warnings and errors
    #[arg(short, long, conflicts_with = "verbose", help_heading = "Running")]
    pub(crate) quiet: bool,
    /// Show the settings with their origins, and lengths by role
    #[arg(short, long, help_heading = "Running")]
    pub(crate) verbose: bool,
}

/// Flags that stand for settings. Their values are checked with the profile's,
/// so that the messages are the same.
#[derive(Debug, Default, Args)]
#[command(next_help_heading = "Settings")]
pub(crate) struct SettingArgs {
    /// Print infill and support of two layers at once, twice as thick
    #[arg(long)]
    dual: bool,
    /// Print so many layers at once, or as many as pay [default: 2]
    #[arg(long, value_name = "N|auto")]
    dual_ratio: Option<String>,
    /// Where thick lines lie: `pair`, on the top layer of each group, or `interlaced`, shared out evenly
    #[arg(long, value_name = "MODE", value_parser = PossibleValuesParser::new(words("dual.mode")), hide_possible_values = true)]
    dual_mode: Option<String>,
    /// What is printed thick: infill, support, inner-walls, inner-skin, or all
    #[arg(long, value_name = "LIST")]
    dual_parts: Option<String>,
    /// Height of a layer, mm
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    layer_height: Option<String>,
    /// Height of the first layer, mm
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    first_layer_height: Option<String>,
    /// Width of a line, mm
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    line_width: Option<String>,
    /// Number of walls
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    walls: Option<String>,
    /// Where walls begin: at a hidden corner in one line, at the rear, near the nozzle, or anywhere
    #[arg(long, value_name = "PLACE", value_parser = PossibleValuesParser::new(words("seam")))]
    seam: Option<String>,
    /// Solid layers at the top and at the bottom
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    skin_layers: Option<String>,
    /// Density of the sparse infill, %
    #[arg(long, value_name = "PERCENT", allow_negative_numbers = true)]
    infill: Option<String>,
    /// Pattern of the sparse infill
    #[arg(long, value_parser = PossibleValuesParser::new(words("pattern")))]
    pattern: Option<String>,
    /// Iron what is seen from above: `top`, all of it, or `topmost`, the highest layer of each model
    #[arg(long, value_name = "WHERE", default_missing_value = "top", num_args = 0..=1, require_equals = true, value_parser = PossibleValuesParser::new(words("ironing.where")))]
    ironing: Option<String>,
    /// Let the skins of gentle slopes follow the surface, where the head touches nothing
    #[arg(long)]
    nonplanar: bool,
    /// What hangs around the nozzle, for --nonplanar; a profile's `[head]` can say it in mm
    #[arg(long, value_name = "NAME", value_parser = PossibleValuesParser::new(words("head.name")))]
    head: Option<String>,
    /// Print support under overhangs
    #[arg(long)]
    support: bool,
    /// Write round lines as arcs (G2, G3), if machine.arcs says that the printer knows them
    #[arg(long)]
    arcs: bool,
    /// Print layers that would take less time than this more slowly, s; 0 for none
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
    min_layer_time: Option<String>,
    /// Print a brim of this width around the parts, mm; 0 prints none
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    brim: Option<String>,
    /// Print a raft under the parts, in place of a brim
    #[arg(long)]
    raft: bool,
    /// Print so many loops around everything
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    skirt: Option<String>,
    /// Temperature of the nozzle, °C
    #[arg(long, value_name = "CELSIUS", allow_negative_numbers = true)]
    temperature: Option<String>,
    /// What the file says of this program: `version`, or `none` for the same bytes in the next one
    #[arg(long, value_name = "WHAT", value_parser = PossibleValuesParser::new(words("output.stamp")), hide_possible_values = true)]
    stamp: Option<String>,
}

impl SettingArgs {
    /// The settings these flags give.
    pub(crate) fn overrides(&self) -> Vec<Override> {
        let given = self.all().into_iter();
        let one = |(flag, key, value): (&'static str, &str, Option<String>)| {
            let origin = ValueOrigin::Flag(flag);
            Some(Override { key: key.to_owned(), value: value?, origin })
        };
        given.filter_map(one).collect()
    }

    /// What to say of a flag that changes nothing with these settings.
    pub(super) fn idle(&self, settings: &Settings) -> Option<&'static str> {
        let is_idle = self.head.is_some() && !settings.nonplanar.enabled;
        is_idle.then_some("--head: has no effect while nonplanar.enabled is off; add --nonplanar")
    }

    /// The flag that sets a key, if there is one.
    pub(super) fn flag_of(key: &str) -> Option<&'static str> {
        let all = Self::default().all();
        // What sets other keys as well is another wish.
        let is_its_own = |flag: &str| !(flag == "--skin-layers" && key != "skin_layers");
        let found = all.into_iter().find(|(flag, name, _)| *name == key && is_its_own(flag));
        found.map(|(flag, _, _)| flag)
    }

    /// Each flag, the key it sets, and the value given.
    fn all(&self) -> [(&'static str, &'static str, Option<String>); 26] {
        let switched = |on: bool, value: &str| on.then(|| value.to_owned());
        [
            ("--dual", "dual.mode", switched(self.dual, "pair")),
            ("--dual-mode", "dual.mode", self.dual_mode.clone()),
            ("--dual-ratio", "dual.ratio", self.dual_ratio.clone()),
            ("--dual-parts", "dual.parts", self.dual_parts.as_deref().map(parts)),
            ("--layer-height", "layer_height", self.layer_height.clone()),
            ("--first-layer-height", "first_layer_height", self.first_layer_height.clone()),
            ("--line-width", "line_width", self.line_width.clone()),
            ("--walls", "walls", self.walls.clone()),
            ("--seam", "seam", self.seam.clone()),
            ("--skin-layers", "skin_layers", self.skin_layers.clone()),
            // A profile may tell top and bottom apart; the flag means both.
            ("--skin-layers", "top_layers", self.skin_layers.clone()),
            ("--skin-layers", "bottom_layers", self.skin_layers.clone()),
            ("--infill", "infill", self.infill.clone()),
            ("--pattern", "pattern", self.pattern.clone()),
            ("--ironing", "ironing.where", self.ironing.clone()),
            ("--nonplanar", "nonplanar.enabled", switched(self.nonplanar, "true")),
            ("--head", "head.name", self.head.clone()),
            ("--support", "support.enabled", switched(self.support, "true")),
            ("--arcs", "arcs", switched(self.arcs, "true")),
            ("--min-layer-time", "cooling.min_layer_time", self.min_layer_time.clone()),
            ("--brim", "brim.width", self.brim.clone()),
            ("--brim", "brim.where", self.brim.as_deref().map(brim)),
            ("--raft", "raft.enabled", switched(self.raft, "true")),
            ("--skirt", "skirt.loops", self.skirt.clone()),
            ("--temperature", "filament.temperature", self.temperature.clone()),
            ("--stamp", "output.stamp", self.stamp.clone()),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::words::numbers;
    use clap::CommandFactory as _;

    #[test]
    fn the_definition_is_consistent() {
        Arguments::command().debug_assert();
    }

    #[test]
    fn skin_layers_win_over_top_and_bottom_of_a_profile() {
        let words = ["slicer", "a.stl", "-o", "b", "--skin-layers", "4"];
        let arguments = Arguments::try_parse_from(words).unwrap();
        let overrides = arguments.slice.settings.overrides();
        let keys: Vec<_> = overrides.iter().map(|one| one.key.as_str()).collect();
        assert_eq!(keys, ["skin_layers", "top_layers", "bottom_layers"]);
    }

    #[test]
    fn negative_turns_and_places_are_no_flags() {
        let words = ["slicer", "a.stl", "-o", "b", "--rotate", "-90,0,0.5", "--at", "-3,4"];
        let placement = Arguments::try_parse_from(words).unwrap().slice.place.placement();
        assert_eq!(placement.rotate, [-90.0, 0.0, 0.5]);
        assert_eq!(placement.at, Some([-3.0, 4.0]));
        assert!(numbers::<2>("1,2,3").is_err());
        assert!(numbers::<2>("1,nan").is_err());
    }
}
