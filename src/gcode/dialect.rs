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

    /// Whether E restarts from zero at every layer. Marlin, the Ultimaker 2 and RepRapFirmware keep
    /// E as a 32-bit float, which loses small moves after some metres of filament. GPX keeps E as
    /// a double, and a Sailfish printer stops at every `G92`: there E never restarts.
    #[must_use]
    pub fn restarts_e(self) -> bool {
        self.name != DialectName::Makerbot
    }

    /// What E counts for each mm of filament: mm, or mm³ where the printer knows the filament.
    /// `area` is the filament's cross-section, mm².
    #[must_use]
    pub fn e_per_mm(self, area: f64) -> f64 {
        if self.name == DialectName::Ultigcode { area } else { 1.0 }
    }

    /// The commands that pull the filament back and push it out again, where the printer knows how
    /// far and how fast.
    #[must_use]
    pub fn own_retraction(self) -> Option<[&'static str; 2]> {
        (self.name == DialectName::Ultigcode).then_some(["G10", "G11"])
    }

    /// The lines that must be the first of a file: how long the print takes, s, and how much plastic
    /// it needs, mm³. Their length does not depend on the numbers, so that they can be filled in later.
    ///
    /// The Ultimaker 2 takes a file for one of its own by the first of them, which must stand on the
    /// first or second line of the file. It heats no nozzle for less than 1 mm³, looks for both numbers
    /// in the first eight lines, and reads whole ones.
    #[must_use]
    pub fn head(self, seconds: f64, plastic: f64, nozzle: f64) -> String {
        if self.name != DialectName::Ultigcode {
            return String::new();
        }
        let whole = |number: f64| format!("{:<10}", number.clamp(0.0, 4e9).ceil() as u64);
        let (seconds, plastic) = (whole(seconds), whole(plastic));
        format!(
            ";FLAVOR:UltiGCode\n;TIME:{seconds}\n;MATERIAL:{plastic}\n;MATERIAL2:0\n\
             ;NOZZLE_DIAMETER:{nozzle}\n"
        )
    }

    /// The command that sets the part cooling fan to `percent`.
    #[must_use]
    pub fn fan(self, percent: f64, tool: u32) -> String {
        let on = percent > 0.0;
        match self.name {
            // Sailfish can only switch its fan on or off.
            DialectName::Makerbot if on => format!("M126 T{tool}"),
            DialectName::Makerbot => format!("M127 T{tool}"),
            // RepRapFirmware takes what is above 1 as a part of 255, so that S1 of 255 would be full
            // power. Parts of 1 are its own scale, and are never taken for another. Its documentation
            // says M106 S0 for off, and of M107 that it is not to be used any more.
            DialectName::Reprapfirmware => {
                format!("M106 S{}", (percent * 10.0).round() / 1000.0)
            }
            _ if on => format!("M106 S{}", (percent * 2.55).round() as u32),
            _ => "M107".to_owned(),
        }
    }

    /// Whether files set temperatures. The Ultimaker 2 heats by the material that is set on it.
    #[must_use]
    pub fn heats(self) -> bool {
        self.name != DialectName::Ultigcode
    }

    /// The command that sets the nozzle to `celsius`, without a wait.
    #[must_use]
    pub fn nozzle(self, celsius: f64, tool: u32) -> String {
        match self.name {
            DialectName::Makerbot => format!("M104 S{celsius} T{tool}"),
            _ => format!("M104 S{celsius}"),
        }
    }

    /// The command that sets the bed to `celsius`, without a wait.
    #[must_use]
    pub fn bed(self, celsius: f64) -> String {
        format!("M140 S{celsius}")
    }

    /// The command that sets pressure advance to `seconds`; none where it is not known.
    #[must_use]
    pub fn advance(self, seconds: f64, tool: u32) -> Option<String> {
        match self.name {
            DialectName::Marlin => Some(format!("M900 K{seconds}")),
            DialectName::Klipper => Some(format!("SET_PRESSURE_ADVANCE ADVANCE={seconds}")),
            DialectName::Reprapfirmware => Some(format!("M572 D{tool} S{seconds}")),
            DialectName::Makerbot | DialectName::Ultigcode => None,
        }
    }

    /// The line that reports `percent` of the print as done and how many minutes are left.
    /// Its length does not depend on the numbers, so that it can be filled in later.
    #[must_use]
    pub fn progress(self, percent: u64, minutes: u64) -> String {
        let (percent, minutes) = (percent.min(100), minutes.min(99_999));
        match self.name {
            DialectName::Marlin | DialectName::Reprapfirmware => {
                format!("{:<15}\n", format!("M73 P{percent} R{minutes}"))
            }
            // GPX rejects R, and Klipper ignores it.
            DialectName::Makerbot | DialectName::Klipper => {
                format!("{:<8}\n", format!("M73 P{percent}"))
            }
            // It has the whole time from the head.
            DialectName::Ultigcode => String::new(),
        }
    }

    /// Whether the writer has to report 100 %. For MakerBot machines the end block does, since
    /// that command ends the build.
    #[must_use]
    pub fn reports_done(self) -> bool {
        self.name != DialectName::Makerbot
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_weak_fan_is_not_taken_for_a_strong_one() {
        let fan = |percent| Dialect::new(DialectName::Reprapfirmware).fan(percent, 0);
        assert_eq!(
            [100.0, 50.0, 0.4, 0.0].map(fan),
            ["M106 S1", "M106 S0.5", "M106 S0.004", "M106 S0"]
        );
    }

    #[test]
    fn a_head_is_as_long_before_its_numbers_are_known_as_after() {
        let dialect = Dialect::new(DialectName::Ultigcode);
        let (empty, full) = (dialect.head(0.0, 0.0, 0.4), dialect.head(1e5, 2.5e5, 0.4));
        assert_eq!(empty.len(), full.len());
        assert!(full.starts_with(";FLAVOR:UltiGCode\n;TIME:100000"), "{full}");
        assert!(Dialect::new(DialectName::Marlin).head(1.0, 1.0, 0.4).is_empty());
    }
}
