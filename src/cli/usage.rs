//! Arguments -> verdict: files that are named twice, words that were meant, and clap's errors on one line.

use super::failure;
use super::output::is_stdout;
use anyhow::Result;
use slicer::profile::suggest;
use slicer::text;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};

/// Checks that a product does not replace the file that it is made from.
///
/// # Errors
/// [`failure::Usage`].
pub(super) fn replaces(product: &Path, input: &OsStr) -> Result<()> {
    if input != "-" && !is_stdout(product) && is_same_file(product, Path::new(input)) {
        let input = text::name(input);
        return refuse(&format!("the output would replace {input}; choose another name for it"));
    }
    Ok(())
}

/// What a first word seems to mean that is neither command nor file, in a sentence.
pub(super) fn meant(word: &str, commands: &clap::Command) -> Option<String> {
    let names = commands.get_subcommands().map(clap::Command::get_name).chain(["--help"]);
    // A command that is known lacks something of its own.
    let unknown = |name: &&str| *name != word && !Path::new(word).exists();
    let name = suggest::nearest(word, names).filter(unknown)?;
    Some(format!("there is no command {word}; did you mean `slicer {name}`?"))
}

/// A refusal.
pub(super) fn refuse(why: &str) -> Result<()> {
    Err(failure::usage(why))
}

/// Devices may well be named twice, only files are compared; files that are
/// not there yet, too.
pub(super) fn is_same_file(a: &Path, b: &Path) -> bool {
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

/// clap's message of a command without its usage block: what is wrong, its tip, and where to find more.
pub(super) fn one_line(text: &str, command: &str) -> String {
    format!("{}; see `{command} --help`", reason(text))
}

/// The same without the last.
pub(super) fn reason(text: &str) -> String {
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
            one_line(text, "slicer"),
            "unexpected argument '--wals' found; a similar argument exists: '--walls'; \
             see `slicer --help`"
        );
        let text = "error: invalid value 'a' for '--b'\n  [possible values: c]\n\nFor more \
                    information, try '--help'.\n";
        assert_eq!(
            one_line(text, "slicer"),
            "invalid value 'a' for '--b'; [possible values: c]; see `slicer --help`"
        );
        let text = "error: the following required arguments were not provided:\n  --output <OUT>\n  \
                    <INPUT>...\n\nUsage: slicer\n";
        assert_eq!(
            one_line(text, "slicer"),
            "the following required arguments were not provided: --output <OUT>, <INPUT>...; \
             see `slicer --help`"
        );
    }
}
