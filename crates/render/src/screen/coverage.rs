//! Decides which pixels a triangle covers, with integer edge functions.
//!
//! Corners are snapped to 1/256 pixel. All later steps use integer arithmetic: coverage is exact
//! and the same for every arithmetic of light. Triangles that share an edge leave no gap and cover
//! no pixel twice.
//!
//! The edge functions: Pineda, "A Parallel Algorithm for Polygon Rasterization", SIGGRAPH 1988.
//! Centres on an edge follow the top-left rule of Direct3D and Vulkan.
//!
//! Coordinates stay within 2^28 (the guard band of 2^20 pixels). Edge functions therefore stay
//! below 2^59 and never overflow.

pub use crate::frame::raster_mode::Grid;
use serde::{Deserialize, Serialize};

use marraztu_core::base::math::each;

/// The number of subpixels per pixel, in each direction.
pub const SUBPIXELS: i32 = Grid::Usual.parts();

/// A snapped point of the picture in subpixels: x to the right, y down.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Snapped {
    /// The distance from the left border.
    pub x: i32,
    /// The distance from the upper border.
    pub y: i32,
}

impl Snapped {
    /// Returns the point relative to a sample with this shift.
    #[inline(always)]
    #[must_use]
    pub const fn seen_from(self, [x, y]: [i32; 2]) -> Self {
        Self { x: self.x - x, y: self.y - y }
    }
}

/// A rectangle of pixels: columns `left..right` of rows `top..bottom`. The default is empty.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct PixelBox {
    /// The first column.
    pub left: i32,
    /// The first row.
    pub top: i32,
    /// The column after the last.
    pub right: i32,
    /// The row after the last.
    pub bottom: i32,
}

impl PixelBox {
    /// Returns the box of pixels with a centre in the bounding box of three points.
    #[inline(always)]
    #[must_use]
    pub fn of(corners: [Snapped; 3]) -> Self {
        Self::reached(corners, [[0; 2]; 2])
    }

    /// Returns the box of pixels with a sample that may lie in the bounding box of three points.
    /// Samples are `least` to `most` subpixels from the centre.
    #[inline(always)]
    #[must_use]
    pub fn reached(corners: [Snapped; 3], reach: [[i32; 2]; 2]) -> Self {
        Self::reached_on(Grid::Usual, corners, reach)
    }

    /// Returns the same box for points on a grid; sample offsets are in 1/256 pixel.
    #[inline(always)]
    #[must_use]
    pub fn reached_on(grid: Grid, [a, b, c]: [Snapped; 3], [least, most]: [[i32; 2]; 2]) -> Self {
        let (least, most) = (grid.offset(least), grid.offset(most));
        let (parts, half) = (grid.parts(), grid.parts() / 2);
        // The first centre at or after the smallest coordinate; past the last one before the
        // largest.
        let first = |a: i32, b: i32, c: i32, most: i32| {
            (a.min(b).min(c) + half - 1 - most).div_euclid(parts)
        };
        let end = |a: i32, b: i32, c: i32, least: i32| {
            (a.max(b).max(c) - half - least).div_euclid(parts) + 1
        };
        Self {
            left: first(a.x, b.x, c.x, most[0]),
            top: first(a.y, b.y, c.y, most[1]),
            right: end(a.x, b.x, c.x, least[0]),
            bottom: end(a.y, b.y, c.y, least[1]),
        }
    }

    /// Returns the intersection of two boxes. Empty boxes have `left >= right` or `top >= bottom`.
    #[must_use]
    pub fn intersection(self, other: Self) -> Self {
        Self {
            left: self.left.max(other.left),
            top: self.top.max(other.top),
            right: self.right.min(other.right),
            bottom: self.bottom.min(other.bottom),
        }
    }

    /// Intersects the box with a tile, relative to the tile's first pixel. `None` if that is empty.
    pub(crate) fn in_tile(self, tile: Self) -> Option<Self> {
        let area = self.intersection(tile);
        (!area.is_empty()).then_some(Self {
            left: area.left - tile.left,
            top: area.top - tile.top,
            right: area.right - tile.left,
            bottom: area.bottom - tile.top,
        })
    }

    /// Returns the number of columns, if the box is not empty.
    #[must_use]
    pub const fn width(self) -> i32 {
        self.right - self.left
    }

    /// Returns the number of rows, if the box is not empty.
    #[must_use]
    pub const fn height(self) -> i32 {
        self.bottom - self.top
    }

    /// Returns whether the box holds no pixel.
    #[must_use]
    pub const fn is_empty(self) -> bool {
        self.left >= self.right || self.top >= self.bottom
    }
}

/// An edge function: the line from one corner to the next, 0 or positive inside.
///
///   e(x, y) = a x + b y + c,   a = p.y - q.y,   b = q.x - p.x,   c = p.x q.y - p.y q.x
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Edge {
    a: i64,
    b: i64,
    c: i64,
}

impl Edge {
    #[inline(always)]
    fn new(p: Snapped, q: Snapped) -> Self {
        // Products of two coordinates need 64 bits.
        let (px, py) = (i64::from(p.x), i64::from(p.y));
        let (qx, qy) = (i64::from(q.x), i64::from(q.y));
        Self { a: py - qy, b: qx - px, c: px * qy - py * qx }
    }

    /// Returns the bias of the top-left rule: 0 if a centre on the edge is covered, else -1.
    /// Centres on a top edge (level, with the triangle below) and on a left edge (going up) are
    /// covered. Since e is an integer, a bias of -1 moves no other centre across.
    #[inline(always)]
    fn bias(self) -> i64 {
        if self.a > 0 || (self.a == 0 && self.b > 0) { 0 } else { -1 }
    }

    #[inline(always)]
    fn at(self, x: i64, y: i64) -> i64 {
        self.a * x + self.b * y + self.c
    }
}

/// A triangle with area, set up to decide which pixels it covers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Triangle {
    /// The edge functions. `edges[i]` is opposite to corner i; its value at a point is twice the
    /// area of the triangle between the edge and the point.
    edges: [Edge; 3],
    doubled_area: i64,
    bounds: PixelBox,
    grid: Grid,
}

/// A covered pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Covered {
    /// The column.
    pub x: i32,
    /// The row.
    pub y: i32,
    /// The edge functions at the pixel's centre. Divided by [`Triangle::doubled_area`] they are the
    /// barycentric coordinates, in the order of the given corners.
    pub edges: [i64; 3],
}

impl Triangle {
    /// Sets up a triangle of either winding. Returns `None` if it has no area.
    #[must_use]
    #[inline(always)]
    pub fn new(corners: [Snapped; 3]) -> Option<Self> {
        Self::on(Grid::Usual, corners)
    }

    /// Sets up a triangle with corners on this grid.
    #[must_use]
    #[inline(always)]
    pub fn on(grid: Grid, [p, q, r]: [Snapped; 3]) -> Option<Self> {
        let doubled_area = doubled_area([p, q, r]);
        if doubled_area == 0 {
            return None;
        }
        // Clockwise on the screen (y down) is positive. The other winding gets reversed edges.
        let edges = if doubled_area > 0 {
            [Edge::new(q, r), Edge::new(r, p), Edge::new(p, q)]
        } else {
            [Edge::new(r, q), Edge::new(p, r), Edge::new(q, p)]
        };
        let bounds = PixelBox::reached_on(grid, [p, q, r], [[0; 2]; 2]);
        Some(Self { edges, doubled_area: doubled_area.abs(), bounds, grid })
    }

    /// Returns twice the area, in squared grid steps: more than 0.
    #[must_use]
    pub const fn doubled_area(&self) -> i64 {
        self.doubled_area
    }

    /// Returns the box of pixels with a centre in the triangle's bounding box.
    #[must_use]
    pub const fn bounds(&self) -> PixelBox {
        self.bounds
    }

    /// Evaluates the edge functions at the centre of a pixel, in the order of their opposite
    /// corners.
    #[must_use]
    #[inline(always)]
    pub fn edges_at(&self, x: i32, y: i32) -> [i64; 3] {
        let (cx, cy) = (self.centre(x), self.centre(y));
        each(self.edges, |edge| edge.at(cx, cy))
    }

    /// Returns the steps of the edge functions for one pixel to the right and one pixel down.
    #[inline(always)]
    #[must_use]
    pub fn steps(&self) -> [[i64; 3]; 2] {
        let step = i64::from(self.grid.parts());
        let [p, q, r] = self.edges;
        [[p.a * step, q.a * step, r.a * step], [p.b * step, q.b * step, r.b * step]]
    }

    /// Returns the smallest values of the edge functions at covered centres.
    #[inline(always)]
    #[must_use]
    pub fn least(&self) -> [i64; 3] {
        let [p, q, r] = self.edges;
        [-p.bias(), -q.bias(), -r.bias()]
    }

    /// Returns the centre of column or row `i`, in grid steps.
    #[inline(always)]
    fn centre(&self, i: i32) -> i64 {
        let parts = i64::from(self.grid.parts());
        i64::from(i) * parts + parts / 2
    }

    /// Calls `cover` for every pixel of `clip` that the triangle covers, row by row.
    #[inline(always)]
    pub fn covered(&self, clip: PixelBox, mut cover: impl FnMut(Covered)) {
        let area = self.bounds.intersection(clip);
        let step = i64::from(self.grid.parts());
        for y in area.top..area.bottom {
            // Edge functions are linear: one evaluation per row, then one addition per pixel.
            let mut edges = self.edges_at(area.left, y);
            for x in area.left..area.right {
                let inside = |i: usize| edges[i] + self.edges[i].bias() >= 0;
                if inside(0) && inside(1) && inside(2) {
                    cover(Covered { x, y, edges });
                }
                for (value, edge) in edges.iter_mut().zip(self.edges) {
                    *value += edge.a * step;
                }
            }
        }
    }
}

/// Returns twice the signed area: positive if the corners run clockwise on the screen, negative if
/// counter-clockwise.
#[must_use]
#[inline(always)]
pub fn doubled_area([p, q, r]: [Snapped; 3]) -> i64 {
    let (px, py) = (i64::from(p.x), i64::from(p.y));
    let (qx, qy) = (i64::from(q.x), i64::from(q.y));
    let (rx, ry) = (i64::from(r.x), i64::from(r.y));
    (qx - px) * (ry - py) - (qy - py) * (rx - px)
}

/// The limits of 32-bit edge functions: the largest doubled area, in square subpixels, at which
/// edge functions fit 31 bits at every pixel of the triangle, and the longest side at which
/// products fit.
pub(crate) const NARROW_AREA: f32 = (1 << 30) as f32;
pub(crate) const NARROW_SIDE: i32 = 1 << 20;

#[cfg(test)]
mod tests {
    use super::*;
    use marraztu_core::base::rng::Rng;

    const EVERYWHERE: PixelBox = PixelBox { left: -50, top: -50, right: 50, bottom: 50 };

    #[test]
    fn barycentric_coordinates_belong_to_the_corners_as_given() {
        for corners in [[(0, 0), (4, 0), (0, 4)], [(0, 0), (0, 4), (4, 0)]] {
            let snapped = corners.map(|(x, y)| Snapped { x: x * SUBPIXELS, y: y * SUBPIXELS });
            let triangle = Triangle::new(snapped).unwrap();
            triangle.covered(EVERYWHERE, |pixel| {
                let sum: i64 = pixel.edges.iter().sum();
                assert_eq!(sum, triangle.doubled_area());
                let weighted = |pick: fn(&Snapped) -> i32| -> i64 {
                    (0..3).map(|i| i64::from(pick(&snapped[i])) * pixel.edges[i]).sum()
                };
                assert_eq!(weighted(|p| p.x) / sum, triangle.centre(pixel.x));
                assert_eq!(weighted(|p| p.y) / sum, triangle.centre(pixel.y));
            });
        }
    }

    #[test]
    fn a_square_of_two_triangles_from_centre_to_centre_covers_its_upper_left_pixels() {
        let at = |x: i32, y: i32| Snapped { x: x * SUBPIXELS + 128, y: y * SUBPIXELS + 128 };
        let mut hits = Vec::new();
        for corners in [[at(0, 0), at(2, 0), at(2, 2)], [at(0, 0), at(2, 2), at(0, 2)]] {
            Triangle::new(corners).unwrap().covered(EVERYWHERE, |p| hits.push((p.y, p.x)));
        }
        hits.sort_unstable();
        assert_eq!(hits, [(0, 0), (0, 1), (1, 0), (1, 1)]);
    }

    /// Half of the points lie on centres or borders of pixels, where only the rule decides.
    #[test]
    fn a_closed_fan_covers_every_pixel_of_its_square_once() {
        const SIDE: i32 = 12;
        let mut rng = Rng::new(1);
        let square = PixelBox { left: 0, top: 0, right: SIDE, bottom: SIDE };
        let mut place = move || {
            let at = rng.between(0, SIDE * SUBPIXELS);
            if rng.one_in(2) { at } else { at / 128 * 128 }
        };
        for _ in 0..5000 {
            let centre = Snapped { x: place(), y: place() };
            let far = SIDE * SUBPIXELS;
            // The corners of the square, and a point on each of its sides.
            let (a, b, c, d) = (place(), place(), place(), place());
            let outline =
                [(0, 0), (a, 0), (far, 0), (far, b), (far, far), (c, far), (0, far), (0, d)]
                    .map(|(x, y)| Snapped { x, y });
            let mut counts = [0; (SIDE * SIDE) as usize];
            for i in 0..outline.len() {
                let corners = [centre, outline[i], outline[(i + 1) % outline.len()]];
                let Some(triangle) = Triangle::new(corners) else { continue };
                triangle.covered(square, |pixel| counts[(pixel.y * SIDE + pixel.x) as usize] += 1);
            }
            assert!(counts.iter().all(|count| *count == 1), "{centre:?} {outline:?}");
        }
    }
}
