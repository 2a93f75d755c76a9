//! The working memory of a thread that shades, and the destinations of its colours.

use super::barycentrics::Barycentrics;
use super::blend::Blend;
use super::bounces::Bounces;
use super::colors::{Colors, Sums};
use super::fragments::Fragments;
use super::full_blocks::Canvas;
use super::interpolate::{CornerValues, Look};
use super::interpolated::ShadingNumber;
use super::map_rows::MapRows;
use super::map_texels::TexturePlacement;
use super::quantize::Thresholds;
use super::samples::Kept;
use super::tiny_triangles::{CornerRows, TinyTriangles};
use super::triangle_attributes::TriangleAttributes;
use crate::frame::program::PathPixels;
use crate::lights::{Batch, Rows};
use crate::plan::tile::TilePlan;
use crate::screen::tiles::BLOCK_PIXELS;
use crate::shadow::rays::{RayCount, RayScratch};
use crate::simd::BATCH;
use crate::simd::gather::SLOTS;

/// Shades blocks. Each thread has a separate one.
#[derive(Debug)]
pub(crate) struct Shader<T> {
    /// The lights of the current tile.
    pub(crate) tile: TilePlan,
    pub(crate) fragments: Fragments,
    pub(crate) attributes: TriangleAttributes<T>,
    pub(crate) barycentrics: Barycentrics<T>,
    pub(crate) batch: Batch<T>,
    /// The memory for shadow rays.
    pub(crate) rays: RayScratch,
    /// The pixels of each path since the frame began.
    pub(crate) path_pixels: PathPixels,
    /// The positions of the triangles on their texture.
    pub(super) placed: TexturePlacement,
    pub(crate) texels: Rows<T>,
    /// The vertex colours of the triangles.
    pub(super) vertex_colors: CornerValues<T>,
    /// The memory for additional maps and emission.
    pub(super) maps: Box<MapRows<T>>,
    /// The memory for mirrored and refracted rays, allocated when a surface first casts one.
    pub(crate) bounces: Option<Box<Bounces<T>>>,
    pub(super) colors: Colors,
    pub(super) thresholds: Thresholds<T>,
    /// The triangles of a list with one triangle per pixel.
    pub(super) tiny: TinyTriangles,
    /// The colours of their corners, with light at vertices.
    pub(super) corner_colors: Box<CornerRows<T>>,
    /// The conversion of a draw's pixels to positions and normals.
    pub(super) look: Option<(u32, Look<T>)>,
    /// Whether only corners, normals and light are prepared for the triangles of the list.
    pub(super) prepares_little: bool,
    /// The triangles of a tile that have to be lit.
    pub(super) new_faces: Vec<u32>,
    /// The blocks with listed pixels that wait to be coloured.
    pub(super) waiting: Vec<Waiting>,
    /// The starts of runs of equal pixels in each block of a tile, if colours of triangles are
    /// looked up.
    pub(super) runs: [u64; BLOCK_PIXELS],
}

/// A block with listed pixels: its first fragment, and its place in the tile.
#[derive(Clone, Copy, Debug)]
pub(super) struct Waiting {
    pub(super) from: usize,
    pub(super) at: usize,
}

/// The destination of a block's colours.
#[derive(Debug)]
pub(crate) enum Out<'a, 'b> {
    /// A tile, starting at an index.
    Tile(&'a mut Canvas<'b>, usize),
    /// The waiting blocks of a tile.
    Waiting(&'a mut Canvas<'b>),
    /// The sums over several samples.
    Sums(&'a mut Sums),
    /// The sums, and the cache for later passes, which stores this number of fragments from the
    /// first.
    Kept(&'a mut Sums, &'a mut Kept, usize),
    /// The colours behind a layer.
    Layer(&'a mut Blend),
}

impl<T: ShadingNumber> Default for Shader<T> {
    fn default() -> Self {
        Self {
            tile: TilePlan::default(),
            fragments: Fragments::default(),
            attributes: TriangleAttributes::default(),
            barycentrics: Barycentrics::default(),
            batch: Batch::default(),
            rays: RayScratch::default(),
            path_pixels: PathPixels::default(),
            placed: TexturePlacement::default(),
            texels: [[T::default(); BATCH]; 3],
            vertex_colors: [[[T::default(); SLOTS]; 3]; 3],
            maps: Box::default(),
            bounces: None,
            colors: Colors::default(),
            thresholds: Thresholds::default(),
            tiny: TinyTriangles::default(),
            corner_colors: Box::new([[[T::default(); 4]; BATCH]; 3]),
            look: None,
            prepares_little: false,
            new_faces: Vec::new(),
            waiting: Vec::new(),
            runs: [0; BLOCK_PIXELS],
        }
    }
}

impl<T: ShadingNumber> Shader<T> {
    /// Begins a frame.
    pub(crate) fn begin(&mut self) {
        self.attributes.forget();
        self.look = None;
        self.rays.count = RayCount::default();
        if let Some(bounces) = &mut self.bounces {
            bounces.begin();
        }
        self.path_pixels = PathPixels::default();
    }

    /// Returns the rays since the frame began.
    pub(crate) fn ray_count(&self) -> RayCount {
        let mut count = self.rays.count;
        if let Some(bounces) = &self.bounces {
            count += bounces.count();
        }
        count
    }
}
