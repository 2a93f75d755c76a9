//! Caches which pixels a light reaches, so only changed pixels are traced again.
//!
//! A pixel's shadow depends on the point it shows, on the casters and on the light's position. It
//! does not depend on the light's colour, on other lights or on materials. For each shadow-casting
//! light, the cache holds two bits per pixel: whether a ray was traced, and whether it was blocked.
//! That is a quarter of a byte per light and pixel.
//!
//! A block of pixels is painted by one thread at a time, so no thread waits for another.

use std::sync::atomic::{AtomicU64, Ordering};

use crate::frame::shadows::ShadowSource;
use crate::screen::tiles::{BLOCK, BLOCK_PIXELS, TILE_SIDE};
use marraztu_core::base::image::Size;

/// The cached shadows of each light of a plan, if it casts any.
#[derive(Debug, Default)]
pub(crate) struct KnownShadows {
    lights: Vec<Option<KnownLight>>,
}

/// The cached shadows of one light.
#[derive(Debug)]
pub(crate) struct KnownLight {
    source: ShadowSource,
    /// The number of blocks in a row of the picture.
    columns: usize,
    blocks: Vec<KnownBlock>,
}

/// The cached pixels of a block, a bit for each.
#[derive(Debug, Default)]
struct KnownBlock {
    /// The pixels with a traced ray.
    traced: AtomicU64,
    /// The pixels with a blocked ray.
    shaded: AtomicU64,
}

/// Some pixels of a block, a bit for each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct KnownPixels {
    /// The pixels with a traced ray.
    pub(crate) traced: u64,
    /// The pixels with a blocked ray.
    pub(crate) shaded: u64,
}

/// The number of blocks in a row of a tile.
const TILE_BLOCKS: usize = TILE_SIDE / BLOCK as usize;

impl KnownShadows {
    /// Clears the cache.
    pub(crate) fn forget(&mut self) {
        self.lights.clear();
    }

    /// Keeps the cache of each light that has not moved, and drops all others. The picture must
    /// have the same size as before.
    pub(crate) fn keep(&mut self, size: Size, sources: &[Option<ShadowSource>]) {
        let before = std::mem::take(&mut self.lights);
        let mut before: Vec<KnownLight> = before.into_iter().flatten().collect();
        // Lights are matched by source, because their numbers in the plan may change.
        let mut kept = |source: &ShadowSource| match before
            .iter()
            .position(|known| known.source.is_same(source))
        {
            Some(at) => before.remove(at),
            None => KnownLight::new(*source, size),
        };
        self.lights = sources.iter().map(|source| source.as_ref().map(&mut kept)).collect();
    }

    /// Returns the lights that cast shadows, with their positions.
    pub(crate) fn lights(&mut self) -> impl Iterator<Item = (ShadowSource, &mut KnownLight)> {
        self.lights.iter_mut().flatten().map(|known| (known.source, known))
    }

    /// Returns the cache of a light, or `None` without a cache.
    pub(crate) fn of(&self, light: u32) -> Option<&KnownLight> {
        self.lights.get(light as usize)?.as_ref()
    }
}

impl KnownLight {
    fn new(source: ShadowSource, size: Size) -> Self {
        let [columns, rows] =
            [size.width, size.height].map(|pixels| pixels.div_ceil(TILE_SIDE) * TILE_BLOCKS);
        let mut blocks = Vec::new();
        blocks.resize_with(columns * rows, KnownBlock::default);
        Self { source, columns, blocks }
    }

    /// Clears the stale tiles.
    pub(crate) fn forget(&mut self, is_stale: impl Fn(usize) -> bool) {
        let columns = self.columns / TILE_BLOCKS;
        for (row, blocks) in self.blocks.chunks_mut(self.columns).enumerate() {
            for (column, blocks) in blocks.chunks_mut(TILE_BLOCKS).enumerate() {
                if is_stale(row / TILE_BLOCKS * columns + column) {
                    blocks.fill_with(KnownBlock::default);
                }
            }
        }
    }

    /// Returns the cached pixels of the block that holds this pixel.
    #[inline(always)]
    pub(crate) fn at(&self, pixel: [i32; 2]) -> KnownPixels {
        self.block(pixel).map_or_else(KnownPixels::default, |block| KnownPixels {
            traced: block.traced.load(Ordering::Relaxed),
            shaded: block.shaded.load(Ordering::Relaxed),
        })
    }

    /// Adds results for the block that holds this pixel.
    #[inline(always)]
    pub(crate) fn note(&self, pixel: [i32; 2], new: KnownPixels) {
        // No other thread writes to this block meanwhile, so no atomic update is needed.
        let KnownPixels { traced, shaded } = self.at(pixel);
        if let Some(block) = self.block(pixel) {
            block.traced.store(traced | new.traced, Ordering::Relaxed);
            // A retraced pixel replaces its earlier result.
            block.shaded.store(shaded & !new.traced | new.shaded, Ordering::Relaxed);
        }
    }

    #[inline(always)]
    fn block(&self, pixel: [i32; 2]) -> Option<&KnownBlock> {
        // A negative index becomes the largest number, which is in no block.
        let [column, row] = pixel.map(|i| usize::try_from(i / BLOCK).unwrap_or(usize::MAX));
        self.blocks.get(row.checked_mul(self.columns)?.checked_add(column)?)
    }
}

/// The pixels of a batch, all in one block.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BatchPixels<'a> {
    /// The column and row of one of the pixels.
    pub(crate) first: [i32; 2],
    /// The index of each pixel in its block.
    pub(crate) places: &'a [u8],
}

impl BatchPixels<'_> {
    /// Converts a mask over the batch to a mask over the block.
    #[inline(always)]
    pub(crate) fn in_block(self, positions: u64) -> u64 {
        // The pixels of a full block are listed in order, so both masks are equal.
        if self.places.len() == BLOCK_PIXELS {
            return positions;
        }
        let bit = |(i, place): (usize, &u8)| (positions >> i & 1) << place;
        self.places.iter().enumerate().map(bit).fold(0, |bits, bit| bits | bit)
    }

    /// Converts a mask over the block to a mask over the batch.
    #[inline(always)]
    pub(crate) fn in_batch(self, pixels: u64) -> u64 {
        if self.places.len() == BLOCK_PIXELS {
            return pixels;
        }
        let bit = |(i, place): (usize, &u8)| (pixels >> place & 1) << i;
        self.places.iter().enumerate().map(bit).fold(0, |bits, bit| bits | bit)
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    const SIZE: Size = Size::new(150, 70);

    fn point(x: f64) -> ShadowSource {
        ShadowSource::Point(DVec3::new(x, 0.0, 0.0))
    }

    #[test]
    fn lights_that_stay_keep_their_pixels_whatever_their_numbers_and_others_begin_anew() {
        let mut known = KnownShadows::default();
        known.keep(SIZE, &[Some(point(1.0)), None, Some(point(2.0))]);
        let pixels = KnownPixels { traced: 0b11, shaded: 0b10 };
        known.of(0).unwrap().note([149, 69], pixels);
        known.of(2).unwrap().note([3, 9], pixels);
        known.keep(SIZE, &[None, Some(point(2.0)), Some(point(3.0)), Some(point(1.0))]);
        assert!(known.of(0).is_none() && known.of(9).is_none());
        assert_eq!(known.of(1).unwrap().at([7, 15]), pixels);
        assert_eq!(known.of(2).unwrap().at([7, 15]), KnownPixels::default());
        assert_eq!(known.of(3).unwrap().at([144, 64]), pixels);
        // Two bits for each pixel of whole tiles: a quarter of a byte.
        let light = known.of(1).unwrap();
        assert_eq!(light.blocks.len() * size_of::<KnownBlock>(), 192 * 128 / 4);
    }

    #[test]
    fn stale_tiles_are_forgotten_and_no_others() {
        let mut known = KnownShadows::default();
        known.keep(SIZE, &[Some(point(1.0))]);
        let pixels = KnownPixels { traced: 1, shaded: 1 };
        for at in [[63, 0], [64, 0], [127, 63], [64, 64]] {
            known.of(0).unwrap().note(at, pixels);
        }
        known.lights().for_each(|(_, light)| light.forget(|tile| tile == 1));
        let at = |pixel| known.of(0).unwrap().at(pixel).traced;
        assert_eq!([at([63, 0]), at([64, 0]), at([127, 63]), at([64, 64])], [1, 0, 0, 1]);
    }

    #[test]
    fn a_retraced_pixel_replaces_its_cached_shadow() {
        let light = KnownLight::new(point(1.0), SIZE);
        light.note([0, 0], KnownPixels { traced: 0b011, shaded: 0b011 });
        light.note([0, 0], KnownPixels { traced: 0b110, shaded: 0b100 });
        assert_eq!(light.at([7, 7]), KnownPixels { traced: 0b111, shaded: 0b101 });
    }

    #[test]
    fn positions_of_a_batch_are_pixels_of_its_block() {
        let some = BatchPixels { first: [0, 0], places: &[3, 5, 63] };
        assert_eq!(some.in_block(0b101), 1 << 3 | 1 << 63);
        assert_eq!(some.in_batch(1 << 63 | 1 << 5 | 1 << 4), 0b110);
    }
}
