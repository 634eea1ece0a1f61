//! First layer -> Adhesion: skirt, and brim or raft, which are printed before everything else.
//!
//! 1. [`loose`] tells which islands would come loose without a brim, if nobody has decided.
//! 2. `brim` lays lines beside the islands that get one, and [`mod@clear`] takes support out of their
//!    place. With a raft there is none: [`raft`] lays a
//!    plate under all that stands on the bed, and the part's layers come above it.
//! 3. `skirt` lays loops around all of it.
//!
//! Where support stands is taken from its paths, whatever its pattern: what lies between its lines
//! belongs to it.

mod brim;
pub mod clear;
pub mod lift;
pub mod loose;
pub mod raft;
mod skirt;

use super::{Order, Path, PathPoint, Role, Shape};
use crate::geom::boxes::Boxes;
use crate::geom::nest::{Nest, extent};
use crate::geom::{Contour, Point, edges, encloses, polygon};
use crate::profile::{BrimPlace, Settings};
use crate::units::{Coord, to_units};
use brim::{BrimParams, Ground};
use loose::{Loose, Rise};
use raft::RaftParams;
use skirt::SkirtParams;

/// What makes a print stick, by layer.
#[derive(Debug, Clone, Default)]
pub struct Adhesion {
    /// For each of the lowest layers what is printed first on it; those of a raft are the lowest.
    pub layers: Vec<Vec<Path>>,
    /// The outline of the raft.
    pub plate: Vec<Contour>,
    /// Where no support may be printed on the first layer of the part: the brim with half a line around it.
    pub taken: Vec<Contour>,
    /// The islands that would come loose, and why, if nobody has decided.
    pub loose: Vec<(usize, Loose)>,
    /// Outer contours of the first layer.
    pub islands: usize,
    /// Islands that would come loose, but whose brim would not fit the bed.
    pub left_out: usize,
}

/// The numbers of skirt, brim and raft.
#[derive(Debug, Clone)]
pub struct AdhesionParams {
    brim: Option<BrimParams>,
    /// A brim only where it is needed.
    is_auto: bool,
    raft: Option<RaftParams>,
    skirt: Option<SkirtParams>,
    line_width: Coord,
    /// Gaps in support up to this belong to it.
    support_gap: Coord,
}

/// The first layer, and what an Adhesion has to know besides.
#[derive(Debug, Clone, Copy)]
pub struct Base<'a> {
    /// The outline of the part.
    pub contours: &'a [Contour],
    /// Its paths.
    pub paths: &'a [Path],
    /// Heights of all layers that may have a skirt, those of a raft first.
    pub heights: &'a [Coord],
    /// Points of the part on the layers above that have a skirt.
    pub above: &'a [Point],
    /// The top of the highest part.
    pub top: Coord,
    /// The bed, as two opposite corners.
    pub bed: (Point, Point),
}

impl AdhesionParams {
    /// Derives the numbers from `settings`; `None` without skirt, brim and raft.
    #[must_use]
    pub fn new(settings: &Settings) -> Option<Self> {
        let (raft, skirt) = (RaftParams::new(settings), SkirtParams::new(settings));
        let brim = BrimParams::new(settings).filter(|_| raft.is_none());
        (brim.is_some() || raft.is_some() || skirt.is_some()).then(|| Self {
            brim,
            is_auto: settings.brim.place == BrimPlace::Auto,
            raft,
            skirt,
            line_width: to_units(settings.line_width),
            support_gap: to_units(settings.support.spacing),
        })
    }

    /// Layers that have a skirt.
    #[must_use]
    pub fn skirt_layers(&self) -> usize {
        self.skirt.map_or(0, |skirt| skirt.layers)
    }

    /// What is printed first on the layers of `base`. `rise` tells how high what stands on each
    /// outer contour rises; it is only asked where that matters.
    #[must_use]
    pub fn lay(&self, base: &Base<'_>, rise: impl FnOnce(&[Contour]) -> Vec<Rise>) -> Adhesion {
        let nest = Nest::new(base.contours);
        let printed = printed(base);
        let mut adhesion = Adhesion { islands: nest.outer().count(), ..Adhesion::default() };
        let support = self.support(base.paths);
        if let Some(raft) = &self.raft {
            // Holes count with what they are in.
            let own = |k: usize| nest.parents[k].filter(|_| !nest.is_outer[k]).unwrap_or(k);
            let held = (0..base.contours.len()).filter(|&k| printed[own(k)]);
            let held = held.map(|k| &base.contours[k]);
            let foot: Vec<Contour> = held.chain(&support).cloned().collect();
            adhesion.plate = raft.plate(&foot);
        }
        if !printed.contains(&true) && adhesion.plate.is_empty() {
            return adhesion;
        }
        let mut beads = Vec::new();
        if let Some(params) = &self.brim {
            let mut chosen = printed.clone();
            if self.is_auto {
                adhesion.loose = loose::loose(base.contours, &nest, base.top, rise);
                adhesion.loose.retain(|(k, _)| printed[*k]);
                let all = adhesion.loose.len();
                let fits = |k: usize| is_within(&base.contours[k], params.reach(), base.bed);
                adhesion.loose.retain(|(k, _)| fits(*k));
                adhesion.left_out = all - adhesion.loose.len();
                chosen.fill(false);
                adhesion.loose.iter().for_each(|(k, _)| chosen[*k] = true);
            }
            beads = brim::brim(&Ground { contours: base.contours, nest: &nest }, &chosen, params);
            adhesion.taken = self.taken(&beads, !support.is_empty());
        }
        self.paths(base, &beads, &support, &mut adhesion);
        adhesion
    }

    /// The paths of skirt, brim and raft.
    fn paths(
        &self,
        base: &Base<'_>,
        brim: &[Bead],
        support: &[Contour],
        Adhesion { layers, plate, .. }: &mut Adhesion,
    ) {
        let Some(&first) = base.heights.first() else { return };
        let path = |role: Role, bead: &Bead, height: Coord| bead.path(role, height, self);
        if let Some(params) = &self.skirt {
            let beside = brim.iter().flat_map(|bead| bead.around(self.line_width / 2));
            let below = base.contours.iter().chain(support).chain(&*plate);
            let part = below.flatten().chain(base.above).copied();
            let loops = skirt::skirt(part.chain(beside).collect(), params);
            layers.push(loops.iter().map(|bead| path(Role::Skirt, bead, first)).collect());
            let above = skirt::above(&loops, params);
            layers.extend(base.heights.iter().skip(1).map(|&height| -> Vec<Path> {
                above.iter().map(|bead| path(Role::Skirt, bead, height)).collect()
            }));
        }
        if !brim.is_empty() {
            layers.resize(layers.len().max(1), Vec::new());
            layers[0].extend(brim.iter().map(|bead| path(Role::Brim, bead, first)));
        }
        let courses = self.raft.iter().flat_map(|raft| raft.paths(plate)).enumerate();
        for (k, course) in courses {
            layers.resize(layers.len().max(k + 1), Vec::new());
            layers[k].extend(course);
        }
    }

    /// What a brim covers, with half a line around it; nothing if there is no support to keep off it.
    fn taken(&self, brim: &[Bead], has_support: bool) -> Vec<Contour> {
        if brim.is_empty() || !has_support {
            return Vec::new();
        }
        let around = |bead: &Bead| {
            bead.points
                .iter()
                .chain(bead.points.first().filter(|_| bead.ring.is_some()))
                .copied()
                .collect()
        };
        let lines: Vec<Vec<Point>> = brim.iter().map(around).collect();
        polygon::covered(lines.iter().map(Vec::as_slice), 2 * self.line_width, 0)
    }

    /// What support covers of the bed.
    fn support(&self, paths: &[Path]) -> Vec<Contour> {
        let lines = paths.iter().filter(|path| path.role.facts().order == Order::Helper);
        let lines: Vec<Vec<Point>> =
            lines.map(|path| path.points.iter().map(|point| point.at).collect()).collect();
        if lines.is_empty() {
            return Vec::new();
        }
        polygon::covered(lines.iter().map(Vec::as_slice), self.line_width, self.support_gap)
    }
}

/// For each contour whether some line of the part begins inside it: what is too thin to be printed needs
/// nothing to hold it.
fn printed(base: &Base<'_>) -> Vec<bool> {
    let of_part = base.paths.iter().filter(|path| path.role.facts().order.is_of_part());
    let boxes = base.contours.iter().map(|contour| extent(contour).unwrap_or_default());
    let boxes = Boxes::new(boxes.collect());
    let mut printed = vec![false; base.contours.len()];
    for start in of_part.map(Path::start) {
        for k in boxes.around(start) {
            printed[k] = printed[k] || encloses(edges(&base.contours[k]), start);
        }
    }
    printed
}

/// Whether a contour fits the bed with `reach` around it.
fn is_within(contour: &Contour, reach: Coord, (low, high): (Point, Point)) -> bool {
    extent(contour).is_none_or(|(first, last)| {
        let from = [first.x - low.x, first.y - low.y, high.x - last.x, high.y - last.y];
        from.iter().all(|&room| room >= reach)
    })
}

/// A line of skirt or brim.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Bead {
    /// Its points; those of a closed one do not repeat the first.
    points: Vec<Point>,
    /// The ring of a closed one, counted from the part; none of an open one.
    ring: Option<u32>,
}

impl Bead {
    fn closed(points: Contour, ring: u32) -> Self {
        Self { points, ring: Some(ring) }
    }

    fn open(points: Vec<Point>) -> Self {
        Self { points, ring: None }
    }

    /// Its length, grid units.
    fn length(&self) -> f64 {
        let open = self.points.windows(2).map(|ends| ends[0].distance(ends[1])).sum::<f64>();
        match self.ring {
            Some(_) => edges(&self.points).map(|(a, b)| a.distance(b)).sum(),
            None => open,
        }
    }

    /// Points that the bead lies within, `half` its width.
    fn around(&self, half: Coord) -> impl Iterator<Item = Point> {
        let corners = move |p: Point| {
            [(-1, -1), (1, -1), (1, 1), (-1, 1)]
                .map(|(x, y)| Point { x: p.x + x * half, y: p.y + y * half })
        };
        self.points.iter().copied().flat_map(corners)
    }

    fn path(&self, role: Role, height: Coord, params: &AdhesionParams) -> Path {
        let width = params.line_width;
        let again = self.points.first().filter(|_| self.ring.is_some());
        let point = |&at: &Point| PathPoint { at, z: 0, width, height, hang: 0 };
        let points = self.points.iter().chain(again).map(point).collect();
        let shape = self.ring.map_or(Shape::Open, |depth| Shape::Loop { depth });
        Path { role, shape, points, layers: 1 }
    }
}
