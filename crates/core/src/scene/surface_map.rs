//! The maps of a material apart from its texture: pictures that vary a coefficient, or the
//! direction of normals, over the surface.

use std::collections::BTreeMap;

use super::Texture;
use crate::base::Shared;

/// The property that a map changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum MapKind {
    /// `map_Ka`: multiplies Ka, in place of the texture.
    Ambient,
    /// `map_Ks`: multiplies Ks.
    Specular,
    /// `map_Ns`: its brightness multiplies Ns.
    Exponent,
    /// `map_d`: its alpha multiplies d, or its brightness if the picture is opaque.
    Opacity,
    /// `map_Ke`: multiplies Ke.
    Emission,
    /// `bump` and `map_bump`: heights. Their slopes tilt the normals.
    Bump,
    /// `norm`: normals in tangent space, green up.
    Normal,
}

impl MapKind {
    /// All kinds of maps.
    pub const ALL: [Self; 7] = [
        Self::Ambient,
        Self::Specular,
        Self::Exponent,
        Self::Opacity,
        Self::Emission,
        Self::Bump,
        Self::Normal,
    ];

    /// Returns the statement of the map in an MTL file.
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

    /// Returns the name of the map in the interface.
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

/// A map and its strength.
#[derive(Clone, Debug, PartialEq)]
pub struct SurfaceMap {
    /// The picture and its mapping onto the surface.
    pub texture: Shared<Texture>,
    /// The factor `-bm` of heights: the height of a white texel in texels. A black texel has height
    /// 0.
    pub gain: f64,
}

/// The maps of a material, by kind.
pub type SurfaceMaps = BTreeMap<MapKind, SurfaceMap>;
