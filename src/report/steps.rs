//! Written G-code -> StepsReport: how fast each motor has to step, beside what it can.

use crate::profile::Settings;
use crate::reader::Reading;
use crate::steps::{highest_rates, most_rates};
use schemars::JsonSchema;
use serde::Serialize;
use std::io::{self, BufRead};

/// How fast motors have to step for the file, its start and end blocks included.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, JsonSchema)]
pub struct StepsReport {
    /// The motor of x.
    pub x: MotorReport,
    /// The motor of y.
    pub y: MotorReport,
    /// The motor of z.
    pub z: MotorReport,
    /// The motor of the filament.
    pub e: MotorReport,
}

/// How fast one motor has to step.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, JsonSchema)]
pub struct MotorReport {
    /// Most steps a second, in the middle of a move at its highest speed.
    pub highest_rate_per_s: f64,
    /// Most steps a second that the motor can make.
    pub limit_per_s: f64,
    /// The former over the latter: above 1 the motor would lose steps.
    pub share: f64,
}

impl StepsReport {
    /// Of the G-code that was written with these settings; `None` where they do not say how far a step of
    /// all axes goes: then nothing is read.
    ///
    /// # Errors
    /// Only what reading the bytes gives.
    pub fn of_file(
        source: &mut dyn BufRead,
        reading: Reading,
        settings: &Settings,
    ) -> io::Result<Option<Self>> {
        let Some(limits) = most_rates(settings) else { return Ok(None) };
        let Some(rates) = highest_rates(source, reading, settings, false)? else { return Ok(None) };
        let motor = |axis: usize| MotorReport {
            highest_rate_per_s: rates[axis],
            limit_per_s: limits[axis],
            share: rates[axis] / limits[axis],
        };
        Ok(Some(Self { x: motor(0), y: motor(1), z: motor(2), e: motor(3) }))
    }

    /// The motors with the letters of their axes.
    #[must_use]
    pub fn motors(&self) -> [(char, MotorReport); 4] {
        [('x', self.x), ('y', self.y), ('z', self.z), ('e', self.e)]
    }
}
