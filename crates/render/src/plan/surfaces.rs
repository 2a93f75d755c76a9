//! Converts materials, textures and lights to pipelines.

use std::sync::OnceLock;

use super::cover::Cover;
use super::maps::{decoded, emission, holds_same_alpha, mapped, mapped_ambient};
use super::planning::{Ground, LARGEST, Planner, Planning, Shining};
use super::rules::{LitSurface, Reading, TexturedSurface};
use super::uses::{Effect, EffectState, EffectUse};
use crate::frame::draw::{Pipeline, Shaded, Stage};
use crate::lights::region::Region;
use crate::lights::{Form, PhongMaterial};
use marraztu_core::accuracy::{Arithmetic, LightAt, SpecularForm};
use marraztu_core::base::image::{Picture, Size};
use marraztu_core::base::once::get_or_compute;
use marraztu_core::base::{
    Shared,
    color::{self, Color},
};
use marraztu_core::scene::{MapKind, PartLook, Surface, Texture};

/// Returns a white texture, which does not change a surface.
fn white() -> &'static Shared<Texture> {
    static WHITE: OnceLock<Shared<Texture>> = OnceLock::new();
    get_or_compute(&WHITE, || {
        Shared::new(Texture::new("", Picture::filled(Size::new(1, 1), [255; 4])))
    })
}

impl Planner<'_> {
    /// Returns the pipeline of one part of an object. `None` if it is too transparent to be drawn.
    pub(super) fn pipeline_of_part(
        &self,
        into: &mut Planning,
        ground: &Ground<'_>,
        part: u32,
    ) -> Option<u32> {
        let object = ground.object;
        let mut look = object.part_look(part);
        let textured = !object.model.mesh.uvs().is_empty();
        let settings = &self.shot.settings;
        let linear = into.plan.variants.are_linear();
        if linear {
            look.material = decoded(&look.material);
        }
        self.settle_transmission(object, &mut look);
        let cover = Cover::of(&look, textured, settings.transparency);
        if cover == Cover::Nothing {
            return None;
        }
        // Only lines are drawn, so the colour does not matter.
        if !ground.seen {
            return Some(into.pipeline(Pipeline::Flat(Color([0; 3]))));
        }
        let mesh = &object.model.mesh;
        let rules = into.plan.rules;
        let texture = look.texture.filter(|_| !mesh.uvs().is_empty());
        let shows_colors = look.shows_colors_with(texture) && !mesh.colors().is_empty();
        // If rules are ignored, a white texture must give the same bytes as no texture.
        let texture = match rules.texture(texture.map(|texture| &**texture)) {
            Some(_) => None,
            None => texture.or_else(|| Some(white()).filter(|_| !mesh.uvs().is_empty())),
        };
        let opacity_map = mapped(ground, &look, MapKind::Opacity).map(|map| &map.texture);
        // A map with the texture's alpha would count twice.
        let opacity_map = opacity_map.filter(|map| !holds_same_alpha(texture, map));
        let surface = TexturedSurface { texture, opacity_map, opacity: look.opacity };
        // A textured part may have holes; an untextured one has the same opacity everywhere.
        let is_textured = texture.is_some() || opacity_map.is_some();
        let has_holes = is_textured && rules.alpha_test(&surface).is_none();
        let colored = object.surface != Surface::Material;
        let mut tint = if colored { object.tint.factors() } else { [1.0; 3] };
        if linear {
            tint = tint.map(color::linear);
        }
        let lit = self.lit(into, ground, (part, &look), texture);
        // Unlit materials show Kd as their colour.
        if look.unlit && object.surface != Surface::Texture {
            tint = std::array::from_fn(|i| tint[i] * lit.material.diffuse[i]);
        }
        let shaded = Shaded {
            vertex_colors: colored && shows_colors,
            tint,
            texture: texture.cloned(),
            cutout: match cover {
                Cover::Threshold(opacity) => has_holes.then_some(opacity),
                Cover::Transparent(_) | Cover::Nothing => None,
            },
            opacity: match cover {
                Cover::Transparent(opacity) => Some(opacity),
                // With a texture, this is an alpha test. Linear values are blended in fixed point,
                // which may round to another byte.
                Cover::Threshold(opacity) => Some(opacity).filter(|_| {
                    !is_textured && !linear && rules.layer(settings.transparency).is_none()
                }),
                Cover::Nothing => None,
            },
            opacity_map: opacity_map
                .filter(|_| has_holes || matches!(cover, Cover::Transparent(_)))
                .cloned(),
            ..lit
        };
        Some(into.pipeline(Pipeline::Shaded(shaded)))
    }

    /// Plans the light of a material.
    fn lit(
        &self,
        into: &mut Planning,
        ground: &Ground<'_>,
        (part, look): (u32, &PartLook<'_>),
        texture: Option<&Shared<Texture>>,
    ) -> Shaded {
        let material = coefficients(look);
        let floor = self.floor(into, ground.region.as_ref(), &material);
        let material = material.with_floor(floor);
        let mut shaded = Shaded::unlit(material);
        if ground.object.surface == Surface::Texture {
            return shaded;
        }
        shaded.extras.emission =
            emission(into.plan.rules, ground, look, self.shot.view.light_factor());
        if look.unlit {
            return shaded;
        }
        // Tilted normals may catch light from behind a face, so bumps are planned before lights.
        let bump = self.bump(into.plan.rules, ground, look);
        let mut stages = self.stages(into, (ground, bump.is_some()), &material);
        shaded.extras.ambient =
            mapped_ambient(into, ground, (look, texture), &material, &mut stages);
        shaded.material = material;
        self.map_highlights(ground, look, &mut shaded.extras, &mut stages);
        shaded.extras.rays = self.rays((&into.plan, ground), (part, look), &material);
        // Rays start along the normals of pixels.
        shaded.needs_positions = shaded.extras.rays.is_some()
            || into.plan.rules.positions(&Reading::of(stages.iter())).is_none();
        // Only lights that read normals show bumps.
        shaded.extras.bump = bump.filter(|_| shaded.needs_positions);
        // Light is culled tile by tile if some light has a limited reach.
        shaded.tiled = ground.tiled && stages.iter().any(|stage| stage.effect.has_reach);
        shaded.light = Some(stages);
        shaded
    }

    /// Computes the floor of highlights: powers below 2^floor count as 0.
    fn floor(&self, into: &Planning, region: Option<&Region>, material: &PhongMaterial) -> f64 {
        // Computed from the scene, before anything is left out.
        let with_highlight = |shining: &&Shining| {
            let light = &into.plan.lights[shining.light as usize];
            shining.shines
                && material.mirrors(light)
                && (shining.effect.is_noop)(light, material).is_none()
        };
        let lit = || self.shining.iter().filter(with_highlight);
        // A highlight that is stronger than its light needs a lower floor. So does a light that is
        // stronger on arrival than at its source.
        let strongest = material.specular.iter().fold(1.0_f64, |most, ks| most.max(ks.abs()));
        // Not at vertices: a vertex very close to a light receives unbounded light, and the little
        // that is cut off here would be all that its polygons show.
        let arriving = |shining: &Shining| {
            let light = &into.plan.lights[shining.light as usize];
            (shining.effect.max_falloff)(light, region)
        };
        let arriving = match self.shot.settings.light {
            LightAt::Face | LightAt::Vertex => 1.0,
            LightAt::Pixel | LightAt::Sample => lit().map(arriving).fold(1.0, f64::max),
        };
        // The sRGB curve is steepest at black: it multiplies differences by 12.92.
        let steepest = if into.plan.variants.are_linear() { 12.92 } else { 1.0 };
        let exposed = self.shot.view.light_factor().max(1.0);
        let times = strongest * arriving * steepest * exposed;
        let deeper = |floor: f64| (floor - libm::log2(times)).max(LOWEST);
        if self.shot.settings.arithmetic == Arithmetic::F64 {
            // The reference keeps much weaker highlights than f32 does.
            return deeper(-24.0);
        }
        let count = lit().count().max(1);
        let count = u32::try_from(count).unwrap_or(u32::MAX);
        // 2^-10 divided among the highlights keeps the sum of all omissions below a quarter of a
        // step of a byte.
        deeper(-10.0 - libm::log2(f64::from(count)))
    }

    /// Returns the lights that a material needs, in the order of the scene.
    fn stages(
        &self,
        into: &mut Planning,
        (ground, is_bumpy): (&Ground<'_>, bool),
        material: &PhongMaterial,
    ) -> Vec<Stage> {
        let mut stages = Vec::new();
        let mut no_highlight = Some("no light falls on it");
        for shining in &self.shining {
            let Shining { id, name, effect, light, .. } = shining;
            let source = into.plan.lights[*light as usize];
            // Bump maps turn normals in any direction.
            let turning = ground.turning.as_deref().filter(|_| !is_bumpy);
            let region = ground.region.as_ref();
            let meeting = LitSurface { effect, light: &source, material, region, turning };
            let rules = &into.plan.rules;
            // A light with an extent reaches around corners that its centre does not.
            let is_soft = into.plan.shadows.radius(*light) > 0.0;
            let elsewhere = || if is_soft { None } else { rules.object(&meeting) };
            let reason = rules.reflection(&meeting).or_else(elsewhere);
            into.notes.add(|| {
                let state = reason.map_or(EffectState::ON, EffectState::left_out);
                let named = EffectUse::new(Effect::Light(*id), ground.thing(), state);
                EffectUse { name: name.clone(), ..named }
            });
            Self::note_shadows(into, ground, shining, reason);
            if reason.is_some() {
                continue;
            }
            let plain = into.plan.rules.highlight(&meeting);
            if effect.reads_positions {
                // One light with a highlight is enough to explain highlights as on.
                no_highlight = no_highlight.and(plain);
            }
            let highlight = match self.shot.settings.specular {
                _ if plain.is_some() => Form::Plain,
                SpecularForm::Reflection => Form::Reflection,
                SpecularForm::HalfVector => Form::HalfVector,
            };
            stages.push(Stage { effect, light: *light, highlight, is_mapped: false });
        }
        let form = match self.shot.settings.specular {
            SpecularForm::Reflection => "(R.V)^Ns",
            SpecularForm::HalfVector => "(N.H)^Ns",
        };
        into.notes.add(|| {
            let state = no_highlight.map_or(EffectState::On(form.into()), EffectState::left_out);
            EffectUse::new(Effect::Highlights, ground.thing(), state)
        });
        stages
    }
}

/// The lowest floor for computing powers.
const LOWEST: f64 = -60.0;

/// Returns the Phong material of a part. Files may hold any number: NaN counts as 0, and exponents
/// below 0 are raised to 0.
fn coefficients(look: &PartLook<'_>) -> PhongMaterial {
    let material = look.material;
    let number = |k: f64| if k.is_nan() { 0.0 } else { k };
    let clamped = |color: [f64; 3]| color.map(|k| number(k).clamp(-LARGEST, LARGEST));
    PhongMaterial {
        ambient: clamped(material.ambient),
        diffuse: clamped(material.diffuse),
        specular: clamped(material.specular),
        exponent: number(material.exponent).clamp(0.0, LARGEST),
        ..PhongMaterial::default()
    }
}
