//! `WxH` -> PictureSize: sizes of pictures in a list, within limits.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::ops::RangeInclusive;
use std::str::FromStr;
use toml::Value;

/// Pixels that a side may have. Larger pictures make files that hosts are slow to read.
pub(super) const SIDES: RangeInclusive<u32> = 16..=1024;

/// Pictures in a file, at most; so the settings' line stays below GPX's limit.
pub(super) const MOST: usize = 8;

/// Width and height of a picture, pixels; `300x200` as text.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[schemars(extend("pattern" = "^[0-9]+x[0-9]+$"))]
#[serde(into = "String", try_from = "String")]
pub struct PictureSize {
    /// From left to right.
    pub width: u32,
    /// From top to bottom.
    pub height: u32,
}

impl fmt::Display for PictureSize {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}x{}", self.width, self.height)
    }
}

impl From<PictureSize> for String {
    fn from(size: PictureSize) -> Self {
        size.to_string()
    }
}

impl FromStr for PictureSize {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let side = |text: &str| text.parse().ok().filter(|side| SIDES.contains(side));
        let sides = text.split_once('x').map(|(width, height)| (side(width), side(height)));
        let Some((Some(width), Some(height))) = sides else {
            return Err(format!("`{}`", crate::text::line(text)));
        };
        Ok(Self { width, height })
    }
}

impl TryFrom<String> for PictureSize {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        text.parse()
    }
}

/// What is allowed, in words.
pub(super) fn allowed() -> String {
    let (least, most) = (SIDES.start(), SIDES.end());
    format!("at most {MOST} of {least}x{least} to {most}x{most}")
}

/// The list as it is kept, or what it holds that does not belong there.
pub(super) fn check(list: &[Value]) -> Result<Value, String> {
    if list.len() > MOST {
        return Err(format!("{} sizes", list.len()));
    }
    let size = |value: &Value| match value.as_str() {
        Some(text) => text.parse::<PictureSize>(),
        None => Err(format!("{value}, which is no text")),
    };
    let sizes = list.iter().map(|value| size(value).map(|size| Value::String(size.into())));
    Ok(Value::Array(sizes.collect::<Result<_, _>>()?))
}

#[cfg(test)]
mod tests {
    use crate::profile::{Override, ValueOrigin, load};

    fn set(value: &str) -> Result<Vec<String>, String> {
        let key = "machine.thumbnails".to_owned();
        let given = Override { key, value: value.to_owned(), origin: ValueOrigin::Set };
        let profile = load(["zcube-dual"], &[given]).map_err(|error| error.to_string())?;
        Ok(profile.settings.machine.thumbnails.iter().map(ToString::to_string).collect())
    }

    #[test]
    fn lists_are_given_with_brackets_and_without() {
        for given in ["[\"32x32\", \"220x124\"]", "32x32,220x124", " 32x32 , 220x124,"] {
            assert_eq!(set(given).unwrap(), ["32x32", "220x124"]);
        }
        assert!(set("[]").unwrap().is_empty());
        assert!(set("").unwrap().is_empty());
    }

    #[test]
    fn what_is_no_size_is_refused() {
        let bad = ["300", "[300]", "15x300", "300x1025", "300x", "-20x20", "3e1x30", "0x20"];
        for given in bad.into_iter().chain(["true", &"32x32,".repeat(9)]) {
            let error = set(given).unwrap_err();
            assert!(error.starts_with("--set: machine.thumbnails "), "{error}");
            assert!(error.contains("at most 8 of 16x16 to 1024x1024"), "{error}");
            assert!(!error.contains('\n'));
        }
    }
}
