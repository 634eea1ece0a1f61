//! Toolpaths -> Toolpaths above a raft.
//!
//! Everything up to the toolpaths is planned as if the part stood on the bed, so that its paths and
//! the groups of dual injection are those of a print without a raft. Only then they are lifted.

use crate::fill::adhesion::lift::Lift;
use crate::fill::{Order, Path};
use crate::plan::Toolpath;

/// Lifts toolpaths that were planned on the bed. What is no part of the model reaches down to the
/// raft: support is thrown away with it, and has to stand until then.
pub fn raise(toolpaths: &mut [Toolpath], lift: &Lift) {
    if lift.layers() == 0 {
        return;
    }
    for toolpath in toolpaths {
        let stands = |path: &Path| {
            path.role.facts().order == Order::Helper && path.layers as usize == toolpath.layer + 1
        };
        let paths = toolpath.moves.iter_mut().map(|next| &mut next.path);
        for path in paths.filter(|path| stands(path)) {
            path.points.iter_mut().for_each(|point| point.height += lift.filled);
        }
        let over = toolpath.moves.iter_mut().map(|next| &mut next.over);
        over.filter(|over| **over > 0).for_each(|over| *over += lift.by());
        toolpath.layer += lift.layers();
        toolpath.z += lift.by();
        toolpath.from.highest += lift.by();
    }
}
