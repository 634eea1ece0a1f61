//! Print + Estimate -> Facts: what the viewer's page gets besides the moves.
//!
//! The page shows times, sums and settings, and colours lines by speed, flow, layer time, width or
//! height. Moves come packed ([`super::packed`]); everything else is gathered here and written as
//! JSON: names and colours of roles, layers with their heights and times, the box around all
//! lines, the settings that the file's comments hold, and the ends of the scales.
//!
//! The ends of the scales are the least and most of all lines but the shortest: the flow of a line of
//! 0.1 mm is mostly rounding, and one such line would stretch the scale for all others. A file of
//! short lines only uses them all.
//!
//! Numbers are rounded to thousandths, so that the page stays small and equal files give equal pages.
//! Times of layers are left out where the estimate divides the file into other layers.
//!
//! A patch of non-planar skin is listed after its layer, as it is packed ([`super::stages`]). The estimate
//! has no time of its own for it: the layer's is shared by what lines take at the feed asked for.

use super::colours::Colour;
use super::stages::{Stage, stages};
use crate::estimate::Estimate;
use crate::reader::Role;
use crate::reader::print::{Print, Step};
use serde::Serialize;
use std::f64::consts::PI;

/// Shorter lines do not count for the ends of scales, mm: with three decimals their flow is off by
/// up to a hundredth.
const SHORTEST: f64 = 0.2;

/// Characters of a setting that are shown.
const LONGEST_VALUE: usize = 300;

/// What the page gets as JSON; lengths in mm, times in s.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Facts {
    /// The file's name.
    pub name: String,
    /// The first of the file's first comments that names its generator; empty without one.
    pub head: String,
    /// The whole time, without heating and homing.
    pub seconds: f64,
    /// Of it, before the first layer.
    pub start_seconds: f64,
    /// Filament that has gone in.
    pub filament_mm: f64,
    /// Its volume, cm³.
    pub filament_cm3: f64,
    /// Cross-section of the filament, mm².
    pub filament_area: f64,
    /// Number of moves.
    pub moves: usize,
    /// Least and most x, y, z of the lines of all layers, their widths included;
    /// nothing without a line.
    pub bounds: Option<[[f64; 3]; 2]>,
    /// By role, in the order of [`Role::ALL`].
    pub roles: Vec<RoleFacts>,
    /// From the bed up, each patch of non-planar skin after its layer.
    pub layers: Vec<LayerFacts>,
    /// Greatest height of a line that is no non-planar skin; nothing in a print without patches.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub highest: Option<f64>,
    /// Ends of the scales.
    pub scales: Scales,
    /// Settings in the file's comments, in their order.
    pub settings: Vec<(String, String)>,
}

/// A role on the page.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RoleFacts {
    /// Its name for people.
    pub name: &'static str,
    /// `#rrggbb`.
    pub colour: String,
    /// That of lines which are printed for several layers.
    pub thick: String,
    /// Its time.
    pub seconds: f64,
    /// Filament pushed out less that pulled back.
    pub filament_mm: f64,
    /// Number of moves.
    pub moves: u64,
}

/// A layer or a patch on the page.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LayerFacts {
    /// Height at which most of its lines lie; of a patch the highest place.
    pub z: f64,
    /// Height above the layer below.
    pub height: f64,
    /// Its time; nothing where the estimate divides the file otherwise.
    pub seconds: Option<f64>,
    /// The layer's number, from 1; nothing in a print without patches, where it is the place in the list.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub number: Option<usize>,
    /// The patch's number, if it is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub skin: Option<u32>,
    /// Of a patch the lowest place of the nozzle.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub low: Option<f64>,
}

/// Least and most of what lines are coloured by; nothing without a line.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Scales {
    /// mm/s.
    pub speed: Option<[f64; 2]>,
    /// mm³/s.
    pub flow: Option<[f64; 2]>,
    /// Of a layer, s.
    pub time: Option<[f64; 2]>,
    /// mm.
    pub width: Option<[f64; 2]>,
    /// mm.
    pub height: Option<[f64; 2]>,
    /// Of the nozzle on non-planar skin, mm; nothing without any.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub z: Option<[f64; 2]>,
}

impl Facts {
    /// Gathers them; `filament_diameter` in mm.
    #[must_use]
    pub fn new(print: &Print, estimate: &Estimate, name: &str, filament_diameter: f64) -> Self {
        let filament_area = PI * filament_diameter * filament_diameter / 4.0;
        let layers = layers(print, estimate);
        Self {
            name: name.to_owned(),
            head: head(print),
            seconds: rounded(estimate.seconds),
            start_seconds: rounded(estimate.start_seconds),
            filament_mm: rounded(estimate.filament_mm),
            filament_cm3: rounded(estimate.filament_mm * filament_area / 1000.0),
            filament_area,
            moves: print.moves.len(),
            bounds: bounds(print),
            roles: Role::ALL.iter().map(|&role| RoleFacts::new(role, estimate)).collect(),
            scales: Scales::new(print, &layers, filament_area),
            layers,
            highest: highest(print),
            settings: settings(print),
        }
    }
}

impl RoleFacts {
    fn new(role: Role, estimate: &Estimate) -> Self {
        let found = estimate.roles.iter().find(|time| time.role == role);
        Self {
            name: role.name(),
            colour: Colour::of(role, false).hex(),
            thick: Colour::of(role, true).hex(),
            seconds: found.map_or(0.0, |time| rounded(time.seconds)),
            filament_mm: found.map_or(0.0, |time| rounded(time.filament_mm)),
            moves: found.map_or(0, |time| time.moves),
        }
    }
}

impl Scales {
    fn new(print: &Print, layers: &[LayerFacts], area: f64) -> Self {
        let mut scales = Self::default();
        let mut widen = |step: &Step| {
            include(&mut scales.speed, f64::from(step.feed));
            include(&mut scales.width, f64::from(step.width));
            include(&mut scales.height, f64::from(step.height));
            let flow = f64::from(step.filament) * area * f64::from(step.feed) / step.length();
            include(&mut scales.flow, flow);
            if step.role == Role::NonPlanar {
                let [low, high] = step.heights();
                include(&mut scales.z, f64::midpoint(low, high));
            }
        };
        let (long, short): (Vec<&Step>, Vec<&Step>) =
            lines(print).partition(|step| step.length() >= SHORTEST);
        let counted = if long.is_empty() { short } else { long };
        counted.into_iter().for_each(&mut widen);
        let times = layers.iter().filter_map(|layer| layer.seconds);
        times.for_each(|seconds| include(&mut scales.time, seconds));
        scales
    }
}

/// The lines of all layers.
fn lines(print: &Print) -> impl Iterator<Item = &Step> {
    let moves = print.layers.iter().flat_map(|layer| print.moves_of(layer));
    moves.filter(|step| step.is_line())
}

fn include(range: &mut Option<[f64; 2]>, value: f64) {
    let value = rounded(value);
    if value.is_finite() {
        let [least, most] = range.unwrap_or([value; 2]);
        *range = Some([least.min(value), most.max(value)]);
    }
}

fn bounds(print: &Print) -> Option<[[f64; 3]; 2]> {
    let mut axes = [None; 3];
    for step in lines(print) {
        let aside = f64::from(step.width) / 2.0;
        for end in [step.from, step.to].map(|end| end.map(f64::from)) {
            for (axis, (range, at)) in axes.iter_mut().zip(end).enumerate() {
                let (below, above) =
                    if axis < 2 { (aside, aside) } else { (step.height.into(), 0.0) };
                include(range, at - below);
                include(range, at + above);
            }
        }
    }
    let [x, y, z] = axes;
    let (x, y, z) = (x?, y?, z?);
    Some([[x[0], y[0], z[0]], [x[1], y[1], z[1]]])
}

fn layers(print: &Print, estimate: &Estimate) -> Vec<LayerFacts> {
    let stages = stages(print);
    let has_patches = stages.iter().any(|stage| stage.patch.is_some());
    let same = print.layers.len() == estimate.layers.len();
    let seconds = |stage: &Stage| {
        let layer = estimate.layers.get(stage.layer).filter(|_| same)?;
        let whole = print.layers.get(stage.layer)?;
        let shared = stage.moves != whole.moves;
        let part = if shared {
            nominal(&print.moves[stage.moves.clone()]) / nominal(print.moves_of(whole))
        } else {
            1.0
        };
        Some(rounded(layer.seconds * part))
    };
    let facts = |stage: &Stage| {
        let layer = print.layers.get(stage.layer);
        let reach = stage.patch.and_then(|_| reach(&print.moves[stage.moves.clone()]));
        let z = reach.map_or(layer.map_or(0.0, |layer| layer.z), |[_, high]| high);
        LayerFacts {
            z: rounded(z),
            height: rounded(layer.map_or(0.0, |layer| layer.height)),
            seconds: seconds(stage),
            number: has_patches.then_some(stage.layer + 1),
            skin: stage.patch,
            low: reach.map(|[low, _]| rounded(low)),
        }
    };
    stages.iter().map(facts).collect()
}

/// What moves take at the feed asked for, s; never 0.
fn nominal(steps: &[Step]) -> f64 {
    let seconds = |step: &Step| {
        let way = step.length().max(f64::from(step.filament).abs());
        way / f64::from(step.feed).max(0.1)
    };
    steps.iter().map(seconds).sum::<f64>().max(f64::MIN_POSITIVE)
}

/// Lowest and highest place of the nozzle on lines, mm.
fn reach(steps: &[Step]) -> Option<[f64; 2]> {
    let lines = steps.iter().filter(|step| step.is_line()).map(Step::heights);
    lines.reduce(|[low, high], [from, to]| [low.min(from), high.max(to)])
}

/// Greatest height of a line that is no skin of a patch, mm; nothing where there is no patch.
fn highest(print: &Print) -> Option<f64> {
    let flat = lines(print).filter(|step| step.role != Role::NonPlanar);
    let highest = flat.map(|step| f64::from(step.height)).reduce(f64::max);
    highest.filter(|_| !print.patches.is_empty()).map(rounded)
}

fn head(print: &Print) -> String {
    let names_it = |line: &&String| line.to_lowercase().contains("generated");
    print.head.iter().find(names_it).map_or_else(String::new, |line| shortened(line))
}

fn settings(print: &Print) -> Vec<(String, String)> {
    let values = print.values.iter();
    values.map(|(key, value)| (shortened(key), shortened(value))).collect()
}

fn shortened(text: &str) -> String {
    text.chars().take(LONGEST_VALUE).collect()
}

/// To thousandths: enough for people, and sums have long tails.
fn rounded(value: f64) -> f64 {
    (value * 1000.0).round() / 1000.0
}
