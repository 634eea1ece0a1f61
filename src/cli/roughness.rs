//! `slicer roughness` -> how rough the tops are that a G-code file prints, as a table or as JSON.

use super::output;
use super::place::PlaceArgs;
use super::profiles::ProfileArgs;
use super::reading::{Opened, ReadingArgs};
use super::texts::ROUGHNESS;
use anyhow::{Context as _, Result};
use clap::Args;
use slicer::check::terms::Terms;
use slicer::mesh::Bed;
use slicer::profile;
use slicer::progress::Progress;
use slicer::reader::{Cause, Stream};
use slicer::roughness::{Means, Model, OfPatch, Options, Roughness, Values, roughness};
use slicer::text;
use std::ffi::OsString;
use std::path::Path;

/// Arguments of `roughness`.
#[derive(Debug, Args)]
#[command(after_long_help = ROUGHNESS)]
pub(crate) struct RoughnessArgs {
    /// G-code file of any slicer; `-` reads standard input
    #[arg(value_name = "FILE", required_unless_present = "schema")]
    pub(crate) file: Option<OsString>,
    /// STL file that it was made from (repeatable); placed as the flags below say, then moved to where the lines are
    #[arg(long, value_name = "PART", required_unless_present = "schema")]
    pub(crate) against: Vec<OsString>,
    /// Cut-off of the Gaussian filters, mm
    #[arg(long, value_name = "MM", default_value = "8", value_parser = cutoff, allow_negative_numbers = true)]
    pub(crate) lc: f64,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
    /// Print the JSON Schema of what --json prints
    #[arg(long, exclusive = true)]
    pub(crate) schema: bool,
    #[command(flatten)]
    pub(crate) reading: ReadingArgs,
    #[command(flatten)]
    pub(crate) profiles: ProfileArgs,
    #[command(flatten)]
    pub(crate) place: PlaceArgs,
}

/// Diameter of the filament where neither file nor profile gives it, mm: the most usual one.
const DIAMETER: f64 = 1.75;

/// Patches that people get to read.
const MOST_SHOWN: usize = 12;

/// What standard output gets.
///
/// # Errors
/// A profile or setting that is wrong, a file or model that cannot be read, one without the other.
pub(super) fn run(args: &RoughnessArgs) -> Result<String> {
    if args.schema {
        return output::json(&slicer::roughness::schema(), Path::new("-"));
    }
    let profiles = &args.profiles;
    let given = if profiles.any() { Some(profiles.load([])?) } else { None };
    let machine = given.as_ref().map(|profile| &profile.settings);
    let Opened { name, source, says, .. } =
        args.reading.open(args.file.as_deref().unwrap_or_default())?;
    let reading = args.reading.of(machine, says);
    let diameter = machine.map_or(DIAMETER, |settings| settings.filament.diameter);
    let unreadable = |error| Cause::Unreadable(error).of(&name);
    let stream = Stream::open(source, reading, diameter).map_err(unreadable)?;
    let print = stream.facts();
    if print.layers.is_empty() {
        return Err(Cause::NoLine.of(&name).into());
    }
    let own = profile::recorded(&print.values)?;
    let made = own.as_ref().or(given.as_ref()).map(|profile| &profile.settings);
    let judge = machine.or(made);
    let bed = judge.map_or(Bed::ANY, |settings| slicer::bed(&settings.machine));
    let models: Vec<slicer::Model> = args.against.iter().map(slicer::Model::path).collect();
    // Models are as large, and copies lie as far apart, as when the file was made.
    let placement = args.place.placement();
    let placement = made.map_or(placement.clone(), |settings| slicer::suited(&placement, settings));
    let placed = slicer::place(&models, &placement, &bed, &Progress::default())?;
    let lift = Terms::new(judge, own.as_ref().map(|profile| &profile.settings), print).lift;
    let model =
        Model { mesh: &placed.mesh, adjacency: &placed.adjacency, offset: placed.offset, lift };
    let found =
        roughness(&stream, model, &Options { cutoff: args.lc }).with_context(|| name.clone())?;
    if args.json {
        return output::json(&found, Path::new("-"));
    }
    let parts: Vec<String> = args.against.iter().map(text::name).collect();
    Ok(table(&name, &parts.join(", "), &found))
}

/// For people.
fn table(name: &str, parts: &str, found: &Roughness) -> String {
    let Roughness { cell_mm, layer_mm, cutoff_mm, .. } = found;
    let mut text = format!(
        "{name} against {parts}: tops that slope by 0.5° to 45°, by cells of {cell_mm} mm and layers of \
         {layer_mm} mm; Gauss {cutoff_mm} mm\n"
    );
    if found.moved_mm.iter().any(|by| *by != 0.0) {
        let [x, y] = found.moved_mm;
        text.push_str(&format!("the part lies x {x:.2} y {y:.2} mm from where it was expected\n"));
    }
    if found.lift_mm != 0.0 {
        text.push_str(&format!("a raft lifts it by {:.2} mm\n", found.lift_mm));
    }
    text.push_str(&format!(
        "{:<18}{:>10}{:>9}{:>8} {:>7} {:>6} {:>6} {:>6} {:>6} {:>6}\n{:<18}{:>10}{:>9}{:>8} {:>7} {:>6} {:>6} {:>6} {:>6} {:>6}\n",
        "", "area", "covered", "mean", "", "Ra", "Rq", "Rz", "Sa", "Sq",
        "", "mm²", "%", "µm", "", "µm", "µm", "µm", "µm", "µm"
    ));
    text.push_str(&rows("all", &found.whole));
    for one in found.slopes.iter().filter(|one| one.means.area_mm2 > 0.0) {
        let name = if one.from_deg == 0.0 {
            "level".to_owned()
        } else {
            format!("{}° to {}°", one.from_deg, one.to_deg)
        };
        text.push_str(&rows(&name, &one.means));
    }
    for (number, patch) in (1..).zip(found.patches.iter().take(MOST_SHOWN)) {
        text.push_str(&rows(&format!("patch {number}"), &patch.means));
        text.push_str(&place(patch));
    }
    let more = found.patches.len().saturating_sub(MOST_SHOWN);
    if more > 0 {
        text.push_str(&format!("and {more} more patches: --json lists them\n"));
    }
    if found.small_patches > 0 {
        let (count, area) = (found.small_patches, found.small_area_mm2);
        text.push_str(&format!("patches below 20 mm²: {count}, {area:.1} mm² in all\n"));
    }
    text
}

/// Where a patch lies.
fn place(patch: &OfPatch) -> String {
    let range = |axis: usize| format!("{:.1} to {:.1}", patch.low_mm[axis], patch.high_mm[axis]);
    format!(
        "    x {} y {} z {} mm; slopes by up to {:.1}°, mostly towards {:.0}° from x\n",
        range(0),
        range(1),
        range(2),
        patch.steepest_deg,
        patch.direction_deg
    )
}

/// A row of plain values, and one of filtered ones.
fn rows(name: &str, means: &Means) -> String {
    let signed = means.mean_um.map_or_else(|| "–".to_owned(), |mean| format!("{mean:+.1}"));
    format!(
        "{name:<18}{:>10.1}{:>9.1}{signed:>8} {:>7}{}\n{:<45} {:>7}{}\n",
        means.area_mm2,
        100.0 * means.coverage,
        "plain",
        values(&means.unfiltered),
        "",
        "Gauss",
        values(&means.filtered)
    )
}

fn values(values: &Values) -> String {
    let Values { ra_um, rq_um, rz_um, sa_um, sq_um } = values;
    let one = |value: &Option<f64>| {
        let text = value.map_or_else(|| "–".to_owned(), |value| format!("{value:.1}"));
        format!(" {text:>6}")
    };
    [ra_um, rq_um, rz_um, sa_um, sq_um].map(one).concat()
}

fn cutoff(text: &str) -> std::result::Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| "it must be a number, such as 2.5".to_owned())?;
    if (0.01..=100.0).contains(&value) {
        Ok(value)
    } else {
        Err("it must be 0.01 to 100".to_owned())
    }
}
