//! What drawing costs in time: measured, never guessed.

pub mod job;
