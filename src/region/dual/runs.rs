//! Rows of the layers of a block -> Runs: what several layers in a row have is printed once, on the last of them.
//!
//! A *run* of a place is as many layers in a row, all in one group, as have lines
//! there. Each place of each layer is in exactly one run: lines printed for a run of
//! `n` layers with `n` layers' material leave no hollow place, and none of them
//! reaches down where there is nothing.

use crate::geom::spans::{Rows, Span};
use crate::units::Coord;

/// What one layer prints: for how many layers, and where. Never empty.
pub type Printed = Vec<(u32, Rows)>;

/// The runs of `layers`, by the layer that prints them. `ends(k)` says whether a group
/// ends with layer `k`; runs do not go on in pieces shorter than `least`.
#[must_use]
pub fn runs(layers: &[Rows], ends: impl Fn(usize) -> bool, least: Coord) -> Vec<Printed> {
    let long = |_, span: Span| span.len() >= i64::from(least);
    let mut out = vec![Printed::new(); layers.len()];
    // What goes on so far: `open[n]` is in runs of n + 1 layers.
    let mut open: Vec<Rows> = Vec::new();
    for (k, here) in layers.iter().enumerate() {
        let mut now = vec![here.clone()];
        for (n, run) in open.iter().enumerate() {
            let goes_on = run.and(here).filter(long);
            now[0] = now[0].minus(&goes_on);
            print(&mut out[k - 1], n, run.minus(&goes_on));
            now.push(goes_on);
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
