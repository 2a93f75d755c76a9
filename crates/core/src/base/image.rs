//! A picture in memory: the renderer's result, and the texels of a texture.

use std::sync::OnceLock;

use serde::{Deserialize, Serialize};

use super::ByteBounds;
use super::once::get_or_compute;

/// Rows of pixels from the top; each pixel is red, green, blue and alpha, not premultiplied.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Picture {
    width: usize,
    height: usize,
    pixels: Vec<[u8; 4]>,
    derived: Derived,
}

/// Properties of a picture's pixels, computed on first use.
#[derive(Clone, Debug, Default)]
struct Derived {
    found: OnceLock<Found>,
    alphas: OnceLock<ByteBounds>,
    colors: OnceLock<ByteBounds>,
}

#[derive(Clone, Copy, Debug)]
struct Found {
    least: u8,
    /// Whether any alpha is neither 0 nor 255.
    partial: bool,
    /// Whether any pixel is neither black nor white.
    grey: bool,
}

/// Always equal: the properties follow from the pixels, which are compared anyway.
impl PartialEq for Derived {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl Eq for Derived {}

/// The width and height of a picture in pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Size {
    /// The number of pixels in a row.
    pub width: usize,
    /// The number of rows.
    pub height: usize,
}

impl Size {
    /// Creates a size of `width` by `height` pixels.
    pub const fn new(width: usize, height: usize) -> Self {
        Self { width, height }
    }

    /// Returns the number of pixels.
    pub const fn area(self) -> usize {
        self.width * self.height
    }
}

impl Picture {
    /// Creates a picture of one colour.
    pub fn filled(size: Size, pixel: [u8; 4]) -> Self {
        let pixels = vec![pixel; size.area()];
        let derived = Derived::default();
        Self { width: size.width, height: size.height, pixels, derived }
    }

    /// Creates a picture of these pixels, row by row from the top; `None` if their number does not
    /// fit.
    pub fn from_pixels(size: Size, pixels: Vec<[u8; 4]>) -> Option<Self> {
        (pixels.len() == size.area()).then_some(Self {
            width: size.width,
            height: size.height,
            pixels,
            derived: Derived::default(),
        })
    }

    /// Returns width and height.
    pub const fn size(&self) -> Size {
        Size::new(self.width, self.height)
    }

    /// Returns all pixels, row by row from the top.
    pub fn pixels(&self) -> &[[u8; 4]] {
        &self.pixels
    }

    /// Returns all pixels, row by row from the top, without copying them.
    pub fn into_pixels(self) -> Vec<[u8; 4]> {
        self.pixels
    }

    /// Returns all pixels for writing, and drops the properties computed from them.
    pub fn pixels_mut(&mut self) -> &mut [[u8; 4]] {
        self.derived = Derived::default();
        &mut self.pixels
    }

    /// Returns the smallest alpha of all pixels; 255 for an empty picture.
    pub fn least_alpha(&self) -> u8 {
        self.found().least
    }

    /// Returns whether the alpha of any pixel is neither 0 nor 255.
    pub fn has_partial_alpha(&self) -> bool {
        self.found().partial
    }

    /// Returns whether the picture, as an opacity map, has values between transparent and opaque.
    /// Its alpha counts, or its colour if all pixels are opaque.
    pub fn fades(&self) -> bool {
        let Found { least, partial, grey } = self.found();
        if least == 255 { grey } else { partial }
    }

    /// Bounds of the alphas, by columns and rows from the upper left.
    pub fn alpha_bounds(&self) -> &ByteBounds {
        let of = |[_, _, _, alpha]: &[u8; 4]| [*alpha; 2];
        get_or_compute(&self.derived.alphas, || self.bounds(of))
    }

    /// Bounds of the colour components, and so of any mean of them, by columns and rows from the
    /// upper left.
    pub fn color_bounds(&self) -> &ByteBounds {
        let of = |[r, g, b, _]: &[u8; 4]| [*r.min(g).min(b), *r.max(g).max(b)];
        get_or_compute(&self.derived.colors, || self.bounds(of))
    }

    fn bounds(&self, of: impl Fn(&[u8; 4]) -> [u8; 2]) -> ByteBounds {
        ByteBounds::new(self.width, self.pixels.iter().map(of))
    }

    fn found(&self) -> Found {
        let nothing = Found { least: 255, partial: false, grey: false };
        let find = || {
            self.pixels.iter().fold(nothing, |found, [r, g, b, alpha]| {
                let color = [*r, *g, *b];
                Found {
                    least: found.least.min(*alpha),
                    partial: found.partial | (*alpha != 0 && *alpha != 255),
                    grey: found.grey | (color != [0; 3] && color != [255; 3]),
                }
            })
        };
        *get_or_compute(&self.derived.found, find)
    }

    /// Returns the pixel in column `x` of row `y`, both counted from the upper left.
    pub fn pixel(&self, x: usize, y: usize) -> [u8; 4] {
        self.pixels[y * self.width + x]
    }

    /// Gives the picture this size. Its pixels are unspecified afterwards.
    pub fn resize(&mut self, size: Size) {
        (self.width, self.height) = (size.width, size.height);
        self.pixels.resize(size.area(), [0, 0, 0, 255]);
        self.derived = Derived::default();
    }
}
