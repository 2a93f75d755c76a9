//! When something is left out of a frame because nothing of the picture changes by it.
//!
//! All rules are one table of functions, and planning asks nothing else. So a rule can be switched off,
//! which draws what it would leave out, and it can be replaced by a wrong one: the proofs of
//! [`lab`](crate::lab) do both, and see that the picture stays and that it does not.

use std::sync::{Arc, OnceLock};

use super::observer::ObserverSpace;
use super::turning::{Turning, is_turned_away};
use super::{Draw, Stage};
use crate::base::once::get_or_compute;
use crate::render::changes::Changes;
use crate::render::effects::{Entry, Lamp, Matter};
use crate::render::region::Region;
use crate::scene::{Bounds, Light, LightKind, SpotOwner, Texture};

/// Why something is left out; `None` where it is not.
pub type Verdict = Option<&'static str>;

/// What a rule decides about, and how.
#[derive(Clone, Copy, Debug)]
pub enum Test {
    /// Whether a light is left out of the whole frame.
    Light(fn(&LightFacts<'_>) -> Verdict),
    /// Whether a light is left out on a surface, wherever that is.
    Reflection(fn(&Meeting<'_>) -> Verdict),
    /// Whether a light's highlight is left out on a surface.
    Highlight(fn(&Meeting<'_>) -> Verdict),
    /// Whether a light is left out on an object.
    Object(fn(&Meeting<'_>) -> Verdict),
    /// Whether a light is left out on what a tile of the picture shows.
    Tile(fn(&Meeting<'_>) -> Verdict),
    /// Whether the places and normals of what is seen are left out.
    Places(fn(&Reading) -> Verdict),
    /// Whether the colours of surfaces are left out.
    Surfaces(fn(&Thing<'_>) -> Verdict),
    /// Whether an object is left out.
    Thing(fn(&Thing<'_>) -> Verdict),
    /// Whether a texture is left out.
    Texture(fn(Option<&Texture>) -> Verdict),
    /// Whether looking for the holes of a texture is left out.
    Holes(fn(&Covering<'_>) -> Verdict),
    /// Whether a whole frame is left out, for what it changes of the last one.
    Frame(fn(&Changes) -> Verdict),
}

/// A rule of the table.
#[derive(Clone, Copy, Debug)]
pub struct Rule {
    /// What it is called in reports.
    pub name: &'static str,
    /// What it decides.
    pub test: Test,
    variant: Variant,
}

/// Whether a rule is that of the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Variant {
    Sound,
    Off,
    Replaced,
}

impl PartialEq for Rule {
    fn eq(&self, other: &Self) -> bool {
        (self.name, self.variant) == (other.name, other.variant)
    }
}

impl Eq for Rule {}

/// A light, and whether there is a place from which it shines.
#[derive(Clone, Copy, Debug)]
pub struct LightFacts<'a> {
    /// The light.
    pub light: &'a Light,
    /// Whether what it is fixed to is there, if it is fixed to anything.
    pub is_placed: bool,
}

/// A light and a surface.
#[derive(Clone, Copy, Debug)]
pub struct Meeting<'a> {
    /// How the light lights.
    pub effect: &'static Entry,
    /// The light.
    pub lamp: &'a Lamp,
    /// The surface.
    pub matter: &'a Matter,
    /// Where the surface is, where that is known.
    pub region: Option<&'a Region>,
    /// How its faces are turned, where that is known.
    pub turning: Option<&'a Turning>,
}

/// The lights of a surface.
#[derive(Clone, Copy, Debug, Default)]
pub struct Reading {
    /// How many they are.
    pub lights: usize,
    /// How many of them look at where a place is, how it is turned, or from where it is seen.
    pub of_places: usize,
}

impl Reading {
    pub(super) fn of<'a>(stages: impl Iterator<Item = &'a Stage>) -> Self {
        stages.fold(Self::default(), |sum, stage| Self {
            lights: sum.lights + 1,
            of_places: sum.of_places + usize::from(stage.effect.reads_places),
        })
    }
}

/// A mesh at its place, seen by somebody.
#[derive(Clone, Copy, Debug)]
pub struct Thing<'a> {
    pub(super) observer: &'a ObserverSpace,
    pub(super) draw: &'a Draw,
    pub(super) bounds: Bounds,
}

impl Thing<'_> {
    /// Whether all of it lies outside the view: its box, and no normals reach out of that.
    #[must_use]
    pub fn is_outside(&self) -> bool {
        let corners = self.bounds.corners();
        !self.draws_normals() && self.observer.misses(self.draw.clip_from_object, corners)
    }

    /// Whether all of its faces are turned away, and so are not drawn; where it has few.
    #[must_use]
    pub fn is_turned_away(&self) -> bool {
        !self.draws_normals() && is_turned_away(self.draw, self.observer.size)
    }

    /// Whether its polygons are filled.
    #[must_use]
    pub const fn is_filled(&self) -> bool {
        self.draw.filled
    }

    const fn draws_normals(&self) -> bool {
        self.draw.lines.face_normals.is_some() || self.draw.lines.vertex_normals.is_some()
    }
}

/// A texture on a surface.
#[derive(Clone, Copy, Debug)]
pub struct Covering<'a> {
    /// The texture.
    pub texture: &'a Texture,
    /// What its alpha is multiplied with; below one half together, nothing is drawn.
    pub opacity: f64,
}

impl Covering<'_> {
    /// Whether something is drawn at each of its texels, and so anywhere between them.
    #[must_use]
    pub fn has_no_holes(&self) -> bool {
        f64::from(self.texture.picture.least_alpha()) / 255.0 * self.opacity >= 0.5
    }
}

/// The table. A new rule is a line here.
const TABLE: &[(&str, Test)] = &[
    ("light off", Test::Light(|it| (!it.light.on).then_some("switched off"))),
    (
        "light black",
        Test::Light(|it| (it.light.color.0 == [0; 3]).then_some("its colour is black")),
    ),
    ("light without an owner", Test::Light(without_owner)),
    ("coefficients 0", Test::Reflection(|it| (it.effect.needless)(it.lamp, it.matter))),
    ("Ks 0", Test::Highlight(|it| (!it.matter.mirrors(it.lamp)).then_some("Ks is 0"))),
    ("object beyond the light", Test::Object(|it| (it.effect.misses)(it.lamp, it.region?))),
    ("light behind the faces", Test::Object(behind)),
    ("tile beyond the light", Test::Tile(|it| (it.effect.misses)(it.lamp, it.region?))),
    ("normals not needed", Test::Places(|it| (it.of_places == 0).then_some("no light reads them"))),
    ("surfaces not filled", Test::Surfaces(|it| (!it.is_filled()).then_some("edges only"))),
    ("outside the view", Test::Thing(|it| it.is_outside().then_some("outside the view"))),
    ("turned away", Test::Thing(|it| it.is_turned_away().then_some("every face is turned away"))),
    ("no texture", Test::Texture(|it| it.is_none().then_some("there is none"))),
    ("texture without holes", Test::Holes(|it| it.has_no_holes().then_some("it has no holes"))),
    ("unchanged", Test::Frame(|it| it.is_nothing().then_some("nothing has changed"))),
];

fn behind(it: &Meeting<'_>) -> Verdict {
    let is_behind = (it.effect.is_behind)(it.lamp, it.region?, it.turning?);
    is_behind.then_some("it comes from behind every face")
}

fn without_owner(it: &LightFacts<'_>) -> Verdict {
    let reason = match &it.light.kind {
        LightKind::Spot { owner: SpotOwner::SelectedObject, .. } => "no object",
        LightKind::Spot { owner: SpotOwner::Object(_) | SpotOwner::Camera(_), .. } => {
            "what it is fixed to is not there"
        }
        _ => "its place is no number",
    };
    (!it.is_placed).then_some(reason)
}

/// The rules that a frame is planned by.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Rules(Vec<Rule>);

impl Rules {
    /// How many there are.
    pub const COUNT: usize = TABLE.len();

    /// The rules of the table.
    #[must_use]
    pub fn sound() -> Arc<Self> {
        static SOUND: OnceLock<Arc<Rules>> = OnceLock::new();
        Arc::clone(get_or_compute(&SOUND, || Arc::new(Self::of(Variant::Sound))))
    }

    /// The same with every rule switched off: everything that a scene names is computed.
    #[must_use]
    pub fn off() -> Arc<Self> {
        let mut rules = Self::of(Variant::Off);
        for rule in &mut rules.0 {
            rule.test = rule.test.never();
        }
        Arc::new(rules)
    }

    /// The rules of the table with one of them, by its name, replaced.
    #[must_use]
    pub fn with(name: &str, replace: impl FnOnce(Test) -> Test) -> Option<Arc<Self>> {
        let mut rules = Self::of(Variant::Sound);
        let rule = rules.0.iter_mut().find(|rule| rule.name == name)?;
        (rule.test, rule.variant) = (replace(rule.test), Variant::Replaced);
        Some(Arc::new(rules))
    }

    fn of(variant: Variant) -> Self {
        Self(TABLE.iter().map(|(name, test)| Rule { name, test: *test, variant }).collect())
    }

    /// The rules, in order.
    pub fn iter(&self) -> impl Iterator<Item = &Rule> {
        self.0.iter()
    }

    fn first(&self, ask: impl Fn(&Test) -> Verdict) -> Verdict {
        self.0.iter().find_map(|rule| ask(&rule.test))
    }
}

/// From rows `method kind facts`: the method that asks the rules of a kind, and for the kind the rules
/// that never and always leave out.
macro_rules! kinds {
    ($($method:ident $kind:ident($($name:ident: $facts:ty),+);)+) => {
        impl Rules {
            $(
                pub(in crate::render) fn $method(&self, $($name: $facts),+) -> Verdict {
                    self.first(|test| match test {
                        Test::$kind(test) => test($($name),+),
                        _ => None,
                    })
                }
            )+
        }

        impl Test {
            /// The rule of the same kind that leaves nothing out.
            #[must_use]
            pub fn never(self) -> Self {
                match self {
                    $(Self::$kind(_) => Self::$kind(|$($name: $facts),+| {
                        let _ = ($($name),+);
                        None
                    }),)+
                }
            }

            /// The rule of the same kind that leaves out whatever it is asked about.
            #[must_use]
            pub fn always(self) -> Self {
                match self {
                    $(Self::$kind(_) => Self::$kind(|$($name: $facts),+| {
                        let _ = ($($name),+);
                        Some("always")
                    }),)+
                }
            }
        }
    };
}

kinds! {
    light Light(it: &LightFacts<'_>);
    reflection Reflection(it: &Meeting<'_>);
    highlight Highlight(it: &Meeting<'_>);
    object Object(it: &Meeting<'_>);
    tile Tile(it: &Meeting<'_>);
    places Places(it: &Reading);
    surfaces Surfaces(it: &Thing<'_>);
    thing Thing(it: &Thing<'_>);
    texture Texture(it: Option<&Texture>);
    holes Holes(it: &Covering<'_>);
    frame Frame(it: &Changes);
}
