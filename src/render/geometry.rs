//! From meshes to triangles and lines on the screen.
//!
//! Placement is composed and applied in f64, once per vertex; clipping is done in homogeneous space,
//! before any division; what is left is snapped to 1/256 of a pixel. From there on, which pixels a
//! triangle covers is a matter of whole numbers.
//!
//! Clipping: Blinn and Newell, "Clipping Using Homogeneous Coordinates", SIGGRAPH 1978; Sutherland
//! and Hodgman, "Reentrant Polygon Clipping", CACM 1974. A cut is computed from the inner end of its
//! edge, so that two triangles which share the edge get the same bits.

use glam::{DVec3, DVec4};

use super::coverage::{SUBPIXELS, Snapped, doubled_area};
use super::plan::{Back, Draw, FramePlan};
use crate::base::image::Size;
use crate::scene::{NONE, dvec3};

/// The guard band: how far from the picture's corner coordinates may be, in pixels.
const GUARD: f64 = 1_048_576.0;

/// A vertex on the screen.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct ScreenVertex {
    /// Its place in the picture.
    pub(super) at: Snapped,
    /// 1 at the near plane, 0 at the far one.
    pub(super) depth: f32,
    /// One by the w of clip space.
    pub(super) inverse_w: f64,
}

/// A triangle, or a piece of one that was cut, on the screen.
#[derive(Clone, Copy, Debug)]
pub(super) struct ScreenTriangle {
    pub(super) corners: [ScreenVertex; 3],
    /// Its draw's place in the plan.
    pub(super) draw: u32,
    /// The triangle of the mesh.
    pub(super) triangle: u32,
    /// Its pipeline's place in the plan.
    pub(super) pipeline: u32,
    /// Where [`Geometry::cuts`] has the corners as parts of the mesh's triangle; [`NONE`] where they
    /// are its own.
    pub(super) cut: u32,
    /// Which side is seen.
    pub(super) side: Side,
}

/// A side of a face.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    Front,
    Back,
}

/// A line on the screen.
#[derive(Clone, Copy, Debug)]
pub(super) struct ScreenLine {
    pub(super) ends: [ScreenVertex; 2],
    /// Its draw's place in the plan.
    pub(super) draw: u32,
    /// The polygon that picking finds.
    pub(super) polygon: u32,
    pub(super) color: [u8; 4],
    /// How many steps of depth it is nearer than it is.
    pub(super) nearer: u32,
}

/// What a frame is made of, on the screen and in view space.
#[derive(Debug, Default)]
pub(super) struct Geometry {
    pub(super) triangles: Vec<ScreenTriangle>,
    pub(super) lines: Vec<ScreenLine>,
    /// The corners of cut triangles as parts of the corners of the mesh's triangle.
    pub(super) cuts: Vec<[DVec3; 3]>,
    /// Where the vertices and the points of each draw begin.
    pub(super) bases: Vec<Base>,
    /// All vertices in view space.
    pub(super) positions: Vec<DVec3>,
    /// The normals of all points in view space, of length 1.
    pub(super) normals: Vec<DVec3>,
    clip: Vec<ClipVertex>,
    facing: Vec<Option<Side>>,
}

/// Where a draw's numbers begin in the lists of [`Geometry`].
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Base {
    pub(super) position: usize,
    pub(super) point: usize,
}

/// A vertex in clip space, with where it lies.
#[derive(Clone, Copy, Debug)]
struct ClipVertex {
    clip: DVec4,
    screen: ScreenVertex,
    /// Bit i: beyond plane i of [`distances`].
    beyond: u8,
    /// Bits for left, right, bottom, top: outside the picture itself.
    outside: u8,
}

/// Beyond everything: a place that is not finite.
const NOWHERE: u8 = 0xff;

/// From clip space to the screen.
#[derive(Clone, Copy, Debug)]
pub(super) struct Screen {
    half: [f64; 2],
    guard: [f64; 2],
}

impl Screen {
    #[expect(clippy::cast_precision_loss, reason = "pictures have fewer than 2^53 pixels a side")]
    pub(super) fn new(size: Size) -> Self {
        let half = [size.width as f64 / 2.0, size.height as f64 / 2.0];
        Self { half, guard: half.map(|half| GUARD / half - 1.0) }
    }

    /// Signed distances to the near plane, the far plane and the four sides of the guard band; not
    /// negative inside.
    fn distances(&self, p: DVec4) -> [f64; 6] {
        let [x, y] = self.guard;
        [p.w - p.z, p.z, x * p.w + p.x, x * p.w - p.x, y * p.w + p.y, y * p.w - p.y]
    }

    /// The place on the screen of a vertex that is beyond none of the planes.
    #[expect(clippy::cast_possible_truncation, reason = "depth is kept as f32")]
    fn vertex(&self, p: DVec4) -> ScreenVertex {
        let inverse_w = 1.0 / p.w;
        let [half_x, half_y] = self.half;
        let x = (p.x * inverse_w + 1.0) * half_x;
        let y = (1.0 - p.y * inverse_w) * half_y;
        let depth = (p.z * inverse_w).clamp(0.0, 1.0) as f32;
        ScreenVertex { at: Snapped { x: snap(x), y: snap(y) }, depth, inverse_w }
    }

    fn clip_vertex(&self, clip: DVec4) -> ClipVertex {
        if !clip.is_finite() {
            let screen = ScreenVertex::default();
            return ClipVertex { clip, screen, beyond: NOWHERE, outside: NOWHERE };
        }
        let bits = |distances: &[f64]| {
            let negative = distances.iter().enumerate().filter(|(_, d)| **d < 0.0);
            negative.fold(0, |bits, (i, _)| bits | 1 << i)
        };
        let beyond = bits(&self.distances(clip));
        let outside = bits(&[clip.w + clip.x, clip.w - clip.x, clip.w + clip.y, clip.w - clip.y]);
        let screen = if beyond == 0 { self.vertex(clip) } else { ScreenVertex::default() };
        ClipVertex { clip, screen, beyond, outside }
    }
}

/// The nearest 1/256 of a pixel.
#[expect(clippy::cast_possible_truncation, reason = "within the guard band: below 2^29")]
fn snap(pixels: f64) -> i32 {
    (pixels * f64::from(SUBPIXELS)).round_ties_even() as i32
}

impl Geometry {
    /// Brings everything that the plan draws onto the screen.
    pub(super) fn build(&mut self, plan: &FramePlan) {
        self.triangles.clear();
        self.lines.clear();
        self.cuts.clear();
        self.bases.clear();
        self.positions.clear();
        self.normals.clear();
        let screen = Screen::new(plan.size);
        for (i, draw) in plan.draws.iter().enumerate() {
            let i = u32::try_from(i).expect("fewer than 2^32 draws");
            self.transform(draw, &screen);
            self.add_triangles(draw, i, &screen);
            super::lines::add(self, draw, i, &screen);
        }
    }

    /// Vertices to clip space and view space, normals to view space.
    fn transform(&mut self, draw: &Draw, screen: &Screen) {
        let mesh = &draw.model.mesh;
        self.bases.push(Base { position: self.positions.len(), point: self.normals.len() });
        self.clip.clear();
        for position in mesh.positions() {
            let p = dvec3(*position);
            self.clip.push(screen.clip_vertex(draw.clip_from_object * p.extend(1.0)));
            self.positions.push(draw.view_from_object.transform_point3(p));
        }
        let turned = |normal: [f32; 3]| {
            let turned = draw.view_from_normal * dvec3(normal);
            crate::base::math::unit(turned).unwrap_or(DVec3::ZERO)
        };
        self.normals.extend(mesh.points().iter().map(|point| turned(point.normal)));
    }

    fn add_triangles(&mut self, draw: &Draw, index: u32, screen: &Screen) {
        let mesh = &draw.model.mesh;
        self.facing.clear();
        self.facing.resize(mesh.polygon_count(), None);
        let all = 0..u32::try_from(mesh.polygon_count()).expect("polygons have 32-bit numbers");
        match &draw.polygons {
            None => all.for_each(|polygon| self.add_polygon(draw, index, polygon, screen)),
            Some(some) => {
                let there = some.iter().copied().filter(|polygon| all.contains(polygon));
                there.for_each(|polygon| self.add_polygon(draw, index, polygon, screen));
            }
        }
    }

    fn add_polygon(&mut self, draw: &Draw, index: u32, polygon: u32, screen: &Screen) {
        let mesh = &draw.model.mesh;
        let part = mesh.polygon_parts()[polygon as usize] as usize;
        let Some(pipeline) = draw.part_pipelines[part] else { return };
        let mut area = 0;
        for i in mesh.triangles_of(polygon) {
            let corners = mesh.triangles()[i].corners;
            let ids = corners.map(|corner| mesh.corners()[corner as usize].position as usize);
            let vertices = ids.map(|id| self.clip[id]);
            let triangle = u32::try_from(i).expect("triangles have 32-bit numbers");
            let template = ScreenTriangle {
                corners: [ScreenVertex::default(); 3],
                draw: index,
                triangle,
                pipeline,
                cut: NONE,
                side: Side::Front,
            };
            area += self.add_triangle(draw, template, vertices, screen);
        }
        self.facing[polygon as usize] = side_of(area, draw.mirrored);
    }

    /// Adds what is seen of a triangle, and gives twice the area of all of it on the screen, in
    /// square parts of a pixel.
    fn add_triangle(
        &mut self,
        draw: &Draw,
        template: ScreenTriangle,
        vertices: [ClipVertex; 3],
        screen: &Screen,
    ) -> i64 {
        let [a, b, c] = vertices;
        if a.beyond & b.beyond & c.beyond != 0 || [a, b, c].iter().any(|v| v.beyond == NOWHERE) {
            return 0;
        }
        if a.beyond | b.beyond | c.beyond == 0 {
            let seen = a.outside & b.outside & c.outside == 0;
            return self.add_piece(draw, template, vertices.map(|v| v.screen), seen);
        }
        let polygon = cut(vertices.map(|v| v.clip), screen);
        let mut area = 0;
        for i in 2..polygon.len() {
            let piece = [polygon[0], polygon[i - 1], polygon[i]];
            let cut = u32::try_from(self.cuts.len()).expect("fewer than 2^32 cuts");
            self.cuts.push(piece.map(|corner| corner.weights));
            let template = ScreenTriangle { cut, ..template };
            area += self.add_piece(draw, template, piece.map(|p| screen.vertex(p.clip)), true);
        }
        area
    }

    fn add_piece(
        &mut self,
        draw: &Draw,
        template: ScreenTriangle,
        corners: [ScreenVertex; 3],
        seen: bool,
    ) -> i64 {
        let area = doubled_area(corners.map(|corner| corner.at));
        let Some(side) = side_of(area, draw.mirrored) else { return area };
        let kept = seen && draw.filled && (side == Side::Front || draw.back != Back::Left);
        if kept {
            self.triangles.push(ScreenTriangle { corners, side, ..template });
        }
        area
    }

    /// Which side of a polygon of the draw last added is seen; `None` where neither is.
    pub(super) fn facing(&self, polygon: u32) -> Option<Side> {
        self.facing[polygon as usize]
    }

    /// The part of a line inside the view and the guard band, on the screen. Its ends are vertices of
    /// the draw last added.
    pub(super) fn edge(&self, ends: [u32; 2], screen: &Screen) -> Option<[ScreenVertex; 2]> {
        segment(ends.map(|end| self.clip[end as usize]), screen)
    }
}

/// The side that is seen of a face with this area on the screen, where y runs down.
const fn side_of(doubled_area: i64, mirrored: bool) -> Option<Side> {
    match (doubled_area, mirrored) {
        (0, _) => None,
        (..0, false) | (1.., true) => Some(Side::Front),
        _ => Some(Side::Back),
    }
}

/// The part of a line between two places of clip space that is inside the view and the guard band.
pub(super) fn line(ends: [DVec4; 2], screen: &Screen) -> Option<[ScreenVertex; 2]> {
    segment(ends.map(|end| screen.clip_vertex(end)), screen)
}

fn segment(ends: [ClipVertex; 2], screen: &Screen) -> Option<[ScreenVertex; 2]> {
    let [mut a, mut b] = ends;
    if a.beyond & b.beyond != 0 || a.outside & b.outside != 0 {
        return None;
    }
    for plane in 0..6 {
        let inner = |v: &ClipVertex| screen.distances(v.clip)[plane];
        let (da, db) = (inner(&a), inner(&b));
        match (da >= 0.0, db >= 0.0) {
            (true, true) => {}
            (true, false) => b = screen.clip_vertex(a.clip + (b.clip - a.clip) * (da / (da - db))),
            (false, true) => a = screen.clip_vertex(b.clip + (a.clip - b.clip) * (db / (db - da))),
            (false, false) => return None,
        }
    }
    Some([screen.vertex(a.clip), screen.vertex(b.clip)])
}

/// A corner of a cut triangle, and the parts that the triangle's own corners have in it.
#[derive(Clone, Copy, Debug)]
struct CutCorner {
    clip: DVec4,
    weights: DVec3,
}

/// What is left of a triangle inside the view and the guard band: a convex polygon.
fn cut(corners: [DVec4; 3], screen: &Screen) -> Vec<CutCorner> {
    let own = [DVec3::X, DVec3::Y, DVec3::Z];
    let mut polygon: Vec<CutCorner> =
        corners.into_iter().zip(own).map(|(clip, weights)| CutCorner { clip, weights }).collect();
    for plane in 0..6 {
        let inner = |corner: &CutCorner| screen.distances(corner.clip)[plane];
        let mut kept = Vec::with_capacity(polygon.len() + 1);
        for (i, to) in polygon.iter().enumerate() {
            let from = &polygon[(i + polygon.len() - 1) % polygon.len()];
            let (df, dt) = (inner(from), inner(to));
            match (df >= 0.0, dt >= 0.0) {
                (true, true) => kept.push(*to),
                (true, false) => kept.push(between(from, to, df / (df - dt))),
                (false, true) => kept.extend([between(to, from, dt / (dt - df)), *to]),
                (false, false) => {}
            }
        }
        polygon = kept;
    }
    polygon
}

/// The corner that lies at the part `t` of the way from the inner end of an edge to the outer one.
fn between(inner: &CutCorner, outer: &CutCorner, t: f64) -> CutCorner {
    CutCorner {
        clip: inner.clip + (outer.clip - inner.clip) * t,
        weights: inner.weights + (outer.weights - inner.weights) * t,
    }
}
