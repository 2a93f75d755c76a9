//! Layers for order-independent transparency: the transparent triangles of a tile in front of
//! opaque surfaces.
//!
//! Transparent triangles have separate bins and hide nothing. Block by block, every pixel gets the
//! list of transparent triangles in front of its entry in the visibility buffer, sorted from far to
//! near. The order of objects and triangles is therefore invisible, and triangles that intersect
//! change their order at the right pixel. At equal depths the lower number is in front, as among
//! opaque triangles: it belongs to the older object or the earlier face.
//!
//! A list holds [`MOST`] layers. If a pixel has more, the farthest are taken first, and the block
//! is gathered again for the next ones. Memory is thus bounded for any number of layers.

use std::collections::BTreeMap;
use std::ops::Range;

use crate::simd::dispatch;
use fearless_simd::{Level, Simd};

use super::beyond;
use super::bins::LargeTriangle;
use super::block_triangle::BlockTriangle;
use super::depth_format::{Format, depths_between};
use super::edges_in_floats::{FloatTriangle, in_pixels};
use super::entries::word;
use super::geometry::ScreenGeometry;
use super::large::{Large, Touched};
use super::scan_lines::ScanLines;
use crate::ancestors::points;
use crate::frame::FramePlan;
use crate::frame::raster_mode::RasterMode;
use crate::screen::coverage::{Grid, PixelBox, Triangle};
use crate::screen::sample_positions::{MANY, SamplePositions};
use crate::screen::tiles::{BLOCK_PIXELS, block_at, within};
use marraztu_core::accuracy::{Coverage, DepthFormat, Transparency};
use marraztu_core::base::math::each;

/// The largest number of layers of a pixel held at once.
const MOST: usize = 1024;
/// The number of layers, the farthest ones, kept after an overflow.
const KEPT: usize = MOST / 2;

/// The layers of one tile, and of the last gathered block.
#[derive(Debug, Default)]
pub(crate) struct Layers {
    /// The samples of the pass. A single one counts as four at the centre.
    sample_positions: SamplePositions,
    bounds: PixelBox,
    /// The blocks that any triangle touches, a bit for each.
    touched: u64,
    /// The pixels of small triangles for each sample of each block: the pixel's index in the block,
    /// and the word for the visibility buffer.
    hits: Vec<Vec<(u8, u64)>>,
    large: Vec<(Layer, Touched)>,
    depth_format: DepthFormat,
    grid: Grid,
    /// The smallest and largest depth.
    depths: [f32; 2],
    block: Held,
}

/// A triangle that is not small.
#[derive(Debug)]
enum Layer {
    Blocks(BlockTriangle),
    /// Scan lines of one sample.
    Rows(Box<ScanLines>, usize),
}

impl Layer {
    /// Returns the largest depth of the corners.
    const fn high(&self) -> f32 {
        match self {
            Self::Blocks(triangle) => triangle.high(),
            Self::Rows(rows, _) => rows.high,
        }
    }
}

/// The layers of a block's pixels: row after row, the farthest first.
#[derive(Debug)]
struct Held {
    rows: Vec<[u64; BLOCK_PIXELS]>,
    counts: [usize; BLOCK_PIXELS],
    /// The keys up to this one were taken before.
    floor: [u64; BLOCK_PIXELS],
    /// The keys above this one are taken later.
    ceiling: [u64; BLOCK_PIXELS],
    /// The pixels that have later keys, a bit for each.
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

impl Layers {
    /// Begins a tile without layers.
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
        let RasterMode { depth, grid, .. } = plan.raster_mode();
        (self.depth_format, self.grid) = (depth, grid);
        (self.touched, self.depths) = (0, [f32::INFINITY, 0.0]);
        self.hits.iter_mut().for_each(Vec::clear);
        self.hits.resize_with(MANY * BLOCK_PIXELS, Vec::new);
        self.large.clear();
        // Hits are sorted into lists per sample; larger triangles are only classified by block.
        for bins in frame.transparent_bins() {
            let samples = self.sample_positions.count();
            let format = Format(self.depth_format);
            dispatch!(level, simd => bins.hits.each((format, simd), tile, |place, word| {
                self.add_hit(place as usize, samples, word);
            }));
            for &number in &bins.tiles[tile].large {
                let triangle = &bins.large[number as usize];
                // Exact coverage alone lists no unsnapped corners.
                match bins.unsnapped.get(number as usize) {
                    None => self.add_large(level, triangle),
                    Some(corners) => {
                        self.add_by_rule(level, (plan, frame), (triangle, *corners));
                    }
                }
            }
        }
    }

    /// Adds a pixel by its index in the visibility buffer.
    #[inline(always)]
    #[expect(clippy::cast_possible_truncation, reason = "the upper half is the depth")]
    fn add_hit(&mut self, place: usize, samples: usize, word: u64) {
        let (sample, pixel) = (place % samples, place / samples);
        let (block, pixel) = (pixel / BLOCK_PIXELS, pixel % BLOCK_PIXELS);
        self.touched |= 1 << block;
        let [low, high] = depths_between(self.depth_format, [(word >> 32) as u32; 2]);
        self.depths = [self.depths[0].min(low), self.depths[1].max(high)];
        self.hits[block * samples + sample].push((pixel as u8, word));
    }

    fn add_large(&mut self, level: Level, triangle: &LargeTriangle) {
        let corners = each(triangle.corners, |corner| corner.at());
        let reach = self.sample_positions.reach::<MANY>();
        let reached = PixelBox::reached_on(self.grid, corners, reach);
        let Some(area) = reached.in_tile(self.bounds) else { return };
        let Some(edges) = Triangle::on(self.grid, corners) else { return };
        self.add_depths(triangle);
        let large = Large::new(triangle, &edges, [self.bounds.left, self.bounds.top]);
        self.add_blocks(level, BlockTriangle::Large(large), area);
    }

    /// Adds a triangle by another rule of coverage.
    fn add_by_rule(
        &mut self,
        level: Level,
        (plan, frame): (&FramePlan, &ScreenGeometry),
        (triangle, corners): (&LargeTriangle, [[f32; 2]; 3]),
    ) {
        self.add_depths(triangle);
        let depths = each(triangle.corners, |corner| corner.depth);
        let coverage = plan.raster_mode().coverage;
        match coverage {
            Coverage::Points => self.add_points(plan, frame, triangle.number),
            // Scan lines round corners, so each sample has separate rows.
            Coverage::ScanLines => {
                for sample in 0..self.sample_positions.count() {
                    let [dx, dy] = in_pixels(self.sample_positions.shift::<MANY>(sample));
                    let seen = each(corners, |[x, y]| [x - dx, y - dy]);
                    let rows = ScanLines::new(seen, depths, triangle.number, self.bounds);
                    let Some(rows) = rows else { continue };
                    let some = rows.blocks().fold(0, |some, block| some | 1 << block);
                    let touched = Touched { some, whole: 0 };
                    self.touched |= some;
                    self.large.push((Layer::Rows(Box::new(rows), sample), touched));
                }
            }
            Coverage::Exact | Coverage::F32Edges => {
                let reach = self.sample_positions.reach::<MANY>();
                // Rounding may cover centres beyond the box, so the box is enlarged.
                let reach = beyond::reach(coverage, reach);
                let at = each(triangle.corners, |corner| corner.at());
                let reached = PixelBox::reached(at, reach);
                let Some(area) = reached.in_tile(self.bounds) else { return };
                let PixelBox { left, top, .. } = self.bounds;
                let own = FloatTriangle::new(corners, depths, triangle.number, [left, top]);
                self.add_blocks(level, BlockTriangle::Floats(own), area);
            }
        }
    }

    /// Adds a triangle that may cover pixels of this area of the tile.
    fn add_blocks(&mut self, level: Level, triangle: BlockTriangle, area: PixelBox) {
        let samples = &self.sample_positions;
        let touched = dispatch!(level, simd => triangle.blocks::<_, MANY>(simd, area, samples));
        self.touched |= touched.some;
        self.large.push((Layer::Blocks(triangle), touched));
    }

    fn add_depths(&mut self, triangle: &LargeTriangle) {
        for depth in triangle.corners.map(|corner| corner.depth) {
            self.depths = [self.depths[0].min(depth), self.depths[1].max(depth)];
        }
    }

    /// Adds the points of a triangle. They may cover a pixel more than once; the nearest one
    /// counts.
    fn add_points(&mut self, plan: &FramePlan, frame: &ScreenGeometry, number: u32) {
        let (draw, start) = frame.draw_of(number);
        let (draw, count) = (&plan.draws[draw as usize], self.sample_positions.count());
        // A map keeps the nearest point of each sample.
        let mut all = BTreeMap::new();
        for sample in 0..count {
            let shift = self.sample_positions.shift::<MANY>(sample);
            let shift = [shift[0] + plan.shift[0], shift[1] + plan.shift[1]];
            let own = number - start.number;
            points::cover(plan, draw, own, (self.bounds, shift), &mut |x, y, depth| {
                let (x, y) = (x - self.bounds.left, y - self.bounds.top);
                let place = (block_at(x, y) * BLOCK_PIXELS + within(x, y)) * count + sample;
                let key = Format(self.depth_format).key(depth);
                let nearest: &mut u32 = all.entry(place).or_default();
                *nearest = key.max(*nearest);
            });
        }
        for (place, key) in all {
            self.add_hit(place, count, word(key, number));
        }
    }

    /// Returns whether a triangle touches a block.
    pub(crate) const fn touches(&self, block: usize) -> bool {
        self.touched >> block & 1 != 0
    }

    /// Returns the blocks that any triangle touches, a bit for each.
    pub(crate) const fn touched(&self) -> u64 {
        self.touched
    }

    /// Returns bounds of the depths of all layers, combined with the bounds of opaque surfaces.
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

    /// Gathers the farthest layers in front of the `opaque` entries, of one sample of a block, that
    /// were not taken before. Returns whether there are any.
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
        let by_draw = order == Transparency::Objects;
        let mut key = Keys { by_draw, frame, last: (0..0, 0) };
        self.block.begin();
        let samples = self.sample_positions;
        // Small triangles were rasterised during setup; large ones are drawn into an empty plane.
        for (pixel, word) in &self.hits[block * samples.count() + sample] {
            let pixel = usize::from(*pixel) % BLOCK_PIXELS;
            if *word > opaque[pixel] {
                self.block.add(pixel, key.of(*word));
            }
        }
        let shift = samples.shift::<MANY>(sample);
        dispatch!(level, simd => self.take_large(simd, &mut key, (block, sample, shift), opaque));
        self.block.end()
    }

    #[inline(always)]
    fn take_large<S: Simd>(
        &mut self,
        simd: S,
        key: &mut Keys<'_>,
        (block, sample, shift): (usize, usize, [i32; 2]),
        opaque: &[u64; BLOCK_PIXELS],
    ) {
        let Self { large, block: held, depth_format, .. } = self;
        let format = Format(*depth_format);
        // A triangle behind the farthest opaque entry is hidden at every pixel.
        let farthest = opaque.iter().fold(u64::MAX, |least, word| *word.min(&least));
        let mut plane = [0; BLOCK_PIXELS];
        for (large, touched) in large.iter().filter(|(_, touched)| touched.some >> block & 1 != 0) {
            // A triangle behind all opaque pixels of the block is skipped.
            if u64::from(format.key(large.high())) << 32 | u64::from(u32::MAX) < farthest {
                continue;
            }
            // The triangle is drawn alone, then its pixels in front of opaque entries are listed.
            plane.fill(0);
            let (at, whole) = ((block, shift), touched.whole >> block & 1 != 0);
            match large {
                Layer::Blocks(own) => own.draw(format, simd, at, whole, None, &mut plane),
                Layer::Rows(rows, own) if *own == sample => {
                    rows.draw(format, simd, block, None, &mut plane);
                }
                Layer::Rows(..) => {}
            }
            for (pixel, (word, opaque)) in plane.iter().zip(opaque).enumerate() {
                if word > opaque {
                    held.add(pixel, key.of(*word));
                }
            }
        }
    }

    /// Returns the number of layers of the pixel that has the most.
    pub(crate) const fn len(&self) -> usize {
        self.block.rows.len()
    }

    /// Returns layer `i` of each pixel of the block, or 0 if a pixel has fewer. The lower halves
    /// are the lower halves of words of the visibility buffer. So are the upper halves, unless
    /// objects are drawn one by one.
    pub(crate) fn row(&self, order: Transparency, i: usize) -> [u64; BLOCK_PIXELS] {
        // Object-wise keys hold the number, so later faces are blended over earlier ones. Entries
        // hold its complement.
        let flip = if order == Transparency::Objects { u64::from(u32::MAX) } else { 0 };
        let mut row = self.block.rows[i];
        for (word, count) in row.iter_mut().zip(&self.block.counts) {
            *word = if *count > i { *word ^ flip } else { 0 };
        }
        row
    }

    /// Returns whether all layers of the block's sample were gathered at once.
    pub(crate) const fn are_all(&self) -> bool {
        self.block.more == 0
    }
}

/// The sort key of layers: larger keys are blended over smaller ones.
struct Keys<'a> {
    by_draw: bool,
    frame: &'a ScreenGeometry,
    /// The triangles of the last requested draw, and the upper half of its key.
    last: (Range<u32>, u64),
}

impl Keys<'_> {
    /// Returns the key of a word of the visibility buffer: the word itself, or the draw's position
    /// from far to near in the upper half and the triangle's number in the lower half.
    #[inline(always)]
    #[expect(clippy::cast_possible_truncation, reason = "the lower half is the number")]
    fn of(&mut self, word: u64) -> u64 {
        if !self.by_draw {
            return word;
        }
        let triangle = !(word as u32);
        // Layers often come from the same draw as the layer before.
        if !self.last.0.contains(&triangle) {
            self.last = self.frame.place_of_draw(triangle);
        }
        self.last.1 << 32 | u64::from(triangle)
    }
}

impl Held {
    fn begin(&mut self) {
        self.rows.clear();
        self.counts = [0; BLOCK_PIXELS];
        // Pixels without further layers are excluded.
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
        // The layer was taken in an earlier turn, or the pixel is complete.
        if key <= self.floor[pixel] {
            return;
        }
        // The pixel had too many layers: nearer ones wait for the next turn.
        if key > self.ceiling[pixel] {
            self.more |= 1 << pixel;
            return;
        }
        let row = self.counts[pixel];
        // The block gets as many rows as its deepest pixel has layers.
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
        // A selection is enough, because `end` sorts the layers that are kept.
        column.select_nth_unstable(KEPT - 1);
        for (row, key) in self.rows.iter_mut().zip(&column[..KEPT]) {
            row[pixel] = *key;
        }
        self.counts[pixel] = KEPT;
        self.ceiling[pixel] = column[KEPT - 1];
        self.more |= 1 << pixel;
        // The key is now above the ceiling, or there is room for it.
        self.add(pixel, key);
    }

    /// Sorts the layers of each pixel. Returns whether there are any.
    fn end(&mut self) -> bool {
        let mut column = Vec::new();
        for (pixel, count) in self.counts.iter().enumerate() {
            // Layers often arrive in order already.
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
        // The next turn starts where this one stopped; complete pixels accept no further keys.
        self.floor = self.ceiling;
        !self.rows.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use marraztu_core::base::rng::Rng;

    /// Returns the layers taken of one pixel, and the number of turns.
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
        let mut rng = Rng::new(1);
        for count in [1, 2, 7, KEPT, MOST, MOST + 1, 5 * MOST + 3] {
            let keys: Vec<u64> = (0..count).map(|_| rng.bits() | 1).collect();
            let mut want = keys.clone();
            want.sort_unstable();
            let (got, turns) = taken(&keys);
            assert_eq!(got, want, "{count}");
            assert!(turns <= count / KEPT + 1, "{turns} turns for {count}");
        }
    }
}
