//! The coordinates of some triangles on their texture, in texels, as lanes read them.
//!
//! Coordinates of a texture that repeats are moved by whole repetitions, so that f32 keeps their
//! digits however far from 0 they are.

use super::uv::Uvs;
use crate::base::math::each;
use crate::render::simd::gather::SLOTS;
use crate::scene::{Texture, Wrap};

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
