//! Stacks of layers, whole prints -> laws: tests dual injection for groups of any number of layers.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common::solid::circle;
use crate::common::stack::{Stack, stack, stacks};
use crate::common::{Kind, Run, Solid, fixture, settings, slice, slice_shipped};
use proptest::prelude::*;
use slicer::check::check;
use slicer::check::finding::Code;
use slicer::check::terms::Terms;
use slicer::geom::raster::Raster;
use slicer::geom::spans::{Rows, Span};
use slicer::pattern::{Pattern, Turns};
use slicer::profile::Settings;
use slicer::reader;
use slicer::region::divide::{LayerAreas, divide, examine};
use slicer::region::dual;
use slicer::region::dual::audit::Audit;
use slicer::region::dual::groups::{Block, Grouping, Lane};
use slicer::region::dual::inner_skin::{self, Skins};
use slicer::region::{RegionParams, Sparse};
use std::collections::{BTreeMap, BTreeSet};

const MODES: [&str; 2] = ["pair", "interlaced"];
const PATTERNS: [&str; 4] = ["rectilinear", "aligned", "grid", "triangles"];

fn all_areas(layers: &Stack, params: &RegionParams) -> Vec<LayerAreas> {
    let rows = |k: usize| layers.rows.get(k);
    let areas = |own| {
        let examined = examine(own, &rows, params);
        divide(own, &examined, params.rasters.iter(), &rows, None, params).areas
    };
    layers.own.iter().map(areas).collect()
}

/// The blocks that `count` layers make.
fn blocks(grouping: &Grouping, count: usize) -> Vec<Block> {
    let mut blocks: Vec<Block> = Vec::new();
    while let Some(from) =
        Some(blocks.last().map_or(0, |b| b.layers.end)).filter(|&from| from < count)
    {
        blocks.push(grouping.block(from, count));
    }
    blocks
}

fn grouping(settings: &Settings) -> Grouping {
    Grouping::new(&settings.dual, settings.dual_ratio())
}

/// Settings of groups of `ratio` layers, as thin as they have to be.
fn grouped(mode: &str, ratio: u32, pattern: &str) -> Settings {
    let (ratio, height) = (ratio.to_string(), (0.4 / f64::from(ratio)).to_string());
    let set = [
        ("dual.mode", mode),
        ("dual.ratio", &ratio),
        ("layer_height", &height),
        ("pattern", pattern),
        ("skin_layers", "1"),
    ];
    settings("generic-marlin", &set)
}

/// The length of what a pattern prints on `rows`, however short.
fn length(pattern: &Pattern, rows: &Rows) -> i64 {
    pattern.length(rows, 0)
}

/// The length of what sparse regions print in strands as long as a line is wide.
fn printed(all: &[Sparse], params: &RegionParams) -> i64 {
    all.iter().map(|sparse| sparse.length(params.walls.line_width)).sum()
}

/// The infill of every layer: what it prints, and what it has.
struct Filled {
    sparse: Vec<Vec<Sparse>>,
    areas: Vec<LayerAreas>,
    blocks: Vec<Block>,
}

fn fill(layers: &Stack, params: &RegionParams, grouping: &Grouping) -> Filled {
    let areas = all_areas(layers, params);
    let blocks = blocks(grouping, areas.len());
    let infill = |block: &Block| infill(&areas, block, params, grouping).0;
    let sparse = blocks.iter().flat_map(infill).collect();
    Filled { sparse, areas, blocks }
}

/// The infill of a block, and what became of it.
fn infill(
    areas: &[LayerAreas],
    block: &Block,
    params: &RegionParams,
    grouping: &Grouping,
) -> (Vec<Vec<Sparse>>, Option<Audit>) {
    let (turns, line_width) = (&params.sparse, params.walls.line_width);
    dual::infill(block, &of_block(areas, block), grouping, turns, line_width)
}

/// Whether a sparse region is filled by the share of this lane.
fn is_of(sparse: &Sparse, lane: &Lane) -> bool {
    format!("{:?}", sparse.pattern) == format!("{:?}", lane.pattern)
}

fn of_block<'a>(areas: &'a [LayerAreas], block: &Block) -> Vec<&'a LayerAreas> {
    areas[block.layers.clone()].iter().collect()
}

fn infill_of<'a>(areas: &'a LayerAreas, pattern: &Pattern) -> &'a Rows {
    &areas.on(pattern.raster()).unwrap().infill
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    #[test]
    fn every_place_of_every_layer_is_printed_once_and_no_line_lies_over_nothing(
        outlines in stacks(), mode in 0..2_usize, ratio in 2..6_u32, pattern in 0..4_usize,
    ) {
        let settings = grouped(MODES[mode], ratio, PATTERNS[pattern]);
        let (params, grouping) = (RegionParams::new(&settings), grouping(&settings));
        let layers = stack(&params, &outlines);
        let filled = fill(&layers, &params, &grouping);
        for block in &filled.blocks {
            let lanes = params.sparse.of(block.turn).iter().flat_map(|p| grouping.lanes(p));
            for lane in lanes {
                // What is left of each layer's lines when what is printed is taken away.
                let mut left: BTreeMap<usize, Rows> = block.layers.clone()
                    .map(|k| (k, infill_of(&filled.areas[k], &lane.pattern).clone()))
                    .collect();
                for k in block.layers.clone() {
                    for sparse in filled.sparse[k].iter().filter(|s| is_of(s, &lane)) {
                        prop_assert!((1..=ratio).contains(&sparse.layers));
                        for down in k + 1 - sparse.layers as usize..=k {
                            let rest = left.get_mut(&down);
                            prop_assert!(rest.is_some(), "a line reaches out of its block");
                            let rest = rest.unwrap();
                            prop_assert!(sparse.rows.minus(rest).is_empty(), "over nothing, or twice");
                            *rest = rest.minus(&sparse.rows);
                        }
                    }
                }
                prop_assert!(left.values().all(Rows::is_empty), "a hollow place");
            }
        }
    }

    #[test]
    fn the_material_is_that_of_all_layers(
        outlines in stacks(), mode in 0..2_usize, ratio in 2..6_u32, pattern in 0..4_usize,
    ) {
        let settings = grouped(MODES[mode], ratio, PATTERNS[pattern]);
        let (params, grouping) = (RegionParams::new(&settings), grouping(&settings));
        let layers = stack(&params, &outlines);
        let filled = fill(&layers, &params, &grouping);
        for block in &filled.blocks {
            // Rooms that are filled solidly are another pattern.
            let printed: i64 = block.layers.clone().flat_map(|k| &filled.sparse[k])
                .filter(|s| !s.pattern.is_solid())
                .map(|s| i64::from(s.layers) * length(&s.pattern, &s.rows))
                .sum();
            let patterns = params.sparse.of(block.turn);
            let plain: i64 = block.layers.clone()
                .flat_map(|k| patterns.iter().map(move |p| (k, p)))
                .map(|(k, pattern)| length(pattern, infill_of(&filled.areas[k], pattern)))
                .sum();
            prop_assert_eq!(printed, plain, "block {:?}", block);
            let (_, audit) = infill(&filled.areas, block, &params, &grouping);
            let audit = audit.unwrap();
            // Lines too short to be printed are made up for by at most a twentieth.
            let lost = (audit.plain - audit.material) as f64;
            let thick: i64 = block.layers.clone().flat_map(|k| &filled.sparse[k])
                .filter(|s| s.layers > 1 && !s.pattern.is_solid())
                .map(|s| i64::from(s.layers) * s.length(params.walls.line_width))
                .sum();
            if thick > 0 && lost > 0.001 * audit.plain as f64 {
                let widest = params.walls.line_width + params.walls.line_width / 20;
                let at_most =
                    |s: &Sparse| s.layers == 1 || s.pattern.is_solid() || s.width == widest;
                prop_assert!(block.layers.clone().flat_map(|k| &filled.sparse[k]).all(at_most));
            }
            prop_assert!(lost >= -0.001 * audit.plain as f64, "{:?}", audit);
        }
    }

    #[test]
    fn what_all_layers_of_a_group_share_is_printed_for_all(
        outlines in stacks(), ratio in 2..6_u32,
    ) {
        let settings = grouped("pair", ratio, "rectilinear");
        let (params, grouping) = (RegionParams::new(&settings), grouping(&settings));
        let layers = stack(&params, &outlines);
        let filled = fill(&layers, &params, &grouping);
        for block in filled.blocks.iter().filter(|b| b.layers.len() > 1) {
            let pattern = &params.sparse.of(block.turn)[0];
            let of = |k: usize| infill_of(&filled.areas[k], pattern);
            let mut shared = of(block.layers.start).clone();
            let long = |_, s: Span| s.len() >= i64::from(params.walls.line_width);
            for k in block.layers.clone().skip(1) {
                shared = shared.and(of(k)).filter(long);
            }
            let count = block.layers.len() as u32;
            let top = &filled.sparse[block.layers.end - 1];
            let whole = top.iter().find(|s| s.layers == count && !s.pattern.is_solid());
            let rows = whole.map_or_else(Rows::default, |s| s.rows.clone());
            prop_assert!(shared.minus(&rows).is_empty() && rows.minus(&shared).is_empty());
        }
    }

    #[test]
    fn every_place_of_every_skin_is_printed_once_and_visible_skin_is_thin(
        outlines in stacks(), ratio in 2..5_u32, top in 0..6_usize, bottom in 0..6_usize,
    ) {
        let (top, bottom) = (top.to_string(), bottom.to_string());
        let set = [("top_layers", top.as_str()), ("bottom_layers", &bottom)];
        let params = RegionParams::new(&settings("generic-marlin", &set));
        let layers = stack(&params, &outlines);
        let areas = all_areas(&layers, &params);
        let (rows, areas) = (&layers.rows, &areas);
        let skins = [0, 1].map(|raster| Skins {
            layers: |k| rows.get(k),
            skins: move |k: usize| Some(&*areas.get(k)?.skin(raster).skin),
            raster: params.rasters.skin(raster),
            thin: |_| false,
            ratio: ratio as usize,
            params: &params.skins,
        });
        let both: Vec<_> = (0..areas.len()).map(|k| inner_skin::share(&skins, k)).collect();
        for raster in [0, 1] {
            let of = |k: usize| Some(&*areas.get(k)?.skin(raster).skin);
            let shared: Vec<_> = both.iter().map(|both| &both[raster]).collect();
            let mut left: Vec<Rows> = (0..areas.len()).map(|k| of(k).unwrap().clone()).collect();
            for (k, (thick, thin)) in shared.into_iter().enumerate() {
                prop_assert!(thin.minus(&left[k]).is_empty(), "thin lines on thick ones");
                left[k] = left[k].minus(thin);
                for (count, rows) in thick {
                    prop_assert!(*count > 1 && *count <= ratio);
                    let down = k + 1 - *count as usize;
                    for (down, left) in left.iter_mut().enumerate().take(k + 1).skip(down) {
                        prop_assert!(rows.minus(left).is_empty(), "over nothing, or twice");
                        *left = left.minus(rows);
                        // What is seen from above or below is in no thick line.
                        for next in [down.checked_sub(1), Some(down + 1)] {
                            let next = next.and_then(|n| layers.rows.get(n));
                            let cover = next.map_or_else(Rows::default, |n| n.skin(raster).cover.clone());
                            let bare = rows.minus(&cover);
                            let longest = bare.iter().flat_map(|(_, row)| row).map(|s| s.len()).max();
                            prop_assert!(longest.unwrap_or(0) < 500, "{:?} of {} is seen", longest, down);
                        }
                    }
                }
            }
            prop_assert!(left.iter().all(Rows::is_empty), "a hollow place");
        }
    }

    #[test]
    fn the_thesis_prints_the_shorter_layer_thick_and_drops_the_other(outlines in stacks()) {
        let settings = settings("thesis", &[("skin_layers", "1")]);
        let (params, grouping) = (RegionParams::new(&settings), grouping(&settings));
        let layers = stack(&params, &outlines);
        let filled = fill(&layers, &params, &grouping);
        for block in filled.blocks.iter().filter(|b| b.layers.len() == 2) {
            let (below, above) = (block.layers.start, block.layers.start + 1);
            // Lines shorter than they are wide are not printed and not counted.
            let plain = [below, above].map(|k| {
                let (patterns, line_width) = (params.sparse.of(k), params.walls.line_width);
                printed(&dual::plain(patterns, &filled.areas[k], line_width), &params)
            });
            prop_assert!(filled.sparse[above].iter().all(|s| s.layers == 2));
            prop_assert!(filled.sparse[below].is_empty());
            prop_assert_eq!(printed(&filled.sparse[above], &params), plain[0].min(plain[1]));
        }
    }
}

#[test]
fn rooms_that_are_solid_stay_so_where_remainders_are_dropped() {
    let bar = Solid::cuboid([0.0; 3], [60.0, 6.0, 8.0]);
    let filament = |remainder: &str| {
        let set = [("dual.mode", "pair"), ("narrow_room", "7"), ("dual.remainder", remainder)];
        slice_shipped(&bar.stl(), "generic-marlin", &set).report.filament.length_mm
    };
    let (kept, dropped) = (filament("thin"), filament("drop"));
    assert!((dropped / kept - 1.0).abs() < 0.01, "{dropped} mm of {kept}");
}

#[test]
fn directions_of_blocks_cross_whatever_their_lengths() {
    for mode in MODES {
        let settings = settings("generic-marlin", &[("dual.mode", mode)]);
        let (turns, grouping) = (Turns::new(&settings), grouping(&settings));
        let blocks = blocks(&grouping, 200);
        assert_eq!(blocks.last().unwrap().layers.end, 200);
        let rasters: Vec<Raster> = blocks.iter().map(|b| turns.of(b.turn)[0].raster()).collect();
        assert!(rasters.windows(2).skip(1).all(|w| w[0] != w[1]), "{mode}: {rasters:?}");
    }
}

#[test]
fn each_interlaced_layer_prints_its_share_of_the_lines() {
    for ratio in 2..5 {
        let settings = grouped("interlaced", ratio, "rectilinear");
        let (turns, grouping) = (Turns::new(&settings), grouping(&settings));
        let block = grouping.block(100 / ratio as usize * ratio as usize, 1000);
        let pattern = &turns.of(block.turn)[0];
        let lanes = grouping.lanes(pattern);
        // Every line belongs to one lane.
        for j in -40..40 {
            let mut line = Rows::starting_at(j);
            line.push_row(|out| out.push(Span { start: 0, end: 1 }));
            let lanes: i64 = lanes.iter().map(|l| length(&l.pattern, &line)).sum();
            assert_eq!(lanes, length(pattern, &line), "line {j}");
        }
        for k in block.layers.clone() {
            let ends = lanes.iter().filter(|l| grouping.ends(l.phase, k, &block)).count();
            let is_last = k + 1 == block.layers.end;
            assert_eq!(ends, if is_last { ratio as usize } else { 1 }, "layer {k}");
        }
    }
}

/// A block with a base that is wider, on which groups cannot share everything.
fn stepped() -> Vec<u8> {
    let base = Solid::cuboid([0.0; 3], [30.0, 24.0, 5.0]);
    base.and(&Solid::cuboid([6.0, 4.0, 4.5], [22.0, 18.0, 9.0])).stl()
}

/// Layers that print beads of a kind, with how many layers high they are.
fn heights(run: &Run, kind: Kind) -> BTreeSet<(usize, u32)> {
    run.print
        .of(kind)
        .map(|m| {
            let k = m.layer.unwrap();
            (k, (m.height / run.print.layers[k].height).round() as u32)
        })
        .collect()
}

/// A plate with fins from 0.25 to 1.2 mm on it: skin between fins is too narrow to be shared along
/// some lines, and wide enough along those across.
fn comb() -> Vec<u8> {
    let plate = Solid::cuboid([0.0; 3], [30.0, 14.0, 1.2]);
    let widths = [0.25, 0.3, 0.35, 0.4, 0.45, 0.5, 0.6, 0.7, 0.8, 1.0, 1.2];
    let fins = widths.iter().enumerate().map(|(i, wide)| {
        let x = 1.5 + 2.5 * i as f64;
        Solid::cuboid([x, 2.0, 1.2], [x + wide, 12.0, 2.0])
    });
    fins.fold(plate, |all, fin| all.and(&fin)).stl()
}

#[test]
fn skin_that_one_layer_leaves_to_another_is_printed_there() {
    for (height, first) in [("0.2", "0.2"), ("0.15", "0.2"), ("0.1", "0.2")] {
        let heights = [("layer_height", height), ("first_layer_height", first)];
        let filament = |parts: &str| {
            let dual = [("dual.mode", "pair"), ("dual.parts", parts), ("skin_layers", "3")];
            let set: Vec<_> = heights.into_iter().chain(dual).collect();
            slice(&comb(), "generic-marlin", &set).report.filament.length_mm
        };
        let (plain, shared) = (filament("infill"), filament("inner-skin"));
        assert!((shared / plain - 1.0).abs() < 0.005, "{shared} of {plain} mm at {height}");
    }
}

#[test]
fn groups_of_four_thin_layers_print_what_they_share_on_the_fourth() {
    let set = [("dual.mode", "pair"), ("dual.ratio", "auto"), ("layer_height", "0.1")];
    let run = slice(&stepped(), "generic-marlin", &set);
    let dual = run.report.dual.as_ref().unwrap();
    assert_eq!(dual.ratio, 4);
    let infill = heights(&run, Kind::Infill);
    assert!(infill.iter().any(|&(_, n)| n == 4));
    for (k, n) in infill {
        // A group ends with each fourth layer; those that are higher end no later.
        assert!(k / 4 == (k + 1 - n as usize) / 4, "{n} layers on layer {k}");
        assert!(n < 4 || k % 4 == 3, "{n} layers on layer {k}");
    }
    assert!((dual.volume_ratio - 1.0).abs() < 0.001, "{}", dual.volume_ratio);
}

#[test]
fn the_audit_accounts_for_every_group() {
    for name in ["bracket.stl", "sphere_20.stl", "two_shells.stl", "cavity.stl"] {
        for mode in MODES {
            let set = [("dual.mode", mode), ("support.enabled", "true")];
            let run = slice(&fixture(name), "generic-marlin", &set);
            let dual = run.report.dual.as_ref().unwrap();
            assert!((dual.volume_ratio - 1.0).abs() < 0.001, "{name}: {}", dual.volume_ratio);
            let sum = |of: fn(&slicer::report::BlockReport) -> f64| -> f64 {
                dual.audit.iter().map(of).sum()
            };
            assert!((sum(|b| b.thick_length_mm) - dual.thick_length_mm).abs() < 1e-6);
            assert!((sum(|b| b.thin_length_mm) - dual.thin_length_mm).abs() < 1e-6);
            for block in dual.audit.iter().filter(|b| b.thick_length_mm > 20.0) {
                let off = (block.volume_ratio - 1.0).abs();
                assert!(off < 0.001, "{name} {mode}: {block:?}");
            }
        }
    }
}

#[test]
fn support_is_thick_where_a_group_shares_it() {
    let set = [("dual.mode", "pair"), ("support.enabled", "true")];
    let run = slice(&fixture("overhang.stl"), "generic-marlin", &set);
    let support = heights(&run, Kind::Support);
    assert!(support.iter().any(|&(k, n)| n == 2 && k % 2 == 1 && k > 1));
    assert!(support.iter().all(|&(k, n)| n == 1 || n == 2 && k % 2 == 1 && k > 1));
    let alone = [set[0], set[1], ("dual.parts", "infill")];
    let run = slice(&fixture("overhang.stl"), "generic-marlin", &alone);
    assert!(heights(&run, Kind::Support).iter().all(|&(_, n)| n == 1));
}

/// Filament of the beads of a kind, mm.
fn filament(run: &Run, kind: Kind) -> f64 {
    run.print.of(kind).map(|m| m.e).sum()
}

#[test]
fn inner_skins_are_printed_for_the_group_and_visible_skins_are_not() {
    let parts = ("dual.parts", "inner-skin");
    let skins = ("skin_layers", "3");
    let plain = slice(&fixture("cube_20.stl"), "generic-marlin", &[skins]);
    for mode in MODES {
        let set = [("dual.mode", mode), parts, skins];
        let run = slice(&fixture("cube_20.stl"), "generic-marlin", &set);
        assert_eq!(
            heights(&run, Kind::Skin).into_iter().collect::<Vec<_>>(),
            [(0, 1), (2, 2), (98, 2), (99, 1)],
            "{mode}"
        );
        let ratio = filament(&run, Kind::Skin) / filament(&plain, Kind::Skin);
        assert!((ratio - 1.0).abs() < 0.01, "{mode}: {ratio}");
    }
    let set = [("skin_layers", "5"), ("dual.mode", "pair"), parts];
    let run = slice(&fixture("cube_20.stl"), "generic-marlin", &set);
    assert_eq!(
        heights(&run, Kind::Skin).into_iter().collect::<Vec<_>>(),
        [(0, 1), (2, 2), (4, 2), (96, 2), (98, 2), (99, 1)]
    );
}

#[test]
fn inner_walls_of_upright_sides_are_printed_for_the_group() {
    let plain = slice(&fixture("cube_20.stl"), "generic-marlin", &[("walls", "3")]);
    for mode in MODES {
        let set = [("walls", "3"), ("dual.mode", mode), ("dual.parts", "inner-walls")];
        let run = slice(&fixture("cube_20.stl"), "generic-marlin", &set);
        assert!(heights(&run, Kind::OuterWall).iter().all(|&(_, n)| n == 1));
        let thick = heights(&run, Kind::InnerWall).iter().filter(|(_, n)| *n == 2).count();
        // 49 pairs; interlaced, the two walls have their turns on layers of their own.
        assert!(thick >= if mode == "pair" { 49 } else { 90 }, "{mode}: {thick}");
        let ratio = filament(&run, Kind::InnerWall) / filament(&plain, Kind::InnerWall);
        assert!((ratio - 1.0).abs() < 1e-4, "{mode}: {ratio}");
    }
}

#[test]
fn inner_walls_of_slopes_are_printed_on_every_layer() {
    let set = [("walls", "3"), ("dual.mode", "pair"), ("dual.parts", "inner-walls")];
    let cone = Solid::tower(&[(circle(12.0, 60), 0.0), (circle(6.0, 60), 8.0)]);
    let run = slice(&cone.stl(), "generic-marlin", &set);
    assert!(heights(&run, Kind::InnerWall).iter().all(|&(_, n)| n == 1));
    // What stands upright beside the slope still is.
    let both = cone.and(&Solid::cuboid([20.0, 0.0, 0.0], [30.0, 10.0, 8.0]));
    let run = slice(&both.stl(), "generic-marlin", &set);
    let heights = heights(&run, Kind::InnerWall);
    assert!(heights.iter().any(|&(_, n)| n == 2) && heights.iter().any(|&(_, n)| n == 1));
}

/// Where beads of these kinds lie on the layers that `keep` names, whichever way they are laid:
/// layer, ends and height, µm; and the material on each layer, mm. Widths are annotated only where they
/// change by 0.01 mm, which depends on what was printed before.
type Laid = (Vec<(usize, [[i64; 2]; 2], i64)>, BTreeMap<usize, f64>);

fn laid(run: &Run, kinds: &[Kind], keep: impl Fn(usize) -> bool) -> Laid {
    let micrometres = |mm: f64| (mm * 1000.0).round() as i64;
    let (mut beads, mut material) = (Vec::new(), BTreeMap::<usize, f64>::new());
    for m in run.print.beads().filter(|m| kinds.contains(&m.kind) && keep(m.layer.unwrap())) {
        let layer = m.layer.unwrap();
        let mut ends = [m.a(), m.b()].map(|p| p.map(micrometres));
        ends.sort_unstable();
        beads.push((layer, ends, micrometres(m.height)));
        *material.entry(layer).or_default() += m.e;
    }
    beads.sort_unstable();
    (beads, material)
}

fn assert_alike(a: &Laid, b: &Laid, what: &str) {
    assert!(a.0 == b.0, "{what}");
    for (layer, e) in &a.1 {
        assert!((b.1[layer] / e - 1.0).abs() < 1e-3, "{what}, layer {layer}");
    }
}

#[test]
fn walls_are_those_of_the_plain_print() {
    // Skins are not: above a group the first one runs across its thick lines.
    for name in ["bracket.stl", "sphere_20.stl", "cavity.stl", "overhang.stl"] {
        let kinds = [Kind::OuterWall, Kind::InnerWall];
        let outside = |set: &[(&str, &str)]| {
            laid(&slice(&fixture(name), "generic-marlin", set), &kinds, |_| true)
        };
        let plain = outside(&[]);
        for mode in MODES {
            assert_alike(&outside(&[("dual.mode", mode)]), &plain, &format!("{name} {mode}"));
        }
    }
}

#[test]
fn visible_beads_are_those_of_the_plain_print_whatever_is_thick() {
    let all = ("dual.parts", "infill,support,inner-walls,inner-skin");
    for name in ["bracket.stl", "cube_20.stl", "tile.stl", "overhang.stl"] {
        let plain = slice(&fixture(name), "generic-marlin", &[]);
        let last = plain.print.layers.len() - 1;
        for mode in MODES {
            let run = slice(&fixture(name), "generic-marlin", &[("dual.mode", mode), all]);
            let walls = |run: &Run| laid(run, &[Kind::OuterWall], |_| true);
            assert_alike(&walls(&run), &walls(&plain), &format!("{name} {mode}: walls"));
            let ends = |run: &Run| laid(run, &[Kind::Skin], |k| k == 0 || k == last);
            assert_alike(
                &ends(&run),
                &ends(&plain),
                &format!("{name} {mode}: first and last skin"),
            );
        }
    }
}

#[test]
fn interlaced_layers_take_a_third_of_the_spread_of_groups() {
    // A block without the layers that are all skin.
    let block = Solid::cuboid([0.0; 3], [40.0, 40.0, 20.0]).stl();
    let spread = |mode| {
        let run = slice(&block, "generic-marlin", &[("dual.mode", mode), ("walls", "1")]);
        let times: Vec<f64> = run.report.time.layers.iter().map(|l| l.time_s).collect();
        let times = &times[4..times.len() - 4];
        let mean = times.iter().sum::<f64>() / times.len() as f64;
        let variance = times.iter().map(|t| (t - mean).powi(2)).sum::<f64>() / times.len() as f64;
        variance.sqrt() / mean
    };
    let (pair, interlaced) = (spread("pair"), spread("interlaced"));
    assert!(interlaced <= pair / 3.0, "{interlaced} interlaced, {pair} in groups");
}

#[test]
fn compare_reports_every_mode_and_what_it_saves() {
    let bracket = crate::common::fixtures().join("bracket.stl");
    let run = |more: &[&str]| {
        let mut command = assert_cmd::Command::cargo_bin("slicer").unwrap();
        command.arg("compare").arg(&bracket).args(["-p", "generic-marlin"]).args(more);
        String::from_utf8(command.assert().success().get_output().stdout.clone()).unwrap()
    };
    let table = run(&["--layer-height", "0.1"]);
    let flags: Vec<&str> = table.lines().skip(1).map(|l| l.split("  ").next().unwrap()).collect();
    let ways = ["(plain)", "--dual", "--dual-mode interlaced", "--dual --dual-ratio 3"];
    assert!(flags.starts_with(&ways), "{table}");
    let found: serde_json::Value = serde_json::from_str(&run(&["--json"])).unwrap();
    let ways = found["ways"].as_array().unwrap();
    let of = |way: &serde_json::Value, key: &str| way[key].as_f64().unwrap();
    let (plain, pair) = (&ways[0], &ways[1]);
    let saved = 100.0 * (1.0 - of(pair, "time_s") / of(plain, "time_s"));
    assert!((saved - of(pair, "saved_percent")).abs() < 1e-9 && saved > 5.0);
    assert!((of(pair, "filament_mm") / of(plain, "filament_mm") - 1.0).abs() < 0.02);
    assert!(ways.iter().all(|way| of(way, "time_s") <= of(plain, "time_s")));
    // As slicing itself reports it.
    let set = [("dual.mode", "pair")];
    let report = slice_shipped(&fixture("bracket.stl"), "generic-marlin", &set).report;
    assert!((report.time.total_s - of(pair, "time_s")).abs() < 1e-9);
}

/// The findings of lines that lie on others in a frustum whose upper sides stand `grows` mm further
/// out than its lower ones.
fn printed_twice(sides: [f64; 2], grows: f64, set: &[(&str, &str)]) -> Vec<String> {
    let ring = |by: f64| {
        let [x, y] = sides.map(|side| side / 2.0 + by);
        vec![[-x, -y], [x, -y], [x, y], [-x, y]]
    };
    let solid = Solid::tower(&[(ring(0.0), 0.0), (ring(grows), 4.0)]);
    let run = slice(&solid.stl(), "generic-marlin", set);
    let print = reader::Print::read(&mut run.text.as_bytes(), 1.75).unwrap();
    let all = check(&print, &Terms::new(None, None, &print), None).findings.into_iter();
    all.filter(|one| one.code == Code::PrintedTwice).map(|one| one.to_string()).collect()
}

const ALONG: [(&str, &str); 3] = [("dual.mode", "pair"), ("angle", "0"), ("walls", "2")];

#[test]
fn remainders_beside_thick_lines_do_not_lie_on_them() {
    let all: Vec<_> =
        ALONG.into_iter().chain([("dual.parts", "infill,inner-walls,inner-skin")]).collect();
    assert_eq!(printed_twice([24.415, 15.338], 1.902, &ALONG), Vec::<String>::new());
    assert_eq!(printed_twice([15.782, 12.712], 1.148, &all), Vec::<String>::new());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    #[test]
    fn no_line_of_a_frustum_lies_on_another(
        (x, y, grows) in (8.0..20.0_f64, 8.0..20.0_f64, -2.0..2.0_f64),
        all in any::<bool>(),
    ) {
        let parts = if all { "infill,inner-walls,inner-skin" } else { "infill" };
        let set: Vec<_> = ALONG.into_iter().chain([("dual.parts", parts)]).collect();
        prop_assert_eq!(printed_twice([x, y], grows, &set), Vec::<String>::new());
    }
}
