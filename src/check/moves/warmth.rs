//! Commands for heaters in the file's order -> findings of temperatures that spoil print or machine.
//!
//! Words used here: a *target* is what the nozzle or the bed was last set to; a temperature is *named*
//! if the file's own settings hold it. Targets are judged:
//! - at any time: above what the material, or any machine, takes;
//! - when a line comes: the nozzle below what the material melts at (below [`MELTS`] nothing is pushed
//!   out at all, which is another finding), or in the print far from all named ones; the bed much colder than
//!   it was, or switched off by the start block that has heated it, so that the part comes loose;
//! - at the file's end: hotter than during the print.
//!
//! The ranges are what makers of filaments print on their spools, with room for hotter nozzles of fast
//! printers. A material that is not listed may have anything that a hot end for plastic reaches.

use crate::check::finding::{Code, Finding, Findings, Place, short};
use crate::check::terms::Terms;
use crate::reader::{Heater, Heating};

/// What a material takes, °C.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Range {
    nozzle: [f64; 2],
    /// The bed at most.
    bed: f64,
}

/// Materials by how their names begin, in upper case; the first that fits counts.
const MATERIALS: &[(&str, Range)] = &[
    ("PLA", Range { nozzle: [165.0, 270.0], bed: 90.0 }),
    ("PCTG", Range { nozzle: [220.0, 300.0], bed: 110.0 }),
    ("PCL", Range { nozzle: [70.0, 170.0], bed: 60.0 }),
    ("PC", Range { nozzle: [230.0, 340.0], bed: 150.0 }),
    ("PETG", Range { nozzle: [200.0, 290.0], bed: 110.0 }),
    ("PET", Range { nozzle: [200.0, 310.0], bed: 120.0 }),
    ("ABS", Range { nozzle: [200.0, 300.0], bed: 140.0 }),
    ("ASA", Range { nozzle: [200.0, 300.0], bed: 140.0 }),
    ("TPU", Range { nozzle: [180.0, 280.0], bed: 110.0 }),
    ("TPE", Range { nozzle: [180.0, 280.0], bed: 110.0 }),
    ("FLEX", Range { nozzle: [180.0, 280.0], bed: 110.0 }),
    ("NYLON", Range { nozzle: [210.0, 340.0], bed: 150.0 }),
];

/// Of any other material: from the coldest that is sold to the hottest hot end for sale.
const ANY: Range = Range { nozzle: [MELTS, 480.0], bed: 160.0 };

/// Nothing melts below this, °C.
const MELTS: f64 = 60.0;

/// Hotter than this no material is printed that is not named, °C.
const HOTTEST: f64 = 320.0;

/// How far the nozzle may be from all named temperatures in the print, °C: towers of temperatures step
/// that far.
const FAR: f64 = 45.0;

/// How far the bed may cool down in the print, °C.
const COOLING: f64 = 25.0;

/// How much hotter a heater may be set at the end than it was, °C.
const ABOVE: f64 = 5.0;

/// One heater.
#[derive(Debug, Clone, Copy, Default)]
struct Target {
    celsius: Option<f64>,
    place: Place,
    /// The hottest so far.
    most: f64,
    /// Whether it was set since the last line.
    is_new: bool,
}

/// Judges heaters in the file's order.
pub(crate) struct Warmth {
    range: Range,
    material: Option<String>,
    named: [Vec<f64>; 2],
    /// The tool in use, if it is known.
    tool: Option<u32>,
    /// The nozzle in use and the bed.
    targets: [Target; 2],
    /// Commands since the last line, which may be those of the end: °C above what was, nozzle or bed.
    hotter: Vec<(usize, f64, Place)>,
    has_begun: bool,
}

impl Warmth {
    pub(crate) fn new(terms: &Terms) -> Self {
        let name = terms.material.as_ref().map(|name| name.to_uppercase());
        let known = |name: &String| {
            MATERIALS.iter().find(|(begin, _)| name.starts_with(begin)).map(|(_, range)| *range)
        };
        let range = name.as_ref().and_then(known);
        Self {
            range: range.unwrap_or(ANY),
            material: terms.material.clone().filter(|_| range.is_some()),
            named: terms.named.clone(),
            tool: terms.machine.as_ref().map(|machine| machine.tool),
            targets: [Target::default(); 2],
            hotter: Vec::new(),
            has_begun: false,
        }
    }

    /// Another tool is in use from here on.
    pub(crate) fn tool(&mut self, tool: u32) {
        self.tool = Some(tool);
    }

    /// A command for a heater.
    pub(crate) fn set(&mut self, heating: &Heating, place: Place, found: &mut Findings) {
        let which = match heating.heater {
            Heater::Bed => 1,
            Heater::Nozzle(None) => 0,
            // An idle tool may be as cold as it likes.
            Heater::Nozzle(tool) if self.tool.is_none() || tool == self.tool => 0,
            _ => return,
        };
        let Some(celsius) = heating.celsius else { return };
        let is_too_hot = self.too_hot(which, celsius, place, found);
        let target = &mut self.targets[which];
        if celsius > target.most + ABOVE && self.has_begun && !is_too_hot {
            self.hotter.push((which, celsius, place));
        }
        (target.celsius, target.place, target.is_new) = (Some(celsius), place, true);
        if !self.has_begun {
            target.most = target.most.max(celsius);
        }
    }

    fn too_hot(&self, which: usize, celsius: f64, place: Place, found: &mut Findings) -> bool {
        let most = match which {
            0 if self.material.is_none() && !self.named[0].contains(&celsius) => HOTTEST,
            0 => self.range.nozzle[1],
            _ => self.range.bed,
        };
        if celsius > most {
            self.report(celsius, &format!("at most {} °C", short(most)), (which, place), found);
        }
        celsius > most
    }

    fn report(
        &self,
        celsius: f64,
        takes: &str,
        (which, place): (usize, Place),
        found: &mut Findings,
    ) {
        let what = ["nozzle", "bed"][which];
        let whose = self.material.as_deref().unwrap_or("any usual material");
        let text = format!("the {what} is set to {} °C, {whose} takes {takes}", short(celsius));
        let code = code(self.has_begun);
        found.add(Finding::of(code, celsius, "°C", text).at(place));
    }

    /// A line of a layer comes next.
    pub(crate) fn line(&mut self, found: &mut Findings) {
        if self.targets[0].is_new || self.targets[1].is_new {
            self.nozzle(found);
            self.bed(found);
            for target in &mut self.targets {
                target.is_new = false;
                target.most = target.most.max(target.celsius.unwrap_or(0.0));
            }
        }
        self.hotter.clear();
        self.has_begun = true;
    }

    fn nozzle(&self, found: &mut Findings) {
        let target = &self.targets[0];
        let Some(celsius) = target.celsius.filter(|_| target.is_new) else { return };
        let [least, most] = self.range.nozzle;
        let away = self.named[0].iter().map(|named| (named - celsius).abs());
        let away = away.fold(f64::INFINITY, f64::min);
        let is_cold_at_start = !self.has_begun && celsius < MELTS;
        if celsius < least && !is_cold_at_start {
            let takes = format!("{} to {} °C", short(least), short(most));
            self.report(celsius, &takes, (0, target.place), found);
        } else if self.has_begun && away.is_finite() && away > FAR && celsius <= most {
            let text = format!(
                "the nozzle is set to {} °C in the print, {} °C from what the settings say",
                short(celsius),
                short(away)
            );
            found.add(Finding::of(code(true), away, "°C", text).at(target.place));
        }
    }

    fn bed(&self, found: &mut Findings) {
        let target = &self.targets[1];
        let Some(celsius) = target.celsius.filter(|_| target.is_new) else { return };
        let is_named = self.named[1].iter().any(|named| (named - celsius).abs() < 1.0);
        let colder = target.most - celsius;
        if !self.has_begun {
            // A start block may heat a bed through, and then let it cool to what is asked for.
            if celsius <= 0.0 && colder > COOLING && !is_named {
                let most = short(target.most);
                let text = format!(
                    "the bed is switched off before the print, where it was set to {most} °C: the part \
                     comes loose"
                );
                let one = if self.named[1].is_empty() { Finding::warning } else { Finding::of };
                found.add(one(code(false), colder, "°C", text).at(target.place));
            }
            return;
        }
        if colder > COOLING && !is_named {
            let text = format!(
                "the bed is set to {} °C in the print, {} °C colder than before: the part comes loose",
                short(celsius),
                short(colder)
            );
            found.add(Finding::of(code(true), colder, "°C", text).at(target.place));
        }
    }

    /// The file ends.
    pub(crate) fn finish(&mut self, found: &mut Findings) {
        for (which, celsius, place) in std::mem::take(&mut self.hotter) {
            let what = ["nozzle", "bed"][which];
            let text = format!("the {what} is set to {} °C after the print", short(celsius));
            found.add(Finding::of(code(true), celsius, "°C", text).at(place));
        }
    }
}

/// The print has begun with a right temperature, and a command changes it; or it begins with a wrong one.
fn code(has_begun: bool) -> Code {
    if has_begun { Code::ChangesTheMachine } else { Code::WrongTemperature }
}
