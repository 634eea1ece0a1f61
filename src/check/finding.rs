//! Finding: what is wrong with a file, where, and by how much.
//!
//! Each finding has a code, a place as far as it is known, a measure with its unit, and a text. Of each
//! code the findings with the largest measures are listed, at most [`MOST_LISTED`], and all are
//! counted: a wrong file has thousands, and the first hundred show what is wrong. Of moves, which may be
//! millions, so many are kept and the rest counted.
//!
//! Most are errors: the print would fail, or is not the part. A *warning* is a weak place of a print
//! that can be made: it fails no run.
//!
//! A place has the line of the file and the layer, both from 1, and x, y and z in the machine's
//! coordinates, so that one finds it in the file and in a preview.
//!
//! Codes, their names and the JSON fields are stable: scripts match on them. A new code is a line in
//! [`Code`], in [`Code::ALL`] and in [`Code::name`], in the order of severity: what harms the machine
//! first, then what spoils the print, then what is wrong with the shape.

use schemars::JsonSchema;
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt;

/// Findings of a kind that are listed; the rest are only counted.
pub const MOST_LISTED: usize = 100;

/// Findings of a kind that are kept while a file is read.
const MOST_KEPT: usize = 1000;

/// Kinds of findings. Their names are stable.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Code {
    /// A command that the machine's firmware does not know.
    UnknownCode,
    /// A word of a command has no number where it needs one, as where a placeholder was not filled in.
    MissingNumber,
    /// The print begins before the machine knows where its axes are.
    NotHomed,
    /// A line or travel leaves the space that the machine has.
    OutsideVolume,
    /// A travel goes below what stands, and through it, by the nozzle's flat end.
    ThroughPrint,
    /// Part of the head runs into plastic that stands, deeper than it may press.
    HeadHits,
    /// A command in the print changes what the commands after it do: where 0 is, how far a motor turns,
    /// how much is pushed out, how hot it is; or it stops the print.
    ChangesTheMachine,
    /// The nozzle or the bed is set to what the material does not take, or no machine.
    WrongTemperature,
    /// Plastic is pushed out before the nozzle is set to a temperature and waited for.
    ColdExtrusion,
    /// A heater is still on when the file ends.
    LeftOn,
    /// A move is faster than the machine's axes.
    TooFast,
    /// A move needs more steps a second than a motor makes.
    TooManySteps,
    /// Plastic goes faster than the hot end melts it.
    TooMuchFlow,
    /// A line is printed with the filament pulled back, or it is pulled back twice.
    UnpairedRetraction,
    /// A line takes far more or less plastic than others of its role and size.
    OddBead,
    /// A layer lies lower than one before it, or a line in what layers before have printed.
    FallingZ,
    /// Lines have nothing under them and hang on nothing.
    InTheAir,
    /// A body, or an island of one, begins above what is printed below. An error where nothing of
    /// the whole body ever stands, else a warning.
    Floating,
    /// A line over nothing with a free end, or parallel to what it should rest on.
    Unanchored,
    /// A line lies on a line of the same layer.
    PrintedTwice,
    /// The last skin of a patch leaves a place of it open.
    UncoveredSkin,
    /// A patch takes more plastic at a place than there is room on what it lies on.
    DoubleSkin,
    /// Walls and skins take more plastic at a place than they have room.
    Overfilled,
    /// Walls and skins leave room open at a place, or fill it too thinly.
    Underfilled,
    /// A line is much narrower than the nozzle.
    NarrowBead,
    /// A piece of support is too high for its width.
    SlenderSupport,
    /// The sparse infill hardly touches the walls.
    LooseInfill,
    /// The file's own sums of filament or layers are wrong.
    WrongSums,
    /// A patch of non-planar skin has no end, or its number comes twice.
    WrongMarks,
    /// The print is larger or smaller than the part.
    WrongSize,
    /// Something of the part's outline is not printed.
    OpenOutline,
    /// Something of a top or bottom surface is not printed.
    OpenSurface,
    /// Lines of the part lie outside it.
    OutsidePart,
    /// The sparse infill is denser or thinner than asked for, or missing.
    WrongInfill,
    /// Walls and skins take more or less plastic than they have room.
    WrongVolume,
}

impl Code {
    /// All of them.
    pub const ALL: [Self; 35] = [
        Self::UnknownCode,
        Self::MissingNumber,
        Self::NotHomed,
        Self::OutsideVolume,
        Self::ThroughPrint,
        Self::HeadHits,
        Self::ChangesTheMachine,
        Self::WrongTemperature,
        Self::ColdExtrusion,
        Self::LeftOn,
        Self::TooFast,
        Self::TooManySteps,
        Self::TooMuchFlow,
        Self::UnpairedRetraction,
        Self::OddBead,
        Self::FallingZ,
        Self::InTheAir,
        Self::Floating,
        Self::Unanchored,
        Self::PrintedTwice,
        Self::UncoveredSkin,
        Self::DoubleSkin,
        Self::Overfilled,
        Self::Underfilled,
        Self::NarrowBead,
        Self::SlenderSupport,
        Self::LooseInfill,
        Self::WrongSums,
        Self::WrongMarks,
        Self::WrongSize,
        Self::OpenOutline,
        Self::OpenSurface,
        Self::OutsidePart,
        Self::WrongInfill,
        Self::WrongVolume,
    ];

    /// Its stable name.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::UnknownCode => "unknown-code",
            Self::MissingNumber => "missing-number",
            Self::NotHomed => "not-homed",
            Self::OutsideVolume => "outside-volume",
            Self::ThroughPrint => "through-print",
            Self::HeadHits => "head-hits",
            Self::ChangesTheMachine => "changes-the-machine",
            Self::WrongTemperature => "wrong-temperature",
            Self::ColdExtrusion => "cold-extrusion",
            Self::LeftOn => "left-on",
            Self::TooFast => "too-fast",
            Self::TooManySteps => "too-many-steps",
            Self::TooMuchFlow => "too-much-flow",
            Self::UnpairedRetraction => "unpaired-retraction",
            Self::OddBead => "odd-bead",
            Self::FallingZ => "falling-z",
            Self::InTheAir => "in-the-air",
            Self::Floating => "floating",
            Self::Unanchored => "unanchored",
            Self::PrintedTwice => "printed-twice",
            Self::UncoveredSkin => "uncovered-skin",
            Self::DoubleSkin => "double-skin",
            Self::Overfilled => "overfilled",
            Self::Underfilled => "underfilled",
            Self::NarrowBead => "narrow-bead",
            Self::SlenderSupport => "slender-support",
            Self::LooseInfill => "loose-infill",
            Self::WrongSums => "wrong-sums",
            Self::WrongMarks => "wrong-marks",
            Self::WrongSize => "wrong-size",
            Self::OpenOutline => "open-outline",
            Self::OpenSurface => "open-surface",
            Self::OutsidePart => "outside-part",
            Self::WrongInfill => "wrong-infill",
            Self::WrongVolume => "wrong-volume",
        }
    }
}

/// How bad a finding is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Severity {
    /// The print fails, or is not the part.
    Error,
    /// A weak place; the print can be made.
    Warning,
}

/// Where something is.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, JsonSchema)]
pub struct Place {
    /// Line of the file, from 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub line: Option<u64>,
    /// Layer, from 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub layer: Option<usize>,
    /// Height of the layer's top, or of the nozzle, mm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub z_mm: Option<f64>,
    /// In the machine's coordinates, mm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub at_mm: Option<[f64; 2]>,
}

/// Something that is wrong.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Finding {
    /// Its kind.
    pub code: Code,
    /// How bad it is.
    pub severity: Severity,
    /// Where it is.
    #[serde(flatten)]
    pub place: Place,
    /// How much, in `unit`.
    pub measure: f64,
    /// Unit of `measure`, such as `mm²`.
    pub unit: &'static str,
    /// What it is, for people: without place and code.
    pub text: String,
}

impl Finding {
    /// An error whose place is filled in later.
    pub(super) fn of(code: Code, measure: f64, unit: &'static str, text: String) -> Self {
        let (severity, place) = (Severity::Error, Place::default());
        Self { code, severity, place, measure, unit, text }
    }

    /// A warning whose place is filled in later.
    pub(super) fn warning(code: Code, measure: f64, unit: &'static str, text: String) -> Self {
        Self { severity: Severity::Warning, ..Self::of(code, measure, unit, text) }
    }

    /// The same at a place.
    pub(super) fn at(self, place: Place) -> Self {
        Self { place, ..self }
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let kind = if self.severity == Severity::Warning { "warning: " } else { "" };
        write!(f, "{kind}{}: {}{}", self.code.name(), self.place, self.text)
    }
}

impl fmt::Display for Place {
    /// `line 7, layer 3 at 0.6 mm, x 10.5 y 20.25: `, as far as it is known.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut parts = Vec::new();
        parts.extend(self.line.map(|line| format!("line {line}")));
        parts.extend(match (self.layer, self.z_mm) {
            (Some(layer), Some(z)) => Some(format!("layer {layer} at {} mm", short(z))),
            (Some(layer), None) => Some(format!("layer {layer}")),
            (None, Some(z)) => Some(format!("{} mm up", short(z))),
            (None, None) => None,
        });
        parts.extend(self.at_mm.map(|[x, y]| format!("x {} y {}", short(x), short(y))));
        if parts.is_empty() { Ok(()) } else { write!(f, "{}: ", parts.join(", ")) }
    }
}

/// A length to the hundredth.
pub(super) fn short(mm: f64) -> f64 {
    let rounded = (mm * 100.0).round() / 100.0;
    // No minus before a zero.
    if rounded == 0.0 { 0.0 } else { rounded }
}

/// Findings in the order in which they are met; of each kind the largest are kept.
#[derive(Debug, Clone, Default)]
pub(super) struct Findings {
    found: Vec<Finding>,
    /// How many were only counted.
    counted: BTreeMap<(Code, Severity), usize>,
}

impl Findings {
    pub(super) fn add(&mut self, finding: Finding) {
        self.found.push(finding);
    }

    /// How many there are.
    pub(super) fn len(&self) -> usize {
        self.found.len()
    }

    /// Fills in the place of all findings from `first` on, where they have none of their own.
    pub(super) fn fill_in(&mut self, first: usize, place: Place) {
        for finding in &mut self.found[first..] {
            let own = finding.place;
            finding.place = Place {
                line: own.line.or(place.line),
                layer: own.layer.or(place.layer),
                z_mm: own.z_mm.or(place.z_mm),
                at_mm: own.at_mm.or(place.at_mm),
            };
        }
    }

    pub(super) fn extend(&mut self, findings: impl IntoIterator<Item = Finding>) {
        self.found.extend(findings);
    }

    /// Where there are many, keeps the largest of each kind and counts the rest.
    pub(super) fn bound(&mut self) {
        if self.found.len() <= 2 * MOST_KEPT {
            return;
        }
        let mut kinds: BTreeMap<(Code, Severity), Vec<usize>> = BTreeMap::new();
        for (k, one) in self.found.iter().enumerate() {
            kinds.entry((one.code, one.severity)).or_default().push(k);
        }
        let mut stays = vec![true; self.found.len()];
        for (kind, mut all) in kinds {
            // Stable: of equals the first of the file.
            all.sort_by(|a, b| self.found[*b].measure.total_cmp(&self.found[*a].measure));
            for &less in all.iter().skip(MOST_KEPT) {
                stays[less] = false;
                *self.counted.entry(kind).or_default() += 1;
            }
        }
        let mut next = stays.into_iter();
        self.found.retain(|_| next.next().unwrap_or_default());
    }

    /// The findings by kind, in each errors first and the largest first, and of how many each kind
    /// was.
    pub(super) fn sorted(mut self) -> (Vec<Finding>, Vec<Count>) {
        let by_size = |a: &Finding, b: &Finding| b.measure.total_cmp(&a.measure);
        // Stable: of equals the first of the file.
        let kind = |one: &Finding| (one.code, one.severity);
        self.found.sort_by(|a, b| kind(a).cmp(&kind(b)).then_with(|| by_size(a, b)));
        let mut counts: Vec<Count> = Vec::new();
        self.found.retain(|finding| {
            let code = finding.code;
            if counts.last().is_none_or(|last| last.code != code) {
                counts.push(Count { code, count: 0, errors: 0 });
            }
            counts.last_mut().is_some_and(|last| {
                last.count += 1;
                last.errors += usize::from(finding.severity == Severity::Error);
                last.count <= MOST_LISTED
            })
        });
        for ((code, severity), more) in self.counted {
            // Of each that was counted some are kept.
            for count in counts.iter_mut().filter(|count| count.code == code) {
                count.count += more;
                count.errors += if severity == Severity::Error { more } else { 0 };
            }
        }
        (self.found, counts)
    }
}

impl IntoIterator for Findings {
    type Item = Finding;
    type IntoIter = std::vec::IntoIter<Finding>;

    fn into_iter(self) -> Self::IntoIter {
        self.found.into_iter()
    }
}

/// How many findings of one kind there are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Count {
    /// The kind.
    pub code: Code,
    /// How many.
    pub count: usize,
    /// How many of them are errors.
    pub errors: usize,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_those_of_the_json() {
        for code in Code::ALL {
            assert_eq!(serde_json::to_value(code).unwrap(), code.name());
        }
        assert!(Code::ALL.windows(2).all(|two| two[0] < two[1]));
    }

    #[test]
    fn places_are_written_as_far_as_they_are_known() {
        let place = Place { line: Some(7), layer: Some(3), z_mm: Some(0.6), at_mm: None };
        assert_eq!(place.to_string(), "line 7, layer 3 at 0.6 mm: ");
        let place = Place { at_mm: Some([-0.001, 10.126]), ..Place::default() };
        assert_eq!(place.to_string(), "x 0 y 10.13: ");
        assert_eq!(Place::default().to_string(), "");
    }

    #[test]
    fn of_each_kind_the_largest_are_listed_and_all_counted() {
        let mut findings = Findings::default();
        for k in 0..150 {
            findings.add(Finding::of(Code::OddBead, f64::from(k), "mm", String::new()));
        }
        let (listed, counts) = findings.sorted();
        assert_eq!((listed.len(), listed[0].measure), (MOST_LISTED, 149.0));
        assert_eq!(counts, [Count { code: Code::OddBead, count: 150, errors: 150 }]);
    }

    #[test]
    fn of_many_the_largest_are_kept_and_all_counted() {
        let (mut bound, mut all) = (Findings::default(), Findings::default());
        for k in 0..12_000_u32 {
            let measure = f64::from(k.wrapping_mul(2_654_435_761) >> 20);
            let one = match k % 3 {
                0 => Finding::warning(Code::HeadHits, measure, "mm", k.to_string()),
                1 => Finding::of(Code::HeadHits, measure, "mm", k.to_string()),
                _ => Finding::of(Code::TooFast, measure, "mm", k.to_string()),
            };
            all.add(one.clone());
            bound.add(one);
            if k % 500 == 0 {
                bound.bound();
                assert!(bound.len() <= 3 * MOST_KEPT, "{}", bound.len());
            }
        }
        assert_eq!(bound.sorted(), all.sorted());
    }

    #[test]
    fn errors_of_a_kind_come_before_its_warnings() {
        let mut findings = Findings::default();
        findings.add(Finding::warning(Code::Floating, 9.0, "mm", "9 mm".to_owned()));
        findings.add(Finding::of(Code::Floating, 1.0, "mm", "1 mm".to_owned()));
        let (listed, counts) = findings.sorted();
        let texts: Vec<String> = listed.iter().map(ToString::to_string).collect();
        assert_eq!(texts, ["floating: 1 mm", "warning: floating: 9 mm"]);
        assert_eq!(counts, [Count { code: Code::Floating, count: 2, errors: 1 }]);
    }
}
