//! Weights of a triangle's corners at any pixel, by the interpolation of the frame: for clipped
//! triangles, and wherever f32 is not accurate enough.
//!
//! Perspective-correct weights follow from clip space. Affine interpolation is defined on the
//! screen, on which a clipped triangle is a polygon. It is interpolated as it is rasterised, and as
//! ancestor B drew it: as a fan of pieces around its first corner. The corners of the polygon have
//! exact weights of the triangle's own corners; inside a piece, these weights are interpolated.

use fearless_simd::{Simd, SimdBase as _, f64x8};
use glam::DVec3;

use super::clip::{Clip, Screen};
use super::coverage::{Snapped, Triangle};
use super::homogeneous::{HomogeneousWeights, barycentric, with_first};
use crate::accel::Accelerated as _;
use crate::frame::FramePlan;
use crate::frame::draw::Draw;
use marraztu_core::accuracy::Interpolation;

/// The weights of a triangle's corners at any pixel.
#[derive(Clone, Debug)]
pub(crate) struct ClippedWeights {
    exact: HomogeneousWeights,
    /// The pieces of the polygon on the screen; none with perspective.
    pieces: Vec<Piece>,
}

/// A triangle of the fan that a clipped triangle is drawn as.
#[derive(Clone, Debug)]
struct Piece {
    triangle: Triangle,
    /// The weights of the clipped triangle's corners at each corner of the piece.
    weights: [DVec3; 3],
}

impl ClippedWeights {
    /// Sets up a triangle by the interpolation of the frame, `shift` subpixels from pixel centres.
    pub(crate) fn new(plan: &FramePlan, draw: &Draw, number: u32, shift: [i32; 2]) -> Self {
        Self::by(plan.variants.interpolation, plan, draw, number, shift)
    }

    /// Sets up a triangle, `shift` subpixels from pixel centres.
    pub(crate) fn by(
        interpolation: Interpolation,
        plan: &FramePlan,
        draw: &Draw,
        number: u32,
        shift: [i32; 2],
    ) -> Self {
        let exact = HomogeneousWeights::new(plan, draw, number, shift);
        let pieces = match interpolation {
            Interpolation::Perspective => Vec::new(),
            Interpolation::Affine => pieces(plan, draw, number, shift),
        };
        Self { exact, pieces }
    }

    /// The perspective-correct weights.
    pub(crate) const fn exact(&self) -> &HomogeneousWeights {
        &self.exact
    }

    /// Computes the weights of the second and third corner at a pixel, and w. Even without
    /// perspective w is exact, because light is computed at the true position.
    #[inline(always)]
    pub(crate) fn at(&self, pixel: [i32; 2]) -> ([f64; 2], f64) {
        let (weights, w) = self.exact.at(pixel);
        (self.on_screen(pixel).unwrap_or(weights), w)
    }

    /// Computes the perspective-correct weights at a pixel if it is in the triangle, and no others
    /// are in use.
    #[inline(always)]
    pub(crate) fn inside(&self, pixel: [i32; 2]) -> Option<DVec3> {
        if self.pieces.is_empty() { self.exact.inside(pixel) } else { None }
    }

    /// Computes [`Self::at`] for eight pixels of a row, starting at `first`, with the same bits.
    #[inline(always)]
    pub(crate) fn of_row<S: Simd>(&self, simd: S, first: [i32; 2]) -> ([f64x8<S>; 2], f64x8<S>) {
        let (weights, w) = self.exact.of_row(simd, first);
        if self.pieces.is_empty() {
            return (weights, w);
        }
        let [second, third] = self.row_on_screen(first);
        ([f64x8::from_slice(simd, &second), f64x8::from_slice(simd, &third)], w)
    }

    /// Computes the weights at eight pixels of a row one by one.
    #[cold]
    fn row_on_screen(&self, [x, y]: [i32; 2]) -> [[f64; 8]; 2] {
        let all = [0, 1, 2, 3, 4, 5, 6, 7].map(|column| self.at([x + column, y]).0);
        [0, 1].map(|corner| all.map(|weights| weights[corner]))
    }

    /// Computes the weights of the second and third corner by the piece that covers a pixel, or by
    /// the piece next to it. `None` with perspective.
    fn on_screen(&self, pixel: [i32; 2]) -> Option<[f64; 2]> {
        let parts = self
            .pieces
            .iter()
            .map(|piece| (piece, with_first(barycentric(&piece.triangle, pixel))));
        // The smallest coordinate is negative outside of a piece, the more the farther away.
        let (piece, parts) =
            parts.max_by(|(_, a), (_, b)| a.min_element().total_cmp(&b.min_element()))?;
        let inside = parts.max(DVec3::ZERO);
        let parts = inside / inside.element_sum();
        let [a, b, c] = piece.weights;
        let weights = a * parts.x + b * parts.y + c * parts.z;
        Some([weights.y, weights.z])
    }
}

/// Returns the pieces of a triangle on the screen.
fn pieces(plan: &FramePlan, draw: &Draw, number: u32, shift: [i32; 2]) -> Vec<Piece> {
    let grid = plan.raster_mode().grid;
    let shift = [shift[0] + plan.shift[0], shift[1] + plan.shift[1]];
    let screen = Screen::new(draw.clip_from_object, plan.viewport).on(grid);
    let screen = screen.seen_from(grid.offset(shift));
    let order = draw.model.mesh.draw_order();
    let corners = order.vertices_of(number).map(|vertex| screen.clip(order.position(vertex)));
    let polygon = screen.cut(corners);
    let at: Vec<Snapped> = polygon.iter().map(|corner| screen.piece(*corner).at()).collect();
    let weights: Vec<DVec3> = polygon.iter().map(|corner| weights_of(&corners, corner)).collect();
    let fan = (2..polygon.len()).filter_map(|i| {
        let of = [0, i - 1, i];
        // Pieces without area cover no pixel.
        let triangle = Triangle::on(grid, of.map(|i| at[i]))?;
        Some(Piece { triangle, weights: of.map(|i| weights[i]) })
    });
    fan.collect()
}

/// Computes the weights of three corners at a point between them, all in clip space:
///
///   m0 = (q x r) . s / (p . (q x r)), m1 and m2 alike, for corners p, q, r and the point s,
///   each as (x, y, w)
fn weights_of(corners: &[Clip; 3], point: &Clip) -> DVec3 {
    let [p, q, r] = corners.map(|[x, y, _, w]| DVec3::new(x, y, w));
    let point = DVec3::new(point[0], point[1], point[3]);
    let parts = [q.cross(r), r.cross(p), p.cross(q)].map(|normal| normal.dot(point));
    let parts = DVec3::from_array(parts) / p.dot(q.cross(r));
    // Rounding must not leave the triangle.
    let parts = parts.max(DVec3::ZERO);
    parts / parts.element_sum()
}
