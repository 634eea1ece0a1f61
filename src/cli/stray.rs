//! Word that is no file -> the value that it was meant to be, as in `--raft 3` or `--ironing topmost`.

use super::args::SettingArgs;
use slicer::profile::keys;
use slicer::text;
use std::ffi::OsString;
use std::path::Path;
use toml::Value;

/// Flags that take no word behind them, and the keys that people mean by one.
const MEANT: [(&str, &[&str]); 6] = [
    ("--arcs", &["arc_tolerance"]),
    ("--dual", &["dual.ratio", "dual.mode"]),
    ("--ironing", &["ironing.where"]),
    ("--nonplanar", &["nonplanar.skins", "head.name"]),
    ("--raft", &["raft.interface_layers"]),
    ("--support", &["support.threshold_angle"]),
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
    let shown = text::line(word);
    if let Some(how) = meant.iter().find_map(|key| set(flag, key, word)) {
        return Some(format!("{flag} takes no value, and {shown} is no file; write {how}"));
    }
    let is_value = word.parse::<f64>().is_ok() || ["on", "off", "true", "false"].contains(&word);
    let how = meant.first().and_then(|key| keys::find(key));
    let how =
        how.map_or_else(String::new, |key| format!(", or see {}: {}", key.name, key.allowed()));
    is_value.then(|| format!("{flag} takes no value, and {shown} is no file; leave it out{how}"))
}

/// How to set a key to the value of `word`, if it takes that.
fn set(flag: &str, key: &str, word: &str) -> Option<String> {
    let number = word.parse().map(Value::Integer).or_else(|_| word.parse().map(Value::Float));
    let value = number.unwrap_or_else(|_| Value::String(word.to_owned()));
    keys::find(key)?.check(value).ok()?;
    Some(match SettingArgs::flag_of(key) {
        Some(own) if own == flag => format!("{own}={word}"),
        Some(other) => format!("{other} {word}"),
        None => format!("{flag} --set {key}={word}"),
    })
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
            ("--nonplanar", "v6", "write --head v6"),
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
