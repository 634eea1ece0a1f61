//! A piece at its home -> its skins' areas: what passes, with all that stands there.
//!
//! The head is tried at all places of each skin's area. Skin i lies (n − i) skin heights below the
//! surface, so its tip is lower where it is not the last.
//!
//! - A place that fails for the last skin is refused to all: it is printed flat, in treads of half a layer
//!   below to half a layer above the surface. A place that fails for a lower skin only leaves that one: the
//!   base ends higher there. So a flat zone does not grow: beside it, on a slope of 10° with a flat of 1 mm
//!   and layers of 0.2 mm, the last skin's tip touches treads that stand 0.1 mm over the surface, and the
//!   slope adds 0.1 mm under the flat's uphill edge: 0.2 of the 0.3 mm that may be pressed. The first
//!   skin's tip is 0.2 mm lower: that one keeps 0.6 mm off. Beside the base that is left, which stands 0.1
//!   mm over it, it may lie.
//! - Treads are piled up where the slicer puts them. Taken as half a layer above the surface everywhere,
//!   they and the press of the steepest slope would be all that may be pressed, ring after ring, until the
//!   slope is gentle. As they are, only edges that lie under the flat's uphill rim are in the way.
//! - What is printed flat instead is raised in the stack, and all is tried again until nothing fails.
//!   Areas only shrink and what stands only grows: that ends.
//! - *Later* lines are those of layers above the home that are no higher than the piece's top: the skins
//!   stand beside them. They are tried the other way round: a head upside down over a pile of their tips.

use super::candidate::{Ground, Piece};
use super::excess::OfLines;
use super::fresh::{Fresh, block_of};
use super::glance::{Glance, Under};
use super::shrink::{Refused, most, nearest, refuse, shrink_all, widened};
use super::stack::{Stack, WIDER, heights_over};
use super::touch::{Touch, cell_at, mm};
use crate::geom::Contour;
use crate::geom::boxes::extent;
use crate::geom::spans::Rows;
use crate::head::Head;
use crate::head::pile::{Hit, Pile};
use crate::nonplanar::field::Field;
use crate::nonplanar::grid::{self, CELL, Spot, cell_of};
use crate::nonplanar::scene::Scene;
use crate::nonplanar::tally::Reason;
use crate::units::{Coord, to_mm, to_units};
use rayon::prelude::*;
use std::collections::BTreeSet;

/// Rounding of heights, mm.
const ROUNDING: f64 = 2e-4;

/// What lies lower than the lowest skin by this share of its height is base: a base ends half a skin
/// height below it at the highest, but for rounding.
const LOWER: f64 = 0.2;

/// A piece that is tried.
pub(super) struct Trial<'a> {
    pub scene: &'a Scene<'a>,
    pub ground: &'a mut Ground,
    pub piece: &'a Piece,
    /// The area of each skin, from the lowest up.
    pub areas: Vec<Vec<Contour>>,
    /// What stands around the piece that is neither its surface nor its base.
    pub others: Pile,
    /// Where what stands leaves room for the head, at a glance; `None` until it is asked for.
    glance: Option<Glance>,
    /// Where lines on the surface leave room for it, at a glance; once it is asked for.
    pub of_lines: OfLines,
    later: Option<Later>,
    /// What may fail now, if all places were tried before.
    fresh: Option<Fresh>,
}

/// The tips of later lines.
struct Later {
    head: Head,
    pile: Pile,
    low: Spot,
    /// Where a part goes on above the piece's top.
    higher: Rows,
    /// The top of the lowest of these layers, and its middle.
    top: Coord,
    plane: Coord,
}

impl<'a> Trial<'a> {
    /// A piece with all skins everywhere.
    pub(super) fn new(
        scene: &'a Scene<'a>,
        ground: &'a mut Ground,
        piece: &'a Piece,
        stack: &mut Stack<'_>,
    ) -> Self {
        let areas = vec![piece.area.clone(); scene.params.skins as usize];
        let later = Later::new(scene, piece, stack);
        let others = others(scene, &ground.field, piece, stack);
        let mut trial = Self {
            scene,
            ground,
            piece,
            areas,
            others,
            glance: None,
            of_lines: OfLines::default(),
            later,
            fresh: None,
        };
        trial.cut_beneath(stack);
        trial
    }

    /// Cuts out what lies inside of the part: shells of a part may overlap.
    fn cut_beneath(&mut self, stack: &mut Stack<'_>) {
        let Piece { area, bounds, .. } = self.piece;
        let beneath = stack.beneath(&self.ground.field, area, bounds[1]);
        if beneath.is_empty() {
            return;
        }
        let mut refused = vec![Refused::new(); self.areas.len()];
        if let Some(last) = refused.last_mut() {
            let place = |cell: Spot| cell.map(|v| v.div_euclid(2));
            beneath.into_iter().for_each(|cell| refuse(last, place(cell), Reason::Obstacle));
        }
        self.cut(&refused, stack);
        // Nothing was tried yet.
        self.fresh = None;
    }

    /// Whether nothing is left.
    pub(super) fn is_empty(&self) -> bool {
        self.areas.last().is_none_or(Vec::is_empty)
    }

    /// Shrinks the areas until all places pass.
    pub(super) fn settle(&mut self, stack: &mut Stack<'_>) {
        if self.fresh.is_none() {
            self.look_round(stack);
        }
        while !self.is_empty() {
            let refused = self.refused(stack);
            if refused.iter().all(Refused::is_empty) {
                return;
            }
            self.cut(&refused, stack);
        }
    }

    /// Makes sure that it is known where there is room for the head at a glance.
    pub(super) fn look_round(&mut self, stack: &Stack<'_>) {
        if self.glance.is_none() && !self.is_empty() {
            self.glance = Some(self.look(stack));
        }
    }

    /// What stands around the piece, but for what lies so low below its surface that only skins would
    /// touch it.
    fn look(&self, stack: &Stack<'_>) -> Glance {
        let params = self.scene.params;
        let (from, to) = extent(self.piece.area.iter().flatten()).unwrap_or_default();
        let depth = f64::from(self.scene.lowered(0)) + LOWER * f64::from(params.height);
        let most = stack.pile.highest() - mm(self.piece.bounds[0] - depth);
        let reach = (params.head.reach_below(most) / to_mm(CELL)).ceil() as i32 + 2;
        let low = [from.x, from.y].map(|v| v.div_euclid(CELL) - reach);
        let high = [to.x, to.y].map(|v| v.div_euclid(CELL) + reach);
        let row = |y: i32| {
            (low[0]..high[0]).map(move |x| {
                let stands = stack.height([x, y]);
                let base = self.ground.field.at([x, y]).map(|z| mm(z - depth));
                if base.is_some_and(|base| stands <= base) {
                    f32::NEG_INFINITY
                } else {
                    stands as f32
                }
            })
        };
        let heights: Vec<f32> = (low[1]..high[1]).into_par_iter().flat_map_iter(row).collect();
        let columns = usize::try_from(high[0] - low[0]).unwrap_or(1);
        let highest = heights.iter().copied().fold(f32::MIN, f32::max);
        let most = f64::from(highest) - mm(self.piece.bounds[0] - depth);
        Glance::new(low, columns, heights, Under::of(&params.head, most))
    }

    /// Whether the head touches nothing, at a glance, with its tip so high, mm, over a cell of the piece.
    pub(super) fn is_clear(&self, cell: Spot, tip: f64) -> bool {
        let surface = self.ground.field.at(cell).map(mm);
        self.glance.as_ref().is_some_and(|glance| glance.is_clear(cell, tip))
            && (self.piece.glance.as_ref().as_ref().zip(surface))
                .is_some_and(|(glance, z)| glance.is_clear(cell, z))
    }

    /// The places of each skin that fail. Where the lowest one touches nothing, those above do not either: their
    /// tips are higher.
    fn refused(&self, stack: &Stack<'_>) -> Vec<Refused> {
        let last = self.areas.len() - 1;
        let inset = self.scene.params.line_width / 2;
        let mut out: Vec<Refused> = Vec::new();
        // The places of the skin below, row by row, and whether each is known to touch nothing.
        let mut below: (Vec<Spot>, Vec<bool>) = Default::default();
        for (i, area) in self.areas.iter().enumerate() {
            let same = i.checked_sub(1).is_some_and(|below| self.areas[below] == *area);
            let places = if same { below.0.clone() } else { grid::places(area, inset) };
            let by_row = |[x, y]: &Spot| [*y, *x];
            let is_known = |k: usize| {
                let at = || below.0.binary_search_by_key(&by_row(&places[k]), by_row).ok();
                let at = if same { Some(k) } else { at() };
                at.is_some_and(|at| below.1[at])
            };
            let tried = |k: usize| {
                let place = places[k];
                if !self.is_fresh(place) {
                    return (true, None);
                }
                let hit = if is_known(k) { None } else { self.touches(place, i, stack) };
                (hit.is_none(), hit.or_else(|| self.hinders(place).filter(|_| i == last)))
            };
            let tried: Vec<(bool, Option<Reason>)> =
                (0..places.len()).into_par_iter().map(tried).collect();
            let failed =
                places.iter().zip(&tried).filter_map(|(place, (_, why))| Some((*place, (*why)?)));
            out.push(failed.collect());
            below = (places, tried.into_iter().map(|(clear, _)| clear).collect());
        }
        self.without_base(stack, &mut out);
        out
    }

    /// Whether something was raised in reach of a place since it passed.
    fn is_fresh(&self, place: Spot) -> bool {
        self.fresh.as_ref().is_none_or(|fresh| fresh.is_near(place))
    }

    /// What the head touches that lays skin `i` at a place.
    fn touches(&self, place: Spot, i: usize, stack: &Stack<'_>) -> Option<Reason> {
        let cell = cell_of(place);
        let z = self.ground.field.at(cell)?;
        let [x, y] = grid::middle(cell);
        let tip = [x, y, mm(z - f64::from(self.scene.lowered(i)))];
        let (head, touch) = (&self.scene.params.head, self.touch());
        let hit = match &self.fresh {
            Some(fresh) if fresh.is_clear(cell, tip[2]) => return None,
            Some(fresh) => fresh.risen.as_ref()?.hit_printing(head, tip, touch.layer)?,
            None if self.is_clear(cell, tip[2]) => return None,
            None => {
                // Press goes into its own surface alone. What else may be touched is known by then.
                let radius = head.press_radius();
                let pressed =
                    || self.others.hit_within(head, tip, radius, &|hit| touch.is_press(hit));
                stack.pile.hit_printing(head, tip, touch.layer).or_else(pressed)?
            }
        };
        Some(touch.reason(&hit, |cell| stack.is_supported(cell)))
    }

    /// Why the skins at a place are in the way of later lines.
    fn hinders(&self, place: Spot) -> Option<Reason> {
        let (later, cell) = (self.later.as_ref()?, cell_of(place));
        later.fails(&self.touch(), grid::middle(cell), self.ground.field.at(cell)?)
    }

    fn touch(&self) -> Touch<'_> {
        let layer = self.scene.params.press_layer_at_places();
        Touch { scene: self.scene, field: &self.ground.field, layer }
    }

    /// Adds places where the lowest skin has no base at its height to those of the last skin.
    fn without_base(&self, stack: &Stack<'_>, refused: &mut [Refused]) {
        let last = refused.len() - 1;
        let heights = self.scene.params.bead_heights();
        let room = mm(*heights.start()) - ROUNDING..=mm(*heights.end()) + ROUNDING;
        let Some(lowest) = self.areas.iter().position(|area| !area.is_empty()) else { return };
        let inset = self.scene.params.line_width / 2;
        let lacks = |place: &Spot| {
            let cell = cell_of(*place);
            let top = mm(self.ground.field.at(cell)? - f64::from(self.scene.lowered(lowest)));
            (!room.contains(&(top - stack.height(cell)))).then_some(*place)
        };
        let places = grid::places(&self.areas[lowest], inset);
        let asked = places.par_iter().filter(|place| self.is_fresh(**place));
        let lacking: Vec<Spot> = asked.filter_map(lacks).collect();
        // What the head touches there has the better reason.
        for place in lacking {
            if !refused[lowest].contains_key(&place) {
                refuse(&mut refused[last], place, Reason::Overhang);
            }
        }
    }

    /// Cuts places out, with all those within so many places around them.
    pub(super) fn cut_around(&mut self, refused: &[Refused], by: i32, stack: &mut Stack<'_>) {
        let wide: Vec<Refused> = refused.iter().map(|own| widened(own, by)).collect();
        self.cut(&wide, stack);
    }

    /// Cuts places out, and raises what is printed flat there instead.
    pub(super) fn cut(&mut self, refused: &[Refused], stack: &mut Stack<'_>) {
        let old: Vec<Rows> = self.areas.iter().map(|area| grid::cells(area)).collect();
        let marks = &mut self.ground.marks;
        self.areas = shrink_all(&self.areas, refused, marks, self.scene.params);
        let heights = self.scene.slicer.heights();
        let most = to_mm(heights.top(self.piece.home));
        let mut raised: BTreeSet<Spot> = BTreeSet::new();
        let mut risen: Vec<Spot> = Vec::new();
        let mut last_block = None;
        for (i, old) in old.iter().enumerate() {
            let lost = old.minus(&grid::cells(&self.areas[i]));
            let last = i + 1 == self.areas.len();
            for (cell, z) in heights_over(&self.ground.field, &lost) {
                let below = if last { 0 } else { self.below_surface(i) };
                // A tread reaches to the edge of a cell whose middle lies beside it.
                let [x, y] = self.ground.field.rise(cell);
                let further = if last { x.hypot(y) * to_mm(CELL) / 2.0 } else { 0.0 };
                if stack.raise(cell, self.flat_end(z + further, below).min(most)) {
                    risen.push(cell);
                }
                let block = block_of(cell);
                // Most cells lie in the block of the one before.
                if last_block.replace(block) != Some(block) {
                    raised.insert(block);
                }
                if let Some(later) = self.later.as_mut().filter(|_| last) {
                    later.add(cell, z);
                }
            }
        }
        let fresh = Fresh::new((self.scene, self.piece), (&raised, &risen), stack);
        if let (Some(all), Some(glance)) = (self.glance.as_mut(), &fresh.glance) {
            all.add(glance);
        }
        self.fresh = Some(fresh);
    }
}

impl Trial<'_> {
    /// How far below the surface the base ends where skin `i` is not laid.
    fn below_surface(&self, i: usize) -> Coord {
        self.scene.lowered(i) - self.scene.params.raised()
    }

    /// How high what is printed flat stands, mm, so far below a surface at `z`: as many layers as the slicer
    /// makes of it, or as [`base`](crate::nonplanar::base) leaves.
    fn flat_end(&self, z: f64, below: Coord) -> f64 {
        let heights = self.scene.slicer.heights();
        let count = heights.planes_up_to(to_units(z) - below);
        count.checked_sub(1).map_or(0.0, |k| to_mm(heights.top(k)))
    }

    /// Prints those pieces of what is left flat that hold refused places; all of it if none does.
    pub(super) fn give_up(&mut self, refused: &[Refused], stack: &mut Stack<'_>) {
        let Some(last) = self.areas.len().checked_sub(1) else { return };
        let all: Refused =
            refused.iter().flatten().map(|(place, reason)| (*place, *reason)).collect();
        let most = most(&all);
        let pieces = grid::pieces(&self.areas[last]);
        let places = pieces.iter().map(|piece| grid::places(piece, 0)).collect::<Vec<_>>();
        // A line's end may lie beside the places of its piece.
        let fails = |piece: &&Vec<Spot>| piece.iter().any(|place| nearest(&all, *place).is_some());
        let failing: Vec<&Vec<Spot>> = places.iter().filter(fails).collect();
        let given = if failing.is_empty() { places.iter().collect() } else { failing };
        let is_all = given.len() == places.len();
        let told = |place: &Spot| (*place, nearest(&all, *place).unwrap_or(most));
        let mut out = vec![Refused::new(); self.areas.len()];
        out[last] = given.into_iter().flatten().map(told).collect();
        self.cut(&out, stack);
        if is_all {
            self.areas.iter_mut().for_each(Vec::clear);
        }
    }
}

/// What stands near a piece and is not known to be its own surface: nothing of it may be pressed unless it
/// continues the surface. Further off nothing is pressed at all.
fn others(scene: &Scene<'_>, field: &Field, piece: &Piece, stack: &Stack<'_>) -> Pile {
    let (from, to) = extent(piece.area.iter().flatten()).unwrap_or_default();
    let reach = (scene.params.head.press_radius() / to_mm(CELL)).ceil() as i32 + 2;
    let low = [from.x, from.y].map(|v| v.div_euclid(CELL) - reach);
    let high = [to.x, to.y].map(|v| v.div_euclid(CELL) + reach);
    let corner = |cell: Spot| grid::middle(cell).map(|v| v - to_mm(CELL) / 2.0);
    let mut pile = Pile::new(corner(low), corner(high), to_mm(CELL)).wider(WIDER);
    let touch = Touch { scene, field, layer: scene.params.press_layer() };
    for y in low[1]..high[1] {
        for x in low[0]..high[0] {
            let height = stack.height([x, y]);
            if !touch.is_surface([x, y], height) {
                pile.raise([(x - low[0]) as usize, (y - low[1]) as usize], height);
            }
        }
    }
    pile
}

impl Later {
    /// The later lines beside a piece, if any layer above its home is lower than its top.
    fn new(scene: &Scene<'_>, piece: &Piece, stack: &mut Stack<'_>) -> Option<Self> {
        let (heights, params) = (scene.slicer.heights(), scene.params);
        let high = piece.bounds[1];
        let all = piece.home + 1..heights.count();
        let layers: Vec<usize> = all.take_while(|&k| f64::from(heights.top(k)) < high).collect();
        let lowest = *layers.first()?;
        let (from, to) = extent(piece.area.iter().flatten())?;
        let reach = (params.head.reach() / to_mm(CELL)).ceil() as i32 + 1;
        let low = [from.x, from.y].map(|v| v.div_euclid(CELL) - reach);
        let high_cell = [to.x, to.y].map(|v| v.div_euclid(CELL) + reach + 2);
        let corner = |cell: Spot| grid::middle(cell).map(|v| v - to_mm(CELL) / 2.0);
        let pile = Pile::new(corner(low), corner(high_cell), to_mm(CELL));
        let (top, plane) = (heights.top(lowest), heights.plane(lowest));
        let higher = heights.planes_up_to(high as Coord + params.height / 2);
        let higher = stack.section(higher).map(|section| section.solid.clone());
        let (head, higher) = (params.head.mirrored(), higher.unwrap_or_default());
        let mut later = Self { head, pile, low, higher, top, plane };
        let own = grid::cells(&piece.area);
        for k in layers {
            let Some(section) = stack.section(k).cloned() else { break };
            let standing = stack.standing(k, &section).minus(&own);
            // Lines keep half a line off the edge.
            let tips = standing.erode(params.line_width / 2, CELL);
            for cell in grid::spots(&tips, CELL) {
                later.raise(cell, -to_mm(heights.top(k)));
            }
        }
        Some(later)
    }

    fn raise(&mut self, cell: Spot, z: f64) {
        if let Some(cell) = grid::counted(cell, self.low) {
            self.pile.raise(cell, z);
        }
    }

    /// A cell of the piece whose surface lies at `z`, mm, is printed flat.
    fn add(&mut self, cell: Spot, z: f64) {
        if z > to_mm(self.plane) {
            self.raise(cell, -to_mm(self.top));
        }
    }

    /// Why the skins at a place are in the way of later lines.
    fn fails(&self, touch: &Touch<'_>, [x, y]: [f64; 2], z: f64) -> Option<Reason> {
        if z <= f64::from(self.top) {
            return None;
        }
        let params = touch.scene.params;
        let goes_on = |[x, y]: Spot| {
            let row = self.higher.row(y).iter();
            row.clone().any(|span| span.start <= x * CELL && x * CELL < span.end)
        };
        // A plateau continues the surface; what goes on above it does not.
        let spare = |hit: &Hit| params.head.presses(hit, touch.layer) && !goes_on(cell_at(hit.at));
        let hit = self.pile.hit(&self.head, [x, y, -mm(z)], &spare)?;
        let is_same = touch.body(hit.at) == touch.body([x, y]);
        Some(if is_same { Reason::Obstacle } else { Reason::Neighbour })
    }
}
