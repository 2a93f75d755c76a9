//! Items of a scene as text, for the clipboard.
//!
//! Items have the same form as in scene files, but with absolute paths, since the text can be
//! pasted into any scene.

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::error::SceneFileError;
use super::files::{Files, Known};
use super::format::{
    FileCamera, FileLocked, FileObject, FileScene, Head, VERSION, cam, written_bare,
};
use super::light::{FileLight, file_light};
use super::save::{file_camera, file_object};
use super::view::FileView;
use super::{open, words};
use crate::findings::Findings;
use crate::progress::Progress;
use marraztu_core::accuracy::Settings;
use marraztu_core::scene::{
    Camera, CameraId, ItemId, Light, LightId, MaterialChoice, Object, ObjectId, Scene,
};

/// The name of the text in errors.
const NAME: &str = "the clipboard";

/// Items from a text, with the ids that they have in it.
#[derive(Debug, Default)]
pub struct Fragment {
    /// The objects, in the order of the list.
    pub objects: Vec<(ObjectId, Object)>,
    /// The cameras.
    pub cameras: Vec<(CameraId, Camera)>,
    /// The lights.
    pub lights: Vec<(LightId, Light)>,
    /// A material that was copied alone.
    pub material: Option<MaterialChoice>,
}

#[derive(Debug, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
struct FileFragment {
    version: u32,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    objects: Vec<FileObject>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    cameras: Vec<FileCamera>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    lights: Vec<FileLight>,
    #[serde(with = "written_bare", skip_serializing_if = "Option::is_none")]
    material: Option<MaterialChoice>,
}

/// Writes items of a scene as text.
///
/// # Errors
/// The reason, if an item cannot be written.
pub fn items_to_text(scene: &Scene, items: &[ItemId]) -> Result<String, String> {
    let mut fragment = FileFragment { version: VERSION, ..FileFragment::default() };
    let nowhere = Path::new("");
    let items: HashSet<&ItemId> = items.iter().collect();
    for (id, object) in scene.objects.iter().filter(|(id, _)| items.contains(&ItemId::Object(*id)))
    {
        fragment.objects.push(file_object(id.0, object, nowhere)?);
    }
    for (id, camera) in scene.cameras.iter().filter(|(id, _)| items.contains(&ItemId::Camera(*id)))
    {
        fragment.cameras.push(file_camera(id.0, camera, nowhere)?);
    }
    for (id, light) in scene.lights.iter().filter(|(id, _)| items.contains(&ItemId::Light(*id))) {
        fragment.lights.push(file_light(id.0, light, nowhere)?);
    }
    text(&fragment)
}

/// Writes a material as text.
///
/// # Errors
/// The reason, if it cannot be written.
pub fn material_to_text(material: &MaterialChoice) -> Result<String, String> {
    let material = Some(material.clone());
    text(&FileFragment { version: VERSION, material, ..FileFragment::default() })
}

fn text(fragment: &FileFragment) -> Result<String, String> {
    let config = ron::ser::PrettyConfig::new().new_line("\n");
    let text = ron::ser::to_string_pretty(fragment, config).map_err(|error| error.to_string())?;
    Ok(text + "\n")
}

/// Parses the items of a text. Models and textures that are not in `known` are loaded.
///
/// # Errors
/// If the text is not a fragment, if its items are invalid, or if a model cannot be loaded; and if
/// `progress` is cancelled.
pub fn items_of_text(
    text: &str,
    known: &Known,
    progress: &Progress,
) -> Result<Fragment, SceneFileError> {
    let fail = |reason: String| SceneFileError::File { file: NAME.to_owned(), reason };
    let text = text.trim_start();
    let is_ours = text.starts_with(['(', '/']) && ron::from_str::<Head>(text).is_ok();
    // Text from other programs is rejected with one plain sentence.
    if !is_ours {
        return Err(fail("it holds no objects, cameras, lights or material".to_owned()));
    }
    let fragment: FileFragment = ron::from_str(text).map_err(|error| SceneFileError::Line {
        file: NAME.to_owned(),
        line: error.span.start.line,
        column: error.span.start.col,
        reason: words::sentence(&error.code),
    })?;
    if !(1..=VERSION).contains(&fragment.version) {
        return Err(fail(format!("this program does not know version {}", fragment.version)));
    }
    let FileFragment { version, objects, mut cameras, mut lights, material } = fragment;
    if let Some(material) = &material {
        open::read_material(material).map_err(fail)?;
    }
    // Only the order of the slots is kept.
    for (light, slot) in lights.iter_mut().zip(0..) {
        light.slot = slot;
    }
    // A scene needs a camera, so a temporary one is added.
    let has_cameras = !cameras.is_empty();
    if !has_cameras {
        let ids = objects.iter().map(|it| it.id).chain(lights.iter().map(|it| it.id));
        cameras.push(stand_in(ids.max().unwrap_or(0).saturating_add(1)));
    }
    let file = FileScene {
        version,
        background: [0; 3],
        next_id: 0,
        objects,
        cameras,
        lights,
        locked: FileLocked::default(),
        view: FileView::default(),
        settings: Settings::default(),
    };
    // From here on, the fragment is checked like a scene file.
    let mut files = Files::new(PathBuf::new(), NAME);
    files.know(known);
    files.load(&file, NAME, progress)?;
    let (scene, _) = open::scene(&file, &files, &mut Findings::new(NAME)).map_err(fail)?;
    let cameras = scene.cameras.iter().filter(|_| has_cameras);
    Ok(Fragment {
        objects: scene.objects.iter().map(|(id, it)| (id, it.clone())).collect(),
        cameras: cameras.map(|(id, it)| (id, it.clone())).collect(),
        lights: scene.lights.iter().map(|(id, it)| (id, it.clone())).collect(),
        material,
    })
}

fn stand_in(id: u32) -> FileCamera {
    FileCamera {
        id,
        name: String::new(),
        visible: true,
        model: cam(),
        material: MaterialChoice::File,
        eye: [0.0; 3],
        axes: glam::DMat3::IDENTITY.to_cols_array_2d(),
        mode: super::format::FileMode::Fly,
        lens: marraztu_core::scene::Lens::default(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(scene: &Scene) -> Vec<ItemId> {
        let objects = scene.objects.ids().map(ItemId::Object);
        let cameras = scene.cameras.ids().map(ItemId::Camera);
        objects.chain(cameras).chain(scene.lights.ids().map(ItemId::Light)).collect()
    }

    fn read(text: &str) -> Result<Fragment, SceneFileError> {
        items_of_text(text, &Known::default(), &Progress::new())
    }

    #[test]
    fn items_come_back_from_their_text() {
        let (scene, _) = crate::default_scene();
        let text = items_to_text(&scene, &all(&scene)).unwrap();
        let fragment = read(&text).unwrap();
        let objects: Vec<_> = scene.objects.iter().map(|(id, it)| (id, it.clone())).collect();
        assert_eq!(fragment.objects, objects);
        assert_eq!((fragment.cameras.len(), fragment.lights.len()), (1, 5));
        let first = scene.lights.ids().next().unwrap();
        let light = read(&items_to_text(&scene, &[ItemId::Light(first)]).unwrap()).unwrap();
        assert_eq!((light.objects.len(), light.cameras.len(), light.lights.len()), (0, 0, 1));
    }

    #[test]
    fn a_material_comes_back_by_itself() {
        let gold = MaterialChoice::Preset(marraztu_core::scene::PresetId::SILVER);
        let fragment = read(&material_to_text(&gold).unwrap()).unwrap();
        assert_eq!(fragment.material, Some(gold));
        assert!(fragment.objects.is_empty() && fragment.cameras.is_empty());
    }

    #[test]
    fn text_of_something_else_is_refused_in_a_sentence() {
        for text in ["", "hello", "(1, 2)", "// comment", "v 0 0 0", "(version: 1, objects: 5)"] {
            let error = read(text).err().map(|error| error.to_string()).unwrap_or_default();
            assert!(error.starts_with("the clipboard"), "{text}: {error}");
        }
        assert!(read("(version: 9)").unwrap_err().to_string().contains("version 9"));
    }
}
