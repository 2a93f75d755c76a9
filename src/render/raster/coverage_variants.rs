//! The variants of coverage: which pixels a triangle covers, one pixel after the other.
//!
//! * Integer edge functions, like the default, but with the chosen subpixels.
//! * Edge functions in f32 of corners that are not snapped. A centre on an edge is covered by both
//!   sides, and a centre near to it may by rounding be covered by both or by neither.
//! * Scan lines, as in software before edge functions: corners are rounded to whole pixels, and
//!   each row runs from the left edge to the right edge, rounded and inclusive. So neighbours cover
//!   the pixels that they share twice, and pixels are covered whose centres lie outside.

use super::unsnapped::UnsnappedTriangle;
use crate::base::math::each;
use crate::render::screen::coverage::{PixelBox, Snapped, doubled_area};

/// A pixel, by column and row, and its depth.
type Take<'a> = &'a mut dyn FnMut(i32, i32, f32);

/// Covers pixels by integer edge functions, with `parts` subpixels per pixel.
#[expect(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    reason = "the nearest number is meant"
)]
pub(crate) fn exactly(plain: &UnsnappedTriangle, parts: i32, clip: PixelBox, take: Take<'_>) {
    let area = doubled_area(plain.corners);
    let [p, q, r] = plain.corners;
    let edges = [Edge::new(q, r, area), Edge::new(r, p, area), Edge::new(p, q, area)];
    let [a, b, c] = plain.depths.map(f64::from);
    let per_area = 1.0 / area.abs() as f64;
    let clamped = clamped(plain);
    let middle = |i: i32| i64::from(i) * i64::from(parts) + i64::from(parts / 2);
    for y in clip.top..clip.bottom {
        for x in clip.left..clip.right {
            let values = each(edges, |edge| edge.at(middle(x), middle(y)));
            if edges.iter().zip(values).all(|(edge, value)| edge.covers(value)) {
                let [_, second, third] = values.map(|value| value as f64 * per_area);
                take(x, y, clamped((a + second * (b - a) + third * (c - a)) as f32));
            }
        }
    }
}

/// a x + b y + c, not negative inside.
#[derive(Clone, Copy)]
struct Edge([i64; 3]);

impl Edge {
    /// From `p` to `q` of a triangle with this area.
    fn new(p: Snapped, q: Snapped, area: i64) -> Self {
        let (p, q) = if area < 0 { (q, p) } else { (p, q) };
        let [px, py, qx, qy] = [p.x, p.y, q.x, q.y].map(i64::from);
        Self([py - qy, qx - px, px * qy - py * qx])
    }

    const fn at(self, x: i64, y: i64) -> i64 {
        let Self([a, b, c]) = self;
        a * x + b * y + c
    }

    /// The top-left rule: centres on top and left edges are covered.
    const fn covers(self, value: i64) -> bool {
        let Self([a, b, _]) = self;
        value > 0 || (value == 0 && (a > 0 || (a == 0 && b > 0)))
    }
}

/// Covers pixels by edge functions in f32.
#[expect(clippy::cast_possible_truncation, reason = "32 bits are meant")]
#[expect(clippy::cast_precision_loss, reason = "columns and rows are small")]
pub(crate) fn in_32_bits(plain: &UnsnappedTriangle, clip: PixelBox, take: Take<'_>) {
    let [p, q, r] = plain.pixels.map(|at| at.map(|x| x as f32));
    let area = (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
    let edge = |p: [f32; 2], q: [f32; 2], x: f32, y: f32| {
        ((p[1] - q[1]) * x + (q[0] - p[0]) * y + (p[0] * q[1] - p[1] * q[0])) * area.signum()
    };
    let [a, b, c] = plain.depths;
    let clamped = clamped(plain);
    for y in clip.top..clip.bottom {
        for x in clip.left..clip.right {
            let (cx, cy) = (x as f32 + 0.5, y as f32 + 0.5);
            let values = [edge(q, r, cx, cy), edge(r, p, cx, cy), edge(p, q, cx, cy)];
            if values.iter().all(|value| *value >= 0.0) {
                let [second, third] = [values[1], values[2]].map(|value| value / area.abs());
                take(x, y, clamped(a + second * (b - a) + third * (c - a)));
            }
        }
    }
}

/// Covers pixels row by row.
#[expect(clippy::cast_possible_truncation, reason = "whole pixels are meant")]
#[expect(clippy::cast_precision_loss, reason = "columns and rows are small")]
pub(crate) fn by_scan_lines(plain: &UnsnappedTriangle, clip: PixelBox, take: Take<'_>) {
    let corners = plain.pixels.map(|at| at.map(|x| x.round() as i32));
    let rows = corners.map(|[_, y]| y);
    let (low, high) = (rows[0].min(rows[1]).min(rows[2]), rows[0].max(rows[1]).max(rows[2]));
    for y in low.max(clip.top)..(high + 1).min(clip.bottom) {
        // The ends of the row: column and depth.
        let mut ends = [[f32::INFINITY, 0.0], [f32::NEG_INFINITY, 0.0]];
        for i in 0..3 {
            let (p, q) = (corners[i], corners[(i + 1) % 3]);
            let (dp, dq) = (plain.depths[i], plain.depths[(i + 1) % 3]);
            if y < p[1].min(q[1]) || y > p[1].max(q[1]) {
                continue;
            }
            let down = (q[1] - p[1]) as f32;
            let parts = if down == 0.0 { [0.0, 1.0] } else { [(y - p[1]) as f32 / down; 2] };
            for t in parts {
                let end = [p[0] as f32 + t * (q[0] - p[0]) as f32, dp + t * (dq - dp)];
                if end[0] < ends[0][0] {
                    ends[0] = end;
                }
                if end[0] > ends[1][0] {
                    ends[1] = end;
                }
            }
        }
        let [[left, from], [right, to]] = ends;
        let per_pixel = if right > left { (to - from) / (right - left) } else { 0.0 };
        let clamped = clamped(plain);
        let columns =
            (left.round() as i32).max(clip.left)..(right.round() as i32 + 1).min(clip.right);
        for x in columns {
            take(x, y, clamped(from + per_pixel * (x as f32 - left)));
        }
    }
}

/// Clamps a depth to those of the corners.
fn clamped(plain: &UnsnappedTriangle) -> impl Fn(f32) -> f32 {
    let [a, b, c] = plain.depths;
    let (low, high) = (a.min(b).min(c), a.max(b).max(c));
    move |depth| {
        let depth = if depth > low { depth } else { low };
        if depth < high { depth } else { high }
    }
}

#[cfg(test)]
#[expect(clippy::cast_possible_truncation, reason = "small numbers")]
mod tests {
    use super::*;
    use crate::render::screen::coverage::{SUBPIXELS, Triangle};

    const CLIP: PixelBox = PixelBox { left: 0, top: 0, right: 40, bottom: 40 };

    fn plain(pixels: [[f64; 2]; 3], parts: i32) -> UnsnappedTriangle {
        let corners = pixels.map(|at| {
            let [x, y] = at.map(|x| (x * f64::from(parts)).round() as i32);
            Snapped { x, y }
        });
        UnsnappedTriangle { corners, pixels, depths: [0.5; 3], number: 0, cutout: false }
    }

    /// Counts how often each pixel of a square is covered by its two halves.
    fn counts(
        [x, y]: [f64; 2],
        cover: impl Fn(&UnsnappedTriangle, Take<'_>),
    ) -> std::collections::BTreeMap<(i32, i32), u32> {
        let at = |u: f64, v: f64| [x + 20.0 * u, y + 20.0 * v];
        let mut counts = std::collections::BTreeMap::new();
        for half in
            [[at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0)], [at(0.0, 0.0), at(1.0, 1.0), at(0.0, 1.0)]]
        {
            cover(&plain(half, SUBPIXELS), &mut |x, y, depth| {
                assert_eq!(depth, 0.5);
                *counts.entry((x, y)).or_default() += 1;
            });
        }
        counts
    }

    #[test]
    fn whole_numbers_cover_what_they_cover_elsewhere() {
        let mut state = 1_u64;
        let mut random = move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            // Half of them on a centre or a border of a pixel.
            let parts = (state >> 33) % (45 * 256);
            (if state >> 63 == 0 { parts } else { parts / 128 * 128 }) as f64 / 256.0 - 2.5
        };
        for _ in 0..300 {
            let plain = plain([0; 3].map(|_: i32| [random(), random()]), SUBPIXELS);
            let Some(triangle) = Triangle::new(plain.corners) else { continue };
            let (mut want, mut got) = (Vec::new(), Vec::new());
            triangle.covered(CLIP, |pixel| want.push((pixel.x, pixel.y)));
            exactly(&plain, SUBPIXELS, CLIP, &mut |x, y, _| got.push((x, y)));
            assert_eq!(got, want);
        }
    }

    #[test]
    fn a_square_of_two_halves_is_covered_once_twice_on_an_edge_and_twice_at_every_seam() {
        let centres = [5.5, 5.5];
        let exact = counts(centres, |plain, take| exactly(plain, SUBPIXELS, CLIP, take));
        assert_eq!((exact.len(), exact.values().sum::<u32>()), (400, 400));
        let floats = counts(centres, |plain, take| in_32_bits(plain, CLIP, take));
        // Both ends of 20 pixels, and the centres on the seam by both.
        assert_eq!((floats.len(), floats.values().sum::<u32>()), (441, 441 + 21));
        let lines = counts([5.2, 5.2], |plain, take| by_scan_lines(plain, CLIP, take));
        assert_eq!((lines.len(), lines.values().sum::<u32>()), (441, 441 + 21));
    }
}
