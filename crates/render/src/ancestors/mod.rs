//! The algorithms of the two ancestors that no stage shares.

pub(crate) mod points;
