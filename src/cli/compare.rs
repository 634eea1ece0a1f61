//! `slicer compare` -> what plain printing and each way of dual injection take, as a table or as JSON.

use super::args::CompareArgs;
use super::{failure, output, words};
use anyhow::Result;
use slicer::compare::{self, Comparison, Way};
use slicer::profile::{Override, Profile, ValueOrigin};
use slicer::{Job, Model};
use std::path::Path;

/// What standard output gets.
///
/// # Errors
/// Those of slicing.
pub(super) fn run(args: &CompareArgs) -> Result<String> {
    if args.inputs.iter().any(|input| input == "-") {
        let why = "compare slices its models several times; give files, not standard input";
        return Err(failure::usage(why));
    }
    let jobs: Vec<(String, Job)> =
        ways(args)?.into_iter().map(|(flags, profile)| (flags, job(args, profile))).collect();
    let models: Vec<Model> = args.inputs.iter().map(Model::path).collect();
    let found = compare::compare(&jobs).map_err(|error| super::about::unplaced(error, &models))?;
    if args.json {
        return output::json(&found, Path::new("-"));
    }
    Ok(table(&found))
}

fn job(args: &CompareArgs, mut profile: Profile) -> Job {
    // Nobody sees what is written.
    profile.settings.machine.thumbnails.clear();
    Job {
        models: args.inputs.iter().map(Model::path).collect(),
        placement: args.place.placement(),
        settings: profile.settings,
        sources: profile.sources,
    }
}

/// The ways to print, by the flags that give them: plain, as groups and interlaced, each
/// ratio that the nozzle allows, and each set of parts.
fn ways(args: &CompareArgs) -> Result<Vec<(String, Profile)>> {
    let mut ways = vec![("(plain)".to_owned(), load(args, &[("dual.mode", "off")])?)];
    let pair = ("dual.mode", "pair");
    for mode in ["pair", "interlaced"] {
        let profile = load(args, &[("dual.mode", mode)])?;
        let flags =
            if mode == "pair" { "--dual".to_owned() } else { format!("--dual-mode {mode}") };
        ways.push((flags, profile));
    }
    let base = ways[1].1.settings.dual_ratio();
    let most = load(args, &[pair, ("dual.ratio", "auto")])?.settings.dual_ratio();
    for ratio in (2..=most).filter(|&ratio| ratio != base) {
        let profile = load(args, &[pair, ("dual.ratio", &ratio.to_string())])?;
        ways.push((format!("--dual --dual-ratio {ratio}"), profile));
    }
    for parts in ["infill", "infill,support", "infill,support,inner-walls", "all"] {
        let profile = load(args, &[pair, ("dual.parts", &words::parts(parts))])?;
        if profile.settings.dual.parts != ways[1].1.settings.dual.parts {
            ways.push((format!("--dual --dual-parts {parts}"), profile));
        }
    }
    Ok(ways)
}

fn load(args: &CompareArgs, more: &[(&str, &str)]) -> Result<Profile> {
    let mut overrides = args.settings.overrides();
    overrides.extend(more.iter().map(|(key, value)| Override {
        key: (*key).to_owned(),
        value: (*value).to_owned(),
        origin: ValueOrigin::Set,
    }));
    args.profiles.load(overrides)
}

/// For people.
fn table(found: &Comparison) -> String {
    let width = found.ways.iter().map(|way| way.flags.len()).max().unwrap_or(0);
    let mut text = format!(
        "{:<width$} {:>10} {:>7} {:>12} {:>22} {:>7} {:>12}\n",
        "way", "time s", "saved", "filament mm", "layers s, from .. to", "spread", "flow mm³/s"
    );
    for way in &found.ways {
        text.push_str(&row(way, width));
    }
    text
}

fn row(way: &Way, width: usize) -> String {
    let layers = format!("{:.1} .. {:.1}", way.shortest_layer_s, way.longest_layer_s);
    format!(
        "{:<width$} {:>10.0} {:>6.1}% {:>12.0} {layers:>22} {:>7.3} {:>12.1}\n",
        way.flags,
        way.time_s,
        way.saved_percent,
        way.filament_mm,
        way.layer_spread,
        way.largest_flow_mm3_s
    )
}
