//! Name -> text: the profiles that come with the program.

/// Name of the profile that is used where none is asked for.
pub const DEFAULT: &str = "zcube-dual";

/// The shipped profiles: name and text.
const BUILTIN: &[(&str, &str)] = &[
    ("zcube-dual", include_str!("../../profiles/zcube-dual.toml")),
    ("replicator", include_str!("../../profiles/replicator.toml")),
    ("thesis", include_str!("../../profiles/thesis.toml")),
    ("generic-marlin", include_str!("../../profiles/generic-marlin.toml")),
    ("generic-klipper", include_str!("../../profiles/generic-klipper.toml")),
    ("witbox-1", include_str!("../../profiles/witbox-1.toml")),
];

/// Names of the shipped profiles, [`DEFAULT`] first.
pub fn builtin_names() -> impl Iterator<Item = &'static str> {
    BUILTIN.iter().map(|(name, _)| *name)
}

/// The text of the shipped profile of this name.
pub(super) fn text(name: &str) -> Option<&'static str> {
    BUILTIN.iter().find(|(known, _)| *known == name).map(|(_, text)| *text)
}
