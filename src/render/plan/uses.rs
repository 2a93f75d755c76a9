//! What a frame uses and what it does without, and why: for people to read.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fmt;

use crate::scene::{ItemId, LightId};

/// Something that the renderer can do in a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Effect {
    /// Filled polygons.
    Surfaces,
    /// A light.
    Light(LightId),
    /// The highlights of all lights.
    Highlights,
    /// Positions and normals at every pixel.
    Normals,
    /// Textures.
    Texture,
    /// Looking for the holes of textures.
    AlphaTest,
    /// The colours of vertices.
    VertexColors,
    /// Polygons that are turned away.
    BackFaces,
    /// The edges of polygons.
    Edges,
    /// The normals of faces, as lines.
    FaceNormals,
    /// The normals of vertices, as lines.
    VertexNormals,
    /// The marks of cameras and bulbs.
    Marks,
}

impl Effect {
    /// What it is called; a light has a name of its own.
    #[must_use]
    pub const fn label(self) -> &'static str {
        match self {
            Self::Surfaces => "Surfaces",
            Self::Light(_) => "Light",
            Self::Highlights => "Highlights",
            Self::Normals => "Normals at pixels",
            Self::Texture => "Textures",
            Self::AlphaTest => "AlphaTest of textures",
            Self::VertexColors => "Vertex colours",
            Self::BackFaces => "Back faces",
            Self::Edges => "Edges",
            Self::FaceNormals => "Face normals",
            Self::VertexNormals => "Vertex normals",
            Self::Marks => "Marks",
        }
    }
}

/// An effect on a thing, or on the frame as a whole.
#[derive(Clone, Debug, PartialEq)]
pub struct EffectUse {
    /// What it is.
    pub effect: Effect,
    /// What it is called: a light by its name.
    pub name: String,
    /// The object or camera that it is on; `None` where it is the whole frame's.
    pub on: Option<Thing>,
    /// Whether it is there.
    pub state: State,
    /// How many pixels it takes part in, where that was counted.
    pub pixels: Option<u64>,
}

/// An object, or a camera by its mark.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Thing {
    /// Which one.
    pub item: ItemId,
    /// As the outline calls it.
    pub name: String,
}

/// Whether an effect is there.
#[derive(Clone, Debug, PartialEq)]
pub enum State {
    /// It is computed. With a word about it, where there is one.
    On(Cow<'static, str>),
    /// It is left out, for this reason.
    LeftOut {
        /// In plain words.
        reason: Cow<'static, str>,
        /// What of the picture changes by it.
        class: Class,
    },
}

/// What of the picture changes by leaving something out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Class {
    /// Not a bit.
    Exact,
    /// Each channel by so many steps of a byte at most, before rounding.
    Bounded(f64),
}

impl State {
    /// It is computed, and there is no more to say.
    pub const ON: Self = Self::On(Cow::Borrowed(""));

    /// Left out without any change of the picture.
    pub(super) fn exact(reason: impl Into<Cow<'static, str>>) -> Self {
        Self::LeftOut { reason: reason.into(), class: Class::Exact }
    }

    /// Whether it is computed.
    #[must_use]
    pub const fn is_on(&self) -> bool {
        matches!(self, Self::On(_))
    }

    /// The reason, or the word about what is on.
    #[must_use]
    pub fn why(&self) -> &str {
        match self {
            Self::On(word) => word,
            Self::LeftOut { reason, .. } => reason,
        }
    }
}

/// The reason, with its bound where there is one, or the word about what is on.
impl fmt::Display for State {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.why())?;
        match self {
            Self::LeftOut { class: Class::Bounded(steps), .. } => {
                write!(f, ": at most {steps:.4} of a step")
            }
            _ => Ok(()),
        }
    }
}

/// What planning notes down while it decides; nothing where nobody asked for it.
#[derive(Debug, Default)]
pub(super) struct Notes {
    wanted: bool,
    /// By effect, and by thing in the order of the plan.
    uses: BTreeMap<(Effect, Option<ItemId>), EffectUse>,
}

impl Notes {
    pub(super) fn wanted() -> Self {
        Self { wanted: true, ..Self::default() }
    }

    /// Notes a decision. What is on for one part of an object is on for the object.
    pub(super) fn add(&mut self, make: impl FnOnce() -> EffectUse) {
        if !self.wanted {
            return;
        }
        let new = make();
        let key = (new.effect, new.on.as_ref().map(|thing| thing.item));
        let before = self.uses.entry(key).or_insert_with(|| new.clone());
        if new.state.is_on() && !before.state.is_on() {
            *before = new;
        }
    }

    /// Notes that what was on for a part is left out after all.
    pub(super) fn replace(&mut self, make: impl FnOnce() -> EffectUse) {
        if self.wanted {
            let new = make();
            let key = (new.effect, new.on.as_ref().map(|thing| thing.item));
            self.uses.insert(key, new);
        }
    }

    /// All of them: what is the whole frame's first, then thing by thing.
    pub(super) fn into_uses(self) -> Vec<EffectUse> {
        self.uses.into_values().collect()
    }
}
