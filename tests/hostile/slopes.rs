//! A sound file with non-planar skins + a fault of theirs -> the file with that fault; and by which codes `check` sees it.
//!
//! Words: a *stroke* is beads of a patch one after the other in about one direction; the *block* of a patch
//! is the file's lines from its first mark to its last.
//!
//! 1. [`SLANTS`] lists what may befall skins, by name, and the codes of which one has to be found.
//! 2. [`Sound::slant`] does it at a place that the seed tells.
//! 3. The part is two ramps, of 15 and 8 degrees, and a tower beside the first that stands higher: so skins
//!    that are printed late are in reach of what stands.
//!
//! Blocks are moved in files that count E relatively: each is whole in itself, but for words and comments in
//! force, which are told again where lines are cut.

use super::common::gcode::Move;
use super::common::relief::Relief;
use super::common::{self, Solid};
use super::sound::{Chance, Sound, word};
use super::witness::{is_new, judge, read};
use slicer::check::Verdict;
use slicer::check::finding::Code;
use std::ops::Range;

/// What befalls skins.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Slant {
    /// A stroke of the last skin lies so much higher, mm.
    Lifted(f64),
    /// So many strokes of the last skin one after the other are missing.
    Missing(usize),
    /// So many times the plastic of a stroke, or of the whole patch.
    Flow(f64, bool),
    /// A travel at this part of its height.
    Low(f64),
    /// A travel goes aside before it goes up.
    AsideFirst,
    /// The patch is printed so many layers later; less than 0: earlier.
    Later(i32),
    EndGone,
    NumberTwice,
    /// A steep stroke so many times as fast as z is.
    TooSteep(f64),
    /// The patch lies so much further along x, mm.
    Beside(f64),
}

/// All of them, each with its name, and the codes by one of which it is found.
pub(crate) const SLANTS: [(&str, Slant, &[Code]); 17] = [
    ("a line 1 mm higher", Slant::Lifted(1.0), &[Code::InTheAir]),
    ("a line 0.3 mm higher", Slant::Lifted(0.3), &[Code::InTheAir]),
    ("a line 0.3 mm lower", Slant::Lifted(-0.3), &[Code::FallingZ]),
    ("a line missing", Slant::Missing(1), &[Code::UncoveredSkin]),
    ("five lines missing", Slant::Missing(5), &[Code::UncoveredSkin]),
    ("a line: twice the plastic", Slant::Flow(2.0, false), &[Code::OddBead]),
    ("a line: half the plastic", Slant::Flow(0.5, false), &[Code::OddBead]),
    ("all: twice the plastic", Slant::Flow(2.0, true), &[Code::DoubleSkin]),
    ("all: half the plastic", Slant::Flow(0.5, true), &[Code::Underfilled, Code::UncoveredSkin]),
    ("a travel at 40 % of the height", Slant::Low(0.4), &[Code::HeadHits]),
    ("a travel goes aside before it goes up", Slant::AsideFirst, &[Code::HeadHits]),
    ("printed two layers too early", Slant::Later(-2), &[Code::FallingZ, Code::InTheAir]),
    ("printed after higher layers", Slant::Later(20), &[Code::HeadHits]),
    ("its last mark is gone", Slant::EndGone, &[Code::WrongMarks]),
    ("its number comes twice", Slant::NumberTwice, &[Code::WrongMarks]),
    ("a steep line too fast for z", Slant::TooSteep(2.0), &[Code::TooFast]),
    ("0.5 mm further along x", Slant::Beside(0.5), &[Code::OutsidePart, Code::OpenSurface]),
];

/// Least length of a stroke, mm.
const LONG: f64 = 3.0;

/// Cosine of the angle that parts strokes.
const CORNER: f64 = 0.8;

impl Sound {
    /// The file after a fault; `None` if it has nothing that it may befall.
    pub(crate) fn slant(&self, slant: Slant, chance: &mut Chance) -> Option<String> {
        let blocks = self.blocks();
        let (number, block) = match slant {
            Slant::Later(_) => self.steepest(blocks.clone())?,
            _ => blocks.get(chance.below(blocks.len()))?.clone(),
        };
        match slant {
            Slant::Lifted(by) => self.lifted(number, by, chance),
            Slant::Missing(count) => self.missing(number, count, chance),
            Slant::Flow(times, is_all) => {
                let of = if is_all { self.skin(number) } else { self.stroke(number, chance)? };
                self.changed(of, |m| Move { e: m.e * times, ..*m })
            }
            Slant::Low(part) => self.low(number, part, chance),
            Slant::AsideFirst => self.aside_first(number, chance),
            Slant::Later(layers) => self.later(block, layers),
            Slant::EndGone => Some(self.without(&[block.end])),
            Slant::NumberTwice => {
                let (other, own) = (blocks.iter().find(|one| one.0 != number)?, block.start);
                let mut lines = self.lines.clone();
                lines[own] = format!(";NONPLANAR_START {}", other.0);
                Some(lines.join("\n") + "\n")
            }
            Slant::TooSteep(times) => {
                let most = 60.0 * times * SPEED_OF_Z;
                let stroke = self.stroke(number, chance)?;
                let steep: Vec<usize> =
                    stroke.into_iter().filter(|&k| sine(&self.print.moves[k]) > 0.1).collect();
                let fast = |m: &Move| Move { feed: most / sine(m), ..*m };
                (!steep.is_empty()).then(|| self.changed(steep, fast))?
            }
            Slant::Beside(by) => self.beside(block, by),
        }
    }

    /// The patches by their numbers, and the lines of each, from 0, its last mark included.
    fn blocks(&self) -> Vec<(u32, Range<usize>)> {
        let mut blocks = Vec::new();
        for (k, line) in self.lines.iter().enumerate() {
            let Some(number) = line.strip_prefix(";NONPLANAR_START ") else { continue };
            let end = self.lines[k..].iter().position(|line| line == ";NONPLANAR_END").unwrap();
            blocks.push((number.parse().unwrap(), k..k + end + 1));
        }
        blocks
    }

    /// The patch with the steepest line: the tower stands beside it.
    fn steepest(&self, blocks: Vec<(u32, Range<usize>)>) -> Option<(u32, Range<usize>)> {
        let steep = |number: u32| {
            let all = self.skin(number).into_iter().map(|k| sine(&self.print.moves[k]));
            all.fold(0.0, f64::max)
        };
        blocks.into_iter().max_by(|a, b| steep(a.0).total_cmp(&steep(b.0)))
    }

    /// The beads of a patch.
    fn skin(&self, number: u32) -> Vec<usize> {
        let is_own = |k: &usize| self.print.moves[*k].patch == number;
        self.beads.iter().copied().filter(is_own).collect()
    }

    /// The long strokes of a patch.
    fn strokes(&self, number: u32) -> Vec<Vec<usize>> {
        let moves = &self.print.moves;
        let mut strokes: Vec<Vec<usize>> = Vec::new();
        for k in self.skin(number) {
            let own = along(&moves[k]);
            match strokes.last_mut() {
                Some(last)
                    if last[last.len() - 1] + 1 == k && {
                        let before = along(&moves[k - 1]);
                        own[0] * before[0] + own[1] * before[1] > CORNER
                    } =>
                {
                    last.push(k);
                }
                _ => strokes.push(vec![k]),
            }
        }
        let length = |stroke: &[usize]| stroke.iter().map(|&k| moves[k].length()).sum::<f64>();
        strokes.into_iter().filter(|stroke| length(stroke) >= LONG).collect()
    }

    fn stroke(&self, number: u32, chance: &mut Chance) -> Option<Vec<usize>> {
        let strokes = self.strokes(number);
        (!strokes.is_empty()).then(|| strokes[chance.below(strokes.len())].clone())
    }

    fn changed(&self, of: Vec<usize>, change: impl Fn(&Move) -> Move) -> Option<String> {
        let new = of.into_iter().map(|k| (k, change(&self.print.moves[k]))).collect();
        Some(self.rewritten(&new))
    }

    fn lifted(&self, number: u32, by: f64, chance: &mut Chance) -> Option<String> {
        // Of the last skin: a first one may have much room below where its base has a tread.
        let strokes = self.strokes(number);
        let last = strokes.get(strokes.len() * 3 / 5..)?;
        let mut of = last.get(chance.below(last.len()))?.clone();
        // Where it begins as well.
        of.insert(0, of[0] - 1);
        self.changed(of, |m| Move { to: [m.to[0], m.to[1], m.to[2] + by], ..*m })
    }

    fn missing(&self, number: u32, count: usize, chance: &mut Chance) -> Option<String> {
        let strokes = self.strokes(number);
        // The last skin, but for its edges.
        let first = strokes.len() * 3 / 5;
        let room = strokes.len().checked_sub(first + count + 1)?;
        let of = first + chance.below(room.max(1));
        let (from, to) = (strokes[of][0], *strokes[of + count - 1].last()?);
        self.changed((from..=to).collect(), |m| Move { e: m.e.min(0.0), ..*m })
    }

    /// A bead of a patch, by its place in the moves.
    fn bead(&self, number: u32, chance: &mut Chance) -> Option<usize> {
        chance.pick(&self.skin(number)[1..])
    }

    fn low(&self, number: u32, part: f64, chance: &mut Chance) -> Option<String> {
        let m = self.print.moves[self.bead(number, chance)?];
        let ([x, y, z], to) = (m.from, m.to);
        let low = part * z;
        let text = format!(
            "G0 Z{low:.3}\nG0 X{:.3} Y{:.3}\nG0 Z{:.3}\nG0 X{x:.3} Y{y:.3}\nG0 Z{z:.3}\n",
            to[0],
            to[1],
            z + 5.0
        );
        Some(self.inserted(m.line - 1, &text))
    }

    fn aside_first(&self, number: u32, chance: &mut Chance) -> Option<String> {
        let m = self.print.moves[self.bead(number, chance)?];
        let [x, y, z] = m.from;
        let higher = |&k: &usize| self.print.moves[k].to[2] > z + 0.5;
        let before = |&k: &usize| self.print.moves[k].line < m.line;
        let all: Vec<usize> = self.skin(number).into_iter().filter(higher).filter(before).collect();
        let to = self.print.moves[chance.pick(&all)?].to;
        let text = format!(
            "G0 X{:.3} Y{:.3}\nG0 Z{:.3}\nG0 X{x:.3} Y{y:.3}\nG0 Z{z:.3}\n",
            to[0],
            to[1],
            to[2] + 5.0
        );
        Some(self.inserted(m.line - 1, &text))
    }

    /// The words and comments in force before a line (from 0), told anew: the nozzle goes there from above.
    fn state(&self, line: usize) -> String {
        let before = self.print.moves.partition_point(|m| m.line <= line);
        let m = self.print.moves[before - 1];
        let told = |mark: &str| {
            let of = self.lines[..line].iter().rev().find(|line| line.starts_with(mark));
            of.map_or(String::new(), |line| format!("{line}\n"))
        };
        let marks = [";TYPE:", ";WIDTH:", ";HEIGHT:"].map(told).concat();
        let [x, y, z] = m.to;
        let high = self.extent[1][2] + 5.0;
        let [lift, travel] = ["F600", "F6000"];
        format!(
            "G0 Z{high:.3} {lift}\nG0 X{x:.3} Y{y:.3} {travel}\nG0 Z{z:.3} {lift}\n{marks}G1 F{:.3}\n",
            m.feed
        )
    }

    fn later(&self, block: Range<usize>, layers: i32) -> Option<String> {
        let marks: Vec<usize> =
            (0..self.lines.len()).filter(|&k| self.lines[k] == ";LAYER_CHANGE").collect();
        let home = marks.partition_point(|mark| *mark < block.start) as i32 - 1;
        // Before the layer that it is printed after, or after some more.
        let next = if layers < 0 { home + layers + 1 } else { home + 1 + layers };
        let to = *marks.get(usize::try_from(next).ok()?)?;
        let text = |range: Range<usize>| self.lines[range].join("\n") + "\n";
        let own = text(block.clone()) + &self.state(to);
        let rest = self.state(block.end);
        let all = self.lines.len();
        Some(if to < block.start {
            [text(0..to), own, text(to..block.start), rest, text(block.end..all)].concat()
        } else {
            let between = text(block.end..to);
            [text(0..block.start), rest, between, own, text(to..all)].concat()
        })
    }

    fn beside(&self, block: Range<usize>, by: f64) -> Option<String> {
        let mut lines = self.lines.clone();
        for line in &mut lines[block.clone()] {
            if let Some(x) = word(line, 'X').filter(|_| line.starts_with('G')) {
                *line = super::sound::with_word(line, 'X', &format!("{:.3}", x + by));
            }
        }
        lines.insert(block.end, self.state(block.end));
        Some(lines.join("\n") + "\n")
    }
}

/// Of the profile, mm/s.
const SPEED_OF_Z: f64 = 16.667;

fn along(m: &Move) -> [f64; 2] {
    [0, 1].map(|axis| (m.to[axis] - m.from[axis]) / m.length())
}

/// Part of a bead's way that is up or down.
fn sine(m: &Move) -> f64 {
    let rise = m.to[2] - m.from[2];
    (rise / m.length().hypot(rise)).abs()
}

/// See the head of this file.
pub(crate) fn part() -> Solid {
    let steep = Relief { sides: [16.0, 12.0], surface: |x, _| 2.0 + 0.268 * x, squares: [1, 1] };
    let gentle = Relief { sides: [12.0, 8.0], surface: |x, _| 2.0 + 0.14 * x, squares: [1, 1] };
    let tower = Solid::cuboid([18.0, 2.0, 0.0], [23.0, 10.0, 11.6]);
    steep.solid().and(&tower).and(&gentle.solid().shifted([0.0, 16.0, 0.0]))
}

/// Settings of the sound file.
pub(crate) const SET: [(&str, &str); 5] = [
    ("machine.thumbnails", "[]"),
    ("machine.relative_e", "true"),
    ("nonplanar.enabled", "true"),
    ("head.name", "long-0.6"),
    ("nonplanar.directions", "auto"),
];

#[test]
fn every_fault_of_skins_has_its_code() {
    let settings = common::shipped("generic-marlin", &SET);
    let run = common::slice_with(&part().stl(), settings.clone(), &common::as_it_is());
    let bed = slicer::bed(&settings.machine);
    let model = slicer::Model::bytes("ramps.stl", part().stl());
    let placed = slicer::place(&[model], &common::as_it_is(), &bed, &Default::default()).unwrap();
    let judged = |text: &str| judge(&read(text), &settings, Some(&placed));
    let good = judged(&run.text);
    assert_eq!(good.findings, [], "{}", common::damage::listed(&good));
    let sound = Sound::new(&run.text);
    assert_eq!(sound.blocks().len(), 2);
    let mut unseen = Vec::new();
    for (name, slant, codes) in SLANTS {
        let (mut seen, mut tried) = (0, 0);
        for seed in 0..12 {
            let Some(text) = sound.slant(slant, &mut Chance(seed)) else { continue };
            let verdict = judged(&text);
            tried += 1;
            let is_one =
                |verdict: &Verdict| verdict.counts.iter().any(|one| codes.contains(&one.code));
            if is_new(&verdict, &good) && is_one(&verdict) {
                seen += 1;
            } else {
                unseen.push((name, seed, common::damage::listed(&verdict)));
            }
            if tried == 2 {
                break;
            }
        }
        println!("{name}: {seen} of {tried}");
        assert!(tried > 0, "{name}");
    }
    assert!(unseen.is_empty(), "{unseen:#?}");
}
