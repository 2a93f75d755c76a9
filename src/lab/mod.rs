//! What drawing costs in time, measured and never guessed; and what is claimed of it, proved.

pub mod cost;
pub mod job;
pub mod proof;
