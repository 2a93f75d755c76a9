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

/// The reference that pictures are judged against.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Reference {
    /// All axes at their most exact, one sample per pixel, with the chosen models.
    #[default]
    Exact,
    /// 256 samples per pixel, each lit.
    Sampled,
    /// Like [`Self::Exact`], with the default models.
    DefaultModel,
}

impl Reference {
    /// Returns the reference that reveals the effect of an axis.
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
    /// Draws the whole picture without reusing the last one.
    fn draw(&mut self, settings: &Settings);
    /// Returns the last picture.
    fn picture(&self) -> &Picture;
    /// Returns the primitive at each pixel of the last picture.
    fn primitives(&mut self) -> Vec<u32>;

    /// Draws the mean of 256 samples per pixel, each drawn as if it were the pixel's centre.
    fn draw_sampled(&mut self, settings: &Settings) -> Picture;

    /// Draws the reference for samples per pixel: [`Settings::sampled`] with 256 samples, each lit.
    fn sampled(&mut self, settings: &Settings) -> Rendering {
        let picture = self.draw_sampled(&settings.sampled());
        let primitives = vec![0; picture.pixels().len()];
        Rendering::new(picture, primitives).mixed()
    }

    /// Draws the reference for these settings.
    fn reference(&mut self, settings: &Settings, reference: Reference) -> Rendering {
        match reference {
            Reference::Exact => self.rendering(&settings.reference()),
            Reference::Sampled => self.sampled(settings),
            Reference::DefaultModel => self.rendering(&Settings::default().reference()),
        }
    }

    /// Draws the picture for these settings, to be judged.
    fn rendering(&mut self, settings: &Settings) -> Rendering {
        self.draw(settings);
        let primitives = self.primitives();
        let rendering = Rendering::new(self.picture().clone(), primitives);
        if settings.samples == Samples::One { rendering } else { rendering.mixed() }
    }
}

/// The samples per pixel of [`Reference::Sampled`].
const SAMPLED: u16 = 256;

/// Returns the sample positions, in 1/256 pixel from the centre: the centres of 16 x 16 squares.
fn sample_shifts() -> impl Iterator<Item = [i32; 2]> {
    (0..256).map(|i| [i % 16, i / 16].map(|i| 16 * i + 8 - 128))
}

/// A renderer with a scene.
#[derive(Debug)]
pub struct Studio {
    shot: Shot,
    renderer: Renderer,
    /// Cancels drawing between two tiles when the pictures are no longer wanted.
    progress: Progress,
}

impl Studio {
    /// Prepares to draw this shot with any settings.
    #[must_use]
    pub fn new(shot: Shot) -> Self {
        Self::watched(shot, Progress::new())
    }

    /// Works like [`Self::new`]. Once `progress` is cancelled, drawing ends soon with undefined
    /// pictures.
    #[must_use]
    pub fn watched(shot: Shot, progress: Progress) -> Self {
        Self { shot, renderer: Renderer::default(), progress }
    }

    /// Returns the shot.
    #[must_use]
    pub const fn shot(&self) -> &Shot {
        &self.shot
    }

    /// Returns the name of the item at a pixel of the last picture, and the polygon.
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
        // A cancelled picture is not used.
        let _ = self.renderer.render_while(&plan, &|| !self.progress.is_cancelled());
    }

    fn draw_sampled(&mut self, settings: &Settings) -> Picture {
        // One plan serves all samples: only the subpixel shift changes.
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
        // The sum of 256 bytes fits into 16 bits, even with the half for rounding.
        let mean = |sum: u16| ((sum + SAMPLED / 2) / SAMPLED) as u8;
        let pixels = sums.into_iter().map(|sum| sum.map(mean)).collect();
        Picture::from_pixels(self.shot.size, pixels).expect("a sum for each pixel")
    }

    fn picture(&self) -> &Picture {
        self.renderer.picture()
    }

    fn primitives(&mut self) -> Vec<u32> {
        if self.progress.is_cancelled() {
            // The picture may be incomplete, so its primitives are unknown.
            return vec![0; self.picture().pixels().len()];
        }
        self.renderer.primitives()
    }
}

/// Hashes a picture's pixels with FNV-1a, with the same value on every machine.
#[must_use]
pub fn hash(picture: &Picture) -> u64 {
    fnv1a(picture.pixels().iter().map(|pixel| u64::from(u32::from_le_bytes(*pixel))))
}
