//! Colours blocks that transparent triangles reach: first what is opaque, then layer by layer from
//! far to near.
//!
//! Every layer is shaded as any block is, so all that surfaces can have works alike on transparent
//! ones. With four samples per pixel, each sample has layers of its own; samples that show the same
//! triangles in the same order throughout a block are coloured once.

use crate::simd::dispatch;
use fearless_simd::Level;

use super::blend::{Blend, Way};
use super::colors::Sums;
use super::context::ShadingContext;
use super::interpolated::ShadingNumber;
use super::resolve::add_other;
use super::surface::{Out, Shader};
use crate::frame::{Eye, FramePlan};
use crate::raster::depth_format;
use crate::raster::entries::key;
use crate::raster::layers::Layers;
use crate::raster::tile::Visibility;
use crate::raster::visibility_buffer::{Visible, seen};
use crate::screen::tiles::BLOCK_PIXELS;
use marraztu_core::accuracy::Transparency;

/// The layers of a tile, and the colours of one sample of a block.
#[derive(Debug, Default)]
pub(super) struct Layered {
    pub(super) layers: Layers,
    blend: Blend,
    /// The numbers of all that the sample shows, layer by layer from what is opaque; empty if that
    /// is not known.
    sequence: Vec<u64>,
    /// The same of the sample before.
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
        self.before.clear();
        shader.rays.paints_layers = true;
        for sample in 0..samples {
            let opaque = visibility.entries(level, block, sample);
            let (at, order) = ((block, sample), (frame, plan.transparency));
            self.layers.open();
            let mut more = self.layers.take(level, order, at, &opaque);
            self.note_sequence(plan, samples, &opaque);
            let Self { layers, blend, sequence, before } = self;
            if sequence.is_empty() || sequence != before {
                let mut behind = Sums::new(plan.variants.are_linear());
                shader.add_entries(context, &opaque, corner, &mut behind);
                blend.begin(|place| behind.parts(place), way(plan));
                while more {
                    for i in 0..layers.len() {
                        let row = layers.row(plan.transparency, i);
                        blend.place(level, || distances(level, plan, &row));
                        shader.layer(context, &row, corner, blend);
                    }
                    more = layers.take(level, order, at, &opaque);
                }
            }
            std::mem::swap(sequence, before);
            (0..BLOCK_PIXELS).for_each(|place| sums.add_parts(place, blend.color(place)));
        }
        shader.rays.paints_layers = false;
    }

    /// Notes what a sample shows, if another sample may be compared with it.
    fn note_sequence(&mut self, plan: &FramePlan, samples: usize, opaque: &[u64; BLOCK_PIXELS]) {
        let Self { layers, sequence, .. } = self;
        sequence.clear();
        // The weights of a mean differ from sample to sample.
        if samples > 1 && layers.are_all() && way(plan) == Way::Over {
            let number = |word: &u64| word & u64::from(u32::MAX);
            sequence.extend(opaque.iter().map(number));
            for i in 0..layers.len() {
                sequence.extend(layers.row(plan.transparency, i).iter().map(number));
            }
        }
    }
}

/// How the layers of a frame are blended.
const fn way(plan: &FramePlan) -> Way {
    match plan.transparency {
        Transparency::Weighted => Way::Weighted,
        Transparency::Exact | Transparency::Objects | Transparency::Threshold => Way::Over,
    }
}

/// The distances of words of the visibility buffer along the observer's axis, in view space.
fn distances(level: Level, plan: &FramePlan, words: &[u64; BLOCK_PIXELS]) -> [f64; BLOCK_PIXELS] {
    let format = plan.variants.depth;
    let mut depths = [0.0; BLOCK_PIXELS];
    for (depth, word) in depths.iter_mut().zip(words) {
        *depth = f64::from(depth_format::depth(format, key(*word)));
    }
    let m = &plan.clip_from_view;
    dispatch!(level, _ => in_view(plan.eye, [m.z_axis.z, m.w_axis.z], &mut depths));
    depths
}

/// Turns depths into distances; zz and zw are entries of the projection.
#[inline(always)]
fn in_view(eye: Eye, [zz, zw]: [f64; 2], depths: &mut [f64; BLOCK_PIXELS]) {
    match eye {
        Eye::Point => depths.iter_mut().for_each(|depth| *depth = zw / (*depth + zz)),
        Eye::Parallel => depths.iter_mut().for_each(|depth| *depth = (zw - *depth) / zz),
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
        let shown = self.fragments.list(context.level, entries, corner);
        if shown.triangles != 0 {
            self.share_evenly(context);
            self.color_fragments(context, corner, &mut Out::Sums(sums));
        }
        for (place, word) in entries.iter().enumerate() {
            match seen(*word) {
                Visible::Triangle(_) => {}
                #[expect(clippy::cast_possible_truncation, reason = "the lower half is meant")]
                Visible::Line(_) | Visible::Background => {
                    add_other(context, !(*word as u32), place, 1, sums);
                }
            }
        }
    }

    /// Lays the triangles of some words, none where they are 0, over a block.
    fn layer(
        &mut self,
        context: &ShadingContext<'_, T>,
        words: &[u64; BLOCK_PIXELS],
        corner: [i32; 2],
        blend: &mut Blend,
    ) {
        let shown = self.fragments.list(context.level, words, corner);
        if shown.triangles != 0 {
            self.share_evenly(context);
            self.color_fragments(context, corner, &mut Out::Layer(blend));
        }
    }

    /// Gives every fragment one share. With several samples its pixel's centre may lie outside of
    /// its triangle.
    fn share_evenly(&mut self, context: &ShadingContext<'_, T>) {
        const ONE: [i32; BLOCK_PIXELS] = [1; BLOCK_PIXELS];
        if context.frame.sample_positions().are_many() {
            self.fragments.share(&ONE);
        } else {
            self.fragments.shares.fill(1);
        }
    }
}
