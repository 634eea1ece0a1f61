//! Profile names, files and overrides -> Settings, each value with its origin.

mod builder;
mod check;
mod choices;
mod derived;
pub mod error;
pub mod foreign;
pub mod keys;
mod layers;
mod load;
mod old;
mod origin;
mod parse;
mod recorded;
mod schema;
mod settings;
mod shelf;
mod shipped;
mod show;
mod sizes;
pub mod suggest;
pub mod template;
mod value;

pub use builder::Builder;
pub use choices::*;
pub use error::{BlockError, ProfileError};
pub use layers::Wanted;
pub use load::{load, load_from};
pub use old::{SETTINGS_FORMAT, renewed};
pub use origin::{Override, Profile, Source, Sources, ValueOrigin};
pub use recorded::recorded;
pub use schema::schema;
pub use settings::*;
pub use shelf::{Found, ProfileKind, Shelf};
pub use shipped::{DEFAULT, builtin_names};
pub use show::{document, dump, values};
pub use sizes::PictureSize;
