//! G-code -> highest rates: how fast each motor would have to step, as the firmware drives the moves.

use super::axis::AXES;
use super::machine::per_mm;
use crate::estimate::apply;
use crate::motion::{Clock, Limits, Move};
use crate::profile::Settings;
use crate::reader::{self, Event, Reading};
use std::io::{self, BufRead};

/// Most steps a second of each axis, in the middle of each move at its highest speed; `None` where the
/// settings do not say how far a step of all axes goes. No rate of a motor lowers it.
/// With `fixed_limits` what the file says of limits is left out.
///
/// # Errors
/// Only what reading the bytes gives.
pub fn highest_rates(
    source: &mut dyn BufRead,
    reading: Reading,
    settings: &Settings,
    fixed_limits: bool,
) -> io::Result<Option<[f64; AXES]>> {
    let Some(per_mm) = per_mm(settings) else { return Ok(None) };
    let mut clock: Clock<[f64; AXES]> = Clock::new(Limits::new(settings));
    let mut highest = [0.0_f64; AXES];
    let mut collect = |clock: &mut Clock<[f64; AXES]>| {
        for timed in clock.drain() {
            for (highest, steps) in highest.iter_mut().zip(timed.tag) {
                *highest = highest.max(steps * timed.peak);
            }
        }
    };
    reader::read(source, reading, &mut |_, event| {
        match event {
            Event::Move(motion) => {
                let [x, y, z] = std::array::from_fn(|axis| motion.to[axis] - motion.from[axis]);
                let delta = [x, y, z, motion.filament];
                let nozzle = (x * x + y * y + z * z).sqrt();
                let way = if nozzle > 0.0 { nozzle } else { motion.filament.abs() };
                // Steps for a mm of the way.
                let tag = std::array::from_fn(|axis| delta[axis].abs() / way * per_mm[axis]);
                clock.push(Move { delta, feed: motion.feed, tag });
            }
            Event::Dwell(seconds) => clock.dwell(seconds, [0.0; AXES]),
            Event::Wait(_) => clock.stop(),
            Event::Change(change) if !fixed_limits => {
                let mut limits = clock.limits().clone();
                apply(&change, &mut limits);
                clock.set_limits(limits);
            }
            _ => {}
        }
        collect(&mut clock);
    })?;
    clock.finish();
    collect(&mut clock);
    Ok(Some(highest))
}
