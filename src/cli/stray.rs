//! Word that is no file -> the value that it was meant to be, as in `--raft 3` or `--ironing topmost`.

use slicer::profile::keys;
use slicer::text;
use std::ffi::OsString;
use std::path::Path;
use toml::Value;

/// A key that people mean by a word behind a flag, and how it is set: the value comes after it.
type Meant = (&'static str, &'static str);

/// Flags that take no word behind them, and what people mean by one.
const MEANT: [(&str, &[Meant]); 6] = [
    ("--arcs", &[("arc_tolerance", "--arcs --set arc_tolerance=")]),
    ("--dual", &[("dual.ratio", "--dual-ratio "), ("dual.mode", "--dual-mode ")]),
    ("--ironing", &[("ironing.where", "--ironing=")]),
    (
        "--nonplanar",
        &[
            ("nonplanar.skins", "--nonplanar --set nonplanar.skins="),
            ("head.name", "--nonplanar --head "),
        ],
    ),
    ("--raft", &[("raft.interface_layers", "--raft --set raft.interface_layers=")]),
    ("--support", &[("support.threshold_angle", "--support --set support.threshold_angle=")]),
];

/// What to say of the first of the `inputs` that is no file, but a value behind such a flag. `words` are
/// the program's name and its arguments. A word that may be the name of a file is taken for one.
pub(super) fn among(words: &[OsString], inputs: &[OsString]) -> Option<String> {
    let pairs = words.windows(2).filter_map(|pair| Some((pair[0].to_str()?, pair[1].to_str()?)));
    let is_input = |word: &str| inputs.iter().any(|input| input == word);
    let mut strays = pairs.filter(|(_, word)| is_input(word) && !Path::new(word).exists());
    strays.find_map(|(flag, word)| told(flag, word))
}

/// What to say of a `word` given to a `flag` that takes none, if it is a value.
pub(super) fn told(flag: &str, word: &str) -> Option<String> {
    let (flag, meant) = MEANT.iter().find(|(name, _)| *name == flag)?;
    let no_file = format!("{flag} takes no value, and {} is no file", text::line(word));
    if let Some((_, how)) = meant.iter().find(|(key, _)| takes(key, word)) {
        return Some(format!("{no_file}; write {how}{word}"));
    }
    let is_value = word.parse::<f64>().is_ok() || ["on", "off", "true", "false"].contains(&word);
    let key = keys::find(meant.first()?.0)?;
    let limits = format!("{no_file}; leave it out, or see {}: {}", key.name, key.allowed());
    is_value.then_some(limits)
}

/// Whether a key may have the value of this word.
fn takes(key: &str, word: &str) -> bool {
    let number = word.parse().map(Value::Integer).or_else(|_| word.parse().map(Value::Float));
    let value = number.unwrap_or_else(|_| Value::String(word.to_owned()));
    keys::find(key).is_some_and(|key| key.check(value).is_ok())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_behind_a_switch_is_told_how_to_be_written() {
        for (flag, word, expected) in [
            ("--raft", "3", "write --raft --set raft.interface_layers=3"),
            ("--raft", "1000", "leave it out, or see raft.interface_layers: "),
            ("--ironing", "topmost", "write --ironing=topmost"),
            ("--support", "45", "write --support --set support.threshold_angle=45"),
            ("--dual", "3", "write --dual-ratio 3"),
            ("--dual", "interlaced", "write --dual-mode interlaced"),
            ("--nonplanar", "v6", "write --nonplanar --head v6"),
            ("--nonplanar", "3", "write --nonplanar --set nonplanar.skins=3"),
            ("--arcs", "0.05", "write --arcs --set arc_tolerance=0.05"),
            ("--support", "off", "leave it out"),
        ] {
            let told = told(flag, word).unwrap_or_default();
            assert!(told.contains(expected), "{flag} {word}: {told}");
        }
    }

    #[test]
    fn what_may_be_a_file_stays_one() {
        let words = |all: &[&str]| all.iter().map(OsString::from).collect::<Vec<_>>();
        let all =
            words(&["slicer", "--raft", "part.stl", "--dual", "lid", "-o", "3", "--raft", "3"]);
        assert_eq!(among(&all, &words(&["part.stl", "lid"])), None);
        assert!(among(&all, &words(&["part.stl", "3"])).is_some());
        assert_eq!(told("--strict", "3"), None);
    }
}
