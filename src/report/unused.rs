//! Settings + what was printed -> findings: what was asked for and is not in the print, for a reason that is no fault.

use crate::fill::Role;
use crate::gcode::usage::Usage;
use crate::profile::{BrimPlace, IroningPlace, Settings};
use crate::warning::Warning;

/// Keys that changed nothing, each with the reason.
pub(super) fn warnings(usage: &Usage, settings: &Settings) -> Vec<Warning> {
    let mut found = Vec::new();
    let on_raft = on_raft(settings);
    if !on_raft.is_empty() {
        found.push(Warning::void(on_raft, "the part stands on a raft, and not on the bed"));
    }
    let ironed = usage.roles[Role::Ironing].iter().any(|(_, used)| used.length > 0.0);
    if settings.ironing.place != IroningPlace::Off && !ironed {
        found.push(Warning::void(["ironing.where"], "no top is wide enough for its lines"));
    }
    if settings.printed_pattern() != settings.pattern {
        let why = "lines that cross cannot be so dense; they run in one direction on each layer";
        found.push(Warning::void(["pattern"], why));
    }
    found
}

/// Keys of the first layer that a raft makes void.
fn on_raft(settings: &Settings) -> Vec<&'static str> {
    let brim = !matches!(settings.brim.place, BrimPlace::Auto | BrimPlace::Off);
    let keys = [
        ("brim.where", brim),
        ("first_layer_width", settings.first_layer_width.is_some()),
        ("elephant_foot", settings.elephant_foot > 0.0),
    ];
    let void = keys.into_iter().filter(|(_, is_set)| *is_set && settings.raft.enabled);
    void.map(|(key, _)| key).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::profile::{Pattern, Profile};

    #[test]
    fn what_crosses_itself_is_not_printed_densely() {
        let told = |pattern: &str, infill: &str| {
            let given = Profile::builder("generic-marlin").set("pattern", pattern);
            let settings = given.set("infill", infill).load().unwrap().settings;
            let warnings = warnings(&Usage::default(), &settings);
            (warnings.len(), settings.printed_pattern())
        };
        assert_eq!(told("grid", "100"), (1, Pattern::Rectilinear));
        assert_eq!(told("triangles", "95"), (1, Pattern::Rectilinear));
        assert_eq!(told("grid", "60"), (0, Pattern::Grid));
        assert_eq!(told("rectilinear", "100"), (0, Pattern::Rectilinear));
    }
}
