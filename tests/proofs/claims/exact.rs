//! The oracle of coverage: finds the pixels of a triangle without edge functions.
//!
//! The tie rule moves every pixel centre right by an infinitesimal amount, and down by an even
//! smaller one, so no centre lies on an edge. A triangle covers the centres of a row between the
//! two points where its outline crosses that row. The crossings are fractions, compared as integers
//! of 128 bits. They also give the winding number of a closed outline.

use std::ops::Range;

use marraztu_render::screen::coverage::{SUBPIXELS, Snapped};

/// The first column of row `y` with its centre right of the point where the side from `p` to `q`
/// crosses the row; `None` if the side does not cross it.
fn crossing(p: Snapped, q: Snapped, y: i32) -> Option<i64> {
    let part = i128::from(SUBPIXELS);
    let centre = i128::from(y) * part + part / 2;
    let (py, qy) = (i128::from(p.y), i128::from(q.y));
    // The centre moves down, so a corner at the same height is above it.
    if (py <= centre) == (qy <= centre) {
        return None;
    }
    let (px, qx) = (i128::from(p.x), i128::from(q.x));
    // x = px + (centre - py) (qx - px) / (qy - py), from the middle of the first column, in
    // columns.
    let (above, below) =
        ((px - part / 2) * (qy - py) + (centre - py) * (qx - px), (qy - py) * part);
    let (above, below) = (above * below.signum(), below.abs());
    // Rounded up: the centre moves right, so a crossing at the same position is left of it.
    i64::try_from(-(-above).div_euclid(below)).ok()
}

/// The columns of row `y` with centres inside a triangle of either winding.
#[must_use]
pub(crate) fn span([p, q, r]: [Snapped; 3], y: i32) -> Range<i64> {
    let mut ends = [(p, q), (q, r), (r, p)].into_iter().filter_map(|(p, q)| crossing(p, q, y));
    match (ends.next(), ends.next()) {
        (Some(a), Some(b)) => a.min(b)..a.max(b),
        _ => 0..0,
    }
}

/// Computes the winding numbers of a closed outline around the pixel centres of a row, positive for
/// clockwise on the screen: `windings[x]` for column x.
pub(crate) fn wind(outline: &[Snapped], y: i32, windings: &mut [i32]) {
    windings.fill(0);
    let columns = i64::try_from(windings.len()).expect("rows are short");
    for (i, p) in outline.iter().enumerate() {
        let q = outline[(i + 1) % outline.len()];
        let Some(column) = crossing(*p, q, y) else { continue };
        let up = if q.y < p.y { 1 } else { -1 };
        let begin = usize::try_from(column.clamp(0, columns)).expect("clamped");
        for winding in &mut windings[begin..] {
            *winding += up;
        }
    }
}
