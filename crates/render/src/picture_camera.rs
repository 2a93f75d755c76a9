//! The camera of a picture, for other programs: intrinsics, pose and projection.
//!
//! * A position in the picture is in pixels from the upper left corner, x to the right and y down.
//!   The centre of the first pixel is (0.5, 0.5).
//! * The depth of a point is its distance along the camera's axis, in units of the world.
//! * The frame of the camera has the axes of OpenGL or of OpenCV: see [`AxesConvention`].

use glam::{DMat4, DVec2, DVec3, DVec4};

use marraztu_core::accuracy::Shot;
use marraztu_core::scene::{Intrinsics, Lens, Projection};

/// The directions of a camera's axes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum AxesConvention {
    /// x to the right, y up, the camera looks along -z: OpenGL, glTF, NeRF, nerfstudio, Blender.
    #[default]
    OpenGl,
    /// x to the right, y down, the camera looks along z: OpenCV, COLMAP, BOP, ROS.
    OpenCv,
}

impl AxesConvention {
    /// Returns the matrix that converts from these axes to the axes of OpenGL. It is its own
    /// inverse.
    #[must_use]
    pub fn flip(self) -> DMat4 {
        match self {
            Self::OpenGl => DMat4::IDENTITY,
            Self::OpenCv => DMat4::from_diagonal(DVec4::new(1.0, -1.0, -1.0, 1.0)),
        }
    }
}

/// The camera of a picture: a pinhole, or an orthographic projection.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PictureCamera {
    /// The projection.
    pub projection: Projection,
    /// The focal lengths or pixels per unit, the principal point, and the size of the picture.
    pub intrinsics: Intrinsics,
    /// The depth of the near plane; nearer points are not drawn.
    pub near: f64,
    /// The depth of the far plane; farther points are not drawn.
    pub far: f64,
    lens: Lens,
    /// The camera's pose with the axes of OpenGL. It has no scale.
    world_from_camera: DMat4,
}

impl PictureCamera {
    /// Returns the camera of a shot.
    #[must_use]
    pub fn of(shot: &Shot) -> Self {
        let Shot { scene, view, size, .. } = shot;
        let (lens, projection) = (scene.selected_camera(view).lens, view.projection);
        let (near, far) = match projection {
            Projection::Perspective => (lens.near, lens.far),
            Projection::Orthographic => (lens.parallel_near, lens.parallel_far),
        };
        let intrinsics = lens.intrinsics(projection, *size);
        let world_from_camera = scene.observer_frame(view);
        Self { projection, intrinsics, near, far, lens, world_from_camera }
    }

    /// Returns the rows of the intrinsic matrix K, in pixels, for axes of OpenCV: in perspective
    /// `(x, y, 1) = K p / p.z`, in orthographic projection `(x, y, 1) = K (p.x, p.y, 1)`.
    ///
    /// The centre of the first pixel is (0.5, 0.5). For programs that put it at (0, 0), subtract
    /// 0.5 from the principal point.
    #[must_use]
    pub fn k(&self) -> [[f64; 3]; 3] {
        let Intrinsics { focal, principal_point: at, .. } = self.intrinsics;
        [[focal.x, 0.0, at.x], [0.0, focal.y, at.y], [0.0, 0.0, 1.0]]
    }

    /// Returns the pose: the matrix that leads from the camera's frame to the world.
    #[must_use]
    pub fn world_from_camera(&self, axes: AxesConvention) -> DMat4 {
        self.world_from_camera * axes.flip()
    }

    /// Returns the inverse of [`Self::world_from_camera`].
    #[must_use]
    pub fn camera_from_world(&self, axes: AxesConvention) -> DMat4 {
        let [x, y, z, eye] = self.world_from_camera.to_cols_array_2d().map(DVec4::from_array);
        // The axes are orthonormal: the inverse of the rotation is its transpose.
        let rotation = glam::DMat3::from_cols(x.truncate(), y.truncate(), z.truncate()).transpose();
        let inverse = DMat4::from_mat3_translation(rotation, -(rotation * eye.truncate()));
        axes.flip() * inverse
    }

    /// Returns the matrix from the world to normalised device coordinates: after division by w, x
    /// and y run from -1 to 1, to the right and up. Depth is 1 at the near plane and 0 at the far
    /// plane.
    #[must_use]
    pub fn ndc_from_world(&self) -> DMat4 {
        self.lens.clip_from_view(self.projection, self.intrinsics.size)
            * self.camera_from_world(AxesConvention::OpenGl)
    }

    /// Returns the point of the world that is seen at a position of the picture, at this depth.
    #[must_use]
    pub fn point(&self, position: DVec2, depth: f64) -> DVec3 {
        let Intrinsics { focal, principal_point, .. } = self.intrinsics;
        let aside = (position - principal_point) / focal;
        let DVec2 { x, y } = match self.projection {
            Projection::Perspective => aside * depth,
            Projection::Orthographic => aside,
        };
        self.world_from_camera.transform_point3(DVec3::new(x, -y, -depth))
    }

    /// Returns the position of a point of the world in the picture, and its depth. The position is
    /// meaningless unless the depth is between the near and the far plane.
    #[must_use]
    pub fn project(&self, point: DVec3) -> (DVec2, f64) {
        let p = self.camera_from_world(AxesConvention::OpenCv).transform_point3(point);
        let aside = match self.projection {
            Projection::Perspective => p.truncate() / p.z,
            Projection::Orthographic => p.truncate(),
        };
        (aside * self.intrinsics.focal + self.intrinsics.principal_point, p.z)
    }
}
