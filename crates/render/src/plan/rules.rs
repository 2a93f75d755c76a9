//! The rules that leave work out of a frame because it changes no bit of the picture.
//!
//! All rules are here, one function per decision, and planning uses no others. Each returns the
//! reason for leaving something out. [`Rules::Ignored`] leaves nothing out and must give the same
//! picture: this is how the rules are tested.

use super::observer::ObserverSpace;
use super::turning::is_turned_away;
use crate::frame::Rules;
use crate::frame::draw::{Draw, Stage};
use crate::lights::region::Region;
use crate::lights::{LightRow, PhongMaterial, ViewLight};
use glam::DVec3;
use marraztu_core::accuracy::Transparency;
use marraztu_core::base::Shared;
use marraztu_core::scene::{Bounds, Light, SpotOwner, Texture};

/// The reason for leaving something out; `None` if it is kept.
type Verdict = Option<&'static str>;

/// A light, and whether it has a position.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LightFacts<'a> {
    /// The light.
    pub(super) light: &'a Light,
    /// Whether the item the light is fixed to exists, if it is fixed to one.
    pub(super) is_placed: bool,
}

/// A light and a surface.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LitSurface<'a> {
    /// The row of the light's kind.
    pub(super) effect: &'static LightRow,
    /// The light.
    pub(super) light: &'a ViewLight,
    /// The surface.
    pub(super) material: &'a PhongMaterial,
    /// The region of the surface, if it is known.
    pub(super) region: Option<&'a Region>,
    /// The normals of its faces, if they are known.
    pub(super) turning: Option<&'a [DVec3]>,
}

/// The lights of a surface.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Reading {
    /// The number of lights.
    pub(super) lights: usize,
    /// The number of lights that read positions, normals or directions to the observer.
    pub(super) of_positions: usize,
}

impl Reading {
    pub(super) fn of<'a>(stages: impl Iterator<Item = &'a Stage>) -> Self {
        stages.fold(Self::default(), |sum, stage| Self {
            lights: sum.lights + 1,
            of_positions: sum.of_positions + usize::from(stage.effect.reads_positions),
        })
    }
}

/// A placed mesh and its observer.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Thing<'a> {
    pub(super) observer: &'a ObserverSpace,
    pub(super) draw: &'a Draw,
    pub(super) bounds: Bounds,
}

impl Thing<'_> {
    /// Returns whether it is completely outside the view: its box is, and no drawn normals stick
    /// out of the box.
    pub(crate) fn is_outside(&self) -> bool {
        let corners = self.bounds.corners();
        !self.draws_normals() && self.observer.misses(self.draw.clip_from_object, corners)
    }

    /// Returns whether all of its faces are culled as back faces; only tested for small meshes.
    pub(crate) fn is_turned_away(&self) -> bool {
        !self.draws_normals()
            && self.draw.strokes.is_none()
            && is_turned_away(self.draw, self.observer.viewport)
    }

    /// Returns whether it has polygons, and they are filled.
    pub(crate) fn is_filled(&self) -> bool {
        self.draw.filled && self.draw.model.mesh.polygon_count() > 0
    }

    const fn draws_normals(&self) -> bool {
        self.draw.lines.face_normals.is_some() || self.draw.lines.vertex_normals.is_some()
    }
}

/// A texture on a surface.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TexturedSurface<'a> {
    /// The texture, if there is one.
    pub(super) texture: Option<&'a Shared<Texture>>,
    /// The opacity map, if there is one.
    pub(super) opacity_map: Option<&'a Shared<Texture>>,
    /// The factor of alpha. If the product is below one half, the alpha test fails.
    pub(super) opacity: f64,
}

impl TexturedSurface<'_> {
    /// Returns whether each texel passes the alpha test, and thus anything interpolated between
    /// texels.
    pub(crate) fn passes_everywhere(&self) -> bool {
        let least = |byte: u8| f64::from(byte) / 255.0;
        let texture = self.texture.map_or(1.0, |texture| least(texture.picture.least_alpha()));
        let map = self.opacity_map.map_or(1.0, |map| match map.picture.least_alpha() {
            // The brightness counts, and may be 0.
            255 => 0.0,
            alpha => least(alpha),
        });
        texture * map * self.opacity >= 0.5
    }
}

impl Rules {
    /// Decides whether to leave a light out of the whole frame.
    pub(super) fn light(self, it: &LightFacts<'_>) -> Verdict {
        self.verdict(|| {
            because(!it.light.on, "switched off")
                .or_else(|| because(it.light.color.0 == [0; 3], "its colour is black"))
                .or_else(|| without_owner(it))
        })
    }

    /// Decides whether to leave a light out on a surface, at any position.
    pub(super) fn reflection(self, it: &LitSurface<'_>) -> Verdict {
        self.verdict(|| (it.effect.is_noop)(it.light, it.material))
    }

    /// Decides whether to leave a light's highlight out on a surface.
    pub(super) fn highlight(self, it: &LitSurface<'_>) -> Verdict {
        self.verdict(|| because(!it.material.mirrors(it.light), "Ks is 0"))
    }

    /// Decides whether to leave a light out on an object.
    pub(super) fn object(self, it: &LitSurface<'_>) -> Verdict {
        self.verdict(|| (it.effect.is_culled)(it.light, it.region?).or_else(|| behind(it)))
    }

    /// Decides whether to leave a light out on the surfaces of a tile.
    pub(super) fn tile(self, it: &LitSurface<'_>) -> Verdict {
        self.verdict(|| (it.effect.is_culled)(it.light, it.region?))
    }

    /// Decides whether to leave out the positions and normals of fragments.
    pub(super) fn positions(self, it: &Reading) -> Verdict {
        self.verdict(|| because(it.of_positions == 0, "no light reads them"))
    }

    /// Decides whether to leave out the colours of surfaces.
    pub(super) fn surfaces(self, it: &Thing<'_>) -> Verdict {
        self.verdict(|| because(!it.is_filled(), "edges only"))
    }

    /// Decides whether to leave out an object.
    pub(super) fn thing(self, it: &Thing<'_>) -> Verdict {
        self.verdict(|| {
            because(it.is_outside(), "outside the view")
                .or_else(|| because(it.is_turned_away(), "every face is turned away"))
        })
    }

    /// Decides whether to leave out a texture.
    pub(super) fn texture(self, it: Option<&Texture>) -> Verdict {
        self.verdict(|| because(it.is_none(), "there is none"))
    }

    /// Decides whether a surface with an opacity of 1 is drawn as opaque instead of being blended.
    /// Only exact transparency gives the same picture for both.
    pub(super) fn layer(self, transparency: Transparency) -> Verdict {
        let exact = transparency == Transparency::Exact;
        // Other methods give a layer other bytes, so it stays opaque even if rules are ignored.
        self.verdict(|| Some("it is opaque")).or_else(|| because(!exact, "it is opaque"))
    }

    /// Decides whether to leave out the alpha test of a texture.
    pub(super) fn alpha_test(self, it: &TexturedSurface<'_>) -> Verdict {
        self.verdict(|| because(it.passes_everywhere(), "it has no holes"))
    }

    /// Decides whether to leave out the emission of a surface.
    pub(super) fn emission(self, color: [f64; 3]) -> Verdict {
        self.verdict(|| because(color == [0.0; 3], "Ke is 0"))
    }

    /// Decides whether to leave out a bump map.
    pub(super) fn bumps(self, gain: f64) -> Verdict {
        self.verdict(|| because(gain == 0.0, "its -bm is 0"))
    }

    /// Returns the verdict of a rule, if rules apply.
    fn verdict(self, rule: impl FnOnce() -> Verdict) -> Verdict {
        match self {
            Self::Applied => rule(),
            Self::Ignored => None,
        }
    }
}

fn because(left_out: bool, reason: &'static str) -> Verdict {
    left_out.then_some(reason)
}

fn behind(it: &LitSurface<'_>) -> Verdict {
    let is_behind = (it.effect.is_behind)(it.light, it.region?, it.turning?);
    is_behind.then_some("it is behind every face")
}

fn without_owner(it: &LightFacts<'_>) -> Verdict {
    let reason = match it.light.kind.owner() {
        Some(SpotOwner::SelectedObject) => "no object",
        Some(SpotOwner::Object(_) | SpotOwner::Camera(_)) => {
            "the item it is attached to is missing"
        }
        Some(SpotOwner::SelectedCamera | SpotOwner::Fixed(_)) | None => "its position is NaN",
    };
    (!it.is_placed).then_some(reason)
}
