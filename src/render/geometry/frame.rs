//! A frame on the screen: its vertices, and its triangles and lines in bins.

use std::sync::atomic::{AtomicU8, AtomicUsize, Ordering};

use fearless_simd::Level;
use glam::DMat4;
use rayon::prelude::*;

use super::bins::Bins;
use super::clip::{Screen, ScreenVertex};
use super::coverage::SUBPIXELS;
use super::culling::Culling;
use super::edges::{self, EdgeSetup};
use super::facing::Facing;
use super::lines::LineNumber;
use super::places::Places;
use super::setup::{self, Setup};
use super::vertices;
use crate::base::Shared;
use crate::base::color::Color;
use crate::base::image::Size;
use crate::render::changes::alike_matrices;
use crate::render::plan::{Draw, FramePlan};
use crate::render::stages::{Laps, Stages};
use crate::render::watch::Watch;
use crate::render::ways::Ways;
use crate::scene::{CLUSTER, Model};

/// Triangles, polygons or edges that a thread takes at a time.
const CHUNK: usize = 32 * CLUSTER;

/// Fewer than this are set up by one thread: waking the others would take longer.
const FEW: usize = 4096;

/// Everything of a frame that is on the screen.
#[derive(Debug, Default)]
pub(in crate::render) struct Frame {
    /// The vertices of all draws, in the order in which their meshes are drawn.
    vertices: Vec<ScreenVertex>,
    /// The same in finer parts of a pixel, where triangles have them.
    fine: Vec<ScreenVertex>,
    /// What the vertices of each draw are of; nothing where they have yet to be brought there.
    held: Vec<Option<Held>>,
    starts: Vec<Start>,
    /// For each polygon of the draws whose edges are drawn the number of an
    /// [`Outline`](super::facing::Outline).
    outlines: Vec<AtomicU8>,
    /// The polygons of the normals that are drawn.
    normals: Vec<u32>,
    work: Vec<Work>,
    bins: Vec<Bins>,
    /// Where its pixels are looked at.
    places: Places,
}

/// Where the numbers of a draw begin.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::render) struct Start {
    vertex: usize,
    vertex_end: usize,
    /// The number of its first triangle.
    pub(in crate::render) number: u32,
    /// The number after that of its last.
    pub(in crate::render) end: u32,
    outline: usize,
    /// The number of its first edge among the lines.
    line: u32,
    /// The number of its first normal among the lines.
    normal: u32,
    /// The number after that of its last line.
    line_end: u32,
    /// Where its normals begin among those of all draws.
    normal_place: usize,
}

/// What a thread takes at a time.
#[derive(Clone, Copy, Debug)]
struct Work {
    draw: usize,
    what: What,
    from: usize,
}

#[derive(Clone, Copy, Debug)]
enum What {
    /// Triangles into bins.
    Triangles,
    /// The outlines of polygons that are one triangle each, in the order of drawing.
    Facing,
    /// The outlines of polygons.
    FacingOneByOne,
    /// Edges into bins.
    Edges,
}

/// What the screen vertices of a draw were made of.
#[derive(Debug)]
struct Held {
    model: Shared<Model>,
    clip_from_object: DMat4,
    size: Size,
    ways: Ways,
    shift: [i32; 2],
    vertex: usize,
}

impl Held {
    fn new(draw: &Draw, plan: &FramePlan, vertex: usize) -> Self {
        let FramePlan { size, ways, shift, .. } = *plan;
        let (model, clip_from_object) = (draw.model.clone(), draw.clip_from_object);
        Self { model, clip_from_object, size, ways, shift, vertex }
    }

    fn is_of(&self, draw: &Draw, plan: &FramePlan, vertex: usize) -> bool {
        Shared::same(&self.model, &draw.model)
            && alike_matrices(&self.clip_from_object, &draw.clip_from_object)
            && (self.size, self.ways, self.shift) == (plan.size, plan.ways, plan.shift)
            && self.vertex == vertex
    }
}

impl Frame {
    /// Forgets what it holds.
    pub(in crate::render) fn forget(&mut self) {
        self.held.clear();
    }

    /// Brings everything that the plan draws onto the screen, to be looked at in some places of each
    /// pixel, as long as that is wanted. Vertices that are there already stay. Says how long it took.
    pub(in crate::render) fn build(
        &mut self,
        level: Level,
        plan: &FramePlan,
        places: Places,
        watch: &Watch<'_>,
    ) -> Stages {
        let mut laps = Laps::start();
        self.places = places;
        self.number(plan);
        self.place(level, plan, watch);
        let vertices = laps.lap();
        self.set_up(level, plan, watch);
        let set_up = laps.lap();
        if !watch.is_given_up() {
            self.add_lines(level, plan, watch);
        }
        Stages { vertices, set_up, lines: laps.lap(), ..Stages::default() }
    }

    /// Where the numbers of each draw begin.
    fn number(&mut self, plan: &FramePlan) {
        self.starts.clear();
        let mut start = Start::default();
        let (mut vertex, mut outline) = (0, 0);
        for draw in &plan.draws {
            let mesh = &draw.model.mesh;
            (start.vertex, start.outline) = (vertex, outline);
            start.number = start.end;
            start.end += number(mesh.draw_order().triangles.len());
            vertex += mesh.draw_order().x.len();
            start.vertex_end = vertex;
            outline += if draw.lines.edges { mesh.polygon_count() } else { 0 };
            self.starts.push(start);
        }
        // What is not kept is overwritten from here on, whoever it belonged to.
        self.held.resize_with(plan.draws.len(), || None);
        for ((held, draw), start) in self.held.iter_mut().zip(&plan.draws).zip(&self.starts) {
            *held = held.take().filter(|held| held.is_of(draw, plan, start.vertex));
        }
        self.vertices.resize(vertex, ScreenVertex::default());
        self.outlines.resize_with(outline, AtomicU8::default);
    }

    /// Vertices to the screen, all draws' together.
    fn place(&mut self, level: Level, plan: &FramePlan, watch: &Watch<'_>) {
        let (starts, held) = (&self.starts, &self.held);
        let work = |(i, mut out): (usize, &mut [ScreenVertex])| {
            let mut at = i * CHUNK;
            let mut next = starts.partition_point(|start| start.vertex_end <= at);
            while !out.is_empty() && watch.goes_on() {
                let (draw, start) = (&plan.draws[next], starts[next]);
                let (own, others) = out.split_at_mut(out.len().min(start.vertex_end - at));
                if held[next].is_none() {
                    let screen = Screen::new(draw.clip_from_object, plan.size);
                    let order = draw.model.mesh.draw_order();
                    let first = at - start.vertex;
                    if plan.ways.has_plain_vertices() {
                        vertices::transform(level, &screen, order, first, own);
                    } else {
                        plan.ways.transform(level, &screen, order, first, own);
                    }
                    see_from(own, plan.shift);
                }
                at += own.len();
                (out, next) = (others, next + 1);
            }
        };
        if self.vertices.len() <= FEW {
            self.vertices.chunks_mut(CHUNK).enumerate().for_each(work);
        } else {
            self.vertices.par_chunks_mut(CHUNK).enumerate().for_each(work);
        }
        self.place_finely(plan);
        if watch.is_given_up() {
            return;
        }
        for ((held, draw), start) in self.held.iter_mut().zip(&plan.draws).zip(&self.starts) {
            held.get_or_insert_with(|| Held::new(draw, plan, start.vertex));
        }
    }

    /// Corners in finer parts of a pixel, where that is chosen.
    fn place_finely(&mut self, plan: &FramePlan) {
        self.fine.clear();
        if !plan.ways.has_fine_corners() {
            return;
        }
        self.fine.resize(self.vertices.len(), ScreenVertex::default());
        for (draw, start) in plan.draws.iter().zip(&self.starts) {
            let screen = Screen::new(draw.clip_from_object, plan.size);
            let order = draw.model.mesh.draw_order();
            let own = &mut self.fine[start.vertex..start.vertex_end];
            own.par_chunks_mut(CHUNK).enumerate().for_each(|(i, out)| {
                plan.ways.transform_finely(&screen, order, i * CHUNK, out);
                see_from(out, plan.shift.map(|shift| shift * (plan.ways.parts() / SUBPIXELS)));
            });
        }
    }

    /// Triangles into bins: one set of bins for each thread that takes part. And which polygons face
    /// the observer, for their outlines.
    fn set_up(&mut self, level: Level, plan: &FramePlan, watch: &Watch<'_>) {
        self.work.clear();
        let mut count = 0;
        for (i, draw) in plan.draws.iter().enumerate() {
            let mesh = &draw.model.mesh;
            let triangles = mesh.draw_order().triangles.len();
            if draw.filled {
                count += self.add_work(i, What::Triangles, triangles);
            }
            if draw.lines.edges && mesh.edge_order().triangles {
                count += self.add_work(i, What::Facing, triangles);
            } else if draw.lines.edges {
                count += self.add_work(i, What::FacingOneByOne, mesh.polygon_count());
            }
        }
        let threads = if count < FEW { 1 } else { rayon::current_num_threads() };
        self.bins.resize_with(threads, Bins::default);
        for bins in &mut self.bins {
            bins.clear(plan.size, self.places);
        }
        self.share_out(level, plan, watch);
    }

    /// Lines into bins.
    fn add_lines(&mut self, level: Level, plan: &FramePlan, watch: &Watch<'_>) {
        self.work.clear();
        self.normals.clear();
        let mut next = 0;
        for (i, draw) in plan.draws.iter().enumerate() {
            if !watch.goes_on() {
                return;
            }
            let edges = if draw.lines.edges { draw.model.mesh.edge_order().edges.len() } else { 0 };
            let start = &mut self.starts[i];
            (start.line, start.normal) = (next, next + number(edges));
            start.normal_place = self.normals.len();
            let parts = Parts::new(plan, &self.vertices, &self.starts, &self.outlines);
            let setup = parts.edge_setup(i);
            let first = self.starts[i].normal;
            setup.add_normals(first, &mut self.bins[0], &mut self.normals);
            next = first + number(self.normals.len() - self.starts[i].normal_place);
            self.starts[i].line_end = next;
            self.add_work(i, What::Edges, edges);
        }
        if !self.work.is_empty() {
            self.share_out(level, plan, watch);
        }
    }

    /// Cuts work into chunks; gives back how much it is.
    fn add_work(&mut self, draw: usize, what: What, count: usize) -> usize {
        self.work.extend((0..count).step_by(CHUNK).map(|from| Work { draw, what, from }));
        count
    }

    /// Has all threads do the work, each into its own bins, as long as that is wanted.
    fn share_out(&mut self, level: Level, plan: &FramePlan, watch: &Watch<'_>) {
        let parts = Parts::new(plan, &self.vertices, &self.starts, &self.outlines);
        let (work, next) = (&self.work, AtomicUsize::new(0));
        let run = |bins: &mut Bins| {
            while let Some(work) = work.get(next.fetch_add(1, Ordering::Relaxed)) {
                if !watch.goes_on() {
                    return;
                }
                parts.run(level, work, bins);
            }
            setup::finish(level, bins);
        };
        match &mut self.bins[..] {
            [one] => run(one),
            all => all.par_iter_mut().with_max_len(1).for_each(run),
        }
    }

    /// The bins of all threads.
    pub(in crate::render) fn bins(&self) -> &[Bins] {
        &self.bins
    }

    /// Where its pixels are looked at.
    pub(in crate::render) const fn places(&self) -> Places {
        self.places
    }

    /// Whether nothing reaches into a tile.
    pub(in crate::render) fn is_empty(&self, tile: usize) -> bool {
        self.bins.iter().all(|bins| bins.is_empty(tile))
    }

    /// The draw that a triangle belongs to, and where its numbers begin.
    #[inline(always)]
    pub(in crate::render) fn draw_of(&self, triangle: u32) -> (u32, Start) {
        let draw = self.starts.partition_point(|start| start.end <= triangle);
        (number(draw), self.starts[draw])
    }

    /// The vertices of a draw, in the order in which its mesh is drawn.
    #[inline(always)]
    pub(in crate::render) fn vertices_of(&self, plan: &FramePlan, draw: u32) -> &[ScreenVertex] {
        let count = plan.draws[draw as usize].model.mesh.draw_order().x.len();
        &self.vertices[self.starts[draw as usize].vertex..][..count]
    }

    /// The corners that the triangles of a draw have.
    pub(in crate::render) fn corners_of(&self, plan: &FramePlan, draw: u32) -> &[ScreenVertex] {
        if self.fine.is_empty() {
            return self.vertices_of(plan, draw);
        }
        let Start { vertex, vertex_end, .. } = self.starts[draw as usize];
        &self.fine[vertex..vertex_end]
    }

    /// The colour of a line.
    pub(in crate::render) fn line_color(&self, plan: &FramePlan, line: LineNumber) -> [u8; 4] {
        if line.is_back() {
            return Color::BACK_FACE.opaque();
        }
        plan.draws[self.draw_of_line(line)].lines.color.opaque()
    }

    /// Whether a line is an edge, and not a normal.
    pub(in crate::render) fn is_edge(&self, line: LineNumber) -> bool {
        line.line() < self.starts[self.draw_of_line(line)].normal
    }

    /// The draw of a line, and the polygon that it is drawn for.
    pub(in crate::render) fn line_seen(
        &self,
        plan: &FramePlan,
        line: LineNumber,
    ) -> Option<(u32, u32)> {
        let draw = self.draw_of_line(line);
        let start = self.starts[draw];
        let polygon = match line.line().checked_sub(start.normal) {
            Some(normal) => self.normals[start.normal_place + normal as usize],
            None => {
                let parts = Parts::new(plan, &self.vertices, &self.starts, &self.outlines);
                edges::polygon_of(
                    &plan.draws[draw],
                    line.line() - start.line,
                    parts.outlines_of(draw),
                )?
            }
        };
        Some((number(draw), polygon))
    }

    fn draw_of_line(&self, line: LineNumber) -> usize {
        self.starts.partition_point(|start| start.line_end <= line.line())
    }

    /// How many triangles of the frame face the observer and may cover a pixel.
    pub(in crate::render) fn triangles(&self) -> usize {
        self.bins.iter().map(|bins| bins.drawn).sum()
    }
}

/// What all threads read while they fill their bins.
#[derive(Debug)]
struct Parts<'a> {
    plan: &'a FramePlan,
    vertices: &'a [ScreenVertex],
    starts: &'a [Start],
    outlines: &'a [AtomicU8],
}

impl<'a> Parts<'a> {
    fn new(
        plan: &'a FramePlan,
        vertices: &'a [ScreenVertex],
        starts: &'a [Start],
        outlines: &'a [AtomicU8],
    ) -> Self {
        Self { plan, vertices, starts, outlines }
    }

    fn run(&self, level: Level, work: &Work, bins: &mut Bins) {
        let Work { draw: i, what, from } = *work;
        let draw = &self.plan.draws[i];
        let mesh = &draw.model.mesh;
        let (vertices, size) = (self.vertices_of(i), self.plan.size);
        match what {
            What::Triangles => {
                let pipelines = &self.plan.pipelines;
                let setup = Setup::new(draw, pipelines, vertices, size, self.starts[i].number);
                let setup = setup.seen_from(self.plan.shift);
                let order = mesh.draw_order();
                let triangles = chunk(&order.triangles, from);
                if self.plan.ways.draws_one_by_one() {
                    self.plan.ways.set_up(&setup, triangles, pipelines, (size, bins));
                } else if order.clusters.is_empty() {
                    setup.run(level, triangles, pipelines, bins);
                } else {
                    let clusters = &order.clusters[from / CLUSTER..];
                    let culling = Culling::new(draw, setup.screen);
                    culling.each_left(clusters, triangles, |some| {
                        setup.run(level, some, pipelines, bins);
                    });
                }
            }
            What::Facing => {
                let triangles = chunk(&mesh.draw_order().triangles, from);
                let facing = Facing::new(draw, vertices, size);
                facing.of_triangles(level, triangles, self.outlines_of(i));
            }
            What::FacingOneByOne => {
                let facing = Facing::new(draw, vertices, size);
                for polygon in from..(from + CHUNK).min(mesh.polygon_count()) {
                    facing.one(number(polygon), self.outlines_of(i));
                }
            }
            What::Edges => {
                self.edge_setup(i).run(level, chunk(&mesh.edge_order().edges, from), bins);
            }
        }
    }

    fn edge_setup(&self, i: usize) -> EdgeSetup<'a> {
        let plan = self.plan;
        let (draw, first) = (&plan.draws[i], self.starts[i].line);
        let screen = Screen::new(draw.clip_from_object, plan.size).seen_from(plan.shift);
        let (vertices, outlines) = (self.vertices_of(i), self.outlines_of(i));
        EdgeSetup { draw, vertices, screen, outlines, first, width: plan.line_width }
    }

    fn vertices_of(&self, draw: usize) -> &'a [ScreenVertex] {
        let count = self.plan.draws[draw].model.mesh.draw_order().x.len();
        &self.vertices[self.starts[draw].vertex..][..count]
    }

    /// The outlines of a draw whose edges are drawn; none elsewhere.
    fn outlines_of(&self, draw: usize) -> &'a [AtomicU8] {
        let Draw { model, lines, .. } = &self.plan.draws[draw];
        let count = if lines.edges { model.mesh.polygon_count() } else { 0 };
        &self.outlines[self.starts[draw].outline..][..count]
    }
}

/// Moves vertices to where they are seen from a place that is shifted by so many parts of a pixel.
fn see_from(vertices: &mut [ScreenVertex], shift: [i32; 2]) {
    if shift != [0; 2] {
        for vertex in vertices.iter_mut().filter(|vertex| vertex.is_inside()) {
            *vertex = vertex.seen_from(shift);
        }
    }
}

/// Some of a list, from `from` on.
fn chunk<T>(all: &[T], from: usize) -> &[T] {
    &all[from..all.len().min(from + CHUNK)]
}

fn number(i: usize) -> u32 {
    u32::try_from(i).expect("fewer than 2^32 primitives")
}
