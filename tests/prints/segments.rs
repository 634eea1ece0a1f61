//! Fine models -> moves that a printer can be fed: the law on the G-code read back.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common::{Move, Run, Solid, slice};
use slicer::warning::Warning;

/// As many moves as the planner knows.
const WINDOW: usize = 16;

/// A ring of short lines: more than a corner for each degree.
fn wheel() -> Vec<u8> {
    Solid::cylinder(6.0, 1.0, 720).stl()
}

fn sliced(rate: &str, more: &[(&str, &str)]) -> Run {
    let set = [("limits.max_segment_rate", rate), ("limits.look_ahead", "16"), ("tolerance", "0")];
    slice(&wheel(), "generic-klipper", &[set.as_slice(), more].concat())
}

/// The highest rate that a window of lines asks for, moves/s.
fn highest(run: &Run) -> f64 {
    let mut most: f64 = 0.0;
    let is_line = |step: &&Move| step.is_bead();
    for stretch in run.print.moves.chunk_by(|a, b| is_line(&a) && is_line(&b)) {
        for window in stretch.windows(WINDOW).filter(|window| is_line(&&window[0])) {
            let seconds: f64 = window.iter().map(|line| 60.0 * line.length() / line.feed).sum();
            most = most.max(WINDOW as f64 / seconds);
        }
    }
    most
}

fn filament(run: &Run) -> f64 {
    run.print.beads().map(|bead| bead.e).sum()
}

#[test]
fn no_window_asks_for_more_moves_than_the_printer_can_be_fed() {
    let free = sliced("0", &[]);
    assert!(free.report.segments.is_none());
    // At 27 mm/s, lines of 0.05 mm are 540 a second.
    assert!(highest(&free) > 300.0, "{}", highest(&free));
    for rate in [60.0, 150.0] {
        let fed = sliced(&rate.to_string(), &[]);
        assert!(highest(&fed) <= rate * 1.001, "{} of {rate}", highest(&fed));
        assert!((filament(&fed) / filament(&free) - 1.0).abs() < 1e-4);
        let told = fed.report.segments.as_ref().unwrap();
        let lines = |run: &Run| run.print.beads().count();
        assert_eq!(told.joined, lines(&free) - lines(&fed));
        assert!(told.joined > 1000, "{told:?}");
        // Joined lines are fewer and longer: few are slower.
        let lost = free.report.time.total_s + told.lost_s;
        assert!(fed.report.time.total_s < 1.02 * lost, "{told:?}");
    }
}

#[test]
fn what_cannot_be_joined_is_slowed_down_and_told() {
    // Teeth of 0.1 mm: every corner counts.
    let teeth: Vec<f64> = (0..360).map(|k| if k % 2 == 0 { 6.0 } else { 6.1 }).collect();
    let gear = Solid::prism(&crate::common::solid::star(&teeth), 0.0, 1.0).stl();
    let set = |rate| [("limits.max_segment_rate", rate), ("limits.look_ahead", "16")];
    let free = slice(&gear, "generic-klipper", &set("0"));
    let fed = slice(&gear, "generic-klipper", &set("50"));
    assert!(highest(&free) > 100.0 && highest(&fed) <= 50.05, "{}", highest(&fed));
    let told = fed.report.segments.as_ref().unwrap();
    assert!(told.slowed > 300 && told.lost_s > 1.0, "{told:?}");
    let [warning @ Warning::ShortLinesSlowed { .. }] = fed.report.warnings.as_slice() else {
        panic!("{:?}", fed.report.warnings);
    };
    assert!(warning.to_string().contains("limits.max_segment_rate above 50"), "{warning}");
    assert!((filament(&fed) / filament(&free) - 1.0).abs() < 1e-4);
}

#[test]
fn joined_lines_stay_where_they_were() {
    let (free, fed) = (sliced("0", &[]), sliced("60", &[]));
    let near = |at: [f64; 2], line: &Move| {
        let (a, b) = (line.a(), line.b());
        let way = [b[0] - a[0], b[1] - a[1]];
        let square = way[0] * way[0] + way[1] * way[1];
        let t = ((at[0] - a[0]) * way[0] + (at[1] - a[1]) * way[1]) / square;
        let [x, y] = line.at(t.clamp(0.0, 1.0));
        (x - at[0]).hypot(y - at[1])
    };
    let of = |run: &Run| -> Vec<Move> {
        run.print.beads().filter(|bead| bead.layer == Some(1)).copied().collect()
    };
    let (before, now) = (of(&free), of(&fed));
    assert!(now.len() < before.len() / 2);
    for bead in &before {
        let off = now.iter().map(|line| near(bead.b(), line)).fold(f64::MAX, f64::min);
        assert!(off < 0.0126, "{off} at {:?}", bead.b());
    }
}

#[test]
fn arcs_are_fed_as_their_pieces() {
    let set = [("arcs", "true"), ("machine.arcs", "true"), ("machine.arc_segment", "0.1")];
    let fed = sliced("20", &set);
    let arcs = fed.text.lines().filter(|line| line.starts_with(['G']) && line.contains(" I"));
    assert!(arcs.count() > 8);
    let told = fed.report.segments.as_ref().unwrap();
    // Pieces of 0.48 mm, 20 a second, are slower than 27 mm/s.
    assert!(told.slowed > 100, "{told:?}");
    let outer = fed.print.of(crate::common::Kind::OuterWall).map(|bead| bead.feed);
    assert!(outer.fold(f64::MAX, f64::min) < 20.0 * 0.8 * 60.0);
}
