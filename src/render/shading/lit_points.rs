//! The points of triangles at which fragments are lit, in world space: rays of shadows begin there.
//!
//! They are computed in f64 from whole edge functions, in either arithmetic, and lie inside their
//! triangles: see [`INSIDE`].

use glam::DVec3;

use super::barycentrics::Barycentrics;
use super::context::ShadingContext;
use super::fragments::Fragments;
use super::groups::Group;
use super::interpolated::ShadingNumber;
use super::triangle_attributes::TriangleAttributes;
use crate::base::math::each;
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

/// The least weight of a corner. A point on an edge may be rounded to either side of the face
/// beyond it, which would then shade the point; a millionth of the triangle inwards, it is on the
/// right side of all faces that share the edge.
const INSIDE: f64 = 1e-6;

/// The point of a triangle with these weights of its corners, which are clamped. NaN is clamped,
/// too.
fn within([a, b, c]: &[DVec3; 3], weights: DVec3) -> DVec3 {
    let [x, y, z] = each(weights.to_array(), |weight| weight.max(INSIDE));
    let sum = x + y + z;
    let [y, z] = if sum.is_finite() { [y / sum, z / sum] } else { [1.0 / 3.0; 2] };
    *a + (*b - *a) * y + (*c - *a) * z
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_on_edges_and_beyond_them_are_moved_inwards_and_others_are_not() {
        let corners = [DVec3::ZERO, DVec3::X * 3.0, DVec3::Y * 3.0];
        let inner = DVec3::new(0.5, 0.25, 0.25);
        assert_eq!(within(&corners, inner), DVec3::new(0.75, 0.75, 0.0));
        for weights in [[0.5, 0.5, 0.0], [1.0, 0.0, 0.0], [-0.1, 0.6, 0.5], [f64::NAN, 0.5, 0.5]] {
            let DVec3 { x, y, .. } = within(&corners, DVec3::from_array(weights));
            assert!(x.min(y).min(3.0 - x - y) > 1e-6, "{weights:?}: {x}, {y}");
        }
        let far = DVec3::new(f64::INFINITY, 0.0, 0.0);
        assert_eq!(within(&corners, far), DVec3::new(1.0, 1.0, 0.0));
    }
}
