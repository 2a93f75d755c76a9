//! The explanation of one pixel: the surface that it shows, and the terms of its colour.

use glam::DVec3;

use marraztu_core::accuracy::LightAt;
use marraztu_core::base::color;
use marraztu_core::scene::{ItemId, LightId};

/// One pixel of a picture, with the terms of its colour.
#[derive(Clone, Debug, PartialEq)]
pub struct PixelColor {
    /// The column and row, from the upper left.
    pub at: [usize; 2],
    /// The column and row of the drawn pixel, if the picture was drawn at half the size and
    /// enlarged. Its light is explained.
    pub drawn: Option<[usize; 2]>,
    /// The visible surface; `None` for the background or a line.
    pub surface: Option<SurfacePoint>,
    /// The terms of the colour, as factors from 0 to 1. Together with [`Self::rounding`] they add
    /// up to [`Self::color`].
    pub terms: Vec<Term>,
    /// The rounding error of the sum in the arithmetic of the picture.
    pub rounding: [f64; 3],
    /// The colour before clamping to 0 to 1 and rounding to a byte.
    pub color: [f64; 3],
    /// Whether the sum is linear light, which is encoded in sRGB before rounding.
    pub linear: bool,
    /// The bytes of the picture.
    pub bytes: [u8; 3],
}

impl PixelColor {
    /// Adds the part that leads from the colour to these bytes.
    pub(crate) fn lead_to(&mut self, bytes: [u8; 3], part: Part) {
        let value = |stored: f64| if self.linear { color::linear(stored) } else { stored };
        let color = bytes.map(|byte| value(f64::from(byte) / 255.0));
        self.terms.push(Term::new(part, [0, 1, 2].map(|i| color[i] - self.color[i])));
        (self.color, self.bytes) = (color, bytes);
    }
}

/// A point of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// The object, the camera if its mark is shown, or the light if its bulb is shown.
    pub item: ItemId,
    /// The polygon of the item's mesh, from 0.
    pub polygon: u32,
    /// The triangle of the item's mesh, from 0, in the order of the polygons.
    pub triangle: u32,
    /// The barycentric coordinates of the point in the triangle, in space.
    pub weights: DVec3,
    /// The distance along the observer's axis, in world units.
    pub distance: f64,
    /// The point in the world.
    pub position: DVec3,
    /// N, of length 1.
    pub normal: DVec3,
    /// V, of length 1.
    pub to_eye: DVec3,
    /// Whether the back is visible.
    pub back: bool,
    /// The surface colour t, which multiplies ambient and diffuse light: texel, tint and vertex
    /// colour.
    pub own: [f64; 3],
    /// The place where light was evaluated; `None` if the surface is not lit.
    pub light_at: Option<LightAt>,
}

/// A part of a colour.
#[derive(Clone, Debug, PartialEq)]
pub struct Term {
    /// The kind of part.
    pub part: Part,
    /// The light it comes from, if any.
    pub light: Option<LightId>,
    /// Red, green and blue, as factors.
    pub value: [f64; 3],
    /// The path of the light to the point; only in a light's first term.
    pub ray: Option<LightRay>,
    /// The number of transparent layers in front of the term's surface.
    pub layer: u32,
}

impl Term {
    pub(super) const fn new(part: Part, value: [f64; 3]) -> Self {
        Self { part, light: None, value, ray: None, layer: 0 }
    }
}

/// The parts that a colour can have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// The background colour.
    Background,
    /// The colour of an edge or of a drawn normal.
    Line,
    /// The colour of an unlit surface.
    Unlit,
    /// The red of a back face.
    BackFace,
    /// I Ka, times the surface colour.
    Ambient,
    /// I Kd (N.L), times the surface colour.
    Diffuse,
    /// I Ks (R.V)^Ns.
    Specular,
    /// Light that the surface adds independently of the lights: emission, and ambient light with a
    /// separate map.
    Emission,
    /// What the surface mirrors, and what is seen through it by refraction.
    Surroundings,
    /// The light above 1 that is clipped before layers are blended.
    Cut,
    /// The difference between the selected blending method and exact blending.
    Blending,
    /// The difference between the drawn pixel and the pixel of the enlarged picture.
    Enlarged,
    /// The interpolated light of the corners, summed over all lights.
    Corners,
}

impl Part {
    /// Returns the name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Background => "background",
            Self::Line => "line",
            Self::Unlit => "surface, not lit",
            Self::BackFace => "back face",
            Self::Ambient => "ambient",
            Self::Diffuse => "diffuse",
            Self::Specular => "specular",
            Self::Emission => "emission",
            Self::Surroundings => "mirrored and refracted",
            Self::Cut => "clamped to 255",
            Self::Blending => "blending method",
            Self::Enlarged => "mean with neighbours",
            Self::Corners => "light of the corners",
        }
    }
}

/// The path of a light to a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightRay {
    /// L, of length 1, in the world.
    pub to_light: DVec3,
    /// R = 2 (N.L) N - L, in the world.
    pub reflected: DVec3,
    /// N.L
    pub n_l: f64,
    /// R.V, or N.H for Blinn's highlights.
    pub highlight: f64,
    /// Whether the highlight uses N.H.
    pub half_vector: bool,
    /// The distance to the light in world units; `None` for a sun.
    pub distance: Option<f64>,
    /// The attenuation factor for the distance.
    pub attenuation: f64,
    /// The factor of a spot's cone.
    pub cone: f64,
    /// 0 if something blocks the light, else 1.
    pub shadow: f64,
}
