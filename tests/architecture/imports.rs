//! Source text -> which file uses which: the graph of imports between files, and its circles.
//!
//! A *path* is the names between the colons, `crate::geom::spans::Span`. It belongs to the file of
//! the longest part of it that is a module: `geom/spans.rs` here. Where that module has what comes
//! next from another (`pub use spans::Span`), it belongs to that one's file: who asks for
//! `geom::Span` uses `spans.rs`, and the table of contents that names it uses nothing.
//!
//! Paths stand in `use` items (`crate::`, `super::`, `self::`, a child's name) and in the code
//! (`crate::a::b()`, or `plan::order()` after `use crate::plan`). What macros and methods of
//! values need is not seen. Tests at a file's end do not count.
//!
//! The head of a folder, `mod.rs`, may use the files of its folder, and they may use it: it holds the
//! value that the folder hands on, and the function that shows the way through its files.

use std::collections::{BTreeMap, BTreeSet};

/// Names between colons.
type Names = Vec<String>;

/// A `use` item, one for each name that it brings.
struct Import {
    path: Names,
    /// The name here; `*` for all.
    name: String,
    /// Hands the name on instead of needing it.
    hands_on: bool,
}

/// A file as a module.
struct Module {
    file: String,
    imports: Vec<Import>,
    /// Paths in the code.
    paths: BTreeSet<Names>,
}

/// The modules of one crate by their paths from its root.
pub(crate) struct Crate(BTreeMap<Names, Module>);

impl Crate {
    /// Of files with their bare code; the names are from `src/`, and `root` is the crate's root.
    pub(crate) fn new<'a>(root: &str, files: impl Iterator<Item = (&'a str, String)>) -> Self {
        let module = |(file, code): (&'a str, String)| {
            let (imports, rest) = split(before_tests(&code));
            let paths = paths(&rest);
            (module_of(file, root), Module { file: file.to_owned(), imports, paths })
        };
        Self(files.map(module).collect())
    }

    /// Each file with those that it uses.
    pub(crate) fn uses(&self) -> BTreeMap<&str, BTreeSet<&str>> {
        let of = |(at, module): (&Names, &'_ Module)| -> BTreeSet<&str> {
            let needed = module.imports.iter().filter(|one| !one.hands_on).map(|one| &one.path);
            let files = needed.chain(&module.paths).filter_map(|path| self.file(at, path, 0));
            let folder = module.file.strip_suffix("mod.rs");
            let below = |file: &str| folder.is_some_and(|folder| file.starts_with(folder));
            files.filter(|file| **file != module.file && !below(file)).collect()
        };
        self.0.iter().map(|(at, module)| (module.file.as_str(), of((at, module)))).collect()
    }

    /// The file that `path` belongs to, said in the module `at`.
    fn file(&self, at: &Names, path: &Names, depth: usize) -> Option<&str> {
        let full = self.full(at, path)?;
        let cut = (0..=full.len()).rev().find(|&cut| self.0.contains_key(&full[..cut]))?;
        let module = &self.0[&full[..cut]];
        let next = full.get(cut);
        let named = |one: &&Import| next.is_some_and(|next| one.name == *next);
        let all = |one: &&Import| next.is_some() && one.name == "*" && one.hands_on;
        let from = module.imports.iter().find(named).or(module.imports.iter().find(all));
        let further = from
            .filter(|_| depth < 9)
            .and_then(|from| self.file(&full[..cut].to_vec(), &from.path, depth + 1));
        further.or(Some(&module.file))
    }

    /// `path`, said in the module `at`, from the crate's root; none of other crates.
    fn full(&self, at: &Names, path: &[String]) -> Option<Names> {
        let (first, rest) = path.split_first()?;
        let onto = |base: &[String], rest: &[String]| Some([base, rest].concat());
        match first.as_str() {
            "crate" => onto(&[], rest),
            "self" => onto(at, rest),
            "super" => {
                let above = at.split_last()?.1.to_vec();
                match rest.first().map(String::as_str) {
                    Some("super") => self.full(&above, rest),
                    _ => onto(&above, rest),
                }
            }
            _ if self.0.contains_key(&[at.as_slice(), &path[..1]].concat()) => onto(at, path),
            name => {
                let import = self.0.get(at)?.imports.iter().find(|one| one.name == name)?;
                // A name that is brought by its own name is another crate's.
                let known = import.path.first().is_some_and(|first| first != name);
                let base = known.then(|| self.full(at, &import.path)).flatten()?;
                onto(&base, rest)
            }
        }
    }
}

/// The code without the tests at its end; a test module in a file of its own takes nothing off.
fn before_tests(code: &str) -> &str {
    let mark = "#[cfg(test)]\n";
    let has_body = |(at, _): &(usize, &str)| {
        let item = code[at + mark.len()..].split(['{', ';', '}']).next().unwrap_or_default();
        let opens = code[at + mark.len() + item.len()..].starts_with('{');
        opens && item.split_whitespace().any(|word| word == "mod")
    };
    code.match_indices(mark).find(has_body).map_or(code, |(at, _)| &code[..at])
}

/// The path of the module in `file` from the crate's root.
fn module_of(file: &str, root: &str) -> Names {
    let stem = file.trim_end_matches(".rs").trim_end_matches("/mod");
    if file == root { Vec::new() } else { stem.split('/').map(str::to_owned).collect() }
}

/// The `use` items of the code, and the rest of it.
fn split(code: &str) -> (Vec<Import>, String) {
    let (mut imports, mut rest) = (Vec::new(), String::new());
    for line in code.split_inclusive(';') {
        let start = line.rfind("use ").filter(|&at| {
            let before = line[..at].chars().next_back();
            before.is_none_or(char::is_whitespace)
        });
        let Some(start) = start else {
            rest.push_str(line);
            continue;
        };
        let before = line[..start].trim_end();
        rest.push_str(&line[..start]);
        let hands_on = before.ends_with("pub") || before.ends_with(')') && before.contains("pub(");
        expand(line[start + 4..].trim_end_matches(';'), &[], hands_on, &mut imports);
    }
    (imports, rest)
}

/// `a::{b, c as d}` -> `a::b` and `a::c`.
fn expand(tree: &str, base: &[String], hands_on: bool, into: &mut Vec<Import>) {
    let tree = tree.trim();
    if let Some((head, list)) = tree.split_once('{') {
        let names = head.split("::").map(str::trim).filter(|name| !name.is_empty());
        let base = [base, &names.map(str::to_owned).collect::<Names>()].concat();
        let list = list.trim_end().strip_suffix('}').unwrap_or(list);
        for item in items(list) {
            expand(item, &base, hands_on, into);
        }
    } else if !tree.is_empty() {
        let (tree, alias) = tree.split_once(" as ").unwrap_or((tree, ""));
        let mut path = base.to_vec();
        path.extend(tree.split("::").map(|name| name.trim().to_owned()).filter(|n| !n.is_empty()));
        // `a::{self}` is `a`.
        if path.len() > 1 && path.last().is_some_and(|last| last == "self") {
            path.pop();
        }
        let last = path.last().cloned().unwrap_or_default();
        if last == "*" {
            path.pop();
        }
        let name = if alias.is_empty() { last } else { alias.trim().to_owned() };
        into.push(Import { path, name, hands_on });
    }
}

/// What the commas part that stand in no braces.
fn items(list: &str) -> Vec<&str> {
    let (mut depth, mut start, mut found) = (0, 0, Vec::new());
    for (at, c) in list.char_indices() {
        match c {
            '{' => depth += 1,
            '}' => depth -= 1,
            ',' if depth == 0 => {
                found.push(&list[start..at]);
                start = at + 1;
            }
            _ => {}
        }
    }
    found.push(&list[start..]);
    found
}

/// All `a::b::c` of the code, of two names and more.
fn paths(code: &str) -> BTreeSet<Names> {
    let of_name = |c: char| c.is_alphanumeric() || c == '_';
    let words = code.split(|c: char| !of_name(c) && c != ':');
    let names = |word: &str| word.split("::").map(str::to_owned).collect::<Names>();
    let is_path = |word: &&str| word.contains("::") && !word.starts_with(':');
    let whole =
        |path: Names| -> Names { path.into_iter().filter(|name| !name.is_empty()).collect() };
    words.filter(is_path).map(names).map(whole).filter(|path| path.len() > 1).collect()
}

/// Files that use each other, each circle once, its files sorted.
pub(crate) fn circles<'a>(uses: &BTreeMap<&'a str, BTreeSet<&'a str>>) -> BTreeSet<Vec<&'a str>> {
    let reached = |from: &'a str| -> BTreeSet<&'a str> {
        let (mut seen, mut open) = (BTreeSet::new(), vec![from]);
        while let Some(file) = open.pop() {
            open.extend(uses.get(file).into_iter().flatten().filter(|next| seen.insert(**next)));
        }
        seen
    };
    let reach: BTreeMap<&str, BTreeSet<&str>> = uses.keys().map(|&f| (f, reached(f))).collect();
    let circle = |&file: &&'a str| -> Vec<&'a str> {
        reach[file].iter().copied().filter(|other| reach[other].contains(file)).collect()
    };
    uses.keys().map(circle).filter(|circle| circle.len() > 1).collect()
}
