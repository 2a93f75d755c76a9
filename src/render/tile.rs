//! What is seen at each pixel of a tile.
//!
//! One word of 64 bits a pixel: the bits of the depth above, the inverted number of the primitive
//! below. The larger word wins: what is nearer, and among what is equally near the primitive with the
//! lower number, that is of the older object, the earlier face. The order in which primitives are
//! drawn cannot show, so it is nobody's concern.
//!
//! Which pixels a triangle covers, and how near it is there, is computed in one of two ways, chosen
//! by the triangle's own size alone: in f32 for boxes up to 8 x 8, where whole numbers below 2^24 are
//! exact, sixteen triangles at once; and in i64 for all others, a block of 8 x 8 pixels at once. So
//! neither tiles nor threads nor instructions show in the picture.

use fearless_simd::{
    Bytes as _, Level, Select as _, Simd, SimdBase as _, SimdInt as _, SimdMask as _, dispatch,
    f32x16, i32x16, u32x16,
};

use super::bins::{Bin, LargeTriangle, PACK, Pack, SMALL};
use super::coverage::{PixelBox, SUBPIXELS, Triangle};
use super::frame::Frame;
use super::lines;
use super::plan::FramePlan;
use super::real::Real;
use super::surface;
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

/// Numbers of lines have this bit.
const LINE: u32 = 1 << 31;

/// What is seen at a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Seen {
    /// Nothing.
    Background,
    /// A triangle, by its number in the frame.
    Triangle(u32),
    /// A line, by its place among the frame's lines.
    Line(u32),
}

/// What a word says is seen.
#[inline(always)]
#[expect(clippy::cast_possible_truncation, reason = "the lower half is meant")]
pub(super) const fn seen(word: u64) -> Seen {
    match (word, !(word as u32)) {
        (0, _) => Seen::Background,
        (_, number) if number & LINE != 0 => Seen::Line(number & !LINE),
        (_, number) => Seen::Triangle(number),
    }
}

/// The depth that a word says.
pub(super) const fn depth(word: u64) -> f32 {
    f32::from_bits((word >> 32) as u32)
}

#[inline(always)]
fn word(depth: f32, number: u32) -> u64 {
    u64::from(depth.to_bits()) << 32 | u64::from(!number)
}

/// The words of one tile, block by block, each block row by row.
#[derive(Debug)]
pub(super) struct Visibility {
    words: Box<[u64; PIXELS]>,
    /// For each block a depth that all of its pixels are at least as near as.
    farthest: [f32; BLOCK_PIXELS],
    bounds: PixelBox,
    hits: Box<Hits>,
}

/// Pixels that a pack of triangles covers.
#[derive(Debug)]
struct Hits {
    pixel: [u32; HITS],
    depth: [u32; HITS],
    number: [u32; HITS],
}

/// All pixels of the boxes of a pack, and room for one store past the last.
const HITS: usize = PACK * BLOCK_PIXELS + PACK;

impl Default for Visibility {
    fn default() -> Self {
        let row = [0; HITS];
        Self {
            words: Box::new([0; PIXELS]),
            farthest: [0.0; BLOCK_PIXELS],
            bounds: PixelBox { left: 0, top: 0, right: 0, bottom: 0 },
            hits: Box::new(Hits { pixel: row, depth: row, number: row }),
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
        self.words.fill(0);
        self.farthest.fill(0.0);
        self.bounds = bounds;
        for bins in frame.bins() {
            let bin = &bins.tiles[tile];
            dispatch!(level, simd => self.draw_small(simd, bin));
            for &number in &bin.large {
                let large = &bins.large[number as usize];
                if large.cutout {
                    self.draw_cutout(plan, frame, large);
                } else {
                    dispatch!(level, simd => self.draw_large(simd, large));
                }
            }
        }
        self.draw_lines(plan, frame, tile);
    }

    /// The words of one block, row by row, and its upper left pixel; `block` counts along rows of
    /// blocks.
    pub(super) fn block(&self, block: usize) -> (&[u64; BLOCK_PIXELS], [i32; 2]) {
        let words = &self.words[block * BLOCK_PIXELS..][..BLOCK_PIXELS];
        let at = i32::try_from(block).expect("a tile has few blocks");
        let corner =
            [self.bounds.left + at % BLOCKS * BLOCK, self.bounds.top + at / BLOCKS * BLOCK];
        (words.try_into().expect("a block has so many pixels"), corner)
    }

    /// The word of a pixel of the tile.
    pub(super) fn word(&self, x: i32, y: i32) -> u64 {
        self.words[place(x - self.bounds.left, y - self.bounds.top)]
    }

    #[inline(always)]
    fn put(&mut self, x: i32, y: i32, depth: f32, number: u32) {
        let place = place(x - self.bounds.left, y - self.bounds.top);
        self.words[place] = self.words[place].max(word(depth, number));
    }

    fn draw_lines(&mut self, plan: &FramePlan, frame: &Frame, tile: usize) {
        for &number in &frame.line_bins.tiles[tile].lines {
            let line = &frame.lines[number as usize];
            lines::pixels(line, plan.line_width, self.bounds, |x, y, depth| {
                self.put(x, y, depth, number | LINE);
            });
        }
    }

    fn draw_cutout(&mut self, plan: &FramePlan, frame: &Frame, large: &LargeTriangle) {
        let corners = each(large.corners, |corner| corner.at());
        let Some(triangle) = Triangle::new(corners) else { return };
        let depth = DepthPlane::new(large, &triangle);
        triangle.covered(self.bounds, |pixel| {
            if surface::is_opaque(plan, frame, large.number, [pixel.x, pixel.y]) {
                self.put(pixel.x, pixel.y, depth.at(pixel.edges), large.number);
            }
        });
    }

    #[inline(always)]
    fn draw_large<S: Simd>(&mut self, _: S, large: &LargeTriangle) {
        let Some(triangle) = Triangle::new(each(large.corners, |corner| corner.at())) else {
            return;
        };
        let plane = DepthPlane::new(large, &triangle);
        let area = triangle.bounds().intersection(self.bounds);
        if area.is_empty() {
            return;
        }
        let blocks = |low: i32, high: i32| low / BLOCK..(high - 1) / BLOCK + 1;
        let (left, top) = (self.bounds.left, self.bounds.top);
        for row in blocks(area.top - top, area.bottom - top) {
            for column in blocks(area.left - left, area.right - left) {
                let block = (row * BLOCKS + column) as usize;
                if plane.high < self.farthest[block] {
                    continue;
                }
                let (x, y) = (left + column * BLOCK, top + row * BLOCK);
                let edges = triangle.edges_at(x, y);
                let Some(whole) = triangle.touches_block(edges) else { continue };
                let words = &mut self.words[block * BLOCK_PIXELS..][..BLOCK_PIXELS];
                let words = words.try_into().expect("a block has so many pixels");
                draw_block(&triangle, &plane, edges, whole, large.number, words);
                if whole {
                    self.farthest[block] = self.farthest[block].max(plane.low);
                }
            }
        }
    }

    #[inline(always)]
    fn draw_small<S: Simd>(&mut self, simd: S, bin: &Bin) {
        for (queue, side) in SMALL.into_iter().enumerate() {
            for (pack, count) in bin.packs(queue) {
                self.draw_pack(simd, pack, count, side);
            }
        }
    }

    /// Draws sixteen triangles whose boxes have `side` x `side` pixels at most.
    #[inline(always)]
    fn draw_pack<S: Simd>(&mut self, simd: S, pack: &Pack, count: usize, side: i32) {
        let lanes = PackLanes::new(simd, pack);
        let columns = self.bounds.right - self.bounds.left;
        let rows = self.bounds.bottom - self.bounds.top;
        let there = (1_u64 << count) - 1;
        let mut hits = 0;
        let mut row = lanes.first;
        for dy in 0..side {
            let y = lanes.top + dy;
            let in_rows = (y.simd_ge(0) & y.simd_lt(rows)).to_bitmask() & there;
            let mut edges = row;
            for dx in 0..side {
                let x = lanes.left + dx;
                let covered = edges[0].simd_ge(lanes.least[0])
                    & edges[1].simd_ge(lanes.least[1])
                    & edges[2].simd_ge(lanes.least[2])
                    & x.simd_ge(0)
                    & x.simd_lt(columns);
                if covered.to_bitmask() & in_rows != 0 {
                    let covered = covered & mask(simd, in_rows);
                    let depth = lanes.depth_at(edges);
                    let place: u32x16<S> = lanes_place(x, y).bitcast();
                    let depth: u32x16<S> = depth.bitcast();
                    let to = hits..hits + PACK;
                    place.compress(covered).store_slice(&mut self.hits.pixel[to.clone()]);
                    depth.compress(covered).store_slice(&mut self.hits.depth[to.clone()]);
                    lanes.number.compress(covered).store_slice(&mut self.hits.number[to]);
                    hits += covered.to_bitmask().count_ones() as usize;
                }
                edges = lanes.step(edges, lanes.a);
            }
            row = lanes.step(row, lanes.b);
        }
        let Hits { pixel, depth, number } = &*self.hits;
        for ((pixel, depth), number) in pixel[..hits].iter().zip(depth).zip(number) {
            let word = u64::from(*depth) << 32 | u64::from(!number);
            let place = *pixel as usize % PIXELS;
            self.words[place] = self.words[place].max(word);
        }
    }
}

#[inline(always)]
fn mask<S: Simd>(simd: S, bits: u64) -> fearless_simd::mask32x16<S> {
    fearless_simd::mask32x16::from_bitmask(simd, bits)
}

/// Where the word of a pixel stands, by column and row of the tile.
#[inline(always)]
const fn place(x: i32, y: i32) -> usize {
    ((y / BLOCK * BLOCKS + x / BLOCK) * BLOCK * BLOCK + y % BLOCK * BLOCK + x % BLOCK) as usize
}

/// The same for sixteen pixels.
#[inline(always)]
fn lanes_place<S: Simd>(x: i32x16<S>, y: i32x16<S>) -> i32x16<S> {
    ((y >> 3) << 9) + ((x >> 3) << 6) + ((y & 7) << 3) + (x & 7)
}

/// Sixteen small triangles, ready to be asked pixel by pixel.
struct PackLanes<S: Simd> {
    left: i32x16<S>,
    top: i32x16<S>,
    number: u32x16<S>,
    /// The edge functions at the first pixel of the box; positive inside, whatever the winding.
    first: [f32x16<S>; 3],
    /// The least values that count as inside: 0, or 1 where centres on the edge are out.
    least: [f32x16<S>; 3],
    /// What an edge function gains by a pixel to the right, and by one down.
    a: [f32x16<S>; 3],
    b: [f32x16<S>; 3],
    depth: f32x16<S>,
    to_second: f32x16<S>,
    to_third: f32x16<S>,
    low: f32x16<S>,
    high: f32x16<S>,
}

impl<S: Simd> PackLanes<S> {
    #[inline(always)]
    fn new(simd: S, pack: &Pack) -> Self {
        let [x0, x1, x2] = each([0, 1, 2], |i: usize| f32x16::from_slice(simd, &pack.x[i]));
        let [y0, y1, y2] = each([0, 1, 2], |i: usize| f32x16::from_slice(simd, &pack.y[i]));
        let [d0, d1, d2] = each([0, 1, 2], |i: usize| f32x16::from_slice(simd, &pack.depth[i]));
        let left = i32x16::from_slice(simd, &pack.left);
        let top = i32x16::from_slice(simd, &pack.top);

        let area = (x1 - x0) * (y2 - y0) - (y1 - y0) * (x2 - x0);
        let one = f32x16::splat(simd, 1.0);
        let sign = area.simd_lt(0.0).select(f32x16::splat(simd, -1.0), one);
        let (parts, half) = (SUBPIXELS as f32, (SUBPIXELS / 2) as f32);
        let cx: f32x16<S> = left.to_float::<f32x16<S>>() * parts + half;
        let cy: f32x16<S> = top.to_float::<f32x16<S>>() * parts + half;
        let middle = [cx, cy];
        let e0 = lanes_edge([x1, y1], [x2, y2], sign, middle);
        let e1 = lanes_edge([x2, y2], [x0, y0], sign, middle);
        let e2 = lanes_edge([x0, y0], [x1, y1], sign, middle);
        // Triangles without area cover nothing; 1 keeps their quotients finite.
        let area = area * sign;
        let per_area = one / area.simd_gt(0.0).select(area, one);
        Self {
            left,
            top,
            number: u32x16::from_slice(simd, &pack.number),
            first: [e0.value, e1.value, e2.value],
            least: [e0.least, e1.least, e2.least],
            a: [e0.a, e1.a, e2.a],
            b: [e0.b, e1.b, e2.b],
            depth: d0,
            to_second: (d1 - d0) * per_area,
            to_third: (d2 - d0) * per_area,
            low: Real::min(Real::min(d0, d1), d2),
            high: Real::max(Real::max(d0, d1), d2),
        }
    }

    #[inline(always)]
    fn step(&self, [x, y, z]: [f32x16<S>; 3], by: [f32x16<S>; 3]) -> [f32x16<S>; 3] {
        [x + by[0], y + by[1], z + by[2]]
    }

    /// The depths at a pixel, linear on the screen and within the depths of the corners.
    #[inline(always)]
    fn depth_at(&self, edges: [f32x16<S>; 3]) -> f32x16<S> {
        let depth = self.depth + edges[1] * self.to_second + edges[2] * self.to_third;
        let depth = depth.simd_gt(self.low).select(depth, self.low);
        depth.simd_lt(self.high).select(depth, self.high)
    }
}

/// An edge function of sixteen triangles.
struct LanesEdge<S: Simd> {
    value: f32x16<S>,
    least: f32x16<S>,
    a: f32x16<S>,
    b: f32x16<S>,
}

/// As in `coverage`: a = p.y - q.y, b = q.x - p.x, e = a (x - p.x) + b (y - p.y); turned by the sign
/// of the area, and with what it gains by a whole pixel.
#[inline(always)]
fn lanes_edge<S: Simd>(
    [px, py]: [f32x16<S>; 2],
    [qx, qy]: [f32x16<S>; 2],
    sign: f32x16<S>,
    [x, y]: [f32x16<S>; 2],
) -> LanesEdge<S> {
    let (a, b) = ((py - qy) * sign, (qx - px) * sign);
    let on_edge = a.simd_gt(0.0) | (a.simd_eq(0.0) & b.simd_gt(0.0));
    let simd = px.simd;
    let (zero, one) = (f32x16::splat(simd, 0.0), f32x16::splat(simd, 1.0));
    LanesEdge {
        value: a * (x - px) + b * (y - py),
        least: on_edge.select(zero, one),
        a: a * (SUBPIXELS as f32),
        b: b * (SUBPIXELS as f32),
    }
}

/// The depth of a large triangle: linear on the screen, within the depths of its corners.
#[derive(Clone, Copy, Debug)]
struct DepthPlane {
    depth: f64,
    to_second: f64,
    to_third: f64,
    low: f32,
    high: f32,
}

impl DepthPlane {
    #[inline(always)]
    #[expect(clippy::cast_precision_loss, reason = "the nearest number is meant")]
    fn new(large: &LargeTriangle, triangle: &Triangle) -> Self {
        let [a, b, c] = each(large.corners, |corner| corner.depth);
        let per_area = 1.0 / triangle.doubled_area() as f64;
        Self {
            depth: f64::from(a),
            to_second: (f64::from(b) - f64::from(a)) * per_area,
            to_third: (f64::from(c) - f64::from(a)) * per_area,
            low: a.min(b).min(c),
            high: a.max(b).max(c),
        }
    }

    /// The depth where the edge functions have these values.
    #[inline(always)]
    #[expect(
        clippy::cast_precision_loss,
        clippy::cast_possible_truncation,
        reason = "the nearest number is meant"
    )]
    fn at(&self, [_, second, third]: [i64; 3]) -> f32 {
        let depth = self.depth + second as f64 * self.to_second + third as f64 * self.to_third;
        let depth = depth as f32;
        let depth = if depth > self.low { depth } else { self.low };
        if depth < self.high { depth } else { self.high }
    }
}

/// Draws a triangle into the words of a block; `edges` are the edge functions at its first pixel.
#[inline(always)]
fn draw_block(
    triangle: &Triangle,
    plane: &DepthPlane,
    edges: [i64; 3],
    whole: bool,
    number: u32,
    words: &mut [u64; BLOCK_PIXELS],
) {
    let [right, down] = triangle.steps();
    let least = triangle.least();
    for (y, row) in (0_i64..).zip(words.chunks_exact_mut(BLOCK as usize)) {
        let at: [i64; 3] = [edges[0] + y * down[0], edges[1] + y * down[1], edges[2] + y * down[2]];
        for (x, slot) in (0_i64..).zip(row) {
            let at = [at[0] + x * right[0], at[1] + x * right[1], at[2] + x * right[2]];
            let inside = (at[0] >= least[0]) & (at[1] >= least[1]) & (at[2] >= least[2]);
            let new = word(plane.at(at), number);
            let new = if whole | inside { new } else { 0 };
            *slot = if new > *slot { new } else { *slot };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::image::Size;
    use crate::render::bins::Bins;
    use crate::render::clip::ScreenVertex;
    use crate::render::coverage::Snapped;

    const BOUNDS: PixelBox = PixelBox { left: 0, top: 0, right: 50, bottom: 60 };

    /// Numbers that look random.
    fn numbers(mut state: u64) -> impl FnMut(i32) -> i32 {
        move |below| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            ((state >> 33) % below.cast_unsigned() as u64) as i32
        }
    }

    fn covered_by(bins: &Bins, level: Level) -> Vec<(i32, i32)> {
        let mut visibility = Visibility { bounds: BOUNDS, ..Visibility::default() };
        dispatch!(level, simd => visibility.draw_small(simd, &bins.tiles[0]));
        for large in &bins.large {
            dispatch!(level, simd => visibility.draw_large(simd, large));
        }
        let all = (0..60).flat_map(|y| (0..50).map(move |x| (x, y)));
        all.filter(|(x, y)| visibility.word(*x, *y) != 0).collect()
    }

    #[test]
    fn both_ways_cover_the_pixels_that_the_rule_says() {
        let mut random = numbers(7);
        for extent in [1, 2, 4, 8, 30] {
            for _ in 0..4000 {
                // Every second coordinate on a pixel's centre or border.
                let (left, top) = (random(56) - 4, random(66) - 4);
                let mut coordinate = |from: i32| {
                    let place = from * 256 + random(extent * 256);
                    if random(2) == 0 { place } else { place / 128 * 128 }
                };
                let corners =
                    [0, 1, 2].map(|_| Snapped { x: coordinate(left), y: coordinate(top) });
                let mut want = Vec::new();
                if let Some(triangle) = Triangle::new(corners) {
                    triangle.covered(BOUNDS, |pixel| want.push((pixel.x, pixel.y)));
                }
                let vertices = corners.map(|corner| ScreenVertex::new(corner, 0.5));
                let bounds = PixelBox::of(corners);
                let side = (bounds.right - bounds.left).max(bounds.bottom - bounds.top);
                for queue in 0..4 {
                    let mut bins = Bins::default();
                    bins.clear(Size::new(50, 60));
                    match SMALL.get(queue) {
                        Some(small) if side <= *small && !bounds.is_empty() => {
                            bins.add_small(queue, vertices.each_ref(), bounds, 5);
                        }
                        Some(_) => continue,
                        None => bins.add_large(
                            LargeTriangle { corners: vertices, number: 5, cutout: false },
                            bounds,
                        ),
                    }
                    let got = covered_by(&bins, Level::new());
                    assert_eq!(got, want, "{corners:?} in queue {queue}");
                }
            }
        }
    }
}
