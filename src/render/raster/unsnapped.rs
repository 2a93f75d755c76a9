//! Triangles that keep their corners as they were before they were snapped.

use crate::render::screen::coverage::{SUBPIXELS, Snapped};

/// A triangle that is drawn pixel by pixel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct UnsnappedTriangle {
    /// Its corners in parts of a pixel.
    pub(crate) corners: [Snapped; 3],
    /// The same in pixels, before they were snapped.
    pub(crate) pixels: [[f64; 2]; 3],
    pub(crate) depths: [f32; 3],
    /// Its number in the frame.
    pub(crate) number: u32,
    /// Whether its texture decides where it is drawn.
    pub(crate) cutout: bool,
}

impl UnsnappedTriangle {
    /// The same as a place sees it that lies so many 256th parts of a pixel from a pixel's middle,
    /// where pixels have `parts`.
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
