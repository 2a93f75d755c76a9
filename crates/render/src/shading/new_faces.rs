//! Lights the faces of a tile that are missing in the table of the frame.

use fearless_simd::Simd;
use prefetch_index::prefetch_index;

use super::colors::Form;
use super::context::{Group, ShadingContext, group_of};
use super::face_colors::FaceColors;
use super::interpolated::ShadingNumber;
use super::runs::Runs;
use super::shader::Shader;
use crate::frame::program::WholePath;
use crate::raster::tile::Visibility;
use crate::screen::tiles::{BLOCK_PIXELS, PIXELS};
use crate::simd::dispatch;
use crate::simd::gather::SLOTS;

impl<T: ShadingNumber> Shader<T> {
    /// Lights the triangles without a known colour that are visible in blocks not fully covered by
    /// one of them, with one sample per pixel.
    pub(crate) fn light_shown_faces(
        &mut self,
        context: &ShadingContext<'_, T>,
        faces: &FaceColors,
        visibility: &Visibility,
    ) {
        let mut new = std::mem::take(&mut self.new_faces);
        let to = (&mut new, &mut self.runs);
        let count = dispatch!(context.level, simd => list(simd, faces, visibility, to));
        let mut left = &new[..count];
        while let Some(first) = left.first() {
            let group = group_of(context, *first);
            // Triangles of one group are lit together, as many as there are slots.
            let count = left.iter().take(SLOTS).take_while(|number| group.holds(**number)).count();
            let (own, others) = left.split_at(count);
            left = others;
            // Faces with more than one colour are shaded pixel by pixel later.
            if group.program.whole != WholePath::Fill {
                continue;
            }
            // The next group is prefetched while this one is lit.
            if group.lit().is_some() {
                prefetch_facets(&group, &left[..left.len().min(SLOTS)]);
            }
            self.fragments.list_faces(own);
            self.colors.form = Form::Pixels;
            self.group(&group);
            for (number, color) in own.iter().zip(&self.colors.pixels) {
                faces.put(*number, *color);
            }
        }
        self.new_faces = new;
    }
}

/// Prefetches the inputs for lighting some faces, if they belong to a group.
fn prefetch_facets<T>(group: &Group<'_, T>, numbers: &[u32]) {
    let mesh = &group.draw.model.mesh;
    let facets = mesh.facets();
    let own = numbers.iter().filter(|number| (group.base..group.end).contains(number));
    for number in own {
        prefetch_index(facets, mesh.polygon_of(number - group.base) as usize);
    }
}

/// Lists the triangles of a tile that have to be lit, and finds the starts of runs of equal pixels,
/// a bit for each pixel of each block. Returns the number of listed triangles.
#[inline(always)]
fn list<S: Simd>(
    simd: S,
    faces: &FaceColors,
    visibility: &Visibility,
    (to, all_runs): (&mut Vec<u32>, &mut [u64; BLOCK_PIXELS]),
) -> usize {
    // Each triangle is stored, and overwritten by the next one unless it is new: this avoids a
    // branch.
    to.resize(PIXELS, 0);
    let mut count = 0;
    let mut claim = |runs: &Runs| {
        runs.each_new(
            #[inline(always)]
            |number| {
                to[count % PIXELS] = number;
                count += usize::from(faces.claim(number));
            },
        );
    };
    let shown = |block: &usize| visibility.shows(*block) && visibility.whole(*block).is_none();
    // One block behind, which gives the prefetched entries time to arrive.
    let mut before: Option<Runs> = None;
    for block in (0..BLOCK_PIXELS).filter(shown) {
        let runs = Runs::find(simd, visibility.block(block));
        all_runs[block] = runs.starts_in_rows();
        runs.each_new(
            #[inline(always)]
            |number| faces.prefetch(number),
        );
        if let Some(before) = before.replace(runs) {
            claim(&before);
        }
    }
    if let Some(last) = before {
        claim(&last);
    }
    count
}
