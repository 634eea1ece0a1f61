//! G-code text -> events: units, modes, arcs and layers, and bytes that are no G-code.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use proptest::prelude::*;
use slicer::reader::{self, Event, Firmware, Heater, Heating, Motion, Role, Summary, Wait};

fn read(bytes: &[u8]) -> (Vec<Event>, Summary) {
    read_as(bytes, Firmware::Other)
}

fn read_as(bytes: &[u8], firmware: Firmware) -> (Vec<Event>, Summary) {
    let mut events = Vec::new();
    let mut source = bytes;
    let mut sink = |_, event| events.push(event);
    let summary = reader::read(&mut source, firmware, &mut sink).unwrap();
    (events, summary)
}

fn read_without_commands(text: &str) -> (Vec<Event>, Summary) {
    let (mut events, summary) = read(text.as_bytes());
    events.retain(|event| !matches!(event, Event::Command { .. }));
    (events, summary)
}

fn moves(text: &str) -> Vec<Motion> {
    let only_moves = |event| match event {
        Event::Move(motion) => Some(motion),
        _ => None,
    };
    read(text.as_bytes()).0.into_iter().filter_map(only_moves).collect()
}

fn ends(text: &str) -> Vec<[f64; 3]> {
    moves(text).iter().map(|motion| motion.to).collect()
}

fn filament(text: &str) -> Vec<f64> {
    moves(text).iter().map(|motion| motion.filament).collect()
}

#[test]
fn positions_are_absolute_or_relative_in_inches_or_not() {
    assert_eq!(
        ends("G1 X1 Y2\nG91\nG1 X1\nG90\nG1 X1 Z3"),
        [[1.0, 2.0, 0.0], [2.0, 2.0, 0.0], [1.0, 2.0, 3.0]]
    );
    assert_eq!(ends("G20\nG1 X1\nG21\ng01y1"), [[25.4, 0.0, 0.0], [25.4, 1.0, 0.0]]);
    assert_eq!(ends("G1 X5\nG92 X0\nG1 X1"), [[5.0, 0.0, 0.0], [6.0, 0.0, 0.0]]);
    let moved = moves("G20\nG1 X1 F60");
    assert!((moved[0].feed.0 - 25.4).abs() < 1e-9);
    assert_eq!(moves("M220 S50\nG1 X1 F60")[0].feed.0, 0.5);
}

#[test]
fn filament_is_absolute_or_relative_too() {
    assert_eq!(filament("G1 X1 E2\nG1 X2 E3\nG92 E0\nG1 X3 E0.5"), [2.0, 1.0, 0.5]);
    assert_eq!(filament("M83\nG1 X1 E2\nG1 X2 E3\nM82\nG1 X3 E6"), [2.0, 3.0, 1.0]);
    assert_eq!(filament("G91\nG1 X1 E2\nG1 X1 E2\nG90\nM83\nG1 X9 E1"), [2.0, 2.0, 1.0]);
    let by = |firmware: Firmware, text: &str| -> f64 {
        let pushed = |event| match event {
            Event::Move(motion) => motion.filament,
            _ => 0.0,
        };
        read_as(text.as_bytes(), firmware).0.into_iter().map(pushed).sum()
    };
    let absolute_after_all = "M83\nG90\nG1 X1 E2\nG1 X2 E2\nG1 X3 E3";
    let absolute_on_the_way = "G91\nM82\nG1 X1 E2\nG1 X1 E2\nG1 X1 E3";
    for text in [absolute_after_all, absolute_on_the_way] {
        assert_eq!([Firmware::Marlin, Firmware::Other].map(|one| by(one, text)), [3.0, 7.0]);
    }
    assert_eq!(by(Firmware::Marlin, "G91\nG1 X1 E2\nG1 X1 E2\nG90\nM83\nG1 X9 E1"), 5.0);
    // Sailfish names its extruders, and counts each apart; E is the current one's.
    assert_eq!(filament("G92 A0 B0\nG1 X1 B2\nG1 X2 B3"), [2.0, 1.0]);
    assert_eq!(
        filament("G92 A0 B0\nG1 X1 A10\nG1 X2 B9\nG1 X3 A20\nG1 X4 B19"),
        [10.0, 9.0, 10.0, 10.0]
    );
    assert_eq!(
        filament("G92 A0 B0\nM135 T1\nG1 X1 E5\nM6 T0\nG1 X2 E4\nM108 T1\nG1 X3 B7"),
        [5.0, 4.0, 2.0]
    );
    // Elsewhere the tools share a counter.
    assert_eq!(filament("T0\nG1 X1 E5\nT1\nG1 X2 E6"), [5.0, 1.0]);
}

#[test]
fn roles_come_from_comments_and_from_what_moves() {
    let text = "G1 X1 E1\n;TYPE:WALL-OUTER\nG1 X2 E2\nG1 X3\nG1 E1\nG1 X4 E1\n;TYPE:odd\nG1 X5 E2";
    let roles: Vec<_> = moves(text).iter().map(|motion| motion.role).collect();
    use Role::{Other, OuterWall, Retraction, Travel};
    assert_eq!(roles, [Other, OuterWall, Travel, Retraction, Travel, Other]);
    let motion = moves(";WIDTH:0.5\n;HEIGHT:0.3\nG1 X1 E1")[0];
    assert_eq!((motion.width, motion.height), (Some(0.5), Some(0.3)));
}

#[test]
fn layers_come_from_marks_or_from_heights() {
    let layers = |text: &str| {
        let (events, _) = read(text.as_bytes());
        let marked = |event: &Event| match event {
            Event::Layer { marked, .. } => Some(*marked),
            _ => None,
        };
        events.iter().filter_map(marked).collect::<Vec<_>>()
    };
    // Lifting the nozzle for a travel is no layer.
    let plain = "G1 Z0.2\nG1 X1 E1\nG1 Z5\nG1 X2\nG1 Z0.2\nG1 X3 E2\nG1 Z0.4\nG1 X1 E3";
    assert_eq!(layers(plain), [false, false]);
    assert_eq!(layers(";LAYER:0\nG1 X1 Z0.2 E1\n;LAYER:1\nG1 Z0.4\nG1 X2 E2"), [true, true]);
}

#[test]
fn arcs_are_as_long_as_they_are() {
    let length = |text: &str| -> f64 {
        let step = |motion: &Motion| {
            let way = |axis: usize| (motion.to[axis] - motion.from[axis]).powi(2);
            (way(0) + way(1) + way(2)).sqrt()
        };
        moves(text).iter().map(step).sum()
    };
    let quarter = std::f64::consts::PI * 5.0;
    let near = |a: f64, b: f64| assert!((a - b).abs() < 0.003 * b, "{a} {b}");
    near(length("G1 X10\nG3 X0 Y10 I-10 J0 E3"), 10.0 + quarter);
    near(length("G1 X10\nG2 X0 Y10 I-10 J0"), 10.0 + 3.0 * quarter);
    near(length("G1 X10\nG3 X0 Y10 R10"), 10.0 + quarter);
    near(length("G1 X10\nG3 X10 Y0 I-10 J0"), 10.0 + 4.0 * quarter);
    // A half circle whose radius was rounded down.
    near(length("G0 X100.123 Y50.456\nG2 X110.357 Y57.891 R6.324") - 112.116, 19.87);
    // A helix.
    near(length("G3 X0 Y0 I10 J0 Z30"), (16.0 * quarter * quarter + 900.0).sqrt());
    let pushed: f64 = filament("G1 X10\nG3 X0 Y10 I-10 J0 E3").iter().sum();
    assert!((pushed - 3.0).abs() < 1e-9);
}

#[test]
fn kinds_of_waits_are_distinguished_and_unknown_lines_counted() {
    let text =
        "M109 S200\nG28\nG4 P1500\nG4 S2\nM400\nT1\nM862.3 P \"MK3\"\nFOO BAR=1\nG999\n%\n(x)";
    let (events, summary) = read_without_commands(text);
    let hot = Heating { heater: Heater::Nozzle(None), celsius: Some(200.0), waits: true };
    assert_eq!(
        events,
        [
            Event::Heating(hot),
            Event::Wait(Wait::Heating),
            Event::Wait(Wait::Homing),
            Event::Dwell(1.5),
            Event::Dwell(2.0),
            Event::Wait(Wait::Moves),
            Event::Unknown(b"FOO BAR=1".to_vec()),
            Event::Unknown(b"G999".to_vec()),
        ]
    );
    assert_eq!((summary.lines, summary.unknown, summary.first_unknown), (11, 2, 8));
    let (events, summary) = read_without_commands("G10\nG11 ; back ");
    let firmware = |back| Event::FirmwareRetraction { back };
    assert_eq!(events, [firmware(true), firmware(false), Event::Comment(b" back ".to_vec())]);
    assert_eq!(summary.firmware_retractions, 2);
}

#[test]
fn g10_is_a_retraction_or_sets_a_tool_or_a_workplace() {
    let event = |text: &str| read_without_commands(text).0;
    for retraction in ["G10", "G10 S1", "G10 S0 ; short"] {
        assert_eq!(event(retraction)[0], Event::FirmwareRetraction { back: true }, "{retraction}");
    }
    let tool = |tool, celsius| {
        let heater = Heater::Nozzle(tool);
        [Event::Heating(Heating { heater, celsius: Some(celsius), waits: false })]
    };
    assert_eq!(event("G10 P0 S210 R180"), tool(Some(0), 210.0));
    assert_eq!(event("G10 S210 P1"), tool(Some(1), 210.0));
    assert_eq!(event("G10 S210"), tool(None, 210.0));
    assert_eq!(event("G10 P1 S0"), tool(Some(1), 0.0));
    for offset in ["G10 P1 X0.5 Y-3", "G10 L2 P1 X0 Y0", "G10 L20 P1 X0 S9", "G10 P1 R150"] {
        assert_eq!(event(offset), [], "{offset}");
    }
}

#[test]
fn a_move_from_an_unknown_place_is_not_counted() {
    let motion = moves("G162 X Y F2500\nG161 Z F1100\nM132 X Y Z\nG1 X0 Y-74 Z50 F3300\nG1 X10");
    assert_eq!(motion.len(), 1);
    assert_eq!(motion[0].from, [0.0, -74.0, 50.0]);
}

proptest! {
    #[test]
    fn no_bytes_are_too_odd(bytes in prop::collection::vec(any::<u8>(), 0..600)) {
        read(&bytes);
    }

    #[test]
    fn no_words_are_too_odd(
        words in prop::collection::vec("[GMTXYZEFIJRSPN;( ]-?[0-9.]{0,24}[ \n]?", 0..200)
    ) {
        let (events, _) = read(words.concat().as_bytes());
        for event in events {
            if let Event::Move(motion) = event {
                let numbers = motion.from.iter().chain(&motion.to);
                prop_assert!(numbers.chain([&motion.filament, &motion.feed.0]).all(|n| n.is_finite()));
                prop_assert!(motion.feed.0 > 0.0);
            }
        }
    }

    #[test]
    fn a_damaged_file_is_read_all_the_same(places in prop::collection::vec((0.0..1.0_f64, any::<u8>()), 1..40)) {
        let mut bytes = include_bytes!("../../fixtures/clock.gcode").to_vec();
        for (place, byte) in places {
            let index = (place * bytes.len() as f64) as usize;
            bytes[index] = byte;
        }
        read(&bytes);
    }
}
