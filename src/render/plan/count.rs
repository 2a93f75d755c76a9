//! How many pixels each effect of a picture takes part in.
//!
//! Counted afterwards, by looking once more at what is seen: so drawing counts nothing and pays nothing.

use std::collections::BTreeMap;

use fearless_simd::Level;
use rayon::prelude::*;

use super::draw::Form;
use super::tile::TilePlan;
use super::uses::{Effect, EffectUse};
use super::{FramePlan, Pipeline, Shaded};
use crate::render::bins::tiles_of;
use crate::render::clip::Screen;
use crate::render::corners::shows_back;
use crate::render::frame::Frame;
use crate::render::renderer::bounds_of;
use crate::render::tile::{BLOCK_PIXELS, Seen, Visibility, seen};
use crate::scene::{ItemId, LightAt};

/// Pixels by effect and thing, and what the worst of them may be off by.
#[derive(Debug, Default)]
struct Counts {
    pixels: BTreeMap<(Effect, ItemId), u64>,
    off_by: f64,
}

impl Counts {
    fn add(&mut self, effect: Effect, item: ItemId, pixels: u64) {
        *self.pixels.entry((effect, item)).or_default() += pixels;
    }

    fn with(mut self, other: Self) -> Self {
        for ((effect, item), pixels) in other.pixels {
            self.add(effect, item, pixels);
        }
        Self { off_by: self.off_by.max(other.off_by), ..self }
    }
}

impl FramePlan {
    /// See [`Renderer::count`](crate::render::Renderer::count).
    pub(in crate::render) fn count(
        &self,
        level: Level,
        frame: &Frame,
        uses: &mut [EffectUse],
    ) -> f64 {
        let [columns, rows] = tiles_of(self.size);
        let tiles = usize::try_from(columns * rows).expect("not negative");
        let counts = (0..tiles)
            .into_par_iter()
            .map_init(
                || (Visibility::default(), TilePlan::default()),
                |(visibility, tile_plan), tile| {
                    let bounds = bounds_of(tile, self.size);
                    visibility.draw(level, self, frame, (tile, bounds));
                    tile_plan.begin(self, visibility, bounds);
                    self.count_tile(frame, visibility, tile_plan)
                },
            )
            .reduce(Counts::default, Counts::with);
        for one in uses.iter_mut().filter(|one| one.state.is_on()) {
            let Some(thing) = &one.on else { continue };
            one.pixels = Some(counts.pixels.get(&(one.effect, thing.item)).copied().unwrap_or(0));
        }
        counts.off_by
    }

    fn count_tile(&self, frame: &Frame, visibility: &Visibility, tile: &mut TilePlan) -> Counts {
        let mut counts = Counts::default();
        // By draw and pipeline.
        let mut surfaces = BTreeMap::<(u32, u32), u64>::new();
        let words = (0..BLOCK_PIXELS).flat_map(|block| visibility.block(block).0);
        let mut last = None;
        for word in words {
            match seen(*word) {
                Seen::Background => {}
                Seen::Line(number) => {
                    self.count_line(frame.lines[number as usize].draw, &mut counts);
                }
                Seen::Triangle(number) => {
                    let (draw, start) = frame.draw_of(number);
                    let pipeline = self.draws[draw as usize].pipeline_of(number - start.number);
                    *surfaces.entry((draw, pipeline)).or_default() += 1;
                    let same = last.filter(|(other, _)| *other == number);
                    let back = same.map_or_else(
                        || self.is_back(frame, draw, number - start.number),
                        |(_, back)| back,
                    );
                    last = Some((number, back));
                    if back {
                        counts.add(Effect::BackFaces, self.draws[draw as usize].item, 1);
                    }
                }
            }
        }
        for ((draw, pipeline), pixels) in surfaces {
            let item = self.draws[draw as usize].item;
            counts.add(super::features::presence(item), item, pixels);
            if let Pipeline::Shaded(shaded) = &self.pipelines[pipeline as usize] {
                self.count_surface(item, pipeline, shaded, pixels, tile, &mut counts);
            }
        }
        counts
    }

    fn is_back(&self, frame: &Frame, draw: u32, number: u32) -> bool {
        let own = &self.draws[draw as usize];
        let vertices = frame.vertices_of(self, draw);
        let ids = own.model.mesh.draw_order().vertices_of(number);
        let corners = ids.map(|vertex| vertices[vertex as usize]);
        let whole = corners.iter().all(|corner| corner.is_inside());
        let screen = Screen::new(own.clip_from_object, self.size);
        shows_back(own, &screen, number, whole.then(|| corners.map(|corner| corner.at())))
    }

    /// Lines are not told apart where several kinds are drawn: each is given all of them.
    fn count_line(&self, draw: u32, counts: &mut Counts) {
        let draw = &self.draws[draw as usize];
        let lines = &draw.lines;
        let kinds = [
            (Effect::Edges, lines.edges),
            (Effect::FaceNormals, lines.face_normals.is_some()),
            (Effect::VertexNormals, lines.vertex_normals.is_some()),
        ];
        for (effect, _) in kinds.into_iter().filter(|(_, drawn)| *drawn) {
            counts.add(effect, draw.item, 1);
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
        for stage in light.stages {
            counts.add(Effect::Light(self.lights[stage.lamp as usize]), item, pixels);
        }
        let features = [
            (Effect::Highlights, light.stages.iter().any(|stage| stage.highlight != Form::Plain)),
            (Effect::Normals, self.light_at == LightAt::Pixel && light.places),
            (Effect::Texture, shaded.texture.is_some()),
            (Effect::Holes, shaded.cutout.is_some()),
            (Effect::VertexColors, shaded.vertex_colors),
        ];
        for (effect, _) in features.into_iter().filter(|(_, there)| *there) {
            counts.add(effect, item, pixels);
        }
        counts.off_by = counts.off_by.max(light.dropped + shaded.cut_off);
    }
}
