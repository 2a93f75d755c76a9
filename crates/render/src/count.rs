//! Counts the pixels that each effect of a picture contributes to.
//!
//! A pixel with several samples counts for the surface that most of them show.
//!
//! The count is made afterwards, from the visibility of each pixel, so drawing itself pays nothing.

use crate::accel::Accelerated as _;
use std::collections::BTreeMap;

use fearless_simd::Level;
use rayon::prelude::*;

use crate::frame::FramePlan;
use crate::frame::draw::{Pipeline, Shaded, Stage};
use crate::lights::Form;
use crate::plan::features::{of_surface, presence};
use crate::plan::tile::TilePlan;
use crate::plan::uses::{Effect, EffectUse};
use crate::raster::geometry::ScreenGeometry;
use crate::raster::lines::LineNumber;
use crate::raster::visibility_buffer::{Visible, seen};
use crate::screen::coverage::PixelBox;
use crate::screen::tiles::{BLOCK_PIXELS, tiles_of};
use crate::shading::painter::bounds_of;
use crate::shading::triangle_attributes::is_front;
use crate::tile_layers::TileLayers;
use marraztu_core::accuracy::LightAt;
use marraztu_core::scene::ItemId;

/// Returns the triangle shown by a sample of the visibility buffer.
fn triangle(word: u64) -> Option<u32> {
    match seen(word) {
        Visible::Triangle(number) => Some(number),
        Visible::Background | Visible::Line(_) => None,
    }
}

/// The pixels of each effect on each item.
#[derive(Debug, Default)]
struct Counts(BTreeMap<(Effect, ItemId), u64>);

impl Counts {
    fn add(&mut self, effect: Effect, item: ItemId, pixels: u64) {
        *self.0.entry((effect, item)).or_default() += pixels;
    }

    fn with(mut self, other: Self) -> Self {
        for ((effect, item), pixels) in other.0 {
            self.add(effect, item, pixels);
        }
        self
    }
}

impl FramePlan {
    /// See [`Renderer::count`](crate::Renderer::count).
    pub(crate) fn count(&self, level: Level, frame: &ScreenGeometry, uses: &mut [EffectUse]) {
        let [columns, rows] = tiles_of(self.size);
        let tiles = usize::try_from(columns * rows).expect("not negative");
        let counts = (0..tiles)
            .into_par_iter()
            .map_init(
                || (TileLayers::default(), TilePlan::default()),
                |(seen, tile_plan), tile| {
                    let bounds = bounds_of(tile, self.size);
                    seen.draw(level, self, frame, (tile, bounds));
                    tile_plan.begin(self, bounds, || seen.depths(level));
                    self.count_tile(level, frame, (seen, bounds), tile_plan)
                },
            )
            .reduce(Counts::default, Counts::with);
        for one in uses.iter_mut().filter(|one| one.state.is_on()) {
            let Some(thing) = &one.on else { continue };
            // An effect that is on but shows at no pixel counts 0.
            one.pixels = Some(counts.0.get(&(one.effect, thing.item)).copied().unwrap_or(0));
        }
    }

    fn count_tile(
        &self,
        level: Level,
        frame: &ScreenGeometry,
        (tile_seen, bounds): (&mut TileLayers, PixelBox),
        tile: &mut TilePlan,
    ) -> Counts {
        let mut counts = Counts::default();
        // The number of pixels by draw and pipeline, and by draw.
        let mut surfaces = BTreeMap::<(u32, u32), u64>::new();
        let mut draws = BTreeMap::<u32, u64>::new();
        let surface = |number: u32| {
            let (draw, start) = frame.draw_of(number);
            (draw, self.draws[draw as usize].pipeline_of(number - start.number))
        };
        let rows = bounds.top..bounds.bottom;
        for (y, x) in rows.flat_map(|y| (bounds.left..bounds.right).map(move |x| (y, x))) {
            // A surface that shows only in a minority of samples counts towards the error, but not
            // as a pixel.
            let (samples, count) = tile_seen.visibility.samples(level, x, y);
            for number in samples[1..count].iter().filter_map(|word| triangle(*word)) {
                surfaces.entry(surface(number)).or_default();
            }
        }
        let (mut last, mut own) = (None, Vec::new());
        for block in 0..BLOCK_PIXELS {
            tile_seen.each(level, frame, block, |_, nearest, words| {
                if let Visible::Line(line) = seen(nearest) {
                    self.count_line(frame, line, &mut counts);
                }
                own.clear();
                own.extend(words.iter().filter_map(|word| triangle(*word)));
                for number in &own {
                    // Facing is reused while neighbouring pixels show the same triangle.
                    let same = last.filter(|(other, _)| other == number);
                    let back = same.map_or_else(
                        || {
                            let (draw, start) = frame.draw_of(*number);
                            self.is_back(frame, draw, number - start.number)
                        },
                        |(_, back)| back,
                    );
                    last = Some((*number, back));
                    if back {
                        let (draw, _) = frame.draw_of(*number);
                        counts.add(Effect::BackFaces, self.draws[draw as usize].item, 1);
                    }
                }
                // Several triangles of one surface at a pixel count once.
                let mut once: Vec<(u32, u32)> = own.iter().map(|number| surface(*number)).collect();
                once.sort_unstable();
                once.dedup();
                for key in &once {
                    *surfaces.entry(*key).or_default() += 1;
                }
                // Several pipelines of one draw count once for its item.
                once.dedup_by_key(|(draw, _)| *draw);
                for (draw, _) in once {
                    *draws.entry(draw).or_default() += 1;
                }
            });
        }
        for (draw, pixels) in draws {
            let item = self.draws[draw as usize].item;
            counts.add(presence(item), item, pixels);
        }
        for ((draw, pipeline), pixels) in surfaces {
            let item = self.draws[draw as usize].item;
            if let Pipeline::Shaded(shaded) = &self.pipelines[pipeline as usize] {
                self.count_surface(item, pipeline, shaded, pixels, tile, &mut counts);
            }
        }
        counts
    }

    /// Returns whether the observer sees the back of a triangle.
    fn is_back(&self, frame: &ScreenGeometry, draw: u32, number: u32) -> bool {
        let own = &self.draws[draw as usize];
        let ids = own.model.mesh.draw_order().vertices_of(number);
        is_front(ids, own, self, frame.corners_of(draw)) == own.mirrored
    }

    /// Counts a pixel of a line. Face normals and vertex normals are not distinguished: a pixel
    /// counts for both.
    fn count_line(&self, frame: &ScreenGeometry, line: LineNumber, counts: &mut Counts) {
        let Some((draw, _)) = frame.line_seen(self, line) else { return };
        let draw = &self.draws[draw as usize];
        if frame.stroke(line).is_some() {
            return counts.add(Effect::Strokes, draw.item, 1);
        }
        if frame.is_edge(line) {
            return counts.add(Effect::Edges, draw.item, 1);
        }
        if draw.lines.face_normals.is_some() {
            counts.add(Effect::FaceNormals, draw.item, 1);
        }
        if draw.lines.vertex_normals.is_some() {
            counts.add(Effect::VertexNormals, draw.item, 1);
        }
    }

    fn count_surface(
        &self,
        item: ItemId,
        pipeline: u32,
        shaded: &Shaded,
        pixels: u64,
        tile: &mut TilePlan,
        counts: &mut Counts,
    ) {
        let light = tile.light(self, pipeline, shaded);
        // Only lights that the tile plan kept for this tile count.
        let stages: Vec<&Stage> = match light.kept {
            None => light.stages.iter().collect(),
            Some(kept) => kept.iter().map(|place| &light.stages[*place as usize]).collect(),
        };
        let mirrors = stages.iter().any(|stage| stage.highlight != Form::Plain);
        for stage in stages {
            let id = self.light_ids[stage.light as usize];
            counts.add(Effect::Light(id), item, pixels);
            if self.shadows.source(stage.light).is_some() {
                counts.add(Effect::Shadows(id), item, pixels);
            }
        }
        let features = [
            (Effect::Highlights, mirrors),
            (Effect::Normals, self.light_at == LightAt::Pixel && light.needs_positions),
        ];
        let of_light = features.into_iter().filter(|(_, there)| *there).map(|(effect, _)| effect);
        for effect in of_light.chain(of_surface(shaded)) {
            counts.add(effect, item, pixels);
        }
    }
}
