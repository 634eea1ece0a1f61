//! Columns -> Columns: support that carries nothing is left out, all the way down or up.
//!
//! Words: support is *idle* if nothing hangs above it, and no support that is not idle.
//!
//! 1. What was lost on the way down ([`mod@super::columns`]) is removed from the layers above as
//!    well: it would hang there beside the foot of its post.
//! 2. Specks are dropped, and what nothing carries ([`mod@super::stand`]). So some posts lose their
//!    tops: from the top down, what lies below neither an overhang nor other support is removed, with
//!    what has grown from it.

use super::columns::Column;
use super::params::SupportParams;
use super::pieces::Pieces;
use super::posts::STEP;
use crate::geom::spans::Rows;

/// A post may lose so many layers at its top, at least: what it carries sags no further than onto it.
/// With less, slopes near the threshold lose their support, whose upper end stands beside them.
const LOST_LAYERS: usize = 2;

/// Removes what is above that which was lost.
pub(super) fn drop_lost(columns: &mut [Column]) {
    let mut lost = Rows::default();
    for column in columns {
        let above = lost.and(&column.all);
        if !above.is_empty() {
            column.all = column.all.minus(&above);
            column.reach = column.reach.minus(&above);
        }
        lost = above.or(&std::mem::take(&mut column.lost));
    }
}

/// Removes what carries nothing.
pub(super) fn drop_idle(columns: &mut [Column], params: &SupportParams) {
    let layers = params.interface_layers.max(LOST_LAYERS);
    let (mut idle, mut above) = (Rows::default(), Rows::default());
    for k in (0..columns.len()).rev() {
        let hangs = columns[k..].iter().take(layers + 1).map(|column| &column.hangs);
        let carried = hangs.fold(std::mem::take(&mut above), |all, hangs| all.or(hangs));
        let here = &mut columns[k];
        idle = idle_of(&here.all, &carried, &idle, params);
        if !idle.is_empty() {
            here.all = here.all.minus(&idle);
            here.reach = here.reach.minus(&idle);
        }
        above = here.all.clone();
    }
}

/// What of a layer carries nothing of what is `carried`, below what was `idle` on the layer above.
fn idle_of(all: &Rows, carried: &Rows, idle: &Rows, params: &SupportParams) -> Rows {
    let [_, alone] = Pieces::new(all).split(all, carried);
    if idle.is_empty() {
        return alone;
    }
    // Posts have grown together: each has the part that it grew itself.
    let pitch = params.raster().pitch;
    let grown = |rows: &Rows| rows.dilate(STEP * pitch, pitch);
    alone.or(&grown(idle).and(all).minus(&grown(carried)))
}
