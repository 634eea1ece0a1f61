//! Wall and exposed rows -> Samples: how deep the exposed skin is behind each place of a wall.

use super::crossed::Crossed;
use super::near::{Area, Near};
use super::params::BeadParams;
use crate::geom::spans::{Rows, Span};
use crate::geom::{Contour, Point, edges};
use crate::units::{Bounded as _, Coord, between, nearest};

/// At most this many beads beside each other along one wall.
pub(super) const MOST_BEADS: usize = 3;

/// A bead along a wall is at least this many line widths wide, where there is room.
pub(super) const NARROWEST: f64 = 0.75;

/// Beads shorter than this many line widths are left to the lines, and gaps in a bead
/// shorter than this are closed.
pub(super) const SHORT: f64 = 2.5;

/// A bead takes a depth of up to this many line widths on its own.
const WIDEST: f64 = 1.5;

/// Strips between two walls get beads if they are no wider than twice this many line
/// widths, one along either wall: wider ones taper too much for more.
const SHARED: f64 = 1.6;

/// A strip between two walls up to this many line widths wide gets one bead.
pub(super) const SINGLE: f64 = 1.6;

/// A bead is stretched to this many line widths to spare another one on a short way.
const STRETCHED: f64 = 1.75;

/// Depths up to this many line widths more than the beads cover are left open: the
/// walls of the layer that ends there reach over it.
const OPEN: f64 = 0.1;

/// Between skin along two walls, this many line widths are not worth any infill.
const GAP: f64 = 2.0;

/// A place beyond the middle of a strip, as a share of its width.
const BEYOND: f64 = 0.6;

/// How much further away the other wall may be there, as a share of the strip's width.
const SLOPE: f64 = 0.1;

/// How far out the middle of a round corner lies, so that its chords keep their distance.
const ROUND: f64 = 1.2;

/// Stretches that seem deep are narrow all the same if narrow skin follows within this
/// many line widths: near a corner the depth is that along the other wall.
const CORNER: f64 = 11.0;

/// Beads and gaps closed in them are no further than this many line widths from a
/// sample that has beads.
const MARGIN: f64 = CORNER + 8.0;

/// Side of the cells that edges are sorted into, in line widths: larger than what is asked for
/// around most places, so that few are looked up.
const CELL: f64 = 4.0;

/// A place of a wall, and the skin behind it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct WallSample {
    /// On the wall.
    pub at: [f64; 2],
    /// What leads away from the wall: its length is that of a mitre, 1 where the wall is straight.
    pub normal: [f64; 2],
    /// How deep the skin is, from the walls' inner edge.
    pub depth: f64,
    /// The depth ends half-way to another wall, which lays beads as well.
    pub shared: bool,
    /// Of these two walls this is the one that lays a bead which both share.
    pub leads: bool,
    /// How many beads it takes; 0 where there is no skin or too much.
    pub beads: usize,
    /// Distance from the wall's first point along the wall.
    way: f64,
    /// There is skin, whether or not beads can cover it.
    skin: bool,
}

/// The samples of closed walls in the order of their points; none where beads cover
/// nothing. Also all edges of the walls, if there are samples.
pub(super) fn samples(
    walls: &[Contour],
    crossed: &Crossed<'_>,
    params: &BeadParams,
) -> Option<(Vec<Vec<WallSample>>, Near)> {
    let mut laps: Vec<Vec<WallSample>> =
        walls.iter().map(|w| measured(w, crossed, params)).collect();
    if laps.iter().flatten().all(|s| s.beads == 0) {
        return None;
    }
    let with_beads = laps.iter().flatten().filter(|s| s.beads > 0).map(|s| s.at);
    let w = f64::from(params.line_width);
    let near = Near::new(walls, Area::around(with_beads, MARGIN * w), CELL * w);
    for (lap, wall) in laps.iter_mut().zip(walls) {
        lap.iter_mut().filter(|s| s.shared).for_each(|s| s.confirm(&near, params));
        if params.only_strips {
            let others = lap.iter_mut().filter(|s| !s.is_single(params));
            others.for_each(|s| (s.beads, s.skin) = (0, false));
        }
        *lap = settled(wall, std::mem::take(lap), params);
    }
    Some((laps, near))
}

/// The samples of a wall without short changes, with the wall's own corners.
fn settled(wall: &Contour, mut found: Vec<WallSample>, params: &BeadParams) -> Vec<WallSample> {
    if found.iter().all(|s| s.beads == 0) {
        return Vec::new();
    }
    let round = edges(wall).map(|(p, q)| p.distance(q)).sum::<f64>();
    bridge(&mut found, round, params);
    calm(&mut found, round, params);
    with_corners(wall, &found, round, params)
}

impl WallSample {
    /// Whether it is at a strip so thin that one bead fills it.
    pub(super) fn is_single(&self, params: &BeadParams) -> bool {
        self.shared && 2.0 * self.depth < SINGLE * f64::from(params.line_width)
    }

    /// Keeps no beads where the wall at the other end of the row is not beside this one:
    /// beyond the middle of a strip the other wall is the nearer one, in a corner it is not.
    /// Else settles which of the two leads.
    fn confirm(&mut self, near: &Near, params: &BeadParams) {
        let across = 2.0 * (self.depth + f64::from(params.line_width) / 2.0);
        let beyond = [0, 1].map(|k| self.at[k] + BEYOND * across * self.normal[k]);
        if let Some(other) = near.nearest(beyond, (1.0 - BEYOND + SLOPE) * across) {
            self.leads = leads(self.normal, other);
        } else {
            self.shared = false;
            self.beads = 0;
        }
    }
}

/// Whether a wall with this normal leads the one with edge `other`, by where the strip
/// between them lies seen from it. The difference of the two normals is the same one
/// from the other side, but for its sign: of two walls that lean either way one leads.
fn leads(normal: [f64; 2], [from, to]: [[f64; 2]; 2]) -> bool {
    let [x, y] = [to[0] - from[0], to[1] - from[1]];
    let length = (x * x + y * y).sqrt().at_least(1.0);
    let [x, y] = [normal[0] + y / length, normal[1] - x / length];
    x > 0.0 || (x == 0.0 && y > 0.0)
}

/// Where rows cross the inner edge of the walls: each edge of the wall under the raster
/// whose rows it crosses at 45° or steeper.
fn measured(wall: &Contour, crossed: &Crossed<'_>, params: &BeadParams) -> Vec<WallSample> {
    let turned = |p: Point| {
        if crossed.left_turn { Point { x: p.y, y: -p.x } } else { Point { x: -p.y, y: p.x } }
    };
    let mut out = Vec::with_capacity(wall.len());
    let mut way = 0.0;
    for (p, q) in edges(wall) {
        let steep = (q.y - p.y).abs() >= (q.x - p.x).abs();
        let edge = Edge::new(p, q, way);
        way += edge.length;
        if steep {
            edge.measure((p, q), (crossed.fill, crossed.skin), params, &mut out);
        } else {
            let ends = (turned(p), turned(q));
            edge.measure(ends, (crossed.fill_columns, crossed.columns), params, &mut out);
        }
    }
    out
}

/// An edge of a wall.
struct Edge {
    from: [f64; 2],
    /// Its direction; the solid is on its left.
    along: [f64; 2],
    length: f64,
    way: f64,
}

impl Edge {
    fn new(p: Point, q: Point, way: f64) -> Self {
        let length = p.distance(q);
        let [x, y] = [f64::from(q.x) - f64::from(p.x), f64::from(q.y) - f64::from(p.y)];
        let from = [f64::from(p.x), f64::from(p.y)];
        Self { from, along: [x / length.at_least(1.0), y / length.at_least(1.0)], length, way }
    }

    fn normal(&self) -> [f64; 2] {
        [-self.along[1], self.along[0]]
    }

    /// Adds the samples where the rows of `fill` and `exposed` cross this edge, which
    /// is `p` to `q` in their frame.
    fn measure(
        &self,
        (p, q): (Point, Point),
        (fill, exposed): (&Rows, &Rows),
        params: &BeadParams,
        out: &mut Vec<WallSample>,
    ) {
        let inset = f64::from(params.wall_to_fill);
        let rise = f64::from(q.y) - f64::from(p.y);
        let run = f64::from(q.x) - f64::from(p.x);
        let by = |part: f64| nearest(inset * part / self.length.at_least(1.0)) as Coord;
        let moved = |p: Point| Point { x: p.x - by(rise), y: p.y + by(run) };
        let (a, b) = (moved(p), moved(q));
        let up = a.y < b.y;
        let (low, high) = if up { (a, b) } else { (b, a) };
        let pitch = params.line_width;
        let sine = rise.abs() / self.length.at_least(1.0);
        let first = out.len();
        for j in low.y.div_euclid(pitch) + 1..high.y.div_euclid(pitch) + 1 {
            let v = j * pitch;
            let u = between(low.x, high.x, (v, low.y, high.y));
            let t = f64::from(v - a.y) / f64::from(b.y - a.y);
            let at = [0, 1].map(|k| self.from[k] + t * self.length * self.along[k]);
            let blank = WallSample {
                at,
                normal: self.normal(),
                depth: 0.0,
                shared: false,
                leads: false,
                beads: 0,
                way: self.way + t * self.length,
                skin: false,
            };
            if exposed.row(j).is_empty() {
                out.push(blank);
                continue;
            }
            let behind = Behind::new(fill.row(j), exposed.row(j), u, !up, pitch);
            out.extend(behind.map(|b| b.sample(blank, sine, params)));
        }
        if !up {
            out[first..].reverse();
        }
    }
}

/// What a row meets behind the inner edge of the walls.
struct Behind {
    /// Length of the exposed skin from there on.
    skin: i64,
    /// Length of the exposed skin at the other end.
    other: i64,
    /// To the walls at the other end.
    room: i64,
}

impl Behind {
    /// For a row that crosses the edge at about `u`, entering to the right or to the left.
    fn new(fill: &[Span], exposed: &[Span], u: Coord, right: bool, pitch: Coord) -> Option<Self> {
        let end = |s: &Span| if right { s.start } else { s.end };
        let near = |s: &&Span| (end(s) - u).abs() <= pitch / 4;
        let fill = fill.iter().filter(near).min_by_key(|s| (end(s) - u).abs())?;
        let from = exposed.partition_point(|s| s.end <= fill.start);
        let to = exposed.partition_point(|s| s.start < fill.end);
        let here = exposed.get(from..to).unwrap_or_default().iter();
        let distance = |a: Coord, b: Coord| i64::from(b) - i64::from(a);
        let from_start = |s: &Span| (distance(fill.start, s.start), distance(fill.start, s.end));
        let from_end = |s: &Span| (distance(s.end, fill.end), distance(s.start, fill.end));
        let at_start = reach(here.clone().map(from_start), pitch);
        let at_end = reach(here.rev().map(from_end), pitch);
        let (skin, other) = if right { (at_start, at_end) } else { (at_end, at_start) };
        Some(Self { skin, other, room: fill.len() })
    }

    /// `blank` with what is behind it; `sine` is that of the angle at which the row crosses.
    fn sample(&self, blank: WallSample, sine: f64, params: &BeadParams) -> WallSample {
        let w = f64::from(params.line_width);
        let lead = f64::from(params.wall_to_fill) - w / 2.0;
        let skin = self.skin > 0 || self.other > 0;
        let depth = |length: i64| length as f64 * sine + lead;
        // What a bead covers at least of either side.
        let taken = |length: i64| if length > 0 { depth(length).max(NARROWEST * w) } else { 0.0 };
        let across = depth(self.room) + lead;
        if skin && across - taken(self.skin) - taken(self.other) <= GAP * w {
            let depth = across / 2.0;
            let beads = usize::from(depth <= SHARED * w);
            return WallSample { depth, shared: true, beads, skin: true, ..blank };
        }
        if self.skin == 0 {
            return blank;
        }
        let depth = depth(self.skin);
        WallSample { depth, beads: beads(depth, w), skin: true, ..blank }
    }
}

/// How far stretches reach that begin at zero; what is covered between two of them is
/// a speck if it is shorter than half a `pitch`.
fn reach(stretches: impl Iterator<Item = (i64, i64)>, pitch: Coord) -> i64 {
    let mut end = 0;
    for (from, to) in stretches {
        if from > end + i64::from(pitch / 2) {
            break;
        }
        end = to;
    }
    end
}

/// How many beads cover a depth; none if it is too deep.
fn beads(depth: f64, w: f64) -> usize {
    let count = (((depth - OPEN * w) / (WIDEST * w)).ceil() as usize).max(1);
    if count <= MOST_BEADS { count } else { 0 }
}

/// The stretches of samples with the same value of `key` as index ranges around the
/// wall, which go on beyond the last sample into the first ones.
fn stretches<K: PartialEq>(
    samples: &[WallSample],
    key: impl Fn(&WallSample) -> K,
) -> Vec<(usize, usize)> {
    let n = samples.len();
    let differs = |k: usize| key(&samples[k % n]) != key(&samples[(k + n - 1) % n]);
    let starts: Vec<usize> = (0..n).filter(|&k| differs(k)).collect();
    let ends = starts.iter().skip(1).copied().chain(starts.first().map(|k| k + n));
    starts.iter().copied().zip(ends).collect()
}

/// The way from the sample before a stretch to the one behind it.
fn span(samples: &[WallSample], (from, to): (usize, usize), round: f64) -> f64 {
    let n = samples.len();
    let way = samples[to % n].way - samples[(from + n - 1) % n].way;
    if way > 0.0 { way } else { way + round }
}

/// Gives beads to short stretches without between two with beads.
fn bridge(samples: &mut [WallSample], round: f64, params: &BeadParams) {
    let (n, w) = (samples.len(), f64::from(params.line_width));
    for (from, to) in stretches(samples, |s| s.beads > 0) {
        let (before, after) = (samples[(from + n - 1) % n], samples[to % n]);
        if samples[from % n].beads > 0 {
            continue;
        }
        let deep = (from..to).any(|k| samples[k % n].skin);
        let most = if deep { CORNER } else { SHORT } * w;
        if span(samples, (from, to), round) > most {
            continue;
        }
        let model = if before.depth <= after.depth { before } else { after };
        // Around the end of a strip the wall turns from one side to the other.
        let leads = before.leads || after.leads;
        for k in from..to {
            let sample = &mut samples[k % n];
            let WallSample { depth, shared, beads, .. } = model;
            *sample = WallSample { depth, shared, leads, beads, ..*sample };
        }
    }
}

/// Spares beads on short stretches, and closes short gaps in them.
fn calm(samples: &mut [WallSample], round: f64, params: &BeadParams) {
    let (n, w) = (samples.len(), f64::from(params.line_width));
    for (from, to) in stretches(samples, |s| s.beads) {
        let (before, after) = (samples[(from + n - 1) % n].beads, samples[to % n].beads);
        let here = samples[from % n].beads;
        let (fewer, more) = (before.min(after), before.max(after));
        let other = match here {
            0 => continue,
            _ if here < fewer => fewer,
            _ if here > more => more,
            _ => continue,
        };
        if other == 0 || span(samples, (from, to), round) > SHORT * w {
            continue;
        }
        let fits = |s: &WallSample| s.depth <= other as f64 * STRETCHED * w;
        if (from..to).all(|k| fits(&samples[k % n])) {
            (from..to).for_each(|k| samples[k % n].beads = other);
        }
    }
}

/// Adds the wall's own corners to the samples found, with the skin of the nearest one.
fn with_corners(
    wall: &Contour,
    found: &[WallSample],
    round: f64,
    params: &BeadParams,
) -> Vec<WallSample> {
    let most = SHORT * f64::from(params.line_width);
    let n = wall.len();
    let mut out = Vec::with_capacity(found.len() + n);
    let mut way = 0.0;
    let mut next = 0;
    for (k, (p, q)) in edges(wall).enumerate() {
        let (before, edge) = (Edge::new(wall[(k + n - 1) % n], p, 0.0), Edge::new(p, q, way));
        let near = |k: usize| {
            let sample = found[k % found.len()];
            let away = (sample.way - way).abs();
            (away.at_most(round - away), sample)
        };
        let (a, b) = (near(next + found.len() - 1), near(next));
        let nearest = if a.0 <= b.0 { a } else { b };
        let gap = a.0 + b.0;
        let alike = a.1.beads == b.1.beads && a.1.shared == b.1.shared;
        let depth = if alike && gap > 0.0 {
            (a.1.depth * b.0 + b.1.depth * a.0) / gap
        } else {
            nearest.1.depth
        };
        let beads = if nearest.0 <= most { nearest.1.beads } else { 0 };
        let leads = a.1.leads || b.1.leads;
        let corner = WallSample { at: edge.from, way, depth, leads, beads, ..nearest.1 };
        add_corner(&before, &edge, corner, &mut out);
        way += edge.length;
        while let Some(sample) = found.get(next).filter(|s| s.way <= way) {
            out.push(*sample);
            next += 1;
        }
    }
    // Of places without beads one in a row is enough.
    out.dedup_by(|b, a| a.beads == 0 && b.beads == 0);
    out
}

/// Adds a corner between two edges: on its mitre, or round in three points where that
/// would reach far.
fn add_corner(before: &Edge, after: &Edge, corner: WallSample, out: &mut Vec<WallSample>) {
    let (a, b) = (before.normal(), after.normal());
    let cosine = a[0] * b[0] + a[1] * b[1];
    if cosine >= 0.0 {
        let normal = [0, 1].map(|k| (a[k] + b[k]) / (1.0 + cosine));
        out.push(WallSample { normal, ..corner });
        return;
    }
    // Between the edges, or straight on where the wall turns back.
    let length = (2.0 + 2.0 * cosine).at_least(0.0).sqrt();
    let middle = [0, 1].map(|k| {
        let ahead = if length > 0.1 { (a[k] + b[k]) / length } else { before.along[k] };
        ahead * ROUND
    });
    out.extend([a, middle, b].map(|normal| WallSample { normal, ..corner }));
}
