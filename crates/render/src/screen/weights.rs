//! Weights of single pixels in one triangle, in f64: for the alpha test and for clipped triangles.

use crate::accel::Accelerated as _;
use fearless_simd::{Select as _, Simd, SimdBase as _, f64x8};
use glam::DVec3;

use super::clip::{Screen, ScreenVertex};
use super::clipped_weights::ClippedWeights;
use super::coverage::{SUBPIXELS, Triangle};
use crate::frame::FramePlan;
use crate::frame::draw::Draw;
use marraztu_core::accuracy::Interpolation;
use marraztu_core::base::math::each;

/// The weights of a triangle's corners at pixels, in f64, `shift` subpixels from pixel centres.
#[derive(Debug)]
pub(crate) enum Weights {
    /// A clipped triangle.
    Cut(ClippedWeights),
    /// Edge functions, if the triangle has an area, and w of each corner (1 without perspective).
    Edges(Option<Triangle>, DVec3),
}

impl Weights {
    /// The weights by which attributes are interpolated in the frame.
    pub(crate) fn new(
        plan: &FramePlan,
        draw: &Draw,
        vertices: &[ScreenVertex],
        number: u32,
        shift: [i32; 2],
    ) -> Self {
        Self::by(plan.variants.interpolation, (plan, draw, vertices), number, shift)
    }

    /// The weights of positions on the surface, which have perspective whatever the interpolation,
    /// at pixel centres.
    pub(crate) fn of_positions(
        plan: &FramePlan,
        draw: &Draw,
        vertices: &[ScreenVertex],
        number: u32,
    ) -> Self {
        Self::by(Interpolation::Perspective, (plan, draw, vertices), number, [0; 2])
    }

    fn by(
        interpolation: Interpolation,
        (plan, draw, vertices): (&FramePlan, &Draw, &[ScreenVertex]),
        number: u32,
        shift: [i32; 2],
    ) -> Self {
        let order = draw.model.mesh.draw_order();
        let ids = order.vertices_of(number);
        let own = each(ids, |vertex| vertices[vertex as usize]);
        let screen = Screen::new(draw.clip_from_object, plan.viewport);
        let w = ids.map(|vertex| screen.clip(order.position(vertex))[3]);
        // Clipped triangles have corners without a screen position.
        if !own.iter().all(ScreenVertex::is_inside) {
            return Self::Cut(ClippedWeights::by(interpolation, plan, draw, number, shift));
        }
        let grid = plan.raster_mode().grid;
        // Moving all corners one way equals moving the sample the other way.
        let corners = own.map(|vertex| vertex.at().seen_from(grid.offset(shift)));
        let w = match interpolation {
            Interpolation::Affine => DVec3::ONE,
            Interpolation::Perspective => DVec3::from_array(w),
        };
        Self::Edges(Triangle::on(grid, corners), w)
    }

    /// Returns whether the weights follow from edge functions alone.
    pub(crate) const fn follow_from_edges(&self) -> bool {
        matches!(self, Self::Edges(Some(_), _))
    }

    /// Computes the weights at a pixel.
    #[inline(always)]
    pub(crate) fn at(&self, pixel: [i32; 2]) -> DVec3 {
        match self {
            Self::Cut(weights) => with_first(weights.at(pixel).0),
            Self::Edges(triangle, w) => {
                // Without an area, the first corner gets all the weight.
                let parts = triangle.as_ref().map(|triangle| barycentric(triangle, pixel));
                let by_w = with_first(parts.unwrap_or_default()) / *w;
                by_w / by_w.element_sum()
            }
        }
    }

    /// Computes the weights at a pixel that need not be in the triangle, for the point of the
    /// triangle's plane seen through it. `None` if that point is behind the observer or very far
    /// away.
    ///
    /// If all four corners of a rectangle have weights, the weights inside lie between them,
    /// because a projection maps lines to lines and keeps the order of points on them.
    #[inline(always)]
    pub(crate) fn projected(&self, pixel: [i32; 2]) -> Option<DVec3> {
        match self {
            Self::Cut(weights) => weights.inside(pixel),
            Self::Edges(triangle, w) => {
                let by_w = with_first(barycentric(triangle.as_ref()?, pixel)) / *w;
                // The sum is 1 / w of the point: negative behind the observer, close to 0 far away.
                let sum = by_w.element_sum();
                (sum >= FAR / w.max_element()).then(|| by_w / sum)
            }
        }
    }

    /// Computes the weights of the second and third corner at eight pixels of a row, starting at
    /// `first`, accurate to a few units in the last place. The array holds the edge functions of
    /// both corners there. `None` for a triangle without area.
    #[inline(always)]
    #[expect(clippy::cast_precision_loss, reason = "the nearest number is meant")]
    pub(crate) fn of_row<S: Simd>(
        &self,
        simd: S,
        first: [i32; 2],
        [second, third]: [f64x8<S>; 2],
    ) -> Option<[f64x8<S>; 2]> {
        match self {
            Self::Cut(weights) => Some(weights.of_row(simd, first).0),
            Self::Edges(triangle, w) => {
                let area = triangle.as_ref()?.doubled_area() as f64;
                let by_w = [1.0 / w.x, 1.0 / w.y, 1.0 / w.z];
                // The three edge functions add up to the doubled area.
                let rest = f64x8::splat(simd, area) - second - third;
                let (second, third) = (second * by_w[1], third * by_w[2]);
                let per = f64x8::splat(simd, 1.0) / (rest * by_w[0] + second + third);
                Some([second * per, third * per])
            }
        }
    }
}

/// The weights at many pixels of a triangle: [`Weights::at`] up to a few units in the last place,
/// with one division instead of seven.
#[derive(Debug)]
pub(crate) struct QuickWeights {
    weights: Weights,
    /// 1 / (doubled area * w) of each corner, for weights from edge functions.
    per_edge: DVec3,
}

impl QuickWeights {
    #[expect(clippy::cast_precision_loss, reason = "the nearest number is meant")]
    pub(crate) fn new(weights: Weights) -> Self {
        let per_edge = match &weights {
            Weights::Edges(Some(triangle), w) => 1.0 / (*w * triangle.doubled_area() as f64),
            _ => DVec3::ZERO,
        };
        Self { weights, per_edge }
    }

    /// Computes the weights of each corner at the eight pixels of a row that starts at a pixel.
    /// They are meaningless at pixels that the triangle does not cover.
    #[inline(always)]
    #[expect(clippy::cast_precision_loss, reason = "the nearest number is meant")]
    pub(crate) fn of_row(&self, [x, y]: [i32; 2]) -> [[f64; 8]; 3] {
        let Weights::Edges(Some(triangle), _) = &self.weights else {
            // The other kinds of weights are computed pixel by pixel.
            let all: [DVec3; 8] = std::array::from_fn(|i| {
                self.weights.at([x + i32::try_from(i).expect("below eight"), y])
            });
            return [0, 1, 2].map(|corner| all.map(|weights| weights[corner]));
        };
        // Edge functions grow by constant steps, exactly, in integers.
        let (first, [step, _]) = (triangle.edges_at(x, y), triangle.steps());
        let mut row = [[0.0; 8]; 3];
        for (corner, row) in row.iter_mut().enumerate() {
            let mut edge = first[corner];
            for by_w in row {
                *by_w = edge as f64 * self.per_edge[corner];
                edge += step[corner];
            }
        }
        // One division per pixel normalises all three weights.
        let [a, b, c] = &mut row;
        for ((a, b), c) in a.iter_mut().zip(b).zip(c) {
            let per = 1.0 / (*a + *b + *c);
            (*a, *b, *c) = (*a * per, *b * per, *c * per);
        }
        row
    }
}

/// The limit for very distant points: the farthest corner's distance over the point's.
const FAR: f64 = 1e-3;

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

/// Projects the point of a clipped triangle with these weights to pixels. Points in the observer's
/// own plane have no screen position; the result is then arbitrary.
pub(crate) fn cut_place(plan: &FramePlan, draw: &Draw, number: u32, weights: DVec3) -> [f64; 2] {
    let screen = Screen::new(draw.clip_from_object, plan.viewport);
    let order = draw.model.mesh.draw_order();
    let corners = order.vertices_of(number).map(|vertex| screen.clip(order.position(vertex)));
    let [x, y, w] = [0, 1, 3].map(|i| weights.dot(DVec3::from_array(corners.map(|c| c[i]))));
    let w = if w == 0.0 { 1.0 } else { w };
    let half = [plan.viewport.width / 2.0, plan.viewport.height / 2.0];
    [(x / w + 1.0) * half[0], (1.0 - y / w) * half[1]]
}
