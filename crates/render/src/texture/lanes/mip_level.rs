//! Fetches the texels of one mipmap level, or of several, for sixteen pixels.

use fearless_simd::{
    Bytes as _, Select as _, Simd, SimdBase as _, SimdCombine as _, SimdFloat as _, SimdMask as _,
    f32x16, i32x4, i32x16, u8x64,
};

use super::decode::{Decode, between};
use super::sampler::{LEVELS, Sampler};
use crate::simd::gather::{permute, permutes};
use crate::simd::{BATCH, Lanes as _, Sixteen, Vec3};
use marraztu_core::base::image::Size;
use marraztu_core::scene::Wrap;

/// The mipmap level that each of sixteen pixels reads.
#[derive(Clone, Copy)]
pub(super) struct MipLevel<S: Simd> {
    /// The level, if all pixels read the same one.
    one: Option<usize>,
    numbers: i32x16<S>,
    /// The sizes of the levels divided by the size of the first level.
    scale: [f32x16<S>; 2],
    width: i32x16<S>,
    height: i32x16<S>,
}

/// The columns and rows of the four texels around sixteen positions.
pub(super) struct Around<S: Simd> {
    /// The lower left texel, at least -1: it is not wrapped yet.
    column: i32x16<S>,
    row: i32x16<S>,
    /// The weight of the right texels, and the weight of the upper texels.
    weights: [f32x16<S>; 2],
    window: Window,
}

/// A small range of columns and rows that holds the texels of sixteen positions.
#[derive(Clone, Copy, Debug, Default)]
struct Window {
    left: i32,
    first: i32,
    /// The number of rows: four or eight, or 0 if the texels are too far apart.
    rows: i32,
}

/// The number of columns of a [`Window`].
const COLUMNS: i32 = 16;

/// [`Around`] for a whole batch of positions.
#[derive(Debug)]
pub(super) struct ManyAround {
    columns: [i32; BATCH],
    rows: [i32; BATCH],
    weights: [[f32; BATCH]; 2],
    windows: [Window; BATCH / 16],
}

impl Default for ManyAround {
    fn default() -> Self {
        Self {
            columns: [0; BATCH],
            rows: [0; BATCH],
            weights: [[0.0; BATCH]; 2],
            windows: [Window::default(); BATCH / 16],
        }
    }
}

impl ManyAround {
    /// Stores the texels around sixteen positions, starting at `at`.
    #[inline(always)]
    pub(super) fn store<S: Simd>(&mut self, at: usize, around: &Around<S>) {
        around.column.store_slice(&mut self.columns[at..at + 16]);
        around.row.store_slice(&mut self.rows[at..at + 16]);
        for (row, weights) in self.weights.iter_mut().zip(around.weights) {
            weights.store_slice(&mut row[at..at + 16]);
        }
        self.windows[at / 16] = around.window;
    }

    /// Loads the texels around sixteen positions, starting at `at`.
    #[inline(always)]
    pub(super) fn load<S: Simd>(&self, simd: S, at: usize) -> Around<S> {
        let [s, t] = &self.weights;
        Around {
            column: i32x16::from_slice(simd, &self.columns[at..at + 16]),
            row: i32x16::from_slice(simd, &self.rows[at..at + 16]),
            weights: [
                f32x16::from_slice(simd, &s[at..at + 16]),
                f32x16::from_slice(simd, &t[at..at + 16]),
            ],
            window: self.windows[at / 16],
        }
    }
}

/// The four texels around sixteen positions.
pub(super) struct Footprint<S: Simd> {
    /// The left and right texels of the lower row, then of the upper row.
    pub(super) texels: [[i32x16<S>; 2]; 2],
    /// The weight of the right texels.
    pub(super) s: f32x16<S>,
    /// The weight of the upper texels.
    pub(super) t: f32x16<S>,
}

impl<S: Simd> Footprint<S> {
    /// Interpolates between the four texels: red, green and blue from 0 to 255.
    #[inline(always)]
    pub(super) fn color<D: Decode>(self) -> Vec3<f32x16<S>> {
        let Self { texels: [lower, upper], s, t } = self;
        let below = between(D::channels(lower[0]), D::channels(lower[1]), s);
        let above = between(D::channels(upper[0]), D::channels(upper[1]), s);
        between(below, above, t)
    }
}

impl<S: Simd> MipLevel<S> {
    /// Selects levels by their numbers. `one` is the level if all lanes share it.
    #[inline(always)]
    pub(super) fn of(
        sampler: &Sampler<'_>,
        simd: S,
        numbers: f32x16<S>,
        one: Option<usize>,
    ) -> Self {
        let lanes = Sixteen(simd);
        let numbers = numbers.to_int();
        let [across, up] = each_level(lanes, &sampler.scales, numbers, one);
        let [width, height] = each_level(lanes, &sampler.sizes, numbers, one);
        let (width, height) = (width.to_int(), height.to_int());
        Self { one, numbers, scale: [across, up], width, height }
    }

    /// Selects the first level for all pixels.
    #[inline(always)]
    pub(super) fn first(sampler: &Sampler<'_>, simd: S) -> Self {
        let [widths, heights] = &sampler.sizes;
        let width = f32x16::splat(simd, widths[0]).to_int();
        let height = f32x16::splat(simd, heights[0]).to_int();
        let one = f32x16::splat(simd, 1.0);
        let numbers = i32x16::splat(simd, 0);
        Self { one: Some(0), numbers, scale: [one, one], width, height }
    }

    /// Fetches the nearest texel at each position.
    #[inline(always)]
    pub(super) fn nearest(
        &self,
        simd: S,
        sampler: &Sampler<'_>,
        [x, y]: [f32x16<S>; 2],
    ) -> i32x16<S> {
        // A position on the upper border belongs to the last texel.
        let column = x.to_int::<i32x16<S>>().min(self.width - 1);
        let row = y.to_int::<i32x16<S>>().min(self.height - 1);
        let window = self.window::<1>(simd, column, row);
        match self.fetch_near::<1>(simd, sampler, (column, row), window) {
            Some([[texels]]) => texels,
            None => self.fetch(simd, sampler, [column, row]),
        }
    }

    /// Fetches the four texels around each position.
    #[inline(always)]
    pub(super) fn footprint(
        &self,
        simd: S,
        sampler: &Sampler<'_>,
        position: [f32x16<S>; 2],
    ) -> Footprint<S> {
        self.texels(simd, sampler, &self.around(simd, position))
    }

    /// Computes the columns and rows of the four texels around each position.
    #[inline(always)]
    pub(super) fn around(&self, simd: S, [x, y]: [f32x16<S>; 2]) -> Around<S> {
        // Texel centres are at halves, so the lower left neighbour is half a texel back.
        let (x, y) = (x * self.scale[0] - 0.5, y * self.scale[1] - 0.5);
        let (left, lower) = (x.floor(), y.floor());
        let (column, row) = (left.to_int(), lower.to_int());
        let window = self.window::<2>(simd, column, row);
        Around { column, row, weights: [x - left, y - lower], window }
    }

    /// Fetches the texels of a footprint.
    #[inline(always)]
    pub(super) fn texels(
        &self,
        simd: S,
        sampler: &Sampler<'_>,
        around: &Around<S>,
    ) -> Footprint<S> {
        let Around { column, row, weights: [s, t], window } = *around;
        // The fast path: all texels are in a small window.
        if let Some(texels) = self.fetch_near::<2>(simd, sampler, (column, row), window) {
            return Footprint { texels, s, t };
        }
        // The general path wraps columns and rows, and loads each pair of neighbours.
        let wrap = sampler.levels[0].wrap;
        let columns = beside(column, self.width, wrap);
        let [lower, upper] = beside(row, self.height, wrap);
        let lower = self.fetch_beside(simd, sampler, columns, lower);
        let upper = self.fetch_beside(simd, sampler, columns, upper);
        Footprint { texels: [lower, upper], s, t }
    }

    /// Finds the window of the texels at these columns and rows. If `N` is 2, it includes the next
    /// column on the right and the next row above.
    #[inline(always)]
    fn window<const N: i32>(&self, simd: S, column: i32x16<S>, row: i32x16<S>) -> Window {
        // A window needs a single level and an instruction that permutes lanes.
        if self.one.is_none() || !permutes(simd.level()) {
            return Window::default();
        }
        let more = N - 1;
        let left = column.reduce_min();
        // A row of the window is one load of sixteen texels, including right neighbours.
        if (column - left).simd_ge(COLUMNS - more).any_true() {
            return Window::default();
        }
        let first = row.reduce_min();
        let high = row - first;
        let mut far = high.simd_ge(8 - more);
        // Texels at the border wrap, so a window must not reach it.
        if N > 1 {
            far = far | column.simd_ge(self.width - more) | row.simd_ge(self.height - more);
        }
        // Four rows take half of the permutations of eight.
        let rows = match (far.any_true(), high.simd_ge(4 - more).any_true()) {
            (true, _) => 0,
            (false, true) => 8,
            (false, false) => 4,
        };
        Window { left, first, rows }
    }

    /// Fetches the texels at these columns and rows (and the next column and row if `N` is 2) if
    /// all of them lie in a window. Each row of the window is then one load of sixteen texels, and
    /// each lane picks its texel by a permutation. With textures as large as on the screen, a frame
    /// of one triangle takes 0.85 of the time (nearest, AVX-512).
    #[inline(always)]
    fn fetch_near<const N: usize>(
        &self,
        simd: S,
        sampler: &Sampler<'_>,
        (column, row): (i32x16<S>, i32x16<S>),
        Window { left, first, rows }: Window,
    ) -> Option<[[i32x16<S>; N]; N]> {
        let level = self.one.filter(|_| permutes(simd.level()) && rows > 0)?;
        let picture = &sampler.levels[level].picture;
        let Size { width, height } = picture.size();
        // Column or row -1 is beyond the border, so no window holds it.
        let (from, above) = (usize::try_from(left).ok()?, usize::try_from(first).ok()?);
        // Rows of the picture run down, texture rows up.
        let at = height.checked_sub(above + 1)? * width + from;
        let source = (picture.pixels(), at, width);
        let place = [column - left, row - first];
        Some(match rows {
            4 => from_rows::<S, N, 4>(simd, source, place),
            _ => from_rows::<S, N, 8>(simd, source, place),
        })
    }

    /// Fetches the texels at these columns and rows of the picture; rows count upwards.
    #[inline(always)]
    fn fetch(&self, simd: S, sampler: &Sampler<'_>, [column, row]: [i32x16<S>; 2]) -> i32x16<S> {
        self.fetch_at(simd, sampler, &self.places([column, row]))
    }

    #[inline(always)]
    fn fetch_at(&self, simd: S, sampler: &Sampler<'_>, places: &[i32; 16]) -> i32x16<S> {
        let pixels = self.pixels(sampler);
        let mut texels = [0; 16];
        for (lane, texel) in texels.iter_mut().enumerate() {
            *texel = texel_of(pixels(lane), places[lane]);
        }
        i32x16::from_slice(simd, &texels)
    }

    /// Fetches the texels at these columns and at the columns on their right. Both are neighbours
    /// in memory except at the texture's border, so one load fetches two texels. One triangle over
    /// 1920 x 1080 pixels takes 0.82 of the time (bilinear, AVX-512).
    #[inline(always)]
    fn fetch_beside(
        &self,
        simd: S,
        sampler: &Sampler<'_>,
        [left, right]: [i32x16<S>; 2],
        row: i32x16<S>,
    ) -> [i32x16<S>; 2] {
        let places = self.places([left, row]);
        // Wrapped or clamped at the border, a right neighbour is not the next texel in memory.
        let apart = !right.simd_eq(left + 1).to_bitmask() & 0xffff;
        if apart != 0 {
            return self.fetch_apart(simd, sampler, [&places, &self.places([right, row])]);
        }
        let pixels = self.pixels(sampler);
        let four = |lane: usize| {
            let pair = |lane: usize| two_texels_of(pixels(lane), places[lane]);
            let ([a, b], [c, d]) = (pair(lane), pair(lane + 1));
            i32x4::from_slice(simd, &[a, b, c, d])
        };
        // Combined in registers: after sixteen separate stores, store forwarding would fail.
        let low = four(0).combine(four(2)).combine(four(4).combine(four(6)));
        let high = four(8).combine(four(10)).combine(four(12).combine(four(14)));
        // Pairs lie left, right, left, right: one deinterleaving separates them.
        low.deinterleave(high).into()
    }

    /// Fetches texels at pairs of places that are not neighbours in memory.
    #[cold]
    #[inline(never)]
    fn fetch_apart(
        &self,
        simd: S,
        sampler: &Sampler<'_>,
        places: [&[i32; 16]; 2],
    ) -> [i32x16<S>; 2] {
        places.map(|places| self.fetch_at(simd, sampler, places))
    }

    /// Computes the indices of texels among the pixels of their level.
    #[inline(always)]
    fn places(&self, [column, row]: [i32x16<S>; 2]) -> [i32; 16] {
        // Rows of the picture run down, texture rows up.
        ((self.height - 1 - row) * self.width + column).into()
    }

    /// Returns the pixels of each lane's level.
    #[inline(always)]
    fn pixels<'a>(&self, sampler: &'a Sampler<'_>) -> impl Fn(usize) -> &'a [[u8; 4]] {
        let one = self.one.map(|level| sampler.levels[level].picture.pixels());
        let numbers = <[i32; 16]>::from(self.numbers);
        #[inline(always)]
        move |lane| one.unwrap_or_else(|| sampler.pixels_of(numbers[lane]))
    }
}

/// Looks up two tables for each lane's level. `one` is the level if all lanes share it.
#[inline(always)]
fn each_level<S: Simd>(
    lanes: Sixteen<S>,
    [first, second]: &[[f32; LEVELS]; 2],
    numbers: i32x16<S>,
    one: Option<usize>,
) -> [f32x16<S>; 2] {
    if let Some(level) = one {
        return [lanes.set(first[level % LEVELS]), lanes.set(second[level % LEVELS])];
    }
    // Sixteen levels fill one register, so a permutation looks them up.
    let first = permute(lanes.load(first, 0).bitcast(), numbers).bitcast();
    [first, permute(lanes.load(second, 0).bitcast(), numbers).bitcast()]
}

/// Picks texels from a window of sixteen columns and `ROWS` rows: those at these columns and rows,
/// and their right and upper neighbours if `N` is 2. `at` is the index of the window's first texel,
/// and `width` the length of a picture row.
#[inline(always)]
fn from_rows<S: Simd, const N: usize, const ROWS: i32>(
    simd: S,
    (pixels, at, width): (&[[u8; 4]], usize, usize),
    [column, row]: [i32x16<S>; 2],
) -> [[i32x16<S>; N]; N] {
    let mut texels = [[i32x16::splat(simd, 0); N]; N];
    let mut at = at;
    for this in 0..ROWS {
        let sixteen = sixteen_from(simd, pixels, at);
        // The next row up is earlier in memory. Beyond the picture, no lane reads the row.
        at = at.saturating_sub(width);
        // Every lane permutes every row; only lanes in this row keep the result.
        for (i, right) in (0..N).zip(0..) {
            let own = permute(sixteen, column + right);
            for (j, up) in (0..N).zip(0..) {
                // A lane finds its upper texels one round after its lower ones.
                texels[j][i] = row.simd_eq(this - up).select(own, texels[j][i]);
            }
        }
    }
    texels
}

/// Loads sixteen texels starting at an index, with 0 after the last one.
#[inline(always)]
fn sixteen_from<S: Simd>(simd: S, pixels: &[[u8; 4]], at: usize) -> i32x16<S> {
    let sixteen = match pixels.get(at..at.saturating_add(16)) {
        Some(sixteen) => u8x64::from_slice(simd, sixteen.as_flattened()),
        None => u8x64::from_slice(simd, last_from(pixels, at).as_flattened()),
    };
    sixteen.bitcast()
}

/// Copies the last texels starting at an index, fewer than sixteen.
#[cold]
fn last_from(pixels: &[[u8; 4]], at: usize) -> [[u8; 4]; 16] {
    let mut texels = [[0; 4]; 16];
    for (to, from) in texels.iter_mut().zip(pixels.iter().skip(at)) {
        *to = *from;
    }
    texels
}

/// Reads a texel by its index. Lanes without a pixel have arbitrary indices and may get 0.
#[inline(always)]
fn texel_of(pixels: &[[u8; 4]], place: i32) -> i32 {
    pixels.get(place.cast_unsigned() as usize).map_or(0, |texel| i32::from_le_bytes(*texel))
}

/// Reads a texel and the next one. Lanes without a pixel get arbitrary texels.
#[inline(always)]
fn two_texels_of(pixels: &[[u8; 4]], place: i32) -> [i32; 2] {
    // A single texel has no pair; its neighbours wrap and are fetched separately.
    let Some(last) = pixels.len().checked_sub(2) else { return [0; 2] };
    // Clamping costs less than a branch.
    let place = (place.cast_unsigned() as usize).min(last);
    [pixels[place], pixels[place + 1]].map(i32::from_le_bytes)
}

/// Wraps a column or row, which is at least -1, and the next one into the picture.
#[inline(always)]
fn beside<S: Simd>(i: i32x16<S>, count: i32x16<S>, wrap: Wrap) -> [i32x16<S>; 2] {
    let zero = i32x16::splat(i.simd, 0);
    let next = i + 1;
    match wrap {
        Wrap::Repeat => [i.simd_lt(0).select(count - 1, i), next.simd_ge(count).select(zero, next)],
        Wrap::Clamp => [i.max(zero).min(count - 1), next.min(count - 1)],
    }
}

#[cfg(test)]
mod tests {
    use crate::simd::dispatch;
    use fearless_simd::Level;

    use super::*;
    use marraztu_core::accuracy::Filter;
    use marraztu_core::base::image::Picture;
    use marraztu_core::base::rng::Rng;
    use marraztu_core::scene::Texture;

    /// Returns the texels around a position, one by one: left and right in the lower row, then in
    /// the upper.
    fn around(texture: &Texture, at: [f32; 2]) -> [[[u8; 4]; 2]; 2] {
        let Size { width, height } = texture.picture.size();
        let bring = |i: i64, count: usize| {
            let count = i64::try_from(count).unwrap();
            let i = match texture.wrap {
                Wrap::Repeat => i.rem_euclid(count),
                Wrap::Clamp => i.clamp(0, count - 1),
            };
            usize::try_from(i).unwrap()
        };
        #[expect(clippy::cast_possible_truncation, reason = "small numbers")]
        let [column, row] = at.map(|x| (x - 0.5).floor() as i64);
        let texel = |i, j| {
            let (x, y) = (bring(column + i, width), bring(row + j, height));
            texture.picture.pixel(x, height - 1 - y)
        };
        [[texel(0, 0), texel(1, 0)], [texel(0, 1), texel(1, 1)]]
    }

    #[test]
    #[expect(clippy::cast_precision_loss, reason = "small numbers")]
    fn near_and_far_from_each_other_places_get_the_texels_around_them() {
        let mut rng = Rng::new(3);
        for _ in 0..3000 {
            let size = Size::new(1 + rng.index(40), 1 + rng.index(40));
            let pixels = (0..size.area()).map(|i| (i as f32).to_bits().to_le_bytes());
            let picture = Picture::from_pixels(size, pixels.collect()).unwrap();
            let wrap = rng.one_of(&[Wrap::Repeat, Wrap::Clamp]);
            let texture = Texture { wrap, ..Texture::new("counted", picture) };
            let levels = std::slice::from_ref(&texture);
            let sampler = Sampler::new(levels, Filter::Bilinear).unwrap();
            let sides = [size.width as f64, size.height as f64];
            let middle = sides.map(|side| rng.real(0.0, side));
            let reach = rng.one_of(&[0.5, 3.0, 8.0, 40.0]);
            #[expect(clippy::cast_possible_truncation, reason = "the nearest f32 is meant")]
            let mut along = |axis: usize| -> [f32; 16] {
                let (side, at) = (sides[axis], middle[axis]);
                std::array::from_fn(|_| (at + rng.real(-reach, reach)).clamp(0.0, side) as f32)
            };
            let [x, y] = [along(0), along(1)];
            let mut texels = [[[0; 16]; 2]; 2];
            dispatch!(Level::new(), simd => {
                let position = [f32x16::from_slice(simd, &x), f32x16::from_slice(simd, &y)];
                let level = MipLevel::first(&sampler, simd);
                let found = level.footprint(simd, &sampler, position).texels;
                for (to, from) in texels.as_flattened_mut().iter_mut().zip(found.as_flattened()) {
                    from.store_slice(to);
                }
            });
            for lane in 0..16 {
                let want = around(&texture, [x[lane], y[lane]]);
                let got = texels.map(|row| row.map(|texels| texels[lane].to_le_bytes()));
                assert_eq!(got, want, "{size:?} {wrap:?} {:?}", [x[lane], y[lane]]);
            }
        }
    }
}
