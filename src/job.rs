//! Models + settings -> Job: what one run is asked for.

use crate::mesh::Placement;
use crate::profile::{Profile, Settings, Sources};
use crate::text;
use std::borrow::Cow;
use std::path::PathBuf;
use std::sync::Arc;

/// Name and version of this program.
pub const NAME: &str = concat!("slicer ", env!("CARGO_PKG_VERSION"));

/// One run: which models are printed, where and how.
#[derive(Debug, Clone)]
pub struct Job {
    /// The models, in the order in which they are laid out.
    pub models: Vec<Model>,
    /// Where they lie.
    pub placement: Placement,
    /// All effective settings.
    pub settings: Settings,
    /// The profiles that the settings are from, for the report.
    pub sources: Sources,
}

/// Where a model is read from.
#[derive(Debug, Clone)]
pub enum Model {
    /// A file, or standard input if it is `-`.
    Path(PathBuf),
    /// The bytes of a file.
    Bytes {
        /// What messages and the report call it.
        name: String,
        /// As they would be in the file.
        bytes: Arc<[u8]>,
    },
}

impl Job {
    /// Prints with the settings of `profile`; no model is in it yet.
    #[must_use]
    pub fn new(profile: Profile) -> Self {
        Self {
            models: Vec::new(),
            placement: Placement::default(),
            settings: profile.settings,
            sources: profile.sources,
        }
    }

    /// Adds a model.
    #[must_use]
    pub fn model(mut self, model: Model) -> Self {
        self.models.push(model);
        self
    }

    /// Lays the models out like this.
    #[must_use]
    pub fn placed(mut self, placement: Placement) -> Self {
        self.placement = placement;
        self
    }
}

impl Model {
    /// The model in the file of this name; `-` is standard input.
    pub fn path(file: impl Into<PathBuf>) -> Self {
        Self::Path(file.into())
    }

    /// The model whose file holds these bytes; messages and the report call it `name`.
    pub fn bytes(name: impl Into<String>, bytes: impl Into<Arc<[u8]>>) -> Self {
        Self::Bytes { name: name.into(), bytes: bytes.into() }
    }

    /// What messages and the report call it: [`text::name`] of a file.
    #[must_use]
    pub fn name(&self) -> Cow<'_, str> {
        match self {
            Self::Path(path) => Cow::Owned(text::name(path)),
            Self::Bytes { name, .. } => text::line(name),
        }
    }
}
