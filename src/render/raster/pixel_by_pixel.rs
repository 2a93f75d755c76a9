//! Draws a tile pixel by pixel, by the chosen variants of coverage and depth. The visibility buffer
//! has the usual form, so shading is the same as with the defaults.

use super::alpha_test::AlphaTest;
use super::bins::Bins;
use super::depth_format::key;
use super::geometry::ScreenGeometry;
use super::{coverage_variants, lines};
use crate::accuracy::{Coverage, DepthFormat};
use crate::render::frame::FramePlan;
use crate::render::frame::variants::Variants;
use crate::render::reference::points;
use crate::render::screen::coverage::PixelBox;
use crate::render::screen::interpolation::subpixels;
use crate::render::screen::tiles::pixel_at;

/// The depth bias of lines, in steps of a format other than the default.
const LINES_NEARER: u32 = 2;

/// Takes a fragment: column and row in the tile, the key of its depth, and the number of its
/// primitive.
pub(crate) type Put<'a> = &'a mut dyn FnMut([i32; 2], u32, u32);

/// Draws everything that reaches into a tile, for one sample of its pixels, given by number and
/// offset in subpixels.
pub(crate) fn paint(
    variants: Variants,
    plan: &FramePlan,
    frame: &ScreenGeometry,
    (tile, bounds): (usize, PixelBox),
    sample: (usize, [i32; 2]),
    put: Put<'_>,
) {
    for bins in frame.bins() {
        paint_bins(variants, plan, frame, bins, (tile, bounds), sample, put);
    }
}

/// Draws what the bins of one thread hold of a tile.
pub(crate) fn paint_bins(
    variants: Variants,
    plan: &FramePlan,
    frame: &ScreenGeometry,
    bins: &Bins,
    (tile, bounds): (usize, PixelBox),
    sample: (usize, [i32; 2]),
    put: Put<'_>,
) {
    for number in &bins.tiles[tile].large {
        paint_triangle(variants, plan, frame, (bins, *number), (bounds, sample.1), put);
    }
    paint_lines(variants, plan, bins, (tile, bounds), sample, put);
}

fn paint_triangle(
    variants: Variants,
    plan: &FramePlan,
    frame: &ScreenGeometry,
    (bins, number): (&Bins, u32),
    (bounds, shift): (PixelBox, [i32; 2]),
    put: Put<'_>,
) {
    let (plain, own) = bins.plain(number);
    let plain = &plain.seen_from(shift, subpixels(variants));
    let clip = own.intersection(bounds);
    let holes = plain.cutout.then(|| AlphaTest::of(plan, frame, plain.number, shift)).flatten();
    let mut take = |x: i32, y: i32, depth: f32| {
        if holes.as_ref().is_none_or(|holes| holes.is_opaque([x, y])) {
            put([x - bounds.left, y - bounds.top], key(variants.depth, depth), plain.number);
        }
    };
    match variants.coverage {
        Coverage::Exact => coverage_variants::exactly(plain, subpixels(variants), clip, &mut take),
        Coverage::F32Edges => coverage_variants::in_32_bits(plain, clip, &mut take),
        Coverage::ScanLines => coverage_variants::by_scan_lines(plain, clip, &mut take),
        Coverage::Points => {
            let (draw, start) = frame.draw_of(plain.number);
            let draw = &plan.draws[draw as usize];
            let number = plain.number - start.number;
            let shift = [0, 1].map(|axis| shift[axis] + plan.shift[axis]);
            points::cover(plan, draw, number, (clip, shift), &mut take);
        }
    }
}

fn paint_lines(
    variants: Variants,
    plan: &FramePlan,
    bins: &Bins,
    (tile, bounds): (usize, PixelBox),
    (sample, shift): (usize, [i32; 2]),
    put: Put<'_>,
) {
    let nearer = if variants.depth == DepthFormat::F32Reversed { 0 } else { LINES_NEARER };
    let key = |depth: f32| key(variants.depth, depth) + nearer;
    let samples = bins.sample_positions.count();
    bins.hits.each(tile, |place, depth, number| {
        let (at, own) = pixel_at(place as usize, samples);
        if own == sample {
            put(at, key(f32::from_bits(depth)), number);
        }
    });
    for place in &bins.tiles[tile].lines {
        let line = bins.lines[*place as usize].seen_from(shift);
        lines::pixels(&line, plan.line_width, bounds, |x, y, depth| {
            put([x - bounds.left, y - bounds.top], key(depth), line.number);
        });
    }
}
