//! Plans mirrors and refraction: the rays of surfaces, and what the rays can meet.

use super::maps::mapped;
use super::planning::{Ground, Planner, Planning};
use super::shadows::{LEAST_OF_RAYS, light_samples};
use super::uses::Notes;
use crate::frame::FramePlan;
use crate::frame::extras::{MirroredPanorama, SurfaceRays};
use crate::frame::panorama::PlacedPanorama;
use crate::lights::PhongMaterial;
use marraztu_core::accuracy::{Bounces, LightAt, Samples, Settings};
use marraztu_core::scene::{
    Environment, MapKind, Object, Optics, PartLook, Reflection, SkyPanorama, Surface, Transmission,
};

impl Planner<'_> {
    /// Rays show what the opacity of a part leaves, if its material says so: the part is then
    /// opaque, and its own colour is weaker.
    pub(super) fn settle_transmission(&self, object: &Object, look: &mut PartLook<'_>) {
        if look.material.optics.transmission != Transmission::Opacity {
            return;
        }
        if let Some(filter) = self.filter(object, look) {
            let own = std::mem::replace(&mut look.opacity, 1.0);
            let material = &mut look.material;
            material.optics.transmission = Transmission::Filter(filter);
            for color in [&mut material.ambient, &mut material.diffuse] {
                *color = color.map(|x| x * own);
            }
        }
    }

    /// Returns the fraction of light that passes through a part, if its material says so.
    pub(super) fn filter(&self, object: &Object, look: &PartLook<'_>) -> Option<[f64; 3]> {
        let is_lit = object.surface != Surface::Texture && !look.unlit;
        if !is_lit || self.shot.settings.bounces == Bounces::None {
            return None;
        }
        match look.material.optics.transmission {
            Transmission::None => None,
            Transmission::Opacity => Some([1.0 - share(look.opacity); 3]),
            Transmission::Filter(filter) => Some(filter.map(share)),
        }
        .filter(|filter| *filter != [0.0; 3])
    }

    /// Returns the closed body of glass that each part of an object belongs to, as the number of
    /// its first part: one that is closed by itself, or all open parts of one glass together, if
    /// these are. Files split bodies by groups and materials.
    pub(super) fn bodies(&self, object: &Object) -> Vec<Option<u32>> {
        let mesh = &object.model.mesh;
        let glass = object.shown_parts().filter_map(|part| {
            let optics = object.part_look(part).material.optics;
            (optics.transmission != Transmission::None).then_some((part, optics))
        });
        let mut glass: Vec<(u32, Optics)> = glass.collect();
        if glass.is_empty() || self.shot.settings.bounces == Bounces::None {
            return Vec::new();
        }
        let mut bodies = vec![None; mesh.parts().len()];
        glass.retain(|(part, _)| {
            let is_closed = mesh.are_parts_closed(&[*part]);
            bodies[*part as usize] = is_closed.then_some(*part);
            !is_closed
        });
        while !glass.is_empty() {
            let (first, own) = glass.remove(0);
            let same = glass.extract_if(.., |(_, optics)| *optics == own);
            let same: Vec<u32> = std::iter::once(first).chain(same.map(|(part, _)| part)).collect();
            if mesh.are_parts_closed(&same) {
                same.iter().for_each(|part| bodies[*part as usize] = Some(first));
            }
        }
        bodies
    }

    /// Returns the rays of a lit part, if it mirrors or refracts.
    pub(super) fn rays(
        &self,
        (plan, ground): (&FramePlan, &Ground<'_>),
        (part, look): (u32, &PartLook<'_>),
        material: &PhongMaterial,
    ) -> Option<SurfaceRays> {
        if self.shot.settings.bounces == Bounces::None {
            return None;
        }
        let Optics { reflection, transmission, index } = look.material.optics;
        let specular = material.specular.map(share);
        let is_dark = reflection == Reflection::Constant && specular == [0.0; 3];
        let rays = SurfaceRays {
            reflection: if is_dark { Reflection::None } else { reflection },
            specular,
            transmission: match transmission {
                // See `settle_transmission`.
                Transmission::None | Transmission::Opacity => [0.0; 3],
                Transmission::Filter(filter) => filter.map(share),
            },
            index: if Optics::INDICES.contains(&index) { index } else { 1.0 },
            map: mapped(ground, look, MapKind::Specular).map(|map| map.texture.clone()),
            is_closed: ground.bodies.get(part as usize).copied().flatten().is_some(),
            environment: look.environment.map(|Environment { panorama, is_alone }| {
                let sky = SkyPanorama { panorama: panorama.clone(), turn: 0.0, is_shown: false };
                let is_linear = plan.variants.are_linear();
                let view = plan.view_from_world;
                let panorama = PlacedPanorama::new(&sky, (None, [1.0; 3]), view, is_linear);
                Box::new(MirroredPanorama { panorama, is_alone: *is_alone })
            }),
        };
        (rays.reflects() || rays.transmits()).then_some(rays)
    }

    /// Plans what rays can meet, if any surface of the plan casts rays.
    pub(super) fn add_surroundings(self, into: &mut Planning) {
        if !into.plan.casts_rays() {
            return;
        }
        // What the observer does not see may be seen in a mirror, and no light is left out because
        // of the view. Points that rays meet are no pixels: each is lit.
        let shot = self.shot.with(Settings { light: LightAt::Pixel, ..self.shot.settings });
        let mut plan = FramePlan {
            light_at: LightAt::Pixel,
            lit_by_sample: false,
            draws: Vec::new(),
            pipelines: Vec::new(),
            ..into.plan.clone()
        };
        // A pixel has a ray for each of up to sixteen samples.
        if !plan.shadows.casters.is_empty() {
            let rays = into.plan.samples.count().min(Samples::Sixteen.count());
            plan.shadows.samples = light_samples(&plan, rays, LEAST_OF_RAYS);
        }
        let mut around = Planning::new(plan, Notes::default());
        let Self { observer, shining, .. } = self;
        Planner { shot: &shot, observer, shining, is_around: true }.add_objects(&mut around);
        into.plan.surroundings = Some(Box::new(around.plan));
    }
}

/// Returns the number of the body of each part; nothing if each part is a body of its own.
pub(super) fn numbers_of(bodies: &[Option<u32>]) -> Vec<u32> {
    let numbered = (0..).zip(bodies);
    if numbered.clone().all(|(part, body): (u32, _)| body.is_none_or(|body| body == part)) {
        return Vec::new();
    }
    numbered.map(|(part, body)| body.unwrap_or(part)).collect()
}

/// Returns a fraction from 0 to 1. Files and scripts may hold any number.
fn share(x: f64) -> f64 {
    if x.is_nan() { 0.0 } else { x.clamp(0.0, 1.0) }
}
