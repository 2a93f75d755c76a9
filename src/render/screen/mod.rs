//! From clip space to the pixels that a triangle covers.
//!
//! `clip` divides by w and cuts what the fixed-point grid has no room for, [`coverage`] decides in
//! whole numbers which pixels a triangle covers, `sample_positions` says at which positions of a
//! pixel it is asked, and `tiles` divides the picture. `weights` and `interpolation` find where a
//! pixel lies in a triangle, one pixel at a time.

pub(crate) mod clip;
pub mod coverage;
pub(crate) mod interpolation;
pub(crate) mod sample_positions;
pub(crate) mod tiles;
pub(crate) mod weights;
