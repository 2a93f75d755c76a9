//! Weights of a triangle's corners from clip space, and from edge functions, one pixel at a time.

use crate::accel::Accelerated as _;
use fearless_simd::{Select as _, Simd, SimdBase as _, f64x8};
use glam::DVec3;

use super::clip::Screen;
use super::coverage::{SUBPIXELS, Triangle};
use crate::frame::FramePlan;
use crate::frame::draw::Draw;
use marraztu_core::base::math::each;

/// Returns all three weights, which add up to 1, from the second and third.
#[inline(always)]
pub(super) fn with_first([second, third]: [f64; 2]) -> DVec3 {
    DVec3::new(1.0 - second - third, second, third)
}

/// Computes the second and third barycentric coordinate of a pixel, linear on the screen.
#[inline(always)]
#[expect(clippy::cast_precision_loss, reason = "the nearest number is meant")]
pub(crate) fn barycentric(triangle: &Triangle, [x, y]: [i32; 2]) -> [f64; 2] {
    let [_, second, third] = triangle.edges_at(x, y);
    let per_area = 1.0 / triangle.doubled_area() as f64;
    [second as f64 * per_area, third as f64 * per_area]
}

/// Perspective-correct weights of a triangle's corners at any pixel, in f64, from the corners in
/// clip space: for clipped triangles, and wherever f32 is not accurate enough.
///
///   N0 = (q x r) . s / (p . (q x r)), N1 and N2 alike, for corners p, q, r and the position s,
///   each as (x, y, w)
///
/// The sum of the three is 1 / w of the position. Each divided by the sum is the weight of a
/// corner. Weights are clamped to the triangle, and their sum is 1.
///
/// Olano and Greer, "Triangle Scan Conversion Using 2D Homogeneous Coordinates", 1997.
#[derive(Clone, Copy, Debug)]
pub(crate) struct HomogeneousWeights {
    /// For each corner a, b and c: N = a x + (b y + c) at the pixel (x, y).
    planes: [[f64; 3]; 3],
    /// w of each corner.
    w: [f64; 3],
}

impl HomogeneousWeights {
    /// Sets up a triangle, `shift` subpixels from pixel centres.
    pub(crate) fn new(plan: &FramePlan, draw: &Draw, number: u32, shift: [i32; 2]) -> Self {
        let screen = Screen::new(draw.clip_from_object, plan.viewport);
        let order = draw.model.mesh.draw_order();
        let vertices = order.vertices_of(number);
        let [p, q, r] = each(vertices, |vertex| {
            let [x, y, _, w] = screen.clip(order.position(vertex));
            DVec3::new(x, y, w)
        });
        // The triple product normalises the weights; a triangle without volume keeps scale 1.
        let normals = [q.cross(r), r.cross(p), p.cross(q)];
        let volume = p.dot(normals[0]);
        let scale = if volume == 0.0 { 1.0 } else { 1.0 / volume };
        let (right, down) = (2.0 / plan.viewport.width, -2.0 / plan.viewport.height);
        let centre =
            |axis: usize| 0.5 + f64::from(shift[axis] + plan.shift[axis]) / f64::from(SUBPIXELS);
        // The position of the first pixel, from -1 to 1.
        let (x, y) = (centre(0) * right - 1.0, centre(1) * down + 1.0);
        // Folds the step per pixel and the first position in: N is then linear in column and row.
        let planes = each(normals, |n| {
            let n = n * scale;
            [n.x * right, n.y * down, n.x * x + n.y * y + n.z]
        });
        Self { planes, w: [p.z, q.z, r.z] }
    }

    /// Returns the steps of N0, N1 and N2 for one pixel to the right and one pixel down.
    pub(crate) fn steps(&self) -> [[f64; 3]; 2] {
        let [p, q, r] = self.planes;
        [[p[0], q[0], r[0]], [p[1], q[1], r[1]]]
    }

    /// Computes the weights of the second and third corner at a pixel, and w.
    #[inline(always)]
    pub(crate) fn at(&self, [x, y]: [i32; 2]) -> ([f64; 2], f64) {
        let (x, y) = (f64::from(x), f64::from(y));
        let [m0, m1, m2] = each(self.planes, |[a, b, c]| {
            let n = a * x + (b * y + c);
            // Beyond an edge, the opposite corner gets no weight.
            if n > 0.0 { n } else { 0.0 }
        });
        // Without any positive weight the pixel is outside all edges: the centroid is used.
        let sum = m0 + m1 + m2;
        let ([m0, m1, m2], sum) = if sum > 0.0 { ([m0, m1, m2], sum) } else { ([1.0; 3], 3.0) };
        let per = 1.0 / sum;
        let [w0, w1, w2] = self.w;
        ([m1 * per, m2 * per], (w0 * m0 + w1 * m1 + w2 * m2) * per)
    }

    /// Computes the weights at a pixel if it is in the triangle.
    #[inline(always)]
    pub(super) fn inside(&self, [x, y]: [i32; 2]) -> Option<DVec3> {
        let (x, y) = (f64::from(x), f64::from(y));
        let parts = DVec3::from_array(each(self.planes, |[a, b, c]| a * x + (b * y + c)));
        (parts.min_element() > 0.0).then(|| parts / parts.element_sum())
    }

    /// Computes [`Self::at`] for eight pixels of a row, starting at `[x, y]`, with the same bits.
    #[inline(always)]
    pub(crate) fn of_row<S: Simd>(&self, simd: S, [x, y]: [i32; 2]) -> ([f64x8<S>; 2], f64x8<S>) {
        let x = f64x8::from_slice(simd, &COLUMNS) + f64::from(x);
        let y = f64::from(y);
        let (zero, one) = (f64x8::splat(simd, 0.0), f64x8::splat(simd, 1.0));
        let [m0, m1, m2] = each(
            self.planes,
            #[inline(always)]
            |[a, b, c]| {
                let n = x * a + (b * y + c);
                n.simd_gt(0.0).select(n, zero)
            },
        );
        let sum = m0 + m1 + m2;
        let inside = sum.simd_gt(0.0);
        // As in `at`, pixels outside all edges get the centroid.
        let (m0, m1, m2) = (inside.select(m0, one), inside.select(m1, one), inside.select(m2, one));
        let per = one / inside.select(sum, one + one + one);
        let [w0, w1, w2] = self.w;
        ([m1 * per, m2 * per], (m0 * w0 + m1 * w1 + m2 * w2) * per)
    }
}

/// The column numbers of eight pixels.
const COLUMNS: [f64; 8] = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0];
