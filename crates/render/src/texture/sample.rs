//! Samples textures at one point. Texels are bytes / 255; (0, 0) is the lower left corner.

use crate::frame::variants::Decoding;
use crate::simd::{Number, Real, Vec3};
use marraztu_core::accuracy::Filter;
use marraztu_core::base::color::linear_factors;
use marraztu_core::scene::{Texture, Wrap};

/// Samples red, green, blue and alpha at `uv`, as factors.
///
/// The texel position is computed in f64 for every arithmetic, so all of them read the same texels.
/// Bilinear interpolation is computed in `T`.
#[inline(always)]
pub(crate) fn sample<T: Number>(texture: &Texture, uv: [f64; 2], filter: Filter) -> [T; 4] {
    sample_as(texture, (uv, [0.0; 2]), filter, Decoding::Stored)
}

/// Samples at an offset of `beside` texels from `uv`, with red, green and blue decoded as given.
#[inline(always)]
pub(crate) fn sample_as<T: Number>(
    texture: &Texture,
    (uv, beside): ([f64; 2], [f64; 2]),
    filter: Filter,
    decoding: Decoding,
) -> [T; 4] {
    let size = texture.picture.size();
    // Without texels, the factors are 1 and change no colour.
    if size.area() == 0 {
        return [T::from_f64(1.0); 4];
    }
    // The position in texels, from the lower left corner of the picture. The offset comes before
    // clamping: next to a clamped texture, it must not lead back inside.
    #[expect(clippy::cast_precision_loss, reason = "pictures have fewer than 2^53 pixels a side")]
    let [x, y] = [(0, size.width as f64), (1, size.height as f64)].map(|(axis, side)| {
        let own = uv[axis] * texture.scale[axis] + texture.offset[axis];
        match texture.wrap {
            Wrap::Repeat => wrapped(own, Wrap::Repeat) * side + beside[axis],
            Wrap::Clamp => wrapped(own + beside[axis] / side, Wrap::Clamp) * side,
        }
    });
    let texel = |column: i64, row: i64| {
        let column = bring(column, size.width, texture.wrap);
        // Rows of the picture run down, texture coordinates up.
        let row = size.height - 1 - bring(row, size.height, texture.wrap);
        let pixel = texture.picture.pixel(column, row);
        let stored = pixel.map(|byte| T::from_f64(FACTORS[usize::from(byte)]));
        match decoding {
            Decoding::Stored => stored,
            Decoding::Linear => {
                let [r, g, b, _] =
                    pixel.map(|byte| T::from_f64(linear_factors()[usize::from(byte)]));
                [r, g, b, stored[3]]
            }
        }
    };
    match filter {
        Filter::Nearest => texel(whole(x), whole(y)),
        // Sampled at full size; the caller handles mipmaps.
        Filter::Bilinear | Filter::Trilinear | Filter::Anisotropic => {
            // Texel centres are at halves, so the lower left neighbour is half a texel back.
            let (x, y) = (x - 0.5, y - 0.5);
            let (column, row) = (whole(x), whole(y));
            let (s, t) = (T::from_f64(x - x.floor()), T::from_f64(y - y.floor()));
            let between = |a: [T; 4], b: [T; 4], part: T| -> [T; 4] {
                std::array::from_fn(|i| a[i] + (b[i] - a[i]) * part)
            };
            let lower = between(texel(column, row), texel(column + 1, row), s);
            let upper = between(texel(column, row + 1), texel(column + 1, row + 1), s);
            between(lower, upper, t)
        }
    }
}

/// Samples an opacity map at `uv`: its alpha or, if it is opaque everywhere, its brightness.
pub(crate) fn opacity_of(map: &Texture, uv: [f64; 2], filter: Filter) -> f64 {
    let [r, g, b, alpha] = sample::<f64>(map, uv, filter);
    if map.picture.least_alpha() == 255 { brightness(Vec3([r, g, b])) } else { alpha }
}

/// The factor of each byte: byte / 255.
const FACTORS: [f64; 256] = {
    let mut factors = [0.0; 256];
    let mut byte = 0;
    while byte < 256 {
        factors[byte] = byte as f64 / 255.0;
        byte += 1;
    }
    factors
};

/// Computes the brightness of a colour, with the weights of ITU-R BT.709. The brightness of a grey
/// is exactly its value.
#[inline(always)]
pub(crate) fn brightness<R: Real>(Vec3([r, g, b]): Vec3<R>) -> R {
    // Differences from green keep greys exact: both terms are 0 if r = g = b.
    g + (r - g) * g.lift(0.2126) + (b - g) * g.lift(0.0722)
}

/// Wraps a coordinate to 0 to 1. NaN and infinities become 0.
#[inline(always)]
fn wrapped(coordinate: f64, wrap: Wrap) -> f64 {
    if !coordinate.is_finite() {
        return 0.0;
    }
    match wrap {
        Wrap::Repeat => coordinate - coordinate.floor(),
        Wrap::Clamp => coordinate.clamp(0.0, 1.0),
    }
}

/// Rounds a coordinate of the picture down to an integer.
#[inline(always)]
#[expect(clippy::cast_possible_truncation, reason = "a place in or next to a picture")]
fn whole(coordinate: f64) -> i64 {
    coordinate.floor() as i64
}

/// Wraps a column or row into the picture.
#[inline(always)]
fn bring(i: i64, count: usize, wrap: Wrap) -> usize {
    let count = i64::try_from(count).unwrap_or(i64::MAX);
    let inside = match wrap {
        // The common case first: the division below takes longer than everything else here.
        _ if (0..count).contains(&i) => i,
        Wrap::Repeat => i.rem_euclid(count),
        Wrap::Clamp => i.clamp(0, count - 1),
    };
    usize::try_from(inside).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use marraztu_core::base::image::{Picture, Size};

    /// Red and green above, blue and white below.
    fn four(wrap: Wrap) -> Texture {
        let pixels = vec![[255, 0, 0, 255], [0, 255, 0, 255], [0, 0, 255, 255], [255, 255, 255, 0]];
        let picture = Picture::from_pixels(Size::new(2, 2), pixels).unwrap();
        Texture { wrap, ..Texture::new("", picture) }
    }

    fn at(uv: [f64; 2], filter: Filter, wrap: Wrap) -> [f64; 4] {
        sample(&four(wrap), uv, filter)
    }

    #[test]
    fn the_origin_is_the_lower_left_corner() {
        assert_eq!(at([0.1, 0.1], Filter::Nearest, Wrap::Repeat), [0.0, 0.0, 1.0, 1.0]);
        assert_eq!(at([0.9, 0.9], Filter::Nearest, Wrap::Repeat), [0.0, 1.0, 0.0, 1.0]);
        assert_eq!(at([0.9, 0.1], Filter::Nearest, Wrap::Repeat), [1.0, 1.0, 1.0, 0.0]);
    }

    #[test]
    fn a_place_on_a_border_belongs_to_the_texel_after_it() {
        let lower_left = [0.0, 0.0, 1.0, 1.0];
        assert_eq!(at([0.0, 0.0], Filter::Nearest, Wrap::Repeat), lower_left);
        assert_eq!(at([0.0, 0.0], Filter::Nearest, Wrap::Clamp), lower_left);
        assert_eq!(at([0.0, 0.5], Filter::Nearest, Wrap::Repeat), [1.0, 0.0, 0.0, 1.0]);
        assert_eq!(at([1.0, 1.0], Filter::Nearest, Wrap::Clamp), [0.0, 1.0, 0.0, 1.0]);
    }

    #[test]
    fn the_middle_of_four_texels_is_their_mean() {
        assert_eq!(at([0.5, 0.5], Filter::Bilinear, Wrap::Repeat), [0.5, 0.5, 0.5, 0.75]);
    }

    #[test]
    fn outside_it_repeats_or_holds_its_border() {
        assert_eq!(at([-0.9, 5.1], Filter::Nearest, Wrap::Repeat), [0.0, 0.0, 1.0, 1.0]);
        assert_eq!(at([-7.0, 9.0], Filter::Bilinear, Wrap::Clamp), [1.0, 0.0, 0.0, 1.0]);
    }

    #[test]
    fn every_place_is_in_bounds() {
        for place in [-1.0, 0.0, 1.0, 1e4, 1e30, -1e300, f64::NAN, f64::INFINITY, 1.0 - 1e-17] {
            for (filter, wrap) in [(Filter::Nearest, Wrap::Repeat), (Filter::Bilinear, Wrap::Clamp)]
            {
                let color = at([place, place], filter, wrap);
                assert!(color.iter().all(|x| (0.0..=1.0).contains(x)), "{place}: {color:?}");
            }
        }
    }
}
