//! Start block + first layer -> Refusal: a print that lies where the start block primes the nozzle.
//!
//! The block is filled in and read as any G-code file is. What it pushes out low above the bed, as a
//! line or in one place, must keep clear of every bead of the first layer: the nozzle would drag
//! the one through the other, and the part would stand on it.

use crate::error::{Refusal, Result};
use crate::geom::segment::distance2;
use crate::plan::Toolpath;
use crate::profile::Settings;
use crate::profile::template::{self, PrintFacts};
use crate::reader::Firmware;
use crate::reader::print::{Print, Step};
use crate::units::to_mm;

/// What is pushed out higher than this above the bed falls where nobody knows, mm.
const LOW: f64 = 2.0;

/// Least filament that counts, mm: less is a retraction given back.
const LEAST_FILAMENT: f32 = 0.5;

/// How far a heap reaches that is pushed out in one place, mm.
const HEAP: f64 = 1.5;

/// Half the width of a primed line, at most, mm.
const MOST_HALF_WIDTH: f64 = 1.5;

/// Distance between the places of a primed line at which it is looked at, mm: below the least width.
const STEP: f64 = 0.2;

/// Refuses a print whose first layer `first` meets what the start block primes. `offset` holds the
/// machine coordinates of the layout's middle, mm.
///
/// # Errors
/// [`Refusal::Primed`], with the first place; a start block that cannot be filled in.
pub fn refuse(
    settings: &Settings,
    facts: &PrintFacts,
    offset: [f64; 2],
    first: Option<&Toolpath>,
) -> Result<()> {
    let Some(first) = first else { return Ok(()) };
    let near = |primed: &Primed| {
        let (low, high) = (facts.min, facts.max);
        let far = |axis: usize| {
            let [from, to] = [primed.ends[0][axis], primed.ends[1][axis]];
            let reach = primed.reach + REACH_AROUND;
            from.max(to) + reach < low[axis] || from.min(to) - reach > high[axis]
        };
        !far(0) && !far(1)
    };
    let primed: Vec<Primed> = primed(settings, facts)?.into_iter().filter(near).collect();
    // Beads: both ends and half the width, mm.
    let beads = first.moves.iter().flat_map(|next| {
        next.path.points.windows(2).map(|pair| {
            let at = |k: usize| {
                let point = pair[k].at;
                [to_mm(point.x) + offset[0], to_mm(point.y) + offset[1]]
            };
            ([at(0), at(1)], to_mm(pair[1].width) / 2.0)
        })
    });
    for (bead, half) in beads {
        if let Some(at_mm) = primed.iter().find_map(|one| one.meets(bead, half)) {
            return Err(Refusal::Primed { at_mm }.into());
        }
    }
    Ok(())
}

/// How far brims, skirts and support may reach beyond the models, mm.
const REACH_AROUND: f64 = 50.0;

/// What the start block pushes out.
struct Primed {
    /// Machine coordinates, mm.
    ends: [[f64; 2]; 2],
    /// How far from the line between them plastic lies, mm.
    reach: f64,
}

impl Primed {
    fn new(step: &Step) -> Option<Self> {
        let [from, to] = [step.from, step.to].map(|at| at.map(f64::from));
        if step.filament < LEAST_FILAMENT || to[2] > LOW {
            return None;
        }
        let ends = [[from[0], from[1]], [to[0], to[1]]];
        let half = f64::from(step.width) / 2.0;
        let reach = if ends[0] == ends[1] { HEAP } else { half.clamp(0.2, MOST_HALF_WIDTH) };
        Some(Self { ends, reach })
    }

    /// A place where a bead of this half width lies on it.
    fn meets(&self, bead: [[f64; 2]; 2], half: f64) -> Option<[f64; 2]> {
        let [from, to] = self.ends;
        let length = (to[0] - from[0]).hypot(to[1] - from[1]);
        let steps = (length / STEP).ceil().max(1.0);
        let clear = (self.reach + half).powi(2);
        let place = |k: usize| {
            let t = k as f64 / steps;
            [0, 1].map(|axis| from[axis] + t * (to[axis] - from[axis]))
        };
        (0..=steps as usize).map(place).find(|&at| distance2(at, bead) < clear)
    }
}

/// Boxes of the bed that the start block primes, with what lies `around` models beside them, mm. A block that
/// goes by the print's own box keeps clear of it by itself.
pub(super) fn areas(settings: &Settings, around: f64) -> Vec<[[f64; 2]; 2]> {
    let block = &settings.machine.start_gcode;
    if OF_PRINT.iter().any(|name| block.contains(name)) {
        return Vec::new();
    }
    // A block that cannot be filled in is refused elsewhere.
    let primed = primed(settings, &PrintFacts::default()).unwrap_or_default();
    let area = |one: &Primed| {
        let reach = one.reach + around + CLEAR;
        let side = |axis: usize| {
            let [from, to] = [one.ends[0][axis], one.ends[1][axis]];
            (from.min(to) - reach, from.max(to) + reach)
        };
        let [x, y] = [side(0), side(1)];
        [[x.0, y.0], [x.1, y.1]]
    };
    primed.iter().map(area).collect()
}

/// Placeholders that tell where the print lies.
const OF_PRINT: [&str; 4] = ["{min_x}", "{min_y}", "{max_x}", "{max_y}"];

/// Distance of models from what is primed, mm: their lines may lie a little beside their contours.
const CLEAR: f64 = 0.2;

fn primed(settings: &Settings, facts: &PrintFacts) -> Result<Vec<Primed>> {
    let block = &settings.machine.start_gcode;
    let values = template::start_values(settings, facts);
    let text = template::render("machine.start_gcode", block, &values)
        .map_err(crate::gcode::Error::from)?;
    let (mut source, diameter) = (text.as_bytes(), settings.filament.diameter);
    let read = Print::read_as(&mut source, Firmware::default(), diameter);
    // A text in memory can be read.
    let moves = read.map(|print| print.moves).unwrap_or_default();
    Ok(moves.iter().filter_map(Primed::new).collect())
}
