//! `slicer diff` -> whether two G-code files print the same, as a verdict with a table, as JSON or as a picture.
//!
//! Words used here: the *clock* is the profile by whose limits both files are timed; an *opened* file
//! is one whose facts are known, and a [`Side`] one that can be compared.
//!
//! 1. Both files are read for their facts. Standard input is kept in a temporary file, since it is
//!    read more than once.
//! 2. The clock is found: a profile that is asked for, or the settings in one of the files.
//! 3. Both are timed and compared. The verdict is the exit code.
//! 4. A picture, or a page with several, is written and put in its place; then the verdict is
//!    printed, unless it is to be quiet.

mod picture;
mod text;

use super::output::Sink;
use super::profiles::ProfileArgs;
use super::reading::{self, ReadingArgs};
use super::{Outcome, clock, failure, input, interrupt, output};
use anyhow::Result;
use clap::{Args, ValueEnum};
use slicer::diff::{Side, Tolerances, diff, views};
use slicer::estimate::{Options, estimate};
use slicer::motion::Limits;
use slicer::profile::{self, Profile};
use slicer::reader::{Cause, Firmware, Reading, Stream};
use std::ffi::OsString;
use std::path::{Path, PathBuf};

const DIFF_RULES: &str = "\
Equal are files whose plastic, ways and orders to the printer are the same:
  moved    a print that lies elsewhere as a whole is one finding, and so is a part of a plate that
           moved alone; all else is compared as if it did not
  layers   the same number of layers, each at the same z within MM
  lines    every place of every line within MM of a line of the same role in the other file, in the
           same layer; neither their order, direction nor division into moves matters
  filament as much filament for each mm of these lines within PERCENT, beside what the decimals
           of a file leave open
  travels  every place of every way without a line within MM of such a way in the other file, z as well,
           from the file's first move to its last; their order matters, and as much filament is pulled
           back and pushed out again in each layer. Where only the order of lines differs, that is told
           once. --ignore travels leaves all of this out
  seams    every wall begins within --seams MM of where one of its kind begins in the other file
  sums     in each layer, by role: length within PERCENT and 0.1 mm, filament within PERCENT and
           0.01 mm, time at the feeds asked for within PERCENT and 0.1 s; in the file, length and
           filament likewise, and the time of the whole print within PERCENT and 1 s
  orders   the same temperatures, and the same other commands such as M106, in the same order
           within each layer; M73, M105, M117 and M118 are left out
  limits   the same speeds, accelerations and jerks that the printer is told (M201, M203, M204, M205,
           M566, SET_VELOCITY_LIMIT), and the same waits (G4) of 20 s and more; how often and where
           that is told shows in the times alone
Told but not decisive: settings in comments (unless --settings), widths in comments, and how often and
how long the file travels and retracts in all; the time of that is part of the file's.
If one of the files tells no roles, all lines count as one role, and seams are not compared. What comes
before the first layer is layer 0 in JSON. Both files are timed with the same limits: those of -p, else
those that A holds as settings, else those of B, else those of the default profile.

A picture (-o) shows the worst layer, a page (.html) the worst ones: what both files print is grey, what
only A prints blue, what only B prints orange, travels that differ dashed.

Kinds of findings in JSON, worst first: layers-only-in, moved, part-moved, heights, heaters, role-only-in,
lines, flow, sum, travels, commands, limits, retractions, firmware-retractions, seams, order, setting; --schema says
what each holds.

Exit codes: 0 equal, 1 not equal, 2 wrong arguments, 3 a file cannot be read or holds no move, 4 an
output cannot be written.";

/// Arguments of `diff`.
#[derive(Debug, Args)]
#[command(after_long_help = DIFF_RULES)]
pub(crate) struct DiffArgs {
    /// G-code file of any slicer; `-` reads standard input
    #[arg(value_name = "A", required_unless_present = "schema")]
    pub(crate) a: Option<OsString>,
    /// The file that it is compared with; `-` reads standard input
    #[arg(value_name = "B", required_unless_present = "schema")]
    pub(crate) b: Option<OsString>,
    /// How far places may lie apart, mm
    #[arg(long, value_name = "MM", default_value = "0.01", value_parser = tolerance, allow_negative_numbers = true)]
    pub(crate) tolerance: f64,
    /// How far apart walls may begin, mm
    #[arg(long, value_name = "MM", default_value = "0.1", value_parser = tolerance, allow_negative_numbers = true)]
    pub(crate) seams: f64,
    /// How much sums of length, filament and time may differ, %
    #[arg(long, value_name = "PERCENT", default_value = "0.1", value_parser = tolerance, allow_negative_numbers = true)]
    pub(crate) sums: f64,
    /// Leave out ways without a line and retractions, or where walls begin (repeatable, or with commas)
    #[arg(long, value_name = "WHAT", value_delimiter = ',')]
    pub(crate) ignore: Vec<Ignored>,
    /// Settings in the comments have to be the same, too
    #[arg(long)]
    pub(crate) settings: bool,
    /// Draw the worst layer, .svg or .png, or write a page with the worst ones, .html
    #[arg(short, long, value_name = "OUT")]
    pub(crate) output: Option<PathBuf>,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
    /// Print the JSON Schema of what --json prints
    #[arg(long, exclusive = true)]
    pub(crate) schema: bool,
    /// List all differences, not only the worst (JSON always does)
    #[arg(long)]
    pub(crate) all: bool,
    /// Print nothing; the exit code says whether they are equal
    #[arg(short, long, conflicts_with_all = ["json", "all"])]
    pub(crate) quiet: bool,
    #[command(flatten)]
    pub(crate) reading: ReadingArgs,
    #[command(flatten)]
    pub(crate) profiles: ProfileArgs,
}

/// What need not be the same.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Ignored {
    /// Ways without a line, and what is pulled back between lines
    Travels,
    /// Where walls begin
    Seams,
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
    if args.schema {
        let text = output::json(&slicer::diff::schema(), Path::new("-"))?;
        return Ok(Outcome { text, code: 0 });
    }
    let name = |file: &'_ Option<OsString>| file.clone().unwrap_or_default();
    let (a, b) = (name(&args.a), name(&args.b));
    if a == "-" && b == "-" {
        let why = "`-` is given twice; standard input holds one file";
        return Err(failure::usage(why));
    }
    let format = args.output.as_deref().map(|out| picture::format(out, [&a, &b])).transpose()?;
    interrupt::watch();
    let sink = args.output.as_deref().map(Sink::open).transpose()?;
    let (a, b) = (args.reading.open(&a)?, args.reading.open(&b)?);
    let names = [a.name.clone(), b.name.clone()];
    let [by, or] = readings(args, [a.says, b.says])?;
    let (one, other) = rayon::join(|| opened(a, by), || opened(b, or));
    let (one, other) = (one?, other?);
    let files = [(&*one.values, "the settings in A"), (&*other.values, "the settings in B")];
    let (clock, limits) = clock::of(&args.profiles, &files)?;
    let (one, other) = rayon::join(|| side(one, &clock), || side(other, &clock));
    let (one, other) = (one?, other?);
    let found = diff(&one, &other, &args.tolerances())?;
    let code = if found.equal { 0 } else { UNEQUAL };
    if let (Some(out), Some(format), Some(sink)) = (args.output.as_deref(), format, sink) {
        let said = text::text(&found, &limits, args.all);
        let views = |layers: &[_], in_place| Ok(views(&one, &other, layers, &found, in_place)?);
        let names = names.each_ref().map(String::as_str);
        picture::write(sink, format, &found, (names, &said), &views, out)?;
    }
    let text = match args {
        _ if args.quiet => String::new(),
        _ if args.json => clock::json(None, &found, &limits, None, None)?,
        _ => text::text(&found, &limits, args.all),
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

impl DiffArgs {
    fn tolerances(&self) -> Tolerances {
        let ignores = |what| self.ignore.contains(&what);
        Tolerances {
            place: self.tolerance,
            share: self.sums / 100.0,
            seams: if ignores(Ignored::Seams) { f64::INFINITY } else { self.seams },
            travels: !ignores(Ignored::Travels),
            settings: self.settings,
        }
    }
}

/// A file whose facts are known.
struct Opened {
    name: String,
    reading: Reading,
    stream: Stream,
    /// Settings in its comments, by today's names.
    values: Vec<(String, String)>,
}

fn opened(file: reading::Opened, reading: Reading) -> Result<Opened> {
    let reading::Opened { name, source, .. } = file;
    let stream = Stream::open(source, reading, SOME_DIAMETER)
        .map_err(|error| Cause::Unreadable(error).of(&name))?;
    let values = profile::renewed(&stream.facts().values);
    Ok(Opened { name, reading, stream, values })
}

fn side(opened: Opened, clock: &Profile) -> Result<Side> {
    let Opened { name, reading, stream, values } = opened;
    let settings = &clock.settings;
    // An Ultimaker 2 knows what its own files leave to it.
    let firmware = match (reading.firmware, input::firmware(settings)) {
        (Firmware::Ultimaker(_) | Firmware::Other, own @ Firmware::Ultimaker(_)) => own,
        (said, _) => said,
    };
    let filament_diameter = settings.filament.diameter;
    let volumes = reading.volumes;
    let options = Options { filament_diameter, firmware, volumes, ..Options::default() };
    let time = estimate(&mut stream.source().reader(), &name, &Limits::new(settings), options)?;
    Ok(Side::new(&name, stream, values, time)?)
}

fn tolerance(text: &str) -> std::result::Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| "it must be a number, such as 0.05".to_owned())?;
    if value.is_finite() && value >= 0.0 {
        Ok(value)
    } else {
        Err("it must be 0 or more".to_owned())
    }
}
