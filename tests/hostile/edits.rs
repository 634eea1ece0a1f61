//! A sound file + a kind of edit + a place by chance -> the file with that one fault.
//!
//! Words: a *kind* is what is done, such as "infill, a line, half flow"; a *bead* is a move that lays
//! plastic; a *block* is up to twenty beads of one role, one after the other; *the middle* is from the
//! first bead of the layers to the last.
//!
//! 1. [`kinds`] lists all kinds by name: for each role what may happen to its lines, what commands may
//!    stand where they should not, where the nozzle may be sent, and what befalls texts.
//! 2. [`Sound::edit`] makes one edit, at a place that the seed tells; all else stays as it is.
//! 3. [`What::always_counts`] tells of kinds that need no look at the moves: a command changes what all
//!    after it does. Of the others [`Sound::counts`] asks whether they change anything.

use super::common::gcode::{Kind, Move};
use super::slopes::{SLANTS, Slant};
use super::sound::{Chance, SAME, Sound, with_word, word};
use std::collections::BTreeMap;

/// Beads of a block, at most.
const LONGEST_BLOCK: usize = 20;

/// What is done.
#[derive(Debug, Clone, Copy)]
pub(crate) enum What {
    /// To a bead or a block of a role.
    Line(Role, bool, Deed),
    /// To a way without plastic.
    Travel(Deed),
    /// A command stands in the file, at this third of it.
    Command(&'static str, Third),
    /// The nozzle goes there and back.
    Goes(&'static str, Third),
    /// It goes down and across what stands.
    Through,
    /// The same once all is printed.
    ThroughAtTheEnd,
    /// What is primed is primed where the part will be.
    Primed,
    /// Commands for heaters get another number.
    Heat(&'static [&'static str], u32),
    /// All plastic from a layer on, times this.
    Flow(f64),
    /// A move in z gets this feed.
    FeedOfZ(f64),
    /// To a whole layer.
    Layer(Deed),
    /// To skins that follow a slope.
    Skin(Slant),
    /// To the text.
    Text(Slip),
}

/// The roles that a slicer writes, as far as edits tell them apart.
pub(crate) type Role = (&'static str, &'static [Kind]);

/// What befalls lines and layers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Deed {
    /// It is missing: the nozzle goes the same way without plastic.
    Missing,
    /// It is printed again.
    Twice,
    /// It lies 0.4 mm beside, a layer above.
    Shifted,
    Half,
    Double,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Third {
    Start,
    Middle,
    End,
}

/// What befalls a text.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Slip {
    MoveGone,
    RetractionGone,
    PrimingGone,
    PointGone,
    DigitChanged,
    CutOff,
    HomingGone,
}

const ROLES: [Role; 8] = [
    ("outer wall", &[Kind::OuterWall, Kind::Overhang]),
    ("inner wall", &[Kind::InnerWall]),
    ("skin", &[Kind::Skin]),
    ("bridge", &[Kind::Bridge]),
    ("ironing", &[Kind::Ironing]),
    ("infill", &[Kind::Infill]),
    ("support", &[Kind::Support, Kind::SupportInterface]),
    ("brim and skirt", &[Kind::Brim]),
];

const DEEDS: [(&str, Deed); 5] = [
    ("missing", Deed::Missing),
    ("printed twice", Deed::Twice),
    ("0.4 mm beside", Deed::Shifted),
    ("half the plastic", Deed::Half),
    ("twice the plastic", Deed::Double),
];

/// Commands that stand in the middle of a print.
const IN_THE_MIDDLE: [&str; 34] = [
    "G92 X0 Y0",
    "G92 Z5",
    "M206 X10",
    "M206 Z2",
    "M92 X160",
    "M92 E200",
    "M221 S500",
    "M221 S50",
    "M220 S400",
    "M220 S20",
    "G28",
    "G28 X",
    "M84",
    "M18",
    "M0",
    "M112",
    "M600",
    "T5",
    "M104 S150",
    "M104 S0",
    "M140 S0",
    "M302 P1",
    "G20",
    "G91",
    "M83/M82",
    "M290 Z1",
    "M851 Z-1",
    "M201 X90000",
    "M203 X1",
    "M204 S90000",
    "M204 S30",
    "M205 X300",
    "SET_VELOCITY_LIMIT ACCEL=30",
    "G4 S3600",
];

/// All kinds by name.
pub(crate) fn kinds() -> Vec<(String, What)> {
    let mut all = Vec::new();
    for role in ROLES {
        for (many, of) in [(false, "a line"), (true, "a block")] {
            for (name, deed) in DEEDS {
                all.push((format!("{}, {of}: {name}", role.0), What::Line(role, many, deed)));
            }
        }
    }
    all.push(("a travel: missing".into(), What::Travel(Deed::Missing)));
    all.push(("a travel: its end 0.4 mm beside".into(), What::Travel(Deed::Shifted)));
    let thirds = [(Third::Start, "start"), (Third::Middle, "middle"), (Third::End, "end")];
    for (third, name) in thirds {
        for to in ["Y900", "X-500", "Z-3", "Z-30", "X900000000"] {
            all.push((format!("`G0 {to}` and back, in the {name}"), What::Goes(to, third)));
        }
    }
    all.push(("down and through the part, and up again".into(), What::Through));
    all.push(("across the part after the print".into(), What::ThroughAtTheEnd));
    all.push(("the start's line lies where the part does".into(), What::Primed));
    for code in IN_THE_MIDDLE {
        let third = Third::Middle;
        all.push((format!("`{code}` in the middle"), What::Command(code, third)));
    }
    all.push(("`M104 S300` in the end".into(), What::Command("M104 S300", Third::End)));
    for celsius in [0, 20, 500] {
        let name = format!("temperature {celsius} °C");
        all.push((name, What::Heat(&["M104", "M109"], celsius)));
    }
    all.push(("bed 200 °C".into(), What::Heat(&["M140", "M190"], 200)));
    all.push(("5 times the plastic from a layer on".into(), What::Flow(5.0)));
    all.push(("a move in z at F60000".into(), What::FeedOfZ(60_000.0)));
    all.push(("a layer: missing".into(), What::Layer(Deed::Missing)));
    all.push(("a layer: printed twice".into(), What::Layer(Deed::Twice)));
    all.push(("a layer: 0.4 mm higher".into(), What::Layer(Deed::Shifted)));
    all.push(("a layer: half the plastic".into(), What::Layer(Deed::Half)));
    all.push(("a layer: twice the plastic".into(), What::Layer(Deed::Double)));
    for (name, slant, _) in SLANTS {
        all.push((format!("non-planar skin, {name}"), What::Skin(slant)));
    }
    for (name, slip) in [
        ("a move's text is gone", Slip::MoveGone),
        ("a retraction is gone", Slip::RetractionGone),
        ("a priming after a retraction is gone", Slip::PrimingGone),
        ("a decimal point is gone", Slip::PointGone),
        ("a digit is another", Slip::DigitChanged),
        ("the file ends in the middle", Slip::CutOff),
        ("`G28` is gone", Slip::HomingGone),
    ] {
        all.push((name.into(), What::Text(slip)));
    }
    all
}

impl Sound {
    /// The file after an edit; `None` if it has nothing to edit so.
    pub(crate) fn edit(&self, what: &What, chance: &mut Chance) -> Option<String> {
        match *what {
            What::Line(role, many, deed) => self.line(role.1, many, deed, chance),
            What::Travel(deed) => self.travel(deed, chance),
            What::Command(code, third) => self.command(code, third, chance),
            What::Goes(to, third) => {
                let line = self.line_in(third, chance)?;
                let [x, y, z] = self.at(line);
                let back = format!("G0 X{x:.3} Y{y:.3}\nG0 Z{z:.3}");
                Some(self.inserted(line, &format!("G0 {to}\n{back}\n")))
            }
            What::Through => self.through(chance),
            What::ThroughAtTheEnd => {
                let line = self.line_in(Third::End, chance)?;
                let z = chance.between(0.1, self.extent[1][2] - 0.5);
                Some(self.inserted(line, &format!("G0 Z{z:.3}\n{}", self.across(chance))))
            }
            What::Primed => Some(self.primed(chance)),
            What::Heat(codes, celsius) => Some(self.heat(codes, celsius)),
            What::Flow(factor) => {
                let first = chance.below(self.print.layers.len() - 1);
                self.flow(factor, |m| m.layer.is_some_and(|layer| layer >= first))
            }
            What::FeedOfZ(feed) => {
                let rises = |&k: &usize| self.print.moves[k].from[2] != self.print.moves[k].to[2];
                let all: Vec<usize> = (0..self.print.moves.len()).filter(rises).collect();
                let k = chance.pick(&all)?;
                Some(self.rewritten(&BTreeMap::from([(k, Move { feed, ..self.print.moves[k] })])))
            }
            What::Layer(deed) => self.layer(deed, chance),
            What::Skin(slant) => self.slant(slant, chance),
            What::Text(slip) => self.slip(slip, chance),
        }
    }
}

/// Lines, travels and layers.
impl Sound {
    /// A bead of these kinds and, if `many`, those that follow it without a break.
    fn beads(&self, kinds: &[Kind], many: bool, chance: &mut Chance) -> Option<Vec<usize>> {
        let moves = &self.print.moves;
        let is_one =
            |k: usize| moves.get(k).is_some_and(|m| m.is_bead() && kinds.contains(&m.kind));
        let all: Vec<usize> =
            self.beads.iter().copied().filter(|&k| is_one(k) && moves[k].length() > SAME).collect();
        let first = chance.pick(&all)?;
        let most = if many { 2 + chance.below(LONGEST_BLOCK - 1) } else { 1 };
        Some((first..).take(most).take_while(|&k| is_one(k)).collect())
    }

    fn line(&self, kinds: &[Kind], many: bool, deed: Deed, chance: &mut Chance) -> Option<String> {
        let beads = self.beads(kinds, many, chance)?;
        if deed == Deed::Twice {
            return Some(self.again(&beads));
        }
        let by = chance.shift();
        let mut changed = BTreeMap::new();
        for &k in &beads {
            let mut new = self.print.moves[k];
            match deed {
                Deed::Missing => new.e = 0.0,
                Deed::Half => new.e /= 2.0,
                Deed::Double => new.e *= 2.0,
                _ => (new.to[0], new.to[1]) = (new.to[0] + by[0], new.to[1] + by[1]),
            }
            changed.insert(k, new);
        }
        // Where it begins moves, too.
        if let (Deed::Shifted, Some(k)) = (deed, beads[0].checked_sub(1)) {
            let mut new = self.print.moves[k];
            (new.to[0], new.to[1]) = (new.to[0] + by[0], new.to[1] + by[1]);
            changed.insert(k, new);
        }
        Some(self.rewritten(&changed))
    }

    /// These beads once more, from where they began.
    fn again(&self, beads: &[usize]) -> String {
        let moves = &self.print.moves;
        let (first, last) = (moves[beads[0]], moves[beads[beads.len() - 1]]);
        let mut text = format!("G0 X{:.3} Y{:.3}\n", first.from[0], first.from[1]);
        if !self.relative {
            let after = word(&self.lines[first.line - 1], 'E').unwrap_or(0.0);
            text += &format!("G92 E{:.5}\n", after - first.e);
        }
        for line in &self.lines[first.line - 1..last.line] {
            text += &format!("{line}\n");
        }
        self.inserted(last.line, &text)
    }

    fn travel(&self, deed: Deed, chance: &mut Chance) -> Option<String> {
        let moves = &self.print.moves;
        let all: Vec<usize> = (0..moves.len()).filter(|&k| moves[k].is_travel()).collect();
        let k = chance.pick(&all)?;
        if deed == Deed::Missing {
            return Some(self.without(&[moves[k].line]));
        }
        let (mut new, by) = (moves[k], chance.shift());
        (new.to[0], new.to[1]) = (new.to[0] + by[0], new.to[1] + by[1]);
        Some(self.rewritten(&BTreeMap::from([(k, new)])))
    }

    fn flow(&self, factor: f64, of: impl Fn(&Move) -> bool) -> Option<String> {
        let beads = self.beads.iter().map(|&k| (k, self.print.moves[k])).filter(|(_, m)| of(m));
        let new = beads.map(|(k, m)| (k, Move { e: m.e * factor, ..m }));
        let changed: BTreeMap<usize, Move> = new.collect();
        (!changed.is_empty()).then(|| self.rewritten(&changed))
    }

    fn layer(&self, deed: Deed, chance: &mut Chance) -> Option<String> {
        let layer = chance.below(self.print.layers.len());
        match deed {
            Deed::Half => return self.flow(0.5, |m| m.layer == Some(layer)),
            Deed::Double => return self.flow(2.0, |m| m.layer == Some(layer)),
            _ => {}
        }
        let marks: Vec<usize> =
            (0..self.lines.len()).filter(|&k| self.lines[k] == ";LAYER_CHANGE").collect();
        let last = self.print.moves[*self.beads.last()?].line;
        let (from, to) = (marks[layer], marks.get(layer + 1).map_or(last, |next| *next));
        let mut lines = self.lines.clone();
        let set_e = |line: usize| match self.e_before(line) {
            Some(e) if !self.relative => format!("G92 E{e:.5}\n"),
            _ => String::new(),
        };
        match deed {
            Deed::Missing => {
                lines.splice(from..to, [set_e(to)]);
            }
            Deed::Twice => {
                let again = set_e(from) + &lines[from..to].join("\n");
                lines.insert(to, again);
            }
            _ => {
                for line in &mut lines[from..to] {
                    if let Some(z) = word(line, 'Z').filter(|_| line.starts_with('G')) {
                        *line = with_word(line, 'Z', &format!("{:.3}", z + 0.4));
                    }
                }
            }
        }
        Some(lines.join("\n") + "\n")
    }
}

/// Commands, ways, heat.
impl Sound {
    fn command(&self, code: &str, third: Third, chance: &mut Chance) -> Option<String> {
        let line = self.line_in(third, chance)?;
        let code = match (code, self.relative) {
            ("M83/M82", true) => "M82",
            ("M83/M82", false) => "M83",
            _ => code,
        };
        Some(self.inserted(line, &format!("{code}\n")))
    }

    /// A line before which something may be put in: of the start after homing, of a bead that is not
    /// one of the last ten, or of what comes after all beads.
    fn line_in(&self, third: Third, chance: &mut Chance) -> Option<usize> {
        let first = self.print.moves[*self.beads.first()?].line;
        let last = self.print.moves[*self.beads.last()?].line;
        let homed = self.lines.iter().position(|line| line.starts_with("G28"))? + 2;
        let is_code = |line: usize| self.lines[line - 1].starts_with(['G', 'M']);
        let lines: Vec<usize> = match third {
            Third::Start => {
                let marked = self.lines.iter().position(|line| line == ";LAYER_CHANGE")?;
                (homed..marked.min(first)).filter(|&line| is_code(line)).collect()
            }
            Third::Middle => {
                let some = &self.beads[..self.beads.len().saturating_sub(10)];
                some.iter().map(|&k| self.print.moves[k].line).collect()
            }
            Third::End => {
                let end = (last + 1..=self.lines.len())
                    .take_while(|&line| !self.lines[line - 1].starts_with("; settings"));
                end.filter(|&line| is_code(line)).collect()
            }
        };
        Some(chance.pick(&lines)? - 1)
    }

    /// Where the nozzle is before a line (from 0) of the file.
    fn at(&self, line: usize) -> [f64; 3] {
        let before = self.print.moves.partition_point(|m| m.line <= line);
        before.checked_sub(1).map_or([0.0; 3], |k| self.print.moves[k].to)
    }

    /// What E counts before a line (from 0).
    fn e_before(&self, line: usize) -> Option<f64> {
        let lines = self.lines[..line].iter().rev();
        let mut told = lines.filter(|line| line.starts_with('G'));
        told.find_map(|line| word(line, 'E'))
    }

    /// A way over the middle of the part from one of its sides to the other.
    fn across(&self, chance: &mut Chance) -> String {
        let [low, high] = self.extent;
        let y = chance.between(low[1] + 2.0, high[1] - 2.0);
        format!("G0 X{:.3} Y{y:.3}\nG0 X{:.3}\n", low[0] - 2.0, high[0] + 2.0)
    }

    fn through(&self, chance: &mut Chance) -> Option<String> {
        let moves = &self.print.moves;
        let half = self.print.layers.len() / 2;
        let high = |&k: &usize| moves[k].layer.is_some_and(|layer| layer > half);
        let all: Vec<usize> = self.beads.iter().copied().filter(high).collect();
        let line = moves[chance.pick(&all)?].line - 1;
        let [x, y, z] = self.at(line);
        let low = chance.between(0.2, z - 0.5);
        let back = format!("G0 Z{z:.3}\nG0 X{x:.3} Y{y:.3}\n");
        Some(self.inserted(line, &format!("G0 Z{low:.3}\n{}{back}", self.across(chance))))
    }

    /// The start's moves sideways lie over the first layer.
    fn primed(&self, chance: &mut Chance) -> String {
        let first = |k: &&usize| self.print.moves[**k].layer == Some(0);
        let on_bed = self.beads.iter().take_while(first).map(|&k| self.print.moves[k].to);
        let on_bed: Vec<[f64; 3]> = on_bed.collect();
        let to = on_bed[chance.below(on_bed.len())];
        let start = self.print.moves.iter().enumerate().filter(|(_, m)| m.layer.is_none());
        let primes = start.clone().find(|(_, m)| m.e > 0.0 && m.length() > 0.0);
        let Some((_, prime)) = primes else { return self.lines.join("\n") };
        let by = [0, 1].map(|axis| to[axis] - prime.from[axis]);
        let moved = |m: &Move| {
            let mut new = *m;
            (new.to[0], new.to[1]) = (m.to[0] + by[0], m.to[1] + by[1]);
            new
        };
        let sideways = start.filter(|(_, m)| m.to[0] != 0.0 || m.to[1] != 0.0);
        self.rewritten(&sideways.map(|(k, m)| (k, moved(m))).collect())
    }

    fn heat(&self, codes: &[&str], celsius: u32) -> String {
        let change = |line: &String| {
            let is_one = codes.iter().any(|code| line.split(' ').next() == Some(code));
            let heats = is_one && word(line, 'S').is_some_and(|s| s > 0.0);
            if heats { with_word(line, 'S', &celsius.to_string()) } else { line.clone() }
        };
        self.lines.iter().map(change).collect::<Vec<_>>().join("\n") + "\n"
    }
}

/// Texts.
impl Sound {
    fn slip(&self, slip: Slip, chance: &mut Chance) -> Option<String> {
        let (moves, lines) = (&self.print.moves, &self.lines);
        let printed = moves.iter().filter(|m| m.layer.is_some() && m.kind != Kind::Custom);
        let of = |fits: fn(&Move) -> bool| -> Vec<usize> {
            printed.clone().filter(|m| fits(m)).map(|m| m.line).collect()
        };
        let line = match slip {
            Slip::HomingGone => lines.iter().position(|line| line.starts_with("G28"))? + 1,
            Slip::RetractionGone => chance.pick(&of(|m| m.e < 0.0))?,
            Slip::PrimingGone => chance.pick(&of(|m| m.e > 0.0 && m.length() == 0.0))?,
            _ => chance.pick(&of(|_| true))?,
        };
        let code = &lines[line - 1];
        let changed = match slip {
            Slip::CutOff => return Some(lines[..line].join("\n") + "\n"),
            Slip::PointGone => {
                let points: Vec<usize> = code.match_indices('.').map(|(at, _)| at).collect();
                let at = chance.pick(&points)?;
                format!("{}{}", &code[..at], &code[at + 1..])
            }
            Slip::DigitChanged => {
                // Not of the command, and none of F.
                let end = code.find(" F").unwrap_or(code.len());
                let is_digit = |&at: &usize| code.as_bytes()[at].is_ascii_digit();
                let digits: Vec<usize> = (3..end).filter(is_digit).collect();
                let at = chance.pick(&digits)?;
                format!("{}{}{}", &code[..at], chance.below(10), &code[at + 1..])
            }
            _ => return Some(self.without(&[line])),
        };
        let mut lines = lines.clone();
        lines[line - 1] = changed;
        Some(lines.join("\n") + "\n")
    }
}

impl What {
    /// Whether every edit of the kind counts.
    pub(crate) fn always_counts(&self) -> bool {
        !matches!(
            self,
            Self::Line(..) | Self::Travel(_) | Self::Primed | Self::Layer(_) | Self::Text(_)
        ) || matches!(self, Self::Text(Slip::CutOff | Slip::HomingGone))
    }
}
