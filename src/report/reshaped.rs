//! Sums -> what the report says of arcs and of short lines, and what it warns of.

use super::{ArcsReport, SegmentsReport};
use crate::gcode::Sums;
use crate::gcode::reshaped::{Arced, Short};
use crate::gcode::usage::Usage;
use crate::profile::{DialectName, Settings};
use crate::warning::Warning;

/// Time lost on short lines that is worth a warning, as a part of the print's: less is not seen.
const MUCH: f64 = 0.01;

/// Findings about both.
pub(super) fn warnings(sums: &Sums, settings: &Settings) -> impl Iterator<Item = Warning> {
    arcs_unknown(settings).into_iter().chain(short_lines(sums, settings))
}

/// Arcs are asked for, but the firmware does not know them.
fn arcs_unknown(settings: &Settings) -> Option<Warning> {
    let machine = &settings.machine;
    let why = match machine.dialect {
        DialectName::Makerbot => "GPX knows no arcs",
        DialectName::Ultigcode => "an Ultimaker 2 draws arcs badly",
        _ => {
            let unknown = settings.arcs && !machine.arcs;
            return unknown.then(|| Warning::ArcsUnknown { machine: machine.name.clone() });
        }
    };
    settings.arcs.then(|| Warning::void(["arcs"], why))
}

/// What arcs stand for.
pub(super) fn arcs(usage: &Usage, settings: &Settings) -> Option<ArcsReport> {
    let Arced { arcs: count, lines } = usage.arced;
    settings.arcs.then_some(ArcsReport { count, lines })
}

/// What became of short lines.
pub(super) fn segments(usage: &Usage, settings: &Settings) -> Option<SegmentsReport> {
    let max_rate_per_s = settings.limits.max_segment_rate;
    let Short { joined, slowed, lost } = usage.short;
    (max_rate_per_s > 0.0).then_some(SegmentsReport {
        max_rate_per_s,
        joined,
        slowed,
        lost_s: lost,
    })
}

/// Short lines are slowed down so much that the print takes longer by more than [`MUCH`].
fn short_lines(Sums { usage, times, .. }: &Sums, settings: &Settings) -> Option<Warning> {
    let Short { slowed, lost, .. } = usage.short;
    (lost > MUCH * times.total()).then_some(Warning::ShortLinesSlowed {
        lines: slowed,
        lost_s: lost,
        limit_per_s: settings.limits.max_segment_rate,
    })
}
