//! Draws the pictures that the laboratory times and judges.

use super::error::Rendering;
use super::hash::fnv1a;
use super::lost::{PixelSurface, flat_surface};
use marraztu_core::accuracy::Shot;
use marraztu_core::accuracy::{Axis, AxisKind, Samples, Settings, uncapitalized};
use marraztu_core::base::image::{Picture, Size};
use marraztu_io::Progress;
use marraztu_render::screen::coverage::PixelBox;
use marraztu_render::{FramePlan, Renderer, plan_frame};

/// The reference that pictures are judged against.
#[derive(Clone, Copy, Debug, Default)]
pub enum Reference {
    /// The ideal: 256 samples per pixel, each lit, every axis at its most exact, with the chosen
    /// models. It answers how far a picture is from the truth.
    #[default]
    Ideal,
    /// The same settings, with this axis alone at its most exact, or at the default of a model. It
    /// answers what one choice changes, however small.
    Alone(&'static Axis),
}

impl Reference {
    /// The settings of the reference of a picture with these settings.
    pub fn of(self, settings: &Settings) -> Settings {
        match self {
            Self::Ideal => settings.ideal(),
            Self::Alone(axis) => settings.exact_in(axis),
        }
    }

    /// The name of the reference of a picture with these settings: "ideal", "exact texture filter".
    /// No choice of a model is exact, so the name of the choice is given: "specular form R.V".
    pub fn name(self, settings: &Settings) -> String {
        match self {
            Self::Ideal => "ideal".to_owned(),
            Self::Alone(axis) => match axis.kind {
                AxisKind::Scored => format!("exact {}", uncapitalized(axis.label)),
                AxisKind::Model => axis.in_words(axis.chosen(&self.of(settings))),
            },
        }
    }
}

impl PartialEq for Reference {
    fn eq(&self, other: &Self) -> bool {
        let key = |reference: &Self| match reference {
            Self::Ideal => None,
            Self::Alone(axis) => Some(axis.key),
        };
        key(self) == key(other)
    }
}

impl Eq for Reference {}

/// Draws one scene, from one view and in one size, with any settings.
pub trait PictureSource {
    /// Draws the whole picture without reusing the last one.
    fn draw(&mut self, settings: &Settings);
    /// Draws the whole picture, and reports its progress.
    fn draw_slowly(&mut self, settings: &Settings, _: &Progress) {
        self.draw(settings);
    }
    /// Returns the colour of a pixel of the picture with these settings, which are an ideal.
    fn ideal_pixel(&mut self, ideal: &Settings, [x, y]: [usize; 2]) -> [u8; 3] {
        self.draw(ideal);
        let [r, g, b, _] = self.picture().pixel(x, y);
        [r, g, b]
    }
    /// Returns a window of the picture with these settings, which are an ideal.
    fn ideal_window(&mut self, ideal: &Settings, window: PixelBox) -> Picture {
        self.draw(ideal);
        cropped(self.picture(), window)
    }
    /// Returns the last picture.
    fn picture(&self) -> &Picture;
    /// Returns the primitive at each pixel of the last picture.
    fn primitives(&mut self) -> Vec<u32>;
    /// Returns the surface at each pixel of the last picture. By default all primitives are of one
    /// flat surface.
    fn surfaces(&mut self) -> Vec<PixelSurface> {
        flat_surface(&self.primitives())
    }

    /// Draws the picture for these settings, to be judged.
    fn rendering(&mut self, settings: &Settings) -> Rendering {
        self.draw(settings);
        self.last_rendering(settings)
    }

    /// Returns the last picture, which has these settings, to be judged.
    fn last_rendering(&mut self, settings: &Settings) -> Rendering {
        let primitives = self.primitives();
        let surfaces = self.surfaces();
        let rendering = Rendering::new(self.picture().clone(), primitives).of_surfaces(surfaces);
        if settings.samples == Samples::One { rendering } else { rendering.mixed() }
    }
}

/// A renderer with a scene.
#[derive(Debug)]
pub struct Studio {
    shot: Shot,
    renderer: Renderer,
    /// The plan of the ideal, once a window of it was drawn.
    ideal: Option<(Settings, FramePlan)>,
    /// Cancels drawing between two tiles when the pictures are no longer wanted.
    progress: Progress,
}

impl Studio {
    /// Prepares to draw this shot with any settings.
    pub fn new(shot: Shot) -> Self {
        Self::watched(shot, Progress::new())
    }

    /// Works like [`Self::new`]. Once `progress` is cancelled, drawing ends soon with undefined
    /// pictures.
    pub fn watched(shot: Shot, progress: Progress) -> Self {
        Self { shot, renderer: Renderer::default(), ideal: None, progress }
    }

    /// Returns the shot.
    pub const fn shot(&self) -> &Shot {
        &self.shot
    }

    /// Names the primitive at a pixel of the last picture: "polygon 12 of chair", counted from 1.
    pub fn seen(&mut self, [x, y]: [usize; 2]) -> Option<String> {
        let hit = self.renderer.hit(x, y)?;
        let name = self.shot.scene.name(hit.item)?;
        Some(match hit.polygon {
            Some(polygon) => format!("polygon {} of {name}", polygon + 1),
            None => format!("a line or point of {name}"),
        })
    }
}

impl PictureSource for Studio {
    fn draw(&mut self, settings: &Settings) {
        let plan = plan_frame(&self.shot.with(*settings));
        // A cancelled picture is not used.
        let _ = self.renderer.render_while(&plan, &|| !self.progress.is_cancelled());
    }

    fn draw_slowly(&mut self, settings: &Settings, progress: &Progress) {
        let plan = plan_frame(&self.shot.with(*settings));
        // A cancelled picture is not used.
        let tell = |done, all| _ = progress.reached(done, all);
        let _ = self.renderer.render_watched(&plan, &|| !self.progress.is_cancelled(), &tell);
    }

    fn ideal_pixel(&mut self, ideal: &Settings, at: [usize; 2]) -> [u8; 3] {
        // A whole ideal picture may take minutes.
        let plan = plan_frame(&self.shot.with(*ideal));
        let [left, top] = at.map(|i| i32::try_from(i).expect("pictures have 32-bit sizes"));
        let pixel = PixelBox { left, top, right: left + 1, bottom: top + 1 };
        let wanted = || !self.progress.is_cancelled();
        let picture = self.renderer.render_window(&plan, pixel, &wanted);
        // A cancelled picture is not used.
        let [r, g, b, _] = picture.map_or([0; 4], |picture| picture.pixel(0, 0));
        [r, g, b]
    }

    fn ideal_window(&mut self, ideal: &Settings, window: PixelBox) -> Picture {
        let plan = match self.ideal.take() {
            Some((settings, plan)) if settings == *ideal => plan,
            _ => plan_frame(&self.shot.with(*ideal)),
        };
        let wanted = || !self.progress.is_cancelled();
        let picture = self.renderer.render_window(&plan, window, &wanted);
        self.ideal = Some((*ideal, plan));
        // A cancelled picture is not used.
        picture.unwrap_or_default()
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

    fn surfaces(&mut self) -> Vec<PixelSurface> {
        if self.progress.is_cancelled() {
            return vec![(0, 0.0); self.picture().pixels().len()];
        }
        self.renderer.surfaces()
    }
}

/// Returns a window of a picture.
pub(crate) fn cropped(picture: &Picture, window: PixelBox) -> Picture {
    let [left, top, right, bottom] = [window.left, window.top, window.right, window.bottom]
        .map(|side| usize::try_from(side).unwrap_or(0));
    let width = picture.size().width;
    let row = |y: usize| &picture.pixels()[y * width + left..y * width + right];
    let pixels: Vec<[u8; 4]> = (top..bottom).flat_map(row).copied().collect();
    Picture::from_pixels(Size::new(right - left, bottom - top), pixels).unwrap_or_default()
}

/// Hashes a picture's pixels with FNV-1a, with the same value on every machine.
pub fn hash(picture: &Picture) -> u64 {
    fnv1a(picture.pixels().iter().map(|pixel| u64::from(u32::from_le_bytes(*pixel))))
}
