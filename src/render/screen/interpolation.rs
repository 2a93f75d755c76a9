//! Barycentric coordinates of single pixels, for the variants of interpolation, subpixels and
//! coverage: affine, perspective-correct at every sixteenth pixel, on a finer grid, or at pixels
//! whose centres no triangle covers.
//!
//! Every sixteenth pixel: a division per pixel was too slow for games of 1996, so a row of a
//! triangle was divided into spans of sixteen pixels from its left end, the last one shorter, with
//! perspective at their ends and linear interpolation between. Abrash, "Graphics Programming Black
//! Book", 1997, chapter 70.

use super::coverage::{SUBPIXELS, Snapped, doubled_area};
use crate::accuracy::{Coverage, Interpolation};
use crate::render::frame::variants::Variants;

/// Pixels of a span.
const PIECE: i64 = 16;

/// The weights of a triangle's second and third corner.
type Parts = [f64; 2];

/// The subpixels per pixel of triangle corners.
pub(crate) fn subpixels(variants: Variants) -> i32 {
    if variants.has_fine_corners() { 4096 } else { SUBPIXELS }
}

/// The weights at a pixel by the chosen variant, `shift` subpixels from its centre, and w there.
/// Positions that may lie outside are clamped to the triangle.
pub(crate) fn parts_at(
    variants: Variants,
    corners: [Snapped; 3],
    by_w: [f64; 3],
    ([x, y], shift): ([i32; 2], [i32; 2]),
    clamped: bool,
) -> (Parts, f64) {
    let [dx, dy] = shift.map(|shift| shift * (subpixels(variants) / SUBPIXELS));
    let corners = corners.map(|at| Snapped { x: at.x - dx, y: at.y - dy });
    let clamped = clamped || variants.coverage != Coverage::Exact;
    let linear = |x: f64| linear(variants, corners, [x, f64::from(y)], clamped);
    let own = linear(f64::from(x));
    let (exact, w) = perspective(own, by_w);
    let parts = match variants.interpolation {
        Interpolation::Perspective => exact,
        Interpolation::Affine => own,
        Interpolation::EverySixteen => match piece(variants, corners, [x, y]) {
            Some([from, to]) => {
                let t = (f64::from(x) - from) / (to - from);
                let [a, b] = [from, to].map(|x| perspective(linear(x), by_w).0);
                [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])]
            }
            None => exact,
        },
    };
    (parts, w)
}

/// The weights at a position, in pixels, linear on the screen.
#[expect(clippy::cast_precision_loss, reason = "the nearest number is meant")]
fn linear(variants: Variants, corners: [Snapped; 3], at: [f64; 2], clamped: bool) -> Parts {
    let parts = f64::from(subpixels(variants));
    let [x, y] = at.map(|i| (i + 0.5) * parts);
    let [p, q, r] = corners.map(|Snapped { x, y }| [f64::from(x), f64::from(y)]);
    // The differences are integers, so that a corner's own weight is exactly 1.
    let area = doubled_area(corners) as f64;
    let edge = |p: [f64; 2], q: [f64; 2]| (q[0] - p[0]) * (y - p[1]) - (q[1] - p[1]) * (x - p[0]);
    let [second, third] = [edge(r, p) / area, edge(p, q) / area];
    if !clamped {
        return [second, third];
    }
    // The centre may lie outside: clamped, so that nothing is extrapolated.
    let clamped = [1.0 - second - third, second, third].map(|part| part.max(0.0));
    let sum: f64 = clamped.iter().sum();
    if sum > 0.0 { [clamped[1] / sum, clamped[2] / sum] } else { [1.0 / 3.0; 2] }
}

/// The first and the last column of the span of a pixel; `None` if it is a single pixel, or the
/// pixel is not inside the triangle.
#[expect(clippy::cast_precision_loss, reason = "columns are small numbers")]
fn piece(variants: Variants, corners: [Snapped; 3], [x, y]: [i32; 2]) -> Option<[f64; 2]> {
    let parts = i64::from(subpixels(variants));
    let sign = doubled_area(corners).signum();
    let (mut first, mut last) = (i64::MIN, i64::MAX);
    for i in 0..3 {
        let [p, q] =
            [corners[i], corners[(i + 1) % 3]].map(|at| [i64::from(at.x), i64::from(at.y)]);
        // sign * e(column) >= 0 with e = a column + b.
        let a = sign * (p[1] - q[1]) * parts;
        let middle = |i: i64| i * parts + parts / 2;
        let b = sign
            * ((q[0] - p[0]) * (middle(i64::from(y)) - p[1]) - (q[1] - p[1]) * (middle(0) - p[0]));
        match a {
            0 => {}
            1.. => first = first.max(-(b.div_euclid(a))),
            _ => last = last.min(b.div_euclid(-a)),
        }
    }
    let x = i64::from(x);
    if !(first..=last).contains(&x) || first == last {
        return None;
    }
    let from = first + (x - first) / PIECE * PIECE;
    let to = (from + PIECE).min(last);
    // The last pixel of a row ends the span before it.
    let from = if from == to { from - PIECE.min(from - first) } else { from };
    Some([from as f64, to as f64])
}

/// The perspective-correct weights, and w.
fn perspective([second, third]: Parts, [w0, w1, w2]: [f64; 3]) -> (Parts, f64) {
    let w = 1.0 / (w0 + second * (w1 - w0) + third * (w2 - w0));
    ([second * w1 * w, third * w2 * w], w)
}

#[cfg(test)]
#[expect(clippy::cast_possible_truncation, reason = "small numbers")]
mod tests {
    use super::*;

    /// The worst error in texels along a wall from z 2.2 to 100, 800 pixels wide, with 1024 texels.
    fn worst(interpolation: Interpolation) -> f64 {
        let ways = Variants { interpolation, ..Variants::default() };
        let at = |x: i32, y: i32| Snapped { x: x * 256, y: y * 256 };
        let corners = [at(0, 0), at(800, 0), at(0, 160_000)];
        let by_w = [1.0 / 2.2, 1.0 / 100.0, 1.0 / 2.2];
        let exact = Variants::default();
        let apart = |x: i32| {
            let of = |ways: Variants| parts_at(ways, corners, by_w, ([x, 0], [0; 2]), false).0[0];
            (of(ways) - of(exact)).abs() * 1024.0
        };
        (0..799).map(apart).fold(0.0, f64::max)
    }

    /// The largest error of linear interpolation between two ends whose distances have the ratio r,
    /// relative to the length between them: (sqrt r - 1) / (sqrt r + 1).
    fn most(ratio: f64) -> f64 {
        (ratio.sqrt() - 1.0) / (ratio.sqrt() + 1.0)
    }

    #[test]
    fn a_wall_is_as_wrong_as_the_equation_of_perspective_says() {
        let all = 1024.0 * most(100.0 / 2.2);
        assert!((worst(Interpolation::Affine) / all - 1.0).abs() < 0.005, "of {all}");
        // w and the texel at a column's centre, and the error of spans of sixteen.
        let w = |x: i32| {
            let t = (f64::from(x) + 0.5) / 800.0;
            1.0 / (1.0 / 2.2 + t * (1.0 / 100.0 - 1.0 / 2.2))
        };
        let texel = |x: i32| (f64::from(x) + 0.5) / 800.0 / 100.0 * w(x) * 1024.0;
        let piece = |i: i32| {
            let (from, to) = (16 * i, (16 * i + 16).min(799));
            (texel(to) - texel(from)) * most(w(to) / w(from))
        };
        let pieces = (0..50).map(piece).fold(0.0, f64::max);
        let sixteen = worst(Interpolation::EverySixteen);
        assert!((0.9..1.001).contains(&(sixteen / pieces)), "{sixteen} of {pieces}");
        assert_eq!(worst(Interpolation::Perspective), 0.0);
    }

    #[test]
    fn pieces_of_a_row_begin_at_its_left_end_and_end_at_its_right() {
        let ways = Variants::default();
        let at = |x: i32, y: i32| Snapped { x: x * 256, y: y * 256 };
        // The centres of row 0 are inside from 10 to 53.
        let corners = [at(10, -10), at(10, 30), at(70, -10)];
        let (first, last) = (10, 53);
        for x in first..=last {
            let [from, to] = piece(ways, corners, [x, 0]).unwrap();
            assert!(from <= f64::from(x) && f64::from(x) <= to && to - from <= 16.0, "{x}");
            assert!((from as i32 - first) % 16 == 0 || to as i32 == last, "{x}: {from} to {to}");
        }
        assert_eq!(piece(ways, corners, [first - 1, 0]), None);
        assert_eq!(piece(ways, corners, [last + 1, 0]), None);
    }

    #[test]
    fn a_corner_has_all_of_itself_and_what_is_outside_stays_within() {
        let at = |x: i32, y: i32| Snapped { x, y };
        let corners = [at(128, 128), at(10_368, 128), at(128, 5248)];
        for coverage in [Coverage::Exact, Coverage::ScanLines] {
            let ways = Variants { coverage, ..Variants::default() };
            for (pixel, want) in
                [([0, 0], [0.0, 0.0]), ([40, 0], [1.0, 0.0]), ([0, 20], [0.0, 1.0])]
            {
                assert_eq!(
                    parts_at(ways, corners, [1.0, 0.5, 0.25], (pixel, [0; 2]), false).0,
                    want
                );
            }
        }
        let ways = Variants { coverage: Coverage::Points, ..Variants::default() };
        for pixel in [[-3, 5], [41, 21], [20, -1]] {
            let ([b, c], w) = parts_at(ways, corners, [1.0, 0.5, 0.25], (pixel, [0; 2]), false);
            assert!(b >= 0.0 && c >= 0.0 && b + c <= 1.0 + 1e-12 && w > 0.0, "{pixel:?}: {b} {c}");
        }
    }
}
