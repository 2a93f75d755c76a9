//! Which triangles and lines may touch which tile.

use super::coverage::{PixelBox, SUBPIXELS, Triangle};
use super::geometry::Geometry;
use crate::base::image::Size;

/// Pixels to a side of a tile.
pub(super) const TILE: i32 = 64;

/// For each tile the primitives whose boxes reach into it, in their own order.
#[derive(Debug, Default)]
pub(super) struct Bins {
    columns: i32,
    rows: i32,
    tiles: Vec<Bin>,
}

/// What one tile has to look at.
#[derive(Debug, Default)]
pub(super) struct Bin {
    pub(super) triangles: Vec<u32>,
    pub(super) lines: Vec<u32>,
}

impl Bins {
    /// Sorts what is on the screen into the tiles of a picture.
    pub(super) fn build(&mut self, geometry: &Geometry, size: Size, line_width: i32) {
        let tiles = |pixels: usize| {
            i32::try_from(pixels.div_ceil(TILE as usize)).expect("pictures have 32-bit sizes")
        };
        (self.columns, self.rows) = (tiles(size.width), tiles(size.height));
        let count = usize::try_from(self.columns * self.rows).expect("not negative");
        self.tiles.resize_with(count, Bin::default);
        for bin in &mut self.tiles {
            bin.triangles.clear();
            bin.lines.clear();
        }
        for (i, triangle) in geometry.triangles.iter().enumerate() {
            let Some(covered) = Triangle::new(triangle.corners.map(|corner| corner.at)) else {
                continue;
            };
            self.each(covered.bounds(), |bin| bin.triangles.push(number(i)));
        }
        for (i, line) in geometry.lines.iter().enumerate() {
            let [a, b] = line.ends.map(|end| end.at);
            let low = |p: i32, q: i32| p.min(q).div_euclid(SUBPIXELS) - line_width;
            let high = |p: i32, q: i32| p.max(q).div_euclid(SUBPIXELS) + 1 + line_width;
            let bounds = PixelBox {
                left: low(a.x, b.x),
                top: low(a.y, b.y),
                right: high(a.x, b.x),
                bottom: high(a.y, b.y),
            };
            self.each(bounds, |bin| bin.lines.push(number(i)));
        }
    }

    /// The tiles with the pixels that they have.
    pub(super) fn tiles(&self, size: Size) -> impl Iterator<Item = (PixelBox, &Bin)> {
        let side = |pixels: usize| i32::try_from(pixels).expect("pictures have 32-bit sizes");
        let (right, bottom) = (side(size.width), side(size.height));
        let picture = PixelBox { left: 0, top: 0, right, bottom };
        self.tiles.iter().zip(0..).map(move |(bin, i)| {
            let (left, top) = (i % self.columns * TILE, i / self.columns * TILE);
            let tile = PixelBox { left, top, right: left + TILE, bottom: top + TILE };
            (tile.intersection(picture), bin)
        })
    }

    fn each(&mut self, bounds: PixelBox, mut add: impl FnMut(&mut Bin)) {
        let tiles = |low: i32, high: i32, count: i32| {
            low.div_euclid(TILE).max(0)..((high - 1).div_euclid(TILE) + 1).min(count)
        };
        if bounds.is_empty() {
            return;
        }
        for row in tiles(bounds.top, bounds.bottom, self.rows) {
            for column in tiles(bounds.left, bounds.right, self.columns) {
                let at = usize::try_from(row * self.columns + column).expect("not negative");
                add(&mut self.tiles[at]);
            }
        }
    }
}

fn number(i: usize) -> u32 {
    u32::try_from(i).expect("fewer than 2^32 primitives")
}
