//! What is seen at each pixel of a tile.
//!
//! One word of 64 bits a pixel: the bits of the depth above, the inverted number of the primitive
//! below. The larger word wins: what is nearer, and among what is equally near the primitive with the
//! lower number, that is of the older object, the earlier face. The order in which primitives are
//! drawn cannot show, so it is nobody's concern.
//!
//! Which pixels a triangle covers, and how near it is there, is computed in one of two ways, chosen
//! by the triangle's own size alone: in f32 for boxes up to 8 x 8, where whole numbers below 2^24 are
//! exact, sixteen triangles at once (`small`); and in 64 bits for all others, a block of 8 x 8 pixels
//! at once (`large`). So neither tiles nor threads nor instructions show in the picture.
//!
//! A block that nothing reaches is never touched, and one that a single large triangle covers is not
//! asked for its depths: that it is covered is all that is noted, until something else comes near.

use fearless_simd::{Level, Simd, dispatch, i32x16};

use super::bins::{Bins, LargeTriangle};
use super::coverage::{PixelBox, Triangle};
use super::frame::Frame;
use super::large::Large;
use super::lines::{self, LineNumber};
use super::plan::FramePlan;
use super::texels;
use crate::base::math::each;

/// Pixels to a side of a tile.
pub(super) const TILE_SIDE: usize = 64;
/// The same, as coordinates are kept.
pub(super) const TILE: i32 = 64;
/// Pixels to a side of a block.
pub(super) const BLOCK: i32 = 8;
/// Pixels of a block.
pub(super) const BLOCK_PIXELS: usize = 64;
/// Blocks in a row of a tile.
const BLOCKS: i32 = TILE / BLOCK;
/// Pixels of a tile.
const PIXELS: usize = TILE_SIDE * TILE_SIDE;

/// What is seen at a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Seen {
    /// Nothing.
    Background,
    /// A triangle, by its number in the frame.
    Triangle(u32),
    /// A line, by its number in the frame and its colour.
    Line(LineNumber),
}

/// What a word says is seen.
#[inline(always)]
#[expect(clippy::cast_possible_truncation, reason = "the lower half is meant")]
pub(super) const fn seen(word: u64) -> Seen {
    let number = !(word as u32);
    match LineNumber::of(number) {
        _ if word == 0 => Seen::Background,
        Some(line) => Seen::Line(line),
        None => Seen::Triangle(number),
    }
}

/// What a word says of the depth: its bits, where it is kept as mostly.
pub(super) const fn key(word: u64) -> u32 {
    (word >> 32) as u32
}

#[inline(always)]
fn word(depth: f32, number: u32) -> u64 {
    u64::from(depth.to_bits()) << 32 | u64::from(!number)
}

/// The words of one tile, block by block, each block row by row.
#[derive(Debug)]
pub(super) struct Visibility {
    words: Box<[u64; PIXELS]>,
    /// The blocks whose words are written, a bit for each.
    written: u64,
    /// The blocks that are known to show one triangle, and have no words yet.
    whole: u64,
    /// What they show, as places in `large`.
    shown: [u32; BLOCK_PIXELS],
    /// Triangles that cover a block as a whole.
    large: Vec<Large>,
    /// For each block a depth that all of its pixels are at least as near as.
    farthest: [f32; BLOCK_PIXELS],
    /// For each block that shows one triangle a depth that no pixel is nearer than.
    nearest: [f32; BLOCK_PIXELS],
    bounds: PixelBox,
}

impl Default for Visibility {
    fn default() -> Self {
        Self {
            words: Box::new([0; PIXELS]),
            written: 0,
            whole: 0,
            shown: [0; BLOCK_PIXELS],
            large: Vec::new(),
            farthest: [0.0; BLOCK_PIXELS],
            nearest: [0.0; BLOCK_PIXELS],
            bounds: PixelBox { left: 0, top: 0, right: 0, bottom: 0 },
        }
    }
}

impl Visibility {
    /// Looks at everything that reaches into a tile: the bins of every thread at this place.
    pub(super) fn draw(
        &mut self,
        level: Level,
        plan: &FramePlan,
        frame: &Frame,
        (tile, bounds): (usize, PixelBox),
    ) {
        self.clear(bounds);
        if plan.ways.draws_one_by_one() {
            return self.draw_one_by_one(plan, frame, (tile, bounds));
        }
        for bins in frame.bins() {
            dispatch!(level, simd => self.draw_plain(simd, bins, tile));
        }
        for bins in frame.bins() {
            dispatch!(level, simd => self.draw_hits(simd, bins, tile));
            for &number in &bins.tiles[tile].large {
                let large = &bins.large[number as usize];
                if large.cutout {
                    self.draw_cutout(level, plan, frame, large);
                }
            }
            dispatch!(level, simd => self.draw_lines(simd, bins, plan.line_width, tile));
        }
    }

    /// Draws everything by a rare way, pixel by pixel.
    fn draw_one_by_one(
        &mut self,
        plan: &FramePlan,
        frame: &Frame,
        (tile, bounds): (usize, PixelBox),
    ) {
        self.words.fill(0);
        self.written = u64::MAX;
        plan.ways.paint(plan, frame, (tile, bounds), &mut |[x, y], key, number| {
            let word = &mut self.words[place(x, y)];
            *word = (u64::from(key) << 32 | u64::from(!number)).max(*word);
        });
    }

    fn clear(&mut self, bounds: PixelBox) {
        (self.written, self.whole) = (0, 0);
        self.large.clear();
        self.farthest.fill(0.0);
        self.bounds = bounds;
    }

    /// Whether a block shows anything; `block` counts along rows of blocks.
    pub(super) const fn shows(&self, block: usize) -> bool {
        (self.written | self.whole) >> block & 1 != 0
    }

    /// Whether no block shows anything.
    pub(super) const fn is_empty(&self) -> bool {
        self.written | self.whole == 0
    }

    /// The triangle that a block shows, where one is known to cover it as a whole; its words are of
    /// no meaning then.
    pub(super) fn whole(&self, block: usize) -> Option<u32> {
        (self.whole >> block & 1 != 0).then(|| self.large[self.shown[block] as usize].number)
    }

    /// The blocks that one triangle is known to cover as a whole, a bit for each.
    pub(super) const fn whole_blocks(&self) -> u64 {
        self.whole
    }

    /// The words of a block that shows something, row by row.
    pub(super) fn block(&self, block: usize) -> &[u64; BLOCK_PIXELS] {
        &self.words.as_chunks().0[block]
    }

    /// A depth that nothing of any triangle of the tile is farther than, and one that nothing is
    /// nearer than; `None` where no triangle is seen.
    pub(super) fn depths(&self, level: Level) -> Option<[f32; 2]> {
        // Depths are not negative, so that their bits are in the order of the numbers.
        let (mut low, mut high) = (u32::MAX, 0);
        for block in (0..BLOCK_PIXELS).filter(|block| self.shows(*block)) {
            let [own_low, own_high] = if self.whole(block).is_some() {
                [self.farthest[block].to_bits(), self.nearest[block].to_bits()]
            } else {
                dispatch!(level, simd => depths_of(simd, self.block(block)))
            };
            (low, high) = (low.min(own_low), high.max(own_high));
        }
        (low <= high).then_some([low, high].map(f32::from_bits))
    }

    /// The upper left pixel of a block.
    pub(super) fn corner(&self, block: usize) -> [i32; 2] {
        let at = i32::try_from(block).expect("a tile has few blocks");
        [self.bounds.left + at % BLOCKS * BLOCK, self.bounds.top + at / BLOCKS * BLOCK]
    }

    /// The word of a pixel of the tile.
    pub(super) fn word(&mut self, level: Level, x: i32, y: i32) -> u64 {
        let place = place(x - self.bounds.left, y - self.bounds.top);
        if !self.shows(place / BLOCK_PIXELS) {
            return 0;
        }
        dispatch!(level, simd => self.write(simd, place / BLOCK_PIXELS));
        self.words[place]
    }

    /// Sees to it that a block has words.
    #[inline(always)]
    fn write<S: Simd>(&mut self, simd: S, block: usize) {
        let bit = 1 << block;
        if self.written & bit == 0 {
            self.written |= bit;
            let words = block_of(&mut self.words, block);
            words.fill(0);
            if self.whole & bit != 0 {
                self.whole &= !bit;
                self.large[self.shown[block] as usize].draw(simd, block, true, words);
            }
        }
    }

    #[inline(always)]
    fn put<S: Simd>(&mut self, simd: S, x: i32, y: i32, depth: f32, number: u32) {
        let place = place(x - self.bounds.left, y - self.bounds.top);
        self.write(simd, place / BLOCK_PIXELS);
        self.words[place] = self.words[place].max(word(depth, number));
    }

    /// Draws the lines of a tile that are not short.
    #[inline(always)]
    fn draw_lines<S: Simd>(&mut self, simd: S, bins: &Bins, width: i32, tile: usize) {
        for &place in &bins.tiles[tile].lines {
            let line = &bins.lines[place as usize];
            lines::pixels(
                line,
                width,
                self.bounds,
                #[inline(always)]
                |x, y, depth| self.put(simd, x, y, depth, line.number),
            );
        }
    }

    fn draw_cutout(
        &mut self,
        level: Level,
        plan: &FramePlan,
        frame: &Frame,
        large: &LargeTriangle,
    ) {
        let corners = each(large.corners, |corner| corner.at());
        let Some(triangle) = Triangle::new(corners) else { return };
        let seen = Large::new(large, &triangle, [self.bounds.left, self.bounds.top]);
        triangle.covered(self.bounds, |pixel| {
            if texels::is_opaque(plan, frame, large.number, [pixel.x, pixel.y]) {
                let depth = seen.depth(pixel.edges);
                dispatch!(level, simd => self.put(simd, pixel.x, pixel.y, depth, large.number));
            }
        });
    }

    /// Draws the small triangles of a tile, and lines that are short.
    #[inline(always)]
    fn draw_hits<S: Simd>(&mut self, simd: S, bins: &Bins, tile: usize) {
        bins.hits.each(
            tile,
            #[inline(always)]
            |place, depth, number| {
                let place = place as usize % PIXELS;
                if self.written >> (place / BLOCK_PIXELS) & 1 == 0 {
                    self.write(simd, place / BLOCK_PIXELS);
                }
                let word = u64::from(depth) << 32 | u64::from(!number);
                self.words[place] = self.words[place].max(word);
            },
        );
    }

    /// Draws the large triangles of a tile whose textures have no part in where they are.
    #[inline(always)]
    fn draw_plain<S: Simd>(&mut self, simd: S, bins: &Bins, tile: usize) {
        for &number in &bins.tiles[tile].large {
            let large = &bins.large[number as usize];
            if !large.cutout {
                self.draw_large(simd, large);
            }
        }
    }

    #[inline(always)]
    fn draw_large<S: Simd>(&mut self, simd: S, large: &LargeTriangle) {
        let Some(triangle) = Triangle::new(each(large.corners, |corner| corner.at())) else {
            return;
        };
        let area = triangle.bounds().intersection(self.bounds);
        if area.is_empty() {
            return;
        }
        let (left, top) = (self.bounds.left, self.bounds.top);
        let large = Large::new(large, &triangle, [left, top]);
        let area = PixelBox {
            left: area.left - left,
            top: area.top - top,
            right: area.right - left,
            bottom: area.bottom - top,
        };
        let touched = large.blocks(simd, area);
        let mut some = touched.some;
        let mut place = None;
        while some != 0 {
            let block = some.trailing_zeros() as usize;
            some &= some - 1;
            if large.high < self.farthest[block] {
                continue;
            }
            if touched.whole >> block & 1 != 0 {
                self.draw_whole(simd, &large, block, &mut place);
            } else {
                self.write(simd, block);
                large.draw(simd, block, false, block_of(&mut self.words, block));
            }
        }
    }

    /// Draws a triangle into a block that it covers; `place` is where it stands among those that do.
    #[inline(always)]
    fn draw_whole<S: Simd>(
        &mut self,
        simd: S,
        large: &Large,
        block: usize,
        place: &mut Option<u32>,
    ) {
        let [low, high] = large.depths(block);
        if high < self.farthest[block] {
            return;
        }
        let bit = 1 << block;
        let alone = (self.written | self.whole) & bit == 0;
        if alone || (self.whole & bit != 0 && low > self.nearest[block]) {
            self.shown[block] = *place.get_or_insert_with(|| {
                self.large.push(*large);
                u32::try_from(self.large.len() - 1).expect("fewer than 2^32 triangles")
            });
            self.whole |= bit;
            self.nearest[block] = high;
        } else {
            self.write(simd, block);
            large.draw(simd, block, true, block_of(&mut self.words, block));
        }
        self.farthest[block] = self.farthest[block].max(low);
    }
}

/// The bits of the least and of the largest depth of the triangles among some words.
#[inline(always)]
#[expect(clippy::cast_possible_truncation, reason = "the lower half is meant")]
fn depths_of<S: Simd>(_: S, words: &[u64; BLOCK_PIXELS]) -> [u32; 2] {
    let (mut low, mut high) = (u32::MAX, 0);
    for word in words {
        let depth = (*word >> 32) as u32;
        // The numbers of lines are the upper half of all; the background has the lowest word.
        let is_triangle = *word as u32 >> 31 == 1;
        low = low.min(if is_triangle { depth } else { u32::MAX });
        high = high.max(if is_triangle { depth } else { 0 });
    }
    [low, high]
}

/// The words of a block.
#[inline(always)]
fn block_of(words: &mut [u64; PIXELS], block: usize) -> &mut [u64; BLOCK_PIXELS] {
    &mut words.as_chunks_mut().0[block]
}

/// The column and row of the tile whose word stands at a place.
#[expect(clippy::cast_possible_truncation, reason = "a tile has 4096 pixels")]
pub(super) const fn column_and_row(place: usize) -> [i32; 2] {
    let (block, pixel) = ((place / BLOCK_PIXELS) as i32, (place % BLOCK_PIXELS) as i32);
    [block % BLOCKS * BLOCK + pixel % BLOCK, block / BLOCKS * BLOCK + pixel / BLOCK]
}

/// Where the word of a pixel stands, by column and row of the tile.
#[inline(always)]
const fn place(x: i32, y: i32) -> usize {
    ((y / BLOCK * BLOCKS + x / BLOCK) * BLOCK * BLOCK + y % BLOCK * BLOCK + x % BLOCK) as usize
}

/// The same for sixteen pixels.
#[inline(always)]
pub(super) fn lanes_place<S: Simd>(x: i32x16<S>, y: i32x16<S>) -> i32x16<S> {
    ((y >> 3) << 9) + ((x >> 3) << 6) + ((y & 7) << 3) + (x & 7)
}

#[cfg(test)]
mod tests {
    use fearless_simd::SimdBase as _;

    use super::*;
    use crate::base::image::Size;
    use crate::render::clip::ScreenVertex;
    use crate::render::coverage::Snapped;
    use crate::render::small::{self, ROWS, SMALL};

    const SIZE: Size = Size { width: 150, height: 140 };
    const PICTURE: PixelBox = PixelBox { left: 0, top: 0, right: 150, bottom: 140 };

    /// Numbers that look random.
    fn numbers(mut state: u64) -> impl FnMut(i32) -> i32 {
        move |below| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            ((state >> 33) % below.cast_unsigned() as u64) as i32
        }
    }

    fn bins() -> Bins {
        let mut bins = Bins::default();
        bins.clear(SIZE);
        bins
    }

    /// The bins with some small triangles, sixteen at the most.
    fn small(triangles: &[[Snapped; 3]]) -> Bins {
        let mut rows = [[0; 16]; ROWS];
        for ((lane, corners), number) in triangles.iter().enumerate().zip(0..) {
            for (i, corner) in corners.iter().enumerate() {
                (rows[2 * i][lane], rows[2 * i + 1][lane]) = (corner.x, corner.y);
                rows[6 + i][lane] = 0.5_f32.to_bits().cast_signed();
            }
            rows[9][lane] = number;
        }
        let mut bins = bins();
        dispatch!(Level::new(), simd => {
            let mut pack = [i32x16::splat(simd, 0); ROWS];
            for (row, values) in rows.iter().zip(&mut pack) {
                *values = i32x16::from_slice(simd, row);
            }
            small::draw(simd, &pack, &mut bins);
        });
        bins
    }

    /// The pixels that show the primitive with the number 0, row by row.
    fn seen_in(bins: &Bins) -> Vec<(i32, i32)> {
        let mut visibility = Visibility::default();
        let mut pixels = Vec::new();
        for tile in 0..9 {
            let (left, top) = (tile % 3 * TILE, tile / 3 * TILE);
            let own = PixelBox { left, top, right: left + TILE, bottom: top + TILE };
            let own = own.intersection(PICTURE);
            visibility.clear(own);
            dispatch!(Level::new(), simd => {
                visibility.draw_plain(simd, bins, tile as usize);
                visibility.draw_hits(simd, bins, tile as usize);
            });
            for (x, y) in (top..own.bottom).flat_map(|y| (left..own.right).map(move |x| (x, y))) {
                if seen(visibility.word(Level::new(), x, y)) == Seen::Triangle(0) {
                    pixels.push((y, x));
                }
            }
        }
        pixels.sort_unstable();
        pixels
    }

    #[test]
    fn every_way_covers_the_pixels_that_the_rule_says() {
        let mut random = numbers(7);
        for extent in [1, 2, 4, 8, 30, 100] {
            for _ in 0..2000 {
                // Every second coordinate on a pixel's centre or border.
                let (left, top) = (random(158) - 8, random(148) - 8);
                let mut coordinate = |from: i32| {
                    let place = from * 256 + random(extent * 256);
                    if random(2) == 0 { place } else { place / 128 * 128 }
                };
                let corners =
                    [0, 1, 2].map(|_| Snapped { x: coordinate(left), y: coordinate(top) });
                let mut want = Vec::new();
                if let Some(triangle) = Triangle::new(corners) {
                    triangle.covered(PICTURE, |pixel| want.push((pixel.y, pixel.x)));
                }
                let bounds = PixelBox::of(corners);
                let side = bounds.width().max(bounds.height());
                if side <= SMALL[3] && !bounds.is_empty() {
                    let got = seen_in(&small(&[corners]));
                    assert_eq!(got, want, "{corners:?} alone");
                    // Others far away are drawn pixel by pixel, whatever the tile.
                    let far = [(2, 2), (140, 3), (4, 130), (141, 135)].map(|(x, y)| {
                        [(0, 0), (200, 0), (0, 200)]
                            .map(|(dx, dy)| Snapped { x: x * 256 + dx, y: y * 256 + dy })
                    });
                    let got = seen_in(&small(&[corners, far[0], far[1], far[2], far[3]]));
                    let nearer = |pixel: &(i32, i32)| !got.contains(pixel);
                    assert!(!want.iter().any(nearer), "{corners:?} among others");
                    assert_eq!(got.len(), want.len(), "{corners:?} among others");
                }
                let mut bins = bins();
                let corners = corners.map(|corner| ScreenVertex::new(corner, 0.5));
                bins.add_large(LargeTriangle { corners, number: 0, cutout: false }, bounds);
                assert_eq!(seen_in(&bins), want, "{corners:?} alone in 64 bits");
            }
        }
    }

    /// Squares that cover blocks as a whole, in few depths, some of them tilted.
    #[test]
    fn of_large_triangles_the_nearest_is_seen_and_of_equally_near_ones_the_older() {
        let mut random = numbers(5);
        for _ in 0..300 {
            let triangles: Vec<LargeTriangle> = (0..6)
                .map(|number| {
                    let depth = random(4) as f32 / 4.0;
                    let tilt = random(2) as f32 / 8.0;
                    let mut corner = |depth: f32| {
                        let [x, y] = [0, 0].map(|_| random(120) * 256 - 20 * 256);
                        ScreenVertex::new(Snapped { x, y }, depth)
                    };
                    let corners = [corner(depth), corner(depth), corner(depth + tilt)];
                    LargeTriangle { corners, number, cutout: false }
                })
                .collect();
            let mut want = vec![0; PIXELS];
            let tile = PixelBox { left: 0, top: 0, right: TILE, bottom: TILE };
            let mut visibility = Visibility::default();
            visibility.clear(tile);
            for large in &triangles {
                dispatch!(Level::new(), simd => visibility.draw_large(simd, large));
                let corners = large.corners.map(|corner| corner.at());
                let Some(triangle) = Triangle::new(corners) else { continue };
                let seen = Large::new(large, &triangle, [0, 0]);
                triangle.covered(tile, |pixel| {
                    let word = word(seen.depth(pixel.edges), large.number);
                    let old = &mut want[place(pixel.x, pixel.y)];
                    *old = word.max(*old);
                });
            }
            for (x, y) in (0..TILE).flat_map(|y| (0..TILE).map(move |x| (x, y))) {
                let (block, pixel) = (place(x, y) / BLOCK_PIXELS, place(x, y) % BLOCK_PIXELS);
                let got = match visibility.whole(block) {
                    Some(number) => Seen::Triangle(number),
                    None if visibility.shows(block) => seen(visibility.block(block)[pixel]),
                    None => Seen::Background,
                };
                assert_eq!(got, seen(want[place(x, y)]), "{x}, {y}: {triangles:?}");
            }
            for (x, y) in (0..TILE).flat_map(|y| (0..TILE).map(move |x| (x, y))) {
                let got = visibility.word(Level::new(), x, y);
                assert_eq!(got, want[place(x, y)], "{x}, {y}: {triangles:?}");
            }
        }
    }
}
