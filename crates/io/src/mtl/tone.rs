//! The options of a map that change its texels: `-mm base gain`, and `-imfchan` for maps of one
//! number.
//!
//! Source: the specification of MTL (Wavefront, "Advanced Visualizer", appendix B1).

use marraztu_core::base::image::Picture;
use marraztu_core::scene::MapKind;

/// The channel that a map of one number is read from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Channel {
    Red,
    Green,
    Blue,
    /// The alpha channel.
    Matte,
    Luminance,
}

impl Channel {
    /// Returns the channel of a letter; `None` for `z`, depth, which pictures do not have.
    pub(super) fn named(letter: &str) -> Option<Self> {
        match letter.to_ascii_lowercase().as_str() {
            "r" => Some(Self::Red),
            "g" => Some(Self::Green),
            "b" => Some(Self::Blue),
            "m" => Some(Self::Matte),
            "l" => Some(Self::Luminance),
            _ => None,
        }
    }

    fn of(self, [r, g, b, alpha]: [u8; 4]) -> u8 {
        match self {
            Self::Red => r,
            Self::Green => g,
            Self::Blue => b,
            Self::Matte => alpha,
            // The weights of ITU-R BT.709, as everywhere, in parts of 10,000.
            Self::Luminance => {
                let sum = 2126 * u32::from(r) + 7152 * u32::from(g) + 722 * u32::from(b);
                u8::try_from((sum + 5000) / 10_000).unwrap_or(u8::MAX)
            }
        }
    }
}

/// What a map does with its texels: texel x gain + base.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Tone {
    pub(super) base: f64,
    pub(super) gain: f64,
    pub(super) channel: Option<Channel>,
}

/// The texels of the file.
impl Default for Tone {
    fn default() -> Self {
        Self { base: 0.0, gain: 1.0, channel: None }
    }
}

impl Tone {
    /// Returns the tone for a map of this kind: a colour keeps its channels.
    pub(super) fn of(self, kind: Option<MapKind>) -> Self {
        let is_number = matches!(kind, Some(MapKind::Exponent | MapKind::Opacity | MapKind::Bump));
        Self { channel: self.channel.filter(|_| is_number), ..self }
    }

    /// Returns what tells tones apart.
    pub(super) fn key(&self) -> ([u64; 2], Option<Channel>) {
        ([self.base.to_bits(), self.gain.to_bits()], self.channel)
    }

    /// Returns the changed picture; `None` if nothing changes.
    pub(super) fn applied(&self, picture: &Picture) -> Option<Picture> {
        if *self == Self::default() {
            return None;
        }
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped")]
        let toned: [u8; 256] = std::array::from_fn(|texel| {
            let number = texel as f64 / 255.0 * self.gain + self.base;
            (number.clamp(0.0, 1.0) * 255.0).round() as u8
        });
        let texel = |[r, g, b, alpha]: [u8; 4]| match self.channel {
            // The brightness of an opaque picture is its number.
            Some(channel) => {
                let number = toned[usize::from(channel.of([r, g, b, alpha]))];
                [number, number, number, u8::MAX]
            }
            None => {
                let [r, g, b] = [r, g, b].map(|it| toned[usize::from(it)]);
                [r, g, b, alpha]
            }
        };
        let pixels = picture.pixels().iter().map(|pixel| texel(*pixel)).collect();
        Picture::from_pixels(picture.size(), pixels)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use marraztu_core::base::image::Size;

    #[test]
    fn texels_are_scaled_and_moved_and_a_number_comes_from_its_channel() {
        let picture = |pixels: &[[u8; 4]]| {
            Picture::from_pixels(Size::new(pixels.len(), 1), pixels.to_vec()).unwrap()
        };
        let from = picture(&[[0, 100, 255, 40], [10, 20, 31, 255]]);
        assert_eq!(Tone::default().applied(&from), None);
        let half = Tone { base: 0.5, gain: 0.5, channel: None };
        assert_eq!(
            half.applied(&from),
            Some(picture(&[[128, 178, 255, 40], [133, 138, 143, 255]]))
        );
        let negative = Tone { base: 1.0, gain: -2.0, channel: Some(Channel::Green) };
        assert_eq!(
            negative.applied(&from),
            Some(picture(&[[55, 55, 55, 255], [215, 215, 215, 255]]))
        );
        for (letter, want) in [("r", 0), ("G", 100), ("b", 255), ("m", 40), ("l", 90)] {
            let tone = Tone { channel: Channel::named(letter), ..Tone::default() };
            let got = tone.of(Some(MapKind::Opacity)).applied(&from).unwrap();
            assert_eq!(got.pixels()[0], [want, want, want, 255], "{letter}");
            assert_eq!(tone.of(Some(MapKind::Specular)).applied(&from), None, "a colour");
        }
        assert_eq!(Channel::named("z"), None);
    }
}
