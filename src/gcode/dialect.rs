//! Dialect -> words: where the G-code of printers differs.

use crate::profile::DialectName;

/// The differences between dialects, as the writer needs them.
#[derive(Debug, Clone, Copy)]
pub struct Dialect {
    name: DialectName,
}

impl Dialect {
    /// The dialect called `name`.
    #[must_use]
    pub fn new(name: DialectName) -> Self {
        Self { name }
    }

    /// Whether E starts again from zero at every layer. Marlin keeps E as a
    /// 32-bit float, which has no room for small moves after some metres. GPX
    /// counts in doubles, and a Sailfish printer stops for every `G92`.
    #[must_use]
    pub fn restarts_e(self) -> bool {
        self.name != DialectName::Makerbot
    }

    /// What turns the part cooling fan to `percent`.
    #[must_use]
    pub fn fan(self, percent: f64, tool: u32) -> String {
        let on = percent > 0.0;
        match self.name {
            // Sailfish's fan is on or off.
            DialectName::Makerbot if on => format!("M126 T{tool}"),
            DialectName::Makerbot => format!("M127 T{tool}"),
            _ if on => format!("M106 S{}", (percent * 2.55).round() as u32),
            _ => "M107".to_owned(),
        }
    }

    /// What says that `percent` of the print is done and how many minutes are left.
    /// Of the same length whatever the numbers are, so that it can be filled in later.
    #[must_use]
    pub fn progress(self, percent: u64, minutes: u64) -> String {
        let (percent, minutes) = (percent.min(100), minutes.min(99_999));
        match self.name {
            DialectName::Marlin => format!("{:<15}", format!("M73 P{percent} R{minutes}")),
            // GPX wants no R, and Klipper makes nothing of it.
            DialectName::Makerbot | DialectName::Klipper => {
                format!("{:<8}", format!("M73 P{percent}"))
            }
        }
    }

    /// Whether the writer has to say that the print is done; MakerBot's end block
    /// does, since a build ends with it.
    #[must_use]
    pub fn says_done(self) -> bool {
        self.name != DialectName::Makerbot
    }
}
