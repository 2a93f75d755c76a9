//! Reads the texels of maps at fragments: sixteen pixels at a time, or one by one if necessary.

use crate::simd::dispatch;

use super::context::{Group, ShadingContext};
use super::interpolate::Points;
use super::interpolated::ShadingNumber;
use super::texels::{
    FarTexture, PlacedTexture, TexelScratch, Texels, TextureSamples, footprint, steps,
};
use super::triangle_attributes::{TriangleAttributes, asks_ahead};
use crate::frame::variants::Decoding;
use crate::lights::Rows;
use crate::screen::clipped_weights::ClippedWeights;
use crate::simd::gather::SLOTS;
use crate::simd::{Bits, Number, Vec3};
use crate::texture::lanes::Sampler;
use crate::texture::mips::Mips;
use crate::texture::placement::{Placement, fits_f32, texels};
use crate::texture::sample::{brightness, sample_as};
use crate::texture::uv::{uv, uvs};
use marraztu_core::accuracy::Filter;
use marraztu_core::base::Shared;
use marraztu_core::base::math::each;
use marraztu_core::scene::Texture;

/// A texture, and the method of reading its texels.
#[derive(Clone, Copy, Debug)]
pub(super) struct TexelSource<'a> {
    texture: &'a Texture,
    mips: Option<&'a Mips>,
    pub(super) filter: Filter,
    decoding: Decoding,
}

impl<'a> TexelSource<'a> {
    /// Returns a texture read by the filter of the frame.
    pub(super) fn new<T: Number>(
        context: &ShadingContext<'a, T>,
        texture: &'a Shared<Texture>,
        decoding: Decoding,
    ) -> Self {
        let mips = context.terms.mips_of(texture, decoding);
        Self { texture, mips, filter: context.plan.filter, decoding }
    }

    /// Returns a texture of colours.
    pub(super) fn of_colors<T: Number>(
        context: &ShadingContext<'a, T>,
        texture: &'a Shared<Texture>,
    ) -> Self {
        Self::new(context, texture, context.mode().decoding)
    }

    /// Returns a sampler for lanes. `None` if the texture has no texels.
    pub(super) fn sampler(&self) -> Option<Sampler<'a>> {
        let levels = self.mips.map_or(std::slice::from_ref(self.texture), Mips::levels);
        Sampler::new(levels, self.filter)
    }

    /// Samples the texture at an offset of `beside` texels from `uv`.
    fn texel<T: ShadingNumber>(
        &self,
        (uv, beside): ([f64; 2], [f64; 2]),
        footprint: impl FnOnce() -> [[f64; 2]; 2],
    ) -> [T; 4] {
        match self.mips {
            Some(mips) if self.filter.reads_mips() => {
                mips.sample_beside((uv, beside), footprint(), self.filter)
            }
            _ => sample_as(self.texture, (uv, beside), self.filter, self.decoding),
        }
    }
}

/// The placement of a texture on the triangles of a list.
#[derive(Debug, Default)]
pub(crate) struct TexturePlacement {
    pub(super) placement: Placement,
    /// The triangles for which f32 is not accurate enough.
    pub(super) far: Vec<FarTexture>,
    /// The memory for reading it.
    pub(super) scratch: TexelScratch,
}

impl<T: ShadingNumber> Points<'_, T> {
    /// Reads a map at all fragments: sixteen pixels at a time, and one by one for the rest. `base`
    /// is the previous content of rows of colours.
    pub(super) fn read(
        self,
        group: &Group<'_, T>,
        (source, what): (TexelSource<'_>, Texels),
        placed: &mut TexturePlacement,
        (base, to): ([f64; 3], &mut Rows<T>),
    ) {
        let Self { attributes, .. } = self;
        let mut done = 0;
        if let Some(sampler) = source.sampler() {
            // The placement is kept while the triangles stay the same.
            if attributes.are_new {
                place(group, attributes, (source.texture, &sampler), placed);
            }
            let TexturePlacement { placement, far, scratch } = placed;
            let texture = PlacedTexture { placement, far, sampler: &sampler };
            let samples = TextureSamples { points: self, texture, decoding: source.decoding };
            let to = (scratch, &mut *to);
            done = T::read_texels(group.context.level, &samples, what, to);
        }
        // The slots that lanes could not handle are read one by one.
        let slots = u64::MAX >> (SLOTS - attributes.count);
        if done & slots != slots {
            self.read_one_by_one(group, (source, what, done), (base, to));
        }
    }

    /// Reads a map pixel by pixel, except for the triangles in the slots `done`.
    fn read_one_by_one(
        self,
        group: &Group<'_, T>,
        (source, what, done): (TexelSource<'_>, Texels, u64),
        (base, to): ([f64; 3], &mut Rows<T>),
    ) {
        let ShadingContext { level, plan, .. } = *group.context;
        let Self { fragments, attributes, barycentrics } = self;
        let (mut corners, mut all_steps) = ([None; SLOTS], [None; SLOTS]);
        for (slot, number) in attributes.numbers[..attributes.count].iter().enumerate() {
            corners[slot] = uvs(group.draw, *number);
            // Only mipmaps need the footprint of a pixel.
            if source.mips.is_some() && done >> slot & 1 == 0 {
                all_steps[slot] = steps((plan, group.draw), attributes, slot);
            }
        }
        // Dispatched so rounding down uses the processor's instruction, if it has one.
        dispatch!(level, _ => for i in 0..fragments.len {
            let slot = fragments.slots[i].cast_unsigned() as usize % SLOTS;
            if done >> slot & 1 == 1 {
                continue;
            }
            // A surface without texture coordinates has no slopes.
            let colors = what == Texels::Colors;
            for (row, base) in to.iter_mut().zip(base) {
                row[i] = T::from_f64(if colors { base } else { 0.0 });
            }
            let Some(corners) = corners[slot] else { continue };
            let weights = barycentrics.weights(i);
            let uv = uv(corners, weights);
            let texel = |beside: [f64; 2]| -> [T; 4] {
                source.texel((uv, beside), || {
                    let steps = all_steps[slot].unwrap_or_default();
                    footprint(corners, weights, barycentrics.w[i].into(), steps)
                })
            };
            match what {
                Texels::Colors => {
                    for (row, part) in to.iter_mut().zip(texel([0.0; 2])) {
                        row[i] = row[i] * part;
                    }
                }
                Texels::Slopes => {
                    // Central differences, as in lanes.
                    let height = |beside: [f64; 2]| {
                        let [r, g, b, _] = texel(beside);
                        brightness(Vec3([r, g, b]))
                    };
                    let half = T::from_f64(0.5);
                    to[0][i] = (height([1.0, 0.0]) - height([-1.0, 0.0])) * half;
                    to[1][i] = (height([0.0, 1.0]) - height([0.0, -1.0])) * half;
                }
            }
        });
    }
}

/// Computes the placement of a texture on the triangles of a list.
pub(super) fn place<T: ShadingNumber>(
    group: &Group<'_, T>,
    attributes: &TriangleAttributes<T>,
    (texture, sampler): (&Texture, &Sampler<'_>),
    TexturePlacement { placement, far, .. }: &mut TexturePlacement,
) {
    let ShadingContext { level, plan, .. } = *group.context;
    placement.clear();
    far.clear();
    let mesh = &group.draw.model.mesh;
    let mut rows = [[[0.0; SLOTS]; 2]; 3];
    let mut uv_places = [None; SLOTS];
    // Addresses first, then coordinates: the prefetches overlap.
    let ahead = asks_ahead(attributes.count);
    for (places, number) in uv_places.iter_mut().zip(&attributes.numbers[..attributes.count]) {
        *places = mesh.uv_places(*number);
        if let Some(places) = places.filter(|_| ahead) {
            mesh.prefetch_uvs(places);
        }
    }
    // Coordinates of each corner, in rows that lanes load.
    for (slot, places) in uv_places[..attributes.count].iter().enumerate() {
        let own = places.and_then(|places| mesh.uvs_at(places));
        placement.known |= u64::from(own.is_some()) << slot;
        for (rows, [u, v]) in rows.iter_mut().zip(own.unwrap_or_default()) {
            (rows[0][slot], rows[1][slot]) = (u, v);
        }
    }
    let reads_mips = sampler.filter.reads_mips();
    let uvs = (&rows, reads_mips);
    // The footprints of rays differ from triangle to triangle.
    let of_rays = !attributes.footprints.is_empty();
    let done = match of_rays {
        true => 0,
        false => T::place_texture(level, attributes, (texture, uvs), placement),
    };
    // Triangles that sixteen lanes could not place exactly.
    let others = placement.known & !done;
    // Dispatched so rounding down uses the processor's instruction, if it has one.
    dispatch!(level, _ => for slot in Bits(others) {
        let uvs = each([0, 1, 2], |corner| rows[corner].map(|row| f64::from(row[slot])));
        let texels = texels(uvs, texture);
        // A triangle with too many texels for f32 gets its positions in f64, pixel by pixel.
        if !fits_f32(&texels) {
            if of_rays {
                placement.known &= !(1 << slot);
                continue;
            }
            let Some(own) = FarTexture::new(slot, uvs, texture, || {
                let number = attributes.numbers[slot];
                ClippedWeights::new(plan, group.draw, number, [0; 2])
            }) else {
                placement.known &= !(1 << slot);
                continue;
            };
            far.push(own);
        }
        let steps = match reads_mips {
            true => steps((plan, group.draw), attributes, slot),
            false => None,
        };
        placement.set(slot, texels, steps);
    });
}
