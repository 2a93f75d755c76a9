//! Working memory for the further maps of surfaces, and for surfaces with light of their own.

use super::context::ShadingContext;
use super::groups::Group;
use super::interpolated::ShadingNumber;
use super::map_texels::{Points, TexelSource, Texels, TexturePlacement};
use crate::lights::Rows;
use crate::simd::gather::SLOTS;
use crate::simd::{BATCH, Number};

/// Working memory for the further maps of surfaces; allocated when a surface first has one.
#[derive(Debug)]
pub(crate) struct MapRows<T> {
    /// What is added to the colour of each pixel.
    pub(super) glow: Rows<T>,
    /// The texels of the map that is read.
    pub(super) texels: Rows<T>,
    /// Where each map lies.
    placements: [TexturePlacement; Map::COUNT],
    /// The tangents of the triangles, if they have bumps.
    pub(super) tangents: TangentRows<T>,
}

/// The maps of a surface beside its texture.
#[derive(Clone, Copy, Debug)]
pub(super) enum Map {
    Emission,
    Ambient,
    Specular,
    Exponent,
    Bump,
}

impl Map {
    const COUNT: usize = 5;
}

impl<T: ShadingNumber> Default for MapRows<T> {
    fn default() -> Self {
        let rows = [[T::default(); BATCH]; 3];
        Self {
            glow: rows,
            texels: rows,
            placements: Default::default(),
            tangents: TangentRows::default(),
        }
    }
}

impl<T: ShadingNumber> MapRows<T> {
    /// Reads a map into the rows for texels, which are all `base` at first.
    pub(super) fn read(
        &mut self,
        context: &ShadingContext<'_, T>,
        group: &Group<'_>,
        points: &Points<'_, T>,
        (map, source, what, new): (Map, TexelSource<'_>, Texels, bool),
        base: [f64; 3],
    ) {
        let Self { texels, placements, .. } = self;
        for (row, base) in texels.iter_mut().zip(base) {
            row.fill(T::from_f64(base));
        }
        let placement = &mut placements[map as usize];
        points.read(context, group, (source, what, new), placement, (base, texels));
    }
}

/// The tangents of some triangles, slot by slot.
#[derive(Debug)]
pub(super) struct TangentRows<T> {
    /// At vertices: T of the first corner, and the differences of the others from it. At pixels:
    /// the vectors whose products with N are T and B, and nothing.
    pub(super) vectors: [[[T; SLOTS]; 3]; 3],
    /// At vertices: s.
    pub(super) signs: [T; SLOTS],
}

impl<T: Number> Default for TangentRows<T> {
    fn default() -> Self {
        let row = [T::default(); SLOTS];
        Self { vectors: [[row; 3]; 3], signs: row }
    }
}
