//! A picture that is laid over a surface.

use std::path::PathBuf;
use std::sync::OnceLock;

use serde::{Deserialize, Serialize};

use crate::base::Shared;
use crate::base::image::{Picture, Size};
use crate::base::once::get_or_compute;

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

/// The picture of every placeholder: one white texel, which leaves the material as it is.
static PLACEHOLDER: OnceLock<Shared<Picture>> = OnceLock::new();

fn placeholder() -> &'static Shared<Picture> {
    get_or_compute(&PLACEHOLDER, || Picture::filled(Size::new(1, 1), [255; 4]).into())
}

impl Texture {
    /// A texture in the place of one whose file is missing or cannot be read. It keeps the file's
    /// path, so that saving the scene does not lose it.
    #[must_use]
    pub fn placeholder(source: PathBuf) -> Self {
        let (wrap, offset, scale) = (Wrap::default(), [0.0; 2], [1.0; 2]);
        Self { source, picture: placeholder().clone(), wrap, offset, scale }
    }

    /// Whether it is in the place of a texture whose file is missing.
    #[must_use]
    pub fn is_placeholder(&self) -> bool {
        Shared::same(&self.picture, placeholder())
    }
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
