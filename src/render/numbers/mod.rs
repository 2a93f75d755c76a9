//! The numbers that light is computed in, one at a time or sixteen at once.
//!
//! [`real`] says what such a number can do and what takes it from memory, `single` and [`sixteen`] do it in
//! 32 bits, and `pick` takes numbers from short tables.

pub(super) mod pick;
pub mod real;
mod single;
pub mod sixteen;
