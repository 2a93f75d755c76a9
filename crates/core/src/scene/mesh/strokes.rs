//! The lines and points of a model: the statements `l` and `p` of an OBJ file.

use glam::DVec3;

use crate::scene::{Mesh, dvec3};

/// A straight line between two vertices, or a point at one. It has a width in pixels and is not
/// lit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stroke {
    /// The vertices at both ends; a point has the same one twice.
    pub ends: [u32; 2],
    /// The part that the stroke belongs to.
    pub part: u32,
}

impl Stroke {
    /// Returns whether the stroke is a point.
    pub const fn is_point(&self) -> bool {
        self.ends[0] == self.ends[1]
    }

    /// Returns whether a stroke goes on where this one ends: both are lines of one polyline.
    pub const fn leads_to(&self, next: &Self) -> bool {
        !self.is_point()
            && !next.is_point()
            && self.ends[1] == next.ends[0]
            && self.part == next.part
    }
}

impl Mesh {
    /// Returns the lines and points, in the order of the file.
    pub fn strokes(&self) -> &[Stroke] {
        &self.shape.strokes
    }

    /// Returns the numbers of lines and of points.
    pub fn stroke_counts(&self) -> [usize; 2] {
        let points = self.strokes().iter().filter(|stroke| stroke.is_point()).count();
        [self.strokes().len() - points, points]
    }

    /// Returns whether the mesh has anything to draw: polygons, lines or points.
    pub fn has_shapes(&self) -> bool {
        self.polygon_count() > 0 || !self.strokes().is_empty()
    }

    /// Returns the positions of a stroke's ends, relative to [`Self::offset`].
    pub fn stroke_ends(&self, stroke: &Stroke) -> [DVec3; 2] {
        stroke.ends.map(|vertex| dvec3(self.shape.positions[vertex as usize]))
    }
}
