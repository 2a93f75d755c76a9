//! Small triangles that wait for the tiles they reach into.
//!
//! With several samples per pixel, hits take more memory than the triangles themselves. A triangle
//! of ten pixels has about forty hits of twelve bytes, which would be written during setup and read
//! from a distant cache when tiles are drawn. Triangles of more than a few pixels are therefore
//! binned by tile instead, and rasterised when their tile is drawn. Near their tile, 16 bits tell
//! a coordinate, which matters because a million triangles do not fit in a near cache.

use fearless_simd::{Select as _, Simd, SimdBase as _, SimdMask as _, i32x16, mask32x16};
use prefetch_index::prefetch_index;

use super::hits::PACK;
use super::queue::{Pack, SMALL};
use crate::screen::coverage::{PixelBox, SUBPIXELS};
use crate::screen::tiles::TILE;
use crate::simd::Bits;
use marraztu_core::base::math::each;

/// The number of sizes of bounding boxes.
pub(super) const SIZES: usize = SMALL.len();

/// Returns the first size of bounding boxes in [`SMALL`] that waits for tiles. With four samples
/// and the next smaller size, a model of a million triangles takes 1.1 times as long, and no model
/// gets faster. With sixteen samples, even the hits of one pixel take more memory than a triangle.
const fn first_size(samples: usize) -> usize {
    match samples {
        1 => SIZES,
        4 => 3,
        _ => 0,
    }
}

/// The number of triangles in a page.
const PAGE: usize = 64;

/// A sentinel page that is never written: it counts as full, and ends every chain.
const FULL: u32 = 0;

/// The largest number of tiles for which sixteen triangles are added tile by tile.
const FEW_TILES: i64 = 6;

/// The numbers stored per triangle: its corners, their depths, the triangle's number.
const ROWS: usize = 7;

/// Sixteen triangles, row by row. See [`packed`].
pub(super) type Packed<S> = [i32x16<S>; ROWS];

/// A page of triangles of one tile and size, with room for sixteen more.
#[derive(Clone, Debug)]
#[repr(align(64))]
struct Page {
    rows: [[i32; PAGE + PACK]; ROWS],
    count: usize,
    /// The page before this one, or [`FULL`].
    previous: u32,
}

impl Page {
    const fn new(count: usize) -> Self {
        Self { rows: [[0; PAGE + PACK]; ROWS], count, previous: FULL }
    }

    /// Prefetches sixteen triangles.
    #[inline(always)]
    fn prefetch(&self, at: usize) {
        self.rows.iter().for_each(|row| prefetch_index(row.as_slice(), at));
    }
}

/// The tiles that each of sixteen triangles reaches into: the first column and row, and the last.
pub(crate) type TileBoxes<S> = [i32x16<S>; 4];

/// The waiting triangles set up by one thread.
#[derive(Debug)]
pub(crate) struct TileQueues {
    /// The first size of triangles that wait for tiles.
    pub(crate) first_size: usize,
    /// The columns and rows of tiles.
    tiles: [i32; 2],
    /// The last page of each tile and size.
    last: Vec<[u32; SIZES]>,
    #[expect(clippy::vec_box, reason = "a list that grows would copy hundreds of megabytes")]
    pages: Vec<Box<Page>>,
    /// The number of pages in use.
    handed_out: usize,
}

impl Default for TileQueues {
    fn default() -> Self {
        let pages = vec![Box::new(Page::new(PAGE))];
        Self { first_size: SIZES, tiles: [0; 2], last: Vec::new(), pages, handed_out: 1 }
    }
}

impl TileQueues {
    /// Removes all triangles, for a picture of this many columns and rows of tiles and this many
    /// samples per pixel.
    pub(crate) fn clear(&mut self, tiles: [i32; 2], samples: usize) {
        (self.tiles, self.first_size, self.handed_out) = (tiles, first_size(samples), 1);
        let count = if self.first_size < SIZES { tiles[0] * tiles[1] } else { 0 };
        self.last.clear();
        self.last.resize(usize::try_from(count).expect("not negative"), [FULL; SIZES]);
    }

    /// Returns whether a tile has no waiting triangles.
    pub(crate) fn is_empty(&self, tile: usize) -> bool {
        self.last.get(tile).is_none_or(|last| *last == [FULL; SIZES])
    }

    /// Returns the tiles of sixteen boxes of pixels (left, top, right, bottom), which may reach
    /// beyond the picture.
    #[inline(always)]
    pub(crate) fn boxes<S: Simd>(
        &self,
        [left, top, right, bottom]: [i32x16<S>; 4],
    ) -> TileBoxes<S> {
        let [columns, rows] = self.tiles;
        [
            (left >> 6).max(0),
            (top >> 6).max(0),
            ((right - 1) >> 6).min(columns - 1),
            ((bottom - 1) >> 6).min(rows - 1),
        ]
    }

    /// Adds the triangles of a mask, out of sixteen, to every tile they reach into.
    #[inline(always)]
    pub(crate) fn add<S: Simd>(
        &mut self,
        size: usize,
        (pack, boxes): (&Packed<S>, &TileBoxes<S>),
        some: mask32x16<S>,
    ) {
        let all = self.reach(boxes, some);
        let columns = self.tiles[0];
        // The common case: all sixteen reach into a single tile.
        if (all.width(), all.height()) == (1, 1) {
            return self.add_to((all.top * columns + all.left) as usize, size, pack, some);
        }
        // For scattered triangles, the masks of most tiles would be nearly empty.
        if i64::from(all.width()) * i64::from(all.height()) > FEW_TILES {
            return self.add_one_by_one(size, (pack, boxes), some.to_bitmask());
        }
        // A few tiles: each gets its share by a mask.
        for row in all.top..all.bottom {
            for column in all.left..all.right {
                let [left, top, right, bottom] = *boxes;
                let in_column = left.simd_le(column) & right.simd_ge(column);
                let own = some & in_column & top.simd_le(row) & bottom.simd_ge(row);
                if own.any_true() {
                    self.add_to((row * columns + column) as usize, size, pack, own);
                }
            }
        }
    }

    /// Returns the tiles that some of sixteen triangles reach into.
    #[inline(always)]
    fn reach<S: Simd>(
        &self,
        [left, top, right, bottom]: &TileBoxes<S>,
        some: mask32x16<S>,
    ) -> PixelBox {
        let [columns, rows] = self.tiles;
        let simd = left.simd;
        let (none, columns, rows) =
            (i32x16::splat(simd, -1), i32x16::splat(simd, columns), i32x16::splat(simd, rows));
        // Lanes outside the mask are replaced by values that change no minimum or maximum.
        PixelBox {
            left: some.select(*left, columns).reduce_min(),
            top: some.select(*top, rows).reduce_min(),
            right: some.select(*right, none).reduce_max() + 1,
            bottom: some.select(*bottom, none).reduce_max() + 1,
        }
    }

    #[inline(never)]
    fn add_one_by_one<S: Simd>(
        &mut self,
        size: usize,
        (pack, boxes): (&Packed<S>, &TileBoxes<S>),
        some: u64,
    ) {
        let pack = pack.map(<[i32; PACK]>::from);
        let [left, top, right, bottom] = boxes.map(<[i32; PACK]>::from);
        // Widely scattered triangles: one at a time, into every tile of its box.
        for lane in Bits(some) {
            for row in top[lane]..=bottom[lane] {
                for column in left[lane]..=right[lane] {
                    let page = self.page((row * self.tiles[0] + column) as usize, size);
                    for (to, from) in page.rows.iter_mut().zip(&pack) {
                        to[page.count] = from[lane];
                    }
                    page.count += 1;
                }
            }
        }
    }

    #[inline(always)]
    fn add_to<S: Simd>(&mut self, tile: usize, size: usize, pack: &Packed<S>, some: mask32x16<S>) {
        let page = self.page(tile, size);
        let at = page.count;
        // A compressing store writes sixteen numbers; a page has room for its overflow.
        for (row, values) in page.rows.iter_mut().zip(pack) {
            values.compress(some).store_slice(&mut row[at..at + PACK]);
        }
        page.count = at + some.to_bitmask().count_ones() as usize;
    }

    /// Returns the first pixel of a tile, in subpixels.
    #[inline(always)]
    fn corner(&self, tile: usize) -> [i32; 2] {
        let (tile, columns) = (i32::try_from(tile).unwrap_or(0), self.tiles[0].max(1));
        [tile % columns, tile / columns].map(|at| at * TILE * SUBPIXELS)
    }

    /// Returns a page of a tile and size with room for sixteen triangles.
    #[inline(always)]
    fn page(&mut self, tile: usize, size: usize) -> &mut Page {
        let page = self.last[tile][size] as usize;
        if self.pages[page].count >= PAGE {
            return self.turn(tile, size);
        }
        &mut self.pages[page]
    }

    /// Starts a new page of a tile and size with the overflow of the page before.
    #[cold]
    #[inline(never)]
    fn turn(&mut self, tile: usize, size: usize) -> &mut Page {
        // Pages of earlier frames are reused first.
        if self.handed_out == self.pages.len() {
            self.pages.push(Box::new(Page::new(0)));
        }
        let new = self.handed_out;
        let previous = self.last[tile][size];
        self.last[tile][size] = u32::try_from(new).expect("fewer than 2^32 pages");
        self.handed_out += 1;
        let (before, after) = self.pages.split_at_mut(new);
        let (full, page) = (&mut before[previous as usize], &mut after[0]);
        // The overflow of the full page moves to the new one.
        for (to, from) in page.rows.iter_mut().zip(&full.rows) {
            to[..PACK].copy_from_slice(&from[PAGE..]);
        }
        (page.count, page.previous) = (full.count - PAGE, previous);
        full.count = PAGE;
        page
    }

    /// Calls `take` with the triangles of a tile and size, sixteen at a time; the last pack may be
    /// shorter.
    #[inline(always)]
    pub(super) fn each<S: Simd>(
        &self,
        simd: S,
        tile: usize,
        size: usize,
        mut take: impl FnMut(&Pack<S>, usize),
    ) {
        let mut page = self.last.get(tile).map_or(FULL, |last| last[size]);
        let corner = self.corner(tile);
        while page != FULL {
            let Page { rows, count, previous } = &*self.pages[page as usize];
            let next = &self.pages[*previous as usize];
            for at in (0..*count).step_by(PACK) {
                let mut packed = [i32x16::splat(simd, 0); ROWS];
                for (values, row) in packed.iter_mut().zip(rows) {
                    *values = i32x16::from_slice(simd, &row[at..at + PACK]);
                }
                // Fetched while these are drawn.
                next.prefetch(at);
                take(&unpacked(packed, corner), (count - at).min(PACK));
            }
            page = *previous;
        }
    }
}

/// Packs triangles: a corner is the lower half of x, and that of y above it.
#[inline(always)]
pub(super) fn packed<S: Simd>(pack: &Pack<S>) -> Packed<S> {
    let [x0, y0, x1, y1, x2, y2, d0, d1, d2, number] = *pack;
    let [a, b, c] = each(
        [[x0, y0], [x1, y1], [x2, y2]],
        #[inline(always)]
        |[x, y]| (x & 0xffff) | (y << 16),
    );
    [a, b, c, d0, d1, d2, number]
}

/// Unpacks triangles of the tile with this first pixel, in subpixels. No corner is more than a box
/// away from the tile, so the lower half tells the distance.
#[inline(always)]
fn unpacked<S: Simd>(rows: Packed<S>, [left, top]: [i32; 2]) -> Pack<S> {
    let [a, b, c, d0, d1, d2, number] = rows;
    // The arithmetic shifts restore the sign of the distance.
    let [[x0, y0], [x1, y1], [x2, y2]] = each(
        [a, b, c],
        #[inline(always)]
        |corner| [(((corner - left) << 16) >> 16) + left, ((corner - (top << 16)) >> 16) + top],
    );
    [x0, y0, x1, y1, x2, y2, d0, d1, d2, number]
}

#[cfg(test)]
mod tests {
    use crate::simd::dispatch;
    use fearless_simd::Level;

    use super::*;
    use marraztu_core::base::rng::Rng;

    #[test]
    fn every_triangle_waits_in_each_tile_that_its_box_reaches_into_and_nowhere_else() {
        let mut rng = Rng::new(11);
        let mut random = |below: i32| rng.between(0, below - 1);
        let mut queues = TileQueues::default();
        for round in 0..30 {
            let [columns, rows] = [1 + random(5), 1 + random(5)];
            queues.clear([columns, rows], 16);
            let mut want = vec![vec![Vec::new(); SIZES]; (columns * rows).cast_unsigned() as usize];
            let mut all = Vec::new();
            for first in (0..400).step_by(PACK) {
                // Close together, or spread over the picture and beyond.
                let spread = if round % 2 == 0 { 40 } else { 64 * 6 };
                let at = [random(64 * columns), random(64 * rows)];
                let mut boxes = [[0; PACK]; 4];
                let size = random(i32::try_from(SIZES).unwrap()).cast_unsigned() as usize;
                let mut some = 0;
                for lane in 0..PACK {
                    let [x, y] = at.map(|at| at + random(spread) - spread / 2);
                    let (right, bottom) = (x + 1 + random(16), y + 1 + random(16));
                    for (row, side) in boxes.iter_mut().zip([x, y, right, bottom]) {
                        row[lane] = side;
                    }
                    let seen = right > 0 && bottom > 0 && x < 64 * columns && y < 64 * rows;
                    if !seen || random(4) == 0 {
                        continue;
                    }
                    some |= 1 << lane;
                    for tile in 0..columns * rows {
                        let (left, top) = (tile % columns * 64, tile / columns * 64);
                        if x < left + 64 && right > left && y < top + 64 && bottom > top {
                            let own = &mut want[tile.cast_unsigned() as usize][size];
                            own.push(first + i32::try_from(lane).unwrap());
                        }
                    }
                }
                // Corners at the corners of the box, and depths that differ.
                let lanes: [_; PACK] = std::array::from_fn(|lane| lane);
                let rows = lanes.map(|lane| {
                    let [left, top, right, bottom] = boxes.map(|row| row[lane] * SUBPIXELS);
                    let number = first + i32::try_from(lane).unwrap();
                    let depths = [number + 1000, number + 2000, number + 3000];
                    [left, top, right, top, right, bottom, depths[0], depths[1], depths[2], number]
                });
                all.extend(rows);
                dispatch!(Level::new(), simd => {
                    let pack: Pack<_> = std::array::from_fn(|row| {
                        i32x16::from_slice(simd, &rows.map(|triangle| triangle[row]))
                    });
                    let boxes = boxes.map(|row| i32x16::from_slice(simd, &row));
                    let boxes = queues.boxes(boxes);
                    let some = mask32x16::from_bitmask(simd, some);
                    queues.add(size, (&packed(&pack), &boxes), some);
                });
            }
            for (tile, sizes) in want.iter().enumerate() {
                assert_eq!(queues.is_empty(tile), sizes.iter().all(Vec::is_empty));
                for (size, want) in sizes.iter().enumerate() {
                    let mut got = Vec::new();
                    dispatch!(Level::new(), simd => queues.each(simd, tile, size, |pack, count| {
                        let pack = pack.map(<[i32; PACK]>::from);
                        for lane in 0..count {
                            let number = pack[9][lane];
                            let added = all[number.cast_unsigned() as usize];
                            assert_eq!(pack.map(|row| row[lane]), added);
                            got.push(number);
                        }
                    }));
                    got.sort_unstable();
                    assert_eq!(got, *want, "{columns} x {rows}, tile {tile}");
                }
            }
        }
    }
}
