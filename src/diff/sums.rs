//! Moves -> Measure: how many, how long, how much filament, by role, and the box around the lines.

use crate::reader::Role;
use crate::reader::print::Step;
use schemars::JsonSchema;
use serde::Serialize;

/// Number of roles.
pub(super) const ROLES: usize = Role::ALL.len();

/// The same thing in both files.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, JsonSchema)]
pub struct Both<T> {
    /// In the first file.
    pub a: T,
    /// In the second file.
    pub b: T,
}

/// A sum in both files.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct Sum {
    /// In the first file.
    pub a: f64,
    /// In the second file.
    pub b: f64,
    /// Whether they are the same as far as the tolerances go.
    pub equal: bool,
}

/// A box around lines, mm.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct Extent {
    /// Lowest x, y and z of the nozzle.
    pub min: [f64; 3],
    /// Highest x, y and z of the nozzle.
    pub max: [f64; 3],
}

/// Box, length and middle of lines, mm.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Shape {
    /// Around them; `None` without lines.
    pub(super) extent: Option<Extent>,
    /// Seen from above.
    pub(super) length: f64,
    /// Sum of the middles of lines times their lengths.
    moment: [f64; 2],
}

/// What moves of one role add up to.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Tally {
    pub(super) moves: u64,
    /// mm.
    pub(super) length: f64,
    /// mm.
    pub(super) filament: f64,
    /// Time at the feeds that are asked for, s.
    pub(super) asked: f64,
}

/// What moves add up to.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Measure {
    /// By role.
    pub(super) roles: [Tally; ROLES],
    /// Around all lines; `None` without lines.
    pub(super) extent: Option<Extent>,
}

impl Sum {
    /// The two are the same if they differ by no more than `share` of the larger one and `least`.
    pub(super) fn new(a: f64, b: f64, share: f64, least: f64) -> Self {
        Self { a, b, equal: (a - b).abs() <= share * a.abs().max(b.abs()) + least }
    }

    /// The difference over the larger of both.
    pub(super) fn share(&self) -> f64 {
        let most = self.a.abs().max(self.b.abs());
        if most > 0.0 { (self.a - self.b).abs() / most } else { 0.0 }
    }
}

impl<T> Both<T> {
    pub(super) fn map<U>(self, to: impl Fn(T) -> U) -> Both<U> {
        Both { a: to(self.a), b: to(self.b) }
    }

    pub(super) fn as_ref(&self) -> Both<&T> {
        Both { a: &self.a, b: &self.b }
    }
}

/// The role that is compared: all that extrudes is one if roles are not compared.
pub(super) fn role(role: Role, by_role: bool) -> Role {
    if by_role || matches!(role, Role::Travel | Role::Retraction) { role } else { Role::Other }
}

impl Shape {
    pub(super) fn add(&mut self, step: &Step) {
        let (own, length) = (Extent::of(step), step.plan_length());
        self.extent = joined(self.extent, Some(own));
        self.length += length;
        for (axis, moment) in self.moment.iter_mut().enumerate() {
            *moment += 0.5 * (f64::from(step.from[axis]) + f64::from(step.to[axis])) * length;
        }
    }

    /// The middle in x and y: that of each line counts by its length.
    pub(super) fn middle(&self) -> [f64; 2] {
        self.moment.map(|moment| moment / self.length.max(f64::MIN_POSITIVE))
    }
}

impl Extent {
    /// The box around a line.
    fn of(step: &Step) -> Self {
        let [from, to] = [step.from, step.to].map(|place| place.map(f64::from));
        Self {
            min: std::array::from_fn(|axis| from[axis].min(to[axis])),
            max: std::array::from_fn(|axis| from[axis].max(to[axis])),
        }
    }
}

impl Measure {
    /// Sums up these moves, by role if both files give roles.
    pub(super) fn new(steps: &[Step], by_role: bool) -> Self {
        let mut measure = Self::default();
        for step in steps {
            let tally = &mut measure.roles[role(step.role, by_role) as usize];
            tally.moves += 1;
            tally.length += step.length();
            tally.filament += f64::from(step.filament);
            if step.feed > 0.0 {
                tally.asked += step.length() / f64::from(step.feed);
            }
            if step.is_line() {
                measure.extent = joined(measure.extent, Some(Extent::of(step)));
            }
        }
        measure
    }

    /// Both together.
    pub(super) fn and(mut self, other: &Self) -> Self {
        for (sum, more) in self.roles.iter_mut().zip(&other.roles) {
            sum.moves += more.moves;
            sum.length += more.length;
            sum.filament += more.filament;
            sum.asked += more.asked;
        }
        self.extent = joined(self.extent, other.extent);
        self
    }
}

fn joined(a: Option<Extent>, b: Option<Extent>) -> Option<Extent> {
    let (Some(one), Some(other)) = (a, b) else { return a.or(b) };
    Some(Extent {
        min: std::array::from_fn(|axis| one.min[axis].min(other.min[axis])),
        max: std::array::from_fn(|axis| one.max[axis].max(other.max[axis])),
    })
}
