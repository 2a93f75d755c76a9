//! How surfaces are coloured: from materials, textures and lights to pipelines.

use std::path::PathBuf;
use std::sync::OnceLock;

use super::bounded;
use super::planning::{Planner, Planning, Shining};
use super::rules::{Covering, Meeting, Reading};
use super::uses::{self, Class, Effect, EffectUse, State};
use crate::accuracy::{Arithmetic, LeaveOut, LightAt, SpecularForm};
use crate::base::image::{Picture, Size};
use crate::base::once::get_or_compute;
use crate::base::{Shared, color::Color};
use crate::render::frame::draw::Form;
use crate::render::frame::draw::{Pipeline, Shaded, Stage};
use crate::render::lights::PhongMaterial;
use crate::render::lights::region::Region;
use crate::render::lights::turning::Turning;
use crate::scene::{ItemId, Object, PartLook, Surface, Texture, Wrap};

/// What the surfaces of an object have in common.
#[derive(Debug)]
pub(super) struct Ground<'a> {
    pub(super) item: ItemId,
    pub(super) object: &'a Object,
    /// Where they are lit, where that is known.
    pub(super) region: Option<Region>,
    /// How they are turned, where that is known.
    pub(super) turning: Option<Turning>,
    /// See [`Shaded::tiled`].
    pub(super) tiled: bool,
    /// Whether their colours are seen at all.
    pub(super) seen: bool,
}

impl Ground<'_> {
    fn thing(&self) -> Option<uses::Thing> {
        Some(uses::Thing { item: self.item, name: self.object.name.clone() })
    }
}

/// What leaves a surface as it is.
fn white() -> &'static Shared<Texture> {
    static WHITE: OnceLock<Shared<Texture>> = OnceLock::new();
    get_or_compute(&WHITE, || {
        Shared::new(Texture {
            source: PathBuf::new(),
            picture: Picture::filled(Size::new(1, 1), [255; 4]).into(),
            wrap: Wrap::Repeat,
            offset: [0.0; 2],
            scale: [1.0; 2],
        })
    })
}

impl Planner<'_> {
    /// How one part of an object is drawn; `None` where its opacity leaves nothing.
    pub(super) fn pipeline_of_part(
        &self,
        into: &mut Planning,
        ground: &Ground<'_>,
        part: u32,
    ) -> Option<u32> {
        let object = ground.object;
        let look = object.part_look(part);
        if look.opacity < 0.5 {
            return None;
        }
        if !ground.seen {
            return Some(into.pipeline(Pipeline::Flat(Color([0; 3]))));
        }
        let mesh = &object.model.mesh;
        let rules = into.plan.rules;
        let texture = look.texture.filter(|_| !mesh.uvs().is_empty());
        let texture = match rules.texture(texture.map(|texture| &**texture)) {
            Some(_) => None,
            None => texture.or_else(|| Some(white()).filter(|_| !mesh.uvs().is_empty())),
        };
        let has_holes = |texture: &&Shared<Texture>| {
            rules.holes(&Covering { texture, opacity: look.opacity }).is_none()
        };
        let colored = object.surface != Surface::Material;
        let shaded = Shaded {
            vertex_colors: colored && !mesh.colors().is_empty(),
            tint: if colored { object.tint.factors() } else { [1.0; 3] },
            texture: texture.cloned(),
            cutout: texture.filter(has_holes).map(|_| look.opacity),
            ..self.lit(into, ground, &look)
        };
        Some(into.pipeline(Pipeline::Shaded(shaded)))
    }

    /// The light of a material.
    fn lit(&self, into: &mut Planning, ground: &Ground<'_>, look: &PartLook<'_>) -> Shaded {
        let matter = coefficients(look);
        let floor = self.floor(into, ground.region.as_ref(), &matter);
        let mut matter = matter.with_floor(floor, self.shot.settings.power);
        let mut shaded = Shaded {
            matter,
            light: None,
            places: false,
            tiled: false,
            dropped: 0.0,
            cut_off: 0.0,
            vertex_colors: false,
            tint: [1.0; 3],
            texture: None,
            cutout: None,
        };
        if ground.object.surface == Surface::Texture {
            return shaded;
        }
        let mut stages = self.stages(into, ground, &matter);
        if self.shot.settings.leave_out == LeaveOut::HalfStep {
            shaded.dropped = self.thin(into, ground, &matter, &mut stages);
            (matter, shaded.cut_off) = self.cut(into, ground, matter, &mut stages);
        }
        shaded.matter = matter;
        shaded.places = into.plan.rules.positions(&Reading::of(stages.iter())).is_none();
        // Tile by tile where some light shines on a part of space only, or is too faint in some.
        shaded.tiled = ground.tiled
            && (self.shot.settings.leave_out == LeaveOut::HalfStep
                || stages.iter().any(|stage| stage.effect.has_reach));
        shaded.light = Some(stages);
        shaded
    }

    /// The power of 2 below which powers of highlights count as 0.
    fn floor(&self, into: &Planning, region: Option<&Region>, matter: &PhongMaterial) -> f64 {
        // By what the scene says, and not by what is left of it after leaving out.
        let with_highlight = |shining: &&Shining| {
            let lamp = &into.plan.lamps[shining.lamp as usize];
            shining.shines
                && matter.mirrors(lamp)
                && (shining.effect.is_noop)(lamp, matter).is_none()
        };
        let lit = || self.shining.iter().filter(with_highlight);
        // A highlight that is stronger than its light reaches further down, and so does one of a light
        // that is stronger where it arrives than where it begins.
        let strongest = matter.specular.iter().fold(1.0_f64, |most, ks| most.max(ks.abs()));
        // Not at vertices: one that a lamp stands on has light beyond measure, and so little of it as is cut
        // off here would be all that its polygons show.
        let arriving = |shining: &Shining| {
            let lamp = &into.plan.lamps[shining.lamp as usize];
            (shining.effect.max_falloff)(lamp, region)
        };
        let arriving = match self.shot.settings.light {
            LightAt::Face | LightAt::Vertex => 1.0,
            LightAt::Pixel | LightAt::Sample => lit().map(arriving).fold(1.0, f64::max),
        };
        let deeper = |floor: f64| (floor - libm::log2(strongest * arriving)).max(LOWEST);
        if self.shot.settings.arithmetic == Arithmetic::F64 {
            return deeper(-24.0);
        }
        let count = lit().count().max(1);
        let count = u32::try_from(count).unwrap_or(u32::MAX);
        // 2^-10 shared out among the highlights, so that all that is left out stays below a quarter of
        // a byte step.
        deeper(-10.0 - libm::log2(f64::from(count)))
    }

    /// The lights that a material needs, in the order of the scene.
    fn stages(
        &self,
        into: &mut Planning,
        ground: &Ground<'_>,
        matter: &PhongMaterial,
    ) -> Vec<Stage> {
        let mut stages = Vec::new();
        let mut no_highlight = Some("no light is on it");
        for Shining { id, name, effect, lamp, .. } in &self.shining {
            let source = into.plan.lamps[*lamp as usize];
            let (region, turning) = (ground.region.as_ref(), ground.turning.as_ref());
            let meeting = Meeting { effect, lamp: &source, matter, region, turning };
            let rules = &into.plan.rules;
            let reason = rules.reflection(&meeting).or_else(|| rules.object(&meeting));
            into.notes.add(|| EffectUse {
                effect: Effect::Light(*id),
                name: name.clone(),
                on: ground.thing(),
                state: reason.map_or(State::ON, State::exact),
                pixels: None,
            });
            if reason.is_some() {
                continue;
            }
            let plain = into.plan.rules.highlight(&meeting);
            if effect.reads_positions {
                no_highlight = no_highlight.and(plain);
            }
            let highlight = match self.shot.settings.specular {
                _ if plain.is_some() => Form::Plain,
                SpecularForm::Reflection => Form::Reflection,
                SpecularForm::HalfVector => Form::HalfVector,
            };
            stages.push(Stage { effect, lamp: *lamp, highlight });
        }
        into.notes.add(|| self.note_highlights(ground, no_highlight.map(State::exact)));
        stages
    }

    fn note_highlights(&self, ground: &Ground<'_>, left_out: Option<State>) -> EffectUse {
        let form = match self.shot.settings.specular {
            SpecularForm::Reflection => "(R.V)^Ns",
            SpecularForm::HalfVector => "(N.H)^Ns",
        };
        EffectUse {
            effect: Effect::Highlights,
            name: Effect::Highlights.label().to_owned(),
            on: ground.thing(),
            state: left_out.unwrap_or(State::On(form.into())),
            pixels: None,
        }
    }

    /// Takes out lights that add too little. Gives what they add, in steps of a byte.
    fn thin(
        &self,
        into: &mut Planning,
        ground: &Ground<'_>,
        matter: &PhongMaterial,
        stages: &mut Vec<Stage>,
    ) -> f64 {
        let Planning { plan, notes, .. } = into;
        let tell = |stage: &Stage, bound: f64| {
            let shining = self.shining.iter().find(|shining| shining.lamp == stage.lamp);
            let Some(Shining { id, name, .. }) = shining else { return };
            notes.replace(|| EffectUse {
                effect: Effect::Light(*id),
                name: name.clone(),
                on: ground.thing(),
                state: State::LeftOut { reason: "too faint".into(), class: Class::Bounded(bound) },
                pixels: None,
            });
        };
        let region = ground.region.as_ref();
        let most =
            |stage: &Stage| bounded::most(stage, &plan.lamps[stage.lamp as usize], matter, region);
        bounded::thin(stages, most, bounded::LIGHTS, tell)
    }

    /// Cuts off the foot of highlights. Gives what that takes away, in steps of a byte.
    fn cut(
        &self,
        into: &mut Planning,
        ground: &Ground<'_>,
        matter: PhongMaterial,
        stages: &mut [Stage],
    ) -> (PhongMaterial, f64) {
        let lit = (&into.plan.lamps[..], &matter);
        let region = ground.region.as_ref();
        let Some(power) = bounded::least_power(stages, lit, region) else { return (matter, 0.0) };
        let floor = libm::log2(power);
        if floor <= matter.floor {
            return (matter, 0.0);
        }
        let cut_off = bounded::cut_off(stages, lit, region, power.min(1.0));
        if power < 1.0 {
            return (matter.with_floor(floor, self.shot.settings.power), cut_off);
        }
        for stage in stages {
            stage.highlight = Form::Plain;
        }
        let class = Class::Bounded(cut_off);
        let faint = State::LeftOut { reason: "too faint".into(), class };
        into.notes.replace(|| self.note_highlights(ground, Some(faint)));
        (matter, cut_off)
    }
}

/// The lowest floor that powers are computed down to.
const LOWEST: f64 = -60.0;

/// The largest coefficient and exponent: beside anything else that light is, it is beyond measure,
/// and it has room in 32 bits.
const LARGEST: f64 = 1e30;

/// What a part reflects. A file may say anything: what is no number reflects nothing, and an exponent
/// below 0 would make a highlight of what is not one.
fn coefficients(look: &PartLook<'_>) -> PhongMaterial {
    let material = look.material;
    let number = |k: f64| if k.is_nan() { 0.0 } else { k };
    let held = |color: [f64; 3]| color.map(|k| number(k).clamp(-LARGEST, LARGEST));
    PhongMaterial {
        ambient: held(material.ambient),
        diffuse: held(material.diffuse),
        specular: held(material.specular),
        exponent: number(material.exponent).clamp(0.0, LARGEST),
        ..PhongMaterial::default()
    }
}
