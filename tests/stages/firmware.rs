//! What the same words mean to each firmware, which firmware a file is for, and arcs of short files.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use slicer::reader::{
    self, Event, Firmware, Heater, Heating, Motion, OwnFilament, Reading, Summary,
};

fn read(text: &str, reading: impl Into<Reading>) -> (Vec<Event>, Summary) {
    let mut events = Vec::new();
    let mut source = text.as_bytes();
    let summary = reader::read(&mut source, reading, &mut |_, event| events.push(event)).unwrap();
    events.retain(|event| !matches!(event, Event::Command { .. }));
    (events, summary)
}

fn moves(text: &str, firmware: Firmware) -> Vec<Motion> {
    let moved = |event| match event {
        Event::Move(motion) => Some(motion),
        _ => None,
    };
    read(text, firmware).0.into_iter().filter_map(moved).collect()
}

/// Filament of each move.
fn pushed(text: &str, firmware: Firmware) -> Vec<f64> {
    let round = |motion: &Motion| (motion.filament * 1e6).round() / 1e6;
    moves(text, firmware).iter().map(round).collect()
}

/// Filament that lines take.
fn extruded(text: &str, firmware: Firmware) -> f64 {
    let lines = moves(text, firmware).into_iter().filter(|one| one.from != one.to);
    let sum: f64 = lines.map(|one| one.filament.max(0.0)).sum();
    (sum * 1e6).round() / 1e6
}

fn way(motion: &Motion) -> f64 {
    (0..3).map(|axis| (motion.to[axis] - motion.from[axis]).powi(2)).sum::<f64>().sqrt()
}

fn dwells(text: &str, firmware: Firmware) -> f64 {
    let seconds = |event| if let Event::Dwell(seconds) = event { seconds } else { 0.0 };
    read(text, firmware).0.into_iter().map(seconds).sum()
}

use Firmware::{Klipper, Marlin, Marlin1, Other, RepRap, Repetier, Sailfish, Smoothie};

/// All but the Ultimaker 2.
const ALL: [Firmware; 8] = [Marlin, Marlin1, Klipper, RepRap, Sailfish, Repetier, Smoothie, Other];

#[test]
fn every_name_is_a_firmware_and_every_firmware_has_its_name() {
    for name in Firmware::NAMES {
        assert_eq!(Firmware::named(name).unwrap().name(), name);
    }
    assert_eq!(Firmware::named("makerbot"), Some(Sailfish));
    assert_eq!(Firmware::named("Marlin"), None);
}

/// faults/g05 and g06.
#[test]
fn modes_of_axes_and_filament_act_together_as_in_each_firmware() {
    let square = |steps: [&str; 4], head: &str| {
        format!("{head}\nG92 E0\nG1 Z0.2\nG1 X100 Y100\n{}", steps.join("\n"))
    };
    let by_91 = ["G1 X20 E0.7", "G1 Y20 E1.4", "G1 X-20 E2.1", "G1 Y-20 E2.8"];
    let by_90 =
        ["G1 X120 Y100 E0.7", "G1 X120 Y120 E0.7", "G1 X100 Y120 E0.7", "G1 X100 Y100 E0.7"];
    let (g05, g06) = (square(by_91, "G91\nM82"), square(by_90, "M83\nG90"));
    for firmware in ALL {
        // The last one counts; E is M82's and M83's alone; E is relative if either says so.
        let expected = match firmware {
            Marlin | Smoothie => [2.8, 0.7],
            RepRap => [2.8, 2.8],
            _ => [7.0, 2.8],
        };
        let found = [&g05, &g06].map(|text| extruded(text, firmware));
        assert_eq!(found, expected, "{firmware:?}");
    }
    for firmware in ALL {
        let after_91 = extruded("G91\nG1 X1 E2\nG1 X1 E2", firmware);
        assert_eq!(after_91, if firmware == RepRap { 2.0 } else { 4.0 }, "{firmware:?}");
        assert_eq!(extruded("M83\nG1 X1 E2\nG1 X2 E2", firmware), 4.0, "{firmware:?}");
    }
}

/// faults/g03: two tools, a counter each.
#[test]
fn a_and_b_are_filaments_of_sailfish_alone() {
    let text = "M132 X Y Z A B\nG90\nG92 A0 B0\nG1 Z0.2\nG1 X0 Y0\nG1 X20 Y0 A10\nG1 X20 Y20 B10\n\
                G1 X0 Y20 A20\nG1 X0 Y0 B20";
    for firmware in [Sailfish, Other] {
        assert_eq!(pushed(text, firmware)[..], [10.0; 4], "{firmware:?}");
    }
    // E is the current tool's from the first line on, and M132 begins both anew.
    let tools = "M135 T1\nG1 X1 E5\nM135 T0\nG1 X2 E4\nM135 T1\nG1 X3 E6\nM132 B\nG1 X4 E1";
    assert_eq!(pushed(tools, Sailfish), [5.0, 4.0, 1.0, 1.0]);
    let axes = "G1 X1 A3\nG1 X2 B3\nG1 X3 E1";
    assert_eq!(pushed(axes, Klipper), [0.0, 0.0, 1.0]);
}

/// faults/g01 and k4_rrf.
#[test]
fn g10_is_what_the_firmware_makes_of_it() {
    let tool = |tool, celsius| {
        let heater = Heater::Nozzle(tool);
        vec![Event::Heating(Heating { heater, celsius: Some(celsius), waits: false })]
    };
    let back = vec![Event::FirmwareRetraction { back: true }];
    let of = |text: &str, firmware| read(text, firmware).0;
    for firmware in [RepRap, Other] {
        assert_eq!(of("G10 P0 S210 R210", firmware), tool(Some(0), 210.0));
        assert_eq!(of("G10 P0 S0", firmware), tool(Some(0), 0.0));
        for set in ["G10 P1 X0.5", "G10 X3", "G10 R150", "G10 L2 P1 X0", "G10 L20 P1 Y0"] {
            assert_eq!(of(set, firmware), [], "{set}");
        }
    }
    for firmware in ALL {
        let bare = of("G10", firmware);
        assert_eq!(bare, if firmware == Sailfish { vec![] } else { back.clone() }, "{firmware:?}");
    }
    assert_eq!(of("G10 S1", Marlin), back);
    assert_eq!(of("G10 S1", RepRap), tool(None, 1.0));
    assert_eq!(of("G10 P0 S210", Marlin), back);
    // GPX knows no G11.
    assert_eq!(read("G11", Sailfish).1.unknown, 1);
}

#[test]
fn a_retraction_that_is_told_moves_filament_and_takes_its_time() {
    let g = "G1 X5 Z1 F600\nG10\nG10\nG1 X9\nG11\nG11";
    let filament_of = |set: &str, firmware| pushed(&format!("{set}\n{g}"), firmware);
    let marlin = "M207 S0.8 F2400\nM208 S0.1 F1200";
    for firmware in [Marlin, Marlin1, Smoothie, Other] {
        assert_eq!(filament_of(marlin, firmware), [0.0, -0.8, 0.0, 0.9], "{firmware:?}");
    }
    let feeds: Vec<f64> =
        moves(&format!("{marlin}\n{g}"), Marlin).iter().map(|m| m.feed.0).collect();
    assert_eq!(feeds, [10.0, 40.0, 10.0, 20.0]);
    let klipper = "SET_RETRACTION RETRACT_LENGTH=0.8 RETRACT_SPEED=40 UNRETRACT_EXTRA_LENGTH=0.1";
    assert_eq!(filament_of(klipper, Klipper), [0.0, -0.8, 0.0, 0.9]);
    // Klipper has no M207; in Repetier it sets jerk; RepRapFirmware's M208 is no surplus.
    for firmware in [Klipper, Repetier] {
        assert_eq!(filament_of(marlin, firmware), [0.0, 0.0], "{firmware:?}");
    }
    let (events, _) = read("M207 X9 Z0.3 E4", Repetier);
    let Event::Change(change) = events[0] else { panic!("{events:?}") };
    assert_eq!(change.jerk, [Some(9.0), Some(9.0), Some(0.3), Some(4.0)]);
    assert_eq!(filament_of("M207 S0.8 R0.2 F2400 T600\nM208 S5", RepRap), [0.0, -0.8, 0.0, 1.0]);
    // Nobody says how far: nothing is known but that it happens.
    let (events, summary) = read("M207 F2400\nG10\nG11", Marlin);
    assert_eq!((events.len(), summary.firmware_retractions), (2, 2));
}

#[test]
fn a_hop_lifts_all_moves_until_the_filament_is_back() {
    let text = "G1 X5 Z1\nM207 S1 F600 Z0.4\nG10\nG1 X9\nG11\nG1 X10 E1";
    let heights: Vec<[f64; 2]> =
        moves(text, Marlin).iter().map(|one| [one.from[2], one.to[2]]).collect();
    let (down, up) = ([1.0, 1.0], [1.4, 1.4]);
    assert_eq!(heights, [[0.0, 1.0], down, [1.0, 1.4], up, [1.4, 1.0], down, down]);
}

#[test]
fn e_is_a_volume_where_the_file_or_m200_says_so() {
    let area = std::f64::consts::PI * 1.75 * 1.75 / 4.0;
    let lines = "G1 X1 E1\nG1 X2 E2\nM200 D0\nG1 X3 E3";
    let expected = [1.0, 1.0, area].map(|e| (e / area * 1e6).round() / 1e6);
    for firmware in [Marlin, Marlin1, RepRap, Repetier, Smoothie, Other] {
        assert_eq!(pushed(&format!("M200 D1.75\n{lines}"), firmware), expected, "{firmware:?}");
        let off_on = format!("M200 S0 D1.75\nM200 S1\n{lines}");
        assert_eq!(pushed(&off_on, firmware), expected, "{firmware:?}");
        assert_eq!(extruded("M200 D1.75 S0\nG1 X1 E1", firmware), 1.0, "{firmware:?}");
    }
    for firmware in [Klipper, Sailfish] {
        assert_eq!(extruded(&format!("M200 D1.75\n{lines}"), firmware), 3.0, "{firmware:?}");
    }
    let settings = "; filament_diameter = 1.75,1.75\n; use_volumetric_e = 1\n";
    let reading = Reading::of(format!("{lines}\n{settings}").as_bytes());
    assert_eq!(reading.volumes, Some(1.75));
    let (events, _) = read("G1 X1 E1", reading);
    let moved = |event: &Event| if let Event::Move(one) = event { one.filament } else { 0.0 };
    assert!((events.iter().map(moved).sum::<f64>() - 1.0 / area).abs() < 1e-9);
    assert_eq!(Reading::of(b"; use_volumetric_e = 0").volumes, None);
    let cura = Reading::of(b";FLAVOR:Marlin(Volumetric)\nG1 X1 E1");
    assert_eq!((cura.firmware, cura.volumes), (Marlin1, Some(0.0)));
}

#[test]
fn factors_of_feed_and_flow_are_applied() {
    let text = "M220 S50\nM221 S90\nG1 X1 E1 F600\nG1 E0\nG1 X5\nM221 S100\nM220 S100\nG1 X6 E1";
    let of = |firmware| -> Vec<(f64, f64)> {
        let round = |value: f64| (value * 1e6).round() / 1e6;
        let both = |one: &Motion| (round(one.filament), one.feed.0);
        moves(text, firmware).iter().map(both).collect()
    };
    for firmware in ALL {
        // RepRapFirmware's are for lines alone.
        let middle = match firmware {
            RepRap => [(-1.0, 10.0), (0.0, 10.0)],
            _ => [(-0.9, 5.0), (0.0, 5.0)],
        };
        let expected = [(0.9, 5.0), middle[0], middle[1], (1.0, 10.0)];
        assert_eq!(of(firmware), expected, "{firmware:?}");
    }
    assert_eq!(pushed("M221 T1 S50\nG1 X1 E1\nT1\nG1 X2 E2", Marlin), [1.0, 0.5]);
    let kept = "M220 S80\nM220 B\nM220 S10\nM220 R\nG1 X1 F6000";
    assert_eq!(moves(kept, Marlin)[0].feed.0, 80.0);
}

#[test]
fn g4_waits_as_each_firmware_does() {
    for firmware in ALL {
        let expected = match firmware {
            Klipper | Sailfish => [0.5, 0.0, 0.5, 0.5],
            Smoothie => [0.5, 2.0, 2.5, 2.5],
            _ => [0.5, 2.0, 2.0, 2.0],
        };
        let found = ["G4 P500", "G4 S2", "G4 P500 S2", "G4 S2 P500"].map(|g| dwells(g, firmware));
        assert_eq!(found, expected, "{firmware:?}");
    }
}

#[test]
fn g92_gives_a_place_another_number_and_moves_nothing() {
    let ends = |text: &str| moves(text, Marlin).iter().map(|one| one.to).collect::<Vec<_>>();
    assert_eq!(ends("G1 X5 Y6 Z1\nG92 X0 Z3\nG1 X1 Z4")[1], [6.0, 6.0, 2.0]);
    assert_eq!(ends("G1 X5 Y6\nG92\nG1 X1 Y1")[1], [6.0, 7.0, 0.0]);
    // Homing undoes it.
    assert_eq!(ends("G1 X5\nG92 X0\nG28\nG1 X1")[1], [1.0, 0.0, 0.0]);
    // Where nobody knows the place, it says where the nozzle is.
    assert_eq!(ends("G28\nG92 Z0.1\nG1 X1 Z0.3")[0], [1.0, 0.0, 0.3]);
    assert_eq!(ends("G162 X Y\nG161 Z\nG92 X0 Y0 Z-5\nG1 X1 Y0 Z0")[0], [1.0, 0.0, 0.0]);
}

#[test]
fn zero_points_are_reprapfirmwares() {
    let text = "G10 L2 P2 X10 Y20\nG55\nG1 X1 Y1\nG10 L20 P2 X0\nG1 X1\nG54\nG1 X1 Y1";
    let ends = |firmware| moves(text, firmware).iter().map(|one| one.to).collect::<Vec<_>>();
    assert_eq!(ends(RepRap), [[11.0, 21.0, 0.0], [12.0, 21.0, 0.0], [1.0, 1.0, 0.0]]);
    assert_eq!(ends(Marlin), [[1.0, 1.0, 0.0]]);
}

/// faults/g19.
#[test]
fn a_radius_that_was_rounded_down_makes_a_half_circle() {
    let length = |radius: f64| -> f64 {
        let text = format!("G0 X100.123 Y50.456\nG2 X110.357 Y57.891 R{radius} E0.66");
        moves(&text, Marlin)[1..].iter().map(way).sum()
    };
    // Half the chord is 6.325 mm.
    for radius in [6.324, 6.27] {
        assert!((length(radius) - 19.87).abs() < 0.01, "{}", length(radius));
    }
    assert!((length(6.0) - 12.65).abs() < 0.01, "{}", length(6.0));
}

#[test]
fn blanks_stand_anywhere_between_letters_and_numbers() {
    let read = |text: &str| moves(text, Other);
    assert_eq!(read("G 1 X 25 E 2"), read("G1 X25 E2"));
    assert_eq!(dwells("G 4 P 500", Other), 0.5);
}

#[test]
fn files_say_which_firmware_they_are_for() {
    let own = Firmware::Ultimaker(OwnFilament::UNTOLD);
    for (text, firmware) in [
        ("", Other),
        ("G1 X1 E1\nM104 S200\n; printed = well", Other),
        (";FLAVOR:Marlin\nG1 X1", Marlin),
        (";FLAVOR:RepRap\nG1 X1", RepRap),
        (";FLAVOR:UltiGCode", own),
        ("G1 X1\n; gcode_flavor = marlin2", Marlin),
        ("; gcode_flavor = marlin", Marlin1),
        ("; gcode_flavor = smoothie", Smoothie),
        ("; gcode_flavor = sailfish", Sailfish),
        ("; machine.dialect = \"klipper\"", Klipper),
        ("; machine.dialect = \"makerbot\"", Sailfish),
        // What stands first counts most.
        ("; gcode_flavor = repetier\n; machine.dialect = \"marlin\"", Marlin),
        // People slice for Klipper with Marlin's flavour.
        (";FLAVOR:Marlin\nPRINT_START BED=60", Klipper),
        ("; gcode_flavor = marlin\nSET_VELOCITY_LIMIT ACCEL=3000", Klipper),
        ("; gcode_flavor = reprapfirmware\nSTART_PRINT", RepRap),
        ("G162 X Y F2500\nM132 X Y Z A B", Sailfish),
        ("M140 S60\nG10 P0 S210 R210\nT0", RepRap),
        ("G10 S1", Other),
    ] {
        assert_eq!(Reading::of(text.as_bytes()).firmware, firmware, "{text}");
    }
    // At the end of a long file, too.
    let long = format!("{}; gcode_flavor = klipper\n", "G1 X1 E1\nG1 X2 E2\n".repeat(60_000));
    assert_eq!(Reading::of(long.as_bytes()).firmware, Klipper);
}

/// faults/arcbomb_10, and a hundred such.
#[test]
fn what_arcs_may_ask_for_is_bounded_by_the_files_length() {
    let bomb =
        |count: usize, arc: &str| format!("G1 X100 Y100\n{}", format!("{arc}\n").repeat(count));
    for (arc, firmware) in [("G2 X100 Y100 I99999 E1", Other), ("G2I9P99999E1", Marlin)] {
        let text = bomb(1000, arc);
        let (events, summary) = read(&text, firmware);
        assert!(events.len() < 20_000 + 10 * text.len(), "{}", events.len());
        let coarse = summary.coarse_arcs;
        assert!(coarse > 900 && coarse <= 1000, "{arc}: {coarse}");
        assert!(summary.first_coarse_arc > 1, "{arc}");
        // What is printed is not lost.
        let moved = |event: &Event| if let Event::Move(one) = event { one.filament } else { 0.0 };
        assert!((events.iter().map(moved).sum::<f64>() - 1.0).abs() < 1e-6);
    }
    // Honest arcs are as fine as ever: a cylinder of 100 mm, all arcs.
    let honest = bomb(500, "G2 X100 Y100 I50.123 J0.000 E12.34567");
    let (events, summary) = read(&format!("M83\n{honest}"), Other);
    assert_eq!((summary.coarse_arcs, summary.first_coarse_arc), (0, 0));
    let pieces = events.iter().filter(|event| matches!(event, Event::Move(_))).count();
    assert_eq!(pieces, 1 + 500 * 223);
    // Turns that can be had are had, in Marlin.
    let round = |firmware| -> f64 {
        moves("G2 I10 P2", firmware).iter().map(way).sum::<f64>() / (20.0 * std::f64::consts::PI)
    };
    assert!((round(Marlin) - 3.0).abs() < 0.01 && (round(Klipper) - 1.0).abs() < 0.01);
}
