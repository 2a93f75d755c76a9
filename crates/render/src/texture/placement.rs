//! The coordinates of some triangles on their texture, in texels, as lanes read them.
//!
//! Coordinates of a texture that repeats are moved by whole repetitions, so that f32 keeps their
//! digits however far from 0 they are.

use fearless_simd::{
    Simd, SimdBase as _, SimdFloat as _, SimdMask as _, SimdNarrow as _, SimdWiden as _, f32x16,
    f64x8,
};

use super::uv::Uvs;
use crate::simd::gather::SLOTS;
use marraztu_core::base::math::each;
use marraztu_core::scene::{Texture, Wrap};

/// The largest coordinate in texels at which f32 tells 1/1024 texel apart.
const FARTHEST: f64 = 16_384.0;

/// The coordinates of the triangles of a list, slot by slot, along u and v.
#[derive(Debug)]
#[repr(align(64))]
pub(crate) struct Placement {
    /// Those of the first corner, in texels of the texture's own size.
    pub(crate) first: [[f32; SLOTS]; 2],
    /// The differences of the second and the third corner from it.
    pub(crate) second: [[f32; SLOTS]; 2],
    pub(crate) third: [[f32; SLOTS]; 2],
    /// The least and the largest of the three.
    pub(crate) low: [[f32; SLOTS]; 2],
    pub(crate) high: [[f32; SLOTS]; 2],
    /// The steps of (u - first) / w by a pixel to the right and by one down, and those of 1 / w.
    pub(crate) steps: [[[f32; SLOTS]; 2]; 2],
    pub(crate) by_w_steps: [[f32; SLOTS]; 2],
    /// Bit i: the triangle has coordinates.
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

/// The steps of a triangle's N0, N1 and N2 by a pixel to the right and by one down: Ni is 1 / w of
/// a pixel times its perspective-correct weight of corner i.
pub(crate) type Steps = [[f64; 3]; 2];

impl Placement {
    /// Forgets the triangles.
    pub(crate) const fn clear(&mut self) {
        self.known = 0;
    }

    /// Sets the coordinates of a triangle's corners in texels along u and v; `steps` are only
    /// needed for mip maps.
    #[inline(always)]
    #[expect(clippy::cast_possible_truncation, reason = "the nearest f32 is meant")]
    pub(crate) fn set(&mut self, slot: usize, texels: [[f64; 3]; 2], steps: Option<Steps>) {
        for (axis, [a, b, c]) in texels.into_iter().enumerate() {
            self.first[axis][slot] = a as f32;
            self.second[axis][slot] = (b - a) as f32;
            self.third[axis][slot] = (c - a) as f32;
            self.low[axis][slot] = a.min(b).min(c) as f32;
            self.high[axis][slot] = a.max(b).max(c) as f32;
        }
        for (way, step) in steps.into_iter().flatten().enumerate() {
            for (axis, [a, b, c]) in texels.into_iter().enumerate() {
                let step = (b - a) * step[1] + (c - a) * step[2];
                self.steps[way][axis][slot] = step as f32;
            }
            self.by_w_steps[way][slot] = (step[0] + step[1] + step[2]) as f32;
        }
        self.known |= 1 << slot;
    }
}

/// Texture coordinates of the corners of the triangles of a list: u and v of each corner.
pub(crate) type UvRows = [[[f32; SLOTS]; 2]; 3];

/// Sixteen numbers.
pub(crate) type Doubles<S> = [f64x8<S>; 2];

/// [`Steps`] of sixteen triangles.
pub(crate) type LaneSteps<S> = [[Doubles<S>; 3]; 2];

impl Placement {
    /// Sets the coordinates of sixteen triangles, from slot `at` on, as [`Self::set`] does. Returns
    /// a bit for each of them for which f32 is enough; those of the others are meaningless.
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

/// The differences of sixteen numbers.
#[inline(always)]
pub(crate) fn less<S: Simd>(a: Doubles<S>, b: Doubles<S>) -> Doubles<S> {
    [a[0] - b[0], a[1] - b[1]]
}

/// Which of sixteen coordinates f32 is enough for, a bit for each.
#[inline(always)]
fn all_near<S: Simd>([x, y]: Doubles<S>) -> u64 {
    let (x, y) = (x.abs().simd_le(FARTHEST), y.abs().simd_le(FARTHEST));
    x.to_bitmask() | y.to_bitmask() << 8
}

/// The coordinates of the corners of sixteen triangles in texels along an axis, as [`along`].
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

/// The coordinates of a triangle's corners in texels, along u and v.
#[inline(always)]
pub(crate) fn texels(uvs: Uvs, texture: &Texture) -> [[f64; 3]; 2] {
    [along(uvs, texture, 0), along(uvs, texture, 1)]
}

/// Whether f32 can tell texels apart between these coordinates.
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
    let repetitions = match texture.wrap {
        Wrap::Repeat => least.floor(),
        Wrap::Clamp => 0.0,
    };
    each(own, |own| (own - repetitions) * side)
}
