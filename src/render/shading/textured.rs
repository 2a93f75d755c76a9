//! The colour of a surface, pixel by pixel: texture, vertex colours and tint.

use fearless_simd::dispatch;

use super::context::ShadingContext;
use super::groups::Group;
use super::interpolated::ShadingNumber;
use super::surface::Shader;
use super::texels::{color, uv_ways};
use crate::render::frame::draw::Shaded;
use crate::render::simd::gather::SLOTS;
use crate::render::texture::sample;
use crate::render::texture::uv::{uv, uvs};

impl<T: ShadingNumber> Shader<T> {
    /// t at the pixels of the group: texel x tint x vertex colour, each 1 where absent.
    pub(crate) fn texels(
        &mut self,
        context: &ShadingContext<'_, T>,
        group: &Group<'_>,
        shaded: &Shaded,
    ) {
        let (plan, draw) = (context.plan, group.draw);
        let mips = shaded.texture.as_ref().and_then(|texture| context.terms.mips_of(texture));
        let Self { fragments, attributes, barycentrics, texels, .. } = self;
        for (row, tint) in texels.iter_mut().zip(shaded.tint) {
            row.fill(T::from_f64(tint));
        }
        let mut corners = [None; SLOTS];
        if shaded.texture.is_some() {
            for (corners, number) in corners.iter_mut().zip(&attributes.numbers[..attributes.count])
            {
                *corners = uvs(draw, *number);
            }
        }
        // Dispatched so that rounding down uses the processor's instruction, if it has one.
        dispatch!(context.level, _ => for i in 0..fragments.len {
            let slot = fragments.slots[i].cast_unsigned() as usize % SLOTS;
            let number = attributes.numbers[slot];
            let weights = barycentrics.weights(i);
            if let Some(texture) = &shaded.texture
                && let Some(corners) = corners[slot]
            {
                let uv = uv(corners, weights);
                let texel = match mips {
                    None => sample::sample::<T>(texture, uv, plan.filter),
                    Some(mips) => mips.sample(
                        uv,
                        uv_ways(
                            (plan, context.frame),
                            group.draw_index,
                            number,
                            [fragments.x[i], fragments.y[i]],
                        ),
                    ),
                };
                for (row, part) in texels.iter_mut().zip(texel) {
                    row[i] = row[i] * part;
                }
            }
            if shaded.vertex_colors {
                for (row, part) in texels.iter_mut().zip(color(draw, number, weights)) {
                    row[i] = row[i] * T::from_f64(part);
                }
            }
        });
    }
}
