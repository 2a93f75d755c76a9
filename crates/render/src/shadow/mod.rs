//! Shadows: decides whether a light reaches the points that it lights.
//!
//! A ray runs from each lit point to the light; any triangle between the two shades the point. All
//! work is done in world space. The corners of all triangles are rounded to f64 once, by one
//! function, and every later decision is exact. Shadow acne therefore needs no bias:
//!
//! * The triangle of the point itself is left out.
//! * A triangle shades a point only if point and light lie strictly on different sides of its
//!   plane. Nothing shades a point in its own plane, and no light is shaded by the surface it lies
//!   on.
//! * A point inherits the side of its triangle: if the whole triangle lies on the light's side of
//!   another triangle's plane, the other one does not shade the point, however its position was
//!   rounded.
//! * A ray through an edge or corner meets every triangle that shares it, so no ray passes between
//!   the triangles of a closed body.
//!
//! Up to 64 rays to one light are traced together ([`rays`]), each patch of a surface separately
//! ([`patches`]). Boxes of a mesh's BVH that lie outside the whole packet are skipped ([`shaft`]).
//! Boxes of leaves are tested ray by ray in f32, padded by their error ([`boxes`]). The
//! ray-triangle intersection prepares eight triangles at a time ([`prepared_block`]) and compares
//! them with the box of all points, then all eight with each ray, in f64 lanes with an error bound.
//! Exact arithmetic decides the rest ([`triangle`]). A sun is a light at 2^60 times the size of the
//! scene: no f64 direction can tell the difference.
//!
//! The results are cached from frame to frame ([`known`]).
//!
//! Lights with an extent ([`extents`]) are balls ([`ball_light`]) or the sky, sampled by a sequence
//! of points ([`sequence`]) that differs from point to point. Their rays have no end in common, and
//! are traced one by one; those to a ball among what lies between it and the points of a block.
//!
//! If the settings ask for shadow maps ([`maps`]), these are read at the same points instead of
//! tracing rays.
//!
//! Shewchuk, "Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric Predicates",
//! 1997. Amanatides and Choi, "Ray Tracing Triangular Meshes", 1995, for edges seen from one point.

pub(crate) mod ball_light;
pub(crate) mod boxes;
pub(crate) mod extents;
pub(crate) mod known;
mod map_bias;
mod map_draws;
pub(crate) mod map_face;
pub(crate) mod maps;
pub(crate) mod patches;
pub(crate) mod prepared_block;
pub(crate) mod rays;
pub(crate) mod sequence;
pub(crate) mod shaft;
pub(crate) mod tracer;
pub(crate) mod triangle;
