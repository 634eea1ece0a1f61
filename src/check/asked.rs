//! Settings of a file -> Asked: speeds, accelerations and jerks that they name.
//!
//! This program's own keys are known, of other slicers' the words that they use: `machine_max_feedrate_x`,
//! `outer_wall_acceleration`, `default_jerk`. Lists have an entry for each tool; parts in percent are left out.

use crate::profile::{Settings, values};
use crate::reader::{Facts, Limit, Told};

/// Values that differ by less are the same: parts of the value, and decimals of a file.
pub(super) const SAME: f64 = 0.01;
const ROUNDING: f64 = 0.01;

/// Marlin's formula: junction deviation, mm, is this times jerk² over acceleration; and what its M205 takes.
const DEVIATION: f64 = 0.4;
const DEVIATIONS: [f64; 2] = [0.01, 0.3];

/// Values that a file's own settings name.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Asked {
    speeds: Vec<f64>,
    accelerations: Vec<f64>,
    corners: Vec<f64>,
}

impl Asked {
    /// Of the settings that an own file was made with, else of the comments of a file.
    pub(super) fn new(own: Option<&Settings>, facts: &Facts) -> Self {
        let mut asked = Self::default();
        match own.map(values) {
            Some(own) => own.iter().for_each(|(key, value)| asked.add(key, value)),
            None => facts.values.iter().for_each(|(key, value)| asked.add(key, value)),
        }
        if own.is_some() {
            let Self { accelerations, corners, .. } = &asked;
            let by = |jerk: &f64| {
                let square = DEVIATION * jerk * jerk;
                accelerations
                    .iter()
                    .map(move |by| (square / by).clamp(DEVIATIONS[0], DEVIATIONS[1]))
            };
            let deviations: Vec<f64> = corners.iter().flat_map(by).collect();
            asked.corners.extend(deviations);
        }
        asked
    }

    fn add(&mut self, key: &str, value: &str) {
        let has = |words: &[&str]| words.iter().any(|word| key.contains(word));
        let list = if has(&["jerk", "junction", "corner", "cruise"]) {
            &mut self.corners
        } else if has(&["acceleration"]) {
            &mut self.accelerations
        } else if has(&["limits.speed", "feedrate", "velocity"]) {
            &mut self.speeds
        } else {
            return;
        };
        let numbers = value.split([',', ';']).filter_map(|text| text.trim().parse::<f64>().ok());
        list.extend(numbers.filter(|number| number.is_finite()));
    }

    /// Whether a value is asked for.
    pub(super) fn has(&self, told: &Told) -> bool {
        let list = match told.limit {
            Limit::Speed(_) => &self.speeds,
            Limit::Jerk(_) | Limit::Deviation | Limit::Corner | Limit::Cruise => &self.corners,
            _ => &self.accelerations,
        };
        let near = |one: &f64| (one - told.value).abs() <= SAME * told.value.abs() + ROUNDING;
        list.iter().any(near)
    }
}
