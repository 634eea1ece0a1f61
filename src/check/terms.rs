//! Settings and a file's own comments -> Terms: what a file is judged by.
//!
//! Words used here: the *machine* is that of a profile, or of the file's own settings; *own* settings are
//! those that this program writes into its files; *keys* are names under which slicers write settings as
//! comments `key = value`.
//!
//! What own settings say counts. Of other slicers' files the comments are read that tell the nozzle, the
//! infill, the material and its temperatures; a list has an entry for each tool, and the first counts. What
//! nobody tells is `None`, empty, or a value that accuses no file.

use super::asked::Asked;
use crate::head::{Head, named};
use crate::profile::{DialectName, ExtrusionModel, Settings};
use crate::reader::print::Step;
use crate::reader::{Facts, Role};
use std::f64::consts::PI;

/// What a file is judged by.
#[derive(Debug, Clone, PartialEq)]
pub struct Terms {
    /// The machine, if one is known.
    pub machine: Option<Machine>,
    /// Cross-section of the filament, mm².
    pub filament_area: f64,
    /// Whether the file is one of this program's, whose rules for faces at the height of a cut are known.
    pub is_own: bool,
    /// How much more plastic than width times height lines take by settings of the file's own:
    /// walls, skins, sparse infill.
    pub flow: [f64; 3],
    /// How much of the box around a line is plastic by settings of the file's own, whatever its role.
    pub section: f64,
    /// Plastic of the layer on the bed by settings of the file's own, 1 if it is as much as on others.
    pub pressed: f64,
    /// Whether bottoms and tops are closed by skin, as far as the file's own settings go.
    pub closes: [bool; 2],
    /// Whether walls close outlines, as far as the file's own settings go.
    pub has_walls: bool,
    /// Diameter of the nozzle, mm, if it is known.
    pub nozzle: Option<f64>,
    /// What hangs around the nozzle, if somebody tells it.
    pub head: Option<Head>,
    /// How far the file's own settings move contours: outlines, holes, the first layer; mm.
    pub moved: [f64; 3],
    /// How far a raft lifts the part by settings of the file's own, mm; 0 without one.
    pub lift: Option<f64>,
    /// Density of the sparse infill asked for, as a part of 1, if it is known.
    pub infill: Option<f64>,
    /// The factor on all plastic by settings of the file's own, 1 without any.
    pub multiplier: f64,
    /// Name of the material, such as PLA, if the file tells it.
    pub material: Option<String>,
    /// Temperatures that the file's own settings name, °C: of the nozzle, of the bed.
    pub named: [Vec<f64>; 2],
    /// How many tools the file was made for, if it tells.
    pub tools: Option<u32>,
    /// Speeds, accelerations and jerks that the file's own settings name.
    pub(super) asked: Asked,
    /// The least power of the part cooling fan by settings of the file's own, %, and the last layer, from
    /// 1, on which it may be less.
    pub fan: Option<(f64, usize)>,
}

/// What a machine can do.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Machine {
    /// Its firmware.
    pub dialect: DialectName,
    /// Number of the tool that prints.
    pub tool: u32,
    /// The lowest and the highest corner of the print volume, where lines may lie, mm.
    pub volume: [[f64; 3]; 2],
    /// The lowest and the highest corner of where the nozzle may go, mm.
    pub reach: [[f64; 3]; 2],
    /// Highest speeds in x, y, z and of the filament, mm/s.
    pub speed: [f64; 4],
    /// Highest accelerations likewise, mm/s².
    pub acceleration: [f64; 4],
    /// Jerks likewise, mm/s.
    pub jerk: [f64; 4],
    /// Plastic that it melts, mm³/s.
    pub flow: f64,
    /// Of motors whose rate is known: steps for a mm, and most steps a second; x, y, z, filament.
    pub steps: [Option<[f64; 2]>; 4],
}

/// A line whose underside is lower than this lies on the bed, mm.
const ON_BED: f64 = 0.02;

/// Keys under which slicers write the nozzle's diameter, mm; with several tools a list.
const NOZZLE_KEYS: &[&str] = &["nozzle_diameter"];

/// Keys under which slicers write the density of infill, %.
const DENSITY_KEYS: &[&str] = &["infill", "fill_density", "sparse_infill_density"];

/// Keys under which slicers write the material's name; with several tools a list.
const MATERIAL_KEYS: &[&str] = &["filament_type"];

/// Keys under which slicers write temperatures of the nozzle and of the bed, °C; lists likewise.
const NOZZLE_HEATS: &[&str] = &[
    "temperature",
    "first_layer_temperature",
    "nozzle_temperature",
    "nozzle_temperature_initial_layer",
    "material_print_temperature",
];
const BED_HEATS: &[&str] = &[
    "bed_temperature",
    "first_layer_bed_temperature",
    "hot_plate_temp",
    "hot_plate_temp_initial_layer",
    "textured_plate_temp",
    "textured_plate_temp_initial_layer",
    "material_bed_temperature",
];

impl Terms {
    /// The machine of `settings`, the settings that the file was made with (`own`, if it is one of
    /// this program's), and else what the file's comments hold.
    #[must_use]
    pub fn new(settings: Option<&Settings>, own: Option<&Settings>, print: &Facts) -> Self {
        let diameter = print.filament_diameter;
        let by_file = || {
            let text = DENSITY_KEYS.iter().find_map(|key| print.value(key))?;
            let percent: f64 = text.trim_end_matches('%').trim().parse().ok()?;
            (percent.is_finite() && percent >= 0.0).then_some(percent / 100.0)
        };
        let of = |settings: &Settings| settings.machine.nozzle_diameter;
        let nozzle = || {
            let text = NOZZLE_KEYS.iter().find_map(|key| print.value(key))?;
            let first: f64 = text.split([',', ';']).next()?.trim().parse().ok()?;
            (first > 0.0).then_some(first)
        };
        Self {
            machine: settings.map(Machine::new),
            filament_area: PI * diameter * diameter / 4.0,
            is_own: own.is_some(),
            flow: own.map_or([1.0; 3], flow),
            section: own.map_or(1.0, |own| own.extrusion.section()),
            pressed: own.map_or(1.0, |own| own.extrusion.first_layer / 100.0),
            closes: own.map_or([true; 2], |own| [own.has_bottom_skins(), own.has_top_skins()]),
            has_walls: own.is_none_or(|own| own.walls > 0),
            head: head(settings, own),
            moved: own.map_or([0.0; 3], |own| {
                [own.xy_compensation.abs(), own.hole_compensation.abs(), own.foot_drawn_in()]
            }),
            nozzle: own.map(of).or_else(nozzle).or_else(|| settings.map(of)),
            lift: own.map(Settings::raft_lift),
            infill: by_file(),
            asked: Asked::new(own, print),
            fan: own.filter(|own| !own.raft.enabled).map(fan),
            multiplier: own.map_or(1.0, |own| own.extrusion.multiplier),
            material: material(own, print),
            named: named(own, print),
            tools: NOZZLE_KEYS.iter().find_map(|key| print.value(key)).map(count),
        }
    }

    /// How far the outline of a layer that begins at this height may lie from the model's, mm.
    pub(super) fn moved_at(&self, bottom: f64) -> f64 {
        let [outline, hole, foot] = self.moved;
        outline.max(hole) + (foot - bottom).max(0.0)
    }

    /// Width of a line by its height and plastic, mm, whatever the file says of it: of a box, or of an ellipse if
    /// its own settings make round strands.
    pub(super) fn width_by_plastic(&self, step: &Step) -> f64 {
        let room = step.plan_length() * f64::from(step.height);
        f64::from(step.filament) * self.filament_area / (room * self.section)
    }

    /// How many times as much plastic as others of its size a line gets since it lies on the bed.
    pub(super) fn pressed(&self, step: &Step) -> f64 {
        let is_low = step.heights()[0] - f64::from(step.height) < ON_BED;
        if is_low { self.pressed } else { 1.0 }
    }

    /// A line's plastic, mm³, less what settings make of it on purpose.
    pub(super) fn plastic(&self, step: &Step) -> f64 {
        let flow = match step.role {
            Role::OuterWall | Role::InnerWall => self.flow[0],
            Role::Skin | Role::Ironing | Role::NonPlanar => self.flow[1],
            Role::Infill => self.flow[2],
            _ => self.section,
        };
        f64::from(step.filament) * self.filament_area / (flow * self.pressed(step))
    }
}

/// See [`Terms::head`]: that of the machine, or else the one that the file was made for. What a profile that
/// tells none is given for the sake of caution accuses no other's file.
fn head(settings: Option<&Settings>, own: Option<&Settings>) -> Option<Head> {
    let told = settings.map(Settings::head).filter(|head| *head != named::cautious());
    told.or_else(|| own.map(Settings::head))
}

/// See [`Terms::fan`].
fn fan(own: &Settings) -> (f64, usize) {
    let (cooling, filament) = (&own.cooling, &own.filament);
    let others =
        [cooling.min_fan, Some(cooling.bridge_fan), cooling.overhang_fan, cooling.interface_fan];
    let least = others.into_iter().flatten().fold(filament.fan, f64::min);
    (least, filament.fan_from_layer.max(cooling.fan_full_from_layer) as usize)
}

/// See [`Terms::material`].
fn material(own: Option<&Settings>, print: &Facts) -> Option<String> {
    let by_file = || {
        let text = MATERIAL_KEYS.iter().find_map(|key| print.value(key))?;
        let first = text.split([',', ';']).next()?.trim().trim_matches('"');
        (!first.is_empty()).then(|| first.to_owned())
    };
    own.map(|own| own.filament.name.clone()).or_else(by_file)
}

/// See [`Terms::named`].
fn named(own: Option<&Settings>, print: &Facts) -> [Vec<f64>; 2] {
    let Some(own) = own else {
        return [NOZZLE_HEATS, BED_HEATS].map(|keys| {
            let texts = keys.iter().filter_map(|key| print.value(key));
            texts.flat_map(|text| text.split([',', ';'])).filter_map(celsius).collect()
        });
    };
    let filament = &own.filament;
    let of = |first: Option<f64>, usual: f64| first.into_iter().chain([usual]).collect();
    [
        of(filament.first_layer_temperature, filament.temperature),
        of(filament.first_layer_bed_temperature, filament.bed_temperature),
    ]
}

fn celsius(text: &str) -> Option<f64> {
    text.trim().parse().ok().filter(|celsius: &f64| celsius.is_finite())
}

/// How many entries a list has.
fn count(text: &str) -> u32 {
    u32::try_from(text.split([',', ';']).count()).unwrap_or(u32::MAX)
}

/// See [`Terms::flow`].
fn flow(own: &Settings) -> [f64; 3] {
    let extrusion = &own.extrusion;
    let room = extrusion.factor_width * extrusion.factor_height;
    [extrusion.wall_factor, extrusion.skin_factor, extrusion.infill_factor].map(|factor| {
        let by_size = match extrusion.model {
            ExtrusionModel::Area | ExtrusionModel::Round => extrusion.section(),
            ExtrusionModel::Factor => factor * own.filament_area() / room,
        };
        by_size * extrusion.multiplier
    })
}

impl Machine {
    fn new(settings: &Settings) -> Self {
        let machine = &settings.machine;
        let limits = &settings.limits;
        let steps = &settings.steps;
        let motor = |per_mm: Option<f64>, rate: Option<f64>| Some([per_mm?, rate?]);
        Self {
            steps: [
                motor(steps.x, steps.rate_x),
                motor(steps.y, steps.rate_y),
                motor(steps.z, steps.rate_z),
                motor(steps.e, steps.rate_e),
            ],
            dialect: machine.dialect,
            tool: machine.tool,
            volume: machine.volume(),
            reach: machine.nozzle_reach(),
            speed: [limits.speed_x, limits.speed_y, limits.speed_z, limits.speed_e],
            acceleration: [
                limits.acceleration_x.max(machine.acceleration),
                limits.acceleration_y.max(machine.acceleration),
                limits.acceleration_z,
                limits.acceleration_e.max(limits.retract_acceleration),
            ],
            jerk: [limits.jerk_x, limits.jerk_y, limits.jerk_z, limits.jerk_e],
            flow: settings.max_volumetric_speed(),
        }
    }
}
