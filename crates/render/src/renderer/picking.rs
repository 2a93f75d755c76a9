//! Queries the last picture: what a pixel shows and why, and which pixels show an item.
//!
//! Queries refer to the last finished picture, even after a cancelled frame. Its geometry is
//! rebuilt if necessary.

use std::collections::BTreeSet;
use std::ops::ControlFlow;

use serde::{Deserialize, Serialize};

use super::Renderer;
use crate::cancellation::Cancellation;
use crate::frame::FramePlan;
use crate::plan::uses::EffectUse;
use crate::raster::visibility_buffer::Visible;
use crate::raster::{depth_format, entries, visibility_buffer};
use crate::screen::sample_positions::passes;
use crate::screen::tiles::{BLOCK_PIXELS, TILE, block_at, tiles_of};
use crate::shading::context::Prepared;
use crate::shading::explain::{Asked, explain};
use crate::shading::interpolated::ShadingNumber;
use crate::shading::painter::bounds_of;
use crate::shading::pixel_color::{Part, PixelColor};
use crate::shadow::tracer::Tracer;
use crate::tile_layers::TileLayers;
use marraztu_core::accuracy::{Arithmetic, Samples};
use marraztu_core::base::image::Size;
use marraztu_core::scene::ItemId;

/// The polygon that a pixel shows.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Hit {
    /// The object, the camera if its mark is shown, or the light if its bulb is shown.
    pub item: ItemId,
    /// The polygon of the item's mesh; `None` for the lines and points of a model.
    pub polygon: Option<u32>,
    /// The depth: 1 at the near plane, 0 at the far plane.
    pub depth: f32,
}

/// Returns the drawn pixel that a pixel of the finished picture shows; `None` outside.
fn drawn_pixel(plan: &FramePlan, [x, y]: [usize; 2]) -> Option<[i32; 2]> {
    let Size { width, height } = plan.size();
    let by = if plan.enlarged.is_some() { 2 } else { 1 };
    let at = [x / by, y / by].map(|i| i32::try_from(i).expect("inside the picture"));
    (x < width && y < height).then_some(at)
}

/// Returns the number of the primitive that a word shows; 0 for the background.
#[expect(clippy::cast_possible_truncation, reason = "the lower half of a word names what is seen")]
const fn primitive(word: u64) -> u32 {
    word as u32
}

impl Renderer {
    /// Rebuilds the geometry of the last finished picture if another frame has been started since.
    fn build_again(&mut self) {
        if let (false, Some(plan)) = (self.built, &self.plan) {
            let sample_positions = passes(plan.samples)[0];
            let watch = Cancellation::new(&|| true);
            self.frame.build(self.level, plan, sample_positions, &watch);
            self.maps.update(self.level, plan, &watch);
            self.built = true;
        }
    }

    /// Returns the polygon shown in column `x` of row `y`, or `None` for the background. With
    /// several samples per pixel, it is the one shown by most of the four samples nearest to the
    /// centre.
    #[must_use]
    pub fn hit(&mut self, x: usize, y: usize) -> Option<Hit> {
        self.build_again();
        let plan = self.plan.as_ref()?;
        let [x, y] = drawn_pixel(plan, [x, y])?;
        let [columns, _] = tiles_of(plan.size);
        let tile = usize::try_from(y / TILE * columns + x / TILE).expect("not negative");
        // Only this pixel's tile is rasterised again.
        let mut tile_seen = TileLayers::default();
        tile_seen.draw(self.level, plan, &self.frame, (tile, bounds_of(tile, plan.size)));
        let mut word = 0;
        tile_seen.each(self.level, &self.frame, block_at(x % TILE, y % TILE), |at, nearest, _| {
            if at == [x, y] {
                word = nearest;
            }
        });
        let (draw, polygon) = self.seen(plan, word)?;
        let depth = depth_format::depth(plan.raster_mode().depth, entries::key(word));
        Some(Hit { item: plan.draws[draw as usize].item, polygon, depth })
    }

    /// Returns the contents of the pixel in column `x` of row `y` and the parts of its colour. A
    /// pixel with several samples is explained by the light at its centre, and one of a picture
    /// drawn at half the size by the light of its drawn pixel.
    #[must_use]
    pub fn explain(&mut self, x: usize, y: usize) -> Option<PixelColor> {
        self.build_again();
        let plan = self.plan.as_ref()?;
        let at = drawn_pixel(plan, [x, y])?;
        plan.prepare();
        let mut explained = match plan.arithmetic {
            Arithmetic::F32 => self.explain_in::<f32>(plan, at),
            Arithmetic::F64 => self.explain_in::<f64>(plan, at),
        };
        if plan.enlarged.is_some() {
            explained.drawn = Some(std::mem::replace(&mut explained.at, [x, y]));
            let [r, g, b, _] = self.enlarged.pixel(x, y);
            if plan.samples == Samples::One && explained.bytes != [r, g, b] {
                explained.lead_to([r, g, b], Part::Enlarged);
            }
        }
        Some(explained)
    }

    fn explain_in<T: ShadingNumber>(&self, plan: &FramePlan, at: [i32; 2]) -> PixelColor {
        // The tables of a frame, prepared for a single pixel.
        let mut prepared = Prepared::<T>::default();
        prepared.prepare(plan);
        let (level, frame) = (self.level, &self.frame);
        let tracer = Tracer::new(plan, &self.maps);
        let around_plan = plan.surroundings.as_deref();
        let around_tracer = around_plan.and_then(|around| Tracer::new(around, &self.maps));
        let around = prepared.around(level, plan, around_tracer.as_ref());
        let traced = (tracer.as_ref(), around.as_ref());
        let context = prepared.context(level, (plan, frame), None, traced);
        let [x, y] = at;
        let [columns, _] = tiles_of(plan.size);
        let tile = usize::try_from(y / TILE * columns + x / TILE).expect("not negative");
        let bounds = bounds_of(tile, plan.size);
        // Visibility is not kept after a frame, so the tile is rasterised again.
        let mut tile_seen = TileLayers::default();
        tile_seen.draw(level, plan, frame, (tile, bounds));
        let depths = tile_seen.depths(level);
        let mut shown = Vec::new();
        tile_seen.each(level, frame, block_at(x % TILE, y % TILE), |place, nearest, words| {
            if place == at {
                // With several samples: the word that most of them show.
                let one = plan.samples == Samples::One;
                shown = if one { words.to_vec() } else { vec![nearest] };
            }
        });
        let [column, row] = at.map(|i| usize::try_from(i).expect("inside the picture"));
        let [r, g, b, _] = self.picture.pixel(column, row);
        explain(&context, &Asked { at, bounds, depths, words: &shown, bytes: [r, g, b] })
    }

    /// Marks the pixels that show an item, also through transparent surfaces: a flag for each
    /// pixel, row by row from the top.
    #[must_use]
    pub fn pixels_of(&mut self, item: ItemId) -> Vec<bool> {
        self.pixels_of_any(&[item])
    }

    /// Marks the pixels that show any of these items, like [`Self::pixels_of`].
    #[must_use]
    pub fn pixels_of_any(&mut self, items: &[ItemId]) -> Vec<bool> {
        let [all, _] = self.marked(items);
        self.spread(all)
    }

    /// Marks the pixels inside the outline of these items. Lines and points of models are outlined
    /// at a distance of one pixel, which leaves their colours visible.
    #[must_use]
    pub fn outlined_pixels(&mut self, items: &[ItemId]) -> Vec<bool> {
        let [mut all, strokes] = self.marked(items);
        let width = self.seen_size().width.max(1);
        for at in (0..strokes.len()).filter(|at| strokes[*at]) {
            let (column, row) = (at % width, at - at % width);
            for beside in [row.checked_sub(width), Some(row), Some(row + width)] {
                let Some(row) = beside.filter(|row| *row < strokes.len()) else { continue };
                let columns = column.saturating_sub(1)..(column + 2).min(width);
                all[row + columns.start..row + columns.end].fill(true);
            }
        }
        self.spread(all)
    }

    /// Marks the drawn pixels that show any of these items, and those that show a line or point of
    /// their models.
    fn marked(&mut self, items: &[ItemId]) -> [Vec<bool>; 2] {
        let [mut all, mut strokes] = [0; 2].map(|_| vec![false; self.seen_size().area()]);
        let mut last = (None, [false; 2]);
        self.look(|renderer, plan, at, _, words| {
            for word in words {
                // Neighbouring pixels mostly show the same primitive.
                let primitive = Some(primitive(*word));
                if last.0 != primitive {
                    let own = renderer
                        .seen(plan, *word)
                        .filter(|(draw, _)| items.contains(&plan.draws[*draw as usize].item));
                    let is_stroke = own.is_some_and(|(_, polygon)| polygon.is_none());
                    last = (primitive, [own.is_some(), is_stroke]);
                }
                all[at] |= last.1[0];
                strokes[at] |= last.1[1];
            }
            ControlFlow::Continue(())
        });
        [all, strokes]
    }

    /// Returns the item shown at each pixel, row by row from the top, or `None` if every one of
    /// these items is visible.
    pub(crate) fn items_unless_all_seen(
        &mut self,
        mut items: BTreeSet<ItemId>,
    ) -> Option<Vec<Option<ItemId>>> {
        let mut pixels = vec![None; self.seen_size().area()];
        let mut last = None;
        self.look(|renderer, plan, at, nearest, words| {
            let item = |word: u64| {
                renderer.seen(plan, word).map(|(draw, _)| plan.draws[draw as usize].item)
            };
            pixels[at] = item(nearest);
            // Neighbouring pixels mostly show the same item: the set is only searched when it
            // changes.
            if pixels[at] != last || words.len() > 1 {
                last = pixels[at];
                words.iter().filter_map(|word| item(*word)).for_each(|item| {
                    items.remove(&item);
                });
            }
            if items.is_empty() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
        (!items.is_empty()).then(|| self.spread(pixels))
    }

    /// Counts the pixels that each effect of the last picture takes part in. Takes about as long as
    /// rasterizing the picture.
    pub fn count(&mut self, uses: &mut [EffectUse]) {
        self.build_again();
        if let Some(plan) = &self.plan {
            plan.count(self.level, &self.frame, uses);
        }
    }

    /// Returns the primitive shown by each pixel, row by row from the top: 0 for the background,
    /// else a number that is unique to each triangle and line of the scene.
    #[must_use]
    pub fn primitives(&mut self) -> Vec<u32> {
        let mut pixels = vec![0; self.seen_size().area()];
        self.look(|_, _, at, word, _| {
            pixels[at] = primitive(word);
            ControlFlow::Continue(())
        });
        self.spread(pixels)
    }

    /// Returns the surface shown by each pixel, row by row from the top: the number of its object
    /// or camera, 0 for the background, and its depth, as in [`Hit::depth`].
    #[must_use]
    pub fn surfaces(&mut self) -> Vec<(u32, f32)> {
        let mut pixels = vec![(0, 0.0); self.seen_size().area()];
        let mut last = (None, 0);
        self.look(|renderer, plan, at, word, _| {
            // Neighbouring pixels mostly show the same primitive.
            let primitive = Some(primitive(word));
            if last.0 != primitive {
                let seen = renderer.seen(plan, word);
                let item = seen.map(|(draw, _)| plan.draws[draw as usize].item);
                last = (primitive, item.map_or(0, number_of));
            }
            let depth = depth_format::depth(plan.raster_mode().depth, entries::key(word));
            pixels[at] = (last.1, if last.1 == 0 { 0.0 } else { depth });
            ControlFlow::Continue(())
        });
        self.spread(pixels)
    }

    /// Gives each pixel of the finished picture what its drawn pixel has.
    fn spread<T: Copy>(&self, drawn: Vec<T>) -> Vec<T> {
        let Some((plan, size)) = self.plan.as_ref().and_then(|plan| Some((plan, plan.enlarged?)))
        else {
            return drawn;
        };
        // A drawn pixel covers 2 x 2 pixels of the finished picture.
        let row = |y: usize| (0..size.width).map(move |x| y / 2 * plan.size.width + x / 2);
        (0..size.height).flat_map(row).map(|at| drawn[at]).collect()
    }

    /// Returns the size of the last picture as it was drawn; 0 x 0 before the first.
    fn seen_size(&self) -> Size {
        self.plan.as_ref().map_or(Size::new(0, 0), |plan| plan.size)
    }

    /// Calls `each` with the index of each pixel of the last picture, its nearest word and all of
    /// its words, tile by tile, until it breaks. See [`TileLayers::each`]. Blocks of background are
    /// left out.
    fn look(
        &mut self,
        mut each: impl FnMut(&Self, &FramePlan, usize, u64, &[u64]) -> ControlFlow<()>,
    ) {
        self.build_again();
        let Some(plan) = &self.plan else { return };
        let [columns, rows] = tiles_of(plan.size);
        let mut tile_seen = TileLayers::default();
        let tiles = 0..usize::try_from(columns * rows).expect("not negative");
        for tile in tiles.filter(|tile| !self.frame.is_empty(*tile)) {
            tile_seen.draw(self.level, plan, &self.frame, (tile, bounds_of(tile, plan.size)));
            for block in 0..BLOCK_PIXELS {
                if !tile_seen.shows(block) {
                    continue;
                }
                let mut flow = ControlFlow::Continue(());
                tile_seen.each(self.level, &self.frame, block, |at, nearest, words| {
                    let [x, y] = at.map(|i| usize::try_from(i).expect("inside the picture"));
                    if flow.is_continue() {
                        flow = each(self, plan, y * plan.size.width + x, nearest, words);
                    }
                });
                // The caller has its answer.
                if flow.is_break() {
                    return;
                }
            }
        }
    }

    /// Returns the draw and the polygon, if there is one, named by a sample of the visibility
    /// buffer.
    fn seen(&self, plan: &FramePlan, word: u64) -> Option<(u32, Option<u32>)> {
        match visibility_buffer::seen(word) {
            Visible::Background => None,
            Visible::Triangle(number) => {
                let (draw, start) = self.frame.draw_of(number);
                let mesh = &plan.draws[draw as usize].model.mesh;
                Some((draw, Some(mesh.polygon_of(number - start.number))))
            }
            Visible::Line(line) => self.frame.line_seen(plan, line),
        }
    }
}

/// Returns a number from 1 that no other item has: items of all three lists share their ids.
const fn number_of(item: ItemId) -> u32 {
    match item {
        ItemId::Object(id) => id.0.saturating_add(1),
        ItemId::Camera(id) => id.0.saturating_add(1),
        ItemId::Light(id) => id.0.saturating_add(1),
    }
}
