//! Colours blocks that transparent triangles reach: first the opaque surface, then layer by layer
//! from far to near.
//!
//! Every layer is shaded like any block, so transparent surfaces support all surface properties.
//! With several samples per pixel, each sample has separate layers. Samples that show the same
//! triangles in the same order throughout a block are coloured once.

use super::blend::Blend;
use super::colors::Sums;
use super::context::ShadingContext;
use super::interpolated::ShadingNumber;
use super::resolve::add_other;
use super::shader::{Out, Shader};
use crate::frame::FramePlan;
use crate::raster::layers::Layers;
use crate::raster::tile::Visibility;
use crate::raster::visibility_buffer::{Visible, seen};
use crate::screen::tiles::BLOCK_PIXELS;

/// The layers of a tile, and the colours of one sample of a block.
#[derive(Debug, Default)]
pub(super) struct Layered {
    pub(super) layers: Layers,
    blend: Blend,
    /// The numbers of the sample's primitives, layer by layer from the opaque one; empty if they
    /// are not known.
    sequence: Vec<u64>,
    /// The sequence of the sample before.
    before: Vec<u64>,
}

impl Layered {
    /// Adds the colours of all samples of a block that transparent triangles touch.
    pub(super) fn add<T: ShadingNumber>(
        &mut self,
        context: &ShadingContext<'_, T>,
        (shader, visibility): (&mut Shader<T>, &mut Visibility),
        (block, corner): (usize, [i32; 2]),
        sums: &mut Sums,
    ) {
        let ShadingContext { level, plan, frame, .. } = *context;
        let samples = frame.sample_positions().count();
        // The last sample of another block must not match the first one here.
        self.before.clear();
        // The layers of a pixel are different points, so shadows are not cached per pixel.
        shader.rays.paints_layers = true;
        for sample in 0..samples {
            let opaque = visibility.entries(level, block, sample);
            let (at, order) = ((block, sample), (frame, plan.transparency));
            self.layers.open();
            let mut more = self.layers.take(level, order, at, &opaque);
            self.note_sequence(plan, samples, &opaque);
            let Self { layers, blend, sequence, before } = self;
            // A sample with the same sequence as the one before has the same colours.
            if sequence.is_empty() || sequence != before {
                // First the opaque surface, then the layers over it from far to near.
                let mut behind = Sums::new(context.mode().is_linear());
                shader.add_entries(context, &opaque, corner, &mut behind);
                blend.begin(|place| behind.parts(place));
                while more {
                    for i in 0..layers.len() {
                        let row = layers.row(plan.transparency, i);
                        shader.color_triangles(context, &row, corner, &mut Out::Layer(blend));
                    }
                    // A pixel with more layers than a list holds is gathered again.
                    more = layers.take(level, order, at, &opaque);
                }
            }
            std::mem::swap(sequence, before);
            (0..BLOCK_PIXELS).for_each(|place| sums.add_parts(place, blend.color(place)));
        }
        shader.rays.paints_layers = false;
    }

    /// Records the primitives of a sample, if another sample may be compared with it.
    fn note_sequence(&mut self, plan: &FramePlan, samples: usize, opaque: &[u64; BLOCK_PIXELS]) {
        let Self { layers, sequence, .. } = self;
        sequence.clear();
        if samples > 1 && layers.are_all() {
            // Depths may differ between samples; only primitives and their order matter.
            let number = |word: &u64| word & u64::from(u32::MAX);
            sequence.extend(opaque.iter().map(number));
            for i in 0..layers.len() {
                sequence.extend(layers.row(plan.transparency, i).iter().map(number));
            }
        }
    }
}

impl<T: ShadingNumber> Shader<T> {
    /// Adds the colours of the opaque entries of a block, each with one share.
    fn add_entries(
        &mut self,
        context: &ShadingContext<'_, T>,
        entries: &[u64; BLOCK_PIXELS],
        corner: [i32; 2],
        sums: &mut Sums,
    ) {
        self.color_triangles(context, entries, corner, &mut Out::Sums(sums));
        // Lines and background are not lit, and are added with their final colours.
        for (place, word) in entries.iter().enumerate() {
            match seen(*word) {
                Visible::Triangle(_) => {}
                other => add_other(context, other, (corner, place, 1), sums),
            }
        }
    }

    /// Colours the triangles of some words of a block, each with one share of its pixel; words of 0
    /// have no triangle.
    fn color_triangles(
        &mut self,
        context: &ShadingContext<'_, T>,
        words: &[u64; BLOCK_PIXELS],
        corner: [i32; 2],
        out: &mut Out<'_, '_>,
    ) {
        if self.fragments.list(context.level, words, corner, 0).triangles == 0 {
            return;
        }
        // With several samples, a pixel's centre may be outside of its triangle.
        let samples = context.frame.sample_positions().shares();
        if samples > 1 {
            self.fragments.share(&[1; BLOCK_PIXELS], samples);
        } else {
            self.fragments.shares.fill(1);
        }
        self.color_fragments(context, out);
    }
}
