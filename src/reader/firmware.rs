//! A firmware's name -> its rules: what words mean in which a firmware differs from others.
//!
//! [`TABLE`] is all of it, a row a firmware. Words used in it:
//! - *E with G91*: how G90 and G91 (axes absolute or relative) act together with M82 and M83 (filament
//!   absolute or relative), see [`Modes`];
//! - *G10*: what pulls filament back and what sets a tool up, see [`G10`];
//! - *M207*: how far and how fast G10 pulls back, see [`M207`];
//! - *M200*: whether it makes E a volume;
//! - *A, B*: whether they are the filaments of two tools, each with a counter of its own;
//! - *G4*: which of its words counts, see [`Dwell`];
//! - *M220, M221*: which moves their factors are for, see [`Factors`];
//! - *turns*: whether P of an arc adds whole turns;
//! - *places*: whether G54 to G59 choose among the zero points that G10 L2 and L20 set.
//!
//! Where each row is from, with the version where one was read; the names of files say where to look for
//! the rest:
//! - marlin: MarlinFirmware/Marlin 2.0 and 2.1, `gcode.h` (`set_relative_mode` clears what M82 and M83
//!   have set, and they override it), `G4.cpp` (S is read last), `fwretract.cpp` (a second G10 does
//!   nothing, the hop is undone before the filament is pushed), `M200-M205.cpp`, `G2_G3.cpp` (P);
//! - marlin-1: Marlin 1.0 and 1.1, `Marlin_main.cpp` (`axis_relative_modes[i] || relative_mode`);
//! - klipper: Klipper3d/klipper, `gcode_move.py` (`not absolute_coord or not absolute_extrude`),
//!   `firmware_retraction.py` (no M207: SET_RETRACTION), `toolhead.py` (G4 has P alone; no M200);
//! - reprapfirmware: Duet3D/RepRapFirmware fc1cd16c, `GCodes.cpp` (`drivesRelative` is M82's and M83's
//!   alone; S of G4 before P; `applyM220M221` for printing moves alone), `GCodes2.cpp` (G10, G54, M200),
//!   `Tool.cpp` (M207 has the feed and the surplus of both ways; M208 is the axes' limits);
//! - sailfish: markwal/GPX 28f3460, `gpx.c`, which makes Sailfish's commands of G-code (`relativeCoordinates
//!   || extruderIsRelative`; G4 has P alone; G10 sets offsets and temperatures; no G11, M200, M207);
//! - ultigcode: Ultimaker/Ultimaker2Marlin, a Marlin 1 whose retraction is a setting of the printer; E is
//!   a volume by its own diameter, whatever M200 says;
//! - repetier: repetier/Repetier-Firmware 7cb37413 (1.0.5), `Printer.cpp` (`relativeCoordinateMode ||
//!   relativeExtruderCoordinateMode`), `Commands.cpp` (S of G4 last; M207 sets jerk; M200);
//! - smoothie: Smoothieware bb41e992, `Robot.cpp` (G90 and G91 set both modes; G4 adds P and S),
//!   `Extruder.cpp` (G10 but with L, M200, M207 with Q, M208);
//! - unknown: what most of them share, and what tells itself apart (G10 with a temperature). A and B are
//!   filaments where they occur.

use crate::units::MmPerS;

/// Whose rules a file is read by.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Firmware {
    /// Nobody says; see the table's row.
    #[default]
    Other,
    /// Marlin 2.
    Marlin,
    /// Marlin up to 1.1, and firmwares made from it, such as Prusa's for the MK3.
    Marlin1,
    /// Klipper.
    Klipper,
    /// RepRapFirmware, of Duet boards.
    RepRap,
    /// Sailfish and MakerBot, through GPX.
    Sailfish,
    /// The Ultimaker 2's, whose files leave to the printer what its own settings are.
    Ultimaker(OwnFilament),
    /// Repetier-Firmware.
    Repetier,
    /// Smoothieware.
    Smoothie,
}

/// What an Ultimaker 2 knows of its filament, and files for it do not say.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OwnFilament {
    /// Its diameter, mm.
    pub diameter: f64,
    /// How far G10 pulls it back, mm; 0 where only the printer knows.
    pub retraction: f64,
    /// How fast, and how fast G11 pushes it out again.
    pub speed: MmPerS,
}

impl OwnFilament {
    /// Where nobody says more: the only diameter that is sold for an Ultimaker 2.
    pub const UNTOLD: Self = Self { diameter: 2.85, retraction: 0.0, speed: MmPerS(25.0) };
}

impl Firmware {
    /// The names under which people choose one, in the table's order.
    pub const NAMES: [&str; 9] = [
        "marlin",
        "marlin-1",
        "klipper",
        "reprapfirmware",
        "sailfish",
        "ultigcode",
        "repetier",
        "smoothie",
        "unknown",
    ];

    /// The firmware of this name; `makerbot` is sailfish.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Some(match name {
            "marlin" => Self::Marlin,
            "marlin-1" => Self::Marlin1,
            "klipper" => Self::Klipper,
            "reprapfirmware" => Self::RepRap,
            "sailfish" | "makerbot" => Self::Sailfish,
            "ultigcode" => Self::Ultimaker(OwnFilament::UNTOLD),
            "repetier" => Self::Repetier,
            "smoothie" => Self::Smoothie,
            "unknown" => Self::Other,
            _ => return None,
        })
    }

    /// Its name.
    #[must_use]
    pub fn name(&self) -> &'static str {
        self.rules().name
    }

    pub(super) fn rules(&self) -> &'static Rules {
        &TABLE[match self {
            Self::Marlin => 0,
            Self::Marlin1 => 1,
            Self::Klipper => 2,
            Self::RepRap => 3,
            Self::Sailfish => 4,
            Self::Ultimaker(_) => 5,
            Self::Repetier => 6,
            Self::Smoothie => 7,
            Self::Other => 8,
        }]
    }
}

/// A row of the table.
#[derive(Debug)]
pub(super) struct Rules {
    pub(super) name: &'static str,
    pub(super) modes: Modes,
    pub(super) g10: G10,
    pub(super) m207: M207,
    pub(super) m200: bool,
    pub(super) ab: Ab,
    pub(super) dwell: Dwell,
    pub(super) factors: Factors,
    pub(super) turns: bool,
    pub(super) places: bool,
}

/// When E is relative.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Modes {
    /// After M83, and after G91 whatever M82 says.
    Either,
    /// By the last of M82, M83, G90 and G91.
    Last,
    /// After M83 alone.
    Apart,
}

/// What G10 does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum G10 {
    /// It pulls filament back, whatever its words but L; G11 pushes it out again.
    Retracts,
    /// It does so without P, R, S and axes. With them it sets a tool's temperatures and offsets, with L
    /// a zero point.
    RetractsBare,
    /// It sets a tool's temperatures and offsets. There is no G11.
    Offsets,
    /// As [`Self::RetractsBare`], but S of 0 or 1 alone is Marlin's, which says how far to pull back.
    Guess,
}

/// What M207 (and M208) set.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum M207 {
    /// S and F of the way back, Z of a hop; M208: S of what is pushed out more, F of the way out.
    Hops,
    /// As [`Self::Hops`], with Q as the hop's feed.
    HopsApart,
    /// All in M207: S, F of both ways, T of the way out, R of what is pushed out more, Z.
    Surplus,
    /// Jerk: X of x and y, Z, E.
    Jerk,
    /// There is none.
    Nothing,
}

/// What A and B are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Ab {
    /// The filaments of two tools, and E is the current one's.
    Filaments,
    /// The same, once a file has any; until then all tools share one counter.
    Found,
    /// No filament.
    Nothing,
}

/// Which words of G4 count.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Dwell {
    /// S in seconds, else P in milliseconds.
    Seconds,
    /// P alone.
    Milliseconds,
    /// Both, one after the other.
    Sum,
}

/// Which moves M220 and M221 are for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Factors {
    /// All.
    All,
    /// Those that extrude on their way.
    Lines,
}

/// What most firmwares do: a row of the table tells in what its own differs.
const USUAL: Rules = Rules {
    name: "",
    modes: Modes::Either,
    g10: G10::Retracts,
    m207: M207::Hops,
    m200: true,
    ab: Ab::Nothing,
    dwell: Dwell::Seconds,
    factors: Factors::All,
    turns: false,
    places: false,
};

/// See the file's head for the words and for where the rows are from.
static TABLE: [Rules; Firmware::NAMES.len()] = [
    Rules { name: "marlin", modes: Modes::Last, turns: true, ..USUAL },
    Rules { name: "marlin-1", ..USUAL },
    Rules {
        name: "klipper",
        m207: M207::Nothing,
        m200: false,
        dwell: Dwell::Milliseconds,
        ..USUAL
    },
    Rules {
        name: "reprapfirmware",
        modes: Modes::Apart,
        g10: G10::RetractsBare,
        m207: M207::Surplus,
        factors: Factors::Lines,
        places: true,
        ..USUAL
    },
    Rules {
        name: "sailfish",
        g10: G10::Offsets,
        m207: M207::Nothing,
        m200: false,
        ab: Ab::Filaments,
        dwell: Dwell::Milliseconds,
        ..USUAL
    },
    Rules { name: "ultigcode", m200: false, ..USUAL },
    Rules { name: "repetier", m207: M207::Jerk, ..USUAL },
    Rules {
        name: "smoothie",
        modes: Modes::Last,
        m207: M207::HopsApart,
        dwell: Dwell::Sum,
        ..USUAL
    },
    Rules { name: "unknown", g10: G10::Guess, ab: Ab::Found, places: true, ..USUAL },
];
