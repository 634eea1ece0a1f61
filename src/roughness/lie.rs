//! G-code + Model -> Lie: where the part was printed, how high its raft is, and how high layers are.
//!
//! The model is tried where it is expected, and where the middle of the box around the part's lines lies; if
//! it fits in neither place, where each edge of that box lies. The place counts where the plastic lies
//! nearest along the surface, looked at on coarse cells. So it does not matter where a slicer lays the part,
//! nor that a thin edge was not printed.

use super::bead::is_of_part;
use super::map::Map;
use super::surface::Surface;
use super::{Error, Model};
use crate::mesh::Mesh;
use crate::reader::{Facts, Role, Stream};
use crate::units::{Coord, to_mm};
use std::collections::BTreeMap;
use std::io;

/// Places that differ by less are the same, mm.
const SAME: f64 = 0.01;

/// Mean distance between plastic and surface, in layers, up to which a place fits: steps of a staircase are
/// a quarter of a layer off.
const FITS: f64 = 0.4;

/// By which share another place must be better than the expected one.
const BETTER: f64 = 0.02;

/// Distance between cells by which places are compared, grid units, as a multiple of the usual cell.
const COARSER: Coord = 5;

/// How much wider the print may be than the model so that edges are tried too, mm: a brim or a skirt that
/// no comment tells is wider.
const WIDER: f64 = 2.0;

/// Share of a raft's height by which the print must be higher than the part.
const LEAST_RAFT: f64 = 0.5;

/// Height of layers where nothing tells it, mm.
const SOME_LAYER: f64 = 0.2;

/// Where the part was printed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Lie {
    /// The middle of the layout, in the machine's coordinates, mm.
    pub(super) origin: [f64; 2],
    /// How far that is from where it was expected, mm.
    pub(super) moved: [f64; 2],
    /// How far a raft lifts the part, mm.
    pub(super) lift: f64,
    /// Height of a layer, mm.
    pub(super) layer: f64,
}

/// What is known of the part's lines.
#[derive(Debug)]
struct Seen {
    /// Lowest and highest x and y, widths included, mm.
    low: [f64; 2],
    high: [f64; 2],
    /// How low lines reach, and how high, mm.
    bottom: f64,
    top: f64,
    /// Length of lines by their height in thousandths of a mm, mm.
    heights: BTreeMap<i64, f64>,
}

/// Finds where the part was printed.
///
/// # Errors
/// [`Error::Unreadable`]; [`Error::NoPlastic`] if no line is one of the part.
pub(super) fn find(stream: &Stream, model: &Model<'_>, surface: &Surface) -> Result<Lie, Error> {
    let facts = stream.facts();
    let seen = Seen::of(stream)?;
    if seen.top <= seen.bottom {
        return Err(Error::NoPlastic);
    }
    let layer = told_height(facts).or_else(|| seen.height()).unwrap_or(SOME_LAYER);
    let lift = model.lift.unwrap_or_else(|| seen.lift(facts, model.mesh));
    let at = |moved: [f64; 2]| Lie {
        origin: [model.offset[0] + moved[0], model.offset[1] + moved[1]],
        moved,
        lift,
        layer,
    };
    let [x, y] = seen.ways(model);
    let usual = [0.0, 0.5].map(|part| [x, y].map(|[low, high]| part * (low + high)));
    if usual[1].iter().all(|by| by.abs() <= SAME) {
        return Ok(at([0.0; 2]));
    }
    let mut map = Map::new(surface, COARSER * surface.cell(), layer);
    let mut best = (f64::INFINITY, [0.0; 2]);
    let mut look = |places: &[[f64; 2]]| {
        for &moved in places {
            map.clear();
            map.draw(stream, at(moved).origin, lift)?;
            let misfit = map.misfit();
            if misfit < (1.0 - BETTER) * best.0 {
                best = (misfit, moved);
            }
        }
        Ok::<_, Error>(best.0 <= FITS * layer)
    };
    let is_wider = |[low, high]: [f64; 2]| high - low > WIDER;
    if !look(&usual)? && ![x, y].into_iter().any(is_wider) {
        look(&[[x[0], y[0]], [x[0], y[1]], [x[1], y[0]], [x[1], y[1]]])?;
    }
    Ok(at(best.1))
}

/// How high layers are by the file's settings or head, mm.
fn told_height(facts: &Facts) -> Option<f64> {
    let in_head = || facts.head.iter().find_map(|text| text.strip_prefix("Layer height:"));
    let told = facts.value("layer_height").or_else(in_head)?;
    told.trim().parse().ok().filter(|height| (0.01..2.0).contains(height))
}

impl Seen {
    fn of(stream: &Stream) -> io::Result<Self> {
        let facts = stream.facts();
        let (most, heights) = (f64::INFINITY, BTreeMap::new());
        let mut seen = Self { low: [most; 2], high: [-most; 2], bottom: most, top: -most, heights };
        for section in stream.sections() {
            let section = section?;
            // What the start draws, and what no comment calls a part of the print, is beside the part.
            let is_known = |role: Role| !facts.has(Role::OuterWall) || role != Role::Other;
            let lines = section.moves.iter().filter(|step| is_of_part(step, facts));
            for step in lines.filter(|step| section.layer.is_some() && is_known(step.role)) {
                let half = f64::from(step.width) / 2.0;
                for [x, y, _] in [step.from, step.to].map(|at| at.map(f64::from)) {
                    seen.low = [seen.low[0].min(x - half), seen.low[1].min(y - half)];
                    seen.high = [seen.high[0].max(x + half), seen.high[1].max(y + half)];
                }
                let height = f64::from(step.height);
                let [low, high] = step.heights();
                seen.bottom = seen.bottom.min(low - height);
                seen.top = seen.top.max(high);
                if step.role != Role::Infill {
                    let class = (height * 1000.0).round() as i64;
                    *seen.heights.entry(class).or_insert(0.0) += step.length();
                }
            }
        }
        Ok(seen)
    }

    /// The height of the middle one of all lines by their heights, mm.
    fn height(&self) -> Option<f64> {
        let all: f64 = self.heights.values().sum();
        let mut below = 0.0;
        let class = self.heights.iter().find(|(_, length)| {
            below += **length;
            2.0 * below >= all
        })?;
        (*class.0 > 0).then_some(*class.0 as f64 / 1000.0)
    }

    /// How far a raft lifts the part in a file that tells support from the part, mm; 0 without one.
    fn lift(&self, facts: &Facts, mesh: &Mesh) -> f64 {
        let more = self.top - to_mm(mesh.top());
        let is_raft = facts.has(Role::OuterWall) && self.bottom > SAME;
        if is_raft && more > LEAST_RAFT * self.bottom { self.bottom } else { 0.0 }
    }

    /// How far the lower and the upper edge of the lines lie from the model's, where it is expected, mm; along
    /// x and along y.
    fn ways(&self, model: &Model<'_>) -> [[f64; 2]; 2] {
        [0, 1].map(|axis: usize| {
            let all = || model.mesh.vertices.iter().map(|at| at[axis]);
            let (low, high) = (all().min().unwrap_or(0), all().max().unwrap_or(0));
            let [low, high] = [low, high].map(|at| to_mm(at) + model.offset[axis]);
            [self.low[axis] - low, self.high[axis] - high]
        })
    }
}
