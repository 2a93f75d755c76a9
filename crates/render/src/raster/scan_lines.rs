//! Rasterises a triangle in one tile by scan lines: ancestor B's fill rule, vectorised.
//!
//! As in software before edge functions, corners are rounded to whole pixels. Each row runs from
//! the left edge to the right edge, rounded and inclusive. Neighbours therefore cover shared pixels
//! twice, and some covered pixels have their centres outside. Rows are found one by one and then
//! filled sixteen pixels at a time.

use fearless_simd::{
    Select as _, Simd, SimdBase as _, SimdCombine as _, SimdMask as _, f32x8, f32x16, mask32x16,
};

use super::alpha_test::BlockHoles;
use super::depth_format::Format;
use super::edges_in_floats::ACROSS;
use super::visibility_buffer::{in_front, put_rows};
use crate::screen::coverage::PixelBox;
use crate::screen::tiles::{BLOCK, BLOCK_PIXELS, TILE_SIDE};

/// A row of a triangle.
#[derive(Clone, Copy, Debug)]
struct ScanLine {
    /// The first and last covered column.
    first: f32,
    last: f32,
    /// The left end, the depth there, and its step to the right.
    left: f32,
    depth: f32,
    per_pixel: f32,
}

/// A row without pixels.
const EMPTY: ScanLine = ScanLine { first: 1.0, last: 0.0, left: 0.0, depth: 0.0, per_pixel: 0.0 };

/// The rows of a triangle in a tile.
#[derive(Clone, Debug)]
pub(crate) struct ScanLines {
    rows: [ScanLine; TILE_SIDE],
    /// The first column of the tile.
    left: f32,
    low: f32,
    /// The largest depth of the corners.
    pub(crate) high: f32,
    number: u32,
    /// The possibly covered pixels, relative to the tile's first.
    pub(crate) area: PixelBox,
}

impl ScanLines {
    /// Finds the rows of a triangle with corners in pixels. `None` if no row is in the tile.
    #[expect(clippy::cast_possible_truncation, reason = "whole pixels are meant")]
    #[expect(clippy::cast_precision_loss, reason = "columns and rows are small")]
    pub(crate) fn new(
        pixels: [[f32; 2]; 3],
        depths: [f32; 3],
        number: u32,
        tile: PixelBox,
    ) -> Option<Self> {
        let corners = pixels.map(|at| at.map(|x| x.round() as i32));
        let [columns, lines] = [0, 1].map(|axis| corners.map(|corner| corner[axis]));
        let least = |of: [i32; 3]| of[0].min(of[1]).min(of[2]);
        let most = |of: [i32; 3]| of[0].max(of[1]).max(of[2]);
        // The end pixels are inclusive, hence the additional row and column.
        let own = PixelBox {
            left: least(columns),
            top: least(lines),
            right: most(columns) + 1,
            bottom: most(lines) + 1,
        };
        let area = own.in_tile(tile)?;
        let mut rows = [EMPTY; TILE_SIDE];
        for y in area.top..area.bottom {
            rows[y as usize % TILE_SIDE] = scan_line(corners, depths, tile.top + y);
        }
        let [a, b, c] = depths;
        Some(Self {
            rows,
            left: tile.left as f32,
            low: a.min(b).min(c),
            high: a.max(b).max(c),
            number,
            area,
        })
    }

    /// Draws the rows into a block of the visibility buffer.
    #[inline(always)]
    pub(crate) fn draw<S: Simd>(
        &self,
        format: Format,
        simd: S,
        block: usize,
        holes: Option<&BlockHoles<'_, '_, '_>>,
        visibility: &mut [u64; BLOCK_PIXELS],
    ) {
        let (column, row) = (block % 8 * 8, block / 8 % 8 * 8);
        let x = f32x16::from_slice(simd, &ACROSS) + (self.left + column as f32);
        let (pairs, _) = visibility.as_chunks_mut::<16>();
        for (pair, visibility) in pairs.iter_mut().enumerate() {
            let (up, down) = (self.rows[row + 2 * pair], self.rows[row + 2 * pair + 1]);
            // The upper half of the lanes holds one row, the lower half the next.
            let both = |of: fn(&ScanLine) -> f32| -> f32x16<S> {
                f32x8::splat(simd, of(&up)).combine(f32x8::splat(simd, of(&down)))
            };
            let mut covered = x.simd_ge(both(|row| row.first)) & x.simd_le(both(|row| row.last));
            if !covered.any_true() {
                continue;
            }
            let way = x - both(|row| row.left);
            let depth = both(|row| row.depth) + both(|row| row.per_pixel) * way;
            // Rounding must not move a depth beyond the depths of the corners.
            let (low, high) = (f32x16::splat(simd, self.low), f32x16::splat(simd, self.high));
            let depth = depth.simd_gt(low).select(depth, low);
            let depth: f32x16<S> = depth.simd_lt(high).select(depth, high);
            if let Some(holes) = holes {
                let front = in_front(format, simd, covered, depth, self.number, visibility);
                covered = mask32x16::from_bitmask(simd, holes.opaque_pixels(pair, front));
            }
            put_rows(format, simd, covered, depth, self.number, visibility);
        }
    }

    /// Returns the possibly covered blocks.
    pub(crate) fn blocks(&self) -> impl Iterator<Item = usize> {
        let PixelBox { left, top, right, bottom } = self.area;
        let columns = left / BLOCK..(right - 1) / BLOCK + 1;
        (top / BLOCK..(bottom - 1) / BLOCK + 1)
            .flat_map(move |row| columns.clone().map(move |column| (row * 8 + column) as usize))
    }
}

/// Finds one row, from its left edge to its right edge.
#[expect(clippy::cast_precision_loss, reason = "columns and rows are small")]
fn scan_line(corners: [[i32; 2]; 3], depths: [f32; 3], y: i32) -> ScanLine {
    // The ends of the row: column and depth.
    let mut ends = [[f32::INFINITY, 0.0], [f32::NEG_INFINITY, 0.0]];
    for i in 0..3 {
        let (p, q) = (corners[i], corners[(i + 1) % 3]);
        let (dp, dq) = (depths[i], depths[(i + 1) % 3]);
        if y < p[1].min(q[1]) || y > p[1].max(q[1]) {
            continue;
        }
        // A level edge contributes both of its ends.
        let down = (q[1] - p[1]) as f32;
        let parts = if down == 0.0 { [0.0, 1.0] } else { [(y - p[1]) as f32 / down; 2] };
        for t in parts {
            let end = [p[0] as f32 + t * (q[0] - p[0]) as f32, dp + t * (dq - dp)];
            if end[0] < ends[0][0] {
                ends[0] = end;
            }
            if end[0] > ends[1][0] {
                ends[1] = end;
            }
        }
    }
    let [[left, from], [right, to]] = ends;
    let per_pixel = if right > left { (to - from) / (right - left) } else { 0.0 };
    ScanLine { first: left.round(), last: right.round(), left, depth: from, per_pixel }
}
