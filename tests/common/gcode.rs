//! G-code text -> Print: parses every move with its role, from the format's rules and not from the writer.

use std::collections::BTreeMap;
use std::f64::consts::TAU;

/// What `;TYPE:` says a move is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Kind {
    /// Start and end blocks.
    Custom,
    OuterWall,
    InnerWall,
    /// A stretch of either wall.
    Overhang,
    Skin,
    Ironing,
    Bridge,
    Infill,
    Support,
    SupportInterface,
    /// Skirt and brim.
    Brim,
}

/// The kinds of walls.
pub(crate) const WALLS: [Kind; 3] = [Kind::OuterWall, Kind::InnerWall, Kind::Overhang];

impl Kind {
    /// Whether it is no part of the model.
    pub(crate) fn is_support(self) -> bool {
        matches!(self, Self::Support | Self::SupportInterface)
    }
}

/// One `G0` or `G1`, or a piece of a `G2` or `G3`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Move {
    /// Line of the file, from 1.
    pub(crate) line: usize,
    /// Layer from 0; `None` before the first.
    pub(crate) layer: Option<usize>,
    pub(crate) kind: Kind,
    pub(crate) from: [f64; 3],
    pub(crate) to: [f64; 3],
    /// Filament pushed (pulled if negative), mm.
    pub(crate) e: f64,
    /// Filament that is pulled back when the move begins, mm.
    pub(crate) pulled: f64,
    /// mm/min.
    pub(crate) feed: f64,
    /// Of the bead, mm.
    pub(crate) height: f64,
    /// Of the bead, mm.
    pub(crate) width: f64,
    /// The patch of skin that follows a surface, from 1; 0 for all else.
    pub(crate) patch: u32,
}

impl Move {
    /// In the plane, mm.
    pub(crate) fn length(&self) -> f64 {
        (self.to[0] - self.from[0]).hypot(self.to[1] - self.from[1])
    }

    /// Lays filament on a layer.
    pub(crate) fn is_bead(&self) -> bool {
        self.layer.is_some() && self.kind != Kind::Custom && self.e > 0.0 && self.length() > 0.0
    }

    /// Moves in the plane without filament.
    pub(crate) fn is_travel(&self) -> bool {
        self.layer.is_some() && self.kind != Kind::Custom && self.e == 0.0 && self.length() > 0.0
    }

    pub(crate) fn a(&self) -> [f64; 2] {
        [self.from[0], self.from[1]]
    }

    pub(crate) fn b(&self) -> [f64; 2] {
        [self.to[0], self.to[1]]
    }

    /// The point a part `t` of the way along.
    pub(crate) fn at(&self, t: f64) -> [f64; 2] {
        let (a, b) = (self.a(), self.b());
        [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])]
    }
}

/// What the annotations of one layer say.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct LayerHead {
    pub(crate) z: f64,
    pub(crate) height: f64,
}

/// A file.
#[derive(Debug, Clone, Default)]
pub(crate) struct Print {
    pub(crate) moves: Vec<Move>,
    pub(crate) layers: Vec<LayerHead>,
    /// Values of `M73 P`, in order.
    pub(crate) progress: Vec<i64>,
}

/// Words in force.
struct State {
    at: [f64; 3],
    e: f64,
    relative_e: bool,
    feed: f64,
    pulled: f64,
    kind: Kind,
    height: f64,
    width: f64,
    patch: u32,
}

/// The ends of pieces of an arc, of a degree at most: much finer than any printer's. An arc that does
/// not end on its circle is an error.
fn arc(
    from: [f64; 3],
    to: [f64; 3],
    middle: [f64; 2],
    clockwise: bool,
) -> Result<Vec<[f64; 3]>, String> {
    let polar = |at: [f64; 3]| {
        let (x, y) = (at[0] - middle[0], at[1] - middle[1]);
        (x.hypot(y), y.atan2(x))
    };
    let ((radius, start), (there, end)) = (polar(from), polar(to));
    if (radius - there).abs() > 0.002 || from[2] != to[2] {
        return Err(format!("an arc from radius {radius} to {there}"));
    }
    let turn = if clockwise { start - end } else { end - start }.rem_euclid(TAU);
    let count = turn.to_degrees().ceil().max(1.0) as usize;
    let sign = if clockwise { -1.0 } else { 1.0 };
    let place = |k: usize| {
        let angle = start + sign * turn * k as f64 / count as f64;
        [middle[0] + radius * angle.cos(), middle[1] + radius * angle.sin(), to[2]]
    };
    Ok((1..count).map(place).chain([to]).collect())
}

impl Print {
    /// Reads `text`. An error names the line that is no G-code.
    pub(crate) fn read(text: &str) -> Result<Self, String> {
        let mut print = Self::default();
        let mut state = State {
            at: [0.0; 3],
            e: 0.0,
            relative_e: false,
            feed: 0.0,
            pulled: 0.0,
            kind: Kind::Custom,
            height: 0.0,
            width: 0.0,
            patch: 0,
        };
        for (k, line) in text.lines().enumerate() {
            let step = match line.split_once(';') {
                Some((code, note)) if code.trim().is_empty() => print.note(note, &mut state),
                Some((code, _)) => print.code(k + 1, code, &mut state),
                None => print.code(k + 1, line, &mut state),
            };
            step.map_err(|what| format!("line {}: {what}: {line}", k + 1))?;
        }
        Ok(print)
    }

    fn note(&mut self, note: &str, state: &mut State) -> Result<(), String> {
        let number = |text: &str| text.parse::<f64>().map_err(|e| e.to_string());
        if note == "LAYER_CHANGE" {
            self.layers.push(LayerHead { z: f64::NAN, height: f64::NAN });
        } else if let Some(kind) = note.strip_prefix("TYPE:") {
            state.kind = match kind {
                "Custom" => Kind::Custom,
                "External perimeter" => Kind::OuterWall,
                "Perimeter" => Kind::InnerWall,
                "Solid infill" | "Top solid infill" | "Gap fill" => Kind::Skin,
                "Ironing" => Kind::Ironing,
                "Bridge infill" => Kind::Bridge,
                "Internal infill" => Kind::Infill,
                "Support material" => Kind::Support,
                "Support material interface" => Kind::SupportInterface,
                "Skirt/Brim" => Kind::Brim,
                "Overhang perimeter" => Kind::Overhang,
                other => return Err(format!("unknown type {other}")),
            };
        } else if let Some(z) = note.strip_prefix("Z:") {
            self.layers.last_mut().ok_or("no layer")?.z = number(z)?;
        } else if let Some(height) = note.strip_prefix("HEIGHT:") {
            state.height = number(height)?;
            let layer = self.layers.last_mut().ok_or("no layer")?;
            if layer.height.is_nan() {
                layer.height = state.height;
            }
        } else if let Some(width) = note.strip_prefix("WIDTH:") {
            state.width = number(width)?;
        } else if let Some(patch) = note.strip_prefix("NONPLANAR_START ") {
            state.patch = number(patch)? as u32;
        } else if note == "NONPLANAR_END" {
            state.patch = 0;
        }
        Ok(())
    }

    fn code(&mut self, line: usize, code: &str, state: &mut State) -> Result<(), String> {
        let mut words = code.split_whitespace();
        let Some(command) = words.next() else { return Ok(()) };
        if !matches!(command, "G0" | "G1" | "G2" | "G3" | "G28" | "G92" | "M82" | "M83" | "M73") {
            let known = command.starts_with(['G', 'M', 'T', 'S', 'P', 'B', 'E'])
                || command.chars().all(|c| c.is_ascii_uppercase() || c == '_');
            return if known { Ok(()) } else { Err("no command".to_owned()) };
        }
        let mut values = BTreeMap::new();
        for word in words {
            let (letter, value) = word.split_at(1);
            // `G28 W`: a letter alone.
            if command == "G28" && value.is_empty() {
                continue;
            }
            let plain = value.bytes().all(|b| b.is_ascii_digit() || b == b'.' || b == b'-');
            let value = value.parse::<f64>().ok().filter(|_| plain);
            if values.insert(letter, value.ok_or("bad number")?).is_some() {
                return Err("a word twice".to_owned());
            }
        }
        let axes = ["X", "Y", "Z"];
        match command {
            "M82" => state.relative_e = false,
            "M83" => state.relative_e = true,
            "M73" => self.progress.extend(values.get("P").map(|p| *p as i64)),
            "G28" => state.at = [0.0; 3],
            "G92" => {
                for (axis, name) in axes.iter().enumerate() {
                    state.at[axis] = values.get(name).copied().unwrap_or(state.at[axis]);
                }
                state.e = values.get("E").copied().unwrap_or(state.e);
            }
            _ => {
                let from = state.at;
                for (axis, name) in axes.iter().enumerate() {
                    state.at[axis] = values.get(name).copied().unwrap_or(from[axis]);
                }
                state.feed = values.get("F").copied().unwrap_or(state.feed);
                let e = values
                    .get("E")
                    .map_or(0.0, |&e| if state.relative_e { e } else { e - state.e });
                // Differences of decimals: removes the rounding below the last digit.
                let e = (e * 1e6).round() / 1e6;
                state.e += e;
                let ends = match command {
                    "G0" | "G1" => vec![state.at],
                    _ => {
                        let offset = |letter| values.get(letter).copied().ok_or("no middle");
                        let middle = [from[0] + offset("I")?, from[1] + offset("J")?];
                        arc(from, state.at, middle, command == "G2")?
                    }
                };
                let mut begins = from;
                for &to in &ends {
                    self.moves.push(Move {
                        line,
                        layer: self.layers.len().checked_sub(1),
                        kind: state.kind,
                        from: begins,
                        to,
                        e: e / ends.len() as f64,
                        pulled: state.pulled,
                        feed: state.feed,
                        height: state.height,
                        width: state.width,
                        patch: state.patch,
                    });
                    begins = to;
                }
                if state.kind != Kind::Custom && self.layers.last().is_some() {
                    state.pulled = (state.pulled - e).max(0.0);
                    state.pulled = if state.pulled < 1e-6 { 0.0 } else { state.pulled };
                }
            }
        }
        Ok(())
    }

    /// Moves that lay filament on layers.
    pub(crate) fn beads(&self) -> impl Iterator<Item = &Move> {
        self.moves.iter().filter(|m| m.is_bead())
    }

    /// Beads of one kind.
    pub(crate) fn of(&self, kind: Kind) -> impl Iterator<Item = &Move> {
        self.beads().filter(move |m| m.kind == kind)
    }

    /// Whether a bead is higher than its layer.
    pub(crate) fn is_thick(&self, bead: &Move) -> bool {
        bead.layer.is_some_and(|k| bead.height > 1.5 * self.layers[k].height)
    }

    /// Filament of one kind, thick or not, mm.
    pub(crate) fn filament(&self, kind: Kind, thick: bool) -> f64 {
        self.of(kind).filter(|m| self.is_thick(m) == thick).map(|m| m.e).sum()
    }

    /// Beads that follow each other without a gap, of one kind and layer.
    pub(crate) fn chains(&self, kind: Kind) -> Vec<Vec<Move>> {
        self.chains_of(&[kind])
    }

    /// The same of several kinds.
    pub(crate) fn chains_of(&self, kinds: &[Kind]) -> Vec<Vec<Move>> {
        let mut chains: Vec<Vec<Move>> = Vec::new();
        let mut goes_on = false;
        for m in &self.moves {
            let bead = m.is_bead() && kinds.contains(&m.kind);
            if bead {
                match chains.last_mut().filter(|_| goes_on) {
                    Some(chain) if chain[0].layer == m.layer => chain.push(*m),
                    _ => chains.push(vec![*m]),
                }
            }
            goes_on = bead;
        }
        chains
    }
}
