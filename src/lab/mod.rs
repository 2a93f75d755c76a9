//! What drawing costs in time, and what it is proved to do: measured, never guessed.

pub mod cost;
pub mod job;
pub mod prove;
