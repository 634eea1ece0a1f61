//! Settings -> what follows from them together: sizes and counts that no single key holds.
//!
//! - An unset key that means another one is looked up here, and nowhere else.
//! - The *volume* is where parts may lie, the *reach* where the nozzle may go.
//! - The *stretch* is by how much models are printed larger, since the material shrinks.
//! - The *head* is the named one, with what else its keys say.
//! - The *ratio* is how many layers dual injection prints at once, with `auto` as many as pay.
//!
//! All of it depends on the settings alone, never on a model.

use super::{BrimPlace, DualRatio, Extrusion, ExtrusionModel, Machine, Origin, Pattern, Settings};
use crate::head::Head;
use std::f64::consts::PI;

/// Slack for comparing lengths that were written as decimals, mm.
const SLACK_MM: f64 = 1e-9;

/// No print is as slow as this on purpose, mm/s: who asks for less has another unit in mind.
const SLOW_MM_S: f64 = 2.0;

/// Densities from which lines that cross on a layer leave no room for each other, %. Where they cross they lie
/// twice; beside that shafts stay open: of a grid of 100 % a quarter.
const MOST_CROSSED: f64 = 90.0;

impl Machine {
    /// The lowest and the highest corner of the print volume, where parts may lie, mm.
    #[must_use]
    pub fn volume(&self) -> [[f64; 3]; 2] {
        let (width, depth, height) = (self.bed_width, self.bed_depth, self.bed_height);
        match self.origin {
            Origin::Centre => {
                let (x, y) = (width / 2.0, depth / 2.0);
                [[-x, -y, 0.0], [x, y, height]]
            }
            Origin::FrontLeft => [[0.0; 3], [width, depth, height]],
        }
    }

    /// The lowest and the highest corner of where the nozzle may go, mm.
    #[must_use]
    pub fn nozzle_reach(&self) -> [[f64; 3]; 2] {
        let reach = &self.reach;
        let low = [reach.min_x, reach.min_y, reach.min_z];
        let high = [reach.max_x, reach.max_y, reach.max_z];
        let [from, to] = self.volume();
        let or = |set: [Option<f64>; 3], volume: [f64; 3]| {
            [0, 1, 2].map(|axis| set[axis].unwrap_or(volume[axis]))
        };
        [or(low, from), or(high, to)]
    }
}

impl Extrusion {
    /// How much of the box around a line, its width times its height, is plastic by the model.
    ///
    /// An ellipse fills π/4 of it. It is the section of a strand that is laid down rather than pressed flat, so
    /// that it touches what lies beside and below it, and leaves the corners between open: where width and
    /// height are the same, the round strand that leaves the nozzle. Of other ratios it is still π/4, so
    /// that lines of two layers at once take the plastic of two, and lines that share a place that of the
    /// place. A line much wider than high is pressed flat, and takes more: that is what `area` is for.
    #[must_use]
    pub fn section(&self) -> f64 {
        match self.model {
            ExtrusionModel::Round => PI / 4.0,
            ExtrusionModel::Area | ExtrusionModel::Factor => 1.0,
        }
    }
}

impl Settings {
    /// The pattern of the infill that is printed: lines in one direction on each layer where the one asked for
    /// cannot be as dense as it should be.
    #[must_use]
    pub fn printed_pattern(&self) -> Pattern {
        match self.pattern {
            Pattern::Grid | Pattern::Triangles if self.infill >= MOST_CROSSED => {
                Pattern::Rectilinear
            }
            asked => asked,
        }
    }

    /// Solid layers at the top, at least; the thickness may ask for more.
    #[must_use]
    pub fn top_skins(&self) -> u32 {
        self.top_layers.unwrap_or(self.skin_layers)
    }

    /// Whether tops are closed by skin.
    #[must_use]
    pub fn has_top_skins(&self) -> bool {
        self.top_skins() > 0 || self.top_thickness > 0.0
    }

    /// Whether bottoms are closed by skin.
    #[must_use]
    pub fn has_bottom_skins(&self) -> bool {
        self.bottom_skins() > 0 || self.bottom_thickness > 0.0
    }

    /// Solid layers at the bottom, at least; the thickness may ask for more.
    #[must_use]
    pub fn bottom_skins(&self) -> u32 {
        self.bottom_layers.unwrap_or(self.skin_layers)
    }

    /// These settings with the lines of the first layer; `None` if they are as wide as all others.
    #[must_use]
    pub fn in_first_width(&self) -> Option<Self> {
        // A raft has widths of its own, and no line of the part lies on the bed.
        let wide = self.first_layer_width.filter(|_| !self.raft.enabled)?;
        if (wide - self.line_width).abs() <= SLACK_MM {
            return None;
        }
        // Nothing is known of what stands on it there: its tops keep their walls.
        Some(Self { line_width: wide, top_one_wall: false, ..self.clone() })
    }

    /// Temperature of the nozzle on the first layer, °C.
    #[must_use]
    pub fn first_temperature(&self) -> f64 {
        self.filament.first_layer_temperature.unwrap_or(self.filament.temperature)
    }

    /// Temperature of the bed on the first layer, °C.
    #[must_use]
    pub fn first_bed_temperature(&self) -> f64 {
        self.filament.first_layer_bed_temperature.unwrap_or(self.filament.bed_temperature)
    }

    /// Layers of the raft; 0 without one.
    #[must_use]
    pub fn raft_layers(&self) -> usize {
        if self.raft.enabled { 1 + self.raft.interface_layers as usize } else { 0 }
    }

    /// From the bed to the bottom of the part, mm: the raft and the gap above it; 0 without one.
    #[must_use]
    pub fn raft_lift(&self) -> f64 {
        let raft = &self.raft;
        let interface = f64::from(raft.interface_layers) * raft.interface_height;
        if raft.enabled { raft.base_height + interface + raft.gap } else { 0.0 }
    }

    /// How far the raft reaches beyond what stands on it, mm; 0 without one. A margin narrower than
    /// a line of its base would leave thin parts without any.
    #[must_use]
    pub fn raft_reach(&self) -> f64 {
        if self.raft.enabled { self.raft.margin.max(self.raft.base_width) } else { 0.0 }
    }

    /// How far the part's first layer is drawn in, mm: on a raft nothing presses it wide.
    #[must_use]
    pub fn foot_drawn_in(&self) -> f64 {
        if self.raft.enabled { 0.0 } else { self.elephant_foot }
    }

    /// How far a brim that is asked for reaches beyond its part, mm; 0 where none is printed, or only
    /// where it is needed.
    #[must_use]
    pub fn brim_reach(&self) -> f64 {
        match self.brim.place {
            _ if self.raft.enabled => 0.0,
            BrimPlace::Outside | BrimPlace::Both => self.brim.gap + self.brim.width,
            BrimPlace::Auto | BrimPlace::Off | BrimPlace::Inside => 0.0,
        }
    }

    /// How far a skirt reaches beyond what it goes around, mm; 0 without one.
    #[must_use]
    pub fn skirt_reach(&self) -> f64 {
        let width = f64::from(self.skirt.loops) * self.line_width;
        if self.skirt.loops > 0 { self.skirt.distance + width } else { 0.0 }
    }

    /// The head: the named one, with what else is said of it.
    #[must_use]
    pub fn head(&self) -> Head {
        let (keys, named) = (&self.head, self.head.name.head());
        Head {
            flat: keys.flat.unwrap_or(named.flat),
            cone: keys.cone.unwrap_or(named.cone),
            cone_length: keys.cone_length.unwrap_or(named.cone_length),
            discs: keys.discs.clone().unwrap_or(named.discs),
            boxes: keys.boxes.clone().unwrap_or(named.boxes),
        }
    }

    /// The steepest slope that skins can follow, degrees: that of the head, or that on which the flat's uphill
    /// edge presses one layer deep into the skin. Boxes may allow less where a surface reaches them.
    #[must_use]
    pub fn steepest_skin(&self) -> f64 {
        let head = self.head();
        head.steepest().min(head.steepest_press(self.layer_height))
    }

    /// Print speeds that are so slow, in mm/s, that they are hardly meant: key and value.
    #[must_use]
    pub fn slow_speeds(&self) -> Vec<(&'static str, f64)> {
        let speed = &self.speed;
        let mut speeds = vec![
            ("speed.wall", speed.wall),
            ("speed.skin", speed.skin),
            ("speed.bridge", speed.bridge),
            ("speed.infill", speed.infill),
            ("speed.thick_infill", speed.thick_infill),
            ("speed.support", speed.support),
        ];
        let own = [
            ("speed.outer_wall", speed.outer_wall),
            ("speed.inner_wall", speed.inner_wall),
            ("speed.top_skin", speed.top_skin),
            ("speed.gap", speed.gap),
        ];
        speeds.extend(own.into_iter().filter_map(|(key, speed)| Some((key, speed?))));
        if self.nonplanar.enabled {
            speeds.push(("speed.nonplanar", speed.nonplanar));
        }
        if self.raft.enabled {
            speeds.push(("speed.raft_base", speed.raft_base));
            speeds.push(("speed.raft_interface", speed.raft_interface));
        }
        speeds.retain(|(_, speed)| *speed < SLOW_MM_S);
        speeds
    }

    /// Factors on x, y and z by which models are printed larger, since they shrink: what is left of
    /// 100 % is to be the model's size.
    #[must_use]
    pub fn stretch(&self) -> [f64; 3] {
        let factor = |percent: f64| 100.0 / (100.0 - percent);
        let (flat, up) = (self.filament.shrinkage, self.filament.shrinkage_z);
        [factor(flat), factor(flat), factor(up)]
    }

    /// The most plastic that the hot end melts of this material, mm³/s.
    #[must_use]
    pub fn max_volumetric_speed(&self) -> f64 {
        let machine = self.machine.max_volumetric_speed;
        self.filament.max_volumetric_speed.map_or(machine, |material| machine.min(material))
    }

    /// The cross-section of the filament, mm².
    #[must_use]
    pub fn filament_area(&self) -> f64 {
        PI * self.filament.diameter * self.filament.diameter / 4.0
    }

    /// Acceleration of the filament when it moves alone, mm/s². Where the key is 0, what Klipper takes
    /// without `max_extrude_only_accel`: the nozzle's acceleration in its configuration, times the
    /// largest line that it allows (`max_extrude_cross_section`, 4 nozzle²), over the filament's area
    /// (klippy/kinematics/extruder.py). Commands in a file do not change it.
    #[must_use]
    pub fn retract_acceleration(&self) -> f64 {
        let (limits, nozzle) = (&self.limits, self.machine.nozzle_diameter);
        if limits.retract_acceleration > 0.0 {
            return limits.retract_acceleration;
        }
        let configured = limits.acceleration_x.min(limits.acceleration_y);
        configured * 4.0 * nozzle * nozzle / self.filament_area()
    }

    /// The tallest line that dual injection may print, mm.
    #[must_use]
    pub fn max_bead_height(&self) -> f64 {
        self.dual.max_bead_height / 100.0 * self.machine.nozzle_diameter
    }

    /// How many layers dual injection prints at once: as asked for, or with `auto` as many
    /// as pay. Those are no more than the tallest line has, and no more than bring thick
    /// lines to the hot end's limit: beyond it they would only be laid more slowly. Less
    /// than 2 means that nothing can be doubled.
    #[must_use]
    pub fn dual_ratio(&self) -> u32 {
        match self.dual.ratio {
            DualRatio::Layers(layers) => layers,
            DualRatio::Auto(_) => {
                let tall = ((self.max_bead_height() + SLACK_MM) / self.layer_height).floor();
                let melts = (self.max_volumetric_speed() / self.layer_flow()).ceil();
                tall.min(melts.max(2.0)) as u32
            }
        }
    }

    /// What each layer adds to the flow of thick infill at its feed, mm³/s.
    fn layer_flow(&self) -> f64 {
        let extrusion = &self.extrusion;
        let area = match extrusion.model {
            ExtrusionModel::Area | ExtrusionModel::Round => {
                self.line_width * self.layer_height * extrusion.section()
            }
            ExtrusionModel::Factor => {
                let width = self.line_width / extrusion.factor_width;
                let height = self.layer_height / extrusion.factor_height;
                extrusion.infill_factor * self.filament_area() * width * height
            }
        };
        extrusion.multiplier * area * self.speed.thick_infill
    }
}

#[cfg(test)]
mod tests {
    use crate::profile::{Override, ValueOrigin, load};

    /// The ratio that `auto` comes to.
    fn auto(profile: &str, set: &[(&str, &str)]) -> u32 {
        let given = |(key, value): &(&str, &str)| Override {
            key: (*key).to_owned(),
            value: (*value).to_owned(),
            origin: ValueOrigin::Set,
        };
        let mut overrides: Vec<Override> = set.iter().map(given).collect();
        overrides.push(given(&("dual.ratio", "auto")));
        load([profile], &overrides).unwrap().settings.dual_ratio()
    }

    #[test]
    fn auto_is_as_many_layers_as_the_tallest_line_has() {
        assert_eq!(auto("generic-marlin", &[]), 2);
        assert_eq!(auto("generic-marlin", &[("layer_height", "0.1")]), 4);
        assert_eq!(auto("generic-marlin", &[("layer_height", "0.15")]), 2);
        let lower = [("layer_height", "0.1"), ("dual.max_bead_height", "80")];
        assert_eq!(auto("generic-marlin", &lower), 3);
    }

    #[test]
    fn auto_stops_where_more_layers_only_mean_slower_lines() {
        // 0.4 mm x 0.1 mm x 60 mm/s are 2.4 mm³/s a layer.
        let slow = [("layer_height", "0.1"), ("machine.max_volumetric_speed", "6")];
        assert_eq!(auto("generic-marlin", &slow), 3);
        let slower = [("layer_height", "0.1"), ("machine.max_volumetric_speed", "2")];
        assert_eq!(auto("generic-marlin", &slower), 2);
        // The thesis's factor: 0.04 mm of 1.75 mm filament at 60 mm/s are 5.8 mm³/s a layer.
        assert_eq!(auto("zcube-dual", &[]), 2);
    }
}
