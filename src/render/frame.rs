//! A frame on the screen: its vertices, and its triangles and lines in bins.

use std::sync::atomic::{AtomicUsize, Ordering};

use fearless_simd::Level;
use rayon::prelude::*;

use glam::DMat4;

use super::bins::Bins;
use super::changes::alike_matrices;
use super::clip::{Screen, ScreenVertex};
use super::lines::{self, ScreenLine};
use super::plan::{Draw, FramePlan};
use super::setup::Setup;
use super::vertices;
use super::watch::Watch;
use crate::base::Shared;
use crate::base::image::Size;
use crate::scene::{DrawTriangle, Model};

/// Triangles that a thread takes at a time.
const CHUNK: usize = 2048;

/// Fewer triangles than this are set up by one thread: waking the others would take longer.
const FEW: usize = 4096;

/// Everything of a frame that is on the screen.
#[derive(Debug, Default)]
pub(super) struct Frame {
    /// The vertices of all draws, in the order in which their meshes are drawn.
    vertices: Vec<ScreenVertex>,
    /// What the vertices of each draw are of; nothing where they have yet to be brought there.
    held: Vec<Option<Held>>,
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

/// What the screen vertices of a draw were made of.
#[derive(Debug)]
struct Held {
    model: Shared<Model>,
    clip_from_object: DMat4,
    size: Size,
    vertex: usize,
}

impl Held {
    fn new(draw: &Draw, size: Size, vertex: usize) -> Self {
        let clip_from_object = draw.clip_from_object;
        Self { model: draw.model.clone(), clip_from_object, size, vertex }
    }

    fn is_of(&self, draw: &Draw, size: Size, vertex: usize) -> bool {
        Shared::same(&self.model, &draw.model)
            && alike_matrices(&self.clip_from_object, &draw.clip_from_object)
            && (self.size, self.vertex) == (size, vertex)
    }
}

impl Frame {
    /// Forgets what it holds.
    pub(super) fn forget(&mut self) {
        self.held.clear();
    }

    /// Brings everything that the plan draws onto the screen, as long as that is wanted. Vertices
    /// that are there already stay.
    pub(super) fn build(&mut self, level: Level, plan: &FramePlan, watch: &Watch<'_>) {
        self.place(level, plan, watch);
        self.set_up(level, plan, watch);
        if watch.is_given_up() {
            return;
        }
        let mut all = std::mem::take(&mut self.lines);
        all.clear();
        self.line_bins.clear(plan.size);
        for (i, draw) in plan.draws.iter().enumerate() {
            if !watch.goes_on() {
                break;
            }
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
    fn place(&mut self, level: Level, plan: &FramePlan, watch: &Watch<'_>) {
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
        // What is not kept is overwritten from here on, whoever it belonged to.
        self.held.resize_with(plan.draws.len(), || None);
        for ((held, draw), start) in self.held.iter_mut().zip(&plan.draws).zip(&self.starts) {
            *held = held.take().filter(|held| held.is_of(draw, plan.size, start.vertex));
        }
        self.vertices.resize(vertex, ScreenVertex::default());
        for ((held, draw), start) in self.held.iter_mut().zip(&plan.draws).zip(&self.starts) {
            if held.is_some() {
                continue;
            }
            if !watch.goes_on() {
                return;
            }
            let order = draw.model.mesh.draw_order();
            let screen = Screen::new(draw.clip_from_object, plan.size);
            let out = &mut self.vertices[start.vertex..][..order.x.len()];
            vertices::transform(level, &screen, order, out);
            *held = Some(Held::new(draw, plan.size, start.vertex));
        }
    }

    /// Triangles into bins: one set of bins for each thread that takes part.
    fn set_up(&mut self, level: Level, plan: &FramePlan, watch: &Watch<'_>) {
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
                if !watch.goes_on() {
                    return;
                }
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
