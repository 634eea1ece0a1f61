//! Good G-code + a change of its moves -> G-code with that fault, and what `check` finds in it.

use super::{Kind, Move, Print, as_it_is, fixtures, slice_placed};
use slicer::check::finding::{Code, Finding, Severity};
use slicer::check::terms::Terms;
use slicer::check::{self, Model, Verdict};
use slicer::mesh::Placement;
use slicer::profile;
use slicer::reader;

/// The sliced fixture.
pub(crate) struct Good {
    pub(crate) text: String,
    pub(crate) print: Print,
    pub(crate) stl: &'static str,
}

impl Good {
    pub(crate) fn of(stl: &'static str, profile: &str, set: &[(&str, &str)]) -> Self {
        let run = slice_placed(&super::fixture(stl), profile, set, &as_it_is());
        Self { text: run.text, print: run.print, stl }
    }

    /// What `check` finds in `text`, a changed copy of this one's.
    pub(crate) fn judge(&self, text: &str) -> Verdict {
        judge(text, self.stl, &as_it_is())
    }

    /// The moves of layers, without the start and end blocks.
    pub(crate) fn moves(&self) -> impl Iterator<Item = &Move> {
        self.print.moves.iter().filter(|m| m.layer.is_some() && m.kind != Kind::Custom)
    }

    /// The file with changed moves. `change` alters a move, or returns `false` to remove it. Nothing
    /// else changes: if E is absolute, `G92` sets it to its old value after each changed move.
    pub(crate) fn with(&self, change: impl Fn(&mut Move) -> bool) -> String {
        let relative = self.text.lines().any(|line| line == "M83");
        let mut lines: Vec<String> = self.text.lines().map(str::to_owned).collect();
        // Words stay in force until the next: the move after a change is written in full.
        let mut in_full = false;
        for old in self.print.moves.iter() {
            let mut new = *old;
            let stays = old.layer.is_none() || change(&mut new);
            let line = &mut lines[old.line - 1];
            let after = word(line, 'E').filter(|_| !relative);
            let set_e = after.map_or(String::new(), |e| format!("\nG92 E{e}"));
            if !stays {
                *line = set_e.trim_start().to_owned();
                in_full = true;
            } else if in_full || new != *old {
                let [x, y, z] = new.to;
                let at = format!("G1 X{x:.3} Y{y:.3} Z{z:.3} F{:.3}", new.feed);
                let before = after.map_or(0.0, |e| e - old.e);
                let e =
                    if new.e == 0.0 { String::new() } else { format!(" E{:.5}", before + new.e) };
                *line = at + &e + if new.e == old.e { "" } else { &set_e };
                in_full = new != *old;
            }
        }
        lines.join("\n") + "\n"
    }
}

fn word(line: &str, letter: char) -> Option<f64> {
    let code = line.split(';').next()?;
    code.split_whitespace().skip(1).find_map(|word| word.strip_prefix(letter)?.parse().ok())
}

/// What `check` finds in `text`, against a fixture placed like this, by the file's own settings.
pub(crate) fn judge(text: &str, stl: &str, placement: &Placement) -> Verdict {
    by_its_own(text, file(stl), placement)
}

/// As [`judge`], against the bytes of a model that is left as it is.
pub(crate) fn judge_made(text: &str, stl: &[u8]) -> Verdict {
    by_its_own(text, slicer::Model::bytes("made.stl", stl.to_vec()), &as_it_is())
}

fn by_its_own(text: &str, model: slicer::Model, placement: &Placement) -> Verdict {
    let print = reader::Print::read(&mut text.as_bytes(), 1.75).unwrap();
    let recorded = profile::recorded(&print.values).unwrap();
    let settings = &recorded.unwrap().settings;
    against(&print, (settings, Some(settings)), model, placement)
}

/// As [`judge`], of a file that tells nothing of its settings, by a profile.
pub(crate) fn judge_bare(text: &str, profile: &str, stl: &str) -> Verdict {
    let print = reader::Print::read(&mut text.as_bytes(), 1.75).unwrap();
    let settings = profile::load([profile], &[]).unwrap().settings;
    against(&print, (&settings, None), file(stl), &as_it_is())
}

fn file(stl: &str) -> slicer::Model {
    slicer::Model::path(fixtures().join(stl).to_str().unwrap().to_owned())
}

fn against(
    print: &reader::Print,
    (settings, own): (&profile::Settings, Option<&profile::Settings>),
    model: slicer::Model,
    placement: &Placement,
) -> Verdict {
    let terms = Terms::new(Some(settings), own, print);
    let bed = slicer::bed(&settings.machine);
    let placed = slicer::place(&[model], placement, &bed, &Default::default()).unwrap();
    check::check(print, &terms, Some(Model { mesh: &placed.mesh, offset: placed.offset }))
}

/// The kinds of errors, in their order.
pub(crate) fn kinds(verdict: &Verdict) -> Vec<Code> {
    let errors = verdict.counts.iter().filter(|count| count.errors > 0);
    errors.map(|count| count.code).collect()
}

/// The errors.
pub(crate) fn errors(verdict: &Verdict) -> impl Iterator<Item = &Finding> {
    verdict.findings.iter().filter(|finding| finding.severity == Severity::Error)
}

/// The kinds of warnings, in their order.
pub(crate) fn warned(verdict: &Verdict) -> Vec<Code> {
    let warnings = verdict.counts.iter().filter(|count| count.errors < count.count);
    warnings.map(|count| count.code).collect()
}

/// The largest finding of a kind.
pub(crate) fn largest(verdict: &Verdict, code: Code) -> &Finding {
    verdict.findings.iter().find(|finding| finding.code == code).unwrap()
}

/// Asserts that exactly these kinds of errors are found. Returns the largest finding of the first.
#[track_caller]
pub(crate) fn only<'v>(verdict: &'v Verdict, codes: &[Code]) -> &'v Finding {
    assert_eq!(kinds(verdict), codes, "{}", listed(verdict));
    largest(verdict, codes[0])
}

/// The findings without wrong sums, which follow from many faults.
pub(crate) fn without_sums(mut verdict: Verdict) -> Verdict {
    verdict.findings.retain(|finding| finding.code != Code::WrongSums);
    verdict.counts.retain(|count| count.code != Code::WrongSums);
    verdict
}

/// The first findings, one a line.
pub(crate) fn listed(verdict: &Verdict) -> String {
    let some = verdict.findings.iter().take(9);
    some.map(|finding| format!("{finding}\n")).collect()
}
