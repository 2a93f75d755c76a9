//! Which lights of a frame cast shadows, and what casts them.

use std::collections::BTreeSet;

use glam::{DMat4, DVec3};

use super::draw::Stage;
use crate::base::Shared;
use crate::base::math::same_bits;
use crate::scene::{Derived, ItemId, Model, Texture};

/// The shadows of a frame; empty if no light casts any.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Shadows {
    /// For each light of the plan, the end of the rays to it, if it casts shadows.
    pub(crate) sources: Vec<Option<ShadowSource>>,
    /// What casts shadows, the oldest first.
    pub(crate) casters: Vec<Caster>,
}

/// The end of the rays to a light, in world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum ShadowSource {
    /// At a point.
    Point(DVec3),
    /// Infinitely far away in this direction.
    Direction(DVec3),
}

impl ShadowSource {
    fn is_same(&self, other: &Self) -> bool {
        let same =
            |a: &DVec3, b: &DVec3| a.to_array().map(f64::to_bits) == b.to_array().map(f64::to_bits);
        match (self, other) {
            (Self::Point(a), Self::Point(b)) | (Self::Direction(a), Self::Direction(b)) => {
                same(a, b)
            }
            (Self::Point(_), Self::Direction(_)) | (Self::Direction(_), Self::Point(_)) => false,
        }
    }
}

/// An object that casts shadows, seen by the observer or not.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Caster {
    pub(crate) item: ItemId,
    pub(crate) model: Shared<Model>,
    pub(crate) world_from_object: DMat4,
    /// Its parts; `None` for those that are not drawn.
    pub(crate) parts: Vec<Option<CasterPart>>,
    /// The polygons that are drawn, if not all are.
    pub(crate) polygons: Option<BTreeSet<u32>>,
}

/// A part of an object that casts shadows.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct CasterPart {
    /// The texture whose holes let light through, if it has any, and the material's opacity.
    pub(crate) holes: Option<(Shared<Texture>, f64)>,
}

impl Caster {
    /// The part of a triangle, if it is drawn.
    #[inline(always)]
    pub(crate) fn part_of(&self, triangle: u32) -> Option<&CasterPart> {
        let mesh = &self.model.mesh;
        let polygon = mesh.polygon_of(triangle);
        if self.polygons.as_ref().is_some_and(|some| !some.contains(&polygon)) {
            return None;
        }
        self.parts[mesh.polygon_parts()[polygon as usize] as usize].as_ref()
    }

    /// Whether all of its triangles are drawn and have no holes.
    pub(crate) fn is_solid(&self) -> bool {
        let solid =
            |part: &Option<CasterPart>| part.as_ref().is_some_and(|part| part.holes.is_none());
        self.polygons.is_none() && self.parts.iter().all(solid)
    }

    fn is_same(&self, other: &Self) -> bool {
        let Self { item, model, world_from_object, parts, polygons } = self;
        let holes = |a: &Option<CasterPart>, b: &Option<CasterPart>| match (a, b) {
            (Some(a), Some(b)) => match (&a.holes, &b.holes) {
                (Some((a, x)), Some((b, y))) => Shared::same(a, b) && x.to_bits() == y.to_bits(),
                (None, None) => true,
                (Some(_), None) | (None, Some(_)) => false,
            },
            (None, None) => true,
            (Some(_), None) | (None, Some(_)) => false,
        };
        *item == other.item
            && Shared::same(model, &other.model)
            && same_bits(world_from_object, &other.world_from_object)
            && *polygons == other.polygons
            && parts.len() == other.parts.len()
            && parts.iter().zip(&other.parts).all(|(a, b)| holes(a, b))
    }
}

impl Shadows {
    /// Whether any light casts a shadow.
    pub(crate) fn are_cast(&self) -> bool {
        !self.casters.is_empty() && self.sources.iter().any(Option::is_some)
    }

    /// The end of the rays to a light, if it casts shadows.
    #[inline(always)]
    pub(crate) fn source(&self, light: u32) -> Option<ShadowSource> {
        self.sources.get(light as usize).copied().flatten()
    }

    /// Whether any of these lights casts shadows.
    pub(crate) fn any_of(&self, stages: &[Stage]) -> bool {
        self.are_cast() && stages.iter().any(|stage| self.source(stage.light).is_some())
    }

    /// Whether all shadows are where they are in another frame.
    pub(crate) fn is_same(&self, other: &Self) -> bool {
        let cast = |source: &&Option<ShadowSource>| source.is_some();
        let own = self.sources.iter().filter(cast).flatten();
        let others = other.sources.iter().filter(cast).flatten();
        self.casters.len() == other.casters.len()
            && own.clone().count() == others.clone().count()
            && own.zip(others).all(|(a, b)| a.is_same(b))
            && self.casters.iter().zip(&other.casters).all(|(a, b)| a.is_same(b))
    }

    /// Computes what tracing rays reads of the meshes.
    pub(crate) fn prepare(&self) {
        for caster in &self.casters {
            let mesh = &caster.model.mesh;
            mesh.prepare(Derived::RayTree);
            mesh.prepare(Derived::PolygonOf);
        }
    }
}
