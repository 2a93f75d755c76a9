//! Sets up a frame in parallel: all threads put triangles and lines into separate bins.

use crate::accel::Accelerated as _;
use std::sync::Mutex;

use fearless_simd::Level;

use super::bins::Bins;
use super::culling::Culling;
use super::edges::EdgeSetup;
use super::facing::Facing;
use super::inputs::Inputs;
use super::numbers::number;
use super::rule::with_rule;
use super::setup::{self, Setup};
use super::strokes::StrokeSetup;
use super::work::{What, Work};
use crate::accel::CLUSTER;
use crate::cancellation::Cancellation;
use crate::frame::FramePlan;
use crate::frame::draw::Draw;
use crate::screen::clip::Screen;
use crate::screen::coverage::Grid;
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
        while let Some(work) = shares.next().map(|i| &work[i]) {
            if !watch.goes_on() {
                return;
            }
            parts.run(level, work, bins);
        }
        // The queues hold fewer than a full batch at the end.
        with_rule!(parts.plan.raster_mode(), R => setup::finish::<R>(level, bins));
    });
}

/// Sets up the draws of a plan into bins.
#[derive(Debug)]
pub(crate) struct Parts<'a> {
    pub(crate) plan: &'a FramePlan,
    pub(crate) inputs: &'a Inputs,
}

impl Parts<'_> {
    fn run(&self, level: Level, work: &Work<What>, bins: &mut Bins) {
        let Work { draw: i, what, from, to, .. } = *work;
        let Self { plan, inputs, .. } = *self;
        let (draw, start) = (&plan.draws[i], inputs.starts[i]);
        let mesh = &draw.model.mesh;
        // Outlines depend on the usual grid, even if triangles are on a finer one.
        let vertices = &inputs.vertices.usual[start.vertex..start.vertex_end];
        let outlines = inputs.outlines_of(plan, i);
        match what {
            What::Triangles => {
                // The screen corners of this draw, on the grid of the frame.
                let mut setup = Setup::new(plan, draw, inputs.corners_of(i), start.number);
                setup.unsnapped = inputs.vertices.unsnapped.get(start.vertex..).unwrap_or_default();
                setup.holes = inputs.holes.of_draw(i);
                // Cluster culling removes whole ranges before any triangle is set up.
                let order = mesh.draw_order();
                let triangles = &order.triangles[from..to];
                with_rule!(plan.raster_mode(), R => if order.clusters.is_empty() {
                    setup.run::<R>(level, triangles, bins);
                } else {
                    // Pieces begin at whole clusters.
                    let clusters = &order.clusters[from / CLUSTER..];
                    let culling = Culling::new(draw, setup.screen, plan.size);
                    culling.each_left(clusters, triangles, |some| {
                        setup.run::<R>(level, some, bins);
                    });
                });
            }
            What::Facing => {
                let triangles = &mesh.draw_order().triangles[from..to];
                let facing = Facing::new(plan, draw, vertices);
                facing.of_triangles(level, triangles, outlines);
            }
            What::FacingOneByOne => {
                let facing = Facing::new(plan, draw, vertices);
                (from..to).for_each(|polygon| facing.one(number(polygon), outlines));
            }
            What::Normals => {
                let normals = &inputs.normals[start.normal_place..][from..to];
                let first = start.normal + number(from);
                self.edge_setup(i).add_normals(level, (first, normals), bins);
            }
            What::Strokes => {
                let (screen, grid) = self.screen(draw);
                let (first, width) = (start.stroke, plan.stroke_width);
                StrokeSetup { draw, screen, grid, first, width }.run(level, from..to, bins);
            }
            What::Edges => {
                self.edge_setup(i).run(level, &mesh.edge_order().edges[from..to], bins);
            }
        }
    }

    /// Returns the transform of a draw's positions to the screen, and the grid of the frame.
    fn screen(&self, draw: &Draw) -> (Screen, Grid) {
        let grid = self.plan.raster_mode().grid;
        let screen = Screen::new(draw.clip_from_object, self.plan.viewport).on(grid);
        (screen.seen_from(grid.offset(self.plan.shift)), grid)
    }

    fn edge_setup(&self, i: usize) -> EdgeSetup<'_> {
        let Self { plan, inputs, .. } = *self;
        let (draw, first) = (&plan.draws[i], inputs.starts[i].line);
        let (screen, grid) = self.screen(draw);
        let (vertices, outlines) = (inputs.corners_of(i), inputs.outlines_of(plan, i));
        EdgeSetup { draw, vertices, screen, grid, outlines, first, width: plan.line_width }
    }
}
