//! Mipmaps: the mean of the texels that a pixel covers, read from copies of the texture at a half,
//! a quarter, an eighth of its size and so on.
//!
//! The footprint of a pixel is the longer of the distances on the texture to its right and lower
//! neighbours. Its logarithm selects the two levels to interpolate between (trilinear). The
//! anisotropic filter divides the longer distance into parts as long as the shorter one, and
//! averages a trilinear sample in each.
//!
//! Williams, "Pyramidal Parametrics", SIGGRAPH 1983. The longer distance follows the OpenGL 4.6
//! specification, 8.14.1. The anisotropic filter follows `EXT_texture_filter_anisotropic`.

use super::lanes::MOST_PROBES;
use super::sample::sample_as;
use crate::frame::variants::Decoding;
use crate::simd::Number;
use marraztu_core::accuracy::Filter;
use marraztu_core::base::Shared;
use marraztu_core::base::color::{byte, encoded, linear_factors};
use marraztu_core::base::image::{Picture, Size};
use marraztu_core::scene::Texture;

/// The mipmap levels of a texture: full size, half size, and so on down to one texel.
#[derive(Debug)]
pub(crate) struct Mips {
    of: Shared<Texture>,
    /// The colour space of the means: stored bytes or linear values.
    decoding: Decoding,
    levels: Vec<Texture>,
}

impl Mips {
    pub(crate) fn new(of: &Shared<Texture>, decoding: Decoding) -> Self {
        let mut levels = vec![Texture::clone(of)];
        while let Some(last) = levels.last()
            && last.picture.size().area() > 1
        {
            levels
                .push(Texture { picture: halved(&last.picture, decoding).into(), ..last.clone() });
        }
        Self { of: of.clone(), decoding, levels }
    }

    /// Returns whether these mipmaps were made from this texture with this decoding.
    pub(crate) fn are_of(&self, texture: &Shared<Texture>, decoding: Decoding) -> bool {
        Shared::same(&self.of, texture) && self.decoding == decoding
    }

    /// Returns the texture and its smaller copies, the largest first.
    pub(crate) fn levels(&self) -> &[Texture] {
        &self.levels
    }

    /// Samples red, green, blue and alpha at an offset of `beside` texels (of the full size) from
    /// `uv`. `ways` are the differences to the neighbouring pixels on the screen.
    pub(crate) fn sample_beside<T: Number>(
        &self,
        (uv, beside): ([f64; 2], [f64; 2]),
        ways: [[f64; 2]; 2],
        filter: Filter,
    ) -> [T; 4] {
        let [right, below] = ways.map(|way| self.texels(way));
        // The longer way decides the level, and anisotropic samples lie along it.
        let (way, longer, shorter) =
            if right >= below { (ways[0], right, below) } else { (ways[1], below, right) };
        // Each sample covers a part as long as the shorter way, which is at least a texel.
        let count = match filter {
            Filter::Anisotropic => {
                (longer / shorter.max(1.0)).ceil().clamp(1.0, MOST_PROBES.into())
            }
            Filter::Nearest | Filter::Bilinear | Filter::Trilinear => 1.0,
        };
        let level = self.level(longer / count);
        if count <= 1.0 {
            return self.trilinear((uv, beside), level);
        }
        let (mut sum, mut probe) = ([T::from_f64(0.0); 4], 0.0);
        while probe < count {
            // The middles of equal parts of the way.
            let part = (probe + 0.5) / count - 0.5;
            let uv = [uv[0] + way[0] * part, uv[1] + way[1] * part];
            let own: [T; 4] = self.trilinear((uv, beside), level);
            sum = std::array::from_fn(|i| sum[i] + own[i] * T::from_f64(1.0 / count));
            probe += 1.0;
        }
        sum
    }

    /// Mixes the two levels around a fractional one.
    fn trilinear<T: Number>(&self, (uv, beside): ([f64; 2], [f64; 2]), level: f64) -> [T; 4] {
        let of = |level: usize| {
            let sides = |level: &Texture| {
                let Size { width, height } = level.picture.size();
                [width, height]
            };
            let (whole, own) = (sides(&self.levels[0]), sides(&self.levels[level]));
            // The offset shrinks with the level.
            #[expect(clippy::cast_precision_loss, reason = "fewer than 2^53 pixels a side")]
            let beside = [0, 1].map(|axis| beside[axis] * own[axis] as f64 / whole[axis] as f64);
            sample_as::<T>(&self.levels[level], (uv, beside), Filter::Bilinear, self.decoding)
        };
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "below 32")]
        let below = level as usize;
        let near = of(below);
        #[expect(clippy::cast_precision_loss, reason = "below 32")]
        let part = T::from_f64(level - below as f64);
        // At level 0 and on the last level, there is nothing to mix.
        match self.levels.get(below + 1) {
            Some(_) if level > 0.0 => {
                let far = of(below + 1);
                std::array::from_fn(|i| near[i] + (far[i] - near[i]) * part)
            }
            _ => near,
        }
    }

    /// Returns the length of a way in texels of the full size.
    #[expect(clippy::cast_precision_loss, reason = "pictures have fewer than 2^53 pixels a side")]
    fn texels(&self, [u, v]: [f64; 2]) -> f64 {
        let Texture { picture, scale, .. } = &self.levels[0];
        let Size { width, height } = picture.size();
        libm::hypot(u * scale[0] * width as f64, v * scale[1] * height as f64)
    }

    /// Computes the mipmap level: log2 of the texels that a pixel covers, clamped to existing
    /// levels.
    #[expect(clippy::cast_precision_loss, reason = "at most 16")]
    fn level(&self, texels: f64) -> f64 {
        if texels > 1.0 { libm::log2(texels).min((self.levels.len() - 1) as f64) } else { 0.0 }
    }
}

/// Halves a picture: each pixel is the mean of the texels that it covers, rounded to the nearest
/// byte. If the texture is decoded, the mean is one of linear values.
fn halved(picture: &Picture, decoding: Decoding) -> Picture {
    let from = picture.size();
    let [columns, rows] = [from.width, from.height].map(covered);
    let size = Size::new(columns.len(), rows.len());
    let pixels = rows.iter().flat_map(|row| columns.iter().map(move |column| (column, row)));
    let mean = |(column, row): (&Covered, &Covered)| {
        let (mut sums, mut light, mut whole) = ([0; 4], [0.0; 3], 0);
        for (y, height) in row {
            for (x, width) in column {
                let (pixel, area) = (picture.pixel(*x, *y), width * height);
                whole += area;
                for (sum, byte) in sums.iter_mut().zip(pixel) {
                    *sum += u64::from(byte) * u64::from(area);
                }
                if decoding == Decoding::Linear {
                    for (sum, byte) in light.iter_mut().zip(pixel) {
                        *sum += linear_factors()[usize::from(byte)] * f64::from(area);
                    }
                }
            }
        }
        let half = u64::from(whole / 2);
        let stored = sums.map(|sum| u8::try_from((sum + half) / u64::from(whole)).unwrap_or(255));
        match decoding {
            Decoding::Stored => stored,
            // Alpha is linear as it is stored, so only colours are decoded.
            Decoding::Linear => {
                let [r, g, b] = light.map(|sum| byte(encoded(sum / f64::from(whole))));
                [r, g, b, stored[3]]
            }
        }
    };
    Picture::from_pixels(size, pixels.map(mean).collect()).unwrap_or_default()
}

/// The texels that a pixel of the halved picture covers along an axis, with their shares in a
/// common unit.
type Covered = Vec<(usize, u32)>;

/// Returns the texels that each pixel of the halved picture covers along a side of the whole one.
///
/// If a side of 2 m + 1 texels becomes m pixels, each covers 2 + 1 / m texels. In units of 1 / m,
/// pixel i has m - i of texel 2 i, m of the next one and i + 1 of the one after it. Guthe and
/// Heckbert, "Non-Power-of-Two Mipmapping", NVIDIA 2005.
fn covered(side: usize) -> Vec<Covered> {
    let half = side / 2;
    let share = |units: usize| u32::try_from(units).unwrap_or(u32::MAX);
    match side {
        0 | 1 => vec![vec![(0, 1)]],
        _ if side.is_multiple_of(2) => {
            (0..half).map(|i| vec![(2 * i, 1), (2 * i + 1, 1)]).collect()
        }
        _ => {
            let shares = |i| [(2 * i, half - i), (2 * i + 1, half), (2 * i + 2, i + 1)];
            (0..half).map(|i| shares(i).map(|(at, units)| (at, share(units))).to_vec()).collect()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TRILINEAR: Filter = Filter::Trilinear;

    /// A texture with white texels and black ones.
    fn patterned(side: usize, is_white: impl Fn(usize) -> bool) -> Shared<Texture> {
        let at = |i: usize| if is_white(i) { [255; 4] } else { [0, 0, 0, 255] };
        let pixels = (0..side * side).map(at).collect();
        let picture = Picture::from_pixels(Size::new(side, side), pixels).unwrap();
        Shared::new(Texture::new("", picture))
    }

    fn chequered(side: usize) -> Shared<Texture> {
        patterned(side, |i| (i % side + i / side).is_multiple_of(2))
    }

    /// A pixel that is eight texels high and half a texel wide lies within one column.
    #[test]
    fn a_pixel_along_a_stripe_shows_its_colour_only_with_the_anisotropic_filter() {
        let mips = Mips::new(&patterned(16, |i| i.is_multiple_of(2)), Decoding::Stored);
        let at = |column: f64, filter: Filter| -> [f64; 4] {
            let uv = [(column + 0.5) / 16.0, 0.37];
            mips.sample_beside((uv, [0.0; 2]), [[0.5 / 16.0, 0.0], [0.0, 8.0 / 16.0]], filter)
        };
        let shown = [0.0, 1.0].map(|column| at(column, Filter::Anisotropic)[0]);
        assert!((shown[0] - 1.0).abs() < 1e-9 && shown[1].abs() < 1e-9, "{shown:?}");
        let grey = [0.0, 1.0].map(|column| at(column, TRILINEAR)[0]);
        assert!(grey.iter().all(|grey| (grey - 0.5).abs() < 0.003), "{grey:?}");
    }

    #[test]
    fn seen_from_afar_a_chequered_texture_is_grey_and_from_near_it_is_not() {
        let mips = Mips::new(&chequered(16), Decoding::Stored);
        assert_eq!(mips.levels.len(), 5);
        for i in 0..40 {
            let uv = [f64::from(i) * 0.137, f64::from(i) * 0.071];
            let afar: [f64; 4] =
                mips.sample_beside((uv, [0.0; 2]), [[2.0 / 16.0, 0.0], [0.0, 0.01]], TRILINEAR);
            assert!((afar[0] - 0.5).abs() < 0.003, "{afar:?}");
        }
        let near: [f64; 4] =
            mips.sample_beside(([0.5 / 16.0; 2], [0.0; 2]), [[0.01, 0.0], [0.0, 0.01]], TRILINEAR);
        // The picture's rows run down, so (0, 0) is its lower left texel.
        assert!(near[0] == 0.0 || near[0] == 1.0, "{near:?}");
    }

    #[test]
    fn between_two_sizes_both_are_mixed() {
        let mips = Mips::new(&chequered(2), Decoding::Stored);
        let at = |texels: f64| -> [f64; 4] {
            mips.sample_beside(([0.25; 2], [0.0; 2]), [[texels / 2.0, 0.0], [0.0, 0.0]], TRILINEAR)
        };
        let (near, half, far) = (at(1.0)[0], at(2.0_f64.sqrt())[0], at(2.0)[0]);
        assert!((far - 128.0 / 255.0).abs() < 1e-9 && (near == 0.0 || near == 1.0));
        assert!((half - (near + far) / 2.0).abs() < 1e-9, "{near} {half} {far}");
    }

    #[test]
    fn odd_sizes_and_a_single_texel_have_mipmap_chains() {
        for (width, height, levels) in [(1, 1, 1), (5, 3, 3), (1, 8, 4)] {
            let size = Size::new(width, height);
            let texture = Texture::new("", Picture::filled(size, [9; 4]));
            let mips = Mips::new(&Shared::new(texture), Decoding::Stored);
            assert_eq!(mips.levels.len(), levels);
            let color: [f64; 4] =
                mips.sample_beside(([0.3, 0.7], [0.0; 2]), [[9.0, 0.0], [0.0, 9.0]], TRILINEAR);
            assert!((color[0] - 9.0 / 255.0).abs() < 1e-12);
        }
    }

    /// Columns of five texels become two, with 2.5 texels each, and then one.
    #[test]
    fn every_texel_of_an_odd_side_has_the_same_share_in_the_last_mipmap() {
        for decoding in [Decoding::Stored, Decoding::Linear] {
            let means = (0..5).map(|white| {
                let pixels = (0..5).map(|i| if i == white { [255; 4] } else { [0; 4] }).collect();
                let picture = Picture::from_pixels(Size::new(5, 1), pixels).unwrap();
                let mips = Mips::new(&Shared::new(Texture::new("", picture)), decoding);
                mips.levels.last().unwrap().picture.pixel(0, 0)
            });
            // A fifth of white, whose light is stored as 124: see `linear`.
            let fifth = if decoding == Decoding::Linear { 124 } else { 51 };
            for mean in means {
                assert!(mean[0].abs_diff(fifth) <= 1 && mean[3].abs_diff(51) <= 1, "{mean:?}");
            }
        }
        let size = Size::new(3, 3);
        let pixels = (0..9).map(|i| [28 * i; 4]).collect();
        let picture = Picture::from_pixels(size, pixels).unwrap();
        assert_eq!(halved(&picture, Decoding::Stored).pixels(), [[112; 4]]);
    }
}
