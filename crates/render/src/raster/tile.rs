//! The visibility of a tile: rasterises its primitives with a depth test (z-buffer).
//!
//! Each sample has an entry in the [visibility buffer](crate::raster::visibility_buffer). The depth
//! test keeps the larger entry: the nearer primitive and, at equal depth, the one with the lower
//! number, which belongs to the older object or the earlier face. The result does not depend on the
//! order of drawing.
//!
//! Coverage and depth are computed in one of two ways, selected only by the triangle's size: in f32
//! (exact for integers below 2^24) for bounding boxes up to 8 x 8 pixels; and in integers, with
//! depths from f64, for all others. Boxes up to 16 x 16 pixels are rasterised sixteen at a time
//! (`small`), here or during setup. All others are rasterised a block of 8 x 8 pixels at a time: in
//! 32 bits for boxes up to 64 x 64 pixels (`medium`), else in 64 bits (`large`), with the same
//! result. Tiles, threads and instruction sets are therefore invisible in the picture.
//!
//! A block without primitives is never touched. If a single large triangle covers a block, only the
//! triangle is noted, and no depths are computed until another primitive comes near. Bounds of each
//! block's depths skip hidden triangles early, as in hierarchical Z.
//!
//! With several samples per pixel, a pixel has an entry for each, side by side. A primitive covers
//! a sample if it covers the centre of the pixel after the primitive is moved by the sample's
//! offset.

use crate::simd::dispatch;
use fearless_simd::{Level, Simd};

use self::scratch::{Cutouts, SmallTriangles};
use super::bins::Bins;
use super::block_triangle::BlockTriangle;
use super::depth_format::{Format, depths_between};
use super::entries::word;
use super::geometry::ScreenGeometry;
use super::lines;
use super::visibility_buffer::{Plane, depths_of};
use crate::frame::FramePlan;
use crate::frame::raster_mode::RasterMode;
use crate::screen::coverage::{Grid, PixelBox};
use crate::screen::sample_positions::{MANY, SamplePositions};
use crate::screen::tiles::{BLOCK, BLOCK_PIXELS, BLOCKS, PIXELS, block_at, within};
use marraztu_core::accuracy::{Coverage, DepthFormat};

/// The visibility buffer of one tile: block by block, each block row by row, each pixel sample by
/// sample.
#[derive(Debug)]
pub(crate) struct Visibility {
    buffer: Box<Buffer>,
    /// The means to draw small triangles with several samples per pixel, created when first needed.
    small: Option<Box<SmallTriangles>>,
    /// The samples of the pass.
    sample_positions: SamplePositions,
    /// The blocks with valid entries, a bit for each.
    written: u64,
    /// The blocks that one triangle covers fully and that have no entries yet.
    whole: u64,
    /// The triangles of those blocks, as indices into `large`.
    shown: [u32; BLOCK_PIXELS],
    /// Triangles that cover a block fully.
    large: Vec<BlockTriangle>,
    /// The depth format.
    depth_format: DepthFormat,
    /// The grid of corners.
    grid: Grid,
    /// A lower bound of each block's depth keys: all pixels are at least as near.
    farthest: [u32; BLOCK_PIXELS],
    /// An upper bound of each fully covered block's depth keys: no pixel is nearer.
    nearest: [u32; BLOCK_PIXELS],
    bounds: PixelBox,
}

/// Entries. Rows of eight start at a cache line, because rows that cross one are read and written
/// twice: 4% of a frame of 70,000 triangles, flat, at 1920 x 1080.
#[derive(Debug)]
#[repr(align(64))]
struct Buffer([u64; MANY * PIXELS]);

impl Default for Visibility {
    fn default() -> Self {
        Self {
            buffer: Box::new(Buffer([0; MANY * PIXELS])),
            small: None,
            sample_positions: SamplePositions::default(),
            written: 0,
            whole: 0,
            shown: [0; BLOCK_PIXELS],
            large: Vec::new(),
            depth_format: DepthFormat::default(),
            grid: Grid::default(),
            farthest: [0; BLOCK_PIXELS],
            nearest: [0; BLOCK_PIXELS],
            bounds: PixelBox { left: 0, top: 0, right: 0, bottom: 0 },
        }
    }
}

impl Visibility {
    /// Draws everything that reaches into a tile, from the bins of every thread.
    pub(crate) fn draw(
        &mut self,
        level: Level,
        plan: &FramePlan,
        frame: &ScreenGeometry,
        (tile, bounds): (usize, PixelBox),
    ) {
        self.clear(bounds, frame.sample_positions());
        let RasterMode { depth, grid, .. } = plan.raster_mode();
        (self.depth_format, self.grid) = (depth, grid);
        match self.sample_positions.are_many() {
            true => self.draw_in::<MANY>(level, plan, frame, tile),
            false => self.draw_in::<1>(level, plan, frame, tile),
        }
    }

    /// Draws with up to `N` samples per pixel.
    fn draw_in<const N: usize>(
        &mut self,
        level: Level,
        plan: &FramePlan,
        frame: &ScreenGeometry,
        tile: usize,
    ) {
        // Large opaque triangles come first: a block without entries can be noted as fully covered.
        let is_exact = plan.raster_mode().coverage == Coverage::Exact;
        if is_exact {
            for bins in frame.bins() {
                dispatch!(level, simd => self.draw_plain::<_, N>(simd, bins, tile));
            }
        }
        // With one sample, small triangles are hits already.
        if N > 1 {
            dispatch!(level, simd => match self.sample_positions.count() {
                4 => self.draw_small::<_, 4>(simd, frame.bins(), tile),
                _ => self.draw_small::<_, MANY>(simd, frame.bins(), tile),
            });
        }
        // Alpha-tested triangles come after large opaque ones, because hidden pixels are not
        // sampled.
        let mut cutouts = Cutouts::default();
        for bins in frame.bins() {
            dispatch!(level, simd => self.draw_hits::<_, N>(simd, bins, tile));
            // The other rules draw opaque and alpha-tested triangles in one pass.
            if !is_exact {
                dispatch!(level, simd => {
                    self.draw_by_rule::<_, N>(simd, (plan, frame), bins, tile);
                });
                self.draw_lines::<N>(level, bins, tile);
                continue;
            }
            for &number in &bins.tiles[tile].large {
                let large = &bins.large[number as usize];
                if large.cutout {
                    dispatch!(level, simd => {
                        self.draw_cutout::<_, N>(simd, (plan, frame), large, &mut cutouts);
                    });
                }
            }
            self.draw_lines::<N>(level, bins, tile);
        }
    }

    fn clear(&mut self, bounds: PixelBox, sample_positions: SamplePositions) {
        self.sample_positions = sample_positions;
        // Entries of blocks that are not `written` are never read, so the buffer is not cleared.
        (self.written, self.whole) = (0, 0);
        self.large.clear();
        self.farthest.fill(0);
        self.bounds = bounds;
    }

    /// Returns whether a block shows anything; `block` counts along rows of blocks.
    pub(crate) const fn shows(&self, block: usize) -> bool {
        (self.written | self.whole) >> block & 1 != 0
    }

    /// Returns whether no block shows anything.
    pub(crate) const fn is_empty(&self) -> bool {
        self.written | self.whole == 0
    }

    /// Returns the triangle that covers a block fully, if there is one. The block's entries are
    /// meaningless then.
    pub(crate) fn whole(&self, block: usize) -> Option<u32> {
        let is_whole = self.whole >> block & 1 != 0;
        is_whole.then(|| self.large[self.shown[block] as usize].number())
    }

    /// Returns the blocks that one triangle covers fully, a bit for each.
    pub(crate) const fn full_blocks(&self) -> u64 {
        self.whole
    }

    /// Returns the entries of a block that shows something, row by row, with one sample per pixel.
    pub(crate) fn block(&self, block: usize) -> &[u64; BLOCK_PIXELS] {
        &self.buffer.0.as_chunks().0[block]
    }

    /// Returns the entries of all samples of a block that shows something, pixel by pixel.
    pub(crate) fn samples_of(&self, block: usize) -> &[u64] {
        let count = self.sample_positions.count() * BLOCK_PIXELS;
        &self.buffer.0[block * count..][..count]
    }

    /// Returns the farthest and nearest depth of all visible triangles. `None` if no triangle is
    /// visible.
    pub(crate) fn depths(&self, level: Level) -> Option<[f32; 2]> {
        let (mut low, mut high) = (u32::MAX, 0);
        for block in (0..BLOCK_PIXELS).filter(|block| self.shows(*block)) {
            // A fully covered block has bounds instead of entries.
            let [own_low, own_high] = if self.whole(block).is_some() {
                [self.farthest[block], self.nearest[block]]
            } else {
                dispatch!(level, simd => depths_of(simd, self.samples_of(block)))
            };
            (low, high) = (low.min(own_low), high.max(own_high));
        }
        (low <= high).then(|| depths_between(self.depth_format, [low, high]))
    }

    /// Returns the upper left pixel of a block.
    pub(crate) fn corner(&self, block: usize) -> [i32; 2] {
        let at = i32::try_from(block).expect("a tile has few blocks");
        [self.bounds.left + at % BLOCKS * BLOCK, self.bounds.top + at / BLOCKS * BLOCK]
    }

    /// Returns the entries of the samples of a pixel of the tile, and their number.
    pub(crate) fn samples(&mut self, level: Level, x: i32, y: i32) -> ([u64; MANY], usize) {
        let (x, y) = (x - self.bounds.left, y - self.bounds.top);
        let block = block_at(x, y);
        let (mut samples, count) = ([0; MANY], self.sample_positions.count());
        if self.shows(block) {
            // A fully covered block gets its entries only now.
            self.write_samples(level, block);
            let own = &self.samples_of(block)[within(x, y) * count..][..count];
            samples[..count].copy_from_slice(own);
        }
        (samples, count)
    }

    /// Returns the entries of a block for one of its samples; 0 in pixels without an opaque
    /// primitive.
    pub(crate) fn entries(
        &mut self,
        level: Level,
        block: usize,
        sample: usize,
    ) -> [u64; BLOCK_PIXELS] {
        if !self.shows(block) {
            return [0; BLOCK_PIXELS];
        }
        self.write_samples(level, block);
        plane_of(self.samples_of(block), self.sample_positions.count(), sample)
    }

    /// Makes the entries of a block valid for the samples of the pass.
    fn write_samples(&mut self, level: Level, block: usize) {
        match self.sample_positions.are_many() {
            true => self.write::<MANY>(level, block),
            false => self.write::<1>(level, block),
        }
    }

    /// Makes the entries of a block valid for up to `N` samples per pixel, before something is
    /// drawn into it.
    #[inline(always)]
    fn write<const N: usize>(&mut self, level: Level, block: usize) {
        let bit = 1 << block;
        if self.written & bit == 0 {
            self.written |= bit;
            self.entries_mut::<N>(block).fill(0);
            // The triangle that was only noted comes first.
            if self.whole & bit != 0 {
                self.expand::<N>(level, block);
            }
        }
    }

    /// Writes the entries of a block that one triangle covers fully.
    #[inline(never)]
    fn expand<const N: usize>(&mut self, level: Level, block: usize) {
        self.whole &= !(1 << block);
        let triangle = self.large[self.shown[block] as usize];
        self.draw_block::<N>(level, &triangle, block, true);
    }

    /// Returns the entries of a block, pixel by pixel, with up to `N` samples each.
    #[inline(always)]
    fn entries_mut<const N: usize>(&mut self, block: usize) -> &mut [u64] {
        let count = self.sample_positions.count_in::<N>() * BLOCK_PIXELS;
        &mut self.buffer.0[block * count..][..count]
    }

    /// Draws into the entries of a block for one of up to `N` samples.
    #[inline(always)]
    fn draw_plane<const N: usize>(
        &mut self,
        block: usize,
        sample: usize,
        draw: impl FnOnce(&mut Plane),
    ) {
        let count = self.sample_positions.count_in::<N>();
        let entries = self.entries_mut::<N>(block);
        if N == 1 {
            if let Some(plane) = entries.first_chunk_mut() {
                draw(plane);
            }
            return;
        }
        let mut plane = plane_of(entries, count, sample);
        draw(&mut plane);
        for (entry, new) in entries.iter_mut().skip(sample).step_by(count).zip(plane) {
            *entry = new;
        }
    }

    /// Draws a triangle into a block that it covers fully or partly.
    #[inline(never)]
    fn draw_block<const N: usize>(
        &mut self,
        level: Level,
        triangle: &BlockTriangle,
        block: usize,
        whole: bool,
    ) {
        let (positions, format) = (self.sample_positions, Format(self.depth_format));
        if N > 1
            && let BlockTriangle::Large(large) = triangle
        {
            let of = (&positions, self.entries_mut::<N>(block));
            dispatch!(level, simd => large.draw_samples(format, simd, block, whole, of));
            return;
        }
        dispatch!(level, simd => for sample in 0..positions.count_in::<N>() {
            let shift = positions.shift::<N>(sample);
            self.draw_plane::<N>(
                block,
                sample,
                #[inline(always)]
                |plane| triangle.draw(format, simd, (block, shift), whole, None, plane),
            );
        });
    }

    #[inline(always)]
    fn put<const N: usize>(
        &mut self,
        level: Level,
        (x, y, sample): (i32, i32, usize),
        key: u32,
        number: u32,
    ) {
        let (x, y) = (x - self.bounds.left, y - self.bounds.top);
        self.write::<N>(level, block_at(x, y));
        let (word, count) = (word(key, number), self.sample_positions.count_in::<N>());
        let old = &mut self.entries_mut::<N>(block_at(x, y))[within(x, y) * count + sample];
        *old = word.max(*old);
    }

    /// Returns the key of a depth.
    #[inline(always)]
    fn key(&self, depth: f32) -> u32 {
        Format(self.depth_format).key(depth)
    }

    /// Draws the hits of a tile from the bins of one thread.
    #[inline(always)]
    fn draw_hits<S: Simd, const N: usize>(&mut self, simd: S, bins: &Bins, tile: usize) {
        let samples = self.sample_positions.count_in::<N>();
        bins.hits.each(
            (Format(self.depth_format), simd),
            tile,
            #[inline(always)]
            |place, word| {
                let place = place as usize % (N * PIXELS);
                let block = place / (samples * BLOCK_PIXELS);
                // Hits of one triangle are neighbours: the block is mostly valid already.
                if self.written >> block & 1 == 0 {
                    self.write::<N>(simd.level(), block);
                }
                let old = &mut self.buffer.0[place];
                *old = word.max(*old);
            },
        );
    }

    /// Draws the long lines of a tile.
    #[inline(always)]
    fn draw_lines<const N: usize>(&mut self, level: Level, bins: &Bins, tile: usize) {
        for &place in &bins.tiles[tile].lines {
            let format = Format(self.depth_format);
            for sample in 0..self.sample_positions.count_in::<N>() {
                // The line moves instead of the sample, which keeps the arithmetic exact.
                let line =
                    bins.lines[place as usize].seen_from(self.sample_positions.shift::<N>(sample));
                lines::pixels(
                    &line,
                    self.bounds,
                    #[inline(always)]
                    |x, y, depth| {
                        let key = format.key(depth) + format.lines_nearer();
                        self.put::<N>(level, (x, y, sample), key, line.number);
                    },
                );
            }
        }
    }

    /// Draws the large triangles of a tile without the alpha test.
    #[inline(always)]
    fn draw_plain<S: Simd, const N: usize>(&mut self, simd: S, bins: &Bins, tile: usize) {
        for &number in &bins.tiles[tile].large {
            let large = &bins.large[number as usize];
            if !large.cutout {
                self.draw_large::<S, N>(simd, large);
            }
        }
    }
}

/// Returns the entries of a block for one of its samples.
#[inline(always)]
fn plane_of(entries: &[u64], count: usize, sample: usize) -> Plane {
    std::array::from_fn(|pixel| entries[pixel * count + sample])
}

mod cutout_fragments;
mod cutouts;
mod other_rules;
mod scratch;
mod small;
#[cfg(test)]
mod tests;
mod triangles;
