//! Triangles that keep their corners from before they were snapped.

use crate::render::screen::coverage::{SUBPIXELS, Snapped};

/// A triangle that is drawn pixel by pixel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct UnsnappedTriangle {
    /// Its corners in subpixels.
    pub(crate) corners: [Snapped; 3],
    /// The same in pixels, before they were snapped.
    pub(crate) pixels: [[f64; 2]; 3],
    pub(crate) depths: [f32; 3],
    /// Its number in the frame.
    pub(crate) number: u32,
    /// Whether it needs the alpha test.
    pub(crate) cutout: bool,
}

impl UnsnappedTriangle {
    /// The triangle relative to a sample with this offset in 1/256 pixel; its corners have `parts`
    /// subpixels per pixel.
    pub(crate) fn seen_from(&self, shift: [i32; 2], parts: i32) -> Self {
        let [x, y] = shift.map(|shift| shift * (parts / SUBPIXELS));
        let [dx, dy] = shift.map(|shift| f64::from(shift) / f64::from(SUBPIXELS));
        Self {
            corners: self.corners.map(|at| Snapped { x: at.x - x, y: at.y - y }),
            pixels: self.pixels.map(|[x, y]| [x - dx, y - dy]),
            ..*self
        }
    }
}
