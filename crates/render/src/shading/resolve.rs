//! MSAA resolve: from the samples of a block's pixels to the mean of their colours.
//!
//! Most blocks show the same triangle in all samples of each pixel, and cost no more than with one
//! sample. In other blocks a pixel is lit once for each triangle that any of its samples shows: the
//! triangles of the first samples, all pixels together, and in the same batch as many others as
//! fit.

use super::colors::Sums;
use super::context::{ShadingContext, one_group};
use super::interpolated::ShadingNumber;
use super::runs::Shown;
use super::samples::{Kept, Other, Samples};
use super::shader::{Out, Shader};
use crate::raster::visibility_buffer::{BACKGROUND, Visible, seen, seen_number};
use crate::screen::tiles::{BLOCK_PIXELS, pixel_of};
use crate::simd::{BATCH, Bits};

impl<T: ShadingNumber> Shader<T> {
    /// Adds the colours of a block with compared samples and the upper left pixel `corner`. In one
    /// of several passes, colours that earlier passes have `kept` are added first, and only the
    /// others are lit. Returns whether any pixel that is lit here shows more than the background.
    pub(crate) fn add_samples(
        &mut self,
        context: &ShadingContext<'_, T>,
        samples: &mut Samples,
        corner: [i32; 2],
        (sums, mut kept): (&mut Sums, Option<&mut Kept>),
    ) -> bool {
        // The pixels whose first primitive is unlit.
        let unlit = match &kept {
            Some(kept) => samples.add_kept(context.level, kept, sums),
            None => u64::MAX,
        };
        if unlit == 0 && samples.others.is_empty() {
            return false;
        }
        // Pixels lit in earlier passes become empty entries.
        let first = &samples.first;
        let entry = |place: usize| first[place] & (unlit >> place & 1).wrapping_neg();
        let masked = kept.is_some().then(|| std::array::from_fn(entry));
        let entries = masked.as_ref().unwrap_or(first);
        let all = context.frame.sample_positions().shares();
        let mut shown = self.list_first(context, entries, corner);
        if shown.triangles == 0 {
            self.fragments.begin_shared(0, all);
        } else {
            self.fragments.share(&samples.shares, all);
        }
        // Lines and background need no light.
        for place in Bits(unlit & !shown.triangles) {
            let share = samples.shares[place];
            add_other(context, seen(first[place]), (corner, place, share), sums);
        }
        let mut first = self.fragments.len;
        let mut color = |shader: &mut Self, sums: &mut Sums| {
            let mut out = match kept.as_deref_mut() {
                Some(kept) => Out::Kept(sums, kept, std::mem::take(&mut first)),
                None => Out::Sums(sums),
            };
            shader.color_list(context, &mut out);
        };
        // Shadows are traced for at most as many points at once as a mask has bits.
        let are_cast = context.plan.shadows.are_cast();
        let most = if are_cast { BLOCK_PIXELS } else { BATCH };
        // First samples may fill such a mask, so they are coloured separately.
        if are_cast {
            color(self, sums);
        }
        // The primitives of later samples join the list until it is full.
        for Other { place, number, share } in samples.others.iter().copied() {
            if !matches!(seen_number(number), Visible::Triangle(_)) {
                shown.lines |= u64::from(number != BACKGROUND) << place;
                add_other(context, seen_number(number), (corner, place, share), sums);
                continue;
            }
            shown.triangles |= 1 << place;
            if self.fragments.is_full(most) {
                color(self, sums);
            }
            self.fragments.add(number, corner, place, share);
        }
        color(self, sums);
        (shown.triangles | shown.lines) != 0
    }

    /// Adds the colours of a block with one sample of each pixel to the sums.
    pub(crate) fn add_sample(
        &mut self,
        context: &ShadingContext<'_, T>,
        entries: &[u64; BLOCK_PIXELS],
        corner: [i32; 2],
        sums: &mut Sums,
    ) {
        let shown = self.list_first(context, entries, corner);
        for place in Bits(!shown.triangles) {
            add_other(context, seen(entries[place]), (corner, place, 1), sums);
        }
        if shown.triangles != 0 {
            self.fragments.shares = [1; BATCH];
            self.color_fragments(context, &mut Out::Sums(sums));
        }
    }

    /// Lists the pixels of a block that show triangles in their first sample. Triangles of the last
    /// list keep their slots, if that pays.
    fn list_first(
        &mut self,
        context: &ShadingContext<'_, T>,
        entries: &[u64; BLOCK_PIXELS],
        corner: [i32; 2],
    ) -> Shown {
        let most = self.most_slots(context);
        let shown = self.fragments.list(context.level, entries, corner, most);
        if most > 0 && shown.triangles != 0 && one_group(context, &self.fragments).is_none() {
            // Some slots belong to a draw that the block may not show.
            return self.fragments.list(context.level, entries, corner, 0);
        }
        shown
    }

    /// Colours the listed fragments, and begins another list.
    fn color_list(&mut self, context: &ShadingContext<'_, T>, out: &mut Out<'_, '_>) {
        let mut most = 0;
        if self.fragments.len > 0 {
            if let Some(group) = one_group(context, &self.fragments) {
                self.color_group(&group, out);
                // Only a list of one group leaves slots that the next list can reuse.
                most = self.most_slots(context);
            } else {
                self.color_groups(context, out);
            }
        }
        self.fragments.begin_shared(most, context.frame.sample_positions().shares());
    }
}

/// Adds the colour of a line or of the background at a pixel of the block with this upper left
/// pixel.
pub(super) fn add_other<T>(
    context: &ShadingContext<'_, T>,
    visible: Visible,
    (corner, place, share): ([i32; 2], usize, i32),
    sums: &mut Sums,
) {
    let color = match visible {
        Visible::Line(line) => {
            context.frame.line_color(context.plan, line, pixel_of(corner, place))
        }
        Visible::Background | Visible::Triangle(_) => {
            context.plan.behind().at(pixel_of(corner, place))
        }
    };
    sums.add(place, color, share);
}
