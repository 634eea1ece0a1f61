//! Commands for the part cooling fan in the file's order -> a finding where it blows less than the file's own settings say.
//!
//! The least power that settings allow is the least of all that they name: for usual lines, for layers
//! that take long, for bridges, overhangs and support next to the part. The first layers, on which the fan
//! rises, are not judged.

use crate::check::beads;
use crate::check::finding::{Code, Finding, Findings, Place, short};
use crate::check::terms::Terms;
use crate::profile::DialectName;
use crate::reader::print::{Order, Step};

/// How much less it may blow, %: powers are rounded.
const SLACK: f64 = 2.0;

/// The fan so far.
pub(crate) struct Air {
    dialect: Option<DialectName>,
    /// The least power, %, and the last layer, from 1, on which it may be less.
    wanted: Option<(f64, usize)>,
    /// %.
    power: f64,
    /// The command that set it, if one did.
    set_at: Option<Place>,
    is_reported: bool,
}

impl Air {
    pub(crate) fn new(terms: &Terms) -> Self {
        let dialect = terms.machine.as_ref().map(|machine| machine.dialect);
        Self { dialect, wanted: terms.fan, power: 0.0, set_at: None, is_reported: false }
    }

    /// A command.
    pub(crate) fn set(&mut self, order: &Order, place: Place) {
        // Fans but the first cool something else.
        let is_other = order.value(b'P').is_some_and(|fan| fan > 0.0);
        let power = match (order.letter, order.number) {
            (b'M', 106) if !is_other => match order.value(b'S') {
                Some(part) if self.dialect == Some(DialectName::Reprapfirmware) && part <= 1.0 => {
                    100.0 * part
                }
                Some(part) => part / 2.55,
                None => 100.0,
            },
            (b'M', 126) => 100.0,
            (b'M', 107) if !is_other => 0.0,
            (b'M', 127) => 0.0,
            _ => return,
        };
        (self.power, self.set_at, self.is_reported) = (power, Some(place), false);
    }

    /// A line of a layer, counted from 0.
    pub(crate) fn line(&mut self, step: &Step, layer: usize, found: &mut Findings) {
        let Some((least, from)) = self.wanted else { return };
        if self.is_reported || layer < from || self.power >= least - SLACK {
            return;
        }
        self.is_reported = true;
        let (power, least) = (short(self.power), short(least));
        let text =
            format!("the fan is at {power} %, where the file's settings want at least {least} %");
        let place = self.set_at.unwrap_or_else(|| beads::place(layer, step));
        found.add(Finding::of(Code::ChangesTheMachine, least - power, "%", text).at(place));
    }
}
