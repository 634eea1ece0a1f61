//! Settings and a file's own comments -> Terms: what a file is judged by.

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
    /// Diameter of the nozzle, mm, if it is known.
    pub nozzle: Option<f64>,
    /// How far the file's own settings move contours: outlines, holes, the first layer; mm.
    pub moved: [f64; 3],
    /// How far a raft lifts the part by settings of the file's own, mm; 0 without one.
    pub lift: Option<f64>,
    /// Density of the sparse infill asked for, as a part of 1, if it is known.
    pub infill: Option<f64>,
}

/// What a machine can do.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Machine {
    /// Its firmware.
    pub dialect: DialectName,
    /// The lowest and the highest corner of the print volume, where lines may lie, mm.
    pub volume: [[f64; 3]; 2],
    /// The lowest and the highest corner of where the nozzle may go, mm.
    pub reach: [[f64; 3]; 2],
    /// Highest speeds in x, y, z and of the filament, mm/s.
    pub speed: [f64; 4],
    /// Plastic that it melts, mm³/s.
    pub flow: f64,
}

/// Keys under which slicers write the nozzle's diameter, mm; with several tools a list.
const NOZZLE_KEYS: &[&str] = &["nozzle_diameter"];

/// Keys under which slicers write the density of infill, %.
const DENSITY_KEYS: &[&str] = &["infill", "fill_density", "sparse_infill_density"];

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
            moved: own.map_or([0.0; 3], |own| {
                [own.xy_compensation.abs(), own.hole_compensation.abs(), own.foot_drawn_in()]
            }),
            nozzle: own.map(of).or_else(nozzle).or_else(|| settings.map(of)),
            lift: own.map(Settings::raft_lift),
            infill: by_file(),
        }
    }

    /// How far the outline of a layer that begins at this height may lie from the model's, mm.
    pub(super) fn moved_at(&self, bottom: f64) -> f64 {
        let [outline, hole, foot] = self.moved;
        outline.max(hole) + (foot - bottom).max(0.0)
    }

    /// Width of a box of a line's height and plastic, mm, whatever the file says.
    pub(super) fn box_width(&self, step: &Step) -> f64 {
        let room = step.length() * f64::from(step.height);
        f64::from(step.filament) * self.filament_area / room
    }

    /// A line's plastic, mm³, less what settings make of it on purpose.
    pub(super) fn plastic(&self, step: &Step) -> f64 {
        let flow = match step.role {
            Role::OuterWall | Role::InnerWall => self.flow[0],
            Role::Skin | Role::Ironing => self.flow[1],
            Role::Infill => self.flow[2],
            _ => 1.0,
        };
        f64::from(step.filament) * self.filament_area / flow
    }
}

/// See [`Terms::flow`].
fn flow(own: &Settings) -> [f64; 3] {
    let extrusion = &own.extrusion;
    let room = extrusion.factor_width * extrusion.factor_height;
    [extrusion.wall_factor, extrusion.skin_factor, extrusion.infill_factor].map(|factor| {
        let by_size = match extrusion.model {
            ExtrusionModel::Area => 1.0,
            ExtrusionModel::Factor => factor * own.filament_area() / room,
        };
        by_size * extrusion.multiplier
    })
}

impl Machine {
    fn new(settings: &Settings) -> Self {
        let machine = &settings.machine;
        let limits = &settings.limits;
        Self {
            dialect: machine.dialect,
            volume: machine.volume(),
            reach: machine.nozzle_reach(),
            speed: [limits.speed_x, limits.speed_y, limits.speed_z, limits.speed_e],
            flow: settings.max_volumetric_speed(),
        }
    }
}
