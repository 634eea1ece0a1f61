//! Mesh + heights -> Part: the model cut at the middle of each layer, as rows of spans.
//!
//! Words used here: a *plane* is the height of a layer's cut; a *crossing* is where an outline crosses
//! the middle of a row; a *level* is the height of a face that lies flat.
//!
//! A cut of its own, so that a fault of the slicer is not repeated here:
//! 1. Triangles are sorted by the planes that they cross.
//! 2. A plane cuts a triangle in a segment, directed so that the solid lies on the same side of all.
//! 3. Segments cross rows; each crossing is +1 or -1 by the segment's direction.
//! 4. Along a row, inside is where the sum of the crossings so far is not 0 (the winding number).
//!
//! What lies on a plane or row counts as above it, so that each outline closes and no corner counts
//! twice. An outline that does not close (the sum at the end of a row is not 0) makes the layer
//! unsure.
//!
//! What lies within a distance of the outline is what capsules around its segments cover: an area is
//! grown and shrunk by an exact distance that way.

use crate::check::capsule::Capsule;
use crate::check::rows::{Lattice, united};
use crate::check::stack::bead::Bead;
use crate::check::stack::laid::Laid;
use crate::geom::cells::Cells;
use crate::geom::segment;
use crate::geom::spans::{Rows, Span};
use crate::mesh::Mesh;
use crate::units::{Coord, UNITS_PER_MM, to_mm, to_units};

/// Planes lie on a grid with this many steps a mm: half of the mesh's units, so that a plane at a
/// vertex's height is exactly the same number.
const PLANE_STEPS: f64 = 2.0 * UNITS_PER_MM;

/// The model where it was printed.
pub(crate) struct Part {
    /// In the machine's coordinates, mm.
    vertices: Vec<[f64; 3]>,
    triangles: Vec<[u32; 3]>,
    /// Heights of all cuts, mm, rising: of each layer's, and of one below each layer that lies higher
    /// than on the one before.
    planes: Vec<f64>,
    /// The plane of each layer.
    of_layer: Vec<usize>,
    /// Triangles that each plane cuts.
    cut: Cells<u32>,
    /// Heights of level faces, mm, rising.
    levels: Vec<f64>,
}

/// Slicers may count a face that lies this near to a cut to either side, mm: they round heights to
/// a thousandth.
const NEAR_LEVEL: f64 = 1.5e-3;

/// Bodies nearer to each other than this (0.01 mm) touch, grid units: their faces were rounded apart.
const CLOSED: Coord = 100;

/// How far beside an outline its sides are looked at, mm more than the distance of rows, and at which
/// distances along it.
const BESIDE: f64 = 0.02;
const EVERY: f64 = 0.5;

/// A stretch of an outline; the solid lies on the same side of all of them.
type Segment = [[f64; 2]; 2];

/// A cut of the model.
#[derive(Debug, Clone, Default)]
pub(crate) struct Section {
    pub(crate) inside: Rows,
    outline: Vec<Segment>,
    /// Whether some of the outline lies inside another body, or on its outline.
    overlaps: bool,
    /// Whether the outline closes.
    pub(crate) closes: bool,
}

impl Section {
    /// Nothing, where the model is not.
    pub(crate) fn empty() -> Self {
        Self { closes: true, ..Self::default() }
    }

    /// Its outline, by which what lies near it is found.
    pub(crate) fn outline(&self) -> Laid {
        Laid::of(self.outline.iter().map(|&[from, to]| Bead::between(from, to)).collect())
    }

    /// All places within `mm` of the outline.
    pub(crate) fn along(&self, lattice: Lattice, mm: f64) -> Rows {
        if self.overlaps {
            // Its segments are no border there. Rare, and takes longer.
            let inside = &self.inside;
            return lattice.grown(inside, mm).minus(&lattice.shrunk(inside, mm));
        }
        let capsules = self.outline.iter().map(|&[from, to]| Capsule { from, to, radius: mm });
        lattice.draw(capsules)
    }

    /// What is wide enough for a disc of radius `mm`.
    pub(crate) fn opened(&self, lattice: Lattice, mm: f64) -> Rows {
        lattice.grown(&self.inside.minus(&self.along(lattice, mm)), mm)
    }
}

impl Part {
    /// Cuts `mesh`, moved by `offset` mm and lifted by `lift`, in the middle of each layer; `layers`
    /// are their tops and heights, mm. A layer of no height is none, and has the cut of the one before. What lies lower than it was lifted is no part: it was cut off at
    /// the bed.
    ///
    /// # Errors
    /// The layer, from 0, that does not lie above the one before.
    pub(crate) fn new(
        mesh: &Mesh,
        (offset, lift): ([f64; 2], f64),
        layers: &[(f64, f64)],
    ) -> Result<Self, usize> {
        let (mut planes, mut of_layer) = (Vec::new(), Vec::with_capacity(layers.len()));
        let mut below = 0.0;
        let plane = |at: f64| (at * PLANE_STEPS).round() / PLANE_STEPS;
        for (layer, (top, height)) in layers.iter().enumerate() {
            let here = plane(top - height / 2.0);
            let last = planes.last().copied().unwrap_or(0.0);
            if layer > 0 && *height <= 0.0 {
                of_layer.push(planes.len() - 1);
                continue;
            }
            if layer > 0 && here <= last {
                return Err(layer);
            }
            let under = plane(top - 1.5 * height);
            if top - height > below + NEAR_LEVEL && under > last {
                planes.push(under);
            }
            of_layer.push(planes.len());
            planes.push(here);
            below = *top;
        }
        let vertices: Vec<[f64; 3]> = mesh
            .vertices
            .iter()
            // On the grid of the planes: a face must lie on a plane, not beside it by a float's last digit.
            .map(|&[x, y, z]| [to_mm(x) + offset[0], to_mm(y) + offset[1], plane(to_mm(z) + lift)])
            .collect();
        let triangles = mesh.triangles.clone();
        let first = planes.partition_point(|plane| *plane <= lift);
        let cut = cut(&vertices, &triangles, &planes, first);
        let levels = levels(&vertices, &triangles);
        Ok(Self { vertices, triangles, planes, of_layer, cut, levels })
    }

    /// Its triangles, mm.
    pub(crate) fn triangles(&self) -> impl ExactSizeIterator<Item = [[f64; 3]; 3]> {
        let place = |corner: u32| self.vertices[corner as usize];
        self.triangles.iter().map(move |corners| corners.map(place))
    }

    /// Moves it, mm.
    pub(crate) fn shift(&mut self, by: [f64; 2]) {
        for vertex in &mut self.vertices {
            vertex[0] += by[0];
            vertex[1] += by[1];
        }
    }

    /// Whether a layer is cut along a level face, where other slicers' rules may differ.
    pub(crate) fn is_along_a_face(&self, layer: usize) -> bool {
        let Some(&plane) = self.of_layer.get(layer) else { return false };
        let plane = self.planes[plane];
        let next = self.levels.partition_point(|level| *level < plane - NEAR_LEVEL);
        self.levels.get(next).is_some_and(|level| *level <= plane + NEAR_LEVEL)
    }

    /// Height of the model above the bed, mm.
    pub(crate) fn height(&self) -> f64 {
        self.vertices.iter().map(|vertex| vertex[2]).fold(0.0, f64::max)
    }

    /// Lowest and highest x and y, mm.
    pub(crate) fn extent(&self) -> Option<([f64; 2], [f64; 2])> {
        extent_of(self.vertices.iter().map(|vertex| [vertex[0], vertex[1]]))
    }

    /// Lowest and highest x and y of a layer's cut, mm.
    pub(crate) fn extent_of(&self, layer: usize) -> Option<([f64; 2], [f64; 2])> {
        extent_of(self.segments(self.of_layer[layer]).flatten())
    }

    /// The outline of a cut.
    fn segments(&self, plane: usize) -> impl Iterator<Item = Segment> {
        let cut = self.cut.of(plane..plane + 1);
        let plane = self.planes[plane];
        cut.iter().filter_map(move |&triangle| self.segment(triangle, plane))
    }

    /// Where a plane cuts a triangle: from the side on which its outline goes up to the other.
    fn segment(&self, triangle: u32, plane: f64) -> Option<Segment> {
        let corners = self.triangles[triangle as usize];
        let above = corners.map(|corner| self.vertices[corner as usize][2] >= plane);
        let (mut up, mut down) = (None, None);
        for k in 0..3 {
            let next = (k + 1) % 3;
            match (above[k], above[next]) {
                (false, true) => up = Some(self.crossing(corners[k], corners[next], plane)),
                (true, false) => down = Some(self.crossing(corners[next], corners[k], plane)),
                _ => {}
            }
        }
        Some([up?, down?])
    }

    /// Where the edge between a corner below and one above crosses; the same for both of its triangles.
    fn crossing(&self, below: u32, above: u32, plane: f64) -> [f64; 2] {
        let (low, high) = (self.vertices[below as usize], self.vertices[above as usize]);
        let part = (plane - low[2]) / (high[2] - low[2]);
        let [x, y, _] = segment::along(low, part, segment::way(low, high));
        [x, y]
    }

    /// What of the bed the model covers at a layer; nothing beyond the last.
    pub(crate) fn section(&self, layer: usize, lattice: Lattice) -> Section {
        let Some(&plane) = self.of_layer.get(layer) else {
            return Section::empty();
        };
        let outline: Vec<Segment> = self.segments(plane).collect();
        // Row, place along it, and which way the outline goes.
        let mut crossings: Vec<(i32, f64, i32)> = Vec::new();
        for &[from, to] in &outline {
            let (low, high, sign) = if from[1] < to[1] { (from, to, 1) } else { (to, from, -1) };
            for row in lattice.range(low[1], high[1]) {
                let y = lattice.middle(row);
                let x = low[0] + (y - low[1]) / (high[1] - low[1]) * (high[0] - low[0]);
                crossings.push((row, x, sign));
            }
        }
        crossings
            .sort_unstable_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)).then(a.2.cmp(&b.2)));
        let (mut closes, mut overlaps) = (is_closed(&outline), false);
        let mut spans: Vec<(i32, Span)> = Vec::with_capacity(crossings.len() / 2);
        for row in crossings.chunk_by(|a, b| a.0 == b.0) {
            let mut winding = 0;
            for two in row.windows(2) {
                let before = winding;
                winding += two[0].2;
                overlaps |= before != 0 && winding != 0;
                if winding != 0 {
                    let Some(span) = Span::new(to_units(two[0].1), to_units(two[1].1)) else {
                        continue;
                    };
                    match spans.last_mut() {
                        Some((row, last))
                            if *row == two[0].0 && span.start - last.end <= CLOSED =>
                        {
                            last.end = span.end;
                        }
                        _ => spans.push((two[0].0, span)),
                    }
                }
            }
            closes &= winding + row.last().map_or(0, |last| last.2) == 0;
        }
        let inside = united(&spans);
        let is_inner = |segment: &Segment| is_inner(*segment, &inside, lattice);
        overlaps = overlaps || outline.iter().any(is_inner);
        Section { inside, outline, overlaps, closes }
    }

    /// The plane below that of a layer: of the layer before, or nearer where there is a gap.
    fn below(&self, layer: usize) -> Option<usize> {
        self.of_layer.get(layer)?.checked_sub(1)
    }

    /// Whether a layer lies above a gap that is empty in the model, too.
    pub(crate) fn is_empty_below(&self, layer: usize) -> bool {
        let before = layer.checked_sub(1).map(|before| self.of_layer[before]);
        let below = self.below(layer).filter(|below| Some(*below) != before);
        below.is_some_and(|below| self.segments(below).next().is_none())
    }

    /// Whether a place of a layer has nothing of the model below it.
    pub(crate) fn hangs(&self, layer: usize, at: [f64; 2]) -> bool {
        let Some(below) = self.below(layer) else { return false };
        let mut winding = 0;
        for [from, to] in self.segments(below) {
            let (low, high, sign) = if from[1] < to[1] { (from, to, 1) } else { (to, from, -1) };
            if (low[1]..high[1]).contains(&at[1]) {
                let x = low[0] + (at[1] - low[1]) / (high[1] - low[1]) * (high[0] - low[0]);
                winding += if x < at[0] { sign } else { 0 };
            }
        }
        winding == 0
    }
}

/// Whether each stretch of an outline begins where another ends. Two gaps beside each other leave the
/// winding numbers of rows whole, and still hide what lies between them.
fn is_closed(outline: &[Segment]) -> bool {
    // All bits of the sum depend on all of a place's (the steps of SplitMix64).
    let mixed = |n: u64| {
        let n = (n ^ (n >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let n = (n ^ (n >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        n ^ (n >> 31)
    };
    let number = |at: [f64; 2]| {
        // 0 and -0 are one place.
        let [x, y] = at.map(|side| (side + 0.0).to_bits());
        mixed(mixed(x).wrapping_add(y))
    };
    let ends = outline.iter().map(|[from, to]| number(*from).wrapping_sub(number(*to)));
    ends.fold(0, u64::wrapping_add) == 0
}

/// Whether some of a stretch of an outline has solid on both sides: bodies that touch by a face have.
fn is_inner([from, to]: Segment, inside: &Rows, lattice: Lattice) -> bool {
    let way = [to[0] - from[0], to[1] - from[1]];
    let length = (way[0] * way[0] + way[1] * way[1]).sqrt();
    let off = (BESIDE + lattice.pitch()) / length.max(f64::MIN_POSITIVE);
    let across = [-off * way[1], off * way[0]];
    let count = (length / EVERY).ceil().max(1.0);
    (0..count as u32).any(|k| {
        let at = segment::along(from, (f64::from(k) + 0.5) / count, way);
        [-1.0, 1.0].iter().all(|side| lattice.has(inside, segment::along(at, *side, across)))
    })
}

/// The triangles that each plane cuts, from plane `first` on.
fn cut(vertices: &[[f64; 3]], triangles: &[[u32; 3]], planes: &[f64], first: usize) -> Cells<u32> {
    let reach = |triangle: u32| {
        let z = triangles[triangle as usize].map(|corner| vertices[corner as usize][2]);
        let (low, high) = (z[0].min(z[1]).min(z[2]), z[0].max(z[1]).max(z[2]));
        let beyond = |height: f64| planes.partition_point(|plane| *plane <= height);
        beyond(low).max(first)..beyond(high).max(first)
    };
    Cells::new(planes.len(), || (0_u32..).take(triangles.len()), reach)
}

/// Heights of level faces, mm, rising.
fn levels(vertices: &[[f64; 3]], triangles: &[[u32; 3]]) -> Vec<f64> {
    let level = |corners: &[u32; 3]| {
        let [a, b, c] = corners.map(|corner| vertices[corner as usize][2]);
        (a == b && b == c).then_some(a)
    };
    let mut levels: Vec<f64> = triangles.iter().filter_map(level).collect();
    levels.sort_unstable_by(f64::total_cmp);
    levels.dedup();
    levels
}

/// Lowest and highest x and y of some places.
pub(crate) fn extent_of(places: impl Iterator<Item = [f64; 2]>) -> Option<([f64; 2], [f64; 2])> {
    places.fold(None, |extent, at| {
        let (low, high) = extent.unwrap_or((at, at));
        Some(([low[0].min(at[0]), low[1].min(at[1])], [high[0].max(at[0]), high[1].max(at[1])]))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::to_units;

    /// A box of these sides, mm; `turned` has its faces inside out.
    fn solid(sides: [f64; 3], turned: bool) -> Mesh {
        let [x, y, z] = sides.map(to_units);
        let corner = |k: i32| [(k & 1) * x, (k >> 1 & 1) * y, (k >> 2) * z];
        let faces = [
            [0, 2, 1],
            [1, 2, 3],
            [4, 5, 6],
            [5, 7, 6],
            [0, 1, 4],
            [1, 5, 4],
            [2, 6, 3],
            [3, 6, 7],
            [0, 4, 2],
            [2, 4, 6],
            [1, 3, 5],
            [3, 7, 5],
        ];
        let face = |[a, b, c]: [u32; 3]| if turned { [a, c, b] } else { [a, b, c] };
        Mesh { vertices: (0..8).map(corner).collect(), triangles: faces.map(face).to_vec() }
    }

    #[test]
    fn a_section_with_two_gaps_beside_each_other_does_not_close() {
        let mut mesh = solid([4.0, 2.0, 0.5], false);
        let lattice = Lattice::new(0.1, 2.0, 1e4);
        let closes = |mesh: &Mesh| {
            let part = Part::new(mesh, ([10.0, 5.0], 0.0), &[(0.2, 0.2), (0.4, 0.2)]).unwrap();
            part.section(0, lattice).closes
        };
        assert!(closes(&mesh));
        // Without its faces to the left and to the right all rows have as many ways in as out: none.
        let x = |v: u32| mesh.vertices[v as usize][0];
        mesh.triangles.retain(|&[a, b, c]| x(a) != x(b) || x(b) != x(c));
        assert!(!closes(&mesh));
    }

    #[test]
    fn a_box_is_cut_into_rectangles_whichever_way_its_faces_look() {
        for turned in [false, true] {
            let layers = [(0.2, 0.2), (0.4, 0.2), (0.6, 0.2)];
            let part =
                Part::new(&solid([4.0, 2.0, 0.5], turned), ([10.0, 5.0], 0.0), &layers).unwrap();
            assert_eq!(part.extent(), Some(([10.0, 5.0], [14.0, 7.0])));
            let lattice = Lattice::new(0.1, 2.0, 1e4);
            // The last plane lies on the upper face, which counts as above it: it cuts nothing higher.
            for layer in 0..3 {
                let area = lattice.area(&part.section(layer, lattice).inside);
                assert!((area - 8.0).abs() < 1e-6, "{layer}: {area}");
            }
            assert!(part.section(3, lattice).inside.is_empty());
            assert!(part.section(1, lattice).closes);
            assert!(part.is_along_a_face(2) && !part.is_along_a_face(1));
            assert!(part.hangs(1, [9.9, 6.0]) && !part.hangs(1, [10.1, 6.0]));
            assert!(!part.hangs(0, [0.0, 0.0]));
        }
        assert_eq!(
            Part::new(&Mesh::default(), ([0.0; 2], 0.0), &[(0.2, 0.2), (0.2, 0.2)]).err(),
            Some(1)
        );
    }

    #[test]
    fn a_section_is_opened_by_an_exact_distance() {
        let part =
            Part::new(&solid([4.0, 2.0, 0.5], false), ([0.0; 2], 0.0), &[(0.2, 0.2)]).unwrap();
        let lattice = Lattice::new(0.05, 2.0, 1e4);
        let section = part.section(0, lattice);
        // Round corners are missing.
        let area = lattice.area(&section.opened(lattice, 0.5));
        assert!((area - (8.0 - 0.215)).abs() < 0.08, "{area}");
        assert!(section.opened(lattice, 1.01).is_empty());
        let along = lattice.area(&section.inside.and(&section.along(lattice, 0.3)));
        assert!((along - (8.0 - 3.4 * 1.4)).abs() < 0.05, "{along}");
    }

    #[test]
    fn a_layer_above_a_gap_hangs_where_nothing_is_just_below() {
        let layers = [(0.2, 0.2), (1.4, 0.2)];
        let part = Part::new(&solid([4.0, 2.0, 2.0], false), ([0.0; 2], 0.0), &layers).unwrap();
        assert!(!part.hangs(1, [1.0, 1.0]) && !part.is_empty_below(1));
        let part = Part::new(&solid([4.0, 2.0, 0.5], false), ([0.0; 2], 0.0), &layers).unwrap();
        assert!(part.hangs(1, [1.0, 1.0]) && part.is_empty_below(1) && !part.is_empty_below(0));
    }
}
