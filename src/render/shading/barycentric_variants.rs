//! Barycentric coordinates of fragments, one at a time, by the variant that the settings choose.

use super::barycentrics::Barycentrics;
use super::fragments::Fragments;
use super::triangle_attributes::{AttributeNumber, TriangleAttributes};
use crate::render::frame::variants::Variants;
use crate::render::screen::clip::ScreenVertex;
use crate::render::screen::interpolation::parts_at;

/// Computes the barycentric coordinates of every fragment by a variant, except in clipped
/// triangles.
pub(crate) fn locate_by_variant<T: AttributeNumber>(
    variants: Variants,
    fragments: &Fragments,
    attributes: &TriangleAttributes<T>,
    corners: &[ScreenVertex],
    to: &mut Barycentrics<T>,
) {
    for i in 0..fragments.len {
        let slot = fragments.slots[i].cast_unsigned() as usize;
        let corners = attributes.corners_among(slot, corners);
        if !corners.iter().all(ScreenVertex::is_inside) {
            continue;
        }
        let by_w = [0, 1, 2].map(|corner| attributes.by_w[corner][slot].into());
        let pixel = ([fragments.x[i], fragments.y[i]], [0; 2]);
        let corners = corners.map(|corner| corner.at());
        let ([second, third], w) = parts_at(variants, corners, by_w, pixel, fragments.shared);
        to.weights[0][i] = T::from_f64(second);
        to.weights[1][i] = T::from_f64(third);
        to.w[i] = T::from_f64(w);
    }
}
