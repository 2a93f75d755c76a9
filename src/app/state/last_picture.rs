//! What is known of the last picture: its statistics, its effects, and a pixel that is explained.

use std::sync::Arc;
use std::time::Duration;

use super::State;
use crate::app::drawing::reduction::Reduction;
use crate::app::drawing::viewport_renderer::Drawn;
use marraztu_core::accuracy::{Samples, Settings};
use marraztu_core::base::image::Size;
use marraztu_core::scene::{Scene, View};
use marraztu_lab::cost::{Costs, Explained};
use marraztu_render::{Damage, PixelColor};

/// Statistics of the last picture.
#[derive(Clone, Debug)]
pub struct Statistics {
    /// From the snapshot to the finished picture in memory, on the thread that draws, of the last
    /// picture that differs from the one before.
    pub time: Duration,
    /// The size of the picture.
    pub size: Size,
    /// The number of pictures drawn.
    pub pictures: u64,
    /// Whether the picture of what there is now takes so long that the last one is still shown.
    pub late: bool,
    /// The number of pictures shown in the last second.
    pub rate: u32,
    /// The number of triangles drawn.
    pub triangles: usize,
    /// How its quality is reduced.
    pub reduction: Reduction,
    /// The measured error of that: the root mean square, in steps of a byte.
    pub lost: Option<f64>,
    /// The samples per pixel that it is refined to.
    pub refined: Option<Samples>,
    /// What was redrawn, and why.
    pub changes: Option<Damage>,
}

impl Default for Statistics {
    fn default() -> Self {
        Self {
            time: Duration::ZERO,
            size: Size::new(0, 0),
            pictures: 0,
            late: false,
            rate: 0,
            triangles: 0,
            reduction: Reduction::NONE,
            lost: None,
            refined: None,
            changes: None,
        }
    }
}

impl Statistics {
    /// Records a picture, the `rate`th in the last second.
    pub(crate) fn note(&mut self, drawn: &Drawn, rate: u32) {
        let [width, height] = drawn.image.size;
        // That nothing had to be drawn again tells nothing of how long the picture takes.
        let is_new = self.pictures == 0 || drawn.changes.tiles() > 0;
        *self = Self {
            time: if is_new { drawn.time } else { self.time },
            size: Size::new(width, height),
            pictures: self.pictures + 1,
            late: false,
            rate,
            triangles: drawn.triangles,
            reduction: drawn.reduction,
            lost: drawn.lost,
            refined: drawn.refined,
            changes: Some(drawn.changes.clone()),
        };
    }
}

/// The effects of the last picture.
#[derive(Clone, Debug, Default)]
pub struct Plan {
    /// Its effects.
    pub explained: Option<Arc<Explained>>,
    /// Their costs in time, if measured.
    pub costs: Option<Arc<Measured>>,
    /// Whether it is being measured.
    pub measuring: bool,
}

/// The measured costs of effects, and their picture.
#[derive(Clone, Debug)]
pub struct Measured {
    /// What was measured.
    pub costs: Costs,
    /// What there was to draw.
    pub scene: Scene,
    /// How it was looked at.
    pub view: View,
    /// How exactly it was drawn.
    pub settings: Settings,
}

/// A pixel that is explained, and the picture that it belongs to.
#[derive(Clone, Debug)]
pub struct ExplainedPixel {
    /// Column and row, from the upper left.
    pub at: [usize; 2],
    /// What there is to draw.
    pub scene: Scene,
    /// How it is looked at.
    pub view: View,
    /// How exactly it is drawn.
    pub settings: Settings,
    /// The size of the picture.
    pub size: Size,
    /// The explanation; `None` if the pixel is outside of the picture.
    pub explained: Option<PixelColor>,
}

impl ExplainedPixel {
    /// Whether the picture is still the one that was explained.
    #[must_use]
    pub fn is_of(&self, state: &State, size: Size) -> bool {
        let Self { scene, view, settings, .. } = self;
        self.size == size
            && (settings, view) == (&state.settings, &state.view)
            && *scene == state.scene
    }
}
