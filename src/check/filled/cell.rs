//! What is measured in a cell -> a finding, or a doubt.
//!
//! A cell is a square of the bed; its room is what walls and skins cover of it ([`super::fills`]).

use crate::check::finding::{Code, Finding, short};
use crate::units::Bounded as _;

/// Plastic over room: neighbours of other slicers overlap by a tenth, ends of lines in walls by
/// another; the model of a bead with round ends leaves 0.79 of the thinnest.
const BOUNDS: [f64; 2] = [0.7, 1.3];

/// What ironing may take of the room: others take 0.1 to 0.25.
const IRONING: f64 = 0.35;

/// Room by which plastic is judged, mm²: too little and too much of it.
const LEAST_ROOM: [f64; 2] = [2.0, 1.2];

/// What must be too much to count, mm² of a layer: three quarters of a mm of a line.
const LEAST_EXCESS: f64 = 0.3;

/// Open part of gaps and room from which on a place is underfilled, and least area, mm².
const OPEN: f64 = 0.2;
pub(super) const LEAST_OPEN: f64 = 0.6;

/// The part of what makes a place open, or too much of it, from which on a first look leaves a doubt.
pub(super) const DOUBT: f64 = 0.5;

/// What plastic over room must be by a first look to leave no doubt: the room of thin walls is an eighth off.
const SURE: [f64; 2] = [0.85, 1.1];

/// What is measured in a cell: mm², and plastic in mm³.
#[derive(Clone, Copy, Default)]
pub(super) struct Cell {
    pub(super) room: f64,
    pub(super) plastic: f64,
    /// Of ironing.
    pub(super) ironed: f64,
    /// What infill side by side covers of the room.
    pub(super) infill: f64,
    /// Open gaps along rows, and along columns.
    pub(super) open: [f64; 2],
}

impl Cell {
    /// The plastic in the room of a layer of this height, without infill and with it, over the room.
    fn fills(&self, height: f64) -> [f64; 2] {
        let room = self.room * height;
        let own = self.plastic + (self.ironed - IRONING * room).at_least(0.0);
        [own, own + self.infill * height].map(|plastic| plastic / room)
    }

    /// Its open gaps, in the direction that shows more of them.
    fn gaps(&self) -> f64 {
        self.open[0].max(self.open[1])
    }

    /// Judges it on a layer of this height, mm.
    pub(super) fn judged(&self, height: f64) -> Option<Finding> {
        let [fills, all] = self.fills(height);
        if self.room >= LEAST_ROOM[1] && all > BOUNDS[1] && (all - 1.0) * self.room >= LEAST_EXCESS
        {
            let percent = short(100.0 * all);
            let beside = if self.infill < LEAST_EXCESS { "" } else { " with the infill on them" };
            let text = format!(
                "walls and skins{beside} take {percent} % of the plastic that they have room for"
            );
            return Some(Finding::warning(Code::Overfilled, percent, "%", text));
        }
        let gaps = self.gaps();
        if is_open(gaps, self.room) {
            let text = format!("{} mm² between walls or skins are open", short(gaps));
            return Some(Finding::warning(Code::Underfilled, gaps, "mm²", text));
        }
        (self.room >= LEAST_ROOM[0] && fills < BOUNDS[0]).then(|| {
            let (percent, lacks) = (short(100.0 * fills), (1.0 - fills) * self.room);
            let text =
                format!("walls and skins take {percent} % of the plastic that they have room for");
            Finding::warning(Code::Underfilled, lacks, "mm²", text)
        })
    }

    /// Whether plastic and gaps are not well within their bounds on a layer of this height.
    pub(super) fn is_doubtful(&self, height: f64) -> bool {
        let [fills, all] = self.fills(height);
        let [least, most] = SURE;
        // A room that is drawn coarsely may hide most of an excess: a quarter of what counts leaves a doubt.
        let is_more = all > most && (all - 1.0) * self.room > DOUBT * DOUBT * LEAST_EXCESS;
        let is_less = fills < least && self.room > DOUBT * LEAST_ROOM[0];
        is_more || is_less || is_open(self.gaps(), self.room)
    }
}

/// Whether gaps are large, in a cell of which walls and skins cover this, mm².
pub(super) fn is_open(gaps: f64, room: f64) -> bool {
    gaps >= LEAST_OPEN && gaps > OPEN * (gaps + room)
}
