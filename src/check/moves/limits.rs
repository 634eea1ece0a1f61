//! Limits and long waits that a file tells the machine + Terms -> findings of those that change the print in its middle.
//!
//! Words used here: a value is *asked for* if the file's own settings hold it; *own* files are this program's.
//! Only what is new between the first line and the last is judged: a start block sets the machine up, and what it
//! has set may be set again.
//!
//! | what is new in the print | asked for | else | beyond the machine | so low that it crawls |
//! |---|---|---|---|---|
//! | highest speeds and accelerations of axes (M201, M203) | fine | warning | error | error |
//! | accelerations and jerks, which slicers set by role (M204, M205, M566) | fine | own files: warning | own files: error; others: from [`FAR`] times on | error |
//! | a wait of 20 s and more (G4) | – | warning | – | – |
//!
//! Klipper's SET_VELOCITY_LIMIT has words of both kinds. Firmwares cap what they are asked for, but not what they
//! are told: beyond the machine's limits motors lose steps. A wait is a pause that people ask for, as M0 is.

use crate::check::asked::SAME;
use crate::check::finding::{Code, Finding, Findings, Place, short};
use crate::check::terms::{Machine, Terms};
use crate::reader::{Facts, Limit, LongWait, Told};
use std::ops::Range;

/// How far beyond the machine a role's value may be in files of others, whose settings nobody can read whole: some
/// write 5000 mm/s² for a machine of 1000, whose firmware holds itself to its own.
const FAR: f64 = 20.0;

/// Slower than this no print is meant to go, mm/s and mm/s².
const LEAST_SPEED: f64 = 2.0;
const LEAST_ACCELERATION: f64 = 20.0;

/// Judges all limits and waits of a file. `printing` is its moves from the first line of a layer to the last line.
pub(crate) fn judge(
    (facts, terms): (&Facts, &Terms),
    printing: &Range<usize>,
    found: &mut Findings,
) {
    let is_new = |at: usize| at > printing.start && at < printing.end;
    let place = |line: u64, at: usize| {
        let layer = facts.layers.partition_point(|layer| layer.moves.start < at);
        Place {
            line: Some(line),
            layer: Some(layer).filter(|layer| *layer > 0),
            ..Place::default()
        }
    };
    let mut before: Option<Told> = None;
    for told in facts.limits.iter().filter(|told| is_new(told.at)) {
        // M204 S sets the travels as well, and VELOCITY both axes: one finding.
        let is_again = |one: Told| one.line == told.line && one.value == told.value;
        if before.replace(*told).is_some_and(is_again) || terms.asked.has(told) {
            continue;
        }
        found.extend(blame(told, terms).map(|one| one.at(place(told.line, told.at))));
    }
    for &LongWait { seconds, line, at } in facts.waits.iter().filter(|wait| is_new(wait.at)) {
        let text = format!("the nozzle stands still for {} s in the print", short(seconds));
        let finding = Finding::warning(Code::ChangesTheMachine, seconds, "s", text);
        found.add(finding.at(place(line, at)));
    }
}

fn blame(told: &Told, terms: &Terms) -> Option<Finding> {
    let Told { limit, value, .. } = *told;
    let by_role = !matches!(limit, Limit::Speed(_) | Limit::Acceleration(_));
    let most = terms.machine.as_ref().and_then(|machine| most(limit, machine));
    let slack = if by_role && !terms.is_own { FAR } else { 1.0 + SAME };
    let unit = limit.unit();
    let text = |what: &str| {
        let number = format!("{} {unit}", short(value));
        format!("the {} is set to {} in the print{what}", limit.name(), number.trim_end())
    };
    let error = |what: &str| Some(Finding::of(Code::ChangesTheMachine, value, unit, text(what)));
    match most {
        _ if value < least(limit) => error(": it crawls"),
        Some(most) if value > slack * most => {
            error(&format!(", where the machine does {}", short(most)))
        }
        _ if by_role && !terms.is_own => None,
        _ => {
            let text = text(", which the file's settings do not ask for");
            Some(Finding::warning(Code::ChangesTheMachine, value, unit, text))
        }
    }
}

/// The least that a print is meant to have.
fn least(limit: Limit) -> f64 {
    match limit {
        Limit::Speed(0 | 1) => LEAST_SPEED,
        Limit::Acceleration(0 | 1) | Limit::Lines | Limit::Travels => LEAST_ACCELERATION,
        _ => 0.0,
    }
}

/// The most that a machine does, if that is known.
fn most(limit: Limit, machine: &Machine) -> Option<f64> {
    let of = |values: [f64; 4], axis: usize| values.get(axis).copied();
    let [x, y, _, filament] = machine.acceleration;
    match limit {
        Limit::Speed(axis) => of(machine.speed, axis),
        Limit::Acceleration(axis) => of(machine.acceleration, axis),
        Limit::Jerk(axis) => of(machine.jerk, axis),
        Limit::Lines | Limit::Travels | Limit::Sprints => Some(x.max(y)),
        Limit::Filament => Some(filament),
        Limit::Deviation | Limit::Corner | Limit::Cruise => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::profile::{Profile, Settings};
    use crate::reader::Print;

    /// A usual printer with these settings.
    fn generic(keys: &[(&str, f64)]) -> Settings {
        let builder = Profile::builder("generic-marlin");
        keys.iter()
            .fold(builder, |builder, (key, value)| builder.set(*key, value))
            .load()
            .unwrap()
            .settings
    }

    /// What is found if a line stands between two layers of a small print.
    fn found(head: &str, between: &str, own: Option<&Settings>) -> Vec<(bool, String)> {
        let text = format!(
            "; generated by hand\n{head}\nM204 S1500\nM203 X70\n;LAYER_CHANGE\nG1 Z0.2\nG1 X9 E1\n{between}\n\
             ;LAYER_CHANGE\nG1 Z0.4\nG1 X0 E2\nM204 S7\nG4 S90\n"
        );
        let print = Print::read(&mut text.as_bytes(), 1.75).unwrap();
        let machine = generic(&[]);
        let terms = Terms::new(Some(&machine), own, &print);
        let mut all = Findings::default();
        judge((&print, &terms), &(print.start.end + 1..print.last_line), &mut all);
        let is_error = |one: &Finding| one.severity == crate::check::finding::Severity::Error;
        all.into_iter().map(|one| (is_error(&one), one.to_string())).collect()
    }

    #[test]
    fn what_settings_ask_for_is_fine_and_all_else_is_named() {
        let own = generic(&[("acceleration.wall", 700.0), ("jerk.wall", 5.0)]);
        let most = own.limits.acceleration_x;
        for line in ["M204 S700", "M204 P1500", "M205 X5 Y5", "M203 X70", "G4 S5", "M900 K0.1"] {
            assert_eq!(found("", line, Some(&own)), [], "{line}");
        }
        for (line, is_error) in [
            ("M204 S650".to_owned(), false),
            ("M203 X40".to_owned(), false),
            ("M201 Y130".to_owned(), false),
            (format!("M201 X{}", 2.0 * most), true),
            (format!("M204 S{}", 2.0 * most), true),
            ("M203 X1".to_owned(), true),
            ("M204 S5".to_owned(), true),
            ("M205 X900".to_owned(), true),
            ("SET_VELOCITY_LIMIT ACCEL=321".to_owned(), false),
            ("G4 S3600".to_owned(), false),
        ] {
            let all = found("", &line, Some(&own));
            assert!(all.len() == 1 && all[0].0 == is_error, "{line}: {all:?}");
            assert!(all[0].1.contains("changes-the-machine: line 8, layer 1: "), "{all:?}");
        }
    }

    #[test]
    fn other_slicers_set_accelerations_by_role() {
        for line in ["M204 S650", "M204 P700 T900", "M205 X9 Y9", "SET_VELOCITY_LIMIT ACCEL=650"] {
            assert_eq!(found("", line, None), [], "{line}");
        }
        assert_eq!(found("; machine_max_feedrate_x = 55,60", "M203 X55", None), []);
        for line in ["M203 X55", "M204 S900000", "M204 S1", "M205 X400"] {
            assert_eq!(found("", line, None).len(), 1, "{line}");
        }
    }
}
