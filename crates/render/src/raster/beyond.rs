//! The distance beyond their bounding boxes at which triangles may cover centres, by coverage
//! variant.

use marraztu_core::accuracy::Coverage;

/// Extends the range of sample offsets by the centres that triangles may cover beyond their boxes,
/// in 1/256 pixel.
#[inline(always)]
pub(crate) const fn reach(coverage: Coverage, [least, most]: [[i32; 2]; 2]) -> [[i32; 2]; 2] {
    let by = match coverage {
        Coverage::Exact => 0,
        Coverage::F32Edges => 16,
        // One and a half pixels: corners are rounded to whole pixels, and so are the ends of rows.
        Coverage::ScanLines | Coverage::Points => 384,
    };
    [[least[0] - by, least[1] - by], [most[0] + by, most[1] + by]]
}
