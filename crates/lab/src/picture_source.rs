//! Draws the pictures that the laboratory times and judges.

use rayon::prelude::*;

use super::error::Rendering;
use super::hash::fnv1a;
use marraztu_core::accuracy::Shot;
use marraztu_core::accuracy::{Axis, AxisKind, Samples, Settings};
use marraztu_core::base::image::Picture;
use marraztu_io::Progress;
use marraztu_render::Renderer;
use marraztu_render::plan_frame;

/// The picture that another is judged against.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Reference {
    /// Every axis at its most exact, one sample per pixel; models as they are chosen.
    #[default]
    Exact,
    /// 256 samples per pixel, each lit.
    Sampled,
    /// As [`Self::Exact`], with the models of the default.
    DefaultModel,
}

impl Reference {
    /// The reference that shows what the choices of an axis do.
    #[must_use]
    pub const fn of(axis: &Axis) -> Self {
        match axis.kind {
            AxisKind::Scored => Self::Exact,
            AxisKind::ScoredApart => Self::Sampled,
            AxisKind::Model => Self::DefaultModel,
        }
    }
}

/// Draws one scene, from one view and in one size, with any settings.
pub trait PictureSource {
    /// Draws the whole picture, reusing nothing of the last one.
    fn draw(&mut self, settings: &Settings);
    /// The picture that was drawn last.
    fn picture(&self) -> &Picture;
    /// The primitive that each of its pixels shows.
    fn primitives(&mut self) -> Vec<u32>;

    /// Draws the mean of 256 samples per pixel, each drawn with these settings as if it were the
    /// centre of its pixel.
    fn draw_sampled(&mut self, settings: &Settings) -> Picture;

    /// The reference of samples per pixel: [`Settings::sampled`] with 256 samples, each lit.
    fn sampled(&mut self, settings: &Settings) -> Rendering {
        let picture = self.draw_sampled(&settings.sampled());
        let primitives = vec![0; picture.pixels().len()];
        Rendering::new(picture, primitives).mixed()
    }

    /// The picture that these settings are judged against.
    fn reference(&mut self, settings: &Settings, reference: Reference) -> Rendering {
        match reference {
            Reference::Exact => self.rendering(&settings.reference()),
            Reference::Sampled => self.sampled(settings),
            Reference::DefaultModel => self.rendering(&Settings::default().reference()),
        }
    }

    /// Draws the picture of these settings, to be judged.
    fn rendering(&mut self, settings: &Settings) -> Rendering {
        self.draw(settings);
        let primitives = self.primitives();
        let rendering = Rendering::new(self.picture().clone(), primitives);
        if settings.samples == Samples::One { rendering } else { rendering.mixed() }
    }
}

/// The samples per pixel of the reference of sampling.
const SAMPLED: u16 = 256;

/// The positions of these samples, in 1/256 pixel from the centre: the centres of 16 x 16 squares.
fn sample_shifts() -> impl Iterator<Item = [i32; 2]> {
    (0..256).map(|i| [i % 16, i / 16].map(|i| 16 * i + 8 - 128))
}

/// The renderer with a scene.
#[derive(Debug)]
pub struct Studio {
    shot: Shot,
    renderer: Renderer,
    /// Whether its pictures are still wanted; if not, drawing ends between two tiles.
    progress: Progress,
}

impl Studio {
    /// Draws this shot, with any settings.
    #[must_use]
    pub fn new(shot: Shot) -> Self {
        Self::watched(shot, Progress::new())
    }

    /// As [`Self::new`]. Once `progress` is cancelled, pictures are undefined, and soon there.
    #[must_use]
    pub fn watched(shot: Shot, progress: Progress) -> Self {
        Self { shot, renderer: Renderer::default(), progress }
    }

    /// The scene.
    #[must_use]
    pub const fn shot(&self) -> &Shot {
        &self.shot
    }

    /// The name of the item that a pixel of the last picture shows, and the polygon.
    #[must_use]
    pub fn seen(&mut self, [x, y]: [usize; 2]) -> Option<(String, u32)> {
        use marraztu_core::scene::ItemId;
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
        // If it is cancelled, the picture is not used.
        let _ = self.renderer.render_while(&plan, &|| !self.progress.is_cancelled());
    }

    fn draw_sampled(&mut self, settings: &Settings) -> Picture {
        let plan = plan_frame(&self.shot.with(Settings { samples: Samples::One, ..*settings }));
        let mut sums = vec![[0_u16; 4]; self.shot.size.area()];
        for shift in sample_shifts() {
            let wanted = || !self.progress.is_cancelled();
            if self.renderer.render_while(&plan.seen_from(shift), &wanted).is_err() {
                break;
            }
            sums.par_iter_mut().zip(self.renderer.picture().pixels()).for_each(|(sum, pixel)| {
                for (sum, byte) in sum.iter_mut().zip(pixel) {
                    *sum += u16::from(*byte);
                }
            });
        }
        // 256 bytes fit into 16 bits, and so does the half that rounds their mean.
        let mean = |sum: u16| ((sum + SAMPLED / 2) / SAMPLED) as u8;
        let pixels = sums.into_iter().map(|sum| sum.map(mean)).collect();
        Picture::from_pixels(self.shot.size, pixels).expect("a sum for each pixel")
    }

    fn picture(&self) -> &Picture {
        self.renderer.picture()
    }

    fn primitives(&mut self) -> Vec<u32> {
        if self.progress.is_cancelled() {
            // The picture may be half drawn: its pixels show nothing that is known.
            return vec![0; self.picture().pixels().len()];
        }
        self.renderer.primitives()
    }
}

/// A hash of a picture, the same on every machine: FNV-1a over its pixels.
#[must_use]
pub fn hash(picture: &Picture) -> u64 {
    fnv1a(picture.pixels().iter().map(|pixel| u64::from(u32::from_le_bytes(*pixel))))
}
