//! Explains the effects of an object's surface and lines, finds the pixels they contribute to, and
//! removes them: one row for each effect other than lights.
//!
//! The rows read the finished draw, so the explanation agrees with the picture.

use std::borrow::Cow;

use super::planning::{Planner, Planning};
use super::rules::Reading;
use super::uses::{Effect, EffectState, EffectUse, Thing};
use crate::frame::FramePlan;
use crate::frame::draw::{Back, Draw, Pipeline, Shaded, Stage};
use crate::frame::extras::SurfaceRays;
use crate::lights::Form;
use marraztu_core::accuracy::{Bounces, Filter, LightAt, Settings, Tangents, Transparency};
use marraztu_core::scene::{ItemId, MapKind, Normals, Object, Optics, Reflection, Sides, Surface};

/// The inputs of a row.
struct Facts<'a> {
    settings: &'a Settings,
    object: &'a Object,
    draw: &'a Draw,
    /// The pipelines of the draw's lit or textured parts.
    shaded: Vec<&'a Shaded>,
}

impl Facts<'_> {
    /// Returns the reason why no polygons are filled, if that is so.
    fn unfilled(&self) -> Option<&'static str> {
        if self.object.model.mesh.polygon_count() == 0 {
            Some("it has no faces")
        } else {
            (!self.draw.filled).then_some("edges only")
        }
    }
}

/// A row of the table: an effect, its explanation, and, for effects of surfaces, a test for a
/// surface.
struct Feature(Effect, fn(&Facts<'_>) -> EffectState, Option<fn(&Shaded) -> bool>);

/// The table: one row for each effect of surfaces or lines.
const FEATURES: &[Feature] = &[
    Feature(Effect::Surfaces, surfaces, None),
    Feature(Effect::Normals, normals, None),
    Feature(Effect::Texture, texture, Some(|shaded| shaded.texture.is_some())),
    Feature(Effect::AlphaTest, holes, Some(|shaded| shaded.cutout.is_some())),
    Feature(Effect::Transparency, transparency, Some(|shaded| shaded.opacity.is_some())),
    Feature(Effect::VertexColors, vertex_colors, Some(|shaded| shaded.vertex_colors)),
    Feature(Effect::Emission, emission, Some(|shaded| shaded.extras.emission.is_some())),
    Feature(Effect::Maps, maps, Some(|shaded| shaded.extras.has_maps())),
    Feature(Effect::Bumps, bumps, Some(|shaded| shaded.extras.bump.is_some())),
    Feature(Effect::Mirrors, mirrors, Some(reflects)),
    Feature(Effect::Refraction, refraction, Some(transmits)),
    Feature(Effect::BackFaces, back_faces, None),
    Feature(Effect::Edges, |it| switched(it.draw.lines.edges), None),
    Feature(Effect::FaceNormals, |it| switched(it.draw.lines.face_normals.is_some()), None),
    Feature(Effect::VertexNormals, |it| switched(it.draw.lines.vertex_normals.is_some()), None),
    Feature(Effect::Strokes, strokes, None),
];

/// Returns the effect that represents the presence of an item.
pub(crate) const fn presence(item: ItemId) -> Effect {
    match item {
        ItemId::Object(_) => Effect::Surfaces,
        ItemId::Camera(_) | ItemId::Light(_) => Effect::Marks,
    }
}

/// Iterates over the effects of a surface, except lights.
pub(crate) fn of_surface(shaded: &Shaded) -> impl Iterator<Item = Effect> {
    let there = |row: &&Feature| row.2.is_some_and(|is_in| is_in(shaded));
    FEATURES.iter().filter(there).map(|row| row.0)
}

impl Planner<'_> {
    /// Notes the effects of a draw, except lights.
    pub(super) fn note_features(&self, into: &mut Planning, object: &Object, draw: &Draw) {
        let Planning { plan, notes, .. } = into;
        // A closure, because facts are only collected if explanations are wanted.
        let facts = || {
            let pipelines = draw.part_pipelines.iter().flatten();
            let pipelines = pipelines.map(|pipeline| &plan.pipelines[*pipeline as usize]);
            let shaded = pipelines.filter_map(|pipeline| match pipeline {
                Pipeline::Shaded(shaded) => Some(shaded),
                Pipeline::Flat(_) => None,
            });
            Facts { settings: &self.shot.settings, object, draw, shaded: shaded.collect() }
        };
        let thing = || Some(Thing { item: draw.item, name: object.name.clone() });
        let note = |effect, state| EffectUse::new(effect, thing(), state);
        // Marks have no surface settings, so they get a single row.
        let presence = presence(draw.item);
        if presence == Effect::Marks {
            return notes.add(|| note(presence, EffectState::ON));
        }
        for Feature(effect, state, _) in FEATURES {
            notes.add(|| note(*effect, state(&facts())));
        }
    }
}

impl FramePlan {
    /// Returns the plan without an effect: another picture, and less work. `None` if the plan does
    /// not use the effect, or needs it.
    #[must_use]
    pub fn without(&self, effect: Effect) -> Option<Self> {
        let mut plan = self.clone();
        match effect {
            Effect::Light(id) => {
                let index = self.light_ids.iter().position(|light| *light == id)?;
                plan.for_each_light(|stages| stages.retain(|stage| stage.light as usize != index));
            }
            Effect::Shadows(id) => {
                let index = self.light_ids.iter().position(|light| *light == id)?;
                *plan.shadows.sources.get_mut(index)? = None;
                if let Some(around) = &mut plan.surroundings {
                    *around.shadows.sources.get_mut(index)? = None;
                }
            }
            Effect::Highlights => plan.for_each_light(|stages| {
                stages.iter_mut().for_each(|stage| stage.highlight = Form::Plain);
            }),
            Effect::Texture => plan.for_each_shaded(&|shaded: &mut Shaded| {
                shaded.texture = None;
                // An opacity map can cut holes without the texture.
                if shaded.opacity_map.is_none() {
                    shaded.cutout = None;
                }
            }),
            Effect::AlphaTest => plan.for_each_shaded(&|shaded: &mut Shaded| {
                // A transparent surface keeps its opacity map.
                if shaded.cutout.is_some() {
                    (shaded.cutout, shaded.opacity_map) = (None, None);
                }
            }),
            Effect::Transparency => {
                plan.for_each_shaded(&|shaded: &mut Shaded| shaded.opacity = None);
            }
            Effect::VertexColors => {
                plan.for_each_shaded(&|shaded: &mut Shaded| shaded.vertex_colors = false);
            }
            Effect::Emission => {
                plan.for_each_shaded(&|shaded: &mut Shaded| shaded.extras.emission = None);
            }
            Effect::Maps => plan.for_each_shaded(&|shaded: &mut Shaded| {
                // The ambient glow stays, because its lights are not among the stages.
                shaded.extras.ambient.iter_mut().for_each(|ambient| ambient.map = None);
                (shaded.extras.specular, shaded.extras.exponent) = (None, None);
                for stage in shaded.light.iter_mut().flatten() {
                    stage.is_mapped = false;
                }
            }),
            Effect::Bumps => plan.for_each_shaded(&|shaded: &mut Shaded| shaded.extras.bump = None),
            Effect::Mirrors => {
                plan.for_each_rays(|rays| rays.reflection = Reflection::None);
            }
            Effect::Refraction => {
                plan.for_each_rays(|rays| rays.transmission = [0.0; 3]);
                plan.shadows.block_light();
                if let Some(around) = &mut plan.surroundings {
                    around.shadows.block_light();
                }
            }
            // Exposure is a factor of the lights and costs nothing.
            Effect::Exposure => return None,
            Effect::LinearLight => plan.variants = plan.variants.in_stored_values(),
            Effect::BackFaces => plan.draws.iter_mut().for_each(|draw| draw.back = Back::Culled),
            Effect::Edges => plan.draws.iter_mut().for_each(|draw| draw.lines.edges = false),
            Effect::FaceNormals => {
                plan.draws.iter_mut().for_each(|draw| draw.lines.face_normals = None);
            }
            Effect::VertexNormals => {
                plan.draws.iter_mut().for_each(|draw| draw.lines.vertex_normals = None);
            }
            Effect::Strokes => plan.draws.iter_mut().for_each(|draw| draw.strokes = None),
            Effect::Marks => plan.draws.retain(|draw| matches!(draw.item, ItemId::Object(_))),
            Effect::Surfaces => plan.draws.iter_mut().for_each(|draw| draw.filled = false),
            Effect::Normals => return None,
        }
        // An effect that the plan does not use leaves it unchanged.
        (plan != *self).then_some(plan)
    }

    fn for_each_shaded(&mut self, change: &dyn Fn(&mut Shaded)) {
        for pipeline in &mut self.pipelines {
            if let Pipeline::Shaded(shaded) = pipeline {
                change(shaded);
            }
        }
        if let Some(around) = &mut self.surroundings {
            around.for_each_shaded(change);
        }
    }

    fn for_each_rays(&mut self, change: impl Fn(&mut SurfaceRays)) {
        self.for_each_shaded(&|shaded: &mut Shaded| {
            let rays = &mut shaded.extras.rays;
            rays.iter_mut().for_each(&change);
            *rays = rays.take().filter(|rays| rays.reflects() || rays.transmits());
        });
        if !self.casts_rays() {
            self.surroundings = None;
        }
    }

    fn for_each_light(&mut self, change: impl Fn(&mut Vec<Stage>)) {
        let rules = self.rules;
        self.for_each_shaded(&|shaded: &mut Shaded| {
            if let Some(stages) = &mut shaded.light {
                change(stages);
                // Perhaps none of the remaining lights reads positions.
                shaded.needs_positions = shaded.extras.rays.is_some()
                    || rules.positions(&Reading::of(stages.iter())).is_none();
            }
        });
    }
}

fn switched(on: bool) -> EffectState {
    if on { EffectState::ON } else { EffectState::left_out("switched off") }
}

fn surfaces(it: &Facts<'_>) -> EffectState {
    if let Some(reason) = it.unfilled() {
        EffectState::left_out(reason)
    } else if it.draw.part_pipelines.iter().all(Option::is_none) {
        EffectState::left_out("every part is hidden, or its opacity is too low")
    } else {
        EffectState::ON
    }
}

/// Returns the state "on" if `is` holds for any part of the object.
fn any(
    it: &Facts<'_>,
    is: impl Fn(&Shaded) -> bool,
    word: impl Into<Cow<'static, str>>,
) -> Option<EffectState> {
    it.shaded.iter().any(|shaded| is(shaded)).then(|| EffectState::On(word.into()))
}

fn normals(it: &Facts<'_>) -> EffectState {
    let whose = match it.draw.normals {
        Normals::Vertex => "of vertices, interpolated",
        Normals::Face => "of faces",
    };
    let left_out = it.unfilled().unwrap_or(match it.settings.light {
        LightAt::Face => "light is evaluated at faces",
        LightAt::Vertex => "light is evaluated at vertices",
        LightAt::Pixel | LightAt::Sample => "no light reads them",
    });
    let per_pixel = it.settings.light == LightAt::Pixel;
    any(it, |shaded| per_pixel && shaded.needs_positions, whose)
        .unwrap_or(EffectState::left_out(left_out))
}

fn texture(it: &Facts<'_>) -> EffectState {
    let filter = match it.settings.filter {
        Filter::Nearest => "nearest texel",
        Filter::Bilinear => "bilinear",
        Filter::Trilinear => "trilinear",
        Filter::Anisotropic => "anisotropic",
    };
    // The first reason that applies: the view, the object, the mesh, the file.
    let left_out = if let Some(reason) = it.unfilled() {
        reason
    } else if it.object.surface == Surface::Material {
        "only the material is shown"
    } else if it.object.model.mesh.uvs().is_empty() {
        "the model has no texture coordinates"
    } else {
        "no texture"
    };
    any(it, |shaded| shaded.texture.is_some(), filter).unwrap_or(EffectState::left_out(left_out))
}

fn holes(it: &Facts<'_>) -> EffectState {
    let textured = it.shaded.iter().any(|shaded| shaded.texture.is_some());
    let left_out = if textured { "every texel is opaque" } else { "no texture" };
    let mapped = |shaded: &Shaded| shaded.cutout.is_some() && shaded.opacity_map.is_some();
    if let Some(on) = any(it, mapped, "with map_d") {
        return on;
    }
    any(it, |shaded| shaded.cutout.is_some(), "").unwrap_or(EffectState::left_out(left_out))
}

fn transparency(it: &Facts<'_>) -> EffectState {
    let how = match it.settings.transparency {
        Transparency::Exact => "pixel by pixel, the farthest first",
        Transparency::Objects => "object by object, the farthest first",
        Transparency::Threshold => return EffectState::left_out("a threshold of one half"),
    };
    any(it, |shaded| shaded.opacity.is_some(), how).unwrap_or(EffectState::left_out("it is opaque"))
}

/// Returns whether a part of the object names a map of one of these kinds.
fn names(it: &Facts<'_>, kinds: &[MapKind]) -> bool {
    let parts = u32::try_from(it.object.model.mesh.parts().len()).unwrap_or(u32::MAX);
    let named = |part: u32| kinds.iter().any(|kind| it.object.part_look(part).map(*kind).is_some());
    (0..parts).any(named)
}

fn emission(it: &Facts<'_>) -> EffectState {
    let mapped = any(
        it,
        |shaded| shaded.extras.emission.as_ref().is_some_and(|glow| glow.map.is_some()),
        "Ke times map_Ke",
    );
    let plain = any(it, |shaded| shaded.extras.emission.is_some(), "Ke");
    let left_out = it.unfilled().unwrap_or(match it.object.surface {
        Surface::Texture => "the texture is shown, not lit",
        Surface::Material | Surface::TextureAndLight => "Ke is 0",
    });
    mapped.or(plain).unwrap_or(EffectState::left_out(left_out))
}

fn maps(it: &Facts<'_>) -> EffectState {
    type Reads = fn(&Shaded) -> bool;
    let rows: [(&str, Reads); 3] = [
        ("map_Ka", |shaded| shaded.extras.ambient.is_some()),
        ("map_Ks", |shaded| shaded.extras.specular.is_some()),
        ("map_Ns", |shaded| shaded.extras.exponent.is_some()),
    ];
    let on = rows.iter().filter(|(_, is)| it.shaded.iter().any(|shaded| is(shaded)));
    let on: Vec<&str> = on.map(|(name, _)| *name).collect();
    if !on.is_empty() {
        let mut on = on.join(", ");
        let is_coarse = matches!(it.settings.light, LightAt::Face | LightAt::Vertex);
        if is_coarse && names(it, &[MapKind::Exponent]) {
            on += "; map_Ns needs light at pixels";
        }
        return EffectState::On(on.into());
    }
    let named = names(it, &[MapKind::Ambient, MapKind::Specular, MapKind::Exponent]);
    EffectState::left_out(it.unfilled().unwrap_or(match it.settings.light {
        _ if !named => "the file has none",
        _ if it.object.model.mesh.uvs().is_empty() => "the model has no texture coordinates",
        LightAt::Face | LightAt::Vertex => "no light at pixels reads them",
        LightAt::Pixel | LightAt::Sample => "no light reads them",
    }))
}

fn bumps(it: &Facts<'_>) -> EffectState {
    let heights = |shaded: &Shaded| shaded.extras.bump.as_ref().is_some_and(|it| it.gain.is_some());
    let tangents = match it.settings.tangents {
        Tangents::Vertex => "tangents at vertices",
        Tangents::Pixel => "tangents at pixels",
    };
    let normals = any(it, |shaded| shaded.extras.bump.is_some(), format!("normals, {tangents}"));
    let heights = any(it, heights, format!("heights, {tangents}"));
    let left_out = it.unfilled().unwrap_or(match it.settings.light {
        _ if !names(it, &[MapKind::Bump, MapKind::Normal]) => "the file has none",
        _ if it.object.model.mesh.uvs().is_empty() => "the model has no texture coordinates",
        LightAt::Face => "light is evaluated at faces",
        LightAt::Vertex => "light is evaluated at vertices",
        LightAt::Pixel | LightAt::Sample => "no light reads them, or their -bm is 0",
    });
    // `normals` holds for both kinds of map, so heights are preferred.
    heights.or(normals).unwrap_or(EffectState::left_out(left_out))
}

/// Returns whether a surface mirrors.
fn reflects(shaded: &Shaded) -> bool {
    shaded.extras.rays.as_ref().is_some_and(SurfaceRays::reflects)
}

/// Returns whether light passes through a surface.
fn transmits(shaded: &Shaded) -> bool {
    shaded.extras.rays.as_ref().is_some_and(SurfaceRays::transmits)
}

fn mirrors(it: &Facts<'_>) -> EffectState {
    let is_even = |shaded: &Shaded| {
        let rays = shaded.extras.rays.as_ref();
        rays.is_some_and(|rays| rays.reflection == Reflection::Constant)
    };
    let bounces = it.settings.bounces.count();
    let how = |what: &str| format!("{what}, {bounces} bounces");
    let even = any(it, is_even, how("Ks"));
    let asks = |optics: &Optics| optics.reflection != Reflection::None;
    even.or_else(|| any(it, reflects, how("Ks, more at grazing angles")))
        .unwrap_or_else(|| EffectState::left_out(without_rays(it, asks, "no material mirrors")))
}

fn refraction(it: &Facts<'_>) -> EffectState {
    let bends = |shaded: &Shaded| {
        let rays = shaded.extras.rays.as_ref();
        rays.is_some_and(|it| it.transmits() && it.is_closed && it.index != 1.0)
    };
    let bent = any(it, bends, "Tf, bent by Ni");
    bent.or_else(|| any(it, transmits, "Tf, unbent")).unwrap_or_else(|| {
        EffectState::left_out(without_rays(it, Optics::transmits, "no material lets light through"))
    })
}

/// Returns the reason why an object casts no rays of a kind.
fn without_rays(
    it: &Facts<'_>,
    asks: fn(&Optics) -> bool,
    otherwise: &'static str,
) -> &'static str {
    let parts = u32::try_from(it.object.model.mesh.parts().len()).unwrap_or(u32::MAX);
    let is_asked = (0..parts).any(|part| asks(&it.object.part_look(part).material.optics));
    match it.unfilled() {
        Some(reason) => reason,
        None if !is_asked => otherwise,
        None if it.settings.bounces == Bounces::None => "0 bounces",
        None => "it is not lit, or its Ks, Tf or transparency is 0",
    }
}

fn vertex_colors(it: &Facts<'_>) -> EffectState {
    let left_out = if let Some(reason) = it.unfilled() {
        reason
    } else if it.object.surface == Surface::Material {
        "only the material is shown"
    } else if it.object.model.mesh.colors().is_empty() {
        "the file has none"
    } else {
        "a texture replaces them"
    };
    any(it, |shaded| shaded.vertex_colors, "").unwrap_or(EffectState::left_out(left_out))
}

fn strokes(it: &Facts<'_>) -> EffectState {
    match &it.draw.strokes {
        Some(drawn) if drawn.vertex_colors => EffectState::On("in the colours of vertices".into()),
        Some(_) => EffectState::On("in Kd; without a material, in the colour of edges".into()),
        None if it.object.model.mesh.strokes().is_empty() => {
            EffectState::left_out("the file has none")
        }
        None => EffectState::left_out("they are not shown"),
    }
}

fn back_faces(it: &Facts<'_>) -> EffectState {
    match it.draw.back {
        Back::Culled if it.object.is_two_sided() => EffectState::left_out("no back is visible"),
        Back::Culled if it.object.sides == Sides::Auto => {
            EffectState::left_out("the surface is closed")
        }
        Back::Culled => EffectState::left_out("one side is drawn"),
        Back::Red => EffectState::On("red, not lit".into()),
        Back::Lit if it.draw.culls_opaque => {
            EffectState::On("lit: they show through the front".into())
        }
        Back::Lit if it.object.sides == Sides::Auto => {
            EffectState::On("lit: the surface is open".into())
        }
        Back::Lit => EffectState::On("lit from both sides".into()),
    }
}
