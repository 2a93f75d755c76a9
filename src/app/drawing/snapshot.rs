//! All inputs of a picture of the viewport.

use std::time::Duration;

use serde::{Deserialize, Serialize};

use super::dial::DialWish;
use marraztu_core::accuracy::{Samples, Shot};
use marraztu_core::scene::{Frame, ItemId, Steps, Subject, Transformation, View};

/// All inputs of a picture.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Snapshot {
    pub(crate) shot: Shot,
    pub(crate) options: DrawOptions,
}

/// The way of the window to draw a picture.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct DrawOptions {
    /// Whether the scene is moving. If it is, the picture may be drawn at reduced quality.
    pub(crate) moving: bool,
    /// Whether the user allows reduced quality.
    pub(crate) coarse: bool,
    /// The time that a picture may take while the scene is moving.
    pub(crate) budget: Duration,
    /// The samples per pixel that the picture is refined to while nothing happens.
    pub(crate) refined: Option<Samples>,
    /// The pictures of the dial, if it is measured.
    pub(crate) dial: Option<DialWish>,
    /// Whether to explain the effects of the picture.
    pub(crate) explain: bool,
    /// The selected items to outline in the picture. The first has a separate border; the others
    /// share one.
    pub(crate) outlined: Vec<ItemId>,
}

/// Returns a view without what no picture shows: the item that the keys act on, and their steps.
pub(crate) fn pictured(view: &View) -> View {
    View {
        subject: Subject::Object,
        light: None,
        transformation: Transformation::Translation,
        frame: Frame::Local,
        steps: Steps::default(),
        ..view.clone()
    }
}

impl Snapshot {
    /// Returns whether another snapshot differs in more than the time.
    pub(crate) fn differs_from(&self, other: &Self) -> bool {
        let mut shot = other.shot.clone();
        shot.view.time = self.shot.view.time;
        self.shot != shot
    }
}
