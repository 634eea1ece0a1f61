//! Fixtures -> G-code, read back: what is printed where, as a person at the printer would see it.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common::checks::{self, furthest_out, sound, stringing_travels};
use crate::common::gcode::WALLS;
use crate::common::raster::Bitmap;
use crate::common::{Kind, Move, Run, Solid, fixture, slice};
use std::collections::{BTreeMap, BTreeSet};

const FIXTURES: [&str; 6] =
    ["cube_20.stl", "bracket.stl", "sphere_20.stl", "overhang.stl", "two_shells.stl", "cavity.stl"];
const DUAL: (&str, &str) = ("dual.mode", "pair");
const SUPPORT: (&str, &str) = ("support.enabled", "true");

const RELATIVE: (&str, &str) = ("machine.relative_e", "true");

fn all_layers(run: &Run) -> Vec<usize> {
    (0..run.print.layers.len()).collect()
}

/// The fixture's triangles where the machine prints them.
fn placed(name: &str, run: &Run) -> Solid {
    Solid::from_stl(&fixture(name)).on_bed(run.middle())
}

/// Layers with a bead that `which` says yes to.
fn layers(run: &Run, which: impl Fn(&Move) -> bool) -> BTreeSet<usize> {
    run.print.beads().filter(|m| which(m)).filter_map(|m| m.layer).collect()
}

/// `p` as seen from the middle of the bed.
fn from_middle(run: &Run, p: [f64; 2]) -> [f64; 2] {
    let middle = run.middle();
    [p[0] - middle[0], p[1] - middle[1]]
}

#[test]
fn every_fixture_prints_soundly_with_every_profile() {
    // An Ultimaker 2 counts E in mm³ and retracts by itself: `printers` reads its files. Two layers of
    // the draft are too tall for one line, as those of `narino`.
    let others = ["ultimaker-2", "draft", "narino", "strand"];
    for profile in slicer::profile::builtin_names().filter(|name| !others.contains(name)) {
        for name in FIXTURES {
            for set in [&[][..], &[DUAL, SUPPORT]] {
                let run = slice(&fixture(name), profile, set);
                sound(&run.print, &run.settings, &format!("{name} {profile} {set:?}"));
            }
        }
    }
}

#[test]
fn relative_filament_prints_as_soundly() {
    for profile in ["generic-marlin", "generic-klipper"] {
        let run = slice(&fixture("bracket.stl"), profile, &[RELATIVE, DUAL, SUPPORT]);
        sound(&run.print, &run.settings, profile);
    }
}

#[test]
fn unusual_settings_print_as_soundly() {
    for set in [
        &[("walls", "30")][..],
        &[("infill", "100"), DUAL],
        &[("infill", "0")],
        &[("skin_layers", "0"), DUAL],
        &[("layer_height", "0.1"), ("first_layer_height", "0.3"), DUAL, SUPPORT],
        &[("layer_height", "0.3"), ("first_layer_height", "0.2")],
        &[("line_width", "0.8"), ("skin_reach", "3"), DUAL],
        &[("tolerance", "0"), ("angle", "-31.5"), ("infill_overlap", "0")],
        &[("tolerance", "0.04"), ("pattern", "triangles"), DUAL],
        &[("pattern", "grid"), ("infill", "70"), DUAL],
        &[("retraction.length", "0")],
        &[("retraction.when", "always"), ("retraction.min_travel", "0"), ("seam", "nearest")],
        &[("wall_order", "outer-first"), ("walls", "3")],
        &[SUPPORT, ("support.threshold_angle", "90"), ("support.spacing", "0.5")],
    ] {
        for name in ["bracket.stl", "sphere_20.stl", "two_shells.stl"] {
            let run = slice(&fixture(name), "generic-marlin", set);
            let what = format!("{name} {set:?}");
            sound(&run.print, &run.settings, &what);
            let solid = placed(name, &run);
            let some: Vec<usize> = all_layers(&run).into_iter().step_by(5).collect();
            let (out, line) = furthest_out(&run.print, &solid, &some, |_| true);
            assert!(out <= 0.05, "{what}: line {line} reaches {out} mm out");
        }
    }
}

#[test]
fn a_part_without_walls_stays_within_its_contour() {
    for name in ["cube_20.stl", "bracket.stl"] {
        let run = slice(&fixture(name), "generic-marlin", &[("walls", "0")]);
        let solid = placed(name, &run);
        let some: Vec<usize> = all_layers(&run).into_iter().step_by(5).collect();
        let (out, line) = furthest_out(&run.print, &solid, &some, |_| true);
        assert!(out <= 0.05, "{name}: line {line} reaches {out} mm out");
    }
}

#[test]
fn no_bead_reaches_out_of_the_part() {
    for profile in ["generic-marlin", "zcube-dual"] {
        for name in FIXTURES {
            let run = slice(&fixture(name), profile, &[DUAL, SUPPORT]);
            let solid = placed(name, &run);
            let (out, line) = furthest_out(&run.print, &solid, &all_layers(&run), |_| true);
            assert!(out <= 0.05, "{name} {profile}: line {line} reaches {out} mm out");
        }
    }
}

#[test]
fn travels_across_an_outer_wall_pull_the_filament_back() {
    let towers = Solid::cuboid([0.0; 3], [8.0, 8.0, 4.0])
        .and(&Solid::cuboid([12.0, 3.0, 0.0], [20.0, 11.0, 4.0]));
    for profile in ["generic-marlin", "zcube-dual", "thesis"] {
        let run = slice(&towers.stl(), profile, &[]);
        let solid = towers.on_bed(run.middle());
        let strings = stringing_travels(&run.print, &solid, &run.settings, &all_layers(&run));
        assert!(strings.is_empty(), "{profile}: lines {strings:?}");
        // And there are such travels: from tower to tower on each layer.
        let pulled = run.print.moves.iter().filter(|m| m.is_travel() && m.pulled > 0.0);
        assert!(pulled.count() >= run.print.layers.len(), "{profile}");
    }
    for name in FIXTURES {
        let run = slice(&fixture(name), "generic-marlin", &[SUPPORT]);
        let solid = placed(name, &run);
        let strings = stringing_travels(&run.print, &solid, &run.settings, &all_layers(&run));
        assert!(strings.is_empty(), "{name}: lines {strings:?}");
    }
}

#[test]
fn travels_within_a_part_do_not_pull_unless_asked() {
    let far = [("retraction.max_travel", "100")];
    let run = slice(&fixture("cube_20.stl"), "generic-marlin", &far);
    assert!(run.report.travel.retractions <= 2, "{}", run.report.travel.retractions);
    let run = slice(&fixture("cube_20.stl"), "generic-marlin", &[("retraction.when", "always")]);
    assert!(run.report.travel.retractions >= 100, "{}", run.report.travel.retractions);
}

#[test]
fn the_lowest_and_highest_layers_are_solid() {
    for (profile, skins) in [("generic-marlin", "3"), ("zcube-dual", "5"), ("thesis", "3")] {
        let run = slice(&fixture("cube_20.stl"), profile, &[("skin_layers", skins)]);
        let n: usize = skins.parse().unwrap();
        let infill = layers(&run, |m| m.kind == Kind::Infill);
        let skin = layers(&run, |m| m.kind == Kind::Skin);
        let solid: BTreeSet<usize> = (0..n).chain(100 - n..100).collect();
        assert_eq!(skin, solid, "{profile}");
        assert!(infill.is_disjoint(&solid), "{profile}: {infill:?}");
        if profile != "thesis" {
            assert_eq!(infill, (n..100 - n).collect(), "{profile}");
        }
    }
}

#[test]
fn skins_of_their_own_numbers_are_at_the_top_and_at_the_bottom() {
    let set = [("top_layers", "4"), ("bottom_layers", "2")];
    let run = slice(&fixture("cube_20.stl"), "generic-marlin", &set);
    let skin = layers(&run, |m| m.kind == Kind::Skin);
    assert_eq!(skin, (0..2).chain(96..100).collect());
}

/// Covered share of what is from 0.3 to 1 mm inside the edge on layer `k`, and material over space in it all.
fn coverage(run: &Run, solid: &Solid, k: usize) -> (f64, f64) {
    let section = checks::section(&run.print, solid, k);
    let (low, high) = section.extent().unwrap();
    let mut bitmap = Bitmap::new(low, high, 0.05);
    let beads = || run.print.beads().filter(|m| m.layer == Some(k));
    beads().for_each(|m| bitmap.lay(m));
    let (all, covered) = bitmap.covered(|p| {
        let inside = -section.signed_distance(p, 1.1);
        (0.3..=1.0).contains(&inside)
    });
    let laid: f64 = beads().map(|m| m.length() * m.width).sum();
    (covered as f64 / all as f64, laid / section.area())
}

#[test]
fn tops_and_bottoms_are_covered_up_to_the_wall_and_not_overfilled() {
    let tilted = |degrees: f64| {
        let (sin, cos) = degrees.to_radians().sin_cos();
        Solid::cuboid([-9.0, -6.0, 0.0], [9.0, 6.0, 2.0])
            .map(|[x, y, z]| [cos * x - sin * y, sin * x + cos * y, z])
    };
    let mut parts = vec![
        ("a cube", Solid::from_stl(&fixture("cube_20.stl"))),
        ("a disc", Solid::cylinder(8.0, 2.0, 90)),
    ];
    parts.extend([5.0, 17.0, 40.0].map(|degrees| ("a tilted block", tilted(degrees))));
    let mut all = Vec::new();
    for (what, part) in parts {
        for (profile, angle) in
            [("generic-marlin", "45"), ("generic-marlin", "0"), ("zcube-dual", "45")]
        {
            let run = slice(&part.stl(), profile, &[("angle", angle)]);
            let solid = part.on_bed(run.middle());
            let last = run.print.layers.len() - 1;
            for k in [0, 1, last - 1, last] {
                let (covered, laid) = coverage(&run, &solid, k);
                let what = format!("{what}, {profile} at {angle}°, layer {k}");
                assert!(covered >= 0.9965, "{what}: only {covered} is covered");
                assert!((0.97..=1.06).contains(&laid), "{what}: {laid} times its space is laid");
                all.push(covered);
            }
        }
    }
    // Specks where lines turn, a pixel each, are all that is left open.
    let mean = all.iter().sum::<f64>() / all.len() as f64;
    assert!(mean >= 0.999, "only {mean} is covered on the whole");
}

/// The box around the outer walls' middles, from the middle of the bed.
fn wall_box(run: &Run) -> [[f64; 2]; 2] {
    let points: Vec<[f64; 2]> = run
        .print
        .of(Kind::OuterWall)
        .flat_map(|m| [m.a(), m.b()])
        .map(|p| from_middle(run, p))
        .collect();
    [0, 1].map(|axis| {
        let at = || points.iter().map(|p| p[axis]);
        [at().fold(f64::MAX, f64::min), at().fold(f64::MIN, f64::max)]
    })
}

#[test]
fn parts_measure_right_because_the_outer_wall_is_half_a_line_inside() {
    for width in ["0.4", "0.5"] {
        for profile in ["generic-marlin", "zcube-dual"] {
            let run = slice(&fixture("cube_20.stl"), profile, &[("line_width", width)]);
            let half = width.parse::<f64>().unwrap() / 2.0;
            for [low, high] in wall_box(&run) {
                assert!((high + half - 10.0).abs() < 0.01, "{profile} {width}: {high}");
                assert!((low - half + 10.0).abs() < 0.01, "{profile} {width}: {low}");
            }
        }
    }
}

#[test]
fn a_wall_without_inset_lies_on_the_contour() {
    let run = slice(&fixture("cube_20.stl"), "generic-marlin", &[("outer_wall_inset", "0")]);
    for [low, high] in wall_box(&run) {
        assert!((high - 10.0).abs() < 0.002 && (low + 10.0).abs() < 0.002, "{low} {high}");
    }
}

#[test]
fn walls_are_as_many_as_asked_for_and_a_line_apart() {
    for walls in 1..5 {
        let run =
            slice(&fixture("cube_20.stl"), "generic-marlin", &[("walls", &walls.to_string())]);
        let mut rings = BTreeSet::new();
        for m in run.print.beads().filter(|m| matches!(m.kind, Kind::OuterWall | Kind::InnerWall)) {
            let [x, y] = from_middle(&run, m.at(0.5));
            rings.insert((x.abs().max(y.abs()) * 1000.0).round() as i64);
        }
        let expected: BTreeSet<i64> = (0..walls).map(|k| 9800 - 400 * k).collect();
        assert_eq!(rings, expected, "{walls} walls");
    }
}

/// The length of `bead` inside the square around `middle`, from −`half` to `half`, moved by `by`.
fn clipped(bead: &Move, middle: [f64; 2], half: f64, by: f64) -> f64 {
    let (mut from, mut to) = (0.0_f64, 1.0_f64);
    for (axis, middle) in middle.into_iter().enumerate() {
        let (a, b) = (bead.from[axis] - middle - by, bead.to[axis] - middle - by);
        if (b - a).abs() < 1e-9 {
            if a.abs() > half {
                return 0.0;
            }
            continue;
        }
        let (s, t) = ((-half - a) / (b - a), (half - a) / (b - a));
        from = from.max(s.min(t));
        to = to.min(s.max(t));
    }
    (to - from).max(0.0) * bead.length()
}

#[test]
fn infill_has_its_density_in_the_interior() {
    let block = Solid::cuboid([0.0; 3], [110.0, 110.0, 4.0]).stl();
    for pattern in ["rectilinear", "aligned", "grid", "triangles"] {
        for (density, angle) in [("20", "45"), ("20", "0"), ("10", "30"), ("50", "45")] {
            for dual in ["off", "pair"] {
                let set = [
                    ("pattern", pattern),
                    ("infill", density),
                    ("angle", angle),
                    ("dual.mode", dual),
                ];
                let run = slice(&block, "generic-marlin", &set);
                // Layers 4 to 15: whole pairs, and whole turns of the directions.
                let within = |m: &&Move| m.layer.is_some_and(|k| (4..16).contains(&k));
                let volume: f64 = run
                    .print
                    .of(Kind::Infill)
                    .filter(within)
                    .map(|m| clipped(m, run.middle(), 48.0, 0.05) * m.width * m.height)
                    .sum();
                let space = 96.0 * 96.0 * 12.0 * 0.2;
                let is = 100.0 * volume / space / density.parse::<f64>().unwrap();
                assert!(
                    (is - 1.0).abs() < 0.03,
                    "{pattern} {density} % at {angle}°, dual {dual}: {is}"
                );
            }
        }
    }
}

#[test]
fn no_infill_at_zero_percent_and_only_skin_at_a_hundred_layers() {
    let run = slice(&fixture("cube_20.stl"), "generic-marlin", &[("infill", "0"), DUAL]);
    assert_eq!(run.print.of(Kind::Infill).count(), 0);
    let run = slice(&fixture("cube_20.stl"), "generic-marlin", &[("skin_layers", "100"), DUAL]);
    assert_eq!(run.print.of(Kind::Infill).count(), 0);
    assert_eq!(layers(&run, |m| m.kind == Kind::Skin).len(), 100);
}

#[test]
fn support_holds_an_overhang_up_to_its_distance() {
    // The stem of the T is 8 wide, 20 high; its arms reach 11 mm out at both sides.
    for (distance, top) in [("0", 20.0), ("0.2", 19.8), ("0.6", 19.4)] {
        let set = [SUPPORT, ("support.z_distance", distance)];
        let run = slice(&fixture("overhang.stl"), "generic-marlin", &set);
        let heads = &run.print.layers;
        for side in [-1.0, 1.0] {
            let under = |m: &Move| {
                let [x, y] = from_middle(&run, m.at(0.5));
                m.kind.is_support() && (6.0..14.0).contains(&(side * x)) && y.abs() < 8.0
            };
            let found = layers(&run, under);
            let highest = heads[*found.last().unwrap()].z;
            assert!((highest - top).abs() < 1e-6, "{distance}: support ends at {highest}");
            assert_eq!(found.len(), found.last().unwrap() + 1, "{distance}: support has gaps");
        }
    }
}

#[test]
fn support_lines_are_as_far_apart_as_asked_for() {
    let set = [SUPPORT, ("support.spacing", "3"), ("angle", "0")];
    let run = slice(&fixture("overhang.stl"), "generic-marlin", &set);
    let level =
        |m: &&Move| m.layer == Some(20) && (m.to[1] - m.from[1]).abs() < 0.01 && m.length() > 2.0;
    let rows: BTreeSet<i64> = run
        .print
        .of(Kind::Support)
        .filter(level)
        .map(|m| (m.to[1] * 1000.0).round() as i64)
        .collect();
    let rows: Vec<i64> = rows.into_iter().collect();
    // The first and the last row are the outline.
    assert!(rows.len() >= 7, "{rows:?}");
    let rows = &rows[1..rows.len() - 1];
    assert!(rows.windows(2).all(|w| w[1] - w[0] == 3000), "{rows:?}");
}

#[test]
fn support_keeps_its_distance_from_the_part() {
    for name in ["overhang.stl", "bracket.stl", "sphere_20.stl"] {
        // Where the distance is none, joins may cut corners of the part by less than half a line.
        for (distance, least) in [("0", -0.2), ("0.6", 0.55), ("1.5", 1.45)] {
            let set = [SUPPORT, ("support.xy_distance", distance)];
            let run = slice(&fixture(name), "generic-marlin", &set);
            let solid = placed(name, &run);
            // All of it may be dense.
            let support = || run.print.beads().filter(|m| m.kind.is_support());
            assert!(support().count() > 0, "{name}");
            for k in all_layers(&run) {
                let section = checks::section(&run.print, &solid, k);
                for m in support().filter(|m| m.layer == Some(k)) {
                    for t in [0.0, 0.2, 0.5, 0.8, 1.0] {
                        let far = section.signed_distance(m.at(t), 2.0);
                        assert!(far >= least, "{name}: line {} comes as near as {far}", m.line);
                    }
                }
            }
        }
    }
}

#[test]
fn there_is_no_support_unless_asked_for_nor_where_nothing_overhangs() {
    let run = slice(&fixture("overhang.stl"), "generic-marlin", &[]);
    assert_eq!(run.print.of(Kind::Support).count(), 0);
    let run = slice(&fixture("cube_20.stl"), "generic-marlin", &[SUPPORT]);
    assert_eq!(run.print.of(Kind::Support).count(), 0);
    // A cone stands on its foot; on its tip it overhangs at 63° from the bed, which holds.
    let cone = Solid::cone(6.0, 12.0, 60);
    let tip_down = cone.map(|[x, y, z]| [x, -y, 12.0 - z]);
    for part in [cone, tip_down] {
        let run = slice(&part.stl(), "generic-marlin", &[SUPPORT]);
        assert_eq!(run.print.of(Kind::Support).count(), 0);
    }
}

/// A C lying open to the side: a floor of 20 × 12, a back wall, and a roof over the floor's half.
fn shelf() -> Solid {
    let c = vec![
        [0.0, 0.0],
        [20.0, 0.0],
        [20.0, 3.0],
        [4.0, 3.0],
        [4.0, 12.0],
        [28.0, 12.0],
        [28.0, 15.0],
        [0.0, 15.0],
    ];
    Solid::prism(&c, 0.0, 12.0).laid_down()
}

#[test]
fn support_stands_on_the_part_only_where_it_may() {
    let part = shelf();
    assert!((part.volume() - 12.0 * (60.0 + 36.0 + 84.0)).abs() < 1e-6);
    for (base, on_part) in [("everywhere", true), ("bed", false)] {
        let set = [SUPPORT, ("support.stands_on", base)];
        let run = slice(&part.stl(), "generic-marlin", &set);
        // In the machine's x the floor ends 6 mm right of the middle.
        let x = |m: &Move| from_middle(&run, m.at(0.5))[0];
        let over_floor = |m: &&Move| from_middle(&run, m.at(0.5))[1].abs() < 5.5 && x(m) < 6.0;
        let support = || run.print.beads().filter(|m| m.kind.is_support());
        let above_floor = support().filter(over_floor).count();
        let beside = support().filter(|m| x(m) > 7.0).count();
        assert!(beside > 0, "{base}");
        assert_eq!(above_floor > 0, on_part, "{base}");
        if on_part {
            let lowest = support().filter(over_floor).map(|m| m.to[2]);
            let lowest = lowest.fold(f64::MAX, f64::min);
            // Its lowest layer begins the distance above the floor's top.
            assert!((lowest - 0.2 - 3.2).abs() < 1e-6, "support begins below {lowest}");
        }
    }
}

#[test]
fn a_cavity_stays_hollow() {
    for set in [&[][..], &[DUAL]] {
        let run = slice(&fixture("cavity.stl"), "generic-marlin", set);
        let mut walls = 0;
        for m in run.print.beads() {
            let p = from_middle(&run, m.at(0.5));
            let far = p[0].abs().max(p[1].abs());
            let z = m.to[2] - m.height / 2.0;
            // A thick bead begins a layer below its own.
            if (6.0..14.0).contains(&z) {
                assert!(far > 4.0, "line {} prints into the cavity", m.line);
            }
            walls += usize::from(m.kind == Kind::OuterWall && (far - 4.2).abs() < 0.01);
        }
        assert_eq!(walls, 4 * 40, "{set:?}");
        // Floor and roof of the cavity are skins.
        let over = |k: usize| {
            let is_solid = |m: &&Move| matches!(m.kind, Kind::Skin | Kind::Bridge);
            run.print
                .beads()
                .filter(|m| m.layer == Some(k))
                .filter(is_solid)
                .map(|m| clipped(m, run.middle(), 3.0, 0.0))
                .sum::<f64>()
        };
        for k in [27, 28, 29, 70, 71, 72] {
            // The lowest layer of the roof is a bridge, whose lines lie further apart.
            let apart = if k == 70 { 0.4 * run.settings.bridge.spacing } else { 0.4 };
            assert!((over(k) * apart / 36.0 - 1.0).abs() < 0.05, "layer {k}: {}", over(k));
        }
        assert!(over(26) == 0.0 && over(73) == 0.0, "{set:?}");
    }
}

#[test]
fn overlapping_shells_have_no_wall_inside() {
    let run = slice(&fixture("two_shells.stl"), "generic-marlin", &[DUAL]);
    let solid = placed("two_shells.stl", &run);
    let (low, high) = solid.extent();
    // The shells overlap over 10 mm in x and y, from 5 mm on.
    let inside = |p: [f64; 2]| {
        let (x, y) = (p[0] - low[0], p[1] - low[1]);
        (10.0 + 1.0..20.0 - 1.0).contains(&x) && (11.0..19.0).contains(&y)
    };
    assert!((high[0] - low[0] - 25.0).abs() < 1e-6);
    let both = |m: &&Move| (5.2..13.8).contains(&m.to[2]);
    let walls =
        || run.print.beads().filter(|m| matches!(m.kind, Kind::OuterWall | Kind::InnerWall));
    assert!(walls().filter(both).count() > 0);
    for m in walls().filter(both) {
        for t in [0.0, 0.25, 0.5, 0.75, 1.0] {
            assert!(!inside(m.at(t)), "line {} draws a wall inside", m.line);
        }
    }
    // And each layer there has one outline.
    let chains = run.print.chains_of(&WALLS);
    let has_outer = |chain: &Vec<Move>| chain.iter().any(|m| m.kind == Kind::OuterWall);
    let chains = chains.into_iter().filter(has_outer);
    let mut per_layer: BTreeMap<usize, usize> = BTreeMap::new();
    for chain in chains {
        *per_layer.entry(chain[0].layer.unwrap()).or_default() += 1;
    }
    assert!(per_layer.values().all(|&n| n == 1), "{per_layer:?}");
}

#[test]
fn thick_lines_are_on_the_upper_layers_of_pairs_and_twice_as_high() {
    // Without skins only the rule keeps thick lines off the first layers.
    for (name, skins) in FIXTURES.map(|name| [(name, "3"), (name, "0")]).concat() {
        let set = [DUAL, SUPPORT, ("skin_layers", skins)];
        let run = slice(&fixture(name), "generic-marlin", &set);
        let mut thick = 0;
        for m in run.print.beads() {
            let k = m.layer.unwrap();
            let times = m.height / run.print.layers[k].height;
            if (times - 1.0).abs() > 1e-9 {
                assert!(
                    (times - 2.0).abs() < 1e-9,
                    "{name}: line {} is {times} layers high",
                    m.line
                );
                let sparse = [Kind::Infill, Kind::Support].contains(&m.kind);
                assert!(sparse, "{name}: line {}", m.line);
                assert!(k % 2 == 1 && k > 1, "{name}: thick line {} on layer {k}", m.line);
                thick += 1;
            }
        }
        assert!(thick > 0, "{name}");
    }
}

#[test]
fn every_number_of_layers_ends_with_skins_and_leaves_no_layer_hollow() {
    for count in 7..=14_usize {
        let block = Solid::cuboid([0.0; 3], [16.0, 16.0, 0.2 * count as f64]).stl();
        let run = slice(&block, "generic-marlin", &[DUAL, ("skin_layers", "3")]);
        assert_eq!(run.print.layers.len(), count);
        let skin = layers(&run, |m| m.kind == Kind::Skin);
        assert_eq!(skin, (0..3).chain(count - 3..count).collect(), "{count} layers");
        let mut filled = BTreeSet::new();
        for m in run.print.of(Kind::Infill) {
            let k = m.layer.unwrap();
            let begins = if run.print.is_thick(m) { k - 1 } else { k };
            for k in begins..=k {
                assert!((3..count - 3).contains(&k), "{count} layers: infill on skin layer {k}");
                filled.insert(k);
            }
        }
        assert_eq!(filled, (3..count - 3).collect(), "{count} layers");
    }
}

/// The axis (0: x, 1: y) along which the thick lines of each layer run for most of their length.
fn thick_axes(run: &Run) -> Vec<usize> {
    let mut along: BTreeMap<usize, [f64; 2]> = BTreeMap::new();
    for m in run.print.of(Kind::Infill).filter(|m| run.print.is_thick(m)) {
        for axis in 0..2 {
            along.entry(m.layer.unwrap()).or_default()[axis] += (m.to[axis] - m.from[axis]).abs();
        }
    }
    along.values().map(|[x, y]| usize::from(y > x)).collect()
}

#[test]
fn thick_lines_cross_from_pair_to_pair() {
    for name in ["cube_20.stl", "two_shells.stl"] {
        let run = slice(&fixture(name), "generic-marlin", &[DUAL, ("angle", "0")]);
        let axes = thick_axes(&run);
        assert!(axes.len() > 40, "{name}");
        assert!(axes.windows(2).all(|w| w[0] != w[1]), "{name}: {axes:?}");
    }
}

#[test]
fn the_thesis_keeps_the_shorter_direction_every_time() {
    // On a part twice as deep as wide the lines along y are longer by their turns' share alone;
    // what counts is that equal pairs decide alike.
    let block = Solid::cuboid([0.0; 3], [20.3, 10.1, 6.0]).stl();
    let axes = thick_axes(&slice(&block, "thesis", &[]));
    assert!(axes.len() >= 10);
    assert!(axes.windows(2).all(|w| w[0] == w[1]), "{axes:?}");
}

#[test]
fn the_end_pulls_no_more_than_the_start_pushed() {
    for profile in slicer::profile::builtin_names() {
        let run = slice(&fixture("cube_20.stl"), profile, &[]);
        let moves = &run.print.moves;
        let first_bead = moves.iter().position(Move::is_bead).unwrap();
        let last_bead = moves.iter().rposition(Move::is_bead).unwrap();
        let pushed: f64 = moves[..first_bead].iter().map(|m| m.e.max(0.0)).sum();
        let pulls: Vec<f64> =
            moves[last_bead + 1..].iter().filter(|m| m.e < 0.0).map(|m| m.e).collect();
        // A macro primes as it likes, and an Ultimaker 2 retracts by itself.
        if pushed == 0.0 {
            continue;
        }
        let length = run.settings.retraction.length;
        assert!((pulls[0] + length).abs() < 1e-3, "{profile}: pulls {pulls:?} mm at the end");
        let pulled: f64 = pulls[1..].iter().sum();
        assert!(-pulled <= pushed, "{profile}: pushed {pushed}, pulls {pulls:?} mm at the end");
    }
}

#[test]
fn a_fresh_start_of_e_is_read_as_the_same_print() {
    // Absolute, restarting at each layer, and relative E say the same.
    let cube = fixture("bracket.stl");
    let absolute = slice(&cube, "generic-marlin", &[]);
    let relative = slice(&cube, "generic-marlin", &[RELATIVE]);
    let sum = |run: &Run| run.print.beads().map(|m| m.e).sum::<f64>();
    assert!((sum(&absolute) / sum(&relative) - 1.0).abs() < 1e-5);
    assert!((sum(&absolute) / absolute.report.filament.length_mm - 1.0).abs() < 1e-4);
}

#[test]
fn the_raster_of_these_tests_sees_a_gap() {
    // A missing line must not pass for covered.
    let run = slice(&fixture("cube_20.stl"), "generic-marlin", &[]);
    let (low, high) = ([0.0; 2], [2.0; 2]);
    let mut bitmap = Bitmap::new(low, high, 0.05);
    let mut bead = *run.print.beads().next().unwrap();
    (bead.width, bead.height) = (0.4, 0.0);
    for y in [0.2, 0.6, 1.4, 1.8] {
        (bead.from, bead.to) = ([-1.0, y, 0.2], [3.0, y, 0.2]);
        bitmap.lay(&bead);
    }
    let (all, covered) = bitmap.covered(|_| true);
    assert_eq!((all, covered), (1600, 1280));
}
