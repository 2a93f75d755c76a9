//! Chooses the palette of an animation and dithers colours that it lacks.
//!
//! The palette comes from NeuQuant (Dekker, "Kohonen Neural Networks for Optimal Colour
//! Quantization", Network 1994), except that colours of large flat regions are kept exactly. A
//! missing colour is dithered from the two best colours of the palette, with the ordered 8 x 8
//! pattern of Bayer ("An Optimum Method for Two-Level Rendition of Continuous-Tone Pictures", ICC
//! 1973).

use std::collections::{BTreeSet, HashMap};

use color_quant::NeuQuant;

/// The most colours that are counted individually.
const MOST_COUNTED: usize = 1 << 16;

/// Bits per channel in the histogram.
const BITS: u32 = 5;

/// A colour of at least 1 / `FLAT` of all pixels is a flat region.
const FLAT: u64 = 200;

/// The most colours of flat regions.
const MOST_FLAT: usize = 32;

/// Number of pixels in the sample that NeuQuant learns from.
const SAMPLE: f64 = 60_000.0;

/// The colours of all pictures.
#[derive(Debug, Default)]
pub(super) struct Colors {
    pixels: u64,
    counts: HashMap<[u8; 3], u64>,
    /// The number of pixels and the sum of their colours in each cell.
    cells: Vec<(u64, [u64; 3])>,
}

impl Colors {
    /// Counts the colours of a picture. Returns the number of distinct colours, or 257 if there are
    /// more.
    pub(super) fn add(&mut self, pixels: impl Iterator<Item = [u8; 3]>) -> usize {
        self.cells.resize(1 << (3 * BITS), (0, [0; 3]));
        let mut distinct = BTreeSet::new();
        let mut last = None;
        for color in pixels {
            self.pixels += 1;
            let (count, sum) = &mut self.cells[cell(color)];
            *count += 1;
            *sum = std::array::from_fn(|i| sum[i] + u64::from(color[i]));
            // Bounds the memory: colours that appear late are only counted by cell.
            if self.counts.len() < MOST_COUNTED || self.counts.contains_key(&color) {
                *self.counts.entry(color).or_default() += 1;
            }
            // Neighbours are often equal, so the set is searched only when the colour changes.
            if last.replace(color) != Some(color) && distinct.len() <= 256 {
                distinct.insert(color);
            }
        }
        distinct.len()
    }

    /// Returns the colours of flat regions, the most frequent first.
    fn flat(&self) -> Vec<[u8; 3]> {
        let counts = self.counts.iter().map(|(color, count)| (*count, *color));
        let mut flat: Vec<_> = counts.filter(|(count, _)| count * FLAT >= self.pixels).collect();
        flat.sort_unstable_by(|a, b| b.cmp(a));
        flat.into_iter().map(|(_, color)| color).take(MOST_FLAT).collect()
    }

    /// Returns a sample in which each cell is as frequent as the square root of its pixel count.
    /// Small parts of the pictures then get colours, too.
    #[expect(
        clippy::cast_precision_loss,
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "counts of pixels, and shares of a sample"
    )]
    fn sample(&self) -> Vec<u8> {
        let weight = |count: u64| (count as f64).sqrt();
        let cells = || self.cells.iter().filter(|(count, _)| *count > 0);
        let all: f64 = cells().map(|(count, _)| weight(*count)).sum();
        let mut sample = Vec::new();
        for (count, sum) in cells() {
            let [r, g, b] = sum.map(|sum| (sum as f64 / *count as f64).round() as u8);
            let share = (weight(*count) / all * SAMPLE).ceil() as usize;
            sample.extend(std::iter::repeat_n([r, g, b, 255], share).flatten());
        }
        sample
    }
}

/// Returns the histogram cell of a colour.
fn cell(color: [u8; 3]) -> usize {
    color.iter().fold(0, |cell, x| cell << BITS | usize::from(x >> (8 - BITS)))
}

/// The colours of an animation.
#[derive(Debug)]
pub(super) struct Palette {
    pub(super) colors: Vec<[u8; 3]>,
}

impl Palette {
    /// Builds a palette of at most `most` colours.
    pub(super) fn of(colors: &Colors, most: usize) -> Self {
        let mut palette = colors.flat();
        let sample = colors.sample();
        // NeuQuant needs at least 64 colours.
        let learned = NeuQuant::new(1, (most - palette.len()).max(64), &sample).color_map_rgb();
        let (learned, _) = learned.as_chunks::<3>();
        palette.extend(learned.iter().take(most - palette.len()));
        Self { colors: palette }
    }
}

/// Two colours of the palette, and the number of pixels out of 64 that get the second.
type Mix = (u8, u8, u8);

/// Finds the palette index of each pixel.
#[derive(Debug)]
pub(super) struct Dither {
    palette: Palette,
    mixes: HashMap<[u8; 3], Mix>,
}

impl Dither {
    pub(super) fn new(palette: Palette) -> Self {
        Self { palette, mixes: HashMap::new() }
    }

    /// Returns the palette index that a pixel shows.
    pub(super) fn index(&mut self, color: [u8; 3], [x, y]: [usize; 2]) -> u8 {
        let (first, second, share) = match self.mixes.get(&color) {
            Some(mix) => *mix,
            None => {
                let mix = mix(&self.palette.colors, color);
                self.mixes.insert(color, mix);
                mix
            }
        };
        if threshold(x, y) < share { second } else { first }
    }
}

/// Returns the rank of a pixel in the 8 x 8 Bayer pattern, 0 to 63.
fn threshold(x: usize, y: usize) -> u8 {
    // The bits of x ^ y and y, interleaved from the lowest.
    (0..3).fold(0, |sum, bit| {
        let low = (x ^ y) >> bit & 1;
        let high = y >> bit & 1;
        let pair = u8::from(low == 1) << 1 | u8::from(high == 1);
        sum << 2 | pair
    })
}

/// Finds the best mixture of two palette colours. Distant colours make a coarse pattern, so similar
/// ones are preferred.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a share of 64")]
fn mix(palette: &[[u8; 3]], color: [u8; 3]) -> Mix {
    const COARSENESS: f32 = 0.06;
    let float = |color: [u8; 3]| color.map(f32::from);
    let minus = |a: [f32; 3], b: [f32; 3]| [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    let dot = |a: [f32; 3], b: [f32; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let color = float(color);
    let away = |other: &[u8; 3]| {
        let off = minus(color, float(*other));
        dot(off, off)
    };
    // The nearest colour is always one of the two.
    let nearest = (0_u8..=255).zip(palette).min_by(|a, b| away(a.1).total_cmp(&away(b.1)));
    let Some((first, near)) = nearest else { return (0, 0, 0) };
    let mut best = (away(near), first, 0.0);
    let off = minus(color, float(*near));
    // The second minimises the error of the mixture plus a penalty for its contrast.
    for (second, other) in (0_u8..=255).zip(palette) {
        let along = minus(float(*other), float(*near));
        let length = dot(along, along);
        if length == 0.0 {
            continue;
        }
        let share = (dot(off, along) / length).clamp(0.0, 0.5);
        let rest = minus(off, along.map(|x| x * share));
        let cost = dot(rest, rest) + COARSENESS * share * length;
        if cost < best.0 {
            best = (cost, second, share);
        }
    }
    let (_, second, share) = best;
    (first, second, (share * 64.0).round() as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_pattern_has_each_of_64_steps_once() {
        let places = (0..64).map(|i| threshold(i % 8, i / 8));
        assert_eq!(places.collect::<BTreeSet<_>>(), (0..64).collect());
    }

    #[test]
    fn a_mixture_has_the_mean_of_its_colour_and_colours_of_the_palette_stay() {
        let palette = || Palette { colors: vec![[0, 0, 0], [255, 255, 255], [0, 0, 179], [96; 3]] };
        let mut dither = Dither::new(palette());
        let mut shown = |color: [u8; 3]| -> Vec<[u8; 3]> {
            let index = |i: usize| dither.index(color, [i % 8, i / 8]);
            (0..64).map(index).map(|index| palette().colors[usize::from(index)]).collect()
        };
        for color in palette().colors {
            assert!(shown(color).iter().all(|it| *it == color), "{color:?}");
        }
        for grey in [10_u8, 50, 90, 120, 200] {
            let sum: f64 = shown([grey; 3]).iter().map(|it| f64::from(it[0])).sum();
            assert!((sum / 64.0 - f64::from(grey)).abs() < 3.0, "{grey}: {}", sum / 64.0);
        }
    }

    #[test]
    fn flat_colours_are_in_the_palette_and_the_others_are_near() {
        let gradient = |i: u32| {
            let [x, y] = [i % 256, i / 256].map(|x| u8::try_from(x).unwrap());
            if i.is_multiple_of(3) { [0, 0, 179] } else { [x, y, 128] }
        };
        let mut colors = Colors::default();
        assert!(colors.add((0..1 << 16).map(gradient)) > 256);
        let palette = Palette::of(&colors, 255);
        assert!(palette.colors.len() <= 255 && palette.colors.contains(&[0, 0, 179]));
        let mut dither = Dither::new(palette);
        // The mean of each 8 x 8 block is close to the true colour.
        let mut sums = [[0.0; 2]; 2];
        for i in 0..64 {
            let color = [100, 200, 128];
            let shown = dither.index(color, [i % 8, i / 8]);
            let shown = dither.palette.colors[usize::from(shown)];
            for axis in 0..2 {
                sums[axis][0] += f64::from(shown[axis]);
                sums[axis][1] += f64::from(color[axis]);
            }
        }
        assert!(sums.iter().all(|[a, b]| (a - b).abs() < 64.0 * 6.0), "{sums:?}");
    }
}
