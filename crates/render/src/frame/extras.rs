//! Additional properties of a surface beyond light, one texture and vertex colours: emission, maps
//! of its coefficients and normals, mirrors and refraction.

use std::hash::{Hash, Hasher};

use super::panorama::PlacedPanorama;

use marraztu_core::base::Shared;
use marraztu_core::scene::{Reflection, Texture};

/// The additional properties of a surface; none by default.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Extras {
    /// Emission: Ke.
    pub(crate) emission: Option<Glow>,
    /// Ambient light coloured by a separate map: the sum of Ia Ka over all ambient lights, which
    /// are then not among the surface's stages.
    pub(crate) ambient: Option<Glow>,
    /// The map of Ks, which multiplies highlights.
    pub(crate) specular: Option<Shared<Texture>>,
    /// The map of Ns: its brightness multiplies the exponent of highlights.
    pub(crate) exponent: Option<Shared<Texture>>,
    /// The map that tilts normals.
    pub(crate) bump: Option<Bump>,
    /// Mirrors and refraction.
    pub(crate) rays: Option<SurfaceRays>,
}

/// What a surface shows of its surroundings, by rays.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct SurfaceRays {
    pub(crate) reflection: Reflection,
    /// Ks.
    pub(crate) specular: [f64; 3],
    /// The fraction of light that passes through the surface.
    pub(crate) transmission: [f64; 3],
    /// The index of refraction.
    pub(crate) index: f64,
    /// The map of Ks.
    pub(crate) map: Option<Shared<Texture>>,
    /// Whether the surface is closed. Light passes through an open one unbent.
    pub(crate) is_closed: bool,
    /// What is mirrored in place of the background.
    pub(crate) environment: Option<Box<MirroredPanorama>>,
}

/// The environment of a material.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct MirroredPanorama {
    pub(crate) panorama: PlacedPanorama,
    /// Whether nothing else is mirrored.
    pub(crate) is_alone: bool,
}

impl SurfaceRays {
    /// Returns whether the surface mirrors.
    pub(crate) fn reflects(&self) -> bool {
        self.reflection != Reflection::None
    }

    /// Returns whether light passes through the surface.
    pub(crate) fn transmits(&self) -> bool {
        self.transmission != [0.0; 3]
    }

    /// Returns all of its numbers.
    fn numbers(&self) -> [f64; 9] {
        let [r, g, b] = self.specular;
        let [s, t, u] = self.transmission;
        let kind = f64::from(self.reflection as u8);
        [kind, f64::from(u8::from(self.is_closed)), self.index, r, g, b, s, t, u]
    }
}

/// Light that is independent of the point it falls on.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Glow {
    pub(crate) color: [f64; 3],
    /// The map that multiplies it.
    pub(crate) map: Option<Shared<Texture>>,
}

/// A map that tilts normals.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Bump {
    pub(crate) map: Shared<Texture>,
    /// For heights: the height of a white texel, in texels. `None` for normals in tangent space.
    pub(crate) gain: Option<f64>,
}

impl Extras {
    /// Returns whether there are no additional properties.
    pub(crate) const fn is_empty(&self) -> bool {
        let Self { emission, ambient, specular, exponent, bump, rays } = self;
        emission.is_none()
            && ambient.is_none()
            && specular.is_none()
            && exponent.is_none()
            && bump.is_none()
            && rays.is_none()
    }

    /// Returns the emission if it is the same at every pixel, or 0 without emission. `None` if
    /// there is any other property.
    pub(crate) fn even_glow(&self) -> Option<[f64; 3]> {
        let Self { emission, ambient, specular, exponent, bump, rays } = self;
        let is_else = ambient.is_some() || specular.is_some() || exponent.is_some();
        if is_else || bump.is_some() || rays.is_some() {
            return None;
        }
        match emission {
            None => Some([0.0; 3]),
            Some(Glow { color, map: None }) => Some(*color),
            // The map of a glow varies from pixel to pixel.
            Some(Glow { map: Some(_), .. }) => None,
        }
    }

    /// Returns whether the colour of a pixel depends on the map of a glow or of highlights, or on
    /// what rays see.
    pub(crate) fn reads_texels(&self) -> bool {
        self.specular.is_some()
            || self.rays.is_some()
            || self.glows().any(|glow| glow.map.is_some())
    }

    /// Returns whether there is a map of Ka, Ks or Ns.
    pub(crate) const fn has_maps(&self) -> bool {
        self.ambient.is_some() || self.specular.is_some() || self.exponent.is_some()
    }

    /// Iterates over the light added to the surface colour.
    pub(crate) fn glows(&self) -> impl Iterator<Item = &Glow> {
        self.emission.iter().chain(&self.ambient)
    }

    /// Iterates over the maps of colours.
    pub(crate) fn colors(&self) -> impl Iterator<Item = &Shared<Texture>> {
        let of_rays = self.rays.iter().filter_map(|rays| rays.map.as_ref());
        self.glows().filter_map(|glow| glow.map.as_ref()).chain(&self.specular).chain(of_rays)
    }

    /// Returns the names of the stages, for [`FramePlan::keys`](super::FramePlan::keys).
    pub(crate) fn key(&self) -> impl Iterator<Item = &'static str> {
        let Self { emission, ambient, specular, exponent, bump, rays } = self;
        let mapped = |glow: &Option<Glow>| glow.as_ref().is_some_and(|glow| glow.map.is_some());
        [
            ("emission", emission.is_some()),
            ("emission map", mapped(emission)),
            ("ambient map", ambient.is_some()),
            ("specular map", specular.is_some()),
            ("exponent map", exponent.is_some()),
            // Only height maps have a gain.
            ("bump map", bump.as_ref().is_some_and(|bump| bump.gain.is_some())),
            ("normal map", bump.as_ref().is_some_and(|bump| bump.gain.is_none())),
            ("rays", rays.is_some()),
        ]
        .into_iter()
        .filter_map(|(name, is)| is.then_some(name))
    }

    /// Hashes the properties that equal surfaces share; of maps, only their sources.
    pub(crate) fn hash_into(&self, hasher: &mut impl Hasher) {
        let Self { emission, ambient, specular, exponent, bump, rays } = self;
        for glow in [emission, ambient] {
            let glow = glow.as_ref();
            glow.map(|glow| glow.color.map(bits)).hash(hasher);
            glow.and_then(|glow| glow.map.as_ref()).map(|map| &map.source).hash(hasher);
        }
        for map in [specular, exponent] {
            map.as_ref().map(|map| &map.source).hash(hasher);
        }
        bump.as_ref().map(|bump| (&bump.map.source, bump.gain.map(bits))).hash(hasher);
        rays.as_ref().map(|rays| rays.numbers().map(bits)).hash(hasher);
    }

    /// Returns a key that is equal if both are drawn with the same bits. Maps are compared by
    /// identity: comparing pixels would cost more than drawing.
    pub(crate) fn identity(&self) -> impl PartialEq + use<> {
        let Self { emission, ambient, specular, exponent, bump, rays } = self;
        let rays = rays.as_ref().map(|it| {
            let around = it.environment.as_ref();
            let around = around.map(|it| (it.panorama.address(), it.is_alone));
            (it.numbers().map(f64::to_bits), address(&it.map), around)
        });
        let glow = |glow: &Option<Glow>| {
            glow.as_ref().map(|glow| (glow.color.map(f64::to_bits), address(&glow.map)))
        };
        let bump = bump.as_ref();
        let bump = bump.map(|it| (Shared::address(&it.map), it.gain.map(f64::to_bits)));
        (glow(emission), glow(ambient), address(specular), address(exponent), bump, rays)
    }
}

/// Returns the address of a shared value, which tells it from others that are alive.
pub(crate) fn address<T>(shared: &Option<Shared<T>>) -> Option<usize> {
    shared.as_ref().map(Shared::address)
}

/// Returns the bits of a number, equal for 0 and -0.
pub(super) fn bits(x: f64) -> u64 {
    (x + 0.0).to_bits()
}
