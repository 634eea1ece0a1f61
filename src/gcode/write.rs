//! Moves -> text: formats the G-code of one layer, independent of all other layers.
//!
//! - *Annotations* are comments that viewers read: `;LAYER_CHANGE`, `;TYPE:`, `;WIDTH:`, `;HEIGHT:`.
//! - A *cut* is a byte of the text where a progress line may be inserted.
//! - A word of G-code stays in force until it is written again. So X, Y, Z and F are written only
//!   where they change, and so are accelerations ([`super::drive`]).
//!
//! Rules:
//! - Each layer starts from its own position and from the filament used before it. No text depends on
//!   another, so that all threads can format layers at once.
//! - E is a rounded sum, or the difference of two rounded sums, so that rounding errors never add up.
//! - A move that changes no coordinate is not written. Its filament goes with the next one.
//! - Annotations come before the first move that they describe.

use super::dialect::Dialect;
use super::drive::{Drives, Driving, Told};
use super::fan::{Fan, FanParams};
use super::moves::{Bead, Kind, Move, MoveParams, Moves};
use super::number::{push_fixed, thousandths};
use super::reshaped::{ArcRun, PatchRun};
use crate::fill::Role;
use crate::profile::Settings;
use crate::units::{Coord, Thousandths, nearest, to_mm};
use std::io::Write as _;
use std::ops::Range;

/// The smallest change of width that is annotated, grid units: 0.01 mm. A trade-off: a smaller value
/// makes the file longer, a larger one makes viewers and `check` work with wrong widths.
/// The moves do not depend on it.
const LEAST_WIDTH_CHANGE: Coord = 100;

/// The smallest change of height and width that is annotated on a slope, grid units: 0.02 mm. There both
/// change from line to line.
const LEAST_CHANGE_ON_SLOPES: Coord = 200;

/// A layer's text.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct LayerText {
    /// The text without progress lines.
    pub text: Vec<u8>,
    /// Where progress lines may be inserted, bytes: at the layer's beginning, then before the
    /// approach of each path and [within](Moves::within) it.
    pub cuts: Vec<usize>,
}

/// The settings that formatting needs.
#[derive(Debug, Clone)]
pub struct WriteParams {
    dialect: Dialect,
    relative_e: bool,
    fan: FanParams,
    drives: Option<Drives>,
    /// What E counts for each mm of filament.
    e_per_mm: f64,
    tool: u32,
    /// The commands for temperatures that the second layer has and the first has not.
    after_first: Vec<String>,
}

/// What is in force when a layer begins.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Before {
    /// Filament used so far, mm.
    pub e: f64,
    /// The fan, and what it is on the layer.
    pub fan: Fan,
    /// Accelerations and jerk.
    pub told: Told,
}

impl WriteParams {
    /// Takes what formatting needs from `settings`.
    #[must_use]
    pub fn new(settings: &Settings) -> Self {
        let dialect = Dialect::new(settings.machine.dialect);
        Self {
            dialect,
            relative_e: settings.machine.relative_e,
            e_per_mm: dialect.e_per_mm(settings.filament_area()),
            fan: FanParams::new(settings),
            drives: Drives::new(settings),
            tool: settings.machine.tool,
            after_first: after_first(settings),
        }
    }

    /// The fan on a layer, when `before` is that on the layer before.
    #[must_use]
    pub fn fan(&self, layer: &Moves, before: Fan) -> Fan {
        Fan { before: before.usual, usual: self.fan.usual(layer.layer, layer.group_seconds) }
    }

    /// Accelerations and jerk after a layer, when those are `before` it.
    #[must_use]
    pub fn told(&self, layer: &Moves, before: Told) -> Told {
        self.drives.as_ref().map_or(before, |drives| drives.after(layer, before))
    }

    /// The text of one layer.
    #[must_use]
    pub fn layer(&self, layer: &Moves, before: Before) -> LayerText {
        let driving = Driving::new(self.drives.as_ref(), layer.layer, before.told);
        let mut text = Text::new(self, before.e, driving);
        // A move takes about 30 bytes.
        text.out.reserve(30 * layer.moves.len());
        let mut cuts = Vec::with_capacity(1 + layer.paths.len());
        text.annotations(layer);
        cuts.push(text.out.len());
        text.begin(layer, before.fan);
        let mut done = 0;
        let mut patches = layer.patches.iter().peekable();
        for (path, &first) in layer.paths.iter().enumerate() {
            text.steps(layer, done..first);
            done = first;
            if patches.next_if(|run| run.paths.end == path).is_some() {
                text.line(";NONPLANAR_END");
            }
            cuts.push(text.out.len());
            patches
                .peek()
                .filter(|run| run.paths.start == path)
                .iter()
                .for_each(|run| text.patch(run));
            for stop in layer.within(path) {
                text.steps(layer, done..stop);
                cuts.push(text.out.len());
                done = stop;
            }
        }
        text.steps(layer, done..layer.moves.len());
        if patches.next().is_some() {
            text.line(";NONPLANAR_END");
        }
        text.blow(None);
        LayerText { text: text.out, cuts }
    }

    /// What comes before the end block: the last retraction, and the machine's own accelerations.
    #[must_use]
    pub fn finish(&self, moves: &MoveParams, before: Before) -> Vec<u8> {
        let mut text = Text::new(self, before.e, Driving::new(None, 0, before.told));
        text.restart_e();
        let (length, feed) = moves.last_pull();
        if length > 0.0 {
            text.pull(-length, feed);
        }
        let own = self.drives.as_ref().map(|drives| drives.restore(before.told));
        text.out.extend_from_slice(own.unwrap_or_default().as_bytes());
        text.out
    }
}

/// The text of a layer so far, and the words in force.
struct Text<'a> {
    params: &'a WriteParams,
    out: Vec<u8>,
    /// Filament used so far, mm.
    e: f64,
    /// E as last written, 10⁻⁵ of its unit.
    written_e: i64,
    /// Position of the nozzle, thousandths of a mm.
    at: Option<[Thousandths; 2]>,
    /// Its z, grid units.
    z: Option<Coord>,
    feed: u32,
    role: Option<Role>,
    /// The fan's power, and what is usual, if this layer is printed with the fan on.
    fan: Option<(f64, f64)>,
    driving: Driving<'a>,
    width: Coord,
    height: Coord,
    /// The layer's top, grid units.
    level: Coord,
}

impl<'a> Text<'a> {
    fn new(params: &'a WriteParams, used: f64, driving: Driving<'a>) -> Self {
        let e = if params.dialect.restarts_e() { 0.0 } else { used };
        Self {
            params,
            out: Vec::new(),
            e,
            written_e: ticks(e * params.e_per_mm),
            at: None,
            z: None,
            feed: 0,
            role: None,
            fan: None,
            driving,
            width: 0,
            height: 0,
            level: 0,
        }
    }

    /// Writes what viewers read at the beginning of a layer.
    fn annotations(&mut self, layer: &Moves) {
        self.line(";LAYER_CHANGE");
        self.annotate(";Z:", layer.z);
        self.annotate(";HEIGHT:", layer.height);
        // Hosts take the print's height from the line that follows this one.
        self.line(";BEFORE_LAYER_CHANGE");
        self.annotate(";", layer.z);
        self.height = layer.height;
        self.level = layer.z;
    }

    /// Tells that a patch begins. What its lines are is told anew.
    fn patch(&mut self, run: &PatchRun) {
        self.line(&format!(";NONPLANAR_START {}", run.patch));
        (self.role, self.height) = (None, 0);
    }

    /// Sets the fan and resets E at the beginning of a layer.
    fn begin(&mut self, layer: &Moves, Fan { before, usual }: Fan) {
        self.fan = usual.map(|usual| (before.unwrap_or(0.0), usual));
        self.blow(None);
        if layer.layer == 1 {
            let params = self.params;
            params.after_first.iter().for_each(|words| self.line(words));
        }
        self.restart_e();
        self.at = layer.from;
    }

    /// Resets E to zero, in dialects that restart it.
    fn restart_e(&mut self) {
        if self.params.dialect.restarts_e() && !self.params.relative_e {
            self.line("G92 E0");
        }
    }

    /// Sets the fan to what `role` needs; at the ends of a layer to what is usual.
    fn blow(&mut self, role: Option<Role>) {
        let Some((power, usual)) = self.fan else { return };
        let fan = &self.params.fan;
        let wanted = role.and_then(|role| fan.roles()[role]).unwrap_or(usual);
        if fan.differ(power, wanted) {
            let words = self.params.dialect.fan(wanted, self.params.tool);
            self.line(&words);
            self.fan = Some((wanted, usual));
        }
    }

    /// Writes moves of a layer, and each arc among them by one line.
    fn steps(&mut self, layer: &Moves, moves: Range<usize>) {
        let mut next = moves.start;
        let first = layer.arcs.partition_point(|arc| arc.pieces.start < next);
        for arc in layer.arcs[first..].iter().take_while(|arc| arc.pieces.start < moves.end) {
            layer.moves[next..arc.pieces.start].iter().for_each(|step| self.step(step));
            self.arc(arc, &layer.moves[arc.pieces.clone()]);
            next = arc.pieces.end;
        }
        layer.moves[next..moves.end].iter().for_each(|step| self.step(step));
    }

    /// Writes an arc. All its words are there: some firmwares want both of X and Y, I and J.
    fn arc(&mut self, arc: &ArcRun, pieces: &[Move]) {
        let Some(&Move { to, z, feed, kind: Kind::Extrude(bead), .. }) = pieces.last() else {
            return;
        };
        self.drive(&Kind::Extrude(bead));
        self.announce(&bead, z);
        self.e += pieces.iter().map(|piece| piece.filament).sum::<f64>();
        self.at = Some(to);
        self.out.extend_from_slice(if arc.clockwise { b"G2" } else { b"G3" });
        let [i, j] = arc.to_middle;
        for (word, value) in [(b" X", to[0]), (b" Y", to[1]), (b" I", i), (b" J", j)] {
            self.out.extend_from_slice(word);
            push_fixed::<3>(&mut self.out, i64::from(value.0));
        }
        if self.z != Some(z) {
            self.push_z(z);
        }
        self.push_e();
        self.end_move(feed);
    }

    fn step(&mut self, step: &Move) {
        self.drive(&step.kind);
        match step.kind {
            Kind::Travel => {
                if self.go(step.to, self.z) {
                    self.end_move(step.feed);
                }
            }
            Kind::Z => {
                self.out.extend_from_slice(b"G1");
                self.push_z(step.z);
                self.end_move(step.feed);
            }
            Kind::Retract | Kind::Restore => self.pull(step.filament, step.feed),
            Kind::Wait(time) => {
                self.out.extend_from_slice(b"G4 P");
                push_fixed::<0>(&mut self.out, i64::from(time));
                self.out.push(b'\n');
            }
            Kind::Extrude(bead) => {
                self.announce(&bead, step.z);
                self.e += step.filament;
                if self.go(step.to, Some(step.z)) {
                    self.push_e();
                    self.end_move(step.feed);
                }
            }
        }
    }

    /// Sets the acceleration and the jerk of a move.
    fn drive(&mut self, kind: &Kind) {
        if let Some(words) = self.driving.words(kind) {
            self.out.extend_from_slice(words.as_bytes());
        }
    }

    fn pull(&mut self, by: f64, feed: u32) {
        if let Some([back, forth]) = self.params.dialect.own_retraction() {
            return self.line(if by < 0.0 { back } else { forth });
        }
        self.out.extend_from_slice(b"G1");
        self.e += by;
        self.push_e();
        self.end_move(feed);
    }

    /// Annotates what differs from the bead before; `z` is where this one ends.
    fn announce(&mut self, bead: &Bead, z: Coord) {
        if self.role != Some(bead.role) {
            self.role = Some(bead.role);
            self.blow(self.role);
            self.out.extend_from_slice(b";TYPE:");
            self.line(bead.role.facts().annotation);
            self.width = 0;
        }
        let level = z == self.level && bead.role != Role::NonPlanar;
        let least = if level { [1, LEAST_WIDTH_CHANGE] } else { [LEAST_CHANGE_ON_SLOPES; 2] };
        if (bead.height - self.height).abs() >= least[0] {
            self.height = bead.height;
            self.annotate(";HEIGHT:", bead.height);
        }
        if (bead.width - self.width).abs() >= least[1] {
            self.width = bead.width;
            self.annotate(";WIDTH:", bead.width);
        }
    }

    /// Begins a move to `to` and `z` with the words that change. Returns whether there are any.
    fn go(&mut self, to: [Thousandths; 2], z: Option<Coord>) -> bool {
        if self.at == Some(to) && self.z == z {
            return false;
        }
        let before = self.at.replace(to);
        self.out.extend_from_slice(b"G1");
        for (axis, word) in [b" X", b" Y"].into_iter().enumerate() {
            if before.is_none_or(|before| before[axis] != to[axis]) {
                self.out.extend_from_slice(word);
                push_fixed::<3>(&mut self.out, i64::from(to[axis].0));
            }
        }
        if let Some(z) = z.filter(|&z| self.z != Some(z)) {
            self.push_z(z);
        }
        true
    }

    fn push_z(&mut self, z: Coord) {
        self.z = Some(z);
        self.out.extend_from_slice(b" Z");
        push_fixed::<3>(&mut self.out, thousandths(to_mm(z)));
    }

    /// Writes E as a rounded sum, or as the difference of two rounded sums: so rounding errors
    /// never add up.
    fn push_e(&mut self) {
        let now = ticks(self.e * self.params.e_per_mm);
        let value = if self.params.relative_e { now - self.written_e } else { now };
        self.written_e = now;
        self.out.extend_from_slice(b" E");
        push_fixed::<5>(&mut self.out, value);
    }

    /// Ends a move, with its feed (mm/min) if that changes.
    fn end_move(&mut self, feed: u32) {
        if self.feed != feed {
            self.feed = feed;
            self.out.extend_from_slice(b" F");
            push_fixed::<0>(&mut self.out, i64::from(feed));
        }
        self.out.push(b'\n');
    }

    fn annotate(&mut self, tag: &str, units: Coord) {
        self.out.extend_from_slice(tag.as_bytes());
        push_fixed::<3>(&mut self.out, thousandths(to_mm(units)));
        self.out.push(b'\n');
    }

    fn line(&mut self, text: &str) {
        // Writing to a vector cannot fail.
        let _ = writeln!(self.out, "{text}");
    }
}

/// The commands for what is hotter or colder after the first layer.
fn after_first(settings: &Settings) -> Vec<String> {
    let (filament, dialect) = (&settings.filament, Dialect::new(settings.machine.dialect));
    let differs = |first: f64, other: f64| (first - other).abs() > f64::EPSILON;
    if !dialect.heats() {
        return Vec::new();
    }
    let nozzle = differs(settings.first_temperature(), filament.temperature)
        .then(|| dialect.nozzle(filament.temperature, settings.machine.tool));
    let bed = differs(settings.first_bed_temperature(), filament.bed_temperature)
        .then(|| dialect.bed(filament.bed_temperature));
    nozzle.into_iter().chain(bed).collect()
}

/// A value of E in 10⁻⁵ of its unit.
fn ticks(e: f64) -> i64 {
    nearest(e * 100_000.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fill::{Path, PathPoint, Shape};
    use crate::gcode::usage::Usage;
    use crate::geom::Point;
    use crate::plan::{Nozzle, PrintMove, Toolpath};
    use crate::profile;

    fn toolpath() -> Toolpath {
        let path = |role, layers: u32, xs: &[Coord], y| {
            let height = 2_000 * layers as Coord;
            let point = |&x| PathPoint { at: Point { x, y }, z: 0, width: 4_000, height, hang: 0 };
            let points = xs.iter().map(point).collect();
            Path { role, shape: Shape::Open, points, layers }
        };
        let wall = path(Role::OuterWall, 1, &[0, 100_000], 0);
        let thick = path(Role::Infill, 2, &[100_000, 0], 20_000);
        let moves = [(true, wall), (false, thick)];
        let moves =
            moves.map(|(retract, path)| PrintMove { retract, ..PrintMove::to(path) }).to_vec();
        Toolpath { layer: 3, z: 8_000, height: 2_000, from: Nozzle::default(), moves }
    }

    fn text(profile: &str) -> String {
        let settings = profile::load([profile], &[]).unwrap().settings;
        let moves = MoveParams::new(&settings, [150.0, 150.0]).moves(&toolpath());
        String::from_utf8(
            WriteParams::new(&settings).layer(&moves, Before { e: 1.0, ..Before::default() }).text,
        )
        .unwrap()
    }

    #[test]
    fn absolute_e_goes_on_and_thick_lines_take_twice_as_much() {
        assert_eq!(
            text("zcube-dual"),
            "\
;LAYER_CHANGE
;Z:0.8
;HEIGHT:0.2
;BEFORE_LAYER_CHANGE
;0.8
G1 E0 F1200
G1 X150 Y150 F5400
G1 Z0.8 F1000
G1 E1 F1200
;TYPE:External perimeter
;WIDTH:0.4
G1 X160 E1.5 F1620
G1 Y152 F5400
;TYPE:Internal infill
;HEIGHT:0.4
;WIDTH:0.4
G1 X150 E2.3 F3600
"
        );
    }

    #[test]
    fn relative_e_counts_from_move_to_move() {
        let text = text("generic-klipper");
        let moves: Vec<&str> = text.lines().filter(|l| l.contains(" E")).collect();
        // 10 mm of 0.4 × 0.2 mm and of 0.4 × 0.4 mm from filament of 1.75 mm.
        assert_eq!(
            moves,
            ["G1 E-1 F1200", "G1 E1 F1200", "G1 X160 E0.3326 F1620", "G1 X150 E0.6652 F3600"]
        );
    }

    #[test]
    fn usage_counts_what_is_written() {
        let settings = profile::load(["zcube-dual"], &[]).unwrap().settings;
        let usage = Usage::of(&MoveParams::new(&settings, [0.0, 0.0]).moves(&toolpath()));
        assert!((usage.filament() - 1.3).abs() < 1e-9);
        assert_eq!((usage.travels, usage.retractions), (2, 1));
    }
}
