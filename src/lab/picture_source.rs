//! Draws the pictures that the laboratory times and judges.

use super::error::Rendering;
use super::hash::fnv1a;
use crate::base::image::{Picture, Size};
use crate::render::{FramePlan, Renderer};
use crate::scene::{Samples, Scene, Settings, View};

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
    scene: Scene,
    view: View,
    size: Size,
    renderer: Renderer,
}

impl Studio {
    /// A studio for this scene.
    #[must_use]
    pub fn new(scene: Scene, view: View, size: Size) -> Self {
        Self { scene, view, size, renderer: Renderer::default() }
    }

    /// The scene.
    #[must_use]
    pub const fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The view.
    #[must_use]
    pub const fn view(&self) -> &View {
        &self.view
    }

    /// The size of the pictures.
    #[must_use]
    pub const fn size(&self) -> Size {
        self.size
    }

    /// The name of the item that a pixel of the last picture shows, and the polygon.
    #[must_use]
    pub fn seen(&mut self, [x, y]: [usize; 2]) -> Option<(String, u32)> {
        use crate::scene::ItemId;
        let hit = self.renderer.hit(x, y)?;
        let name = match hit.item {
            ItemId::Object(id) => self.scene.objects.get(id).map(|object| &object.name),
            ItemId::Camera(id) => self.scene.cameras.get(id).map(|camera| &camera.name),
            ItemId::Light(id) => self.scene.lights.get(id).map(|light| &light.name),
        };
        Some((name?.clone(), hit.polygon))
    }
}

impl PictureSource for Studio {
    fn draw(&mut self, settings: &Settings) {
        let plan = FramePlan::new(&self.scene, &self.view, settings, self.size);
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
