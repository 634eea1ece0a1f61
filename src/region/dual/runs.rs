//! Rows of the layers of a block -> Runs: what successive layers share is printed once, on the last of them.
//!
//! A *run* of a place is a maximal sequence of successive layers of one group that all have lines
//! there. Each place of each layer is in exactly one run. A line for a run of `n` layers has the
//! material of `n` layers. So no place stays hollow, and no line is higher than what it replaces.

use crate::geom::spans::{Rows, Span};
use crate::units::Coord;

/// What one layer prints: for how many layers, and where. No rows are empty.
pub type Printed = Vec<(u32, Rows)>;

/// The runs of `layers`, by the layer that prints them. `ends(k)` is whether a group ends with
/// layer `k`. Where less than `least` of a span continues on the next layer, the run ends.
#[must_use]
pub fn runs(layers: &[Rows], ends: impl Fn(usize) -> bool, least: Coord) -> Vec<Printed> {
    let long = |_, span: Span| span.len() >= i64::from(least);
    let mut out = vec![Printed::new(); layers.len()];
    // Runs that may continue: `open[n]` has n + 1 layers so far.
    let mut open: Vec<Rows> = Vec::new();
    for (k, here) in layers.iter().enumerate() {
        let mut now = vec![here.clone()];
        for (n, run) in open.iter().enumerate() {
            let continued = run.and(here).filter(long);
            now[0] = now[0].minus(&continued);
            print(&mut out[k - 1], n, run.minus(&continued));
            now.push(continued);
        }
        open = now;
        if ends(k) {
            for (n, run) in open.drain(..).enumerate() {
                print(&mut out[k], n, run);
            }
        }
    }
    out
}

fn print(out: &mut Printed, n: usize, rows: Rows) {
    if !rows.is_empty() {
        out.push((n as u32 + 1, rows));
    }
}
