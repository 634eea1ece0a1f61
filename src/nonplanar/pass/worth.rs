//! A piece that has settled -> what of it is worth its lines.

use super::candidate::{has_treads, places};
use super::shrink::Refused;
use super::stack::Stack;
use super::trial::Trial;
use crate::geom::Contour;
use crate::geom::spans::Rows;
use crate::nonplanar::grid::{self, STEP, cell_of};
use crate::nonplanar::surface::Surface;
use crate::nonplanar::tally::Reason;

impl Trial<'_> {
    /// Leaves to be printed flat what is not worth its lines; whether there was any.
    pub(super) fn drop_worthless(&mut self, surface: &Surface, stack: &mut Stack<'_>) -> bool {
        if self.is_striped() {
            return self.drop(&self.whole(), Some(Reason::Overhang), stack);
        }
        let is_level = |part: &Vec<Contour>| {
            !self.has_treads_at_places(part)
                && surface.over(part).is_none_or(|bounds| !has_treads(self.scene, bounds))
        };
        let level: Vec<Contour> =
            grid::pieces(&self.whole()).into_iter().filter(is_level).flatten().collect();
        self.drop(&level, None, stack)
    }

    /// Whether the places of a part tell that there are treads. It is quicker than to look at all of its surface.
    fn has_treads_at_places(&self, part: &[Contour]) -> bool {
        let field = &self.ground.field;
        let heights = grid::spots(&places(part), STEP).into_iter();
        let heights = heights.filter_map(|place| field.at(cell_of(place)));
        let [low, high] =
            heights.fold([f64::MAX, f64::MIN], |[low, high], z| [low.min(z), high.max(z)]);
        // A unit less, since a field's heights are rounded.
        low < high && has_treads(self.scene, [low + 1.0, high - 1.0])
    }

    /// The area of the last skin.
    fn whole(&self) -> Vec<Contour> {
        self.areas.last().cloned().unwrap_or_default()
    }

    /// Whether more than a quarter of the piece is lost, most of that since a line has no room there: tread
    /// by tread a stripe, if layers are too high for the nozzle. Stripes of skin between flat ones are
    /// rougher than all flat.
    fn is_striped(&self) -> bool {
        let all = places(&self.piece.area);
        let lost = grid::spots(&all.minus(&places(&self.whole())), STEP);
        let has_no_room =
            |place: &&[i32; 2]| self.ground.marks.reason(**place) == Some(Reason::Overhang);
        let stripes = lost.iter().filter(has_no_room).count();
        4 * lost.len() > count(&all) && 2 * stripes > lost.len()
    }

    /// Cuts parts of the last skin out; without a reason, they are as well printed flat.
    fn drop(&mut self, area: &[Contour], why: Option<Reason>, stack: &mut Stack<'_>) -> bool {
        let Some(last) = self.areas.len().checked_sub(1).filter(|_| !area.is_empty()) else {
            return false;
        };
        let rows = places(area);
        if why.is_none() {
            self.ground.marks.mark_level(&rows);
        }
        let mut out = vec![Refused::new(); self.areas.len()];
        let why = why.unwrap_or(Reason::Thin);
        out[last] = grid::spots(&rows, STEP).into_iter().map(|place| (place, why)).collect();
        self.cut(&out, stack);
        true
    }
}

/// How many places these are.
fn count(rows: &Rows) -> usize {
    grid::spots(rows, STEP).len()
}
