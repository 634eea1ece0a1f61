//! `slicer diff` -> whether two G-code files print the same, as a verdict with a table or as JSON.

mod text;

use super::profiles::ProfileArgs;
use super::reading::{Opened, ReadingArgs};
use super::{Outcome, clock, failure, input};
use anyhow::Result;
use clap::Args;
use slicer::diff::{Side, Tolerances, diff};
use slicer::estimate::{Options, estimate};
use slicer::motion::Limits;
use slicer::profile::{self, Profile};
use slicer::reader::{Firmware, Print, Reading};
use std::ffi::OsString;
use std::io::Read as _;

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
    pub(crate) reading: ReadingArgs,
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
    let (a, b) = (args.reading.open(&args.a)?, args.reading.open(&args.b)?);
    let [by, or] = readings(args, [a.says, b.says])?;
    let (one, other) = rayon::join(|| print(&a, by), || print(&b, or));
    let (one, other) = (one?, other?);
    let files = [(&*one.values, "the settings in A"), (&*other.values, "the settings in B")];
    let (clock, limits) = clock::of(&args.profiles, &files)?;
    let (one, other) = rayon::join(|| side(&a, one, &clock, by), || side(&b, other, &clock, or));
    let tolerances =
        Tolerances { place: args.tolerance, share: args.sums / 100.0, settings: args.settings };
    let found = diff(&one?, &other?, &tolerances);
    let code = if found.equal { 0 } else { UNEQUAL };
    let text = if args.json {
        clock::json(&found, &limits)?
    } else {
        text::text(&found, &limits, args.all)
    };
    Ok(Outcome { text, code })
}

/// How each file is read. What one does not say, such as a file without comments, the other says for both.
fn readings(args: &DiffArgs, says: [Reading; 2]) -> Result<[Reading; 2]> {
    let profile = args.profiles.load([])?;
    let machine = args.profiles.any().then_some(&profile.settings);
    let other = |own: usize| match says[own].firmware {
        Firmware::Other => Reading { firmware: says[1 - own].firmware, ..says[own] },
        _ => says[own],
    };
    Ok([0, 1].map(|file| args.reading.of(machine, other(file))))
}

fn print(opened: &Opened, reading: Reading) -> Result<Print> {
    let print = Print::read_as(&mut opened.source.reader(), reading, SOME_DIAMETER);
    let mut print = print.map_err(|error| opened.unreadable(error))?;
    print.values = profile::renewed(&print.values);
    Ok(print)
}

fn side(opened: &Opened, print: Print, clock: &Profile, reading: Reading) -> Result<Side> {
    let settings = &clock.settings;
    // An Ultimaker 2 knows what its own files leave to it.
    let firmware = match (reading.firmware, input::firmware(settings)) {
        (Firmware::Ultimaker(_) | Firmware::Other, own @ Firmware::Ultimaker(_)) => own,
        (said, _) => said,
    };
    let filament_diameter = settings.filament.diameter;
    let volumes = reading.volumes;
    let options = Options { filament_diameter, firmware, volumes, ..Options::default() };
    let mut bytes = Vec::new();
    let read = opened.source.reader().read_to_end(&mut bytes);
    read.map_err(|error| opened.unreadable(error))?;
    let time = estimate(&mut &bytes[..], &opened.name, &Limits::new(settings), options)?;
    Ok(Side::new(&bytes, print, time))
}

fn tolerance(text: &str) -> std::result::Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| "it must be a number, such as 0.05".to_owned())?;
    if value.is_finite() && value >= 0.0 {
        Ok(value)
    } else {
        Err("it must be 0 or more".to_owned())
    }
}
