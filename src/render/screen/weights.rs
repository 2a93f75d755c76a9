//! Perspective-correct weights of single pixels in one triangle, in f64: for the alpha test, and
//! for clipped triangles.

use glam::DVec3;

use super::clip::{Screen, ScreenVertex, homogeneous_weights};
use super::coverage::{SUBPIXELS, Snapped, Triangle};
use super::interpolation::parts_at;
use crate::base::math::each;
use crate::render::frame::FramePlan;
use crate::render::frame::draw::Draw;

/// The perspective-correct weights of a triangle's corners at pixels, in f64, `shift` subpixels
/// from their centres.
#[derive(Debug)]
pub(crate) struct Weights<'a> {
    plan: &'a FramePlan,
    draw: &'a Draw,
    number: u32,
    shift: [i32; 2],
    method: Method,
}

/// The method that computes the weights.
#[derive(Debug)]
enum Method {
    /// The triangle is clipped.
    Cut,
    /// By a variant, from its corners and 1/w of each.
    Variant([Snapped; 3], [f64; 3]),
    /// From edge functions, if it has an area, and w of each corner.
    Edges(Option<Triangle>, DVec3),
}

impl<'a> Weights<'a> {
    pub(crate) fn new(
        plan: &'a FramePlan,
        draw: &'a Draw,
        vertices: &[ScreenVertex],
        number: u32,
        shift: [i32; 2],
    ) -> Self {
        let order = draw.model.mesh.draw_order();
        let ids = order.vertices_of(number);
        let own = each(ids, |vertex| vertices[vertex as usize]);
        let screen = Screen::new(draw.clip_from_object, plan.size);
        let w = ids.map(|vertex| screen.clip(order.position(vertex))[3]);
        let method = if !own.iter().all(ScreenVertex::is_inside) {
            Method::Cut
        } else if plan.variants.locates_one_by_one() {
            Method::Variant(own.map(|vertex| vertex.at()), w.map(|w| 1.0 / w))
        } else {
            let triangle = Triangle::new(own.map(|vertex| vertex.at().seen_from(shift)));
            Method::Edges(triangle, DVec3::from_array(w))
        };
        Self { plan, draw, number, shift, method }
    }

    /// The weights at a pixel.
    #[inline(always)]
    pub(crate) fn at(&self, pixel: [i32; 2]) -> DVec3 {
        match &self.method {
            Method::Cut => cut_weights(self.plan, self.draw, self.number, (pixel, self.shift)),
            Method::Variant(corners, by_w) => {
                let at = (pixel, self.shift);
                let ([second, third], _) = parts_at(self.plan.variants, *corners, *by_w, at, false);
                DVec3::new(1.0 - second - third, second, third)
            }
            Method::Edges(triangle, w) => {
                let parts = triangle.as_ref().map(|triangle| barycentric(triangle, pixel));
                let [second, third] = parts.unwrap_or_default();
                let by_w = DVec3::new(1.0 - second - third, second, third) / *w;
                by_w / by_w.element_sum()
            }
        }
    }
}

/// The second and third barycentric coordinate of a pixel, linear on the screen.
#[inline(always)]
#[expect(clippy::cast_precision_loss, reason = "the nearest number is meant")]
pub(crate) fn barycentric(triangle: &Triangle, [x, y]: [i32; 2]) -> [f64; 2] {
    let [_, second, third] = triangle.edges_at(x, y);
    let per_area = 1.0 / triangle.doubled_area() as f64;
    [second as f64 * per_area, third as f64 * per_area]
}

/// The weights of a clipped triangle's corners at a pixel, as for [`Weights`].
#[expect(clippy::cast_precision_loss, reason = "pictures have fewer than 2^53 pixels a side")]
pub(crate) fn cut_weights(
    plan: &FramePlan,
    draw: &Draw,
    number: u32,
    (pixel, shift): ([i32; 2], [i32; 2]),
) -> DVec3 {
    let screen = Screen::new(draw.clip_from_object, plan.size);
    let order = draw.model.mesh.draw_order();
    let vertices = order.vertices_of(number);
    let clip = vertices.map(|vertex| screen.clip(order.position(vertex)));
    let shift = [0, 1].map(|axis| shift[axis] + plan.shift[axis]);
    let at =
        |axis: usize| f64::from(pixel[axis]) + 0.5 + f64::from(shift[axis]) / f64::from(SUBPIXELS);
    let x = at(0) / plan.size.width as f64 * 2.0 - 1.0;
    let y = 1.0 - at(1) / plan.size.height as f64 * 2.0;
    homogeneous_weights(clip, [x, y])
}

/// The w of a clipped triangle at a pixel with these weights.
pub(crate) fn cut_w(plan: &FramePlan, draw: &Draw, number: u32, weights: DVec3) -> f64 {
    let screen = Screen::new(draw.clip_from_object, plan.size);
    let order = draw.model.mesh.draw_order();
    let w = order.vertices_of(number).map(|vertex| screen.clip(order.position(vertex))[3]);
    weights.dot(DVec3::from_array(w))
}

/// The screen position, in pixels, of a clipped triangle's point with these weights. Points in the
/// observer's own plane have none: then the position is arbitrary.
#[expect(clippy::cast_precision_loss, reason = "pictures have fewer than 2^53 pixels a side")]
pub(crate) fn cut_place(plan: &FramePlan, draw: &Draw, number: u32, weights: DVec3) -> [f64; 2] {
    let screen = Screen::new(draw.clip_from_object, plan.size);
    let order = draw.model.mesh.draw_order();
    let corners = order.vertices_of(number).map(|vertex| screen.clip(order.position(vertex)));
    let [x, y, w] = [0, 1, 3].map(|i| weights.dot(DVec3::from_array(corners.map(|c| c[i]))));
    let w = if w == 0.0 { 1.0 } else { w };
    let half = [plan.size.width as f64 / 2.0, plan.size.height as f64 / 2.0];
    [(x / w + 1.0) * half[0], (1.0 - y / w) * half[1]]
}
