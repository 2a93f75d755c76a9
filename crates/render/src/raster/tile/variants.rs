//! Draws the triangles of a tile by the variants of coverage.

use crate::simd::dispatch;
use fearless_simd::{Level, Simd};

use super::{Shown, Visibility};
use crate::ancestors::points;
use crate::frame::FramePlan;
use crate::raster::alpha_test::{AlphaSurface, AlphaTest};
use crate::raster::beyond::{beyond, reach};
use crate::raster::bins::Bins;
use crate::raster::depth_format::Any;
use crate::raster::edges_in_floats::{Everywhere, FloatTriangle, Opaque, in_pixels};
use crate::raster::geometry::ScreenGeometry;
use crate::raster::scan_lines::ScanLines;
use crate::screen::coverage::PixelBox;
use crate::screen::tiles::BLOCK;
use marraztu_core::accuracy::Coverage;
use marraztu_core::base::math::each;

/// The alpha test of a triangle in one block, one pixel at a time.
struct Tested<'a, 'b, 'c> {
    test: &'c AlphaTest<'a, 'b>,
    /// The first pixel of the block.
    first: [i32; 2],
}

impl Opaque for Tested<'_, '_, '_> {
    const ALL: bool = false;

    fn of(&self, pair: usize, mut pixels: u64) -> u64 {
        let [x, y] = self.first;
        let y = y + 2 * i32::try_from(pair).unwrap_or(0);
        let mut opaque = 0;
        while pixels != 0 {
            let lane = pixels.trailing_zeros();
            pixels &= pixels - 1;
            let at = lane.cast_signed();
            opaque |= u64::from(self.test.is_opaque([x + at % BLOCK, y + at / BLOCK])) << lane;
        }
        opaque
    }
}

impl Visibility {
    /// Draws all triangles of a tile that are not small.
    #[inline(always)]
    pub(super) fn draw_by_variant<S: Simd, const N: usize>(
        &mut self,
        simd: S,
        (plan, frame): (&FramePlan, &ScreenGeometry),
        bins: &Bins,
        tile: usize,
    ) {
        let mut surface = None;
        for place in &bins.tiles[tile].large {
            let triangle = &bins.large[*place as usize];
            let number = triangle.number;
            let own = match triangle.cutout {
                true => AlphaSurface::of(&mut surface, plan, frame, number),
                false => None,
            };
            // One alpha test per sample: its texture position differs.
            let tests: [Option<AlphaTest<'_, '_>>; N] = std::array::from_fn(|sample| {
                let shift = self.sample_positions.shift::<N>(sample);
                AlphaTest::of(own?, (plan, frame), number, shift)
            });
            if plan.variants.coverage == Coverage::Points {
                self.draw_points::<N>(simd.level(), (plan, frame), number, &tests);
                continue;
            }
            let depths = each(triangle.corners, |corner| corner.depth);
            let corners = bins.unsnapped[*place as usize];
            if plan.variants.coverage == Coverage::ScanLines {
                self.draw_scan_lines::<S, N>(simd, (corners, depths, number), &tests);
                continue;
            }
            let first = [self.bounds.left, self.bounds.top];
            let own = FloatTriangle::new(corners, depths, number, first);
            let at = each(triangle.corners, |corner| corner.at());
            // Rounding may cover centres beyond the box, so the box is enlarged.
            let beyond = beyond(Coverage::F32Edges);
            let reach = reach(self.sample_positions.reach::<N>(), beyond);
            if let Some(area) = self.in_tile(PixelBox::reached(at, reach)) {
                self.draw_floats::<S, N>(simd, (&own, area), &tests);
            }
        }
    }

    /// Draws a triangle by f32 edge functions.
    #[inline(always)]
    fn draw_floats<S: Simd, const N: usize>(
        &mut self,
        simd: S,
        (triangle, area): (&FloatTriangle, PixelBox),
        tests: &[Option<AlphaTest<'_, '_>>; N],
    ) {
        let touched = triangle.blocks::<S, N>(simd, area, &self.sample_positions);
        let (mut some, high) = (touched.some, self.key(triangle.high));
        let mut place = None;
        for block in bits(some) {
            if high < self.farthest[block] {
                continue;
            }
            let whole = touched.whole >> block & 1 != 0;
            // Alpha-tested blocks are always written; others can be noted as fully covered.
            if tests[0].is_some() {
                self.write::<N>(simd.level(), block);
                let (first, format) = (self.corner(block), Any(self.depth_format));
                for (sample, test) in tests.iter().enumerate() {
                    let at = (block, self.sample_positions.shift::<N>(sample));
                    let plane = self.plane::<N>(block, sample);
                    if let Some(test) = test {
                        let holes = Tested { test, first };
                        triangle.draw(format, simd, at, whole, &holes, plane);
                    }
                }
            } else if whole {
                self.draw_full_float_block::<N>(simd.level(), triangle, block, &mut place);
            } else {
                self.write::<N>(simd.level(), block);
                self.draw_float_planes::<N>(simd.level(), triangle, block, false);
            }
        }
    }

    /// See `draw_full_block`.
    #[inline(never)]
    fn draw_full_float_block<const N: usize>(
        &mut self,
        level: Level,
        triangle: &FloatTriangle,
        block: usize,
        place: &mut Option<u32>,
    ) {
        let [low, high] = triangle.depths::<N>(block).map(|depth| self.key(depth));
        if self.hides(block, high, triangle.number) {
            return;
        }
        let own = ([low, high], triangle.number);
        if !self.show_whole(block, own, place, || Shown::Floats(*triangle)) {
            self.write::<N>(level, block);
            self.draw_float_planes::<N>(level, triangle, block, true);
        }
        self.farthest[block] = self.farthest[block].max(low);
    }

    /// Draws a triangle into a block that it covers fully or partly.
    #[inline(never)]
    pub(super) fn draw_float_planes<const N: usize>(
        &mut self,
        level: Level,
        triangle: &FloatTriangle,
        block: usize,
        whole: bool,
    ) {
        let format = Any(self.depth_format);
        dispatch!(level, simd => for sample in 0..N {
            let at = (block, self.sample_positions.shift::<N>(sample));
            let plane = self.plane::<N>(block, sample);
            triangle.draw(format, simd, at, whole, &Everywhere, plane);
        });
    }

    /// Draws a triangle by scan lines.
    #[inline(always)]
    fn draw_scan_lines<S: Simd, const N: usize>(
        &mut self,
        simd: S,
        (corners, depths, number): ([[f32; 2]; 3], [f32; 3], u32),
        tests: &[Option<AlphaTest<'_, '_>>; N],
    ) {
        let format = Any(self.depth_format);
        for (sample, test) in tests.iter().enumerate() {
            let shift = self.sample_positions.shift::<N>(sample);
            let [dx, dy] = in_pixels(shift);
            let seen = each(corners, |[x, y]| [x - dx, y - dy]);
            let Some(rows) = ScanLines::new(seen, depths, number, self.bounds) else { continue };
            for block in rows.blocks() {
                self.write::<N>(simd.level(), block);
                let first = self.corner(block);
                let plane = self.plane::<N>(block, sample);
                // Compiled only once, for any `N`.
                simd.vectorize(
                    #[inline(always)]
                    || match test {
                        Some(test) => {
                            rows.draw(format, simd, block, &Tested { test, first }, plane);
                        }
                        None => rows.draw(format, simd, block, &Everywhere, plane),
                    },
                );
            }
        }
    }

    /// Draws a triangle by ancestor A's fill rule: points, one after the other.
    fn draw_points<const N: usize>(
        &mut self,
        level: Level,
        (plan, frame): (&FramePlan, &ScreenGeometry),
        number: u32,
        tests: &[Option<AlphaTest<'_, '_>>; N],
    ) {
        let (draw, start) = frame.draw_of(number);
        let draw = &plan.draws[draw as usize];
        for (sample, test) in tests.iter().enumerate() {
            let shift = self.sample_positions.shift::<N>(sample);
            let shift = [shift[0] + plan.shift[0], shift[1] + plan.shift[1]];
            let own = number - start.number;
            points::cover(plan, draw, own, (self.bounds, shift), &mut |x, y, depth| {
                if test.as_ref().is_none_or(|test| test.is_opaque([x, y])) {
                    self.put::<N>(level, (x, y, sample), self.key(depth), number);
                }
            });
        }
    }
}
