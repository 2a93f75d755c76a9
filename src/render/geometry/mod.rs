//! From the meshes of a plan to triangles and lines in the bins of tiles.
//!
//! A `frame` brings the `vertices` to the screen and cuts what reaches beyond it (`clip`); threads then set
//! up its `parts`, piece of `work` by piece: `setup` and `edges` put what may be seen into `bins`, what is
//! `small` as `hits`, pixel by pixel, at once.
//! Which pixels are covered is said by [`coverage`] and `lines`, and where each stands by `tiles`.

pub(super) mod bins;
pub(super) mod clip;
pub mod coverage;
mod culling;
mod edges;
mod facing;
pub(super) mod frame;
mod hits;
pub(super) mod lines;
mod parts;
pub(super) mod places;
pub(super) mod setup;
pub(super) mod small;
pub(super) mod starts;
pub(super) mod tiles;
pub(super) mod vertices;
mod work;
