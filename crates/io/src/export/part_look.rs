//! The look of a part of an object, as it is exported.

use marraztu_core::base::Shared;
use marraztu_core::scene::{MapKind, Material, SurfaceMap, Texture, Undrawn, UndrawnMap};

/// The look of a part of an object.
#[derive(Clone, Debug)]
pub(super) struct Look {
    /// A unique name.
    pub(super) name: String,
    /// The coefficients. The tint is multiplied into Ka and Kd.
    pub(super) material: Material,
    /// The colour that multiplies texture and vertex colours: Kd, or white if the file names no
    /// material.
    pub(super) base: [f64; 3],
    pub(super) opacity: f64,
    pub(super) texture: Option<Shared<Texture>>,
    /// Whether vertex colours are shown, if there are any.
    pub(super) colored: bool,
    pub(super) two_sided: bool,
    /// Whether Kd and texture are shown without lighting.
    pub(super) unlit: bool,
    /// All maps except the texture, with their height factor.
    pub(super) maps: Vec<(MapKind, SurfaceMap)>,
    /// Numbers of the file's material that this program does not draw.
    pub(super) undrawn: Undrawn,
    /// Maps of the file's material that this program does not draw.
    pub(super) undrawn_maps: Vec<UndrawnMap>,
    /// Roughness and metalness, for glTF.
    pub(super) rough_metal: RoughMetal,
}

impl Look {
    /// Returns the map of a kind.
    pub(super) fn map(&self, kind: MapKind) -> Option<&SurfaceMap> {
        self.maps.iter().find(|(other, _)| *other == kind).map(|(_, map)| map)
    }

    /// Returns a number that this program does not draw.
    pub(super) fn undrawn(&self, keyword: &str) -> Option<f64> {
        self.undrawn.get(keyword)?.first().copied()
    }
}

/// The roughness and metalness of a look: factors, which multiply a texture.
#[derive(Clone, Debug, Default)]
pub(super) struct RoughMetal {
    pub(super) texture: Option<Shared<Texture>>,
    pub(super) roughness: f64,
    pub(super) metalness: f64,
}
