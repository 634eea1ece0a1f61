//! Two halves -> SeamsOfPair: where walls begin.
//!
//! A wall is a chain of lines of one kind of wall, each beginning where the one before ends. Where
//! it begins is seen on the part, as its seam. Walls are not matched one by one: each beginning has
//! to lie near some beginning of the same kind of wall in the other file.

use super::apart::SLACK;
use super::grid::Grid;
use super::half::Half;
use super::line::{Line, seen};
use super::place::{Place, in_file};
use super::sums::Both;
use crate::reader::Role;
use schemars::JsonSchema;
use serde::Serialize;

/// What has seams.
pub(super) const WALLS: [Role; 2] = [Role::OuterWall, Role::InnerWall];

/// Where walls begin in both files.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct SeamsOfPair {
    /// The kind of wall.
    #[schemars(with = "String")]
    pub role: Role,
    /// Number of walls.
    pub walls: Both<usize>,
    /// Walls that begin farther than the tolerance from where any wall of the other file does.
    pub moved: Both<usize>,
    /// The beginning that is farthest from those of the other file; `None` if none is too far.
    pub farthest: Option<Place>,
}

/// Compares where walls of a role begin; `None` if neither file has such walls.
pub(super) fn compare(halves: Both<&Half<'_>>, role: Role, tolerance: f64) -> Option<SeamsOfPair> {
    let begins = halves.map(|half| begins(half, role));
    let walls = begins.as_ref().map(Vec::len);
    if walls.a + walls.b == 0 {
        return None;
    }
    let mut found = SeamsOfPair { role, walls, moved: Both::default(), farthest: None };
    if walls.a > 0 && walls.b > 0 {
        let reach = tolerance + SLACK;
        found.moved.a = each_far(&begins.a, &begins.b, reach, &mut |distance, own, other| {
            let line = Both { a: own.number, b: other.number };
            found.farthest = farther(found.farthest, place(halves.a, own, distance, line));
        });
        found.moved.b = each_far(&begins.b, &begins.a, reach, &mut |distance, own, other| {
            let line = Both { a: other.number, b: own.number };
            found.farthest = farther(found.farthest, place(halves.b, own, distance, line));
        });
    }
    Some(found)
}

/// Where walls of the role begin, as dots.
fn begins(half: &Half<'_>, role: Role) -> Vec<Line> {
    let mut begins = Vec::new();
    let mut goes_on = None;
    for step in half.steps {
        let is_wall = step.is_line() && step.role == role;
        if is_wall && goes_on != Some(step.from) {
            begins.push(Line::dot(seen(step.from, half.origin), step.line));
        }
        goes_on = is_wall.then_some(step.to);
    }
    begins
}

/// Calls `sink` for each that is farther than `reach` from all others, with the distance and the
/// nearest. Returns how many.
fn each_far(
    own: &[Line],
    others: &[Line],
    reach: f64,
    sink: &mut dyn FnMut(f64, &Line, &Line),
) -> usize {
    let mut grid = None;
    let mut count = 0;
    for (index, begin) in own.iter().enumerate() {
        // Mostly walls follow in the same order.
        if others.get(index).is_some_and(|other| other.distance(begin.from) <= reach) {
            continue;
        }
        let grid = grid.get_or_insert_with(|| Grid::new(others));
        let (distance, nearest) = grid.nearest(begin.from);
        if distance > reach {
            count += 1;
            sink(distance, begin, &others[nearest]);
        }
    }
    count
}

fn place(half: &Half<'_>, dot: &Line, distance_mm: f64, line: Both<u32>) -> Place {
    Place { distance_mm, at_mm: in_file(dot.from, half), line }
}

fn farther(known: Option<Place>, place: Place) -> Option<Place> {
    let is_farther = known.is_none_or(|known| place.distance_mm > known.distance_mm);
    if is_farther { Some(place) } else { known }
}
