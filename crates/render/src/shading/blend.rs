//! Alpha blending: blends layers over the surface behind them.
//!
//! Colours have the fixed-point format of [`Colors`](super::colors::Colors), units of 2^-16 of a
//! step of a byte, and keep it: after a thousand layers the error is below a hundredth of a step.
//!
//! Over: c' = a f + (1 - a) c, with the layer's colour f and opacity a, the farthest layer first.
//! Porter and Duff, "Compositing Digital Images", SIGGRAPH 1984. The result is f for a = 1 and c
//! for a = 0, bit for bit.
//!
//! Weighted: c' = (sum of w a f) / (sum of w a) (1 - T) + T c, where T is the product of all 1 - a,
//! and w falls with the distance z: equation (9) of McGuire and Bavoil, "Weighted Blended
//! Order-Independent Transparency", JCGT 2(2), 2013. z is in units of view space, which has its far
//! plane between 1024 and 2048 units away.

use crate::simd::dispatch;
use fearless_simd::Level;

use crate::screen::tiles::BLOCK_PIXELS;
use marraztu_core::accuracy::Transparency;

/// A colour for each pixel of a block.
type Rows = [[f32; BLOCK_PIXELS]; 3];

/// The pixels of a block while layers are blended over them.
#[derive(Debug)]
pub(crate) struct Blend {
    colors: Rows,
    /// The sums of a weighted mean, if weighted blending is selected.
    mean: Option<Box<Mean>>,
}

/// The sums of a weighted mean.
#[derive(Debug)]
struct Mean {
    /// The weight w of the next layer.
    next: [f64; BLOCK_PIXELS],
    /// The sum of w a f.
    colors: [[f64; BLOCK_PIXELS]; 3],
    /// The sum of w a.
    weights: [f64; BLOCK_PIXELS],
    /// T: the transmittance of all layers together.
    through: [f64; BLOCK_PIXELS],
}

impl Default for Blend {
    fn default() -> Self {
        Self { colors: [[0.0; BLOCK_PIXELS]; 3], mean: None }
    }
}

impl Default for Mean {
    fn default() -> Self {
        let none = [0.0; BLOCK_PIXELS];
        Self { next: none, colors: [none; 3], weights: none, through: [1.0; BLOCK_PIXELS] }
    }
}

impl Blend {
    /// Begins with the colours behind all layers.
    #[expect(clippy::cast_precision_loss, reason = "below 2^24")]
    pub(crate) fn begin(&mut self, behind: impl Fn(usize) -> [u32; 3], transparency: Transparency) {
        for place in 0..BLOCK_PIXELS {
            for (row, part) in self.colors.iter_mut().zip(behind(place)) {
                row[place] = part as f32;
            }
        }
        match transparency {
            // These methods blend layer over layer, without sums.
            Transparency::Exact | Transparency::Objects | Transparency::Threshold => {
                self.mean = None;
            }
            Transparency::Weighted => **self.mean.get_or_insert_default() = Mean::default(),
        }
    }

    /// Sets the distances of the next layer, if the method needs them.
    pub(crate) fn place(&mut self, level: Level, distances: impl FnOnce() -> [f64; BLOCK_PIXELS]) {
        if let Some(mean) = &mut self.mean {
            mean.next = distances();
            dispatch!(level, _ => mean.next.iter_mut().for_each(|it| *it = weight(*it)));
        }
    }

    /// Blends a colour over a pixel.
    #[inline(always)]
    #[expect(clippy::cast_precision_loss, reason = "below 2^24")]
    pub(crate) fn put(&mut self, place: usize, color: [u32; 3], opacity: f32) {
        let place = place % BLOCK_PIXELS;
        match &mut self.mean {
            None => {
                for (row, part) in self.colors.iter_mut().zip(color) {
                    row[place] = opacity * part as f32 + (1.0 - opacity) * row[place];
                }
            }
            Some(mean) => mean.put(place, color, f64::from(opacity)),
        }
    }

    /// Returns the blended colour of a pixel.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "between 0 and 2^24, like what is blended"
    )]
    pub(crate) fn color(&self, place: usize) -> [u32; 3] {
        let behind = [0, 1, 2].map(|i: usize| self.colors[i][place]);
        let color = match &self.mean {
            // Without weight the mean would be 0 / 0: the surface behind shows unchanged.
            Some(mean) if mean.weights[place] > 0.0 => mean.over(place, behind),
            _ => behind,
        };
        // Rounding must not carry a colour beyond 24 bits.
        color.map(|part| (part as u32).min((1 << 24) - 1))
    }
}

impl Mean {
    #[inline(always)]
    fn put(&mut self, place: usize, color: [u32; 3], opacity: f64) {
        let weight = self.next[place] * opacity;
        for (sum, part) in self.colors.iter_mut().zip(color) {
            sum[place] += weight * f64::from(part);
        }
        self.weights[place] += weight;
        self.through[place] *= 1.0 - opacity;
    }

    #[expect(clippy::cast_possible_truncation, reason = "the nearest f32 is meant")]
    fn over(&self, place: usize, behind: [f32; 3]) -> [f32; 3] {
        let through = self.through[place];
        let mean = |i: usize| self.colors[i][place] / self.weights[place];
        [0, 1, 2]
            .map(|i: usize| (mean(i) * (1.0 - through) + f64::from(behind[i]) * through) as f32)
    }
}

/// Computes the weight of a layer: w = max(0.01, min(3000, 0.03 / (1e-5 + (z / 200)^4))).
#[inline(always)]
fn weight(z: f64) -> f64 {
    let square = (z / 200.0) * (z / 200.0);
    (0.03 / (1e-5 + square * square)).clamp(0.01, 3000.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns a byte in fixed point.
    const fn parts(byte: u32) -> u32 {
        (byte << 16) + (1 << 15)
    }

    fn blended(transparency: Transparency, layers: &[(u32, f32)]) -> u32 {
        let mut blend = Blend::default();
        blend.begin(|_| [parts(100); 3], transparency);
        for (color, opacity) in layers {
            blend.place(Level::new(), || [50.0; BLOCK_PIXELS]);
            blend.put(9, [parts(*color); 3], *opacity);
        }
        blend.color(9)[1]
    }

    #[test]
    fn opacity_0_and_1_leave_and_replace_every_bit() {
        for color in [0, 1, 100, 254, 255] {
            assert_eq!(blended(Transparency::Exact, &[(color, 1.0)]), parts(color));
            assert_eq!(blended(Transparency::Exact, &[(color, 0.0)]), parts(100));
            assert_eq!(blended(Transparency::Weighted, &[(color, 0.0)]), parts(100));
        }
    }

    #[test]
    fn one_layer_is_the_same_in_both_ways_and_two_are_not() {
        for opacity in [0.125, 0.5, 0.9] {
            let [over, mean] = [Transparency::Exact, Transparency::Weighted]
                .map(|way| blended(way, &[(200, opacity)]));
            assert!(over.abs_diff(mean) <= 2, "{over} {mean}");
        }
        let layers = [(0, 0.5), (255, 0.5)];
        // 0.5 * 255 + 0.25 * 0 + 0.25 * 100, and 127.5 * 0.75 + 25.
        assert_eq!(blended(Transparency::Exact, &layers) >> 16, 153);
        assert_eq!(blended(Transparency::Weighted, &layers) >> 16, 121);
    }

    #[test]
    fn the_weight_is_that_of_the_paper() {
        // 0.03 / (1e-5 + 1), at its largest and smallest.
        assert!((weight(200.0) - 0.029_999_7).abs() < 1e-7);
        assert!((weight(0.0) - 3000.0).abs() < 1e-9 && weight(500.0) == 0.01);
    }
}
