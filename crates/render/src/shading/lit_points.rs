//! The points of triangles at which fragments are lit, in world space: shadow rays start there.
//!
//! The points are computed in f64 from integer edge functions, for either arithmetic, and lie
//! inside their triangles: see [`INSIDE`]. On request they are lifted to the smooth surface
//! suggested by vertex normals: see [`lift`].

use crate::accel::Accelerated as _;
use glam::{DMat3, DVec3};

use super::context::{Group, ShadingContext};
use super::interpolate::Points;
use super::interpolated::ShadingNumber;
use crate::frame::FramePlan;
use crate::frame::draw::Draw;
use crate::rays::Corners;
use crate::screen::coverage::SUBPIXELS;
use crate::screen::weights::Weights;
use crate::shadow::rays::Origins;
use crate::shadow::sequence::place_of_pixel;
use crate::shadow::tracer::Tracer;
use marraztu_core::accuracy::{Interpolation, Terminator};
use marraztu_core::base::math::{each, normal_matrix, unit};
use marraztu_core::scene::{Normals, dvec3};

/// Sets the points at which fragments are lit.
pub(crate) fn place_fragments<T: ShadingNumber>(
    group: &Group<'_, T>,
    (tracer, caster): (&Tracer<'_>, u32),
    Points { fragments, attributes, barycentrics }: Points<'_, T>,
    origins: &mut Origins,
) {
    let ShadingContext { plan, frame, .. } = *group.context;
    origins.begin(Some(caster), true);
    let vertices = frame.corners_of(group.draw_index);
    // Only weights with perspective are weights of positions.
    let has_perspective = group.context.mode().interpolation == Interpolation::Perspective;
    let (mut last, mut known) = (usize::MAX, None);
    for i in 0..fragments.len {
        let slot = fragments.slots[i].cast_unsigned() as usize;
        let number = attributes.numbers[slot];
        // Corners, normals and weights are only computed when the triangle changes.
        if slot != last {
            last = slot;
            let is_back = attributes.back >> slot & 1 == 1;
            let triangle = LitTriangle::new(group, (tracer, caster), (number, is_back), origins);
            let weights = Weights::of_positions(plan, group.draw, vertices, number);
            known = Some((triangle, weights));
        }
        let Some((triangle, weights)) = &known else { continue };
        let at_centre = weights.at([fragments.x[i], fragments.y[i]]);
        // Lit at the centre of the pixel, unless the centre is outside of the triangle.
        let is_inside = at_centre.min_element() >= 0.0;
        let is_shared = fragments.shared && has_perspective;
        let weights = if is_inside || !is_shared { at_centre } else { barycentrics.weights(i) };
        let place = light_place(plan, [fragments.x[i], fragments.y[i]]);
        triangle.place((i, place), weights, origins);
    }
}

/// Sets the points at which surfaces are lit that rays meet, from the triangle of each, its
/// weights, and its place in the sequences of samples. Those in the mask `back` show their backs.
pub(super) fn place_points<T: ShadingNumber>(
    group: &Group<'_, T>,
    of: (&Tracer<'_>, u32),
    (points, back): (impl Iterator<Item = (u32, DVec3, u32)>, u64),
    origins: &mut Origins,
) {
    origins.begin(Some(of.1), true);
    for (i, (number, weights, place)) in points.enumerate() {
        let is_back = back >> i & 1 == 1;
        LitTriangle::new(group, of, (number, is_back), origins).place((i, place), weights, origins);
    }
}

/// Returns the place of a pixel's samples in the sequences of lights. If each sample of a pixel is
/// lit, each has a part of them.
pub(super) fn light_place(plan: &FramePlan, [x, y]: [i32; 2]) -> u32 {
    let [left, top] = plan.shift.map(|shift| (shift + SUBPIXELS / 2).div_euclid(SUBPIXELS));
    let pixel = place_of_pixel([x + left, y + top]);
    match plan.lit_by_sample {
        true => pixel.wrapping_mul(plan.samples.count()).wrapping_add(plan.sample),
        false => pixel,
    }
}

/// A triangle with lit points, in world space.
struct LitTriangle {
    number: u32,
    corners: Corners,
    /// The normals at the corners, if points are lifted to the smooth surface.
    normals: Option<[DVec3; 3]>,
}

impl LitTriangle {
    fn new<T: ShadingNumber>(
        group: &Group<'_, T>,
        (tracer, caster): (&Tracer<'_>, u32),
        (number, is_back): (u32, bool),
        origins: &mut Origins,
    ) -> Self {
        let corners = tracer.corners_of(caster, number);
        // Points may be rounded off their planes by a multiple of the largest coordinate.
        let reach = corners.iter().fold(0.0, |most: f64, c| most.max(c.abs().max_element()));
        origins.reach = origins.reach.max(reach);
        let is_smooth = group.context.mode().terminator == Terminator::Smooth;
        let normals = (is_smooth && group.draw.normals == Normals::Vertex).then(|| {
            let turn = if is_back { -1.0 } else { 1.0 };
            each(normals_of(group.draw, tracer, caster, number), |normal| normal * turn)
        });
        Self { number, corners, normals }
    }

    /// Sets a point by its weights and its place in the sequences of samples.
    fn place(&self, (i, place): (usize, u32), weights: DVec3, origins: &mut Origins) {
        let Self { number, corners, normals } = self;
        // The point is moved off the edges, and its own triangle never shades it.
        let [y, z] = shares(weights);
        let at = within(corners, [y, z]);
        origins.set(i, at, [*number, number + 1], place);
        if let Some(normals) = normals {
            let lift = lift(corners, normals, [1.0 - y - z, y, z], at);
            if lift != DVec3::ZERO {
                origins.lift(i, at + lift);
            }
        }
    }
}

/// Returns the normals of a triangle's corners in world space, of length 1.
fn normals_of(draw: &Draw, tracer: &Tracer<'_>, caster: u32, number: u32) -> [DVec3; 3] {
    let order = draw.model.mesh.draw_order();
    let points = order.points(draw.normal_source);
    let to_world = normal_matrix(DMat3::from_mat4(tracer.placement(caster)));
    each(points.of(order, number, order.vertices_of(number)), |point| {
        unit(to_world * dvec3(points.normals[point as usize])).unwrap_or(DVec3::ZERO)
    })
}

/// Returns the offset of a triangle's point to the curved surface suggested by the normals N of its
/// corners V: sum of w max(0, (V - P) . N) N, with the weights w. No point is moved inwards.
///
/// Hanika, "Hacking the Shadow Terminator", Ray Tracing Gems II, 2021, chapter 4.
fn lift(corners: &Corners, normals: &[DVec3; 3], weights: [f64; 3], p: DVec3) -> DVec3 {
    let mut lift = DVec3::ZERO;
    for ((corner, normal), weight) in corners.iter().zip(normals).zip(weights) {
        lift += *normal * (weight * (*corner - p).dot(*normal).max(0.0));
    }
    lift
}

/// The smallest weight of a corner. A point on an edge may be rounded to either side of the face
/// beyond it, and that face would then shade the point. A millionth of the triangle inwards, the
/// point is on the right side of all faces that share the edge.
const INSIDE: f64 = 1e-6;

/// Returns the weights of the second and third corner, clamped together with the first. NaN is
/// clamped, too.
pub(super) fn shares(weights: DVec3) -> [f64; 2] {
    let [x, y, z] = each(weights.to_array(), |weight| weight.max(INSIDE));
    let sum = x + y + z;
    // Infinite weights give no point, so the centroid is lit.
    if sum.is_finite() { [y / sum, z / sum] } else { [1.0 / 3.0; 2] }
}

/// Returns the point of a triangle with these weights of its second and third corner.
pub(super) fn within([a, b, c]: &Corners, [y, z]: [f64; 2]) -> DVec3 {
    *a + (*b - *a) * y + (*c - *a) * z
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_on_edges_and_beyond_them_are_moved_inwards_and_others_are_not() {
        let corners = [DVec3::ZERO, DVec3::X * 3.0, DVec3::Y * 3.0];
        let within = |weights| within(&corners, shares(weights));
        let inner = DVec3::new(0.5, 0.25, 0.25);
        assert_eq!(within(inner), DVec3::new(0.75, 0.75, 0.0));
        for weights in [[0.5, 0.5, 0.0], [1.0, 0.0, 0.0], [-0.1, 0.6, 0.5], [f64::NAN, 0.5, 0.5]] {
            let DVec3 { x, y, .. } = within(DVec3::from_array(weights));
            assert!(x.min(y).min(3.0 - x - y) > 1e-6, "{weights:?}: {x}, {y}");
        }
        let far = DVec3::new(f64::INFINITY, 0.0, 0.0);
        assert_eq!(within(far), DVec3::new(1.0, 1.0, 0.0));
    }

    #[test]
    fn points_are_lifted_towards_the_surface_of_a_ball_and_never_into_a_bowl() {
        let corners = [DVec3::X, DVec3::Y, DVec3::Z];
        let middle = DVec3::splat(1.0 / 3.0);
        let third = [1.0 / 3.0; 3];
        let lifted = middle + lift(&corners, &corners, third, middle);
        // One third of (1 - 1/3) along each normal.
        assert!((lifted - DVec3::splat(1.0 / 3.0 + 2.0 / 9.0)).length() < 1e-15, "{lifted}");
        assert!(middle.length() < lifted.length() && lifted.length() < 1.0);
        let bowl = each(corners, |normal| -normal);
        assert_eq!(lift(&corners, &bowl, third, middle), DVec3::ZERO);
        let at_corner = lift(&corners, &corners, [1.0, 0.0, 0.0], DVec3::X);
        assert_eq!(at_corner, DVec3::ZERO, "corners stay where they are");
    }
}
