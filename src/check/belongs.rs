//! A line -> whether it is of the part, and of its layer.

use super::stack::bead::Bead;
use crate::reader::Role;
use crate::reader::print::{Layer, Step};

/// Width of a line where no wall gives one, mm.
pub(super) const SOME_WIDTH: f64 = 0.4;

/// Heights that differ by less are the same, mm.
pub(super) const SAME_HEIGHT: f64 = 1e-3;

/// Whether a line is of the part itself: no support, skirt or start line.
pub(super) fn is_of_part(step: &Step, has_roles: bool) -> bool {
    let roles = [Role::OuterWall, Role::InnerWall, Role::Skin, Role::NonPlanar, Role::Infill];
    step.is_line() && (!has_roles || roles.contains(&step.role))
}

/// Whether a line lies so far from its layer's height that it is judged with other layers: with those
/// at which it lies. All non-planar skin is.
pub(super) fn is_stray(step: &Step, layer: &Layer) -> bool {
    let off = step.heights().map(|z| (z - layer.z).abs());
    step.role == Role::NonPlanar || off[0].max(off[1]) > layer.height + SAME_HEIGHT
}

/// The pieces of a line by the layers that they lie in, each with its layer: that of which the top is the
/// next above.
pub(super) fn pieces(step: &Step, layers: &[Layer]) -> Vec<(usize, Step)> {
    let [low, high] = step.heights();
    let last = layers.len().saturating_sub(1);
    let at = |z: f64| layers.partition_point(|layer| layer.z < z).min(last);
    let (first, end) = (at(low), at(high));
    if first == end {
        return vec![(first, *step)];
    }
    let part = |part: f64| -> [f32; 3] {
        std::array::from_fn(|axis| {
            let [from, to] = [step.from, step.to].map(|place| f64::from(place[axis]));
            (from + part * (to - from)) as f32
        })
    };
    let rises = step.to[2] > step.from[2];
    let mut from = 0.0;
    let mut pieces = Vec::with_capacity(end - first + 1);
    for (k, layer) in layers.iter().enumerate().take(end + 1).skip(first) {
        let to = if k == end { 1.0 } else { (layer.z - low) / (high - low) };
        let ends = if rises { [from, to] } else { [1.0 - to, 1.0 - from] };
        let filament = (f64::from(step.filament) * (to - from)) as f32;
        let piece = Step { from: part(ends[0]), to: part(ends[1]), filament, ..*step };
        pieces.extend(piece.is_line().then_some((k, piece)));
        from = to;
    }
    pieces
}

/// How far beside its own width a line of a layer carries one that lies over it, mm: level lines as far as that one is
/// wide, as those of layers below do, since a skin's line may lie half over the next tread of its staircase. Of a skin
/// they carry only what lies over them: next to a line lies its neighbour down the slope.
pub(super) fn carries_aside(step: &Step, layer: &Layer, bead: &Bead) -> f64 {
    let is_tread = step.role != Role::NonPlanar
        && step.heights().into_iter().all(|z| (z - layer.z).abs() < SAME_HEIGHT);
    if is_tread { bead.radius } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_over_a_slope_is_cut_where_layers_end() {
        let layer = |z: f64| Layer { moves: 0..0, z, height: 0.2 };
        let layers = [0.2, 0.4, 0.6, 0.8].map(layer);
        let step = Step {
            from: [0.0, 0.0, 0.3],
            to: [4.0, 0.0, 0.7],
            filament: 4.0,
            feed: 1.0,
            width: 0.4,
            height: 0.2,
            role: Role::NonPlanar,
            line: 1,
        };
        let down = Step { from: step.to, to: step.from, ..step };
        for step in [step, down] {
            let pieces = pieces(&step, &layers);
            let lengths: Vec<(usize, f32)> =
                pieces.iter().map(|(k, one)| (*k, one.filament)).collect();
            assert_eq!(lengths.len(), 3);
            for ((k, filament), (layer, length)) in
                lengths.iter().zip([(1, 1.0), (2, 2.0), (3, 1.0)])
            {
                assert!(*k == layer && (filament - length).abs() < 1e-4, "{lengths:?}");
            }
            assert!(
                pieces
                    .iter()
                    .all(|(_, one)| (one.plan_length() - f64::from(one.filament)).abs() < 1e-4)
            );
        }
        let level = Step { to: [4.0, 0.0, 0.3], ..step };
        assert_eq!(pieces(&level, &layers), [(1, level)]);
    }
}
