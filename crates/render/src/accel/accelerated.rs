//! The accelerators of a mesh by name.

use super::bvh::Bvh;
use super::draw_order::DrawOrder;
use super::edge_order::EdgeOrder;
use marraztu_core::scene::Mesh;

/// The accelerators of a mesh, each built by the first call.
pub trait Accelerated {
    /// The triangles and vertices in the order in which they are drawn fastest.
    fn draw_order(&self) -> &DrawOrder;
    /// Draws the mesh in the order of its file, unless a better one has been computed: for a
    /// program that draws one picture and ends, that is not worth its time.
    fn draw_as_filed(&self);
    /// The edges in the order in which they are drawn fastest.
    fn edge_order(&self) -> &EdgeOrder;
    /// The bounding volume hierarchy in which rays find the triangles that they may meet.
    fn bvh(&self) -> &Bvh;
}

impl Accelerated for Mesh {
    fn draw_order(&self) -> &DrawOrder {
        self.accelerator()
    }

    fn draw_as_filed(&self) {
        self.accelerator_or(|| DrawOrder::as_filed(self));
    }

    fn edge_order(&self) -> &EdgeOrder {
        self.accelerator()
    }

    fn bvh(&self) -> &Bvh {
        self.accelerator()
    }
}
