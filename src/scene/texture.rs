//! A picture that is laid over a surface.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use crate::base::Shared;
use crate::base::image::Picture;

/// A picture for a surface, and how it is laid over it.
#[derive(Clone, Debug, PartialEq)]
pub struct Texture {
    /// Its file.
    pub source: PathBuf,
    /// Its texels, rows from the top, which other textures may share. The uv (0, 0) is the lower
    /// left corner.
    pub picture: Shared<Picture>,
    /// What a uv outside 0 to 1 shows: `-clamp on` is the border; otherwise the picture repeats.
    pub wrap: Wrap,
    /// `-o u v`, added after scaling.
    pub offset: [f64; 2],
    /// `-s u v`, multiplied by the uv.
    pub scale: [f64; 2],
}

/// What a texture shows outside its borders.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Wrap {
    /// Its repetitions.
    #[default]
    Repeat,
    /// The texels of its border.
    Clamp,
}
