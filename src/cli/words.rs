//! Words of flags -> values: settings after `--set`, lists of numbers, units, and names that stand for others.

use super::failure::usage;
use anyhow::Result;
use clap::builder::RangedU64ValueParser;
use slicer::check::finding::Code;
use slicer::mesh::Unit;
use slicer::profile::keys::{self, Kind};
use slicer::profile::{Override, ValueOrigin, suggest};
use slicer::text;

/// The overrides that `--set` gives.
///
/// # Errors
/// [`Usage`](super::failure::Usage) for a word without `=`.
pub(super) fn set_overrides(words: &[String]) -> Result<Vec<Override>> {
    let one = |word: &String| {
        let (key, value) = word.split_once('=').ok_or_else(|| {
            let word = text::line(word);
            usage(format!("--set {word}: there is no `=`; write --set KEY=VALUE"))
        })?;
        Ok(Override {
            key: key.trim().to_owned(),
            value: value.trim().to_owned(),
            origin: ValueOrigin::Set,
        })
    };
    words.iter().map(one).collect()
}

/// `all` is short for every part there is.
pub(super) fn parts(list: &str) -> String {
    let all = || words("dual.parts").collect::<Vec<_>>().join(",");
    if list.trim() == "all" { all() } else { list.to_owned() }
}

/// Where a brim of this width is: around the parts, or nowhere.
pub(super) fn brim(width: &str) -> String {
    let none = width.trim().parse::<f64>().is_ok_and(|width| width == 0.0);
    if none { "off" } else { "outside" }.to_owned()
}

/// The words that a setting may have.
pub(super) fn words(key: &str) -> impl Iterator<Item = &'static str> {
    let words = match keys::find(key).map(|key| &key.kind) {
        Some(Kind::Word(words) | Kind::Words(words)) => words.as_slice(),
        _ => &[],
    };
    words.iter().map(String::as_str)
}

/// A kind of findings of `check`.
pub(super) fn code(name: &str) -> std::result::Result<Code, String> {
    let name = name.trim();
    let known = || Code::ALL.iter().map(|code| code.name());
    Code::ALL.into_iter().find(|code| code.name() == name).ok_or_else(|| {
        let mut hint = suggest::did_you_mean(name, known());
        if hint.is_empty() {
            hint = suggest::containing(name, known());
        }
        format!("check finds nothing of this code{hint}; `slicer man check` lists them")
    })
}

/// A number above 0.
pub(super) fn factor(text: &str) -> std::result::Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| "it must be a number, such as 0.5".to_owned())?;
    if value.is_finite() && value > 0.0 {
        Ok(value)
    } else {
        Err("it must be more than 0".to_owned())
    }
}

/// A length that is not negative.
pub(super) fn sunk(text: &str) -> std::result::Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| "it must be a number, such as 0.5".to_owned())?;
    if value.is_finite() && value >= 0.0 {
        Ok(value)
    } else {
        Err("it must be 0 or more".to_owned())
    }
}

/// `N` finite numbers with commas between them.
pub(super) fn numbers<const N: usize>(text: &str) -> std::result::Result<[f64; N], String> {
    let wrong = || format!("it must be {N} numbers with commas between them");
    let parsed: Vec<f64> = text
        .split(',')
        .map(|part| part.trim().parse().ok().filter(|number: &f64| number.is_finite()))
        .collect::<Option<_>>()
        .ok_or_else(wrong)?;
    parsed.try_into().map_err(|_| wrong())
}

/// Units that a model's numbers may have.
pub(super) const UNITS: [&str; 4] = ["mm", "cm", "m", "inch"];

/// One of [`UNITS`].
pub(super) fn unit(name: &str) -> Unit {
    match name {
        "cm" => Unit::Cm,
        "m" => Unit::M,
        "inch" => Unit::Inch,
        _ => Unit::Mm,
    }
}

/// A number of triangles that a mesh can have.
pub(super) fn triangles() -> RangedU64ValueParser<usize> {
    RangedU64ValueParser::new().range(1..1 << 30)
}
