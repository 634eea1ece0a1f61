//! Settings -> Drives: acceleration and jerk of each kind of move, for the text and for the clock.
//!
//! - A *drive* is how hard the machine may speed up on one kind of move (acceleration, mm/s²), and how
//!   fast it may take its corners (jerk; what stands for it on this machine).
//! - What it is *told* stays in force until it is told something else. So text and clock follow the
//!   moves of a layer from what is in force before it, and tell only what changes.
//! - Its *own* values are those of `[machine]` and `[limits]`. It gets them back at the print's end.
//!
//! Rules:
//! - Lines have the drive of their role, or that of the first layer. Travels and moves in z have that
//!   of travels. Moves of the filament alone, and pauses, leave what is in force.
//! - Marlin and RepRapFirmware keep one acceleration for lines and another for travels (M204 P and T).
//!   Klipper, and Marlin before 1.0.2 (M204 S), have one for both: it is told around travels where they
//!   differ. That Marlin takes T for the filament's alone, so that T is never written for it.
//! - Marlin's junction deviation is told instead of a jerk, by Marlin's own formula.
//! - Sailfish, through GPX, can be told nothing.

use super::moves::{Kind, Moves};
use crate::fill::{Role, RoleTable};
use crate::motion::{Junction, Limits, Rates};
use crate::profile::{Acceleration, DialectName, Jerk, JunctionRule, Settings, values};
use std::fmt::Write as _;

/// Marlin's formula: junction deviation, mm, is this times jerk² over acceleration.
const DEVIATION_FACTOR: f64 = 0.4;

/// The least and most junction deviation that Marlin's M205 takes, mm.
const DEVIATIONS: [f64; 2] = [0.01, 0.3];

/// How the machine keeps accelerations.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Way {
    /// One for lines and one for travels.
    Apart,
    /// One for both.
    One,
    /// It cannot be told.
    Never,
}

/// What the machine is told; none where that stays as it is.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Told {
    /// Acceleration of lines, or of all moves, mm/s².
    print: Option<f64>,
    /// Acceleration of travels where it is kept apart, mm/s².
    travel: Option<f64>,
    /// Jerk in x and y or square corner velocity, mm/s; junction deviation, mm.
    corner: Option<[f64; 2]>,
}

impl Told {
    /// With what `other` says of the rest.
    fn or(self, other: Self) -> Self {
        Self {
            print: self.print.or(other.print),
            travel: self.travel.or(other.travel),
            corner: self.corner.or(other.corner),
        }
    }

    /// Of this, what is not in force `before`.
    fn news(self, before: Self) -> Self {
        Self {
            print: self.print.filter(|_| self.print != before.print),
            travel: self.travel.filter(|_| self.travel != before.travel),
            corner: self.corner.filter(|_| self.corner != before.corner),
        }
    }
}

/// How one kind of move is driven.
#[derive(Debug, Clone)]
pub struct Drive {
    /// What the machine is told for it.
    told: Told,
    /// What its planner holds itself to then.
    pub rates: Rates,
}

/// How all moves of a print are driven.
#[derive(Debug, Clone)]
pub struct Drives {
    all: Vec<Drive>,
    /// The place of each role's drive, on the first layer and on the others.
    lines: [RoleTable<usize>; 2],
    /// The part's first layer on a raft; 0 without one.
    of_part: usize,
    /// The place of that of travels.
    travel: usize,
    own: Told,
    dialect: DialectName,
    rule: JunctionRule,
}

impl Drives {
    /// None where the settings ask for nothing that the machine can be told.
    #[must_use]
    pub fn new(settings: &Settings) -> Option<Self> {
        let maker = Maker::new(settings);
        if !maker.accelerates && !maker.corners {
            return None;
        }
        let mut all: Vec<Drive> = Vec::new();
        let mut place = |drive: Drive| {
            let found = all.iter().position(|one| one.told == drive.told);
            found.unwrap_or_else(|| {
                all.push(drive);
                all.len() - 1
            })
        };
        let travel = place(maker.travel());
        let lines =
            [true, false].map(|first| RoleTable::new(|role| place(maker.line(role, first))));
        let (own, rule) = (maker.own(), settings.limits.junction);
        let (of_part, dialect) = (settings.raft_layers(), settings.machine.dialect);
        Some(Self { all, lines, of_part, travel, own, dialect, rule })
    }

    /// The number of the drive that a move of this layer asks for; none if it leaves what is in force.
    #[must_use]
    pub fn of(&self, layer: usize, kind: &Kind) -> Option<usize> {
        match kind {
            Kind::Extrude(bead) => {
                let first = layer == 0 || layer == self.of_part;
                Some(self.lines[usize::from(!first)][bead.role])
            }
            Kind::Travel | Kind::Z => Some(self.travel),
            Kind::Retract | Kind::Restore | Kind::Wait(_) => None,
        }
    }

    /// The drive of this number.
    #[must_use]
    pub fn get(&self, number: usize) -> Option<&Drive> {
        self.all.get(number)
    }

    /// What is in force after a layer, if this is `before` it.
    #[must_use]
    pub fn after(&self, layer: &Moves, before: Told) -> Told {
        let mut told = Told::default();
        for step in layer.moves.iter().rev() {
            let drive = self.of(layer.layer, &step.kind).and_then(|number| self.get(number));
            told = drive.map_or(told, |drive| told.or(drive.told));
            // All that can be told.
            if told.or(self.own) == told {
                return told;
            }
        }
        told.or(before)
    }

    /// The lines that give the machine its own values back, if this is in force.
    #[must_use]
    pub fn restore(&self, now: Told) -> String {
        self.words(self.own.news(now))
    }

    /// The commands that tell the machine `news`, a line each.
    fn words(&self, news: Told) -> String {
        let mut words = String::new();
        let mut say = |head: &str, parts: &[(&str, Option<f64>)]| {
            let parts = parts.iter().filter_map(|(name, value)| Some((name, (*value)?)));
            let parts: String = parts.map(|(name, value)| format!(" {name}{value}")).collect();
            if !parts.is_empty() {
                // Writing to a text cannot fail.
                let _ = writeln!(words, "{head}{parts}");
            }
        };
        let [x, y] = [0, 1].map(|axis| news.corner.map(|corner| corner[axis]));
        let old = self.rule == JunctionRule::VectorJerk;
        match self.dialect {
            DialectName::Makerbot => {}
            DialectName::Klipper => {
                say("SET_VELOCITY_LIMIT", &[("ACCEL=", news.print), ("SQUARE_CORNER_VELOCITY=", x)])
            }
            DialectName::Reprapfirmware => {
                say("M204", &[("P", news.print), ("T", news.travel)]);
                let per_minute = |jerk: Option<f64>| jerk.map(|jerk| rounded(60.0 * jerk));
                say("M566", &[("X", per_minute(x)), ("Y", per_minute(y))]);
            }
            DialectName::Marlin if !old => {
                say("M204", &[("P", news.print), ("T", news.travel)]);
                if self.rule == JunctionRule::Deviation {
                    say("M205", &[("J", x)]);
                } else {
                    say("M205", &[("X", x), ("Y", y)]);
                }
            }
            DialectName::Marlin | DialectName::Ultigcode => {
                say("M204", &[("S", news.print)]);
                say("M205", &[("X", x)]);
            }
        }
        words
    }
}

/// What the machine is told while the moves of a layer go by.
#[derive(Debug)]
pub(super) struct Driving<'a> {
    drives: Option<&'a Drives>,
    layer: usize,
    /// What is in force.
    told: Told,
    /// The drive of the last move that asked for one.
    number: Option<usize>,
}

impl<'a> Driving<'a> {
    /// At the beginning of a layer, before which `told` is in force.
    pub(super) fn new(drives: Option<&'a Drives>, layer: usize, told: Told) -> Self {
        Self { drives, layer, told, number: None }
    }

    /// The lines that must stand before a move of this kind, if any.
    pub(super) fn words(&mut self, kind: &Kind) -> Option<String> {
        let drives = self.drives?;
        let number = drives.of(self.layer, kind).filter(|&number| self.number != Some(number))?;
        self.number = Some(number);
        let wanted = drives.get(number)?.told;
        let news = wanted.news(self.told);
        self.told = wanted.or(self.told);
        (news != Told::default()).then(|| drives.words(news))
    }
}

/// Makes drives.
struct Maker<'a> {
    settings: &'a Settings,
    way: Way,
    /// Whether accelerations are told, and corners.
    accelerates: bool,
    corners: bool,
}

/// The junction deviation that stands for a jerk at this acceleration, as far as Marlin takes it, mm.
fn deviation(jerk: f64, acceleration: f64) -> f64 {
    let [least, most] = DEVIATIONS;
    (DEVIATION_FACTOR * jerk * jerk / acceleration).clamp(least, most)
}

/// The jerk that the machine really has where this one is asked for, mm/s: no command has room for any.
#[must_use]
pub fn held_jerk(settings: &Settings, jerk: f64, acceleration: f64) -> f64 {
    match settings.limits.junction {
        JunctionRule::Deviation => {
            let held = (deviation(jerk, acceleration) * acceleration / DEVIATION_FACTOR).sqrt();
            (held * 100.0).round() / 100.0
        }
        _ => jerk,
    }
}

impl<'a> Maker<'a> {
    fn new(settings: &'a Settings) -> Self {
        let (way, corners) = (way(settings), tells_corners(settings));
        Self {
            settings,
            way,
            accelerates: way != Way::Never && settings.acceleration != Acceleration::default(),
            corners: corners && settings.jerk != Jerk::default(),
        }
    }

    fn line(&self, role: Role, first: bool) -> Drive {
        let line = line(self.settings, role, first);
        self.drive(line.acceleration, line.jerk, false)
    }

    fn travel(&self) -> Drive {
        let travel = travel(self.settings);
        self.drive(travel.acceleration, travel.jerk, true)
    }

    fn drive(&self, acceleration: f64, jerk: Option<f64>, travels: bool) -> Drive {
        let settings = self.settings;
        let told = Told {
            print: (self.accelerates && !(travels && self.way == Way::Apart))
                .then_some(acceleration),
            travel: (self.accelerates && self.way == Way::Apart)
                .then(|| self::travel(settings).acceleration),
            corner: self.corners.then(|| self.corner(acceleration, jerk)),
        };
        let mut limits = Limits::new(settings);
        if self.accelerates {
            limits.print_acceleration = acceleration;
            limits.travel_acceleration = told.travel.unwrap_or(acceleration);
        }
        if let Some(corner) = told.corner {
            set_corner(&mut limits.junction, corner);
        }
        Drive { told, rates: Rates::new(limits) }
    }

    /// What stands for this jerk on the machine; its own without one.
    fn corner(&self, acceleration: f64, jerk: Option<f64>) -> [f64; 2] {
        let limits = &self.settings.limits;
        let [x, y] = [limits.jerk_x, limits.jerk_y];
        let corner = match (limits.junction, jerk) {
            (JunctionRule::Deviation, Some(jerk)) => {
                [(deviation(jerk, acceleration) * 1e4).round() / 1e4; 2]
            }
            (_, Some(jerk)) => [jerk; 2],
            (JunctionRule::Deviation, None) => [limits.junction_deviation; 2],
            (JunctionRule::SquareCorner, None) => [limits.square_corner_velocity; 2],
            (JunctionRule::VectorJerk, None) => [x; 2],
            (JunctionRule::Jerk | JunctionRule::SpeedChange, None) => [x, y],
        };
        if limits.junction == JunctionRule::Deviation { corner } else { corner.map(rounded) }
    }

    fn own(&self) -> Told {
        let (machine, limits) = (&self.settings.machine, &self.settings.limits);
        let acceleration = rounded(machine.acceleration);
        let apart = self.accelerates && self.way == Way::Apart;
        Told {
            print: self.accelerates.then_some(acceleration),
            travel: apart.then(|| rounded(limits.travel_acceleration)),
            corner: self.corners.then(|| self.corner(acceleration, None)),
        }
    }
}

/// Acceleration and jerk of one kind of move, as asked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Asked {
    /// mm/s², the machine's own where nothing else is asked for.
    pub acceleration: f64,
    /// mm/s; none where it is the machine's own.
    pub jerk: Option<f64>,
}

/// Acceleration and jerk of a role, on the first layer or above it.
#[must_use]
pub fn line(settings: &Settings, role: Role, first: bool) -> Asked {
    let (accelerations, jerks) = (&settings.acceleration, &settings.jerk);
    let facts = role.facts();
    let acceleration = accelerations.first_layer.filter(|_| first);
    let acceleration = acceleration.or_else(|| (facts.acceleration)(accelerations));
    Asked {
        acceleration: held(settings, acceleration, settings.machine.acceleration),
        jerk: jerks.first_layer.filter(|_| first).or_else(|| (facts.jerk)(jerks)),
    }
}

/// Acceleration and jerk of travels.
#[must_use]
pub fn travel(settings: &Settings) -> Asked {
    let own = settings.limits.travel_acceleration;
    Asked {
        acceleration: held(settings, settings.acceleration.travel, own),
        jerk: settings.jerk.travel,
    }
}

/// The most acceleration that may be asked for, mm/s²: what both x and y bear.
#[must_use]
pub fn most(settings: &Settings) -> f64 {
    settings.limits.acceleration_x.min(settings.limits.acceleration_y)
}

fn held(settings: &Settings, asked: Option<f64>, own: f64) -> f64 {
    rounded(asked.map_or(own, |asked| asked.min(most(settings))))
}

/// The keys of a table of accelerations or jerks that are set, with their values.
#[must_use]
pub fn asked(settings: &Settings, table: &str) -> Vec<(String, f64)> {
    let inside = |key: &str| key.strip_prefix(table).is_some_and(|rest| rest.starts_with('.'));
    let set = values(settings).into_iter().filter(|(key, _)| inside(key));
    set.filter_map(|(key, value)| Some((key, value.parse().ok()?))).collect()
}

/// Whether the machine can be told accelerations.
#[must_use]
pub fn tells_accelerations(settings: &Settings) -> bool {
    way(settings) != Way::Never
}

/// Whether the machine can be told how to take corners: by a command of its own for its rule.
#[must_use]
pub fn tells_corners(settings: &Settings) -> bool {
    let rule = settings.limits.junction;
    match settings.machine.dialect {
        DialectName::Makerbot => false,
        DialectName::Klipper => rule == JunctionRule::SquareCorner,
        DialectName::Marlin => rule != JunctionRule::SquareCorner,
        DialectName::Reprapfirmware | DialectName::Ultigcode => {
            !matches!(rule, JunctionRule::SquareCorner | JunctionRule::Deviation)
        }
    }
}

fn way(settings: &Settings) -> Way {
    match settings.machine.dialect {
        DialectName::Makerbot => Way::Never,
        DialectName::Klipper | DialectName::Ultigcode => Way::One,
        DialectName::Marlin if settings.limits.junction == JunctionRule::VectorJerk => Way::One,
        DialectName::Marlin | DialectName::Reprapfirmware => Way::Apart,
    }
}

fn set_corner(junction: &mut Junction, [x, y]: [f64; 2]) {
    match junction {
        Junction::Jerk(jerk) | Junction::VectorJerk(jerk) | Junction::SpeedChange(jerk) => {
            (jerk[0], jerk[1]) = (x, y);
        }
        Junction::Deviation(deviation) => *deviation = x,
        Junction::SquareCorner { velocity, .. } => *velocity = x,
    }
}

/// In thousandths, as it is written.
fn rounded(value: f64) -> f64 {
    (value * 1000.0).round() / 1000.0
}
