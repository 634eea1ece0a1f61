//! Scene -> Patches: the one upward pass over the layers that decides which places become skin.
//!
//! 1. Each surface is cut to pieces that may become skin, as far as it is known from the surface alone
//!    (`candidate`). Each has a home layer.
//! 2. Pieces come in the order of their homes; of those with one home, the one with the lower top first.
//! 3. Layers are piled up to the home (`stack`), without the room of skins.
//! 4. The piece shrinks to what passes there (`trial`), and is laid
//!    (`lay`). If its lines refuse places, or the head touches those laid before (`beads`), both are done again, a few
//!    times.
//! 5. What is left is a patch: its skins stand from now on.
//!
//! In each round more is cut out around what fails. What has faults after the last one is printed flat:
//! those parts of the piece that hang together, and no others.
//!
//! What is found so may tell that some pieces came too late, since the places that made their homes high
//! can never pass. Then all is done again with lower homes for these (`homes`), and kept if that gives more.

mod beads;
mod candidate;
mod excess;
mod fresh;
mod glance;
mod homes;
mod lay;
mod marks;
mod shrink;
mod smooth;
mod stack;
mod touch;
mod trial;
mod worth;

use crate::geom::Contour;
use crate::geom::boxes::extent;
use crate::geom::spans::Rows;
use crate::nonplanar::field::{Field, Fields};
use crate::nonplanar::grid::{self, STEP, Spot, cell_of};
use crate::nonplanar::patch::{Patch, Patches, Stroke};
use crate::nonplanar::scene::Scene;
use crate::nonplanar::surface::Surface;
use crate::nonplanar::tally::{Areas, Reason};
use crate::region::scan::Scan;
use crate::units::{Coord, to_mm};
use candidate::{Ground, Piece};
use lay::{Coat, lay, steepest, strokes};
use marks::Marks;
use rayon::prelude::*;
use shrink::Refused;
use stack::{Cut, Stack};
use std::ops::Range;
use trial::Trial;

/// What fails when a piece is laid is cut out with so many places around it, round by round.
const ROUNDS: [i32; 5] = [0, 1, 3, 6, 15];

/// So often all is done again with lower homes.
const AGAIN: usize = 2;

/// Decides which places of gentle slopes are printed as skins, and lays these. Gives the heights of the
/// surfaces too, which are known then.
#[must_use]
pub fn patches_and_fields(scene: &Scene<'_>) -> (Patches, Fields) {
    let surfaces = &scene.surfaces.surfaces;
    let found: Vec<(Ground, Vec<Piece>)> = surfaces
        .par_iter()
        .enumerate()
        .map(|(number, surface)| candidate::pieces(scene, number, surface))
        .collect();
    let (mut grounds, pieces): (Vec<Ground>, Vec<Vec<Piece>>) = found.into_iter().unzip();
    let mut best = run(scene, &mut grounds, pieces.into_iter().flatten().collect());
    for _ in 0..AGAIN {
        let Some(pieces) = homes::lower(scene, &mut grounds, &best) else { break };
        let again = run(scene, &mut grounds, pieces);
        if again.mm2 <= best.mm2 {
            break;
        }
        best = again;
    }
    let out = best.finished(scene, &mut grounds);
    let fields = grounds.into_iter().map(|ground| ground.field);
    (out, Fields::new(surfaces.iter().cloned().zip(fields)))
}

/// What became of some pieces.
struct Run {
    /// In the order in which they were tried.
    pieces: Vec<Piece>,
    /// What of them is skin, in plan, mm².
    mm2: f64,
    /// The patches, and the numbers of their pieces.
    patches: Vec<Patch>,
    from: Vec<usize>,
    /// What is said of the places of each surface, and what was said before.
    marks: Vec<Marks>,
    before: Vec<Marks>,
}

/// Tries some pieces. What is said of their places is taken out of `grounds`.
fn run(scene: &Scene<'_>, grounds: &mut [Ground], mut pieces: Vec<Piece>) -> Run {
    // Of equal ones the first surface's, from its first contour: as they come.
    pieces.sort_by(|a, b| {
        a.home
            .cmp(&b.home)
            .then(a.bounds[1].total_cmp(&b.bounds[1]))
            .then(a.surface.cmp(&b.surface))
    });
    let before: Vec<Marks> = grounds.iter().map(|ground| ground.marks.clone()).collect();
    let (mut patches, mut from) = (Vec::new(), Vec::new());
    let mut mm2 = 0.0;
    if !pieces.is_empty() {
        let mut stack = stack(scene, grounds, &pieces);
        for (k, piece) in pieces.iter().enumerate() {
            stack.raise_to(piece.home);
            let ground = &mut grounds[piece.surface];
            if let Some(made) = patch(scene, (k, piece), ground, &mut stack) {
                mm2 += made.areas.last().map_or(0.0, |area| grid::area_mm2(area));
                patches.push(made);
                from.push(k);
            }
        }
    }
    let marks = grounds.iter_mut().zip(&before);
    let marks = marks.map(|(ground, old)| std::mem::replace(&mut ground.marks, old.clone()));
    Run { pieces, mm2, patches, from, marks: marks.collect(), before }
}

impl Run {
    /// The patches in their order, and what became of all tops.
    fn finished(self, scene: &Scene<'_>, grounds: &mut [Ground]) -> Patches {
        for (ground, marks) in grounds.iter_mut().zip(self.marks) {
            ground.marks = marks;
        }
        let mut out = Patches { patches: self.patches, ..Patches::default() };
        for (number, patch) in (1..).zip(&mut out.patches) {
            patch.number = number;
        }
        let from: Vec<&Piece> = self.from.iter().map(|&k| &self.pieces[k]).collect();
        out.mm2 = tally(scene, grounds, &mut out.patches, &from);
        out
    }
}

/// What stands before the first piece is laid, with room for all of them.
fn stack<'a>(scene: &'a Scene<'a>, grounds: &[Ground], pieces: &[Piece]) -> Stack<'a> {
    let (heights, depth) = (scene.slicer.heights(), scene.base_depth());
    let low = pieces.iter().map(|piece| piece.bounds[0]).fold(f64::MAX, f64::min);
    // Two layers more, so that a base is seen.
    let first = heights.planes_up_to((low - f64::from(depth)) as Coord).saturating_sub(2);
    let reach = (scene.params.head.reach() / to_mm(grid::CELL)).ceil() as i32 + 2;
    let corners = || pieces.iter().flat_map(|piece| piece.area.iter().flatten());
    let (from, to) = extent(corners()).unwrap_or_default();
    let around = |low: Coord, high: Coord| -> Range<i32> {
        low.div_euclid(grid::CELL) - reach..high.div_euclid(grid::CELL) + reach
    };
    let mut stack = Stack::new(scene, first, (around(from.x, to.x), around(from.y, to.y)));
    let cut = |piece: &Piece| {
        let field = &grounds[piece.surface].field;
        Cut::new(field, &piece.area, heights, (depth, scene.params.height), 0)
    };
    stack.cuts = pieces.par_iter().map(cut).collect();
    stack
}

/// Tries a piece at its home. What stands afterwards is in the stack.
fn patch(
    scene: &Scene<'_>,
    (k, piece): (usize, &Piece),
    ground: &mut Ground,
    stack: &mut Stack<'_>,
) -> Option<Patch> {
    let surface = scene.surfaces.surfaces.get(piece.surface)?;
    let mut trial = Trial::new(scene, ground, piece, stack);
    let mut coat = None;
    // After the last round at least one part goes each time: that ends.
    for round in 0.. {
        trial.settle(stack);
        if trial.drop_worthless(surface, stack) {
            trial.settle(stack);
        }
        if trial.is_empty() {
            break;
        }
        trial.look_round(stack);
        let Coat { skins, refused } = lay(&trial, surface, stack);
        if refused.iter().all(Refused::is_empty) {
            coat = Some(skins);
            break;
        }
        match ROUNDS.get(round) {
            Some(&by) => trial.cut_around(&refused, by, stack),
            None => trial.give_up(&refused, stack),
        }
    }
    let made = coat.map(|skins| {
        let strokes = strokes(&trial, stack, skins);
        let areas = std::mem::take(&mut trial.areas);
        made(scene, (piece, surface), &trial.ground.field, (areas, strokes))
    });
    let field = &ground.field;
    let (heights, depth) = (scene.slicer.heights(), scene.base_depth());
    let area: &[Contour] = made.as_ref().and_then(|p: &Patch| p.areas.last()).map_or(&[], |a| a);
    stack.cuts[k] = Cut::new(field, area, heights, (depth, scene.params.height), piece.home + 1);
    stack.raise_over(field, &grid::cells(area));
    made
}

/// The patch of what is left of a piece.
fn made(
    scene: &Scene<'_>,
    (piece, surface): (&Piece, &Surface),
    field: &Field,
    (areas, strokes): (Vec<Vec<Contour>>, Vec<Stroke>),
) -> Patch {
    let last = areas.last().map_or(&[][..], |area| area);
    let (low, high) = extent(last.iter().flatten()).unwrap_or_default();
    let bounds = surface.over(last).unwrap_or(piece.bounds);
    let directions = (0..areas.len()).map(|i| scene.direction(i, surface.direction())).collect();
    Patch {
        number: 0,
        surface: piece.surface,
        layer: piece.home,
        top: scene.slicer.heights().top(piece.home),
        strokes,
        extent: [low, high],
        bounds: [bounds[0].floor() as Coord, bounds[1].ceil() as Coord],
        steepest: steepest(field, last),
        directions,
        mm2: Areas::default(),
        areas,
    }
}

/// Adds up what became of all tops, for each patch too, of the piece that it was made from.
fn tally(scene: &Scene<'_>, grounds: &[Ground], patches: &mut [Patch], from: &[&Piece]) -> Areas {
    let tops = &scene.surfaces.tops;
    let mut all = Areas { level: tops.level, ..Areas::default() };
    all.add(Reason::Slope, tops.slope);
    all.add(Reason::Press, tops.press);
    all.add(Reason::Area, tops.small);
    for (number, (ground, surface)) in grounds.iter().zip(&scene.surfaces.surfaces).enumerate() {
        let lists = patches.iter().filter(|patch| patch.surface == number);
        let skins: Vec<Rows> = lists.filter_map(|patch| Some(rows(patch.areas.last()?))).collect();
        let skins = Rows::united(&skins.iter().collect::<Vec<_>>());
        let places: Vec<Spot> = ground.marks.places().collect();
        let mut own = Areas::default();
        for &place in &places {
            count(&mut own, ground, place, holds(&skins, place));
        }
        // Places are counted; the surface's area is known.
        let share = surface.area_mm2(surface.outline()) / own.total().max(f64::MIN_POSITIVE);
        all.skin += own.skin * share;
        all.level += own.level * share;
        for reason in Reason::ALL {
            all.add(reason, own.of(reason) * share);
        }
        for (patch, piece) in patches.iter_mut().zip(from) {
            let Some(area) = patch.areas.last().filter(|_| patch.surface == number) else {
                continue;
            };
            let skin = rows(area);
            for place in grid::spots(&rows(&piece.area), STEP) {
                count(&mut patch.mm2, ground, place, holds(&skin, place));
            }
            patch.mm2.skin *= share;
            patch.mm2.level *= share;
            patch.mm2.flat.iter_mut().for_each(|mm2| *mm2 *= share);
        }
    }
    all
}

/// Adds a place of a surface.
fn count(areas: &mut Areas, ground: &Ground, place: Spot, is_skin: bool) {
    let [x, y] = ground.field.rise(cell_of(place));
    let mm2 = to_mm(STEP).powi(2) * (1.0 + x * x + y * y).sqrt();
    match ground.marks.reason(place) {
        _ if is_skin => areas.skin += mm2,
        _ if ground.marks.is_level(place) => areas.level += mm2,
        reason => areas.add(reason.unwrap_or(Reason::Thin), mm2),
    }
}

/// The places of an area.
fn rows(area: &[Contour]) -> Rows {
    Scan::new(area, grid::raster(STEP)).inside().clone()
}

fn holds(rows: &Rows, [x, y]: Spot) -> bool {
    let (row, x) = (rows.row(y), x * STEP);
    let after = row.partition_point(|span| span.start <= x);
    after > 0 && x < row[after - 1].end
}
