//! Map -> Roughness: the means of the whole surface, of slopes and of patches, and their JSON Schema.

use super::lie::Lie;
use super::map::Map;
use super::means::Means;
use super::profile::{Found, measure};
use super::sums::{CLASSES, SLOPES, Sums};
use super::surface::Surface;
use super::{Options, WINDOW};
use crate::units::to_mm;
use schemars::JsonSchema;
use schemars::generate::SchemaSettings;
use serde::Serialize;

/// Version of the JSON schema; raised when a field changes its meaning or goes away.
pub const SCHEMA: u32 = 1;

/// Area from which a patch is listed, mm².
const LEAST_PATCH: f64 = 20.0;

/// Roughness of the tops that a file prints.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Roughness {
    /// [`SCHEMA`].
    pub schema: u32,
    /// Side of a cell of the map, mm.
    pub cell_mm: f64,
    /// Height of a layer, by which plastic is near, mm.
    pub layer_mm: f64,
    /// Plastic within this many layers of the surface is near it.
    pub window_layers: f64,
    /// Cut-off of the Gaussian filters, mm.
    pub cutoff_mm: f64,
    /// How far the part lies from where it was expected on the bed, x and y, mm.
    pub moved_mm: [f64; 2],
    /// How far a raft lifts it, mm.
    pub lift_mm: f64,
    /// All that slopes by 0.5° to 45°.
    pub whole: Means,
    /// By slope, level tops among them.
    pub slopes: Vec<OfSlope>,
    /// Patches of 20 mm² or more that slope, the largest first.
    pub patches: Vec<OfPatch>,
    /// How many smaller patches there are that slope.
    pub small_patches: usize,
    /// And their area, mm².
    pub small_area_mm2: f64,
}

/// Slopes from one to another.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct OfSlope {
    /// From this slope on, degrees.
    pub from_deg: f64,
    /// Up to this one, degrees.
    pub to_deg: f64,
    /// What was found.
    #[serde(flatten)]
    pub means: Means,
}

/// A piece of the surface whose facets are joined by edges of less than 30°.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct OfPatch {
    /// Lowest corner of the box around it, in the machine's coordinates, mm.
    pub low_mm: [f64; 3],
    /// Highest corner, mm.
    pub high_mm: [f64; 3],
    /// Steepest slope, degrees.
    pub steepest_deg: f64,
    /// Direction in which it mostly rises or falls, degrees from x towards y, 0 to 180.
    pub direction_deg: f64,
    /// What was found, level places left out.
    #[serde(flatten)]
    pub means: Means,
}

/// The JSON Schema of a [`Roughness`].
#[must_use]
pub fn schema() -> serde_json::Value {
    let settings = SchemaSettings::draft2020_12().for_serialize();
    settings.into_generator().into_root_schema_for::<Roughness>().to_value()
}

/// Measures all patches of a map.
pub(super) fn make(surface: &Surface, map: &Map, lie: &Lie, options: &Options) -> Roughness {
    let mut samples: Vec<Vec<u32>> = vec![Vec::new(); surface.patches];
    for (k, sample) in (0_u32..).zip(&map.samples) {
        samples[sample.patch as usize].push(k);
    }
    let mut by_class = [Sums::default(); CLASSES];
    let mut patches = Vec::new();
    let (mut small_patches, mut small_area_mm2) = (0, 0.0);
    for samples in samples.iter().filter(|samples| !samples.is_empty()) {
        let found = measure(map, samples, options.cutoff);
        by_class.iter_mut().zip(&found.sums).for_each(|(all, one)| all.and(one));
        let sloped = Sums::of(&found.sums[1..]);
        if sloped.area >= LEAST_PATCH {
            patches.push(patch(map, samples, lie, &found));
        } else if sloped.area > 0.0 {
            small_patches += 1;
            small_area_mm2 += sloped.area;
        }
    }
    let slopes = by_class.iter().zip(SLOPES.windows(2)).map(|(sums, ends)| OfSlope {
        from_deg: ends[0],
        to_deg: ends[1],
        means: sums.means(),
    });
    Roughness {
        schema: SCHEMA,
        cell_mm: to_mm(map.grid.cell),
        layer_mm: lie.layer,
        window_layers: WINDOW,
        cutoff_mm: options.cutoff,
        moved_mm: lie.moved.map(rounded),
        lift_mm: rounded(lie.lift),
        whole: Sums::of(&by_class[1..]).means(),
        slopes: slopes.collect(),
        patches,
        small_patches,
        small_area_mm2,
    }
}

fn patch(map: &Map, samples: &[u32], lie: &Lie, found: &Found) -> OfPatch {
    let all = || samples.iter().map(|sample| &map.samples[*sample as usize]);
    let half = to_mm(map.grid.cell) / 2.0;
    let (mut low_mm, mut high_mm) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for sample in all() {
        let cell = sample.cell as usize;
        let [x, y] = [cell % map.grid.size[0], cell / map.grid.size[0]];
        let middle = |axis: usize, place: usize| {
            lie.origin[axis] + to_mm(map.grid.middle(axis, place).round() as i32)
        };
        let at = [middle(0, x), middle(1, y), to_mm(sample.z) + lie.lift];
        for axis in 0..3 {
            let half = if axis < 2 { half } else { 0.0 };
            low_mm[axis] = low_mm[axis].min(at[axis] - half);
            high_mm[axis] = high_mm[axis].max(at[axis] + half);
        }
    }
    OfPatch {
        low_mm,
        high_mm,
        steepest_deg: all().map(|sample| sample.slope()).fold(0.0, f64::max),
        direction_deg: found.direction,
        means: Sums::of(&found.sums[1..]).means(),
    }
}

/// A length to the nanometre, and no minus before a zero.
fn rounded(mm: f64) -> f64 {
    let rounded = (mm * 1e6).round() / 1e6;
    if rounded == 0.0 { 0.0 } else { rounded }
}
