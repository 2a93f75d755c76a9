//! Texels of fragments, sixteen at a time; the footprint of a pixel on its texture; vertex colours.

use fearless_simd::{Simd, SimdBase as _, f32x16, i32x16};
use glam::DVec3;

use super::barycentrics::Barycentrics;
use super::fragments::Fragments;
use super::triangle_attributes::{AttributeNumber, TriangleAttributes};
use crate::base::math::each;
use crate::render::frame::FramePlan;
use crate::render::frame::draw::Draw;
use crate::render::lights::{Rows, load, store};
use crate::render::raster::geometry::ScreenGeometry;
use crate::render::screen::coverage::{SUBPIXELS, doubled_area};
use crate::render::screen::weights::{HomogeneousWeights, Weights};
use crate::render::simd::gather::SLOTS;
use crate::render::simd::{Lanes as _, Real, Sixteen, Vec3};
use crate::render::texture::lanes::Sampler;
use crate::render::texture::placement::{Placement, Steps};
use crate::render::texture::uv::uvs;
use crate::scene::dvec3;

/// A texture on the triangles of a list.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlacedTexture<'a> {
    pub(crate) placement: &'a Placement,
    pub(crate) sampler: &'a Sampler<'a>,
}

/// What the texels of some fragments are sampled from.
#[derive(Debug)]
pub(crate) struct TextureSamples<'a, T> {
    pub(crate) fragments: &'a Fragments,
    pub(crate) barycentrics: &'a Barycentrics<T>,
    pub(crate) texture: PlacedTexture<'a>,
}

impl TextureSamples<'_, f32> {
    /// Multiplies colours by the texels of all fragments; those of triangles whose placement is not
    /// known get arbitrary factors.
    #[inline(always)]
    pub(crate) fn multiply<S: Simd, const PAGES: usize>(&self, simd: S, to: &mut Rows<f32>) {
        let Self { fragments, barycentrics, texture } = *self;
        let lanes = Sixteen(simd);
        for at in (0..fragments.len).step_by(16) {
            let slots = OfSlots::<S, PAGES>(lanes.slots(&fragments.slots, at));
            let second = lanes.load(&barycentrics.weights[0], at);
            let third = lanes.load(&barycentrics.weights[1], at);
            let w = lanes.load(&barycentrics.w, at);
            let texel = texture.texel(simd, &slots, [second, third], w);
            store(lanes, product(load(lanes, to, at), texel), to, at);
        }
    }
}

/// The product of two colours.
#[inline(always)]
pub(crate) fn product<R: Real>(Vec3([r, g, b]): Vec3<R>, Vec3([x, y, z]): Vec3<R>) -> Vec3<R> {
    Vec3([r * x, g * y, b * z])
}

/// The triangles of sixteen pixels.
pub(crate) trait Triangles<S: Simd> {
    /// The numbers of the triangles in a row.
    fn pick(&self, simd: S, row: &[f32; SLOTS]) -> f32x16<S>;
}

/// Those of some slots, all below `PAGES` times sixteen.
struct OfSlots<S: Simd, const PAGES: usize>(i32x16<S>);

impl<S: Simd, const PAGES: usize> Triangles<S> for OfSlots<S, PAGES> {
    #[inline(always)]
    fn pick(&self, simd: S, row: &[f32; SLOTS]) -> f32x16<S> {
        Sixteen(simd).pick::<PAGES>(row, self.0)
    }
}

/// The first triangle of the list.
pub(crate) struct OfFirst;

impl<S: Simd> Triangles<S> for OfFirst {
    #[inline(always)]
    fn pick(&self, simd: S, row: &[f32; SLOTS]) -> f32x16<S> {
        f32x16::splat(simd, row[0])
    }
}

impl PlacedTexture<'_> {
    /// Red, green and blue, as factors, at sixteen points with these perspective-correct weights of
    /// the second and third corner, and this w.
    #[inline(always)]
    pub(crate) fn texel<S: Simd>(
        &self,
        simd: S,
        of: &impl Triangles<S>,
        weights: [f32x16<S>; 2],
        w: f32x16<S>,
    ) -> Vec3<f32x16<S>> {
        let way = [self.way(simd, of, weights, 0), self.way(simd, of, weights, 1)];
        let position = [self.position(simd, of, way[0], 0), self.position(simd, of, way[1], 1)];
        self.sampler.sample(
            simd,
            position,
            #[inline(always)]
            || {
                let right = self.to_neighbour(simd, of, (way, w), 0);
                Real::max(right, self.to_neighbour(simd, of, (way, w), 1))
            },
        )
    }

    /// The texels from the first corner to the point along an axis.
    #[inline(always)]
    fn way<S: Simd>(
        &self,
        simd: S,
        of: &impl Triangles<S>,
        [second, third]: [f32x16<S>; 2],
        axis: usize,
    ) -> f32x16<S> {
        of.pick(simd, &self.placement.second[axis]) * second
            + of.pick(simd, &self.placement.third[axis]) * third
    }

    /// The position of the point along an axis, in texels.
    #[inline(always)]
    fn position<S: Simd>(
        &self,
        simd: S,
        of: &impl Triangles<S>,
        way: f32x16<S>,
        axis: usize,
    ) -> f32x16<S> {
        let texels = of.pick(simd, &self.placement.first[axis]) + way;
        let texels = Real::max(texels, of.pick(simd, &self.placement.low[axis]));
        Real::min(texels, of.pick(simd, &self.placement.high[axis]))
    }

    /// The square of the distance in texels to the next pixel on the right (0) or below (1). With
    /// u = U w, where U and 1/w change by dU and d to that pixel:
    ///
    ///   (U + dU) / (1/w + d) - U w = (dU - u d) w / (1 + w d)
    #[inline(always)]
    fn to_neighbour<S: Simd>(
        &self,
        simd: S,
        of: &impl Triangles<S>,
        ([u, v], w): ([f32x16<S>; 2], f32x16<S>),
        which: usize,
    ) -> f32x16<S> {
        let Placement { steps, by_w_steps, .. } = self.placement;
        let by_w = of.pick(simd, &by_w_steps[which]);
        let per = w / (by_w * w + 1.0);
        let u = (of.pick(simd, &steps[which][0]) - u * by_w) * per;
        let v = (of.pick(simd, &steps[which][1]) - v * by_w) * per;
        u * u + v * v
    }
}

/// The [`Steps`] of a triangle; `None` if it has no area.
pub(crate) fn steps<T: AttributeNumber>(
    (plan, draw): (&FramePlan, &Draw),
    attributes: &TriangleAttributes<T>,
    slot: usize,
) -> Option<Steps> {
    if attributes.cut >> slot & 1 == 1 {
        let number = attributes.numbers[slot];
        return Some(HomogeneousWeights::new(plan, draw, number, [0; 2]).steps());
    }
    let corners = attributes.corners(slot);
    let [a, b, c] = corners.map(|corner| [corner.x, corner.y].map(f64::from));
    #[expect(clippy::cast_precision_loss, reason = "the nearest number is meant")]
    let area = doubled_area(corners) as f64;
    if area == 0.0 {
        return None;
    }
    let by_w: [f64; 3] = [0, 1, 2].map(|corner| attributes.by_w[corner][slot].into());
    let per_pixel = f64::from(SUBPIXELS) / area;
    // Of the barycentric coordinates of the second and the third corner.
    let right = [c[1] - a[1], a[1] - b[1]].map(|step| step * per_pixel);
    let down = [a[0] - c[0], b[0] - a[0]].map(|step| step * per_pixel);
    Some(
        [right, down].map(|[second, third]| {
            [-(second + third) * by_w[0], second * by_w[1], third * by_w[2]]
        }),
    )
}

/// The footprint of a pixel: the differences of uv to its neighbours on the right and below.
#[cold]
pub(crate) fn uv_ways(
    (plan, frame): (&FramePlan, &ScreenGeometry),
    draw_index: u32,
    number: u32,
    [x, y]: [i32; 2],
) -> [[f64; 2]; 2] {
    let draw = &plan.draws[draw_index as usize];
    let Some(uvs) = uvs(draw, number) else { return [[0.0; 2]; 2] };
    let corners = frame.corners_of(plan, draw_index);
    let parts = Weights::new(plan, draw, corners, number, [0; 2]);
    let at = |pixel: [i32; 2]| -> [f64; 2] {
        let weights = parts.at(pixel).to_array();
        [0, 1].map(|axis| (0..3).map(|i| weights[i] * uvs[i][axis]).sum())
    };
    let own = at([x, y]);
    [at([x + 1, y]), at([x, y + 1])].map(|it| [it[0] - own[0], it[1] - own[1]])
}

/// The interpolated vertex colour.
#[inline(always)]
pub(crate) fn color(corners: [[f32; 3]; 3], weights: DVec3) -> [f64; 3] {
    let [a, b, c] = each(corners, dvec3);
    (a + (b - a) * weights.y + (c - a) * weights.z).to_array()
}
