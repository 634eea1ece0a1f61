//! Words of the axes -> places of the nozzle: what G92, homing and zero points make of a number.
//!
//! All places are the machine's own: where the nozzle really is. A file's number is such a place less
//! two shifts:
//! - what G92 has moved the axis's numbers by, until it is homed;
//! - the zero point that G54 to G59 choose (RepRapFirmware: G10 L2 and L20 set them; see
//!   [`firmware`](super::firmware)).
//!
//! An axis that was sent to an end stop whose place only the printer knows is unknown (`None`) until the
//! file names one. A place is *sure* once an absolute number has named it; before that, at the start and
//! after homing, G92 says where the nozzle is, and shifts nothing: files for machines without end stops
//! begin so, and people set the height of their first layer so.
//!
//! Sums are kept at whole billionths of a mm, finer than any file's decimals: the error of a double does
//! not add up over any number of relative moves.

/// Zero points that can be chosen, G54 to G59.
const ZEROS: usize = 6;

/// The nearest whole number of billionths of a mm.
fn exact(mm: f64) -> f64 {
    const BILLION: f64 = 1e9;
    (mm * BILLION).round() / BILLION
}

/// Where the nozzle is, and how numbers are read.
#[derive(Debug, Clone)]
pub(super) struct Places {
    /// Where it is, mm; `None` where only the printer knows.
    pub(super) at: [Option<f64>; 3],
    sure: [bool; 3],
    /// By G92, mm.
    shift: [f64; 3],
    /// By G10 L2 and L20, mm.
    zeros: [[f64; 3]; ZEROS],
    /// The zero point in use.
    zero: usize,
}

impl Default for Places {
    fn default() -> Self {
        let zeros = [[0.0; 3]; ZEROS];
        Self { at: [Some(0.0); 3], sure: [false; 3], shift: [0.0; 3], zeros, zero: 0 }
    }
}

impl Places {
    /// Where a move with these numbers ends.
    pub(super) fn end(&mut self, numbers: [Option<f64>; 3], relative: bool) -> [Option<f64>; 3] {
        std::array::from_fn(|axis| match (numbers[axis], self.at[axis]) {
            (None, at) => at,
            (Some(by), at) if relative => at.map(|at| exact(at + by)),
            (Some(number), _) => {
                self.sure[axis] = true;
                let shift = self.shift[axis] + self.zeros[self.zero][axis];
                Some(if shift == 0.0 { number } else { exact(number + shift) })
            }
        })
    }

    /// G92: where the nozzle is has this number from now on.
    pub(super) fn rename(&mut self, axis: usize, number: f64) {
        let zero = self.zeros[self.zero][axis];
        match self.at[axis] {
            Some(at) if self.sure[axis] => self.shift[axis] = at - zero - number,
            _ => {
                self.at[axis] = Some(number + zero);
                self.shift[axis] = 0.0;
            }
        }
    }

    /// The axis is homed, to this place.
    pub(super) fn home(&mut self, axis: usize, at: Option<f64>) {
        (self.at[axis], self.sure[axis], self.shift[axis]) = (at, false, 0.0);
    }

    /// G54 and on, counted from 0: choose a zero point.
    pub(super) fn choose(&mut self, zero: usize) {
        self.zero = zero.min(ZEROS - 1);
    }

    /// G10 L2: sets a zero point, counted from 1; 0 is the one in use. With `here` (L20) so that the
    /// nozzle is at these numbers.
    pub(super) fn set_zero(&mut self, which: usize, numbers: [Option<f64>; 3], here: bool) {
        let which = if which == 0 { self.zero } else { which - 1 };
        let Some(zero) = self.zeros.get_mut(which) else { return };
        for axis in 0..3 {
            let Some(number) = numbers[axis] else { continue };
            let at = self.at[axis].unwrap_or_default() - self.shift[axis];
            zero[axis] = if here { at - number } else { number };
        }
    }
}
