//! Keys that do not go together -> the error, with the origin of the value that is most likely to blame.

use super::error::{Conflict, ProfileError};
use super::origin::ValueOrigin;
use std::collections::BTreeMap;

/// Makes the errors.
pub(super) struct Blame<'a> {
    pub(super) origins: &'a BTreeMap<String, ValueOrigin>,
}

impl Blame<'_> {
    /// An error about these keys.
    pub(super) fn error(&self, keys: &[&str], source: Conflict) -> ProfileError {
        ProfileError::Conflict { origin: self.origin(keys), source }
    }

    /// The origin that is most likely to blame: a flag before `--set` before a file.
    pub(super) fn origin(&self, keys: &[&str]) -> Option<ValueOrigin> {
        let rank = |origin: &&ValueOrigin| match origin {
            ValueOrigin::Flag(_) => 0,
            ValueOrigin::Set | ValueOrigin::Program => 1,
            ValueOrigin::File { .. } | ValueOrigin::Recorded => 2,
            ValueOrigin::Default | ValueOrigin::Follows(_) => 3,
        };
        keys.iter().filter_map(|key| self.origins.get(*key)).min_by_key(rank).cloned()
    }
}
