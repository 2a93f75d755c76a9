//! From clip space to the pixels that a triangle covers: clipping, snapping, coverage.
//!
//! `clip` clips triangles to what the fixed-point grid can hold, divides by w and snaps;
//! [`coverage`] decides with integer edge functions which pixels a triangle covers;
//! `sample_positions` holds the positions of samples in a pixel; `tiles` divides the picture.
//! `weights` and `spans` compute barycentric coordinates, one pixel at a time; `perspective` makes
//! weights of corners from them, for many pixels.

pub(crate) mod clip;
pub mod coverage;
pub(crate) mod perspective;
pub(crate) mod sample_positions;
pub(crate) mod spans;
pub(crate) mod tiles;
pub(crate) mod weights;
