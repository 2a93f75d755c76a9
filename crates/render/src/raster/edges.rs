//! Line setup: from polygon edges and drawn normals to lines in bins.
//!
//! Sixteen edges are set up at a time. Short ones become hits immediately, the others are added to
//! the tiles they cross. Edges with an end beyond the clipping planes are clipped.

use std::sync::atomic::{AtomicU8, Ordering};

use crate::simd::{Bits, dispatch};
use fearless_simd::{Bytes as _, Level, Simd, SimdBase as _, SimdMask as _, i32x16, mask32x16};
use glam::{DMat3, DVec3};

use super::bins::Bins;
use super::facing::Outline;
use super::hits::PACK;
use super::lines::{self, Ends, LineNumber, SHORT, ScreenLine, Short};
use super::vertices::fetch_vertices;
use crate::accel::DrawEdge;
use crate::frame::draw::{Draw, Lines};
use crate::screen::clip::{Screen, ScreenVertex};
use crate::screen::coverage::{Grid, SUBPIXELS};
use crate::screen::sample_positions::MANY;
use marraztu_core::scene::{Corner, NONE, NormalSource, dvec3};

/// The depth bias: lines are drawn this many steps of depth nearer than the surface below them,
/// against z-fighting.
pub(super) const NEARER: u32 = 2;

/// The inputs of line setup for one draw.
#[derive(Debug)]
pub(crate) struct EdgeSetup<'a> {
    pub(crate) draw: &'a Draw,
    pub(crate) vertices: &'a [ScreenVertex],
    pub(crate) screen: Screen,
    /// The grid of `vertices` and `screen`.
    pub(crate) grid: Grid,
    /// The [`Outline`] of each polygon.
    pub(crate) outlines: &'a [AtomicU8],
    /// The number of the draw's first line in the frame.
    pub(crate) first: u32,
    /// The width of lines, in pixels.
    pub(crate) width: i32,
}

impl EdgeSetup<'_> {
    /// Sets up some of the draw's edges into bins.
    pub(crate) fn run(&self, level: Level, edges: &[DrawEdge], bins: &mut Bins) {
        if bins.sample_positions.are_many() {
            dispatch!(level, simd => self.all::<_, MANY>(simd, edges, bins));
        } else {
            dispatch!(level, simd => self.all::<_, 1>(simd, edges, bins));
        }
    }

    #[inline(always)]
    fn all<S: Simd, const N: usize>(&self, simd: S, edges: &[DrawEdge], bins: &mut Bins) {
        for some in edges.chunks(PACK) {
            let mut last = [some[0]; PACK];
            let sixteen = some.first_chunk().unwrap_or_else(|| {
                last[..some.len()].copy_from_slice(some);
                &last
            });
            self.sixteen::<S, N>(simd, sixteen, some.len(), bins);
        }
    }

    /// Sets up the first `count` of sixteen edges.
    #[inline(always)]
    fn sixteen<S: Simd, const N: usize>(
        &self,
        simd: S,
        edges: &[DrawEdge; PACK],
        count: usize,
        bins: &mut Bins,
    ) {
        // Visibility and colour of each edge. An edge without vertices in draw order is set up
        // singly.
        let mut numbers = [0; PACK];
        let (mut shown, mut odd) = (0_u64, 0_u64);
        for (lane, edge) in edges[..count].iter().enumerate() {
            let outline = outline_of(self.draw, edge, self.outlines);
            shown |= u64::from(outline != Outline::Not) << lane;
            odd |= u64::from(edge.vertices[0] == NONE || edge.vertices[1] == NONE) << lane;
            numbers[lane] = self.number(edge, outline).bits().cast_signed();
        }
        if shown == 0 {
            return;
        }
        // The rest is done in lanes: clipping test, length, and rasterising the short edges.
        let (a, b) = (self.ends(simd, edges, 0), self.ends(simd, edges, 1));
        let beyond = a[0].simd_eq(ScreenVertex::BEYOND) | b[0].simd_eq(ScreenVertex::BEYOND);
        // Lanes without a vertex fetched some other one; they are odd already.
        odd = (odd | beyond.to_bitmask()) & shown;
        shown &= !odd;
        let ([xa, ya, _], [xb, yb, _]) = (a, b);
        // On the fine grid, all lines are stepped through.
        let longest = if self.grid == Grid::Usual { SHORT } else { -1 };
        let short = (xb - xa).abs().simd_le(longest) & (yb - ya).abs().simd_le(longest);
        let some = short & mask32x16::from_bitmask(simd, shown);
        let number = i32x16::from_slice(simd, &numbers).bitcast();
        let samples = bins.sample_positions.count_in::<N>();
        for sample in 0..samples {
            // The lines move instead of the sample, which keeps the arithmetic exact.
            let [x, y] = bins.sample_positions.shift::<N>(sample);
            let seen = [[a[0] - x, a[1] - y, a[2]], [b[0] - x, b[1] - y, b[2]]];
            let (width, nearer) = (self.width, self.nearer());
            let short = Short { some, number, width, nearer, sample: (sample, samples) };
            lines::draw_short(seen[0], seen[1], &short, &mut bins.hits);
        }
        // Long edges go to the tiles they cross, odd ones through clipping first.
        for lane in Bits(shown & !some.to_bitmask()) {
            let ends = edges[lane].vertices.map(|vertex| self.vertices[vertex as usize]);
            self.add(ends, numbers[lane].cast_unsigned(), self.nearer(), bins);
        }
        for lane in Bits(odd) {
            self.add_odd(&edges[lane], numbers[lane].cast_unsigned(), bins);
        }
    }

    #[inline(always)]
    fn ends<S: Simd>(&self, simd: S, edges: &[DrawEdge; PACK], end: usize) -> Ends<S> {
        let [x, y, depth, _] = fetch_vertices(
            simd,
            self.vertices,
            #[inline(always)]
            |lane| edges[lane].vertices[end],
        );
        [x, y, depth]
    }

    #[inline(always)]
    fn number(&self, edge: &DrawEdge, outline: Outline) -> LineNumber {
        LineNumber::new(self.first + edge.number, outline == Outline::Back)
    }

    /// Returns the depth bias of edges, in steps of depth.
    const fn nearer(&self) -> u32 {
        if self.draw.filled { NEARER } else { 0 }
    }

    /// Adds a line of any length.
    fn add(&self, ends: [ScreenVertex; 2], number: u32, nearer: u32, bins: &mut Bins) {
        let width = self.width * SUBPIXELS;
        let line = ScreenLine { ends, number, nearer, grid: self.grid, width, is_point: false };
        bins.add_line(line);
    }

    /// Adds an edge that may need clipping.
    fn add_odd(&self, edge: &DrawEdge, number: u32, bins: &mut Bins) {
        let mesh = &self.draw.model.mesh;
        let ends = mesh.edges()[edge.number as usize].ends;
        // The ends come from the mesh, because some have no position on the screen.
        let ends = ends.map(|end| dvec3(mesh.positions()[end as usize]));
        self.add_segment(ends, number, self.nearer(), bins);
    }

    #[inline(always)]
    fn add_segment(&self, ends: [DVec3; 2], number: u32, nearer: u32, bins: &mut Bins) {
        let clip = ends.map(|end| self.screen.clip(end.to_array()));
        if let Some(ends) = self.screen.segment(clip) {
            self.add(ends, number, nearer, bins);
        }
    }

    /// Sets up some of the draw's normals into bins. `first` is the number of the first one.
    pub(crate) fn add_normals(
        &self,
        level: Level,
        (first, normals): (u32, &[DrawnNormal]),
        bins: &mut Bins,
    ) {
        let view_from_object = DMat3::from_mat4(self.draw.view_from_object);
        let object_from_view = view_from_object.inverse();
        let placed = NormalsInObject { draw: self.draw, view_from_object, object_from_view };
        // Dispatched so rounding uses the processor's instruction, if it has one.
        dispatch!(level, _ => for (number, normal) in (first..).zip(normals) {
            let number = LineNumber::new(number, false);
            self.add_segment(placed.ends(normal), number.bits(), NEARER, bins);
        });
    }
}

/// Returns the outline of an edge: the largest outline of its polygons.
#[inline(always)]
fn outline_of(draw: &Draw, edge: &DrawEdge, outlines: &[AtomicU8]) -> Outline {
    let outline = |polygon: u32| outlines[polygon as usize].load(Ordering::Relaxed);
    let [a, b] = edge.polygons;
    // Edges of one or two polygons store them; others are looked up in the mesh.
    if b != NONE {
        return Outline::of(outline(a).max(outline(b)));
    }
    let mesh = &draw.model.mesh;
    let all = mesh.edge_polygons(&mesh.edges()[edge.number as usize]);
    Outline::of(all.iter().map(|polygon| outline(*polygon)).max().unwrap_or(0))
}

/// Returns the polygon that an edge is drawn for: the first one with the largest outline.
pub(crate) fn polygon_of(draw: &Draw, edge: u32, outlines: &[AtomicU8]) -> Option<u32> {
    let mesh = &draw.model.mesh;
    let all = mesh.edge_polygons(&mesh.edges()[edge as usize]).iter().copied();
    let outline = |polygon: u32| outlines[polygon as usize].load(Ordering::Relaxed);
    all.min_by_key(|polygon| (u8::MAX - outline(*polygon), *polygon))
}

/// A normal drawn as a line.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DrawnNormal {
    /// The polygon the normal belongs to; for a point, its first visible polygon.
    pub(crate) polygon: u32,
    /// The point of a vertex normal, or [`NONE`].
    point: u32,
}

/// Lists the normals of drawn polygons, front-facing or back-facing.
pub(crate) fn list_normals(draw: &Draw, to: &mut Vec<DrawnNormal>) {
    let Lines { face_normals, vertex_normals, .. } = draw.lines;
    if face_normals.is_none() && vertex_normals.is_none() {
        return;
    }
    let mesh = &draw.model.mesh;
    let mut drawn = vec![false; mesh.points().len()];
    let all = 0..u32::try_from(mesh.polygon_count()).expect("polygons have 32-bit numbers");
    for polygon in all.filter(|polygon| draw.shows(*polygon)) {
        if face_normals.is_some() {
            to.push(DrawnNormal { polygon, point: NONE });
        }
        if vertex_normals.is_some() {
            // Each point is listed once, with the first polygon that uses it.
            for corner in mesh.polygon(polygon) {
                let point = point_of(draw, corner);
                if !std::mem::replace(&mut drawn[point as usize], true) {
                    to.push(DrawnNormal { polygon, point });
                }
            }
        }
    }
}

/// Returns the point of a corner with the vertex normals used by the draw.
fn point_of(draw: &Draw, corner: &Corner) -> u32 {
    match draw.normal_source {
        NormalSource::File => corner.filed,
        NormalSource::Computed => corner.smooth,
    }
}

/// The drawn normals of a draw in object space.
struct NormalsInObject<'a> {
    draw: &'a Draw,
    view_from_object: DMat3,
    object_from_view: DMat3,
}

impl NormalsInObject<'_> {
    /// Returns the two ends of a normal.
    #[inline(always)]
    fn ends(&self, normal: &DrawnNormal) -> [DVec3; 2] {
        let DrawnNormal { polygon, point } = *normal;
        let (mesh, lines) = (&self.draw.model.mesh, &self.draw.lines);
        let (from, normal, length) = if point == NONE {
            let normal = mesh.polygon_normals()[polygon as usize];
            (mesh.polygon_centre(polygon), normal, lines.face_normals)
        } else {
            let point = mesh.points()[point as usize];
            let from = dvec3(mesh.positions()[point.position as usize]);
            (from, point.normal, lines.vertex_normals)
        };
        [from, from + self.placed(dvec3(normal), length.unwrap_or(0.0))]
    }

    /// Returns a normal perpendicular to the placed surface. Its length equals that of the
    /// undistorted normal, `length` units of object space, after placement.
    #[inline(always)]
    fn placed(&self, normal: DVec3, length: f64) -> DVec3 {
        let across = self.object_from_view * (self.draw.view_from_normal * normal);
        let along = (self.view_from_object * normal).length();
        // A placement that flattens the object has no inverse: the quotient is not finite then.
        let scale = along / (self.view_from_object * across).length();
        if scale.is_finite() { across * (scale * length) } else { normal * length }
    }
}
