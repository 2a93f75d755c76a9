//! The lowest floor: mathematics, colours, pictures, shared values, parallel work.

mod byte_bounds;
pub mod color;
pub mod image;
pub mod lists;
pub mod math;
pub mod once;
pub mod rng;
mod shared;
pub mod threads;

pub use byte_bounds::ByteBounds;
pub use shared::Shared;
