//! A point in the space of accuracy. Each field is one axis of [`super::AXES`]; the default is what the
//! editor begins with.

use serde::{Deserialize, Serialize};

/// How exactly a picture is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Settings {
    /// The numbers that light is computed in.
    pub arithmetic: Arithmetic,
    /// Where light is evaluated.
    #[serde(rename = "shading", alias = "light")]
    pub light: LightAt,
    /// In how many places of a pixel it is asked what is seen.
    pub samples: Samples,
    /// What a texture gives between its texels.
    pub filter: Filter,
    /// Which form the highlight has.
    pub specular: SpecularForm,
    /// What may be left out of a picture.
    #[serde(rename = "faint")]
    pub leave_out: LeaveOut,
}

/// The numbers that light is computed in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Arithmetic {
    /// 32 bits, sixteen at once.
    #[default]
    F32,
    /// 64 bits, one at a time, with the library's power: the reference.
    F64,
}

/// Where light is evaluated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum LightAt {
    /// Once a polygon, at the mean of its corners (flat shading).
    Face,
    /// At its vertices, interpolated between them (Gouraud).
    Vertex,
    /// At each pixel, with interpolated normals (Phong).
    #[default]
    Pixel,
}

/// In how many places of a pixel it is asked what is seen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Samples {
    /// In its middle.
    #[default]
    One,
    /// In four.
    Four,
    /// In sixteen.
    Sixteen,
    /// In sixty-four: the reference.
    SixtyFour,
}

impl Samples {
    /// From few to many.
    pub const ALL: [Self; 4] = [Self::One, Self::Four, Self::Sixteen, Self::SixtyFour];

    /// How many.
    #[must_use]
    pub const fn count(self) -> u32 {
        match self {
            Self::One => 1,
            Self::Four => 4,
            Self::Sixteen => 16,
            Self::SixtyFour => 64,
        }
    }
}

/// What a texture gives between its texels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Filter {
    /// The texel that the place falls into.
    Nearest,
    /// A mean of the four around it.
    #[default]
    Bilinear,
}

/// Which form the highlight has. The two are different models: neither is an error of the other.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum SpecularForm {
    /// (R.V)^Ns: Phong's.
    #[default]
    Reflection,
    /// (N.H)^Ns, H half-way between L and V: Blinn's.
    HalfVector,
}

/// What may be left out of a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum LeaveOut {
    /// What changes no bit of it.
    #[default]
    #[serde(rename = "Kept")]
    Unseen,
    /// Light, too, that together adds less than half a step of a byte: a byte is one step off at most.
    #[serde(rename = "LeftOut")]
    HalfStep,
}
