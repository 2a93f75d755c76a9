//! Explains the effects of an object's surface and lines: one row for each effect that is not a
//! light.
//!
//! The rows read the finished draw, so the explanation agrees with what is drawn.

use std::borrow::Cow;

use super::planning::{Planner, Planning};
use super::uses::{Effect, EffectState, EffectUse, Thing};
use crate::accuracy::{Filter, LightAt, Settings, Transparency};
use crate::render::frame::draw::{Back, Draw, Pipeline, Shaded};
use crate::scene::{ItemId, Normals, Object, Sides, Surface};

/// What a row reads.
struct Facts<'a> {
    settings: &'a Settings,
    object: &'a Object,
    draw: &'a Draw,
    /// The pipelines of its lit or textured parts.
    shaded: Vec<&'a Shaded>,
}

/// A row of the table.
struct Feature(Effect, fn(&Facts<'_>) -> EffectState);

/// The table: one row for each effect of surfaces or lines.
const FEATURES: &[Feature] = &[
    Feature(Effect::Surfaces, surfaces),
    Feature(Effect::Normals, normals),
    Feature(Effect::Texture, texture),
    Feature(Effect::AlphaTest, holes),
    Feature(Effect::Transparency, transparency),
    Feature(Effect::VertexColors, vertex_colors),
    Feature(Effect::BackFaces, back_faces),
    Feature(Effect::Edges, |it| switched(it.draw.lines.edges)),
    Feature(Effect::FaceNormals, |it| switched(it.draw.lines.face_normals.is_some())),
    Feature(Effect::VertexNormals, |it| switched(it.draw.lines.vertex_normals.is_some())),
];

/// The effect that stands for an item being drawn at all.
pub(crate) const fn presence(item: ItemId) -> Effect {
    match item {
        ItemId::Object(_) => Effect::Surfaces,
        ItemId::Camera(_) | ItemId::Light(_) => Effect::Marks,
    }
}

impl Planner<'_> {
    /// Notes the effects of a draw that are not lights.
    pub(super) fn note_features(&self, into: &mut Planning, object: &Object, draw: &Draw) {
        let Planning { plan, notes, .. } = into;
        let facts = || {
            let pipelines = draw.part_pipelines.iter().flatten();
            let pipelines = pipelines.map(|pipeline| &plan.pipelines[*pipeline as usize]);
            let shaded = pipelines.filter_map(|pipeline| match pipeline {
                Pipeline::Shaded(shaded) => Some(shaded),
                Pipeline::Flat(_) => None,
            });
            Facts { settings: &self.shot.settings, object, draw, shaded: shaded.collect() }
        };
        let note = |effect: Effect, state: EffectState| EffectUse {
            effect,
            name: effect.label().to_owned(),
            on: Some(Thing { item: draw.item, name: object.name.clone() }),
            state,
            pixels: None,
        };
        let presence = presence(draw.item);
        if presence == Effect::Marks {
            return notes.add(|| note(presence, EffectState::ON));
        }
        for Feature(effect, state) in FEATURES {
            notes.add(|| note(*effect, state(&facts())));
        }
    }
}

fn switched(on: bool) -> EffectState {
    if on { EffectState::ON } else { EffectState::exact("switched off") }
}

fn surfaces(it: &Facts<'_>) -> EffectState {
    if !it.draw.filled {
        EffectState::exact("edges only")
    } else if it.draw.part_pipelines.iter().all(Option::is_none) {
        EffectState::exact("every part is hidden, or its opacity is too low")
    } else {
        EffectState::ON
    }
}

/// On if `is` holds for any part of the object.
fn any(
    it: &Facts<'_>,
    is: impl Fn(&Shaded) -> bool,
    word: Cow<'static, str>,
) -> Option<EffectState> {
    it.shaded.iter().any(|shaded| is(shaded)).then_some(EffectState::On(word))
}

fn normals(it: &Facts<'_>) -> EffectState {
    let whose = match it.draw.normals {
        Normals::Vertex => "of vertices, interpolated",
        Normals::Face => "of faces",
    };
    let left_out = match it.settings.light {
        _ if !it.draw.filled => "edges only",
        LightAt::Face => "light is evaluated at faces",
        LightAt::Vertex => "light is evaluated at vertices",
        LightAt::Pixel | LightAt::Sample => "no light reads them",
    };
    let per_pixel = it.settings.light == LightAt::Pixel;
    any(it, |shaded| per_pixel && shaded.needs_positions, whose.into())
        .unwrap_or(EffectState::exact(left_out))
}

fn texture(it: &Facts<'_>) -> EffectState {
    let filter = match it.settings.filter {
        Filter::Nearest => "nearest texel",
        Filter::Bilinear => "bilinear",
        Filter::Trilinear => "trilinear",
    };
    let left_out = if !it.draw.filled {
        "edges only"
    } else if it.object.surface == Surface::Material {
        "only the material is shown"
    } else if it.object.model.mesh.uvs().is_empty() {
        "the file places none"
    } else {
        "there is none"
    };
    any(it, |shaded| shaded.texture.is_some(), filter.into())
        .unwrap_or(EffectState::exact(left_out))
}

fn holes(it: &Facts<'_>) -> EffectState {
    let textured = it.shaded.iter().any(|shaded| shaded.texture.is_some());
    let left_out = if textured { "every texel is opaque" } else { "no texture" };
    any(it, |shaded| shaded.cutout.is_some(), "".into()).unwrap_or(EffectState::exact(left_out))
}

fn transparency(it: &Facts<'_>) -> EffectState {
    let how = match it.settings.transparency {
        Transparency::Exact => "pixel by pixel, the farthest first",
        Transparency::Objects => "object by object, the farthest first",
        Transparency::Weighted => "a weighted mean",
        Transparency::Threshold => return EffectState::exact("a threshold of one half"),
    };
    any(it, |shaded| shaded.opacity.is_some(), how.into())
        .unwrap_or(EffectState::exact("it is opaque"))
}

fn vertex_colors(it: &Facts<'_>) -> EffectState {
    let left_out = if !it.draw.filled {
        "edges only"
    } else if it.object.surface == Surface::Material {
        "only the material is shown"
    } else {
        "the file has none"
    };
    any(it, |shaded| shaded.vertex_colors, "".into()).unwrap_or(EffectState::exact(left_out))
}

fn back_faces(it: &Facts<'_>) -> EffectState {
    match it.draw.back {
        Back::Culled if it.object.sides == Sides::Auto => {
            EffectState::exact("the surface is closed")
        }
        Back::Culled => EffectState::exact("one side is drawn"),
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
