//! Names of features in comments -> Role.

use serde::Serialize;

/// What a move is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Role {
    /// The outermost wall.
    OuterWall,
    /// The walls inside it.
    InnerWall,
    /// Solid infill.
    Skin,
    /// The nozzle goes over skin once more, with little plastic.
    Ironing,
    /// Skin that follows a slope, between the marks of its patch.
    NonPlanar,
    /// Sparse infill.
    Infill,
    /// Support.
    Support,
    /// Skirt and brim: what is printed on the bed beside the part, so that it sticks.
    Adhesion,
    /// Anything else that extrudes, and all of it in files without comments.
    Other,
    /// The nozzle moves without extruding, sideways or in z.
    Travel,
    /// The filament moves alone, back or forth.
    Retraction,
}

/// The names that slicers use after `;TYPE:` and `;FEATURE:`, in lower case without blanks,
/// `-` and `_`: those of PrusaSlicer, OrcaSlicer and CuraEngine.
const NAMES: &[(&str, Role)] = &[
    ("externalperimeter", Role::OuterWall),
    ("overhangperimeter", Role::OuterWall),
    ("outerwall", Role::OuterWall),
    ("overhangwall", Role::OuterWall),
    ("wallouter", Role::OuterWall),
    ("perimeter", Role::InnerWall),
    ("innerwall", Role::InnerWall),
    ("wallinner", Role::InnerWall),
    ("solidinfill", Role::Skin),
    ("topsolidinfill", Role::Skin),
    ("bridgeinfill", Role::Skin),
    ("ironing", Role::Ironing),
    ("gapfill", Role::Skin),
    ("gapinfill", Role::Skin),
    ("internalsolidinfill", Role::Skin),
    ("topsurface", Role::Skin),
    ("bottomsurface", Role::Skin),
    ("bridge", Role::Skin),
    ("internalbridge", Role::Skin),
    ("internalbridgeinfill", Role::Skin),
    ("skin", Role::Skin),
    ("internalinfill", Role::Infill),
    ("sparseinfill", Role::Infill),
    ("fill", Role::Infill),
    ("supportmaterial", Role::Support),
    ("supportmaterialinterface", Role::Support),
    ("support", Role::Support),
    ("supportinterface", Role::Support),
    ("supporttransition", Role::Support),
    ("skirt/brim", Role::Adhesion),
    ("skirt", Role::Adhesion),
    ("brim", Role::Adhesion),
];

impl Role {
    /// All of them, in the order of reports.
    pub const ALL: [Self; 11] = [
        Self::OuterWall,
        Self::InnerWall,
        Self::Skin,
        Self::Ironing,
        Self::NonPlanar,
        Self::Infill,
        Self::Support,
        Self::Adhesion,
        Self::Other,
        Self::Travel,
        Self::Retraction,
    ];

    /// The name for people.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::OuterWall => "outer wall",
            Self::InnerWall => "inner wall",
            Self::Skin => "skin",
            Self::Ironing => "ironing",
            Self::NonPlanar => "non-planar skin",
            Self::Infill => "infill",
            Self::Support => "support",
            Self::Adhesion => "skirt and brim",
            Self::Other => "other",
            Self::Travel => "travel",
            Self::Retraction => "retraction",
        }
    }

    /// The role that a slicer calls this; an unknown name is [`Role::Other`].
    #[must_use]
    pub fn of_name(name: &[u8]) -> Self {
        let letters = name.iter().filter(|byte| !matches!(byte, b' ' | b'-' | b'_' | b'\t'));
        let plain: Vec<u8> = letters.map(u8::to_ascii_lowercase).collect();
        let known = NAMES.iter().find(|(known, _)| known.as_bytes() == plain);
        known.map_or(Self::Other, |(_, role)| *role)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_slicer_has_its_names() {
        for (name, role) in [
            ("External perimeter", Role::OuterWall),
            ("WALL-INNER", Role::InnerWall),
            ("Top surface", Role::Skin),
            ("Ironing", Role::Ironing),
            ("FILL", Role::Infill),
            ("Support material interface", Role::Support),
            ("SKIRT", Role::Adhesion),
            ("Skirt/Brim", Role::Adhesion),
            ("Brim", Role::Adhesion),
            ("Prime tower", Role::Other),
            ("", Role::Other),
        ] {
            assert_eq!(Role::of_name(name.as_bytes()), role, "{name}");
        }
        assert!(Role::ALL.windows(2).all(|two| two[0] < two[1]));
    }
}
