//! Draws the hits of a tile: pixels of small triangles and of short lines.
//!
//! Hits may have [colours](super::super::hit_colors), like other triangles that are
//! [painted](super::super::paint). The colours of the nearest hits are then stored next to their
//! entries, in blocks that a coloured hit reaches. Anything else drawn into such a block later
//! drops them.

use std::hint::select_unpredictable;

use fearless_simd::{Level, Simd};

use super::Visibility;
use crate::raster::bins::Bins;
use crate::raster::depth_format::{Format as _, with_format};
use crate::screen::tiles::{BLOCK_PIXELS, PIXELS};

/// The colours of pixels, block by block: red, green, blue and 255; or 0 if unknown. The entries
/// after the last pixel are a dummy target for hidden hits.
#[derive(Debug)]
#[repr(align(64))]
pub(super) struct HitColors([u32; PIXELS + BLOCK_PIXELS]);

impl Default for HitColors {
    fn default() -> Self {
        Self([0; PIXELS + BLOCK_PIXELS])
    }
}

impl HitColors {
    /// Returns the colours of a block.
    #[inline(always)]
    pub(super) fn block_mut(&mut self, block: usize) -> &mut [u32; BLOCK_PIXELS] {
        &mut self.0.as_chunks_mut().0[block]
    }
}

impl Visibility {
    /// Draws the hits of a tile from the bins of one thread.
    #[inline(always)]
    pub(super) fn draw_hits<S: Simd, const N: usize>(&mut self, simd: S, bins: &Bins, tile: usize) {
        if N == 1 && bins.hits.colored {
            return simd.vectorize(
                #[inline(always)]
                || self.draw_colored_hits(simd, bins, tile),
            );
        }
        let samples = self.sample_positions.count_in::<N>();
        with_format!(self.depth_format, D => bins.hits.each(
            (D::of(self.depth_format), simd),
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
        ));
    }

    /// Draws hits that have colours, with one sample per pixel.
    #[inline(always)]
    fn draw_colored_hits<S: Simd>(&mut self, simd: S, bins: &Bins, tile: usize) {
        with_format!(self.depth_format, D => bins.hits.each_page(
            (D::of(self.depth_format), simd),
            tile,
            #[inline(always)]
            |places, words, colors| {
                for ((place, word), color) in places.iter().zip(words).zip(colors) {
                    let place = *place as usize % PIXELS;
                    self.color(simd.level(), place / BLOCK_PIXELS);
                    let old = &mut self.buffer.0[place];
                    // A hidden hit stores its colour in the dummy entry, which avoids an
                    // unpredictable branch.
                    let to = select_unpredictable(*word > *old, place, PIXELS);
                    self.colors.0[to] = *color;
                    *old = (*word).max(*old);
                }
            },
        ));
    }

    /// Makes the entries and colours of a block valid.
    #[inline(always)]
    pub(super) fn color(&mut self, level: Level, block: usize) {
        if self.colored >> block & 1 == 0 {
            self.begin_colors(level, block);
        }
    }

    /// Starts the colours of a block. Primitives drawn earlier have unknown colours.
    #[inline(never)]
    fn begin_colors(&mut self, level: Level, block: usize) {
        let is_empty = !self.shows(block);
        self.write::<1>(level, block);
        self.colored |= 1 << block;
        let entries = &self.buffer.0.as_chunks::<BLOCK_PIXELS>().0[block];
        let colors = &mut self.colors.0.as_chunks_mut::<BLOCK_PIXELS>().0[block];
        if is_empty {
            return colors.fill(self.background);
        }
        // 0 is an unknown colour: the primitive that is there will be shaded later.
        for (color, entry) in colors.iter_mut().zip(entries) {
            *color = if *entry == 0 { self.background } else { 0 };
        }
    }

    /// Returns the colours of a block's pixels, including background pixels, and whether all are
    /// known. `None` if the block has no colours.
    pub(crate) fn colors(&self, block: usize) -> Option<(&[u32; BLOCK_PIXELS], bool)> {
        if self.colored >> block & 1 == 0 {
            return None;
        }
        let colors = &self.colors.0.as_chunks().0[block];
        // Known colours have 255 in the top byte, unknown ones 0.
        let all = colors.iter().fold(u32::MAX, |all, color| all & color);
        Some((colors, all >> 24 != 0))
    }

    /// Returns the entries of a block's pixels without a known colour; 0 for the others.
    pub(crate) fn uncolored(&self, block: usize) -> [u64; BLOCK_PIXELS] {
        let entries = self.block(block);
        let colors = &self.colors.0.as_chunks::<BLOCK_PIXELS>().0[block];
        std::array::from_fn(|i| if colors[i] == 0 { entries[i] } else { 0 })
    }
}
