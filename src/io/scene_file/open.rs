//! Makes a scene from the text of a file.
//!
//! Items are inserted by the same commands as in the editor: whatever those refuse (an id used
//! twice, a NaN) is refused here.

use std::collections::BTreeSet;

use glam::{DMat3, DMat4, DVec3};

use super::format::{
    FileCamera, FileLight, FileLightKind, FileMode, FileModel, FileObject, FileOrbit, FileOwner,
    FileScene, FileSpin, FileTexture, FileView, UNSAID,
};
use crate::base::{Shared, color::Color};
use crate::io::findings::{FindingKind, Findings};
use crate::scene::{
    Aim, Camera, CameraId, CameraMode, Command, CommandError, Item, Light, LightId, LightKind,
    List, MaterialChoice, Model, Object, ObjectId, Orbit, PolygonMode, Pose, Scene, Sides, Spin,
    SpotOwner, Steps, Texture, Tracked, View,
};

/// The most items of a kind in a scene: each is looked up among all others.
const MOST_ITEMS: usize = 10_000;

/// Checks that there are few enough items for a scene.
///
/// # Errors
/// The reason, if there are too many.
pub(super) fn check_counts(file: &FileScene) -> Result<(), String> {
    let counts = [
        ("objects", file.objects.len()),
        ("cameras", file.cameras.len()),
        ("lights", file.lights.len()),
    ];
    match counts.into_iter().find(|(_, count)| *count > MOST_ITEMS) {
        Some((what, count)) => {
            Err(format!("it has {count} {what}, but a scene has at most {MOST_ITEMS}"))
        }
        None => Ok(()),
    }
}

/// The models and textures that a scene file needs.
pub(super) trait Needs {
    /// The model that the file names.
    fn model(&self, model: &FileModel) -> Shared<Model>;
    /// The texture that the file names.
    fn texture(&self, texture: &FileTexture) -> Shared<Texture>;
}

/// The scene and the view that a file holds.
///
/// # Errors
/// The reason, if its scene is not valid.
pub(super) fn scene(
    file: &FileScene,
    needs: &dyn Needs,
    findings: &mut Findings,
) -> Result<(Scene, View), String> {
    let mut scene = Scene {
        objects: List::default(),
        cameras: List::default(),
        lights: List::default(),
        background: Color(file.background),
        next_id: 0,
        locked: BTreeSet::new(),
    };
    let mut largest = 0;
    let mut insert = |at: usize, item: Item, id: u32, what: String| {
        largest = largest.max(id);
        let insertion = Command::Insert { at, item };
        insertion.apply(&mut scene).map(|_| ()).map_err(|error| match error {
            CommandError::AlreadyThere(_) => format!("{what}: its id is used twice"),
            error => format!("{what}: {error}"),
        })
    };
    for (at, object) in file.objects.iter().enumerate() {
        let what = format!("object {} \"{}\"", object.id, object.name);
        let item = read_object(object, needs).map_err(|reason| format!("{what}: {reason}"))?;
        insert(at, Item::Object(ObjectId(object.id), Box::new(item)), object.id, what)?;
    }
    for (at, camera) in file.cameras.iter().enumerate() {
        let what = format!("camera {} \"{}\"", camera.id, camera.name);
        let item = read_camera(camera, needs).map_err(|reason| format!("{what}: {reason}"))?;
        insert(at, Item::Camera(CameraId(camera.id), Box::new(item)), camera.id, what)?;
    }
    let mut slots = BTreeSet::new();
    for (at, light) in file.lights.iter().enumerate() {
        let what = format!("light {} \"{}\"", light.id, light.name);
        if !slots.insert(light.slot) {
            return Err(format!("{what}: another light has slot {} already", light.slot));
        }
        let item = read_light(light).map_err(|reason| format!("{what}: {reason}"))?;
        insert(at, Item::Light(LightId(light.id), Box::new(item)), light.id, what)?;
    }
    if file.cameras.is_empty() {
        return Err("a scene needs a camera".to_owned());
    }
    let after = largest.checked_add(1).ok_or("an id is too large for another to follow")?;
    scene.next_id = file.next_id.max(after);
    scene.locked = file.locked.within(&scene);
    note_missing_owners(&scene, findings);
    let view = read_view(&file.view, &scene, findings)?;
    Ok((scene, view))
}

/// Notes spots and cameras that are attached to something that is missing.
fn note_missing_owners(scene: &Scene, findings: &mut Findings) {
    let mut note = |what: String| findings.add(FindingKind::OwnerMissing, &what, None);
    for (_, light) in scene.lights.iter() {
        let LightKind::Spot { owner, .. } = &light.kind else { continue };
        let owner = match *owner {
            SpotOwner::Object(id) if scene.objects.get(id).is_none() => format!("object {}", id.0),
            SpotOwner::Camera(id) if scene.cameras.get(id).is_none() => format!("camera {}", id.0),
            _ => continue,
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

fn finite(what: &str, numbers: &[f64]) -> Result<(), String> {
    if numbers.iter().all(|x| x.is_finite()) {
        Ok(())
    } else {
        Err(format!("{what} has a number that is infinite or NaN"))
    }
}

fn read_material(material: &MaterialChoice) -> Result<MaterialChoice, String> {
    if let MaterialChoice::Own(own) = material {
        let colors = [own.ambient, own.diffuse, own.specular].concat();
        finite("its material", &colors)?;
        finite("its material", &[own.exponent])?;
        let right = colors.iter().all(|x| (0.0..=1.0).contains(x)) && own.exponent >= 0.0;
        if !right {
            return Err("its material needs colours from 0 to 1 and an exponent above 0".into());
        }
    }
    Ok(material.clone())
}

fn read_object(object: &FileObject, needs: &dyn Needs) -> Result<Object, String> {
    finite("its placement", object.placement.as_flattened())?;
    let FileSpin { axes, speed, since } = object.spin;
    finite("its spin", &[speed, since])?;
    finite("its opacity", &[object.opacity])?;
    if let Some(texture) = &object.texture {
        finite("its texture", &[texture.offset, texture.scale].concat())?;
    }
    let model = needs.model(&object.model);
    // The model may have changed since, and have fewer parts now.
    let hidden_parts = object.hidden_parts.below(model.mesh.parts().len());
    Ok(Object {
        name: object.name.clone(),
        visible: object.visible,
        model,
        hidden_parts,
        placement: Tracked::new(DMat4::from_cols_array_2d(&object.placement)),
        spin: Spin { axes, speed, since },
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

/// The sides that a scene file names; earlier files say whether there are two. Built-in models have
/// one if nothing is said.
fn read_sides(object: &FileObject) -> Sides {
    let earlier = object.two_sided.map(|two| if two { Sides::Two } else { Sides::One });
    object.sides.or(earlier).unwrap_or(match object.model {
        FileModel::Own(_) => Sides::One,
        FileModel::File { .. } => Sides::Auto,
    })
}

fn read_camera(camera: &FileCamera, needs: &dyn Needs) -> Result<Camera, String> {
    finite("its place", &camera.eye)?;
    finite("its axes", camera.axes.as_flattened())?;
    let axes = DMat3::from_cols_array_2d(&camera.axes);
    let error = (axes.transpose() * axes - DMat3::IDENTITY).to_cols_array();
    if error.iter().any(|x| x.abs() > 1e-6) || axes.determinant() < 0.0 {
        return Err("its axes are not at right angles, of length 1 and right-handed".to_owned());
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

fn read_light(light: &FileLight) -> Result<Light, String> {
    let kind = match light.kind {
        FileLightKind::Ambient => LightKind::Ambient,
        FileLightKind::Sun { direction } => {
            LightKind::Sun { direction: Tracked::new(read_direction(direction)?) }
        }
        FileLightKind::Bulb { position, orbit: FileOrbit { on, speed, since } } => {
            finite("its place", &position)?;
            finite("its orbit", &[speed, since])?;
            let position = Tracked::new(DVec3::from_array(position));
            LightKind::Bulb { position, orbit: Orbit { on, speed, since } }
        }
        FileLightKind::Spot { ref owner, half_aperture, exponent } => {
            let right =
                (0.0..=90.0).contains(&half_aperture) && (0.0..f64::INFINITY).contains(&exponent);
            if !right {
                return Err("it needs a half-aperture of 0 to 90 and an exponent above 0".into());
            }
            LightKind::Spot { owner: read_owner(owner)?, half_aperture, exponent }
        }
    };
    Ok(Light {
        name: light.name.clone(),
        slot: light.slot,
        on: light.on,
        color: Color(light.color),
        attenuation: light.attenuation,
        shadows: light.shadows,
        kind,
    })
}

fn read_owner(owner: &FileOwner) -> Result<SpotOwner, String> {
    Ok(match *owner {
        FileOwner::SelectedObject => SpotOwner::SelectedObject,
        FileOwner::SelectedCamera => SpotOwner::SelectedCamera,
        FileOwner::Object(id) => SpotOwner::Object(ObjectId(id)),
        FileOwner::Camera(id) => SpotOwner::Camera(CameraId(id)),
        FileOwner::Fixed { position, direction } => {
            finite("its place", &position)?;
            let position = DVec3::from_array(position);
            SpotOwner::Fixed(Tracked::new(Aim { position, direction: read_direction(direction)? }))
        }
    })
}

/// A direction of length 1, kept bit for bit if it has that length already.
fn read_direction(direction: [f64; 3]) -> Result<DVec3, String> {
    finite("its direction", &direction)?;
    let direction = DVec3::from_array(direction);
    if (direction.length() - 1.0).abs() < 1e-9 {
        return Ok(direction);
    }
    crate::base::math::unit(direction).ok_or_else(|| "its direction has no length".to_owned())
}

fn read_view(file: &FileView, scene: &Scene, findings: &mut Findings) -> Result<View, String> {
    let Steps { translation, rotation, scaling, .. } = file.steps;
    finite("the view", &[translation, rotation, scaling, file.time])?;
    if translation <= 0.0 || rotation <= 0.0 || scaling <= 1.0 {
        return Err("the steps of the view have to be above 0, and of scaling above 1".to_owned());
    }
    // If the selected item is missing, the selection of a new scene is used.
    let first = scene.first_view();
    let mut check = |what: &str, id: u32, is_there: bool| {
        if !is_there {
            findings.add(FindingKind::SelectionMissing, &format!("{what} {id}"), None);
        }
        is_there
    };
    let is_there = |id: &ObjectId| check("object", id.0, scene.objects.get(*id).is_some());
    let object = file.object.map(ObjectId).filter(is_there);
    let is_there = |id: &CameraId| check("camera", id.0, scene.cameras.get(*id).is_some());
    let camera = Some(file.camera).filter(|id| *id != UNSAID).map(CameraId).filter(is_there);
    let is_there = |id: &LightId| check("light", id.0, scene.lights.get(*id).is_some());
    let light = file.light.map(LightId).filter(is_there);
    let object = object.or(first.object);
    let polygons = object.and_then(|id| scene.objects.get(id)).and_then(|object| {
        let file = file.polygons.as_ref()?;
        let count = object.model.mesh.polygon_count();
        let there = |polygon: u32| (polygon as usize) < count;
        // The model may have changed since, and have fewer polygons now.
        let shown = file.shown.below(count);
        let mut mode = PolygonMode { current: 0, shown };
        mode.go_to(if there(file.current) { file.current } else { 0 });
        Some(mode)
    });
    Ok(View {
        subject: file.subject,
        object,
        camera: camera.unwrap_or(first.camera),
        light: light.or(first.light),
        transformation: file.transformation,
        frame: file.frame,
        steps: file.steps,
        observer: file.observer,
        projection: file.projection,
        fill: file.fill,
        edges_over_fill: file.edges_over_fill,
        polygons,
        polygons_stay: file.polygons_stay,
        only_selected: file.only_selected,
        normals: file.normals,
        back_faces: file.back_faces,
        face_normals: file.face_normals,
        vertex_normals: file.vertex_normals,
        normal_length: file.normal_length,
        wide_lines: file.wide_lines,
        marks: file.marks,
        coarse_while_moving: file.coarse_while_moving,
        time: file.time,
        panels: file.panels,
    })
}
