//! The texture coordinates of some triangles, in texels, in the layout that SIMD lanes read.
//!
//! Coordinates of a repeating texture are moved by whole repetitions. This keeps the digits of f32
//! at any distance from 0.

use fearless_simd::{
    Simd, SimdBase as _, SimdFloat as _, SimdMask as _, SimdNarrow as _, SimdWiden as _, f32x16,
    f64x8,
};

use super::uv::Uvs;
use crate::simd::gather::SLOTS;
use marraztu_core::base::math::each;
use marraztu_core::scene::{Texture, Wrap};

/// The largest coordinate, in texels, at which f32 resolves 1/1024 texel.
const FARTHEST: f64 = 16_384.0;

/// The texel coordinates of a list of triangles, one per slot, along u and v.
#[derive(Debug)]
#[repr(align(64))]
pub(crate) struct Placement {
    /// The first corner's coordinates, in texels of the full-size texture.
    pub(crate) first: [[f32; SLOTS]; 2],
    /// The differences of the second and third corner from the first.
    pub(crate) second: [[f32; SLOTS]; 2],
    pub(crate) third: [[f32; SLOTS]; 2],
    /// The smallest and largest coordinate of the three corners.
    pub(crate) low: [[f32; SLOTS]; 2],
    pub(crate) high: [[f32; SLOTS]; 2],
    /// The steps of (u - first) / w, and of 1 / w, for one pixel to the right and one pixel down.
    pub(crate) steps: [[[f32; SLOTS]; 2]; 2],
    pub(crate) by_w_steps: [[f32; SLOTS]; 2],
    /// A bit per slot: set if the triangle has coordinates.
    pub(crate) known: u64,
}

impl Default for Placement {
    fn default() -> Self {
        let row = [0.0; SLOTS];
        Self {
            first: [row; 2],
            second: [row; 2],
            third: [row; 2],
            low: [row; 2],
            high: [row; 2],
            steps: [[row; 2]; 2],
            by_w_steps: [row; 2],
            known: 0,
        }
    }
}

/// The steps of a triangle's N0, N1 and N2 for one pixel to the right and one pixel down. Ni is
/// 1 / w of a pixel times the perspective-correct weight of corner i.
pub(crate) type Steps = [[f64; 3]; 2];

impl Placement {
    /// Removes all triangles.
    pub(crate) const fn clear(&mut self) {
        self.known = 0;
    }

    /// Sets the coordinates of a triangle's corners, in texels along u and v. `steps` are only
    /// needed for mipmaps.
    #[inline(always)]
    #[expect(clippy::cast_possible_truncation, reason = "the nearest f32 is meant")]
    pub(crate) fn set(&mut self, slot: usize, texels: [[f64; 3]; 2], steps: Option<Steps>) {
        for (axis, [a, b, c]) in texels.into_iter().enumerate() {
            // Differences are computed in f64 and only then rounded.
            self.first[axis][slot] = a as f32;
            self.second[axis][slot] = (b - a) as f32;
            self.third[axis][slot] = (c - a) as f32;
            self.low[axis][slot] = a.min(b).min(c) as f32;
            self.high[axis][slot] = a.max(b).max(c) as f32;
        }
        for (way, step) in steps.into_iter().flatten().enumerate() {
            for (axis, [a, b, c]) in texels.into_iter().enumerate() {
                // (u - first) / w is (b - a) N1 + (c - a) N2, so its step is linear in their steps.
                let step = (b - a) * step[1] + (c - a) * step[2];
                self.steps[way][axis][slot] = step as f32;
            }
            // N0 + N1 + N2 is 1 / w.
            self.by_w_steps[way][slot] = (step[0] + step[1] + step[2]) as f32;
        }
        self.known |= 1 << slot;
    }
}

/// Texture coordinates of the corners of a list of triangles: u and v of each corner.
pub(crate) type UvRows = [[[f32; SLOTS]; 2]; 3];

/// Sixteen f64 numbers.
pub(crate) type Doubles<S> = [f64x8<S>; 2];

/// [`Steps`] of sixteen triangles.
pub(crate) type LaneSteps<S> = [[Doubles<S>; 3]; 2];

impl Placement {
    /// Sets the coordinates of sixteen triangles, starting at slot `at`, like [`Self::set`].
    /// Returns a bit mask of the triangles for which f32 is accurate enough; the coordinates of the
    /// others are meaningless.
    #[inline(always)]
    pub(crate) fn set_sixteen<S: Simd>(
        &mut self,
        simd: S,
        (uvs, at): (&UvRows, usize),
        texture: &Texture,
        steps: Option<LaneSteps<S>>,
    ) -> u64 {
        let mut fits = u64::MAX;
        let mut ways = [[[f64x8::splat(simd, 0.0); 2]; 2]; 2];
        for axis in 0..2 {
            // One axis at a time: corners in f64, differences and bounds narrowed to f32.
            let own = [&uvs[0][axis], &uvs[1][axis], &uvs[2][axis]];
            let [a, b, c] = lanes_along(simd, own, at, (texture, axis));
            fits &= all_near(a) & all_near(b) & all_near(c);
            let (second, third) = (less(b, a), less(c, a));
            let low = [a[0].min(b[0]).min(c[0]), a[1].min(b[1]).min(c[1])];
            let high = [a[0].max(b[0]).max(c[0]), a[1].max(b[1]).max(c[1])];
            let rows = [&mut self.first, &mut self.second, &mut self.third];
            for (rows, [x, y]) in rows.into_iter().zip([a, second, third]) {
                x.narrow(y).store_slice(&mut rows[axis][at..at + 16]);
            }
            for (rows, [x, y]) in [&mut self.low, &mut self.high].into_iter().zip([low, high]) {
                x.narrow(y).store_slice(&mut rows[axis][at..at + 16]);
            }
            ways[axis] = [second, third];
        }
        // Gradients for mipmaps: the corner differences times the steps of the weights.
        if let Some(steps) = steps {
            for (which, [first, second, third]) in steps.into_iter().enumerate() {
                for (axis, [to_second, to_third]) in ways.into_iter().enumerate() {
                    let x = to_second[0] * second[0] + to_third[0] * third[0];
                    let y = to_second[1] * second[1] + to_third[1] * third[1];
                    x.narrow(y).store_slice(&mut self.steps[which][axis][at..at + 16]);
                }
                let (x, y) = (first[0] + second[0] + third[0], first[1] + second[1] + third[1]);
                x.narrow(y).store_slice(&mut self.by_w_steps[which][at..at + 16]);
            }
        }
        fits & 0xffff
    }
}

/// Subtracts sixteen numbers.
#[inline(always)]
pub(crate) fn less<S: Simd>(a: Doubles<S>, b: Doubles<S>) -> Doubles<S> {
    [a[0] - b[0], a[1] - b[1]]
}

/// Returns a bit mask of the coordinates, of sixteen, for which f32 is accurate enough.
#[inline(always)]
fn all_near<S: Simd>([x, y]: Doubles<S>) -> u64 {
    let (x, y) = (x.abs().simd_le(FARTHEST), y.abs().simd_le(FARTHEST));
    x.to_bitmask() | y.to_bitmask() << 8
}

/// Computes the texel coordinates of sixteen triangles' corners along an axis, like [`along`].
#[inline(always)]
#[expect(clippy::cast_precision_loss, reason = "pictures have fewer than 2^53 pixels a side")]
fn lanes_along<S: Simd>(
    simd: S,
    rows: [&[f32; SLOTS]; 3],
    at: usize,
    (texture, axis): (&Texture, usize),
) -> [Doubles<S>; 3] {
    let size = texture.picture.size();
    let side = [size.width, size.height][axis] as f64;
    let (scale, offset) = (texture.scale[axis], texture.offset[axis]);
    let mut own = [[f64x8::splat(simd, 0.0); 2]; 3];
    for (own, row) in own.iter_mut().zip(rows) {
        let (low, high) = f32x16::from_slice(simd, &row[at..at + 16]).widen();
        *own = [low * scale + offset, high * scale + offset];
    }
    let [a, b, c] = own;
    // Whole repetitions are removed here, as in `along`.
    for half in 0..2 {
        let repetitions = match texture.wrap {
            Wrap::Repeat => a[half].min(b[half]).min(c[half]).floor(),
            Wrap::Clamp => f64x8::splat(simd, 0.0),
        };
        for own in &mut own {
            own[half] = (own[half] - repetitions) * side;
        }
    }
    own
}

/// Computes the texel coordinates of a triangle's corners along u and v.
#[inline(always)]
pub(crate) fn texels(uvs: Uvs, texture: &Texture) -> [[f64; 3]; 2] {
    [along(uvs, texture, 0), along(uvs, texture, 1)]
}

/// Returns whether f32 resolves texels at these coordinates.
#[inline(always)]
pub(crate) fn fits_f32(texels: &[[f64; 3]; 2]) -> bool {
    let [[a, b, c], [d, e, f]] = texels.map(|along| each(along, f64::abs));
    let near = |x: f64| x <= FARTHEST;
    near(a) && near(b) && near(c) && near(d) && near(e) && near(f)
}

#[inline(always)]
#[expect(clippy::cast_precision_loss, reason = "pictures have fewer than 2^53 pixels a side")]
fn along(uvs: Uvs, texture: &Texture, axis: usize) -> [f64; 3] {
    let size = texture.picture.size();
    let side = [size.width, size.height][axis] as f64;
    let own = each(uvs, |uv| uv[axis] * texture.scale[axis] + texture.offset[axis]);
    let least = own[0].min(own[1]).min(own[2]);
    // All corners move by the same repetitions, so the triangle keeps its extent.
    let repetitions = match texture.wrap {
        Wrap::Repeat => least.floor(),
        Wrap::Clamp => 0.0,
    };
    each(own, |own| (own - repetitions) * side)
}
