//! Prints -> times and feeds of layers: tests that quick layers are slowed down, evenly, and no more than needed.
//!
//! Times are those that the library's reader and clock find in the file. Each print is compared with
//! the same one without a least time.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common::solid::{circle, rectangle};
use crate::common::{Kind, Run, Solid, fixture, slice_shipped};
use slicer::estimate::{Options, estimate};
use slicer::motion::Limits;
use std::sync::LazyLock;

/// The default, s.
const LEAST: f64 = 10.0;

/// The default of the least speed, mm/min.
const SLOWEST: f64 = 600.0;

const PROFILES: [&str; 4] = ["generic-marlin", "generic-klipper", "zcube-dual", "witbox-1"];

/// A print, and the same one at full speed.
struct Pair {
    what: String,
    cooled: Run,
    free: Run,
    /// Layers of a group.
    ratio: usize,
}

/// A box with a pipe on it, which is all at once much quicker to print.
fn chimney() -> Solid {
    let hole = Solid::prism(&circle(2.0, 24), 2.6, 8.0).inside_out();
    let base = Solid::cuboid([-9.0, -9.0, 0.0], [9.0, 9.0, 2.0]);
    base.and(&Solid::prism(&circle(3.5, 24), 1.9, 8.0)).and(&hole)
}

/// A cone: each layer is a little quicker than the one below.
fn cone() -> Solid {
    Solid::cone(9.0, 9.0, 40)
}

/// Narrow, then wide, then narrow, all by and by.
fn vase() -> Solid {
    let ring = |half: f64, z: f64| (rectangle([-half, -half], [half, half]), z);
    Solid::tower(&[ring(3.0, 0.0), ring(6.5, 5.0), ring(2.0, 9.0)])
}

fn pair(name: &str, solid: &Solid, profile: &str, more: &[(&str, &str)], ratio: usize) -> Pair {
    let dual = [("dual.mode", "pair"), ("infill", "40"), ("floating", "warn")];
    let set: Vec<(&str, &str)> =
        dual.into_iter().skip(usize::from(ratio == 1)).chain(more.iter().copied()).collect();
    let free: Vec<_> = set.iter().copied().chain([("cooling.min_layer_time", "0")]).collect();
    Pair {
        what: format!("{name}, {profile}, groups of {ratio}"),
        cooled: slice_shipped(&solid.stl(), profile, &set),
        free: slice_shipped(&solid.stl(), profile, &free),
        ratio,
    }
}

/// Every shape in every way; slicing them takes long.
static PAIRS: LazyLock<Vec<Pair>> = LazyLock::new(|| {
    let shapes = [("chimney", chimney()), ("cone", cone()), ("vase", vase())];
    let ways: Vec<_> = PROFILES.iter().flat_map(|&profile| [(profile, 1), (profile, 2)]).collect();
    let pairs = shapes.iter().flat_map(|(name, solid)| {
        ways.iter().map(move |&(profile, ratio)| pair(name, solid, profile, &[], ratio))
    });
    pairs.collect()
});

/// What each layer takes, by the file without its end block.
fn seconds(run: &Run) -> Vec<f64> {
    let end = run.text.rfind(";TYPE:Custom").unwrap();
    let options =
        Options { filament_diameter: run.settings.filament.diameter, ..Options::default() };
    let text = &run.text.as_bytes()[..end];
    let read = estimate(&mut &text[..], "test", &Limits::new(&run.settings), options).unwrap();
    read.layers.iter().map(|layer| layer.seconds).collect()
}

/// The highest feed of some kinds of lines on each layer, mm/min; 0 where there are none.
fn feeds(run: &Run, kinds: &[Kind]) -> Vec<f64> {
    let mut feeds = vec![0.0; run.print.layers.len()];
    for bead in run.print.beads().filter(|bead| kinds.contains(&bead.kind)) {
        let feed: &mut f64 = &mut feeds[bead.layer.unwrap()];
        *feed = feed.max(bead.feed);
    }
    feeds
}

const INSIDE: [Kind; 4] = [Kind::Infill, Kind::Skin, Kind::Support, Kind::SupportInterface];
const OUTSIDE: [Kind; 3] = [Kind::OuterWall, Kind::Overhang, Kind::Bridge];

/// The layers of each group: the first alone, then as many at a time as end with a multiple.
fn groups(count: usize, ratio: usize) -> Vec<Vec<usize>> {
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for layer in 0..count {
        match groups.last_mut() {
            Some(group) if layer > 1 && layer % ratio != 0 => group.push(layer),
            _ => groups.push(vec![layer]),
        }
    }
    groups
}

#[test]
fn every_layer_takes_the_least_time_or_is_at_the_least_speed() {
    let mut slowed = 0;
    for Pair { what, cooled, free, .. } in PAIRS.iter() {
        let (took, would) = (seconds(cooled), seconds(free));
        let all = [&INSIDE[..], &OUTSIDE, &[Kind::InnerWall]].concat();
        let fastest = feeds(cooled, &all);
        for (k, &took) in took.iter().enumerate() {
            assert!(took >= LEAST || fastest[k] <= SLOWEST, "{what}: layer {k} takes {took} s");
            slowed += usize::from(would[k] < LEAST && took >= LEAST);
        }
        let by_kind = |run: &Run| {
            let moves = run.print.moves.iter();
            moves.filter(|m| !m.is_bead()).map(|m| (m.to, m.e, m.feed)).collect::<Vec<_>>()
        };
        assert_eq!(by_kind(cooled), by_kind(free), "{what}: travels and retractions");
        let beads = cooled.print.beads().zip(free.print.beads());
        for (slow, fast) in beads {
            assert_eq!((slow.to, slow.e), (fast.to, fast.e), "{what}");
            let least = fast.feed.min(SLOWEST);
            assert!((least..=fast.feed).contains(&slow.feed), "{what}: {slow:?} {fast:?}");
        }
    }
    assert!(slowed > 300, "{slowed}");
}

#[test]
fn a_group_takes_the_least_time_of_all_its_layers_or_is_as_slow_inside_as_it_may_be() {
    let mut made_up = 0;
    for Pair { what, cooled, ratio, .. } in PAIRS.iter().filter(|pair| pair.ratio > 1) {
        let took = seconds(cooled);
        let inside = feeds(cooled, &[&INSIDE[..], &[Kind::InnerWall]].concat());
        for group in groups(took.len(), *ratio) {
            let all: f64 = group.iter().map(|&k| took[k]).sum();
            let enough = all >= LEAST * group.len() as f64;
            let fastest = group.iter().map(|&k| inside[k]).fold(0.0, f64::max);
            assert!(enough || fastest <= SLOWEST, "{what}: {group:?} take {all} s, {fastest}");
            made_up += usize::from(enough && group.iter().any(|&k| took[k] < LEAST));
        }
    }
    assert!(made_up > 10, "{made_up}");
}

#[test]
fn outer_walls_differ_little_within_groups_and_between_groups_that_are_alike() {
    let differ = |a: f64, b: f64| a.max(b) > 1.1 * a.min(b);
    let (mut slowed, mut alike) = (0, 0);
    for Pair { what, cooled, free, ratio } in PAIRS.iter() {
        let would = seconds(free);
        let (walls, asked) = (feeds(cooled, &[Kind::OuterWall]), feeds(free, &[Kind::OuterWall]));
        let groups = groups(walls.len(), *ratio);
        let with_walls = |group: &[usize]| -> Vec<usize> {
            group.iter().copied().filter(|&k| walls[k] > 0.0).collect()
        };
        for group in &groups {
            let group = with_walls(group);
            for k in &group {
                assert!(!differ(walls[*k], walls[group[0]]), "{what}: {group:?}");
                slowed += usize::from(walls[*k] < asked[*k]);
            }
        }
        let mean =
            |group: &[usize]| group.iter().map(|&k| would[k]).sum::<f64>() / group.len() as f64;
        for two in groups.windows(2) {
            let (a, b) = (mean(&two[0]), mean(&two[1]));
            if (a - b).abs() >= 0.3 * a.max(b) - 0.1 {
                continue;
            }
            let both = (with_walls(&two[0]), with_walls(&two[1]));
            if let (Some(&k), Some(&l)) = (both.0.first(), both.1.first()) {
                assert!(
                    !differ(walls[k], walls[l]),
                    "{what}: {two:?} at {} {}",
                    walls[k],
                    walls[l]
                );
                alike += usize::from(walls[k] != walls[l]);
            }
        }
    }
    assert!(slowed > 100 && alike > 10, "{slowed} {alike}");
}

#[test]
fn what_is_inside_slows_down_first_and_outer_walls_last() {
    for Pair { what, cooled, free, .. } in PAIRS.iter().filter(|pair| pair.ratio == 1) {
        let (took, would) = (seconds(cooled), seconds(free));
        let of = |kinds: &[Kind]| (feeds(cooled, kinds), feeds(free, kinds));
        let (inside, _) = of(&INSIDE);
        let (inner, inner_asked) = of(&[Kind::InnerWall]);
        let (outer, outer_asked) = of(&OUTSIDE);
        // Only a slower layer beside it makes outer walls slower than a layer itself needs: then
        // it takes longer than the least time.
        for k in (0..took.len()).filter(|&k| would[k] < LEAST && took[k] < 1.01 * LEAST) {
            let what = format!("{what}: layer {k}, {} s", took[k]);
            if inner[k] < inner_asked[k] || outer[k] < outer_asked[k] {
                let evened = outer[k] < outer_asked[k] && inner[k] == inner_asked[k];
                assert!(inside[k] <= SLOWEST || evened, "{what}: inside at {}", inside[k]);
            }
        }
    }
    // Alike from bottom to top: no layer is slowed down for another's sake.
    for (side, inside, inner, outer) in [
        (14.0, 3000.0, 1620.0, 1620.0),
        (8.0, SLOWEST, 1620.0, 1620.0),
        (6.0, SLOWEST, SLOWEST, 1620.0),
    ] {
        let half = side / 2.0;
        let tower = Solid::cuboid([-half, -half, 0.0], [half, half, 6.0]);
        let run = slice_shipped(&tower.stl(), "generic-marlin", &[]);
        let took = seconds(&run);
        for (k, took) in took.iter().enumerate().take(20).skip(5) {
            let feed = |kinds: &[Kind]| feeds(&run, kinds)[k];
            let (a, b, c) = (feed(&INSIDE), feed(&[Kind::InnerWall]), feed(&[Kind::OuterWall]));
            assert!(a <= inside && b <= inner && c <= outer, "{side}: {a} {b} {c}");
            assert!(*took < 1.01 * LEAST || (a, b, c) == (3600.0, 1620.0, 1620.0), "{took}");
            // A kind is only slower if those before it are as slow as they may be.
            assert!(b == 1620.0 || a <= SLOWEST, "{side}: {a} {b} {c}");
            assert!(c == 1620.0 || a <= SLOWEST && b <= SLOWEST, "{side}: {a} {b} {c}");
        }
    }
}

#[test]
fn bytes_do_not_depend_on_threads() {
    let text = |threads: usize, set: &[(&str, &str)]| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| slice_shipped(&cone().stl(), "generic-marlin", set).text)
    };
    let ways: [&[(&str, &str)]; 3] = [
        &[],
        &[
            ("dual.mode", "pair"),
            ("layer_height", "0.1"),
            ("dual.ratio", "3"),
            ("cooling.wait", "true"),
        ],
        &[("dual.mode", "pair"), ("cooling.min_fan", "20"), ("speed.wall", "200")],
    ];
    for set in ways {
        let one = text(1, set);
        assert!([2, 3, 7].iter().all(|&threads| text(threads, set) == one), "{set:?}");
    }
}

#[test]
fn a_print_without_quick_layers_is_the_same_with_and_without_a_least_time() {
    let brick = Solid::cuboid([0.0; 3], [12.0, 12.0, 4.0]).stl();
    let lines = |seconds: &str| {
        let set = [("dual.mode", "pair"), ("cooling.min_layer_time", seconds)];
        let run = slice_shipped(&brick, "generic-marlin", &set);
        let lines = run.text.lines().filter(|line| !line.starts_with("; cooling.min_layer_time"));
        lines.map(str::to_owned).collect::<Vec<_>>()
    };
    assert!(lines("0") == lines("1"));
}

#[test]
fn the_report_says_what_was_slowed_down() {
    for ratio in [1, 2] {
        let Pair { cooled, free, .. } = pair("cone", &cone(), "generic-marlin", &[], ratio);
        assert_eq!(free.report.cooling, None);
        let report = cooled.report.cooling.as_ref().unwrap();
        let differ = |kinds: &[Kind]| {
            let beads = cooled.print.beads().zip(free.print.beads());
            let slower =
                beads.filter(|(slow, fast)| kinds.contains(&slow.kind) && slow.feed < fast.feed);
            let layers: std::collections::BTreeSet<_> =
                slower.map(|(bead, _)| bead.layer).collect();
            layers.len()
        };
        let counts = [differ(&INSIDE), differ(&[Kind::InnerWall]), differ(&OUTSIDE)];
        assert_eq!(report.kinds.iter().map(|kind| kind.layers).collect::<Vec<_>>(), counts);
        let all = [&INSIDE[..], &OUTSIDE, &[Kind::InnerWall]].concat();
        assert_eq!(report.slowed_layers, differ(&all));
        // Infill from 60 to 10 mm/s.
        assert!((report.lowest_factor - 1.0 / 6.0).abs() < 1e-9, "{}", report.lowest_factor);
        let quick: Vec<usize> = report.quick.iter().map(|layer| layer.layer - 1).collect();
        let times = &cooled.report.time.layers;
        let expected: Vec<usize> = (0..times.len()).filter(|&k| times[k].time_s < LEAST).collect();
        assert_eq!((quick, report.quick_layers), (expected.clone(), expected.len()));
        assert!(report.quick_layers > 3);
        assert!(cooled.report.flow.largest_mm3_s <= free.report.flow.largest_mm3_s);
    }
}

#[test]
fn the_nozzle_waits_beside_the_part_where_slow_is_not_slow_enough() {
    for profile in PROFILES {
        let waits = pair("cone", &cone(), profile, &[("cooling.wait", "true")], 2).cooled;
        assert!(seconds(&waits).iter().all(|&s| s >= LEAST), "{profile}");
        let report = waits.report.cooling.as_ref().unwrap();
        assert_eq!((report.quick_layers, report.quick.len()), (0, 0), "{profile}");
        let pauses: Vec<f64> = waits
            .text
            .lines()
            .filter_map(|line| Some(line.strip_prefix("G4 P")?.parse::<f64>().unwrap() / 1000.0))
            .collect();
        assert_eq!(pauses.len(), report.waits, "{profile}");
        assert!(pauses.len() > 3, "{profile}");
        assert!((pauses.iter().sum::<f64>() - report.waited_s).abs() < 1e-6, "{profile}");
        // It stands above the layer, away from all that is printed, and filament is pulled back.
        let lines: Vec<&str> = waits.text.lines().collect();
        let mut stands = waits.print.moves.iter().peekable();
        for (number, _) in lines.iter().enumerate().filter(|(_, line)| line.starts_with("G4")) {
            let mut last = None;
            while stands.peek().is_some_and(|m| m.line <= number) {
                last = stands.next();
            }
            let at = last.unwrap();
            let layer = at.layer.unwrap();
            assert!(at.to[2] > waits.print.layers[layer].z + 1.0, "{profile}: {at:?}");
            let beads = waits.print.beads().filter(|bead| bead.layer == Some(layer));
            let near = beads.map(|m| (m.to[0] - at.to[0]).hypot(m.to[1] - at.to[1]));
            assert!(near.fold(f64::MAX, f64::min) > 9.0, "{profile}: {at:?}");
            assert!(at.pulled > 0.0, "{profile}: {at:?}");
        }
        let time = &waits.report.time;
        let layers: f64 = time.layers.iter().map(|layer| layer.time_s).sum();
        assert!((layers - time.total_s).abs() < 1e-6);
    }
}

#[test]
fn the_fan_goes_by_layer_time_and_role_in_each_dialect() {
    // What the fan is set to while each kind of line of each layer is laid.
    fn blows(run: &Run) -> Vec<(usize, Kind, u32)> {
        let (mut power, mut seen) = (0, Vec::new());
        let mut moves = run.print.beads().peekable();
        for (number, line) in run.text.lines().enumerate() {
            let line = line.trim();
            if let Some(value) = line.strip_prefix("M106 S") {
                power = value.parse().unwrap();
            } else if line.starts_with("M107") || line.starts_with("M127") {
                power = 0;
            } else if line.starts_with("M126") {
                power = 255;
            }
            while let Some(bead) = moves.next_if(|bead| bead.line <= number + 1) {
                seen.push((bead.layer.unwrap(), bead.kind, power));
            }
        }
        seen.dedup();
        seen
    }
    let set = [
        ("support.enabled", "true"),
        ("filament.fan", "80"),
        ("cooling.fan_full_from_layer", "5"),
        ("cooling.overhang_fan", "60"),
        ("cooling.interface_fan", "50"),
        ("cooling.bridge_fan", "100"),
    ];
    let on = |percent: f64| (percent * 2.55).round() as u32;
    for (profile, switches) in
        [("generic-marlin", false), ("generic-klipper", false), ("zcube-dual", true)]
    {
        let run = slice_shipped(&fixture("overhang.stl"), profile, &set);
        let mut kinds = std::collections::BTreeSet::new();
        for (layer, kind, power) in blows(&run) {
            let usual = [0.0, 20.0, 40.0, 60.0].get(layer).copied().unwrap_or(80.0);
            let wanted = match kind {
                _ if layer == 0 => 0.0,
                Kind::Bridge => 100.0,
                Kind::Overhang => 60.0,
                Kind::SupportInterface => 50.0,
                _ => usual,
            };
            let wanted = if switches { 255 * u32::from(wanted > 0.0) } else { on(wanted) };
            assert_eq!(power, wanted, "{profile}: {kind:?} on layer {layer}");
            kinds.insert(kind);
        }
        assert!(kinds.contains(&Kind::SupportInterface), "{kinds:?}");
        if switches {
            // It stays on: nothing is said again that is so already.
            assert_eq!(run.text.matches("M126").count(), 1, "{profile}");
        }
    }
    // By time: the same on both layers of a pair, the less the longer they take.
    let set = [
        ("cooling.min_fan", "20"),
        ("cooling.fan_full_from_layer", "1"),
        ("cooling.min_fan_time", "30"),
    ];
    let run = pair("cone", &cone(), "generic-marlin", &set, 2).cooled;
    let took = seconds(&run);
    let mut by_layer = vec![0; took.len()];
    blows(&run).iter().for_each(|&(layer, _, power)| by_layer[layer] = power);
    let mut powers = std::collections::BTreeSet::new();
    for group in groups(took.len(), 2).iter().skip(1) {
        let mean = group.iter().map(|&k| took[k]).sum::<f64>() / group.len() as f64;
        let share = ((mean - 10.0) / 20.0).clamp(0.0, 1.0);
        for &k in group {
            let wanted = on(100.0 - 80.0 * share);
            assert!(by_layer[k].abs_diff(wanted) <= 2, "layer {k}: {} for {wanted}", by_layer[k]);
            powers.insert(by_layer[k]);
        }
    }
    assert!(powers.len() > 2, "{powers:?}");
}
