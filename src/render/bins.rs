//! What may be seen in which tile.
//!
//! Every thread that sets up triangles and lines has bins of its own, so that none waits for another.
//! What is seen does not depend on the order in which a tile looks at them.

use super::clip::ScreenVertex;
use super::coverage::PixelBox;
use super::hits::Hits;
use super::lines::{self, ScreenLine};
use super::small::{Queue, SMALL};
use super::tile::{TILE, TILE_SIDE};
use super::ways::setup::Plain;
use crate::base::image::Size;

/// A triangle that is not small, or not simple.
#[derive(Clone, Copy, Debug)]
pub(super) struct LargeTriangle {
    pub(super) corners: [ScreenVertex; 3],
    pub(super) number: u32,
    /// Whether its texture decides where it is drawn.
    pub(super) cutout: bool,
}

/// What one tile has to look at besides its hits.
#[derive(Debug, Default)]
pub(super) struct Bin {
    /// Triangles, as places in [`Bins::large`], or among those that are drawn one by one.
    pub(super) large: Vec<u32>,
    /// Lines, as places in [`Bins::lines`].
    pub(super) lines: Vec<u32>,
}

/// The bins of one thread.
#[derive(Debug, Default)]
pub(super) struct Bins {
    columns: i32,
    rows: i32,
    pub(super) tiles: Vec<Bin>,
    pub(super) hits: Hits,
    pub(super) large: Vec<LargeTriangle>,
    /// Triangles that are drawn one by one, with their boxes: then there are no others.
    plain: Vec<(Plain, PixelBox)>,
    pub(super) lines: Vec<ScreenLine>,
    /// Small triangles that wait to be drawn together, by the size of their boxes.
    pub(super) queues: Box<[Queue; SMALL.len()]>,
    /// How many triangles, or pieces of such, are in the bins.
    pub(super) drawn: usize,
}

/// How many tiles there are in a row, and how many rows of them.
pub(super) fn tiles_of(size: Size) -> [i32; 2] {
    [size.width, size.height].map(|pixels| {
        i32::try_from(pixels.div_ceil(TILE_SIDE)).expect("pictures have 32-bit sizes")
    })
}

impl Bins {
    /// Empties the bins, for a picture of this size.
    pub(super) fn clear(&mut self, size: Size) {
        [self.columns, self.rows] = tiles_of(size);
        let count = usize::try_from(self.columns * self.rows).expect("not negative");
        self.tiles.resize_with(count, Bin::default);
        for bin in &mut self.tiles {
            bin.large.clear();
            bin.lines.clear();
        }
        let extent = [size.width, size.height]
            .map(|pixels| i32::try_from(pixels).expect("pictures have 32-bit sizes"));
        self.hits.clear(extent, [self.columns, self.rows]);
        self.large.clear();
        self.plain.clear();
        self.lines.clear();
        // A frame that was given up leaves some behind.
        for queue in self.queues.iter_mut() {
            queue.clear();
        }
        self.drawn = 0;
    }

    /// Whether nothing reaches into a tile.
    pub(super) fn is_empty(&self, tile: usize) -> bool {
        let bin = &self.tiles[tile];
        self.hits.is_empty(tile) && bin.large.is_empty() && bin.lines.is_empty()
    }

    /// Adds a triangle of any size, whose box of pixels is this.
    pub(super) fn add_large(&mut self, triangle: LargeTriangle, bounds: PixelBox) {
        let number = u32::try_from(self.large.len()).expect("fewer than 2^32 triangles");
        self.drawn += 1;
        self.large.push(triangle);
        self.each(bounds, |bin| bin.large.push(number));
    }

    /// Adds a triangle that is drawn pixel by pixel, somewhere in a box.
    pub(super) fn add_plain(&mut self, triangle: Plain, bounds: PixelBox) {
        let number = u32::try_from(self.plain.len()).expect("fewer than 2^32 triangles");
        self.drawn += 1;
        self.plain.push((triangle, bounds));
        self.each(bounds, |bin| bin.large.push(number));
    }

    /// A triangle that is drawn pixel by pixel, and its box.
    pub(super) fn plain(&self, number: u32) -> (&Plain, PixelBox) {
        let (plain, bounds) = &self.plain[number as usize];
        (plain, *bounds)
    }

    /// Adds a line of so many pixels' width to the tiles that it crosses.
    pub(super) fn add_line(&mut self, line: ScreenLine, width: i32) {
        let number = u32::try_from(self.lines.len()).expect("fewer than 2^32 lines");
        self.lines.push(line);
        let picture =
            PixelBox { left: 0, top: 0, right: self.columns * TILE, bottom: self.rows * TILE };
        for bounds in lines::stretches(&line, width, picture) {
            self.each(bounds, |bin| bin.lines.push(number));
        }
    }

    fn each(&mut self, bounds: PixelBox, mut add: impl FnMut(&mut Bin)) {
        if bounds.is_empty() {
            return;
        }
        for row in tiles(bounds.top, bounds.bottom, self.rows) {
            for column in tiles(bounds.left, bounds.right, self.columns) {
                add(&mut self.tiles[(row * self.columns + column) as usize]);
            }
        }
    }
}

/// The tiles of one direction that a range of pixels reaches into, of `count`.
#[inline(always)]
fn tiles(low: i32, high: i32, count: i32) -> std::ops::Range<i32> {
    low.div_euclid(TILE).max(0)..((high - 1).div_euclid(TILE) + 1).min(count)
}
