//! From what is seen in a tile to its colours in the picture.
//!
//! A `painter` has the `surface` list what a block shows (`items`), fetch what is known of the triangles
//! (`faces`), find where pixels lie in them (`located`), mix what their corners carry (`interpolate`),
//! and light them, at pixels or at faces and vertices (`light`), in the colour of the surface itself
//! (`textured`); `finish` makes bytes of it, and `resolve` means of samples. Blocks of one triangle
//! (`blocks`) go through all of it in one pass, without a list (`whole`).

mod blocks;
pub(super) mod colors;
pub(super) mod faces;
pub(super) mod finish;
mod groups;
mod hold;
mod interpolate;
pub(super) mod items;
pub(super) mod light;
pub(super) mod located;
pub(super) mod painter;
mod resolve;
pub(super) mod shines;
pub(super) mod surface;
pub(super) mod texels;
pub(super) mod texture;
mod textured;
mod weights;
mod whole;
