//! Toolpath -> Moves: what the machine does on one layer, move by move, as it will be written.
//!
//! The text, the sums and the clock all read these moves: a length, a feed and an
//! amount of filament are worked out once, and the clock times what is written.

use super::flow::{FlowLimit, Flows, Lowered, whole_feed};
use crate::fill::{Both, Path, PathPoint, Role, RoleTable};
use crate::geom::Point;
use crate::plan::Toolpath;
use crate::profile::{ExtrusionModel, Settings};
use crate::units::{Coord, UNITS_PER_MM, to_mm, to_units};

/// A straight move to a place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Move {
    /// Where it ends in x and y on the machine, thousandths of a mm.
    pub to: [i32; 2],
    /// Where it ends in z, grid units.
    pub z: Coord,
    /// mm/min, as written.
    pub feed: u32,
    /// Length before rounding, mm.
    pub length: f64,
    /// Filament pushed, or pulled if negative, mm.
    pub filament: f64,
    /// What it is for.
    pub kind: Kind,
}

/// What a move is for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Kind {
    /// To the beginning of a path.
    Travel,
    /// Up or down.
    Z,
    /// Pulls the filament back.
    Retract,
    /// Pushes it forward again.
    Restore,
    /// Lays a bead. A stretch shorter than the rounding ends where it began; its
    /// filament counts all the same.
    Extrude(Bead),
}

/// The bead that a move lays.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Bead {
    /// What it is for.
    pub role: Role,
    /// Printed for more than its own layer.
    pub thick: bool,
    /// Height, grid units.
    pub height: Coord,
    /// Width, grid units.
    pub width: Coord,
}

/// All that the machine does on one layer.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Moves {
    /// The layer, counted from 0.
    pub layer: usize,
    /// Top of the layer above the bed, grid units.
    pub z: Coord,
    /// Height of the layer, grid units.
    pub height: Coord,
    /// Where the nozzle comes from, thousandths of a mm, if known.
    pub from: Option<[i32; 2]>,
    /// The moves, in order.
    pub moves: Vec<Move>,
    /// For each path, the first move of the way to it.
    pub paths: Vec<usize>,
    /// How fast its filament is molten.
    pub flows: Flows,
}

/// The numbers that the moves are made by.
#[derive(Debug, Clone)]
pub struct MoveParams {
    /// Where the layout's middle goes on the machine, grid units.
    offset: [i64; 2],
    /// mm of filament for each mm of path, mm of width and mm of height, by role.
    rates: RoleTable<f64>,
    /// mm/min.
    feeds: RoleTable<Both<f64>>,
    /// Factor on the feeds of the first layer.
    first_layer: f64,
    travel_feed: f64,
    z_feed: f64,
    retract: f64,
    retract_feed: f64,
    hop: Coord,
    limit: FlowLimit,
}

impl MoveParams {
    /// The numbers that `settings` mean; `offset` is the layout's middle, mm.
    #[must_use]
    pub fn new(settings: &Settings, offset: [f64; 2]) -> Self {
        let (x, s) = (&settings.extrusion, &settings.speed);
        let area = settings.filament_area();
        let rate = |factor: f64| match x.model {
            ExtrusionModel::Area => x.multiplier / area,
            ExtrusionModel::Factor => x.multiplier * factor / (x.factor_width * x.factor_height),
        };
        Self {
            offset: offset.map(|mm| i64::from(to_units(mm))),
            rates: RoleTable::new(|role| rate((role.facts().factor)(x))),
            feeds: RoleTable::new(|role| (role.facts().speed)(s)),
            first_layer: s.first_layer / 100.0,
            travel_feed: s.travel,
            z_feed: s.z,
            retract: settings.retraction.length,
            retract_feed: settings.retraction.feed,
            hop: to_units(settings.retraction.z_hop),
            limit: FlowLimit::new(settings),
        }
    }

    /// Filament for this length of a bead, mm.
    fn filament(&self, bead: &Bead, length_mm: f64) -> f64 {
        self.rates[bead.role] * length_mm * to_mm(bead.width) * to_mm(bead.height)
    }

    /// The moves of one layer.
    #[must_use]
    pub fn moves(&self, layer: &Toolpath) -> Moves {
        let mut walk = Walk::new(self, layer);
        for next in &layer.moves {
            let Some(first) = next.path.points.first() else { continue };
            walk.out.paths.push(walk.out.moves.len());
            walk.approach(first, next.retract);
            walk.path(&next.path);
        }
        walk.out
    }

    /// How far the filament is pulled back once all is printed, mm, and how fast, mm/min.
    #[must_use]
    pub fn last_pull(&self) -> (f64, u32) {
        (self.retract, whole_feed(self.retract_feed))
    }

    /// Where a point is on the machine, thousandths of a mm.
    fn place(&self, p: Point) -> [i32; 2] {
        let [x, y] = self.offset;
        // Ten units are a thousandth; half away from zero is not needed, only the same everywhere.
        [(i64::from(p.x) + x + 5).div_euclid(10), (i64::from(p.y) + y + 5).div_euclid(10)]
            .map(|thousandths| thousandths as i32)
    }
}

/// A layer's moves in the making.
struct Walk<'a> {
    params: &'a MoveParams,
    out: Moves,
    /// Where the nozzle is, on the bed and on the machine.
    at: Option<(Point, [i32; 2])>,
    /// Height of the nozzle where this layer has set it.
    z: Option<Coord>,
    /// The highest place printed so far: a travel passes over it.
    highest: Coord,
}

impl<'a> Walk<'a> {
    fn new(params: &'a MoveParams, layer: &Toolpath) -> Self {
        let at = layer.from.at.map(|from| (from, params.place(from)));
        let points: usize = layer.moves.iter().map(|next| next.path.points.len()).sum();
        // A path has a point more than segments; the rest is for the way to it.
        let most = points + 3 * layer.moves.len();
        let out = Moves {
            layer: layer.layer,
            z: layer.z,
            height: layer.height,
            from: at.map(|(_, place)| place),
            moves: Vec::with_capacity(most),
            paths: Vec::with_capacity(layer.moves.len()),
            flows: Flows::default(),
        };
        Self { params, out, at, z: None, highest: layer.from.highest }
    }

    /// The way to the first point of a path.
    fn approach(&mut self, to: &PathPoint, retract: bool) {
        let z = self.out.z + to.z;
        // Over all that may stand in the way; on a flat layer that is the layer itself.
        let over = z.max(self.highest);
        if retract {
            self.pull(-self.params.retract, Kind::Retract);
            if self.params.hop > 0 {
                self.lift(over + self.params.hop);
            }
        }
        // Up before sideways. The first way of a print goes down at its end instead:
        // the start block leaves the nozzle above its purge.
        let goes = self.at.is_some_and(|(at, _)| at != to.at);
        if self.at.is_some() && self.z.is_none_or(|now| now < over && goes) {
            self.lift(over);
        }
        self.travel(to.at);
        if self.z != Some(z) {
            self.lift(z);
        }
        if retract {
            self.pull(self.params.retract, Kind::Restore);
        }
    }

    fn travel(&mut self, to: Point) {
        let place = self.params.place(to);
        let length = match self.at {
            Some((_, from)) if from == place => return,
            Some((from, _)) => from.distance(to) / UNITS_PER_MM,
            None => 0.0,
        };
        self.at = Some((to, place));
        self.push(self.params.travel_feed, length, 0.0, Kind::Travel);
    }

    fn lift(&mut self, z: Coord) {
        self.z = Some(z);
        self.push(self.params.z_feed, 0.0, 0.0, Kind::Z);
    }

    fn pull(&mut self, by: f64, kind: Kind) {
        self.push(self.params.retract_feed, 0.0, by, kind);
    }

    /// A move to where the nozzle is now said to be.
    fn push(&mut self, feed: f64, length: f64, filament: f64, kind: Kind) {
        let to = self.at.map_or([0, 0], |(_, place)| place);
        let z = self.z.unwrap_or(self.out.z);
        self.out.moves.push(Move { to, z, feed: whole_feed(feed), length, filament, kind });
    }

    fn path(&mut self, path: &Path) {
        let thick = path.is_thick();
        let slow = if self.out.layer == 0 { self.params.first_layer } else { 1.0 };
        let asked = self.params.feeds[path.role].of(thick) * slow;
        // No bead has this width: the first one is looked at.
        let mut bead = Bead { role: path.role, thick, height: 0, width: -1 };
        let mut feed = 0;
        for ends in path.points.windows(2) {
            let (from, to) = (&ends[0], &ends[1]);
            if (to.width, to.height) != (bead.width, bead.height) {
                (bead.width, bead.height) = (to.width, to.height);
                feed = self.feed(&bead, asked);
            }
            let length = length(from, to) / UNITS_PER_MM;
            self.out.moves.push(Move {
                to: self.params.place(to.at),
                z: self.out.z + to.z,
                feed,
                length,
                filament: self.params.filament(&bead, length),
                kind: Kind::Extrude(bead),
            });
            self.highest = self.highest.max(self.out.z + to.z);
        }
        if let Some(end) = path.points.last() {
            self.at = Some((end.at, self.params.place(end.at)));
            self.z = Some(self.out.z + end.z);
        }
    }

    /// How fast a bead is laid, mm/min.
    fn feed(&mut self, bead: &Bead, asked: f64) -> u32 {
        let (given, flow) = self.params.limit.feed(self.params.filament(bead, 1.0), asked);
        let feeds = Lowered { asked: whole_feed(asked), given };
        self.out.flows.note(bead.role, bead.thick, flow, feeds);
        given
    }
}

/// The length of a segment, grid units.
fn length(from: &PathPoint, to: &PathPoint) -> f64 {
    if from.z == to.z {
        return from.at.distance(to.at);
    }
    let rise = i64::from(to.z) - i64::from(from.z);
    ((from.at.distance2(to.at) + rise * rise) as f64).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fill::Shape;
    use crate::gcode::times::Timer;
    use crate::motion::Limits;
    use crate::plan::{Head, PrintMove};
    use crate::profile;

    fn path(places: &[(Coord, Coord)], y: Coord) -> Path {
        let point = |&(x, z): &(Coord, Coord)| PathPoint {
            at: Point { x, y },
            z,
            width: 4_000,
            height: 2_000 + z,
        };
        let points = places.iter().map(point).collect();
        Path { role: Role::Skin, shape: Shape::Open, points, layers: 1, tool: 0 }
    }

    /// A path that rises by 0.3 mm over 0.4 mm and stays there, then one at the layer's own height.
    fn hill(highest: Coord) -> Toolpath {
        let rising = path(&[(0, 0), (4_000, 3_000), (100_000, 3_000)], 0);
        let flat = path(&[(100_000, 0), (0, 0)], 50_000);
        let moves = [rising, flat].map(|path| PrintMove { retract: false, path }).to_vec();
        let from = Head { at: Some(Point { x: 0, y: 0 }), highest };
        Toolpath { layer: 4, z: 10_000, height: 2_000, from, moves }
    }

    fn moves(toolpath: &Toolpath) -> (Moves, Settings) {
        let settings = profile::load("generic-marlin", &[]).unwrap().settings;
        (MoveParams::new(&settings, [0.0, 0.0]).moves(toolpath), settings)
    }

    #[test]
    fn beads_rise_with_their_points_and_take_the_plastic_of_their_length_and_height() {
        let (moves, settings) = moves(&hill(8_000));
        let beads: Vec<&Move> =
            moves.moves.iter().filter(|m| matches!(m.kind, Kind::Extrude(_))).collect();
        assert_eq!(beads.iter().map(|m| m.z).collect::<Vec<_>>(), [13_000, 13_000, 10_000]);
        // 3, 4, 5: the way up is as long as the slope, not as its shadow.
        assert!((beads[0].length - 0.5).abs() < 1e-12);
        let plastic = beads[0].filament * settings.filament_area();
        assert!((plastic - 0.5 * 0.4 * 0.5).abs() < 1e-9, "{plastic}");
        // A bead more than twice as high is laid more slowly where the hot end melts no more.
        let flow = |m: &Move| f64::from(m.feed) / 60.0 * 0.4 * 0.5;
        assert!(flow(beads[1]) <= settings.machine.max_volumetric_flow + 1e-9);
    }

    #[test]
    fn travels_pass_over_what_stands_higher() {
        let heights = |highest| -> Vec<(Kind, Coord)> {
            let (moves, _) = moves(&hill(highest));
            let way = moves.moves.iter().skip(moves.paths[1]);
            let way = way.take_while(|m| !matches!(m.kind, Kind::Extrude(_)));
            way.map(|m| (m.kind, m.z)).collect()
        };
        // From the hill's own height, which nothing exceeds, then down.
        let down = (Kind::Z, 10_000);
        assert_eq!(heights(8_000), [(Kind::Travel, 13_000), down]);
        // Over what an earlier layer left standing.
        assert_eq!(heights(15_000), [(Kind::Z, 15_000), (Kind::Travel, 15_000), down]);
    }

    #[test]
    fn the_clock_times_the_way_up() {
        let seconds = |toolpath: &Toolpath| {
            let (moves, settings) = moves(toolpath);
            let mut timer = Timer::new(Limits::new(&settings));
            timer.layer(&moves);
            timer.finish();
            timer.times().total()
        };
        let mut level = hill(8_000);
        level.moves.iter_mut().flat_map(|m| &mut m.path.points).for_each(|p| p.z = 0);
        // 0.3 mm up and down again, at no more than the z axis's speed.
        assert!(seconds(&hill(8_000)) > seconds(&level) + 0.03);
    }
}
