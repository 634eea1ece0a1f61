//! A wedge with a tower beside it -> G-code made by hand whose z varies within a layer, and its mesh.
//!
//! Words used here: the *surface* is the wedge's top, [`height`] at each x; the *base* is what of the
//! wedge is printed flat, straight down from the surface by two layers; a *skin* is lines over the
//! slope, the first along it, the last across it, so that each line of that one is level.
//!
//! - Our own form ([`Form::Marked`]) has the skins between marks after the layer that makes the base
//!   whole; the tower goes on with layers lower than the patch's highest lines.
//! - Ahlers's fork of Slic3r ([`Form::Bare`]) has no comments, and the skins after the whole body.
//! - [`Form::Contoured`]: Orca's contouring ([`Form::Contoured`]) lowers the lines of a top within their own layer.

use slicer::mesh::Mesh;
use std::fmt::Write as _;

/// Height of a layer, width of a line, mm.
pub(crate) const LAYER: f64 = 0.2;
pub(crate) const WIDTH: f64 = 0.4;

/// Sides of the wedge, and its lower left corner on the bed, mm.
pub(crate) const SIDES: [f64; 2] = [20.0, 10.0];
pub(crate) const CORNER: [f64; 2] = [90.0, 90.0];

/// Rise of its surface, 10 degrees, and its height at the lower end, mm.
const RISE: f64 = 0.176_327;
const LOW: f64 = 1.2;

/// Side of the tower, its distance from the wedge, mm, and its layers.
const TOWER: [f64; 2] = [6.0, 8.0];
pub(crate) const LAYERS: usize = 30;

/// Feed of skins and of all else, and of the nozzle up and down, mm/min.
const SLOW: f64 = 1200.0;
const FAST: f64 = 2400.0;
const LIFT: f64 = 600.0;

/// Plastic of a mm³, mm of filament 1.75 mm thick.
const FILAMENT: f64 = 1.0 / 2.405_282;

/// How a file has its skins.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Form {
    Marked,
    Bare,
    Contoured,
}

/// What is done to a line of a skin, counted from 0 in both skins together.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Change {
    /// mm.
    pub(crate) lift: f64,
    /// Times.
    pub(crate) flow: f64,
    pub(crate) feed: f64,
    pub(crate) left_out: bool,
}

pub(crate) const SAME: Change = Change { lift: 0.0, flow: 1.0, feed: 1.0, left_out: false };

/// Height of the surface, mm; `x` from the wedge's lower end.
pub(crate) fn height(x: f64) -> f64 {
    LOW + RISE * x
}

/// What of the base is narrower is not printed, mm.
const NARROW: f64 = 2.5 * WIDTH;

/// Layers of the base: the middle of the last lies below its top.
pub(crate) fn base() -> usize {
    ((height(SIDES[0] - NARROW) - 1.5 * LAYER) / LAYER).floor() as usize
}

/// Lines of a skin along x, and across.
pub(crate) fn lines() -> [usize; 2] {
    [SIDES[1], SIDES[0]].map(|side| (side / WIDTH).round() as usize)
}

/// A file. `joined` skins are zigzags, else each line stands alone; `change` is asked for each line.
pub(crate) fn file(form: Form, joined: bool, change: impl Fn(usize) -> Change) -> String {
    let mut pen = Pen { text: String::new(), at: [0.0; 3], form, told: 0.0 };
    pen.say("; made by hand");
    pen.code("G28\nM109 S210\nM83\nG1 Z5 F600");
    let wedge = if form == Form::Contoured { LAYERS } else { base() };
    for k in 0..LAYERS {
        pen.layer(k);
        if k < wedge {
            pen.wedge(k);
        }
        if form != Form::Bare {
            pen.tower(k);
        }
        if form != Form::Contoured && k + 1 == base() {
            pen.patch(joined, &change);
            if form == Form::Bare {
                break;
            }
        }
    }
    pen.code("M104 S0");
    pen.text
}

struct Pen {
    text: String,
    at: [f64; 3],
    form: Form,
    /// Height of lines that was told last, mm.
    told: f64,
}

impl Pen {
    fn code(&mut self, text: &str) {
        let _ = writeln!(self.text, "{text}");
    }

    fn say(&mut self, comment: &str) {
        if self.form != Form::Bare {
            self.code(comment);
        }
    }

    /// Up, over and down.
    fn travel(&mut self, to: [f64; 3], over: f64) {
        let up = over.max(self.at[2]).max(to[2]);
        if up > self.at[2] {
            self.code(&format!("G1 Z{up:.3} F{LIFT}"));
        }
        self.code(&format!("G1 X{:.3} Y{:.3} F6000", to[0], to[1]));
        if up > to[2] {
            self.code(&format!("G1 Z{:.3} F{LIFT}", to[2]));
        }
        self.at = to;
    }

    /// A line, of a height that is told, mm; plastic by its length from above.
    fn line(&mut self, to: [f64; 3], height: f64, (flow, feed): (f64, f64)) {
        if (height - self.told).abs() > 1e-6 {
            self.say(&format!(";HEIGHT:{height:.3}"));
            self.told = height;
        }
        let [x, y] = [to[0] - self.at[0], to[1] - self.at[1]];
        let e = x.hypot(y) * WIDTH * height * FILAMENT * flow;
        let z = if to[2] == self.at[2] { String::new() } else { format!(" Z{:.3}", to[2]) };
        self.code(&format!("G1 X{:.3} Y{:.3}{z} E{e:.5} F{feed:.0}", to[0], to[1]));
        self.at = to;
    }

    fn layer(&mut self, k: usize) {
        self.say(";LAYER_CHANGE");
        self.say(&format!(";Z:{:.1}", LAYER * (k + 1) as f64));
    }

    /// A loop within a box and lines along y that fill it, `x` from the wedge's lower end.
    fn solid(
        &mut self,
        [from, to]: [f64; 2],
        deep: f64,
        (z, over): (f64, f64),
        bent: &dyn Fn(f64) -> f64,
    ) {
        let at = |x: f64, y: f64| [CORNER[0] + x, CORNER[1] + y, z];
        let half = WIDTH / 2.0;
        let (a, b) = (from + half, to - half);
        self.say(&format!(";TYPE:External perimeter\n;WIDTH:{WIDTH}"));
        self.travel(at(a, half), over);
        for corner in [at(b, half), at(b, deep - half), at(a, deep - half), at(a, half)] {
            self.line(corner, LAYER, (1.0, FAST));
        }
        let count = ((to - from) / WIDTH - 2.0).floor() as usize;
        let ends = [1.25 * WIDTH, deep - 1.25 * WIDTH];
        self.say(";TYPE:Solid infill");
        for k in 0..count {
            let x = from + WIDTH * (k as f64 + 1.5);
            let by = bent(x);
            let at = |y: f64| [CORNER[0] + x, CORNER[1] + y, z + by];
            if k == 0 {
                self.travel(at(ends[0]), over);
            } else {
                self.line(at(ends[k % 2]), LAYER + by, (1.0, FAST));
            }
            self.line(at(ends[1 - k % 2]), LAYER + by, (1.0, FAST));
        }
    }

    fn wedge(&mut self, k: usize) {
        let (z, below) =
            (LAYER * (k + 1) as f64, if self.form == Form::Contoured { 0.0 } else { 2.0 });
        // Where the middle of the layer meets the surface less the skins.
        let from = ((z - LAYER / 2.0 + below * LAYER - LOW) / RISE).clamp(0.0, SIDES[0]);
        if SIDES[0] - from < NARROW {
            return;
        }
        let bent = |x: f64| (height(x) - z).clamp(-0.14, 0.06);
        let is_bent = self.form == Form::Contoured;
        // Where the layer above begins, no top is seen.
        let top = from + LAYER / RISE;
        let bent = |x: f64| if is_bent && x < top { bent(x) } else { 0.0 };
        self.solid([from, SIDES[0]], SIDES[1], (z, z), &bent);
    }

    fn tower(&mut self, k: usize) {
        let from = SIDES[0] + TOWER[1];
        let z = LAYER * (k + 1) as f64;
        let over = if k >= base() { height(SIDES[0]) + 1.0 } else { z };
        self.solid([from, from + TOWER[0]], TOWER[0], (z, over), &|_| 0.0);
    }

    fn patch(&mut self, joined: bool, change: &impl Fn(usize) -> Change) {
        self.say(";NONPLANAR_START 1\n;TYPE:Top solid infill");
        let (half, over) = (WIDTH / 2.0, height(SIDES[0]) + 1.0);
        let [along, across] = lines();
        let mut is_first = true;
        for k in 0..along + across {
            let Change { lift, flow, feed, left_out } = change(k);
            let (skin, j) = if k < along { (1.0, k) } else { (0.0, k - along) };
            let side = half + WIDTH * j as f64;
            let mut ends = if k < along {
                [[half, side], [SIDES[0] - half, side]]
            } else {
                [[side, half], [side, SIDES[1] - half]]
            };
            if j % 2 == 1 {
                ends.reverse();
            }
            is_first |= j == 0;
            if left_out {
                is_first = true;
                continue;
            }
            let at =
                ends.map(|[x, y]| [CORNER[0] + x, CORNER[1] + y, height(x) - skin * LAYER + lift]);
            let how = (flow, SLOW * feed);
            if is_first || !joined {
                self.travel(at[0], over);
            } else {
                self.line(at[0], LAYER, how);
            }
            self.line(at[1], LAYER, how);
            is_first = false;
        }
        self.say(";NONPLANAR_END");
    }
}

/// The wedge and the tower, their corner at 0.
pub(crate) fn mesh(has_tower: bool) -> Mesh {
    let mut mesh = Mesh::default();
    let [x, y] = SIDES;
    block(&mut mesh, [0.0, x], y, [height(0.0), height(x)]);
    if has_tower {
        let from = x + TOWER[1];
        block(&mut mesh, [from, from + TOWER[0]], TOWER[0], [LAYER * LAYERS as f64; 2]);
    }
    mesh
}

/// A block of these heights at its two ends.
fn block(mesh: &mut Mesh, [from, to]: [f64; 2], deep: f64, [low, high]: [f64; 2]) {
    let first = mesh.vertices.len() as u32;
    let corners = [
        [from, 0.0, 0.0],
        [to, 0.0, 0.0],
        [from, deep, 0.0],
        [to, deep, 0.0],
        [from, 0.0, low],
        [to, 0.0, high],
        [from, deep, low],
        [to, deep, high],
    ];
    mesh.vertices.extend(corners.map(|corner| corner.map(slicer::units::to_units)));
    let faces: [[u32; 3]; 12] = [
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
    mesh.triangles.extend(faces.map(|face| face.map(|corner| corner + first)));
}
