//! Everything that a picture of the viewport depends on.

use crate::accuracy::Settings;
use crate::base::image::Size;
use crate::scene::{Scene, View};

/// Everything that a picture depends on.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Snapshot {
    pub(crate) scene: Scene,
    pub(crate) view: View,
    pub(crate) settings: Settings,
    pub(crate) size: Size,
    /// Whether it is on the move, so that a coarser picture in time is better than none.
    pub(crate) moving: bool,
    /// Whether it shall be said what the picture is made of.
    pub(crate) explain: bool,
}

impl Snapshot {
    /// Whether another one shows something else than the passing of time.
    pub(crate) fn differs_from(&self, other: &Self) -> bool {
        let Self { scene, view, settings, size, moving: _, explain: _ } = self;
        let view = |of: &View| View { time: view.time, ..of.clone() };
        (*settings, *size) != (other.settings, other.size)
            || *scene != other.scene
            || self.view != view(&other.view)
    }
}
