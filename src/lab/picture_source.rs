//! Draws the pictures that the laboratory times and judges.

use super::error::Rendering;
use super::hash::fnv1a;
use crate::accuracy::Shot;
use crate::accuracy::{Samples, Settings};
use crate::base::image::Picture;
use crate::render::Renderer;
use crate::render::plan_frame;

/// Draws one scene, from one view and in one size, with any settings.
pub trait PictureSource {
    /// Draws the whole picture, reusing nothing of the last one.
    fn draw(&mut self, settings: &Settings);
    /// The picture that was drawn last.
    fn picture(&self) -> &Picture;
    /// The primitive that each of its pixels shows.
    fn primitives(&mut self) -> Vec<u32>;

    /// Draws the picture of these settings, to be judged.
    fn rendering(&mut self, settings: &Settings) -> Rendering {
        self.draw(settings);
        let primitives = self.primitives();
        let rendering = Rendering::new(self.picture().clone(), primitives);
        if settings.samples == Samples::One { rendering } else { rendering.mixed() }
    }
}

/// The renderer with a scene.
#[derive(Debug)]
pub struct Studio {
    shot: Shot,
    renderer: Renderer,
}

impl Studio {
    /// Draws this shot, with any settings.
    #[must_use]
    pub fn new(shot: Shot) -> Self {
        Self { shot, renderer: Renderer::default() }
    }

    /// The scene.
    #[must_use]
    pub const fn shot(&self) -> &Shot {
        &self.shot
    }

    /// The name of the item that a pixel of the last picture shows, and the polygon.
    #[must_use]
    pub fn seen(&mut self, [x, y]: [usize; 2]) -> Option<(String, u32)> {
        use crate::scene::ItemId;
        let hit = self.renderer.hit(x, y)?;
        let name = match hit.item {
            ItemId::Object(id) => self.shot.scene.objects.get(id).map(|object| &object.name),
            ItemId::Camera(id) => self.shot.scene.cameras.get(id).map(|camera| &camera.name),
            ItemId::Light(id) => self.shot.scene.lights.get(id).map(|light| &light.name),
        };
        Some((name?.clone(), hit.polygon))
    }
}

impl PictureSource for Studio {
    fn draw(&mut self, settings: &Settings) {
        let plan = plan_frame(&self.shot.with(*settings));
        self.renderer.render(&plan);
    }

    fn picture(&self) -> &Picture {
        self.renderer.picture()
    }

    fn primitives(&mut self) -> Vec<u32> {
        self.renderer.primitives()
    }
}

/// A hash of a picture, the same on every machine: FNV-1a over its pixels.
#[must_use]
pub fn hash(picture: &Picture) -> u64 {
    fnv1a(picture.pixels().iter().map(|pixel| u64::from(u32::from_le_bytes(*pixel))))
}
