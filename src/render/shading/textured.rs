//! The colour of a surface, pixel by pixel: texture, vertex colours and tint.

use fearless_simd::dispatch;

use super::context::ShadingContext;
use super::far_texture::FarTexture;
use super::groups::Group;
use super::interpolate::multiply;
use super::interpolated::ShadingNumber;
use super::surface::Shader;
use super::texels::{PlacedTexture, TextureSamples, footprint, steps};
use crate::base::math::each;
use crate::render::frame::draw::Shaded;
use crate::render::screen::weights::HomogeneousWeights;
use crate::render::simd::gather::SLOTS;
use crate::render::texture::lanes::Sampler;
use crate::render::texture::mips::Mips;
use crate::render::texture::placement::{fits_f32, texels};
use crate::render::texture::sample;
use crate::render::texture::uv::{uv, uvs};
use crate::scene::Texture;

/// How lanes sample a texture; `None` if they cannot.
pub(super) fn sampler<'a, T>(
    context: &ShadingContext<'_, T>,
    texture: &'a Texture,
    mips: Option<&'a Mips>,
) -> Option<Sampler<'a>> {
    let levels = mips.map_or(std::slice::from_ref(texture), Mips::levels);
    let plan = context.plan;
    Sampler::new(levels, plan.filter)
}

impl<T: ShadingNumber> Shader<T> {
    /// t at the pixels of the group: texel x tint x vertex colour, each 1 where absent. `new` says
    /// whether the triangles differ from those before.
    pub(crate) fn texels(
        &mut self,
        context: &ShadingContext<'_, T>,
        group: &Group<'_>,
        shaded: &Shaded,
        new: bool,
    ) {
        for (row, tint) in self.texels.iter_mut().zip(shaded.tint) {
            row.fill(T::from_f64(tint));
        }
        if let Some(texture) = &shaded.texture {
            let mips = context.terms.mips_of(texture);
            let done = self.multiply_texels(context, group, (texture, mips), new);
            let slots = u64::MAX >> (SLOTS - self.attributes.count);
            if done & slots != slots {
                self.sample_one_by_one(context, group, (shaded, texture, mips), done);
            }
        }
        if shaded.vertex_colors {
            if new {
                self.take_vertex_colors(group);
            }
            let Self { fragments, attributes, barycentrics, texels, vertex_colors, .. } = self;
            let at = (context.level, attributes.count);
            multiply(at, fragments, vertex_colors, barycentrics, texels);
        }
    }

    /// Samples the texture sixteen pixels at a time. Returns the slots, a bit for each, for whose
    /// triangles that could be done.
    fn multiply_texels(
        &mut self,
        context: &ShadingContext<'_, T>,
        group: &Group<'_>,
        (texture, mips): (&Texture, Option<&Mips>),
        new: bool,
    ) -> u64 {
        let Some(sampler) = sampler(context, texture, mips) else { return 0 };
        if new {
            self.place_texture(context, group, texture, &sampler);
        }
        let Self { fragments, attributes, barycentrics, placement, far, texels, .. } = self;
        let texture = PlacedTexture { placement, far, sampler: &sampler };
        let samples = TextureSamples { fragments, barycentrics, texture };
        T::multiply_texels(context.level, attributes.count, &samples, texels)
    }

    /// Finds where a texture lies on the triangles of the list.
    pub(super) fn place_texture(
        &mut self,
        context: &ShadingContext<'_, T>,
        group: &Group<'_>,
        texture: &Texture,
        sampler: &Sampler<'_>,
    ) {
        let Self { attributes, placement, far, .. } = self;
        placement.clear();
        far.clear();
        let mut corners = [None; SLOTS];
        // One after another, so that the processor fetches many at once.
        for (corners, number) in corners.iter_mut().zip(&attributes.numbers[..attributes.count]) {
            *corners = uvs(group.draw, *number);
        }
        let reads_mips = sampler.reads_mips();
        // Dispatched so that rounding down uses the processor's instruction, if it has one.
        dispatch!(context.level, _ => for (slot, uvs) in corners.iter().enumerate() {
            let Some(uvs) = *uvs else { continue };
            let texels = texels(uvs, texture);
            if !fits_f32(&texels) {
                let Some(own) = FarTexture::new(slot, uvs, texture, || {
                    let number = attributes.numbers[slot];
                    HomogeneousWeights::new(context.plan, group.draw, number, [0; 2])
                }) else {
                    continue;
                };
                far.push(own);
            }
            let steps = match reads_mips {
                true => steps((context.plan, group.draw), attributes, slot),
                false => None,
            };
            placement.set(slot, texels, steps);
        });
    }

    /// Samples the texture pixel by pixel, except for the triangles of the slots that are `done`.
    fn sample_one_by_one(
        &mut self,
        context: &ShadingContext<'_, T>,
        group: &Group<'_>,
        (shaded, texture, mips): (&Shaded, &Texture, Option<&Mips>),
        done: u64,
    ) {
        let plan = context.plan;
        let Self { fragments, attributes, barycentrics, texels, .. } = self;
        let (mut corners, mut all_steps) = ([None; SLOTS], [None; SLOTS]);
        for (slot, number) in attributes.numbers[..attributes.count].iter().enumerate() {
            corners[slot] = uvs(group.draw, *number);
            if mips.is_some() && done >> slot & 1 == 0 {
                all_steps[slot] = steps((plan, group.draw), attributes, slot);
            }
        }
        // Dispatched so that rounding down uses the processor's instruction, if it has one.
        dispatch!(context.level, _ => for i in 0..fragments.len {
            let slot = fragments.slots[i].cast_unsigned() as usize % SLOTS;
            if done >> slot & 1 == 1 {
                continue;
            }
            for (row, tint) in texels.iter_mut().zip(shaded.tint) {
                row[i] = T::from_f64(tint);
            }
            let Some(corners) = corners[slot] else { continue };
            let weights = barycentrics.weights(i);
            let uv = uv(corners, weights);
            let texel = match mips {
                None => sample::sample::<T>(texture, uv, plan.filter),
                Some(mips) => {
                    let steps = all_steps[slot].unwrap_or_default();
                    let w = barycentrics.w[i].into();
                    mips.sample(uv, footprint(corners, weights, w, steps))
                }
            };
            for (row, part) in texels.iter_mut().zip(texel) {
                row[i] = row[i] * part;
            }
        });
    }

    /// Fetches the vertex colours at the corners of the triangles of the list.
    pub(super) fn take_vertex_colors(&mut self, group: &Group<'_>) {
        let Self { attributes, vertex_colors, .. } = self;
        let mesh = &group.draw.model.mesh;
        for (slot, number) in attributes.numbers[..attributes.count].iter().enumerate() {
            let [a, b, c] = each(mesh.triangle_colors(*number), |color| each(color, f64::from));
            for part in 0..3 {
                let row = [a[part], b[part] - a[part], c[part] - a[part]];
                for (values, value) in vertex_colors.iter_mut().zip(row) {
                    values[part][slot] = T::from_f64(value);
                }
            }
        }
    }
}
