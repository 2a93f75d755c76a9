//! Draws pictures with 256 samples per pixel, each lit (supersampling), and parts of any picture.
//!
//! The picture is drawn 16 times as wide and high, with one sample per pixel, and each square of 16
//! x 16 pixels is averaged. Textures are therefore filtered for a sample, not for a whole pixel,
//! and thin lines keep their width. The larger picture is drawn window by window, which bounds its
//! memory and lets a caller draw only a part. Its colours are bytes, so a mean is up to half a step
//! off before it is rounded.

use rayon::prelude::*;

use super::{Cancelled, Renderer};
use crate::cancellation::Cancellation;
use crate::damage::Damage;
use crate::frame::{FramePlan, Viewport};
use crate::screen::coverage::{PixelBox, SUBPIXELS};
use crate::screen::tiles::{TILE, tiles_of};
use crate::shading::colors::mean;
use crate::shading::painter::Filled;
use marraztu_core::accuracy::Samples;
use marraztu_core::base::image::{Picture, Size};

/// The samples of a pixel along a side.
const MAGNIFIED: i32 = 16;

/// The logarithm to base 2 of the samples of a pixel.
const LOG2: u32 = 8;

/// The side of a window in pixels of the finished picture. Each window transforms all vertices
/// again, and its larger picture has 16 MiB.
const WINDOW: i32 = 2 * TILE;

impl Renderer {
    /// Draws a window of a picture without the rest of it.
    ///
    /// # Errors
    /// [`Cancelled`] if `wanted`, which every thread calls between tiles, returns false.
    ///
    /// # Panics
    /// If the plan has no windows ([`FramePlan::has_windows`]).
    pub fn render_window(
        &mut self,
        plan: &FramePlan,
        window: PixelBox,
        wanted: &(dyn Fn() -> bool + Sync),
    ) -> Result<Picture, Cancelled> {
        assert!(plan.has_windows(), "an enlarged picture has no windows");
        let size = size_of(window);
        if !plan.is_supersampled() {
            return Ok(self.render_while(&part_of(plan, window), wanted)?.clone());
        }
        let mut picture = Picture::filled(size, plan.background.opaque());
        for part in windows(window) {
            let colors = self.averaged(plan, part, wanted)?;
            let within = [part.left - window.left, part.top - window.top];
            copy(&colors, part, within, picture.pixels_mut(), size.width);
        }
        Ok(picture)
    }

    /// Returns the number of windows in which a whole picture with 256 samples per pixel is drawn.
    pub fn window_count(size: Size) -> usize {
        let side = usize::try_from(WINDOW).expect("positive");
        size.width.div_ceil(side) * size.height.div_ceil(side)
    }

    /// Draws the windows of the picture, or of the band, that contain damaged tiles.
    pub(super) fn draw_supersampled(
        &mut self,
        plan: &FramePlan,
        damage: &Damage,
        watch: &Cancellation<'_>,
    ) {
        let mut larger = self.larger.take().unwrap_or_else(|| Box::new(Self::new(self.level)));
        let [width, height] = [plan.size.width, self.picture.size().height]
            .map(|side| i32::try_from(side).expect("pictures have 32-bit sizes"));
        let columns = tiles_of(plan.size)[0];
        // Windows begin with the band, so none of them reaches beyond its rows.
        let top = i32::try_from(self.first_row).expect("below 2^26") * TILE;
        let band = PixelBox { left: 0, top, right: width, bottom: top + height };
        // The blocks of these tiles no longer have one colour.
        self.filled.fill(Filled::default());
        watch.expect_tiles(damage.tiles());
        for window in windows(band) {
            let tiles = (window.top / TILE..(window.bottom - 1) / TILE + 1).flat_map(|row| {
                (window.left / TILE..(window.right - 1) / TILE + 1)
                    .map(move |column| row * columns + column)
            });
            let damaged = |tile: &i32| damage.tiles.contains(usize::try_from(*tile).unwrap_or(0));
            let count = tiles.filter(damaged).count();
            if count == 0 {
                continue;
            }
            // If cancelled, the remaining windows stay as they are.
            let Ok(colors) = larger.averaged(plan, window, &|| watch.goes_on()) else { break };
            self.rays += larger.rays();
            let within = [window.left, window.top - top];
            copy(&colors, window, within, self.picture.pixels_mut(), plan.size.width);
            (0..count).for_each(|_| watch.tile_is_painted());
        }
        self.larger = Some(larger);
    }

    /// Draws a window larger, and returns the means of its squares, row by row.
    fn averaged(
        &mut self,
        plan: &FramePlan,
        window: PixelBox,
        wanted: &(dyn Fn() -> bool + Sync),
    ) -> Result<Vec<[u8; 4]>, Cancelled> {
        let larger = self.render_while(&magnified(plan, window), wanted)?;
        let side = usize::try_from(MAGNIFIED).expect("positive");
        let width = size_of(window).width;
        let (linear, stride) = (plan.variants.are_linear(), width * side);
        let mut colors = vec![[0; 4]; size_of(window).area()];
        let rows = larger.pixels().par_chunks(stride * side);
        colors.par_chunks_mut(width).zip(rows).for_each(|(colors, rows)| {
            for (column, color) in colors.iter_mut().enumerate() {
                let square = rows.chunks(stride).map(|row| &row[column * side..][..side]);
                *color = mean(square.flatten(), LOG2, linear);
            }
        });
        Ok(colors)
    }
}

/// Returns the plan of a window of a picture that is drawn as it is.
fn part_of(plan: &FramePlan, window: PixelBox) -> FramePlan {
    // The window's corner becomes the first pixel.
    let shift = [window.left, window.top].map(|at| at * SUBPIXELS);
    FramePlan { size: size_of(window), shift, ..plan.clone() }
}

/// Returns the plan of a window in which each pixel has become a square of pixels with one sample
/// each.
fn magnified(plan: &FramePlan, window: PixelBox) -> FramePlan {
    let Size { width, height } = size_of(window);
    let side = usize::try_from(MAGNIFIED).expect("positive");
    let times = f64::from(MAGNIFIED);
    FramePlan {
        size: Size::new(width * side, height * side),
        viewport: Viewport {
            width: plan.viewport.width * times,
            height: plan.viewport.height * times,
        },
        enlarged: None,
        samples: Samples::One,
        lit_by_sample: false,
        // The window's corner becomes the first pixel of the larger picture.
        shift: [window.left, window.top].map(|at| at * MAGNIFIED * SUBPIXELS),
        spacing: 1.0,
        line_width: plan.line_width * MAGNIFIED,
        stroke_width: plan.stroke_width * MAGNIFIED,
        // 1/256 of a smaller pixel is as fine as the fine grid, which has a smaller guard band.
        variants: plan.variants.on_usual_grid(),
        ..plan.clone()
    }
}

/// Divides a box of pixels into windows.
fn windows(all: PixelBox) -> impl Iterator<Item = PixelBox> {
    let starts = |from: i32, to: i32| (from..to).step_by(usize::try_from(WINDOW).unwrap_or(1));
    starts(all.top, all.bottom).flat_map(move |top| {
        starts(all.left, all.right).map(move |left| {
            PixelBox { left, top, right: left + WINDOW, bottom: top + WINDOW }.intersection(all)
        })
    })
}

fn size_of(window: PixelBox) -> Size {
    let side = |from: i32, to: i32| usize::try_from(to - from).unwrap_or(0);
    Size::new(side(window.left, window.right), side(window.top, window.bottom))
}

/// Copies the colours of a window to a picture of this width.
fn copy(colors: &[[u8; 4]], window: PixelBox, at: [i32; 2], pixels: &mut [[u8; 4]], width: usize) {
    let [left, top] = at.map(|i| usize::try_from(i).unwrap_or(0));
    let own = size_of(window).width;
    for (row, from) in colors.chunks(own).enumerate() {
        pixels[(top + row) * width + left..][..own].copy_from_slice(from);
    }
}
