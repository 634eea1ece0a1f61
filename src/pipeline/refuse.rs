//! Job + model -> Refusal: jobs that cannot be printed, found out before anything is written.
//!
//! There are five causes, and each is known at another time:
//!
//! - A model is smaller than the machine prints: known from its size.
//! - The model is lower than half a layer, or its last layer ends above the machine: known from
//!   its height, see [`heights`](super::heights).
//! - The mesh is open, and a contour would have to be closed by a line that is too long. Contours
//!   can only be open where a triangle has no neighbour. A mesh without such triangles, which is
//!   nearly every mesh, is not looked at. Of any other mesh the open contours are cut once more,
//!   block by block, and forgotten: this takes no memory that grows with the layers, and less
//!   time than cutting whole layers does.
//! - Everything is too thin for a bead. This is only known when all layers are planned. So the
//!   writer keeps what it has until the first line is extruded, which is in the first layer of
//!   nearly every print. A layer without lines takes a few bytes until then.
//!
//! The other way, to write all and to take it back, needs an output that can be taken back.

use crate::error::{MOST_GAP_MM, Refusal, Result};
use crate::fill::adhesion::lift::Lift;
use crate::job::Job;
use crate::mesh::Policy;
use crate::mesh::place::Placed;
use crate::profile::Settings;
use crate::progress::Progress;
use crate::slice::{Heights, Slicer};
use crate::units::{Coord, to_mm, to_units};

/// Refuses models of which a side is below the least that the machine prints.
///
/// # Errors
/// [`Refusal::TooSmall`].
pub fn small(settings: &Settings, placed: &Placed) -> Result<(), Refusal> {
    let least_mm = settings.machine.min_part_size;
    let least = to_units(least_mm);
    let is_small = |size_mm: &[f64; 3]| size_mm.iter().any(|side| to_units(*side) < least);
    match placed.reports.iter().find(|report| is_small(&report.size_mm)) {
        None => Ok(()),
        Some(report) => {
            let (file, size_mm) = (report.file.clone(), report.size_mm);
            Err(Refusal::TooSmall { file, size_mm, least_mm })
        }
    }
}

/// Refuses a print that ends above the machine. The model itself fits, or it would not have been
/// placed, but its last layer is counted as soon as its middle is inside the model, a raft lifts it,
/// and the nozzle is lifted above it to travel.
///
/// # Errors
/// [`Refusal::TooTall`].
pub fn tall(settings: &Settings, heights: &Heights, lift: &Lift) -> Result<(), Refusal> {
    let Some(last) = heights.count().checked_sub(1) else { return Ok(()) };
    let hop = to_units(settings.retraction.z_hop);
    let top = heights.top(last).saturating_add(lift.by());
    let machine = &settings.machine;
    let [_, [_, _, reach]] = machine.nozzle_reach();
    // The nozzle may go higher than parts may be.
    for (hop, height_mm) in [(0, machine.bed_height), (hop, reach)] {
        let top = top.saturating_add(hop);
        if top > to_units(height_mm) {
            let (top_mm, hop_mm, raft_mm) = (to_mm(top), to_mm(hop), to_mm(lift.by()));
            return Err(Refusal::TooTall { top_mm, hop_mm, raft_mm, height_mm });
        }
    }
    Ok(())
}

/// Refuses layers whose contours are open too far. Nothing is looked at if the mesh is closed, or
/// is to be sliced as it is.
///
/// # Errors
/// [`Refusal::Open`].
pub fn gaps(job: &Job, placed: &Placed, slicer: &Slicer<'_>, progress: &Progress) -> Result<()> {
    if placed.adjacency.unpaired == 0 || job.placement.policy == Policy::Warn {
        return Ok(());
    }
    // Number of layers with gaps; the longest gap and the first layer that has it.
    let (mut layers, mut longest): (usize, (Coord, usize)) = (0, (0, 0));
    for block in 0..slicer.blocks() {
        progress.go_on()?;
        for (layer, gap) in slicer.gaps(block) {
            layers += usize::from(gap > 0);
            if gap > longest.0 {
                longest = (gap, layer + 1);
            }
        }
    }
    let (gap_mm, layer) = (to_mm(longest.0), longest.1);
    if gap_mm <= MOST_GAP_MM {
        return Ok(());
    }
    Err(Refusal::Open {
        models: job.models.iter().map(|model| model.name().into_owned()).collect(),
        layers,
        layer,
        gap_mm,
    }
    .into())
}

/// The refusal of a job of which nothing was extruded.
#[must_use]
pub fn thin(settings: &Settings) -> Refusal {
    Refusal::TooThin { line_width_mm: settings.line_width }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::MeshReport;
    use crate::profile;

    #[test]
    fn a_part_has_the_least_side_in_all_directions_or_is_refused() {
        let mut settings = profile::load(["generic-marlin"], &[]).unwrap().settings;
        let of = |size_mm: [f64; 3]| {
            let report = MeshReport { file: "a.stl".to_owned(), size_mm, ..MeshReport::default() };
            Placed { reports: vec![report], ..Placed::default() }
        };
        assert_eq!(small(&settings, &of([0.1; 3])), Ok(()));
        settings.machine.min_part_size = 5.0;
        assert_eq!(small(&settings, &of([5.0, 30.0, 5.0])), Ok(()));
        for axis in 0..3 {
            let mut size = [30.0; 3];
            size[axis] = 4.9999;
            let text = small(&settings, &of(size)).unwrap_err().to_string();
            for part in ["a.stl", "30.00", "5 mm", "machine.min_part_size", "--scale"] {
                assert!(text.contains(part) && !text.contains('\n'), "{text}");
            }
        }
    }

    #[test]
    fn a_print_ends_below_the_machine_or_is_refused() {
        let profile = |hop: f64| {
            let mut settings = profile::load(["generic-marlin"], &[]).unwrap().settings;
            settings.retraction.z_hop = hop;
            settings
        };
        let layers = |height: Coord, count: usize| Heights::new(std::iter::repeat_n(height, count));
        let limit = to_units(profile(0.0).machine.bed_height);
        let tall = |settings: &Settings, heights: &Heights, raft: Coord| {
            tall(settings, heights, &Lift { heights: vec![raft], ..Lift::default() })
        };
        assert_eq!(tall(&profile(0.0), &layers(limit / 100, 100), 0), Ok(()));
        let refusal = tall(&profile(0.0), &layers(limit / 100 + 1, 100), 0).unwrap_err();
        assert!(refusal.to_string().contains("--layer-height"), "{refusal}");
        let refusal = tall(&profile(0.4), &layers(limit / 100, 100), 0).unwrap_err();
        let text = refusal.to_string();
        for part in ["lifted by 0.4 mm", "retraction.z_hop", "--scale"] {
            assert!(text.contains(part), "{text}");
        }
        // Parts may end at the limit where the nozzle reaches higher.
        let mut higher = profile(0.4);
        higher.machine.reach.max_z = Some(higher.machine.bed_height + 0.4);
        assert_eq!(tall(&higher, &layers(limit / 100, 100), 0), Ok(()));
        assert!(tall(&higher, &layers(limit / 100 + 1, 100), 0).is_err());
        let refusal = tall(&profile(0.0), &layers(limit / 100, 100), 9_000).unwrap_err();
        let text = refusal.to_string();
        for part in ["0.9 mm of raft", "no --raft"] {
            assert!(text.contains(part), "{text}");
        }
    }
}
