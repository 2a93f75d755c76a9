//! One picture of a shadow map, and its comparison with points.

use glam::DMat4;

use super::shaft::POINTS;
use crate::screen::tiles::{BLOCK_PIXELS, PIXELS, TILE_SIDE};
use crate::simd::Bits;

/// A picture of depths; 0 in empty texels.
#[derive(Debug)]
pub(super) struct Face {
    /// The rows of the transform from the world to (x, y, z, w), with x and y in texels times w.
    rows: [[f64; 4]; 4],
    side: usize,
    /// The depths, tile by tile, block by block, row by row.
    texels: Vec<f32>,
}

/// Returns the index of a texel in a picture with this many texels a side.
#[inline(always)]
pub(super) const fn place(side: usize, x: usize, y: usize) -> usize {
    let tile = y / TILE_SIDE * (side / TILE_SIDE) + x / TILE_SIDE;
    let (x, y) = (x % TILE_SIDE, y % TILE_SIDE);
    tile * PIXELS + (y / 8 * 8 + x / 8) * BLOCK_PIXELS + y % 8 * 8 + x % 8
}

/// The number of texels compared by percentage-closer filtering (PCF): 3 x 3.
pub(crate) const TAPS: u32 = 9;

/// The shadow map of one light.
#[derive(Debug)]
pub(crate) struct LightMap {
    pub(super) faces: Vec<Face>,
    pub(super) is_filtered: bool,
}

/// The result of reading a map at a batch of points.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reading {
    /// The points that no texel lets light through to.
    pub(crate) occluded: u64,
    /// The points that some texels let light through to, and others do not.
    pub(crate) partly: u64,
    /// The number of open texels for each of those points.
    pub(crate) open: [u8; POINTS],
}

impl Face {
    #[expect(clippy::cast_precision_loss, reason = "maps are small")]
    pub(super) fn new(clip_from_world: DMat4, side: usize, texels: Vec<f32>) -> Self {
        let half = side as f64 / 2.0;
        let [x, y, z, w] = clip_from_world.transpose().to_cols_array_2d();
        // Scales x and y from -1..1 to texels, with y down, before the division by w.
        let right = std::array::from_fn(|i| (x[i] + w[i]) * half);
        let down = std::array::from_fn(|i| (w[i] - y[i]) * half);
        Self { rows: [right, down, z, w], side, texels }
    }

    /// Returns whether a texel lets light through to a depth.
    #[inline(always)]
    fn is_open(&self, x: usize, y: usize, depth: f32) -> bool {
        depth >= self.texels[place(self.side, x, y)]
    }

    /// Counts the texels, of 3 x 3, that let light through to a depth. Texels at the border repeat.
    #[inline(always)]
    fn open_taps(&self, x: usize, y: usize, depth: f32) -> u32 {
        let around = |x: usize| [x.saturating_sub(1), x, (x + 1).min(self.side - 1)];
        let columns = around(x);
        let row = |y| columns.map(|x| u32::from(self.is_open(x, y, depth))).iter().sum::<u32>();
        around(y).into_iter().map(row).sum()
    }
}

impl LightMap {
    /// Reads the map at the points of a mask. Points outside all of its pictures are lit.
    #[inline(always)]
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        clippy::cast_precision_loss,
        reason = "inside of a map"
    )]
    pub(crate) fn read(&self, at: &[[f64; POINTS]; 3], mask: u64) -> Reading {
        let mut reading = Reading { occluded: 0, partly: 0, open: [0; POINTS] };
        let [mut x, mut y, mut z] = [[0.0_f64; POINTS]; 3];
        let mut left = mask;
        for face in &self.faces {
            let side = face.side as f64;
            let mut is_inside = [0_u8; POINTS];
            let row = |row: &[f64; 4], i: usize| {
                row[0] * at[0][i] + row[1] * at[1][i] + row[2] * at[2][i] + row[3]
            };
            // Projects all points, without branches.
            for i in 0..POINTS {
                let w = row(&face.rows[3], i);
                let by = 1.0 / w;
                (x[i], y[i]) = (row(&face.rows[0], i) * by, row(&face.rows[1], i) * by);
                z[i] = row(&face.rows[2], i) * by;
                // NaN counts as outside, because every comparison with it is false.
                let within = (w > 0.0) & (x[i] >= 0.0) & (x[i] < side) & (y[i] >= 0.0);
                is_inside[i] = u8::from(within & (y[i] < side));
            }
            // Compares the points of this picture one by one: each reads other texels.
            for i in Bits(left) {
                if is_inside[i] == 0 {
                    continue;
                }
                // The first picture that holds a point decides: pictures share only their borders.
                left &= !(1 << i);
                let (column, line, depth) = (x[i] as usize, y[i] as usize, z[i] as f32);
                if self.is_filtered {
                    let open = face.open_taps(column, line, depth);
                    reading.occluded |= u64::from(open == 0) << i;
                    reading.partly |= u64::from(open != 0 && open != TAPS) << i;
                    reading.open[i] = open as u8;
                } else {
                    reading.occluded |= u64::from(!face.is_open(column, line, depth)) << i;
                }
            }
            if left == 0 {
                break;
            }
        }
        reading
    }
}
