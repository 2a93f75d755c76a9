//! Hits: pixels covered by small primitives, tile by tile.
//!
//! Small triangles and short lines are rasterised sixteen at a time, one per lane, before tiles are
//! drawn. The covered pixels are hits. They are stored in pages, which are allocated to tiles as
//! needed and reused in the next frame.

use fearless_simd::{Bytes as _, Simd, SimdBase as _, SimdMask as _, i32x16, mask32x16, u32x16};

use prefetch_index::prefetch_index;

use super::depth_format::Format;
use super::entries::{keys_and_numbers, put_words, word};
use crate::screen::coverage::PixelBox;
use crate::screen::tiles::{TILE, lanes_place};
use crate::simd::Bits;

/// The number of primitives rasterised at once.
pub(crate) const PACK: usize = 16;

/// The number of hits in a page.
const PAGE: usize = 512;

/// A sentinel page that is never written: it counts as full, and ends every chain.
const FULL: u32 = 0;

/// The largest number of tiles for which sixteen primitives are added tile by tile.
const FEW_TILES: i32 = 6;

/// A page of hits of one tile.
#[derive(Clone, Debug)]
struct Page {
    /// The index of the sample in the tile's visibility buffer.
    place: [u32; PAGE],
    /// The entry in the visibility buffer, for formats with the bits of depths as keys.
    word: [u64; PAGE],
    count: usize,
    /// The tile's page before this one, or [`FULL`].
    previous: u32,
}

impl Page {
    const fn new(count: usize) -> Self {
        Self { place: [0; PAGE], word: [0; PAGE], count, previous: FULL }
    }

    /// Prefetches the first cache lines; the hardware prefetcher follows with the rest.
    #[inline(always)]
    fn prefetch(&self) {
        for at in (0..64).step_by(16) {
            prefetch_index(self.place.as_slice(), at);
        }
        for at in (0..64).step_by(8) {
            prefetch_index(self.word.as_slice(), at);
        }
    }

    /// Adds the hits of a mask, out of sixteen.
    #[inline(always)]
    fn add<S: Simd>(&mut self, place: u32x16<S>, pixels: &Pixels<S>, some: mask32x16<S>) {
        let to = self.count..self.count + PACK;
        place.compress(some).store_slice(&mut self.place[to.clone()]);
        let (depth, number) = (pixels.depth.compress(some), pixels.number.compress(some));
        put_words(depth, number, &mut self.word[to]);
        self.count += some.to_bitmask().count_ones() as usize;
    }

    /// Adds the first `count` of sixteen hits.
    #[inline(always)]
    fn add_first<S: Simd>(&mut self, place: u32x16<S>, pixels: &Pixels<S>, count: usize) {
        let to = self.count..self.count + PACK;
        place.store_slice(&mut self.place[to.clone()]);
        put_words(pixels.depth, pixels.number, &mut self.word[to]);
        self.count += count;
    }
}

/// One pixel of each of sixteen primitives.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pixels<S: Simd> {
    pub(crate) x: i32x16<S>,
    pub(crate) y: i32x16<S>,
    /// The bits of the depth.
    pub(crate) depth: u32x16<S>,
    /// The number of the primitive.
    pub(crate) number: u32x16<S>,
}

/// The tiles that sixteen primitives may reach into.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Reach {
    /// One tile, with all pixels inside the picture.
    One(usize),
    /// A few tiles.
    Few(PixelBox),
    /// Many tiles.
    Many,
}

/// The hits found by one thread.
#[derive(Debug)]
pub(crate) struct Hits {
    /// The columns and rows of the picture.
    pub(crate) extent: [i32; 2],
    /// The columns and rows of tiles.
    tiles: [i32; 2],
    /// The last page of each tile.
    last: Vec<u32>,
    pages: Vec<Page>,
    /// The number of pages in use.
    used: usize,
}

impl Default for Hits {
    fn default() -> Self {
        let pages = vec![Page::new(PAGE)];
        Self {
            extent: [0; 2],
            tiles: [0; 2],
            last: Vec::new(),
            pages,
            // Page 0 is the sentinel.
            used: 1,
        }
    }
}

impl Hits {
    /// Removes all hits, for a picture of this many columns and rows of pixels and of tiles.
    pub(crate) fn clear(&mut self, extent: [i32; 2], tiles: [i32; 2]) {
        (self.extent, self.tiles) = (extent, tiles);
        // Every chain starts at the sentinel again; the pages keep their memory.
        self.last.clear();
        self.last.resize(usize::try_from(tiles[0] * tiles[1]).expect("not negative"), FULL);
        self.used = 1;
    }

    /// Returns whether a tile has no hits.
    #[inline(always)]
    pub(crate) fn is_empty(&self, tile: usize) -> bool {
        self.last[tile] == FULL
    }

    /// Finds the tiles that a box of pixels reaches into. The box may be empty, or reach beyond the
    /// picture.
    #[inline(always)]
    pub(crate) fn reach(&self, pixels: PixelBox) -> Reach {
        let [columns, rows] = self.tiles;
        let [width, height] = self.extent;
        let tiles = PixelBox {
            left: (pixels.left >> 6).max(0),
            top: (pixels.top >> 6).max(0),
            right: (((pixels.right - 1) >> 6) + 1).min(columns),
            bottom: (((pixels.bottom - 1) >> 6) + 1).min(rows),
        };
        // Only boxes inside the picture may skip the bounds test of each pixel.
        let whole =
            pixels.left >= 0 && pixels.top >= 0 && pixels.right <= width && pixels.bottom <= height;
        match (tiles.width(), tiles.height()) {
            (1, 1) if whole => Reach::One((tiles.top * columns + tiles.left) as usize),
            (columns, rows) if i64::from(columns) * i64::from(rows) <= i64::from(FEW_TILES) => {
                Reach::Few(tiles)
            }
            _ => Reach::Many,
        }
    }

    /// Adds the first `count` of sixteen pixels, covered in one of their samples (with the number
    /// of samples), except pixels outside the picture.
    #[inline(always)]
    pub(crate) fn add_first<S: Simd>(
        &mut self,
        reach: &Reach,
        (pixels, sample): (&Pixels<S>, (usize, usize)),
        count: usize,
    ) {
        let Pixels { x, y, .. } = *pixels;
        // The common case: all hits go to one tile, and no lane has to be masked out.
        if let Reach::One(tile) = *reach {
            let place = lanes_place(x & (TILE - 1), y & (TILE - 1), sample).bitcast();
            self.page(tile).add_first(place, pixels, count);
        } else {
            let covered = mask32x16::from_bitmask(x.simd, (1 << count) - 1);
            self.add(reach, (pixels, sample), covered);
        }
    }

    /// Adds the pixels, of sixteen, that are covered in one of their samples (with the number of
    /// samples) and inside the picture.
    #[inline(always)]
    pub(crate) fn add<S: Simd>(
        &mut self,
        reach: &Reach,
        (pixels, sample): (&Pixels<S>, (usize, usize)),
        covered: mask32x16<S>,
    ) {
        let Pixels { x, y, .. } = *pixels;
        let place = lanes_place(x & (TILE - 1), y & (TILE - 1), sample).bitcast();
        let (column, row) = (x >> 6, y >> 6);
        let [width, height] = self.extent;
        match *reach {
            Reach::One(tile) => self.page(tile).add(place, pixels, covered),
            // A few tiles: the mask of each tile is compressed separately.
            Reach::Few(tiles) => {
                let covered = covered & x.simd_lt(width) & y.simd_lt(height);
                for own_row in tiles.top..tiles.bottom {
                    for own_column in tiles.left..tiles.right {
                        let some = covered & row.simd_eq(own_row) & column.simd_eq(own_column);
                        if some.any_true() {
                            let tile = (own_row * self.tiles[0] + own_column) as usize;
                            self.page(tile).add(place, pixels, some);
                        }
                    }
                }
            }
            // Many tiles: one pixel at a time, because most masks would be nearly empty.
            Reach::Many => {
                let inside = x.simd_ge(0) & y.simd_ge(0) & x.simd_lt(width) & y.simd_lt(height);
                let tile = row * self.tiles[0] + column;
                for lane in Bits((covered & inside).to_bitmask()) {
                    let page = self.page(tile[lane] as usize);
                    let at = page.count;
                    page.place[at] = place[lane];
                    page.word[at] = word(pixels.depth[lane], pixels.number[lane]);
                    page.count = at + 1;
                }
            }
        }
    }

    /// Returns a page of a tile with room for sixteen hits.
    #[inline(always)]
    fn page(&mut self, tile: usize) -> &mut Page {
        let page = self.last[tile] as usize;
        // Compressing stores write sixteen numbers, however few are new.
        if self.pages[page].count > PAGE - PACK {
            return self.turn(tile);
        }
        &mut self.pages[page]
    }

    /// Starts a new page for a tile.
    #[cold]
    #[inline(never)]
    fn turn(&mut self, tile: usize) -> &mut Page {
        // Pages of earlier frames are reused first.
        if self.used == self.pages.len() {
            self.pages.push(Page::new(0));
        }
        let new = u32::try_from(self.used).expect("fewer than 2^32 pages");
        let page = &mut self.pages[self.used];
        page.count = 0;
        page.previous = std::mem::replace(&mut self.last[tile], new);
        self.used += 1;
        page
    }

    /// Calls `take` with the index and entry of each hit in a tile.
    #[inline(always)]
    pub(crate) fn each<S: Simd>(
        &self,
        (format, simd): (Format, S),
        tile: usize,
        mut take: impl FnMut(u32, u64),
    ) {
        let mut page = self.last[tile];
        while page != FULL {
            let Page { place, word, count, previous } = &self.pages[page as usize];
            // Fetched while this page is read.
            self.pages[*previous as usize].prefetch();
            if format.keeps_bits() {
                place[..*count].iter().zip(word).for_each(
                    #[inline(always)]
                    |(place, word)| take(*place, *word),
                );
            } else {
                // Hits store the bits of depths. Other formats convert them here, where each is
                // read once.
                for (places, words) in place[..*count].chunks(PACK).zip(word.as_chunks::<PACK>().0)
                {
                    let (depth, number) = keys_and_numbers(simd, words);
                    let lines = (number >> 31) * format.lines_nearer();
                    let keys = format.keys(depth.bitcast()) + lines;
                    let mut words = [0; PACK];
                    put_words(keys, number, &mut words);
                    places.iter().zip(words).for_each(
                        #[inline(always)]
                        |(place, word)| take(*place, word),
                    );
                }
            }
            page = *previous;
        }
    }
}
