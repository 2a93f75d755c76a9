//! The text of a scene file.
//!
//! These types belong to the file alone: the scene may change its own, and old files still open. A
//! missing field has the value that a new scene gives it; an unknown field is an error, since it
//! may be a typing error that would be lost on saving.

use std::collections::BTreeSet;

use serde::{Deserialize, Serialize};

use crate::accuracy::Settings;
use crate::scene::{
    Attenuation, Fill, Frame, ItemId, Lens, MaterialChoice, NormalLength, Normals, Observer,
    Panels, Projection, Scene, Sides, Steps, Subject, Surface, Transformation, UpAxis, Winding,
    Wrap,
};

/// The version that is written, and the latest that is read.
pub(super) const VERSION: u32 = 1;

/// The part that every version has.
#[derive(Debug, Deserialize)]
pub(super) struct Head {
    pub(super) version: u32,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct FileScene {
    pub(super) version: u32,
    #[serde(default = "background")]
    pub(super) background: [u8; 3],
    #[serde(default)]
    pub(super) next_id: u32,
    #[serde(default)]
    pub(super) objects: Vec<FileObject>,
    pub(super) cameras: Vec<FileCamera>,
    #[serde(default)]
    pub(super) lights: Vec<FileLight>,
    #[serde(default, skip_serializing_if = "FileLocked::is_empty")]
    pub(super) locked: FileLocked,
    #[serde(default)]
    pub(super) view: FileView,
    #[serde(default)]
    pub(super) settings: Settings,
}

/// The items that are locked, by their ids.
#[derive(Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct FileLocked {
    pub(super) objects: Numbers,
    pub(super) cameras: Numbers,
    pub(super) lights: Numbers,
}

impl FileLocked {
    fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// The locked ones of a scene.
    pub(super) fn of(scene: &Scene) -> Self {
        let mut ids: [BTreeSet<u32>; 3] = Default::default();
        for id in scene.locked.iter().filter(|id| scene.contains(**id)) {
            match *id {
                ItemId::Object(id) => ids[0].insert(id.0),
                ItemId::Camera(id) => ids[1].insert(id.0),
                ItemId::Light(id) => ids[2].insert(id.0),
            };
        }
        let [objects, cameras, lights] = ids.map(|ids| Numbers::of(&ids));
        Self { objects, cameras, lights }
    }

    /// Those of a scene's items that are locked.
    pub(super) fn within(&self, scene: &Scene) -> BTreeSet<ItemId> {
        let objects = scene.objects.ids().filter(|id| self.objects.has(id.0)).map(ItemId::Object);
        let cameras = scene.cameras.ids().filter(|id| self.cameras.has(id.0)).map(ItemId::Camera);
        let lights = scene.lights.ids().filter(|id| self.lights.has(id.0)).map(ItemId::Light);
        objects.chain(cameras).chain(lights).collect()
    }
}

/// The source of a model.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) enum FileModel {
    /// A built-in one, by its name.
    Own(String),
    /// A file, relative to the folder of the scene file.
    File {
        path: String,
        #[serde(default)]
        up: UpAxis,
        #[serde(default = "one")]
        scale: f64,
        #[serde(default)]
        winding: Winding,
        #[serde(default = "crease")]
        crease: f64,
    },
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct FileObject {
    pub(super) id: u32,
    pub(super) name: String,
    #[serde(default = "yes")]
    pub(super) visible: bool,
    pub(super) model: FileModel,
    #[serde(default)]
    pub(super) hidden_parts: Numbers,
    /// The columns of `world_from_object`.
    #[serde(default = "identity")]
    pub(super) placement: [[f64; 4]; 4],
    #[serde(default)]
    pub(super) spin: FileSpin,
    #[serde(default = "silver")]
    pub(super) material: MaterialChoice,
    #[serde(default)]
    pub(super) surface: Surface,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) texture: Option<FileTexture>,
    #[serde(default = "white")]
    pub(super) tint: [u8; 3],
    #[serde(default = "one", skip_serializing_if = "is_one")]
    pub(super) opacity: f64,
    #[serde(default, with = "written_bare", skip_serializing_if = "Option::is_none")]
    pub(super) sides: Option<Sides>,
    /// The predecessor of `sides` in earlier scene files.
    #[serde(default, with = "written_bare", skip_serializing_if = "Option::is_none")]
    pub(super) two_sided: Option<bool>,
    #[serde(default = "yes")]
    pub(super) file_normals: bool,
    #[serde(default = "white")]
    pub(super) edge_color: [u8; 3],
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct FileTexture {
    pub(super) path: String,
    #[serde(default)]
    pub(super) wrap: Wrap,
    #[serde(default)]
    pub(super) offset: [f64; 2],
    #[serde(default = "ones")]
    pub(super) scale: [f64; 2],
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct FileSpin {
    pub(super) axes: [bool; 3],
    pub(super) speed: f64,
    pub(super) since: f64,
}

impl Default for FileSpin {
    fn default() -> Self {
        let crate::scene::Spin { axes, speed, since } = crate::scene::Spin::default();
        Self { axes, speed, since }
    }
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct FileCamera {
    pub(super) id: u32,
    pub(super) name: String,
    #[serde(default = "yes")]
    pub(super) visible: bool,
    #[serde(default = "cam")]
    pub(super) model: FileModel,
    #[serde(default = "silver")]
    pub(super) material: MaterialChoice,
    #[serde(default)]
    pub(super) eye: [f64; 3],
    /// Its axes X, Y and Z.
    #[serde(default = "axes")]
    pub(super) axes: [[f64; 3]; 3],
    #[serde(default)]
    pub(super) mode: FileMode,
    #[serde(default)]
    pub(super) lens: Lens,
}

#[derive(Debug, Default, Serialize, Deserialize)]
pub(super) enum FileMode {
    #[default]
    Fly,
    /// About the centre of the object with this id.
    Analysis(u32),
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct FileLight {
    pub(super) id: u32,
    pub(super) name: String,
    pub(super) slot: u32,
    #[serde(default = "yes")]
    pub(super) on: bool,
    #[serde(default = "white")]
    pub(super) color: [u8; 3],
    #[serde(default)]
    pub(super) attenuation: Attenuation,
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub(super) shadows: bool,
    pub(super) kind: FileLightKind,
}

#[derive(Debug, Serialize, Deserialize)]
pub(super) enum FileLightKind {
    Ambient,
    Sun {
        direction: [f64; 3],
    },
    Bulb {
        position: [f64; 3],
        #[serde(default)]
        orbit: FileOrbit,
    },
    Spot {
        owner: FileOwner,
        half_aperture: f64,
        exponent: f64,
    },
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct FileOrbit {
    pub(super) on: bool,
    pub(super) speed: f64,
    pub(super) since: f64,
}

impl Default for FileOrbit {
    fn default() -> Self {
        let crate::scene::Orbit { on, speed, since } = crate::scene::Orbit::default();
        Self { on, speed, since }
    }
}

#[derive(Debug, Serialize, Deserialize)]
pub(super) enum FileOwner {
    SelectedObject,
    SelectedCamera,
    Object(u32),
    Camera(u32),
    Fixed { position: [f64; 3], direction: [f64; 3] },
}

/// The camera of a view that does not say which: no camera has this id.
pub(super) const UNSAID: u32 = u32::MAX;

#[derive(Debug, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct FileView {
    pub(super) subject: Subject,
    pub(super) object: Option<u32>,
    pub(super) camera: u32,
    pub(super) light: Option<u32>,
    pub(super) transformation: Transformation,
    pub(super) frame: Frame,
    pub(super) steps: Steps,
    pub(super) observer: Observer,
    pub(super) projection: Projection,
    pub(super) fill: Fill,
    pub(super) edges_over_fill: bool,
    pub(super) polygons: Option<FilePolygons>,
    pub(super) polygons_stay: bool,
    pub(super) only_selected: bool,
    pub(super) normals: Normals,
    pub(super) back_faces: bool,
    pub(super) face_normals: bool,
    pub(super) vertex_normals: bool,
    pub(super) normal_length: NormalLength,
    pub(super) wide_lines: bool,
    pub(super) marks: bool,
    pub(super) coarse_while_moving: bool,
    pub(super) time: f64,
    pub(super) panels: Panels,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct FilePolygons {
    pub(super) current: u32,
    #[serde(default)]
    pub(super) shown: Numbers,
}

/// Numbers as ranges, `0-7 9 12-20`, so that a hundred thousand shown polygons do not take as many
/// lines.
///
/// They stay ranges until it is known how many there can be.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(into = "String", try_from = "String")]
pub(super) struct Numbers(Vec<(u32, u32)>);

impl Numbers {
    pub(super) fn of(numbers: &BTreeSet<u32>) -> Self {
        let mut runs: Vec<(u32, u32)> = Vec::new();
        for &number in numbers {
            match runs.last_mut() {
                Some((_, last)) if last.checked_add(1) == Some(number) => *last = number,
                _ => runs.push((number, number)),
            }
        }
        Self(runs)
    }

    /// Whether a number is among them.
    fn has(&self, number: u32) -> bool {
        self.0.iter().any(|(first, last)| (*first..=*last).contains(&number))
    }

    /// Those of the numbers that are below `count`.
    pub(super) fn below(&self, count: usize) -> BTreeSet<u32> {
        let mut runs = self.0.clone();
        runs.sort_unstable();
        let end = u32::try_from(count).unwrap_or(u32::MAX);
        let mut numbers = BTreeSet::new();
        let mut next = 0;
        for (first, last) in runs {
            // A number that is named repeatedly counts once.
            numbers.extend(next.max(first)..end.min(last.saturating_add(1)));
            next = next.max(last.saturating_add(1));
        }
        numbers
    }
}

impl From<Numbers> for String {
    fn from(numbers: Numbers) -> Self {
        let text = |(first, last): &(u32, u32)| {
            if first == last { first.to_string() } else { format!("{first}-{last}") }
        };
        numbers.0.iter().map(text).collect::<Vec<_>>().join(" ")
    }
}

impl TryFrom<String> for Numbers {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        let run = |word: &str| {
            let (first, last) = word.split_once('-').unwrap_or((word, word));
            let number = |text: &str| {
                text.parse::<u32>().map_err(|error| format!("\"{word}\" is not a number: {error}"))
            };
            Ok((number(first)?, number(last)?))
        };
        text.split_whitespace().map(run).collect::<Result<_, String>>().map(Self)
    }
}

/// A field that may be missing, written without `Some`.
mod written_bare {
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    pub(super) fn serialize<T: Serialize, S: Serializer>(
        value: &Option<T>,
        serializer: S,
    ) -> Result<S::Ok, S::Error> {
        match value {
            Some(value) => value.serialize(serializer),
            None => serializer.serialize_none(),
        }
    }

    pub(super) fn deserialize<'de, T: Deserialize<'de>, D: Deserializer<'de>>(
        deserializer: D,
    ) -> Result<Option<T>, D::Error> {
        T::deserialize(deserializer).map(Some)
    }
}

fn yes() -> bool {
    true
}

fn one() -> f64 {
    1.0
}

#[expect(clippy::trivially_copy_pass_by_ref, clippy::float_cmp, reason = "as serde calls it")]
fn is_one(number: &f64) -> bool {
    *number == 1.0
}

fn crease() -> f64 {
    crate::scene::Crease::default().get()
}

fn ones() -> [f64; 2] {
    [1.0; 2]
}

fn white() -> [u8; 3] {
    [255; 3]
}

fn background() -> [u8; 3] {
    Scene::BACKGROUND.0
}

fn silver() -> MaterialChoice {
    MaterialChoice::Preset(crate::scene::PresetId::SILVER)
}

fn cam() -> FileModel {
    FileModel::Own("cam".to_owned())
}

fn identity() -> [[f64; 4]; 4] {
    glam::DMat4::IDENTITY.to_cols_array_2d()
}

fn axes() -> [[f64; 3]; 3] {
    glam::DMat3::IDENTITY.to_cols_array_2d()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_written_in_runs_and_come_back() {
        let all: BTreeSet<u32> = [0, 1, 2, 5, 7, 8, 4000].into();
        let numbers = Numbers::of(&all);
        let text = String::from(numbers.clone());
        assert_eq!(text, "0-2 5 7-8 4000");
        assert_eq!(Numbers::try_from(text), Ok(numbers.clone()));
        assert_eq!(numbers.below(4001), all);
        assert_eq!(numbers.below(8), [0, 1, 2, 5, 7].into());
        assert!(Numbers::try_from("three".to_owned()).is_err());
    }

    #[test]
    fn numbers_that_no_model_has_cost_nothing() {
        let text = "0-4294967295 ".repeat(10_000) + "5-2 4294967295";
        let numbers = Numbers::try_from(text).unwrap();
        assert_eq!(numbers.below(3), [0, 1, 2].into());
        assert_eq!(numbers.below(0), BTreeSet::new());
    }
}
