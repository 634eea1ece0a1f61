//! Everyday parts -> G-code, read back: nothing is printed twice, beside the part, or left open.
//!
//! What `check` says is the measure, but for corners, which are measured themselves. The parts are plates with
//! steps, slots and strips: where rasters of other distances meet, where an edge lies exactly along a row,
//! where beads of two kinds fill one room, and where a corner lies beside something thin.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common::damage::{judge_made, kinds};
use crate::common::section::distance;
use crate::common::solid::Outline;
use crate::common::stack::stars;
use crate::common::{Kind, Move, Run, Solid, slice};
use proptest::prelude::*;

/// A plate with a block on it: the skin of the plate ends on the infill of both.
fn step(block: f64) -> Solid {
    let plate = Solid::cuboid([0.0; 3], [24.0, 20.0, 2.4]);
    plate.and(&Solid::cuboid([0.0; 3], [block, 20.0, 5.0]))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// At 15, 30 and 40 % sparse lines lie on a raster of their own, whose rows are not those of skins.
    #[test]
    fn infill_of_any_density_keeps_off_skin(
        block in 4.0..20.0_f64,
        infill in prop_oneof![
            Just("15"), Just("30"), Just("33"), Just("40"), Just("60"), Just("80"), Just("100")
        ],
        dual in prop_oneof![Just("off"), Just("pair")],
        turned in any::<bool>(),
    ) {
        let solid = if turned { step(block).quarter_turned() } else { step(block) };
        let stl = solid.stl();
        let run = slice(&stl, "generic-marlin", &[("infill", infill), ("dual.mode", dual)]);
        prop_assert_eq!(kinds(&judge_made(&run.text, &stl)), []);
    }
}

#[test]
fn a_plate_whose_edge_lies_along_a_row_is_closed() {
    // Of 0.8 mm and some: with two walls all skin. One of the rows of skin lies exactly where it ends.
    for (y, line) in [(16.88, "0.4"), (16.08, "0.4"), (20.1, "0.5")] {
        let stl = Solid::cuboid([0.0; 3], [17.34, y, 0.8]).stl();
        let run = slice(&stl, "generic-marlin", &[("line_width", line)]);
        assert_eq!(kinds(&judge_made(&run.text, &stl)), [], "{y} mm with lines of {line}");
    }
}

/// Without walls the ends and the outermost lines of skin are the outside of the part.
#[test]
fn plates_without_walls_are_whole_up_to_their_edges() {
    for (x, y) in [(17.3, 12.1), (12.0, 9.5), (20.25, 8.7)] {
        let stl = Solid::cuboid([0.0; 3], [x, y, 0.8]).stl();
        let run = slice(&stl, "generic-marlin", &[("walls", "0")]);
        assert_eq!(kinds(&judge_made(&run.text, &stl)), [], "{x} by {y} mm");
    }
}

/// A block with slots through it. Between the innermost of three walls there are rooms of a bead.
#[test]
fn rooms_that_cross_get_no_bead_twice() {
    let block = Solid::cuboid([0.0; 3], [24.0, 24.0, 2.0]);
    let slot =
        |x: f64, half: f64| Solid::cuboid([x - half, 3.0, 0.0], [x + half, 21.0, 2.0]).inside_out();
    let slots = [(4.0, 0.325), (8.0, 0.4), (12.0, 0.475), (16.0, 0.55), (20.0, 0.625)];
    let solid = slots.into_iter().fold(block, |all, (x, half)| all.and(&slot(x, half)));
    let stl = solid.stl();
    for dual in ["off", "pair"] {
        let run = slice(&stl, "generic-marlin", &[("walls", "3"), ("dual.mode", dual)]);
        assert_eq!(kinds(&judge_made(&run.text, &stl)), [], "{dual}");
    }
}

/// How far a wall reaches beyond the box of its part, mm.
fn beyond(run: &Run, solid: &Solid) -> f64 {
    let (low, high) = solid.on_bed(run.middle()).extent();
    let out = |axis: usize, at: f64, half: f64| (at + half - high[axis]).max(low[axis] - at + half);
    let beads = run.print.of(Kind::OuterWall).filter(|m| m.is_bead());
    beads
        .flat_map(|m| [(m.from, m.width / 2.0), (m.to, m.width / 2.0)])
        .flat_map(|(at, half)| [0, 1].map(|axis| out(axis, at[axis], half)))
        .fold(f64::MIN, f64::max)
}

/// A plate with a notch, alone and beside a strip that is thin: then thin places are looked for.
#[test]
fn corners_beside_something_thin_stay_square() {
    for deep in [0.7, 0.9, 1.1, 1.3] {
        let plate = Solid::cuboid([0.0; 3], [14.0, 24.0, 1.0]);
        let notch = Solid::cuboid([14.0 - deep, 7.6, 0.0], [14.0, 16.4, 1.0]).inside_out();
        let strip = Solid::cuboid([-4.0, 8.0, 0.0], [-2.24, 16.0, 1.0]);
        let solid = plate.and(&notch).and(&strip);
        let stl = solid.stl();
        let run = slice(&stl, "generic-marlin", &[]);
        let beyond = beyond(&run, &solid);
        assert!(beyond < 0.03, "{deep} mm deep: {beyond} mm outside");
        assert_eq!(kinds(&judge_made(&run.text, &stl)), [], "{deep}");
    }
}

/// Lines of skin that meet a wall a little askew, as all do after a mesh was turned or scaled.
#[test]
fn skin_has_no_blot_at_each_end_along_a_wall_that_is_not_quite_square() {
    for askew in [0.05, 0.1, 0.4, 1.0] {
        let outline = vec![[0.0, 0.0], [30.0, 0.0], [30.0 + askew, 24.0], [0.0, 24.0]];
        let stl = Solid::prism(&outline, 0.0, 1.2).stl();
        let run = slice(&stl, "generic-marlin", &[]);
        let is_blot = |m: &&Move| m.width > 1.1 * run.settings.line_width && m.length() < 0.5;
        let blots = run.print.of(Kind::Skin).filter(is_blot).count();
        assert!(blots < 20, "{askew}: {blots}");
        assert_eq!(kinds(&judge_made(&run.text, &stl)), [], "{askew}");
    }
}

/// A gear of `teeth` that are `long`, each with so much of its pitch, around a body of this radius.
fn gear(teeth: usize, radius: f64, long: f64, share: f64) -> Outline {
    let pitch = std::f64::consts::TAU / teeth as f64;
    let tooth = |k: usize| {
        let at = |turn: f64, r: f64| {
            let (sin, cos) = (pitch * (k as f64 + turn)).sin_cos();
            [r * cos, r * sin]
        };
        let tip = share * 0.6 * radius / (radius + long);
        [
            at(-share / 2.0, radius),
            at(-tip / 2.0, radius + long),
            at(tip / 2.0, radius + long),
            at(share / 2.0, radius),
        ]
    };
    (0..teeth).flat_map(tooth).collect()
}

/// A comb of tines `wide` and `long`, so far apart, on a back of this depth.
fn comb(tines: usize, wide: f64, apart: f64, long: f64, back: f64) -> Outline {
    let tine = |k: usize| {
        let x = (k as f64 + 0.5) * apart;
        [
            [x + wide / 2.0, 0.0],
            [x + wide / 3.0, long],
            [x - wide / 3.0, long],
            [x - wide / 2.0, 0.0],
        ]
    };
    let end = tines as f64 * apart;
    let foot = [[0.0, 0.0], [0.0, -back], [end, -back], [end, 0.0]];
    foot.into_iter().chain((0..tines).rev().flat_map(tine)).collect()
}

fn extruded() -> impl Strategy<Value = Outline> {
    let gears = (8..30_usize, 5.0..12.0_f64, 1.0..4.0_f64, 0.3..0.7_f64);
    let combs = (3..9_usize, 0.8..2.5_f64, 2.7..6.0_f64, 2.0..10.0_f64, 3.0..9.0_f64);
    prop_oneof![
        gears.prop_map(|(teeth, radius, long, share)| gear(teeth, radius, long, share)),
        combs.prop_map(|(tines, wide, apart, long, back)| comb(tines, wide, apart, long, back)),
        stars(),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    /// Every layer is like the next. Where a part is narrow it is filled, with infill as well.
    #[test]
    fn in_a_straight_extrusion_only_bottom_and_top_are_skin(
        outline in extruded(), walls in 1..4_u32, infill in prop_oneof![Just("10"), Just("20"), Just("35")],
        dual in prop_oneof![Just("off"), Just("pair")],
    ) {
        let stl = Solid::prism(&outline, 0.0, 4.0).stl();
        let set = [("walls", &*walls.to_string()), ("infill", infill), ("dual.mode", dual)];
        let run = slice(&stl, "generic-marlin", &set);
        let last = run.print.layers.len() - run.settings.top_skins() as usize;
        let middle = run.settings.bottom_skins() as usize..last;
        let skin = run.print.of(Kind::Skin).filter(|m| m.is_bead() && m.layer.is_some_and(|k| middle.contains(&k)));
        let places: Vec<_> = skin.map(|m| (m.layer, m.from, m.to)).collect();
        prop_assert!(places.is_empty(), "{} {:?}", places.len(), places[0]);
    }
}

/// A tube of 30 mm with walls of this thickness.
fn tube(thickness: f64) -> Solid {
    let hole = Solid::cylinder(15.0 - thickness, 2.0, 96).inside_out();
    Solid::cylinder(15.0, 2.0, 96).and(&hole)
}

/// The lengths of the chains of beads on a layer, mm.
fn lengths(run: &Run, layer: usize, kinds: &[Kind]) -> Vec<f64> {
    let chains = run.print.chains_of(kinds).into_iter();
    let here = chains.filter(|chain| chain[0].layer == Some(layer));
    here.map(|chain| chain.iter().map(Move::length).sum()).collect()
}

/// What is measured from facet to facet of a bent strip must not change the number of its beads.
#[test]
fn tubes_are_closed_rings_whatever_their_walls_measure() {
    let all = [Kind::OuterWall, Kind::InnerWall, Kind::Skin, Kind::Infill];
    for (walls, most) in [("1", 27), ("2", 36)] {
        for tenths in 20..=most {
            let stl = tube(f64::from(tenths) / 10.0).stl();
            let run = slice(&stl, "generic-marlin", &[("walls", walls)]);
            let rings = lengths(&run, 5, &all);
            let shortest = rings.iter().copied().fold(f64::MAX, f64::min);
            let what = format!("{walls} walls, 0.1 mm times {tenths}");
            assert!(rings.len() <= 10 && shortest > 20.0, "{what}: {rings:?}");
            assert_eq!(kinds(&judge_made(&run.text, &stl)), [], "{what}");
        }
    }
}

/// A box with thin walls: its outer wall goes straight from corner to corner, and what lies between turns with it.
#[test]
fn walls_of_thin_boxes_turn_their_corners() {
    let plate = |side: f64| Solid::cuboid([-side, -side, 0.0], [side, side, 2.0]);
    for thickness in [1.2, 1.25, 1.3, 1.35, 1.5] {
        let stl = plate(10.0).and(&plate(10.0 - thickness).inside_out()).stl();
        let run = slice(&stl, "generic-marlin", &[]);
        let outer = run.print.of(Kind::OuterWall).filter(|line| line.layer == Some(5));
        let outer: Vec<&Move> = outer.collect();
        let inside = lengths(&run, 5, &[Kind::InnerWall]);
        let widths = outer.iter().map(|line| line.width);
        let (least, most) = widths.fold((9.0_f64, 0.0_f64), |(a, b), w| (a.min(w), b.max(w)));
        // Two squares; a seam may part one side of each.
        assert!(outer.len() <= 10 && most - least < 0.011, "{thickness}: {least} {most}");
        let rings = if thickness < 1.45 { 1 } else { 2 };
        assert!(inside.len() == rings && inside[0] > 60.0, "{thickness}: {inside:?}");
    }
}

/// A block with square holes: at the corners of a hole its walls reach further out than an arc around them.
#[test]
fn no_line_ends_on_the_wall_around_the_corner_of_a_window() {
    let hole = |x: f64, y: f64| {
        Solid::cuboid([x - 2.2, y - 2.2, 0.0], [x + 2.2, y + 2.2, 3.0]).inside_out()
    };
    let places = [-4.0, 0.0, 4.0].map(|x| [-4.0, 0.0, 4.0].map(|y| (1.5 * x, 1.5 * y)));
    let block = Solid::cuboid([-10.0, -10.0, 0.0], [10.0, 10.0, 3.0]);
    let block = places.as_flattened().iter().fold(block, |all, &(x, y)| all.and(&hole(x, y)));
    // On its corner.
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let stl = block.map(|[x, y, z]| [half * (x - y), half * (x + y), z]).stl();
    let run = slice(&stl, "generic-marlin", &[]);
    let beads = |kinds: [Kind; 2]| -> Vec<&Move> {
        let all = kinds.into_iter().flat_map(|kind| run.print.of(kind));
        all.filter(|m| m.is_bead() && m.layer == Some(7)).collect()
    };
    let loops = beads([Kind::OuterWall, Kind::InnerWall]);
    let lines = beads([Kind::Skin, Kind::Infill]);
    assert!(!loops.is_empty() && !lines.is_empty());
    for line in lines {
        for end in [line.a(), line.b()] {
            let away = loops.iter().map(|wall| distance(end, wall.a(), wall.b()));
            assert!(away.fold(f64::MAX, f64::min) > 0.2, "line {}", line.line);
        }
    }
    assert_eq!(kinds(&judge_made(&run.text, &stl)), []);
}

/// Teeth taper: lines fill them in one go, where beads along the flanks would leave crumbs between them.
#[test]
fn teeth_of_a_rack_are_filled_by_few_pieces() {
    let teeth = 12;
    let stl = Solid::prism(&comb(teeth, 4.0, 6.0, 3.5, 5.0), 0.0, 4.0).stl();
    let run = slice(&stl, "generic-marlin", &[]);
    for layer in [8, 9] {
        let pieces = lengths(&run, layer, &[Kind::Skin, Kind::Infill]);
        let stubs = pieces.iter().filter(|length| **length < 1.0).count();
        assert!(pieces.len() <= 3 * teeth && stubs <= teeth / 2, "{layer}: {pieces:?}");
    }
    assert_eq!(kinds(&judge_made(&run.text, &stl)), []);
}

/// A wheel with a small hub: the window between two spokes, `wide` each.
fn window([from, to]: [f64; 2], wide: f64) -> Solid {
    let (hub, rim) = (3.2, 16.0);
    let at = |r: f64, angle: f64| [r * angle.cos(), r * angle.sin()];
    let beside = |r: f64| (wide / 2.0 / r).asin();
    let [first, last] = [from + beside(rim), to - beside(rim)];
    let arc = (0..=8).map(|k| at(rim, first + (last - first) * f64::from(k) / 8.0));
    let ends = [at(hub, to - beside(hub)), at(hub, from + beside(hub))];
    Solid::prism(&arc.chain(ends).collect(), 0.0, 4.0).inside_out()
}

/// What is left in the hub is no reason to fill the spokes with lines.
#[test]
fn each_spoke_of_a_wheel_has_a_bead_all_along() {
    let spokes = 6;
    for (degrees, wide) in [(0.0, 2.0), (15.0, 2.0), (15.0, 2.3), (40.0, 2.1)] {
        let angle = |k: usize| f64::to_radians(degrees + 360.0 / spokes as f64 * k as f64);
        let windows = (0..spokes).map(|k| window([angle(k), angle(k + 1)], wide));
        let wheel = Solid::cylinder(19.0, 4.0, 72);
        let stl = windows.fold(wheel, |all, window| all.and(&window)).stl();
        let run = slice(&stl, "generic-marlin", &[]);
        for layer in [8, 9] {
            let pieces = lengths(&run, layer, &[Kind::Infill]);
            let whole = pieces.iter().filter(|length| **length > 9.0).count();
            assert!(whole >= spokes, "{degrees} {wide} {layer}: {pieces:?}");
        }
    }
}

/// A plate with a rib along its edge, whose inner side is a wave: so wide on average, and by so much more and less.
fn wavy(wide: f64, swing: f64, period: f64) -> Solid {
    let wave = (0..=160).rev().map(|k| 0.25 * f64::from(k));
    let wave = wave.map(|x| [x, wide + swing * (std::f64::consts::TAU * x / period).sin()]);
    let rib = [[0.0, 0.0], [40.0, 0.0]].into_iter().chain(wave).collect();
    Solid::cuboid([0.0, 0.0, 0.0], [40.0, 20.0, 2.0]).and(&Solid::prism(&rib, 1.9, 3.0))
}

/// As many beads as have room would begin and end in each wave, with crumbs between them.
#[test]
fn skin_between_a_wave_and_an_edge_is_filled_by_few_pieces() {
    for (wide, swing, period) in
        [(2.6, 0.6, 6.0), (2.6, 1.0, 12.0), (3.0, 1.0, 12.0), (3.4, 1.0, 12.0)]
    {
        let stl = wavy(wide, swing, period).stl();
        let run = slice(&stl, "generic-marlin", &[]);
        let waves = (40.0 / period) as usize;
        for layer in [13, 14] {
            let pieces = lengths(&run, layer, &[Kind::Skin]);
            assert!(pieces.len() <= 4 * waves + 3, "{wide} {swing} {layer}: {pieces:?}");
        }
        assert_eq!(kinds(&judge_made(&run.text, &stl)), [], "{wide} {swing}");
    }
}
