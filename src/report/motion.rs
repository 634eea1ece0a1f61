//! Settings + what is printed -> MotionReport: acceleration and jerk of each kind of move, and what of it has no effect.

use super::{DriveReport, MotionReport};
use crate::fill::Role;
use crate::gcode::dialect::Dialect;
use crate::gcode::drive::{self, Asked};
use crate::gcode::usage::Usage;
use crate::profile::{Acceleration, DialectName, Jerk, JunctionRule, Settings};
use crate::warning::Warning;
use std::f64::consts::SQRT_2;

/// Jerks that are held to others by a smaller part than this differ by rounding alone.
const MUCH: f64 = 0.01;

/// What the file tells the machine of accelerations; none if it tells nothing.
pub(super) fn motion(usage: &Usage, settings: &Settings) -> Option<MotionReport> {
    let accelerates = drive::tells_accelerations(settings) && asks_acceleration(settings);
    let corners = drive::tells_corners(settings) && asks_jerk(settings);
    let dialect = Dialect::new(settings.machine.dialect);
    let advance = settings.filament.pressure_advance;
    let advance = advance.filter(|&s| dialect.advance(s, settings.machine.tool).is_some());
    if !accelerates && !corners && advance.is_none() {
        return None;
    }
    let row = |of: &str, acceleration: Option<f64>, jerk: Option<f64>| DriveReport {
        of: of.to_owned(),
        acceleration_mm_s2: acceleration.filter(|_| accelerates),
        jerk_mm_s: jerk.filter(|_| corners),
    };
    let asked = |of, Asked { acceleration, jerk }| {
        let jerk = jerk.map(|jerk| drive::held_jerk(settings, jerk, acceleration));
        row(of, Some(acceleration), jerk)
    };
    let mut drives = Vec::new();
    if accelerates || corners {
        let used = |role: &Role| usage.roles[*role].iter().any(|(_, used)| used.length > 0.0);
        let first = drive::line(settings, Role::OuterWall, true);
        let acceleration = settings.acceleration.first_layer.map(|_| first.acceleration);
        drives.push(row("first layer", acceleration, settings.jerk.first_layer));
        let roles = Role::ALL.into_iter().filter(used);
        // The base of a raft is all first layer.
        let line = |role: Role| drive::line(settings, role, role == Role::RaftBase);
        drives.extend(roles.map(|role| asked(role.facts().name, line(role))));
        drives.push(asked("travel", drive::travel(settings)));
        drives.retain(|one| one.acceleration_mm_s2.is_some() || one.jerk_mm_s.is_some());
    }
    Some(MotionReport { drives, pressure_advance_s: advance })
}

/// Keys of accelerations, jerks and pressure advance that do not what they say.
#[must_use]
pub fn warnings(settings: &Settings) -> Vec<Warning> {
    own(settings).into_iter().chain(asked(settings)).collect()
}

/// The printer's own acceleration, where it is told another than is timed. Marlin and others keep each
/// axis within its limit; Klipper does as it is told, or as it is set up if the start block says nothing.
fn own(settings: &Settings) -> Vec<Warning> {
    let (machine, limits) = (&settings.machine, &settings.limits);
    let own = machine.acceleration;
    if let Some(told) = told(&machine.start_gcode) {
        let why = format!(
            "machine.start_gcode sets {told} mm/s², while times count {own}; write {{acceleration}} there"
        );
        let differs = told != own;
        return differs
            .then(|| Warning::void(["machine.acceleration"], &why))
            .into_iter()
            .collect();
    }
    let is_told = machine.start_gcode.contains("{acceleration}");
    let is_klipper = limits.junction == JunctionRule::SquareCorner;
    if is_klipper && !is_told && own != limits.acceleration_x {
        let why = "the start block does not tell it ({acceleration}), and the printer goes by \
                   limits.acceleration_x; make them equal";
        return vec![Warning::void(["machine.acceleration"], why)];
    }
    let given_mm_s2 = drive::most(settings);
    // Askew, two axes together do more than each.
    if is_klipper || !is_told || own <= given_mm_s2 * SQRT_2 {
        return Vec::new();
    }
    let setting = "machine.acceleration".to_owned();
    vec![Warning::AccelerationHeld { setting, asked_mm_s2: own, given_mm_s2 }]
}

/// The acceleration that a block sets by a number, mm/s²: M204 S or P, or Klipper's ACCEL.
fn told(block: &str) -> Option<f64> {
    let code = block.lines().filter_map(|line| line.split(';').next());
    let number = |line: &str| {
        let mut words = line.split_whitespace();
        let prefixes: &[&str] = match words.next()?.to_ascii_uppercase().as_str() {
            "M204" => &["S", "P"],
            "SET_VELOCITY_LIMIT" => &["ACCEL="],
            _ => return None,
        };
        words.find_map(|word| {
            let word = word.to_ascii_uppercase();
            prefixes.iter().find_map(|prefix| word.strip_prefix(prefix)?.parse().ok())
        })
    };
    code.filter_map(number).next_back()
}

/// Those of `[acceleration]`, `[jerk]` and of the material.
fn asked(settings: &Settings) -> Vec<Warning> {
    let dialect = settings.machine.dialect;
    let mut accelerations = Vec::new();
    if asks_acceleration(settings) {
        accelerations = drive::asked(settings, "acceleration");
    }
    let jerks = if asks_jerk(settings) { drive::asked(settings, "jerk") } else { Vec::new() };
    let none = |keys: Vec<(String, f64)>, why: &str| {
        let any = !keys.is_empty();
        any.then(|| Warning::void(keys.iter().map(|(key, _)| key.as_str()), why))
    };
    let mut advance = Vec::new();
    if let Some(seconds) = settings.filament.pressure_advance
        && Dialect::new(dialect).advance(seconds, settings.machine.tool).is_none()
    {
        advance.push(("filament.pressure_advance".to_owned(), seconds));
    }
    if dialect == DialectName::Makerbot {
        let all = [accelerations, jerks, advance].concat();
        let why = "GPX and Sailfish have no command for it; set it on the printer";
        return none(all, why).into_iter().collect();
    }
    let most = drive::most(settings);
    let high = accelerations.into_iter().filter(|(_, asked)| *asked > most);
    let held = high.map(|(setting, asked_mm_s2)| Warning::AccelerationHeld {
        setting,
        asked_mm_s2,
        given_mm_s2: most,
    });
    let corners = drive::tells_corners(settings);
    let held = held.chain(if corners { held_jerks(settings, &jerks) } else { Vec::new() });
    let jerks = if corners { Vec::new() } else { jerks };
    let why = "the firmware has no command for the rule of corners that limits.junction names";
    let why_advance = "the Ultimaker 2 has no command for it";
    held.chain(none(jerks, why)).chain(none(advance, why_advance)).collect()
}

/// Those of the keys of jerks that the machine's command has no room for.
fn held_jerks(settings: &Settings, jerks: &[(String, f64)]) -> Vec<Warning> {
    let own = drive::asked(settings, "acceleration");
    let held = jerks.iter().filter_map(|(key, asked)| {
        let beside = key.replace("jerk.", "acceleration.");
        let acceleration = own.iter().find(|(key, _)| *key == beside).map(|(_, value)| *value);
        let acceleration = acceleration.unwrap_or(settings.machine.acceleration);
        let given = drive::held_jerk(settings, *asked, acceleration);
        ((given - asked).abs() > MUCH * asked).then(|| Warning::JerkHeld {
            setting: key.clone(),
            asked_mm_s: *asked,
            given_mm_s: given,
        })
    });
    held.collect()
}

fn asks_acceleration(settings: &Settings) -> bool {
    settings.acceleration != Acceleration::default()
}

fn asks_jerk(settings: &Settings) -> bool {
    settings.jerk != Jerk::default()
}
