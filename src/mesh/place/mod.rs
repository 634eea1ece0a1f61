//! RawMesh -> Mesh: mends models and lays them out on the bed, in one mesh.
//!
//! A part is one model, scaled, turned, set down on the bed and rounded to the grid; a body is a
//! part or one of its copies. The layout is where all bodies lie; its middle is the origin of
//! the mesh, and its offset says where that is in the machine's coordinates.
//!
//! 1. `fit` refuses numbers that make no sense.
//! 2. `part` makes a part of each model, and refuses one that does not fit the bed alone.
//! 3. `room` lays the bodies' bounding boxes out in rows (`shelves`), clear of what the start block primes.
//! 4. `fit` refuses a layout that sticks out of the bed where the user wants it.
//! 5. `join` copies the parts to their places in one mesh. Half-edges are not paired again: those
//!    of a copy are its part's with other numbers.

pub mod part;
pub mod placement;

mod fit;
mod room;
pub(super) mod shelves;

use crate::geom::Point;
use crate::mesh::edges::{self, Adjacency, MAX_TRIANGLES};
use crate::mesh::faults;
use crate::mesh::{Bed, BodyReport, Error, Mesh, MeshReport, Placement, Policy, RawMesh, Result};
use crate::units::{Coord, MAX_COORDINATE_MM, sum_mm, to_mm, to_units};
use crate::warning::Warning;
use fit::{check_placement, offset};
use part::{Part, part};
use room::{Laid, Room};
use shelves::Layout;

pub use shelves::GAP_MM;

/// A model whose largest side is below this may be in another unit than mm: a part of 7 cm
/// seems to have 2.8 mm if its file is in inches, and 0.07 mm if it is in metres. A larger value
/// would warn of real small parts.
pub const TINY_MM: f64 = 3.0;

/// The models as they lie on the bed, and what was found on the way.
#[derive(Debug, Clone, Default)]
pub struct Placed {
    /// All models and copies; x and y from the middle of the layout, or from where it was moved, z from the
    /// bed.
    pub mesh: Mesh,
    /// Which half-edges of `mesh` are neighbours.
    pub adjacency: Adjacency,
    /// One for each model, in the order given; copies are not counted.
    pub reports: Vec<MeshReport>,
    /// Where the mesh's origin is, in the machine's coordinates, mm: the layout's middle, unless it was moved.
    pub offset: [f64; 2],
    /// Where the layout's middle is in the mesh, grid units: at its origin, unless it was moved.
    pub middle: Point,
    /// Size of the whole layout, mm.
    pub size_mm: [f64; 3],
    /// The lowest and the highest corner of each body, from the middle of the layout, grid units.
    pub bodies: Vec<[Point; 2]>,
    /// What a user should know.
    pub warnings: Vec<Warning>,
    /// Whether all surfaces are known to be closed and to face outward. With [`Policy::Warn`]
    /// nobody has checked which way shells face.
    pub is_sound: bool,
}

/// Places `models` on the `bed`.
///
/// Each model is scaled; turned about x, then y, then z; set down on the bed; and moved so that
/// the middle of its bounding box is at the origin. Only then are coordinates rounded to the
/// grid: a shifted file gives the same mesh, and a mirrored file the mirrored mesh, as far as its
/// numbers allow. Several models and copies are laid out in rows, with the gap asked for. Corners that
/// round to one grid point stay different vertices, so that a closed mesh stays closed.
///
/// # Errors
/// [`Error::Scale`], [`Error::NotFinite`], [`Error::NoCopies`] and [`Error::NoModel`] for a request that makes no
/// sense; those of [`part()`] for one model; [`Error::TooManyTriangles`], [`Error::BedFull`] and
/// [`Error::OffBed`] for all of them.
pub fn place(models: Vec<RawMesh>, placement: &Placement, bed: &Bed) -> Result<Placed> {
    check_placement(placement)?;
    let mut placed = Placed::default();
    let mut parts = Vec::with_capacity(models.len());
    for mut model in models {
        let part = part(&mut model, placement, bed)?;
        warn(&model.report, &mut placed.warnings);
        placed.reports.push(model.report);
        parts.push(part);
    }
    let left = placed.reports.iter().flat_map(|report| &report.left).count();
    placed.is_sound = placement.policy != Policy::Warn && left == 0;
    let Laid { layout, within, .. } = lay_out(&parts, placement, bed)?;
    let height = parts.iter().map(|part| part.size[2]).max().unwrap_or(0);
    placed.size_mm = [layout.size[0], layout.size[1], height].map(sum_mm);
    placed.offset = offset(placement, &within, [placed.size_mm[0], placed.size_mm[1]])?;
    let copies = placement.copies as usize;
    placed.bodies = bodies(&parts, &layout, copies);
    tell_places(&parts, copies, &mut placed);
    join(parts, &layout, copies, &mut placed);
    Ok(placed)
}

/// Warnings about what a model's report says.
fn warn(report: &MeshReport, warnings: &mut Vec<Warning>) {
    let file = || report.file.clone();
    if report.trailing_bytes > 0 {
        warnings.push(Warning::TrailingBytes { file: file(), count: report.trailing_bytes });
    }
    if let Some(guessed) = faults::guessed(&report.mended) {
        warnings.push(Warning::MeshMended { file: file(), what: guessed });
    }
    if let Some(left) = faults::open(&report.left) {
        warnings.push(Warning::OpenMesh { file: file(), what: left });
    }
    let size_mm = report.size_mm.into_iter().fold(0.0, f64::max);
    if size_mm < TINY_MM {
        warnings.push(Warning::TinyModel { file: file(), size_mm });
    }
}

/// Positions of all copies, model by model.
fn lay_out(parts: &[Part], placement: &Placement, bed: &Bed) -> Result<Laid> {
    let copies = placement.copies as usize;
    let models = parts.len().saturating_mul(copies);
    let bed_mm = bed.size();
    let triangles: usize = parts.iter().map(|part| part.mesh.triangles.len()).sum();
    let (triangles, most) = (triangles.saturating_mul(copies), placement.max_triangles);
    if triangles > most.min(MAX_TRIANGLES) {
        return Err(Error::TooManyTriangles { models, triangles, most });
    }
    let boxes: Vec<[i64; 2]> = parts
        .iter()
        .flat_map(|part| std::iter::repeat_n([part.size[0], part.size[1]], copies))
        .collect();
    if boxes.is_empty() {
        return Err(Error::NoModel);
    }
    let gap_mm = placement.gap.min(MAX_COORDINATE_MM);
    // Who says where they lie has them there.
    let taken = if placement.at.is_some() { &[][..] } else { &placement.taken };
    let room = Room { bed, taken, gap: i64::from(to_units(gap_mm)) };
    room.lay(&boxes).ok_or_else(|| {
        let each: Vec<[i64; 2]> = parts.iter().map(|part| [part.size[0], part.size[1]]).collect();
        let (copies_fit, models_fit) = (room.copies(&each, copies), room.first(&each));
        Error::BedFull { models, gap_mm, bed_mm, copies_fit, models_fit }
    })
}

/// Where each body lies.
fn bodies(parts: &[Part], layout: &Layout, copies: usize) -> Vec<[Point; 2]> {
    let corner = |[x, y]: [Coord; 2], size: [i64; 3], side: i64| Point {
        x: x + (side * size[0] / 2) as Coord,
        y: y + (side * size[1] / 2) as Coord,
    };
    let all = layout.middles.iter().enumerate();
    all.map(|(i, &at)| [-1, 1].map(|side| corner(at, parts[i / copies].size, side))).collect()
}

/// Tells in each model's report where its bodies lie.
fn tell_places(parts: &[Part], copies: usize, placed: &mut Placed) {
    let Placed { bodies, reports, offset, .. } = placed;
    let copies = bodies.chunks(copies.max(1));
    for ((report, part), copies) in reports.iter_mut().zip(parts).zip(copies) {
        let corner =
            |at: Point, z: i64| [offset[0] + to_mm(at.x), offset[1] + to_mm(at.y), sum_mm(z)];
        let body = |&[low, high]: &[Point; 2]| BodyReport {
            min_mm: corner(low, 0),
            max_mm: corner(high, part.size[2]),
        };
        report.bodies = copies.iter().map(body).collect();
    }
}

/// Puts all copies into one mesh.
#[expect(clippy::cast_possible_truncation, reason = "lay_out has checked the number of triangles")]
fn join(parts: Vec<Part>, layout: &Layout, copies: usize, placed: &mut Placed) {
    if let (1, [[0, 0]]) = (parts.len(), &layout.middles[..]) {
        if let Some(part) = parts.into_iter().next() {
            (placed.mesh, placed.adjacency) = (part.mesh, part.adjacency);
        }
        return;
    }
    let Placed { mesh, adjacency, .. } = placed;
    for (i, &[x, y]) in layout.middles.iter().enumerate() {
        let part = &parts[i / copies];
        let vertex = mesh.vertices.len() as u32;
        let half = edges::half_edge(mesh.triangles.len(), 0);
        let moved = |&[px, py, pz]: &[i32; 3]| [px + x, py + y, pz];
        mesh.vertices.extend(part.mesh.vertices.iter().map(moved));
        let corners = part.mesh.triangles.iter();
        mesh.triangles.extend(corners.map(|corners| corners.map(|corner| corner + vertex)));
        let shifted = |other: u32| {
            if other == edges::NONE { other } else { other + half }
        };
        let sides = part.adjacency.neighbour.iter();
        adjacency.neighbour.extend(sides.map(|sides| sides.map(shifted)));
        adjacency.unpaired += part.adjacency.unpaired;
        adjacency.non_manifold += part.adjacency.non_manifold;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Unit;
    use crate::mesh::faults::{Fault, Mending};

    const BED: Bed = Bed { min: [-100.0, -50.0], max: [100.0, 50.0], height: 80.0 };
    const PLAIN: Placement = Placement {
        sink: 0.0,
        unit: Unit::Mm,
        scale: 1.0,
        stretch: [1.0; 3],
        rotate: [0.0; 3],
        at: None,
        gap: GAP_MM,
        taken: Vec::new(),
        copies: 1,
        max_triangles: MAX_TRIANGLES,
        policy: Policy::Repair,
    };

    /// A tetrahedron with right angles at `at`.
    fn corner(at: [f32; 3], size: [f32; 3]) -> RawMesh {
        let [x, y, z] = at;
        let [a, b, c] = size;
        let vertices = vec![at, [x + a, y, z], [x, y + b, z], [x, y, z + c]];
        let triangles = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
        let report = MeshReport { file: "x.stl".to_owned(), ..MeshReport::default() };
        RawMesh { vertices, triangles, report, ..RawMesh::default() }
    }

    fn one(model: RawMesh, placement: &Placement) -> Placed {
        place(vec![model], placement, &BED).unwrap_or_else(|error| panic!("{error}"))
    }

    fn refusal(model: RawMesh, placement: &Placement) -> String {
        let error = place(vec![model], placement, &BED).expect_err("must be refused");
        let text = error.to_string();
        assert!(!text.contains('\n'), "{text}");
        text
    }

    #[test]
    fn a_model_is_centred_and_stands_on_the_bed() {
        let placed = one(corner([7.0, -3.0, -5.5], [20.0, 10.0, 5.0]), &PLAIN);
        assert_eq!(placed.mesh.vertices[0], [-100_000, -50_000, 0]);
        assert_eq!(placed.mesh.vertices[3], [-100_000, -50_000, 50_000]);
        assert_eq!((placed.offset, placed.size_mm), ([0.0, 0.0], [20.0, 10.0, 5.0]));
        let report = &placed.reports[0];
        assert_eq!((report.size_mm, report.shells), ([20.0, 10.0, 5.0], 1));
        assert!(report.found.is_empty() && report.mended.is_empty());
        assert!((report.volume_mm3 - 1000.0 / 6.0).abs() < 1e-9);
        assert!(placed.warnings.is_empty());
    }

    #[test]
    fn shifted_and_mirrored_models_give_equal_and_mirrored_meshes() {
        let model = corner([0.0; 3], [10.125, 3.5, 2.75]);
        let plain = one(model.clone(), &PLAIN).mesh.vertices;
        assert_eq!(
            one(corner([64.0, -32.0, 5.0], [10.125, 3.5, 2.75]), &PLAIN).mesh.vertices,
            plain
        );
        let mut mirrored = model;
        for [x, y, _] in &mut mirrored.vertices {
            (*x, *y) = (-*x, -*y);
        }
        let expected: Vec<_> = plain.iter().map(|&[x, y, z]| [-x, -y, z]).collect();
        assert_eq!(one(mirrored, &PLAIN).mesh.vertices, expected);
    }

    #[test]
    fn turns_go_about_x_then_y_then_z_and_are_exact_by_quarters() {
        let turned =
            |rotate| one(corner([0.0; 3], [20.0, 10.0, 6.0]), &Placement { rotate, ..PLAIN });
        assert_eq!(turned([90.0, 0.0, 0.0]).size_mm, [20.0, 6.0, 10.0]);
        assert_eq!(turned([90.0, 0.0, -270.0]).size_mm, [6.0, 20.0, 10.0]);
        let vertices = turned([90.0, 90.0, 0.0]).mesh.vertices;
        // x -> x -> -z; y -> z -> x; z -> -y -> -y.
        assert_eq!(vertices[1][2], 0);
        assert_eq!(vertices[0][2], 200_000);
        assert_eq!(vertices[2][0] - vertices[0][0], 100_000);
        assert_eq!(vertices[3][1] - vertices[0][1], -60_000);
        let volume = turned([31.0, -7.0, 200.5]).reports[0].volume_mm3;
        assert!((volume - 200.0).abs() < 0.01, "{volume}");
    }

    #[test]
    fn unit_and_scale_multiply() {
        let placement = Placement { unit: Unit::Inch, scale: 0.5, ..PLAIN };
        assert_eq!(one(corner([0.0; 3], [1.0, 2.0, 3.0]), &placement).size_mm, [12.7, 25.4, 38.1]);
    }

    #[test]
    fn copies_are_separate_closed_bodies() {
        let models = vec![corner([0.0; 3], [20.0, 10.0, 5.0]), corner([0.0; 3], [8.0, 8.0, 9.0])];
        let placement = Placement { copies: 3, ..PLAIN };
        let placed = place(models, &placement, &BED).unwrap();
        assert_eq!((placed.mesh.triangles.len(), placed.mesh.vertices.len()), (24, 24));
        assert_eq!((placed.reports.len(), placed.size_mm[2]), (2, 9.0));
        for (k, [low, high]) in placed.bodies.iter().enumerate() {
            let body = placed.reports[k / 3].bodies[k % 3];
            let at = [low, high].map(|at| [to_mm(at.x), to_mm(at.y)]);
            assert_eq!([body.min_mm, body.max_mm].map(|[x, y, _]| [x, y]), at);
            assert_eq!((body.min_mm[2], body.max_mm[2]), (0.0, [5.0, 9.0][k / 3]));
        }
        assert_eq!(
            placed.adjacency,
            edges::adjacency(&placed.mesh.vertices, &placed.mesh.triangles)
        );
        for axis in 0..2 {
            let all = placed.mesh.vertices.iter().map(|vertex| vertex[axis]);
            let (low, high) = (all.clone().min().unwrap(), all.max().unwrap());
            assert!((low + high).abs() <= 1, "{low} {high}");
            assert_eq!(sum_mm(i64::from(high - low)), placed.size_mm[axis]);
        }
    }

    #[test]
    fn a_place_is_taken_or_refused_with_the_side() {
        let model = || corner([0.0; 3], [20.0, 10.0, 5.0]);
        let at = |x, y| Placement { at: Some([x, y]), ..PLAIN };
        assert_eq!(one(model(), &at(90.0, -45.0)).offset, [90.0, -45.0]);
        let text = refusal(model(), &at(90.5, -47.0));
        assert!(text.contains("0.5 mm at the right and 2 mm at the front"), "{text}");
        assert!(text.contains("20 × 10 mm"), "{text}");
    }

    #[test]
    fn what_is_too_large_is_refused_with_a_scale_that_fits() {
        let text = refusal(corner([0.0; 3], [300.0, 10.0, 5.0]), &PLAIN);
        assert!(text.contains("300 × 10 × 5 mm") && text.contains("--scale 0.666 "), "{text}");
        assert!(refusal(corner([0.0; 3], [9.0, 9.0, 81.0]), &PLAIN).contains("higher"));
        assert!(refusal(corner([0.0; 3], [1e9, 1e9, 1e9]), &PLAIN).contains("1.0e9"));
        let huge = Placement { scale: 1e300, ..PLAIN };
        assert!(refusal(corner([0.0; 3], [1e9, 1e9, 1e9]), &huge).contains("at most 1e9"));
        let many = Placement { copies: u32::MAX, ..PLAIN };
        assert!(refusal(corner([0.0; 3], [9.0, 9.0, 9.0]), &many).contains("fewer"));
        assert!(
            refusal(corner([0.0; 3], [99.0, 9.0, 9.0]), &Placement { copies: 9, ..PLAIN })
                .contains("9 models with gaps")
        );
        let copies = |copies, side| {
            refusal(corner([0.0; 3], [side, side, 9.0]), &Placement { copies, ..PLAIN })
        };
        // Four squares of 45 mm beside each other, in two rows.
        assert!(copies(9, 45.0).contains("; --copies 8 fits"), "{}", copies(9, 45.0));
        assert!(copies(5, 90.0).contains("; --copies 2 fits"), "{}", copies(5, 90.0));
        assert!(copies(5, 100.0).contains("; --copies 1 fits"), "{}", copies(5, 100.0));
        let plate = vec![corner([0.0; 3], [90.0, 90.0, 5.0]); 3];
        let text = place(plate, &PLAIN, &BED).unwrap_err().to_string();
        assert!(text.contains("the first 2 of them do"), "{text}");
        let sunk = Placement { sink: 30.0, ..PLAIN };
        let text = refusal(corner([0.0; 3], [20.0; 3]), &sunk);
        assert!(text.contains("--sink 30 cuts off all") && text.contains("20 mm high"), "{text}");
        assert_eq!(one(corner([0.0; 3], [200.0, 100.0, 80.0]), &PLAIN).offset, [0.0, 0.0]);
    }

    #[test]
    fn what_is_flat_is_refused() {
        assert!(refusal(corner([0.0; 3], [9.0, 9.0, 0.0]), &PLAIN).contains("no height"));
        assert!(refusal(corner([0.0; 3], [0.0, 9.0, 9.0]), &PLAIN).contains("no area"));
        let mut line = corner([0.0; 3], [9.0; 3]);
        line.vertices = vec![[0.0; 3], [1.0; 3], [2.0; 3], [3.0; 3]];
        assert!(refusal(line, &PLAIN).contains("no area"));
        assert!(
            refusal(corner([0.0; 3], [9.0; 3]), &Placement { scale: 0.0, ..PLAIN })
                .contains("--scale")
        );
    }

    #[test]
    fn findings_become_warnings() {
        let mut model = corner([0.0; 3], [0.5, 0.25, 0.125]);
        model.triangles.push([0, 1, 2]);
        model.triangles.push([0, 1, 3]);
        model.report.trailing_bytes = 3;
        let placed = one(model.clone(), &Placement { policy: Policy::Warn, ..PLAIN });
        let file = || "x.stl".to_owned();
        assert_eq!(placed.reports[0].left[0].kind, Fault::CrowdedEdge);
        let tiny = Warning::TinyModel { file: file(), size_mm: 0.5 };
        assert_eq!(
            placed.warnings,
            [Warning::TrailingBytes { file: file(), count: 3 }, tiny.clone()]
        );
        // Mended, as a matter of form.
        let placed = one(model, &PLAIN);
        assert_eq!(placed.warnings.last(), Some(&tiny));
        let mended = &placed.reports[0].mended[..];
        assert_eq!((mended[0].kind, mended[0].count), (Mending::DroppedDuplicate, 2));
        assert_eq!(placed.mesh.triangles.len(), 4);
    }
}
