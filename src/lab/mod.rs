//! What drawing costs in time and what accuracy costs, measured, never guessed; and whether this
//! processor draws the listed pictures.

pub mod attribution;
pub mod candidates;
pub mod cost;
pub mod error;
pub mod flip;
pub mod front;
pub mod hash;
pub mod instructions;
pub mod kernels;
pub mod pairs;
pub mod picture_source;
pub mod pictures;
pub mod pixel;
pub mod report;
pub mod statistics;
pub mod suite;
pub mod sweep;
pub mod timing;
