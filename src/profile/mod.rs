//! Profile names, files and overrides -> Settings, each value with its origin.

mod builder;
mod check;
mod derived;
pub mod keys;
mod load;
mod old;
mod parse;
mod recorded;
mod settings;
mod show;
mod sizes;
pub mod suggest;
pub mod template;

pub use builder::Builder;
pub use load::{DEFAULT, Override, Profile, ValueOrigin, builtin_names, load};
pub use old::{SETTINGS_FORMAT, renewed};
pub use recorded::recorded;
pub use settings::*;
pub use show::{document, dump};
pub use sizes::PictureSize;
