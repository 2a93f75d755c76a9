//! Places on a texture to be sampled.

use fearless_simd::{Simd, f32x16};

use super::mip_level::ManyAround;
use crate::simd::{BATCH, Lanes as _, Sixteen};

/// Places on a texture to be sampled.
#[derive(Debug)]
pub(crate) struct TexelPlaces {
    /// The positions, in texels of the first level.
    pub(crate) position: [[f32; BATCH]; 2],
    /// The squared number of texels that a pixel covers along its longer side, if the filter reads
    /// mipmaps.
    pub(crate) footprint: [f32; BATCH],
    /// The same along its shorter side, if the filter is anisotropic.
    pub(crate) shorter: [f32; BATCH],
    /// The longer side in texels, if the filter is anisotropic.
    pub(crate) longer: [[f32; BATCH]; 2],
    /// The number of samples along the longer side.
    pub(super) probes: [f32; BATCH],
    /// The finer level that trilinear filtering mixes, and the weight of the coarser one.
    pub(super) levels: [[f32; BATCH]; 2],
    /// The texels around the positions, on the finer and on the coarser level.
    pub(super) finer: ManyAround,
    pub(super) coarser: ManyAround,
}

impl Default for TexelPlaces {
    fn default() -> Self {
        let row = [0.0; BATCH];
        Self {
            position: [row; 2],
            footprint: row,
            shorter: row,
            longer: [row; 2],
            probes: row,
            levels: [row; 2],
            finer: ManyAround::default(),
            coarser: ManyAround::default(),
        }
    }
}

impl TexelPlaces {
    #[inline(always)]
    pub(super) fn at<S: Simd>(&self, lanes: Sixteen<S>, at: usize) -> [f32x16<S>; 2] {
        [lanes.load(&self.position[0], at), lanes.load(&self.position[1], at)]
    }
}
