//! Skins of successive layers -> which of them nobody sees, and which layer prints them for several.
//!
//! The *depth* of a place of a skin says how many layers lie between it and the air:
//! 1 is the layer that is seen, from above or from below, and is never shared. What lies
//! deeper is grouped by depth, not by the layer's number, since else half of all skins
//! would fall between two groups: depths 2 and 3 are a group of two, whichever layers
//! they are on. A place that is near both to the top and to the bottom belongs to the
//! top. So each place of each layer is in one group at most, and its uppermost
//! layer prints it for all.

use super::runs::Printed;
use crate::geom::raster::Raster;
use crate::geom::spans::{Rows, Span};
use crate::region::params::SkinParams;
use crate::region::prepare::LayerRows;
use crate::units::Coord;

/// As in : exposed stretches shorter than this are noise (50 µm).
const LEAST_SEEN: Coord = 500;

/// Skin narrower than this, in line widths, is not shared: strips on slopes would fall
/// into even narrower ones on every second layer, which take longer.
const LEAST_WIDE: Coord = 6;

/// The layers as one raster sees them.
pub struct Skins<'a, L, S> {
    /// Layers, `None` outside the part.
    pub layers: L,
    /// Their skins, `None` where they are not known: they share nothing.
    pub skins: S,
    /// The raster.
    pub raster: Raster,
    /// Layers of a group.
    pub ratio: usize,
    /// The stage's numbers.
    pub params: &'a SkinParams,
}

/// A group of depths: printed on its uppermost layer.
#[derive(Debug, Clone, Copy)]
struct Depths {
    from_top: bool,
    /// Depth of the layer that prints it.
    depth: usize,
    /// How many layers it has.
    count: usize,
}

impl<'a, L, S> Skins<'a, L, S>
where
    L: Fn(usize) -> Option<&'a LayerRows>,
    S: Fn(usize) -> Option<&'a Rows>,
{
    /// What layer `k` prints for itself and layers below it, and what of its skin is left for
    /// itself alone: the rest is printed by layers above.
    #[must_use]
    pub fn share(&self, k: usize) -> (Printed, Rows) {
        let thick = self.thick(k);
        let mut thin = (self.skins)(k).cloned().unwrap_or_default();
        for (_, rows) in &thick {
            thin = thin.minus(rows);
        }
        for above in 1..self.ratio {
            for (count, rows) in self.thick(k + above) {
                if count as usize > above {
                    thin = thin.minus(&rows);
                }
            }
        }
        (thick, thin)
    }

    /// What layer `k` prints for several layers.
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
                    Some(skin) => rows.and(skin).minus(&self.seen(k - n)),
                    None => Rows::default(),
                };
            }
            // Groups of neighbouring depths end on other layers: a place near both is the upper
            // group's if it lies in its depths, else the lower one's.
            for other in self.depths() {
                for far in 1..self.ratio {
                    rows = rows.minus(&self.core(k + far, other));
                    if far <= k {
                        rows = rows.minus(&self.margined(k - far, other));
                    }
                }
            }
            let long = |_, span: Span| span.len() >= i64::from(self.params.line_width);
            out.push((depths.count as u32, rows.filter(long)));
        }
        out.retain(|(_, rows)| !rows.is_empty());
        out
    }

    /// The groups of two layers or more.
    fn depths(&self) -> impl Iterator<Item = Depths> {
        let groups = |skins: usize, from_top: bool| {
            (2..=skins).step_by(self.ratio).map(move |first| {
                let count = self.ratio.min(skins + 1 - first);
                // From the top the uppermost layer is the nearest to the air, from below the furthest.
                let depth = if from_top { first } else { first + count - 1 };
                Depths { from_top, depth, count }
            })
        };
        let (top, bottom) = (self.params.top, self.params.bottom);
        groups(top, true).chain(groups(bottom, false)).filter(|d| d.count > 1)
    }

    /// Where layer `k` prints a group, with the margin that skins have under and over what
    /// covers them.
    fn margined(&self, k: usize, depths: Depths) -> Rows {
        let core = self.core(k, depths);
        let pitch = self.raster.pitch;
        if core.is_empty() { core } else { core.dilate(self.params.reach, pitch) }
    }

    /// Where layer `k` is the uppermost of a group's depths, with all its layers below.
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
        rows = rows.filter(|_, span| span.len() >= i64::from(LEAST_SEEN));
        for n in 1..depth {
            rows = and(rows, if from_top { up(n) } else { down(n) });
        }
        if rows.is_empty() {
            return rows;
        }
        if from_top {
            // Its lowest layer is not seen from below.
            rows = and(rows, down(count));
        } else {
            for n in 1..=self.params.top {
                rows = and(rows, up(n));
            }
        }
        let rows = (1..count).fold(rows, |rows, n| and(rows, self.fill(k.checked_sub(n))));
        self.wide(k, rows)
    }

    /// What of `rows` of layer `k` is wider than [`LEAST_WIDE`] line widths, or as wide as the part: what is left if
    /// everything around it reaches in by half of that, and it grows again.
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

    /// What is seen of layer `k`, from above or from below, with its margin.
    fn seen(&self, k: usize) -> Rows {
        let Some(fill) = self.fill(Some(k)) else { return Rows::default() };
        let mut hidden = fill.clone();
        for cover in [self.cover(Some(k + 1)), self.cover(k.checked_sub(1))] {
            hidden = cover.map_or_else(Rows::default, |cover| hidden.and(cover));
        }
        let seen = fill.minus(&hidden).filter(|_, span| span.len() >= i64::from(LEAST_SEEN));
        let pitch = self.raster.pitch;
        if seen.is_empty() { seen } else { seen.dilate(self.params.reach, pitch) }
    }

    fn fill(&self, k: Option<usize>) -> Option<&'a Rows> {
        Some(&k.and_then(&self.layers)?.on(self.raster)?.fill)
    }

    fn cover(&self, k: Option<usize>) -> Option<&'a Rows> {
        Some(&k.and_then(&self.layers)?.on(self.raster)?.cover)
    }
}
