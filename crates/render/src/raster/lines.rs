//! Rasterises lines: decides which pixels a line covers.
//!
//! In each column that it crosses (or each row, if it is steep), a line covers the pixel that
//! contains it at the column's centre. At its ends the diamond-exit rule of Vulkan and Direct3D
//! decides: a pixel is covered if the line leaves the diamond |x| + |y| < 1/2 around its centre. A
//! line of length 0 therefore covers no pixel, and two consecutive lines cover no pixel twice. The
//! ends are snapped, and all arithmetic is in integers.
//!
//! Short lines are drawn sixteen at a time, one per lane, and become hits. Other lines are stepped
//! through in each tile. Both cover the same pixels at the same depths.

use fearless_simd::{
    Bytes as _, Select as _, Simd, SimdBase as _, SimdFloat as _, SimdInt as _, SimdMask as _,
    SimdNarrow as _, SimdWiden as _, f32x16, f64x8, i32x16, mask32x16, u32x16,
};

use super::hits::{Hits, Pixels};
use crate::screen::clip::ScreenVertex;
use crate::screen::coverage::{Grid, PixelBox, SUBPIXELS, Snapped};
use crate::screen::tiles::TILE;
use crate::simd::in_f64;

/// Half of a pixel on the usual grid.
const HALF: i32 = SUBPIXELS / 2;

/// The longest short line, in subpixels along its major axis. Dividends stay below 2^23, so f32
/// gives the integer part of quotients exactly.
pub(crate) const SHORT: i32 = 8 * SUBPIXELS;

/// The bit set in every line's number.
const LINE: u32 = 1 << 31;

/// The number of a line in the frame and a flag for the colour of back faces, as stored in the
/// visibility buffer. A lower number belongs to an older line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct LineNumber(u32);

impl LineNumber {
    /// Creates the number of a line, with or without the colour of back faces.
    pub(crate) fn new(line: u32, back: bool) -> Self {
        assert!(line < LINE / 2, "fewer than 2^30 lines");
        Self(LINE | line << 1 | u32::from(back))
    }

    /// Returns the line with this primitive number, if the number belongs to a line.
    pub(crate) const fn of(number: u32) -> Option<Self> {
        if number & LINE == 0 { None } else { Some(Self(number)) }
    }

    /// Returns the line's number among the lines of the frame.
    pub(crate) const fn line(self) -> u32 {
        (self.0 & !LINE) >> 1
    }

    /// Returns whether the line has the colour of back faces.
    pub(crate) const fn is_back(self) -> bool {
        self.0 & 1 != 0
    }

    /// Returns the primitive number.
    pub(crate) const fn bits(self) -> u32 {
        self.0
    }
}

/// A line on the screen.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ScreenLine {
    pub(crate) ends: [ScreenVertex; 2],
    /// The number, as [`LineNumber::bits`].
    pub(crate) number: u32,
    /// The depth bias: the line is drawn this many steps of depth nearer.
    pub(crate) nearer: u32,
    /// The grid of the ends, which is the grid of the triangles: on another one, a line would be
    /// hidden by its own surface.
    pub(crate) grid: Grid,
    /// The width in subpixels of the usual grid: an even number, and at least a pixel.
    pub(crate) width: i32,
    /// Whether it is a point: a disc around both ends, which are equal.
    pub(crate) is_point: bool,
}

impl ScreenLine {
    /// Returns the width in steps of the grid.
    fn width_on_grid(&self) -> i32 {
        self.width * (self.grid.parts() / SUBPIXELS)
    }

    /// Returns the line relative to a sample with this offset in 1/256 pixel.
    #[inline(always)]
    pub(crate) fn seen_from(&self, shift: [i32; 2]) -> Self {
        let shift = self.grid.offset(shift);
        Self { ends: self.ends.map(|end| end.seen_from(shift)), ..*self }
    }
}

/// Returns the bounding box of the pixels that a line may cover.
pub(crate) fn bounds(grid: Grid, [a, b]: [Snapped; 2], width: i32) -> PixelBox {
    let low = |p: i32, q: i32| p.min(q).div_euclid(grid.parts()) - width;
    let high = |p: i32, q: i32| p.max(q).div_euclid(grid.parts()) + 1 + width;
    PixelBox {
        left: low(a.x, b.x),
        top: low(a.y, b.y),
        right: high(a.x, b.x),
        bottom: high(a.y, b.y),
    }
}

/// Returns bounding boxes of a line's pixels in `clip`: one per column of tiles, or per row if it
/// is steep.
pub(crate) fn stretches(
    line: &ScreenLine,
    width: i32,
    clip: PixelBox,
) -> impl Iterator<Item = PixelBox> {
    let [a, b] = line.ends.map(|end| end.at());
    // u is the major axis: pixels are bounded per tile along it.
    let all = bounds(line.grid, [a, b], width).intersection(clip);
    let parts = i64::from(line.grid.parts());
    let steep = (b.y - a.y).abs() > (b.x - a.x).abs();
    let (ua, va, ub, vb) = if steep { (a.y, a.x, b.y, b.x) } else { (a.x, a.y, b.x, b.y) };
    let (du, dv) = (i64::from(ub) - i64::from(ua), i64::from(vb) - i64::from(va));
    let (first, last) = if steep { (all.top, all.bottom) } else { (all.left, all.right) };
    // The line's minor coordinate at a major coordinate, rounded down to pixels.
    let across = move |pixel: i32| {
        let along = i64::from(pixel) * parts - i64::from(ua);
        // If du is 0, the line has no length and covers no pixel: any divisor will do.
        let v = i64::from(va) + along * dv / if du == 0 { 1 } else { du };
        i32::try_from(v.div_euclid(parts)).unwrap_or(0)
    };
    let tiles = first.div_euclid(TILE)..(last - 1).div_euclid(TILE) + 1;
    let tiles = if all.is_empty() { 0..0 } else { tiles };
    tiles.map(move |tile| {
        let (from, to) = ((tile * TILE).max(first), (tile * TILE + TILE).min(last));
        let (p, q) = (across(from), across(to));
        let (low, high) = (p.min(q) - width - 1, p.max(q) + width + 2);
        let own = if steep {
            PixelBox { left: low, top: from, right: high, bottom: to }
        } else {
            PixelBox { left: from, top: low, right: to, bottom: high }
        };
        own.intersection(all)
    })
}

/// Calls `take` with each pixel of a line or point inside `clip`, and the depth there.
///
/// In a column, a line of width W covers the pixels with centres from W / 2 above it, exclusively,
/// to W / 2 below it.
#[inline(always)]
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_precision_loss,
    reason = "the nearest number is meant"
)]
pub(crate) fn pixels(line: &ScreenLine, clip: PixelBox, mut take: impl FnMut(i32, i32, f32)) {
    if line.is_point {
        return disc(line, clip, take);
    }
    let ([a, b], parts) = (line.ends, line.grid.parts());
    let steep = (b.at().y - a.at().y).abs() > (b.at().x - a.at().x).abs();
    // u runs along the major axis, v across it. A wide line is centred on the segment: the segment
    // is moved back by half of the added width, and more pixels follow each of its pixels.
    let wider = line.width_on_grid() - parts;
    let shift = wider / 2;
    let turn = |p: ScreenVertex| {
        let Snapped { x, y } = p.at();
        if steep { (y, x - shift) } else { (x, y - shift) }
    };
    let ((ua, va), (ub, vb)) = (turn(a), turn(b));
    let (du, dv) = (i64::from(ub) - i64::from(ua), i64::from(vb) - i64::from(va));
    // A line of length 0 leaves no diamond.
    if du == 0 {
        return;
    }
    let (columns, rows) = ((clip.left, clip.right), (clip.top, clip.bottom));
    let ((first, last), (low, high)) = if steep { (rows, columns) } else { (columns, rows) };
    let begin = ua.min(ub).div_euclid(parts).max(first);
    let end = (ua.max(ub).div_euclid(parts) + 1).min(last);
    let pixel = i64::from(parts);
    let at = |u: i32| i64::from(u) * pixel + pixel / 2 - i64::from(ua);
    // v at the centre of the first column, times parts du: see `Crossing`.
    let first = i64::from(va) * du + dv * at(begin);
    let mut crossing = Crossing::new(first, dv * pixel, du * pixel);
    // A width of whole pixels has the same number of pixels in all columns.
    let is_whole = wider % parts == 0;
    let wider = i64::from(wider);
    for u in begin..end {
        let ((v, rest), along) = (crossing.next(), at(u));
        let more = match is_whole {
            true => wider / pixel,
            false => (rest + wider * du.abs()) / crossing.divisor,
        };
        let (Ok(v), Ok(last)) = (i32::try_from(v), i32::try_from(v + more)) else { continue };
        // None of the pixels is inside the clip.
        if v >= high || last < low {
            continue;
        }
        // The diamond test only matters near the ends.
        let is_end = along.abs() <= pixel || (along - du).abs() <= pixel;
        if is_end && !leaves(parts, [u, v], (along, du), [(ua, va), (ub, vb)]) {
            continue;
        }
        // The centre of the first or last pixel may lie beyond the end of the line.
        let t = (along as f64 / du as f64).clamp(0.0, 1.0);
        let depth = f64::from(a.depth) + t * (f64::from(b.depth) - f64::from(a.depth));
        let depth = nearer(depth as f32, line.nearer);
        for v in v.max(low)..(last + 1).min(high) {
            let (x, y) = if steep { (v, u) } else { (u, v) };
            take(x, y, depth);
        }
    }
}

/// Calls `take` with each pixel of a point inside `clip`: the pixel that contains it, and those
/// with centres in its disc.
fn disc(line: &ScreenLine, clip: PixelBox, mut take: impl FnMut(i32, i32, f32)) {
    let (Snapped { x, y }, parts) = (line.ends[0].at(), line.grid.parts());
    let (diameter, half) = (line.width_on_grid(), parts / 2);
    let radius = diameter / 2;
    let depth = nearer(line.ends[0].depth, line.nearer);
    let own = [x.div_euclid(parts), y.div_euclid(parts)];
    let all = PixelBox {
        left: (x - radius).div_euclid(parts),
        top: (y - radius).div_euclid(parts),
        right: (x + radius).div_euclid(parts) + 1,
        bottom: (y + radius).div_euclid(parts) + 1,
    };
    let all = all.intersection(clip);
    let squared = |a: i32, b: i32| (i64::from(a) - i64::from(b)).pow(2);
    for row in all.top..all.bottom {
        for column in all.left..all.right {
            let [to_x, to_y] = [column, row].map(|at| at * parts + half);
            let distance = squared(to_x, x) + squared(to_y, y);
            if 4 * distance <= i64::from(diameter).pow(2) || own == [column, row] {
                take(column, row, depth);
            }
        }
    }
}

/// The v at which a line crosses the centres of columns: (va du + dv along) / du, rounded down.
/// Quotient and remainder grow by constants from column to column, so no further division is
/// needed.
#[derive(Clone, Copy, Debug)]
struct Crossing {
    quotient: i64,
    remainder: i64,
    /// The growth of the quotient and the remainder.
    step: [i64; 2],
    divisor: i64,
}

impl Crossing {
    /// Starts with a dividend, its growth and a divisor other than 0.
    const fn new(dividend: i64, growth: i64, divisor: i64) -> Self {
        // The sign moves to the dividend, so both remainders are below a positive divisor.
        let (dividend, growth) = (dividend * divisor.signum(), growth * divisor.signum());
        let divisor = divisor.abs();
        Self {
            quotient: dividend.div_euclid(divisor),
            remainder: dividend.rem_euclid(divisor),
            step: [growth.div_euclid(divisor), growth.rem_euclid(divisor)],
            divisor,
        }
    }

    /// Returns the quotient and the remainder in this column, and advances to the next column.
    #[inline(always)]
    const fn next(&mut self) -> (i64, i64) {
        let Self { quotient, remainder, step, divisor } = *self;
        let carry = remainder + step[1] >= divisor;
        self.quotient = quotient + step[0] + carry as i64;
        self.remainder = remainder + step[1] - if carry { divisor } else { 0 };
        (quotient, remainder)
    }
}

/// Returns whether a line leaves the diamond of the pixel in this column. A pixel has `parts` grid
/// steps.
fn leaves(
    parts: i32,
    [u, v]: [i32; 2],
    (along, du): (i64, i64),
    [from, to]: [(i32, i32); 2],
) -> bool {
    let half = parts / 2;
    let within = |(pu, pv): (i32, i32)| {
        let (cu, cv) = (u * parts + half, v * parts + half);
        (pu - cu).abs() + (pv - cv).abs() < half
    };
    // A line that ends in the diamond does not leave it.
    if within(to) {
        return false;
    }
    let crosses = if du > 0 { along >= 0 && along <= du } else { along <= 0 && along >= du };
    crosses || within(from)
}

/// Moves a depth nearer by some steps.
fn nearer(depth: f32, steps: u32) -> f32 {
    f32::from_bits(depth.to_bits() + steps).min(1.0)
}

/// One end of sixteen lines: x, y and depth.
pub(crate) type Ends<S> = [i32x16<S>; 3];

/// The shared properties of sixteen short lines, and the mask of drawn ones.
pub(crate) struct Short<S: Simd> {
    pub(crate) some: mask32x16<S>,
    pub(crate) number: u32x16<S>,
    pub(crate) width: i32,
    /// The depth bias, in steps of depth.
    pub(crate) nearer: u32,
    /// The sample that the lines are drawn for, and the number of samples per pixel.
    pub(crate) sample: (usize, usize),
}

/// Draws sixteen lines of at most [`SHORT`] on the usual grid, for one of the samples per pixel.
///
/// In the axes of [`pixels`]: v = floor((va du + dv along) / (256 du)).
#[inline(always)]
pub(crate) fn draw_short<S: Simd>(a: Ends<S>, b: Ends<S>, lines: &Short<S>, hits: &mut Hits) {
    let simd = a[0].simd;
    let ([xa, ya, da], [xb, yb, db]) = (a, b);
    // Steep lines swap their axes, so every lane steps along its major axis u.
    let steep = (yb - ya).abs().simd_gt((xb - xa).abs());
    let shift = (lines.width - 1) * SUBPIXELS / 2;
    let (ua, va) = (steep.select(ya, xa), steep.select(xa, ya) - shift);
    let (ub, vb) = (steep.select(yb, xb), steep.select(xb, yb) - shift);
    let (du, dv) = (ub - ua, vb - va);
    let some = lines.some & !du.simd_eq(0);
    let backward = du.simd_lt(0);
    let (begin, end) = (ua.min(ub) >> 8, (ua.max(ub) >> 8) + 1);
    let zero = i32x16::splat(simd, 0);
    let columns = some.select(end - begin, zero).reduce_max();
    let reach = hits.reach(bounds_of([xa, ya], [xb, yb], some, lines.width));
    let below = (du.abs() << 8).max(1).to_float::<f32x16<S>>();
    let depths = Depths::new(da, db, du);
    // One column per step. Lanes with shorter lines are masked out.
    for column in 0..columns {
        let u = begin + column;
        let along = (u << 8) + HALF - ua;
        // Only the fraction of va enters the dividend, so it stays below 2^23.
        let above = (va & (SUBPIXELS - 1)) * du + dv * along;
        let above = backward.select(-above, above).to_float::<f32x16<S>>();
        let v = (va >> 8) + (above / below).floor().to_int::<i32x16<S>>();
        let across = (v << 8) + HALF;
        // The diamond-exit rule: the end must not lie in the diamond, and the line must reach it.
        let within_a = (along.abs() + (va - across).abs()).simd_lt(HALF);
        let within_b = ((along - du).abs() + (vb - across).abs()).simd_lt(HALF);
        let passed = backward.select(-along, along);
        let crosses = passed.simd_ge(0) & passed.simd_le(du.abs());
        let covered = some & u.simd_lt(end) & (crosses | within_a) & !within_b;
        if !covered.any_true() {
            continue;
        }
        // The bits of depths are ordered like the depths, so a step nearer adds 1.
        let depth = (depths.at(along) + lines.nearer.cast_signed()).min(ONE.cast_signed());
        let depth = depth.bitcast();
        // A wide line repeats each pixel across its major axis.
        for side in 0..lines.width {
            let v = v + side;
            let (x, y) = (steep.select(v, u), steep.select(u, v));
            let pixels = Pixels { x, y, depth, number: lines.number };
            hits.add(&reach, (&pixels, lines.sample), covered);
        }
    }
}

/// The bits of the largest depth.
const ONE: u32 = 1.0_f32.to_bits();

/// The depths along sixteen lines: a + t (b - a), t = along / du, clamped to 0..1, in f64.
struct Depths<S: Simd> {
    from: [f64x8<S>; 2],
    gain: [f64x8<S>; 2],
    length: [f64x8<S>; 2],
}

impl<S: Simd> Depths<S> {
    #[inline(always)]
    fn new(a: i32x16<S>, b: i32x16<S>, du: i32x16<S>) -> Self {
        let (a_low, a_high) = a.bitcast::<f32x16<S>>().widen();
        let (b_low, b_high) = b.bitcast::<f32x16<S>>().widen();
        let gain = [b_low - a_low, b_high - a_high];
        Self { from: [a_low, a_high], gain, length: in_f64(du) }
    }

    /// Returns the bits of the depths.
    #[inline(always)]
    fn at(&self, along: i32x16<S>) -> i32x16<S> {
        let [low, high] = in_f64(along);
        self.half(0, low).narrow(self.half(1, high)).bitcast()
    }

    #[inline(always)]
    fn half(&self, i: usize, along: f64x8<S>) -> f64x8<S> {
        let t = along / self.length[i];
        let (zero, one) = (f64x8::splat(t.simd, 0.0), f64x8::splat(t.simd, 1.0));
        let t = t.simd_lt(0.0).select(zero, t);
        let t = t.simd_gt(1.0).select(one, t);
        self.from[i] + t * self.gain[i]
    }
}

/// Returns the bounding box of the pixels that some of sixteen lines may cover.
#[inline(always)]
fn bounds_of<S: Simd>(
    [xa, ya]: [i32x16<S>; 2],
    [xb, yb]: [i32x16<S>; 2],
    some: mask32x16<S>,
    width: i32,
) -> PixelBox {
    // With an empty mask the box is inverted, but far from overflow.
    let far = i32x16::splat(xa.simd, 1 << 29);
    let first = Snapped {
        x: some.select(xa.min(xb), far).reduce_min(),
        y: some.select(ya.min(yb), far).reduce_min(),
    };
    let last = Snapped {
        x: some.select(xa.max(xb), -far).reduce_max(),
        y: some.select(ya.max(yb), -far).reduce_max(),
    };
    if first.x > last.x {
        return PixelBox { left: 0, top: 0, right: 0, bottom: 0 };
    }
    bounds(Grid::Usual, [first, last], width)
}

#[cfg(test)]
#[expect(clippy::cast_possible_truncation, reason = "small numbers")]
mod tests {
    use crate::simd::dispatch;
    use fearless_simd::Level;

    use super::super::depth_format::Format;
    use super::*;
    use marraztu_core::accuracy::DepthFormat;
    use marraztu_core::base::rng::Rng;

    const EVERYWHERE: PixelBox = PixelBox { left: -99, top: -99, right: 199, bottom: 199 };

    fn line(ends: [ScreenVertex; 2], width: i32, grid: Grid) -> ScreenLine {
        ScreenLine { ends, number: 0, nearer: 0, grid, width, is_point: false }
    }

    fn drawn(ends: [(f64, f64); 2]) -> Vec<(i32, i32)> {
        drawn_wide(ends, 1)
    }

    fn drawn_wide(ends: [(f64, f64); 2], width: i32) -> Vec<(i32, i32)> {
        let vertex = |(x, y): (f64, f64)| {
            ScreenVertex::new(Snapped { x: (x * 256.0) as i32, y: (y * 256.0) as i32 }, 0.5)
        };
        let ends = ends.map(vertex);
        let line = line(ends, width * SUBPIXELS, Grid::Usual);
        let taken = |line: &ScreenLine| {
            let mut pixels = Vec::new();
            super::pixels(line, EVERYWHERE, |x, y, _| pixels.push((x, y)));
            pixels.sort_unstable();
            pixels
        };
        // The same ends on the fine grid give the same line.
        let fine = |end: ScreenVertex| {
            let Snapped { x, y } = end.at();
            ScreenVertex::new(Snapped { x: 16 * x, y: 16 * y }, 0.5)
        };
        let on_fine = ScreenLine { ends: ends.map(fine), grid: Grid::Fine, ..line };
        assert_eq!(taken(&on_fine), taken(&line));
        taken(&line)
    }

    /// The same line, drawn in a lane.
    fn drawn_short(ends: [(f64, f64); 2], width: i32) -> Vec<(i32, i32)> {
        let mut hits = Hits::default();
        hits.clear([99, 99], [2, 2]);
        let end = |(x, y): (f64, f64)| [(x * 256.0) as i32, (y * 256.0) as i32];
        dispatch!(Level::new(), simd => {
            let [a, b] = ends.map(|ends| end(ends).map(|x| i32x16::splat(simd, x)));
            let depth = i32x16::splat(simd, 0.5_f32.to_bits().cast_signed());
            let some = mask32x16::from_bitmask(simd, 1 << 5);
            let number = u32x16::splat(simd, 0);
            let short = Short { some, number, width, nearer: 0, sample: (0, 1) };
            draw_short([a[0], a[1], depth], [b[0], b[1], depth], &short, &mut hits);
        });
        let mut pixels = Vec::new();
        for tile in 0..4 {
            let mut take = |place: u32| {
                let (place, tile) = (place as i32, tile as i32);
                let (block, within) = (place / 64, place % 64);
                let x = tile % 2 * TILE + block % 8 * 8 + within % 8;
                pixels.push((x, tile / 2 * TILE + block / 8 * 8 + within / 8));
            };
            dispatch!(Level::new(), simd => {
                hits.each((Format(DepthFormat::default()), simd), tile, |place, _| take(place));
            });
        }
        pixels.sort_unstable();
        pixels
    }

    #[test]
    fn a_line_in_a_lane_takes_the_same_pixels_at_the_same_depths() {
        let mut rng = Rng::new(3);
        let mut random = move |below: i32| rng.between(0, below - 1);
        let picture = |&(x, y): &(i32, i32)| (0..99).contains(&x) && (0..99).contains(&y);
        for _ in 0..20_000 {
            let (x, y) = (random(100 * 256), random(100 * 256));
            let mut far = |from: i32| from + random(2 * SHORT + 1) - SHORT;
            let ends = [(x, y), (far(x), far(y))].map(|(x, y)| {
                let place = |a: i32| f64::from(if a % 3 == 0 { a / 128 * 128 } else { a }) / 256.0;
                (place(x), place(y))
            });
            for width in [1, 2] {
                let mut want = drawn_wide(ends, width);
                want.retain(picture);
                assert_eq!(drawn_short(ends, width), want, "{ends:?}, {width} wide");
            }
        }
    }

    /// Applies the diamond-exit rule itself, at many points: a line leaves a diamond if its last
    /// point inside is not its end.
    fn by_the_rule([from, to]: [(f64, f64); 2]) -> Vec<(i32, i32)> {
        let n = 200_000;
        let mut entered = Vec::new();
        let inside = |x: f64, y: f64| {
            let (column, row) = (x.floor(), y.floor());
            ((x - column - 0.5).abs() + (y - row - 0.5).abs() < 0.5)
                .then_some((column as i32, row as i32))
        };
        for i in 0..=n {
            let t = f64::from(i) / f64::from(n);
            let at = inside(from.0 + (to.0 - from.0) * t, from.1 + (to.1 - from.1) * t);
            entered.extend(at.filter(|pixel| entered.last() != Some(pixel)));
        }
        if let Some(last) = inside(to.0, to.1) {
            entered.retain(|pixel| *pixel != last);
        }
        entered.sort_unstable();
        entered.dedup();
        entered
    }

    #[test]
    fn a_line_covers_exactly_the_pixels_with_diamonds_that_it_exits() {
        let lines = [
            [(0.3, 0.4), (9.7, 3.9)],
            [(9.7, 3.9), (0.3, 0.4)],
            [(5.2, -7.6), (3.1, 8.4)],
            [(3.1, 8.4), (5.2, -7.6)],
            [(0.6, 0.55), (4.45, 4.6)],
            [(2.05, 2.45), (2.9, 2.55)],
            [(-3.4, 6.3), (4.4, -1.7)],
            [(1.9, 1.9), (2.1, 7.2)],
        ];
        for ends in lines {
            let snapped = ends.map(|(x, y): (f64, f64)| {
                ((x * 256.0).trunc() / 256.0, (y * 256.0).trunc() / 256.0)
            });
            assert_eq!(drawn(ends), by_the_rule(snapped), "{ends:?}");
        }
    }

    #[test]
    fn a_line_two_pixels_wide_has_its_middle_on_the_segment() {
        // Along the border of rows 4 and 5, and of columns 4 and 5.
        let level = drawn_wide([(0.5, 5.0), (3.5, 5.0)], 2);
        assert_eq!(level, [(0, 4), (0, 5), (1, 4), (1, 5), (2, 4), (2, 5)]);
        let upright = drawn_wide([(5.0, 0.5), (5.0, 3.5)], 2);
        assert_eq!(upright, [(4, 0), (4, 1), (4, 2), (5, 0), (5, 1), (5, 2)]);
    }

    #[test]
    fn a_line_of_any_width_covers_the_centres_closer_than_half_of_it_along_the_shorter_axis() {
        let mut rng = Rng::new(5);
        let mut random = move |most: i32| rng.between(0, most);
        for i in 0..5000 {
            let ends = [0, 0].map(|_| [random(60 * 256), random(60 * 256)]);
            let [[xa, ya], [xb, yb]] = ends;
            let width = SUBPIXELS + 2 * random(700);
            let grid = if i % 2 == 0 { Grid::Usual } else { Grid::Fine };
            let times = grid.parts() / SUBPIXELS;
            let vertex =
                |[x, y]: [i32; 2]| ScreenVertex::new(Snapped { x: x * times, y: y * times }, 0.5);
            let mut got = Vec::new();
            pixels(&line(ends.map(vertex), width, grid), EVERYWHERE, |x, y, _| got.push([x, y]));
            // Along the longer axis, centres between the ends; there, the diamonds decide.
            let steep = (yb - ya).abs() > (xb - xa).abs();
            let [u, v] = if steep { [1, 0] } else { [0, 1] };
            let [a, b] = ends;
            let (du, dv) = (i64::from(b[u] - a[u]), i64::from(b[v] - a[v]));
            let inner = |at: i32| {
                let centre = at * 256 + 128;
                centre > a[u].min(b[u]) + 256 && centre < a[u].max(b[u]) - 256
            };
            let mut want = Vec::new();
            for along in (-1..70).filter(|at| inner(*at)) {
                for across in -9..80 {
                    let [x, y] = [along, across].map(|at| i64::from(at * 256 + 128));
                    // 2 |du| times the distance from the line, downwards.
                    let by = (y - i64::from(a[v])) * du - (x - i64::from(a[u])) * dv;
                    let (by, half) = (2 * by * du.signum(), i64::from(width) * du.abs());
                    if -half < by && by <= half {
                        want.push(if steep { [across, along] } else { [along, across] });
                    }
                }
            }
            got.retain(|pixel| inner(pixel[u]));
            got.sort_unstable();
            want.sort_unstable();
            assert_eq!(got, want, "{ends:?}, {width} wide");
        }
    }

    #[test]
    fn a_point_covers_the_centres_in_its_disc_and_always_its_own_pixel() {
        let mut rng = Rng::new(6);
        let mut random = move |most: i32| rng.between(0, most);
        for i in 0..5000 {
            let (x, y, width) = (random(30 * 256), random(30 * 256), SUBPIXELS + 2 * random(700));
            let grid = if i % 2 == 0 { Grid::Usual } else { Grid::Fine };
            let times = grid.parts() / SUBPIXELS;
            let ends = [ScreenVertex::new(Snapped { x: x * times, y: y * times }, 0.5); 2];
            let point = ScreenLine { is_point: true, ..line(ends, width, grid) };
            let mut got = Vec::new();
            pixels(&point, EVERYWHERE, |x, y, _| got.push([x, y]));
            let is_in = |[column, row]: &[i32; 2]| {
                let away = [column * 256 + 128 - x, row * 256 + 128 - y].map(f64::from);
                away[0].hypot(away[1]) <= f64::from(width) / 2.0
                    || [*column, *row] == [x / 256, y / 256]
            };
            let all = (-9..40).flat_map(|row| (-9..40).map(move |column| [column, row]));
            assert_eq!(got, all.filter(is_in).collect::<Vec<_>>(), "{x} {y}, {width} wide");
        }
    }

    #[test]
    fn two_lines_that_follow_one_another_take_no_pixel_twice() {
        let (a, b, c) = ((0.3, 0.4), (5.6, 2.3), (9.1, 7.7));
        let first = drawn([a, b]);
        assert!(drawn([b, c]).iter().all(|pixel| !first.contains(pixel)));
    }

    #[test]
    fn every_pixel_of_a_long_line_lies_in_one_of_its_stretches() {
        let mut rng = Rng::new(9);
        let mut random = move || rng.between(-100 * 256, 400 * 256);
        let picture = PixelBox { left: 0, top: 0, right: 320, bottom: 256 };
        for i in 0..2000 {
            let ends = [0, 0].map(|_| ScreenVertex::new(Snapped { x: random(), y: random() }, 0.5));
            let grid = if i % 4 < 2 { Grid::Usual } else { Grid::Fine };
            let (width, is_point) = (1 + i % 3, i % 7 == 0);
            let ends = if is_point { [ends[0]; 2] } else { ends };
            let line = ScreenLine { is_point, ..line(ends, width * SUBPIXELS - 2 * (i % 5), grid) };
            let boxes: Vec<PixelBox> = stretches(&line, width, picture).collect();
            pixels(&line, picture, |x, y, _| {
                let holds = |own: &&PixelBox| {
                    (own.left..own.right).contains(&x) && (own.top..own.bottom).contains(&y)
                };
                assert_eq!(boxes.iter().filter(holds).count(), 1, "{x}, {y}: {ends:?}");
            });
        }
    }
}
