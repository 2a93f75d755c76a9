//! Structures that a renderer builds once for each mesh, and keeps with it.
//!
//! The mesh does not know their types. It only has a place for each, so that all scenes that share
//! the mesh share them too.

use std::any::Any;
use std::sync::OnceLock;

use crate::base::once::get_or_compute;
use crate::scene::Mesh;

/// A structure that is built from a mesh.
pub trait Accelerator: Any + Send + Sync {
    /// Its place in the mesh. No other type has the same.
    const PLACE: AcceleratorPlace;
    /// Builds it.
    fn build(mesh: &Mesh) -> Self;
}

/// A place in a mesh for an [`Accelerator`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AcceleratorPlace {
    /// Triangles and vertices in the order in which they are drawn, with normals.
    DrawOrder,
    /// Edges in the order in which they are drawn.
    EdgeOrder,
    /// A bounding volume hierarchy.
    Bvh,
}

/// An accelerator of any type.
pub(super) type AnyAccelerator = OnceLock<Box<dyn Any + Send + Sync>>;

impl Mesh {
    /// An accelerator of this mesh, built by the first call.
    ///
    /// # Panics
    /// If two types claim one place.
    pub fn accelerator<T: Accelerator>(&self) -> &T {
        self.accelerator_or(|| T::build(self))
    }

    /// The same, built in another way if it is not there yet.
    ///
    /// # Panics
    /// If two types claim one place.
    pub fn accelerator_or<T: Accelerator>(&self, build: impl FnOnce() -> T) -> &T {
        let place = match T::PLACE {
            AcceleratorPlace::DrawOrder => &self.found.draw_order,
            AcceleratorPlace::EdgeOrder => &self.shape.found.edge_order,
            AcceleratorPlace::Bvh => &self.shape.found.bvh,
        };
        let any = get_or_compute(place, || Box::new(build()));
        any.downcast_ref().expect("a place has one type")
    }
}
