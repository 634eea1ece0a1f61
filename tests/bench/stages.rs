//! Models -> time per stage: the stages one by one, then the whole run into a sink.
//!
//! `cargo bench --bench stages` measures fixtures/bracket.stl; with
//! `SLICER_MODELS=folder` also the models named in [`LARGE`], as far as the folder
//! holds them. Words behind `--` pick some, such as `-- femur` or `-- whole`.

#![allow(clippy::print_stderr, reason = "says what is not measured")]
#![allow(clippy::print_stdout, reason = "the result of a bench is what it prints")]

mod stopwatch;

use hashbrown::HashMap;
use nalgebra::Vector3;
use slicer::Job;
use slicer::fill::{self, FillParams};
use slicer::gcode::moves::{MoveParams, Moves};
use slicer::gcode::times::Timer;
use slicer::gcode::write::{Before, WriteParams};
use slicer::mesh::place::{Placed, place};
use slicer::mesh::{Bed, Placement, read};
use slicer::motion::Limits;
use slicer::pipeline;
use slicer::plan::order::{self, Unordered};
use slicer::plan::{Nozzle, PlanParams, Seams, Toolpath, travel};
use slicer::profile::{self, Override, Settings, ValueOrigin};
use slicer::region::dual::groups::Grouping;
use slicer::region::prepare::{LayerRows, prepare};
use slicer::region::scan::Scan;
use slicer::region::window::Window;
use slicer::region::{Region, RegionParams, classify, walls};
use slicer::slice::{Heights, Layer, Slicer};
use slicer::units::to_units;
use std::hint::black_box;
use std::path::{Path, PathBuf};
use stopwatch::Bench;

/// Name in the results and file in the folder of large models.
const LARGE: [(&str, &str); 5] = [
    ("saddle", "thesis/surf_hypar.stl"),
    ("femur", "scan_femur.stl"),
    ("liver", "scan_liver.stl"),
    ("benchy", "calib_3dbenchy.stl"),
    ("brain", "scan_brain_mni152_500k.stl"),
];

/// Without what makes a print stick, cool and look well.
const PLAIN: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/bench/plain.toml");

/// A model, and what it becomes under the settings of the comparison: one wall, dual.
struct Model {
    name: &'static str,
    file: PathBuf,
    bytes: Vec<u8>,
    settings: Settings,
    params: RegionParams,
}

impl Model {
    fn new(name: &'static str, file: PathBuf) -> Self {
        let overrides = [set("walls", "1"), set("dual.mode", "pair")];
        let settings =
            profile::load(["generic-marlin", PLAIN], &overrides).expect("they are here").settings;
        let bytes = std::fs::read(&file).expect("the model can be read");
        let params = RegionParams::new(&settings);
        Self { name, file, bytes, settings, params }
    }

    fn place(&self) -> Placed {
        let machine = &self.settings.machine;
        let bed = Bed {
            min: [0.0, 0.0],
            max: [machine.bed_width, machine.bed_depth],
            height: machine.bed_height,
        };
        let raw = read::from_bytes(self.name, &self.bytes, read::DEFAULT_MAX_TRIANGLES)
            .expect("a sound model");
        place(vec![raw], &placement(), &bed).expect("it fits")
    }

    fn slicer<'a>(&self, placed: &'a Placed) -> Slicer<'a> {
        let top = placed.mesh.vertices.iter().map(|v| v[2]).max().unwrap_or(0);
        let first = to_units(self.settings.first_layer_height);
        let heights = Heights::even(first, to_units(self.settings.layer_height), top);
        let tolerance = to_units(self.settings.tolerance);
        Slicer::new(&placed.mesh, &placed.adjacency, heights, tolerance)
    }

    /// All regions of the print.
    fn regions(&self) -> Vec<Region> {
        let placed = self.place();
        let slicer = self.slicer(&placed);
        let grouping = Grouping::new(&self.settings.dual, self.settings.dual_ratio());
        Window::new(&slicer, &self.params, &grouping, None).flatten().collect()
    }
}

fn set(key: &str, value: &str) -> Override {
    Override { key: key.to_owned(), value: value.to_owned(), origin: ValueOrigin::Set }
}

fn placement() -> Placement {
    Placement::default()
}

/// The bracket, and the large models that are there.
fn models() -> Vec<Model> {
    let fixture = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/bracket.stl");
    let mut models = vec![Model::new("bracket", fixture)];
    let Some(folder) = std::env::var_os("SLICER_MODELS").map(PathBuf::from) else {
        eprintln!("SLICER_MODELS names no folder: only the bracket is measured");
        return models;
    };
    for (name, file) in LARGE {
        let file = folder.join(file);
        if file.is_file() {
            models.push(Model::new(name, file));
        } else {
            eprintln!("{} is missing: skipped", file.display());
        }
    }
    models
}

/// The least that can be asked of a binary STL: its corners told apart by a hash, and the sum
/// of its triangles' areas, mm².
fn weld_and_sum(bytes: &[u8]) -> (usize, f64) {
    let mut numbers: HashMap<[u32; 3], u32> = HashMap::new();
    let mut corners: Vec<[f32; 3]> = Vec::new();
    let mut area = 0.0;
    for record in bytes[84..].chunks_exact(50) {
        let float = |at: usize| f32::from_le_bytes(std::array::from_fn(|k| record[at + k]));
        let triangle = [12, 24, 36].map(|at| {
            let corner = [float(at), float(at + 4), float(at + 8)];
            let next = corners.len() as u32;
            let number = *numbers.entry(corner.map(f32::to_bits)).or_insert(next);
            if number == next {
                corners.push(corner);
            }
            Vector3::from(corners[number as usize])
        });
        let [a, b, c] = triangle;
        area += f64::from((b - a).cross(&(c - a)).norm()) / 2.0;
    }
    (corners.len(), area)
}

/// Bytes to a welded mesh, to an oriented one on the bed, to contours.
fn mesh_and_slice(bench: &Bench, model: &Model) {
    let group = bench.group("mesh", model.name);
    group.time("yardstick", || weld_and_sum(black_box(&model.bytes)));
    group.time("parse and weld", || {
        read::from_bytes(model.name, black_box(&model.bytes), read::DEFAULT_MAX_TRIANGLES)
    });
    group.time("parse and place", || black_box(model).place());
    let placed = model.place();
    let slicer = model.slicer(&placed);
    let group = bench.group("slice", model.name);
    group.time("bucket triangles", || model.slicer(black_box(&placed)));
    group.time("middle block", || slicer.block(black_box(slicer.blocks() / 2)));
}

/// All layers of a block, one after the other: what each part of the pass costs.
fn region(bench: &Bench, model: &Model) {
    let placed = model.place();
    let slicer = model.slicer(&placed);
    let layers: Vec<Layer> = slicer.block(slicer.blocks() / 2);
    let params = &model.params;
    let group = bench.group("region, middle block", model.name);
    group.time("walls", || {
        layers
            .iter()
            .map(|l| walls::walls(&l.contours, false, &params.walls).walls.len())
            .sum::<usize>()
    });
    group.time("raster scan", || {
        layers.iter().map(|l| scan(l, params).inside().total()).sum::<i64>()
    });
    let scans: Vec<Scan> = layers.iter().map(|l| scan(l, params)).collect();
    group.time("inset", || scans.iter().map(|s| s.inset(params.insets.fill).total()).sum::<i64>());
    let rows: Vec<LayerRows> = layers.iter().map(|l| prepare(l.clone(), params).1).collect();
    let areas = |k: usize| {
        let (fill, raster) = (&rows[k].skin(0).fill, params.rasters.skin(0));
        let exposed = classify::exposed(k, raster, &|k| rows.get(k), &params.skins);
        classify::areas(fill, &exposed, None, raster.pitch, &params.skins).skin.total()
    };
    group.time("classify", || (0..rows.len()).map(areas).sum::<i64>());
}

fn scan(layer: &Layer, params: &RegionParams) -> Scan {
    Scan::new(&layer.contours, params.rasters.skin(0))
}

/// The numbers of filling, for layers that are enough for every model.
fn fill_params(model: &Model) -> FillParams {
    FillParams::new(&model.settings, model.slicer(&model.place()).heights())
}

/// All regions of a print to paths, and to paths in order.
fn fill_and_plan(bench: &Bench, model: &Model) {
    let regions = model.regions();
    let (fill, plan) = (fill_params(model), PlanParams::new(&model.settings));
    let paths = || regions.iter().map(|r| fill::paths(r, &fill)).collect::<Vec<_>>();
    let group = bench.group("plan", model.name);
    group.time("fill", paths);
    let order = |all: Vec<Vec<fill::Path>>| {
        let (mut nozzle, mut seams) = (Nozzle::default(), Seams::default());
        for (region, paths) in regions.iter().zip(all) {
            let paths = Unordered::new(paths, &region.layer.contours, &plan);
            let paths = order::order(paths, nozzle.at.unwrap_or_default(), &mut seams, &plan);
            nozzle = nozzle.after(&region.layer, &paths);
        }
        nozzle
    };
    group.time_with("order", paths, order);
}

/// All toolpaths of a print to moves, to text and to times.
fn gcode(bench: &Bench, model: &Model) {
    let (fill, plan) = (fill_params(model), PlanParams::new(&model.settings));
    let (mut nozzle, mut seams) = (Nozzle::default(), Seams::default());
    let toolpath = |region: &Region| {
        let paths = Unordered::new(fill::paths(region, &fill), &region.layer.contours, &plan);
        let paths = order::order(paths, nozzle.at.unwrap_or_default(), &mut seams, &plan);
        let next = nozzle.after(&region.layer, &paths);
        travel::toolpath(&region.layer, paths, std::mem::replace(&mut nozzle, next), &plan)
    };
    let toolpaths: Vec<Toolpath> = model.regions().iter().map(toolpath).collect();
    let params = MoveParams::new(&model.settings, [150.0; 2]);
    let moves = || toolpaths.iter().map(|layer| params.moves(layer)).collect::<Vec<_>>();
    let group = bench.group("gcode", model.name);
    group.time("moves", moves);
    let layers: Vec<Moves> = moves();
    let params = WriteParams::new(&model.settings);
    let text = || {
        layers.iter().map(|layer| params.layer(layer, Before::default()).text.len()).sum::<usize>()
    };
    group.time("text", text);
    group.time("times", || {
        let mut timer = Timer::new(Limits::new(&model.settings));
        layers.iter().for_each(|layer| timer.layer(layer));
        timer.finish();
        timer.times().total()
    });
}

/// A print of a model.
fn job(model: &Model, settings: Settings) -> Job {
    Job {
        models: vec![slicer::Model::path(model.file.clone())],
        placement: placement(),
        settings,
        sources: slicer::profile::Sources::default(),
    }
}

/// From the file to G-code that nobody keeps, on all cores and on one.
fn whole(bench: &Bench, model: &Model) {
    let job = job(model, model.settings.clone());
    let run = || slicer::slice(&job, &mut std::io::empty(), &Default::default());
    let group = bench.group("whole", model.name);
    group.time("all cores", run);
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("one thread");
    one.install(|| group.time("one core", run));
}

/// What skins that follow the surface cost, on one core, as shipped: finding them, and the whole print beside
/// the flat one.
fn skins(bench: &Bench, model: &Model) {
    let settings = |on: &str| {
        let overrides = [set("nonplanar.enabled", on), set("head.name", "long-0.6")];
        profile::load(["generic-marlin"], &overrides).expect("it is here").settings
    };
    let [flat, curved] = ["false", "true"].map(settings);
    let placed = model.place();
    let slicer = model.slicer(&placed);
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("one thread");
    let group = bench.group("skins", model.name);
    one.install(|| {
        group.time("find", || pipeline::curved::find(&curved, &placed, &slicer, None).is_some());
    });
    let [flat, curved] = [("flat", &flat), ("curved", &curved)].map(|(name, settings)| {
        let job = job(model, settings.clone());
        let run = || slicer::slice(&job, &mut std::io::empty(), &Default::default());
        one.install(|| group.time(name, run))
    });
    if let (Some(flat), Some(curved)) = (flat, curved) {
        println!("{:<44} {:8.2}", format!("skins/curved : flat/{}", model.name), curved / flat);
    }
}

fn main() {
    let bench = Bench::from_arguments();
    for model in models() {
        mesh_and_slice(&bench, &model);
        region(&bench, &model);
        fill_and_plan(&bench, &model);
        gcode(&bench, &model);
        whole(&bench, &model);
        skins(&bench, &model);
    }
}
