//! Layers as they come -> Window: some of them at a time, with those above that reach down into them.

use crate::reader::print::{Note, Step};
use crate::reader::stream::Section;
use crate::reader::{Facts, Print};
use std::borrow::Cow;
use std::collections::VecDeque;
use std::convert::Infallible;

/// Layers above the last that is judged which are held at most: thick lines and bent skins reach down
/// through fewer.
const MOST_AHEAD: usize = 64;

/// The start of a file, or a layer.
#[derive(Debug, Clone)]
pub(super) struct Page<'a> {
    /// From 0; `None` for the start.
    pub(super) layer: Option<usize>,
    /// How many moves come before.
    pub(super) first: usize,
    pub(super) moves: Cow<'a, [Step]>,
    pub(super) notes: Cow<'a, [Note]>,
}

/// The pages of a file, in its order.
pub(super) type Pages<'a, E> = Box<dyn Iterator<Item = Result<Page<'a>, E>> + Send + 'a>;

/// The pages of a print.
pub(super) fn of_print(print: &Print) -> Pages<'_, Infallible> {
    let pages = (0..=print.layers.len()).map(move |index| {
        let (range, notes) = print.section(index);
        let (first, moves) = (range.start, Cow::Borrowed(&print.moves[range]));
        Ok(Page { layer: index.checked_sub(1), first, moves, notes: Cow::Borrowed(notes) })
    });
    Box::new(pages)
}

impl From<Section> for Page<'_> {
    fn from(section: Section) -> Self {
        let Section { layer, first, moves, notes } = section;
        Self { layer, first, moves: Cow::Owned(moves), notes: Cow::Owned(notes) }
    }
}

/// Some layers of a file, one after the other.
pub(super) struct Window<'a> {
    pub(super) facts: &'a Facts,
    /// The first of them.
    first: usize,
    pages: VecDeque<Page<'a>>,
}

impl<'a> Window<'a> {
    pub(super) fn new(facts: &'a Facts) -> Self {
        Self { facts, first: 0, pages: VecDeque::new() }
    }

    /// The moves of a layer; none of one that is not held.
    pub(super) fn moves(&self, layer: usize) -> &[Step] {
        let page = layer.checked_sub(self.first).and_then(|k| self.pages.get(k));
        page.map_or(&[], |page| &page.moves)
    }

    /// Held layers from `layer` on with what is known of them.
    pub(super) fn page(&self, layer: usize) -> Option<&Page<'a>> {
        self.pages.get(layer.checked_sub(self.first)?)
    }

    /// The layer after the last that is held.
    pub(super) fn end(&self) -> usize {
        self.first + self.pages.len()
    }

    /// Lets go of the layers before `first`, and takes in those up to `end`, and beyond it those that
    /// reach down into them: `floors` says how low a layer and all above it reach, mm.
    pub(super) fn go_on<E>(
        &mut self,
        (first, end): (usize, usize),
        floors: &[f64],
        pages: &mut Pages<'a, E>,
    ) -> Result<(), E> {
        while self.first < first && self.pages.pop_front().is_some() {
            self.first += 1;
        }
        let layers = &self.facts.layers[first..end];
        let top = layers.iter().map(|layer| layer.z).fold(f64::NEG_INFINITY, f64::max);
        let is_wanted =
            |layer: usize| layer < end || (layer < end + MOST_AHEAD && floors[layer] < top);
        while self.end() < floors.len() && is_wanted(self.end()) {
            let Some(page) = pages.next() else { break };
            self.pages.push_back(page?);
        }
        Ok(())
    }
}
