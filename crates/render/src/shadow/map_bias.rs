//! Moves the depths of a shadow map away from the light: the per-texel bias against shadow acne.
//!
//! Each tile is copied with a border of one texel. Sixteen texels of a row and all of their
//! neighbours can then be loaded without checks.

use crate::simd::dispatch;
use fearless_simd::{Level, Select as _, Simd, SimdBase as _, f32x16};

use super::map_face::place;
use crate::screen::tiles::{BLOCK_PIXELS, TILE_SIDE};

/// The relative bias of depths that allows for rounding in f32.
const ROUNDING: f32 = 4.0 * f32::EPSILON;

/// The limits of the bias.
pub(super) struct Limit {
    /// The largest distance, in texels, between a texel's centre and a point compared with it.
    pub(super) reach: f32,
    /// The largest slope taken into account; in perspective, relative to the depth.
    pub(super) steepest: f32,
    pub(super) is_perspective: bool,
}

/// A light's view: a depth per texel (0 if empty), and the slope of its triangle.
#[derive(Clone, Copy)]
pub(super) struct Picture<'a> {
    pub(super) side: usize,
    pub(super) depths: &'a [f32],
    pub(super) slopes: &'a [f32],
}

/// The rows of a tile with its border, and the distance between the starts of two rows.
const ROWS: usize = TILE_SIDE + 2;
const STRIDE: usize = TILE_SIDE + 16;

/// A tile with its border, row by row. Texels beyond the picture are 0 and add no bias.
#[derive(Debug)]
pub(super) struct Bordered {
    depths: Vec<f32>,
    slopes: Vec<f32>,
}

impl Default for Bordered {
    fn default() -> Self {
        let none = vec![0.0; ROWS * STRIDE];
        Self { depths: none.clone(), slopes: none }
    }
}

impl Bordered {
    /// Computes the biased depths of a tile.
    pub(super) fn biased(
        &mut self,
        level: Level,
        picture: Picture<'_>,
        (tile, limit): (usize, &Limit),
        texels: &mut [f32],
    ) {
        let columns = picture.side / TILE_SIDE;
        self.copy(picture, [tile % columns * TILE_SIDE, tile / columns * TILE_SIDE]);
        dispatch!(level, simd => self.moved(simd, limit, texels));
    }

    /// Copies a tile, given by its first texel, and its border.
    fn copy(&mut self, picture: Picture<'_>, [left, top]: [usize; 2]) {
        let Picture { side, .. } = picture;
        for row in 0..ROWS {
            for (to, from) in
                [(&mut self.depths, picture.depths), (&mut self.slopes, picture.slopes)]
            {
                let to = &mut to[row * STRIDE..][..ROWS];
                // Rows beyond the picture are empty and add no bias.
                let Some(y) = (top + row).checked_sub(1).filter(|y| *y < side) else {
                    to.fill(0.0);
                    continue;
                };
                let texel = |x: usize| if x < side { from[place(side, x, y)] } else { 0.0 };
                // The border columns belong to other tiles; the columns between are whole blocks.
                to[0] = left.checked_sub(1).map_or(0.0, texel);
                to[ROWS - 1] = texel(left + TILE_SIDE);
                for (block, to) in to[1..].chunks_exact_mut(8).enumerate() {
                    to.copy_from_slice(&from[place(side, left + 8 * block, y)..][..8]);
                }
            }
        }
    }

    /// Applies the bias to the depths of the tile.
    #[inline(always)]
    fn moved<S: Simd>(&self, simd: S, limit: &Limit, texels: &mut [f32]) {
        let zero = f32x16::splat(simd, 0.0);
        for y in 0..TILE_SIDE {
            for x in (0..TILE_SIDE).step_by(16) {
                let depth = self.depths_at(simd, x + 1, y + 1);
                let slope = self.slope_around(simd, [x, y], depth);
                // The bias is the slope times the reach, plus the rounding; in perspective, limits
                // scale with depth.
                let steepest = f32x16::splat(simd, limit.steepest);
                let most = if limit.is_perspective { steepest * depth } else { steepest };
                let moved = depth - slope.min(most) * limit.reach - depth * ROUNDING;
                // A drawn texel stays above 0, because 0 marks an empty one.
                let moved = moved.max(f32x16::splat(simd, f32::MIN_POSITIVE));
                // Empty texels stay 0. The row is split into two blocks because textures are stored
                // by block.
                let mut row = [0.0; 16];
                depth.simd_gt(zero).select(moved, zero).store_slice(&mut row);
                for (block, row) in row.chunks_exact(8).enumerate() {
                    let at = (y / 8 * 8 + x / 8 + block) * BLOCK_PIXELS + y % 8 * 8;
                    texels[at..at + 8].copy_from_slice(row);
                }
            }
        }
    }

    #[inline(always)]
    fn depths_at<S: Simd>(&self, simd: S, x: usize, y: usize) -> f32x16<S> {
        f32x16::from_slice(simd, &self.depths[y * STRIDE + x..][..16])
    }

    /// Returns the largest slope around each of sixteen texels: of the texel itself and of the
    /// neighbours that continue its surface.
    #[inline(always)]
    fn slope_around<S: Simd>(&self, simd: S, [x, y]: [usize; 2], depth: f32x16<S>) -> f32x16<S> {
        let slopes = |x, y| f32x16::from_slice(simd, &self.slopes[y * STRIDE + x..][..16]);
        let own = slopes(x + 1, y + 1);
        let mut slope = own;
        for y in y..y + 3 {
            for x in x..x + 3 {
                let other = slopes(x, y);
                // The plane of a neighbour continues this one if its depth is within reach of both
                // slopes.
                let away = (self.depths_at(simd, x, y) - depth).abs();
                let continues = away.simd_le((own + other) * 2.0);
                slope = slope.max(continues.select(other, own));
            }
        }
        slope
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::screen::tiles::PIXELS;
    use marraztu_core::base::rng::Rng;

    /// The same bias, texel by texel.
    fn moved(picture: Picture<'_>, limit: &Limit, [x, y]: [usize; 2]) -> f32 {
        let Picture { side, depths, slopes } = picture;
        let (depth, own) = (depths[place(side, x, y)], slopes[place(side, x, y)]);
        if depth == 0.0 {
            return 0.0;
        }
        let mut slope = own;
        for y in y.saturating_sub(1)..=(y + 1).min(side - 1) {
            for x in x.saturating_sub(1)..=(x + 1).min(side - 1) {
                let other = slopes[place(side, x, y)];
                if (depths[place(side, x, y)] - depth).abs() <= (own + other) * 2.0 {
                    slope = slope.max(other);
                }
            }
        }
        let most = if limit.is_perspective { limit.steepest * depth } else { limit.steepest };
        (depth - limit.reach * slope.min(most) - depth * ROUNDING).max(f32::MIN_POSITIVE)
    }

    #[test]
    fn sixteen_texels_are_moved_as_each_by_itself() {
        let (mut rng, side) = (Rng::new(7), 2 * TILE_SIDE);
        for round in 0..8 {
            let mut numbers = |most: usize, unit: f32| -> Vec<f32> {
                (0..4 * PIXELS).map(|_| rng.index(most) as f32 * unit).collect()
            };
            // A quarter of the texels is empty; some slopes join surfaces, and some do not.
            let (mut depths, slopes) = (numbers(4, 0.25), numbers(9, 0.02));
            for (depth, more) in depths.iter_mut().zip(numbers(100, 1e-3)) {
                *depth = if *depth == 0.0 { 0.0 } else { *depth - more };
            }
            let picture = Picture { side, depths: &depths, slopes: &slopes };
            let limit = Limit { reach: 1.51, steepest: 0.1, is_perspective: round % 2 == 0 };
            for level in crate::simd::levels() {
                for tile in 0..4 {
                    let mut texels = [0.0; PIXELS];
                    Bordered::default().biased(level, picture, (tile, &limit), &mut texels);
                    for i in 0..PIXELS {
                        let (x, y) = (i % TILE_SIDE, i / TILE_SIDE);
                        let at = [tile % 2 * TILE_SIDE + x, tile / 2 * TILE_SIDE + y];
                        let got = texels[place(TILE_SIDE, x, y)];
                        assert_eq!(got, moved(picture, &limit, at), "{at:?}");
                    }
                }
            }
        }
    }
}
