//! Claims that are proved by trying: on scenes by chance, and against claims that are wrong on purpose.

pub mod absent;
pub mod instructions;
pub mod plan;
pub mod random;
pub mod scenes;
mod shapes;
