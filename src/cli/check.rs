//! `slicer check` -> what is wrong with G-code files, as lines or as JSON.
//!
//! 1. Profiles, and what the command line says of the head, are the same for all files.
//! 2. Each file is read and judged by itself: by `-p`, or else by the settings at its end.
//! 3. One file has a headline, its findings, what was measured and what was not judged. Of several each has a
//!    headline, and every finding names its file.
//! 4. JSON is an object for one file, and for several one on each line, also for one that cannot be read.
//! 5. Errors come before warnings, and of many of a kind the largest.

use super::args::CheckArgs;
use super::reading::Opened;
use super::{Outcome, about, failed, failure, output, say_line};
use anyhow::Result;
use serde::Serialize;
use slicer::check::finding::{Code, Count, Finding, Severity};
use slicer::check::terms::Terms;
use slicer::check::{self, Measures, Model, Verdict};
use slicer::mesh::Bed;
use slicer::mesh::place::Placed;
use slicer::profile::{self, Override, Profile, ValueOrigin};
use slicer::progress::Progress;
use slicer::reader::{Cause, Firmware, Stream};
use slicer::text;
use slicer::warning::plural;
use std::ffi::{OsStr, OsString};
use std::path::Path;

/// Diameter of the filament where neither file nor profile gives it, mm: the most usual one.
const DIAMETER: f64 = 1.75;

/// Findings of a kind that people get to read.
const MOST_SHOWN: usize = 5;

/// What all files are judged with.
struct Judge<'a> {
    args: &'a CheckArgs,
    /// The profiles that are asked for, laid together.
    given: Option<Profile>,
    /// What the command line says of the head.
    of_head: Vec<Override>,
}

/// What was found in a file.
struct Judged {
    name: String,
    verdict: Verdict,
    /// By whose settings, against which models.
    by: String,
}

/// What JSON holds of a file.
#[derive(Serialize)]
struct Row<'a> {
    file: &'a str,
    #[serde(flatten)]
    verdict: &'a Verdict,
    /// Codes that do not count.
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    allowed: &'a [Code],
}

/// What standard output gets, and 1 if there are findings that are more than warnings. Of several files the
/// highest exit code holds, and one that cannot be read keeps no other from being judged.
///
/// # Errors
/// A profile or setting that is wrong; of a single file that it cannot be read or has no move.
pub(super) fn run(args: &CheckArgs) -> Result<Outcome> {
    let profiles = &args.profiles;
    let set = profiles.overrides()?;
    // What hangs around the nozzle may be told of any file; all else belongs to a machine.
    if set.iter().any(|given| !is_of_head(given)) && !profiles.any() {
        return Err(failure::usage("--set changes a profile; name one with -p, too"));
    }
    models_among(args)?;
    let against = args.against.iter().filter(|file| *file == "-").count();
    if args.files.iter().filter(|file| *file == "-").count() + against > 1 {
        return Err(failure::usage("`-` is given twice; standard input holds one file"));
    }
    if against > 0 && args.files.len() > 1 {
        let why = "--against - is read once, and several files are held against it; name a file";
        return Err(failure::usage(why));
    }
    let named = named_head(args);
    let given = if profiles.any() { Some(profiles.load(named.clone())?) } else { None };
    let of_head = set.into_iter().filter(is_of_head).chain(named).collect();
    let judge = Judge { args, given, of_head };
    if let [file] = args.files.as_slice() {
        return judge.outcome(&judge.judge(file)?, false);
    }
    let mut all = Outcome { text: String::new(), code: 0 };
    for file in &args.files {
        let one = judge.judge(file).and_then(|judged| judge.outcome(&judged, true));
        let Outcome { text, code } = match one {
            Ok(outcome) => outcome,
            Err(error) => judge.failed(file, &error)?,
        };
        all.text += &text;
        all.code = all.code.max(code);
    }
    Ok(all)
}

/// A model among the files to be judged was meant to be held against one.
///
/// # Errors
/// [`Usage`](failure::Usage).
fn models_among(args: &CheckArgs) -> Result<()> {
    let is_model = |file: &&OsString| {
        Path::new(file).extension().is_some_and(|end| end.eq_ignore_ascii_case("stl"))
    };
    let Some(model) = args.files.iter().find(is_model) else { return Ok(()) };
    let what = if args.against.is_empty() {
        "what is judged is G-code; give the model after --against"
    } else {
        "repeat --against before each"
    };
    Err(failure::usage(format!("{}: an STL is a model: {what}", text::name(model))))
}

impl Judge<'_> {
    /// Judges a file.
    fn judge(&self, file: &OsStr) -> Result<Judged> {
        let Self { args, given, of_head } = self;
        let machine = given.as_ref().map(|profile| &profile.settings);
        let Opened { name, source, says, .. } = args.reading.open(file)?;
        let reading = args.reading.of(machine, says);
        let diameter = given.as_ref().map_or(DIAMETER, |p| p.settings.filament.diameter);
        let unreadable = |error| Cause::Unreadable(error).of(&name);
        let stream = Stream::open(source, reading, diameter).map_err(unreadable)?;
        let print = stream.facts();
        if print.layers.is_empty() {
            return Err(Cause::NoLine.of(&name).into());
        }
        let own = profile::recorded_with(&print.values, of_head)?;
        let judge = given.as_ref().or(own.as_ref());
        let machine = judge.map(|profile| &profile.settings);
        let mut terms = Terms::new(machine, own.as_ref().map(|profile| &profile.settings), print);
        if !of_head.is_empty() {
            // Told here it holds for files of other slicers, too, and where it is the most cautious one.
            let told = if judge.is_none() {
                Some(profile::load([] as [&str; 0], of_head)?.settings.head())
            } else {
                machine.map(slicer::profile::Settings::head)
            };
            terms.head = told;
        }
        let placed = self.placed(own.as_ref())?;
        let model =
            placed.as_ref().map(|placed| Model { mesh: &placed.mesh, offset: placed.offset });
        let verdict = check::check_stream(&stream, &terms, model).map_err(unreadable)?;
        let firmware = print.summary.firmware;
        let by = judged_by(given.as_ref(), own.as_ref(), firmware, &args.against);
        Ok(Judged { name, verdict, by })
    }

    /// The models to hold it against, as large and as far apart as when the file was made.
    fn placed(&self, own: Option<&Profile>) -> Result<Option<Placed>> {
        let Self { args, given, .. } = self;
        if args.against.is_empty() {
            return Ok(None);
        }
        let judge = given.as_ref().or(own);
        let bed = judge.map_or(Bed::ANY, |profile| slicer::bed(&profile.settings.machine));
        let models: Vec<slicer::Model> = args.against.iter().map(slicer::Model::path).collect();
        let placement = args.place.placement();
        let made = own.or(given.as_ref());
        let placement = made.map_or(placement.clone(), |p| slicer::suited(&placement, &p.settings));
        let placed = slicer::place(&models, &placement, &bed, &Progress::default());
        Ok(Some(placed.map_err(|error| about::unplaced(error, &models))?))
    }

    /// What is said of a file, which may be one of several, and its exit code.
    fn outcome(&self, judged: &Judged, is_one_of_many: bool) -> Result<Outcome> {
        let (args, Judged { name, verdict, by }) = (self.args, judged);
        let counting = verdict.counts.iter().filter(|count| !args.allow.contains(&count.code));
        let fails = counting.clone().any(|count| args.strict || count.errors > 0);
        let row = Row { file: name, verdict, allowed: &args.allow };
        let found = || findings(verdict, &args.allow, "--json");
        let more = if args.quiet { "" } else { several(verdict) };
        let each = || {
            let lines = found() + more;
            lines.lines().map(|line| format!("{name}: {line}\n")).collect::<String>()
        };
        let headline = || format!("{name}: {}, {by}\n", headline(verdict, &args.allow));
        let text = match (args.json, args.quiet, is_one_of_many) {
            (true, _, false) => output::json(&row, Path::new("-"))?,
            (true, _, true) => output::json_line(&row, Path::new("-"))?,
            (_, true, _) => each(),
            (_, _, true) => headline() + &each(),
            (_, _, false) => headline() + &found() + more + &notes(verdict),
        };
        Ok(Outcome { text, code: u8::from(fails) })
    }

    /// What is said of a file that cannot be judged, one of several.
    fn failed(&self, file: &OsStr, error: &anyhow::Error) -> Result<Outcome> {
        let (code, line) = (failure::exit_code(error), failure::line(error));
        say_line("error", &line);
        if !self.args.json {
            let text = if self.args.quiet {
                String::new()
            } else {
                format!("{}: not judged\n", text::name(file))
            };
            return Ok(Outcome { text, code });
        }
        Ok(Outcome { text: failed::row(file, code, line, error)?, code })
    }
}

/// What to do where the print is larger than what it is held against: it may be of several parts.
fn several(verdict: &Verdict) -> &'static str {
    let is_larger =
        |finding: &Finding| finding.code == Code::WrongSize && finding.text.contains(" larger in ");
    if verdict.findings.iter().any(is_larger) {
        "note: a file of several parts is held against all of them: name each with --against, and \
         with --copies how often each was printed\n"
    } else {
        ""
    }
}

fn is_of_head(given: &Override) -> bool {
    given.key.starts_with("head.")
}

/// The head that `--head` names.
fn named_head(args: &CheckArgs) -> Option<Override> {
    let (key, origin) = ("head.name".to_owned(), ValueOrigin::Flag("--head"));
    args.head.clone().map(|value| Override { key, value, origin })
}

fn judged_by(
    given: Option<&Profile>,
    own: Option<&Profile>,
    firmware: Firmware,
    models: &[OsString],
) -> String {
    let by = match (given, own) {
        (Some(profile), _) => format!("judged by the profile {}", profile.sources),
        (None, Some(_)) => "judged by its own settings".to_owned(),
        (None, None) if firmware == Firmware::Other => "judged without a profile".to_owned(),
        (None, None) => format!("judged without a profile, read as {} reads it", firmware.name()),
    };
    if models.is_empty() {
        by
    } else {
        format!("{by}, against {}", models.iter().map(text::name).collect::<Vec<_>>().join(", "))
    }
}

/// `clean` or how many findings and warnings, of how much.
fn headline(verdict: &Verdict, allow: &[Code]) -> String {
    let sum = |allowed: bool, of: fn(&Count) -> usize| {
        let counts = verdict.counts.iter().filter(|one| allow.contains(&one.code) == allowed);
        counts.map(of).sum::<usize>() as u64
    };
    let (errors, all) = (sum(false, |one| one.errors), sum(false, |one| one.count));
    let (findings, warnings) = (plural(errors, "finding"), plural(all - errors, "warning"));
    let found = match (errors, all - errors) {
        (0, 0) => "clean".to_owned(),
        (0, _) => format!("clean but for {warnings}"),
        (_, 0) => findings,
        _ => format!("{findings} and {warnings}"),
    };
    let known = match sum(true, |one| one.count) {
        0 => String::new(),
        known => format!(" ({known} allowed)"),
    };
    let layers = plural(verdict.layers as u64, "layer");
    format!("{found}{known} in {layers} and {}", plural(verdict.moves as u64, "move"))
}

/// Findings, a line each, errors before warnings, and last those of codes that are allowed; where there are too
/// many, `whole` is the option that lists all.
pub(super) fn findings(verdict: &Verdict, allow: &[Code], whole: &str) -> String {
    let of = |severity: Severity, allowed: bool| {
        let kinds = verdict.counts.iter().filter(move |one| allow.contains(&one.code) == allowed);
        kinds.map(move |count| of_kind(verdict, count, (severity, allowed), whole))
    };
    let (errors, warnings) = (Severity::Error, Severity::Warning);
    let counting = of(errors, false).chain(of(warnings, false));
    counting.chain(of(errors, true)).chain(of(warnings, true)).collect()
}

/// What was measured, and what was not judged.
pub(super) fn notes(verdict: &Verdict) -> String {
    let mut text = measures(&verdict.measures);
    for not in &verdict.not_judged {
        text.push_str(&format!("not judged: {not}\n"));
    }
    text
}

/// The largest findings of a kind and severity, and how many more there are.
fn of_kind(
    verdict: &Verdict,
    count: &Count,
    (severity, allowed): (Severity, bool),
    whole: &str,
) -> String {
    let (kind, all) = match severity {
        Severity::Error => ("", count.errors),
        Severity::Warning => ("warning: ", count.count - count.errors),
    };
    let is_it = |one: &&Finding| one.code == count.code && one.severity == severity;
    let of_kind = verdict.findings.iter().filter(is_it).take(MOST_SHOWN);
    let line = |finding: &Finding| {
        let told = finding.to_string();
        // It names its severity itself.
        if allowed { format!("allowed: {}\n", told.trim_start_matches(kind)) } else { told + "\n" }
    };
    let mut text: String = of_kind.map(line).collect();
    if all > MOST_SHOWN {
        let (more, kind) = (all - MOST_SHOWN, if allowed { "allowed: " } else { kind });
        let code = count.code.name();
        text.push_str(&format!("{kind}{code}: and {more} more ({whole} lists them)\n"));
    }
    text
}

fn measures(measures: &Measures) -> String {
    let percent = |name: &str, part: Option<f64>, digits: usize| {
        part.map(|part| format!("{name} {:.digits$} %", 100.0 * part))
    };
    let parts: Vec<String> = [
        percent("outline printed", measures.outline, 2),
        percent("surfaces closed", measures.surface, 2),
        percent("infill", measures.infill, 1),
        percent("walls and skins filled", measures.solid, 1),
        (measures.longest_bridge_mm > 0.0)
            .then(|| format!("longest bridge {:.1} mm", measures.longest_bridge_mm)),
        (measures.part_hangs_mm > 0.0).then(|| {
            format!(
                "{:.0} mm hang where the part itself does: think of --support",
                measures.part_hangs_mm
            )
        }),
    ]
    .into_iter()
    .flatten()
    .collect();
    if parts.is_empty() { String::new() } else { format!("measured: {}\n", parts.join(", ")) }
}
