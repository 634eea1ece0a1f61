//! Sound files with one fault each -> how many of them `check` and `diff` see.
//!
//! Each kind of [`edits::kinds`] is tried at a few places of each sound file; `HOSTILE_CASES` makes them
//! more. Every edit that changes the print or the way of the nozzle has to be seen: by `check` as a
//! finding that the sound file has not, or by `diff` against it. The few kinds of which some are not
//! seen stand in [`UNSEEN`], with the reason. Those that `check` without the model sees are
//! not asked with it.
//!
//! The table in `tests/README.md` is written by
//!
//! ```sh
//! UPDATE_WITNESS=1 HOSTILE_CASES=1000 cargo test --release --test hostile witness
//! ```
//!
//! `WITNESS_ONLY=bridge` tries the kinds with that word alone; `WITNESS_KEEP=folder` writes what
//! `check` did not see there, to look at.

use super::common;
use super::edits::{self, What};
use super::slopes;
use super::sound::{Chance, Sound};
use rayon::prelude::*;
use slicer::check::terms::Terms;
use slicer::check::{self, Model, Verdict};
use slicer::diff::{Side, Tolerances, diff};
use slicer::estimate::{self, estimate};
use slicer::mesh::Placement;
use slicer::mesh::place::Placed;
use slicer::motion::Limits;
use slicer::profile::{self, Settings};
use slicer::reader::Print;
use std::fmt::Write as _;
use std::sync::OnceLock;

/// Edits of a kind, if nothing else is said.
const CASES: usize = 2;

/// Edits that are tried for one that counts.
const TRIES: usize = 8;

/// Least share that has to be seen where there are many cases.
const LEAST: f64 = 0.99;

/// Kinds of which less is seen, how much at least, and why.
const UNSEEN: &[(&str, f64, &str)] = &[(
    "a move in z at F60000",
    0.85,
    "on a line of 0.2 mm of a slope the printer never gets as fast as it is asked to be",
)];

/// A fixture, how deep it is sunk (mm), and settings.
type Job = (&'static str, f64, &'static [(&'static str, &'static str)]);

/// The sound files: fixture, profile, how deep it is sunk (mm), settings. The parts are cut low so
/// that a case is quick.
const FILES_OF: [Job; 5] = [
    ("cube_20.stl", 14.0, &[("machine.thumbnails", "[]")]),
    (
        "cube_20.stl",
        14.0,
        &[
            ("machine.thumbnails", "[]"),
            ("dual.mode", "pair"),
            ("machine.relative_e", "true"),
            ("brim.where", "outside"),
        ],
    ),
    (
        "overhang.stl",
        0.0,
        &[("machine.thumbnails", "[]"), ("support.enabled", "true"), ("layer_height", "0.35")],
    ),
    (
        "sphere_20.stl",
        16.0,
        &[
            ("machine.thumbnails", "[]"),
            ("ironing.where", "top"),
            ("skirt.loops", "2"),
            ("machine.relative_e", "true"),
        ],
    ),
    (RAMPS, 0.0, &slopes::SET),
];

/// The name of a part that is made in code.
const RAMPS: &str = "ramps.stl";

/// Where the parts lie, mm: near what the start block draws, since maps of a small print are small.
const BESIDE_THE_START: [f64; 2] = [35.0, 28.0];

/// A sound file, ready to be compared with its edits.
struct File {
    sound: Sound,
    settings: Settings,
    placed: Placed,
    side: Side,
    /// What `check` finds in it without and with the model.
    found: [Verdict; 2],
}

/// How many edits of a kind there were, and which were seen.
#[derive(Debug, Clone, Default)]
struct Row {
    cases: usize,
    check: usize,
    with_model: usize,
    diff: usize,
    either: usize,
    /// The first that was not seen: number of the file and seed.
    unseen: Option<(usize, u64)>,
}

pub(super) fn read(text: &str) -> Print {
    Print::read(&mut text.as_bytes(), 1.75).unwrap()
}

/// What `check` finds by the file's own settings, else by `settings`.
pub(super) fn judge(print: &Print, settings: &Settings, placed: Option<&Placed>) -> Verdict {
    let own = profile::recorded(&print.values).ok().flatten();
    let own = own.as_ref().map(|own| &own.settings);
    let terms = Terms::new(Some(own.unwrap_or(settings)), own, print);
    let model = placed.map(|placed| Model { mesh: &placed.mesh, offset: placed.offset });
    check::check(print, &terms, model)
}

fn side(text: &str, settings: &Settings) -> Option<Side> {
    let options = estimate::Options { filament_diameter: 1.75, ..estimate::Options::default() };
    let time = estimate(&mut text.as_bytes(), "x.gcode", &Limits::new(settings), options).ok()?;
    Side::of_bytes(text.as_bytes(), time).ok()
}

/// Whether some kind of finding is there more often than in the sound file.
pub(super) fn is_new(verdict: &Verdict, sound: &Verdict) -> bool {
    verdict.counts.iter().any(|one| {
        let old = sound.counts.iter().find(|old| old.code == one.code);
        old.is_none_or(|old| one.count > old.count || one.errors > old.errors)
    })
}

impl File {
    fn new((stl, sink, set): &(&str, f64, &[(&str, &str)])) -> Self {
        let placement = Placement { sink: *sink, at: Some(BESIDE_THE_START), ..common::as_it_is() };
        let settings = common::shipped("generic-marlin", set);
        let bytes = if *stl == RAMPS { slopes::part().stl() } else { common::fixture(stl) };
        let text = common::slice_with(&bytes, settings.clone(), &placement).text;
        let model = slicer::Model::bytes(*stl, bytes);
        let bed = slicer::bed(&settings.machine);
        let placed = slicer::place(&[model], &placement, &bed, &Default::default()).unwrap();
        let print = read(&text);
        let found = [None, Some(&placed)].map(|placed| judge(&print, &settings, placed));
        for verdict in &found {
            assert!(!verdict.fails(), "{stl}: {}", common::damage::listed(verdict));
        }
        let side = side(&text, &settings).unwrap();
        Self { sound: Sound::new(&text), settings, placed, side, found }
    }

    /// Whether an edit is seen by `check`, by `check` with the model, by `diff`.
    fn sees(&self, text: &str) -> [bool; 3] {
        let print = read(text);
        let new = |k: usize, placed| is_new(&judge(&print, &self.settings, placed), &self.found[k]);
        let alone = print.layers.is_empty() || new(0, None);
        let with_model = alone || new(1, Some(&self.placed));
        let differs = match side(text, &self.settings) {
            Some(other) => !diff(&self.side, &other, &Tolerances::default()).unwrap().equal,
            None => true,
        };
        [alone, with_model, differs]
    }
}

/// Edits of one kind, so many that count, in turn from each file that has what they change.
fn row(files: &[File], what: &What, cases: usize, salt: u64) -> Row {
    let mut row = Row::default();
    for turn in 0..(cases * TRIES) as u64 {
        if row.cases == cases {
            break;
        }
        let number = turn as usize % files.len();
        let (file, seed) = (&files[number], salt << 32 | turn);
        let Some(text) = file.sound.edit(what, &mut Chance(seed)) else { continue };
        if !what.always_counts() && !file.sound.counts(&text) {
            continue;
        }
        row.cases += 1;
        let [check, with_model, differs] = file.sees(&text);
        row.check += usize::from(check);
        row.with_model += usize::from(with_model);
        row.diff += usize::from(differs);
        row.either += usize::from(with_model || differs);
        if !(with_model || differs) && row.unseen.is_none() {
            row.unseen = Some((number, seed));
        }
        if let Ok(folder) = std::env::var("WITNESS_KEEP")
            && !with_model
        {
            let name = format!("{folder}/{salt}-{number}-{turn}-{differs}.gcode");
            std::fs::write(name, text).unwrap();
        }
    }
    row
}

fn share(some: usize, all: usize) -> String {
    if all == 0 { "–".to_owned() } else { format!("{:.1}", 100.0 * some as f64 / all as f64) }
}

/// The table, in Markdown.
fn table(rows: &[(String, Row)]) -> String {
    let mut text = "| edit | places | `check`, % | with the model, % | `diff`, % | either, % |\n\
                    |---|--:|--:|--:|--:|--:|\n"
        .to_owned();
    for (name, row) in rows {
        let shares = [row.check, row.with_model, row.diff, row.either];
        let [check, with_model, diff, either] = shares.map(|some| share(some, row.cases));
        let _ = writeln!(
            text,
            "| {name} | {} | {check} | {with_model} | {diff} | {either} |",
            row.cases
        );
    }
    text
}

const MARKS: [&str; 2] = ["<!-- witness -->\n", "<!-- end of witness -->\n"];

fn write_down(table: &str) {
    let path = common::fixtures().join("../tests/README.md");
    let text = std::fs::read_to_string(&path).unwrap();
    let (before, rest) = text.split_once(MARKS[0]).unwrap();
    let (_, after) = rest.split_once(MARKS[1]).unwrap();
    std::fs::write(&path, [before, MARKS[0], table, MARKS[1], after].concat()).unwrap();
}

/// For `tests/fuzz`: the edit that these bytes stand for is seen, if it counts.
#[allow(dead_code, reason = "only the fuzzer's")]
pub(crate) fn is_seen(bytes: &[u8]) {
    static FILES: OnceLock<Vec<File>> = OnceLock::new();
    let &[file, kind, high, low, ..] = bytes else { return };
    let files = FILES.get_or_init(|| FILES_OF.iter().map(File::new).collect());
    let kinds = edits::kinds();
    let file = &files[usize::from(file) % files.len()];
    let (name, what) = &kinds[usize::from(kind) % kinds.len()];
    let seed = u64::from(u16::from_be_bytes([high, low]));
    let Some(text) = file.sound.edit(what, &mut Chance(seed)) else { return };
    if what.always_counts() || file.sound.counts(&text) {
        assert!(file.sees(&text)[1..].contains(&true), "not seen: {name}");
    }
}

#[test]
fn what_spoils_a_print_or_a_machine_is_seen() {
    let told = std::env::var("HOSTILE_CASES").ok().and_then(|number| number.parse().ok());
    let cases: usize = told.unwrap_or(CASES);
    let files: Vec<File> = FILES_OF.iter().map(File::new).collect();
    let only = std::env::var("WITNESS_ONLY").unwrap_or_default();
    let kinds: Vec<(String, What)> =
        edits::kinds().into_iter().filter(|(name, _)| name.contains(&only)).collect();
    let rows: Vec<(String, Row)> = kinds
        .par_iter()
        .enumerate()
        .map(|(k, (name, what))| (name.clone(), row(&files, what, cases, k as u64)))
        .collect();
    let table = table(&rows);
    println!("{table}");
    let missed: Vec<&(String, Row)> = rows
        .iter()
        .filter(|(name, row)| {
            let known = UNSEEN.iter().find(|(kind, ..)| kind == name);
            let least = known.map_or(LEAST, |(_, least, _)| *least);
            (row.either as f64) < least * row.cases as f64
        })
        .collect();
    if std::env::var_os("UPDATE_WITNESS").is_some() {
        write_down(&table);
        panic!("the table is written; run without UPDATE_WITNESS");
    }
    assert!(missed.is_empty(), "not seen: {missed:?}");
}
