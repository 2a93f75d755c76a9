//! The contents of a frame, as plain data. Nothing here makes a decision or touches a pixel.

pub(crate) mod draw;
pub(crate) mod extras;
pub(crate) mod panorama;
mod prepare;
pub(crate) mod program;
pub(crate) mod raster_mode;
pub(crate) mod shading_mode;
pub(crate) mod shadows;
pub(crate) mod variants;

use glam::{DMat4, DVec3};

use self::draw::{Draw, Pipeline};
use self::panorama::PlacedPanorama;
use self::raster_mode::RasterMode;
use self::shading_mode::ShadingMode;
use self::shadows::Shadows;
use self::variants::Variants;
use super::lights::ViewLight;
use marraztu_core::accuracy::{Arithmetic, Filter, LightAt, Samples, Transparency};
use marraztu_core::base::color::Color;
use marraztu_core::base::image::Size;
use marraztu_core::scene::LightId;

/// All data of a frame.
#[derive(Clone, Debug, PartialEq)]
pub struct FramePlan {
    /// The size in pixels: of the whole picture, or of a window of it.
    pub(crate) size: Size,
    /// The size of the whole picture.
    pub(crate) viewport: Viewport,
    /// The size that the picture is enlarged to, if it is drawn at half resolution.
    pub(crate) enlarged: Option<Size>,
    /// The background colour.
    pub(crate) background: Color,
    /// The kind of projection, which determines the direction V to the observer.
    pub(crate) eye: Eye,
    /// The arithmetic of light.
    pub(crate) arithmetic: Arithmetic,
    /// Whether light is evaluated at faces, vertices, pixels or samples.
    pub(crate) light_at: LightAt,
    /// The samples per pixel.
    pub(crate) samples: Samples,
    /// Whether each sample is lit like the centre of a pixel; `light_at` is then `Pixel`.
    pub(crate) lit_by_sample: bool,
    /// The offset of the sample from the centre of its pixel, in subpixels, if each sample is drawn
    /// as a separate picture; in a window, the offset of the window, too.
    pub(crate) shift: [i32; 2],
    /// The number of the sample, if each is drawn as a separate picture; otherwise 0.
    pub(crate) sample: u32,
    /// The distance between samples that are lit, in pixels: textures are filtered for it.
    pub(crate) spacing: f64,
    /// The filter of textures.
    pub(crate) filter: Filter,
    /// The blending method of transparent surfaces.
    pub(crate) transparency: Transparency,
    /// The variants of stages selected by the settings.
    pub(crate) variants: Variants,
    /// The view transform.
    pub(crate) view_from_world: DMat4,
    /// `clip_from_view`.
    pub(crate) clip_from_view: DMat4,
    /// The width of edges and normals in pixels: 1 or 2.
    pub(crate) line_width: i32,
    /// The width of the lines of models, and the diameter of their points, in subpixels.
    pub(crate) stroke_width: i32,
    /// The lights in view space, the oldest first.
    pub(crate) lights: Vec<ViewLight>,
    /// The panoramas of the lights that have one.
    pub(crate) panoramas: Vec<PlacedPanorama>,
    /// The ids of the lights, in the same order.
    pub(crate) light_ids: Vec<LightId>,
    /// The lights that cast shadows, and the casters.
    pub(crate) shadows: Shadows,
    /// The draws, in the order that decides between equal depths.
    pub(crate) draws: Vec<Draw>,
    /// The distinct pipelines of all draws.
    pub(crate) pipelines: Vec<Pipeline>,
    /// What rays can meet, if any surface mirrors or refracts: all objects, whether the picture
    /// shows them or not, with light at pixels.
    pub(crate) surroundings: Option<Box<Self>>,
    /// Whether rules leave out what no pixel shows.
    pub(crate) rules: Rules,
}

/// The width and height of the picture that a projection fills, in pixels of the drawn picture:
/// halves at half resolution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Viewport {
    pub(crate) width: f64,
    pub(crate) height: f64,
}

impl From<Size> for Viewport {
    #[expect(clippy::cast_precision_loss, reason = "pictures have fewer than 2^53 pixels a side")]
    fn from(size: Size) -> Self {
        Self { width: size.width as f64, height: size.height as f64 }
    }
}

/// The direction to the observer, by projection.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Eye {
    /// Perspective: to the origin of view space.
    Point,
    /// Orthographic: along +Z.
    Parallel,
}

/// Whether a frame leaves out work that changes no bit of its picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Rules {
    /// Such work is left out.
    Applied,
    /// Everything the scene names is computed; the rules are tested against this.
    Ignored,
}

impl FramePlan {
    /// Returns the position of the view axis in normalised device coordinates: 0 for a centred
    /// lens. In these coordinates, a point of view space is `x * clip_from_view.x_axis.x` away from
    /// the axis, divided by w.
    pub(crate) fn axis(&self) -> [f64; 2] {
        let m = &self.clip_from_view;
        match self.eye {
            // w is -z.
            Eye::Point => [0.0 - m.z_axis.x, 0.0 - m.z_axis.y],
            Eye::Parallel => [m.w_axis.x, m.w_axis.y],
        }
    }

    /// Returns what rasterisation reads of the settings.
    pub(crate) const fn raster_mode(&self) -> RasterMode {
        self.variants.raster_mode()
    }

    /// Returns what shading reads of the settings.
    pub(crate) fn shading_mode(&self) -> ShadingMode {
        ShadingMode::of(&self.variants)
    }

    /// Returns the plan of the picture seen by one sample of each pixel, `right` and `down` from
    /// the centre, in 1/256 pixel.
    #[must_use]
    pub fn seen_from(&self, [right, down]: [i32; 2]) -> Self {
        let shift = [self.shift[0] + right, self.shift[1] + down];
        Self { shift, ..self.clone() }
    }

    /// Returns whether each pixel is the mean of a square of 16 x 16 samples, each lit. Such
    /// pictures are drawn larger and averaged.
    pub(crate) fn is_supersampled(&self) -> bool {
        self.lit_by_sample && self.samples == Samples::TwoFiftySix
    }

    /// Returns whether a part of the picture can be drawn alone. Enlarged pictures are whole.
    #[must_use]
    pub const fn has_windows(&self) -> bool {
        self.enlarged.is_none()
    }

    /// Returns whether any surface mirrors or refracts.
    #[must_use]
    pub fn casts_rays(&self) -> bool {
        let casts = |pipeline: &Pipeline| match pipeline {
            Pipeline::Shaded(shaded) => shaded.extras.rays.is_some(),
            Pipeline::Flat(_) => false,
        };
        self.pipelines.iter().any(casts)
    }

    /// Returns whether any surface is transparent.
    pub(crate) fn is_transparent(&self) -> bool {
        self.pipelines.iter().any(|pipeline| pipeline.opacity().is_some())
    }

    /// Returns the position of each draw in the order from far to near, by the centres of their
    /// boxes. At equal distances, the younger one counts as farther.
    pub(crate) fn far_to_near(&self) -> Vec<u32> {
        // View space looks along -Z.
        let away = |draw: &Draw| {
            let middle = draw.model.mesh.bounds().map_or(DVec3::ZERO, |bounds| bounds.centre());
            -draw.view_from_object.transform_point3(middle).z
        };
        let mut order: Vec<(f64, usize)> = self.draws.iter().map(away).zip(0..).collect();
        // `total_cmp` also orders NaN.
        order.sort_by(|a, b| b.0.total_cmp(&a.0).then(b.1.cmp(&a.1)));
        // `order` lists draws by position; the result lists positions by draw.
        let mut places = vec![0; order.len()];
        for (place, (_, draw)) in (0..).zip(order) {
            places[draw] = place;
        }
        places
    }

    /// Returns the size of the finished picture in pixels.
    #[must_use]
    pub fn size(&self) -> Size {
        self.enlarged.unwrap_or(self.size)
    }

    /// Returns the stages of each pipeline by name, in order: two frames with the same keys do the
    /// same work for each pixel.
    #[must_use]
    pub fn keys(&self) -> Vec<String> {
        self.pipelines.iter().map(Pipeline::key).collect()
    }
}
