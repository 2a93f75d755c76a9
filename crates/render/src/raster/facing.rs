//! Finds the colour of polygon outlines.
//!
//! The colour depends on the side that the observer sees, given by the sign of the area on the
//! screen. If all polygons are triangles, and all back faces are treated alike, sixteen are
//! computed at a time in draw order; other polygons are computed one by one.

use crate::accel::Accelerated as _;
use std::sync::atomic::{AtomicU8, Ordering};

use crate::simd::{Bits, dispatch};
use fearless_simd::{Level, Select as _, Simd, SimdBase as _, SimdMask as _, i32x16};

use super::hits::PACK;
use super::setup::NARROW;
use super::vertices::fetch_corners;
use crate::accel::DrawTriangle;
use crate::frame::FramePlan;
use crate::frame::draw::{Back, Draw, Pipeline};
use crate::screen::clip::{Screen, ScreenVertex};
use crate::screen::coverage::doubled_area;
use marraztu_core::scene::Mesh;

/// The colour of an outline. An edge gets the largest one of its polygons.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Outline {
    /// The outline is not drawn.
    Not,
    /// The colour of back faces.
    Back,
    /// The draw's line colour.
    Own,
}

impl Outline {
    /// Returns the outline with this number.
    #[inline(always)]
    pub(crate) const fn of(number: u8) -> Self {
        match number {
            0 => Self::Not,
            1 => Self::Back,
            _ => Self::Own,
        }
    }
}

/// The inputs for finding the outlines of one draw.
#[derive(Debug)]
pub(crate) struct Facing<'a> {
    draw: &'a Draw,
    pipelines: &'a [Pipeline],
    mesh: &'a Mesh,
    vertices: &'a [ScreenVertex],
    screen: Screen,
    /// The outlines of polygons with a negative and a positive area.
    outlines: [Outline; 2],
}

impl<'a> Facing<'a> {
    pub(crate) fn new(plan: &'a FramePlan, draw: &'a Draw, vertices: &'a [ScreenVertex]) -> Self {
        let back = match draw.back {
            Back::Lit => Outline::Own,
            Back::Red => Outline::Back,
            Back::Culled => Outline::Not,
        };
        // Front faces have a negative area, or a positive one if mirrored.
        let outlines = if draw.mirrored { [back, Outline::Own] } else { [Outline::Own, back] };
        let screen = Screen::new(draw.clip_from_object, plan.viewport);
        let (mesh, pipelines) = (&draw.model.mesh, &plan.pipelines[..]);
        Self { draw, pipelines, mesh, vertices, screen, outlines }
    }

    /// Finds the outlines of polygons that are single triangles.
    pub(crate) fn of_triangles(&self, level: Level, triangles: &[DrawTriangle], all: &[AtomicU8]) {
        dispatch!(level, simd => self.all(simd, triangles, all));
    }

    #[inline(always)]
    fn all<S: Simd>(&self, simd: S, triangles: &[DrawTriangle], all: &[AtomicU8]) {
        let (whole, rest) = triangles.as_chunks::<PACK>();
        for sixteen in whole {
            self.sixteen(simd, sixteen, all);
        }
        for triangle in rest {
            self.one(triangle.number, all);
        }
    }

    #[inline(always)]
    fn sixteen<S: Simd>(&self, simd: S, triangles: &[DrawTriangle; PACK], all: &[AtomicU8]) {
        let [x0, y0, ..] = fetch_corners(simd, self.vertices, triangles, 0);
        let [x1, y1, ..] = fetch_corners(simd, self.vertices, triangles, 1);
        let [x2, y2, ..] = fetch_corners(simd, self.vertices, triangles, 2);
        // A triangle beyond the clipping planes, or with an area of more than 32 bits, is done
        // singly.
        let (low_x, high_x) = (x0.min(x1).min(x2), x0.max(x1).max(x2));
        let (low_y, high_y) = (y0.min(y1).min(y2), y0.max(y1).max(y2));
        let beyond = low_x.simd_eq(ScreenVertex::BEYOND);
        let wide = (high_x - low_x).simd_gt(NARROW) | (high_y - low_y).simd_gt(NARROW);
        let area = (x1 - x0) * (y2 - y0) - (y1 - y0) * (x2 - x0);
        let [negative, positive] = self.outlines.map(|outline| i32x16::splat(simd, outline as i32));
        let outlines = area.simd_lt(0).select(negative, positive);
        let outlines = area.simd_eq(0).select(i32x16::splat(simd, Outline::Not as i32), outlines);
        let outlines: [i32; PACK] = *outlines;
        let choosy = self.draw.polygons.is_some() || self.draw.uniform.is_none();
        // Relaxed stores are enough: outlines are read after all threads have joined.
        for (lane, triangle) in triangles.iter().enumerate() {
            let shown = !choosy || self.draw.shows(triangle.number);
            let [outline, ..] = outlines[lane].to_le_bytes();
            let outline = if shown { outline } else { Outline::Not as u8 };
            all[triangle.number as usize].store(outline, Ordering::Relaxed);
        }
        // Their areas in lanes are meaningless, so these outlines are overwritten.
        for lane in Bits((beyond | wide).to_bitmask()) {
            self.one(triangles[lane].number, all);
        }
    }

    /// Finds the outline of a polygon.
    pub(crate) fn one(&self, polygon: u32, all: &[AtomicU8]) {
        let outline = if self.draw.shows(polygon) { self.seen(polygon) } else { Outline::Not };
        all[polygon as usize].store(outline as u8, Ordering::Relaxed);
    }

    fn seen(&self, polygon: u32) -> Outline {
        let triangles = self.mesh.triangles_of(polygon);
        let number = |i: usize| u32::try_from(i).expect("triangles have 32-bit numbers");
        let area: i64 = triangles.map(|triangle| self.area_on_screen(number(triangle))).sum();
        let is_back = (area > 0) != self.draw.mirrored;
        match area {
            0 => Outline::Not,
            _ if is_back && self.draw.culls_opaque && !self.is_transparent(polygon) => Outline::Not,
            ..0 => self.outlines[0],
            1.. => self.outlines[1],
        }
    }

    fn is_transparent(&self, polygon: u32) -> bool {
        let part = self.mesh.polygon_parts()[polygon as usize];
        let pipeline = self.draw.part_pipelines[part as usize];
        pipeline.is_some_and(|pipeline| self.pipelines[pipeline as usize].opacity().is_some())
    }

    /// Computes twice the area of a triangle on the screen after clipping, in square subpixels.
    fn area_on_screen(&self, triangle: u32) -> i64 {
        let order = self.mesh.draw_order();
        let corners = order.vertices_of(triangle);
        let own = corners.map(|vertex| self.vertices[vertex as usize]);
        if own.iter().all(ScreenVertex::is_inside) {
            return doubled_area(own.map(|corner| corner.at()));
        }
        // A clipped triangle counts by the polygon that is left, as a fan around its first corner.
        let clip = corners.map(|vertex| self.screen.clip(order.position(vertex)));
        let pieces = self.screen.cut(clip);
        let piece = |i: usize| {
            doubled_area([pieces[0], pieces[i - 1], pieces[i]].map(|p| self.screen.piece(p).at()))
        };
        (2..pieces.len()).map(piece).sum()
    }
}
