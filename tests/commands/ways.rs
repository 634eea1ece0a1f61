//! `slicer diff`: where the nozzle goes without a line, where walls begin, what moved as a whole, and pictures of it.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use super::run::with as slicer;
use crate::common::{as_it_is, fixture, slice, slice_placed};
use crate::diff::side;
use slicer::diff::{Both, Difference, Finding, Ordered, Tolerances, diff};
use slicer::mesh::Placement;
use slicer::reader::Role;
use std::sync::OnceLock;

/// A sound slice of a cube of 20 mm.
fn cube() -> &'static str {
    static TEXT: OnceLock<String> = OnceLock::new();
    TEXT.get_or_init(|| slice(&fixture("cube_20.stl"), "generic-marlin", &[]).text)
}

fn compared(a: &str, b: &str, tolerances: &Tolerances) -> Difference {
    let (a, b) = (side(a), side(b));
    let found = diff(&a, &b, tolerances).unwrap();
    // It has no direction.
    assert_eq!(diff(&b, &a, tolerances).unwrap().findings.len(), found.findings.len());
    found
}

/// The text with some lines put in before the first line after `from` that begins with `mark`.
fn with(text: &str, from: usize, mark: &str, lines: &str) -> String {
    let at = from + text[from..].find(&format!("\n{mark}")).unwrap() + 1;
    format!("{}{lines}{}", &text[..at], &text[at..])
}

/// Goes back to where the nozzle is at `from`: first up or down.
fn back(text: &str, from: usize) -> String {
    let last = |letter: &str| {
        let words = text[..from].lines().filter(|line| line.starts_with('G')).rev();
        let mut words = words.flat_map(|line| line.split(' '));
        words.find(|word| word.starts_with(letter)).unwrap().to_owned()
    };
    format!("G0 {}\nG0 {} {}\n", last("Z"), last("X"), last("Y"))
}

/// Where the mark of this layer is, counted from 1.
fn layer(text: &str, number: usize) -> usize {
    text.match_indices(";LAYER_CHANGE").nth(number - 1).unwrap().0
}

/// Where the end block begins.
fn end(text: &str) -> usize {
    text.rfind(";TYPE:Custom").unwrap()
}

/// Where travels differ: layer, place, lines of both files.
type Elsewhere = (Option<Both<usize>>, [f64; 3], Both<u32>);

/// The travels that differ, the worst first.
fn travels(found: &Difference) -> Vec<Elsewhere> {
    let travels = found.findings.iter().filter_map(|one| match one {
        Finding::Travels { layer, farthest, .. } => Some((*layer, farthest.at_mm, farthest.line)),
        _ => None,
    });
    travels.collect()
}

#[test]
fn a_nozzle_that_goes_elsewhere_is_told_with_its_line_wherever_it_does() {
    let made = cube();
    let middle = layer(made, 60);
    let first = made.find("\nG1 X65").unwrap();
    let across = "G0 Z0.2\nG0 X100 Y100\nG0 X120 Y120\n".to_owned() + &back(made, middle);
    let after = "G0 Z0.1\nG0 X110 Y100\nG0 X110 Y130\n";
    let mut edits: Vec<(usize, &str, String, f64)> = vec![
        (end(made), "M104", "G0 Z-30\n".to_owned(), -30.0),
        (middle, "G1", across, 0.2),
        (end(made), "M104", after.to_owned(), 0.1),
    ];
    for place in ["Y900", "X-500", "Z-3", "X900000000"] {
        // And back to where it was, so that no line is another one.
        for (from, mark, back) in [
            (first - 1, "G1", back(made, first)),
            (middle, "G1", back(made, middle)),
            (end(made), "M104", String::new()),
        ] {
            edits.push((from, mark, format!("G0 {place}\n{back}"), f64::NAN));
        }
    }
    for (from, mark, lines, low) in edits {
        let other = with(made, from, mark, &lines);
        let found = compared(made, &other, &Tolerances::default());
        assert!(!found.equal, "{lines}");
        let told = travels(&found);
        let first = 1 + other[..other.find(&lines).unwrap()].matches('\n').count() as u32;
        let last = first + lines.matches('\n').count() as u32;
        let ours = told.iter().find(|(_, _, line)| (first..=last).contains(&line.b));
        assert!(ours.is_some(), "{lines}: {:?}", found.findings);
        if !low.is_nan() {
            let heights = found.findings.iter().find_map(|one| match one {
                Finding::Travels { z_mm: Both { b: Some(z), .. }, .. } => Some(z[0]),
                _ => None,
            });
            assert!((heights.unwrap() - low).abs() < 1e-4, "{lines}: {heights:?}");
        }
        // Without travels nothing is left but the time that they take.
        let plastic = Tolerances { travels: false, ..Tolerances::default() };
        let rest = compared(made, &other, &plastic).findings;
        let is_time = |one: &Finding| matches!(one, Finding::Sum { layer: None, .. });
        assert!(rest.iter().all(is_time), "{lines}: {rest:?}");
    }
}

#[test]
fn the_layer_or_the_end_is_told() {
    let made = cube();
    let lower = with(made, end(made), "M104", "G0 Z-30 F1000\n");
    let found = compared(made, &lower, &Tolerances::default());
    assert!(matches!(travels(&found)[..], [(None, [_, _, z], _)] if (z + 30.0).abs() < 1e-4));
    let sixty = layer(made, 60);
    let aside = with(made, sixty, "G1", &("G0 X150\n".to_owned() + &back(made, sixty)));
    let found = compared(made, &aside, &Tolerances::default());
    assert_eq!(travels(&found)[0].0, Some(Both { a: 60, b: 60 }));
    let early = made.replacen("G0 Z2 F1000", "G0 Z0.4 F1000", 1);
    assert_ne!(made, early);
    let found = compared(made, &early, &Tolerances::default());
    assert!(!found.equal && !travels(&found).is_empty(), "{:?}", found.findings);
}

/// Squares of 20 mm side by side, each wall drawn from this corner on, in this order.
fn squares(layers: usize, squares: &[[f64; 2]], corner: impl Fn(usize) -> usize) -> String {
    let mut text = "M104 S210\nG28\nM83\nG1 Z5 F1000\n".to_owned();
    for layer in 0..layers {
        text += &format!(";LAYER_CHANGE\nG1 Z{:.2} F1000\n", 0.2 * (layer + 1) as f64);
        for [x, y] in squares {
            let corners = [[0.0, 0.0], [20.0, 0.0], [20.0, 20.0], [0.0, 20.0]];
            let at = |k: usize| {
                let [dx, dy] = corners[(k + corner(layer)) % 4];
                format!("X{} Y{}", x + dx, y + dy)
            };
            text += &format!("G1 {} F9000\nG1 E0.8 F1800\n;TYPE:Outer wall\n", at(0));
            for k in 1..5 {
                text += &format!("G1 {} E0.666 F3000\n", at(k));
            }
            text += "G1 E-0.8 F1800\n";
        }
    }
    text + "G1 Z30 F1000\nM104 S0\n"
}

const THREE: [[f64; 2]; 3] = [[10.0, 10.0], [40.0, 10.0], [70.0, 20.0]];

#[test]
fn walls_that_begin_elsewhere_are_told_once_with_the_farthest() {
    let made = squares(6, &THREE, |_| 0);
    let other = squares(6, &THREE, |layer| usize::from(layer > 2));
    let seams = Tolerances { travels: false, ..Tolerances::default() };
    let found = compared(&made, &other, &seams);
    let [Finding::Seams { role, layers, moved, layer, farthest }] = &found.findings[..] else {
        panic!("{:?}", found.findings);
    };
    assert_eq!((*role, &layers[..]), (Role::OuterWall, &[4, 5, 6][..]));
    assert_eq!((*moved, *layer), (Both { a: 9, b: 9 }, Both { a: 4, b: 4 }));
    // From corner to corner, and no other wall begins nearer.
    assert!((farthest.distance_mm - 20.0).abs() < 1e-3 || farthest.distance_mm < 20.0);
    assert!(farthest.distance_mm > 9.0, "{farthest:?}");
    // With the ways both are told; a tolerance lets seams wander.
    let found = compared(&made, &other, &Tolerances::default());
    assert!(found.findings.iter().any(|one| matches!(one, Finding::Seams { .. })));
    assert!(compared(&made, &other, &Tolerances { seams: 21.0, ..seams }).equal);
    assert!(compared(&made, &made, &Tolerances::default()).equal);
}

#[test]
fn another_order_is_told_as_such() {
    let made = squares(4, &THREE, |_| 0);
    let back = [THREE[1], THREE[0], THREE[2]];
    let other = squares(4, &back, |_| 0);
    let found = compared(&made, &other, &Tolerances::default());
    let orders: Vec<_> = found
        .findings
        .iter()
        .filter(|one| !matches!(one, Finding::Sum { layer: None, .. }))
        .collect();
    let [Finding::Order { of: Ordered::Lines, layers, layer: Some(first), line, .. }] = orders[..]
    else {
        panic!("{:?}", found.findings);
    };
    assert_eq!((&layers[..], *first), (&[1, 2, 3, 4][..], Both { a: 1, b: 1 }));
    assert_eq!(*line, Both { a: 10, b: 10 });
    // The same travels, the other way round: only their order differs.
    let way = "G1 X50 Y50\nG1 X55 Y50\nG1 X50 Y50\nG1 X50 Y55\nG1 X50 Y50\n";
    let turned = "G1 X50 Y50\nG1 X50 Y55\nG1 X50 Y50\nG1 X55 Y50\nG1 X50 Y50\n";
    let from = layer(&made, 3);
    let (one, two) = (with(&made, from, "G1 X", way), with(&made, from, "G1 X", turned));
    let found = compared(&one, &two, &Tolerances::default());
    let [Finding::Order { of: Ordered::Travels, layers, .. }] = &found.findings[..] else {
        panic!("{:?}", found.findings);
    };
    assert_eq!(layers[..], [3]);
    // Divided otherwise, they are the same.
    let parts = with(&made, from, "G1 X", &way.replace("G1 X55 Y50\n", "G1 X52 Y50\nG1 X55 Y50\n"));
    assert!(compared(&one, &parts, &Tolerances::default()).equal);
}

#[test]
fn what_is_not_pulled_back_or_pushed_out_again_is_told() {
    let made = squares(4, &THREE, |_| 0);
    let from = layer(&made, 3);
    for gone in ["G1 E0.8 F1800\n", "G1 E-0.8 F1800\n"] {
        let other = made[..from].to_owned() + &made[from..].replacen(gone, "", 1);
        let found = compared(&made, &other, &Tolerances::default());
        let [Finding::Retractions { layers, pulled_mm, pushed_mm, .. }] = &found.findings[..]
        else {
            panic!("{:?}", found.findings);
        };
        assert_eq!(layers[..], [3]);
        let less = pulled_mm.a - pulled_mm.b + pushed_mm.a - pushed_mm.b;
        assert!((less - 0.8).abs() < 1e-4, "{less}");
    }
    let own = made.replace("G1 E-0.8 F1800", "G10").replace("G1 E0.8 F1800", "G11");
    let other = own.replacen("G11\n", "", 1);
    let found = compared(&own, &other, &Tolerances::default());
    assert!(matches!(
        found.findings[..],
        [Finding::FirmwareRetractions { count: Both { a: 24, b: 23 } }]
    ));
}

#[test]
fn a_print_that_moved_as_a_whole_is_one_finding() {
    let made = cube();
    let middle = [110.0, 110.0];
    for by in [[1.0, 0.0], [-7.25, 12.5]] {
        let at = Some([middle[0] + by[0], middle[1] + by[1]]);
        let still = Placement { at: Some(middle), ..as_it_is() };
        let moved = Placement { at, ..as_it_is() };
        let one = slice_placed(&fixture("cube_20.stl"), "generic-marlin", &[], &still).text;
        let two = slice_placed(&fixture("cube_20.stl"), "generic-marlin", &[], &moved).text;
        let found = compared(&one, &two, &Tolerances::default());
        let [Finding::Moved { by_mm }] = &found.findings[..] else {
            panic!("{by:?}: {:?}", found.findings);
        };
        assert_eq!(*by_mm, [by[0], by[1], 0.0]);
        // What else is another is told beside it.
        let hotter = two.replacen("M109 S210", "M109 S230", 1);
        let lower = with(&hotter, end(&hotter), "M104", "G0 Z-30 F1000\n");
        let mut kinds = compared(&one, &lower, &Tolerances::default()).findings;
        // The way down takes its time.
        kinds.retain(|one| !matches!(one, Finding::Sum { layer: None, .. }));
        assert!(matches!(kinds[0], Finding::Moved { .. }), "{kinds:?}");
        assert!(matches!(kinds[1], Finding::Heaters { .. }), "{kinds:?}");
        assert!(matches!(kinds[2], Finding::Travels { layer: None, .. }), "{kinds:?}");
        assert_eq!(kinds.len(), 3, "{kinds:?}");
    }
    // Upwards: by less than a layer, and by as much as three.
    for up in [0.07, 0.6] {
        let (start, rest) = made.split_at(layer(made, 1));
        let (layers, end) = rest.split_at(rest.rfind(";TYPE:Custom").unwrap());
        let layers = layers.lines().map(|line| raised(line, up) + "\n").collect::<String>();
        let raised = [start, &layers, end].concat();
        let found = compared(made, &raised, &Tolerances::default());
        let [Finding::Moved { by_mm }] = &found.findings[..] else {
            panic!("{up}: {:?}", found.findings);
        };
        assert_eq!(*by_mm, [0.0, 0.0, up]);
    }
}

#[test]
fn a_part_that_moved_alone_is_one_finding() {
    let made = squares(4, &THREE, |_| 0);
    let moved = [THREE[0], [41.0, 9.5], THREE[2]];
    let found = compared(&made, &squares(4, &moved, |_| 0), &Tolerances::default());
    let [Finding::PartMoved(part)] = &found.findings[..] else { panic!("{:?}", found.findings) };
    assert_eq!((part.by_mm, part.box_mm), ([1.0, -0.5], [[40.0, 10.0], [60.0, 30.0]]));
    assert_eq!(found.parts_moved, [*part]);
    // Two of them, each its own way; and what else is another is told beside it.
    let both = [[9.0, 10.0], THREE[1], [70.0, 22.0]];
    let other = squares(4, &both, |_| 0);
    let found = compared(&made, &other, &Tolerances::default()).findings;
    let by = |one: &Finding| match one {
        Finding::PartMoved(part) => Some(part.by_mm),
        _ => None,
    };
    let all: Vec<_> = found.iter().map(by).collect();
    assert_eq!(all, [Some([0.0, 2.0]), Some([-1.0, 0.0])]);
    let thick = other.replacen("E0.666", "E0.9", 1);
    let found = compared(&made, &thick, &Tolerances::default()).findings;
    let flow = |one: &Finding| matches!(one, Finding::Flow { .. });
    assert!(found.iter().any(flow) && found.iter().filter_map(by).count() == 2, "{found:?}");
    // A part of another shape did not move.
    let turned = made.replace("X60 Y30", "X61 Y30");
    let found = compared(&made, &turned, &Tolerances::default()).findings;
    assert!(found.iter().filter_map(by).count() == 0 && found.len() >= 4, "{found:?}");
}

#[test]
fn limits_and_long_waits_of_one_file_are_one_finding() {
    let made = squares(4, &THREE, |_| 0);
    let at = layer(&made, 3);
    let told = with(&made, at, "G1", "M204 S300\nM203 X40\n");
    let again = with(&told, layer(&told, 4), "G1", "M204 S300\nG4 S3600\nG4 S2\n");
    let mut found = compared(&made, &again, &Tolerances::default()).findings;
    found.retain(|one| !matches!(one, Finding::Sum { layer: None, .. }));
    let [Finding::Limits { difference }] = &found[..] else { panic!("{found:?}") };
    let named = "acceleration 300 mm/s², acceleration of travels 300 mm/s², highest speed of x 40 mm/s, wait of 3600 s";
    assert_eq!(
        difference.only,
        Both { a: vec![], b: named.split(", ").map(str::to_owned).collect() }
    );
    let line = again[..again.find("M204").unwrap()].lines().count() as u64 + 1;
    assert_eq!(difference.line, Both { a: None, b: Some(line) });
}

/// The line with its z raised.
fn raised(line: &str, by: f64) -> String {
    let z = line.strip_prefix("G1 Z").and_then(|rest| rest.split_once(' '));
    let z = z.and_then(|(z, rest)| Some((z.parse::<f64>().ok()?, rest)));
    match z {
        Some((z, rest)) => format!("G1 Z{:.3} {rest}", z + by),
        None => line.to_owned(),
    }
}

#[test]
fn what_is_found_does_not_depend_on_threads_or_windows() {
    let made = squares(600, &THREE, |_| 0);
    let other =
        squares(600, &THREE, |layer| usize::from(layer > 300)).replace("X60 Y10", "X60.5 Y10");
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| diff(&side(&made), &side(&other), &Tolerances::default()).unwrap())
    };
    let (one, many) = (with(1), with(4));
    assert_eq!(one, many);
    assert_eq!(one.pairs.len(), 601);
    let numbers = one.pairs.iter().map(|pair| pair.layer.a.unwrap());
    assert!(numbers.eq(0..=600));
}

const TILE: &str = "fixtures/golden/tile@generic-marlin.gcode";

#[test]
fn quiet_leaves_the_exit_code_alone() {
    let tile = std::fs::read_to_string(TILE).unwrap();
    slicer(&["diff", TILE, "-", "-q"]).write_stdin(tile.clone()).assert().code(0).stdout("");
    let lower = with(&tile, end(&tile), "M104", "G0 Z-30\n");
    let run = slicer(&["diff", TILE, "-", "-q"]).write_stdin(lower.clone()).assert();
    run.code(1).stdout("").stderr("");
    let words = ["diff", TILE, "-", "-q", "--ignore", "travels", "--sums", "20"];
    slicer(&words).write_stdin(lower).assert().code(0);
    slicer(&["diff", TILE, "none.gcode", "-q"]).assert().code(3);
}

#[test]
fn json_is_as_its_schema_says() {
    let schema: serde_json::Value =
        serde_json::from_slice(&slicer(&["diff", "--schema"]).assert().code(0).get_output().stdout)
            .unwrap();
    let mut schemas = boon::Schemas::new();
    let mut compiler = boon::Compiler::new();
    compiler.add_resource("schema.json", schema).unwrap();
    let index = compiler.compile("schema.json", &mut schemas).unwrap();
    let made = squares(4, &THREE, |_| 0);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.gcode");
    std::fs::write(&path, &made).unwrap();
    let others = [
        made.clone(),
        squares(4, &THREE, |layer| layer % 4),
        squares(5, &[THREE[2], THREE[0]], |_| 0),
        squares(4, &THREE.map(|[x, y]| [x + 3.0, y]), |_| 0).replacen("G1 E0.8 F1800", "M106", 1),
        squares(4, &[THREE[1], THREE[0], THREE[2]], |_| 0),
    ];
    let mut kinds = Vec::new();
    for other in others {
        for ignore in [&["--settings"][..], &["--ignore", "travels,seams"]] {
            let words = [&["diff", path.to_str().unwrap(), "-", "--json"][..], ignore].concat();
            let run = slicer(&words).write_stdin(other.clone()).assert();
            let json: serde_json::Value = serde_json::from_slice(&run.get_output().stdout).unwrap();
            schemas.validate(&json, index).map_err(|error| error.to_string()).unwrap();
            let findings = json["findings"].as_array().unwrap();
            kinds.extend(findings.iter().map(|one| one["kind"].as_str().unwrap().to_owned()));
            let mut wrong = json.clone();
            wrong["pairs"] = "many".into();
            assert!(schemas.validate(&wrong, index).is_err());
        }
    }
    for kind in ["moved", "seams", "travels", "order", "retractions", "layers-only-in"] {
        assert!(kinds.iter().any(|known| known == kind), "{kind} is not in {kinds:?}");
    }
}

#[test]
fn pictures_show_both_files_in_two_colours() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let made = squares(4, &THREE, |_| 0);
    let other = made.replacen("X30 Y30", "X32 Y30", 1);
    assert_ne!(made, other);
    std::fs::write(at("a.gcode"), &made).unwrap();
    std::fs::write(at("b.gcode"), &other).unwrap();
    let (a, b) = (at("a.gcode"), at("b.gcode"));
    let draw = |out: &str, b: &str, code| {
        slicer(&["diff", &a, b, "-q", "-o", &at(out)]).assert().code(code).stderr("");
        std::fs::read(at(out)).unwrap()
    };
    let (first, second) = ("#0072b2", "#d55e00");
    let svg = String::from_utf8(draw("x.svg", &b, 1)).unwrap();
    let strokes = |svg: &str, colour: &str| svg.matches(&format!("stroke=\"{colour}\"")).count();
    assert!(strokes(&svg, first) > 0 && strokes(&svg, second) > 0, "{svg}");
    assert!(svg.contains("A: layer 1, z 0.2"), "{svg}");
    let same = String::from_utf8(draw("y.svg", &a.clone(), 0)).unwrap();
    assert_eq!((strokes(&same, first), strokes(&same, second)), (0, 0));
    assert!(draw("x.png", &b, 1).starts_with(b"\x89PNG"));
    let page = String::from_utf8(draw("x.html", &b, 1)).unwrap();
    assert!(page.contains("outer wall") && page.contains("data:image/svg+xml;base64,"), "{page}");
    assert!(!page.contains("http"), "it needs no network");
    let wrong = slicer(&["diff", &a, &b, "-o", &at("x.pdf")]).assert().code(2);
    let told = String::from_utf8(wrong.get_output().stderr.clone()).unwrap();
    assert!(told.contains("use .html, .svg or .png"), "{told}");
    slicer(&["diff", &a, &b, "-o", &b]).assert().code(2);
    slicer(&["diff", &a, &b, "-o", &at("none/x.svg")]).assert().code(4);
}

#[test]
fn a_file_without_a_stamp_names_no_version_and_prints_the_same() {
    let stamped = slice(&fixture("tile.stl"), "generic-marlin", &[]).text;
    let plain = slice(&fixture("tile.stl"), "generic-marlin", &[("output.stamp", "none")]).text;
    let version = env!("CARGO_PKG_VERSION");
    let head = |text: &str| text.lines().take(3).collect::<Vec<_>>().join("\n");
    assert!(head(&stamped).contains(version) && !head(&plain).contains(version));
    // Clients find the same words in the same places.
    assert_eq!(
        head(&plain).replace("0.0.0", version).replace("neither version nor date", "no date"),
        head(&stamped)
    );
    let differs = stamped.lines().zip(plain.lines()).filter(|(a, b)| a != b).count();
    assert_eq!(differs, 3, "two of the head and the setting");
    assert!(compared(&stamped, &plain, &Tolerances::default()).equal);
}
