//! Which triangles and lines may touch which tile.
//!
//! Every thread that sets up triangles has bins of its own, so that none waits for another. What is
//! seen does not depend on the order in which a tile looks at them.
//!
//! Small triangles are kept ready to be rasterised sixteen at a time, in queues by the size of the
//! box of pixels that they may cover: 2 x 2, 4 x 4, 8 x 8.

use super::clip::ScreenVertex;
use super::coverage::{PixelBox, SUBPIXELS};
use super::tile::{TILE, TILE_SIDE};
use crate::base::image::Size;

/// Triangles in a pack.
pub(super) const PACK: usize = 16;

/// Pixels to a side of the boxes of the queues.
pub(super) const SMALL: [i32; 3] = [2, 4, 8];

/// Sixteen small triangles: coordinates in parts of a pixel from the tile's upper left corner.
#[derive(Clone, Copy, Debug, Default)]
#[repr(align(64))]
pub(super) struct Pack {
    pub(super) x: [[f32; PACK]; 3],
    pub(super) y: [[f32; PACK]; 3],
    pub(super) depth: [[f32; PACK]; 3],
    /// Column and row of the first pixel of the box, from the tile's.
    pub(super) left: [i32; PACK],
    pub(super) top: [i32; PACK],
    pub(super) number: [u32; PACK],
}

/// A triangle that is not small, or not simple.
#[derive(Clone, Copy, Debug)]
pub(super) struct LargeTriangle {
    pub(super) corners: [ScreenVertex; 3],
    pub(super) number: u32,
    /// Whether its texture decides where it is drawn.
    pub(super) cutout: bool,
}

/// What one tile has to look at.
#[derive(Debug, Default)]
pub(super) struct Bin {
    packs: [Vec<Pack>; 3],
    counts: [usize; 3],
    pub(super) large: Vec<u32>,
    pub(super) lines: Vec<u32>,
}

impl Bin {
    /// Whether there is nothing to look at.
    pub(super) fn is_empty(&self) -> bool {
        self.counts == [0; 3] && self.large.is_empty() && self.lines.is_empty()
    }

    /// The only large triangle, where there is nothing else.
    pub(super) fn alone(&self) -> Option<u32> {
        let nothing_else = self.counts == [0; 3] && self.lines.is_empty();
        if let [large] = self.large[..]
            && nothing_else
        {
            Some(large)
        } else {
            None
        }
    }

    /// The packs of a queue, each with the number of triangles in it.
    pub(super) fn packs(&self, queue: usize) -> impl Iterator<Item = (&Pack, usize)> {
        let count = self.counts[queue];
        let packs = &self.packs[queue][..count.div_ceil(PACK)];
        packs.iter().enumerate().map(move |(i, pack)| (pack, (count - i * PACK).min(PACK)))
    }
}

/// The bins of one thread.
#[derive(Debug, Default)]
pub(super) struct Bins {
    columns: i32,
    rows: i32,
    pub(super) tiles: Vec<Bin>,
    pub(super) large: Vec<LargeTriangle>,
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
            bin.counts = [0; 3];
            bin.large.clear();
            bin.lines.clear();
        }
        self.large.clear();
        self.drawn = 0;
    }

    /// Adds a triangle whose box of pixels (not empty, and in the picture at least in part) is small
    /// enough for a queue.
    #[inline(always)]
    pub(super) fn add_small(
        &mut self,
        queue: usize,
        corners: [&ScreenVertex; 3],
        bounds: PixelBox,
        number: u32,
    ) {
        self.drawn += 1;
        let columns = tiles(bounds.left, bounds.right, self.columns);
        for row in tiles(bounds.top, bounds.bottom, self.rows) {
            for column in columns.clone() {
                let (left, top) = (column * TILE, row * TILE);
                let bin = &mut self.tiles[(row * self.columns + column) as usize];
                let count = bin.counts[queue];
                let (pack, lane) = (count / PACK, count % PACK);
                if pack == bin.packs[queue].len() {
                    bin.packs[queue].push(Pack::default());
                }
                let pack = &mut bin.packs[queue][pack];
                for (i, corner) in corners.into_iter().enumerate() {
                    let at = corner.at();
                    pack.x[i][lane] = (at.x - left * SUBPIXELS) as f32;
                    pack.y[i][lane] = (at.y - top * SUBPIXELS) as f32;
                    pack.depth[i][lane] = corner.depth;
                }
                pack.left[lane] = bounds.left - left;
                pack.top[lane] = bounds.top - top;
                pack.number[lane] = number;
                bin.counts[queue] = count + 1;
            }
        }
    }

    /// Adds a triangle of any size, whose box of pixels is this.
    pub(super) fn add_large(&mut self, triangle: LargeTriangle, bounds: PixelBox) {
        let number = u32::try_from(self.large.len()).expect("fewer than 2^32 triangles");
        self.drawn += 1;
        self.large.push(triangle);
        self.each(bounds, |bin| bin.large.push(number));
    }

    /// Adds a line whose box of pixels is this.
    pub(super) fn add_line(&mut self, line: u32, bounds: PixelBox) {
        self.each(bounds, |bin| bin.lines.push(line));
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
