//! Skins over a slope -> layers, patches and times as they are, findings of what is wrong, and differences.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common::damage::{kinds, largest, listed};
use crate::common::slope::{self, CORNER, Change, Form, LAYER, LAYERS, SAME};
use slicer::check::finding::Code;
use slicer::check::terms::Terms;
use slicer::check::{self, Model, Verdict};
use slicer::profile;
use slicer::reader::{Print, Role};

fn read(text: &str) -> Print {
    Print::read(&mut text.as_bytes(), 1.75).unwrap()
}

fn good(form: Form, joined: bool) -> String {
    slope::file(form, joined, |_| SAME)
}

fn judge(text: &str, against: Option<bool>) -> Verdict {
    let print = read(text);
    let settings = profile::load(["generic-marlin"], &[]).unwrap().settings;
    let terms = Terms::new(Some(&settings), None, &print);
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
        assert_eq!((own.clone().count(), lines(Role::NonPlanar)), (own.count(), lines(Role::NonPlanar)));
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
