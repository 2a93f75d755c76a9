//! The error of a picture against its reference.
//!
//! All pixels count. A pixel that shows a different triangle is an error like any other, and is
//! also counted separately. A second set of figures covers only pixels with equal coverage: it
//! measures shading without the errors along edges. With several samples, a pixel may show several
//! primitives, so both sets are equal.

use serde::{Deserialize, Serialize};

use super::flip::Perceived;
use super::lost::{PixelSurface, flat_surface, lost};
use marraztu_core::base::image::Picture;

/// A picture with the primitive at each pixel.
#[derive(Debug)]
pub struct Rendering {
    picture: Picture,
    /// The primitive at each pixel.
    primitives: Vec<u32>,
    /// The surface at each pixel.
    surfaces: Vec<PixelSurface>,
    /// Whether pixels may show several primitives.
    mixed: bool,
    seen: Perceived,
}

/// The error of a picture against its reference.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Error {
    /// The byte differences over all pixels.
    #[serde(flatten)]
    pub whole: Figures,
    /// The byte differences over pixels with equal coverage.
    pub inside: Figures,
    /// The number of pixels that show a different triangle, line or background.
    pub coverage: usize,
    /// The perceived difference over all pixels, from 0 to 1.
    pub flip: f64,
    /// The part of the reference's surfaces that the picture lacks, from 0 to 1.
    #[serde(default)]
    pub lost: f64,
}

/// The smallest part of the surfaces that makes a picture incomplete.
const INCOMPLETE: f64 = 0.05;

/// Statistics of the byte differences of two pictures.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Figures {
    /// The largest difference.
    pub largest: u8,
    /// The root mean square of the differences.
    pub rmse: f64,
    /// 20 log10(255 / rmse), in decibels; `None` if no byte differs.
    pub psnr: Option<f64>,
    /// The fraction of bytes that differ.
    pub differing: f64,
}

/// The pixels that figures cover.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Region {
    /// All pixels.
    #[default]
    Whole,
    /// The pixels with equal coverage.
    Inside,
}

impl Region {
    /// Returns the addition to the label of a metric.
    pub const fn note(self) -> &'static str {
        match self {
            Self::Whole => "",
            Self::Inside => ", pixels with equal coverage",
        }
    }
}

impl Error {
    /// Returns whether the picture lacks surfaces that its reference shows. Its time is then no
    /// gain.
    pub fn is_incomplete(&self) -> bool {
        self.lost >= INCOMPLETE
    }

    /// Returns the figures over a region.
    pub const fn over(&self, region: Region) -> &Figures {
        match region {
            Region::Whole => &self.whole,
            Region::Inside => &self.inside,
        }
    }
}

/// An error metric: one number for an error.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Measure {
    /// The root mean square difference, in byte steps.
    #[default]
    Rmse,
    /// The largest difference, in byte steps.
    Largest,
    /// The fraction of bytes that differ.
    Differing,
    /// The perceived difference by FLIP.
    Flip,
}

impl Measure {
    /// All metrics.
    pub const ALL: [Self; 4] = [Self::Rmse, Self::Largest, Self::Differing, Self::Flip];

    /// Returns the name on the command line.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Rmse => "rmse",
            Self::Largest => "largest",
            Self::Differing => "differing",
            Self::Flip => "flip",
        }
    }

    /// Returns the label at a plot axis.
    pub const fn label(self) -> &'static str {
        match self {
            Self::Rmse => "RMSE in byte steps",
            Self::Largest => "largest error in byte steps",
            Self::Differing => "fraction of the bytes that differ",
            Self::Flip => "FLIP, 0 to 1",
        }
    }

    /// Returns the metric's value for an error. FLIP always covers all pixels.
    pub fn of(self, error: &Error, region: Region) -> f64 {
        let figures = error.over(region);
        match self {
            Self::Rmse => figures.rmse,
            Self::Largest => f64::from(figures.largest),
            Self::Differing => figures.differing,
            Self::Flip => error.flip,
        }
    }
}

impl Rendering {
    /// Combines a picture with the primitive at each pixel.
    pub fn new(picture: Picture, primitives: Vec<u32>) -> Self {
        assert_eq!(picture.pixels().len(), primitives.len(), "every pixel shows something");
        let seen = Perceived::new(&picture);
        let surfaces = flat_surface(&primitives);
        Self { picture, primitives, surfaces, mixed: false, seen }
    }

    /// Adds the surface at each pixel; without them, all primitives are of one flat surface.
    #[must_use]
    pub fn of_surfaces(self, surfaces: Vec<PixelSurface>) -> Self {
        assert_eq!(surfaces.len(), self.primitives.len(), "every pixel shows something");
        Self { surfaces, ..self }
    }

    /// Marks that each pixel has several samples, and may show several primitives.
    #[must_use]
    pub fn mixed(self) -> Self {
        Self { mixed: true, ..self }
    }

    /// The picture.
    pub const fn picture(&self) -> &Picture {
        &self.picture
    }

    /// Computes the error of this picture against a reference.
    pub fn error(&self, reference: &Self) -> Error {
        let (mut whole, mut inside) = (Sum::default(), Sum::default());
        let pixels = self.picture.pixels().iter().zip(reference.picture.pixels());
        let primitives = self.primitives.iter().zip(&reference.primitives);
        for ((a, b), (shown, exact)) in pixels.zip(primitives) {
            // Alpha is not compared.
            let steps = [0, 1, 2].map(|i| a[i].abs_diff(b[i]));
            whole.add(steps);
            if reference.mixed || shown == exact {
                inside.add(steps);
            }
        }
        Error {
            whole: whole.figures(),
            inside: inside.figures(),
            coverage: whole.pixels - inside.pixels,
            flip: self.seen.difference(&reference.seen),
            lost: lost(&self.surfaces, &reference.surfaces, self.picture.size().width),
        }
    }

    /// Computes the byte differences between this picture and another.
    pub fn change(&self, other: &Self) -> Figures {
        let mut sum = Sum::default();
        for (a, b) in self.picture.pixels().iter().zip(other.picture.pixels()) {
            sum.add([0, 1, 2].map(|i| a[i].abs_diff(b[i])));
        }
        sum.figures()
    }
}

/// Running sums for figures.
#[derive(Clone, Copy, Debug, Default)]
struct Sum {
    pixels: usize,
    largest: u8,
    squares: u64,
    differing: usize,
}

impl Sum {
    fn add(&mut self, steps: [u8; 3]) {
        self.pixels += 1;
        for step in steps {
            self.largest = self.largest.max(step);
            self.squares += u64::from(step) * u64::from(step);
            self.differing += usize::from(step != 0);
        }
    }

    #[expect(clippy::cast_precision_loss, reason = "pictures have fewer than 2^52 bytes")]
    fn figures(&self) -> Figures {
        let bytes = (3 * self.pixels).max(1) as f64;
        let rmse = libm::sqrt(self.squares as f64 / bytes);
        Figures {
            largest: self.largest,
            rmse,
            psnr: (self.squares != 0).then(|| 20.0 * libm::log10(255.0 / rmse)),
            differing: self.differing as f64 / bytes,
        }
    }
}

/// Returns the absolute difference of two equally sized pictures, times `factor`.
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
    use marraztu_core::base::image::Size;

    fn rendering(pixels: [[u8; 4]; 4], primitives: [u32; 4]) -> Rendering {
        let picture = Picture::from_pixels(Size::new(2, 2), pixels.to_vec()).unwrap();
        Rendering::new(picture, primitives.to_vec())
    }

    const PIXELS: [[u8; 4]; 4] =
        [[10, 20, 30, 255], [0, 0, 0, 255], [255, 255, 255, 255], [7, 7, 7, 255]];

    /// By hand: three of twelve bytes differ, by 3, 4 and 193; in pixels with the same primitive,
    /// two of nine.
    #[test]
    fn an_error_is_counted_by_hand_over_all_pixels_and_inside() {
        let reference = rendering(PIXELS, [1, 0, 2, 2]);
        let mut pixels = PIXELS;
        pixels[0][1] = 23;
        pixels[2][2] = 251;
        pixels[3] = [200, 7, 7, 255];
        let error = rendering(pixels, [1, 0, 2, 1]).error(&reference);
        assert_eq!((error.whole.largest, error.inside.largest, error.coverage), (193, 4, 1));
        assert!((error.whole.rmse - libm::sqrt((9.0 + 16.0 + 193.0 * 193.0) / 12.0)).abs() < 1e-12);
        assert!((error.inside.rmse - 5.0 / 3.0).abs() < 1e-12);
        assert!((error.whole.differing - 0.25).abs() < 1e-12);
        assert!((error.inside.differing - 2.0 / 9.0).abs() < 1e-12);
        // 20 log10(255 / (5/3)) = 20 log10(153)
        assert!((error.inside.psnr.unwrap() - 43.693_828_6).abs() < 1e-6);
        assert!(error.flip > 0.0);
        let values = |region| Measure::ALL.map(|measure| measure.of(&error, region));
        assert!(values(Region::Whole)[0] > values(Region::Inside)[0]);
        assert_eq!(values(Region::Whole)[3], values(Region::Inside)[3]);
    }

    #[test]
    fn against_several_samples_every_pixel_is_inside() {
        let reference = rendering(PIXELS, [1, 0, 2, 2]).mixed();
        let mut pixels = PIXELS;
        pixels[3] = [7, 7, 8, 255];
        let error = rendering(pixels, [1, 0, 2, 1]).error(&reference);
        assert_eq!((error.whole.largest, error.coverage), (1, 0));
        assert_eq!(error.whole, error.inside);
        assert!((error.whole.differing - 1.0 / 12.0).abs() < 1e-12);
    }

    #[test]
    fn a_picture_has_no_error_against_itself() {
        let reference = rendering(PIXELS, [1, 0, 2, 2]);
        let error = reference.error(&reference);
        let none = Figures { largest: 0, rmse: 0.0, psnr: None, differing: 0.0 };
        assert_eq!(error, Error { whole: none, inside: none, coverage: 0, flip: 0.0, lost: 0.0 });
        assert_eq!(reference.change(&reference), none);
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
