//! What is seen in a tile, pixel by pixel, by the way of covering and the format of depth that are
//! chosen. Words come out as they do elsewhere, so all that follows goes on as it does.

use super::Ways;
use super::depth::key;
use super::{cover, points};
use crate::render::geometry::bins::Bins;
use crate::render::geometry::coverage::PixelBox;
use crate::render::geometry::frame::Frame;
use crate::render::geometry::lines;
use crate::render::geometry::tiles::pixel_at;
use crate::render::plan::FramePlan;
use crate::render::shading::texels::Holes;
use crate::scene::{Coverage, DepthFormat};

/// How many steps of a format of its own lines are nearer than the surfaces that they lie on.
const LINES_NEARER: u32 = 2;

/// Where a primitive is seen: column and row from the tile's first, what its word has above, its number.
pub(in crate::render) type Put<'a> = &'a mut dyn FnMut([i32; 2], u32, u32);

impl Ways {
    /// Draws everything that reaches into a tile, as a sample of its pixels sees it: the sample's number,
    /// and how many parts of a pixel it lies from the middle.
    pub(in crate::render) fn paint(
        &self,
        plan: &FramePlan,
        frame: &Frame,
        (tile, bounds): (usize, PixelBox),
        sample: (usize, [i32; 2]),
        put: Put<'_>,
    ) {
        for bins in frame.bins() {
            for number in &bins.tiles[tile].large {
                self.triangle(plan, frame, (bins, *number), (bounds, sample.1), put);
            }
            self.lines(plan, bins, (tile, bounds), sample, put);
        }
    }

    fn triangle(
        &self,
        plan: &FramePlan,
        frame: &Frame,
        (bins, number): (&Bins, u32),
        (bounds, shift): (PixelBox, [i32; 2]),
        put: Put<'_>,
    ) {
        let (plain, own) = bins.plain(number);
        let plain = &plain.seen_from(shift, self.parts());
        let clip = own.intersection(bounds);
        let holes = plain.cutout.then(|| Holes::of(plan, frame, plain.number, shift)).flatten();
        let mut take = |x: i32, y: i32, depth: f32| {
            if holes.as_ref().is_none_or(|holes| holes.is_opaque([x, y])) {
                put([x - bounds.left, y - bounds.top], key(self.depth, depth), plain.number);
            }
        };
        match self.coverage {
            Coverage::Exact => cover::exactly(plain, self.parts(), clip, &mut take),
            Coverage::F32Edges => cover::in_32_bits(plain, clip, &mut take),
            Coverage::ScanLines => cover::by_scan_lines(plain, clip, &mut take),
            Coverage::Points => {
                let (draw, start) = frame.draw_of(plain.number);
                let draw = &plan.draws[draw as usize];
                let number = plain.number - start.number;
                let shift = [0, 1].map(|axis| shift[axis] + plan.shift[axis]);
                points::cover(plan, draw, number, (clip, shift), &mut take);
            }
        }
    }

    fn lines(
        &self,
        plan: &FramePlan,
        bins: &Bins,
        (tile, bounds): (usize, PixelBox),
        (sample, shift): (usize, [i32; 2]),
        put: Put<'_>,
    ) {
        let nearer = if self.depth == DepthFormat::F32Reversed { 0 } else { LINES_NEARER };
        let key = |depth: f32| key(self.depth, depth) + nearer;
        let samples = bins.places.count();
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
}
