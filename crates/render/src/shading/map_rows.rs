//! The working memory for the maps of a surface in addition to its texture.

use super::context::Group;
use super::interpolate::{CornerValues, Points};
use super::interpolated::ShadingNumber;
use super::map_texels::{TexelSource, TexturePlacement};
use super::texels::Texels;
use crate::lights::Rows;
use crate::simd::gather::SLOTS;
use crate::simd::{BATCH, Number};

/// Working memory for additional maps, allocated when a surface first has one.
#[derive(Debug)]
pub(crate) struct MapRows<T> {
    /// The light added to the colour of each pixel.
    pub(super) glow: Rows<T>,
    /// What the surface shows of its surroundings, which is part of the glow.
    pub(super) seen: Rows<T>,
    /// The normals without bumps, if the surface sends out rays.
    pub(super) unbent: Rows<T>,
    /// The texels of the current map.
    pub(super) texels: Rows<T>,
    /// The placement of each map.
    placements: [TexturePlacement; Map::COUNT],
    /// The tangents of the triangles, if they have bump maps.
    pub(super) tangents: TangentRows<T>,
}

/// The maps of a surface in addition to its texture.
#[derive(Clone, Copy, Debug)]
pub(super) enum Map {
    Emission,
    Ambient,
    Specular,
    Exponent,
    Bump,
    /// The map of Ks, for mirrors.
    Mirror,
}

impl Map {
    const COUNT: usize = 6;
}

impl<T: ShadingNumber> Default for MapRows<T> {
    fn default() -> Self {
        let rows = [[T::default(); BATCH]; 3];
        Self {
            glow: rows,
            seen: rows,
            unbent: rows,
            texels: rows,
            placements: Default::default(),
            tangents: TangentRows::default(),
        }
    }
}

impl<T: ShadingNumber> MapRows<T> {
    /// Reads a map into the rows of texels, which start as `base`.
    pub(super) fn read(
        &mut self,
        group: &Group<'_, T>,
        points: Points<'_, T>,
        (map, source, what): (Map, TexelSource<'_>, Texels),
        base: [f64; 3],
    ) {
        let Self { texels, placements, .. } = self;
        for (row, base) in texels.iter_mut().zip(base) {
            row.fill(T::from_f64(base));
        }
        let placement = &mut placements[map as usize];
        points.read(group, (source, what), placement, (base, texels));
    }
}

/// The tangents of some triangles, slot by slot.
#[derive(Debug)]
pub(super) struct TangentRows<T> {
    /// At vertices: T of the first corner, and the differences of the others from it. At pixels:
    /// the vectors that give T and B in a cross product with N; the third is unused.
    pub(super) vectors: CornerValues<T>,
    /// At vertices: the sign s.
    pub(super) signs: [T; SLOTS],
}

impl<T: Number> Default for TangentRows<T> {
    fn default() -> Self {
        let row = [T::default(); SLOTS];
        Self { vectors: [[row; 3]; 3], signs: row }
    }
}
