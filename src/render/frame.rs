//! A frame on the screen: its vertices, and its triangles and lines in bins.

use std::sync::atomic::{AtomicUsize, Ordering};

use fearless_simd::Level;
use rayon::prelude::*;

use super::bins::{Bins, LargeTriangle};
use super::clip::{Screen, ScreenVertex};
use super::lines::{self, ScreenLine};
use super::plan::FramePlan;
use super::setup::Setup;
use super::vertices;
use crate::scene::DrawTriangle;

/// Triangles that a thread takes at a time.
const CHUNK: usize = 2048;

/// Fewer triangles than this are set up by one thread: waking the others would take longer.
const FEW: usize = 4096;

/// Everything of a frame that is on the screen.
#[derive(Debug, Default)]
pub(super) struct Frame {
    /// The vertices of all draws, in the order in which their meshes are drawn.
    vertices: Vec<ScreenVertex>,
    starts: Vec<Start>,
    bins: Vec<Bins>,
    /// Edges and normals.
    pub(super) lines: Vec<ScreenLine>,
    /// Which tiles they reach into.
    pub(super) line_bins: Bins,
}

/// Where the numbers of a draw begin.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Start {
    vertex: usize,
    /// The number of its first triangle.
    pub(super) number: u32,
    /// The number after that of its last.
    pub(super) end: u32,
}

impl Frame {
    /// Brings everything that the plan draws onto the screen.
    pub(super) fn build(&mut self, level: Level, plan: &FramePlan) {
        self.place(level, plan);
        self.set_up(level, plan);
        let mut all = std::mem::take(&mut self.lines);
        all.clear();
        self.line_bins.clear(plan.size);
        for (i, draw) in plan.draws.iter().enumerate() {
            let i = number(i);
            let vertices = self.vertices_of(plan, i);
            lines::collect(draw, i, plan.size, vertices, &mut all);
        }
        self.lines = all;
        for (i, line) in self.lines.iter().enumerate() {
            self.line_bins.add_line(number(i), lines::bounds(line, plan.line_width));
        }
    }

    /// Vertices to the screen.
    fn place(&mut self, level: Level, plan: &FramePlan) {
        self.starts.clear();
        let mut start = Start::default();
        let mut vertex = 0;
        for draw in &plan.draws {
            let order = draw.model.mesh.draw_order();
            start.vertex = vertex;
            start.number = start.end;
            start.end += number(order.triangles.len());
            vertex += order.x.len();
            self.starts.push(start);
        }
        self.vertices.resize(vertex, ScreenVertex::default());
        for (draw, start) in plan.draws.iter().zip(&self.starts) {
            let order = draw.model.mesh.draw_order();
            let screen = Screen::new(draw.clip_from_object, plan.size);
            let out = &mut self.vertices[start.vertex..][..order.x.len()];
            vertices::transform(level, &screen, order, out);
        }
    }

    /// Triangles into bins: one set of bins for each thread that takes part.
    fn set_up(&mut self, level: Level, plan: &FramePlan) {
        let total = self.starts.last().map_or(0, |start| start.end as usize);
        let threads = if total < FEW { 1 } else { rayon::current_num_threads() };
        self.bins.resize_with(threads, Bins::default);
        let setups: Vec<Setup<'_>> = plan
            .draws
            .iter()
            .zip(&self.starts)
            .map(|(draw, start)| {
                let count = draw.model.mesh.draw_order().x.len();
                let vertices = &self.vertices[start.vertex..][..count];
                Setup::new(draw, &plan.pipelines, vertices, plan.size, start.number)
            })
            .collect();
        let work: Vec<(&Setup<'_>, &[DrawTriangle])> = setups
            .iter()
            .filter(|setup| setup.draw.filled)
            .flat_map(|setup| setup.order.triangles.chunks(CHUNK).map(move |some| (setup, some)))
            .collect();
        let next = AtomicUsize::new(0);
        let fill = |bins: &mut Bins| {
            bins.clear(plan.size);
            while let Some((setup, some)) = work.get(next.fetch_add(1, Ordering::Relaxed)) {
                setup.run(level, some, &plan.pipelines, bins);
            }
        };
        match &mut self.bins[..] {
            [one] => fill(one),
            all => all.par_iter_mut().with_max_len(1).for_each(fill),
        }
    }

    /// The bins of all threads.
    pub(super) fn bins(&self) -> &[Bins] {
        &self.bins
    }

    /// Whether nothing reaches into a tile.
    pub(super) fn is_empty(&self, tile: usize) -> bool {
        self.bins.iter().chain([&self.line_bins]).all(|bins| bins.tiles[tile].is_empty())
    }

    /// The triangle that alone reaches into a tile, where there is one and no texture leaves some of
    /// it out.
    pub(super) fn alone(&self, tile: usize) -> Option<&LargeTriangle> {
        let mut alone = None;
        if !self.line_bins.tiles[tile].is_empty() {
            return None;
        }
        for bins in self.bins.iter().filter(|bins| !bins.tiles[tile].is_empty()) {
            let large = bins.tiles[tile].alone().map(|number| &bins.large[number as usize])?;
            if large.cutout || alone.replace(large).is_some() {
                return None;
            }
        }
        alone
    }

    /// The draw that a triangle belongs to, and where its numbers begin.
    #[inline(always)]
    pub(super) fn draw_of(&self, triangle: u32) -> (u32, Start) {
        let draw = self.starts.partition_point(|start| start.end <= triangle);
        (number(draw), self.starts[draw])
    }

    /// The vertices of a draw, in the order in which its mesh is drawn.
    #[inline(always)]
    pub(super) fn vertices_of(&self, plan: &FramePlan, draw: u32) -> &[ScreenVertex] {
        let count = plan.draws[draw as usize].model.mesh.draw_order().x.len();
        &self.vertices[self.starts[draw as usize].vertex..][..count]
    }

    /// How many triangles of the frame face the observer and may cover a pixel.
    pub(super) fn triangles(&self) -> usize {
        self.bins.iter().map(|bins| bins.drawn).sum()
    }
}

fn number(i: usize) -> u32 {
    u32::try_from(i).expect("fewer than 2^32 primitives")
}
