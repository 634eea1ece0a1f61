//! Random shapes -> laws: tests every stage against brute force, another library and sums.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common::solid::{Outline, circle, star};
use crate::common::stack::{contour, contours, stack, stacks, stars};
use crate::common::{Kind, Section, Solid, as_it_is, settings, slice};
use i_overlay::mesh::float::outline::offset::OutlineOffset;
use i_overlay::mesh::float::style::{LineJoin, OutlineStyle};
use proptest::prelude::*;
use slicer::geom::frame::Frame;
use slicer::geom::polyline::{LinePoint, Polyline};
use slicer::geom::raster::Raster;
use slicer::geom::spans::{Rows, Span, total};
use slicer::geom::{Contour, Point, double_area, edges, polygon};
use slicer::mesh::{Bed, place, read};
use slicer::region::RegionParams;
use slicer::region::classify::Areas;
use slicer::region::divide::{Divided, divide, examine};
use slicer::region::per_raster::skin_turn;
use slicer::region::scan::{Scan, around};
use slicer::slice::{Heights, Layer, Slicer};
use slicer::units::{Coord, UNITS_PER_MM, to_units};

/// The contours in grid units, for brute force.
fn section(contours: &[Contour]) -> Section {
    let number = |p: Point| [f64::from(p.x), f64::from(p.y)];
    let edges = |c: &Contour| -> Vec<_> {
        c.iter().zip(c.iter().cycle().skip(1)).map(|(a, b)| (number(*a), number(*b))).collect()
    };
    Section::from_edges(contours.iter().flat_map(edges).collect())
}

/// How often `contours` wind around `p`, by the sum of the angles they are seen under.
fn winding_by_angles(contours: &[Contour], p: [f64; 2]) -> i64 {
    let angle = |q: &Point| (f64::from(q.y) - p[1]).atan2(f64::from(q.x) - p[0]);
    let tau = std::f64::consts::TAU;
    let turn = |a: &Point, b: &Point| {
        let d = angle(b) - angle(a);
        d - (d / tau).round() * tau
    };
    let sum: f64 = contours
        .iter()
        .flat_map(|c| c.iter().zip(c.iter().cycle().skip(1)))
        .map(|(a, b)| turn(a, b))
        .sum();
    (sum / tau).round() as i64
}

fn holds(row: &[Span], u: Coord) -> bool {
    row.iter().any(|s| s.start <= u && u < s.end)
}

fn is_tidy(rows: &Rows) -> bool {
    rows.iter().all(|(_, row)| {
        row.iter().all(|s| s.start < s.end) && row.windows(2).all(|w| w[0].end <= w[1].start)
    })
}

/// Rows compared without the empty ones around them.
fn spans(rows: &Rows) -> Vec<(i32, Vec<Span>)> {
    rows.iter().filter(|(_, row)| !row.is_empty()).map(|(j, row)| (j, row.to_vec())).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(192))]

    #[test]
    fn inside_is_where_the_contours_wind(
        outlines in prop::collection::vec(stars(), 1..4), joined: bool, degrees in 0.0..360.0_f64,
    ) {
        // Overlapping shells go in as they are, or joined to one outline by the union.
        let raw = contours(&outlines);
        let contours = if joined { polygon::union(&raw) } else { raw.clone() };
        let raster = Raster { frame: Frame::new(degrees), pitch: 3701 };
        let scan = Scan::new(&contours, raster);
        prop_assert!(is_tidy(scan.inside()));
        let edges = section(&raw);
        for j in -45..45 {
            for u in (-160_000..160_000).step_by(4999) {
                let at = raster.frame.leave(Point { x: u, y: j * raster.pitch });
                let p = [f64::from(at.x), f64::from(at.y)];
                // Crossings are rounded to the grid, turned corners too.
                if edges.distance(p, 4.0) >= 4.0 {
                    let is = holds(scan.inside().row(j), u);
                    prop_assert_eq!(is, winding_by_angles(&raw, p) != 0, "row {} at {}", j, u);
                }
            }
        }
    }

    #[test]
    fn inset_and_outset_keep_their_distance(
        outlines in prop::collection::vec(stars(), 1..4),
        r in 50..15_000_i32,
        spots in prop::collection::vec((-60..60_i32, -200_000..200_000_i32), 600),
    ) {
        let contours = polygon::union(&contours(&outlines));
        let raster = Raster { frame: Frame::new(0.0), pitch: 4000 };
        let scan = Scan::new(&contours, raster);
        let (inset, outset) = (scan.inset(r), scan.outset(r));
        prop_assert!(is_tidy(&inset) && is_tidy(&outset));
        let edges = section(&contours);
        let distance = f64::from(r);
        for (j, u) in spots {
            let p = [f64::from(u), f64::from(j * raster.pitch)];
            let (inside, far) = (edges.is_inside(p), edges.distance(p, 2.0 * distance + 10.0));
            if (far - distance).abs() > 1.0 && far > 1.0 {
                prop_assert_eq!(holds(inset.row(j), u), inside && far > distance, "in: {} {}", j, u);
                prop_assert_eq!(holds(outset.row(j), u), inside || far < distance, "out: {} {}", j, u);
            }
        }
    }

    #[test]
    fn an_inset_is_the_inside_without_what_is_around_any_edge(
        outlines in prop::collection::vec(stars(), 1..4), r in 50..15_000_i32, degrees in 0.0..360.0_f64,
    ) {
        let contours = polygon::union(&contours(&outlines));
        let raster = Raster { frame: Frame::new(degrees), pitch: 1777 };
        prop_assert_eq!(spans(&Scan::new(&contours, raster).inset(r)), spans(&cleared(&contours, raster, r)));
    }

    #[test]
    fn inset_and_outset_are_those_of_a_polygon_offset(
        outlines in prop::collection::vec(stars(), 1..3), r in 0.1..1.5_f64,
    ) {
        let contours = polygon::union(&contours(&outlines));
        let raster = Raster { frame: Frame::new(0.0), pitch: 4000 };
        let scan = Scan::new(&contours, raster);
        // 2 µm more and less: what the library's arcs of straight pieces are worth.
        let of_library = |by: f64| Scan::new(&library_offset(&contours, by), raster).inside().clone();
        for (is, by) in [(scan.inset(to_units(r)), -r), (scan.outset(to_units(r)), r)] {
            let (less, more) = (of_library(by - 0.002), of_library(by + 0.002));
            for j in -60..60 {
                let (low, high) = (total(less.row(j)) - 4, total(more.row(j)) + 4);
                let length = total(is.row(j));
                prop_assert!((low..=high).contains(&length), "{} row {}: {} not in {}..{}", by, j, length, low, high);
            }
        }
    }
}

/// The inside of `contours` without everything within `r` of an edge; tests every edge on all rows.
fn cleared(contours: &[Contour], raster: Raster, r: Coord) -> Rows {
    let enter = |(p, q)| (raster.frame.enter(p), raster.frame.enter(q), r);
    let all: Vec<_> = contours.iter().flat_map(|c| edges(c)).map(enter).collect();
    Scan::new(contours, raster).inside().minus(&around(&all, raster))
}

#[test]
fn insets_that_end_on_a_row_are_those_of_all_edges() {
    let raster = Raster { frame: Frame::new(0.0), pitch: 100 };
    let ring = |points: &[(Coord, Coord)]| -> Contour {
        points.iter().map(|&(x, y)| Point { x: 100 * x, y: 100 * y }).collect()
    };
    // A block with a square hole and a step, all of it on rows.
    let outside = ring(&[(0, 0), (40, 0), (40, 20), (50, 20), (50, 40), (0, 40)]);
    let hole = ring(&[(10, 10), (10, 30), (30, 30), (30, 10)]);
    for r in (50..1_200).step_by(50) {
        let contours = [outside.clone(), hole.clone()];
        let inset = Scan::new(&contours, raster).inset(r);
        assert_eq!(spans(&inset), spans(&cleared(&contours, raster, r)), "{r}");
    }
}

/// `contours` grown by `by` mm (shrunk if negative) by i_overlay, with round corners.
fn library_offset(contours: &[Contour], by: f64) -> Vec<Contour> {
    let outlines: Vec<Outline> = contours
        .iter()
        .map(|c| c.iter().map(|p| [p.x, p.y].map(|x| f64::from(x) / UNITS_PER_MM)).collect())
        .collect();
    let style = OutlineStyle::new(by).line_join(LineJoin::Round(0.03));
    // It wants holes together with what they are in; its overlay with nothing sorts that out.
    use i_overlay::core::fill_rule::FillRule;
    use i_overlay::float::simplify::SimplifyShape;
    let shapes = outlines.simplify_shape(FillRule::NonZero);
    shapes.outline(&style).iter().flatten().map(contour).collect()
}

/// Whether a place in the frame of rows, `pitch` apart, lies on one of them or less than a line beside it.
fn is_beside(at: Point, rows: &Rows, pitch: Coord) -> bool {
    let row = at.y.div_euclid(pitch);
    let near = |span: &Span| span.start - pitch <= at.x && at.x <= span.end + pitch;
    (row - 1..row + 3).any(|j| rows.row(j).iter().any(near))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    #[test]
    fn skin_and_infill_are_disjoint_and_together_the_inside_of_the_walls(
        outlines in stacks(), skins in 0..4_u32, reach in 0.0..1.0_f64,
    ) {
        let (skins, reach) = (skins.to_string(), reach.to_string());
        let set = [("skin_layers", skins.as_str()), ("skin_reach", &reach), ("pattern", "triangles")];
        let params = RegionParams::new(&settings("generic-marlin", &set));
        let layers = stack(&params, &outlines);
        let rows = &layers.rows;
        for (k, own) in layers.own.iter().enumerate() {
            let examined = examine(own, &|k| rows.get(k), &params);
            let Divided { areas, beads, room_beads, .. } = divide(
                own,
                &examined,
                params.rasters.iter(),
                &|k| rows.get(k),
                None,
                &params,
            );
            prop_assert_eq!(areas.iter().count(), params.rasters.iter().count());
            let areas_of = &areas;
            for (raster, areas) in areas_of.iter() {
                let Areas { skin, infill, fill, dense } = areas;
                let infill = &infill.or(dense);
                // Beads along the walls take a part of the fill rows, or nothing.
                let whole = &rows[k].on(raster).unwrap().fill;
                prop_assert!(!beads.is_empty() || !room_beads.is_empty() || fill == whole);
                prop_assert!(fill.minus(whole).is_empty());
                prop_assert!(is_tidy(skin) && is_tidy(infill));
                prop_assert!(skin.and(infill).is_empty(), "layer {} raster {:?}", k, raster);
                let left = fill.minus(&skin.or(infill));
                // On rasters of its own infill keeps off the skin that is printed, on another one.
                let printed = params.rasters.skin(skin_turn(k).0);
                let skin = areas_of.on(printed).map(|areas| &*areas.skin).unwrap();
                if (0..2).any(|r| params.rasters.skin(r) == raster) {
                    prop_assert!(left.is_empty(), "layer {} raster {:?}", k, raster);
                }
                let middles = left.iter().flat_map(|(j, row)| row.iter().map(move |s| (j, s.start.midpoint(s.end))));
                for (j, u) in middles {
                    let at = printed.frame.enter(raster.frame.leave(Point { x: u, y: j * raster.pitch }));
                    prop_assert!(is_beside(at, skin, printed.pitch), "layer {} raster {:?} at {:?}", k, raster, at);
                }
                for n in 1..=params.skins.top {
                    // A neighbour that is not there covers nothing.
                    let above = rows.get(k + n);
                    let below = k.checked_sub(n).map(|k| &rows[k]);
                    for neighbour in [above, below] {
                        let bare = match neighbour.and_then(|rows| rows.on(raster)) {
                            Some(neighbour) => infill.minus(&neighbour.cover),
                            None => infill.clone(),
                        };
                        let longest = bare.iter().flat_map(|(_, row)| row).map(|s| s.len()).max();
                        prop_assert!(longest.unwrap_or(0) < 500, "bare infill of {:?}", longest);
                    }
                }
            }
        }
    }

    #[test]
    fn beads_along_walls_run_where_lines_may_and_keep_off_the_walls(
        outlines in stacks(), walls in 1..4_u32, profile in 0..2_usize,
    ) {
        let walls = walls.to_string();
        let profile = ["generic-marlin", "thesis"][profile];
        let params = RegionParams::new(&settings(profile, &[("walls", &walls)]));
        let layers = stack(&params, &outlines);
        for (k, own) in layers.own.iter().enumerate() {
            let beads = examine(own, &|k| layers.rows.get(k), &params).beads;
            let raster = params.rasters.skin(skin_turn(k).0);
            let scan = Scan::new(&own.layer.contours, Raster { pitch: 500, ..raster });
            for w in beads.iter().flat_map(|b| b.windows(2)) {
                let (low, high) = if w[0].v < w[1].v { (w[0], w[1]) } else { (w[1], w[0]) };
                // Half the bead, less what strips of uneven width may take. Walls of thin places
                // share the room, and lie nearer to the contour.
                let walls = if own.core.is_none() { params.walls.count } else { 1 };
                let edge = params.walls.inset_of(walls);
                let free = scan.inset((edge + w[1].width / 2).max(0));
                for j in low.v.div_euclid(500) + 1..high.v.div_euclid(500) + 1 {
                    let t = f64::from(j * 500 - low.v) / f64::from(high.v - low.v);
                    let u = low.u + (t * f64::from(high.u - low.u)) as Coord;
                    prop_assert!(holds(free.row(j), u), "layer {} at {} {}: {:?}", k, u, j * 500, w);
                }
            }
        }
    }
}

/// A blade, `length` mm long and turned by `degrees`: its walls `wide` mm apart on average
/// and each bent in its own way by up to a fifth of a millimetre.
fn blade(length: f64, wide: f64, bends: &[f64], degrees: f64) -> Outline {
    let (sine, cosine) = degrees.to_radians().sin_cos();
    let half = bends.len() / 2;
    let last = (half - 1) as f64;
    let side = |k: usize| (length * k as f64 / last, wide / 2.0);
    let below = (0..half).map(|k| (side(k).0, bends[k] - side(k).1));
    let above = (0..half).rev().map(|k| (side(k).0, bends[half + k] + side(k).1));
    let turned = |(x, y): (f64, f64)| [x * cosine - y * sine, x * sine + y * cosine];
    below.chain(above).map(turned).collect()
}

/// The longest stretch of `beads` that runs along another bead, or back along its own, with
/// their middles nearer than `apart`; grid units, in steps of 500.
fn longest_twice(beads: &[Polyline], apart: f64) -> f64 {
    const STEP: f64 = 500.0;
    let point = |p: &LinePoint| [f64::from(p.u), f64::from(p.v)];
    let segments: Vec<[[f64; 2]; 2]> =
        beads.iter().flat_map(|b| b.windows(2)).map(|w| [point(&w[0]), point(&w[1])]).collect();
    let dot = |a: [f64; 2], b: [f64; 2]| a[0] * b[0] + a[1] * b[1];
    let minus = |a: [f64; 2], b: [f64; 2]| [a[0] - b[0], a[1] - b[1]];
    let mut longest = 0.0_f64;
    for (k, &[a, b]) in segments.iter().enumerate() {
        let way = minus(b, a);
        let length = dot(way, way).sqrt();
        let mut run = 0.0;
        for n in 0..(length / STEP) as usize {
            let at = [0, 1].map(|i| a[i] + way[i] * (n as f64 + 0.5) * STEP / length);
            let beside =
                segments.iter().enumerate().filter(|(other, _)| *other != k).any(|(_, &[c, d])| {
                    let along = minus(d, c);
                    let t = dot(minus(at, c), along) / dot(along, along).max(1.0);
                    let off = minus(at, [0, 1].map(|i| c[i] + t * along[i]));
                    (0.0..=1.0).contains(&t) && dot(off, off) < apart * apart
                });
            run = if beside { run + STEP } else { 0.0 };
            longest = longest.max(run);
        }
    }
    longest
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    #[test]
    fn no_part_of_a_blade_is_filled_twice(
        length in 5.0..20.0_f64, lines in 0.5..3.0_f64, degrees in 0.0..360.0_f64, raster: bool,
        bends in (2..5_usize).prop_flat_map(|n| prop::collection::vec(-0.2..0.2_f64, 2 * n)),
    ) {
        let params = RegionParams::new(&settings("generic-marlin", &[("walls", "1")]));
        let w = f64::from(params.walls.line_width) / UNITS_PER_MM;
        // As it comes, or along the lines up to what its walls lean.
        let degrees = if raster { 45.0 } else { degrees };
        let outline = blade(length, (2.0 + lines) * w, &bends, degrees);
        let layers = stack(&params, &[vec![outline]]);
        let own = &layers.own[0];
        let beads = examine(own, &|k| layers.rows.get(k), &params).beads;
        let twice = longest_twice(&beads, f64::from(params.walls.line_width) / 2.0);
        // Two beads that come together to go on as one are this near for a short way.
        prop_assert!(twice <= 20_000.0, "{} of {:?}", twice, beads);
    }
}

/// Filament that the beads' lengths, widths and heights ask for, by role as written, mm³.
fn space(run: &crate::common::Run, kind: Kind, thick: bool) -> f64 {
    let beads = run.print.of(kind).filter(|m| run.print.is_thick(m) == thick);
    beads.map(|m| m.length() * m.width * m.height).sum()
}

const KINDS: [Kind; 9] = [
    Kind::OuterWall,
    Kind::InnerWall,
    Kind::Overhang,
    Kind::Skin,
    Kind::Bridge,
    Kind::Infill,
    Kind::Support,
    Kind::SupportInterface,
    Kind::Brim,
];

#[test]
fn filament_is_the_volume_of_the_beads() {
    for name in ["bracket.stl", "sphere_20.stl", "overhang.stl"] {
        let set =
            [("dual.mode", "pair"), ("support.enabled", "true"), ("extrusion.multiplier", "0.9")];
        let run = slice(&crate::common::fixture(name), "generic-marlin", &set);
        for kind in KINDS {
            for thick in [false, true] {
                let laid = run.print.filament(kind, thick) * run.filament_area();
                let space = 0.9 * space(&run, kind, thick);
                // Widths are annotated in steps of 0.01 mm. All lines of a zigzag have one width, so
                // that these roundings do not level out.
                let zigzag = matches!(kind, Kind::Infill | Kind::Support | Kind::SupportInterface);
                let most = if zigzag { 0.0125 } else { 0.005 };
                assert!(
                    (laid - space).abs() <= most * space,
                    "{name} {kind:?}: {laid} for {space}"
                );
            }
        }
    }
}

#[test]
fn filament_is_the_factor_times_the_length_and_thick_lines_take_twice_that() {
    let set = [("dual.mode", "pair"), ("support.enabled", "true")];
    for name in ["bracket.stl", "sphere_20.stl", "overhang.stl"] {
        let run = slice(&crate::common::fixture(name), "zcube-dual", &set);
        for m in run.print.beads().filter(|m| m.length() > 1.0 && (m.width - 0.4).abs() < 1e-9) {
            let factor = match m.kind {
                Kind::OuterWall | Kind::InnerWall | Kind::Overhang | Kind::Brim => 0.05,
                _ if run.print.is_thick(m) => 0.08,
                _ => 0.04,
            };
            let is = m.e / m.length();
            // Both are rounded, and a line may be 0.01 mm wider than annotated.
            // Lines in a zig-zag carry what its round turns save, at most 4 %, and thick ones
            // what is too short to be printed beside them, at most a twentieth.
            let off = match m.kind {
                Kind::OuterWall | Kind::InnerWall | Kind::Overhang | Kind::Brim => 0.002,
                _ if run.print.is_thick(m) => 0.093,
                _ => 0.041,
            };
            assert!((is / factor - 1.0).abs() < off, "{name} line {}: {is}, not {factor}", m.line);
        }
    }
}

#[test]
fn the_report_counts_what_the_file_holds() {
    let set = [("dual.mode", "pair"), ("support.enabled", "true")];
    for profile in ["generic-marlin", "zcube-dual"] {
        let run = slice(&crate::common::fixture("bracket.stl"), profile, &set);
        for (name, kind, thick) in [
            ("outer wall", Kind::OuterWall, false),
            ("inner wall", Kind::InnerWall, false),
            ("overhanging wall", Kind::Overhang, false),
            ("skin", Kind::Skin, false),
            ("bridge", Kind::Bridge, false),
            ("infill", Kind::Infill, false),
            ("thick infill", Kind::Infill, true),
            ("support", Kind::Support, false),
            ("support interface", Kind::SupportInterface, false),
        ] {
            // Tops are skin to who reads the file by kinds.
            let is_it = |role: &str| role == name || (name == "skin" && role == "top skin");
            let reported = run.report.roles.iter().filter(|r| is_it(&r.role));
            let (length_mm, filament_mm) =
                reported.fold((0.0, 0.0), |sum, r| (sum.0 + r.length_mm, sum.1 + r.filament_mm));
            let beads = || run.print.of(kind).filter(|m| run.print.is_thick(m) == thick);
            let length: f64 = beads().map(crate::common::Move::length).sum();
            let filament = run.print.filament(kind, thick);
            assert!((length_mm - length).abs() <= 2e-3 * length, "{name}: {length} mm");
            assert!((filament_mm - filament).abs() <= 1e-3 * filament, "{name}: {filament} mm");
        }
    }
}

/// The layers of `solid`, 0.1 mm high, simplified within `tolerance` mm.
fn layers(solid: &Solid, tolerance: f64) -> Vec<Layer> {
    let mesh = read::from_bytes("test", &solid.stl(), read::DEFAULT_MAX_TRIANGLES).unwrap();
    let bed = Bed { min: [-100.0; 2], max: [100.0; 2], height: 100.0 };
    let placed = place::place(vec![mesh], &as_it_is(), &bed).unwrap();
    assert!(placed.reports[0].left.is_empty());
    let top = placed.mesh.vertices.iter().map(|v| v[2]).max().unwrap();
    let heights = Heights::even(1000, 1000, top);
    let slicer = Slicer::new(&placed.mesh, &placed.adjacency, heights, to_units(tolerance));
    (0..slicer.blocks()).flat_map(|b| slicer.block(b)).collect()
}

/// mm².
fn area(layer: &Layer) -> f64 {
    let sum: i128 = layer.contours.iter().map(|c| double_area(c)).sum();
    sum as f64 / 2.0 / UNITS_PER_MM / UNITS_PER_MM
}

/// mm.
fn perimeter(layer: &Layer) -> f64 {
    let edges = layer.contours.iter().flat_map(|c| c.iter().zip(c.iter().cycle().skip(1)));
    edges.map(|(a, b)| a.distance(*b)).sum::<f64>() / UNITS_PER_MM
}

/// Towers of random rings, 0.8 to 4 mm apart.
fn towers() -> impl Strategy<Value = Solid> {
    let ring = |n| (prop::collection::vec(3.0..9.0_f64, n), 0.8..4.0_f64);
    (3..30_usize).prop_flat_map(move |n| prop::collection::vec(ring(n), 2..6)).prop_map(|rings| {
        let mut z = 0.0;
        let rings: Vec<_> = rings
            .iter()
            .map(|(radii, up)| {
                z += up;
                (star(radii), z)
            })
            .collect();
        Solid::tower(&rings)
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    #[test]
    fn layers_of_a_closed_mesh_have_no_gap_and_sum_to_its_volume(solid in towers()) {
        let layers = layers(&solid, 0.0);
        prop_assert!(layers.iter().all(|l| l.closed_gap == 0 && !l.contours.is_empty()));
        let sum: f64 = layers.iter().map(|l| 0.1 * area(l)).sum();
        let (low, high) = solid.extent();
        // A layer counts whole if its middle is inside: up to half a layer at the top.
        let top = Section::new(&solid, high[2] - 1e-6).area();
        let widest = layers.iter().map(area).fold(top, f64::max);
        let rest = (high[2] - low[2] - 0.1 * layers.len() as f64).abs() * widest;
        let volume = solid.volume();
        prop_assert!((sum - volume).abs() <= rest + 0.003 * volume, "{} of {}", sum, volume);
    }

    #[test]
    fn contours_are_those_of_a_plane_through_the_triangles(solid in towers()) {
        let middle = solid.on_bed([0.0; 2]);
        for layer in layers(&solid, 0.0).iter().step_by(7) {
            let z = (f64::from(layer.z) - 500.0) / UNITS_PER_MM;
            let by_hand = Section::new(&middle, z);
            prop_assert!((area(layer) - by_hand.area()).abs() < 0.05, "at {}", z);
            for p in layer.contours.iter().flatten() {
                let far = by_hand.distance([p.x, p.y].map(|x| f64::from(x) / UNITS_PER_MM), 1.0);
                prop_assert!(far < 0.001, "{} mm off at {}", far, z);
            }
        }
    }

    #[test]
    fn simplified_contours_keep_their_place_and_their_area(
        solid in towers(), corners in 30..300_usize, tolerance in 0.002..0.1_f64,
    ) {
        // A finely cornered tube beside the tower, which has much to simplify.
        let solid = solid.and(&Solid::prism(&circle(5.0, corners), 0.0, 3.0).shifted([30.0, 0.0, 0.8]));
        let (exact, simple) = (layers(&solid, 0.0), layers(&solid, tolerance));
        prop_assert_eq!(exact.len(), simple.len());
        for (exact, simple) in exact.iter().zip(&simple) {
            let bound = tolerance * perimeter(exact) + 1e-4;
            prop_assert!((area(exact) - area(simple)).abs() <= bound);
            let edges = section(&simple.contours);
            for p in exact.contours.iter().flatten() {
                let far = edges.distance([f64::from(p.x), f64::from(p.y)], 1e4) / UNITS_PER_MM;
                prop_assert!(far <= tolerance + 0.0003, "{} mm off", far);
            }
        }
    }
}

#[test]
fn simplification_takes_most_corners_of_a_fine_circle() {
    let fine = Solid::cylinder(10.0, 0.5, 2000);
    let count = |tolerance| layers(&fine, tolerance)[0].contours[0].len();
    assert!(count(0.0) >= 2000);
    assert!(count(0.01) < 200, "{}", count(0.01));
}
