//! Sloped solids -> prints whose skins follow the surface, read back: coverage, plastic, ways of the head, what lies below.
//!
//! The judge is [`relief`](crate::common::relief): it knows the part's top as a formula, and neither the
//! product's surfaces nor its head. Parts are 12 to 18 mm wide, so that each test takes a few seconds.
//!
//! Parts: a *wedge* of 5.7°, an *arc* of up to 13° at its ends, a *dome* of up to 16°, and a *valley*, in
//! which lines lie lower than the base at both sides.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common::relief::{Looks, Relief, look};
use crate::common::{Kind, Run, Solid, as_it_is, settings, slice, slice_with};
use slicer::mesh::Placement;

const WEDGE: Relief =
    Relief { sides: [16.0, 12.0], surface: |x, _| 2.0 + 0.1 * x, squares: [1, 1] };

const ARC: Relief = Relief {
    sides: [18.0, 12.0],
    surface: |x, _| 3.0 + (1600.0 - (x - 9.0) * (x - 9.0)).sqrt() - 40.0,
    squares: [72, 1],
};

const DOME: Relief = Relief {
    sides: [16.0, 16.0],
    surface: |x, y| 4.0 + (1600.0 - (x - 8.0).powi(2) - (y - 8.0).powi(2)).sqrt() - 40.0,
    squares: [64, 64],
};

const VALLEY: Relief =
    Relief { sides: [16.0, 12.0], surface: |x, _| 2.0 + 0.1 * (x - 8.0).abs(), squares: [2, 1] };

/// Settings of a case.
type Set<'a> = &'a [(&'a str, &'a str)];

const ON: Set<'static> = &[("nonplanar.enabled", "true"), ("head.name", "long-0.6")];

fn print(solid: &Solid, set: Set<'_>) -> Run {
    slice(&solid.stl(), "generic-marlin", &[ON, set].concat())
}

/// Where the lower left corner of a part in the middle of the bed is.
fn corner(run: &Run, part: &Relief) -> [f64; 2] {
    [0, 1].map(|axis| run.middle()[axis] - part.sides[axis] / 2.0)
}

fn seen(part: &Relief, set: Set<'_>) -> (Run, Looks) {
    let run = print(&part.solid(), set);
    let looks = look(&run, part, corner(&run, part), 0.0);
    (run, looks)
}

/// What holds of every skin.
fn is_sound(looks: &Looks, what: &str) {
    let Looks { mean_um, fill, outside, in_air, press, hit, .. } = looks;
    assert!(mean_um.abs() < 20.0, "{what}: {mean_um} µm over the surface");
    assert!(fill.len() > 50, "{what}: {} mm² of skin", fill.len());
    let odd = fill.iter().filter(|fill| !(0.7..=1.3).contains(*fill)).count();
    assert!(odd * 100 <= fill.len(), "{what}: {odd} of {} mm²: {fill:?}", fill.len());
    let mean = fill.iter().sum::<f64>() / fill.len() as f64;
    assert!((mean - 1.0).abs() < 0.03, "{what}: {mean} times the room");
    assert!(*outside < 0.5, "{what}: {outside} mm over the part");
    assert!(*in_air < 0.5, "{what}: {in_air} mm in the air");
    assert!(*press <= 0.3, "{what}: presses {press} mm deep");
    assert!(*hit < 0.005, "{what}: hits {hit} mm deep");
}

/// What holds where all of the top is skin.
fn is_whole(looks: &Looks, what: &str) {
    assert!(looks.coverage > 0.985, "{what}: {} covered", looks.coverage);
    is_sound(looks, what);
}

#[test]
fn skins_cover_slopes_with_as_much_plastic_as_there_is_room() {
    for (what, part) in [("wedge", WEDGE), ("arc", ARC), ("dome", DOME), ("valley", VALLEY)] {
        let (_, looks) = seen(&part, &[]);
        is_whole(&looks, what);
    }
}

#[test]
fn skins_are_the_same_on_every_kind_of_base() {
    let raft = 0.3 + 2.0 * 0.2 + 0.2;
    let cases: [(Set<'_>, f64); 7] = [
        (&[("nonplanar.directions", "auto")], 0.0),
        (&[("layer_height", "0.1")], 0.0),
        (&[("walls", "0")], 0.0),
        (&[("walls", "1"), ("machine.relative_e", "true")], 0.0),
        (&[("dual.mode", "pair")], 0.0),
        (&[("dual.mode", "interlaced"), ("support.enabled", "true")], 0.0),
        (&[("raft.enabled", "true")], raft),
    ];
    for (set, lift) in cases {
        let run = print(&WEDGE.solid(), set);
        is_whole(&look(&run, &WEDGE, corner(&run, &WEDGE), lift), &format!("{set:?}"));
    }
}

/// The judge sees what is wrong with a file.
#[test]
fn faults_of_skins_are_seen() {
    let (run, good) = seen(&WEDGE, &[]);
    let with = |change: &dyn Fn(usize, &mut crate::common::Move)| {
        let mut run = Run {
            text: String::new(),
            print: run.print.clone(),
            report: run.report.clone(),
            settings: run.settings.clone(),
        };
        run.print
            .moves
            .iter_mut()
            .filter(|m| m.patch > 0)
            .enumerate()
            .for_each(|(k, m)| change(k, m));
        look(&run, &WEDGE, corner(&run, &WEDGE), 0.0)
    };
    let bare = with(&|k, m| {
        if (600..900).contains(&k) {
            m.e = m.e.min(0.0)
        }
    });
    assert!(bare.coverage < good.coverage - 0.01 || bare.fill.iter().any(|fill| *fill < 0.7));
    let double = with(&|_, m| {
        if m.e > 0.0 {
            m.e *= 1.6
        }
    });
    assert!(double.fill.iter().all(|fill| *fill > 1.3), "{double:?}");
    let high = with(&|_, m| {
        m.from[2] += 0.05;
        m.to[2] += 0.05;
    });
    assert!((high.mean_um - good.mean_um - 50.0).abs() < 2.0, "{high:?}");
    let low = with(&|_, m| {
        m.from[2] -= 0.5;
        m.to[2] -= 0.5;
    });
    assert!(low.hit > 0.1, "{low:?}");
    let loose = with(&|_, m| {
        m.from[2] += 1.0;
        m.to[2] += 1.0;
    });
    assert!(loose.in_air > 20.0 && loose.outside > 100.0, "{loose:?}");
}

/// Under skins lie as many solid layers as under any top, and no line for several layers, nor its top
/// within one layer more.
#[test]
fn below_skins_all_is_thin_and_solid() {
    let parts = ("dual.parts", "infill,inner-walls,inner-skin");
    let cases: [Set<'_>; 4] = [
        &[("dual.mode", "pair")],
        &[("dual.mode", "interlaced")],
        &[("dual.mode", "pair"), parts],
        &[("dual.mode", "pair"), ("dual.ratio", "3"), ("layer_height", "0.1")],
    ];
    let high = Relief { surface: |x, _| 4.0 + 0.1 * x, ..WEDGE };
    for set in cases {
        let run = print(&high.solid(), set);
        let what = format!("{set:?}");
        let (layer, corner) = (run.settings.layer_height, corner(&run, &high));
        let tops = f64::from(run.settings.skin_layers);
        let (mut thick, mut sparse) = (0.0, 0.0);
        for bead in run.print.beads().filter(|bead| bead.patch == 0 && bead.layer > Some(0)) {
            for share in [0.05, 0.5, 0.95] {
                let at = bead.at(share);
                let base = (high.surface)(at[0] - corner[0], at[1] - corner[1]) - 2.0 * layer;
                let below = base - bead.to[2];
                assert!(below > -0.8 * layer, "{what}: {below} under the skins: {bead:?}");
                // Lines end somewhere in the width of one that crosses the border.
                let near = below < (tops + 0.75) * layer;
                assert!(!near || !run.print.is_thick(bead), "{what}: {below}: {bead:?}");
                thick += if run.print.is_thick(bead) { bead.length() / 3.0 } else { 0.0 };
                // The topmost layer may end half a layer lower than the base.
                let sparse_here = bead.kind == Kind::Infill && below < (tops - 1.5) * layer;
                sparse += if sparse_here { bead.length() / 3.0 } else { 0.0 };
            }
        }
        assert!(thick > 100.0, "{what}: only {thick} mm of thick lines");
        assert!(sparse < 1.0, "{what}: {sparse} mm of sparse lines close under the skins");
    }
}

/// A ramp as the wedge's, 18 by 14 mm, with a boss of 4 by 4 mm up to 9 mm: one shell.
fn ramp_with_boss() -> Solid {
    let (xs, ys) = ([0.0, 12.0, 16.0, 18.0], [0.0, 5.0, 9.0, 14.0]);
    let foot = |[i, j]: [usize; 2]| [xs[i], ys[j], 0.0];
    let ramp = |[i, j]: [usize; 2]| [xs[i], ys[j], 2.0 + 0.1 * xs[i]];
    let roof = |[i, j]: [usize; 2]| [xs[i], ys[j], 9.0];
    let mut triangles = Vec::new();
    let mut quad = |[a, b, c, d]: [[f64; 3]; 4]| triangles.extend([[a, b, c], [a, c, d]]);
    let corners = |i: usize, j: usize| [[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]];
    for (i, j) in (0..9).map(|k| (k % 3, k / 3)) {
        let of_boss = (i, j) == (1, 1);
        quad(corners(i, j).map(|at| if of_boss { roof(at) } else { ramp(at) }));
        let [a, b, c, d] = corners(i, j).map(foot);
        quad([a, d, c, b]);
    }
    for k in 0..3 {
        for [a, b] in
            [[[k, 0], [k + 1, 0]], [[3, k], [3, k + 1]], [[k + 1, 3], [k, 3]], [[0, k + 1], [0, k]]]
        {
            quad([foot(a), foot(b), ramp(b), ramp(a)]);
        }
    }
    let around = corners(1, 1);
    for k in 0..4 {
        let (a, b) = (around[k], around[(k + 1) % 4]);
        quad([ramp(a), ramp(b), roof(b), roof(a)]);
    }
    Solid { triangles }
}

/// What is printed flat has a reason, and all areas together are the tops of the mesh.
#[test]
fn a_boss_costs_what_the_head_reaches_and_all_areas_add_up() {
    let ramp = Relief { sides: [18.0, 14.0], ..WEDGE };
    let run = print(&ramp_with_boss(), &[("nonplanar.contour", "false")]);
    let looks = look(&run, &ramp, corner(&run, &ramp), 0.0);
    is_sound(&looks, "ramp with a boss");
    let report = run.report.nonplanar.as_ref().unwrap();
    let flat: f64 = report.areas.flat.iter().map(|flat| flat.mm2).sum();
    let areas = &report.areas;
    // Lines that rise and fall within their layer go where no skin does.
    let contoured = print(&ramp_with_boss(), &[]).report.nonplanar.unwrap().areas;
    assert!(contoured.contour_mm2 > 1.0 && areas.contour_mm2 == 0.0, "{contoured:?}");
    assert!((contoured.contour_mm2 + contoured.flat_mm2 - flat).abs() < 0.5, "{contoured:?}");
    let slanted = 1.01_f64.sqrt();
    let tops = (18.0 * 14.0 - 16.0) * slanted + 16.0;
    let told = areas.skin_mm2 + areas.contour_mm2 + areas.level_mm2 + flat;
    assert!((told - tops).abs() < 0.01 * tops, "{told} mm² of {tops}: {report:?}");
    assert!((areas.level_mm2 - 16.0).abs() < 1.0, "{report:?}");
    assert!(areas.skin_mm2 > 0.6 * tops, "{report:?}");
    assert!(areas.flat.iter().any(|flat| flat.reason == "obstacle"), "{report:?}");
    let told = areas.skin_mm2 / slanted;
    assert!((looks.covered - told).abs() < 0.02 * told, "{} of {told} mm²", looks.covered);
    // The boss goes on after the skins, which are laid as soon as they have their base.
    let first = run.print.beads().position(|bead| bead.patch > 0).unwrap();
    let tallest = run.print.beads().take(first).map(|bead| bead.to[2]).fold(0.0, f64::max);
    assert!(tallest < 4.0, "something stands {tallest} mm high before the skins are laid");
}

#[test]
fn of_two_bodies_the_lower_one_gets_its_skins_before_the_other_stands_higher() {
    let solid = WEDGE.solid().and(&Solid::cuboid([18.0, 0.0, 0.0], [24.0, 12.0, 14.0]));
    let both = Relief {
        sides: [24.0, 12.0],
        surface: |x, _| if x < 16.0 { 2.0 + 0.1 * x } else { -9.0 },
        squares: [1, 1],
    };
    let run = print(&solid, &[]);
    let looks = look(&run, &both, corner(&run, &both), 0.0);
    is_sound(&looks, "wedge and tower");
    assert!(looks.covered > 0.985 * 16.0 * 12.0, "{} mm²", looks.covered);
}

#[test]
fn every_copy_has_its_skins() {
    let placement = Placement { copies: 2, ..as_it_is() };
    let run = slice_with(&WEDGE.solid().stl(), settings("generic-marlin", ON), &placement);
    let patches = &run.report.nonplanar.as_ref().unwrap().patches;
    assert_eq!(patches.len(), 2, "{patches:?}");
    for number in [1, 2] {
        let beads = || run.print.beads().filter(move |bead| bead.patch == number);
        let least = |axis: usize| beads().map(|b| b.a()[axis]).fold(f64::INFINITY, f64::min);
        // Lines keep half their width off the edge.
        let half = beads().next().unwrap().width / 2.0;
        let corner = [0, 1].map(|axis| least(axis) - half);
        is_whole(&look(&run, &WEDGE, corner, 0.0), &format!("copy {number}"));
    }
}

#[test]
fn support_stands_elsewhere_and_never_on_skins() {
    // A shelf over the bed beside the wedge, and a roof over its lower end.
    let shelf = Solid::cuboid([15.0, 2.0, 1.2], [24.0, 10.0, 2.4]);
    let post = Solid::cuboid([-3.0, 0.0, 0.0], [0.5, 12.0, 9.0]);
    let roof = Solid::cuboid([-3.0, 0.0, 8.0], [5.0, 12.0, 9.5]);
    let solid = WEDGE.solid().and(&shelf).and(&post).and(&roof);
    let run = print(&solid, &[("support.enabled", "true")]);
    let whole = Relief {
        sides: [27.0, 12.0],
        surface: |x, _| if (3.0..19.0).contains(&x) { 2.0 + 0.1 * (x - 3.0) } else { -9.0 },
        squares: [1, 1],
    };
    let corner = corner(&run, &whole);
    is_sound(&look(&run, &whole, corner, 0.0), "under a roof");
    let supports = || run.print.beads().filter(|bead| bead.kind.is_support());
    let below = supports().filter(|bead| bead.at(0.5)[0] > corner[0] + 19.5).count();
    assert!(below > 10, "{below} lines of support under the shelf");
    let skins: Vec<_> = run.print.beads().filter(|bead| bead.patch > 0).collect();
    assert!(!skins.is_empty());
    for support in supports().filter(|support| support.to[2] > 2.0) {
        let at = support.at(0.5);
        let near = |skin: &&&crate::common::Move| {
            (skin.at(0.5)[0] - at[0]).hypot(skin.at(0.5)[1] - at[1]) < 0.2
        };
        assert_eq!(skins.iter().find(near), None, "under {support:?}");
    }
}

/// Support of posts has outlines on every layer and lines on few of them: the head must know the outlines.
#[test]
fn the_head_keeps_clear_of_the_outlines_of_support() {
    // A roof on a post stands beside the low end of a slope of 11°.
    let wedge = Relief { surface: |x, _| 2.0 + 0.2 * x, ..WEDGE };
    let post = Solid::cuboid([-8.0, 5.0, 0.0], [-6.0, 7.0, 9.0]);
    let roof = Solid::cuboid([-8.0, 5.0, 8.0], [-3.0, 7.0, 9.0]);
    let run = print(&wedge.solid().and(&post).and(&roof), &[("support.enabled", "true")]);
    let whole = Relief {
        sides: [24.0, 12.0],
        surface: |x, _| if x >= 8.0 { 2.0 + 0.2 * (x - 8.0) } else { -9.0 },
        squares: [1, 1],
    };
    is_sound(&look(&run, &whole, corner(&run, &whole), 0.0), "beside support");
}

#[test]
fn any_number_of_threads_gives_the_same_bytes() {
    let both = DOME.solid().and(&Solid::cuboid([18.0, 5.0, 0.0], [21.0, 9.0, 7.0]));
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| print(&both, &[]).text)
    };
    let one = with(1);
    assert!(one.contains(";NONPLANAR_START 1\n"), "no skins");
    assert!(with(2) == one && with(3) == one);
}

#[test]
fn without_the_key_nothing_follows_the_surface() {
    let run = slice(&WEDGE.solid().stl(), "generic-marlin", &[("head.name", "long-0.6")]);
    assert!(!run.text.contains("NONPLANAR") && run.report.nonplanar.is_none());
    assert!(run.print.beads().all(|bead| (bead.from[2] - bead.to[2]).abs() < 1e-9));
}

/// A head that hangs low takes away what it would touch, and no more.
#[test]
fn with_a_low_head_only_the_shallow_middle_is_skin() {
    let (run, looks) = seen(&ARC, &[("head.name", "cautious")]);
    let report = run.report.nonplanar.as_ref().unwrap();
    assert!(report.areas.skin_mm2 > 40.0, "{report:?}");
    assert!(report.areas.skin_mm2 < 0.6 * report.areas.top_mm2, "{report:?}");
    assert!(report.patches.iter().all(|patch| patch.steepest_deg < 4.4), "{report:?}");
    let highest = run.print.beads().filter(|b| b.patch > 0).map(|b| b.to[2]).fold(0.0, f64::max);
    assert!((highest - 3.0).abs() < 0.01, "{highest}: {looks:?}");
}

/// A solid, so far along x, y and z.
fn moved(solid: Solid, by: [f64; 3]) -> Solid {
    let triangles = solid
        .triangles
        .into_iter()
        .map(|corners| corners.map(|corner| std::array::from_fn(|axis| corner[axis] + by[axis])));
    Solid { triangles: triangles.collect() }
}

/// Square millimetres that are flat, or contoured, for a reason.
fn flat_mm2(run: &Run, reason: &str) -> f64 {
    let areas = &run.report.nonplanar.as_ref().unwrap().areas;
    areas.flat.iter().filter(|flat| flat.reason == reason).map(|flat| flat.mm2).sum()
}

#[test]
fn a_wall_along_the_edge_leaves_as_much_to_the_lines() {
    for part in [WEDGE, DOME] {
        let (run, looks) = seen(&part, &[("nonplanar.wall", "1")]);
        is_whole(&looks, "with a wall");
        // It runs half a line within all four sides.
        let (corner, half) = (corner(&run, &part), run.settings.line_width * 0.45);
        for axis in [0, 1] {
            for edge in [half, part.sides[axis] - half] {
                let along = run.print.beads().filter(|bead| bead.patch > 0).filter(|bead| {
                    let [from, to] = [bead.a(), bead.b()].map(|at| at[axis] - corner[axis] - edge);
                    from.abs() < 0.02 && to.abs() < 0.02
                });
                let length: f64 = along.map(crate::common::Move::length).sum();
                assert!(length > 1.8 * (part.sides[1 - axis] - 1.0), "{axis} {edge}: {length} mm");
            }
        }
    }
}

#[test]
fn of_two_patches_after_one_layer_the_lower_comes_first() {
    // The second one's top is 0.05 mm lower: the same layer makes both bases whole.
    let other = moved(WEDGE.solid(), [17.0, 0.0, 0.0]);
    let low = Solid {
        triangles: other
            .triangles
            .into_iter()
            .map(|t| t.map(|[x, y, z]| [x, y, if z > 0.0 { z - 0.05 } else { z }]))
            .collect(),
    };
    let both = Relief {
        sides: [33.0, 12.0],
        surface: |x, _| match x {
            x if x < 16.0 => 2.0 + 0.1 * x,
            x if x < 17.0 => -9.0,
            x => 1.95 + 0.1 * (x - 17.0),
        },
        squares: [1, 1],
    };
    let run = print(&WEDGE.solid().and(&low), &[("nonplanar.contour", "false")]);
    let patches = &run.report.nonplanar.as_ref().unwrap().patches;
    let [first, second] = patches.as_slice() else { panic!("{patches:?}") };
    assert_eq!(first.layer, second.layer);
    assert!(
        first.max_mm[2] < second.max_mm[2] && first.min_mm[0] > second.min_mm[0],
        "{patches:?}"
    );
    let looks = look(&run, &both, corner(&run, &both), 0.0);
    is_sound(&looks, "two wedges");
    // The high end of one stands 1.5 mm over the low end of the other, 1 mm beside it.
    assert!(looks.covered > 0.85 * 2.0 * 16.0 * 12.0, "{} mm²", looks.covered);
    assert!(flat_mm2(&run, "neighbour") + flat_mm2(&run, "obstacle") > 1.0, "{patches:?}");
}

/// A skirt of several layers stands when the skins are laid, and is as much in the way as a part.
#[test]
fn a_tall_skirt_keeps_the_head_off() {
    let near: Set<'_> = &[
        ("skirt.loops", "1"),
        ("skirt.layers", "99"),
        ("skirt.distance", "0.8"),
        ("nonplanar.contour", "false"),
    ];
    let (run, looks) = seen(&WEDGE, near);
    let skirts = run.print.beads().filter(|bead| bead.kind == Kind::Brim);
    let highest = skirts.map(|bead| bead.to[2]).fold(0.0, f64::max);
    assert!(highest > 3.0, "the skirt is {highest} mm high");
    is_sound(&looks, "behind a skirt");
    assert!(flat_mm2(&run, "neighbour") > 3.0, "{:?}", run.report.nonplanar);
    assert!(looks.covered > 0.6 * 16.0 * 12.0, "{} mm²", looks.covered);
    // Of a layer, it is in nobody's way.
    let low: Set<'_> = &[("skirt.loops", "1"), ("skirt.distance", "0.8")];
    is_whole(&seen(&WEDGE, low).1, "behind a low skirt");
}

/// No tread is left beside skins where the outline is moved, and nothing hangs beside the part.
#[test]
fn a_moved_outline_leaves_no_rim_beside_skins() {
    for (by, value) in [(0.15, "0.15"), (-0.15, "-0.15")] {
        let run = print(&WEDGE.solid(), &[("xy_compensation", value)]);
        let corner = corner(&run, &WEDGE);
        let areas = &run.report.nonplanar.as_ref().unwrap().areas;
        let sides = WEDGE.sides.map(|side| side + 2.0 * f64::min(by, 0.0));
        let top = sides[0] * sides[1] * 1.01_f64.sqrt();
        assert!((areas.skin_mm2 - top).abs() < 0.02 * top, "{by}: {areas:?}");
        for bead in run.print.beads().filter(|bead| bead.kind != Kind::Brim) {
            let at = bead.at(0.5);
            let surface = (WEDGE.surface)(at[0] - corner[0], 0.0);
            let over = bead.to[2].max(bead.from[2]) - surface;
            // Along its sides, a part that is moved outwards may have one skin on a layer more.
            let base = if by > 0.0 { -0.09 } else { -0.29 };
            let most = if bead.patch > 0 { 0.05 } else { base };
            assert!(over < most, "{by}: {over} mm over the surface: {bead:?}");
        }
    }
}
