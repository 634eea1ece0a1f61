//! `slicer mesh` -> what is wrong with a model, as text or JSON, and the mended mesh as STL.

use super::output::{self, Sink};
use super::{Outcome, failure, interrupt, usage, words};
use anyhow::{Context as _, Result};
use clap::Args;
use serde::Serialize;
use slicer::mesh::faults::{Counted, Fault, place_text};
use slicer::mesh::place::part::part;
use slicer::mesh::{Bed, MeshReport, Placement, inspect, read, write};
use slicer::slice::volume::solid_mm3;
use slicer::warning::plural;
use std::ffi::OsString;
use std::fmt::Display;
use std::path::{Path, PathBuf};

/// Version of the JSON schema; raised when a field changes its meaning or goes away.
const SCHEMA: u32 = 1;

/// Places of each kind of fault in the text; JSON has more.
const MOST_SHOWN: usize = 3;

/// Arguments of `slicer mesh`.
#[derive(Debug, Args)]
#[command(after_help = "Exit codes: 0 the mesh is closed, or could be closed; 1 it cannot be; \
2 wrong arguments;\n3 the file cannot be read or encloses nothing; 4 the output cannot be written.\n\
Places and the mended mesh are in the file's own coordinates.")]
pub(crate) struct MeshArgs {
    /// STL file; `-` reads standard input
    #[arg(value_name = "FILE")]
    file: OsString,
    /// Write the mended mesh here, as binary STL; `-` is standard output
    #[arg(short, long, value_name = "STL")]
    output: Option<PathBuf>,
    /// Print JSON
    #[arg(long)]
    json: bool,
    /// Unit of the model's numbers; sizes and gaps are reported in mm
    #[arg(long, default_value = "mm", value_parser = words::UNITS)]
    unit: String,
    /// Refuse a model with more triangles
    #[arg(long, value_name = "N", default_value_t = read::DEFAULT_MAX_TRIANGLES, value_parser = words::triangles())]
    max_triangles: usize,
}

/// What is reported about a mesh.
#[derive(Debug, Serialize)]
struct Findings<'a> {
    schema: u32,
    slicer: &'static str,
    /// As in the report of slicing.
    #[serde(flatten)]
    report: &'a MeshReport,
    /// The volume that layers through the mended mesh enclose, mm³; overlaps count once.
    solid_mm3: f64,
    /// Faults that are visible in the mended mesh, and that mending leaves.
    seen: &'a [Counted<Fault>],
}

/// Inspects a mesh and mends it.
///
/// # Errors
/// A file that cannot be read, a model that encloses nothing, an output that cannot be written.
pub(super) fn run(args: &MeshArgs) -> Result<Outcome> {
    interrupt::watch();
    if args.json && args.output.as_deref().is_some_and(output::is_stdout) {
        usage::refuse("mesh and JSON cannot both go to standard output; name a file for the mesh")?;
    }
    if let Some(out) = args.output.as_deref()
        && args.file != "-"
        && usage::is_same_file(out, Path::new(&args.file))
    {
        usage::refuse("the output would replace the model; choose another name for it")?;
    }
    let sink =
        args.output.as_deref().map(|out| Sink::open(out).map(|sink| (out, sink))).transpose()?;
    let placement = Placement {
        unit: words::unit(&args.unit),
        max_triangles: args.max_triangles,
        ..Placement::default()
    };
    let mut model = read::from_path(&args.file, args.max_triangles)?;
    let part = part(&mut model, &placement, &Bed::ANY)?;
    let seen = inspect::faults(&part.mesh, &part.adjacency, &model.vertices);
    let findings = Findings {
        schema: SCHEMA,
        slicer: slicer::NAME,
        report: &model.report,
        solid_mm3: solid_mm3(&part.mesh, &part.adjacency),
        seen: &seen,
    };
    let text = if args.json { output::json(&findings, Path::new("-"))? } else { lines(&findings) };
    let code = u8::from(part.adjacency.unpaired > 0);
    if let Some((out, mut sink)) = sink {
        write::write(&mut sink, &model.vertices, &part.mesh.triangles)
            .with_context(|| failure::writing(out))?;
        sink.commit()?;
        if output::is_stdout(out) {
            super::say(&text);
            return Ok(Outcome { text: String::new(), code });
        }
    }
    Ok(Outcome { text, code })
}

/// The report as text.
fn lines(findings: &Findings) -> String {
    let MeshReport { file, format, triangles, shells, size_mm, volume_mm3, .. } = findings.report;
    let [x, y, z] = size_mm;
    let mut text = format!(
        "{file}: {format} STL; mended: {}, {}, {x:.3} x {y:.3} x {z:.3} mm, {volume_mm3:.1} mm³ \
         (solid: {:.1} mm³)\n",
        plural(*triangles as u64, "triangle"),
        plural(*shells as u64, "shell"),
        findings.solid_mm3,
    );
    if findings.report.trailing_bytes > 0 {
        let bytes = plural(findings.report.trailing_bytes, "byte");
        text.push_str(&format!("found: {bytes} after the last triangle\n"));
    }
    text.push_str(&list("found", &findings.report.found));
    text.push_str(&list("mended", &findings.report.mended));
    text.push_str(&list("left", &findings.report.left));
    text.push_str(&list("seen", findings.seen));
    if text.lines().count() == 1 {
        text.push_str("no faults\n");
    }
    text
}

fn list<K>(title: &str, all: &[Counted<K>]) -> String
where
    Counted<K>: Display,
{
    let line = |one: &Counted<K>| {
        let places = one.places.iter().take(MOST_SHOWN).map(|&place| place_text(place));
        let places = places.collect::<Vec<_>>().join("; ");
        let more = if one.count > MOST_SHOWN { "; …" } else { "" };
        let at = if places.is_empty() { String::new() } else { format!(", at {places}{more}") };
        format!("{title}: {one}{at}\n")
    };
    all.iter().map(line).collect()
}
