//! FLIP: the perceived difference of two pictures when an observer flips between them.
//!
//! The metric is for display values on a screen 0.7 m and 3840 pixels wide, seen from 0.7 m: 67
//! pixels per degree. 0 means equal, 1 is the largest difference.
//!
//! Source: Andersson, Nilsson, Akenine-Moller, Oskarsson, Astrom and Fairchild, "FLIP: A Difference
//! Evaluator for Alternating Images", Proc. ACM Comput. Graph. Interact. Tech. 3(2), 2020, for low
//! dynamic range. All its filters are sums of separable ones, so each runs along rows, then along
//! columns. Borders are extended with the last pixel.

use std::ops::Range;

use libm::{ceil, exp, pow, sqrt};
use rayon::prelude::*;

use marraztu_core::base::color::linear_factors;
use marraztu_core::base::image::{Picture, Size};
use marraztu_render::screen::coverage::PixelBox;

/// Pixels per degree: 0.7 (3840 / 0.7) (pi / 180).
const PIXELS_A_DEGREE: f64 = 3840.0 * std::f64::consts::PI / 180.0;

/// The white point: X, Y and Z of D65.
const WHITE: [f64; 3] = [0.950_428_545, 1.0, 1.088_900_371];

/// Converts linear sRGB to XYZ.
const XYZ_FROM_RGB: [[f64; 3]; 3] = [
    [10_135_552.0 / 24_577_794.0, 8_788_810.0 / 24_577_794.0, 4_435_075.0 / 24_577_794.0],
    [2_613_072.0 / 12_288_897.0, 8_788_810.0 / 12_288_897.0, 887_015.0 / 12_288_897.0],
    [1_425_312.0 / 73_733_382.0, 8_788_810.0 / 73_733_382.0, 70_074_185.0 / 73_733_382.0],
];

/// Converts XYZ to linear sRGB.
const RGB_FROM_XYZ: [[f64; 3]; 3] = [
    [3.241_003_275, -1.537_398_934, -0.498_615_861],
    [-0.969_224_334, 1.875_930_071, 0.041_554_224],
    [0.055_639_423, -0.204_011_202, 1.057_148_933],
];

/// The largest per-pixel FLIP of two pictures that look the same.
///
/// It is the FLIP of two large grey areas whose lightness differs by 2.3, the just noticeable
/// difference of CIELAB: Mahy, Van Eycken and Oosterlinck, "Evaluation of Uniform Color Spaces
/// Developed after the Adoption of CIELAB and CIELUV", Color Research and Application 19(2), 1994.
/// FLIP raises it to the power 0.7 and divides it: (2.3^0.7) 0.95 / (0.4 41.3) = 0.10.
pub const VISIBLE: f64 = 0.1;

/// The part of the metric that depends on one picture only.
#[derive(Debug)]
pub struct Perceived {
    size: Size,
    /// The picture filtered by the eye's contrast sensitivity, in CIELAB with Hunt's adjustment.
    color: Vec<[f64; 3]>,
    /// The strengths of edges and points.
    features: Vec<[f64; 2]>,
}

impl Perceived {
    /// Filters a picture.
    pub fn new(picture: &Picture) -> Self {
        let size = picture.size();
        let opponent: Vec<[f64; 3]> = picture.pixels().par_iter().map(|p| opponent(*p)).collect();
        let plane = |i: usize| -> Vec<f64> { opponent.iter().map(|pixel| pixel[i]).collect() };
        let planes = [plane(0), plane(1), plane(2)];
        let filtered: Vec<Vec<f64>> =
            planes.iter().zip(&SENSITIVITY).map(|(plane, of)| contrast(plane, size, of)).collect();
        let color = (0..size.area())
            .into_par_iter()
            .map(|i| lab([filtered[0][i], filtered[1][i], filtered[2][i]]))
            .collect();
        let bright: Vec<f64> = planes[0].par_iter().map(|y| (y + 16.0) / 116.0).collect();
        Self { size, color, features: features(&bright, size) }
    }

    /// Returns the mean difference to another picture of the same size, from 0 to 1.
    ///
    /// # Panics
    /// If the sizes differ.
    pub fn difference(&self, other: &Self) -> f64 {
        assert_eq!(self.size, other.size, "pictures of one size are compared");
        mean(&self.sums(other, 0..self.size.height, &|_| true), self.size.area())
    }

    /// The distance in pixels up to which a pixel changes the metric of another one.
    pub(crate) const REACH: usize = REACH;

    /// Returns the largest difference of a pixel within a window, from 0 to 1.
    pub(crate) fn largest(&self, other: &Self, window: &PixelBox) -> f64 {
        let (width, most) = (self.size.width, most_color_error());
        let [left, top, right, bottom] = [window.left, window.top, window.right, window.bottom]
            .map(|side| usize::try_from(side).unwrap_or(0));
        let row = |y| y * width + left..y * width + right;
        let of_row = |y| row(y).map(|i| self.at(other, i, most)).fold(0.0, f64::max);
        (top..bottom).into_par_iter().map(of_row).reduce(|| 0.0, f64::max)
    }

    /// Returns the largest difference of any pixel, from 0 to 1.
    pub(crate) fn largest_of_all(&self, other: &Self) -> f64 {
        let [right, bottom] =
            [self.size.width, self.size.height].map(|side| i32::try_from(side).unwrap_or(i32::MAX));
        self.largest(other, &PixelBox { left: 0, top: 0, right, bottom })
    }

    /// Returns the sum of the differences in each of some rows, at the pixels that count. Summation
    /// by rows makes the result independent of the number of threads.
    fn sums(&self, other: &Self, rows: Range<usize>, counts: &Counts<'_>) -> Vec<f64> {
        let (width, most) = (self.size.width, most_color_error());
        let row = |y| (y * width..(y + 1) * width).filter(|i| counts(*i));
        rows.into_par_iter().map(|y| row(y).map(|i| self.at(other, i, most)).sum()).collect()
    }

    fn at(&self, other: &Self, i: usize, most: f64) -> f64 {
        let color = compressed(pow(hyab(self.color[i], other.color[i]), COLOR_EXPONENT), most);
        let (a, b) = (self.features[i], other.features[i]);
        let feature = (a[0] - b[0]).abs().max((a[1] - b[1]).abs());
        let feature = sqrt(feature / std::f64::consts::SQRT_2);
        pow(color, 1.0 - feature)
    }
}

/// Returns the mean difference of two pictures of one size, from 0 to 1, like
/// [`Perceived::difference`]. Filters in bands of rows, so memory grows with the width alone.
///
/// # Panics
/// If the sizes differ.
pub fn difference(a: &Picture, b: &Picture) -> f64 {
    difference_within(a, b, None)
}

/// Works like [`difference`], for the mean over the pixels of a mask, row by row from the top.
///
/// # Panics
/// If the sizes differ, or the mask has fewer pixels.
pub fn difference_within(a: &Picture, b: &Picture, mask: Option<&[bool]>) -> f64 {
    let size = a.size();
    assert_eq!(size, b.size(), "pictures of one size are compared");
    let mut sums = Vec::with_capacity(size.height);
    for top in (0..size.height).step_by(BAND) {
        let bottom = size.height.min(top + BAND);
        let (from, to) = (top.saturating_sub(REACH), size.height.min(bottom + REACH));
        let [a, b] = [a, b].map(|picture| {
            let pixels = picture.pixels()[from * size.width..to * size.width].to_vec();
            let band = Picture::from_pixels(Size::new(size.width, to - from), pixels);
            Perceived::new(&band.expect("whole rows"))
        });
        let counts = |i: usize| mask.is_none_or(|mask| mask[from * size.width + i]);
        sums.extend(a.sums(&b, top - from..bottom - from, &counts));
    }
    let count = mask.map_or(size.area(), |mask| mask.iter().filter(|counts| **counts).count());
    mean(&sums, count)
}

/// Returns whether a pixel counts, by its number.
type Counts<'a> = dyn Fn(usize) -> bool + Sync + 'a;

#[expect(clippy::cast_precision_loss, reason = "pictures have fewer than 2^52 pixels")]
fn mean(sums: &[f64], count: usize) -> f64 {
    sums.iter().sum::<f64>() / count.max(1) as f64
}

/// The rows that are filtered at a time.
const BAND: usize = 256;

/// The largest radius of the filters, in pixels.
const REACH: usize = 10;

/// q_c: the exponent of colour differences.
const COLOR_EXPONENT: f64 = 0.7;

/// The contrast sensitivity of the eye, as a sum of a sqrt(pi / b) exp(-pi^2 x^2 / b), x in
/// degrees.
const SENSITIVITY: [[[f64; 2]; 2]; 3] =
    [[[1.0, 0.0047], [0.0, 1e-5]], [[1.0, 0.0053], [0.0, 1e-5]], [[34.1, 0.04], [13.5, 0.025]]];

fn times(m: [[f64; 3]; 3], v: [f64; 3]) -> [f64; 3] {
    m.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
}

/// Converts a pixel to Y C_x C_z, a linear relative of CIELAB.
fn opponent(pixel: [u8; 4]) -> [f64; 3] {
    let [r, g, b, _] = pixel.map(|byte| linear_factors()[usize::from(byte)]);
    let [x, y, z] = relative(times(XYZ_FROM_RGB, [r, g, b]));
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

fn relative(xyz: [f64; 3]) -> [f64; 3] {
    [xyz[0] / WHITE[0], xyz[1] / WHITE[1], xyz[2] / WHITE[2]]
}

/// Converts Y C_x C_z, clamped to the screen's gamut, to CIELAB with Hunt's adjustment.
fn lab([luminance, cx, cz]: [f64; 3]) -> [f64; 3] {
    let y = (luminance + 16.0) / 116.0;
    let (x, z) = (y + cx / 500.0, y - cz / 200.0);
    let rgb = times(RGB_FROM_XYZ, [x * WHITE[0], y * WHITE[1], z * WHITE[2]]);
    hunt(rgb.map(|c| c.clamp(0.0, 1.0)))
}

fn hunt(rgb: [f64; 3]) -> [f64; 3] {
    const DELTA: f64 = 6.0 / 29.0;
    let f = |t: f64| {
        if t > DELTA * DELTA * DELTA {
            libm::cbrt(t)
        } else {
            t / (3.0 * DELTA * DELTA) + 4.0 / 29.0
        }
    };
    let [x, y, z] = relative(times(XYZ_FROM_RGB, rgb)).map(f);
    let lightness = 116.0 * y - 16.0;
    [lightness, 500.0 * (x - y) * 0.01 * lightness, 200.0 * (y - z) * 0.01 * lightness]
}

/// Returns the HyAB distance, which suits large colour differences better than the Euclidean.
fn hyab(a: [f64; 3], b: [f64; 3]) -> f64 {
    let (da, db) = (a[1] - b[1], a[2] - b[2]);
    (a[0] - b[0]).abs() + sqrt(da * da + db * db)
}

/// Returns the largest colour difference, from green to blue, raised to the exponent.
fn most_color_error() -> f64 {
    pow(hyab(hunt([0.0, 1.0, 0.0]), hunt([0.0, 0.0, 1.0])), COLOR_EXPONENT)
}

/// Maps a colour difference to 0..=1: differences below 0.4 of the largest fill 0.95 of the range.
fn compressed(error: f64, most: f64) -> f64 {
    let (corner, height) = (0.4 * most, 0.95);
    if error < corner {
        height / corner * error
    } else {
        height + (error - corner) / (most - corner) * (1.0 - height)
    }
}

/// Filters a channel by the contrast sensitivity of the eye.
// All channels share the radius of the widest filter, as in the authors' program.
fn contrast(plane: &[f64], size: Size, of: &[[f64; 2]; 2]) -> Vec<f64> {
    use std::f64::consts::PI;
    let radius = ceil(3.0 * sqrt(0.04 / (2.0 * PI * PI)) * PIXELS_A_DEGREE);
    let kernel = |b: f64| {
        taps(radius, |x| {
            let degrees = x / PIXELS_A_DEGREE;
            exp(-PI * PI * degrees * degrees / b)
        })
    };
    let parts: Vec<(f64, Vec<f64>)> =
        of.iter().filter(|[a, _]| *a > 0.0).map(|[a, b]| (a * sqrt(PI / b), kernel(*b))).collect();
    // A 2D Gaussian is the product of two 1D ones, so its sum is the square of theirs.
    let sum: f64 = parts.iter().map(|(a, taps)| a * pow(taps.iter().sum::<f64>(), 2.0)).sum();
    let mut all = vec![0.0; plane.len()];
    for (a, taps) in parts {
        let part = filter(plane, size, &taps, &taps);
        let weight = a / sum;
        all.par_iter_mut().zip(&part).for_each(|(all, part)| *all += weight * part);
    }
    all
}

/// Returns the strengths of edges and points at each pixel.
fn features(bright: &[f64], size: Size) -> Vec<[f64; 2]> {
    let deviation = 0.5 * 0.082 * PIXELS_A_DEGREE;
    let radius = ceil(3.0 * deviation);
    let smooth = |x: f64| exp(-x * x / (2.0 * deviation * deviation));
    // Edges are the first derivative of a Gaussian, points the second.
    let across = taps(radius, smooth);
    let edge = taps(radius, |x| -x * smooth(x));
    let point = taps(radius, |x| (x * x / (deviation * deviation) - 1.0) * smooth(x));
    let weigh = |along: Vec<f64>| {
        // Normalize the positive weights to a sum of 1, and the negative ones to -1.
        let sum: f64 = across.iter().sum();
        let up: f64 = along.iter().filter(|t| **t > 0.0).sum::<f64>() * sum;
        let down: f64 = -along.iter().filter(|t| **t < 0.0).sum::<f64>() * sum;
        along.into_iter().map(|t| if t > 0.0 { t / up } else { t / down }).collect::<Vec<f64>>()
    };
    let length = |along: &[f64]| -> Vec<f64> {
        let x = filter(bright, size, along, &across);
        let y = filter(bright, size, &across, along);
        x.par_iter().zip(&y).map(|(x, y)| sqrt(x * x + y * y)).collect()
    };
    let (edges, points) = (length(&weigh(edge)), length(&weigh(point)));
    edges.into_iter().zip(points).map(|(edge, point)| [edge, point]).collect()
}

/// Samples a function at the integers from -radius to radius.
#[expect(clippy::cast_possible_truncation, reason = "a few pixels")]
fn taps(radius: f64, of: impl Fn(f64) -> f64) -> Vec<f64> {
    let radius = radius as i32;
    (-radius..=radius).map(|x| of(f64::from(x))).collect()
}

/// Runs one filter along rows, then another along columns.
fn filter(plane: &[f64], size: Size, along: &[f64], down: &[f64]) -> Vec<f64> {
    let Size { width, height } = size;
    if size.area() == 0 {
        return Vec::new();
    }
    let radius = along.len() / 2;
    // Rows: extended copies make the borders free of branches.
    let mut rows = vec![0.0; plane.len()];
    rows.par_chunks_mut(width).zip(plane.par_chunks(width)).for_each(|(out, row)| {
        let mut wide = vec![row[0]; radius];
        wide.extend_from_slice(row);
        wide.extend(std::iter::repeat_n(row[width - 1], radius));
        for (i, tap) in along.iter().enumerate() {
            for (out, value) in out.iter_mut().zip(&wide[i..]) {
                *out += tap * value;
            }
        }
    });
    let mut all = vec![0.0; plane.len()];
    // Columns: whole rows are added at a time, which vectorises and stays in cache.
    let radius = down.len() / 2;
    all.par_chunks_mut(width).enumerate().for_each(|(y, out)| {
        for (i, tap) in down.iter().enumerate() {
            let from = (y + i).saturating_sub(radius).min(height - 1);
            for (out, value) in out.iter_mut().zip(&rows[from * width..]) {
                *out += tap * value;
            }
        }
    });
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(side: usize, of: impl Fn(usize, usize) -> [usize; 3]) -> Perceived {
        let pixels = (0..side * side).map(|i| {
            let [r, g, b] = of(i % side, i / side).map(|c| u8::try_from(c % 256).unwrap());
            [r, g, b, 255]
        });
        let size = Size::new(side, side);
        Perceived::new(&Picture::from_pixels(size, pixels.collect()).unwrap())
    }

    fn pattern(x: usize, y: usize) -> [usize; 3] {
        [x * 8, y * 8, x * y]
    }

    /// Returns the same pattern with a changed rectangle and a changed column.
    fn changed(x: usize, y: usize) -> [usize; 3] {
        let [r, g, b] = pattern(x, y);
        match (x, y) {
            (8..16, 8..20) => [255 - r, g, b],
            (24, _) => [r, g + 40, b],
            _ => [r, g, b],
        }
    }

    /// The expected numbers are from the authors' program, `flip_evaluator` 1.7 (LDR), which
    /// computes in f32.
    #[test]
    fn differences_match_the_authors_program() {
        let (a, b) = (picture(32, pattern), picture(32, changed));
        assert!((a.difference(&b) - 0.116_092_6).abs() < 2e-5, "{}", a.difference(&b));
        let most = most_color_error();
        let places = [
            ((8, 8), 0.568_076_8),
            ((12, 14), 0.463_154_1),
            ((24, 5), 0.161_033_7),
            ((20, 20), 0.058_617_2),
            ((31, 31), 0.042_659_3),
            ((16, 9), 0.105_954_4),
        ];
        for ((x, y), expected) in places {
            let got = a.at(&b, y * 32 + x, most);
            assert!((got - expected).abs() < 1e-4, "{x} {y}: {got}");
        }
        let grey = |value| picture(16, move |_, _| [value; 3]);
        assert!((grey(100).difference(&grey(101)) - 0.030_794).abs() < 1e-4);
        assert!((grey(255).difference(&grey(0)) - 0.967_391).abs() < 1e-4);
    }

    #[test]
    fn bands_of_rows_give_the_same_bits_as_the_whole_picture() {
        for height in [0, 9, 2 * BAND, 2 * BAND + 3] {
            let size = Size::new(7, height);
            let [a, b] = [pattern, changed].map(|of| {
                let pixels = (0..size.area()).map(|i| {
                    let [r, g, b] = of(i % 7 * 4, i / 7).map(|c| u8::try_from(c % 256).unwrap());
                    [r, g, b, 255]
                });
                Picture::from_pixels(size, pixels.collect()).unwrap()
            });
            let whole = Perceived::new(&a).difference(&Perceived::new(&b));
            assert_eq!(difference(&a, &b).to_bits(), whole.to_bits(), "{height}");
            assert!(height == 0 || whole > 0.0);
        }
    }

    #[test]
    fn the_difference_within_a_mask_is_the_mean_over_its_pixels() {
        let size = Size::new(7, 2 * BAND + 3);
        let pixels = (0..size.area()).map(|i| [u8::try_from(i % 256).unwrap(), 0, 0, 255]);
        let a = Picture::from_pixels(size, pixels.collect()).unwrap();
        let b = Picture::filled(size, [9, 9, 9, 255]);
        let [mut upper, mut lower] = [vec![false; size.area()], vec![false; size.area()]];
        let (above, below) = (7 * BAND, size.area() - 7 * BAND);
        upper[..above].fill(true);
        lower[above..].fill(true);
        let [upper, lower] = [upper, lower].map(|mask| difference_within(&a, &b, Some(&mask)));
        let whole = difference_within(&a, &b, Some(&vec![true; size.area()]));
        assert_eq!(whole.to_bits(), difference(&a, &b).to_bits());
        let joined = (upper * above as f64 + lower * below as f64) / size.area() as f64;
        assert!(upper != lower && (joined - whole).abs() < 1e-12, "{upper} {lower} {whole}");
    }

    #[test]
    fn a_picture_is_not_different_from_itself_and_green_is_most_different_from_blue() {
        let a = picture(16, pattern);
        assert_eq!(a.difference(&a), 0.0);
        let (green, blue) = (picture(16, |_, _| [0, 255, 0]), picture(16, |_, _| [0, 0, 255]));
        assert!((green.difference(&blue) - 1.0).abs() < 1e-6);
    }
}
