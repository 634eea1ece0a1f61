//! Foot of the print -> raft: a plate under it, in courses.
//!
//! - The *foot* is what part and support cover of the first layer.
//! - The *plate* is the foot, grown by the raft's reach. Bays and holes of it that are narrower than
//!   twice the reach are closed, each piece of it by itself: two parts keep a plate each.
//! - A *course* is one layer of the plate. The *base* lies on the bed: an outline, and wide lines apart
//!   from each other. The others are the *interface*, each across the one below.
//!
//! The courses are turned so that the part's first layer lies across the last one.

use super::super::{Path, PathPoint, Role, Shape};
use crate::geom::nest::Nest;
use crate::geom::polyline::Polyline;
use crate::geom::{Contour, Point, polygon};
use crate::pattern::{Lines, SparsePattern as _};
use crate::profile::Settings;
use crate::region::scan::Scan;
use crate::units::{Coord, to_units};

/// The middle of the outermost lines of the base lies this far inside the middle of its outline, in
/// tenths of a line's width: they hold on to it.
const FROM_OUTLINE: Coord = 9;

/// The numbers of a raft, grid units.
#[derive(Debug, Clone)]
pub struct RaftParams {
    /// From the foot to the plate's edge.
    reach: Coord,
    /// Between the last course and the part.
    gap: Coord,
    /// From the bed upwards.
    courses: Vec<Course>,
}

/// A layer of a raft.
#[derive(Debug, Clone, Copy)]
struct Course {
    role: Role,
    height: Coord,
    width: Coord,
    /// From line to line.
    pitch: Coord,
    /// Direction of its lines.
    degrees: f64,
}

impl RaftParams {
    /// Derives the numbers from `settings`; `None` without a raft.
    #[must_use]
    pub fn new(settings: &Settings) -> Option<Self> {
        let (raft, line, count) = (&settings.raft, settings.line_width, settings.raft_layers());
        let course = |k: usize| {
            let (role, height, width, gap) = match k {
                0 => (Role::RaftBase, raft.base_height, raft.base_width, raft.base_spacing),
                _ => (Role::RaftInterface, raft.interface_height, line, raft.interface_spacing),
            };
            Course {
                role,
                height: to_units(height),
                width: to_units(width),
                pitch: to_units(width + gap),
                degrees: settings.angle.degrees() + 90.0 * ((count - k) % 2) as f64,
            }
        };
        raft.enabled.then(|| Self {
            reach: to_units(settings.raft_reach()),
            gap: to_units(raft.gap),
            courses: (0..count).map(course).collect(),
        })
    }

    /// Heights of the courses, from the bed upwards.
    pub fn heights(&self) -> impl Iterator<Item = Coord> {
        self.courses.iter().map(|course| course.height)
    }

    /// The gap between the last course and the part.
    #[must_use]
    pub fn gap(&self) -> Coord {
        self.gap
    }

    /// The plate under `foot`, contours that may overlap.
    pub(super) fn plate(&self, foot: &[Contour]) -> Vec<Contour> {
        let grown = polygon::outset(&polygon::union(foot), self.reach);
        let nest = Nest::new(&grown);
        let closed = |k: usize| {
            let piece = std::iter::once(k).chain(nest.within(Some(k)));
            let piece: Vec<Contour> = piece.map(|k| grown[k].clone()).collect();
            polygon::inset(&polygon::outset(&piece, self.reach), self.reach)
        };
        // Closing rounds to the grid: nothing of the foot's own reach is lost by it.
        let closed: Vec<Contour> = nest.outer().flat_map(closed).chain(grown.clone()).collect();
        polygon::union(&closed)
    }

    /// The paths of each course on `plate`.
    pub(super) fn paths(&self, plate: &[Contour]) -> impl Iterator<Item = Vec<Path>> {
        self.courses.iter().map(|course| self.course(course, plate))
    }

    fn course(&self, course: &Course, plate: &[Contour]) -> Vec<Path> {
        let half = (course.width / 2).max(1);
        let point =
            |at: Point| PathPoint { at, z: 0, width: course.width, height: course.height, hang: 0 };
        let path = |points: Vec<PathPoint>| Path {
            role: course.role,
            shape: Shape::Open,
            points,
            layers: 1,
        };
        let middle = polygon::inset(plate, half);
        let mut paths = Vec::new();
        let mut room = middle.clone();
        if course.role == Role::RaftBase {
            let closed =
                |one: &Contour| one.iter().chain(one.first()).map(|&at| point(at)).collect();
            paths.extend(middle.iter().map(closed).map(path));
            room = polygon::inset(&middle, (course.width * FROM_OUTLINE / 10).max(1));
        }
        let lines = Lines::new(course.degrees, course.pitch, course.width);
        let scan = Scan::new(&room, lines.raster);
        let strands = lines.strands(scan.inside(), course.width, course.width);
        let of = |strand: &Polyline| {
            let places = strand.iter().map(|at| Point { x: at.u, y: at.v });
            places.map(|at| point(lines.raster.frame.leave(at))).collect()
        };
        paths.extend(strands.iter().map(of).map(path));
        paths
    }
}
