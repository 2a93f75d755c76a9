//! Lists the surfaces that each pixel of a tile shows, from the opaque one to the nearest
//! transparent one: for queries about a picture, not for drawing it.

use fearless_simd::Level;

use super::frame::FramePlan;
use super::raster::geometry::ScreenGeometry;
use super::raster::layers::Layers;
use super::raster::tile::Visibility;
use super::raster::visibility_buffer::seen;
use super::screen::coverage::PixelBox;
use super::screen::sample_positions::MANY;
use super::screen::tiles::{BLOCK, BLOCK_PIXELS};
use marraztu_core::accuracy::Transparency;

/// The visibility and the layers of one tile.
#[derive(Debug, Default)]
pub(crate) struct TileLayers {
    pub(crate) visibility: Visibility,
    layers: Layers,
    bounds: Option<PixelBox>,
    /// The words of all samples of each pixel in a block: the opaque surface and each layer.
    words: Vec<Vec<u64>>,
}

impl TileLayers {
    /// Draws the visibility of a tile.
    pub(crate) fn draw(
        &mut self,
        level: Level,
        plan: &FramePlan,
        frame: &ScreenGeometry,
        (tile, bounds): (usize, PixelBox),
    ) {
        self.visibility.draw(level, plan, frame, (tile, bounds));
        if frame.is_layered(tile) {
            self.layers.begin(level, plan, frame, (tile, bounds));
        } else {
            self.layers.begin_none();
        }
        self.bounds = Some(bounds);
        self.words.resize_with(BLOCK_PIXELS, Vec::new);
    }

    /// Returns the range of depths in the tile.
    pub(crate) fn depths(&self, level: Level) -> Option<[f32; 2]> {
        self.layers.depths_with(self.visibility.depths(level))
    }

    /// Calls `take` with each pixel of a block that is inside the picture: its column and row, its
    /// nearest word (with several samples, the one shown by most), and all of its words including
    /// the nearest.
    pub(crate) fn each(
        &mut self,
        level: Level,
        frame: &ScreenGeometry,
        block: usize,
        mut take: impl FnMut([i32; 2], u64, &[u64]),
    ) {
        let Some(bounds) = self.bounds else { return };
        let [left, top] = self.visibility.corner(block);
        let is_layered = self.layers.touches(block);
        let samples = frame.sample_positions().count();
        let mut tops = [[0; BLOCK_PIXELS]; MANY];
        if is_layered {
            self.find_layers(level, frame, block, &mut tops);
        } else {
            for (sample, top) in tops.iter_mut().enumerate().take(samples) {
                *top = self.visibility.entries(level, block, sample);
            }
        }
        for place in 0..BLOCK_PIXELS {
            let at = i32::try_from(place).expect("a block has few pixels");
            let [x, y] = [left + at % BLOCK, top + at / BLOCK];
            if x >= bounds.right || y >= bounds.bottom {
                continue;
            }
            let own = tops.map(|sample| sample[place]);
            let nearest = most(&own[..samples]);
            // Without layers, a pixel has one word.
            let words = if is_layered { &self.words[place][..] } else { &[nearest] };
            take([x, y], nearest, words);
        }
    }

    /// Returns whether a block shows anything.
    pub(crate) const fn shows(&self, block: usize) -> bool {
        self.visibility.shows(block) || self.layers.touches(block)
    }

    /// Returns the nearest words of a block's pixels, row by row, with one sample per pixel. `None`
    /// if the block shows nothing.
    pub(crate) fn nearest(
        &mut self,
        level: Level,
        frame: &ScreenGeometry,
        block: usize,
    ) -> Option<[u64; BLOCK_PIXELS]> {
        if !self.layers.touches(block) {
            let shows = self.visibility.shows(block);
            return shows.then(|| self.visibility.entries(level, block, 0));
        }
        let mut tops = [[0; BLOCK_PIXELS]; MANY];
        self.find_layers(level, frame, block, &mut tops);
        Some(tops[0])
    }

    /// Finds the words of all samples of a block, and the nearest word of each sample.
    fn find_layers(
        &mut self,
        level: Level,
        frame: &ScreenGeometry,
        block: usize,
        tops: &mut [[u64; BLOCK_PIXELS]; MANY],
    ) {
        let Self { visibility, layers, words, .. } = self;
        words.iter_mut().for_each(Vec::clear);
        let samples = frame.sample_positions().count();
        for (sample, top) in tops.iter_mut().enumerate().take(samples) {
            let opaque = visibility.entries(level, block, sample);
            // The opaque surface is the farthest; layers in front of it replace it below.
            *top = opaque;
            for (words, word) in words.iter_mut().zip(&opaque) {
                words.push(*word);
            }
            // Each round takes the next layers, from far to near.
            layers.open();
            let order = Transparency::Exact;
            while layers.take(level, (frame, order), (block, sample), &opaque) {
                for i in 0..layers.len() {
                    let row = layers.row(order, i);
                    for (place, word) in row.into_iter().enumerate().filter(|(_, word)| *word != 0)
                    {
                        top[place] = word;
                        words[place].push(word);
                    }
                }
            }
        }
    }
}

/// Returns the word with the primitive shown by most samples, the first one in a tie.
fn most(samples: &[u64]) -> u64 {
    if let [only] = samples {
        return *only;
    }
    let alike = |word: &u64| samples.iter().filter(|other| seen(**other) == seen(*word)).count();
    // Of equal counts, `max_by_key` takes the last one, so the order is reversed.
    samples.iter().rev().max_by_key(|word| alike(word)).copied().unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raster::entries::word;

    #[test]
    fn a_pixel_reports_the_triangle_of_most_of_its_samples() {
        let [a, b, c] = [7, 8, 9].map(|number| word(0.5_f32.to_bits(), number));
        let cases = [
            ([a, a, a, a], a),
            ([a, b, b, c], b),
            ([b, a, a, b], b),
            ([0, a, b, c], 0),
            ([0, a, word(0.6_f32.to_bits(), 7), c], a),
        ];
        for (samples, want) in cases {
            assert_eq!(most(&samples), want, "{samples:?}");
        }
    }
}
