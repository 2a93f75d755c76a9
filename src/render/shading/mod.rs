//! From what is visible in a tile to its colours in the picture.
//!
//! A `painter` has the `surface` list the fragments of a block (`fragments`), fetch what is known
//! of their triangles (`triangle_attributes`), find where they lie in them (`barycentrics`),
//! interpolate what the corners carry (`interpolate`), and light them, per pixel, face or vertex
//! (`light`), in the colour of the surface itself (`textured`); `quantize` makes bytes of it, and
//! `resolve` means of samples. Blocks that one triangle covers (`blocks`) go through all of it in
//! one pass, without a list (`full_blocks`).

mod barycentric_variants;
pub(crate) mod barycentrics;
mod blocks;
mod clamp_to_triangle;
pub(crate) mod colors;
pub(crate) mod context;
pub(crate) mod fragments;
mod full_blocks;
mod groups;
mod interpolate;
pub(crate) mod interpolated;
pub(crate) mod light;
pub(crate) mod light_terms;
pub(crate) mod painter;
pub(crate) mod quantize;
mod resolve;
pub(crate) mod rounding;
pub(crate) mod surface;
mod texels;
mod textured;
pub(crate) mod triangle_attributes;
