//! The error of a picture against its reference.
//!
//! Colours are compared at pixels that show the same primitive in both pictures. At the others,
//! colours say nothing about how light was computed: these pixels are counted as coverage. If the
//! reference has several samples per pixel, a pixel may show several primitives, and every pixel is
//! compared.

use serde::Serialize;

use super::flip::Perceived;
use crate::base::image::Picture;

/// A picture with the primitives that it shows.
#[derive(Debug)]
pub struct Rendering {
    picture: Picture,
    /// The primitive that each pixel shows.
    primitives: Vec<u32>,
    /// Whether a pixel may show several.
    mixed: bool,
    seen: Perceived,
}

/// The error of a picture against its reference.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Error {
    /// The largest difference of a byte.
    pub largest: u8,
    /// The root of the mean square of the differences of bytes.
    pub rmse: f64,
    /// 20 log10(255 / rmse), in decibels; `None` if no byte differs.
    pub psnr: Option<f64>,
    /// The part of the bytes that differ.
    pub differing: f64,
    /// The number of pixels whose coverage differs: they show another triangle, line or background.
    pub coverage: usize,
    /// How different the pictures look, from 0 to 1, over all pixels.
    pub flip: f64,
}

/// An error metric: one number for an error.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Measure {
    /// The root mean square difference, in byte steps.
    #[default]
    Rmse,
    /// The largest difference, in byte steps.
    Largest,
    /// The part of the bytes that differ.
    Differing,
    /// FLIP: how different it looks.
    Flip,
}

impl Measure {
    /// All metrics.
    pub const ALL: [Self; 4] = [Self::Rmse, Self::Largest, Self::Differing, Self::Flip];

    /// Its word on the command line.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Rmse => "rmse",
            Self::Largest => "largest",
            Self::Differing => "differing",
            Self::Flip => "flip",
        }
    }

    /// Its label at an axis of a plot.
    #[must_use]
    pub const fn label(self) -> &'static str {
        match self {
            Self::Rmse => "RMSE in byte steps",
            Self::Largest => "largest error in byte steps",
            Self::Differing => "part of the bytes that differ",
            Self::Flip => "FLIP, 0 to 1",
        }
    }

    /// The metric's value for an error.
    #[must_use]
    pub fn of(self, error: &Error) -> f64 {
        match self {
            Self::Rmse => error.rmse,
            Self::Largest => f64::from(error.largest),
            Self::Differing => error.differing,
            Self::Flip => error.flip,
        }
    }
}

impl Rendering {
    /// A picture with the primitive that each of its pixels shows.
    #[must_use]
    pub fn new(picture: Picture, primitives: Vec<u32>) -> Self {
        assert_eq!(picture.pixels().len(), primitives.len(), "every pixel shows something");
        let seen = Perceived::new(&picture);
        Self { picture, primitives, mixed: false, seen }
    }

    /// The same with several samples per pixel, so that each pixel may show several primitives.
    #[must_use]
    pub fn mixed(self) -> Self {
        Self { mixed: true, ..self }
    }

    /// The picture.
    #[must_use]
    pub const fn picture(&self) -> &Picture {
        &self.picture
    }

    /// The error of this picture against a reference.
    #[must_use]
    #[expect(clippy::cast_precision_loss, reason = "pictures have fewer than 2^52 bytes")]
    pub fn error(&self, reference: &Self) -> Error {
        let (mut largest, mut squares, mut differing, mut alike) = (0, 0_u64, 0_usize, 0_usize);
        let pixels = self.picture.pixels().iter().zip(reference.picture.pixels());
        let primitives = self.primitives.iter().zip(&reference.primitives);
        let judged = |a: &u32, b: &u32| reference.mixed || a == b;
        for ((a, b), _) in pixels.zip(primitives).filter(|(_, (a, b))| judged(a, b)) {
            alike += 3;
            for step in (0..3).map(|i| a[i].abs_diff(b[i])) {
                largest = largest.max(step);
                squares += u64::from(step) * u64::from(step);
                differing += usize::from(step != 0);
            }
        }
        let rmse = libm::sqrt(squares as f64 / alike.max(1) as f64);
        Error {
            largest,
            rmse,
            psnr: (squares != 0).then(|| 20.0 * libm::log10(255.0 / rmse)),
            differing: differing as f64 / alike.max(1) as f64,
            coverage: self.primitives.len() - alike / 3,
            flip: self.seen.difference(&reference.seen),
        }
    }
}

/// The differences of two pictures of one size, each byte times `factor`.
#[must_use]
pub fn amplified(a: &Picture, b: &Picture, factor: u16) -> Picture {
    let difference = |a: u8, b: u8| {
        u8::try_from(u32::from(a.abs_diff(b)) * u32::from(factor)).unwrap_or(u8::MAX)
    };
    let pixels = a.pixels().iter().zip(b.pixels()).map(|(a, b)| {
        [difference(a[0], b[0]), difference(a[1], b[1]), difference(a[2], b[2]), 255]
    });
    Picture::from_pixels(a.size(), pixels.collect()).expect("pictures of one size are compared")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::image::Size;

    fn rendering(pixels: [[u8; 4]; 4], primitives: [u32; 4]) -> Rendering {
        let picture = Picture::from_pixels(Size::new(2, 2), pixels.to_vec()).unwrap();
        Rendering::new(picture, primitives.to_vec())
    }

    const PIXELS: [[u8; 4]; 4] =
        [[10, 20, 30, 255], [0, 0, 0, 255], [255, 255, 255, 255], [7, 7, 7, 255]];

    /// By hand: of the three pixels that show the same primitive, two bytes of nine differ, by 3
    /// and by 4, so the mean square is 25/9.
    #[test]
    fn an_error_is_counted_by_hand_and_coverage_apart_from_it() {
        let reference = rendering(PIXELS, [1, 0, 2, 2]);
        let mut pixels = PIXELS;
        pixels[0][1] = 23;
        pixels[2][2] = 251;
        pixels[3] = [200, 0, 0, 255];
        let error = rendering(pixels, [1, 0, 2, 1]).error(&reference);
        assert_eq!((error.largest, error.coverage), (4, 1));
        assert!((error.rmse - 5.0 / 3.0).abs() < 1e-12);
        assert!((error.differing - 2.0 / 9.0).abs() < 1e-12);
        // 20 log10(255 / (5/3)) = 20 log10(153)
        assert!((error.psnr.unwrap() - 43.693_828_6).abs() < 1e-6);
        assert!(error.flip > 0.0);
    }

    #[test]
    fn against_several_samples_every_pixel_is_judged() {
        let reference = rendering(PIXELS, [1, 0, 2, 2]).mixed();
        let mut pixels = PIXELS;
        pixels[3] = [7, 7, 8, 255];
        let error = rendering(pixels, [1, 0, 2, 1]).error(&reference);
        assert_eq!((error.largest, error.coverage), (1, 0));
        assert!((error.differing - 1.0 / 12.0).abs() < 1e-12);
    }

    #[test]
    fn a_picture_has_no_error_against_itself() {
        let reference = rendering(PIXELS, [1, 0, 2, 2]);
        let error = reference.error(&reference);
        let none =
            Error { largest: 0, rmse: 0.0, psnr: None, differing: 0.0, coverage: 0, flip: 0.0 };
        assert_eq!(error, none);
    }

    #[test]
    fn a_difference_is_amplified_and_ends_at_white() {
        let a = Picture::from_pixels(Size::new(1, 1), vec![[10, 20, 30, 255]]).unwrap();
        let b = Picture::from_pixels(Size::new(1, 1), vec![[12, 19, 30, 0]]).unwrap();
        assert_eq!(amplified(&a, &b, 1).pixel(0, 0), [2, 1, 0, 255]);
        assert_eq!(amplified(&a, &b, 16).pixel(0, 0), [32, 16, 0, 255]);
        assert_eq!(amplified(&b, &a, 256).pixel(0, 0), [255, 255, 0, 255]);
    }
}
