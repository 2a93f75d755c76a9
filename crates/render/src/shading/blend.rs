//! Alpha blending: blends layers over the surface behind them.
//!
//! Colours have the fixed-point format of [`Colors`](super::colors::Colors), units of 2^-16 of a
//! step of a byte, and keep it: after a thousand layers the error is below a hundredth of a step.
//!
//! Over: c' = a f + (1 - a) c, with the layer's colour f and opacity a, the farthest layer first.
//! Porter and Duff, "Compositing Digital Images", SIGGRAPH 1984. The result is f for a = 1 and c
//! for a = 0, bit for bit.

use crate::screen::tiles::BLOCK_PIXELS;

/// The pixels of a block while layers are blended over them.
#[derive(Debug)]
pub(crate) struct Blend {
    colors: [[f32; BLOCK_PIXELS]; 3],
}

impl Default for Blend {
    fn default() -> Self {
        Self { colors: [[0.0; BLOCK_PIXELS]; 3] }
    }
}

impl Blend {
    /// Begins with the colours behind all layers.
    #[expect(clippy::cast_precision_loss, reason = "below 2^24")]
    pub(crate) fn begin(&mut self, behind: impl Fn(usize) -> [u32; 3]) {
        for place in 0..BLOCK_PIXELS {
            for (row, part) in self.colors.iter_mut().zip(behind(place)) {
                row[place] = part as f32;
            }
        }
    }

    /// Blends a colour over a pixel.
    #[inline(always)]
    #[expect(clippy::cast_precision_loss, reason = "below 2^24")]
    pub(crate) fn put(&mut self, place: usize, color: [u32; 3], opacity: f32) {
        let place = place % BLOCK_PIXELS;
        for (row, part) in self.colors.iter_mut().zip(color) {
            row[place] = opacity * part as f32 + (1.0 - opacity) * row[place];
        }
    }

    /// Returns the blended colour of a pixel.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "between 0 and 2^24, like what is blended"
    )]
    pub(crate) fn color(&self, place: usize) -> [u32; 3] {
        // Rounding must not carry a colour beyond 24 bits.
        [0, 1, 2].map(|i: usize| (self.colors[i][place] as u32).min((1 << 24) - 1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns a byte in fixed point.
    const fn parts(byte: u32) -> u32 {
        (byte << 16) + (1 << 15)
    }

    fn blended(layers: &[(u32, f32)]) -> u32 {
        let mut blend = Blend::default();
        blend.begin(|_| [parts(100); 3]);
        for (color, opacity) in layers {
            blend.put(9, [parts(*color); 3], *opacity);
        }
        blend.color(9)[1]
    }

    #[test]
    fn opacity_0_and_1_leave_and_replace_every_bit() {
        for color in [0, 1, 100, 254, 255] {
            assert_eq!(blended(&[(color, 1.0)]), parts(color));
            assert_eq!(blended(&[(color, 0.0)]), parts(100));
        }
    }

    #[test]
    fn the_last_of_two_layers_is_in_front() {
        // 0.5 * 255 + 0.25 * 0 + 0.25 * 100.
        assert_eq!(blended(&[(0, 0.5), (255, 0.5)]) >> 16, 153);
    }
}
