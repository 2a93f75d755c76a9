//! Blends layers over what is behind them.
//!
//! Colours are those of [`Colors`](super::colors::Colors) in fixed point, units of 2^-16 of a step
//! of a byte, and stay so: a thousand layers are within a hundredth of a step of the true sum.
//!
//! Over: c' = a f + (1 - a) c, with the colour f of the layer and its opacity a, the farthest layer
//! first. Porter and Duff, "Compositing Digital Images", SIGGRAPH 1984. With a = 1 that is f and
//! with a = 0 it is c, bit for bit.
//!
//! Weighted: c' = (sum of w a f) / (sum of w a) (1 - T) + T c, where T is the product of all
//! 1 - a, and w falls with the distance z: equation (9) of McGuire and Bavoil, "Weighted Blended
//! Order-Independent Transparency", JCGT 2(2), 2013, with z in units of view space, whose far plane
//! is between 1024 and 2048 units away. That needs no order, and none may show in the last bit: the
//! terms of all sums are rounded to steps, so that f64 adds up exactly the 1024 layers that are
//! held at once, and T is two to the power of a sum of logarithms.
//!
//! A layer is laid over all pixels of the block at once, with an opacity of 0 wherever it is not.

use fearless_simd::{Level, dispatch};

use crate::render::screen::tiles::BLOCK_PIXELS;

/// A colour of each pixel of a block.
type Rows = [[f32; BLOCK_PIXELS]; 3];

/// The pixels of a block while layers are laid over them.
#[derive(Debug)]
pub(crate) struct Blend {
    colors: Rows,
    layer: Layer,
    /// The sums of a weighted mean, if that is chosen.
    mean: Option<Box<Mean>>,
}

/// The layer that comes next.
#[derive(Debug)]
struct Layer {
    colors: [[u32; BLOCK_PIXELS]; 3],
    opacities: [f32; BLOCK_PIXELS],
}

/// The sums of a weighted mean.
#[derive(Debug)]
struct Mean {
    /// w of the layer that comes next.
    next: [f64; BLOCK_PIXELS],
    /// Its log2(1 - a).
    through: [f64; BLOCK_PIXELS],
    /// The last opacity, and that logarithm of it.
    known: (f32, f64),
    /// The sums of w a f, with f in steps of a byte.
    colors: [[f64; BLOCK_PIXELS]; 3],
    /// Of w a.
    weights: [f64; BLOCK_PIXELS],
    /// Of log2(1 - a).
    logarithms: [f64; BLOCK_PIXELS],
}

impl Default for Blend {
    fn default() -> Self {
        let layer = Layer { colors: [[0; BLOCK_PIXELS]; 3], opacities: [0.0; BLOCK_PIXELS] };
        Self { colors: [[0.0; BLOCK_PIXELS]; 3], layer, mean: None }
    }
}

impl Default for Mean {
    fn default() -> Self {
        let none = [0.0; BLOCK_PIXELS];
        Self {
            next: none,
            through: none,
            known: (0.0, 0.0),
            colors: [none; 3],
            weights: none,
            logarithms: none,
        }
    }
}

/// How layers are blended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Way {
    /// One over another.
    Over,
    /// As a weighted mean.
    Weighted,
}

impl Blend {
    /// Begins with what is behind all layers.
    #[expect(clippy::cast_precision_loss, reason = "below 2^24")]
    pub(crate) fn begin(&mut self, behind: impl Fn(usize) -> [u32; 3], way: Way) {
        for place in 0..BLOCK_PIXELS {
            for (row, part) in self.colors.iter_mut().zip(behind(place)) {
                row[place] = part as f32;
            }
        }
        match way {
            Way::Over => self.mean = None,
            Way::Weighted => **self.mean.get_or_insert_default() = Mean::default(),
        }
    }

    /// Begins a layer, with the distances of its pixels if they matter.
    pub(crate) fn begin_layer(
        &mut self,
        level: Level,
        distances: impl FnOnce() -> [f64; BLOCK_PIXELS],
    ) {
        self.layer.opacities = [0.0; BLOCK_PIXELS];
        if let Some(mean) = &mut self.mean {
            mean.next = distances();
            mean.through = [0.0; BLOCK_PIXELS];
            dispatch!(level, _ => mean.next.iter_mut().for_each(|it| *it = weight(*it)));
        }
    }

    /// Sets the colour of the layer at a pixel.
    #[inline(always)]
    pub(crate) fn put(&mut self, place: usize, color: [u32; 3], opacity: f32) {
        let place = place % BLOCK_PIXELS;
        for (row, part) in self.layer.colors.iter_mut().zip(color) {
            row[place] = part;
        }
        self.layer.opacities[place] = opacity;
        if let Some(mean) = &mut self.mean {
            if mean.known.0.to_bits() != opacity.to_bits() {
                mean.known = (opacity, libm::log2(1.0 - f64::from(opacity)));
            }
            mean.through[place] = mean.known.1;
        }
    }

    /// Lays the layer over what is behind it.
    pub(crate) fn end_layer(&mut self, level: Level) {
        let Self { colors, layer, mean } = self;
        match mean {
            None => dispatch!(level, _ => layer.over(colors)),
            Some(mean) => dispatch!(level, _ => mean.add(layer)),
        }
    }

    /// Ends after the last layer.
    pub(crate) fn end(&mut self, level: Level) {
        if let Some(mean) = &self.mean {
            dispatch!(level, _ => mean.over(&mut self.colors));
        }
    }

    /// The blended colours of a pixel.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "between 0 and 2^24, like what is blended"
    )]
    pub(crate) fn color(&self, place: usize) -> [u32; 3] {
        [0, 1, 2].map(|i: usize| (self.colors[i][place] as u32).min((1 << 24) - 1))
    }
}

impl Layer {
    #[inline(always)]
    #[expect(clippy::cast_precision_loss, reason = "below 2^24")]
    fn over(&self, behind: &mut Rows) {
        for (row, own) in behind.iter_mut().zip(&self.colors) {
            for ((behind, own), opacity) in row.iter_mut().zip(own).zip(&self.opacities) {
                let own = own.cast_signed() as f32;
                *behind = *opacity * own + (1.0 - *opacity) * *behind;
            }
        }
    }
}

/// The steps of the terms of each sum: 2^20 for a w below 2^12 and a colour below 2^8 leaves 2^10
/// terms 53 bits. Adding and taking away 1.5 * 2^52 steps rounds to them.
const fn rounding_to(step: f64) -> f64 {
    1.5 * (1_u64 << 52) as f64 * step
}
const OF_COLORS: f64 = rounding_to(1.0 / (1_u64 << 23) as f64);
const OF_WEIGHTS: f64 = rounding_to(1.0 / (1_u64 << 31) as f64);
const OF_LOGARITHMS: f64 = rounding_to(1.0 / (1_u64 << 38) as f64);

impl Mean {
    #[inline(always)]
    fn add(&mut self, layer: &Layer) {
        let Self { next, through, colors, weights, logarithms, .. } = self;
        for (weight, opacity) in next.iter_mut().zip(&layer.opacities) {
            *weight *= f64::from(*opacity);
        }
        for (row, own) in colors.iter_mut().zip(&layer.colors) {
            for ((sum, own), weight) in row.iter_mut().zip(own).zip(&*next) {
                let term = *weight * (f64::from(own.cast_signed()) * (1.0 / 65_536.0));
                *sum += (term + OF_COLORS) - OF_COLORS;
            }
        }
        for (sum, weight) in weights.iter_mut().zip(next) {
            *sum += (*weight + OF_WEIGHTS) - OF_WEIGHTS;
        }
        for (sum, term) in logarithms.iter_mut().zip(through) {
            *sum += (*term + OF_LOGARITHMS) - OF_LOGARITHMS;
        }
    }

    /// Lays the mean over what is behind all layers.
    #[inline(always)]
    #[expect(clippy::cast_possible_truncation, reason = "the nearest f32 is meant")]
    fn over(&self, behind: &mut Rows) {
        let mut through = self.logarithms;
        through.iter_mut().for_each(|it| *it = power_of_two(*it));
        for (row, colors) in behind.iter_mut().zip(&self.colors) {
            let sums = colors.iter().zip(&self.weights).zip(&through);
            for (behind, ((color, weight), through)) in row.iter_mut().zip(sums) {
                let mean = color / weight.max(f64::MIN_POSITIVE) * 65_536.0;
                let color = mean * (1.0 - through) + f64::from(*behind) * through;
                *behind = if *weight > 0.0 { color as f32 } else { *behind };
            }
        }
    }
}

/// 2^x for x up to 0, to 1e-11 of itself; 0 below 2^-1000. With x = i + f, where i is whole and f
/// at most one half from 0, it is 2^i times the series of e^(f ln 2).
#[inline(always)]
fn power_of_two(x: f64) -> f64 {
    const WHOLE: f64 = rounding_to(1.0);
    let shifted = x.max(-1000.0) + WHOLE;
    let y = (x.max(-1000.0) - (shifted - WHOLE)) * std::f64::consts::LN_2;
    let mut series = 1.0;
    for k in [9.0, 8.0, 7.0, 6.0, 5.0, 4.0, 3.0, 2.0, 1.0] {
        series = 1.0 + y / k * series;
    }
    // The lowest bits of the sum are those of i.
    let power = (shifted.to_bits() << 52).wrapping_add(1023 << 52);
    let power = f64::from_bits(power) * series;
    if x < -1000.0 { 0.0 } else { power }
}

/// w = max(0.01, min(3000, 0.03 / (1e-5 + (z / 200)^4)))
#[inline(always)]
fn weight(z: f64) -> f64 {
    let square = (z / 200.0) * (z / 200.0);
    (0.03 / (1e-5 + square * square)).clamp(0.01, 3000.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A byte in fixed point.
    const fn parts(byte: u32) -> u32 {
        (byte << 16) + (1 << 15)
    }

    fn blended(way: Way, layers: &[(u32, f32)]) -> u32 {
        let mut blend = Blend::default();
        blend.begin(|_| [parts(100); 3], way);
        for (color, opacity) in layers {
            blend.begin_layer(Level::new(), || [50.0; BLOCK_PIXELS]);
            blend.put(9, [parts(*color); 3], *opacity);
            blend.end_layer(Level::new());
        }
        blend.end(Level::new());
        // Pixels without any layer are what is behind.
        assert_eq!(blend.color(8), [parts(100); 3]);
        blend.color(9)[1]
    }

    #[test]
    fn opacity_0_and_1_leave_and_replace_every_bit() {
        for color in [0, 1, 100, 254, 255] {
            assert_eq!(blended(Way::Over, &[(color, 1.0)]), parts(color));
            assert_eq!(blended(Way::Over, &[(color, 0.0)]), parts(100));
            assert_eq!(blended(Way::Weighted, &[(color, 0.0)]), parts(100));
        }
    }

    #[test]
    fn one_layer_is_the_same_in_both_ways_and_two_are_not() {
        for opacity in [0.125, 0.5, 0.9] {
            let [over, mean] =
                [Way::Over, Way::Weighted].map(|way| blended(way, &[(200, opacity)]));
            assert!(over.abs_diff(mean) <= 2, "{over} {mean}");
        }
        let layers = [(0, 0.5), (255, 0.5)];
        // 0.5 * 255 + 0.25 * 0 + 0.25 * 100, and 127.5 * 0.75 + 25.
        assert_eq!(blended(Way::Over, &layers) >> 16, 153);
        assert_eq!(blended(Way::Weighted, &layers) >> 16, 121);
    }

    #[test]
    fn a_weighted_mean_has_the_same_bits_in_every_order() {
        let mut rng = crate::base::rng::Rng::new(3);
        let any = |rng: &mut crate::base::rng::Rng| {
            let opacity = rng.one_of(&[0.004, 0.3, 0.5, 0.97, 1.0]) as f32;
            (rng.index(256) as u32, opacity, rng.real(0.0, 600.0))
        };
        for count in [2, 3, 10, 1024] {
            let mut layers: Vec<(u32, f32, f64)> = (0..count).map(|_| any(&mut rng)).collect();
            let mean = |layers: &[(u32, f32, f64)]| {
                let mut blend = Blend::default();
                blend.begin(|_| [parts(100); 3], Way::Weighted);
                for (color, opacity, z) in layers {
                    blend.begin_layer(Level::new(), || [*z; BLOCK_PIXELS]);
                    blend.put(9, [parts(*color), *color, 0], *opacity);
                    blend.end_layer(Level::new());
                }
                let mean = blend.mean.as_ref().unwrap();
                let sums = [mean.colors[0][9], mean.weights[9], mean.logarithms[9]];
                (sums.map(f64::to_bits), {
                    blend.end(Level::new());
                    blend.color(9)
                })
            };
            let first = mean(&layers);
            for _ in 0..20 {
                for i in (1..layers.len()).rev() {
                    layers.swap(i, rng.index(i + 1));
                }
                assert_eq!(mean(&layers), first, "{count}");
            }
        }
    }

    #[test]
    fn powers_of_two_are_within_their_bound() {
        for i in 0..200_000 {
            let x = -1e-4 * f64::from(i);
            let (own, exact) = (power_of_two(x), libm::exp2(x));
            assert!((own - exact).abs() <= 1e-11 * exact, "{x}: {own} {exact}");
        }
        assert_eq!([power_of_two(0.0), power_of_two(f64::NEG_INFINITY)], [1.0, 0.0]);
    }

    #[test]
    fn the_weight_is_that_of_the_paper() {
        // 0.03 / (1e-5 + 1), at its largest and at its least.
        assert!((weight(200.0) - 0.029_999_7).abs() < 1e-7);
        assert!((weight(0.0) - 3000.0).abs() < 1e-9 && weight(500.0) == 0.01);
    }
}
