//! Layer + its time + role -> power of the part cooling fan.
//!
//! The *usual* power of a layer holds for all of it but the roles that have their own. It rises over
//! the first layers with the fan on, where the bed keeps the part warm, and goes by the time that
//! the layers of a group take: a quick layer below a slow one gets the same air as that.

use crate::fill::RoleTable;
use crate::profile::{DialectName, Settings};

/// How the fan is run.
#[derive(Debug, Clone)]
pub(super) struct FanParams {
    /// Power on quick layers, %.
    most: f64,
    /// Power on slow layers, %, and what quick and slow mean, s; none if no time changes it.
    least: Option<(f64, [f64; 2])>,
    /// First layer with the fan on, counted from 0.
    from: usize,
    /// First layer with its whole power.
    full: usize,
    /// The part's first layer on a raft and its power, %, which is that of support next to the part.
    on_raft: Option<(usize, f64)>,
    /// Roles with a power of their own, %.
    roles: RoleTable<Option<f64>>,
    /// The machine knows on and off only.
    switches: bool,
}

/// The fan before a layer and on it, %; none while it is off.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Fan {
    /// As the layer before has left it.
    pub before: Option<f64>,
    /// Where no role asks for another.
    pub usual: Option<f64>,
}

impl FanParams {
    pub(super) fn new(settings: &Settings) -> Self {
        let (cooling, filament) = (&settings.cooling, &settings.filament);
        let least = cooling.min_fan.filter(|&least| least < filament.fan);
        Self {
            most: filament.fan,
            least: least.map(|least| (least, [cooling.max_fan_time, cooling.min_fan_time])),
            from: filament.fan_from_layer.max(1) as usize - 1,
            full: cooling.fan_full_from_layer.max(1) as usize - 1,
            on_raft: cooling
                .interface_fan
                .filter(|_| settings.raft.enabled)
                .map(|power| (settings.raft_layers(), power)),
            roles: RoleTable::new(|role| (role.facts().fan)(cooling)),
            switches: settings.machine.dialect == DialectName::Makerbot,
        }
    }

    /// Whether the power depends on what layers take.
    pub(super) fn goes_by_time(&self) -> bool {
        self.least.is_some()
    }

    /// The usual power on a layer, counted from 0, of a group whose layers take `seconds`; none
    /// while the fan is off altogether.
    pub(super) fn usual(&self, layer: usize, seconds: Option<f64>) -> Option<f64> {
        if layer < self.from {
            return None;
        }
        if let Some((_, power)) = self.on_raft.filter(|(first, _)| *first == layer) {
            return Some(power);
        }
        let power = match (self.least, seconds) {
            (Some((least, [quick, slow])), Some(seconds)) => {
                let share = if seconds <= quick {
                    0.0
                } else if seconds >= slow {
                    1.0
                } else {
                    (seconds - quick) / (slow - quick)
                };
                self.most - share * (self.most - least)
            }
            _ => self.most,
        };
        // The layers from the first with the fan on to the first with all of it, both counted.
        let steps = (self.full + 1).saturating_sub(self.from).max(1);
        let step = (layer - self.from + 1).min(steps);
        Some(power * step as f64 / steps as f64)
    }

    /// The powers of roles that have their own, %.
    pub(super) fn roles(&self) -> &RoleTable<Option<f64>> {
        &self.roles
    }

    /// Whether the machine does another thing at `b` % than at `a` %.
    pub(super) fn differ(&self, a: f64, b: f64) -> bool {
        if self.switches { (a > 0.0) != (b > 0.0) } else { (a - b).abs() > f64::EPSILON }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::profile::{Override, ValueOrigin, load};

    fn params(profile: &str, set: &[(&str, &str)]) -> FanParams {
        let given = |(key, value): &(&str, &str)| Override {
            key: (*key).to_owned(),
            value: (*value).to_owned(),
            origin: ValueOrigin::Set,
        };
        let overrides: Vec<Override> = set.iter().map(given).collect();
        FanParams::new(&load([profile], &overrides).unwrap().settings)
    }

    #[test]
    fn the_fan_is_off_then_rises_then_stays() {
        let powers = |set: &[(&str, &str)]| {
            let fan = params("generic-marlin", set);
            [0, 1, 2, 3, 4, 90].map(|layer| fan.usual(layer, None).map(f64::round))
        };
        let full = Some(100.0);
        assert_eq!(powers(&[]), [None, Some(33.0), Some(67.0), full, full, full]);
        let at_once = [("cooling.fan_full_from_layer", "1"), ("filament.fan_from_layer", "3")];
        assert_eq!(powers(&at_once), [None, None, full, full, full, full]);
    }

    #[test]
    fn the_longer_a_layer_takes_the_less_air_it_gets() {
        let fan = params("generic-marlin", &[("filament.fan", "80"), ("cooling.min_fan", "30")]);
        let power = |seconds| fan.usual(9, Some(seconds)).unwrap();
        assert_eq!([0.0, 10.0, 35.0, 60.0, 999.0].map(power), [80.0, 80.0, 55.0, 30.0, 30.0]);
        assert!(!params("generic-marlin", &[]).goes_by_time());
        // Times in the wrong order are a step.
        let set = [
            ("cooling.min_fan", "30"),
            ("cooling.max_fan_time", "60"),
            ("cooling.min_fan_time", "20"),
        ];
        let fan = params("generic-marlin", &set);
        assert_eq!(
            [20.0, 60.0, 61.0].map(|s| fan.usual(9, Some(s)).unwrap()),
            [100.0, 100.0, 30.0]
        );
    }
}
