//! Toolpaths with paths that rise and fall -> G-code: travels, marks, feeds, times and heights.
//!
//! The toolpaths are made by hand: a square of walls on some layers, and on one of them a patch of
//! non-planar skin. What the file does is read from its lines by this file's own few words of G-code.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use slicer::estimate::{Options, estimate};
use slicer::fill::adhesion::lift::Lift;
use slicer::fill::{Path, PathPoint, Role, Shape};
use slicer::gcode::reshaped::Bound;
use slicer::gcode::{Sums, Writer};
use slicer::geom::Point;
use slicer::motion::Limits;
use slicer::pipeline::raise::raise;
use slicer::plan::{Nozzle, PlanParams, PrintMove, Toolpath, travel};
use slicer::profile::template::PrintFacts;
use slicer::profile::{JunctionRule, Override, Settings, ValueOrigin, load};
use std::io::Cursor;

/// The top of the layer on which patches are printed, mm: the third.
const TOP: f64 = 0.6;

fn settings(profile: &str, set: &[(&str, &str)]) -> Settings {
    let plain =
        [("cooling.min_layer_time", "0"), ("layer_height", "0.2"), ("speed.nonplanar", "20")];
    let given = plain.iter().chain(set).map(|(key, value)| Override {
        key: (*key).to_owned(),
        value: (*value).to_owned(),
        origin: ValueOrigin::Set,
    });
    load([profile], &given.collect::<Vec<_>>()).unwrap().settings
}

fn units(mm: f64) -> i32 {
    (10_000.0 * mm).round() as i32
}

/// A path through places x, y, z, mm; each with its bead's height.
fn path(role: Role, places: &[([f64; 3], f64)]) -> Path {
    let point = |&([x, y, z], height): &([f64; 3], f64)| PathPoint {
        at: Point { x: units(x), y: units(y) },
        z: units(z),
        width: 4_000,
        height: units(height),
        hang: 0,
    };
    let points = places.iter().map(point).collect();
    Path { role, shape: Shape::Open, points, layers: 1 }
}

/// A line of skin along x at this y, its height over the layer's top as `z` says.
fn line(y: f64, xs: impl IntoIterator<Item = f64>, z: impl Fn(f64) -> f64) -> Path {
    let places: Vec<_> = xs.into_iter().map(|x| ([x, y, z(x)], 0.2)).collect();
    path(Role::NonPlanar, &places)
}

/// From 0 to 30 mm in steps of this length, mm.
fn steps(step: f64) -> impl Iterator<Item = f64> {
    (0..=(30.0 / step).round() as u32).map(move |k| step * f64::from(k))
}

/// Four layers of a square, and on the third a patch with the number 7. All travels to its paths go
/// `over` that, mm.
fn layers(patch: &[Path], over: f64, settings: &Settings) -> Vec<Toolpath> {
    let plan = PlanParams::new(settings);
    let corners = [[0.0, 0.0], [30.0, 0.0], [30.0, 30.0], [0.0, 30.0], [0.0, 0.0]];
    let square: Vec<_> = corners.map(|[x, y]| ([x, y, 0.0], 0.2)).to_vec();
    let wall = path(Role::OuterWall, &square);
    let mut nozzle = Nozzle::default();
    let mut all = Vec::new();
    for (layer, z) in [2_000, 4_000, 6_000, 8_000].into_iter().enumerate() {
        let moves = vec![PrintMove { retract: true, ..PrintMove::to(wall.clone()) }];
        let mut toolpath = Toolpath { layer, z, height: 2_000, from: nozzle, moves };
        nozzle = Nozzle { at: Some(wall.end()), highest: nozzle.highest.max(z) };
        if z == units(TOP) && !patch.is_empty() {
            let paths = patch.iter().map(|path| (path.clone(), units(over)));
            travel::add_patch(&mut toolpath, 7, paths, &plan);
            nozzle = nozzle.after_patch(z, patch, units(settings.nonplanar.clearance));
        }
        all.push(toolpath);
    }
    all
}

fn written(toolpaths: &[Toolpath], settings: &Settings) -> (String, Sums) {
    let mut out = Cursor::new(Vec::new());
    let facts = PrintFacts { layers: toolpaths.len(), ..PrintFacts::default() };
    let mut writer = Writer::new(&mut out, settings, facts, [100.0, 100.0], &[]).unwrap();
    writer.layers(toolpaths).unwrap();
    let sums = writer.finish().unwrap().unwrap();
    (String::from_utf8(out.into_inner()).unwrap(), sums)
}

fn print(patch: &[Path], over: f64, settings: &Settings) -> (String, Sums) {
    written(&layers(patch, over, settings), settings)
}

/// What a move does.
#[derive(Debug, Clone, Copy)]
struct Step {
    from: [f64; 3],
    to: [f64; 3],
    /// Filament is pushed.
    prints: bool,
    /// mm/s.
    feed: f64,
    /// Within a patch.
    in_patch: bool,
}

impl Step {
    fn sideways(&self) -> bool {
        self.from[..2] != self.to[..2]
    }

    fn long(&self) -> f64 {
        (0..3).map(|k| (self.to[k] - self.from[k]).powi(2)).sum::<f64>().sqrt()
    }

    fn sine(&self) -> f64 {
        (self.to[2] - self.from[2]) / self.long()
    }
}

/// The moves of the layers, with E as differences or sums.
fn moves(text: &str) -> Vec<Step> {
    let (mut at, mut e, mut feed, mut in_patch, mut relative) = ([0.0; 3], 0.0, 0.0, false, false);
    let (mut steps, mut begun) = (Vec::new(), false);
    for text in text.lines() {
        begun |= text == ";LAYER_CHANGE";
        relative |= text == "M83";
        in_patch = text.starts_with(";NONPLANAR_START") || in_patch && text != ";NONPLANAR_END";
        if begun && text.starts_with(";TYPE:Custom") {
            break;
        }
        if text.starts_with("G92") {
            e = 0.0;
        }
        if !text.starts_with("G1 ") {
            continue;
        }
        let (from, before) = (at, if relative { 0.0 } else { e });
        for word in text.split_whitespace().skip(1) {
            let value: f64 = word[1..].parse().unwrap();
            match &word[..1] {
                "X" => at[0] = value,
                "Y" => at[1] = value,
                "Z" => at[2] = value,
                "E" => e = value,
                _ => feed = value / 60.0,
            }
        }
        let prints = text.contains(" E") && e > before && from != at;
        if begun {
            steps.push(Step { from, to: at, prints, feed, in_patch });
        }
    }
    steps
}

/// The beads of the patch.
fn beads(text: &str) -> Vec<Step> {
    moves(text).into_iter().filter(|step| step.in_patch && step.prints).collect()
}

fn ridge(x: f64) -> f64 {
    0.2 * (15.0 - (x - 15.0).abs())
}

/// The wave of the thesis: z'' up to 0.095 /mm.
fn wave(x: f64) -> f64 {
    let turn = std::f64::consts::TAU / 20.0;
    0.095 / (turn * turn) * (1.0 - (turn * x).cos()) / 2.0 * 2.0
}

#[test]
fn a_patch_is_written_after_its_layer_between_marks_with_its_own_heights() {
    let settings = settings("generic-klipper", &[("speed.nonplanar", "10")]);
    let up = [([5.0, 5.0, -0.1], 0.2), ([7.0, 5.0, 0.0], 0.2), ([9.0, 5.0, 0.3], 0.215)];
    let on = [([11.0, 5.0, 0.6], 0.225), ([11.0, 6.0, 0.6], 0.225), ([11.0, 6.0, 0.7], 0.225)];
    let paths = [path(Role::NonPlanar, &up), path(Role::NonPlanar, &on)];
    let (text, _) = print(&paths, 1.5, &settings);
    let layer = text.find(";Z:0.6\n").unwrap();
    let patch = &text[layer..text.find(";Z:0.8\n").unwrap()];
    let patch = &patch[patch.find(";NONPLANAR_START").unwrap()..];
    let kept = patch.lines().filter(|line| *line != ";LAYER_CHANGE");
    let patch: String = kept.map(|line| format!("{line}\n")).collect();
    assert_eq!(patch, include_str!("slopes/patch.txt"), "{patch}");
    assert_eq!(text.matches(";NONPLANAR_").count(), 2);
    assert_eq!(text.matches(";LAYER_CHANGE").count(), 4);
}

#[test]
fn travels_rise_before_they_go_sideways_and_pass_over_what_a_patch_left() {
    let [lower, upper] = [10.0, 10.4].map(|y| line(y, [1.0, 15.0, 29.0], ridge));
    for retracts in ["0", "1"] {
        for hop in ["0", "0.4"] {
            let set = [("retraction.length", retracts), ("retraction.z_hop", hop)];
            let settings = settings("generic-marlin", &set);
            let (text, _) = print(&[lower.clone(), upper.clone()], 4.5, &settings);
            let mut after = false;
            for step in moves(&text).iter().filter(|step| step.sideways()) {
                after |= step.in_patch;
                if step.prints {
                    continue;
                }
                assert_eq!(step.from[2], step.to[2], "{step:?}");
                // 3 mm above the layer's top, and the clearance.
                let least = if step.in_patch { 4.5 } else { TOP + 3.0 + 0.5 };
                assert!(!after || step.to[2] >= least - 1e-9, "{step:?}, hop {hop}");
            }
            assert!(after);
        }
    }
}

#[test]
fn within_a_patch_the_plan_says_how_high_travels_go() {
    let settings = settings("generic-marlin", &[]);
    let [lower, upper] = [10.0, 10.4].map(|y| line(y, [1.0, 15.0, 29.0], ridge));
    let heights = |over| -> Vec<f64> {
        let (text, _) = print(&[lower.clone(), upper.clone()], over, &settings);
        let travels = moves(&text).into_iter().filter(|s| s.in_patch && s.sideways() && !s.prints);
        travels.map(|step| step.to[2]).collect()
    };
    // The first one over the layer, the second from the end of a line to the beginning of the next.
    assert_eq!(heights(0.0), [TOP + 0.2, TOP + 0.2]);
    assert_eq!(heights(4.5), [4.5, 4.5]);
}

#[test]
fn the_first_travel_of_a_print_rises_as_well() {
    let settings = settings("generic-marlin", &[]);
    let path = line(10.0, [1.0, 29.0], |_| 0.0);
    let moves = vec![PrintMove { over: 50_000, ..PrintMove::to(path) }];
    let first = Toolpath { layer: 0, z: 2_000, height: 2_000, from: Nozzle::default(), moves };
    let (text, _) = written(&[first], &settings);
    let travel = self::moves(&text).into_iter().find(Step::sideways).unwrap();
    assert_eq!((travel.from[2], travel.to[2], travel.prints), (5.0, 5.0, false));
}

#[test]
fn short_lines_keep_to_the_speed_of_z_as_the_file_tells_it() {
    // A step rises by 69.1 µm, which the file tells as 69 or 70.
    let settings = settings("generic-marlin", &[("limits.speed_z", "5")]);
    let line = line(10.0, steps(0.1).take(60), |x| 0.691 * x);
    let (text, _) = print(&[line], 4.5, &settings);
    let beads = beads(&text);
    let fastest = beads.iter().map(|bead| bead.feed * bead.sine()).fold(0.0, f64::max);
    assert!(beads.len() > 50 && fastest > 4.9 && fastest <= 5.0 + 1e-6, "{fastest}");
}

/// Asserts what the z axis bears on every line of a patch, and between any two that follow each other.
fn within_limits(text: &str, settings: &Settings) {
    let limits = &settings.limits;
    let beads = beads(text);
    for bead in &beads {
        assert!(bead.feed * bead.sine().abs() <= limits.speed_z * 1.01, "{bead:?}");
        assert!(bead.feed <= settings.speed.nonplanar + 1e-9, "{bead:?}");
    }
    for joint in beads.windows(2).filter(|joint| joint[0].to == joint[1].from) {
        // z is rounded by half a thousandth at each end of a line.
        let rounding = 0.001 / joint[0].long() + 0.001 / joint[1].long();
        let change = (joint[1].sine() - joint[0].sine()).abs() - rounding;
        let mean = 0.5 * (joint[0].long() + joint[1].long());
        for bead in joint {
            let acceleration = bead.feed * bead.feed * change / mean;
            assert!(acceleration <= 1.01 * limits.acceleration_z, "{joint:?}");
            let jerk =
                !matches!(limits.junction, JunctionRule::Deviation | JunctionRule::SquareCorner);
            assert!(!jerk || bead.feed * change <= 1.01 * limits.jerk_z, "{joint:?}");
        }
    }
}

#[test]
fn z_bears_every_line() {
    for profile in
        ["generic-marlin", "witbox-1", "generic-klipper", "ender-3", "zcube-dual", "ultimaker-2"]
    {
        let settings = settings(profile, &[]);
        let roof = line(10.0, [0.0, 15.0, 30.0], ridge);
        let steep = line(11.0, [0.0, 30.0], |x| 0.7 * x);
        for path in [roof, steep, line(12.0, steps(0.6), wave), line(13.0, steps(0.25), wave)] {
            let (text, sums) = print(&[path], 30.0, &settings);
            within_limits(&text, &settings);
            let beads = beads(&text);
            let long: f64 = beads.iter().map(Step::long).sum();
            assert!((sums.usage.slopes.total() / long - 1.0).abs() < 1e-3, "{profile}");
        }
    }
}

#[test]
fn a_weak_z_axis_is_what_holds_a_wave() {
    let fastest_on_crest = |profile| {
        let settings = settings(profile, &[]);
        let (text, sums) = print(&[line(10.0, steps(0.25), wave)], 30.0, &settings);
        let beads = beads(&text);
        let crest = beads.iter().filter(|step| (step.to[0] - 110.0).abs() < 0.6);
        (crest.map(|step| step.feed).fold(0.0, f64::max), sums.usage.slopes)
    };
    // sqrt(10 mm/s² / 0.095 /mm) = 10.3 mm/s.
    let (feed, slopes) = fastest_on_crest("witbox-1");
    assert!((10.0..10.4).contains(&feed), "{feed}");
    assert!(slopes.of(Bound::ZAcceleration) > 0.5 * slopes.total(), "{slopes:?}");
    // 40 mm/s².
    let (feed, slopes) = fastest_on_crest("witbox-2");
    assert!(feed > 15.0, "{feed}");
    assert_eq!(slopes.of(Bound::ZAcceleration), 0.0, "{slopes:?}");
}

#[test]
fn a_long_line_is_slow_only_beside_its_joint() {
    let settings = settings("generic-marlin", &[]);
    let (text, sums) = print(&[line(10.0, [0.0, 15.0, 30.0], ridge)], 30.0, &settings);
    let beads = beads(&text);
    let lengths: Vec<f64> = beads.iter().map(Step::long).collect();
    assert_eq!(beads.len(), 4, "{lengths:?}");
    assert!((lengths[1] - 0.2).abs() < 2e-3 && (lengths[2] - 0.2).abs() < 2e-3, "{lengths:?}");
    // 0.4 mm/s by which the sine of 11.3° turns to its negative, and no slower than that.
    let most = 0.4 / (2.0 * 0.2 / 1.04_f64.sqrt());
    assert!((beads[1].feed - most).abs() < 0.02 && beads[2].feed == beads[1].feed, "{most}");
    assert_eq!([beads[0].feed, beads[3].feed], [20.0; 2]);
    assert!((sums.usage.slopes.of(Bound::ZJerk) - 0.4).abs() < 1e-6);
}

#[test]
fn what_the_hot_end_melts_and_what_z_can_do_are_told_apart() {
    let fast = [("speed.nonplanar", "150")];
    let slow = settings("ender-3", &fast);
    let (_, sums) = print(&[line(10.0, [0.0, 30.0], |x| 0.2 * x)], 30.0, &slow);
    let slopes = sums.usage.slopes;
    assert!((slopes.of(Bound::ZSpeed) / slopes.total() - 1.0).abs() < 1e-9, "{slopes:?}");
    let level = settings("generic-marlin", &[("speed.nonplanar", "150"), ("speed.z", "5")]);
    let most = level.max_volumetric_speed();
    let (text, sums) = print(&[line(10.0, [0.0, 30.0], |x| 0.01 * x)], 30.0, &level);
    let slopes = sums.usage.slopes;
    let feed = beads(&text)[0].feed;
    assert!(feed * 0.4 * 0.2 <= most * 1.001 && feed > 0.97 * most / 0.08, "{feed} {most}");
    assert!((slopes.of(Bound::Flow) / slopes.total() - 1.0).abs() < 1e-9, "{slopes:?}");
    assert!((sums.usage.flows.largest / most - 1.0).abs() < 0.01);
}

#[test]
fn cooling_makes_slopes_slower_and_never_faster() {
    let path = || [line(10.0, steps(0.6), wave)];
    let with = |set: &[(&str, &str)]| print(&path(), 30.0, &settings("generic-marlin", set)).0;
    let (warm, cool) = (with(&[]), with(&[("cooling.min_layer_time", "60")]));
    let (warm, cool) = (beads(&warm), beads(&cool));
    assert_eq!(warm.len(), cool.len());
    assert!(warm.iter().zip(&cool).all(|(warm, cool)| cool.feed <= warm.feed + 1e-9));
    assert!(warm.iter().zip(&cool).any(|(warm, cool)| cool.feed < warm.feed));
    // Where the nozzle waits, it goes there above the slope.
    let waits = [("cooling.min_layer_time", "400"), ("cooling.wait", "true")];
    let text = with(&waits);
    let (before, after) =
        text.split_once("G4 P").map(|_| text.rsplit_once("G4 P").unwrap()).unwrap();
    assert!(!before.is_empty() && !after.is_empty());
    let top = TOP + steps(0.6).map(wave).fold(0.0, f64::max);
    let moves = moves(&text);
    let first = moves.iter().position(|step| step.in_patch && step.prints).unwrap();
    for step in moves[first..].iter().filter(|step| step.sideways() && !step.prints) {
        assert!(step.to[2] >= top, "{step:?}");
    }
}

#[test]
fn arcs_are_level_and_short_lines_on_slopes_are_not_joined() {
    let set = [("arcs", "true"), ("machine.arcs", "true"), ("limits.max_segment_rate", "20")];
    let settings = settings("generic-marlin", &set);
    let circle = |rise: f64| -> Vec<([f64; 3], f64)> {
        let angle = |k: u32| 0.03 * f64::from(k);
        let at = |k| [15.0 + 8.0 * angle(k).cos(), 15.0 + 8.0 * angle(k).sin(), rise * angle(k)];
        (0..=90).map(|k| (at(k), 0.2)).collect()
    };
    let arcs = |rise| {
        let (text, _) = print(&[path(Role::NonPlanar, &circle(rise))], 5.0, &settings);
        let patch = &text[text.find(";NONPLANAR_START").unwrap()..];
        let patch = patch[..patch.find(";NONPLANAR_END").unwrap()].to_owned();
        let arcs = patch.lines().filter(|line| line.starts_with("G2") || line.starts_with("G3"));
        assert!(arcs.clone().all(|line| !line.contains(" Z")), "{patch}");
        (arcs.count(), beads(&text).len())
    };
    assert!(arcs(0.0).0 > 0);
    assert_eq!(arcs(0.3), (0, 90));
}

#[test]
fn heights_are_told_where_they_have_changed_and_drifts_are() {
    let settings = settings("generic-marlin", &[]);
    // Each of 40 lines is 0.005 mm higher than the one before.
    let places: Vec<_> = (0..=40)
        .map(|k| ([0.5 * f64::from(k), 10.0, 0.05 * f64::from(k)], 0.2 + 0.005 * f64::from(k)))
        .collect();
    let (text, _) = print(&[path(Role::NonPlanar, &places)], 5.0, &settings);
    let patch = &text[text.find(";NONPLANAR_START").unwrap()..];
    let (patch, after) = patch.split_once(";NONPLANAR_END").unwrap();
    let told: Vec<f64> =
        patch.lines().filter_map(|line| line.strip_prefix(";HEIGHT:")?.parse().ok()).collect();
    assert_eq!(told.len(), 10, "{told:?}");
    for (k, height) in told.iter().enumerate() {
        assert!((height - 0.205 - 0.02 * k as f64).abs() < 1e-9, "{told:?}");
    }
    // The next layer's own.
    assert!(after.contains(";LAYER_CHANGE\n;Z:0.8\n;HEIGHT:0.2\n"));
}

#[test]
fn the_file_takes_as_long_as_it_says_and_hosts_read_how_high_it_is() {
    for profile in ["generic-marlin", "witbox-1", "generic-klipper"] {
        let settings = settings(profile, &[]);
        let lines = (0..25).map(|k| line(3.0 + f64::from(k), steps(0.5), wave));
        let (text, sums) = print(&lines.collect::<Vec<_>>(), 4.0, &settings);
        let options = Options { filament_diameter: 1.75, ..Options::default() };
        let read =
            estimate(&mut text.as_bytes(), "slopes", &Limits::new(&settings), options).unwrap();
        // Where the start block leaves the nozzle is in the file alone.
        for (ours, theirs) in sums.times.layers.iter().zip(&read.layers).skip(1).take(2) {
            assert!((ours.seconds / theirs.seconds - 1.0).abs() < 0.001, "{profile}: {ours:?}");
        }
        // Its lines alone take longer than at the speed that is asked for.
        let skin = sums.times.roles[Role::NonPlanar].thin;
        assert!(skin > 25.0 * 30.0 / 20.0, "{profile}: {skin}");
        assert!(sums.times.layers[2].seconds > skin, "{profile}");
        let heights = text.split(";BEFORE_LAYER_CHANGE\n;").skip(1);
        let heights = heights.map(|rest| rest.lines().next().unwrap().parse::<f64>().unwrap());
        let top = TOP + steps(0.5).map(wave).fold(0.0, f64::max);
        assert!((heights.fold(0.0, f64::max) - top).abs() < 1e-3, "{profile}");
        assert!((f64::from(sums.usage.highest) / 10_000.0 - top).abs() < 1e-3);
    }
}

#[test]
fn a_raft_lifts_the_ways_to_a_patch_with_it() {
    let settings = settings("generic-marlin", &[("raft.enabled", "true")]);
    let lift = Lift::new(&settings);
    assert!(lift.by() > 0);
    let mut toolpaths = layers(&[line(10.0, [1.0, 15.0, 29.0], ridge)], 4.5, &settings);
    raise(&mut toolpaths, &lift);
    let overs: Vec<_> = toolpaths.iter().flat_map(|t| &t.moves).map(|next| next.over).collect();
    assert_eq!(overs, [0, 0, 0, 45_000 + lift.by(), 0]);
    let (text, _) = written(&toolpaths, &settings);
    let by = f64::from(lift.by()) / 10_000.0;
    let travel = moves(&text).into_iter().find(|step| step.in_patch && step.sideways()).unwrap();
    assert!((travel.from[2] - 4.5 - by).abs() < 1e-6 && !travel.prints, "{travel:?}");
}

#[test]
fn layers_without_slopes_have_no_marks_and_one_height_of_the_print() {
    let (text, sums) = print(&[], 0.0, &settings("generic-marlin", &[]));
    assert!(!text.contains("NONPLANAR_"));
    assert_eq!(text.matches(";BEFORE_LAYER_CHANGE").count(), 4);
    assert_eq!(sums.usage.slopes.total(), 0.0);
}
