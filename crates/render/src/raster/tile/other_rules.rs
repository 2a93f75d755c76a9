//! Draws the triangles of a tile by the rules of coverage that are not exact.

use fearless_simd::{Level, Simd};

use super::Visibility;
use crate::ancestors::points;
use crate::frame::FramePlan;
use crate::raster::alpha_test::{AlphaSurface, AlphaTest, BlockHoles};
use crate::raster::beyond::reach;
use crate::raster::bins::Bins;
use crate::raster::block_triangle::BlockTriangle;
use crate::raster::depth_format::Format;
use crate::raster::edges_in_floats::{FloatTriangle, in_pixels};
use crate::raster::geometry::ScreenGeometry;
use crate::raster::scan_lines::ScanLines;
use crate::screen::coverage::PixelBox;
use crate::simd::Bits;
use marraztu_core::accuracy::Coverage;
use marraztu_core::base::math::each;

impl Visibility {
    /// Draws all triangles of a tile that are not small.
    #[inline(always)]
    pub(super) fn draw_by_rule<S: Simd, const N: usize>(
        &mut self,
        simd: S,
        (plan, frame): (&FramePlan, &ScreenGeometry),
        bins: &Bins,
        tile: usize,
    ) {
        let (mut surface, coverage) = (None, plan.raster_mode().coverage);
        for place in &bins.tiles[tile].large {
            let triangle = &bins.large[*place as usize];
            let number = triangle.number;
            let own = match triangle.cutout {
                true => AlphaSurface::of(&mut surface, plan, frame, number),
                false => None,
            };
            // One alpha test per sample: its texture position differs.
            let samples = self.sample_positions.count_in::<N>();
            let tests: [Option<AlphaTest<'_, '_>>; N] = std::array::from_fn(|sample| {
                let shift = self.sample_positions.shift::<N>(sample);
                AlphaTest::of(own.filter(|_| sample < samples)?, (plan, frame), number, shift)
            });
            let tests = &tests[..samples];
            if coverage == Coverage::Points {
                self.draw_points::<N>(simd.level(), (plan, frame), number, tests);
                continue;
            }
            let depths = each(triangle.corners, |corner| corner.depth);
            let corners = bins.unsnapped[*place as usize];
            if coverage == Coverage::ScanLines {
                self.draw_scan_lines::<S, N>(simd, (corners, depths, number), tests);
                continue;
            }
            let first = [self.bounds.left, self.bounds.top];
            let own = FloatTriangle::new(corners, depths, number, first);
            let at = each(triangle.corners, |corner| corner.at());
            // Rounding may cover centres beyond the box, so the box is enlarged.
            let reach = reach(Coverage::F32Edges, self.sample_positions.reach::<N>());
            if let Some(area) = PixelBox::reached(at, reach).in_tile(self.bounds) {
                let own = BlockTriangle::Floats(own);
                self.draw_floats::<S, N>(simd, (&own, area), tests);
            }
        }
    }

    /// Draws a triangle by f32 edge functions.
    #[inline(always)]
    fn draw_floats<S: Simd, const N: usize>(
        &mut self,
        simd: S,
        (triangle, area): (&BlockTriangle, PixelBox),
        tests: &[Option<AlphaTest<'_, '_>>],
    ) {
        // Alpha-tested blocks are always written; others can be noted as fully covered.
        if tests[0].is_none() {
            return self.draw_blocks::<S, N>(simd, triangle, area);
        }
        let touched = triangle.blocks::<S, N>(simd, area, &self.sample_positions);
        let high = self.key(triangle.high());
        for block in Bits(touched.some) {
            if high >= self.farthest[block] {
                let whole = touched.whole >> block & 1 != 0;
                self.draw_tested::<S, N>(simd, triangle, block, whole, tests);
            }
        }
    }

    /// Draws a triangle by scan lines.
    #[inline(always)]
    fn draw_scan_lines<S: Simd, const N: usize>(
        &mut self,
        simd: S,
        (corners, depths, number): ([[f32; 2]; 3], [f32; 3], u32),
        tests: &[Option<AlphaTest<'_, '_>>],
    ) {
        let format = Format(self.depth_format);
        for (sample, test) in tests.iter().enumerate() {
            let shift = self.sample_positions.shift::<N>(sample);
            let [dx, dy] = in_pixels(shift);
            // Corners move instead of the sample, and are rounded to pixels afterwards.
            let seen = each(corners, |[x, y]| [x - dx, y - dy]);
            let Some(rows) = ScanLines::new(seen, depths, number, self.bounds) else { continue };
            for block in rows.blocks() {
                self.write::<N>(simd.level(), block);
                let first = self.corner(block);
                let holes = test.as_ref().map(|test| BlockHoles { test, first });
                self.draw_plane::<N>(block, sample, |plane| {
                    // Compiled only once, for any `N`.
                    simd.vectorize(
                        #[inline(always)]
                        || rows.draw(format, simd, block, holes.as_ref(), plane),
                    );
                });
            }
        }
    }

    /// Draws a triangle by ancestor A's fill rule: points, one after the other.
    fn draw_points<const N: usize>(
        &mut self,
        level: Level,
        (plan, frame): (&FramePlan, &ScreenGeometry),
        number: u32,
        tests: &[Option<AlphaTest<'_, '_>>],
    ) {
        let (draw, start) = frame.draw_of(number);
        let draw = &plan.draws[draw as usize];
        for (sample, test) in tests.iter().enumerate() {
            let shift = self.sample_positions.shift::<N>(sample);
            // Points start in object space, so the offset of the picture is added.
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
