//! Source text -> verdict: the layout the modules promise: who imports whom, sizes, heads, who may print.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod imports;

use imports::{Crate, circles};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// What each module of the library may use of the crate, beside itself.
const MAY_USE: &[(&str, &[&str])] = &[
    // Texts only.
    ("guide", &[]),
    ("units", &[]),
    ("warning", &[]),
    ("progress", &[]),
    ("text", &[]),
    // Composes what the stages report of their failures.
    ("geom", &["units"]),
    ("mesh", &["geom", "text", "units", "warning"]),
    ("slice", &["geom", "mesh", "units"]),
    ("render", &["mesh", "units"]),
    ("pattern", &["geom", "profile", "units"]),
    ("region", &["geom", "mesh", "pattern", "slice", "profile", "units"]),
    ("fill", &["geom", "pattern", "region", "slice", "profile", "units"]),
    // Paths of its own kind; of regions it sees how sections are scanned.
    (
        "nonplanar",
        &["fill", "geom", "head", "mesh", "pattern", "region", "slice", "profile", "units"],
    ),
    // Paths in, paths out: nothing of where they come from.
    ("plan", &["fill", "geom", "slice", "profile", "units"]),
    // The program's name comes from the job.
    ("gcode", &["geom", "fill", "plan", "motion", "profile", "units", "job"]),
    ("job", &["mesh", "profile", "text"]),
    // What hangs around the nozzle, and where it would touch a map of heights: no settings, no G-code.
    ("head", &["units"]),
    ("profile", &["text", "head"]),
    ("motion", &["profile", "units"]),
    // A witness of its own: it shares nothing with the code that slices, plans or writes, but for what
    // an arc is: see WITNESSES.
    ("reader", &["units", "geom"]),
    ("estimate", &["reader", "motion"]),
    // Independent witnesses: nothing of slice, region, plan or gcode. Of `geom` they use only what
    // knows no contour, raster or offset: see WITNESSES.
    ("check", &["reader", "mesh", "head", "profile", "units", "geom"]),
    ("preview", &["reader", "estimate", "text", "units"]),
    ("diff", &["reader", "estimate", "geom"]),
    ("roughness", &["reader", "mesh", "units"]),
    // G-code in, steps out: it plans times as an estimate does.
    ("steps", &["reader", "estimate", "motion", "profile", "units"]),
    // Composed of the stages' own errors: no stage uses it.
    ("error", &["gcode", "mesh", "profile", "progress", "reader", "steps", "warning"]),
    // Tells of what all stages made, and of nothing that composes them.
    (
        "report",
        &[
            "check",
            "error",
            "fill",
            "gcode",
            "job",
            "mesh",
            "nonplanar",
            "profile",
            "reader",
            "region",
            "slice",
            "steps",
            "units",
            "warning",
        ],
    ),
];

/// Modules that judge what the others have made. `check` knows the shape of a head, which is what a profile
/// says of the machine; where it touches something it finds by a map and a sweep of its own.
const WITNESSES: &[&str] = &["reader", "estimate", "check", "diff", "roughness"];

/// What witnesses may use of `geom`: distances to segments, sorting by counting, booleans of spans on a
/// line, the pieces of an arc, and which numbers hang together (union-find). None knows what is sliced or printed, all are tested on their own by laws, and a
/// second version of them would only be another place for the same slip. Contours, offsets and
/// rasters have a part in what is judged; of these a witness has its own.
const SHARED_GEOMETRY: &[&str] = &["segment", "cells", "spans", "arc", "sets"];

/// Modules that may use all others: the flow itself.
const MAY_USE_ALL: &[&str] = &["lib", "pipeline", "compare"];

/// So many there are nearly. With fewer the search for them has a hole, and the rest here proves nothing.
const LEAST_SOURCES: usize = 480;
const LEAST_FUNCTIONS: usize = 4_200;
const LEAST_IMPORTS: usize = 2_100;

/// The binary's own modules.
const BINARY: &[&str] = &["cli", "main"];

/// Lines of a file.
const MOST_LINES: usize = 500;

/// Lines of a function.
const MOST_LINES_OF_FUNCTION: usize = 60;

/// Circles of imports that are there still. None is added: what two files need of each other goes
/// into a third.
const CIRCLES: &[&[&str]] = &[];

/// Lines from which a file has a head, and lines that the head has at least.
const LONG: usize = 200;
const LEAST_HEAD: usize = 8;

/// Long files without a head. None is added.
const WITHOUT_HEAD: &[&str] = &["cli/args.rs"];

struct Source {
    /// From src/, with slashes.
    path: String,
    /// `geom` for `geom/spans.rs`, `lib` for `lib.rs`.
    module: String,
    text: String,
}

fn sources() -> Vec<Source> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let (mut folders, mut files) = (vec![root.clone()], Vec::<PathBuf>::new());
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            let is_rust = path.extension().is_some_and(|extension| extension == "rs");
            match path.is_dir() {
                true => folders.push(path),
                false if is_rust => files.push(path),
                // Parts of a page are none of the modules.
                false => {}
            }
        }
    }
    files.sort();
    let source = |path: PathBuf| {
        let from_root = path.strip_prefix(&root).unwrap();
        let parts: Vec<_> = from_root.iter().map(|p| p.to_str().unwrap()).collect();
        let path_in_src = parts.join("/");
        Source {
            module: module_of(&path_in_src).to_owned(),
            path: path_in_src,
            text: fs::read_to_string(&path).unwrap(),
        }
    };
    let sources: Vec<Source> = files.into_iter().map(source).collect();
    assert!(sources.len() > LEAST_SOURCES, "only {} sources were found", sources.len());
    sources
}

/// The code without comments and without what string and character literals hold.
fn bare(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(c) = rest.chars().next() {
        let skip = if rest.starts_with("//") {
            rest.find('\n').unwrap_or(rest.len())
        } else if c == '"' {
            end_of_string(rest)
        } else if c == '\'' {
            end_of_character(rest)
        } else {
            out.push(c);
            rest = &rest[c.len_utf8()..];
            continue;
        };
        // Line breaks within literals keep their place.
        out.extend(rest[..skip].chars().filter(|&c| c == '\n'));
        rest = &rest[skip..];
    }
    out
}

/// Where the literal ends that `text` begins with; bytes.
fn end_of_string(text: &str) -> usize {
    let mut escaped = false;
    for (k, c) in text.char_indices().skip(1) {
        match c {
            '"' if !escaped => return k + 1,
            _ => escaped = c == '\\' && !escaped,
        }
    }
    text.len()
}

/// Where the character literal ends that `text` begins with; a lifetime is only its quote.
fn end_of_character(text: &str) -> usize {
    let mut chars = text.char_indices().skip(1);
    match chars.next() {
        Some((_, '\\')) => text[2..].find('\'').map_or(1, |k| {
            // An escaped quote is followed by the one that ends the literal.
            if k == 0 { 4 } else { k + 3 }
        }),
        Some(_) => match chars.next() {
            Some((k, '\'')) => k + 1,
            _ => 1,
        },
        None => 1,
    }
}

/// Each file of the library with the files that it uses.
fn used_in_library(sources: &[Source]) -> BTreeMap<String, BTreeSet<String>> {
    let mine = sources.iter().filter(|s| !BINARY.contains(&s.module.as_str()));
    let all = Crate::new("lib.rs", mine.map(|s| (s.path.as_str(), bare(&s.text))));
    let owned = |files: BTreeSet<&str>| files.into_iter().map(str::to_owned).collect();
    all.uses().into_iter().map(|(file, used)| (file.to_owned(), owned(used))).collect()
}

/// `geom` for `geom/spans.rs`, `lib` for `lib.rs`.
fn module_of(file: &str) -> &str {
    file.split('/').next().unwrap_or_default().trim_end_matches(".rs")
}

#[test]
fn modules_use_only_what_lies_before_them() {
    let known: Vec<&str> =
        MAY_USE.iter().map(|(module, _)| *module).chain(MAY_USE_ALL.iter().copied()).collect();
    for (file, used) in used_in_library(&sources()) {
        let module = module_of(&file);
        assert!(known.contains(&module), "{file}: say in this test what it may use");
        let Some((_, allowed)) = MAY_USE.iter().find(|(name, _)| *name == module) else { continue };
        for other in &used {
            let to = module_of(other);
            let fits = to == module || allowed.contains(&to);
            assert!(fits, "src/{file} uses src/{other}, which {module} may not");
        }
    }
}

#[test]
fn the_table_grants_nothing_that_nobody_needs() {
    let uses = used_in_library(&sources());
    let mut spare = Vec::new();
    for (module, allowed) in MAY_USE {
        let mine = uses.iter().filter(|(file, _)| module_of(file) == *module);
        let needed: BTreeSet<&str> =
            mine.flat_map(|(_, used)| used).map(|f| module_of(f)).collect();
        spare.extend(allowed.iter().filter(|to| !needed.contains(*to)).map(|to| (*module, *to)));
    }
    assert!(spare.is_empty(), "grants that nobody needs: not in MAY_USE: {spare:?}");
}

#[test]
fn witnesses_share_no_geometry_with_what_they_judge() {
    for (file, used) in used_in_library(&sources()) {
        let used = used.iter().filter_map(|other| other.strip_prefix("geom/"));
        for other in used.filter(|_| WITNESSES.contains(&module_of(&file))) {
            assert!(SHARED_GEOMETRY.contains(&module_of(other)), "src/{file} uses geom/{other}");
        }
    }
}

#[test]
fn the_table_of_contents_names_every_module() {
    let sources = sources();
    let root = sources.iter().find(|s| s.path == "lib.rs").unwrap();
    let head: String = root
        .text
        .lines()
        .take_while(|line| line.starts_with('/') || line.starts_with('#'))
        .collect();
    let modules = BTreeSet::from_iter(sources.iter().map(|s| s.module.as_str()));
    for module in modules.into_iter().filter(|m| *m != "lib" && !BINARY.contains(m)) {
        let named = [format!("[`{module}`]"), format!("[`mod@{module}`]")];
        assert!(
            named.iter().any(|name| head.contains(name)),
            "src/lib.rs does not tell of {module}"
        );
    }
}

#[test]
fn files_that_the_guide_names_are_there() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let guide = fs::read_dir(root.join("src/guide")).unwrap().map(|entry| entry.unwrap().path());
    let texts = guide
        .chain([root.join("README.md")])
        .filter(|path| path.extension().is_some_and(|e| e == "md"));
    let mut count = 0;
    for path in texts {
        let text = fs::read_to_string(&path).unwrap();
        // What stands in `quotes`; `NAME` is what somebody will add.
        let words = text.split('`').skip(1).step_by(2);
        let is_path = |word: &&str| word.contains('/') || word.ends_with(".rs");
        let words = words.filter(is_path).filter(|word| !word.contains([' ', '\n']));
        for word in words.filter(|word| !word.contains("NAME")) {
            count += 1;
            let is_there = root.join("src").join(word).exists() || root.join(word).exists();
            assert!(is_there, "{} names {word}, which is not there", path.display());
        }
    }
    assert!(count > 50, "only {count} names of files were found");
}

#[test]
fn every_source_begins_with_what_it_is() {
    for source in sources() {
        let first = source.text.lines().next().unwrap_or_default();
        let said = first.strip_prefix("//! ").unwrap_or_default();
        assert!(said.len() > 10, "src/{} begins with {first:?}", source.path);
    }
}

#[test]
fn every_source_is_a_module_of_the_crate() {
    let sources = sources();
    for source in &sources {
        let path = source.path.trim_end_matches("/mod.rs").trim_end_matches(".rs");
        let (parent, name) = path.rsplit_once('/').unwrap_or(("", path));
        if BINARY.contains(&name) || name == "lib" {
            continue;
        }
        let heads = [format!("{parent}.rs"), format!("{parent}/mod.rs")];
        let tops = ["lib.rs".to_owned(), "main.rs".to_owned()];
        let declared = sources
            .iter()
            .filter(|s| if parent.is_empty() { &tops } else { &heads }.contains(&s.path))
            .any(|head| bare(&head.text).contains(&format!("mod {name};")));
        assert!(declared, "src/{}: no file declares it, so it is never compiled", source.path);
    }
}

#[test]
fn sources_are_short() {
    for source in sources() {
        let lines = source.text.lines().count();
        assert!(lines <= MOST_LINES, "src/{} has {lines} lines", source.path);
    }
}

/// Each function's name, first line and length, by counting braces.
fn functions(code: &str) -> Vec<(String, usize, usize)> {
    let mut found = Vec::new();
    for (at, _) in code.match_indices("fn ") {
        let before = code[..at].chars().next_back();
        if before.is_some_and(|c| !c.is_whitespace() && c != '(') {
            continue;
        }
        let name: String =
            code[at + 3..].chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
        let (mut brackets, mut depth, mut length) = (0, 0, None);
        for (k, c) in code[at..].char_indices() {
            match c {
                '(' | '[' => brackets += 1,
                ')' | ']' => brackets -= 1,
                ';' if depth == 0 && brackets == 0 => break,
                '{' => depth += 1,
                '}' if depth == 1 => {
                    length = Some(code[at..at + k].matches('\n').count() + 1);
                    break;
                }
                '}' => depth -= 1,
                _ => {}
            }
        }
        let line = code[..at].matches('\n').count() + 1;
        found.extend(length.filter(|_| !name.is_empty()).map(|length| (name, line, length)));
    }
    found
}

#[test]
fn functions_are_short() {
    let mut count = 0;
    for source in sources() {
        for (name, line, length) in functions(&bare(&source.text)) {
            count += 1;
            assert!(
                length <= MOST_LINES_OF_FUNCTION,
                "src/{}:{line}: {name} has {length} lines",
                source.path
            );
        }
    }
    assert!(count > LEAST_FUNCTIONS, "only {count} functions were found");
}

#[test]
fn only_the_command_line_prints() {
    for source in sources().iter().filter(|s| !BINARY.contains(&s.module.as_str())) {
        let code = bare(&source.text);
        for word in ["println!", "eprintln!", "print!", "eprint!", "dbg!", "stdout()", "stderr()"] {
            assert!(!code.contains(word), "src/{} has {word}", source.path);
        }
    }
}

#[test]
fn the_text_of_literals_and_comments_is_no_code() {
    let text = "a \"x { \\\" // \" b // { \n '{' c '\\'' '\\n' &'a d \"\n\" e";
    assert_eq!(bare(text), "a  b \n  c   &a d \n e");
    let code = "impl A {\n fn one() -> [u8; 2] {\n {}\n }\n fn no();\n}\nfn two() {}\n";
    let found = functions(code);
    assert_eq!(found[0], ("one".to_owned(), 2, 3));
    assert_eq!(found[1].0, "two");
}

#[test]
fn files_use_each_other_in_no_circle() {
    let sources = sources();
    let mut found = BTreeSet::new();
    for (root, binary, least) in [("lib.rs", false, LEAST_IMPORTS), ("main.rs", true, 100)] {
        let mine = sources.iter().filter(|s| BINARY.contains(&s.module.as_str()) == binary);
        let all = Crate::new(root, mine.map(|s| (s.path.as_str(), bare(&s.text))));
        let uses = all.uses();
        let count = uses.values().map(BTreeSet::len).sum::<usize>();
        assert!(count > least, "{root}: only {count} imports were found");
        found.extend(circles(&uses).into_iter().map(|files| files.join(" ")));
    }
    let known: BTreeSet<String> = CIRCLES.iter().map(|files| files.join(" ")).collect();
    let new: Vec<_> = found.difference(&known).collect();
    assert!(new.is_empty(), "these files of src use each other in a circle: {new:#?}");
    let gone: Vec<_> = known.difference(&found).collect();
    assert!(gone.is_empty(), "circles that are gone: take them out of CIRCLES: {gone:#?}");
}

#[test]
fn long_sources_begin_with_their_words_and_their_algorithm() {
    let sources = sources();
    let short = |source: &&Source| {
        let head = source.text.lines().take_while(|line| line.starts_with("//!")).count();
        source.text.lines().count() > LONG && head < LEAST_HEAD
    };
    let found: BTreeSet<&str> = sources.iter().filter(short).map(|s| s.path.as_str()).collect();
    let known = BTreeSet::from_iter(WITHOUT_HEAD.iter().copied());
    let new: Vec<_> = found.difference(&known).collect();
    assert!(
        new.is_empty(),
        "these files of src are over {LONG} lines; let them begin with {LEAST_HEAD} lines or more that \
         define their words and say how they go about it: {new:#?}"
    );
    let gone: Vec<_> = known.difference(&found).collect();
    assert!(gone.is_empty(), "they have a head, or need none: not in WITHOUT_HEAD: {gone:#?}");
}

#[test]
fn imports_are_followed_to_the_file_that_has_the_name() {
    let files = [
        ("lib.rs", "mod a; mod b; pub use a::x::One;"),
        ("a/mod.rs", "pub mod x; mod y; mod z; pub(crate) use y::*; use x::One;"),
        ("a/x.rs", "use super::Two; use crate::b; fn f() { b::go(); }"),
        ("a/y.rs", "pub struct Two; use crate::{One as Uno, b::{self, Three}}; use std::fmt;"),
        ("a/z/mod.rs", "mod w;"),
        ("a/z/w.rs", "use super::super::super::b::go; use super::super::y::Two;"),
        (
            "b.rs",
            "fn f() -> self::Four { super::a::x::g(); fmt::x(); }\n#[cfg(test)]\nmod tests { use crate::a::y::Two; }",
        ),
    ];
    let all = Crate::new("lib.rs", files.into_iter().map(|(file, code)| (file, code.to_owned())));
    let uses = all.uses();
    let expected = [
        ("lib.rs", vec![]),
        // A folder's head may use what is in the folder.
        ("a/mod.rs", vec![]),
        ("a/x.rs", vec!["a/y.rs", "b.rs"]),
        ("a/y.rs", vec!["a/x.rs", "b.rs"]),
        ("a/z/mod.rs", vec![]),
        // However many `super::` lead there.
        ("a/z/w.rs", vec!["a/y.rs", "b.rs"]),
        ("b.rs", vec!["a/x.rs"]),
    ];
    assert_eq!(uses, expected.map(|(file, used)| (file, used.into_iter().collect())).into());
    let circle = vec!["a/x.rs", "a/y.rs", "b.rs"];
    assert_eq!(circles(&uses), BTreeSet::from([circle]));
}
