//! Events -> counts and places: collects what the steps of mending find and do.

use super::faults::{Counted, MOST_PLACES};
use crate::units::UNITS_PER_MM;

/// Events of some kinds, in the order of their first occurrence.
#[derive(Debug, Clone)]
pub(super) struct Notes<K>(pub(super) Vec<Note<K>>);

/// Events of one kind.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Note<K> {
    pub(super) kind: K,
    pub(super) count: usize,
    /// The largest size, grid units.
    pub(super) largest: f64,
    /// The vertices where the first of them are.
    pub(super) at: Vec<u32>,
}

impl<K> Default for Notes<K> {
    fn default() -> Self {
        Self(Vec::new())
    }
}

impl<K: Copy + PartialEq> Notes<K> {
    /// Adds `count` events of a `kind` without a place.
    pub(super) fn many(&mut self, kind: K, count: usize) {
        if count > 0 {
            self.extend(Self(vec![Note { kind, count, largest: 0.0, at: Vec::new() }]));
        }
    }

    /// Adds other events.
    pub(super) fn extend(&mut self, others: Self) {
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

    /// Adds an event of a `kind`, at a vertex.
    pub(super) fn add(&mut self, kind: K, vertex: u32) {
        self.sized(kind, vertex, 0.0);
    }

    /// Adds an event of a `kind` and of some size in grid units, at a vertex.
    pub(super) fn sized(&mut self, kind: K, vertex: u32, size: f64) {
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

    /// The counts for the report, with places in the file's own numbers.
    pub(super) fn counted(self, vertices: &[[f32; 3]]) -> Vec<Counted<K>> {
        let counted = |note: Note<K>| Counted {
            kind: note.kind,
            count: note.count,
            // Rounded to the grid: more digits would be noise.
            largest_mm: (note.largest.round() / UNITS_PER_MM).max(0.0),
            places: note.at.iter().map(|&v| vertices[v as usize].map(f64::from)).collect(),
        };
        self.0.into_iter().map(counted).collect()
    }
}
