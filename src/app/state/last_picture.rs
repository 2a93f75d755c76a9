//! Information about the last picture: its statistics, its effects, and the explanation of a pixel.

use std::sync::Arc;
use std::time::Duration;

use crate::app::drawing::reduction::Reduction;
use crate::app::drawing::viewport_renderer::Drawn;
use marraztu_core::accuracy::{Samples, Shot};
use marraztu_core::base::image::Size;
use marraztu_lab::cost::{Costs, Explained};
use marraztu_render::{Damage, PixelColor};

/// Statistics of the last picture.
#[derive(Clone, Debug, Default)]
pub struct Statistics {
    /// The time from the snapshot to the finished picture in memory, on the drawing thread, of the
    /// last picture that differs from the one before.
    pub time: Duration,
    /// The size of the picture.
    pub size: Size,
    /// The number of pictures drawn.
    pub pictures: u64,
    /// The next picture, if it takes so long that this one is out of date.
    pub late: Option<Late>,
    /// The number of pictures shown in the last second.
    pub rate: u32,
    /// The number of triangles drawn.
    pub triangles: usize,
    /// The reduction of its quality.
    pub reduction: Reduction,
    /// The measured error of that reduction: the root mean square, in steps of a byte.
    pub lost: Option<f64>,
    /// The samples per pixel after refinement.
    pub refined: Option<Samples>,
    /// The parts that were redrawn, and why.
    pub changes: Option<Damage>,
}

/// A picture that takes long.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Late {
    /// The time since it was requested.
    pub spent: Duration,
    /// The finished fraction, if it is known.
    pub fraction: Option<f64>,
}

impl Late {
    /// Describes the progress: "34%, about 12 s left". The time left is known after a while.
    pub fn in_words(&self) -> String {
        let Some(fraction) = self.fraction else { return "...".to_owned() };
        let percent = format!("{:.0}%", fraction * 100.0);
        let left = self.spent.as_secs_f64() * (1.0 - fraction) / fraction;
        match self.spent >= Self::TOLD {
            true if left >= 100.0 => format!("{percent}, about {:.0} minutes left", left / 60.0),
            true => format!("{percent}, about {:.0} s left", left.ceil()),
            false => percent,
        }
    }

    /// The time after which the time left is known.
    const TOLD: Duration = Duration::from_secs(1);
}

impl Statistics {
    /// Records a picture, the `rate`th in the last second.
    pub(crate) fn note(&mut self, drawn: &Drawn, rate: u32) {
        let [width, height] = drawn.image.size;
        // A picture without redrawn tiles says nothing about the time that a picture takes.
        let is_new = self.pictures == 0 || drawn.changes.tiles() > 0;
        *self = Self {
            time: if is_new { drawn.time } else { self.time },
            size: Size::new(width, height),
            pictures: self.pictures + 1,
            late: None,
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
    /// Their measured costs in time, if any.
    pub costs: Option<Arc<Measured>>,
    /// Whether a measurement is running.
    pub measuring: bool,
}

/// The measured costs of effects, with the picture that was measured.
#[derive(Clone, Debug)]
pub struct Measured {
    /// The costs.
    pub costs: Costs,
    /// The picture.
    pub of: Shot,
}

/// The explanation of a pixel, and the picture that the pixel belongs to.
#[derive(Clone, Debug)]
pub struct ExplainedPixel {
    /// Column and row, from the upper left.
    pub at: [usize; 2],
    /// The picture.
    pub shot: Shot,
    /// The explanation; `None` if the pixel is outside of the picture.
    pub explained: Option<PixelColor>,
}
