//! Solids -> their tops, small walls and skins: order of lines, speeds of their own, numbers of layers.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common::solid::{rectangle, star};
use crate::common::{Kind, Move, Run, Section, Solid, slice, slice_shipped};
use proptest::prelude::*;

/// The beads under `;TYPE:` and this name.
fn beads_of<'a>(run: &'a Run, name: &str) -> Vec<&'a Move> {
    let (mut under, mut lines) = (false, Vec::new());
    for line in run.text.lines() {
        under = line.strip_prefix(";TYPE:").map_or(under, |kind| kind == name);
        lines.push(under);
    }
    run.print.moves.iter().filter(|m| m.is_bead() && lines[m.line - 1]).collect()
}

fn tops(run: &Run) -> Vec<&Move> {
    beads_of(run, "Top solid infill")
}

/// A plate with a hole through it and a post on it.
fn plate(hole: [f64; 2], post: [f64; 2]) -> Solid {
    let plate = Solid::cuboid([0.0; 3], [30.0, 24.0, 2.0]);
    let [x, y] = hole;
    let hole = Solid::prism(&rectangle([x, y], [x + 6.0, y + 5.0]), 0.0, 2.0).inside_out();
    let [x, y] = post;
    let post = Solid::prism(&rectangle([x, y], [x + 5.0, y + 6.0]), 1.0, 4.0);
    plate.and(&hole).and(&post)
}

/// Pairs of lines that lie side by side: how far the second lies beside the first across them. Lines run
/// along the longest one.
fn advances(lines: &[&Move]) -> Vec<f64> {
    let lines: Vec<&&Move> = lines.iter().filter(|m| m.length() > 1.2).collect();
    let Some(longest) = lines.iter().max_by(|a, b| a.length().total_cmp(&b.length())) else {
        return Vec::new();
    };
    let unit = [0, 1].map(|axis| (longest.b()[axis] - longest.a()[axis]) / longest.length());
    let turned = |p: [f64; 2]| [p[0] * unit[0] + p[1] * unit[1], p[1] * unit[0] - p[0] * unit[1]];
    let spans: Vec<[f64; 3]> = lines
        .iter()
        .filter_map(|m| {
            let ([u1, v1], [u2, v2]) = (turned(m.a()), turned(m.b()));
            ((v1 - v2).abs() < 0.05).then_some([u1.min(u2), u1.max(u2), (v1 + v2) / 2.0])
        })
        .collect();
    let mut found = Vec::new();
    for (k, a) in spans.iter().enumerate() {
        for b in &spans[k + 1..] {
            let shared = a[1].min(b[1]) - a[0].max(b[0]);
            let beside = (b[2] - a[2]).abs();
            if shared > 0.5 && beside > 0.2 && beside < 0.6 {
                found.push(b[2] - a[2]);
            }
        }
    }
    found
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    #[test]
    fn the_lines_of_a_top_are_laid_in_one_direction_of_advance(
        // Narrow strips are closed by beads along walls, before the lines.
        hole in [5.0..9.0_f64, 5.0..14.0_f64],
        post in [19.0..20.0_f64, 5.0..13.0_f64],
        angle in prop::sample::select(vec!["0", "45", "70"]),
        dual: bool,
    ) {
        let mode = if dual { "pair" } else { "off" };
        let set = [("angle", angle), ("dual.mode", mode), ("layer_height", "0.2")];
        let run = slice(&plate(hole, post).stl(), "generic-marlin", &set);
        let tops = tops(&run);
        for layer in [9, 19] {
            let lines: Vec<&Move> =
                tops.iter().copied().filter(|m| m.layer == Some(layer)).collect();
            let advances = advances(&lines);
            prop_assert!(advances.len() > 5, "{} lines", lines.len());
            let back = advances.iter().filter(|by| **by < 0.0).count();
            prop_assert!(back == 0 || back == advances.len(), "{back} of {}", advances.len());
        }
        // Each top is there once: the plate's and the post's.
        prop_assert!(tops.iter().all(|m| m.layer == Some(9) || m.layer == Some(19)));
    }

    #[test]
    fn what_is_seen_from_above_has_a_speed_of_its_own(
        hole in [2.0..12.0_f64, 2.0..16.0_f64],
        post in [20.0..24.0_f64, 2.0..16.0_f64],
        monotonic: bool,
    ) {
        let monotonic = if monotonic { "true" } else { "false" };
        let set = [("speed.top_skin", "17"), ("top_monotonic", monotonic)];
        let solid = plate(hole, post);
        let run = slice(&solid.stl(), "generic-marlin", &set);
        let laid = solid.on_bed(run.middle());
        for m in run.print.moves.iter().filter(|m| m.is_bead() && m.kind == Kind::Skin) {
            let above = Section::new(&laid, m.to[2] + 0.1);
            let is_slow = m.feed <= 17.0 * 60.0 + 1.0;
            let middle = m.at(0.5);
            // Between the two there is an edge a line or two wide.
            if m.length() > 1.0 && above.distance(middle, 3.0) > 2.0 {
                prop_assert_eq!(is_slow, !above.is_inside(middle), "line {}", m.line);
            }
        }
    }
}

#[test]
fn without_a_use_for_them_tops_are_skin() {
    let solid = plate([4.0, 4.0], [21.0, 8.0]);
    let run = slice(&solid.stl(), "generic-marlin", &[("top_monotonic", "false")]);
    assert!(tops(&run).is_empty());
    assert!(!beads_of(&run, "Solid infill").is_empty());
}

#[test]
fn walls_have_speeds_of_their_own() {
    let solid = Solid::cuboid([0.0; 3], [15.0, 15.0, 2.0]);
    let set = [("speed.wall", "33"), ("speed.outer_wall", "21")];
    let run = slice(&solid.stl(), "generic-marlin", &set);
    let all = |name, feed| beads_of(&run, name).iter().all(|m: &&Move| m.feed == feed);
    assert!(all("External perimeter", 21.0 * 60.0) && all("Perimeter", 33.0 * 60.0));
    let run =
        slice(&solid.stl(), "generic-marlin", &[("speed.wall", "33"), ("speed.inner_wall", "41")]);
    let all = |name, feed| beads_of(&run, name).iter().all(|m: &&Move| m.feed == feed);
    assert!(all("External perimeter", 33.0 * 60.0) && all("Perimeter", 41.0 * 60.0));
}

#[test]
fn gaps_are_told_apart_if_they_have_a_speed() {
    // Its skin tapers to less than a line.
    let radii: Vec<f64> = (0..14).map(|k| if k % 2 == 0 { 12.0 } else { 5.0 }).collect();
    let solid = Solid::prism(&star(&radii), 0.0, 1.0);
    let run = slice(&solid.stl(), "generic-marlin", &[("speed.gap", "11"), ("angle", "45")]);
    let gaps = beads_of(&run, "Gap fill");
    assert!(!gaps.is_empty() && gaps.iter().all(|m| m.feed == 660.0));
    let run = slice(&solid.stl(), "generic-marlin", &[("angle", "45")]);
    assert!(beads_of(&run, "Gap fill").is_empty());
}

#[test]
fn loops_shorter_than_a_length_are_slower() {
    for (radius, feed) in [(2.0, 18.0), (6.0, 30.0)] {
        let solid = Solid::cylinder(radius, 2.0, 60);
        let set = [("speed.wall", "30"), ("speed.small_loop", "60"), ("walls", "1")];
        let run = slice(&solid.stl(), "generic-marlin", &set);
        let walls = beads_of(&run, "External perimeter");
        assert!(walls.iter().all(|m| m.feed == feed * 60.0), "{radius}");
    }
}

/// The numbers of layers without sparse infill at the bottom and at the top of a block 6 mm high.
fn solid_layers(set: &[(&str, &str)]) -> (usize, usize) {
    let run =
        slice_shipped(&Solid::cuboid([0.0; 3], [16.0, 16.0, 6.0]).stl(), "generic-marlin", set);
    let count = run.print.layers.len();
    let mut sparse = vec![false; count];
    for m in run.print.moves.iter().filter(|m| m.is_bead() && m.kind == Kind::Infill) {
        sparse[m.layer.unwrap()] = true;
    }
    let bottom = sparse.iter().take_while(|sparse| !**sparse).count();
    (bottom, sparse.iter().rev().take_while(|sparse| !**sparse).count())
}

#[test]
fn skins_are_as_thick_as_asked_for_and_have_as_many_layers() {
    for (set, layers) in [
        (vec![("layer_height", "0.2")], (4, 4)),
        (vec![("layer_height", "0.12"), ("first_layer_height", "0.12")], (7, 7)),
        (vec![("layer_height", "0.12"), ("first_layer_height", "0.3")], (7, 7)),
        (vec![("layer_height", "0.3"), ("first_layer_height", "0.3")], (3, 3)),
        (vec![("skin_layers", "2")], (2, 2)),
        (vec![("top_layers", "5")], (4, 5)),
        (vec![("bottom_layers", "1"), ("top_thickness", "1.1")], (1, 6)),
        (vec![("skin_layers", "2"), ("top_thickness", "0.9")], (2, 5)),
    ] {
        assert_eq!(solid_layers(&set), layers, "{set:?}");
    }
}
