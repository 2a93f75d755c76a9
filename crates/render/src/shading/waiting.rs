//! Colours several blocks at once.
//!
//! A block of one surface has up to 64 pixels, and only few at the surface's border. Calls and
//! unfilled lanes then take a part of its time. Blocks of a tile with the same draw and pipeline
//! therefore wait until their pixels fill a batch, and a triangle in several of them is prepared
//! once. Light per pixel takes 0.8 to 0.95 of the time. The bits are the same, because no pixel
//! depends on others of its list.

use std::ops::Range;

use super::context::{ShadingContext, are_of, group_of, one_group};
use super::full_blocks::Canvas;
use super::interpolated::ShadingNumber;
use super::path_number::PathNumber;
use super::runs::{Runs, Shown};
use super::shader::{Out, Shader, Waiting};
use super::tiny::MANY;
use crate::raster::visibility_buffer::{Visible, seen};
use crate::screen::background::Background;
use crate::screen::tiles::{BLOCK, BLOCK_PIXELS, pixel_of};
use crate::simd::Bits;
use crate::simd::gather::most_gathered;

/// The number of triangles above which a block is coloured separately.
const MANY_TRIANGLES: usize = 24;

impl<T: PathNumber> Shader<T> {
    /// Colours a block with the upper left pixel `corner` into a tile, starting at index `at`: at
    /// the latest when [`Shader::finish_waiting`] is called. Background pixels show `fill`; without
    /// one, they are left unchanged. Returns whether any pixel shows more than the
    /// background.
    pub(crate) fn block_later(
        &mut self,
        context: &ShadingContext<'_, T>,
        visibility: &[u64; BLOCK_PIXELS],
        corner: [i32; 2],
        (canvas, at): (&mut Canvas<'_>, usize),
        fill: Option<Background<'_>>,
    ) -> bool {
        let runs = Runs::of(context.level, visibility);
        // Three ways to wait: with tiny triangles, with the blocks already waiting, or as the first
        // one.
        if runs.new_starts().count_ones() >= MANY
            && let group = group_of(context, runs.first_triangle())
            && T::wait_tiny(self, &group, (&runs, corner), (canvas, at))
        {
            put_others(context, (visibility, corner), runs.shown(), (canvas, at), fill);
            return true;
        }
        if !self.waiting.is_empty() {
            if let Some(shown) = self.join(context, &runs, corner, at) {
                put_others(context, (visibility, corner), shown, (canvas, at), fill);
                return shown.triangles | shown.lines != 0;
            }
            // The block does not fit in, so the waiting ones are coloured and it begins a list.
            self.finish_waiting(context, canvas);
        }
        // Triangles that were prepared for the last list may keep their slots.
        let most = self.most_slots(context);
        let shown = self.fragments.list_runs(context.level, &runs, corner, most);
        put_others(context, (visibility, corner), shown, (canvas, at), fill);
        if shown.triangles == 0 {
            return shown.lines != 0;
        }
        match one_group(context, &self.fragments) {
            // The block becomes the first of a list, if more may follow.
            Some(group) if self.has_room() && group.program.joins => {
                self.waiting.push(Waiting { from: 0, at });
            }
            Some(group) => self.color_group(&group, &mut Out::Tile(canvas, at)),
            None => {
                if most > 0 {
                    // Some slots belong to a draw that the block may not show.
                    self.fragments.list(context.level, visibility, corner, 0);
                }
                self.color_fragments(context, &mut Out::Tile(canvas, at));
            }
        }
        true
    }

    /// Colours the waiting blocks.
    pub(crate) fn finish_waiting(
        &mut self,
        context: &ShadingContext<'_, T>,
        canvas: &mut Canvas<'_>,
    ) {
        if !self.waiting.is_empty() {
            let are_tiny = self.fragments.are_tiny();
            // All waiting blocks show one surface, so the first triangle tells the group.
            let first =
                if are_tiny { &self.fragments.each()[0] } else { &self.fragments.numbers[0] };
            let group = group_of(context, *first);
            if are_tiny {
                T::finish_tiny(self, &group, canvas);
            } else {
                self.color_group(&group, &mut Out::Waiting(canvas));
            }
            self.waiting.clear();
        }
    }

    /// Adds a block to the waiting ones, if it shows the same surface and fits.
    fn join(
        &mut self,
        context: &ShadingContext<'_, T>,
        runs: &Runs,
        corner: [i32; 2],
        at: usize,
    ) -> Option<Shown> {
        // With more slots than this, every gather takes longer.
        if !self.fragments.have_room(runs, most_gathered(context.level)) {
            return None;
        }
        let (len, count) = (self.fragments.len, self.fragments.count);
        let shown = self.fragments.list_more(context.level, runs, corner);
        let group = group_of(context, self.fragments.numbers[0]);
        if !are_of(&group, &self.fragments.numbers[count..self.fragments.count]) {
            // The block shows another surface: its fragments are removed again.
            self.fragments.take_back(len, count);
            return None;
        }
        // A block without triangles gets its lines and background from `put_others`.
        if shown.triangles != 0 {
            self.waiting.push(Waiting { from: len, at });
        }
        Some(shown)
    }

    /// Returns whether another block may fit in the list, which must not have many triangles.
    const fn has_room(&self) -> bool {
        self.fragments.count <= MANY_TRIANGLES
    }
}

impl<T: ShadingNumber> Shader<T> {
    /// Copies the colours into the waiting blocks.
    pub(super) fn copy_waiting(&self, canvas: &mut Canvas<'_>) {
        // The fragments of a block end where the next block begins.
        let ends = self.waiting.iter().skip(1).map(|next| next.from).chain([self.fragments.len]);
        for (Waiting { from, at }, end) in self.waiting.iter().copied().zip(ends) {
            self.copy(canvas, from..end, at);
        }
    }

    /// Copies the colours of some fragments into their block.
    pub(super) fn copy(&self, canvas: &mut Canvas<'_>, range: Range<usize>, at: usize) {
        let Range { start: from, end } = range;
        let colors = &self.colors.pixels[from..end];
        // A block with all pixels is copied row by row.
        if let Some(all) = colors.first_chunk::<BLOCK_PIXELS>() {
            return canvas.put(at, all);
        }
        for (i, color) in self.fragments.pixels[from..end].iter().zip(colors) {
            let offset = canvas.offset(in_block(usize::from(*i)));
            canvas.pixels[at + offset] = color.to_le_bytes();
        }
    }
}

/// Colours the pixels of a block without a triangle, like [`Shader::block_later`].
#[inline(always)]
fn put_others<T>(
    context: &ShadingContext<'_, T>,
    (visibility, corner): (&[u64; BLOCK_PIXELS], [i32; 2]),
    shown: Shown,
    (canvas, at): (&mut Canvas<'_>, usize),
    fill: Option<Background<'_>>,
) {
    // The whole block is filled; its triangles are stored over the background afterwards.
    if let Some(background) = fill
        && (shown.triangles | shown.lines) != u64::MAX
    {
        canvas.fill_behind(at, corner, background);
    }
    // Lines are not lit, so their colours are final.
    for i in Bits(shown.lines) {
        if let Visible::Line(line) = seen(visibility[i]) {
            canvas.pixels[at + canvas.offset(in_block(i))] =
                context.frame.line_color(context.plan, line, pixel_of(corner, i));
        }
    }
}

/// Returns the column and row of pixel `i` of a block.
const fn in_block(i: usize) -> [usize; 2] {
    [i % BLOCK as usize, i / BLOCK as usize]
}
