//! How fragments find where they lie in their triangles, in each of the two precisions.

use fearless_simd::{Level, Simd, SimdBase as _, SimdInt as _, dispatch, f32x16, i32x16};

use super::barycentrics::{Barycentrics, Perspective};
use super::fragments::Fragments;
use super::full_blocks::{self, BlockLight, Blocks, Canvas, Linear as _, Wide};
use super::triangle_attributes::{Faced, TriangleAttributes, picked};
use crate::render::frame::FramePlan;
use crate::render::frame::draw::Draw;
use crate::render::lights::{Batch, Light, set};
use crate::render::screen::coverage::Triangle;
use crate::render::screen::weights::{barycentric, cut_place, cut_w, cut_weights};
use crate::render::simd::gather::{SLOTS, paged, pick};
use crate::render::simd::{Lanes as _, Sixteen};

/// Numbers that are interpolated.
pub(crate) trait Interpolated: Faced {
    /// Finds where every pixel lies, where the triangles allow it to be done sixteen pixels at a time;
    /// says whether they do.
    fn find(
        level: Level,
        items: &Fragments,
        faces: &TriangleAttributes<Self>,
        to: &mut Barycentrics<Self>,
    ) -> bool;
    /// Finds the linear barycentric coordinates, but for those of wide triangles.
    fn find_linear(
        level: Level,
        items: &Fragments,
        faces: &TriangleAttributes<Self>,
        to: &mut Barycentrics<Self>,
    );
    /// Mixes the colours that the corners of one triangle carry in blocks of a tile that it covers as
    /// a whole, where that can be done in one pass; says whether it can.
    fn mix_blocks(
        level: Level,
        faces: &TriangleAttributes<Self>,
        blocks: Blocks,
        to: &mut Canvas<'_>,
    ) -> bool;
    /// Lights the pixels of blocks of a tile that one triangle covers as a whole, where that can be done
    /// in one pass a block; says whether it can.
    fn light_blocks(
        level: Level,
        faces: &TriangleAttributes<Self>,
        blocks: Blocks,
        light: (BlockLight<'_, Self>, &mut Batch<Self>),
        to: &mut Canvas<'_>,
    ) -> bool;
}

impl<T: Interpolated> Barycentrics<T> {
    /// Finds where every pixel lies.
    pub(crate) fn find(
        &mut self,
        level: Level,
        items: &Fragments,
        faces: &TriangleAttributes<T>,
        (plan, draw): (&FramePlan, &Draw),
    ) {
        if items.shared || !T::find(level, items, faces, self) {
            T::find_linear(level, items, faces, self);
            self.find_wide(items, faces);
            if items.shared {
                self.hold(level, items, faces);
            }
            let count = faces.count;
            paged!(count, PAGES => T::run(level, Perspective::<T, PAGES> { items, faces, to: self }));
            if faces.cut != 0 {
                self.find_cut(items, faces, plan, draw);
            }
        }
    }

    /// Triangles that were cut are looked at one pixel at a time, in homogeneous coordinates.
    #[cold]
    fn find_cut(
        &mut self,
        items: &Fragments,
        faces: &TriangleAttributes<T>,
        plan: &FramePlan,
        draw: &Draw,
    ) {
        for i in 0..items.len {
            let slot = items.slots[i].cast_unsigned() as usize;
            if faces.cut >> slot & 1 == 1 {
                let number = faces.numbers[slot];
                let pixel = [items.x[i], items.y[i]];
                let weights = cut_weights(plan, draw, number, (pixel, [0; 2]));
                self.weights[0][i] = T::from_f64(weights.y);
                self.weights[1][i] = T::from_f64(weights.z);
                self.w[i] = T::from_f64(cut_w(plan, draw, number, weights));
                if items.shared {
                    let place = cut_place(plan, draw, number, weights);
                    for (row, place) in self.places.iter_mut().zip(place) {
                        row[i] = T::from_f64(place);
                    }
                }
            }
        }
    }

    /// Finds the linear coordinates in wide triangles, with whole numbers of 64 bits.
    fn find_wide(&mut self, items: &Fragments, faces: &TriangleAttributes<T>) {
        let (mut last, mut triangle) = (usize::MAX, None);
        for i in 0..items.len {
            let slot = items.slots[i].cast_unsigned() as usize;
            if faces.wide >> slot & 1 == 0 {
                continue;
            }
            if slot != last {
                (last, triangle) = (slot, Triangle::new(faces.corners(slot)));
            }
            if let Some(triangle) = &triangle {
                let [second, third] = barycentric(triangle, [items.x[i], items.y[i]]);
                self.linear[0][i] = T::from_f64(second);
                self.linear[1][i] = T::from_f64(third);
            }
        }
    }
}

impl Interpolated for f64 {
    fn find(
        _: Level,
        _: &Fragments,
        _: &TriangleAttributes<Self>,
        _: &mut Barycentrics<Self>,
    ) -> bool {
        false
    }

    fn find_linear(
        _: Level,
        _: &Fragments,
        _: &TriangleAttributes<Self>,
        _: &mut Barycentrics<Self>,
    ) {
    }

    fn mix_blocks(_: Level, _: &TriangleAttributes<Self>, _: Blocks, _: &mut Canvas<'_>) -> bool {
        false
    }

    fn light_blocks(
        _: Level,
        _: &TriangleAttributes<Self>,
        _: Blocks,
        _: (BlockLight<'_, Self>, &mut Batch<Self>),
        _: &mut Canvas<'_>,
    ) -> bool {
        false
    }
}

impl Interpolated for f32 {
    fn find(
        level: Level,
        items: &Fragments,
        faces: &TriangleAttributes<Self>,
        to: &mut Barycentrics<Self>,
    ) -> bool {
        let wide = faces.count == 1 && faces.wide == 1;
        if wide && let Some(triangle) = Triangle::new(faces.corners(0)) {
            dispatch!(level, simd => find_in_one(simd, items, &triangle, faces, to));
            return true;
        }
        if (faces.wide | faces.cut) != 0 {
            return false;
        }
        paged!(faces.count, PAGES => {
            dispatch!(level, simd => find_narrow::<_, PAGES>(simd, items, faces, to));
        });
        true
    }

    fn find_linear(
        level: Level,
        items: &Fragments,
        faces: &TriangleAttributes<Self>,
        to: &mut Barycentrics<Self>,
    ) {
        paged!(faces.count, PAGES => {
            dispatch!(level, simd => find_narrow::<_, PAGES>(simd, items, faces, to));
        });
    }

    fn mix_blocks(
        level: Level,
        faces: &TriangleAttributes<Self>,
        blocks: Blocks,
        to: &mut Canvas<'_>,
    ) -> bool {
        full_blocks::mix(level, faces, blocks, to)
    }

    fn light_blocks(
        level: Level,
        faces: &TriangleAttributes<Self>,
        blocks: Blocks,
        light: (BlockLight<'_, Self>, &mut Batch<Self>),
        to: &mut Canvas<'_>,
    ) -> bool {
        full_blocks::light(level, faces, blocks, light, to)
    }
}

/// Where pixels lie in narrow triangles.
#[inline(always)]
fn find_narrow<S: Simd, const PAGES: usize>(
    simd: S,
    items: &Fragments,
    faces: &TriangleAttributes<f32>,
    to: &mut Barycentrics<f32>,
) {
    let lanes = Sixteen(simd);
    for at in (0..items.len).step_by(16) {
        let slots = lanes.slots(&items.slots, at);
        let x = i32x16::from_slice(simd, &items.x[at..at + 16]);
        let y = i32x16::from_slice(simd, &items.y[at..at + 16]);
        let per_area = lanes.pick::<PAGES>(&faces.per_area, slots);
        let second = edge::<S, PAGES>(simd, &faces.edges[0], slots, [x, y]) * per_area;
        let third = edge::<S, PAGES>(simd, &faces.edges[1], slots, [x, y]) * per_area;
        lanes.store(second, &mut to.linear[0], at);
        lanes.store(third, &mut to.linear[1], at);
        let by_w = picked::<_, PAGES>(lanes, &faces.by_w, slots);
        to.put(lanes, at, [second, third], by_w);
    }
}

/// The edge functions of narrow triangles are exact in 32 bits, even where products of theirs are
/// not: what overflows is taken away again.
#[inline(always)]
fn edge<S: Simd, const PAGES: usize>(
    simd: S,
    [a, b, c]: &[[i32; SLOTS]; 3],
    slots: i32x16<S>,
    [x, y]: [i32x16<S>; 2],
) -> f32x16<S> {
    let a = pick::<S, PAGES>(simd, a, slots);
    let b = pick::<S, PAGES>(simd, b, slots);
    let c = pick::<S, PAGES>(simd, c, slots);
    (a * x + b * y + c).to_float()
}

/// Where pixels lie in one triangle whose edge functions need more bits.
#[inline(always)]
fn find_in_one<S: Simd>(
    simd: S,
    items: &Fragments,
    triangle: &Triangle,
    faces: &TriangleAttributes<f32>,
    to: &mut Barycentrics<f32>,
) {
    let lanes = Sixteen(simd);
    let wide = Wide::new(simd, triangle);
    let [w0, w1, w2] = faces.by_w;
    let by_w = set(lanes, [w0[0], w1[0], w2[0]]);
    if items.is_whole() {
        for (pair, linear) in wide.block(simd, [items.x[0], items.y[0]]).into_iter().enumerate() {
            to.put(lanes, 16 * pair, linear, by_w);
        }
        return;
    }
    for at in (0..items.len).step_by(16) {
        let linear = wide.scattered(simd, &items.x[at..at + 16], &items.y[at..at + 16]);
        to.put(lanes, at, linear, by_w);
    }
}

/// Numbers that fragments are shaded in.
pub(crate) trait ShadingNumber: Light + Interpolated {}

impl<T: Light + Interpolated> ShadingNumber for T {}
