//! The memory for drawing the triangles of a tile, which is reused.

use super::cutout_fragments::Fragments;
use crate::raster::alpha_test::AlphaSurface;
use crate::raster::covered::Covered;
use crate::raster::queue::Queue;

/// The data reused from one alpha-tested triangle of a tile to the next.
#[derive(Debug, Default)]
pub(super) struct Cutouts<'a> {
    pub(super) surface: Option<AlphaSurface<'a>>,
    pub(super) fragments: Fragments,
}

/// The means to draw the small triangles of a tile.
#[derive(Debug, Default)]
pub(super) struct SmallTriangles {
    pub(super) covered: Covered,
    /// The triangles left over from packs of fewer than sixteen.
    pub(super) rest: Queue,
}
