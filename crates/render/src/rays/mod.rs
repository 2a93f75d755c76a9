//! Rays from surfaces to the nearest surface that they meet, for mirrors and refraction.
//!
//! The work is done in view space and in the space of each object, in f64. The edge functions of
//! two triangles that share an edge are the same number with opposite signs, so no ray passes
//! between them. A ray starts at the exact point of its triangle, without an offset:
//!
//! * The triangle that it starts on is left out.
//! * Another triangle is met only if the first one reaches to the side of its plane that the ray
//!   comes from, however the starting point was rounded. Faces in one plane do not meet each
//!   other's rays.
//!
//! Woop, Benthin and Wald, "Watertight Ray/Triangle Intersection", JCGT 2013; Ize, "Robust BVH Ray
//! Traversal", JCGT 2013.

mod nearest;
pub(crate) mod surroundings;

pub(crate) use nearest::{Hit, Ray, RayStack};
