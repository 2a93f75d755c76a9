//! Clamps the position at which a pixel is lit to the triangle that it shows.
//!
//! A pixel with several samples may show a triangle that does not cover its centre. Attributes
//! would be extrapolated there: to a colour below black or a position beyond the triangle. Such a
//! pixel is therefore lit at the triangle's point nearest to the centre.
//!
//! That point lies on an edge with a negative edge function at the centre. Of two such edges it is
//! the one, if any, with a nearest point that is not the corner between them.

use fearless_simd::Level;

use super::barycentrics::Barycentrics;
use super::fragments::Fragments;
use super::triangle_attributes::{AttributeNumber, TriangleAttributes};
use crate::screen::tiles::BLOCK;
use crate::simd::gather::SLOTS;
use crate::simd::{Kernel, Lanes, Number, Real};

impl<T: AttributeNumber> Barycentrics<T> {
    /// Clamps linear coordinates outside of a triangle to its nearest point, and sets the positions
    /// of all fragments.
    pub(crate) fn clamp_to_triangle(
        &mut self,
        level: Level,
        fragments: &Fragments,
        attributes: &TriangleAttributes<T>,
    ) {
        // One origin for all pixels of a block: a pixel must not depend on its neighbours.
        let origin = [fragments.x[0] & !(BLOCK - 1), fragments.y[0] & !(BLOCK - 1)];
        T::run(level, Hold { fragments, attributes, origin, to: self });
    }
}

struct Hold<'a, T> {
    fragments: &'a Fragments,
    attributes: &'a TriangleAttributes<T>,
    origin: [i32; 2],
    to: &'a mut Barycentrics<T>,
}

impl<T: Number> Kernel<T> for Hold<'_, T> {
    #[inline(always)]
    fn run<M: Lanes<Number = T>>(self, lanes: M) {
        let Self { fragments, attributes, origin, to } = self;
        let parts = attributes.grid.parts();
        // Relative to the block, coordinates keep their digits in f32.
        let corners = corners(lanes, attributes, origin.map(|pixel| pixel * parts));
        let [left, top] = origin.map(|pixel| lanes.lift(f64::from(pixel)));
        let (zero, half) = (lanes.lift(0.0), lanes.lift(0.5));
        for at in (0..fragments.len).step_by(M::LANES) {
            let (x, y) =
                (lanes.whole(&fragments.x, at) + half, lanes.whole(&fragments.y, at) + half);
            let [second, third] = [lanes.load(&to.linear[0], at), lanes.load(&to.linear[1], at)];
            let first = lanes.lift(1.0) - second - third;
            let outside = Real::max(Real::max(-first, -second), -third);
            // A triangle shown by all samples covers the centre, despite rounding.
            let shares = lanes.whole(&fragments.shares, at);
            let outside = lanes.lift(f64::from(fragments.samples)).if_more(shares, outside, zero);
            let mut place = [x, y];
            // Most groups have no pixel outside and skip the search.
            if lanes.any_more(outside, zero) {
                let slots = lanes.slots((&fragments.slots, attributes.count), at);
                let [x0, y0, ux, uy, vx, vy] = picked(lanes, &corners, slots);
                let per_pixel = lanes.lift(f64::from(parts));
                let d = [(x - left) * per_pixel - x0, (y - top) * per_pixel - y0];
                let [s, t] = nearest(d, [ux, uy], [vx, vy], [first, second, third]);
                place = [
                    outside.if_more(zero, left + (x0 + ux * s + vx * t) / per_pixel, x),
                    outside.if_more(zero, top + (y0 + uy * s + vy * t) / per_pixel, y),
                ];
                lanes.store(outside.if_more(zero, s, second), &mut to.linear[0], at);
                lanes.store(outside.if_more(zero, t, third), &mut to.linear[1], at);
            }
            lanes.store(place[0], &mut to.positions[0], at);
            lanes.store(place[1], &mut to.positions[1], at);
        }
    }
}

/// Computes the corners of triangles in subpixels: the first relative to a point of the picture,
/// and the vectors from it to the second and third; x and y of each.
#[inline(always)]
fn corners<T: Number, M: Lanes<Number = T>>(
    lanes: M,
    attributes: &TriangleAttributes<T>,
    origin: [i32; 2],
) -> [[T; SLOTS]; 6] {
    let [first, second, third] = &attributes.corners;
    let mut ways = [[0; SLOTS]; 6];
    for axis in 0..2 {
        let from = origin[axis];
        for slot in 0..SLOTS {
            // Corners of clipped triangles have no screen position; they are never read.
            ways[axis][slot] = first[axis][slot].wrapping_sub(from);
            ways[2 + axis][slot] = second[axis][slot].wrapping_sub(first[axis][slot]);
            ways[4 + axis][slot] = third[axis][slot].wrapping_sub(first[axis][slot]);
        }
    }
    let mut corners = [[T::default(); SLOTS]; 6];
    for (row, ways) in corners.iter_mut().zip(&ways) {
        for at in (0..attributes.count).step_by(M::LANES) {
            lanes.store(lanes.whole(ways, at), row, at);
        }
    }
    corners
}

/// Gathers the corners of the triangles in some slots.
#[inline(always)]
fn picked<M: Lanes>(
    lanes: M,
    [a, b, c, d, e, f]: &[[M::Number; SLOTS]; 6],
    slots: M::Slots,
) -> [M::R; 6] {
    [
        lanes.pick(a, slots),
        lanes.pick(b, slots),
        lanes.pick(c, slots),
        lanes.pick(d, slots),
        lanes.pick(e, slots),
        lanes.pick(f, slots),
    ]
}

/// Computes the second and third barycentric coordinate of the triangle's point that is nearest to
/// a point outside. The triangle has the sides u and v from its first corner; the outside point is
/// at d from that corner, with the coordinates given last.
///
/// On the side from a corner p along g: p + t g, t = (d - p).g / g.g, clamped to 0..1.
#[inline(always)]
fn nearest<R: Real>(d: [R; 2], u: [R; 2], v: [R; 2], [first, second, third]: [R; 3]) -> [R; 2] {
    let (zero, one) = (first.lift(0.0), first.lift(1.0));
    // The third side runs from the second corner to the third.
    let g = [v[0] - u[0], v[1] - u[1]];
    let from_second = [d[0] - u[0], d[1] - u[1]];
    let on_u = along(d, u);
    let on_v = along(d, v);
    let on_g = along(from_second, g);
    let (beyond_u, beyond_v) = (-third, -second);
    // A side is taken if the point lies beyond it. If the point also lies beyond an earlier side,
    // this side is taken only if its nearest point is not the corner between the two.
    let take_v = beyond_u.if_more(zero, on_v, one);
    let take_v = beyond_v.if_more(zero, take_v, zero);
    let end = clamped(on_v, [zero, one]);
    let (s, t) =
        (take_v.if_more(zero, zero, clamped(on_u, [zero, one])), take_v.if_more(zero, end, zero));
    // The third side meets u at its start and v at its end.
    let take_g = beyond_u.if_more(zero, on_g, beyond_v.if_more(zero, one - on_g, one));
    let take_g = (-first).if_more(zero, take_g, zero);
    let end = clamped(on_g, [zero, one]);
    [take_g.if_more(zero, one - end, s), take_g.if_more(zero, end, t)]
}

#[inline(always)]
fn clamped<R: Real>(t: R, [least, most]: [R; 2]) -> R {
    Real::min(Real::max(t, least), most)
}

/// Returns the parameter along a triangle's side nearest to a point: 0 at its start and 1 at its
/// end.
#[inline(always)]
fn along<R: Real>(point: [R; 2], side: [R; 2]) -> R {
    (point[0] * side[0] + point[1] * side[1]) / (side[0] * side[0] + side[1] * side[1])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_point_of_the_triangle_is_nearer() {
        let mut state = 1_u64;
        let mut random = move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            f64::from((state >> 33) as u32 % 2001) - 1000.0
        };
        let mut looked_at = 0;
        for _ in 0..3000 {
            let [a, b, c, p] = [0; 4].map(|_| [random(), random()]);
            let side = |from: [f64; 2], to: [f64; 2]| [to[0] - from[0], to[1] - from[1]];
            let (u, v, d) = (side(a, b), side(a, c), side(a, p));
            let cross = |a: [f64; 2], b: [f64; 2]| a[0] * b[1] - a[1] * b[0];
            let area = cross(u, v);
            if area == 0.0 {
                continue;
            }
            let (second, third) = (cross(d, v) / area, cross(u, d) / area);
            let first = 1.0 - second - third;
            if first >= 0.0 && second >= 0.0 && third >= 0.0 {
                continue;
            }
            looked_at += 1;
            let [s, t] = nearest(d, u, v, [first, second, third]);
            assert!(s >= 0.0 && t >= 0.0 && s + t <= 1.0 + 1e-12, "{s} {t}");
            let distance =
                |s: f64, t: f64| (d[0] - s * u[0] - t * v[0]).hypot(d[1] - s * u[1] - t * v[1]);
            // All points of the border, in small steps.
            let steps = (0..=500).map(|i| f64::from(i) / 500.0);
            let least = steps
                .flat_map(|i| [[i, 0.0], [0.0, i], [1.0 - i, i]])
                .map(|[s, t]| distance(s, t))
                .fold(f64::INFINITY, f64::min);
            assert!(distance(s, t) <= least + 1e-9, "{a:?} {b:?} {c:?} {p:?}");
        }
        assert!(looked_at > 1000);
    }
}
