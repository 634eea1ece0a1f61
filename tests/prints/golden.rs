//! Fixtures -> G-code, byte for byte what a person has looked at and kept in `fixtures/golden/`.
//!
//! `UPDATE_GOLDEN=1 cargo test --test prints golden` rewrites the files, and fails, so
//! that nobody leaves the variable set. Look at the difference before it is kept.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common::checks::sound;
use crate::common::{fixture, fixtures, slice_shipped};
use std::fs;

/// Differing lines shown, at most.
const MOST_SHOWN: usize = 12;

/// Two skins leave two pairs of a tile's eight layers for thick lines. Nobody can read a
/// picture in a difference; `hosts.rs` looks at those.
const SET: [(&str, &str); 3] =
    [("dual.mode", "pair"), ("skin_layers", "2"), ("machine.thumbnails", "[]")];

fn check(name: &str, profile: &str) {
    let run = slice_shipped(&fixture(&format!("{name}.stl")), profile, &SET);
    sound(&run.print, &run.settings, name);
    let file = format!("golden/{name}@{profile}.gcode");
    let path = fixtures().join(&file);
    if std::env::var_os("UPDATE_GOLDEN").is_some() {
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(&path, &run.text).unwrap();
        panic!("fixtures/{file} is rewritten; look at it, and unset UPDATE_GOLDEN");
    }
    let kept = fs::read_to_string(&path).unwrap_or_default();
    assert!(kept == run.text, "fixtures/{file} differs:\n{}", difference(&kept, &run.text));
}

/// The first lines that differ, with their numbers.
fn difference(kept: &str, made: &str) -> String {
    let (mut kept, mut made) = (kept.split('\n'), made.split('\n'));
    let mut text = String::new();
    let mut shown = 0;
    for number in 1.. {
        let (old, new) = (kept.next(), made.next());
        if old.is_none() && new.is_none() || shown == MOST_SHOWN {
            break;
        }
        if old != new {
            let line = |line: Option<&str>| line.map_or("(end)".to_owned(), |l| format!("{l:?}"));
            text += &format!("line {number}\n  kept {}\n  made {}\n", line(old), line(new));
            shown += 1;
        }
    }
    text
}

#[test]
fn a_tile_on_the_default_printer_is_as_kept() {
    check("tile", "zcube-dual");
}

#[test]
fn a_tile_on_a_marlin_printer_is_as_kept() {
    check("tile", "generic-marlin");
}

#[test]
fn a_tile_as_the_thesis_prints_it_is_as_kept() {
    check("tile", "thesis");
}

#[test]
fn differences_are_shown_with_their_lines() {
    assert_eq!(difference("a\nb\n", "a\nb\n"), "");
    assert_eq!(difference("a\nb", "a\nc"), "line 2\n  kept \"b\"\n  made \"c\"\n");
    assert_eq!(difference("a", "a\nb"), "line 2\n  kept (end)\n  made \"b\"\n");
    assert_eq!(difference("", &"x\n".repeat(50)).matches("line").count(), MOST_SHOWN);
}
