//! Layers: the transparent triangles of a tile that are in front of what is opaque.
//!
//! Transparent triangles have bins of their own and hide nothing. Block by block, every pixel gets
//! the list of those that cover it in front of its entry in the visibility buffer, sorted from far
//! to near. So neither the order of objects nor of triangles shows, and triangles that cut through
//! each other change places at the pixel where they do. Of equal depths the lower number is in
//! front, as among opaque triangles: it belongs to the older object or is the earlier face.
//!
//! A list holds [`MOST`] layers. If a pixel has more, the farthest are taken first, and the block
//! is gathered again for the next, so memory is bounded whatever the number of layers.

use fearless_simd::{Level, Simd, dispatch};

use super::bins::{Bins, LargeTriangle};
use super::geometry::ScreenGeometry;
use super::large::{Large, Solid, Touched};
use super::pixel_by_pixel;
use crate::accuracy::Transparency;
use crate::base::math::each;
use crate::render::frame::FramePlan;
use crate::render::screen::coverage::{PixelBox, Triangle};
use crate::render::screen::sample_positions::{FOUR, SamplePositions};
use crate::render::screen::tiles::{BLOCK_PIXELS, block_at, within};

/// The layers of a pixel that are held at once.
const MOST: usize = 1024;
/// Those that are kept when they become more: the farthest.
const KEPT: usize = MOST / 2;

/// The layers of one tile, and of the block that was gathered last.
#[derive(Debug)]
pub(crate) struct Layers {
    sample_positions: SamplePositions,
    bounds: PixelBox,
    /// The blocks that any triangle touches, a bit for each.
    touched: u64,
    /// The pixels of small triangles, for each sample of each block: the pixel of the block and the
    /// word that the visibility buffer would hold.
    hits: Vec<Vec<(u8, u64)>>,
    large: Vec<(Large, Touched)>,
    /// The least and the largest depth.
    depths: [f32; 2],
    block: Held,
}

/// The layers of a block's pixels: row after row, the farthest first.
#[derive(Debug)]
struct Held {
    rows: Vec<[u64; BLOCK_PIXELS]>,
    counts: [usize; BLOCK_PIXELS],
    /// Keys up to these were taken before.
    floor: [u64; BLOCK_PIXELS],
    /// Keys above these are taken later.
    ceiling: [u64; BLOCK_PIXELS],
    /// The pixels that have such keys, a bit for each.
    more: u64,
}

impl Default for Held {
    fn default() -> Self {
        Self {
            rows: Vec::new(),
            counts: [0; BLOCK_PIXELS],
            floor: [0; BLOCK_PIXELS],
            ceiling: [u64::MAX; BLOCK_PIXELS],
            more: 0,
        }
    }
}

impl Default for Layers {
    fn default() -> Self {
        Self {
            sample_positions: SamplePositions::default(),
            bounds: PixelBox { left: 0, top: 0, right: 0, bottom: 0 },
            touched: 0,
            hits: vec![Vec::new(); FOUR * BLOCK_PIXELS],
            large: Vec::new(),
            depths: [f32::INFINITY, 0.0],
            block: Held::default(),
        }
    }
}

impl Layers {
    /// Begins a tile without any layers.
    pub(crate) fn begin_none(&mut self) {
        self.touched = 0;
    }

    /// Begins a tile: finds the blocks that its transparent triangles touch.
    pub(crate) fn begin(
        &mut self,
        level: Level,
        plan: &FramePlan,
        frame: &ScreenGeometry,
        (tile, bounds): (usize, PixelBox),
    ) {
        (self.sample_positions, self.bounds) = (frame.sample_positions(), bounds);
        (self.touched, self.depths) = (0, [f32::INFINITY, 0.0]);
        self.hits.iter_mut().for_each(Vec::clear);
        self.large.clear();
        for bins in frame.transparent_bins() {
            if plan.variants.draws_one_by_one() {
                self.add_one_by_one(plan, frame, bins, (tile, bounds));
                continue;
            }
            let samples = self.sample_positions.count();
            bins.hits.each(tile, |place, depth, number| {
                self.add_hit(place as usize, samples, u64::from(depth) << 32 | u64::from(!number));
            });
            for &number in &bins.tiles[tile].large {
                self.add_large(level, &bins.large[number as usize]);
            }
        }
    }

    /// Adds a pixel by its index in the visibility buffer.
    #[inline(always)]
    #[expect(clippy::cast_possible_truncation, reason = "the upper half is the depth")]
    fn add_hit(&mut self, place: usize, samples: usize, word: u64) {
        let (plane, pixel) = (place / BLOCK_PIXELS, place % BLOCK_PIXELS);
        self.touched |= 1 << (plane / samples);
        let depth = f32::from_bits((word >> 32) as u32);
        self.depths = [self.depths[0].min(depth), self.depths[1].max(depth)];
        self.hits[plane].push((pixel as u8, word));
    }

    fn add_large(&mut self, level: Level, triangle: &LargeTriangle) {
        let corners = each(triangle.corners, |corner| corner.at());
        let reach = match self.sample_positions.are_many() {
            true => self.sample_positions.reach::<FOUR>(),
            false => self.sample_positions.reach::<1>(),
        };
        let area = PixelBox::reached(corners, reach).intersection(self.bounds);
        let PixelBox { left, top, .. } = self.bounds;
        let Some(edges) = Triangle::new(corners).filter(|_| !area.is_empty()) else { return };
        let large = Large::new(triangle, &edges, [left, top]);
        let area = PixelBox {
            left: area.left - left,
            top: area.top - top,
            right: area.right - left,
            bottom: area.bottom - top,
        };
        let samples = &self.sample_positions;
        let touched = match samples.are_many() {
            true => dispatch!(level, simd => large.blocks::<_, FOUR>(simd, area, samples)),
            false => dispatch!(level, simd => large.blocks::<_, 1>(simd, area, samples)),
        };
        self.touched |= touched.some;
        for depth in triangle.corners.map(|corner| corner.depth) {
            self.depths = [self.depths[0].min(depth), self.depths[1].max(depth)];
        }
        self.large.push((large, touched));
    }

    /// Adds what the chosen variants cover, pixel by pixel. Some of them cover a pixel more than
    /// once by one triangle, whose nearest place counts.
    fn add_one_by_one(
        &mut self,
        plan: &FramePlan,
        frame: &ScreenGeometry,
        bins: &Bins,
        (tile, bounds): (usize, PixelBox),
    ) {
        let (samples, count) = (self.sample_positions, self.sample_positions.count());
        let mut all = Vec::new();
        for sample in 0..count {
            let shift = if count == 1 { [0; 2] } else { samples.shift::<FOUR>(sample) };
            let (at, which) = ((tile, bounds), (sample, shift));
            pixel_by_pixel::paint_bins(plan.variants, plan, frame, bins, at, which, &mut {
                |[x, y]: [i32; 2], key: u32, number: u32| {
                    let plane = (block_at(x, y) * count + sample) * BLOCK_PIXELS;
                    all.push((plane + within(x, y), number, key));
                }
            });
        }
        all.sort_unstable_by_key(|(place, number, key)| (*place, *number, !*key));
        all.dedup_by_key(|(place, number, _)| (*place, *number));
        for (place, number, key) in all {
            self.add_hit(place, count, u64::from(key) << 32 | u64::from(!number));
        }
        // The keys of other formats are no depths.
        self.depths = [0.0, 1.0];
    }

    /// Whether a triangle touches a block.
    pub(crate) const fn touches(&self, block: usize) -> bool {
        self.touched >> block & 1 != 0
    }

    /// The blocks that any triangle touches, a bit for each.
    pub(crate) const fn touched(&self) -> u64 {
        self.touched
    }

    /// Bounds of the depths of all layers, and of these of what is opaque.
    pub(crate) fn depths_with(&self, opaque: Option<[f32; 2]>) -> Option<[f32; 2]> {
        let [low, high] = self.depths;
        let own = Some([low, high]).filter(|_| self.touched != 0);
        match (own, opaque) {
            (Some([low, high]), Some([least, most])) => Some([low.min(least), high.max(most)]),
            (own, opaque) => own.or(opaque),
        }
    }

    /// Begins a sample of a block.
    pub(crate) fn open(&mut self) {
        self.block.floor = [0; BLOCK_PIXELS];
        self.block.more = u64::MAX;
    }

    /// Gathers the farthest layers of a sample of a block that were not taken before, in front of
    /// the `opaque` entries. Returns whether there are any.
    pub(crate) fn take(
        &mut self,
        level: Level,
        (frame, order): (&ScreenGeometry, Transparency),
        (block, sample): (usize, usize),
        opaque: &[u64; BLOCK_PIXELS],
    ) -> bool {
        if self.block.more == 0 {
            return false;
        }
        let key = Keys { by_draw: order == Transparency::Objects, frame };
        self.block.begin();
        let samples = self.sample_positions;
        for (pixel, word) in &self.hits[block * samples.count() + sample] {
            let pixel = usize::from(*pixel) % BLOCK_PIXELS;
            if *word > opaque[pixel] {
                self.block.add(pixel, key.of(*word));
            }
        }
        let shift = if samples.are_many() { samples.shift::<FOUR>(sample) } else { [0; 2] };
        dispatch!(level, simd => self.take_large(simd, &key, (block, shift), opaque));
        self.block.end()
    }

    #[inline(always)]
    fn take_large<S: Simd>(
        &mut self,
        simd: S,
        key: &Keys<'_>,
        (block, shift): (usize, [i32; 2]),
        opaque: &[u64; BLOCK_PIXELS],
    ) {
        let Self { large, block: held, .. } = self;
        let farthest = opaque.iter().fold(u64::MAX, |least, word| *word.min(&least));
        let mut plane = [0; BLOCK_PIXELS];
        for (large, touched) in large.iter().filter(|(_, touched)| touched.some >> block & 1 != 0) {
            if u64::from(large.high.to_bits()) << 32 | u64::from(u32::MAX) < farthest {
                continue;
            }
            plane.fill(0);
            large.draw(simd, (block, shift), touched.whole >> block & 1 != 0, &Solid, &mut plane);
            for (pixel, (word, opaque)) in plane.iter().zip(opaque).enumerate() {
                if word > opaque {
                    held.add(pixel, key.of(*word));
                }
            }
        }
    }

    /// The number of layers of the pixel that has the most.
    pub(crate) const fn len(&self) -> usize {
        self.block.rows.len()
    }

    /// The layers `i` of a block's pixels, 0 where a pixel has fewer. The lower halves are those of
    /// words of the visibility buffer, and so are the upper halves unless objects are drawn one by
    /// one.
    pub(crate) fn row(&self, order: Transparency, i: usize) -> [u64; BLOCK_PIXELS] {
        let flip = if order == Transparency::Objects { u64::from(u32::MAX) } else { 0 };
        let mut row = self.block.rows[i];
        for (word, count) in row.iter_mut().zip(&self.block.counts) {
            *word = if *count > i { *word ^ flip } else { 0 };
        }
        row
    }

    /// Whether all layers of the block's sample were gathered at once.
    pub(crate) const fn are_all(&self) -> bool {
        self.block.more == 0
    }
}

/// By what layers are sorted: the larger key is laid over the smaller.
struct Keys<'a> {
    by_draw: bool,
    frame: &'a ScreenGeometry,
}

impl Keys<'_> {
    /// The key of a word of the visibility buffer: itself, or the draw's place in the order from
    /// far to near above and the triangle's number below.
    #[inline(always)]
    #[expect(clippy::cast_possible_truncation, reason = "the lower half is the number")]
    fn of(&self, word: u64) -> u64 {
        if self.by_draw { self.frame.key_by_draw(!(word as u32)) } else { word }
    }
}

impl Held {
    fn begin(&mut self) {
        self.rows.clear();
        self.counts = [0; BLOCK_PIXELS];
        // Pixels whose layers were all taken are left out.
        for (pixel, floor) in self.floor.iter_mut().enumerate() {
            if self.more >> pixel & 1 == 0 {
                *floor = u64::MAX;
            }
        }
        self.ceiling = [u64::MAX; BLOCK_PIXELS];
        self.more = 0;
    }

    #[inline(always)]
    fn add(&mut self, pixel: usize, key: u64) {
        if key <= self.floor[pixel] {
            return;
        }
        if key > self.ceiling[pixel] {
            self.more |= 1 << pixel;
            return;
        }
        let row = self.counts[pixel];
        if row == self.rows.len() {
            if row == MOST {
                return self.add_to_full(pixel, key);
            }
            self.rows.push([0; BLOCK_PIXELS]);
        }
        self.rows[row][pixel] = key;
        self.counts[pixel] = row + 1;
    }

    /// Keeps the farthest layers of a pixel that has too many, and adds one.
    #[cold]
    fn add_to_full(&mut self, pixel: usize, key: u64) {
        let mut column: Vec<u64> = self.rows.iter().map(|row| row[pixel]).collect();
        column.select_nth_unstable(KEPT - 1);
        for (row, key) in self.rows.iter_mut().zip(&column[..KEPT]) {
            row[pixel] = *key;
        }
        self.counts[pixel] = KEPT;
        self.ceiling[pixel] = column[KEPT - 1];
        self.more |= 1 << pixel;
        self.add(pixel, key);
    }

    /// Sorts the layers of each pixel. Returns whether there are any.
    fn end(&mut self) -> bool {
        let mut column = Vec::new();
        for (pixel, count) in self.counts.iter().enumerate() {
            let sorted = (1..*count).all(|i| self.rows[i - 1][pixel] < self.rows[i][pixel]);
            if !sorted {
                column.clear();
                column.extend(self.rows[..*count].iter().map(|row| row[pixel]));
                column.sort_unstable();
                for (row, key) in self.rows.iter_mut().zip(&column) {
                    row[pixel] = *key;
                }
            }
        }
        self.floor = self.ceiling;
        !self.rows.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The layers that are taken of one pixel, in as many turns as it needs.
    fn taken(keys: &[u64]) -> (Vec<u64>, usize) {
        let mut held = Held { more: u64::MAX, floor: [0; BLOCK_PIXELS], ..Held::default() };
        let (mut all, mut turns) = (Vec::new(), 0);
        while held.more != 0 {
            held.begin();
            keys.iter().for_each(|key| held.add(7, *key));
            held.end();
            all.extend(held.rows[..held.counts[7]].iter().map(|row| row[7]));
            turns += 1;
        }
        (all, turns)
    }

    #[test]
    fn every_layer_is_taken_once_from_far_to_near_however_many_there_are() {
        let mut state = 1_u64;
        for count in [1, 2, 7, KEPT, MOST, MOST + 1, 5 * MOST + 3] {
            let keys: Vec<u64> = (0..count)
                .map(|_| {
                    state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                    state | 1
                })
                .collect();
            let mut want = keys.clone();
            want.sort_unstable();
            let (got, turns) = taken(&keys);
            assert_eq!(got, want, "{count}");
            assert!(turns <= count / KEPT + 1, "{turns} turns for {count}");
        }
    }
}
