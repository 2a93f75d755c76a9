//! Explains which effects a frame uses, which it leaves out, and why.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fmt;

use serde::{Deserialize, Serialize};

use marraztu_core::scene::{ItemId, LightId};

/// An effect that the renderer can use in a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub enum Effect {
    /// Filled polygons.
    Surfaces,
    /// A light.
    Light(LightId),
    /// The shadows of a light.
    Shadows(LightId),
    /// The highlights of all lights.
    Highlights,
    /// Positions and normals at every pixel.
    Normals,
    /// Textures.
    Texture,
    /// The alpha test of textures.
    AlphaTest,
    /// Transparent surfaces.
    Transparency,
    /// The colours of vertices.
    VertexColors,
    /// The emission of surfaces.
    Emission,
    /// The maps of Ka, Ks and Ns.
    Maps,
    /// Maps of heights or normals.
    Bumps,
    /// Surfaces that mirror their surroundings.
    Mirrors,
    /// Surfaces that light passes through, bent or unbent.
    Refraction,
    /// Light in linear sRGB.
    LinearLight,
    /// Exposure: a common factor of all light.
    Exposure,
    /// Back faces.
    BackFaces,
    /// The edges of polygons.
    Edges,
    /// The normals of faces, as lines.
    FaceNormals,
    /// The normals of vertices, as lines.
    VertexNormals,
    /// The lines and points of models.
    Strokes,
    /// Helpers: the models of cameras and bulbs.
    Marks,
}

impl Effect {
    /// Returns the label. For a light, use its name instead.
    #[must_use]
    pub const fn label(self) -> &'static str {
        match self {
            Self::Surfaces => "Surfaces",
            Self::Light(_) => "Light",
            Self::Shadows(_) => "Shadows",
            Self::Highlights => "Highlights",
            Self::Normals => "Pixel normals",
            Self::Texture => "Textures",
            Self::AlphaTest => "Alpha test",
            Self::Transparency => "Transparency",
            Self::VertexColors => "Vertex colours",
            Self::Emission => "Emission",
            Self::Maps => "Ka, Ks, Ns maps",
            Self::Bumps => "Bumps",
            Self::Mirrors => "Mirrors",
            Self::Refraction => "Refraction",
            Self::LinearLight => "Linear light",
            Self::Exposure => "Exposure",
            Self::BackFaces => "Back faces",
            Self::Edges => "Edges",
            Self::FaceNormals => "Face normals",
            Self::VertexNormals => "Vertex normals",
            Self::Strokes => "Lines and points",
            Self::Marks => "Markers",
        }
    }
}

/// An effect on an item, or on the whole frame.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct EffectUse {
    /// The effect.
    pub effect: Effect,
    /// The label, or the name of a light.
    pub name: String,
    /// The object or camera; `None` if the effect belongs to the whole frame.
    pub on: Option<Thing>,
    /// Whether the effect is used.
    pub state: EffectState,
    /// The number of pixels it contributes to, if they were counted.
    pub pixels: Option<u64>,
}

impl EffectUse {
    /// Creates the use of an effect that is named by its label.
    pub(super) fn new(effect: Effect, on: Option<Thing>, state: EffectState) -> Self {
        Self { effect, name: effect.label().to_owned(), on, state, pixels: None }
    }
}

/// An object, or a camera drawn as a helper.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Thing {
    /// The id.
    pub item: ItemId,
    /// The name in the outline.
    pub name: String,
}

/// Whether an effect is used.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum EffectState {
    /// It is computed; with a remark, or an empty text.
    On(Cow<'static, str>),
    /// It is left out, for this reason.
    LeftOut(Cow<'static, str>),
}

impl EffectState {
    /// It is computed, without a remark.
    pub const ON: Self = Self::On(Cow::Borrowed(""));

    /// It is left out. No bit of the picture changes by that.
    pub(super) fn left_out(reason: impl Into<Cow<'static, str>>) -> Self {
        Self::LeftOut(reason.into())
    }

    /// Returns whether it is computed.
    #[must_use]
    pub const fn is_on(&self) -> bool {
        matches!(self, Self::On(_))
    }

    /// Returns the reason, or the remark.
    #[must_use]
    pub fn why(&self) -> &str {
        match self {
            Self::On(text) | Self::LeftOut(text) => text,
        }
    }
}

/// The reason, or the remark.
impl fmt::Display for EffectState {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.why())
    }
}

/// The explanations collected while planning decides; empty if they were not requested.
#[derive(Debug, Default)]
pub(super) struct Notes {
    wanted: bool,
    /// The uses by effect, then by item.
    uses: BTreeMap<(Effect, Option<ItemId>), EffectUse>,
}

impl Notes {
    pub(super) fn wanted() -> Self {
        Self { wanted: true, ..Self::default() }
    }

    /// Returns whether decisions are noted.
    pub(super) const fn are_wanted(&self) -> bool {
        self.wanted
    }

    /// Notes a decision. An effect that is on for one part of an object is on for the object.
    pub(super) fn add(&mut self, make: impl FnOnce() -> EffectUse) {
        // Most frames are not explained and format no text.
        if !self.wanted {
            return;
        }
        let new = make();
        let key = (new.effect, new.on.as_ref().map(|thing| thing.item));
        // The first note stays, unless a later part turns the effect on.
        let before = self.uses.entry(key).or_insert_with(|| new.clone());
        if new.state.is_on() && !before.state.is_on() {
            *before = new;
        }
    }

    /// Returns all of them, by effect and then by item.
    pub(super) fn into_uses(self) -> Vec<EffectUse> {
        self.uses.into_values().collect()
    }
}
