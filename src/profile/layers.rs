//! Names -> layers: the profiles of a job with all that they inherit, in the order in which they are laid.
//!
//! A *layer* is the text of one profile, read. Of several layers the last one that says a value
//! gives it. Layers are put in this order:
//!
//! 1. the default print and the default material, where the job names none of its own,
//! 2. the default printer, where it names no printer,
//! 3. the profiles asked for, one after the other, each after what it inherits.
//!
//! Defaults lie below what is asked for, so that a printer of one's own with a temperature in it
//! keeps it. A profile names them in `[defaults]`; where several do, the last one holds. So a
//! printer alone is a whole job, and `--material petg` replaces its material instead of being laid
//! over it.

use super::error::{ProfileError, Result};
use super::kind::ProfileKind;
use super::origin::{Source, ValueOrigin};
use super::parse::{self, Entry};
use super::shelf::{Found, Shelf};
use crate::text;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use toml::Value;

/// A profile that a job asks for.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Wanted {
    /// Its name or file.
    pub name: String,
    /// The file itself, where its name is no UTF-8.
    pub file: Option<PathBuf>,
    /// What it has to be, if that is asked for.
    pub kind: Option<ProfileKind>,
}

impl Wanted {
    /// Any profile of this name.
    pub fn any(name: impl Into<String>) -> Self {
        Self { name: name.into(), file: None, kind: None }
    }

    /// The profile of this name, which is of this kind.
    pub fn of(kind: ProfileKind, name: impl Into<String>) -> Self {
        Self { name: name.into(), file: None, kind: Some(kind) }
    }

    /// As [`any`](Self::any) or [`of`](Self::of) by a word of the command line. One that is no UTF-8
    /// is the name of a file, whatever it looks like.
    #[must_use]
    pub fn word(kind: Option<ProfileKind>, word: &OsStr) -> Self {
        let file = word.to_str().is_none().then(|| PathBuf::from(word));
        let name = word.to_str().map_or_else(|| text::name(word), str::to_owned);
        Self { name, file, kind }
    }
}

/// One profile, read.
pub(super) struct Layer {
    pub(super) found: Found,
    pub(super) entries: Vec<Entry>,
}

impl Layer {
    fn read(found: Found) -> Result<Self> {
        let entries = parse::document(&found.shown, &found.text()?)?;
        Ok(Self { found, entries })
    }

    /// The values that are no settings: what it inherits, and its defaults.
    fn says(&self, key: &str) -> Option<&Entry> {
        self.entries.iter().find(|entry| entry.key == key)
    }

    /// Its settings, with their places.
    pub(super) fn settings(self) -> impl Iterator<Item = (String, Value, ValueOrigin)> {
        let name = self.found.shown;
        let own = self.entries.into_iter().filter(|entry| {
            entry.key != INHERITS && !is_default(&entry.key) && !entry.is_empty_table()
        });
        own.map(move |Entry { key, value, line }| {
            (key, value, ValueOrigin::File { name: name.clone(), line })
        })
    }

    /// Whether it says which printer it is for.
    fn names_printer(&self) -> bool {
        self.found.kind == Some(ProfileKind::Printer) || self.says(MACHINE).is_some()
    }

    pub(super) fn source(&self) -> Source {
        let Found { name, kind, path, shown, .. } = &self.found;
        let file = path.as_ref().map(|_| shown.clone());
        Source { name: name.clone(), kind: *kind, file }
    }
}

const INHERITS: &str = "inherits";

/// The key that every printer of one's own says.
const MACHINE: &str = "machine.name";

/// Whether this names a default, and so is no setting.
fn is_default(key: &str) -> bool {
    let kind = key.strip_prefix("defaults.");
    kind.is_some_and(|kind| ProfileKind::ALL.iter().any(|one| one.name() == kind))
}

/// The layers of a job.
#[derive(Default)]
pub(super) struct Laid {
    /// The most general first.
    pub(super) layers: Vec<Layer>,
    /// The names of what was asked for.
    pub(super) asked: Vec<String>,
    /// The printer that somebody chose, by the name that was asked for; or else the default one.
    pub(super) printer: String,
    /// Whether somebody chose it.
    pub(super) is_printer_chosen: bool,
}

/// The layers of a job that asks for `wanted`.
///
/// # Errors
/// What is wrong with a name, a file, `inherits` or `[defaults]`.
pub(super) fn layers(wanted: &[Wanted], shelf: &Shelf) -> Result<Laid> {
    let (mut asked, mut printer) = (Vec::new(), None);
    let mut reading = Reading { shelf, chain: Vec::new(), layers: Vec::new() };
    for one in wanted {
        let found = match &one.file {
            Some(file) => Found::file(file.clone(), None),
            None => shelf.find(&one.name, None, |_| false)?,
        };
        let (name, below) = (found.name.clone(), reading.layers.len());
        asked.push(name.clone());
        reading.add(of_kind(found, one.kind)?)?;
        if reading.layers[below..].iter().any(Layer::names_printer) {
            printer = Some(name);
        }
    }
    // Files of one's own may be a whole job, and are refused with a hint if they are not.
    let may_be_whole =
        !wanted.is_empty() && reading.layers.iter().all(|layer| layer.found.kind.is_none());
    for kind in ProfileKind::ALL {
        if reading.layers.iter().any(|layer| layer.found.kind == Some(kind)) {
            continue;
        }
        let default = match reading.default_of(kind)? {
            None if kind == ProfileKind::Printer && !may_be_whole => {
                let found = shelf.default_printer();
                // A default of one's own was chosen once and for all.
                printer = printer.or(found.path.is_some().then(|| found.name.clone()));
                found
            }
            None => continue,
            Some(found) => {
                if kind == ProfileKind::Printer {
                    printer = Some(found.name.clone());
                }
                of_kind(found, Some(kind))?
            }
        };
        let mut below = Reading { shelf, chain: Vec::new(), layers: Vec::new() };
        below.add(default)?;
        reading.layers.splice(0..0, below.layers);
    }
    let layers = reading.layers;
    let is_printer_chosen = printer.is_some() || may_be_whole;
    let is_printer = |layer: &&Layer| layer.found.kind == Some(ProfileKind::Printer);
    let last = || layers.iter().rev().find(is_printer).map(|layer| layer.found.name.clone());
    let printer = printer.or_else(last).or_else(|| asked.last().cloned()).unwrap_or_default();
    Ok(Laid { layers, asked, printer, is_printer_chosen })
}

/// The profile if it is of this kind; a file that may be anything then is.
fn of_kind(mut found: Found, kind: Option<ProfileKind>) -> Result<Found> {
    match (found.kind, kind) {
        (Some(is), Some(wanted)) if is != wanted => {
            Err(ProfileError::OtherKind { name: found.shown, is, wanted })
        }
        (is, wanted) => {
            found.kind = is.or(wanted);
            Ok(found)
        }
    }
}

/// Reads profiles and what they inherit.
struct Reading<'a> {
    shelf: &'a Shelf,
    /// The profiles being read, each inherited by the one before.
    chain: Vec<Found>,
    layers: Vec<Layer>,
}

impl Reading<'_> {
    /// Adds what `found` inherits, then itself.
    fn add(&mut self, found: Found) -> Result<()> {
        let layer = Layer::read(found.clone())?;
        self.chain.push(found);
        if let Some(entry) = layer.says(INHERITS) {
            let origin = ValueOrigin::File { name: layer.found.shown.clone(), line: entry.line };
            for parent in names(INHERITS, &entry.value, &origin)? {
                self.inherit(parent, &layer.found, &origin)?;
            }
        }
        self.chain.pop();
        self.layers.push(layer);
        Ok(())
    }

    fn inherit(&mut self, name: &str, heir: &Found, origin: &ValueOrigin) -> Result<()> {
        // A profile may stand in front of another of its name, and inherit that one.
        let parent = self
            .shelf
            .find(name, folder(heir), |found| found.is_same(heir))
            .map_err(|source| named(INHERITS, origin, source))?;
        if let Some(start) = self.chain.iter().position(|one| one.is_same(&parent)) {
            let files = self.chain[start..].iter().chain([&parent]).map(|one| one.shown.clone());
            return Err(ProfileError::Circle { origin: origin.clone(), files: files.collect() });
        }
        self.add(parent)
    }

    /// The profile of this kind that the last layer which says one names.
    fn default_of(&self, kind: ProfileKind) -> Result<Option<Found>> {
        let key = format!("defaults.{kind}");
        let said = self.layers.iter().rev().find_map(|layer| Some((layer, layer.says(&key)?)));
        let Some((layer, entry)) = said else { return Ok(None) };
        let origin = ValueOrigin::File { name: layer.found.shown.clone(), line: entry.line };
        let name = entry.value.as_str().ok_or_else(|| not_a_name(&key, &origin))?;
        let found = self.shelf.find(name, folder(&layer.found), |_| false);
        found.map(Some).map_err(|source| named(&key, &origin, source))
    }
}

/// The folder in which a profile's own files are looked for.
fn folder(of: &Found) -> Option<&Path> {
    of.path.as_deref().and_then(Path::parent)
}

/// One name, or a list of them.
fn names<'a>(key: &str, value: &'a Value, origin: &ValueOrigin) -> Result<Vec<&'a str>> {
    let list = match value {
        Value::Array(list) => list.iter().map(Value::as_str).collect(),
        one => one.as_str().map(|name| vec![name]),
    };
    list.ok_or_else(|| not_a_name(key, origin))
}

fn not_a_name(key: &str, origin: &ValueOrigin) -> ProfileError {
    ProfileError::NoName { origin: origin.clone(), key: key.to_owned() }
}

fn named(key: &str, origin: &ValueOrigin, source: ProfileError) -> ProfileError {
    ProfileError::Named { origin: origin.clone(), key: key.to_owned(), source: Box::new(source) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::profile::{Profile, load, load_from};
    use std::fs;

    fn of(wanted: &[Wanted]) -> Profile {
        load_from(&Shelf::default(), wanted, &[]).unwrap()
    }

    fn names(profile: &Profile) -> Vec<&str> {
        profile.sources.list.iter().map(|source| source.name.as_str()).collect()
    }

    #[test]
    fn a_printer_alone_is_a_whole_job() {
        let profile = of(&[Wanted::any("generic-klipper")]);
        assert_eq!(names(&profile), ["standard", "pla", "generic-marlin", "generic-klipper"]);
        let nothing = of(&[]);
        assert_eq!(names(&nothing), ["one-wall", "pla-thesis", "zcube-dual"]);
        assert!(nothing.sources.asked.is_empty());
        assert_eq!(nothing.sources.to_string(), "zcube-dual");
    }

    #[test]
    fn a_material_or_a_print_replaces_the_printers_own() {
        let marlin = Wanted::of(ProfileKind::Printer, "generic-marlin");
        let petg = Wanted::of(ProfileKind::Material, "petg");
        let fine = Wanted::of(ProfileKind::Print, "fine");
        let profile = of(&[marlin, petg.clone(), fine]);
        assert_eq!(names(&profile), ["generic-marlin", "petg", "fine"]);
        assert_eq!(profile.settings.layer_height, 0.12);
        assert_eq!(profile.settings.filament.temperature, 240.0);
        // The default printer, where none is named.
        assert_eq!(names(&of(&[petg])), ["one-wall", "zcube-dual", "petg"]);
    }

    #[test]
    fn who_chose_the_printer_is_known() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| {
            fs::write(folder.path().join(name), text).unwrap();
            folder.path().join(name).to_str().unwrap().to_owned()
        };
        let mine = write("mine.toml", "inherits = \"ender-3\"\n");
        let infill = write("infill.toml", "infill = 30\n");
        for (wanted, printer, is_chosen) in [
            (vec![], "zcube-dual", false),
            (vec!["petg"], "zcube-dual", false),
            (vec!["petg", infill.as_str()], "zcube-dual", false),
            (vec!["thesis"], "zcube-dual", true),
            (vec!["ender-3", "petg"], "ender-3", true),
            (vec![mine.as_str(), "petg"], "mine.toml", true),
            (vec!["ender-3", infill.as_str()], "ender-3", true),
            (vec!["generic-marlin", "voron-2.4"], "voron-2.4", true),
        ] {
            let all: Vec<Wanted> = wanted.iter().map(|name| Wanted::any(*name)).collect();
            let sources = of(&all).sources;
            let told = (sources.printer.as_str(), sources.is_printer_chosen);
            assert_eq!(told, (printer, is_chosen), "{wanted:?}");
        }
        fs::write(folder.path().join("default.toml"), "inherits = \"ender-3\"\n").unwrap();
        let shelf = Shelf::new(vec![folder.path().to_owned()]);
        let sources = load_from(&shelf, &[Wanted::any("petg")], &[]).unwrap().sources;
        assert_eq!((sources.printer.as_str(), sources.is_printer_chosen), ("default.toml", true));
    }

    #[test]
    fn the_thesis_is_printer_material_and_rules_unless_others_are_named() {
        assert_eq!(
            names(&of(&[Wanted::any("thesis")])),
            ["pla-thesis", "zcube-dual", "one-wall", "thesis"]
        );
        let other = of(&[Wanted::any("generic-marlin"), Wanted::any("thesis")]);
        assert_eq!(names(&other), ["pla-thesis", "generic-marlin", "one-wall", "thesis"]);
    }

    #[test]
    fn a_profile_of_another_kind_is_refused() {
        let wanted = [Wanted::of(ProfileKind::Material, "fine")];
        let error = load_from(&Shelf::default(), &wanted, &[]).unwrap_err().to_string();
        assert!(error.starts_with("fine is a print, not a material;"), "{error}");
    }

    #[test]
    fn values_of_ones_own_printer_lie_over_its_default_material() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("mine.toml");
        fs::write(&file, "inherits = \"generic-marlin\"\n[filament]\ntemperature = 205\n").unwrap();
        let mine = Wanted::any(file.to_str().unwrap());
        assert_eq!(of(std::slice::from_ref(&mine)).settings.filament.temperature, 205.0);
        let petg = Wanted::of(ProfileKind::Material, "petg");
        assert_eq!(of(&[mine, petg]).settings.filament.temperature, 240.0);
    }

    #[test]
    fn several_are_inherited_and_later_ones_win() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("mine.toml");
        fs::write(&file, "inherits = [\"generic-marlin\", \"petg\", \"strong\"]\n").unwrap();
        let profile = of(&[Wanted::any(file.to_str().unwrap())]);
        assert_eq!(names(&profile), ["generic-marlin", "petg", "strong", "mine.toml"]);
        fs::write(&file, "inherits = [\"generic-marlin\", 7]\n").unwrap();
        let error = load([file.to_str().unwrap()], &[]).unwrap_err().to_string();
        assert!(error.ends_with(
            "mine.toml:1: inherits: must be the name of a profile or a file, in quotes"
        ));
        fs::write(&file, "inherits = \"generic-marlin\"\n[defaults]\nmaterial = \"pteg\"\n")
            .unwrap();
        let error = load([file.to_str().unwrap()], &[]).unwrap_err().to_string();
        assert!(
            error.contains(
                "mine.toml:3: defaults.material: unknown profile `pteg`; did you mean `petg`?"
            ),
            "{error}"
        );
    }

    #[test]
    fn shelves_are_searched_in_order_and_before_what_is_shipped() {
        let (first, second) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
        for folder in [first.path(), second.path()] {
            fs::create_dir(folder.join("materials")).unwrap();
        }
        let shelf = Shelf::new(vec![first.path().to_owned(), second.path().to_owned()]);
        let write = |folder: &tempfile::TempDir, name: &str, text: &str| {
            fs::write(folder.path().join(name), text).unwrap();
        };
        // It stands before the shipped one of its name, and inherits that.
        write(&second, "materials/petg.toml", "inherits = \"petg\"\n[filament]\ncost = 20\n");
        write(&second, "materials/mine.toml", "[filament]\ntemperature = 200\n");
        write(&first, "materials/mine.toml", "[filament]\ntemperature = 201\n");
        write(&first, "default.toml", "inherits = \"generic-marlin\"\n");
        let load = |name| load_from(&shelf, &[Wanted::any(name)], &[]).unwrap();
        let petg = load("petg").settings;
        assert_eq!((petg.filament.cost, petg.filament.temperature), (20.0, 240.0));
        assert_eq!(petg.machine.name, "Marlin printer");
        assert_eq!(load("mine").settings.filament.temperature, 201.0);
        let source = load("mine").sources.list.last().cloned().unwrap();
        assert!(source.file.unwrap().ends_with("mine.toml") && source.name == "mine");
        let listed: Vec<_> = shelf.all().into_iter().map(|found| found.name).collect();
        assert_eq!(listed.iter().filter(|name| *name == "petg" || *name == "mine").count(), 2);
    }

    #[test]
    fn lines_and_heights_follow_the_nozzle_unless_they_are_said() {
        let set = |key: &str, value: &str| crate::profile::Override {
            key: key.to_owned(),
            value: value.to_owned(),
            origin: ValueOrigin::Set,
        };
        let nozzle = set("machine.nozzle_diameter", "0.6");
        let wide = load(["generic-marlin"], std::slice::from_ref(&nozzle)).unwrap();
        let sizes = |p: &Profile| (p.settings.line_width, p.settings.layer_height);
        assert_eq!(sizes(&wide), (0.6, 0.3));
        let follows = ValueOrigin::Follows("machine.nozzle_diameter".to_owned());
        assert_eq!(wide.origins["line_width"], follows);
        let said = load(["generic-marlin"], &[nozzle, set("layer_height", "0.2")]).unwrap();
        assert_eq!(sizes(&said), (0.6, 0.2));
        assert_eq!(sizes(&load(["generic-marlin"], &[]).unwrap()), (0.4, 0.2));
    }

    #[test]
    fn a_bed_without_a_heater_stays_cold() {
        let profile = load(["witbox-1", "petg"], &[]).unwrap();
        assert_eq!(profile.settings.filament.bed_temperature, 0.0);
    }
}
