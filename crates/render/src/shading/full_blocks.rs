//! Blocks that one triangle covers fully.
//!
//! No list of fragments is made. Barycentric coordinates, interpolation and conversion to bytes are
//! one pass over the tile, two rows of a block at a time. The bits are the same as for listed
//! fragments, because the same integers and quotients are used in the same order.

use crate::simd::dispatch;
use fearless_simd::{
    Level, Simd, SimdBase as _, SimdInt as _, SimdNarrow as _, f32x16, f64x8, i32x16,
};

use super::interpolate::{CornerValues, Look, depth_between};
use super::quantize::reflected;
use super::texels::{OfFirst, PlacedTexture, TexelScratch};
use super::triangle_attributes::TriangleAttributes;
use crate::lights::{Batch, LightTerm, load, set, store};
use crate::plan::tile::TileLight;
use crate::screen::background::Background;
use crate::screen::clipped_weights::ClippedWeights;
use crate::screen::coverage::Triangle;
use crate::screen::perspective::{between, weighed};
use crate::screen::tiles::{BLOCK, BLOCK_PIXELS};
use crate::simd::gather::SLOTS;
use crate::simd::{Encoding, Lanes as _, Sixteen, Vec3};
use crate::texture::lanes::Stored;
use marraztu_core::accuracy::Interpolation;

/// The pixels of a tile, in rows that are `stride` pixels apart.
#[derive(Debug)]
pub(crate) struct Canvas<'a> {
    pub(crate) pixels: &'a mut [[u8; 4]],
    pub(crate) stride: usize,
}

impl Canvas<'_> {
    /// Stores the pixels of a whole block, row by row; `at` is the index of the first.
    #[inline(always)]
    pub(crate) fn put(&mut self, at: usize, pixels: &[u32]) {
        for (row, from) in pixels.as_chunks::<ROW>().0.iter().enumerate() {
            let to = &mut self.pixels[at + row * self.stride..][..ROW];
            for (to, from) in to.iter_mut().zip(from) {
                *to = from.to_le_bytes();
            }
        }
    }

    /// Fills a block with a colour; `at` is the index of its first pixel.
    #[inline(always)]
    pub(crate) fn fill(&mut self, at: usize, color: [u8; 4]) {
        for row in self.pixels[at..].chunks_mut(self.stride).take(ROW) {
            row[..ROW].fill(color);
        }
    }

    /// Fills a block with what the picture shows behind all surfaces; `corner` is its upper left
    /// pixel, and `at` the index of it.
    #[inline(always)]
    pub(crate) fn fill_behind(&mut self, at: usize, corner: [i32; 2], background: Background<'_>) {
        match background.even() {
            Some(color) => self.fill(at, color.opaque()),
            None => self.fill_panorama(at, corner, background),
        }
    }

    #[inline(never)]
    fn fill_panorama(&mut self, at: usize, corner: [i32; 2], background: Background<'_>) {
        for (row, y) in self.pixels[at..].chunks_mut(self.stride).take(ROW).zip(corner[1]..) {
            for (pixel, x) in row[..ROW].iter_mut().zip(corner[0]..) {
                *pixel = background.at([x, y]);
            }
        }
    }

    /// Returns the index of the first pixel of a block from [`Blocks::each`].
    #[inline(always)]
    pub(crate) fn offset_of(&self, first: [i32; 2]) -> usize {
        self.offset(first.map(|i| usize::try_from(i).expect("in the tile")))
    }

    /// Returns the index of a pixel of the tile, by column and row.
    #[inline(always)]
    pub(crate) const fn offset(&self, [x, y]: [usize; 2]) -> usize {
        y * self.stride + x
    }
}

/// The blocks of a tile that one triangle covers fully.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Blocks {
    /// A bit for each block.
    pub(crate) which: u64,
    /// The upper left pixel of the tile.
    pub(crate) corner: [i32; 2],
}

impl Blocks {
    /// Returns the number of pixels.
    pub(crate) const fn pixels(self) -> u64 {
        self.which.count_ones() as u64 * BLOCK_PIXELS as u64
    }

    /// Calls `each` with the column and row in the tile of the first pixel of each block.
    #[inline(always)]
    pub(crate) fn each(self, mut each: impl FnMut([i32; 2])) {
        let mut left = self.which;
        while left != 0 {
            let block = left.trailing_zeros().cast_signed();
            left &= left - 1;
            each([block % BLOCK * BLOCK, block / BLOCK * BLOCK]);
        }
    }
}

/// The pixels along a side of a block.
pub(crate) const ROW: usize = BLOCK as usize;
/// The pairs of rows in a block.
const PAIRS: usize = ROW / 2;
const COLUMNS: [f64; ROW] = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0];
/// The columns and rows of the pixels in two rows of a block.
const ACROSS: [i32; 16] = [0, 1, 2, 3, 4, 5, 6, 7, 0, 1, 2, 3, 4, 5, 6, 7];
const DOWN: [i32; 16] = [0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1, 1, 1];

/// A triangle with edge functions of at most 31 bits at its pixels.
#[derive(Clone, Copy, Debug)]
struct Narrow<S: Simd> {
    /// The edge functions at the first pixel of the picture, and their steps for one pixel to the
    /// right and one pixel down.
    edges: [[i32; 3]; 2],
    /// The offsets of the edge functions within two rows.
    gains: [i32x16<S>; 2],
    per_area: f32,
}

impl<S: Simd> Narrow<S> {
    #[inline(always)]
    fn new(simd: S, attributes: &TriangleAttributes<f32>) -> Self {
        let edges = attributes.edges.each_ref().map(|[a, b, c]| [c[0], a[0], b[0]]);
        let across = i32x16::from_slice(simd, &ACROSS);
        let down = i32x16::from_slice(simd, &DOWN);
        // These offsets are the same for every pair of rows, so each pair adds a single integer.
        let gains =
            [across * edges[0][1] + down * edges[0][2], across * edges[1][1] + down * edges[1][2]];
        Self { edges, gains, per_area: attributes.per_area[0] }
    }

    /// Computes a coordinate in two rows of pixels, from their first.
    #[inline(always)]
    fn at(&self, i: usize, [x, y]: [i32; 2]) -> f32x16<S> {
        // Modulo 2^32: products may wrap, but the sum fits.
        let [c, a, b] = self.edges[i];
        let first = a.wrapping_mul(x).wrapping_add(b.wrapping_mul(y));
        (self.gains[i] + first.wrapping_add(c)).to_float::<f32x16<S>>() * self.per_area
    }
}

impl<S: Simd> Narrow<S> {
    /// Computes the coordinates of a whole block, two rows at a time, from its first pixel.
    #[inline(always)]
    fn block(&self, [x, y]: [i32; 2]) -> [[f32x16<S>; 2]; PAIRS] {
        let pair = |pair| [x, y + 2 * pair];
        [
            [self.at(0, pair(0)), self.at(1, pair(0))],
            [self.at(0, pair(1)), self.at(1, pair(1))],
            [self.at(0, pair(2)), self.at(1, pair(2))],
            [self.at(0, pair(3)), self.at(1, pair(3))],
        ]
    }
}

/// A triangle with edge functions of more than 31 bits. They are integers below 2^53, which f64
/// holds exactly.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Wide<'a, S: Simd> {
    triangle: &'a Triangle,
    per_area: f64,
    /// The offsets of the edge functions in the first and second row of a block.
    gains: [[f64x8<S>; 2]; 2],
    /// The steps of the edge functions for two pixels down.
    down: [f64x8<S>; 2],
}

impl<'a, S: Simd> Wide<'a, S> {
    #[inline(always)]
    #[expect(clippy::cast_precision_loss, reason = "they have fewer than 53 bits")]
    pub(crate) fn new(simd: S, triangle: &'a Triangle) -> Self {
        let [[_, er, fr], [_, ed, fd]] = triangle.steps();
        // The edge functions of two rows, relative to the first pixel of the upper one.
        let columns = f64x8::from_slice(simd, &COLUMNS);
        let (e_columns, f_columns) = (columns * er as f64, columns * fr as f64);
        Self {
            triangle,
            per_area: 1.0 / triangle.doubled_area() as f64,
            gains: [[e_columns, e_columns + ed as f64], [f_columns, f_columns + fd as f64]],
            down: [f64x8::splat(simd, 2.0 * ed as f64), f64x8::splat(simd, 2.0 * fd as f64)],
        }
    }

    /// Steps an edge function to the two rows below.
    #[inline(always)]
    fn below(&self, i: usize, [a, b]: [f64x8<S>; 2]) -> [f64x8<S>; 2] {
        [a + self.down[i], b + self.down[i]]
    }

    /// Computes a coordinate in two rows, from the edge function.
    #[inline(always)]
    fn linear(&self, [a, b]: [f64x8<S>; 2]) -> f32x16<S> {
        (a * self.per_area).narrow(b * self.per_area)
    }

    /// Computes the coordinates of sixteen arbitrary pixels.
    #[inline(always)]
    #[expect(
        clippy::cast_precision_loss,
        clippy::cast_possible_truncation,
        reason = "the nearest number is meant"
    )]
    pub(crate) fn scattered(&self, simd: S, x: &[i32], y: &[i32]) -> [f32x16<S>; 2] {
        // One pixel at a time in 64-bit integers, because scattered pixels share no steps.
        let mut linear = [[0.0; 16]; 2];
        for (lane, (x, y)) in x.iter().zip(y).enumerate() {
            let [_, e, f] = self.triangle.edges_at(*x, *y);
            linear[0][lane] = (e as f64 * self.per_area) as f32;
            linear[1][lane] = (f as f64 * self.per_area) as f32;
        }
        [f32x16::from_slice(simd, &linear[0]), f32x16::from_slice(simd, &linear[1])]
    }
}

impl<S: Simd> Wide<'_, S> {
    /// Computes the coordinates of a whole block, two rows at a time, from its first pixel.
    #[inline(always)]
    #[expect(clippy::cast_precision_loss, reason = "they have fewer than 53 bits")]
    pub(crate) fn block(&self, [x, y]: [i32; 2]) -> [[f32x16<S>; 2]; PAIRS] {
        let [_, e, f] = self.triangle.edges_at(x, y);
        let e0 = [self.gains[0][0] + e as f64, self.gains[0][1] + e as f64];
        let f0 = [self.gains[1][0] + f as f64, self.gains[1][1] + f as f64];
        // All values are integers below 2^53, so stepping down adds no rounding error.
        let (e1, f1) = (self.below(0, e0), self.below(1, f0));
        let (e2, f2) = (self.below(0, e1), self.below(1, f1));
        let (e3, f3) = (self.below(0, e2), self.below(1, f2));
        [
            [self.linear(e0), self.linear(f0)],
            [self.linear(e1), self.linear(f1)],
            [self.linear(e2), self.linear(f2)],
            [self.linear(e3), self.linear(f3)],
        ]
    }
}

/// The perspective-correct weights of the second and third corner, and w.
type Weighted<S> = ([f32x16<S>; 2], f32x16<S>);

/// A triangle, as its pixels are weighted.
enum Points<'a, S: Simd> {
    /// Corners have no place on the screen: weights are computed one row at a time.
    Clipped(&'a ClippedWeights),
    /// Edge functions in 32-bit integers.
    Narrow(Narrow<S>),
    /// Edge functions in 64-bit integers and f64.
    Wide(Wide<'a, S>),
}

impl<S: Simd> Points<'_, S> {
    /// Computes the weights of a whole block, two rows at a time, from its first pixel.
    #[inline(always)]
    fn block(
        &self,
        lanes: Sixteen<S>,
        (interpolation, by_w): (Interpolation, Vec3<f32x16<S>>),
        first: [i32; 2],
    ) -> [Weighted<S>; PAIRS] {
        let [a, b, c, d] = match self {
            Self::Narrow(narrow) => narrow.block(first),
            Self::Wide(wide) => wide.block(first),
            Self::Clipped(of) => {
                let [x, y] = first;
                return [
                    two_rows(lanes.0, of, [x, y]),
                    two_rows(lanes.0, of, [x, y + 2]),
                    two_rows(lanes.0, of, [x, y + 4]),
                    two_rows(lanes.0, of, [x, y + 6]),
                ];
            }
        };
        [
            weighed(interpolation, lanes, a, by_w),
            weighed(interpolation, lanes, b, by_w),
            weighed(interpolation, lanes, c, by_w),
            weighed(interpolation, lanes, d, by_w),
        ]
    }
}

#[inline(always)]
fn two_rows<S: Simd>(simd: S, of: &ClippedWeights, [x, y]: [i32; 2]) -> Weighted<S> {
    let ([b, c], w) = of.of_row(simd, [x, y]);
    let ([b_below, c_below], w_below) = of.of_row(simd, [x, y + 1]);
    ([b.narrow(b_below), c.narrow(c_below)], w.narrow(w_below))
}

/// The lighting of fully covered blocks.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BlockLight<'a> {
    /// The weights of the triangle, if it is clipped.
    pub(crate) cut: Option<&'a ClippedWeights>,
    pub(crate) interpolation: Interpolation,
    /// The rounding thresholds of a block's pixels.
    pub(crate) thresholds: &'a [f32; BLOCK_PIXELS],
    /// The conversion from pixels to positions and normals; `None` if no light reads them.
    pub(crate) look: Option<Look<f32>>,
    /// The colour of the surface itself.
    pub(crate) tint: [f32; 3],
    /// The texture that multiplies it.
    pub(crate) texture: Option<PlacedTexture<'a>>,
    /// The vertex colours that multiply it.
    pub(crate) vertex_colors: Option<&'a CornerValues<f32>>,
    /// The lights, if the surface is lit.
    pub(crate) lights: Option<TileLight<'a>>,
    /// The products of the lights and the material.
    pub(crate) terms: &'a [LightTerm<f32>],
    /// The emitted light added to every colour, if the surface has any.
    pub(crate) glow: Option<[f32; 3]>,
    /// The encoding, if colours are linear.
    pub(crate) encoding: Option<&'a Encoding>,
}

/// Colours blocks that the first triangle, with normals at its corners, covers fully. Does nothing
/// and returns false if the triangle has no area.
pub(crate) fn color(
    level: Level,
    attributes: &TriangleAttributes<f32>,
    blocks: Blocks,
    (light, batch, scratch): (BlockLight<'_>, &mut Batch<f32>, &mut TexelScratch),
    canvas: &mut Canvas<'_>,
) -> bool {
    let is_wide = light.cut.is_none() && attributes.wide & 1 != 0;
    let wide = match is_wide {
        true => Triangle::on(attributes.grid, attributes.corners(0)),
        false => None,
    };
    // A wide triangle may have no area.
    if is_wide && wide.is_none() {
        return false;
    }
    dispatch!(level, simd => {
        let points = match (light.cut, &wide) {
            (Some(cut), _) => Points::Clipped(cut),
            (None, Some(triangle)) => Points::Wide(Wide::new(simd, triangle)),
            (None, None) => Points::Narrow(Narrow::new(simd, attributes)),
        };
        colored(simd, attributes, &points, blocks, (light, (batch, scratch)), canvas);
    });
    true
}

#[inline(always)]
fn colored<S: Simd>(
    simd: S,
    attributes: &TriangleAttributes<f32>,
    points: &Points<'_, S>,
    blocks: Blocks,
    (light, (batch, scratch)): (BlockLight<'_>, (&mut Batch<f32>, &mut TexelScratch)),
    canvas: &mut Canvas<'_>,
) {
    let lanes = Sixteen(simd);
    let BlockLight { thresholds, look, tint, texture, vertex_colors, lights, terms, .. } = light;
    let BlockLight { glow, encoding, interpolation, .. } = light;
    let by = (interpolation, of_first(lanes, &attributes.by_w));
    let z = of_first(lanes, &attributes.z);
    let corners = corners(lanes, &attributes.values);
    let tint = set(lanes, tint);
    let is_colored = texture.is_some() || vertex_colors.is_some();
    let across = i32x16::from_slice(simd, &ACROSS);
    let down = i32x16::from_slice(simd, &DOWN);
    let [left, top] = blocks.corner;
    batch.len = BLOCK_PIXELS;
    // Light that reads no positions is equal in all blocks, and is computed for the first only.
    let mut is_lit = false;
    let TexelScratch { places, texels, colors } = scratch;
    blocks.each(
        #[inline(always)]
        |[column, row]| {
            let [x, y] = [left + column, top + row];
            // First pass over the block: positions, normals, texture positions and vertex colours.
            if look.is_some() || is_colored {
                let pairs = points.block(lanes, by, [x, y]);
                for ((pair, point), y) in pairs.into_iter().enumerate().zip((y..).step_by(2)) {
                    let (weights, w) = point;
                    if let Some(look) = &look {
                        let [x, y] = [across + x, down + y];
                        let place =
                            [x.to_float::<f32x16<S>>() + 0.5, y.to_float::<f32x16<S>>() + 0.5];
                        let normal = between(corners, weights);
                        let depth = || depth_between(z, weights);
                        let sample = look.at(lanes, normal, place, w, depth);
                        batch.put(lanes, sample, 16 * pair);
                    }
                    if let Some(texture) = &texture {
                        let way = texture.way(simd, &OfFirst, weights);
                        // A triangle with too many texels for f32 is placed in f64.
                        let position = match texture.far.first() {
                            Some(far) => far.of_two_rows(simd, [x, y]),
                            None => texture.position(simd, &OfFirst, way),
                        };
                        let to = (&mut *places, 16 * pair);
                        texture.put(simd, &OfFirst, (way, w), position, to);
                    }
                    if let Some(values) = vertex_colors {
                        let color = between(self::corners(lanes, values), weights);
                        store(lanes, color, colors, 16 * pair);
                    }
                }
            }
            // Texels, and then light, for the whole block at once.
            if let Some(texture) = &texture {
                texture.sampler.sample::<S, Stored>(simd, places, BLOCK_PIXELS, texels);
            }
            if let Some(lights) = &lights
                && (look.is_some() || !is_lit)
            {
                is_lit = true;
                lights.light_batch(terms, simd.level(), batch, None);
            }
            let mut at = canvas.offset([column as usize, row as usize]);
            // Second pass: surface colour times light, two rows at a time.
            for pair in 0..PAIRS {
                let mut pixels = [0; 16];
                let mut own = tint;
                if texture.is_some() {
                    own = own.product(load(lanes, texels, 16 * pair));
                }
                if vertex_colors.is_some() {
                    own = own.product(load(lanes, colors, 16 * pair));
                }
                let mut color = match lights {
                    Some(_) => reflected(lanes, own, batch, 16 * pair),
                    None => own,
                };
                if glow.is_some() || encoding.is_some() {
                    color = finished(lanes, color, glow, encoding);
                }
                // The dithering pattern has the size of a block, so thresholds repeat.
                let threshold = lanes.load(thresholds, 16 * pair);
                lanes.store_pixels_by(color, threshold, &mut pixels, 0);
                canvas.put(at, &pixels);
                at += 2 * canvas.stride;
            }
        },
    );
}

/// Adds the glow to a colour, and encodes it if it is linear.
#[inline(always)]
fn finished<S: Simd>(
    lanes: Sixteen<S>,
    mut color: Vec3<f32x16<S>>,
    glow: Option<[f32; 3]>,
    encoding: Option<&Encoding>,
) -> Vec3<f32x16<S>> {
    // No closures here: they would not be compiled for the caller's instruction set.
    if let Some(glow) = glow {
        color = color.plus(set(lanes, glow));
    }
    if let Some(encoding) = encoding {
        let Vec3([r, g, b]) = color;
        color = Vec3([encoding.of(r), encoding.of(g), encoding.of(b)]);
    }
    color
}

/// Three numbers of the first triangle, the same for all lanes.
#[inline(always)]
fn of_first<S: Simd>(lanes: Sixteen<S>, rows: &[[f32; SLOTS]; 3]) -> Vec3<f32x16<S>> {
    set(lanes, [rows[0][0], rows[1][0], rows[2][0]])
}

/// Returns the values at the corners of the first triangle.
#[inline(always)]
fn corners<S: Simd>(lanes: Sixteen<S>, values: &CornerValues<f32>) -> [Vec3<f32x16<S>>; 3] {
    let [a, b, c] = values;
    [of_first(lanes, a), of_first(lanes, b), of_first(lanes, c)]
}
