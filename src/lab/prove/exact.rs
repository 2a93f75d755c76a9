//! Which pixels a triangle covers, without any edge function: the oracle of coverage.
//!
//! The rule for pixels on an edge says nothing else than that every centre is moved to the right by
//! less than anything, and down by less than that: then none lies on an edge. So the centres of a row
//! that a triangle covers are those between the two places where its outline crosses the row, and
//! these are fractions, compared as whole numbers of 128 bits. What a closed outline winds about is
//! counted by the same crossings.

use std::ops::Range;

use crate::render::screen::coverage::{SUBPIXELS, Snapped};

/// The first column of row `y` whose centre lies to the right of where the side from `p` to `q`
/// crosses the row; `None` where it does not.
fn crossing(p: Snapped, q: Snapped, y: i32) -> Option<i64> {
    let part = i128::from(SUBPIXELS);
    let centre = i128::from(y) * part + part / 2;
    let (py, qy) = (i128::from(p.y), i128::from(q.y));
    // The centre is moved down, so a corner at its height is above it.
    if (py <= centre) == (qy <= centre) {
        return None;
    }
    let (px, qx) = (i128::from(p.x), i128::from(q.x));
    // x = px + (centre - py) (qx - px) / (qy - py), from the middle of the first column, in columns.
    let (above, below) =
        ((px - part / 2) * (qy - py) + (centre - py) * (qx - px), (qy - py) * part);
    let (above, below) = (above * below.signum(), below.abs());
    // Rounded up: the centre is moved right, so a crossing at it is to its left.
    i64::try_from(-(-above).div_euclid(below)).ok()
}

/// The columns of row `y` whose centres a triangle of either winding covers.
#[must_use]
pub fn span([p, q, r]: [Snapped; 3], y: i32) -> Range<i64> {
    let mut ends = [(p, q), (q, r), (r, p)].into_iter().filter_map(|(p, q)| crossing(p, q, y));
    match (ends.next(), ends.next()) {
        (Some(a), Some(b)) => a.min(b)..a.max(b),
        _ => 0..0,
    }
}

/// How often a closed outline winds about the centre of every pixel of a row, clockwise on the screen
/// being positive: `windings[x]` for column x.
pub fn wind(outline: &[Snapped], y: i32, windings: &mut [i32]) {
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

#[cfg(test)]
mod tests {
    use super::*;

    fn at(x: i32, y: i32) -> Snapped {
        Snapped { x, y }
    }

    #[test]
    fn a_square_from_centre_to_centre_has_its_upper_and_left_pixels() {
        // From the centre of pixel (0, 0) to that of pixel (2, 2).
        let [a, b, c, d] = [at(128, 128), at(640, 128), at(640, 640), at(128, 640)];
        for y in 0..2 {
            let (upper, lower) = (span([a, b, c], y), span([a, c, d], y));
            let columns = (upper.end - upper.start) + (lower.end - lower.start);
            assert_eq!((columns, lower.start, upper.end), (2, 0, 2), "row {y}");
        }
        assert!(span([a, b, c], 2).is_empty() && span([a, c, d], -1).is_empty());
    }

    #[test]
    fn an_outline_that_goes_round_twice_winds_twice() {
        let square = [at(0, 0), at(1024, 0), at(1024, 1024), at(0, 1024)];
        let twice: Vec<Snapped> = square.iter().chain(&square).copied().collect();
        let mut row = [9; 6];
        wind(&twice, 1, &mut row);
        assert_eq!(row, [2, 2, 2, 2, 0, 0]);
        let back: Vec<Snapped> = square.iter().rev().copied().collect();
        wind(&back, 3, &mut row);
        assert_eq!(row, [-1, -1, -1, -1, 0, 0]);
    }
}
