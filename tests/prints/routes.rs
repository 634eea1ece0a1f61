//! Bodies in a row -> the order of their walls and lines: nearest next, or as the file has them.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common::{Kind, Print, Run, Solid, slice};

const AS_LISTED: (&str, &str) = ("travel.order", "file");

/// Blocks of 8 mm at these x, in this order of triangles.
fn blocks(places: &[f64]) -> Vec<u8> {
    let block = |x: f64| Solid::cuboid([x, 0.0, 0.0], [x + 8.0, 8.0, 2.0]);
    let solids = places.iter().map(|&x| block(x));
    solids.reduce(|all, one| all.and(&one)).unwrap().stl()
}

fn sliced(places: &[f64], set: &[(&str, &str)]) -> Run {
    let plain = [("skirt.loops", "0"), ("walls", "1"), ("skin_layers", "0")];
    slice(&blocks(places), "generic-marlin", &[&plain, set].concat())
}

/// On layer `k`: kind and place, from 0 at the lowest x, of each block that the nozzle lays lines of.
fn visits(print: &Print, k: usize) -> Vec<(Kind, usize)> {
    let low = print.beads().map(|bead| bead.from[0].min(bead.to[0])).fold(f64::MAX, f64::min);
    let beads = print.beads().filter(|bead| bead.layer == Some(k));
    let mut all: Vec<_> =
        beads.map(|bead| (bead.kind, ((bead.from[0] - low + 1.0) / 20.0) as usize)).collect();
    all.dedup();
    all
}

#[test]
fn as_listed_walls_come_in_the_order_of_the_file_and_lines_after_them() {
    for places in [[40.0, 0.0, 20.0], [0.0, 40.0, 20.0], [20.0, 40.0, 0.0]] {
        let run = sliced(&places, &[AS_LISTED]);
        let blocks = places.map(|x| (x / 20.0) as usize);
        for k in 0..run.print.layers.len() {
            let (walls, lines): (Vec<_>, Vec<_>) =
                visits(&run.print, k).into_iter().partition(|(kind, _)| *kind == Kind::OuterWall);
            let order: Vec<usize> = walls.iter().map(|(_, block)| *block).collect();
            assert_eq!(order, blocks, "layer {k}");
            assert!(lines.iter().all(|(kind, _)| *kind == Kind::Infill) && lines.len() >= 3);
            let first = visits(&run.print, k).iter().position(|(kind, _)| *kind == Kind::Infill);
            assert_eq!(first, Some(3), "layer {k}: lines come after all walls");
        }
    }
}

#[test]
fn walls_begin_at_the_same_corner_and_lines_go_one_way_as_listed() {
    let run = sliced(&[0.0], &[AS_LISTED, ("angle", "0"), ("pattern", "aligned")]);
    let first = |k: usize, kind: Kind| {
        let bead = run.print.beads().find(|bead| bead.layer == Some(k) && bead.kind == kind);
        bead.map(|bead| bead.a()).unwrap()
    };
    for k in 1..run.print.layers.len() {
        assert_eq!(first(k, Kind::OuterWall), first(0, Kind::OuterWall));
        assert_eq!(first(k, Kind::Infill), first(0, Kind::Infill));
    }
}

#[test]
fn the_nearest_next_prints_the_same_with_shorter_ways() {
    for places in [[40.0, 0.0, 20.0], [0.0, 40.0, 20.0]] {
        let [listed, nearest] = [&[AS_LISTED][..], &[]].map(|set| sliced(&places, set));
        for kind in [Kind::OuterWall, Kind::Infill] {
            let [a, b] = [&listed, &nearest].map(|run| run.print.filament(kind, false));
            assert!((a - b).abs() < 1e-3 * a, "{kind:?}: {a} and {b} mm");
        }
        let [a, b] = [&listed, &nearest].map(|run| run.report.travel.length_mm);
        assert!(b < 0.8 * a, "{b} mm, as listed {a}");
        // Island by island.
        let order: Vec<usize> = visits(&nearest.print, 1).iter().map(|(_, block)| *block).collect();
        assert_eq!(order.len(), 6, "{order:?}");
        assert!(order.chunks(2).all(|pair| pair[0] == pair[1]), "{order:?}");
    }
}
