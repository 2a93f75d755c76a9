//! The shadows of a frame: lights and casters.

use crate::accel::Accelerated as _;
use std::collections::BTreeSet;

use glam::{DMat4, DVec3};

use super::draw::Stage;
use super::extras::address;
use marraztu_core::accuracy::ShadowMethod;
use marraztu_core::base::Shared;
use marraztu_core::base::math::same_bits;
use marraztu_core::scene::{Derived, ItemId, Model, Texture};

/// The shadows of a frame; empty if no light casts any.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Shadows {
    /// The end of the rays to each light of the plan, if it casts shadows.
    pub(crate) sources: Vec<Option<ShadowSource>>,
    /// The radius of each light of the plan in the world, if it is a ball; 0 for points.
    pub(crate) radii: Vec<f64>,
    /// The samples of a ball or of the sky for each point that is lit.
    pub(crate) samples: u32,
    /// The casters, the oldest first.
    pub(crate) casters: Vec<Caster>,
}

/// The end of the rays to a light, in world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum ShadowSource {
    /// A point.
    Point(DVec3),
    /// A point that shines along a direction, in a cone with this cosine of its half-aperture.
    Cone { at: DVec3, direction: DVec3, cos_half_aperture: f64 },
    /// Infinitely far away in this direction.
    Direction(DVec3),
    /// Infinitely far away in all directions.
    Everywhere,
}

impl ShadowSource {
    /// Returns whether both are the same, bit for bit.
    pub(crate) fn is_same(&self, other: &Self) -> bool {
        self.numbers().map(f64::to_bits) == other.numbers().map(f64::to_bits)
    }

    /// Returns all of its numbers.
    fn numbers(&self) -> [f64; 8] {
        // The first number tells the kinds apart.
        match *self {
            Self::Point(at) => [0.0, at.x, at.y, at.z, 0.0, 0.0, 0.0, 0.0],
            Self::Direction(to) => [1.0, to.x, to.y, to.z, 0.0, 0.0, 0.0, 0.0],
            Self::Everywhere => [3.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
            Self::Cone { at, direction: d, cos_half_aperture } => {
                [2.0, at.x, at.y, at.z, d.x, d.y, d.z, cos_half_aperture]
            }
        }
    }
}

/// An object that casts shadows, even if the observer does not see it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Caster {
    pub(crate) item: ItemId,
    pub(crate) model: Shared<Model>,
    pub(crate) world_from_object: DMat4,
    /// The parts; `None` for parts that are not drawn.
    pub(crate) parts: Vec<Option<CasterPart>>,
    /// The polygons to draw, if not all are drawn.
    pub(crate) polygons: Option<BTreeSet<u32>>,
}

/// A part of an object that casts shadows.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct CasterPart {
    /// The textures with holes for light, if there are any.
    pub(crate) holes: Option<Holes>,
    /// The fraction of light that passes through each of its surfaces, if any does.
    pub(crate) filter: Option<[f64; 3]>,
}

/// The holes of a part: light passes if the product of all three opacities is below one half.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Holes {
    /// The texture with its alpha.
    pub(crate) texture: Option<Shared<Texture>>,
    /// The opacity map: its alpha, or its brightness if the map is opaque everywhere.
    pub(crate) map: Option<Shared<Texture>>,
    /// The opacity of the material and the object.
    pub(crate) opacity: f64,
}

impl CasterPart {
    /// Returns whether it stops all light.
    fn is_solid(&self) -> bool {
        self.holes.is_none() && self.filter.is_none()
    }
}

impl Caster {
    /// Returns whether light passes through any of its parts.
    pub(crate) fn filters(&self) -> bool {
        self.parts.iter().flatten().any(|part| part.filter.is_some())
    }

    /// Returns the part of a triangle, if it is drawn.
    #[inline(always)]
    pub(crate) fn part_of(&self, triangle: u32) -> Option<&CasterPart> {
        let mesh = &self.model.mesh;
        let polygon = mesh.polygon_of(triangle);
        if self.polygons.as_ref().is_some_and(|some| !some.contains(&polygon)) {
            return None;
        }
        self.parts[mesh.polygon_parts()[polygon as usize] as usize].as_ref()
    }

    /// Returns whether all of its triangles are drawn and have no holes.
    pub(crate) fn is_solid(&self) -> bool {
        // A hidden part is not solid either, because the BVH holds its triangles.
        let solid = |part: &Option<CasterPart>| part.as_ref().is_some_and(|part| part.is_solid());
        self.polygons.is_none() && self.parts.iter().all(solid)
    }

    /// Returns whether both cast the same shadows.
    pub(crate) fn is_same(&self, other: &Self) -> bool {
        let Self { item, model, world_from_object, parts, polygons } = self;
        // Textures are compared by address: comparing texels would take too long.
        let key = |Holes { texture, map, opacity }: &Holes| {
            (address(texture), address(map), opacity.to_bits())
        };
        let part_key = |part: &Option<CasterPart>| {
            let bits = |filter: [f64; 3]| filter.map(f64::to_bits);
            part.as_ref().map(|part| (part.holes.as_ref().map(key), part.filter.map(bits)))
        };
        *item == other.item
            && Shared::same(model, &other.model)
            && same_bits(world_from_object, &other.world_from_object)
            && *polygons == other.polygons
            && parts.iter().map(part_key).eq(other.parts.iter().map(part_key))
    }
}

impl Shadows {
    /// Makes all casters opaque for light.
    pub(crate) fn block_light(&mut self) {
        for part in self.casters.iter_mut().flat_map(|caster| &mut caster.parts).flatten() {
            part.filter = None;
        }
    }

    /// Returns whether any light casts a shadow.
    pub(crate) fn are_cast(&self) -> bool {
        !self.casters.is_empty() && self.sources.iter().any(Option::is_some)
    }

    /// Returns the end of the rays to a light, if it casts shadows.
    #[inline(always)]
    pub(crate) fn source(&self, light: u32) -> Option<ShadowSource> {
        self.sources.get(light as usize).copied().flatten()
    }

    /// Returns the radius of a light that casts soft shadows; 0 for others.
    #[inline(always)]
    pub(crate) fn radius(&self, light: u32) -> f64 {
        match self.source(light) {
            Some(_) => self.radii.get(light as usize).copied().unwrap_or(0.0),
            None => 0.0,
        }
    }

    /// Returns whether any light casts soft shadows.
    pub(crate) fn are_soft(&self) -> bool {
        self.are_cast() && (0_u32..).zip(&self.sources).any(|(light, _)| self.radius(light) > 0.0)
    }

    /// Returns whether any of these lights casts shadows.
    pub(crate) fn any_of(&self, stages: &[Stage]) -> bool {
        self.are_cast() && stages.iter().any(|stage| self.source(stage.light).is_some())
    }

    /// Returns whether all shadows equal those of another frame.
    pub(crate) fn is_same(&self, other: &Self) -> bool {
        // A light without shadows may come or go without changing any shadow.
        let cast = |source: &&Option<ShadowSource>| source.is_some();
        let radii = |of: &Self| -> Vec<u64> {
            let cast = (0_u32..).zip(&of.sources).filter(|(_, source)| source.is_some());
            cast.map(|(light, _)| of.radius(light).to_bits()).collect()
        };
        let own = self.sources.iter().filter(cast).flatten();
        let others = other.sources.iter().filter(cast).flatten();
        self.casters.len() == other.casters.len()
            && own.clone().count() == others.clone().count()
            && own.zip(others).all(|(a, b)| a.is_same(b))
            && radii(self) == radii(other)
            && self.casters.iter().zip(&other.casters).all(|(a, b)| a.is_same(b))
    }

    /// Computes what deciding shadows by a method reads of the meshes.
    pub(crate) fn prepare(&self, method: ShadowMethod) {
        let is_searched = self.are_soft();
        for caster in &self.casters {
            let mesh = &caster.model.mesh;
            // Rays need the BVH; maps are rasterised in draw order.
            match method.map() {
                None => _ = mesh.bvh(),
                Some(_) => _ = mesh.draw_order(),
            }
            // Single rays ask for the corners of a triangle.
            if is_searched || caster.filters() {
                _ = mesh.draw_order();
            }
            // Both look up the part of a triangle by its polygon.
            mesh.prepare(Derived::PolygonOf);
        }
    }
}
