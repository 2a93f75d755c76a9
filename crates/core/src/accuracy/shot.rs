//! The complete input of one picture.

use super::Settings;
use crate::base::image::Size;
use crate::scene::{Scene, View};

/// A scene with its view, settings and size. Equal shots give equal pictures, and a clone is cheap.
#[derive(Clone, Debug, PartialEq)]
pub struct Shot {
    /// The scene to draw.
    pub scene: Scene,
    /// The view: camera, background and switches.
    pub view: View,
    /// The accuracy settings.
    pub settings: Settings,
    /// The size of the picture: at least 1 x 1.
    pub size: Size,
}

impl Shot {
    /// A shot of a scene.
    pub fn new(scene: &Scene, view: &View, settings: &Settings, size: Size) -> Self {
        Self { scene: scene.clone(), view: view.clone(), settings: *settings, size }
    }

    /// The same shot with other settings.
    #[must_use]
    pub fn with(&self, settings: Settings) -> Self {
        Self { settings, ..self.clone() }
    }
}
