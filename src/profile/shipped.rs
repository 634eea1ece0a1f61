//! Name -> text: the profiles that come with the program, by kind. A name stands for one of them alone.

use super::kind::ProfileKind;
use ProfileKind::{Material, Print, Printer};

/// Name of the printer that is used where none is asked for.
pub const DEFAULT: &str = "zcube-dual";

/// A shipped profile: kind, name and text.
macro_rules! shipped {
    ($kind:ident, $folder:literal, $($name:literal)*) => {
        &[$(($kind, $name, include_str!(concat!("../../profiles/", $folder, "/", $name, ".toml"))),)*]
    };
}

const BUILTIN: [&[(ProfileKind, &str, &str)]; 3] = [
    shipped!(Printer, "printers", "zcube-dual" "replicator" "replicator-2" "replicator-2x" "witbox-1" "witbox-2" "ender-3" "prusa-mk3s" "prusa-mk4" "voron-2.4" "ultimaker-2" "narino" "generic-marlin" "generic-klipper" "generic-reprapfirmware"),
    shipped!(Material, "materials", "pla" "petg" "abs" "asa" "tpu" "pla-thesis" "abs-narino"),
    shipped!(Print, "prints", "standard" "draft" "fine" "strong" "one-wall" "thesis" "strand"),
];

fn all() -> impl Iterator<Item = &'static (ProfileKind, &'static str, &'static str)> {
    BUILTIN.iter().copied().flatten()
}

/// Names of all shipped profiles, the printers first, and of these [`DEFAULT`].
pub fn builtin_names() -> impl Iterator<Item = &'static str> {
    all().map(|(_, name, _)| *name)
}

/// Names of the shipped profiles of a kind.
pub(super) fn names(kind: ProfileKind) -> impl Iterator<Item = &'static str> {
    all().filter(move |(its, _, _)| *its == kind).map(|(_, name, _)| *name)
}

/// The kind of the shipped profile of this name.
pub(super) fn kind(name: &str) -> Option<ProfileKind> {
    all().find(|(_, known, _)| *known == name).map(|(kind, _, _)| *kind)
}

/// The text of the shipped profile of this name.
pub(super) fn text(name: &str) -> Option<&'static str> {
    all().find(|(_, known, _)| *known == name).map(|(_, _, text)| *text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unique_over_the_kinds() {
        let mut names: Vec<_> = builtin_names().collect();
        assert_eq!(names[0], DEFAULT);
        names.sort_unstable();
        assert!(names.windows(2).all(|pair| pair[0] != pair[1]), "{names:?}");
    }
}
