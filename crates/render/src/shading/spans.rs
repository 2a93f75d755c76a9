//! Perspective at every sixteenth pixel of a row, and linear interpolation between.
//!
//! A renderer that draws rows from their left ends computes two divisions for sixteen pixels. Here
//! the unit is a block of 8 x 8 pixels, so a span is found for each of its rows.

use super::barycentrics::Barycentrics;
use super::fragments::Fragments;
use super::triangle_attributes::{AttributeNumber, TriangleAttributes};
use crate::screen::spans::Row;

/// Replaces the weights of every fragment inside its triangle by the weights of its span, except in
/// clipped triangles.
pub(crate) fn interpolate_spans<T: AttributeNumber>(
    fragments: &Fragments,
    attributes: &TriangleAttributes<T>,
    to: &mut Barycentrics<T>,
) {
    let mut row = None;
    let mut span = None;
    for i in 0..fragments.len {
        let slot = fragments.slots[i].cast_unsigned() as usize;
        if attributes.cut >> slot & 1 == 1 {
            continue;
        }
        let (x, y) = (fragments.x[i], fragments.y[i]);
        let place = (slot, y);
        // Row and span are reused while fragments stay in them.
        let own = match row {
            Some((known, own)) if known == place => own,
            _ => {
                let by_w = [0, 1, 2].map(|corner| attributes.by_w[corner][slot].into());
                let own = Row::new(attributes.corners(slot), by_w, y, attributes.grid);
                (row, span) = (Some((place, own)), None);
                own
            }
        };
        let holds = |span: &crate::screen::spans::Span| span.holds(x);
        if !span.as_ref().is_some_and(holds) {
            span = own.span(x);
        }
        if let Some(span) = &span {
            let [second, third] = span.at(x);
            to.weights[0][i] = T::from_f64(second);
            to.weights[1][i] = T::from_f64(third);
        }
    }
}
