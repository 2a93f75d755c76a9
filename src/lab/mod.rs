//! What drawing costs in time, what accuracy costs, and what drawing is proved to do: measured, never
//! guessed.

pub mod blame;
pub mod candidates;
pub mod clock;
pub mod cost;
pub mod easel;
pub mod error;
pub mod flip;
pub mod front;
pub mod job;
pub mod kernels;
pub mod pairs;
pub mod prove;
pub mod report;
pub mod statistics;
pub mod sweep;
