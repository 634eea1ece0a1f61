//! Beads below a chain -> Carriers: what carries it, each once.
//!
//! A long zigzag crosses hundreds of chains, each many times: whether one is known already is looked up, not
//! searched for.

use super::ground::{Carrier, Ground};

/// What carries a chain, in the order in which it was found.
pub(crate) struct Carriers {
    all: Vec<Carrier>,
    /// For each layer of the ground, and each of its chains, the number of the last chain that it carries; 0
    /// for none.
    last: Vec<Vec<u32>>,
    /// The number of the chain, from 1.
    number: u32,
}

impl Carriers {
    /// Of no chain yet.
    pub(crate) fn new(ground: &Ground<'_>) -> Self {
        let last = ground.chains().map(|count| vec![0; count]).collect();
        Self { all: Vec::new(), last, number: 0 }
    }

    /// The next chain begins.
    pub(crate) fn begin(&mut self) {
        self.all.clear();
        self.number += 1;
    }

    /// The bed carries it.
    pub(crate) fn add_bed(&mut self) {
        if !self.all.contains(&Carrier::Bed) {
            self.all.push(Carrier::Bed);
        }
    }

    /// Whether a chain of a layer, by its place in the ground, is known to carry it.
    pub(crate) fn has(&self, (place, chain): (usize, u32)) -> bool {
        self.last[place][chain as usize] == self.number
    }

    /// A chain of a layer, by its place in the ground, carries it.
    pub(crate) fn add(&mut self, ground: &Ground<'_>, (place, chain): (usize, u32)) {
        let last = &mut self.last[place][chain as usize];
        if std::mem::replace(last, self.number) != self.number {
            self.all.push(Carrier::Chain(ground.number(place), chain));
        }
    }

    /// All that was found for the chain.
    pub(crate) fn take(&mut self) -> Vec<Carrier> {
        std::mem::take(&mut self.all)
    }
}
