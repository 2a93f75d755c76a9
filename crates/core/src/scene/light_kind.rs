//! The kinds of light, with the facts that the rest of the program needs.
//!
//! Keys, panels, marks, files and the renderer query these facts (a light's anchor, numbers and
//! name) instead of matching on the kind. A new kind therefore needs a variant with its facts, a
//! form in scene files, a shader, and an action that adds it.

use glam::DVec3;

use super::anchor::{Anchor, AnchorMut, Orbit, SpotOwner};
use super::panorama::SkyPanorama;
use super::tracked::Tracked;
use crate::base::color::Color;

/// The kind of a light.
#[derive(Clone, Debug, PartialEq)]
pub enum LightKind {
    /// Ambient light, from everywhere.
    Ambient,
    /// Light from the sky above and the ground below, with the light's colour above the horizon;
    /// or the light of a panorama, multiplied by the light's colour.
    Sky {
        /// The colour below the horizon, without a panorama.
        ground: Color,
        /// The panorama.
        panorama: Option<SkyPanorama>,
    },
    /// Directional light, from infinitely far away.
    Sun {
        /// The direction of the light's travel, of length 1.
        direction: Tracked<DVec3>,
    },
    /// A point light, in all directions.
    Bulb {
        /// The position.
        position: Tracked<DVec3>,
        /// The circular motion about the world's Y axis.
        orbit: Orbit,
    },
    /// A point light with a cone.
    Spot {
        /// The owner, or a fixed position and direction.
        owner: SpotOwner,
        /// Degrees from the axis to the edge of the cone: 0 to 90.
        half_aperture: f64,
        /// The concentration of the light along the axis: at least 0.
        exponent: f64,
    },
}

/// The facts about a kind of light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LightKindInfo {
    /// The name of new lights.
    pub name: &'static str,
    /// The code point of its icon in the font Material Symbols.
    pub icon: &'static str,
}

/// A number of some kinds of light, apart from position and direction.
#[derive(Debug)]
pub struct LightNumber {
    /// The label next to the field.
    pub label: &'static str,
    /// The name of the field.
    pub name: &'static str,
    /// The hint shown over the field: one sentence.
    pub hint: &'static str,
    /// The name of the undo step that changes the number, before the light's name.
    pub step: &'static str,
    /// The unit, shown after the number.
    pub suffix: &'static str,
    /// The change for each point of dragging.
    pub speed: f64,
    /// The largest number that the field accepts.
    pub most_typed: f64,
    /// The largest valid number; the smallest is 0.
    pub largest: f64,
    /// Reads the number of a light; `None` if the light's kind does not have it.
    pub get: fn(&LightKind) -> Option<f64>,
    /// Returns the number of a light for changing it.
    pub get_mut: fn(&mut LightKind) -> Option<&mut f64>,
}

/// The angle in degrees from the axis to the edge of the cone.
pub static HALF_APERTURE: LightNumber = LightNumber {
    label: "Aperture",
    name: "Half-aperture",
    hint: "Degrees from the axis to the border of the cone; keys + and -",
    step: "Aperture of",
    suffix: " deg",
    speed: 0.2,
    most_typed: 90.0,
    largest: 90.0,
    get: |kind| match kind {
        LightKind::Spot { half_aperture, .. } => Some(*half_aperture),
        LightKind::Ambient
        | LightKind::Sky { .. }
        | LightKind::Sun { .. }
        | LightKind::Bulb { .. } => None,
    },
    get_mut: |kind| match kind {
        LightKind::Spot { half_aperture, .. } => Some(half_aperture),
        LightKind::Ambient
        | LightKind::Sky { .. }
        | LightKind::Sun { .. }
        | LightKind::Bulb { .. } => None,
    },
};

/// The concentration of the light along the axis.
pub static CONCENTRATION: LightNumber = LightNumber {
    label: "Exponent",
    name: "Concentration",
    hint: "Concentration of the light along the axis",
    step: "Concentration of",
    suffix: "",
    speed: 0.1,
    most_typed: 1000.0,
    largest: f64::MAX,
    get: |kind| match kind {
        LightKind::Spot { exponent, .. } => Some(*exponent),
        LightKind::Ambient
        | LightKind::Sky { .. }
        | LightKind::Sun { .. }
        | LightKind::Bulb { .. } => None,
    },
    get_mut: |kind| match kind {
        LightKind::Spot { exponent, .. } => Some(exponent),
        LightKind::Ambient
        | LightKind::Sky { .. }
        | LightKind::Sun { .. }
        | LightKind::Bulb { .. } => None,
    },
};

/// All light numbers, in the order of the properties.
pub static LIGHT_NUMBERS: [&LightNumber; 2] = [&HALF_APERTURE, &CONCENTRATION];

impl LightNumber {
    /// Returns whether a light may have this value.
    pub fn is_valid(&self, number: f64) -> bool {
        (0.0..=self.largest).contains(&number)
    }
}

impl LightKind {
    /// Returns the facts about this kind of light.
    pub const fn info(&self) -> LightKindInfo {
        match self {
            Self::Ambient => LightKindInfo { name: "ambient", icon: "\u{e3e4}" },
            Self::Sky { .. } => LightKindInfo { name: "sky", icon: "\u{e3e4}" },
            Self::Sun { .. } => LightKindInfo { name: "sun", icon: "\u{e518}" },
            Self::Bulb { .. } => LightKindInfo { name: "bulb", icon: "\u{e90f}" },
            Self::Spot { .. } => LightKindInfo { name: "spot", icon: "\u{e25f}" },
        }
    }

    /// Returns the panorama of a sky that has one.
    pub const fn panorama(&self) -> Option<&SkyPanorama> {
        match self {
            Self::Sky { panorama, .. } => panorama.as_ref(),
            Self::Ambient | Self::Sun { .. } | Self::Bulb { .. } | Self::Spot { .. } => None,
        }
    }

    /// Returns the source of the light's position and direction.
    pub const fn anchor(&self) -> Anchor<'_> {
        match self {
            Self::Ambient | Self::Sky { .. } => Anchor::Everywhere,
            Self::Sun { direction } => Anchor::Direction(direction),
            Self::Bulb { position, .. } => Anchor::Position(position),
            Self::Spot { owner, .. } => Anchor::Owner(owner),
        }
    }

    /// Returns the source of the light's position and direction, for changing it.
    pub const fn anchor_mut(&mut self) -> AnchorMut<'_> {
        match self {
            Self::Ambient | Self::Sky { .. } => AnchorMut::Everywhere,
            Self::Sun { direction } => AnchorMut::Direction(direction),
            Self::Bulb { position, .. } => AnchorMut::Position(position),
            Self::Spot { owner, .. } => AnchorMut::Owner(owner),
        }
    }

    /// Returns the circular motion, if lights of this kind can circle.
    pub const fn orbit(&self) -> Option<&Orbit> {
        match self {
            Self::Bulb { orbit, .. } => Some(orbit),
            Self::Ambient | Self::Sky { .. } | Self::Sun { .. } | Self::Spot { .. } => None,
        }
    }

    /// Returns the circular motion, for changing it.
    pub const fn orbit_mut(&mut self) -> Option<&mut Orbit> {
        match self {
            Self::Bulb { orbit, .. } => Some(orbit),
            Self::Ambient | Self::Sky { .. } | Self::Sun { .. } | Self::Spot { .. } => None,
        }
    }

    /// Returns the numbers of the light, each with its description.
    pub fn numbers(&self) -> impl Iterator<Item = (&'static LightNumber, f64)> {
        LIGHT_NUMBERS.iter().filter_map(|row| Some((*row, (row.get)(self)?)))
    }

    /// Returns the owner, if lights of this kind have one.
    pub const fn owner(&self) -> Option<&SpotOwner> {
        match self.anchor() {
            Anchor::Owner(owner) => Some(owner),
            Anchor::Everywhere | Anchor::Direction(_) | Anchor::Position(_) => None,
        }
    }

    /// Returns whether the light has a position and thus fades with distance.
    pub const fn has_position(&self) -> bool {
        match self.anchor() {
            Anchor::Position(_) | Anchor::Owner(_) => true,
            Anchor::Everywhere | Anchor::Direction(_) => false,
        }
    }

    /// Returns whether the light has a direction and thus can be aimed.
    pub const fn has_direction(&self) -> bool {
        match self.anchor() {
            Anchor::Direction(_) | Anchor::Owner(_) => true,
            Anchor::Everywhere | Anchor::Position(_) => false,
        }
    }

    /// Returns whether a diamond marks the light's position in the picture.
    pub const fn has_diamond(&self) -> bool {
        matches!(self.anchor(), Anchor::Position(_))
    }

    /// Returns whether the numbers are valid, and the position and direction finite.
    pub fn is_valid(&self) -> bool {
        let anchored = match self.anchor() {
            Anchor::Everywhere => true,
            Anchor::Direction(v) | Anchor::Position(v) => v.now().is_finite(),
            Anchor::Owner(owner) => owner.fixed().is_none_or(|aim| {
                aim.now().position.is_finite() && aim.now().direction.is_finite()
            }),
        };
        let is_turned = self.panorama().is_none_or(|sky| sky.turn.is_finite());
        anchored && is_turned && self.numbers().all(|(row, number)| row.is_valid(number))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Light;

    #[test]
    fn a_number_of_a_light_is_read_where_it_is_written() {
        for mut light in Light::five() {
            for number in LIGHT_NUMBERS {
                let is_there = (number.get)(&light.kind).is_some();
                match (number.get_mut)(&mut light.kind) {
                    Some(own) => *own = 12.5,
                    None => assert!(!is_there, "{}", number.name),
                }
                assert_eq!((number.get)(&light.kind), is_there.then_some(12.5), "{}", number.name);
            }
            assert!(light.kind.is_valid());
            for number in LIGHT_NUMBERS {
                for wrong in [-1.0, number.largest * 2.0, f64::NAN] {
                    let mut kind = light.kind.clone();
                    if let Some(own) = (number.get_mut)(&mut kind) {
                        *own = wrong;
                        assert!(!kind.is_valid(), "{} {wrong}", number.name);
                    }
                }
            }
        }
    }

    #[test]
    fn a_light_is_changed_where_it_is_anchored() {
        let moved = DVec3::new(1.0, 2.0, 3.0);
        for mut light in Light::five() {
            match light.kind.anchor_mut() {
                AnchorMut::Everywhere => {}
                AnchorMut::Direction(own) | AnchorMut::Position(own) => *own = Tracked::new(moved),
                AnchorMut::Owner(own) => *own = SpotOwner::SelectedCamera,
            }
            let (position, direction) = (light.kind.has_position(), light.kind.has_direction());
            match light.kind.anchor() {
                Anchor::Everywhere => assert!(!position && !direction),
                Anchor::Direction(own) => assert!(*own.now() == moved && !position && direction),
                Anchor::Position(own) => assert!(*own.now() == moved && position && !direction),
                Anchor::Owner(own) => {
                    assert!(*own == SpotOwner::SelectedCamera && position && direction);
                }
            }
        }
    }
}
