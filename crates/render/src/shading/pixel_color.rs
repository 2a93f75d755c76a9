//! One pixel of a picture explained: what it shows, and the terms that its colour is the sum of.

use glam::DVec3;

use marraztu_core::accuracy::LightAt;
use marraztu_core::scene::{ItemId, LightId};

/// One pixel of a picture, and what its colour is made of.
#[derive(Clone, Debug, PartialEq)]
pub struct PixelColor {
    /// Column and row, from the upper left.
    pub at: [usize; 2],
    /// The surface that is seen there; `None` if it is the background or a line.
    pub surface: Option<SurfacePoint>,
    /// What the colour is made of, as factors from 0 to 1: with [`Self::rounding`] their sum is
    /// [`Self::color`].
    pub terms: Vec<Term>,
    /// What the sum loses in the arithmetic of the picture.
    pub rounding: [f64; 3],
    /// The colour before it is clamped to 0 to 1 and rounded to a byte.
    pub color: [f64; 3],
    /// Whether the sum is linear light, which is encoded in sRGB before it is rounded.
    pub linear: bool,
    /// The bytes of the picture.
    pub bytes: [u8; 3],
}

/// A point of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// The object, the camera whose mark it is, or the bulb's light.
    pub item: ItemId,
    /// The polygon of its mesh.
    pub polygon: u32,
    /// The triangle of its mesh, in the order in which it is drawn.
    pub triangle: u32,
    /// The barycentric coordinates of the point in the triangle, in space.
    pub weights: DVec3,
    /// The distance along the observer's axis, in units of the world.
    pub distance: f64,
    /// The point in the world.
    pub position: DVec3,
    /// N, of length 1.
    pub normal: DVec3,
    /// V, of length 1.
    pub to_eye: DVec3,
    /// Whether its back is seen.
    pub back: bool,
    /// The colour t of the surface, which ambient and diffuse light are multiplied by: texel, tint
    /// and vertex colour.
    pub own: [f64; 3],
    /// Where light was evaluated; `None` if the surface is not lit.
    pub light_at: Option<LightAt>,
}

/// A part of a colour.
#[derive(Clone, Debug, PartialEq)]
pub struct Term {
    /// Which part it is.
    pub part: Part,
    /// The light that it comes from, if it comes from one.
    pub light: Option<LightId>,
    /// Red, green and blue, as factors.
    pub value: [f64; 3],
    /// How the light reaches the point; with a light's first term.
    pub ray: Option<LightRay>,
    /// How many transparent layers lie before what it is the colour of.
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
    /// The colour where nothing is seen.
    Background,
    /// The colour of an edge or of a drawn normal.
    Line,
    /// The colour of what is not lit.
    Unlit,
    /// The red of a back face.
    BackFace,
    /// I Ka, times the colour of the surface.
    Ambient,
    /// I Kd (N.L), times the colour of the surface.
    Diffuse,
    /// I Ks (R.V)^Ns.
    Specular,
    /// What the surface adds to its colour whatever the lights: emission, and ambient light that
    /// has a map of its own.
    Emission,
    /// What is cut off above 1 before layers are blended.
    Cut,
    /// What another way of blending makes of the layers than one over another.
    Blending,
    /// Light of the corners, interpolated: of all lights together.
    Corners,
}

impl Part {
    /// Its name.
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
            Self::Cut => "clamped to 255",
            Self::Blending => "blending method",
            Self::Corners => "light of the corners",
        }
    }
}

/// How a light reaches a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightRay {
    /// L, of length 1, in the world.
    pub to_light: DVec3,
    /// R = 2 (N.L) N - L, in the world.
    pub reflected: DVec3,
    /// N.L
    pub n_l: f64,
    /// R.V, or N.H if highlights are Blinn's.
    pub highlight: f64,
    /// Whether it is N.H.
    pub half_vector: bool,
    /// The distance to the light in units of the world; `None` for a sun.
    pub distance: Option<f64>,
    /// The factor by which distance weakens it.
    pub attenuation: f64,
    /// The factor of a spot's cone.
    pub cone: f64,
    /// 0 where something stands between, else 1.
    pub shadow: f64,
}
