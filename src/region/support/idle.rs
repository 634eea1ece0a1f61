//! Columns, from the top down -> Columns: posts that have lost what they carry are left out.
//!
//! The tops of posts may be too small to print, or would stand on nothing ([`mod@super::stand`]).
//! Then all of a post over which something hangs may be gone.

use super::columns::Column;
use super::params::SupportParams;
use super::pieces::Pieces;
use super::posts::begins;
use crate::geom::spans::Rows;
use std::collections::VecDeque;

/// Support may lose so many layers at its top and still carry what hangs there. With none, slopes near
/// the threshold lose their support, which is too small on its first layers.
const LOST: usize = 2;

/// Removes pieces above which there is neither another nor what hangs. Tells whether there were any.
pub(super) fn drop_idle(columns: &mut [Column], params: &SupportParams) -> bool {
    let (outset, pitch) = (params.outset, params.raster().pitch);
    // What hangs over this layer and the last ones, and is not carried yet.
    let mut open: VecDeque<Rows> = VecDeque::new();
    let (mut above, mut found) = (Rows::default(), false);
    for column in columns.iter_mut().rev() {
        open.push_front(column.hangs.clone());
        open.truncate(LOST + 1);
        let mut carries = above;
        for open in open.iter_mut().filter(|open| !open.is_empty()) {
            let begins = begins(&column.all, open, params);
            *open = open.minus(&begins.dilate(outset, pitch));
            carries = carries.or(&begins);
        }
        let pieces = Pieces::new(&column.all);
        let mut is_kept = vec![false; pieces.count()];
        pieces.meeting(&column.all, &carries, |piece, _| is_kept[piece] = true);
        if is_kept.contains(&false) {
            let kept = pieces.keep(&column.all, |piece| is_kept[piece]);
            column.reach = column.reach.minus(&column.all.minus(&kept));
            column.all = kept;
            found = true;
        }
        above = column.all.clone();
    }
    found
}
