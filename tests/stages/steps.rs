//! `steps`: random files become steps, and the steps played keep to the lines, the rates and the times.
//!
//! The judge knows nothing of the library's own arithmetic: it sums up the moves as whole picometres while
//! it writes the file, and looks for places on the true path, one after the other, at which all axes stand
//! within half a step.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use slicer::estimate::{self, estimate};
use slicer::motion::Limits;
use slicer::profile::{self, Override, Settings, ValueOrigin};
use slicer::reader::Reading;
use slicer::steps::{Form, Item, Made, Options, Played, make, play};
use std::fmt::Write as _;

const PM: f64 = 1e9;

/// Numbers that look random, the same on every run.
struct Dice(u64);

impl Dice {
    fn roll(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut mixed = self.0;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        mixed ^ (mixed >> 31)
    }

    fn below(&mut self, most: u64) -> u64 {
        self.roll() % most
    }

    fn share(&mut self) -> f64 {
        self.roll() as f64 / u64::MAX as f64
    }
}

/// A file, and where each of its moves truly ends, pm.
struct Case {
    text: String,
    ends: Vec<[i64; 4]>,
}

/// Random moves in all octants and four axes, 1 nm to `longest` mm long.
fn case(seed: u64, moves: usize, longest: f64) -> Case {
    let mut dice = Dice(seed);
    // True places, and what the file's numbers are less than them; all in pm.
    let (mut at, mut shift) = ([0_i64; 4], [0_i64; 4]);
    let (mut relative, mut relative_e) = (false, false);
    let mut text = String::from("G21\nG90\nM82\nG1 F6000\n");
    let mut ends = vec![at];
    let number = |pm: i64| {
        let sign = if pm < 0 { "-" } else { "" };
        format!(
            "{sign}{}.{:09}",
            pm.unsigned_abs() / 1_000_000_000,
            pm.unsigned_abs() % 1_000_000_000
        )
    };
    for _ in 0..moves {
        match dice.below(40) {
            0 => {
                relative = !relative;
                text.push_str(if relative { "G91\n" } else { "G90\n" });
                // In Marlin it sets both modes.
                relative_e = relative;
            }
            1 => {
                relative_e = !relative_e;
                text.push_str(if relative_e { "M83\n" } else { "M82\n" });
            }
            2 => {
                let axis = dice.below(4) as usize;
                let named = (dice.below(20_000_000) as i64 - 10_000_000) * 1000;
                shift[axis] = at[axis] - named;
                let _ = writeln!(text, "G92 {}{}", ['X', 'Y', 'Z', 'E'][axis], number(named));
            }
            _ => {}
        }
        let length = 1e-6 * (longest * 1e6).powf(dice.share());
        text.push_str("G1");
        for axis in 0..4 {
            if dice.below(4) == 0 {
                continue;
            }
            // In the middle now and then, so that nothing goes too far.
            let wish =
                length * (2.0 * dice.share() - 1.0) * PM / if axis == 3 { 10.0 } else { 1.0 };
            let by = wish as i64 / 1000 * 1000;
            let by = if (at[axis] + by).abs() > 300 * 1_000_000_000 { -by } else { by };
            at[axis] += by;
            let told = match axis {
                3 if relative_e => by,
                3 => at[axis] - shift[axis],
                _ if relative => by,
                _ => at[axis] - shift[axis],
            };
            let _ = write!(text, " {}{}", ['X', 'Y', 'Z', 'E'][axis], number(told));
        }
        if dice.below(5) == 0 {
            let _ = write!(text, " F{}", 60 + dice.below(12_000));
        }
        text.push('\n');
        ends.push(at);
    }
    Case { text, ends }
}

fn settings(set: &[(&str, &str)]) -> Settings {
    let with = |&(key, value): &(&str, &str)| Override {
        key: key.to_owned(),
        value: value.to_owned(),
        origin: ValueOrigin::Set,
    };
    let overrides: Vec<Override> = set.iter().map(with).collect();
    profile::load(["generic-marlin"], &overrides).unwrap().settings
}

const MOTORS: [(&str, &str); 10] = [
    ("steps.x", "9.861932938856016"),
    ("steps.y", "5"),
    ("steps.z", "13.7"),
    ("steps.e", "8.53"),
    ("steps.rate_x", "900"),
    ("steps.rate_y", "777"),
    ("steps.rate_z", "400"),
    ("steps.rate_e", "350"),
    ("steps.turn", "1500"),
    ("steps.pulse", "10"),
];

/// A stream and what it is played as.
struct Stream {
    made: Made,
    bytes: Vec<u8>,
    played: Played,
    /// Time, axes that step, and which of all go back.
    steps: Vec<(i64, u8, u8)>,
}

fn stream(text: &str, settings: &Settings, form: Form) -> Stream {
    let reading = Reading::from(slicer::reader::Firmware::Marlin);
    let options = Options { reading, form, start: None };
    let mut bytes = Vec::new();
    let made = make(&mut text.as_bytes(), "x.gcode", settings, options, &mut bytes).unwrap();
    let mut steps = Vec::new();
    let played = play(
        &mut bytes.as_slice(),
        "x.steps",
        |_| {},
        |_, item| {
            if let Item::Step { at, mask, backwards } = *item {
                steps.push((at, mask, backwards));
            }
        },
    );
    let played = played.unwrap();
    assert_eq!((played.totals, played.blocks), (made.totals, u64::from(made.blocks)));
    Stream { made, bytes, played, steps }
}

/// Places are kept to 2⁻³² step; the judge's own sums in doubles are finer.
const FINE: f64 = 1e-9;

/// Where all axes are within half a step of where they stand, on the line between two ends, as shares of it.
fn near(from: &[f64; 4], to: &[f64; 4], stands: &[i64; 4]) -> Option<(f64, f64)> {
    let (mut least, mut most) = (0.0_f64, 1.0_f64);
    for axis in 0..4 {
        let way = to[axis] - from[axis];
        let middle = stands[axis] as f64 - from[axis];
        if way.abs() < 1e-12 {
            if middle.abs() > 0.5 + FINE {
                return None;
            }
            continue;
        }
        let half = 0.5 + FINE;
        let [a, b] = [(middle - half) / way, (middle + half) / way];
        least = least.max(a.min(b));
        most = most.min(a.max(b));
    }
    (least <= most).then_some((least, most))
}

/// Judges the steps of a file by where its moves end.
fn judge(case: &Case, stream: &Stream) {
    let scale = stream.played.header.machine.scale;
    let ends: Vec<[f64; 4]> = case
        .ends
        .iter()
        .map(|end| {
            std::array::from_fn(|axis| {
                let (steps, mm) = (i128::from(scale[axis].steps), i128::from(scale[axis].mm));
                let (number, unit) = (i128::from(end[axis]) * steps, mm * 1_000_000_000);
                let whole = number.div_euclid(unit);
                whole as f64 + number.rem_euclid(unit) as f64 / unit as f64
            })
        })
        .collect();
    let (mut line, mut share) = (0, 0.0_f64);
    let mut stands = [0_i64; 4];
    for (number, (_, mask, backwards)) in stream.steps.iter().enumerate() {
        for (axis, stands) in stands.iter_mut().enumerate() {
            let by = if backwards >> axis & 1 == 1 { -1 } else { 1 };
            *stands += by * i64::from(mask >> axis & 1);
        }
        loop {
            assert!(line + 1 < ends.len(), "step {number}: {stands:?} is on no line any more");
            match near(&ends[line], &ends[line + 1], &stands) {
                Some((least, most)) if most >= share => {
                    share = share.max(least);
                    break;
                }
                _ => (line, share) = (line + 1, 0.0),
            }
        }
    }
    let end = ends.last().unwrap();
    for axis in 0..4 {
        assert!((stands[axis] as f64 - end[axis]).abs() <= 0.5 + FINE, "{stands:?} is not {end:?}");
    }
    assert_eq!(stands, stream.played.totals.end);
}

/// No axis steps faster than it may, and turns wait.
fn rates(stream: &Stream, intervals: [i64; 4], turn: i64, pulse: i64) {
    let mut last: [Option<(i64, bool)>; 4] = [None; 4];
    let mut before = None;
    for (at, mask, backwards) in &stream.steps {
        assert!(before.is_none_or(|before| at - before >= pulse), "at {at} µs");
        before = Some(*at);
        for axis in (0..4).filter(|axis| mask >> axis & 1 == 1) {
            let back = backwards >> axis & 1 == 1;
            if let Some((was, was_back)) = last[axis] {
                let least =
                    if back == was_back { intervals[axis] } else { intervals[axis].max(turn) };
                assert!(at - was >= least, "axis {axis} steps after {} µs at {at} µs", at - was);
            }
            last[axis] = Some((*at, back));
        }
    }
    assert!(stream.played.findings.iter().all(|finding| finding.code == "beyond-switch"));
}

fn random_moves(seed: u64, moves: usize, set: &[(&str, &str)]) {
    let settings = settings(&[&MOTORS[..], set].concat());
    let case = case(seed, moves, 200.0);
    let stream = stream(&case.text, &settings, Form::Steps);
    judge(&case, &stream);
    // 1e6 / rate, upwards.
    rates(&stream, [1112, 1288, 2500, 2858], 1500, 10);
}

#[test]
fn random_moves_keep_to_their_lines_and_rates() {
    random_moves(1, 4000, &[]);
    random_moves(2, 4000, &[("steps.ramps", "false")]);
    random_moves(3, 1000, &[("limits.junction", "square-corner")]);
}

#[test]
#[ignore = "a minute: 100 000 moves"]
fn a_hundred_thousand_moves_keep_to_their_lines_and_rates() {
    random_moves(4, 100_000, &[]);
    random_moves(5, 100_000, &[("steps.ramps", "false")]);
}

#[test]
fn the_time_is_that_of_the_plan_to_a_millisecond() {
    let fast: Vec<(&str, &str)> = MOTORS[..4].to_vec();
    let rates = ["steps.rate_x", "steps.rate_y", "steps.rate_z", "steps.rate_e"];
    let set: Vec<_> = fast.into_iter().chain(rates.map(|key| (key, "100000"))).collect();
    let settings = settings(&set);
    let case = case(7, 5000, 20.0);
    let stream = stream(&case.text, &settings, Form::Steps);
    let options = estimate::Options {
        firmware: slicer::reader::Firmware::Marlin,
        ..estimate::Options::default()
    };
    let limits = Limits::new(&settings);
    let told = estimate(&mut case.text.as_bytes(), "x", &limits, options).unwrap().seconds;
    let took = stream.played.seconds() - stream.made.waits;
    assert!((took - told).abs() < 1e-3, "{took} s, where the plan has {told} s");
    assert!(stream.made.waits < 1e-3 * told, "{} s of waits", stream.made.waits);
    // Every step comes when the plan has it: the first after a long even move, by hand.
    let text = "G1 X100 F600\n";
    let even = [&set[..], &[("steps.ramps", "false")]].concat();
    let steps = self::stream(text, &self::settings(&even), Form::Steps).steps;
    for (k, (at, ..)) in steps.iter().enumerate() {
        let due = (k as f64 + 0.5) * 0.1014 / 10.0 * 1e6;
        assert!((*at as f64 - due).abs() < 0.51, "step {k} at {at} µs, due at {due}");
    }
    assert_eq!(steps.len(), 986);
}

#[test]
fn coils_play_as_the_same_steps() {
    let settings = settings(&MOTORS);
    let case = case(11, 500, 50.0);
    let steps = stream(&case.text, &settings, Form::Steps);
    let bare = |stream: &Stream| -> Vec<(i64, u8, u8)> {
        stream.steps.iter().map(|(at, mask, back)| (*at, *mask, back & mask)).collect()
    };
    for full in [[false; 4], [true; 4], [false, false, true, false]] {
        let coils = stream(&case.text, &settings, Form::Coils(full));
        assert_eq!(bare(&coils), bare(&steps));
        assert_eq!(coils.played.totals, steps.played.totals);
    }
    assert_eq!(steps.bytes, stream(&case.text, &settings, Form::Steps).bytes);
}

#[test]
fn arcs_inches_homing_and_starts() {
    let settings = settings(&[&MOTORS[..], &[("steps.home_x", "10")]].concat());
    let end = |text: &str| {
        let stream = stream(text, &settings, Form::Steps);
        let machine = &stream.played.header.machine;
        (machine.mm(stream.played.totals.end), stream.played.totals.steps)
    };
    let near = |(end, _): ([f64; 4], [u64; 4]), x: f64, y: f64, z: f64| {
        assert!(
            (end[0] - x).abs() < 0.06 && (end[1] - y).abs() < 0.11 && (end[2] - z).abs() < 0.05,
            "{end:?}"
        );
    };
    // A full circle, and what it goes.
    let circle = end("G1 X30 Y0\nG2 X30 Y0 I-20 J0 E3\n");
    near(circle, 30.0, 0.0, 0.0);
    let way = circle.1[0] as f64 / 9.861_932_9 - 20.0;
    assert!((way - 80.0).abs() < 0.5, "{way}");
    near(end("G20\nG1 X1 Y-2 Z.5\n"), 25.4, -50.8, 12.7);
    // The axis goes home by steps.
    near(end("G1 X50 Y20 Z5\nG28 X Y\n"), 0.0, 0.0, 5.0);
    near(end("G28\nG92 Z0.2\nG1 X5 Y5 Z0.2\n"), 5.0, 5.0, 0.0);
    near(end("G92 X0\nG1 X7 Y1\n"), 17.0, 1.0, 0.0);
    near(end("G91\nG1 X7 Y1\n"), 17.0, 1.0, 0.0);
    // None of these moves is a step.
    let small = "G1 X0.0001\n".repeat(200_000);
    near(end(&format!("G90\nG1 X0\nG91\n{small}")), 20.0, 0.0, 0.0);
}

#[test]
fn the_example_of_the_format_is_what_is_made() {
    let page = include_str!("../../src/steps/FORMAT.md");
    let (_, example) = page.split_once("is this stream:").unwrap();
    let of_line = |line: &str| -> Vec<u8> {
        // Bytes end where two blanks begin the explanation.
        let bytes = line.split("  ").next().unwrap_or_default().split(' ');
        bytes.map_while(|byte| u8::from_str_radix(byte, 16).ok()).collect()
    };
    let told: Vec<u8> = example.lines().skip(3).flat_map(of_line).collect();
    let motors = [
        ("steps.x", "10"),
        ("steps.y", "10"),
        ("steps.z", "100"),
        ("steps.e", "20"),
        ("steps.rate_x", "1000"),
        ("steps.rate_y", "1000"),
        ("steps.rate_z", "500"),
        ("steps.rate_e", "1000"),
        ("steps.turn", "200"),
        ("steps.ramps", "false"),
        ("machine.bed_width", "300"),
        ("machine.bed_depth", "300"),
        ("machine.bed_height", "300"),
    ];
    let text = "G1 X0.3 Y0.1 F600\nG1 X0.2 E0.1\n";
    let made = stream(text, &settings(&motors), Form::Steps).bytes;
    assert_eq!(told, made);
}

#[test]
fn relative_moves_add_up_exactly() {
    let text = format!("G91\n{}", "G1 X0.1 Y-0.001 E0.1\n".repeat(10_000));
    let mut end = [0.0; 3];
    slicer::reader::read(&mut text.as_bytes(), Reading::default(), &mut |_, event| {
        if let slicer::reader::Event::Move(motion) = event {
            assert_eq!(motion.from, end);
            end = motion.to;
        }
    })
    .unwrap();
    assert_eq!(end, [1000.0, -10.0, 0.0]);
}
