//! Sets transforms, and keeps cameras in analysis aimed.
//!
//! A transformation pushes the old transform of the item, once per gesture. If a camera in analysis
//! looks at a moved object, the same command aims the camera again, without pushing its old pose.

use glam::{DMat3, DMat4, DVec3};

use super::items::one_or_batch;
use super::{Change, GesturePhase, Refusal};
use crate::base::math;
use crate::scene::{
    Aim, Anchor, AnchorMut, CameraId, CameraMode, Command, CommandError, Item, ItemId, Lens, Light,
    LightId, LightOrigin, Object, ObjectId, Pose, Scene, SpotOwner, Tracked, Transformation, View,
};

/// Returns the selected object.
pub(super) fn selected_object<'a>(
    scene: &'a Scene,
    view: &View,
) -> Result<(ObjectId, &'a Object), Refusal> {
    let id = view.object.ok_or(Refusal::NoObject)?;
    Ok((id, scene.objects.get(id).ok_or(Refusal::NoObject)?))
}

/// Returns the selected light.
pub(super) fn selected_light<'a>(
    scene: &'a Scene,
    view: &View,
) -> Result<(LightId, &'a Light), Refusal> {
    let id = view.light.ok_or(Refusal::NoLight)?;
    Ok((id, scene.lights.get(id).ok_or(Refusal::NoLight)?))
}

/// Returns an error if an item is locked, as it then may not be moved or deleted.
pub(super) fn unlocked(scene: &Scene, id: ItemId) -> Result<(), Refusal> {
    if !scene.locked.contains(&id) {
        return Ok(());
    }
    Err(Refusal::Locked(scene.name(id).unwrap_or_default().to_owned()))
}

/// Gives the object `id` another placement.
pub(super) fn object(
    scene: &Scene,
    view: &View,
    id: ObjectId,
    placement: DMat4,
    phase: GesturePhase,
) -> Change {
    let before = scene.objects.get(id).ok_or(Refusal::Gone)?;
    object_placed(scene, view, id, phase.apply(&before.placement, placement))
}

/// Gives the object `id` another placement and stack, and aims the cameras that look at it.
pub(super) fn object_placed(
    scene: &Scene,
    view: &View,
    id: ObjectId,
    placement: Tracked<DMat4>,
) -> Change {
    if !placement.now().is_finite() {
        return Err(Refusal::TooLarge);
    }
    unlocked(scene, ItemId::Object(id))?;
    let mut object = scene.objects.get(id).ok_or(Refusal::Gone)?.clone();
    object.placement = placement;
    let centre = object.centre(view.time);
    let mut commands = vec![Command::Replace(Item::Object(id, Box::new(object)))];
    for (camera_id, camera) in scene.cameras.iter() {
        let pose = camera.pose.now();
        if scene.locked.contains(&ItemId::Camera(camera_id)) {
            continue;
        }
        if pose.mode_with(view.object) == (CameraMode::Analysis { target: id }) {
            // The camera's Y stays up, so a camera that has orbited over the pole does not flip.
            let axes = math::look_at(pose.eye, centre, pose.axes.y_axis, pose.axes);
            let mut camera = camera.clone();
            camera.pose = camera.pose.replaced(Pose { axes, ..*camera.pose.now() });
            commands.push(Command::Replace(Item::Camera(camera_id, Box::new(camera))));
        }
    }
    Ok(one_or_batch(commands))
}

/// Gives the camera `id` another pose, with its axes made orthonormal.
pub(super) fn pose(scene: &Scene, id: CameraId, pose: Pose, phase: GesturePhase) -> Change {
    let lens = scene.cameras.get(id).ok_or(Refusal::Gone)?.lens;
    pose_and_lens(scene, id, pose, lens, phase)
}

/// Gives the camera `id` another lens and another pose, with its axes made orthonormal.
pub(super) fn pose_and_lens(
    scene: &Scene,
    id: CameraId,
    pose: Pose,
    lens: Lens,
    phase: GesturePhase,
) -> Change {
    let mut camera = scene.cameras.get(id).ok_or(Refusal::Gone)?.clone();
    unlocked(scene, ItemId::Camera(id))?;
    if !(pose.eye.is_finite() && pose.axes.is_finite()) {
        return Err(Refusal::TooLarge);
    }
    if lens != camera.lens && !lens.is_valid() {
        return Err(CommandError::Lens.into());
    }
    let axes = math::frame(pose.axes.z_axis, pose.axes.y_axis, camera.pose.now().axes);
    camera.pose = phase.apply(&camera.pose, Pose { axes, ..pose });
    camera.lens = lens;
    Ok(Command::Replace(Item::Camera(id, Box::new(camera))))
}

/// Within this sine of straight up or down, the camera's Y stays up instead of the world's Y.
///
/// Seen from above, the centre of an object is rarely exactly below the camera. With the world's Y
/// up, a tiny horizontal offset would turn the picture by an arbitrary angle.
const STEEP: f64 = 0.1;

/// Aims the selected camera at the object that it orbits in analysis, after undo or redo has moved
/// only the object. `None` if the camera is already aimed, or locked.
#[must_use]
pub fn aimed_again(scene: &Scene, view: &View) -> Option<Command> {
    let centre = analysis_centre(scene, view)?;
    let camera = scene.selected_camera(view);
    let pose = camera.pose.now();
    let axes = math::look_at(pose.eye, centre, pose.axes.y_axis, pose.axes);
    let is_aimed = axes.z_axis.abs_diff_eq(pose.axes.z_axis, 1e-9);
    if is_aimed || scene.locked.contains(&ItemId::Camera(view.camera)) {
        return None;
    }
    let mut camera = camera.clone();
    camera.pose = camera.pose.replaced(Pose { axes, ..*pose });
    Some(Command::Replace(Item::Camera(view.camera, Box::new(camera))))
}

/// Returns the upright pose in analysis that looks at the centre of an object.
pub(super) fn aimed(pose: &Pose, target: ObjectId, centre: DVec3) -> Pose {
    let steep = math::unit(pose.eye - centre)
        .is_some_and(|z| z.cross(DVec3::Y).length() < STEEP && z.dot(pose.axes.z_axis) > 0.9);
    let up = if steep { pose.axes.y_axis } else { DVec3::Y };
    Pose {
        eye: pose.eye,
        axes: math::look_at(pose.eye, centre, up, pose.axes),
        mode: CameraMode::Analysis { target },
    }
}

/// Returns the centre that the selected camera orbits in analysis; `None` in fly.
pub(super) fn analysis_centre(scene: &Scene, view: &View) -> Option<DVec3> {
    match scene.selected_camera(view).pose.now().mode_with(view.object) {
        CameraMode::Fly => None,
        CameraMode::Analysis { target } => Some(scene.objects.get(target)?.centre(view.time)),
    }
}

/// Returns the position and the direction of a light that can be set, or the reason why it cannot
/// be transformed.
pub(super) fn place_of(light: &Light) -> Result<LightOrigin, Refusal> {
    let (position, direction) = match light.kind.anchor() {
        Anchor::Everywhere => return Err(Refusal::Ambient),
        Anchor::Direction(direction) => (None, Some(*direction.now())),
        Anchor::Position(position) => (Some(*position.now()), None),
        Anchor::Owner(owner) => match owner {
            SpotOwner::Fixed(aim) => (Some(aim.now().position), Some(aim.now().direction)),
            SpotOwner::SelectedObject | SpotOwner::Object(_) => {
                return Err(Refusal::SpotFollows("object"));
            }
            SpotOwner::SelectedCamera | SpotOwner::Camera(_) => {
                return Err(Refusal::SpotFollows("camera"));
            }
        },
    };
    Ok(LightOrigin { position, direction })
}

/// Returns the transformation of x, y and z for a light, if `chosen` is asked for. A sun can only
/// be turned and a bulb only be moved, for any `chosen`.
///
/// # Errors
/// If the light has neither a position nor a direction that can be set.
pub fn transformation_of(light: &Light, chosen: Transformation) -> Result<Transformation, Refusal> {
    Ok(match place_of(light)? {
        LightOrigin { position: None, .. } => Transformation::Rotation,
        LightOrigin { direction: None, .. } => Transformation::Translation,
        LightOrigin { .. } => chosen,
    })
}

/// Gives the light `id` another position or direction; `place` must suit the kind of light.
pub(super) fn light(scene: &Scene, id: LightId, place: LightOrigin, phase: GesturePhase) -> Change {
    let mut light = scene.lights.get(id).ok_or(Refusal::NoLight)?.clone();
    unlocked(scene, ItemId::Light(id))?;
    // Checked before the light is changed: directions have length 1, positions are finite.
    let direction = |v: DVec3| math::unit(v).ok_or(Refusal::TooLarge);
    let position = |v: DVec3| if v.is_finite() { Ok(v) } else { Err(Refusal::TooLarge) };
    match (light.kind.anchor_mut(), place.position, place.direction) {
        (AnchorMut::Direction(placed), None, Some(to)) => {
            *placed = phase.apply(placed, direction(to)?);
        }
        (AnchorMut::Position(placed), Some(to), None) => {
            *placed = phase.apply(placed, position(to)?);
        }
        (AnchorMut::Owner(SpotOwner::Fixed(placed)), Some(at), Some(to)) => {
            let to = Aim { position: position(at)?, direction: direction(to)? };
            *placed = phase.apply(placed, to);
        }
        (AnchorMut::Everywhere, ..) => return Err(Refusal::Ambient),
        (AnchorMut::Direction(_), ..) => return Err(Refusal::SunMoved),
        (AnchorMut::Position(_), ..) => return Err(Refusal::BulbTurned),
        (AnchorMut::Owner(_), ..) => {
            place_of(&light)?;
            return Err(Refusal::Gone);
        }
    }
    Ok(Command::Replace(Item::Light(id, Box::new(light))))
}

/// Returns the rotation by `radians` about an axis of any length; the identity if the length is 0.
///
/// Full turns are left to the sine: a remainder by the nearest number to 2 pi would lose 4e-11 at
/// an angle of 1e6.
pub(super) fn turn(axis: DVec3, radians: f64) -> Result<DMat3, Refusal> {
    if !radians.is_finite() {
        return Err(Refusal::TooLarge);
    }
    Ok(math::unit(axis).map_or(DMat3::IDENTITY, |axis| math::rotation(axis, radians)))
}
