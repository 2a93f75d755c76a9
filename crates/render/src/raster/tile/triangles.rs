//! Draws the medium and large triangles of a tile that have no holes.

use crate::simd::Bits;
use fearless_simd::{Level, Simd};

use super::Visibility;
use crate::raster::bins::LargeTriangle;
use crate::raster::block_triangle::BlockTriangle;
use crate::raster::depth_format::Format;
use crate::raster::entries::word;
use crate::raster::large::{Large, Touched};
use crate::raster::medium::{self, Medium};
use crate::screen::coverage::{Grid, PixelBox, Snapped, Triangle};
use crate::screen::tiles::BLOCK_PIXELS;
use marraztu_core::base::math::each;

impl Visibility {
    /// Draws a medium or large triangle without holes.
    #[inline(always)]
    pub(super) fn draw_large<S: Simd, const N: usize>(
        &mut self,
        simd: S,
        triangle: &LargeTriangle,
    ) {
        let corners = each(triangle.corners, |corner| corner.at());
        let reached = PixelBox::reached(corners, self.sample_positions.reach::<N>());
        // The fine grid needs more than 32 bits.
        let is_medium = reached.width() <= medium::LONGEST && reached.height() <= medium::LONGEST;
        if is_medium && self.grid == Grid::Usual {
            return self.draw_medium::<S, N>(simd, triangle);
        }
        let Some((large, area)) = self.set_up::<N>(triangle) else { return };
        self.draw_blocks::<S, N>(simd, &BlockTriangle::Large(large), area);
    }

    /// Draws a triangle without holes block by block. `area` bounds its pixels, relative to the
    /// tile's first.
    #[inline(always)]
    pub(super) fn draw_blocks<S: Simd, const N: usize>(
        &mut self,
        simd: S,
        triangle: &BlockTriangle,
        area: PixelBox,
    ) {
        let touched = triangle.blocks::<S, N>(simd, area, &self.sample_positions);
        let (high, mut place) = (self.key(triangle.high()), None);
        // Skip hidden blocks (hierarchical Z), note fully covered ones, draw the rest.
        for block in Bits(touched.some) {
            if high < self.farthest[block] {
                continue;
            }
            let whole = touched.whole >> block & 1 != 0;
            if whole && self.note_full_block::<N>(triangle, block, &mut place) {
                continue;
            }
            self.write::<N>(simd.level(), block);
            self.draw_block::<N>(simd.level(), triangle, block, whole);
        }
    }

    /// Draws a triangle with a bounding box of at most the size of a tile.
    #[inline(always)]
    fn draw_medium<S: Simd, const N: usize>(&mut self, simd: S, triangle: &LargeTriangle) {
        let corners = each(triangle.corners, |corner| corner.at());
        let Some(area) = self.reached::<N>(corners) else { return };
        let first = [self.bounds.left, self.bounds.top];
        let Some(medium) = Medium::new(simd, triangle, first) else { return };
        let Touched { some, whole } = medium.blocks::<N>(simd, area, &self.sample_positions);
        let high = self.key(medium.high);
        let (mut large, mut place) = (None, None);
        for block in Bits(some) {
            let block = block % BLOCK_PIXELS;
            if high < self.farthest[block] {
                continue;
            }
            // A fully covered block may need no entries at all; `Large` is built for the first such
            // block.
            if whole >> block & 1 != 0 {
                large = large.or_else(|| {
                    let edges = Triangle::new(corners)?;
                    Some(BlockTriangle::Large(Large::new(triangle, &edges, first)))
                });
                if large.is_some_and(|it| self.note_full_block::<N>(&it, block, &mut place)) {
                    continue;
                }
            }
            self.write::<N>(simd.level(), block);
            let (format, positions) = (Format(self.depth_format), self.sample_positions);
            let entries = self.entries_mut::<N>(block);
            if N > 1 {
                medium.draw_samples(format, simd, block, area, (&positions, entries));
            } else if let Some(plane) = entries.first_chunk_mut() {
                medium.draw(format, simd, block, area, plane);
            }
        }
    }

    /// Draws a triangle into a block that it covers fully. `place` is its index in `large`, once it
    /// has one.
    pub(super) fn draw_full_block<const N: usize>(
        &mut self,
        level: Level,
        triangle: &BlockTriangle,
        block: usize,
        place: &mut Option<u32>,
    ) {
        if !self.note_full_block::<N>(triangle, block, place) {
            self.write::<N>(level, block);
            self.draw_block::<N>(level, triangle, block, true);
        }
    }

    /// Draws a triangle into a block that it covers fully, if no entries need to be written: if it
    /// is hidden, or alone in the block. Returns whether this was so.
    #[inline(never)]
    fn note_full_block<const N: usize>(
        &mut self,
        triangle: &BlockTriangle,
        block: usize,
        place: &mut Option<u32>,
    ) -> bool {
        let [low, high] = triangle.depths::<N>(block).map(|depth| self.key(depth));
        let number = triangle.number();
        // At equal depths the lower number is in front, which happens often with coarse formats.
        let other = self.whole(block);
        let is_hidden = match other {
            Some(other) => word(high, number) < word(self.farthest[block], other),
            None => high < self.farthest[block],
        };
        // The triangle replaces an empty block, or a noted triangle that is behind it everywhere.
        let is_alone = !self.shows(block)
            || other.is_some_and(|other| word(low, number) > word(self.nearest[block], other));
        if !is_hidden && is_alone {
            self.shown[block] = *place.get_or_insert_with(|| {
                self.large.push(*triangle);
                u32::try_from(self.large.len() - 1).expect("fewer than 2^32 triangles")
            });
            self.whole |= 1 << block;
            self.nearest[block] = high;
        }
        self.farthest[block] = self.farthest[block].max(low);
        is_hidden || is_alone
    }

    /// Sets up a triangle relative to the tile, and finds the pixels of its bounding box in the
    /// tile, relative to the tile's first. `None` if there are no such pixels.
    pub(super) fn set_up<const N: usize>(
        &self,
        triangle: &LargeTriangle,
    ) -> Option<(Large, PixelBox)> {
        let corners = each(triangle.corners, |corner| corner.at());
        let area = self.reached::<N>(corners)?;
        let edges = Triangle::on(self.grid, corners)?;
        Some((Large::new(triangle, &edges, [self.bounds.left, self.bounds.top]), area))
    }

    /// Returns the pixels of the tile that a triangle's bounding box reaches into, relative to the
    /// tile's first.
    #[inline(always)]
    fn reached<const N: usize>(&self, corners: [Snapped; 3]) -> Option<PixelBox> {
        let reach = self.sample_positions.reach::<N>();
        PixelBox::reached_on(self.grid, corners, reach).in_tile(self.bounds)
    }
}
