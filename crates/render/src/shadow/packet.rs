//! The size of a packet of rays.

/// The most rays of a packet: each has a bit in a mask of 64.
pub(crate) const POINTS: usize = 64;
