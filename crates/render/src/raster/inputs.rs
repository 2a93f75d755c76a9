//! What all threads read while they fill bins.

use std::sync::atomic::AtomicU8;

use super::edges::DrawnNormal;
use super::hole_tables::HoleTables;
use super::numbers::number;
use super::vertices::Vertices;
use crate::frame::FramePlan;
use crate::frame::draw::Draw;
use crate::screen::clip::ScreenVertex;

/// The first numbers of one draw.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Start {
    pub(crate) vertex: usize,
    pub(crate) vertex_end: usize,
    /// The number of the first triangle.
    pub(crate) number: u32,
    /// The number after the last triangle's.
    pub(crate) end: u32,
    pub(crate) outline: usize,
    /// The number of the first edge among the lines.
    pub(crate) line: u32,
    /// The number of the first normal among the lines.
    pub(crate) normal: u32,
    /// The number of the first stroke among the lines.
    pub(crate) stroke: u32,
    /// The number after the last line's.
    pub(crate) line_end: u32,
    /// The index of the first normal among the normals of all draws.
    pub(crate) normal_place: usize,
}

/// What all threads read while they fill bins.
#[derive(Debug, Default)]
pub(crate) struct Inputs {
    /// The vertices of all draws, in the draw order of their meshes.
    pub(super) vertices: Vertices,
    pub(super) starts: Vec<Start>,
    /// The number of an [`Outline`](super::facing::Outline) for each polygon of draws with edges.
    pub(super) outlines: Vec<AtomicU8>,
    /// The drawn normals.
    pub(super) normals: Vec<DrawnNormal>,
    /// The classification of triangles by their holes.
    pub(super) holes: HoleTables,
}

impl Inputs {
    /// Returns the draw of a triangle, and the draw's first numbers.
    #[inline(always)]
    pub(crate) fn draw_of(&self, triangle: u32) -> (u32, Start) {
        // The first draw that ends after the triangle; draws without triangles are skipped.
        let draw = self.starts.partition_point(|start| start.end <= triangle);
        (number(draw), self.starts[draw])
    }

    /// Returns the corners of a draw's triangles, on the finer grid if there is one.
    pub(crate) fn corners_of(&self, draw: usize) -> &[ScreenVertex] {
        let Start { vertex, vertex_end, .. } = self.starts[draw];
        let Vertices { usual, fine, .. } = &self.vertices;
        // The finer grid replaces the usual one for all draws of a frame.
        let corners = if fine.is_empty() { usual } else { fine };
        &corners[vertex..vertex_end]
    }

    /// Returns the outlines of a draw; empty if its edges are not drawn.
    pub(super) fn outlines_of(&self, plan: &FramePlan, draw: usize) -> &[AtomicU8] {
        let Draw { model, lines, .. } = &plan.draws[draw];
        let count = if lines.edges { model.mesh.polygon_count() } else { 0 };
        &self.outlines[self.starts[draw].outline..][..count]
    }
}
