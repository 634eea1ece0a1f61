//! Settings + origins -> Outdone: numbers of skin layers in a profile of one's own that print more, since a thickness
//! of another profile asks for more.
//!
//! Whoever gives a number on the command line gets it: the thickness gives way. Of profiles both hold.

use super::Settings;
use super::origin::{Outdone, Source, ValueOrigin};
use std::collections::BTreeMap;

/// The numbers of these settings that are outdone. `list` has the profiles that had a say.
pub(super) fn find(
    settings: &Settings,
    origins: &BTreeMap<String, ValueOrigin>,
    list: &[Source],
) -> Vec<Outdone> {
    let own_file = |key: &str| match origins.get(key) {
        Some(ValueOrigin::File { name, .. })
            if list.iter().any(|one| one.file.as_ref() == Some(name)) =>
        {
            Some(name)
        }
        _ => None,
    };
    let sides = [
        ("top_layers", settings.top_layers, "top_thickness", settings.top_thickness),
        ("bottom_layers", settings.bottom_layers, "bottom_thickness", settings.bottom_thickness),
    ];
    let outdone = |(key, count, by, thickness_mm): (&'static str, Option<u32>, _, f64)| {
        let (key, count) = count.map_or(("skin_layers", settings.skin_layers), |one| (key, one));
        let layers = (thickness_mm / settings.layer_height - 1e-9).ceil() as u32;
        let file = own_file(key)?;
        // Who says both means both.
        let is_given = origins.get(by).is_some_and(ValueOrigin::is_given);
        let is_meant = own_file(by) == Some(file) || is_given;
        (layers > count && !is_meant).then_some(Outdone { key, by, thickness_mm, layers })
    };
    sides.into_iter().filter_map(outdone).collect()
}

#[cfg(test)]
mod tests {
    use crate::profile::{Override, ValueOrigin, builtin_names, load};
    use std::fs;

    #[test]
    fn a_number_of_ones_own_that_another_thickness_outdoes_is_found() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("mine.toml");
        let found = |text: &str, given: &[Override]| {
            fs::write(&file, format!("inherits = \"ender-3\"\n{text}")).unwrap();
            let outdone = load([file.to_str().unwrap()], given).unwrap().sources.outdone;
            outdone.iter().map(|one| (one.key, one.by, one.layers)).collect::<Vec<_>>()
        };
        assert_eq!(found("top_layers = 2\n", &[]), [("top_layers", "top_thickness", 4)]);
        assert_eq!(found("top_layers = 2\ntop_thickness = 0.8\n", &[]), []);
        assert_eq!(found("top_layers = 2\ntop_thickness = 0\n", &[]), []);
        assert_eq!(found("top_layers = 4\n", &[]), []);
        assert_eq!(found("walls = 2\n", &[]), []);
        let (key, value) = ("top_layers".to_owned(), "1".to_owned());
        let given = [Override { key, value, origin: ValueOrigin::Set }];
        assert_eq!(found("top_layers = 2\n", &given), []);
        for name in builtin_names() {
            assert_eq!(load([name], &[]).unwrap().sources.outdone, [], "{name}");
        }
    }
}
