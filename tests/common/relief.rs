//! Height over a rectangle -> solid, and what a print of it looks like from above: tops, coverage, plastic, the head's way.
//!
//! Words used here:
//! - The *surface* is the height of the part's top at each place, as a formula: the true one, not the
//!   product's.
//! - A *map* has one height for each square of [`CELL`], where its middle is. Beads are as wide as the
//!   file says and level across; their ends are half their width further out.
//! - The *last skin* is what lies within half a layer of the surface.
//! - The *head* is `long-0.6`: a flat of 1 mm, 60° over 20 mm, a disc of 13 mm above. It may press into
//!   plastic within 1 mm of its middle, 1.5 layers deep, while it prints or goes straight up or down.

use super::{Move, Run, Solid};

/// Side of a square, mm.
pub(crate) const CELL: f64 = 0.1;

/// Squares along the side of a block, so that the head passes over most of a map at a glance.
const BLOCK: usize = 10;

/// Height over the bed at x, y, mm, from the part's lower left corner.
pub(crate) type Surface = fn(f64, f64) -> f64;

/// A block with a sloped top.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Relief {
    /// Sides in x and y, mm.
    pub(crate) sides: [f64; 2],
    pub(crate) surface: Surface,
    /// Squares of the mesh along each side.
    pub(crate) squares: [usize; 2],
}

impl Relief {
    /// The block, its lower left corner at the origin.
    pub(crate) fn solid(&self) -> Solid {
        let [nx, ny] = self.squares;
        let at = |i: usize, j: usize, top: bool| {
            let x = self.sides[0] * i as f64 / nx as f64;
            let y = self.sides[1] * j as f64 / ny as f64;
            [x, y, if top { (self.surface)(x, y) } else { 0.0 }]
        };
        let mut triangles = Vec::new();
        let mut quad = |a, b, c, d| triangles.extend([[a, b, c], [a, c, d]]);
        for i in 0..nx {
            for j in 0..ny {
                let corners = |top| {
                    [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)].map(|(i, j)| at(i, j, top))
                };
                let [a, b, c, d] = corners(true);
                quad(a, b, c, d);
                let [a, b, c, d] = corners(false);
                quad(a, d, c, b);
            }
        }
        for i in 0..nx {
            quad(at(i, 0, false), at(i + 1, 0, false), at(i + 1, 0, true), at(i, 0, true));
            quad(at(i, ny, false), at(i, ny, true), at(i + 1, ny, true), at(i + 1, ny, false));
        }
        for j in 0..ny {
            quad(at(0, j, false), at(0, j, true), at(0, j + 1, true), at(0, j + 1, false));
            quad(at(nx, j, false), at(nx, j + 1, false), at(nx, j + 1, true), at(nx, j, true));
        }
        Solid { triangles }
    }
}

/// A number for each square of a rectangle.
pub(crate) struct Map {
    low: [f64; 2],
    size: [usize; 2],
    values: Vec<f64>,
    /// Greatest value of each [`BLOCK`] by [`BLOCK`] squares, with as many blocks to a row.
    blocks: Vec<f64>,
    in_a_row: usize,
    highest: f64,
}

impl Map {
    pub(crate) fn new(low: [f64; 2], high: [f64; 2]) -> Self {
        let size = [0, 1].map(|axis| ((high[axis] - low[axis]) / CELL).round() as usize);
        let [in_a_row, rows] = size.map(|n| n.div_ceil(BLOCK));
        let (values, blocks) = (vec![0.0; size[0] * size[1]], vec![0.0; in_a_row * rows]);
        Self { low, size, values, blocks, in_a_row, highest: 0.0 }
    }

    /// The squares within some mm of `from` to `to`: index, the way along, mm, and beside it.
    fn near(
        &self,
        from: [f64; 2],
        to: [f64; 2],
        reach: f64,
        mut each: impl FnMut(usize, [f64; 2], [f64; 2]),
    ) {
        let length = (to[0] - from[0]).hypot(to[1] - from[1]).max(1e-9);
        let along = [(to[0] - from[0]) / length, (to[1] - from[1]) / length];
        let range = |axis: usize| {
            let cell = |v: f64| {
                ((v - self.low[axis]) / CELL).floor().clamp(0.0, self.size[axis] as f64) as usize
            };
            cell(from[axis].min(to[axis]) - reach)
                ..(cell(from[axis].max(to[axis]) + reach) + 1).min(self.size[axis])
        };
        for j in range(1) {
            for i in range(0) {
                let at = self.middle([i, j]);
                let by = [at[0] - from[0], at[1] - from[1]];
                let way = by[0] * along[0] + by[1] * along[1];
                each(j * self.size[0] + i, [way, by[1] * along[0] - by[0] * along[1]], at);
            }
        }
    }

    fn middle(&self, [i, j]: [usize; 2]) -> [f64; 2] {
        [self.low[0] + (i as f64 + 0.5) * CELL, self.low[1] + (j as f64 + 0.5) * CELL]
    }

    /// The squares under a bead, with the bead's top there and the square's middle.
    pub(crate) fn under(&self, bead: &Move, mut each: impl FnMut(usize, f64, [f64; 2])) {
        let (half, length) = (bead.width / 2.0 + 1e-6, bead.length());
        self.near(bead.a(), bead.b(), half, |k, [way, beside], at| {
            if beside.abs() <= half && -half <= way && way <= length + half {
                let share = (way / length).clamp(0.0, 1.0);
                each(k, bead.from[2] + share * (bead.to[2] - bead.from[2]), at);
            }
        });
    }

    pub(crate) fn raise(&mut self, bead: &Move) {
        let mut under = Vec::new();
        self.under(bead, |k, z, _| under.push((k, z)));
        for (k, z) in under {
            self.values[k] = self.values[k].max(z);
            let block = k / self.size[0] / BLOCK * self.in_a_row + k % self.size[0] / BLOCK;
            self.blocks[block] = self.blocks[block].max(z);
            self.highest = self.highest.max(z);
        }
    }

    /// Shares a bead's plastic out over the squares under it.
    fn spread(&mut self, bead: &Move, plastic: f64) {
        let mut under = Vec::new();
        self.under(bead, |k, _, _| under.push(k));
        for k in &under {
            self.values[*k] += plastic / under.len() as f64;
        }
    }

    /// Each square of the rectangle, less a margin: its middle and value.
    pub(crate) fn within(&self, margin: f64) -> impl Iterator<Item = (usize, [f64; 2], f64)> {
        let edge = (margin / CELL).round() as usize;
        let row = move |j: usize| {
            (edge..self.size[0] - edge).map(move |i| {
                let k = j * self.size[0] + i;
                (k, self.middle([i, j]), self.values[k])
            })
        };
        (edge..self.size[1] - edge).flat_map(row)
    }

    /// How deep the head stands in what is there, mm: where it may press, and elsewhere.
    fn depth(&self, tip: [f64; 3]) -> [f64; 2] {
        let mut deepest = [0.0_f64; 2];
        if self.highest <= tip[2] {
            return deepest;
        }
        let free = |far: f64| {
            let cone = (far - 0.5).max(0.0) * 60.0_f64.to_radians().tan();
            if far <= 13.0 { cone.min(20.0) } else { f64::INFINITY }
        };
        for (block, &top) in self.blocks.iter().enumerate() {
            let first = [block % self.in_a_row * BLOCK, block / self.in_a_row * BLOCK];
            // The place of the block that is nearest to the tip.
            let beside = [0, 1].map(|axis| {
                let from = self.low[axis] + first[axis] as f64 * CELL;
                tip[axis] - tip[axis].clamp(from, from + BLOCK as f64 * CELL)
            });
            if top <= tip[2] + free(beside[0].hypot(beside[1])) {
                continue;
            }
            for j in first[1]..(first[1] + BLOCK).min(self.size[1]) {
                for i in first[0]..(first[0] + BLOCK).min(self.size[0]) {
                    let at = self.middle([i, j]);
                    let far = (at[0] - tip[0]).hypot(at[1] - tip[1]);
                    let place = usize::from(far > 1.0);
                    let depth = self.values[j * self.size[0] + i] - tip[2] - free(far);
                    deepest[place] = deepest[place].max(depth);
                }
            }
        }
        deepest
    }
}

/// What the last skin of a part and the head's ways are like.
#[derive(Debug, Default)]
pub(crate) struct Looks {
    /// How much of the part's top lies under the last skin, in plan, mm², and which share of all.
    pub(crate) covered: f64,
    pub(crate) coverage: f64,
    /// Mean of tops of the last skin over the surface, µm.
    pub(crate) mean_um: f64,
    /// Plastic of the skins over their room, of each mm² that is all skin.
    pub(crate) fill: Vec<f64>,
    /// Length of skins that stand over the surface by more than half a layer, mm.
    pub(crate) outside: f64,
    /// Length of skins that have mostly nothing within two layers below their tops, mm.
    pub(crate) in_air: f64,
    /// How deep the head presses where it may, mm.
    pub(crate) press: f64,
    /// How deep it stands in plastic where it may not.
    pub(crate) hit: f64,
}

/// Looks at one part whose lower left corner lies at `corner` and whose foot at `lift`, mm. All of the
/// patches on it are looked at together.
pub(crate) fn look(run: &Run, part: &Relief, corner: [f64; 2], lift: f64) -> Looks {
    let high = [0, 1].map(|axis| corner[axis] + part.sides[axis]);
    let surface = |at: [f64; 2]| (part.surface)(at[0] - corner[0], at[1] - corner[1]) + lift;
    let is_own = |m: &Move| {
        let middle = m.at(0.5);
        (0..2).all(|axis| corner[axis] - 1.0 < middle[axis] && middle[axis] < high[axis] + 1.0)
    };
    let layer = run.settings.layer_height;
    let new = || Map::new(corner, high);
    let (mut looks, mut pile, mut base) = (Looks::default(), new(), None);
    let (mut plastic, mut last) = (new(), new());
    for step in run.print.moves.iter().filter(|m| m.layer.is_some()) {
        if !step.is_bead() {
            head_goes(&mut looks, &pile, step, layer);
            continue;
        }
        if step.patch > 0 && is_own(step) {
            base.get_or_insert_with(|| pile.values.clone());
            lay(&mut looks, (&pile, &mut last), step, (layer, &surface));
            plastic.spread(step, step.e * run.filament_area());
        }
        head_goes(&mut looks, &pile, step, layer);
        pile.raise(step);
    }
    let base = base.unwrap_or_else(|| pile.values.clone());
    let tops = last.within(0.0).filter(|(.., z)| *z > 0.0);
    let over: Vec<f64> = tops.map(|(_, at, z)| z - surface(at)).collect();
    looks.covered = over.len() as f64 * CELL * CELL;
    looks.coverage = over.len() as f64 / last.values.len() as f64;
    looks.mean_um = 1000.0 * over.iter().sum::<f64>() / over.len().max(1) as f64;
    looks.fill = fills([&plastic, &last], &base, &surface);
    looks
}

/// Tries the head on the way of a move.
fn head_goes(looks: &mut Looks, pile: &Map, step: &Move, layer: f64) {
    let rise = step.to[2] - step.from[2];
    let count = (step.length().hypot(rise) / 0.25).ceil().max(1.0) as usize;
    let may_press = step.is_bead() || step.length() == 0.0;
    for k in 0..=count {
        let share = k as f64 / count as f64;
        let [x, y] = step.at(share);
        let [near, far] = pile.depth([x, y, step.from[2] + share * rise]);
        if may_press && near <= 1.5 * layer {
            looks.press = looks.press.max(near);
        } else {
            looks.hit = looks.hit.max(near);
        }
        looks.hit = looks.hit.max(far);
    }
}

/// Adds a bead of a skin to the last skin, as far as it is of that, and what is wrong with it.
fn lay(
    looks: &mut Looks,
    (pile, last): (&Map, &mut Map),
    bead: &Move,
    (layer, surface): (f64, &dyn Fn([f64; 2]) -> f64),
) {
    let (mut all, mut outside, mut bare) = (0_u32, 0_u32, 0_u32);
    let mut covered = Vec::new();
    pile.under(bead, |k, z, at| {
        all += 1;
        let over = z - surface(at);
        outside += u32::from(over > layer / 2.0);
        if over.abs() <= layer / 2.0 {
            covered.push((k, z));
        }
        bare += u32::from(!(z - 2.0 * layer..z + layer).contains(&pile.values[k]));
    });
    covered.into_iter().for_each(|(k, z)| last.values[k] = z);
    looks.outside += bead.length() * f64::from(outside) / f64::from(all.max(1));
    // It shares squares with the line beside it and the segment before it: of short ones none are told.
    looks.in_air += if 2 * bare > all { bead.length() } else { 0.0 };
}

/// Plastic over room of each mm² that is all last skin.
fn fills([plastic, last]: [&Map; 2], base: &[f64], surface: &dyn Fn([f64; 2]) -> f64) -> Vec<f64> {
    let side = (1.0 / CELL).round() as usize;
    let mut out = Vec::new();
    for j in (0..last.size[1] / side).map(|j| j * side) {
        for i in (0..last.size[0] / side).map(|i| i * side) {
            let squares = || (0..side * side).map(move |n| [i + n % side, j + n / side]);
            let index = |[i, j]: [usize; 2]| j * last.size[0] + i;
            if squares().all(|at| last.values[index(at)] > 0.0) {
                let room: f64 =
                    squares().map(|at| surface(last.middle(at)) - base[index(at)]).sum();
                let laid: f64 = squares().map(|at| plastic.values[index(at)]).sum();
                out.push(laid / (room * CELL * CELL));
            }
        }
    }
    out
}
