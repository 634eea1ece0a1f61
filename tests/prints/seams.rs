//! Solids -> where their walls begin and end: in one line, anywhere, moved inside, with a gap and a wipe.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common::gcode::WALLS;
use crate::common::solid::{circle, rectangle, star};
use crate::common::{Kind, Move, Print, Run, Solid, slice};
use proptest::prelude::*;

const ALIGNED: (&str, &str) = ("seam", "aligned");

/// A closed wall as it is printed.
struct Loop<'a> {
    beads: Vec<&'a Move>,
    /// The moves after it that lay nothing.
    after: Vec<&'a Move>,
}

impl Loop<'_> {
    fn start(&self) -> [f64; 2] {
        self.beads[0].a()
    }

    fn end(&self) -> [f64; 2] {
        self.beads[self.beads.len() - 1].b()
    }

    fn is_outer(&self) -> bool {
        self.beads.iter().any(|m| m.kind == Kind::OuterWall)
    }
}

fn apart(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// The closed walls of a layer. Walls of one kind that touch are told apart by what lies between.
fn loops(print: &Print, layer: usize) -> Vec<Loop<'_>> {
    let mut all: Vec<Loop<'_>> = Vec::new();
    let mut goes_on = false;
    for step in print.moves.iter().filter(|m| m.layer == Some(layer)) {
        let is_wall = step.is_bead() && WALLS.contains(&step.kind);
        match all.last_mut().filter(|_| goes_on) {
            Some(last) if is_wall => last.beads.push(step),
            _ if is_wall => all.push(Loop { beads: vec![step], after: Vec::new() }),
            _ => {
                if let Some(last) = all.last_mut() {
                    last.after.push(step);
                }
            }
        }
        goes_on = is_wall;
    }
    all
}

/// Where the only outer wall of each layer begins.
fn seams(print: &Print) -> Vec<[f64; 2]> {
    let seam = |k| loops(print, k).iter().find(|l| l.is_outer()).map(Loop::start);
    (0..print.layers.len()).filter_map(seam).collect()
}

/// The longest step of a seam from one layer to the next, mm.
fn longest_step(seams: &[[f64; 2]]) -> f64 {
    seams.windows(2).map(|two| apart(two[0], two[1])).fold(0.0, f64::max)
}

/// A prism that leans: by `lean` mm in x for each mm of height.
fn leaning(outline: &[[f64; 2]], height: f64, lean: f64) -> Solid {
    Solid::prism(&outline.to_vec(), 0.0, height).map(|[x, y, z]| [x + lean * z, y, z])
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(16))]

    #[test]
    fn aligned_seams_make_one_line_up_the_part(
        corners in prop::sample::select(vec![3_usize, 4, 6, 48, 160]),
        radius in 5.0..9.0_f64,
        lean in prop::sample::select(vec![0.0, 0.3, 0.7]),
        dual: bool,
    ) {
        let mode = if dual { "pair" } else { "off" };
        let solid = leaning(&circle(radius, corners), 4.0, lean);
        let run = slice(&solid.stl(), "generic-marlin", &[ALIGNED, ("dual.mode", mode)]);
        let seams = seams(&run.print);
        prop_assert_eq!(seams.len(), 20);
        // Upright sides move no seam but by rounding.
        let step = longest_step(&seams);
        prop_assert!(step < lean * 0.2 + 0.02, "{} mm", step);
    }

    #[test]
    fn aligned_seams_hide_in_corners_concave_ones_first(
        points in 4..8_usize,
        inner in 0.3..0.42_f64,
        turned in 0.0..1.0_f64,
    ) {
        let radii: Vec<f64> =
            (0..2 * points).map(|k| if k % 2 == 0 { 12.0 } else { 12.0 * inner }).collect();
        let (sin, cos) = turned.sin_cos();
        let outline: Vec<[f64; 2]> =
            star(&radii).iter().map(|[x, y]| [x * cos - y * sin, x * sin + y * cos]).collect();
        let solid = Solid::prism(&outline, 0.0, 3.0);
        let run = slice(&solid.stl(), "generic-marlin", &[ALIGNED]);
        let laid = solid.on_bed(run.middle());
        let dents: Vec<[f64; 3]> = laid.triangles.as_flattened().to_vec();
        let (low, high) = solid.extent();
        let [x, y] = run.middle();
        let centre = [x - (low[0] + high[0]) / 2.0, y - (low[1] + high[1]) / 2.0];
        for seam in seams(&run.print) {
            let corner = dents.iter().min_by(|a, b| {
                apart([a[0], a[1]], seam).total_cmp(&apart([b[0], b[1]], seam))
            }).unwrap();
            let corner = [corner[0], corner[1]];
            prop_assert!(apart(corner, seam) < 0.5, "{:?} is at no corner", seam);
            prop_assert!((apart(corner, centre) - 12.0 * inner).abs() < 0.01, "a point, no dent");
        }
    }

    #[test]
    fn every_closed_wall_ends_a_gap_before_its_beginning(
        gap in 0.05..0.6_f64,
        seam in prop::sample::select(vec!["rear", "nearest", "aligned", "random"]),
        staggered: bool,
    ) {
        let gap_mm = format!("{gap:.3}");
        let inner = if staggered { "staggered" } else { "aligned" };
        let set = [("seam", seam), ("seam_inner", inner), ("seam_gap", gap_mm.as_str())];
        let run = slice(&Solid::cuboid([0.0; 3], [12.0, 9.0, 2.0]).stl(), "generic-marlin", &set);
        for k in 0..run.print.layers.len() {
            let loops = loops(&run.print, k);
            prop_assert_eq!(loops.len(), 2);
            for one in loops {
                // Around a corner a gap is shorter as the crow flies.
                let [across, along] = [apart(one.start(), one.end()), gap];
                prop_assert!(across < along + 0.003, "{} mm instead of {}", across, along);
                prop_assert!(across > along / 1.42 - 0.003, "{} mm instead of {}", across, along);
            }
        }
    }

    #[test]
    fn staggered_seams_lie_beside_no_other(
        seam in prop::sample::select(vec!["rear", "nearest", "aligned"]),
        order in prop::sample::select(vec!["inner-first", "outer-first"]),
        round: bool,
    ) {
        let outline = if round { circle(8.0, 90) } else { rectangle([0.0; 2], [14.0, 12.0]) };
        let least = |inner: &str| {
            let set = [("seam", seam), ("wall_order", order), ("seam_inner", inner), ("walls", "3")];
            let run = slice(&Solid::prism(&outline, 0.0, 2.0).stl(), "generic-marlin", &set);
            let apart = |k: usize| {
                let mut starts: Vec<[f64; 2]> = loops(&run.print, k).iter().map(Loop::start).collect();
                if order == "inner-first" {
                    starts.reverse();
                }
                assert_eq!(starts.len(), 3);
                starts.windows(2).map(|two| apart(two[0], two[1])).fold(f64::MAX, f64::min)
            };
            (0..10).map(apart).fold(f64::MAX, f64::min)
        };
        prop_assert!(least("aligned") < 0.7);
        prop_assert!(least("staggered") > 1.0);
    }
}

/// All of a run with so many threads.
fn with_threads(solid: &Solid, seam: &str, threads: usize) -> Run {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    pool.install(|| slice(&solid.stl(), "generic-marlin", &[("seam", seam)]))
}

#[test]
fn random_seams_lie_anywhere_and_are_the_same_on_every_run() {
    let solid = Solid::cylinder(8.0, 10.0, 80);
    let run = with_threads(&solid, "random", 1);
    assert!(run.text == with_threads(&solid, "random", 4).text);
    let seams = seams(&run.print);
    let [x, y] = run.middle();
    let mut quarters = [0; 4];
    for seam in &seams {
        quarters[2 * usize::from(seam[0] > x) + usize::from(seam[1] > y)] += 1;
    }
    assert!(quarters.iter().all(|&count| count >= 3), "{quarters:?} of {}", seams.len());
    let mean = seams.windows(2).map(|two| apart(two[0], two[1])).sum::<f64>() / 49.0;
    assert!(mean > 6.0, "{mean} mm");
}

#[test]
fn aligned_seams_are_the_same_on_any_number_of_threads() {
    let solid = leaning(&star(&[9.0, 5.0, 8.0, 6.0, 9.0, 4.0]), 12.0, 0.4);
    assert!(with_threads(&solid, "aligned", 1).text == with_threads(&solid, "aligned", 3).text);
}

#[test]
fn a_line_of_seams_begins_anew_where_another_side_begins() {
    // A post with corners on a round foot, far from its edge.
    let foot = Solid::cylinder(14.0, 2.0, 90);
    let post = Solid::cuboid([-4.0, -4.0, 1.0], [4.0, 4.0, 5.0]);
    let run = slice(&foot.and(&post).stl(), "generic-marlin", &[ALIGNED]);
    let (seams, [x, y]) = (seams(&run.print), run.middle());
    assert!(longest_step(&seams[..10]) < 0.02 && longest_step(&seams[10..]) < 0.02);
    let from_corner = |[a, b]: [f64; 2]| ((a - x).abs() - 4.0).hypot((b - y).abs() - 4.0);
    assert!(from_corner(seams[12]) < 0.4, "{:?}", seams[12]);
}

#[test]
fn the_nozzle_goes_on_over_the_beginning_of_an_outer_wall() {
    let solid = Solid::cuboid([0.0; 3], [12.0, 9.0, 2.0]);
    for gap in ["0", "0.2"] {
        let set = [("seam_wipe", "1.5"), ("seam_gap", gap), ("wall_order", "outer-first")];
        let run = slice(&solid.stl(), "generic-marlin", &set);
        for k in 0..run.print.layers.len() {
            let loops = loops(&run.print, k);
            let outer = loops.iter().find(|l| l.is_outer()).unwrap();
            let (start, first) = (outer.start(), outer.beads[0].b());
            let mut way: Vec<[f64; 2]> =
                outer.after.iter().filter(|m| m.is_travel()).map(|m| m.b()).collect();
            way.retain(|p| *p != start);
            // From the seam along the first side, which is longer than the wipe.
            assert!((apart(start, way[0]) - (1.5 - gap.parse::<f64>().unwrap())).abs() < 0.01);
            let off = apart(start, way[0]) + apart(way[0], first) - apart(start, first);
            assert!(off < 0.001, "{off}");
        }
    }
}
