//! Events -> counts and places: what the steps of mending found and did.

use crate::mesh::faults::MOST_PLACES;
use crate::units::UNITS_PER_MM;

/// Events of some kinds, in the order of their first occurrence.
#[derive(Debug, Clone)]
pub(crate) struct Notes<K>(pub(crate) Vec<Note<K>>);

/// Events of one kind.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Note<K> {
    pub(crate) kind: K,
    pub(crate) count: usize,
    /// The largest size, grid units.
    pub(crate) largest: f64,
    /// Vertices that the first of them are at.
    pub(crate) at: Vec<u32>,
}

impl<K> Default for Notes<K> {
    fn default() -> Self {
        Self(Vec::new())
    }
}

impl<K: Copy + PartialEq> Notes<K> {
    /// So many events of a `kind` without a place.
    pub(crate) fn many(&mut self, kind: K, count: usize) {
        if count > 0 {
            self.extend(Self(vec![Note { kind, count, largest: 0.0, at: Vec::new() }]));
        }
    }

    /// Adds other events.
    pub(crate) fn extend(&mut self, others: Self) {
        for other in others.0 {
            match self.0.iter_mut().find(|note| note.kind == other.kind) {
                Some(note) => {
                    note.count += other.count;
                    note.largest = note.largest.max(other.largest);
                    note.at.extend(other.at);
                    note.at.truncate(MOST_PLACES);
                }
                None => self.0.push(other),
            }
        }
    }

    /// One more event of a `kind`, at a vertex.
    pub(crate) fn add(&mut self, kind: K, vertex: u32) {
        self.sized(kind, vertex, 0.0);
    }

    /// One more event of a `kind` and of some size, grid units.
    pub(crate) fn sized(&mut self, kind: K, vertex: u32, size: f64) {
        let place = self.0.iter().position(|note| note.kind == kind).unwrap_or_else(|| {
            self.0.push(Note { kind, count: 0, largest: 0.0, at: Vec::new() });
            self.0.len() - 1
        });
        let note = &mut self.0[place];
        note.count += 1;
        note.largest = note.largest.max(size);
        if note.at.len() < MOST_PLACES {
            note.at.push(vertex);
        }
    }
}

/// Grid units as mm, for what is told.
pub(crate) fn told_mm(units: f64) -> f64 {
    // To the grid: more digits would be noise.
    (units.round() / UNITS_PER_MM).max(0.0)
}
