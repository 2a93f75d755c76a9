//! From the meshes of a plan to what is visible at each pixel.
//!
//! `geometry` brings the `vertices` of a frame to the screen; threads then set up its `parts`,
//! piece of `work` by piece: `setup` and `edges` put what may be visible into `bins`, what is
//! `small` as `hits`, pixel by pixel, at once. A `tile` then tests the hits, the `large` triangles
//! and the `lines` that reach into it against each other by depth; the nearest stays in the
//! `visibility_buffer`.
//!
//! Beside the defaults stand the variants that settings can choose: `vertex_variants`,
//! `setup_variants`, `coverage_variants`, `depth_format`, and `pixel_by_pixel`, which draws by
//! them.

pub(crate) mod alpha_test;
pub(crate) mod bins;
mod coverage_variants;
mod culling;
pub(crate) mod depth_format;
mod edges;
mod facing;
pub(crate) mod geometry;
mod hits;
mod large;
pub(crate) mod lines;
mod parts;
mod pixel_by_pixel;
mod queue;
mod setup;
mod setup_variants;
mod small;
mod starts;
pub(crate) mod tile;
mod unsnapped;
mod vertex_variants;
pub(crate) mod vertices;
pub(crate) mod visibility_buffer;
mod work;
