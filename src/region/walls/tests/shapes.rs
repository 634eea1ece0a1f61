//! Stars, triangles and letters -> walls: no place stays open that a bead has room for.

use super::*;

/// A star of `rays` bars of this `width` that meet in the middle, the tips `reach` away from there.
fn star(rays: u32, width: f64, reach: f64, degrees: f64) -> Vec<Contour> {
    let ray = |k: u32| {
        let turn = degrees + 360.0 * f64::from(k) / f64::from(rays);
        let (l, a) = (reach, width / 2.0);
        [(0.0, -a), (l, -a), (l, a), (0.0, a)].map(|(x, y)| at(x, y, turn)).to_vec()
    };
    polygon::union(&(0..rays).map(ray).collect::<Vec<_>>())
}

/// The letter M, `height` high, of strokes of this `width`.
fn letter_m(width: f64, height: f64, degrees: f64) -> Vec<Contour> {
    let (l, r) = (-height / 2.0, height / 2.0);
    let corners = [
        (l, l),
        (l + width, l),
        (l + width, r - 1.6 * width),
        (0.0, -0.5 * width),
        (r - width, r - 1.6 * width),
        (r - width, l),
        (r, l),
        (r, r),
        (r - width, r),
        (0.0, width),
        (l + width, r),
        (l, r),
    ];
    polygon::union(&[corners.map(|(x, y)| at(x, y, degrees)).to_vec()])
}

/// A triangle with the angles `a` and `b`, around a circle with this diameter.
fn triangle(size: f64, a: f64, b: f64, degrees: f64) -> Vec<Contour> {
    let tan = |x: f64| {
        let (sin, cos) = sin_cos(x / 2.0);
        size / 2.0 / (sin / cos)
    };
    let (left, right) = (tan(a), tan(b));
    let (sin, cos) = sin_cos(a);
    let side = left + tan(180.0 - a - b);
    let corners = [(-left, 0.0), (right, 0.0), (-left + side * cos, side * sin)];
    vec![corners.map(|(x, y)| at(x, y - size / 2.0, degrees)).to_vec()]
}

/// As [`params`] with a nozzle of this size, mm, and lines as wide.
fn params_of(count: u32, nozzle: f64) -> WallParams {
    let builder = profile::Profile::builder("generic-marlin");
    let builder = builder.set("machine.nozzle_diameter", nozzle).set("line_width", nozzle);
    let mut settings = builder.load().unwrap().settings;
    settings.walls = count;
    RegionParams::new(&settings).walls
}

/// As [`made`], with the width of each bead.
fn made_of(contours: &[Contour], params: &WallParams) -> Walls {
    let mut made = made(contours, params);
    let plain = made.walls.iter_mut().filter(|wall| wall.widths.is_empty());
    plain.for_each(|wall| wall.widths = vec![params.line_width; wall.path.len()]);
    made
}

/// The round ends of beads over solid, both as areas.
fn ends(contours: &[Contour], walls: &[Wall]) -> f64 {
    let solid: f64 = contours.iter().map(|c| double_area(c) as f64 / 2.0).sum();
    let open = walls.iter().filter(|wall| !wall.closed).map(|wall| &wall.widths);
    open.flat_map(|w| [w[0], w[w.len() - 1]])
        .map(|w| f64::from(w).powi(2) * std::f64::consts::PI / 8.0)
        .sum::<f64>()
        / solid
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, ..ProptestConfig::default() })]

    #[test]
    fn stars_have_no_hole_where_their_rays_meet(
        count in 1..=3_u32,
        nozzle in prop::sample::select(vec![0.4, 0.6]),
        rays in 3..10_u32,
        width in 1.0..6.5,
        degrees in 0.0..90.0,
    ) {
        let params = params_of(count, nozzle);
        let star = star(rays, width * nozzle * 1e4, 60_000.0, degrees);
        let made = made_of(&star, &params);
        prop_assume!(made.core.is_some());
        let hole = hole(&star, &made);
        prop_assert!(hole < 0.8 * f64::from(params.line_width), "{hole}");
    }

    #[test]
    fn small_shapes_are_full(
        count in 1..=3_u32,
        nozzle in prop::sample::select(vec![0.4, 0.6]),
        kind in 0..4_u32,
        size in 0.9..5.0_f64,
        (a, b) in (20.0..75.0, 20.0..75.0),
        degrees in 0.0..360.0,
    ) {
        let params = params_of(count, nozzle);
        let unit = nozzle * 1e4;
        let shape = match kind {
            0 => triangle(size * unit, a, b, degrees),
            1 => star(a as u32 / 10 + 1, (0.3 * size).max(0.9) * unit, 1.2 * size * unit, degrees),
            2 => letter_m(0.25 * size * unit, 1.2 * size * unit, degrees),
            _ => vec![pin(size * unit, 4, degrees, b / 20.0).remove(0)],
        };
        let narrow = nearest(params.narrowest / 2.0) as Coord;
        prop_assume!(!polygon::inset(&shape, narrow).is_empty());
        let made = made_of(&shape, &params);
        prop_assume!(made.core.is_some());
        let hole = hole(&shape, &made);
        prop_assert!(hole < 0.8 * f64::from(params.line_width), "{hole}");
        // Beads of many rays lie on one another; one in a pointed corner leaves others open.
        if kind != 1 && made.core.is_some_and(|core| core.is_empty()) {
            let most = filled(&shape, &made.walls);
            let least = most + ends(&shape, &made.walls);
            prop_assert!(most < 1.15 && least > 0.6, "{most} {least}");
        }
    }
}

#[test]
fn what_one_island_has_too_much_makes_up_for_nothing_that_another_lacks() {
    // Beads of the narrowest width hold more than there is room in a strip of 0.2 mm.
    let strip = |thick: f64, at: Coord| -> Contour {
        let strip = bar(thick, thick, 0.0).remove(0);
        strip.into_iter().map(|p| Point { y: p.y + at, ..p }).collect()
    };
    let made = made(&[strip(2_000.0, 0), strip(800.0, 50_000)], &params(2));
    assert_eq!(made.walls.len(), 1);
    assert!((made.lost_mm2 - 24.0 * 0.08).abs() < 0.01, "{}", made.lost_mm2);
}
