//! Wall and its samples -> samples with the wall's own corners, so that beads follow them.

use super::measured::Side;
use super::{SHORT, WallSample};
use crate::geom::{Contour, edges};
use crate::region::params::BeadParams;
use crate::units::Bounded as _;

/// Length of the middle normal of a round corner. A corner of 90° to 180° gets three points; their
/// two chords would cut inside the circle around the corner. At 1 beads come too near to the
/// wall at such corners; a larger value leaves them further open.
const ROUND: f64 = 1.2;

/// The cosine of the turn up to which sides that meet inside a corner meet on its mitre: at a tip of 26°, which is
/// 4.5 times as far away as the sides. In a sharper one the sides end where they come too near to the other.
const SHARPEST: f64 = -0.9;

/// Adds the wall's own corners to the samples, with the skin of the nearest sample.
pub(super) fn with_corners(
    wall: &Contour,
    found: &[WallSample],
    perimeter: f64,
    params: &BeadParams,
) -> Vec<WallSample> {
    let most = SHORT * f64::from(params.line_width);
    let n = wall.len();
    let mut out = Vec::with_capacity(found.len() + n);
    let mut position = 0.0;
    let mut next = 0;
    for (k, (p, q)) in edges(wall).enumerate() {
        let (before, edge) = (Side::new(wall[(k + n - 1) % n], p, 0.0), Side::new(p, q, position));
        let near = |k: usize| {
            let sample = found[k % found.len()];
            let away = (sample.position - position).abs();
            (away.at_most(perimeter - away), sample)
        };
        let (a, b) = (near(next + found.len() - 1), near(next));
        let nearest = if a.0 <= b.0 { a } else { b };
        let gap = a.0 + b.0;
        let alike = a.1.beads == b.1.beads && a.1.shared == b.1.shared;
        let depth = if alike && gap > 0.0 {
            (a.1.depth * b.0 + b.1.depth * a.0) / gap
        } else {
            nearest.1.depth
        };
        let beads = if nearest.0 <= most { nearest.1.beads } else { 0 };
        let leads = a.1.leads || b.1.leads;
        let corner = WallSample { at: edge.from, position, depth, leads, beads, ..nearest.1 };
        add_corner(&before, &edge, corner, &mut out);
        position += edge.length;
        while let Some(sample) = found.get(next).filter(|s| s.position <= position) {
            out.push(*sample);
            next += 1;
        }
    }
    // One sample is enough for each stretch without beads.
    out.dedup_by(|b, a| a.beads == 0 && b.beads == 0);
    out
}

/// Adds a corner between two edges. Where the wall turns towards the solid, the sides of a bead meet on the
/// mitre, however sharp the corner is. Where it turns away by more than 90°, a mitre would reach too far:
/// it gets three round points.
fn add_corner(before: &Side, after: &Side, corner: WallSample, out: &mut Vec<WallSample>) {
    let (a, b) = (before.normal(), after.normal());
    let cosine = a[0] * b[0] + a[1] * b[1];
    let inwards = a[0] * b[1] - a[1] * b[0] > 0.0;
    if cosine >= 0.0 || inwards && cosine > SHARPEST {
        let normal = [0, 1].map(|k| (a[k] + b[k]) / (1.0 + cosine));
        out.push(WallSample { normal, ..corner });
        return;
    }
    // The middle normal bisects the two, or points straight on where the wall turns back.
    let length = (2.0 + 2.0 * cosine).at_least(0.0).sqrt();
    let middle = [0, 1].map(|k| {
        let ahead = if length > 0.1 { (a[k] + b[k]) / length } else { before.along[k] };
        ahead * ROUND
    });
    out.extend([a, middle, b].map(|normal| WallSample { normal, ..corner }));
}
