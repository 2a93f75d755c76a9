//! From vertices on the screen to triangles in bins.
//!
//! Sixteen triangles at a time: those that face away, that cover no pixel's centre or that miss the
//! picture are dropped before anything of theirs is copied. What has a corner beyond the planes is
//! cut, and what is so large that its area needs 64 bits is looked at one by one.

use fearless_simd::{Level, Simd, SimdBase as _, SimdMask as _, dispatch, i32x16};

use super::bins::{Bins, LargeTriangle, SMALL};
use super::clip::{Screen, ScreenVertex};
use super::coverage::{PixelBox, SUBPIXELS, doubled_area};
use super::plan::{Back, Draw, Pipeline};
use crate::base::image::Size;
use crate::base::math::each;
use crate::scene::{DrawOrder, DrawTriangle};

/// The largest box, in parts of a pixel, whose doubled area fits 31 bits.
const NARROW: i32 = 1 << 14;

/// What setting up the triangles of one draw reads.
#[derive(Debug)]
pub(super) struct Setup<'a> {
    pub(super) draw: &'a Draw,
    pub(super) order: &'a DrawOrder,
    pub(super) vertices: &'a [ScreenVertex],
    pub(super) screen: Screen,
    pub(super) size: Size,
    /// The number of the draw's first triangle in the frame.
    pub(super) base: u32,
    /// Whether some triangles are not drawn or have holes: then each is asked.
    pub(super) choosy: bool,
}

/// How a triangle is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Not,
    Plain,
    Cutout,
}

impl<'a> Setup<'a> {
    pub(super) fn new(
        draw: &'a Draw,
        pipelines: &[Pipeline],
        vertices: &'a [ScreenVertex],
        size: Size,
        base: u32,
    ) -> Self {
        let choosy = draw.polygons.is_some()
            || draw.part_pipelines.iter().any(|pipeline| {
                pipeline.is_none_or(|pipeline| pipelines[pipeline as usize].is_cutout())
            });
        let screen = Screen::new(draw.clip_from_object, size);
        Self { draw, order: draw.model.mesh.draw_order(), vertices, screen, size, base, choosy }
    }

    /// Puts some of the draw's triangles into bins.
    pub(super) fn run(
        &self,
        level: Level,
        triangles: &[DrawTriangle],
        pipelines: &[Pipeline],
        bins: &mut Bins,
    ) {
        dispatch!(level, simd => self.all(simd, triangles, pipelines, bins));
    }

    #[inline(always)]
    fn all<S: Simd>(
        &self,
        simd: S,
        triangles: &[DrawTriangle],
        pipelines: &[Pipeline],
        bins: &mut Bins,
    ) {
        for sixteen in triangles.chunks(16) {
            self.sixteen(simd, sixteen, pipelines, bins);
        }
    }

    #[inline(always)]
    fn sixteen<S: Simd>(
        &self,
        simd: S,
        triangles: &[DrawTriangle],
        pipelines: &[Pipeline],
        bins: &mut Bins,
    ) {
        let (mut x, mut y) = ([[0; 16]; 3], [[0; 16]; 3]);
        let mut beyond = 0_u64;
        for (lane, triangle) in triangles.iter().enumerate() {
            for (i, vertex) in triangle.vertices.into_iter().enumerate() {
                let vertex = &self.vertices[vertex as usize];
                let at = vertex.at();
                (x[i][lane], y[i][lane]) = (at.x, at.y);
                beyond |= u64::from(!vertex.is_inside()) << lane;
            }
        }
        let x = each([0, 1, 2], |i: usize| i32x16::from_slice(simd, &x[i]));
        let y = each([0, 1, 2], |i: usize| i32x16::from_slice(simd, &y[i]));
        let (low_x, high_x) = (x[0].min(x[1]).min(x[2]), x[0].max(x[1]).max(x[2]));
        let (low_y, high_y) = (y[0].min(y[1]).min(y[2]), y[0].max(y[1]).max(y[2]));

        let half = SUBPIXELS / 2;
        let left = (low_x + (half - 1)) >> 8;
        let right = ((high_x - half) >> 8) + 1;
        let top = (low_y + (half - 1)) >> 8;
        let bottom = ((high_y - half) >> 8) + 1;
        let [width, height] = [self.size.width, self.size.height]
            .map(|pixels| i32::try_from(pixels).expect("pictures have 32-bit sizes"));
        let seen = left.simd_lt(right)
            & top.simd_lt(bottom)
            & right.simd_gt(0)
            & bottom.simd_gt(0)
            & left.simd_lt(width)
            & top.simd_lt(height);
        let wide = (high_x - low_x).simd_gt(NARROW) | (high_y - low_y).simd_gt(NARROW);
        let area = (x[1] - x[0]) * (y[2] - y[0]) - (y[1] - y[0]) * (x[2] - x[0]);
        let turned = if self.draw.back == Back::Left {
            let away = if self.draw.mirrored { area.simd_lt(1) } else { area.simd_gt(-1) };
            away.to_bitmask()
        } else {
            area.simd_eq(0).to_bitmask()
        };

        let there = (1_u64 << triangles.len()) - 1;
        let odd = (beyond | (wide.to_bitmask() & seen.to_bitmask())) & there;
        let mut plain = seen.to_bitmask() & !turned & !wide.to_bitmask() & !beyond & there;
        if plain != 0 {
            let mut bounds = [[0; 16]; 4];
            left.store_slice(&mut bounds[0]);
            top.store_slice(&mut bounds[1]);
            right.store_slice(&mut bounds[2]);
            bottom.store_slice(&mut bounds[3]);
            while plain != 0 {
                let lane = plain.trailing_zeros() as usize;
                plain &= plain - 1;
                let bounds = PixelBox {
                    left: bounds[0][lane],
                    top: bounds[1][lane],
                    right: bounds[2][lane],
                    bottom: bounds[3][lane],
                };
                self.add(&triangles[lane], bounds, pipelines, bins);
            }
        }
        let mut odd = odd;
        while odd != 0 {
            let lane = odd.trailing_zeros() as usize;
            odd &= odd - 1;
            self.add_odd(&triangles[lane], pipelines, bins);
        }
    }

    /// Adds a triangle that is inside all planes, seen, and small enough for 32 bits.
    #[inline(always)]
    fn add(
        &self,
        triangle: &DrawTriangle,
        bounds: PixelBox,
        pipelines: &[Pipeline],
        bins: &mut Bins,
    ) {
        let number = self.base + triangle.number;
        let corners = each(triangle.vertices, |vertex| &self.vertices[vertex as usize]);
        let kind = if self.choosy { self.kind(triangle.number, pipelines) } else { Kind::Plain };
        let side = (bounds.right - bounds.left).max(bounds.bottom - bounds.top);
        match kind {
            Kind::Plain if side <= SMALL[0] => bins.add_small(0, corners, bounds, number),
            Kind::Plain if side <= SMALL[1] => bins.add_small(1, corners, bounds, number),
            Kind::Plain if side <= SMALL[2] => bins.add_small(2, corners, bounds, number),
            Kind::Not => {}
            _ => {
                let cutout = kind == Kind::Cutout;
                let corners = each(corners, |corner| *corner);
                bins.add_large(LargeTriangle { corners, number, cutout }, bounds);
            }
        }
    }

    /// Adds a triangle that has to be cut, or whose area needs 64 bits.
    fn add_odd(&self, triangle: &DrawTriangle, pipelines: &[Pipeline], bins: &mut Bins) {
        let kind = self.kind(triangle.number, pipelines);
        if kind == Kind::Not {
            return;
        }
        let vertices = triangle.vertices.map(|vertex| self.vertices[vertex as usize]);
        let pieces = if vertices.iter().all(ScreenVertex::is_inside) {
            vertices.to_vec()
        } else {
            self.screen.cut(self.clip_corners(triangle.vertices))
        };
        for i in 2..pieces.len() {
            let corners = [pieces[0], pieces[i - 1], pieces[i]];
            let area = doubled_area(corners.map(|corner| corner.at()));
            let front = (area < 0) != self.draw.mirrored;
            if area == 0 || (!front && self.draw.back == Back::Left) {
                continue;
            }
            let number = self.base + triangle.number;
            let cutout = kind == Kind::Cutout;
            let bounds = PixelBox::of(corners.map(|corner| corner.at()));
            bins.add_large(LargeTriangle { corners, number, cutout }, bounds);
        }
    }

    /// The corners of a triangle in clip space.
    fn clip_corners(&self, vertices: [u32; 3]) -> [super::clip::Clip; 3] {
        vertices.map(|vertex| self.screen.clip(self.order.position(vertex)))
    }

    fn kind(&self, number: u32, pipelines: &[Pipeline]) -> Kind {
        let mesh = &self.draw.model.mesh;
        let polygon = mesh.triangles()[number as usize].polygon;
        if self.draw.polygons.as_ref().is_some_and(|some| !some.contains(&polygon)) {
            return Kind::Not;
        }
        match self.draw.part_pipelines[mesh.polygon_parts()[polygon as usize] as usize] {
            None => Kind::Not,
            Some(pipeline) if pipelines[pipeline as usize].is_cutout() => Kind::Cutout,
            Some(_) => Kind::Plain,
        }
    }
}
