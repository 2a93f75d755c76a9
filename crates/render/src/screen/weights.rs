//! Weights of single pixels in one triangle, in f64: for the alpha test and for clipped triangles.

use crate::accel::Accelerated as _;
use fearless_simd::{Simd, SimdBase as _, f64x8};
use glam::DVec3;

use super::clip::{Screen, ScreenVertex};
use super::clipped_weights::ClippedWeights;
use super::coverage::{SUBPIXELS, Triangle};
use super::homogeneous::{barycentric, with_first};
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
        Self::of_samples(plan, draw, vertices, (number, [0; 2]))
    }

    /// The same, `shift` subpixels from pixel centres.
    pub(crate) fn of_samples(
        plan: &FramePlan,
        draw: &Draw,
        vertices: &[ScreenVertex],
        (number, shift): (u32, [i32; 2]),
    ) -> Self {
        Self::by(Interpolation::Perspective, (plan, draw, vertices), number, shift)
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

/// Projects the point of a clipped triangle with these weights to pixels. Points in the observer's
/// own plane have no screen position; the result is then arbitrary.
pub(crate) fn cut_place(plan: &FramePlan, draw: &Draw, number: u32, weights: DVec3) -> [f64; 2] {
    let screen = Screen::new(draw.clip_from_object, plan.viewport);
    let order = draw.model.mesh.draw_order();
    let corners = order.vertices_of(number).map(|vertex| screen.clip(order.position(vertex)));
    let [x, y, w] = [0, 1, 3].map(|i| weights.dot(DVec3::from_array(corners.map(|c| c[i]))));
    let w = if w == 0.0 { 1.0 } else { w };
    let half = [plan.viewport.width / 2.0, plan.viewport.height / 2.0];
    let [right, down] = plan.shift.map(|shift| f64::from(shift) / f64::from(SUBPIXELS));
    [(x / w + 1.0) * half[0] - right, (1.0 - y / w) * half[1] - down]
}
