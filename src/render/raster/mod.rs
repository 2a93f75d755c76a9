//! Rasterization: from the meshes of a plan to the visibility of each pixel.
//!
//! `geometry` transforms the `vertices` of a frame; threads then set up its `parts`, one piece of
//! `work` after another: `setup` and `edges` put primitives that may be visible into `bins`, and
//! `small` rasterizes small triangles at once, to `hits`. A `tile` then draws its hits, `large`
//! triangles and `lines` with a depth test; the nearest primitive stays in the `visibility_buffer`.
//! `layers` are the transparent triangles in front of it.
//!
//! Beside the defaults stand the variants that the settings can choose: `vertex_variants`,
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
pub(crate) mod layers;
pub(crate) mod lines;
mod medium;
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
