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
use crate::screen::clip::Screen;
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
        let brush = &mut Brush::new(parts.light, parts.inputs.corners());
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

/// What all threads read while they fill bins.
#[derive(Debug, Default)]
pub(crate) struct Inputs {
    /// The vertices of all draws, in the draw order of their meshes.
    pub(crate) vertices: Vertices,
    pub(crate) starts: Vec<Start>,
    /// The number of an [`Outline`](super::facing::Outline) for each polygon of draws with edges.
    pub(crate) outlines: Vec<AtomicU8>,
    /// The drawn normals.
    pub(crate) normals: Vec<DrawnNormal>,
    /// The classification of triangles by their holes.
    pub(crate) holes: HoleTables,
}

impl Inputs {
    /// Returns the corners of all triangles.
    pub(crate) fn corners(&self) -> DrawCorners<'_> {
        DrawCorners { corners: self.vertices.corners(), starts: &self.starts }
    }

    /// Returns the outlines of a draw; empty if its edges are not drawn.
    pub(crate) fn outlines_of(&self, plan: &FramePlan, draw: usize) -> &[AtomicU8] {
        let Draw { model, lines, .. } = &plan.draws[draw];
        let count = if lines.edges { model.mesh.polygon_count() } else { 0 };
        &self.outlines[self.starts[draw].outline..][..count]
    }
}

/// Sets up the draws of a plan into bins.
#[derive(Debug)]
pub(crate) struct Parts<'a> {
    pub(crate) plan: &'a FramePlan,
    pub(crate) inputs: &'a Inputs,
    /// The light at corners, if hits have colours.
    pub(crate) light: Option<&'a dyn CornerLight>,
}

impl Parts<'_> {
    fn run(&self, level: Level, work: &Work<What>, bins: &mut Bins, brush: &mut Brush<'_>) {
        let Work { draw: i, what, from, to, .. } = *work;
        let Self { plan, inputs, .. } = *self;
        let (draw, start) = (&plan.draws[i], inputs.starts[i]);
        let mesh = &draw.model.mesh;
        let vertices = &inputs.vertices.usual[start.vertex..start.vertex_end];
        let outlines = inputs.outlines_of(plan, i);
        match what {
            What::Triangles => {
                // The screen corners of this draw, on the grid and with the variants of the frame.
                let mut setup = Setup::new(plan, draw, inputs.corners().of(i), start.number);
                setup.unsnapped = inputs.vertices.unsnapped.get(start.vertex..).unwrap_or_default();
                setup.holes = inputs.holes.of_draw(i);
                // Cluster culling removes whole ranges before any triangle is set up.
                let order = mesh.draw_order();
                let triangles = &order.triangles[from..to];
                with_rule!(plan.variants, R => if order.clusters.is_empty() {
                    setup.run::<R>(level, triangles, (bins, brush));
                } else {
                    let clusters = &order.clusters[from / CLUSTER..];
                    let culling = Culling::new(draw, setup.screen, plan.size);
                    culling.each_left(clusters, triangles, |some| {
                        setup.run::<R>(level, some, (bins, brush));
                    });
                });
            }
            What::Facing => {
                let triangles = &mesh.draw_order().triangles[from..to];
                let facing = Facing::new(draw, vertices, plan.viewport);
                facing.of_triangles(level, triangles, outlines);
            }
            What::FacingOneByOne => {
                let facing = Facing::new(draw, vertices, plan.viewport);
                (from..to).for_each(|polygon| facing.one(number(polygon), outlines));
            }
            What::Normals => {
                let normals = &inputs.normals[start.normal_place..][from..to];
                let first = start.normal + number(from);
                self.edge_setup(i).add_normals(level, (first, normals), bins);
            }
            What::Edges => {
                self.edge_setup(i).run(level, &mesh.edge_order().edges[from..to], bins);
            }
        }
    }

    fn edge_setup(&self, i: usize) -> EdgeSetup<'_> {
        let Self { plan, inputs, .. } = *self;
        let (draw, first) = (&plan.draws[i], inputs.starts[i].line);
        let grid = plan.variants.grid();
        let screen = Screen::new(draw.clip_from_object, plan.viewport).on(grid);
        let screen = screen.seen_from(grid.offset(plan.shift));
        let (vertices, outlines) = (inputs.corners().of(i), inputs.outlines_of(plan, i));
        EdgeSetup { draw, vertices, screen, grid, outlines, first, width: plan.line_width }
    }
}
