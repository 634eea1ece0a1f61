//! Print + Mesh -> Part where it was printed, and whether it is as large.
//!
//! Words: the *fit* of a print is the share of its outer walls that lie along the model's outline, or of
//! that outline along which outer walls lie, whichever is more.
//!
//! The model is cut at the print's layers. If the walls do not fit where it is expected, it is moved by
//! the usual distance between the middles of layers and cuts; the better of the two places counts. A
//! print that fits in neither is one of another model, and its size is compared. A raft lifts it.

use super::against::{PIECE, share_in};
use super::part::Part;
use super::raft;
use crate::check::Model;
use crate::check::belongs::{SOME_WIDTH, is_of_part};
use crate::check::capsule::Capsule;
use crate::check::finding::{Code, Finding, Findings, short};
use crate::check::median;
use crate::check::rows::Lattice;
use crate::check::survey::Survey;
use crate::check::terms::Terms;
use crate::geom::segment;
use crate::geom::spans::Rows;
use crate::reader::print::{Layer, Step};
use crate::reader::{Facts, Role};
use nalgebra::Vector2;

/// A model that lies within this of where it is expected is not moved, mm.
const MOST_OFF: f64 = 0.3;

/// Band around the outline in which outer walls must lie, outwards and inwards, mm: a usual wall's
/// middle lies 0.2 mm inside.
const BAND: [f64; 2] = [0.3, 0.6];

/// Share of the outer walls that must lie in that band; below it the print is taken for one of
/// another model.
const LEAST_FIT: f64 = 0.75;

/// Distance of rows for that, mm, and rows at most.
const ROWS: (f64, f64) = (0.1, 3000.0);

/// Layers above a wall of a base in which the skins over it lie, at most.
const SKINS: usize = 6;

/// Sizes that differ by less are the same, mm: a line and a half.
const SIZE_SLACK: f64 = 0.6;

/// Layers by which print and model may differ in height: one, by rounding.
const HEIGHT_SLACK: f64 = 1.01;

/// Layers above the last that are searched for something that should be printed.
const MOST_ABOVE: usize = 200;

/// What is narrower than this many lines need not be printed above the last layer: the thinnest beads
/// that slicers lay on purpose.
const LEAST_LINE: f64 = 0.85;

/// Patches of a cut that are too small to print, mm².
const LEAST_AREA: f64 = 1.0;

/// How the lines of a layer lie to the model's cut: middle to middle, and larger in x and y, mm.
#[derive(Debug, Clone, Copy)]
struct Off {
    middle: Vector2<f64>,
    size: Vector2<f64>,
}

/// What is known before the part is laid.
#[derive(Clone, Copy)]
pub(crate) struct Given<'a> {
    pub(crate) facts: &'a Facts,
    pub(crate) survey: &'a Survey,
    pub(crate) model: Model<'a>,
    pub(crate) terms: &'a Terms,
    /// Whether the file tells what its lines are for.
    pub(crate) has_roles: bool,
}

/// The model cut at the print's layers, moved to where the lines lie. `None` if the two cannot be
/// compared; a finding or note gives the reason.
pub(crate) fn place(
    given: Given<'_>,
    found: &mut Findings,
    notes: &mut Vec<String>,
) -> Option<Part> {
    let Given { facts, survey, model, has_roles, .. } = given;
    if [raft::SUPPORT, raft::RAFT].iter().any(|key| raft::is_untold(facts, key)) {
        notes.push("the part: the file has support, and does not tell which lines it is".into());
        return None;
    }
    let heights = tops(facts, survey);
    let (made, lift) = lifted(given, &heights);
    let mut part = match made {
        Ok(part) => part,
        Err(layer) => {
            notes.push(format!(
                "the part: layer {} does not lie above the one before, so that there is no one \
                 height for each",
                layer + 1
            ));
            return None;
        }
    };
    let outlines = survey.outlines.iter().enumerate();
    let offs: Vec<Off> = outlines
        .filter_map(|(index, outline)| Some(off((*outline)?, part.extent_of(index)?)))
        .collect();
    let mut fits = fit(survey, &part, has_roles);
    let usual = |of: fn(&Off) -> Vector2<f64>| {
        let axis = |axis: usize| median(offs.iter().map(|off| of(off)[axis]).collect());
        [axis(0).unwrap_or(0.0), axis(1).unwrap_or(0.0)]
    };
    let by = usual(|off| off.middle);
    if fits < 1.0 && by.iter().any(|by| by.abs() > MOST_OFF) {
        part.shift(by);
        let shifted = fit(survey, &part, has_roles);
        if shifted > fits {
            fits = shifted;
            let [x, y] = segment::along(model.offset, 1.0, by).map(short);
            notes.push(format!("where on the bed the part lies: its middle is at x {x} y {y}"));
        } else {
            part.shift(by.map(|by| -by));
        }
    }
    // A smaller print can be right where the part is too thin to print; real gaps are found with
    // the outline.
    let larger = usual(|off| off.size);
    if fits < LEAST_FIT || larger.iter().any(|by| *by > SIZE_SLACK) {
        sizes(larger, fits, found);
        notes.push(
            "the part's surfaces: it is not the model (see --scale, --rotate, --unit)".into(),
        );
        return None;
    }
    height((facts, survey), (model, lift), &part, found);
    Some(part)
}

/// Tops and heights of all layers, mm. A layer above a gap is no higher than its lines, a skin that a file
/// calls a layer is none.
fn tops(facts: &Facts, survey: &Survey) -> Vec<(f64, f64)> {
    let layers = facts.layers.iter().zip(&survey.heights).zip(&survey.is_skin);
    let of = |((layer, height), is_skin): ((&Layer, &f64), &bool)| {
        (layer.z, if *is_skin { 0.0 } else { *height })
    };
    layers.map(of).collect()
}

/// The model cut at layers of these tops and heights, as high as a raft lifts it, and how far that is, mm.
fn lifted(given: Given<'_>, heights: &[(f64, f64)]) -> (Result<Part, usize>, f64) {
    let Given { facts, survey, model, terms, has_roles } = given;
    let seen = || if has_roles { raft::lift((facts, survey), model.mesh) } else { 0.0 };
    let lift = terms.lift.unwrap_or_else(seen);
    let made = Part::new(model.mesh, (model.offset, lift), heights);
    let untold = match &made {
        Ok(part) if !has_roles && terms.lift.is_none() => raft::untold_lift((facts, survey), part),
        _ => 0.0,
    };
    if untold > 0.0 {
        return (Part::new(model.mesh, (model.offset, untold), heights), untold);
    }
    (made, lift)
}

/// What part of the outer walls lies along the model's outline, or of the outline along outer walls:
/// whichever is more. Files call inner walls that hang the same as outer ones, and leave thin places
/// without walls.
fn fit(survey: &Survey, part: &Part, has_roles: bool) -> f64 {
    let Some((low, high)) = part.extent() else { return 0.0 };
    let lattice = Lattice::new(ROWS.0, high[1] - low[1], ROWS.1);
    let mut shares = [[0.0; 2]; 2];
    for (index, moves) in &survey.looked_at {
        // A raft that nobody calls so.
        if !has_roles && part.extent_of(*index).is_none() {
            continue;
        }
        let cut = part.section(*index, lattice);
        let near = cut.along(lattice, BAND[0]);
        let mut band = cut.inside.or(&near);
        if has_roles {
            band = band.minus(&cut.inside.minus(&cut.along(lattice, BAND[1])));
        }
        let steps = moves.iter();
        let walls = || {
            let walls = |step: &&Step| step.role == Role::OuterWall || !has_roles;
            steps.clone().filter(|step| step.is_line()).filter(walls)
        };
        let skins = if has_roles { skins_over(survey, *index, lattice) } else { Rows::default() };
        let band = band.minus(&skins);
        for step in walls() {
            let length = step.length();
            let free =
                if skins.is_empty() { 1.0 } else { 1.0 - share_in(step, lattice, &skins, PIECE) };
            shares[0][0] += length * share_in(step, lattice, &band, PIECE);
            shares[0][1] += length * free;
        }
        let rim = cut.inside.and(&near);
        let walled = lattice.draw(walls().map(|step| Capsule::of(step, 1.0))).or(&skins);
        shares[1][0] += lattice.area(&rim.and(&walled));
        shares[1][1] += lattice.area(&rim);
    }
    let [of_walls, of_rim] = shares.map(|[along, all]| if all > 0.0 { along / all } else { 0.0 });
    if has_roles { of_walls.max(of_rim) } else { of_walls }
}

/// What skins cover over a layer and at its height: what is below them ends inside the model's outline.
fn skins_over(survey: &Survey, layer: usize, lattice: Lattice) -> Rows {
    let layers = survey.strays.iter().skip(layer).take(SKINS).flatten();
    let lines = layers.filter(|step| is_of_part(step, true));
    lattice.draw(lines.map(|step| Capsule::of(step, 1.0)))
}

/// How a layer's lines lie to the model's cut, by what both cover.
fn off((from, to): ([f64; 2], [f64; 2]), (low, high): ([f64; 2], [f64; 2])) -> Off {
    let [from, to, low, high] = [from, to, low, high].map(Vector2::from);
    Off { middle: (from + to - low - high) / 2.0, size: (to - from) - (high - low) }
}

/// Reports which size is wrong, or else that the shape is.
fn sizes(larger: [f64; 2], fits: f64, found: &mut Findings) {
    let before = found.len();
    for (larger, name) in larger.into_iter().zip(["x", "y"]) {
        if larger.abs() > SIZE_SLACK {
            let than = if larger > 0.0 { "larger" } else { "smaller" };
            let size = short(larger.abs());
            let text = format!("the print is {size} mm {than} in {name} than the part");
            found.add(Finding::of(Code::WrongSize, larger.abs(), "mm", text));
        }
    }
    if found.len() == before {
        let percent = short(100.0 * fits);
        let text = format!("only {percent} % of the outer walls lie along the part's outline");
        found.add(Finding::of(Code::WrongSize, percent, "%", text));
    }
}

/// Whether the print is as high as what of the model can be printed.
fn height(
    (facts, survey): (&Facts, &Survey),
    (model, lift): (Model<'_>, f64),
    part: &Part,
    found: &mut Findings,
) {
    let Some(last) = facts.layers.last() else { return };
    let top = survey.top;
    let lacks = part.height() - top;
    let mut report = |than: &str| {
        let text = format!("the print is {} mm {than} than the part", short(lacks.abs()));
        found.add(Finding::of(Code::WrongSize, lacks.abs(), "mm", text));
    };
    if lacks < -HEIGHT_SLACK * last.height {
        report("higher");
    }
    if lacks <= HEIGHT_SLACK * last.height {
        return;
    }
    // A tip that is thinner than a line is rightly left out.
    let above = ((lacks / last.height).floor() as usize).min(MOST_ABOVE);
    let layers: Vec<(f64, f64)> =
        (1..=above).map(|k| (top + k as f64 * last.height, last.height)).collect();
    let Ok(rest) = Part::new(model.mesh, (model.offset, lift), &layers) else { return };
    let Some((low, high)) = rest.extent() else { return };
    let lattice = Lattice::new(ROWS.0, high[1] - low[1], ROWS.1);
    let line = SOME_WIDTH * LEAST_LINE / 2.0;
    let area = |layer| lattice.area(&rest.section(layer, lattice).opened(lattice, line));
    if (0..above).any(|layer| area(layer) >= LEAST_AREA) {
        report("lower");
    }
}
