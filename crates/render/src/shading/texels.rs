//! Texels of fragments, sixteen at a time, and the footprint of a pixel on its texture.

use fearless_simd::{
    Select as _, Simd, SimdBase as _, SimdMask as _, SimdNarrow as _, SimdWiden as _, f32x16,
    f64x8, i32x16,
};
use glam::DVec3;

use super::fragments::Fragments;
use super::interpolate::Points;
use super::triangle_attributes::{AttributeNumber, TriangleAttributes};
use crate::frame::FramePlan;
use crate::frame::draw::Draw;
use crate::frame::variants::Decoding;
use crate::lights::{Rows, load, store};
use crate::screen::clipped_weights::ClippedWeights;
use crate::screen::coverage::doubled_area;
use crate::screen::homogeneous::HomogeneousWeights;
use crate::simd::gather::{SLOTS, Slots};
use crate::simd::{BATCH, Lanes as _, Real, Sixteen, in_f64};
use crate::texture::exact_placement::ExactPlacement;
use crate::texture::lanes::{Decode, Sampler, Stored, TexelPlaces};
use crate::texture::placement::{Doubles, LaneSteps, Placement, Steps, less};
use crate::texture::sample::brightness;
use crate::texture::uv::Uvs;
use marraztu_core::accuracy::Filter;
use marraztu_core::scene::Texture;

/// The kind of data read from a map.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Texels {
    /// Red, green and blue, multiplied into the rows.
    Colors,
    /// The slopes of heights along u and v, per texel, which replace the first two rows.
    Slopes,
}

/// A texture on the triangles of a list.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlacedTexture<'a> {
    pub(crate) placement: &'a Placement,
    /// The triangles for which f32 is not accurate enough.
    pub(crate) far: &'a [FarTexture],
    pub(crate) sampler: &'a Sampler<'a>,
}

/// A texture on a triangle that spans more texels than f32 can tell apart: positions are computed
/// in f64, and reduced to one repetition before rounding to f32.
#[derive(Clone, Debug)]
pub(crate) struct FarTexture {
    /// The slot of the triangle.
    pub(crate) slot: usize,
    weights: ClippedWeights,
    placement: ExactPlacement,
}

impl FarTexture {
    /// Sets up the triangle of a slot. `None` if its coordinates are too large.
    pub(crate) fn new(
        slot: usize,
        uvs: Uvs,
        texture: &Texture,
        weights: impl FnOnce() -> ClippedWeights,
    ) -> Option<Self> {
        let placement = ExactPlacement::new(uvs, texture)?;
        Some(Self { slot, weights: weights(), placement })
    }

    /// Computes the position at a pixel, in texels.
    pub(crate) fn at(&self, pixel: [i32; 2]) -> [f32; 2] {
        self.placement.at(self.weights.at(pixel).0)
    }

    /// Computes the positions in two rows of eight pixels, with the same bits as [`Self::at`].
    #[inline(always)]
    pub(crate) fn of_two_rows<S: Simd>(&self, simd: S, [x, y]: [i32; 2]) -> [f32x16<S>; 2] {
        let (upper, _) = self.weights.of_row(simd, [x, y]);
        let (lower, _) = self.weights.of_row(simd, [x, y + 1]);
        let ([u, v], [u_below, v_below]) =
            (self.placement.of_row(upper), self.placement.of_row(lower));
        [u.narrow(u_below), v.narrow(v_below)]
    }
}

/// The inputs for sampling the texels of some fragments.
#[derive(Debug)]
pub(crate) struct TextureSamples<'a, T> {
    pub(crate) points: Points<'a, T>,
    pub(crate) texture: PlacedTexture<'a>,
    pub(crate) decoding: Decoding,
}

/// The output of sampling. It is reused from list to list and never cleared.
#[derive(Debug)]
pub(crate) struct TexelScratch {
    pub(crate) places: TexelPlaces,
    pub(crate) texels: Rows<f32>,
    /// The vertex colours of a full block.
    pub(crate) colors: Rows<f32>,
}

impl Default for TexelScratch {
    fn default() -> Self {
        let rows = [[0.0; BATCH]; 3];
        Self { places: TexelPlaces::default(), texels: rows, colors: rows }
    }
}

impl TextureSamples<'_, f32> {
    /// Multiplies colours by the texels of all fragments. Triangles without a known placement get
    /// arbitrary factors.
    #[inline(always)]
    pub(crate) fn multiply<S: Simd, D: Decode>(
        &self,
        simd: S,
        TexelScratch { places, texels, .. }: &mut TexelScratch,
        to: &mut Rows<f32>,
    ) {
        let Self { points: Points { fragments, .. }, texture, .. } = *self;
        let lanes = Sixteen(simd);
        self.place(simd, places);
        texture.sampler.sample::<S, D>(simd, places, fragments.len, texels);
        for at in (0..fragments.len).step_by(16) {
            let texel = load(lanes, texels, at);
            store(lanes, load(lanes, to, at).product(texel), to, at);
        }
    }

    /// Computes the places of all fragments.
    #[inline(always)]
    fn place<S: Simd>(&self, simd: S, to: &mut TexelPlaces) {
        let Self { points: Points { fragments, attributes, barycentrics }, texture, .. } = *self;
        let lanes = Sixteen(simd);
        for at in (0..fragments.len).step_by(16) {
            let slots = OfSlots(lanes.slots((&fragments.slots, attributes.count), at));
            let w = lanes.load(&barycentrics.w, at);
            let way = texture.way(simd, &slots, barycentrics.weights_at(lanes, at));
            let mut position = texture.position(simd, &slots, way);
            // Rarely needed: f32 cannot tell apart the texels of some triangles.
            if !texture.far.is_empty() {
                position = self.far_positions(simd, at, position);
            }
            texture.put(simd, &slots, (way, w), position, (to, at));
        }
    }

    /// Computes the slopes of heights at all fragments, per texel along u and v, into the first two
    /// rows.
    #[inline(always)]
    pub(crate) fn slopes<S: Simd>(
        &self,
        simd: S,
        TexelScratch { places, texels, .. }: &mut TexelScratch,
        to: &mut Rows<f32>,
    ) {
        let Self { points: Points { fragments, .. }, texture, .. } = *self;
        let lanes = Sixteen(simd);
        self.place(simd, places);
        // A copy, because the places are moved for each of the four heights.
        let own = places.position;
        let mut heights = [[0.0; BATCH]; 4];
        // Central differences: heights one texel to the right, left, above and below.
        let beside = [[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]];
        for (heights, beside) in heights.iter_mut().zip(beside) {
            for axis in 0..2 {
                for at in (0..fragments.len).step_by(16) {
                    let position = lanes.load(&own[axis], at) + beside[axis];
                    lanes.store(position, &mut places.position[axis], at);
                }
            }
            texture.sampler.sample::<S, Stored>(simd, places, fragments.len, texels);
            for at in (0..fragments.len).step_by(16) {
                lanes.store(brightness(load(lanes, texels, at)), heights, at);
            }
        }
        let [right, left, above, below] = &heights;
        for at in (0..fragments.len).step_by(16) {
            let across = (lanes.load(right, at) - lanes.load(left, at)) * 0.5;
            let up = (lanes.load(above, at) - lanes.load(below, at)) * 0.5;
            lanes.store(across, &mut to[0], at);
            lanes.store(up, &mut to[1], at);
        }
    }
}

impl<T> TextureSamples<'_, T> {
    /// Replaces the positions of sixteen fragments in triangles for which f32 is not accurate
    /// enough.
    #[cold]
    fn far_positions<S: Simd>(
        &self,
        simd: S,
        at: usize,
        positions: [f32x16<S>; 2],
    ) -> [f32x16<S>; 2] {
        let mut rows = [<[f32; 16]>::from(positions[0]), <[f32; 16]>::from(positions[1])];
        let Fragments { len, x, y, slots, .. } = self.points.fragments;
        for lane in 0..16.min(len - at) {
            let slot = slots[at + lane].cast_unsigned() as usize;
            if let Some(far) = self.texture.far.iter().find(|far| far.slot == slot) {
                let [u, v] = far.at([x[at + lane], y[at + lane]]);
                (rows[0][lane], rows[1][lane]) = (u, v);
            }
        }
        [f32x16::from_slice(simd, &rows[0]), f32x16::from_slice(simd, &rows[1])]
    }
}

/// The triangles of sixteen pixels.
pub(crate) trait Triangles<S: Simd> {
    /// Picks the numbers of the triangles in a row.
    fn pick(&self, simd: S, row: &[f32; SLOTS]) -> f32x16<S>;
}

/// The triangles in some slots.
struct OfSlots<S: Simd>(Slots<S>);

impl<S: Simd> Triangles<S> for OfSlots<S> {
    #[inline(always)]
    fn pick(&self, simd: S, row: &[f32; SLOTS]) -> f32x16<S> {
        Sixteen(simd).pick(row, self.0)
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
    /// Stores sixteen places on the texture in a row: their positions and, for mipmaps, their
    /// footprints, from the offsets in texels from the first corner and from w.
    #[inline(always)]
    pub(crate) fn put<S: Simd>(
        &self,
        simd: S,
        of: &impl Triangles<S>,
        way: ([f32x16<S>; 2], f32x16<S>),
        position: [f32x16<S>; 2],
        (to, at): (&mut TexelPlaces, usize),
    ) {
        let lanes = Sixteen(simd);
        lanes.store(position[0], &mut to.position[0], at);
        lanes.store(position[1], &mut to.position[1], at);
        if self.sampler.filter.reads_mips() {
            let [right, below] = [0, 1].map(|which| self.step(simd, of, way, which));
            let squared = |[u, v]: [f32x16<S>; 2]| u * u + v * v;
            // The longer step selects the mipmap; anisotropic filtering needs the shorter one, too.
            let squares = [squared(right), squared(below)];
            lanes.store(Real::max(squares[0], squares[1]), &mut to.footprint, at);
            if self.sampler.filter == Filter::Anisotropic {
                lanes.store(Real::min(squares[0], squares[1]), &mut to.shorter, at);
                let is_right = squares[0].simd_ge(squares[1]);
                for axis in 0..2 {
                    let longer = is_right.select(right[axis], below[axis]);
                    lanes.store(longer, &mut to.longer[axis], at);
                }
            }
        }
    }

    /// Returns the texels from the first corner to the point with these weights of the second and
    /// third.
    #[inline(always)]
    pub(crate) fn way<S: Simd>(
        &self,
        simd: S,
        of: &impl Triangles<S>,
        [b, c]: [f32x16<S>; 2],
    ) -> [f32x16<S>; 2] {
        let Placement { second, third, .. } = self.placement;
        [
            of.pick(simd, &second[0]) * b + of.pick(simd, &third[0]) * c,
            of.pick(simd, &second[1]) * b + of.pick(simd, &third[1]) * c,
        ]
    }

    /// Returns the position in texels, for this offset in texels from the first corner.
    #[inline(always)]
    pub(crate) fn position<S: Simd>(
        &self,
        simd: S,
        of: &impl Triangles<S>,
        [u, v]: [f32x16<S>; 2],
    ) -> [f32x16<S>; 2] {
        [self.clamped(simd, of, u, 0), self.clamped(simd, of, v, 1)]
    }

    #[inline(always)]
    fn clamped<S: Simd>(
        &self,
        simd: S,
        of: &impl Triangles<S>,
        way: f32x16<S>,
        axis: usize,
    ) -> f32x16<S> {
        let texels = of.pick(simd, &self.placement.first[axis]) + way;
        // Rounding must not leave the range of the corners.
        let texels = Real::max(texels, of.pick(simd, &self.placement.low[axis]));
        Real::min(texels, of.pick(simd, &self.placement.high[axis]))
    }

    /// Returns the texels along u and v to the next pixel on the right (0) or below (1). With
    /// u = U w, where U and 1/w change by dU and d to that pixel:
    ///
    ///   (U + dU) / (1/w + d) - U w = (dU - u d) w / (1 + w d)
    #[inline(always)]
    fn step<S: Simd>(
        &self,
        simd: S,
        of: &impl Triangles<S>,
        ([u, v], w): ([f32x16<S>; 2], f32x16<S>),
        which: usize,
    ) -> [f32x16<S>; 2] {
        let Placement { steps, by_w_steps, .. } = self.placement;
        let by_w = of.pick(simd, &by_w_steps[which]);
        let per = w / (by_w * w + 1.0);
        let u = (of.pick(simd, &steps[which][0]) - u * by_w) * per;
        let v = (of.pick(simd, &steps[which][1]) - v * by_w) * per;
        [u, v]
    }
}

/// Computes the [`Steps`] of a triangle, from one lit sample to the next. `None` if it has no area.
pub(crate) fn steps<T: AttributeNumber>(
    (plan, draw): (&FramePlan, &Draw),
    attributes: &TriangleAttributes<T>,
    slot: usize,
) -> Option<Steps> {
    if let Some(steps) = attributes.footprints.get(slot) {
        return Some(*steps);
    }
    if attributes.cut >> slot & 1 == 1 {
        // Clipped triangles have no screen corners, but homogeneous weights are linear as well.
        let number = attributes.numbers[slot];
        let steps = HomogeneousWeights::new(plan, draw, number, [0; 2]).steps();
        return Some(steps.map(|steps| steps.map(|step| step * plan.spacing)));
    }
    let corners = attributes.corners(slot);
    let [a, b, c] = corners.map(|corner| [corner.x, corner.y].map(f64::from));
    #[expect(clippy::cast_precision_loss, reason = "the nearest number is meant")]
    let area = doubled_area(corners) as f64;
    if area == 0.0 {
        return None;
    }
    let by_w: [f64; 3] = [0, 1, 2].map(|corner| attributes.by_w[corner][slot].into());
    let per_pixel = attributes.parts_per_sample() / area;
    // The steps of the barycentric coordinates of the second and third corner.
    let right = [c[1] - a[1], a[1] - b[1]].map(|step| step * per_pixel);
    let down = [a[0] - c[0], b[0] - a[0]].map(|step| step * per_pixel);
    // The weights add up to 1, so the first one falls by the sum of the others' steps.
    Some(
        [right, down].map(|[second, third]| {
            [-(second + third) * by_w[0], second * by_w[1], third * by_w[2]]
        }),
    )
}

/// Computes the [`Steps`] of sixteen triangles, starting at slot `at`, with the bits of [`steps`].
/// Also returns a bit mask of triangles with meaningless steps: clipped, wide, or without area.
#[inline(always)]
pub(super) fn lane_steps<S: Simd>(
    simd: S,
    attributes: &TriangleAttributes<f32>,
    at: usize,
) -> (LaneSteps<S>, u64) {
    let [ax, ay] = places(simd, &attributes.corners[0], at);
    let [bx, by] = places(simd, &attributes.corners[1], at);
    let [cx, cy] = places(simd, &attributes.corners[2], at);
    let [w0, w1, w2] = &attributes.by_w;
    // All corners as f64, for sixteen triangles in two halves.
    let by_w = [wide(simd, w0, at), wide(simd, w1, at), wide(simd, w2, at)];
    let (b, c) = ([less(bx, ax), less(by, ay)], [less(cx, ax), less(cy, ay)]);
    let parts = attributes.parts_per_sample();
    let zero = f64x8::splat(simd, 0.0);
    let (mut steps, mut flat) = ([[[zero; 2]; 3]; 2], 0);
    for half in 0..2 {
        // Sides of triangles that are not wide have 20 bits, so this is exact.
        let area = b[0][half] * c[1][half] - b[1][half] * c[0][half];
        flat |= area.simd_eq(0.0).to_bitmask() << (8 * half);
        let per_pixel = f64x8::splat(simd, parts) / area;
        let right = [(cy[half] - ay[half]) * per_pixel, (ay[half] - by[half]) * per_pixel];
        let down = [(ax[half] - cx[half]) * per_pixel, (bx[half] - ax[half]) * per_pixel];
        for (steps, [second, third]) in steps.iter_mut().zip([right, down]) {
            steps[0][half] = -(second + third) * by_w[0][half];
            steps[1][half] = second * by_w[1][half];
            steps[2][half] = third * by_w[2][half];
        }
    }
    (steps, flat | (attributes.cut | attributes.wide) >> at & 0xffff)
}

/// Returns x and y of one corner of sixteen triangles.
#[inline(always)]
fn places<S: Simd>(simd: S, [x, y]: &[[i32; SLOTS]; 2], at: usize) -> [Doubles<S>; 2] {
    let (x, y) = (&x[at..at + 16], &y[at..at + 16]);
    [in_f64(i32x16::from_slice(simd, x)), in_f64(i32x16::from_slice(simd, y))]
}

/// Returns sixteen numbers of a row.
#[inline(always)]
fn wide<S: Simd>(simd: S, row: &[f32; SLOTS], at: usize) -> Doubles<S> {
    let (low, high) = Sixteen(simd).load(row, at).widen();
    [low, high]
}

/// Computes the footprint of a pixel with these perspective-correct weights and w: the differences
/// of uv to its neighbours on the right and below. See [`PlacedTexture::step`].
pub(crate) fn footprint([a, b, c]: Uvs, weights: DVec3, w: f64, steps: Steps) -> [[f64; 2]; 2] {
    steps.map(|[first, second, third]| {
        let by_w = first + second + third;
        let per = w / (1.0 + w * by_w);
        [0, 1].map(|axis| {
            let (b, c) = (b[axis] - a[axis], c[axis] - a[axis]);
            let way = b * weights.y + c * weights.z;
            (b * second + c * third - way * by_w) * per
        })
    })
}
