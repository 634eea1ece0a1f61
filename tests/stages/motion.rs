//! Moves -> seconds: times known by hand, and laws that hold for any moves.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use proptest::prelude::*;
use slicer::motion::{Clock, Junction, Limits, Move};
use slicer::profile::{Override, Settings, ValueOrigin, load};
use slicer::units::MmPerS;
use std::sync::LazyLock;

/// 100 mm/s, 1000 mm/s² and no corner above rest, unless a test says otherwise.
fn limits() -> Limits {
    Limits {
        feed: [300.0; 4],
        acceleration: [1000.0; 4],
        print_acceleration: 1000.0,
        travel_acceleration: 1000.0,
        retract_acceleration: 1000.0,
        junction: Junction::Jerk([0.0; 4]),
        look_ahead: None,
        minimum_speed: 0.0,
    }
}

fn times(limits: &Limits, moves: &[([f64; 4], f64)]) -> Vec<f64> {
    let mut clock = Clock::new(limits.clone());
    let mut times = Vec::new();
    for (index, &(delta, feed)) in moves.iter().enumerate() {
        clock.push(Move { delta, feed: MmPerS(feed), tag: index });
        times.extend(clock.drain());
    }
    clock.finish();
    times.extend(clock.drain());
    assert!(times.iter().enumerate().all(|(index, timed)| timed.tag == index));
    assert_eq!(times.len(), moves.len());
    times.iter().map(|timed| timed.seconds).collect()
}

fn total(limits: &Limits, moves: &[([f64; 4], f64)]) -> f64 {
    times(limits, moves).iter().sum()
}

fn near(a: f64, b: f64) {
    assert!((a - b).abs() < 1e-9 * b.abs().max(1.0), "{a} is not {b}");
}

fn x(mm: f64) -> [f64; 4] {
    [mm, 0.0, 0.0, 0.0]
}

fn y(mm: f64) -> [f64; 4] {
    [0.0, mm, 0.0, 0.0]
}

/// Settings of a shipped printer, with these values.
fn settings(printer: &str, set: &[(&str, f64)]) -> Settings {
    let given = |(key, value): &(&str, f64)| Override {
        key: (*key).to_owned(),
        value: value.to_string(),
        origin: ValueOrigin::Set,
    };
    let overrides: Vec<Override> = set.iter().map(given).collect();
    load([printer], &overrides).unwrap().settings
}

#[test]
fn klipper_does_as_the_file_says_and_x_and_y_have_no_limit_of_their_own() {
    let told = Limits::new(&settings("generic-klipper", &[("machine.acceleration", 5000.0)]));
    // 0.02 s up, 0.02 s down, 98 mm between them at 100 mm/s.
    near(total(&told, &[([100.0, 0.0, 0.0, 3.0], 100.0)]), 1.02);
    near(total(&told, &[(x(100.0), 100.0)]), 1.02);
    // Marlin keeps x within 1000 mm/s².
    let held = Limits {
        junction: Junction::Jerk([0.0; 4]),
        minimum_speed: 0.0,
        ..Limits::new(&settings("generic-marlin", &[("machine.acceleration", 5000.0)]))
    };
    near(total(&held, &[([100.0, 0.0, 0.0, 3.0], 100.0)]), 1.1);
}

#[test]
fn klipper_moves_the_filament_alone_by_what_its_configuration_gives() {
    // 1000 · 4 · 0.4² / 2.405 mm².
    let own = Limits::new(&settings("generic-klipper", &[]));
    assert!((own.retract_acceleration - 266.08).abs() < 0.01, "{own:?}");
    near(
        total(&own, &[([0.0, 0.0, 0.0, -1.0], 100.0)]),
        2.0 * (1.0 / own.retract_acceleration).sqrt(),
    );
}

#[test]
fn one_move_is_a_trapezoid_or_a_triangle() {
    // 0.1 s up, 0.1 s down, 90 mm between them at 100 mm/s.
    near(total(&limits(), &[(x(100.0), 100.0)]), 1.1);
    // Up for half of the way: 2 · √(d/a).
    near(total(&limits(), &[(x(2.5), 100.0)]), 2.0 * (2.5_f64 / 1000.0).sqrt());
    // The filament alone moves the same way.
    near(total(&limits(), &[([0.0, 0.0, 0.0, -2.5], 100.0)]), 0.1);
}

#[test]
fn a_move_starts_and_ends_at_its_jerk() {
    let limits = Limits { junction: Junction::Jerk([20.0, 20.0, 1.0, 1.0]), ..limits() };
    // From 20 to 100 mm/s in 0.08 s and 4.8 mm, twice.
    near(total(&limits, &[(x(100.0), 100.0)]), 0.16 + 90.4 / 100.0);
    // An extruder of little jerk holds the whole move back: 1 mm/s at a twentieth of the way is 20.
    let slow = total(&limits, &[([100.0, 0.0, 0.0, 10.0], 100.0)]);
    near(slow, 2.0 * 0.09 + (100.0 - 2.0 * (10_000.0 - 100.0) / 2000.0) / 100.0);
}

#[test]
fn a_square_corner_is_taken_at_the_jerk_and_a_u_turn_too() {
    let limits = Limits { junction: Junction::Jerk([20.0; 4]), ..limits() };
    let corner = [(x(100.0), 100.0), (y(100.0), 100.0)];
    let there_and_back = [(x(100.0), 100.0), (x(-100.0), 100.0)];
    let one = 0.16 + 90.4 / 100.0;
    near(total(&limits, &corner), 2.0 * one);
    near(total(&limits, &there_and_back), 2.0 * one);
    // Straight on there is no corner at all.
    near(total(&limits, &[(x(100.0), 100.0), (x(100.0), 100.0)]), 0.16 + 190.4 / 100.0);
}

#[test]
fn jerk_as_a_vector_holds_x_and_y_together() {
    let jerk = Junction::VectorJerk([15.0, 15.0, 1.0, 0.0]);
    let limits = Limits { junction: jerk, ..limits() };
    // Begins and ends at rest.
    near(total(&limits, &[(x(100.0), 100.0)]), 1.1);
    // At 90° the change is √2 times the speed, at a U-turn twice the speed.
    let root = 2.0_f64.sqrt();
    near(total(&limits, &[(x(100.0), 100.0), (y(100.0), 100.0)]), two_sides(15.0 / root));
    near(total(&limits, &[(x(100.0), 100.0), (x(-100.0), 100.0)]), two_sides(7.5));
    // Straight on, and from 50 to 60 mm/s: no corner.
    near(total(&limits, &[(x(100.0), 100.0), (x(100.0), 100.0)]), 2.1);
    let line = total(&limits, &[(x(100.0), 50.0), (x(100.0), 60.0)]);
    let second = 0.01 + 0.06 + (100.0 - (1100.0 + 3600.0) / 2000.0) / 60.0;
    near(line, 0.05 + (100.0 - 1.25) / 50.0 + second);
    // From flat to a slope of 3 in 5, z jumps by 0.6 of the speed: 1/0.6 mm/s.
    near(
        total(&limits, &[(x(100.0), 100.0), ([80.0, 0.0, 60.0, 0.0], 100.0)]),
        two_sides(1.0 / 0.6),
    );
    // Half the jerk in y: the turn is 1 / 15 by 1 / 7.5 of a jerk for each mm/s.
    let uneven = Limits { junction: Junction::VectorJerk([15.0, 7.5, 1.0, 0.0]), ..limits };
    let corner = 1.0 / (1.0_f64 / 225.0 + 1.0 / 56.25).sqrt();
    near(total(&uneven, &[(x(100.0), 100.0), (y(100.0), 100.0)]), two_sides(corner));
}

#[test]
fn jerk_as_a_vector_minds_the_filament_only_where_it_moves_alone() {
    let of = |e| Limits { junction: Junction::VectorJerk([15.0, 15.0, 1.0, e]), ..limits() };
    let extruding = ([100.0, 0.0, 0.0, 5.0], 100.0);
    near(total(&of(0.0), &[(x(100.0), 100.0), extruding]), 2.1);
    let alone = ([0.0, 0.0, 0.0, -1.0], 10.0);
    // A stop: 0.11 s for the filament.
    near(total(&of(0.0), &[(x(100.0), 100.0), alone, (x(100.0), 100.0)]), 2.2 + 0.11);
    // 2 mm/s are left on both sides; the filament needs no more than 8 ms for the rest.
    let both = two_sides(2.0) + 2.0 * 0.008 + (1.0 - 2.0 * 0.048) / 10.0;
    near(total(&of(2.0), &[(x(100.0), 100.0), alone, (x(100.0), 100.0)]), both);
}

#[test]
fn sailfish_stops_an_axis_that_stands_still_next() {
    let limits =
        Limits { junction: Junction::SpeedChange([20.0; 4]), minimum_speed: 2.0, ..limits() };
    // From 2 to 100 mm/s and back.
    let one = 2.0 * 0.098 + (100.0 - 2.0 * (10_000.0 - 4.0) / 2000.0) / 100.0;
    near(total(&limits, &[(x(100.0), 100.0), (y(100.0), 100.0)]), 2.0 * one);
    // From 50 to 60 mm/s in line: no corner.
    let line = total(&limits, &[(x(100.0), 50.0), (x(100.0), 60.0)]);
    let first = 0.048 + (100.0 - (2500.0 - 4.0) / 2000.0) / 50.0;
    let second = 0.01 + 0.058 + (100.0 - (1100.0 + 3596.0) / 2000.0) / 60.0;
    near(line, first + second);
}

#[test]
fn an_axis_holds_back_the_whole_move_by_its_share() {
    let limits = Limits {
        feed: [300.0, 300.0, 5.0, 300.0],
        acceleration: [1000.0, 1000.0, 50.0, 1000.0],
        ..limits()
    };
    near(total(&limits, &[([0.0, 0.0, 10.0, 0.0], 100.0)]), 2.1);
    // Up a slope of 3 in 5 the path goes 5/3 as fast as z does.
    let slope = total(&limits, &[([8.0, 0.0, 6.0, 0.0], 100.0)]);
    near(slope, 5.0 / 50.0 + 10.0 / (25.0 / 3.0));
    // Filament at a fifth of the path, at most 4 mm/s: 20 mm/s.
    let limits = Limits { feed: [300.0, 300.0, 300.0, 4.0], ..limits };
    near(total(&limits, &[([10.0, 0.0, 0.0, 2.0], 100.0)]), 0.02 + 0.5);
}

#[test]
fn kinds_of_moves_have_their_own_acceleration() {
    let limits = Limits {
        acceleration: [9000.0; 4],
        print_acceleration: 500.0,
        travel_acceleration: 2000.0,
        retract_acceleration: 4000.0,
        ..limits()
    };
    near(total(&limits, &[([100.0, 0.0, 0.0, 1.0], 100.0)]), 1.2);
    near(total(&limits, &[(x(100.0), 100.0)]), 1.05);
    near(total(&limits, &[([0.0, 0.0, 0.0, 100.0], 100.0)]), 1.025);
}

/// The time of two moves of 100 mm at 100 mm/s with this speed at the corner.
fn two_sides(corner: f64) -> f64 {
    let ramp = |from: f64| (100.0 - from) / 1000.0;
    let way = |from: f64| (10_000.0 - from * from) / 2000.0;
    2.0 * (ramp(0.0) + ramp(corner) + (100.0 - way(0.0) - way(corner)) / 100.0)
}

#[test]
fn corners_by_deviation_and_by_klipper() {
    let corner = [(x(100.0), 100.0), (y(100.0), 100.0)];
    let root = 2.0_f64.sqrt();
    // s / (1 − s) is 1 + √2 at 90°; √2 · 1000 mm/s² across the corner are within both axes.
    let deviation = Limits { junction: Junction::Deviation(0.05), ..limits() };
    near(total(&deviation, &corner), two_sides((1000.0 * 0.05 * (1.0 + root)).sqrt()));
    let square = |velocity| Junction::SquareCorner {
        velocity,
        minimum_cruise_ratio: 0.0,
        extruder_corner_velocity: 1.0,
    };
    let klipper = Limits { junction: square(5.0), ..limits() };
    near(total(&klipper, &corner), two_sides(5.0));
    // Starting to extrude 0.05 mm per mm at a change of at most 1 mm/s: 20 mm/s.
    let extruding = [(x(100.0), 100.0), ([100.0, 0.0, 0.0, 5.0], 100.0)];
    near(total(&klipper, &extruding), two_sides(20.0));
    // Filament alone is a stop for Klipper.
    let stop = [(x(100.0), 100.0), ([0.0, 0.0, 0.0, 1.0], 10.0), (x(100.0), 100.0)];
    near(total(&klipper, &stop), 2.2 + 0.11);
}

#[test]
fn klipper_leaves_a_part_of_short_moves_for_cruising() {
    let junction = Junction::SquareCorner {
        velocity: 5.0,
        minimum_cruise_ratio: 0.5,
        extruder_corner_velocity: 1.0,
    };
    let limits = Limits { junction, ..limits() };
    // The slow pass turns at v² = d · a / 2; the way up and down to there is half of the move.
    let peak = (2.0_f64 * 500.0).sqrt();
    near(total(&limits, &[(x(2.0), 100.0)]), 2.0 * peak / 1000.0 + 1.0 / peak);
    // Pieces of a straight line share one top speed.
    let pieces = [(x(0.5), 100.0), (x(0.5), 100.0), (x(0.5), 100.0), (x(0.5), 100.0)];
    near(total(&limits, &pieces), 2.0 * peak / 1000.0 + 1.0 / peak);
}

#[test]
fn a_short_look_ahead_is_slower_on_short_pieces() {
    let pieces = vec![(x(0.1), 100.0); 1000];
    let whole = total(&limits(), &pieces);
    near(whole, 1.1);
    let of = |blocks| total(&Limits { look_ahead: Some(blocks), ..limits() }, &pieces);
    // Three blocks of 0.1 mm behind the one that ends: √600 mm/s, and in each a sprint to √700.
    let each = 2.0 * (700.0_f64.sqrt() - 600.0_f64.sqrt()) / 1000.0;
    assert!((of(4) - 1000.0 * each).abs() < 0.05, "{}", of(4));
    assert!(of(4) > of(16) && of(16) > whole);
    near(of(1000), whole);
}

#[test]
fn a_dwell_stops_and_counts() {
    let mut clock = Clock::new(limits());
    for tag in 0..2 {
        clock.push(Move { delta: x(100.0), feed: MmPerS(100.0), tag });
        clock.dwell(0.5, tag + 10);
    }
    let found: Vec<_> = clock.drain().map(|timed| (timed.tag, timed.seconds)).collect();
    assert_eq!(found.iter().map(|one| one.0).collect::<Vec<_>>(), [0, 10, 1, 11]);
    near(found.iter().map(|one| one.1).sum(), 3.2);
}

#[test]
fn a_move_of_no_length_takes_no_time_and_stops_nobody() {
    let with = [(x(50.0), 100.0), ([0.0; 4], 100.0), (x(f64::NAN), 1.0), (x(50.0), 100.0)];
    for junction in [limits().junction, Junction::Deviation(0.01)] {
        let limits = Limits { junction, ..limits() };
        near(total(&limits, &with), 1.1);
        near(total(&Limits { look_ahead: Some(16), ..limits }, &with), 1.1);
    }
}

#[test]
fn a_feed_or_limit_that_is_no_number_is_the_least() {
    for junction in [limits().junction, Junction::Deviation(0.01)] {
        let limits = Limits { junction, ..limits() };
        near(total(&limits, &[(x(0.01), f64::NAN)]), total(&limits, &[(x(0.01), 0.0)]));
        let with = |acceleration| Limits {
            travel_acceleration: acceleration,
            print_acceleration: acceleration,
            acceleration: [acceleration, 1000.0, 1000.0, 1000.0],
            feed: [acceleration, 300.0, 300.0, 300.0],
            ..limits
        };
        near(total(&with(f64::NAN), &[(x(0.01), 1.0)]), total(&with(0.0), &[(x(0.01), 1.0)]));
    }
}

/// A rule for corners.
fn junction() -> impl Strategy<Value = Junction> {
    prop_oneof![
        (0.0..30.0_f64).prop_map(|jerk| Junction::Jerk([jerk, jerk, 0.1 * jerk, jerk])),
        (0.0..30.0_f64).prop_map(|jerk| Junction::VectorJerk([jerk, jerk, 0.1 * jerk, jerk])),
        (0.0..30.0_f64).prop_map(|most| Junction::SpeedChange([most; 4])),
        (0.0..0.2_f64).prop_map(Junction::Deviation),
        (0.0..20.0_f64, 0.0..0.9_f64).prop_map(|(velocity, minimum_cruise_ratio)| {
            Junction::SquareCorner { velocity, minimum_cruise_ratio, extruder_corner_velocity: 1.0 }
        }),
    ]
}

fn machine() -> impl Strategy<Value = Limits> {
    let look_ahead = prop_oneof![Just(None), (2_usize..40).prop_map(Some)];
    (junction(), look_ahead, 100.0..5000.0_f64).prop_map(|(junction, look_ahead, acceleration)| {
        let print_acceleration = acceleration;
        Limits { junction, look_ahead, print_acceleration, ..limits() }
    })
}

/// Moves on a coarse grid, so that straight lines, U-turns and moves of no length come up.
fn moves() -> impl Strategy<Value = Vec<([f64; 4], f64)>> {
    let step = prop_oneof![Just(0.0), (-4_i32..=4).prop_map(|n| f64::from(n) * 0.25)];
    let delta = (step.clone(), step.clone(), prop_oneof![9 => Just(0.0), 1 => Just(0.2)], step)
        .prop_map(|(x, y, z, e)| [x, y, z, 0.1 * e]);
    prop::collection::vec((delta, 5.0..200.0_f64), 1..80)
}

proptest! {
    #[test]
    fn no_move_beats_its_feed(limits in machine(), moves in moves()) {
        for (seconds, (delta, feed)) in times(&limits, &moves).iter().zip(&moves) {
            let [x, y, z, e] = delta;
            let nozzle = (x * x + y * y + z * z).sqrt();
            let distance = if nozzle > 0.0 { nozzle } else { e.abs() };
            prop_assert!(*seconds >= distance / feed * (1.0 - 1e-9));
            prop_assert!(seconds.is_finite());
        }
    }

    #[test]
    fn the_whole_file_is_never_slower_than_a_short_buffer(limits in machine(), moves in moves()) {
        let whole = total(&Limits { look_ahead: None, ..limits.clone() }, &moves);
        prop_assert!(total(&limits, &moves) >= whole * (1.0 - 1e-9));
    }

    #[test]
    fn a_straight_move_in_two_takes_the_same(limits in machine(), d in 0.1..50.0_f64, at in 0.01..0.99_f64) {
        // A buffer of 16 has room for both; Klipper's rule for short moves counts them as one.
        let limits = Limits { look_ahead: None, ..limits };
        let whole = total(&limits, &[([0.6 * d, 0.8 * d, 0.0, 0.05 * d], 100.0)]);
        let part = |share: f64| ([0.6 * d * share, 0.8 * d * share, 0.0, 0.05 * d * share], 100.0);
        let halves = total(&limits, &[part(at), part(1.0 - at)]);
        prop_assert!((whole - halves).abs() < 1e-6 * whole, "{whole} {halves}");
    }

    #[test]
    fn klippers_own_acceleration_of_the_filament_follows_its_configuration(
        a in 100.0..20_000.0_f64,
        told in 100.0..20_000.0_f64,
        nozzle in 0.3..1.0_f64,
        diameter in prop::sample::select(vec![1.75, 2.85]),
    ) {
        static KLIPPER: LazyLock<Settings> = LazyLock::new(|| settings("generic-klipper", &[]));
        let mut settings = KLIPPER.clone();
        (settings.limits.acceleration_x, settings.limits.acceleration_y) = (a, a);
        (settings.machine.acceleration, settings.limits.minimum_cruise_ratio) = (told, 0.0);
        (settings.machine.nozzle_diameter, settings.filament.diameter) = (nozzle, diameter);
        let limits = Limits::new(&settings);
        let area = std::f64::consts::FRAC_PI_4 * diameter * diameter;
        // Never what the start block sets, but no more than that either.
        prop_assert!((limits.retract_acceleration - a * 4.0 * nozzle * nozzle / area).abs() < 1e-6);
        let least = limits.retract_acceleration.min(told);
        let seconds = total(&limits, &[([0.0, 0.0, 0.0, 0.001], 100.0)]);
        prop_assert!((seconds - 2.0 * (0.001 / least).sqrt()).abs() < 1e-9);
    }

    #[test]
    fn more_acceleration_is_never_slower(moves in moves(), jerk in 0.0..20.0_f64, a in 100.0..2000.0_f64) {
        let of = |factor: f64| total(&Limits {
            acceleration: [a * factor; 4],
            print_acceleration: a * factor,
            travel_acceleration: a * factor,
            retract_acceleration: a * factor,
            junction: Junction::Jerk([jerk; 4]),
            ..limits()
        }, &moves);
        prop_assert!(of(1.5) <= of(1.0) * (1.0 + 1e-9));
    }
}

/// Planning in batches must not show: 40 000 moves in one go and the sum of their plans by hand.
#[test]
fn batches_do_not_change_the_plan() {
    let mut state = 1_u32;
    let mut next = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(state >> 16) / 65536.0 - 0.5
    };
    let moves: Vec<_> = (0..20_000).map(|_| ([next(), next(), 0.0, 0.02], 80.0)).collect();
    let square = Junction::SquareCorner {
        velocity: 5.0,
        minimum_cruise_ratio: 0.5,
        extruder_corner_velocity: 1.0,
    };
    for junction in [
        Junction::Jerk([8.0; 4]),
        Junction::VectorJerk([8.0; 4]),
        Junction::Deviation(0.02),
        square,
    ] {
        let limits = Limits { junction, ..limits() };
        let streamed = times(&limits, &moves);
        // The same moves from 1 on, after a first one: batches end elsewhere.
        let shifted = times(&limits, &moves[337..]);
        // Away from the start, where the first move began from rest, nothing changes.
        for (a, b) in streamed[337 + 50..].iter().zip(&shifted[50..]) {
            assert_eq!(a.to_bits(), b.to_bits());
        }
    }
}
