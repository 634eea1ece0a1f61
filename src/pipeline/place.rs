//! Model files -> Placed: reads the models and lays them on the machine's bed.

use super::prime;
use crate::error::Result;
use crate::fill::adhesion::lift::Lift;
use crate::geom::Point;
use crate::job::Model;
use crate::mesh::{self, Bed, Placement, place::Placed};
use crate::profile::template::PrintFacts;
use crate::profile::{Machine, Settings};
use crate::progress::Progress;
use crate::slice::Heights;
use crate::units::{Coord, to_mm, to_units};

/// Reads models and lays them on a bed. Only `progress` of a longer run is of use here: the
/// reading stops once that is cancelled.
///
/// # Errors
/// Those of reading and placing: [`Error::Mesh`](crate::error::Error::Mesh);
/// [`Error::Cancelled`](crate::error::Error::Cancelled).
pub fn place(
    models: &[Model],
    placement: &Placement,
    bed: &Bed,
    progress: &Progress,
) -> Result<Placed> {
    let most = placement.max_triangles;
    let load = |model: &Model| {
        progress.go_on()?;
        match model {
            Model::Path(path) => Ok(mesh::read::from_path(path, most)?),
            Model::Bytes { name, bytes } => Ok(mesh::read::from_bytes(name, bytes, most)?),
        }
    };
    let models = models.iter().map(load).collect::<Result<_>>()?;
    progress.go_on()?;
    Ok(mesh::place::place(models, placement, bed)?)
}

/// `placement` as these settings need it: models larger by what the material shrinks, clear of what the start
/// block primes, with room for rafts or brims between them, where they are asked for. A brim that is only
/// printed where it is needed gets none: where two meet they grow together.
#[must_use]
pub fn suited(placement: &Placement, settings: &Settings) -> Placement {
    let (brims, rafts) = (2.0 * settings.brim_reach(), 2.0 * settings.raft_reach());
    let room = if rafts > 0.0 {
        rafts + settings.raft.base_width
    } else if brims > 0.0 {
        brims + settings.line_width
    } else {
        0.0
    };
    let gap = placement.gap.max(room);
    let around = settings.brim_reach().max(settings.raft_reach()) + settings.skirt_reach();
    let taken = prime::areas(settings, around);
    Placement { gap, taken, stretch: settings.stretch(), ..placement.clone() }
}

/// The machine's print volume.
#[must_use]
pub fn bed(machine: &Machine) -> Bed {
    let [low, high] = machine.volume();
    Bed { min: [low[0], low[1]], max: [high[0], high[1]], height: machine.bed_height }
}

/// The bed's corners relative to the middle of the layout, grid units.
#[must_use]
pub fn bed_corners(bed: &Bed, offset: [f64; 2]) -> (Point, Point) {
    let corner =
        |at: [f64; 2]| Point { x: to_units(at[0] - offset[0]), y: to_units(at[1] - offset[1]) };
    (corner(bed.min), corner(bed.max))
}

/// What the start and end blocks may name. Above the layers skins reach up to `highest`. `beside` is the box around skirt, brim and raft, in the
/// layout.
#[must_use]
pub fn print_facts(
    placed: &Placed,
    (heights, highest): (&Heights, Coord),
    lift: &Lift,
    beside: Option<(Point, Point)>,
) -> PrintFacts {
    let half = [placed.size_mm[0] / 2.0, placed.size_mm[1] / 2.0];
    let both = |at: Point| [to_mm(at.x), to_mm(at.y)];
    let middle = both(placed.middle);
    let (low, high) = beside.map_or((middle, middle), |(low, high)| (both(low), both(high)));
    let at = placed.offset;
    PrintFacts {
        layers: heights.count() + lift.layers(),
        min: [0, 1].map(|axis| at[axis] + low[axis].min(middle[axis] - half[axis])),
        max: [0, 1].map(|axis| at[axis] + high[axis].max(middle[axis] + half[axis])),
        height: to_mm(heights.top(heights.count() - 1).max(highest) + lift.by()),
    }
}
