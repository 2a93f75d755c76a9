//! What a frame needs, and why: decides, and touches no pixel.

use crate::base::image::Size;
use crate::scene::{Scene, Settings, View};

/// Everything that a frame needs.
#[derive(Clone, Debug)]
pub struct FramePlan {
    pub(super) size: Size,
    pub(super) background: [u8; 4],
}

impl FramePlan {
    /// Plans the picture of a scene.
    #[must_use]
    pub fn new(scene: &Scene, view: &View, settings: &Settings, size: Size) -> Self {
        let _ = (view, settings);
        Self { size, background: scene.background.opaque() }
    }
}
