//! Profile name + keys and values -> Profile: settings for a program that embeds the library.

use super::error::Result;
use super::load::load;
use super::origin::{Override, Profile, ValueOrigin};
use std::fmt::Display;

/// A profile with values laid over it, one key at a time.
#[derive(Debug, Clone)]
#[must_use]
pub struct Builder {
    profiles: Vec<String>,
    overrides: Vec<Override>,
}

impl Profile {
    /// Begins with the profile of this name: a shipped one, or a file if it has a `/` or ends
    /// in `.toml`.
    pub fn builder(profile: impl Into<String>) -> Builder {
        Builder { profiles: vec![profile.into()], overrides: Vec::new() }
    }
}

impl Builder {
    /// Lays another profile over those before it.
    pub fn with(mut self, profile: impl Into<String>) -> Self {
        self.profiles.push(profile.into());
        self
    }

    /// Sets a key, such as `dual.mode`, to a number, a word or any other TOML value.
    pub fn set(mut self, key: impl Into<String>, value: impl Display) -> Self {
        let (key, value) = (key.into(), value.to_string());
        self.overrides.push(Override { key, value, origin: ValueOrigin::Program });
        self
    }

    /// Reads the profile and checks all values.
    ///
    /// # Errors
    /// As [`load`](super::load()).
    pub fn load(self) -> Result<Profile> {
        load(self.profiles, &self.overrides)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::profile::DualMode;

    #[test]
    fn keys_are_set_in_their_order_and_errors_say_who_set_them() {
        let made = Profile::builder("generic-marlin").set("walls", 3).set("dual.mode", "pair");
        let settings = made.clone().set("walls", 4).load().unwrap().settings;
        assert_eq!((settings.walls, settings.dual.mode), (4, DualMode::Pair));
        let error = made.set("infill", 101).load().unwrap_err().to_string();
        assert!(error.starts_with("the program: infill = 101 is out of range"), "{error}");
    }
}
