//! Settings -> ratio: how many layers a thick line may be printed for.

use super::{DualRatio, Settings};

/// Slack for comparing lengths that were written as decimals, mm.
const SLACK_MM: f64 = 1e-9;

impl Settings {
    /// The tallest line that dual injection may print, mm.
    #[must_use]
    pub fn max_bead_height(&self) -> f64 {
        self.dual.max_bead_height / 100.0 * self.machine.nozzle
    }

    /// How many layers dual injection prints at once: as asked for, or with `auto` as
    /// many as the tallest line has. Less than 2 means that nothing can be doubled.
    #[must_use]
    pub fn dual_ratio(&self) -> u32 {
        match self.dual.ratio {
            DualRatio::Layers(layers) => layers,
            DualRatio::Auto(_) => {
                ((self.max_bead_height() + SLACK_MM) / self.layer_height).floor() as u32
            }
        }
    }
}
