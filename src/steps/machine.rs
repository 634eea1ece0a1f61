//! Settings -> Machine: a board and its motors, as a stream of steps is made for it.

use super::axis::{AXES, LETTERS, STEP, Scale};
use crate::profile::error::Conflict;
use crate::profile::{ProfileError, Settings};

/// Microseconds in a second.
const SECOND: f64 = 1e6;

/// Most steps a second that the motor of each axis can make: `steps.rate_x` …, or what the axis's own speed
/// makes, and no more than pulses fit. `None` where the settings do not say how far a step of all axes goes.
#[must_use]
pub fn most_rates(settings: &Settings) -> Option<[f64; AXES]> {
    let (steps, limits) = (&settings.steps, &settings.limits);
    let per_mm = per_mm(settings)?;
    let speeds = [limits.speed_x, limits.speed_y, limits.speed_z, limits.speed_e];
    let rates = [steps.rate_x, steps.rate_y, steps.rate_z, steps.rate_e];
    let by_pulse = SECOND / f64::from(2 * steps.pulse);
    Some(std::array::from_fn(|axis| {
        rates[axis].unwrap_or(speeds[axis] * per_mm[axis]).min(by_pulse)
    }))
}

/// Steps for a mm of each axis, if all are known.
pub(super) fn per_mm(settings: &Settings) -> Option<[f64; AXES]> {
    let steps = &settings.steps;
    let per_mm = [steps.x?, steps.y?, steps.z?, steps.e?];
    (!per_mm.contains(&0.0)).then_some(per_mm)
}

/// A board and its motors. Arrays are x, y, z, e.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Machine {
    /// Steps for a mm.
    pub scale: [Scale; AXES],
    /// Least time between two steps of an axis, µs.
    pub interval: [u32; AXES],
    /// Least time between two steps of an axis that turns round, µs.
    pub turn: u32,
    /// How long the board holds a pulse, µs: two steps are at least so far apart.
    pub pulse: u32,
    /// Where the axes stand at the beginning, in steps.
    pub start: [i64; AXES],
    /// Lowest and highest step of each axis; the filament has no ends.
    pub ends: [[i64; AXES]; 2],
}

impl Machine {
    /// The machine that these settings are for. `start` is where its nozzle stands at the beginning, mm;
    /// `None` is where the settings say.
    ///
    /// # Errors
    /// [`ProfileError::Conflict`] if they do not say how far a step goes.
    pub fn new(settings: &Settings, start: Option<[f64; 3]>) -> Result<Self, ProfileError> {
        let steps = &settings.steps;
        let keys = ["steps.x", "steps.y", "steps.z", "steps.e"];
        let per_mm = [steps.x, steps.y, steps.z, steps.e];
        let mut scale = [Scale { steps: 1, mm: 1 }; AXES];
        for axis in 0..AXES {
            let known = per_mm[axis].and_then(Scale::new);
            let conflict = Conflict::NoSteps { key: keys[axis] };
            scale[axis] = known.ok_or(ProfileError::Conflict { origin: None, source: conflict })?;
        }
        let rates = most_rates(settings).unwrap_or([1.0; AXES]);
        let [x, y, z] = start.unwrap_or([steps.home_x, steps.home_y, steps.home_z]);
        let [low, high] = settings.machine.nozzle_reach();
        let end = |ends: [f64; 3], axis: usize, none: i64| {
            let place = ends.get(axis).and_then(|mm| scale[axis].place_of_mm(*mm));
            place.map_or(none, super::axis::nearest)
        };
        let start = [x, y, z, 0.0];
        Ok(Self {
            interval: std::array::from_fn(|axis| {
                let interval = (SECOND / rates[axis] - 1e-9).ceil().min(f64::from(u32::MAX)) as u32;
                interval.max(2 * steps.pulse)
            }),
            turn: steps.turn,
            pulse: steps.pulse,
            start: std::array::from_fn(|axis| {
                scale[axis].place_of_mm(start[axis]).map_or(0, super::axis::nearest)
            }),
            ends: [
                std::array::from_fn(|axis| end(low, axis, i64::MIN)),
                std::array::from_fn(|axis| end(high, axis, i64::MAX)),
            ],
            scale,
        })
    }

    /// Highest speed of a path of `way` mm on which the axes go so far, in units of a place: no axis steps
    /// faster than it may. An axis steps with the leader, so that two of its steps are as far apart as a
    /// whole number of the leader's.
    #[must_use]
    pub fn most_speed(&self, lengths: [i64; AXES], way: f64) -> f64 {
        let longest = lengths.into_iter().max().unwrap_or(0);
        let mut interval = 1.0_f64;
        for (length, least) in lengths.into_iter().zip(self.interval) {
            if length > 0 {
                interval = interval.max(f64::from(least) / (longest / length) as f64);
            }
        }
        let steps = longest as f64 / STEP as f64;
        if steps > 0.0 { way / steps * (SECOND / interval) } else { f64::INFINITY }
    }

    /// How far an axis at this step is beyond the switch, in mm.
    #[must_use]
    pub fn beyond(&self, axis: usize, step: i64) -> Option<f64> {
        let [low, high] = [self.ends[0][axis], self.ends[1][axis]];
        let by = if step < low { low.saturating_sub(step) } else { step.saturating_sub(high) };
        (step < low || step > high).then(|| self.scale[axis].mm(by as f64))
    }

    /// Where the axes stand at these steps, mm.
    #[must_use]
    pub fn mm(&self, steps: [i64; AXES]) -> [f64; AXES] {
        std::array::from_fn(|axis| self.scale[axis].mm(steps[axis] as f64))
    }
}

/// A step beyond an end of an axis, in words.
pub(super) fn beyond_text(axis: usize, mm: f64) -> String {
    format!("{} goes {mm:.3} mm beyond its end", LETTERS[axis])
}
