//! Builds a scene from a parsed file.
//!
//! Items are inserted by the editor's own commands, so the checks of those (a duplicate id, a NaN)
//! apply here, too.

use std::collections::BTreeSet;

use glam::{DMat3, DMat4, DVec3};

use super::fields::finite;
use super::format::{FileCamera, FileMode, FileModel, FileObject, FileScene, FileTexture};
use super::light::read_light;
use super::view::read_view;
use crate::findings::{FindingKind, Findings};
use marraztu_core::base::{Shared, color::Color};
use marraztu_core::scene::{
    Camera, CameraId, CameraMode, Command, CommandError, Item, LightId, List, MaterialChoice,
    Model, Object, ObjectId, Objects, Panorama, Pose, Scene, Sides, SpotOwner, Texture, Tracked,
    View,
};

/// The most hidden parts of missing models that are kept: it limits the memory that a damaged file
/// takes.
const MOST_HIDDEN: usize = 1_000_000;

/// The models, textures and panoramas that a scene file needs.
pub(super) trait Needs {
    /// Returns the model that the file refers to.
    fn model(&self, model: &FileModel) -> Shared<Model>;
    /// Returns the texture that the file refers to.
    fn texture(&self, texture: &FileTexture) -> Shared<Texture>;
    /// Returns the panorama with this path in the file.
    fn panorama(&self, path: &str) -> Shared<Panorama>;
}

/// Builds the scene and the view of a file. Fails with the reason if the scene is invalid.
pub(super) fn scene(
    file: &FileScene,
    needs: &dyn Needs,
    findings: &mut Findings,
) -> Result<(Scene, View), String> {
    scene_with(Objects::default(), file, needs, findings)
}

/// Works like [`scene`], with the objects of the file after these.
pub(super) fn scene_with(
    objects: Objects,
    file: &FileScene,
    needs: &dyn Needs,
    findings: &mut Findings,
) -> Result<(Scene, View), String> {
    let mut largest = objects.ids().map(|id| id.0).max().unwrap_or(0);
    let mut scene = Scene {
        objects,
        cameras: List::default(),
        lights: List::default(),
        background: Color(file.background),
        next_id: 0,
        locked: BTreeSet::new(),
    };
    // Errors name the item, since the user finds it by id and name in the file.
    let mut insert = |at: usize, item: Item, id: u32, what: String| {
        largest = largest.max(id);
        let insertion = Command::Insert { at, item };
        insertion.apply(&mut scene).map(|_| ()).map_err(|error| match error {
            CommandError::AlreadyThere(_) => format!("{what}: its id is used twice"),
            error => format!("{what}: {error}"),
        })
    };
    let mut room = MOST_HIDDEN;
    for (at, object) in file.objects.iter().enumerate() {
        let what = format!("object {} \"{}\"", object.id, object.name);
        let item =
            read_object(object, needs, &mut room).map_err(|reason| format!("{what}: {reason}"))?;
        insert(at, Item::Object(ObjectId(object.id), Box::new(item)), object.id, what)?;
    }
    for (at, camera) in file.cameras.iter().enumerate() {
        let what = format!("camera {} \"{}\"", camera.id, camera.name);
        let item = read_camera(camera, needs).map_err(|reason| format!("{what}: {reason}"))?;
        insert(at, Item::Camera(CameraId(camera.id), Box::new(item)), camera.id, what)?;
    }
    // Commands do not check slots, so duplicates are rejected here.
    let mut slots = BTreeSet::new();
    for (at, light) in file.lights.iter().enumerate() {
        let what = format!("light {} \"{}\"", light.id, light.name);
        if !slots.insert(light.slot) {
            return Err(format!("{what}: another light has slot {} already", light.slot));
        }
        let item = read_light(light, needs).map_err(|reason| format!("{what}: {reason}"))?;
        insert(at, Item::Light(LightId(light.id), Box::new(item)), light.id, what)?;
    }
    if file.cameras.is_empty() {
        return Err("a scene needs a camera".to_owned());
    }
    // New items must get unused ids, even if the file states a smaller `next_id`.
    let after = largest.checked_add(1).ok_or("an id is too large")?;
    scene.next_id = file.next_id.max(after);
    scene.locked = file.locked.within(&scene);
    note_missing_owners(&scene, findings);
    let view = read_view(&file.view, &scene, findings)?;
    Ok((scene, view))
}

/// Notes spots and cameras that are attached to a missing item.
fn note_missing_owners(scene: &Scene, findings: &mut Findings) {
    let mut note = |what: String| findings.add(FindingKind::OwnerMissing, &what, None);
    for (_, light) in scene.lights.iter() {
        let Some(owner) = light.kind.owner() else { continue };
        let owner = match *owner {
            SpotOwner::Object(id) if scene.objects.get(id).is_none() => format!("object {}", id.0),
            SpotOwner::Camera(id) if scene.cameras.get(id).is_none() => format!("camera {}", id.0),
            SpotOwner::Object(_) | SpotOwner::Camera(_) | SpotOwner::Fixed(_) => continue,
            SpotOwner::SelectedObject | SpotOwner::SelectedCamera => continue,
        };
        note(format!("the light \"{}\" belongs to {owner}", light.name));
    }
    for (_, camera) in scene.cameras.iter() {
        if let CameraMode::Analysis { target } = camera.pose.now().mode
            && scene.objects.get(target).is_none()
        {
            note(format!("the camera \"{}\" is aimed at object {}", camera.name, target.0));
        }
    }
}

/// Checks a material. Fails with the reason if one of its numbers is invalid.
pub(super) fn read_material(material: &MaterialChoice) -> Result<MaterialChoice, String> {
    if let MaterialChoice::Own(own) = material {
        let colors = [own.ambient, own.diffuse, own.specular].concat();
        // Emission is light, which has no largest value.
        let positive = [&own.emission[..], &[own.exponent]].concat();
        finite("its material", &[&colors[..], &positive].concat())?;
        let right =
            colors.iter().all(|x| (0.0..=1.0).contains(x)) && positive.iter().all(|x| *x >= 0.0);
        if !right {
            return Err("its material needs colours from 0 to 1, and an emission and an exponent \
                of at least 0"
                .into());
        }
    }
    Ok(material.clone())
}

/// Builds an object. `room` is the remaining limit for hidden parts of missing models.
fn read_object(object: &FileObject, needs: &dyn Needs, room: &mut usize) -> Result<Object, String> {
    finite("its placement", object.placement.as_flattened())?;
    finite("its spin", &[object.spin.speed, object.spin.since])?;
    finite("its opacity", &[object.opacity])?;
    if let Some(texture) = &object.texture {
        finite("its texture", &[texture.offset, texture.scale].concat())?;
    }
    let model = needs.model(&object.model);
    let hidden_parts = if model.is_placeholder() {
        let kept = object.hidden_parts.smallest(*room);
        *room -= kept.len();
        kept
    } else {
        // The model may have changed on disk, and have fewer parts now.
        object.hidden_parts.below(model.mesh.parts().len())
    };
    Ok(Object {
        name: object.name.clone(),
        visible: object.visible,
        model,
        hidden_parts,
        placement: Tracked::new(DMat4::from_cols_array_2d(&object.placement)),
        spin: object.spin,
        material: read_material(&object.material)?,
        surface: object.surface,
        texture: object.texture.as_ref().map(|texture| needs.texture(texture)),
        tint: Color(object.tint),
        opacity: object.opacity.clamp(0.0, 1.0),
        sides: read_sides(object),
        file_normals: object.file_normals,
        edge_color: Color(object.edge_color),
    })
}

/// Returns the sides that a scene file states, or that an earlier file states as `two_sided`. The
/// default for built-in models is one side.
fn read_sides(object: &FileObject) -> Sides {
    let earlier = object.two_sided.map(|two| if two { Sides::Two } else { Sides::One });
    object.sides.or(earlier).unwrap_or(match object.model {
        FileModel::Own(_) | FileModel::Shape { .. } => Sides::One,
        FileModel::File { .. } => Sides::Auto,
    })
}

fn read_camera(camera: &FileCamera, needs: &dyn Needs) -> Result<Camera, String> {
    finite("its position", &camera.eye)?;
    finite("its axes", camera.axes.as_flattened())?;
    let axes = DMat3::from_cols_array_2d(&camera.axes);
    // Orthonormal and right-handed, up to rounding in the file.
    let error = (axes.transpose() * axes - DMat3::IDENTITY).to_cols_array();
    if error.iter().any(|x| x.abs() > 1e-6) || axes.determinant() < 0.0 {
        return Err("its axes must be perpendicular, of length 1 and right-handed".to_owned());
    }
    let mode = match camera.mode {
        FileMode::Fly => CameraMode::Fly,
        FileMode::Analysis(target) => CameraMode::Analysis { target: ObjectId(target) },
    };
    let eye = DVec3::from_array(camera.eye);
    Ok(Camera {
        name: camera.name.clone(),
        visible: camera.visible,
        model: needs.model(&camera.model),
        material: read_material(&camera.material)?,
        pose: Tracked::new(Pose { eye, axes, mode }),
        lens: camera.lens,
    })
}

#[cfg(test)]
mod tests {
    use marraztu_core::accuracy::Settings;
    use marraztu_core::edit::items;

    use crate::keeping::{Abandoned, Journal, OwnFolders, Unsaved};
    use crate::progress::Progress;
    use crate::window_state::WindowState;
    use crate::{default_scene, open, save};

    #[test]
    fn twenty_thousand_objects_can_be_saved_opened_and_recovered() {
        let (mut scene, view) = default_scene();
        let object = scene.objects.at(0).unwrap().1.clone();
        items::insert_objects(&scene, vec![object; 20_000]).apply(&mut scene).unwrap();
        assert_eq!(scene.objects.len(), 20_003);
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.marraztu");
        save(&path, &scene, &view, &Settings::default()).unwrap();
        let opened = open(&path, &Progress::new()).unwrap().scene;
        assert!(opened.objects == scene.objects);
        // The journal writes the same text.
        let folders = OwnFolders::within(folder.path());
        let journal = Journal::begin(&folders).unwrap();
        let (settings, window) = (Settings::default(), WindowState::DEFAULT);
        journal.keep(Unsaved { scene, view, settings, window, file: None, content: None });
        journal.wait();
        assert_eq!(journal.news(), None);
        drop(journal);
        let work = Abandoned::all(&folders);
        assert_eq!(open(work[0].path(), &Progress::new()).unwrap().scene.objects.len(), 20_003);
    }
}
