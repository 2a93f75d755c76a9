//! A turntable: the scene after a part of a turn about the vertical axis.
//!
//! Either the objects turn under fixed lights, as in a photographer's studio, or the camera circles
//! around them. The axis goes through the centre of everything visible.

use glam::{DMat4, DVec3};
use serde::{Deserialize, Serialize};

use super::{Refusal, framing, items};
use crate::base::math;
use crate::scene::{Command, Item, Observer, Pose, Scene, Tracked, View};

/// The part of the scene that turns.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Turn {
    /// The objects.
    #[default]
    Objects,
    /// The camera.
    Camera,
}

/// Returns the scene after `part` of a full turn, counter-clockwise seen from above. A part of 0
/// returns the scene unchanged.
///
/// # Errors
/// If nothing is visible, or an object is the observer and the camera is to turn.
pub fn turned(scene: &Scene, view: &View, turn: Turn, part: f64) -> Result<Scene, Refusal> {
    if turn == Turn::Camera && view.observer == Observer::Object && view.object.is_some() {
        return Err(Refusal::ObjectLooks);
    }
    let sphere = framing::sphere(scene, view, &framing::shown(scene, view));
    let sphere = sphere.ok_or(Refusal::NothingToFrame)?;
    let mut turned = scene.clone();
    if part.rem_euclid(1.0) == 0.0 {
        return Ok(turned);
    }
    let rotation = math::rotation(DVec3::Y, part * std::f64::consts::TAU);
    let centre = DVec3::new(sphere.centre.x, 0.0, sphere.centre.z);
    let command = match turn {
        Turn::Objects => {
            let about: DMat4 = math::placed(rotation, centre - rotation * centre);
            items::change_all_objects(scene, |object| {
                object.placement = Tracked::new(about * *object.placement.now());
            })
        }
        Turn::Camera => {
            let id = view.camera;
            let mut camera = scene.selected_camera(view).clone();
            let pose = *camera.pose.now();
            let eye = centre + rotation * (pose.eye - centre);
            camera.pose = Tracked::new(Pose { eye, axes: rotation * pose.axes, ..pose });
            Command::Replace(Item::Camera(id, Box::new(camera)))
        }
    };
    command.apply(&mut turned)?;
    Ok(turned)
}
