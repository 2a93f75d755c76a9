//! What drawing costs in time, and what accuracy costs: measured, never guessed.

pub mod blame;
pub mod candidates;
pub mod clock;
pub mod easel;
pub mod error;
pub mod flip;
pub mod front;
pub mod job;
pub mod kernels;
pub mod pairs;
pub mod report;
pub mod statistics;
pub mod sweep;
