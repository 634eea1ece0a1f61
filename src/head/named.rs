//! Names -> Heads: those that a profile can name, each with its source.
//!
//! There is none for MK8 and Volcano nozzles: no dependable figures of them were found.
//! `profiles/README.md` says how to measure one's own.

use super::Head;

/// A name, and its head.
type Named = (&'static str, fn() -> Head);

/// The heads by name, the default first.
const NAMED: [Named; 3] = [("cautious", cautious), ("v6", v6), ("long-0.6", long)];

/// The names, the default first.
pub fn names() -> impl Iterator<Item = &'static str> {
    NAMED.iter().map(|(name, _)| *name)
}

/// The head of this name.
#[must_use]
pub fn named(name: &str) -> Option<Head> {
    NAMED.iter().find(|(known, _)| *known == name).map(|(_, head)| head())
}

/// The name of a head, if it is one of these.
#[must_use]
pub fn name_of(head: &Head) -> Option<&'static str> {
    NAMED.iter().find(|(_, named)| named() == *head).map(|(name, _)| *name)
}

/// `cautious`, for a head that nobody measured: Cura's defaults for an unknown machine
/// (`machine_nozzle_tip_outer_diameter` 1, `machine_nozzle_expansion_angle` 45,
/// `machine_nozzle_head_distance` 3). The radius of all that hangs above it, 40 mm, is ours: it
/// allows a slope of 4.3 degrees.
#[must_use]
pub fn cautious() -> Head {
    Head { flat: 1.0, cone: 45.0, cone_length: 3.0, discs: vec![[40.0, 3.0]], boxes: Vec::new() }
}

/// `v6`, an E3D V6 with its heater block: E3D's drawing V6-NOZZLE-ALL (hexagon of 7 mm, 4.04 mm over
/// its corners) and the block as Knochi/OpenScad models it (flat 1, cone to a diameter of 5 over 2 mm,
/// block 23 x 16 mm with the tip 8 mm from one end); the block is 5 mm up, as in nophead/NopSCADlib's
/// `e3d.scad`. No fan, no duct: they are the printer's own.
#[must_use]
pub fn v6() -> Head {
    Head {
        flat: 1.0,
        cone: 45.0,
        cone_length: 2.0,
        discs: vec![[4.04, 2.0]],
        boxes: vec![[-15.0, -8.0, 8.0, 8.0, 5.0]],
    }
}

/// `long-0.6`, a nozzle made for skins: not measured, but chosen so that the paraboloid of the thesis
/// passes, 10 mm high over 50 mm. Its flank is 60 degrees over 20 mm.
#[must_use]
pub fn long() -> Head {
    Head { flat: 1.0, cone: 60.0, cone_length: 20.0, discs: vec![[13.0, 20.0]], boxes: Vec::new() }
}
