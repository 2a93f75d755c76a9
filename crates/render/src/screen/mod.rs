//! Turns clip space into covered pixels: clipping, snapping, coverage.
//!
//! `clip` clips triangles to the range of the fixed-point grid, divides by w and snaps.
//! [`coverage`] decides with integer edge functions which pixels a triangle covers.
//! `sample_positions` holds the positions of samples in a pixel, and `tiles` the layout of tiles.
//! `weights`, `clipped_weights`, `homogeneous` and `spans` compute barycentric coordinates one
//! pixel at a time; `perspective` turns them into perspective-correct weights for many pixels at
//! once.

pub(crate) mod background;
pub(crate) mod clip;
pub(crate) mod clipped_weights;
pub mod coverage;
pub(crate) mod homogeneous;
pub(crate) mod perspective;
pub(crate) mod sample_positions;
pub(crate) mod tiles;
pub(crate) mod weights;
