//! `slicer diff` -> whether two G-code files print the same, as a verdict with a table or as JSON.

mod text;

use super::profiles::ProfileArgs;
use super::{Outcome, failure, input, output};
use anyhow::Result;
use clap::Args;
use serde::Serialize;
use slicer::diff::{Difference, Side, Tolerances, diff};
use slicer::estimate::{Options, estimate};
use slicer::motion::Limits;
use slicer::profile::{self, Profile};
use slicer::reader::{Cause, Firmware, Print};
use std::ffi::OsString;
use std::path::Path;

const DIFF_RULES: &str = "\
Equal are files whose plastic and orders to the printer are the same:
  layers   the same number of layers, each at the same z within MM
  lines    every place of every line within MM of a line of the same role in the other file, in the
           same layer; neither their order, direction nor division into moves matters
  filament as much filament for each mm of these lines within PERCENT, beside what the decimals
           of a file leave open
  sums     in each layer, by role: length within PERCENT and 0.1 mm, filament within PERCENT and
           0.01 mm, time at the feeds asked for within PERCENT and 0.1 s; in the file, length and
           filament likewise, and the time of the whole print within PERCENT and 1 s
  orders   the same temperatures, and the same other commands such as M106, in the same order
           within each layer; M73, M105, M117 and M118 are left out
Told but not decisive: settings in comments (unless --settings), widths in comments, and the count
and length of travels and retractions, which leave no plastic; their time is part of the file's.
If one of the files tells no roles, all lines count as one role. What comes before the first
layer is layer 0 in JSON. Both files are timed with the same limits: those of -p, else those that A
holds as settings, else those of B, else those of the default profile.

Exit codes: 0 equal, 1 not equal, 2 wrong arguments, 3 a file cannot be read or holds no move.";

/// Arguments of `diff`.
#[derive(Debug, Args)]
#[command(after_long_help = DIFF_RULES)]
pub(crate) struct DiffArgs {
    /// G-code file of any slicer; `-` reads standard input
    #[arg(value_name = "A")]
    pub(crate) a: OsString,
    /// The file that it is compared with; `-` reads standard input
    #[arg(value_name = "B")]
    pub(crate) b: OsString,
    /// How far places may lie apart, mm
    #[arg(long, value_name = "MM", default_value = "0.01", value_parser = tolerance, allow_negative_numbers = true)]
    pub(crate) tolerance: f64,
    /// How much sums of length, filament and time may differ, %
    #[arg(long, value_name = "PERCENT", default_value = "0.1", value_parser = tolerance, allow_negative_numbers = true)]
    pub(crate) sums: f64,
    /// Settings in the comments have to be the same, too
    #[arg(long)]
    pub(crate) settings: bool,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
    /// List all differences, not only the worst (JSON always does)
    #[arg(long)]
    pub(crate) all: bool,
    #[command(flatten)]
    pub(crate) limit: input::LimitArgs,
    #[command(flatten)]
    pub(crate) profiles: ProfileArgs,
}

/// Exit code of files that are not equal.
const UNEQUAL: u8 = 1;

/// Diameter that widths are worked out with before the files' own is known, mm. What is
/// compared is the filament itself.
const SOME_DIAMETER: f64 = 1.75;

/// What standard output gets, and whether the files are equal.
///
/// # Errors
/// A profile or setting that is wrong, a file that cannot be read or holds no move.
pub(super) fn run(args: &DiffArgs) -> Result<Outcome> {
    if args.a == "-" && args.b == "-" {
        let why = "`-` is given twice; standard input holds one file";
        return Err(failure::usage(why));
    }
    let (a, b) = (input::read(&args.a, args.limit)?, input::read(&args.b, args.limit)?);
    let (one, other) = rayon::join(|| print(&a), || print(&b));
    let (one, other) = (one?, other?);
    let (clock, limits) = clock(args, &one, &other)?;
    let (one, other) = rayon::join(|| side(&a, one, &clock), || side(&b, other, &clock));
    let tolerances =
        Tolerances { place: args.tolerance, share: args.sums / 100.0, settings: args.settings };
    let found = diff(&one?, &other?, &tolerances);
    let code = if found.equal { 0 } else { UNEQUAL };
    let text =
        if args.json { json(&found, &limits)? } else { text::text(&found, &limits, args.all) };
    Ok(Outcome { text, code })
}

fn print((name, bytes): &(String, Vec<u8>)) -> Result<Print> {
    let print = Print::read(&mut bytes.as_slice(), SOME_DIAMETER);
    let mut print = print.map_err(|error| Cause::Unreadable(error).of(name))?;
    print.values = profile::renewed(&print.values);
    Ok(print)
}

fn side((name, bytes): &(String, Vec<u8>), print: Print, clock: &Profile) -> Result<Side> {
    let settings = &clock.settings;
    // Whatever the clock's dialect, both files are read alike; but an Ultimaker 2 knows what its own
    // files leave to it.
    let firmware = match input::firmware(settings) {
        own @ Firmware::Ultimaker(_) => own,
        _ => Firmware::default(),
    };
    let filament_diameter = settings.filament.diameter;
    let options = Options { filament_diameter, firmware, ..Options::default() };
    let time = estimate(&mut bytes.as_slice(), name, &Limits::new(settings), options)?;
    Ok(Side::new(bytes, print, time))
}

/// The profile by whose limits both files are timed, and where it is from.
fn clock(args: &DiffArgs, a: &Print, b: &Print) -> Result<(Profile, String)> {
    let overrides = args.profiles.overrides()?;
    let asked = args.profiles.load([])?;
    if args.profiles.any() {
        let origin = format!("profile {}", asked.sources);
        return Ok((asked, origin));
    }
    for (print, file) in [(a, "A"), (b, "B")] {
        // A file of another version may hold settings that do not exist any more.
        if !matches!(profile::recorded(&print.values), Ok(Some(_))) {
            continue;
        }
        let mut values = print.values.clone();
        values.extend(overrides.iter().map(|set| (set.key.clone(), set.value.clone())));
        if let Some(recorded) = profile::recorded(&values)? {
            return Ok((recorded, format!("the settings in {file}")));
        }
    }
    let origin = format!("profile {}", asked.sources);
    Ok((asked, origin))
}

fn json(found: &Difference, limits: &str) -> Result<String> {
    #[derive(Serialize)]
    struct Product<'a> {
        #[serde(flatten)]
        difference: &'a Difference,
        /// Where the limits are from that both files are timed with.
        limits: &'a str,
    }
    output::json(&Product { difference: found, limits }, Path::new("-"))
}

fn tolerance(text: &str) -> std::result::Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| "it must be a number, such as 0.05".to_owned())?;
    if value.is_finite() && value >= 0.0 {
        Ok(value)
    } else {
        Err("it must be 0 or more".to_owned())
    }
}
