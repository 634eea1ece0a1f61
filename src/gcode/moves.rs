//! Toolpath -> Moves: turns the paths of one layer into machine moves, as they will be written.
//!
//! The text, the sums and the clock all read these moves. So lengths, feeds and filament are
//! computed once, and the clock times exactly what is written.
//!
//! - A *move* is one straight line with its feed and its filament.
//! - The *approach* of a path is all moves before its first bead: retraction, lift, travel, descent
//!   and the restored filament.
//! - *Highest* is the greatest z printed so far, and over a patch of non-planar skin the clearance more.
//!   It is above the layer only after a path that rose.
//!
//! For each path, in order:
//! 1. Retract if the plan says so, wipe, and lift by the z-hop.
//! 2. Lift over everything that is printed, travel, and go down to the first point. Within a patch the
//!    plan says how high that is.
//! 3. Write a move for each pair of points. Filament is length x width x height x rate of the role, and of
//!    a round strand π/4 of that. The length is that in plan, also on a slope: between two surfaces one
//!    straight above the other, lines a width apart in plan fill width x height x length in plan.
//! 4. Where width or height change, compute the feed again, clamped to the flow limit.

use super::flow::{FlowLimit, Flows, Lowered, feed, whole_feed};
use super::reshaped::{ArcRun, PatchRun, Short, SlopeFeeds};
use crate::fill::{Both, Path, PathPoint, Role, RoleTable, Shape};
use crate::geom::Point;
use crate::plan::{PrintMove, Toolpath};
use crate::profile::{ExtrusionModel, Settings};
use crate::units::{Bounded as _, Coord, Thousandths, UNITS_PER_MM, to_mm, to_units};

/// A straight move.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Move {
    /// Where it ends in x and y on the machine, thousandths of a mm.
    pub to: [Thousandths; 2],
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
    /// Stands still for so many ms.
    Wait(u32),
    /// Lays a bead. A segment may end where it began, if it is shorter than the rounding of
    /// coordinates; its filament still counts.
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

impl Bead {
    /// Whether both may be parts of one line: all is the same, but for a hundredth of the width.
    pub(super) fn is_like(&self, other: &Self) -> bool {
        (self.role, self.thick, self.height) == (other.role, other.thick, other.height)
            && 100 * (self.width - other.width).abs() <= other.width
    }
}

/// All machine moves of one layer.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Moves {
    /// The layer, counted from 0.
    pub layer: usize,
    /// Top of the layer above the bed, grid units.
    pub z: Coord,
    /// Height of the layer, grid units.
    pub height: Coord,
    /// Where the nozzle comes from, thousandths of a mm, if known.
    pub from: Option<[Thousandths; 2]>,
    /// The moves, in order.
    pub moves: Vec<Move>,
    /// For each path, the index of the first move of its approach.
    pub paths: Vec<usize>,
    /// The arcs among the moves, in their order.
    pub arcs: Vec<ArcRun>,
    /// What was done about lines shorter than the printer can be fed.
    pub short: Short,
    /// Its plastic flow, and feeds that the flow limit lowered.
    pub flows: Flows,
    /// Mean time of the layers of its group, s, where the fan goes by it.
    pub group_seconds: Option<f64>,
    /// Paths that rise or fall, by their number in [`Self::paths`], in order.
    pub risen: Vec<usize>,
    /// The patches of non-planar skin, in order.
    pub patches: Vec<PatchRun>,
    /// What holds the feeds of risen paths down.
    pub slopes: SlopeFeeds,
    /// As high as travels have to go after it, grid units above the bed.
    pub highest: Coord,
}

impl Moves {
    /// Finds the largest flow anew, now that lines are slower; `area` is the filament's cross-section, mm².
    pub(super) fn slowed(&mut self, area: f64) {
        let lines = self.moves.iter().filter(|step| step.length > 0.0);
        let beads = lines.filter(|step| matches!(step.kind, Kind::Extrude(_)));
        let flow = beads.map(|s| s.filament * area / s.length * f64::from(s.feed) / 60.0);
        self.flows.largest = flow.fold(0.0, f64::max).min(self.flows.largest);
    }
}

/// How the first layer differs from others, on the bed and of the part on a raft.
#[derive(Debug, Clone, Copy)]
struct FirstLayer {
    /// The part's; 0 without a raft.
    of_part: usize,
    /// Factor on its feeds.
    slow: f64,
    /// Its highest feed, mm/min.
    most: f64,
    /// Factor on its filament.
    flow: f64,
}

/// The settings from which moves are made.
#[derive(Debug, Clone)]
pub struct MoveParams {
    /// Machine coordinates of the layout's middle, grid units.
    offset: [i64; 2],
    /// mm of filament for each mm of path, mm of width and mm of height, by role.
    rates: RoleTable<f64>,
    /// Requested feeds by role, mm/min.
    feeds: RoleTable<Both<f64>>,
    first_layer: FirstLayer,
    /// Factor on the feeds of closed walls shorter than this, grid units.
    small_loop: (f64, f64),
    travel_feed: f64,
    z_feed: f64,
    retract: f64,
    retract_feed: f64,
    hop: Coord,
    /// Over a patch of non-planar skin, grid units.
    clearance: Coord,
    limit: FlowLimit,
}

impl MoveParams {
    /// Converts `settings`. `offset` holds the machine coordinates of the layout's middle, mm.
    #[must_use]
    pub fn new(settings: &Settings, offset: [f64; 2]) -> Self {
        let (x, s) = (&settings.extrusion, &settings.speed);
        let area = settings.filament_area();
        let rate = |factor: f64| match x.model {
            ExtrusionModel::Area | ExtrusionModel::Round => x.multiplier * x.section() / area,
            ExtrusionModel::Factor => x.multiplier * factor / (x.factor_width * x.factor_height),
        };
        Self {
            offset: offset.map(|mm| i64::from(to_units(mm))),
            rates: RoleTable::new(|role| rate((role.facts().factor)(x))),
            feeds: RoleTable::new(|role| {
                let speed = (role.facts().speed)(s);
                Both { thin: feed(speed.thin), thick: feed(speed.thick) }
            }),
            first_layer: FirstLayer {
                of_part: settings.raft_layers(),
                slow: s.first_layer / 100.0,
                most: feed(s.first_layer_max),
                flow: x.first_layer / 100.0,
            },
            small_loop: (s.small_loop / 100.0, s.small_loop_length * UNITS_PER_MM),
            travel_feed: feed(s.travel),
            z_feed: feed(s.z),
            retract: settings.retraction.length,
            retract_feed: feed(settings.retraction.speed),
            hop: to_units(settings.retraction.z_hop),
            clearance: to_units(settings.nonplanar.clearance),
            limit: FlowLimit::new(settings),
        }
    }

    /// Filament for `length_mm` of a bead of a layer, mm.
    fn filament(&self, bead: &Bead, length_mm: f64, layer: usize) -> f64 {
        let all = self.rates[bead.role] * length_mm * to_mm(bead.width) * to_mm(bead.height);
        if layer == 0 { all * self.first_layer.flow } else { all }
    }

    /// The feed asked for where nothing hangs, mm/min: small loops are slower.
    fn usual(&self, path: &Path) -> f64 {
        let usual = *self.feeds[path.role].of(path.is_thick());
        let (factor, limit) = self.small_loop;
        if factor >= 1.0 || !matches!(path.shape, Shape::Loop { .. }) {
            return usual;
        }
        let mut left = limit;
        for ends in path.points.windows(2) {
            left -= length(&ends[0], &ends[1]);
            if left <= 0.0 {
                return usual;
            }
        }
        factor * usual
    }

    /// The feed asked for where a path of a layer hangs by `hang` % of its width, mm/min. From half to the
    /// whole width it falls from the `usual` one to that of overhangs.
    fn asked(&self, role: Role, usual: f64, hang: u8, layer: usize) -> f64 {
        let share = (f64::from(hang) / 50.0 - 1.0).at_least(0.0);
        let asked = usual - share * (usual - self.feeds[Role::Overhang].thin).at_least(0.0);
        let FirstLayer { of_part, slow, most, .. } = self.first_layer;
        // The speed of a raft's base is that of a first layer.
        let slow = if role == Role::RaftBase { 1.0 } else { slow };
        if layer == 0 || layer == of_part { (asked * slow).at_most(most) } else { asked }
    }

    /// The moves of one layer.
    #[must_use]
    pub fn moves(&self, layer: &Toolpath) -> Moves {
        let mut walk = Walk::new(self, layer);
        for next in &layer.moves {
            let Some(first) = next.path.points.first() else { continue };
            walk.out.paths.push(walk.out.moves.len());
            let goes_on = walk.mark(next.patch);
            walk.approach(first, next, goes_on);
            walk.path(&next.path, next.patch.is_some());
        }
        Moves { highest: walk.highest, ..walk.out }
    }

    /// The last retraction, after everything is printed: length, mm, and feed, mm/min.
    #[must_use]
    pub fn last_pull(&self) -> (f64, u32) {
        (self.retract, whole_feed(self.retract_feed))
    }

    /// Machine coordinates of a point.
    fn place(&self, p: Point) -> [Thousandths; 2] {
        let [x, y] = self.offset;
        // A thousandth is ten units. Halves round upwards on both sides of zero, so that equal
        // beads stay equal wherever they lie.
        [(i64::from(p.x) + x + 5).div_euclid(10), (i64::from(p.y) + y + 5).div_euclid(10)]
            .map(|thousandths| Thousandths(thousandths as i32))
    }
}

/// Builds the moves of a layer, and keeps track of the nozzle.
struct Walk<'a> {
    params: &'a MoveParams,
    out: Moves,
    /// Position of the nozzle: in the layout and on the machine.
    at: Option<(Point, [Thousandths; 2])>,
    /// Height of the nozzle, once this layer has set it.
    z: Option<Coord>,
    /// What travels pass over.
    highest: Coord,
}

impl<'a> Walk<'a> {
    fn new(params: &'a MoveParams, layer: &Toolpath) -> Self {
        let at = layer.from.at.map(|from| (from, params.place(from)));
        let points: usize = layer.moves.iter().map(|next| next.path.points.len()).sum();
        // A path has one point more than segments. Its approach takes the rest.
        let most = points + 3 * layer.moves.len();
        let out = Moves {
            layer: layer.layer,
            z: layer.z,
            height: layer.height,
            from: at.map(|(_, place)| place),
            moves: Vec::with_capacity(most),
            paths: Vec::with_capacity(layer.moves.len()),
            ..Moves::default()
        };
        Self { params, out, at, z: None, highest: layer.from.highest }
    }

    /// Notes that the path that begins here is of this patch. Returns whether the one before is as well.
    fn mark(&mut self, patch: Option<u32>) -> bool {
        let (Some(patch), path) = (patch, self.out.paths.len() - 1) else { return false };
        let run = self.out.patches.last_mut();
        match run.filter(|run| run.patch == patch && run.paths.end == path) {
            Some(run) => run.paths.end = path + 1,
            None => {
                self.out.patches.push(PatchRun { patch, paths: path..path + 1 });
                return false;
            }
        }
        true
    }

    /// Adds the approach to the first point of a path; `goes_on` within a patch.
    fn approach(&mut self, to: &PathPoint, next: &PrintMove, goes_on: bool) {
        let PrintMove { retract, wipe, via, over: least, .. } = next;
        let retract = *retract;
        let z = self.out.z + to.z;
        // The height of the travel. On a flat layer that is the layer's own. Within a patch the plan
        // knows what stands under the way.
        let over = z.max(*least).max(if goes_on { 0 } else { self.highest });
        if retract {
            self.pull(-self.params.retract, Kind::Retract);
            wipe.iter().for_each(|&at| self.travel(at));
            if self.params.hop > 0 {
                self.lift(over + self.params.hop);
            }
        }
        // Lift before the travel. The first approach of a print goes down after its travel
        // instead, since the start block leaves the nozzle above its purge.
        let goes = self.at.is_none_or(|(at, _)| at != to.at);
        let known = self.at.is_some() || *least > 0;
        if known && self.z.is_none_or(|now| now < over && goes) {
            self.lift(over);
        }
        via.iter().for_each(|&at| self.travel(at));
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

    /// Adds a move that ends at the nozzle's current position.
    fn push(&mut self, feed: f64, length: f64, filament: f64, kind: Kind) {
        let to = self.at.map_or([Thousandths(0); 2], |(_, place)| place);
        let z = self.z.unwrap_or(self.out.z);
        self.out.moves.push(Move { to, z, feed: whole_feed(feed), length, filament, kind });
    }

    /// Adds the beads of a path, which may be one of a patch.
    fn path(&mut self, path: &Path, of_patch: bool) {
        let thick = path.is_thick();
        // No bead has a negative width, so that the first segment always computes its feed.
        let mut bead = Bead { role: path.role, thick, height: 0, width: -1 };
        let (mut asked, mut hang, mut level, mut rises) = (0.0, 0, None, of_patch);
        let usual = self.params.usual(path);
        for ends in path.points.windows(2) {
            let (from, to) = (&ends[0], &ends[1]);
            if (to.width, to.height, to.hang) != (bead.width, bead.height, hang) {
                (bead.width, bead.height, hang) = (to.width, to.height, to.hang);
                bead.role = if hang > 0 { Role::Overhang } else { path.role };
                asked = self.params.asked(path.role, usual, hang, self.out.layer);
                level = None;
            }
            let shadow = from.at.distance(to.at);
            let long = if from.z == to.z { shadow } else { length(from, to) };
            let feed = match level.filter(|_| from.z == to.z) {
                Some(feed) => feed,
                // A slope is longer than its shadow, and takes its plastic in more time.
                None if from.z != to.z => self.feed(&bead, asked, shadow / long),
                None => *level.insert(self.feed(&bead, asked, 1.0)),
            };
            rises |= from.z != to.z;
            self.out.moves.push(Move {
                to: self.params.place(to.at),
                z: self.out.z + to.z,
                feed,
                length: long / UNITS_PER_MM,
                filament: self.params.filament(&bead, shadow / UNITS_PER_MM, self.out.layer),
                kind: Kind::Extrude(bead),
            });
            let clearance = if of_patch { self.params.clearance } else { 0 };
            self.highest = self.highest.max(self.out.z + from.z.max(to.z) + clearance);
        }
        if rises {
            self.out.risen.push(self.out.paths.len() - 1);
        }
        if let Some(end) = path.points.last() {
            self.at = Some((end.at, self.params.place(end.at)));
            self.z = Some(self.out.z + end.z);
        }
    }

    /// The feed of a bead, clamped to the flow limit, mm/min. It takes its filament for `plan` mm of each
    /// mm that the nozzle goes.
    fn feed(&mut self, bead: &Bead, asked: f64, plan: f64) -> u32 {
        let filament = self.params.filament(bead, plan, self.out.layer);
        let (given, flow) = self.params.limit.feed(filament, asked);
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
    use crate::plan::Nozzle;
    use crate::profile;

    fn path(places: &[(Coord, Coord)], y: Coord) -> Path {
        let point = |&(x, z): &(Coord, Coord)| PathPoint {
            at: Point { x, y },
            z,
            width: 4_000,
            height: 2_000 + z,
            hang: 0,
        };
        let points = places.iter().map(point).collect();
        Path { role: Role::Skin, shape: Shape::Open, points, layers: 1 }
    }

    /// A path that rises by 0.3 mm over 0.4 mm and stays there, then one at the layer's own height.
    fn hill(highest: Coord) -> Toolpath {
        let rising = path(&[(0, 0), (4_000, 3_000), (100_000, 3_000)], 0);
        let flat = path(&[(100_000, 0), (0, 0)], 50_000);
        let moves = [rising, flat].map(PrintMove::to).to_vec();
        let from = Nozzle { at: Some(Point { x: 0, y: 0 }), highest };
        Toolpath { layer: 4, z: 10_000, height: 2_000, from, moves }
    }

    fn moves(toolpath: &Toolpath) -> (Moves, Settings) {
        let mut settings = profile::load(["generic-marlin"], &[]).unwrap().settings;
        settings.machine.max_volumetric_speed = 5.0;
        (MoveParams::new(&settings, [0.0, 0.0]).moves(toolpath), settings)
    }

    #[test]
    fn beads_rise_with_their_points_and_take_the_plastic_of_their_plan_and_height() {
        let (moves, settings) = moves(&hill(8_000));
        let beads: Vec<&Move> =
            moves.moves.iter().filter(|m| matches!(m.kind, Kind::Extrude(_))).collect();
        assert_eq!(beads.iter().map(|m| m.z).collect::<Vec<_>>(), [13_000, 13_000, 10_000]);
        // 3, 4, 5: the way up is as long as the slope, its plastic that of its shadow.
        assert!((beads[0].length - 0.5).abs() < 1e-12);
        let plastic = beads[0].filament * settings.filament_area();
        assert!((plastic - 0.4 * 0.4 * 0.5).abs() < 1e-9, "{plastic}");
        // A bead more than twice as high is laid more slowly where the hot end melts no more, and the
        // faster the longer the way is on which that is laid.
        let most = settings.max_volumetric_speed();
        for (bead, plan) in [(beads[0], 0.8), (beads[1], 1.0)] {
            let flow = |feed: u32| f64::from(feed) / 60.0 * 0.4 * 0.5 * plan;
            assert!(flow(bead.feed) <= most + 1e-9 && flow(bead.feed + 1) > most, "{bead:?}");
        }
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
}
