//! Sets up a frame in parallel: all threads put triangles and lines into separate bins.

use crate::accel::Accelerated as _;
use std::sync::Mutex;
use std::sync::atomic::AtomicU8;

use fearless_simd::Level;

use super::bins::Bins;
use super::culling::Culling;
use super::edges::{DrawnNormal, EdgeSetup};
use super::facing::Facing;
use super::hit_colors::{Brush, CornerLight};
use super::hole_tables::HoleTables;
use super::rule::with_rule;
use super::setup::{self, Setup};
use super::starts::{DrawCorners, Start, number};
use super::vertices::Vertices;
use super::work::{What, Work};
use crate::accel::CLUSTER;
use crate::cancellation::Cancellation;
use crate::frame::FramePlan;
use crate::frame::draw::Draw;
use crate::screen::clip::{Screen, ScreenVertex};
use crate::work_stealing::{WorkStealing, own, together};

/// Runs the work on all threads, each with separate bins, unless cancelled.
pub(crate) fn share_out(
    level: Level,
    work: &[Work<What>],
    parts: &Parts<'_>,
    bins: &mut [Bins],
    watch: &Cancellation<'_>,
) {
    let shares = WorkStealing::new(work.len(), bins.len());
    let all: Vec<Mutex<&mut Bins>> = bins.iter_mut().map(Mutex::new).collect();
    together(all.len(), || {
        let bins = &mut own(&all);
        let brush = &mut Brush::new(parts.light, parts.corners());
        while let Some(work) = shares.next().map(|i| &work[i]) {
            if !watch.goes_on() {
                return;
            }
            parts.run(level, work, bins, brush);
        }
        // The queues hold fewer than a full batch at the end.
        with_rule!(parts.plan.variants, R => setup::finish::<R>(level, bins, brush));
    });
}

/// The inputs of all threads that fill bins.
#[derive(Debug)]
pub(crate) struct Parts<'a> {
    plan: &'a FramePlan,
    vertices: &'a Vertices,
    starts: &'a [Start],
    outlines: &'a [AtomicU8],
    holes: Option<&'a HoleTables>,
    normals: &'a [DrawnNormal],
    /// The light at corners, if hits have colours.
    light: Option<&'a dyn CornerLight>,
}

impl<'a> Parts<'a> {
    pub(crate) fn new(
        plan: &'a FramePlan,
        vertices: &'a Vertices,
        starts: &'a [Start],
        outlines: &'a [AtomicU8],
    ) -> Self {
        Self { plan, vertices, starts, outlines, holes: None, normals: &[], light: None }
    }

    /// Adds the classification of holes.
    pub(crate) fn with_holes(self, holes: &'a HoleTables) -> Self {
        Self { holes: Some(holes), ..self }
    }

    /// Adds the drawn normals.
    pub(crate) fn with_normals(self, normals: &'a [DrawnNormal]) -> Self {
        Self { normals, ..self }
    }

    /// Adds the light for colouring hits.
    pub(crate) fn with_light(self, light: Option<&'a dyn CornerLight>) -> Self {
        Self { light, ..self }
    }

    fn run(&self, level: Level, work: &Work<What>, bins: &mut Bins, brush: &mut Brush<'_>) {
        let Work { draw: i, what, from, to, .. } = *work;
        let draw = &self.plan.draws[i];
        let mesh = &draw.model.mesh;
        let (vertices, viewport) = (self.vertices_of(i), self.plan.viewport);
        match what {
            What::Triangles => {
                // The screen corners of this draw, on the grid and with the variants of the frame.
                let pipelines = &self.plan.pipelines;
                let corners = self.corners().of(i);
                let setup = Setup::new(draw, pipelines, corners, viewport, self.starts[i].number);
                let mut setup = setup.seen_from(self.plan.shift, self.plan.variants.grid());
                setup.coverage = self.plan.variants.coverage;
                setup.holes = self.holes.map_or(&[], |holes| holes.of_draw(i));
                if !self.vertices.unsnapped.is_empty() {
                    setup.unsnapped = &self.vertices.unsnapped[self.starts[i].vertex..];
                }
                // Cluster culling removes whole ranges before any triangle is set up.
                let order = mesh.draw_order();
                let triangles = &order.triangles[from..to];
                with_rule!(self.plan.variants, R => if order.clusters.is_empty() {
                    setup.run::<R>(level, triangles, pipelines, (bins, brush));
                } else {
                    let clusters = &order.clusters[from / CLUSTER..];
                    let culling = Culling::new(draw, setup.screen, self.plan.size);
                    culling.each_left(clusters, triangles, |some| {
                        setup.run::<R>(level, some, pipelines, (bins, brush));
                    });
                });
            }
            What::Facing => {
                let triangles = &mesh.draw_order().triangles[from..to];
                let facing = Facing::new(draw, vertices, viewport);
                facing.of_triangles(level, triangles, self.outlines_of(i));
            }
            What::FacingOneByOne => {
                let facing = Facing::new(draw, vertices, viewport);
                for polygon in from..to {
                    facing.one(number(polygon), self.outlines_of(i));
                }
            }
            What::Normals => {
                let Start { normal, normal_place, .. } = self.starts[i];
                let own = &self.normals[normal_place..][from..to];
                self.edge_setup(i).add_normals(level, (normal + number(from), own), bins);
            }
            What::Edges => {
                self.edge_setup(i).run(level, &mesh.edge_order().edges[from..to], bins);
            }
        }
    }

    pub(crate) fn edge_setup(&self, i: usize) -> EdgeSetup<'a> {
        let plan = self.plan;
        let (draw, first) = (&plan.draws[i], self.starts[i].line);
        let grid = plan.variants.grid();
        let screen = Screen::new(draw.clip_from_object, plan.viewport).on(grid);
        let screen = screen.seen_from(grid.offset(plan.shift));
        let (vertices, outlines) = (self.corners().of(i), self.outlines_of(i));
        EdgeSetup { draw, vertices, screen, grid, outlines, first, width: plan.line_width }
    }

    fn vertices_of(&self, draw: usize) -> &'a [ScreenVertex] {
        let Start { vertex, vertex_end, .. } = self.starts[draw];
        &self.vertices.usual[vertex..vertex_end]
    }

    /// Returns the corners of all triangles.
    fn corners(&self) -> DrawCorners<'a> {
        DrawCorners { corners: self.vertices.corners(), starts: self.starts }
    }

    /// Returns the outlines of a draw; empty if its edges are not drawn.
    pub(crate) fn outlines_of(&self, draw: usize) -> &'a [AtomicU8] {
        let Draw { model, lines, .. } = &self.plan.draws[draw];
        let count = if lines.edges { model.mesh.polygon_count() } else { 0 };
        &self.outlines[self.starts[draw].outline..][..count]
    }
}
