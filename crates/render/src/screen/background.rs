//! What a picture shows behind all surfaces.

use glam::DVec3;

use super::coverage::SUBPIXELS;
use crate::frame::panorama::light_of;
use crate::frame::{Eye, FramePlan};
use marraztu_core::base::color::{Color, byte, encoded};

/// What a picture shows where no surface is.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Background<'a> {
    /// The same everywhere.
    Even(Color),
    /// The panoramas of a plan that are shown, added up.
    Panoramas(&'a FramePlan),
}

impl FramePlan {
    /// Returns what the picture shows behind all surfaces.
    #[inline]
    pub(crate) fn behind(&self) -> Background<'_> {
        match self.panoramas.iter().any(|panorama| panorama.is_shown) {
            true => Background::Panoramas(self),
            false => Background::Even(self.background),
        }
    }

    /// Returns the direction of view through a pixel, in view space.
    fn direction_through(&self, [x, y]: [i32; 2]) -> DVec3 {
        let m = &self.clip_from_view;
        if self.eye == Eye::Parallel {
            return DVec3::NEG_Z;
        }
        // All samples of a pixel show the background in its middle; windows shift by whole pixels.
        let within = |at: i32, shift: i32| {
            f64::from(at) + 0.5 + f64::from((shift + SUBPIXELS / 2).div_euclid(SUBPIXELS))
        };
        let right = 2.0 * within(x, self.shift[0]) / self.viewport.width - 1.0;
        let up = 1.0 - 2.0 * within(y, self.shift[1]) / self.viewport.height;
        // At the distance 1, w is 1.
        let y = (up + m.z_axis.y) / m.y_axis.y;
        let x = (right + m.z_axis.x - m.y_axis.x * y) / m.x_axis.x;
        DVec3::new(x, y, -1.0)
    }
}

impl Background<'_> {
    /// Returns the colour, if it is the same everywhere.
    #[inline]
    pub(crate) const fn even(&self) -> Option<Color> {
        match self {
            Self::Even(color) => Some(*color),
            Self::Panoramas(_) => None,
        }
    }

    /// Returns the colour at a pixel.
    #[inline]
    pub(crate) fn at(&self, pixel: [i32; 2]) -> [u8; 4] {
        match self {
            Self::Even(color) => color.opaque(),
            Self::Panoramas(plan) => panoramas_at(plan, pixel),
        }
    }
}

fn panoramas_at(plan: &FramePlan, pixel: [i32; 2]) -> [u8; 4] {
    let towards = plan.direction_through(pixel);
    // A pixel beside the axis is seen at a smaller angle, and in parallel at none.
    let width = match plan.eye {
        Eye::Point => plan.pixel_size() / towards.length_squared(),
        Eye::Parallel => 0.0,
    };
    let shown = plan.panoramas.iter().filter(|panorama| panorama.is_shown);
    let light = light_of(shown, towards, width);
    let is_linear = plan.shading_mode().is_linear();
    let [r, g, b] = if is_linear { light.map(encoded) } else { light }.map(byte);
    [r, g, b, u8::MAX]
}
