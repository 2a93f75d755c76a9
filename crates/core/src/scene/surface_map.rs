//! Maps of a material beside its texture: pictures that change one of its coefficients, or the
//! direction of its normals, from place to place.

use std::collections::BTreeMap;

use super::Texture;
use crate::base::Shared;

/// What a map changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum MapKind {
    /// `map_Ka`: multiplied with Ka, in place of the texture.
    Ambient,
    /// `map_Ks`: multiplied with Ks.
    Specular,
    /// `map_Ns`: its brightness is multiplied with Ns.
    Exponent,
    /// `map_d`: its alpha is multiplied with d, or its brightness if all of it is opaque.
    Opacity,
    /// `map_Ke`: multiplied with Ke.
    Emission,
    /// `bump` and `map_bump`: heights, whose slopes tilt the normals.
    Bump,
    /// `norm`: normals in tangent space, green up.
    Normal,
}

impl MapKind {
    /// All of them.
    pub const ALL: [Self; 7] = [
        Self::Ambient,
        Self::Specular,
        Self::Exponent,
        Self::Opacity,
        Self::Emission,
        Self::Bump,
        Self::Normal,
    ];

    /// Its statement in an MTL file.
    #[must_use]
    pub const fn statement(self) -> &'static str {
        match self {
            Self::Ambient => "map_Ka",
            Self::Specular => "map_Ks",
            Self::Exponent => "map_Ns",
            Self::Opacity => "map_d",
            Self::Emission => "map_Ke",
            Self::Bump => "bump",
            Self::Normal => "norm",
        }
    }

    /// Its name in the interface.
    #[must_use]
    pub const fn label(self) -> &'static str {
        match self {
            Self::Ambient => "Ambient map",
            Self::Specular => "Specular map",
            Self::Exponent => "Exponent map",
            Self::Opacity => "Opacity map",
            Self::Emission => "Emission map",
            Self::Bump => "Bump map",
            Self::Normal => "Normal map",
        }
    }
}

/// A map, and how strong it is.
#[derive(Clone, Debug, PartialEq)]
pub struct SurfaceMap {
    /// The picture, and how it is laid over the surface.
    pub texture: Shared<Texture>,
    /// `-bm`: the factor of heights. A white texel is this many texels high, a black one 0.
    pub gain: f64,
}

/// The maps of a material, by what they change.
pub type SurfaceMaps = BTreeMap<MapKind, SurfaceMap>;
