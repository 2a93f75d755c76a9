//! Lists the pixels of a small alpha-tested triangle that pass the depth test.
//!
//! A triangle that covers few pixels of a tile reaches into up to four blocks, with few pixels in
//! each pair of rows. Its pixels are listed first and then tested sixteen at a time: 0.9 of the
//! time of a frame of 70,000 triangles with holes (bilinear, AVX-512).

use fearless_simd::{
    Simd, SimdBase as _, SimdMask as _, f32x16, f64x8, i32x16, mask32x16, mask64x8,
};

use crate::raster::alpha_test::AlphaTest;
use crate::raster::depth_format::Format;
use crate::raster::entries::word;
use crate::raster::large;
use crate::screen::sample_positions::MANY;
use crate::screen::tiles::{BLOCK, BLOCK_PIXELS, BLOCKS, PIXELS};
use crate::simd::{Bits, UP_TO_SIXTEEN};

/// The largest bounding box, in pixels, of a triangle drawn by a list of fragments.
pub(super) const MOST: i32 = 64;
/// Room for one more group of fragments.
const ROOM: usize = MOST as usize + 16;

/// The pixels of a small triangle that pass the depth test, before the alpha test.
#[derive(Debug)]
pub(super) struct Fragments {
    pub(super) count: usize,
    /// The indices in the visibility buffer.
    places: [i32; ROOM],
    depths: [f32; ROOM],
    /// The edge functions of the second and third corner.
    edges: [[f64; ROOM]; 2],
}

impl Default for Fragments {
    fn default() -> Self {
        Self { count: 0, places: [0; ROOM], depths: [0.0; ROOM], edges: [[0.0; ROOM]; 2] }
    }
}

/// Lists the pixels of a block that pass the depth test, and draws none.
pub(super) struct List<'a> {
    pub(super) fragments: &'a mut Fragments,
    /// The index of the sample's first entry in the visibility buffer, and the number of samples
    /// per pixel.
    pub(super) first: usize,
    pub(super) samples: usize,
}

impl<S: Simd> large::InFront<S> for List<'_> {
    #[inline(always)]
    fn opaque(
        &mut self,
        simd: S,
        pair: usize,
        pixels: u64,
        [upper, lower]: [[f64x8<S>; 2]; 2],
        depth: f32x16<S>,
    ) -> u64 {
        let Fragments { count, places, depths, edges } = &mut *self.fragments;
        // The box has at most MOST pixels, so the remainder only saves bounds checks.
        let to = *count % (ROOM - 16);
        let mask = mask32x16::from_bitmask(simd, pixels);
        // Appends the pixels of both rows; compressing keeps only the lanes in front.
        let first = i32::try_from(self.first + 16 * pair * self.samples).unwrap_or(0);
        let samples = i32::try_from(self.samples).unwrap_or(1);
        let place = i32x16::from_slice(simd, &UP_TO_SIXTEEN) * samples + first;
        place.compress(mask).store_slice(&mut places[to..to + 16]);
        depth.compress(mask).store_slice(&mut depths[to..to + 16]);
        let [up, down] = [pixels & 0xff, pixels >> 8 & 0xff];
        let below = to + up.count_ones() as usize;
        let (up, down) = (mask64x8::from_bitmask(simd, up), mask64x8::from_bitmask(simd, down));
        for i in 0..2 {
            upper[i].compress(up).store_slice(&mut edges[i][to..to + 8]);
            lower[i].compress(down).store_slice(&mut edges[i][below..below + 8]);
        }
        *count = to + pixels.count_ones() as usize;
        // No pixel is drawn yet: `Fragments::put` does it after the alpha test.
        0
    }
}

impl Fragments {
    /// Draws the fragments that pass the alpha test of a triangle, into a tile with this first
    /// pixel and this number of samples.
    #[inline(always)]
    pub(super) fn put<S: Simd>(
        &self,
        simd: S,
        format: Format,
        (test, [left, top]): (Option<&AlphaTest<'_, '_>>, [i32; 2]),
        (number, samples): (u32, usize),
        buffer: &mut [u64; MANY * PIXELS],
    ) {
        // Sixteen fragments of any rows are tested at once, then written one by one.
        for at in (0..self.count).step_by(16) {
            let pixels = (1 << (self.count - at).min(16)) - 1;
            let [second, third] = &self.edges;
            let edges = [
                [
                    f64x8::from_slice(simd, &second[at..at + 8]),
                    f64x8::from_slice(simd, &third[at..at + 8]),
                ],
                [
                    f64x8::from_slice(simd, &second[at + 8..at + 16]),
                    f64x8::from_slice(simd, &third[at + 8..at + 16]),
                ],
            ];
            let pixel = |lane: usize| {
                let [x, y] = pixel_of(self.place(at + lane), samples);
                [left + x, top + y]
            };
            let opaque = match test {
                Some(test) => test.opaque(simd, [0; 2], edges, pixels, pixel),
                None => pixels,
            };
            let depth = f32x16::from_slice(simd, &self.depths[at..at + 16]);
            let keys = <[u32; 16]>::from(format.keys(depth));
            for lane in Bits(opaque) {
                let lane = lane % 16;
                let entry = &mut buffer[self.place(at + lane)];
                *entry = word(keys[lane], number).max(*entry);
            }
        }
    }

    /// Returns the index of a fragment in the visibility buffer.
    #[inline(always)]
    fn place(&self, i: usize) -> usize {
        self.places[i].cast_unsigned() as usize % (MANY * PIXELS)
    }
}

/// Returns the column and row in the tile of an entry of the visibility buffer.
fn pixel_of(place: usize, samples: usize) -> [i32; 2] {
    let pixel = place / samples;
    let (block, within) = (pixel / BLOCK_PIXELS, pixel % BLOCK_PIXELS);
    let (side, blocks) = (BLOCK as usize, BLOCKS as usize);
    let (x, y) = (block % blocks * side + within % side, block / blocks * side + within / side);
    [x, y].map(|i| i32::try_from(i).unwrap_or(0))
}
