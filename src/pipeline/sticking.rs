//! Settings + first layer -> skirt, brim and raft, judged against the bed.
//!
//! What was asked for and does not fit the bed is refused, like a part; a brim that nobody asked for
//! is left out with a warning.

use super::rise::rise;
use crate::error::Refusal;
use crate::fill::adhesion::clear::clear;
use crate::fill::adhesion::lift::Lift;
use crate::fill::adhesion::{Adhesion, AdhesionParams, Base};
use crate::fill::{Path, Role};
use crate::geom::Point;
use crate::geom::nest::{Nest, extent};
use crate::mesh::place::Placed;
use crate::profile::{BrimPlace, Settings};
use crate::report::{BrimReport, RaftReport};
use crate::slice::{Heights, Layer};
use crate::units::{Coord, to_mm};
use crate::warning::Warning;

/// What makes a print stick, laid when its first layer is known.
pub struct Sticking<'a> {
    params: Option<AdhesionParams>,
    placed: &'a Placed,
    heights: &'a Heights,
    /// The bed's corners.
    bed: (Point, Point),
    /// Nobody asked for the brim.
    is_auto: bool,
    width_mm: f64,
    lift: Lift,
    /// The layers of a raft until they are taken, and what is printed on them.
    raft: Vec<(Layer, Vec<Path>)>,
    /// What is still to be printed, by layer.
    layers: Vec<Vec<Path>>,
    stuck: Result<Stuck, Refusal>,
}

/// What was done so that the print sticks.
#[derive(Debug, Clone, Default)]
pub struct Stuck {
    /// A brim that nobody asked for.
    pub brim: Option<BrimReport>,
    /// One that was left out.
    pub warning: Option<Warning>,
    /// A raft.
    pub raft: Option<RaftReport>,
    /// The box around skirt, brim and raft in the layout, grid units.
    pub extent: Option<(Point, Point)>,
}

impl<'a> Sticking<'a> {
    /// Ready to lay what `settings` ask for, within these corners of the bed.
    #[must_use]
    pub fn new(
        settings: &Settings,
        placed: &'a Placed,
        heights: &'a Heights,
        bed: (Point, Point),
    ) -> Self {
        let wide = settings.in_first_width();
        Self {
            params: AdhesionParams::new(wide.as_ref().unwrap_or(settings)),
            placed,
            heights,
            bed,
            is_auto: settings.brim.place == BrimPlace::Auto,
            width_mm: settings.brim.width,
            lift: Lift::new(settings),
            raft: Vec::new(),
            layers: Vec::new(),
            stuck: Ok(Stuck::default()),
        }
    }

    /// Adds what is printed first on a layer to its `paths`, and takes support out of its place. Layers
    /// come from the lowest on.
    pub fn layer(&mut self, layer: &Layer, paths: &mut Vec<Path>) {
        if let Some(params) = self.params.take_if(|_| layer.index == 0) {
            let mut adhesion = self.lay(&params, layer, paths);
            self.stuck = self.judge(&adhesion);
            clear(paths, &adhesion.taken);
            adhesion.layers.resize(adhesion.layers.len().max(self.lift.layers()), Vec::new());
            self.layers = adhesion.layers.split_off(self.lift.layers());
            let layers = Heights::new(self.lift.heights.iter().copied());
            let course = |(index, paths): (usize, Vec<Path>)| {
                let (z, height) = (layers.top(index), layers.height(index));
                let contours = adhesion.plate.clone();
                (Layer { index, z, height, contours, closed_gap: 0 }, paths)
            };
            self.raft = adhesion.layers.into_iter().enumerate().map(course).collect();
        }
        paths.extend(self.layers.get_mut(layer.index).map(std::mem::take).unwrap_or_default());
    }

    /// The layers of a raft with what is printed on them; once, when the first layer was given.
    pub fn raft(&mut self) -> Vec<(Layer, Vec<Path>)> {
        std::mem::take(&mut self.raft)
    }

    /// What was done; known once the first layer was given.
    ///
    /// # Errors
    /// [`Refusal::BesideBed`].
    pub fn stuck(&self) -> Result<Stuck, Refusal> {
        self.stuck.clone()
    }

    fn lay(&self, params: &AdhesionParams, layer: &Layer, paths: &[Path]) -> Adhesion {
        let (mesh, heights, below) = (&self.placed.mesh, self.heights, self.lift.layers());
        let count = params.skirt_layers().clamp(1, below + heights.count());
        // Of the part's layers.
        let with_skirt = count.saturating_sub(below);
        let top = with_skirt.checked_sub(1).map_or(0, |last| heights.top(last));
        let is_beside = |z: Coord| count > 1 && z <= top;
        let above =
            mesh.vertices.iter().filter(|v| is_beside(v[2])).map(|&[x, y, _]| Point { x, y });
        let above: Vec<Point> = above.collect();
        let base = Base {
            contours: &layer.contours,
            paths,
            heights: &(0..count).map(|k| self.height(k)).collect::<Vec<_>>(),
            above: &above,
            top: mesh.top(),
            bed: self.bed,
        };
        let nest = Nest::new(&layer.contours);
        let island = |k: usize| nest.parents[k].filter(|_| !nest.is_outer[k]).unwrap_or(k);
        let islands: Vec<usize> = (0..layer.contours.len()).map(island).collect();
        params.lay(&base, |contours| rise(mesh, heights.plane(0), contours, &islands))
    }

    /// How high a skirt is on a layer of the print. It fills the gap above a raft.
    fn height(&self, layer: usize) -> Coord {
        let Some(own) = layer.checked_sub(self.lift.layers()) else {
            return self.lift.heights[layer];
        };
        self.heights.height(own) + if own == 0 { self.lift.filled } else { 0 }
    }

    /// Refuses what does not fit the bed, and says what was decided.
    fn judge(&self, adhesion: &Adhesion) -> Result<Stuck, Refusal> {
        let mut stuck = Stuck::default();
        for role in [Role::Brim, Role::RaftBase, Role::RaftInterface, Role::Skirt] {
            let beads = adhesion.layers.iter().flatten().filter(|path| path.role == role);
            let points = beads.flat_map(|path| &path.points).map(|p| (p.at, p.width / 2));
            let corners = |(p, half): (Point, Coord)| {
                [-half, half].map(|by| Point { x: p.x + by, y: p.y + by })
            };
            let own = extent(&points.flat_map(corners).collect::<Vec<_>>());
            let Some((low, high)) = own else { continue };
            let beyond = |own: Coord, bed: Coord| to_mm((own - bed).max(0));
            let (first, last) = self.bed;
            let over_mm = [
                [beyond(first.x, low.x), beyond(high.x, last.x)],
                [beyond(first.y, low.y), beyond(high.y, last.y)],
            ];
            // Rounded to the grid, as parts are.
            if over_mm.iter().flatten().any(|over| *over > 0.000_15) {
                let what = match role {
                    Role::RaftBase | Role::RaftInterface => "raft",
                    other => other.facts().name,
                };
                return Err(Refusal::BesideBed { what, over_mm });
            }
            let all: Vec<Point> = [low, high]
                .into_iter()
                .chain(stuck.extent.into_iter().flat_map(|(low, high)| [low, high]))
                .collect();
            stuck.extent = extent(&all);
        }
        if self.is_auto && !adhesion.loose.is_empty() {
            let mut why: Vec<_> = adhesion.loose.iter().map(|(_, why)| *why).collect();
            why.sort_unstable();
            why.dedup();
            stuck.brim = Some(BrimReport {
                width_mm: self.width_mm,
                islands: adhesion.loose.len(),
                of: adhesion.islands,
                why: why.iter().map(|why| why.words().to_owned()).collect(),
            });
        }
        stuck.raft = (!adhesion.plate.is_empty()).then(|| RaftReport {
            layers: self.lift.layers(),
            height_mm: to_mm(self.lift.by() - self.lift.gap),
            gap_mm: to_mm(self.lift.gap),
            plates: Nest::new(&adhesion.plate).outer().count(),
        });
        stuck.warning = (adhesion.left_out > 0)
            .then_some(Warning::BrimLeftOut { islands: adhesion.left_out, of: adhesion.islands });
        Ok(stuck)
    }
}
