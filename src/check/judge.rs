//! Layers as they come -> Verdict: all witnesses, some layers at a time.
//!
//! Words used here: a *batch* is some layers that are judged side by side; the *window* holds their moves,
//! and those of layers above that reach down into them.
//!
//! 1. All layers are surveyed: what must be known of all before any is judged ([`survey`](super::survey)).
//! 2. The part, if it is given, is laid where it was printed ([`align`]).
//! 3. Batch by batch, layers are judged side by side by those witnesses for which one layer is enough,
//!    while the witnesses that go from move to move go through the same batch. What each has found is then
//!    put together in the file's order.
//! 4. Sums over all layers are judged at the end.
//!
//! So the findings and their order are the same for any number of threads, and only a window of layers
//! is held.

use super::filled::Filled;
use super::filled::contact::{self, Contact, Contacts};
use super::filled::fills::{self, Field};
use super::filled::posts::{self, Posts};
use super::finding::{Code, Finding, Findings};
use super::model::against;
use super::model::align::{self, Given};
use super::model::part::Part;
use super::model::{Sums, Surfaces};
use super::moves::Moves;
use super::stack::Stack;
use super::stack::lay;
use super::survey::Survey;
use super::terms::Terms;
use super::window::{Pages, Window};
use super::{Measures, Model, SCHEMA, Verdict, beads};
use crate::reader::{Facts, Role};
use rayon::prelude::*;
use std::ops::Range;

/// Layers that are judged side by side: enough for many threads, and few to hold.
const BATCH: usize = 32;

/// No print is wider or deeper, mm: larger than any machine's bed.
const WIDEST: f64 = 10_000.0;

/// Judges a file by its facts and its pages, which are gone through twice.
pub(super) fn judge<'a, E: Send>(
    facts: &'a Facts,
    pages: &dyn Fn() -> Pages<'a, E>,
    terms: &Terms,
    model: Option<Model<'_>>,
) -> Result<Verdict, E> {
    let has_roles = facts.has(Role::OuterWall);
    let survey = Survey::new(facts, terms, pages())?;
    let mut found = Found::default();
    // A print wider than any machine is not checked place by place: its map would fill the memory.
    let absurd = is_absurd(&survey);
    let part = model.filter(|_| absurd.is_none()).and_then(|model| {
        let given = Given { facts, survey: &survey, model, terms, has_roles };
        align::place(given, &mut found.placed, &mut found.notes)
    });
    let mut judge = Judge::new((facts, &survey), terms, part.as_ref());
    judge.is_absurd = absurd.is_some();
    let mut moves = Moves::new(facts, terms, survey.has_slopes(facts));
    let mut window = Window::new(facts);
    let mut pages = pages();
    if let Some(start) = pages.next() {
        moves.page(&start?, &mut found.moves);
    }
    let count = facts.layers.len();
    let mut batch = 0..BATCH.min(count);
    window.go_on((0, batch.end), &survey.floors, &mut pages)?;
    while !batch.is_empty() {
        let next = batch.end..(batch.end + BATCH).min(count);
        let (judged, ()) = rayon::join(
            || judge.batch(&window, batch.clone()),
            || walk(&mut moves, &window, batch.clone(), &mut found.moves),
        );
        judge.put_together(&window, judged, &mut found);
        judge.forget(batch.end);
        window.go_on((next.start, next.end), &survey.floors, &mut pages)?;
        batch = next;
    }
    beads::sums(facts, survey.used, &mut found.sums);
    found.sums.extend(absurd);
    moves.finish(&mut found.moves, &mut found.of_moves);
    let (stacked, sums) = judge.finish(&mut found);
    let mut not_judged = what_is_missing((facts, &survey), terms, model.is_some());
    let (findings, counts, notes) = found.sorted();
    not_judged.extend(notes);
    Ok(Verdict {
        schema: SCHEMA,
        layers: count,
        moves: facts.move_count,
        findings,
        counts,
        not_judged,
        measures: measures(terms, &survey, &stacked, sums.as_ref()),
    })
}

/// What was measured on the way.
fn measures(
    terms: &Terms,
    survey: &Survey,
    stacked: &lay::Measured,
    sums: Option<&Sums>,
) -> Measures {
    let share = |[all, some]: [f64; 2]| if all > 0.0 { some / all } else { 1.0 };
    Measures {
        plastic_mm3: survey.filament * terms.filament_area,
        longest_bridge_mm: stacked.longest_bridge,
        longest_end_mm: stacked.longest_end,
        part_hangs_mm: stacked.part_hangs,
        part_mm3: sums.map(|sums| sums.total.part),
        outline: sums.filter(|_| terms.has_walls).map(|sums| share(sums.total.rim)),
        surface: sums.map(|sums| share(sums.total.surface)),
        solid: sums.map(|sums| share(sums.total.solid)),
        infill: sums.and_then(|sums| sums.density),
    }
}

/// Judges the moves of some layers one by one.
fn walk(moves: &mut Moves<'_>, window: &Window<'_>, layers: Range<usize>, found: &mut Findings) {
    for page in layers.filter_map(|layer| window.page(layer)) {
        moves.page(page, found);
    }
}

/// What each witness has found, and what could not be judged.
#[derive(Default)]
struct Found {
    moves: Findings,
    odd: Vec<(Role, Finding)>,
    narrow: Findings,
    sums: Findings,
    placed: Findings,
    surfaces: Findings,
    stacked: Findings,
    fills: Findings,
    posts: Findings,
    contacts: Findings,
    /// Of the moves, and of the rest.
    of_moves: Vec<String>,
    notes: Vec<String>,
}

impl Found {
    /// All findings by kind, in the order of the witnesses.
    fn sorted(self) -> (Vec<Finding>, Vec<super::Count>, Vec<String>) {
        let mut all = self.moves;
        let mut odd = self.odd;
        odd.sort_by_key(|(role, _)| *role);
        all.extend(odd.into_iter().map(|(_, finding)| finding));
        let rest = [self.narrow, self.sums, self.placed, self.surfaces, self.stacked, self.fills];
        rest.into_iter().for_each(|findings| all.extend(findings));
        all.extend(self.contacts);
        all.extend(self.posts);
        let (findings, counts) = all.sorted();
        let notes = self.of_moves.into_iter().chain(self.notes).collect();
        (findings, counts, notes)
    }
}

/// All witnesses, with what they know so far.
struct Judge<'a> {
    facts: &'a Facts,
    survey: &'a Survey,
    terms: &'a Terms,
    has_roles: bool,
    /// Whether lines lie further apart than on any machine.
    is_absurd: bool,
    stack: Stack<'a>,
    surfaces: Option<Surfaces<'a>>,
    field: Option<Field>,
    contacts: Contacts,
    posts: Option<Posts>,
}

/// What witnesses found on a layer that look at one at a time.
struct Judged {
    layer: usize,
    odd: Vec<(Role, Finding)>,
    narrow: Vec<Finding>,
    stacked: Option<lay::Judged>,
    fills: Vec<Finding>,
    contact: Option<Contact>,
    posts: Option<posts::Drawn>,
    surface: Option<against::Verdict>,
}

impl<'a> Judge<'a> {
    fn new(
        (facts, survey): (&'a Facts, &'a Survey),
        terms: &'a Terms,
        part: Option<&'a Part>,
    ) -> Self {
        let has_roles = facts.has(Role::OuterWall);
        Self {
            facts,
            survey,
            terms,
            has_roles,
            is_absurd: false,
            stack: Stack::new(facts, part),
            surfaces: part.and_then(|part| Surfaces::new(part, (survey, terms), has_roles)),
            field: Field::over(survey).filter(|_| has_roles),
            contacts: Contacts::default(),
            posts: Posts::over(survey).filter(|_| has_roles),
        }
    }

    /// Judges some layers side by side.
    fn batch(&mut self, window: &Window<'_>, layers: Range<usize>) -> Vec<Judged> {
        let filled = Filled { window, survey: self.survey };
        if !self.is_absurd {
            self.stack.lay(window, layers.clone());
        }
        let one = &*self;
        let (judged, surfaces) = rayon::join(
            || layers.clone().into_par_iter().map(|k| one.layer(&filled, k)).collect::<Vec<_>>(),
            || one.surfaces.as_ref().map(|all| all.batch(&filled, layers.clone())),
        );
        let mut judged = judged;
        for (one, surface) in judged.iter_mut().zip(surfaces.into_iter().flatten()) {
            one.surface = Some(surface);
        }
        judged
    }

    /// Judges a layer.
    fn layer(&self, filled: &Filled<'_>, layer: usize) -> Judged {
        let (moves, terms) = (filled.window.moves(layer), self.terms);
        let looks = !self.is_absurd;
        let field = self.field.filter(|_| looks);
        let posts = self.posts.as_ref().filter(|_| looks);
        Judged {
            layer,
            odd: beads::odd((self.facts, terms), (layer, moves), &self.survey.usual),
            narrow: beads::narrow((self.facts, terms), (layer, moves)),
            stacked: looks.then(|| self.stack.judged(filled, layer)),
            fills: field.map_or(Vec::new(), |field| fills::layer(filled, (field, terms), layer)),
            contact: (looks && self.has_roles).then(|| contact::layer(filled, terms, layer)),
            posts: posts.map(|posts| posts.drawn(filled, layer)),
            surface: None,
        }
    }

    /// Adds what was found on some layers, in their order.
    fn put_together(&mut self, window: &Window<'_>, judged: Vec<Judged>, found: &mut Found) {
        let filled = Filled { window, survey: self.survey };
        for one in judged {
            found.odd.extend(one.odd);
            found.narrow.extend(one.narrow);
            found.fills.extend(one.fills);
            if let Some(stacked) = one.stacked {
                self.stack.layer(stacked, &mut found.stacked);
            }
            if let Some(contact) = one.contact {
                self.contacts.layer(one.layer, contact);
            }
            if let (Some(posts), Some(drawn)) = (&mut self.posts, one.posts) {
                posts.layer((&filled, one.layer), drawn, &mut found.posts);
            }
            if let (Some(surfaces), Some(verdict)) = (&mut self.surfaces, one.surface) {
                surfaces.layer(verdict, &mut found.surfaces);
            }
        }
    }

    /// Lets go of what the layers from `next` on do not need.
    fn forget(&mut self, next: usize) {
        let floor = self.survey.depths.get(next).copied().unwrap_or(f64::INFINITY);
        self.stack.forget(floor);
    }

    /// Judges the sums over all layers.
    fn finish(self, found: &mut Found) -> (lay::Measured, Option<Sums>) {
        self.contacts.finish(&mut found.contacts);
        if let Some(posts) = self.posts.filter(|_| !self.is_absurd) {
            posts.finish(self.facts, &mut found.posts);
        }
        let all = (self.facts, self.survey);
        let say = (&mut found.surfaces, &mut found.notes);
        let sums = self.surfaces.map(|surfaces| surfaces.finish(all, say));
        (self.stack.finish(&mut found.stacked), sums)
    }
}

/// The finding that lines lie further apart than on any machine, if they do.
fn is_absurd(survey: &Survey) -> Option<Finding> {
    let (low, high) = survey.extent?;
    let side = (high[0] - low[0]).max(high[1] - low[1]);
    let text = || format!("lines lie {side:.0} mm apart, further than on any machine");
    (side > WIDEST).then(|| Finding::of(Code::OutsideVolume, side, "mm", text()))
}

/// What cannot be judged because the file or the caller does not give it.
fn what_is_missing(
    (facts, survey): (&Facts, &Survey),
    terms: &Terms,
    has_model: bool,
) -> Vec<String> {
    let missing = [
        (
            terms.machine.is_none(),
            "volume, commands, speeds and flow: the file does not tell the machine; give -p",
        ),
        (
            terms.head.is_none() && survey.has_slopes(facts),
            "what the head touches: no profile says its shape; give --head",
        ),
        (!has_model, "size, outline, surfaces, infill and volume: give the model with --against"),
        (
            terms.has_walls && !facts.has(Role::OuterWall),
            "what lines are for: no comment of the file tells it",
        ),
        (!terms.has_walls, "the outline: its own settings ask for no walls"),
        (!facts.has_widths, "the plastic of single lines: no comment tells how wide they are"),
    ];
    missing.into_iter().filter(|(is, _)| *is).map(|(_, what)| what.to_owned()).collect()
}
