//! The three things that a job is made of, which are swapped one by one:
//!
//! - *printer*: machine, limits, start and end blocks, retraction.
//! - *material*: temperatures, fan, flow, density, price.
//! - *print*: heights, walls, skins, infill, speeds, dual injection, support.

use std::fmt;

/// Which of the three things of a job a profile describes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum ProfileKind {
    /// The machine.
    Printer,
    /// The filament.
    Material,
    /// How it is printed.
    Print,
}

impl ProfileKind {
    /// All kinds, in the order of lists.
    pub const ALL: [Self; 3] = [Self::Printer, Self::Material, Self::Print];

    /// Its name, which is also that of its key under `defaults`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Printer => "printer",
            Self::Material => "material",
            Self::Print => "print",
        }
    }
}

impl fmt::Display for ProfileKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
