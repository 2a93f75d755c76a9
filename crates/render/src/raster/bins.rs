//! Tile binning: lists the primitives that may be visible in each tile.
//!
//! Every thread fills separate bins, so no thread waits for another. The order of reading them does
//! not change visibility.

use super::covered::Covered;
use super::hits::Hits;
use super::lines::{self, ScreenLine};
use super::queue::{Queue, SMALL};
use super::tile_queues::TileQueues;
use crate::screen::clip::ScreenVertex;
use crate::screen::coverage::{PixelBox, SUBPIXELS};
use crate::screen::sample_positions::SamplePositions;
use crate::screen::tiles::{TILE, tiles_of};
use marraztu_core::base::image::Size;

/// A triangle that is not small, or needs the alpha test.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LargeTriangle {
    pub(crate) corners: [ScreenVertex; 3],
    pub(crate) number: u32,
    /// Whether the triangle needs the alpha test.
    pub(crate) cutout: bool,
}

/// The primitives of one tile, except its hits.
#[derive(Debug, Default)]
pub(crate) struct Bin {
    /// Triangles, as indices into [`Bins::large`].
    pub(crate) large: Vec<u32>,
    /// Lines, as indices into [`Bins::lines`].
    pub(crate) lines: Vec<u32>,
}

/// The bins of one thread, aligned so threads never share a cache line.
#[derive(Debug, Default)]
#[repr(align(128))]
pub(crate) struct Bins {
    columns: i32,
    rows: i32,
    /// The samples of the pass.
    pub(crate) sample_positions: SamplePositions,
    pub(crate) tiles: Vec<Bin>,
    pub(crate) hits: Hits,
    /// Small triangles that are rasterised when their tile is drawn.
    pub(crate) tile_queues: TileQueues,
    pub(crate) large: Vec<LargeTriangle>,
    /// The corners of large triangles in pixels before snapping, if the coverage rule needs them.
    pub(crate) unsnapped: Vec<[[f32; 2]; 3]>,
    pub(crate) lines: Vec<ScreenLine>,
    /// Small triangles waiting to be drawn together, by the size of their boxes.
    pub(crate) queues: Box<[Queue; SMALL.len()]>,
    /// The pixels covered by the triangles of a queue.
    pub(crate) covered: Box<Covered>,
    /// The number of triangles, or pieces of clipped triangles, in the bins.
    pub(crate) drawn: usize,
    /// The bins of transparent triangles, which hide nothing; `None` in a frame without
    /// transparency.
    transparent: Option<Box<Self>>,
}

impl Bins {
    /// Empties the bins for a picture of this size and a pass with these samples.
    pub(crate) fn clear(&mut self, size: Size, sample_positions: SamplePositions) {
        self.sample_positions = sample_positions;
        [self.columns, self.rows] = tiles_of(size);
        let count = usize::try_from(self.columns * self.rows).expect("not negative");
        self.tiles.resize_with(count, Bin::default);
        for bin in &mut self.tiles {
            bin.large.clear();
            bin.lines.clear();
        }
        let extent = [size.width, size.height]
            .map(|pixels| i32::try_from(pixels).expect("pictures have 32-bit sizes"));
        self.hits.clear(extent, [self.columns, self.rows]);
        self.tile_queues.clear([self.columns, self.rows], sample_positions.count());
        self.large.clear();
        self.unsnapped.clear();
        self.lines.clear();
        // A cancelled frame leaves triangles in the queues.
        for queue in self.queues.iter_mut() {
            queue.clear();
        }
        self.drawn = 0;
    }

    /// Empties the bins of transparent triangles, or drops them if the frame is opaque.
    pub(crate) fn clear_transparent(&mut self, size: Size, is_transparent: bool) {
        self.transparent = is_transparent.then(|| {
            let mut bins = self.transparent.take().unwrap_or_default();
            bins.clear(size, self.sample_positions);
            // Layers are gathered from hits and large triangles only.
            bins.tile_queues.clear([0; 2], 1);
            bins
        });
    }

    /// Returns the bins of transparent triangles, if the frame has any.
    pub(crate) fn transparent(&self) -> Option<&Self> {
        self.transparent.as_deref()
    }

    /// Returns the bins of opaque or of transparent triangles.
    pub(crate) fn of(&mut self, transparent: bool) -> &mut Self {
        if transparent { self.transparent.get_or_insert_default() } else { self }
    }

    /// Returns the number of triangles, or pieces of clipped triangles, including the transparent
    /// ones.
    pub(crate) fn triangles(&self) -> usize {
        self.drawn + self.transparent().map_or(0, |bins| bins.drawn)
    }

    /// Returns whether no primitive reaches into a tile.
    pub(crate) fn is_empty(&self, tile: usize) -> bool {
        let bin = &self.tiles[tile];
        self.hits.is_empty(tile)
            && self.tile_queues.is_empty(tile)
            && bin.large.is_empty()
            && bin.lines.is_empty()
            && self.transparent().is_none_or(|bins| bins.is_empty(tile))
    }

    /// Adds a triangle of any size to the tiles of its bounding box.
    pub(crate) fn add_large(&mut self, triangle: LargeTriangle, bounds: PixelBox) {
        let number = u32::try_from(self.large.len()).expect("fewer than 2^32 triangles");
        self.drawn += 1;
        self.large.push(triangle);
        self.each(bounds, |bin| bin.large.push(number));
    }

    /// Adds a line, or a point, to the tiles it crosses.
    pub(crate) fn add_line(&mut self, line: ScreenLine) {
        let number = u32::try_from(self.lines.len()).expect("fewer than 2^32 lines");
        self.lines.push(line);
        let picture =
            PixelBox { left: 0, top: 0, right: self.columns * TILE, bottom: self.rows * TILE };
        let width = (line.width + SUBPIXELS - 1) / SUBPIXELS;
        // At a sample off the centre, the line may cover the next pixel.
        let width = if self.sample_positions.are_many() { width + 1 } else { width };
        for bounds in lines::stretches(&line, width, picture) {
            self.each(bounds, |bin| bin.lines.push(number));
        }
    }

    fn each(&mut self, bounds: PixelBox, mut add: impl FnMut(&mut Bin)) {
        if bounds.is_empty() {
            return;
        }
        for row in tiles(bounds.top, bounds.bottom, self.rows) {
            for column in tiles(bounds.left, bounds.right, self.columns) {
                add(&mut self.tiles[(row * self.columns + column) as usize]);
            }
        }
    }
}

/// Returns the tiles along an axis of `count` tiles that a range of pixels reaches into.
#[inline(always)]
fn tiles(low: i32, high: i32, count: i32) -> std::ops::Range<i32> {
    low.div_euclid(TILE).max(0)..((high - 1).div_euclid(TILE) + 1).min(count)
}
