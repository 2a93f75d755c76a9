//! Single rays from surfaces: to the nearest surface that they meet, for mirrors and refraction,
//! and to a point of a large light, for soft shadows.
//!
//! The work is done in f64, in the space of each object. The edge functions of two triangles that
//! share an edge are the same number with opposite signs, so no ray passes between them. A ray
//! starts at the exact point of its triangle, without an offset:
//!
//! * The triangle that it starts on is left out.
//! * Another triangle is met only if the first one reaches to the side of its plane that the ray
//!   comes from, however the starting point was rounded. Faces in one plane do not meet each
//!   other's rays.
//!
//! Woop, Benthin and Wald, "Watertight Ray/Triangle Intersection", JCGT 2013; Ize, "Robust BVH Ray
//! Traversal", JCGT 2013.

mod frontier;
mod search;
mod things;

use glam::DVec3;

pub(crate) use frontier::{Ends, Frontier};
pub(crate) use search::RayStack;
pub(crate) use things::{Thing, Things};

/// The corners of a triangle.
pub(crate) type Corners = [DVec3; 3];

/// The distance within which triangles lie in one plane, relative to the largest coordinate in
/// object space: files round coordinates to six decimals, and meshes to f32. Doubled faces and
/// decals would shade each other in blotches otherwise.
pub(crate) const FLAT: f64 = 1.0 / (1_u64 << 20) as f64;

/// A ray.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ray {
    pub(crate) from: DVec3,
    /// The direction, of length 1.
    pub(crate) towards: DVec3,
    /// The triangles that the ray starts on, which it does not meet.
    pub(crate) own: Option<OwnTriangles>,
}

/// The triangles that a ray starts on: those of a thing from `first` up to but excluding `end`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OwnTriangles {
    pub(crate) thing: u32,
    pub(crate) first: u32,
    pub(crate) end: u32,
    /// Whether the ray starts on the first triangle, at a rounded point. If not, its start is
    /// exact.
    pub(crate) is_rounded: bool,
}

impl OwnTriangles {
    /// One triangle of a thing, with the ray's start on it.
    pub(crate) const fn one(thing: u32, triangle: u32) -> Self {
        Self { thing, first: triangle, end: triangle + 1, is_rounded: true }
    }
}

/// The point at which a ray meets a surface.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hit {
    /// The index of the thing.
    pub(crate) thing: u32,
    pub(crate) triangle: u32,
    /// The weights of the triangle's corners.
    pub(crate) weights: DVec3,
    /// The distance from the start of the ray.
    pub(crate) distance: f64,
    /// Whether it is the front of the triangle.
    pub(crate) is_front: bool,
}
