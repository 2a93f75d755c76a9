//! Merges two textures into one: opacity maps into the alpha of textures, since glTF has no opacity
//! maps, and maps of roughness with maps of metalness.
//!
//! The merged picture covers a part of the surface after which both pictures repeat. A texture that
//! repeats 4 times while the map repeats once is therefore repeated 4 times in the merged picture.

use marraztu_core::base::Shared;
use marraztu_core::base::image::{Picture, Size};
use marraztu_core::scene::{Texture, Wrap};
use rayon::prelude::*;

use super::gltf_buffer::single;

/// The most texels of a merged picture, unless the texture has more.
const MOST_TEXELS: usize = 1 << 26;

/// The largest side of a merged picture, which most readers accept.
const LARGEST_SIDE: f64 = 16_384.0;

/// The most periods of the larger picture that are searched for a common period.
const MOST_PERIODS: u32 = 64;

/// The largest error of a common period, in periods of the smaller picture: less than a texel of
/// most.
const PERIOD_ERROR: f64 = 1.0 / 1024.0;

/// The offset and scale of a texture on a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Layout {
    pub(super) offset: [f64; 2],
    pub(super) scale: [f64; 2],
}

impl Default for Layout {
    fn default() -> Self {
        Self { offset: [0.0; 2], scale: [1.0; 2] }
    }
}

impl Layout {
    pub(super) fn of(texture: &Texture) -> Self {
        Self { offset: texture.offset, scale: texture.scale }
    }

    /// Returns texture coordinates with (0, 0) at the upper left.
    pub(super) fn laid(&self, [u, v]: [f32; 2]) -> [f32; 2] {
        let along = |x: f32, i: usize| f64::from(x) * self.scale[i] + self.offset[i];
        [single(along(u, 0)), single(1.0 - along(v, 1))]
    }
}

/// How a texture and an opacity map become one texture.
#[derive(Debug)]
pub(super) struct Merging {
    /// The layout of the merged texture.
    pub(super) layout: Layout,
    size: Size,
    /// Whether the merged texture shows what both show.
    pub(super) is_exact: bool,
}

/// The layout of a merged texture along one axis.
struct Along {
    offset: f64,
    scale: f64,
    is_exact: bool,
}

impl Merging {
    pub(super) fn of(texture: &Texture, map: &Texture) -> Self {
        let along = [0, 1].map(|i| along(texture, map, i));
        let layout = Layout {
            offset: along.each_ref().map(|it| it.offset),
            scale: along.each_ref().map(|it| it.scale),
        };
        let (size, is_whole) = size(texture, map, &layout);
        let is_exact = is_whole && along.iter().all(|it| it.is_exact) && texture.wrap == map.wrap;
        Self { layout, size, is_exact }
    }

    /// Multiplies the texture's alpha by the map.
    pub(super) fn merged(&self, texture: &Texture, map: &Texture) -> Texture {
        let opacity = opacity(map);
        self.combined(texture, map, |[r, g, b, alpha], map| [r, g, b, alpha * opacity(map) / 255.0])
    }

    /// Computes every texel from the texels of both at the same point of the surface.
    pub(super) fn combined(
        &self,
        texture: &Texture,
        map: &Texture,
        combine: impl Fn([f64; 4], [f64; 4]) -> [f64; 4] + Sync,
    ) -> Texture {
        let size = self.size;
        let mut pixels = vec![[0; 4]; size.area()];
        let rows = pixels.par_chunks_mut(size.width.max(1)).enumerate();
        rows.for_each(|(y, row)| {
            for (x, pixel) in row.iter_mut().enumerate() {
                let at = [middle(x, size.width), 1.0 - middle(y, size.height)];
                let of = |it| sample(it, moved(&self.layout, &Layout::of(it), at));
                *pixel = combine(of(texture), of(map)).map(byte);
            }
        });
        let Layout { offset, scale } = self.layout;
        Texture { offset, scale, ..with_pixels(texture, size, pixels) }
    }
}

/// Returns white with the opacity of a map.
pub(super) fn white_with(map: &Texture) -> Texture {
    let opacity = opacity(map);
    let white = |pixel: &[u8; 4]| [255, 255, 255, byte(opacity(pixel.map(f64::from)))];
    let pixels = map.picture.pixels().iter().map(white).collect();
    with_pixels(map, map.picture.size(), pixels)
}

/// Returns the function from a map's texels to opacity: their alpha, or their luminance if the map
/// is opaque.
fn opacity(map: &Texture) -> impl Fn([f64; 4]) -> f64 + Sync {
    let by_brightness = map.picture.least_alpha() == 255;
    move |[r, g, b, alpha]| {
        if by_brightness { 0.2126 * r + 0.7152 * g + 0.0722 * b } else { alpha }
    }
}

/// Chooses the layout along an axis: whole periods of the texture, beginning at a border of it.
fn along(texture: &Texture, map: &Texture, i: usize) -> Along {
    let (offset, scale) = (texture.offset[i], texture.scale[i]);
    // A picture with a scale of 0 is constant along the axis, so the other decides.
    if scale == 0.0 || map.scale[i] == 0.0 {
        let of = if scale == 0.0 && map.scale[i] != 0.0 { map } else { texture };
        return Along { offset: of.offset[i], scale: of.scale[i], is_exact: true };
    }
    let (first, count, is_exact) = match (texture.wrap, map.wrap) {
        (Wrap::Clamp, Wrap::Clamp) => {
            // Everything between the borders of either picture.
            let [from, to] =
                [0.0, 1.0].map(|at| moved(&Layout::of(map), &Layout::of(texture), [at; 2])[i]);
            let first = (from.min(to).min(0.0) + PERIOD_ERROR).floor();
            (first, (from.max(to).max(1.0) - PERIOD_ERROR).ceil() - first, true)
        }
        _ => {
            let (count, is_exact) = common_period((map.scale[i] / scale).abs());
            (0.0, count, is_exact)
        }
    };
    Along { offset: (offset - first) / count, scale: scale / count, is_exact }
}

/// Returns the number of the texture's periods after which a map repeats, too, that has `ratio`
/// periods in each; and whether both repeat exactly. Otherwise it is at least one period of both.
fn common_period(ratio: f64) -> (f64, bool) {
    let counts = (1..=MOST_PERIODS).map(f64::from);
    let mut counts = counts.map(|i| if ratio < 1.0 { (i / ratio).round() } else { i });
    let fits = |count: &f64| (count * ratio - (count * ratio).round()).abs() < PERIOD_ERROR;
    counts.find(fits).map_or(((1.0 / ratio).ceil(), false), |count| (count, true))
}

/// Returns the size at which neither picture loses texels, and whether it is within the limits;
/// otherwise, the size is reduced.
#[expect(clippy::cast_precision_loss, reason = "pictures have fewer rows than 2^52")]
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "limited")]
fn size(texture: &Texture, map: &Texture, layout: &Layout) -> (Size, bool) {
    let sides = |it: &Texture| {
        let Size { width, height } = it.picture.size();
        let periods = |i: usize| {
            let periods = (it.scale[i] / layout.scale[i]).abs();
            if periods > 1.0 { periods } else { 1.0 }
        };
        [width as f64 * periods(0), height as f64 * periods(1)]
    };
    let (own, other) = (sides(texture), sides(map));
    let wanted = [0, 1].map(|i| own[i].max(other[i]).round());
    let least = texture.picture.size();
    let sides = wanted.map(|side| side.min(LARGEST_SIDE));
    let most = MOST_TEXELS.max(least.area()) as f64;
    let factor = (most / (sides[0] * sides[1])).sqrt().min(1.0);
    let [width, height] = sides.map(|side| ((side * factor) as usize).max(1));
    (Size::new(width, height), [width as f64, height as f64] == wanted)
}

pub(super) fn with_pixels(like: &Texture, size: Size, pixels: Vec<[u8; 4]>) -> Texture {
    let picture = Picture::from_pixels(size, pixels).unwrap_or_default();
    Texture { picture: Shared::new(picture), ..like.clone() }
}

/// Returns the centre of a texel, from 0 to 1.
#[expect(clippy::cast_precision_loss, reason = "pictures have fewer rows than 2^52")]
fn middle(i: usize, count: usize) -> f64 {
    (i as f64 + 0.5) / count as f64
}

/// Converts coordinates in one layout to coordinates in another at the same point of the surface.
fn moved(from: &Layout, to: &Layout, at: [f64; 2]) -> [f64; 2] {
    std::array::from_fn(|i| {
        if from.scale[i] == to.scale[i] || from.scale[i] == 0.0 {
            return at[i] - from.offset[i] + to.offset[i];
        }
        (at[i] - from.offset[i]) / from.scale[i] * to.scale[i] + to.offset[i]
    })
}

/// Samples a texture with bilinear filtering; (0, 0) is its lower left corner.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "within the picture")]
#[expect(clippy::cast_precision_loss, reason = "pictures have fewer rows than 2^52")]
fn sample(texture: &Texture, [u, v]: [f64; 2]) -> [f64; 4] {
    let Texture { picture, wrap, .. } = texture;
    let size = picture.size();
    // Texel centres are at half integers.
    let along = |x: f64, count: usize| {
        let (x, count) = (x * count as f64 - 0.5, count as f64);
        let texel = |x: f64| match wrap {
            Wrap::Repeat => x.rem_euclid(count).min(count - 1.0) as usize,
            Wrap::Clamp => x.clamp(0.0, count - 1.0) as usize,
        };
        let first = x.floor();
        (texel(first), texel(first + 1.0), x - first)
    };
    let (left, right, across) = along(u, size.width);
    let (upper, lower, down) = along(1.0 - v, size.height);
    let row = |y| {
        let [a, b] = [left, right].map(|x| picture.pixel(x, y).map(f64::from));
        std::array::from_fn(|i| a[i] + (b[i] - a[i]) * across)
    };
    let [a, b]: [[f64; 4]; 2] = [upper, lower].map(row);
    std::array::from_fn(|i| a[i] + (b[i] - a[i]) * down)
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 255")]
pub(super) fn byte(x: f64) -> u8 {
    x.round().clamp(0.0, 255.0) as u8
}
