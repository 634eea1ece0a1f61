//! Good G-code with one fault -> findings of `check`: reports that fault and no other.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common::damage::{Good, errors, judge, kinds, largest, listed, only, without_sums};
use crate::common::{Kind, Move, as_it_is};
use proptest::prelude::*;
use slicer::check::finding::Code;
use slicer::mesh::Placement;
use std::sync::LazyLock;

const DUAL: &[(&str, &str)] = &[("dual.mode", "pair")];

/// Name, profile and settings.
type Way = (&'static str, &'static str, &'static [(&'static str, &'static str)]);

/// How good files are made.
const WAYS: &[Way] = &[
    ("marlin", "generic-marlin", &[]),
    ("klipper", "generic-klipper", &[]),
    ("zcube", "zcube-dual", &[]),
    ("pair", "zcube-dual", DUAL),
    ("interlaced", "generic-marlin", &[("dual.mode", "interlaced"), ("pattern", "grid")]),
    ("support", "generic-marlin", &[("support.enabled", "true"), ("dual.mode", "pair")]),
];

const ALL_PARTS: Way = (
    "all parts",
    "zcube-dual",
    &[
        ("dual.mode", "pair"),
        ("walls", "3"),
        ("dual.parts", "infill,support,inner-walls,inner-skin"),
    ],
);

const PARTS: [&str; 7] = [
    "cube_20.stl",
    "cube_ascii.stl",
    "tile.stl",
    "cavity.stl",
    "two_shells.stl",
    "overhang.stl",
    "sphere_20.stl",
];

static CUBE: LazyLock<Good> = LazyLock::new(|| Good::of("cube_20.stl", "generic-marlin", &[]));
static RELATIVE: LazyLock<Good> = LazyLock::new(|| Good::of("cube_20.stl", "generic-klipper", &[]));
static PAIR: LazyLock<Good> = LazyLock::new(|| Good::of("cube_20.stl", "zcube-dual", DUAL));
static SPHERE: LazyLock<Good> = LazyLock::new(|| Good::of("sphere_20.stl", "zcube-dual", &[]));

/// A layer in the middle of the cube and one at its top, from 0, and their heights, mm.
const MIDDLE: usize = 50;
const TOP: usize = 99;

/// The first line of this kind from a layer on that is longer than 3 mm.
fn long_line(good: &Good, layer: usize, kind: Kind) -> Move {
    let is_it =
        |m: &&Move| m.is_bead() && m.layer >= Some(layer) && m.kind == kind && m.length() > 3.0;
    *good.moves().find(is_it).unwrap()
}

fn is_on(m: &Move, layer: usize, kind: Kind) -> bool {
    m.is_bead() && m.layer == Some(layer) && m.kind == kind
}

/// The file with the filament of the move at `line` times `times`.
fn with_e(good: &Good, line: usize, times: f64) -> String {
    good.with(|m| {
        if m.line == line {
            m.e *= times;
        }
        true
    })
}

fn good_files(stl: &'static str, ways: &[Way]) {
    for &(name, profile, set) in ways {
        let good = Good::of(stl, profile, set);
        let verdict = good.judge(&good.text);
        assert_eq!(kinds(&verdict), [], "{stl} {name}: {}", listed(&verdict));
        let measures = &verdict.measures;
        assert!(measures.outline.unwrap() > 0.995, "{stl} {name}: {measures:?}");
        assert!(measures.surface.unwrap() > 0.97, "{stl} {name}: {measures:?}");
        assert!((0.9..1.1).contains(&measures.solid.unwrap()), "{stl} {name}: {measures:?}");
        if let Some(infill) = measures.infill {
            assert!((0.17..0.25).contains(&infill), "{stl} {name}: {measures:?}");
        }
        assert!(verdict.not_judged.is_empty(), "{stl} {name}: {:?}", verdict.not_judged);
    }
}

#[test]
fn good_cubes_are_clean() {
    PARTS[..2].iter().for_each(|stl| good_files(stl, WAYS));
}

#[test]
fn good_parts_are_clean() {
    PARTS[2..].iter().for_each(|stl| good_files(stl, WAYS));
}

#[test]
fn a_good_bracket_is_clean() {
    good_files("bracket.stl", WAYS);
}

/// Inner walls printed thick lie in the layer below their own, too.
#[test]
fn parts_with_all_printed_thick_are_clean() {
    PARTS.into_iter().chain(["bracket.stl"]).for_each(|stl| good_files(stl, &[ALL_PARTS]));
}

#[test]
fn a_cold_nozzle() {
    for good in [&*CUBE, &RELATIVE, &PAIR] {
        let lines = good.text.lines();
        let text = |left_out: &[&str]| -> String {
            let kept = lines.clone().filter(|line| !left_out.iter().any(|w| line.starts_with(w)));
            kept.map(|line| format!("{line}\n")).collect()
        };
        // GPX's M6 waits; the start block gives it `T1`.
        let verdict = good.judge(&text(&["M104", "M109", "M6 "]));
        let found = only(&verdict, &[Code::ColdExtrusion]);
        assert!(found.text.ends_with("with the nozzle cold"), "{found}");
        // Reported once, for the first line or for the priming before it.
        let first = good.moves().find(|m| m.is_bead()).unwrap().line as u64;
        assert!(found.place.line.unwrap() <= first && errors(&verdict).count() == 1);
        let verdict = good.judge(&text(&["M109", "M6 ", "M116", "M133"]));
        let found = only(&verdict, &[Code::ColdExtrusion]);
        assert!(found.text.contains("before anything waits"), "{found}");
    }
}

#[test]
fn a_line_with_odd_plastic() {
    for good in [&*CUBE, &RELATIVE, &PAIR] {
        for kind in [Kind::OuterWall, Kind::Skin, Kind::Infill] {
            let layer = match kind {
                Kind::Skin => TOP,
                _ => MIDDLE + 1,
            };
            let line = long_line(good, layer, kind);
            for (times, measure) in [(2.0, 2.0), (0.5, 2.0)] {
                let verdict = good.judge(&with_e(good, line.line, times));
                let mut kinds = kinds(&verdict);
                // Some lines go nearly as fast as plastic melts.
                kinds.retain(|code| *code != Code::TooMuchFlow || times < 1.0);
                assert_eq!(kinds, [Code::OddBead], "{}", listed(&verdict));
                let found = largest(&verdict, Code::OddBead);
                assert_eq!(found.place.line, Some(line.line as u64), "{found}");
                assert_eq!(found.place.layer, line.layer.map(|k| k + 1));
                assert!((found.measure - measure).abs() < 0.3, "{kind:?} {times}: {found}");
            }
        }
    }
}

#[test]
fn a_wall_that_is_missing() {
    for good in [&*CUBE, &RELATIVE] {
        let verdict = good.judge(&good.with(|m| !is_on(m, MIDDLE, Kind::OuterWall)));
        let found = only(&verdict, &[Code::OpenOutline]);
        assert_eq!((found.place.layer, found.place.z_mm), (Some(MIDDLE + 1), Some(10.2)));
        // All around, 0.3 mm wide: where the second wall or the infill do not lie.
        let area: f64 = errors(&verdict).map(|finding| finding.measure).sum();
        assert!((15.0..24.5).contains(&area), "{area}");
    }
}

/// The thick infill of a pair lies on its upper layer: below are walls alone, and none without them.
#[test]
fn a_layer_of_walls_that_is_missing() {
    let is_wall = |m: &Move| m.is_bead() && m.kind != Kind::Infill;
    let bare = (MIDDLE..)
        .find(|&k| PAIR.moves().all(|m| m.layer != Some(k) || !m.is_bead() || is_wall(m)));
    let layer = bare.unwrap();
    let verdict = PAIR.judge(&PAIR.with(|m| m.layer != Some(layer) || !m.is_bead()));
    assert_ne!(kinds(&verdict), [], "layer {}", layer + 1);
    let places = errors(&verdict).filter_map(|finding| finding.place.layer);
    assert!(places.into_iter().all(|found| found.abs_diff(layer + 1) <= 1), "{}", listed(&verdict));
}

#[test]
fn a_skin_line_that_is_missing() {
    for good in [&*CUBE, &RELATIVE, &PAIR] {
        for layer in [0, TOP] {
            let line = long_line(good, layer, Kind::Skin);
            let verdict = good.judge(&with_e(good, line.line, 0.0));
            let found = only(&verdict, &[Code::OpenSurface]);
            assert_eq!(found.place.layer, Some(layer + 1));
            let expected = line.length() * line.width;
            assert!((0.5..1.1).contains(&(found.measure / expected)), "{found}");
            let at = found.place.at_mm.unwrap();
            let [low, high] = [0, 1].map(|k| {
                let (a, b) = (line.from[k], line.to[k]);
                (at[k] - a.min(b) > -0.5, a.max(b) - at[k] > -0.5)
            });
            assert_eq!([low, high], [(true, true); 2], "{found}: {line:?}");
        }
    }
}

/// Who asks for no walls gets open sides; tops and bottoms are closed all the same.
#[test]
fn a_part_without_walls_has_no_outline() {
    let bare = Good::of("cube_20.stl", "generic-marlin", &[("walls", "0")]);
    let verdict = bare.judge(&bare.with(|_| true));
    assert!(verdict.findings.is_empty(), "{}", listed(&verdict));
    assert!(verdict.measures.outline.is_none());
    assert!(verdict.not_judged.iter().any(|what| what.contains("no walls")), "{verdict:?}");
    let middle = bare.moves().map(|m| m.to[1]).fold(0.0, f64::max) - 10.0;
    let half = bare.with(|m| !m.is_bead() || m.layer != Some(TOP) || m.to[1] < middle);
    let open = bare.judge(&half);
    assert!(open.findings.iter().any(|finding| finding.code == Code::OpenSurface), "{open:?}");
}

#[test]
fn a_layer_that_is_missing() {
    for good in [&*CUBE, &RELATIVE] {
        for layer in [0, MIDDLE] {
            let verdict = good.judge(&good.with(|m| !m.is_bead() || m.layer != Some(layer)));
            let verdict = without_sums(verdict);
            let found = only(&verdict, &[Code::InTheAir]);
            assert_eq!(found.place.layer, Some(layer + 1), "{found}");
            // Four walls of a loop of 80 mm in all, and more.
            let length: f64 = errors(&verdict).map(|finding| finding.measure).sum();
            assert!(length > 150.0, "{}", listed(&verdict));
        }
    }
}

#[test]
fn infill_that_is_missing_or_thin() {
    for good in [&*CUBE, &RELATIVE, &PAIR] {
        let verdict = good.judge(&good.with(|m| {
            !(40..52).contains(&m.layer.unwrap()) || m.kind != Kind::Infill || !m.is_bead()
        }));
        only(&without_sums(verdict), &[Code::WrongInfill]);
    }
    let thin = PAIR.with(|m| {
        if m.kind == Kind::Infill && PAIR.print.is_thick(m) {
            m.e /= 2.0;
        }
        true
    });
    let verdict = PAIR.judge(&thin);
    // What is thin by right stands out where most lines are.
    only(&verdict, &[Code::OddBead, Code::WrongSums, Code::WrongInfill]);
    let found = largest(&verdict, Code::WrongInfill);
    assert!((9.0..12.0).contains(&found.measure), "{found}");
}

#[test]
fn a_loop_that_is_printed_twice() {
    for good in [&*CUBE, &RELATIVE] {
        let chains = good.print.chains(Kind::OuterWall);
        let wall = chains.iter().find(|chain| chain[0].layer == Some(MIDDLE)).unwrap();
        let [first, last] = [wall[0].line, wall[wall.len() - 1].line];
        let lines: Vec<&str> = good.text.lines().collect();
        let again = lines[first - 1..last].join("\n");
        let e = lines[first - 1].split(" E").nth(1).unwrap().split(' ').next().unwrap();
        let before: f64 = e.parse::<f64>().unwrap() - wall[0].e;
        let set_e =
            if good.text.contains("M83") { String::new() } else { format!("G92 E{before:.5}\n") };
        let [x, y] = wall[0].a();
        let head = lines[..last].join("\n");
        let tail = lines[last..].join("\n");
        let text = format!("{head}\n{set_e}G1 X{x} Y{y}\n{again}\n{tail}\n");
        let verdict = good.judge(&text);
        let found = only(&verdict, &[Code::PrintedTwice]);
        assert_eq!(found.place.layer, Some(MIDDLE + 1));
        let length: f64 = errors(&verdict).map(|finding| finding.measure).sum();
        assert!((70.0..80.0).contains(&length), "{}", listed(&verdict));
    }
}

#[test]
fn a_restore_that_is_missing() {
    for profile in ["generic-marlin", "generic-klipper", "zcube-dual"] {
        let good = Good::of("two_shells.stl", profile, &[]);
        let is_restore = |m: &&Move| m.layer > Some(0) && m.e > 0.0 && m.length() == 0.0;
        let restore = *good.moves().find(is_restore).unwrap();
        let next = good.moves().find(|m| m.line > restore.line && m.is_bead()).unwrap();
        let verdict = good.judge(&good.with(|m| m.line != restore.line));
        let found = only(&verdict, &[Code::UnpairedRetraction]);
        assert!((found.measure - 1.0).abs() < 0.01, "{found}");
        assert_eq!(found.place.layer, restore.layer.map(|k| k + 1), "{found}");
        assert_eq!(found.place.line, Some(next.line as u64), "{found}");
        if profile == "generic-klipper" {
            continue;
        }
        // Where E counts from the start the next line makes up for it, all at once.
        let lines = good.text.lines().enumerate().filter(|(k, _)| k + 1 != restore.line);
        let verdict = good.judge(&lines.map(|(_, text)| format!("{text}\n")).collect::<String>());
        let found = largest(&verdict, Code::UnpairedRetraction);
        assert_eq!(found.place.line, Some(next.line as u64 - 1), "{found}");
        let others = [Code::UnpairedRetraction, Code::OddBead, Code::TooMuchFlow];
        assert!(kinds(&verdict).iter().all(|code| others.contains(code)), "{}", listed(&verdict));
    }
}

#[test]
fn commands_that_the_firmware_does_not_know() {
    for (good, known, unknown) in [
        (&*CUBE, "M105", "G161 Z F100"),
        (&PAIR, "G161 Z F100", "M105"),
        (&RELATIVE, "M105", "M205 X8"),
    ] {
        let at = good.text.lines().position(|line| line == ";LAYER_CHANGE").unwrap() + 1;
        let with =
            |code: &str| good.text.replacen(";LAYER_CHANGE", &format!("{code}\n;LAYER_CHANGE"), 1);
        assert_eq!(kinds(&good.judge(&with(known))), []);
        for code in [unknown, "G777", "!garbage"] {
            let verdict = good.judge(&with(code));
            let found = only(&verdict, &[Code::UnknownCode]);
            assert_eq!(found.place.line, Some(at as u64), "{found}");
            assert!(found.text.contains(code.split(' ').next().unwrap()), "{found}");
        }
    }
}

#[test]
fn a_command_with_too_many_digits() {
    let text = CUBE.text.replacen(";LAYER_CHANGE", "G12345678901\n;LAYER_CHANGE", 1);
    only(&CUBE.judge(&text), &[Code::UnknownCode]);
}

#[test]
fn a_layer_that_is_shifted() {
    for good in [&*CUBE, &RELATIVE, &PAIR] {
        let verdict = good.judge(&good.with(|m| {
            if m.layer == Some(MIDDLE) {
                m.to[0] += 5.0;
            }
            true
        }));
        only(&verdict, &[Code::OpenOutline, Code::OutsidePart]);
        for code in [Code::OpenOutline, Code::OutsidePart] {
            assert_eq!(largest(&verdict, code).place.layer, Some(MIDDLE + 1));
        }
        // Walls and infill, 5 mm beside 20 mm, less what is let pass.
        let out = largest(&verdict, Code::OutsidePart).measure;
        assert!((10.0..94.5).contains(&out), "{out}");
    }
}

#[test]
fn a_print_that_is_stretched() {
    let stretched = CUBE.with(|m| {
        m.to[0] *= 1.05;
        true
    });
    let verdict = CUBE.judge(&stretched);
    let found = only(&verdict, &[Code::WrongSize]);
    assert!((found.measure - 1.0).abs() < 0.1 && found.text.contains("larger in x"), "{found}");
}

#[test]
fn a_print_of_another_part() {
    let larger = Placement { scale: 1.1, ..as_it_is() };
    let verdict = judge(&CUBE.text, "cube_20.stl", &larger);
    let found = only(&verdict, &[Code::WrongSize]);
    assert!((found.measure - 2.0).abs() < 0.1 && errors(&verdict).count() == 2, "{found}");
    let turned = Placement { rotate: [0.0, 0.0, 30.0], ..as_it_is() };
    only(&judge(&CUBE.text, "cube_20.stl", &turned), &[Code::WrongSize]);
    only(&judge(&CUBE.text, "sphere_20.stl", &as_it_is()), &[Code::WrongSize]);
    only(&judge(&SPHERE.text, "cube_20.stl", &as_it_is()), &[Code::WrongSize]);
}

#[test]
fn a_print_elsewhere_on_the_bed_is_clean() {
    for good in [&*CUBE, &PAIR, &SPHERE] {
        // Not so far that what primes and parks would leave the machine.
        let verdict = good.judge(&good.with(|m| {
            m.to[0] += 13.0;
            m.to[1] -= 2.5;
            true
        }));
        assert_eq!(kinds(&verdict), [], "{}", listed(&verdict));
        assert_eq!(verdict.not_judged.len(), 1, "{:?}", verdict.not_judged);
        assert!(verdict.not_judged[0].starts_with("where on the bed"), "{:?}", verdict.not_judged);
    }
}

#[test]
fn a_move_beyond_the_bed() {
    for (good, x, out) in [(&*CUBE, 400.0, 100.0), (&PAIR, -150.0, 37.5)] {
        let travel = good.moves().find(|m| m.layer == Some(MIDDLE) && m.is_travel()).unwrap().line;
        let verdict = good.judge(&good.with(|m| {
            if m.line == travel {
                m.to[0] = x;
            }
            true
        }));
        let kinds = kinds(&verdict);
        assert_eq!(kinds[0], Code::OutsideVolume);
        let found = errors(&verdict).next().unwrap();
        assert_eq!(found.place.line, Some(travel as u64), "{found}");
        assert!((found.measure - out).abs() < 20.0, "{found}");
    }
}

#[test]
fn moves_that_are_too_fast() {
    for good in [&*CUBE, &RELATIVE, &PAIR] {
        let line = long_line(good, MIDDLE, Kind::Infill);
        let fast = |feed: f64| {
            good.judge(&good.with(|m| {
                if m.line == line.line {
                    m.feed = feed;
                }
                true
            }))
        };
        let verdict = fast(12_000_000.0);
        let found = only(&verdict, &[Code::TooFast]);
        assert_eq!(found.place.line, Some(line.line as u64));
        // 200 m/s along the line, of which an axis takes at least the root of a half.
        assert!((141_000.0..200_001.0).contains(&found.measure), "{found}");
        let verdict = fast(17_900.0);
        let found = only(&verdict, &[Code::TooMuchFlow]);
        assert_eq!(found.place.line, Some(line.line as u64));
        let flow = line.e * 2.405 / line.length() * 17_900.0 / 60.0;
        assert!((found.measure - flow).abs() < 0.02 * flow, "{found}: {flow}");
    }
}

#[test]
fn a_layer_that_lies_lower() {
    for good in [&*CUBE, &RELATIVE] {
        let verdict = good.judge(&good.with(|m| {
            if m.layer == Some(MIDDLE) && m.to[2] > 10.0 {
                m.to[2] -= 0.4;
            }
            true
        }));
        let found = largest(&verdict, Code::FallingZ);
        assert_eq!(found.place.layer, Some(MIDDLE + 1));
        assert!((found.measure - 0.2).abs() < 0.01, "{found}");
        assert!(
            verdict.not_judged[0].starts_with("the part: layer 51"),
            "{:?}",
            verdict.not_judged
        );
        // What it lies in is printed already, travels go through it, and the next layer has nothing below.
        // The move up again has the feed of a travel.
        let mut kinds = kinds(&verdict);
        kinds.retain(|kind| *kind != Code::TooFast);
        assert_eq!(
            kinds,
            [Code::ThroughPrint, Code::FallingZ, Code::InTheAir],
            "{}",
            listed(&verdict)
        );
        assert_eq!(largest(&verdict, Code::InTheAir).place.layer, Some(MIDDLE + 2));
    }
}

#[test]
fn sums_that_are_wrong() {
    let comment = |key: &str| {
        let line = CUBE.text.lines().find(|line| line.starts_with(key)).unwrap();
        (line, line.rsplit(' ').next().unwrap().parse::<f64>().unwrap())
    };
    let (line, used) = comment("; filament used [mm]");
    let verdict =
        CUBE.judge(&CUBE.text.replace(line, &format!("; filament used [mm] = {}", used + 80.0)));
    let found = only(&verdict, &[Code::WrongSums]);
    assert!((found.measure - 80.0).abs() < 0.5, "{found}");
    let (line, _) = comment("; total layers count");
    let verdict = CUBE.judge(&CUBE.text.replace(line, "; total layers count = 101"));
    let found = only(&verdict, &[Code::WrongSums]);
    assert_eq!((found.measure, found.unit), (1.0, "layers"));
}

#[test]
fn walls_and_skins_that_are_too_fat() {
    for (times, kinds) in
        [(1.5, [Kind::OuterWall, Kind::InnerWall]), (1.4, [Kind::Skin, Kind::OuterWall])]
    {
        let fat = CUBE.with(|m| {
            if kinds.contains(&m.kind) {
                m.e *= times;
            }
            true
        });
        let verdict = without_sums(CUBE.judge(&fat));
        let found = only(&verdict, &[Code::WrongVolume]);
        assert!((125.0..152.0).contains(&found.measure), "{found}");
    }
}

/// Lines on the surface: outer walls on every layer, inner walls and skins on the lowest and the highest
/// layer. Inner walls and skins between are hidden, and `check` does not report them.
static VISIBLE: LazyLock<Vec<Move>> = LazyLock::new(|| {
    let is_visible = |m: &&Move| {
        m.is_bead()
            && m.length() > 3.0
            && (m.kind == Kind::OuterWall
                || [Some(0), Some(TOP)].contains(&m.layer)
                    && matches!(m.kind, Kind::InnerWall | Kind::Skin))
    };
    CUBE.moves().filter(is_visible).copied().collect()
});

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(16) })]

    #[test]
    fn every_missing_line_on_the_surface_is_reported(pick in any::<prop::sample::Index>()) {
        let line = pick.get(&VISIBLE);
        let verdict = CUBE.judge(&with_e(&CUBE, line.line, 0.0));
        let code = if line.kind == Kind::OuterWall { Code::OpenOutline } else { Code::OpenSurface };
        prop_assert!(kinds(&verdict).contains(&code), "{line:?}: {}", listed(&verdict));
        prop_assert_eq!(largest(&verdict, code).place.layer, line.layer.map(|k| k + 1));
    }
}
