//! Derived data of a mesh, computed on first use.
//!
//! A picture needs only part of this data. Computing and storing all of it would take longer than
//! drawing.

use std::sync::{Mutex, OnceLock, PoisonError};

use glam::DMat4;
use prefetch_index::prefetch_index;
use rayon::prelude::*;

use super::accelerator::AnyAccelerator;
use super::closed::{boundaries, key, key_in_steps};
use super::tangents::CornerTangents;
use crate::base::math::each;
use crate::base::once::get_or_compute;
use crate::scene::mesh::edges::{Edge, Edges};
use crate::scene::mesh::normals::shown_normal;
use crate::scene::mesh::outlines::{Outlines, triangles};
use crate::scene::mesh::{Shape, index};
use crate::scene::{Corner, Mesh, NONE, Triangle};

/// The data for flat shading of one polygon, within a cache line.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(32))]
pub struct Facet {
    /// The mean of the polygon's corners.
    pub centre: [f32; 3],
    /// The polygon's normal; see [`Mesh::polygon_normals`].
    pub normal: [f32; 3],
}

/// The source of vertex normals for lighting.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NormalSource {
    /// The mean of the face normals around each vertex.
    Computed,
    /// The file's normals, for polygons that have them.
    File,
}

/// A kind of data that is derived from a mesh on first use.
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
    /// The tangents of corners, for one kind of normals.
    Tangents(NormalSource),
    /// [`Mesh::edges`] and [`Mesh::edge_polygons`].
    Edges,
}

/// The steps that corners are rounded to, to find the same ones: a part of the mesh's extent.
const WELDED: f64 = 1.0 / (1_u64 << 20) as f64;

/// The derived data that has been computed so far.
#[derive(Default)]
pub(crate) struct Found {
    corners: OnceLock<Vec<Corner>>,
    pub(super) draw_order: AnyAccelerator,
    /// The tangents for computed normals, and for the file's normals.
    pub(super) tangents: [OnceLock<Vec<CornerTangents>>; 2],
}

/// The derived data that does not depend on vertex normals.
#[derive(Default)]
pub(crate) struct FoundOfShape {
    triangles: OnceLock<Vec<Triangle>>,
    normals: OnceLock<Vec<[f32; 3]>>,
    facets: OnceLock<Vec<Facet>>,
    edges: OnceLock<Edges>,
    pub(super) edge_order: AnyAccelerator,
    boundaries: OnceLock<Vec<u64>>,
    welded_boundaries: OnceLock<Vec<u64>>,
    pub(super) bvh: AnyAccelerator,
    /// The last placement with a known radius.
    radius: Mutex<Option<(DMat4, f64)>>,
}

impl Mesh {
    /// Returns the radius of the placed mesh, which `compute` returns: the pictures of a model from
    /// many sides place it in one way.
    pub(crate) fn radius_of(&self, world_from_mesh: DMat4, compute: impl FnOnce() -> f64) -> f64 {
        let mut known = self.shape.found.radius.lock().unwrap_or_else(PoisonError::into_inner);
        match *known {
            Some((placement, radius)) if placement == world_from_mesh => radius,
            _ => known.insert((world_from_mesh, compute())).1,
        }
    }

    /// Returns the corners of all polygons, in the order of the polygons.
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

    /// Returns the triangles of all polygons, in the order of the polygons.
    pub fn triangles(&self) -> &[Triangle] {
        get_or_compute::<Vec<_>>(&self.shape.found.triangles, || triangles(&self.outlines()))
    }

    /// Returns the polygon that a triangle belongs to.
    #[inline(always)]
    pub fn polygon_of(&self, triangle: u32) -> u32 {
        if self.has_triangles_only() {
            return triangle;
        }
        self.triangles()[triangle as usize].polygon
    }

    /// Computes one kind of data now, so it can be read inside
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

    /// Returns whether each polygon is one triangle.
    #[inline(always)]
    const fn has_triangles_only(&self) -> bool {
        self.triangles_only
    }

    /// Returns the number of triangles.
    pub fn triangle_count(&self) -> usize {
        self.shape.corners.len() - 2 * self.polygon_count()
    }

    /// Returns the position of a corner, by its index in [`Self::corners`].
    pub fn corner_position(&self, corner: usize) -> glam::DVec3 {
        super::dvec3(self.shape.positions[self.shape.corners[corner] as usize])
    }

    /// Returns the corners of a triangle, as indices into [`Self::corners`].
    #[inline(always)]
    pub fn triangle(&self, number: usize) -> [usize; 3] {
        if self.has_triangles_only() {
            return [3 * number, 3 * number + 1, 3 * number + 2];
        }
        each(self.triangles()[number].corners, |corner| corner as usize)
    }

    /// Returns the vertex of a corner.
    #[inline(always)]
    pub fn vertex_of(&self, corner: usize) -> u32 {
        self.shape.corners[corner]
    }

    /// The point of a corner, as an index into [`Self::points`]; with a normal of the file if
    /// `source` asks for it and the polygon has one.
    pub fn point_of(&self, corner: usize, source: NormalSource) -> u32 {
        match source {
            NormalSource::Computed => self.corners.smooth(&self.shape.corners, corner),
            NormalSource::File => self.corners.filed(&self.shape.corners, corner),
        }
    }

    /// Whether each vertex has one computed normal, so points are numbered as vertices.
    pub const fn has_smooth_vertices(&self) -> bool {
        self.corners.are_vertices()
    }

    /// Returns the uv coordinates of a triangle's corners; `None` if a corner lacks them.
    #[inline(always)]
    pub fn triangle_uvs(&self, number: u32) -> Option<[[f32; 2]; 3]> {
        self.uvs_at(self.uv_places(number)?)
    }

    /// Prefetches the data that [`Self::uv_places`] reads.
    #[inline(always)]
    pub fn prefetch_uv_places(&self, number: u32) {
        let [first, ..] = self.triangle(number as usize);
        prefetch_index(&self.shape.corner_uvs, first);
    }

    /// Returns the indices of the uv coordinates of a triangle's corners, for [`Self::uvs_at`].
    #[inline(always)]
    pub fn uv_places(&self, number: u32) -> Option<[u32; 3]> {
        let [a, b, c] = self.triangle(number as usize);
        let of = |corner: usize| self.shape.corner_uvs.get(corner).copied();
        Some([of(a)?, of(b)?, of(c)?])
    }

    /// Prefetches the data that [`Self::uvs_at`] reads.
    #[inline(always)]
    pub fn prefetch_uvs(&self, places: [u32; 3]) {
        places.iter().for_each(|place| prefetch_index(&self.shape.uvs, *place as usize));
    }

    /// Returns the uv coordinates at three indices; `None` if a corner lacks them.
    #[inline(always)]
    pub fn uvs_at(&self, [a, b, c]: [u32; 3]) -> Option<[[f32; 2]; 3]> {
        let of = |place: u32| self.shape.uvs.get(place as usize).copied();
        Some([of(a)?, of(b)?, of(c)?])
    }

    /// Returns the colours of a triangle's corners. The mesh must have colours.
    #[inline(always)]
    pub fn triangle_colors(&self, number: u32) -> [[f32; 3]; 3] {
        each(self.triangle(number as usize), |corner| {
            self.shape.colors[self.shape.corners[corner] as usize]
        })
    }

    /// Returns the unit normal of each polygon, by Newell's method; (0, 0, 1) for a polygon without
    /// area.
    pub fn polygon_normals(&self) -> &[[f32; 3]] {
        get_or_compute::<Vec<_>>(&self.shape.found.normals, || {
            let outlines = self.outlines();
            let polygons = 0..self.polygon_count();
            polygons.into_par_iter().map(|i| shown_normal(outlines.normal(i))).collect()
        })
    }

    /// Returns the data for flat shading of each polygon.
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

    /// Returns whether the polygons form closed surfaces: every edge is traversed as often in one
    /// direction as in the other.
    pub fn is_closed(&self) -> bool {
        self.is_closed_without([])
    }

    /// Returns whether the polygons form closed surfaces after these parts are removed.
    pub fn is_closed_without(&self, parts: impl IntoIterator<Item = u32>) -> bool {
        let all = self.boundaries();
        let removed = parts.into_iter().filter_map(|part| all.get(part as usize).copied());
        let sum = all.iter().copied().fold(0, u64::wrapping_add);
        removed.fold(sum, u64::wrapping_sub) == 0
    }

    /// Returns whether the polygons of these parts form closed surfaces together. Corners that
    /// differ by far less than a millionth of the mesh are one: some generators compute the ends
    /// of a seam in two ways.
    pub fn are_parts_closed(&self, parts: &[u32]) -> bool {
        let is_closed = |all: &[u64]| {
            let own = parts.iter().filter_map(|part| all.get(*part as usize));
            own.fold(0, |sum: u64, own| sum.wrapping_add(*own)) == 0
        };
        is_closed(self.boundaries()) || is_closed(self.welded_boundaries())
    }

    /// Returns the sum of the boundaries of each part.
    fn boundaries(&self) -> &[u64] {
        get_or_compute::<Vec<_>>(&self.shape.found.boundaries, || {
            boundaries(&self.outlines(), self.polygon_parts(), self.parts().len(), key)
        })
    }

    /// Returns the same with corners rounded.
    fn welded_boundaries(&self) -> &[u64] {
        get_or_compute::<Vec<_>>(&self.shape.found.welded_boundaries, || {
            let extent = self.bounds().map_or(0.0, |bounds| bounds.extent().max_element());
            let step = (extent * WELDED).max(f64::MIN_POSITIVE);
            let key = |place| key_in_steps(place, step);
            boundaries(&self.outlines(), self.polygon_parts(), self.parts().len(), key)
        })
    }

    /// Returns the edges of the mesh: the sides of all polygons, each listed once.
    pub fn edges(&self) -> &[Edge] {
        self.edge_table().edges()
    }

    /// Returns the polygons that have this edge as a side.
    pub fn edge_polygons(&self, edge: &Edge) -> &[u32] {
        self.edge_table().polygons(edge)
    }

    fn edge_table(&self) -> &Edges {
        get_or_compute(&self.shape.found.edges, || Edges::of(self))
    }

    /// Returns the outlines of all polygons.
    pub(crate) fn outlines(&self) -> Outlines<'_> {
        self.shape.outlines()
    }
}

impl Shape {
    /// Returns the outlines of all polygons.
    pub(crate) fn outlines(&self) -> Outlines<'_> {
        Outlines { places: &self.positions, corners: &self.corners, starts: &self.starts }
    }
}
