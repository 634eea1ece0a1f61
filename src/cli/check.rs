//! `slicer check` -> what is wrong with a G-code file, as lines or as JSON.

use super::args::CheckArgs;
use super::reading::Opened;
use super::{Outcome, failure, output};
use anyhow::Result;
use slicer::check::finding::Count;
use slicer::check::terms::Terms;
use slicer::check::{self, Measures, Model, Verdict};
use slicer::mesh::Bed;
use slicer::profile::{self, Override, Profile, ValueOrigin};
use slicer::progress::Progress;
use slicer::reader::{Cause, Firmware, Stream};
use slicer::text;
use slicer::warning::plural;
use std::ffi::OsString;
use std::path::Path;

/// Diameter of the filament where neither file nor profile gives it, mm: the most usual one.
const DIAMETER: f64 = 1.75;

/// Findings of a kind that people get to read.
const MOST_SHOWN: usize = 5;

/// What standard output gets, and 1 if there are findings that are more than warnings.
///
/// # Errors
/// A profile or setting that is wrong, a file or model that cannot be read, a file without a move.
pub(super) fn run(args: &CheckArgs) -> Result<Outcome> {
    let profiles = &args.profiles;
    let set = profiles.overrides()?;
    // What hangs around the nozzle may be told of any file; all else belongs to a machine.
    if set.iter().any(|given| !is_of_head(given)) && !profiles.any() {
        return Err(failure::usage("--set changes a profile; name one with -p, too"));
    }
    let named = named_head(args);
    let given = if profiles.any() { Some(profiles.load(named.clone())?) } else { None };
    let machine = given.as_ref().map(|profile| &profile.settings);
    let Opened { name, source, says, .. } = args.reading.open(&args.file)?;
    let reading = args.reading.of(machine, says);
    let diameter = given.as_ref().map_or(DIAMETER, |p| p.settings.filament.diameter);
    let unreadable = |error| Cause::Unreadable(error).of(&name);
    let stream = Stream::open(source, reading, diameter).map_err(unreadable)?;
    let print = stream.facts();
    if print.layers.is_empty() {
        return Err(Cause::NoLine.of(&name).into());
    }
    let of_head: Vec<Override> = set.into_iter().filter(is_of_head).chain(named).collect();
    let own = profile::recorded_with(&print.values, &of_head)?;
    let judge = given.as_ref().or(own.as_ref());
    let machine = judge.map(|profile| &profile.settings);
    let mut terms = Terms::new(machine, own.as_ref().map(|profile| &profile.settings), print);
    if !of_head.is_empty() {
        // Told here it holds for files of other slicers, too, and where it is the most cautious one.
        let told = if judge.is_none() {
            Some(profile::load([] as [&str; 0], &of_head)?.settings.head())
        } else {
            machine.map(slicer::profile::Settings::head)
        };
        terms.head = told;
    }
    let bed = judge.map_or(Bed::ANY, |profile| slicer::bed(&profile.settings.machine));
    let placed = if args.against.is_empty() {
        None
    } else {
        let models: Vec<slicer::Model> = args.against.iter().map(slicer::Model::path).collect();
        // Models are as large, and copies lie as far apart, as when the file was made.
        let placement = args.place.placement();
        let made = own.as_ref().or(given.as_ref());
        let placement = made.map_or(placement.clone(), |p| slicer::suited(&placement, &p.settings));
        Some(slicer::place(&models, &placement, &bed, &Progress::default())?)
    };
    let model = placed.as_ref().map(|placed| Model { mesh: &placed.mesh, offset: placed.offset });
    let verdict = check::check_stream(&stream, &terms, model).map_err(unreadable)?;
    let code = u8::from(verdict.fails());
    let text = if args.json {
        output::json(&verdict, Path::new("-"))?
    } else {
        let firmware = print.summary.firmware;
        let by = judged_by(given.as_ref(), own.as_ref(), firmware, &args.against);
        let (headline, findings) = (headline(&verdict), findings(&verdict, "--json"));
        format!("{name}: {headline}, {by}\n{findings}{}", notes(&verdict))
    };
    Ok(Outcome { text, code })
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
fn headline(verdict: &Verdict) -> String {
    let sum = |of: fn(&Count) -> usize| verdict.counts.iter().map(of).sum::<usize>() as u64;
    let (errors, all) = (sum(|one| one.errors), sum(|one| one.count));
    let (findings, warnings) = (plural(errors, "finding"), plural(all - errors, "warning"));
    let found = match (errors, all - errors) {
        (0, 0) => "clean".to_owned(),
        (0, _) => format!("clean but for {warnings}"),
        (_, 0) => findings,
        _ => format!("{findings} and {warnings}"),
    };
    let layers = plural(verdict.layers as u64, "layer");
    format!("{found} in {layers} and {}", plural(verdict.moves as u64, "move"))
}

/// Findings, a line each; where there are too many, `whole` is the option that lists all.
pub(super) fn findings(verdict: &Verdict, whole: &str) -> String {
    verdict.counts.iter().map(|count| of_kind(verdict, count, whole)).collect()
}

/// What was measured, and what was not judged.
pub(super) fn notes(verdict: &Verdict) -> String {
    let mut text = measures(&verdict.measures);
    for not in &verdict.not_judged {
        text.push_str(&format!("not judged: {not}\n"));
    }
    text
}

/// The largest findings of a kind, and how many more there are.
fn of_kind(verdict: &Verdict, &Count { code, count, .. }: &Count, whole: &str) -> String {
    let of_kind = verdict.findings.iter().filter(|finding| finding.code == code);
    let mut text: String = of_kind.take(MOST_SHOWN).map(|finding| format!("{finding}\n")).collect();
    if count > MOST_SHOWN {
        let more = count - MOST_SHOWN;
        text.push_str(&format!("{}: and {more} more ({whole} lists them)\n", code.name()));
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
