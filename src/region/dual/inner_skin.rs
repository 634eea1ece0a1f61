//! Skins of successive layers -> Printed: the hidden skin that one layer prints for several.
//!
//! Words: the *depth* of a place of skin is its layer's number counted from the air, above or
//! below. Depth 1 is the visible layer, which is never shared. The *core* is where a layer is the
//! uppermost of a group; the *margin* is what skin reaches under or over what covers it.
//!
//! Deeper skin is grouped by depth, not by layer number: depths 2 and 3 are a group of two,
//! whichever layers they are on. By layer number, half of all skins would fall between two
//! groups. A place near both the top and the bottom belongs to the top. So each place of each
//! layer is in at most one group, and the uppermost layer of the group prints it for all.
//!
//! Algorithm, for each layer and each group of depths: intersect the layer's skin with the
//! covers of its neighbours to find the core, add the margin, drop what any layer of the group
//! lacks or shows, and drop what neighbouring groups print. This is done on both rasters, and only
//! what both agree on is shared: a layer's lines run along one raster and those of the next along
//! the other, so that what one leaves out the other must print.

use super::runs::Printed;
use crate::geom::outline::Columns;
use crate::geom::raster::Raster;
use crate::geom::spans::{Rows, Span};
use crate::region::params::{NOISE, SkinParams};
use crate::region::prepare::LayerRows;
use crate::units::Coord;

/// Minimum width of shared skin, in line widths. A narrower strip on a slope would be cut into
/// even narrower ones on every second layer. These have more turns and take longer than what
/// sharing saves. A larger value shares less skin.
const LEAST_WIDE: Coord = 6;

/// What layer `k` prints for itself and layers below, and the skin that it prints for itself alone,
/// on two rasters of which the second is turned by +90°. Layers above print the rest.
#[must_use]
pub fn share<'a, L, S, T>(skins: &[Skins<'a, L, S, T>; 2], k: usize) -> [(Printed, Rows); 2]
where
    L: Fn(usize) -> Option<&'a LayerRows>,
    S: Fn(usize) -> Option<&'a Rows>,
    T: Fn(usize) -> bool,
{
    let thick = agreed(skins, k);
    let mut thin = [0, 1].map(|r| (skins[r].skins)(k).cloned().unwrap_or_default());
    for above in 0..skins[0].ratio {
        let printed = if above == 0 { &thick } else { &agreed(skins, k + above) };
        for (thin, printed) in thin.iter_mut().zip(printed) {
            let reaches = printed.iter().filter(|(count, _)| *count as usize > above);
            reaches.for_each(|(_, rows)| *thin = thin.minus(rows));
        }
    }
    let [a, b] = thick;
    let [thin, thin_across] = thin;
    [(a, thin), (b, thin_across)]
}

/// What layer `k` prints for several layers: what both rasters have, but for their edges.
fn agreed<'a, L, S, T>(skins: &[Skins<'a, L, S, T>; 2], k: usize) -> [Printed; 2]
where
    L: Fn(usize) -> Option<&'a LayerRows>,
    S: Fn(usize) -> Option<&'a Rows>,
    T: Fn(usize) -> bool,
{
    if (skins[0].thin)(k) {
        return [Printed::new(), Printed::new()];
    }
    let both = [skins[0].thick(k), skins[1].thick(k)];
    let least = i64::from(skins[0].params.line_width);
    [0, 1].map(|r| {
        let agreed = both[r].iter().filter_map(|(count, rows)| {
            let (_, across) = both[1 - r].iter().find(|(c, _)| c == count)?;
            let pitch = skins[1 - r].raster.pitch;
            let columns = Columns { rows: across, pitch, left_turn: r == 0 };
            let held = columns.held(rows, skins[r].raster.pitch);
            let rows = rows.minus(&rows.minus(&held).filter(|_, span| span.len() >= least));
            let rows = rows.filter(|_, span| span.len() >= least);
            (!rows.is_empty()).then_some((*count, rows))
        });
        agreed.collect()
    })
}

/// The layers on one raster.
pub struct Skins<'a, L, S, T> {
    /// Layers, `None` outside the part.
    pub layers: L,
    /// Their skins; a layer with `None` shares nothing.
    pub skins: S,
    /// Whether a layer prints nothing for others.
    pub thin: T,
    /// The raster.
    pub raster: Raster,
    /// Layers of a group.
    pub ratio: usize,
    /// The stage's numbers.
    pub params: &'a SkinParams,
}

/// Columns of the skin that a layer prints for itself, without threads: those that no row crosses,
/// beside shared skin whose last line leaves less than half a line open. A bead there would lie on
/// that line. `whole` is all skin of the layer, and its rows lie `pitch` apart.
#[must_use]
pub fn without_threads(own: &Rows, whole: &Rows, pitch: Coord) -> Rows {
    let below = |at: Coord| at.div_euclid(pitch) * pitch;
    let above = |at: Coord| -below(-at);
    let has_room = |j: i32, s: Span| {
        if above(s.start) <= s.end {
            return true;
        }
        let around = whole.span_at(j, s.start).filter(|w| s.end <= w.end);
        let ends = around.map_or([true; 2], |w| [w.start == s.start, w.end == s.end]);
        match ends {
            [true, true] => true,
            [false, false] => false,
            [false, true] => 2 * (s.end - below(s.start)) >= pitch,
            [true, false] => 2 * (above(s.end) - s.start) >= pitch,
        }
    };
    own.filter(has_room)
}

/// A group of depths: printed on its uppermost layer.
#[derive(Debug, Clone, Copy)]
struct Depths {
    from_top: bool,
    /// Depth of the layer that prints it.
    depth: usize,
    /// Number of its layers.
    count: usize,
}

impl<'a, L, S, T> Skins<'a, L, S, T>
where
    L: Fn(usize) -> Option<&'a LayerRows>,
    S: Fn(usize) -> Option<&'a Rows>,
    T: Fn(usize) -> bool,
{
    /// What layer `k` prints for several layers: at most one entry for each number of layers.
    fn thick(&self, k: usize) -> Printed {
        let mut out = Printed::new();
        for depths in self.depths() {
            let mut rows = self.margined(k, depths);
            if rows.is_empty() {
                continue;
            }
            for (_, other) in &out {
                rows = rows.minus(other);
            }
            for n in 0..depths.count {
                rows = match (self.skins)(k.wrapping_sub(n)) {
                    Some(skin) => rows.and(skin).minus(&self.visible(k - n)),
                    None => Rows::default(),
                };
            }
            // Groups of other layers may reach here too. A place in the core of the upper group
            // belongs to that group, any other place to the lower one.
            for other in self.depths() {
                for far in 1..self.ratio {
                    rows = rows.minus(&self.core(k + far, other));
                    if far <= k {
                        rows = rows.minus(&self.margined(k - far, other));
                    }
                }
            }
            let long = |_, span: Span| span.len() >= i64::from(self.params.line_width);
            let (count, rows) = (depths.count as u32, rows.filter(long));
            match out.iter_mut().find(|(c, _)| *c == count) {
                Some((_, all)) => *all = all.or(&rows),
                None => out.push((count, rows)),
            }
        }
        out.retain(|(_, rows)| !rows.is_empty());
        out
    }

    /// The groups of two layers or more.
    fn depths(&self) -> impl Iterator<Item = Depths> {
        let groups = |skins: usize, from_top: bool| {
            (2..=skins).step_by(self.ratio).map(move |first| {
                let count = self.ratio.min(skins + 1 - first);
                // The uppermost layer is the nearest to the air at a top, the furthest at a bottom.
                let depth = if from_top { first } else { first + count - 1 };
                Depths { from_top, depth, count }
            })
        };
        let (top, bottom) = (self.params.top, self.params.bottom);
        groups(top, true).chain(groups(bottom, false)).filter(|d| d.count > 1)
    }

    /// Where layer `k` prints a group, with the margin.
    fn margined(&self, k: usize, depths: Depths) -> Rows {
        let core = self.core(k, depths);
        let pitch = self.raster.pitch;
        if core.is_empty() { core } else { core.dilate(self.params.reach, pitch) }
    }

    /// Where layer `k` is the uppermost of a group and all other layers of the group are below.
    fn core(&self, k: usize, depths: Depths) -> Rows {
        let Depths { from_top, depth, count } = depths;
        let Some(skin) = (self.skins)(k) else { return Rows::default() };
        let mut rows = skin.clone();
        let up = |n: usize| self.cover(Some(k + n));
        let down = |n: usize| self.cover(k.checked_sub(n));
        let and = |rows: Rows, cover: Option<&Rows>| match cover {
            Some(cover) => rows.and(cover),
            None => Rows::default(),
        };
        let ends = if from_top { up(depth) } else { down(depth) };
        if let Some(cover) = ends {
            rows = rows.minus(cover);
        }
        rows = rows.filter(|_, span| span.len() >= NOISE);
        for n in 1..depth {
            rows = and(rows, if from_top { up(n) } else { down(n) });
        }
        if rows.is_empty() {
            return rows;
        }
        if from_top {
            // The group's lowest layer must not be visible from below.
            rows = and(rows, down(count));
        } else {
            for n in 1..=self.params.top {
                rows = and(rows, up(n));
            }
        }
        let rows = (1..count).fold(rows, |rows, n| and(rows, self.fill(k.checked_sub(n))));
        self.wide(k, rows)
    }

    /// The part of `rows` of layer `k` that is wider than [`LEAST_WIDE`] line widths, or as wide
    /// as the part. This is an opening: shrink from all around by half of that, then grow back.
    fn wide(&self, k: usize, rows: Rows) -> Rows {
        let Some(fill) = self.fill(Some(k)) else { return Rows::default() };
        let pitch = self.raster.pitch;
        let half = self.params.line_width * LEAST_WIDE / 2;
        let around = fill.minus(&rows);
        if around.is_empty() || rows.is_empty() {
            return rows;
        }
        let inmost = rows.minus(&around.dilate(half, pitch));
        if inmost.is_empty() { inmost } else { rows.and(&inmost.dilate(half, pitch)) }
    }

    /// The visible part of layer `k`, from above or from below, with its margin.
    fn visible(&self, k: usize) -> Rows {
        let Some(fill) = self.fill(Some(k)) else { return Rows::default() };
        let mut hidden = fill.clone();
        for cover in [self.cover(Some(k + 1)), self.cover(k.checked_sub(1))] {
            hidden = cover.map_or_else(Rows::default, |cover| hidden.and(cover));
        }
        let visible = fill.minus(&hidden).filter(|_, span| span.len() >= NOISE);
        let pitch = self.raster.pitch;
        if visible.is_empty() { visible } else { visible.dilate(self.params.reach, pitch) }
    }

    fn fill(&self, k: Option<usize>) -> Option<&'a Rows> {
        Some(&k.and_then(&self.layers)?.on(self.raster)?.fill)
    }

    fn cover(&self, k: Option<usize>) -> Option<&'a Rows> {
        Some(&k.and_then(&self.layers)?.on(self.raster)?.cover)
    }
}
