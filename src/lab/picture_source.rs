//! What pictures are drawn on, so that they can be timed and judged.

use super::error::Rendering;
use super::hash::fnv1a;
use crate::accuracy::Shot;
use crate::accuracy::{Samples, Settings};
use crate::base::image::Picture;
use crate::render::Renderer;
use crate::render::plan_frame;

/// Draws one scene, seen one way, in one size, with any settings.
pub trait PictureSource {
    /// Draws the picture, as wholly as if it were the first.
    fn draw(&mut self, settings: &Settings);
    /// The picture that was drawn last.
    fn picture(&self) -> &Picture;
    /// Which primitive each pixel of it shows.
    fn primitives(&mut self) -> Vec<u32>;

    /// The picture of these settings, with what is needed to judge it.
    fn rendering(&mut self, settings: &Settings) -> Rendering {
        self.draw(settings);
        let primitives = self.primitives();
        let rendering = Rendering::new(self.picture().clone(), primitives);
        if settings.samples == Samples::One { rendering } else { rendering.mixed() }
    }
}

/// The renderer, with what it draws.
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

    /// What is drawn.
    #[must_use]
    pub const fn shot(&self) -> &Shot {
        &self.shot
    }

    /// What is seen at a pixel of the last picture: the name of the item, and the polygon.
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

/// A number for a picture, the same for the same bytes on every machine: FNV-1a over its pixels.
#[must_use]
pub fn hash(picture: &Picture) -> u64 {
    fnv1a(picture.pixels().iter().map(|pixel| u64::from(u32::from_le_bytes(*pixel))))
}
