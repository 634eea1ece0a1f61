//! Toolpath -> text: the G-code of one layer, independent of all others but for where it begins.

use super::dialect::Dialect;
use super::number::{push_fixed, push_integer, thousandths};
use crate::geom::Point;
use crate::plan::{Path, Role, Toolpath};
use crate::profile::{ExtrusionModel, Settings};
use crate::units::{Coord, UNITS_PER_MM, nearest, to_mm, to_units};
use std::f64::consts::PI;
use std::io::Write as _;

/// Widths that differ by less are not worth an annotation (0.01 mm).
const LEAST_WIDTH_CHANGE: Coord = 100;

/// What was extruded in one role: path and filament, mm.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Used {
    /// Length of path, mm.
    pub length: f64,
    /// Filament, mm.
    pub filament: f64,
}

/// What a layer, or a print, moves and uses.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Usage {
    /// By role, in the order of [`Role::ALL`]: lines of one layer's height, then thick ones.
    pub roles: [[Used; 2]; 5],
    /// Travels.
    pub travels: usize,
    /// Their length, mm.
    pub travel_length: f64,
    /// How many of them retract.
    pub retractions: usize,
}

impl Usage {
    /// Filament in all, mm.
    #[must_use]
    pub fn filament(&self) -> f64 {
        self.roles.as_flattened().iter().map(|r| r.filament).sum()
    }

    /// Adds another layer's usage.
    pub fn add(&mut self, other: &Self) {
        let theirs = other.roles.as_flattened();
        for (mine, theirs) in self.roles.as_flattened_mut().iter_mut().zip(theirs) {
            mine.length += theirs.length;
            mine.filament += theirs.filament;
        }
        self.travels += other.travels;
        self.travel_length += other.travel_length;
        self.retractions += other.retractions;
    }
}

/// How far the print is when a layer begins.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Start {
    /// Filament used so far, mm.
    pub e: f64,
    /// Layers done and in all, for the progress.
    pub done: (usize, usize),
}

/// The numbers that writing needs.
#[derive(Debug, Clone)]
pub struct WriteParams {
    dialect: Dialect,
    relative_e: bool,
    /// Where the layout's middle goes on the machine, grid units.
    offset: [i64; 2],
    /// mm of filament for each mm of path, mm of width and mm of height, by role.
    rates: [f64; 5],
    /// By role, of lines of one layer's height and of thick ones.
    feeds: [[f64; 2]; 5],
    first_layer: f64,
    travel_feed: f64,
    z_feed: f64,
    retract: f64,
    retract_feed: f64,
    hop: Coord,
    fan: f64,
    fan_from_layer: usize,
    tool: u32,
}

impl WriteParams {
    /// The numbers that `settings` mean for writing; `offset` is the layout's middle, mm.
    #[must_use]
    pub fn new(settings: &Settings, offset: [f64; 2]) -> Self {
        let (x, s) = (&settings.extrusion, &settings.speed);
        let rate = |factor: f64| match x.model {
            ExtrusionModel::Area => x.multiplier / filament_area(settings),
            ExtrusionModel::Factor => x.multiplier * factor / (x.factor_width * x.factor_height),
        };
        let (wall, infill) = (rate(x.wall_factor), rate(x.infill_factor));
        Self {
            dialect: Dialect::new(settings.machine.dialect),
            relative_e: settings.machine.relative_e,
            offset: offset.map(|mm| i64::from(to_units(mm))),
            rates: [wall, wall, rate(x.skin_factor), infill, rate(x.support_factor)],
            feeds: [
                [s.wall; 2],
                [s.wall; 2],
                [s.skin; 2],
                [s.infill, s.thick_infill],
                [s.support; 2],
            ],
            first_layer: s.first_layer / 100.0,
            travel_feed: s.travel,
            z_feed: s.z,
            retract: settings.retraction.length,
            retract_feed: settings.retraction.feed,
            hop: to_units(settings.retraction.z_hop),
            fan: settings.filament.fan,
            fan_from_layer: settings.filament.fan_from_layer as usize,
            tool: settings.machine.tool,
        }
    }

    /// Filament for a stretch of path, mm.
    fn filament(&self, role: Role, length_mm: f64, width: Coord, height: Coord) -> f64 {
        self.rates[role as usize] * length_mm * to_mm(width) * to_mm(height)
    }

    /// What a layer will use.
    #[must_use]
    pub fn usage(&self, layer: &Toolpath) -> Usage {
        let mut usage = Usage::default();
        let mut at = layer.from;
        for step in &layer.steps {
            if at != Some(step.path.start()) {
                usage.travels += 1;
                usage.travel_length +=
                    at.map_or(0.0, |p| p.distance(step.path.start())) / UNITS_PER_MM;
            }
            usage.retractions += usize::from(step.retract);
            let used = &mut usage.roles[step.path.role as usize][usize::from(step.path.is_thick())];
            for (_, length, width) in step.path.segments() {
                let length = length / UNITS_PER_MM;
                used.length += length;
                used.filament += self.filament(step.path.role, length, width, step.path.height);
            }
            at = Some(step.path.end());
        }
        usage
    }

    /// The text of one layer.
    #[must_use]
    pub fn layer(&self, layer: &Toolpath, start: &Start) -> Vec<u8> {
        let mut text = Text::new(self, start);
        text.begin(layer, start);
        for step in &layer.steps {
            text.approach(layer.z, step.path.start(), step.retract);
            text.path(&step.path, layer);
        }
        text.out
    }

    /// The last pull before the end block, at filament used `e`.
    #[must_use]
    pub fn finish(&self, start: &Start) -> Vec<u8> {
        let mut text = Text::new(self, start);
        text.restart_e();
        if self.retract > 0.0 {
            text.retract();
        }
        text.out
    }

    /// What says that the print is done, where the end block does not.
    #[must_use]
    pub fn done(&self) -> String {
        if self.dialect.says_done() { self.dialect.progress(100) + "\n" } else { String::new() }
    }

    /// The annotation of a role, in the words that viewers know.
    fn type_name(role: Role) -> &'static str {
        match role {
            Role::OuterWall => "External perimeter",
            Role::InnerWall => "Perimeter",
            Role::Skin => "Solid infill",
            Role::Infill => "Internal infill",
            Role::Support => "Support material",
        }
    }
}

/// A length of filament in the measures that people buy it in.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Material {
    /// Length, mm.
    pub mm: f64,
    /// Volume, cm³.
    pub cm3: f64,
    /// Weight, g.
    pub grams: f64,
}

impl Material {
    /// What `mm` of the filament in `settings` are.
    #[must_use]
    pub fn new(mm: f64, settings: &Settings) -> Self {
        let cm3 = mm * filament_area(settings) / 1000.0;
        Self { mm, cm3, grams: cm3 * settings.filament.density }
    }
}

/// The cross-section of the filament, mm².
#[must_use]
pub fn filament_area(settings: &Settings) -> f64 {
    PI * settings.filament.diameter * settings.filament.diameter / 4.0
}

/// A layer's text in the making, with the words that stay in force.
struct Text<'a> {
    params: &'a WriteParams,
    out: Vec<u8>,
    /// Filament used, mm.
    e: f64,
    /// E as last written, 10⁻⁵ mm.
    written_e: i64,
    x: Option<i64>,
    y: Option<i64>,
    z: Option<Coord>,
    feed: Option<u64>,
    role: Option<Role>,
    width: Coord,
    height: Coord,
}

impl<'a> Text<'a> {
    fn new(params: &'a WriteParams, start: &Start) -> Self {
        let e = if params.dialect.restarts_e() { 0.0 } else { start.e };
        Self {
            params,
            out: Vec::new(),
            e,
            written_e: ticks(e),
            x: None,
            y: None,
            z: None,
            feed: None,
            role: None,
            width: 0,
            height: 0,
        }
    }

    /// Annotations, progress, fan and E at the beginning of a layer.
    fn begin(&mut self, layer: &Toolpath, start: &Start) {
        self.line(";LAYER_CHANGE");
        self.annotate(";Z:", layer.z);
        self.annotate(";HEIGHT:", layer.height);
        let (done, total) = start.done;
        let percent = |layers: usize| 100 * layers / total.max(1);
        if done == 0 || percent(done) != percent(done - 1) {
            let words = self.params.dialect.progress(percent(done));
            self.line(&words);
        }
        let from = self.params.fan_from_layer.max(1) - 1;
        let fan = self.params.fan;
        if fan > 0.0 && layer.layer == from {
            let words = self.params.dialect.fan(fan, self.params.tool);
            self.line(&words);
        }
        self.restart_e();
        self.height = layer.height;
        if let Some(from) = layer.from {
            let [x, y] = self.place(from);
            (self.x, self.y) = (Some(x), Some(y));
        }
    }

    /// Says that E counts from zero again, where it does.
    fn restart_e(&mut self) {
        if self.params.dialect.restarts_e() && !self.params.relative_e {
            self.line("G92 E0");
        }
    }

    /// The way to the beginning of a path at height `z`.
    fn approach(&mut self, z: Coord, to: Point, retract: bool) {
        if retract {
            self.retract();
            if self.params.hop > 0 {
                self.move_z(z + self.params.hop);
            }
        }
        // Up before sideways. The first way of a print goes down at its end instead:
        // the start block leaves the nozzle above its purge.
        if self.z.is_none() && self.x.is_some() {
            self.move_z(z);
        }
        if self.go(to) {
            self.end_move(self.params.travel_feed);
        }
        if self.z != Some(z) {
            self.move_z(z);
        }
        if retract {
            self.pull(self.params.retract);
        }
    }

    fn retract(&mut self) {
        self.pull(-self.params.retract);
    }

    fn move_z(&mut self, z: Coord) {
        self.out.extend_from_slice(b"G1 Z");
        push_fixed(&mut self.out, thousandths(to_mm(z)), 3);
        self.z = Some(z);
        self.end_move(self.params.z_feed);
    }

    fn pull(&mut self, by: f64) {
        self.out.extend_from_slice(b"G1");
        self.e += by;
        self.push_e();
        self.end_move(self.params.retract_feed);
    }

    fn path(&mut self, path: &Path, layer: &Toolpath) {
        let slow = if layer.layer == 0 { self.params.first_layer } else { 1.0 };
        let feed = self.params.feeds[path.role as usize][usize::from(path.is_thick())] * slow;
        if self.role != Some(path.role) {
            self.role = Some(path.role);
            self.out.extend_from_slice(b";TYPE:");
            self.line(WriteParams::type_name(path.role));
            self.width = 0;
        }
        if self.height != path.height {
            self.height = path.height;
            self.annotate(";HEIGHT:", path.height);
        }
        for (to, length, width) in path.segments() {
            if (width - self.width).abs() >= LEAST_WIDTH_CHANGE {
                self.width = width;
                self.annotate(";WIDTH:", width);
            }
            let length = length / UNITS_PER_MM;
            self.e += self.params.filament(path.role, length, width, path.height);
            if self.go(to) {
                self.push_e();
                self.end_move(feed);
            }
        }
    }

    /// Where a point is on the machine, thousandths of a mm.
    fn place(&self, p: Point) -> [i64; 2] {
        let [x, y] = self.params.offset;
        // Ten units are a thousandth; half away from zero is not needed, only the same everywhere.
        [(i64::from(p.x) + x + 5).div_euclid(10), (i64::from(p.y) + y + 5).div_euclid(10)]
    }

    /// Begins a move to `to` with the words that change; says no if none does.
    fn go(&mut self, to: Point) -> bool {
        let [x, y] = self.place(to);
        if self.x == Some(x) && self.y == Some(y) {
            return false;
        }
        self.out.extend_from_slice(b"G1");
        if self.x != Some(x) {
            self.x = Some(x);
            self.out.extend_from_slice(b" X");
            push_fixed(&mut self.out, x, 3);
        }
        if self.y != Some(y) {
            self.y = Some(y);
            self.out.extend_from_slice(b" Y");
            push_fixed(&mut self.out, y, 3);
        }
        true
    }

    /// Writes E so that roundings never add up: what is written is always the
    /// rounded sum, or the difference of two rounded sums.
    fn push_e(&mut self) {
        let now = ticks(self.e);
        let value = if self.params.relative_e { now - self.written_e } else { now };
        self.written_e = now;
        self.out.extend_from_slice(b" E");
        push_fixed(&mut self.out, value, 5);
    }

    /// Ends a move with its feed (mm/min), if that changes.
    fn end_move(&mut self, feed: f64) {
        let feed = feed.round().max(1.0) as u64;
        if self.feed != Some(feed) {
            self.feed = Some(feed);
            self.out.extend_from_slice(b" F");
            push_integer(&mut self.out, feed);
        }
        self.out.push(b'\n');
    }

    fn annotate(&mut self, tag: &str, units: Coord) {
        self.out.extend_from_slice(tag.as_bytes());
        push_fixed(&mut self.out, thousandths(to_mm(units)), 3);
        self.out.push(b'\n');
    }

    fn line(&mut self, text: &str) {
        // Writing to a vector cannot fail.
        let _ = writeln!(self.out, "{text}");
    }
}

/// mm of filament in 10⁻⁵ mm.
fn ticks(mm: f64) -> i64 {
    nearest(mm * 100_000.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::{PathPoint, Step};
    use crate::profile;

    fn toolpath() -> Toolpath {
        let path = |role, layers: u32, xs: &[Coord], y| Path {
            role,
            layers,
            height: 2_000 * layers as Coord,
            points: xs.iter().map(|&x| PathPoint { at: Point { x, y }, width: 4_000 }).collect(),
        };
        let wall = path(Role::OuterWall, 1, &[0, 100_000], 0);
        let thick = path(Role::Infill, 2, &[100_000, 0], 20_000);
        let steps = vec![Step { retract: true, path: wall }, Step { retract: false, path: thick }];
        Toolpath { layer: 3, z: 8_000, height: 2_000, from: None, steps }
    }

    fn text(profile: &str) -> String {
        let settings = profile::load(profile, &[]).unwrap().settings;
        let params = WriteParams::new(&settings, [150.0, 150.0]);
        let start = Start { e: 1.0, done: (3, 10) };
        String::from_utf8(params.layer(&toolpath(), &start)).unwrap()
    }

    #[test]
    fn absolute_e_goes_on_and_thick_lines_take_twice_as_much() {
        assert_eq!(
            text("zcube-dual"),
            "\
;LAYER_CHANGE
;Z:0.8
;HEIGHT:0.2
M73 P30
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
        let settings = profile::load("zcube-dual", &[]).unwrap().settings;
        let usage = WriteParams::new(&settings, [0.0, 0.0]).usage(&toolpath());
        assert!((usage.filament() - 1.3).abs() < 1e-9);
        assert_eq!((usage.travels, usage.retractions), (2, 1));
    }
}
