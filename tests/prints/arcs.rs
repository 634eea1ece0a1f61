//! Round parts -> G2 and G3, read back: they lie where the lines lay, with all their filament, and nothing
//! else of the print changes.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common::damage::{judge, kinds};
use crate::common::solid::circle;
use crate::common::{Move, Run, Solid, as_it_is, settings, slice};
use slicer::diff::{Side, Tolerances, diff};
use slicer::estimate::{Options, estimate};
use slicer::motion::Limits;
use slicer::profile::{Override, ValueOrigin, load};
use slicer::warning::Warning;
use std::collections::BTreeMap;

const ON: [(&str, &str); 2] = [("arcs", "true"), ("machine.arcs", "true")];

/// With pieces as short as of a Klipper that is set to it, the tolerance alone decides.
const FINE: [(&str, &str); 3] =
    [("arcs", "true"), ("machine.arcs", "true"), ("machine.arc_segment", "0.1")];

/// A plate with a round end and a round hole, and a straight end.
fn tag() -> Solid {
    let arc = |radius: f64, x: f64| circle(radius, 144).into_iter().map(move |[a, b]| [a + x, b]);
    let round: Vec<_> = arc(8.0, 0.0).filter(|at| at[0] > -1e-9).collect();
    let start = round.iter().position(|at| at[1] < -7.9).unwrap_or_default();
    let mut outline: Vec<_> = [&round[start..], &round[..start]].concat();
    outline.extend([[-12.0, 8.0], [-12.0, -8.0]]);
    Solid::prism(&outline, 0.0, 2.0)
}

/// The lines of G-code that are arcs.
fn arcs(run: &Run) -> Vec<&str> {
    let is_arc = |line: &&str| line.starts_with("G2 ") || line.starts_with("G3 ");
    run.text.lines().filter(is_arc).collect()
}

/// Beads of each layer and kind.
fn lines(run: &Run) -> BTreeMap<(usize, u32), Vec<&Move>> {
    let mut all = BTreeMap::<_, Vec<_>>::new();
    for bead in run.print.beads() {
        all.entry((bead.layer.unwrap(), bead.kind as u32)).or_default().push(bead);
    }
    all
}

/// How far a point is from the nearest of these lines, mm.
fn off(at: [f64; 2], lines: &[&Move]) -> f64 {
    let to = |line: &&Move| {
        let (a, b) = (line.a(), line.b());
        let way = [b[0] - a[0], b[1] - a[1]];
        let long = way[0] * way[0] + way[1] * way[1];
        let t = ((at[0] - a[0]) * way[0] + (at[1] - a[1]) * way[1]) / long;
        let [x, y] = line.at(t.clamp(0.0, 1.0));
        (x - at[0]).hypot(y - at[1])
    };
    lines.iter().map(to).fold(f64::MAX, f64::min)
}

/// The furthest that a place on one's lines is from the other's, mm.
fn apart(one: &Run, other: &Run) -> f64 {
    let (one, other) = (lines(one), lines(other));
    assert!(one.keys().eq(other.keys()));
    let of = |(lines, others): (&Vec<&Move>, &Vec<&Move>)| {
        let places = lines.iter().flat_map(|line| [0.0, 0.25, 0.5, 0.75, 1.0].map(|t| line.at(t)));
        places.map(|at| off(at, others)).fold(0.0, f64::max)
    };
    one.values().zip(other.values()).map(of).fold(0.0, f64::max)
}

#[test]
fn arcs_lie_within_the_tolerance_of_the_lines_and_have_all_their_filament() {
    for (profile, tolerance) in [("generic-klipper", "0.01"), ("generic-marlin", "0.02")] {
        let plain = slice(&tag().stl(), profile, &[]);
        let set = [FINE.as_slice(), &[("arc_tolerance", tolerance)]].concat();
        let round = slice(&tag().stl(), profile, &set);
        assert!(arcs(&plain).is_empty());
        let layers = round.report.layers.count;
        // Two walls: half a circle each is one arc, or two where the seam lies in it.
        let count = arcs(&round).len();
        assert!((2 * layers..=5 * layers).contains(&count), "{count} on {layers} layers");
        // What is rounded: ends of lines, and the middle.
        let most = tolerance.parse::<f64>().unwrap() + 0.002;
        let (there, back) = (apart(&plain, &round), apart(&round, &plain));
        assert!(there < most && back < most, "{profile}: {there} {back}");
        // And they are no better than that: the test sees what it measures.
        assert!(there.max(back) > 0.001, "{there} {back}");
        let all = |run: &Run| run.print.beads().map(|bead| bead.e).sum::<f64>();
        assert!((all(&plain) - all(&round)).abs() < 1e-3, "{} {}", all(&plain), all(&round));
        let said = |run: &Run| run.report.filament.length_mm;
        assert!((said(&plain) - said(&round)).abs() < 1e-9);
        let told = round.report.arcs.as_ref().unwrap();
        assert_eq!(told.count, count);
        assert!(told.lines > 20 * told.count, "{told:?}");
        assert!(round.text.len() < plain.text.len());
    }
}

#[test]
fn filament_per_way_stays_the_same_within_a_hundredth() {
    let plain = slice(&tag().stl(), "generic-klipper", &[]);
    let round = slice(&tag().stl(), "generic-klipper", &FINE);
    let rate = |run: &Run| -> BTreeMap<u32, [f64; 2]> {
        let mut rates = BTreeMap::new();
        let flat = run.print.beads().filter(|bead| bead.length() > 0.1);
        for bead in flat {
            let rate = bead.e / bead.length();
            let [low, high] = rates.entry(bead.kind as u32).or_insert([f64::MAX, 0.0_f64]);
            (*low, *high) = (low.min(rate), high.max(rate));
        }
        rates
    };
    for ((kind, a), (other, b)) in rate(&plain).into_iter().zip(rate(&round)) {
        assert_eq!(kind, other);
        assert!(b[0] > 0.99 * a[0] && b[1] < 1.01 * a[1], "{a:?} {b:?}");
    }
}

#[test]
fn files_with_and_without_arcs_print_the_same_and_check_finds_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("tag.stl");
    std::fs::write(&path, tag().stl()).unwrap();
    let sides = [&[][..], &FINE].map(|set| {
        let run = slice(&tag().stl(), "generic-klipper", set);
        assert_eq!(arcs(&run).is_empty(), set.is_empty());
        let verdict = judge(&run.text, path.to_str().unwrap(), &as_it_is());
        assert_eq!(kinds(&verdict), [], "{set:?}");
        let (bytes, limits) = (run.text.as_bytes(), Limits::new(&run.settings));
        let options = Options { filament_diameter: 1.75, ..Options::default() };
        let times = estimate(&mut &bytes[..], "test", &limits, options).unwrap();
        Side::of_bytes(bytes, times).unwrap()
    });
    // An arc off its lines, and the pieces that it is read as off the arc.
    let tolerances = Tolerances { place: 0.018, share: 0.002, ..Tolerances::default() };
    let difference = diff(&sides[0], &sides[1], &tolerances).unwrap();
    assert_eq!(difference.findings, []);
}

#[test]
fn straight_walls_are_byte_for_byte_as_without() {
    let cube = Solid::cuboid([0.0; 3], [20.0, 15.0, 2.0]);
    let code = |run: &Run| run.text.lines().filter(|line| !line.starts_with("; ")).count();
    let plain = slice(&cube.stl(), "generic-klipper", &[("corner_radius", "0")]);
    let set = [FINE.as_slice(), &[("corner_radius", "0")]].concat();
    let round = slice(&cube.stl(), "generic-klipper", &set);
    assert_eq!(code(&plain), code(&round));
    let pairs = plain.text.lines().zip(round.text.lines());
    let other: Vec<_> = pairs.filter(|(a, b)| a != b).map(|(a, _)| a).collect();
    assert_eq!(other.len(), 3, "{other:?}");
    assert!(other.iter().all(|line| line.contains("arc")), "{other:?}");
}

#[test]
fn small_circles_stay_lines_where_the_firmware_would_flatten_them() {
    // Pieces of 1 mm stand 0.063 mm off a circle of 2 mm radius.
    let pin = Solid::cylinder(2.2, 1.0, 48);
    let outer = |run: &Run| arcs(run).len();
    assert_eq!(outer(&slice(&pin.stl(), "generic-marlin", &ON)), 0);
    assert!(outer(&slice(&pin.stl(), "generic-marlin", &FINE)) > 0);
    let duet = [("arcs", "true")];
    assert!(outer(&slice(&pin.stl(), "generic-reprapfirmware", &duet)) > 0);
    // Contours are simplified until lines stand off the circle by all of the tolerance.
    let wheel = Solid::cylinder(30.0, 0.4, 360);
    assert!(outer(&slice(&wheel.stl(), "generic-marlin", &ON)) > 0);
}

#[test]
fn what_the_machine_does_not_know_is_not_written() {
    let stl = Solid::cylinder(15.0, 0.4, 180).stl();
    let run = slice(&stl, "generic-klipper", &[("arcs", "true")]);
    assert!(arcs(&run).is_empty());
    let [warning @ Warning::ArcsUnknown { .. }] = run.report.warnings.as_slice() else {
        panic!("{:?}", run.report.warnings);
    };
    assert!(warning.to_string().contains("machine.arcs = true"), "{warning}");
    assert!(slice(&stl, "generic-klipper", &ON).report.warnings.is_empty());
    // A machine that knows them does not draw them unasked.
    assert!(settings("ender-3", &[]).machine.arcs);
    assert!(arcs(&slice(&stl, "ender-3", &[])).is_empty());
    for printer in ["zcube-dual", "ultimaker-2"] {
        let (key, value) = ("machine.arcs".to_owned(), "true".to_owned());
        let asked = [Override { key, value, origin: ValueOrigin::Set }];
        let refused = load([printer], &asked).unwrap_err().to_string();
        assert!(refused.contains("set machine.arcs = false"), "{refused}");
    }
}
