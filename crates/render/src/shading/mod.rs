//! Shading: from the visibility of a tile to its colours in the picture.
//!
//! A `painter` draws tiles; each thread has the memory of a `shader`. For each block, `surface`
//! lists the fragments (`fragments`) from the `runs` of pixels with the same primitive and fetches
//! the attributes of their triangles (`triangle_attributes`). It computes barycentric coordinates
//! (`barycentrics`), interpolates attributes (`interpolate`), lights fragments per pixel, face or
//! vertex (`light`) unless they are in shadow (`shadows`), and multiplies by the surface colour
//! (`surface_maps`). `quantize` converts the result to bytes, and `resolve` averages `samples`
//! (MSAA resolve).
//!
//! Blocks with the same surface are `waiting` for each other and are coloured together. Blocks of
//! triangles of about a pixel are coloured without looking triangles up (`tiny`). Blocks that one
//! triangle covers fully (`blocks`) take all of these steps in one pass without a list
//! (`full_blocks`). Blocks that transparent triangles reach are coloured layer by layer (`layers`),
//! each with its opacity, and combined by alpha blending (`blend`). Surfaces that mirror or refract
//! send out rays (`bounces`, by the formulas of `optics`), and the points that these meet are
//! shaded by the same stages (`hits`). With light per face, `new_faces` lights a tile's triangles
//! once, into a table (`face_colors`).
//!
//! f32 and f64 share all of this (`interpolated`) except the paths without lists, which f32 alone
//! has (`path_number`).

pub(crate) mod barycentrics;
mod blend;
mod blocks;
pub(crate) mod bounces;
mod bumps;
mod clamp_to_triangle;
pub(crate) mod colors;
pub(crate) mod context;
pub(crate) mod explain;
pub(crate) mod face_colors;
pub(crate) mod fragments;
mod full_blocks;
mod hits;
mod interpolate;
pub(crate) mod interpolated;
mod layers;
pub(crate) mod light;
pub(crate) mod light_terms;
mod lit_points;
mod map_rows;
mod map_texels;
mod new_faces;
mod occlusion;
mod optics;
pub(crate) mod painter;
pub(crate) mod path_number;
pub(crate) mod pixel_color;
pub(crate) mod quantize;
mod resolve;
mod runs;
mod samples;
mod shader;
pub(crate) mod shadows;
mod soft_shadows;
pub(crate) mod surface;
mod surface_maps;
pub(crate) mod surroundings;
mod texels;
mod tiny;
mod tiny_triangles;
pub(crate) mod triangle_attributes;
mod waiting;
