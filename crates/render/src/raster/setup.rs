//! Triangle setup: from vertices on the screen to triangles in bins.
//!
//! Sixteen triangles are set up at a time. Triangles that face away, cover no pixel centre (or
//! sample) or lie outside the picture are culled before any of their data is copied. Triangles with
//! a corner beyond the clipping planes are clipped, and triangles with an area that needs 64 bits
//! are set up one by one.

use crate::accel::Accelerated as _;
use crate::simd::{Bits, dispatch};
use fearless_simd::{Level, Simd, SimdBase as _, SimdMask as _, i32x16, mask32x16};

use super::beyond;
use super::bins::{Bins, LargeTriangle};
use super::hits::PACK;
use super::queue::{Pack, SMALL};
use super::rule::Rule;
use super::small;
use super::tile_queues::packed;
use super::vertices::{fetch, fetch_corners};
use crate::accel::{DrawOrder, DrawTriangle};
use crate::frame::FramePlan;
use crate::frame::draw::{Back, Draw, Pipeline, Shaded};
use crate::frame::raster_mode::RasterMode;
use crate::screen::clip::{Screen, ScreenVertex};
use crate::screen::coverage::{PixelBox, doubled_area};
use crate::screen::sample_positions::MANY;
use crate::texture::opacity::Holes;
use marraztu_core::accuracy::Coverage;
use marraztu_core::base::math::each;

/// The largest bounding box, in subpixels, with a doubled area of at most 31 bits.
pub(crate) const NARROW: i32 = 1 << 14;

/// The inputs of triangle setup for one draw.
#[derive(Debug)]
pub(crate) struct Setup<'a> {
    draw: &'a Draw,
    pipelines: &'a [Pipeline],
    order: &'a DrawOrder,
    vertices: &'a [ScreenVertex],
    pub(crate) screen: Screen,
    /// The number of the draw's first triangle in the frame.
    base: u32,
    /// Whether triangles must be checked one by one, because some are not drawn, need the alpha
    /// test or are transparent.
    choosy: bool,
    /// The vertices in pixels before snapping, if the rule of coverage needs them.
    pub(crate) unsnapped: &'a [[f32; 2]],
    coverage: Coverage,
    /// The classification of triangles by their holes, if any has holes.
    pub(crate) holes: &'a [Holes],
    /// Whether all drawn triangles are transparent.
    transparent: bool,
}

/// The kind of drawing of a triangle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Not,
    Plain,
    Cutout,
    Transparent,
}

impl<'a> Setup<'a> {
    /// Prepares a draw of a plan, given its vertices and the number of its first triangle.
    pub(crate) fn new(
        plan: &'a FramePlan,
        draw: &'a Draw,
        vertices: &'a [ScreenVertex],
        base: u32,
    ) -> Self {
        let RasterMode { grid, coverage, .. } = plan.raster_mode();
        let pipelines = &plan.pipelines;
        let transparent =
            draw.uniform.is_some_and(|pipeline| pipelines[pipeline as usize].opacity().is_some());
        // If no triangle differs from the others, none has to be looked at separately.
        let choosy = draw.polygons.is_some()
            || draw.part_pipelines.iter().any(|pipeline| {
                pipeline.is_none_or(|pipeline| {
                    let pipeline = &pipelines[pipeline as usize];
                    pipeline.is_cutout() || (!transparent && pipeline.opacity().is_some())
                })
            });
        let screen = Screen::new(draw.clip_from_object, plan.viewport).on(grid);
        Self {
            draw,
            pipelines,
            order: draw.model.mesh.draw_order(),
            vertices,
            screen: screen.seen_from(grid.offset(plan.shift)),
            base,
            choosy,
            transparent,
            unsnapped: &[],
            coverage,
            holes: &[],
        }
    }

    /// Sets up some of the draw's triangles into bins.
    pub(crate) fn run<R: Rule>(&self, level: Level, triangles: &[DrawTriangle], bins: &mut Bins) {
        if bins.sample_positions.are_many() {
            dispatch!(level, simd => self.all::<_, R, MANY>(simd, triangles, bins));
        } else {
            dispatch!(level, simd => self.all::<_, R, 1>(simd, triangles, bins));
        }
    }

    #[inline(always)]
    fn all<S: Simd, R: Rule, const N: usize>(
        &self,
        simd: S,
        triangles: &[DrawTriangle],
        bins: &mut Bins,
    ) {
        for some in triangles.chunks(PACK) {
            // The last pack is filled up with copies, which are masked out by the count.
            let mut last = [some[0]; PACK];
            let sixteen = some.first_chunk().unwrap_or_else(|| {
                last[..some.len()].copy_from_slice(some);
                &last
            });
            self.sixteen::<S, R, N>(simd, (sixteen, some.len()), bins);
        }
    }

    /// Sets up the first `count` of sixteen triangles.
    #[inline(always)]
    fn sixteen<S: Simd, R: Rule, const N: usize>(
        &self,
        simd: S,
        (triangles, count): (&[DrawTriangle; PACK], usize),
        bins: &mut Bins,
    ) {
        let [x0, y0, d0, _] = fetch_corners(simd, self.vertices, triangles, 0);
        let [x1, y1, d1, _] = fetch_corners(simd, self.vertices, triangles, 1);
        let [x2, y2, d2, _] = fetch_corners(simd, self.vertices, triangles, 2);
        // Bounding boxes in pixels. A triangle without a centre (or sample) in its box is culled.
        let (low_x, high_x) = (x0.min(x1).min(x2), x0.max(x1).max(x2));
        let (low_y, high_y) = (y0.min(y1).min(y2), y0.max(y1).max(y2));

        // The first centre in the box and the one after the last, as in `PixelBox::reached_on`.
        let (half, log2) = (R::GRID.parts() / 2, R::GRID.parts().trailing_zeros());
        let [least, most] = self.reach::<R, N>(bins);
        let (least, most) = (R::GRID.offset(least), R::GRID.offset(most));
        let left = (low_x + (half - 1 - most[0])) >> log2;
        let right = ((high_x - (half + least[0])) >> log2) + 1;
        let top = (low_y + (half - 1 - most[1])) >> log2;
        let bottom = ((high_y - (half + least[1])) >> log2) + 1;
        let [width, height] = bins.hits.extent;
        let seen = left.simd_lt(right)
            & top.simd_lt(bottom)
            & right.simd_gt(0)
            & bottom.simd_gt(0)
            & left.simd_lt(width)
            & top.simd_lt(height);
        // BEYOND is the smallest integer, so one minimum finds corners beyond the planes.
        let beyond = low_x.simd_eq(ScreenVertex::BEYOND);
        let wide = (high_x - low_x).simd_gt(NARROW) | (high_y - low_y).simd_gt(NARROW);
        // Back-face culling by the sign of the area. 32 bits are enough for triangles that are not
        // wide.
        let area = (x1 - x0) * (y2 - y0) - (y1 - y0) * (x2 - x0);
        let faces = match (self.draw.back, self.draw.mirrored) {
            (Back::Culled, false) => area.simd_lt(0),
            (Back::Culled, true) => area.simd_gt(0),
            _ => !area.simd_eq(0),
        };
        let there = mask32x16::from_bitmask(simd, (1 << count) - 1);
        // A corner beyond the planes leaves no valid box, so the triangle is always clipped. A
        // wide one is skipped if its box is not in the picture.
        let odd = (beyond | (wide & seen)) & there;
        let plain = seen & faces & there & !odd;
        // Only the surviving triangles are copied into queues or bins.
        if plain.any_true() {
            let [_, _, _, number] = fetch(
                simd,
                #[inline(always)]
                |lane| triangles[lane].row(),
            );
            let number = number + self.base.cast_signed();
            let mut pack = [x0, y0, x1, y1, x2, y2, d0, d1, d2, number];
            // Queues of unsnapped triangles hold the bits of f32 corners in the same rows.
            if R::UNSNAPPED && self.has_small::<R>() {
                for corner in 0..3 {
                    let [x, y] = self.unsnapped_corners(simd, triangles, corner);
                    (pack[2 * corner], pack[2 * corner + 1]) = (x, y);
                }
            }
            let boxes = [left, top, right, bottom];
            // Front faces run counter-clockwise (negative area), or clockwise if mirrored.
            let front = if self.draw.mirrored { area.simd_gt(0) } else { area.simd_lt(0) };
            let (plain, front) = (plain.to_bitmask(), front.to_bitmask());
            for (some, cutout, transparent) in self.kinds(triangles, plain, front) {
                if some | cutout != 0 {
                    let visible = (mask32x16::from_bitmask(simd, some), cutout);
                    let rows = (&pack, boxes);
                    self.sort::<S, R, N>(triangles, rows, visible, bins.of(transparent));
                }
            }
        }
        // Triangles that need clipping or 64 bits are set up one by one.
        for lane in Bits(odd.to_bitmask()) {
            self.add_odd::<R, N>(&triangles[lane], bins);
        }
    }

    /// Fetches unsnapped x and y in pixels of one corner of sixteen triangles, as bits.
    #[inline(always)]
    fn unsnapped_corners<S: Simd>(
        &self,
        simd: S,
        triangles: &[DrawTriangle; PACK],
        corner: usize,
    ) -> [i32x16<S>; 2] {
        let last = self.unsnapped.len().saturating_sub(1);
        let [x, y, _, _] = fetch(
            simd,
            #[inline(always)]
            |lane| {
                let [x, y] = self.unsnapped[(triangles[lane].vertices[corner] as usize).min(last)];
                [x.to_bits().cast_signed(), y.to_bits().cast_signed(), 0, 0]
            },
        );
        [x, y]
    }

    /// Sorts visible triangles by the larger side of their bounding boxes: into this thread's
    /// queues of small triangles, into the queues of the tiles they reach into, or to the large
    /// triangles. The masks mark triangles without the alpha test and with it.
    #[inline(always)]
    fn sort<S: Simd, R: Rule, const N: usize>(
        &self,
        triangles: &[DrawTriangle; PACK],
        (pack, boxes): (&Pack<S>, [i32x16<S>; 4]),
        (plain, cutout): (mask32x16<S>, u64),
        bins: &mut Bins,
    ) {
        let [left, top, right, bottom] = boxes;
        let side = (right - left).max(bottom - top);
        // With several samples, triangles of more than a few pixels wait for their tiles.
        let in_tiles = N > 1 && R::IN_TILES;
        let (tiles, in_tile) = (bins.tile_queues.boxes(boxes), packed(pack));
        let mut above = 0;
        let queues = if self.has_small::<R>() { R::QUEUES } else { 0 };
        // The queues in ascending size; a full queue is drawn immediately.
        for (queue, limit) in SMALL[..queues].iter().copied().enumerate() {
            let some = plain & side.simd_gt(above) & side.simd_le(limit);
            above = limit;
            let count = some.to_bitmask().count_ones() as usize;
            if count == 0 {
                continue;
            }
            bins.drawn += count;
            if in_tiles && queue >= bins.tile_queues.first_size {
                bins.tile_queues.add(queue, (&in_tile, &tiles), some);
                continue;
            }
            if bins.queues[queue].add(pack, some, count) {
                small::draw_queue::<S, R, N>(side.simd, queue, bins);
            }
        }
        // The remaining triangles are large or alpha-tested.
        let large = (plain & side.simd_gt(above)).to_bitmask() | cutout;
        for lane in Bits(large) {
            let corners = each(triangles[lane].vertices, |i| self.vertices[i as usize]);
            let number = self.base + triangles[lane].number;
            let cutout = cutout >> lane & 1 != 0;
            // This list is filled before the triangle is added, so that its indices match.
            if R::UNSNAPPED {
                let own = each(triangles[lane].vertices, |i| self.unsnapped[i as usize]);
                bins.unsnapped.push(own);
            }
            self.add_large::<R, N>(LargeTriangle { corners, number, cutout }, bins);
        }
    }

    /// Adds a triangle that is large, or is not drawn together with small ones.
    #[inline(always)]
    fn add_large<R: Rule, const N: usize>(&self, triangle: LargeTriangle, bins: &mut Bins) {
        let at = each(triangle.corners, |corner| corner.at());
        let reach = self.reach::<R, N>(bins);
        bins.add_large(triangle, PixelBox::reached_on(R::GRID, at, reach));
    }

    /// Returns the range of offsets from pixel centres at which triangles may cover.
    #[inline(always)]
    fn reach<R: Rule, const N: usize>(&self, bins: &Bins) -> [[i32; 2]; 2] {
        let reach = bins.sample_positions.reach::<N>();
        if R::UNSNAPPED { beyond::reach(self.coverage, reach) } else { reach }
    }

    /// Returns whether small triangles are drawn sixteen at a time.
    #[inline(always)]
    fn has_small<R: Rule>(&self) -> bool {
        !R::UNSNAPPED || self.coverage == Coverage::F32Edges
    }

    /// Splits the triangles of a mask by kind of drawing: the masks without and with the alpha
    /// test, for opaque triangles and for transparent ones. `front` is the mask of front-facing
    /// triangles.
    #[inline(always)]
    fn kinds(
        &self,
        triangles: &[DrawTriangle; PACK],
        some: u64,
        front: u64,
    ) -> [(u64, u64, bool); 2] {
        // The common case: all triangles of the draw are of one kind.
        if !self.choosy {
            let (opaque, transparent) = if self.transparent { (0, some) } else { (some, 0) };
            return [(opaque, 0, false), (transparent, 0, true)];
        }
        let [mut plain, mut cutout, transparent] = self.kinds_one_by_one(triangles, some);
        // Back faces of transparent parts are kept in this case.
        if self.draw.culls_opaque {
            (plain, cutout) = (plain & front, cutout & front);
        }
        [(plain, cutout, false), (transparent, 0, true)]
    }

    /// Returns the masks of triangles drawn without the alpha test, with it, and as transparent.
    fn kinds_one_by_one(&self, triangles: &[DrawTriangle; PACK], some: u64) -> [u64; 3] {
        let mut kinds = [0; 3];
        for lane in Bits(some) {
            match self.kind(triangles[lane].number) {
                Kind::Not => {}
                Kind::Plain => kinds[0] |= 1 << lane,
                Kind::Cutout => kinds[1] |= 1 << lane,
                Kind::Transparent => kinds[2] |= 1 << lane,
            }
        }
        kinds
    }

    /// Adds a triangle that needs clipping, or 64 bits for its area.
    fn add_odd<R: Rule, const N: usize>(&self, triangle: &DrawTriangle, bins: &mut Bins) {
        let kind = self.kind(triangle.number);
        if kind == Kind::Not {
            return;
        }
        let vertices = triangle.vertices.map(|vertex| self.vertices[vertex as usize]);
        // Clipping returns a convex polygon, drawn as a fan of triangles around its first corner.
        let (mut pieces, mut unsnapped) = (Vec::new(), Vec::new());
        if vertices.iter().all(ScreenVertex::is_inside) {
            pieces.extend(vertices);
            if R::UNSNAPPED {
                unsnapped.extend(triangle.vertices.map(|i| self.unsnapped[i as usize]));
            }
        } else {
            let clip = |vertex: u32| self.screen.clip(self.order.position(vertex));
            for clip in self.screen.cut(triangle.vertices.map(clip)) {
                pieces.push(self.screen.piece(clip));
                if R::UNSNAPPED {
                    unsnapped.push(self.screen.pixels_seen(clip));
                }
            }
        }
        for i in 2..pieces.len() {
            let corners = [pieces[0], pieces[i - 1], pieces[i]];
            let area = doubled_area(corners.map(|corner| corner.at()));
            let front = (area < 0) != self.draw.mirrored;
            // Facing is tested on the clipped pieces, after snapping.
            if area == 0 || (!front && self.culls_back(kind)) {
                continue;
            }
            let bins = bins.of(kind == Kind::Transparent);
            let number = self.base + triangle.number;
            let cutout = kind == Kind::Cutout;
            if R::UNSNAPPED {
                bins.unsnapped.push([unsnapped[0], unsnapped[i - 1], unsnapped[i]]);
            }
            self.add_large::<R, N>(LargeTriangle { corners, number, cutout }, bins);
        }
    }

    fn kind(&self, number: u32) -> Kind {
        let mesh = &self.draw.model.mesh;
        // Excluded polygons first, then the pipeline of the part decides.
        let polygon = mesh.polygon_of(number);
        if self.draw.polygons.as_ref().is_some_and(|some| !some.contains(&polygon)) {
            return Kind::Not;
        }
        match self.draw.part_pipelines[mesh.polygon_parts()[polygon as usize] as usize] {
            None => Kind::Not,
            Some(pipeline) => match &self.pipelines[pipeline as usize] {
                Pipeline::Shaded(Shaded { cutout: Some(_), .. }) => {
                    // The table spares opaque triangles the alpha test, and drops empty ones.
                    match self.holes.get(number as usize) {
                        Some(Holes::Nowhere) => Kind::Plain,
                        Some(Holes::Everywhere) => Kind::Not,
                        Some(Holes::Somewhere) | None => Kind::Cutout,
                    }
                }
                Pipeline::Shaded(Shaded { opacity: Some(_), .. }) => Kind::Transparent,
                Pipeline::Shaded(_) | Pipeline::Flat(_) => Kind::Plain,
            },
        }
    }

    /// Returns whether the back faces of a kind are culled.
    fn culls_back(&self, kind: Kind) -> bool {
        self.draw.back == Back::Culled || (kind != Kind::Transparent && self.draw.culls_opaque)
    }
}

/// Draws the small triangles that are still waiting.
pub(crate) fn finish<R: Rule>(level: Level, bins: &mut Bins) {
    if bins.transparent().is_some() {
        finish::<R>(level, bins.of(true));
    }
    let many = bins.sample_positions.are_many();
    dispatch!(level, simd => {
        for queue in 0..R::QUEUES {
            match many {
                true => small::draw_queue::<_, R, MANY>(simd, queue, bins),
                false => small::draw_queue::<_, R, 1>(simd, queue, bins),
            }
        }
    });
}
