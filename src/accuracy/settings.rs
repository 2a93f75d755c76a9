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
    /// How powers of highlights are taken.
    pub power: SpecularPower,
    /// How vectors are brought to length 1.
    pub normalising: Normalising,
    /// How colours become bytes.
    pub rounding: Rounding,
    /// How normals are placed.
    pub stretched: NormalMatrix,
    /// The numbers that vertices are placed in.
    pub vertices: VertexArithmetic,
    /// Which parts of a pixel corners are snapped to.
    pub subpixels: Subpixels,
    /// Which pixels a triangle covers.
    pub coverage: Coverage,
    /// How depths are kept.
    pub depth: DepthFormat,
    /// How what corners carry gets to pixels.
    pub interpolation: Interpolation,
}

impl Settings {
    /// Whether pictures are the same, bit for bit, on every processor.
    #[must_use]
    pub fn is_alike_everywhere(&self) -> bool {
        self.normalising == Normalising::Root
    }
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
    /// At each of the places in a pixel that are looked at, as at a pixel's middle.
    Sample,
}

/// In how many places of a pixel it is asked what is seen; written as a number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(into = "u8", try_from = "u8")]
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

impl From<Samples> for u8 {
    fn from(samples: Samples) -> Self {
        match samples {
            Samples::One => 1,
            Samples::Four => 4,
            Samples::Sixteen => 16,
            Samples::SixtyFour => 64,
        }
    }
}

impl TryFrom<u8> for Samples {
    type Error = String;

    fn try_from(count: u8) -> Result<Self, String> {
        let found = Self::ALL.into_iter().find(|samples| u8::from(*samples) == count);
        found.ok_or_else(|| format!("a pixel has 1, 4, 16 or 64 samples, not {count}"))
    }
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
    /// A mean of those that a pixel covers, from pictures of them at smaller sizes.
    Trilinear,
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

/// How powers of highlights are taken.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum SpecularPower {
    /// Schlick's curve, which is none.
    Schlick,
    /// The nearest of 256 in a table.
    Table256,
    /// A line between two of 1024 in a table.
    Table1024,
    /// Whole exponents to 64 by squaring, others by a polynomial: sixteen at once.
    #[default]
    Polynomial,
    /// Exponents that are a power of two by squaring alone; others as [`Self::Polynomial`].
    Squaring,
    /// The library's, one at a time.
    Library,
}

/// How vectors are brought to length 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Normalising {
    /// By the processor's estimate of one by the root. Pictures differ between processors.
    Rsqrt,
    /// By the estimate and a step of Newton's. Pictures differ between processors.
    Newton,
    /// By one by the root, as exact as the numbers are.
    #[default]
    Root,
}

/// How colours become bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Rounding {
    /// What is behind the point is cut off.
    Truncated,
    /// Up or down by a pattern of 8 x 8 pixels.
    Dithered,
    /// To the nearest.
    #[default]
    Nearest,
}

/// How normals are placed with an object that is stretched.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum NormalMatrix {
    /// By the object's own matrix.
    AsItIs,
    /// By its cofactors, which keeps them across the surface.
    #[default]
    Cofactor,
}

/// The numbers that vertices are placed in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum VertexArithmetic {
    /// 32 bits for matrices and vertices.
    F32,
    /// Matrices are multiplied in 64 bits, vertices by them in 32.
    F32ComposedInF64,
    /// 64 bits for both.
    #[default]
    F64,
}

/// Which parts of a pixel corners are snapped to: 2^-bits of it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Subpixels {
    /// Whole pixels.
    Bits0,
    /// 1/16.
    Bits4,
    /// 1/256.
    #[default]
    Bits8,
    /// 1/4096.
    Bits12,
}

/// Which pixels a triangle covers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Coverage {
    /// Where one of the points falls that lie every 0.1 unit of the observer's space on it.
    Points,
    /// Rows between edges that are rounded to whole pixels, both ends with them.
    ScanLines,
    /// Where edge functions of 32-bit numbers are not negative.
    F32Edges,
    /// Where edge functions of whole numbers say so, by the rule of Direct3D and Vulkan.
    #[default]
    Exact,
}

/// How depths are kept.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum DepthFormat {
    /// Whole numbers of 16 bits, 0 near and 65,535 far.
    Bits16,
    /// Whole numbers of 24 bits.
    Bits24,
    /// 32-bit numbers, 0 near and 1 far.
    F32,
    /// 32-bit numbers, 1 near and 0 far.
    #[default]
    F32Reversed,
}

/// How what corners carry gets to pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Interpolation {
    /// Evenly on the screen.
    Affine,
    /// With perspective at every sixteenth pixel of a row, evenly between.
    EverySixteen,
    /// With perspective.
    #[default]
    Perspective,
}
