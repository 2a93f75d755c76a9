//! Where fragments lie in their triangles, one at a time, by the variant that settings name.

use super::barycentrics::Barycentrics;
use super::fragments::Fragments;
use super::triangle_attributes::{Faced, TriangleAttributes};
use crate::render::frame::variants::Variants;
use crate::render::screen::clip::ScreenVertex;
use crate::render::screen::interpolation::parts_at;

/// Finds where every fragment lies by a variant, but for triangles that are cut.
pub(crate) fn locate_by_variant<T: Faced>(
    variants: Variants,
    items: &Fragments,
    faces: &TriangleAttributes<T>,
    corners: &[ScreenVertex],
    to: &mut Barycentrics<T>,
) {
    for i in 0..items.len {
        let slot = items.slots[i].cast_unsigned() as usize;
        let corners = faces.corners_among(slot, corners);
        if !corners.iter().all(ScreenVertex::is_inside) {
            continue;
        }
        let by_w = [0, 1, 2].map(|corner| faces.by_w[corner][slot].into());
        let pixel = ([items.x[i], items.y[i]], [0; 2]);
        let corners = corners.map(|corner| corner.at());
        let ([second, third], w) = parts_at(variants, corners, by_w, pixel, items.shared);
        to.weights[0][i] = T::from_f64(second);
        to.weights[1][i] = T::from_f64(third);
        to.w[i] = T::from_f64(w);
    }
}
