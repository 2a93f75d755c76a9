//! A texture: a picture that is mapped onto a surface.

use std::path::PathBuf;
use std::sync::OnceLock;

use serde::{Deserialize, Serialize};

use crate::base::Shared;
use crate::base::image::{Picture, Size};
use crate::base::once::get_or_compute;

/// A picture and its mapping onto a surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Texture {
    /// The file.
    pub source: PathBuf,
    /// The texels, in rows from the top; textures may share them. The uv (0, 0) is the lower left
    /// corner.
    pub picture: Shared<Picture>,
    /// The wrapping of uvs outside 0 to 1: `-clamp on` extends the border, else the picture
    /// repeats.
    pub wrap: Wrap,
    /// The offset `-o u v`, added after scaling.
    pub offset: [f64; 2],
    /// The scale `-s u v`, multiplied by the uv.
    pub scale: [f64; 2],
}

/// The picture of every placeholder: one white texel, which does not change the material.
static PLACEHOLDER: OnceLock<Shared<Picture>> = OnceLock::new();

fn placeholder() -> &'static Shared<Picture> {
    get_or_compute(&PLACEHOLDER, || Picture::filled(Size::new(1, 1), [255; 4]).into())
}

impl Texture {
    /// Creates a texture that repeats, and that uses texture coordinates as they are.
    pub fn new(source: impl Into<PathBuf>, picture: impl Into<Shared<Picture>>) -> Self {
        let (source, picture) = (source.into(), picture.into());
        Self { source, picture, wrap: Wrap::Repeat, offset: [0.0; 2], scale: [1.0; 2] }
    }

    /// Builds a texture that replaces a missing or unreadable file. It keeps the file's path, so
    /// saving the scene does not lose it.
    pub fn placeholder(source: PathBuf) -> Self {
        Self::new(source, placeholder().clone())
    }

    /// Returns whether the texture replaces a missing file.
    pub fn is_placeholder(&self) -> bool {
        Shared::same(&self.picture, placeholder())
    }
}

/// The wrapping of a texture outside its borders.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Wrap {
    /// The texture repeats.
    #[default]
    Repeat,
    /// The border texels extend outwards.
    Clamp,
}
