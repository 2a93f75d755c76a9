//! A separate triangle for each pixel of a list: sixteen at a time, from vertices to colours.

use crate::accel::DrawOrder;
use fearless_simd::{
    Bytes as _, Select as _, Simd, SimdBase as _, SimdInt as _, SimdMask as _, f32x16, i32x16,
    mask32x16,
};
use prefetch_index::prefetch_index;

use super::barycentrics::Barycentrics;
use super::colors::Colors;
use super::fragments::Fragments;
use super::interpolate::Look;
use super::triangle_attributes::{Edges, corners};
use crate::frame::draw::Draw;
use crate::frame::raster_mode::Grid;
use crate::lights::Batch;
use crate::raster::vertices::fetch;
use crate::screen::clip::ScreenVertex;
use crate::screen::perspective::between;
use crate::simd::{BATCH, Lanes as _, Sixteen, Vec3};
use marraztu_core::accuracy::Interpolation;

/// The triangles of a list of pixels, one for each pixel.
#[derive(Debug)]
#[repr(align(64))]
pub(crate) struct TinyTriangles {
    /// The vertices in the mesh's draw order.
    ids: [[u32; 3]; BATCH],
    /// The indices of the corners in the list of normals, or of light.
    pub(super) places: [[u32; 3]; BATCH],
    /// The masks of back faces, sixteen triangles at a time.
    pub(super) back: [u64; BATCH / 16],
}

impl Default for TinyTriangles {
    fn default() -> Self {
        Self { ids: [[0; 3]; BATCH], places: [[0; 3]; BATCH], back: [0; BATCH / 16] }
    }
}

impl TinyTriangles {
    /// Sets the triangles of a list, all of one draw with numbers from `base`, and prefetches their
    /// vertices and corner data. `corners` returns the indices of a triangle's corners, given its
    /// number in the mesh and its vertices; `prefetch` prefetches the data at an index.
    #[inline(always)]
    pub(super) fn take(
        &mut self,
        (order, vertices): (&DrawOrder, &[ScreenVertex]),
        (numbers, base): (&[u32], u32),
        corners: impl Fn(u32, [u32; 3]) -> [u32; 3],
        prefetch: impl Fn(u32),
    ) {
        // All vertices are requested before any corner is looked up, so the fetches overlap.
        for (ids, number) in self.ids.iter_mut().zip(numbers) {
            *ids = order.vertices_of(number - base);
            ids.iter().for_each(|id| prefetch_index(vertices, *id as usize));
        }
        let own = self.places.iter_mut().zip(&self.ids).zip(numbers);
        for ((places, ids), number) in own {
            *places = corners(number - base, *ids);
            places.iter().for_each(|place| prefetch(*place));
        }
    }
}

/// The colours of the corners of some triangles, corner by corner: red, green, blue, and an unused
/// number.
pub(crate) type CornerRows<T> = [[[T; 4]; BATCH]; 3];

/// Computes the barycentric coordinates of a list with these screen vertices, and the masks of back
/// faces. Returns false if a triangle is clipped or wide: the results are then meaningless.
#[inline(always)]
pub(super) fn weigh<S: Simd>(
    simd: S,
    (grid, interpolation): (Grid, Interpolation),
    (draw, vertices): (&Draw, &[ScreenVertex]),
    (fragments, triangles): (&Fragments, &mut TinyTriangles),
    to: &mut Barycentrics<f32>,
) -> bool {
    let mut odd = 0;
    for at in (0..fragments.len).step_by(16) {
        let [[x0, y0, _, w0], [x1, y1, _, w1], [x2, y2, _, w2]] =
            corners(simd, &triangles.ids[at..], vertices);
        let edges = Edges::new(grid, [[x0, y0], [x1, y1], [x2, y2]]);
        // Unused lanes hold old triangles, which must not reject the list.
        let own = u64::MAX >> (64 - (fragments.len - at).min(16));
        odd |= (edges.cut | edges.wide).to_bitmask() & own;
        let front = edges.area.simd_lt(0).to_bitmask();
        triangles.back[at / 16] = if draw.mirrored { front } else { !front };
        // Each lane evaluates one triangle at one pixel.
        let x = i32x16::from_slice(simd, &fragments.x[at..at + 16]);
        let y = i32x16::from_slice(simd, &fragments.y[at..at + 16]);
        let per_area = edges.per_area();
        let [[a1, b1, c1], [a2, b2, c2]] = edges.functions;
        let second = (a1 * x + b1 * y + c1).to_float::<f32x16<S>>() * per_area;
        let third = (a2 * x + b2 * y + c2).to_float::<f32x16<S>>() * per_area;
        let by_w = Vec3([w0.bitcast(), w1.bitcast(), w2.bitcast()]);
        to.put(interpolation, Sixteen(simd), at, [second, third], by_w);
    }
    odd == 0
}

/// Computes position, normal and direction to the observer of every pixel, from the normals at
/// corners, which are reversed on lit back faces.
#[inline(always)]
pub(super) fn sample<S: Simd>(
    simd: S,
    look: &Look<f32>,
    (fragments, triangles): (&Fragments, &TinyTriangles),
    (normals, turns): (&[[f32; 3]], bool),
    weights: &Barycentrics<f32>,
    to: &mut Batch<f32>,
) {
    let lanes = Sixteen(simd);
    for at in (0..fragments.len).step_by(16) {
        let places = &triangles.places[at..at + 16];
        let [mut a, mut b, mut c] = [
            normals_at(simd, normals, places, 0),
            normals_at(simd, normals, places, 1),
            normals_at(simd, normals, places, 2),
        ];
        // Back faces are lit with reversed normals.
        if turns {
            let back = mask32x16::from_bitmask(simd, triangles.back[at / 16] & 0xffff);
            (a, b, c) = (turned(a, back), turned(b, back), turned(c, back));
        }
        let normal = between([a, b.minus(a), c.minus(a)], weights.weights_at(lanes, at));
        let half = f32x16::splat(simd, 0.5);
        let place = [lanes.whole(&fragments.x, at) + half, lanes.whole(&fragments.y, at) + half];
        // Depths only matter in orthographic projection, which has no tiny triangles.
        let depth = || f32x16::splat(simd, 0.0);
        let sample = look.at(lanes, normal, place, lanes.load(&weights.w, at), depth);
        to.put(lanes, sample, at);
    }
}

/// Fetches the normals at one corner of sixteen triangles.
#[inline(always)]
fn normals_at<S: Simd>(
    simd: S,
    normals: &[[f32; 3]],
    places: &[[u32; 3]],
    corner: usize,
) -> Vec3<f32x16<S>> {
    // Unused lanes may have indices of other draws.
    let last = normals.len().saturating_sub(1);
    let [x, y, z, _] = fetch(
        simd,
        #[inline(always)]
        |lane| {
            let [x, y, z] = normals[(places[lane][corner] as usize).min(last)];
            let [x, y, z] = [x, y, z].map(|x| x.to_bits().cast_signed());
            // The fourth number is not read.
            [x, y, z, z]
        },
    );
    Vec3([x.bitcast(), y.bitcast(), z.bitcast()])
}

/// Reverses the normals in some lanes.
#[inline(always)]
fn turned<S: Simd>(Vec3([x, y, z]): Vec3<f32x16<S>>, some: mask32x16<S>) -> Vec3<f32x16<S>> {
    Vec3([some.select(-x, x), some.select(-y, y), some.select(-z, z)])
}

/// Interpolates the colours at the corners of a number of pixels.
#[inline(always)]
pub(super) fn mix<S: Simd>(
    simd: S,
    (rows, len): (&CornerRows<f32>, usize),
    weights: &Barycentrics<f32>,
    (colors, thresholds): (&mut Colors, &[f32; BATCH]),
) {
    let lanes = Sixteen(simd);
    for at in (0..len).step_by(16) {
        let [r, g, b, _] = lanes.load_four(&rows[0], at);
        let first = Vec3([r, g, b]);
        let [r, g, b, _] = lanes.load_four(&rows[1], at);
        let second = Vec3([r, g, b]).minus(first);
        let [r, g, b, _] = lanes.load_four(&rows[2], at);
        let third = Vec3([r, g, b]).minus(first);
        // The same operations as with slots, so the bits are equal.
        let color = between([first, second, third], weights.weights_at(lanes, at));
        colors.store_by(lanes, color, lanes.load(thresholds, at), at);
    }
}
