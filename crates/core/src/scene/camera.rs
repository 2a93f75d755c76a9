//! A camera, its pose and its lens. It looks along -Z of its frame.

use glam::{DMat3, DMat4, DVec3, DVec4};
use serde::{Deserialize, Serialize};

use super::{MaterialChoice, Model, ObjectId, Projection, Tracked};
use crate::base::image::Size;
use crate::base::{Shared, math};

/// A camera, with the model that marks it for other observers.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    /// The name in the outline.
    pub name: String,
    /// Whether its marker is drawn.
    pub visible: bool,
    /// The marker's shape.
    pub model: Shared<Model>,
    /// The marker's material.
    pub material: MaterialChoice,
    /// The position, orientation and mode.
    pub pose: Tracked<Pose>,
    /// The field of view and its planes.
    pub lens: Lens,
}

impl Camera {
    /// Creates a camera at `eye` that looks along -Z, with the default lens.
    pub fn new(name: &str, model: Shared<Model>, material: MaterialChoice, eye: DVec3) -> Self {
        let pose = Tracked::new(Pose::facing_minus_z(eye));
        let lens = Lens::default();
        Self { name: name.to_owned(), visible: true, model, material, pose, lens }
    }
}

/// The position, orientation and mode of a camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// The position in the world.
    pub eye: DVec3,
    /// The axes as columns, orthonormal and right-handed.
    pub axes: DMat3,
    /// The mode of movement.
    pub mode: CameraMode,
}

/// A camera's mode of movement.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum CameraMode {
    /// The camera moves in its own frame.
    #[default]
    Fly,
    /// The camera orbits the centre of an object and looks at it (an orbit camera).
    Analysis {
        /// The object.
        target: ObjectId,
    },
}

impl Pose {
    /// Creates a pose at `eye` that looks along -Z.
    pub const fn facing_minus_z(eye: DVec3) -> Self {
        Self { eye, axes: DMat3::IDENTITY, mode: CameraMode::Fly }
    }

    /// Returns the matrix `world_from_camera`.
    pub fn world_from_camera(&self) -> DMat4 {
        math::placed(self.axes, self.eye)
    }

    /// Creates a pose from a matrix `world_from_camera`; `None` unless it is a rotation with a
    /// position. Matrices in files have few digits, so the axes are made orthonormal again.
    pub fn from_matrix(world_from_camera: DMat4) -> Option<Self> {
        /// The largest difference of an entry of R R' from the identity, and of the last row from
        /// 0 0 0 1.
        const MOST: f64 = 1e-3;
        let (axes, eye) = (DMat3::from_mat4(world_from_camera), world_from_camera.w_axis);
        let is_rotation = (axes * axes.transpose()).abs_diff_eq(DMat3::IDENTITY, MOST);
        // A matrix for row vectors has the position in its last row.
        let is_affine = world_from_camera.row(3).abs_diff_eq(DVec4::W, MOST);
        if !is_rotation || !is_affine || axes.determinant() < 0.0 || !eye.is_finite() {
            return None;
        }
        let z = axes.z_axis.normalize_or_zero();
        let x = axes.y_axis.cross(z).normalize_or_zero();
        let axes = DMat3::from_cols(x, z.cross(x), z);
        Some(Self { eye: eye.truncate(), axes, mode: CameraMode::Fly })
    }

    /// Returns the current mode. The camera orbits only while its target is the selected object.
    pub fn mode_with(&self, selected: Option<ObjectId>) -> CameraMode {
        match self.mode {
            CameraMode::Analysis { target } if Some(target) == selected => self.mode,
            CameraMode::Analysis { .. } | CameraMode::Fly => CameraMode::Fly,
        }
    }
}

/// The lens of a camera, in perspective and in orthographic projection.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Lens {
    /// Degrees to each side of the axis, across the shorter side of the picture: above 0, below 90.
    pub half_angle: f64,
    /// The near plane in perspective: more than 0.
    pub near: f64,
    /// Whether the window moves the near plane towards the eye where it would cut a surface.
    #[serde(skip_serializing_if = "is_on")]
    pub automatic_near: bool,
    /// The far plane in perspective: more than `near`.
    pub far: f64,
    /// Units to each side of the axis in orthographic projection, across the shorter side: above 0.
    pub half_size: f64,
    /// The near plane in orthographic projection.
    pub parallel_near: f64,
    /// The far plane in orthographic projection: more than `parallel_near`.
    pub parallel_far: f64,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde passes a reference")]
const fn is_on(automatic: &bool) -> bool {
    *automatic
}

impl Default for Lens {
    fn default() -> Self {
        Self {
            half_angle: 22.5,
            near: 1.0,
            automatic_near: true,
            far: 2000.0,
            half_size: 500.0,
            parallel_near: 0.0,
            parallel_far: 2000.0,
        }
    }
}

impl Lens {
    /// Returns whether the lens gives a valid projection.
    pub fn is_valid(&self) -> bool {
        let Self { half_angle, near, far, half_size, parallel_near, parallel_far, .. } = *self;
        let finite = [half_angle, near, far, half_size, parallel_near, parallel_far];
        finite.iter().all(|x| x.is_finite())
            && half_angle > 0.0
            && half_angle < 90.0
            && near > 0.0
            && far > near
            && half_size > 0.0
            && parallel_far > parallel_near
    }

    /// Returns the matrix `clip_from_view` for a picture of this size.
    pub fn clip_from_view(&self, projection: Projection, size: Size) -> DMat4 {
        match projection {
            Projection::Perspective => {
                math::perspective(self.half_angle.to_radians(), self.near, self.far, size)
            }
            Projection::Orthographic => {
                math::orthographic(self.half_size, self.parallel_near, self.parallel_far, size)
            }
        }
    }
}
