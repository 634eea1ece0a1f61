//! First layer -> brim: lines beside the part on the bed.
//!
//! - A *space* is what is open beside the part: all around it, or a hole. Islands in a hole stand in
//!   its space.
//! - A space has *sides*: the outer contours that stand in it, and the hole's own contour. Those that
//!   get a brim are *chosen*; from the others brim keeps away. Support keeps away from it.
//! - A *ring* is all lines at one distance from the chosen sides, counted from 0 next to them.
//!
//! 1. For each ring, grow what the chosen sides enclose by its distance. Its outline are the lines.
//!    Brims of neighbours grow together, so that no line is laid on another.
//! 2. Where the lines of two sides would come nearer than their width, the space between them closes:
//!    it is grown by half a width more, and shrunk again.
//! 3. Cut the lines off where they come too near to what has no brim.
//!
//! Rings come from outside inwards: the first line, on which the nozzle may still fill, is the one
//! farthest from the part, and the last one is laid against those before it, right before the wall
//! that it holds.

use super::Bead;
use crate::geom::boxes::Around;
use crate::geom::nest::{Nest, extent, turned};
use crate::geom::polygon::{self, Cut};
use crate::geom::{Contour, Point};
use crate::profile::{BrimPlace, Settings};
use crate::units::{Coord, nearest, to_units};

/// Lines shorter than this many widths are left out: a dot holds nothing.
const LEAST_LENGTH: Coord = 3;

/// The numbers of a brim, grid units.
#[derive(Debug, Clone, Copy)]
pub(super) struct BrimParams {
    /// Around parts.
    pub(super) outside: bool,
    /// In holes.
    pub(super) inside: bool,
    /// Number of rings.
    pub(super) rings: Coord,
    pub(super) width: Coord,
    /// From the contour to the middle of the innermost line.
    pub(super) first: Coord,
}

impl BrimParams {
    /// Derives the numbers from `settings`; `None` without a brim.
    pub(super) fn new(settings: &Settings) -> Option<Self> {
        let (place, width) = (settings.brim.place, settings.line_width);
        let rings = nearest(settings.brim.width / width).max(i64::from(settings.brim.width > 0.0));
        // A wall whose middle lies on the contour reaches out of it.
        let wall = (0.5 - settings.outer_wall_inset).max(0.0);
        let first = settings.brim.gap + (0.5 + wall) * width;
        (place != BrimPlace::Off && rings > 0).then(|| Self {
            outside: place != BrimPlace::Inside,
            inside: matches!(place, BrimPlace::Inside | BrimPlace::Both),
            rings: rings as Coord,
            width: to_units(width),
            first: to_units(first),
        })
    }

    /// How far the brim reaches out of the contour.
    pub(super) fn reach(&self) -> Coord {
        self.first + (self.rings - 1) * self.width + self.width / 2
    }
}

/// What lies on the bed.
pub(super) struct Ground<'a> {
    pub(super) contours: &'a [Contour],
    pub(super) nest: &'a Nest,
}

/// The brim of the outer contours that are `chosen`, in the order of printing.
pub(super) fn brim(ground: &Ground<'_>, chosen: &[bool], params: &BrimParams) -> Vec<Bead> {
    let holes = (0..ground.contours.len()).filter(|&k| !ground.nest.is_outer[k]);
    let spaces = std::iter::once(None).chain(holes.map(Some));
    spaces
        .flat_map(|hole| Space::new(ground, chosen, params, hole))
        .flat_map(Space::beads)
        .collect()
}

/// A space with something chosen in it.
struct Space<'a> {
    params: &'a BrimParams,
    /// What the chosen outer contours enclose.
    bodies: Vec<Contour>,
    /// The hole as solid, if its contour is chosen.
    room: Option<Contour>,
    /// Where no line may run.
    kept_off: Vec<Contour>,
}

impl<'a> Space<'a> {
    fn new(
        ground: &Ground<'_>,
        chosen: &[bool],
        params: &'a BrimParams,
        hole: Option<usize>,
    ) -> Option<Self> {
        let Ground { contours, nest } = ground;
        let (with, without): (Vec<usize>, Vec<usize>) =
            nest.within(hole).partition(|&k| params.outside && chosen[k]);
        let of =
            |list: Vec<usize>| list.into_iter().map(|k| contours[k].clone()).collect::<Vec<_>>();
        let (bodies, others) = (of(with), of(without));
        let around = hole.map(|k| turned(&contours[k]));
        let is_chosen = |k: usize| nest.parents[k].is_some_and(|island| chosen[island]);
        let has_room = params.inside && hole.is_some_and(is_chosen);
        if bodies.is_empty() && !has_room {
            return None;
        }
        let mut kept_off = polygon::outset(&others, params.first);
        if let Some(around) = around.as_ref().filter(|_| !has_room) {
            // Everything but the hole.
            kept_off.extend(frame(&bodies, around, params.reach()));
            let room = polygon::inset(std::slice::from_ref(around), params.first);
            kept_off.extend(room.iter().map(turned));
        }
        Some(Self { params, bodies, room: around.filter(|_| has_room), kept_off })
    }

    /// The lines, island by island of what they enclose, from outside inwards.
    fn beads(self) -> Vec<Bead> {
        let rings: Vec<Cut> = (0..self.params.rings).rev().map(|ring| self.ring(ring)).collect();
        // What belongs together: all that lies in one loop of the outermost ring.
        let together = self.together();
        let least = f64::from(LEAST_LENGTH * self.params.width);
        let around = Around::new(together.iter().enumerate());
        let group = |at: Point| around.of(at).min().unwrap_or(together.len());
        let mut beads = Vec::new();
        for (ring, Cut { whole, pieces }) in (0..self.params.rings).rev().zip(rings) {
            let loops = whole.into_iter().map(|points| Bead::closed(points, ring as u32));
            let all = loops.chain(pieces.into_iter().map(Bead::open));
            let long = all.filter(|one| one.length() >= least);
            beads.extend(long.map(|one| (group(one.points[0]), one)));
        }
        // Within a group they keep their order.
        beads.sort_by_key(|(group, _)| *group);
        beads.into_iter().map(|(_, bead)| bead).collect()
    }

    /// The outlines of what the outermost ring encloses.
    fn together(&self) -> Vec<Contour> {
        if self.room.is_some() || self.bodies.len() < 2 {
            return Vec::new();
        }
        let mut outer = polygon::outset(&self.bodies, self.params.reach());
        outer.retain(|contour| crate::geom::double_area(contour) > 0);
        outer
    }

    /// The lines of one ring.
    fn ring(&self, ring: Coord) -> Cut {
        let half = (self.params.width / 2).max(1);
        let distance = self.params.first + ring * self.params.width;
        let grown = polygon::outset(&self.bodies, distance + half);
        let loops = match &self.room {
            Some(room) => {
                let free = polygon::inset(std::slice::from_ref(room), distance + half);
                let free =
                    if grown.is_empty() { free } else { polygon::difference(&free, &grown, 0) };
                polygon::outset(&free, half)
            }
            None => polygon::inset(&grown, half),
        };
        polygon::cut(loops, &self.kept_off)
    }
}

/// A frame around everything within `reach`.
fn frame(bodies: &[Contour], around: &Contour, reach: Coord) -> Option<Contour> {
    let (low, high) = extent(bodies.iter().flatten().chain(around))?;
    let (x1, x2) = (low.x - 2 * reach, high.x + 2 * reach);
    let (y1, y2) = (low.y - 2 * reach, high.y + 2 * reach);
    Some([(x1, y1), (x2, y1), (x2, y2), (x1, y2)].map(|(x, y)| Point { x, y }).to_vec())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_stands_apart_gets_its_rings_together_from_outside_inwards() {
        let square = |k: Coord| -> Contour {
            let corners = [(0, 0), (20_000, 0), (20_000, 20_000), (0, 20_000)];
            corners.map(|(x, y)| Point { x: x + 60_000 * k, y }).to_vec()
        };
        let contours: Vec<Contour> = (0..40).map(square).collect();
        let nest = Nest::new(&contours);
        let ground = Ground { contours: &contours, nest: &nest };
        let params =
            BrimParams { outside: true, inside: false, rings: 2, width: 4_000, first: 2_000 };
        let beads = brim(&ground, &[true; 40], &params);
        let around = |bead: &Bead| (bead.points[0].x + 20_000).div_euclid(60_000);
        let mut seen: Vec<Coord> = Vec::new();
        for pair in beads.chunks(2) {
            let rings: Vec<_> = pair.iter().map(|bead| (around(bead), bead.ring)).collect();
            assert_eq!(rings, [(rings[0].0, Some(1)), (rings[0].0, Some(0))]);
            seen.push(rings[0].0);
        }
        seen.sort_unstable();
        assert_eq!(seen, (0..40).collect::<Vec<_>>());
    }
}
