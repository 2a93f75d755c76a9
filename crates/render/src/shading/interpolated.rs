//! The two precisions of shading: the barycentric coordinates of fragments in each, and the fast
//! paths of f32.

use crate::simd::dispatch;
use fearless_simd::{
    Level, Select as _, Simd, SimdBase as _, SimdInt as _, SimdMask as _, SimdNarrow as _, f32x16,
    f64x8, i32x16,
};
use glam::DVec3;

use super::barycentrics::{Barycentrics, Weigh};
use super::context::Group;
use super::fragments::Fragments;
use super::full_blocks::Wide;
use super::texels::{TexelScratch, Texels, TextureSamples, lane_steps};
use super::triangle_attributes::{AttributeNumber, TriangleAttributes, picked};
use crate::frame::FramePlan;
use crate::frame::draw::Draw;
use crate::frame::shading_mode::ShadingMode;
use crate::frame::variants::Decoding;
use crate::lights::{Rows, set};
use crate::screen::clipped_weights::ClippedWeights;
use crate::screen::coverage::Triangle;
use crate::screen::homogeneous::barycentric;
use crate::screen::weights::cut_place;
use crate::simd::gather::{SLOTS, Slots, pick};
use crate::simd::{Bits, Lanes as _, Sixteen, in_f64};
use crate::texture::lanes::{Linear, Stored};
use crate::texture::placement::{Placement, UvRows};
use marraztu_core::accuracy::Interpolation;
use marraztu_core::scene::Texture;

/// A number type in which fragments are shaded. The defaults are those of f64, which has no fast
/// paths: they handle nothing.
#[expect(unused_variables, reason = "the defaults read nothing")]
pub(crate) trait ShadingNumber: AttributeNumber {
    /// Computes all barycentric coordinates sixteen pixels at a time, if the triangles allow it.
    /// Returns whether they do.
    fn find(
        interpolation: Interpolation,
        level: Level,
        fragments: &Fragments,
        attributes: &TriangleAttributes<Self>,
        to: &mut Barycentrics<Self>,
    ) -> bool {
        false
    }
    /// Computes the linear barycentric coordinates, except in wide triangles.
    fn find_linear(
        level: Level,
        fragments: &Fragments,
        attributes: &TriangleAttributes<Self>,
        to: &mut Barycentrics<Self>,
    ) {
    }
    /// Places a texture on triangles with these texture coordinates, sixteen at a time. Steps are
    /// only needed for mipmaps. Returns a bit mask of the slots that were handled.
    fn place_texture(
        level: Level,
        attributes: &TriangleAttributes<Self>,
        texture: (&Texture, (&UvRows, bool)),
        to: &mut Placement,
    ) -> u64 {
        0
    }
    /// Reads texels at fragments, if this works sixteen pixels at a time: see
    /// [`TextureSamples::multiply`] and [`TextureSamples::slopes`]. Returns a bit mask of the slots
    /// that were handled.
    fn read_texels(
        level: Level,
        samples: &TextureSamples<'_, Self>,
        what: Texels,
        to: (&mut TexelScratch, &mut Rows<Self>),
    ) -> u64 {
        0
    }
}

impl<T: ShadingNumber> Barycentrics<T> {
    /// Computes the barycentric coordinates of every fragment.
    pub(crate) fn find(
        &mut self,
        level: Level,
        fragments: &Fragments,
        attributes: &TriangleAttributes<T>,
        group: &Group<'_, T>,
    ) {
        let &ShadingMode { interpolation, clamps, .. } = group.context.mode();
        // The quick path needs pixel centres inside of their triangles.
        let outside = fragments.shared || clamps;
        if outside || !T::find(interpolation, level, fragments, attributes, self) {
            self.find_step_by_step(level, fragments, attributes, group);
        }
    }

    /// Computes the coordinates for all kinds of triangles, and for pixels with centres outside.
    fn find_step_by_step(
        &mut self,
        level: Level,
        fragments: &Fragments,
        attributes: &TriangleAttributes<T>,
        group: &Group<'_, T>,
    ) {
        let &ShadingMode { interpolation, clamps, .. } = group.context.mode();
        // Linear coordinates first; then pixels outside are clamped; then perspective is applied.
        T::find_linear(level, fragments, attributes, self);
        self.find_wide(fragments, attributes);
        if fragments.shared {
            self.clamp_to_triangle(level, fragments, attributes);
        }
        T::run(level, Weigh { interpolation, clamps, fragments, attributes, to: self });
        if attributes.cut != 0 {
            self.find_cut(fragments, attributes, group.context.plan, group.draw);
        }
    }

    /// Computes the coordinates in clipped triangles, one pixel at a time.
    #[cold]
    fn find_cut(
        &mut self,
        fragments: &Fragments,
        attributes: &TriangleAttributes<T>,
        plan: &FramePlan,
        draw: &Draw,
    ) {
        for slot in Bits(attributes.cut & (u64::MAX >> (SLOTS - attributes.count))) {
            let number = attributes.numbers[slot];
            // One set-up per triangle serves all of its pixels.
            let of = ClippedWeights::new(plan, draw, number, [0; 2]);
            for i in
                (0..fragments.len).filter(|i| fragments.slots[*i].cast_unsigned() as usize == slot)
            {
                let ([second, third], w) = of.at([fragments.x[i], fragments.y[i]]);
                self.weights[0][i] = T::from_f64(second);
                self.weights[1][i] = T::from_f64(third);
                self.w[i] = T::from_f64(w);
                // Perspective-correct weights are clamped to the triangle, and light is evaluated
                // at their point.
                if fragments.shared {
                    let ([second, third], _) = of.exact().at([fragments.x[i], fragments.y[i]]);
                    let weights = DVec3::new(1.0 - second - third, second, third);
                    let place = cut_place(plan, draw, number, weights);
                    for (row, place) in self.positions.iter_mut().zip(place) {
                        row[i] = T::from_f64(place);
                    }
                }
            }
        }
    }

    /// Computes the linear coordinates in wide triangles, with 64-bit integers.
    fn find_wide(&mut self, fragments: &Fragments, attributes: &TriangleAttributes<T>) {
        let (mut last, mut triangle) = (usize::MAX, None);
        for i in 0..fragments.len {
            let slot = fragments.slots[i].cast_unsigned() as usize;
            if attributes.wide >> slot & 1 == 0 {
                continue;
            }
            if slot != last {
                (last, triangle) = (slot, Triangle::on(attributes.grid, attributes.corners(slot)));
            }
            if let Some(triangle) = &triangle {
                let [second, third] = barycentric(triangle, [fragments.x[i], fragments.y[i]]);
                self.linear[0][i] = T::from_f64(second);
                self.linear[1][i] = T::from_f64(third);
            }
        }
    }
}

impl ShadingNumber for f64 {}

impl ShadingNumber for f32 {
    fn find(
        interpolation: Interpolation,
        level: Level,
        fragments: &Fragments,
        attributes: &TriangleAttributes<Self>,
        to: &mut Barycentrics<Self>,
    ) -> bool {
        // A list of a single wide triangle needs no gathering.
        let wide = attributes.count == 1 && attributes.wide == 1;
        if wide && let Some(triangle) = Triangle::on(attributes.grid, attributes.corners(0)) {
            dispatch!(level, simd => {
                find_in_one(interpolation, simd, fragments, &triangle, attributes, to);
            });
            return true;
        }
        // Clipped triangles have no edge functions.
        if attributes.cut != 0 {
            return false;
        }
        dispatch!(level, simd => find_narrow(interpolation, simd, fragments, attributes, to));
        // Wide triangles among others are computed again in f64.
        for slot in Bits(attributes.wide) {
            let corners = attributes.corners(slot);
            let Some(triangle) = Triangle::on(attributes.grid, corners) else { continue };
            dispatch!(level, simd => {
                let of = (slot, &triangle);
                find_among(interpolation, simd, fragments, of, attributes, to);
            });
        }
        true
    }

    fn find_linear(
        level: Level,
        fragments: &Fragments,
        attributes: &TriangleAttributes<Self>,
        to: &mut Barycentrics<Self>,
    ) {
        // Only the linear coordinates are used: weights are computed again after clamping.
        let perspective = Interpolation::Perspective;
        dispatch!(level, simd => find_narrow(perspective, simd, fragments, attributes, to));
    }

    fn place_texture(
        level: Level,
        attributes: &TriangleAttributes<Self>,
        (texture, (uvs, reads_mips)): (&Texture, (&UvRows, bool)),
        to: &mut Placement,
    ) -> u64 {
        let mut done = 0;
        dispatch!(level, simd => for at in (0..attributes.count).step_by(16) {
            // Triangles with meaningless steps are placed one by one.
            let steps = reads_mips.then(|| lane_steps(simd, attributes, at));
            let (steps, odd) = steps.map_or((None, 0), |(steps, odd)| (Some(steps), odd));
            done |= (to.set_sixteen(simd, (uvs, at), texture, steps) & !odd) << at;
        });
        done
    }

    fn read_texels(
        level: Level,
        samples: &TextureSamples<'_, Self>,
        what: Texels,
        (scratch, to): (&mut TexelScratch, &mut Rows<Self>),
    ) -> u64 {
        dispatch!(level, simd => match (what, samples.decoding) {
            (Texels::Colors, Decoding::Stored) => samples.multiply::<_, Stored>(simd, scratch, to),
            (Texels::Colors, Decoding::Linear) => samples.multiply::<_, Linear>(simd, scratch, to),
            // Heights are numbers and are never decoded.
            (Texels::Slopes, _) => samples.slopes(simd, scratch, to),
        });
        samples.texture.placement.known
    }
}

/// Computes the coordinates in narrow triangles.
#[inline(always)]
fn find_narrow<S: Simd>(
    interpolation: Interpolation,
    simd: S,
    fragments: &Fragments,
    attributes: &TriangleAttributes<f32>,
    to: &mut Barycentrics<f32>,
) {
    let lanes = Sixteen(simd);
    for at in (0..fragments.len).step_by(16) {
        let slots = lanes.slots((&fragments.slots, attributes.count), at);
        let x = i32x16::from_slice(simd, &fragments.x[at..at + 16]);
        let y = i32x16::from_slice(simd, &fragments.y[at..at + 16]);
        let per_area = lanes.pick(&attributes.per_area, slots);
        let second = edge(simd, &attributes.edges[0], slots, [x, y]) * per_area;
        let third = edge(simd, &attributes.edges[1], slots, [x, y]) * per_area;
        lanes.store(second, &mut to.linear[0], at);
        lanes.store(third, &mut to.linear[1], at);
        let by_w = picked(lanes, &attributes.by_w, slots);
        to.put(interpolation, lanes, at, [second, third], by_w);
    }
}

/// Computes the coordinates in one wide triangle of a list that shows others, too. The coordinates
/// in the other triangles are already known.
#[inline(always)]
#[expect(clippy::cast_precision_loss, reason = "they have fewer than 53 bits")]
fn find_among<S: Simd>(
    interpolation: Interpolation,
    simd: S,
    fragments: &Fragments,
    (slot, triangle): (usize, &Triangle),
    attributes: &TriangleAttributes<f32>,
    to: &mut Barycentrics<f32>,
) {
    let lanes = Sixteen(simd);
    let slot = i32::try_from(slot).expect("there are 64 slots");
    let [[_, er, fr], [_, ed, fd]] = triangle.steps();
    // Relative to the first fragment: the integers stay small enough for f64.
    let [left, top] = [fragments.x[0], fragments.y[0]];
    let [_, e, f] = triangle.edges_at(left, top);
    let per_area = 1.0 / triangle.doubled_area() as f64;
    let second = [er as f64, ed as f64, e as f64, per_area];
    let third = [fr as f64, fd as f64, f as f64, per_area];
    for at in (0..fragments.len).step_by(16) {
        let slots = lanes.slots((&fragments.slots, attributes.count), at);
        let own = slots.lanes.simd_eq(slot);
        if !own.any_true() {
            continue;
        }
        let x = in_f64(i32x16::from_slice(simd, &fragments.x[at..at + 16]) - left);
        let y = in_f64(i32x16::from_slice(simd, &fragments.y[at..at + 16]) - top);
        // Lanes of other triangles keep their coordinates.
        let second = own.select(plane(second, x, y), lanes.load(&to.linear[0], at));
        let third = own.select(plane(third, x, y), lanes.load(&to.linear[1], at));
        lanes.store(second, &mut to.linear[0], at);
        lanes.store(third, &mut to.linear[1], at);
        let by_w = picked(lanes, &attributes.by_w, slots);
        to.put(interpolation, lanes, at, [second, third], by_w);
    }
}

/// Computes (a x + b y + c) d at sixteen places. The sum has integers that f64 holds exactly.
#[inline(always)]
fn plane<S: Simd>([a, b, c, d]: [f64; 4], x: [f64x8<S>; 2], y: [f64x8<S>; 2]) -> f32x16<S> {
    let low = (x[0] * a + y[0] * b + c) * d;
    low.narrow((x[1] * a + y[1] * b + c) * d)
}

/// Computes an edge function of narrow triangles. It is exact in 32 bits: products may wrap, but
/// the sum fits.
#[inline(always)]
fn edge<S: Simd>(
    simd: S,
    [a, b, c]: &[[i32; SLOTS]; 3],
    slots: Slots<S>,
    [x, y]: [i32x16<S>; 2],
) -> f32x16<S> {
    let a = pick(simd, a, slots);
    let b = pick(simd, b, slots);
    let c = pick(simd, c, slots);
    (a * x + b * y + c).to_float()
}

/// Computes the coordinates in one wide triangle.
#[inline(always)]
fn find_in_one<S: Simd>(
    interpolation: Interpolation,
    simd: S,
    fragments: &Fragments,
    triangle: &Triangle,
    attributes: &TriangleAttributes<f32>,
    to: &mut Barycentrics<f32>,
) {
    let lanes = Sixteen(simd);
    let wide = Wide::new(simd, triangle);
    let [w0, w1, w2] = attributes.by_w;
    let by_w = set(lanes, [w0[0], w1[0], w2[0]]);
    // A whole block needs no pixel positions.
    if fragments.is_whole() {
        for (pair, linear) in wide.block([fragments.x[0], fragments.y[0]]).into_iter().enumerate() {
            to.put(interpolation, lanes, 16 * pair, linear, by_w);
        }
        return;
    }
    for at in (0..fragments.len).step_by(16) {
        let linear = wide.scattered(simd, &fragments.x[at..at + 16], &fragments.y[at..at + 16]);
        to.put(interpolation, lanes, at, linear, by_w);
    }
}

#[cfg(test)]
#[expect(clippy::cast_possible_truncation, reason = "the nearest f32 is meant")]
mod tests {
    use super::*;
    use crate::screen::clip::ScreenVertex;
    use crate::screen::coverage::Snapped;
    use crate::simd::Kernel as _;

    #[test]
    fn wide_triangles_among_others_have_the_coordinates_that_they_have_alone() {
        let level = Level::new();
        let corner = |[x, y]: [i32; 2], inverse_w| {
            ScreenVertex::placed(Snapped { x: x * 256, y: y * 256 }, 0.5, inverse_w)
        };
        let vertices = [
            corner([0, 0], 0.5),
            corner([64, 1], 0.25),
            corner([3, 64], 0.125),
            corner([-7, -1000], 0.75),
            corner([1500, 700], 0.5),
            corner([-2000, 900], 0.25),
        ];
        let attributes = TriangleAttributes::<f32>::of(level, &[[0, 1, 2], [3, 4, 5]], &vertices);
        assert_eq!((attributes.cut, attributes.wide), (0, 0b10));
        let wide = Triangle::on(attributes.grid, attributes.corners(1)).unwrap();
        let word = |i: usize| 1 << 62 | u64::from(!u32::from(i % 5 > 2));
        let mut fragments = Fragments::default();
        fragments.list(level, &std::array::from_fn(word), [8, 16], 0);
        let interpolation = Interpolation::Perspective;
        let mut found = Barycentrics::default();
        assert!(f32::find(interpolation, level, &fragments, &attributes, &mut found));
        let mut linear = Barycentrics::default();
        f32::find_linear(level, &fragments, &attributes, &mut linear);
        for i in (0..fragments.len).filter(|i| fragments.slots[*i] == 1) {
            let [second, third] = barycentric(&wide, [fragments.x[i], fragments.y[i]]);
            (linear.linear[0][i], linear.linear[1][i]) = (second as f32, third as f32);
        }
        assert!(found.linear == linear.linear);
        let (fragments, attributes) = (&fragments, &attributes);
        let to = &mut linear;
        let all = Weigh::<f32> { interpolation, clamps: false, fragments, attributes, to };
        dispatch!(level, simd => all.run(Sixteen(simd)));
        assert!(found.weights == linear.weights && found.w == linear.w);
    }
}
