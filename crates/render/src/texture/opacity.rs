//! The opacity of a surface with holes: the material's opacity, times the texture's alpha, times
//! the opacity map.

use std::ops::RangeInclusive;

use super::sample::{brightness, sample};
use crate::frame::draw::Shaded;
use crate::simd::Vec3;
use marraztu_core::accuracy::Filter;
use marraztu_core::scene::{Texture, Wrap};

/// The error bound of texel positions, in texels.
const MARGIN: f64 = 1.0 / 64.0;
/// The coordinate, in repetitions, beyond which [`MARGIN`] no longer holds.
const FARTHEST: f64 = 1e9;
/// The error bound of an opacity.
const ROUNDING: f64 = 1e-6;

/// The opacity of a surface as a function of the texture coordinates.
#[derive(Clone, Debug)]
pub(crate) struct Opacity<'a> {
    of_material: f64,
    filter: Filter,
    layers: [Option<OpacityLayer<'a>>; 2],
}

/// A texture that scales the opacity.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OpacityLayer<'a> {
    pub(crate) texture: &'a Texture,
    pub(crate) channel: Channel,
}

/// The part of a texel that holds the opacity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Channel {
    Alpha,
    Brightness,
}

/// The classification of a part of a surface: a point is a hole if its opacity is below one half.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Holes {
    /// No point is a hole: opaque.
    Nowhere,
    /// Every point is a hole: empty.
    Everywhere,
    /// Some points may be holes: mixed.
    Somewhere,
}

impl<'a> Opacity<'a> {
    /// Creates the opacity of a pipeline. `None` if it has no holes.
    #[inline(always)]
    pub(crate) fn of(shaded: &'a Shaded, filter: Filter) -> Option<Self> {
        let Shaded { cutout, texture, opacity_map, .. } = shaded;
        let layer = |texture, channel| OpacityLayer { texture, channel };
        let texture = texture.as_deref().map(|it| layer(it, Channel::Alpha));
        let map = opacity_map.as_deref().map(|it| {
            // An opaque opacity map is a greyscale picture: its brightness counts instead of alpha.
            let is_opaque = it.picture.least_alpha() == 255;
            layer(it, if is_opaque { Channel::Brightness } else { Channel::Alpha })
        });
        Some(Self { of_material: (*cutout)?, filter, layers: [texture, map] })
    }

    /// Computes the tables that [`Self::holes`] reads.
    pub(crate) fn prepare(&self) {
        // Any question builds the tables; its answer does not matter.
        self.holes([[0.0; 2]; 2]);
    }

    /// Returns the material's opacity.
    pub(crate) const fn of_material(&self) -> f64 {
        self.of_material
    }

    /// Returns the textures that scale the opacity.
    pub(crate) const fn layers(&self) -> &[Option<OpacityLayer<'a>>; 2] {
        &self.layers
    }

    /// Computes the opacity at a point.
    #[inline(always)]
    pub(crate) fn at(&self, uv: [f64; 2]) -> f64 {
        let layers = self.layers.iter().flatten();
        layers.fold(self.of_material, |opacity, layer| opacity * layer.at(uv, self.filter))
    }

    /// Classifies the part between the smallest and largest texture coordinates.
    #[inline(always)]
    pub(crate) fn holes(&self, between: [[f64; 2]; 2]) -> Holes {
        let [mut low, mut high] = [self.of_material; 2];
        for layer in self.layers.iter().flatten() {
            let Some([own_low, own_high]) = layer.bounds(between, self.filter) else {
                return Holes::Somewhere;
            };
            // No factor is negative, so the products of bounds bound the product.
            (low, high) = (low * own_low, high * own_high);
        }
        // Rounding may move opacities across one half, so close bounds count as mixed.
        if low >= 0.5 + ROUNDING {
            Holes::Nowhere
        } else if high < 0.5 - ROUNDING {
            Holes::Everywhere
        } else {
            Holes::Somewhere
        }
    }
}

impl OpacityLayer<'_> {
    #[inline(always)]
    fn at(&self, uv: [f64; 2], filter: Filter) -> f64 {
        let [r, g, b, alpha] = sample::<f64>(self.texture, uv, filter);
        match self.channel {
            Channel::Alpha => alpha,
            Channel::Brightness => brightness(Vec3([r, g, b])),
        }
    }

    /// Bounds the opacity between these coordinates. `None` if they are too large.
    #[inline(always)]
    fn bounds(&self, [low, high]: [[f64; 2]; 2], filter: Filter) -> Option<[f64; 2]> {
        let Texture { picture, wrap, offset, scale, .. } = self.texture;
        let size = picture.size();
        // A texture without texels counts as opaque, as in `sample`.
        if size.area() == 0 {
            return Some([1.0; 2]);
        }
        let along = |axis: usize, count: usize| {
            let ends = [low[axis], high[axis]].map(|it| it * scale[axis] + offset[axis]);
            texels(ends, count, *wrap, filter)
        };
        let (columns, rows) = (along(0, size.width)?, along(1, size.height)?);
        // A table of block-wise bounds answers any rectangle quickly.
        let bounds = match self.channel {
            Channel::Alpha => picture.alpha_bounds(),
            Channel::Brightness => picture.color_bounds(),
        };
        let (mut least, mut largest) = (u8::MAX, 0);
        for row in rows.iter().flatten() {
            // Rows of the picture run down, texture coordinates up.
            let row = size.height - 1 - row.end()..=size.height - 1 - row.start();
            for column in columns.iter().flatten() {
                let [low, high] = bounds.over(column, &row);
                (least, largest) = (least.min(low), largest.max(high));
            }
        }
        Some([least, largest].map(|byte| f64::from(byte) / 255.0))
    }
}

/// Finds the columns (or rows) of the texels read between two coordinates: one or two ranges.
/// `None` if the coordinates are too large or NaN.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_precision_loss,
    reason = "far below 2^53, after the check"
)]
#[inline(always)]
fn texels(
    [a, b]: [f64; 2],
    count: usize,
    wrap: Wrap,
    filter: Filter,
) -> Option<[Option<RangeInclusive<usize>>; 2]> {
    // Negated, so that NaN is rejected as well.
    if !(a.abs() <= FARTHEST && b.abs() <= FARTHEST) {
        return None;
    }
    let side = count as f64;
    let (before, after) = match filter {
        Filter::Nearest => (0.0, 0),
        // The alpha test reads no mipmaps.
        Filter::Bilinear | Filter::Trilinear | Filter::Anisotropic => (0.5, 1),
    };
    // Widened by the error of positions, so no texel that drawing reads is missed.
    let first = (a.min(b) * side - before - MARGIN).floor() as i64;
    let last = (a.max(b) * side - before + MARGIN).floor() as i64 + after;
    let end = i64::try_from(count).ok()? - 1;
    let range = |first: i64, last: i64| {
        Some(usize::try_from(first).unwrap_or(0)..=usize::try_from(last).unwrap_or(0))
    };
    Some(match wrap {
        Wrap::Clamp => [range(first.clamp(0, end), last.clamp(0, end)), None],
        // A whole repetition or more reads every texel.
        Wrap::Repeat if last - first >= end => [range(0, end), None],
        // A repeated range can run across the border and continue at the first texel.
        Wrap::Repeat => {
            let start = first.rem_euclid(end + 1);
            let stop = start + (last - first);
            if stop <= end {
                [range(start, stop), None]
            } else {
                [range(start, end), range(0, stop - end - 1)]
            }
        }
    })
}

/// Returns the smallest and largest coordinates of some points.
#[inline(always)]
pub(crate) fn between<const N: usize>(uvs: [[f64; 2]; N]) -> [[f64; 2]; 2] {
    uvs.into_iter().fold([[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]], |[low, high], uv| {
        [[low[0].min(uv[0]), low[1].min(uv[1])], [high[0].max(uv[0]), high[1].max(uv[1])]]
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lights::PhongMaterial;
    use marraztu_core::base::image::{Picture, Size};
    use marraztu_core::base::rng::Rng;

    /// Areas of holes and of opaque texels, with a few texels between.
    fn texture(rng: &mut Rng, size: Size, wrap: Wrap) -> Texture {
        let field = 1 + rng.index(9);
        let pixels = (0..size.area()).map(|i| {
            let open = (i % size.width / field + i / size.width / field).is_multiple_of(2);
            let byte = if rng.one_in(50) { 120 } else { 255 * u8::from(open) };
            [byte, byte, byte, 255 - byte / 2 * u8::from(rng.one_in(2))]
        });
        let picture = Picture::from_pixels(size, pixels.collect()).unwrap().into();
        let scale = [rng.real(-2.0, 2.0), 1.0];
        Texture { source: "fields".into(), picture, wrap, offset: [0.25, -0.5], scale }
    }

    #[test]
    fn solid_and_empty_parts_agree_with_the_opacity_of_their_points() {
        let mut rng = Rng::new(9);
        let mut counts = [0; 3];
        for i in 0..400 {
            let size = Size::new(1 + rng.index(80), 1 + rng.index(80));
            let wrap = rng.one_of(&[Wrap::Repeat, Wrap::Clamp]);
            let filter = rng.one_of(&[Filter::Nearest, Filter::Bilinear, Filter::Trilinear]);
            let texture = texture(&mut rng, size, wrap).into();
            let shaded = Shaded {
                cutout: Some(rng.one_of(&[0.4, 0.6, 1.0])),
                opacity_map: Some(texture),
                ..Shaded::unlit(PhongMaterial::default())
            };
            let opacity = Opacity::of(&shaded, filter).unwrap();
            for _ in 0..40 {
                let side = rng.one_of(&[0.01, 0.1, 0.5, 3.0]);
                let first = [rng.real(-3.0, 3.0), rng.real(-3.0, 3.0)];
                let corners = [first, [first[0] + rng.real(0.0, side), first[1] + side]];
                let [low, high] = between(corners);
                let holes = opacity.holes([low, high]);
                counts[holes as usize] += 1;
                for _ in 0..30 {
                    let uv =
                        [0, 1].map(|i: usize| rng.real(low[i], high[i]).clamp(low[i], high[i]));
                    let is_hole = opacity.at(uv) < 0.5;
                    match holes {
                        Holes::Nowhere => assert!(!is_hole, "{i}: {uv:?}"),
                        Holes::Everywhere => assert!(is_hole, "{i}: {uv:?}"),
                        Holes::Somewhere => {}
                    }
                }
            }
        }
        assert!(counts.iter().all(|count| *count > 1000), "{counts:?}");
    }

    #[test]
    fn huge_and_nan_coordinates_may_have_holes_anywhere() {
        let mut rng = Rng::new(2);
        let texture = texture(&mut rng, Size::new(8, 8), Wrap::Repeat).into();
        let shaded = Shaded {
            cutout: Some(1.0),
            texture: Some(texture),
            ..Shaded::unlit(PhongMaterial::default())
        };
        let opacity = Opacity::of(&shaded, Filter::Nearest).unwrap();
        for far in [f64::NAN, f64::INFINITY, 1e300, -1e12] {
            assert_eq!(opacity.holes([[far, 0.0], [far, 0.0]]), Holes::Somewhere, "{far}");
        }
    }
}
