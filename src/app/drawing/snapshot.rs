//! Everything that a picture of the viewport depends on.

use std::time::Duration;

use marraztu_core::accuracy::{Samples, Settings};
use marraztu_core::base::image::Size;
use marraztu_core::scene::{ItemId, Scene, View};

/// Everything that a picture depends on.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Snapshot {
    pub(crate) scene: Scene,
    pub(crate) view: View,
    pub(crate) settings: Settings,
    pub(crate) size: Size,
    /// Whether the scene is moving, so that the picture may be drawn at reduced quality.
    pub(crate) moving: bool,
    /// Whether it ever may be.
    pub(crate) coarse: bool,
    /// The time that a picture may take while the scene is moving.
    pub(crate) budget: Duration,
    /// The samples per pixel that the picture is refined to while nothing happens.
    pub(crate) refined: Option<Samples>,
    /// Whether to explain the effects of the picture.
    pub(crate) explain: bool,
    /// The selected items whose borders are wanted with the picture: the first has its own, the
    /// others have one together.
    pub(crate) outlined: Vec<ItemId>,
}

impl Snapshot {
    /// Whether another snapshot differs in more than the time.
    pub(crate) fn differs_from(&self, other: &Self) -> bool {
        let Self { scene, view, settings, size, moving: _, .. } = self;
        let view = |of: &View| View { time: view.time, ..of.clone() };
        (*settings, *size) != (other.settings, other.size)
            || *scene != other.scene
            || self.view != view(&other.view)
    }
}
