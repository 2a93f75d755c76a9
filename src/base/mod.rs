//! What every floor stands on: mathematics, colours, pictures, shared values.

pub mod color;
pub mod image;
pub mod lists;
pub mod math;
pub mod once;
pub mod rng;
mod shared;

pub use shared::Shared;
