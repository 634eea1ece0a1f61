//! Prints -> times, flows and costs: tests that file and report agree with the moves.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common::{Run, Solid, beside_droop, fixture, slice};
use slicer::estimate::{Options, estimate};
use slicer::motion::Limits;
use slicer::warning::Warning;

/// The values of each `M73`: whether it stands at a layer's beginning, P and R.
fn progress(run: &Run) -> Vec<(bool, u64, Option<u64>)> {
    let mut lines = Vec::new();
    let mut before = [""; 2];
    for line in run.text.lines() {
        if let Some(words) = line.strip_prefix("M73 P") {
            let mut words = words.split_whitespace();
            let percent = words.next().unwrap().parse().unwrap();
            let minutes = words.next().map(|word| word.strip_prefix('R').unwrap().parse().unwrap());
            lines.push((before[0] == ";BEFORE_LAYER_CHANGE", percent, minutes));
        }
        before = [before[1], line];
    }
    lines
}

/// mm³/s of each bead that is long enough for its rounding not to matter.
fn flows(run: &Run) -> impl Iterator<Item = f64> {
    let area = run.filament_area();
    let long = run.print.beads().filter(|m| m.length() > 1.0);
    long.map(move |m| m.e * area / m.length() * m.feed / 60.0)
}

#[test]
fn parts_of_the_time_add_up_and_no_move_is_faster_than_its_feed() {
    for profile in ["generic-marlin", "generic-klipper", "zcube-dual", "witbox-1"] {
        let run = slice(&fixture("bracket.stl"), profile, &[("dual.mode", "pair")]);
        let (time, travel) = (&run.report.time, &run.report.travel);
        let roles: f64 = run.report.roles.iter().map(|role| role.time_s).sum();
        let parts = roles + travel.time_s + travel.retraction_time_s;
        assert!((parts / time.total_s - 1.0).abs() < 1e-9, "{profile}: {parts}");
        let layers: f64 = time.layers.iter().map(|layer| layer.time_s).sum();
        assert!((layers / time.total_s - 1.0).abs() < 1e-9, "{profile}: {layers}");
        assert_eq!(time.layers.len(), run.report.layers.count, "{profile}");
        let on_feed: f64 = run.print.beads().map(|m| 60.0 * m.length() / m.feed).sum();
        assert!(roles > on_feed, "{profile}: {roles} s for {on_feed} s");
        assert!(time.total_s < 3.0 * on_feed, "{profile}: {} s for {on_feed} s", time.total_s);
    }
}

#[test]
fn layers_and_their_spread_are_told() {
    let run = slice(&fixture("bracket.stl"), "generic-marlin", &[]);
    let time = &run.report.time;
    let seconds: Vec<f64> = time.layers.iter().map(|layer| layer.time_s).collect();
    assert_eq!(time.longest_layer_s, seconds.iter().copied().fold(0.0, f64::max));
    assert_eq!(time.shortest_layer_s, seconds.iter().copied().fold(f64::MAX, f64::min));
    let mean = time.total_s / seconds.len() as f64;
    let square = seconds.iter().map(|s| s * s).sum::<f64>() / seconds.len() as f64;
    let spread = (square - mean * mean).sqrt() / mean;
    assert!((time.layer_spread - spread).abs() < 1e-6, "{spread}");
    let tops = run.print.layers.iter().map(|layer| layer.z);
    assert!(time.layers.iter().zip(tops).all(|(layer, z)| (layer.z_mm - z).abs() < 1e-9));
}

#[test]
fn progress_is_told_in_time_at_each_layer() {
    for profile in ["generic-marlin", "generic-klipper", "zcube-dual"] {
        let run = slice(&fixture("bracket.stl"), profile, &[("dual.mode", "pair")]);
        let lines = progress(&run);
        let at_layers: Vec<_> = lines.iter().filter(|line| line.0).collect();
        let time = &run.report.time;
        assert_eq!(at_layers.len(), time.layers.len(), "{profile}");
        let mut begin = 0.0;
        for (&&(_, percent, minutes), layer) in at_layers.iter().zip(&time.layers) {
            let part = 100.0 * begin / time.total_s;
            assert!(
                (part - 0.5 - percent as f64).abs() < 0.5 + 1e-6,
                "{profile}: {percent} {part}"
            );
            assert_eq!(minutes.is_some(), profile == "generic-marlin");
            if let Some(minutes) = minutes {
                let left = (time.total_s - begin) / 60.0;
                assert!((left - minutes as f64).abs() < 0.5 + 1e-6, "{profile}: {minutes} {left}");
            }
            begin += layer.time_s;
        }
    }
}

#[test]
fn long_layers_tell_progress_every_minute() {
    let slow = [("speed.wall", "1.667"), ("speed.skin", "1.667"), ("speed.infill", "1.667")];
    let run = slice(&fixture("bracket.stl"), "generic-marlin", &slow);
    let minutes: Vec<u64> = progress(&run).iter().filter_map(|line| line.2).collect();
    let time = &run.report.time;
    assert!(time.longest_layer_s > 600.0, "{}", time.longest_layer_s);
    // Paths that take longer than a minute leave out lines.
    let least = 0.5 * time.total_s / 60.0;
    assert!(minutes.len() as f64 > least, "{} of {least}", minutes.len());
    assert!(minutes.is_sorted_by(|a, b| a >= b));
    // Speeds below 2 mm/s are hardly meant.
    let warnings: Vec<String> = beside_droop(&run).iter().map(ToString::to_string).collect();
    let says = |setting| format!("{setting} = 1.667 is very slow; speeds are in mm/s");
    assert_eq!(warnings, slow.map(|(setting, _)| says(setting)));
}

#[test]
fn the_file_says_how_long_it_takes() {
    let run = slice(&fixture("tile.stl"), "generic-marlin", &[]);
    let line = "; estimated printing time (normal mode) = ";
    let said = run.text.lines().find_map(|l| l.strip_prefix(line)).unwrap();
    let seconds: u64 = said
        .split(' ')
        .map(|part| {
            let (number, unit) = part.split_at(part.len() - 1);
            let unit = match unit {
                "d" => 86_400,
                "h" => 3_600,
                "m" => 60,
                _ => 1,
            };
            unit * number.parse::<u64>().unwrap()
        })
        .sum();
    assert!((seconds as f64 - run.report.time.total_s).abs() <= 0.5, "{said}");
}

#[test]
fn lines_that_the_hot_end_cannot_follow_are_slowed_down_and_told() {
    let dual = ("dual.mode", "pair");
    let free = slice(&fixture("bracket.stl"), "generic-marlin", &[dual]);
    let fastest = flows(&free).fold(0.0, f64::max);
    assert!((fastest / free.report.flow.largest_mm3_s - 1.0).abs() < 0.01, "{fastest}");
    assert_eq!(beside_droop(&free), []);

    let set = [dual, ("machine.max_volumetric_speed", "3")];
    let held = slice(&fixture("bracket.stl"), "generic-marlin", &set);
    assert!(held.report.flow.largest_mm3_s <= 3.0);
    assert!(flows(&held).all(|flow| flow < 3.0 * 1.01));
    assert!(held.report.time.total_s > free.report.time.total_s);
    // What is laid is the same, only slower.
    assert_eq!(held.print.moves.len(), free.print.moves.len());
    let warnings = beside_droop(&held);
    let asked: Vec<_> = warnings
        .iter()
        .map(|warning| match warning {
            Warning::FlowLimited { role, setting, asked_mm_s, lowest_mm_s, limit_mm3_s } => {
                assert!(lowest_mm_s < asked_mm_s && *limit_mm3_s == 3.0, "{warning}");
                (role.as_str(), setting.as_str(), *asked_mm_s)
            }
            other => panic!("{other}"),
        })
        .collect();
    let expected = [
        ("skin", "speed.skin", 50.0),
        ("infill", "speed.infill", 60.0),
        ("thick infill", "speed.thick_infill", 60.0),
        ("top skin", "speed.skin", 50.0),
    ];
    assert_eq!(asked, expected);
    let said = warnings[2].to_string();
    assert!(said.contains("from 60 to") && said.contains("speed.thick_infill"), "{said}");
}

#[test]
fn a_material_that_melts_slowly_is_printed_slower_without_a_word() {
    let run =
        slice(&fixture("cube_20.stl"), "generic-marlin", &[("filament.max_volumetric_speed", "3")]);
    assert!(run.report.warnings.is_empty(), "{:?}", run.report.warnings);
    let flow = &run.report.flow;
    assert!(flow.limit_mm3_s == 3.0 && flow.largest_mm3_s <= 3.0 && flow.largest_mm3_s > 2.9);
}

#[test]
fn a_price_makes_a_cost() {
    let line = |run: &Run| {
        let line = run.text.lines().find_map(|l| l.strip_prefix("; filament cost = "));
        line.map(str::to_owned)
    };
    let free = slice(&fixture("tile.stl"), "generic-marlin", &[]);
    assert_eq!((line(&free), free.report.filament.cost), (None, None));
    let paid = slice(&fixture("tile.stl"), "generic-marlin", &[("filament.cost", "25")]);
    let cost = 25.0 * paid.report.filament.weight_g / 1000.0;
    assert!((paid.report.filament.cost.unwrap() - cost).abs() < 1e-9);
    assert_eq!(line(&paid), Some(format!("{cost:.2}")));
}

#[test]
fn an_estimate_of_the_file_agrees() {
    let profiles = ["generic-marlin", "generic-klipper", "zcube-dual", "thesis", "witbox-1"];
    for profile in profiles {
        for (model, hop) in [("bracket.stl", "0"), ("overhang.stl", "0.3")] {
            let set = [("dual.mode", "pair"), ("retraction.z_hop", hop)];
            agrees(&slice(&fixture(model), profile, &set), &format!("{model} {profile}"));
        }
    }
}

/// What the start block tells the machine is what is timed, whatever the accelerations are.
#[test]
fn an_estimate_agrees_where_accelerations_are_not_the_profiles() {
    for profile in ["generic-marlin", "generic-klipper", "generic-reprapfirmware"] {
        for (own, travel) in [("5000", "300"), ("200", "3000")] {
            let set = [("machine.acceleration", own), ("limits.travel_acceleration", travel)];
            agrees(&slice(&fixture("overhang.stl"), profile, &set), &format!("{profile} {own}"));
        }
    }
}

#[test]
fn an_estimate_of_a_file_with_arcs_agrees() {
    // 72 corners lie within the tolerance.
    let lens = Solid::cylinder(8.0, 2.0, 72);
    for profile in ["generic-marlin", "generic-klipper", "generic-reprapfirmware"] {
        for rate in ["0", "40"] {
            let arcs = [("arcs", "true"), ("machine.arcs", "true"), ("arc_tolerance", "0.02")];
            let set = [("limits.max_segment_rate", rate), ("limits.look_ahead", "16")];
            let run = slice(&lens.stl(), profile, &[arcs.as_slice(), &set].concat());
            assert!(run.report.arcs.as_ref().unwrap().count > 20, "{profile}");
            agrees(&run, &format!("{profile} {rate}"));
        }
    }
}

/// An estimate of a run's file comes to the time that it says, in all and layer by layer.
fn agrees(run: &Run, what: &str) {
    // Without the end block, which would count as part of the last layer.
    let end = run.text.rfind(";TYPE:Custom").unwrap();
    let options =
        Options { filament_diameter: run.settings.filament.diameter, ..Options::default() };
    let limits = Limits::new(&run.settings);
    let text = &run.text.as_bytes()[..end];
    let read = estimate(&mut &text[..], "test", &limits, options).unwrap();
    let time = &run.report.time;
    // Only the start block knows where the first travel of a print begins.
    let read_s = read.seconds - read.start_seconds - read.layers[0].seconds;
    let said_s = time.total_s - time.layers[0].time_s;
    let what = format!("{what}: {read_s} s of {said_s} s");
    assert!((read_s / said_s - 1.0).abs() < 0.005, "{what}");
    for (read, said) in read.layers.iter().zip(&time.layers) {
        // Axes that go down to the first layer may be slow.
        let most = 0.01 * said.time_s + if said.z_mm < 0.3 { 6.0 } else { 0.2 };
        assert!((read.seconds - said.time_s).abs() < most, "{what}: {read:?} {said:?}");
    }
}

#[test]
fn progress_goes_on_within_a_skin_that_is_one_long_path() {
    let keys = [("nonplanar.enabled", "true"), ("head.name", "long-0.6"), ("speed.nonplanar", "2")];
    let run = slice(&fixture("wedge.stl"), "generic-marlin", &keys);
    let skin = run.report.roles.iter().find(|role| role.role == "non-planar skin").unwrap();
    assert!(skin.time_s > 500.0, "{}", skin.time_s);
    let left: Vec<u64> = progress(&run).iter().filter_map(|(_, _, minutes)| *minutes).collect();
    let jump = left.windows(2).map(|two| two[0].abs_diff(two[1])).max();
    assert!(jump <= Some(2), "{left:?}");
}
