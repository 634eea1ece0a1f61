//! Job + ways to print it -> Comparison: what each way of dual injection saves on one model.

use crate::error::Result;
use crate::job::Job;
use crate::progress::Progress;
use crate::report::Report;
use serde::Serialize;

/// Version of the JSON schema; raised when a field changes its meaning or goes away.
pub const SCHEMA: u32 = 1;

/// The prints of one job, one for each way.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Comparison {
    /// [`SCHEMA`].
    pub schema: u32,
    /// Name and version of this program.
    pub slicer: String,
    /// Profile asked for, by name or file.
    pub profile: String,
    /// Each way; the first one is what the others are compared with.
    pub ways: Vec<Way>,
}

/// Time and material of one way to print.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Way {
    /// The flags that give it.
    pub flags: String,
    /// Layers printed at once; 1 without dual injection.
    pub ratio: u32,
    /// Print time, seconds.
    pub time_s: f64,
    /// Part of the first way's time that is saved, %.
    pub saved_percent: f64,
    /// Filament, mm.
    pub filament_mm: f64,
    /// The longest layer, seconds.
    pub longest_layer_s: f64,
    /// The shortest layer, seconds.
    pub shortest_layer_s: f64,
    /// Standard deviation of the layers' times over their mean.
    pub layer_spread: f64,
    /// Largest flow of filament, mm³/s.
    pub largest_flow_mm3_s: f64,
}

/// Slices each of `jobs`, which stand under the flags that give them, and compares them
/// with the first.
///
/// # Errors
/// The first that slicing one of them meets.
pub fn compare(jobs: &[(String, Job)]) -> Result<Comparison> {
    let mut ways: Vec<Way> = Vec::with_capacity(jobs.len());
    for (flags, job) in jobs {
        let report = crate::slice(job, &mut std::io::empty(), &Progress::default())?;
        let first = ways.first().map_or(report.time.total_s, |way| way.time_s);
        ways.push(way(flags, &report, first));
    }
    Ok(Comparison {
        schema: SCHEMA,
        slicer: crate::NAME.to_owned(),
        profile: jobs.first().map(|(_, job)| job.sources.to_string()).unwrap_or_default(),
        ways,
    })
}

fn way(flags: &str, report: &Report, first_s: f64) -> Way {
    let time = &report.time;
    Way {
        flags: flags.to_owned(),
        ratio: report.dual.as_ref().map_or(1, |dual| dual.ratio),
        time_s: time.total_s,
        saved_percent: 100.0 * (1.0 - time.total_s / first_s),
        filament_mm: report.filament.length_mm,
        longest_layer_s: time.longest_layer_s,
        shortest_layer_s: time.shortest_layer_s,
        layer_spread: time.layer_spread,
        largest_flow_mm3_s: report.flow.largest_mm3_s,
    }
}
