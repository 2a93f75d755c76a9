//! The text of a scene file.
//!
//! These types belong to the file format alone, so the scene's own types may change while old files
//! still open. Missing fields get the values of a new scene. Unknown fields are errors, since they
//! may be typing errors that would be lost on saving.

use std::collections::BTreeSet;

use serde::{Deserialize, Serialize};

use super::fields::{Numbers, white, yes};
use super::light::FileLight;
use super::view::FileView;
use marraztu_core::accuracy::Settings;
use marraztu_core::scene::{
    BumpMaps, ItemId, Lens, MaterialChoice, Scene, Sides, Spin, Surface, UpAxis, Winding, Wrap,
};

/// The version that is written, and the latest that can be read.
pub(super) const VERSION: u32 = 1;

/// The part that all versions share.
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

/// The ids of locked items.
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

    /// Collects the locked items of a scene.
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

    /// Returns the items of a scene that are locked.
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
    /// A built-in model, by name.
    Own(String),
    /// A built-in shape of this width. Shapes that are one unit wide are [`Self::Own`].
    Shape { name: String, size: f64 },
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
        #[serde(default, skip_serializing_if = "are_usual")]
        bumps: BumpMaps,
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
    pub(super) spin: Spin,
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
    /// The camera's axes X, Y and Z.
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
    /// Orbits the centre of the object with this id.
    Analysis(u32),
}

fn one() -> f64 {
    1.0
}

#[expect(clippy::trivially_copy_pass_by_ref, clippy::float_cmp, reason = "as serde calls it")]
fn is_one(number: &f64) -> bool {
    *number == 1.0
}

fn crease() -> f64 {
    marraztu_core::scene::Crease::default().get()
}

fn ones() -> [f64; 2] {
    [1.0; 2]
}

fn background() -> [u8; 3] {
    Scene::BACKGROUND.0
}

fn silver() -> MaterialChoice {
    MaterialChoice::Preset(marraztu_core::scene::PresetId::SILVER)
}

fn are_usual(bumps: &BumpMaps) -> bool {
    *bumps == BumpMaps::default()
}

pub(super) fn cam() -> FileModel {
    FileModel::Own("cam".to_owned())
}

fn identity() -> [[f64; 4]; 4] {
    glam::DMat4::IDENTITY.to_cols_array_2d()
}

fn axes() -> [[f64; 3]; 3] {
    glam::DMat3::IDENTITY.to_cols_array_2d()
}

/// Serializes an optional field without `Some`.
pub(super) mod written_bare {
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    pub(in super::super) fn serialize<T: Serialize, S: Serializer>(
        value: &Option<T>,
        serializer: S,
    ) -> Result<S::Ok, S::Error> {
        match value {
            Some(value) => value.serialize(serializer),
            None => serializer.serialize_none(),
        }
    }

    pub(in super::super) fn deserialize<'de, T: Deserialize<'de>, D: Deserializer<'de>>(
        deserializer: D,
    ) -> Result<Option<T>, D::Error> {
        T::deserialize(deserializer).map(Some)
    }
}
