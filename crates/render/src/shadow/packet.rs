//! The size of a packet of rays.

/// The largest number of rays in a packet: each has a bit in a mask of 64.
pub(crate) const POINTS: usize = 64;
