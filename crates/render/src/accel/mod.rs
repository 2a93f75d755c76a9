//! Structures that are built once for each mesh, so that frames take less time.
//!
//! They are kept in the mesh, which all scenes share: see
//! [`Accelerator`](marraztu_core::scene::Accelerator).

mod accelerated;
mod bvh;
mod clusters;
mod draw_order;
mod edge_order;
mod eight_boxes;
mod slivers;

pub use accelerated::Accelerated;
pub use bvh::{BVH_BLOCK, Bvh, BvhBlock, BvhChild, BvhNode, BvhTriangle};
pub use clusters::{CLUSTER, Cluster, DrawTriangle};
pub use draw_order::{DrawOrder, Points};
pub use edge_order::{DrawEdge, EdgeOrder};
pub use eight_boxes::EightBoxes;
