//! Shadows: whether a light is seen from the points that it lights.
//!
//! A ray runs from each lit point to the light, and any triangle between the two shades the point.
//! All of it happens in world space: the corners of all triangles are rounded to f64 once, by one
//! function, and from there on every decision is exact. There is no bias:
//!
//! * The triangle that the point lies on is left out.
//! * A triangle shades a point only if point and light lie strictly on different sides of its
//!   plane, so nothing shades a point in its own plane, and no light is shaded by what it lies on.
//! * A point is as good as its triangle: if all of that lies on the light's side of another
//!   triangle's plane, the other one does not shade the point, however its position was rounded.
//! * A ray through an edge or a corner meets every triangle that has it, so no ray passes between
//!   the triangles of a closed body.
//!
//! Up to 64 rays to one light are traced together ([`rays`]), those of each patch of a surface by
//! themselves ([`patches`]). Boxes of a mesh beside all of them are passed over ([`shaft`]); those
//! of leaves are tested ray by ray in f32, padded by their error ([`boxes`]). Triangles are
//! prepared eight at a time ([`prepared_block`]), compared with the box of all points, then all
//! eight with each ray, in f64 lanes with an error bound; exact arithmetic decides the rest
//! ([`triangle`]). A sun is a light at 2^60 times the size of the scene: no f64 direction tells the
//! difference.
//!
//! What is known of a light's shadows is kept from frame to frame ([`known`]).
//!
//! In place of rays, settings choose shadow maps ([`maps`]), which are read at the same points.
//!
//! Shewchuk, "Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric Predicates",
//! 1997. Amanatides and Choi, "Ray Tracing Triangular Meshes", 1995, for edges seen from one point.

pub(crate) mod boxes;
pub(crate) mod known;
mod map_bias;
mod map_draws;
pub(crate) mod map_face;
pub(crate) mod maps;
pub(crate) mod packet;
pub(crate) mod patches;
pub(crate) mod prepared_block;
pub(crate) mod rays;
pub(crate) mod shaft;
pub(crate) mod tracer;
pub(crate) mod triangle;
