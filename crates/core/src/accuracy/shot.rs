//! Everything that one picture is made from.

use super::Settings;
use crate::base::image::Size;
use crate::scene::{Scene, View};

/// A scene with its view, settings and size. Equal shots give equal pictures, and a clone is
/// cheap.
#[derive(Clone, Debug, PartialEq)]
pub struct Shot {
    /// What is drawn.
    pub scene: Scene,
    /// How it is viewed.
    pub view: View,
    /// How exactly it is drawn.
    pub settings: Settings,
    /// The size of the picture: at least 1 x 1.
    pub size: Size,
}

impl Shot {
    /// A shot of a scene.
    #[must_use]
    pub fn new(scene: &Scene, view: &View, settings: &Settings, size: Size) -> Self {
        Self { scene: scene.clone(), view: view.clone(), settings: *settings, size }
    }

    /// The same shot with other settings.
    #[must_use]
    pub fn with(&self, settings: Settings) -> Self {
        Self { settings, ..self.clone() }
    }
}
