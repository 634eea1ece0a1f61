//! Arguments -> verdict: combinations that clap cannot know, and its errors on one line.

use super::args::SliceArgs;
use super::output::is_stdout;
use clap::CommandFactory as _;
use slicer::error::{Error, Result};
use slicer::profile::suggest;
use std::path::{Path, PathBuf};

/// Checks that no two arguments mean the same file.
///
/// # Errors
/// [`Error::Usage`].
pub(super) fn check(args: &SliceArgs, out: &Path) -> Result<()> {
    if args.inputs.iter().filter(|input| *input == "-").count() > 1 {
        return refuse("`-` is given twice; standard input holds one model");
    }
    let report = args.report.as_deref();
    if is_stdout(out) && report.is_some_and(is_stdout) {
        return refuse("G-code and report cannot both go to standard output; name a file for one");
    }
    let same = |a: &Path, b: &Path| !is_stdout(a) && !is_stdout(b) && is_same_file(a, b);
    if report.is_some_and(|report| same(report, out)) {
        return refuse("-o and --report name the same file; name two");
    }
    for product in std::iter::once(out).chain(report) {
        let read = args.inputs.iter().map(String::as_str).chain([args.profile.as_str()]);
        if let Some(name) = read.into_iter().find(|name| same(product, Path::new(name))) {
            return refuse(&format!("the output would replace {name}; choose another name for it"));
        }
    }
    Ok(())
}

/// Checks that a product does not replace the file that it is made from.
///
/// # Errors
/// [`Error::Usage`].
pub(super) fn replaces(product: &Path, input: &str) -> Result<()> {
    if input != "-" && !is_stdout(product) && is_same_file(product, Path::new(input)) {
        return refuse(&format!("the output would replace {input}; choose another name for it"));
    }
    Ok(())
}

/// What a first word seems to mean that is neither command nor file, in a sentence.
pub(super) fn meant(word: &str) -> Option<String> {
    let commands = super::args::Arguments::command();
    let names = commands.get_subcommands().map(clap::Command::get_name).chain(["--help"]);
    // A command that is known lacks something of its own.
    let unknown = |name: &&str| *name != word && !Path::new(word).exists();
    let name = suggest::nearest(word, names).filter(unknown)?;
    Some(format!("there is no command {word}; did you mean `slicer {name}`?"))
}

fn refuse(why: &str) -> Result<()> {
    Err(Error::Usage(why.to_owned()))
}

/// Devices may well be named twice, only files are compared; files that are
/// not there yet, too.
fn is_same_file(a: &Path, b: &Path) -> bool {
    real_path(a).is_some_and(|a| real_path(b) == Some(a))
}

fn real_path(path: &Path) -> Option<PathBuf> {
    if let Ok(real) = path.canonicalize() {
        return real.is_file().then_some(real);
    }
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    let folder = folder.unwrap_or(Path::new(".")).canonicalize().ok()?;
    Some(folder.join(path.file_name()?))
}

/// clap's message without its usage block: what is wrong, its tip, and where to find more.
pub(super) fn one_line(text: &str) -> String {
    let mut parts: Vec<String> = Vec::new();
    let over = |line: &str| line.starts_with("Usage:") || line.starts_with("For more information");
    let lines = text.lines().take_while(|line| !over(line));
    for line in lines.map(str::trim).filter(|line| !line.is_empty()) {
        let line = line.trim_start_matches("error: ");
        match (parts.last_mut(), line.strip_prefix("tip: ")) {
            (Some(last), None) if last.ends_with(':') => {
                last.push(' ');
                last.push_str(line);
            }
            (Some(last), None) if !line.starts_with('[') => {
                last.push_str(", ");
                last.push_str(line);
            }
            (_, tip) => parts.push(tip.unwrap_or(line).to_owned()),
        }
    }
    parts.push("see `slicer --help`".to_owned());
    parts.join("; ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clap_errors_become_one_line() {
        let text = "error: unexpected argument '--wals' found\n\n  tip: a similar argument exists: \
                    '--walls'\n\nUsage: slicer\n\nFor more information, try '--help'.\n";
        assert_eq!(
            one_line(text),
            "unexpected argument '--wals' found; a similar argument exists: '--walls'; \
             see `slicer --help`"
        );
        let text = "error: invalid value 'a' for '--b'\n  [possible values: c]\n\nFor more \
                    information, try '--help'.\n";
        assert_eq!(
            one_line(text),
            "invalid value 'a' for '--b'; [possible values: c]; see `slicer --help`"
        );
        let text = "error: the following required arguments were not provided:\n  --output <OUT>\n  \
                    <INPUT>...\n\nUsage: slicer\n";
        assert_eq!(
            one_line(text),
            "the following required arguments were not provided: --output <OUT>, <INPUT>...; \
             see `slicer --help`"
        );
    }
}
