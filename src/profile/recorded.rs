//! Comments of a G-code file -> Profile: the settings that this program writes at its end.

use super::error::Result;
use super::keys::KEYS;
use super::layers::Wanted;
use super::load::merge;
use super::old::{is_ours, renewed};
use super::origin::{Override, Profile, ValueOrigin};
use super::shelf::Shelf;
use super::shipped::DEFAULT;
use super::show::NOT_DUMPED;

/// The settings that a file of ours was made with, read from its comments `key = value`;
/// `None` if it holds none of them. Settings of an older format are [renewed]. What a file never holds, such as the start block, is
/// that of the default profile.
///
/// # Errors
/// As [`load`](super::load()): a value that is out of range, such as of a file of another version.
pub fn recorded(comments: &[(String, String)]) -> Result<Option<Profile>> {
    recorded_with(comments, &[])
}

/// As [`recorded`], with `more` laid over what the file holds.
///
/// # Errors
/// As [`recorded`].
pub fn recorded_with(comments: &[(String, String)], more: &[Override]) -> Result<Option<Profile>> {
    if !is_ours(comments) {
        return Ok(None);
    }
    let values = renewed(comments);
    let value = |name: &str| values.iter().rev().find(|(key, _)| key == name);
    let dumped = KEYS.iter().filter(|key| !NOT_DUMPED.contains(&key.name.as_str()));
    let overrides: Vec<Override> = dumped
        .filter_map(|key| {
            let (key, value) = value(&key.name)?.clone();
            Some(Override { key, value, origin: ValueOrigin::Recorded })
        })
        .collect();
    merge(&Shelf::default(), &[Wanted::any(DEFAULT)], &[&overrides, more]).map(Some)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::profile::{builtin_names, dump, load};

    #[test]
    fn what_a_file_holds_gives_the_settings_back() {
        for name in builtin_names() {
            let made = load([name], &[]).unwrap().settings;
            let read = recorded(&dump(&made)).unwrap().unwrap().settings;
            assert_eq!(dump(&read), dump(&made));
        }
        let stray = vec![("infill".to_owned(), "20".to_owned())];
        assert!(recorded(&stray).unwrap().is_none());
    }
}
