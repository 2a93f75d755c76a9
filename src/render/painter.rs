//! Paints tiles: what is seen in a tile, its colours, and the copy into the picture.
//!
//! A painter stays with its thread from frame to frame, so that a frame allocates and clears nothing
//! for its tiles. A tile that showed nothing but the background and still does is not touched.

use super::bins::tiles_of;
use super::colors::Sums;
use super::coverage::PixelBox;
use super::effects::Light;
use super::places::FOUR;
use super::resolve::Samples;
use super::surface::{Out, Scenery, Shader};
use super::tile::{BLOCK_PIXELS, TILE, TILE_SIDE, Visibility};
use crate::base::color::Color;
use crate::base::image::Size;

/// The pixels of a tile; tiles are counted along rows.
pub(super) fn bounds_of(tile: usize, size: Size) -> PixelBox {
    let [columns, _] = tiles_of(size);
    let tile = i32::try_from(tile).expect("pictures have 32-bit sizes");
    let (left, top) = (tile % columns * TILE, tile / columns * TILE);
    let [right, bottom] = [size.width, size.height]
        .map(|pixels| i32::try_from(pixels).expect("pictures have 32-bit sizes"));
    let picture = PixelBox { left: 0, top: 0, right, bottom };
    PixelBox { left, top, right: left + TILE, bottom: top + TILE }.intersection(picture)
}

/// The rows of the picture that a row of tiles lies in.
#[derive(Debug)]
pub(super) struct Band<'a> {
    pub(super) pixels: &'a mut [[u8; 4]],
    /// For each of its tiles the colour that fills it as a whole, where one is known to.
    pub(super) filled: &'a mut [Option<Color>],
}

/// Where a block stands in the rows of its tile.
fn place_of([x, y]: [i32; 2], bounds: PixelBox) -> usize {
    let [x, y] =
        [x - bounds.left, y - bounds.top].map(|i| usize::try_from(i).expect("in the tile"));
    y * TILE_SIDE + x
}

/// Puts the means of 2^`log2` samples into the rows of a tile, from `at` on.
fn put_means(sums: &Sums, log2: u32, tile: &mut [[u8; 4]], at: usize) {
    for (i, mean) in sums.means(log2).enumerate() {
        tile[at + i / BLOCK_SIDE * TILE_SIDE + i % BLOCK_SIDE] = mean;
    }
}

/// Pixels to a side of a block.
const BLOCK_SIDE: usize = 8;

/// Blocks of a tile.
pub(super) const BLOCKS: usize = TILE_SIDE * TILE_SIDE / BLOCK_PIXELS;

/// Draws one tile after another.
#[derive(Debug)]
pub(super) struct Painter<T> {
    shader: Shader<T>,
    visibility: Visibility,
    samples: Samples,
    pixels: Box<[[u8; 4]; TILE_SIDE * TILE_SIDE]>,
}

impl<T: Light> Default for Painter<T> {
    fn default() -> Self {
        Self {
            shader: Shader::default(),
            visibility: Visibility::default(),
            samples: Samples::default(),
            pixels: Box::new([[0; 4]; TILE_SIDE * TILE_SIDE]),
        }
    }
}

impl<T: Light> Painter<T> {
    /// Gets ready for another frame.
    pub(super) const fn begin(&mut self) {
        self.shader.begin();
    }

    /// Paints a tile; says whether it shows anything but the background.
    pub(super) fn paint(&mut self, scenery: &Scenery<'_, T>, tile: usize) -> bool {
        let Scenery { level, plan, frame, .. } = *scenery;
        if frame.is_empty(tile) {
            return false;
        }
        let bounds = bounds_of(tile, plan.size);
        self.visibility.draw(level, plan, frame, (tile, bounds));
        self.shader.tile.begin(plan, &self.visibility, bounds);
        self.pixels.fill(plan.background.opaque());
        let mut shows = false;
        for block in 0..BLOCKS {
            if !self.visibility.shows(block) {
                continue;
            }
            let corner = self.visibility.corner(block);
            let (tile, at) = (&mut self.pixels[..], place_of(corner, bounds));
            if let Some(number) = self.visibility.whole(block) {
                self.shader.whole_block(scenery, number, corner, &mut Out::Tile(tile, at));
                shows = true;
            } else if frame.places().are_many() {
                shows |= self.paint_samples(scenery, block, at);
            } else {
                let words = self.visibility.block(block);
                shows |= self.shader.block(scenery, words, corner, (tile, at));
            }
        }
        shows
    }

    /// Paints a block whose pixels have four samples.
    fn paint_samples(&mut self, scenery: &Scenery<'_, T>, block: usize, at: usize) -> bool {
        let Self { shader, visibility, samples, pixels, .. } = self;
        let (planes, corner) = (visibility.planes(block), visibility.corner(block));
        let tile = &mut pixels[..];
        if samples.compare(scenery.level, planes) {
            return shader.block(scenery, &planes[0], corner, (tile, at));
        }
        let mut sums = Sums::default();
        let shows = shader.add_samples(scenery, (samples, planes), corner, &mut sums);
        put_means(&sums, FOUR.ilog2(), tile, at);
        shows
    }

    /// Adds the colours of four samples of a tile to those of others, block by block.
    pub(super) fn add(&mut self, scenery: &Scenery<'_, T>, tile: usize, to: &mut [Sums]) {
        let Scenery { level, plan, frame, .. } = *scenery;
        let (background, all) = (plan.background.opaque(), FOUR as i32);
        if frame.is_empty(tile) {
            return to.iter_mut().for_each(|sums| sums.add_everywhere(background, all));
        }
        let bounds = bounds_of(tile, plan.size);
        let Self { shader, visibility, samples, .. } = self;
        visibility.draw(level, plan, frame, (tile, bounds));
        shader.tile.begin(plan, visibility, bounds);
        for (block, to) in to.iter_mut().enumerate() {
            if !visibility.shows(block) {
                to.add_everywhere(background, all);
                continue;
            }
            let corner = visibility.corner(block);
            if let Some(number) = visibility.whole(block) {
                shader.whole_block(scenery, number, corner, &mut Out::Sums(to));
            } else {
                let planes = visibility.planes(block);
                samples.compare(level, planes);
                shader.add_samples(scenery, (samples, planes), corner, to);
            }
        }
    }

    /// Takes the means of all samples of a tile for its pixels.
    pub(super) fn take_means(&mut self, of: &[Sums], samples: u32) {
        for (block, sums) in of.iter().enumerate() {
            let (x, y) = (block % 8 * 8, block / 8 * 8);
            put_means(sums, samples.ilog2(), &mut self.pixels[..], y * TILE_SIDE + x);
        }
    }

    /// Copies what was painted into its band of the picture.
    pub(super) fn copy(&self, tile: usize, size: Size, band: &mut Band<'_>) {
        let (column, place) = Self::place(tile, size);
        band.filled[column] = None;
        for (from, to) in self.pixels.chunks(TILE_SIDE).zip(band.pixels.chunks_mut(size.width)) {
            to[place.clone()].copy_from_slice(&from[..place.len()]);
        }
    }

    /// Fills a tile with a colour, where it is not filled with it.
    pub(super) fn fill(tile: usize, size: Size, color: Color, band: &mut Band<'_>) {
        let (column, place) = Self::place(tile, size);
        if band.filled[column] != Some(color) {
            band.filled[column] = Some(color);
            for row in band.pixels.chunks_mut(size.width) {
                row[place.clone()].fill(color.opaque());
            }
        }
    }

    /// Which tile of its band it is, and its columns of the picture.
    fn place(tile: usize, size: Size) -> (usize, std::ops::Range<usize>) {
        let column = tile % size.width.div_ceil(TILE_SIDE);
        let left = column * TILE_SIDE;
        (column, left..size.width.min(left + TILE_SIDE))
    }
}
