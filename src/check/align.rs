//! Print + Mesh -> Part where it was printed, and whether it is as large.

use super::against::is_of_part;
use super::extent;
use super::finding::{Code, Finding, Findings, short};
use super::part::Part;
use crate::mesh::Mesh;
use crate::reader::print::{Layer, Step};
use crate::reader::{Print, Role};

/// A model may lie so far from where it is expected and be taken as lying there, mm.
const MOST_OFF: f64 = 0.3;

/// Sizes may differ by this: outlines are rounded, and tips thinner than a line left out, mm.
const SIZE_SLACK: f64 = 0.6;

/// The model may be so many layers higher or lower.
const HEIGHT_SLACK: f64 = 1.01;

/// How the lines of a layer lie to the model's cut: middle to middle, and larger in x and y, mm.
#[derive(Debug, Clone, Copy)]
struct Off {
    middle: [f64; 2],
    size: [f64; 2],
}

/// The model cut at the print's layers, where the lines lie. `expected` is where its middle was put.
/// `None` if the two cannot be held against each other; a finding or note says why.
pub(super) fn place(
    print: &Print,
    mesh: &Mesh,
    expected: [f64; 2],
    has_roles: bool,
    (found, notes): (&mut Findings, &mut Vec<String>),
) -> Option<Part> {
    let heights: Vec<(f64, f64)> =
        print.layers.iter().map(|layer| (layer.z, layer.height)).collect();
    let mut part = match Part::new(mesh, expected, &heights) {
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
    let offs: Vec<Off> = print
        .layers
        .iter()
        .enumerate()
        .filter_map(|(index, layer)| off(print, layer, part.extent_of(index)?, has_roles))
        .collect();
    if offs.is_empty() {
        notes.push("the part: no layer of it has both an outline and lines".to_owned());
        return None;
    }
    let by = [0, 1].map(|axis| median(offs.iter().map(|off| off.middle[axis])));
    if by.iter().any(|by| by.abs() > MOST_OFF) {
        let [x, y] = [0, 1].map(|axis| short(expected[axis] + by[axis]));
        notes.push(format!("where on the bed the part lies: its middle is at x {x} y {y}"));
        part.shift(by);
    }
    let is_same = sizes(&offs, found) & height(print, &part, found);
    if !is_same {
        notes.push(
            "the part's surfaces: it has another size (see --scale, --rotate, --unit)".into(),
        );
    }
    is_same.then_some(part)
}

/// How a layer's lines lie to the model's cut, by their extents.
fn off(
    print: &Print,
    layer: &Layer,
    (low, high): ([f64; 2], [f64; 2]),
    has_roles: bool,
) -> Option<Off> {
    let steps = print.moves_of(layer);
    let outlines = |step: &&Step| step.is_line() && step.role == Role::OuterWall;
    let any = |step: &&Step| is_of_part(step, has_roles);
    let walls = extent(steps.iter().filter(outlines));
    let (from, to) = walls.or_else(|| extent(steps.iter().filter(any)))?;
    Some(Off {
        middle: [0, 1].map(|axis| (from[axis] + to[axis] - low[axis] - high[axis]) / 2.0),
        size: [0, 1].map(|axis| (to[axis] - from[axis]) - (high[axis] - low[axis])),
    })
}

/// Whether the layers are as wide and deep as the model.
fn sizes(offs: &[Off], found: &mut Findings) -> bool {
    let mut fits = true;
    for axis in 0..2 {
        let larger = median(offs.iter().map(|off| off.size[axis]));
        if larger.abs() > SIZE_SLACK {
            fits = false;
            let name = ["x", "y"][axis];
            found.add(of_size(name, larger));
        }
    }
    fits
}

fn height(print: &Print, part: &Part, found: &mut Findings) -> bool {
    let Some(last) = print.layers.last() else { return true };
    let higher = last.z - part.height();
    // Layers are rounded to whole ones at the top.
    if higher.abs() <= HEIGHT_SLACK * last.height {
        return true;
    }
    found.add(of_size("z", higher));
    false
}

fn of_size(axis: &str, larger: f64) -> Finding {
    let than = if larger > 0.0 { "larger" } else { "smaller" };
    let text = format!("the print is {} mm {than} in {axis} than the part", short(larger.abs()));
    Finding::of(Code::WrongSize, larger.abs(), "mm", text)
}

/// The middle one; 0 of none.
fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    let middle = values.len() / 2;
    if values.is_empty() {
        return 0.0;
    }
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}
