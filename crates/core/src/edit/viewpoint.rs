//! Viewpoints: the camera that is looked through, with its pose and its planes. The window keeps
//! earlier viewpoints to return to. They are separate from the history.

use super::{Change, GesturePhase, Refusal, set_transform};
use crate::scene::{
    CameraId, Command, CommandError, Item, ItemId, Lens, Observer, Pose, Projection, Scene, View,
};

/// The camera that is looked through, with its pose and its planes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Viewpoint {
    camera: CameraId,
    pose: Pose,
    lens: Lens,
    observer: Observer,
    projection: Projection,
}

impl Viewpoint {
    /// Returns the present viewpoint.
    pub fn of(scene: &Scene, view: &View) -> Self {
        let camera = scene.selected_camera(view);
        let (pose, lens) = (*camera.pose.now(), camera.lens);
        let View { camera, observer, projection, .. } = *view;
        Self { camera, pose, lens, observer, projection }
    }

    /// Returns whether two viewpoints give the same picture of the same scene. The near plane and
    /// the field of view do not count: the first follows the pose, and a change of the second is a
    /// step of the history.
    pub fn is_like(&self, other: &Self) -> bool {
        let Lens { near, automatic_near, half_angle, .. } = other.lens;
        let lens = Lens { near, automatic_near, half_angle, ..self.lens };
        Self { lens, ..*self } == *other
    }

    /// Returns the view from this viewpoint, and the command that moves the camera there.
    ///
    /// # Errors
    /// If the camera is gone or locked.
    pub fn shown(&self, scene: &Scene, view: &View) -> (View, Change) {
        let Self { camera, observer, projection, .. } = *self;
        let view = View { camera, observer, projection, ..view.clone() };
        (view, self.command(scene))
    }

    /// Returns the command that gives the camera exactly this pose.
    fn command(&self, scene: &Scene) -> Change {
        let Self { camera: id, pose, lens, .. } = *self;
        set_transform::unlocked(scene, ItemId::Camera(id))?;
        let mut camera = scene.cameras.get(id).ok_or(Refusal::Gone)?.clone();
        let Lens { half_angle, automatic_near, .. } = camera.lens;
        let near = if automatic_near { lens.near } else { camera.lens.near };
        let lens = Lens { half_angle, automatic_near, near, ..lens };
        if !lens.is_valid() {
            return Err(CommandError::Lens.into());
        }
        camera.pose = GesturePhase::First.apply(&camera.pose, pose);
        camera.lens = lens;
        Ok(Command::Replace(Item::Camera(id, Box::new(camera))))
    }
}
