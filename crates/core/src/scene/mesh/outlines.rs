//! The outlines of polygons, and their triangulation.

use glam::DVec3;
use rayon::prelude::*;

use crate::base::lists::concatenated;
use crate::base::math;
use crate::scene::mesh::index;
use crate::scene::triangulate::Triangulator;
use crate::scene::{NONE, Triangle, dvec3, newell};

/// The number of polygons that a thread takes at a time.
const SHARE: usize = 4096;

/// The corners of all polygons, with one list for each attribute.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct CornerLists {
    /// The vertex of each corner.
    pub positions: Vec<u32>,
    /// The uv of each corner, or [`NONE`]; empty if no corner has uv coordinates.
    pub uvs: Vec<u32>,
    /// The normal of each corner, or [`NONE`]; empty if no corner has a normal.
    pub normals: Vec<u32>,
}

impl CornerLists {
    /// Returns the uv of a corner, or [`NONE`].
    pub fn uv(&self, corner: usize) -> u32 {
        self.uvs.get(corner).copied().unwrap_or(NONE)
    }

    /// Returns the normal of a corner, or [`NONE`].
    pub fn normal(&self, corner: usize) -> u32 {
        self.normals.get(corner).copied().unwrap_or(NONE)
    }
}

/// The outlines of all polygons.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Outlines<'a> {
    pub(crate) places: &'a [[f32; 3]],
    /// The vertices of all corners.
    pub(crate) corners: &'a [u32],
    /// The start of each polygon's corners, and the end of the last polygon's corners.
    pub(crate) starts: &'a [u32],
}

impl<'a> Outlines<'a> {
    /// Returns the vertices of a polygon's corners.
    pub(crate) fn vertices(&self, polygon: usize) -> &'a [u32] {
        &self.corners[self.starts[polygon] as usize..self.starts[polygon + 1] as usize]
    }

    /// Returns the positions of a polygon's corners.
    pub(crate) fn of(&self, polygon: usize) -> impl ExactSizeIterator<Item = DVec3> + Clone + 'a {
        let places = self.places;
        self.vertices(polygon).iter().map(|vertex| dvec3(places[*vertex as usize]))
    }

    /// Returns the unit normal of a polygon by Newell's method; `None` for a polygon without area.
    pub(crate) fn normal(&self, polygon: usize) -> Option<DVec3> {
        math::unit(newell(self.of(polygon)))
    }
}

/// Cuts all polygons into triangles, in the order of the polygons.
pub(crate) fn triangles(outlines: &Outlines<'_>) -> Vec<Triangle> {
    let count = outlines.starts.len() - 1;
    if outlines.corners.len() == 3 * count {
        let own = |polygon: usize| {
            let first = index(3 * polygon);
            Triangle { corners: [first, first + 1, first + 2], polygon: index(polygon) }
        };
        return (0..count).into_par_iter().map(own).collect();
    }
    // Threads take shares of polygons, so each triangulator reuses its memory.
    let share = |share: usize| {
        let mut triangles = Vec::new();
        let mut triangulator = Triangulator::default();
        for polygon in share * SHARE..count.min((share + 1) * SHARE) {
            let begin = outlines.starts[polygon];
            // The normal is not rounded to f32, since its last digits decide how the polygon is
            // cut.
            let normal = outlines.normal(polygon).unwrap_or(DVec3::Z);
            let cut = triangulator.cut(outlines.of(polygon), normal);
            let polygon = index(polygon);
            let own = |own: &[u32; 3]| Triangle { corners: own.map(|i| begin + i), polygon };
            triangles.extend(cut.iter().map(own));
        }
        triangles
    };
    concatenated((0..count.div_ceil(SHARE)).into_par_iter().map(share).collect())
}
