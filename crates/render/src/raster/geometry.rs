//! The geometry of a frame on the screen: vertices, and triangles and lines in bins.

use crate::accel::Accelerated as _;
use std::ops::Range;
use std::sync::atomic::AtomicU8;
use std::sync::{Mutex, PoisonError};

use fearless_simd::Level;
use glam::DMat4;
use rayon::prelude::*;

use super::bins::Bins;
use super::edges;
use super::inputs::{Inputs, Start};
use super::lines::LineNumber;
use super::numbers::number;
use super::parts::{Parts, share_out};
use super::rule::{Rule as _, with_rule};
use super::strokes;
use super::vertex_variants;
use super::vertices::Vertices;
use super::work::{FEW, FEW_VERTICES, What, WorkList, piece_of};
use crate::cancellation::Cancellation;
use crate::frame::draw::Draw;
use crate::frame::raster_mode::RasterMode;
use crate::frame::{FramePlan, Viewport};
use crate::screen::clip::{Screen, ScreenVertex};
use crate::screen::coverage::Grid;
use crate::screen::sample_positions::SamplePositions;
use crate::timings::{Laps, Timings};
use crate::work_stealing::{WorkStealing, together};
use marraztu_core::accuracy::Transparency;
use marraztu_core::base::Shared;
use marraztu_core::base::color::Color;
use marraztu_core::base::math::same_bits;
use marraztu_core::scene::Model;

/// The geometry of a frame on the screen.
#[derive(Debug, Default)]
pub(crate) struct ScreenGeometry {
    inputs: Inputs,
    /// The inputs that the vertices of each draw were made from; `None` if they must be
    /// transformed.
    held: Vec<Option<Held>>,
    /// The vertices to transform.
    placing: WorkList<()>,
    /// The triangles to set up, and the polygons to find outlines of.
    set_up: WorkList<What>,
    /// The edges and normals to set up.
    lines: WorkList<What>,
    bins: Vec<Bins>,
    /// The samples of the pass.
    sample_positions: SamplePositions,
    /// The position of each draw in the order from far to near, if the frame needs it.
    far_to_near: Vec<u32>,
}

/// The inputs that the screen vertices of a draw were made from.
#[derive(Debug)]
struct Held {
    model: Shared<Model>,
    clip_from_object: DMat4,
    viewport: Viewport,
    mode: RasterMode,
    shift: [i32; 2],
    vertex: usize,
}

impl Held {
    fn new(draw: &Draw, plan: &FramePlan, vertex: usize) -> Self {
        let FramePlan { viewport, shift, .. } = *plan;
        let (model, clip_from_object) = (draw.model.clone(), draw.clip_from_object);
        Self { model, clip_from_object, viewport, mode: plan.raster_mode(), shift, vertex }
    }

    fn is_of(&self, draw: &Draw, plan: &FramePlan, vertex: usize) -> bool {
        Shared::same(&self.model, &draw.model)
            && same_bits(&self.clip_from_object, &draw.clip_from_object)
            && self.viewport == plan.viewport
            && (self.mode, self.shift) == (plan.raster_mode(), plan.shift)
            && self.vertex == vertex
    }
}

impl ScreenGeometry {
    /// Invalidates all vertices.
    pub(crate) fn forget(&mut self) {
        self.held.clear();
    }

    /// Transforms and bins everything that the plan draws, for a pass with these samples, unless
    /// cancelled. Vertices that are still valid are reused. Returns the time taken.
    pub(crate) fn build(
        &mut self,
        level: Level,
        plan: &FramePlan,
        sample_positions: SamplePositions,
        watch: &Cancellation<'_>,
    ) -> Timings {
        let mut laps = Laps::start();
        self.sample_positions = sample_positions;
        self.number(plan);
        self.place(level, plan, watch);
        let vertices = laps.lap();
        self.set_up(level, plan, watch);
        let set_up = laps.lap();
        if !watch.is_given_up() {
            self.add_lines(level, plan, watch);
        }
        Timings { vertices, set_up, lines: laps.lap(), ..Timings::default() }
    }

    /// Assigns the first numbers of each draw.
    fn number(&mut self, plan: &FramePlan) {
        self.inputs.starts.clear();
        let mut start = Start::default();
        let (mut vertex, mut outline) = (0, 0);
        for draw in &plan.draws {
            let mesh = &draw.model.mesh;
            (start.vertex, start.outline) = (vertex, outline);
            // At equal depths, the lower number of the earlier draw is in front.
            start.number = start.end;
            start.end += number(mesh.draw_order().triangles.len());
            vertex += mesh.draw_order().x.len();
            start.vertex_end = vertex;
            outline += if draw.lines.edges { mesh.polygon_count() } else { 0 };
            self.inputs.starts.push(start);
        }
        // Only object-wise blending needs an order of draws.
        self.far_to_near.clear();
        if plan.transparency == Transparency::Objects && plan.is_transparent() {
            self.far_to_near = plan.far_to_near();
        }
        // From here on, vertices that are not reused are overwritten.
        self.held.resize_with(plan.draws.len(), || None);
        for ((held, draw), start) in self.held.iter_mut().zip(&plan.draws).zip(&self.inputs.starts)
        {
            *held = held.take().filter(|held| held.is_of(draw, plan, start.vertex));
        }
        self.inputs.vertices.usual.resize(vertex, ScreenVertex::default());
        self.inputs.outlines.resize_with(outline, AtomicU8::default);
    }

    /// Transforms the vertices of all draws in one parallel section.
    fn place(&mut self, level: Level, plan: &FramePlan, watch: &Cancellation<'_>) {
        self.placing.clear();
        for (i, draw) in plan.draws.iter().enumerate().filter(|(i, _)| self.held[*i].is_none()) {
            let order = draw.model.mesh.draw_order();
            let position = |i| order.position(number(i));
            self.placing.add((i, draw), ((), order.x.len()), plan, position);
        }
        // The output slices of all pieces, in the order of adding.
        let (mut rest, mut pieces) = (&mut self.inputs.vertices.usual[..], Vec::new());
        pieces.reserve_exact(self.placing.len());
        for (start, held) in self.inputs.starts.iter().zip(&self.held) {
            let (own, others) = rest.split_at_mut(start.vertex_end - start.vertex);
            rest = others;
            if held.is_none() {
                pieces.extend(own.chunks_mut(piece_of(own.len())).map(Mutex::new));
            }
        }
        // Threads take pieces sorted by position on the screen, so neighbours stay on one core.
        let threads = self.placing.threads(FEW_VERTICES);
        let work = self.placing.sorted();
        let (shares, mode) = (WorkStealing::new(work.len(), threads), plan.raster_mode());
        together(threads, || {
            while let Some(work) = shares.next().map(|i| &work[i]).filter(|_| watch.goes_on()) {
                let draw = &plan.draws[work.draw];
                let screen = Screen::new(draw.clip_from_object, plan.viewport);
                let order = draw.model.mesh.draw_order();
                let out = &mut *pieces[work.place].lock().unwrap_or_else(PoisonError::into_inner);
                vertex_variants::transform(mode, level, &screen, order, work.from, out);
                see_from(out, plan.shift);
            }
        });
        drop(pieces);
        self.place_otherwise(level, plan);
        // The vertices of a cancelled frame are incomplete and must not be reused.
        if watch.is_given_up() {
            return;
        }
        for ((held, draw), start) in self.held.iter_mut().zip(&plan.draws).zip(&self.inputs.starts)
        {
            held.get_or_insert_with(|| Held::new(draw, plan, start.vertex));
        }
    }

    /// Transforms vertices to a finer grid, or to unsnapped pixels, if the settings need them.
    fn place_otherwise(&mut self, level: Level, plan: &FramePlan) {
        let Vertices { usual, fine, unsnapped } = &mut self.inputs.vertices;
        fine.clear();
        unsnapped.clear();
        let mode = plan.raster_mode();
        let is_fine = mode.grid != Grid::Usual;
        if !is_fine && !with_rule!(mode, R => R::UNSNAPPED) {
            return;
        }
        fine.resize(if is_fine { usual.len() } else { 0 }, ScreenVertex::default());
        unsnapped.resize(if is_fine { 0 } else { usual.len() }, [0.0; 2]);
        // Draws are transformed one after the other here, each in parallel pieces.
        for (draw, start) in plan.draws.iter().zip(&self.inputs.starts) {
            let screen = Screen::new(draw.clip_from_object, plan.viewport).on(mode.grid);
            let screen = screen.seen_from(mode.grid.offset(plan.shift));
            let (order, own) = (draw.model.mesh.draw_order(), start.vertex..start.vertex_end);
            let piece = piece_of(own.len());
            if is_fine {
                fine[own].par_chunks_mut(piece).enumerate().for_each(|(i, out)| {
                    let at = i * piece;
                    vertex_variants::transform(mode, level, &screen, order, at, out);
                    see_from(out, mode.grid.offset(plan.shift));
                });
            } else {
                unsnapped[own].par_chunks_mut(piece).enumerate().for_each(|(i, out)| {
                    let at = i * piece;
                    // `to_pixels` subtracts the offset of the sample itself.
                    vertex_variants::to_pixels(mode, level, &screen, order, at, out);
                });
            }
        }
    }

    /// Sets up triangles into bins, one set per thread, and finds the facing of polygons for their
    /// outlines.
    fn set_up(&mut self, level: Level, plan: &FramePlan, watch: &Cancellation<'_>) {
        self.set_up.clear();
        // Lists the work: triangles, then the facing of polygons with edges.
        for (i, draw) in plan.draws.iter().enumerate() {
            let mesh = &draw.model.mesh;
            let triangles = mesh.draw_order().triangles.len();
            let mut add = |what: What, count| {
                let position = |i| what.position(draw, i);
                self.set_up.add((i, draw), (what, count), plan, position);
            };
            if draw.filled {
                add(What::Triangles, triangles);
            }
            if draw.lines.edges && mesh.edge_order().triangles && !draw.culls_opaque {
                add(What::Facing, triangles);
            } else if draw.lines.edges {
                add(What::FacingOneByOne, mesh.polygon_count());
            }
        }
        // Empties one set of bins per thread.
        self.bins.resize_with(self.set_up.threads(FEW), Bins::default);
        for bins in &mut self.bins {
            bins.clear(plan.size, self.sample_positions);
            bins.clear_transparent(plan.size, plan.is_transparent());
        }
        // The tables are computed before the parallel section, which only reads them.
        self.inputs.holes.update(plan);
        let parts = Parts { plan, inputs: &self.inputs };
        share_out(level, self.set_up.sorted(), &parts, &mut self.bins, watch);
    }

    /// Sets up lines into bins.
    fn add_lines(&mut self, level: Level, plan: &FramePlan, watch: &Cancellation<'_>) {
        self.lines.clear();
        self.inputs.normals.clear();
        let mut next = 0;
        for (i, draw) in plan.draws.iter().enumerate() {
            if !watch.goes_on() {
                return;
            }
            let edges = if draw.lines.edges { draw.model.mesh.edge_order().edges.len() } else { 0 };
            // Edges come first, then normals, then strokes: the number of a line tells its kind.
            let start = &mut self.inputs.starts[i];
            (start.line, start.normal) = (next, next + number(edges));
            start.normal_place = self.inputs.normals.len();
            edges::list_normals(draw, &mut self.inputs.normals);
            let normals = &self.inputs.normals[start.normal_place..];
            start.stroke = start.normal + number(normals.len());
            let strokes = draw.strokes.as_ref().map_or(0, |_| draw.model.mesh.strokes().len());
            next = start.stroke + number(strokes);
            start.line_end = next;
            let position = |edge| What::Edges.position(draw, edge);
            self.lines.add((i, draw), (What::Edges, edges), plan, position);
            let position = |i: usize| What::Normals.position(draw, normals[i].polygon as usize);
            self.lines.add((i, draw), (What::Normals, normals.len()), plan, position);
            let position = |stroke| What::Strokes.position(draw, stroke);
            self.lines.add((i, draw), (What::Strokes, strokes), plan, position);
        }
        if self.lines.len() > 0 {
            let parts = Parts { plan, inputs: &self.inputs };
            share_out(level, self.lines.sorted(), &parts, &mut self.bins, watch);
        }
    }

    /// Distributes the tiles of the picture. Each thread mostly draws triangles it has set up.
    pub(crate) fn shares_of_tiles(&self, tiles: usize) -> WorkStealing {
        self.set_up.shares_of_tiles(tiles)
    }

    /// Returns the bins of all threads.
    pub(crate) fn bins(&self) -> &[Bins] {
        &self.bins
    }

    /// Returns the transparent bins of all threads.
    pub(crate) fn transparent_bins(&self) -> impl Iterator<Item = &Bins> {
        self.bins.iter().filter_map(Bins::transparent)
    }

    /// Returns whether a transparent triangle reaches into a tile.
    pub(crate) fn is_layered(&self, tile: usize) -> bool {
        self.transparent_bins().any(|bins| !bins.is_empty(tile))
    }

    /// Returns the samples of the pass.
    pub(crate) const fn sample_positions(&self) -> SamplePositions {
        self.sample_positions
    }

    /// Returns whether no primitive reaches into a tile.
    pub(crate) fn is_empty(&self, tile: usize) -> bool {
        self.bins.iter().all(|bins| bins.is_empty(tile))
    }

    /// Returns the draw of a triangle, and the draw's first numbers.
    #[inline(always)]
    pub(crate) fn draw_of(&self, triangle: u32) -> (u32, Start) {
        self.inputs.draw_of(triangle)
    }

    /// Returns the number after the last triangle's.
    pub(crate) fn triangle_numbers(&self) -> usize {
        self.inputs.starts.last().map_or(0, |start| start.end as usize)
    }

    /// Returns the triangles of a triangle's draw, and the draw's position in the order from far to
    /// near if draws are blended as a whole.
    pub(crate) fn place_of_draw(&self, triangle: u32) -> (Range<u32>, u64) {
        let (draw, start) = self.draw_of(triangle);
        // Positions count from 1, because a layer with the key 0 would count as taken before.
        let place = self.far_to_near.get(draw as usize).map_or(0, |place| u64::from(*place) + 1);
        (start.number..start.end, place)
    }

    /// Returns the corners of a draw's triangles, on the finer grid if there is one.
    pub(crate) fn corners_of(&self, draw: u32) -> &[ScreenVertex] {
        self.inputs.corners_of(draw as usize)
    }

    /// Returns the colour of a line at a pixel.
    pub(crate) fn line_color(
        &self,
        plan: &FramePlan,
        line: LineNumber,
        pixel: [i32; 2],
    ) -> [u8; 4] {
        if line.is_back() {
            return Color::BACK_FACE.opaque();
        }
        let draw = &plan.draws[self.draw_of_line(line)];
        match self.stroke(line) {
            Some(stroke) => strokes::color(plan, draw, stroke, pixel).opaque(),
            None => draw.lines.color.opaque(),
        }
    }

    /// Returns the stroke that a line is, as an index into those of its mesh; `None` for edges and
    /// normals.
    pub(crate) fn stroke(&self, line: LineNumber) -> Option<u32> {
        line.line().checked_sub(self.inputs.starts[self.draw_of_line(line)].stroke)
    }

    /// Returns whether a line is an edge and not a normal.
    pub(crate) fn is_edge(&self, line: LineNumber) -> bool {
        line.line() < self.inputs.starts[self.draw_of_line(line)].normal
    }

    /// Returns the draw of a line, and the polygon it is drawn for; strokes have none.
    pub(crate) fn line_seen(
        &self,
        plan: &FramePlan,
        line: LineNumber,
    ) -> Option<(u32, Option<u32>)> {
        let draw = self.draw_of_line(line);
        let start = self.inputs.starts[draw];
        if self.stroke(line).is_some() {
            return Some((number(draw), None));
        }
        let polygon = match line.line().checked_sub(start.normal) {
            Some(normal) => self.inputs.normals[start.normal_place + normal as usize].polygon,
            None => {
                let outlines = self.inputs.outlines_of(plan, draw);
                edges::polygon_of(&plan.draws[draw], line.line() - start.line, outlines)?
            }
        };
        Some((number(draw), Some(polygon)))
    }

    fn draw_of_line(&self, line: LineNumber) -> usize {
        // Draws without lines have empty ranges, which the search skips.
        self.inputs.starts.partition_point(|start| start.line_end <= line.line())
    }

    /// Returns the number of triangles that face the observer and may cover a pixel.
    pub(crate) fn triangles(&self) -> usize {
        self.bins.iter().map(Bins::triangles).sum()
    }
}

/// Moves vertices relative to a sample with this offset in subpixels.
fn see_from(vertices: &mut [ScreenVertex], shift: [i32; 2]) {
    if shift != [0; 2] {
        // Vertices beyond the clipping planes keep their marker in x.
        for vertex in vertices.iter_mut().filter(|vertex| vertex.is_inside()) {
            *vertex = vertex.seen_from(shift);
        }
    }
}
