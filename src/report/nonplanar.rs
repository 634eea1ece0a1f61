//! Patches -> NonPlanarReport: which places of the tops are skin that follows the surface, and why others are not.

use crate::nonplanar::{Areas, Patch, Patches, Reason};
use crate::units::to_mm;
use crate::warning::Warning;
use schemars::JsonSchema;
use serde::Serialize;

/// Skins that follow the surface. Areas are true areas of the model's surface where it faces up by 45°
/// or less; each place counts once.
#[derive(Debug, Clone, Default, PartialEq, Serialize, JsonSchema)]
pub struct NonPlanarReport {
    /// Name of the head that holds, if no key of `[head]` changes it.
    pub head: Option<&'static str>,
    /// All of these areas.
    pub areas: TopAreas,
    /// The patches, in the order of printing.
    pub patches: Vec<PatchReport>,
}

/// Areas of tops by how they are printed, mm².
#[derive(Debug, Clone, Default, PartialEq, Serialize, JsonSchema)]
pub struct TopAreas {
    /// All together.
    pub top_mm2: f64,
    /// Skins follow the surface.
    pub skin_mm2: f64,
    /// Lines rise and fall within their own layer.
    pub contour_mm2: f64,
    /// Too flat to need either.
    pub level_mm2: f64,
    /// Printed flat although sloped.
    pub flat_mm2: f64,
    /// The same by the first reason that applies.
    pub flat: Vec<FlatReport>,
}

/// What is printed flat for one reason.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct FlatReport {
    /// `slope`: steeper than the head can follow; `press`: the nozzle's flat face would press too deep;
    /// `cone`: the head would touch the surface or its base; `obstacle`: something else of the same
    /// body; `neighbour`: another body, support or skirt; `overhang`: too little lies below; `support`: it
    /// would stand there; `z-limit`: no room above; `area`: too small; `thin`: narrower than three lines.
    pub reason: &'static str,
    /// How much, mm².
    pub mm2: f64,
}

/// One patch.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct PatchReport {
    /// Its number in the file.
    pub number: u32,
    /// The layer after which it is printed, counted from 1.
    pub layer: usize,
    /// Its lowest corner x, y, z in the layout, z above the bed, mm.
    pub min_mm: [f64; 3],
    /// Its highest corner, mm.
    pub max_mm: [f64; 3],
    /// Its steepest slope, degrees.
    pub steepest_deg: f64,
    /// Direction of the lines of each skin, from the lowest up, degrees.
    pub directions_deg: Vec<f64>,
    /// The piece of surface that it is of.
    pub areas: TopAreas,
}

/// The report on some patches over `count` layers; the layers of a raft, and how far it lifts, mm, come on
/// top.
#[must_use]
pub fn report(patches: &Patches, count: usize, (layers, lift_mm): (usize, f64)) -> NonPlanarReport {
    let one = |patch: &Patch| {
        let [low, high] = patch.extent;
        let [bottom, top] = patch.bounds.map(|z| to_mm(z) + lift_mm);
        PatchReport {
            number: patch.number,
            // Of the layer that it waited for nothing may be left.
            layer: (patch.layer + 1).min(count) + layers,
            min_mm: [to_mm(low.x), to_mm(low.y), bottom],
            max_mm: [to_mm(high.x), to_mm(high.y), top],
            steepest_deg: patch.steepest,
            directions_deg: patch.directions.clone(),
            areas: areas(&patch.mm2),
        }
    };
    let patches_report = patches.patches.iter().map(one).collect();
    NonPlanarReport { head: None, areas: areas(&patches.mm2), patches: patches_report }
}

/// A warning if no top is printed otherwise than without such skins.
#[must_use]
pub fn unused(report: &NonPlanarReport) -> Option<Warning> {
    let why = "no top slopes so that the head can follow it; the report says why";
    let areas = &report.areas;
    let is_void = areas.skin_mm2 <= 0.0 && areas.contour_mm2 <= 0.0;
    is_void.then(|| Warning::void(["nonplanar.enabled"], why))
}

fn areas(mm2: &Areas) -> TopAreas {
    let of = |reason: Reason| FlatReport { reason: reason.name(), mm2: mm2.of(reason) };
    let flat: Vec<FlatReport> =
        Reason::ALL.into_iter().map(of).filter(|flat| flat.mm2 > 0.0).collect();
    TopAreas {
        top_mm2: mm2.total(),
        skin_mm2: mm2.skin,
        contour_mm2: mm2.contour,
        level_mm2: mm2.level,
        flat_mm2: flat.iter().fold(0.0, |sum, flat| sum + flat.mm2),
        flat,
    }
}
