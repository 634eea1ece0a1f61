//! STL bytes -> Mesh: tests that both forms agree, damage never panics and real files load.

use proptest::prelude::*;
use slicer::error::Error;
use slicer::mesh::faults::Fault;
use slicer::mesh::{Bed, Placement, RawMesh, place, read};
use std::path::{Path, PathBuf};

const MOST: usize = read::DEFAULT_MAX_TRIANGLES;

type Corners = [[f32; 3]; 3];

fn binary(triangles: &[Corners]) -> Vec<u8> {
    let mut bytes = vec![b' '; 80];
    bytes.extend(u32::try_from(triangles.len()).expect("a short list").to_le_bytes());
    for triangle in triangles {
        bytes.extend([0; 12]);
        bytes.extend(triangle.as_flattened().iter().flat_map(|number| number.to_le_bytes()));
        bytes.extend([0; 2]);
    }
    bytes
}

fn ascii(triangles: &[Corners]) -> Vec<u8> {
    let mut text = "solid\n".to_owned();
    for triangle in triangles {
        text += "facet normal 0 0 0\nouter loop\n";
        for [x, y, z] in triangle {
            text += &format!("vertex {x} {y:e} {z}\n");
        }
        text += "endloop\nendfacet\n";
    }
    text += "endsolid\n";
    text.into_bytes()
}

/// The triangles by their coordinates, each begun at its least corner, in order.
fn canonical(mesh: &RawMesh) -> Vec<[[u32; 3]; 3]> {
    let corner = |&v: &u32| mesh.vertices[v as usize].map(f32::to_bits);
    let mut all: Vec<[[u32; 3]; 3]> = mesh
        .triangles
        .iter()
        .map(|[a, b, c]| {
            let turns = [[a, b, c], [b, c, a], [c, a, b]].map(|turn| turn.map(corner));
            turns.into_iter().min().unwrap_or_default()
        })
        .collect();
    all.sort_unstable();
    all
}

/// Numbers of few distinct values, so that corners often meet, and of all kinds.
fn number() -> impl Strategy<Value = f32> {
    prop_oneof![4 => (-2_i8..3).prop_map(f32::from), 1 => -1e9_f32..1e9, 1 => Just(1e-42_f32), 1 => Just(-0.0_f32)]
}

fn triangles() -> impl Strategy<Value = Vec<Corners>> {
    let corner = || [number(), number(), number()];
    let good = [[7.0, 0.0, 0.0], [0.0, 7.0, 0.0], [0.0, 0.0, 7.0]];
    prop::collection::vec([corner(), corner(), corner()], 0..40).prop_map(move |mut all| {
        all.push(good);
        all
    })
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn binary_and_ascii_are_one_mesh(triangles in triangles()) {
        let a = read::from_bytes("x", &binary(&triangles), MOST).unwrap();
        let b = read::from_bytes("x", &ascii(&triangles), MOST).unwrap();
        prop_assert_eq!(&a.vertices, &b.vertices);
        prop_assert_eq!(&a.triangles, &b.triangles);
        prop_assert_eq!(a.degenerate, b.degenerate);
        prop_assert_eq!(a.triangles.len() + a.degenerate, triangles.len());
    }

    #[test]
    fn the_order_of_triangles_changes_nothing(
        (plain, shuffled) in triangles().prop_flat_map(|all| (Just(all.clone()), Just(all).prop_shuffle()))
    ) {
        let [a, b] = [plain, shuffled].map(|all| read::from_bytes("x", &binary(&all), MOST).unwrap());
        prop_assert_eq!(canonical(&a), canonical(&b));
        prop_assert_eq!(a.vertices.len(), b.vertices.len());
        // Where there is something to place, it is measured alike.
        if let (Ok(a), Ok(b)) = (placed(a), placed(b)) {
            prop_assert_eq!(&a.reports, &b.reports);
            prop_assert_eq!(a.size_mm, b.size_mm);
        }
    }

    #[test]
    fn damage_never_panics(
        form in any::<bool>(),
        triangles in triangles(),
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..6),
        cut in prop::option::of(any::<prop::sample::Index>()),
    ) {
        let mut bytes = if form { binary(&triangles) } else { ascii(&triangles) };
        for (at, byte) in changes {
            let at = at.index(bytes.len());
            bytes[at] = byte;
        }
        if let Some(cut) = cut {
            bytes.truncate(cut.index(bytes.len()));
        }
        check(&bytes).ok();
    }

    #[test]
    fn noise_never_panics(bytes in prop::collection::vec(any::<u8>(), 0..400), solid in any::<bool>()) {
        let start: &[u8] = if solid { b"solid facet" } else { b"" };
        check(&[start, &bytes].concat()).ok();
    }
}

fn placed(mesh: RawMesh) -> slicer::mesh::Result<place::Placed> {
    let placement = Placement::default();
    let bed = Bed { min: [0.0; 2], max: [400.0; 2], height: 400.0 };
    place::place(vec![mesh], &placement, &bed)
}

/// Reads and places; a refusal must be one line that names the file.
fn check(bytes: &[u8]) -> Result<place::Placed, Error> {
    let result = read::from_bytes("x.stl", bytes, MOST).and_then(placed).map_err(Error::from);
    if let Err(error) = &result {
        let text = error.to_string();
        assert!(text.starts_with("x.stl: ") && !text.contains(char::is_control), "{text:?}");
        assert!(text.len() < 300, "{text}");
        assert_eq!(error.exit_code(), 3);
    }
    result
}

/// The message of a test that finds no models.
const SKIPPED: &str = "skipped: SLICER_MODELS names no folder of models";

/// The folder of models, if there is one on this machine.
fn models() -> Option<PathBuf> {
    std::env::var_os("SLICER_MODELS").map(PathBuf::from)
}

fn stl_files(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder)
        .expect("the folder of models")
        .map(|entry| entry.expect("an entry of it").path());
    let mut files: Vec<_> =
        entries.filter(|path| path.extension().is_some_and(|end| end == "stl")).collect();
    files.sort();
    assert!(!files.is_empty(), "no models in {}", folder.display());
    files
}

#[test]
fn real_models_load() {
    let Some(folder) = models() else { return println!("{SKIPPED}") };
    for path in [stl_files(&folder), stl_files(&folder.join("thesis"))].concat() {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        let result = check(&std::fs::read(&path).unwrap());
        if name.contains("empty") {
            assert!(result.unwrap_err().to_string().contains("no triangles"), "{name}");
            continue;
        }
        if name.contains("soup") {
            assert!(result.unwrap_err().to_string().contains("cannot be mended"), "{name}");
            continue;
        }
        let placed = result.unwrap_or_else(|error| panic!("{name}: {error}"));
        // What the list of models says is open.
        let open = ["castle", "impeller", "spikey", "multibody"];
        let expected = open.iter().any(|part| name.contains(part));
        let report = &placed.reports[0];
        let of_edges = [Fault::OpenEdge, Fault::FlippedEdge];
        let is_open = report.found.iter().any(|fault| of_edges.contains(&fault.kind));
        assert_eq!(is_open, expected, "{name}: {report:?}");
    }
}

#[test]
fn good_files_read_as_by_another_reader() {
    let Some(folder) = models() else { return println!("{SKIPPED}") };
    // Files that the other reader refuses, though they are good.
    let beyond_it = ["malformed", "multibody"];
    for path in [stl_files(&folder), stl_files(&folder.join("thesis"))].concat() {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        if beyond_it.iter().any(|part| name.contains(part)) || name.contains("500k") {
            continue;
        }
        let bytes = std::fs::read(&path).unwrap();
        let other = stl_io::read_stl(&mut std::io::Cursor::new(&bytes)).unwrap();
        let theirs: Vec<Corners> =
            other.faces.iter().map(|face| face.vertices.map(|v| other.vertices[v].0)).collect();
        let same = |corners: &Corners| {
            corners[0] != corners[1] && corners[1] != corners[2] && corners[2] != corners[0]
        };
        let theirs: Vec<Corners> = theirs.into_iter().filter(same).collect();
        let mesh = read::from_bytes(&name, &bytes, MOST).unwrap();
        let ours = mesh.triangles.iter().map(|corners| corners.map(|v| mesh.vertices[v as usize]));
        assert!(ours.eq(theirs), "{name}");
    }
}

#[test]
fn broken_models_are_read_or_refused_with_a_reason() {
    let Some(folder) = models() else { return println!("{SKIPPED}") };
    let table = std::fs::read_to_string(folder.join("broken/EXPECT.tsv")).unwrap();
    let good = placed(read::from_path(folder.join("broken/good_tower.stl"), MOST).unwrap());
    let good = good.unwrap().reports[0].volume_mm3;
    let mut tested = 0;
    for line in table.lines().skip(1) {
        let fields: Vec<&str> = line.split('\t').collect();
        let result = check(&std::fs::read(folder.join("broken").join(fields[0])).unwrap());
        match &result {
            Ok(placed) => println!("{}: {:?}", fields[0], placed.warnings),
            Err(error) => println!("{}: {error}", fields[0]),
        }
        let expected = fields[3];
        if expected.starts_with("slice exactly as good_tower") {
            let volume = result.unwrap().reports[0].volume_mm3;
            assert!((volume / good - 1.0).abs() < 1e-6, "{}: {volume}, not {good}", fields[0]);
        } else if expected.starts_with("refuse with") || expected.starts_with("reject") {
            assert!(result.is_err(), "{}", fields[0]);
        } else if !expected.starts_with("refuse") && !expected.contains("or refuse") {
            assert!(result.is_ok(), "{}", fields[0]);
        }
        tested += 1;
    }
    assert!(tested > 60);
}

#[test]
fn the_fixture_in_both_forms_is_one_mesh() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures");
    let load = |name: &str| read::from_path(folder.join(name), MOST).unwrap();
    let (a, b) = (load("cube_20.stl"), load("cube_ascii.stl"));
    assert_eq!((a.report.format, b.report.format), ("binary", "ascii"));
    assert_eq!((&a.vertices, &a.triangles), (&b.vertices, &b.triangles));
    assert_eq!((a.vertices.len(), a.triangles.len()), (8, 12));
}
