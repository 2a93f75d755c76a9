//! Samples textures: colours, opacity, and the texture coordinates of triangles.

pub(crate) mod exact_placement;
pub(crate) mod lanes;
pub(crate) mod mips;
pub(crate) mod opacity;
pub(crate) mod placement;
pub(crate) mod sample;
pub(crate) mod uv;
