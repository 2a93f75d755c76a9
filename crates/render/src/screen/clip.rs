//! Transforms vertices from object space to the screen: model-view-projection, clipping, projection
//! and snapping.
//!
//! The matrix is composed and applied in f64. Clipping is done in homogeneous space, before any
//! division, against the near and far planes and a guard band of 2^20 pixels to each side. The
//! clipped polygon is projected and snapped to 1/256 pixel.
//!
//! Clipping: Blinn and Newell, "Clipping Using Homogeneous Coordinates", SIGGRAPH 1978; Sutherland
//! and Hodgman, "Reentrant Polygon Clipping", CACM 1974. A cut is computed from the inner end of
//! its edge. Two triangles that share the edge therefore get the same bits.

use glam::{DMat4, DVec3};

use super::coverage::{Grid, SUBPIXELS, Snapped};
use crate::frame::Viewport;

/// The guard band: the largest coordinate of a vertex that needs no clipping, in pixels.
const GUARD: f64 = 1_048_576.0;

/// The rounding constant: a number below 2^51 plus this has its nearest integer in the lowest bits.
const ROUND: f64 = 6_755_399_441_055_744.0;

/// A vertex on the screen.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C, align(16))]
pub(crate) struct ScreenVertex {
    x: i32,
    y: i32,
    /// 1 at the near plane, 0 at the far one.
    pub(crate) depth: f32,
    /// 1/w of clip space.
    pub(crate) inverse_w: f32,
}

impl ScreenVertex {
    /// A marker in place of x: the vertex is beyond the near plane, the far plane or the guard
    /// band.
    pub(crate) const BEYOND: i32 = i32::MIN;

    /// Returns the vertex as stored in memory: x, y, and the bits of the depth and of 1/w.
    #[inline(always)]
    pub(crate) const fn row(&self) -> [i32; 4] {
        let (depth, inverse_w) = (self.depth.to_bits(), self.inverse_w.to_bits());
        [self.x, self.y, depth.cast_signed(), inverse_w.cast_signed()]
    }

    /// Returns whether the vertex is inside the clipping planes. If not, its position is
    /// meaningless.
    #[inline(always)]
    pub(crate) const fn is_inside(&self) -> bool {
        self.x != Self::BEYOND
    }

    /// Creates a vertex at a position.
    pub(crate) const fn placed(at: Snapped, depth: f32, inverse_w: f32) -> Self {
        Self { x: at.x, y: at.y, depth, inverse_w }
    }

    /// Creates a vertex at a position, for tests.
    #[cfg(test)]
    pub(crate) const fn new(at: Snapped, depth: f32) -> Self {
        Self { x: at.x, y: at.y, depth, inverse_w: 1.0 }
    }

    /// Returns the vertex relative to a sample with this offset in subpixels. The vertex must be
    /// [inside](Self::is_inside).
    #[inline(always)]
    pub(crate) const fn seen_from(self, [x, y]: [i32; 2]) -> Self {
        Self { x: self.x - x, y: self.y - y, ..self }
    }

    /// Returns the vertex's position in the picture.
    #[inline(always)]
    pub(crate) const fn at(&self) -> Snapped {
        Snapped { x: self.x, y: self.y }
    }
}

/// A position in clip space: x, y, z, w.
pub(crate) type Clip = [f64; 4];

/// The transform from object space to the screen, with the clipping planes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Screen {
    /// The rows of `clip_from_object`.
    pub(crate) rows: [[f64; 4]; 4],
    /// Half of the picture's width and height.
    pub(crate) half: [f64; 2],
    /// The guard band's half width and half height as factors of w.
    pub(crate) guard: [f64; 2],
    /// The sample's offset in subpixels, subtracted from clipped corners after snapping.
    shift: [i32; 2],
    /// The number of grid steps per pixel.
    pub(crate) parts: f64,
}

/// The guard band of the fine grid, in pixels: edge functions stay below 2^62.
const FINE_GUARD: f64 = 131_072.0;

/// Rounds a number below 2^31 to the nearest integer, ties to even. The result is in the lowest
/// bits of the sum with [`ROUND`]. Unlike a conversion, this compiles to SIMD code.
#[inline(always)]
#[expect(clippy::cast_possible_truncation, reason = "the lowest bits are the integer")]
pub(crate) fn snapped(number: f64) -> i32 {
    ((number + ROUND).to_bits() as u32).cast_signed()
}

impl Screen {
    pub(crate) fn new(clip_from_object: DMat4, viewport: impl Into<Viewport>) -> Self {
        let Viewport { width, height } = viewport.into();
        let half = [width / 2.0, height / 2.0];
        Self {
            rows: clip_from_object.transpose().to_cols_array_2d(),
            half,
            // (x / w + 1) half stays within GUARD, so a coordinate stays within 2^28 subpixels.
            guard: half.map(|half| GUARD / half - 1.0),
            shift: [0; 2],
            parts: f64::from(SUBPIXELS),
        }
    }

    /// Returns the same transform with corners snapped to this grid.
    pub(crate) fn on(self, grid: Grid) -> Self {
        match grid {
            Grid::Usual => self,
            Grid::Fine => {
                let guard = self.half.map(|half| FINE_GUARD / half - 1.0);
                Self { parts: f64::from(grid.parts()), guard, ..self }
            }
        }
    }

    /// Returns the same transform for a sample with this offset in subpixels.
    pub(crate) const fn seen_from(self, shift: [i32; 2]) -> Self {
        Self { shift, ..self }
    }

    /// Returns the sample's offset, in pixels.
    pub(crate) fn shift_in_pixels(&self) -> [f64; 2] {
        self.shift.map(|by| f64::from(by) / self.parts)
    }

    /// Returns the transform to a part of the picture that is centred at `middle` and reaches
    /// `half` to each side, both in pixels; the guard band ends there. Only distances to the planes
    /// are meaningful.
    pub(crate) fn close_to(self, middle: [f64; 2], half: [f64; 2]) -> Self {
        // From -1 to 1, with y up.
        let x = middle[0] / self.half[0] - 1.0;
        let y = 1.0 - middle[1] / self.half[1];
        let [of_x, of_y, z, w] = self.rows;
        // After division by w, subtracting a multiple of w moves the middle to 0.
        let less = |row: [f64; 4], by: f64| std::array::from_fn(|i| row[i] - by * w[i]);
        let rows = [less(of_x, x), less(of_y, y), z, w];
        Self { rows, guard: [half[0] / self.half[0], half[1] / self.half[1]], ..self }
    }

    /// Transforms a position from object space to clip space.
    #[inline(always)]
    pub(crate) fn clip(&self, [x, y, z]: [f64; 3]) -> Clip {
        let row = |i: usize| {
            let [a, b, c, d] = self.rows[i];
            a * x + b * y + c * z + d
        };
        [row(0), row(1), row(2), row(3)]
    }

    /// Returns the signed distances to the near plane, the far plane and the four sides of the
    /// guard band. Distances are 0 or positive inside.
    #[inline(always)]
    pub(crate) fn distances(&self, [x, y, z, w]: Clip) -> [f64; 6] {
        let [gx, gy] = self.guard;
        [w - z, z, gx * w + x, gx * w - x, gy * w + y, gy * w - y]
    }

    /// Returns the largest change of each distance per unit of length in object space.
    pub(crate) fn slopes(&self) -> [f64; 6] {
        // Distances are linear in the position, so the columns of the matrix give the gradient.
        let along = |axis: usize| self.distances(self.rows.map(|row| row[axis]));
        let [x, y, z] = [along(0), along(1), along(2)];
        std::array::from_fn(|i| DVec3::new(x[i], y[i], z[i]).length())
    }

    /// Returns whether a position is inside the clipping planes by more than rounding errors.
    pub(crate) fn holds(&self, clip: Clip) -> bool {
        // Rounding errors grow with the coordinates, so the margin does, too.
        let least = 1e-9 * clip.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        self.distances(clip).iter().all(|distance| *distance > least)
    }

    /// Projects and snaps a position, or marks it as [beyond](ScreenVertex::BEYOND) the planes.
    #[inline(always)]
    pub(crate) fn vertex(&self, clip: Clip) -> ScreenVertex {
        let [a, b, c, d, e, f] = self.distances(clip);
        // `&` instead of `&&`: six comparisons without a branch compile to SIMD code.
        let inside = (a >= 0.0) & (b >= 0.0) & (c >= 0.0) & (d >= 0.0) & (e >= 0.0) & (f >= 0.0);
        let vertex = self.project(clip);
        ScreenVertex { x: if inside { vertex.x } else { ScreenVertex::BEYOND }, ..vertex }
    }

    /// Projects and snaps a position that is inside the planes, up to rounding.
    #[inline(always)]
    #[expect(clippy::cast_possible_truncation, reason = "the nearest f32 is meant")]
    fn project(&self, [x, y, z, w]: Clip) -> ScreenVertex {
        let inverse_w = 1.0 / w;
        let snap = |pixels: f64| snapped(pixels * self.parts);
        let depth = z * inverse_w;
        // Rounding can leave a depth just outside 0 to 1. Comparisons also turn NaN into 0.
        let depth = if depth > 0.0 { depth } else { 0.0 };
        let depth = if depth < 1.0 { depth } else { 1.0 };
        ScreenVertex {
            x: snap((x * inverse_w + 1.0) * self.half[0]),
            y: snap((1.0 - y * inverse_w) * self.half[1]),
            depth: depth as f32,
            inverse_w: inverse_w as f32,
        }
    }

    /// Projects a position that is inside the planes to pixels, without snapping.
    #[inline(always)]
    pub(crate) fn pixels(&self, [x, y, _, w]: Clip) -> [f64; 2] {
        let inverse_w = 1.0 / w;
        [(x * inverse_w + 1.0) * self.half[0], (1.0 - y * inverse_w) * self.half[1]]
    }

    /// Projects a position to pixels relative to the sample, in f32.
    #[inline(always)]
    #[expect(clippy::cast_possible_truncation, reason = "the nearest f32 is meant")]
    pub(crate) fn pixels_seen(&self, clip: Clip) -> [f32; 2] {
        let [x, y] = self.pixels(clip);
        let [dx, dy] = self.shift_in_pixels();
        [(x - dx) as f32, (y - dy) as f32]
    }

    /// Projects a corner of a clipped triangle.
    pub(crate) fn piece(&self, corner: Clip) -> ScreenVertex {
        self.project(corner).seen_from(self.shift)
    }

    /// Clips a triangle and returns the corners of the remaining convex polygon.
    pub(crate) fn cut(&self, corners: [Clip; 3]) -> Vec<Clip> {
        if !corners.as_flattened().iter().all(|x| x.is_finite()) {
            return Vec::new();
        }
        // Most of the triangles that are not inside all planes are outside one, and need no memory.
        let distances = corners.map(|corner| self.distances(corner));
        if (0..6).any(|plane| distances.iter().all(|of| of[plane] < 0.0)) {
            return Vec::new();
        }
        let mut polygon = corners.to_vec();
        // Sutherland and Hodgman: each plane cuts the polygon that the planes before it left.
        for plane in 0..6 {
            let inner = |corner: &Clip| self.distances(*corner)[plane];
            let mut kept = Vec::with_capacity(polygon.len() + 1);
            for (i, to) in polygon.iter().enumerate() {
                let from = &polygon[(i + polygon.len() - 1) % polygon.len()];
                // A crossing is always computed from the inner end, so neighbours get the same
                // corner.
                let (df, dt) = (inner(from), inner(to));
                match (df >= 0.0, dt >= 0.0) {
                    (true, true) => kept.push(*to),
                    (true, false) => kept.push(between(from, to, df / (df - dt))),
                    (false, true) => kept.extend([between(to, from, dt / (dt - df)), *to]),
                    (false, false) => {}
                }
            }
            polygon = kept;
        }
        polygon
    }

    /// Clips a line between two positions of clip space.
    #[inline(always)]
    pub(crate) fn segment(&self, ends: [Clip; 2]) -> Option<[ScreenVertex; 2]> {
        let [mut a, mut b] = ends;
        if !ends.as_flattened().iter().all(|x| x.is_finite()) {
            return None;
        }
        // Each plane moves the end that lies outside; two ends outside leave no line.
        for plane in 0..6 {
            let inner = |end: Clip| self.distances(end)[plane];
            let (da, db) = (inner(a), inner(b));
            match (da >= 0.0, db >= 0.0) {
                (true, true) => {}
                (true, false) => b = between(&a, &b, da / (da - db)),
                (false, true) => a = between(&b, &a, db / (db - da)),
                (false, false) => return None,
            }
        }
        Some([a, b].map(|end| self.project(end).seen_from(self.shift)))
    }
}

/// Interpolates between the inner and the outer end of an edge.
fn between(inner: &Clip, outer: &Clip, t: f64) -> Clip {
    std::array::from_fn(|i| inner[i] + (outer[i] - inner[i]) * t)
}

/// Returns whether the corners of a triangle in clip space run counter-clockwise for the observer.
pub(crate) fn faces_observer(corners: [Clip; 3]) -> bool {
    // Without division, the sign of the triple product also holds for corners behind the eye.
    let [p, q, r] = corners.map(|[x, y, _, w]| DVec3::new(x, y, w));
    p.dot(q.cross(r)) > 0.0
}
