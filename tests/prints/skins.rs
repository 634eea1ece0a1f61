//! Solids with skins over sparse infill -> where the lines of their skins end.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common::gcode::WALLS;
use crate::common::raster::Bitmap;
use crate::common::section::distance;
use crate::common::solid::{circle, rectangle};
use crate::common::{Kind, Move, Print, Run, Section, Solid, slice};
use proptest::prelude::*;

/// Step along a line, mm.
const STEP: f64 = 0.1;

/// An end may reach this far into the air, mm.
const MOST_FREE: f64 = 0.6;

/// A block with a slot that is closed by what lies above it.
fn slot(size: [f64; 2], at: [f64; 2]) -> Solid {
    let end = [at[0] + size[0], at[1] + size[1]];
    let block = Solid::cuboid([0.0; 3], [30.0, 24.0, 5.0]);
    block.and(&Solid::cuboid([at[0], at[1], 1.0], [end[0], end[1], 2.0]).inside_out())
}

/// A plate with a smaller block on it: the skin of the plate ends inside, on the infill of both.
fn step(size: f64, block: [f64; 2], at: [f64; 2]) -> Solid {
    let foot = Solid::prism(&rectangle([0.0; 2], [size; 2]), 0.0, 3.0);
    let end = [at[0] + block[0], at[1] + block[1]];
    foot.and(&Solid::prism(&rectangle(at, end), 2.0, 5.0))
}

/// A plate on two pillars.
fn table(width: f64) -> Solid {
    let pillar = |x: f64| Solid::cuboid([x, 0.0, 0.0], [x + 6.0, width, 4.2]);
    let plate = Solid::cuboid([0.0, 0.0, 4.0], [24.0, width, 5.6]);
    pillar(0.0).and(&pillar(18.0)).and(&plate)
}

/// A frustum whose sides rise at `degrees`, on a plate of its own outline; or upside down.
fn frustum(degrees: f64, corners: usize, upside_down: bool) -> Solid {
    let (foot, slope) = (13.0, degrees.to_radians().tan());
    let height = (slope * 10.0).min(5.0);
    let top = foot - height / slope;
    let (foot, top) = (circle(foot, corners), circle(top, corners));
    if upside_down {
        return Solid::tower(&[(top, 0.0), (foot.clone(), height), (foot, height + 1.6)]);
    }
    Solid::tower(&[(foot.clone(), 0.0), (foot, 1.6), (top, height + 1.6)])
}

/// Places of a grid that lie within as many layers from a surface as are to be solid, and those of
/// them where nothing is printed.
fn voids(run: &Run, solid: &Solid) -> (usize, Vec<(usize, [f64; 2])>) {
    let (print, count) = (&run.print, run.print.layers.len());
    let solid = solid.on_bed(run.middle());
    let cut = |k: usize| {
        let head = print.layers[k];
        Section::new(&solid, head.z - head.height / 2.0)
    };
    let sections: Vec<Section> = (0..count).map(cut).collect();
    let holds = |k: usize, p: [f64; 2]| sections.get(k).is_some_and(|s| s.is_inside(p));
    let as_thick = |thickness: f64| (thickness / run.settings.layer_height).round() as usize;
    let top = as_thick(run.settings.top_thickness).max(run.settings.top_skins() as usize);
    let bottom = as_thick(run.settings.bottom_thickness).max(run.settings.bottom_skins() as usize);
    let (low, high) = sections[0].extent().unwrap();
    let (mut all, mut found) = (0, Vec::new());
    for (k, section) in sections.iter().enumerate() {
        let z = print.layers[k].z - print.layers[k].height / 2.0;
        let beads: Vec<&Move> = print
            .moves
            .iter()
            .filter(|m| m.is_bead() && m.to[2] > z && m.to[2] - m.height < z)
            .collect();
        let steps = |axis: usize| ((high[axis] - low[axis] + 20.0) / 0.45) as usize;
        for (i, j) in (0..steps(0)).flat_map(|i| (0..steps(1)).map(move |j| (i, j))) {
            let p = [low[0] - 10.0 + 0.45 * i as f64, low[1] - 10.0 + 0.45 * j as f64];
            if !section.is_inside(p) || section.distance(p, 0.3) < 0.3 {
                continue;
            }
            let shown = (1..=top).any(|n| !holds(k + n, p))
                || (1..=bottom).any(|n| n > k || !holds(k - n, p));
            if !shown {
                continue;
            }
            all += 1;
            if !beads.iter().any(|m| distance(p, m.a(), m.b()) < m.width / 2.0 + 0.12) {
                found.push((k, p));
            }
        }
    }
    (all, found)
}

/// Ends of lines of skin, longer than 1.5 mm, that lie in the air: layer and place.
fn free_ends(print: &Print) -> Vec<(usize, [f64; 2])> {
    let layer = |k: usize| print.moves.iter().filter(move |m| m.is_bead() && m.layer == Some(k));
    let mut found = Vec::new();
    for k in 1..print.layers.len() {
        let z = print.layers[k - 1].z;
        // What is tall lies on the layers below, too.
        let below: Vec<&Move> = (k - 1..(k + 3).min(print.layers.len()))
            .flat_map(layer)
            .filter(|m| m.to[2] > z - 0.01 && m.to[2] - m.height < z - 0.01)
            .collect();
        let walls: Vec<&Move> = layer(k).filter(|m| WALLS.contains(&m.kind)).collect();
        let on = |beads: &[&Move], p: [f64; 2], more: f64| {
            beads.iter().any(|m| distance(p, m.a(), m.b()) < m.width / 2.0 + more)
        };
        for m in layer(k).filter(|m| m.kind == Kind::Skin && m.length() > 1.5) {
            for (from, way) in [(0.0, 1.0), (1.0, -1.0)] {
                let end = m.at(from);
                let mut free = 0.0;
                while free < m.length() && !on(&below, m.at(from + way * free / m.length()), 0.0) {
                    free += STEP;
                }
                // A line that ends beside a wall holds on to it.
                if free > MOST_FREE && !on(&walls, end, 0.45) {
                    found.push((k, end));
                }
            }
        }
    }
    found
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    #[test]
    fn bridges_close_what_is_open(
        size in [6.0..16.0_f64, 0.5..7.0_f64], at in [3.0..10.0_f64, 3.0..12.0_f64], turned: bool,
    ) {
        let angle = if turned { "30" } else { "0" };
        let run = slice(&slot(size, at).stl(), "generic-marlin", &[("angle", angle)]);
        let [x, y] = run.middle();
        let low = [x - 15.0 + at[0], y - 12.0 + at[1]];
        let high = [low[0] + size[0], low[1] + size[1]];
        let mut raster = Bitmap::new(low, high, 0.05);
        let roof = run.print.moves.iter().filter(|m| m.is_bead() && m.layer == Some(10));
        roof.for_each(|bead| raster.lay(bead));
        let (all, covered) = raster.covered(|_| true);
        // Round ends of lines leave notches.
        prop_assert!(covered * 100 >= all * 97, "{} of {}", covered, all);
    }

    #[test]
    fn nothing_is_laid_between_a_bridge_and_the_walls_beside_it(width in 6.0..12.0_f64) {
        let run = slice(&table(width).stl(), "generic-marlin", &[("angle", "0")]);
        let layer = || run.print.moves.iter().filter(|m| m.is_bead() && m.layer == Some(20));
        prop_assert!(layer().any(|m| m.kind == Kind::Bridge));
        let [x, _] = run.middle();
        let span = |m: &&Move| m.kind == Kind::Skin && (m.at(0.5)[0] - x).abs() < 4.0;
        let skin: f64 = layer().filter(span).map(Move::length).sum();
        prop_assert!(skin < 0.5, "{} mm", skin);
    }

    /// Every column of a part has as many solid layers as asked for, from each surface inwards.
    #[test]
    fn slopes_are_solid_as_deep_as_asked_for(
        degrees in 5.0..85.0_f64,
        corners in prop::sample::select(vec![4_usize, 7, 60]),
        upside_down: bool,
        walls in 1..4_u32,
        dual: bool,
    ) {
        // Flatter undersides begin in the air.
        let degrees = if upside_down { 45.0 + degrees / 2.0 } else { degrees };
        let (walls, mode) = (format!("{walls}"), if dual { "pair" } else { "off" });
        let solid = frustum(degrees, corners, upside_down);
        let set = [("walls", walls.as_str()), ("dual.mode", mode)];
        let run = slice(&solid.stl(), "generic-marlin", &set);
        let (all, found) = voids(&run, &solid);
        prop_assert!(found.is_empty(), "{} of {}: {:?}", found.len(), all, found);
    }

    #[test]
    fn skins_over_infill_end_on_what_is_printed_below(
        size in 20.0..30.0_f64,
        block in [6.0..10.0_f64, 6.0..10.0_f64],
        at in [4.0..8.0_f64, 4.0..8.0_f64],
        infill in 12.0..35.0_f64,
        dual: bool,
        turned: bool,
    ) {
        let infill = format!("{infill}");
        let mode = if dual { "pair" } else { "off" };
        let angle = if turned { "45" } else { "0" };
        let skins = ("skin_layers", "3");
        let set = [("infill", infill.as_str()), ("dual.mode", mode), ("angle", angle), skins];
        let run = slice(&step(size, block, at).stl(), "generic-marlin", &set);
        let free = free_ends(&run.print);
        prop_assert!(free.is_empty(), "{} free ends: {:?}", free.len(), free);
    }
}
