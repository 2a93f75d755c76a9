//! The option `--sky`.

use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};

use marraztu_core::base::Shared;
use marraztu_core::base::once::get_or_compute;
use marraztu_core::scene::Panorama;
use marraztu_io::{self as io, LoadError};

/// A panorama that is read once, however many pictures it lights.
#[derive(Clone, Debug)]
pub(crate) struct Sky {
    path: PathBuf,
    read: Arc<OnceLock<Result<Shared<Panorama>, LoadError>>>,
}

/// Parses the option.
pub(super) fn sky(path: &str) -> Result<Sky, String> {
    Ok(Sky { path: path.into(), read: Arc::default() })
}

impl Sky {
    /// Returns the file.
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// Returns the panorama.
    pub(crate) fn panorama(&self) -> Result<Shared<Panorama>, LoadError> {
        get_or_compute(&self.read, || io::load_panorama(&self.path).map(Shared::new)).clone()
    }
}
