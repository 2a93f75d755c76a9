//! Draws the alpha-tested triangles of a tile.

use fearless_simd::{Level, Simd};

use super::Visibility;
use super::cutout_fragments::{Fragments, List, MOST};
use super::scratch::Cutouts;
use crate::frame::FramePlan;
use crate::raster::alpha_test::{AlphaSurface, AlphaTest, BlockHoles};
use crate::raster::bins::LargeTriangle;
use crate::raster::block_triangle::BlockTriangle;
use crate::raster::depth_format::Format;
use crate::raster::geometry::ScreenGeometry;
use crate::raster::large::{Large, Touched};
use crate::screen::tiles::BLOCK_PIXELS;
use crate::simd::Bits;
use crate::texture::opacity::Holes;

/// Classifies the pixels of a block by their holes, for all samples together.
#[inline(always)]
fn holes_in_block(tests: &[Option<AlphaTest<'_, '_>>], first: [i32; 2]) -> Holes {
    let mut each = tests
        .iter()
        .map(|test| test.as_ref().map_or(Holes::Nowhere, |it| it.holes_in_block(first)));
    let own = each.next().unwrap_or(Holes::Somewhere);
    if each.all(|other| other == own) { own } else { Holes::Somewhere }
}

impl Visibility {
    /// Draws a triangle with the alpha test in each sample.
    #[inline(always)]
    pub(super) fn draw_cutout<'a, S: Simd, const N: usize>(
        &mut self,
        simd: S,
        (plan, frame): (&'a FramePlan, &ScreenGeometry),
        triangle: &LargeTriangle,
        cutouts: &mut Cutouts<'a>,
    ) {
        let Some((large, area)) = self.set_up::<N>(triangle) else { return };
        let Touched { mut some, whole } = large.blocks::<S, N>(simd, area, &self.sample_positions);
        // Blocks with nearer depths everywhere hide the triangle (hierarchical Z).
        let high = self.key(large.high);
        for block in Bits(some) {
            if high < self.farthest[block] {
                some &= !(1 << block);
            }
        }
        if some == 0 {
            return;
        }
        let Cutouts { surface, fragments } = cutouts;
        let surface = AlphaSurface::of(surface, plan, frame, triangle.number);
        let positions = self.sample_positions;
        let test = |sample: usize| {
            let shift = positions.shift::<N>(sample);
            AlphaTest::of(surface?, (plan, frame), triangle.number, shift)
        };
        // Three paths: a list of fragments for few pixels, whole blocks without sampling, and the
        // rest with the alpha test in two rows at a time.
        if area.width() * area.height() <= MOST
            && self.draw_few::<S, N>(simd, &large, (some, whole), test, fragments)
        {
            return;
        }
        let samples = positions.count_in::<N>();
        let tests: [Option<AlphaTest<'_, '_>>; N] =
            std::array::from_fn(|sample| if sample < samples { test(sample) } else { None });
        let tests = &tests[..samples];
        let large = BlockTriangle::Large(large);
        some &= !self.draw_even_blocks::<N>(simd.level(), &large, some & whole, tests);
        for block in Bits(some) {
            self.draw_tested::<S, N>(simd, &large, block, whole >> block & 1 != 0, tests);
        }
    }

    /// Draws a triangle with the alpha test into a block that it covers fully or partly.
    #[inline(always)]
    pub(super) fn draw_tested<S: Simd, const N: usize>(
        &mut self,
        simd: S,
        triangle: &BlockTriangle,
        block: usize,
        whole: bool,
        tests: &[Option<AlphaTest<'_, '_>>],
    ) {
        self.write::<N>(simd.level(), block);
        let (first, format) = (self.corner(block), Format(self.depth_format));
        for (sample, test) in tests.iter().enumerate() {
            let at = (block, self.sample_positions.shift::<N>(sample));
            let holes = test.as_ref().map(|test| BlockHoles { test, first });
            self.draw_plane::<N>(block, sample, |plane| {
                // Compiled only once, for any `N`.
                simd.vectorize(
                    #[inline(always)]
                    || triangle.draw(format, simd, at, whole, holes, plane),
                );
            });
        }
    }

    /// Draws a triangle into the fully covered blocks of a mask that are opaque everywhere. Returns
    /// these blocks, together with blocks of holes only.
    #[inline(always)]
    fn draw_even_blocks<const N: usize>(
        &mut self,
        level: Level,
        triangle: &BlockTriangle,
        blocks: u64,
        tests: &[Option<AlphaTest<'_, '_>>],
    ) -> u64 {
        let (mut done, mut place) = (0, None);
        // Classifying costs a tenth of sampling. If it hardly ever succeeds, it stops.
        let mut credit = 4;
        for block in Bits(blocks) {
            if credit == 0 {
                break;
            }
            let holes = holes_in_block(tests, self.corner(block));
            if holes == Holes::Somewhere {
                credit -= 1;
                continue;
            }
            credit += 1;
            done |= 1 << block;
            if holes == Holes::Nowhere {
                self.draw_full_block::<N>(level, triangle, block, &mut place);
            }
        }
        done
    }

    /// Draws a triangle that covers few pixels of the tile: lists the pixels that pass the depth
    /// test, then tests sixteen of them at a time. Returns whether the triangle was drawn; clipped
    /// triangles are not.
    #[inline(always)]
    fn draw_few<'a, 'b, S: Simd, const N: usize>(
        &mut self,
        simd: S,
        large: &Large,
        (some, whole): (u64, u64),
        test: impl Fn(usize) -> Option<AlphaTest<'a, 'b>>,
        fragments: &mut Fragments,
    ) -> bool
    where
        'a: 'b,
    {
        let format = Format(self.depth_format);
        let samples = self.sample_positions.count_in::<N>();
        for sample in 0..samples {
            let shift = self.sample_positions.shift::<N>(sample);
            // First pass: list the pixels in front, block by block.
            fragments.count = 0;
            for block in Bits(some) {
                self.write::<N>(simd.level(), block);
                let first = block * samples * BLOCK_PIXELS + sample;
                let whole = whole >> block & 1 != 0;
                let mut list = List { fragments, first, samples };
                self.draw_plane::<N>(block, sample, |plane| {
                    simd.vectorize(
                        #[inline(always)]
                        || large.draw(format, simd, (block, shift), whole, &mut list, plane),
                    );
                });
            }
            if fragments.count == 0 {
                continue;
            }
            // Second pass: the alpha test, for listed pixels only.
            let test = test(sample);
            if test.as_ref().is_some_and(|test| !test.has_edges()) {
                return false;
            }
            let corner = [self.bounds.left, self.bounds.top];
            let buffer = &mut self.buffer.0;
            simd.vectorize(
                #[inline(always)]
                || {
                    let test = (test.as_ref(), corner);
                    fragments.put(simd, format, test, (large.number, samples), buffer);
                },
            );
        }
        true
    }
}
