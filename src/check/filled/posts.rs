//! Filled -> findings of support that is too high for its width.
//!
//! Words used here: an *island* is support of a layer that touches; it stands on the islands below that
//! it overlaps. A *post* is islands one on another that are about as thick; where one is twice as
//! thick or half as thick, a new post begins: cross lines that tie posts together brace them. The
//! *thickness* of an island is the side of the square that resists bending as it does in its weakest
//! direction, √12 times its least radius of gyration: of a straight line its width, of a zigzag or an
//! outline about the side of the field. The *slenderness* of a post is its height over its thickness.

use super::Filled;
use crate::check::capsule::Capsule;
use crate::check::finding::{Code, Finding, Findings, Place, short};
use crate::check::rows::Lattice;
use crate::check::survey::Survey;
use crate::geom::sets::Sets;
use crate::geom::spans::{Rows, Span};
use crate::reader::{Facts, Role};
use crate::units::to_mm;

/// The most slender post that stands while the nozzle pushes it.
const MOST: f64 = 10.0;

/// An island this many times as thick as the post below braces it, or begins another.
const OTHER: f64 = 2.0;

/// Distance of rows, mm, a quarter of a line, and rows of a layer at most.
const PITCH: f64 = 0.1;
const MOST_ROWS: f64 = 6000.0;

/// Support of a layer that touches.
#[derive(Debug, Clone, Copy, Default)]
struct Island {
    /// Sums of area, of x, y, xx, xy and yy over it, from its first span, mm.
    sums: [f64; 6],
    origin: [f64; 2],
    /// Height and thickness of its post up to here, mm.
    height: f64,
    thick: f64,
    goes_on: bool,
}

/// The support of a layer.
#[derive(Debug, Default)]
pub(crate) struct Drawn {
    islands: Vec<Island>,
    rows: Rows,
    /// The island of each span.
    of_span: Vec<usize>,
}

/// Posts as far as they are known.
pub(crate) struct Posts {
    lattice: Lattice,
    below: Drawn,
}

impl Posts {
    /// Of all support of a print, if it has any.
    pub(crate) fn over(survey: &Survey) -> Option<Self> {
        let (low, high) = survey.support?;
        let lattice = Lattice::new(PITCH, high[1] - low[1], MOST_ROWS);
        Some(Self { lattice, below: Drawn::default() })
    }

    /// The islands of a layer.
    pub(crate) fn drawn(&self, filled: &Filled<'_>, layer: usize) -> Drawn {
        let lines = filled.lines(layer).filter(|(step, _)| step.role == Role::Support);
        let rows = self.lattice.draw(lines.map(|(step, _)| Capsule::of(step, 1.0)));
        let (islands, of_span) = islands(&rows, self.lattice);
        Drawn { islands, rows, of_span }
    }

    /// Lays the next layer on those before.
    pub(crate) fn layer(
        &mut self,
        (filled, layer): (&Filled<'_>, usize),
        mut drawn: Drawn,
        found: &mut Findings,
    ) {
        let below = &mut self.below;
        let on = overlaps((&drawn.rows, &drawn.of_span), (&below.rows, &below.of_span));
        for (k, island) in drawn.islands.iter_mut().enumerate() {
            let mut stands_on = on.iter().filter(|(above, _)| *above == k).map(|(_, under)| *under);
            island.grow(filled.height(layer), &mut stands_on, &mut below.islands);
        }
        if let Some(before) = layer.checked_sub(1) {
            report(filled.window.facts, before, &below.islands, found);
        }
        self.below = drawn;
    }

    /// Ends the print.
    pub(crate) fn finish(self, facts: &Facts, found: &mut Findings) {
        if let Some(last) = facts.layers.len().checked_sub(1) {
            report(facts, last, &self.below.islands, found);
        }
    }
}

/// Reports posts that end on a layer.
fn report(facts: &Facts, layer: usize, islands: &[Island], found: &mut Findings) {
    for island in islands.iter().filter(|island| !island.goes_on) {
        let slender = island.height / island.thick;
        if slender > MOST {
            let (height, thick) = (short(island.height), short(island.thick));
            let text = format!("support is {height} mm high where it is {thick} mm thick");
            let finding = Finding::warning(Code::SlenderSupport, slender, "times", text);
            found.add(finding.at(Place {
                line: None,
                layer: Some(layer + 1),
                z_mm: Some(short(facts.layers[layer].z)),
                at_mm: Some(island.middle().map(short)),
            }));
        }
    }
}

impl Island {
    /// Adds a span of a row in the middle of `y`, mm.
    fn add(&mut self, span: Span, (y, pitch): (f64, f64)) {
        let (from, to) = (to_mm(span.start) - self.origin[0], to_mm(span.end) - self.origin[0]);
        let (x, y, length) = (0.5 * (from + to), y - self.origin[1], to - from);
        let area = length * pitch;
        let own = [length * length / 12.0, pitch * pitch / 12.0];
        let more = [1.0, x, y, x * x + own[0], x * y, y * y + own[1]];
        self.sums.iter_mut().zip(more).for_each(|(sum, more)| *sum += area * more);
    }

    fn middle(&self) -> [f64; 2] {
        let [area, x, y, ..] = self.sums;
        [self.origin[0] + x / area, self.origin[1] + y / area]
    }

    /// See the words of this file.
    fn own_thickness(&self) -> f64 {
        let [area, x, y, xx, xy, yy] = self.sums;
        let (x, y) = (x / area, y / area);
        let (a, b, c) = (xx / area - x * x, xy / area - x * y, yy / area - y * y);
        let least = 0.5 * (a + c - ((a - c) * (a - c) + 4.0 * b * b).sqrt());
        (12.0 * least.max(0.0)).sqrt()
    }

    /// Stands on islands of the layer below.
    fn grow(
        &mut self,
        height: f64,
        stands_on: &mut dyn Iterator<Item = usize>,
        below: &mut [Self],
    ) {
        let own = self.own_thickness().max(PITCH);
        (self.height, self.thick) = (height, own);
        for under in stands_on {
            let post = &mut below[under];
            if own > OTHER * post.thick || own * OTHER < post.thick {
                continue;
            }
            post.goes_on = true;
            if post.height + height > self.height {
                self.height = post.height + height;
            }
            self.thick = self.thick.max(post.thick);
        }
    }
}

/// The islands of a layer, and the island of each span.
fn islands(rows: &Rows, lattice: Lattice) -> (Vec<Island>, Vec<usize>) {
    let mut sets = Sets::default();
    let mut above: Vec<(Span, usize)> = Vec::new();
    for (_, row) in rows.iter() {
        let mut here = Vec::with_capacity(row.len());
        for &span in row {
            let one = sets.add();
            for (_, other) in
                above.iter().filter(|(other, _)| other.start <= span.end && span.start <= other.end)
            {
                sets.join(one, *other);
            }
            here.push((span, one));
        }
        above = here;
    }
    let (mut found, mut numbers): (Vec<Island>, Vec<usize>) = (Vec::new(), Vec::new());
    let spans = rows.iter().flat_map(|(j, row)| row.iter().map(move |&span| (j, span)));
    for (one, (j, span)) in spans.enumerate() {
        let root = sets.root(one);
        let y = lattice.middle(j);
        let number = if root == one {
            found.push(Island { origin: [to_mm(span.start), y], ..Island::default() });
            found.len() - 1
        } else {
            numbers[root]
        };
        numbers.push(number);
        found[number].add(span, (y, lattice.pitch()));
    }
    (found, numbers)
}

/// Which islands of a layer overlap which of the layer below.
fn overlaps(
    (rows, of_span): (&Rows, &[usize]),
    (below, of_below): (&Rows, &[usize]),
) -> Vec<(usize, usize)> {
    // The number of the first span of each row below.
    let mut firsts = Vec::new();
    let mut sum = 0;
    for (_, row) in below.iter() {
        firsts.push(sum);
        sum += row.len();
    }
    let mut found = Vec::new();
    let mut next = 0;
    for (j, row) in rows.iter() {
        let first = usize::try_from(j - below.range().start).ok().and_then(|k| firsts.get(k));
        for span in row {
            let island = of_span[next];
            next += 1;
            let Some(first) = first else { continue };
            for (k, under) in below.row(j).iter().enumerate() {
                let pair = (island, of_below[first + k]);
                if under.overlaps(*span) && found.last() != Some(&pair) {
                    found.push(pair);
                }
            }
        }
    }
    found.sort_unstable();
    found.dedup();
    found
}
