//! The derived data of a mesh, computed when it is first needed.
//!
//! A picture needs only a part of it; computing and storing the rest would take longer than
//! drawing.

use std::sync::OnceLock;

use prefetch_index::prefetch_index;
use rayon::prelude::*;

use super::accelerator::AnyAccelerator;
use super::closed::is_closed;
use super::tangents::CornerTangents;
use crate::base::math::each;
use crate::base::once::get_or_compute;
use crate::scene::mesh::edges::{Edge, Edges};
use crate::scene::mesh::normals::shown_normal;
use crate::scene::mesh::outlines::{Outlines, triangles};
use crate::scene::mesh::{Shape, index};
use crate::scene::{Corner, Mesh, NONE, Triangle};

/// The data for flat shading of a polygon, in one cache line.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(32))]
pub struct Facet {
    /// The mean of its corners.
    pub centre: [f32; 3],
    /// See [`Mesh::polygon_normals`].
    pub normal: [f32; 3],
}

/// The normals of vertices that light uses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NormalSource {
    /// The means of the normals of the faces around each vertex.
    Computed,
    /// The file's normals, for polygons that have them.
    File,
}

/// A kind of data that is derived from a mesh when it is first needed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Derived {
    /// [`Mesh::corners`].
    Corners,
    /// [`Mesh::triangles`].
    Triangles,
    /// [`Mesh::polygon_of`].
    PolygonOf,
    /// [`Mesh::polygon_normals`].
    PolygonNormals,
    /// [`Mesh::facets`].
    Facets,
    /// The tangents of corners, beside one kind of normals.
    Tangents(NormalSource),
    /// [`Mesh::edges`] and [`Mesh::edge_polygons`].
    Edges,
}

/// The data that has been computed.
#[derive(Default)]
pub(crate) struct Found {
    corners: OnceLock<Vec<Corner>>,
    pub(super) draw_order: AnyAccelerator,
    /// With computed normals, and with those of the file.
    pub(super) tangents: [OnceLock<Vec<CornerTangents>>; 2],
}

/// The data that has been computed and does not depend on the normals of vertices.
#[derive(Default)]
pub(crate) struct FoundOfShape {
    triangles: OnceLock<Vec<Triangle>>,
    normals: OnceLock<Vec<[f32; 3]>>,
    facets: OnceLock<Vec<Facet>>,
    edges: OnceLock<Edges>,
    pub(super) edge_order: AnyAccelerator,
    closed: OnceLock<bool>,
    pub(super) bvh: AnyAccelerator,
}

impl Mesh {
    /// The corners of all polygons, one after the other.
    #[must_use]
    pub fn corners(&self) -> &[Corner] {
        get_or_compute::<Vec<_>>(&self.found.corners, || {
            let vertices = &self.shape.corners;
            let corner = |i: usize| Corner {
                position: vertices[i],
                uv: self.shape.corner_uvs.get(i).copied().unwrap_or(NONE),
                smooth: self.corners.smooth(vertices, i),
                filed: self.corners.filed(vertices, i),
            };
            (0..vertices.len()).into_par_iter().map(corner).collect()
        })
    }

    /// The triangles of all polygons, in the order of the polygons.
    #[must_use]
    pub fn triangles(&self) -> &[Triangle] {
        get_or_compute::<Vec<_>>(&self.shape.found.triangles, || triangles(&self.outlines()))
    }

    /// The polygon that a triangle belongs to.
    #[inline(always)]
    #[must_use]
    pub fn polygon_of(&self, triangle: u32) -> u32 {
        if self.has_triangles_only() {
            return triangle;
        }
        self.triangles()[triangle as usize].polygon
    }

    /// Computes some data of the mesh now, so that it can be read inside
    /// [`without_computing`](crate::base::once::without_computing).
    pub fn prepare(&self, what: Derived) {
        match what {
            Derived::Corners => _ = self.corners(),
            Derived::Triangles => _ = self.triangles(),
            Derived::PolygonOf if self.has_triangles_only() => {}
            Derived::PolygonOf => _ = self.triangles(),
            Derived::PolygonNormals => _ = self.polygon_normals(),
            Derived::Facets => _ = self.facets(),
            Derived::Tangents(source) => _ = self.tangents(source),
            Derived::Edges => _ = self.edge_table(),
        }
    }

    /// Whether each polygon is one triangle.
    #[inline(always)]
    const fn has_triangles_only(&self) -> bool {
        self.triangles_only
    }

    /// The number of triangles.
    #[must_use]
    pub fn triangle_count(&self) -> usize {
        self.shape.corners.len() - 2 * self.polygon_count()
    }

    /// The position of a corner, by its place in [`Self::corners`].
    pub fn corner_position(&self, corner: usize) -> glam::DVec3 {
        super::dvec3(self.shape.positions[self.shape.corners[corner] as usize])
    }

    /// The corners of a triangle, as places in [`Self::corners`].
    #[inline(always)]
    pub fn triangle(&self, number: usize) -> [usize; 3] {
        if self.has_triangles_only() {
            return [3 * number, 3 * number + 1, 3 * number + 2];
        }
        each(self.triangles()[number].corners, |corner| corner as usize)
    }

    /// The vertex of a corner, as an index into [`Self::positions`].
    #[inline(always)]
    #[must_use]
    pub fn vertex_of(&self, corner: usize) -> u32 {
        self.shape.corners[corner]
    }

    /// The point of a corner, as an index into [`Self::points`]; with a normal of the file if
    /// `source` asks for it and the polygon has one.
    #[must_use]
    pub fn point_of(&self, corner: usize, source: NormalSource) -> u32 {
        match source {
            NormalSource::Computed => self.corners.smooth(&self.shape.corners, corner),
            NormalSource::File => self.corners.filed(&self.shape.corners, corner),
        }
    }

    /// Whether each vertex has one computed normal, so points are numbered as vertices.
    #[must_use]
    pub const fn has_smooth_vertices(&self) -> bool {
        self.corners.are_vertices()
    }

    /// The uv coordinates of a triangle's corners; `None` if one has none.
    #[inline(always)]
    #[must_use]
    pub fn triangle_uvs(&self, number: u32) -> Option<[[f32; 2]; 3]> {
        self.uvs_at(self.uv_places(number)?)
    }

    /// Asks the cache for what [`Self::uv_places`] reads.
    #[inline(always)]
    pub fn prefetch_uv_places(&self, number: u32) {
        let [first, ..] = self.triangle(number as usize);
        prefetch_index(&self.shape.corner_uvs, first);
    }

    /// The places of the uv coordinates of a triangle's corners, for [`Self::uvs_at`].
    #[inline(always)]
    pub fn uv_places(&self, number: u32) -> Option<[u32; 3]> {
        let [a, b, c] = self.triangle(number as usize);
        let of = |corner: usize| self.shape.corner_uvs.get(corner).copied();
        Some([of(a)?, of(b)?, of(c)?])
    }

    /// Asks the cache for what [`Self::uvs_at`] reads.
    #[inline(always)]
    pub fn prefetch_uvs(&self, places: [u32; 3]) {
        places.iter().for_each(|place| prefetch_index(&self.shape.uvs, *place as usize));
    }

    /// The uv coordinates at three places; `None` if a place has none.
    #[inline(always)]
    pub fn uvs_at(&self, [a, b, c]: [u32; 3]) -> Option<[[f32; 2]; 3]> {
        let of = |place: u32| self.shape.uvs.get(place as usize).copied();
        Some([of(a)?, of(b)?, of(c)?])
    }

    /// The colours of a triangle's corners, which the mesh must have.
    #[inline(always)]
    #[must_use]
    pub fn triangle_colors(&self, number: u32) -> [[f32; 3]; 3] {
        each(self.triangle(number as usize), |corner| {
            self.shape.colors[self.shape.corners[corner] as usize]
        })
    }

    /// The normal of each polygon by Newell's method, of length 1; (0, 0, 1) for one without area.
    #[must_use]
    pub fn polygon_normals(&self) -> &[[f32; 3]] {
        get_or_compute::<Vec<_>>(&self.shape.found.normals, || {
            let outlines = self.outlines();
            let polygons = 0..self.polygon_count();
            polygons.into_par_iter().map(|i| shown_normal(outlines.normal(i))).collect()
        })
    }

    /// The data for flat shading of each polygon.
    #[must_use]
    pub fn facets(&self) -> &[Facet] {
        get_or_compute::<Vec<_>>(&self.shape.found.facets, || {
            let facet = |(normal, polygon): (&[f32; 3], u32)| Facet {
                centre: self.polygon_centre(polygon).as_vec3().to_array(),
                normal: *normal,
            };
            let polygons = 0..index(self.polygon_count());
            self.polygon_normals().par_iter().zip(polygons).map(facet).collect()
        })
    }

    /// Whether the polygons form closed surfaces: every edge is traversed as often in one direction
    /// as in the other.
    #[must_use]
    pub fn is_closed(&self) -> bool {
        *get_or_compute(&self.shape.found.closed, || is_closed(&self.outlines()))
    }

    /// The sides of all polygons, each once.
    #[must_use]
    pub fn edges(&self) -> &[Edge] {
        self.edge_table().edges()
    }

    /// The polygons that have this edge as a side.
    #[must_use]
    pub fn edge_polygons(&self, edge: &Edge) -> &[u32] {
        self.edge_table().polygons(edge)
    }

    fn edge_table(&self) -> &Edges {
        get_or_compute(&self.shape.found.edges, || Edges::of(self))
    }

    /// The outlines of all polygons.
    pub(crate) fn outlines(&self) -> Outlines<'_> {
        self.shape.outlines()
    }
}

impl Shape {
    /// The outlines of all polygons.
    pub(crate) fn outlines(&self) -> Outlines<'_> {
        Outlines { places: &self.positions, corners: &self.corners, starts: &self.starts }
    }
}
