//! Solids -> their tops, small walls and skins: order of lines, speeds of their own, numbers of layers.
//!
//! - *Tops* are what the layer above leaves bare, told by cuts of the solid itself.
//! - *Ironing* goes over them once more: where, in which order and with how much plastic, and that
//!   `check` takes it for what it is and for nothing else.
//! - Tops with *one wall* are skin up to the outer wall; below what stands on the layer and on slopes
//!   the walls stay. Lengths of walls are compared with those of the same print with all walls.
//! - Then come speeds of walls, gaps and small loops, and how many layers are skin.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common::damage::{Good, kinds, listed, warned};
use crate::common::solid::{circle, rectangle, star};
use crate::common::{Kind, Move, Run, Section, Solid, fixture, slice, slice_shipped};
use proptest::prelude::*;
use slicer::check::finding::Code;

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

/// Pairs of lines that lie side by side, about `pitch` apart: how far the second lies beside the first
/// across them. Lines run along the longest one.
fn advances(lines: &[&Move], pitch: f64) -> Vec<f64> {
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
            ((v1 - v2).abs() < 0.125 * pitch).then_some([u1.min(u2), u1.max(u2), (v1 + v2) / 2.0])
        })
        .collect();
    let mut found = Vec::new();
    for (k, a) in spans.iter().enumerate() {
        for b in &spans[k + 1..] {
            let shared = a[1].min(b[1]) - a[0].max(b[0]);
            let beside = (b[2] - a[2]).abs();
            if shared > 0.5 && beside > 0.5 * pitch && beside < 1.5 * pitch {
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
            let advances = advances(&lines, 0.4);
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
fn what_is_seen_from_above_is_laid_last() {
    let set = [("speed.top_skin", "17"), ("top_monotonic", "false"), ("seam", "rear")];
    for dual in ["off", "pair"] {
        let run =
            slice(&stairs().stl(), "generic-marlin", &[&set[..], &[("dual.mode", dual)]].concat());
        let seen: Vec<usize> = tops(&run).iter().map(|m| m.line).collect();
        let beads = run.print.moves.iter().filter(|m| m.is_bead());
        let inside: Vec<&Move> =
            beads.filter(|m| matches!(m.kind, Kind::Skin | Kind::Infill)).collect();
        let mut layers = 0;
        for layer in inside.chunk_by(|a, b| a.layer == b.layer) {
            let first = layer.iter().position(|m| seen.contains(&m.line)).unwrap_or(layer.len());
            layers += usize::from(first > 0 && first < layer.len());
            let after = layer[first..].iter().find(|m| !seen.contains(&m.line));
            assert!(after.is_none(), "{dual}: {after:?}");
        }
        assert!(layers > 1, "{dual}: {layers} layers have both");
    }
}

/// What irons.
fn ironing(run: &Run) -> Vec<&Move> {
    run.print.of(Kind::Ironing).collect()
}

/// A print of the plate with ironing where `place` says.
fn ironed(place: &str, set: &[(&str, &str)]) -> (Solid, Run) {
    let solid = plate([5.0, 9.0], [20.0, 8.0]);
    let run = slice(&solid.stl(), "generic-marlin", &[&[("ironing.where", place)], set].concat());
    (solid.on_bed(run.middle()), run)
}

#[test]
fn ironing_covers_tops_and_stays_on_them() {
    // Layer, and its area without half a line around: the plate without hole and post, and the post.
    let tops = [(9, 29.6 * 23.6 - 6.4 * 5.4 - 5.4 * 6.4), (19, 4.6 * 5.6)];
    let (solid, run) = ironed("top", &[]);
    let all = ironing(&run);
    assert!(all.iter().all(|m| [9, 19].map(Some).contains(&m.layer)));
    for (layer, area) in tops {
        let lines: Vec<&&Move> = all.iter().filter(|m| m.layer == Some(layer)).collect();
        let z = run.print.layers[layer].z;
        let [here, above] = [-0.1, 0.1].map(|by| Section::new(&solid, z + by));
        for m in &lines {
            assert!((m.to[2] - z).abs() < 1e-6 && m.feed == 900.0, "line {}", m.line);
            let steps = (m.length() / 0.3).ceil() as usize;
            for at in (0..=steps).map(|k| m.at(k as f64 / steps as f64)) {
                assert!(here.is_inside(at) && here.distance(at, 1.0) > 0.195, "line {}", m.line);
                assert!(!above.is_inside(at) && above.distance(at, 1.0) > 0.195, "line {}", m.line);
            }
        }
        let covered = 0.1 * lines.iter().map(|m| m.length()).sum::<f64>();
        assert!((0.98..1.04).contains(&(covered / area)), "{covered} mm² of {area} mm²");
    }
}

#[test]
fn ironing_comes_last_on_its_layer_in_one_direction_of_advance_across_the_lines_of_the_top() {
    for set in [&[("angle", "20")][..], &[("angle", "20"), ("dual.mode", "pair")]] {
        let (_, run) = ironed("top", set);
        for layer in [9, 19] {
            let beads: Vec<&Move> = run.print.beads().filter(|m| m.layer == Some(layer)).collect();
            let first = beads.iter().position(|m| m.kind == Kind::Ironing).unwrap();
            assert!(beads[first..].iter().all(|m| m.kind == Kind::Ironing), "layer {layer}");
            let advances = advances(&beads[first..], 0.1);
            let back = advances.iter().filter(|by| **by < 0.0).count();
            assert!(advances.len() > 30, "{} lines", advances.len());
            assert!(back == 0 || back == advances.len(), "{back} of {}", advances.len());
            let direction = |kind: Kind| {
                let of_kind = beads.iter().filter(|m| m.kind == kind);
                let longest = of_kind.max_by(|a, b| a.length().total_cmp(&b.length())).unwrap();
                let [x, y] = [0, 1].map(|axis| longest.b()[axis] - longest.a()[axis]);
                y.atan2(x).to_degrees().rem_euclid(180.0)
            };
            let turn = (direction(Kind::Ironing) - direction(Kind::Skin)).rem_euclid(180.0);
            assert!((turn - 45.0).abs() < 0.5, "{turn} degrees");
        }
    }
}

#[test]
fn ironing_takes_the_share_of_plastic_that_is_asked_for() {
    for (flow, spacing) in [("15", "0.1"), ("30", "0.2"), ("10", "0.15")] {
        let set = [("ironing.flow", flow), ("ironing.spacing", spacing), ("layer_height", "0.25")];
        let (_, run) = ironed("topmost", &[&set[..], &[("first_layer_height", "0.25")]].concat());
        let [flow, spacing]: [f64; 2] = [flow, spacing].map(|number| number.parse().unwrap());
        let lines = ironing(&run);
        let sum = |of: fn(&Move) -> f64| lines.iter().map(|m| of(m)).sum::<f64>();
        let each_mm = sum(|m| m.e) * run.filament_area() / sum(Move::length);
        let asked = flow / 100.0 * spacing * 0.25;
        assert!((each_mm / asked - 1.0).abs() < 0.02, "{each_mm} mm², asked for {asked}");
    }
}

#[test]
fn only_what_is_asked_for_is_ironed() {
    assert!(ironing(&ironed("off", &[]).1).is_empty());
    let layers = |place: &str| {
        let (_, run) = ironed(place, &[]);
        let mut layers: Vec<usize> = ironing(&run).iter().filter_map(|m| m.layer).collect();
        layers.dedup();
        layers
    };
    assert_eq!(layers("topmost"), [19]);
    assert_eq!(layers("top"), [9, 19]);
    // Steps of a slope 0.8 mm wide: no more than its flat end is a top.
    let slope = Solid::tower(&[(circle(12.0, 60), 0.0), (circle(4.0, 60), 2.0)]);
    let run = slice(&slope.stl(), "generic-marlin", &[("ironing.where", "top")]);
    assert!(ironing(&run).len() > 50 && ironing(&run).iter().all(|m| m.layer == Some(9)));
}

#[test]
fn check_takes_ironing_for_what_it_is_and_for_nothing_else() {
    let set = [("ironing.where", "top"), ("machine.relative_e", "true")];
    let good = Good::of("tile.stl", "generic-marlin", &set);
    let verdict = good.judge(&good.text);
    assert!(good.print.of(Kind::Ironing).count() > 20);
    assert_eq!((kinds(&verdict), warned(&verdict)), (vec![], vec![]), "{}", listed(&verdict));
    // The top itself a second time, said to be ironing.
    let from = good.text.find(";TYPE:Top solid infill").unwrap();
    let length = good.text[from..].find(";TYPE:Ironing").unwrap();
    let again = good.text[from..][..length].replace("Top solid infill", "Ironing");
    let text = [&good.text[..from + length], &again, &good.text[from + length..]].concat();
    assert!(warned(&good.judge(&text)).contains(&Code::Overfilled));
    // A second time under its own name.
    let again = &good.text[from..][..length];
    let text = [&good.text[..from + length], again, &good.text[from + length..]].concat();
    assert!(kinds(&good.judge(&text)).contains(&Code::PrintedTwice));
    // Beside the part.
    let text = good.with(|m| {
        if m.kind == Kind::Ironing {
            m.to[0] += 10.0;
        }
        true
    });
    assert!(kinds(&good.judge(&text)).contains(&Code::InTheAir));
}

/// A block, half of which is higher, with a post on that half.
fn stairs() -> Solid {
    let block = Solid::cuboid([0.0; 3], [30.0, 24.0, 2.0]);
    let half = Solid::cuboid([14.0, 0.0, 0.0], [30.0, 24.0, 4.0]);
    let post = Solid::cuboid([19.0, 8.0, 0.0], [25.0, 15.0, 6.0]);
    block.and(&half).and(&post)
}

/// A print with one wall on tops, and one with all walls.
fn both(stl: &[u8], set: &[(&str, &str)]) -> [Run; 2] {
    ["true", "false"]
        .map(|one| slice(stl, "generic-marlin", &[&[("top_one_wall", one)], set].concat()))
}

/// Length of inner walls on each layer.
fn inner_walls(run: &Run) -> Vec<f64> {
    let mut lengths = vec![0.0; run.print.layers.len()];
    run.print.of(Kind::InnerWall).for_each(|m| lengths[m.layer.unwrap()] += m.length());
    lengths
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4))]

    #[test]
    fn tops_have_one_wall_and_all_else_has_all_of_them(
        walls in 2..5_u32,
        angle in prop::sample::select(vec!["0", "30", "45"]),
        dual: bool,
    ) {
        let mode = if dual { "pair" } else { "off" };
        let count = walls.to_string();
        let set = [("walls", count.as_str()), ("angle", angle), ("dual.mode", mode)];
        let [run, all] = both(&stairs().stl(), &set);
        let laid = stairs().on_bed(run.middle());
        let lengths = [&run, &all].map(inner_walls);
        prop_assert!(lengths.iter().all(|lengths| lengths.len() == 30));
        for (layer, (&one, &all)) in lengths[0].iter().zip(&lengths[1]).enumerate() {
            match layer {
                29 => prop_assert_eq!(one, 0.0),
                9 | 19 => prop_assert!(one < 0.8 * all, "layer {}: {} of {}", layer, one, all),
                _ => prop_assert!((one - all).abs() < 1e-6, "layer {}: {} of {}", layer, one, all),
            }
        }
        // One loop, all around.
        let loops = run.print.chains(Kind::OuterWall);
        let last: Vec<_> = loops.iter().filter(|chain| chain[0].layer == Some(29)).collect();
        prop_assert_eq!(last.len(), 1);
        prop_assert_eq!(last[0][0].a(), last[0][last[0].len() - 1].b());
        // No inner wall lies in what is bare, but for its end; under the higher half all do.
        let above = Section::new(&laid, 2.1);
        for m in run.print.of(Kind::InnerWall).filter(|m| m.layer == Some(9)) {
            let out = [m.a(), m.b()].map(|p| {
                if above.is_inside(p) { 0.0 } else { above.distance(p, 5.0) }
            });
            prop_assert!(out[0].max(out[1]) < 0.45, "line {}: {out:?}", m.line);
        }
        let half = 24.0 + 2.0 * 16.0;
        let kept = lengths[0][9] / (half * f64::from(walls - 1));
        prop_assert!((0.85..1.02).contains(&kept), "{kept}");
        // Skin fills it all.
        let skin = run.print.of(Kind::Skin).filter(|m| m.layer == Some(29));
        let area = skin.map(|m| m.e).sum::<f64>() * run.filament_area() / 0.2;
        prop_assert!((area / (5.2 * 6.2) - 1.0).abs() < 0.05, "{area} mm²");
    }

    #[test]
    fn slopes_and_narrow_tops_keep_their_walls(step in 0.05..1.6_f64, rim in 0.8..2.0_f64) {
        let layers = 8.0;
        let slope = Solid::tower(&[
            (circle(8.0 + step * layers, 60), 0.0),
            (circle(8.0, 60), 0.2 * layers),
        ]);
        let [one, all] = both(&slope.stl(), &[]).map(|run| inner_walls(&run));
        prop_assert_eq!(&one[..7], &all[..7]);
        prop_assert!(one[7] == 0.0 && all[7] > 40.0);
        // The rim of a cup.
        let hollow = Solid::prism(&circle(10.0 - rim, 60), 0.6, 2.0).inside_out();
        let cup = Solid::cylinder(10.0, 2.0, 60).and(&hollow);
        let [one, all] = both(&cup.stl(), &[]).map(|run| inner_walls(&run));
        prop_assert_eq!(one[9], all[9]);
    }
}

#[test]
fn tops_with_one_wall_are_neither_printed_twice_nor_open() {
    for stl in ["tile.stl", "cube_20.stl", "cavity.stl", "two_shells.stl"] {
        let set = [("top_one_wall", "true"), ("walls", "3"), ("ironing.where", "top")];
        let good = Good::of(stl, "generic-marlin", &set);
        let verdict = good.judge(&good.text);
        assert_eq!(kinds(&verdict), [], "{stl}: {}", listed(&verdict));
        assert!(verdict.measures.surface.unwrap() > 0.99, "{stl}: {:?}", verdict.measures);
        let fills = [Code::Overfilled, Code::Underfilled, Code::PrintedTwice, Code::NarrowBead];
        assert!(warned(&verdict).iter().all(|code| !fills.contains(code)), "{}", listed(&verdict));
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

#[test]
fn a_print_without_anything_to_iron_says_so() {
    let said = |inset: &str| -> Vec<String> {
        let set = [("ironing.where", "top"), ("ironing.inset", inset)];
        let run = slice(&fixture("tile.stl"), "generic-marlin", &set);
        run.report.warnings.iter().map(ToString::to_string).collect()
    };
    assert!(said("0.2").is_empty());
    assert_eq!(said("20"), ["ironing.where has no effect: no top is wide enough for its lines"]);
}

#[test]
fn layers_above_the_last_line_are_neither_written_nor_counted() {
    // A post that ends in a needle: too thin for a line, and many layers high.
    let needle = Solid::cuboid([4.9, 4.9, 4.0], [5.1, 5.1, 9.0]);
    let stl = Solid::cuboid([0.0; 3], [10.0, 10.0, 4.0]).and(&needle).stl();
    for (profile, set) in [
        ("generic-marlin", &[] as &[(&str, &str)]),
        ("generic-marlin", &[("dual.mode", "pair")]),
        ("generic-marlin", &[("walls", "0")]),
        ("ender-3", &[("raft.enabled", "true"), ("support.enabled", "true")]),
    ] {
        let set = [set, &[("machine.end_gcode", "; blocks say {layers}\n")]].concat();
        let run = slice(&stl, profile, &set);
        let count = run.report.layers.count;
        let raft = run.report.raft.as_ref().map_or(0, |raft| raft.layers);
        assert_eq!(count - raft, 20, "{set:?}");
        let marks = run.text.lines().filter(|line| *line == ";LAYER_CHANGE").count();
        assert_eq!((marks, run.report.time.layers.len()), (count, count), "{set:?}");
        for told in ["; layers = ", "; total layers count = ", "; num_layers = ", "; blocks say "] {
            let line = run.text.lines().find_map(|line| line.strip_prefix(told)).unwrap();
            assert_eq!(line, count.to_string(), "{told}");
        }
        let last = &run.text[run.text.rfind(";LAYER_CHANGE").unwrap()..];
        assert!(last.contains(";TYPE:Top solid infill") || set[0].1 == "0", "{set:?}: {last}");
        let raised = run.report.raft.as_ref().map_or(0.0, |raft| raft.height_mm + raft.gap_mm);
        assert!((run.report.layers.top_mm - raised - 4.0).abs() < 1e-6, "{set:?}");
    }
}

#[test]
fn what_is_left_out_with_its_layers_is_told() {
    let fin = Solid::cuboid([1.0, 4.975, 4.0], [33.0, 5.025, 9.0]);
    let stl = Solid::cuboid([0.0; 3], [34.0, 10.0, 4.0]).and(&fin).stl();
    let run = slice(&stl, "generic-marlin", &[]);
    assert_eq!(run.report.layers.count, 20);
    let thin = run.report.warnings.iter().find_map(|warning| match warning {
        slicer::warning::Warning::ThinPlaces { layers, area_mm2 } => Some((*layers, *area_mm2)),
        _ => None,
    });
    let (layers, area_mm2) = thin.unwrap();
    assert!(layers == 25 && (area_mm2 - 25.0 * 1.6).abs() < 1.0, "{layers} {area_mm2}");
}
