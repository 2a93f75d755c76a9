//! The distance beyond their bounding boxes at which triangles may cover centres, by coverage
//! variant.

use marraztu_core::accuracy::Coverage;

/// Returns how far beyond its bounding box a triangle may cover centres, in 1/256 pixel.
pub(crate) const fn beyond(coverage: Coverage) -> i32 {
    match coverage {
        Coverage::Exact => 0,
        Coverage::F32Edges => 16,
        Coverage::ScanLines | Coverage::Points => 384,
    }
}

/// Extends the range of sample offsets by centres up to `by` beyond a box.
#[inline(always)]
pub(crate) const fn reach([least, most]: [[i32; 2]; 2], by: i32) -> [[i32; 2]; 2] {
    [[least[0] - by, least[1] - by], [most[0] + by, most[1] + by]]
}
