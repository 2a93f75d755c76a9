//! The settings: one choice for each axis of accuracy.
//!
//! Each field is one axis of [`super::AXES`]; the editor starts with the default. Older scene files
//! may name choices that no longer exist: they are aliases of the default.

use serde::{Deserialize, Serialize};

/// How exactly a picture is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
#[must_use]
#[expect(missing_docs, reason = "the type of each field says it")]
pub struct Settings {
    pub arithmetic: Arithmetic,
    #[serde(rename = "shading", alias = "light")]
    pub light: LightAt,
    pub samples: Samples,
    pub resolution: Resolution,
    pub filter: Filter,
    pub specular: SpecularForm,
    pub rounding: Rounding,
    pub stretched: NormalMatrix,
    pub vertices: VertexArithmetic,
    pub subpixels: Subpixels,
    pub coverage: Coverage,
    pub depth: DepthFormat,
    pub interpolation: Interpolation,
    pub transparency: Transparency,
    pub tangents: Tangents,
    #[serde(rename = "bumps")]
    pub bump_filter: BumpFilter,
    #[serde(rename = "shadow-method")]
    pub shadow_method: ShadowMethod,
    pub terminator: Terminator,
    #[serde(rename = "light-samples")]
    pub light_samples: LightSamples,
    pub bounces: Bounces,
    #[serde(rename = "values")]
    pub light_values: LightValues,
    /// An axis of older scene files.
    #[doc(hidden)]
    #[serde(skip_serializing, rename = "normalising")]
    pub former_normalising: FormerAxis,
    /// An axis of older scene files.
    #[doc(hidden)]
    #[serde(skip_serializing, rename = "faint")]
    pub former_faint: FormerAxis,
    /// An axis of older scene files.
    #[doc(hidden)]
    #[serde(skip_serializing, rename = "power")]
    pub former_power: FormerAxis,
}

/// A former axis in older scene files; its choices saved nothing. Any choice is accepted and
/// ignored.
#[doc(hidden)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct FormerAxis;

impl<'de> Deserialize<'de> for FormerAxis {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        serde::de::IgnoredAny::deserialize(deserializer).map(|_| Self)
    }
}

/// The precision of lighting.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Arithmetic {
    /// 32 bits, sixteen at once, with powers of whole exponents up to 64 by squaring, and others by
    /// a polynomial.
    #[default]
    F32,
    /// 64 bits, one pixel at a time, with the power function of libm: the reference.
    F64,
}

/// Where light is evaluated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum LightAt {
    /// Once per polygon, at the mean of its corners (flat shading).
    Face,
    /// At its vertices, interpolated between them (Gouraud).
    Vertex,
    /// At each pixel, with interpolated normals (Phong).
    #[default]
    Pixel,
    /// At each sample of a pixel.
    Sample,
}

/// Samples per pixel, written as a number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(into = "u16", try_from = "u16")]
pub enum Samples {
    /// One, at the pixel's centre.
    #[default]
    One = 1,
    /// Four.
    Four = 4,
    /// Sixteen.
    Sixteen = 16,
    /// Sixty-four.
    SixtyFour = 64,
    /// Two hundred and fifty-six: the ideal.
    TwoFiftySix = 256,
}

impl From<Samples> for u16 {
    fn from(samples: Samples) -> Self {
        samples as Self
    }
}

impl TryFrom<u16> for Samples {
    type Error = String;

    fn try_from(count: u16) -> Result<Self, String> {
        let found = Self::ALL.into_iter().find(|samples| u16::from(*samples) == count);
        found.ok_or_else(|| format!("a pixel has 1, 4, 16, 64 or 256 samples, not {count}"))
    }
}

impl Samples {
    /// All of them, from one to the ideal.
    pub const ALL: [Self; 5] =
        [Self::One, Self::Four, Self::Sixteen, Self::SixtyFour, Self::TwoFiftySix];

    /// The number of samples.
    pub const fn count(self) -> u32 {
        self as u32
    }
}

/// The part of the pixels that is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Resolution {
    /// Half of the width and height, enlarged with bilinear interpolation.
    Half,
    /// Every pixel.
    #[default]
    Full,
}

/// How a texture is filtered between its texels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Filter {
    /// The nearest texel.
    Nearest,
    /// A weighted mean of the four nearest texels.
    #[default]
    Bilinear,
    /// A mean of the texels that a pixel covers, from mipmaps: a square as wide as the pixel's
    /// longer side on the texture.
    Trilinear,
    /// A mean of the texels that a pixel covers: up to 16 trilinear samples along its longer side.
    Anisotropic,
}

impl Filter {
    /// Returns whether the filter reads smaller copies of the texture.
    pub const fn reads_mips(self) -> bool {
        match self {
            Self::Nearest | Self::Bilinear => false,
            Self::Trilinear | Self::Anisotropic => true,
        }
    }
}

/// The form of the highlight. The two are different models: neither is an error of the other.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum SpecularForm {
    /// (R.V)^Ns: Phong's.
    #[default]
    Reflection,
    /// (N.H)^Ns with H half-way between L and V: Blinn's.
    HalfVector,
}

/// How colours become bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Rounding {
    /// Rounded down.
    Truncated,
    /// Rounded up or down by a pattern of 8 x 8 pixels.
    Dithered,
    /// Rounded to the nearest byte.
    #[default]
    Nearest,
}

/// How the normals of a stretched object are transformed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum NormalMatrix {
    /// By the object's own matrix.
    AsItIs,
    /// By its cofactors, which keep normals perpendicular to the surface.
    #[default]
    Cofactor,
}

/// The precision of vertex transforms.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum VertexArithmetic {
    /// 32 bits for matrices and vertices.
    F32,
    /// 64 bits for both. Older scene files may ask for 64-bit matrices and 32-bit vertices, which
    /// saved no time.
    #[default]
    #[serde(alias = "F32ComposedInF64")]
    F64,
}

/// The fraction of a pixel that vertices are snapped to: 2^-bits.
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
    /// Pixels hit by points on the triangle, one every 0.1 unit in camera space.
    Points,
    /// Rows between edges that are rounded to whole pixels, including both ends.
    ScanLines,
    /// Pixels at which edge functions in 32-bit floating point are not negative.
    F32Edges,
    /// Pixels inside by edge functions in integers, with the rule of Direct3D and Vulkan.
    #[default]
    Exact,
}

/// How depths are stored.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum DepthFormat {
    /// 16-bit integers, 0 at the near plane and 65,535 at the far one.
    Bits16,
    /// 24-bit integers.
    Bits24,
    /// 32-bit floating point, 0 at the near plane and 1 at the far one.
    F32,
    /// 32-bit floating point, 1 at the near plane and 0 at the far one.
    #[default]
    F32Reversed,
}

/// How vertex attributes are interpolated across a triangle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Interpolation {
    /// Linearly on the screen.
    Affine,
    /// With perspective.
    #[default]
    #[serde(alias = "EverySixteen")]
    Perspective,
}

/// How transparent surfaces are blended.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Transparency {
    /// Not at all: surfaces that are less than half opaque are not drawn, others are opaque.
    Threshold,
    /// Object by object, the farthest first; each object triangle by triangle.
    Objects,
    /// Pixel by pixel, the farthest first.
    #[default]
    #[serde(alias = "Weighted")]
    Exact,
}

/// How tangents for bumps are computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Tangents {
    /// At each pixel, from the gradients of the texture coordinates on its triangle.
    Pixel,
    /// At vertices, by MikkTSpace, interpolated between them.
    #[default]
    Vertex,
}

/// How height and normal maps are filtered.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum BumpFilter {
    /// The nearest texel.
    Nearest,
    /// A mean of the texels that a pixel covers, from mipmaps.
    #[default]
    Trilinear,
}

/// The colour space in which light is computed. The two are different models: neither is an error
/// of the other.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum LightValues {
    /// In the values in which colours are stored.
    #[default]
    Stored,
    /// In linear sRGB: colours are decoded, and pictures are encoded.
    Linear,
}

/// How shadows are computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum ShadowMethod {
    /// By a shadow map of 512 x 512 texels.
    Map512,
    /// By a shadow map of 2048 x 2048 texels.
    Map2048,
    /// By the mean of nine texels of such a map.
    Map2048Pcf,
    /// By rays against all triangles, in exact arithmetic.
    #[default]
    #[serde(alias = "Map512Pcf", alias = "Map1024", alias = "Map1024Pcf")]
    #[serde(alias = "Map4096", alias = "Map4096Pcf")]
    Exact,
}

/// How a shadow map is made and read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ShadowMapForm {
    /// Its width and height in texels.
    pub side: usize,
    /// Whether the results of the nine nearest texels are averaged.
    pub is_filtered: bool,
}

impl ShadowMethod {
    /// The form of its shadow maps, if it uses any.
    pub const fn map(self) -> Option<ShadowMapForm> {
        let (side, is_filtered) = match self {
            Self::Map512 => (512, false),
            Self::Map2048 => (2048, false),
            Self::Map2048Pcf => (2048, true),
            Self::Exact => return None,
        };
        Some(ShadowMapForm { side, is_filtered })
    }
}

/// Where shadow rays start on surfaces with vertex normals. The two are different models.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Terminator {
    /// On the triangles.
    #[default]
    Triangles,
    /// On the curved surface that vertex normals suggest.
    Smooth,
}

/// How often a ray is mirrored or refracted, written as a number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(into = "u16", try_from = "u16")]
pub enum Bounces {
    /// Never: surfaces show nothing of their surroundings.
    None = 0,
    /// Once: what mirrors show does not mirror anything.
    One = 1,
    /// Twice.
    Two = 2,
    /// Four times.
    #[default]
    Four = 4,
    /// Eight times.
    Eight = 8,
}

impl Bounces {
    /// All of them, from none to the most.
    pub const ALL: [Self; 5] = [Self::None, Self::One, Self::Two, Self::Four, Self::Eight];

    /// The number of bounces.
    pub const fn count(self) -> u32 {
        self as u32
    }
}

impl From<Bounces> for u16 {
    fn from(bounces: Bounces) -> Self {
        bounces as Self
    }
}

impl TryFrom<u16> for Bounces {
    type Error = String;

    fn try_from(count: u16) -> Result<Self, String> {
        let found = Self::ALL.into_iter().find(|bounces| u16::from(*bounces) == count);
        found.ok_or_else(|| format!("a ray bounces 0, 1, 2, 4 or 8 times, not {count}"))
    }
}

/// The samples of a light with an extent at each point that it lights, written as a number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(into = "u16", try_from = "u16")]
pub enum LightSamples {
    /// One, at its centre: shadows are hard.
    One = 1,
    /// Four.
    Four = 4,
    /// Sixteen.
    #[default]
    Sixteen = 16,
    /// Sixty-four.
    SixtyFour = 64,
    /// Two hundred and fifty-six.
    TwoFiftySix = 256,
}

impl LightSamples {
    /// All of them, from one to the most.
    pub const ALL: [Self; 5] =
        [Self::One, Self::Four, Self::Sixteen, Self::SixtyFour, Self::TwoFiftySix];

    /// The number of samples.
    pub const fn count(self) -> u32 {
        self as u32
    }
}

impl From<LightSamples> for u16 {
    fn from(samples: LightSamples) -> Self {
        samples as Self
    }
}

impl TryFrom<u16> for LightSamples {
    type Error = String;

    fn try_from(count: u16) -> Result<Self, String> {
        let found = Self::ALL.into_iter().find(|samples| u16::from(*samples) == count);
        found.ok_or_else(|| format!("a light has 1, 4, 16, 64 or 256 samples, not {count}"))
    }
}
