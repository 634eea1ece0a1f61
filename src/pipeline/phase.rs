//! infill_start + placed models -> the same models, moved to where raster lines lie as asked.
//!
//! Raster lines go through the origin of the mesh, which is the middle of the layout, and lie by whole
//! distances beside it. So the models are moved under them, and the offset by as much the other way: on the
//! machine nothing moves but the lines. Without the key nothing is copied.

use crate::geom::Point;
use crate::geom::frame::Frame;
use crate::mesh::place::Placed;
use crate::profile::Settings;
use crate::units::{Coord, to_mm, to_units};
use std::borrow::Cow;

/// The models with a line of the infill as far from their lowest coordinate as the settings ask for, across
/// the lines of even layers and across those of odd ones.
#[must_use]
pub fn in_phase<'a>(settings: &Settings, placed: &'a Placed) -> Cow<'a, Placed> {
    let Some(start) = settings.infill_start else { return Cow::Borrowed(placed) };
    let frame = Frame::new(super::settle(settings, &placed.mesh).angle.degrees());
    let corner = |&[x, y, _]: &[Coord; 3]| frame.enter(Point { x, y });
    let lower = |a: Point, b: Point| Point { x: a.x.min(b.x), y: a.y.min(b.y) };
    let Some(low) = placed.mesh.vertices.iter().map(corner).reduce(lower) else {
        return Cow::Borrowed(placed);
    };
    // Lines of the other direction lie across u, so that both directions take one step.
    let first = |low: Coord| low.saturating_add(to_units(start));
    let by = frame.leave(Point { x: -first(low.x), y: -first(low.y) });
    let mut placed = placed.clone();
    let moved = |at: Point| Point { x: at.x + by.x, y: at.y + by.y };
    for [x, y, _] in &mut placed.mesh.vertices {
        (*x, *y) = (*x + by.x, *y + by.y);
    }
    placed.bodies.iter_mut().flatten().for_each(|corner| *corner = moved(*corner));
    placed.middle = moved(placed.middle);
    placed.offset = [placed.offset[0] - to_mm(by.x), placed.offset[1] - to_mm(by.y)];
    Cow::Owned(placed)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Mesh;
    use crate::profile::Profile;

    /// A box of 50 by 20 mm about the middle, and settings with these values.
    fn of(set: &[(&str, &str)]) -> (Settings, Placed) {
        let given = Profile::builder("generic-marlin");
        let given = set.iter().fold(given, |given, (key, value)| given.set(*key, *value));
        let settings = given.load().unwrap().settings;
        let [x, y] = [250_000, 100_000];
        let vertices = vec![[-x, -y, 0], [x, -y, 0], [x, y, 0], [-x, y, 0]];
        let bodies = vec![[Point { x: -x, y: -y }, Point { x, y }]];
        let mesh = Mesh { vertices, triangles: vec![[0, 1, 2], [0, 2, 3]] };
        (settings, Placed { mesh, bodies, offset: [100.0, 80.0], ..Placed::default() })
    }

    #[test]
    fn without_the_key_nothing_is_moved() {
        let (settings, placed) = of(&[]);
        assert!(matches!(in_phase(&settings, &placed), Cow::Borrowed(_)));
    }

    #[test]
    fn a_line_lies_so_far_from_the_lowest_coordinate_in_both_directions() {
        let (settings, placed) = of(&[("infill_start", "3"), ("angle", "0")]);
        let moved = in_phase(&settings, &placed);
        // The lines through the origin are 3 mm inside the left and the front.
        assert_eq!(moved.mesh.vertices[0], [-30_000, -30_000, 0]);
        assert_eq!(moved.bodies[0][1], Point { x: 470_000, y: 170_000 });
        // On the machine all of it lies where it was.
        assert_eq!(moved.offset.map(to_units), [780_000, 730_000]);
        assert_eq!(moved.middle, Point { x: 220_000, y: 70_000 });
    }

    #[test]
    fn the_lowest_coordinate_is_that_across_the_lines() {
        let (settings, placed) = of(&[("infill_start", "1.5"), ("angle", "30")]);
        let moved = in_phase(&settings, &placed);
        let frame = Frame::new(30.0);
        let corners = moved.mesh.vertices.iter().map(|&[x, y, _]| frame.enter(Point { x, y }));
        let low = corners.reduce(|a, b| Point { x: a.x.min(b.x), y: a.y.min(b.y) }).unwrap();
        assert!((low.x + 15_000).abs() <= 2 && (low.y + 15_000).abs() <= 2, "{low:?}");
    }
}
