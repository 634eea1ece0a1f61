//! Skins over a slope -> layers, patches and times as they are, findings of what is wrong, and differences.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common::damage::{kinds, largest, listed};
use crate::common::slope::{self, CORNER, Change, Form, LAYER, LAYERS, SAME, SIDES};
use slicer::check::finding::Code;
use slicer::check::terms::Terms;
use slicer::check::{self, Model, Verdict};
use slicer::diff::{self, File, Finding, Side, Tolerances};
use slicer::estimate::{self, Estimate, Options};
use slicer::head::named::named;
use slicer::motion::{Junction, Limits};
use slicer::profile::{self, Settings};
use slicer::reader::{Print, Role};

fn read(text: &str) -> Print {
    Print::read(&mut text.as_bytes(), 1.75).unwrap()
}

fn settings() -> Settings {
    let mut settings = profile::load(["generic-marlin"], &[]).unwrap().settings;
    settings.limits.speed_z = 5.0;
    settings
}

fn good(form: Form, joined: bool) -> String {
    slope::file(form, joined, |_| SAME)
}

/// What is found in a file, by a machine that lifts 5 mm/s; with `against` the tower, or without.
fn judge(text: &str, against: Option<bool>) -> Verdict {
    judge_by("long-0.6", text, against)
}

/// As [`judge`], by the head of this name, or none.
fn judge_by(head: &str, text: &str, against: Option<bool>) -> Verdict {
    let print = read(text);
    let settings = settings();
    let mut terms = Terms::new(Some(&settings), None, &print);
    terms.head = named(head);
    let mesh = slope::mesh(against == Some(true));
    check::check(&print, &terms, against.map(|_| Model { mesh: &mesh, offset: CORNER }))
}

#[test]
fn a_patch_is_a_thing_of_its_own_in_its_layer() {
    for joined in [true, false] {
        let print = read(&good(Form::Marked, joined));
        assert_eq!(print.layers.len(), LAYERS);
        for (k, layer) in print.layers.iter().enumerate() {
            let z = LAYER * (k + 1) as f64;
            assert!((layer.z - z).abs() < 1e-5 && (layer.height - LAYER).abs() < 1e-5, "{layer:?}");
        }
        assert_eq!(print.patches.len(), 1);
        let patch = &print.patches[0];
        assert_eq!(patch.number, 1);
        let home = print.layers.iter().position(|layer| layer.moves.contains(&patch.moves.start));
        assert_eq!(home, Some(slope::base() - 1));
        let lines = |role| print.lines().filter(|step| step.role == role).count();
        let own = print.moves[patch.moves.clone()].iter().filter(|step| step.is_line());
        assert_eq!(
            (own.clone().count(), lines(Role::NonPlanar)),
            (own.count(), lines(Role::NonPlanar))
        );
        let line = print.lines().find(|step| step.role == Role::NonPlanar).unwrap();
        assert_eq!(print.patch_at(u64::from(line.line)).map(|patch| patch.number), Some(1));
        assert_eq!(print.patch_at(u64::from(print.moves[0].line)), None);
        assert!(line.heights()[1] - line.heights()[0] > 3.0, "{line:?}");
    }
}

#[test]
fn without_marks_the_lines_across_a_slope_begin_no_layer() {
    for joined in [true, false] {
        let text = good(Form::Bare, joined);
        let print = read(&text);
        for (k, layer) in print.layers.iter().enumerate() {
            let z = LAYER * (k + 1) as f64;
            assert!((layer.z - z).abs() < 1e-5, "{k} {layer:?}");
        }
        assert_eq!(print.layers.len(), slope::base(), "{joined}");
    }
}

#[test]
fn good_files_have_no_findings() {
    for (form, joined) in [
        (Form::Marked, true),
        (Form::Marked, false),
        (Form::Bare, true),
        (Form::Bare, false),
        (Form::Contoured, true),
    ] {
        for against in [None, Some(form != Form::Bare)] {
            let verdict = judge(&good(form, joined), against);
            assert_eq!(kinds(&verdict), [], "{form:?} {joined} {against:?} {}", listed(&verdict));
            println!("{form:?} {:?} {:?}", verdict.not_judged, verdict.measures);
        }
    }
}

#[test]
fn a_lifted_line_is_found() {
    let lift = |k| if k == 40 { Change { lift: 1.0, ..SAME } } else { SAME };
    for (form, joined) in [(Form::Marked, true), (Form::Marked, false), (Form::Bare, false)] {
        let verdict = judge(&slope::file(form, joined, lift), None);
        let found = largest(&verdict, Code::InTheAir);
        assert!(found.measure > 5.0, "{found}");
    }
}

#[test]
fn twice_the_flow_is_found() {
    for (form, all) in [(Form::Marked, true), (Form::Marked, false)] {
        let more = |k| if all || k == 40 { Change { flow: 2.0, ..SAME } } else { SAME };
        let verdict = judge(&slope::file(form, true, more), None);
        let code = if all { Code::Overfilled } else { Code::OddBead };
        assert!((largest(&verdict, code).measure - if all { 200.0 } else { 2.0 }).abs() < 1.0);
    }
}

#[test]
fn lines_that_rise_faster_than_the_machine_are_found() {
    // 17.4 % of the way is in z.
    let fast = |k| if k == 3 { Change { feed: 4.0, ..SAME } } else { SAME };
    for form in [Form::Marked, Form::Bare] {
        let verdict = judge(&slope::file(form, false, fast), None);
        let found = largest(&verdict, Code::TooFast);
        assert!((found.measure - 80.0 * 0.17365).abs() < 0.1, "{found}");
        assert!(found.text.contains("in z"), "{found}");
    }
}

#[test]
fn a_lowered_line_falls_into_the_skin_below() {
    for joined in [true, false] {
        let low = |k| if k == 60 { Change { lift: -0.6, ..SAME } } else { SAME };
        let verdict = judge(&slope::file(Form::Marked, joined, low), None);
        let found = largest(&verdict, Code::FallingZ);
        assert!((found.measure - 0.4).abs() < 0.1, "{found}");
    }
}

#[test]
fn a_head_that_is_too_flat_hits_the_slope() {
    for (form, joined) in [(Form::Marked, true), (Form::Bare, false)] {
        // Its disc allows 4.3 degrees, the slope has 10.
        let verdict = judge_by("cautious", &good(form, joined), None);
        let found = largest(&verdict, Code::HeadHits);
        assert!(found.text.contains("disc 1"), "{found}");
        // From the lower end it reaches the upper one, or the tower.
        let most = slope::height(SIDES[0]) - slope::height(0.0) - 3.0;
        assert!(found.measure > 0.5 * most && found.measure < most + 0.1, "{found} {most}");
        assert_eq!(kinds(&verdict), [Code::HeadHits], "{}", listed(&verdict));
        let verdict = judge_by("nobody's", &good(form, joined), None);
        assert_eq!(kinds(&verdict), [], "{}", listed(&verdict));
        let is_told = |note: &String| note.starts_with("what the head touches");
        assert!(verdict.not_judged.iter().any(is_told), "{:?}", verdict.not_judged);
    }
    let verdict = judge_by("nobody's", &good(Form::Contoured, true), None);
    assert!(!verdict.not_judged.iter().any(|note| note.contains("head")), "no slope is crossed");
}

#[test]
fn a_travel_through_the_slope_hits_it() {
    let z = 0.4 * slope::height(SIDES[0]);
    let (x, y) = (CORNER[0] + SIDES[0] - 4.0, CORNER[1] + 5.1);
    let travel = format!("G1 Z20 F600\nG1 X{x} Y60 F6000\nG1 Z{z:.3}\nG1 Y{y}\nG1 Z20 F600\n");
    for form in [Form::Marked, Form::Bare] {
        let text = good(form, true);
        let text = match form {
            Form::Marked => text.replace(";NONPLANAR_END\n", &format!(";NONPLANAR_END\n{travel}")),
            _ => text + &travel,
        };
        let found = judge(&text, None);
        let found = largest(&found, Code::HeadHits);
        // By the flat's uphill edge, half a mm further.
        let deep = slope::height(SIDES[0] - 3.5) - z;
        assert!((found.measure - deep).abs() < 0.1, "{found} {deep}");
        assert!(found.text.contains("travel") && found.place.at_mm.is_some(), "{found}");
    }
}

#[test]
fn missing_lines_leave_a_skin_open() {
    let [along, _] = slope::lines();
    let all =
        [(Form::Marked, true), (Form::Marked, false), (Form::Bare, true), (Form::Bare, false)];
    for (form, joined) in all {
        // Of the last skin one, and five; of the first five.
        for (from, count, area) in [(along + 20, 1, 4.0), (along + 20, 5, 20.0), (10, 5, 40.0)] {
            let change = |k| match k {
                k if (from..from + count).contains(&k) => Change { left_out: true, ..SAME },
                _ => SAME,
            };
            let verdict = judge(&slope::file(form, joined, change), None);
            let found = largest(&verdict, Code::UncoveredSkin);
            // Squares that are judged are 1 mm wide and more.
            let bounds = if from < along { 0.5 * area..1.2 * area } else { 0.8 * area..1.1 * area };
            assert!(bounds.contains(&found.measure), "{form:?} {joined} {found} {area}");
        }
    }
}

#[test]
fn missing_lines_of_both_skins_show_the_base() {
    let [along, _] = slope::lines();
    // All of the first, and six of the last.
    let change = |k| match k {
        k if k < along || (along + 20..along + 26).contains(&k) => {
            Change { left_out: true, ..SAME }
        }
        _ => SAME,
    };
    let verdict = judge(&slope::file(Form::Marked, false, change), None);
    let open = verdict.findings.iter().find(|found| found.text.contains("not covered")).unwrap();
    assert_eq!(open.code, Code::UncoveredSkin);
    assert!((15.0..25.0).contains(&open.measure), "{open}");
}

#[test]
fn twice_the_flow_fills_a_skin_twice() {
    for form in [Form::Marked, Form::Bare] {
        for (from, times) in [(0, 2.0), (25, 1.5)] {
            let change = |k| if k >= from { Change { flow: 2.0, ..SAME } } else { SAME };
            let verdict = judge(&slope::file(form, true, change), None);
            let found = largest(&verdict, Code::DoubleSkin);
            // All of the slope's 200 mm², but for the ends of lines.
            assert!(found.measure > 150.0 && found.measure < 215.0, "{found}");
            let percent = found.text.split("take ").nth(1).unwrap().split(' ').next().unwrap();
            let percent: f64 = percent.parse().unwrap();
            assert!((percent - 100.0 * times).abs() < 25.0, "{found}");
        }
        let once = |k| if k == 40 { Change { flow: 2.0, ..SAME } } else { SAME };
        let verdict = judge(&slope::file(form, true, once), None);
        assert!(!kinds(&verdict).contains(&Code::HeadHits), "{}", listed(&verdict));
    }
}

fn times(text: &str, limits: &Limits) -> Estimate {
    let options = Options { filament_diameter: 1.75, ..Options::default() };
    estimate::estimate(&mut text.as_bytes(), "slope", limits, options).unwrap()
}

/// What makes two files unequal.
fn differences(a: &str, b: &str) -> Vec<Finding> {
    let side = |text: &str| {
        Side::of_bytes(text.as_bytes(), times(text, &Limits::new(&settings()))).unwrap()
    };
    let found = diff::diff(&side(a), &side(b), &Tolerances::default()).unwrap();
    assert_eq!(found.equal, found.findings.is_empty());
    assert_eq!(found.pairs.len(), LAYERS + 1);
    found.findings
}

#[test]
fn patches_are_compared_as_patches() {
    for joined in [true, false] {
        let good = good(Form::Marked, joined);
        assert_eq!(differences(&good, &good), []);
        // Another number makes no other patch.
        let other = good.replace("NONPLANAR_START 1", "NONPLANAR_START 7");
        assert_eq!(differences(&good, &other), []);
        let lifted = slope::file(Form::Marked, joined, |_| Change { lift: 0.1, ..SAME });
        let found = differences(&good, &lifted);
        let Finding::Lines { layer, role, patch, farthest, .. } = &found[0] else {
            panic!("{found:?}");
        };
        assert_eq!((layer.a, *role), (slope::base(), Role::NonPlanar));
        assert_eq!(patch.map(|patch| (patch.a, patch.b)), Some((Some(1), Some(1))));
        assert!((farthest.distance_mm - 0.1).abs() < 0.01, "{farthest:?}");
        let missing =
            |k| if (40..45).contains(&k) { Change { left_out: true, ..SAME } } else { SAME };
        let found = differences(&good, &slope::file(Form::Marked, joined, missing));
        let Finding::Lines { patch, far_mm, .. } = &found[0] else { panic!("{found:?}") };
        assert_eq!(patch.map(|patch| patch.a), Some(Some(1)));
        // Lines of 9.6 mm and what joins them, less what lies near the lines across.
        assert!((40.0..52.0).contains(&far_mm.a), "{far_mm:?}");
        let without = slope::file(Form::Marked, joined, |_| Change { left_out: true, ..SAME });
        let found = differences(&good, &without);
        let is_named = |one: &Finding| {
            matches!(one, Finding::RoleOnlyIn { file: File::A, role: Role::NonPlanar, patches, .. }
                if *patches == [1])
        };
        assert!(found.iter().any(is_named), "{found:?}");
    }
}

/// A machine that takes corners as it comes, but lifts 5 mm/s at most.
fn quick() -> Limits {
    let limits = Limits::new(&settings());
    Limits {
        feed: [500.0, 500.0, 5.0, 100.0],
        acceleration: [1e6; 4],
        print_acceleration: 1e6,
        junction: Junction::Jerk([100.0; 4]),
        ..limits
    }
}

#[test]
fn times_are_those_of_ways_in_space() {
    // 30 mm aside and 40 mm up: at 5 mm/s up 8 s, whatever the feed; at 4 mm/s along the way 12.5 s.
    for (feed, seconds) in [(3000.0, 8.0), (240.0, 12.5)] {
        let text = format!("M83\nG1 X30 Z40 E1 F{feed}\n");
        let found = times(&text, &quick());
        assert!((found.seconds - seconds).abs() < 0.01 * seconds, "{found:?}");
    }
    // From rest to 5 mm/s along the way and to rest again, of which 4 in z, gained at 10 mm/s²: 12.5 along.
    let slow = Limits {
        acceleration: [1e6, 1e6, 10.0, 1e6],
        junction: Junction::Jerk([0.0; 4]),
        minimum_speed: 0.0,
        ..quick()
    };
    let found = times("M83\nG1 X30 Z40 E1 F300\n", &slow);
    let seconds = 50.0 / 5.0 + 5.0 / 12.5;
    assert!((found.seconds - seconds).abs() < 0.01 * seconds, "{found:?}");
    let found = times(&good(Form::Marked, true), &quick());
    let skin = found.roles.iter().find(|role| role.role == Role::NonPlanar).unwrap();
    // 25 lines along of 19.6 mm from above, 50 across of 9.6, and what joins them, at 20 mm/s.
    let slope = 1.0 / 10.0_f64.to_radians().cos();
    let length = 25.0 * 19.6 * slope + 24.0 * 0.4 + 50.0 * 9.6 + 49.0 * 0.4 * slope;
    assert!((skin.length_mm - length).abs() < 0.1, "{skin:?} {length}");
    assert!((skin.seconds - length / 20.0).abs() < 0.01 * skin.seconds, "{skin:?}");
    assert_eq!(found.layers.len(), LAYERS);
    let home = found.layers[slope::base() - 1];
    assert!((home.z_mm - LAYER * slope::base() as f64).abs() < 1e-9 && home.seconds > skin.seconds);
}
