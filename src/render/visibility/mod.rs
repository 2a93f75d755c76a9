//! What is seen at each pixel of a tile, from its bins.
//!
//! A `tile` looks at the hits, the `large` triangles and the lines that reach into it; what is nearest
//! at a pixel stays as one of the `words`.

mod large;
pub(super) mod tile;
pub(super) mod words;
