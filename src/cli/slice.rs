//! Arguments of slicing -> G-code, report and exit code: the program's main job.
//!
//! 1. No two arguments may mean the same file.
//! 2. The report's sink is opened, and a report that is there says that the run has not ended.
//! 3. Profiles are loaded, the models are sliced into the sink of the G-code, and with `--check` that is
//!    read back and judged.
//! 4. With `[steps]` it is read back for the rates of its motors, too, if anybody gets to see them.
//! 5. What was found is told, and written to the report.
//! 6. G-code and report are put in place together.
//!
//! From the second step on a failure is reported, where a report is asked for.

use super::about::{self, About};
use super::args::SliceArgs;
use super::failure::Output;
use super::output::{self, Sink};
use super::publish::publish;
use super::steps::Target;
use super::{check, failed, failure, input, interrupt, progress, say, say_line, summary, usage};
use anyhow::{Context as _, Result};
use slicer::check::Verdict;
use slicer::check::terms::Terms;
use slicer::error::Error;
use slicer::gcode;
use slicer::mesh::MeshReport;
use slicer::profile::{Profile, Settings};
use slicer::progress::Progress;
use slicer::reader::{Print, Reading};
use slicer::report::Report;
use slicer::report::steps::StepsReport;
use slicer::steps;
use slicer::warning::{Warning, plural};
use slicer::{Job, Model, text};
use std::ffi::{OsStr, OsString};
use std::io::Write as _;
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

/// Exit code of a run that is done but has findings: warnings with `--strict`, or of `--check`.
const FINDINGS: u8 = 1;

/// Endings of formats that a file of text must not be taken for, and what to do.
const OTHERS: &[(&str, &str)] = &[
    ("3mf", "choose .gcode"),
    ("amf", "choose .gcode"),
    ("obj", "choose .gcode"),
    ("step", "choose .gcode, or .steps for steps of motors"),
    ("bgcode", "choose .gcode, which Prusa's `bgcode` turns into that"),
    ("x3g", "choose .gcode, which `gpx` turns into that"),
    ("s3g", "choose .gcode, which `gpx` turns into that"),
    ("makerbot", "choose .gcode"),
    ("ufp", "choose .gcode"),
    ("gz", "choose .gcode, or pipe it: -o - | gzip"),
    ("zip", "choose .gcode"),
    ("toml", "it is a profile's ending, and -p reads one; choose .gcode"),
    ("ini", "choose .gcode"),
    ("json", "choose .gcode; --report writes a report"),
    ("html", "choose .gcode; `slicer preview` draws it"),
    ("svg", "choose .gcode; `slicer preview` draws it"),
    ("png", "choose .gcode; `slicer preview` draws it"),
];

/// Slices, and returns the exit code.
///
/// # Errors
/// Everything that can go wrong; then there is no output.
pub(super) fn run(args: &SliceArgs) -> Result<u8> {
    let started = Instant::now();
    interrupt::watch();
    let Some(out) = args.output.as_deref() else {
        return Err(failure::usage("no output; give one with -o"));
    };
    no_file_twice(args, out)?;
    let Some(report) = args.report.as_deref() else { return make(args, out, started, &mut None) };
    let mut report_sink = Some(Sink::open(report)?);
    failed::promise(report);
    let made = make(args, out, started, &mut report_sink);
    made.inspect_err(|error| failed::tell(report, report_sink, error))
}

/// Makes G-code and report. The sink of the report is left where it was not needed.
fn make(
    args: &SliceArgs,
    out: &Path,
    started: Instant,
    report_sink: &mut Option<Sink>,
) -> Result<u8> {
    let profile = load(args)?;
    if args.verbose {
        say(&summary::settings(&profile));
    }
    // Files that profiles inherit, and those that a name finds, are known by now.
    let read = profile.sources.list.iter().filter_map(|source| source.file.as_deref());
    read.map(OsStr::new).try_for_each(|file| usage::replaces(out, file))?;
    let mut target = Target::open(out, &profile.settings)?;

    let mut report = work(args, out, profile, target.gcode())?;
    let is_good = report.check.as_ref().is_none_or(|verdict| !verdict.fails());
    let warnings = report.warnings.len() + report.check.as_ref().map_or(0, Verdict::warnings);
    let is_clean = is_good && !(args.strict && warnings > 0);
    report.exit_code = if is_clean { 0 } else { FINDINGS };
    report.output = is_good.then(|| text::name(out));
    let about = About::of_job(&report.models).to_string();
    tell(args, &about, &report);
    // The report lists the findings, so that it is written with them, too.
    let mut products = Vec::new();
    if is_good {
        products.push(target.whole(out, args.quiet)?);
    }
    if let Some((path, sink)) = args.report.as_deref().zip(report_sink.take()) {
        products.push(write_report(path, sink, &report)?.whole()?);
    }
    publish(products)?;
    if !is_good {
        let why =
            "--check has findings, so that no G-code is written; slice without it to see them";
        say_line("error", format!("{about}: {why}"));
        return Ok(FINDINGS);
    }
    if args.verbose {
        say(&summary::roles(&report));
    }
    if !args.quiet {
        say(&summary::summary(&about, &report, started.elapsed()));
    }
    if !is_clean {
        // The output is written all the same, to be looked at.
        let warnings = plural(warnings as u64, "warning");
        let why = "with --strict; look at them before printing";
        say_line("error", format!("{about}: {warnings} {why}"));
    }
    Ok(report.exit_code)
}

/// Tells what was found: notes, warnings, and what the check says.
fn tell(args: &SliceArgs, about: &str, report: &Report) {
    if !args.quiet {
        say(&summary::notes(about, report));
    }
    for warning in &report.warnings {
        say_line("warning", about::told(warning, report));
    }
    if let Some(verdict) = &report.check {
        say(&about::lines(&check::findings(verdict, &[], "--report"), &report.models));
        if !args.quiet {
            say(&check::notes(verdict));
        }
    }
}

/// Checks that no two arguments mean the same file.
///
/// # Errors
/// [`failure::Usage`].
fn no_file_twice(args: &SliceArgs, out: &Path) -> Result<()> {
    if args.inputs.iter().filter(|input| *input == "-").count() > 1 {
        return usage::refuse("`-` is given twice; standard input holds one model");
    }
    let report = args.report.as_deref();
    if output::is_stdout(out) && report.is_some_and(output::is_stdout) {
        return usage::refuse(
            "G-code and report cannot both go to standard output; name a file for one",
        );
    }
    let same = |a: &Path, b: &Path| {
        !output::is_stdout(a) && !output::is_stdout(b) && usage::is_same_file(a, b)
    };
    if report.is_some_and(|report| same(report, out)) {
        return usage::refuse("-o and --report name the same file; name two");
    }
    for product in std::iter::once(out).chain(report) {
        let read = args.inputs.iter().map(OsString::as_os_str).chain(args.profiles.files());
        if let Some(name) = read.into_iter().find(|name| same(product, Path::new(name))) {
            let name = text::name(name);
            return usage::refuse(&format!(
                "the output would replace {name}; choose another name for it"
            ));
        }
        let ending = product.extension().map(|end| end.to_ascii_lowercase());
        let other = OTHERS.iter().find(|(end, _)| ending.as_deref() == Some(OsStr::new(end)));
        if let Some((_, remedy)) = other.filter(|_| product == out) {
            let name = text::name(product.as_os_str());
            return usage::refuse(&format!(
                "{name}: this format is not written here, only G-code as text; {remedy}"
            ));
        }
        // A forgotten -o in a shell's list of files would cost a model.
        if product.extension().is_some_and(|end| end.eq_ignore_ascii_case("stl")) {
            let name = text::name(product.as_os_str());
            return usage::refuse(&format!(
                "{name} is a model's name, and what is written is none; choose another ending"
            ));
        }
    }
    Ok(())
}

fn load(args: &SliceArgs) -> Result<Profile> {
    let profile = args.profiles.load(args.settings.overrides())?;
    match args.settings.idle(&profile.settings) {
        Some(why) => Err(failure::usage(why)),
        None => Ok(profile),
    }
}

/// Runs the pipeline under a progress bar.
fn work(args: &SliceArgs, out: &Path, profile: Profile, sink: &mut Sink) -> Result<Report> {
    let job = Job {
        models: args.inputs.iter().map(Model::path).collect(),
        placement: args.place.placement(),
        settings: profile.settings,
        sources: profile.sources,
    };
    let progress = Arc::new(Progress::default());
    let _meter = progress::Meter::start(&progress, !args.quiet);
    let mut report = slice_and_check(&job, args.check, out, sink, &progress)?;
    // Reading all of it again is for those who get to see what it gives.
    if !args.quiet || args.report.is_some() {
        report.steps = steps_of(&job.settings, out, sink)?;
    }
    Ok(report)
}

/// How fast motors have to step for what was written, where the profile says how far a step goes.
fn steps_of(settings: &Settings, out: &Path, sink: &mut Sink) -> Result<Option<StepsReport>> {
    if steps::most_rates(settings).is_none() {
        return Ok(None);
    }
    let reading = Reading::from(input::firmware(settings));
    let read = sink
        .read_back()
        .and_then(|mut source| StepsReport::of_file(&mut source, reading, settings));
    read.with_context(|| Output { file: out.to_owned(), action: "cannot read back" })
}

/// Slices; with `check` reads the product back and checks it against the models.
fn slice_and_check(
    job: &Job,
    check: bool,
    out: &Path,
    sink: &mut Sink,
    progress: &Progress,
) -> Result<Report> {
    let settings = &job.settings;
    let bed = slicer::bed(&settings.machine);
    let placement = slicer::suited(&job.placement, settings);
    let placed = slicer::place(&job.models, &placement, &bed, progress)
        .map_err(|error| about::unplaced(error, &job.models))?;
    let mut report = slicer::slice_placed(job, &placed, sink, progress)
        .map_err(|error| named(error, out, &placed.reports))?;
    if !check {
        return Ok(report);
    }
    let print = sink
        .read_back()
        .and_then(|mut source| {
            Print::read_as(&mut source, input::firmware(settings), settings.filament.diameter)
        })
        .with_context(|| Output { file: out.to_owned(), action: "cannot read back" })?;
    let terms = Terms::new(Some(settings), Some(settings), &print);
    let model = slicer::check::Model { mesh: &placed.mesh, offset: placed.offset };
    let verdict = slicer::check::check(&print, &terms, Some(model));
    let length_mm = verdict.measures.part_hangs_mm;
    if length_mm > 0.0 {
        let supported = settings.support.enabled;
        report.warnings.push(Warning::PartHangs { length_mm, supported });
    }
    report.check = Some(verdict);
    Ok(report)
}

/// The library does not know what the output is called.
fn named(error: Error, out: &Path, models: &[MeshReport]) -> anyhow::Error {
    let is_of_output = matches!(error, Error::Gcode(gcode::Error::Write(_)) | Error::Thumbnails(_));
    if !is_of_output {
        return about::unsliced(error, models);
    }
    anyhow::Error::from(error).context(Output { file: out.to_owned(), action: "" })
}

fn write_report(path: &Path, mut sink: Sink, report: &Report) -> Result<Sink> {
    let text = output::json(report, path)?;
    sink.write_all(text.as_bytes())
        .and_then(|()| sink.flush())
        .with_context(|| failure::writing(path))?;
    Ok(sink)
}
