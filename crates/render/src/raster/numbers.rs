//! The numbers of primitives.

/// Converts an index to a 32-bit number of the frame or of a draw.
pub(crate) fn number(i: usize) -> u32 {
    u32::try_from(i).expect("fewer than 2^32 primitives")
}
