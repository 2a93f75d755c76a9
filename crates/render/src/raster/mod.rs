//! Rasterisation: from the meshes of a plan to the visibility of each pixel.
//!
//! `geometry` transforms the `vertices` of a frame. Threads then set up its `parts`, one piece of
//! `work` after another: `setup` and `edges` put possibly visible primitives into `bins` (tile
//! binning). `small` rasterises small triangles immediately, to `hits`. With several samples per
//! pixel, they wait for their tile in `tile_queues` instead. A `tile` then draws its hits and
//! queues, `large` triangles and `lines`, all with a depth test: lines are edges, normals, and the
//! `strokes` of models. The nearest primitive stays in the `visibility_buffer`. `layers` are the
//! transparent triangles in front of it.
//!
//! Alternatives selected by the settings are variants of the same kernels: each `rule` of coverage
//! is a type that kernels are compiled for, and the `depth_format` is selected as they run.
//! `vertex_variants` transforms vertices by other arithmetics; `edges_in_floats` and `scan_lines`
//! cover blocks by other rules.

pub(crate) mod alpha_test;
mod beyond;
pub(crate) mod bins;
mod block_triangle;
mod covered;
mod culling;
pub(crate) mod depth_format;
mod edges;
mod edges_in_floats;
pub(crate) mod entries;
mod facing;
pub(crate) mod geometry;
pub(crate) mod hits;
mod hole_tables;
pub(crate) mod inputs;
mod large;
pub(crate) mod layers;
pub(crate) mod lines;
mod medium;
mod numbers;
mod parts;
mod queue;
mod rule;
mod scan_lines;
mod setup;
mod small;
mod small_edges;
pub(crate) mod strokes;
pub(crate) mod tile;
mod tile_queues;
mod vertex_variants;
pub(crate) mod vertices;
pub(crate) mod visibility_buffer;
mod work;
