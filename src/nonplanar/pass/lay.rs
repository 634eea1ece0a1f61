//! A piece whose areas have settled -> the paths of its skins, and how high the travels to them go.
//!
//! Skins are laid from the lowest up. Each way of the nozzle is looked at once more, now along its
//! lines: the head may touch nothing of what stands, nor the skins of the piece, as far as it is not
//! press. Where it would, and where a line would have too little or too much room, places are refused
//! and the piece is laid again.
//!
//! A travel within a patch goes straight where nothing at all is touched on the way. Elsewhere it rises
//! above all that it would touch, and by the clearance more. The first one comes from anywhere: it
//! rises above all that stands.

use super::beads::touches;
use super::shrink::{Refused, refuse};
use super::stack::Stack;
use super::touch::{Touch, cell_at, up};
use super::trial::Trial;
use crate::fill::{Path, PathPoint};
use crate::geom::Point;
use crate::geom::spans::Rows;
use crate::head::pile::{Hit, Pile};
use crate::head::sweep::{SAMPLE, deepest, sweep};
use crate::nonplanar::field::Field;
use crate::nonplanar::grid::{self, CELL, Spot, cell_around, cell_of, place_at};
use crate::nonplanar::patch::Stroke;
use crate::nonplanar::skin::{self, Base, Laid, Outside, Skin};
use crate::nonplanar::surface::Surface;
use crate::nonplanar::tally::Reason;
use crate::units::{Coord, to_mm};
use rayon::prelude::*;

/// A travel is raised so often until it is clear.
const LIFTS: usize = 8;

/// The skins of a piece as laid.
pub(super) struct Coat {
    /// The skins' paths, from the lowest skin up.
    pub skins: Vec<Vec<Path>>,
    /// What each skin refuses.
    pub refused: Vec<Refused>,
}

/// What a skin is laid on: the skin below where there is one, what stands elsewhere.
struct Under<'a> {
    field: &'a Field,
    stack: &'a Stack<'a>,
    /// The cells of the skin below, and how far its top lies below the surface.
    below: Option<(Rows, f64)>,
    /// The base is no lower below the surface.
    deepest: f64,
}

impl Base for Under<'_> {
    fn height(&self, at: Point) -> f64 {
        let [x, y] = cell_around(at);
        let holds = |(rows, _): &&(Rows, f64)| {
            rows.row(y).iter().any(|span| span.start <= x * CELL && x * CELL < span.end)
        };
        let below = self.below.as_ref().filter(holds);
        let plane = below.and_then(|(_, lowered)| Some((lowered, self.field.plane([x, y])?)));
        if let Some((lowered, (z, [along, across]))) = plane {
            let (dx, dy) = (f64::from(at.x - x * CELL), f64::from(at.y - y * CELL));
            return z + along * dx + across * dy - lowered;
        }
        let surface = self.field.at([x, y]);
        let height = |cell: Spot| self.stack.height(cell) * crate::units::UNITS_PER_MM;
        let own = height([x, y]);
        // At the edge of a part the middle of a cell may lie beside it.
        if surface.is_some_and(|z| own >= z - self.deepest) {
            return own;
        }
        let beside = (-1..=1).flat_map(|dx| (-1..=1).map(move |dy| [x + dx, y + dy]));
        beside.map(height).fold(own, f64::max)
    }
}

/// Lays the skins of a piece.
pub(super) fn lay(trial: &Trial<'_>, surface: &Surface, stack: &Stack<'_>) -> Coat {
    let scene = trial.scene;
    let (field, params) = (&trial.ground.field, scene.params);
    let layer_top = scene.slicer.heights().top(trial.piece.home);
    let height = f64::from(params.height);
    let mut coat = Coat { skins: Vec::new(), refused: vec![Refused::new(); trial.areas.len()] };
    for (i, area) in trial.areas.iter().enumerate() {
        let lowered = scene.lowered(i);
        let below = i.checked_sub(1).map(|below| {
            let rows = grid::cells(&trial.areas[below]).dilate(CELL, CELL);
            (rows, f64::from(scene.lowered(below)))
        });
        let deepest = f64::from(scene.depth()) + height;
        let under = Under { field, stack, below, deepest };
        let direction = scene.direction(i, surface.direction());
        let skin = Skin { surface, area, lowered, layer_top, direction };
        let Laid { paths, outside, .. } = skin::paths(&skin, &under, params);
        let last = trial.areas.len() - 1;
        for place in outside.iter().flat_map(covered) {
            refuse(&mut coat.refused[last], place, Reason::Overhang);
        }
        let swept = Swept { trial, stack, layer_top };
        for (place, reason) in swept.touches(&paths) {
            refuse(&mut coat.refused[i], place, reason);
        }
        coat.skins.push(paths);
    }
    for (of, touched) in
        coat.refused.iter_mut().zip(touches((trial, surface), &coat.skins, layer_top))
    {
        touched.into_iter().for_each(|(place, reason)| refuse(of, place, reason));
    }
    coat
}

/// The places under a stretch of a line.
fn covered(outside: &Outside) -> Vec<Spot> {
    let (a, b) = (outside.from, outside.to);
    let steps = (a.distance(b) / f64::from(grid::STEP)).ceil().max(1.0);
    let at = |k: usize| {
        let share = k as f64 / steps;
        let on = |a: Coord, b: Coord| to_mm(a) + (to_mm(b) - to_mm(a)) * share;
        place_at([on(a.x, b.x), on(a.y, b.y)])
    };
    (0..=steps as usize).map(at).collect()
}

/// The ways of a skin.
struct Swept<'a> {
    trial: &'a Trial<'a>,
    stack: &'a Stack<'a>,
    layer_top: Coord,
}

impl Swept<'_> {
    /// The places of the nozzle on some paths where the head would touch something.
    fn touches(&self, paths: &[Path]) -> Vec<(Spot, Reason)> {
        let moves: Vec<[PathPoint; 2]> =
            paths.iter().flat_map(|path| path.points.windows(2).map(|w| [w[0], w[1]])).collect();
        let touched = |[a, b]: &[PathPoint; 2]| {
            let (a, b) = (place(a, self.layer_top), place(b, self.layer_top));
            self.on_way(a, b)
        };
        moves.par_iter().flat_map_iter(touched).collect()
    }

    /// Whether a straight way is clear at a glance.
    fn is_clear(&self, a: [f64; 3], b: [f64; 3]) -> bool {
        let length = (a[0] - b[0]).hypot(a[1] - b[1]);
        let steps = (length / SAMPLE).ceil().max(1.0);
        (0..=steps as usize).all(|k| {
            let share = k as f64 / steps;
            let on = |axis: usize| a[axis] + share * (b[axis] - a[axis]);
            let (x, y, z) = (on(0), on(1), on(2));
            self.trial.is_clear(cell_at([x, y]), z)
        })
    }

    /// The places on a straight way. Most ways are clear.
    fn on_way(&self, a: [f64; 3], b: [f64; 3]) -> Vec<(Spot, Reason)> {
        let scene = self.trial.scene;
        let (head, field) = (&scene.params.head, &self.trial.ground.field);
        let layer = scene.params.press_layer();
        let touch = Touch { scene, field, layer };
        let press = |hit: &Hit| touch.is_press(hit);
        let mut out = Vec::new();
        let mut open = vec![(a, b)];
        while let Some((a, b)) = open.pop() {
            if self.is_clear(a, b) {
                continue;
            }
            // What the skins are to themselves is known: they lie on the surface within the tolerance.
            // Beyond the ring where a touch may be press, nothing is touched by then.
            let radius = head.press_radius();
            let (all, others) = (&self.stack.pile, &self.trial.others);
            let is_open = |[x, y, z]: [f64; 3]| !self.trial.is_clear(cell_at([x, y]), z);
            let printing =
                |tip| if is_open(tip) { all.hit_printing(head, tip, layer) } else { None };
            let within = |tip| {
                if is_open(tip) { others.hit_within(head, tip, radius, &press) } else { None }
            };
            let pressed = || deepest(others, head, [a, b], &within);
            let hit = deepest(all, head, [a, b], &printing).or_else(pressed);
            let Some(hit) = hit else { continue };
            let reason = touch.reason(&hit, |cell| self.stack.is_supported(cell));
            let middle = [0, 1, 2].map(|axis| f64::midpoint(a[axis], b[axis]));
            if (a[0] - b[0]).hypot(a[1] - b[1]) <= to_mm(grid::STEP) {
                out.push((place_at([middle[0], middle[1]]), reason));
            } else {
                open.extend([(a, middle), (middle, b)]);
            }
        }
        out
    }
}

/// Where the tip is at a point of a path, mm.
fn place(point: &PathPoint, layer_top: Coord) -> [f64; 3] {
    [to_mm(point.at.x), to_mm(point.at.y), to_mm(layer_top + point.z)]
}

/// The paths of a coat in their order, with their travels. `stack` has all that stood before it.
pub(super) fn strokes(trial: &Trial<'_>, stack: &Stack<'_>, skins: Vec<Vec<Path>>) -> Vec<Stroke> {
    let layer_top = trial.scene.slicer.heights().top(trial.piece.home);
    let clearance = trial.scene.params.clearance;
    let mut out: Vec<Stroke> = Vec::new();
    for path in skins.into_iter().flatten() {
        let ends =
            out.last().and_then(|last: &Stroke| last.path.points.last().zip(path.points.first()));
        let over = match ends {
            Some((a, b)) => {
                let (a, b) = (place(a, layer_top), place(b, layer_top));
                let clear = clear_over(&[&stack.pile, &trial.piece.own], trial, a, b);
                clear.map_or(0, |z| up(z).saturating_add(clearance))
            }
            None => {
                let highest = stack.pile.highest().max(to_mm(layer_top));
                up(highest).saturating_add(clearance)
            }
        };
        out.push(Stroke { path, over });
    }
    out
}

/// The least height, mm, at which the way from `a` to `b` touches nothing; `None` if the straight one does
/// not.
fn clear_over(piles: &[&Pile], trial: &Trial<'_>, a: [f64; 3], b: [f64; 3]) -> Option<f64> {
    let head = &trial.scene.params.head;
    let deepest = |a: [f64; 3], b: [f64; 3]| {
        let hits = piles.iter().filter_map(|pile| sweep(pile, head, a, b, &|_| false));
        hits.map(|hit| hit.depth).max_by(f64::total_cmp)
    };
    deepest(a, b)?;
    let mut z = a[2].max(b[2]);
    for _ in 0..LIFTS {
        match deepest([a[0], a[1], z], [b[0], b[1], z]) {
            Some(depth) => z += depth,
            None => break,
        }
    }
    Some(z)
}

/// The steepest slope of a field over an area's places, degrees.
pub(super) fn steepest(field: &Field, area: &[crate::geom::Contour]) -> f64 {
    let slope = |place: &Spot| {
        let [x, y] = field.rise(cell_of(*place));
        x.hypot(y)
    };
    let places = grid::places(area, CELL);
    let most = places.par_iter().map(slope).reduce(|| 0.0, f64::max);
    libm::atan(most).to_degrees()
}
