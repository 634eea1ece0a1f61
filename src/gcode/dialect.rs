//! Dialect -> words: the commands in which the G-code of firmwares differs.

use crate::profile::DialectName;

/// What the writer needs to know about a dialect.
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

    /// Whether E restarts from zero at every layer. Marlin keeps E as a 32-bit float, which
    /// loses small moves after some metres of filament. GPX keeps E as a double, and a
    /// Sailfish printer stops at every `G92`: there E never restarts.
    #[must_use]
    pub fn restarts_e(self) -> bool {
        self.name != DialectName::Makerbot
    }

    /// The command that sets the part cooling fan to `percent`.
    #[must_use]
    pub fn fan(self, percent: f64, tool: u32) -> String {
        let on = percent > 0.0;
        match self.name {
            // Sailfish can only switch its fan on or off.
            DialectName::Makerbot if on => format!("M126 T{tool}"),
            DialectName::Makerbot => format!("M127 T{tool}"),
            _ if on => format!("M106 S{}", (percent * 2.55).round() as u32),
            _ => "M107".to_owned(),
        }
    }

    /// The command that sets the nozzle to `celsius`, without a wait.
    #[must_use]
    pub fn nozzle(self, celsius: f64, tool: u32) -> String {
        match self.name {
            DialectName::Makerbot => format!("M104 S{celsius} T{tool}"),
            DialectName::Marlin | DialectName::Klipper => format!("M104 S{celsius}"),
        }
    }

    /// The command that sets the bed to `celsius`, without a wait.
    #[must_use]
    pub fn bed(self, celsius: f64) -> String {
        format!("M140 S{celsius}")
    }

    /// The command that reports `percent` of the print as done and how many minutes are left.
    /// Its length does not depend on the numbers, so that it can be filled in later.
    #[must_use]
    pub fn progress(self, percent: u64, minutes: u64) -> String {
        let (percent, minutes) = (percent.min(100), minutes.min(99_999));
        match self.name {
            DialectName::Marlin => format!("{:<15}", format!("M73 P{percent} R{minutes}")),
            // GPX rejects R, and Klipper ignores it.
            DialectName::Makerbot | DialectName::Klipper => {
                format!("{:<8}", format!("M73 P{percent}"))
            }
        }
    }

    /// Whether the writer has to report 100 %. For MakerBot machines the end block does, since
    /// that command ends the build.
    #[must_use]
    pub fn reports_done(self) -> bool {
        self.name != DialectName::Makerbot
    }
}
