//! Error or warning of a job -> the same with the model that it is about: a farm's log holds those of many jobs.
//!
//! - What is at one place of the bed is about the model whose box holds it.
//! - What is not is about all models of the job: the first are named, and how many more there are.
//! - What names a file itself is left as it is, and so are errors of the command line, a profile or the output.

use slicer::Model;
use slicer::error::Error;
use slicer::error::details::Details;
use slicer::mesh::{self, MeshReport};
use slicer::report::Report;
use slicer::warning::Warning;
use std::fmt;

/// Models that are named where something is about all of them.
const MOST_NAMED: usize = 3;

/// Context: the models that something is wrong with.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct About {
    /// The file, if it is one.
    pub(super) file: Option<String>,
    /// What people read.
    names: String,
}

impl fmt::Display for About {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.names)
    }
}

impl About {
    /// All of these files.
    fn all<'a>(files: impl Iterator<Item = &'a str>) -> Self {
        let files: Vec<&str> = files.collect();
        let named = files.iter().take(MOST_NAMED).copied().collect::<Vec<_>>().join(", ");
        let more = files.len().saturating_sub(MOST_NAMED);
        let names = if more == 0 { named } else { format!("{named} and {more} more") };
        let file = if let [one] = files[..] { Some(one.to_owned()) } else { None };
        Self { file, names }
    }

    /// The model that holds this place, or else all.
    fn at(models: &[MeshReport], at_mm: Option<[f64; 2]>) -> Self {
        match at_mm.and_then(|at_mm| mesh::model_at(models, at_mm)) {
            Some(model) => Self::all(std::iter::once(model.file.as_str())),
            None => Self::of_job(models),
        }
    }

    /// All models of a job.
    pub(super) fn of_job(models: &[MeshReport]) -> Self {
        Self::all(models.iter().map(|model| model.file.as_str()))
    }
}

/// An error of placing, with the models.
pub(super) fn unplaced(error: Error, models: &[Model]) -> anyhow::Error {
    if !is_nameless(&error) {
        return error.into();
    }
    let names: Vec<String> = models.iter().map(name).collect();
    anyhow::Error::from(error).context(About::all(names.iter().map(String::as_str)))
}

/// An error of slicing, with the models or the one that is at its place.
pub(super) fn unsliced(error: Error, models: &[MeshReport]) -> anyhow::Error {
    if !is_nameless(&error) {
        return error.into();
    }
    let at_mm = Details::from(&error).place.and_then(|place| place.at_mm);
    anyhow::Error::from(error).context(About::at(models, at_mm))
}

/// A warning as it is told.
pub(super) fn told(warning: &Warning, report: &Report) -> String {
    match warning.file() {
        Some(_) => warning.to_string(),
        None => format!("{}: {warning}", About::at(&report.models, warning.at_mm())),
    }
}

/// Lines that tell of a job, each with the models.
pub(super) fn lines(text: &str, models: &[MeshReport]) -> String {
    let about = About::of_job(models);
    text.lines().map(|line| format!("{about}: {line}\n")).collect()
}

/// As the report calls it.
fn name(model: &Model) -> String {
    let name = model.name();
    if name == "-" { "<stdin>".to_owned() } else { name.into_owned() }
}

/// Whether it is about models, and names none.
fn is_nameless(error: &Error) -> bool {
    match error {
        Error::Mesh(error) if error.is_usage() => false,
        Error::Mesh(_) | Error::Refused(_) => {
            let names_all = matches!(error, Error::Refused(slicer::error::Refusal::Open { .. }));
            Details::from(error).file.is_none() && !names_all
        }
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_models_are_named_and_a_file_only_where_it_is_one() {
        let of = |files: &[&str]| About::all(files.iter().copied());
        let told = of(&["a", "b", "c", "d", "e"]);
        assert_eq!((told.to_string().as_str(), told.file), ("a, b, c and 2 more", None));
        let told = of(&["a"]);
        assert_eq!((told.to_string().as_str(), told.file.as_deref()), ("a", Some("a")));
    }
}
