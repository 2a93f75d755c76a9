//! The points of triangles at which fragments are lit, in world space: rays of shadows begin there.
//!
//! They are computed in f64 from whole edge functions, in either arithmetic, and lie in their
//! triangles but for the rounding of one sum.

use glam::DVec3;

use super::barycentrics::Barycentrics;
use super::context::ShadingContext;
use super::fragments::Fragments;
use super::groups::Group;
use super::interpolated::ShadingNumber;
use super::triangle_attributes::TriangleAttributes;
use crate::render::screen::weights::Weights;
use crate::render::shadow::rays::Origins;
use crate::render::shadow::tracer::Tracer;

/// Sets the points at which fragments are lit.
pub(crate) fn place_fragments<T: ShadingNumber>(
    context: &ShadingContext<'_, T>,
    (tracer, caster): (&Tracer<'_>, u32),
    group: &Group<'_>,
    (fragments, attributes): (&Fragments, &TriangleAttributes<T>),
    barycentrics: &Barycentrics<T>,
    origins: &mut Origins,
) {
    let ShadingContext { plan, frame, .. } = *context;
    origins.begin(Some(caster), true);
    let vertices = frame.corners_of(group.draw_index);
    let (mut last, mut known) = (usize::MAX, None);
    for i in 0..fragments.len {
        let slot = fragments.slots[i].cast_unsigned() as usize;
        let number = attributes.numbers[slot];
        if slot != last {
            last = slot;
            let corners = tracer.corners_of(caster, number);
            let reach = corners.iter().fold(0.0, |most: f64, c| most.max(c.abs().max_element()));
            origins.reach = origins.reach.max(reach);
            known = Some((corners, Weights::new(plan, group.draw, vertices, number, [0; 2])));
        }
        let Some((corners, weights)) = &known else { continue };
        let at_centre = weights.at([fragments.x[i], fragments.y[i]]);
        // Lit at the centre of its pixel, unless that is outside of the triangle.
        let is_inside = at_centre.min_element() >= 0.0;
        let weights =
            if is_inside || !fragments.shared { at_centre } else { barycentrics.weights(i) };
        origins.set(i, within(corners, weights), [number, number + 1]);
    }
}

/// The point of a triangle with these weights of its corners, which are clamped.
fn within([a, b, c]: &[DVec3; 3], weights: DVec3) -> DVec3 {
    let weights = DVec3::new(above_0(weights.x), above_0(weights.y), above_0(weights.z));
    let sum = weights.element_sum();
    let weights =
        if sum > 0.0 && sum.is_finite() { weights / sum } else { DVec3::splat(1.0 / 3.0) };
    *a + (*b - *a) * weights.y + (*c - *a) * weights.z
}

/// NaN gives 0.
fn above_0(x: f64) -> f64 {
    if x > 0.0 { x } else { 0.0 }
}
